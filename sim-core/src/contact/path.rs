//! The path of a disc's centre, at constant twist or along a wall.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use crate::{
    math,
    pose::{Pose, Twist},
    scene::Bounds,
};

/// The path of a point. The point either moves at constant twist (on a straight line, on a circle, or not at all), or
/// it slides along a track, which is a straight line or a circle. Times are seconds since the start of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    /// Position at the start, in the world frame, m.
    pub origin: DVec2,
    /// Unit vector of the moving frame's x axis at the start, in the world frame.
    pub direction: DVec2,
    /// Twist of the moving frame. For a sliding point, the twist with which a point follows the track at 1 m/s.
    pub twist: Twist,
    /// Speed of the point along the path.
    pub pace: Pace,
}

/// Speed of a point along its path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// The point moves with the twist of the path, and the heading of the body turns with it.
    ConstantTwist,
    /// The point slides along the track of the path according to `law`, while the heading of the body turns at `omega`
    /// rad/s.
    Sliding {
        /// Turning speed of the body, rad/s.
        omega: f64,
        /// Length covered on the track as a function of time.
        law: LengthLaw,
    },
}

/// The length that a sliding point has covered as a function of time, in closed form. The length never decreases while
/// the law holds, that is, until the contact changes between sliding left, sliding right, rolling and rest.
///
/// Beta is defined in docs/motion.md, section Sliding. It is the angle from the normal of the contact to the push (the
/// velocity that the wheels would give the centre without contacts), plus the angle of friction if the rim slides to
/// the left of the normal, or minus that angle if the rim slides to the right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LengthLaw {
    /// Constant speed, m/s.
    Steady(f64),
    /// A turning body slides along a straight wall at the speed `speed` sin(`phase` + `rate` t).
    Wave {
        /// Maximum speed, m/s; negative if the direction of the track is opposite to the contact's tangent.
        speed: f64,
        /// Beta at the start, rad.
        phase: f64,
        /// Rate of beta, rad/s.
        rate: f64,
    },
    /// A body slides around a point, such as a wall's end, at the speed `sense` `speed` sin(beta) along the track; beta
    /// changes at the rate `rate` - (`speed` / `radius`) sin(beta).
    Round {
        /// Distance of the track from the point, m.
        radius: f64,
        /// Maximum speed, m/s.
        speed: f64,
        /// Beta at the start, rad.
        phase: f64,
        /// Rate at which the direction of the push turns, rad/s.
        rate: f64,
        /// 1 if the track has the direction of the contact's tangent, -1 if it has the opposite direction.
        sense: f64,
    },
}

impl LengthLaw {
    /// The length covered after `seconds`, m.
    pub fn length(&self, seconds: f64) -> f64 {
        match *self {
            Self::Steady(speed) => speed * seconds,
            Self::Wave { speed, phase, rate } => {
                let (sin, cos) = math::sin_cos(phase);
                speed * seconds * (sin * math::sinc(rate * seconds) + cos * math::cosc(rate * seconds))
            }
            Self::Round { radius, rate, sense, .. } => sense * radius * (rate * seconds - self.beta_change(seconds)),
        }
    }

    /// Speed along the track after `seconds`, m/s.
    pub fn speed(&self, seconds: f64) -> f64 {
        match *self {
            Self::Steady(speed) => speed,
            Self::Wave { speed, phase, rate } => speed * math::sin(phase + rate * seconds),
            Self::Round { speed, phase, sense, .. } => sense * speed * math::sin(phase + self.beta_change(seconds)),
        }
    }

    /// Upper bound of the acceleration, m/s^2, of a point on a track of this curvature (1/m).
    fn acceleration(&self, curvature: f64) -> f64 {
        match *self {
            Self::Steady(speed) => speed * speed * curvature.abs(),
            Self::Wave { speed, rate, .. } => (speed * rate).abs(),
            Self::Round { radius, speed, rate, .. } => speed * (rate.abs() + 2.0 * speed / radius),
        }
    }

