//! Picture of a finished run: the world with the trails of robots and objects.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;
use sim_core::pose::Pose;
use sim_core::scene::Texture;
use sim_core::spec::{MarkerSpec, ObjectSpec, ObjectType, RobiSpec, RobotSpec, SceneSpec, WorldSpec};
use sim_host::executive::scheduler::RobotEnd;
use sim_host::launch::Finished;
use sim_host::record::Trails;
use sim_host::record::diff::PathPair;
use sim_host::record::trail::{BodyTrails, Trail};

use super::colour::{self, INK, SHADE};
use super::drawing::{Drawing, Form, Line, Paint, Shape, Symbol};
use super::ground;
use super::object::{collider_shape, draw_object};
use super::robot::{RobotStyle, draw_body, draw_heading};
use super::scene::{MAX_LABELS, robot_label};

/// A robot of a run.
#[derive(Clone, Debug)]
pub struct RunRobot {
    /// Its number.
    pub id: u32,
    /// Its type.
    pub robi: Arc<RobiSpec>,
    /// Pose at the start.
    pub start: Pose,
    /// Pose at the end.
    pub end: Pose,
    /// Depth of its hull under the surface of the water at the end, in metres; `None` on dry land.
    pub depth: Option<f64>,
    /// Angles of the joints of its legs at the end, leg by leg, in radians.
    pub joints: Vec<f64>,
    /// Its path: one line from the start, and one from each pose at which it was placed.
    pub trails: Vec<Vec<DVec2>>,
}

/// An object of a run.
#[derive(Clone, Debug)]
pub struct RunObject {
    /// Its type.
    pub kind: Arc<ObjectType>,
    /// Pose at the start.
    pub start: Pose,
    /// Pose at the end.
    pub end: Pose,
    /// Its path, as polylines like a robot's; empty for an object that does not move.
    pub trails: Vec<Vec<DVec2>>,
}

/// Data for the picture of a finished run.
#[derive(Clone, Debug)]
pub struct RunPicture<'a> {
    /// Title, shown above the picture.
    pub title: &'a str,
    /// The world.
    pub world: &'a WorldSpec,
    /// Image of its floor.
    pub floor: Option<Arc<Texture>>,
    /// Its markers.
    pub markers: &'a [MarkerSpec],
    /// The robots in the order of their numbers.
    pub robots: &'a [RunRobot],
    /// The objects.
    pub objects: &'a [RunObject],
    /// Points of contact between bodies.
    pub contacts: &'a [DVec2],
}

/// Draws the world of a finished run with the paths that `trails`, a sink of the run, has recorded.
pub fn draw_finished(finished: &Finished, trails: &Trails) -> Drawing {
    let Finished { scene, ended, .. } = finished;
    let spawner = ended.run.spawner();
    let robot = |((spec, end), trail): ((&RobotSpec, &RobotEnd), &BodyTrails)| RunRobot {
        id: spec.id.0,
        robi: Arc::clone(&spec.robi),
        start: spec.start,
        end: end.pose,
        depth: end.depth,
        joints: end.joints.clone(),
        trails: trail.lines(),
    };
    let robots: Vec<RunRobot> =
        spawner.roster().robots().iter().zip(&ended.robots).zip(trails.trails()).map(robot).collect();
    let object = |object: &ObjectSpec, end: Pose, trails: Vec<Vec<DVec2>>| RunObject {
        kind: Arc::clone(&object.kind),
        start: object.pose,
        end,
        trails,
    };
    let fixed_specs = scene.objects.iter().filter(|spec| spec.kind.is_fixed);
    let fixed = fixed_specs.map(|spec| object(spec, spec.pose, Vec::new()));
    let movable = spawner.roster().objects().iter().zip(ended.objects.iter().zip(trails.objects()));
    let movable = movable.map(|(spec, (end, trail))| object(spec, *end, trail.lines()));
    let objects: Vec<RunObject> = fixed.chain(movable).collect();
    draw_run(&RunPicture {
        title: &scene.file,
        world: &scene.world,
        floor: finished.scenery.floor(),
        markers: &scene.markers,
        robots: &robots,
        objects: &objects,
        contacts: trails.contacts(),
    })
}

