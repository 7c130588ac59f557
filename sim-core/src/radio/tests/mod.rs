//! Tests of channel and stations: statistics of errors and collisions, random schedules compared with an oracle, the
//! token ring, edge cases.

mod aloha;
mod cases;
mod errors;
mod oracle;
mod ring;
mod schedules;

use super::*;
use crate::noise::RadioNoise;

/// A message from robot `from`, whose address is the robot's number, queued and transmitted at `queued_at`.
fn message_from(from: u32, sequence: u64, to: Address, payload: Vec<u8>, queued_at: Time) -> OutgoingMessage {
    OutgoingMessage {
        from: RobotId(from),
        address: from,
        sequence,
        to,
        payload,
        queued_at,
        begins: Some(queued_at),
        baud: BAUD,
        out_of_reach: Vec::new(),
    }
}

const BAUD: u32 = 115_200;

/// A channel with the stations of the robots 1 to `members`; the address of each is the robot's number.
fn channel(model: RadioModel, errors: Vec<RadioNoise>, members: u32) -> Channel {
    let mut channel = Channel::new(model, 42, errors);
    for robot in 1..=members {
        channel
            .set_member(RobotId(robot), Some(StationInfo { robot: RobotId(robot), address: robot, baud: model.baud }));
    }
    channel
}
