//! One stage of a plan: a piece of motion, the commands in force, and the walls that the body meets.

use std::mem::offset_of;

use glam::DVec2;

use super::{
    HISTORY,
    command::{ActiveCommand, CommandState},
    control::{self, Actuation},
    hull::Hull,
    imperfection::{ContactRule, DisturbedTwists, Vehicle},
    model::{DriveKind, Model},
    motion::{Passage, Passages},
    piece::{Cause, Piece, Rates, State},
};
use crate::{
    contact::{APPROACH, Body, Obstacle, Pace, Path, Push, SKIN, Slide, TOUCH, Thing, first_contact},
    math,
    pose::{Pose, Twist},
    scene::{Bounds, Segment, WallId, Walls},
    time::{TICK, Time},
};

/// A piece of motion, with the data from which the next stage is computed.
///
/// The fields are laid out in this order, so that the search for a stage and its path at an instant read few cache
/// lines.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Stage {
    /// Path of the centre, without contacts.
    pub path: Path,
    /// Seconds after the start up to which walls have been searched.
    pub explored: f64,
    /// Intervals of the motion from the first contact with a wall on, in order of time, for a body that can slide.
    pub intervals: Vec<MotionInterval>,
    /// True if the stage begins with a placement of the robot. A placement ends all earlier contacts.
    pub is_placed: bool,
    /// True if the motion has random errors, which are valid for this tick only.
    has_random_errors: bool,
    /// True if no later tick changes the motion; for a hull, unless the hull meets a wall or a robot.
    is_steady: bool,
    /// Instant until which the robot moves without errors, because the errors would press the robot against a contact.
    error_free_until: Option<Time>,
    pub piece: Piece,
    pub commands: CommandState,
    /// State of wheels and controllers just before the stage. If another command arrives at the start of the stage,
    /// that command starts from this state.
    pub actuation_before: Actuation,
    /// State of wheels and controllers during the stage.
    pub actuation: Actuation,
    /// True twist of the axle, motion errors included, without movable objects; a robot that pushes an object may be
    /// slower.
    pub unhindered_twist: Twist,
    /// Slow-down by movable objects.
    pub slowdown: Slowdown,
}

/// A part of a stage. It begins at a contact with a wall or at the end of the previous part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MotionInterval {
    /// Seconds from the start of the stage to the start of the interval.
    pub begin: f64,
    /// Duration in seconds; infinite while the end is not known.
    pub duration: f64,
    /// Path of the centre.
    pub path: Path,
    /// Length of the axle's path from the start of the stage to the start of the interval, m.
    pub length_before: f64,
    /// Wall against which the body is pressed, and the touched point.
    pub pressed_wall: Option<(WallId, DVec2)>,
    /// True if the body did not touch the wall before this interval.
    pub is_fresh: bool,
    /// Wall at which the interval ends, if the body did not touch that wall before.
    pub next_wall: Option<WallId>,
}

impl MotionInterval {
    /// Passage of the interval; `stage_passage` is the passage of its stage.
    fn passage(&self, stage_passage: &Passage) -> Passage {
        let end = (self.begin + self.duration).min(stage_passage.end);
        Passage { begin: self.begin, end, path: self.path, ..*stage_passage }
    }

    /// Position of the centre `seconds` after the start of the stage.
    fn position(&self, seconds: f64) -> DVec2 {
        self.path.position((seconds - self.begin).clamp(0.0, self.duration))
    }

    /// Velocity of the centre `seconds` after the start of the stage, in the world, m/s.
    fn velocity(&self, seconds: f64) -> DVec2 {
        self.path.velocity((seconds - self.begin).clamp(0.0, self.duration))
    }
}

/// Slip ratio above which the wheels are regarded as stalled: slip speed divided by the speed that the wheels command.
/// Our choice.
const STALL_SLIP: f64 = 0.5;

/// Number of intervals within [`INTERVAL_WINDOW_S`] after which the body rests. Our choice.
const MAX_INTERVALS: usize = 16;

/// Seconds within which [`MAX_INTERVALS`] intervals cause a rest; also the duration of that rest.
const INTERVAL_WINDOW_S: f64 = 1e-3;

/// Slow-down of a robot by the objects that it pushes; the path stays the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slowdown {
    /// Twist of the robot as a fraction of the twist that it would have without objects, 0 to 1.
    pub fraction: f64,
    /// The obstacle that the robot pushes if `fraction` is below 1.
    pub obstacle: Option<Obstacle>,
}

