//! Invariants of every spec: finite numbers within their documented ranges.

use std::f64::consts::TAU;
use std::fmt::{self, Debug, Write};

use glam::{DVec2, DVec3};
use sim_core::RobotId;
use sim_core::build;
use sim_core::noise::{RangeErrors, RangeKind};
use sim_core::pose::Pose;
use sim_core::radio::RadioModel;
use sim_core::scene::Mesh;
use sim_core::spec::{
    Collider, CostTable, CostsRef, DriveKind, JointSpec, Layout, Lens, LightSpec, MAX_LENGTH, MAX_SAMPLES, ModelSpec,
    NoiseRef, NoiseSpec, ObjectLine, ObjectType, RobiSpec, Scatter, SceneSpec, SimSpec, Span, StartRef, WorldSpec,
};
use sim_core::time::Time;

use crate::text::Lines;

/// Smallest size that a file may give, in metres.
const MIN_SIZE: f64 = 1e-6;

/// Largest angle that a file may give, in radians: a million degrees.
const MAX_ANGLE: f64 = 1e6 * TAU / 360.0;

/// Factor that tolerates the rounding of a conversion to SI units.
const ROUNDING: f64 = 1.0 + 1e-12;

/// Panics unless the spec of a world or maze is valid and its spans lie in `lines`.
pub fn world(world: &WorldSpec, lines: &Lines<'_>) {
    finite(world);
    length(world.floor.x, "width of the floor");
    length(world.floor.y, "height of the floor");
    if let Some(cell) = world.cell {
        size(cell, "cell");
    }
    light(&world.looks.light);
    for wall in &world.walls {
        place(wall.from, &wall);
        place(wall.to, &wall);
        assert!(wall.from != wall.to, "a wall without length: {wall:?}");
        length(wall.thickness, &wall);
        size(wall.height, &wall);
        inside(wall.span, lines, &wall);
    }
    for start in &world.starts {
        pose(&start.pose, &start);
        inside(start.span, lines, &start);
        let is_uppercase = start.letter.is_none_or(|letter| letter.is_ascii_uppercase());
        assert!(is_uppercase, "a start letter in upper case: {start:?}");
    }
    objects(&world.objects, lines);
    if let Some(texture) = &world.texture {
        assert!(!texture.text.trim().is_empty(), "{texture:?}");
        inside(texture.span, lines, &texture);
    }
    let (low, high) = world.bounds();
    assert!(low.cmple(high).all() && low.is_finite() && high.is_finite(), "bounds {low} {high}");
}

/// Panics unless the lines of a sim are valid and their spans lie in `lines`.
pub fn sim(sim: &SimSpec, lines: &Lines<'_>) {
    finite(sim);
    for path in sim.world.iter().map(|line| &line.path).chain(&sim.robot_types).chain(&sim.object_types) {
        assert!(!path.text.trim().is_empty(), "{path:?}");
        inside(path.span, lines, path);
    }
    for robot in sim.robots.iter().chain(&sim.named) {
        inside(robot.span, lines, &robot);
        inside(robot.kind.written().span, lines, &robot);
        assert!(!robot.kind.written().text.trim().is_empty(), "{robot:?}");
        assert!(robot.program.as_ref().is_none_or(|program| !program.text.trim().is_empty()), "{robot:?}");
        robot.noise.iter().for_each(|noise| noise_ref(noise, lines));
        match robot.start {
            StartRef::Next => {}
            StartRef::Pose(start) => pose(&start, &robot),
            StartRef::Letter { letter, heading } => {
                assert!(letter.is_ascii_uppercase(), "{robot:?}");
                angle(heading.unwrap_or(0.0), &robot);
            }
            StartRef::Many { count, layout } => many(count, &layout),
        }
    }
    objects(&sim.objects, lines);
    for marker in &sim.markers {
        place(marker.position, &marker);
        inside(marker.span, lines, &marker);
    }
    let inline = &sim.inline;
    if let Some(described) = &inline.world {
        world(described, lines);
    }
    for (described, span) in &inline.robot_types {
        robi(described);
        inside(*span, lines, span);
    }
    for (described, span) in &inline.object_types {
        object_type(described);
        inside(*span, lines, span);
    }
    radio(&sim.radio);
    let run = &sim.run;
    assert!(
        run.slot.is_none_or(|slot| slot > Time::ZERO) && run.until.is_none_or(|until| until > Time::ZERO),
        "{run:?}"
    );
    run.noise.iter().for_each(|noise| noise_ref(noise, lines));
    match &run.costs {
        Some(CostsRef::File(path)) => inside(path.span, lines, path),
        Some(CostsRef::Table(table)) => costs(table, lines),
        None => {}
    }
}

