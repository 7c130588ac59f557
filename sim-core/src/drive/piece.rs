//! One piece of motion: motion at constant twist, in closed form, that starts at a whole microsecond.

use glam::DVec2;

use super::model::Wheels;
use crate::{
    contact::Obstacle,
    pose::{Pose, Twist},
    time::Time,
};

/// Poses of a robot, and the wheel angles and the path length covered so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// True pose of the axle's midpoint in the world.
    pub world_from_axle: Pose,
    /// Pose of the axle's midpoint according to odometry, in the frame of odometry.
    pub odometry: Pose,
    /// Angles of the wheels since the start of the run, rad.
    pub wheels: Wheels,
    /// Length of the axle's true path since the start of the run, m.
    pub path_length: f64,
}

/// Rates of change of a [`State`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// True twist of the axle.
    pub truth: Twist,
    /// Twist computed from the wheels with nominal diameters and no slip. A drive ends when motion at this twist has
    /// covered its displacement.
    pub nominal: Twist,
    /// Twist that odometry integrates: `nominal` plus the noise of odometry.
    pub odometry: Twist,
    /// Rates of the wheels, rad/s.
    pub wheels: Wheels,
}

/// Reason why a piece ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The piece lasts until another piece replaces it.
    Open,
    /// The drive reaches its target. The value is its displacement from the start of the piece.
    Arrived(Twist),
    /// The body touches an obstacle.
    Impact {
        /// The obstacle.
        with: Obstacle,
        /// False if the body touched the obstacle already when the piece began.
        fresh: bool,
    },
}

/// Motion with constant rates from `start` until its end, then rest. The fields are laid out in this order.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Piece {
    /// Start of the piece.
    pub start: Time,
    /// Seconds from `start` to the end; can be infinite.
    pub duration: f64,
    /// The state at `start`.
    pub state: State,
    /// The rates from `start` on.
    pub rates: Rates,
    /// Reason why the piece ends.
    pub cause: Cause,
}

impl Piece {
    /// The state at `at`, which must not be before `start`. The result depends only on the piece and `at`.
    pub fn state(&self, at: Time) -> State {
        self.state_after((at - self.start).seconds(), self.state.world_from_axle.heading.direction())
    }

    /// The state `seconds` after the start; `forward` is the unit vector of the axle's heading at the start.
    pub(super) fn state_after(&self, seconds: f64, forward: DVec2) -> State {
        let seconds = seconds.clamp(0.0, self.duration.max(0.0));
        State {
            world_from_axle: self.world_from_axle_after(seconds, forward),
            odometry: self.state.odometry.moved(self.covered(self.rates.odometry, seconds)),
            wheels: std::array::from_fn(|i| self.state.wheels[i] + self.rates.wheels[i] * seconds),
            path_length: self.state.path_length + self.covered(self.rates.truth, seconds).speed(),
        }
    }

    /// True pose of the axle at `at`, equal to the pose in [`Piece::state`].
    pub fn world_from_axle(&self, at: Time) -> Pose {
        let seconds = (at - self.start).seconds().clamp(0.0, self.duration.max(0.0));
        self.world_from_axle_after(seconds, self.state.world_from_axle.heading.direction())
    }

    /// True pose of the axle `seconds` after the start, but not after the end; `forward` is the unit vector of the
    /// axle's heading at the start.
    pub(super) fn world_from_axle_after(&self, seconds: f64, forward: DVec2) -> Pose {
        self.state.world_from_axle.moved_along(forward, self.covered(self.rates.truth, seconds))
    }

    /// Displacement at `twist`, one of the piece's twists, in the first `seconds` of the piece, at most until its end.
    pub(super) fn covered(&self, twist: Twist, seconds: f64) -> Twist {
        match self.cause {
            // The displacement of the drive is exact; twist times duration would round.
            Cause::Arrived(displacement) if seconds >= self.duration && twist == self.rates.nominal => displacement,
            _ => twist.scaled(seconds),
        }
    }

    /// Returns true if the piece has ended at `at`.
    pub fn has_ended(&self, at: Time) -> bool {
        (at - self.start).seconds() >= self.duration
    }

    /// The rates at `at`: zero after the end.
    pub fn rates(&self, at: Time) -> Rates {
        if self.has_ended(at) { Rates::default() } else { self.rates }
    }

    /// End of the piece, rounded up to a microsecond; [`Time::NEVER`] for a piece without end.
    pub fn end(&self) -> Time {
        self.start + Time::from_seconds_ceil(self.duration)
    }
}
