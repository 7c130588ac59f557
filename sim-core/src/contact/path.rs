//! The path of a disc's centre at constant twist.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use crate::{
    math,
    pose::{Pose, Twist},
    scene::Bounds,
};

/// The way of a point that moves at constant twist: a straight line, a circle, or rest; or that slides along such a track. Times
/// are seconds since its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    /// Where it starts, in the world, m.
    pub origin: DVec2,
    /// Unit vector of the moving frame's x axis at the start.
    pub direction: DVec2,
    /// Twist of the moving frame; of a track the twist at 1 m/s along it.
    pub twist: Twist,
    /// How fast the point moves.
    pub pace: Pace,
}

/// How fast a point moves on its path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// With the path's twist, which the body's heading follows.
    Even,
    /// Along the path's track by a law of its own, while the body's heading turns at `omega` rad/s.
    Led {
        /// Turning speed of the body, rad/s.
        omega: f64,
        /// The length covered as a function of time.
        law: Law,
    },
}

/// The length that a sliding point has covered as a function of time: a closed form, that grows for as long as the path holds.
///
/// The rates are those of the angle beta of docs/motion.md, the direction of the push against the contact's tangent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Constant speed, m/s.
    Steady(f64),
    /// Along a straight wall, of a body that turns: speed `speed` sin(`phase` + `rate` t).
    Wave {
        /// Greatest speed, m/s; negative where the track leads against the contact's tangent.
        speed: f64,
        /// Beta at the start, rad.
        phase: f64,
        /// Rate of beta, rad/s.
        rate: f64,
    },
    /// Around a point: speed `speed` sin(beta), with the rate of beta `rate` - `speed` / `radius` sin(beta).
    Round {
        /// Distance of the track from the point, m.
        radius: f64,
        /// Greatest speed, m/s.
        speed: f64,
        /// Beta at the start, rad.
        phase: f64,
        /// Turning speed of the push, rad/s.
        rate: f64,
        /// 1, or -1 where the track leads against the contact's tangent.
        sense: f64,
    },
}

impl Law {
    /// The length covered after `seconds`, m.
    pub fn length(&self, seconds: f64) -> f64 {
        match *self {
            Self::Steady(speed) => speed * seconds,
            Self::Wave { speed, phase, rate } => {
                let (sin, cos) = math::sin_cos(phase);
                speed * seconds * (sin * math::sinc(rate * seconds) + cos * math::cosc(rate * seconds))
            }
            Self::Round { radius, rate, sense, .. } => sense * radius * (rate * seconds - self.turned(seconds)),
        }
    }

    /// Speed along the track after `seconds`, m/s.
    pub fn speed(&self, seconds: f64) -> f64 {
        match *self {
            Self::Steady(speed) => speed,
            Self::Wave { speed, phase, rate } => speed * math::sin(phase + rate * seconds),
            Self::Round { speed, phase, sense, .. } => sense * speed * math::sin(phase + self.turned(seconds)),
        }
    }

    /// A bound of the acceleration of a point on a track of this curvature (1/m), m/s^2.
    fn acceleration(&self, curvature: f64) -> f64 {
        match *self {
            Self::Steady(speed) => speed * speed * curvature.abs(),
            Self::Wave { speed, rate, .. } => (speed * rate).abs(),
            Self::Round { radius, speed, rate, .. } => speed * (rate.abs() + 2.0 * speed / radius),
        }
    }

    /// What beta has gained after `seconds`, rad.
    fn turned(&self, seconds: f64) -> f64 {
        let Self::Round { radius, speed, phase, rate, .. } = *self else { return 0.0 };
        let pull = speed / radius;
        let (sin, cos) = math::sin_cos(phase);
        // z = tan(beta / 2) obeys a Riccati equation; as a quotient of two solutions of a linear one it has no pole.
        let (even, odd) = growth(pull, rate, seconds);
        2.0 * math::atan2(0.5 * odd * (rate - pull * sin), even + 0.5 * odd * pull * cos)
    }

    /// Seconds after which beta, of [`Law::Round`], has gained `angle`, up to half a turn; infinite where it never does.
    pub(super) fn seconds_to_turn(&self, angle: f64) -> f64 {
        let Self::Round { radius, speed, phase, rate, .. } = *self else { return f64::INFINITY };
        let pull = speed / radius;
        let (sin, cos) = math::sin_cos(phase);
        let (half_sin, half_cos) = math::sin_cos(0.5 * angle);
        let q = 0.5 * ((pull - rate) * (pull + rate)).abs().sqrt();
        // odd / even = tanh(q t) / q, or tan(q t) / q.
        let (over, under) = (2.0 * half_sin, half_cos * (rate - pull * sin) - half_sin * pull * cos);
        if pull.abs() > rate.abs() {
            let ratio = q * over / under;
            if (0.0..1.0).contains(&ratio) { 0.5 * math::ln_1p(2.0 * ratio / (1.0 - ratio)) / q } else { f64::INFINITY }
        } else if q == 0.0 {
            let seconds = over / under;
            if seconds >= 0.0 { seconds } else { f64::INFINITY }
        } else {
            let turned = math::atan2(q * over, under);
            (if turned < 0.0 { turned + PI } else { turned }) / q
        }
    }
}

