//! Motion of a body that was observed but not yet evaluated by the checks.

use glam::DVec2;

use super::section::{MotionSection, push, take_until};
use crate::contact::Path;
use crate::drive::{Motion, Passages};
use crate::pose::{Pose, Twist};
use crate::time::Time;
use crate::world::ObjectStep;

/// Motion of a body that was observed but not yet evaluated.
#[derive(Clone, Debug)]
pub(super) struct PendingMotion {
    radius: f64,
    /// Motion of the centre, without gaps.
    body: Vec<MotionSection>,
    /// Instant up to which the motion is known, s.
    known_until: f64,
    /// Position at that instant.
    position: DVec2,
    odometry: Option<Box<PendingOdometry>>,
}

/// Motion of a robot's axle: the true one and the one that odometry computes.
#[derive(Clone, Debug)]
struct PendingOdometry {
    /// Offset of the axle from the centre, forwards, m.
    forward_offset: f64,
    truth: Vec<MotionSection>,
    /// The motion that odometry computes, in the world frame.
    estimate: Vec<MotionSection>,
    /// Rotation (a unit vector) and translation from the odometry frame to the world frame.
    world_from_odometry: (DVec2, DVec2),
    /// True once the program has set its odometry, which fixes the odometry frame.
    is_anchored: bool,
    /// True position and odometry's position at the end of the known motion, world frame.
    last_positions: [DVec2; 2],
}

/// Motion of one body over a time interval.
#[derive(Clone, Debug)]
pub(super) struct BodyMotion {
    /// Radius of the body, m; 0 for an object.
    pub radius: f64,
    /// Motion of its centre.
    pub body: Vec<MotionSection>,
    /// True motion of its axle and the one that odometry computes; empty if odometry is not checked.
    pub axle: [Vec<MotionSection>; 2],
}

impl PendingMotion {
    /// Pending motion of a body at rest from `since` on.
    pub fn resting(position: DVec2, radius: f64, since: Time) -> Self {
        Self { radius, body: Vec::new(), known_until: since.seconds(), position, odometry: None }
    }

    /// Pending motion of a robot that is first observed in a slot that starts at `from`.
    pub fn of_robot(motion: &mut Motion, from: Time, needs_odometry: bool) -> Self {
        let pending = Self::resting(motion.pose(from).position, motion.radius(), from);
        let odometry = needs_odometry.then(|| {
            let state = motion.state(from);
            let frame_transform = world_from_odometry(&state.world_from_axle, &state.odometry);
            let position = state.world_from_axle.position;
            Box::new(PendingOdometry {
                forward_offset: motion.model().axis_offset,
                truth: Vec::new(),
                estimate: Vec::new(),
                world_from_odometry: frame_transform,
                is_anchored: false,
                last_positions: [position; 2],
            })
        });
        Self { odometry, ..pending }
    }

    /// Appends the motion of a robot from `from` to `to`.
    pub fn append_robot(&mut self, motion: &mut Motion, (from, to): (Time, Time)) {
        self.rest_until(from);
        let mut passages = Passages::new();
        motion.passages(from, to, &mut passages);
        MotionSection::append(&mut self.body, &passages, (from, to), 0.0);
        if let Some(odometry) = &mut self.odometry {
            MotionSection::append(&mut odometry.truth, &passages, (from, to), odometry.forward_offset);
            odometry.append_robot(motion, (from, to));
        }
        self.set_end(to.seconds());
    }

    /// Appends the motion of an object in one step.
    pub fn append_step(&mut self, step: &ObjectStep) {
        let to = step.end.seconds();
        let from = if step.is_jump { to } else { step.start.seconds() };
        self.rest_until(step.start.max(Time::from_seconds_ceil(self.known_until)));
        if from < to && step.from != step.to && self.known_until <= from {
            let velocity = (step.to - step.from) / (to - from);
            let twist = Twist { vx: velocity.x, vy: velocity.y, omega: 0.0 };
            let path = Path { twist, ..Path::new(&Pose::new(step.from.x, step.from.y, 0.0), twist) };
            push(&mut self.body, MotionSection::on_path(path, from, (from, to)));
            self.known_until = to;
        }
        self.position = step.to;
    }

