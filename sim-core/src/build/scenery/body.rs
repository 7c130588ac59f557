//! Default appearance of robots without a mesh.
//!
//! The hull has the robot's colour. It consists of the robi's colliders. Without colliders it is a cylinder of the
//! robot's diameter; for cars and Mecanum drives, it is a box whose diagonal is that diameter. The heading is visible
//! from every side: a bright wedge points forwards, lamps are white in front, red behind, green at the right and red at
//! the left (as on ships), and a sloping display is towards the rear. The camera and dark wheels, which match the
//! drive, show the heading too. Source: our choice.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::mesh_builder::{MeshBuilder, Paint, RoundSize, circle, direction};
use crate::build;
use crate::drive::DriveKind;
use crate::math;
use crate::pose::Pose3;
use crate::scene::{Mesh, Texture};
use crate::spec::{Axis, CameraSpec, Collider, JointSpec, RobiSpec};

/// Colours of robots (red, green, blue), assigned by id and repeated cyclically: blue, green, violet, yellow, cyan,
/// pink. None is red or orange, the colours of the objects `Can` and `Soccer`. Source: our choice.
pub const ROBOT_COLOURS: [[u8; 3]; 6] =
    [[30, 100, 200], [40, 150, 70], [130, 80, 180], [225, 205, 60], [60, 185, 205], [215, 110, 175]];

const TYRE: [u8; 3] = [40, 40, 44];
const HUB: [u8; 3] = [170, 172, 176];
const CHASSIS: [u8; 3] = [70, 72, 78];
const NOSE: [u8; 3] = [245, 243, 235];
const CONSOLE: [u8; 3] = [60, 62, 70];
const SCREEN: [u8; 3] = [150, 185, 120];
const HOUSING: [u8; 3] = [30, 30, 34];
const GLASS: [u8; 3] = [120, 160, 200];
const WHITE_LAMP: [u8; 3] = [255, 255, 255];
const RED_LAMP: [u8; 3] = [230, 30, 30];
const GREEN_LAMP: [u8; 3] = [30, 220, 60];

/// Ratio of a wheel's width to its diameter.
const WHEEL_WIDTH: f64 = 0.25;
/// Number of corners of a wheel and of smaller round parts.
const WHEEL_SIDES: u32 = 20;
const SMALL_SIDES: u32 = 10;
/// Number of corners of a round hull.
const HULL_SIDES: u32 = 36;
/// Ratios of the height of a round hull, and of a box hull, to the robot's diameter.
const ROUND_HEIGHT: f64 = 0.4;
const BOX_HEIGHT: f64 = 0.26;
/// Minimum ratio of the hull's height to the robot's diameter, for a hull under a low camera.
const MIN_HEIGHT_RATIO: f64 = 0.15;
/// Scale of the drawn hull relative to its outline; lamps on the outline then protrude.
const INSET: f64 = 0.98;

/// Centres of the wheels in the robot's frame, in metres, left before right. The driven wheels of a car come first, and
/// so do the front wheels of a Mecanum drive.
pub fn wheel_centres(robi: &RobiSpec) -> Vec<DVec2> {
    let (half_track, half_base) = (0.5 * robi.wheel.track, 0.5 * robi.drive.wheelbase);
    let pair = |x: f64| [DVec2::new(x, half_track), DVec2::new(x, -half_track)];
    let axis = robi.axis_offset;
    match robi.drive.kind {
        DriveKind::Differential => pair(axis).to_vec(),
        DriveKind::Ackermann => [pair(axis), pair(axis + robi.drive.wheelbase)].concat(),
        DriveKind::Omni => [pair(axis + half_base), pair(axis - half_base)].concat(),
        DriveKind::Legged | DriveKind::Thrusters => Vec::new(),
    }
}

/// Mesh of a robot type's body in a colour.
pub fn mesh(robi: &RobiSpec, colour: [u8; 3]) -> Arc<Mesh> {
    let hull = Hull::new(robi);
    let mut builder = MeshBuilder::default();
    let paint = builder.paint(colour);
    if robi.colliders.is_empty() {
        hull.draw(&mut builder, paint);
    }
    robi.colliders.iter().for_each(|collider| builder.collider(collider, paint));
    draw_wheels(&mut builder, robi, &hull);
    hull.draw_lamps(&mut builder);
    hull.draw_deck(&mut builder);
    if let Some(camera) = &robi.camera {
        draw_camera(&mut builder, camera, &hull, robi.diameter);
    }
    builder.finish()
}