impl Slowdown {
    /// No slow-down: the robot pushes nothing.
    pub const NONE: Self = Self { fraction: 1.0, obstacle: None };
}

const _: () = assert!(offset_of!(Stage, piece.state.world_from_axle) + size_of::<Pose>() <= Stage::HEAD_LEN);

/// Length of the first search for walls, in seconds of motion; each further search reaches twice as far.
const FIRST_SEARCH: f64 = 0.1;

impl Stage {
    /// Length of the head of a stage, in bytes: its path, its start time and the pose at the start.
    pub const HEAD_LEN: usize = 256;

    /// Stage that follows `commands` from `start` on. It begins with the robot in `state` and its wheels in
    /// `actuation_before`. If the robot would approach a body of `touching`, it is blocked at once.
    pub fn open(
        vehicle: &Vehicle,
        start: Time,
        state: State,
        commands: CommandState,
        actuation_before: Actuation,
        touching: &[Body],
        slowdown: Slowdown,
    ) -> Self {
        let model = &*vehicle.model;
        let actuation = actuate(vehicle, start, &commands, &actuation_before);
        let nominal = nominal_twist(model, &commands, &actuation);
        let disturbed = vehicle.disturbed_twists(start, &commands, &actuation, nominal);
        let (rates, duration, cause) = motion_of(model, &commands, nominal, &disturbed, &actuation, slowdown.fraction);
        let mut stage = Self {
            piece: Piece { start, state, rates, duration, cause },
            commands,
            actuation_before,
            actuation,
            path: Path::resting(DVec2::ZERO),
            unhindered_twist: disturbed.truth,
            slowdown,
            explored: 0.0,
            is_placed: false,
            has_random_errors: disturbed.are_random,
            error_free_until: None,
            is_steady: false,
            intervals: Vec::new(),
        };
        stage.set_path(model);
        let mut obstacle = stage.approached(model.body_radius, touching);
        if obstacle.is_some() && stage.has_motion_errors() {
            // Contacts with robots are found at ends of slots only. So the robot drives without errors for `HISTORY`;
            // contacts that follow each other within `HISTORY` are reported as one.
            stage.suppress_errors(model, start + HISTORY);
            obstacle = stage.approached(model.body_radius, touching);
        }
        if let Some(obstacle) = obstacle {
            stage.stop(0.0, obstacle, true);
        }
        if let Slowdown { fraction: 0.0, obstacle: Some(obstacle) } = slowdown
            && !stage.unhindered_twist.is_zero()
            && !matches!(cause, Cause::Arrived(_))
        {
            stage.stop(0.0, obstacle, false);
        }
        stage
    }

    fn set_path(&mut self, model: &Model) {
        let centre = centre_of(model, &self.piece.state.world_from_axle);
        self.path = Path::new(&centre, self.twist_of_centre(model));
        // Negative if the robot moves, because a contact may stop the motion at its very start.
        self.explored = if self.path.is_resting() { f64::INFINITY } else { -1.0 };
    }

    /// Twist of the centre without contacts, in the robot's frame.
    fn twist_of_centre(&self, model: &Model) -> Twist {
        self.piece.rates.truth.at_offset(DVec2::new(-model.axis_offset, 0.0))
    }

    /// Interval that contains the instant `seconds` after the start of the stage; `None` before the first contact.
    pub fn interval_at(&self, seconds: f64) -> Option<&MotionInterval> {
        let index = self.intervals.partition_point(|interval| interval.begin <= seconds);
        index.checked_sub(1).map(|current| &self.intervals[current])
    }

    /// Seconds from the start of the stage to `at`, clamped to the stage's duration.
    fn seconds_at(&self, at: Time) -> f64 {
        (at - self.piece.start).seconds().clamp(0.0, self.piece.duration.max(0.0))
    }

    /// State at `at`, which must not be before the start. The result depends only on the stage and `at`.
    pub fn state(&self, model: &Model, at: Time) -> State {
        self.state_after(model, (at - self.piece.start).seconds())
    }

    /// State `seconds` after the start.
    fn state_after(&self, model: &Model, seconds: f64) -> State {
        let state = self.piece.state_after(seconds, self.path.direction);
        let seconds = seconds.clamp(0.0, self.piece.duration.max(0.0));
        let Some(interval) = self.interval_at(seconds) else { return state };
        let covered = interval.length_before + self.covered_length(model, interval, seconds - interval.begin);
        let path_length = self.piece.state.path_length + covered;
        State { world_from_axle: axle_of(model, &self.centre_after(model, seconds)), path_length, ..state }
    }

