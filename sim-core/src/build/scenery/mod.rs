//! Builds the scenery of a scene: the surfaces that cameras see.

mod body;
mod leg;
mod mesh_builder;
mod object;
#[cfg(test)]
mod tests;
mod visuals;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;

use crate::camera::{Attachment, Floor, Ground, Label, Light, Part, Scenery, Sky, Spot};
use crate::math;
use crate::pose::Pose3;
use crate::scene::{Mesh, Segment, Texture};
use crate::spec::{
    DEFAULT_FLOOR_COLOUR, LightSpec, ObjectSpec, ObjectType, RobiSpec, SceneSpec, SkySpec, WallSpec, WorldSpec,
};
use crate::{ObjectId, RobotId};
pub use body::{ROBOT_COLOURS, wheel_centres};
use mesh_builder::MeshBuilder;
pub use visuals::{NoMeshes, SpawnedEntity, Visuals};

/// Default colour of walls (red, green, blue): nearly white, distinct from floor and sky. Source: our choice.
pub const WALL_COLOUR: [u8; 3] = [228, 228, 224];

/// Radius of a marker's spot in metres. Source: our choice, since the file formats do not define it.
pub const MARKER_RADIUS: f64 = 0.05;

/// Fraction of the non-ambient light that comes from the side opposite to the sun. Source: our choice.
const FILL: f64 = 0.35;

/// Source of the meshes and images of a scene, queried only when they are to be displayed.
pub trait MeshSource {
    /// The mesh of a robot type, in the robot's frame; `None` if the type names no mesh or the mesh cannot be read.
    fn robot(&mut self, robi: &RobiSpec) -> Option<Arc<Mesh>>;

    /// The mesh of an object type, in the object's frame; `None` if the type names no mesh or the mesh cannot be read.
    fn object(&mut self, kind: &ObjectType) -> Option<Arc<Mesh>>;

    /// The image stretched over the floor; `None` if the world names none, or the image cannot be read.
    fn floor(&mut self, world: &WorldSpec) -> Option<Arc<Texture>>;
}

/// Cache of meshes by type of robot or object. The keys are the addresses of the types, so `object_meshes` and
/// `robot_meshes` keep the types alive; the other maps contain only robot types that `robot_meshes` contains.
#[derive(Clone, Debug, Default)]
struct MeshCache {
    object_meshes: BTreeMap<usize, (Arc<ObjectType>, Arc<Mesh>)>,
    /// For each robot type, the mesh that its file names, if any.
    robot_meshes: BTreeMap<usize, (Arc<RobiSpec>, Option<Arc<Mesh>>)>,
    /// Default bodies of robot types without a mesh, by type and colour.
    default_bodies: BTreeMap<(usize, usize), Arc<Mesh>>,
    /// Leg parts, by robot type.
    legs: BTreeMap<usize, Vec<Arc<Mesh>>>,
}

impl MeshCache {
    /// Visible part of a movable object of this type.
    fn object(&mut self, id: ObjectId, kind: &Arc<ObjectType>, reader: &mut dyn MeshSource) -> Part {
        Part { mesh: self.object_mesh(kind, reader), label: Label::Object(id), attachment: Attachment::Object(id) }
    }

    fn object_mesh(&mut self, kind: &Arc<ObjectType>, reader: &mut dyn MeshSource) -> Arc<Mesh> {
        let raised_mesh = || {
            let mesh = reader.object(kind).unwrap_or_else(|| object::mesh(kind));
            (Arc::clone(kind), super::raised(&mesh, kind.lift))
        };
        Arc::clone(&self.object_meshes.entry(Arc::as_ptr(kind).addr()).or_insert_with(raised_mesh).1)
    }

    /// Visible part of a robot of this type, without legs.
    fn robot(&mut self, id: RobotId, robi: &Arc<RobiSpec>, reader: &mut dyn MeshSource) -> Part {
        let address = Arc::as_ptr(robi).addr();
        let read = || (Arc::clone(robi), reader.robot(robi));
        let (_, file_mesh) = self.robot_meshes.entry(address).or_insert_with(read);
        let mesh = file_mesh.clone().unwrap_or_else(|| {
            let colour = id.index() % ROBOT_COLOURS.len();
            let build = || body::mesh(robi, ROBOT_COLOURS[colour]);
            Arc::clone(self.default_bodies.entry((address, colour)).or_insert_with(build))
        });
        Part { mesh, label: Label::Robot(id), attachment: Attachment::Robot(id) }
    }

