//! Ground truth: reads and sets the poses of robots and objects. A real robot has no such functions.

use super::Robot;
use crate::drive::Position;
use crate::os::RobotNumber;
use crate::robot::robios7;
use crate::unit::{Angle, Length};

/// Ground truth.
#[derive(Clone, Copy, Debug)]
pub struct Simulation<'r>(pub(super) &'r Robot);

/// Number of an object; objects are numbered after the robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectNumber(pub u16);

/// Pose in the world frame, seen from above: x to the right, y to the top, origin at the lower left corner. Values are
/// rounded to 1 mm and 1 degree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TruePose {
    /// Position and heading on the ground.
    pub position: Position,
    /// Height above the ground.
    pub height: Length,
}

impl TruePose {
    fn from_robios7([x, y, z, phi]: [i32; 4]) -> Self {
        let (x, y, phi) = (Length::from_robios7(x), Length::from_robios7(y), Angle::from_robios7(phi));
        Self { position: Position { x, y, phi }, height: Length::from_robios7(z) }
    }

    fn to_robios7(self) -> [i32; 4] {
        let Position { x, y, phi } = self.position;
        [x.to_robios7(), y.to_robios7(), self.height.to_robios7(), phi.to_robios7()]
    }
}

impl Simulation<'_> {
    /// Pose of this robot.
    #[track_caller]
    pub fn own_pose(&self) -> TruePose {
        self.robot_pose(RobotNumber(0))
    }

    /// Pose of a robot; number 0 is this robot.
    #[track_caller]
    pub fn robot_pose(&self, robot: RobotNumber) -> TruePose {
        let mut pose = [0; 4];
        let [x, y, z, phi] = &mut pose;
        let () = robios7!(self.0, SIMGetRobot(robot.0.into(), x, y, z, phi));
        TruePose::from_robios7(pose)
    }

    /// Moves a robot to a pose; number 0 is this robot.
    #[track_caller]
    pub fn put_robot(&self, robot: RobotNumber, pose: TruePose) {
        let [x, y, z, phi] = pose.to_robios7();
        let () = robios7!(self.0, SIMSetRobot(robot.0.into(), x, y, z, phi));
    }

    /// Pose of an object.
    #[track_caller]
    pub fn object_pose(&self, object: ObjectNumber) -> TruePose {
        let mut pose = [0; 4];
        let [x, y, z, phi] = &mut pose;
        let () = robios7!(self.0, SIMGetObject(object.0.into(), x, y, z, phi));
        TruePose::from_robios7(pose)
    }

    /// Moves an object to a pose.
    #[track_caller]
    pub fn put_object(&self, object: ObjectNumber, pose: TruePose) {
        let [x, y, z, phi] = pose.to_robios7();
        let () = robios7!(self.0, SIMSetObject(object.0.into(), x, y, z, phi));
    }

    /// Numbers of all robots.
    #[track_caller]
    pub fn robots(&self) -> impl Iterator<Item = RobotNumber> + use<> {
        let count: i32 = robios7!(self.0, SIMGetRobotCount());
        (1..=count.clamp(0, 255) as u8).map(RobotNumber)
    }

    /// Numbers of all objects.
    #[track_caller]
    pub fn objects(&self) -> impl Iterator<Item = ObjectNumber> + use<> {
        let robots: i32 = robios7!(self.0, SIMGetRobotCount());
        let count: i32 = robios7!(self.0, SIMGetObjectCount());
        let first = robots.max(0) + 1;
        (first..first + count.max(0)).map(|number| ObjectNumber(number as u16))
    }
}
