//! Closed forms of motion on a floor with friction, and of impacts of smooth discs.

use glam::DVec2;
use sim_core::math;
use sim_core::object::GRAVITY;

/// Impact of a moving disc on a resting one, without friction.
#[derive(Clone, Copy, Debug)]
pub struct Impact {
    /// Masses of the moving and of the resting disc, kg.
    pub masses: [f64; 2],
    /// Distance of the centres at contact (sum of the radii), m.
    pub contact_distance: f64,
    /// Speed of the moving disc along x, m/s.
    pub speed: f64,
    /// Impact parameter: lateral distance of the resting disc's centre from the path of the moving disc, positive to
    /// the left, m.
    pub offset: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
}

impl Impact {
    /// Direction from the centre of the moving disc to that of the resting disc at contact.
    pub fn normal(&self) -> DVec2 {
        DVec2::new((self.contact_distance * self.contact_distance - self.offset * self.offset).sqrt(), self.offset)
            / self.contact_distance
    }

    /// Velocities after the impact, m/s.
    pub fn velocities(&self) -> [DVec2; 2] {
        let [moving_mass, resting_mass] = self.masses;
        let normal = self.normal();
        let impulse = (1.0 + self.restitution) * moving_mass * resting_mass / (moving_mass + resting_mass)
            * self.speed
            * normal.x;
        [DVec2::new(self.speed, 0.0) - normal * (impulse / moving_mass), normal * (impulse / resting_mass)]
    }

    /// Positions of both centres `seconds` after the start, with the resting disc at the origin and the moving one at x
    /// = -`distance`.
    pub fn positions(&self, distance: f64, seconds: f64) -> [DVec2; 2] {
        let contact_position = -self.normal() * self.contact_distance;
        let after_contact = seconds - (distance + contact_position.x) / self.speed;
        let [moving_velocity, resting_velocity] = self.velocities();
        [contact_position + moving_velocity * after_contact, resting_velocity * after_contact]
    }
}

/// Stopping distance from `speed`, m, for a coefficient of friction or of rolling resistance.
pub fn stopping_distance(speed: f64, coefficient: f64) -> f64 {
    speed * speed / (2.0 * coefficient * GRAVITY)
}

/// Distance and angle that a sliding and spinning disc covers until it is at rest.
///
/// docs/motion.md: dv/dt = -a v / l and dw/dt = -8/9 a w / l, with l^2 = v^2 + q^2 w^2, q^2 = 8/9 k^2 (k: radius of
/// gyration) and a = `coefficient` g. With p = q w this gives p = c v^(8/9). The distance is the integral of l / a over
/// v, the angle that of (w / v) l / a. With v = s^9 both integrands are smooth, for Simpson's rule.
pub fn slide_and_turn(speed: f64, omega: f64, radius: f64, coefficient: f64) -> (f64, f64) {
    const INTERVALS: u32 = 2_000;
    let q = (8.0_f64 / 9.0 * 0.5).sqrt() * radius;
    let s_start = math::exp(math::ln(speed) / 9.0);
    let c = q * omega / s_start.powi(8);
    let scale = 9.0 / (coefficient * GRAVITY);
    let l_over_s8 = |s: f64| (s * s + c * c).sqrt();
    let integral = |integrand: &dyn Fn(f64) -> f64| {
        let weight = |index: u32| match index {
            0 | INTERVALS => 1.0,
            odd if odd % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let width = s_start / f64::from(INTERVALS);
        (0..=INTERVALS).map(|index| weight(index) * integrand(f64::from(index) * width)).sum::<f64>() * width / 3.0
    };
    let distance = scale * integral(&|s| s.powi(16) * l_over_s8(s));
    let angle = scale * c / q * integral(&|s| s.powi(15) * l_over_s8(s));
    (distance, angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impact_conserves_momentum_and_separates_with_the_restitution() {
        let impact = Impact { masses: [0.2, 0.3], contact_distance: 0.1, speed: 1.5, offset: 0.06, restitution: 0.5 };
        let [moving, resting] = impact.velocities();
        assert!((moving * 0.2 + resting * 0.3 - DVec2::new(0.3, 0.0)).length() < 1e-15);
        let separation_speed = (resting - moving).dot(impact.normal());
        assert!(
            (separation_speed - 0.5 * 1.5 * 0.8).abs() < 1e-15,
            "normal speeds part at the restitution: {separation_speed}"
        );
    }

    #[test]
    fn slide_and_turn_matches_pure_sliding_and_small_time_steps() {
        let (distance, angle) = slide_and_turn(1.0, 1e-9, 0.1, 0.4);
        assert!((distance - stopping_distance(1.0, 0.4)).abs() < 1e-9 && angle < 1e-6, "{distance} m, {angle}");
        let (distance, angle) = slide_and_turn(1.0, 20.0, 0.1, 0.4);
        let (mut v, mut w, mut x, mut turned) = (1.0, 20.0, 0.0, 0.0);
        let (step, a) = (1e-6, 0.4 * GRAVITY);
        let gyration_squared = 0.005;
        let spin_factor = 8.0 / 9.0;
        let l = |v: f64, w: f64| (v * v + spin_factor * gyration_squared * w * w).sqrt();
        while l(v, w) > 1e-5 {
            let fraction = a * step / l(v, w);
            x += v * step * (1.0 - 0.5 * fraction);
            turned += w * step * (1.0 - 0.5 * spin_factor * fraction);
            v *= 1.0 - fraction;
            w *= 1.0 - spin_factor * fraction;
        }
        assert!(
            (x - distance).abs() < 1e-6 && (turned - angle).abs() < 1e-5,
            "{x} instead of {distance}, {turned} instead of {angle}"
        );
    }
}
