//! Chains of links: rigid parts connected by joints.

use glam::DVec3;

use super::Pose3;

/// A rigid part of a robot that is connected to the body or to another part and turns about an axis, such as a pan head
/// or a shank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// The parent link, as an index into the robot's list of links; `None` for the body.
    pub parent: Option<usize>,
    /// The link's frame in the parent's frame at joint angle 0.
    pub origin: Pose3,
    /// Axis of the joint through the link's origin, a unit vector in the link's frame; the joint angle is right-handed
    /// about it.
    pub axis: DVec3,
    /// Joint that rotates the link, as an index into the robot's list of joint angles (servos first, then legs); `None`
    /// for a fixed link.
    pub joint: Option<usize>,
}

/// Pose of link `index` in the robot's frame at the joint angles `angles` (rad, in the order of the joints' indices).
///
/// # Panics
/// If the link or an angle does not exist, or a link is before its parent in the list.
pub fn link_pose(links: &[Link], angles: &[f64], index: usize) -> Pose3 {
    let link = &links[index];
    let parent_from_link =
        link.joint.map_or(link.origin, |joint| link.origin.then(&Pose3::about_axis(link.axis, angles[joint])));
    match link.parent {
        Some(parent) => {
            assert!(parent < index, "a link is after its parent");
            link_pose(links, angles, parent).then(&parent_from_link)
        }
        None => parent_from_link,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn leg_of_two_links_matches_trigonometry() {
        // A thigh of 0.4 m hangs from the hip at a height of 0.8 m, a shank of 0.3 m from the knee; both turn about y.
        let hip = Link {
            parent: None,
            origin: Pose3::from_angles(DVec3::new(0.1, 0.0, 0.8), 0.0, 0.0, 0.0),
            axis: DVec3::Y,
            joint: Some(1),
        };
        let knee = Link {
            parent: Some(0),
            origin: Pose3::from_angles(DVec3::new(0.0, 0.0, -0.4), 0.0, 0.0, 0.0),
            joint: Some(0),
            ..hip
        };
        let foot = Link {
            parent: Some(1),
            origin: Pose3::from_angles(DVec3::new(0.0, 0.0, -0.3), 0.0, 0.0, 0.0),
            joint: None,
            ..hip
        };
        let links = [hip, knee, foot];
        let foot_pose = |angles: &[f64]| link_pose(&links, angles, 2);
        assert!((foot_pose(&[0.0, 0.0]).position - DVec3::new(0.1, 0.0, 0.1)).length() < 1e-15);
        // A positive angle about y swings a hanging part backwards.
        let raised = foot_pose(&[FRAC_PI_2, -FRAC_PI_2]);
        assert!((raised.position - DVec3::new(0.5, 0.0, 0.5)).length() < 1e-15, "{raised:?}");
        assert!((raised.forward() - DVec3::X).length() < 1e-15);
    }
}
