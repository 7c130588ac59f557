use glam::{DVec2, DVec3};

/// A face as the camera sees it: its corners in the camera's frame, made ready for rays.
#[derive(Clone, Debug)]
pub struct Face {
    /// Number of the part.
    pub part: u32,
    /// Number of the triangle in the part's mesh.
    pub triangle: u32,
    /// The cross products of two corners each, with the sign that makes all of them positive along rays that meet the face.
    /// Those of an edge that two faces share differ in nothing but the sign.
    edges: [DVec3; 3],
    /// Their sum: perpendicular to the face.
    normal: DVec3,
    /// Determinant of the corners; positive.
    det: f64,
    /// Whether the corners are counter-clockwise as seen from the camera: it looks at the face from outside.
    pub is_outside: bool,
}

impl Face {
    /// The face with these corners; `None` if the camera sees it from its edge, or if it has no area.
    pub fn new(part: u32, triangle: u32, [a, b, c]: [DVec3; 3]) -> Option<Self> {
        let edges = [b.cross(c), c.cross(a), a.cross(b)];
        let det = a.dot(edges[0]);
        let sign = if det < 0.0 { -1.0 } else { 1.0 };
        let edges = edges.map(|edge| edge * sign);
        let normal = edges[0] + edges[1] + edges[2];
        let is_seen = det != 0.0 && det.is_finite() && normal.is_finite();
        // A camera in front of a face counter-clockwise has its corners turn left about each ray: their determinant is negative.
        is_seen.then(|| Self { part, triangle, edges, normal, det: det.abs(), is_outside: det < 0.0 })
    }

    /// Whether the ray meets the face. On an edge, one of the two faces that share it is met.
    pub fn is_met(&self, ray: DVec3) -> bool {
        self.edges.iter().all(|edge| {
            let side = edge.dot(ray);
            side > 0.0 || side == 0.0 && is_first(*edge)
        })
    }

    /// 1 over the multiple of the ray that lies on the face's plane.
    pub fn nearness(&self, ray: DVec3) -> f64 {
        self.normal.dot(ray) / self.det
    }

    /// The shares of the three corners (barycentric coordinates) in the point that the ray meets, and how they change with a
    /// change of the ray.
    pub fn shares(&self, ray: DVec3, steps: [DVec3; 2]) -> Shares {
        let along = self.normal.dot(ray);
        let here = self.edges.map(|edge| edge.dot(ray) / along);
        let step = |step: DVec3| {
            let across = self.normal.dot(step);
            std::array::from_fn(|corner| (self.edges[corner].dot(step) - here[corner] * across) / along)
        };
        Shares { here, steps: steps.map(step) }
    }
}

/// Of the two directions of an edge, one.
fn is_first(edge: DVec3) -> bool {
    edge.to_array().into_iter().find(|part| *part != 0.0).is_some_and(|part| part > 0.0)
}

/// Barycentric coordinates of a point, and their changes.
#[derive(Clone, Copy, Debug)]
pub struct Shares {
    /// At the point; they add up to 1.
    pub here: [f64; 3],
    /// Their changes to the next column and the next row.
    pub steps: [[f64; 3]; 2],
}

impl Shares {
    /// What has these values at the corners, at the point.
    pub fn point(&self, [a, b, c]: [DVec2; 3]) -> DVec2 {
        blend(self.here, [a, b, c])
    }

    /// Its changes to the next column and the next row.
    pub fn changes(&self, corners: [DVec2; 3]) -> [DVec2; 2] {
        self.steps.map(|step| blend(step, corners))
    }
}

fn blend(shares: [f64; 3], corners: [DVec2; 3]) -> DVec2 {
    corners[0] * shares[0] + corners[1] * shares[1] + corners[2] * shares[2]
}
