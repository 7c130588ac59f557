//! The driving interface of RoBIOS 6: metres, radians, seconds.
//!
//! Source: RoBIOS 6 library, VW interface.

use robios_sys::robios6::hdt_type::HDT_VW;
use robios_sys::robios6::{PositionType, SpeedType};
use robios_sys::{Out, Robios6Call as Call};
use sim_core::drive::{Command, CommandError, Gains, State};
use sim_core::pose::{Pose, Twist};
use sim_core::time::Time;
use sim_core::world::World;

use super::caller::Poll;
use super::hint::{LONG_DRIVE, LONG_TURN, Mistake};
use super::robot::{Robot, WaitReason};
use sim_core::record::Event;

/// The only handle: a number that no other family returns, so that a mixed-up handle is detected.
pub const HANDLE: i32 = 0x56;

/// A program that replaces a drive within this time of its start probably forgot to wait for its end.
const IMMEDIATE_REPLACEMENT: Time = Time::from_millis(20);

/// State of a robot's driving interface.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vw {
    /// The interface is open, from `VWInit` to `VWRelease` of RoBIOS 6: motors are reserved.
    pub is_open: bool,
    /// Start of the last drive, and the function that waits for its end.
    pub last_drive: Option<(Time, &'static str)>,
    /// Pose of the odometry frame in the world: the pose of the robot's axle at its start, until the program sets the
    /// odometry.
    pub world_from_odometry: Pose,
}

/// Reason why a command is refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DriveRefusal {
    /// The duration of the drive would be infinite or undefined.
    #[error("it takes a length or angle that is a number, a speed other than 0, and a length for a curve")]
    Endless,
    /// The drive rejects the command.
    #[error(transparent)]
    Command(#[from] CommandError),
}

/// `VWInit`
pub fn init(robot: &mut Robot, world: &World, semantics: i32, timescale: i32) -> i32 {
    if let Some(reason) = init_failure(robot, semantics, timescale) {
        return robot.refuse_call(Call::VWInit, 0, |_| reason.to_owned());
    }
    robot.robios.vw.is_open = true;
    robot.halt(world);
    // The drive accepts this pose, which is finite.
    let _ = robot.state.motion.set_odometry(robot.state.now, Pose::default());
    locate_odometry(robot);
    robot.record(Event::SetOdometry { x_m: 0.0, y_m: 0.0, phi_rad: 0.0 });
    HANDLE
}

/// `VWRelease`
pub fn release(robot: &mut Robot, world: &World, handle: i32) -> i32 {
    if !is_handle(robot, handle) {
        return robot.refuse_handle(Call::VWRelease, -1, handle, Call::VWInit);
    }
    robot.tasks.recheck_drive(robot.state.now);
    robot.halt(world);
    robot.state.motion.stop_control(robot.state.now);
    robot.robios.vw.is_open = false;
    0
}

/// `VWSetSpeed`
pub fn set_speed(robot: &mut Robot, world: &World, handle: i32, v: f32, omega: f32) -> i32 {
    let (v, omega) = (f64::from(v), f64::from(omega));
    if !is_handle(robot, handle) {
        return robot.refuse_handle(Call::VWSetSpeed, -1, handle, Call::VWInit);
    }
    let outcome = set_twist(robot, world, v, omega);
    robot.answer_call(Call::VWSetSpeed, -1, outcome)
}

/// `VWGetSpeed`
pub fn speed(robot: &mut Robot, handle: i32, speed: &mut Out<SpeedType>) -> i32 {
    if !is_handle(robot, handle) {
        return robot.refuse_handle(Call::VWGetSpeed, -1, handle, Call::VWInit);
    }
    if speed.is_null() {
        return robot.fail_call(Call::VWGetSpeed, -1);
    }
    let twist = twist(robot);
    speed.set(SpeedType { v: twist.vx as f32, w: twist.omega as f32 });
    0
}

