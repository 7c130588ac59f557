//! Distance of segments from the ground, and height bounds of the ground under discs.

use glam::{DVec2, DVec3};

use super::HeightField;
use crate::scene::Bounds;
use crate::scene::distance::segment_to_triangle;

impl HeightField {
    /// Distance of a segment from the ground, in metres; 0 if they touch. If a part of the segment is below the ground,
    /// the result is the negative of its maximum depth.
    ///
    /// `ends` are in the world frame. A distance up to `max_distance` is exact; a larger one gives `max_distance`.
    /// Outside the field's rectangle, the result is the height above the nearest point of its border. NaN if a
    /// coordinate is NaN.
    pub fn clearance(&self, ends: [DVec3; 2], max_distance: f64) -> f64 {
        let (gap, _) = self.min_height_above(ends);
        if gap.is_nan() || gap <= 0.0 {
            return gap;
        }
        let mut minimum = gap.min(max_distance.max(0.0));
        let [a, b] = ends;
        let lowest = a.z.min(b.z);
        let segment_bounds = Bounds::of_points([a.truncate(), b.truncate()]);
        if lowest - self.height_bounds().1 >= minimum || !segment_bounds.grown(minimum).overlaps(&self.bounds()) {
            return minimum;
        }
        let [columns, rows] = self.cells(&segment_bounds.grown(minimum));
        for row in rows {
            for column in columns.clone() {
                // Bounding boxes of cell and segment are no farther apart than their contents.
                let low = self.corner(column, row).truncate();
                let high = self.corner(column + 1, row + 1).truncate();
                let separation = (low - segment_bounds.max).max(segment_bounds.min - high).max(DVec2::ZERO);
                let highest = self.cell(column, row).into_iter().fold(f64::NEG_INFINITY, f64::max);
                let above = (lowest - highest).max(0.0);
                if separation.length_squared() + above * above >= minimum * minimum {
                    continue;
                }
                for triangle in self.triangles(column, row) {
                    minimum = minimum.min(segment_to_triangle(ends, triangle));
                }
            }
        }
        minimum
    }

    /// Minimum height of the points of the segment above the ground, in metres, negative if the point is below; and the
    /// point with that height.
    ///
    /// Segment and ground are linear between the lines of the grid and the diagonals, so only the crossings must be
    /// tested. NaN if a coordinate is NaN.
    pub fn min_height_above(&self, [a, b]: [DVec3; 2]) -> (f64, DVec3) {
        if a.is_nan() || b.is_nan() {
            return (f64::NAN, a);
        }
        let along = b - a;
        let point = |fraction: f64| (a + fraction * along).truncate();
        // The crossed coordinate is set exactly: on a step, `height` then gives the upper edge.
        let crossings = |lines: &[f64], start: f64, delta: f64, snap: fn(DVec2, f64) -> DVec2| -> Vec<(f64, DVec2)> {
            let crossing = |line: &f64| ((line - start) / delta, *line);
            let crossed = lines.iter().map(crossing).filter(|(fraction, _)| 0.0 < *fraction && *fraction < 1.0);
            crossed.map(|(fraction, line)| (fraction, snap(point(fraction), line))).collect()
        };
        let mut breaks = vec![(0.0, a.truncate()), (1.0, b.truncate())];
        breaks.extend(crossings(&self.xs, a.x, along.x, |point, line| point.with_x(line)));
        breaks.extend(crossings(&self.ys, a.y, along.y, |point, line| point.with_y(line)));
        breaks.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut minimum = (f64::INFINITY, 0.0);
        let mut test_point = |fraction: f64, point: DVec2| {
            let gap = a.z + fraction * along.z - self.height(point.x, point.y);
            if gap < minimum.0 {
                minimum = (gap, fraction);
            }
        };
        breaks.iter().for_each(|(fraction, point)| test_point(*fraction, *point));
        for pair in breaks.windows(2).filter(|pair| pair[0].0 < pair[1].0) {
            let (first, last) = (pair[0].0, pair[1].0);
            let middle = point(0.5 * (first + last));
            let [columns, rows] = self.cells(&Bounds { min: middle, max: middle });
            for (column, row) in columns.flat_map(|column| rows.clone().map(move |row| (column, row))) {
                // Seen from above: positive to the left of the cell's diagonal, negative to its right.
                let low = self.corner(column, row).truncate();
                let diagonal = self.corner(column + 1, row + 1).truncate() - low;
                let side = |fraction: f64| diagonal.perp_dot(point(fraction) - low);
                let (first_side, last_side) = (side(first), side(last));
                if first_side * last_side < 0.0 {
                    let fraction = first + (last - first) * first_side / (first_side - last_side);
                    test_point(fraction, point(fraction));
                }
            }
        }
        (minimum.0, a + minimum.1 * along)
    }