/// Panics unless a cost table is valid and its spans lie in `lines`.
pub fn costs(table: &CostTable, lines: &Lines<'_>) {
    for entry in &table.entries {
        assert!((1..=3_600_000_000).contains(&entry.cost.0), "{entry:?}");
        assert!(!entry.generation.is_empty(), "{entry:?}");
        inside(entry.span, lines, entry);
    }
}

/// Panics unless a noise profile is valid, its models accept its values, and its spans lie in `lines`.
pub fn noise(noise: &NoiseSpec, lines: &Lines<'_>) {
    for entry in &noise.entries {
        assert!(entry.value.is_finite() && !entry.key.is_empty(), "{entry:?}");
        inside(entry.span, lines, entry);
    }
    let profile = noise.profile();
    for name in profile.sensors.keys().map(String::as_str).chain([""]) {
        let range = profile.range(RangeKind::Psd, name);
        let (errors, limits) = (RangeErrors::new(range, 1, RobotId(1), name), [0.1, 4.0]);
        let read = errors.reading(1, Time::from_millis(1), limits, Some(2.0));
        assert!(read.is_none_or(|read| (0.1..=4.0).contains(&read)), "{range:?} reads {read:?}");
    }
    let radio = profile.radio;
    let probabilities = [radio.bit_error_rate, radio.packet_loss];
    assert!(probabilities.iter().all(|probability| (0.0..=1.0).contains(probability)), "{radio:?}");
    let imperfection = profile.motion.imperfection(DriveKind::Omni, 1, RobotId(1));
    assert_eq!(imperfection.check(), Ok(()), "{:?}", profile.motion);
}

fn noise_ref(noise: &NoiseRef, lines: &Lines<'_>) {
    match noise {
        NoiseRef::Preset(_) => {}
        NoiseRef::File(path) => inside(path.span, lines, path),
        NoiseRef::Profile(spec) => self::noise(spec, lines),
    }
}

