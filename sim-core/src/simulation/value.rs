//! A whole simulation as one value: owned, advanced, looked at, copied and set back by its caller.

use std::convert::Infallible;
use std::sync::Arc;

use super::{Environment, FactoryError, Robot, RobotFactory};
use crate::RobotId;
use crate::build::Visuals;
use crate::camera::{Label, Picture};
use crate::device::camera::{CameraError, Setting};
use crate::drive::{Command, CommandError};
use crate::pose::Pose;
use crate::record::{Digest, KindSet, Record, Recorder};
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
    /// A robot type, or errors of its drive, with which nothing can be computed.
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
        let world = factory.world(scene, &mut robots, heard);
        let acted = robots.iter().map(|robot| robot.id).collect();
        let recorder = Recorder::new(seed, slot, KindSet::NONE);
        Ok(Self { environment: Environment::new(world, recorder), robots, acted, now: Time::ZERO, visuals: None })
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
        for robot in robots {
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
        let concerned = environment.concerned(std::mem::take(acted), |id, act| act(&mut robots[id.index()]));
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
        let due = self.robots.iter().map(|robot| robot.devices.due()).fold(self.environment.message_due(), Time::min);
        let next = due.min(time).floor_to(world.slot()).max(following);
        if next > following {
            self.environment.world.advance_to(next);
            self.robots.iter_mut().for_each(|robot| robot.now = next);
            self.now = next;
        }
    }
}