    /// Change of beta after `seconds`, rad; 0 for other laws than [`LengthLaw::Round`].
    fn beta_change(&self, seconds: f64) -> f64 {
        let Self::Round { radius, speed, phase, rate, .. } = *self else { return 0.0 };
        let sliding_rate = speed / radius;
        let (sin, cos) = math::sin_cos(phase);
        // z = tan(beta / 2) obeys a Riccati equation, so z is a quotient of two solutions of a linear equation. `atan2`
        // takes numerator and denominator separately, so a pole of z needs no special case.
        let (even, odd) = linear_solutions(sliding_rate, rate, seconds);
        2.0 * math::atan2(0.5 * odd * (rate - sliding_rate * sin), even + 0.5 * odd * sliding_rate * cos)
    }

    /// Seconds until the beta of [`LengthLaw::Round`] has changed by `angle`, rad; infinite if it never does. `angle`
    /// is at most half a turn.
    pub(super) fn seconds_to_turn(&self, angle: f64) -> f64 {
        let Self::Round { radius, speed, phase, rate, .. } = *self else { return f64::INFINITY };
        let sliding_rate = speed / radius;
        let (sin, cos) = math::sin_cos(phase);
        let (half_sin, half_cos) = math::sin_cos(0.5 * angle);
        let q = 0.5 * ((sliding_rate - rate) * (sliding_rate + rate)).abs().sqrt();
        // odd / even = tanh(q t) / q, or tan(q t) / q.
        let numerator = 2.0 * half_sin;
        let denominator = half_cos * (rate - sliding_rate * sin) - half_sin * sliding_rate * cos;
        if sliding_rate.abs() > rate.abs() {
            let ratio = q * numerator / denominator;
            if (0.0..1.0).contains(&ratio) { 0.5 * math::ln_1p(2.0 * ratio / (1.0 - ratio)) / q } else { f64::INFINITY }
        } else if q == 0.0 {
            let seconds = numerator / denominator;
            if seconds >= 0.0 { seconds } else { f64::INFINITY }
        } else {
            let angle = math::atan2(q * numerator, denominator);
            (if angle < 0.0 { angle + PI } else { angle }) / q
        }
    }
}

/// Even and odd solution of the linear equation y'' = s y at the time t = `seconds`, with s = (`sliding_rate`^2 -
/// `rate`^2) / 4. Let q = sqrt |s|. The results have a common factor, since callers use only their quotient: for s > 0
/// the solutions cosh(q t) and sinh(q t) / q are divided by cosh(q t), so that they do not overflow. For s < 0 they are
/// cos(q t) and sin(q t) / q.
fn linear_solutions(sliding_rate: f64, rate: f64, seconds: f64) -> (f64, f64) {
    let s = 0.25 * (sliding_rate - rate) * (sliding_rate + rate);
    let q = s.abs().sqrt();
    let x = q * seconds;
    if x < 1e-5 {
        let square = s * seconds * seconds;
        (1.0 + 0.5 * square, seconds * (1.0 + square / 6.0))
    } else if s > 0.0 {
        (1.0, math::tanh(x) / q)
    } else {
        let (sin, cos) = math::sin_cos(x);
        (cos, sin / q)
    }
}

/// Turn of a path since its start, rad, up to which the centre of a surrounding disc is on the tangent at the start;
/// after a larger turn the centre is on the path. A disc on the tangent is enlarged by the maximum distance between
/// path and tangent: half of the acceleration times the squared time. It needs no trigonometric function. Our choice.
const NEARLY_STRAIGHT: f64 = 0.125;

impl Path {
    /// The path of the origin of a frame that starts at `pose` and moves with `twist`.
    pub fn new(pose: &Pose, twist: Twist) -> Self {
        Self { origin: pose.position, direction: pose.heading.direction(), twist, pace: Pace::ConstantTwist }
    }

    /// The path of a point at rest.
    pub fn resting(origin: DVec2) -> Self {
        Self { origin, direction: DVec2::X, twist: Twist::ZERO, pace: Pace::ConstantTwist }
    }

    /// Returns true if the point is at rest; its frame may still turn.
    pub fn is_resting(&self) -> bool {
        self.twist.vx == 0.0 && self.twist.vy == 0.0
    }

    /// Speed of the twist, m/s: the speed of the point for constant twist, 1 for a sliding point.
    pub fn speed(&self) -> f64 {
        self.twist.speed()
    }

