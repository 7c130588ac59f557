//! Constant properties of a robot's drive and body, and the kinematics between wheels and body.

use crate::{math, pose::Twist};

/// Kind of drive: the arrangement of wheels, legs or thrusters that moves the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveKind {
    /// Two driven wheels on one axle, in the order left, right.
    Differential,
    /// One motor drives the rear axle and a servo steers the front wheels; modelled as a bicycle.
    Ackermann,
    /// Four Mecanum wheels in the order front left, front right, back left, back right.
    Omni,
    /// Legs without wheels. The wheel rates are the twist itself: m/s ahead, m/s to the left, rad/s.
    Legged,
    /// Four thrusters of a [`Hull`](super::Hull) under water, in the order left, front, right, back. Commands set the
    /// rates of the thrusters. The wheel rates of the motion are the velocity: m/s ahead, m/s to the left, rad/s, m/s
    /// up.
    Thrusters,
}

/// Rates or angles of up to four wheels in the order of the [`DriveKind`]; unused elements are 0.
pub type Wheels = [f64; 4];

/// Constant properties of a drive and its body.
///
/// Source: Koestler & Bräunl, section 2, and the `.robi` format.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Arrangement of the wheels.
    pub kind: DriveKind,
    /// Diameter of the driven wheels, m.
    pub wheel_diameter: f64,
    /// Maximum rate of a wheel, rad/s.
    pub max_wheel_rate: f64,
    /// Encoder counts per turn of a wheel.
    pub ticks_per_turn: f64,
    /// Distance between the left and right wheels, m.
    pub track: f64,
    /// Distance between the front and back axles, m (Ackermann and omni).
    pub wheelbase: f64,
    /// Position of the axle in front of the robot's centre, m; drive and odometry refer to the axle's midpoint.
    pub axis_offset: f64,
    /// Maximum speed that the VW interface commands, m/s; infinite for no limit.
    pub max_speed: f64,
    /// Maximum turning speed that the VW interface commands, rad/s; infinite for no limit.
    pub max_turn: f64,
    /// Radius of the body, a disc around the robot's centre, m.
    pub body_radius: f64,
    /// Time constant with which the wheels follow their command, s; 0 for wheels that follow immediately.
    pub wheel_lag: f64,
    /// Maximum steering angle to either side, rad (Ackermann); 45 degrees for the classic servo.
    pub max_steering: f64,
    /// Mass of the robot, kg; used only in contacts with movable objects and by a hull.
    pub mass: f64,
    /// Coefficient of friction between wheels and floor: the maximum force of the wheels divided by the robot's weight.
    pub traction: f64,
}

/// A value of a [`Model`] that is out of range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{field}` is {value}, accepted: {accepted}")]
pub struct ModelError {
    /// Name of the field.
    pub field: &'static str,
    /// Its value, in SI units.
    pub value: f64,
    /// The accepted values.
    pub accepted: &'static str,
}

impl Model {
    /// Number of wheels or thrusters with a motor.
    pub fn wheel_count(&self) -> usize {
        match self.kind {
            DriveKind::Differential => 2,
            DriveKind::Ackermann => 1,
            DriveKind::Omni | DriveKind::Thrusters => 4,
            DriveKind::Legged => 0,
        }
    }

