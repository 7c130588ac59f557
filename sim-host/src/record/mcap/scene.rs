//! Frames, scene entities and transforms of a scene, as in the Foxglove messages `foxglove.SceneUpdate` and
//! `foxglove.FrameTransforms`.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::DQuat;
use serde_json::{Value, json};
use sim_core::pose::{Pose, Pose3};
use sim_core::time::Time;
use sim_core::{ObjectId, RobotId};
use sim_view::protocol::{Attachment, Body, Floor, Link, Mesh, Point, Scene};

use super::timestamp;
use sim_core::math;

/// Name of the world frame.
pub(super) const WORLD: &str = "world";

/// Name of a robot's frame.
pub(super) fn robot_frame(RobotId(robot): RobotId) -> String {
    format!("robot/{robot}")
}

/// Name of the frame of a link of a robot.
pub(super) fn link_frame(robot: RobotId, link: usize) -> String {
    format!("{}/link/{link}", robot_frame(robot))
}

/// Name of a movable object's frame.
pub(super) fn object_frame(ObjectId(object): ObjectId) -> String {
    format!("object/{object}")
}

/// Pose in space, in the format of the viewer's web pages and of recordings.
pub fn point(pose: &Pose3) -> Point {
    Point { position_m: pose.position.to_array(), rotation: DQuat::from_mat3(&pose.rotation).normalize().to_array() }
}

/// Frame to which a part belongs.
#[derive(Clone, Copy, PartialEq)]
enum Owner {
    World,
    Robot(u32),
    Link(u32, u32),
    Object(u32),
}

impl Owner {
    fn of(attachment: &Attachment) -> Self {
        match attachment {
            Attachment::World { .. } => Self::World,
            Attachment::Robot { robot } => Self::Robot(*robot),
            Attachment::Link { robot, link } => Self::Link(*robot, *link),
            Attachment::Object { object } => Self::Object(*object),
        }
    }
}

/// Entities of the world and of all bodies.
pub(super) fn all(scene: &Scene) -> Vec<Value> {
    let robots = scene.robots.iter().map(|robot| robot.id).flat_map(|id| self::robot(scene, id, id));
    let objects = scene.objects.iter().map(|object| object.id).filter_map(|id| self::object(scene, id, id));
    std::iter::once(world(scene)).chain(robots).chain(objects).collect()
}

/// Entities of robot `id`: its body, and its links that have a shape. They look like the robot of the scene whose id is
/// `model`; without such a robot there are none.
pub(super) fn robot(scene: &Scene, id: u32, model: u32) -> Vec<Value> {
    let Some(robot) = scene.robots.iter().find(|robot| robot.id == model) else { return Vec::new() };
    let label = json!([{
        "pose": pose(&Point { position_m: [0.0, 0.0, robot.body.height_m + 0.05], rotation: UPRIGHT }),
        "billboard": true,
        "font_size": 12.0,
        "scale_invariant": true,
        "color": colour(robot.colour),
        "text": format!("{} {id}", robot.name),
    }]);
    let triangles = triangles(scene, Owner::Robot(model));
    let body = entity(&robot_frame(RobotId(id)), triangles, &robot.body, robot.colour, label);
    let link = |link: usize| {
        let shape = self::triangles(scene, Owner::Link(model, link as u32));
        (!shape.is_empty()).then(|| frame_entity(&link_frame(RobotId(id), link), shape, Vec::new(), json!([])))
    };
    std::iter::once(body).chain((0..robot.links.len()).filter_map(link)).collect()
}

/// Entity of movable object `id`, with the appearance of object `model` of the scene.
pub(super) fn object(scene: &Scene, id: u32, model: u32) -> Option<Value> {
    let object = scene.objects.iter().find(|object| object.id == model)?;
    let triangles = triangles(scene, Owner::Object(model));
    Some(entity(&object_frame(ObjectId(id)), triangles, &object.body, [200, 120, 40], json!([])))
}

fn world(scene: &Scene) -> Value {
    let mut surfaces = triangles(scene, Owner::World);
    if let Some(floor) = scene.ground.as_ref().and_then(|ground| ground.floor.as_ref()) {
        surfaces.push(floor_triangles(floor));
    }
    frame_entity(WORLD, surfaces, Vec::new(), json!([]))
}

/// Entity of a body: its meshes, or the cylinder around it if it has none.
fn entity(frame: &str, triangles: Vec<Value>, body: &Body, rgb: [u8; 3], label: Value) -> Value {
    let mut cylinders = Vec::new();
    if triangles.is_empty() {
        let (width, height) = (2.0 * body.radius_m, body.height_m);
        cylinders.push(json!({
            "pose": pose(&Point { position_m: [0.0, 0.0, 0.5 * height], rotation: UPRIGHT }),
            "size": { "x": width, "y": width, "z": height },
            "bottom_scale": 1.0,
            "top_scale": 1.0,
            "color": colour(rgb),
        }));
    }
    frame_entity(frame, triangles, cylinders, label)
}

