//! Brute-force solutions: no index, no closed form for contacts, formulas other than the core's.

use glam::{DVec2, DVec3};
use sim_core::math;
use sim_core::pose::{Pose, Twist};
use sim_core::scene::Segment;

/// Nearest of `segments` along a ray: distance in metres from `origin` along the unit vector `direction`, and index in
/// the list. `None` if there is no hit within `range` metres.
///
/// Each wall is extended by `extension` metres at both ends (shortened if negative). If an index lets no ray pass
/// through a corner and its errors come only from rounding, its result is between the results for a small positive and
/// a small negative `extension`. A wall that is parallel to the ray or has zero length is hit at its nearer end if both
/// ends are within `extension` of the ray's line.
///
/// The ray and the wall's line are two linear equations, solved by Cramer's rule.
pub fn nearest_wall(
    segments: &[Segment],
    origin: DVec2,
    direction: DVec2,
    range: f64,
    extension: f64,
) -> Option<(f64, usize)> {
    let distances = segments.iter().map(|segment| distance_along_ray(segment, origin, direction, extension));
    nearest(distances, range)
}

/// Smallest of these distances up to `range`, and its index; the first of equal distances.
fn nearest(distances: impl Iterator<Item = Option<f64>>, range: f64) -> Option<(f64, usize)> {
    distances
        .enumerate()
        .filter_map(|(index, distance)| distance.filter(|&metres| metres <= range).map(|metres| (metres, index)))
        .min_by(|one, other| one.0.total_cmp(&other.0))
}

fn distance_along_ray(segment: &Segment, origin: DVec2, direction: DVec2, extension: f64) -> Option<f64> {
    let (to_wall, along) = (segment.a - origin, segment.b - segment.a);
    let length = along.length();
    // origin + t direction = a + u along, u in units of the wall's length.
    let determinant = direction.perp_dot(along);
    if determinant.abs() <= 1e-14 * length {
        return distance_to_parallel(to_wall, to_wall + along, direction, extension);
    }
    let t = to_wall.perp_dot(along) / determinant;
    let u = to_wall.perp_dot(direction) / determinant;
    let slack = extension / length;
    (t >= -extension.max(0.0) && (-slack..=1.0 + slack).contains(&u)).then_some(t.max(0.0))
}

fn distance_to_parallel(a: DVec2, b: DVec2, direction: DVec2, extension: f64) -> Option<f64> {
    if direction.perp_dot(a).abs().max(direction.perp_dot(b).abs()) > extension {
        return None;
    }
    let (near, far) = (direction.dot(a).min(direction.dot(b)), direction.dot(a).max(direction.dot(b)));
    (far >= -extension).then_some(near.max(0.0))
}

/// Nearest of `triangles` along a ray: distance in metres from `origin` along the unit vector `direction`, and index in
/// the list. `None` if there is no hit within `range` metres.
///
/// All edges of each triangle are moved outwards by `margin` metres (inwards if negative). If an index lets no ray pass
/// through a shared edge, its result is between the results for a small positive and a small negative `margin`.
/// Triangles of zero area, and triangles whose plane is parallel to the ray, are not hit.
///
/// The ray and two edges are three linear equations, solved by Cramer's rule.
pub fn nearest_triangle(
    triangles: &[[DVec3; 3]],
    origin: DVec3,
    direction: DVec3,
    range: f64,
    margin: f64,
) -> Option<(f64, usize)> {
    let distances = triangles.iter().map(|corners| distance_to_triangle(corners, origin, direction, margin));
    nearest(distances, range)
}

/// Distance to one triangle as in [`nearest_triangle`], without a range.
pub(crate) fn distance_to_triangle(
    &[a, b, c]: &[DVec3; 3],
    origin: DVec3,
    direction: DVec3,
    margin: f64,
) -> Option<f64> {
    let (ab, ac, to_a) = (b - a, c - a, a - origin);
    let normal = ab.cross(ac);
    let area = normal.length();
    let determinant = -direction.dot(normal);
    if area.is_nan() || determinant.abs() <= 1e-14 * area {
        return None;
    }
    // origin + t direction = a + u ab + v ac.
    let t = -to_a.dot(normal) / determinant;
    let u = direction.dot(to_a.cross(ac)) / determinant;
    let v = direction.dot(ab.cross(to_a)) / determinant;
    // A barycentric coordinate of 1 corresponds to the triangle's height over the edge.
    let inside = [(u, ac), (v, ab), (1.0 - u - v, c - b)]
        .iter()
        .all(|(coordinate, edge)| coordinate * area >= -margin * edge.length());
    (t >= -margin.max(0.0) && inside).then_some(t.max(0.0))
}

