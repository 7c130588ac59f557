//! Maps from range sensors, for robot programs.
//!
//! The library is independent of robots and simulators: poses and readings go in, maps come out. Lengths in metres,
//! angles in radians counter-clockwise, `f64`. The same input gives the same bits on every platform.

#![warn(missing_docs)]
#![forbid(unsafe_code)]

pub mod astar;
pub mod distance;
pub mod grid;
pub mod inverse;
pub mod line;
pub mod local_map;
pub mod localise;
pub mod log_odds;
pub mod math;
pub mod measurement;
pub mod occupancy;
pub mod pose;
pub mod rls;
pub mod score;
pub mod sector;
pub mod sonar;
pub mod sonar_grid;
pub mod tracker;
pub mod tsk;
