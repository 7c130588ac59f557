//! Motion of a robot: a chain of pieces that is computed from its commands.

mod legs;

use std::{collections::VecDeque, ops::Range, sync::Arc};

use glam::DVec2;
use smallvec::SmallVec;

use super::{
    HISTORY,
    command::{ActiveCommand, Command, CommandError, CommandState, check_wheel},
    control::{Actuation, Gains, Pid},
    hull::Hull,
    imperfection::{ContactRule, Imperfection, MotionErrors, Vehicle},
    legged::Walk,
    model::{DriveKind, Model, ModelError, Wheels},
    piece::{Cause, Piece, State},
    rare::Rare,
    stage::{MotionInterval, Slowdown, Stage, axle_of},
};
use crate::{
    ObjectId, RobotId,
    contact::{APPROACH, Body, Obstacle, Pace, Path, Thing},
    math,
    pose::{Heading, PlacementError, Pose, Twist},
    scene::Walls,
    sort::sort_few,
    time::{TICK, Time},
};

/// Number of new contacts before the present slot that a motion keeps.
const KEPT_IMPACTS: usize = 32;

/// Number of stages of a robot that is commanded once in each slot of 50 ms, and has no errors and no contacts.
const USUAL_STAGES: usize = 4;

/// Maximum number of ticks that [`Motion::drive_end`] computes in advance while ticks still change the motion: 1,000 s.
const MAX_TICKS_AHEAD: usize = 100_000;

/// A body's contact with an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Instant of the contact, rounded up to a microsecond.
    pub time: Time,
    /// Instant from which the robot's program can detect the impact. For a wall this is `time`. For a robot or an
    /// object it is the end of the slot, at which such impacts are computed.
    pub known_at: Time,
    /// The touched obstacle.
    pub thing: Thing,
    /// The touched point in the world frame, m.
    pub point: DVec2,
    /// Direction from the robot's centre to the touched point, in the robot's frame, rad counter-clockwise from ahead.
    pub bearing: f64,
    /// False if an earlier contact continues: the body already touched the wall when the body began to move, or the
    /// body was pressed against the same wall or stopped by the same robot within the last 100 ms.
    pub fresh: bool,
}

/// A change of a robot's motion by a command, a setting or a placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Input {
    Command(Command),
    Odometry(Pose),
    Control(Option<Gains>),
    WheelControl(usize, Option<Pid>),
    /// Pose of the robot's centre.
    Place(Pose),
}

/// Motion of a disc on one path: it moves from `begin` to `end`, both in seconds after `start`, and then rests until
/// `until`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Passage {
    pub start: Time,
    pub begin: f64,
    pub until: Time,
    pub end: f64,
    pub path: Path,
    /// Heading of the robot at `start`.
    pub heading: Heading,
}

/// The passages of a body in a slot: usually one, which then needs no heap memory.
pub(crate) type Passages = SmallVec<[Passage; 1]>;

impl Passage {
    /// Seconds for which the disc has moved on the path until `at`.
    pub fn elapsed(&self, at: Time) -> f64 {
        ((at - self.start).seconds().min(self.end) - self.begin).max(0.0)
    }

    /// Returns true if the disc has come to rest at `at`.
    pub fn has_ended(&self, at: Time) -> bool {
        (at - self.start).seconds() >= self.end
    }

    /// Instant at which the disc starts to move (`begin`), rounded up to a microsecond.
    pub fn begin_time(&self) -> Time {
        if self.begin == 0.0 { self.start } else { self.start + Time::from_seconds_ceil(self.begin) }
    }

    /// A motion of constant twist that approximates this passage: its start, the pose at the start, the twist, and the
    /// duration in seconds.
    ///
    /// For a passage of constant twist the result is exact. A slide along a wall is replaced by a circular arc between
    /// its positions at `from` and `to`.
    pub fn constant_twist(&self, from: Time, to: Time) -> (Time, Pose, Twist, f64) {
        if self.path.pace == Pace::ConstantTwist {
            let start = self.begin_time();
            return (start, self.pose(start), self.path.twist, self.end - self.begin);
        }
        let start = from.max(self.begin_time());
        let to = to.min(self.until).max(start + Time(1));
        let pose = self.pose(start);
        let chord = pose.inverse_transform_point(self.centre(to));
        let duration = (self.elapsed(to) - self.elapsed(start)).max(1e-6);
        let angle = self.path.omega() * duration;
        // The arc through both positions: the inverse of `Pose::moved`.
        let (s, c) = (math::sinc(angle), math::cosc(angle));
        let divisor = (s * s + c * c) * duration;
        let twist = Twist {
            vx: (chord.x * s + chord.y * c) / divisor,
            vy: (chord.y * s - chord.x * c) / divisor,
            omega: self.path.omega(),
        };
        (start, pose, twist, duration)
    }

    /// Position of the disc's centre.
    pub fn centre(&self, at: Time) -> DVec2 {
        if self.path.is_resting() { self.path.origin } else { self.path.position(self.elapsed(at)) }
    }

    /// Pose of the robot's centre.
    pub fn pose(&self, at: Time) -> Pose {
        Pose {
            position: self.centre(at),
            heading: self.heading.turned(self.path.omega() * (self.begin + self.elapsed(at))),
        }
    }
}

/// Drive of a robot at an instant, as the solver of the movable objects needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DriveState {
    /// Pose of the centre in the world.
    pub centre: Pose,
    /// Twist of the centre, in the robot's frame, that the robot would have without movable objects.
    pub twist_without_objects: Twist,
    /// Fraction of this twist with which the robot moves, 0 to 1.
    pub fraction: f64,
    /// Seconds until the robot comes to rest on the present plan; infinite if it does not, or if an object blocks it
    /// now.
    pub time_to_rest: f64,
}