/// Distance in metres between a disc of `radius` around `centre` and the nearest of `segments`; negative if they
/// overlap, infinite without segments.
pub fn clearance(segments: &[Segment], centre: DVec2, radius: f64) -> f64 {
    segments.iter().map(|segment| distance_to_point(segment, centre)).fold(f64::INFINITY, f64::min) - radius
}

/// Distance from the wall's line if the foot of the perpendicular is on the wall, otherwise from the nearer end.
fn distance_to_point(segment: &Segment, point: DVec2) -> f64 {
    let (from_a, from_b, along) = (point - segment.a, point - segment.b, segment.b - segment.a);
    if from_a.dot(along) > 0.0 && from_b.dot(along) < 0.0 {
        from_a.perp_dot(along).abs() / along.length()
    } else {
        from_a.length().min(from_b.length())
    }
}

/// Number of samples in the horizon while the disc is close to a wall.
const SAMPLES: f64 = 1e5;

/// First instant, in seconds from 0 to `horizon`, at which a disc touches one of `segments`. It is 0 if the disc
/// overlaps a segment at the start, even if the disc moves away. `None` if it touches no segment or an argument is not
/// finite.
///
/// The disc of `radius` metres has its centre at the origin of a frame that starts at `start` and moves with the
/// constant `twist`, given in that frame (see [`Twist::at_offset`] for another centre).
///
/// The clearance is sampled, and its first change of sign is found by bisection. The time to the next sample is that in
/// which the disc travels the clearance, at least 10^-5 of the horizon. A contact is missed only if the overlap is
/// shorter than this minimum interval, and not deeper than the disc travels in it. The error of a contact is about
/// 10^-15 m divided by the speed of approach, below 10^-9 s unless the disc grazes the wall.
pub fn first_contact(segments: &[Segment], start: Pose, twist: Twist, radius: f64, horizon: f64) -> Option<f64> {
    if !(twist.is_finite() && start.position.is_finite() && radius.is_finite() && horizon.is_finite()) {
        return None;
    }
    let clearance_at = |t: f64| clearance(segments, centre_at(&start, twist, t), radius);
    let mut free_until = 0.0;
    let mut gap = clearance_at(free_until);
    if gap <= 0.0 {
        return Some(0.0);
    }
    let speed = twist.speed();
    while free_until < horizon {
        let next = (free_until + (0.999 * gap / speed).max(horizon / SAMPLES)).min(horizon);
        gap = clearance_at(next);
        if gap <= 0.0 {
            return Some(bisected(free_until, next, |t| clearance_at(t) <= 0.0));
        }
        free_until = next;
    }
    None
}

