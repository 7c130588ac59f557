//! Contacts of a moving disc: time of impact with static walls and with other discs, and sliding along walls.
//!
//! A body is in contact when the gap to its neighbour is no larger than the skin of 1 um. In contact the body may still
//! move in every way that does not approach a contact point. This room computes paths and shapes; `drive` decides what
//! a robot does at a contact.

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

/// Maximum gap in metres at which two bodies are in contact. Source: design section 4.
pub const SKIN: f64 = 1e-6;

/// Maximum gap in metres at which a body that starts to move counts as in contact: the skin, plus 1 nm for the rounding
/// of poses.
pub const TOUCH: f64 = SKIN + 1e-9;

/// Speed along the normal in m/s above which a body counts as approaching another one. The speed is far above rounding,
/// and moves a body by less than 0.1 mm a day.
pub const APPROACH: f64 = 1e-9;

/// Anything that a body, a leg or a ray can meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Thing {
    /// A static wall. A thick wall consists of its four sides; a ray that hits its upper face reports one of the sides.
    Wall(WallId),
    /// The floor, or for legs the ground. Only rays and legs can meet it.
    Floor,
    /// A body that never moves, by its index in [`Space::fixed`](crate::world::Space::fixed). Only rays and legs can
    /// meet it; in the plane its outline consists of walls.
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
