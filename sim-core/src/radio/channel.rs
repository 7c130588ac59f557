//! Carries messages from senders to receivers over the radio channel.

use std::collections::BTreeSet;

use crate::RobotId;
use crate::noise::{Purpose, RadioNoise, Stream};
use crate::time::Time;

use super::air::{Air, Transmission};
use super::ring::Ring;
use super::{
    Address, Arrived, Delivery, Loss, Medium, OutgoingMessage, RadioModel, StationChange, StationInfo, SwitchedOff,
};

/// The channel between all robots of a run.
///
/// At the end of a slot the caller reports the stations that were switched on or off ([`Channel::report_change`]), then
/// the messages that were queued ([`Channel::exchange`]). `exchange` must be called at the end of each slot in which a
/// station was switched or a message was queued, and at the end of the slot that contains [`Channel::due`]. Other slots
/// may be skipped.
#[derive(Clone, Debug)]
pub struct Channel {
    model: RadioModel,
    seed: u64,
    /// Noise models of the receivers, in the order of their ids; further receivers have no errors.
    errors: Vec<RadioNoise>,
    /// Robots whose radio is silenced: they receive nothing and no other robot receives their messages.
    silent: BTreeSet<RobotId>,
    /// Stations that are on, in the order of their robots.
    members: Vec<StationInfo>,
    /// Pairs (address, robot) of the members, sorted.
    addresses: Vec<(u32, RobotId)>,
    has_changed: bool,
    /// Stations switched off since the last exchange.
    switched_off: Vec<SwitchedOff>,
    air: Air,
    ring: Ring,
    /// Transmissions of the token ring in progress: (end, sender, sequence), in the order of time.
    in_progress: Vec<(Time, RobotId, u64)>,
    /// Messages that the token ring has transmitted since the last [`Channel::take_transmitted`]: (sender, sequence).
    transmitted: Vec<(RobotId, u64)>,
    due: Time,
}

impl Default for Channel {
    fn default() -> Self {
        Self::new(RadioModel::default(), 0, Vec::new())
    }
}