    /// Pose of the robot's centre at `at`, which must not be before the start.
    pub fn centre(&self, model: &Model, at: Time) -> Pose {
        self.centre_after(model, self.seconds_at(at))
    }

    /// Pose of the robot's centre `seconds` after the start.
    pub fn centre_after(&self, model: &Model, seconds: f64) -> Pose {
        let seconds = seconds.clamp(0.0, self.piece.duration.max(0.0));
        let Some(interval) = self.interval_at(seconds) else {
            return centre_of(model, &self.piece.world_from_axle_after(seconds, self.path.direction));
        };
        let heading = self.piece.state.world_from_axle.heading.turned(interval.path.omega() * seconds);
        Pose { position: interval.position(seconds), heading }
    }

    /// Appends the passages of the body from `from` to `to`; `until` is the start of the next stage.
    pub fn passages(&self, from: Time, until: Time, to: Time, passages: &mut Passages) {
        let Piece { start, state, duration, .. } = self.piece;
        let heading = state.world_from_axle.heading;
        let stage_passage = Passage { start, begin: 0.0, until, end: duration, path: self.path, heading };
        if self.intervals.is_empty() {
            passages.push(stage_passage);
            return;
        }
        let seconds = (from - start).seconds();
        let next = self.intervals.partition_point(|interval| interval.begin <= seconds);
        let has_begun = |interval: &&MotionInterval| (to.min(until) - start).seconds() >= interval.begin;
        let current = next.checked_sub(1).map(|current| self.intervals[current].passage(&stage_passage));
        passages.push(current.unwrap_or(stage_passage));
        for interval in self.intervals[next..].iter().take_while(has_begun) {
            let previous = passages.last_mut().expect("one passage has been added");
            previous.until = start + Time::from_seconds_ceil(interval.begin);
            previous.end = interval.begin;
            passages.push(interval.passage(&stage_passage));
        }
    }

    /// Length of the axle's path in the first `seconds` of an interval, m.
    fn covered_length(&self, model: &Model, interval: &MotionInterval, seconds: f64) -> f64 {
        let omega = interval.path.omega();
        let seconds = seconds.min(interval.duration);
        match interval.path.pace {
            Pace::ConstantTwist if interval.pressed_wall.is_none() => self.piece.rates.truth.speed() * seconds,
            Pace::ConstantTwist => (omega * model.axis_offset * seconds).abs(),
            Pace::Sliding { law, .. } if model.axis_offset == 0.0 || omega == 0.0 => law.length(seconds),
            // If the axle is not at the centre, the length has no closed form.
            Pace::Sliding { .. } => {
                let heading = self.piece.state.world_from_axle.heading.turned(omega * interval.begin).direction();
                let speed = |t: f64| {
                    let (sin, cos) = math::sin_cos(omega * t);
                    let forward = heading.rotate(DVec2::new(cos, sin));
                    (interval.path.velocity(t) + forward.perp() * (omega * model.axis_offset)).length()
                };
                integral(speed, seconds)
            }
        }
    }

    /// Interval that contains `at` and slip ratio of the wheels, if the body is pressed against a wall. The slip ratio
    /// is the slip speed of the wheels over the floor, divided by the speed that the wheels command.
    pub fn slip(&self, model: &Model, at: Time) -> Option<(&MotionInterval, f64)> {
        if self.piece.has_ended(at) {
            return None;
        }
        let seconds = self.seconds_at(at);
        let interval = self.interval_at(seconds).filter(|interval| interval.pressed_wall.is_some())?;
        let Twist { vx, vy, omega } = self.twist_of_centre(model);
        let heading = self.piece.state.world_from_axle.heading.turned(omega * seconds).direction();
        let commanded = heading.rotate(DVec2::new(vx, vy));
        let commanded_speed = commanded.length();
        let slip_speed = (commanded - interval.velocity(seconds)).length();
        Some((interval, if commanded_speed > 0.0 { slip_speed / commanded_speed } else { 0.0 }))
    }

    /// Returns true if the wheels slip so much at `at` that they are regarded as stalled.
    pub fn is_slipping(&self, model: &Model, at: Time) -> bool {
        self.slip(model, at).is_some_and(|(_, ratio)| ratio > STALL_SLIP)
    }

