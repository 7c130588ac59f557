//! One stage of a plan: a piece of motion, the orders that it follows, and the walls that end it.

use glam::DVec2;

use super::{
    HISTORY,
    command::{Orders, Pending},
    control::{self, Actuation},
    hull::{Afloat, Hull},
    imperfection::{ContactRule, Erring, Vehicle},
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

/// A piece, with what is needed to go on from it.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    pub piece: Piece,
    pub orders: Orders,
    /// The wheels and controllers just before the stage, so that a command at the same instant starts from there.
    pub before: Actuation,
    /// The wheels and controllers during the stage.
    pub during: Actuation,
    /// The centre's path.
    pub path: Path,
    /// The true twist of the axle that comes of its orders, which an object may slow.
    pub ordered: Twist,
    /// What movable objects leave of it.
    pub grip: Grip,
    /// Walls have been looked for up to here, seconds since the start.
    pub explored: f64,
    /// The robot was put here: what it touched before it has left.
    pub is_placed: bool,
    /// Its errors are drawn for this tick.
    is_drawn: bool,
    /// Its errors would press it against what it touches: so it moves as its wheels tell, until then.
    yields: Option<Time>,
    /// The next ticks change nothing.
    steady: bool,
    /// Where the body goes from its first contact with a wall on, if contacts make it slide: in the order of time.
    pub legs: Vec<Leg>,
}

/// A stretch of a stage that follows a contact with a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    /// Seconds from the stage's start to the leg's.
    pub from: f64,
    /// Seconds that it lasts; infinite while its end is not known.
    pub after: f64,
    /// The centre's path.
    pub path: Path,
    /// Length of the axle's path from the stage's start to the leg's, m.
    pub covered: f64,
    /// What the body is pressed against.
    pub against: Option<(WallId, DVec2)>,
    /// The wall was not in contact before.
    pub is_fresh: bool,
    /// The wall that ends it, if that was not touched before.
    pub meets: Option<WallId>,
}

impl Leg {
    /// Its passage, where the stage's is `whole`.
    fn passage(&self, whole: &Passage) -> Passage {
        Passage { begin: self.from, after: (self.from + self.after).min(whole.after), path: self.path, ..*whole }
    }

    /// Where the centre is `seconds` after the stage's start.
    fn position(&self, seconds: f64) -> DVec2 {
        self.path.position((seconds - self.from).clamp(0.0, self.after))
    }

    /// The centre's velocity then, in the world.
    fn velocity(&self, seconds: f64) -> DVec2 {
        self.path.velocity((seconds - self.from).clamp(0.0, self.after))
    }
}

/// Share of the speed of the wheels over the floor by which they slip, from which on they count as stalled: our choice.
const STALL_SLIP: f64 = 0.5;

/// So many legs in less than [`RUSH_SECONDS`] are followed by a rest: our choice.
const RUSH_LEGS: usize = 16;

/// How soon [`RUSH_LEGS`] legs have to follow each other, and how long the rest is that ends them, s.
const RUSH_SECONDS: f64 = 1e-3;

/// How fast a robot gets along its own path among movable objects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grip {
    /// Share of the ordered twist, 0 to 1.
    pub share: f64,
    /// What it presses, for a share below 1.
    pub obstacle: Option<Obstacle>,
}

impl Grip {
    /// Nothing is in the way.
    pub const FREE: Self = Self { share: 1.0, obstacle: None };
}

/// Static contact is looked for this many seconds ahead at first, then twice as far each time.
const FIRST_LOOK: f64 = 0.1;

