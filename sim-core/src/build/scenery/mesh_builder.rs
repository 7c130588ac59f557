//! Builder of meshes from simple solids.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2, Vec3};

use crate::math;
use crate::pose::Pose3;
use crate::scene::{Material, Mesh, Texture, Triangle};
use crate::spec::{Axis, Collider};

/// Number of sides of a round solid. The outline of a circle of radius r deviates from the circle by at most 0.43 % of
/// r, equally outwards and inwards (see [`circumradius`]). This is a quarter of a pixel for a circle 116 pixels wide.
/// Source: our choice.
pub const SIDES: u32 = 24;

/// Mesh builder.
#[derive(Debug, Default)]
pub struct MeshBuilder {
    mesh: Mesh,
}

/// Material of faces of a [`MeshBuilder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Paint(u32);

/// Dimensions of a round solid about z, and its number of sides.
#[derive(Clone, Copy, Debug)]
pub struct RoundSize {
    pub radius: f64,
    pub height: f64,
    pub sides: u32,
}

/// A ring of a surface of revolution about z.
#[derive(Clone, Copy, Debug)]
struct Ring {
    radius: f64,
    z: f64,
    /// Normal of the surface: outwards and upwards.
    normal: DVec2,
}

/// Circumradius of the regular polygon that deviates from the circle of radius 1 equally outwards and inwards.
pub fn circumradius(sides: u32) -> f64 {
    2.0 / (1.0 + math::cos(PI / f64::from(sides)))
}

/// Corners, counter-clockwise, of the regular polygon about the origin that approximates a circle.
pub fn circle(radius: f64, sides: u32) -> Vec<DVec2> {
    let radius = radius * circumradius(sides);
    (0..sides).map(|side| radius * direction(TAU * f64::from(side) / f64::from(sides))).collect()
}

/// Unit vector at the angle `angle` from the x axis.
pub fn direction(angle: f64) -> DVec2 {
    let (sin, cos) = math::sin_cos(angle);
    DVec2::new(cos, sin)
}

impl MeshBuilder {
    /// Returns the mesh.
    pub fn finish(self) -> Arc<Mesh> {
        Arc::new(self.mesh)
    }

    /// Material of one colour: red, green, blue.
    pub fn paint(&mut self, colour: [u8; 3]) -> Paint {
        self.material(colour, None)
    }

    /// Material that shows an image.
    pub fn image(&mut self, texture: Arc<Texture>) -> Paint {
        self.material([255; 3], Some(texture))
    }

    fn material(&mut self, colour: [u8; 3], texture: Option<Arc<Texture>>) -> Paint {
        let colour = colour.map(|shade| f32::from(shade) / 255.0);
        let material = Material { colour, texture, ..Material::default() };
        let existing = self.mesh.materials.iter().position(|existing| *existing == material);
        let index = existing.unwrap_or_else(|| {
            self.mesh.materials.push(material);
            self.mesh.materials.len() - 1
        });
        Paint(index as u32)
    }

    /// Adds a vertex; returns its index.
    fn add_vertex(&mut self, point: DVec3) -> u32 {
        self.mesh.positions.push(point);
        self.mesh.positions.len() as u32 - 1
    }

    /// Adds a face with corners counter-clockwise from outside, unless they are collinear.
    fn triangle(&mut self, corners: [u32; 3], normals: Option<[Vec3; 3]>, uv: Option<[Vec2; 3]>, paint: Paint) {
        let [a, b, c] = corners.map(|corner| self.mesh.positions[corner as usize]);
        if (b - a).cross(c - a).try_normalize().is_some() {
            self.mesh.triangles.push(Triangle { corners, normals, uv, material: paint.0 });
        }
    }

    /// Adds a flat convex face with corners counter-clockwise from outside.
    pub fn polygon(&mut self, corners: &[DVec3], paint: Paint) {
        let indices: Vec<u32> = corners.iter().map(|corner| self.add_vertex(*corner)).collect();
        for pair in indices[1..].windows(2) {
            self.triangle([indices[0], pair[0], pair[1]], None, None, paint);
        }
    }

    /// Adds a flat face of four corners, counter-clockwise from outside, starting at the lower left corner of the
    /// paint's image.
    pub fn panel(&mut self, corners: [DVec3; 4], paint: Paint) {
        let [a, b, c, d] = corners.map(|corner| self.add_vertex(corner));
        let uv = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        self.triangle([a, b, c], None, Some([uv[0], uv[1], uv[2]]), paint);
        self.triangle([a, c, d], None, Some([uv[0], uv[2], uv[3]]), paint);
    }

    /// Adds an upright solid over a convex `outline`, counter-clockwise from above; `top` gives the height of its upper
    /// face at each corner. Its sides are painted with `side`, its upper face with `lid`; it has no lower face.
    pub fn column(&mut self, outline: &[DVec2], bottom: f64, top: impl Fn(DVec2) -> f64, side: Paint, lid: Paint) {
        let next = outline.iter().cycle().skip(1);
        for (a, b) in outline.iter().zip(next) {
            let corners = [a.extend(bottom), b.extend(bottom), b.extend(top(*b)), a.extend(top(*a))];
            self.panel(corners, side);
        }
        let lid_corners: Vec<DVec3> = outline.iter().map(|corner| corner.extend(top(*corner))).collect();
        self.polygon(&lid_corners, lid);
    }

