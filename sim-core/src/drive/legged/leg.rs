//! One leg: its parts, forward kinematics as links, and inverse kinematics in closed form.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use crate::{
    math,
    pose::{Link, Pose3},
};

/// Maximum extension of a leg, as a fraction of thigh plus shank. The knee stays bent by at least 7.2 degrees, because
/// near a straight knee a millimetre of height may need an arbitrarily large change of the knee's angle. Our choice.
const MAX_EXTENSION: f64 = 0.998;

/// Minimum height of the hip while walking, as a fraction of its height while standing. Our choice.
pub(super) const MIN_HIP_HEIGHT: f64 = 5.0 / 6.0;

/// Maximum flexion of a knee, rad: 150 degrees. Our choice.
const MAX_KNEE: f64 = 150.0 / 180.0 * PI;

/// One leg: a thigh that hangs from the hip, a shank that hangs from the knee, and optionally a foot.
///
/// The hip has the joints `yaw` about z, `roll` about x (both right-handed) and `pitch` of the thigh (positive
/// forwards). Then follow `knee` (flexion positive) and, if the leg has a foot, `ankle` (toes up positive). At angles
/// of 0 the leg hangs straight down and the foot is level. A leg without a foot stands on the tip of its shank.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    /// Name of the leg, such as `LEFT`: its links are then `LEFT.thigh`, `LEFT.shank` and `LEFT.foot`.
    pub name: String,
    /// Position of the hip in the robot's frame, m; while the robot stands on the floor, z is the height of the hip
    /// above the floor.
    pub hip: DVec3,
    /// Length from hip to knee, m.
    pub thigh: f64,
    /// Length from knee to ankle, or to the tip of the leg, m.
    pub shank: f64,
    /// The foot; `None` for a leg that ends in a tip or a wheel.
    pub foot: Option<Foot>,
    /// Radius of the wheel on which the leg rolls instead of stepping, m.
    pub wheel: Option<f64>,
}

/// A flat foot from heel to toe, without width.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Foot {
    /// Distance from the ankle back to the heel, m.
    pub heel: f64,
    /// Distance from the ankle forwards to the toe on which the foot rolls off, m.
    pub toe: f64,
    /// Height of the ankle above the sole, m.
    pub height: f64,
}

/// Angles of the joints of a leg, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Joints {
    /// Rotation of the hip about z.
    pub yaw: f64,
    /// Rotation of the hip about x: positive swings the leg to the left.
    pub roll: f64,
    /// Rotation of the thigh: positive swings it forwards.
    pub pitch: f64,
    /// Flexion of the knee.
    pub knee: f64,
    /// Dorsiflexion of the ankle (toes up); 0 without a foot.
    pub ankle: f64,
}

/// Contact of a sole: the position of the contact point on the sole, and the pitch of the foot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sole {
    /// Position of the contact point on the sole, m in front of the ankle.
    pub from_ankle: f64,
    /// Pitch of the foot in the plane of the leg, toes up, rad.
    pub pitch: f64,
}

/// Names of the parts of a leg that can carry sensors, in the order of their links.
const PARTS: [&str; 3] = ["thigh", "shank", "foot"];
/// Number of hip links before the thigh: yaw and roll.
const HIP_LINKS: usize = 2;

impl Leg {
    /// Number of joints: 4, or 5 with a foot.
    pub fn joint_count(&self) -> usize {
        if self.foot.is_some() { 5 } else { 4 }
    }

    /// Number of links, one per joint.
    pub fn link_count(&self) -> usize {
        self.joint_count()
    }

    /// Names of the parts that can carry sensors, `thigh`, `shank` and, with a foot, `foot`, with their indices among
    /// the leg's links.
    pub fn parts(&self) -> impl Iterator<Item = (&'static str, usize)> {
        PARTS.into_iter().zip(HIP_LINKS..self.link_count())
    }

    /// The links, one per joint. The first link gets the index `first_link`, the first joint the index `first_joint`.
    /// The frames of thigh, shank and foot have their origins in hip, knee and ankle, and axes parallel to those of the
    /// robot (x forward, y left, z up) at joint angles of 0.
    pub fn links(&self, first_link: usize, first_joint: usize) -> Vec<Link> {
        let translation = |position| Pose3 { position, ..Pose3::IDENTITY };
        let down = |length: f64| translation(DVec3::new(0.0, 0.0, -length));
        let joints = [
            (translation(self.hip), DVec3::Z),
            (Pose3::IDENTITY, DVec3::X),
            (Pose3::IDENTITY, DVec3::NEG_Y),
            (down(self.thigh), DVec3::Y),
            (down(self.shank), DVec3::NEG_Y),
        ];
        let link = |(index, (origin, axis)): (usize, (Pose3, DVec3))| Link {
            parent: index.checked_sub(1).map(|previous| first_link + previous),
            origin,
            axis,
            joint: Some(first_joint + index),
        };
        joints.into_iter().enumerate().take(self.link_count()).map(link).collect()
    }

