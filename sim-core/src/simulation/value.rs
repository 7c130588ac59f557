//! A complete simulation as one value that the caller can advance, read, copy and restore.

use std::convert::Infallible;
use std::sync::Arc;

use super::{Environment, FactoryError, Faults, Intervention, Refusal, Robot, RobotFactory, Roster};
use crate::RobotId;
use crate::build::{NoMeshes, SpawnedEntity, Visuals};
use crate::camera::{Label, Picture};
use crate::check::{Finding, Monitor};
use crate::device::camera::{CameraError, Setting};
use crate::drive::{Command, CommandError};
use crate::parallel::{self, Serial};
use crate::pose::Pose;
use crate::record::{Action, Digest, KindSet, Record, Recorder};
use crate::spec::SceneSpec;
use crate::time::Time;
use crate::world::World;

/// Robots in their environment, without programs. The caller commands the robots, with the same devices, noise and
/// timing as a program.
///
/// A simulation is a value: a [`Clone`] is a snapshot, and assigning it back restores it. Copies are independent of the
/// original and stay bit-identical under the same commands. Walls, meshes and types are shared between copies.
///
/// A command takes effect at the present time, [`Simulation::now`]; other robots see its effect from the next slot on.
/// The order in which robots act during a slot has no effect. A simulation never accesses files, clocks or other
/// external state.
#[derive(Clone, Debug)]
pub struct Simulation {
    environment: Environment,
    /// Robots in the order of their ids.
    robots: Vec<Robot>,
    /// Robots that may have acted in the present slot.
    acted: Vec<RobotId>,
    now: Time,
    /// Visuals for cameras; `None` until they are set.
    visuals: Option<Arc<Visuals>>,
    /// All robots and objects, and the types of robots and objects that can be added.
    roster: Arc<Roster>,
    factory: Arc<RobotFactory>,
    /// Memory that is reused for vectors of references.
    spare: Vec<usize>,
    /// Pending faults of the scene.
    faults: Faults,
}

/// Options of a simulation that override those of its scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Seed of all random numbers; default: the scene's seed, otherwise 0.
    pub seed: Option<u64>,
    /// Length of a slot, positive; default: the scene's slot length, otherwise 50 ms.
    pub slot: Option<Time>,
}

/// Default length of a slot.
pub const DEFAULT_SLOT: Time = Time::from_millis(50);

impl Simulation {
    /// Creates the simulation of `scene` at time 0.
    ///
    /// # Errors
    /// [`FactoryError`] for an invalid robot type or noise model of a drive, and for movable objects in a build without
    /// rigid bodies.
    ///
    /// # Panics
    /// If the slot is not positive.
    pub fn new(scene: &SceneSpec, options: &Options) -> Result<Self, FactoryError> {
        let (seed, slot) = seed_and_slot(scene, options);
        Self::from_factory(RobotFactory::new(scene, seed, slot, false), scene, seed, slot)
    }

    /// Creates the simulation of `scene` at time 0. The result is equal to that of [`Simulation::new`], but is created
    /// faster, because it shares walls, ground and types with this simulation. Walls, terrain, fixed objects, contact
    /// rule and types of robots of `scene` must be the same as in this simulation's scene; initial poses, noise and
    /// seed can differ.
    ///
    /// # Errors
    /// [`FactoryError`] for an invalid noise model of a drive.
    ///
    /// # Panics
    /// If the slot is not positive.
    pub fn restarted(&self, scene: &SceneSpec, options: &Options) -> Result<Self, FactoryError> {
        let (seed, slot) = seed_and_slot(scene, options);
        Self::from_factory(RobotFactory::clone(&self.factory).with_seed(seed, slot), scene, seed, slot)
    }

    fn from_factory(mut factory: RobotFactory, scene: &SceneSpec, seed: u64, slot: Time) -> Result<Self, FactoryError> {
        let created = scene.robots.iter().map(|spec| factory.robot(spec, Time::ZERO));
        let (mut robots, reception_noise): (Vec<Robot>, Vec<_>) =
            created.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        robots.iter_mut().for_each(|robot| robot.record_start(""));
        let world = factory.world(scene, &mut robots, reception_noise)?;
        let monitor = Monitor::new(scene, world.walls(), scene.run.until.unwrap_or(Time::NEVER));
        let environment = Environment::new(world, Recorder::new(seed, slot, KindSet::NONE)).with_monitor(monitor);
        let until = scene.run.until.unwrap_or(Time::NEVER);
        let noise = |id: RobotId| robots.get(id.index()).map(|robot: &Robot| robot.noise().clone()).unwrap_or_default();
        let faults = Faults::new(&scene.faults, seed, until, noise);
        let mut simulation = Self { faults, ..Self::of(environment, robots, Roster::of(scene), factory) };
        simulation.apply_faults();
        Ok(simulation)
    }