    /// Drops the intervals that ended before `time`.
    pub fn drop_intervals_before(&mut self, time: Time) {
        let seconds = (time - self.piece.start).seconds();
        let end = self.intervals.partition_point(|interval| interval.begin <= seconds);
        // Draining is worthwhile only for many intervals at a time.
        if end > 64 {
            self.intervals.drain(..end - 1);
        }
    }

    /// Returns true if the true motion differs from the motion of error-free wheels.
    fn has_motion_errors(&self) -> bool {
        self.piece.rates.truth != self.piece.rates.nominal
    }

    /// Removes the motion errors until `until`, because only the errors press the robot against a contact; the wheels
    /// are assumed to slip at this contact.
    fn suppress_errors(&mut self, model: &Model, until: Time) {
        self.unhindered_twist = nominal_twist(model, &self.commands, &self.actuation);
        self.piece.rates.truth = self.piece.rates.nominal;
        self.error_free_until = Some(until);
        self.set_path(model);
    }

    /// Twist of the centre at `at`, in the robot's frame, that walls allow and that only movable objects would reduce.
    pub fn twist_without_objects(&self, model: &Model, at: Time) -> Twist {
        let twist = self.unhindered_twist.at_offset(DVec2::new(-model.axis_offset, 0.0));
        let seconds = self.seconds_at(at);
        let Some(interval) = self
            .interval_at(seconds)
            .filter(|interval| interval.pressed_wall.is_some() && self.slowdown.fraction > 0.0)
        else {
            return twist;
        };
        let heading = self.piece.state.world_from_axle.heading.turned(interval.path.omega() * seconds).direction();
        let velocity = DVec2::new(heading.x, -heading.y).rotate(interval.velocity(seconds)) / self.slowdown.fraction;
        Twist { vx: velocity.x, vy: velocity.y, ..twist }
    }

    /// Returns true if a movable object blocks the robot at `at`.
    pub fn is_held(&self, at: Time) -> bool {
        matches!(self.piece.cause, Cause::Impact { with, .. } if matches!(with.thing, Thing::Object(_)))
            && self.piece.has_ended(at)
    }

    /// The first body of `touching` that the robot approaches at the start of the stage.
    fn approached(&self, radius: f64, touching: &[Body]) -> Option<Obstacle> {
        if touching.is_empty() {
            return None;
        }
        let velocity = self.path.velocity(0.0);
        touching.iter().find_map(|body| {
            let towards = (body.centre - self.path.origin).normalize_or_zero();
            let is_in_contact = (body.centre - self.path.origin).length() <= radius + body.radius + TOUCH;
            let point = body.centre - towards * body.radius;
            (is_in_contact && velocity.dot(towards) > APPROACH)
                .then_some(Obstacle { thing: Thing::Robot(body.robot), point })
        })
    }

    /// Ends the stage after `seconds` at `obstacle`.
    pub fn stop(&mut self, seconds: f64, obstacle: Obstacle, fresh: bool) {
        self.intervals.retain(|interval| interval.begin <= seconds);
        self.piece.duration = seconds;
        self.piece.cause = Cause::Impact { with: obstacle, fresh };
        self.explored = f64::INFINITY;
    }

    /// Searches for walls up to `seconds` after the start. At the first wall the stage ends or, if the body slides, an
    /// interval begins.
    ///
    /// The contact with each wall is computed for the whole path, and the steps of the search are counted from the
    /// start. So the result does not depend on earlier searches.
    #[inline]
    pub fn explore(&mut self, vehicle: &Vehicle, walls: &Walls, seconds: f64) {
        if self.explored < seconds.min(self.piece.duration) {
            self.continue_exploring(vehicle, walls, seconds);
        }
    }

    fn continue_exploring(&mut self, vehicle: &Vehicle, walls: &Walls, seconds: f64) {
        while self.explored < seconds.min(self.piece.duration) {
            let last = self.intervals.last().copied();
            if let Some(MotionInterval { begin, duration, next_wall, pressed_wall: Some(_), .. }) = last {
                self.begin_interval(vehicle, walls, begin + duration, next_wall, next_wall.is_some());
                continue;
            }
            let start = last.map_or(0.0, |interval| interval.begin);
            let searched = (self.explored - start).max(0.0);
            let search_to = (2.0 * searched).max(FIRST_SEARCH);
            self.explored = if searched >= self.last_path().period() { f64::INFINITY } else { start + search_to };
            if self.explored.is_finite() {
                self.search_walls(vehicle, walls, searched, search_to.min(self.piece.duration - start));
            }
        }
    }

