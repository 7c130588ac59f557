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

/// A gap in m that is closed: above what a step around a corner opens, below what is worth a step of its own.
const CLOSED: f64 = 1e-7;

impl Case {
    /// Where the centre is after `seconds`, in `steps` steps, of which one is cut in two where a wall is met.
    pub fn by_steps(&self, seconds: f64, steps: u64) -> DVec2 {
        let step = seconds / steps as f64;
        let mut centre = self.start.position;
        let mut velocity = self.push(0.0);
        for index in 0..steps {
            let (mut from, end) = (index as f64 * step, (index + 1) as f64 * step);
            // More walls than these are not met at once.
            for _ in 0..8 {
                let left = end - from;
                velocity = self.settle(centre, self.push(from + 0.5 * left), velocity, left);
                let part = self.clear_part(centre, velocity * left);
                centre += velocity * (part * left);
                from += part * left;
                if part == 1.0 {
                    break;
                }
            }
        }
        centre
    }

    /// Where the centre is after `seconds`: Richardson's extrapolation of `steps` and twice as many steps, and how far that is from
    /// the latter.
    pub fn extrapolated(&self, seconds: f64, steps: u64) -> (DVec2, f64) {
        let (coarse, fine) = (self.by_steps(seconds, steps), self.by_steps(seconds, 2 * steps));
        // Of second order, but for the instants at which contacts end.
        let limit = fine + (fine - coarse) / 3.0;
        (limit, (limit - fine).length())
    }

    /// The push after `seconds`, m/s in the world.
    pub fn push(&self, seconds: f64) -> DVec2 {
        let (sin, cos) = math::sin_cos(self.twist.omega * seconds);
        let heading = self.start.heading.direction().rotate(DVec2::new(cos, sin));
        heading.rotate(DVec2::new(self.twist.vx, self.twist.vy))
    }

    fn gap(&self, wall: &Segment, centre: DVec2) -> f64 {
        (centre - wall.nearest_point(centre)).length() - self.radius - SKIN
    }

    /// The part of `way` that leads into none of the walls whose gap is open.
    fn clear_part(&self, centre: DVec2, way: DVec2) -> f64 {
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

    /// The velocity in a step from `centre` on: of slip over the floor in the direction of the forces at the contacts.
    fn settle(&self, centre: DVec2, push: DVec2, before: DVec2, step: f64) -> DVec2 {
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
