use glam::DVec2;

use crate::{math, pose::Pose, scene::Bounds};

/// The outline of a part of an object in plan view, centred on the origin of the part's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A disc.
    Disc {
        /// Radius, m.
        radius: f64,
    },
    /// A rectangle whose sides are parallel to the axes of the frame.
    Rectangle {
        /// Half of the side lengths, m.
        half: DVec2,
    },
    /// All points within `radius` of the segment from -`half_length` to `half_length` on the x axis.
    Capsule {
        /// Half of the length of the segment, m.
        half_length: f64,
        /// Distance from the segment, m.
        radius: f64,
    },
}

impl Shape {
    /// Area, m².
    pub fn area(&self) -> f64 {
        match *self {
            Self::Disc { radius } => std::f64::consts::PI * radius * radius,
            Self::Rectangle { half } => 4.0 * half.x * half.y,
            Self::Capsule { half_length, radius } => {
                std::f64::consts::PI * radius * radius + 4.0 * half_length * radius
            }
        }
    }

    /// Square of the radius of gyration about the centre, m².
    pub fn gyration_squared(&self) -> f64 {
        match *self {
            Self::Disc { radius } => 0.5 * radius * radius,
            Self::Rectangle { half } => half.length_squared() / 3.0,
            Self::Capsule { half_length: h, radius: r } => {
                let (disc, middle) = (std::f64::consts::PI * r * r, 4.0 * h * r);
                // Parallel axis theorem for the two half discs: their centroids are 4 r / (3 pi) beyond the ends of the
                // segment.
                let centroid = 4.0 * r / (3.0 * std::f64::consts::PI);
                let caps_squared = 0.5 * r * r - centroid * centroid + (h + centroid) * (h + centroid);
                (disc * caps_squared + middle * (h * h + r * r) / 3.0) / (disc + middle)
            }
        }
    }

    /// Maximum distance of a point from the centre, m.
    pub fn reach(&self) -> f64 {
        match *self {
            Self::Disc { radius } => radius,
            Self::Rectangle { half } => half.length(),
            Self::Capsule { half_length, radius } => half_length + radius,
        }
    }

    /// The axis-aligned bounding rectangle of the shape, in the world frame.
    pub fn bounds(&self, world_from_part: &Pose) -> Bounds {
        let axis = world_from_part.heading.direction();
        let half = match *self {
            Self::Disc { radius } => DVec2::splat(radius),
            Self::Rectangle { half } => {
                DVec2::new(axis.x.abs() * half.x + axis.y.abs() * half.y, axis.y.abs() * half.x + axis.x.abs() * half.y)
            }
            Self::Capsule { half_length, radius } => axis.abs() * half_length + DVec2::splat(radius),
        };
        Bounds { min: world_from_part.position - half, max: world_from_part.position + half }
    }

    /// Distance along a ray in the part's frame to the shape, m: 0 if the ray starts inside, `None` if it misses the
    /// shape.
    pub fn cast(&self, origin: DVec2, direction: DVec2) -> Option<f64> {
        match *self {
            Self::Disc { radius } => cast_disc(origin, direction, DVec2::ZERO, radius),
            Self::Rectangle { half } => cast_rectangle(origin, direction, half),
            Self::Capsule { half_length, radius } => {
                let middle = cast_rectangle(origin, direction, DVec2::new(half_length, radius));
                let end = |x: f64| cast_disc(origin, direction, DVec2::new(x, 0.0), radius);
                [middle, end(-half_length), end(half_length)].into_iter().flatten().min_by(f64::total_cmp)
            }
        }
    }

    /// The corners of the shape, counter-clockwise in the part's frame. A circle is replaced by a circumscribed regular
    /// polygon of 64 sides; its corners are outside the circle by at most 0.13 % of the radius.
    pub fn outline(&self) -> Vec<DVec2> {
        const SIDES: usize = 64;
        let circle = |radius: f64| {
            (0..SIDES).map(move |side| {
                let (sin, cos) = math::sin_cos((side as f64 + 0.5) * std::f64::consts::TAU / SIDES as f64);
                DVec2::new(cos, sin) * (radius / math::cos(std::f64::consts::PI / SIDES as f64))
            })
        };
        match *self {
            Self::Disc { radius } => circle(radius).collect(),
            Self::Rectangle { half } => {
                [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec2::new(x, y) * half).to_vec()
            }
            Self::Capsule { half_length, radius } => {
                circle(radius).map(|corner| corner + DVec2::new(half_length.copysign(corner.x), 0.0)).collect()
            }
        }
    }

    /// The point of the shape that is nearest to `point`, in the part's frame: `point` itself if it is inside.
    pub fn nearest_point(&self, point: DVec2) -> DVec2 {
        let (core, radius) = match *self {
            Self::Disc { radius } => (DVec2::ZERO, radius),
            Self::Rectangle { half } => return point.clamp(-half, half),
            Self::Capsule { half_length, radius } => {
                (DVec2::new(point.x.clamp(-half_length, half_length), 0.0), radius)
            }
        };
        let offset = point - core;
        if offset.length() <= radius { point } else { core + offset * (radius / offset.length()) }
    }

