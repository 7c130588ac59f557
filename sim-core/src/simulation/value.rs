//! A whole simulation as one value: owned, advanced, looked at, copied and set back by its caller.

use std::convert::Infallible;
use std::sync::Arc;

use super::{Environment, FactoryError, Intervention, Refusal, Robot, RobotFactory, Roster};
use crate::RobotId;
use crate::build::{Newcomer, NoMeshes, Visuals};
use crate::camera::{Label, Picture};
use crate::device::camera::{CameraError, Setting};
use crate::drive::{Command, CommandError};
use crate::pose::Pose;
use crate::record::{Action, Digest, KindSet, Record, Recorder};
use crate::spec::SceneSpec;
use crate::time::Time;
use crate::world::World;

/// Robots in their environment, without programs: their caller drives them through the devices, noise and timing that a program
/// would get.
///
/// It is a value: a [`Clone`] is a snapshot, and assigning that back restores it. Whatever happens to a copy, the original goes on as
/// if there were none, and both go on alike, to the bit. Walls, meshes and types are shared between copies.
///
/// A command acts at the present time, [`Simulation::now`]; other robots see it from the next slot on. Within a slot the order in which
/// robots act changes nothing. Nothing here reads a file, a clock or anything else from outside.
#[derive(Clone, Debug)]
pub struct Simulation {
    environment: Environment,
    /// In the order of their ids.
    robots: Vec<Robot>,
    /// Robots that may have acted in the present slot.
    acted: Vec<RobotId>,
    now: Time,
    /// What cameras see, once somebody has said it.
    visuals: Option<Arc<Visuals>>,
    /// Who is in it, and what more of them are made of.
    roster: Arc<Roster>,
    factory: Arc<RobotFactory>,
}

/// What a simulation is told beside its scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Seed of all randomness; that of the scene, else 0, where none is given.
    pub seed: Option<u64>,
    /// Length of a slot; that of the scene, else 50 ms, where none is given. Positive.
    pub slot: Option<Time>,
}

/// Length of a slot where nobody says anything else.
pub const DEFAULT_SLOT: Time = Time::from_millis(50);

impl Simulation {
    /// The simulation of `scene` at time 0.
    ///
    /// # Errors
    /// A robot type, or errors of its drive, with which nothing can be computed; movable objects in a build without them.
    ///
    /// # Panics
    /// If the slot is not positive.
    pub fn new(scene: &SceneSpec, options: &Options) -> Result<Self, FactoryError> {
        let seed = options.seed.or(scene.run.seed).unwrap_or(0);
        let slot = options.slot.or(scene.run.slot).unwrap_or(DEFAULT_SLOT);
        let mut factory = RobotFactory::new(scene, seed, slot, false);
        let made = scene.robots.iter().map(|spec| factory.robot(spec, Time::ZERO));
        let (mut robots, heard): (Vec<Robot>, Vec<_>) = made.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        robots.iter_mut().for_each(|robot| robot.record_start(""));
        let world = factory.world(scene, &mut robots, heard)?;
        let environment = Environment::new(world, Recorder::new(seed, slot, KindSet::NONE));
        Ok(Self::of(environment, robots, Roster::of(scene), factory))
    }

    /// The simulation of these robots, in the order of their ids, in their environment, at the start of its present slot: copies of
    /// those of a run, with what more of them are made of.
    pub fn of(environment: Environment, mut robots: Vec<Robot>, roster: Roster, factory: RobotFactory) -> Self {
        let now = environment.world.slot_start();
        robots.iter_mut().for_each(|robot| robot.now = now);
        let acted = robots.iter().map(|robot| robot.id).collect();
        let (roster, factory) = (Arc::new(roster), Arc::new(factory));
        Self { environment, robots, acted, now, visuals: None, roster, factory }
    }

    /// The present time, that of all robots.
    pub fn now(&self) -> Time {
        self.now
    }

    /// The world, as it was made public at the start of the present slot.
    pub fn world(&self) -> &World {
        &self.environment.world
    }

    /// Number of robots; their ids are 1 to this.
    pub fn robot_count(&self) -> usize {
        self.robots.len()
    }

    /// Robot `id`: its true motion, its devices, its spec.
    ///
    /// # Panics
    /// If there is no such robot.
    pub fn robot(&self, id: RobotId) -> &Robot {
        &self.robots[id.index()]
    }

