//! Robots from above: body, heading, wheels, sensors with their ranges.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use plotters::style::RGBColor;
use sim_core::build;
use sim_core::drive::legged::Stance;
use sim_core::math;
use sim_core::pose::{Pose, Pose3};
use sim_core::scene::{Mesh, Walls};
use sim_core::sensor::{Posture, RangeModel, RangeSensor};
use sim_core::spec::{JointSpec, LidarSpec, RobiSpec};

use super::colour::{BUMPER, CAMERA, INFRARED, INK, LIDAR, PSD, RANGE, WHEEL};
use super::drawing::{Drawing, Form, Label, Line, Paint, Shape, Symbol};
use super::object::{collider_shape, draw_mesh, footprint};

/// Minimum radius of a robot's body, in pixels.
const MIN_RADIUS: f64 = 4.0;

const PSD_LINE: Line = Line::solid(PSD, 1.25);
const RANGE_LINE: Line = Line::solid(RANGE, 1.25);
const SONAR_FILL: Paint = Paint::translucent(RANGE, 0.12);
const INFRARED_LINE: Line = Line::solid(INFRARED, 2.0);
const BUMPER_LINE: Line = Line::solid(BUMPER, 4.0);
const CAMERA_LINE: Line = Line::solid(CAMERA, 1.0);
const CAMERA_FILL: Paint = Paint::translucent(CAMERA, 0.2);
const LIDAR_LINE: Line = Line::solid(LIDAR, 1.25);

/// Appearance of a robot.
#[derive(Clone, Copy, Debug)]
pub struct RobotStyle<'a> {
    /// Colour of its body.
    pub colour: RGBColor,
    /// Its mesh, if it is to be shown.
    pub mesh: Option<&'a Mesh>,
    /// Angles of the joints of its legs, leg by leg, in radians; empty for a standing robot.
    pub joints: &'a [f64],
}

/// Draws the body with its heading and wheels.
pub fn draw_body(drawing: &mut Drawing, robi: &RobiSpec, pose: &Pose, style: &RobotStyle<'_>) {
    let radius = 0.5 * robi.diameter;
    drawing.include_around(pose.position, radius);
    let edge = Line::solid(style.colour, 1.5);
    if let Some(mesh) = style.mesh {
        draw_mesh(drawing, mesh, pose, Paint::translucent(style.colour, 0.1));
    }
    draw_wheels(drawing, robi, pose);
    draw_legs(drawing, robi, pose, style);
    let disc = Form::Disc { centre: pose.position, radius, min_radius_px: MIN_RADIUS };
    drawing.push(Shape::filled(disc, Paint::translucent(style.colour, 0.35)).with_line(edge));
    for collider in &robi.colliders {
        footprint(collider).into_iter().for_each(|point| drawing.include(pose.transform_point(point)));
        let shape =
            collider_shape(collider, pose, Paint::translucent(style.colour, 0.15), Line::solid(style.colour, 1.0));
        drawing.push(shape.detail(robi.diameter));
    }
    draw_heading(drawing, pose, radius);
}

/// Draws the heading of a robot: a line from its centre to its edge.
pub fn draw_heading(drawing: &mut Drawing, pose: &Pose, radius: f64) {
    let needle = Form::Needle { pose: *pose, length: radius, min_length_px: MIN_RADIUS };
    drawing.push(Shape::outlined(needle, Line::solid(INK, 1.25)));
}

fn draw_wheels(drawing: &mut Drawing, robi: &RobiSpec, pose: &Pose) {
    // The width of a wheel is not specified; a fifth of its diameter looks right.
    let half_size = 0.5 * robi.wheel.diameter * DVec2::new(1.0, 0.2);
    for wheel in build::wheel_centres(robi) {
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let corners = corners.map(|(x, y)| pose.transform_point(wheel + half_size * DVec2::new(x, y)));
        corners.iter().for_each(|corner| drawing.include(*corner));
        drawing.push(Shape::filled(Form::Polygon(corners.to_vec()), Paint::solid(WHEEL)).detail(robi.wheel.diameter));
    }
}

