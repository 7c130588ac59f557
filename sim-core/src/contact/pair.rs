//! First contact of two moving discs, by steps that are safe because the second derivative of the gap is bounded.

use super::{APPROACH, Path, TOUCH};

/// A moving disc: the path of its centre, the time since the path's start, and its radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingDisc {
    /// Path of the centre.
    pub path: Path,
    /// Seconds since the start of the path.
    pub elapsed: f64,
    /// Radius, m.
    pub radius: f64,
}

/// Seconds until two discs are in contact and approach each other; `None` if that takes `span` seconds or longer.
///
/// The second derivative of the gap is at least -A, where A is the sum of the accelerations of both discs. From a gap g
/// with rate g', the discs cannot meet before the root h of g + g' h - A h^2 / 2. Repeated steps to this root therefore
/// converge to the contact and never pass it.
pub fn first_touch(a: &MovingDisc, b: &MovingDisc, span: f64) -> Option<f64> {
    let acceleration = a.path.acceleration() + b.path.acceleration();
    // Minimum step in seconds, for discs in contact that do not approach each other.
    let min_step = (1e-3 * span).max(1e-6);
    let mut t = 0.0;
    while t < span {
        let offset = b.path.position(b.elapsed + t) - a.path.position(a.elapsed + t);
        let relative = b.path.velocity(b.elapsed + t) - a.path.velocity(a.elapsed + t);
        let distance = offset.length();
        let gap = distance - a.radius - b.radius;
        let rate = if distance > 0.0 { relative.dot(offset) / distance } else { 0.0 };
        if gap > TOUCH {
            let excess = gap - TOUCH;
            let root = (rate * rate + 2.0 * acceleration * excess).sqrt();
            let step = if rate < 0.0 { 2.0 * excess / (root - rate) } else { (rate + root) / acceleration };
            // Since each step is at least half a picosecond, the iteration ends; where this minimum applies, the
            // remaining gap is a rounding error.
            t += step.max(5e-13);
            if !step.is_finite() {
                return None;
            }
        } else if rate < -APPROACH {
            return Some(t);
        } else if acceleration == 0.0 {
            // Discs on straight lines that do not approach each other now never will.
            return None;
        } else {
            t += ((rate + APPROACH) / acceleration).max(min_step);
        }
    }
    None
}
