//! Reliable delivery of findings: a queue for each other robot, whose first report is repeated until it is
//! acknowledged.

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use robios_api::{Error, Message, Radio, Result, Robot, RobotNumber};
use serde::{Deserialize, Serialize};

use crate::Map;

/// Time without an acknowledgement after which a report is repeated.
const TIMEOUT: Duration = Duration::from_millis(200);

/// The walls at both sides of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Walls {
    pub left: bool,
    pub right: bool,
}

/// Content of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Report {
    kind: PacketKind,
    lane: u8,
    column: u8,
    walls: Walls,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum PacketKind {
    Found,
    /// Acknowledges the report with the same lane, column and walls.
    Ack,
}

/// A report with its checksum, as it is sent.
#[derive(Debug, Serialize, Deserialize)]
struct Packet {
    report: Report,
    checksum: u16,
}

impl Packet {
    fn new(report: Report) -> Self {
        Self { report, checksum: report.checksum() }
    }
}

impl Report {
    /// CRC-16 of CCITT, which finds every error of up to three bits.
    fn checksum(&self) -> u16 {
        let walls = u8::from(self.walls.left) | u8::from(self.walls.right) << 1;
        [self.kind as u8, self.lane, self.column, walls].into_iter().fold(0xFFFF, |crc, byte| {
            (0..8)
                .fold(crc ^ u16::from(byte) << 8, |crc, _| if crc & 0x8000 == 0 { crc << 1 } else { crc << 1 ^ 0x1021 })
        })
    }
}

/// Connection to the other robots.
pub struct Link {
    radio: Radio,
    queues: BTreeMap<RobotNumber, Queue>,
    repeats: u32,
    garbled: u32,
}

/// Reports that one other robot has not acknowledged yet.
#[derive(Default)]
struct Queue {
    reports: VecDeque<Report>,
    /// Time at which the first report was last sent.
    sent: Option<Duration>,
}

impl Link {
    pub fn new(radio: Radio, others: impl Iterator<Item = RobotNumber>) -> Self {
        Self { radio, queues: others.map(|other| (other, Queue::default())).collect(), repeats: 0, garbled: 0 }
    }

    /// Queues a report for every other robot.
    pub fn queue_report(&mut self, lane: u8, column: u8, walls: Walls) {
        let report = Report { kind: PacketKind::Found, lane, column, walls };
        self.queues.values_mut().for_each(|queue| queue.reports.push_back(report));
    }

    /// Returns true while an acknowledgement is missing.
    pub fn is_unacknowledged(&self) -> bool {
        self.queues.values().any(|queue| !queue.reports.is_empty())
    }

    /// Sends and receives for the time `span`.
    pub fn serve(&mut self, robot: &Robot, span: Duration, map: &mut Map) -> Result {
        self.send_due(robot)?;
        let end = robot.now() + span;
        while let Some(message) = self.radio.receive_within(end.saturating_sub(robot.now()))? {
            self.handle(&message, map)?;
            self.send_due(robot)?;
        }
        Ok(())
    }

    /// Answers until no message has arrived for the time `span`.
    pub fn serve_until_silent(&mut self, robot: &Robot, span: Duration, map: &mut Map) -> Result {
        while let Some(message) = self.radio.receive_within(span)? {
            self.handle(&message, map)?;
            self.send_due(robot)?;
        }
        Ok(())
    }

    pub fn repeats(&self) -> u32 {
        self.repeats
    }

    pub fn garbled(&self) -> u32 {
        self.garbled
    }

    /// Sends the first report of each queue, if it is new or its acknowledgement is overdue.
    fn send_due(&mut self, robot: &Robot) -> Result {
        for (other, queue) in &mut self.queues {
            let Some(report) = queue.reports.front() else { continue };
            if queue.sent.is_none_or(|sent| robot.now() >= sent + TIMEOUT) {
                self.repeats += u32::from(queue.sent.is_some());
                queue.sent = Some(robot.now());
                self.radio.send_as(*other, &Packet::new(*report))?;
            }
        }
        Ok(())
    }

    fn handle(&mut self, message: &Message, map: &mut Map) -> Result {
        let report = match self.radio.decode::<Packet>(message) {
            Ok(packet) if packet.checksum == packet.report.checksum() => packet.report,
            // Garbled: it will be repeated.
            Ok(_) | Err(Error::Garbled { .. }) => {
                self.garbled += 1;
                return Ok(());
            }
            Err(error) => return Err(error),
        };
        match report.kind {
            PacketKind::Found => {
                let lane = map.get_mut(usize::from(report.lane));
                if let Some(cell) = lane.and_then(|lane| lane.get_mut(usize::from(report.column))) {
                    *cell = Some(report.walls);
                }
                self.radio.send_as(message.from, &Packet::new(Report { kind: PacketKind::Ack, ..report }))?;
            }
            PacketKind::Ack => {
                if let Some(queue) = self.queues.get_mut(&message.from)
                    && queue.reports.front() == Some(&Report { kind: PacketKind::Found, ..report })
                {
                    queue.reports.pop_front();
                    queue.sent = None;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_a_bit_are_found() {
        let report = Report { kind: PacketKind::Found, lane: 2, column: 5, walls: Walls { left: true, right: false } };
        let others = [
            Report { kind: PacketKind::Ack, ..report },
            Report { lane: 3, ..report },
            Report { column: 4, ..report },
            Report { walls: Walls { left: true, right: true }, ..report },
        ];
        assert!(others.iter().all(|other| other.checksum() != report.checksum()));
    }
}
