//! The driving interface of RoBIOS-7: always open, without a handle, in millimetres and degrees.
//!
//! Source: RoBIOS-7 library, V-Omega driving. The motors follow the last command, whether of this family or of
//! `MOTORDrive`: our choice.

use robios_sys::{Out, Robios7Call as Call};
use sim_core::drive::{Gains, arc_to};
use sim_core::pose::Twist;
use sim_core::world::World;

use super::caller::Poll;
use super::hint::Mistake;
use super::robot::Robot;
use super::unit7::{degrees, metres, mm, pose_numbers, radians, remaining};
use super::vw::{self, DriveRefusal};
use sim_core::record::Event;

/// If a length and a speed are both below this limit, they are probably in metres.
const SHORT_MM: i32 = 5;

/// If all angles and turning speeds of a program are at most this limit, they are probably in radians.
const SMALL_DEGREES: i32 = 6;

/// `VWSetSpeed`
pub fn set_speed(robot: &mut Robot, world: &World, v_mm: i32, omega_degrees: i32) -> i32 {
    hint_at_nan(robot, &[v_mm, omega_degrees]);
    robot.robios.hints.note_drive();
    let outcome = vw::set_twist(robot, world, metres(v_mm), radians(omega_degrees));
    robot.answer_call(Call::VWSetSpeed, 1, outcome)
}

/// `VWGetSpeed`
pub fn speed(robot: &mut Robot, [v, omega]: [&mut Out<i32>; 2]) -> i32 {
    let twist = vw::twist(robot);
    v.set(mm(twist.vx));
    omega.set(degrees(twist.omega));
    0
}

/// `VWSetPosition`
pub fn set_position(robot: &mut Robot, [x_mm, y_mm, phi_degrees]: [i32; 3]) -> i32 {
    let outcome = vw::set_odometry(robot, [metres(x_mm), metres(y_mm), radians(phi_degrees)]);
    robot.answer_call(Call::VWSetPosition, 1, outcome)
}

/// `VWGetPosition`
pub fn position(robot: &mut Robot, out: [&mut Out<i32>; 3]) -> i32 {
    let numbers = pose_numbers(&vw::odometry(robot));
    out.into_iter().zip(numbers).for_each(|(out, number)| out.set(number));
    0
}

/// `VWStraight`: the direction is the sign of `distance_mm`; the sign of the speed is ignored.
pub fn straight(robot: &mut Robot, world: &World, distance_mm: i32, v_mm: i32) -> i32 {
    hint_at_metres(robot, distance_mm, v_mm);
    hint_at_nan(robot, &[distance_mm, v_mm]);
    if distance_mm == 0 && v_mm != 0 {
        robot.hint_at(Mistake::NoLengthInMm);
    }
    let (distance, v) = (metres(distance_mm), metres(v_mm));
    let event = Event::DriveStraight { distance_m: distance, v_m_per_s: v };
    start(robot, world, Call::VWStraight, Twist::new(distance, 0.0), distance / v, event)
}

/// `VWTurn`: the direction is the sign of `angle_degrees`; the sign of the rate is ignored.
pub fn turn(robot: &mut Robot, world: &World, angle_degrees: i32, omega_degrees: i32) -> i32 {
    let is_small = |degrees: i32| (1..=SMALL_DEGREES).contains(&degrees.saturating_abs());
    let is_turn = angle_degrees != 0 && omega_degrees != 0;
    if is_turn && robot.robios.hints.count_turn(is_small(angle_degrees) && is_small(omega_degrees)) {
        robot.hint_at(Mistake::Radians);
    }
    hint_at_nan(robot, &[angle_degrees, omega_degrees]);
    let (angle, omega) = (radians(angle_degrees), radians(omega_degrees));
    let event = Event::DriveTurn { angle_rad: angle, omega_rad_per_s: omega };
    start(robot, world, Call::VWTurn, Twist::new(0.0, angle), angle / omega, event)
}

/// `VWCurve`: forwards or backwards by the sign of `distance_mm`; the sign of the speed is ignored.
pub fn curve(robot: &mut Robot, world: &World, [distance_mm, angle_degrees]: [i32; 2], v_mm: i32) -> i32 {
    hint_at_metres(robot, distance_mm, v_mm);
    hint_at_nan(robot, &[distance_mm, angle_degrees, v_mm]);
    let (distance, angle, v) = (metres(distance_mm), radians(angle_degrees), metres(v_mm));
    let event = Event::DriveCurve { distance_m: distance, angle_rad: angle, v_m_per_s: v };
    start(robot, world, Call::VWCurve, Twist::new(distance, angle), vw::curve_seconds(distance, angle, v), event)
}