/// `VWSetPosition`
pub fn set_position(robot: &mut Robot, handle: i32, x: f32, y: f32, phi: f32) -> i32 {
    let [x, y, phi] = [x, y, phi].map(f64::from);
    if !is_handle(robot, handle) {
        return robot.refuse_handle(Call::VWSetPosition, -1, handle, Call::VWInit);
    }
    let outcome = set_odometry(robot, [x, y, phi]);
    robot.answer_call(Call::VWSetPosition, -1, outcome)
}

/// `VWGetPosition`: the heading is within [-pi, pi).
pub fn position(robot: &mut Robot, handle: i32, position: &mut Out<PositionType>) -> i32 {
    if !is_handle(robot, handle) {
        return robot.refuse_handle(Call::VWGetPosition, -1, handle, Call::VWInit);
    }
    if position.is_null() {
        return robot.fail_call(Call::VWGetPosition, -1);
    }
    let pose = odometry(robot);
    let (x, y, phi) = (pose.position.x, pose.position.y, pose.heading.remainder());
    position.set(PositionType { x: x as f32, y: y as f32, phi: phi as f32 });
    0
}

/// `VWStartControl`
pub fn start_control(robot: &mut Robot, handle: i32, [vv, tv, vw, tw]: [f32; 4]) -> i32 {
    if !is_handle(robot, handle) {
        return robot.refuse_handle(Call::VWStartControl, -1, handle, Call::VWInit);
    }
    let outcome = set_gains(robot, Gains { vv: vv.into(), tv: tv.into(), vw: vw.into(), tw: tw.into() });
    robot.answer_call(Call::VWStartControl, -1, outcome)
}

/// `VWStopControl`
pub fn stop_control(robot: &mut Robot, handle: i32) -> i32 {
    if !is_handle(robot, handle) {
        return robot.refuse_handle(Call::VWStopControl, -1, handle, Call::VWInit);
    }
    clear_gains(robot);
    0
}

/// `VWDriveStraight`: the direction is the sign of `distance`; the sign of the speed is ignored.
pub fn drive_straight(robot: &mut Robot, world: &World, handle: i32, distance: f32, v: f32) -> i32 {
    let (distance, v) = (f64::from(distance), f64::from(v));
    if distance.abs() > LONG_DRIVE {
        robot.hint_at(Mistake::LongDrive);
    }
    if distance == 0.0 && v != 0.0 {
        robot.hint_at(Mistake::NoLength);
    }
    let event = Event::DriveStraight { distance_m: distance, v_m_per_s: v };
    let drive = Twist::new(distance, 0.0);
    start(robot, world, handle, drive, seconds(distance, v), (Call::VWDriveStraight, event))
}

/// `VWDriveTurn`: the direction is the sign of `angle`; the sign of the rate is ignored.
pub fn drive_turn(robot: &mut Robot, world: &World, handle: i32, angle: f32, omega: f32) -> i32 {
    let (angle, omega) = (f64::from(angle), f64::from(omega));
    if angle.abs() > LONG_TURN {
        robot.hint_at(Mistake::LongTurn);
    }
    let event = Event::DriveTurn { angle_rad: angle, omega_rad_per_s: omega };
    start(robot, world, handle, Twist::new(0.0, angle), seconds(angle, omega), (Call::VWDriveTurn, event))
}

/// `VWDriveCurve`: forwards or backwards by the sign of `distance`; the sign of the speed is ignored.
pub fn drive_curve(robot: &mut Robot, world: &World, handle: i32, [distance, angle, v]: [f32; 3]) -> i32 {
    let [distance, angle, v] = [distance, angle, v].map(f64::from);
    if distance.abs() > LONG_DRIVE {
        robot.hint_at(Mistake::LongDrive);
    }
    if angle.abs() > LONG_TURN {
        robot.hint_at(Mistake::LongTurn);
    }
    let event = Event::DriveCurve { distance_m: distance, angle_rad: angle, v_m_per_s: v };
    let seconds = curve_seconds(distance, angle, v);
    start(robot, world, handle, Twist::new(distance, angle), seconds, (Call::VWDriveCurve, event))
}

