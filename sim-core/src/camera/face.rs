//! A face as a camera sees it.

use glam::{DMat3, DVec3};

/// A face in lens space (see [`optics`](super::optics)), made ready for rays.
#[derive(Clone, Debug)]
pub struct Face {
    /// The cross products of two corners each, with the sign that makes all of them positive along rays that meet the face.
    /// Those of an edge that two faces share differ in nothing but the sign.
    pub edges: [DVec3; 3],
    /// Its product with a ray is 1 over the multiple of the ray that lies on the face.
    pub plane: DVec3,
    /// 1 over the determinant of the corners, positive.
    pub per_det: f64,
    /// Number of the part.
    pub part: u32,
    /// Number of the triangle in the part's mesh.
    pub triangle: u32,
    /// Whether the corners are counter-clockwise as seen from the camera: it looks at the face from outside.
    pub is_outside: bool,
}

/// Nothing of a face is greater, so that nothing overflows in `f32`.
const GREATEST: f64 = 1e30;

/// 1 over the distance, in metres, of a plane that the camera sees from its edge: they are within rounding of each other. Our
/// choice.
const NEAREST: f64 = 1e9;

impl Face {
    /// The face with these corners; `None` if the camera sees it from its edge, or from inside where that `is_hidden`, or if
    /// it has no area.
    #[inline(always)]
    pub fn new(
        (part, triangle): (u32, u32),
        [a, b, c]: [DVec3; 3],
        lens_from_camera: &DMat3,
        is_hidden: bool,
    ) -> Option<Self> {
        let normal = (b - a).cross(c - a);
        let det = a.dot(normal);
        // A camera in front of a face counter-clockwise has its corners turn left about each ray: their determinant is negative.
        if is_hidden && det > 0.0 || det == 0.0 {
            return None;
        }
        let sign = if det < 0.0 { -1.0 } else { 1.0 };
        let edges = [b.cross(c) * sign, c.cross(a) * sign, a.cross(b) * sign];
        let (plane, per_det) = (normal / det, 1.0 / det.abs());
        let greatest = edges[0].abs().max(edges[1].abs()).max(edges[2].abs()).max(plane.abs()).max_element();
        let per_distance = lens_from_camera.transpose() * plane;
        // Sums of what is not finite are not, either.
        let is_sound = greatest <= GREATEST
            && per_distance.length_squared() <= NEAREST * NEAREST
            && (per_det + plane.x + plane.y + plane.z).is_finite();
        is_sound.then_some(Self { edges, plane, per_det, part, triangle, is_outside: det < 0.0 })
    }

    /// What has these values at the corners is on the face the first of them and the product of this form with the ray, over
    /// that of [`plane`](Self::plane).
    #[inline(always)]
    pub fn form(&self, [a, b, c]: [f64; 3]) -> DVec3 {
        (self.edges[1] * (b - a) + self.edges[2] * (c - a)) * self.per_det
    }
}