impl Stage {
    /// The stage that obeys `orders` from `start` on, from `state` with the wheels `before`; blocked at once by a body of
    /// `touching` that it would approach.
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
        let during = actuate(vehicle, start, &orders, before);
        let belief = ordered_twist(model, &orders, &during);
        let erring = vehicle.erring(start, &orders, &during, belief);
        let (rates, after, cause) = motion_of(model, &orders, belief, &erring, &during, grip.share);
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
            yields: None,
            steady: false,
            legs: Vec::new(),
        };
        stage.set_path(model);
        let mut obstacle = stage.approached(model.body_radius, touching);
        if obstacle.is_some() && stage.is_erring() {
            // Another robot is felt at the end of its slots only: once is for as long as counts as one contact.
            stage.yield_to_contact(model, start + HISTORY);
            obstacle = stage.approached(model.body_radius, touching);
        }
        if let Some(obstacle) = obstacle {
            stage.stop(0.0, obstacle, true);
        }
        if let Grip { share: 0.0, obstacle: Some(obstacle) } = grip
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
        // Not even the start: a contact may stop it at once.
        self.explored = if self.path.is_resting() { f64::INFINITY } else { -1.0 };
    }

    /// The twist of the centre without contacts, in the robot's frame.
    fn twist_of_centre(&self, model: &Model) -> Twist {
        self.piece.rates.truth.at_offset(DVec2::new(-model.axis_offset, 0.0))
    }

    /// The leg in force `seconds` after the start, if contacts have begun by then.
    pub fn leg_at(&self, seconds: f64) -> Option<&Leg> {
        let index = self.legs.partition_point(|leg| leg.from <= seconds);
        index.checked_sub(1).map(|last| &self.legs[last])
    }

    /// Seconds after the start at `at`, not beyond the end.
    fn seconds_at(&self, at: Time) -> f64 {
        (at - self.piece.start).seconds().clamp(0.0, self.piece.after.max(0.0))
    }

    /// The state at `at`, not before the start: a function of `at` alone.
    pub fn state(&self, model: &Model, at: Time) -> State {
        self.state_after(model, (at - self.piece.start).seconds())
    }

    /// The state `seconds` after the start.
    fn state_after(&self, model: &Model, seconds: f64) -> State {
        let state = self.piece.state_after(seconds);
        let seconds = seconds.clamp(0.0, self.piece.after.max(0.0));
        let Some(leg) = self.leg_at(seconds) else { return state };
        let path = self.piece.state.path + (leg.covered + self.length_on(model, leg, seconds - leg.from));
        State { world_from_axle: axle_of(model, &self.centre_after(model, seconds)), path, ..state }
    }

    /// Pose of the robot's centre at `at`, not before the start.
    pub fn centre(&self, model: &Model, at: Time) -> Pose {
        self.centre_after(model, self.seconds_at(at))
    }

    pub fn centre_after(&self, model: &Model, seconds: f64) -> Pose {
        let seconds = seconds.clamp(0.0, self.piece.after.max(0.0));
        let Some(leg) = self.leg_at(seconds) else {
            let axle = self.piece.state.world_from_axle.moved(self.piece.covered(self.piece.rates.truth, seconds));
            return centre_of(model, &axle);
        };
        let heading = self.piece.state.world_from_axle.heading.turned(leg.path.omega() * seconds);
        Pose { position: leg.position(seconds), heading }
    }

    /// Adds the passages of the body that touch the time from `from` to `to`; the next stage begins at `until`.
    pub fn passages(&self, from: Time, until: Time, to: Time, passages: &mut Vec<Passage>) {
        let Piece { start, state, after, .. } = self.piece;
        let heading = state.world_from_axle.heading;
        let whole = Passage { start, begin: 0.0, until, after, path: self.path, heading };
        if self.legs.is_empty() {
            passages.push(whole);
            return;
        }
        let seconds = (from - start).seconds();
        let first = self.legs.partition_point(|leg| leg.from <= seconds);
        let begun = |leg: &&Leg| (to.min(until) - start).seconds() >= leg.from;
        let at_first = first.checked_sub(1).map_or(whole, |first| self.legs[first].passage(&whole));
        passages.push(at_first);
        for leg in self.legs[first..].iter().take_while(begun) {
            let begin = leg.from;
            let last = passages.last_mut().expect("one has been added");
            last.until = start + Time::from_seconds_ceil(begin);
            last.after = begin;
            passages.push(leg.passage(&whole));
        }
    }

    /// Length of the axle's path in the first `seconds` of a leg, m.
    fn length_on(&self, model: &Model, leg: &Leg, seconds: f64) -> f64 {
        let omega = leg.path.omega();
        let seconds = seconds.min(leg.after);
        match leg.path.pace {
            Pace::Even if leg.against.is_none() => self.piece.rates.truth.speed() * seconds,
            Pace::Even => (omega * model.axis_offset * seconds).abs(),
            Pace::Led { law, .. } if model.axis_offset == 0.0 || omega == 0.0 => law.length(seconds),
            // Beside the axle there is no closed form.
            Pace::Led { .. } => {
                let heading = self.piece.state.world_from_axle.heading.turned(omega * leg.from).direction();
                let speed = |t: f64| {
                    let (sin, cos) = math::sin_cos(omega * t);
                    let ahead = heading.rotate(DVec2::new(cos, sin));
                    (leg.path.velocity(t) + ahead.perp() * (omega * model.axis_offset)).length()
                };
                gauss(speed, seconds)
            }
        }
    }

    /// What the body is pressed against at `at`, and by what share of the speed that its wheels are to give it they slip.
    pub fn slip(&self, model: &Model, at: Time) -> Option<(&Leg, f64)> {
        if self.piece.has_ended(at) {
            return None;
        }
        let seconds = self.seconds_at(at);
        let leg = self.leg_at(seconds).filter(|leg| leg.against.is_some())?;
        let Twist { vx, vy, omega } = self.twist_of_centre(model);
        let heading = self.piece.state.world_from_axle.heading.turned(omega * seconds).direction();
        let pushed = heading.rotate(DVec2::new(vx, vy));
        let speed = pushed.length();
        let slip = (pushed - leg.velocity(seconds)).length();
        Some((leg, if speed > 0.0 { slip / speed } else { 0.0 }))
    }

    /// True when the wheels slip at `at` by so much that they count as stalled.
    pub fn is_slipping(&self, model: &Model, at: Time) -> bool {
        self.slip(model, at).is_some_and(|(_, share)| share > STALL_SLIP)
    }

    /// Forgets the legs that have ended before an instant.
    pub fn forget_legs(&mut self, before: Time) {
        let seconds = (before - self.piece.start).seconds();
        let kept = self.legs.partition_point(|leg| leg.from <= seconds);
        // One at a time is not worth it.
        if kept > 64 {
            self.legs.drain(..kept - 1);
        }
    }

    /// The body moves otherwise than its wheels tell.
    fn is_erring(&self) -> bool {
        self.piece.rates.truth != self.piece.rates.belief
    }

    /// Moves as the wheels tell until an instant: what only its errors would press into a contact slips there.
    fn yield_to_contact(&mut self, model: &Model, until: Time) {
        self.ordered = ordered_twist(model, &self.orders, &self.during);
        self.piece.rates.truth = self.piece.rates.belief;
        self.yields = Some(until);
        self.set_path(model);
    }

    /// The twist of the centre that is ordered at `at`, in the robot's frame, as far as walls leave it.
    pub fn ordered_at_centre(&self, model: &Model, at: Time) -> Twist {
        let ordered = self.ordered.at_offset(DVec2::new(-model.axis_offset, 0.0));
        let seconds = self.seconds_at(at);
        let Some(leg) = self.leg_at(seconds).filter(|leg| leg.against.is_some() && self.grip.share > 0.0) else {
            return ordered;
        };
        let heading = self.piece.state.world_from_axle.heading.turned(leg.path.omega() * seconds).direction();
        let velocity = DVec2::new(heading.x, -heading.y).rotate(leg.velocity(seconds)) / self.grip.share;
        Twist { vx: velocity.x, vy: velocity.y, ..ordered }
    }

    /// True when the robot is held by a movable object at `at`.
    pub fn is_held(&self, at: Time) -> bool {
        matches!(self.piece.cause, Cause::Impact { with, .. } if matches!(with.thing, Thing::Object(_)))
            && self.piece.has_ended(at)
    }

    /// The body of `touching` that the robot approaches as the stage begins, the first in their order.
    fn approached(&self, radius: f64, touching: &[Body]) -> Option<Obstacle> {
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
        self.legs.retain(|leg| leg.from <= seconds);
        self.piece.after = seconds;
        self.piece.cause = Cause::Impact { with: obstacle, fresh };
        self.explored = f64::INFINITY;
    }

    /// Looks for walls in the way as far as `seconds` after the start, and ends the stage at the first.
    ///
    /// Contact with each wall is found for the whole path, and the stretches of the search are counted from the start: so
    /// the outcome does not depend on who asked how far before.
    pub fn explore(&mut self, vehicle: &Vehicle, walls: &Walls, seconds: f64) {
        while self.explored < seconds.min(self.piece.after) {
            let last = self.legs.last().copied();
            if let Some(Leg { from, after, meets, against: Some(_), .. }) = last {
                self.begin_leg(vehicle, walls, from + after, meets, meets.is_some());
                continue;
            }
            let start = last.map_or(0.0, |leg| leg.from);
            let from = (self.explored - start).max(0.0);
            let to = (2.0 * from).max(FIRST_LOOK);
            self.explored = if from >= self.last_path().period() { f64::INFINITY } else { start + to };
            if self.explored.is_finite() {
                self.explore_stretch(vehicle, walls, from, to.min(self.piece.after - start));
            }
        }
    }

    /// The path of the leg that has been found last.
    fn last_path(&self) -> &Path {
        self.legs.last().map_or(&self.path, |leg| &leg.path)
    }

    fn explore_stretch(&mut self, vehicle: &Vehicle, walls: &Walls, from: f64, to: f64) {
        let model = &*vehicle.model;
        let radius = model.body_radius;
        let start = self.legs.last().map_or(0.0, |leg| leg.from);
        let path = *self.last_path();
        let duration = self.piece.after - start;
        let (middle, half_way) = path.surrounding_disc(from, to);
        // The skin once for the contact itself, once for rounding.
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
        // A drive that ends where it touches has arrived.
        let Some((after, id, wall, fresh)) = first.filter(|(after, ..)| *after < duration) else { return };
        if vehicle.contact != ContactRule::Stall {
            if let Some(leg) = self.legs.last_mut() {
                leg.after = after;
            }
            return self.begin_leg(vehicle, walls, start + after, Some(id), fresh);
        }
        if after == 0.0 && self.is_erring() {
            return self.yield_to_contact(model, self.next_tick());
        }
        let point = wall.nearest_point(path.position(after));
        self.stop(after, Obstacle { thing: Thing::Wall(id), point }, fresh);
    }

    /// Begins the leg that follows the end of another one or a contact, `from` seconds after the start. `met`: what is met there;
    /// `is_fresh`: it was not touched before.
    fn begin_leg(&mut self, vehicle: &Vehicle, walls: &Walls, from: f64, met: Option<WallId>, is_fresh: bool) {
        let model = &*vehicle.model;
        let ContactRule::Slide { friction } = vehicle.contact else { return };
        let centre = self.centre_after(model, from);
        let covered = self.state_after(model, from).path - self.piece.state.path;
        let push = Push { free: Path::new(&centre, self.twist_of_centre(model)), radius: model.body_radius, friction };
        let earlier = self.legs.len().checked_sub(RUSH_LEGS).map(|earlier| self.legs[earlier].from);
        let slide = if earlier.is_some_and(|earlier| from - earlier < RUSH_SECONDS) {
            push.resting(RUSH_SECONDS, self.legs.last().and_then(|leg| leg.against))
        } else {
            push.slide(walls, met, self.piece.after - from)
        };
        self.explored = match slide.against {
            // Its contacts let it go: what it meets is looked for from here on.
            None => from,
            Some(_) if from + slide.after < self.piece.after => from + slide.after,
            Some(_) => f64::INFINITY,
        };
        let Slide { path, after, against, meets } = slide;
        self.legs.push(Leg { from, after, path, covered, against, is_fresh, meets });
    }

    /// The stage that a tick opens after this one, if one does not after `limit`: only wheels with a lag, a robot with
    /// errors and a hull under water have any.
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
        if is_settled && !self.is_erring() && !self.is_drawn && self.yields.is_none() {
            self.steady = true;
            return None;
        }
        if is_settled && !self.is_drawn && self.yields.is_none() && vehicle.contact != ContactRule::Stall {
            // Its errors stay, and no wall ends the piece.
            self.steady = true;
            return None;
        }
        self.explore(vehicle, walls, (tick - self.piece.start).seconds());
        if self.piece.has_ended(tick) || is_settled && !self.is_drawn && self.yields.is_none() {
            return self.next_after_contact(vehicle, walls, limit);
        }
        Some(self.at_tick(vehicle, tick))
    }

    /// No tick opens another stage after this one.
    fn has_no_ticks(&self, vehicle: &Vehicle) -> bool {
        self.steady || vehicle.model.wheel_lag == 0.0 && vehicle.errors.is_none() && vehicle.hull.is_none()
    }

    /// The last microsecond before which it is known that no wall, mark or tick ends this stage: its start, if that is not
    /// known.
    pub fn steady_until(&self, vehicle: &Vehicle) -> Time {
        // Legs along walls are published one by one.
        if !self.has_no_ticks(vehicle) || !self.legs.is_empty() {
            return self.piece.start;
        }
        let known = self.explored.min(self.piece.after).max(0.0);
        self.piece.start.saturating_add(Time::from_seconds_ceil(known)) - Time(1)
    }

    /// The stage of a hull that a tick opens after this one, if one does not after `limit`: none while nothing changes, up
    /// to the first tick after a contact with a wall.
    fn next_afloat(&mut self, vehicle: &Vehicle, hull: &Hull, walls: &Walls, limit: Time) -> Option<Self> {
        let mut tick = self.next_tick();
        if tick > limit {
            return None;
        }
        self.steady = swim(&vehicle.model, hull, &self.orders, self.during) == self.during;
        if self.steady {
            self.explore(vehicle, walls, (limit - self.piece.start).seconds());
            let contact = self.piece.start + Time::from_seconds_ceil(self.legs.first()?.from);
            tick = tick.max((contact + (TICK - Time(1))).floor_to(TICK));
        } else {
            self.explore(vehicle, walls, (tick - self.piece.start).seconds());
        }
        (tick <= limit && !self.piece.has_ended(tick)).then(|| self.at_tick(vehicle, tick))
    }

    /// Height of a hull above the floor at `at`, m; of other robots 0.
    pub fn lift(&self, at: Time) -> f64 {
        let Afloat { lift, .. } = self.during.afloat;
        lift - self.during.rates[3] * (self.next_tick() - at).seconds().max(0.0)
    }

    /// The change of a hull's velocity by what it is pressed against at `at`, in its frame, m/s: it loses that part of its
    /// speed that the contact takes.
    fn impulse(&self, model: &Model, at: Time) -> DVec2 {
        let seconds = self.seconds_at(at);
        let Some(leg) = self.leg_at(seconds).filter(|leg| leg.against.is_some()) else { return DVec2::ZERO };
        let Twist { vx, vy, omega } = self.twist_of_centre(model);
        let heading = self.piece.state.world_from_axle.heading.turned(omega * seconds).direction();
        DVec2::new(heading.x, -heading.y).rotate(leg.velocity(seconds)) - DVec2::new(vx, vy)
    }

    /// The stage that the first tick opens after errors have brought the body to a wall, if one does not after `limit`: none
    /// if what is commanded leads into the wall too.
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
        if let Some(until) = self.yields.filter(|until| *until > tick) {
            next.yield_to_contact(&vehicle.model, until);
        }
        next
    }

    fn next_tick(&self) -> Time {
        self.piece.start.floor_to(TICK) + TICK
    }

    /// The wheels and controllers after one more tick.
    fn step(&self, model: &Model) -> Actuation {
        let Orders { controllers, pending, steering } = &self.orders;
        control::step(model, controllers, pending.target(), *steering, self.during)
    }

    /// The orders still to be obeyed at `at`.
    pub fn orders_at(&self, at: Time) -> Orders {
        let pending = match self.orders.pending {
            Pending::Drive { whole, remaining, rate } => {
                if matches!(self.piece.cause, Cause::Arrived(_)) && self.piece.has_ended(at) {
                    Pending::Idle
                } else {
                    let seconds = (at - self.piece.start).seconds().min(self.piece.after);
                    let covered = self.piece.covered(self.piece.rates.belief, seconds);
                    let remaining = Twist {
                        vx: remaining.vx - covered.vx,
                        vy: remaining.vy - covered.vy,
                        omega: remaining.omega - covered.omega,
                    };
                    Pending::Drive { whole, remaining, rate }
                }
            }
            other => other,
        };
        Orders { pending, ..self.orders }
    }

    /// The first microsecond at which the drive of its orders is done, if nothing stops it before.
    pub fn drive_end(&mut self, vehicle: &Vehicle, walls: &Walls) -> Option<Time> {
        if vehicle.contact == ContactRule::Stall {
            self.explore(vehicle, walls, self.piece.after);
        }
        matches!(self.piece.cause, Cause::Arrived(_)).then(|| self.piece.end())
    }

    /// The wheels and controllers just before `at`.
    pub fn actuation_before(&self, model: &Model, at: Time) -> Actuation {
        if at == self.piece.start {
            return self.before;
        }
        let mut before = self.during;
        let Afloat { velocity: [ahead, aside, turn, _], .. } = &mut before.afloat;
        if self.piece.has_ended(at) {
            [*ahead, *aside, *turn] = [0.0; 3];
            // A hull that is held goes on to rise or sink.
            before.rates = [0.0, 0.0, 0.0, if model.kind == DriveKind::Thrusters { before.rates[3] } else { 0.0 }];
        } else if model.kind == DriveKind::Thrusters && at.floor_to(TICK) == at {
            let impulse = self.impulse(model, at);
            *ahead += impulse.x;
            *aside += impulse.y;
        }
        before
    }

    /// The robot that the body is blocked by, once the stage has ended.
    pub fn blocker(&self) -> Option<Obstacle> {
        match self.piece.cause {
            Cause::Impact { with, .. } if matches!(with.thing, Thing::Robot(_)) => Some(with),
            _ => None,
        }
    }
}

