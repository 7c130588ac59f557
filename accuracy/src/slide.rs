//! A disc that is pushed along walls, by an integrator in small steps: what the core's closed forms are compared with.
//!
//! It knows nothing of the core's events. In each step it looks for the contact forces that keep the disc out of the walls and within
//! their friction cones, by sweeps over the contacts (projected Gauss-Seidel); its error falls with the step.

use glam::DVec2;
use sim_core::contact::SKIN;
use sim_core::math;
use sim_core::pose::{Pose, Twist};
use sim_core::scene::Segment;

/// A disc under a constant push in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// What it may touch.
    pub walls: Vec<Segment>,
    /// Its radius, m.
    pub radius: f64,
    /// Coefficient of friction at its rim.
    pub friction: f64,
    /// Centre and direction at the start.
    pub start: Pose,
    /// The twist of the centre without walls.
    pub twist: Twist,
}

/// Rounds of the search for the forces of one step at most.
const ROUNDS: usize = 400;

impl Case {
    /// Where the centre is after `seconds`, in `steps` steps.
    pub fn by_steps(&self, seconds: f64, steps: u64) -> DVec2 {
        let step = seconds / steps as f64;
        let mut centre = self.start.position;
        let mut velocity = self.push(0.0);
        for index in 0..steps {
            let push = self.push((index as f64 + 0.5) * step);
            velocity = self.settle(centre, push, velocity, step);
            centre += velocity * step;
        }
        centre
    }

    /// Where the centre is after `seconds`: Richardson's extrapolation of `steps` and twice as many steps, and how far that is from
    /// the latter.
    pub fn extrapolated(&self, seconds: f64, steps: u64) -> (DVec2, f64) {
        let (coarse, fine) = (self.by_steps(seconds, steps), self.by_steps(seconds, 2 * steps));
        // The scheme is of first order.
        let limit = fine + (fine - coarse);
        (limit, (limit - fine).length())
    }

    fn push(&self, seconds: f64) -> DVec2 {
        let (sin, cos) = math::sin_cos(self.twist.omega * seconds);
        let heading = self.start.heading.direction().rotate(DVec2::new(cos, sin));
        heading.rotate(DVec2::new(self.twist.vx, self.twist.vy))
    }

    /// The velocity in a step from `centre` on: of slip over the floor in the direction of the forces at the contacts.
    fn settle(&self, centre: DVec2, push: DVec2, before: DVec2, step: f64) -> DVec2 {
        struct Contact {
            normal: DVec2,
            gap: f64,
            roll: f64,
            force: DVec2,
        }
        let near = 2.0 * push.length() * step;
        let halfway = centre + 0.5 * step * before;
        let mut contacts: Vec<Contact> = Vec::new();
        for wall in &self.walls {
            let gap = (centre - wall.nearest_point(centre)).length() - self.radius - SKIN;
            if gap < near {
                let offset = halfway - wall.nearest_point(halfway);
                let normal = offset.normalize_or_zero();
                contacts.push(Contact { normal, gap, roll: self.twist.omega * offset.length(), force: DVec2::ZERO });
            }
        }
        let mut velocity = push;
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
