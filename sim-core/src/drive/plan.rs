//! From commands to pieces: what a robot is told to do, and one stage of doing it.

use glam::DVec2;

use super::{
    control::{self, Actuation, Gains, Target},
    model::{DriveKind, Model, Wheels},
    piece::{Cause, Piece, Rates, State},
};
use crate::{
    contact::{APPROACH, Body, Obstacle, Path, SKIN, TOUCH, Thing, first_contact},
    pose::{Pose, Twist},
    scene::{Bounds, Segment, WallId, Walls},
    time::{TICK, Time},
};

/// What a robot's program tells its drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Rates of the motors in the order of the [`DriveKind`], rad/s, each cut to the limit of the wheels.
    Wheels(Wheels),
    /// Steering angle of an Ackermann drive, rad, left positive, cut to its limit.
    Steer(f64),
    /// Speed and turning speed until the next command, within the limits of the robi and the wheels.
    Twist(Twist),
    /// A straight line, an arc or a turn on the spot: `displacement` in `duration` seconds, or as fast as the limits allow.
    Drive {
        /// Arc length (m) and angle (rad) to cover; the drive ends exactly there.
        displacement: Twist,
        /// Seconds to take, from 0 to 10^12.
        duration: f64,
    },
    /// All wheels to rest.
    Halt,
}

/// Why a command was refused; the robot goes on as before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CommandError {
    /// A number is NaN, infinite, negative where it may not be, or beyond 10^12.
    #[error("a value of the command is not a number that can be driven, accepted: finite values up to 1e12")]
    NotFinite,
    /// An Ackermann drive cannot turn without driving.
    #[error("an Ackermann drive cannot turn on the spot, accepted: curves with a length")]
    TurnOnSpot,
    /// The curve is tighter than the steering allows.
    #[error("the curve is too tight for the steering, accepted: a radius of at least {min_radius_mm} mm")]
    TooTight {
        /// Radius of the tightest curve of the rear axle, mm.
        min_radius_mm: u32,
    },
    /// Only an Ackermann drive steers.
    #[error("this drive has no steering, accepted: Ackermann drives")]
    NoSteering,
    /// Only an omni drive moves to the side.
    #[error("this drive cannot move sideways, accepted: omni drives")]
    Sideways,
}

/// The command in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pending {
    Idle,
    Wheels(Wheels),
    Twist(Twist),
    Drive {
        /// The displacement commanded, as far as it counts as progress.
        whole: Twist,
        /// What the robot believes to be left of it.
        remaining: Twist,
        rate: Twist,
    },
}

impl Pending {
    /// Arc length of a displacement along `whole`, m, or its angle, rad, for a turn on the spot.
    pub fn progress(whole: Twist, covered: Twist) -> f64 {
        let length = whole.speed();
        if length > 0.0 {
            whole.vx / length * covered.vx + whole.vy / length * covered.vy
        } else if whole.omega != 0.0 {
            whole.omega.signum() * covered.omega
        } else {
            0.0
        }
    }

    fn target(&self) -> Target {
        match *self {
            Self::Idle => Target::Wheels([0.0; 4]),
            Self::Wheels(rates) => Target::Wheels(rates),
            Self::Twist(twist) | Self::Drive { rate: twist, .. } => Target::Twist(twist),
        }
    }
}

/// What a robot's motion obeys from some instant on, besides its state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Orders {
    pub pending: Pending,
    /// Steering angle of an Ackermann drive.
    pub steering: f64,
    pub gains: Option<Gains>,
}

impl Orders {
    /// These orders with `command` in force.
    pub fn with(self, model: &Model, command: Command) -> Result<Self, CommandError> {
        match command {
            Command::Halt => Ok(Self { pending: Pending::Idle, ..self }),
            Command::Wheels(rates) => {
                if !rates.iter().all(|rate| rate.is_finite()) {
                    return Err(CommandError::NotFinite);
                }
                let mut rates = model.clamp_wheels(&rates);
                rates[model.wheel_count()..].fill(0.0);
                Ok(Self { pending: Pending::Wheels(rates), ..self })
            }
            Command::Steer(angle) => self.steered(model, angle),
            Command::Twist(twist) => self.with_twist(model, twist),
            Command::Drive { displacement, duration } => self.with_drive(model, displacement, duration),
        }
    }

    fn steered(self, model: &Model, angle: f64) -> Result<Self, CommandError> {
        if model.kind != DriveKind::Ackermann {
            return Err(CommandError::NoSteering);
        }
        if !angle.is_finite() {
            return Err(CommandError::NotFinite);
        }
        let steering = angle.clamp(-model.max_steering, model.max_steering);
        let pending = match self.pending {
            // The speed stays; the servo now has the last word about the curve.
            Pending::Twist(twist) => Pending::Wheels(model.wheels_from_twist(twist)),
            // A drive keeps its curve to its end.
            Pending::Drive { .. } => return Ok(self),
            other => other,
        };
        Ok(Self { pending, steering, ..self })
    }

