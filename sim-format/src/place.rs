//! Placement: creates robots and objects, with their types and poses, from the lines of a sim file.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::code::Code;
use super::diagnostic::Sink;
use super::load::Loader;
use super::print::number;
use super::scene::{FreeSpace, is_reachable};
use super::spec::{
    Collider, Dialect, Drawn, Layout, ModelSpec, ObjectLine, ObjectSpec, ObjectType, PositionRef, RobiSpec, RobotLine,
    RobotSpec, Scatter, SceneFormat, SimSpec, SpannedText, StartRef, TypeRef, WallSpec, WorldSpec,
};
use super::types::{LoadedType, Types};
use super::{Severity, Span, builtin, path};
use sim_core::RobotId;
use sim_core::noise::{Purpose, Stream, name_key};
use sim_core::pose::Pose;

/// Entities of a scene.
pub(super) struct PlacedEntities {
    /// Robots in the order of their ids.
    pub(super) robots: Vec<RobotSpec>,
    /// Objects, the world's objects first.
    pub(super) objects: Vec<ObjectSpec>,
    /// Number of objects that come from the world.
    pub(super) world_object_count: usize,
    /// Walls of the world, with the positions that were drawn.
    pub(super) walls: Vec<WallSpec>,
    /// Poses that were drawn.
    pub(super) drawn: Vec<Drawn>,
    /// True if a random placement failed or a required route is missing, which is reported; another attempt may
    /// succeed.
    pub(super) may_retry: bool,
}

/// Places all entities of `sim`, whose file is in `folder`, and of its world. `world` is `None` if the world is
/// missing, which is already reported. Random positions depend on the number of the `attempt`.
pub(super) fn place(
    loader: &mut Loader<'_>,
    sim: &SimSpec,
    folder: &str,
    world: Option<&WorldSpec>,
    attempt: u32,
) -> PlacedEntities {
    let types = Types::load(loader, sim, folder);
    let mut placer = Placer {
        sink: Sink::new(&sim.file),
        sim,
        folder,
        types,
        starts: Starts::new(world),
        mesh_types: BTreeMap::new(),
        robots: Vec::new(),
        objects: Vec::new(),
        has_robots: false,
        scattered: Vec::new(),
        paths: BTreeMap::new(),
        drawn: Vec::new(),
        attempt,
        may_retry: false,
    };
    placer.place_objects(world.map_or(&[], |world| &world.objects), loader);
    let world_object_count = placer.objects.len();
    placer.place_objects(&sim.objects, loader);
    placer.place_robots(loader);
    let walls = placer.draw_positions(world);
    placer.check_routes(world, &walls);
    let (drawn, may_retry) = (std::mem::take(&mut placer.drawn), placer.may_retry);
    placer.objects[world_object_count..].sort_by_key(|object| object.span);
    if let Some(depth) = world.and_then(|world| world.water) {
        float_objects(&mut placer.objects, depth);
    }
    loader.diagnostics.extend(placer.sink.finish());
    if !placer.has_robots && !super::has_errors(&loader.diagnostics) {
        let mut sink = Sink::new(&sim.file);
        let expected = match sim.format {
            SceneFormat::Sim => "a line `NAME X Y PHI PROGRAM` or `robi FILE.robi PROGRAM`",
            SceneFormat::Toml => "a section `[[robot]]`",
        };
        let diagnostic = sink.warn(Code::SimRobotMissing, Span::default(), "the scene has no robot", expected);
        let is_sim = sim.format == SceneFormat::Sim;
        diagnostic.suggestion = is_sim.then(|| "write a line such as `S4 500 500 0 program.c`".to_owned());
        loader.diagnostics.extend(sink.finish());
    }
    PlacedEntities { robots: placer.robots, objects: placer.objects, world_object_count, walls, drawn, may_retry }
}