/// Panics unless the spec of a robot type is valid.
pub fn robi(robi: &RobiSpec) {
    finite(robi);
    assert!(!robi.name.trim().is_empty() || robi.file.is_empty(), "a robot type has a name: {robi:?}");
    size(robi.diameter, "diameter");
    size(robi.max_speed, "speed");
    assert!(robi.max_turn > 0.0 && robi.mass > 0.0 && robi.traction >= 0.0, "{robi:?}");
    assert!(robi.axis_offset.abs() <= MAX_LENGTH, "{robi:?}");
    point(robi.centre_of_mass, "centre of mass");
    let wheel = &robi.wheel;
    size(wheel.diameter, "wheel");
    size(wheel.track, "track");
    assert!(wheel.max_rate > 0.0 && wheel.ticks_per_turn > 0.0, "{wheel:?}");
    let drive = &robi.drive;
    let (motors, has_steering) = match drive.kind {
        DriveKind::Differential => (2, false),
        DriveKind::Ackermann => (1, true),
        DriveKind::Omni | DriveKind::Thrusters => (4, false),
        DriveKind::Legged => (0, false),
    };
    assert_eq!((drive.motors.len(), drive.steering.is_some()), (motors, has_steering), "{drive:?}");
    assert!((MIN_SIZE / 2.0..=MAX_LENGTH).contains(&drive.wheelbase), "{drive:?}");
    assert!(drive.max_steer > 0.0 && drive.max_steer < TAU / 4.0, "{drive:?}");
    assert!((0.0..=3600.0).contains(&drive.wheel_lag), "{drive:?}");
    assert!(robi.legs.is_none() || drive.kind == DriveKind::Legged, "{robi:?}");
    for leg in robi.legs.iter().flat_map(|legs| &legs.legs) {
        point(leg.hip, &leg);
        size(leg.thigh, &leg);
        size(leg.shank, &leg);
        let (min, max) = build::leg(leg).standing_heights();
        assert!((min..=max).contains(&leg.hip.z), "{leg:?}");
    }
    for gait in robi.legs.iter().flat_map(|legs| &legs.gaits) {
        assert!(gait.period > 0.0 && gait.duty > 0.0 && gait.duty < 1.0, "{gait:?}");
        let legs = robi.legs.as_ref().map_or(0, |legs| legs.legs.len());
        assert!(gait.offsets.is_empty() || gait.offsets.len() == legs, "{gait:?}");
    }
    for psd in &robi.psds {
        point(psd.position, &psd);
        angle(psd.angle, &psd);
        size(psd.range, &psd);
        assert!(!psd.name.is_empty(), "{psd:?}");
    }
    if let Some(camera) = &robi.camera {
        point(camera.position, camera);
        joint(&camera.pan);
        joint(&camera.tilt);
        assert!(
            camera.image.is_none_or(|image| image.iter().all(|pixels| (1..=65_536).contains(pixels))),
            "{camera:?}"
        );
        let widest = match camera.lens {
            Lens::Pinhole { .. } => TAU / 2.0,
            Lens::Fisheye { .. } => TAU * ROUNDING,
        };
        assert!(camera.lens.fov() > 0.0 && camera.lens.fov() <= widest, "{camera:?}");
        assert!((1..=MAX_SAMPLES).contains(&camera.samples), "{camera:?}");
    }
    if let Some(lidar) = &robi.lidar {
        assert!(lidar.points > 0, "{lidar:?}");
        angle(lidar.tilt, lidar);
    }
    robi.model.iter().for_each(model);
    robi.colliders.iter().for_each(collider);
    for infrared in &robi.infrareds {
        point(infrared.position, &infrared);
        angle(infrared.angle, &infrared);
        size(infrared.range, &infrared);
    }
    for bumper in &robi.bumpers {
        assert!(bumper.from < bumper.to && bumper.to <= bumper.from + TAU * ROUNDING, "{bumper:?}");
        angle(bumper.from, &bumper);
    }
    for servo in &robi.servos {
        assert!(servo.from.abs().max(servo.to.abs()) <= TAU * ROUNDING, "{servo:?}");
    }
    let inputs = &robi.inputs;
    assert!(inputs.analog.iter().all(|(channel, value)| *channel <= 15 && *value <= 1023), "{inputs:?}");
    assert!(inputs.digital.iter().all(|(line, value)| (1..=16).contains(line) && *value <= 1), "{inputs:?}");
    assert!(inputs.voltage >= 0.0 && inputs.digital.is_sorted(), "{inputs:?}");
    assert!(robi.serials.is_sorted_by_key(|serial| serial.interface), "{:?}", robi.serials);
    assert!(inputs.analog.is_sorted() && inputs.latches.is_sorted() && robi.hdt.is_sorted(), "{inputs:?}");
}

/// Panics unless the spec of an object type is valid.
pub fn object_type(object: &ObjectType) {
    finite(object);
    assert!(
        object.scale > 0.0 && object.mass > 0.0 && object.friction >= 0.0 && object.displaced_volume >= 0.0,
        "{object:?}"
    );
    assert!((0.0..=1.0).contains(&object.restitution), "{object:?}");
    assert!(object.rolling.is_none_or(|rolling| rolling >= 0.0), "{object:?}");
    assert!(!object.colliders.is_empty() && !object.name.is_empty(), "{object:?}");
    point(object.centre_of_mass, "centre of mass");
    object.model.iter().for_each(model);
    object.colliders.iter().for_each(collider);
}

