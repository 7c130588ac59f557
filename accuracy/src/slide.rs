//! Reference for the sliding of a disc along walls: an integrator in small steps, with which the core's closed forms
//! are compared.
//!
//! The integrator does not use the events of the core. In each step, sweeps over the contacts (projected Gauss-Seidel)
//! find contact forces that keep the disc out of the walls and lie within their friction cones. The error falls with
//! the length of the step.

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
const ROUNDS: usize = 400;

/// Gap that counts as closed, m: larger than the gap that opens in a step around a corner, too small for a separate
/// step.
const CLOSED: f64 = 1e-7;

impl Case {
    /// Position of the centre after `seconds`, in `steps` equal steps; a step in which the disc reaches a wall is
    /// divided there.
    pub fn by_steps(&self, seconds: f64, steps: u64) -> DVec2 {
        let step = seconds / steps as f64;
        let mut centre = self.start.position;
        let mut velocity = self.free_velocity(0.0);
        for index in 0..steps {
            let (mut from, end) = (index as f64 * step, (index + 1) as f64 * step);
            // The disc reaches no more than eight walls within one step.
            for _ in 0..8 {
                let left = end - from;
                velocity = self.constrained_velocity(centre, self.free_velocity(from + 0.5 * left), velocity, left);
                let part = self.free_share(centre, velocity * left);
                centre += velocity * (part * left);
                from += part * left;
                if part == 1.0 {
                    break;
                }
            }
        }
        centre
    }

    /// Position of the centre after `seconds`, by Richardson extrapolation from `steps` steps and twice as many steps,
    /// and its distance from the position with twice as many steps.
    pub fn extrapolated(&self, seconds: f64, steps: u64) -> (DVec2, f64) {
        let (coarse, fine) = (self.by_steps(seconds, steps), self.by_steps(seconds, 2 * steps));
        // The method is of second order except at the instants at which contacts end.
        let limit = fine + (fine - coarse) / 3.0;
        (limit, (limit - fine).length())
    }

    /// Velocity of the centre after `seconds` if no wall hinders the disc, world frame, m/s.
    pub fn free_velocity(&self, seconds: f64) -> DVec2 {
        let (sin, cos) = math::sin_cos(self.twist.omega * seconds);
        let heading = self.start.heading.direction().rotate(DVec2::new(cos, sin));
        heading.rotate(DVec2::new(self.twist.vx, self.twist.vy))
    }

    fn gap(&self, wall: &Segment, centre: DVec2) -> f64 {
        (centre - wall.nearest_point(centre)).length() - self.radius - SKIN
    }

    /// Share of the displacement `way`, 0 to 1, after which the disc reaches the first of the walls whose gap is open.
    fn free_share(&self, centre: DVec2, way: DVec2) -> f64 {
        let mut part = 1.0;
        for wall in &self.walls {
            let gap = self.gap(wall, centre);
            if gap <= CLOSED || gap > way.length() || self.gap(wall, centre + way * part) >= 0.0 {
                continue;
            }
            let (mut low, mut high) = (0.0, part);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if self.gap(wall, centre + way * middle) >= 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            part = low;
        }
        part
    }

    /// Velocity in a step from `centre` on: `free_velocity`, plus a slip over the floor in the direction of the forces at the
    /// contacts.
    fn constrained_velocity(&self, centre: DVec2, free: DVec2, before: DVec2, step: f64) -> DVec2 {
        struct Contact {
            normal: DVec2,
            gap: f64,
            roll: f64,
            force: DVec2,
        }
        let halfway = centre + 0.5 * step * before;
        let mut contacts: Vec<Contact> = Vec::new();
        for wall in &self.walls {
            let gap = self.gap(wall, centre);
            if gap <= CLOSED {
                let offset = halfway - wall.nearest_point(halfway);
                let normal = offset.normalize_or_zero();
                contacts.push(Contact { normal, gap, roll: self.twist.omega * offset.length(), force: DVec2::ZERO });
            }
        }
        let mut velocity = free;
        for _ in 0..ROUNDS {
            let mut change: f64 = 0.0;
            for contact in &mut contacts {
                let tangent = contact.normal.perp();
                let normal_force = (contact.force.x - contact.normal.dot(velocity) - contact.gap / step).max(0.0);
                velocity += (normal_force - contact.force.x) * contact.normal;
                let most = self.friction * normal_force;
                let friction = (contact.force.y - (tangent.dot(velocity) - contact.roll)).clamp(-most, most);
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
