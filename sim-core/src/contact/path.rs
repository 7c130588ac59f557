//! The path of a disc's centre at constant twist.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::{
    math,
    pose::{Pose, Twist},
    scene::Bounds,
};

/// The way of a point that moves at constant twist: a straight line, a circle, or rest. Times are seconds since its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    /// Where it starts, in the world, m.
    pub origin: DVec2,
    /// Unit vector of the moving frame's x axis at the start.
    pub direction: DVec2,
    /// Twist of the moving frame.
    pub twist: Twist,
}

impl Path {
    /// The path of the origin of a frame that starts at `pose` and moves with `twist`.
    pub fn new(pose: &Pose, twist: Twist) -> Self {
        Self { origin: pose.position, direction: pose.heading.direction(), twist }
    }

    /// A point that stays.
    pub fn resting(origin: DVec2) -> Self {
        Self { origin, direction: DVec2::X, twist: Twist::ZERO }
    }

    /// True when the point stays where it is, though its frame may turn.
    pub fn is_resting(&self) -> bool {
        self.twist.vx == 0.0 && self.twist.vy == 0.0
    }

    /// Speed along the path, m/s.
    pub fn speed(&self) -> f64 {
        self.twist.speed()
    }

    /// Position after `seconds`.
    pub fn position(&self, seconds: f64) -> DVec2 {
        if self.is_resting() {
            return self.origin;
        }
        let Twist { vx, vy, omega } = self.twist.scaled(seconds);
        let (s, c) = (math::sinc(omega), math::cosc(omega));
        self.origin + self.direction.rotate(DVec2::new(vx * s - vy * c, vx * c + vy * s))
    }

    /// Velocity after `seconds`, m/s in the world.
    pub fn velocity(&self, seconds: f64) -> DVec2 {
        let (sin, cos) = math::sin_cos(self.twist.omega * seconds);
        self.direction.rotate(DVec2::new(cos, sin).rotate(DVec2::new(self.twist.vx, self.twist.vy)))
    }

    /// Seconds after which a curved path repeats itself; infinite for a straight one.
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
        let speed = self.speed();
        // No point is farther from the middle than half the way, or than the circle is wide.
        let half_way = 0.5 * speed * (to - from);
        (self.position(0.5 * (from + to)), half_way.min(2.0 * speed / self.twist.omega.abs()))
    }
}
