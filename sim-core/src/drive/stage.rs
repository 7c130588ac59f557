//! One stage of a plan: a piece of motion, the orders that it follows, and the walls that it meets.

use glam::DVec2;

use super::{
    HISTORY,
    command::{Orders, Pending},
    control::{self, Actuation},
    hull::Hull,
    imperfection::{ContactRule, ErringTwists, Vehicle},
    model::{DriveKind, Model},
    motion::Passage,
    piece::{Cause, Piece, Rates, State},
};
use crate::{
    contact::{APPROACH, Body, Obstacle, Pace, Path, Push, SKIN, Slide, TOUCH, Thing, first_contact},
    math,
    pose::{Pose, Twist},
    scene::{Bounds, Segment, WallId, Walls},
    time::{TICK, Time},
};

/// A piece of motion with all that is needed to continue after it.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    pub piece: Piece,
    pub orders: Orders,
    /// State of wheels and controllers just before the stage, from which a further command at the same instant starts.
    pub before: Actuation,
    /// State of wheels and controllers during the stage.
    pub during: Actuation,
    /// Path of the centre, without contacts.
    pub path: Path,
    /// True twist of the axle that results from the orders; pressing an object may slow the robot below this twist.
    pub ordered: Twist,
    /// Fraction of the ordered twist that movable objects leave.
    pub grip: Grip,
    /// Seconds after the start up to which walls have been searched.
    pub explored: f64,
    /// True if the stage begins with a placement of the robot, which ends all earlier contacts.
    pub is_placed: bool,
    /// True if the errors include random ones, which hold for this tick only.
    is_drawn: bool,
    /// Instant until which the robot moves without errors, because its errors would press it against a contact.
    error_free_until: Option<Time>,
    /// True if the coming ticks change nothing.
    steady: bool,
    /// Motion of the body from its first contact with a wall, in order of time, if contacts make it slide.
    pub segments: Vec<SlideSegment>,
}

/// A part of a stage that begins at a contact with a wall or where such a part ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SlideSegment {
    /// Seconds from the start of the stage to the start of the segment.
    pub from: f64,
    /// Duration in seconds; infinite while the end is not known.
    pub after: f64,
    /// Path of the centre.
    pub path: Path,
    /// Length of the axle's path from the start of the stage to the start of the segment, m.
    pub length_before: f64,
    /// Wall against which the body is pressed, and the touched point.
    pub against: Option<(WallId, DVec2)>,
    /// True if the body did not touch the wall before this segment.
    pub is_fresh: bool,
    /// Wall at which the segment ends, if the body did not touch that wall before.
    pub meets: Option<WallId>,
}

impl SlideSegment {
    /// Passage of the segment; `whole` is the passage of its stage.
    fn passage(&self, whole: &Passage) -> Passage {
        Passage { begin: self.from, after: (self.from + self.after).min(whole.after), path: self.path, ..*whole }
    }

    /// Position of the centre `seconds` after the start of the stage.
    fn position(&self, seconds: f64) -> DVec2 {
        self.path.position((seconds - self.from).clamp(0.0, self.after))
    }

    /// Velocity of the centre `seconds` after the start of the stage, in the world, m/s.
    fn velocity(&self, seconds: f64) -> DVec2 {
        self.path.velocity((seconds - self.from).clamp(0.0, self.after))
    }
}

/// Slip ratio above which the wheels count as stalled: slip speed divided by the speed of the push. Our choice.
const STALL_SLIP: f64 = 0.5;

/// Number of segments within [`SEGMENT_WINDOW_S`] after which the body rests. Our choice.
const MAX_SEGMENTS: usize = 16;

/// Seconds within which [`MAX_SEGMENTS`] segments cause a rest; also the duration of that rest.
const SEGMENT_WINDOW_S: f64 = 1e-3;

/// Slow-down of a robot on its own path by movable objects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grip {
    /// Fraction of the ordered twist with which the robot moves, 0 to 1.
    pub fraction: f64,
    /// The obstacle that the robot presses, for a share below 1.
    pub obstacle: Option<Obstacle>,
}

impl Grip {
    /// Grip of a robot without obstacle.
    pub const FREE: Self = Self { fraction: 1.0, obstacle: None };
}

/// Seconds after the start up to which walls are searched first; each further search reaches twice as far.
const FIRST_LOOK: f64 = 0.1;