/// The motion of one robot in a static world, as a function of virtual time, computed from the robot's commands.
///
/// Queries may refer to instants up to [`HISTORY`] before the present slot, and to the future according to the present
/// plan.
#[derive(Clone, Debug)]
pub struct Motion {
    id: RobotId,
    vehicle: Vehicle,
    walls: Arc<Walls>,
    /// Stages of the plan, never empty; in ascending order of their starts.
    stages: VecDeque<Stage>,
    /// Inputs since the start of the slot.
    journal: Vec<(Time, Input)>,
    /// Start of the present slot. The motion before it is final; its impacts are in `log`.
    committed: Time,
    /// New contacts with movable objects in the present slot.
    object_impacts: Vec<Impact>,
    /// Time of the last contact with each movable object that the body touched in the last 100 ms.
    touched_objects: Vec<(ObjectId, Time)>,
    /// The last new contacts before the present slot; `None` if they are not kept.
    log: Option<VecDeque<Impact>>,
    /// Number of contacts before the present slot.
    contacts: u32,
    revision: u64,
    /// Result of the last [`Motion::pose`], with the revision and the instant for which it is valid. Cached because the
    /// sensors of a robot measure at the same instants.
    last_pose: Option<(u64, Time, Pose)>,
    /// Cached unit vector of a heading, with that heading.
    cached_forward: (Heading, DVec2),
    /// Result of the last [`Motion::drive_end`], with the revision for which it is valid.
    drive_end: Option<(u64, Option<Time>)>,
    /// The feet of a robot with legs.
    walk: Option<Box<Walk>>,
}

impl Motion {
    /// Motion of a robot that rests from the start of the run, with its centre at `world_from_robot`; odometry is 0.
    ///
    /// The model must have passed [`Model::check`].
    pub fn new(id: RobotId, model: Arc<Model>, walls: Arc<Walls>, world_from_robot: Pose) -> Self {
        let state = State { world_from_axle: axle_of(&model, &world_from_robot), ..State::default() };
        let commands = CommandState { active: ActiveCommand::Idle, steering: 0.0, controllers: Rare::DEFAULT };
        let vehicle = Vehicle { model, errors: None, contact: ContactRule::Stall, hull: None };
        let stage = Stage::open(&vehicle, Time::ZERO, state, commands, Actuation::REST, &[], Slowdown::NONE);
        Self::from_stage(id, vehicle, walls, stage)
    }

    /// Motion with the single stage `stage` and without a past.
    fn from_stage(id: RobotId, vehicle: Vehicle, walls: Arc<Walls>, stage: Stage) -> Self {
        Self {
            id,
            vehicle,
            walls,
            stages: VecDeque::from([stage]),
            journal: Vec::new(),
            committed: Time::ZERO,
            object_impacts: Vec::new(),
            touched_objects: Vec::new(),
            log: Some(VecDeque::new()),
            contacts: 0,
            revision: 0,
            last_pose: None,
            cached_forward: (Heading::default(), Heading::default().direction()),
            drive_end: None,
            walk: None,
        }
    }

    /// Returns this motion, which must have no command yet, for a robot that enters the world at `start` instead of at
    /// the start of the run.
    pub fn starting_at(mut self, start: Time) -> Self {
        self.stages.iter_mut().for_each(|stage| stage.piece.start = start);
        self.committed = start;
        self
    }

    /// Returns this motion without a log of its impacts: [`Motion::impacts`] then returns only those of the present
    /// slot. Saves memory for a robot without bumpers.
    pub fn without_impact_log(mut self) -> Self {
        self.log = None;
        self
    }

    /// Adds an imperfection to this motion, which must have no command yet. The random numbers are those of a run with
    /// `seed`.
    ///
    /// # Errors
    /// [`ModelError`] with the first number of the imperfection that is out of range.
    pub fn with_imperfection(mut self, seed: u64, imperfection: Imperfection) -> Result<Self, ModelError> {
        imperfection.check()?;
        self.vehicle.errors = MotionErrors::unless_perfect(imperfection, seed, self.id);
        Ok(self)
    }

    /// Sets the contact rule of this motion, which must have no command yet. For a robot with legs the rule is always
    /// [`ContactRule::Stall`].
    ///
    /// # Errors
    /// [`ModelError`] for a friction that is negative or not finite.
    pub fn with_contact(mut self, rule: ContactRule) -> Result<Self, ModelError> {
        if let ContactRule::Slide { friction } = rule
            && !(friction.is_finite() && friction >= 0.0)
        {
            return Err(ModelError { field: "friction", value: friction, accepted: "0 or more" });
        }
        let has_legs = self.vehicle.model.kind == DriveKind::Legged;
        self.vehicle.contact = if has_legs { ContactRule::Stall } else { rule };
        Ok(self)
    }

    /// Adds a hull to this motion, which must have no command yet, of a robot with [`DriveKind::Thrusters`] in the
    /// water. The robot is at rest, with its frame `height` metres above the floor. Its contact rule must be
    /// [`ContactRule::Slide`].
    ///
    /// # Errors
    /// [`ModelError`] with the first number of the hull that is out of range.
    pub fn with_hull(mut self, hull: Hull, height: f64) -> Result<Self, ModelError> {
        hull.check(&self.vehicle.model)?;
        self.vehicle.hull = Some(hull);
        for stage in &mut self.stages {
            stage.actuation_before.memory.hull.height = height.clamp(0.0, hull.ceiling);
            stage.actuation.memory.hull = stage.actuation_before.memory.hull;
        }
        Ok(self)
    }

    /// The robot's hull, if it is in the water.
    pub fn hull(&self) -> Option<&Hull> {
        self.vehicle.hull.as_ref()
    }

    /// Behaviour of the body when it is pushed against a wall.
    pub fn contact_rule(&self) -> ContactRule {
        self.vehicle.contact
    }