    /// Distance from `point`, in the part's frame, to the nearest point of the shape, m; 0 inside.
    pub fn distance(&self, point: DVec2) -> f64 {
        match *self {
            Self::Disc { radius } => (point.length() - radius).max(0.0),
            Self::Rectangle { half } => {
                let outside = (point.abs() - half).max(DVec2::ZERO);
                math::hypot(outside.x, outside.y)
            }
            Self::Capsule { half_length, radius } => {
                let offset = DVec2::new((point.x.abs() - half_length).max(0.0), point.y);
                (offset.length() - radius).max(0.0)
            }
        }
    }
}

/// Distance along a ray to a disc: 0 if the ray starts inside, `None` if it misses the disc.
pub(crate) fn cast_disc(origin: DVec2, direction: DVec2, centre: DVec2, radius: f64) -> Option<f64> {
    let offset = centre - origin;
    if offset.length_squared() <= radius * radius {
        return Some(0.0);
    }
    let along = offset.dot(direction);
    // Computed from the point of the line that is nearest to the centre; this preserves precision for a distant disc.
    let distance_squared = (offset - direction * along).length_squared();
    let half_chord_squared = radius * radius - distance_squared;
    (along > 0.0 && half_chord_squared >= 0.0).then(|| (along - half_chord_squared.sqrt()).max(0.0))
}

/// Distance along a ray to a rectangle around the origin: 0 if the ray starts inside, `None` if it misses the
/// rectangle. The border belongs to the rectangle.
fn cast_rectangle(origin: DVec2, direction: DVec2, half: DVec2) -> Option<f64> {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for axis in 0..2 {
        if direction[axis] == 0.0 {
            if origin[axis].abs() > half[axis] {
                return None;
            }
        } else {
            let one = (-half[axis] - origin[axis]) / direction[axis];
            let other = (half[axis] - origin[axis]) / direction[axis];
            enter = enter.max(one.min(other));
            leave = leave.min(one.max(other));
        }
    }
    (enter <= leave).then_some(enter)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: [Shape; 3] = [
        Shape::Disc { radius: 0.3 },
        Shape::Rectangle { half: DVec2::new(0.4, 0.1) },
        Shape::Capsule { half_length: 0.25, radius: 0.1 },
    ];

    #[test]
    fn area_and_gyration_match_sampled_points() {
        for shape in SHAPES {
            let (mut count, mut moment) = (0.0, 0.0);
            let step = 1e-3;
            for i in -500..500 {
                for j in -500..500 {
                    let point = DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5) * step;
                    if shape.distance(point) == 0.0 {
                        count += 1.0;
                        moment += point.length_squared();
                    }
                }
            }
            assert!((shape.area() / (count * step * step) - 1.0).abs() < 2e-3, "{shape:?}");
            assert!((shape.gyration_squared() / (moment / count) - 1.0).abs() < 2e-3, "{shape:?}");
        }
    }

    #[test]
    fn cast_matches_ray_marching() {
        for shape in SHAPES {
            for step in 0..1000 {
                let (sin, cos) = math::sin_cos(f64::from(step) * 0.7);
                let origin = DVec2::new(cos, sin) * (0.05 + 0.001 * f64::from(step));
                let (sin, cos) = math::sin_cos(f64::from(step) * 1.3);
                let direction = DVec2::new(cos, sin);
                // Ray marching: each step is the distance from the shape.
                let mut travelled = 0.0;
                while travelled < 3.0 && shape.distance(origin + direction * travelled) > 1e-9 {
                    travelled += shape.distance(origin + direction * travelled);
                }
                match shape.cast(origin, direction) {
                    Some(distance) => assert!((distance - travelled).abs() < 1e-4, "{shape:?} {step}: {distance}"),
                    None => assert!(
                        travelled >= 3.0,
                        "{shape:?} {step}: the ray misses the shape, which is {travelled} m ahead"
                    ),
                }
            }
        }
    }

    #[test]
    fn outline_encloses_the_shape_closely() {
        for shape in SHAPES {
            let corners = shape.outline();
            let count = corners.len();
            for (index, corner) in corners.iter().enumerate() {
                let next = corners[(index + 1) % count];
                assert!(shape.distance(*corner) < 1.3e-3 * 0.3, "{shape:?} {corner}");
                let middle = 0.5 * (*corner + next);
                assert!(shape.distance(middle * (1.0 - 1e-12)) < 1e-12, "{shape:?}: the sides touch the shape");
                assert!(corner.perp_dot(next) > 0.0, "counter-clockwise");
            }
        }
    }

    #[test]
    fn ray_along_a_border_hits_it() {
        let rectangle = Shape::Rectangle { half: DVec2::new(0.4, 0.1) };
        assert_eq!(rectangle.cast(DVec2::new(-1.0, 0.1), DVec2::X), Some(0.6));
        assert_eq!(rectangle.cast(DVec2::new(-1.0, 0.1000001), DVec2::X), None);
        assert_eq!(rectangle.cast(DVec2::new(0.4, 0.0), DVec2::X), Some(0.0), "from its border");
    }
}
