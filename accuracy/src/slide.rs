//! Reference integrator with small steps for the sliding of a disc along walls; the core's closed forms are compared
//! with it.
//!
//! The integrator does not compute the instants at which contacts begin and end, as the core does. In each step, sweeps
//! over the contacts (projected Gauss-Seidel) find contact forces that keep the disc out of the walls and are within
//! their friction cones. The error falls with the length of the step.

use glam::DVec2;
use sim_core::contact::SKIN;
use sim_core::math;
use sim_core::pose::{Pose, Twist};
use sim_core::scene::Segment;

/// A disc that is driven with a constant twist in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Walls that the disc may touch.
    pub walls: Vec<Segment>,
    /// Radius of the disc, m.
    pub radius: f64,
    /// Coefficient of friction between the rim and the walls.
    pub friction: f64,
    /// Centre and heading at the start.
    pub start: Pose,
    /// Twist of the disc while it touches no wall, in its own frame.
    pub twist: Twist,
}

/// Maximum number of sweeps in the search for the forces of one step.
const MAX_SWEEPS: usize = 400;

/// Maximum gap that is treated as a contact, m: larger than the gap that opens in a step around a corner, and too small
/// for a separate step.
const CONTACT_GAP: f64 = 1e-7;

impl Case {
    /// Position of the centre after `seconds`, in `steps` equal steps; a step in which the disc reaches a wall is
    /// divided at that instant.
    pub fn by_steps(&self, seconds: f64, steps: u64) -> DVec2 {
        let step = seconds / steps as f64;
        let mut centre = self.start.position;
        let mut velocity = self.free_velocity(0.0);
        for index in 0..steps {
            let (mut from, end) = (index as f64 * step, (index + 1) as f64 * step);
            // The disc reaches at most eight walls within one step.
            for _ in 0..8 {
                let remaining = end - from;
                velocity =
                    self.constrained_velocity(centre, self.free_velocity(from + 0.5 * remaining), velocity, remaining);
                let fraction = self.free_fraction(centre, velocity * remaining);
                centre += velocity * (fraction * remaining);
                from += fraction * remaining;
                if fraction == 1.0 {
                    break;
                }
            }
        }
        centre
    }

    /// Position of the centre after `seconds`, by Richardson extrapolation from `steps` steps and twice as many steps,
    /// and the distance of this position from that with twice as many steps.
    pub fn extrapolated(&self, seconds: f64, steps: u64) -> (DVec2, f64) {
        let (coarse, fine) = (self.by_steps(seconds, steps), self.by_steps(seconds, 2 * steps));
        // The method is of second order except at the instants at which contacts end.
        let limit = fine + (fine - coarse) / 3.0;
        (limit, (limit - fine).length())
    }

    /// Velocity of the centre after `seconds` without walls, in the world frame, m/s.
    pub fn free_velocity(&self, seconds: f64) -> DVec2 {
        let (sin, cos) = math::sin_cos(self.twist.omega * seconds);
        let heading = self.start.heading.direction().rotate(DVec2::new(cos, sin));
        heading.rotate(DVec2::new(self.twist.vx, self.twist.vy))
    }

    fn gap(&self, wall: &Segment, centre: DVec2) -> f64 {
        (centre - wall.nearest_point(centre)).length() - self.radius - SKIN
    }

    /// Fraction of the displacement, 0 to 1, after which the disc reaches the first of the walls that it does not touch
    /// yet.
    fn free_fraction(&self, centre: DVec2, displacement: DVec2) -> f64 {
        let mut fraction = 1.0;
        for wall in &self.walls {
            let gap = self.gap(wall, centre);
            if gap <= CONTACT_GAP
                || gap > displacement.length()
                || self.gap(wall, centre + displacement * fraction) >= 0.0
            {
                continue;
            }
            let (mut low, mut high) = (0.0, fraction);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if self.gap(wall, centre + displacement * middle) >= 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            fraction = low;
        }
        fraction
    }

    /// Velocity in a step that starts at `centre`: the velocity `free`, plus a slip over the floor in the direction of
    /// the contact forces. `previous` is the velocity in the previous step.
    fn constrained_velocity(&self, centre: DVec2, free: DVec2, previous: DVec2, step: f64) -> DVec2 {
        struct Contact {
            normal: DVec2,
            gap: f64,
            /// Speed of the rim due to the disc's rotation.
            rim_speed: f64,
            force: DVec2,
        }
        let halfway = centre + 0.5 * step * previous;
        let mut contacts: Vec<Contact> = Vec::new();
        for wall in &self.walls {
            let gap = self.gap(wall, centre);
            if gap <= CONTACT_GAP {
                let offset = halfway - wall.nearest_point(halfway);
                let normal = offset.normalize_or_zero();
                contacts.push(Contact {
                    normal,
                    gap,
                    rim_speed: self.twist.omega * offset.length(),
                    force: DVec2::ZERO,
                });
            }
        }
        let mut velocity = free;
        for _ in 0..MAX_SWEEPS {
            let mut change: f64 = 0.0;
            for contact in &mut contacts {
                let tangent = contact.normal.perp();
                let normal_force = (contact.force.x - contact.normal.dot(velocity) - contact.gap / step).max(0.0);
                velocity += (normal_force - contact.force.x) * contact.normal;
                let max_friction = self.friction * normal_force;
                let friction =
                    (contact.force.y - (tangent.dot(velocity) - contact.rim_speed)).clamp(-max_friction, max_friction);
                velocity += (friction - contact.force.y) * tangent;
                let force = DVec2::new(normal_force, friction);
                change = change.max((force - contact.force).length());
                contact.force = force;
            }
            if change <= 1e-15 {
                break;
            }
        }
        velocity
    }
}
