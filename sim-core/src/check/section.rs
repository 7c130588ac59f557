//! Motion of a body as sections in closed form.

use glam::DVec2;

use crate::contact::{Pace, Path};
use crate::drive::Passage;
use crate::pose::Heading;
use crate::time::Time;

/// Motion of a point of a body on one path over a time interval. Times are absolute, in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MotionSection {
    /// First instant of the section.
    pub from: f64,
    /// Last instant of the section.
    pub to: f64,
    /// Instant at which the path starts.
    origin: f64,
    path: Path,
    /// Offset of the point from the path's point, forwards, m.
    forward_offset: f64,
    /// Heading of the body at `origin`; unused if `forward_offset` is 0.
    heading: Heading,
}

impl MotionSection {
    /// A section at rest at `position`.
    pub fn resting(position: DVec2, from: f64, to: f64) -> Self {
        Self { from, to, origin: from, path: Path::resting(position), forward_offset: 0.0, heading: Heading::new(0.0) }
    }

    /// Motion along `path`, which starts at `origin`.
    pub fn on_path(path: Path, origin: f64, (from, to): (f64, f64)) -> Self {
        Self { from, to, origin, path, forward_offset: 0.0, heading: Heading::new(0.0) }
    }

    /// Appends to `sections` the motion on successive passages from `from` to `to`, for the point that is
    /// `forward_offset` metres in front of the centre.
    pub fn append(sections: &mut Vec<Self>, passages: &[Passage], (from, to): (Time, Time), forward_offset: f64) {
        let origin = |passage: &Passage| passage.start.seconds() + passage.begin;
        let (from, to) = (from.seconds(), to.seconds());
        for (index, passage) in passages.iter().enumerate() {
            let start = origin(passage);
            let next = passages.get(index + 1).map_or(to, |next| origin(next).min(to));
            let begin = from.max(start);
            if begin >= next {
                continue;
            }
            if index == 0 && from < begin {
                push(sections, Self::resting(passage.path.position(0.0), from, begin));
            }
            let end = (passage.start.seconds() + passage.end).min(next);
            let heading = passage.heading.turned(passage.path.omega() * passage.begin);
            let is_moving = !passage.path.is_resting() || forward_offset != 0.0 && passage.path.omega() != 0.0;
            let moving = Self { from: begin, to: end, origin: start, path: passage.path, forward_offset, heading };
            if is_moving && begin < end {
                push(sections, moving);
            }
            let rest_position_time = if is_moving { end.max(start) } else { start };
            let rest_start = if is_moving { begin.max(end) } else { begin };
            if rest_start < next {
                push(sections, Self::resting(moving.position(rest_position_time), rest_start, next));
            }
        }
    }

    /// Position of the point at `t`, in the world.
    pub fn position(&self, t: f64) -> DVec2 {
        let seconds = t - self.origin;
        let position = self.path.position(seconds);
        if self.forward_offset == 0.0 { position } else { position + self.offset_vector(seconds) }
    }

    /// Velocity of the point at `t`, in the world, m/s.
    pub fn velocity(&self, t: f64) -> DVec2 {
        let seconds = t - self.origin;
        let velocity = if self.path.is_resting() { DVec2::ZERO } else { self.path.velocity(seconds) };
        if self.forward_offset == 0.0 {
            velocity
        } else {
            velocity + self.offset_vector(seconds).perp() * self.path.omega()
        }
    }

    fn offset_vector(&self, seconds: f64) -> DVec2 {
        self.heading.turned(self.path.omega() * seconds).direction() * self.forward_offset
    }

    /// Returns true if the point is at rest throughout the section.
    pub fn is_resting(&self) -> bool {
        self.path.is_resting() && (self.forward_offset == 0.0 || self.path.omega() == 0.0)
    }

    /// Upper bound of the point's acceleration, m/s^2.
    pub fn max_acceleration(&self) -> f64 {
        let path = if self.path.is_resting() { 0.0 } else { self.path.acceleration() };
        path + self.forward_offset.abs() * self.path.omega() * self.path.omega()
    }

    /// Upper bound of the point's speed within `half` seconds of `t`, m/s.
    pub fn max_speed(&self, t: f64, half: f64) -> f64 {
        self.velocity(t).length() + self.max_acceleration() * half
    }

    /// Length of the path from `from` to `to`, m.
    pub fn length(&self, from: f64, to: f64) -> f64 {
        match self.path.pace {
            _ if self.path.is_resting() => 0.0,
            Pace::ConstantTwist => self.path.speed() * (to - from),
            Pace::Sliding { law, .. } => (law.length(to - self.origin) - law.length(from - self.origin)).abs(),
        }
    }

    /// The part from `from` to `to`, which must be within the section.
    pub fn part(&self, from: f64, to: f64) -> Self {
        Self { from, to, ..*self }
    }

