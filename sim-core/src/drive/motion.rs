//! A robot's motion: the chain of its pieces, from the commands that it is given.

mod legs;

use std::{collections::VecDeque, sync::Arc};

use glam::DVec2;

use super::{
    HISTORY,
    command::{Command, CommandError, Orders, Pending, check_wheel},
    control::{Actuation, Controllers, Gains, Pid},
    hull::{Afloat, Hull},
    imperfection::{ContactRule, Errors, Imperfection, Vehicle},
    legged::Walk,
    model::{DriveKind, Model, ModelError, Wheels},
    piece::{Cause, State},
    stage::{Grip, Leg, Stage, axle_of},
};
use crate::{
    ObjectId, RobotId,
    contact::{APPROACH, Body, Obstacle, Pace, Path, Thing},
    math,
    pose::{Heading, PlacementError, Pose, Twist},
    scene::Walls,
    time::{TICK, Time},
};

/// Number of impacts that a motion remembers.
const IMPACTS: usize = 32;

/// Ticks that [`Motion::drive_end`] looks ahead at most while wheels with a lag are not settled: 1,000 s.
const LOOK_AHEAD: usize = 100_000;

/// A body's contact with an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// The first microsecond not before it.
    pub time: Time,
    /// From when on the robot's program can know of it: `time`, or for an impact with a robot the end of its slot, at
    /// which it was found.
    pub known: Time,
    /// What was met.
    pub thing: Thing,
    /// The touched point, in the world.
    pub point: DVec2,
    /// Direction of the touched point from the robot's centre, in the robot's frame, rad counter-clockwise from ahead.
    pub bearing: f64,
    /// False when the contact goes on: the body touched the wall already as it set off, or was stopped by the same robot
    /// within the last 100 ms.
    pub fresh: bool,
}

/// What the program of a robot does to its motion, in the order of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Input {
    Command(Command),
    Odometry(Pose),
    Control(Option<Gains>),
    WheelControl(usize, Option<Pid>),
    /// Pose of the robot's centre.
    Place(Pose),
}

/// A disc on a path from `begin` seconds after `start` on, at rest from `after` seconds after `start` on, until `until`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Passage {
    pub start: Time,
    pub begin: f64,
    pub until: Time,
    pub after: f64,
    pub path: Path,
    /// Of the robot at the start.
    pub heading: Heading,
}

impl Passage {
    /// Seconds that the disc has moved at `at`.
    pub fn elapsed(&self, at: Time) -> f64 {
        ((at - self.start).seconds().min(self.after) - self.begin).max(0.0)
    }

    /// True when the disc has come to rest at `at`.
    pub fn has_ended(&self, at: Time) -> bool {
        (at - self.start).seconds() >= self.after
    }

    /// The first microsecond not before its beginning.
    pub fn since(&self) -> Time {
        if self.begin == 0.0 { self.start } else { self.start + Time::from_seconds_ceil(self.begin) }
    }

    /// A stretch of constant twist: its start, the pose then, the twist and how long it lasts, s. It is the passage from its beginning on;
    /// where that slides along a wall, what leads between its poses at `from` and `to`.
    pub fn stretch(&self, from: Time, to: Time) -> (Time, Pose, Twist, f64) {
        if self.path.pace == Pace::Even {
            let start = self.since();
            return (start, self.pose(start), self.path.twist, self.after - self.begin);
        }
        let start = from.max(self.since());
        let to = to.min(self.until).max(start + Time(1));
        let pose = self.pose(start);
        let chord = pose.inverse_transform_point(self.centre(to));
        let after = (self.elapsed(to) - self.elapsed(start)).max(1e-6);
        let angle = self.path.omega() * after;
        // The circle through both places: the inverse of `Pose::moved`.
        let (s, c) = (math::sinc(angle), math::cosc(angle));
        let whole = (s * s + c * c) * after;
        let twist = Twist {
            vx: (chord.x * s + chord.y * c) / whole,
            vy: (chord.y * s - chord.x * c) / whole,
            omega: self.path.omega(),
        };
        (start, pose, twist, after)
    }

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

/// How a robot goes on its own path at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Thrust {
    /// Pose of its centre.
    pub centre: Pose,
    /// The twist of its centre that is ordered, in its own frame.
    pub ordered: Twist,
    /// The share of it with which it goes.
    pub share: f64,
    /// Seconds until it comes to rest by itself; infinite for none.
    pub left: f64,
}

