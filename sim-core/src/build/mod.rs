//! Builds the simulated world from specs: walls, bodies, sensors, and the scenery that cameras see.

mod scenery;

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::DVec3;

use crate::drive::legged::{Gait, Leg, Legs};
use crate::drive::{ContactRule, DriveKind, Hull, Model};
use crate::object::{Figure, Part, Properties, Resistance, Shape, Solid};
use crate::pose::{Link, Pose, Pose3};
use crate::scene::{Ground, HeightField, Mesh, MeshIndex, Segment, Surface, WallId, Walls};
use crate::sensor::{RangeModel, RangeSensor};
use crate::spec::{
    self, Axis, Collider, ContactKind, DEFAULT_DUTY, DEFAULT_PERIOD, GaitSpec, HullSpec, LegSpec, LegsSpec, LidarSpec,
    LinkSpec, MountSpec, ObjectSpec, ObjectType, RobiSpec, SceneSpec, SpannedText, TerrainShape, WorldSpec,
};
use crate::time::Time;
use crate::world::{Space, ThickWall};
pub use scenery::{
    MARKER_RADIUS, MeshSource, NoMeshes, ROBOT_COLOURS, SpawnedEntity, Visuals, WALL_COLOUR, scenery, wheel_centres,
};

/// Coefficient of friction of an object against walls, robots and other objects. Source: our choice.
const CONTACT_FRICTION: f64 = 0.3;

/// Deceleration of a floating object as a fraction of gravity: a constant that replaces the water's drag. Source: our
/// choice.
const WATER_RESISTANCE: f64 = 0.005;

/// The static walls of a world. A thick wall becomes the four sides of its rectangle.
pub fn walls(world: &WorldSpec) -> Arc<Walls> {
    let (segments, heights) = segments(world);
    Arc::new(Walls::new(segments).with_heights(heights))
}

/// All static walls of a scene: the walls of its world, then the outlines of its fixed objects.
///
/// Each outline is as high as its collider. A circle becomes a circumscribed regular polygon of 64 sides, see
/// [`Shape::outline`].
pub fn obstacles(scene: &SceneSpec) -> Arc<Walls> {
    let (mut segments, mut heights) = segments(&scene.world);
    for object in scene.objects.iter().filter(|object| object.kind.is_fixed) {
        // An object without colliders still has one part, which is infinitely high.
        let tops = object.kind.colliders.iter().map(Collider::top).chain([f64::INFINITY]);
        for (corners, top) in properties(object).outlines(&object.pose).into_iter().zip(tops) {
            let next = corners.iter().cycle().skip(1);
            segments.extend(corners.iter().zip(next).map(|(a, b)| Segment::new(*a, *b)));
            heights.resize(segments.len(), top);
        }
    }
    Arc::new(Walls::new(segments).with_heights(heights))
}

/// Height field of a world's terrain, built from an image, random relief or steps. `None` for the plane z = 0 and for a
/// terrain from a mesh file.
///
/// It depends only on the text of the scene and its images. [`HeightField::height`] is the ground truth of the terrain.
pub fn height_field(world: &WorldSpec) -> Option<&Arc<HeightField>> {
    world.terrain.as_ref()?.field.as_ref()
}

/// Ground of the legged robots in a world: its [`height_field`], or the plane z = 0.
pub fn ground(world: &WorldSpec) -> Arc<Ground> {
    Arc::new(height_field(world).map_or(Ground::Flat, |field| Ground::Field(Arc::clone(field))))
}

