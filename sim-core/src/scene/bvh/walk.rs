//! Traversal of the tree by a ray, eight boxes and eight triangles at a time.

use super::build::MAX_DEPTH;
use super::node::{Child, Node, Tree, TriangleBatch, WIDTH};
use super::ray::Ray;
use super::transform::TreeTransform;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8};

/// Limit to which reciprocals of a direction's components are clamped, so that all are finite. Over the whole mesh the
/// clamping shifts the ray sideways by less than 2^-38 tree units.
pub(super) const MAX_RECIPROCAL: f64 = (1_u64 << 40) as f64;

/// Stack sizes of the traversal, 7 entries per level of the tree: for trees of the usual depth, and for any tree.
const USUAL_STACK: usize = 7 * 9;
const MAX_STACK: usize = 7 * MAX_DEPTH;

/// Upper bound of the length of any path through the tree's coordinates.
const MAX_PATH: f64 = 8.0;

/// Tests `ray` against every triangle that it may hit before its nearest hit.
pub(super) fn nearest(level: Level, tree: &Tree, frame: &TreeTransform, ray: &mut Ray) {
    if let Some(root) = tree.root {
        if 7 * tree.depth <= USUAL_STACK {
            dispatch!(level, simd => walk::<_, USUAL_STACK>(simd, tree, root, frame, ray));
        } else {
            dispatch!(level, simd => walk::<_, MAX_STACK>(simd, tree, root, frame, ray));
        }
    }
}

/// A ray in tree coordinates.
struct Probe<S: Simd> {
    x: Slab<S>,
    y: Slab<S>,
    z: Slab<S>,
    /// Axis permutation of [`Ray::axes`].
    axes: [usize; 3],
    /// Origin, in the order of `axes`.
    origin: [f32x8<S>; 3],
    shear: [f32x8<S>; 2],
}

/// A ray on one axis.
struct Slab<S: Simd> {
    /// Reciprocal of the direction.
    reciprocal: f32x8<S>,
    /// Product of reciprocal and origin.
    origin_product: f32x8<S>,
    /// Side of a box (low 0, high 1) through which the ray enters.
    near: usize,
}

// Vector code has no closures: only functions that are always inlined are compiled for the processor
// that is dispatched to.
impl<S: Simd> Slab<S> {
    #[inline(always)]
    fn new(simd: S, origin: f32, reciprocal: f64) -> Self {
        let reciprocal = reciprocal.clamp(-MAX_RECIPROCAL, MAX_RECIPROCAL) as f32;
        Self {
            reciprocal: f32x8::splat(simd, reciprocal),
            origin_product: f32x8::splat(simd, reciprocal * origin),
            near: usize::from(reciprocal < 0.0),
        }
    }

    /// Distances to the planes through which the ray enters the boxes.
    #[inline(always)]
    fn entries(&self, simd: S, planes: &[[f32; WIDTH]; 2]) -> f32x8<S> {
        f32x8::simd_from(simd, planes[self.near & 1]).mul_sub(self.reciprocal, self.origin_product)
    }

    /// Distances to the planes through which the ray leaves the boxes.
    #[inline(always)]
    fn exits(&self, simd: S, planes: &[[f32; WIDTH]; 2]) -> f32x8<S> {
        f32x8::simd_from(simd, planes[(self.near & 1) ^ 1]).mul_sub(self.reciprocal, self.origin_product)
    }
}

impl<S: Simd> Probe<S> {
    #[inline(always)]
    fn new(simd: S, ray: &Ray, frame: &TreeTransform) -> Self {
        let origin = frame.tree_from_mesh(ray.origin).as_vec3();
        let ([first, second, last], [shear_first, shear_second]) = (ray.axes(), ray.shear());
        Self {
            x: Slab::new(simd, origin.x, ray.reciprocal.x),
            y: Slab::new(simd, origin.y, ray.reciprocal.y),
            z: Slab::new(simd, origin.z, ray.reciprocal.z),
            axes: [first, second, last],
            origin: [
                f32x8::splat(simd, origin[first]),
                f32x8::splat(simd, origin[second]),
                f32x8::splat(simd, origin[last]),
            ],
            shear: [f32x8::splat(simd, shear_first as f32), f32x8::splat(simd, shear_second as f32)],
        }
    }

    /// Entry distances into the boxes of a node, and the bit mask of the boxes entered within `farthest`.
    #[inline(always)]
    fn enter_boxes(&self, simd: S, node: &Node, farthest: f32) -> ([f32; WIDTH], u32) {
        let [x, y, z] = &node.planes;
        let near = self
            .x
            .entries(simd, x)
            .max(self.y.entries(simd, y))
            .max(self.z.entries(simd, z).max(f32x8::splat(simd, 0.0)));
        let far = self
            .x
            .exits(simd, x)
            .min(self.y.exits(simd, y))
            .min(self.z.exits(simd, z).min(f32x8::splat(simd, farthest)));
        (near.into(), near.simd_le(far).to_bitmask() as u32)
    }

