//! Commands to a drive, and the commands in force.

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
    /// Rate of one motor as in [`Command::Wheel`], regulated by the wheel's PID controller if that controller runs: see
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
    /// Drive along a straight line, along an arc, or turn on the spot: covers `displacement` in `duration` seconds, or
    /// as fast as the limits allow if `duration` is too short.
    Drive {
        /// Arc length (m) and angle (rad); the drive ends when it has covered exactly this displacement.
        displacement: Twist,
        /// Duration in seconds, from 0 to 10^12.
        duration: f64,
    },
    /// All wheels stop.
    Halt,
}

/// Displacement (arc length and angle) of a drive along the arc that starts in the direction of the robot's heading and
/// ends at `point`. `point` is in the robot's frame (x ahead, y left, m).
///
/// The arc lies on the circle that is tangent to the robot's heading and passes through `point`; its curvature is 2 y /
/// (x² + y²). The robot drives forwards to a point ahead of it and backwards (negative length) to a point behind it, on
/// at most half of the circle. To a point exactly at its side, the robot drives half a circle forwards (our choice); to
/// a point on the x axis, the robot drives a straight line. The displacement to the robot's own position is zero.
///
/// Source: `VWDrive` of RoBIOS-7, which requires x > |y|; the result for other points is our choice.
pub fn arc_to(point: DVec2) -> Twist {
    let chord = math::hypot(point.x, point.y);
    // The angle between the heading and the chord is half of the arc's angle.
    let half_angle = math::atan2(point.y, point.x.abs());
    let direction = if point.x < 0.0 { -1.0 } else { 1.0 };
    Twist::new(direction * chord / math::sinc(half_angle), direction * 2.0 * half_angle)
}

/// Reason why a command was rejected; the robot's motion is then unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CommandError {
    /// A number is NaN, infinite, of a magnitude greater than 10^12, or negative where it must not be.
    #[error("a value of the command is not a number that can be driven, accepted: finite values up to 1e12")]
    NotFinite,
    /// A parameter of a controller is not valid.
    #[error("a parameter of the controller is out of range, accepted: factors from 0 to 1e12, reset times above 0")]
    Controller,
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
    /// Thrusters accept the rates of their motors, but neither speeds nor targets.
    #[error("thrusters can be driven only by their motors, accepted: rates of single motors")]
    Thrusters,
    /// Only an omni drive and legs can move sideways.
    #[error("this drive cannot move sideways, accepted: omni drives and legs")]
    Sideways,
}

/// The command in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ActiveCommand {
    Idle,
    Wheels {
        rates: Wheels,
        /// Wheels whose rate is regulated by their PID controllers, if these run.
        regulated: [bool; 4],
    },
    Twist(Twist),
    Drive {
        /// The commanded displacement; a component is 0 if its rate is too small for a measurable progress.
        total: Twist,
        /// The remaining part of the commanded displacement according to the wheels.
        remaining: Twist,
        rate: Twist,
    },
}

impl ActiveCommand {
    /// Part of the displacement `total` that `covered` has covered: arc length along `total`, m, or the angle, rad, for
    /// a turn on the spot.
    pub fn progress(total: Twist, covered: Twist) -> f64 {
        let length = total.speed();
        if length > 0.0 {
            total.vx / length * covered.vx + total.vy / length * covered.vy
        } else if total.omega != 0.0 {
            total.omega.signum() * covered.omega
        } else {
            0.0
        }
    }

    /// Set points of the wheels.
    pub fn target(&self) -> Target {
        match *self {
            Self::Idle => Target::Wheels { rates: [0.0; 4], regulated: [false; 4] },
            Self::Wheels { rates, regulated } => Target::Wheels { rates, regulated },
            Self::Twist(twist) | Self::Drive { rate: twist, .. } => Target::Twist(twist),
        }
    }
}

/// The commands in force: everything that determines a robot's motion from an instant on, except its state.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CommandState {
    pub active: ActiveCommand,
    /// Steering angle of an Ackermann drive, rad, left positive.
    pub steering: f64,
    pub controllers: Rare<Controllers>,
}