/// Raises the objects that float in water of this depth, in metres; objects that share a type still share one
/// afterwards.
fn float_objects(objects: &mut [ObjectSpec], depth: f64) {
    // The keys are addresses, so the map must never be iterated; its values keep the types alive.
    let mut types = BTreeMap::new();
    for object in objects {
        let kind = Arc::clone(&object.kind);
        let raised_kind = || kind.afloat(depth).map(Arc::new);
        let (_, raised) = types.entry(Arc::as_ptr(&kind).addr()).or_insert_with(|| (Arc::clone(&kind), raised_kind()));
        if let Some(raised) = raised {
            object.kind = Arc::clone(raised);
        }
    }
}

struct Placer<'a> {
    sink: Sink,
    sim: &'a SimSpec,
    folder: &'a str,
    types: Types,
    starts: Starts<'a>,
    /// Types of objects that only a mesh describes, by the mesh's file.
    mesh_types: BTreeMap<String, Arc<ObjectType>>,
    robots: Vec<RobotSpec>,
    objects: Vec<ObjectSpec>,
    /// True if the scene has lines of robots, even if none of them is usable.
    has_robots: bool,
    /// Robots and objects with random positions, in the order in which they are placed.
    scattered: Vec<(Entity, Scatter)>,
    /// Paths of robots and objects in the scene, such as `robot.1`.
    paths: BTreeMap<Entity, String>,
    drawn: Vec<Drawn>,
    attempt: u32,
    may_retry: bool,
}

/// A robot or object by its index, before objects are sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Entity {
    Robot(usize),
    Object(usize),
}

/// Robots of one line.
struct Group<'a> {
    line: &'a RobotLine,
    /// Type of the robots; `None` if it is missing, which is already reported.
    robi: Option<Arc<RobiSpec>>,
    count: u32,
    /// Layout of the group; `None` for a single robot.
    layout: Option<Layout>,
    /// True if there is no room for the remaining robots of the group, which is already reported.
    is_full: bool,
}

/// A robot of a group.
struct Member {
    id: RobotId,
    /// Index of the group.
    group: usize,
    /// Index within the group.
    index: u32,
}

/// An end of a route, in metres.
struct RouteEnd {
    position: DVec2,
    /// Radius of the entity; 0 for a point.
    radius: f64,
    entity: Option<Entity>,
}

/// Generator of ids for robots without a stated one.
struct Ids {
    last: u32,
    stated_ids: BTreeSet<RobotId>,
}

impl Ids {
    fn excluding(stated_ids: impl Iterator<Item = RobotId>) -> Self {
        Self { last: 0, stated_ids: stated_ids.collect() }
    }

    fn next(&mut self) -> RobotId {
        self.last += 1;
        while self.stated_ids.contains(&RobotId(self.last)) {
            self.last += 1;
        }
        RobotId(self.last)
    }
}