/// Draws thighs, shanks and feet as they are seen from above.
fn draw_legs(drawing: &mut Drawing, robi: &RobiSpec, pose: &Pose, style: &RobotStyle<'_>) {
    let Some(legs) = build::legs(robi) else { return };
    let joints = if style.joints.is_empty() { legs.standing_joints() } else { style.joints.to_vec() };
    let stance = Stance { joints, ..Stance::default() };
    let mut draw = |outline: Vec<DVec2>| {
        outline.iter().for_each(|point| drawing.include(*point));
        let leg = Shape::filled(Form::Polygon(outline), Paint::translucent(WHEEL, 0.45));
        drawing.push(leg.with_line(Line::solid(WHEEL, 1.0)).detail(robi.diameter));
    };
    for limb in legs.limbs(&stance, pose) {
        draw(stadium(limb.capsule.ends.map(|end| end.truncate()), limb.capsule.radius));
    }
    let mut frames = legs.parts(&stance).into_iter();
    for leg in &legs.legs {
        let frame = frames.by_ref().take(leg.parts().count()).last();
        let (Some(foot), Some(frame)) = (leg.foot, frame) else { continue };
        let corners = [(foot.toe, 2.0), (-foot.heel, 2.0), (-foot.heel, -2.0), (foot.toe, -2.0)];
        let corner =
            |(forward, left): (f64, f64)| frame.transform_point(DVec3::new(forward, left * legs.radius, -foot.height));
        draw(corners.map(|offsets| pose.transform_point(corner(offsets).truncate())).to_vec());
    }
}

/// Outline of all points within `radius` of the line between two ends.
fn stadium([from, to]: [DVec2; 2], radius: f64) -> Vec<DVec2> {
    const STEPS: u32 = 8;
    let direction = (to - from).normalize_or(DVec2::X);
    let cap = |end: DVec2, outward: DVec2| {
        (0..=STEPS).map(move |step| {
            let angle = PI * (f64::from(step) / f64::from(STEPS) - 0.5);
            end + radius * (math::cos(angle) * outward + math::sin(angle) * outward.perp())
        })
    };
    cap(to, direction).chain(cap(from, -direction)).collect()
}

/// Draws bumpers and the origins of beams, on top of the body.
pub fn draw_fittings(drawing: &mut Drawing, robi: &RobiSpec, pose: &Pose) {
    for bumper in &robi.bumpers {
        let arc = arc(pose, DVec2::ZERO, 0.5 * robi.diameter, bumper.from, bumper.to);
        drawing.push(Shape::outlined(Form::Path(arc), BUMPER_LINE).detail(robi.diameter));
    }
    let sensor_views = sensor_views(robi);
    let ranges = sensor_views.iter().map(|view| (view.at, view.line()));
    let infrareds = robi.infrareds.iter().map(|infrared| (infrared.position, INFRARED_LINE));
    for (position, line) in ranges.chain(infrareds.map(|(position, line)| (position.truncate(), line))) {
        let dot = Form::Disc { centre: pose.transform_point(position), radius: 0.0, min_radius_px: 2.0 };
        drawing.push(Shape::filled(dot, line.paint).detail(robi.diameter));
    }
}

/// Draws the ranges of all sensors, below the bodies; beams end at `walls`.
pub fn draw_sensors(drawing: &mut Drawing, robi: &RobiSpec, pose: &Pose, walls: &Walls) {
    draw_camera(drawing, robi, pose);
    let visible_length = |origin: DVec2, direction: DVec2, range: f64| {
        walls.cast(origin, direction, range).map_or(range, |hit| hit.distance)
    };
    let sensor_views = sensor_views(robi);
    for (view, half_angle) in sensor_views.iter().filter_map(|view| Some((view, view.half_angle?))) {
        draw_cone(drawing, view, half_angle, pose, walls);
    }
    let mut beam = |position: DVec2, angle: f64, range: f64, line: Line| {
        let origin = pose.transform_point(position);
        let direction = pose.heading.turned(angle).direction();
        let end = origin + direction * visible_length(origin, direction, range);
        drawing.push(Shape::outlined(Form::Path(vec![origin, end]), line).detail(range));
    };
    for view in &sensor_views {
        beam(view.at, view.angle(), view.floor_range, view.line());
    }
    for infrared in &robi.infrareds {
        beam(infrared.position.truncate(), infrared.angle, infrared.range, INFRARED_LINE);
    }
    let radius = 0.5 * robi.diameter;
    if let Some(lidar) = &robi.lidar {
        // The scanner's full range would hide the other sensors: only short rays are drawn around its position, over
        // its sweep.
        let start = pose.transform_point(scanner_pose(robi, lidar).position.truncate());
        let steps = (36.0 * lidar.sweep / TAU).ceil().max(1.0) as u32;
        let middle = scanner_pose(robi, lidar).forward();
        let first = math::atan2(middle.y, middle.x) - 0.5 * lidar.sweep;
        for angle in (0..steps).map(|step| first + lidar.sweep * (f64::from(step) + 0.5) / f64::from(steps)) {
            let towards = pose.heading.turned(angle).direction();
            let ray = vec![start + 0.5 * radius * towards, start + 0.7 * radius * towards];
            drawing.push(Shape::outlined(Form::Path(ray), LIDAR_LINE).detail(0.1 * robi.diameter));
        }
    }
    add_sensor_legend(drawing, robi);
}

