//! Roster: all robots and objects of a simulation, including removed ones, and the types of robots and objects that can
//! be added.

use std::sync::Arc;

use super::Refusal;
use super::intervention::checked_pose;
use crate::build::{self, SpawnedEntity};
use crate::pose::Pose;
use crate::spec::{NoiseRef, ObjectSpec, ObjectType, RobiSpec, RobotSpec, SceneSpec};
use crate::world::World;
use crate::{ObjectId, RobotId};

/// Maximum number of robots that can be added after the start of a simulation. Removed robots are included, because
/// each keeps its id and its record. Our choice.
pub const MAX_ROBOTS: usize = 1_000;

/// Maximum number of movable objects that can be added after the start of a simulation, including removed ones. Our
/// choice.
pub const MAX_OBJECTS: usize = 10_000;

/// All robots and movable objects of a simulation, including removed ones, in the order of their ids, with their
/// initial poses. Also contains the named types of robots and objects that can be added.
#[derive(Clone, Debug)]
pub struct Roster {
    /// Types of robots.
    pub robot_types: Types<RobiSpec>,
    /// Types of movable objects.
    pub object_types: Types<ObjectType>,
    robots: Vec<RobotSpec>,
    objects: Vec<ObjectSpec>,
    /// Number of robots and number of objects at the start.
    initial_counts: [usize; 2],
    /// Default noise profile of robots.
    noise: Option<NoiseRef>,
}

/// Types by name, without duplicates.
#[derive(Clone, Debug)]
pub struct Types<T> {
    /// Word for messages: `robots` or `movable objects`.
    what: &'static str,
    types: Vec<(String, Arc<T>)>,
    /// Name and file of each type.
    known_types: Vec<[String; 2]>,
}

impl Roster {
    /// Roster of `scene`, with the types of its robots and objects.
    pub fn of(scene: &SceneSpec) -> Self {
        let mut robot_types = Types::of("robots");
        for robi in scene.robots.iter().map(|robot| &robot.robi) {
            robot_types.add(&robi.name, &robi.file, || Arc::clone(robi));
        }
        let mut object_types = Types::of("movable objects");
        for kind in build::movable_objects(scene).map(|object| &object.kind) {
            object_types.add(&kind.name, &kind.file, || Arc::clone(kind));
        }
        let objects: Vec<ObjectSpec> = build::movable_objects(scene).cloned().collect();
        let (robots, noise) = (scene.robots.clone(), scene.run.noise.clone());
        Self { robot_types, object_types, initial_counts: [robots.len(), objects.len()], robots, objects, noise }
    }

    /// All robots, in the order of their ids.
    pub fn robots(&self) -> &[RobotSpec] {
        &self.robots
    }

    /// All movable objects, in the order of their ids.
    pub fn objects(&self) -> &[ObjectSpec] {
        &self.objects
    }

    /// The robots and objects that were added after the start.
    pub(super) fn added(&self) -> impl Iterator<Item = SpawnedEntity> {
        let [robots, objects] = self.initial_counts;
        let robots = self.robots[robots..].iter().map(|spec| SpawnedEntity::Robot(spec.id, Arc::clone(&spec.robi)));
        let objects = (objects..).map(ObjectId::from_index).zip(&self.objects[objects..]);
        robots.chain(objects.map(|(id, spec)| SpawnedEntity::Object(id, Arc::clone(&spec.kind))))
    }

    /// Spec of a new robot of the type `kind` at `start`: x and y in m, heading in rad. It runs the program of the
    /// robot with the number `program_of`. Its noise profile is that of the robot `program_of`; without such a robot,
    /// that of the first robot of its type; without such a robot either, that of the scene.
    ///
    /// # Errors
    /// [`Refusal`] if a name or number is unknown, the position is occupied, or the limit is reached.
    pub fn robot(
        &self,
        kind: &str,
        program_of: Option<u32>,
        start: [f64; 3],
        world: &World,
    ) -> Result<RobotSpec, Refusal> {
        let start = checked_pose(start)?;
        // The robot may have been removed: its spec is still in the roster.
        let find = |number: u32| self.robots.get((number as usize).wrapping_sub(1)).ok_or(Refusal::NoRobot(number));
        let model = program_of.map(find).transpose()?;
        let robi = self.robot_types.find(kind)?;
        if let Some(thing) = world.overlapped_by_disc(start.position, 0.5 * robi.diameter) {
            return Err(Refusal::Occupied(thing));
        }
        check_limit(self.robots.len() - self.initial_counts[0], MAX_ROBOTS, "robots")?;
        let of_type = || self.robots.iter().find(|robot| Arc::ptr_eq(&robot.robi, &robi));
        let noise = model.or_else(of_type).map_or(&self.noise, |robot| &robot.noise).clone();
        Ok(RobotSpec {
            id: RobotId::from_index(self.robots.len()),
            start,
            program: model.and_then(|robot| robot.program.clone()),
            arguments: model.map(|robot| robot.arguments.clone()).unwrap_or_default(),
            api: model.and_then(|robot| robot.api),
            noise,
            dialect: model.and_then(|robot| robot.dialect),
            line: String::new(),
            span: Default::default(),
            robi,
        })
    }

    /// Spec of a new movable object of the type called `kind` at `pose`.
    ///
    /// # Errors
    /// [`Refusal`] if the type is unknown, or the limit is reached.
    pub fn object(&self, kind: &str, pose: Pose) -> Result<ObjectSpec, Refusal> {
        let kind = self.object_types.find(kind)?;
        check_limit(self.objects.len() - self.initial_counts[1], MAX_OBJECTS, "movable objects")?;
        Ok(ObjectSpec { friction: kind.friction, kind, pose, line: String::new(), span: Default::default() })
    }

    /// Adds the spec of a robot that was added to the simulation.
    pub fn keep_robot(&mut self, spec: RobotSpec) {
        self.robots.push(spec);
    }

    /// Adds the spec of a movable object that was added to the simulation.
    pub fn keep_object(&mut self, spec: ObjectSpec) {
        self.objects.push(spec);
    }
}

fn check_limit(added: usize, max_count: usize, what: &'static str) -> Result<(), Refusal> {
    if added < max_count { Ok(()) } else { Err(Refusal::Full { most: max_count, what }) }
}

impl<T> Types<T> {
    fn of(what: &'static str) -> Self {
        Self { what, types: Vec::new(), known_types: Vec::new() }
    }

    /// Adds the type with this `name` from `file`, unless it is already known. If another type has this name, the new
    /// type is named by its file.
    pub fn add(&mut self, name: &str, file: &str, kind: impl FnOnce() -> Arc<T>) {
        let name_and_file = [name, file].map(str::to_owned);
        if self.known_types.contains(&name_and_file) {
            return;
        }
        if let Some(word) = name_and_file.iter().find(|word| self.names().all(|used| used != *word)).cloned() {
            self.types.push((word, kind()));
        }
        self.known_types.push(name_and_file);
    }

    /// Names of the types.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.types.iter().map(|(name, _)| &**name)
    }

    /// The type with this name.
    ///
    /// # Errors
    /// [`Refusal::NoType`] if no type has this name.
    pub fn find(&self, name: &str) -> Result<Arc<T>, Refusal> {
        let found = self.types.iter().find(|(known, _)| known == name).map(|(_, kind)| Arc::clone(kind));
        found.ok_or_else(|| Refusal::NoType {
            what: self.what,
            name: name.to_owned(),
            known: self.names().collect::<Vec<_>>().join(", "),
        })
    }
}
