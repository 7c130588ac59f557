//! What is constant about a robot's drive and body, and the kinematics between wheels and body.

use crate::{math, pose::Twist};

/// How wheels move the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveKind {
    /// Two driven wheels on one axle, in the order left, right.
    Differential,
    /// One motor drives the rear axle, a servo steers the front wheels: the bicycle model.
    Ackermann,
    /// Four Mecanum wheels in the order front left, front right, back left, back right.
    Omni,
}

/// Rates or angles of up to four wheels in the order of the [`DriveKind`]; unused places are 0.
pub type Wheels = [f64; 4];

/// The constant facts of a drive and its body.
///
/// Source: Koestler & Bräunl, section 2, and the `.robi` format.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Arrangement of the wheels.
    pub kind: DriveKind,
    /// Diameter of the driven wheels, m.
    pub wheel_diameter: f64,
    /// Greatest rate of a wheel, rad/s.
    pub max_wheel_rate: f64,
    /// Encoder ticks in one turn of a wheel.
    pub ticks_per_turn: f64,
    /// Distance of the left and right wheels, m.
    pub track: f64,
    /// Distance of the front and back axles, m (Ackermann and omni). See [`Model::default_wheelbase`].
    pub wheelbase: f64,
    /// From the robot's centre to the axle along x, m; the axle's midpoint is the reference of the drive and of odometry.
    pub axis_offset: f64,
    /// Greatest speed that the VW interface commands, m/s; infinite for no limit.
    pub max_speed: f64,
    /// Greatest turning speed that the VW interface commands, rad/s; infinite for no limit.
    pub max_turn: f64,
    /// Radius of the body, a disc around the robot's centre, m.
    pub body_radius: f64,
    /// Time constant with which the wheels follow their command, s; 0: at once.
    pub wheel_lag: f64,
    /// Greatest steering angle to either side, rad (Ackermann); 45 degrees on the classic servo.
    pub max_steering: f64,
}

/// A value of a [`Model`] with which nothing can be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{field}` is {value}, accepted: {accepted}")]
pub struct ModelError {
    /// Name of the field.
    pub field: &'static str,
    /// Its value, in SI units.
    pub value: f64,
    /// What it must be.
    pub accepted: &'static str,
}

impl Model {
    /// The wheelbase of a robot whose file gives none: the track of an omni drive, else half the body's diameter.
    ///
    /// Our choice: with 45 degrees of steering the rear axle then turns on a circle as wide as the body.
    pub fn default_wheelbase(kind: DriveKind, track: f64, body_radius: f64) -> f64 {
        if kind == DriveKind::Omni { track } else { body_radius }
    }

    /// Number of wheels with a motor and an encoder.
    pub fn wheel_count(&self) -> usize {
        match self.kind {
            DriveKind::Differential => 2,
            DriveKind::Ackermann => 1,
            DriveKind::Omni => 4,
        }
    }

    /// Checks that all that the kinematics divide by, and all limits, make sense.
    ///
    /// # Errors
    /// The first field that does not, with the values accepted.
    pub fn check(&self) -> Result<(), ModelError> {
        let check = |field, value: f64, accepted, ok: bool| {
            if ok { Ok(()) } else { Err(ModelError { field, value, accepted }) }
        };
        let positive =
            |field, value: f64| check(field, value, "a number greater than 0", value.is_finite() && value > 0.0);
        positive("wheel diameter", self.wheel_diameter)?;
        positive("maximum wheel rate", self.max_wheel_rate)?;
        positive("ticks per turn", self.ticks_per_turn)?;
        positive("track", self.track)?;
        positive("wheelbase", self.wheelbase)?;
        positive("body radius", self.body_radius)?;
        check("axis", self.axis_offset, "a finite number", self.axis_offset.is_finite())?;
        check("speed", self.max_speed, "a number greater than 0", self.max_speed > 0.0)?;
        check("turn", self.max_turn, "a number greater than 0", self.max_turn > 0.0)?;
        check("wheel lag", self.wheel_lag, "0 or more", self.wheel_lag.is_finite() && self.wheel_lag >= 0.0)?;
        let steering_ok = self.max_steering >= 0.0 && self.max_steering < std::f64::consts::FRAC_PI_2;
        check("maximum steering angle", self.max_steering, "0 to less than 90 degrees", steering_ok)
    }