    /// Creates a simulation of copies of `robots`, in the order of their ids, in a copy of `environment`, at the start
    /// of the environment's present slot, with these pending `faults`. The copy has no visuals. `roster` and `factory`
    /// are used to add more robots.
    pub fn copy_of(
        environment: &Environment,
        robots: &[&Robot],
        roster: &Roster,
        factory: &RobotFactory,
        faults: Faults,
    ) -> Self {
        let robots = robots.iter().map(|robot| (*robot).clone()).collect();
        let mut copy = Self { faults, ..Self::of(environment.clone(), robots, roster.clone(), factory.clone()) };
        copy.apply_faults();
        copy
    }

    /// Creates a simulation of `robots`, in the order of their ids, in `environment`, at the start of its present slot.
    fn of(environment: Environment, mut robots: Vec<Robot>, roster: Roster, factory: RobotFactory) -> Self {
        let now = environment.world.slot_start();
        robots.iter_mut().for_each(|robot| robot.now = now);
        let acted = robots.iter().map(|robot| robot.id).collect();
        let (roster, factory) = (Arc::new(roster), Arc::new(factory));
        Self {
            environment,
            robots,
            acted,
            now,
            visuals: None,
            roster,
            factory,
            spare: Vec::new(),
            faults: Faults::default(),
        }
    }

    /// The present time of all robots.
    pub fn now(&self) -> Time {
        self.now
    }

    /// The world, as published at the start of the present slot.
    pub fn world(&self) -> &World {
        &self.environment.world
    }

    /// Number of robots; their ids run from 1 to this number.
    pub fn robot_count(&self) -> usize {
        self.robots.len()
    }

    /// Robot `id` with its true motion, devices and spec.
    ///
    /// # Panics
    /// If the robot does not exist.
    pub fn robot(&self, id: RobotId) -> &Robot {
        &self.robots[id.index()]
    }

    /// Calls `act` with robot `id` at the present time, to read and change its devices, radio and drive.
    ///
    /// # Panics
    /// If the robot does not exist.
    pub fn with_robot<R>(&mut self, id: RobotId, act: impl FnOnce(&mut Robot, &World) -> R) -> R {
        if self.acted.last() != Some(&id) {
            self.acted.push(id);
        }
        act(&mut self.robots[id.index()], &self.environment.world)
    }

    /// Commands the drive of robot `id` at the present time. A robot that has failed or was removed does not obey.
    ///
    /// # Errors
    /// [`CommandError`] for a command that the drive cannot carry out; nothing changes then.
    ///
    /// # Panics
    /// If the robot does not exist.
    pub fn command(&mut self, id: RobotId, command: Command) -> Result<(), CommandError> {
        self.with_robot(id, |robot, world| robot.command(world, command))
    }

    /// Applies and records an intervention now, like a [run with programs](Action). The present time must be the start
    /// of a slot.
    ///
    /// Added robots have no program. The types of added robots and objects can be those of the scene and those
    /// [added](Simulation::roster_mut) to the roster. A removed robot keeps its id but is no longer in the world.
    ///
    /// # Errors
    /// [`Refusal`] for unknown names and invalid values, for a present time [within a slot](Refusal::WithinSlot), and
    /// for actions that need a run with programs: adding a robot with a program, typing a line to a program, and ending
    /// the run. Nothing changes then.
    pub fn act(&mut self, action: &Action) -> Result<(), Refusal> {
        if self.now != self.world().slot_start() {
            return Err(Refusal::WithinSlot(self.world().slot_end()));
        }
        if let Action::AddRobot { kind, program_of, x_m, y_m, phi_rad } = action {
            if program_of.is_some() {
                return Err(Refusal::Other("a simulation runs no programs: who hosts them does".to_owned()));
            }
            let spec = self.roster.robot(kind, None, [*x_m, *y_m, *phi_rad], self.world())?;
            let new_robot = Arc::make_mut(&mut self.factory).robot(&spec, self.now);
            let (mut robot, reception_noise) = new_robot.map_err(|error| Refusal::Other(error.to_string()))?;
            robot.record_start("");
            self.environment.record_intervention(self.now, action);
            self.environment.admit(&mut robot, reception_noise);
            self.add_visuals(SpawnedEntity::Robot(robot.id, Arc::clone(&spec.robi)));
            self.acted.push(robot.id);
            self.robots.push(robot);
            Arc::make_mut(&mut self.roster).keep_robot(spec);
            return Ok(());
        }
        let robots = &mut self.robots[..];
        let intervention = Intervention::validate(action, robots, &self.roster, &self.environment.world)?;
        self.environment.record_intervention(self.now, action);
        if let Intervention::RemoveRobot(id) | Intervention::HaltRobot(id) = intervention {
            self.with_robot(id, |robot, world| {
                robot.halt(world);
                robot.switch_radio_off();
            });
        }
        let effect = self.environment.intervene(&intervention, &mut self.robots[..]);
        self.acted.extend(effect.robots);
        if let (Intervention::AddObject(spec), Some(id)) = (intervention, effect.added_object) {
            self.add_visuals(SpawnedEntity::Object(id, Arc::clone(&spec.kind)));
            Arc::make_mut(&mut self.roster).keep_object(*spec);
        }
        Ok(())
    }