/// Draws the world, the paths of robots and objects, and the contacts. Reads no meshes.
pub fn draw_run(run: &RunPicture<'_>) -> Drawing {
    let RunPicture { robots, contacts, .. } = run;
    let mut drawing = Drawing::new(run.title);
    ground::draw_world(&mut drawing, run.world, run.floor.clone());
    ground::draw_markers(&mut drawing, run.markers);
    draw_objects(&mut drawing, run.objects);
    let line = |index: usize| Line::solid(colour::robot(index), 1.5);
    for (index, robot) in robots.iter().enumerate() {
        draw_trails(&mut drawing, &robot.trails, line(index));
    }
    for (index, robot) in robots.iter().enumerate() {
        let radius = 0.5 * robot.robi.diameter;
        drawing.include_around(robot.start.position, radius);
        let ring = Form::Disc { centre: robot.start.position, radius, min_radius_px: 4.0 };
        drawing.push(Shape::outlined(ring, line(index)));
        draw_heading(&mut drawing, &robot.start, radius);
        draw_body(
            &mut drawing,
            &robot.robi,
            &robot.end,
            &RobotStyle { colour: colour::robot(index), mesh: None, joints: &robot.joints },
        );
        if robots.len() <= MAX_LABELS {
            let mut label = robot_label(robot.id, &robot.robi, &robot.end);
            if let Some(depth) = robot.depth {
                label.text += &format!(", {depth:.2} m deep");
            }
            drawing.labels.push(label);
        }
    }
    let cross = Line::solid(INK, 1.5);
    for contact in *contacts {
        drawing.include(*contact);
        drawing.push(Shape::outlined(Form::Cross(*contact), cross));
    }
    drawing.add_legend(Symbol::Disc(None, cross), "start");
    drawing.add_legend(Symbol::Disc(Some(Paint::translucent(INK, 0.35)), cross), "end");
    drawing.add_legend(Symbol::Cross(cross), "contact");
    for (index, robot) in robots.iter().enumerate() {
        let line = Line { width: 3.0, ..line(index) };
        drawing.add_legend(Symbol::Line(line), format!("r{} {}", robot.id, robot.robi.name));
    }
    drawing
}

/// Draws the world of a scene (`floor` is the image on its floor), the paths of several runs, each in its own colour,
/// and a cross at the point of interest of each run.
pub fn draw_trials(
    scene: &SceneSpec,
    floor: Option<Arc<Texture>>,
    trials: &[(Vec<Vec<DVec2>>, Option<DVec2>)],
) -> Drawing {
    let mut drawing = Drawing::new(scene.file.as_str());
    ground::draw_world(&mut drawing, &scene.world, floor);
    ground::draw_markers(&mut drawing, &scene.markers);
    for (index, (lines, mark)) in trials.iter().enumerate() {
        let line = Line { paint: Paint::translucent(colour::robot(index), 0.7), width: 1.5 };
        draw_trails(&mut drawing, lines, line);
        if let Some(start) = lines.first().and_then(|line| line.first()) {
            let ring = Form::Disc { centre: *start, radius: 0.0, min_radius_px: 4.0 };
            drawing.push(Shape::outlined(ring, line));
        }
        if let Some(mark) = mark {
            drawing.include(*mark);
            drawing.push(Shape::outlined(Form::Cross(*mark), Line::solid(INK, 1.5)));
        }
    }
    drawing
}

/// Draws the paths of the robots of two runs, keyed by robot number: the first run in colour, the second on top in
/// black.
pub fn draw_paths(mut drawing: Drawing, paths: &BTreeMap<u32, PathPair>) -> Drawing {
    for (index, (robot, paths)) in paths.iter().enumerate() {
        let lines = [Line::solid(colour::robot(index), 4.0), Line::solid(INK, 1.2)];
        for (trail, line) in paths.trails.iter().zip(lines) {
            draw_trails(&mut drawing, &trail.iter().map(Trail::points).collect::<Vec<_>>(), line);
        }
        drawing.add_legend(Symbol::Line(lines[0]), format!("A: r{robot}"));
        if paths.trails[1].is_some() {
            drawing.add_legend(Symbol::Line(lines[1]), "B");
        }
    }
    drawing
}

fn draw_trails(drawing: &mut Drawing, trails: &[Vec<DVec2>], line: Line) {
    for trail in trails {
        trail.iter().for_each(|point| drawing.include(*point));
        drawing.push(Shape::outlined(Form::Path(trail.clone()), line));
    }
}

/// Draws objects at their last poses, and the outlines of moved objects at their first poses.
fn draw_objects(drawing: &mut Drawing, objects: &[RunObject]) {
    let line = Line::solid(SHADE, 1.0);
    for object in objects.iter().filter(|object| object.start != object.end) {
        drawing.include(object.start.position);
        for collider in &object.kind.colliders {
            drawing.push(Shape { fill: None, ..collider_shape(collider, &object.start, Paint::solid(SHADE), line) });
        }
        draw_trails(drawing, &object.trails, line);
        drawing.add_legend(Symbol::Disc(None, line), "where an object was");
    }
    for object in objects {
        draw_object(drawing, &object.kind, None, &object.end);
    }
}
