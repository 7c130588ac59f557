//! The radio of RoBIOS-7: messages of text with a final 0.
//!
//! Source: RoBIOS-7 library, radio communication; that 0 is the broadcast address is our choice.

use robios_sys::{Out, OutBytes, OutInts, Robios7Call as Call};
use sim_core::radio::BUFFER_BYTES;
use sim_core::world::World;

use super::caller::Poll;
use super::robot::{Robot, WaitReason};
use super::{os7, radio};

/// Maximum length of a text in bytes, without the final 0, which takes one byte of the buffer.
const MAX_TEXT: usize = BUFFER_BYTES - 1;

/// Return value of a call that fails.
const FAILURE: i32 = 1;

/// `RADIOInit`
pub fn init(robot: &mut Robot, world: &World) -> i32 {
    let address = robot.id.0;
    radio::init(robot, world, Call::RADIOInit, FAILURE, address, world.radio().model().baud)
}

/// `RADIORelease`
pub fn release(robot: &mut Robot) -> i32 {
    radio::release(robot, Call::RADIORelease, FAILURE)
}

/// `RADIOSend`
pub fn send(robot: &mut Robot, world: &World, id: i32, text: Option<&[u8]>) -> i32 {
    let payload = match text {
        None => Err("no text".to_owned()),
        Some(text) if text.len() > MAX_TEXT => {
            Err(format!("the text has {} bytes, a message has at most {MAX_TEXT}", text.len()))
        }
        Some(_) if id < 0 => Err(format!("{id} is not an address, accepted: 0 for everybody, the number of a robot")),
        Some(text) => Ok(text),
    };
    radio::send(robot, world, Call::RADIOSend, id.unsigned_abs(), payload)
}

/// `RADIOReceive`: ends the text at the first 0 received, and truncates it so that the final 0 fits into the buffer.
pub fn receive(robot: &mut Robot, id: &mut Out<i32>, text: &mut OutBytes) -> Poll<i32> {
    if text.capacity() == 0 {
        return Poll::Ready(
            robot.refuse_call(Call::RADIOReceive, FAILURE, |_| "no buffer, or no room in it".to_owned()),
        );
    }
    radio::receive(robot, Call::RADIOReceive, FAILURE, |message| {
        id.set(i32::try_from(message.address).unwrap_or(i32::MAX));
        let received = message.payload.split(|byte| *byte == 0).next().unwrap_or_default();
        text.set(&os7::terminated(received, text.capacity()));
    })
}

/// `RADIOStatus`: addresses of the stations that were on at the slot's start. The station of a robot that has switched
/// it on in this slot waits for the slot's end, so that robots that start together find each other.
pub fn status(robot: &mut Robot, world: &World, addresses: &mut OutInts) -> Poll<i32> {
    if addresses.is_null() {
        let reason = |_: &_| "the pointer for the addresses is null".to_owned();
        return Poll::Ready(robot.refuse_call(Call::RADIOStatus, 0, reason));
    }
    let Some(own) = robot.radio_member() else {
        return Poll::Ready(radio::refuse_while_off(robot, Call::RADIOStatus, 0));
    };
    let members = world.radio().members();
    let is_listed = members.iter().any(|member| member.robot == own.robot);
    if !is_listed && !robot.timers.in_callback {
        return Poll::Pending { at: world.slot_end(), reason: WaitReason::Time(world.slot_end()) };
    }
    let others = members.iter().filter(|member| member.robot != own.robot);
    let mut members: Vec<_> = others.chain([&own]).collect();
    members.sort_unstable_by_key(|member| member.robot);
    let found: Vec<i32> = members.iter().map(|member| i32::try_from(member.address).unwrap_or(i32::MAX)).collect();
    Poll::Ready(addresses.set(&found) as i32)
}
