//! One piece of motion: constant twist from a whole microsecond on, in closed form.

use super::model::Wheels;
use crate::{
    contact::Obstacle,
    pose::{Pose, Twist},
    time::Time,
};

/// Where a robot is and what its wheels have done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// True pose of the axle's midpoint in the world.
    pub world_from_axle: Pose,
    /// Pose of the axle that the robot believes in, in the frame of its odometry.
    pub odometry: Pose,
    /// Angles of the wheels since the start of the run, rad.
    pub wheels: Wheels,
    /// Length of the axle's true path since the start of the run, m.
    pub path: f64,
}

/// How fast a [`State`] changes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// True twist of the axle.
    pub truth: Twist,
    /// Twist that the wheels tell, with nominal diameters and no slip: drives end by it.
    pub belief: Twist,
    /// Twist that odometry integrates: `belief` with the noise of odometry.
    pub odometry: Twist,
    /// Rates of the wheels, rad/s.
    pub wheels: Wheels,
}

/// Why a piece ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// It does not end by itself.
    Open,
    /// The drive has reached its mark, having covered this displacement since the start of the piece.
    Arrived(Twist),
    /// The body has met an obstacle; `fresh` when it did not touch it already as the piece began.
    Impact {
        /// What it met.
        with: Obstacle,
        /// False for a contact that goes on.
        fresh: bool,
    },
}

/// Motion with constant rates from `start` until its end, then rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// When it was opened.
    pub start: Time,
    /// The state at `start`.
    pub state: State,
    /// The rates from `start` on.
    pub rates: Rates,
    /// Seconds from `start` to the end; may be infinite.
    pub after: f64,
    /// Why it ends.
    pub cause: Cause,
}

impl Piece {
    /// The state at `at`, not before `start`: a function of `at` alone.
    pub fn state(&self, at: Time) -> State {
        self.state_after((at - self.start).seconds())
    }

    /// The state `seconds` after the start.
    pub fn state_after(&self, seconds: f64) -> State {
        let seconds = seconds.clamp(0.0, self.after.max(0.0));
        let truth = self.covered(self.rates.truth, seconds);
        State {
            world_from_axle: self.state.world_from_axle.moved(truth),
            odometry: self.state.odometry.moved(self.covered(self.rates.odometry, seconds)),
            wheels: std::array::from_fn(|i| self.state.wheels[i] + self.rates.wheels[i] * seconds),
            path: self.state.path + truth.speed(),
        }
    }

    /// True pose of the axle at `at`, the same as in [`Piece::state`].
    pub fn world_from_axle(&self, at: Time) -> Pose {
        let seconds = (at - self.start).seconds().clamp(0.0, self.after.max(0.0));
        self.state.world_from_axle.moved(self.covered(self.rates.truth, seconds))
    }

    /// The displacement at one of the piece's `rates` in the `seconds` after the start, not beyond the end.
    pub(super) fn covered(&self, rate: Twist, seconds: f64) -> Twist {
        match self.cause {
            // The mark itself, not speed times time.
            Cause::Arrived(mark) if seconds >= self.after && rate == self.rates.belief => mark,
            _ => rate.scaled(seconds),
        }
    }

    /// True when the piece has come to its end at `at`.
    pub fn has_ended(&self, at: Time) -> bool {
        (at - self.start).seconds() >= self.after
    }

    /// The rates at `at`: rest after the end.
    pub fn rates(&self, at: Time) -> Rates {
        if self.has_ended(at) { Rates::default() } else { self.rates }
    }

    /// The first instant not before the end; [`Time::NEVER`] for a piece without one.
    pub fn end(&self) -> Time {
        self.start + Time::from_seconds_ceil(self.after)
    }
}
