//! Simulation of mobile robots as a pure library: no files, threads, clock or `unsafe`, and independent of RoBIOS.
//!
//! [`Simulation`](simulation::Simulation) is a whole simulation as one value: the owner steps it, commands its robots,
//! reads their devices, renders the images of their cameras, clones it as a snapshot and restores it. The parts can be
//! used on their own: a [`world`] of bodies, the motion of a [`drive`](mod@drive), a [`sensor`], a [`camera`], the
//! [`device`]s of a robot.
//!
//! The library uses SI units and `f64` throughout, with the frames and signs of `docs/conventions.md`. Millimetres and
//! degrees appear only in [`mod@unit`] and in messages to the user. Scenes are plain data ([`mod@spec`]) that
//! `sim-format` reads from text.
#![forbid(unsafe_code)]

pub mod build;
pub mod camera;
pub mod check;
pub mod contact;
pub mod device;
pub mod drive;
pub mod math;
pub mod nearest;
pub mod noise;
pub mod object;
pub mod parallel;
pub mod pose;
pub mod radio;
pub mod record;
pub mod scene;
pub mod sensor;
pub mod simulation;
mod sort;
pub mod spec;
pub mod time;
pub mod unit;
pub mod world;

/// A robot's number: 1, 2, ... in the order of the file, unless the scene sets other numbers. `OSMachineID` returns
/// this number, and it is the robot's radio address.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
pub struct RobotId(pub u32);

impl RobotId {
    /// Index of the robot in a list of all robots in the order of their ids.
    pub fn index(self) -> usize {
        self.0 as usize - 1
    }

    /// The id of the robot at `index` in a list of all robots.
    ///
    /// # Panics
    /// If `index` is `u32::MAX` or more.
    pub fn from_index(index: usize) -> Self {
        Self(u32::try_from(index + 1).expect("a scene has fewer than 2^32 robots"))
    }
}

impl std::fmt::Display for RobotId {
    /// Formats the id as `r1`, `r2`, ..., as in all output.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "r{}", self.0)
    }
}

/// A movable object's number: 1, 2, ... in the order in which the scene places the objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
pub struct ObjectId(pub u32);

impl ObjectId {
    /// Index of the object in a list of all objects in the order of their ids.
    pub fn index(self) -> usize {
        self.0 as usize - 1
    }

    /// The id of the object at `index` in a list of all objects.
    ///
    /// # Panics
    /// If `index` is `u32::MAX` or more.
    pub fn from_index(index: usize) -> Self {
        Self(u32::try_from(index + 1).expect("a scene has fewer than 2^32 objects"))
    }
}

impl std::fmt::Display for ObjectId {
    /// Formats the id as `o1`, `o2`, ..., as in all output.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "o{}", self.0)
    }
}
