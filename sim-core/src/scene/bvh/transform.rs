//! The tree's frame: centred on the mesh, scaled to coordinates of at most 1.

use glam::DVec3;

/// Transform from the mesh's metres to the tree's coordinates, which lie in [-1, 1] for any extent of the mesh. The
/// rounding of `f32` is then the same for every mesh, and nothing overflows.
#[derive(Clone, Copy, Debug)]
pub(super) struct TreeTransform {
    /// Bounds of the mesh.
    pub low: DVec3,
    pub high: DVec3,
    /// Maximum absolute coordinate of the mesh, m.
    pub max_coordinate: f64,
    /// Middle of the mesh.
    pub centre: DVec3,
    /// Half extents of the bounds around `centre`, rounded up.
    half_extents: DVec3,
    /// Tree units per metre; a power of two, so that scaling is exact.
    pub scale: f64,
}

/// Start of the traversal of a ray.
pub(super) struct RayEntry {
    /// Distance from the ray's origin, m.
    pub distance: f64,
    /// Starting point in the mesh's frame, within or next to the mesh's bounds.
    pub origin: DVec3,
}

/// Enlargement of the bounds when rays enter them, in tree units.
const MARGIN: f64 = 1.0 / (1 << 20) as f64;

impl TreeTransform {
    /// The frame of a mesh with these corners; `None` without corners.
    pub fn around(mut corners: impl Iterator<Item = DVec3>) -> Option<Self> {
        let first = corners.next()?;
        let (low, high) = corners.fold((first, first), |(low, high), corner| (low.min(corner), high.max(corner)));
        let centre = 0.5 * low + 0.5 * high;
        let half_extents = (high - centre).max(centre - low);
        let max_coordinate = low.abs().max(high.abs()).max_element();
        // Power of two that scales `half_extents` to [0.5, 1).
        let exponent = half_extents.max_element().max(1e-280).to_bits() >> 52;
        let scale = f64::from_bits((2045 - exponent) << 52);
        Some(Self { low, high, max_coordinate, centre, half_extents, scale })
    }

    /// A point of the mesh's frame in tree coordinates.
    pub fn tree_from_mesh(&self, point: DVec3) -> DVec3 {
        (point - self.centre) * self.scale
    }

    /// Point at which the ray enters the bounds; its origin if that lies within the bounds. `None` if the ray misses
    /// the bounds or ends before them. `reciprocal` is the reciprocal of the direction.
    pub fn enter(&self, origin: DVec3, direction: DVec3, reciprocal: DVec3, range: f64) -> Option<RayEntry> {
        let offset = origin - self.centre;
        // The second term exceeds the rounding of the computations below.
        let half_extents = self.half_extents + (MARGIN / self.scale + offset.abs().max_element() * f64::EPSILON * 8.0);
        if offset.abs().cmple(half_extents).all() {
            return Some(RayEntry { distance: 0.0, origin });
        }
        let (to_low, to_high) = ((-half_extents - offset) * reciprocal, (half_extents - offset) * reciprocal);
        let (mut near, mut far) = (0.0_f64, range);
        for axis in 0..3 {
            if reciprocal[axis].is_finite() {
                near = near.max(to_low[axis].min(to_high[axis]));
                far = far.min(to_low[axis].max(to_high[axis]));
            } else if offset[axis].abs() > half_extents[axis] {
                return None;
            }
        }
        let origin = || self.centre + (offset + near * direction).clamp(-half_extents, half_extents);
        (near <= far).then(|| RayEntry { distance: near, origin: origin() })
    }
}
