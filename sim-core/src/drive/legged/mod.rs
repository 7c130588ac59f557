//! Legs: bodies that walk.
//!
//! Kinematic, without forces. A legged robot's planar motion is that of any robot, a chain of pieces from its commands; its
//! feet, its joints and the height of its body are functions of that motion and of virtual time, so they too are exact for
//! every slot length. See docs/legged.md.

mod curve;
mod gait;
mod glide;
mod leg;
mod limb;
mod walk;

use glam::{DVec2, DVec3};

use crate::{math, pose::Link, time::Time};
use curve::Natural;
pub use curve::natural_angles;
pub use gait::Gait;
pub use leg::{Foot, Joints, Leg, Sole};
pub use limb::{Limb, Touching};
pub(in crate::drive) use walk::{Course, Plan, Walk};

/// How fast a natural gait goes at most, as a multiple of the source's speed. Our choice.
const FASTEST: f64 = 1.2;

/// The legs of a robot and the gaits that they know.
#[derive(Clone, Debug, PartialEq)]
pub struct Legs {
    /// Its legs.
    pub legs: Vec<Leg>,
    /// Its gaits, the first is the one that it starts with; at least one.
    pub gaits: Vec<Gait>,
    /// How high a foot is lifted over the higher of the places that it steps from and to, m, until something else is commanded.
    pub step_height: f64,
    /// Radius of thighs and shanks, m.
    pub radius: f64,
    /// Height of the underside of the body in the robot's frame, m.
    pub belly: f64,
}

/// What a robot's program tells its legs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LegCommand {
    /// Walk in this gait, counted from 0: feet in the air come down as planned.
    Gait(usize),
    /// How high a foot is lifted over the higher of the places that it steps from and to, m.
    StepHeight(f64),
    /// Shifts where a foot comes down, from the next instant of decision on and until it is told otherwise.
    Correct {
        /// Which leg, counted from 0.
        leg: usize,
        /// Shift of the place in the robot's frame (x forward, y left), m.
        shift: DVec2,
        /// Additional height of the foot in the air, m.
        lift: f64,
    },
}

/// Why legs refused a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LegCommandError {
    /// The robot has none.
    #[error("the robot has no legs")]
    NoLegs,
    /// There is no gait of this number.
    #[error("the robot has no such gait, accepted: less than {gaits}")]
    NoGait {
        /// Number of its gaits.
        gaits: usize,
    },
    /// There is no leg of this number.
    #[error("the robot has no such leg, accepted: less than {legs}")]
    NoLeg {
        /// Number of its legs.
        legs: usize,
    },
    /// A height or a shift that no leg can do.
    #[error("a length is not one that a leg can do, accepted: finite values within its reach, heights of 0 or more")]
    Length,
}

/// How a legged robot holds itself at an instant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stance {
    /// Height of the robot's frame above the plane z = 0, m: 0 for one that stands on the floor.
    pub lift: f64,
    /// Angles of all joints, leg by leg, rad: see [`Leg`].
    pub joints: Vec<f64>,
    /// Its feet.
    pub feet: Vec<FootState>,
}

/// Where a foot is at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootState {
    /// The point of its sole that is nearest to where it stands or will: in the world, m.
    pub point: DVec3,
    /// Which place of the sole that is.
    pub sole: Sole,
    /// Where its toes point, rad counter-clockwise from the world's x axis.
    pub heading: f64,
    /// Whether it is on the ground.
    pub is_down: bool,
}

/// A foot that has come down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footfall {
    /// When.
    pub time: Time,
    /// Which leg, counted from 0.
    pub leg: usize,
    /// Where it stands: the tip of the leg, or the point of the sole under the ankle; in the world, m.
    pub point: DVec3,
}

impl Legs {
    /// Number of joints of all legs.
    pub fn joint_count(&self) -> usize {
        self.legs.iter().map(Leg::joint_count).sum()
    }

    /// The links of all legs, where `first_link` links and `first_joint` angles stand before theirs.
    pub fn links(&self, mut first_link: usize, mut first_joint: usize) -> Vec<Link> {
        let mut links = Vec::new();
        for leg in &self.legs {
            links.extend(leg.links(first_link, first_joint));
            first_link += leg.link_count();
            first_joint += leg.joint_count();
        }
        links
    }

    /// Angles of all joints of a robot that stands, leg by leg, rad.
    pub fn standing_joints(&self) -> Vec<f64> {
        let of_leg = |leg: &Leg| {
            let joints = leg.joints(DVec3::new(0.0, 0.0, -leg.hip.z), 0.0, Sole::default());
            joints.to_array().into_iter().take(leg.joint_count())
        };
        self.legs.iter().flat_map(of_leg).collect()
    }

    /// How far a foot may be from its place under the hip while it stands, m: the leg reaches that with the hip lowered by a
    /// sixth. Our choice.
    pub fn excursion(&self) -> f64 {
        let of_leg = |leg: &Leg| {
            let ankle = leg.foot.map_or(0.0, |foot| foot.height);
            let depth = leg::LOWEST_HIP * leg.hip.z - ankle;
            (leg.reach() * leg.reach() - depth * depth).max(0.0).sqrt()
        };
        self.legs.iter().filter(|leg| leg.wheel.is_none()).map(of_leg).fold(f64::INFINITY, f64::min)
    }

    /// The speed at which a natural gait is that of its source, m/s; `None` for another gait or legs without feet.
    pub fn natural_speed(&self, gait: &Gait) -> Option<f64> {
        let natural = Natural::new(self.legs.first()?).filter(|_| gait.is_natural)?;
        Some(natural.stride / gait.period.seconds())
    }

    /// The greatest speed at which no foot is left behind in a gait, m/s: a foot goes from one end of four fifths of its
    /// excursion to the other while it stands; a natural gait goes by a fifth faster than its source. Our choice.
    pub fn greatest_speed(&self, gait: &Gait) -> f64 {
        if let Some(speed) = self.natural_speed(gait) {
            return FASTEST * speed;
        }
        2.0 * 0.8 * self.excursion() / (gait.duty * gait.period.seconds())
    }

    /// The greatest turning speed at which no foot is left behind in a gait, rad/s.
    pub fn greatest_turn(&self, gait: &Gait) -> f64 {
        let radius = self.legs.iter().map(|leg| math::hypot(leg.hip.x, leg.hip.y)).fold(0.0, f64::max);
        // A foot does not turn by more than 45 degrees to either side either.
        let by_angle = std::f64::consts::FRAC_PI_2 / (gait.duty * gait.period.seconds());
        by_angle.min(self.greatest_speed(gait) / radius)
    }
}
