//! Transmissions and their collisions.

use crate::RobotId;
use crate::time::Time;

use super::{OutgoingMessage, RadioModel, SwitchedOff, air_time};

/// A message whose transmission has begun or begins at a known instant.
#[derive(Clone, Debug)]
pub(super) struct Transmission {
    pub message: OutgoingMessage,
    pub begins: Time,
    /// End of the transmission.
    pub ends: Time,
    /// `ends` plus the latency.
    pub arrives: Time,
}

impl Transmission {
    pub fn new(message: OutgoingMessage, begins: Time, model: &RadioModel) -> Self {
        let ends = begins + air_time(message.payload.len(), message.baud);
        Self { message, begins, ends, arrives: ends + model.latency }
    }

    /// Returns true if `off` switches the sender off before the transmission begins.
    pub fn is_stopped_by(&self, off: &SwitchedOff) -> bool {
        self.message.from == off.robot && self.message.sequence <= off.last_sequence && self.begins > off.at
    }

    /// Returns true if this transmission interferes with others at `receiver`: `receiver` sends this transmission or
    /// can hear it.
    fn is_heard_by(&self, receiver: RobotId) -> bool {
        let is_out_of_reach = || self.message.out_of_reach.binary_search_by_key(&receiver, |(robot, _)| *robot).is_ok();
        self.message.from == receiver || !is_out_of_reach()
    }
}

/// All transmissions that can still arrive or collide.
#[derive(Clone, Debug, Default)]
pub(super) struct Air {
    /// Transmissions in order of (begins, sender, sequence); the flag is true once the outcome is decided.
    transmissions: Vec<(Transmission, bool)>,
    /// Duration of the longest transmission so far.
    longest: Time,
}

impl Air {
    pub fn add(&mut self, transmissions: impl IntoIterator<Item = Transmission>) {
        for transmission in transmissions {
            self.longest = self.longest.max(transmission.ends - transmission.begins);
            self.transmissions.push((transmission, false));
        }
        self.transmissions.sort_unstable_by_key(|(it, _)| (it.begins, it.message.from, it.message.sequence));
    }

    /// Removes and returns the transmissions that cannot begin because `off` switched their sender off.
    pub fn stop(&mut self, off: &SwitchedOff) -> impl Iterator<Item = Transmission> {
        self.transmissions
            .extract_if(.., |(transmission, _)| transmission.is_stopped_by(off))
            .map(|(transmission, _)| transmission)
    }

    /// Transmissions that have arrived by `time` and are not yet decided.
    pub fn arrived(&self, time: Time) -> impl Iterator<Item = &Transmission> {
        let is_due =
            move |(transmission, is_decided): &&(Transmission, bool)| !is_decided && transmission.arrives <= time;
        self.transmissions.iter().filter(is_due).map(|(transmission, _)| transmission)
    }

    /// Returns true if another transmission is on the air at `receiver` during this one.
    pub fn is_disturbed(&self, transmission: &Transmission, receiver: RobotId) -> bool {
        self.overlapping(transmission)
            .any(|other| other.message.from != transmission.message.from && other.is_heard_by(receiver))
    }

    /// Transmissions that overlap with this one in time; includes this one.
    fn overlapping(&self, transmission: &Transmission) -> impl Iterator<Item = &Transmission> {
        let end = self.transmissions.partition_point(|(other, _)| other.begins < transmission.ends);
        let start =
            self.transmissions[..end].partition_point(|(other, _)| other.begins + self.longest <= transmission.begins);
        self.transmissions[start..end].iter().map(|(other, _)| other).filter(|other| other.ends > transmission.begins)
    }

    /// Marks transmissions that have arrived by `time` as decided. Removes decided transmissions that can no longer
    /// collide with an undecided transmission or with one that begins at `time` or later.
    pub fn forget(&mut self, time: Time) {
        let mut earliest_begin = time;
        for (transmission, is_decided) in &mut self.transmissions {
            *is_decided |= transmission.arrives <= time;
            if !*is_decided {
                earliest_begin = earliest_begin.min(transmission.begins);
            }
        }
        self.transmissions.retain(|(transmission, is_decided)| !is_decided || transmission.ends > earliest_begin);
    }

    /// Time of the next arrival among the undecided transmissions.
    pub fn next_arrival(&self) -> Time {
        let undecided = self.transmissions.iter().filter(|(_, is_decided)| !is_decided);
        undecided.map(|(transmission, _)| transmission.arrives).fold(Time::NEVER, Time::min)
    }
}
