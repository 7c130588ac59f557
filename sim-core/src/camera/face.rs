//! Faces prepared for ray tests.

use glam::{DMat3, DVec3};

/// A face in lens space (see [`optics`](super::optics)), prepared for ray tests.
#[derive(Clone, Debug)]
pub struct Face {
    /// Cross product of the corners of each edge. Its sign is such that the dot products of a ray with all three are
    /// positive if the ray hits the face. The cross products of an edge shared by two faces differ only in sign.
    pub edges: [DVec3; 3],
    /// Plane of the face: its dot product with a ray is the reciprocal of the ray's parameter at the plane.
    pub plane: DVec3,
    /// Reciprocal of the absolute determinant of the corners.
    pub inverse_det: f64,
    /// Number of the part.
    pub part: u32,
    /// Number of the triangle in the part's mesh.
    pub triangle: u32,
    /// True if the camera sees the outside of the face: the corners are counter-clockwise.
    pub is_outside: bool,
}

/// Limit of all coefficients of a face, which prevents overflow in `f32`.
const MAX_COEFFICIENT: f64 = 1e30;

/// Reciprocal of the minimum distance in metres between camera and plane. At a smaller distance, rounding would decide
/// whether the camera sees the face, so the face is treated as edge-on. Source: our choice.
const MAX_RECIPROCAL_DISTANCE: f64 = 1e9;

impl Face {
    /// The face with these corners; `None` if the camera sees it edge-on, if it has no area, or if the camera sees its
    /// back side and `hides_back_side` is true.
    #[inline(always)]
    pub fn new(
        (part, triangle): (u32, u32),
        [a, b, c]: [DVec3; 3],
        lens_from_camera: &DMat3,
        hides_back_side: bool,
    ) -> Option<Self> {
        let normal = (b - a).cross(c - a);
        let det = a.dot(normal);
        // Seen from outside, the corners are counter-clockwise and their determinant is negative.
        if hides_back_side && det > 0.0 || det == 0.0 {
            return None;
        }
        let sign = if det < 0.0 { -1.0 } else { 1.0 };
        let edges = [b.cross(c) * sign, c.cross(a) * sign, a.cross(b) * sign];
        let (plane, inverse_det) = (normal / det, 1.0 / det.abs());
        let max_coefficient = edges[0].abs().max(edges[1].abs()).max(edges[2].abs()).max(plane.abs()).max_element();
        // Plane in the camera's frame; its length is the reciprocal of the plane's distance.
        let camera_plane = lens_from_camera.transpose() * plane;
        // A sum with a term that is not finite is not finite.
        let is_usable = max_coefficient <= MAX_COEFFICIENT
            && camera_plane.length_squared() <= MAX_RECIPROCAL_DISTANCE * MAX_RECIPROCAL_DISTANCE
            && (inverse_det + plane.x + plane.y + plane.z).is_finite();
        is_usable.then_some(Self { edges, plane, inverse_det, part, triangle, is_outside: det < 0.0 })
    }

    /// Linear form that interpolates values at the corners over the face. The value at a ray is
    /// a + form . ray / plane . ray, where a is the value at the first corner and [`plane`](Self::plane) the face's
    /// plane.
    #[inline(always)]
    pub fn form(&self, [a, b, c]: [f64; 3]) -> DVec3 {
        (self.edges[1] * (b - a) + self.edges[2] * (c - a)) * self.inverse_det
    }
}