fn add_sensor_legend(drawing: &mut Drawing, robi: &RobiSpec) {
    if !robi.psds.is_empty() {
        drawing.add_legend(Symbol::Beam(PSD_LINE), "PSD, up to its range");
    }
    if robi.ranges.iter().any(|range| !matches!(range.model, RangeModel::Sonar(_))) {
        drawing.add_legend(Symbol::Beam(RANGE_LINE), "range sensor, line of sight");
    }
    if robi.ranges.iter().any(|range| matches!(range.model, RangeModel::Sonar(_))) {
        drawing.add_legend(Symbol::Sector(SONAR_FILL, RANGE_LINE), "sonar, its beam");
    }
    if !robi.infrareds.is_empty() {
        drawing.add_legend(Symbol::Beam(INFRARED_LINE), "infrared switch, its range");
    }
    if !robi.bumpers.is_empty() {
        drawing.add_legend(Symbol::Line(BUMPER_LINE), "bumper");
    }
    if robi.camera.is_some() {
        drawing.add_legend(Symbol::Sector(CAMERA_FILL, CAMERA_LINE), "camera, field of view");
    }
    if robi.lidar.is_some() {
        drawing.add_legend(Symbol::Line(LIDAR_LINE), "laser scanner");
    }
}

/// Range sensor from above, with its servos centred.
struct SensorView<'r> {
    name: &'r str,
    /// Position in the robot's frame.
    at: DVec2,
    /// Line of sight in the robot's frame, projected on the floor; shorter than a unit vector if it points up or down.
    axis: DVec2,
    /// Range along the floor.
    floor_range: f64,
    /// Range along the line of sight.
    range: f64,
    /// Half angle of a sonar's beam.
    half_angle: Option<f64>,
    model: RangeModel,
}

impl SensorView<'_> {
    fn line(&self) -> Line {
        if matches!(self.model, RangeModel::Psd { .. }) { PSD_LINE } else { RANGE_LINE }
    }

    fn angle(&self) -> f64 {
        math::atan2(self.axis.y, self.axis.x)
    }
}

/// Range sensors of a robot whose servos are centred.
fn sensor_views(robi: &RobiSpec) -> Vec<SensorView<'_>> {
    let names = robi.psds.iter().map(|psd| &psd.name).chain(robi.ranges.iter().map(|range| &range.name));
    let sensors = build::range_sensors(robi);
    let view = |(name, sensor): (_, &RangeSensor)| {
        let frame = frame_of(robi, &sensor.mount, sensor.link);
        let forward = frame.forward().truncate();
        let (range, half_angle) = match &sensor.model {
            RangeModel::Psd { range } => (*range, None),
            RangeModel::Laser(echo) | RangeModel::Ultrasonic(echo) | RangeModel::Reflectance(echo) => (echo.max, None),
            RangeModel::Sonar(sonar) => (sonar.max, Some(sonar.half_angle)),
        };
        let (at, floor_range) = (frame.position.truncate(), range * forward.length());
        SensorView { name, at, axis: forward, floor_range, range, half_angle, model: sensor.model }
    };
    names.map(String::as_str).zip(&sensors).map(view).collect()
}

/// Pose in the robot's frame of a device at `mount` on a link, or on the body, with the servos centred.
fn frame_of(robi: &RobiSpec, mount: &Pose3, link: Option<usize>) -> Pose3 {
    let servos = robi.all_servos().into_iter().map(|servo| 0.5 * (servo.swing[0] + servo.swing[1]));
    let joints = build::legs(robi).map_or_else(Vec::new, |legs| legs.standing_joints());
    let angles: Vec<f64> = servos.chain(joints).collect();
    let links = build::links(robi);
    Posture { links: &links, angles: &angles, ..Posture::default() }.world_from(mount, link)
}

/// Pose of a laser scanner in the robot's frame.
fn scanner_pose(robi: &RobiSpec, lidar: &LidarSpec) -> Pose3 {
    let (mount, link) = build::scanner_mount(robi, lidar);
    frame_of(robi, &mount, link)
}

