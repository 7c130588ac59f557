//! Functions of RoBIOS-7 that only a simulator can provide: ground-truth poses, and placement of robots and objects.
//!
//! Source: EyeSim VR, simulation functions. Headings are as in the sim file and in VW: 0 along x, counter-clockwise;
//! headings of EyeSim VR of 2018 differ (`heading_to_program`, `heading_from_program`).

use sim_core::pose::Pose;
use sim_core::simulation::{self, Placeable, Placement};
use sim_core::spec::{Dialect, ObjectSpec, SceneSpec};
use sim_core::unit::mm_from_metres;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};

use robios_sys::{Out, Robios7Call as Call};

use super::robot::Robot;
use super::unit7::{pose, pose_numbers};

/// Numbers of robots and objects for programs: first the robots of the scene from 1 on, then its objects in the order
/// of the sim file, then spawned entities in the order of their addition.
#[derive(Clone, Debug, Default)]
pub struct EntityNumbers {
    /// Number of robots in the scene.
    pub robots: usize,
    /// Objects of the scene, fixed ones included.
    pub objects: Vec<NumberedObject>,
    /// Robots and movable objects that were added during the run.
    pub spawned: boxcar::Vec<Placeable>,
}

/// An object with a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NumberedObject {
    /// A movable object.
    Movable(ObjectId),
    /// A fixed object and its pose.
    Fixed(Pose),
}

impl EntityNumbers {
    /// Numbers at the start of `scene`.
    pub fn of(scene: &SceneSpec) -> Self {
        let mut movable = 0;
        let counted = |object: &ObjectSpec| {
            if object.kind.is_fixed {
                return NumberedObject::Fixed(object.pose);
            }
            movable += 1;
            NumberedObject::Movable(ObjectId(movable))
        };
        let objects = scene.objects.iter().map(counted).collect();
        Self { robots: scene.robots.len(), objects, ..Self::default() }
    }

    /// Id of the robot with this number; 0 is the robot `own_id`.
    fn robot(&self, number: i32, own_id: RobotId) -> Option<RobotId> {
        match usize::try_from(number).ok()? {
            0 => Some(own_id),
            number if number <= self.robots => Some(RobotId::from_index(number - 1)),
            number => match self.spawned(number)? {
                Placeable::Robot(id) => Some(id),
                Placeable::Object(_) => None,
            },
        }
    }

    /// Object with this number.
    fn object(&self, number: i32) -> Option<NumberedObject> {
        let number = usize::try_from(number).ok()?;
        let scene_object = self.objects.get(number.checked_sub(self.robots + 1)?).copied();
        scene_object.or_else(|| match self.spawned(number)? {
            Placeable::Object(id) => Some(NumberedObject::Movable(id)),
            Placeable::Robot(_) => None,
        })
    }

    fn spawned(&self, number: usize) -> Option<Placeable> {
        self.spawned.get(number.checked_sub(self.robots + self.objects.len() + 1)?).copied()
    }

    /// Number of a spawned robot or object.
    pub fn spawned_number(&self, entity: Placeable) -> Option<i32> {
        let (index, _) = self.spawned.iter().find(|(_, spawned)| **spawned == entity)?;
        Some((self.robots + self.objects.len() + 1 + index) as i32)
    }
}

/// `SIMGetRobot`
pub fn robot_pose(robot: &mut Robot, world: &World, number: i32, out: [&mut Out<i32>; 4]) {
    let Some(id) = robot.robios.entity_numbers.robot(number, robot.id) else {
        return skip_for_unknown_robot(robot, Call::SIMGetRobot, number);
    };
    let now = robot.now;
    if id != robot.id && !world.is_robot_present(id, now) {
        return robot.skip_call(Call::SIMGetRobot, |_| absence_reason("robot", number));
    }
    let (pose, height) = if id == robot.id {
        (robot.motion.pose(now), robot.motion.lift(now))
    } else {
        (world.robot_pose(id, now), world.robot_pose_in_space(id, now).position.z)
    };
    store_pose(robot.robios.dialect, &pose, height, out);
}

