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
    /// Expected costs of the subtree as at most 1, 2, ... 7 children of a wide node.
    costs: [f32; WIDTH - 1],
    /// Number of children of the left subtree out of at most 2, 3, ... 8; 0 if one child fewer in total is as good.
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

    /// Indices of all boxes below a subtree.
    pub fn places(&self, root: usize) -> &[usize] {
        &self.order[self.subtrees[root].range.clone()]
    }

    /// Appends the subtrees that become the children, at most `parts`, of a wide node made of `root`.
    pub fn split(&self, root: usize, parts: usize, into: &mut Vec<usize>) {
        let Some(left) = self.subtrees[root].left.filter(|_| parts > 1) else {
            into.push(root);
            return;
        };
        match self.subtrees[root].best.left_parts[parts - 2] {
            0 => self.split(root, parts - 1, into),
            left_parts => {
                self.split(left, left_parts, into);
                self.split(left + 1, parts - left_parts, into);
            }
        }
    }

    /// Computes the cheapest collapse of a subtree. Source: Ylitie, Karras and Laine 2017, section 3.1.
    fn cheapest_collapse(&self, index: usize, batch_cost: f32) -> Collapse {
        let fork = &self.subtrees[index];
        let area = fork.bounds.half_area();
        let batch = area * batch_cost;
        let Some(left) = fork.left else {
            return Collapse { costs: [batch; WIDTH - 1], left_parts: [0; WIDTH - 1], is_leaf: true };
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
        let inner = area + costs[WIDTH];
        best.is_leaf = fork.range.len() <= WIDTH && batch <= inner;
        best.costs[0] = if best.is_leaf { batch } else { inner };
        for (parts, &cost) in costs.iter().enumerate().take(WIDTH).skip(2) {
            let fewer = best.costs[parts - 2];
            if fewer <= cost {
                best.left_parts[parts - 2] = 0;
            }
            best.costs[parts - 1] = fewer.min(cost);
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

/// Partitions `order` where the expected cost is lowest, and returns the size of the first part. Both parts are
/// non-empty.
///
/// Source: Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007. If all middles coincide, the
/// boxes are split in half by count.
fn split(boxes: &[Box3], order: &mut [usize]) -> usize {
    let middles = order.iter().fold(Box3::EMPTY, |all, &index| all.union(Box3::at(boxes[index].middle())));
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
        for at in (0..BINS).rev() {
            above[at] = (above[at + 1].0.union(bins[at].0), above[at + 1].1 + bins[at].1);
        }
        let mut below = (Box3::EMPTY, 0);
        for at in 1..BINS {
            below = (below.0.union(bins[at - 1].0), below.1 + bins[at - 1].1);
            if below.1 == 0 || above[at].1 == 0 {
                continue;
            }
            let cost = below.0.half_area() * below.1 as f32 + above[at].0.half_area() * above[at].1 as f32;
            if cost < best.0 {
                best = (cost, axis, at);
            }
        }
    }
    let (cost, axis, at) = best;
    if cost == f32::INFINITY {
        return order.len() / 2;
    }
    let mut first = 0;
    for index in 0..order.len() {
        if bin(order[index], axis) < at {
            order.swap(first, index);
            first += 1;
        }
    }
    first
}