/// The centre of the robot, as a pose in the world.
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

/// The integral of a smooth function from 0 to `end`: the rule of Gauss and Legendre with 8 points on each of 4 parts.
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

/// The wheels and controllers from `start` on: at once what is ordered, or with a lag or a hull one step on the grid of
/// ticks.
fn actuate(vehicle: &Vehicle, start: Time, orders: &Orders, before: Actuation) -> Actuation {
    let model = &*vehicle.model;
    if let Some(hull) = &vehicle.hull {
        if start.floor_to(TICK) == start { swim(model, hull, orders, before) } else { before }
    } else if model.wheel_lag == 0.0 {
        Actuation { rates: orders.pending.target().wheels(model), ..before }
    } else if start.floor_to(TICK) == start {
        control::step(model, &orders.controllers, orders.pending.target(), orders.steering, before)
    } else {
        before
    }
}

/// One tick of a hull.
fn swim(model: &Model, hull: &Hull, orders: &Orders, before: Actuation) -> Actuation {
    let (rates, afloat) = hull.step(model, &orders.pending.target().wheels(model), &before.afloat);
    Actuation { rates, afloat, ..before }
}

/// The twist of the axle that the orders ask for.
fn ordered_twist(model: &Model, orders: &Orders, during: &Actuation) -> Twist {
    match orders.pending {
        // The twist itself, not what its wheels give back.
        Pending::Twist(twist) | Pending::Drive { rate: twist, .. } if model.wheel_lag == 0.0 => twist,
        _ => model.twist_from_wheels(&during.rates, orders.steering),
    }
}