/// `VWDriveRemain`
pub fn drive_remain(robot: &mut Robot, handle: i32) -> f32 {
    if !is_handle(robot, handle) {
        robot.refuse_handle(Call::VWDriveRemain, 0, handle, Call::VWInit);
        return 0.0;
    }
    robot.state.motion.drive_remaining(robot.state.now) as f32
}

/// `VWDriveDone`
pub fn drive_done(robot: &mut Robot, handle: i32) -> i32 {
    if !is_handle(robot, handle) {
        return robot.refuse_handle(Call::VWDriveDone, -1, handle, Call::VWInit);
    }
    i32::from(robot.state.motion.is_drive_done(robot.state.now))
}

/// `VWDriveWait`
pub fn drive_wait(robot: &mut Robot, handle: i32) -> Poll<i32> {
    if !is_handle(robot, handle) {
        return Poll::Ready(robot.refuse_handle(Call::VWDriveWait, -1, handle, Call::VWInit));
    }
    wait_for_drive(robot)
}

/// `VWStalled`
pub fn stalled(robot: &mut Robot, handle: i32) -> i32 {
    if !is_handle(robot, handle) {
        return robot.refuse_handle(Call::VWStalled, -1, handle, Call::VWInit);
    }
    i32::from(robot.state.motion.is_stalled(robot.state.now))
}

/// Reason why `VWInit` fails, if it does.
fn init_failure(robot: &Robot, semantics: i32, timescale: i32) -> Option<&'static str> {
    if robot.robios.table.find(HDT_VW, semantics).is_none() {
        Some("the first argument must be `VW_DRIVE`")
    } else if timescale < 1 {
        Some("the second argument must be at least 1")
    } else if robot.robios.vw.is_open {
        Some("it is in use: there is one handle until `VWRelease`")
    } else if robot.robios.motors.is_any_open() {
        Some("the program holds motors of `MOTORInit`: release them first")
    } else {
        None
    }
}

fn is_handle(robot: &Robot, handle: i32) -> bool {
    robot.robios.vw.is_open && handle == HANDLE
}