    /// Path of the last interval found so far, or of the stage if there is no interval.
    fn last_path(&self) -> &Path {
        self.intervals.last().map_or(&self.path, |interval| &interval.path)
    }

    /// Searches for the first wall on the last path, from `searched` to `search_to` seconds after the start of that
    /// path.
    fn search_walls(&mut self, vehicle: &Vehicle, walls: &Walls, searched: f64, search_to: f64) {
        let model = &*vehicle.model;
        let radius = model.body_radius;
        let start = self.intervals.last().map_or(0.0, |interval| interval.begin);
        let path = *self.last_path();
        let duration = self.piece.duration - start;
        let (middle, disc_radius) = path.surrounding_disc(searched, search_to);
        // One skin for the contact itself, one for rounding.
        let reach = disc_radius + radius + 2.0 * SKIN;
        let mut first: Option<(f64, WallId, Segment, bool)> = None;
        walls.for_each_in(Bounds::of_disc(middle, reach), |id, wall| {
            if (wall.nearest_point(middle) - middle).length_squared() > reach * reach {
                return;
            }
            let Some(contact) = first_contact(&path, radius, wall, duration) else { return };
            let is_first = first.is_none_or(|(seconds, best, ..)| (contact.seconds, id) < (seconds, best));
            if contact.seconds <= search_to && is_first {
                first = Some((contact.seconds, id, *wall, contact.fresh));
            }
        });
        // A drive that ends exactly at the contact has reached its target.
        let Some((seconds, id, wall, fresh)) = first.filter(|(seconds, ..)| *seconds < duration) else { return };
        if vehicle.contact != ContactRule::Stall {
            if let Some(interval) = self.intervals.last_mut() {
                interval.duration = seconds;
            }
            return self.begin_interval(vehicle, walls, start + seconds, Some(id), fresh);
        }
        if seconds == 0.0 && self.has_motion_errors() {
            return self.suppress_errors(model, self.next_tick());
        }
        let point = wall.nearest_point(path.position(seconds));
        self.stop(seconds, Obstacle { thing: Thing::Wall(id), point }, fresh);
    }

    /// Begins the interval that follows a contact or another interval, `begin` seconds after the start. `met` is the
    /// wall that the body meets at that instant; `is_fresh` is true if the body did not touch that wall before.
    fn begin_interval(&mut self, vehicle: &Vehicle, walls: &Walls, begin: f64, met: Option<WallId>, is_fresh: bool) {
        let model = &*vehicle.model;
        let ContactRule::Slide { friction } = vehicle.contact else { return };
        let centre = self.centre_after(model, begin);
        let length_before = self.state_after(model, begin).path_length - self.piece.state.path_length;
        let push = Push { free: Path::new(&centre, self.twist_of_centre(model)), radius: model.body_radius, friction };
        let earlier_begin = self.intervals.len().checked_sub(MAX_INTERVALS).map(|index| self.intervals[index].begin);
        let slide = if earlier_begin.is_some_and(|earlier_begin| begin - earlier_begin < INTERVAL_WINDOW_S) {
            push.resting(INTERVAL_WINDOW_S, self.intervals.last().and_then(|interval| interval.pressed_wall))
        } else {
            push.slide(walls, met, self.piece.duration - begin)
        };
        self.explored = match slide.pressed_wall {
            // The body leaves its contacts, so the next wall must be searched from here on.
            None => begin,
            Some(_) if begin + slide.duration < self.piece.duration => begin + slide.duration,
            Some(_) => f64::INFINITY,
        };
        let Slide { path, duration, pressed_wall, next_wall } = slide;
        self.intervals.push(MotionInterval { begin, duration, path, length_before, pressed_wall, is_fresh, next_wall });
    }