/// The motion of one robot in a static world, as a function of virtual time, with what it has been commanded.
///
/// Instants that are asked for lie at most [`HISTORY`] before the present slot; those ahead are answered by the present
/// plan.
#[derive(Clone, Debug)]
pub struct Motion {
    id: RobotId,
    vehicle: Vehicle,
    walls: Arc<Walls>,
    /// Never empty; in ascending order of their starts.
    stages: VecDeque<Stage>,
    /// Inputs since the start of the slot.
    journal: Vec<(Time, Input)>,
    /// Start of the present slot: impacts before it are in the log.
    committed: Time,
    /// Contacts with movable objects since then.
    touches: Vec<Impact>,
    /// When each movable object was touched last, of those of the last 100 ms.
    touched: Vec<(ObjectId, Time)>,
    log: VecDeque<Impact>,
    contacts: u32,
    revision: u64,
    /// Revision and answer of the last [`Motion::drive_end`].
    drive_end: Option<(u64, Option<Time>)>,
    /// The feet of a robot with legs.
    walk: Option<Box<Walk>>,
}

impl Motion {
    /// A robot at rest at `world_from_robot`, the pose of its centre, at the start of the run; odometry at 0.
    ///
    /// The model must have passed [`Model::check`].
    pub fn new(id: RobotId, model: Arc<Model>, walls: Arc<Walls>, world_from_robot: Pose) -> Self {
        let state = State { world_from_axle: axle_of(&model, &world_from_robot), ..State::default() };
        let orders = Orders { pending: Pending::Idle, steering: 0.0, controllers: Controllers::default() };
        let vehicle = Vehicle { model, errors: None, contact: ContactRule::Stall, hull: None };
        let stage = Stage::open(&vehicle, Time::ZERO, state, orders, Actuation::default(), &[], Grip::FREE);
        Self {
            id,
            vehicle,
            walls,
            stages: VecDeque::from([stage]),
            journal: Vec::new(),
            committed: Time::ZERO,
            touches: Vec::new(),
            touched: Vec::new(),
            log: VecDeque::new(),
            contacts: 0,
            revision: 0,
            drive_end: None,
            walk: None,
        }
    }

    /// This motion, not yet commanded, of a robot that comes into the world at `start`, not at the start of the run.
    pub fn starting_at(mut self, start: Time) -> Self {
        self.stages.iter_mut().for_each(|stage| stage.piece.start = start);
        self.committed = start;
        self
    }

    /// This motion, not yet commanded, with an imperfection whose random numbers are those of a run with `seed`.
    ///
    /// # Errors
    /// The first number of the imperfection that makes no sense.
    pub fn with_imperfection(mut self, seed: u64, imperfection: Imperfection) -> Result<Self, ModelError> {
        imperfection.check()?;
        self.vehicle.errors = Errors::unless_perfect(imperfection, seed, self.id);
        Ok(self)
    }

    /// This motion, not yet commanded, with this rule for what happens at walls; a robot with legs stalls whatever it is.
    ///
    /// # Errors
    /// A friction that is negative or not finite.
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

    /// This motion, not yet commanded, of a robot with [`DriveKind::Thrusters`] in the water: at rest, its frame `lift` metres
    /// above the floor. At walls it slides.
    ///
    /// # Errors
    /// The first number of the hull that makes no sense.
    pub fn with_hull(mut self, hull: Hull, lift: f64) -> Result<Self, ModelError> {
        hull.check(&self.vehicle.model)?;
        self.vehicle.hull = Some(hull);
        for stage in &mut self.stages {
            stage.before.afloat.lift = lift.clamp(0.0, hull.ceiling);
            stage.during.afloat = stage.before.afloat;
        }
        Ok(self)
    }

    /// The robot's hull, if it is in the water.
    pub fn hull(&self) -> Option<&Hull> {
        self.vehicle.hull.as_ref()
    }

    /// What happens when the body is pushed against a wall.
    pub fn contact_rule(&self) -> ContactRule {
        self.vehicle.contact
    }

    /// From `at` on, the start of the present slot, it has this imperfection, whose random numbers are those of a run with `seed`.
    ///
    /// # Errors
    /// The first number of the imperfection that makes no sense; nothing changes then.
    pub fn set_imperfection(&mut self, at: Time, seed: u64, imperfection: Imperfection) -> Result<(), ModelError> {
        imperfection.check()?;
        // What has been until now is planned with the errors that there were.
        let index = self.index_at(at);
        let stage = &self.stages[index];
        let at = at.max(stage.piece.start);
        let (state, orders, before) =
            (stage.state(&self.vehicle.model, at), stage.orders_at(at), stage.actuation_before(&self.vehicle.model, at));
        let (grip, is_placed) = (stage.grip, stage.is_placed && stage.piece.start == at);
        let blocker = stage.blocker().filter(|_| stage.piece.has_ended(at));
        self.vehicle.errors = Errors::unless_perfect(imperfection, seed, self.id);
        let mut next = Stage::open(&self.vehicle, at, state, orders, before, &[], grip);
        if let Some(blocker) = blocker {
            // Only a command tries to get past.
            next.stop(0.0, blocker, false);
        }
        next.is_placed = is_placed;
        self.stages.truncate(if self.stages[index].piece.start == at { index } else { index + 1 });
        self.stages.push_back(next);
        self.revision += 1;
        Ok(())
    }