/// The main part of a body, which carries all other parts.
struct Hull {
    /// Convex, counter-clockwise from above.
    outline: Vec<DVec2>,
    bottom: f64,
    top: f64,
    /// Centre of the outline.
    centre: DVec2,
    /// Half length and half width, m.
    half_size: DVec2,
    /// Half height of the lamps.
    lamp_half_height: f64,
}

impl Hull {
    fn new(robi: &RobiSpec) -> Self {
        let volume = |collider: &Collider| {
            let (half_size, height, _) = extent(collider);
            half_size.x * half_size.y * height
        };
        let largest = robi.colliders.iter().max_by(|a, b| volume(a).total_cmp(&volume(b)));
        largest.map_or_else(|| Self::of_drive(robi), Self::of_collider)
    }

    fn of_drive(robi: &RobiSpec) -> Self {
        let (diameter, wheel) = (robi.diameter, robi.wheel.diameter);
        let radius = 0.5 * diameter;
        // The hull of a legged robot begins at the underside of its body.
        let underside = build::legs(robi).map_or(0.0, |legs| legs.underside);
        // Wheels are visible below the hull, and for a car also beside it.
        let (outline, bottom, half_size, height) = match robi.drive.kind {
            DriveKind::Differential => (circle(radius, HULL_SIDES), 0.7 * wheel, DVec2::splat(radius), ROUND_HEIGHT),
            DriveKind::Legged | DriveKind::Thrusters => {
                (circle(radius, HULL_SIDES), underside, DVec2::splat(radius), ROUND_HEIGHT)
            }
            DriveKind::Ackermann | DriveKind::Omni => {
                let between = robi.wheel.track - (WHEEL_WIDTH + 0.1) * wheel;
                let width = between.clamp(0.35 * diameter, 0.75 * diameter);
                let length = (diameter * diameter - width * width).sqrt();
                let half_size = 0.5 * DVec2::new(length, width);
                (rectangle(DVec2::ZERO, half_size), 0.4 * wheel, half_size, BOX_HEIGHT)
            }
        };
        let bottom = if robi.drive.kind == DriveKind::Legged { bottom } else { bottom.min(0.5 * diameter) };
        let default_top = bottom + height * diameter;
        let below_camera = robi.camera.as_ref().map_or(default_top, |camera| camera.position.z - 0.06 * diameter);
        let top = default_top.min(below_camera).max(bottom + MIN_HEIGHT_RATIO * diameter);
        Self { outline, bottom, top, centre: DVec2::ZERO, half_size, lamp_half_height: 0.15 * (top - bottom) }
    }

    fn of_collider(collider: &Collider) -> Self {
        let (half_size, height, centre) = extent(collider);
        let (bottom, top) = (centre.z - 0.5 * height, centre.z + 0.5 * height);
        let middle = centre.truncate();
        let is_flat = matches!(collider, Collider::Box { .. } | Collider::Cylinder { .. });
        let outline = match collider {
            Collider::Box { .. } => rectangle(middle, half_size),
            _ if half_size.x == half_size.y => {
                circle(half_size.x, HULL_SIDES).into_iter().map(|corner| middle + corner).collect()
            }
            _ => {
                // A lying capsule.
                let round = half_size.min_element();
                let shift = half_size - DVec2::splat(round);
                let corners = circle(round, HULL_SIDES).into_iter();
                corners.map(|corner| middle + corner + shift * corner.signum()).collect()
            }
        };
        // A rounded hull is narrower than its outline above and below its middle height, so its lamps are lower.
        let lamp_half_height = if is_flat { 0.15 } else { 0.06 } * height;
        Self { outline, bottom, top, centre: middle, half_size, lamp_half_height }
    }

    fn draw(&self, builder: &mut MeshBuilder, paint: Paint) {
        let outline: Vec<DVec2> =
            self.outline.iter().map(|corner| self.centre + INSET * (*corner - self.centre)).collect();
        builder.column(&outline, self.bottom, |_| self.top, paint, paint);
        let chassis = builder.paint(CHASSIS);
        let lower: Vec<DVec3> = outline.iter().rev().map(|corner| corner.extend(self.bottom)).collect();
        builder.polygon(&lower, chassis);
    }