    /// Lets `act` read and change robot `id` now: devices, radio, drive.
    ///
    /// # Panics
    /// If there is no such robot.
    pub fn with_robot<R>(&mut self, id: RobotId, act: impl FnOnce(&mut Robot, &World) -> R) -> R {
        if self.acted.last() != Some(&id) {
            self.acted.push(id);
        }
        act(&mut self.robots[id.index()], &self.environment.world)
    }

    /// Gives the drive of robot `id` a command now.
    ///
    /// # Errors
    /// [`CommandError`] for what the drive cannot do; nothing changes then.
    ///
    /// # Panics
    /// If there is no such robot.
    pub fn command(&mut self, id: RobotId, command: Command) -> Result<(), CommandError> {
        self.with_robot(id, |robot, world| robot.command(world, command))
    }

    /// Carries out an intervention now, at the start of a slot, and records it, as [runs with programs](Action) do.
    ///
    /// Robots that come have no program; they and objects are of the types of the scene, and of those that were
    /// [added](Simulation::roster_mut). A robot that is removed stays known by its id and is not in the world any more.
    ///
    /// # Errors
    /// [`Refusal`] for what is not there or makes no sense, [within a slot](Refusal::WithinSlot), and for what only a run with
    /// programs can do: programs of robots that come, and its end. Nothing changes then.
    pub fn act(&mut self, action: &Action) -> Result<(), Refusal> {
        if self.now != self.world().slot_start() {
            return Err(Refusal::WithinSlot(self.world().slot_end()));
        }
        if let Action::AddRobot { kind, program_of, x_m, y_m, phi_rad } = action {
            if program_of.is_some() {
                return Err(Refusal::Other("a simulation runs no programs: who hosts them does".to_owned()));
            }
            let spec = self.roster.robot(kind, None, [*x_m, *y_m, *phi_rad], self.world())?;
            let made = Arc::make_mut(&mut self.factory).robot(&spec, self.now);
            let (mut robot, heard) = made.map_err(|error| Refusal::Other(error.to_string()))?;
            robot.record_start("");
            self.environment.record_intervention(self.now, action);
            self.environment.admit(&mut robot, heard);
            self.show(Newcomer::Robot(robot.id, Arc::clone(&spec.robi)));
            self.acted.push(robot.id);
            self.robots.push(robot);
            Arc::make_mut(&mut self.roster).keep_robot(spec);
            return Ok(());
        }
        let robots = &mut self.robots[..];
        let intervention = Intervention::validate(action, robots, &self.roster, &self.environment.world)?;
        self.environment.record_intervention(self.now, action);
        if let Intervention::RemoveRobot(id) = intervention {
            self.with_robot(id, Robot::halt);
        }
        let effect = self.environment.intervene(&intervention, &mut self.robots[..]);
        self.acted.extend(effect.robots);
        if let (Intervention::AddObject(spec), Some(id)) = (intervention, effect.came) {
            self.show(Newcomer::Object(id, Arc::clone(&spec.kind)));
            Arc::make_mut(&mut self.roster).keep_object(*spec);
        }
        Ok(())
    }

    /// Lets cameras see somebody who has come: as others of the type look, else as its colliders are.
    fn show(&mut self, newcomer: Newcomer) {
        if let Some(visuals) = &mut self.visuals {
            Arc::make_mut(visuals).add([newcomer], &mut NoMeshes);
        }
    }

    /// Who is in it, and the types of which more can be added.
    pub fn roster(&self) -> &Roster {
        &self.roster
    }

    /// The same, so that types can be added.
    pub fn roster_mut(&mut self) -> &mut Roster {
        Arc::make_mut(&mut self.roster)
    }

    /// What range sensor `index` of robot `id` reads now, with its errors, m; `None` when nothing is within its reach.
    ///
    /// # Panics
    /// If there is no such robot.
    pub fn range(&mut self, id: RobotId, index: usize) -> Option<f64> {
        self.robots[id.index()].read_range(&self.environment.world, index).distance
    }

    /// True pose of the centre of robot `id`, now.
    ///
    /// # Panics
    /// If there is no such robot.
    pub fn pose(&mut self, id: RobotId) -> Pose {
        self.robots[id.index()].motion.pose(self.now)
    }

    /// Pose of robot `id` by its odometry, now, in the frame in which it started.
    ///
    /// # Panics
    /// If there is no such robot.
    pub fn odometry(&mut self, id: RobotId) -> Pose {
        self.robots[id.index()].motion.odometry(self.now)
    }

    /// Lets cameras see this from now on; all copies share it. Without it there are no images.
    pub fn set_visuals(&mut self, visuals: Visuals) {
        self.visuals = Some(Arc::new(visuals));
    }