/// Three-dimensional shapes of bodies, and upper faces of walls. Only three-dimensional rays use them, in addition to
/// the scene's [`obstacles`] and [`movable_objects`].
///
/// A robot is an upright cylinder of the robot's diameter, as high as its highest collider. Without colliders, the
/// cylinder is infinitely high.
pub fn space(scene: &SceneSpec) -> Space {
    let world = &scene.world;
    let mut surfaces = Vec::new();
    let mut thick_walls = Vec::new();
    for wall in &world.walls {
        let first = surfaces.len();
        let sides = if wall.thickness > 0.0 { 4 } else { 1 };
        surfaces.resize(first + sides, wall.surface.or(world.surface).unwrap_or_default());
        if wall.thickness > 0.0 {
            let centre_line = Segment { a: wall.from, b: wall.to };
            thick_walls.push(ThickWall::new(WallId(first as u32), &centre_line, wall.thickness, wall.height));
        }
    }
    let ground = world.surface.unwrap_or(default_ground_surface(world));
    let terrain = world.terrain.as_ref().and_then(|terrain| terrain.mesh.as_ref());
    let terrain_figure = |mesh: &Arc<Mesh>| Figure { solids: vec![Solid::Mesh(index(mesh))], surface: ground };
    let mut fixed: Vec<_> = terrain.map(|mesh| (Pose::default(), Arc::new(terrain_figure(mesh)))).into_iter().collect();
    let mut objects = Vec::new();
    // Objects or robots of the same type share a figure. The keys are addresses, so the maps must never be iterated.
    let (mut object_figures, mut robot_figures) = (BTreeMap::new(), BTreeMap::new());
    for object in &scene.objects {
        let figure = object_figures.entry(Arc::as_ptr(&object.kind)).or_insert_with(|| Arc::new(figure(&object.kind)));
        if object.kind.is_fixed {
            fixed.push((object.pose, Arc::clone(figure)));
        } else {
            objects.push(Arc::clone(figure));
        }
    }
    let mut robot = |robi: &Arc<RobiSpec>| {
        Arc::clone(robot_figures.entry(Arc::as_ptr(robi)).or_insert_with(|| Arc::new(robot_figure(robi))))
    };
    let robots = scene.robots.iter().map(|spec| robot(&spec.robi)).collect();
    Space {
        floor: terrain.is_none().then_some(ground),
        outlines: Some(WallId(surfaces.len() as u32)),
        walls: surfaces,
        thick_walls,
        fixed,
        robots,
        objects,
    }
}

/// Default surface of the ground. Floors, stairs and meshes are smooth, because a sonar near a rough floor would
/// receive only echoes of the floor. Hills are rough, because a smooth hill may have no facet that faces the sensor and
/// would return hardly any echo. Our choice.
fn default_ground_surface(world: &WorldSpec) -> Surface {
    match world.terrain.as_ref().map(|terrain| &terrain.shape) {
        Some(TerrainShape::Image(_) | TerrainShape::Random(_)) => Surface::ROUGH,
        Some(TerrainShape::Mesh { .. } | TerrainShape::Steps(_)) | None => Surface::SMOOTH,
    }
}

/// Three-dimensional shape of a robot type: see [`space`].
pub fn robot_figure(robi: &RobiSpec) -> Figure {
    let top = robi.colliders.iter().map(Collider::top).reduce(f64::max).unwrap_or(f64::INFINITY);
    Figure::cylinder(0.5 * robi.diameter, top, robi.surface)
}

/// Three-dimensional shape of an object type: its mesh if sensors detect the mesh, otherwise its colliders, or its
/// footprint if it has neither.
pub fn figure(kind: &ObjectType) -> Figure {
    let solids = match &kind.sensor_shape {
        spec::SensorShape::Mesh(Some(mesh)) => vec![Solid::Mesh(index(&raised(mesh, kind.lift)))],
        _ if kind.colliders.is_empty() => {
            let Part { shape: footprint, object_from_part: body_from_footprint } = default_footprint();
            vec![Solid::Prism { footprint, body_from_footprint, bottom: 0.0, top: f64::INFINITY }]
        }
        _ => kind.colliders.iter().map(|collider| solid(&collider.raised(kind.lift))).collect(),
    };
    Figure { solids, surface: kind.surface }
}

/// `mesh` raised by `lift` metres.
fn raised(mesh: &Arc<Mesh>, lift: f64) -> Arc<Mesh> {
    let mut mesh = Arc::clone(mesh);
    if lift > 0.0 {
        Arc::make_mut(&mut mesh).positions.iter_mut().for_each(|position| position.z += lift);
    }
    mesh
}

/// Ray index over the faces of a mesh.
fn index(mesh: &Mesh) -> Arc<MeshIndex> {
    let corners: Vec<_> = mesh.triangles.iter().map(|triangle| mesh.corners(triangle)).collect();
    Arc::new(MeshIndex::new(&corners))
}