    /// The next stage, if a tick not later than `limit` starts one. Only wheels with a lag, robots with errors and
    /// hulls in the water have such stages.
    pub fn next(&mut self, vehicle: &Vehicle, walls: &Walls, limit: Time) -> Option<Self> {
        let model = &*vehicle.model;
        if let Some(hull) = &vehicle.hull {
            return self.next_of_hull(vehicle, hull, walls, limit);
        }
        if self.has_no_ticks(vehicle) {
            return None;
        }
        let tick = self.next_tick();
        if tick > limit {
            return None;
        }
        let is_settled = model.wheel_lag == 0.0 || self.step(model) == self.actuation;
        if is_settled && !self.has_motion_errors() && !self.has_random_errors && self.error_free_until.is_none() {
            self.is_steady = true;
            return None;
        }
        if is_settled
            && !self.has_random_errors
            && self.error_free_until.is_none()
            && vehicle.contact != ContactRule::Stall
        {
            // The errors are constant, and walls do not end the piece.
            self.is_steady = true;
            return None;
        }
        self.explore(vehicle, walls, (tick - self.piece.start).seconds());
        if self.piece.has_ended(tick) || is_settled && !self.has_random_errors && self.error_free_until.is_none() {
            return self.next_after_contact(vehicle, walls, limit);
        }
        Some(self.open_at_tick(vehicle, tick))
    }

    /// Returns true if no tick starts another stage after this one.
    #[inline]
    pub fn has_no_ticks(&self, vehicle: &Vehicle) -> bool {
        vehicle.hull.is_none() && (self.is_steady || vehicle.model.wheel_lag == 0.0 && vehicle.errors.is_none())
    }

    /// Lower bound of the end of this stage: no wall, target or tick ends the stage before this instant. It is the
    /// start of the stage if no better bound is known.
    pub fn unchanged_until(&self, vehicle: &Vehicle) -> Time {
        // Each interval along a wall is reported separately, so its end may come at any time: no bound is known.
        let has_ticks = !self.is_steady && !self.has_no_ticks(vehicle);
        if has_ticks || !self.intervals.is_empty() {
            return self.piece.start;
        }
        let explored_end = self.explored.min(self.piece.duration).max(0.0);
        self.piece.start.saturating_add(Time::from_seconds_ceil(explored_end)) - Time(1)
    }

    /// The next stage of a hull, if a tick not later than `limit` starts one. If the hull's motion is steady, only the
    /// first tick after a contact with a wall, or after a robot has blocked the hull, starts a new stage.
    fn next_of_hull(&mut self, vehicle: &Vehicle, hull: &Hull, walls: &Walls, limit: Time) -> Option<Self> {
        let mut tick = self.next_tick();
        if tick > limit {
            return None;
        }
        self.is_steady |= step_hull(&vehicle.model, hull, &self.commands, &self.actuation) == self.actuation;
        if self.is_steady {
            self.explore(vehicle, walls, (limit - self.piece.start).seconds());
            let seconds = self.intervals.first().map_or(self.piece.duration, |interval| interval.begin);
            if seconds == f64::INFINITY {
                return None;
            }
            let contact = self.piece.start.saturating_add(Time::from_seconds_ceil(seconds));
            tick = tick.max(contact.saturating_add(TICK - Time(1)).floor_to(TICK));
        } else {
            self.explore(vehicle, walls, (tick - self.piece.start).seconds());
        }
        (tick <= limit).then(|| {
            let mut next = self.open_at_tick(vehicle, tick);
            if let Some(blocker) = self.blocker().filter(|_| self.piece.has_ended(tick)) {
                // Only a new command or a free path can free the hull from its blocker; it still rises or sinks.
                next.stop(0.0, blocker, false);
            }
            next
        })
    }

    /// Height of a hull's frame above the floor at `at`, m; 0 for other robots.
    pub fn hull_height(&self, at: Time) -> f64 {
        let height_at_tick = self.actuation.memory.hull.height;
        height_at_tick - self.actuation.rates[3] * (self.next_tick() - at).seconds().max(0.0)
    }

    /// Change of a hull's velocity by the contact with a wall at `at`, in the hull's frame, m/s.
    fn velocity_change(&self, model: &Model, at: Time) -> DVec2 {
        let seconds = self.seconds_at(at);
        let Some(interval) = self.interval_at(seconds).filter(|interval| interval.pressed_wall.is_some()) else {
            return DVec2::ZERO;
        };
        let Twist { vx, vy, omega } = self.twist_of_centre(model);
        let heading = self.piece.state.world_from_axle.heading.turned(omega * seconds).direction();
        DVec2::new(heading.x, -heading.y).rotate(interval.velocity(seconds)) - DVec2::new(vx, vy)
    }