/// Even and odd part of the solution of the linear equation: cosh(q t) and sinh(q t) / q up to a common factor, or cos and sin.
fn growth(pull: f64, rate: f64, seconds: f64) -> (f64, f64) {
    let square = 0.25 * (pull - rate) * (pull + rate);
    let q = square.abs().sqrt();
    let x = q * seconds;
    if x < 1e-5 {
        let square = square * seconds * seconds;
        (1.0 + 0.5 * square, seconds * (1.0 + square / 6.0))
    } else if square > 0.0 {
        (1.0, math::tanh(x) / q)
    } else {
        let (sin, cos) = math::sin_cos(x);
        (cos, sin / q)
    }
}

impl Path {
    /// The path of the origin of a frame that starts at `pose` and moves with `twist`.
    pub fn new(pose: &Pose, twist: Twist) -> Self {
        Self { origin: pose.position, direction: pose.heading.direction(), twist, pace: Pace::Even }
    }

    /// A point that stays.
    pub fn resting(origin: DVec2) -> Self {
        Self { origin, direction: DVec2::X, twist: Twist::ZERO, pace: Pace::Even }
    }

    /// True when the point stays where it is, though its frame may turn.
    pub fn is_resting(&self) -> bool {
        self.twist.vx == 0.0 && self.twist.vy == 0.0
    }

    /// Speed along the path, m/s; along a track 1.
    pub fn speed(&self) -> f64 {
        self.twist.speed()
    }

    /// Turning speed of the body, rad/s.
    pub fn omega(&self) -> f64 {
        match self.pace {
            Pace::Even => self.twist.omega,
            Pace::Led { omega, .. } => omega,
        }
    }

    /// A bound of the acceleration, m/s^2.
    pub fn acceleration(&self) -> f64 {
        match self.pace {
            Pace::Even => self.speed() * self.twist.omega.abs(),
            Pace::Led { law, .. } => law.acceleration(self.twist.omega),
        }
    }

    /// Seconds at the path's twist that lead to where the point is after `seconds`.
    fn even_seconds(&self, seconds: f64) -> f64 {
        match self.pace {
            Pace::Even => seconds,
            Pace::Led { law, .. } => law.length(seconds),
        }
    }

    /// Position after `seconds`.
    pub fn position(&self, seconds: f64) -> DVec2 {
        if self.is_resting() {
            return self.origin;
        }
        let Twist { vx, vy, omega } = self.twist.scaled(self.even_seconds(seconds));
        let (s, c) = (math::sinc(omega), math::cosc(omega));
        self.origin + self.direction.rotate(DVec2::new(vx * s - vy * c, vx * c + vy * s))
    }

    /// Velocity after `seconds`, m/s in the world.
    pub fn velocity(&self, seconds: f64) -> DVec2 {
        let (sin, cos) = math::sin_cos(self.twist.omega * self.even_seconds(seconds));
        let velocity = self.direction.rotate(DVec2::new(cos, sin).rotate(DVec2::new(self.twist.vx, self.twist.vy)));
        match self.pace {
            Pace::Even => velocity,
            Pace::Led { law, .. } => velocity * law.speed(seconds),
        }
    }

    /// Seconds after which a curved path of even pace repeats itself; infinite for a straight one.
    pub fn period(&self) -> f64 {
        // 0 turns into infinity.
        TAU / self.twist.omega.abs()
    }

    /// A rectangle that holds the path from `from` to `to` seconds.
    pub fn bounds(&self, from: f64, to: f64) -> Bounds {
        let (middle, reach) = self.surrounding_disc(from, to);
        Bounds::of_disc(middle, reach)
    }

    /// Centre and radius of a disc that holds the path from `from` to `to` seconds.
    pub fn surrounding_disc(&self, from: f64, to: f64) -> (DVec2, f64) {
        if self.is_resting() {
            return (self.origin, 0.0);
        }
        let (from, to) = (self.even_seconds(from), self.even_seconds(to));
        let speed = self.speed();
        // No point is farther from the middle than half the way, or than the circle is wide.
        let half_way = 0.5 * speed * (to - from);
        let middle = Self { pace: Pace::Even, ..*self }.position(0.5 * (from + to));
        (middle, half_way.min(2.0 * speed / self.twist.omega.abs()))
    }
}
