//! Commands to a drive, and the orders that the motion follows after a command.

use glam::DVec2;

use super::{
    control::{Controllers, Target},
    model::{DriveKind, Model, Wheels},
    rare::Rare,
};
use crate::{math, pose::Twist, unit};

/// A command of a robot's program to its drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Rates of the motors in the order of the [`DriveKind`], rad/s, each clamped to the limit of the wheels.
    Wheels(Wheels),
    /// Rate of one motor, clamped to the limit of the wheels; the other motors keep their commanded rates.
    Wheel {
        /// Index of the wheel in the order of the [`DriveKind`].
        wheel: usize,
        /// Its rate, rad/s.
        rate: f64,
    },
    /// Rate of one motor as in [`Command::Wheel`], regulated by the wheel's own controller if the wheel has one: see
    /// [`Motion::start_wheel_control`](super::Motion::start_wheel_control).
    WheelSpeed {
        /// Index of the wheel in the order of the [`DriveKind`].
        wheel: usize,
        /// Its rate, rad/s.
        rate: f64,
    },
    /// Steering angle of an Ackermann drive, rad, left positive, clamped to the limit of the steering.
    Steer(f64),
    /// Speed and turning speed until the next command, within the limits of the robi and the wheels.
    Twist(Twist),
    /// A straight line, an arc or a turn on the spot: covers `displacement` in `duration` seconds, or as fast as the
    /// limits allow if `duration` is too short.
    Drive {
        /// Arc length (m) and angle (rad) to cover; the drive ends exactly there.
        displacement: Twist,
        /// Duration in seconds, from 0 to 10^12.
        duration: f64,
    },
    /// Stop of all wheels.
    Halt,
}

/// Displacement (arc length and angle) of a drive along the arc that starts straight ahead and ends at `point`, given
/// in the robot's frame (x ahead, y left, m).
///
/// The arc lies on the circle that is tangent to the robot's heading and passes through `point`; its curvature is 2 y /
/// (x² + y²). The robot drives forwards to a point ahead of it and backwards (negative length) to a point behind it, on
/// at most half of the circle. A point exactly at the side takes half a circle forwards (our choice), a point on the x
/// axis a straight line. The displacement to the robot's own position is zero.
///
/// Source: `VWDrive` of RoBIOS-7, which asks for x > |y|; the rest is our choice.
pub fn arc_to(point: DVec2) -> Twist {
    let chord = math::hypot(point.x, point.y);
    // The angle between the heading and the chord is half of the arc's angle.
    let half = math::atan2(point.y, point.x.abs());
    let sense = if point.x < 0.0 { -1.0 } else { 1.0 };
    Twist::new(sense * chord / math::sinc(half), sense * 2.0 * half)
}

/// Reason why a command was refused; the motion of the robot does not change then.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CommandError {
    /// A number is NaN, infinite, greater than 10^12, or negative where it must not be.
    #[error("a value of the command is not a number that can be driven, accepted: finite values up to 1e12")]
    NotFinite,
    /// An Ackermann drive cannot turn without driving.
    #[error("an Ackermann drive cannot turn on the spot, accepted: curves with a length")]
    TurnOnSpot,
    /// The steering cannot make a curve as tight as the commanded one.
    #[error("the curve is too tight for the steering, accepted: a radius of at least {min_radius_mm} mm")]
    TooTight {
        /// Radius of the tightest curve of the rear axle, mm.
        min_radius_mm: u32,
    },
    /// Only an Ackermann drive steers.
    #[error("this drive has no steering, accepted: Ackermann drives")]
    NoSteering,
    /// No wheel with a motor has this number.
    #[error("the drive has no such wheel, accepted: less than {wheels}")]
    NoWheel {
        /// Number of wheels with a motor.
        wheels: usize,
    },
    /// Thrusters accept forces but neither speeds nor targets.
    #[error("thrusters are driven by their motors alone, accepted: rates of single motors")]
    Thrusters,
    /// Only an omni drive and legs can move sideways.
    #[error("this drive cannot move sideways, accepted: omni drives and legs")]
    Sideways,
}

/// The command in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pending {
    Idle,
    Wheels {
        rates: Wheels,
        /// Wheels whose rate is regulated by their own controllers, if these run.
        held: [bool; 4],
    },
    Twist(Twist),
    Drive {
        /// The commanded displacement; a component too slow to count as progress is 0.
        whole: Twist,
        /// The remaining part of the commanded displacement according to the wheels.
        remaining: Twist,
        rate: Twist,
    },
}

impl Pending {
    /// Progress of a drive towards `whole` when `covered` has been covered: arc length along `whole`, m, or the angle,
    /// rad, for a turn on the spot.
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

    /// Set points of the wheels.
    pub fn target(&self) -> Target {
        match *self {
            Self::Idle => Target::Wheels { rates: [0.0; 4], held: [false; 4] },
            Self::Wheels { rates, held } => Target::Wheels { rates, held },
            Self::Twist(twist) | Self::Drive { rate: twist, .. } => Target::Twist(twist),
        }
    }
}