    /// Visible parts of the legs of a robot of this type; empty for a wheeled robot.
    fn legs(&mut self, id: RobotId, robi: &Arc<RobiSpec>) -> Vec<Part> {
        let meshes = self.legs.entry(Arc::as_ptr(robi).addr()).or_insert_with(|| leg::meshes(robi));
        let part = |(number, mesh): (usize, &Arc<Mesh>)| Part {
            mesh: Arc::clone(mesh),
            label: Label::Robot(id),
            attachment: Attachment::Leg(id, number),
        };
        meshes.iter().enumerate().map(part).collect()
    }
}

/// The scenery of a scene: ground, walls, objects, robots, light and sky.
///
/// Meshes and textures come from `reader`. An object without a mesh is shown as its colliders. A robot without a mesh
/// gets a default body (see `body`) in a colour chosen by its id, with wheels if it drives on them.
pub fn scenery(scene: &SceneSpec, reader: &mut dyn MeshSource) -> Scenery {
    scenery_with(scene, &mut MeshCache::default(), reader)
}

/// [`scenery`] with a cache of meshes that later additions can share.
fn scenery_with(scene: &SceneSpec, meshes: &mut MeshCache, reader: &mut dyn MeshSource) -> Scenery {
    let world = &scene.world;
    let mut parts: Vec<Part> = (0..).zip(&world.walls).map(|(number, wall)| wall_part(number, wall)).collect();
    let terrain = world.terrain.as_ref().and_then(|terrain| terrain.mesh.clone());
    let ground = terrain.is_none().then(|| ground(scene, reader));
    let fixed = |mesh, label| Part { mesh, label, attachment: Attachment::Fixed(Pose3::IDENTITY) };
    parts.extend(terrain.map(|mesh| fixed(mesh, Label::Ground)));
    parts.extend(object_parts(scene, meshes, reader));
    parts.extend(scene.robots.iter().map(|robot| meshes.robot(robot.id, &robot.robi, reader)));
    parts.extend(scene.robots.iter().flat_map(|robot| meshes.legs(robot.id, &robot.robi)));
    Scenery::new(parts, ground, light(&world.looks.light), sky(&world.looks.sky))
}

fn ground(scene: &SceneSpec, reader: &mut dyn MeshSource) -> Ground {
    let WorldSpec { floor: size, looks, .. } = &scene.world;
    let colour = looks.colour.unwrap_or(DEFAULT_FLOOR_COLOUR);
    let spots = scene.markers.iter().map(|marker| Spot {
        centre: marker.position,
        radius: MARKER_RADIUS,
        colour: marker.colour,
    });
    Ground {
        colour: looks.sky.ground,
        floor: Some(Floor { size: *size, colour, texture: reader.floor(&scene.world) }),
        spots: spots.collect(),
    }
}

fn light(light: &LightSpec) -> Light {
    let LightSpec { azimuth, elevation, ambient, shadows } = *light;
    let (vertical, horizontal) = math::sin_cos(elevation);
    let sun_direction = DVec3::new(horizontal * math::cos(azimuth), horizontal * math::sin(azimuth), vertical);
    let directed = 1.0 - ambient;
    Light { sun_direction, ambient, fill: FILL * directed, diffuse: (1.0 - FILL) * directed, shadows }
}

fn sky(sky: &SkySpec) -> Sky {
    Sky { horizon: sky.horizon, zenith: sky.zenith }
}

/// A wall on the floor: a sheet, or a box without a lower face. Sheets that meet at their ends share exact corners, so
/// that no gap shows; boxes that meet do not.
fn wall_part(number: u32, wall: &WallSpec) -> Part {
    let mut builder = MeshBuilder::default();
    let paint = builder.paint(wall.colour.unwrap_or(WALL_COLOUR));
    let line = Segment { a: wall.from, b: wall.to };
    if wall.thickness > 0.0 {
        let outline = line.thickened(wall.thickness).map(|side| side.a);
        builder.column(&outline, 0.0, |_| wall.height, paint, paint);
    } else {
        let [a, b] = [line.a, line.b];
        builder.panel([a.extend(0.0), b.extend(0.0), b.extend(wall.height), a.extend(wall.height)], paint);
    }
    Part { mesh: builder.finish(), label: Label::Wall(number), attachment: Attachment::Fixed(Pose3::IDENTITY) }
}

fn object_parts(scene: &SceneSpec, meshes: &mut MeshCache, reader: &mut dyn MeshSource) -> Vec<Part> {
    let mut movable = 0;
    let part = |(number, object): (u32, &ObjectSpec)| {
        if object.kind.is_fixed {
            let attachment = Attachment::Fixed(Pose3::from_planar(&object.pose, 0.0));
            return Part { mesh: meshes.object_mesh(&object.kind, reader), label: Label::Fixed(number), attachment };
        }
        movable += 1;
        meshes.object(ObjectId(movable), &object.kind, reader)
    };
    (0..).zip(&scene.objects).map(part).collect()
}