impl Stage {
    /// The stage that obeys `orders` from `start` on, beginning with `state` and with `before` as the state of the
    /// wheels. If the robot would approach a body of `touching`, it is blocked at once.
    pub fn open(
        vehicle: &Vehicle,
        start: Time,
        state: State,
        orders: Orders,
        before: Actuation,
        touching: &[Body],
        grip: Grip,
    ) -> Self {
        let model = &*vehicle.model;
        let during = actuate(vehicle, start, &orders, &before);
        let nominal = ordered_twist(model, &orders, &during);
        let erring = vehicle.erring_twists(start, &orders, &during, nominal);
        let (rates, after, cause) = motion_of(model, &orders, nominal, &erring, &during, grip.fraction);
        let mut stage = Self {
            piece: Piece { start, state, rates, after, cause },
            orders,
            before,
            during,
            path: Path::resting(DVec2::ZERO),
            ordered: erring.truth,
            grip,
            explored: 0.0,
            is_placed: false,
            is_drawn: erring.is_drawn,
            error_free_until: None,
            steady: false,
            segments: Vec::new(),
        };
        stage.set_path(model);
        let mut obstacle = stage.approached(model.body_radius, touching);
        if obstacle.is_some() && stage.is_erring() {
            // Contacts with robots are found at ends of slots only, so the robot drives without errors for the time within which
            // contacts count as one.
            stage.suppress_errors(model, start + HISTORY);
            obstacle = stage.approached(model.body_radius, touching);
        }
        if let Some(obstacle) = obstacle {
            stage.stop(0.0, obstacle, true);
        }
        if let Grip { fraction: 0.0, obstacle: Some(obstacle) } = grip
            && !stage.ordered.is_zero()
            && !matches!(cause, Cause::Arrived(_))
        {
            stage.stop(0.0, obstacle, false);
        }
        stage
    }

    fn set_path(&mut self, model: &Model) {
        let centre = centre_of(model, &self.piece.state.world_from_axle);
        self.path = Path::new(&centre, self.twist_of_centre(model));
        // A negative value, because a contact may stop the motion already at its start.
        self.explored = if self.path.is_resting() { f64::INFINITY } else { -1.0 };
    }

    /// Twist of the centre without contacts, in the robot's frame.
    fn twist_of_centre(&self, model: &Model) -> Twist {
        self.piece.rates.truth.at_offset(DVec2::new(-model.axis_offset, 0.0))
    }

    /// The segment in force `seconds` after the start of the stage; `None` before the first contact.
    pub fn segment_at(&self, seconds: f64) -> Option<&SlideSegment> {
        let index = self.segments.partition_point(|segment| segment.from <= seconds);
        index.checked_sub(1).map(|last| &self.segments[last])
    }

    /// Seconds from the start of the stage to `at`, not beyond its end.
    fn seconds_at(&self, at: Time) -> f64 {
        (at - self.piece.start).seconds().clamp(0.0, self.piece.after.max(0.0))
    }

    /// State at `at`, not before the start; a function of `at` alone.
    pub fn state(&self, model: &Model, at: Time) -> State {
        self.state_after(model, (at - self.piece.start).seconds())
    }

    /// State `seconds` after the start.
    fn state_after(&self, model: &Model, seconds: f64) -> State {
        let state = self.piece.state_after(seconds, self.path.direction);
        let seconds = seconds.clamp(0.0, self.piece.after.max(0.0));
        let Some(segment) = self.segment_at(seconds) else { return state };
        let path =
            self.piece.state.path + (segment.length_before + self.length_on(model, segment, seconds - segment.from));
        State { world_from_axle: axle_of(model, &self.centre_after(model, seconds)), path, ..state }
    }

    /// Pose of the robot's centre at `at`, not before the start.
    pub fn centre(&self, model: &Model, at: Time) -> Pose {
        self.centre_after(model, self.seconds_at(at))
    }

    pub fn centre_after(&self, model: &Model, seconds: f64) -> Pose {
        let seconds = seconds.clamp(0.0, self.piece.after.max(0.0));
        let Some(segment) = self.segment_at(seconds) else {
            return centre_of(model, &self.piece.world_from_axle_after(seconds, self.path.direction));
        };
        let heading = self.piece.state.world_from_axle.heading.turned(segment.path.omega() * seconds);
        Pose { position: segment.position(seconds), heading }
    }