/// Starts a drive through a handle.
fn start(
    robot: &mut Robot,
    world: &World,
    handle: i32,
    displacement: Twist,
    seconds: f64,
    (call, event): (Call, Event<'_>),
) -> i32 {
    if !is_handle(robot, handle) {
        return robot.refuse_handle(call, -1, handle, Call::VWInit);
    }
    let outcome = start_drive(robot, world, displacement, seconds, (event, Call::VWDriveWait.name()));
    robot.answer_call(call, -1, outcome)
}

// The functions below serve both generations, in metres, radians and seconds.

/// Duration of a distance or angle at this rate; NaN at an infinite rate.
fn seconds(distance: f64, rate: f64) -> f64 {
    if rate.is_infinite() { f64::NAN } else { distance / rate }
}

/// Duration of a curve; NaN for a curve of length 0, along which no speed is defined.
pub(super) fn curve_seconds(distance: f64, angle: f64, v: f64) -> f64 {
    if distance == 0.0 && angle != 0.0 { f64::NAN } else { seconds(distance, v) }
}

/// Starts a drive that takes |`seconds`|: the sign of `seconds` is ignored. `wait_function` is the name of the function
/// that waits for the drive's end.
pub(super) fn start_drive(
    robot: &mut Robot,
    world: &World,
    displacement: Twist,
    seconds: f64,
    (event, wait_function): (Event<'_>, &'static str),
) -> Result<(), DriveRefusal> {
    // A speed of 0 yields an infinite time, or NaN for a distance of 0.
    if !seconds.is_finite() {
        return Err(DriveRefusal::Endless);
    }
    let replaces_immediately =
        robot.robios.vw.last_drive.is_some_and(|(start, _)| robot.now - start <= IMMEDIATE_REPLACEMENT);
    if replaces_immediately && !robot.state.motion.is_drive_done(robot.state.now) {
        let text = format!(
            "this drive replaces the previous one, which has just begun: write `{}` above this line to wait for its end",
            if wait_function == "VWWait" { "VWWait()" } else { wait_function }
        );
        robot.hint_once(Mistake::MissingWait, &text);
    }
    robot.command(world, Command::Drive { displacement, duration: seconds.abs() })?;
    robot.robios.vw.last_drive = Some((robot.now, wait_function));
    robot.record(event);
    Ok(())
}

/// Drives with a linear and an angular speed from now on.
pub(super) fn set_twist(robot: &mut Robot, world: &World, v: f64, omega: f64) -> Result<(), DriveRefusal> {
    robot.command(world, Command::Twist(Twist::new(v, omega)))?;
    robot.record(Event::DriveSpeed { v_m_per_s: v, omega_rad_per_s: omega });
    Ok(())
}

/// Linear and angular speed as measured at the wheels.
pub(super) fn twist(robot: &mut Robot) -> Twist {
    let twist = robot.state.motion.speed(robot.state.now);
    robot.record(Event::OdometrySpeed { v_m_per_s: twist.vx, omega_rad_per_s: twist.omega });
    twist
}

/// Sets the odometry pose.
pub(super) fn set_odometry(robot: &mut Robot, [x, y, phi]: [f64; 3]) -> Result<(), DriveRefusal> {
    // A heading cannot count the whole turns of every finite angle.
    if phi.is_nan() || phi.abs() > 1e12 {
        return Err(CommandError::NotFinite.into());
    }
    robot.state.motion.set_odometry(robot.state.now, Pose::new(x, y, phi))?;
    locate_odometry(robot);
    robot.record(Event::SetOdometry { x_m: x, y_m: y, phi_rad: phi });
    Ok(())
}

/// Stores the pose of the odometry frame in the world for which the current odometry equals the true pose.
pub(super) fn locate_odometry(robot: &mut Robot) {
    let State { world_from_axle, odometry, .. } = robot.state.motion.state(robot.state.now);
    let turn = Pose::new(0.0, 0.0, world_from_axle.heading.radians() - odometry.heading.radians());
    let position = world_from_axle.position - turn.transform_point(odometry.position);
    robot.robios.vw.world_from_odometry = Pose { position, ..turn };
}

/// The odometry pose.
pub(super) fn odometry(robot: &mut Robot) -> Pose {
    let pose = robot.state.motion.odometry(robot.state.now);
    robot.record(Event::Odometry { x_m: pose.position.x, y_m: pose.position.y, phi_rad: pose.heading.remainder() });
    pose
}

/// Starts the controllers of linear and angular speed.
pub(super) fn set_gains(robot: &mut Robot, gains: Gains) -> Result<(), DriveRefusal> {
    robot.state.motion.start_control(robot.state.now, gains)?;
    let Gains { vv, tv, vw, tw } = gains;
    robot.record(Event::ControlStarted { v_gain: vv, v_reset_s: tv, omega_gain: vw, omega_reset_s: tw });
    Ok(())
}

/// Stops the controllers.
pub(super) fn clear_gains(robot: &mut Robot) {
    robot.state.motion.stop_control(robot.state.now);
    robot.record(Event::ControlStopped {});
}

/// Waits for the end of the drive in progress.
pub(super) fn wait_for_drive(robot: &mut Robot) -> Poll<i32> {
    if robot.state.motion.is_drive_done(robot.state.now) {
        return Poll::Ready(0);
    }
    Poll::Pending { at: robot.motion.drive_end().unwrap_or(Time::NEVER), reason: WaitReason::Drive }
}