/// Position of the frame's origin after `t` seconds, by rotation about the instantaneous centre of rotation.
///
/// For small angles the rotation loses digits, so the velocity is integrated numerically.
fn centre_at(start: &Pose, twist: Twist, t: f64) -> DVec2 {
    let angle = twist.omega * t;
    let forward = start.heading.direction();
    let velocity = DVec2::new(twist.vx, twist.vy);
    if angle.abs() > 1e-2 {
        let start_from_pivot = DVec2::new(twist.vy, -twist.vx) / twist.omega;
        let (sin, cos) = math::sin_cos(angle);
        return start.position + forward.rotate(DVec2::new(cos, sin).rotate(start_from_pivot) - start_from_pivot);
    }
    // Six-point Gauss-Legendre quadrature of the velocity: its error is below angle^12 / 10^16.
    let nodes = [
        (0.238_619_186_083_196_9, 0.467_913_934_572_691),
        (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
        (0.932_469_514_203_152, 0.171_324_492_379_170_35),
    ];
    let mean = nodes.iter().flat_map(|&(node, weight)| [(node, weight), (-node, weight)]).fold(
        DVec2::ZERO,
        |sum, (node, weight)| {
            let (sin, cos) = math::sin_cos(0.5 * angle * (1.0 + node));
            sum + 0.5 * weight * DVec2::new(cos, sin).rotate(velocity)
        },
    );
    start.position + forward.rotate(mean * t)
}

/// Bisects the interval from `low`, where `condition` is false, to `high`, where it is true, down to adjacent `f64`
/// numbers and returns the upper one.
fn bisected(mut low: f64, mut high: f64, condition: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = low + 0.5 * (high - low);
        if middle <= low || middle >= high {
            return high;
        }
        if condition(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
}

/// Solid body in the world frame; lengths in metres.
#[derive(Clone, Copy, Debug)]
pub enum Body {
    /// An upright box.
    Box {
        /// Centre.
        centre: DVec3,
        /// Half sizes along its axes.
        half: DVec3,
        /// Counter-clockwise angle from the world's x axis to the box's, rad.
        turn: f64,
    },
    /// An upright cylinder.
    Cylinder {
        /// Centre.
        centre: DVec3,
        /// Radius.
        radius: f64,
        /// Half height.
        half: f64,
    },
    /// All points within `radius` of a line segment.
    Capsule {
        /// Ends of the segment.
        ends: [DVec3; 2],
        /// Distance of the surface from the segment.
        radius: f64,
    },
}

impl Body {
    /// Distance in metres from `point` to the body; 0 inside.
    pub fn distance(&self, point: DVec3) -> f64 {
        match *self {
            Self::Box { centre, half, turn } => {
                let (sin, cos) = math::sin_cos(turn);
                let offset = point - centre;
                let local = DVec3::new(cos * offset.x + sin * offset.y, cos * offset.y - sin * offset.x, offset.z);
                (local.abs() - half).max(DVec3::ZERO).length()
            }
            Self::Cylinder { centre, radius, half } => {
                let offset = point - centre;
                let horizontal = (math::hypot(offset.x, offset.y) - radius).max(0.0);
                math::hypot(horizontal, (offset.z.abs() - half).max(0.0))
            }
            Self::Capsule { ends: [a, b], radius } => {
                let length = (b - a).length();
                let fraction =
                    if length > 0.0 { ((point - a).dot(b - a) / (length * length)).clamp(0.0, 1.0) } else { 0.0 };
                ((point - a.lerp(b, fraction)).length() - radius).max(0.0)
            }
        }
    }
}

/// Nearest of `bodies` along a ray, as in [`nearest_wall`]: distance in metres from `origin`, and index in the list.
///
/// Sphere tracing: each step along the ray is as long as the distance to the nearest body, so no step enters a body.
/// The search ends at a distance of at most `tolerance` metres from a body; a ray that passes a body within this
/// distance hits it.
pub fn nearest_body(
    bodies: &[Body],
    origin: DVec3,
    direction: DVec3,
    range: f64,
    tolerance: f64,
) -> Option<(f64, usize)> {
    let mut travelled = 0.0;
    while travelled <= range {
        let point = origin + direction * travelled;
        let distances = bodies.iter().map(|body| body.distance(point)).zip(0..);
        let (distance, index) = distances.min_by(|one, other| one.0.total_cmp(&other.0))?;
        if distance <= tolerance {
            return Some((travelled, index));
        }
        travelled += distance;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    const WALL: Segment = Segment::new(DVec2::new(2.0, -1.0), DVec2::new(2.0, 1.0));

    #[test]
    fn nearest_wall_matches_geometry() {
        let direction = DVec2::new(0.8, 0.6);
        assert_eq!(nearest_wall(&[WALL], DVec2::new(0.0, -1.0), direction, 9.0, 0.0), Some((2.5, 0)));
        assert_eq!(nearest_wall(&[WALL], DVec2::new(0.0, -1.0), direction, 2.4, 0.0), None);
        assert_eq!(nearest_wall(&[WALL], DVec2::new(0.0, 1.0), direction, 9.0, 0.0), None);
        assert_eq!(nearest_wall(&[WALL], DVec2::new(0.0, 1.0), DVec2::X, 9.0, 1e-9), Some((2.0, 0)));
        assert_eq!(nearest_wall(&[WALL], DVec2::new(0.0, 1.0), DVec2::X, 9.0, -1e-9), None);
        assert_eq!(nearest_wall(&[WALL], DVec2::new(2.0, -4.0), DVec2::Y, 9.0, 1e-9), Some((3.0, 0)));
    }

    #[test]
    fn nearest_triangle_matches_geometry() {
        let slope = [DVec3::new(2.0, 0.0, 0.0), DVec3::new(4.0, 0.0, 2.0), DVec3::new(2.0, 3.0, 0.0)];
        let found =
            |y: f64, range, margin| nearest_triangle(&[slope], DVec3::new(0.0, y, 0.5), DVec3::X, range, margin);
        let is_near = |found: Option<(f64, usize)>| found.is_some_and(|(metres, _)| (metres - 2.5).abs() < 1e-15);
        assert!(is_near(found(1.0, 9.0, 0.0)), "x - 2 = z: {:?}", found(1.0, 9.0, 0.0));
        assert_eq!(found(1.0, 2.4, 0.0), None);
        assert!(is_near(found(0.0, 9.0, 1e-9)));
        assert_eq!(found(0.0, 9.0, -1e-9), None);
        assert!(is_near(found(-1.9e-3, 9.0, 2e-3)), "the edge is moved by 2 mm");
        assert_eq!(found(-2.1e-3, 9.0, 2e-3), None);
    }

    #[test]
    fn straight_disc_touches_at_a_radius_from_the_wall() {
        let contact = first_contact(&[WALL], Pose::default(), Twist::new(0.5, 0.0), 0.1, 10.0);
        assert!((contact.unwrap() - 3.8).abs() < 1e-12, "within 1 ps: {contact:?}");
        assert_eq!(first_contact(&[WALL], Pose::default(), Twist::new(0.5, 0.0), 0.1, 3.7), None);
        assert_eq!(first_contact(&[WALL], Pose::default(), Twist::new(-0.5, 0.0), 0.1, 10.0), None);
        assert_eq!(first_contact(&[WALL], Pose::new(1.95, 0.0, 0.0), Twist::ZERO, 0.1, 10.0), Some(0.0));
    }

    #[test]
    fn disc_on_an_arc_touches_where_its_circle_does() {
        // The centre circles (0, 2) at 1.95 m with 1 rad/s and reaches x = 1.9, a radius from the wall, after asin(1.9
        // / 1.95) s.
        let wall = Segment::new(DVec2::new(2.0, -9.0), DVec2::new(2.0, 9.0));
        let start = Pose::new(0.0, 2.0 - 1.95, 0.0);
        let contact = first_contact(&[wall], start, Twist::new(1.95, 1.0), 0.1, 10.0).unwrap();
        assert!((math::sin(contact) * 1.95 - 1.9).abs() < 1e-12, "within 1 pm: {contact}");
        // No tunnelling at 20 km/s.
        let contact = first_contact(&[wall], start, Twist::new(1.95, 1.0).scaled(1e4), 0.1, 1e-2).unwrap();
        assert!((math::sin(contact * 1e4) * 1.95 - 1.9).abs() < 1e-11, "within 10 pm: {contact}");
    }

    #[test]
    fn rotation_and_quadrature_agree_at_their_limit() {
        let start = Pose::new(1.0, 2.0, 0.7);
        for omega in [0.00999, 0.01001] {
            let twist = Twist { vx: 0.3, vy: -0.2, omega };
            let expected = start.moved(twist).position;
            assert!((centre_at(&start, twist, 1.0) - expected).length() < 1e-14, "omega {omega}");
        }
        let quarter = centre_at(&Pose::default(), Twist::new(FRAC_PI_2, FRAC_PI_2), 1.0);
        assert!((quarter - DVec2::ONE).length() < 1e-15);
    }
}