impl CommandState {
    /// The commands in force after `command`.
    pub fn with(self, model: &Model, command: Command) -> Result<Self, CommandError> {
        match command {
            Command::Halt => Ok(Self { active: ActiveCommand::Idle, ..self }),
            Command::Wheels(_) if model.wheel_count() == 0 => Err(CommandError::NoWheel { wheels: 0 }),
            Command::Wheels(rates) => {
                if !rates.iter().all(|rate| rate.is_finite()) {
                    return Err(CommandError::NotFinite);
                }
                let mut rates = model.clamp_wheels(&rates);
                rates[model.wheel_count()..].fill(0.0);
                Ok(Self { active: ActiveCommand::Wheels { rates, regulated: [false; 4] }, ..self })
            }
            Command::Wheel { wheel, rate } => self.with_wheel(model, wheel, rate, false),
            Command::WheelSpeed { wheel, rate } => self.with_wheel(model, wheel, rate, true),
            Command::Steer(angle) => self.with_steering(model, angle),
            Command::Twist(twist) => self.with_twist(model, twist),
            Command::Drive { displacement, duration } => self.with_drive(model, displacement, duration),
        }
    }

    fn with_wheel(self, model: &Model, wheel: usize, rate: f64, is_regulated: bool) -> Result<Self, CommandError> {
        check_wheel(model, wheel)?;
        if !rate.is_finite() {
            return Err(CommandError::NotFinite);
        }
        let (mut rates, mut regulated) = match self.active.target() {
            Target::Wheels { rates, regulated } => (rates, regulated),
            Target::Twist(twist) => (model.wheels_from_twist(twist), [false; 4]),
        };
        rates[wheel] = rate.clamp(-model.max_wheel_rate, model.max_wheel_rate);
        regulated[wheel] = is_regulated;
        Ok(Self { active: ActiveCommand::Wheels { rates, regulated }, ..self })
    }

    fn with_steering(self, model: &Model, angle: f64) -> Result<Self, CommandError> {
        if model.kind != DriveKind::Ackermann {
            return Err(CommandError::NoSteering);
        }
        if !angle.is_finite() {
            return Err(CommandError::NotFinite);
        }
        let steering = angle.clamp(-model.max_steering, model.max_steering);
        let active = match self.active {
            // The speed stays the same; from now on the steering servo, not the commanded twist, determines the curve.
            ActiveCommand::Twist(twist) => {
                ActiveCommand::Wheels { rates: model.wheels_from_twist(twist), regulated: [false; 4] }
            }
            // A drive keeps its curve until it ends.
            ActiveCommand::Drive { .. } => return Ok(self),
            other => other,
        };
        Ok(Self { active, steering, ..self })
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
        Ok(Self { active: ActiveCommand::Twist(twist), steering, ..self })
    }

    fn with_drive(self, model: &Model, displacement: Twist, duration: f64) -> Result<Self, CommandError> {
        check_drivable(model, displacement)?;
        if !(0.0..=1e12).contains(&duration) {
            return Err(CommandError::NotFinite);
        }
        let mut steering = self.steering;
        if model.kind == DriveKind::Ackermann && !displacement.is_zero() {
            steering = model.steering(displacement).ok_or(CommandError::TurnOnSpot)?;
            // The tolerance for rounding permits the tightest curve itself.
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
        // A component whose rate is below 1e-290 has lost its digits, so it is not used to measure progress. If no
        // component is left, the drive ends at once.
        let if_measurable = |rate: f64, value: f64| if rate >= 1e-290 { value } else { 0.0 };
        let speed = rate.speed();
        let total = Twist {
            vx: if_measurable(speed, displacement.vx),
            vy: if_measurable(speed, displacement.vy),
            omega: if_measurable(rate.omega.abs(), displacement.omega),
        };
        let active = ActiveCommand::Drive { total, remaining: displacement, rate };
        Ok(Self { active, steering, ..self })
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
    fn arc_lengths_and_angles_match_geometry() {
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
