//! One stage of a plan: a piece of motion, the orders that it follows, and the walls that end it.

use glam::DVec2;

use super::{
    HISTORY,
    command::{Orders, Pending},
    control::{self, Actuation},
    imperfection::{Erring, Vehicle},
    model::Model,
    piece::{Cause, Piece, Rates, State},
};
use crate::{
    contact::{APPROACH, Body, Obstacle, Path, SKIN, TOUCH, Thing, first_contact},
    pose::{Pose, Twist},
    scene::{Bounds, Segment, WallId, Walls},
    time::{TICK, Time},
};

/// A piece, with what is needed to go on from it.
#[derive(Clone, Copy, Debug)]
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
}

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
        let during = actuate(model, start, &orders, before);
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
        self.path = Path::new(&centre, self.piece.rates.truth.at_offset(DVec2::new(-model.axis_offset, 0.0)));
        // Not even the start: a contact may stop it at once.
        self.explored = if self.path.is_resting() { f64::INFINITY } else { -1.0 };
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

    /// The twist of the centre that is ordered, in the robot's frame.
    pub fn ordered_at_centre(&self, model: &Model) -> Twist {
        self.ordered.at_offset(DVec2::new(-model.axis_offset, 0.0))
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
        self.piece.after = seconds;
        self.piece.cause = Cause::Impact { with: obstacle, fresh };
        self.explored = f64::INFINITY;
    }

    /// Looks for walls in the way as far as `seconds` after the start, and ends the stage at the first.
    ///
    /// Contact with each wall is found for the whole path, and the stretches of the search are counted from the start: so
    /// the outcome does not depend on who asked how far before.
    pub fn explore(&mut self, model: &Model, walls: &Walls, seconds: f64) {
        while self.explored < seconds.min(self.piece.after) {
            let from = self.explored.max(0.0);
            let to = (2.0 * from).max(FIRST_LOOK);
            self.explored = if from >= self.path.period() { f64::INFINITY } else { to };
            if self.explored.is_finite() {
                self.explore_stretch(model, walls, from, to.min(self.piece.after));
            }
        }
    }

    fn explore_stretch(&mut self, model: &Model, walls: &Walls, from: f64, to: f64) {
        let radius = model.body_radius;
        let (middle, half_way) = self.path.surrounding_disc(from, to);
        // The skin once for the contact itself, once for rounding.
        let reach = half_way + radius + 2.0 * SKIN;
        let mut first: Option<(f64, WallId, Segment, bool)> = None;
        walls.for_each_in(Bounds::of_disc(middle, reach), |id, wall| {
            if (wall.nearest_point(middle) - middle).length_squared() > reach * reach {
                return;
            }
            let Some(contact) = first_contact(&self.path, radius, wall, self.piece.after) else { return };
            let is_first = first.is_none_or(|(after, best, ..)| (contact.after, id) < (after, best));
            if contact.after <= to && is_first {
                first = Some((contact.after, id, *wall, contact.fresh));
            }
        });
        // A drive that ends where it touches has arrived.
        if let Some((after, id, wall, fresh)) = first
            && after < self.piece.after
        {
            if after == 0.0 && self.is_erring() {
                return self.yield_to_contact(model, self.next_tick());
            }
            let point = wall.nearest_point(self.path.position(after));
            self.stop(after, Obstacle { thing: Thing::Wall(id), point }, fresh);
        }
    }

    /// The stage that a tick opens after this one, if one does not after `limit`: only wheels with a lag and a robot with
    /// errors have any.
    pub fn next(&mut self, vehicle: &Vehicle, walls: &Walls, limit: Time) -> Option<Self> {
        let model = &*vehicle.model;
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
        self.explore(model, walls, (tick - self.piece.start).seconds());
        if self.piece.has_ended(tick) || is_settled && !self.is_drawn && self.yields.is_none() {
            return self.next_after_contact(vehicle, walls, limit);
        }
        Some(self.at_tick(vehicle, tick))
    }

    /// No tick opens another stage after this one.
    fn has_no_ticks(&self, vehicle: &Vehicle) -> bool {
        self.steady || vehicle.model.wheel_lag == 0.0 && vehicle.errors.is_none()
    }

    /// The last microsecond before which it is known that no wall, mark or tick ends this stage: its start, if that is not
    /// known.
    pub fn steady_until(&self, vehicle: &Vehicle) -> Time {
        if !self.has_no_ticks(vehicle) {
            return self.piece.start;
        }
        let known = self.explored.min(self.piece.after).max(0.0);
        self.piece.start.saturating_add(Time::from_seconds_ceil(known)) - Time(1)
    }

    /// The stage that the first tick opens after errors have brought the body to a wall, if one does not after `limit`: none
    /// if what is commanded leads into the wall too.
    fn next_after_contact(&mut self, vehicle: &Vehicle, walls: &Walls, limit: Time) -> Option<Self> {
        let model = &*vehicle.model;
        self.explore(model, walls, (limit - self.piece.start).seconds());
        let tick = (self.piece.end() + (TICK - Time(1))).floor_to(TICK);
        if !self.piece.has_ended(limit) || tick > limit {
            return None;
        }
        if self.is_erring()
            && matches!(self.piece.cause, Cause::Impact { with, .. } if matches!(with.thing, Thing::Wall(_)))
        {
            let mut next = self.at_tick(vehicle, tick);
            next.explore(model, walls, 0.0);
            if next.piece.after > 0.0 || !matches!(next.piece.cause, Cause::Impact { .. }) {
                return Some(next);
            }
        }
        self.steady = true;
        None
    }

    fn at_tick(&self, vehicle: &Vehicle, tick: Time) -> Self {
        let (state, orders) = (self.piece.state(tick), self.orders_at(tick));
        let mut next = Self::open(vehicle, tick, state, orders, self.actuation_before(tick), &[], self.grip);
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
        self.explore(&vehicle.model, walls, self.piece.after);
        matches!(self.piece.cause, Cause::Arrived(_)).then(|| self.piece.end())
    }

    /// The wheels and controllers just before `at`.
    pub fn actuation_before(&self, at: Time) -> Actuation {
        if at == self.piece.start {
            self.before
        } else if self.piece.has_ended(at) {
            Actuation { rates: [0.0; 4], ..self.during }
        } else {
            self.during
        }
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

/// The wheels and controllers from `start` on: at once what is ordered, or with a lag one step on the grid of ticks.
fn actuate(model: &Model, start: Time, orders: &Orders, before: Actuation) -> Actuation {
    if model.wheel_lag == 0.0 {
        Actuation { rates: orders.pending.target().wheels(model), ..before }
    } else if start.floor_to(TICK) == start {
        control::step(model, &orders.controllers, orders.pending.target(), orders.steering, before)
    } else {
        before
    }
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
