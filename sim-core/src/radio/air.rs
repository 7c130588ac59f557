//! What is on the air, and what meets there.

use crate::RobotId;
use crate::time::Time;

use super::{Model, Off, Sending, air_time};

/// A message whose transmission has begun, or begins at a known instant.
#[derive(Clone, Debug)]
pub(super) struct Flight {
    pub sending: Sending,
    pub begins: Time,
    /// End of the transmission.
    pub ends: Time,
    /// `ends` and the latency.
    pub arrives: Time,
}

impl Flight {
    pub fn new(sending: Sending, begins: Time, model: &Model) -> Self {
        let ends = begins + air_time(sending.payload.len(), sending.baud);
        Self { sending, begins, ends, arrives: ends + model.latency }
    }

    /// True if `off` comes before it has begun.
    pub fn is_stopped_by(&self, off: &Off) -> bool {
        self.sending.from == off.robot && self.sending.sequence <= off.last_sequence && self.begins > off.at
    }

    /// True if `receiver` has this on its ears while another message comes: it sends it, or is within its reach.
    fn is_heard_by(&self, receiver: RobotId) -> bool {
        let is_far = || self.sending.out_of_reach.binary_search_by_key(&receiver, |(robot, _)| *robot).is_ok();
        self.sending.from == receiver || !is_far()
    }
}

/// All transmissions that still matter.
#[derive(Clone, Debug, Default)]
pub(super) struct Air {
    /// In order of (begins, sender, sequence), each with true once it is decided.
    flights: Vec<(Flight, bool)>,
    /// No transmission so far took longer.
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

    /// Takes away what `off` stops.
    pub fn stop(&mut self, off: &Off) -> impl Iterator<Item = Flight> {
        self.flights.extract_if(.., |(flight, _)| flight.is_stopped_by(off)).map(|(flight, _)| flight)
    }

    /// What has arrived by `time` and is not yet decided.
    pub fn arrived(&self, time: Time) -> impl Iterator<Item = &Flight> {
        let due = move |(flight, is_decided): &&(Flight, bool)| !is_decided && flight.arrives <= time;
        self.flights.iter().filter(due).map(|(flight, _)| flight)
    }

    /// True if another transmission is on the air at `receiver` during this one.
    pub fn disturbs(&self, flight: &Flight, receiver: RobotId) -> bool {
        self.beside(flight).any(|other| other.sending.from != flight.sending.from && other.is_heard_by(receiver))
    }

    /// The others that are on the air for some of the time that this one is.
    fn beside(&self, flight: &Flight) -> impl Iterator<Item = &Flight> {
        let end = self.flights.partition_point(|(other, _)| other.begins < flight.ends);
        let start = self.flights[..end].partition_point(|(other, _)| other.begins + self.longest <= flight.begins);
        self.flights[start..end].iter().map(|(other, _)| other).filter(|other| other.ends > flight.begins)
    }

    /// What has arrived by `time` is decided; forgets what can meet nothing that is not, nor what begins from then on.
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

    /// When the next one arrives that is not decided.
    pub fn next_arrival(&self) -> Time {
        let open = self.flights.iter().filter(|(_, is_decided)| !is_decided);
        open.map(|(flight, _)| flight.arrives).fold(Time::NEVER, Time::min)
    }
}