    /// One corner of each of a batch's triangles in ray coordinates, sheared so that the ray runs through 0.
    #[inline(always)]
    fn sheared(&self, simd: S, batch: &TriangleBatch, corner: usize) -> (f32x8<S>, f32x8<S>) {
        let [first, second, last] = self.axes;
        let ahead = f32x8::simd_from(simd, batch.tree_corners[last][corner]) - self.origin[2];
        let x = f32x8::simd_from(simd, batch.tree_corners[first][corner]) - self.origin[0] - self.shear[0] * ahead;
        let y = f32x8::simd_from(simd, batch.tree_corners[second][corner]) - self.origin[1] - self.shear[1] * ahead;
        (x, y)
    }

    /// Bit mask of the triangles of a batch that the ray's line may hit.
    ///
    /// In units of u, the rounding error near 1: a corner relative to the origin has an error of 4.1 u, and 17 u on
    /// each axis after shearing. Let m, at most 4.2, be the maximum of these coordinates. Then the offset of an edge
    /// has an error of 4 (17 u) m + 4 m^2 u < 86 u m, plus 2 (17 u)^2 where m is about as small as u. The margin is 128
    /// u (m + 2^-18).
    #[inline(always)]
    fn may_hit(&self, simd: S, batch: &TriangleBatch) -> u32 {
        let (ax, ay) = self.sheared(simd, batch, 0);
        let (bx, by) = self.sheared(simd, batch, 1);
        let (cx, cy) = self.sheared(simd, batch, 2);
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        let spread = ax.abs().max(ay.abs()).max(bx.abs().max(by.abs())).max(cx.abs().max(cy.abs()));
        let slack = (spread + f32x8::splat(simd, 1.0 / (1 << 18) as f32)) * f32x8::splat(simd, 1.0 / (1 << 17) as f32);
        // False where a corner is NaN.
        let is_left = u.min(v).min(w).simd_ge(-slack);
        let is_right = u.max(v).max(w).simd_le(slack);
        (is_left | is_right).to_bitmask() as u32
    }
}

/// A distance in tree units, rounded up.
#[inline(always)]
fn upper_bound(distance: f64, frame: &TreeTransform) -> f32 {
    ((distance * frame.scale).min(MAX_PATH) * (1.0 + 1e-6)) as f32
}

/// A child with the entry distance of its box in the upper bits, which sort as numbers because they are not negative.
#[inline(always)]
fn entry(near: &[f32; WIDTH], node: &Node, lane: u32) -> u64 {
    let lane = lane as usize % WIDTH;
    u64::from(near[lane].to_bits()) << 32 | u64::from(node.children[lane].0)
}

#[inline(always)]
fn walk<S: Simd, const STACK: usize>(simd: S, tree: &Tree, root: Child, frame: &TreeTransform, ray: &mut Ray) {
    let probe = Probe::new(simd, ray, frame);
    let mut farthest = upper_bound(ray.distance(), frame);
    let mut stack = [0_u64; STACK];
    let mut count = 0;
    let mut child = root;
    loop {
        if let Some(index) = child.as_batch() {
            let batch = &tree.batches[index];
            let mut hit_lanes = probe.may_hit(simd, batch);
            if hit_lanes != 0 {
                while hit_lanes != 0 {
                    let lane = hit_lanes.trailing_zeros() as usize % WIDTH;
                    ray.test(&batch.corners[lane], batch.numbers[lane], (index, lane));
                    hit_lanes &= hit_lanes - 1;
                }
                farthest = upper_bound(ray.distance(), frame);
            }
        } else {
            let node = &tree.nodes[child.0 as usize];
            let (near, mut hit_lanes) = probe.enter_boxes(simd, node, farthest);
            if hit_lanes != 0 {
                let first = hit_lanes.trailing_zeros();
                hit_lanes &= hit_lanes - 1;
                if hit_lanes == 0 {
                    child = node.children[first as usize % WIDTH];
                    continue;
                }
                let mut nearest = entry(&near, node, first);
                let start = count;
                while hit_lanes != 0 {
                    let next = entry(&near, node, hit_lanes.trailing_zeros());
                    hit_lanes &= hit_lanes - 1;
                    let farther = nearest.max(next);
                    nearest = nearest.min(next);
                    // Insertion sort with the nearest entry last.
                    let mut index = count;
                    while index > start && stack[index - 1] < farther {
                        stack[index] = stack[index - 1];
                        index -= 1;
                    }
                    stack[index] = farther;
                    count += 1;
                }
                child = Child(nearest as u32);
                continue;
            }
        }
        child = loop {
            if count == 0 {
                return;
            }
            count -= 1;
            let entry = stack[count];
            if f32::from_bits((entry >> 32) as u32) <= farthest {
                break Child(entry as u32);
            }
        };
    }
}