/// `VWDrive`: drives an arc that begins straight ahead, or straight back for a negative `dx_mm`.
pub fn drive(robot: &mut Robot, world: &World, [dx_mm, dy_mm]: [i32; 2], v_mm: i32) -> i32 {
    hint_at_metres(robot, dx_mm.saturating_abs().max(dy_mm.saturating_abs()), v_mm);
    hint_at_nan(robot, &[dx_mm, dy_mm, v_mm]);
    let v = metres(v_mm);
    let arc = arc_to([metres(dx_mm), metres(dy_mm)].into());
    let event = Event::DriveCurve { distance_m: arc.vx, angle_rad: arc.omega, v_m_per_s: v };
    start(robot, world, Call::VWDrive, arc, arc.vx / v, event)
}

/// `VWRemain`: the remaining distance in millimetres; for a turn, the remaining angle in degrees.
pub fn remain(robot: &mut Robot) -> i32 {
    let rest = robot.state.motion.drive_remaining(robot.state.now);
    if robot.state.motion.is_drive_turn(robot.state.now) {
        remaining(sim_core::unit::degrees_from_radians(rest))
    } else {
        remaining(sim_core::unit::mm_from_metres(rest))
    }
}

/// `VWDone`
pub fn done(robot: &mut Robot) -> i32 {
    robot.state.motion.is_drive_done(robot.state.now).into()
}

/// `VWWait`
pub fn wait(robot: &mut Robot) -> Poll<i32> {
    vw::wait_for_drive(robot)
}

/// `VWStalled`: 1 for the left wheels, 2 for the right wheels, 3 for both sides.
pub fn stalled(robot: &mut Robot) -> i32 {
    let [front_left, front_right, back_left, back_right] = robot.state.motion.stalled_wheels(robot.state.now);
    i32::from(front_left || back_left) + 2 * i32::from(front_right || back_right)
}

/// `VWControl`: gains in tenths, times in hundredths of a second.
pub fn start_control(robot: &mut Robot, [vv, tv, vw, tw]: [i32; 4]) -> i32 {
    let (gain, seconds) = (|tenths: i32| f64::from(tenths) / 10.0, |hundredths: i32| f64::from(hundredths) / 100.0);
    let outcome = vw::set_gains(robot, Gains { vv: gain(vv), tv: seconds(tv), vw: gain(vw), tw: seconds(tw) });
    robot.answer_call(Call::VWControl, 1, outcome)
}

/// `VWControlOff`
pub fn stop_control(robot: &mut Robot) -> i32 {
    vw::clear_gains(robot);
    0
}

/// Starts a drive that takes |`seconds`|.
fn start(robot: &mut Robot, world: &World, call: Call, displacement: Twist, seconds: f64, event: Event<'_>) -> i32 {
    if call != Call::VWTurn {
        robot.robios.hints.note_drive();
    }
    match vw::start_drive(robot, world, displacement, seconds, (event, Call::VWWait.name())) {
        Ok(()) => 0,
        Err(DriveRefusal::Endless) if displacement.vx == 0.0 && call == Call::VWCurve => {
            robot.refuse_call(call, 1, |_| "a curve takes a length other than 0, `VWTurn` turns on the spot".to_owned())
        }
        Err(DriveRefusal::Endless) => robot.refuse_call(call, 1, |_| {
            "its speed is 0: RoBIOS-7 takes whole mm/s and degrees/s, such as 300; 0.3 becomes 0".to_owned()
        }),
        Err(refusal) => robot.refuse_call(call, 1, |_| refusal.to_string()),
    }
}

/// Gives a hint if a number was NaN in the program: on x86-64, the conversion of NaN to an integer yields the minimum.
fn hint_at_nan(robot: &mut Robot, numbers: &[i32]) {
    if numbers.contains(&i32::MIN) {
        robot.hint_at(Mistake::NoNumber);
    }
}

fn hint_at_metres(robot: &mut Robot, length_mm: i32, v_mm: i32) {
    let is_short = |mm: i32| (1..SHORT_MM).contains(&mm.saturating_abs());
    if is_short(length_mm) && is_short(v_mm) {
        robot.hint_at(Mistake::Metres);
    }
}