    /// Makes an added entity visible to cameras: with the appearance of its type if this appearance is known, otherwise
    /// in the shape of its colliders.
    fn add_visuals(&mut self, entity: SpawnedEntity) {
        if let Some(visuals) = &mut self.visuals {
            Arc::make_mut(visuals).add([entity], &mut NoMeshes);
        }
    }

    /// Findings of the scene's checks on motion, each with the index of its check in the scene. They include the motion
    /// up to the last whole tenth of a second before the end of the last completed slot.
    pub fn findings(&self) -> impl Iterator<Item = (usize, Finding)> {
        self.environment.monitor().into_iter().flat_map(Monitor::findings)
    }

    /// All robots and objects, and the types of robots and objects that can be added.
    pub fn roster(&self) -> &Roster {
        &self.roster
    }

    /// The roster, mutable, to add types.
    pub fn roster_mut(&mut self) -> &mut Roster {
        Arc::make_mut(&mut self.roster)
    }

    /// Reading of range sensor `index` of robot `id` now, with its errors, m; `None` if out of range.
    ///
    /// # Panics
    /// If the robot does not exist.
    pub fn range(&mut self, id: RobotId, index: usize) -> Option<f64> {
        self.robots[id.index()].read_range(&self.environment.world, index).distance
    }

    /// True pose of the centre of robot `id`, now.
    ///
    /// # Panics
    /// If the robot does not exist.
    pub fn pose(&mut self, id: RobotId) -> Pose {
        self.robots[id.index()].motion.pose(self.now)
    }

    /// Odometry pose of robot `id` now, in the odometry frame.
    ///
    /// # Panics
    /// If the robot does not exist.
    pub fn odometry(&mut self, id: RobotId) -> Pose {
        self.robots[id.index()].motion.odometry(self.now)
    }

    /// Sets the visuals of the scene for cameras; later copies share them. Without visuals there are no images. Robots
    /// and objects that were added before appear like those that are added later.
    pub fn set_visuals(&mut self, mut visuals: Visuals) {
        visuals.add(self.roster.added(), &mut NoMeshes);
        self.visuals = Some(Arc::new(visuals));
    }

    /// Takes the image that a program of robot `id` would get now: red, green and blue of each pixel, 0 to 255, with
    /// the camera's errors. The image was exposed [one read-out time](crate::device::camera::READ_OUT) ago. It is
    /// counted and recorded like an image of a program.
    ///
    /// If the camera is off, it is first switched on with the default setting, for images of 320 x 240 pixels. To use
    /// another [`Setting`], call [`Simulation::with_robot`] and
    /// [`Camera::switch_on`](crate::device::camera::Camera::switch_on).
    ///
    /// # Errors
    /// [`CameraError`] for a robot without a camera, and before [`Simulation::set_visuals`].
    ///
    /// # Panics
    /// If the robot does not exist.
    pub fn image(&mut self, id: RobotId) -> Result<Picture<[u8; 3]>, CameraError> {
        let visuals = self.visuals.clone().ok_or(CameraError::NoScenery)?;
        self.with_robot(id, |robot, world| {
            if robot.camera_setting() == Err(CameraError::Off) {
                robot.devices.camera.switch_on(Setting::default());
            }
            robot.take_colour(world, visuals.scenery())
        })
    }

    /// Depth of each pixel of the last image of robot `id`, without errors: the distance along the line of sight
    /// through the centre of the pixel, m. It is infinite for the sky.
    ///
    /// # Errors
    /// [`CameraError`], [`NotTaken`](CameraError::NotTaken) before the first image.
    ///
    /// # Panics
    /// If the robot does not exist.
    pub fn depth(&mut self, id: RobotId) -> Result<Picture<f32>, CameraError> {
        self.robots[id.index()].take_depth()
    }