/// The solid of a collider.
fn solid(collider: &Collider) -> Solid {
    let prism = |bottom, top| {
        let Part { shape: footprint, object_from_part: body_from_footprint } = footprint(collider);
        Solid::Prism { footprint, body_from_footprint, bottom, top }
    };
    match *collider {
        Collider::Box { centre, size } => prism(centre.z - 0.5 * size.z, centre.z + 0.5 * size.z),
        Collider::Cylinder { centre, height, .. } => prism(centre.z - 0.5 * height, centre.z + 0.5 * height),
        Collider::Sphere { centre, radius } => Solid::Capsule { ends: [centre; 2], radius },
        Collider::Capsule { centre, radius, height, axis } => {
            let axis = match axis {
                Axis::X => DVec3::X,
                Axis::Y => DVec3::Y,
                Axis::Z => DVec3::Z,
            };
            let half = axis * (0.5 * height - radius).max(0.0);
            Solid::Capsule { ends: [centre - half, centre + half], radius }
        }
    }
}

/// The movable objects of a scene, in the order of their ids 1, 2, ...
pub fn movable_objects(scene: &SceneSpec) -> impl Iterator<Item = &ObjectSpec> {
    scene.objects.iter().filter(|object| !object.kind.is_fixed)
}

/// The mass, the footprint and the friction of an object.
///
/// The footprint of a sphere, an upright capsule or an upright cylinder is a disc. The footprint of a lying capsule is
/// its silhouette. An object without colliders is a disc of 1 mm.
pub fn properties(object: &ObjectSpec) -> Arc<Properties> {
    let kind = &object.kind;
    let mut parts: Vec<Part> = kind.colliders.iter().map(footprint).collect();
    if parts.is_empty() {
        parts.push(default_footprint());
    }
    Arc::new(Properties {
        mass: kind.mass,
        centre_of_mass: kind.centre_of_mass.truncate(),
        parts,
        resistance: match kind.rolling {
            _ if kind.lift > 0.0 => Resistance::Rolling(WATER_RESISTANCE),
            Some(rolling) => Resistance::Rolling(rolling),
            None => Resistance::Sliding(object.friction),
        },
        restitution: kind.restitution,
        contact_friction: CONTACT_FRICTION,
        lift: kind.lift,
    })
}

/// The footprint of an object without a shape.
fn default_footprint() -> Part {
    Part { shape: Shape::Disc { radius: 1e-3 }, object_from_part: Pose::default() }
}

/// The footprint of a collider.
fn footprint(collider: &Collider) -> Part {
    let disc = |radius| (Shape::Disc { radius }, 0.0);
    let (centre, (shape, phi)) = match *collider {
        Collider::Box { centre, size } => (centre, (Shape::Rectangle { half: size.truncate() * 0.5 }, 0.0)),
        Collider::Sphere { centre, radius } | Collider::Cylinder { centre, radius, .. } => (centre, disc(radius)),
        Collider::Capsule { centre, radius, axis: Axis::Z, .. } => (centre, disc(radius)),
        Collider::Capsule { centre, radius, height, axis } => {
            let half_length = 0.5 * height - radius;
            let capsule = Shape::Capsule { half_length, radius };
            let phi = if axis == Axis::Y { FRAC_PI_2 } else { 0.0 };
            (centre, if half_length > 0.0 { (capsule, phi) } else { disc(radius) })
        }
    };
    Part { shape, object_from_part: Pose::new(centre.x, centre.y, phi) }
}

/// The links of a robot type, parents before children: the links of its legs, leg by leg, then the file's links. Their
/// joint indices refer to a list of the servos' angles followed by the legs' angles.
pub fn links(robi: &RobiSpec) -> Vec<Link> {
    let legs = legs(robi);
    let order = link_order(robi);
    let indices = link_indices(robi, &order);
    let servos = robi.all_servos();
    let link = |index: &usize| {
        let LinkSpec { mount, joint, .. } = &robi.links[*index];
        let axis = match joint.as_ref().map_or(Axis::Z, |joint| joint.axis) {
            Axis::X => DVec3::X,
            // A positive joint angle raises the link's x axis, as a positive pitch does.
            Axis::Y => DVec3::NEG_Y,
            Axis::Z => DVec3::Z,
        };
        let servo = joint.as_ref().and_then(|joint| servos.iter().position(|servo| servo.name == joint.servo.text));
        Link { parent: parent_link(mount.link.as_ref(), &indices), origin: pose(mount), axis, joint: servo }
    };
    let leg_links = legs.map_or_else(Vec::new, |legs| legs.links(0, servos.len()));
    leg_links.into_iter().chain(order.iter().map(link)).collect()
}

