//! Geometry of a scene: vertical walls with their ray index, an index over bodies that is rebuilt per slot, ground and
//! meshes.
//!
//! Walls and bodies are planar geometry in the world frame, in metres; a wall is its trace on the floor, a line
//! segment. The module finds the walls along a ray and the walls or bodies near a point; it contains no shapes of
//! robots, no sensors and no contacts. Meshes are in the frame of their body.

mod bounds;
mod bounds_index;
mod bvh;
mod capsule;
pub(crate) mod distance;
mod grid;
mod ground;
mod height_field;
mod material;
mod mesh;
mod nearby;
mod random_terrain;
mod segment;
mod steps;
mod surface;
mod walls;

pub use bounds::Bounds;
pub use bounds_index::BoundsIndex;
pub use bvh::{MeshHit, MeshIndex};
pub use capsule::Capsule;
pub use ground::Ground;
pub use height_field::{FieldError, HeightField, MAX_CELLS};
pub use material::{Material, Texture};
pub use mesh::{Mesh, Triangle};
pub use nearby::Nearby;
pub use random_terrain::{Boulders, Disc, MAX_BOULDERS, RandomTerrain};
pub use segment::Segment;
pub use steps::{Block, MAX_STEPS, Stairs, StairsDirection, Steps};
pub use surface::Surface;
pub use walls::{WallHit, WallId, Walls};
