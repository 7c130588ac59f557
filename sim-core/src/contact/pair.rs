//! First contact of two moving discs, by steps that are safe by a bound on the second derivative of their gap.

use super::{APPROACH, Path, TOUCH};

/// A disc on its way: its centre's path, how long it has been on it, and its radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rolling {
    /// Path of the centre.
    pub path: Path,
    /// Seconds since the start of the path.
    pub elapsed: f64,
    /// Radius, m.
    pub radius: f64,
}

/// Seconds until two discs are in contact and approach each other, if before `span` seconds.
///
/// The gap's second derivative is at least minus the sum A of both accelerations, so that from gap g with rate g' no
/// contact comes before the root of g + g' h - A h^2 / 2: stepping there again and again comes to the contact from before
/// and passes none.
pub fn first_touch(a: &Rolling, b: &Rolling, span: f64) -> Option<f64> {
    let acceleration = a.path.acceleration() + b.path.acceleration();
    // Discs that roll along each other in contact are looked at anew this often.
    let patience = (1e-3 * span).max(1e-6);
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
            // Half a picosecond ends the approach to the contact; the gap is then a rounding error.
            t += step.max(5e-13);
            if !step.is_finite() {
                return None;
            }
        } else if rate < -APPROACH {
            return Some(t);
        } else if acceleration == 0.0 {
            // Two straight lines part for ever once they do.
            return None;
        } else {
            t += ((rate + APPROACH) / acceleration).max(patience);
        }
    }
    None
}
