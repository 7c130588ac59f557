//! Scenes, robots, objects and noise profiles as plain data in SI units: metres, radians, seconds.
//! `docs/conventions.md` defines the frames. `sim-format` reads and prints specs, [`build`](crate::build) turns them
//! into simulation models.
//!
//! Every number in a spec is finite and within its documented range, for any text from which the spec was read.

mod check;
mod device;
mod fault;
mod legs;
mod looks;
mod mount;
mod noise;
mod object;
mod robi;
mod scene;
mod shape;
mod span;
mod world;

pub use crate::camera::Lens;
pub use crate::drive::DriveKind;
pub use crate::scene::Surface;
pub use check::*;
pub use device::*;
pub use fault::*;
pub use legs::*;
pub use looks::*;
pub use mount::*;
pub use noise::*;
pub use object::*;
pub use robi::*;
pub use scene::*;
pub use shape::*;
pub use span::*;
pub use world::*;

pub use crate::unit::MAX_LENGTH;

/// A text in a file, such as a path or a name, with its location.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SpannedText {
    /// The text as written, without quotes.
    pub text: String,
    /// Location in the file.
    pub span: Span,
}

/// The last part of a path.
pub fn file_name(path: &str) -> &str {
    path.rfind(['/', '\\']).map_or(path, |index| &path[index + 1..])
}

/// The last part of a path without its extension.
pub fn stem(path: &str) -> &str {
    let name = file_name(path);
    name.rfind('.').filter(|index| *index > 0).map_or(name, |index| &name[..index])
}