    /// Bounds of the ground's height in a disc, in metres: the minimum and the maximum height of the disc's centre and
    /// of the corners of all cells that the disc touches. No height in the disc is outside the bounds.
    pub fn height_bounds_in(&self, centre: DVec2, radius: f64) -> (f64, f64) {
        let middle = self.height(centre.x, centre.y);
        let (mut lowest, mut highest) = (middle, middle);
        let [columns, rows] = self.cells(&Bounds::of_disc(centre, radius));
        for row in rows {
            for column in columns.clone() {
                let low = self.corner(column, row).truncate();
                let high = self.corner(column + 1, row + 1).truncate();
                if centre.clamp(low, high).distance_squared(centre) <= radius * radius {
                    let corners = self.cell(column, row);
                    lowest = corners.into_iter().fold(lowest, f64::min);
                    highest = corners.into_iter().fold(highest, f64::max);
                }
            }
        }
        (lowest, highest)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::rough;
    use super::*;
    use crate::RobotId;
    use crate::noise::{Purpose, Stream};

    /// Reference by brute force, from many points of the segment and all triangles. Returns the minimum height of the
    /// points above the ground, and their minimum distance from the ground.
    fn brute_force(field: &HeightField, [a, b]: [DVec3; 2]) -> (f64, f64) {
        let points: Vec<DVec3> = (0..=4000).map(|step| a + f64::from(step) / 4000.0 * (b - a)).collect();
        let gap = |point: &DVec3| point.z - field.height(point.x, point.y);
        let mut gap = points.iter().map(gap).fold(f64::INFINITY, f64::min);
        // No sample lies exactly on a step, where the height of the upper edge is the relevant one.
        for (axis, lines) in [(0, &field.xs), (1, &field.ys)] {
            for line in lines.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]) {
                let fraction = (line - a[axis]) / (b[axis] - a[axis]);
                let mut point = a + fraction * (b - a);
                point[axis] = line;
                if (0.0..=1.0).contains(&fraction) {
                    gap = gap.min(point.z - field.height(point.x, point.y));
                }
            }
        }
        let mesh = field.mesh(None);
        let distances = points.iter().step_by(40).map(|point| {
            let distance = |triangle| point.distance(nearest_on_triangle(*point, mesh.corners(triangle)));
            mesh.triangles.iter().map(distance).fold(f64::INFINITY, f64::min)
        });
        (gap, distances.fold(f64::INFINITY, f64::min))
    }

    /// Nearest point of a triangle: the projection onto its plane if that lies inside the triangle, otherwise the
    /// nearest point of its sides.
    fn nearest_on_triangle(point: DVec3, corners: [DVec3; 3]) -> DVec3 {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let projection = point - normal * ((point - a).dot(normal) / normal.length_squared());
        let is_inside =
            [(a, b), (b, c), (c, a)].iter().all(|(p, q)| (*q - *p).cross(projection - *p).dot(normal) >= 0.0);
        if is_inside {
            return projection;
        }
        let on_side = |(p, q): (DVec3, DVec3)| {
            let along = q - p;
            p + along * ((point - p).dot(along) / along.length_squared().max(1e-300)).clamp(0.0, 1.0)
        };
        let sides = [on_side((a, b)), on_side((b, c)), on_side((c, a))];
        sides
            .into_iter()
            .min_by(|p, q| p.distance(point).total_cmp(&q.distance(point)))
            .expect("a triangle has three sides")
    }

    #[test]
    fn clearance_matches_brute_force() {
        let (mut below, mut above) = (0, 0);
        for seed in 0..3 {
            let field = rough(seed);
            let Bounds { min, max } = field.bounds();
            let mut stream = Stream::new(seed, RobotId(0), Purpose::Terrain, 97, 0);
            for _ in 0..60 {
                let mut point = |low: f64, high: f64| {
                    let centre = DVec2::new(stream.unit(), stream.unit()) * (max - min - 1.4) + min + 0.7;
                    centre.extend(low + (high - low) * stream.unit())
                };
                let start = point(0.2, 1.6);
                let direction = point(-0.5, 0.5) - point(-0.5, 0.5);
                let ends = [start, start + direction * (0.6 / direction.length())];
                let (gap, distance) = brute_force(&field, ends);
                let clearance = field.clearance(ends, 5.0);
                if gap <= 0.0 {
                    below += 1;
                    // Samples are 0.15 mm apart, and the ground rises by up to a few tens of metres per metre; steps
                    // are sampled exactly.
                    assert!(clearance <= gap + 1e-12 && clearance > gap - 0.02, "{clearance} against {gap}");
                } else if clearance > 0.0 {
                    above += 1;
                    // Samples are 15 mm apart: the nearest one is up to 7.5 mm from the segment's nearest point.
                    assert!(
                        clearance <= distance + 1e-9 && clearance > distance - 7.6e-3,
                        "{clearance} against {distance}"
                    );
                    assert_eq!(field.clearance(ends, 0.5 * clearance), 0.5 * clearance, "limited to `max_distance`");
                }
            }
        }
        assert!(below > 20 && above > 20, "{below} below, {above} above");
    }

    #[test]
    fn clearance_over_a_slope_is_the_perpendicular_distance() {
        let slope = HeightField::new(vec![0.0, 3.0], vec![0.0, 4.0], vec![0.0, 3.0, 0.0, 3.0]).expect("a field");
        let ends = |height: f64| [DVec3::new(1.0, 1.0, 1.0 + height), DVec3::new(2.0, 3.0, 2.0 + height)];
        assert!((slope.clearance(ends(0.2), 1.0) - 0.2 * std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-12);
        assert!((slope.clearance(ends(-0.2), 1.0) + 0.2).abs() < 1e-12);
        assert_eq!(slope.clearance(ends(2.0), 0.1), 0.1);
        assert!(slope.clearance([DVec3::NAN, DVec3::ZERO], 0.1).is_nan());
        // Outside the border, the clearance is the height above the border.
        assert!((slope.clearance([DVec3::new(5.0, 1.0, 3.25), DVec3::new(6.0, 1.0, 4.0)], 1.0) - 0.25).abs() < 1e-12);
    }

    #[test]
    fn height_bounds_in_a_disc_are_never_too_narrow() {
        let field = rough(5);
        let Bounds { min, max } = field.bounds();
        for step in 0..50 {
            let fraction = f64::from(step) / 50.0;
            let centre = min + fraction * (max - min);
            let (lowest, highest) = field.height_bounds_in(centre, 0.3);
            for turn in 0..200 {
                let (sin, cos) = crate::math::sin_cos(f64::from(turn));
                let point = centre + 0.3 * f64::from(turn) / 200.0 * DVec2::new(cos, sin);
                let height = field.height(point.x, point.y);
                assert!(lowest <= height && height <= highest);
            }
        }
        let corner = field.corner(0, 0).z;
        assert_eq!(field.height_bounds_in(DVec2::splat(-50.0), 0.1), (corner, corner));
    }
}