/// `SIMSetRobot`: places the calling robot immediately, another robot at the slot's end. Odometry is not affected.
pub fn set_robot(robot: &mut Robot, world: &World, number: i32, to: [i32; 3]) {
    let Some(id) = robot.robios.entity_numbers.robot(number, robot.id) else {
        return skip_for_unknown_robot(robot, Call::SIMSetRobot, number);
    };
    if id != robot.id && !world.is_robot_present(id, robot.now) {
        return robot.skip_call(Call::SIMSetRobot, |_| absence_reason("robot", number));
    }
    let pose = pose_from_program(robot.robios.dialect, to);
    if id != robot.id {
        return place(robot, Placeable::Robot(id), pose);
    }
    // Poses in whole millimetres are always valid.
    let _ = robot.state.motion.place(robot.state.now, pose);
    let (now, id) = (robot.now, robot.id);
    robot.record_placed(now, id, &pose);
}

/// `SIMGetObject`
pub fn object_pose(robot: &mut Robot, world: &World, number: i32, out: [&mut Out<i32>; 4]) {
    let (pose, height) = match robot.robios.entity_numbers.object(number) {
        Some(NumberedObject::Movable(object)) if !world.is_object_present(object, robot.now) => {
            return robot.skip_call(Call::SIMGetObject, |_| absence_reason("object", number));
        }
        Some(NumberedObject::Movable(object)) => {
            (world.object_pose(object, robot.now), world.object_properties(object).lift)
        }
        Some(NumberedObject::Fixed(pose)) => (pose, 0.0),
        None => return skip_for_unknown_object(robot, Call::SIMGetObject, number),
    };
    store_pose(robot.robios.dialect, &pose, height, out);
}

/// `SIMSetObject`: places the object at the slot's end.
pub fn set_object(robot: &mut Robot, world: &World, number: i32, to: [i32; 3]) {
    match robot.robios.entity_numbers.object(number) {
        Some(NumberedObject::Movable(object)) if !world.is_object_present(object, robot.now) => {
            robot.skip_call(Call::SIMSetObject, |_| absence_reason("object", number));
        }
        Some(NumberedObject::Movable(object)) => {
            place(robot, Placeable::Object(object), pose_from_program(robot.robios.dialect, to));
        }
        Some(NumberedObject::Fixed(_)) => {
            robot.skip_call(Call::SIMSetObject, |_| format!("object {number} is fixed: it cannot be moved"));
        }
        None => skip_for_unknown_object(robot, Call::SIMSetObject, number),
    }
}

/// `SIMGetRobotCount`
pub fn robot_count(robot: &Robot) -> i32 {
    robot.robios.entity_numbers.robots as i32
}

/// `SIMGetObjectCount`
pub fn object_count(robot: &Robot) -> i32 {
    robot.robios.entity_numbers.objects.len() as i32
}

/// Stores a pose and a height for a program, in mm and degrees. `height` is in metres; it is 0 except for a robot with
/// legs or in the water, and for a floating object.
fn store_pose(dialect: Dialect, pose: &Pose, height: f64, [x, y, z, phi]: [&mut Out<i32>; 4]) {
    let [x_mm, y_mm, phi_degrees] = pose_numbers(pose);
    let numbers = [x_mm, y_mm, heading_to_program(dialect, phi_degrees)];
    [x, y, phi].into_iter().zip(numbers).for_each(|(out, number)| out.set(number));
    z.set(mm_from_metres(height).round() as i32);
}

fn pose_from_program(dialect: Dialect, [x_mm, y_mm, phi_degrees]: [i32; 3]) -> Pose {
    pose([x_mm, y_mm, heading_from_program(dialect, phi_degrees)])
}

/// Heading in degrees that a program reads: `phi`, from -179 to 180, counter-clockwise from x. For EyeSim VR of 2018 it
/// is 360 minus the yaw of Unity: from 1 to 360, counter-clockwise from y.
fn heading_to_program(dialect: Dialect, phi: i32) -> i32 {
    match dialect {
        Dialect::Vr2018 => 360 - yaw(phi),
        Dialect::Classic | Dialect::Vr2023 => phi,
    }
}