    /// Height halfway between bottom and top.
    fn middle_height(&self) -> f64 {
        0.5 * (self.bottom + self.top)
    }

    /// Point of the outline in the direction `angle` from the centre.
    fn rim(&self, angle: f64) -> DVec2 {
        let direction = direction(angle);
        let next = self.outline.iter().cycle().skip(1);
        let distance = self.outline.iter().zip(next).filter_map(|(a, b)| {
            let (a, along) = (*a - self.centre, *b - *a);
            let determinant = direction.perp_dot(along);
            let (distance, fraction) = (a.perp_dot(along) / determinant, a.perp_dot(direction) / determinant);
            (determinant > 0.0 && (-1e-9..=1.0 + 1e-9).contains(&fraction)).then_some(distance)
        });
        self.centre + direction * distance.fold(0.0, f64::max)
    }

    fn draw_lamps(&self, builder: &mut MeshBuilder) {
        let [front, right, back, left] = [0.0, -0.25 * TAU, 0.5 * TAU, 0.25 * TAU];
        // Angle of the corner of a long hull, seen from its centre. Lamps in front and behind shift towards this
        // corner.
        let corner = math::atan2(self.half_size.y, self.half_size.x);
        for side in [-1.0, 1.0] {
            self.draw_lamp(builder, front + side * 0.62 * corner, 0.25 * corner, WHITE_LAMP);
            self.draw_lamp(builder, back + side * 0.62 * corner, 0.25 * corner, RED_LAMP);
        }
        let complement = 0.25 * TAU - corner;
        self.draw_lamp(builder, right, 0.3 * complement, GREEN_LAMP);
        self.draw_lamp(builder, left, 0.3 * complement, RED_LAMP);
    }

    /// A lamp on the rim, over the directions `middle - half_angle` to `middle + half_angle`.
    fn draw_lamp(&self, builder: &mut MeshBuilder, middle: f64, half_angle: f64, colour: [u8; 3]) {
        const STEPS: i32 = 1;
        let paint = builder.paint(colour);
        let height = self.middle_height() + 0.5 * (self.top - self.middle_height()).min(4.0 * self.lamp_half_height);
        let (low, high) = (height - self.lamp_half_height, height + self.lamp_half_height);
        let outside = |step: i32| self.rim(middle + half_angle * f64::from(step) / f64::from(STEPS));
        let inside = |step: i32| self.centre + 0.9 * (outside(step) - self.centre);
        for step in -STEPS..STEPS {
            let (a, b, c, d) = (outside(step), outside(step + 1), inside(step + 1), inside(step));
            builder.panel([a.extend(low), b.extend(low), b.extend(high), a.extend(high)], paint);
            builder.polygon(&[a, b, c, d].map(|corner| corner.extend(high)), paint);
        }
        for (step, is_end) in [(-STEPS, false), (STEPS, true)] {
            let (a, b) = if is_end { (outside(step), inside(step)) } else { (inside(step), outside(step)) };
            builder.polygon(&[a.extend(low), b.extend(low), b.extend(high), a.extend(high)], paint);
        }
    }

    /// Draws the wedge that points forwards, and the display.
    fn draw_deck(&self, builder: &mut MeshBuilder) {
        let size = self.half_size.min_element();
        let point = |x: f64, y: f64| self.centre + self.half_size * DVec2::new(x, y);
        let nose = builder.paint(NOSE);
        let wedge = [point(0.93, 0.0), point(0.12, 0.55), point(0.12, -0.55)];
        let slope = |at: DVec2| {
            let fraction = (at.x - wedge[0].x) / (wedge[1].x - wedge[0].x);
            self.top + size * (0.02 + 0.14 * fraction)
        };
        builder.column(&wedge, self.middle_height(), slope, nose, nose);
        let console = builder.paint(CONSOLE);
        let corners = [point(-0.62, -0.45), point(0.0, -0.45), point(0.0, 0.45), point(-0.62, 0.45)];
        let slope = |at: DVec2| {
            let fraction = (at.x - corners[0].x) / (corners[1].x - corners[0].x);
            self.top + size * (0.08 + 0.32 * fraction)
        };
        builder.column(&corners, self.middle_height(), slope, console, console);
        let screen = builder.paint(SCREEN);
        let inner = [point(-0.54, -0.36), point(-0.08, -0.36), point(-0.08, 0.36), point(-0.54, 0.36)];
        let corners = inner.map(|corner| corner.extend(slope(corner) + 0.01 * size));
        builder.panel(corners, screen);
    }
}