impl Channel {
    /// Channel of a run with `seed`; `errors` are the noise models in the order of the receivers' ids.
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
            in_progress: Vec::new(),
            transmitted: Vec::new(),
            due: Time::NEVER,
        }
    }

    /// Model of the medium.
    pub fn model(&self) -> &RadioModel {
        &self.model
    }

    /// Stations that were on at the start of the present slot, in the order of their robots.
    pub fn members(&self) -> &[StationInfo] {
        &self.members
    }

    /// Reports that a station was switched on or off in the present slot.
    pub fn report_change(&mut self, change: StationChange) {
        self.set_member(change.robot, change.member);
        self.switched_off.extend(change.switched_off);
    }

    /// Sets the station of `robot` from the end of the present slot on; `None` if it is off.
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

    /// Silences the radio of `robot`, or restores it if `is_silent` is false. This applies to messages whose outcome is
    /// decided from the end of the present slot on. A silenced radio still occupies the medium, but its messages are
    /// lost.
    pub fn set_silent(&mut self, robot: RobotId, is_silent: bool) {
        if is_silent {
            self.silent.insert(robot);
        } else {
            self.silent.remove(&robot);
        }
    }

    /// Takes the messages queued in the slot that ends at `slot_end`, in any order, and returns the deliveries decided
    /// by `slot_end`, sorted by (visible, receiver, arrives, sender, sequence).
    pub fn exchange(&mut self, slot_end: Time, mut messages: Vec<OutgoingMessage>) -> Vec<Delivery> {
        messages.sort_unstable_by_key(|message| (message.from, message.sequence));
        let mut deliveries = self.send(slot_end, messages);
        let until = if self.model.medium == Medium::Free { Time::NEVER } else { slot_end };
        for transmission in self.air.arrived(until) {
            self.decide(slot_end, transmission, &mut deliveries);
        }
        self.air.forget(until);
        self.update_due(slot_end);
        deliveries.sort_by_key(|it| (it.visible, it.to, it.arrives, it.from, it.sequence));
        deliveries
    }

    /// Next time at which the channel must decide an outcome even if no message is queued; the slot that contains this
    /// instant must be run. [`Time::NEVER`] if there is nothing to decide. [`Time::ZERO`] after a station was switched,
    /// or after a noise model of a token ring was set.
    pub fn due(&self) -> Time {
        if self.has_changed { Time::ZERO } else { self.due }
    }

    /// Ends the run: returns the undecided messages as losses of their senders, sorted by (sender, sequence).
    pub fn finish(&mut self, end: Time) -> Vec<Delivery> {
        let air = std::mem::take(&mut self.air);
        let mut transmissions: Vec<Transmission> = air.arrived(Time::NEVER).cloned().collect();
        transmissions
            .extend(self.ring.take_queued().into_iter().map(|message| Transmission::new(message, end, &self.model)));
        transmissions.sort_unstable_by_key(|transmission| (transmission.message.from, transmission.message.sequence));
        self.due = Time::NEVER;
        let end_loss = |transmission: &Transmission| Delivery {
            visible: end,
            ..lost(transmission, transmission.message.from, end, Loss::End)
        };
        transmissions.iter().map(end_loss).collect()
    }

    /// Removes and returns the messages that a token ring has transmitted since the last call, as (sender, sequence),
    /// for [`super::Station::release`]. Stations on the other media know the end of each transmission without a report.
    pub fn take_transmitted(&mut self) -> Vec<(RobotId, u64)> {
        std::mem::take(&mut self.transmitted)
    }

    /// Starts the transmission of messages; returns those that are never transmitted.
    fn send(&mut self, slot_end: Time, messages: Vec<OutgoingMessage>) -> Vec<Delivery> {
        let switched_off = std::mem::take(&mut self.switched_off);
        let has_changed = std::mem::take(&mut self.has_changed);
        let model = self.model;
        let unsent = |transmission: &Transmission| Delivery {
            visible: slot_end,
            ..lost(transmission, transmission.message.from, slot_end, Loss::Unsent)
        };
        match self.model.medium {
            Medium::Free | Medium::Aloha => {
                let transmission = |message: OutgoingMessage| {
                    let begins = message.begins.unwrap_or(message.queued_at);
                    Transmission::new(message, begins, &model)
                };
                self.air.add(messages.into_iter().map(transmission));
                switched_off
                    .iter()
                    .flat_map(|off| self.air.stop(off).map(|transmission| unsent(&transmission)).collect::<Vec<_>>())
                    .collect()
            }
            Medium::TokenRing => {
                self.ring.queue(messages);
                switched_off.iter().for_each(|off| self.ring.stop(off));
                let started = self.ring.advance(slot_end).into_iter();
                let transmissions: Vec<Transmission> =
                    started.map(|(message, begins)| Transmission::new(message, begins, &model)).collect();
                let end_of = |transmission: &Transmission| {
                    (transmission.ends, transmission.message.from, transmission.message.sequence)
                };
                self.in_progress.extend(transmissions.iter().map(end_of));
                self.air.add(transmissions);
                if has_changed {
                    let errors = &self.errors;
                    self.ring.set_members(&self.members, |robot| noise_of(errors, robot), slot_end);
                }
                let untransmitted = self.ring.take_untransmitted().into_iter();
                untransmitted.map(|message| unsent(&Transmission::new(message, slot_end, &model))).collect()
            }
        }
    }

    /// Decides the outcome of a message at each station to which it is addressed.
    fn decide(&self, slot_end: Time, transmission: &Transmission, deliveries: &mut Vec<Delivery>) {
        let OutgoingMessage { from, to, .. } = transmission.message;
        let count_before = deliveries.len();
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
                let addressed = self.addresses[start..].iter().take_while(|it| it.0 == address);
                addressed.filter_map(|(_, robot)| self.member(*robot)).for_each(&mut deliver);
            }
        }
        if deliveries.len() == count_before {
            deliveries.push(lost(transmission, from, slot_end, Loss::Nobody));
        }
    }

    fn outcome(&self, transmission: &Transmission, member: &StationInfo) -> Result<Arrived, Loss> {
        let message = &transmission.message;
        if let Ok(index) = message.out_of_reach.binary_search_by_key(&member.robot, |(robot, _)| *robot) {
            return Err(message.out_of_reach[index].1);
        }
        if member.baud != message.baud {
            return Err(Loss::Baud);
        }
        if self.model.medium == Medium::Aloha && self.air.is_disturbed(transmission, member.robot) {
            return Err(Loss::Collision);
        }
        if [message.from, member.robot].iter().any(|robot| self.silent.contains(robot)) {
            return Err(Loss::Packet);
        }
        let mut payload = message.payload.clone();
        let noise = noise_of(&self.errors, member.robot);
        if noise.is_perfect() {
            return Ok(Arrived { payload, bit_errors: 0 });
        }
        let mut stream = Stream::new(self.seed, member.robot, Purpose::Radio, message.from.0, message.sequence);
        let bit_errors = noise.garble(&mut stream, &mut payload).ok_or(Loss::Packet)?;
        Ok(Arrived { payload, bit_errors })
    }

    fn member(&self, robot: RobotId) -> Option<&StationInfo> {
        self.members.binary_search_by_key(&robot, |member| member.robot).ok().map(|index| &self.members[index])
    }

    /// Updates the transmitted messages up to `slot_end`, and the time of the next decision.
    fn update_due(&mut self, slot_end: Time) {
        let ended = self.in_progress.partition_point(|(ends, ..)| *ends <= slot_end);
        self.transmitted.extend(self.in_progress.drain(..ended).map(|(_, robot, sequence)| (robot, sequence)));
        let mut next = self.air.next_arrival();
        if self.model.medium == Medium::TokenRing {
            let next_end = self.in_progress.first().map_or(Time::NEVER, |(ends, ..)| *ends);
            next = next.min(next_end).min(self.ring.next_end());
        }
        // An arrival exactly at a slot's end is decided in the slot that ends there, so that slot must be run.
        self.due = if next == Time::NEVER { next } else { next - Time(1) };
    }
}

/// Noise model of messages to `robot`.
fn noise_of(errors: &[RadioNoise], robot: RobotId) -> RadioNoise {
    errors.get(robot.index()).copied().unwrap_or_default()
}

/// Loss of a message at `to`.
fn lost(transmission: &Transmission, to: RobotId, slot_end: Time, loss: Loss) -> Delivery {
    Delivery {
        to,
        from: transmission.message.from,
        address: transmission.message.address,
        sequence: transmission.message.sequence,
        arrives: transmission.arrives,
        visible: transmission.arrives.max(slot_end),
        outcome: Err(loss),
    }
}
