//! Tests of channel and stations: statistics of errors and collisions, random schedules against an oracle, the ring,
//! hard cases.

mod aloha;
mod cases;
mod errors;
mod oracle;
mod ring;
mod schedules;

use super::*;
use crate::noise::RadioNoise;

/// A message from robot `from`, whose address is its own number.
fn sending(from: u32, sequence: u64, to: Address, payload: Vec<u8>, sent: Time) -> SentMessage {
    SentMessage {
        from: RobotId(from),
        address: from,
        sequence,
        to,
        payload,
        sent,
        begins: Some(sent),
        baud: BAUD,
        out_of_reach: Vec::new(),
    }
}

const BAUD: u32 = 115_200;

/// A channel with the members 1 to `members`, each with its number as its address.
fn channel(model: RadioModel, errors: Vec<RadioNoise>, members: u32) -> Channel {
    let mut channel = Channel::new(model, 42, errors);
    for robot in 1..=members {
        channel
            .set_member(RobotId(robot), Some(StationInfo { robot: RobotId(robot), address: robot, baud: model.baud }));
    }
    channel
}
