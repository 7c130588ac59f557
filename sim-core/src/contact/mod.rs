//! Contacts of a moving disc: time of impact with static walls and with other discs, and sliding along walls.
//!
//! A body is in contact when the gap to its neighbour is no larger than the skin of 1 um. In contact the body can still
//! move in every direction in which it does not approach a contact point. This module computes paths and contacts;
//! `drive` decides how a robot moves at a contact.

mod pair;
mod path;
mod slide;
mod wall;

use glam::DVec2;

pub use pair::{MovingDisc, first_touch};
pub use path::{LengthLaw, Pace, Path};
pub use slide::{Push, Slide};
pub use wall::{WallContact, first_contact};

use crate::{ObjectId, RobotId, scene::WallId};

/// Maximum gap in metres at which two bodies are in contact. Our choice.
pub const SKIN: f64 = 1e-6;

/// Maximum gap in metres at which a body is regarded as in contact at the start of a motion: the skin, plus 1 nm for
/// the rounding of poses.
pub const TOUCH: f64 = SKIN + 1e-9;

/// Speed along the normal in m/s above which a body is regarded as approaching another one. It is far above rounding
/// errors, and moves a body by less than 0.1 mm per day.
pub const APPROACH: f64 = 1e-9;

/// Anything that a body, a leg or a ray can touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Thing {
    /// A static wall. A thick wall consists of its four sides; a ray that hits its upper face reports one of the sides.
    Wall(WallId),
    /// The floor; for legs the ground. Only rays and legs can touch it.
    Floor,
    /// A fixed body, given by its index in [`Space::fixed`](crate::world::Space::fixed). Only rays and legs can touch a
    /// fixed body; for motion in the plane, walls along its outline replace it.
    Fixed(u32),
    /// The body of a robot.
    Robot(RobotId),
    /// A movable object.
    Object(ObjectId),
}

/// An obstacle in contact with a body, and the touched point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// The touched obstacle.
    pub thing: Thing,
    /// The touched point in the world frame, m.
    pub point: DVec2,
}

/// The body of a robot at an instant: a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// The robot.
    pub robot: RobotId,
    /// Centre in the world, m.
    pub centre: DVec2,
    /// Radius, m.
    pub radius: f64,
}