    /// The stage that begins at the first tick after errors have moved the body against a wall, if that tick is not
    /// later than `limit`. `None` if the body would be pressed against a wall in that stage too.
    fn next_after_contact(&mut self, vehicle: &Vehicle, walls: &Walls, limit: Time) -> Option<Self> {
        self.explore(vehicle, walls, (limit - self.piece.start).seconds());
        let tick = (self.piece.end() + (TICK - Time(1))).floor_to(TICK);
        if !self.piece.has_ended(limit) || tick > limit {
            return None;
        }
        if self.has_motion_errors()
            && matches!(self.piece.cause, Cause::Impact { with, .. } if matches!(with.thing, Thing::Wall(_)))
        {
            let mut next = self.open_at_tick(vehicle, tick);
            next.explore(vehicle, walls, 0.0);
            if next.piece.duration > 0.0 || !matches!(next.piece.cause, Cause::Impact { .. }) {
                return Some(next);
            }
        }
        self.is_steady = true;
        None
    }

    /// Stage that begins at `tick` with the commands in force.
    fn open_at_tick(&self, vehicle: &Vehicle, tick: Time) -> Self {
        let (state, commands) = (self.state(&vehicle.model, tick), self.commands_at(tick));
        let actuation_before = self.actuation_before(&vehicle.model, tick);
        let mut next = Self::open(vehicle, tick, state, commands, actuation_before, &[], self.slowdown);
        if let Some(until) = self.error_free_until.filter(|until| *until > tick) {
            next.suppress_errors(&vehicle.model, until);
        }
        next
    }

    /// The first tick after the start of the stage.
    pub fn next_tick(&self) -> Time {
        self.piece.start.floor_to(TICK) + TICK
    }

    /// State of wheels and controllers one tick later.
    fn step(&self, model: &Model) -> Actuation {
        let CommandState { controllers, active, steering } = &self.commands;
        control::step(model, controllers, active.target(), *steering, &self.actuation)
    }

    /// The commands in force at `at`; a drive contains the displacement that remains at `at`.
    pub fn commands_at(&self, at: Time) -> CommandState {
        let active = match self.commands.active {
            ActiveCommand::Drive { total, remaining, rate } => {
                if matches!(self.piece.cause, Cause::Arrived(_)) && self.piece.has_ended(at) {
                    ActiveCommand::Idle
                } else {
                    let seconds = (at - self.piece.start).seconds().min(self.piece.duration);
                    let covered = self.piece.covered(self.piece.rates.nominal, seconds);
                    let remaining = Twist {
                        vx: remaining.vx - covered.vx,
                        vy: remaining.vy - covered.vy,
                        omega: remaining.omega - covered.omega,
                    };
                    ActiveCommand::Drive { total, remaining, rate }
                }
            }
            other => other,
        };
        CommandState { active, steering: self.commands.steering, controllers: self.commands.controllers.clone() }
    }

    /// End of the drive, rounded up to a microsecond; `None` if there is no drive or an obstacle stops the body before
    /// its target.
    pub fn drive_end(&mut self, vehicle: &Vehicle, walls: &Walls) -> Option<Time> {
        if vehicle.contact == ContactRule::Stall {
            self.explore(vehicle, walls, self.piece.duration);
        }
        matches!(self.piece.cause, Cause::Arrived(_)).then(|| self.piece.end())
    }

    /// State of wheels, controllers and hull just before `at`.
    pub fn actuation_before(&self, model: &Model, at: Time) -> Actuation {
        if at == self.piece.start {
            return self.actuation_before.clone();
        }
        let mut actuation = self.actuation.clone();
        let is_hull = model.kind == DriveKind::Thrusters;
        if self.piece.has_ended(at) {
            // A blocked hull continues to rise or sink.
            actuation.rates = [0.0, 0.0, 0.0, if is_hull { actuation.rates[3] } else { 0.0 }];
            if is_hull {
                actuation.memory.hull.velocity[..3].fill(0.0);
            }
        } else if is_hull && at.floor_to(TICK) == at {
            let change = self.velocity_change(model, at);
            let [forwards, sideways, ..] = &mut actuation.memory.hull.velocity;
            *forwards += change.x;
            *sideways += change.y;
        }
        actuation
    }

    /// The robot that blocks the body at the end of the stage, with the touched point.
    pub fn blocker(&self) -> Option<Obstacle> {
        match self.piece.cause {
            Cause::Impact { with, .. } if matches!(with.thing, Thing::Robot(_)) => Some(with),
            _ => None,
        }
    }
}

