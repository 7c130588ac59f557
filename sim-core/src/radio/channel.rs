//! Channel: transport of messages between sending and receiving.

use crate::RobotId;
use crate::noise::{Purpose, Radio, Stream};
use crate::time::Time;

use super::air::{Air, Flight};
use super::ring::Ring;
use super::{Address, Arrived, Change, Delivery, Loss, Medium, Member, Model, Off, Sending};

/// The channel between all robots of a run.
///
/// At the end of a slot the caller reports the stations that were switched ([`Channel::change`]), then the messages that were sent
/// ([`Channel::exchange`]). `exchange` must be called at the end of each slot in which a station was switched or sent, and of the
/// slot that contains [`Channel::due`]; other slots may be skipped.
#[derive(Clone, Debug)]
pub struct Channel {
    model: Model,
    seed: u64,
    /// Noise models of the receivers, in the order of their ids; receivers beyond the end have no errors.
    errors: Vec<Radio>,
    /// Stations that are on, in the order of their robots.
    members: Vec<Member>,
    /// The addresses of the members as (address, robot), in this order.
    addresses: Vec<(u32, RobotId)>,
    has_changed: bool,
    /// Stations switched off since the last exchange.
    offs: Vec<Off>,
    air: Air,
    ring: Ring,
    /// Transmissions of the ring in progress: (end, sender, number), in the order of time.
    leaving: Vec<(Time, RobotId, u64)>,
    left: Vec<(RobotId, u64)>,
    due: Time,
}

impl Default for Channel {
    fn default() -> Self {
        Self::new(Model::default(), 0, Vec::new())
    }
}

impl Channel {
    /// Channel of a run with `seed`; `errors` in the order of the receivers' ids.
    pub fn new(model: Model, seed: u64, errors: Vec<Radio>) -> Self {
        Self {
            model,
            seed,
            errors,
            members: Vec::new(),
            addresses: Vec::new(),
            has_changed: false,
            offs: Vec::new(),
            air: Air::default(),
            ring: Ring::new(seed),
            leaving: Vec::new(),
            left: Vec::new(),
            due: Time::NEVER,
        }
    }

    /// Model of the medium.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Stations that were on at the start of the slot, in the order of their robots.
    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// Reports that a station was switched in the present slot.
    pub fn change(&mut self, change: Change) {
        self.set_member(change.robot, change.member);
        self.offs.extend(change.offs);
    }

    /// Sets the station of `robot` from the end of the present slot on; `None` is off.
    pub fn set_member(&mut self, robot: RobotId, member: Option<Member>) {
        let place = self.members.binary_search_by_key(&robot, |member| member.robot);
        if let Ok(place) = place {
            let known = (self.members.remove(place).address, robot);
            self.addresses.retain(|it| *it != known);
        }
        if let Some(member) = member {
            let place = place.unwrap_or_else(|place| place);
            self.members.insert(place, Member { robot, ..member });
            let known = (member.address, robot);
            self.addresses.insert(self.addresses.partition_point(|it| *it < known), known);
        }
        self.has_changed = true;
    }

    /// Sets the noise model of messages to `robot`, from the present slot on. For the tokens of a token ring it applies from the end of
    /// the slot on.
    pub fn set_errors(&mut self, robot: RobotId, errors: Radio) {
        if self.errors.len() <= robot.index() {
            self.errors.resize(robot.index() + 1, Radio::default());
        }
        self.errors[robot.index()] = errors;
        self.has_changed |= self.model.medium == Medium::TokenRing;
    }

    /// Takes the messages sent in the slot that ends at `slot_end`, in any order, and returns the deliveries that are decided by then,
    /// in order of (visible, receiver, arrives, sender, sequence).
    pub fn exchange(&mut self, slot_end: Time, mut sendings: Vec<Sending>) -> Vec<Delivery> {
        sendings.sort_by_key(|sending| (sending.from, sending.sequence));
        let mut deliveries = self.send(slot_end, sendings);
        let until = if self.model.medium == Medium::Free { Time::NEVER } else { slot_end };
        for flight in self.air.arrived(until) {
            self.decide(slot_end, flight, &mut deliveries);
        }
        self.air.forget(until);
        self.settle_dues(slot_end);
        deliveries.sort_by_key(|it| (it.visible, it.to, it.arrives, it.from, it.sequence));
        deliveries
    }

    /// Next time at which the channel has something to decide even if nobody sends: the slot that contains this instant must be run.
    /// [`Time::NEVER`] for nothing, [`Time::ZERO`] after a station was switched.
    pub fn due(&self) -> Time {
        if self.has_changed { Time::ZERO } else { self.due }
    }

    /// Ends the run: returns the undecided messages as losses to their senders, in order of (sender, sequence).
    pub fn finish(&mut self, end: Time) -> Vec<Delivery> {
        let air = std::mem::take(&mut self.air);
        let mut flights: Vec<Flight> = air.arrived(Time::NEVER).cloned().collect();
        flights.extend(self.ring.take_queued().into_iter().map(|sending| Flight::new(sending, end, &self.model)));
        flights.sort_by_key(|flight| (flight.sending.from, flight.sending.sequence));
        self.due = Time::NEVER;
        let fate = |flight: &Flight| Delivery { visible: end, ..lost(flight, flight.sending.from, end, Loss::End) };
        flights.iter().map(fate).collect()
    }