    /// Replaces the imperfection from `at` on; `at` must be the start of the present slot. The random numbers are those
    /// of a run with `seed`.
    ///
    /// # Errors
    /// [`ModelError`] with the first number of the imperfection that is out of range; nothing changes then.
    pub fn set_imperfection(&mut self, at: Time, seed: u64, imperfection: Imperfection) -> Result<(), ModelError> {
        imperfection.check()?;
        // The motion before `at` must be computed with the old errors.
        let index = self.index_at(at);
        let stage = &self.stages[index];
        let at = at.max(stage.piece.start);
        let (state, commands, actuation_before) = (
            stage.state(&self.vehicle.model, at),
            stage.commands_at(at),
            stage.actuation_before(&self.vehicle.model, at),
        );
        let (slowdown, is_placed) = (stage.slowdown, stage.is_placed && stage.piece.start == at);
        let blocker = stage.blocker().filter(|_| stage.piece.has_ended(at));
        self.vehicle.errors = MotionErrors::unless_perfect(imperfection, seed, self.id);
        let mut next = Stage::open(&self.vehicle, at, state, commands, actuation_before, &[], slowdown);
        if let Some(blocker) = blocker {
            // Only a new command can free the body from its blocker.
            next.stop(0.0, blocker, false);
        }
        next.is_placed = is_placed;
        self.stages.truncate(if self.stages[index].piece.start == at { index } else { index + 1 });
        self.stages.push_back(next);
        self.revision += 1;
        Ok(())
    }

    /// The robot of this motion.
    pub fn id(&self) -> RobotId {
        self.id
    }

    /// Constant properties of drive and body.
    pub fn model(&self) -> &Model {
        &self.vehicle.model
    }

    /// Errors of motion and odometry.
    pub fn imperfection(&self) -> Imperfection {
        self.vehicle.errors.as_ref().map(|errors| errors.imperfection).unwrap_or_default()
    }

    /// Number of changes of the plan, such as commands, placements, and contacts with robots or objects. While this
    /// number is constant, queries about the future give constant results.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Applies a command at `at`, which must not precede the last command. `touching` are the bodies of other robots
    /// that may be in contact, from [`World::touching`](crate::world::World::touching). If the command would approach
    /// one of these bodies, the robot is blocked at once.
    ///
    /// # Errors
    /// A [`CommandError`] for a command that this drive cannot carry out; nothing changes then.
    pub fn command(&mut self, at: Time, command: Command, touching: &[Body]) -> Result<(), CommandError> {
        self.input(at, Input::Command(command), touching)
    }

    /// Starts the PI controllers at `at`. They have an effect only if the wheels have a lag.
    ///
    /// # Errors
    /// [`CommandError::Controller`] for gains that are not [valid](Gains::is_valid).
    pub fn start_control(&mut self, at: Time, gains: Gains) -> Result<(), CommandError> {
        if !gains.is_valid() {
            return Err(CommandError::Controller);
        }
        self.input(at, Input::Control(Some(gains)), &[])
    }

    /// Stops the PI controllers at `at`; from then on the wheels follow their command in open loop.
    pub fn stop_control(&mut self, at: Time) {
        // This input is never rejected.
        let _ = self.input(at, Input::Control(None), &[]);
    }

    /// Starts the PID controller of a wheel at `at`, for [`Command::WheelSpeed`]. It has an effect only if the wheels
    /// have a lag.
    ///
    /// # Errors
    /// [`CommandError::NoWheel`], or [`CommandError::Controller`] for factors that are not [valid](Pid::is_valid).
    pub fn start_wheel_control(&mut self, at: Time, wheel: usize, pid: Pid) -> Result<(), CommandError> {
        check_wheel(&self.vehicle.model, wheel)?;
        if !pid.is_valid() {
            return Err(CommandError::Controller);
        }
        self.input(at, Input::WheelControl(wheel, Some(pid)), &[])
    }

    /// Stops the PID controller of a wheel at `at`; from then on the wheel follows its command in open loop.
    ///
    /// # Errors
    /// [`CommandError::NoWheel`].
    pub fn stop_wheel_control(&mut self, at: Time, wheel: usize) -> Result<(), CommandError> {
        check_wheel(&self.vehicle.model, wheel)?;
        self.input(at, Input::WheelControl(wheel, None), &[])
    }

    /// Places the robot at `at` with its centre at `world_from_robot`. The robot then rests: its command ends, and the
    /// integrals of its controllers are 0. Odometry, wheel angles, path length, steering angle and the parameters of
    /// the controllers do not change.
    ///
    /// Any pose is accepted. A robot that is placed inside a wall or another body is in contact and can move out of it.
    /// The robot touches nothing between the old and the new position. Other robots see the new pose from the next slot
    /// on. If the placement does not come from the robot's own program, it must happen at the end of the slot, before
    /// [`World::advance`](crate::world::World::advance).
    ///
    /// # Errors
    /// [`PlacementError`] for a position that is not finite or beyond 10^9 m.
    pub fn place(&mut self, at: Time, world_from_robot: Pose) -> Result<(), PlacementError> {
        world_from_robot.check_placement()?;
        // After this check the input is never rejected.
        let _ = self.input(at, Input::Place(world_from_robot), &[]);
        Ok(())
    }

    /// Sets the odometry pose at `at`; the true pose does not change.
    ///
    /// # Errors
    /// [`CommandError::NotFinite`] for a position that is not finite or beyond 10^12 m.
    pub fn set_odometry(&mut self, at: Time, odometry: Pose) -> Result<(), CommandError> {
        // The negation rejects NaN as well.
        if !(odometry.position.abs().max_element() <= 1e12 && odometry.position.is_finite()) {
            return Err(CommandError::NotFinite);
        }
        self.input(at, Input::Odometry(odometry), &[])
    }

    /// True pose of the robot's centre at `at`.
    pub fn pose(&mut self, at: Time) -> Pose {
        if let Some((revision, time, pose)) = self.last_pose
            && (revision, time) == (self.revision, at)
        {
            return pose;
        }
        let index = self.index_at(at);
        let pose = self.stages[index].centre(&self.vehicle.model, at);
        self.last_pose = Some((self.revision, at, pose));
        pose
    }

    /// Position of the robot's centre at `at`, and the unit vector of its heading.
    pub(crate) fn centre_and_forward(&mut self, at: Time) -> (DVec2, DVec2) {
        let Pose { position, heading } = self.pose(at);
        if self.cached_forward.0 != heading {
            self.cached_forward = (heading, heading.direction());
        }
        (position, self.cached_forward.1)
    }

