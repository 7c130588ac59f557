//! Legs: functions of this simulator, identical in both generations.
//!
//! Legs, joints, links and gaits are numbered from 1. Readings are the exact stance at the call's end: errors of joint
//! encoders are not modelled.

use glam::DVec2;
use robios_sys::{Out, OutFloats};
use sim_core::drive::Command;
use sim_core::drive::legged::{Leg, LegCommand, Legs};
use sim_core::pose::{Twist, link_pose};
use sim_core::unit;
use sim_core::world::World;

use super::call::Call;
use super::robot::Robot;
use super::unit7::{metres, radians};
use sim_core::record::Event;

/// Return value of a call that fails.
const FAILURE: i32 = -1;

/// Names of the joints of a leg, from the body on.
const JOINTS: [&str; 5] = ["yaw", "roll", "pitch", "knee", "ankle"];

/// `LEGCount`
pub fn count(robot: &Robot) -> i32 {
    robot.motion.legs().map_or(0, |legs| legs.legs.len() as i32)
}

/// `LEGSetGait`
pub fn set_gait(robot: &mut Robot, call: impl Into<Call>, number: i32) -> i32 {
    let call = call.into();
    let name = |legs: &Legs, index: usize| legs.gaits.get(index).map(|gait| gait.name.clone());
    let found = robot.motion.legs().zip(index_of(number)).and_then(|(legs, index)| Some((index, name(legs, index)?)));
    let Some((index, name)) = found else { return refuse_missing_part(robot, call, "gait", number, list_gaits) };
    let outcome = robot.state.motion.command_legs(robot.state.now, LegCommand::Gait(index));
    if outcome.is_ok() {
        robot.record(Event::Gait { gait: index as u32 + 1, name: &name });
    }
    robot.answer_call(call, FAILURE, outcome)
}

/// `LEGSetSpeed`
pub fn set_speed(robot: &mut Robot, world: &World, call: impl Into<Call>, [vx, vy, omega]: [i32; 3]) -> i32 {
    let call = call.into();
    if robot.motion.legs().is_none() {
        return refuse_without_legs(robot, call);
    }
    let twist = Twist { vx: metres(vx), vy: metres(vy), omega: radians(omega) };
    let outcome = robot.command(world, Command::Twist(twist));
    if outcome.is_ok() {
        let Twist { vx, vy, omega } = twist;
        robot.record(Event::LegSpeed { vx_m_per_s: vx, vy_m_per_s: vy, omega_rad_per_s: omega });
    }
    robot.answer_call(call, FAILURE, outcome)
}

/// `LEGSetStep`
pub fn set_step(robot: &mut Robot, call: impl Into<Call>, height_mm: i32) -> i32 {
    let (call, height) = (call.into(), metres(height_mm));
    if robot.motion.legs().is_none() {
        return refuse_without_legs(robot, call);
    }
    let outcome = robot.state.motion.command_legs(robot.state.now, LegCommand::StepHeight(height));
    if outcome.is_ok() {
        robot.record(Event::StepHeight { height_m: height });
    }
    robot.answer_call(call, FAILURE, outcome)
}

/// `LEGGetJoint`
pub fn joint(robot: &mut Robot, call: impl Into<Call>, [number, joint]: [i32; 2], degrees: &mut Out<f32>) -> i32 {
    let call = call.into();
    let Some(named) = NamedLeg::find(robot, number) else {
        return refuse_missing_part(robot, call, "leg", number, list_legs);
    };
    let Some(index) = index_of(joint).filter(|index| *index < named.leg.joint_count()) else {
        let names = JOINTS[..named.leg.joint_count()].iter();
        return refuse_missing_part(robot, call, "joint", joint, |_| list(names.copied()));
    };
    if degrees.is_null() {
        return robot.refuse_call(call, FAILURE, |_| "the pointer for the angle is null".to_owned());
    }
    let angle = robot.state.motion.stance(robot.state.now).joints[named.first_joint + index];
    robot.record(Event::Joint { joint: &format!("{}.{}", named.leg.name, JOINTS[index]), angle_rad: angle });
    degrees.set(unit::degrees_from_radians(angle) as f32);
    0
}