    /// Appends the passages of the body from `from` to `to`; `until` is the start of the next stage.
    pub fn passages(&self, from: Time, until: Time, to: Time, passages: &mut Vec<Passage>) {
        let Piece { start, state, after, .. } = self.piece;
        let heading = state.world_from_axle.heading;
        let whole = Passage { start, begin: 0.0, until, after, path: self.path, heading };
        if self.segments.is_empty() {
            passages.push(whole);
            return;
        }
        let seconds = (from - start).seconds();
        let first = self.segments.partition_point(|segment| segment.from <= seconds);
        let begun = |segment: &&SlideSegment| (to.min(until) - start).seconds() >= segment.from;
        let at_first = first.checked_sub(1).map_or(whole, |first| self.segments[first].passage(&whole));
        passages.push(at_first);
        for segment in self.segments[first..].iter().take_while(begun) {
            let begin = segment.from;
            let last = passages.last_mut().expect("one has been added");
            last.until = start + Time::from_seconds_ceil(begin);
            last.after = begin;
            passages.push(segment.passage(&whole));
        }
    }

    /// Length of the axle's path in the first `seconds` of a segment, m.
    fn length_on(&self, model: &Model, segment: &SlideSegment, seconds: f64) -> f64 {
        let omega = segment.path.omega();
        let seconds = seconds.min(segment.after);
        match segment.path.pace {
            Pace::ConstantTwist if segment.against.is_none() => self.piece.rates.truth.speed() * seconds,
            Pace::ConstantTwist => (omega * model.axis_offset * seconds).abs(),
            Pace::Sliding { law, .. } if model.axis_offset == 0.0 || omega == 0.0 => law.length(seconds),
            // If the axle is not at the centre, the length has no closed form.
            Pace::Sliding { .. } => {
                let heading = self.piece.state.world_from_axle.heading.turned(omega * segment.from).direction();
                let speed = |t: f64| {
                    let (sin, cos) = math::sin_cos(omega * t);
                    let ahead = heading.rotate(DVec2::new(cos, sin));
                    (segment.path.velocity(t) + ahead.perp() * (omega * model.axis_offset)).length()
                };
                gauss(speed, seconds)
            }
        }
    }

    /// The segment in force at `at`, if a wall presses the body, and the slip ratio: slip speed of the wheels over the
    /// floor, divided by the speed of the push.
    pub fn slip(&self, model: &Model, at: Time) -> Option<(&SlideSegment, f64)> {
        if self.piece.has_ended(at) {
            return None;
        }
        let seconds = self.seconds_at(at);
        let segment = self.segment_at(seconds).filter(|segment| segment.against.is_some())?;
        let Twist { vx, vy, omega } = self.twist_of_centre(model);
        let heading = self.piece.state.world_from_axle.heading.turned(omega * seconds).direction();
        let pushed = heading.rotate(DVec2::new(vx, vy));
        let speed = pushed.length();
        let slip = (pushed - segment.velocity(seconds)).length();
        Some((segment, if speed > 0.0 { slip / speed } else { 0.0 }))
    }

    /// Returns true if the wheels slip so much at `at` that they count as stalled.
    pub fn is_slipping(&self, model: &Model, at: Time) -> bool {
        self.slip(model, at).is_some_and(|(_, fraction)| fraction > STALL_SLIP)
    }

    /// Drops the segments that ended before `before`.
    pub fn forget_segments(&mut self, before: Time) {
        let seconds = (before - self.piece.start).seconds();
        let end = self.segments.partition_point(|segment| segment.from <= seconds);
        // Draining is worthwhile only for many segments at a time.
        if end > 64 {
            self.segments.drain(..end - 1);
        }
    }

    /// Returns true if the true motion differs from the motion of error-free wheels.
    fn is_erring(&self) -> bool {
        self.piece.rates.truth != self.piece.rates.nominal
    }

    /// Switches to motion without errors until `until`: the wheels slip where only errors would press the robot against
    /// a contact.
    fn suppress_errors(&mut self, model: &Model, until: Time) {
        self.ordered = ordered_twist(model, &self.orders, &self.during);
        self.piece.rates.truth = self.piece.rates.nominal;
        self.error_free_until = Some(until);
        self.set_path(model);
    }

