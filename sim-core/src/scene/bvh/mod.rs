//! Finds the nearest triangle along a ray, for the meshes that sensors detect.
//!
//! [`ray`] decides each hit in `f64`, from only the ray and one triangle. The tree (`binary`, `build`, `node`) and its
//! traversal eight boxes at a time (`walk`) only cull triangles, in `f32` and with margins wider than all rounding. So
//! the result is bit-identical for every tree, order and processor.

mod binary;
mod build;
mod node;
mod ray;
#[cfg(test)]
mod tests;
mod transform;
mod walk;

use fearless_simd::Level;
use glam::DVec3;

use node::Tree;
use ray::Ray;
use transform::TreeTransform;

/// The nearest triangle along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshHit {
    /// Metres from the ray's origin to the triangle; not negative.
    pub distance: f64,
    /// Number of the triangle; among triangles at the same distance, the lowest.
    pub triangle: u32,
    /// Unit normal of the triangle on the side from which the ray comes. For a ray in the triangle's plane, the normal
    /// on the side from which its corners are counter-clockwise.
    pub normal: DVec3,
}

/// All triangles of a mesh in its own frame, immutable, with a bounding volume hierarchy for rays.
///
/// Any list is allowed: duplicates, slivers, open and intersecting surfaces, an empty list, any extent and position.
/// Triangles without area, or with a coordinate that is not finite or exceeds 10^100 m, keep their number but are never
/// hit.
///
/// # Definition of a hit
/// Both sides of a triangle can be hit, edges and corners included. Where triangles share bit-identical corners, no ray
/// slips through between them. The reason is that the offset of a shared edge from the ray, projected along the ray, is
/// the same number for both triangles. Rounding never gives this offset a wrong sign. It can only make the offset 0,
/// and then the ray hits both triangles. A ray in a triangle's plane hits the triangle at the point where the ray
/// enters the triangle. A ray that starts on a triangle hits it at distance 0; the tolerance is 4 units in the last
/// place (2^-52) of the coordinates involved.
///
/// Distances are exact within rounding (about 10^-15 of the mesh's extent, divided by the cosine of the incidence
/// angle). A ray from outside the mesh's bounds is followed from the point where it enters the bounds, so a distant
/// origin adds only the rounding of its coordinates.
///
/// Source: Woop, Benthin and Wald, "Watertight ray/triangle intersection", 2013, in `f64`; Ylitie, Karras and Laine,
/// "Efficient incoherent ray traversal on GPUs through compressed wide BVHs", 2017, section 3, for the wide tree.
#[derive(Clone, Debug)]
pub struct MeshIndex {
    /// Number of triangles.
    count: usize,
    frame: Option<TreeTransform>,
    tree: Tree,
    level: Level,
}

impl MeshIndex {
    /// An index over `triangles`, numbered in their order: three corners each, in metres.
    ///
    /// # Panics
    /// If there are 2^28 triangles or more.
    pub fn new(triangles: &[[DVec3; 3]]) -> Self {
        Self::at_level(triangles, Level::new())
    }

    fn at_level(triangles: &[[DVec3; 3]], level: Level) -> Self {
        assert!(triangles.len() < 1 << 28, "a mesh has fewer than 2^28 triangles");
        let candidates: Vec<u32> =
            (0..).zip(triangles).filter(|(_, corners)| has_area(corners)).map(|(index, _)| index).collect();
        let frame = TreeTransform::around(candidates.iter().flat_map(|&index| triangles[index as usize]));
        let tree = frame.map_or_else(Tree::default, |frame| build::tree(triangles, &candidates, &frame));
        Self { count: triangles.len(), frame, tree, level }
    }

    /// Number of triangles, including those that no ray can hit.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Returns true if there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Lowest and highest corner of the box around all triangles that a ray can hit; `None` if there are none.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.frame.map(|frame| (frame.low, frame.high))
    }

    /// The nearest triangle at most `range` metres from `origin` along `direction`, a vector of length 1.
    ///
    /// [`MeshIndex`] defines a hit. `range` may be infinite. `None` without a hit, and for an invalid ray: an argument
    /// is NaN, `origin` is infinite or beyond 10^100 m, `range` is negative, or the length of `direction` is not 1
    /// within 10^-6.
    pub fn cast(&self, origin: DVec3, direction: DVec3, range: f64) -> Option<MeshHit> {
        let is_ray = is_usable(origin) && (direction.length_squared() - 1.0).abs() <= 2e-6 && range >= 0.0;
        let frame = self.frame.as_ref().filter(|_| is_ray)?;
        let reciprocal = direction.recip();
        let entry = frame.enter(origin, direction, reciprocal, range)?;
        let mut ray = Ray::new(&entry, direction, reciprocal, range - entry.distance, frame);
        walk::nearest(self.level, &self.tree, frame, &mut ray);
        let nearest = ray.nearest()?;
        let (batch, lane) = nearest.batch_lane;
        let normal = normal(&self.tree.batches[batch].corners[lane], direction);
        Some(MeshHit { distance: (entry.distance + nearest.distance).min(range), triangle: nearest.triangle, normal })
    }
}

fn is_usable(point: DVec3) -> bool {
    // False for NaN.
    point.abs().max_element() <= 1e100 && !point.is_nan()
}

/// Returns true if a ray can hit the triangle.
fn has_area(corners: &[DVec3; 3]) -> bool {
    corners.iter().all(|&corner| is_usable(corner)) && area_vector(corners) != DVec3::ZERO
}

/// Vector normal to the triangle, on the side from which its corners are counter-clockwise. Its length is twice the
/// triangle's area divided by the square of the maximum coordinate extent of its edges, so that nothing overflows.
fn area_vector([a, b, c]: &[DVec3; 3]) -> DVec3 {
    let (ab, ac) = (*b - *a, *c - *a);
    let extent = ab.abs().max(ac.abs()).max_element();
    if extent == 0.0 { DVec3::ZERO } else { (ab / extent).cross(ac / extent) }
}

/// Unit normal of a triangle on the side from which a ray along `direction` comes.
fn normal(corners: &[DVec3; 3], direction: DVec3) -> DVec3 {
    let [a, b, c] = *corners;
    let mut normal = (b - a).cross(c - a);
    let mut length_squared = normal.length_squared();
    if !(1e-200..1e200).contains(&length_squared) {
        let scaled = area_vector(corners);
        normal = scaled / scaled.abs().max_element();
        length_squared = normal.length_squared();
    }
    let unit = normal / length_squared.sqrt();
    if unit.dot(direction) > 0.0 { -unit } else { unit }
}