    /// Centre and radius of a disc that contains the section.
    pub fn surrounding_disc(&self) -> (DVec2, f64) {
        let (middle, half) = (0.5 * (self.from + self.to), 0.5 * (self.to - self.from));
        (self.position(middle), self.max_speed(middle, half) * half)
    }

    /// This motion, rotated by `rotation` (a unit vector) about the world's origin, then moved by `shift`.
    pub fn transformed(&self, rotation: DVec2, shift: DVec2) -> Self {
        let path = Path {
            origin: rotation.rotate(self.path.origin) + shift,
            direction: rotation.rotate(self.path.direction),
            ..self.path
        };
        Self { path, ..*self }
    }

    /// Returns true if `next` continues this section on the same path.
    fn continues_in(&self, next: &Self) -> bool {
        let is_same = self.path == next.path && self.forward_offset == next.forward_offset;
        is_same && (self.origin == next.origin && self.heading == next.heading || self.is_resting())
    }
}

/// Appends `section`, or extends the last section if `section` continues it. Sections therefore do not depend on the
/// slots in which they were observed.
pub(super) fn push(sections: &mut Vec<MotionSection>, section: MotionSection) {
    match sections.last_mut() {
        Some(last) if last.to == section.from && last.continues_in(&section) => last.to = section.to,
        _ => sections.push(section),
    }
}

/// Removes the motion before `until` from `sections` and returns it; a section across `until` is split.
pub(super) fn take_until(sections: &mut Vec<MotionSection>, until: f64) -> Vec<MotionSection> {
    let mut taken: Vec<MotionSection> = Vec::new();
    let complete = sections.partition_point(|section| section.to <= until);
    taken.extend(sections.drain(..complete));
    if let Some(first) = sections.first_mut().filter(|first| first.from < until) {
        taken.push(first.part(first.from, until));
        first.from = until;
    }
    taken
}

/// Function of time with a bounded second derivative, for [`find_zeros`] and [`find_minimum`].
pub(super) trait Smooth {
    /// Value and first derivative at `t`.
    fn at(&self, t: f64) -> (f64, f64);

    /// Upper bound of the second derivative's absolute value within `half` of `t`.
    fn curvature_bound(&self, t: f64, half: f64) -> f64;
}

/// Half of the shortest interval, in seconds, that the search for zeros divides; closer zeros are found as one.
const MIN_HALF_INTERVAL: f64 = 5e-7;

/// Appends the zeros of `function` between `from` and `to` to `zeros`, in ascending order.
///
/// The value and slope at the midpoint of an interval and the bound of the second derivative may prove that the
/// interval contains no zero, or that the function is monotonic in the interval. All other intervals are halved. The
/// search misses no zero, except pairs of zeros closer than a microsecond.
pub(super) fn find_zeros(function: &impl Smooth, from: f64, to: f64, zeros: &mut Vec<f64>) {
    let (half, middle) = (0.5 * (to - from), 0.5 * (from + to));
    if half <= 0.0 {
        return;
    }
    let (value, slope) = function.at(middle);
    let curvature_bound = function.curvature_bound(middle, half);
    let max_change = slope.abs() * half + 0.5 * curvature_bound * half * half;
    if value.abs() > max_change || max_change == 0.0 {
        return;
    }
    if slope.abs() > curvature_bound * half {
        let (first, last) = (function.at(from).0, function.at(to).0);
        if (first < 0.0) != (last < 0.0) {
            zeros.push(bisect(function, from, to, first < 0.0));
        }
    } else if half < MIN_HALF_INTERVAL {
        zeros.push(middle);
    } else {
        find_zeros(function, from, middle, zeros);
        find_zeros(function, middle, to, zeros);
    }
}

/// The first `f64` at which a monotonic function has changed its sign, by bisection.
fn bisect(function: &impl Smooth, mut from: f64, mut to: f64, is_rising: bool) -> f64 {
    loop {
        let middle = 0.5 * (from + to);
        if middle <= from || middle >= to {
            return to;
        }
        if (function.at(middle).0 < 0.0) == is_rising { from = middle } else { to = middle }
    }
}

/// Finds the minimum of `function` between `from` and `to`, up to `tolerance`. Replaces `best`, a pair (value,
/// instant), if the minimum is lower.
pub(super) fn find_minimum(function: &impl Smooth, (from, to): (f64, f64), best: &mut (f64, f64), tolerance: f64) {
    let (half, middle) = (0.5 * (to - from), 0.5 * (from + to));
    let (value, slope) = function.at(middle);
    for t in [from, middle, to] {
        let value = if t == middle { value } else { function.at(t).0 };
        if value < best.0 {
            *best = (value, t);
        }
    }
    let curvature_bound = function.curvature_bound(middle, half);
    let lower_bound = value - slope.abs() * half - 0.5 * curvature_bound * half * half;
    if lower_bound >= best.0 - tolerance || half < MIN_HALF_INTERVAL {
        return;
    }
    find_minimum(function, (from, middle), best, tolerance);
    find_minimum(function, (middle, to), best, tolerance);
}
