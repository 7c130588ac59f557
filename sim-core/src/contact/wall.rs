//! First contact of a moving disc with a wall: closed forms bracket the instant, and an iteration refines it.
//!
//! On a path of constant twist, the distance from the centre to a wall has two kinds of critical points. At one kind
//! the path is parallel to the wall; at the other kind the centre is nearest to or farthest from one of the wall's
//! ends. Their times have closed forms. Between two neighbouring critical points the distance is monotone, so every
//! contact is bracketed and none is missed.

use std::f64::consts::PI;

use glam::DVec2;

use super::{Path, SKIN, TOUCH};
use crate::{math, scene::Segment};

/// First contact of a path with a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallContact {
    /// Seconds since the start of the path.
    pub seconds: f64,
    /// False if the disc was in contact with this wall at the start of the path.
    pub fresh: bool,
}

/// First instant at which a disc of `radius` is in contact with `wall` and approaches it. The centre follows `path` for
/// `duration` seconds, which may be infinite. `None` if there is no such instant.
///
/// A disc that starts in contact with the wall, or overlaps it, can leave the wall, slide along it and turn. The result
/// is then the instant at which the disc begins to approach the wall. An approach by less than a thousandth of the gap
/// is ignored, so that the rounding of the heading does not stop a drive along a wall.
pub fn first_contact(path: &Path, radius: f64, wall: &Segment, duration: f64) -> Option<WallContact> {
    if path.is_resting() {
        return None;
    }
    let gap = |seconds: f64| wall.distance(path.position(seconds)) - radius;
    let along = wall.b - wall.a;
    let side = |seconds: f64| along.perp_dot(path.position(seconds) - wall.a);
    let critical_times = CriticalTimes::new(path, wall, duration.min(path.period()));
    let mut from = IntervalEnd { time: 0.0, gap: gap(0.0), side: side(0.0) };
    let mut is_touching = from.gap <= TOUCH;
    let fresh = !is_touching;
    let tolerance = 8.0 * f64::EPSILON * (path.origin.abs().max_element() + radius);
    for &time in critical_times.as_slice() {
        let end = IntervalEnd { time, gap: gap(time), side: side(time) };
        // The distance can have a kink where the centre crosses the line of the wall, so the interval is divided there.
        let crossing = (from.side * end.side < 0.0).then(|| {
            let time = root(side, (from.time, from.side), (end.time, end.side));
            IntervalEnd { time, gap: gap(time), side: 0.0 }
        });
        for to in crossing.into_iter().chain([end]) {
            if is_touching {
                if to.gap < from.gap - (1e-3 * from.gap).max(tolerance) {
                    return Some(WallContact { seconds: from.time, fresh });
                }
                is_touching = to.gap <= TOUCH;
            } else if to.gap <= SKIN {
                let seconds =
                    root(|seconds| gap(seconds) - SKIN, (from.time, from.gap - SKIN), (to.time, to.gap - SKIN));
                return Some(WallContact { seconds, fresh });
            }
            from = to;
        }
    }
    None
}

/// Position of the disc relative to the wall at an end of an interval in which the distance is monotone.
struct IntervalEnd {
    time: f64,
    gap: f64,
    /// Number whose sign gives the side of the wall's line on which the centre is.
    side: f64,
}

/// Root of `f` between two instants, each given with its value. At the returned instant `f` has changed its sign, at
/// most a rounding error ago.
fn root(f: impl Fn(f64) -> f64, from: (f64, f64), to: (f64, f64)) -> f64 {
    let (mut low, mut low_value) = from;
    let (mut high, mut high_value) = to;
    let sign = low_value.signum();
    // A variant of the Illinois method: regula falsi that halves the function value at the end that is kept. Every
    // third step is a bisection, so that the bracket shrinks to neighbouring doubles for every function `f`.
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

/// Ends of the intervals in which the distance to a wall is monotone, in ascending order; the last one is the end of
/// the path, if it is finite.
struct CriticalTimes {
    times: [f64; 10],
    len: usize,
}

impl CriticalTimes {
    fn new(path: &Path, wall: &Segment, end: f64) -> Self {
        let mut critical = Self { times: [0.0; 10], len: 0 };
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
                // With the series of the arc tangent, the result for a straight path is the limit of the results for
                // curved paths.
                let ratio = a / b;
                critical.push_with_half_turns(ahead / (speed * b) * (1.0 - ratio * ratio / 3.0), omega, end);
            } else {
                critical.push_with_half_turns(math::atan2(a, b) / omega, omega, end);
            }
        }
        let along = wall.b - wall.a;
        if omega != 0.0 && along != DVec2::ZERO {
            critical.push_with_half_turns(math::atan2(along.dot(normal), along.dot(tangent)) / omega, omega, end);
        }
        if end < f64::INFINITY {
            critical.push(end, end);
        }
        critical.times[..critical.len].sort_by(f64::total_cmp);
        critical
    }

    /// Adds the instant `time`, which is within half a turn of the start, and the instants one and two half turns
    /// later, if they are on the path.
    fn push_with_half_turns(&mut self, time: f64, omega: f64, end: f64) {
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