    /// Minimum and maximum height of the hip at which the leg can stand with its foot below the hip, m.
    pub fn standing_heights(&self) -> (f64, f64) {
        let height = self.contact_to_ankle(Sole::default()).y;
        (height + self.min_reach(), height + self.reach())
    }

    /// The maximum distance from hip to ankle, m.
    pub fn reach(&self) -> f64 {
        MAX_EXTENSION * (self.thigh + self.shank)
    }

    /// The minimum distance from hip to ankle, m.
    fn min_reach(&self) -> f64 {
        let (thigh, shank) = (self.thigh, self.shank);
        (thigh * thigh + shank * shank + 2.0 * thigh * shank * math::cos(MAX_KNEE)).max(0.0).sqrt()
    }

    /// Vector from the contact point of the sole to the ankle; components forwards and up in the plane of the leg, m.
    fn contact_to_ankle(&self, sole: Sole) -> DVec2 {
        let height = self.foot.map(|foot| foot.height).or(self.wheel).unwrap_or(0.0);
        let (sin, cos) = math::sin_cos(sole.pitch);
        DVec2::new(-sole.from_ankle * cos - height * sin, -sole.from_ankle * sin + height * cos)
    }

    /// Maximum height of the hip above a contact point, m, at which the leg reaches the point. `offset` is the
    /// horizontal vector from the hip to the point; its components are ahead and to the left, as seen from the foot.
    /// `None` if the point is out of reach at any height.
    pub fn max_hip_height(&self, offset: DVec2, sole: Sole) -> Option<f64> {
        let to_ankle = self.contact_to_ankle(sole);
        let root = |square: f64| (square >= 0.0).then(|| square.sqrt());
        let forwards = offset.x + to_ankle.x;
        let depth = to_ankle.y + root(self.reach() * self.reach() - forwards * forwards)?;
        root(depth * depth - offset.y * offset.y).filter(|_| depth > 0.0)
    }

    /// Joint angles that place the contact point of the sole at a given point, with the foot at `yaw` relative to the
    /// robot. `hip_to_point` is the vector from the hip to that point in the robot's axes, m. If the point is out of
    /// reach, the angles are those for the nearest reachable point.
    ///
    /// The solution has a closed form. Yaw is given, and roll turns the plane of the leg until it contains the point.
    /// In that plane, thigh and shank are two links that reach the ankle.
    pub fn joints(&self, hip_to_point: DVec3, yaw: f64, sole: Sole) -> Joints {
        let (sin, cos) = math::sin_cos(yaw);
        let forwards = cos * hip_to_point.x + sin * hip_to_point.y;
        let left = cos * hip_to_point.y - sin * hip_to_point.x;
        let roll = math::atan2(left, -hip_to_point.z);
        let depth = math::hypot(left, hip_to_point.z);
        let ankle = DVec2::new(forwards, -depth) + self.contact_to_ankle(sole);
        let distance = math::hypot(ankle.x, ankle.y).clamp(self.min_reach(), self.reach());
        let (thigh, shank) = (self.thigh, self.shank);
        let cos_knee = ((distance * distance - thigh * thigh - shank * shank) / (2.0 * thigh * shank)).clamp(-1.0, 1.0);
        let sin_knee = (1.0 - cos_knee * cos_knee).max(0.0).sqrt();
        let knee = math::atan2(sin_knee, cos_knee);
        let pitch = math::atan2(ankle.x, -ankle.y) + math::atan2(shank * sin_knee, thigh + shank * cos_knee);
        let ankle = if self.foot.is_some() { sole.pitch - pitch + knee } else { 0.0 };
        Joints { yaw, roll, pitch, knee, ankle }
    }
}