    /// True pose of the axle's midpoint, wheel angles, odometry and path length at `at`.
    pub fn state(&mut self, at: Time) -> State {
        let index = self.index_at(at);
        self.stages[index].state(&self.vehicle.model, at)
    }

    /// Odometry reading at `at`: the pose of the axle's midpoint according to odometry, rounded to its
    /// [`Resolution`](crate::noise::Resolution).
    pub fn odometry(&mut self, at: Time) -> Pose {
        let odometry = self.state(at).odometry;
        match &self.vehicle.errors {
            Some(errors) => errors.imperfection.resolution.rounded(odometry),
            None => odometry,
        }
    }

    /// Angles of the wheels at `at` since the start of the run, rad.
    pub fn wheel_angles(&mut self, at: Time) -> Wheels {
        self.state(at).wheels
    }

    /// Length of the path of the axle's midpoint until `at`, m.
    pub fn path_length(&mut self, at: Time) -> f64 {
        self.state(at).path_length
    }

    /// Twist of the axle according to odometry at `at`, as `VWGetSpeed` returns it.
    pub fn speed(&mut self, at: Time) -> Twist {
        self.stage_at(at).piece.rates(at).odometry
    }

    /// Steering angle of an Ackermann drive at `at`, rad.
    pub fn steering(&mut self, at: Time) -> f64 {
        self.stage_at(at).commands.steering
    }

    /// Remaining part of the drive in progress at `at`: the arc length, m, or the angle of a turn on the spot, rad. It
    /// is 0 without a drive.
    pub fn drive_remaining(&mut self, at: Time) -> f64 {
        match self.stage_at(at).commands_at(at).active {
            ActiveCommand::Drive { total, remaining, .. } => ActiveCommand::progress(total, remaining).max(0.0),
            _ => 0.0,
        }
    }

    /// Returns true if the drive in progress at `at` turns on the spot.
    pub fn is_drive_turn(&mut self, at: Time) -> bool {
        match self.stage_at(at).commands_at(at).active {
            ActiveCommand::Drive { total, .. } => total.speed() == 0.0 && total.omega != 0.0,
            _ => false,
        }
    }

    /// Returns true if no drive is in progress at `at`: the last drive has reached its target or was replaced, or there
    /// was none.
    pub fn is_drive_done(&mut self, at: Time) -> bool {
        !matches!(self.stage_at(at).commands_at(at).active, ActiveCommand::Drive { .. })
    }

    /// Instant at which the last drive ends or has ended, rounded up to a microsecond. `None` if there is no drive, or
    /// if an obstacle stops the body before the target on the present plan.
    ///
    /// If ticks change a drive for more than 1,000 s (because of random errors or a controller that oscillates), the
    /// result is an instant before the end. The caller must call again at that instant.
    pub fn drive_end(&mut self) -> Option<Time> {
        if let Some((revision, end)) = self.drive_end
            && revision == self.revision
        {
            return end;
        }
        let end = self.find_drive_end();
        match end {
            DriveEnd::At(end) => {
                self.drive_end = Some((self.revision, end));
                end
            }
            DriveEnd::NotBefore(instant) => Some(instant),
        }
    }

    /// Returns true if the drive is stalled at `at`: an obstacle stops the commanded motion, or the wheels slip at a
    /// wall by more than half of their speed (our choice).
    pub fn is_stalled(&mut self, at: Time) -> bool {
        let index = self.index_at(at);
        let stage = &self.stages[index];
        let is_stopped = matches!(stage.piece.cause, Cause::Impact { .. }) && stage.piece.has_ended(at);
        is_stopped || stage.is_slipping(&self.vehicle.model, at)
    }

    /// For each wheel, true if the drive is stalled at `at` and the wheel is commanded to turn.
    pub fn stalled_wheels(&mut self, at: Time) -> [bool; 4] {
        if !self.is_stalled(at) {
            return [false; 4];
        }
        let target = self.stage_at(at).commands.active.target();
        target.wheels(&self.vehicle.model).map(|rate| rate != 0.0)
    }

    /// The contact that stops the body at `at`, or the contact with which its present slide along a wall began.
    pub fn contact(&mut self, at: Time) -> Option<Impact> {
        let model = Arc::clone(&self.vehicle.model);
        let stage = self.stage_at(at);
        if stage.piece.has_ended(at) {
            return stage_impact(&model, stage);
        }
        let (interval, _) = stage.slip(&model, at)?;
        interval_impact(&model, stage, interval)
    }

    /// Slip ratio of the wheels at `at` because of a wall: slip speed over the floor, divided by the speed that the
    /// wheels command. It is 1 if a wall holds the body at rest while the wheels slip. It is 0 without contact, and
    /// with [`ContactRule::Stall`].
    pub fn slip(&mut self, at: Time) -> f64 {
        let index = self.index_at(at);
        self.stages[index].slip(&self.vehicle.model, at).map_or(0.0, |(_, ratio)| ratio)
    }

    /// Returns true if the body or a wheel moves at `at`.
    pub fn is_moving(&mut self, at: Time) -> bool {
        let rates = self.stage_at(at).piece.rates(at);
        !rates.truth.is_zero() || rates.wheels.iter().any(|&rate| rate != 0.0)
    }

    /// Number of contacts until `at`: impacts with obstacles that the body did not touch already. In the present slot,
    /// contacts with objects are not counted.
    pub fn contacts(&mut self, at: Time) -> u32 {
        self.contacts + self.uncommitted_impacts(at).iter().filter(|impact| impact.fresh).count() as u32
    }

    /// The impacts whose `known_at` is between `since` and `until`, both included, in order of time. Before the present
    /// slot only the last 32 new contacts are kept, or [none](Motion::without_impact_log). In the present slot, impacts
    /// with objects are not included.
    pub fn impacts(&mut self, since: Time, until: Time) -> Vec<Impact> {
        let recent = self.uncommitted_impacts(until);
        let is_in_interval = |impact: &Impact| impact.known_at >= since && impact.known_at <= until;
        self.log.iter().flatten().copied().chain(recent).filter(is_in_interval).collect()
    }