    /// Whose motion it is.
    pub fn id(&self) -> RobotId {
        self.id
    }

    /// The constant facts of the drive and body.
    pub fn model(&self) -> &Model {
        &self.vehicle.model
    }

    /// How far the motion is from perfect.
    pub fn imperfection(&self) -> Imperfection {
        self.vehicle.errors.as_ref().map(|errors| errors.imperfection).unwrap_or_default()
    }

    /// Counts the changes of the plan by commands, and by contacts with other robots when the world advances: as long as
    /// it stays, so do all answers about the future.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Takes a command at `at`, not before the one before. `touching`: the bodies of the other robots that may be in
    /// contact, from [`World::touching`](crate::world::World::touching); the command is blocked at once by one that it
    /// would approach.
    ///
    /// # Errors
    /// A [`CommandError`] for a command that this drive cannot obey; nothing changes then.
    pub fn command(&mut self, at: Time, command: Command, touching: &[Body]) -> Result<(), CommandError> {
        self.input(at, Input::Command(command), touching)
    }

    /// Starts the PI controllers at `at`; they have something to do only with a lag of the wheels.
    ///
    /// # Errors
    /// [`CommandError::NotFinite`] for gains that are not [valid](Gains::is_valid).
    pub fn start_control(&mut self, at: Time, gains: Gains) -> Result<(), CommandError> {
        if !gains.is_valid() {
            return Err(CommandError::NotFinite);
        }
        self.input(at, Input::Control(Some(gains)), &[])
    }

    /// Stops the PI controllers at `at`: the wheels follow what is commanded, open loop.
    pub fn stop_control(&mut self, at: Time) {
        // Nothing to refuse.
        let _ = self.input(at, Input::Control(None), &[]);
    }

    /// Starts the PID controller of a wheel at `at`, for [`Command::WheelSpeed`]; it has something to do only with a lag of
    /// the wheels.
    ///
    /// # Errors
    /// [`CommandError::NoWheel`], or [`CommandError::NotFinite`] for factors that are not [valid](Pid::is_valid).
    pub fn start_wheel_control(&mut self, at: Time, wheel: usize, pid: Pid) -> Result<(), CommandError> {
        check_wheel(&self.vehicle.model, wheel)?;
        if !pid.is_valid() {
            return Err(CommandError::NotFinite);
        }
        self.input(at, Input::WheelControl(wheel, Some(pid)), &[])
    }

    /// Stops the PID controller of a wheel at `at`: it follows what is commanded, open loop.
    ///
    /// # Errors
    /// [`CommandError::NoWheel`].
    pub fn stop_wheel_control(&mut self, at: Time, wheel: usize) -> Result<(), CommandError> {
        check_wheel(&self.vehicle.model, wheel)?;
        self.input(at, Input::WheelControl(wheel, None), &[])
    }

    /// Puts the robot at `world_from_robot`, the true pose of its centre, at `at`: at rest, its command ended and the sums of
    /// its controllers at 0. Odometry, wheel angles and path length stay as they are, so do steering and controllers.
    ///
    /// Any place will do: in a wall or another body it stands in contact, and may leave. Nothing on the way is touched.
    /// The others see it there from the next slot on. By another robot than itself it is placed at the end of the slot,
    /// before [`World::advance`](crate::world::World::advance).
    ///
    /// # Errors
    /// [`PlacementError`] for a position that is not finite or beyond 10^9 m.
    pub fn place(&mut self, at: Time, world_from_robot: Pose) -> Result<(), PlacementError> {
        world_from_robot.check_placement()?;
        // Nothing else to refuse.
        let _ = self.input(at, Input::Place(world_from_robot), &[]);
        Ok(())
    }

    /// Sets what the robot believes its pose to be at `at`; the true pose stays.
    ///
    /// # Errors
    /// [`CommandError::NotFinite`] for a position that is not finite or beyond 10^12 m.
    pub fn set_odometry(&mut self, at: Time, odometry: Pose) -> Result<(), CommandError> {
        // Negated, so that NaN is refused as well.
        if !(odometry.position.abs().max_element() <= 1e12 && odometry.position.is_finite()) {
            return Err(CommandError::NotFinite);
        }
        self.input(at, Input::Odometry(odometry), &[])
    }

