//! Motion of a robot: kinematics of wheels, pieces of closed-form motion, and the chain of pieces that follows a
//! robot's commands.
//!
//! All motion is a function of virtual time in whole microseconds, in pieces of closed form, and does not depend on the
//! slot length. Only wheel lag, controllers, random errors and hulls advance in ticks. This module finds contacts with
//! static walls; [`crate::world`] finds contacts with robots and objects.

mod command;
mod control;
mod hull;
mod imperfection;
pub mod legged;
mod model;
mod motion;
mod piece;
mod rare;
mod stage;

pub use command::{Command, CommandError, arc_to};
pub use control::{Gains, Pid};
pub use hull::{Drag, Hull};
pub use imperfection::{ContactRule, Imperfection};
pub use model::{DriveKind, Model, ModelError, Wheels};
pub(crate) use motion::{DriveState, Passage, Passages};
pub use motion::{Impact, Motion};
pub use piece::{Cause, Piece, Rates, State};

use crate::time::Time;

/// Length of the past for which motions and the world can be queried.
pub const HISTORY: Time = Time::from_millis(100);