    /// Keeps the body at rest until `until`.
    pub fn rest_until(&mut self, until: Time) {
        let until = until.seconds();
        if self.known_until >= until {
            return;
        }
        push(&mut self.body, MotionSection::resting(self.position, self.known_until, until));
        if let Some(odometry) = &mut self.odometry {
            let [truth, estimate] = odometry.last_positions;
            push(&mut odometry.truth, MotionSection::resting(truth, self.known_until, until));
            push(&mut odometry.estimate, MotionSection::resting(estimate, self.known_until, until));
        }
        self.known_until = until;
    }

    /// Returns true if the body is at rest during all motion that is not yet evaluated.
    pub fn is_at_rest(&self) -> bool {
        let is_resting =
            |sections: &[MotionSection]| sections.len() <= 1 && sections.iter().all(MotionSection::is_resting);
        let odometry = self.odometry.as_ref();
        is_resting(&self.body)
            && odometry.is_none_or(|odometry| is_resting(&odometry.truth) && is_resting(&odometry.estimate))
    }

    /// Removes and returns the motion before `until`, s.
    pub fn take_until(&mut self, until: f64) -> BodyMotion {
        let axle = match &mut self.odometry {
            Some(odometry) => [take_until(&mut odometry.truth, until), take_until(&mut odometry.estimate, until)],
            None => [Vec::new(), Vec::new()],
        };
        BodyMotion { radius: self.radius, body: take_until(&mut self.body, until), axle }
    }

    /// Ends the known motion at `to`.
    fn set_end(&mut self, to: f64) {
        let last_position = |sections: &[MotionSection]| sections.last().map(|section| section.position(to));
        self.position = last_position(&self.body).unwrap_or(self.position);
        self.known_until = to;
        if let Some(odometry) = &mut self.odometry {
            let [truth, estimate] = odometry.last_positions;
            odometry.last_positions = [
                last_position(&odometry.truth).unwrap_or(truth),
                last_position(&odometry.estimate).unwrap_or(estimate),
            ];
        }
    }
}

impl PendingOdometry {
    /// Appends the motion that odometry computes. The first call that sets the odometry fixes the odometry frame in the
    /// world. Later calls are corrections, which the check treats as part of the odometry.
    fn append_robot(&mut self, motion: &mut Motion, (from, to): (Time, Time)) {
        let first_setting = motion.odometry_set().filter(|_| !self.is_anchored);
        let Some((at, pose)) = first_setting.filter(|(at, _)| *at < to) else {
            return self.append(motion, (from, to));
        };
        if from < at {
            self.append(motion, (from, at));
        }
        let axle = motion.state(at).world_from_axle;
        (self.world_from_odometry, self.is_anchored) = (world_from_odometry(&axle, &pose), true);
        self.append(motion, (at.max(from), to));
    }

    fn append(&mut self, motion: &mut Motion, times: (Time, Time)) {
        let mut passages = Passages::new();
        motion.odometry_passages(times.0, times.1, &mut passages);
        let mut sections = Vec::new();
        MotionSection::append(&mut sections, &passages, times, 0.0);
        let (turn, shift) = self.world_from_odometry;
        sections.iter().for_each(|section| push(&mut self.estimate, section.transformed(turn, shift)));
    }
}

/// Rotation and translation from the odometry frame to the world frame that take the odometry pose of the axle to its
/// true pose.
fn world_from_odometry(world_from_axle: &Pose, odometry: &Pose) -> (DVec2, DVec2) {
    let turn = world_from_axle.heading.turned(-odometry.heading.remainder()).direction();
    (turn, world_from_axle.position - turn.rotate(odometry.position))
}
