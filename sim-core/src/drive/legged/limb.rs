//! Thighs and shanks as capsules.

use glam::DVec3;

use super::{Legs, Stance};
use crate::{
    pose::{Pose, Pose3, link_pose},
    scene::Capsule,
};

/// [`Limb::ground_margin`] of a shank, as a multiple of the limb's radius. Our choice.
const GROUND_MARGIN_RADII: f64 = 3.0;

/// A part of a legged robot whose contacts are reported, with the index of the leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BodyPart {
    /// The body: an upright cylinder with the robot's diameter, above the height of the body's underside.
    Body,
    /// The thigh of a leg.
    Thigh(usize),
    /// The shank of a leg.
    Shank(usize),
}

/// A thigh or a shank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// The part.
    pub part: BodyPart,
    /// Capsule in the world from the upper to the lower end: from hip to knee, or from knee to ankle or tip.
    pub capsule: Capsule,
    /// Length of the lower end that is not tested against the ground, m, because the foot there is on the ground; 0 for
    /// a thigh.
    pub ground_margin: f64,
}

impl Legs {
    /// Indices of the parts among the [links](Self::links), leg by leg: the thigh, the shank and, if present, the foot.
    pub fn part_links(&self) -> Vec<usize> {
        let mut first = 0;
        let mut indices = Vec::new();
        for leg in &self.legs {
            indices.extend(leg.parts().map(|(_, index)| first + index));
            first += leg.link_count();
        }
        indices
    }

    /// Poses of the [parts](Self::part_links) of all legs in the robot's frame, which is `stance.lift` above the floor.
    pub fn parts(&self, stance: &Stance) -> Vec<Pose3> {
        let links = self.links(0, 0);
        self.part_links().into_iter().map(|link| link_pose(&links, &stance.joints, link)).collect()
    }

    /// Thighs and shanks, leg by leg, of a robot at `world_from_robot` with this stance.
    pub fn limbs(&self, stance: &Stance, world_from_robot: &Pose) -> Vec<Limb> {
        let links = self.links(0, 0);
        let world_from_body = Pose3::from_planar(world_from_robot, stance.lift);
        let mut first = 0;
        let mut limbs = Vec::with_capacity(2 * self.legs.len());
        for (number, leg) in self.legs.iter().enumerate() {
            let indices: Vec<usize> = leg.parts().map(|(_, index)| first + index).collect();
            let part_frame = |part: usize| world_from_body.then(&link_pose(&links, &stance.joints, indices[part]));
            let (thigh, shank) = (part_frame(0), part_frame(1));
            let capsule = |upper, lower| Capsule { ends: [upper, lower], radius: self.radius };
            let lower = shank.transform_point(DVec3::new(0.0, 0.0, -leg.shank));
            limbs.push(Limb {
                part: BodyPart::Thigh(number),
                capsule: capsule(thigh.position, shank.position),
                ground_margin: 0.0,
            });
            let ground_margin = GROUND_MARGIN_RADII * self.radius;
            limbs.push(Limb { part: BodyPart::Shank(number), capsule: capsule(shank.position, lower), ground_margin });
            first += leg.link_count();
        }
        limbs
    }
}
