//! Energy limit of a step: removes energy that the solver has added, for each island of touching bodies.
//!
//! The motion of an island is the sum of the rigid motion that has the island's momentum and angular momentum, and of
//! the relative motion of its bodies. Only the relative motion is scaled, so that momentum is conserved. If an island
//! touches an immovable body, its momentum is not conserved, and its whole motion is scaled.

use glam::DVec2;

use super::Velocity;

/// A body in an island of touching bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct IslandBody {
    pub mass: f64,
    pub inertia: f64,
    pub centre: DVec2,
    pub velocity: Velocity,
}

impl IslandBody {
    pub fn energy(&self) -> f64 {
        0.5 * (self.mass * self.velocity.linear.length_squared()
            + self.inertia * self.velocity.omega * self.velocity.omega)
    }
}

/// Scales the velocities of an island so that its energy is at most `max_energy`; `is_held` is true if the island
/// touches an immovable body.
pub(super) fn limit(members: &mut [IslandBody], max_energy: f64, is_held: bool) {
    let energy: f64 = members.iter().map(IslandBody::energy).sum();
    if energy <= max_energy {
        return;
    }
    let common = if is_held { RigidMotion::default() } else { RigidMotion::of_island(members) };
    let (mut common_energy, mut relative_energy) = (0.0, 0.0);
    for member in members.iter() {
        let rigid = IslandBody { velocity: common.velocity_at(member.centre), ..*member };
        let relative = Velocity {
            linear: member.velocity.linear - rigid.velocity.linear,
            omega: member.velocity.omega - rigid.velocity.omega,
        };
        common_energy += rigid.energy();
        relative_energy += IslandBody { velocity: relative, ..*member }.energy();
    }
    let relative_factor = if relative_energy > 0.0 {
        ((max_energy - common_energy).max(0.0) / relative_energy).sqrt().min(1.0)
    } else {
        0.0
    };
    // The energy of the common motion exceeds the limit only by rounding, or because the distances between the bodies
    // have changed in the step.
    let common_factor = if common_energy > max_energy { (max_energy / common_energy).sqrt() } else { 1.0 };
    for member in members {
        let rigid = common.velocity_at(member.centre);
        let scaled = |total: f64, common: f64| common * common_factor + (total - common) * relative_factor;
        member.velocity = Velocity {
            linear: rigid.linear * common_factor + (member.velocity.linear - rigid.linear) * relative_factor,
            omega: scaled(member.velocity.omega, rigid.omega),
        };
    }
}

/// Rigid motion of an island: all bodies move together.
#[derive(Clone, Copy, Debug, Default)]
struct RigidMotion {
    centre: DVec2,
    velocity: DVec2,
    omega: f64,
}

impl RigidMotion {
    /// Rigid motion with the total momentum and angular momentum of `members`.
    fn of_island(members: &[IslandBody]) -> Self {
        let mass: f64 = members.iter().map(|member| member.mass).sum();
        let centre = members.iter().map(|member| member.centre * member.mass).sum::<DVec2>() / mass;
        let velocity = members.iter().map(|member| member.velocity.linear * member.mass).sum::<DVec2>() / mass;
        let (mut angular_momentum, mut inertia) = (0.0, 0.0);
        for member in members {
            let arm = member.centre - centre;
            angular_momentum +=
                member.inertia * member.velocity.omega + member.mass * arm.perp_dot(member.velocity.linear);
            inertia += member.inertia + member.mass * arm.length_squared();
        }
        Self { centre, velocity, omega: angular_momentum / inertia }
    }

    fn velocity_at(&self, point: DVec2) -> Velocity {
        Velocity { linear: self.velocity + (point - self.centre).perp() * self.omega, omega: self.omega }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair() -> [IslandBody; 2] {
        let member = |x: f64, vx: f64, omega: f64| IslandBody {
            mass: 1.0 + x,
            inertia: 0.1,
            centre: DVec2::new(x, 0.3 * x),
            velocity: Velocity { linear: DVec2::new(vx, 0.2), omega },
        };
        [member(0.0, 1.0, 2.0), member(1.0, -0.5, -1.0)]
    }

    fn momenta_and_energy(members: &[IslandBody]) -> (DVec2, f64, f64) {
        let momentum = members.iter().map(|m| m.velocity.linear * m.mass).sum();
        let angular =
            members.iter().map(|m| m.inertia * m.velocity.omega + m.mass * m.centre.perp_dot(m.velocity.linear)).sum();
        (momentum, angular, members.iter().map(IslandBody::energy).sum())
    }

    #[test]
    fn free_island_conserves_momentum_and_angular_momentum() {
        let mut members = pair();
        let (momentum, angular, energy) = momenta_and_energy(&members);
        limit(&mut members, 0.9 * energy, false);
        let after = momenta_and_energy(&members);
        assert!((after.0 - momentum).length() < 1e-14 && (after.1 - angular).abs() < 1e-14);
        assert!((after.2 / (0.9 * energy) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn energy_within_the_limit_changes_nothing() {
        let mut members = pair();
        let (.., energy) = momenta_and_energy(&members);
        limit(&mut members, energy, false);
        assert!(members.iter().zip(&pair()).all(|(a, b)| a.velocity == b.velocity));
        limit(&mut members, 0.25 * energy, true);
        assert!((momenta_and_energy(&members).2 / (0.25 * energy) - 1.0).abs() < 1e-14);
        assert!((members[0].velocity.linear.x - 0.5).abs() < 1e-14);
    }
}