/// Entity that moves with the frame of the same name.
fn frame_entity(frame: &str, triangles: Vec<Value>, cylinders: Vec<Value>, texts: Value) -> Value {
    json!({
        "timestamp": timestamp(Time::ZERO),
        "frame_id": frame,
        "id": frame,
        "lifetime": { "seconds": 0, "nanos": 0 },
        "frame_locked": true,
        "cylinders": cylinders,
        "triangles": triangles,
        "texts": texts,
    })
}

/// No rotation.
const UPRIGHT: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// Triangle lists of the owner's parts, one for each material of each part.
fn triangles(scene: &Scene, owner: Owner) -> Vec<Value> {
    let parts = scene.parts.iter().filter(|part| Owner::of(&part.place) == owner);
    parts
        .flat_map(|part| {
            let at = match &part.place {
                Attachment::World { at, .. } => *at,
                _ => Point { position_m: [0.0; 3], rotation: UPRIGHT },
            };
            scene.meshes.get(part.mesh as usize).map(|mesh| triangle_lists(mesh, &at)).unwrap_or_default()
        })
        .collect()
}

/// Triangle lists of a mesh at the pose `at`, one for each material.
fn triangle_lists(mesh: &Mesh, at: &Point) -> Vec<Value> {
    let bytes = STANDARD.decode(&mesh.positions).unwrap_or_default();
    let (numbers, _) = bytes.as_chunks::<4>();
    let numbers: Vec<f32> = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let (points, _) = numbers.as_chunks::<3>();
    let mut rest = points;
    let mut triangle_lists = Vec::new();
    for material in &mesh.materials {
        let (points, others) = rest.split_at((3 * material.triangles as usize).min(rest.len()));
        rest = others;
        triangle_lists.push(triangle_list(at, points, material.colour));
    }
    triangle_lists
}

fn triangle_list(at: &Point, points: &[[f32; 3]], rgb: [u8; 3]) -> Value {
    let points: Vec<_> = points.iter().map(|[x, y, z]| json!({ "x": x, "y": y, "z": z })).collect();
    json!({ "pose": pose(at), "points": points, "color": colour(rgb) })
}

fn floor_triangles(floor: &Floor) -> Value {
    let [width, length] = floor.size_m.map(|side| side as f32);
    let corners = [[0.0, 0.0, 0.0], [width, 0.0, 0.0], [width, length, 0.0], [0.0, length, 0.0]];
    let points = [0, 1, 2, 0, 2, 3].map(|corner| corners[corner]);
    triangle_list(&Point { position_m: [0.0; 3], rotation: UPRIGHT }, &points, floor.colour)
}

pub(super) fn pose(point: &Point) -> Value {
    json!({ "position": vector(point.position_m), "orientation": quaternion(point.rotation) })
}

fn vector([x, y, z]: [f64; 3]) -> Value {
    json!({ "x": x, "y": y, "z": z })
}

fn quaternion([x, y, z, w]: [f64; 4]) -> Value {
    json!({ "x": x, "y": y, "z": z, "w": w })
}

fn colour(rgb: [u8; 3]) -> Value {
    let [r, g, b] = rgb.map(|level| f64::from(level) / 255.0);
    json!({ "r": r, "g": g, "b": b, "a": 1.0 })
}

/// A transform of `foxglove.FrameTransforms`.
pub(super) fn transform(at: Time, parent: &str, child: &str, point: &Point) -> Value {
    json!({
        "timestamp": timestamp(at),
        "parent_frame_id": parent,
        "child_frame_id": child,
        "translation": vector(point.position_m),
        "rotation": quaternion(point.rotation),
    })
}

/// Transforms of the links of a robot, each in the frame of its parent, at these joint angles.
pub(super) fn links(at: Time, robot: RobotId, links: &[Link], joints_rad: &[f64]) -> Vec<Value> {
    let transform = |(index, link): (usize, &Link)| {
        let parent = link.parent.map_or_else(|| robot_frame(robot), |parent| link_frame(robot, parent as usize));
        let angle = link.joint.and_then(|joint| joints_rad.get(joint as usize)).copied().unwrap_or(0.0);
        let turn = DQuat::from_axis_angle(link.axis.into(), angle);
        let rotation = (DQuat::from_array(link.origin.rotation) * turn).to_array();
        self::transform(at, &parent, &link_frame(robot, index), &Point { rotation, ..link.origin })
    };
    links.iter().enumerate().map(transform).collect()
}

/// Pose in space of a body in the plane.
pub(super) fn upright(x_m: f64, y_m: f64, phi_rad: f64) -> Point {
    Point { position_m: [x_m, y_m, 0.0], rotation: [0.0, 0.0, math::sin(0.5 * phi_rad), math::cos(0.5 * phi_rad)] }
}

/// Pose in space of a pose in the plane.
pub(super) fn pose_in_space(pose: &Pose) -> Point {
    upright(pose.position.x, pose.position.y, pose.heading.radians())
}
