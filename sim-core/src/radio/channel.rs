//! Channel: transport of messages from senders to receivers.

use std::collections::BTreeSet;

use crate::RobotId;
use crate::noise::{Purpose, RadioNoise, Stream};
use crate::time::Time;

use super::air::{Air, Transmission};
use super::ring::Ring;
use super::{
    Address, Arrived, Delivery, Loss, Medium, RadioModel, SentMessage, StationChange, StationInfo, SwitchedOff,
};

/// The channel between all robots of a run.
///
/// At the end of a slot the caller reports the stations that were switched ([`Channel::change`]), then the messages that were sent
/// ([`Channel::exchange`]). `exchange` must be called at the end of each slot in which a station was switched or sent, and of the
/// slot that contains [`Channel::due`]; other slots may be skipped.
#[derive(Clone, Debug)]
pub struct Channel {
    model: RadioModel,
    seed: u64,
    /// Noise models of the receivers, in the order of their ids; receivers beyond the end have no errors.
    errors: Vec<RadioNoise>,
    /// Robots whose radio is silenced: it can neither be heard nor hear.
    silent: BTreeSet<RobotId>,
    /// Stations that are on, in the order of their robots.
    members: Vec<StationInfo>,
    /// The addresses of the members as (address, robot), in this order.
    addresses: Vec<(u32, RobotId)>,
    has_changed: bool,
    /// Stations switched off since the last exchange.
    switched_off: Vec<SwitchedOff>,
    air: Air,
    ring: Ring,
    /// Transmissions of the ring in progress: (end, sender, number), in the order of time.
    leaving: Vec<(Time, RobotId, u64)>,
    departed: Vec<(RobotId, u64)>,
    due: Time,
}

impl Default for Channel {
    fn default() -> Self {
        Self::new(RadioModel::default(), 0, Vec::new())
    }
}

impl Channel {
    /// Channel of a run with `seed`; `errors` in the order of the receivers' ids.
    pub fn new(model: RadioModel, seed: u64, errors: Vec<RadioNoise>) -> Self {
        Self {
            model,
            seed,
            errors,
            silent: BTreeSet::new(),
            members: Vec::new(),
            addresses: Vec::new(),
            has_changed: false,
            switched_off: Vec::new(),
            air: Air::default(),
            ring: Ring::new(seed),
            leaving: Vec::new(),
            departed: Vec::new(),
            due: Time::NEVER,
        }
    }

    /// Model of the medium.
    pub fn model(&self) -> &RadioModel {
        &self.model
    }

    /// Stations that were on at the start of the slot, in the order of their robots.
    pub fn members(&self) -> &[StationInfo] {
        &self.members
    }

    /// Reports that a station was switched in the present slot.
    pub fn change(&mut self, change: StationChange) {
        self.set_member(change.robot, change.member);
        self.switched_off.extend(change.switched_off);
    }

    /// Sets the station of `robot` from the end of the present slot on; `None` is off.
    pub fn set_member(&mut self, robot: RobotId, member: Option<StationInfo>) {
        let index = self.members.binary_search_by_key(&robot, |member| member.robot);
        if let Ok(index) = index {
            let key = (self.members.remove(index).address, robot);
            self.addresses.retain(|it| *it != key);
        }
        if let Some(member) = member {
            let index = index.unwrap_or_else(|index| index);
            self.members.insert(index, StationInfo { robot, ..member });
            let key = (member.address, robot);
            self.addresses.insert(self.addresses.partition_point(|it| *it < key), key);
        }
        self.has_changed = true;
    }

    /// Sets the noise model of messages to `robot`, from the present slot on. For the tokens of a token ring the model
    /// applies from the end of the slot on.
    pub fn set_errors(&mut self, robot: RobotId, errors: RadioNoise) {
        if self.errors.len() <= robot.index() {
            self.errors.resize(robot.index() + 1, RadioNoise::default());
        }
        self.errors[robot.index()] = errors;
        self.has_changed |= self.model.medium == Medium::TokenRing;
    }

    /// Silences the radio of `robot` or ends its silence, for messages that are decided from the end of the present slot on. Its messages
    /// are still on the air, but lost.
    pub fn set_silent(&mut self, robot: RobotId, is_silent: bool) {
        if is_silent {
            self.silent.insert(robot);
        } else {
            self.silent.remove(&robot);
        }
    }

    /// Takes the messages sent in the slot that ends at `slot_end`, in any order, and returns the deliveries that are decided by then,
    /// in order of (visible, receiver, arrives, sender, sequence).
    pub fn exchange(&mut self, slot_end: Time, mut sendings: Vec<SentMessage>) -> Vec<Delivery> {
        sendings.sort_by_key(|sending| (sending.from, sending.sequence));
        let mut deliveries = self.send(slot_end, sendings);
        let until = if self.model.medium == Medium::Free { Time::NEVER } else { slot_end };
        for transmission in self.air.arrived(until) {
            self.decide(slot_end, transmission, &mut deliveries);
        }
        self.air.forget(until);
        self.settle_dues(slot_end);
        deliveries.sort_by_key(|it| (it.visible, it.to, it.arrives, it.from, it.sequence));
        deliveries
    }

    /// Next time at which the channel must decide something even if no station sends; the slot that contains this instant
    /// must be run. [`Time::NEVER`] if there is nothing to decide, [`Time::ZERO`] after a station was switched.
    pub fn due(&self) -> Time {
        if self.has_changed { Time::ZERO } else { self.due }
    }

