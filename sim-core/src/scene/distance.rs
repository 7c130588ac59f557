//! Distances between segments and triangles in space.

use glam::DVec3;

/// Minimum distance between the segments `a` and `b`, in metres; either may be a point.
///
/// Source: the clamped solution of the two normal equations, see Ericson, Real-Time Collision Detection, 5.1.9.
pub(crate) fn segment_to_segment(a: [DVec3; 2], b: [DVec3; 2]) -> f64 {
    let (along_a, along_b, between) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (square_a, square_b) = (along_a.length_squared(), along_b.length_squared());
    let (on_a, on_b, mixed) = (along_a.dot(between), along_b.dot(between), along_a.dot(along_b));
    let fraction =
        |projection: f64, square: f64| if square > 0.0 { (projection / square).clamp(0.0, 1.0) } else { 0.0 };
    let determinant = square_a * square_b - mixed * mixed;
    // For segments that are parallel within rounding, the ends determine the distance.
    let mut min_squared = f64::INFINITY;
    let mut try_shares =
        |s: f64, t: f64| min_squared = min_squared.min((between + s * along_a - t * along_b).length_squared());
    if determinant > 1e-14 * square_a * square_b {
        let s = ((mixed * on_b - square_b * on_a) / determinant).clamp(0.0, 1.0);
        let t = fraction(on_b + s * mixed, square_b);
        try_shares(fraction(t * mixed - on_a, square_a), t);
    }
    for s in [0.0, 1.0] {
        try_shares(s, fraction(on_b + s * mixed, square_b));
    }
    for t in [0.0, 1.0] {
        try_shares(fraction(t * mixed - on_a, square_a), t);
    }
    min_squared.sqrt()
}

/// Minimum distance between a segment and a triangle, in metres; 0 if they cross. A triangle without area counts as its
/// sides.
pub(crate) fn segment_to_triangle(piece: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> f64 {
    let sides = [[a, b], [b, c], [c, a]].map(|side| segment_to_segment(piece, side));
    let mut minimum = sides[0].min(sides[1]).min(sides[2]);
    let normal = (b - a).cross(c - a);
    let area = normal.length();
    if area > 0.0 {
        let normal = normal / area;
        let is_over =
            |point: DVec3| [(a, b), (b, c), (c, a)].iter().all(|(p, q)| (*q - *p).cross(point - *p).dot(normal) >= 0.0);
        let [from, to] = piece.map(|end| (end - a).dot(normal));
        if is_over(piece[0]) {
            minimum = minimum.min(from.abs());
        }
        if is_over(piece[1]) {
            minimum = minimum.min(to.abs());
        }
        if from * to < 0.0 && is_over(piece[0] + from / (from - to) * (piece[1] - piece[0])) {
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
    fn distances_are_those_of_many_points() {
        let mut stream = Stream::new(1, RobotId(0), Purpose::Terrain, 96, 0);
        let mut point = || DVec3::from([(); 3].map(|()| stream.unit()));
        for _ in 0..300 {
            let (piece, [a, b, c]) = ([point(), point()], [point(), point(), point()]);
            let on = |[p, q]: [DVec3; 2], count: u32| {
                (0..=count).map(move |step| p + f64::from(step) / f64::from(count) * (q - p)).collect::<Vec<_>>()
            };
            let min_distance = |others: &[DVec3]| {
                let to =
                    |point: &DVec3| others.iter().map(|other| other.distance(*point)).fold(f64::INFINITY, f64::min);
                on(piece, 60).iter().map(to).fold(f64::INFINITY, f64::min)
            };
            let to_side = min_distance(&on([a, b], 60));
            let exact = segment_to_segment(piece, [a, b]);
            // Neighbouring samples are at most 30 mm apart.
            assert!(exact <= to_side + 1e-12 && to_side < exact + 0.03, "{exact} and {to_side}");
            let points: Vec<DVec3> = on([a, b], 40).into_iter().flat_map(|point| on([c, point], 40)).collect();
            let to_face = min_distance(&points);
            let exact = segment_to_triangle(piece, [a, b, c]);
            assert!(exact <= to_face + 1e-12 && to_face < exact + 0.05, "{exact} and {to_face}");
        }
    }

    #[test]
    fn points_and_parallels_have_distances_too() {
        let [origin, x, y, z] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        assert_eq!(segment_to_segment([origin, origin], [x, x]), 1.0);
        assert_eq!(segment_to_segment([origin, x], [y, y + x]), 1.0);
        assert_eq!(segment_to_segment([origin, x], [3.0 * x, 2.0 * x]), 1.0);
        assert_eq!(segment_to_segment([origin, x], [0.5 * x + z, 0.5 * x - z]), 0.0);
        assert_eq!(segment_to_triangle([0.25 * (x + y) + z, 0.25 * (x + y) - z], [origin, x, y]), 0.0);
        assert_eq!(segment_to_triangle([z, 2.0 * z], [origin, origin, x]), 1.0);
    }
}
