//! Printers: convert specs to texts of each file format. Reading the text gives the same spec.
//!
//! Properties that a format cannot represent are listed. Numbers are printed as the shortest decimal that reads back to
//! the same `f64`. If none exists (for coordinates computed in a local frame), the nearest decimal is printed.

mod maze;
mod noise;
pub(crate) mod number;
mod object;
mod robi;
mod scene;
mod sim;
mod text;
mod world;

pub(super) use maze::lost_in_maze;
pub use maze::{NotAMaze, print_maze};
pub use noise::print_noise;
pub use object::print_esobj;
pub use robi::{print_companion, print_robi};
pub use scene::{companion_schema, noise_schema, print_scene, scene_schema};
pub(super) use scene::{schema, section};
pub(super) use sim::is_classic;
pub use sim::print_sim;
pub(crate) use text::document;
pub use world::print_world;

/// Properties that only our own format for scenes can represent, in words.
const LOOKS: &str = "the light and the colours of the world";

/// Properties that a printed format cannot represent, in words such as `the arguments of r3`.
pub type Lost = Vec<String>;

/// Printed text, and the properties that it omits.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Printed {
    /// The text of the file.
    pub text: String,
    /// Properties that the text omits.
    pub lost: Lost,
}