/// The cone of a sonar from above, up to its range or the walls.
fn draw_cone(drawing: &mut Drawing, view: &SensorView<'_>, half_angle: f64, pose: &Pose, walls: &Walls) {
    const STEPS: u32 = 16;
    let origin = pose.transform_point(view.at);
    let end = |step: u32| {
        let angle = view.angle() + half_angle * (2.0 * f64::from(step) / f64::from(STEPS) - 1.0);
        let direction = pose.heading.turned(angle).direction();
        origin
            + direction * walls.cast(origin, direction, view.floor_range).map_or(view.floor_range, |hit| hit.distance)
    };
    let outline = std::iter::once(origin).chain((0..=STEPS).map(end)).collect();
    drawing.push(Shape::filled(Form::Polygon(outline), SONAR_FILL).detail(view.floor_range));
}

/// Draws the field of view of the camera and, if a servo pans it, the arc of the servo's range.
fn draw_camera(drawing: &mut Drawing, robi: &RobiSpec, pose: &Pose) {
    let Some(camera) = &robi.camera else { return };
    let (pan, range) = match camera.pan {
        JointSpec::Fixed(pan) => (pan, None),
        JointSpec::Servo { from, to, .. } => (0.5 * (from + to), Some((from, to))),
    };
    let view = camera.lens.fov();
    let (position, length) = (camera.position.truncate(), 1.5 * robi.diameter);
    let mut outline = arc(pose, position, length, pan - 0.5 * view, pan + 0.5 * view);
    outline.push(pose.transform_point(position));
    let sector = Shape::filled(Form::Polygon(outline), CAMERA_FILL).with_line(CAMERA_LINE);
    drawing.push(sector.detail(robi.diameter));
    if let Some((from, to)) = range {
        let line = Line::solid(CAMERA, 2.0);
        drawing
            .push(Shape::outlined(Form::Path(arc(pose, position, 0.4 * length, from, to)), line).detail(robi.diameter));
        drawing.add_legend(Symbol::Line(line), "camera, range of its pan servo");
    }
}

/// Points, in the world frame, of an arc about `centre` (robot's frame). The angles are counter-clockwise from forward.
fn arc(pose: &Pose, centre: DVec2, radius: f64, from: f64, to: f64) -> Vec<DVec2> {
    let steps = ((to - from).abs() / (PI / 36.0)).ceil().clamp(1.0, 144.0) as u32;
    let point = |step: u32| {
        let angle = from + (to - from) * f64::from(step) / f64::from(steps);
        pose.transform_point(centre + radius * DVec2::new(math::cos(angle), math::sin(angle)))
    };
    (0..=steps).map(point).collect()
}

/// Labels each sensor, in the picture of a single robot, with its name and its range, image size or number of points.
pub fn label_sensors(drawing: &mut Drawing, robi: &RobiSpec, pose: &Pose) {
    let mut label = |text: String, point: DVec2, towards: DVec2| {
        let at = pose.transform_point(point);
        drawing.labels.push(Label {
            text,
            at,
            clearance: 0.0,
            min_clearance_px: 4.0,
            direction: pose.transform_vector(towards),
        });
    };
    let direction_of = |angle: f64| DVec2::new(math::cos(angle), math::sin(angle));
    // Labels are placed at the edge of the body, where the beams leave it, since the sensors themselves are close
    // together.
    let edge = |position: DVec2, direction: DVec2, range: f64| {
        let (along, radius) = (position.dot(direction), 0.5 * robi.diameter);
        let edge_squared = along * along + radius * radius - position.length_squared();
        position + direction * (edge_squared.max(0.0).sqrt() - along).clamp(0.0, range)
    };
    for view in sensor_views(robi) {
        let direction = direction_of(view.angle());
        label(
            format!("{}, {} m", view.name, rounded(view.range)),
            edge(view.at, direction, view.floor_range),
            direction,
        );
    }
    for infrared in &robi.infrareds {
        let text = format!("{}, {} m", infrared.name, rounded(infrared.range));
        let (position, direction) = (infrared.position.truncate(), direction_of(infrared.angle));
        label(text, edge(position, direction, infrared.range), direction);
    }
    for bumper in &robi.bumpers {
        let middle = direction_of(0.5 * (bumper.from + bumper.to));
        label(bumper.name.clone(), 0.5 * robi.diameter * middle, middle);
    }
    if let Some(camera) = &robi.camera {
        let text = camera.image.map_or("camera".to_owned(), |[width, height]| format!("camera, {width} x {height}"));
        label(text, camera.position.truncate(), DVec2::ZERO);
    }
    if let Some(lidar) = &robi.lidar {
        let point = scanner_pose(robi, lidar).position.truncate();
        label(format!("lidar, {} points", lidar.points), point, DVec2::ZERO);
    }
}

/// Metres rounded to a millimetre.
fn rounded(metres: f64) -> f64 {
    (metres * 1000.0).round() / 1000.0
}
