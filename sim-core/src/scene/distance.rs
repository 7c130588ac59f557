//! Distances between segments and triangles in three dimensions.

use glam::DVec3;

/// Minimum distance between the segments `a` and `b`, in metres; either may be a point.
///
/// Source: the clamped solution of the two normal equations, see Ericson, Real-Time Collision Detection, 5.1.9.
pub(crate) fn segment_to_segment(a: [DVec3; 2], b: [DVec3; 2]) -> f64 {
    let (along_a, along_b, offset) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (square_a, square_b) = (along_a.length_squared(), along_b.length_squared());
    let (on_a, on_b, mixed) = (along_a.dot(offset), along_b.dot(offset), along_a.dot(along_b));
    let fraction =
        |projection: f64, square: f64| if square > 0.0 { (projection / square).clamp(0.0, 1.0) } else { 0.0 };
    let determinant = square_a * square_b - mixed * mixed;
    // If the segments are parallel within rounding, the minimum distance occurs at an end.
    let mut min_squared = f64::INFINITY;
    let mut test_points =
        |s: f64, t: f64| min_squared = min_squared.min((offset + s * along_a - t * along_b).length_squared());
    if determinant > 1e-14 * square_a * square_b {
        let s = ((mixed * on_b - square_b * on_a) / determinant).clamp(0.0, 1.0);
        let t = fraction(on_b + s * mixed, square_b);
        test_points(fraction(t * mixed - on_a, square_a), t);
    }
    for s in [0.0, 1.0] {
        test_points(s, fraction(on_b + s * mixed, square_b));
    }
    for t in [0.0, 1.0] {
        test_points(fraction(t * mixed - on_a, square_a), t);
    }
    min_squared.sqrt()
}

/// Minimum distance between a segment and a triangle, in metres; 0 if they cross. A triangle without area is treated as
/// its sides.
pub(crate) fn segment_to_triangle(segment: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> f64 {
    let sides = [[a, b], [b, c], [c, a]].map(|side| segment_to_segment(segment, side));
    let mut minimum = sides[0].min(sides[1]).min(sides[2]);
    let normal = (b - a).cross(c - a);
    let area = normal.length();
    if area > 0.0 {
        let normal = normal / area;
        let is_above_face =
            |point: DVec3| [(a, b), (b, c), (c, a)].iter().all(|(p, q)| (*q - *p).cross(point - *p).dot(normal) >= 0.0);
        let [height_0, height_1] = segment.map(|end| (end - a).dot(normal));
        if is_above_face(segment[0]) {
            minimum = minimum.min(height_0.abs());
        }
        if is_above_face(segment[1]) {
            minimum = minimum.min(height_1.abs());
        }
        let crossing = segment[0] + height_0 / (height_0 - height_1) * (segment[1] - segment[0]);
        if height_0 * height_1 < 0.0 && is_above_face(crossing) {
            minimum = 0.0;
        }
    }
    minimum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RobotId;
    use crate::noise::{Purpose, Stream};

    #[test]
    fn distances_match_the_minimum_over_many_points() {
        let mut stream = Stream::new(1, RobotId(0), Purpose::Terrain, 96, 0);
        let mut point = || DVec3::from([(); 3].map(|()| stream.unit()));
        for _ in 0..300 {
            let (segment, [a, b, c]) = ([point(), point()], [point(), point(), point()]);
            let samples = |[p, q]: [DVec3; 2], count: u32| {
                (0..=count).map(move |step| p + f64::from(step) / f64::from(count) * (q - p)).collect::<Vec<_>>()
            };
            let min_distance = |points: &[DVec3]| {
                let to_points =
                    |sample: &DVec3| points.iter().map(|point| point.distance(*sample)).fold(f64::INFINITY, f64::min);
                samples(segment, 60).iter().map(to_points).fold(f64::INFINITY, f64::min)
            };
            let to_side = min_distance(&samples([a, b], 60));
            let exact = segment_to_segment(segment, [a, b]);
            // Neighbouring samples are at most 30 mm apart.
            assert!(exact <= to_side + 1e-12 && to_side < exact + 0.03, "{exact} and {to_side}");
            let points: Vec<DVec3> =
                samples([a, b], 40).into_iter().flat_map(|point| samples([c, point], 40)).collect();
            let to_face = min_distance(&points);
            let exact = segment_to_triangle(segment, [a, b, c]);
            assert!(exact <= to_face + 1e-12 && to_face < exact + 0.05, "{exact} and {to_face}");
        }
    }

    #[test]
    fn points_and_parallel_segments_have_distances() {
        let [origin, x, y, z] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        assert_eq!(segment_to_segment([origin, origin], [x, x]), 1.0);
        assert_eq!(segment_to_segment([origin, x], [y, y + x]), 1.0);
        assert_eq!(segment_to_segment([origin, x], [3.0 * x, 2.0 * x]), 1.0);
        assert_eq!(segment_to_segment([origin, x], [0.5 * x + z, 0.5 * x - z]), 0.0);
        assert_eq!(segment_to_triangle([0.25 * (x + y) + z, 0.25 * (x + y) - z], [origin, x, y]), 0.0);
        assert_eq!(segment_to_triangle([z, 2.0 * z], [origin, origin, x]), 1.0);
    }
}