    fn with_twist(self, model: &Model, twist: Twist) -> Result<Self, CommandError> {
        check_drivable(model, twist)?;
        let mut twist = model.clamp_twist(twist);
        let mut steering = self.steering;
        if model.kind == DriveKind::Ackermann && !twist.is_zero() {
            let wanted = model.steering(twist).ok_or(CommandError::TurnOnSpot)?;
            steering = wanted.clamp(-model.max_steering, model.max_steering);
            if steering != wanted {
                twist = model.twist_from_wheels(&model.wheels_from_twist(twist), steering);
            }
        }
        Ok(Self { pending: Pending::Twist(twist), steering, ..self })
    }

    fn with_drive(self, model: &Model, displacement: Twist, duration: f64) -> Result<Self, CommandError> {
        check_drivable(model, displacement)?;
        if !(0.0..=1e12).contains(&duration) {
            return Err(CommandError::NotFinite);
        }
        let mut steering = self.steering;
        if model.kind == DriveKind::Ackermann && !displacement.is_zero() {
            steering = model.steering(displacement).ok_or(CommandError::TurnOnSpot)?;
            // Some rounding beyond the limit is let pass, so that the tightest curve itself can be driven.
            if steering.abs() > model.max_steering + 1e-6 {
                let min_radius = model.wheelbase / crate::math::tan(model.max_steering);
                return Err(CommandError::TooTight {
                    min_radius_mm: (crate::unit::mm_from_metres(min_radius) - 1e-6).ceil() as u32,
                });
            }
        }
        let duration = duration.max(model.shortest_duration(displacement));
        let rate = if duration > 0.0 { displacement.scaled(1.0 / duration) } else { Twist::ZERO };
        let rate = if rate.is_finite() { rate } else { Twist::ZERO };
        // Progress is not counted by what is so slow that it has lost its digits; without any, the drive is done at once.
        let counts = |rate: f64, value: f64| if rate >= 1e-290 { value } else { 0.0 };
        let speed = rate.speed();
        let whole = Twist {
            vx: counts(speed, displacement.vx),
            vy: counts(speed, displacement.vy),
            omega: counts(rate.omega.abs(), displacement.omega),
        };
        let pending = Pending::Drive { whole, remaining: displacement, rate };
        Ok(Self { pending, steering, ..self })
    }
}

fn check_drivable(model: &Model, twist: Twist) -> Result<(), CommandError> {
    // Negated, so that NaN is refused as well.
    if !(twist.vx.abs().max(twist.vy.abs()).max(twist.omega.abs()) <= 1e12 && twist.is_finite()) {
        Err(CommandError::NotFinite)
    } else if twist.vy != 0.0 && model.kind != DriveKind::Omni {
        Err(CommandError::Sideways)
    } else {
        Ok(())
    }
}

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
    /// Walls have been looked for up to here, seconds since the start.
    pub explored: f64,
    /// The next ticks change nothing.
    steady: bool,
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
    ) -> Self {
        let during = actuate(model, start, &orders, before);
        let (rates, after, cause) = motion_of(model, &orders, &during);
        let centre = centre_of(model, &state.world_from_axle);
        let path = Path::new(&centre, rates.truth.at_offset(DVec2::new(-model.axis_offset, 0.0)));
        let piece = Piece { start, state, rates, after, cause };
        // Not even the start: a contact may stop it at once.
        let explored = if path.is_resting() { f64::INFINITY } else { -1.0 };
        let mut stage = Self { piece, orders, before, during, path, explored, steady: false };
        if let Some(obstacle) = stage.approached(model.body_radius, touching) {
            stage.stop(0.0, obstacle, true);
        }
        stage
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
            self.orders.gains.as_ref(),
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
        Some(Self::open(model, tick, state, self.orders_at(tick), self.during, &[]))
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
        let rates = match orders.pending.target() {
            Target::Wheels(rates) => rates,
            Target::Twist(twist) => model.wheels_from_twist(twist),
        };
        Actuation { rates, ..before }
    } else if start.floor_to(TICK) == start {
        control::step(model, orders.gains.as_ref(), orders.pending.target(), orders.steering, before)
    } else {
        before
    }
}

/// Rates, end and its cause in open space.
fn motion_of(model: &Model, orders: &Orders, during: &Actuation) -> (Rates, f64, Cause) {
    let belief = match orders.pending {
        // The twist itself, not what its wheels give back.
        Pending::Twist(twist) | Pending::Drive { rate: twist, .. } if model.wheel_lag == 0.0 => twist,
        _ => model.twist_from_wheels(&during.rates, orders.steering),
    };
    let rates = Rates { truth: belief, belief, wheels: during.rates };
    let Pending::Drive { whole, remaining, .. } = orders.pending else { return (rates, f64::INFINITY, Cause::Open) };
    let left = Pending::progress(whole, remaining);
    let speed = Pending::progress(whole, belief);
    if left <= 0.0 || (speed <= 0.0 && model.wheel_lag == 0.0) {
        (rates, 0.0, Cause::Arrived(if model.wheel_lag == 0.0 { remaining } else { Twist::ZERO }))
    } else if speed <= 0.0 {
        (rates, f64::INFINITY, Cause::Open)
    } else {
        let after = left / speed;
        (rates, after, Cause::Arrived(if model.wheel_lag == 0.0 { remaining } else { belief.scaled(after) }))
    }
}