/// Panics unless the indices of a mesh's faces are in range, its numbers finite and its normals unit vectors.
pub fn mesh(mesh: &Mesh) {
    assert!(mesh.positions.iter().all(|position| position.is_finite()), "positions of {mesh:?}");
    for triangle in &mesh.triangles {
        assert!(mesh.corners(triangle).iter().all(|corner| corner.is_finite()), "{triangle:?}");
        let _ = mesh.material(triangle);
        let is_unit = |normal: &glam::Vec3| (normal.length() - 1.0).abs() < 1e-3;
        assert!(triangle.normals.is_none_or(|normals| normals.iter().all(is_unit)), "{triangle:?}");
        assert!(triangle.uv.is_none_or(|uv| uv.iter().all(|point| point.is_finite())), "{triangle:?}");
    }
}

/// Panics unless a scene is valid.
pub fn scene(scene: &SceneSpec) {
    finite(scene);
    radio(&scene.radio);
    let mut last = 0;
    for robot in &scene.robots {
        assert!(robot.id.0 > last, "ids go up: {robot:?}");
        last = robot.id.0;
        pose(&robot.start, &robot);
    }
    for object in &scene.objects {
        pose(&object.pose, &object.span);
        assert!(object.friction >= 0.0, "{object:?}");
    }
}

fn radio(model: &RadioModel) {
    assert!((1..=1_000_000_000).contains(&model.baud), "{model:?}");
    assert!((0..=3_600_000_000).contains(&model.latency.0), "{model:?}");
    model.range.iter().for_each(|range| size(*range, model));
}

fn many(count: u32, layout: &Layout) {
    assert!(count > 0, "{layout:?}");
    match layout {
        Layout::Starts => {}
        Layout::Line { from, to, heading } => {
            place(*from, layout);
            place(*to, layout);
            angle(*heading, layout);
        }
        Layout::Grid { from, spacing, columns, heading } => {
            place(*from, layout);
            place(*spacing, layout);
            angle(*heading, layout);
            assert!(columns.is_none_or(|columns| columns > 0), "{layout:?}");
        }
        Layout::Circle { centre, radius, first, facing } => {
            place(*centre, layout);
            size(*radius, layout);
            angle(*first, layout);
            angle(*facing, layout);
        }
        Layout::Random(Scatter { area, clearance, heading }) => {
            for corner in area.iter().flatten() {
                place(*corner, layout);
            }
            length(*clearance, layout);
            angle(heading.unwrap_or(0.0), layout);
        }
    }
}

fn objects(objects: &[ObjectLine], lines: &Lines<'_>) {
    for object in objects {
        pose(&object.pose, &object);
        assert!(object.friction.is_none_or(|friction| friction >= 0.0), "{object:?}");
        assert!(!object.kind.written().text.is_empty(), "{object:?}");
        inside(object.span, lines, &object);
    }
}

fn light(light: &LightSpec) {
    assert!(light.azimuth.abs() <= TAU * ROUNDING, "{light:?}");
    assert!(light.elevation > 0.0 && light.elevation <= TAU / 4.0 * ROUNDING, "{light:?}");
    assert!((0.0..=1.0).contains(&light.ambient), "{light:?}");
}

fn model(model: &ModelSpec) {
    assert!(!model.path.text.trim().is_empty(), "{model:?}");
    point(model.offset, model);
    model.rotations.to_array().iter().for_each(|turn| angle(*turn, model));
}

fn collider(collider: &Collider) {
    match collider {
        Collider::Box { centre, size } => {
            point(*centre, collider);
            assert!(size.min_element() > 0.0, "{collider:?}");
        }
        Collider::Sphere { centre, radius } => {
            point(*centre, collider);
            assert!(*radius > 0.0, "{collider:?}");
        }
        Collider::Capsule { centre, radius, height, .. } => {
            point(*centre, collider);
            assert!(*radius > 0.0 && *height * ROUNDING >= 2.0 * radius, "{collider:?}");
        }
        Collider::Cylinder { centre, radius, height } => {
            point(*centre, collider);
            assert!(*radius > 0.0 && *height > 0.0, "{collider:?}");
        }
    }
}