    /// Label of each pixel of the last image of robot `id`, without errors: sky, ground, a wall, an object or a robot.
    ///
    /// # Errors
    /// [`CameraError`], [`NotTaken`](CameraError::NotTaken) before the first image.
    ///
    /// # Panics
    /// If the robot does not exist.
    pub fn labels(&mut self, id: RobotId) -> Result<Picture<Label>, CameraError> {
        self.robots[id.index()].take_labels()
    }

    /// Advances to `time`; does nothing if `time` is not later than [`Simulation::now`].
    pub fn advance_to(&mut self, time: Time) {
        let Ok(()) = self.advance_with(time, |_| Ok::<(), Infallible>(()));
    }

    /// Advances to `time`. At the end of each slot, `visit` is called with the recorded events of
    /// [interest](Recorder::set_interest), in order of (virtual time, robot, sequence).
    ///
    /// # Errors
    /// The first error of `visit`; the simulation is then at the end of that slot.
    pub fn advance_with<E>(
        &mut self,
        time: Time,
        mut visit: impl FnMut(&Record<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        while self.now < time {
            let slot_end = self.world().slot_end();
            self.pass_to(time.min(slot_end));
            if time < slot_end {
                break;
            }
            self.end_slot();
            let ended = self.environment.recorder().end_slot(slot_end, &mut visit);
            if ended.is_ok() {
                self.skip_to(time);
            }
            self.apply_faults();
            ended?;
        }
        Ok(())
    }

    /// Applies the faults of the present slot, which has just begun. Skips a fault that cannot be applied, such as a
    /// fault of a removed robot.
    fn apply_faults(&mut self) {
        while self.faults.next().is_some_and(|at| at < self.world().slot_end()) {
            let action = self.faults.pop().map(|(_, action)| action);
            action.into_iter().for_each(|action| _ = self.act(&action));
        }
    }

    /// Sets the kinds of events with which [`Simulation::advance_with`] calls `visit`.
    pub fn set_interest(&mut self, interest: KindSet) {
        self.environment.recorder().set_interest(interest);
    }

    /// Digest of all events up to the last ended slot.
    pub fn digest(&self) -> Digest {
        self.environment.digest()
    }

    /// Advances all robots to `time`, which lies within the present slot or at its end. Also computes the measurements
    /// that end by then.
    fn pass_to(&mut self, time: Time) {
        let Self { environment, robots, now, .. } = self;
        let slot_end = environment.world.slot_end();
        for robot in robots.iter_mut().filter(|robot| !robot.is_removed) {
            while robot.devices.due() <= time && robot.devices.due() < slot_end {
                robot.now = robot.now.max(robot.devices.due());
                robot.settle(&environment.world);
            }
            robot.now = time;
        }
        *now = time;
    }

    fn end_slot(&mut self) {
        let Self { environment, robots, acted, spare, .. } = self;
        acted.sort_unstable();
        acted.dedup();
        let mut affected = environment.affected_robots(acted, acted, &mut robots[..]).iter().copied().peekable();
        acted.clear();
        // Both lists are in the order of the ids.
        let is_affected = |robot: &&mut Robot| affected.next_if_eq(&robot.id).is_some();
        let mut states: Vec<&mut Robot> = parallel::reuse(std::mem::take(spare));
        states.extend(robots.iter_mut().filter(is_affected));
        environment.end_slot(&mut states, &Serial);
        *spare = parallel::reuse(states);
    }

    /// Skips the slots before `time` in which nothing happens.
    fn skip_to(&mut self, time: Time) {
        let world = &self.environment.world;
        let slot_start = world.slot_start();
        if world.is_object_moving() || self.environment.is_robot_moving() {
            return;
        }
        let present = self.robots.iter().filter(|robot| !robot.is_removed);
        let due = present.map(|robot| robot.devices.due()).fold(self.environment.message_due(), Time::min);
        let due = due.min(self.faults.next().unwrap_or(Time::NEVER));
        let next = due.min(time).floor_to(world.slot()).max(slot_start);
        if next > slot_start {
            self.environment.world.advance_to(next);
            self.robots.iter_mut().for_each(|robot| robot.now = next);
            self.now = next;
        }
    }
}

/// Seed and slot length of a simulation of `scene`.
fn seed_and_slot(scene: &SceneSpec, options: &Options) -> (u64, Time) {
    let seed = options.seed.or(scene.run.seed).unwrap_or(0);
    (seed, options.slot.or(scene.run.slot).unwrap_or(DEFAULT_SLOT))
}
