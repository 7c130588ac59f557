//! Time intervals in which a moving point is inside a region of the floor.

use glam::DVec2;

use super::section::{MotionSection, Smooth, find_zeros};
use crate::scene::Segment;
use crate::spec::Region;

/// Tolerance in metres for the rounding of poses: checks shift borders by 1 nm in favour of the checked body.
pub(super) const ROUNDING: f64 = 1e-9;

/// Squared distance between a moving point and a fixed segment, minus a squared reference distance.
pub(super) struct DistanceToSegment<'a> {
    pub section: &'a MotionSection,
    pub segment: Segment,
    pub squared_reference: f64,
}

impl Smooth for DistanceToSegment<'_> {
    fn at(&self, t: f64) -> (f64, f64) {
        let position = self.section.position(t);
        let offset = position - self.segment.nearest_point(position);
        (offset.length_squared() - self.squared_reference, 2.0 * offset.dot(self.section.velocity(t)))
    }

    fn curvature_bound(&self, t: f64, half: f64) -> f64 {
        let (speed, position) = (self.section.max_speed(t, half), self.section.position(t));
        let max_distance = (position - self.segment.nearest_point(position)).length() + speed * half;
        2.0 * (speed * speed + max_distance * self.section.max_acceleration())
    }
}

/// Squared distance between two moving points, minus a squared reference distance.
pub(super) struct DistanceBetween<'a> {
    pub sections: [&'a MotionSection; 2],
    pub squared_reference: f64,
}

impl Smooth for DistanceBetween<'_> {
    fn at(&self, t: f64) -> (f64, f64) {
        let [a, b] = self.sections;
        let (offset, rate) = (b.position(t) - a.position(t), b.velocity(t) - a.velocity(t));
        (offset.length_squared() - self.squared_reference, 2.0 * offset.dot(rate))
    }

    fn curvature_bound(&self, t: f64, half: f64) -> f64 {
        let [a, b] = self.sections;
        let max_acceleration = a.max_acceleration() + b.max_acceleration();
        let speed = (b.velocity(t) - a.velocity(t)).length() + max_acceleration * half;
        let max_distance = (b.position(t) - a.position(t)).length() + speed * half;
        2.0 * (speed * speed + max_distance * max_acceleration)
    }
}

/// A function times -1.
pub(super) struct Negated<F>(pub F);

impl<F: Smooth> Smooth for Negated<F> {
    fn at(&self, t: f64) -> (f64, f64) {
        let (value, slope) = self.0.at(t);
        (-value, -slope)
    }

    fn curvature_bound(&self, t: f64, half: f64) -> f64 {
        self.0.curvature_bound(t, half)
    }
}

/// Signed distance of a moving point from a line: positive to the left.
pub(super) struct DistanceToLine<'a> {
    pub section: &'a MotionSection,
    pub point: DVec2,
    /// Unit vector perpendicular to the line, to the left.
    pub normal: DVec2,
}

impl Smooth for DistanceToLine<'_> {
    fn at(&self, t: f64) -> (f64, f64) {
        let distance = (self.section.position(t) - self.point).dot(self.normal);
        (distance, self.section.velocity(t).dot(self.normal))
    }

    fn curvature_bound(&self, _: f64, _: f64) -> f64 {
        self.section.max_acceleration()
    }
}

/// Divides a section at the instants `breaks`, at which the value of `is_inside` may change. Returns the intervals
/// (start, end, value) in the order of time; successive intervals with equal values are one interval.
pub(super) fn intervals(
    section: &MotionSection,
    mut breaks: Vec<f64>,
    is_inside: impl Fn(f64) -> bool,
) -> Vec<(f64, f64, bool)> {
    breaks.push(section.to);
    breaks.sort_by(f64::total_cmp);
    let mut found: Vec<(f64, f64, bool)> = Vec::with_capacity(breaks.len());
    let mut from = section.from;
    for to in breaks {
        if to <= from {
            continue;
        }
        let inside = is_inside(0.5 * (from + to));
        match found.last_mut() {
            Some((_, end, last)) if *last == inside => *end = to,
            _ => found.push((from, to, inside)),
        }
        from = to;
    }
    found
}

/// Divides a section into intervals inside and outside `region`, whose border is shifted outwards by [`ROUNDING`].
pub(super) fn intervals_in(section: &MotionSection, region: &Region) -> Vec<(f64, f64, bool)> {
    let margin = ROUNDING;
    let mut breaks = Vec::new();
    match region {
        Region::Disc { centre, radius } => {
            let radius = radius + margin;
            let function = DistanceToSegment {
                section,
                segment: Segment::new(*centre, *centre),
                squared_reference: radius * radius,
            };
            find_zeros(&function, section.from, section.to, &mut breaks);
            intervals(section, breaks, |t| function.at(t).0 <= 0.0)
        }
        Region::Polygon(corners) => {
            for edge in edges(corners) {
                let along = edge.b - edge.a;
                let Some(normal) = along.perp().try_normalize() else { continue };
                for side in [-margin, margin] {
                    let line = DistanceToLine { section, point: edge.a + normal * side, normal };
                    find_zeros(&line, section.from, section.to, &mut breaks);
                }
            }
            intervals(section, breaks, |t| {
                let point = section.position(t);
                is_within(corners, point) || edges(corners).any(|edge| edge.distance(point) <= margin)
            })
        }
    }
}

/// Edges of a polygon.
pub(super) fn edges(corners: &[DVec2]) -> impl Iterator<Item = Segment> + '_ {
    (0..corners.len()).map(|index| Segment::new(corners[index], corners[(index + 1) % corners.len()]))
}

/// Returns true if `point` lies inside a polygon; counts the edges that a ray to the right crosses.
pub(super) fn is_within(corners: &[DVec2], point: DVec2) -> bool {
    let crossed = edges(corners).filter(|Segment { a, b }| {
        (a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
    });
    crossed.count() % 2 == 1
}