/// Half sizes in the floor plane, height and centre of a collider.
fn extent(collider: &Collider) -> (DVec2, f64, DVec3) {
    match *collider {
        Collider::Box { centre, size } => (0.5 * size.truncate(), size.z, centre),
        Collider::Sphere { centre, radius } => (DVec2::splat(radius), 2.0 * radius, centre),
        Collider::Cylinder { centre, radius, height } => (DVec2::splat(radius), height, centre),
        Collider::Capsule { centre, radius, height, axis } => {
            let half = (0.5 * height).max(radius);
            match axis {
                Axis::X => (DVec2::new(half, radius), 2.0 * radius, centre),
                Axis::Y => (DVec2::new(radius, half), 2.0 * radius, centre),
                Axis::Z => (DVec2::splat(radius), 2.0 * half, centre),
            }
        }
    }
}

fn rectangle(centre: DVec2, half: DVec2) -> Vec<DVec2> {
    [(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, y)| centre + half * DVec2::new(x, y)).to_vec()
}

/// Draws wheels with their axles, and the castors of a differential drive; nothing for a legged robot.
fn draw_wheels(builder: &mut MeshBuilder, robi: &RobiSpec, hull: &Hull) {
    let wheels = wheel_centres(robi);
    let (Some(first), Some(last)) = (wheels.first(), wheels.last()) else { return };
    let radius = 0.5 * robi.wheel.diameter;
    let width = (WHEEL_WIDTH * robi.wheel.diameter).min(0.6 * robi.wheel.track);
    let (hub, chassis) = (builder.paint(HUB), builder.paint(CHASSIS));
    let tyre = builder.paint(TYRE);
    for point in &wheels {
        let tread = match robi.drive.kind {
            DriveKind::Omni => builder.image(rollers(point.x > robi.axis_offset, point.y > 0.0)),
            _ => tyre,
        };
        // The axle is the wheel's z axis, pointing left.
        let at =
            |y: f64| Pose3 { position: DVec3::new(point.x, y, radius), ..Pose3::about_axis(DVec3::X, -0.25 * TAU) };
        builder.cylinder(
            &at(point.y - 0.5 * width),
            RoundSize { radius, height: width, sides: WHEEL_SIDES },
            8,
            [tread, tyre],
        );
        let hubs = RoundSize { radius: 0.55 * radius, height: 1.06 * width, sides: SMALL_SIDES };
        builder.cylinder(&at(point.y - 0.5 * hubs.height), hubs, 1, [hub, hub]);
    }
    for pair in wheels.chunks_exact(2) {
        let (left, right) = (pair[0], pair[1]);
        let at = Pose3 { position: left.midpoint(right).extend(radius), ..Pose3::IDENTITY };
        builder.cuboid(&at, DVec3::new(0.3 * radius, left.distance(right), 0.3 * radius), chassis);
    }
    // Support of a hull above the axles.
    let axles = first.midpoint(*last);
    let (low, high) = (0.85 * radius, hull.middle_height());
    if hull.bottom > low {
        let size = DVec3::new(0.6 * hull.half_size.x, 0.5 * robi.wheel.track.min(2.0 * hull.half_size.y), high - low);
        let at = Pose3 { position: axles.extend(0.5 * (low + high)), ..Pose3::IDENTITY };
        builder.cuboid(&at, size, chassis);
    }
    if robi.drive.kind == DriveKind::Differential {
        // A castor is at each end that is far from the axle; a robot with its axle in the middle has castors at both
        // ends.
        let has_rear_castor = axles.x > hull.centre.x - 0.2 * hull.half_size.x;
        let has_front_castor = axles.x < hull.centre.x + 0.2 * hull.half_size.x;
        let castor = (0.4 * hull.bottom).clamp(0.2 * radius, radius).min(0.2 * hull.half_size.min_element());
        for (side, _) in
            [(-1.0, has_rear_castor), (1.0, has_front_castor)].into_iter().filter(|(_, is_there)| *is_there)
        {
            let point = hull.centre + DVec2::new(side * 0.72 * hull.half_size.x, 0.0);
            let size = RoundSize { radius: castor, height: 0.6 * castor, sides: SMALL_SIDES };
            let position = DVec3::new(point.x, point.y - 0.5 * size.height, castor);
            let at = Pose3 { position, ..Pose3::about_axis(DVec3::X, -0.25 * TAU) };
            builder.cylinder(&at, size, 1, [tyre; 2]);
            // Fork of the castor, up into the hull.
            let high = hull.middle_height().max(castor);
            let fork = Pose3 { position: point.extend(0.5 * (castor + high)), ..Pose3::IDENTITY };
            builder.cuboid(&fork, DVec3::new(0.5 * castor, 0.9 * castor, high - castor), chassis);
        }
    }
}