    /// Ends the run: returns the undecided messages as losses to their senders, in order of (sender, sequence).
    pub fn finish(&mut self, end: Time) -> Vec<Delivery> {
        let air = std::mem::take(&mut self.air);
        let mut transmissions: Vec<Transmission> = air.arrived(Time::NEVER).cloned().collect();
        transmissions
            .extend(self.ring.take_queued().into_iter().map(|sending| Transmission::new(sending, end, &self.model)));
        transmissions.sort_by_key(|transmission| (transmission.sending.from, transmission.sending.sequence));
        self.due = Time::NEVER;
        let fate = |transmission: &Transmission| Delivery {
            visible: end,
            ..lost(transmission, transmission.sending.from, end, Loss::End)
        };
        transmissions.iter().map(fate).collect()
    }

    /// Messages that left the buffers of their senders since the last call, as (sender, number), for
    /// [`super::Station::has_left`]. Only a medium that decides when to send (token ring) reports such messages.
    pub fn take_departed(&mut self) -> Vec<(RobotId, u64)> {
        std::mem::take(&mut self.departed)
    }

    /// Puts messages on the air; returns those that are never transmitted.
    fn send(&mut self, slot_end: Time, sendings: Vec<SentMessage>) -> Vec<Delivery> {
        let switched_off = std::mem::take(&mut self.switched_off);
        let has_changed = std::mem::take(&mut self.has_changed);
        let model = self.model;
        let unsent = |transmission: &Transmission| Delivery {
            visible: slot_end,
            ..lost(transmission, transmission.sending.from, slot_end, Loss::Unsent)
        };
        match self.model.medium {
            Medium::Free | Medium::Aloha => {
                let transmission = |sending: SentMessage| {
                    let begins = sending.begins.unwrap_or(sending.sent);
                    Transmission::new(sending, begins, &model)
                };
                self.air.add(sendings.into_iter().map(transmission));
                switched_off
                    .iter()
                    .flat_map(|off| self.air.stop(off).map(|transmission| unsent(&transmission)).collect::<Vec<_>>())
                    .collect()
            }
            Medium::TokenRing => {
                self.ring.queue(sendings);
                switched_off.iter().for_each(|off| self.ring.stop(off));
                let sent = self.ring.advance(slot_end).into_iter();
                let transmissions: Vec<Transmission> =
                    sent.map(|(sending, begins)| Transmission::new(sending, begins, &model)).collect();
                let leaving = |transmission: &Transmission| {
                    (transmission.ends, transmission.sending.from, transmission.sending.sequence)
                };
                self.leaving.extend(transmissions.iter().map(leaving));
                self.air.add(transmissions);
                if has_changed {
                    let errors = &self.errors;
                    self.ring.set_members(&self.members, |robot| radio_of(errors, robot), slot_end);
                }
                let never = self.ring.take_unsent().into_iter();
                never.map(|sending| unsent(&Transmission::new(sending, slot_end, &model))).collect()
            }
        }
    }

    /// Decides the outcome of a message at each station to which it is addressed.
    fn decide(&self, slot_end: Time, transmission: &Transmission, deliveries: &mut Vec<Delivery>) {
        let SentMessage { from, to, .. } = transmission.sending;
        let count = deliveries.len();
        let mut deliver = |member: &StationInfo| {
            if member.robot != from {
                let outcome = self.outcome(transmission, member);
                deliveries.push(Delivery { outcome, ..lost(transmission, member.robot, slot_end, Loss::Nobody) });
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
            deliveries.push(lost(transmission, from, slot_end, Loss::Nobody));
        }
    }

    fn outcome(&self, transmission: &Transmission, member: &StationInfo) -> Result<Arrived, Loss> {
        let sending = &transmission.sending;
        if let Ok(index) = sending.out_of_reach.binary_search_by_key(&member.robot, |(robot, _)| *robot) {
            return Err(sending.out_of_reach[index].1);
        }
        if member.baud != sending.baud {
            return Err(Loss::Baud);
        }
        if self.model.medium == Medium::Aloha && self.air.disturbs(transmission, member.robot) {
            return Err(Loss::Collision);
        }
        if [sending.from, member.robot].iter().any(|robot| self.silent.contains(robot)) {
            return Err(Loss::Packet);
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

    fn member(&self, robot: RobotId) -> Option<&StationInfo> {
        self.members.binary_search_by_key(&robot, |member| member.robot).ok().map(|index| &self.members[index])
    }

    /// Updates the messages that have left their senders by `slot_end`, and the time of the next decision.
    fn settle_dues(&mut self, slot_end: Time) {
        let gone = self.leaving.partition_point(|(ends, ..)| *ends <= slot_end);
        self.departed.extend(self.leaving.drain(..gone).map(|(_, robot, sequence)| (robot, sequence)));
        let mut next = self.air.next_arrival();
        if self.model.medium == Medium::TokenRing {
            let leaves = self.leaving.first().map_or(Time::NEVER, |(ends, ..)| *ends);
            next = next.min(leaves).min(self.ring.next_end());
        }
        // An arrival exactly at a slot's end is decided in the slot that ends there, so that slot must be run.
        self.due = if next == Time::NEVER { next } else { next - Time(1) };
    }
}

/// Noise model of messages to `robot`.
fn radio_of(errors: &[RadioNoise], robot: RobotId) -> RadioNoise {
    errors.get(robot.index()).copied().unwrap_or_default()
}

fn lost(transmission: &Transmission, to: RobotId, slot_end: Time, loss: Loss) -> Delivery {
    Delivery {
        to,
        from: transmission.sending.from,
        address: transmission.sending.address,
        sequence: transmission.sending.sequence,
        arrives: transmission.arrives,
        visible: transmission.arrives.max(slot_end),
        outcome: Err(loss),
    }
}
