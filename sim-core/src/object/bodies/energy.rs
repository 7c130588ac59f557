//! Energy limit of a step: energy that the solver added is removed, island by island.
//!
//! The motion of an island is split into the rigid motion that has the island's momentum and angular momentum, and the
//! rest. Only the rest is scaled, so that momentum is conserved. An island that touches an immovable body passes its
//! momentum to that body, and its whole motion is scaled.

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

/// Scales the velocities of an island so that its energy is at most `limit`; `is_held` states that the island touches
/// an immovable body.
pub(super) fn limit(members: &mut [IslandBody], limit: f64, is_held: bool) {
    let energy: f64 = members.iter().map(IslandBody::energy).sum();
    if energy <= limit {
        return;
    }
    let common = if is_held { Rigid::default() } else { Rigid::of(members) };
    let (mut shared, mut relative) = (0.0, 0.0);
    for member in members.iter() {
        let rigid = IslandBody { velocity: common.at(member.centre), ..*member };
        let rest = Velocity {
            linear: member.velocity.linear - rigid.velocity.linear,
            omega: member.velocity.omega - rigid.velocity.omega,
        };
        shared += rigid.energy();
        relative += IslandBody { velocity: rest, ..*member }.energy();
    }
    let factor = if relative > 0.0 { ((limit - shared).max(0.0) / relative).sqrt().min(1.0) } else { 0.0 };
    // The common motion can exceed the limit only by rounding, or because distances between the bodies changed in the
    // step.
    let shared_factor = if shared > limit { (limit / shared).sqrt() } else { 1.0 };
    for member in members {
        let rigid = common.at(member.centre);
        let scaled = |whole: f64, part: f64| part * shared_factor + (whole - part) * factor;
        member.velocity = Velocity {
            linear: rigid.linear * shared_factor + (member.velocity.linear - rigid.linear) * factor,
            omega: scaled(member.velocity.omega, rigid.omega),
        };
    }
}

/// Rigid motion of all bodies of an island together.
#[derive(Clone, Copy, Debug, Default)]
struct Rigid {
    centre: DVec2,
    velocity: DVec2,
    omega: f64,
}

impl Rigid {
    /// Rigid motion with the total momentum and angular momentum of `members`.
    fn of(members: &[IslandBody]) -> Self {
        let mass: f64 = members.iter().map(|member| member.mass).sum();
        let centre = members.iter().map(|member| member.centre * member.mass).sum::<DVec2>() / mass;
        let velocity = members.iter().map(|member| member.velocity.linear * member.mass).sum::<DVec2>() / mass;
        let (mut momentum, mut inertia) = (0.0, 0.0);
        for member in members {
            let arm = member.centre - centre;
            momentum += member.inertia * member.velocity.omega + member.mass * arm.perp_dot(member.velocity.linear);
            inertia += member.inertia + member.mass * arm.length_squared();
        }
        Self { centre, velocity, omega: momentum / inertia }
    }

    fn at(&self, point: DVec2) -> Velocity {
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

    fn sums(members: &[IslandBody]) -> (DVec2, f64, f64) {
        let momentum = members.iter().map(|m| m.velocity.linear * m.mass).sum();
        let angular =
            members.iter().map(|m| m.inertia * m.velocity.omega + m.mass * m.centre.perp_dot(m.velocity.linear)).sum();
        (momentum, angular, members.iter().map(IslandBody::energy).sum())
    }

    #[test]
    fn a_free_island_keeps_its_momenta() {
        let mut members = pair();
        let (momentum, angular, energy) = sums(&members);
        limit(&mut members, 0.9 * energy, false);
        let after = sums(&members);
        assert!((after.0 - momentum).length() < 1e-14 && (after.1 - angular).abs() < 1e-14);
        assert!((after.2 / (0.9 * energy) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn what_is_within_the_limit_stays_to_the_bit() {
        let mut members = pair();
        let (.., energy) = sums(&members);
        limit(&mut members, energy, false);
        assert!(members.iter().zip(&pair()).all(|(a, b)| a.velocity == b.velocity));
        limit(&mut members, 0.25 * energy, true);
        assert!((sums(&members).2 / (0.25 * energy) - 1.0).abs() < 1e-14);
        assert!((members[0].velocity.linear.x - 0.5).abs() < 1e-14);
    }
}