/// Rates, end and its cause in a space without walls, with this share of the ordered twists.
fn motion_of(
    model: &Model,
    orders: &Orders,
    ordered: Twist,
    erring: &Erring,
    during: &Actuation,
    share: f64,
) -> (Rates, f64, Cause) {
    // Times 1 changes no bit.
    let belief = ordered.scaled(share);
    let rates = Rates {
        truth: erring.truth.scaled(share),
        belief,
        odometry: erring.odometry.scaled(share),
        wheels: during.rates.map(|rate| rate * share),
    };
    let Pending::Drive { whole, remaining, .. } = orders.pending else { return (rates, f64::INFINITY, Cause::Open) };
    let left = Pending::progress(whole, remaining);
    let speed = Pending::progress(whole, ordered);
    if left <= 0.0 || (speed <= 0.0 && model.wheel_lag == 0.0) {
        (rates, 0.0, Cause::Arrived(if model.wheel_lag == 0.0 { remaining } else { Twist::ZERO }))
    } else if speed <= 0.0 || share == 0.0 {
        (rates, f64::INFINITY, Cause::Open)
    } else {
        let after = left / (speed * share);
        (rates, after, Cause::Arrived(if model.wheel_lag == 0.0 { remaining } else { belief.scaled(after) }))
    }
}