    /// The robot that blocks the body at the end of the present plan; `None` if no robot does.
    pub fn blocker(&self) -> Option<RobotId> {
        self.last().blocker().and_then(|obstacle| match obstacle.thing {
            Thing::Robot(id) => Some(id),
            _ => None,
        })
    }

    /// Returns true if [`World::advance`](crate::world::World::advance) must process this motion: the motion has an
    /// input in the present slot, the robot or one of its legs moves, or the robot is blocked by a robot or an object
    /// that may move away.
    pub fn is_active(&self) -> bool {
        let piece = &self.last().piece;
        let rests = piece.rates.truth.is_zero() && piece.rates.wheels == [0.0; 4] || piece.has_ended(self.committed);
        let is_blocked = self.last().blocker().is_some() || self.last().is_held(self.committed);
        let is_walking = self.walk.as_ref().is_some_and(|walk| walk.is_walking());
        !self.journal.is_empty() || !rests || is_walking || is_blocked || self.has_ticks()
    }

    // Functions for [`crate::world`].

    /// Copy of the plan from `at` on, without the past, in the memory of `spare` if there is one. `None` if no tick up
    /// to `until` changes the plan, and for legs and hulls.
    pub(crate) fn plan_at(&mut self, at: Time, until: Time, spare: &mut Option<Box<Self>>) -> Option<Box<Self>> {
        if self.walk.is_some() || self.vehicle.hull.is_some() || self.last().has_no_ticks(&self.vehicle) {
            return None;
        }
        let stage = self.stage_at(at);
        let tick = stage.next_tick();
        if tick <= at || tick > until {
            return None;
        }
        let (stage, vehicle) = (stage.clone(), self.vehicle.clone());
        let Some(mut plan) = spare.take() else {
            return Some(Box::new(Self::from_stage(self.id, vehicle, Arc::clone(&self.walls), stage)));
        };
        plan.stages.clear();
        plan.stages.push_back(stage);
        plan.vehicle = vehicle;
        Some(plan)
    }

    /// Address ranges of the heap memory that commands and queries access: the heads of the earlier stages, the last
    /// stage and, in most cases, the place of the next one.
    pub(crate) fn hot_memory(&self) -> impl Iterator<Item = Range<*const u8>> {
        let earlier = self.stages.len() - 1;
        self.stages.iter().enumerate().map(move |(index, stage)| {
            let start = std::ptr::from_ref(stage).cast::<u8>();
            start..start.wrapping_add(if index < earlier { Stage::HEAD_LEN } else { 2 * size_of::<Stage>() })
        })
    }

    pub(crate) fn radius(&self) -> f64 {
        self.vehicle.model.body_radius
    }

    pub(crate) fn journal(&self) -> &[(Time, Input)] {
        &self.journal
    }

    /// Fills `passages` with the passages of the body from `from` to `to`, in order; `until` of the last one is
    /// [`Time::NEVER`].
    pub(crate) fn passages(&mut self, from: Time, to: Time, passages: &mut Passages) {
        let mut index = self.index_at(from);
        self.index_at(to);
        // `index_at(to)` explores only the stage at `to`, so each earlier stage is explored here up to its successor.
        passages.clear();
        while index < self.stages.len() && (passages.is_empty() || self.stages[index].piece.start <= to) {
            let until = self.stages.get(index + 1).map_or(Time::NEVER, |next| next.piece.start);
            let stage = &mut self.stages[index];
            stage.explore(&self.vehicle, &self.walls, (until.min(to) - stage.piece.start).seconds());
            stage.passages(from, until, to, passages);
            index += 1;
        }
    }

    /// Appends to `passages` the passages of the axle from `from` to `to` according to odometry, in the frame of
    /// odometry.
    pub(crate) fn odometry_passages(&mut self, from: Time, to: Time, passages: &mut Passages) {
        let first = self.index_at(from);
        self.index_at(to);
        let stages = self.stages.iter().skip(first).enumerate();
        let stages = stages.take_while(|(index, stage)| *index == 0 || stage.piece.start <= to);
        passages.extend(stages.map(|(_, stage)| {
            let Piece { start, state, rates, duration, .. } = stage.piece;
            let (path, heading) = (Path::new(&state.odometry, rates.odometry), state.odometry.heading);
            Passage { start, begin: 0.0, until: Time::NEVER, end: duration, path, heading }
        }));
    }

    /// Time and pose of the first setting of the odometry in the present slot.
    pub(crate) fn odometry_set(&self) -> Option<(Time, Pose)> {
        self.journal.iter().find_map(|(at, input)| match input {
            Input::Odometry(pose) => Some((*at, *pose)),
            _ => None,
        })
    }

    /// Stops the body at `obstacle`, `seconds` after `base`, an instant of the present slot. Discards the plan after
    /// that instant.
    pub(crate) fn block(&mut self, base: Time, seconds: f64, obstacle: Obstacle) {
        while self.stages.len() > 1 && (self.last().piece.start - base).seconds() > seconds {
            self.stages.pop_back();
        }
        let stage = self.stages.back_mut().expect("a motion has a stage");
        let stop_after = ((base - stage.piece.start).seconds() + seconds).clamp(0.0, stage.piece.duration);
        stage.stop(stop_after, obstacle, true);
        // If the same robot has stopped the body before, the contact is regarded as the continuation of that contact.
        let last = self.stages.len() - 1;
        let is_same = |stage: &Stage| stage.blocker().is_some_and(|blocker| blocker.thing == obstacle.thing);
        let placement = self.stages.iter().rposition(|stage| stage.is_placed).unwrap_or(0);
        if self.stages.iter().take(last).skip(placement).any(is_same) {
            self.stages[last].stop(stop_after, obstacle, false);
        }
        self.revision += 1;
    }

