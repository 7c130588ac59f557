//! The wide tree: a binary tree collapsed to eight children per node at the minimum expected cost.

use glam::{DVec3, Vec3};

use super::binary::Binary;
use super::node::{Box3, Child, Node, PADDING, Tree, TriangleBatch, WIDTH};
use super::transform::TreeTransform;

/// Maximum depth of a tree.
pub(super) const MAX_DEPTH: usize = 24;

/// Depth from which subtrees are split by count, so that 2^28 triangles fit into the remaining levels.
const BALANCED_FROM: usize = 14;

/// Cost of testing a batch relative to a node.
const BATCH_COST: f32 = 1.0;

/// The tree over the triangles with these `indices`.
pub(super) fn tree(triangles: &[[DVec3; 3]], indices: &[u32], frame: &TreeTransform) -> Tree {
    let tree_corners: Vec<[Vec3; 3]> = indices
        .iter()
        .map(|&index| triangles[index as usize].map(|corner| frame.tree_from_mesh(corner).as_vec3()))
        .collect();
    let boxes: Vec<Box3> = tree_corners.iter().map(padded).collect();
    let mut builder = Builder { triangles, indices, tree_corners: &tree_corners, boxes: &boxes, tree: Tree::default() };
    builder.tree.root = Some(builder.subtree(&Binary::new(&boxes, BATCH_COST), 0, 0).0);
    builder.tree
}

fn padded(corners: &[Vec3; 3]) -> Box3 {
    let [a, b, c] = *corners;
    Box3 { low: a.min(b).min(c) - PADDING, high: a.max(b).max(c) + PADDING }
}

struct Builder<'a> {
    /// Corners of all triangles, by index.
    triangles: &'a [[DVec3; 3]],
    /// Indices of the triangles of the tree; the next two lists have the same order.
    indices: &'a [u32],
    /// Corners in the coordinates of the tree.
    tree_corners: &'a [[Vec3; 3]],
    boxes: &'a [Box3],
    tree: Tree,
}

impl Builder<'_> {
    /// Adds a subtree of the binary tree as one child.
    fn subtree(&mut self, binary: &Binary, root: usize, depth: usize) -> (Child, Box3) {
        if binary.is_leaf(root) {
            return self.batch(binary.boxes_below(root).to_vec());
        }
        if depth >= BALANCED_FROM {
            return self.balanced(binary.boxes_below(root).to_vec(), depth);
        }
        let node = self.reserve(depth);
        let mut parts = Vec::with_capacity(WIDTH);
        binary.split(root, WIDTH, &mut parts);
        let children: Vec<_> = parts.into_iter().map(|part| self.subtree(binary, part, depth + 1)).collect();
        self.fill(node, &children)
    }

    /// Adds the triangles at these positions of the lists as one child, split only by count.
    fn balanced(&mut self, mut positions: Vec<usize>, depth: usize) -> (Child, Box3) {
        if positions.len() <= WIDTH {
            return self.batch(positions);
        }
        let bounds = self.bounds(&positions);
        let size = bounds.high - bounds.low;
        let axis = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let middle = |position: &usize| self.boxes[*position].low[axis] + self.boxes[*position].high[axis];
        positions.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
        let node = self.reserve(depth);
        let per_child = positions.len().div_ceil(WIDTH);
        let children: Vec<_> =
            positions.chunks(per_child).map(|part| self.balanced(part.to_vec(), depth + 1)).collect();
        self.fill(node, &children)
    }

    fn bounds(&self, positions: &[usize]) -> Box3 {
        positions.iter().fold(Box3::EMPTY, |bounds, &position| bounds.union(self.boxes[position]))
    }

    /// Adds a batch of triangles as one child.
    fn batch(&mut self, mut positions: Vec<usize>) -> (Child, Box3) {
        positions.sort_unstable();
        let mut batch = TriangleBatch::EMPTY;
        for (lane, &position) in positions.iter().enumerate() {
            let index = self.indices[position];
            batch.numbers[lane] = index;
            batch.corners[lane] = self.triangles[index as usize];
            for (vertex, corner) in self.tree_corners[position].iter().enumerate() {
                for axis in 0..3 {
                    batch.tree_corners[axis][vertex][lane] = corner[axis];
                }
            }
        }
        self.tree.batches.push(batch);
        (Child::batch(self.tree.batches.len() - 1), self.bounds(&positions))
    }

    /// Adds an empty node at `depth` (0: the root) and returns its index.
    fn reserve(&mut self, depth: usize) -> usize {
        self.tree.depth = self.tree.depth.max(depth + 1);
        // Rays enter these boxes at infinity, that is, never.
        let planes = [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3];
        self.tree.nodes.push(Node { planes, children: [Child::default(); WIDTH] });
        self.tree.nodes.len() - 1
    }

    /// Sets the children of node `index`; returns the node as a child and its bounds.
    fn fill(&mut self, index: usize, children: &[(Child, Box3)]) -> (Child, Box3) {
        let node = &mut self.tree.nodes[index];
        for (lane, (child, bounds)) in children.iter().enumerate() {
            node.children[lane] = *child;
            for axis in 0..3 {
                node.planes[axis][0][lane] = bounds.low[axis];
                node.planes[axis][1][lane] = bounds.high[axis];
            }
        }
        (Child::node(index), children.iter().fold(Box3::EMPTY, |union, (_, bounds)| union.union(*bounds)))
    }
}