    /// Turning speed of the body, rad/s.
    pub fn omega(&self) -> f64 {
        match self.pace {
            Pace::ConstantTwist => self.twist.omega,
            Pace::Sliding { omega, .. } => omega,
        }
    }

    /// Upper bound of the acceleration, m/s^2.
    pub fn acceleration(&self) -> f64 {
        match self.pace {
            Pace::ConstantTwist => self.speed() * self.twist.omega.abs(),
            Pace::Sliding { law, .. } => law.acceleration(self.twist.omega),
        }
    }

    /// Time at which the twist alone would bring the point to its position after `seconds`: `seconds` itself for a
    /// constant twist; for a sliding point the covered length, since its twist has the speed 1 m/s.
    fn twist_seconds(&self, seconds: f64) -> f64 {
        match self.pace {
            Pace::ConstantTwist => seconds,
            Pace::Sliding { law, .. } => law.length(seconds),
        }
    }

    /// Position after `seconds`.
    pub fn position(&self, seconds: f64) -> DVec2 {
        if self.is_resting() {
            return self.origin;
        }
        let Twist { vx, vy, omega } = self.twist.scaled(self.twist_seconds(seconds));
        let (s, c) = (math::sinc(omega), math::cosc(omega));
        self.origin + self.direction.rotate(DVec2::new(vx * s - vy * c, vx * c + vy * s))
    }

    /// Velocity after `seconds`, m/s in the world.
    pub fn velocity(&self, seconds: f64) -> DVec2 {
        let (sin, cos) = math::sin_cos(self.twist.omega * self.twist_seconds(seconds));
        let velocity = self.direction.rotate(DVec2::new(cos, sin).rotate(DVec2::new(self.twist.vx, self.twist.vy)));
        match self.pace {
            Pace::ConstantTwist => velocity,
            Pace::Sliding { law, .. } => velocity * law.speed(seconds),
        }
    }

    /// Seconds after which a circle of constant twist repeats itself; infinite for a straight line.
    pub fn period(&self) -> f64 {
        // Without rotation, the quotient is infinite.
        TAU / self.twist.omega.abs()
    }

    /// A rectangle that contains the path from `from` to `to` seconds.
    pub fn bounds(&self, from: f64, to: f64) -> Bounds {
        let (middle, reach) = self.surrounding_disc(from, to);
        Bounds::of_disc(middle, reach)
    }

    /// Centre and radius of a disc that contains the path from `from` to `to` seconds.
    pub fn surrounding_disc(&self, from: f64, to: f64) -> (DVec2, f64) {
        if self.is_resting() {
            return (self.origin, 0.0);
        }
        let (from, to) = (self.twist_seconds(from), self.twist_seconds(to));
        let speed = self.speed();
        // No point is farther from the middle than half the length of the path or the diameter of the circle.
        let half_length = 0.5 * speed * (to - from);
        let (middle, omega) = (0.5 * (from + to), self.twist.omega.abs());
        if to * omega <= NEARLY_STRAIGHT {
            let velocity = self.direction.rotate(DVec2::new(self.twist.vx, self.twist.vy));
            return (self.origin + velocity * middle, half_length + 0.5 * speed * omega * to * to);
        }
        let middle = Self { pace: Pace::ConstantTwist, ..*self }.position(middle);
        (middle, half_length.min(2.0 * speed / omega))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn surrounding_disc_contains_the_path(
            (vx, vy, omega) in (-3.0..3.0_f64, -3.0..3.0_f64, -4.0..4.0_f64),
            (from, length) in (0.0..0.2_f64, 0.0..0.3_f64),
            part in 0.0..=1.0_f64,
        ) {
            let path = Path::new(&Pose::new(1.0, -2.0, 0.7), Twist { vx, vy, omega });
            let (middle, radius) = path.surrounding_disc(from, from + length);
            let distance = (path.position(from + part * length) - middle).length();
            prop_assert!(distance <= radius + 1e-12, "{distance} {radius}");
            // The disc is not much larger than the path.
            prop_assert!(radius <= 0.5 * path.speed() * (length + 0.125 * (from + length)) + 1e-12);
        }
    }
}