/// `LEGGetLink`
pub fn link(robot: &mut Robot, call: impl Into<Call>, [number, link]: [i32; 2], pose: &mut OutFloats) -> i32 {
    let call = call.into();
    let Some(named) = NamedLeg::find(robot, number) else {
        return refuse_missing_part(robot, call, "leg", number, list_legs);
    };
    let Some((part, index)) = index_of(link).and_then(|index| named.leg.parts().nth(index)) else {
        let names: Vec<_> = named.leg.parts().map(|(part, _)| part).collect();
        return refuse_missing_part(robot, call, "link", link, |_| list(names.into_iter()));
    };
    if pose.is_null() {
        return robot.refuse_call(call, FAILURE, |_| "the buffer for 6 numbers is null".to_owned());
    }
    let joints = robot.state.motion.stance(robot.state.now).joints;
    let body_from_link = link_pose(&named.leg.links(0, named.first_joint), &joints, index);
    let (position, [roll, pitch, yaw]) = (body_from_link.position, body_from_link.angles());
    let name = format!("{}.{part}", named.leg.name);
    robot.record(Event::Link {
        link: &name,
        x_m: position.x,
        y_m: position.y,
        z_m: position.z,
        roll_rad: roll,
        pitch_rad: pitch,
        yaw_rad: yaw,
    });
    let lengths = position.to_array().map(unit::mm_from_metres);
    let angles = [roll, pitch, yaw].map(unit::degrees_from_radians);
    let numbers: Vec<f32> = lengths.into_iter().chain(angles).map(|number| number as f32).collect();
    pose.set(&numbers);
    0
}

/// `LEGGetHeight`
pub fn height(robot: &mut Robot, call: impl Into<Call>, mm: &mut Out<f32>) -> i32 {
    let call = call.into();
    if robot.motion.legs().is_none() {
        return refuse_without_legs(robot, call);
    }
    if mm.is_null() {
        return robot.refuse_call(call, FAILURE, |_| "the pointer for the height is null".to_owned());
    }
    let height = robot.state.motion.stance(robot.state.now).lift;
    robot.record(Event::BodyHeight { height_m: height });
    mm.set(unit::mm_from_metres(height) as f32);
    0
}

/// `LEGGetFoot`
pub fn foot(robot: &mut Robot, call: impl Into<Call>, number: i32) -> i32 {
    let call = call.into();
    let Some(NamedLeg { leg, index, .. }) = NamedLeg::find(robot, number) else {
        return refuse_missing_part(robot, call, "leg", number, list_legs);
    };
    let is_down = robot.state.motion.stance(robot.state.now).feet[index].is_down;
    robot.record(Event::Reading { device: &format!("{} foot", leg.name), value: i64::from(is_down) });
    i32::from(is_down)
}

/// `LEGCorrect`
pub fn correct(robot: &mut Robot, call: impl Into<Call>, number: i32, [dx_mm, dy_mm, dz_mm]: [i32; 3]) -> i32 {
    let call = call.into();
    let Some(NamedLeg { leg, index, .. }) = NamedLeg::find(robot, number) else {
        return refuse_missing_part(robot, call, "leg", number, list_legs);
    };
    let [dx, dy, dz] = [dx_mm, dy_mm, dz_mm].map(metres);
    let command = LegCommand::ShiftFoothold { leg: index, shift: DVec2::new(dx, dy), lift: dz };
    let outcome = robot.state.motion.command_legs(robot.state.now, command);
    if outcome.is_ok() {
        robot.record(Event::LegCorrection { leg: &leg.name, dx_m: dx, dy_m: dy, dz_m: dz });
    }
    robot.answer_call(call, FAILURE, outcome)
}

/// A leg whose number a program has passed.
struct NamedLeg {
    leg: Leg,
    index: usize,
    /// Index of the leg's first joint among the joints of all legs.
    first_joint: usize,
}

impl NamedLeg {
    fn find(robot: &Robot, number: i32) -> Option<Self> {
        let (legs, index) = (&robot.motion.legs()?.legs, index_of(number)?);
        let leg = legs.get(index)?.clone();
        let first_joint = legs[..index].iter().map(Leg::joint_count).sum();
        Some(Self { leg, index, first_joint })
    }
}

/// Index of the list element with this number.
fn index_of(number: i32) -> Option<usize> {
    usize::try_from(number).ok()?.checked_sub(1)
}

/// Refuses a call on a robot without legs.
fn refuse_without_legs(robot: &mut Robot, call: Call) -> i32 {
    robot.refuse_call(call, FAILURE, |robot| {
        format!("`{}` has no legs; in a companion they are tables `[[leg]]`", robot.spec.file)
    })
}

/// Refuses a call for a part that the robot does not have; `list_parts` lists the existing parts.
fn refuse_missing_part(
    robot: &mut Robot,
    call: Call,
    kind: &str,
    number: i32,
    list_parts: impl FnOnce(&Legs) -> String,
) -> i32 {
    if robot.motion.legs().is_none() {
        return refuse_without_legs(robot, call);
    }
    robot.refuse_call(call, FAILURE, |robot| {
        let known = robot.motion.legs().map(list_parts).unwrap_or_default();
        format!("there is no {kind} {number}, there are: {known}")
    })
}

fn list_legs(legs: &Legs) -> String {
    list(legs.legs.iter().map(|leg| leg.name.as_str()))
}

fn list_gaits(legs: &Legs) -> String {
    list(legs.gaits.iter().map(|gait| gait.name.as_str()))
}

/// Lists names with their numbers.
fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let named: Vec<String> = (1..).zip(names).map(|(number, name): (i32, _)| format!("{number} ({name})")).collect();
    named.join(", ")
}