/// Everything that determines a robot's motion from an instant on, except its state.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Orders {
    pub pending: Pending,
    /// Steering angle of an Ackermann drive, rad, left positive.
    pub steering: f64,
    pub controllers: Rare<Controllers>,
}

impl Orders {
    /// These orders with `command` in force.
    pub fn with(self, model: &Model, command: Command) -> Result<Self, CommandError> {
        match command {
            Command::Halt => Ok(Self { pending: Pending::Idle, ..self }),
            Command::Wheels(_) if model.wheel_count() == 0 => Err(CommandError::NoWheel { wheels: 0 }),
            Command::Wheels(rates) => {
                if !rates.iter().all(|rate| rate.is_finite()) {
                    return Err(CommandError::NotFinite);
                }
                let mut rates = model.clamp_wheels(&rates);
                rates[model.wheel_count()..].fill(0.0);
                Ok(Self { pending: Pending::Wheels { rates, held: [false; 4] }, ..self })
            }
            Command::Wheel { wheel, rate } => self.with_wheel(model, wheel, rate, false),
            Command::WheelSpeed { wheel, rate } => self.with_wheel(model, wheel, rate, true),
            Command::Steer(angle) => self.steered(model, angle),
            Command::Twist(twist) => self.with_twist(model, twist),
            Command::Drive { displacement, duration } => self.with_drive(model, displacement, duration),
        }
    }

    fn with_wheel(self, model: &Model, wheel: usize, rate: f64, is_held: bool) -> Result<Self, CommandError> {
        check_wheel(model, wheel)?;
        if !rate.is_finite() {
            return Err(CommandError::NotFinite);
        }
        let (mut rates, mut held) = match self.pending.target() {
            Target::Wheels { rates, held } => (rates, held),
            Target::Twist(twist) => (model.wheels_from_twist(twist), [false; 4]),
        };
        rates[wheel] = rate.clamp(-model.max_wheel_rate, model.max_wheel_rate);
        held[wheel] = is_held;
        Ok(Self { pending: Pending::Wheels { rates, held }, ..self })
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
            // The speed stays; from now on the steering servo, not the commanded twist, determines the curve.
            Pending::Twist(twist) => Pending::Wheels { rates: model.wheels_from_twist(twist), held: [false; 4] },
            // A drive keeps its curve until it ends.
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
            let steering_angle = model.steering(twist).ok_or(CommandError::TurnOnSpot)?;
            steering = steering_angle.clamp(-model.max_steering, model.max_steering);
            if steering != steering_angle {
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
            // The tolerance for rounding lets the tightest curve itself be driven.
            if steering.abs() > model.max_steering + 1e-6 {
                let min_radius = model.wheelbase / math::tan(model.max_steering);
                return Err(CommandError::TooTight {
                    min_radius_mm: (unit::mm_from_metres(min_radius) - 1e-6).ceil() as u32,
                });
            }
        }
        let duration = duration.max(model.shortest_duration(displacement));
        let rate = if duration > 0.0 { displacement.scaled(1.0 / duration) } else { Twist::ZERO };
        let rate = if rate.is_finite() { rate } else { Twist::ZERO };
        // A component whose rate is below 1e-290 has lost its digits and does not count as progress. If no component
        // counts, the drive ends at once.
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

/// Checks that the drive has a wheel of this number.
pub(super) fn check_wheel(model: &Model, wheel: usize) -> Result<(), CommandError> {
    let wheels = model.wheel_count();
    if wheel < wheels { Ok(()) } else { Err(CommandError::NoWheel { wheels }) }
}

fn check_drivable(model: &Model, twist: Twist) -> Result<(), CommandError> {
    // The negation also refuses NaN.
    if !(twist.vx.abs().max(twist.vy.abs()).max(twist.omega.abs()) <= 1e12 && twist.is_finite()) {
        Err(CommandError::NotFinite)
    } else if model.kind == DriveKind::Thrusters {
        Err(CommandError::Thrusters)
    } else if twist.vy != 0.0 && !model.is_holonomic() {
        Err(CommandError::Sideways)
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn arcs_to_points_are_those_of_geometry() {
        let assert_close = |x: f64, y: f64, length: f64, angle: f64| {
            let Twist { vx, omega, .. } = arc_to(DVec2::new(x, y));
            assert!((vx - length).abs() < 1e-15 && (omega - angle).abs() < 1e-15, "({x}, {y}): {vx} m, {omega} rad");
        };
        assert_close(0.5, 0.0, 0.5, 0.0);
        assert_close(-0.5, 0.0, -0.5, 0.0);
        assert_close(0.0, 0.0, 0.0, 0.0);
        // Quarters of a circle of 1 m: to the left and right ahead, to the left and right behind.
        assert_close(1.0, 1.0, PI / 2.0, PI / 2.0);
        assert_close(1.0, -1.0, PI / 2.0, -PI / 2.0);
        assert_close(-1.0, 1.0, -PI / 2.0, -PI / 2.0);
        assert_close(-1.0, -1.0, -PI / 2.0, PI / 2.0);
        // Half a circle of 0.2 m.
        assert_close(0.0, 0.4, 0.2 * PI, PI);
        assert_close(0.0, -0.4, 0.2 * PI, -PI);
    }
}