    /// Ordered twist of the centre at `at` in the robot's frame, as limited by walls.
    pub fn ordered_at_centre(&self, model: &Model, at: Time) -> Twist {
        let ordered = self.ordered.at_offset(DVec2::new(-model.axis_offset, 0.0));
        let seconds = self.seconds_at(at);
        let Some(segment) =
            self.segment_at(seconds).filter(|segment| segment.against.is_some() && self.grip.fraction > 0.0)
        else {
            return ordered;
        };
        let heading = self.piece.state.world_from_axle.heading.turned(segment.path.omega() * seconds).direction();
        let velocity = DVec2::new(heading.x, -heading.y).rotate(segment.velocity(seconds)) / self.grip.fraction;
        Twist { vx: velocity.x, vy: velocity.y, ..ordered }
    }

    /// Returns true if a movable object holds the robot at `at`.
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
            let in_contact = (body.centre - self.path.origin).length() <= radius + body.radius + TOUCH;
            let point = body.centre - towards * body.radius;
            (in_contact && velocity.dot(towards) > APPROACH)
                .then_some(Obstacle { thing: Thing::Robot(body.robot), point })
        })
    }

    /// Ends the stage after `seconds` at `obstacle`.
    pub fn stop(&mut self, seconds: f64, obstacle: Obstacle, fresh: bool) {
        self.segments.retain(|segment| segment.from <= seconds);
        self.piece.after = seconds;
        self.piece.cause = Cause::Impact { with: obstacle, fresh };
        self.explored = f64::INFINITY;
    }

    /// Searches for walls up to `seconds` after the start. The first wall ends the stage, or begins a segment if the body
    /// slides.
    ///
    /// The contact with each wall is computed for the whole path, and the intervals of the search are counted from the
    /// start. So the result does not depend on earlier searches.
    #[inline]
    pub fn explore(&mut self, vehicle: &Vehicle, walls: &Walls, seconds: f64) {
        if self.explored < seconds.min(self.piece.after) {
            self.explore_on(vehicle, walls, seconds);
        }
    }

    fn explore_on(&mut self, vehicle: &Vehicle, walls: &Walls, seconds: f64) {
        while self.explored < seconds.min(self.piece.after) {
            let last = self.segments.last().copied();
            if let Some(SlideSegment { from, after, meets, against: Some(_), .. }) = last {
                self.begin_segment(vehicle, walls, from + after, meets, meets.is_some());
                continue;
            }
            let start = last.map_or(0.0, |segment| segment.from);
            let from = (self.explored - start).max(0.0);
            let to = (2.0 * from).max(FIRST_LOOK);
            self.explored = if from >= self.last_path().period() { f64::INFINITY } else { start + to };
            if self.explored.is_finite() {
                self.explore_stretch(vehicle, walls, from, to.min(self.piece.after - start));
            }
        }
    }

    /// Path of the last segment found so far, or of the stage if there is no segment.
    fn last_path(&self) -> &Path {
        self.segments.last().map_or(&self.path, |segment| &segment.path)
    }

    fn explore_stretch(&mut self, vehicle: &Vehicle, walls: &Walls, from: f64, to: f64) {
        let model = &*vehicle.model;
        let radius = model.body_radius;
        let start = self.segments.last().map_or(0.0, |segment| segment.from);
        let path = *self.last_path();
        let duration = self.piece.after - start;
        let (middle, half_way) = path.surrounding_disc(from, to);
        // One skin for the contact itself, one for rounding.
        let reach = half_way + radius + 2.0 * SKIN;
        let mut first: Option<(f64, WallId, Segment, bool)> = None;
        walls.for_each_in(Bounds::of_disc(middle, reach), |id, wall| {
            if (wall.nearest_point(middle) - middle).length_squared() > reach * reach {
                return;
            }
            let Some(contact) = first_contact(&path, radius, wall, duration) else { return };
            let is_first = first.is_none_or(|(after, best, ..)| (contact.after, id) < (after, best));
            if contact.after <= to && is_first {
                first = Some((contact.after, id, *wall, contact.fresh));
            }
        });
        // A drive that ends exactly at the contact has reached its target.
        let Some((after, id, wall, fresh)) = first.filter(|(after, ..)| *after < duration) else { return };
        if vehicle.contact != ContactRule::Stall {
            if let Some(segment) = self.segments.last_mut() {
                segment.after = after;
            }
            return self.begin_segment(vehicle, walls, start + after, Some(id), fresh);
        }
        if after == 0.0 && self.is_erring() {
            return self.suppress_errors(model, self.next_tick());
        }
        let point = wall.nearest_point(path.position(after));
        self.stop(after, Obstacle { thing: Thing::Wall(id), point }, fresh);
    }

    /// Begins the segment that follows a contact or another segment, `from` seconds after the start. `met` is the wall met at
    /// that instant; `is_fresh` states that the body did not touch it before.
    fn begin_segment(&mut self, vehicle: &Vehicle, walls: &Walls, from: f64, met: Option<WallId>, is_fresh: bool) {
        let model = &*vehicle.model;
        let ContactRule::Slide { friction } = vehicle.contact else { return };
        let centre = self.centre_after(model, from);
        let distance = self.state_after(model, from).path - self.piece.state.path;
        let push = Push { free: Path::new(&centre, self.twist_of_centre(model)), radius: model.body_radius, friction };
        let earlier = self.segments.len().checked_sub(MAX_SEGMENTS).map(|earlier| self.segments[earlier].from);
        let slide = if earlier.is_some_and(|earlier| from - earlier < SEGMENT_WINDOW_S) {
            push.resting(SEGMENT_WINDOW_S, self.segments.last().and_then(|segment| segment.against))
        } else {
            push.slide(walls, met, self.piece.after - from)
        };
        self.explored = match slide.against {
            // The body leaves its contacts, so the next wall must be searched from here on.
            None => from,
            Some(_) if from + slide.after < self.piece.after => from + slide.after,
            Some(_) => f64::INFINITY,
        };
        let Slide { path, after, against, meets } = slide;
        self.segments.push(SlideSegment { from, after, path, length_before: distance, against, is_fresh, meets });
    }

    /// The stage that a tick opens after this one, if that happens up to `limit`. Only wheels with a lag, robots with
    /// errors and hulls in the water have such stages.
    pub fn next(&mut self, vehicle: &Vehicle, walls: &Walls, limit: Time) -> Option<Self> {
        let model = &*vehicle.model;
        if let Some(hull) = &vehicle.hull {
            return self.next_afloat(vehicle, hull, walls, limit);
        }
        if self.has_no_ticks(vehicle) {
            return None;
        }
        let tick = self.next_tick();
        if tick > limit {
            return None;
        }
        let is_settled = model.wheel_lag == 0.0 || self.step(model) == self.during;
        if is_settled && !self.is_erring() && !self.is_drawn && self.error_free_until.is_none() {
            self.steady = true;
            return None;
        }
        if is_settled && !self.is_drawn && self.error_free_until.is_none() && vehicle.contact != ContactRule::Stall {
            // The errors are constant, and walls do not end the piece.
            self.steady = true;
            return None;
        }
        self.explore(vehicle, walls, (tick - self.piece.start).seconds());
        if self.piece.has_ended(tick) || is_settled && !self.is_drawn && self.error_free_until.is_none() {
            return self.next_after_contact(vehicle, walls, limit);
        }
        Some(self.at_tick(vehicle, tick))
    }

    /// Returns true if no tick opens another stage after this one.
    #[inline]
    pub fn has_no_ticks(&self, vehicle: &Vehicle) -> bool {
        self.steady || vehicle.model.wheel_lag == 0.0 && vehicle.errors.is_none() && vehicle.hull.is_none()
    }

    /// Lower bound of the end of this stage: no wall, target or tick ends the stage before this instant. The start of
    /// the stage if no better bound is known.
    pub fn steady_until(&self, vehicle: &Vehicle) -> Time {
        // Each segment along a wall is published by itself, so no bound is given.
        if !self.has_no_ticks(vehicle) || !self.segments.is_empty() {
            return self.piece.start;
        }
        let explored_end = self.explored.min(self.piece.after).max(0.0);
        self.piece.start.saturating_add(Time::from_seconds_ceil(explored_end)) - Time(1)
    }

    /// The stage of a hull that a tick opens after this one, if that happens up to `limit`. While nothing changes only the
    /// first tick after a contact with a wall opens one.
    fn next_afloat(&mut self, vehicle: &Vehicle, hull: &Hull, walls: &Walls, limit: Time) -> Option<Self> {
        let mut tick = self.next_tick();
        if tick > limit {
            return None;
        }
        self.steady = swim(&vehicle.model, hull, &self.orders, &self.during) == self.during;
        if self.steady {
            self.explore(vehicle, walls, (limit - self.piece.start).seconds());
            let contact = self.piece.start + Time::from_seconds_ceil(self.segments.first()?.from);
            tick = tick.max((contact + (TICK - Time(1))).floor_to(TICK));
        } else {
            self.explore(vehicle, walls, (tick - self.piece.start).seconds());
        }
        (tick <= limit && !self.piece.has_ended(tick)).then(|| self.at_tick(vehicle, tick))
    }

    /// Height of a hull above the floor at `at`, m; of other robots 0.
    pub fn lift(&self, at: Time) -> f64 {
        let lift = self.during.memory.afloat.lift;
        lift - self.during.rates[3] * (self.next_tick() - at).seconds().max(0.0)
    }

    /// The change of a hull's velocity by a contact at `at`, in its frame, m/s: the part of its speed that the contact takes away.
    fn impulse(&self, model: &Model, at: Time) -> DVec2 {
        let seconds = self.seconds_at(at);
        let Some(segment) = self.segment_at(seconds).filter(|segment| segment.against.is_some()) else {
            return DVec2::ZERO;
        };
        let Twist { vx, vy, omega } = self.twist_of_centre(model);
        let heading = self.piece.state.world_from_axle.heading.turned(omega * seconds).direction();
        DVec2::new(heading.x, -heading.y).rotate(segment.velocity(seconds)) - DVec2::new(vx, vy)
    }

    /// The stage that the first tick opens after errors have moved the body against a wall, if that happens up to
    /// `limit`. `None` if the next stage would press against a wall too.
    fn next_after_contact(&mut self, vehicle: &Vehicle, walls: &Walls, limit: Time) -> Option<Self> {
        self.explore(vehicle, walls, (limit - self.piece.start).seconds());
        let tick = (self.piece.end() + (TICK - Time(1))).floor_to(TICK);
        if !self.piece.has_ended(limit) || tick > limit {
            return None;
        }
        if self.is_erring()
            && matches!(self.piece.cause, Cause::Impact { with, .. } if matches!(with.thing, Thing::Wall(_)))
        {
            let mut next = self.at_tick(vehicle, tick);
            next.explore(vehicle, walls, 0.0);
            if next.piece.after > 0.0 || !matches!(next.piece.cause, Cause::Impact { .. }) {
                return Some(next);
            }
        }
        self.steady = true;
        None
    }

    fn at_tick(&self, vehicle: &Vehicle, tick: Time) -> Self {
        let (state, orders) = (self.state(&vehicle.model, tick), self.orders_at(tick));
        let before = self.actuation_before(&vehicle.model, tick);
        let mut next = Self::open(vehicle, tick, state, orders, before, &[], self.grip);
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
        let Orders { controllers, pending, steering } = &self.orders;
        control::step(model, controllers, pending.target(), *steering, &self.during)
    }

    /// The orders in force at `at`, with the part of a drive that is left.
    pub fn orders_at(&self, at: Time) -> Orders {
        let pending = match self.orders.pending {
            Pending::Drive { whole, remaining, rate } => {
                if matches!(self.piece.cause, Cause::Arrived(_)) && self.piece.has_ended(at) {
                    Pending::Idle
                } else {
                    let seconds = (at - self.piece.start).seconds().min(self.piece.after);
                    let distance = self.piece.covered(self.piece.rates.nominal, seconds);
                    let remaining = Twist {
                        vx: remaining.vx - distance.vx,
                        vy: remaining.vy - distance.vy,
                        omega: remaining.omega - distance.omega,
                    };
                    Pending::Drive { whole, remaining, rate }
                }
            }
            other => other,
        };
        Orders { pending, steering: self.orders.steering, controllers: self.orders.controllers.clone() }
    }

    /// End of the drive, rounded up to a microsecond; `None` if there is no drive or an obstacle stops the body before.
    pub fn drive_end(&mut self, vehicle: &Vehicle, walls: &Walls) -> Option<Time> {
        if vehicle.contact == ContactRule::Stall {
            self.explore(vehicle, walls, self.piece.after);
        }
        matches!(self.piece.cause, Cause::Arrived(_)).then(|| self.piece.end())
    }

    /// State of wheels, controllers and hull just before `at`.
    pub fn actuation_before(&self, model: &Model, at: Time) -> Actuation {
        if at == self.piece.start {
            return self.before.clone();
        }
        let mut before = self.during.clone();
        let is_afloat = model.kind == DriveKind::Thrusters;
        if self.piece.has_ended(at) {
            // A hull that is held continues to rise or sink.
            before.rates = [0.0, 0.0, 0.0, if is_afloat { before.rates[3] } else { 0.0 }];
            if is_afloat {
                before.memory.afloat.velocity[..3].fill(0.0);
            }
        } else if is_afloat && at.floor_to(TICK) == at {
            let impulse = self.impulse(model, at);
            let [ahead, sideways, ..] = &mut before.memory.afloat.velocity;
            *ahead += impulse.x;
            *sideways += impulse.y;
        }
        before
    }

    /// The robot that ends the stage by blocking the body, with the touched point.
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
fn gauss(f: impl Fn(f64) -> f64, end: f64) -> f64 {
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

/// State of wheels, controllers and hull from `start` on: wheels without lag follow their orders at once; wheels with a lag
/// and a hull advance one step if `start` is a tick.
fn actuate(vehicle: &Vehicle, start: Time, orders: &Orders, before: &Actuation) -> Actuation {
    let model = &*vehicle.model;
    if let Some(hull) = &vehicle.hull {
        if start.floor_to(TICK) == start { swim(model, hull, orders, before) } else { before.clone() }
    } else if model.wheel_lag == 0.0 {
        Actuation { rates: orders.pending.target().wheels(model), memory: before.memory.clone() }
    } else if start.floor_to(TICK) == start {
        control::step(model, &orders.controllers, orders.pending.target(), orders.steering, before)
    } else {
        before.clone()
    }
}

/// One tick of a hull.
fn swim(model: &Model, hull: &Hull, orders: &Orders, before: &Actuation) -> Actuation {
    let mut after = before.clone();
    let memory = &mut *after.memory;
    (after.rates, memory.afloat) = hull.step(model, &orders.pending.target().wheels(model), &memory.afloat);
    after
}

/// Twist of the axle that the orders ask for.
fn ordered_twist(model: &Model, orders: &Orders, during: &Actuation) -> Twist {
    match orders.pending {
        // The ordered twist itself is exact; a conversion to wheel rates and back would round.
        Pending::Twist(twist) | Pending::Drive { rate: twist, .. } if model.wheel_lag == 0.0 => twist,
        _ => model.twist_from_wheels(&during.rates, orders.steering),
    }
}

/// Rates, duration in seconds and reason of the end of a piece without walls; `fraction` is the fraction of the ordered
/// twist.
fn motion_of(
    model: &Model,
    orders: &Orders,
    ordered: Twist,
    erring: &ErringTwists,
    during: &Actuation,
    fraction: f64,
) -> (Rates, f64, Cause) {
    // A factor of 1 keeps the result bit-identical.
    let nominal = ordered.scaled(fraction);
    let rates = Rates {
        truth: erring.truth.scaled(fraction),
        nominal,
        odometry: erring.odometry.scaled(fraction),
        wheels: during.rates.map(|rate| rate * fraction),
    };
    let Pending::Drive { whole, remaining, .. } = orders.pending else { return (rates, f64::INFINITY, Cause::Open) };
    let remaining_path = Pending::progress(whole, remaining);
    let speed = Pending::progress(whole, ordered);
    if remaining_path <= 0.0 || (speed <= 0.0 && model.wheel_lag == 0.0) {
        (rates, 0.0, Cause::Arrived(if model.wheel_lag == 0.0 { remaining } else { Twist::ZERO }))
    } else if speed <= 0.0 || fraction == 0.0 {
        (rates, f64::INFINITY, Cause::Open)
    } else {
        let after = remaining_path / (speed * fraction);
        (rates, after, Cause::Arrived(if model.wheel_lag == 0.0 { remaining } else { nominal.scaled(after) }))
    }
}
