//! Transmissions on the air and their collisions.

use crate::RobotId;
use crate::time::Time;

use super::{Model, Off, Sending, air_time};

/// A message whose transmission has begun or begins at a known instant.
#[derive(Clone, Debug)]
pub(super) struct Flight {
    pub sending: Sending,
    pub begins: Time,
    /// End of the transmission.
    pub ends: Time,
    /// `ends` plus the latency.
    pub arrives: Time,
}

impl Flight {
    pub fn new(sending: Sending, begins: Time, model: &Model) -> Self {
        let ends = begins + air_time(sending.payload.len(), sending.baud);
        Self { sending, begins, ends, arrives: ends + model.latency }
    }

    /// Returns true if the station is switched off before the transmission begins.
    pub fn is_stopped_by(&self, off: &Off) -> bool {
        self.sending.from == off.robot && self.sending.sequence <= off.last_sequence && self.begins > off.at
    }

    /// Returns true if this transmission disturbs others at `receiver`, which is its sender or within its reach.
    fn is_heard_by(&self, receiver: RobotId) -> bool {
        let is_far = || self.sending.out_of_reach.binary_search_by_key(&receiver, |(robot, _)| *robot).is_ok();
        self.sending.from == receiver || !is_far()
    }
}

/// All transmissions that can still arrive or collide.
#[derive(Clone, Debug, Default)]
pub(super) struct Air {
    /// In order of (begins, sender, sequence); the flag is true once the outcome is decided.
    flights: Vec<(Flight, bool)>,
    /// Duration of the longest transmission so far.
    longest: Time,
}

impl Air {
    pub fn add(&mut self, flights: impl IntoIterator<Item = Flight>) {
        for flight in flights {
            self.longest = self.longest.max(flight.ends - flight.begins);
            self.flights.push((flight, false));
        }
        self.flights.sort_by_key(|(it, _)| (it.begins, it.sending.from, it.sending.sequence));
    }

    /// Removes and returns the transmissions that `off` prevents.
    pub fn stop(&mut self, off: &Off) -> impl Iterator<Item = Flight> {
        self.flights.extract_if(.., |(flight, _)| flight.is_stopped_by(off)).map(|(flight, _)| flight)
    }

    /// Transmissions that have arrived by `time` and are not yet decided.
    pub fn arrived(&self, time: Time) -> impl Iterator<Item = &Flight> {
        let due = move |(flight, is_decided): &&(Flight, bool)| !is_decided && flight.arrives <= time;
        self.flights.iter().filter(due).map(|(flight, _)| flight)
    }

    /// Returns true if another transmission is on the air at `receiver` during this one.
    pub fn disturbs(&self, flight: &Flight, receiver: RobotId) -> bool {
        self.beside(flight).any(|other| other.sending.from != flight.sending.from && other.is_heard_by(receiver))
    }

    /// Other transmissions that overlap with this one in time.
    fn beside(&self, flight: &Flight) -> impl Iterator<Item = &Flight> {
        let end = self.flights.partition_point(|(other, _)| other.begins < flight.ends);
        let start = self.flights[..end].partition_point(|(other, _)| other.begins + self.longest <= flight.begins);
        self.flights[start..end].iter().map(|(other, _)| other).filter(|other| other.ends > flight.begins)
    }

    /// Marks transmissions that have arrived by `time` as decided, and drops those that can collide neither with an undecided one nor
    /// with one that begins at `time` or later.
    pub fn forget(&mut self, time: Time) {
        let mut oldest = time;
        for (flight, is_decided) in &mut self.flights {
            *is_decided |= flight.arrives <= time;
            if !*is_decided {
                oldest = oldest.min(flight.begins);
            }
        }
        self.flights.retain(|(flight, is_decided)| !is_decided || flight.ends > oldest);
    }

    /// Time of the next arrival that is not decided.
    pub fn next_arrival(&self) -> Time {
        let open = self.flights.iter().filter(|(_, is_decided)| !is_decided);
        open.map(|(flight, _)| flight.arrives).fold(Time::NEVER, Time::min)
    }
}