    /// Adds a box in `frame`, whose origin is its centre.
    pub fn cuboid(&mut self, frame: &Pose3, size: DVec3, paint: Paint) {
        let half = 0.5 * size;
        let corner = |x: f64, y: f64, z: f64| frame.transform_point(half * DVec3::new(x, y, z));
        // Each face starts at its lower left corner, as seen from outside.
        let sides = [(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];
        for (index, (x, y)) in sides.iter().enumerate() {
            let (u, v) = sides[(index + 1) % 4];
            self.panel([corner(*x, *y, -1.0), corner(u, v, -1.0), corner(u, v, 1.0), corner(*x, *y, 1.0)], paint);
        }
        let horizontal = |z: f64, x: f64| [(-x, -1.0), (x, -1.0), (x, 1.0), (-x, 1.0)].map(|(x, y)| corner(x, y, z));
        self.panel(horizontal(1.0, 1.0), paint);
        self.panel(horizontal(-1.0, -1.0), paint);
    }

    /// Adds a cylinder about z in `frame`, from z = 0 to `height`, with smooth sides and a flat face at either
    /// end. An image of its paint is repeated `turns` times around it.
    pub fn cylinder(&mut self, frame: &Pose3, size: RoundSize, turns: u32, paint: [Paint; 2]) {
        let [side, ends] = paint;
        let RoundSize { radius, height, sides } = size;
        let normal = DVec2::X;
        self.revolve(
            frame,
            &[Ring { radius, z: 0.0, normal }, Ring { radius, z: height, normal }],
            (sides, turns),
            side,
        );
        let corners = circle(radius, sides);
        let upper: Vec<DVec3> = corners.iter().map(|corner| frame.transform_point(corner.extend(height))).collect();
        let lower: Vec<DVec3> = corners.iter().rev().map(|corner| frame.transform_point(corner.extend(0.0))).collect();
        self.polygon(&upper, ends);
        self.polygon(&lower, ends);
    }

    /// Adds a cylinder of this `length` between two half spheres, about z in `frame`, whose origin is its
    /// centre; with length 0, a sphere.
    pub fn capsule(&mut self, frame: &Pose3, radius: f64, length: f64, paint: Paint) {
        let ring = |angle: f64, shift: f64| {
            // Exact at the poles, so that the faces beyond them have no area.
            let normal = if angle.abs() < 0.25 * TAU { direction(angle) } else { DVec2::Y * angle.signum() };
            let point = radius * circumradius(SIDES) * normal;
            // `revolve` applies `circumradius` to the radius itself.
            Ring { radius: radius * normal.x, z: point.y + shift, normal }
        };
        let half = SIDES / 4;
        let angles = |from: f64| (0..=half).map(move |step| from + 0.25 * TAU * f64::from(step) / f64::from(half));
        let lower = angles(-0.25 * TAU).map(|angle| ring(angle, -0.5 * length));
        let upper = angles(0.0).map(|angle| ring(angle, 0.5 * length));
        let skipped = usize::from(length <= 0.0);
        let rings: Vec<Ring> = lower.chain(upper.skip(skipped)).collect();
        self.revolve(frame, &rings, (SIDES, 1), paint);
    }

    /// Adds the surface between rings about z in `frame`, from the lowest to the highest.
    fn revolve(&mut self, frame: &Pose3, rings: &[Ring], (sides, turns): (u32, u32), paint: Paint) {
        let directions: Vec<DVec2> = circle(1.0, sides);
        let first = self.mesh.positions.len() as u32;
        for ring in rings {
            for radial in &directions {
                let point = frame.transform_point((ring.radius * *radial).extend(ring.z));
                self.add_vertex(point);
            }
        }
        let normal = |ring: usize, side: u32| {
            let DVec2 { x: outwards, y: upwards } = rings[ring].normal;
            let radial = outwards * direction(TAU * f64::from(side) / f64::from(sides));
            (frame.rotation * radial.extend(upwards)).normalize_or(DVec3::Z).as_vec3()
        };
        let uv = |ring: usize, side: u32| {
            let fraction = (rings[ring].z - rings[0].z) / (rings[rings.len() - 1].z - rings[0].z);
            Vec2::new((side * turns) as f32 / sides as f32, fraction as f32)
        };
        let corner = |ring: usize, side: u32| first + ring as u32 * sides + side % sides;
        for ring in 1..rings.len() {
            for side in 0..sides {
                let [a, b, c, d] = [(ring - 1, side), (ring - 1, side + 1), (ring, side + 1), (ring, side)];
                for corners in [[a, b, c], [a, c, d]] {
                    let points = corners.map(|(ring, side)| corner(ring, side));
                    let normals = corners.map(|(ring, side)| normal(ring, side));
                    let uv = corners.map(|(ring, side)| uv(ring, side));
                    self.triangle(points, Some(normals), Some(uv), paint);
                }
            }
        }
    }

    /// Adds the solid of a collider.
    pub fn collider(&mut self, collider: &Collider, paint: Paint) {
        let upright = |centre: DVec3| Pose3 { position: centre, ..Pose3::IDENTITY };
        match *collider {
            Collider::Box { centre, size } => self.cuboid(&upright(centre), size, paint),
            Collider::Sphere { centre, radius } => self.capsule(&upright(centre), radius, 0.0, paint),
            Collider::Cylinder { centre, radius, height } => {
                let size = RoundSize { radius, height, sides: SIDES };
                self.cylinder(&upright(centre - 0.5 * height * DVec3::Z), size, 1, [paint; 2]);
            }
            Collider::Capsule { centre, radius, height, axis } => {
                let turned = match axis {
                    Axis::X => Pose3::about_axis(DVec3::Y, 0.25 * TAU),
                    Axis::Y => Pose3::about_axis(DVec3::X, -0.25 * TAU),
                    Axis::Z => Pose3::IDENTITY,
                };
                let frame = Pose3 { position: centre, ..turned };
                self.capsule(&frame, radius, (height - 2.0 * radius).max(0.0), paint);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume inside a closed mesh whose faces are counter-clockwise from outside.
    fn volume(mesh: &Mesh) -> f64 {
        mesh.triangles.iter().map(|face| mesh.corners(face)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    fn mesh_of(collider: Collider) -> Arc<Mesh> {
        let mut builder = MeshBuilder::default();
        let paint = builder.paint([10, 20, 30]);
        builder.collider(&collider, paint);
        builder.finish()
    }

    const CENTRE: DVec3 = DVec3::new(0.3, -0.2, 0.5);

    #[test]
    fn solids_are_closed_and_have_the_right_volume() {
        let cylinder = PI * 0.01 * 0.4;
        let ball = PI * 4.0 / 3.0 * 0.001;
        let size = DVec3::new(0.1, 0.2, 0.3);
        for (collider, expected) in [
            (Collider::Box { centre: CENTRE, size }, 0.006),
            (Collider::Cylinder { centre: CENTRE, radius: 0.1, height: 0.4 }, cylinder),
            (Collider::Sphere { centre: CENTRE, radius: 0.1 }, ball),
            (Collider::Capsule { centre: CENTRE, radius: 0.1, height: 0.6, axis: Axis::X }, ball + cylinder),
            (Collider::Capsule { centre: CENTRE, radius: 0.1, height: 0.6, axis: Axis::Y }, ball + cylinder),
            (Collider::Capsule { centre: CENTRE, radius: 0.1, height: 0.6, axis: Axis::Z }, ball + cylinder),
        ] {
            let found = volume(&mesh_of(collider));
            assert!((found / expected - 1.0).abs() < 0.02, "{collider:?}: {found}, not {expected}");
        }
    }

    #[test]
    fn capsules_lie_along_their_axes() {
        for (axis, normal) in [(Axis::X, DVec3::X), (Axis::Y, DVec3::Y), (Axis::Z, DVec3::Z)] {
            let mesh = mesh_of(Collider::Capsule { centre: CENTRE, radius: 0.1, height: 0.6, axis });
            let (low, high) = mesh.bounds().expect("faces");
            let half = DVec3::splat(0.1) + 0.2 * normal;
            assert!((high - CENTRE - half).abs().max_element() < 1e-3, "{axis:?}: {high}");
            assert!((low - CENTRE + half).abs().max_element() < 1e-3, "{axis:?}: {low}");
        }
    }

    #[test]
    fn outline_of_a_ball_deviates_within_the_documented_bound() {
        let mesh = mesh_of(Collider::Sphere { centre: CENTRE, radius: 1.0 });
        for face in &mesh.triangles {
            let [a, b, c] = mesh.corners(face).map(|corner| corner - CENTRE);
            for corner in [a, b, c] {
                assert!((corner.length() - 1.0).abs() <= 0.0043 + 1e-9, "{}", corner.length());
            }
        }
        assert_eq!(mesh.triangles.len(), 24 * 2 * 11);
    }

    #[test]
    fn normals_are_unit_vectors_that_point_outwards() {
        let mesh = mesh_of(Collider::Capsule { centre: DVec3::ZERO, radius: 0.1, height: 0.6, axis: Axis::Y });
        for face in &mesh.triangles {
            let [a, b, c] = mesh.corners(face);
            let face_normal = (b - a).cross(c - a).normalize_or_zero();
            for normal in face.normals.expect("smooth") {
                assert!((normal.length() - 1.0).abs() < 1e-6);
                assert!(face_normal.dot(normal.as_dvec3()) > 0.9, "{face_normal} {normal}");
            }
        }
    }
}