    /// Applies an input of the journal again.
    pub(crate) fn replay(&mut self, at: Time, input: Input, touching: &[Body]) {
        // The input was accepted before. It can be rejected now, because the steering angle may differ; it then has no
        // effect.
        let _ = self.apply(at, input, touching);
    }

    /// Resumes at `at`, the end of the present slot, a motion that a robot has blocked. Returns false if the motion is
    /// still blocked, or was not blocked by a robot.
    pub(crate) fn resume(&mut self, at: Time, touching: &[Body]) -> bool {
        let index = self.index_at(at);
        let stage = &self.stages[index];
        if stage.blocker().is_none() || !stage.piece.has_ended(at) {
            return false;
        }
        let state = stage.state(&self.vehicle.model, at);
        let commands = stage.commands_at(at);
        let mut next = Stage::open(
            &self.vehicle,
            at,
            state,
            commands,
            stage.actuation_before(&self.vehicle.model, at),
            touching,
            Slowdown::NONE,
        );
        if next.blocker().is_some() {
            return false;
        }
        next.is_placed = stage.is_placed && stage.piece.start == at;
        self.stages.truncate(if stage.piece.start == at { index } else { index + 1 });
        self.stages.push_back(next);
        self.revision += 1;
        true
    }

    /// Ends the present slot at `end` and returns its impacts; from now on the motion before `end` is final.
    pub(crate) fn commit(&mut self, end: Time) -> Vec<Impact> {
        let mut impacts = self.uncommitted_impacts(end);
        impacts.append(&mut self.object_impacts);
        sort_few(&mut impacts, |impact| impact.time);
        self.touched_objects.retain(|(_, last)| *last > end - HISTORY);
        for impact in &mut impacts {
            if !matches!(impact.thing, Thing::Wall(_)) {
                impact.known_at = end;
            }
            self.contacts += u32::from(impact.fresh);
            if let Some(log) = self.log.as_mut().filter(|_| impact.fresh) {
                if log.len() == KEPT_IMPACTS {
                    log.pop_front();
                }
                log.push_back(*impact);
            }
        }
        self.journal.clear();
        self.committed = end;
        if let Some(mut walk) = self.walk.take() {
            walk.commit(self, end);
            self.walk = Some(walk);
        }
        while self.stages.len() > 1 && self.stages[1].piece.start <= end - HISTORY {
            self.stages.pop_front();
        }
        // Contacts in quick succession need more stages. Their memory is freed afterwards, so that the memory of a long
        // run stays constant, and the next stages reuse few cache lines.
        if self.stages.len() < USUAL_STAGES && self.stages.capacity() > USUAL_STAGES {
            self.stages.shrink_to(USUAL_STAGES);
        }
        self.stages[0].drop_intervals_before(end - HISTORY);
        impacts
    }

    /// Ends the present slot at `end`, for a motion for which [`Motion::commit`] would change nothing else.
    pub(crate) fn skip_slot(&mut self, end: Time) {
        self.committed = end;
    }

    /// Returns true if the motion has had no input in the present slot.
    pub(crate) fn is_uncommanded(&self) -> bool {
        self.journal.is_empty()
    }

    /// Lower bound of the end of the piece in force at `from`: no wall, target or tick ends the piece before that
    /// instant. The result is `from` if no better bound is known.
    pub(crate) fn unchanged_until(&mut self, from: Time) -> Time {
        let index = self.index_at(from);
        let stage = &self.stages[index];
        let is_last = index + 1 == self.stages.len();
        if is_last && stage.piece.start <= from { stage.unchanged_until(&self.vehicle).max(from) } else { from }
    }

    /// Drive of the robot at `at`, for the solver of the movable objects.
    pub(crate) fn drive_state(&mut self, at: Time) -> DriveState {
        let model = Arc::clone(&self.vehicle.model);
        let stage = self.stage_at(at);
        let is_held = stage.is_held(at);
        let centre = stage.centre(&model, at);
        let time_to_rest = stage.piece.duration - (at - stage.piece.start).seconds();
        let (twist_without_objects, fraction, time_to_rest) = if is_held {
            (stage.twist_without_objects(&model, at), 0.0, f64::INFINITY)
        } else if time_to_rest <= 0.0 {
            (Twist::ZERO, 1.0, 0.0)
        } else {
            (stage.twist_without_objects(&model, at), stage.slowdown.fraction, time_to_rest)
        };
        DriveState { centre, twist_without_objects, fraction, time_to_rest }
    }

    /// Slows the robot to `fraction` (0 to 1) of its twist from `at` on, an instant of the present slot. A fraction
    /// below 1 means that the robot pushes `obstacle`. Discards the plan after `at`.
    pub(crate) fn slow(&mut self, at: Time, fraction: f64, obstacle: Obstacle) {
        let index = self.index_at(at);
        let stage = &self.stages[index];
        let slowdown = if fraction < 1.0 { Slowdown { fraction, obstacle: Some(obstacle) } } else { Slowdown::NONE };
        let state = stage.state(&self.vehicle.model, at);
        let mut next = Stage::open(
            &self.vehicle,
            at,
            state,
            stage.commands_at(at),
            stage.actuation_before(&self.vehicle.model, at),
            &[],
            slowdown,
        );
        next.is_placed = stage.is_placed && stage.piece.start == at;
        self.stages.truncate(if stage.piece.start == at { index } else { index + 1 });
        self.stages.push_back(next);
        self.revision += 1;
    }

    /// The obstacle that the robot pushes at `at`.
    pub(crate) fn pushed_obstacle(&mut self, at: Time) -> Option<Obstacle> {
        self.stage_at(at).slowdown.obstacle
    }