    /// The image that a program of robot `id` would get now: red, green and blue of each pixel, 0 to 255, with the camera's errors,
    /// exposed [a read-out](crate::device::camera::READ_OUT) ago. It counts and is recorded as a program's.
    ///
    /// A camera that is off is switched on first, for images of 320 x 240 pixels; another [`Setting`] is set by
    /// [`Simulation::with_robot`] and [`Camera::switch_on`](crate::device::camera::Camera::switch_on).
    ///
    /// # Errors
    /// [`CameraError`] for a robot without a camera, and before [`Simulation::set_visuals`].
    ///
    /// # Panics
    /// If there is no such robot.
    pub fn image(&mut self, id: RobotId) -> Result<Picture<[u8; 3]>, CameraError> {
        let visuals = self.visuals.clone().ok_or(CameraError::NoScenery)?;
        self.with_robot(id, |robot, world| {
            if robot.camera_setting() == Err(CameraError::Off) {
                robot.devices.camera.switch_on(Setting::default());
            }
            robot.take_colour(world, visuals.scenery())
        })
    }

    /// How far away what each pixel of the last image of robot `id` shows is, without errors: m along the line of sight through
    /// the pixel's middle; infinite for the sky.
    ///
    /// # Errors
    /// [`CameraError`], [`NotTaken`](CameraError::NotTaken) before a first image.
    ///
    /// # Panics
    /// If there is no such robot.
    pub fn depth(&mut self, id: RobotId) -> Result<Picture<f32>, CameraError> {
        self.robots[id.index()].take_depth()
    }

    /// What each pixel of the last image of robot `id` shows, without errors: sky, ground, a wall, an object or a robot.
    ///
    /// # Errors
    /// [`CameraError`], [`NotTaken`](CameraError::NotTaken) before a first image.
    ///
    /// # Panics
    /// If there is no such robot.
    pub fn labels(&mut self, id: RobotId) -> Result<Picture<Label>, CameraError> {
        self.robots[id.index()].take_labels()
    }

    /// Goes on to `time`; nothing happens if that is not later than [`Simulation::now`].
    pub fn advance_to(&mut self, time: Time) {
        let Ok(()) = self.advance_with(time, |_| Ok::<(), Infallible>(()));
    }

    /// Goes on to `time`; `show` gets what is recorded at the end of each slot, in order of (virtual time, robot, sequence), as far as
    /// it is of [interest](Recorder::set_interest).
    ///
    /// # Errors
    /// The first error of `show`; the simulation then stands at the end of that slot.
    pub fn advance_with<E>(&mut self, time: Time, mut show: impl FnMut(&Record<'_>) -> Result<(), E>) -> Result<(), E> {
        while self.now < time {
            let slot_end = self.world().slot_end();
            self.pass_to(time.min(slot_end));
            if time < slot_end {
                break;
            }
            self.end_slot();
            let ended = self.environment.recorder().end_slot(slot_end, &mut show);
            ended?;
            self.skip_to(time);
        }
        Ok(())
    }

    /// Shows events of these kinds to who [looks on](Simulation::advance_with).
    pub fn set_interest(&mut self, interest: KindSet) {
        self.environment.recorder().set_interest(interest);
    }

    /// The digest of everything recorded up to the last slot that has ended.
    pub fn digest(&self) -> Digest {
        self.environment.digest()
    }

    /// Lets all robots pass to `time`, within the present slot or at its end; measurements are computed on the way that end.
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
        let Self { environment, robots, acted, .. } = self;
        let concerned = environment.concerned(acted, &mut robots[..]);
        acted.clear();
        // The robots and their ids are in the same order.
        let mut next = concerned.iter().copied().peekable();
        let is_concerned = |robot: &&mut Robot| next.next_if_eq(&robot.id).is_some();
        let mut states: Vec<&mut Robot> = robots.iter_mut().filter(is_concerned).collect();
        environment.end_slot(&mut states);
    }

    /// Skips the slots before `time` in which nothing happens.
    fn skip_to(&mut self, time: Time) {
        let world = &self.environment.world;
        let following = world.slot_start();
        if world.is_object_moving() || self.environment.is_robot_moving() {
            return;
        }
        let present = self.robots.iter().filter(|robot| !robot.is_removed);
        let due = present.map(|robot| robot.devices.due()).fold(self.environment.message_due(), Time::min);
        let next = due.min(time).floor_to(world.slot()).max(following);
        if next > following {
            self.environment.world.advance_to(next);
            self.robots.iter_mut().for_each(|robot| robot.now = next);
            self.now = next;
        }
    }
}
