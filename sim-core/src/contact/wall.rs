//! First contact of a moving disc with a wall, in closed form up to the last bisection.
//!
//! Along a path of constant twist the distance from the centre to a wall has critical points only where the path is
//! parallel to the wall and where it is nearest to, or farthest from, one of the wall's ends. All of these have closed
//! forms; between two neighbours the distance is monotone, so that a contact is bracketed and cannot be missed.

use std::f64::consts::PI;

use glam::DVec2;

use super::{Path, SKIN, TOUCH};
use crate::{math, scene::Segment};

/// The contact that ends a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallContact {
    /// Seconds since the start of the path.
    pub after: f64,
    /// False when the disc was in contact with this wall already at the start.
    pub fresh: bool,
}

/// When a disc of `radius` whose centre follows `path` for `duration` seconds (may be infinite) first is in contact with
/// `wall` and approaches it.
///
/// A disc that starts in contact, or inside, may leave, slide along and turn: only coming nearer is a contact, at the
/// instant from which it comes nearer. Coming nearer by less than a thousandth of the gap is none, so that a drive along a
/// wall is not stopped by the rounding of its heading.
pub fn first_contact(path: &Path, radius: f64, wall: &Segment, duration: f64) -> Option<WallContact> {
    if path.is_resting() {
        return None;
    }
    let gap = |seconds: f64| wall.distance(path.position(seconds)) - radius;
    let marks = CriticalTimes::new(path, wall, duration.min(path.period()));
    let mut from = 0.0;
    let mut gap_from = gap(0.0);
    let mut touching = gap_from <= TOUCH;
    let fresh = !touching;
    for &to in marks.as_slice() {
        let gap_to = gap(to);
        if touching {
            if is_approached(path, wall, radius, (from, gap_from), (to, gap_to)) {
                return Some(WallContact { after: from, fresh });
            }
            touching = gap_to <= TOUCH;
        } else if gap_to <= SKIN {
            return Some(WallContact { after: crossing(gap, (from, gap_from), (to, gap_to)), fresh });
        }
        (from, gap_from) = (to, gap_to);
    }
    None
}

/// Whether a disc in contact comes nearer to the wall within a stretch of monotone distance.
fn is_approached(path: &Path, wall: &Segment, radius: f64, from: (f64, f64), to: (f64, f64)) -> bool {
    let rounding = 8.0 * f64::EPSILON * (path.origin.abs().max_element() + radius);
    let tolerance = (1e-3 * from.1).max(rounding);
    if to.1 < from.1 - tolerance {
        return true;
    }
    // A centre on its way across the wall itself is as far behind it as it was before: nearer in between.
    let along = wall.b - wall.a;
    let side = |seconds: f64| along.perp_dot(path.position(seconds) - wall.a);
    from.1 < -0.5 * radius && side(from.0) * side(to.0) < 0.0 && crosses_between_ends(path, wall, from.0, to.0)
}

/// Whether the chord from `from` to `to` seconds crosses the wall between its ends.
fn crosses_between_ends(path: &Path, wall: &Segment, from: f64, to: f64) -> bool {
    let (start, end) = (path.position(from), path.position(to));
    let chord = end - start;
    chord.perp_dot(wall.a - start) * chord.perp_dot(wall.b - start) < 0.0
}

/// The instant at which `gap` falls to the skin, between one where it is greater and one where it is not: the first
/// double found at which it is not greater, with no double of a greater gap more than a rounding error before it.
fn crossing(gap: impl Fn(f64) -> f64, from: (f64, f64), to: (f64, f64)) -> f64 {
    let (mut low, mut low_excess) = (from.0, from.1 - SKIN);
    let (mut high, mut high_excess) = (to.0, to.1 - SKIN);
    // Illinois: regula falsi that halves the weight of an end that stays. Each third step bisects, so that the bracket
    // shrinks to neighbouring doubles whatever the shape.
    for step in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high || high_excess == 0.0 {
            break;
        }
        let secant = high - high_excess * (high - low) / (high_excess - low_excess);
        let guess = if step % 3 == 2 || !(secant > low && secant < high) { middle } else { secant };
        let excess = gap(guess) - SKIN;
        if excess > 0.0 {
            (low, low_excess) = (guess, excess);
            high_excess *= 0.5;
        } else {
            (high, high_excess) = (guess, excess);
            low_excess *= 0.5;
        }
    }
    high
}

/// The ends of the stretches in which the distance to a wall is monotone, in ascending order, the last the path's own end.
struct CriticalTimes {
    times: [f64; 10],
    len: usize,
}

impl CriticalTimes {
    fn new(path: &Path, wall: &Segment, end: f64) -> Self {
        let mut all = Self { times: [0.0; 10], len: 0 };
        let speed = path.speed();
        let omega = path.twist.omega;
        let tangent = path.direction.rotate(DVec2::new(path.twist.vx / speed, path.twist.vy / speed));
        let normal = tangent.perp();
        for point in [wall.a, wall.b] {
            let offset = point - path.origin;
            let (ahead, aside) = (offset.dot(tangent), offset.dot(normal));
            // Nearest or farthest where the angle turned, theta, has tan(theta) = a / b.
            let (a, b) = (omega / speed * ahead, 1.0 - omega / speed * aside);
            if b > 0.0 && (a / b).abs() < 1e-4 {
                // The series of the arc tangent, so that a straight path is the limit of a curved one.
                let ratio = a / b;
                all.push_turning(ahead / (speed * b) * (1.0 - ratio * ratio / 3.0), omega, end);
            } else {
                all.push_turning(math::atan2(a, b) / omega, omega, end);
            }
        }
        let along = wall.b - wall.a;
        if omega != 0.0 && along != DVec2::ZERO {
            all.push_turning(math::atan2(along.dot(normal), along.dot(tangent)) / omega, omega, end);
        }
        if end < f64::INFINITY {
            all.push(end, end);
        }
        all.times[..all.len].sort_by(f64::total_cmp);
        all
    }

    /// Takes those of the instants `time`, within a half turn of the start, and half turns later that lie on the path.
    fn push_turning(&mut self, time: f64, omega: f64, end: f64) {
        let half_turn = PI / omega.abs();
        for time in [time, time + half_turn, time + 2.0 * half_turn] {
            self.push(time, end);
        }
    }

    fn push(&mut self, time: f64, end: f64) {
        if time > 0.0 && time <= end && time.is_finite() {
            self.times[self.len] = time;
            self.len += 1;
        }
    }

    fn as_slice(&self) -> &[f64] {
        &self.times[..self.len]
    }
}
