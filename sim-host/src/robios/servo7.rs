//! Servos of RoBIOS-7: addressed by number, with a range that the program sets.
//!
//! Raw positions are 0 to 255 over the servo's whole swing: our choice. Source: RoBIOS-7 library, servos and motors.

use robios_sys::Robios7Call as Call;
use robios_sys::robios6::hdt_type::HDT_SERVO;
use sim_core::world::World;

use super::robot::Robot;
use super::servo;

/// `SERVOSet`
pub fn set(robot: &mut Robot, world: &World, servo: i32, position: i32) -> i32 {
    let Some((index, position)) = find(robot, Call::SERVOSet, servo, position) else { return 1 };
    let [low, high] = robot.robios.servos.range(index).map(f64::from);
    let raw_position = low + f64::from(position) / 255.0 * (high - low);
    servo::turn(robot, world, index, raw_position.round() as u8);
    0
}

/// `SERVOSetRaw`
pub fn set_raw(robot: &mut Robot, world: &World, servo: i32, position: i32) -> i32 {
    let Some((index, position)) = find(robot, Call::SERVOSetRaw, servo, position) else { return 1 };
    servo::turn(robot, world, index, position);
    0
}

/// `SERVORange`
pub fn set_range(robot: &mut Robot, servo: i32, [low, high]: [i32; 2]) -> i32 {
    let Some((index, low)) = find(robot, Call::SERVORange, servo, low) else { return 1 };
    let Some((_, high)) = find(robot, Call::SERVORange, servo, high) else { return 1 };
    robot.robios.servos.set_range(index, [low, high]);
    0
}

/// `SERVOGet`: position in the scale of `SERVOSet`, for the current range.
pub fn position(robot: &mut Robot, servo: i32) -> i32 {
    let Some(index) = robot.find_numbered(Call::SERVOGet, HDT_SERVO, servo, &[]) else {
        return robot.fail_call(Call::SERVOGet, -1);
    };
    let [low, high] = robot.robios.servos.range(index).map(f64::from);
    let raw_position = f64::from(robot.devices.servos.position(index));
    let position = if low == high { raw_position } else { 255.0 * (raw_position - low) / (high - low) };
    position.round().clamp(0.0, 255.0) as i32
}

/// Index of a servo, and `number` as a position; `None` if either is invalid, which is counted as a failure.
fn find(robot: &mut Robot, call: Call, servo: i32, number: i32) -> Option<(usize, u8)> {
    let Some(index) = robot.find_numbered(call, HDT_SERVO, servo, &[]) else {
        robot.fail_call(call, 1);
        return None;
    };
    let Ok(number) = u8::try_from(number) else {
        robot.refuse_call(call, 1, |_| format!("a position is 0 to 255, not {number}"));
        return None;
    };
    Some((index, number))
}
