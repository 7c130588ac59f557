//! The radio of RoBIOS 6: messages of bytes, and its settings.
//!
//! Source: RoBIOS 6 library, radio communication; the fields of the status are our choice.

use robios_sys::robios6::{
    MAXMSGLEN, RadioIOParameters, RadioStatus, SER9600, SER19200, SER38400, SER57600, SER115200, SERIAL1, SERIAL3,
};
use robios_sys::{Out, OutBytes, Robios6Call as Call};
use sim_core::world::World;

use super::caller::Poll;
use super::robot::Robot;
use super::{os, radio};

/// Rates of the radio.
const RATES: [i32; 5] = [SER9600, SER19200, SER38400, SER57600, SER115200];

/// Return value of a call that fails.
const FAILURE: i32 = -1;

/// `RADIOInit`
pub fn init(robot: &mut Robot, world: &World) -> i32 {
    let settings = settings(robot, world);
    radio::init(robot, world, Call::RADIOInit, FAILURE, settings.id as u32, settings.speed as u32)
}

/// `RADIOTerm`
pub fn release(robot: &mut Robot) -> i32 {
    radio::release(robot, Call::RADIOTerm, FAILURE)
}

/// `RADIOSend`
pub fn send(robot: &mut Robot, world: &World, id: u8, buffer: Option<&[u8]>) -> i32 {
    let payload = match buffer {
        Some(bytes) if bytes.len() <= MAXMSGLEN as usize => Ok(bytes),
        Some(_) => Err(format!("the message is longer than MAXMSGLEN, {MAXMSGLEN} bytes")),
        None => Err("no buffer, or a negative number of bytes".to_owned()),
    };
    radio::send(robot, world, Call::RADIOSend, id.into(), payload)
}

/// `RADIORecv`: bytes beyond the buffer's capacity are lost.
pub fn receive(robot: &mut Robot, id: &mut Out<u8>, received: &mut Out<i32>, buffer: &mut OutBytes) -> Poll<i32> {
    if buffer.is_null() {
        return Poll::Ready(robot.refuse_call(Call::RADIORecv, FAILURE, |_| "no buffer".to_owned()));
    }
    radio::receive(robot, Call::RADIORecv, FAILURE, |message| {
        id.set(message.address as u8);
        received.set(buffer.set(&message.payload) as i32);
    })
}

/// `RADIOGetIoctl`
pub fn get_settings(robot: &mut Robot, world: &World, parameters: &mut Out<RadioIOParameters>) -> i32 {
    if parameters.is_null() {
        return robot.refuse_call(Call::RADIOGetIoctl, FAILURE, |_| "the pointer for the settings is null".to_owned());
    }
    parameters.set(settings(robot, world));
    0
}

/// `RADIOSetIoctl`
pub fn set_settings(robot: &mut Robot, world: &World, parameters: Option<&RadioIOParameters>) -> i32 {
    let outcome = checked_settings(robot, world, parameters);
    if let Ok(settings) = outcome {
        robot.robios.radio.settings = Some(settings);
    }
    robot.answer_call(Call::RADIOSetIoctl, FAILURE, outcome.map(drop))
}

/// `RADIOGetStatus`
pub fn status(robot: &mut Robot, status: &mut Out<RadioStatus>) -> i32 {
    if status.is_null() {
        return robot.refuse_call(Call::RADIOGetStatus, FAILURE, |_| "the pointer for the status is null".to_owned());
    }
    let Some(member) = robot.radio_member() else {
        return radio::refuse_while_off(robot, Call::RADIOGetStatus, FAILURE);
    };
    let waiting = robot.radio_waiting() as i32;
    let radio::Radio { sent, received, .. } = robot.robios.radio;
    status.set(RadioStatus { id: member.address as i32, sent, received, waiting });
    0
}

/// Settings that the program has made, or the defaults of the robot.
fn settings(robot: &Robot, world: &World) -> RadioIOParameters {
    robot.robios.radio.settings.unwrap_or_else(|| RadioIOParameters {
        interface: SERIAL1,
        speed: i32::try_from(world.radio().model().baud).unwrap_or(i32::MAX),
        id: os::machine_id(robot).into(),
        remote_on: 0,
        image_transfer: 0,
        debug: 0,
    })
}

/// Checks the settings that the program requests.
fn checked_settings(
    robot: &Robot,
    world: &World,
    parameters: Option<&RadioIOParameters>,
) -> Result<RadioIOParameters, String> {
    let Some(requested) = parameters else { return Err("no settings".to_owned()) };
    if robot.radio_member().is_some() {
        return Err("the radio is on: its settings can be changed only before `RADIOInit`".to_owned());
    }
    let RadioIOParameters { interface, speed, id, remote_on, image_transfer, debug } = *requested;
    let current = settings(robot, world);
    let checks = [
        ((SERIAL1..=SERIAL3).contains(&interface), "interface", interface, "SERIAL1 to SERIAL3"),
        (RATES.contains(&speed) || speed == current.speed, "speed", speed, "SER9600 to SER115200"),
        ((1..=255).contains(&id) || id == current.id, "id", id, "1 to 255"),
        ((0..=1).contains(&remote_on), "remoteOn", remote_on, "0 or 1"),
        ((0..=2).contains(&image_transfer), "imageTransfer", image_transfer, "0, 1 or 2"),
        ((0..=100).contains(&debug), "debug", debug, "0 to 100"),
    ];
    match checks.iter().find(|(is_valid, ..)| !is_valid) {
        Some((_, name, value, expected)) => Err(format!("{name} is {value}, expected {expected}")),
        None => Ok(*requested),
    }
}
