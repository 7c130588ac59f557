//! Binary tree by the surface area heuristic, and the cheapest ways to collapse it into wide nodes.

use std::ops::Range;

use super::node::{Box3, WIDTH};

/// Number of bins per axis for candidate splits.
const BINS: usize = 32;

/// A binary tree over boxes, with single boxes as leaves.
pub(super) struct Binary {
    subtrees: Vec<Subtree>,
    /// Indices of the boxes, ordered so that the boxes of each subtree are contiguous.
    order: Vec<usize>,
}

/// A subtree. Its children come later in the list.
struct Subtree {
    bounds: Box3,
    /// Its boxes in [`Binary::order`].
    range: Range<usize>,
    /// The left child; the right one follows it in the list. `None` for a single box.
    left: Option<usize>,
    best: Collapse,
}

/// The cheapest way to collapse a subtree.
#[derive(Default)]
struct Collapse {
    /// Expected cost if the subtree becomes at most 1, 2, ... 7 children of a wide node.
    costs: [f32; WIDTH - 1],
    /// Number of children from the left subtree if the subtree becomes at most 2, 3, ... 8 children; 0 if one child
    /// fewer in total costs no more.
    left_parts: [usize; WIDTH - 1],
    /// True if the subtree, as one child, is cheapest as a batch of triangles.
    is_leaf: bool,
}

impl Binary {
    /// The tree over `boxes`, which must not be empty; testing a batch costs `batch_cost` times as much as testing a
    /// node.
    pub fn new(boxes: &[Box3], batch_cost: f32) -> Self {
        let mut order: Vec<usize> = (0..boxes.len()).collect();
        let mut subtrees = vec![Subtree::new(boxes, &order, 0..boxes.len())];
        let mut next = 0;
        while let Some(Subtree { range, .. }) = subtrees.get(next) {
            let range = range.clone();
            if range.len() > 1 {
                let middle = range.start + split(boxes, &mut order[range.clone()]);
                subtrees[next].left = Some(subtrees.len());
                subtrees.push(Subtree::new(boxes, &order, range.start..middle));
                subtrees.push(Subtree::new(boxes, &order, middle..range.end));
            }
            next += 1;
        }
        let mut binary = Self { subtrees, order };
        for index in (0..binary.subtrees.len()).rev() {
            binary.subtrees[index].best = binary.cheapest_collapse(index, batch_cost);
        }
        binary
    }

    /// Returns true if the subtree is cheapest as a batch of triangles.
    pub fn is_leaf(&self, root: usize) -> bool {
        self.subtrees[root].best.is_leaf
    }

    /// Indices of all boxes of a subtree.
    pub fn boxes_below(&self, root: usize) -> &[usize] {
        &self.order[self.subtrees[root].range.clone()]
    }

    /// Splits the subtree `root` into at most `parts` subtrees, the children of a wide node, and appends them to
    /// `children`.
    pub fn split(&self, root: usize, parts: usize, children: &mut Vec<usize>) {
        let Some(left) = self.subtrees[root].left.filter(|_| parts > 1) else {
            children.push(root);
            return;
        };
        match self.subtrees[root].best.left_parts[parts - 2] {
            0 => self.split(root, parts - 1, children),
            left_parts => {
                self.split(left, left_parts, children);
                self.split(left + 1, parts - left_parts, children);
            }
        }
    }

    /// Computes the cheapest collapse of a subtree. Source: Ylitie, Karras and Laine 2017, section 3.1.
    fn cheapest_collapse(&self, index: usize, batch_cost: f32) -> Collapse {
        let subtree = &self.subtrees[index];
        let area = subtree.bounds.half_area();
        let leaf_cost = area * batch_cost;
        let Some(left) = subtree.left else {
            return Collapse { costs: [leaf_cost; WIDTH - 1], left_parts: [0; WIDTH - 1], is_leaf: true };
        };
        let mut best = Collapse::default();
        // Indexed by the number of parts.
        let mut costs = [f32::INFINITY; WIDTH + 1];
        for (parts, min_cost) in costs.iter_mut().enumerate().skip(2) {
            for left_parts in 1..parts {
                let cost = self.subtrees[left].best.costs[left_parts - 1]
                    + self.subtrees[left + 1].best.costs[parts - left_parts - 1];
                if cost < *min_cost {
                    *min_cost = cost;
                    best.left_parts[parts - 2] = left_parts;
                }
            }
        }
        let node_cost = area + costs[WIDTH];
        best.is_leaf = subtree.range.len() <= WIDTH && leaf_cost <= node_cost;
        best.costs[0] = if best.is_leaf { leaf_cost } else { node_cost };
        for (parts, &cost) in costs.iter().enumerate().take(WIDTH).skip(2) {
            let cost_with_fewer = best.costs[parts - 2];
            if cost_with_fewer <= cost {
                best.left_parts[parts - 2] = 0;
            }
            best.costs[parts - 1] = cost_with_fewer.min(cost);
        }
        best
    }
}

impl Subtree {
    fn new(boxes: &[Box3], order: &[usize], range: Range<usize>) -> Self {
        let bounds = order[range.clone()].iter().fold(Box3::EMPTY, |bounds, &index| bounds.union(boxes[index]));
        Self { bounds, range, left: None, best: Collapse::default() }
    }
}

/// Partitions `order` into two non-empty parts at the lowest expected cost, and returns the size of the first part. If
/// the centres of all boxes coincide, both parts have the same number of boxes.
///
/// Source: Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007.
fn split(boxes: &[Box3], order: &mut [usize]) -> usize {
    let middle_box = |index: usize| Box3::of_point(boxes[index].middle());
    let middles = order.iter().fold(Box3::EMPTY, |bounds, &index| bounds.union(middle_box(index)));
    let size = middles.high - middles.low;
    let bin = |index: usize, axis: usize| {
        let fraction = (boxes[index].middle()[axis] - middles.low[axis]) / size[axis];
        ((fraction * BINS as f32) as usize).min(BINS - 1)
    };
    let mut best = (f32::INFINITY, 0, 0);
    for axis in (0..3).filter(|&axis| size[axis] > 0.0) {
        let mut bins = [(Box3::EMPTY, 0_usize); BINS];
        for &index in &*order {
            let (bounds, count) = &mut bins[bin(index, axis)];
            *bounds = bounds.union(boxes[index]);
            *count += 1;
        }
        let mut above = [(Box3::EMPTY, 0_usize); BINS + 1];
        for first_bin in (0..BINS).rev() {
            let (bounds, count) = above[first_bin + 1];
            above[first_bin] = (bounds.union(bins[first_bin].0), count + bins[first_bin].1);
        }
        let mut below = (Box3::EMPTY, 0);
        for split_bin in 1..BINS {
            below = (below.0.union(bins[split_bin - 1].0), below.1 + bins[split_bin - 1].1);
            let above = above[split_bin];
            if below.1 == 0 || above.1 == 0 {
                continue;
            }
            let cost = below.0.half_area() * below.1 as f32 + above.0.half_area() * above.1 as f32;
            if cost < best.0 {
                best = (cost, axis, split_bin);
            }
        }
    }
    let (cost, axis, split_bin) = best;
    if cost == f32::INFINITY {
        return order.len() / 2;
    }
    let mut first = 0;
    for index in 0..order.len() {
        if bin(order[index], axis) < split_bin {
            order.swap(first, index);
            first += 1;
        }
    }
    first
}
