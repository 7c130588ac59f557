//! Reachability of positions in a scene.

use std::collections::VecDeque;

use glam::DVec2;

use super::FreeSpace;

/// Step of the grid as a fraction of the diameter of the disc.
const STEP: f64 = 0.125;

/// Maximum number of steps along a side of the floor.
const MAX_STEPS: f64 = 2000.0;

/// Returns true if a disc of this radius can move from `from` to `to`, on a floor of this size, without touching walls
/// or discs of `space`. `from` and `to` are each a point with the distance from it at which the path may begin or end.
///
/// The path is searched on a grid with steps of an eighth of the disc's diameter, but at most 2000 steps along each
/// side of the floor. A path that is found is free of contacts along its whole length. The search may miss a path
/// through gaps that are hardly wider than the disc.
pub(crate) fn is_reachable(space: &FreeSpace, floor: DVec2, radius: f64, from: (DVec2, f64), to: (DVec2, f64)) -> bool {
    let step = (2.0 * radius * STEP).max(floor.max_element() / MAX_STEPS).max(1e-3);
    let [columns, rows] = (floor / step).floor().to_array().map(|count| count as usize + 1);
    // If a disc of this radius is free at both ends of a step, a disc of the given radius is free along the whole step.
    // The reason is that the point of a convex obstacle nearest to the step is at most half a step from one of the
    // ends, measured along the step.
    let inflated_radius = (radius * radius + 0.25 * step * step).sqrt();
    let diagonal = std::f64::consts::SQRT_2 * step;
    let point = |node: usize| DVec2::new((node % columns) as f64, (node / columns) as f64) * step;
    let mut is_visited = vec![false; columns * rows];
    let mut queue = VecDeque::new();
    for (node, is_visited) in is_visited.iter_mut().enumerate() {
        let centre = point(node);
        if centre.distance(from.0) <= from.1 + diagonal && space.is_free(centre, inflated_radius) {
            *is_visited = true;
            queue.push_back(node);
        }
    }
    while let Some(node) = queue.pop_front() {
        if point(node).distance(to.0) <= to.1 + diagonal {
            return true;
        }
        let (column, row) = (node % columns, node / columns);
        let neighbours = [
            (column > 0).then(|| node - 1),
            (column + 1 < columns).then(|| node + 1),
            (row > 0).then(|| node - columns),
            (row + 1 < rows).then(|| node + columns),
        ];
        for next in neighbours.into_iter().flatten() {
            if !is_visited[next] && space.is_free(point(next), inflated_radius) {
                is_visited[next] = true;
                queue.push_back(next);
            }
        }
    }
    false
}
