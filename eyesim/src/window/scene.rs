//! Scene of a run in the page's protocol.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use glam::DVec2;
use sim_core::build;
use sim_core::camera::{self, Attachment, Label, Scenery};
use sim_core::pose::Link;
use sim_core::spec::{ObjectSpec, ObjectType, RobiSpec, RobotSpec, SceneSpec};
use sim_core::time::Time;
use sim_core::{ObjectId, RobotId};
use sim_host::record::mcap::scene::point;
use sim_host::robios::lcd;
use sim_view::protocol::{self, Body, Lcd, Part};

use super::device;
use super::surface::Surfaces;

/// Input of [`scene`](Self::scene): the parts of a run that do not change with every slot.
pub struct SceneInput<'a> {
    /// Number of the run since the window was opened, from 1.
    pub run: u32,
    /// Seed of the run.
    pub seed: u64,
    /// Length of a slot.
    pub slot: Time,
    /// Scene of the run.
    pub spec: &'a SceneSpec,
    /// Scenery that cameras see.
    pub scenery: &'a Scenery,
    /// The robots that are in the world, in order of their ids.
    pub robots: Vec<RobotInput>,
    /// The movable objects that are in the world, in order of their ids.
    pub objects: Vec<ObjectInput>,
    /// Types of robots and objects that can be added.
    pub addable_types: protocol::AddableTypes,
}

/// A robot.
#[derive(Clone)]
pub struct RobotInput {
    /// Its number.
    pub id: RobotId,
    /// Its type.
    pub robi: Arc<RobiSpec>,
    /// Its program; empty for none.
    pub program: String,
    /// Position in the world frame, in metres.
    pub position: DVec2,
    /// True if the robot has the display of RoBIOS-7.
    pub has_colours: bool,
}

/// A movable object.
#[derive(Clone)]
pub struct ObjectInput {
    /// Its number.
    pub id: ObjectId,
    /// Its type.
    pub kind: Arc<ObjectType>,
    /// Position in the world frame, in metres.
    pub position: DVec2,
}

impl RobotInput {
    /// The robot of `spec` at its start.
    pub fn at_start(spec: &RobotSpec) -> Self {
        Self {
            id: spec.id,
            robi: Arc::clone(&spec.robi),
            program: spec.program_name().to_owned(),
            position: spec.start.position,
            has_colours: spec.api.or(spec.dialect) == Some(7),
        }
    }
}

impl ObjectInput {
    /// The object of `spec` at its start.
    pub fn at_start(id: ObjectId, spec: &ObjectSpec) -> Self {
        Self { id, kind: Arc::clone(&spec.kind), position: spec.pose.position }
    }
}

impl SceneInput<'_> {
    /// The scene in the page's protocol.
    pub fn scene(&self) -> protocol::Scene {
        let mut surfaces = Surfaces::default();
        let parts = self.scenery.parts().iter().filter(|part| self.is_present(part.attachment));
        let links = self.robots.iter().map(|robot| (robot.id, part_links(&robot.robi))).collect();
        let parts =
            parts.map(|part| Part { mesh: surfaces.mesh(&part.mesh), place: attachment_of(part, &links) }).collect();
        let ground = self.scenery.ground().map(|ground| ground_of(ground, &mut surfaces));
        let camera::Light { sun_direction, ambient, diffuse, shadows, .. } = *self.scenery.light();
        let camera::Sky { horizon, zenith } = *self.scenery.sky();
        protocol::Scene {
            run: self.run,
            title: title(self.spec),
            seed: self.seed.to_string(),
            slot_s: self.slot.seconds(),
            bounds_m: self.bounds().map(|corner| corner.to_array()),
            parts,
            ground,
            light: protocol::Light { towards: sun_direction.to_array(), ambient, diffuse, shadows },
            sky: protocol::Sky { horizon, zenith },
            robots: self.robots.iter().map(robot_of).collect(),
            objects: self.objects.iter().map(object_of).collect(),
            addable_types: self.addable_types.clone(),
            images: surfaces.images,
            meshes: surfaces.meshes,
        }
    }

    fn is_present(&self, attachment: Attachment) -> bool {
        match attachment {
            Attachment::Fixed(_) => true,
            Attachment::Robot(id) | Attachment::Leg(id, _) => self.robots.iter().any(|robot| robot.id == id),
            Attachment::Object(id) => self.objects.iter().any(|object| object.id == id),
        }
    }

    /// Lower left and upper right corner of the area that floor, walls, terrain, robots and objects occupy.
    fn bounds(&self) -> [DVec2; 2] {
        let (low, high) = self.spec.world.bounds();
        let discs = self.robots.iter().map(|robot| (robot.position, 0.5 * robot.robi.diameter));
        let objects = self.objects.iter().map(|object| (object.position, body_of(&object.kind).radius_m));
        let discs = discs.chain(objects).flat_map(|(centre, radius)| [centre - radius, centre + radius]);
        let terrain = self.spec.world.terrain.iter().filter_map(|terrain| terrain.mesh.as_ref()?.bounds());
        let terrain = terrain.flat_map(|(low, high)| [low.truncate(), high.truncate()]);
        let corners = discs.chain(terrain).fold([low, high], |[low, high], point| [low.min(point), high.max(point)]);
        // An empty scene still needs a visible area.
        if (corners[1] - corners[0]).min_element() > 0.0 { corners } else { [corners[0] - 1.0, corners[1] + 1.0] }
    }
}

