//! Passive objects from above: outline of the mesh, and colliders.

use glam::{DVec2, DVec3};
use plotters::style::RGBColor;
use sim_core::math;
use sim_core::pose::Pose;
use sim_core::scene::Mesh;
use sim_core::spec::{Axis, Collider, ObjectType};

use super::colour::{INK, OBJECT, SHADE};
use super::drawing::{Drawing, Form, Line, Paint, Shape, Symbol};

/// Number of segments of a half circle's outline.
const ARC: u32 = 12;

/// Outline of a collider.
pub const COLLIDER: Line = Line::solid(INK, 1.0);
/// Outline of a mesh.
pub const MESH: Line = Line::solid(SHADE, 1.0);

/// Draws an object of this type at `pose`, with its mesh if there is one.
pub fn draw_object(drawing: &mut Drawing, kind: &ObjectType, mesh: Option<&Mesh>, pose: &Pose) {
    let colour = kind.colour.map_or(OBJECT, |[red, green, blue]| RGBColor(red, green, blue));
    let fill = Paint::translucent(colour, 0.8);
    if let Some(mesh) = mesh {
        draw_mesh(drawing, mesh, pose, Paint::translucent(SHADE, 0.3));
    }
    for collider in &kind.colliders {
        for point in footprint(collider) {
            drawing.include(pose.transform_point(point));
        }
        drawing.push(collider_shape(collider, pose, fill, COLLIDER));
    }
    drawing.include(pose.position);
    let symbol = match kind.colliders.first() {
        Some(Collider::Box { .. }) => Symbol::Square(Some(fill), COLLIDER),
        _ => Symbol::Disc(Some(fill), COLLIDER),
    };
    drawing.add_legend(symbol, kind.name.clone());
}

/// Draws the outline of a mesh from above.
pub fn draw_mesh(drawing: &mut Drawing, mesh: &Mesh, pose: &Pose, fill: Paint) {
    let points = mesh.triangles.iter().flat_map(|triangle| mesh.corners(triangle)).map(DVec3::truncate);
    let hull: Vec<DVec2> = convex_hull(points.collect()).into_iter().map(|point| pose.transform_point(point)).collect();
    hull.iter().for_each(|corner| drawing.include(*corner));
    drawing.push(Shape::filled(Form::Polygon(hull), fill).with_line(MESH));
    drawing.add_legend(Symbol::Square(Some(fill), MESH), "outline of a mesh");
}

/// Shape of a collider from above.
pub fn collider_shape(collider: &Collider, pose: &Pose, fill: Paint, line: Line) -> Shape {
    let form = match *collider {
        Collider::Sphere { centre, radius }
        | Collider::Cylinder { centre, radius, .. }
        | Collider::Capsule { centre, radius, axis: Axis::Z, .. } => {
            Form::Disc { centre: pose.transform_point(centre.truncate()), radius, min_radius_px: 2.0 }
        }
        Collider::Box { .. } | Collider::Capsule { .. } => {
            Form::Polygon(footprint(collider).into_iter().map(|point| pose.transform_point(point)).collect())
        }
    };
    Shape::filled(form, fill).with_line(line)
}

/// Corners of a collider's outline from above, in the body's frame; round outlines are inscribed polygons.
pub fn footprint(collider: &Collider) -> Vec<DVec2> {
    let half_circle = |centre: DVec2, radius: f64, from: f64| {
        (0..=ARC).map(move |step| {
            let angle = from + std::f64::consts::PI * f64::from(step) / f64::from(ARC);
            centre + radius * DVec2::new(math::cos(angle), math::sin(angle))
        })
    };
    let right_angle = std::f64::consts::FRAC_PI_2;
    match *collider {
        Collider::Box { centre, size } => {
            let (centre, half) = (centre.truncate(), 0.5 * size.truncate());
            [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| centre + half * DVec2::new(x, y)).to_vec()
        }
        Collider::Capsule { centre, radius, height, axis: axis @ (Axis::X | Axis::Y) } => {
            let (direction, from) = if axis == Axis::X { (DVec2::X, -right_angle) } else { (DVec2::Y, 0.0) };
            let half_axis = (0.5 * height - radius).max(0.0) * direction;
            let (front, back) = (centre.truncate() + half_axis, centre.truncate() - half_axis);
            let ends = half_circle(front, radius, from).chain(half_circle(back, radius, from + 2.0 * right_angle));
            ends.collect()
        }
        Collider::Sphere { centre, radius }
        | Collider::Cylinder { centre, radius, .. }
        | Collider::Capsule { centre, radius, .. } => {
            let centre = centre.truncate();
            half_circle(centre, radius, 0.0).chain(half_circle(centre, radius, 2.0 * right_angle).skip(1)).collect()
        }
    }
}

/// Corners of the convex hull of `points`, counter-clockwise.
pub fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., previous, last] = chain[..]
                && (last - previous).perp_dot(point - previous) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        // The last corner is the first of the other chain.
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn convex_hull_has_only_outer_corners() {
        let points = [(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, 0.5), (2.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.5, 0.7)];
        let hull = convex_hull(points.map(|(x, y)| DVec2::new(x, y)).to_vec());
        assert_eq!(hull, [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y)));
        assert!(convex_hull(Vec::new()).is_empty());
        assert_eq!(convex_hull(vec![DVec2::ONE; 5]).len(), 1);
    }

    #[test]
    fn footprints_have_the_size_of_their_colliders() {
        let centre = DVec3::new(1.0, 2.0, 3.0);
        for (collider, half) in [
            (Collider::Box { centre, size: DVec3::new(0.2, 0.4, 9.0) }, (0.1, 0.2)),
            (Collider::Sphere { centre, radius: 0.3 }, (0.3, 0.3)),
            (Collider::Cylinder { centre, radius: 0.3, height: 9.0 }, (0.3, 0.3)),
            (Collider::Capsule { centre, radius: 0.1, height: 0.8, axis: Axis::X }, (0.4, 0.1)),
            (Collider::Capsule { centre, radius: 0.1, height: 0.8, axis: Axis::Y }, (0.1, 0.4)),
            (Collider::Capsule { centre, radius: 0.1, height: 0.8, axis: Axis::Z }, (0.1, 0.1)),
        ] {
            let points = footprint(&collider);
            let low = points.iter().copied().reduce(DVec2::min).expect("corners");
            let high = points.iter().copied().reduce(DVec2::max).expect("corners");
            let (middle, size) = (0.5 * (low + high), 0.5 * (high - low));
            assert!((middle - centre.truncate()).length() < 1e-12, "{collider:?}");
            assert!((size - DVec2::new(half.0, half.1)).length() < 1e-12, "{collider:?}: {size}");
        }
    }
}
