//! The profile of the floor from points: heights of cells, the error at a step, and edges.

use glam::DVec2;

use super::crossing::Step;

/// Minimum number of points on each side of an edge.
const SIDE: usize = 2;

/// Known heights, as pairs of the middle of a cell and its height, in ascending order: in each cell of the width `cell` (m) the median of the
/// points in it. Under the standing foot the height is known without a sensor.
pub fn known<'a>(step: &Step, points: impl Iterator<Item = &'a DVec2>, cell: f64) -> Vec<(f64, f64)> {
    let index = |x: f64| (x / cell).floor() as i64;
    let [heel, toe] = step.stand.map(|x| index(x + step.shift));
    let mut cells: Vec<(i64, f64)> = (heel..=toe).map(|cell| (cell, step.stand_height)).collect();
    let own = |point: &&DVec2| !(heel..=toe).contains(&index(point.x));
    cells.extend(points.filter(own).map(|point| (index(point.x), point.y)));
    cells.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let middle = |group: &[(i64, f64)]| {
        let heights = [group[(group.len() - 1) / 2].1, group[group.len() / 2].1];
        ((group[0].0 as f64 + 0.5) * cell, 0.5 * (heights[0] + heights[1]))
    };
    cells.chunk_by(|a, b| a.0 == b.0).map(middle).collect()
}

/// Height at a place: linear between known heights, constant beyond the last and before the first.
pub fn height(known: &[(f64, f64)], x: f64) -> f64 {
    let next = known.partition_point(|(middle, _)| *middle <= x);
    match (next.checked_sub(1).map(|before| known[before]), known.get(next)) {
        (Some((x0, z0)), Some((x1, z1))) => z0 + (z1 - z0) * (x - x0) / (x1 - x0),
        (Some((_, z)), None) | (None, Some(&(_, z))) => z,
        (None, None) => f64::NAN,
    }
}

/// Root mean square error of the profile over the ground that a step needs, m.
pub fn error<'a>(step: &Step, points: impl Iterator<Item = &'a DVec2>, cell: f64) -> f64 {
    let known = known(step, points, cell);
    let square = |(x, truth): (&f64, &f64)| (height(&known, x + step.shift) - truth).powi(2);
    let sum: f64 = step.xs.iter().zip(&step.truth).map(square).sum();
    (sum / step.xs.len() as f64).sqrt()
}

/// The step between two levels that fits points best: its place and rise, m; `None` with fewer than two points on a side. The levels are medians,
/// and the sum of the absolute differences from them is least.
pub fn edge(points: &[DVec2]) -> Option<(f64, f64)> {
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    let level = |side: &[DVec2]| {
        let mut heights: Vec<f64> = side.iter().map(|point| point.y).collect();
        heights.sort_by(f64::total_cmp);
        let median = heights[heights.len() / 2];
        (median, heights.iter().map(|height| (height - median).abs()).sum::<f64>())
    };
    let splits = SIDE..(points.len() + 1).saturating_sub(SIDE);
    let fit = |split: usize| {
        let ((before, b), (after, a)) = (level(&points[..split]), level(&points[split..]));
        (a + b, 0.5 * (points[split - 1].x + points[split].x), after - before)
    };
    let best = splits.map(fit).min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((best.1, best.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step() -> Step {
        let xs: Vec<f64> = (0..=35).map(|index| 1.0 + 0.02 * f64::from(index)).collect();
        Step {
            at: 1.0,
            truth: xs.iter().map(|x| if *x < 1.5 { 0.0 } else { 0.1 }).collect(),
            xs,
            stand: [0.8, 1.0],
            stand_height: 0.0,
            foothold: 1.55,
            shift: 0.0,
        }
    }

    #[test]
    fn a_robot_without_sensors_expects_level_ground() {
        let step = step();
        let high = step.truth.iter().filter(|height| **height > 0.0).count() as f64;
        let expected = 0.1 * (high / step.truth.len() as f64).sqrt();
        assert!((error(&step, [].iter(), 0.04) - expected).abs() < 1e-12);
    }

    #[test]
    fn dense_exact_points_leave_no_error_but_at_the_edge() {
        let step = step();
        let points: Vec<DVec2> = step.xs.iter().zip(&step.truth).map(|(x, z)| DVec2::new(*x, *z)).collect();
        assert!(error(&step, points.iter(), 0.02) < 0.02);
        // Odometry that is ahead moves points and step alike.
        let moved: Vec<DVec2> = points.iter().map(|point| DVec2::new(point.x + 0.4, point.y)).collect();
        let shifted = Step { shift: 0.4, ..step };
        assert!(error(&shifted, moved.iter(), 0.02) < 0.02);
    }

    #[test]
    fn an_edge_is_found_between_its_points() {
        let points: Vec<DVec2> =
            (0..20).map(|index| DVec2::new(0.05 * f64::from(index), if index < 8 { 0.3 } else { 0.1 })).collect();
        let (at, rise) = edge(&points).expect("an edge");
        assert!((at - 0.375).abs() < 1e-9 && (rise + 0.2).abs() < 1e-9, "{at} {rise}");
        assert_eq!(edge(&points[..3]), None);
    }
}