fn joint(joint: &JointSpec) {
    match joint {
        JointSpec::Fixed(fixed) => angle(*fixed, joint),
        JointSpec::Servo { name, from, to } => {
            // A camera's servo turns it to either side of a fixed angle.
            assert!(!name.is_empty() && from.abs().max(to.abs()) <= 2.0 * MAX_ANGLE * ROUNDING, "{joint:?}");
        }
    }
}

fn place(point: DVec2, what: &impl Debug) {
    assert!(point.is_finite() && point.abs().max_element() <= MAX_LENGTH * ROUNDING, "{what:?}");
}

fn point(point: DVec3, what: &(impl Debug + ?Sized)) {
    assert!(point.is_finite() && point.abs().max_element() <= MAX_LENGTH * ROUNDING, "{what:?}");
}

fn pose(pose: &Pose, what: &impl Debug) {
    // A start in an open frame may lie beyond the frame's own bound.
    assert!(pose.position.is_finite() && pose.position.abs().max_element() <= 3.0 * MAX_LENGTH, "{what:?}");
    assert!((-TAU / 2.0..TAU / 2.0).contains(&pose.heading.remainder()), "{what:?}");
}

fn length(value: f64, what: &(impl Debug + ?Sized)) {
    assert!((0.0..=MAX_LENGTH * ROUNDING).contains(&value), "{value}: {what:?}");
}

fn size(value: f64, what: &(impl Debug + ?Sized)) {
    assert!((MIN_SIZE / ROUNDING..=MAX_LENGTH * ROUNDING).contains(&value), "{value}: {what:?}");
}

fn angle(value: f64, what: &impl Debug) {
    assert!(value.abs() <= MAX_ANGLE * ROUNDING, "{value}: {what:?}");
}

fn inside(span: Span, lines: &Lines<'_>, what: &impl Debug) {
    lines.check(span, what);
}

/// Panics if any number in `spec` is infinite or NaN; searches the `Debug` output outside of string literals.
pub fn finite(spec: &impl Debug) {
    let mut search = Search { word: [0; 3], is_text: false, is_escaped: false, is_found: false };
    write!(search, "{spec:?}").expect("the search takes everything");
    assert!(!search.is_found, "a number is not finite: {spec:#?}");
}

/// Searches a `Debug` output for the words `inf` and `NaN` outside of string literals.
struct Search {
    /// The last three bytes outside of a string literal.
    word: [u8; 3],
    is_text: bool,
    is_escaped: bool,
    is_found: bool,
}

impl Write for Search {
    fn write_str(&mut self, piece: &str) -> fmt::Result {
        for &byte in piece.as_bytes() {
            match byte {
                _ if self.is_escaped => self.is_escaped = false,
                b'\\' if self.is_text => self.is_escaped = true,
                b'"' => self.is_text = !self.is_text,
                _ if self.is_text => {}
                // `infrareds` is the only name with these letters: a number is followed by punctuation, not by a
                // letter.
                b'a'..=b'z' if self.word == *b"inf" => self.word = [0, 0, byte],
                _ => {
                    self.is_found |= self.word == *b"inf" || self.word == *b"NaN";
                    self.word = [self.word[1], self.word[2], byte];
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn infinite_numbers_are_found_outside_of_texts_only() {
        #[derive(Debug)]
        #[allow(dead_code, reason = "read by its debug form")]
        struct Spec {
            infrareds: f64,
            name: &'static str,
            letter: char,
        }
        let found = |infrareds| {
            let mut search = Search { word: [0; 3], is_text: false, is_escaped: false, is_found: false };
            write!(search, "{:?}", Spec { infrareds, name: "inf, \" NaN,\\", letter: 'i' }).expect("no error");
            search.is_found
        };
        assert_eq!([0.0, 1e300, f64::INFINITY, -f64::INFINITY, f64::NAN].map(found), [false, false, true, true, true]);
    }
}
