//! Software renderer for cameras: pictures, depths and labels of a scene, without a graphics card.
//!
//! A [`Scenery`] is all that can be seen of a scene, the same for all cameras; a [`PosedScenery`] adds the poses of its parts
//! at an instant; a [`View`] is a camera's pose, its lens and the size of its image; a [`Camera`] renders a still in a
//! view.
//!
//! # Pictures
//! Row 0 is on top. The pixel in `column` and `row` covers [column, column + 1) x [row, row + 1); it shows the first
//! hit of the ray through its middle. Pixels are square. A camera's frame is that of sensors: x along the optical axis,
//! y to the left, z up.
//!
//! # Definition of a hit
//! A ray from the camera hits a face if it lies in the cone over the face's corners, from either side: with the corners
//! v0, v1, v2 in the camera's frame and e0 = v1 x v2 (and so on), all e . ray have the sign of the determinant v0 . e0
//! (ray against edges: Olano and Greer, Triangle scan conversion using 2D homogeneous coordinates, 1997). The test is
//! the same for every lens, and faces behind the camera or across its plane need no clipping. Edges are widened by 1e-4
//! pixels (2e-6 rad for a fisheye), more than all rounding, so that nothing shows through between faces that share an
//! edge or a corner. Of coplanar faces the first is seen: the lower part number, then the lower triangle number. A
//! camera less than 1 nm from a face's plane sees the face edge-on: not at all. Below everything lies the ground, the
//! plane z = 0, visible only from above, and behind everything the sky; neither is a face, both are computed. Our
//! choices.
//!
//! # Colour
//! The colour of a surface is that of its material times its texture, times the light: `ambient`, `fill` times (1 + n .
//! f) / 2, where f points to the side opposite to the sun, and `diffuse` times n . l if the sun reaches the surface. On
//! faces with normals at the corners, n is interpolated between them; it is flipped to the side from which the face is
//! seen. With `shadows`, the sun reaches a place if no other face, more than 1e-6 m away, covers the sun: hard shadows,
//! exact, cast by everything visible, a camera's own robot too; the ground casts none. Textures are filtered: see
//! [`MipMap`]. Colours are added and multiplied as the values of the image, 0 to 255, without gamma correction.
//!
//! # Implementation
//! Faces are binned into tiles of 8 x 8 pixels (`bins`); for each tile, `tile` finds the nearest face of each pixel
//! with SIMD instructions, and `shade` then colours the pixels, face by face. Linear forms on rays are set up in `f64`
//! and evaluated relative to a tile's middle in `f32`. The bits are the same on every processor: no operations are
//! fused, and no sum runs over lanes.

mod bins;
mod face;
mod optics;
mod picture;
mod rays;
mod render;
mod render_mesh;
mod scenery;
mod shade;
mod shadow;
mod surface;
mod texture;
mod tile;
mod view;

#[cfg(test)]
mod tests;

pub use picture::Picture;
pub use render::Camera;
pub use scenery::{Attachment, Floor, Ground, Label, Light, Part, PosedScenery, Scenery, Sky, Spot};
pub use texture::MipMap;
pub use view::{Lens, View, ViewError};
