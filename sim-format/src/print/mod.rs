//! Printers: specs to texts of every kind of file, such that reading the text gives the spec again.
//!
//! What a form has no place for is listed, not dropped silently. Numbers are the shortest decimals that read back to the same
//! double; where none does (a place that the arithmetic of a frame has put between them), the nearest is taken.

mod maze;
mod noise;
pub(crate) mod number;
mod object;
mod robi;
mod scene;
mod sim;
mod text;
mod world;

pub(super) use maze::beside_maze;
pub use maze::print_maze;
pub use noise::print_noise;
pub use object::print_esobj;
pub use robi::{print_companion, print_robi};
pub(super) use scene::section;
pub use scene::{print_scene, scene_schema};
pub use sim::print_sim;
pub use world::print_world;

/// What only our own form has a place for.
const LOOKS: &str = "the light and the colours of the world";

/// What a printed form cannot hold: in words, such as `the arguments of r3`.
pub type Lost = Vec<String>;

/// The text and what it leaves out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Printed {
    /// The text of the file.
    pub text: String,
    /// What it has no place for.
    pub lost: Lost,
}
