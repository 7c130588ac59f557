//! How a robot moves: wheel kinematics, pieces of closed-form motion, and the chain of pieces that is a robot's motion.
//!
//! Everything is a function of virtual time in whole microseconds: no step, no slot length. Contact with static walls
//! belongs to the plan of a motion; contact with other robots is the world's business ([`crate::world`]).

mod command;
mod control;
mod hull;
mod imperfection;
pub mod legged;
mod model;
mod motion;
mod piece;
mod stage;

pub use command::{Command, CommandError, arc_to};
pub use control::{Gains, Pid};
pub use hull::{Drag, Hull};
pub use imperfection::{ContactRule, Imperfection};
pub use model::{DriveKind, Model, ModelError, Wheels};
pub use motion::{Impact, Motion};
pub(crate) use motion::{Passage, Thrust};
pub use piece::{Cause, Piece, Rates, State};

use crate::time::Time;

/// How far back a motion and the world remember.
pub const HISTORY: Time = Time::from_millis(100);