    /// True pose of the robot's centre at `at`.
    pub fn pose(&mut self, at: Time) -> Pose {
        let index = self.index_at(at);
        self.stages[index].centre(&self.vehicle.model, at)
    }

    /// True pose of the axle's midpoint, wheel angles, odometry and path length at `at`.
    pub fn state(&mut self, at: Time) -> State {
        let index = self.index_at(at);
        self.stages[index].state(&self.vehicle.model, at)
    }

    /// The pose of the axle's midpoint that the robot believes in at `at`, as it is read: in the steps of its
    /// [`Resolution`](crate::noise::Resolution).
    pub fn odometry(&mut self, at: Time) -> Pose {
        let odometry = self.state(at).odometry;
        match &self.vehicle.errors {
            Some(errors) => errors.imperfection.resolution.read(odometry),
            None => odometry,
        }
    }

    /// Angles of the wheels at `at` since the start of the run, rad.
    pub fn wheel_angles(&mut self, at: Time) -> Wheels {
        self.state(at).wheels
    }

    /// Length of the path of the axle's midpoint until `at`, m.
    pub fn path_length(&mut self, at: Time) -> f64 {
        self.state(at).path
    }

    /// The twist that odometry takes from the wheels at `at`: what `VWGetSpeed` reads.
    pub fn speed(&mut self, at: Time) -> Twist {
        self.stage_at(at).piece.rates(at).odometry
    }

    /// Steering angle of an Ackermann drive at `at`, rad.
    pub fn steering(&mut self, at: Time) -> f64 {
        self.stage_at(at).orders.steering
    }

    /// What the drive in progress still has to cover at `at`: arc length, m, or for a turn on the spot its angle, rad;
    /// 0 without a drive.
    pub fn drive_remaining(&mut self, at: Time) -> f64 {
        match self.stage_at(at).orders_at(at).pending {
            Pending::Drive { whole, remaining, .. } => Pending::progress(whole, remaining).max(0.0),
            _ => 0.0,
        }
    }

    /// True at `at` while a drive is in progress that turns on the spot.
    pub fn is_drive_turn(&mut self, at: Time) -> bool {
        match self.stage_at(at).orders_at(at).pending {
            Pending::Drive { whole, .. } => whole.speed() == 0.0 && whole.omega != 0.0,
            _ => false,
        }
    }

    /// True at `at` when no drive is in progress: it has reached its mark, or was replaced, or none was commanded.
    pub fn is_drive_done(&mut self, at: Time) -> bool {
        !matches!(self.stage_at(at).orders_at(at).pending, Pending::Drive { .. })
    }

