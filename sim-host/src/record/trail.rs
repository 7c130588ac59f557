//! Trails of robots and objects: polylines that approximate paths in bounded memory.

use std::collections::VecDeque;

use glam::DVec2;
use sim_core::ObjectId;
use sim_core::build;
use sim_core::math;
use sim_core::pose::Pose;
use sim_core::spec::SceneSpec;
use sim_core::time::Time;

use super::sink::{RecordError, Sink};
use sim_core::record::{Digest, Event, Kind, KindSet, Record};

/// Initial tolerance of a trail, in metres.
const TOLERANCE: f64 = 1e-3;

/// Maximum number of points of a trail; a longer trail is simplified again, with twice the tolerance.
const MAX_POINTS: usize = 4096;

/// A polyline that stays within [`Self::deviation`] of every pushed position.
///
/// Positions since the last corner are not stored. Instead, the trail stores the sector of directions in which a
/// segment passes all of them within the tolerance (cone intersection, Sklansky & Gonzalez 1980). The tolerance is 1 mm
/// and doubles when the trail exceeds 4096 points.
#[derive(Clone, Debug)]
pub struct Trail {
    corners: Vec<DVec2>,
    /// The last position, at the end of the open segment.
    last: DVec2,
    tolerance: f64,
    segment: Option<Sector>,
}

/// Constraints on the open segment of a trail, as seen from its corner.
#[derive(Clone, Copy, Debug)]
struct Sector {
    /// Unit vector from which angles are measured.
    axis: DVec2,
    /// Angles between which the segment must lie, rad.
    angles: (f64, f64),
    /// Maximum distance of the segment's positions from the corner, m.
    max_distance: f64,
}

impl Trail {
    /// Creates the trail that begins at `start`, in metres.
    pub fn new(start: DVec2) -> Self {
        Self::with_tolerance(start, TOLERANCE)
    }

    fn with_tolerance(start: DVec2, tolerance: f64) -> Self {
        Self { corners: vec![start], last: start, tolerance, segment: None }
    }

    /// Continues the trail to `position`, in metres.
    pub fn push(&mut self, position: DVec2) {
        let corner = self.corners[self.corners.len() - 1];
        match self.extend_segment(position - corner) {
            Ok(segment) => self.segment = segment,
            Err(CornerNeeded) => {
                self.corners.push(self.last);
                self.segment = None;
                self.segment = self.extend_segment(position - self.last).unwrap_or(None);
            }
        }
        self.last = position;
        if self.corners.len() > MAX_POINTS {
            self.simplify();
        }
    }

    /// Points of the polyline: the first position, the corners, the last position.
    pub fn points(&self) -> Vec<DVec2> {
        self.corners
            .iter()
            .copied()
            .chain((self.last != self.corners[self.corners.len() - 1]).then_some(self.last))
            .collect()
    }

    /// Maximum distance of the polyline from a pushed position, in metres.
    pub fn deviation(&self) -> f64 {
        // Each simplification adds its tolerance to the earlier ones; the sum of this geometric series is less than
        // twice the last tolerance. A point beyond the end of a segment may deviate by one tolerance along the segment
        // and one across it.
        2.0 * std::f64::consts::SQRT_2 * self.tolerance
    }

    /// The open segment, extended to the position at `offset` from its corner; [`CornerNeeded`] if the segment cannot
    /// pass this position.
    fn extend_segment(&self, offset: DVec2) -> Result<Option<Sector>, CornerNeeded> {
        let distance = math::hypot(offset.x, offset.y);
        let Some(sector) = self.segment else {
            let width = self.tolerance / distance;
            let is_near = distance <= self.tolerance;
            return Ok((!is_near).then(|| Sector {
                axis: offset / distance,
                angles: (-width, width),
                max_distance: distance,
            }));
        };
        if distance < sector.max_distance - self.tolerance {
            return Err(CornerNeeded);
        }
        let angle = math::atan2(sector.axis.perp_dot(offset), sector.axis.dot(offset));
        let (low, high) = sector.angles;
        if !(low..=high).contains(&angle) {
            return Err(CornerNeeded);
        }
        // The sine of an angle is less than the angle, so this width is conservative.
        let width = self.tolerance / distance;
        let angles = (low.max(angle - width), high.min(angle + width));
        Ok(Some(Sector { angles, max_distance: sector.max_distance.max(distance), ..sector }))
    }

