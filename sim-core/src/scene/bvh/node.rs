//! Nodes and batches of the tree.

use glam::{DVec3, Vec3};

/// Children per node, and triangles per batch.
pub(super) const WIDTH: usize = 8;

/// Margin of the boxes around their triangles on all sides, in tree units: 24 u, where u = 2^-24 is the maximum
/// rounding error of an `f32` near 1.
///
/// A ray enters a box at (bound - origin) / direction on each axis. Rounding shifts the entry along that axis by at
/// most 8.3 u. The bound contributes 1 u, the origin 1 u, the reciprocal 2.1 u, and the difference (at most 2.1) with
/// its products (two, or one if multiplication and subtraction are fused) 4.2 u. The position of a hit has an error of
/// at most 4 u (see `ray`), and so does an origin on a surface. The rest of the margin covers reciprocals clamped to
/// [`MAX_RECIPROCAL`](super::walk::MAX_RECIPROCAL), and the rounding of `f64`.
pub(super) const PADDING: f32 = 24.0 / (1 << 24) as f32;

/// The tree over a mesh's triangles.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    pub nodes: Vec<Node>,
    pub batches: Vec<TriangleBatch>,
    /// `None` for an empty tree.
    pub root: Option<Child>,
    /// Number of nodes on the longest path from the root.
    pub depth: usize,
}

/// Eight boxes, coordinate by coordinate; no ray enters the box of a missing child.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Planes by axis and by side (low, high).
    pub planes: [[[f32; WIDTH]; 2]; 3],
    pub children: [Child; WIDTH],
}

/// Reference to a node or batch: its index in [`Tree::nodes`] or, with the highest bit set, in [`Tree::batches`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Child(pub u32);

const BATCH: u32 = 1 << 31;

impl Child {
    pub fn node(index: usize) -> Self {
        Self(u32::try_from(index).expect("fewer than 2^28 triangles"))
    }

    pub fn batch(index: usize) -> Self {
        Self(u32::try_from(index).expect("fewer than 2^28 triangles") | BATCH)
    }

    /// Index into the tree's batches; `None` for a node.
    #[inline(always)]
    pub fn as_batch(self) -> Option<usize> {
        (self.0 & BATCH != 0).then_some((self.0 & !BATCH) as usize)
    }
}

/// Up to eight triangles.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct TriangleBatch {
    /// Corners by axis and corner, in tree coordinates; unused lanes are NaN, which no ray hits.
    pub tree_corners: [[[f32; WIDTH]; 3]; 3],
    /// Numbers of the triangles.
    pub numbers: [u32; WIDTH],
    /// Corners by triangle, in the mesh's frame, m; stored here for locality.
    pub corners: [[DVec3; 3]; WIDTH],
}

impl TriangleBatch {
    pub const EMPTY: Self = Self {
        tree_corners: [[[f32::NAN; WIDTH]; 3]; 3],
        numbers: [u32::MAX; WIDTH],
        corners: [[DVec3::NAN; 3]; WIDTH],
    };
}

/// A box in tree coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Box3 {
    pub low: Vec3,
    pub high: Vec3,
}

impl Box3 {
    pub const EMPTY: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };

    pub fn of_point(point: Vec3) -> Self {
        Self { low: point, high: point }
    }

    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    pub fn middle(self) -> Vec3 {
        0.5 * (self.low + self.high)
    }

    /// Half of its surface area.
    pub fn half_area(self) -> f32 {
        let size = self.high - self.low;
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}
