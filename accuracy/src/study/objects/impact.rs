//! Closed forms of motion on a floor with friction, and of impacts of smooth discs.

use glam::DVec2;
use sim_core::math;
use sim_core::object::GRAVITY;

/// Impact of a moving disc on a resting one, without friction.
#[derive(Clone, Copy, Debug)]
pub struct Impact {
    /// Masses of the moving and of the resting disc, kg.
    pub masses: [f64; 2],
    /// Sum of the radii, m.
    pub reach: f64,
    /// Speed of the moving disc along x, m/s.
    pub speed: f64,
    /// Distance of the resting centre to the left of the moving disc's path, m.
    pub offset: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
}

impl Impact {
    /// Direction from the moving to the resting centre when they touch.
    pub fn normal(&self) -> DVec2 {
        DVec2::new((self.reach * self.reach - self.offset * self.offset).sqrt(), self.offset) / self.reach
    }

    /// Velocities after the impact, m/s.
    pub fn velocities(&self) -> [DVec2; 2] {
        let [mass, other] = self.masses;
        let normal = self.normal();
        let impulse = (1.0 + self.restitution) * mass * other / (mass + other) * self.speed * normal.x;
        [DVec2::new(self.speed, 0.0) - normal * (impulse / mass), normal * (impulse / other)]
    }

    /// Positions of both centres `seconds` after the start, with the resting disc at the origin and the moving one at x = -`distance`.
    pub fn positions(&self, distance: f64, seconds: f64) -> [DVec2; 2] {
        let touching = -self.normal() * self.reach;
        let left = seconds - (distance + touching.x) / self.speed;
        let [one, other] = self.velocities();
        [touching + one * left, other * left]
    }
}

/// Distance to rest from `speed`, m, at a coefficient of friction or of rolling resistance.
pub fn way_to_rest(speed: f64, coefficient: f64) -> f64 {
    speed * speed / (2.0 * coefficient * GRAVITY)
}

/// Distance and angle to rest of a disc that slides and turns.
///
/// With p = q w and q^2 = 8/9 k^2 the friction of docs/motion.md gives dp/dv = 8/9 p/v, so p = c v^(8/9). With v = s^9 both integrals are
/// smooth: the distance is that of l dv / a, the angle that of (w / v) l dv / a, by Simpson's rule.
pub fn slide_and_turn(speed: f64, omega: f64, radius: f64, coefficient: f64) -> (f64, f64) {
    const INTERVALS: u32 = 2_000;
    let q = (8.0_f64 / 9.0 * 0.5).sqrt() * radius;
    let last = math::exp(math::ln(speed) / 9.0);
    let c = q * omega / last.powi(8);
    let scale = 9.0 / (coefficient * GRAVITY);
    let length = |s: f64| (s * s + c * c).sqrt();
    let integral = |of: &dyn Fn(f64) -> f64| {
        let weight = |index: u32| match index {
            0 | INTERVALS => 1.0,
            odd if odd % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let width = last / f64::from(INTERVALS);
        (0..=INTERVALS).map(|index| weight(index) * of(f64::from(index) * width)).sum::<f64>() * width / 3.0
    };
    let way = scale * integral(&|s| s.powi(16) * length(s));
    let angle = scale * c / q * integral(&|s| s.powi(15) * length(s));
    (way, angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impacts_keep_momentum_and_lose_the_energy_of_the_restitution() {
        let impact = Impact { masses: [0.2, 0.3], reach: 0.1, speed: 1.5, offset: 0.06, restitution: 0.5 };
        let [one, other] = impact.velocities();
        assert!((one * 0.2 + other * 0.3 - DVec2::new(0.3, 0.0)).length() < 1e-15);
        let apart = (other - one).dot(impact.normal());
        assert!((apart - 0.5 * 1.5 * 0.8).abs() < 1e-15, "normal speeds part at the restitution: {apart}");
    }

    #[test]
    fn sliding_and_turning_ends_as_each_alone_and_as_small_steps() {
        let (way, angle) = slide_and_turn(1.0, 1e-9, 0.1, 0.4);
        assert!((way - way_to_rest(1.0, 0.4)).abs() < 1e-9 && angle < 1e-6, "{way} m, {angle}");
        let (way, angle) = slide_and_turn(1.0, 20.0, 0.1, 0.4);
        let (mut v, mut w, mut x, mut turned) = (1.0, 20.0, 0.0, 0.0);
        let (step, a) = (1e-6, 0.4 * GRAVITY);
        let (l, k2) = (|v: f64, w: f64| (v * v + 8.0 / 9.0 * 0.005 * w * w).sqrt(), 8.0 / 9.0);
        while l(v, w) > 1e-5 {
            let share = a * step / l(v, w);
            x += v * step * (1.0 - 0.5 * share);
            turned += w * step * (1.0 - 0.5 * k2 * share);
            v *= 1.0 - share;
            w *= 1.0 - k2 * share;
        }
        assert!((x - way).abs() < 1e-6 && (turned - angle).abs() < 1e-5, "{x} for {way}, {turned} for {angle}");
    }
}