/// Pose of the robot's centre in the world.
pub(super) fn centre_of(model: &Model, world_from_axle: &Pose) -> Pose {
    if model.axis_offset == 0.0 {
        return *world_from_axle;
    }
    Pose { position: world_from_axle.transform_point(DVec2::new(-model.axis_offset, 0.0)), ..*world_from_axle }
}

/// Pose of the axle's midpoint of a robot whose centre is at `world_from_robot`.
pub(super) fn axle_of(model: &Model, world_from_robot: &Pose) -> Pose {
    let axle = DVec2::new(model.axis_offset, 0.0);
    Pose { position: world_from_robot.transform_point(axle), ..*world_from_robot }
}

/// Integral of a smooth function from 0 to `end`, by Gauss-Legendre quadrature with 8 points on each of 4 parts.
fn integral(f: impl Fn(f64) -> f64, end: f64) -> f64 {
    const NODES: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
    ];
    let half = end / 8.0;
    let part = |middle: f64| -> f64 {
        NODES.iter().map(|(node, weight)| weight * (f(middle - half * node) + f(middle + half * node))).sum()
    };
    half * (0..4).map(|index| part(half * f64::from(2 * index + 1))).sum::<f64>()
}

/// State of wheels, controllers and hull from `start` on. Wheels without lag follow their commands at once. A hull, and
/// wheels with a lag, advance by one step if `start` is a tick.
fn actuate(vehicle: &Vehicle, start: Time, commands: &CommandState, before: &Actuation) -> Actuation {
    let model = &*vehicle.model;
    if let Some(hull) = &vehicle.hull {
        if start.floor_to(TICK) == start { step_hull(model, hull, commands, before) } else { before.clone() }
    } else if model.wheel_lag == 0.0 {
        Actuation { rates: commands.active.target().wheels(model), memory: before.memory.clone() }
    } else if start.floor_to(TICK) == start {
        control::step(model, &commands.controllers, commands.active.target(), commands.steering, before)
    } else {
        before.clone()
    }
}

/// State of a hull after one more tick.
fn step_hull(model: &Model, hull: &Hull, commands: &CommandState, before: &Actuation) -> Actuation {
    let mut after = before.clone();
    let memory = &mut *after.memory;
    (after.rates, memory.hull) = hull.step(model, &commands.active.target().wheels(model), &memory.hull);
    after
}

/// Twist of the axle that the commands give with error-free wheels.
fn nominal_twist(model: &Model, commands: &CommandState, actuation: &Actuation) -> Twist {
    match commands.active {
        // The commanded twist itself is exact; a conversion to wheel rates and back would round.
        ActiveCommand::Twist(twist) | ActiveCommand::Drive { rate: twist, .. } if model.wheel_lag == 0.0 => twist,
        _ => model.twist_from_wheels(&actuation.rates, commands.steering),
    }
}

/// Rates, duration in seconds and reason of the end of a piece without walls. `fraction` is the fraction of the twists
/// at which the robot moves.
fn motion_of(
    model: &Model,
    commands: &CommandState,
    nominal_twist: Twist,
    disturbed: &DisturbedTwists,
    actuation: &Actuation,
    fraction: f64,
) -> (Rates, f64, Cause) {
    // A factor of 1 keeps the result bit-identical.
    let nominal = nominal_twist.scaled(fraction);
    let rates = Rates {
        truth: disturbed.truth.scaled(fraction),
        nominal,
        odometry: disturbed.odometry.scaled(fraction),
        wheels: actuation.rates.map(|rate| rate * fraction),
    };
    let ActiveCommand::Drive { total, remaining, .. } = commands.active else {
        return (rates, f64::INFINITY, Cause::Open);
    };
    let remaining_path = ActiveCommand::progress(total, remaining);
    let speed = ActiveCommand::progress(total, nominal_twist);
    if remaining_path <= 0.0 || (speed <= 0.0 && model.wheel_lag == 0.0) {
        (rates, 0.0, Cause::Arrived(if model.wheel_lag == 0.0 { remaining } else { Twist::ZERO }))
    } else if speed <= 0.0 || fraction == 0.0 {
        (rates, f64::INFINITY, Cause::Open)
    } else {
        let duration = remaining_path / (speed * fraction);
        (rates, duration, Cause::Arrived(if model.wheel_lag == 0.0 { remaining } else { nominal.scaled(duration) }))
    }
}