impl Placer<'_> {
    fn place_objects(&mut self, lines: &[ObjectLine], loader: &mut Loader<'_>) {
        for line in lines {
            let kind = match &line.kind {
                TypeRef::File(path) => self.object_type_of_file(loader, path),
                TypeRef::Name(name) => self.object_type_of_name(loader, name),
            };
            if let Some(kind) = kind {
                let friction = line.friction.unwrap_or(kind.friction);
                let entity = Entity::Object(self.objects.len());
                self.scattered.extend(line.scatter.map(|scatter| (entity, scatter)));
                if !line.path.is_empty() {
                    self.paths.insert(entity, line.path.clone());
                }
                self.objects.push(ObjectSpec {
                    kind,
                    pose: line.pose,
                    friction,
                    line: line.path.clone(),
                    span: line.span,
                });
            }
        }
    }

    /// Finds the object type with this name; reports an unknown name and the name of a robot type.
    fn object_type_of_name(&mut self, loader: &mut Loader<'_>, name: &SpannedText) -> Option<Arc<ObjectType>> {
        match self.types.find(&mut self.sink, name) {
            Some(LoadedType::Object(object)) => Some(object),
            Some(LoadedType::Robot(_)) => {
                let message = format!("`{}` is a robot, not an object", name.text);
                self.sink.error(Code::SimTypeUnknown, name.span, message, "the name of an object type");
                None
            }
            None => {
                self.types.report_unknown(loader, &mut self.sink, Severity::Error, self.folder, name);
                None
            }
        }
    }

    /// Type of a classic `object` line: that of an object file. A mesh gets the shape of the built-in type of the same
    /// name, otherwise that of a cylinder.
    fn object_type_of_file(&mut self, loader: &mut Loader<'_>, path: &SpannedText) -> Option<Arc<ObjectType>> {
        if path::extension(&path.text) == "esobj" {
            return loader.object_type(&self.sim.file, self.folder, path);
        }
        if let Some(object) = self.mesh_types.get(&path.text) {
            return Some(Arc::clone(object));
        }
        let name = path::stem(&path.text);
        let object = builtin::object(if name.eq_ignore_ascii_case("ball") { "Soccer" } else { name });
        if object.is_none() {
            let message = format!("the shape of `{}` is not known: an upright cylinder of 100 mm is used", path.text);
            let expected = "a mesh named can, ball, soccer, crate or golf, or an .esObj file with a collider";
            self.sink.warn(Code::SimObjectShape, path.span, message, expected);
        }
        let model = ModelSpec { path: path.clone(), offset: DVec3::ZERO, rotations: DVec3::ZERO };
        let defaults = object.map_or_else(|| ObjectType::with_defaults(&path.text), Arc::unwrap_or_clone);
        let file = self.sim.file.clone();
        let kind = Arc::new(ObjectType { file, name: name.to_owned(), model: Some(model), ..defaults });
        self.mesh_types.insert(path.text.clone(), Arc::clone(&kind));
        Some(kind)
    }

    /// Places the robots of all lines, and the objects of lines that name a loaded object type.
    fn place_robots(&mut self, loader: &mut Loader<'_>) {
        let mut lines: Vec<&RobotLine> = self.sim.robots.iter().chain(&self.sim.named).collect();
        lines.sort_by_key(|line| line.span);
        let mut ids = Ids::excluding(lines.iter().filter_map(|line| line.id));
        let mut groups = Vec::new();
        let mut members = Vec::new();
        for line in lines {
            let Some(robi) = self.robot_type(loader, line) else { continue };
            let (count, layout) = match line.start {
                StartRef::Many { count, layout } => (count, Some(layout)),
                _ => (1, None),
            };
            for index in 0..count {
                let id = line.id.unwrap_or_else(|| ids.next());
                members.push(Member { id, group: groups.len(), index });
            }
            groups.push(Group { line, robi, count, layout, is_full: false });
        }
        // Placement proceeds in the order of robot numbers, not of lines.
        members.sort_by_key(|member| member.id);
        for member in &members {
            self.place_robot(&mut groups[member.group], member);
        }
        self.has_robots = !members.is_empty();
    }

    /// Type of the robot of a line: `Some(None)` if the type is missing, which is already reported; `None` if the line
    /// places no robot.
    fn robot_type(&mut self, loader: &mut Loader<'_>, line: &RobotLine) -> Option<Option<Arc<RobiSpec>>> {
        let name = match &line.kind {
            TypeRef::File(path) => return Some(loader.robot_type(&self.sim.file, self.folder, path)),
            TypeRef::Name(name) => name,
        };
        match self.types.find(&mut self.sink, name) {
            Some(LoadedType::Robot(robi)) => Some(Some(robi)),
            Some(LoadedType::Object(object)) => {
                if self.sim.format == SceneFormat::Toml {
                    let message = format!("`{}` is an object, not a robot", name.text);
                    self.sink.error(Code::SimTypeUnknown, name.span, message, "the name of a robot type");
                } else {
                    self.place_named_object(line, object);
                }
                None
            }
            None => {
                // A line without a program may mean an object, which EyeSim skips, so it gives only a warning.
                let is_robot = self.sim.format == SceneFormat::Toml
                    || line.program.is_some()
                    || !matches!(line.start, StartRef::Pose(_));
                let severity = if is_robot { Severity::Error } else { Severity::Warning };
                self.types.report_unknown(loader, &mut self.sink, severity, self.folder, name);
                is_robot.then_some(None)
            }
        }
    }

    /// Places a robot as its line states, if there is room.
    fn place_robot(&mut self, group: &mut Group<'_>, member: &Member) {
        if group.is_full {
            return;
        }
        let line = group.line;
        let start = match group.layout {
            None => self.start_pose(line),
            Some(Layout::Starts) => self.next_start(line.span),
            // Provisional: `draw_positions` finds a free pose when all other bodies are placed.
            Some(Layout::Random(_)) => Some(Pose::default()),
            Some(layout) => layout.pose(member.index, group.count),
        };
        group.is_full = start.is_none();
        let (Some(robi), Some(start)) = (&group.robi, start) else { return };
        let entity = Entity::Robot(self.robots.len());
        if let Some(Layout::Random(scatter)) = group.layout {
            self.scattered.push((entity, scatter));
        }
        let path = match group.layout {
            Some(_) if group.count > 1 && !line.path.is_empty() => format!("{}.{}", line.path, member.index + 1),
            _ => line.path.clone(),
        };
        if !path.is_empty() {
            self.paths.insert(entity, path.clone());
        }
        let dialect = match (self.sim.format, &line.kind) {
            (SceneFormat::Toml, _) => self.sim.run.dialect.map(Dialect::generation),
            (SceneFormat::Sim, TypeRef::File(_)) => Some(6),
            (SceneFormat::Sim, TypeRef::Name(_)) => Some(7),
        };
        self.robots.push(RobotSpec {
            id: member.id,
            robi: Arc::clone(robi),
            start,
            program: line.program.clone(),
            arguments: line.arguments.clone(),
            api: line.api.or(self.sim.run.api),
            noise: line.noise.as_ref().or(self.sim.run.noise.as_ref()).cloned(),
            dialect,
            line: path,
            span: line.span,
        });
    }

    /// Draws random positions for walls, then for robots, then for objects. No random body overlaps a body that was
    /// placed earlier or has a stated position. Returns the walls.
    fn draw_positions(&mut self, world: Option<&WorldSpec>) -> Vec<WallSpec> {
        let Some(world) = world else { return Vec::new() };
        let mut walls = world.walls.clone();
        let is_random = |wall: &WallSpec| wall.scatter.is_some();
        if self.scattered.is_empty() && !walls.iter().any(is_random) {
            return walls;
        }
        let entities = (0..self.robots.len()).map(Entity::Robot).chain((0..self.objects.len()).map(Entity::Object));
        let entities: Vec<Entity> = entities.collect();
        let max_radius = entities.iter().map(|entity| self.bounding_radius(*entity)).fold(0.0, f64::max);
        let clearance = self.scattered.iter().map(|(_, scatter)| scatter.clearance).fold(0.0, f64::max);
        let random_entities: BTreeSet<Entity> = self.scattered.iter().map(|(entity, _)| *entity).collect();
        let fixed_bodies: Vec<(DVec2, f64)> = entities
            .iter()
            .filter(|entity| !random_entities.contains(entity))
            .map(|entity| (self.pose(*entity).position, self.bounding_radius(*entity)))
            .collect();
        let free_space = |walls: &[WallSpec]| {
            let placed_walls = walls.iter().filter(|wall| !is_random(wall));
            let mut free_space = FreeSpace::new(placed_walls, world.floor, max_radius + clearance);
            fixed_bodies.iter().for_each(|(centre, bounding_radius)| free_space.take(*centre, *bounding_radius));
            free_space
        };
        self.draw_wall_positions(&free_space(&walls), &mut walls);
        let mut free_space = free_space(&walls);
        let (mut full_line, mut placed) = (None, BTreeSet::new());
        self.scattered.sort_by_key(|(entity, _)| *entity);
        for (entity, scatter) in self.scattered.clone() {
            let span = self.span(entity);
            if full_line == Some(span) {
                continue;
            }
            let path = self.paths.get(&entity).cloned().unwrap_or_default();
            let (mut random_stream, bounding_radius) = (self.random_stream(&path), self.bounding_radius(entity));
            let Some(pose) = free_space.place(&mut random_stream, bounding_radius, &scatter) else {
                let (count, total) = self.line_counts(entity);
                let noun = if matches!(entity, Entity::Robot(_)) { "robots" } else { "objects" };
                self.report_no_room(span, &format!("there is room for {count} of {total} {noun}"), noun);
                full_line = Some(span);
                continue;
            };
            self.record_pose(&path, &pose);
            match entity {
                Entity::Robot(index) => self.robots[index].start = pose,
                Entity::Object(index) => self.objects[index].pose = pose,
            }
            placed.insert(entity);
        }
        self.drop_unplaced(&random_entities, &placed);
        walls
    }

    /// Drops the random bodies for which there was no room.
    fn drop_unplaced(&mut self, random: &BTreeSet<Entity>, placed: &BTreeSet<Entity>) {
        let is_lost = |entity: Entity| random.contains(&entity) && !placed.contains(&entity);
        let mut index = 0..;
        self.robots.retain(|_| !is_lost(Entity::Robot(index.next().unwrap_or_default())));
        let mut index = 0..;
        self.objects.retain(|_| !is_lost(Entity::Object(index.next().unwrap_or_default())));
    }

    /// Draws random positions for the walls without a stated position; a wall without room stays unplaced.
    fn draw_wall_positions(&mut self, space: &FreeSpace, walls: &mut [WallSpec]) {
        let mut added: Vec<WallSpec> = Vec::new();
        let mut full_line = None;
        for (index, wall) in walls.iter_mut().enumerate() {
            let Some((length, scatter)) = wall.scatter.filter(|_| full_line != Some(wall.span)) else { continue };
            let path = self.sim.wall_paths.get(index).cloned().unwrap_or_default();
            let mut random_stream = self.random_stream(&path);
            let Some(segment) = space.place_wall(&mut random_stream, (length, wall.thickness), &scatter, &added) else {
                let count = added.iter().filter(|other| other.span == wall.span).count();
                self.report_no_room(wall.span, &format!("there is room for {count} of these walls"), "walls");
                full_line = Some(wall.span);
                continue;
            };
            (wall.from, wall.to, wall.scatter) = (segment.a, segment.b, None);
            for (key, end) in [("from_mm", wall.from), ("to_mm", wall.to)] {
                let value = vec![number::mm(end.x), number::mm(end.y)].into();
                self.drawn.push(Drawn { path: format!("{path}.{key}"), value });
            }
            added.push(*wall);
        }
    }

    fn report_no_room(&mut self, span: Span, message: &str, noun: &str) {
        self.sink.error(Code::SceneRoom, span, message, format!("fewer {noun}, a larger area or less clearance"));
        self.may_retry = true;
    }

    fn random_stream(&self, path: &str) -> Stream {
        let seed = self.sim.run.seed.unwrap_or_default();
        Stream::new(seed, RobotId(0), Purpose::Layout, self.attempt, name_key(path))
    }

    fn record_pose(&mut self, path: &str, pose: &Pose) {
        let values = [
            ("x_mm", number::mm(pose.position.x)),
            ("y_mm", number::mm(pose.position.y)),
            ("heading_deg", number::heading(pose.heading)),
        ];
        let draws = values.map(|(key, value)| Drawn { path: format!("{path}.{key}"), value: value.into() });
        self.drawn.extend(draws);
    }

    fn pose(&self, entity: Entity) -> Pose {
        match entity {
            Entity::Robot(index) => self.robots[index].start,
            Entity::Object(index) => self.objects[index].pose,
        }
    }

    fn span(&self, entity: Entity) -> Span {
        match entity {
            Entity::Robot(index) => self.robots[index].span,
            Entity::Object(index) => self.objects[index].span,
        }
    }

    /// Radius of the disc around the pose that contains the body.
    fn bounding_radius(&self, entity: Entity) -> f64 {
        match entity {
            Entity::Robot(index) => 0.5 * self.robots[index].robi.diameter,
            Entity::Object(index) => self.objects[index].kind.colliders.iter().map(Collider::reach).fold(0.0, f64::max),
        }
    }

    /// Number of bodies of the line of `entity` that come before it, and of all bodies of this line.
    fn line_counts(&self, entity: Entity) -> (usize, usize) {
        let span = self.span(entity);
        let of_line = || self.scattered.iter().filter(|(other, _)| self.span(*other) == span);
        (of_line().filter(|(other, _)| *other < entity).count(), of_line().count())
    }

    /// Checks that the required routes between positions exist.
    fn check_routes(&mut self, world: Option<&WorldSpec>, walls: &[WallSpec]) {
        let Some(world) = world.filter(|_| !self.may_retry) else { return };
        for requirement in &self.sim.reachable {
            let Some((from, to)) = self.route_end(&requirement.from).zip(self.route_end(&requirement.to)) else {
                continue;
            };
            let is_robot = matches!(from.entity, Some(Entity::Robot(_)));
            let Some(width) = requirement.width.or(is_robot.then_some(2.0 * from.radius)) else {
                let message = "the width of the route is not known, since it does not begin at a robot";
                self.sink.error(Code::TomlMissing, requirement.span, message, "a line `width_mm = ...`");
                continue;
            };
            let ends = [from.entity, to.entity];
            let obstacles = (0..self.objects.len()).map(Entity::Object).filter(|entity| !ends.contains(&Some(*entity)));
            let obstacles: Vec<(DVec2, f64)> =
                obstacles.map(|entity| (self.pose(entity).position, self.bounding_radius(entity))).collect();
            let radius = 0.5 * width;
            let max_radius = obstacles.iter().map(|(_, bounding_radius)| *bounding_radius).fold(1.1 * radius, f64::max);
            let mut space = FreeSpace::new(walls.iter(), world.floor, max_radius);
            obstacles.iter().for_each(|(centre, bounding_radius)| space.take(*centre, *bounding_radius));
            let tolerance = if to.entity.is_some() { radius + to.radius } else { 0.0 };
            if !is_reachable(&space, world.floor, radius, (from.position, 0.0), (to.position, tolerance)) {
                let message = format!(
                    "no route {} mm wide leads from {} to {}",
                    number::mm(width),
                    position_text(&requirement.from),
                    position_text(&requirement.to)
                );
                let expected = "fewer or smaller obstacles, a narrower route, or less clearance";
                self.sink.error(Code::SceneReach, requirement.span, message, expected);
                self.may_retry = true;
            }
        }
    }

    /// The end of a route that a requirement names by a point or an entity.
    fn route_end(&mut self, position: &PositionRef) -> Option<RouteEnd> {
        let path = match position {
            PositionRef::Point(point) => return Some(RouteEnd { position: *point, radius: 0.0, entity: None }),
            PositionRef::Start(path) => path,
        };
        if let Some((entity, _)) = self.paths.iter().find(|(_, known)| **known == path.text) {
            let (position, radius) = (self.pose(*entity).position, self.bounding_radius(*entity));
            return Some(RouteEnd { position, radius, entity: Some(*entity) });
        }
        let message = format!("there is no robot or object `{}`", path.text);
        let close = super::line::nearest(&path.text, self.paths.values().map(String::as_str));
        let close = close.map(|path| format!("write `{path}`"));
        let expected = "the path of one, as `robot.1` or `object.1`: by its name, else by its number in the file";
        self.sink.error(Code::SceneReach, path.span, message, expected).suggestion = close;
        None
    }

    /// Places an object of a loaded type.
    fn place_named_object(&mut self, line: &RobotLine, kind: Arc<ObjectType>) {
        let syntax = "`NAME X Y PHI` in mm and degrees";
        if let Some(program) = &line.program {
            let message = format!("`{}` is left over: an object has no program", program.text);
            self.sink.warn(Code::WordExtra, program.span, message, syntax);
        }
        let StartRef::Pose(pose) = line.start else {
            let message = format!("`{}` is an object; only robots start at a letter", line.kind.written().text);
            self.sink.error(Code::SimPlaceArity, line.span, message, syntax);
            return;
        };
        let friction = kind.friction;
        self.objects.push(ObjectSpec { kind, pose, friction, line: String::new(), span: line.span });
    }

    fn start_pose(&mut self, line: &RobotLine) -> Option<Pose> {
        match line.start {
            StartRef::Pose(pose) => Some(pose),
            StartRef::Next | StartRef::Many { .. } => self.next_start(line.span),
            StartRef::Letter { letter, heading } => {
                let start = match self.sim.run.dialect {
                    Some(Dialect::Vr2018) => {
                        self.starts.take_start_of_2018().or_else(|| self.start_at_letter(letter, line.span))?
                    }
                    _ => self.start_at_letter(letter, line.span)?,
                };
                let position = start.position;
                Some(heading.map_or(start, |heading| Pose::new(position.x, position.y, heading)))
            }
        }
    }

    fn next_start(&mut self, span: Span) -> Option<Pose> {
        let start = self.starts.take_next();
        // If the world is missing, which is already reported, the missing start is no further mistake.
        if let (None, Some(world)) = (start, self.starts.world) {
            let message = format!("no start is left for this robot: the world has {}", world.starts.len());
            let expected = match self.sim.format {
                SceneFormat::Sim => {
                    "`X Y PHI` on this line, `position X Y PHI` in the world or a start letter in the maze"
                }
                SceneFormat::Toml => "`x_mm` and `y_mm`, a `layout`, or a start in the world",
            };
            self.sink.error(Code::SimStartMissing, span, message, expected);
        }
        start
    }

    fn start_at_letter(&mut self, letter: char, span: Span) -> Option<Pose> {
        let world = self.starts.world?;
        if let Some(start) = self.starts.take_start_of_letter(letter) {
            return Some(start);
        }
        let letters: BTreeSet<char> = world.starts.iter().filter_map(|start| start.letter).collect();
        let available_letters = if letters.is_empty() {
            "it has no start letters".to_owned()
        } else {
            let letters: Vec<String> = letters.iter().map(|letter| format!("`{letter}`")).collect();
            format!("it has {}", letters.join(", "))
        };
        let expected = "a letter of the maze, or `X Y PHI`";
        // In the first EyeSim VR, `s` meant the start of the maze, regardless of its letter.
        if letter == 'S' && !letters.is_empty() {
            let message = format!("the world has no start `S`: {available_letters}; the next free one is used");
            self.sink.warn(Code::SimStartLetter, span, message, expected);
            return self.next_start(span);
        }
        let message = format!("the world has no start `{letter}`: {available_letters}");
        self.sink.error(Code::SimStartLetter, span, message, expected);
        None
    }
}