impl Joints {
    /// The angles in the order of the joints.
    pub fn to_array(self) -> [f64; 5] {
        [self.yaw, self.roll, self.pitch, self.knee, self.ankle]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::link_pose;

    fn leg(foot: Option<Foot>) -> Leg {
        Leg { name: "LEFT".to_owned(), hip: DVec3::new(0.1, 0.2, 0.8), thigh: 0.4, shank: 0.5, foot, wheel: None }
    }

    const FOOT: Foot = Foot { heel: 0.05, toe: 0.15, height: 0.08 };

    /// Position in the robot's frame of the point on the sole that is `from_ankle` m in front of the ankle.
    fn sole_position(leg: &Leg, joints: Joints, from_ankle: f64) -> DVec3 {
        let links = leg.links(0, 0);
        let (index, point) = match leg.foot {
            Some(foot) => (4, DVec3::new(from_ankle, 0.0, -foot.height)),
            None => (3, DVec3::new(0.0, 0.0, -leg.shank)),
        };
        link_pose(&links, &joints.to_array(), index).transform_point(point)
    }

    #[test]
    fn links_match_trigonometry() {
        let leg = leg(None);
        // The thigh points horizontally forwards and the knee is at a right angle: the tip is below the knee.
        let joints = Joints { pitch: PI / 2.0, knee: PI / 2.0, ..Joints::default() };
        assert!((sole_position(&leg, joints, 0.0) - DVec3::new(0.5, 0.2, 0.3)).length() < 1e-15);
        // A straight leg that points horizontally to the left.
        let joints = Joints { roll: PI / 2.0, ..Joints::default() };
        assert!((sole_position(&leg, joints, 0.0) - DVec3::new(0.1, 1.1, 0.8)).length() < 1e-15);
        // With the hip turned to the left, forwards is to the left.
        let joints = Joints { yaw: PI / 2.0, pitch: PI / 2.0, ..Joints::default() };
        assert!((sole_position(&leg, joints, 0.0) - DVec3::new(0.1, 1.1, 0.8)).length() < 1e-15);
    }

    #[test]
    fn inverse_kinematics_places_the_sole_on_the_point() {
        for foot in [None, Some(FOOT)] {
            let leg = leg(foot);
            for from_ankle in [-0.05, 0.0, 0.15] {
                for (x, y, z) in [(0.0, 0.0, -0.8), (0.2, -0.1, -0.7), (-0.3, 0.2, -0.55)] {
                    for (yaw, pitch) in [(0.0, 0.0), (0.4, -0.6), (-0.8, 0.3)] {
                        let sole = Sole { from_ankle: if foot.is_some() { from_ankle } else { 0.0 }, pitch };
                        let to_point = DVec3::new(x, y, z);
                        let joints = leg.joints(to_point, yaw, sole);
                        let found = sole_position(&leg, joints, from_ankle);
                        assert!((found - leg.hip - to_point).length() < 1e-12, "{to_point} {yaw} {sole:?}: {found}");
                        if foot.is_some() {
                            let tilt = joints.pitch - joints.knee + joints.ankle;
                            assert!((tilt - pitch).abs() < 1e-15);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn inverse_kinematics_inverts_forward_kinematics() {
        let leg = leg(Some(FOOT));
        for joints in [
            Joints { yaw: 0.2, roll: -0.1, pitch: 0.5, knee: 0.7, ankle: 0.1 },
            Joints { yaw: -0.4, roll: 0.3, pitch: -0.3, knee: 0.2, ankle: -0.4 },
        ] {
            let pitch = joints.pitch - joints.knee + joints.ankle;
            let point = sole_position(&leg, joints, 0.15);
            let found = leg.joints(point - leg.hip, joints.yaw, Sole { from_ankle: 0.15, pitch });
            for (found, given) in found.to_array().into_iter().zip(joints.to_array()) {
                assert!((found - given).abs() < 1e-14, "{found} {given}");
            }
        }
    }

    #[test]
    fn max_hip_height_stretches_the_leg() {
        let leg = leg(Some(FOOT));
        let (offset, sole) = (DVec2::new(0.3, -0.2), Sole { from_ankle: 0.15, pitch: -0.5 });
        let height = leg.max_hip_height(offset, sole).expect("within reach");
        let knee = leg.joints(offset.extend(-height), 0.0, sole).knee;
        // The law of cosines, with a distance of 0.998 * 0.9 m from hip to ankle.
        let cosine = ((0.998f64 * 0.9).powi(2) - 0.16 - 0.25) / 0.4;
        assert!((math::cos(knee) - cosine).abs() < 1e-12, "{knee}");
        assert_eq!(leg.max_hip_height(DVec2::new(1.2, 0.0), sole), None);
        assert_eq!(leg.max_hip_height(DVec2::new(0.0, 1.2), sole), None);
    }
}
