//! First contact of a moving disc with a wall: closed forms bracket the instant, and an iteration refines it.
//!
//! On a path of constant twist, the distance from the centre to a wall has two kinds of critical points: where the path
//! is parallel to the wall, and where the centre is nearest to or farthest from one of the wall's ends. All of these
//! have closed forms. Between two neighbouring critical points the distance is monotone, so every contact is bracketed
//! and none is missed.

use std::f64::consts::PI;

use glam::DVec2;

use super::{Path, SKIN, TOUCH};
use crate::{math, scene::Segment};

/// The contact that ends a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallContact {
    /// Seconds since the start of the path.
    pub after: f64,
    /// False if the disc was in contact with this wall already at the start.
    pub fresh: bool,
}

/// First instant at which a disc of `radius` is in contact with `wall` and approaches it. The centre follows `path` for
/// `duration` seconds, which may be infinite. `None` if the disc does not meet the wall.
///
/// A disc that starts in contact, or overlaps the wall, may leave, slide along the wall and turn. Only an approach
/// counts as a contact, from the instant at which the disc begins to approach. An approach by less than a thousandth of
/// the gap does not count, so that the rounding of the heading does not stop a drive along a wall.
pub fn first_contact(path: &Path, radius: f64, wall: &Segment, duration: f64) -> Option<WallContact> {
    if path.is_resting() {
        return None;
    }
    let gap = |seconds: f64| wall.distance(path.position(seconds)) - radius;
    let along = wall.b - wall.a;
    let side = |seconds: f64| along.perp_dot(path.position(seconds) - wall.a);
    let marks = CriticalTimes::new(path, wall, duration.min(path.period()));
    let mut from = StretchEnd { time: 0.0, gap: gap(0.0), side: side(0.0) };
    let mut touching = from.gap <= TOUCH;
    let fresh = !touching;
    let tolerance = 8.0 * f64::EPSILON * (path.origin.abs().max_element() + radius);
    for &time in marks.as_slice() {
        let end = StretchEnd { time, gap: gap(time), side: side(time) };
        // The distance may have a kink where the centre crosses the wall's line, so the interval is divided there.
        let passage = (from.side * end.side < 0.0).then(|| {
            let time = root(side, (from.time, from.side), (end.time, end.side));
            StretchEnd { time, gap: gap(time), side: 0.0 }
        });
        for to in passage.into_iter().chain([end]) {
            if touching {
                if to.gap < from.gap - (1e-3 * from.gap).max(tolerance) {
                    return Some(WallContact { after: from.time, fresh });
                }
                touching = to.gap <= TOUCH;
            } else if to.gap <= SKIN {
                let after = root(|seconds| gap(seconds) - SKIN, (from.time, from.gap - SKIN), (to.time, to.gap - SKIN));
                return Some(WallContact { after, fresh });
            }
            from = to;
        }
    }
    None
}

/// State of the disc at an end of a monotone part of the path.
struct StretchEnd {
    time: f64,
    gap: f64,
    /// Sign: the side of the wall's line on which the centre is.
    side: f64,
}

/// Root of `f` between two instants, each given with its value. At the returned instant `f` has changed its sign; the
/// instant is at most a rounding error after one at which it has not.
fn root(f: impl Fn(f64) -> f64, from: (f64, f64), to: (f64, f64)) -> f64 {
    let (mut low, mut low_value) = from;
    let (mut high, mut high_value) = to;
    let sign = low_value.signum();
    // The Illinois method: regula falsi that halves the value at an end that is kept. Every third step bisects, so that
    // the bracket shrinks to neighbouring doubles for every shape of `f`.
    for step in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high || high_value == 0.0 {
            break;
        }
        let secant = high - high_value * (high - low) / (high_value - low_value);
        let guess = if step % 3 == 2 || !(low..high).contains(&secant) || secant == low { middle } else { secant };
        let value = f(guess);
        if value * sign > 0.0 {
            (low, low_value) = (guess, value);
            high_value *= 0.5;
        } else {
            (high, high_value) = (guess, value);
            low_value *= 0.5;
        }
    }
    high
}

/// Ends of the intervals in which the distance to a wall is monotone, in ascending order; the last is the end of the
/// path.
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
            let (ahead, lateral) = (offset.dot(tangent), offset.dot(normal));
            // The centre is nearest or farthest where the path has turned by an angle theta with tan(theta) = a / b.
            let (a, b) = (omega / speed * ahead, 1.0 - omega / speed * lateral);
            if b > 0.0 && (a / b).abs() < 1e-4 {
                // The series of the arc tangent makes a straight path the limit of a curved path.
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

    /// Adds the instant `time`, within half a turn of the start, and the instants one and two half turns later, if they
    /// lie on the path.
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