/// The starts of a world; records which of them robots have taken.
struct Starts<'a> {
    world: Option<&'a WorldSpec>,
    is_taken: Vec<bool>,
}

impl<'a> Starts<'a> {
    fn new(world: Option<&'a WorldSpec>) -> Self {
        Self { world, is_taken: vec![false; world.map_or(0, |world| world.starts.len())] }
    }

    /// Takes the first free start.
    fn take_next(&mut self) -> Option<Pose> {
        let index = self.is_taken.iter().position(|is_taken| !is_taken)?;
        self.is_taken[index] = true;
        Some(self.world?.starts[index].pose)
    }

    /// Takes the start of a maze in EyeSim VR of 2018: the cell of the last letter, for any letter. The robot faces
    /// along x.
    fn take_start_of_2018(&mut self) -> Option<Pose> {
        let starts = &self.world?.starts;
        let index = (0..starts.len()).rfind(|index| starts[*index].letter.is_some())?;
        self.is_taken[index] = true;
        let position = starts[index].pose.position;
        Some(Pose::new(position.x, position.y, 0.0))
    }

    /// Takes the first free start with this letter; if all are taken, returns the first, so that two robots share a
    /// cell.
    fn take_start_of_letter(&mut self, letter: char) -> Option<Pose> {
        let starts = &self.world?.starts;
        let mut indices = (0..starts.len()).filter(|index| starts[*index].letter == Some(letter));
        let first = indices.clone().next()?;
        let index = indices.find(|index| !self.is_taken[*index]).unwrap_or(first);
        self.is_taken[index] = true;
        Some(starts[index].pose)
    }
}

/// Text of a position in messages.
fn position_text(position: &PositionRef) -> String {
    match position {
        PositionRef::Start(path) => format!("`{}`", path.text),
        PositionRef::Point(point) => format!("({}, {}) mm", number::mm(point.x), number::mm(point.y)),
    }
}