/// The range sensors of a robot type, PSDs first. Their link indices refer to [`links`].
pub fn range_sensors(robi: &RobiSpec) -> Vec<RangeSensor> {
    let indices = link_indices(robi, &link_order(robi));
    let psds = robi.psds.iter().map(|psd| RangeSensor {
        mount: Pose3::from_angles(psd.position, 0.0, psd.pitch, psd.angle),
        link: parent_link(psd.link.as_ref(), &indices),
        model: RangeModel::Psd { range: psd.range },
    });
    let others = robi.ranges.iter().map(|range| RangeSensor {
        mount: pose(&range.mount),
        link: parent_link(range.mount.link.as_ref(), &indices),
        model: range.model,
    });
    psds.chain(others).collect()
}

/// Pose of a laser scanner on its parent link, and the index of that link in [`links`]; `None` for the body.
pub fn scanner_mount(robi: &RobiSpec, lidar: &LidarSpec) -> (Pose3, Option<usize>) {
    let indices = link_indices(robi, &link_order(robi));
    (pose(&lidar.mount), parent_link(lidar.mount.link.as_ref(), &indices))
}

/// Pose of a mount relative to its parent.
fn pose(mount: &MountSpec) -> Pose3 {
    Pose3::from_angles(mount.position, mount.roll, mount.pitch, mount.yaw)
}

/// Index of the parent link of this name; `None` for the body.
fn parent_link(on: Option<&SpannedText>, indices: &BTreeMap<String, usize>) -> Option<usize> {
    on.and_then(|on| indices.get(on.text.as_str()).copied())
}

/// Indices in [`links`] by the links' names. If several links share a name, the first one counts.
fn link_indices(robi: &RobiSpec, order: &[usize]) -> BTreeMap<String, usize> {
    let mut indices = BTreeMap::new();
    let mut first = 0;
    for leg in legs(robi).iter().flat_map(|legs| &legs.legs) {
        indices.extend(leg.parts().map(|(part, offset)| (format!("{}.{part}", leg.name), first + offset)));
        first += leg.link_count();
    }
    for (offset, index) in order.iter().enumerate() {
        indices.entry(robi.links[*index].name.clone()).or_insert(first + offset);
    }
    indices
}

/// File indices of a robot type's links, sorted so that parents come before children.
fn link_order(robi: &RobiSpec) -> Vec<usize> {
    let mut names: BTreeMap<&str, usize> = BTreeMap::new();
    for (index, link) in robi.links.iter().enumerate() {
        names.entry(&link.name).or_insert(index);
    }
    let parent =
        |index: usize| robi.links[index].mount.link.as_ref().and_then(|link| names.get(link.text.as_str()).copied());
    let mut is_placed = vec![false; robi.links.len()];
    let mut order = Vec::with_capacity(robi.links.len());
    for index in 0..robi.links.len() {
        // Follows the parents up to the first ancestor that is already in `order`, then appends this chain, ancestors
        // first.
        let mut chain = Vec::new();
        let mut next = Some(index);
        while let Some(link) = next.filter(|link| !is_placed[*link]) {
            is_placed[link] = true;
            chain.push(link);
            next = parent(link);
        }
        order.extend(chain.into_iter().rev());
    }
    order
}

/// The walls of a world and their heights.
fn segments(world: &WorldSpec) -> (Vec<Segment>, Vec<f64>) {
    let mut segments = Vec::with_capacity(world.walls.len());
    let mut heights = Vec::with_capacity(world.walls.len());
    for wall in &world.walls {
        if wall.thickness > 0.0 {
            segments.extend(Segment { a: wall.from, b: wall.to }.thickened(wall.thickness));
        } else {
            segments.push(Segment { a: wall.from, b: wall.to });
        }
        heights.resize(segments.len(), wall.height);
    }
    (segments, heights)
}

