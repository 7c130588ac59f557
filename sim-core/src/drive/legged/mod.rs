//! Legged locomotion.
//!
//! The model is kinematic, without forces. A legged robot moves in the plane like any robot, on a chain of pieces of
//! motion that follow its commands. Its feet, joints and body height are functions of this motion and of virtual time,
//! so they do not depend on the slot length either. See docs/legged.md.

mod curve;
mod gait;
mod leg;
mod limb;
mod smooth;
mod walk;

use glam::{DVec2, DVec3};

use crate::{math, pose::Link, time::Time};
use curve::NaturalGait;
pub use curve::natural_angles;
pub use gait::Gait;
pub use leg::{Foot, Joints, Leg, Sole};
pub use limb::{BodyPart, Limb};
pub(in crate::drive) use walk::{MotionPiece, Plan, Walk};

/// Maximum speed of a natural gait, as a multiple of its [natural speed](Legs::natural_speed). Our choice.
const MAX_NATURAL_SPEED: f64 = 1.2;

/// The legs of a robot and their gaits.
#[derive(Clone, Debug, PartialEq)]
pub struct Legs {
    /// The legs.
    pub legs: Vec<Leg>,
    /// The gaits, at least one; the robot starts with the first.
    pub gaits: Vec<Gait>,
    /// Default step height: height to which a foot is lifted above the higher of its two footholds, m.
    pub step_height: f64,
    /// Radius of thighs and shanks, m.
    pub radius: f64,
    /// Height of the underside of the body in the robot's frame, m.
    pub underside: f64,
}

/// A command of a robot's program to its legs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LegCommand {
    /// Walk in the gait with this index. Feet in the air land at their planned instants.
    Gait(usize),
    /// Set the height to which a foot is lifted above the higher of its two footholds, m.
    StepHeight(f64),
    /// Shift the footholds of a leg, from the next decision instant until the next command of this kind for the leg.
    ShiftFoothold {
        /// Index of the leg.
        leg: usize,
        /// Shift of the foothold in the robot's frame (x forward, y left), m.
        shift: DVec2,
        /// Additional height of the foot in the air, m.
        lift: f64,
    },
}

/// Reason why a leg command was rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LegCommandError {
    /// The robot has no legs.
    #[error("the robot has no legs")]
    NoLegs,
    /// No gait has this number.
    #[error("the robot has no such gait, accepted: less than {gaits}")]
    NoGait {
        /// Number of its gaits.
        gaits: usize,
    },
    /// No leg has this number.
    #[error("the robot has no such leg, accepted: less than {legs}")]
    NoLeg {
        /// Number of its legs.
        legs: usize,
    },
    /// A height or shift exceeds a leg's reach or is not finite, or a height is negative.
    #[error("a length is not one that a leg can do, accepted: finite values within its reach, heights of 0 or more")]
    Length,
}

/// Posture of a legged robot at an instant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stance {
    /// Height of the robot's frame above the plane z = 0, m: 0 for a robot standing on the floor.
    pub lift: f64,
    /// Angles of all joints, leg by leg, rad: see [`Leg`].
    pub joints: Vec<f64>,
    /// State of each foot, leg by leg.
    pub feet: Vec<FootState>,
}

/// State of a foot at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootState {
    /// Contact point of the sole in the world, m: at the foothold while the foot stands, and on the swing path of the
    /// gait while it swings. If a swinging leg does not reach that path, its joint angles place the foot above the
    /// path.
    pub point: DVec3,
    /// Position of the contact point on the sole, and pitch of the foot.
    pub sole: Sole,
    /// Direction of the toes, rad counter-clockwise from the world's x axis.
    pub heading: f64,
    /// True if the foot is on the ground.
    pub is_down: bool,
}

/// Touch-down of a foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footfall {
    /// Instant of touch-down.
    pub time: Time,
    /// Index of the leg.
    pub leg: usize,
    /// The foothold: the tip of the leg, or the point of the sole under the ankle; in the world, m.
    pub point: DVec3,
}

impl Legs {
    /// Number of joints of all legs.
    pub fn joint_count(&self) -> usize {
        self.legs.iter().map(Leg::joint_count).sum()
    }

    /// The links of all legs. The first link gets the index `first_link`, the first joint the index `first_joint`.
    pub fn links(&self, mut first_link: usize, mut first_joint: usize) -> Vec<Link> {
        let mut links = Vec::new();
        for leg in &self.legs {
            links.extend(leg.links(first_link, first_joint));
            first_link += leg.link_count();
            first_joint += leg.joint_count();
        }
        links
    }

    /// Joint angles of a standing robot, leg by leg, rad.
    pub fn standing_joints(&self) -> Vec<f64> {
        let of_leg = |leg: &Leg| {
            let joints = leg.joints(DVec3::new(0.0, 0.0, -leg.hip.z), 0.0, Sole::default());
            joints.to_array().into_iter().take(leg.joint_count())
        };
        self.legs.iter().flat_map(of_leg).collect()
    }

    /// Maximum distance of a standing foot from its neutral position under the hip, m: the distance that the leg
    /// reaches if the hip is lowered by a sixth. Our choice.
    pub fn excursion(&self) -> f64 {
        let of_leg = |leg: &Leg| {
            let ankle = leg.foot.map_or(0.0, |foot| foot.height);
            let depth = leg::MIN_HIP_HEIGHT * leg.hip.z - ankle;
            (leg.reach() * leg.reach() - depth * depth).max(0.0).sqrt()
        };
        self.legs.iter().filter(|leg| leg.wheel.is_none()).map(of_leg).fold(f64::INFINITY, f64::min)
    }

    /// Speed of a natural gait with unscaled joint angles, m/s: one stride per period. `None` for another gait or legs
    /// without feet.
    pub fn natural_speed(&self, gait: &Gait) -> Option<f64> {
        let natural = NaturalGait::new(self.legs.first()?).filter(|_| gait.is_natural)?;
        Some(natural.stride / gait.period.seconds())
    }

    /// Maximum speed of a gait, m/s: at this speed a standing foot uses four fifths of its excursion to either side. A
    /// natural gait is limited to 1.2 times its natural speed. Our choice.
    pub fn max_speed(&self, gait: &Gait) -> f64 {
        if let Some(speed) = self.natural_speed(gait) {
            return MAX_NATURAL_SPEED * speed;
        }
        2.0 * 0.8 * self.excursion() / (gait.duty * gait.period.seconds())
    }

    /// Maximum turning speed of a gait, rad/s, at which no standing foot gets out of reach or turns too far. Our
    /// choice.
    pub fn max_turn_rate(&self, gait: &Gait) -> f64 {
        let radius = self.legs.iter().map(|leg| math::hypot(leg.hip.x, leg.hip.y)).fold(0.0, f64::max);
        // A foot turns by at most 45 degrees to either side.
        let by_angle = std::f64::consts::FRAC_PI_2 / (gait.duty * gait.period.seconds());
        by_angle.min(self.max_speed(gait) / radius)
    }
}
