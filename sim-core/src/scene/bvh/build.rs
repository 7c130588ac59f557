//! The wide tree: a binary tree collapsed to eight children per node at the least expected cost.

use glam::{DVec3, Vec3};

use super::binary::Binary;
use super::frame::Frame;
use super::node::{Box3, Child, Node, PADDING, Tree, TriangleBatch, WIDTH};

/// Maximum depth of a tree.
pub(super) const DEPTH: usize = 24;

/// Depth from which subtrees are split by count, so that 2^28 triangles fit into the remaining levels.
const BALANCED_FROM: usize = 14;

/// Cost of testing a batch relative to a node.
const BATCH_COST: f32 = 1.0;

/// The tree over the `triangles` whose numbers are in `met`.
pub(super) fn tree(triangles: &[[DVec3; 3]], met: &[u32], frame: &Frame) -> Tree {
    let seen: Vec<[Vec3; 3]> = met
        .iter()
        .map(|&number| triangles[number as usize].map(|corner| frame.tree_from_mesh(corner).as_vec3()))
        .collect();
    let boxes: Vec<Box3> = seen.iter().map(padded).collect();
    let mut builder = Builder { triangles, numbers: met, seen: &seen, boxes: &boxes, tree: Tree::default() };
    builder.tree.root = Some(builder.subtree(&Binary::new(&boxes, BATCH_COST), 0, 0).0);
    builder.tree
}

fn padded(corners: &[Vec3; 3]) -> Box3 {
    let [a, b, c] = *corners;
    Box3 { low: a.min(b).min(c) - PADDING, high: a.max(b).max(c) + PADDING }
}

struct Builder<'a> {
    /// Indexed by triangle number.
    triangles: &'a [[DVec3; 3]],
    /// Indexed by place: the triangle's number, its corners in the tree's coordinates and its box.
    numbers: &'a [u32],
    seen: &'a [[Vec3; 3]],
    boxes: &'a [Box3],
    tree: Tree,
}

impl Builder<'_> {
    /// Adds a subtree of the binary tree as one child.
    fn subtree(&mut self, binary: &Binary, root: usize, depth: usize) -> (Child, Box3) {
        if binary.is_block(root) {
            return self.batch(binary.places(root).to_vec());
        }
        if depth >= BALANCED_FROM {
            return self.balanced(binary.places(root).to_vec(), depth);
        }
        let place = self.reserve(depth);
        let mut parts = Vec::with_capacity(WIDTH);
        binary.split(root, WIDTH, &mut parts);
        let children: Vec<_> = parts.into_iter().map(|part| self.subtree(binary, part, depth + 1)).collect();
        self.fill(place, &children)
    }

    /// Adds triangles as one child, split by count alone.
    fn balanced(&mut self, mut places: Vec<usize>, depth: usize) -> (Child, Box3) {
        if places.len() <= WIDTH {
            return self.batch(places);
        }
        let bounds = self.bounds(&places);
        let size = bounds.high - bounds.low;
        let axis = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let middle = |place: &usize| self.boxes[*place].low[axis] + self.boxes[*place].high[axis];
        places.sort_by(|one, other| middle(one).total_cmp(&middle(other)));
        let place = self.reserve(depth);
        let share = places.len().div_ceil(WIDTH);
        let children: Vec<_> = places.chunks(share).map(|part| self.balanced(part.to_vec(), depth + 1)).collect();
        self.fill(place, &children)
    }

    fn bounds(&self, places: &[usize]) -> Box3 {
        places.iter().fold(Box3::EMPTY, |bounds, &place| bounds.union(self.boxes[place]))
    }

    fn batch(&mut self, mut places: Vec<usize>) -> (Child, Box3) {
        places.sort_unstable();
        let mut batch = TriangleBatch::EMPTY;
        for (lane, &place) in places.iter().enumerate() {
            let number = self.numbers[place];
            batch.numbers[lane] = number;
            batch.corners[lane] = self.triangles[number as usize];
            for (number, corner) in self.seen[place].iter().enumerate() {
                for axis in 0..3 {
                    batch.seen[axis][number][lane] = corner[axis];
                }
            }
        }
        self.tree.batches.push(batch);
        (Child::batch(self.tree.batches.len() - 1), self.bounds(&places))
    }

    /// Adds an empty node at this depth; that of the root is 0.
    fn reserve(&mut self, depth: usize) -> usize {
        self.tree.depth = self.tree.depth.max(depth + 1);
        // Boxes that no ray enters: their entry is at infinity.
        let planes = [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3];
        self.tree.nodes.push(Node { planes, children: [Child::default(); WIDTH] });
        self.tree.nodes.len() - 1
    }

    fn fill(&mut self, place: usize, children: &[(Child, Box3)]) -> (Child, Box3) {
        let node = &mut self.tree.nodes[place];
        for (lane, (child, bounds)) in children.iter().enumerate() {
            node.children[lane] = *child;
            for axis in 0..3 {
                node.planes[axis][0][lane] = bounds.low[axis];
                node.planes[axis][1][lane] = bounds.high[axis];
            }
        }
        (Child::node(place), children.iter().fold(Box3::EMPTY, |all, (_, bounds)| all.union(*bounds)))
    }
}
