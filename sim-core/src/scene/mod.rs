//! Where things stand: vertical walls with their ray index, and a per-slot index of the bodies that move.
//!
//! Everything here is planar geometry in the world frame, in metres; a wall is its trace on the floor, a line segment.
//! The room knows no robots' shapes, sensors or contacts: it answers which walls a ray meets and which walls or bodies are
//! near a place.

mod bounds;
mod grid;
mod moving;
mod segment;
mod walls;

pub use bounds::Bounds;
pub use moving::Moving;
pub use segment::Segment;
pub use walls::{Hit, WallId, Walls};