    /// Doubles the tolerance until the number of corners is at most three quarters of `MAX_POINTS`.
    fn simplify(&mut self) {
        while self.corners.len() > MAX_POINTS / 4 * 3 {
            let mut simplified = Self::with_tolerance(self.corners[0], 2.0 * self.tolerance);
            self.points().into_iter().skip(1).for_each(|point| simplified.push(point));
            *self = simplified;
        }
    }
}

/// Error: the open segment cannot be extended, and a corner is needed.
struct CornerNeeded;

/// Maximum number of trails kept for a body that is placed repeatedly; the latest ones are kept.
const MAX_TRAILS: usize = 64;

/// Trails of one body: a new trail begins each time the body is placed.
#[derive(Clone, Debug)]
pub struct BodyTrails {
    trails: VecDeque<Trail>,
}

impl BodyTrails {
    fn new(start: DVec2) -> Self {
        Self { trails: VecDeque::from([Trail::new(start)]) }
    }

    /// Continues the latest trail to `position`, in metres.
    fn push(&mut self, position: DVec2) {
        if let Some(trail) = self.trails.back_mut() {
            trail.push(position);
        }
    }

    /// Starts a new trail at `position`, in metres.
    fn restart_at(&mut self, position: DVec2) {
        if self.trails.len() == MAX_TRAILS {
            self.trails.pop_front();
        }
        self.trails.push_back(Trail::new(position));
    }

    /// Points of each trail; the trails are in order of time.
    pub fn lines(&self) -> Vec<Vec<DVec2>> {
        self.trails.iter().map(Trail::points).collect()
    }
}

/// Sink that collects the trails of all bodies and the points of contact.
#[derive(Clone, Debug)]
pub struct Trails {
    trails: Vec<BodyTrails>,
    objects: Vec<BodyTrails>,
    contacts: Vec<DVec2>,
}

impl Trails {
    /// Trails of the robots and movable objects of `scene`.
    pub fn of_scene(scene: &SceneSpec) -> Self {
        let starts: Vec<Pose> = scene.robots.iter().map(|robot| robot.start).collect();
        let objects: Vec<Pose> = build::movable_objects(scene).map(|object| object.pose).collect();
        Self::new(&starts, &objects)
    }

    /// Trails from the starting poses of robots and movable objects, in order of their ids.
    pub fn new(robots: &[Pose], objects: &[Pose]) -> Self {
        let trails = |starts: &[Pose]| starts.iter().map(|start| BodyTrails::new(start.position)).collect();
        Self { trails: trails(robots), objects: trails(objects), contacts: Vec::new() }
    }

    /// The trails of the movable objects in order of their ids.
    pub fn objects(&self) -> &[BodyTrails] {
        &self.objects
    }

    /// The trails in order of the robots' ids.
    pub fn trails(&self) -> &[BodyTrails] {
        &self.trails
    }

    /// Points of contact, in metres; points within 1 cm of the previous point are omitted.
    pub fn contacts(&self) -> &[DVec2] {
        &self.contacts
    }
}

/// Continues the trail of a body, or starts the trail of a spawned body.
fn push(bodies: &mut Vec<BodyTrails>, index: usize, position: DVec2) {
    match bodies.get_mut(index) {
        Some(trail) => trail.push(position),
        None => bodies.push(BodyTrails::new(position)),
    }
}

