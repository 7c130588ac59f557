//! What the files say, in SI units: metres, radians, seconds. The frames are those of `docs/conventions.md`.
//!
//! Every value in a spec is a finite number within its documented range, whatever the text was.

mod device;
mod legs;
mod looks;
mod mount;
mod object;
mod robi;
mod scene;
mod shape;
mod world;

use super::Span;
pub use crate::camera::Lens;
pub use crate::drive::DriveKind;
pub use crate::scene::Surface;
pub use device::*;
pub use legs::*;
pub use looks::*;
pub use mount::*;
pub use object::*;
pub use robi::*;
pub use scene::*;
pub use shape::*;
pub use world::*;

/// Largest coordinate or size that a file may have, in metres.
pub const MAX_LENGTH: f64 = 1e6;

/// A file named in another file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PathRef {
    /// As written, without quotes.
    pub text: String,
    /// Where it is written.
    pub span: Span,
}
