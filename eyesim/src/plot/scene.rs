//! Pictures of files: a scene, a world, a robot type, an object type.

use std::collections::BTreeMap;

use glam::DVec2;
use sim_core::build;
use sim_core::build::MeshSource;
use sim_core::pose::Pose;
use sim_core::scene::Walls;
use sim_core::spec::{ObjectType, RobiSpec, SceneSpec};
use sim_format::MeshReader;
use sim_format::path;

use super::drawing::{Drawing, Form, Label, Line, Paint, Shape, Symbol};
use super::robot::{RobotStyle, draw_body, draw_fittings, draw_sensors, label_sensors};
use super::viewport::metres;
use super::{colour, ground, object};

/// Maximum number of robots that get labels: more labels would hide the picture.
pub const MAX_LABELS: usize = 100;
/// Maximum number of robots whose sensors are drawn: more sensors would hide the picture.
const MAX_WITH_SENSORS: usize = 30;

/// Draws the world and its markers, without robots and objects, into `drawing`.
pub fn draw_ground(mut drawing: Drawing, scene: &SceneSpec, mesh_reader: &mut MeshReader<'_>) -> Drawing {
    ground::draw_world(&mut drawing, &scene.world, mesh_reader.floor(&scene.world));
    ground::draw_markers(&mut drawing, &scene.markers);
    drawing
}

/// Draws the world with its markers and objects, and the robots at their starts.
pub fn draw_scene(scene: &SceneSpec, mesh_reader: &mut MeshReader<'_>) -> Drawing {
    let world = &scene.world;
    let mut drawing = draw_ground(Drawing::new(title(scene)), scene, mesh_reader);
    // A start at which a robot stands gets no arrow.
    let is_taken = |pose: &Pose| scene.robots.iter().any(|robot| robot.start == *pose);
    ground::draw_starts(&mut drawing, world.starts.iter().filter(|start| !is_taken(&start.pose)));
    let mut meshes = BTreeMap::new();
    for object in &scene.objects {
        let kind = &object.kind;
        let mesh = meshes.entry((&kind.file, &kind.name)).or_insert_with(|| mesh_reader.object(kind));
        object::draw_object(&mut drawing, kind, mesh.as_deref(), &object.pose);
    }
    if scene.robots.len() <= MAX_WITH_SENSORS {
        let walls = build::walls(world);
        for robot in &scene.robots {
            draw_sensors(&mut drawing, &robot.robi, &robot.start, &walls);
        }
    }
    for (index, robot) in scene.robots.iter().enumerate() {
        let mesh = mesh_reader.robot(&robot.robi);
        let style = RobotStyle { colour: colour::robot(index), mesh: mesh.as_deref(), joints: &[] };
        draw_body(&mut drawing, &robot.robi, &robot.start, &style);
        draw_fittings(&mut drawing, &robot.robi, &robot.start);
        if scene.robots.len() <= MAX_LABELS {
            drawing.labels.push(robot_label(robot.id.0, &robot.robi, &robot.start));
        }
    }
    for (index, robot) in scene.robots.iter().enumerate() {
        // The program's folders would leave no space for its name.
        let program = path::file_name(robot.program_name());
        let command = [program].into_iter().chain(robot.arguments.iter().map(String::as_str));
        let program = command.collect::<Vec<_>>().join(" ");
        let text = format!("r{} {} {program}", robot.id.0, robot.robi.name);
        drawing.add_legend(body_symbol(index), text.trim_end());
    }
    drawing
}

/// File name, size of the floor and number of walls.
fn title(scene: &SceneSpec) -> String {
    let name = scene.file.rsplit('/').next().unwrap_or_default();
    let DVec2 { x, y } = scene.world.floor;
    let size = (x > 0.0 && y > 0.0).then(|| format!("{} m x {} m", metres(x, 0.01), metres(y, 0.01)));
    let walls = match scene.world.walls.len() {
        0 => None,
        1 => Some("1 wall".to_owned()),
        count => Some(format!("{count} walls")),
    };
    let facts: Vec<String> = size.into_iter().chain(walls).collect();
    if facts.is_empty() { name.to_owned() } else { format!("{name}: {}", facts.join(", ")) }
}

/// Label with the number of a robot, in front of it.
pub fn robot_label(id: u32, robi: &RobiSpec, pose: &Pose) -> Label {
    let direction = pose.heading.direction();
    Label {
        text: format!("r{id}"),
        at: pose.position,
        clearance: 0.5 * robi.diameter,
        min_clearance_px: 4.0,
        direction,
    }
}

/// Legend symbol of the robot at `index` of the list.
pub fn body_symbol(index: usize) -> Symbol {
    let colour = colour::robot(index);
    Symbol::Disc(Some(Paint::translucent(colour, 0.35)), Line::solid(colour, 1.5))
}

/// Draws a robot type, facing right, with its sensors and their names.
pub fn draw_robi(robi: &RobiSpec, mesh_reader: &mut MeshReader<'_>) -> Drawing {
    let name = robi.file.rsplit('/').next().unwrap_or_default();
    let title = format!("{name}: {}, {} mm across", robi.name, (robi.diameter * 1000.0).round());
    let mut drawing = Drawing::new(title);
    let pose = Pose::new(0.0, 0.0, 0.0);
    let mesh = mesh_reader.robot(robi);
    // Beams leave the picture; their lengths are written beside them.
    drawing.include_around(DVec2::ZERO, 1.1 * robi.diameter);
    draw_sensors(&mut drawing, robi, &pose, &Walls::new(Vec::new()));
    draw_body(&mut drawing, robi, &pose, &RobotStyle { colour: colour::robot(0), mesh: mesh.as_deref(), joints: &[] });
    draw_fittings(&mut drawing, robi, &pose);
    label_sensors(&mut drawing, robi, &pose);
    drawing.add_legend(body_symbol(0), "body, heading");
    drawing
}

/// Draws an object type, facing right.
pub fn draw_object_type(kind: &ObjectType, mesh_reader: &mut MeshReader<'_>) -> Drawing {
    let name = kind.file.rsplit('/').next().unwrap_or_default();
    let mut drawing = Drawing::new(format!("{name}: {}", kind.name));
    let mesh = mesh_reader.object(kind);
    let pose = Pose::new(0.0, 0.0, 0.0);
    object::draw_object(&mut drawing, kind, mesh.as_deref(), &pose);
    let (low, high) = drawing.extent();
    let margin = 0.3 * (high - low).max_element();
    drawing.include(low - DVec2::splat(margin));
    drawing.include(high + DVec2::splat(margin));
    let line = Line::solid(colour::INK, 1.25);
    let needle = Form::Needle { pose, length: 0.25 * (high - low).max_element(), min_length_px: 10.0 };
    drawing.push(Shape::outlined(needle, line));
    drawing.add_legend(Symbol::Line(line), "forward");
    drawing
}