impl Sink for Trails {
    fn interest(&self) -> KindSet {
        KindSet::of(&[Kind::Pose, Kind::Object, Kind::Placed, Kind::ObjectPlaced, Kind::Contact])
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        match record.event {
            Event::Pose { x_m, y_m, .. } => {
                push(&mut self.trails, record.robot.index(), DVec2::new(x_m, y_m));
            }
            Event::Object { object, x_m, y_m, .. } => {
                push(&mut self.objects, ObjectId(object).index(), DVec2::new(x_m, y_m));
            }
            Event::Placed { x_m, y_m, .. } => {
                if let Some(trail) = self.trails.get_mut(record.robot.index()) {
                    trail.restart_at(DVec2::new(x_m, y_m));
                }
            }
            Event::ObjectPlaced { object, x_m, y_m, .. } => {
                if let Some(trail) = self.objects.get_mut(ObjectId(object).index()) {
                    trail.restart_at(DVec2::new(x_m, y_m));
                }
            }
            Event::Contact { x_m, y_m, .. } => {
                let point = DVec2::new(x_m, y_m);
                if self.contacts.last().is_none_or(|last| last.distance_squared(point) > 1e-4) {
                    self.contacts.push(point);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance of `point` from the nearest segment of `line`, brute force.
    fn distance(line: &[DVec2], point: DVec2) -> f64 {
        let to_segment = |pair: &[DVec2]| {
            let along = pair[1] - pair[0];
            let t = ((point - pair[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            point.distance(pair[0] + along * t)
        };
        line.windows(2).map(to_segment).fold(line[0].distance(point), f64::min)
    }

    fn trail_of(points: &[DVec2]) -> Trail {
        let mut trail = Trail::new(points[0]);
        points[1..].iter().for_each(|point| trail.push(*point));
        trail
    }

    #[test]
    fn straight_line_has_two_points() {
        let points: Vec<_> = (0..=1000).map(|i| DVec2::new(0.01 * f64::from(i), 0.02 * f64::from(i))).collect();
        assert_eq!(trail_of(&points).points(), [points[0], points[1000]]);
    }

    #[test]
    fn square_keeps_its_corners() {
        let side = |from: DVec2, by: DVec2| (1..=50).map(move |i| from + by * f64::from(i) / 50.0);
        let mut points = vec![DVec2::ZERO];
        for by in [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y] {
            points.extend(side(points[points.len() - 1], by).collect::<Vec<_>>());
        }
        let trail = trail_of(&points).points();
        assert_eq!(trail.len(), 5, "{trail:?}");
        assert!(trail[2].distance(DVec2::ONE) < 1e-12, "{trail:?}");
    }

    #[test]
    fn turning_point_is_kept() {
        let there = (0..=100).map(|i| DVec2::new(0.01 * f64::from(i), 0.0));
        let points: Vec<_> = there.clone().chain(there.rev()).collect();
        let trail = trail_of(&points).points();
        assert!(trail.iter().any(|point| point.x > 1.0 - TOLERANCE), "{trail:?}");
        assert!(trail.len() <= 3, "{trail:?}");
    }

    #[test]
    fn trail_is_within_the_tolerance_of_every_position() {
        // A curve with loops and cusps: an epitrochoid that drifts.
        let at = |i: i32| {
            let t = 0.003 * f64::from(i);
            let small = 0.2 * DVec2::new(math::cos(7.0 * t), math::sin(7.0 * t));
            DVec2::new(math::cos(t), math::sin(t)) + small + DVec2::new(0.01 * t, 0.0)
        };
        let points: Vec<_> = (0..6000).map(at).collect();
        let trail = trail_of(&points);
        let line = trail.points();
        assert!(line.len() < 1500, "{} points", line.len());
        for point in points {
            assert!(distance(&line, point) <= trail.deviation(), "{point} is {} m off", distance(&line, point));
        }
    }

    #[test]
    fn long_trail_has_bounded_size_and_deviation() {
        let mut random = 1_u64;
        let mut step = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 40) as f64 / (1 << 24) as f64 - 0.5
        };
        let mut position = DVec2::ZERO;
        let mut points = vec![position];
        for _ in 0..30_000 {
            position += 0.05 * DVec2::new(step(), step());
            points.push(position);
        }
        let trail = trail_of(&points);
        let line = trail.points();
        assert!(line.len() <= MAX_POINTS + 1, "{} points", line.len());
        assert!(trail.deviation() > 2.0 * TOLERANCE, "the test must reach the limit");
        for point in points.into_iter().step_by(37) {
            assert!(distance(&line, point) <= trail.deviation(), "{point}");
        }
    }

    #[test]
    fn placing_a_body_begins_a_new_trail() {
        let mut trail = BodyTrails::new(DVec2::ZERO);
        trail.push(DVec2::X);
        trail.restart_at(DVec2::new(5.0, 5.0));
        trail.push(DVec2::new(5.0, 6.0));
        assert_eq!(trail.lines(), [vec![DVec2::ZERO, DVec2::X], vec![DVec2::new(5.0, 5.0), DVec2::new(5.0, 6.0)]]);
        (0..100).for_each(|_| trail.restart_at(DVec2::ZERO));
        assert_eq!(trail.lines().len(), MAX_TRAILS);
    }

    #[test]
    fn robot_at_rest_has_one_point() {
        let points = [DVec2::ONE; 10];
        assert_eq!(trail_of(&points).points(), [DVec2::ONE]);
    }
}