/// Heading in degrees, counter-clockwise from x, for the argument `phi` of a program. EyeSim VR of 2018 takes `phi` as
/// the yaw of Unity, clockwise from y.
fn heading_from_program(dialect: Dialect, phi: i32) -> i32 {
    match dialect {
        Dialect::Vr2018 => yaw(phi),
        Dialect::Classic | Dialect::Vr2023 => phi,
    }
}

/// Yaw of Unity, clockwise from y, from 0 to 359, for a heading counter-clockwise from x. The function is its own
/// inverse, up to whole turns.
fn yaw(phi: i32) -> i32 {
    (90 - i64::from(phi)).rem_euclid(360) as i32
}

fn absence_reason(kind: &str, number: i32) -> String {
    format!("{kind} {number} has been taken out of the world")
}

fn place(robot: &mut Robot, entity: Placeable, pose: Pose) {
    let simulation::Robot { now, id, placements, .. } = &mut robot.state;
    placements.push(Placement { time: *now, by: *id, what: entity, pose });
}

fn skip_for_unknown_robot(robot: &mut Robot, call: Call, number: i32) {
    robot.skip_call(call, |robot| {
        format!(
            "there is no robot {number}, accepted: 0 for the robot itself, 1 to {}",
            robot.robios.entity_numbers.robots
        )
    });
}

fn skip_for_unknown_object(robot: &mut Robot, call: Call, number: i32) {
    robot.skip_call(call, |robot| {
        let EntityNumbers { robots, objects, .. } = &*robot.robios.entity_numbers;
        match objects.len() {
            0 => format!("there is no object {number}, since the scene has none"),
            count => format!(
                "there is no object {number}: the objects' numbers follow those of the robots, here from {} to {}",
                robots + 1,
                robots + count
            ),
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_of_2018_follow_its_source_code() {
        let headings = |phi| [Dialect::Vr2018, Dialect::Vr2023].map(|dialect| heading_to_program(dialect, phi));
        assert_eq!([90, 0, 180, -90, 89].map(headings), [[360, 90], [270, 0], [90, 180], [180, -90], [359, 89]]);
        let meant = |phi| [Dialect::Vr2018, Dialect::Vr2023].map(|dialect| heading_from_program(dialect, phi));
        assert_eq!([0, 90, 180, -90].map(meant), [[90, 0], [0, 90], [270, 180], [180, -90]]);
        assert_eq!(heading_from_program(Dialect::Vr2018, i32::MIN), (90 + (1_i64 << 31)).rem_euclid(360) as i32);
    }

    #[test]
    fn objects_are_numbered_after_the_robots() {
        let (can, stone) = (NumberedObject::Movable(ObjectId(1)), NumberedObject::Fixed(Pose::new(1.0, 2.0, 0.0)));
        let entity_numbers = EntityNumbers { robots: 2, objects: vec![can, stone], ..EntityNumbers::default() };
        let own = RobotId(2);
        assert_eq!([0, 1, 2].map(|number| entity_numbers.robot(number, own)), [Some(own), Some(RobotId(1)), Some(own)]);
        assert_eq!([-1, 3, i32::MIN].map(|number| entity_numbers.robot(number, own)), [None; 3]);
        assert_eq!([3, 4].map(|number| entity_numbers.object(number)), [Some(can), Some(stone)]);
        assert_eq!([0, 2, 5, -7, i32::MAX].map(|number| entity_numbers.object(number)), [None; 5]);

        let [ball, spawned_robot] = [Placeable::Object(ObjectId(2)), Placeable::Robot(RobotId(3))];
        entity_numbers.spawned.push(ball);
        entity_numbers.spawned.push(spawned_robot);
        assert_eq!(
            (entity_numbers.object(5), entity_numbers.robot(5, own)),
            (Some(NumberedObject::Movable(ObjectId(2))), None)
        );
        assert_eq!((entity_numbers.object(6), entity_numbers.robot(6, own)), (None, Some(RobotId(3))));
        assert_eq!([ball, spawned_robot].map(|who| entity_numbers.spawned_number(who)), [Some(5), Some(6)]);
        assert_eq!((entity_numbers.object(7), entity_numbers.robot(7, own)), (None, None));
    }
}