/// Name of a scene's file without folders and extension.
pub fn title(spec: &SceneSpec) -> String {
    let name = Path::new(&spec.file).file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = [".scene.toml", ".toml", ".sim"].into_iter().find_map(|extension| name.strip_suffix(extension));
    stem.map(str::to_owned).unwrap_or(name)
}

/// For each part of a robot's legs, the index of its link.
fn part_links(robi: &RobiSpec) -> Vec<usize> {
    build::legs(robi).map_or_else(Vec::new, |legs| legs.part_links())
}

/// Attachment of a part; `links` contains, for each robot, the links of the parts of its legs.
fn attachment_of(part: &camera::Part, links: &BTreeMap<RobotId, Vec<usize>>) -> protocol::Attachment {
    match part.attachment {
        Attachment::Robot(RobotId(robot)) => protocol::Attachment::Robot { robot },
        Attachment::Leg(id, part) => protocol::Attachment::Link { robot: id.0, link: links[&id][part] as u32 },
        Attachment::Object(ObjectId(object)) => protocol::Attachment::Object { object },
        Attachment::Fixed(pose) => {
            let what = match part.label {
                Label::Wall(_) => "wall",
                Label::Ground => "terrain",
                _ => "object",
            };
            protocol::Attachment::World { what: what.to_owned(), at: point(&pose) }
        }
    }
}

fn ground_of(ground: &camera::Ground, surfaces: &mut Surfaces) -> protocol::Ground {
    let floor = ground.floor.as_ref().map(|floor| protocol::Floor {
        size_m: floor.size.to_array(),
        colour: floor.colour,
        image: floor.texture.as_ref().map(|texture| surfaces.image(texture)),
    });
    let spot = |spot: &camera::Spot| protocol::Spot {
        centre_m: spot.centre.to_array(),
        radius_m: spot.radius,
        colour: spot.colour,
    };
    protocol::Ground { colour: ground.colour, floor, spots: ground.spots.iter().map(spot).collect() }
}

/// Assumed height of a robot's body if its colliders have none, in metres.
const ROBOT_HEIGHT: f64 = 0.15;

fn robot_of(robot: &RobotInput) -> protocol::Robot {
    let RobotInput { id, robi, program, has_colours, .. } = robot;
    let legs = build::legs(robi);
    let top = robi.colliders.iter().map(|collider| collider.top()).fold(0.0, f64::max);
    let size_px = if *has_colours {
        [robi.lcd.width, robi.lcd.height].map(u32::from)
    } else {
        [lcd::WIDTH, lcd::HEIGHT].map(|side| side as u32)
    };
    protocol::Robot {
        id: id.0,
        name: robi.name.clone(),
        kind: robi.name.clone(),
        program: program.clone(),
        colour: build::ROBOT_COLOURS[id.index() % build::ROBOT_COLOURS.len()],
        body: Body { radius_m: 0.5 * robi.diameter, height_m: if top > 0.0 { top } else { ROBOT_HEIGHT } },
        links: legs.iter().flat_map(|legs| legs.links(0, 0)).map(link_of).collect(),
        standing_rad: legs.map_or_else(Vec::new, |legs| legs.standing_joints()),
        sensors: device::sensors(robi),
        camera: device::camera(robi),
        lcd: Lcd { size_px, has_colours: *has_colours },
    }
}

fn link_of(link: Link) -> protocol::Link {
    let Link { parent, origin, axis, joint } = link;
    let index = |index: usize| index as u32;
    protocol::Link { parent: parent.map(index), origin: point(&origin), axis: axis.to_array(), joint: joint.map(index) }
}

fn object_of(object: &ObjectInput) -> protocol::Object {
    protocol::Object { id: object.id.0, kind: object.kind.name.clone(), body: body_of(&object.kind) }
}

fn body_of(kind: &ObjectType) -> Body {
    let reach = kind.colliders.iter().map(|collider| collider.reach()).fold(0.0, f64::max);
    let top = kind.colliders.iter().map(|collider| collider.top()).fold(0.0, f64::max);
    Body { radius_m: reach, height_m: top }
}