    /// Twist of the axle's midpoint for these wheel rates (rad/s) and this steering angle (rad, left positive).
    ///
    /// Mecanum turn row (-, +, -, +) c / (2 (W + L)): the matrix printed in the paper repeats the signs of the row above
    /// and is singular. Source: Koestler & Bräunl, section 2.
    pub fn twist_from_wheels(&self, wheels: &Wheels, steering: f64) -> Twist {
        let radius = 0.5 * self.wheel_diameter;
        match self.kind {
            DriveKind::Differential => {
                let [left, right, ..] = *wheels;
                Twist::new(0.5 * radius * (left + right), radius * (right - left) / self.track)
            }
            DriveKind::Ackermann => {
                let v = radius * wheels[0];
                Twist::new(v, if steering == 0.0 { 0.0 } else { v * math::tan(steering) / self.wheelbase })
            }
            DriveKind::Omni => {
                let [fl, fr, bl, br] = *wheels;
                Twist {
                    vx: 0.25 * radius * ((fl + fr) + (bl + br)),
                    vy: 0.25 * radius * ((fr - fl) + (bl - br)),
                    omega: 0.5 * radius * ((fr - fl) + (br - bl)) / (self.track + self.wheelbase),
                }
            }
        }
    }

    /// Wheel rates (rad/s) that give this twist of the axle's midpoint, or wheel angles that give this displacement.
    ///
    /// For an Ackermann drive the rate of its motor; the steering angle is [`Model::steering`].
    pub fn wheels_from_twist(&self, twist: Twist) -> Wheels {
        let per_metre = 2.0 / self.wheel_diameter;
        let Twist { vx, vy, omega } = twist;
        match self.kind {
            DriveKind::Differential => {
                let turn = 0.5 * self.track * omega;
                [(vx - turn) * per_metre, (vx + turn) * per_metre, 0.0, 0.0]
            }
            DriveKind::Ackermann => [vx * per_metre, 0.0, 0.0, 0.0],
            DriveKind::Omni => {
                let turn = 0.5 * (self.track + self.wheelbase) * omega;
                [vx - vy - turn, vx + vy + turn, vx + vy - turn, vx - vy + turn].map(|speed| speed * per_metre)
            }
        }
    }

    /// Steering angle of an Ackermann drive for this twist, not yet limited; `None` when the wheels cannot give it because
    /// it turns without driving.
    pub fn steering(&self, twist: Twist) -> Option<f64> {
        if twist.omega == 0.0 {
            return Some(0.0);
        }
        (twist.vx != 0.0).then(|| math::atan(twist.omega * self.wheelbase / twist.vx))
    }

    /// `wheels` with each rate within its limit.
    pub fn clamp_wheels(&self, wheels: &Wheels) -> Wheels {
        wheels.map(|rate| rate.clamp(-self.max_wheel_rate, self.max_wheel_rate))
    }

    /// `twist` with speed and turning speed each within the robi's limits, then scaled as a whole to what the wheels can
    /// do, so that the curve keeps its shape.
    pub fn clamp_twist(&self, twist: Twist) -> Twist {
        let speed = twist.speed();
        let slow = if speed > self.max_speed { self.max_speed / speed } else { 1.0 };
        let twist =
            Twist { vx: twist.vx * slow, vy: twist.vy * slow, omega: twist.omega.clamp(-self.max_turn, self.max_turn) };
        let excess = self.wheel_excess(&self.wheels_from_twist(twist));
        if excess > 1.0 { twist.scaled(1.0 / excess) } else { twist }
    }

    /// Shortest time in seconds in which the limits allow this displacement along its curve.
    pub fn shortest_duration(&self, displacement: Twist) -> f64 {
        let wheels = self.wheel_excess(&self.wheels_from_twist(displacement));
        (displacement.speed() / self.max_speed).max(displacement.omega.abs() / self.max_turn).max(wheels)
    }

    /// Greatest of the wheels' rates, as a multiple of the limit.
    pub(super) fn wheel_excess(&self, wheels: &Wheels) -> f64 {
        wheels.iter().fold(0.0, |most: f64, rate| most.max(rate.abs())) / self.max_wheel_rate
    }
}