    /// Messages that left the buffers of their senders since the last call, as (sender, number), for [`super::Station::has_left`];
    /// only of a medium that decides when to send (token ring).
    pub fn take_left(&mut self) -> Vec<(RobotId, u64)> {
        std::mem::take(&mut self.left)
    }

    /// Puts messages on the air; returns those that are never transmitted.
    fn send(&mut self, slot_end: Time, sendings: Vec<Sending>) -> Vec<Delivery> {
        let offs = std::mem::take(&mut self.offs);
        let has_changed = std::mem::take(&mut self.has_changed);
        let model = self.model;
        let unsent = |flight: &Flight| Delivery {
            visible: slot_end,
            ..lost(flight, flight.sending.from, slot_end, Loss::Unsent)
        };
        match self.model.medium {
            Medium::Free | Medium::Aloha => {
                let flight = |sending: Sending| {
                    let begins = sending.begins.unwrap_or(sending.sent);
                    Flight::new(sending, begins, &model)
                };
                self.air.add(sendings.into_iter().map(flight));
                offs.iter()
                    .flat_map(|off| self.air.stop(off).map(|flight| unsent(&flight)).collect::<Vec<_>>())
                    .collect()
            }
            Medium::TokenRing => {
                self.ring.queue(sendings);
                offs.iter().for_each(|off| self.ring.stop(off));
                let sent = self.ring.advance(slot_end).into_iter();
                let flights: Vec<Flight> = sent.map(|(sending, begins)| Flight::new(sending, begins, &model)).collect();
                let leaving = |flight: &Flight| (flight.ends, flight.sending.from, flight.sending.sequence);
                self.leaving.extend(flights.iter().map(leaving));
                self.air.add(flights);
                if has_changed {
                    let errors = &self.errors;
                    self.ring.set_members(&self.members, |robot| radio_of(errors, robot), slot_end);
                }
                let never = self.ring.take_unsent().into_iter();
                never.map(|sending| unsent(&Flight::new(sending, slot_end, &model))).collect()
            }
        }
    }

    /// Decides the outcome of a message at each station that it is addressed to.
    fn decide(&self, slot_end: Time, flight: &Flight, deliveries: &mut Vec<Delivery>) {
        let Sending { from, to, .. } = flight.sending;
        let count = deliveries.len();
        let mut deliver = |member: &Member| {
            if member.robot != from {
                let outcome = self.outcome(flight, member);
                deliveries.push(Delivery { outcome, ..lost(flight, member.robot, slot_end, Loss::Nobody) });
            }
        };
        match to {
            Address::All => self.members.iter().for_each(deliver),
            Address::One(address) => {
                let start = self.addresses.partition_point(|it| it.0 < address);
                let named = self.addresses[start..].iter().take_while(|it| it.0 == address);
                named.filter_map(|(_, robot)| self.member(*robot)).for_each(&mut deliver);
            }
        }
        if deliveries.len() == count {
            deliveries.push(lost(flight, from, slot_end, Loss::Nobody));
        }
    }

    fn outcome(&self, flight: &Flight, member: &Member) -> Result<Arrived, Loss> {
        let sending = &flight.sending;
        if let Ok(place) = sending.out_of_reach.binary_search_by_key(&member.robot, |(robot, _)| *robot) {
            return Err(sending.out_of_reach[place].1);
        }
        if member.baud != sending.baud {
            return Err(Loss::Baud);
        }
        if self.model.medium == Medium::Aloha && self.air.disturbs(flight, member.robot) {
            return Err(Loss::Collision);
        }
        let mut payload = sending.payload.clone();
        let radio = radio_of(&self.errors, member.robot);
        if radio.is_perfect() {
            return Ok(Arrived { payload, bit_errors: 0 });
        }
        let mut stream = Stream::new(self.seed, member.robot, Purpose::Radio, sending.from.0, sending.sequence);
        let bit_errors = radio.garble(&mut stream, &mut payload).ok_or(Loss::Packet)?;
        Ok(Arrived { payload, bit_errors })
    }

    fn member(&self, robot: RobotId) -> Option<&Member> {
        self.members.binary_search_by_key(&robot, |member| member.robot).ok().map(|place| &self.members[place])
    }

    /// Updates the messages that have left their senders by `slot_end`, and the time of the next decision.
    fn settle_dues(&mut self, slot_end: Time) {
        let gone = self.leaving.partition_point(|(ends, ..)| *ends <= slot_end);
        self.left.extend(self.leaving.drain(..gone).map(|(_, robot, sequence)| (robot, sequence)));
        let mut next = self.air.next_arrival();
        if self.model.medium == Medium::TokenRing {
            let leaves = self.leaving.first().map_or(Time::NEVER, |(ends, ..)| *ends);
            next = next.min(leaves).min(self.ring.next_end());
        }
        // An arrival exactly at a slot's end is decided there, so the slot before it must be run.
        self.due = if next == Time::NEVER { next } else { next - Time(1) };
    }
}

/// Noise model of messages to `robot`.
fn radio_of(errors: &[Radio], robot: RobotId) -> Radio {
    errors.get(robot.index()).copied().unwrap_or_default()
}

fn lost(flight: &Flight, to: RobotId, slot_end: Time, loss: Loss) -> Delivery {
    Delivery {
        to,
        from: flight.sending.from,
        address: flight.sending.address,
        sequence: flight.sending.sequence,
        arrives: flight.arrives,
        visible: flight.arrives.max(slot_end),
        outcome: Err(loss),
    }
}