    /// Records a contact of the body with a movable object at `at`, an instant of the present slot.
    pub(crate) fn record_touch(&mut self, at: Time, object: ObjectId, point: DVec2) {
        let placement = self.stages.iter().rfind(|stage| stage.is_placed && stage.piece.start <= at);
        let known_since = placement.map_or(at - HISTORY, |stage| stage.piece.start.max(at - HISTORY));
        let last = self.touched_objects.iter_mut().find(|(other, _)| *other == object);
        let is_known = last.as_ref().is_some_and(|(_, last)| *last > known_since);
        match last {
            Some((_, last)) => *last = at,
            None => self.touched_objects.push((object, at)),
        }
        if !is_known {
            let towards = self.pose(at).inverse_transform_point(point);
            self.object_impacts.push(Impact {
                time: at,
                known_at: at,
                thing: Thing::Object(object),
                point,
                bearing: math::atan2(towards.y, towards.x),
                fresh: true,
            });
        }
    }

    // Helpers.

    /// Slow-down of the robot just after a command at `at`. A robot that still pushes its obstacle keeps the component
    /// of its velocity along the new path; any other robot moves freely at once.
    fn slowdown_after_command(&self, stage: &Stage, at: Time, next: &Stage) -> Slowdown {
        let Some(obstacle) = stage.slowdown.obstacle else { return Slowdown::NONE };
        let towards = obstacle.point - next.path.origin;
        if stage.slowdown.fraction >= 1.0 || next.path.velocity(0.0).dot(towards) <= APPROACH * towards.length() {
            return Slowdown::NONE;
        }
        let present_fraction = if stage.piece.has_ended(at) { 0.0 } else { stage.slowdown.fraction };
        let projection = self.vehicle.model.projection(stage.unhindered_twist, next.unhindered_twist);
        let fraction = present_fraction * projection;
        Slowdown { fraction: fraction.clamp(0.0, 1.0), obstacle: Some(obstacle) }
    }

    fn last(&self) -> &Stage {
        self.stages.back().expect("a motion has a stage")
    }

    /// Returns true if the next tick after the start of the present slot changes the motion, because of wheel lag,
    /// errors or a hull.
    fn has_ticks(&self) -> bool {
        if self.last().has_no_ticks(&self.vehicle) {
            return false;
        }
        let mut stage = self.last().clone();
        let next_tick = self.committed.max(stage.piece.start) + TICK;
        stage.next(&self.vehicle, &self.walls, next_tick).is_some()
    }

    fn input(&mut self, at: Time, mut input: Input, touching: &[Body]) -> Result<(), CommandError> {
        // The journal stores the drive with its error, so that a replay does not draw the error again.
        if let (Input::Command(Command::Drive { displacement, .. }), Some(errors)) = (&mut input, &self.vehicle.errors)
        {
            *displacement = errors.with_target_error(self.vehicle.model.kind, at, *displacement);
        }
        self.apply(at, input, touching)?;
        self.journal.push((at, input));
        Ok(())
    }

    fn apply(&mut self, at: Time, input: Input, touching: &[Body]) -> Result<(), CommandError> {
        let index = self.index_at(at);
        let stage = &self.stages[index];
        let at = at.max(stage.piece.start);
        let commands_before = stage.commands_at(at);
        let mut state = stage.state(&self.vehicle.model, at);
        let mut actuation_before = stage.actuation_before(&self.vehicle.model, at);
        let commands = match input {
            Input::Command(command) => commands_before.clone().with(&self.vehicle.model, command)?,
            Input::Control(gains) => {
                let mut commands = commands_before.clone();
                commands.controllers.body = gains;
                commands
            }
            Input::WheelControl(wheel, pid) => {
                let mut commands = commands_before.clone();
                commands.controllers.wheels[wheel] = pid;
                commands
            }
            Input::Odometry(pose) => {
                state.odometry = pose;
                commands_before.clone()
            }
            Input::Place(world_from_robot) => {
                state.world_from_axle = axle_of(&self.vehicle.model, &world_from_robot);
                let height = if self.vehicle.hull.is_some() { stage.hull_height(at) } else { 0.0 };
                actuation_before = Actuation::REST;
                if height > 0.0 {
                    actuation_before.memory.hull.height = height;
                }
                CommandState { active: ActiveCommand::Idle, ..commands_before.clone() }
            }
        };
        let is_blocked = stage.blocker().is_some() && stage.piece.has_ended(at);
        let is_same = commands == commands_before && !matches!(commands.active, ActiveCommand::Drive { .. });
        let sets_pose = matches!(input, Input::Odometry(_) | Input::Place(_));
        if is_same && !sets_pose && !is_blocked && touching.is_empty() {
            return Ok(());
        }
        let mut next = Stage::open(&self.vehicle, at, state, commands, actuation_before, touching, Slowdown::NONE);
        let slowdown = self.slowdown_after_command(stage, at, &next);
        if slowdown != Slowdown::NONE {
            next = Stage::open(&self.vehicle, at, state, next.commands, next.actuation_before, touching, slowdown);
        }
        if let Some(blocker) = stage.blocker().filter(|_| is_blocked) {
            match &mut next.piece.cause {
                Cause::Impact { with, fresh } if with.thing == blocker.thing => *fresh = false,
                // Only a command or a placement can free the body from its blocker.
                _ if !matches!(input, Input::Command(_) | Input::Place(_)) => next.stop(0.0, blocker, false),
                _ => {}
            }
        }
        next.is_placed = matches!(input, Input::Place(_)) || stage.is_placed && stage.piece.start == at;
        // The new stage replaces a stage that starts at the same instant, and contains the commands of that stage.
        self.stages.truncate(if stage.piece.start == at { index } else { index + 1 });
        self.stages.push_back(next);
        self.revision += 1;
        Ok(())
    }

    /// The stage in force at `at`; its contacts are known at least up to `at`.
    fn stage_at(&mut self, at: Time) -> &Stage {
        let index = self.index_at(at);
        &self.stages[index]
    }

    /// Index of the stage in force at `at`; its contacts are known at least up to `at`.
    fn index_at(&mut self, at: Time) -> usize {
        loop {
            let last = self.stages.back_mut().expect("a motion has a stage");
            if last.has_no_ticks(&self.vehicle) {
                break;
            }
            match last.next(&self.vehicle, &self.walls, at) {
                Some(next) => self.stages.push_back(next),
                None => break,
            }
        }
        let mut index = self.stages.len() - 1;
        while index > 0 && self.stages[index].piece.start > at {
            index -= 1;
        }
        let stage = &mut self.stages[index];
        stage.explore(&self.vehicle, &self.walls, (at - stage.piece.start).seconds());
        index
    }

