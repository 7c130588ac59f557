//! The frame in which the tree is kept: around the mesh's middle, scaled to coordinates of at most 1.

use glam::DVec3;

/// From the mesh's metres to the tree's coordinates, which lie in [-1, 1] whatever the mesh's extent: rounding of `f32` is
/// then the same everywhere, and nothing overflows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Bounds of the mesh.
    pub low: DVec3,
    pub high: DVec3,
    /// Greatest coordinate of the mesh, m.
    pub extent: f64,
    /// Middle of the mesh.
    pub centre: DVec3,
    /// From there to the bounds, at least.
    half: DVec3,
    /// Tree's units for a metre; a power of two, so that scaling rounds nothing.
    pub scale: f64,
}

/// Where a ray begins to be followed.
pub(super) struct Entry {
    /// Metres from the ray's origin.
    pub distance: f64,
    /// In the mesh's frame; within or next to the mesh's bounds.
    pub origin: DVec3,
}

/// How much larger the bounds are taken when rays enter them, in the tree's units.
const MARGIN: f64 = 1.0 / (1 << 20) as f64;

impl Frame {
    /// The frame of a mesh with these corners; `None` without any.
    pub fn around(mut corners: impl Iterator<Item = DVec3>) -> Option<Self> {
        let first = corners.next()?;
        let (low, high) = corners.fold((first, first), |(low, high), corner| (low.min(corner), high.max(corner)));
        let centre = 0.5 * low + 0.5 * high;
        let half = (high - centre).max(centre - low);
        let extent = low.abs().max(high.abs()).max_element();
        // The power of two that takes `half` to [0.5, 1).
        let exponent = half.max_element().max(1e-280).to_bits() >> 52;
        Some(Self { low, high, extent, centre, half, scale: f64::from_bits((2045 - exponent) << 52) })
    }

    /// A point of the mesh's frame in the tree's coordinates.
    pub fn tree_from_mesh(&self, point: DVec3) -> DVec3 {
        (point - self.centre) * self.scale
    }

    /// Where the ray meets the bounds: its own origin, if that is within. `None` if it passes by or ends before.
    /// `reciprocal` is that of the direction.
    pub fn enter(&self, origin: DVec3, direction: DVec3, reciprocal: DVec3, range: f64) -> Option<Entry> {
        let offset = origin - self.centre;
        // The second term exceeds the rounding of what follows.
        let reach = self.half + (MARGIN / self.scale + offset.abs().max_element() * f64::EPSILON * 8.0);
        if offset.abs().cmple(reach).all() {
            return Some(Entry { distance: 0.0, origin });
        }
        let (to_low, to_high) = ((-reach - offset) * reciprocal, (reach - offset) * reciprocal);
        let (mut near, mut far) = (0.0_f64, range);
        for axis in 0..3 {
            if reciprocal[axis].is_finite() {
                near = near.max(to_low[axis].min(to_high[axis]));
                far = far.min(to_low[axis].max(to_high[axis]));
            } else if offset[axis].abs() > reach[axis] {
                return None;
            }
        }
        (near <= far)
            .then(|| Entry { distance: near, origin: self.centre + (offset + near * direction).clamp(-reach, reach) })
    }
}
