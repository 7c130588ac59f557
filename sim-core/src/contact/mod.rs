//! When a moving disc meets something: time of impact with static walls and with other discs; and how it slides along walls.
//!
//! A body keeps a skin of 1 um: it is in contact when the gap to its neighbour is no more, and then it may move in any
//! way that approaches no contact point. The room knows paths and shapes, not what a robot does about a contact.

mod pair;
mod path;
mod slide;
mod wall;

use glam::DVec2;

pub use pair::{Rolling, first_touch};
pub use path::{Law, Pace, Path};
pub use slide::{Push, Slide};
pub use wall::{WallContact, first_contact};

use crate::{ObjectId, RobotId, scene::WallId};

/// Gap in metres that is contact. Source: design section 4.
pub const SKIN: f64 = 1e-6;

/// Gap in metres below which a body that sets off counts as in contact: the skin, and 1 nm for the rounding of poses.
pub const TOUCH: f64 = SKIN + 1e-9;

/// Speed along the normal in m/s above which a body approaches another one: far above rounding, and a creep of less than
/// 0.1 mm a day.
pub const APPROACH: f64 = 1e-9;

/// What a body, a leg or a ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Thing {
    /// A static wall; for rays of a thick one, one of its sides, also for its upper face.
    Wall(WallId),
    /// The floor, or for legs the ground: met by rays and legs alone.
    Floor,
    /// A body that never moves, by its place in [`Space::fixed`](crate::world::Space::fixed): met by rays and legs alone; in the plane
    /// its outlines are walls.
    Fixed(u32),
    /// The body of a robot.
    Robot(RobotId),
    /// A movable object.
    Object(ObjectId),
}

/// A thing in contact with a body, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// What is touched.
    pub thing: Thing,
    /// The touched point, in the world.
    pub point: DVec2,
}

/// The body of a robot at an instant: a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Whose body.
    pub robot: RobotId,
    /// Centre in the world, m.
    pub centre: DVec2,
    /// Radius, m.
    pub radius: f64,
}
