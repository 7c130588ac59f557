//! Faces prepared for ray tests.

use glam::{DMat3, DVec3};

/// A face in lens space (see [`optics`](super::optics)), prepared for ray tests.
#[derive(Clone, Debug)]
pub struct Face {
    /// Cross products of pairs of corners, with the sign that makes all three dot products with a ray positive if the
    /// ray hits the face. The products of an edge shared by two faces differ only in sign.
    pub edges: [DVec3; 3],
    /// Plane of the face: its dot product with a ray is the reciprocal of the ray's parameter at the plane.
    pub plane: DVec3,
    /// Reciprocal of the absolute determinant of the corners.
    pub per_det: f64,
    /// Number of the part.
    pub part: u32,
    /// Number of the triangle in the part's mesh.
    pub triangle: u32,
    /// True if the camera sees the outside of the face: the corners are counter-clockwise.
    pub is_outside: bool,
}

/// Limit of all coefficients of a face, which prevents overflow in `f32`.
const MAX_COEFFICIENT: f64 = 1e30;

/// Reciprocal of the minimum distance in metres between camera and plane. At a smaller distance rounding decides
/// whether the camera sees the face, so the face counts as edge-on. Our choice.
const MAX_RECIPROCAL_DISTANCE: f64 = 1e9;

impl Face {
    /// The face with these corners. `None` if the camera sees it edge-on, if it has no area, or if the camera sees its
    /// inside and `is_hidden` is true.
    #[inline(always)]
    pub fn new(
        (part, triangle): (u32, u32),
        [a, b, c]: [DVec3; 3],
        lens_from_camera: &DMat3,
        is_hidden: bool,
    ) -> Option<Self> {
        let normal = (b - a).cross(c - a);
        let det = a.dot(normal);
        // Seen from outside, the corners are counter-clockwise and their determinant is negative.
        if is_hidden && det > 0.0 || det == 0.0 {
            return None;
        }
        let sign = if det < 0.0 { -1.0 } else { 1.0 };
        let edges = [b.cross(c) * sign, c.cross(a) * sign, a.cross(b) * sign];
        let (plane, per_det) = (normal / det, 1.0 / det.abs());
        let largest = edges[0].abs().max(edges[1].abs()).max(edges[2].abs()).max(plane.abs()).max_element();
        let per_distance = lens_from_camera.transpose() * plane;
        // A sum with a term that is not finite is not finite.
        let is_usable = largest <= MAX_COEFFICIENT
            && per_distance.length_squared() <= MAX_RECIPROCAL_DISTANCE * MAX_RECIPROCAL_DISTANCE
            && (per_det + plane.x + plane.y + plane.z).is_finite();
        is_usable.then_some(Self { edges, plane, per_det, part, triangle, is_outside: det < 0.0 })
    }

    /// Linear form that interpolates corner values over the face. At a ray, the value is the first corner's plus the
    /// form's dot product with the ray divided by the dot product of [`plane`](Self::plane).
    #[inline(always)]
    pub fn form(&self, [a, b, c]: [f64; 3]) -> DVec3 {
        (self.edges[1] * (b - a) + self.edges[2] * (c - a)) * self.per_det
    }
}