    /// Checks that all limits and all divisors of the kinematics are within their ranges.
    ///
    /// # Errors
    /// The first field that is out of range, with the accepted values.
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
        positive("mass", self.mass)?;
        check("traction", self.traction, "0 or more", self.traction.is_finite() && self.traction >= 0.0)?;
        check("maximum steering angle", self.max_steering, "0 to less than 90 degrees", steering_ok)
    }

    /// Twist of the axle's midpoint for the given wheel rates (rad/s) and steering angle (rad, left positive).
    ///
    /// For Mecanum wheels of radius r, track W and wheelbase L, the row of the matrix for the turning speed is (-, +,
    /// -, +) r / (2 (W + L)). The matrix printed in the source repeats the signs of the row above and is singular.
    /// Source: Koestler & Bräunl, section 2.
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
            DriveKind::Legged | DriveKind::Thrusters => {
                let [vx, vy, omega, _] = *wheels;
                Twist { vx, vy, omega }
            }
        }
    }

    /// Wheel rates (rad/s) that give this twist of the axle's midpoint, or wheel angles that give this displacement.
    ///
    /// For an Ackermann drive, the rate of its motor; [`Model::steering`] gives the steering angle.
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
            DriveKind::Legged | DriveKind::Thrusters => [vx, vy, omega, 0.0],
        }
    }

    /// Steering angle of an Ackermann drive for this twist, not yet limited, rad; `None` for a turn on the spot, which
    /// this drive cannot make.
    pub fn steering(&self, twist: Twist) -> Option<f64> {
        if twist.omega == 0.0 {
            return Some(0.0);
        }
        (twist.vx != 0.0).then(|| math::atan(twist.omega * self.wheelbase / twist.vx))
    }

    /// Returns true if the drive can move sideways as well as ahead.
    pub fn is_holonomic(&self) -> bool {
        matches!(self.kind, DriveKind::Omni | DriveKind::Legged)
    }

    /// `wheels` with each rate clamped to its limit.
    pub fn clamp_wheels(&self, wheels: &Wheels) -> Wheels {
        wheels.map(|rate| rate.clamp(-self.max_wheel_rate, self.max_wheel_rate))
    }

    /// `twist` with speed and turning speed each clamped to the robi's limits, then scaled as a whole to the limit of
    /// the wheels. The scaling preserves the shape of the curve.
    pub fn clamp_twist(&self, twist: Twist) -> Twist {
        let speed = twist.speed();
        let scale = if speed > self.max_speed { self.max_speed / speed } else { 1.0 };
        let twist = Twist {
            vx: twist.vx * scale,
            vy: twist.vy * scale,
            omega: twist.omega.clamp(-self.max_turn, self.max_turn),
        };
        let excess = self.wheel_excess(&self.wheels_from_twist(twist));
        if excess > 1.0 { twist.scaled(1.0 / excess) } else { twist }
    }

    /// Shortest time in seconds in which the limits allow the robot to cover this displacement along its curve.
    pub fn shortest_duration(&self, displacement: Twist) -> f64 {
        let wheel_duration = self.wheel_excess(&self.wheels_from_twist(displacement));
        (displacement.speed() / self.max_speed).max(displacement.omega.abs() / self.max_turn).max(wheel_duration)
    }

    /// Moment of inertia of the body, a uniform disc, about its centre, kg m².
    pub fn inertia(&self) -> f64 {
        0.5 * self.mass * self.body_radius * self.body_radius
    }

    /// Speed of a straight drive that has the same kinetic energy as this twist of the centre, m/s.
    pub fn energy_speed(&self, twist: Twist) -> f64 {
        (twist.vx * twist.vx + twist.vy * twist.vy + self.inertia() / self.mass * twist.omega * twist.omega).sqrt()
    }

    /// Projection coefficient of `twist` onto the twist `onto`, both in one frame, in the inner product of kinetic
    /// energy; 0 if `onto` is zero. Suppose that the wheels of a robot that moves with `twist` suddenly allow only
    /// motion along `onto`. If the robot's momentum along `onto` is kept, the robot continues with this multiple of
    /// `onto`.
    pub fn projection(&self, twist: Twist, onto: Twist) -> f64 {
        let product = |a: Twist, b: Twist| self.mass * (a.vx * b.vx + a.vy * b.vy) + self.inertia() * a.omega * b.omega;
        let square = product(onto, onto);
        if square > 0.0 { product(twist, onto) / square } else { 0.0 }
    }

    /// Maximum of the absolute wheel rates, divided by their limit.
    pub(super) fn wheel_excess(&self, wheels: &Wheels) -> f64 {
        if self.kind == DriveKind::Legged {
            // Speed and turning speed both move a foot beside the body, so their fractions of the limits add up.
            return math::hypot(wheels[0], wheels[1]) / self.max_speed + wheels[2].abs() / self.max_turn;
        }
        wheels.iter().fold(0.0, |max: f64, rate| max.max(rate.abs())) / self.max_wheel_rate
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub fn model(kind: DriveKind) -> Model {
        Model {
            kind,
            wheel_diameter: 0.1,
            max_wheel_rate: 6.0,
            ticks_per_turn: 1000.0,
            track: 0.2,
            wheelbase: 0.3,
            axis_offset: 0.0,
            max_speed: 0.5,
            max_turn: 2.0,
            body_radius: 0.15,
            wheel_lag: 0.0,
            max_steering: std::f64::consts::FRAC_PI_4,
            mass: 1.0,
            traction: 0.6,
        }
    }

    fn assert_close(a: Twist, b: Twist) {
        let difference = (a.vx - b.vx).abs().max((a.vy - b.vy).abs()).max((a.omega - b.omega).abs());
        assert!(difference < 1e-15, "{a:?} is not {b:?}");
    }

    #[test]
    fn differential_drive_matches_the_matrix_of_the_paper() {
        let model = model(DriveKind::Differential);
        // Radius r = 0.05 m, track d = 0.2 m: v = r/2 (L + R), omega = r/d (R - L).
        assert_close(model.twist_from_wheels(&[2.0, 4.0, 0.0, 0.0], 0.0), Twist::new(0.15, 0.5));
        assert_eq!(model.twist_from_wheels(&[0.3, 0.3, 0.0, 0.0], 0.0).omega, 0.0);
    }

    #[test]
    fn mecanum_twists_match_the_signs_of_the_wheels() {
        let model = model(DriveKind::Omni);
        let to_side = model.twist_from_wheels(&[-1.0, 1.0, 1.0, -1.0], 0.0);
        assert_close(to_side, Twist { vx: 0.0, vy: 0.05, omega: 0.0 });
        // r / (2 (W + L)) (-, +, -, +): 0.05 / (2 * 0.5) * 4.
        assert_close(model.twist_from_wheels(&[-1.0, 1.0, -1.0, 1.0], 0.0), Twist::new(0.0, 0.2));
        assert_close(model.twist_from_wheels(&[1.0; 4], 0.0), Twist::new(0.05, 0.0));
    }

    #[test]
    fn wheels_from_twist_inverts_twist_from_wheels() {
        let twist = Twist { vx: 0.13, vy: -0.07, omega: 0.9 };
        let omni = model(DriveKind::Omni);
        assert_close(omni.twist_from_wheels(&omni.wheels_from_twist(twist), 0.0), twist);
        let differential = model(DriveKind::Differential);
        let twist = Twist::new(-0.2, 1.1);
        assert_close(differential.twist_from_wheels(&differential.wheels_from_twist(twist), 0.0), twist);
        let ackermann = model(DriveKind::Ackermann);
        let twist = Twist::new(-0.2, 0.3);
        let steering = ackermann.steering(twist).expect("the robot drives");
        assert!(steering < 0.0, "to turn left backwards, the robot steers to the right");
        assert_close(ackermann.twist_from_wheels(&ackermann.wheels_from_twist(twist), steering), twist);
    }

    #[test]
    fn limits_scale_the_twist_and_keep_the_curve() {
        let model = model(DriveKind::Differential);
        assert_close(model.clamp_twist(Twist::new(-0.9, 0.0)), Twist::new(-0.3, 0.0));
        assert_close(model.clamp_twist(Twist::new(0.0, 9.0)), Twist::new(0.0, 2.0));
        // Clamped to 0.5 m/s and 2 rad/s, the outer wheel would turn at 14 rad/s, so all rates are scaled by 6 / 14.
        assert_close(model.clamp_twist(Twist::new(3.0, 2.5)), Twist::new(0.5, 2.0).scaled(6.0 / 14.0));
        let allowed = Twist::new(0.1, 0.2);
        assert_eq!(model.clamp_twist(allowed), allowed);
        assert_eq!(model.clamp_wheels(&[7.0, -9.0, 1.0, 0.0]), [6.0, -6.0, 1.0, 0.0]);
        assert!((model.shortest_duration(Twist::new(0.6, 0.0)) - 2.0).abs() < 1e-15);
        assert!((model.shortest_duration(Twist::new(0.0, 4.0)) - 2.0).abs() < 1e-15);
    }

    #[test]
    fn check_names_the_value_out_of_range() {
        let wrong = Model { track: 0.0, ..model(DriveKind::Differential) };
        assert_eq!(wrong.check().expect_err("no track").to_string(), "`track` is 0, accepted: a number greater than 0");
        for value in [f64::NAN, f64::INFINITY, -1.0] {
            assert!(Model { wheel_diameter: value, ..model(DriveKind::Omni) }.check().is_err());
            assert!(Model { wheel_lag: value, ..model(DriveKind::Omni) }.check().is_err());
        }
        assert_eq!(Model { max_speed: f64::INFINITY, ..model(DriveKind::Omni) }.check(), Ok(()));
    }
}
