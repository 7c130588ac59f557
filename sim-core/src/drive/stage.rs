//! One stage of a plan: a piece of motion, the orders that it follows, and the walls that end it.

use glam::DVec2;

use super::{
    command::{Orders, Pending},
    control::{self, Actuation},
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
    /// The twist of the axle that is ordered, which an object may slow.
    pub ordered: Twist,
    /// What movable objects leave of it.
    pub grip: Grip,
    /// Walls have been looked for up to here, seconds since the start.
    pub explored: f64,
    /// The robot was put here: what it touched before it has left.
    pub is_placed: bool,
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
        model: &Model,
        start: Time,
        state: State,
        orders: Orders,
        before: Actuation,
        touching: &[Body],
        grip: Grip,
    ) -> Self {
        let during = actuate(model, start, &orders, before);
        let ordered = ordered_twist(model, &orders, &during);
        let (rates, after, cause) = motion_of(model, &orders, ordered, &during, grip.share);
        let centre = centre_of(model, &state.world_from_axle);
        let path = Path::new(&centre, rates.truth.at_offset(DVec2::new(-model.axis_offset, 0.0)));
        let piece = Piece { start, state, rates, after, cause };
        // Not even the start: a contact may stop it at once.
        let explored = if path.is_resting() { f64::INFINITY } else { -1.0 };
        let mut stage =
            Self { piece, orders, before, during, path, ordered, grip, explored, is_placed: false, steady: false };
        if let Some(obstacle) = stage.approached(model.body_radius, touching) {
            stage.stop(0.0, obstacle, true);
        }
        if let Grip { share: 0.0, obstacle: Some(obstacle) } = grip
            && !ordered.is_zero()
            && !matches!(cause, Cause::Arrived(_))
        {
            stage.stop(0.0, obstacle, false);
        }
        stage
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
                self.explore_stretch(model.body_radius, walls, from, to.min(self.piece.after));
            }
        }
    }

    fn explore_stretch(&mut self, radius: f64, walls: &Walls, from: f64, to: f64) {
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
            let point = wall.nearest_point(self.path.position(after));
            self.stop(after, Obstacle { thing: Thing::Wall(id), point }, fresh);
        }
    }

    /// The stage that a tick opens after this one, if one does not after `limit`: only wheels with a lag have any.
    pub fn next(&mut self, model: &Model, walls: &Walls, limit: Time) -> Option<Self> {
        if model.wheel_lag == 0.0 || self.steady {
            return None;
        }
        let tick = self.piece.start.floor_to(TICK) + TICK;
        if tick > limit {
            return None;
        }
        let during = control::step(
            model,
            &self.orders.controllers,
            self.orders.pending.target(),
            self.orders.steering,
            self.during,
        );
        if during == self.during {
            self.steady = true;
            return None;
        }
        self.explore(model, walls, (tick - self.piece.start).seconds());
        if self.piece.has_ended(tick) {
            self.steady = true;
            return None;
        }
        let state = self.piece.state(tick);
        Some(Self::open(model, tick, state, self.orders_at(tick), self.during, &[], self.grip))
    }

    /// The orders still to be obeyed at `at`.
    pub fn orders_at(&self, at: Time) -> Orders {
        let pending = match self.orders.pending {
            Pending::Drive { whole, remaining, rate } => {
                if matches!(self.piece.cause, Cause::Arrived(_)) && self.piece.has_ended(at) {
                    Pending::Idle
                } else {
                    let seconds = (at - self.piece.start).seconds().min(self.piece.after);
                    let covered = self.piece.displacements(seconds).1;
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

/// Rates, end and its cause in a space without walls, with this share of the ordered twist.
fn motion_of(model: &Model, orders: &Orders, ordered: Twist, during: &Actuation, share: f64) -> (Rates, f64, Cause) {
    // Times 1 changes no bit.
    let belief = ordered.scaled(share);
    let rates = Rates { truth: belief, belief, wheels: during.rates.map(|rate| rate * share) };
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
