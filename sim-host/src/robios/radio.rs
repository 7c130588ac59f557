//! Radio functions of both generations: switching on and off, sending, waiting for a message.
//!
//! A robot sends and receives through its own station; messages reach the other stations at the slot's end, see
//! [`sim_core::simulation::Environment`]. Sources: RoBIOS 6 library, radio communication; RoBIOS-7 library, radio
//! communication.

use robios_sys::robios6::{BROADCAST, RadioIOParameters};
use sim_core::RobotId;
use sim_core::radio::{Address, ReceivedMessage};
use sim_core::world::World;

use super::call::Call;
use super::caller::Poll;
use super::hint::Mistake;
use super::robot::{Robot, WaitReason};

/// Radio settings and counters of a program.
#[derive(Clone, Debug, Default)]
pub struct Radio {
    /// Settings made by `RADIOSetIoctl`.
    pub settings: Option<RadioIOParameters>,
    /// Number of messages that the program has sent.
    pub sent: i32,
    /// Number of messages that the program has received.
    pub received: i32,
}

/// `RADIOInit`: switches on the station `address`, which sends at `baud`.
pub fn init(robot: &mut Robot, world: &World, call: impl Into<Call>, failure: i32, address: u32, baud: u32) -> i32 {
    if robot.radio_member().is_some() {
        return robot.refuse_call(call, failure, |_| "the radio is on already".to_owned());
    }
    robot.switch_radio_on(world, address, baud);
    0
}

/// `RADIOTerm`, `RADIORelease`
pub fn release(robot: &mut Robot, call: impl Into<Call>, failure: i32) -> i32 {
    if robot.radio_member().is_none() {
        return refuse_while_off(robot, call, failure);
    }
    switch_off(robot);
    0
}

/// Refuses a call that requires the radio to be on.
pub fn refuse_while_off(robot: &mut Robot, call: impl Into<Call>, failure: i32) -> i32 {
    robot.refuse_call(call, failure, |_| "the radio is off: `RADIOInit` switches it on".to_owned())
}

/// Switches the radio off; returns the number of messages that are not transmitted, if it is known. In RoBIOS-7 messages
/// that were sent are still transmitted, as in EyeSim VR, unless the robot was removed or has failed.
fn switch_off(robot: &mut Robot) -> Option<usize> {
    let is_retired = robot.robios.is_of_robios7() && !(robot.is_removed || robot.is_halted);
    let unsent = if is_retired { robot.retire_radio() } else { robot.switch_radio_off() };
    robot.tasks.recheck_radio(robot.state.now);
    unsent
}

/// `RADIOSend`
pub fn send(robot: &mut Robot, world: &World, call: impl Into<Call>, to: u32, payload: Result<&[u8], String>) -> i32 {
    const FAILURE: i32 = 1;
    if robot.radio_member().is_none() {
        return refuse_while_off(robot, call, FAILURE);
    }
    let payload = match payload {
        Ok(payload) => payload,
        Err(reason) => return robot.refuse_call(call, FAILURE, |_| reason),
    };
    if !is_known(robot, world, to) {
        let text = format!("`RADIOSend` to {to}: no other robot has this address, no robot receives the message");
        robot.hint_once(Mistake::UnknownAddress, &text);
    }
    let to = if to == BROADCAST as u32 { Address::All } else { Address::One(to) };
    if robot.send_message(world, to, payload).is_err() {
        return robot.fail_call(call, FAILURE);
    }
    robot.robios.radio.sent = robot.robios.radio.sent.saturating_add(1);
    0
}

/// Returns true for the broadcast address, and for the address of another robot.
fn is_known(robot: &Robot, world: &World, address: u32) -> bool {
    let is_own = robot.radio_member().is_some_and(|member| member.address == address);
    let is_number = address > 0 && world.is_robot_present(RobotId(address), robot.now);
    let is_on = || world.radio().members().iter().any(|member| member.address == address);
    address == BROADCAST as u32 || !is_own && (is_number || is_on())
}

/// `RADIOCheck`
pub fn check(robot: &mut Robot, call: impl Into<Call>) -> i32 {
    if robot.radio_member().is_none() {
        return refuse_while_off(robot, call, 0);
    }
    robot.radio_waiting() as i32
}

/// Waits for a message, which `deliver` passes to the program.
pub fn receive(
    robot: &mut Robot,
    call: impl Into<Call>,
    failure: i32,
    deliver: impl FnOnce(&ReceivedMessage),
) -> Poll<i32> {
    let now = robot.now;
    robot.settle_radio(now);
    if robot.radio_member().is_none() {
        return Poll::Ready(refuse_while_off(robot, call, failure));
    }
    let Some(message) = robot.receive_message() else {
        return Poll::Pending { at: robot.next_message(), reason: WaitReason::Message };
    };
    robot.robios.radio.received = robot.robios.radio.received.saturating_add(1);
    deliver(&message);
    Poll::Ready(0)
}

/// Switches the radio off when the program ends.
pub fn end(robot: &mut Robot) {
    let unsent = switch_off(robot);
    if !(robot.is_removed || robot.is_halted) {
        robot.state.end_radio(unsent);
    }
}
