//! The simulation: robots with their devices in one environment, advanced slot by slot.
//!
//! [`Robot`] is the state of one robot, and [`Environment`] the state that robots share. [`Simulation`] contains both
//! as one value, for callers that drive robots themselves. This module does not use programs, threads or files: the
//! host lets each robot act during the slot, at the robot's virtual time, and ends the slot.

mod actuator;
mod camera;
mod environment;
mod factory;
mod fault;
mod intervention;
mod placement;
mod robot;
mod roster;
mod station;
mod traffic;
mod value;

pub use environment::{Environment, SlotEnd};
pub use factory::{FactoryError, RobotFactory};
pub use fault::Faults;
pub use intervention::{Effect, Intervention, Refusal, Robots};
pub use placement::{Placeable, Placement};
pub use robot::{Robot, WalkRecord};
pub use roster::{MAX_OBJECTS, MAX_ROBOTS, Roster, Types};
pub use value::{DEFAULT_SLOT, Options, Simulation};