    fn find_drive_end(&mut self) -> DriveEnd {
        if !matches!(self.last().commands.active, ActiveCommand::Drive { .. }) {
            return DriveEnd::At(None);
        }
        let last = self.stages.back_mut().expect("a motion has a stage");
        let Some(mut stage) = last.next(&self.vehicle, &self.walls, Time::NEVER) else {
            return DriveEnd::At(last.drive_end(&self.vehicle, &self.walls));
        };
        // The stages at the ticks are not kept, because the caller needs only the instant of the end.
        for _ in 0..MAX_TICKS_AHEAD {
            match stage.next(&self.vehicle, &self.walls, Time::NEVER) {
                Some(next) => stage = next,
                None => return DriveEnd::At(stage.drive_end(&self.vehicle, &self.walls)),
            }
        }
        DriveEnd::NotBefore(stage.piece.start)
    }

    /// Returns true if the body was pressed against the wall of `interval` (an interval of stage `index`) within
    /// [`HISTORY`] before `interval`.
    fn was_pressed_before(&self, index: usize, interval: &MotionInterval) -> bool {
        let wall = interval.pressed_wall.map(|(wall, _)| wall);
        let start = self.stages[index].piece.start;
        for (stage_index, stage) in self.stages.iter().enumerate().take(index + 1).rev() {
            // Start of the interval and end of `stage`, both in seconds after the start of `stage`.
            let begin = (start - stage.piece.start).seconds() + interval.begin;
            let stage_end = if stage_index == index {
                begin
            } else {
                (self.stages[stage_index + 1].piece.start - stage.piece.start).seconds()
            };
            let since = begin - HISTORY.seconds();
            let is_same = |earlier: &MotionInterval| {
                let end = (earlier.begin + earlier.duration).min(stage.piece.duration).min(stage_end);
                earlier.pressed_wall.map(|(wall, _)| wall) == wall && earlier.begin < stage_end && end >= since
            };
            if stage.intervals.iter().any(is_same) {
                return true;
            }
            if stage.is_placed || since > 0.0 {
                return false;
            }
        }
        false
    }

    /// The impacts with walls and robots in the present slot up to `until`.
    fn uncommitted_impacts(&mut self, until: Time) -> Vec<Impact> {
        self.index_at(until);
        let mut impacts = Vec::new();
        // Stages that ended before the slot have no new impact. They are not read, because their memory is not in the
        // cache.
        let first = self.stages.iter().rposition(|stage| stage.piece.start < self.committed).unwrap_or(0);
        for (index, stage) in self.stages.iter().enumerate().skip(first) {
            let piece = &stage.piece;
            let stage_end = self.stages.get(index + 1).map_or(until, |next| next.piece.start.min(until));
            let is_new = piece.start >= self.committed || !piece.has_ended(self.committed);
            if piece.start <= until {
                let is_known = |interval: &&MotionInterval| {
                    (self.committed - piece.start).seconds() >= interval.begin && piece.start < self.committed
                };
                let has_begun = |interval: &&MotionInterval| (stage_end - piece.start).seconds() >= interval.begin;
                let intervals = stage.intervals.iter().skip_while(is_known).take_while(has_begun);
                for interval in intervals {
                    let Some(impact) = interval_impact(&self.vehicle.model, stage, interval) else { continue };
                    let fresh = impact.fresh && !self.was_pressed_before(index, interval);
                    impacts.push(Impact { fresh, ..impact });
                }
            }
            if piece.start <= until && is_new && piece.has_ended(stage_end) {
                impacts.extend(stage_impact(&self.vehicle.model, stage));
            }
        }
        impacts
    }
}

/// Result of the search for a drive's end.
enum DriveEnd {
    /// The drive ends at this instant, or never on the present plan.
    At(Option<Time>),
    /// The drive does not end before this instant.
    NotBefore(Time),
}

/// The impact that ends a stage.
fn stage_impact(model: &Model, stage: &Stage) -> Option<Impact> {
    let Cause::Impact { with, fresh } = stage.piece.cause else { return None };
    let world_from_robot = stage.centre_after(model, stage.piece.duration);
    let towards = world_from_robot.inverse_transform_point(with.point);
    Some(Impact {
        time: stage.piece.end(),
        known_at: stage.piece.end(),
        thing: with.thing,
        point: with.point,
        bearing: math::atan2(towards.y, towards.x),
        fresh,
    })
}

/// The contact with which an interval begins.
fn interval_impact(model: &Model, stage: &Stage, interval: &MotionInterval) -> Option<Impact> {
    let (wall, point) = interval.pressed_wall?;
    let towards = stage.centre_after(model, interval.begin).inverse_transform_point(point);
    let time = stage.piece.start + Time::from_seconds_ceil(interval.begin);
    Some(Impact {
        time,
        known_at: time,
        thing: Thing::Wall(wall),
        point,
        bearing: math::atan2(towards.y, towards.x),
        fresh: interval.is_fresh,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::model::tests::model;

    #[test]
    fn many_commands_in_a_slot_leave_no_memory_behind() {
        let model = Arc::new(model(DriveKind::Differential));
        let mut motion = Motion::new(RobotId(1), model, Arc::new(Walls::new(Vec::new())), Pose::default());
        let mut end = Time::ZERO;
        for commands in [40, 1, 1, 1, 1] {
            for number in 0..commands {
                let twist = Twist { vx: 0.1, vy: 0.0, omega: 0.01 * f64::from(number) };
                motion.command(end + Time::from_millis(number.into()), Command::Twist(twist), &[]).unwrap();
            }
            end += Time::from_millis(50);
            motion.commit(end);
        }
        assert!(motion.stages.capacity() <= USUAL_STAGES, "{} stages", motion.stages.capacity());
    }
}
