//! Published motion of an object: extrapolated from the start of a slot with floor friction, without contacts.

use super::{Properties, State, floor::Velocity};
use crate::{pose::Pose, scene::Bounds, time::Time};

/// Published trajectory of an object from an instant on: a straight line, with constant decelerations of translation
/// and rotation until each of them ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectTrajectory {
    /// Start of the trajectory.
    pub since: Time,
    /// State at the start.
    pub state: State,
    /// Deceleration of the centre of mass, m/s².
    deceleration: f64,
    /// Deceleration of the rotation, rad/s².
    angular_deceleration: f64,
}

impl ObjectTrajectory {
    /// Trajectory of an object that is in `state` at `since`.
    pub fn new(since: Time, state: State, properties: &Properties) -> Self {
        let velocity = Velocity { linear: state.velocity, omega: state.omega };
        let (deceleration, angular_deceleration) =
            velocity.decelerations(properties.resistance.deceleration(), properties.gyration_squared());
        Self { since, state, deceleration, angular_deceleration }
    }

    /// Pose of the object at `at`; before the start, the pose at the start.
    pub fn pose(&self, properties: &Properties, at: Time) -> Pose {
        if self.state.is_resting() || at <= self.since {
            return self.state.world_from_object;
        }
        let seconds = (at - self.since).seconds();
        let State { world_from_object, velocity, omega } = self.state;
        let speed = velocity.length();
        let equivalent_seconds = if speed > 0.0 { covered(speed, self.deceleration, seconds) / speed } else { 0.0 };
        let angle = omega.signum() * covered(omega.abs(), self.angular_deceleration, seconds);
        let centre = world_from_object.transform_point(properties.centre_of_mass) + velocity * equivalent_seconds;
        let heading = world_from_object.heading.turned(angle);
        let moved = Pose { position: centre, heading };
        Pose { position: moved.transform_point(-properties.centre_of_mass), heading }
    }

    /// A rectangle that contains the object from the start of the trajectory to `until`.
    pub fn bounds(&self, properties: &Properties, until: Time) -> Bounds {
        if self.state.is_resting() {
            return properties.bounds(&self.state.world_from_object);
        }
        let centre = |at: Time| self.pose(properties, at).transform_point(properties.centre_of_mass);
        Bounds::of_points([centre(self.since), centre(until)])
            .grown(properties.reach() + properties.centre_of_mass.length())
    }
}

/// Distance (or angle) that is covered in `seconds` with this initial speed and deceleration.
fn covered(speed: f64, deceleration: f64, seconds: f64) -> f64 {
    let seconds = if deceleration > 0.0 { seconds.min(speed / deceleration) } else { seconds };
    (speed - 0.5 * deceleration * seconds) * seconds
}