/// Texture of the oblique rollers of a Mecanum wheel; front left and back right, the rollers point forwards and
/// inwards.
fn rollers(is_front: bool, is_left: bool) -> Arc<Texture> {
    const SIZE: u32 = 16;
    let shade = |column: u32, row: u32| {
        let along = if is_front == is_left { column + row } else { column + SIZE - row };
        let grey = if along % SIZE < SIZE / 2 { 150 } else { 50 };
        [grey, grey, grey, 255]
    };
    let pixels = (0..SIZE * SIZE).map(|pixel| shade(pixel % SIZE, pixel / SIZE)).collect();
    Arc::new(Texture::new(SIZE, SIZE, pixels).expect("the number of pixels matches the size"))
}

/// Draws the camera at its mount, with its servos in mid-range. A camera inside the hull is drawn on the hull's
/// outline.
fn draw_camera(builder: &mut MeshBuilder, camera: &CameraSpec, hull: &Hull, diameter: f64) {
    let middle = |joint: &JointSpec| match joint {
        JointSpec::Fixed(angle) => *angle,
        JointSpec::Servo { from, to, .. } => 0.5 * (from + to),
    };
    let (pan, tilt) = (middle(&camera.pan), middle(&camera.tilt).clamp(-0.5 * PI, 0.5 * PI));
    let size = (0.1 * diameter).clamp(0.008, 0.04);
    let mut position = camera.position;
    let from_centre = position.truncate() - hull.centre;
    let rim = hull.rim(pan);
    if position.z < hull.top && position.z > hull.bottom && from_centre.length() < rim.distance(hull.centre) {
        position = (rim - 0.2 * size * direction(pan)).extend(position.z);
    }
    let at = Pose3::from_angles(position, 0.0, tilt, pan);
    let housing = builder.paint(HOUSING);
    let has_rear_castor = Pose3 { position: at.transform_point(DVec3::new(-0.35 * size, 0.0, 0.0)), ..at };
    builder.cuboid(&has_rear_castor, DVec3::new(0.7 * size, size, 0.9 * size), housing);
    // The optical axis is the camera's x axis.
    let lens = at.then(&Pose3::about_axis(DVec3::Y, 0.25 * TAU));
    let (rim, glass) = (builder.paint(HUB), builder.paint(GLASS));
    let barrel = RoundSize { radius: 0.36 * size, height: 0.25 * size, sides: SMALL_SIDES };
    builder.cylinder(&lens, barrel, 1, [rim, housing]);
    let front = lens.then(&Pose3 { position: 0.2 * size * DVec3::Z, ..Pose3::IDENTITY });
    let pane = RoundSize { radius: 0.22 * size, height: 0.07 * size, sides: SMALL_SIDES };
    builder.cylinder(&front, pane, 1, [glass, glass]);
    // Mast between the hull and the camera.
    let (low, high) = (hull.middle_height().min(position.z), hull.middle_height().max(position.z));
    let mast = Pose3 { position: has_rear_castor.position.truncate().extend(0.5 * (low + high)), ..Pose3::IDENTITY };
    builder.cuboid(&mast, DVec3::new(0.3 * size, 0.5 * size, high - low), housing);
}