    /// The first microsecond at which the last drive is done, in the past if it is; `None` without one, or when it does not end on the
    /// present plan because the body is stopped before.
    ///
    /// A drive of more than 1,000 s with ticks all the way (errors that are drawn, a controller that oscillates) is answered
    /// by an earlier instant: ask again then.
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
            DriveEnd::After(instant) => Some(instant),
        }
    }

    /// True at `at` when the body is stopped by an obstacle with a command that it cannot obey, or when its wheels slip at a wall
    /// by more than half of the speed that they are to give it (our choice).
    pub fn is_stalled(&mut self, at: Time) -> bool {
        let index = self.index_at(at);
        let stage = &self.stages[index];
        let is_stopped = matches!(stage.piece.cause, Cause::Impact { .. }) && stage.piece.has_ended(at);
        is_stopped || stage.is_slipping(&self.vehicle.model, at)
    }

    /// The wheels that are to turn at `at` and do not move the body, because of an obstacle.
    pub fn stalled_wheels(&mut self, at: Time) -> [bool; 4] {
        if !self.is_stalled(at) {
            return [false; 4];
        }
        let target = self.stage_at(at).orders.pending.target();
        target.wheels(&self.vehicle.model).map(|rate| rate != 0.0)
    }

    /// The contact that stops the body at `at`, or that with which the stretch along a wall began that it slides on or rests at.
    pub fn contact(&mut self, at: Time) -> Option<Impact> {
        let model = Arc::clone(&self.vehicle.model);
        let stage = self.stage_at(at);
        if stage.piece.has_ended(at) {
            return impact_of(&model, stage);
        }
        let (leg, _) = stage.slip(&model, at)?;
        leg_impact(&model, stage, leg)
    }

    /// Share of the speed of its wheels by which they slip over the floor at `at` because of a wall: 0 without one, 1 for a body at
    /// rest.
    pub fn slip(&mut self, at: Time) -> f64 {
        let index = self.index_at(at);
        self.stages[index].slip(&self.vehicle.model, at).map_or(0.0, |(_, share)| share)
    }

    /// True when the body or a wheel moves at `at`.
    pub fn is_moving(&mut self, at: Time) -> bool {
        let rates = self.stage_at(at).piece.rates(at);
        !rates.truth.is_zero() || rates.wheels.iter().any(|&rate| rate != 0.0)
    }

    /// Number of contacts until `at`: impacts with what was not touched already.
    pub fn contacts(&mut self, at: Time) -> u32 {
        self.contacts + self.uncommitted(at).iter().filter(|impact| impact.fresh).count() as u32
    }

    /// The impacts that became known from `since` until `until`, both included, in the order of time: of the last 32
    /// before the present slot, and all within it.
    pub fn impacts(&mut self, since: Time, until: Time) -> Vec<Impact> {
        let recent = self.uncommitted(until);
        let is_asked = |impact: &Impact| impact.known >= since && impact.known <= until;
        self.log.iter().copied().chain(recent).filter(is_asked).collect()
    }

    /// The robot that blocks the body, if one does at the end of the plan made so far.
    pub fn blocker(&self) -> Option<RobotId> {
        self.last().blocker().and_then(|obstacle| match obstacle.thing {
            Thing::Robot(id) => Some(id),
            _ => None,
        })
    }

    /// True when the world has to be given this motion to advance: it has had an input in the present slot, or moves in it,
    /// or waits for another robot or an object to clear its way.
    pub fn is_active(&self) -> bool {
        let piece = &self.last().piece;
        let rests = piece.rates.truth.is_zero() && piece.rates.wheels == [0.0; 4] || piece.has_ended(self.committed);
        let waits = self.last().blocker().is_some() || self.last().is_held(self.committed);
        !self.journal.is_empty() || !rests || waits || self.has_ticks()
    }

    // What follows is for the world.

    pub(crate) fn radius(&self) -> f64 {
        self.vehicle.model.body_radius
    }

    pub(crate) fn journal(&self) -> &[(Time, Input)] {
        &self.journal
    }

    /// The passages of the body's motion that touch the time from `from` to `to`, in order, the last without an end.
    pub(crate) fn passages(&mut self, from: Time, to: Time, passages: &mut Vec<Passage>) {
        let mut first = self.index_at(from);
        self.index_at(to);
        // Exploring the stage at `to` does not reach back; each stage on the way is explored to its successor.
        passages.clear();
        while first < self.stages.len() && (passages.is_empty() || self.stages[first].piece.start <= to) {
            let until = self.stages.get(first + 1).map_or(Time::NEVER, |next| next.piece.start);
            let stage = &mut self.stages[first];
            stage.explore(&self.vehicle, &self.walls, (until.min(to) - stage.piece.start).seconds());
            stage.passages(from, until, to, passages);
            first += 1;
        }
    }

    /// Stops the body at `obstacle` `seconds` after `base`, an instant of the present slot; forgets what was planned after.
    pub(crate) fn block(&mut self, base: Time, seconds: f64, obstacle: Obstacle) {
        while self.stages.len() > 1 && (self.last().piece.start - base).seconds() > seconds {
            self.stages.pop_back();
        }
        let stage = self.stages.back_mut().expect("a motion has a stage");
        let after = ((base - stage.piece.start).seconds() + seconds).clamp(0.0, stage.piece.after);
        stage.stop(after, obstacle, true);
        // A body that tries again and is stopped again by the same robot has been in contact all the time.
        let earlier = self.stages.len() - 1;
        let is_same = |stage: &Stage| stage.blocker().is_some_and(|blocker| blocker.thing == obstacle.thing);
        let placed = self.stages.iter().rposition(|stage| stage.is_placed).unwrap_or(0);
        if self.stages.iter().take(earlier).skip(placed).any(is_same) {
            self.stages[earlier].stop(after, obstacle, false);
        }
        self.revision += 1;
    }

    /// Obeys an input again that is in the journal already.
    pub(crate) fn replay(&mut self, at: Time, input: Input, touching: &[Body]) {
        // It was accepted before; where the steering made the difference it stays refused.
        let _ = self.apply(at, input, touching);
    }

    /// Tries again at `at`, the end of the present slot, to obey what a robot had blocked; false if it still does.
    pub(crate) fn resume(&mut self, at: Time, touching: &[Body]) -> bool {
        let index = self.index_at(at);
        let stage = &self.stages[index];
        if stage.blocker().is_none() || !stage.piece.has_ended(at) {
            return false;
        }
        let state = stage.state(&self.vehicle.model, at);
        let orders = stage.orders_at(at);
        let next = Stage::open(&self.vehicle, at, state, orders, stage.actuation_before(&self.vehicle.model, at), touching, Grip::FREE);
        if next.blocker().is_some() {
            return false;
        }
        self.stages.truncate(index + 1);
        self.stages.push_back(next);
        self.revision += 1;
        true
    }

    /// Ends the present slot at `end`: what has happened in it stands.
    /// Returns the impacts.
    pub(crate) fn commit(&mut self, end: Time) -> Vec<Impact> {
        let mut impacts = self.uncommitted(end);
        impacts.append(&mut self.touches);
        impacts.sort_by_key(|impact| impact.time);
        self.touched.retain(|(_, last)| *last > end - HISTORY);
        for impact in &mut impacts {
            if !matches!(impact.thing, Thing::Wall(_)) {
                impact.known = end;
            }
            self.contacts += u32::from(impact.fresh);
            if self.log.len() == IMPACTS {
                self.log.pop_front();
            }
            self.log.push_back(*impact);
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
        self.stages[0].forget_legs(end - HISTORY);
        impacts
    }

    /// Ends the present slot at `end`, with nothing in it that [`Motion::commit`] would have to see to.
    pub(crate) fn pass(&mut self, end: Time) {
        self.committed = end;
    }

    /// True when the present slot has had no input.
    pub(crate) fn is_uncommanded(&self) -> bool {
        self.journal.is_empty()
    }

    /// Until when, as far as has been looked, the piece of the plan that holds at `from` goes on: no wall, mark or tick ends
    /// it by then. `from` itself where that is not known.
    pub(crate) fn steady_until(&mut self, from: Time) -> Time {
        let index = self.index_at(from);
        let stage = &self.stages[index];
        let is_last = index + 1 == self.stages.len();
        if is_last && stage.piece.start <= from { stage.steady_until(&self.vehicle).max(from) } else { from }
    }

    /// How the robot goes at `at`, for the movable objects in its way.
    pub(crate) fn thrust(&mut self, at: Time) -> Thrust {
        let model = Arc::clone(&self.vehicle.model);
        let stage = self.stage_at(at);
        let is_held = stage.is_held(at);
        let centre = stage.centre(&model, at);
        let left = stage.piece.after - (at - stage.piece.start).seconds();
        let (ordered, share, left) = if is_held {
            (stage.ordered_at_centre(&model, at), 0.0, f64::INFINITY)
        } else if left <= 0.0 {
            (Twist::ZERO, 1.0, 0.0)
        } else {
            (stage.ordered_at_centre(&model, at), stage.grip.share, left)
        };
        Thrust { centre, ordered, share, left }
    }

    /// From `at` on, an instant of the present slot, the robot gets along with `share` of what is ordered, 0 to 1; below 1
    /// because it presses `obstacle`. Forgets what was planned after.
    pub(crate) fn slow(&mut self, at: Time, share: f64, obstacle: Obstacle) {
        let index = self.index_at(at);
        let stage = &self.stages[index];
        let grip = if share < 1.0 { Grip { share, obstacle: Some(obstacle) } } else { Grip::FREE };
        let state = stage.state(&self.vehicle.model, at);
        let mut next =
            Stage::open(&self.vehicle, at, state, stage.orders_at(at), stage.actuation_before(&self.vehicle.model, at), &[], grip);
        next.is_placed = stage.is_placed && stage.piece.start == at;
        self.stages.truncate(if stage.piece.start == at { index } else { index + 1 });
        self.stages.push_back(next);
        self.revision += 1;
    }

    /// What keeps the robot slow at `at`.
    pub(crate) fn pressed(&mut self, at: Time) -> Option<Obstacle> {
        self.stage_at(at).grip.obstacle
    }

    /// The body touches a movable object at `at`, an instant of the present slot.
    pub(crate) fn touch(&mut self, at: Time, object: ObjectId, point: DVec2) {
        let placed = self.stages.iter().rfind(|stage| stage.is_placed && stage.piece.start <= at);
        let known_since = placed.map_or(at - HISTORY, |stage| stage.piece.start.max(at - HISTORY));
        let last = self.touched.iter_mut().find(|(other, _)| *other == object);
        let is_known = last.as_ref().is_some_and(|(_, last)| *last > known_since);
        match last {
            Some((_, last)) => *last = at,
            None => self.touched.push((object, at)),
        }
        if !is_known {
            let towards = self.pose(at).inverse_transform_point(point);
            self.touches.push(Impact {
                time: at,
                known: at,
                thing: Thing::Object(object),
                point,
                bearing: math::atan2(towards.y, towards.x),
                fresh: true,
            });
        }
    }

    // Helpers.

    /// What a command at `at` leaves of the grip of the stage before it: a robot that still presses its obstacle keeps the
    /// speed that it has, along the new path; another one goes at once.
    fn carried_grip(&self, stage: &Stage, at: Time, next: &Stage) -> Grip {
        let Some(obstacle) = stage.grip.obstacle else { return Grip::FREE };
        let towards = obstacle.point - next.path.origin;
        if stage.grip.share >= 1.0 || next.path.velocity(0.0).dot(towards) <= APPROACH * towards.length() {
            return Grip::FREE;
        }
        let present = if stage.piece.has_ended(at) { 0.0 } else { stage.grip.share };
        let share = present * self.vehicle.model.overlap(stage.ordered, next.ordered);
        Grip { share: share.clamp(0.0, 1.0), obstacle: Some(obstacle) }
    }

    fn last(&self) -> &Stage {
        self.stages.back().expect("a motion has a stage")
    }

    /// Wheels with a lag are not settled, or errors go on to change the motion.
    fn has_ticks(&self) -> bool {
        let mut stage = self.last().clone();
        let next_tick = self.committed.max(stage.piece.start) + TICK;
        stage.next(&self.vehicle, &self.walls, next_tick).is_some()
    }

    fn input(&mut self, at: Time, input: Input, touching: &[Body]) -> Result<(), CommandError> {
        self.apply(at, input, touching)?;
        self.journal.push((at, input));
        Ok(())
    }

    fn apply(&mut self, at: Time, input: Input, touching: &[Body]) -> Result<(), CommandError> {
        let index = self.index_at(at);
        let stage = &self.stages[index];
        let at = at.max(stage.piece.start);
        let present = stage.orders_at(at);
        let mut state = stage.state(&self.vehicle.model, at);
        let mut before = stage.actuation_before(&self.vehicle.model, at);
        let orders = match input {
            Input::Command(command) => present.with(&self.vehicle.model, command)?,
            Input::Control(gains) => {
                Orders { controllers: Controllers { body: gains, ..present.controllers }, ..present }
            }
            Input::WheelControl(wheel, pid) => {
                let mut controllers = present.controllers;
                controllers.wheels[wheel] = pid;
                Orders { controllers, ..present }
            }
            Input::Odometry(pose) => {
                state.odometry = pose;
                present
            }
            Input::Place(world_from_robot) => {
                state.world_from_axle = axle_of(&self.vehicle.model, &world_from_robot);
                let lift = if self.vehicle.hull.is_some() { stage.lift(at) } else { 0.0 };
                before = Actuation { afloat: Afloat { lift, ..Afloat::default() }, ..Actuation::default() };
                Orders { pending: Pending::Idle, ..present }
            }
        };
        let is_blocked = stage.blocker().is_some() && stage.piece.has_ended(at);
        let is_same = orders == present && !matches!(orders.pending, Pending::Drive { .. });
        let is_moved = matches!(input, Input::Odometry(_) | Input::Place(_));
        if is_same && !is_moved && !is_blocked && touching.is_empty() {
            return Ok(());
        }
        let mut next = Stage::open(&self.vehicle, at, state, orders, before, touching, Grip::FREE);
        let grip = self.carried_grip(stage, at, &next);
        if grip != Grip::FREE {
            next = Stage::open(&self.vehicle, at, state, orders, before, touching, grip);
        }
        if let Some(blocker) = stage.blocker().filter(|_| is_blocked) {
            match &mut next.piece.cause {
                Cause::Impact { with, fresh } if with.thing == blocker.thing => *fresh = false,
                // Only a command tries to get past.
                _ if !matches!(input, Input::Command(_) | Input::Place(_)) => next.stop(0.0, blocker, false),
                _ => {}
            }
        }
        next.is_placed = matches!(input, Input::Place(_)) || stage.is_placed && stage.piece.start == at;
        // A stage without length has been nothing but its orders, which are in the new one.
        self.stages.truncate(if stage.piece.start == at { index } else { index + 1 });
        self.stages.push_back(next);
        self.revision += 1;
        Ok(())
    }

    /// The stage in force at `at`, with its contacts known at least until then.
    fn stage_at(&mut self, at: Time) -> &Stage {
        let index = self.index_at(at);
        &self.stages[index]
    }

    /// The place of the stage in force at `at`, with its contacts known at least until then.
    fn index_at(&mut self, at: Time) -> usize {
        loop {
            let last = self.stages.back_mut().expect("a motion has a stage");
            match last.next(&self.vehicle, &self.walls, at) {
                Some(next) => self.stages.push_back(next),
                None => break,
            }
        }
        let index = self.stages.iter().rposition(|stage| stage.piece.start <= at).unwrap_or(0);
        let stage = &mut self.stages[index];
        stage.explore(&self.vehicle, &self.walls, (at - stage.piece.start).seconds());
        index
    }

    fn find_drive_end(&mut self) -> DriveEnd {
        if !matches!(self.last().orders.pending, Pending::Drive { .. }) {
            return DriveEnd::At(None);
        }
        let last = self.stages.back_mut().expect("a motion has a stage");
        let Some(mut stage) = last.next(&self.vehicle, &self.walls, Time::NEVER) else {
            return DriveEnd::At(last.drive_end(&self.vehicle, &self.walls));
        };
        // Ticks are run through without keeping them: whoever only waits needs no more than the instant.
        for _ in 0..LOOK_AHEAD {
            match stage.next(&self.vehicle, &self.walls, Time::NEVER) {
                Some(next) => stage = next,
                None => return DriveEnd::At(stage.drive_end(&self.vehicle, &self.walls)),
            }
        }
        DriveEnd::After(stage.piece.start)
    }

    /// Whether the body was pressed against a leg's wall, in stage `index`, within [`HISTORY`] before it.
    fn has_rubbed(&self, index: usize, leg: &Leg) -> bool {
        let wall = leg.against.map(|(wall, _)| wall);
        let start = self.stages[index].piece.start;
        for (place, stage) in self.stages.iter().enumerate().take(index + 1).rev() {
            // In seconds of this stage: when the leg begins, and when the stage is over.
            let begin = (start - stage.piece.start).seconds() + leg.from;
            let over =
                if place == index { begin } else { (self.stages[place + 1].piece.start - stage.piece.start).seconds() };
            let since = begin - HISTORY.seconds();
            let is_same = |earlier: &Leg| {
                let end = (earlier.from + earlier.after).min(stage.piece.after).min(over);
                earlier.against.map(|(wall, _)| wall) == wall && earlier.from < over && end >= since
            };
            if stage.legs.iter().any(is_same) {
                return true;
            }
            if stage.is_placed || since > 0.0 {
                return false;
            }
        }
        false
    }

    /// The impacts of the present slot until `until`.
    fn uncommitted(&mut self, until: Time) -> Vec<Impact> {
        self.index_at(until);
        let mut impacts = Vec::new();
        for (index, stage) in self.stages.iter().enumerate() {
            let piece = &stage.piece;
            let bound = self.stages.get(index + 1).map_or(until, |next| next.piece.start.min(until));
            let is_new = piece.start >= self.committed || !piece.has_ended(self.committed);
            if piece.start <= until {
                let is_known =
                    |leg: &&Leg| (self.committed - piece.start).seconds() >= leg.from && piece.start < self.committed;
                let has_begun = |leg: &&Leg| (bound - piece.start).seconds() >= leg.from;
                let legs = stage.legs.iter().skip_while(is_known).take_while(has_begun);
                for leg in legs {
                    let Some(impact) = leg_impact(&self.vehicle.model, stage, leg) else { continue };
                    let fresh = impact.fresh && !self.has_rubbed(index, leg);
                    impacts.push(Impact { fresh, ..impact });
                }
            }
            if piece.start <= until && is_new && piece.has_ended(bound) {
                impacts.extend(impact_of(&self.vehicle.model, stage));
            }
        }
        impacts
    }
}

/// What a motion can say about the end of its drive.
enum DriveEnd {
    /// It ends then, or not at all.
    At(Option<Time>),
    /// It does not end before.
    After(Time),
}

/// The impact that ends a stage.
fn impact_of(model: &Model, stage: &Stage) -> Option<Impact> {
    let Cause::Impact { with, fresh } = stage.piece.cause else { return None };
    let world_from_robot = stage.centre_after(model, stage.piece.after);
    let towards = world_from_robot.inverse_transform_point(with.point);
    Some(Impact {
        time: stage.piece.end(),
        known: stage.piece.end(),
        thing: with.thing,
        point: with.point,
        bearing: math::atan2(towards.y, towards.x),
        fresh,
    })
}

/// The contact with which a leg begins.
fn leg_impact(model: &Model, stage: &Stage, leg: &Leg) -> Option<Impact> {
    let (wall, point) = leg.against?;
    let towards = stage.centre_after(model, leg.from).inverse_transform_point(point);
    let time = stage.piece.start + Time::from_seconds_ceil(leg.from);
    Some(Impact {
        time,
        known: time,
        thing: Thing::Wall(wall),
        point,
        bearing: math::atan2(towards.y, towards.x),
        fresh: leg.is_fresh,
    })
}
