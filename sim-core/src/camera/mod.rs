//! Software renderer for cameras: pictures, depths and labels of a scene, without a graphics card.
//!
//! A [`Scenery`] is everything visible in a scene, shared by all cameras. A [`PosedScenery`] adds the poses of its
//! parts at an instant. A [`View`] is a camera's pose, its lens and the size of its image. A [`Camera`] renders a posed
//! scenery in a view.
//!
//! # Pictures
//! Row 0 is at the top. The pixel in `column` and `row` covers [column, column + 1) x [row, row + 1); it shows the first
//! hit of the ray through its centre. Pixels are square. A camera has the frame of sensors: x along the optical axis, y
//! to the left, z up.
//!
//! # Definition of a hit
//! A ray from the camera hits a face if it lies in the cone of the rays to the points of the face. Both sides of a face
//! can be hit. Let v0, v1, v2 be the corners in the camera's frame, and e0 = v1 x v2, e1 = v2 x v0, e2 = v0 x v1. The
//! ray lies in the cone if all dot products e . ray have the sign of the determinant v0 . e0 (Olano and Greer, Triangle
//! scan conversion using 2D homogeneous coordinates, 1997). The test is the same for every lens, and faces behind the
//! camera or crossing its plane need no clipping. Edges are widened by 1e-4 pixels (2e-6 rad for a fisheye), which
//! exceeds all rounding. Nothing therefore shows through between faces that share an edge or a corner. Among coplanar
//! faces the lowest part number is visible, then the lowest triangle number. A face is invisible to a camera less than
//! 1 nm from the face's plane. The ground is the plane z = 0, visible only from above; the sky is behind all faces and
//! the ground. Ground and sky are computed without faces. These definitions are our choice.
//!
//! # Colour
//! The colour of a surface is its material's colour times its texture times the light. The light is the sum of
//! `ambient`, of `fill` (1 + n . f) / 2 and, if the sun reaches the surface, of `diffuse` n . l. Here n is the unit
//! normal, l the direction to the sun, and f the direction of the fill light, on the side opposite to the sun. On faces
//! with normals at the corners, n is interpolated between these normals. n is flipped to the side from which the face
//! is seen. With `shadows`, the sun reaches a point if no other face farther than 1e-6 m from it hides the sun. Shadows
//! are hard and exact. Every visible face casts shadows, including faces of the camera's own robot; the ground does
//! not. Textures are filtered: see [`MipMap`]. Colours are added and multiplied as the values of the image, 0 to 255,
//! without gamma correction.
//!
//! # Implementation
//! Faces are binned into tiles of 8 x 8 pixels (`bins`). For each tile, `tile` finds the nearest face of each pixel
//! with SIMD instructions, and `shade` then colours the pixels, face by face. Linear forms on rays are set up in `f64`
//! and evaluated relative to a tile's centre in `f32`. Images are bit-identical on every processor, because no
//! operations are fused and no sum runs over lanes.

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
