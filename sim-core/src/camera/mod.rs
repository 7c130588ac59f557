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
//! v0 . e0. The test is the same for every lens; faces behind the camera or across its plane need no clipping, and two faces
//! that share an edge have the same number there with opposite signs, so that nothing shows through between them.
//! Beneath all lies the ground, the plane z = 0, and behind all the sky; both are no faces but computed.
//!
//! # Colour
//! The colour of a surface is that of its material times its texture, times the share of light: `ambient`, `fill` times how
//! far the surface looks up to the side opposite to the sun ((1 + n . f) / 2), and `diffuse` times n . l where the sun reaches it.
//! Textures are filtered: see [`Pyramid`]. Colours are added and multiplied as the numbers of the image, 0 to 255, as
//! graphics cards without a colour space do.

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
