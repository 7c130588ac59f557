//! What cameras see: pictures, depths and labels of a scene, rendered without a graphics card.
//!
//! A [`Scenery`] is all that can be seen of a scene, the same for all cameras; a [`Still`] is where its parts stand at an
//! instant; a [`View`] is a camera's pose, its lens and the size of its image; a [`Camera`] renders the one in the other.
//!
//! # Pictures
//! Row 0 is on top. The pixel in `column` and `row` covers [column, column + 1) x [row, row + 1); it shows what the ray
//! through its middle meets first. Pixels are square. A camera's frame is that of sensors: x along the optical axis, y to
//! the left, z up.
//!
//! # What is met
//! A ray from the camera meets a face where it lies in the cone over the face's corners, from either side: with the corners
//! v0, v1, v2 in the camera's frame and e0 = v1 x v2 (and so on), where all e . ray have the sign of the determinant
//! v0 . e0 (ray against edges: Olano and Greer, Triangle scan conversion using 2D homogeneous coordinates, 1997). The test is the
//! same for every lens, and faces behind the camera or across its plane need no clipping. Edges are taken as wider by 1e-4
//! pixels (2e-6 rad for a fisheye), more than all rounding, so that nothing shows through between faces that share an edge or a
//! corner. Of faces in one plane the first is seen: the part, then the triangle with the lower number. A camera less than 1 nm
//! from a face's plane sees it from its edge: not at all. Beneath all lies the ground, the plane z = 0, seen from above alone, and
//! behind all the sky; both are no faces but computed. Our choices.
//!
//! # Colour
//! The colour of a surface is that of its material times its texture, times the share of light: `ambient`, `fill` times how
//! far the surface looks up to the side opposite to the sun ((1 + n . f) / 2), and `diffuse` times n . l where the sun reaches it.
//! On faces with normals at the corners n is blended between them; it is turned to the side from which the face is seen.
//! With `shadows` the sun reaches what no other face covers from it, as seen from more than 1e-6 m away: hard shadows, exact, of
//! all that is seen, a camera's own robot too; the ground throws none. Textures are filtered: see [`Pyramid`]. Colours are added and multiplied as the numbers of the image, 0 to 255, as
//! graphics cards without a colour space do.
//!
//! # How it is computed
//! Faces go into tiles of 8 x 8 pixels (`bins`); in a tile `tile` finds the nearest face of each pixel, with the processor's
//! vectors, and `shade` then colours the pixels, face by face. Forms on rays are set up in `f64` and taken about a tile's middle
//! in `f32`. The bits are the same on every processor: nothing is fused, and no sum is over lanes.

mod bins;
mod face;
mod optics;
mod picture;
mod rays;
mod render;
mod scenery;
mod shade;
mod shadow;
mod shape;
mod surface;
mod texture;
mod tile;
mod view;

#[cfg(test)]
mod tests;

pub use picture::Picture;
pub use render::Camera;
pub use scenery::{Floor, Ground, Label, Light, Part, Place, Scenery, Sky, Spot, Still};
pub use texture::Pyramid;
pub use view::{Lens, View, ViewError};