/// The legs of a robot type; `None` if it has none.
pub fn legs(robi: &RobiSpec) -> Option<Arc<Legs>> {
    let LegsSpec { step_height, radius, gaits, legs } = robi.legs.as_ref().filter(|legs| !legs.legs.is_empty())?;
    let legs: Vec<Leg> = legs.iter().map(leg).collect();
    let default_gait =
        || GaitSpec { name: "walk".to_owned(), period: DEFAULT_PERIOD, duty: DEFAULT_DUTY, ..GaitSpec::default() };
    let default_gait = gaits.is_empty().then(default_gait);
    let gaits = gaits.iter().chain(&default_gait).map(|spec| gait(spec, legs.len())).collect();
    // Without colliders, the underside of the body is at the height of the hips.
    let hips = legs.iter().map(|leg| leg.hip.z).fold(f64::INFINITY, f64::min);
    let underside = robi.colliders.iter().map(Collider::bottom).reduce(f64::min).unwrap_or(hips);
    Some(Arc::new(Legs { legs, gaits, step_height: *step_height, radius: *radius, underside }))
}

/// A leg of a robot type.
pub fn leg(spec: &LegSpec) -> Leg {
    Leg {
        name: spec.name.text.clone(),
        hip: spec.hip,
        thigh: spec.thigh,
        shank: spec.shank,
        foot: spec.foot,
        wheel: spec.wheel.map(|diameter| 0.5 * diameter),
    }
}

fn gait(spec: &GaitSpec, legs: usize) -> Gait {
    let one_by_one = (0..legs).map(|leg| leg as f64 / legs as f64);
    let offsets = if spec.offsets.is_empty() { one_by_one.collect() } else { spec.offsets.clone() };
    Gait {
        name: spec.name.clone(),
        period: Time::from_seconds_ceil(spec.period),
        duty: spec.duty,
        offsets,
        is_natural: spec.has_natural_curve,
    }
}

/// Drive and body model of a robot type. For a legged robot, the maximum speed and turning speed are lowered to the
/// limits of its gaits.
pub fn model(robi: &RobiSpec) -> Model {
    let mut model = model_of_file(robi);
    if let Some(legs) = legs(robi).filter(|_| robi.drive.kind == DriveKind::Legged) {
        for gait in &legs.gaits {
            model.max_speed = model.max_speed.min(legs.max_speed(gait));
            model.max_turn = model.max_turn.min(legs.max_turn_rate(gait));
        }
    }
    model
}

/// The hull of a robot type in water of this depth in metres; `None` for a robot without a hull.
///
/// The height is that of the robot's highest collider, or the robot's diameter if it has no colliders.
pub fn hull(robi: &RobiSpec, water: f64) -> Option<Hull> {
    let HullSpec { thrust, drag } = robi.hull;
    (robi.drive.kind == DriveKind::Thrusters).then(|| Hull { thrust, drag, ceiling: water - hull_height(robi) })
}

/// Height of a hull over the origin of its robot's frame, in metres.
pub fn hull_height(robi: &RobiSpec) -> f64 {
    robi.colliders.iter().map(Collider::top).reduce(f64::max).unwrap_or(robi.diameter)
}

/// Contact rule of a robot at walls. The coefficient of friction is the minimum of the robot's and the walls'
/// coefficients, as it is between objects. A hull always slides, since it may rise or sink while it touches a wall.
pub fn contact_rule(kind: ContactKind, wall_friction: f64, robi: &RobiSpec) -> ContactRule {
    match kind {
        ContactKind::Stall if robi.drive.kind != DriveKind::Thrusters => ContactRule::Stall,
        ContactKind::Slide | ContactKind::Stall => ContactRule::Slide { friction: robi.friction.min(wall_friction) },
    }
}

fn model_of_file(robi: &RobiSpec) -> Model {
    Model {
        kind: robi.drive.kind,
        wheel_diameter: robi.wheel.diameter,
        max_wheel_rate: robi.wheel.max_rate,
        ticks_per_turn: robi.wheel.ticks_per_turn,
        track: robi.wheel.track,
        wheelbase: robi.drive.wheelbase,
        axis_offset: robi.axis_offset,
        max_speed: robi.max_speed,
        max_turn: robi.max_turn,
        body_radius: robi.diameter / 2.0,
        wheel_lag: robi.drive.wheel_lag,
        max_steering: robi.drive.max_steer,
        mass: robi.mass,
        traction: robi.traction,
    }
}
