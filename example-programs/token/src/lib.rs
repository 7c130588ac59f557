//! A token goes round a ring of robots over a radio that loses messages: stop-and-wait.
//!
//! The holder sends the token to the next robot until that robot acknowledges it. A token carries the number of its
//! hop, so receivers recognise duplicates. Arguments: number of robots, at least 2, and number of rounds. `token-c` is
//! the same program in C and interoperates.

use std::error::Error;

use robios_api::prelude::*;
use robios_api::{Radio, RobotNumber};

robios_api::program!(main);

/// Time without an answer after which a token is sent again.
const TIMEOUT: Duration = Duration::from_millis(60);
/// Time without a message after which a robot ends. Until then it answers, since an acknowledgement may have been lost.
const LINGER: Duration = Duration::from_secs(3);

/// Message of the protocol, with the number of the hop.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Packet {
    Token(u32),
    Ack(u32),
}

impl Packet {
    fn to_bytes(self) -> [u8; 5] {
        let (kind, [a, b, c, d]) = match self {
            Self::Token(hop) => (b'T', hop.to_le_bytes()),
            Self::Ack(hop) => (b'A', hop.to_le_bytes()),
        };
        [kind, a, b, c, d]
    }

    fn from_bytes(bytes: &[u8]) -> Option<Self> {
        match *bytes {
            [b'T', a, b, c, d] => Some(Self::Token(u32::from_le_bytes([a, b, c, d]))),
            [b'A', a, b, c, d] => Some(Self::Ack(u32::from_le_bytes([a, b, c, d]))),
            _ => None,
        }
    }
}

/// A robot of the ring.
struct Station {
    radio: Radio,
    previous: RobotNumber,
    next: RobotNumber,
    /// Number of the last hop received here.
    last_received: u32,
    retransmissions: u32,
}

impl Station {
    fn take(&mut self, hop: u32) -> Result {
        while self.last_received < hop {
            let message = self.radio.receive()?;
            self.handle(&message.bytes)?;
        }
        Ok(())
    }

    fn pass(&mut self, hop: u32) -> Result {
        loop {
            self.radio.send(self.next, &Packet::Token(hop).to_bytes())?;
            while let Some(message) = self.radio.receive_within(TIMEOUT)? {
                // The token may return before our own transmission is acknowledged.
                if self.handle(&message.bytes)? == Some(hop) || self.last_received > hop {
                    return Ok(());
                }
            }
            self.retransmissions += 1;
        }
    }

    /// Handles a message: acknowledges a token; returns the hop of an acknowledgement.
    fn handle(&mut self, message: &[u8]) -> Result<Option<u32>> {
        match Packet::from_bytes(message) {
            Some(Packet::Token(hop)) => {
                // A duplicate is acknowledged too, since the first acknowledgement was lost.
                self.radio.send(self.previous, &Packet::Ack(hop).to_bytes())?;
                self.last_received = self.last_received.max(hop);
                Ok(None)
            }
            Some(Packet::Ack(hop)) => Ok(Some(hop)),
            None => Ok(None),
        }
    }
}

fn main(robot: &Robot) -> Result<(), Box<dyn Error>> {
    let number = |index: usize, default: u32| robot.arguments().get(index).map_or(Ok(default), |it| it.parse::<u32>());
    let (robots, rounds) = (number(0, 2)?, number(1, 10)?);
    if robots < 2 {
        return Err(format!("`{robots}` robots: expected a number of at least 2").into());
    }
    let me = u32::from(robot.id().0);
    let address = |number: u32| u8::try_from(number).map(RobotNumber);
    let mut station = Station {
        radio: robot.radio()?,
        previous: address((me + robots - 2) % robots + 1)?,
        next: address(me % robots + 1)?,
        last_received: 0,
        retransmissions: 0,
    };
    for round in 0..rounds {
        if me == 1 {
            station.pass(round * robots + 1)?;
            station.take((round + 1) * robots)?;
        } else {
            station.take(round * robots + me - 1)?;
            station.pass(round * robots + me)?;
        }
    }
    writeln!(robot.console(), "{rounds} rounds, {} repeats", station.retransmissions);

    while let Some(message) = station.radio.receive_within(LINGER)? {
        station.handle(&message.bytes)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use robios_api::fake::Fake;

    #[test]
    fn packets_survive_a_round_trip() {
        for packet in [Packet::Token(0), Packet::Token(0x0102_0304), Packet::Ack(u32::MAX)] {
            assert_eq!(Packet::from_bytes(&packet.to_bytes()), Some(packet));
        }
        assert_eq!(Packet::from_bytes(b"Tab"), None);
        assert_eq!(Packet::from_bytes(b"X1234"), None);
    }

    #[test]
    fn a_ring_has_at_least_two_robots() {
        let run = Fake::new().argument("0").run(main);
        assert_eq!(run.expect_failed(), "`0` robots: expected a number of at least 2");
    }

    /// The other robot of two: it loses messages, acknowledges the others, and returns the token.
    #[test]
    fn a_token_is_sent_until_it_is_acknowledged() {
        let mut count = 0;
        let fake = Fake::new().argument("2").argument("5").answer(move |sent| {
            count += 1;
            match Packet::from_bytes(&sent.bytes)? {
                Packet::Token(hop) if count % 3 != 0 => {
                    let bytes = Packet::Ack(hop).to_bytes().to_vec();
                    Some((30.millis(), robios_api::Message { from: sent.to, bytes }))
                }
                _ => None,
            }
        });
        let fake = (1..=5).fold(fake, |fake, round: u32| {
            fake.message(Duration::from_secs(2 * u64::from(round)), RobotNumber(2), Packet::Token(2 * round).to_bytes())
        });
        let run = fake.run(main).expect_finished();
        let tokens = run.sent().iter().filter(|sent| sent.bytes[0] == b'T').count();
        assert_eq!(run.console(), format!("5 rounds, {} repeats\n", tokens - 5));
        assert!(tokens > 5, "some were lost");
        let acks = run.sent().iter().filter_map(|sent| Packet::from_bytes(&sent.bytes));
        let acks: Vec<Packet> = acks.filter(|packet| matches!(packet, Packet::Ack(_))).collect();
        assert_eq!(acks, [2, 4, 6, 8, 10].map(Packet::Ack));
    }
}
