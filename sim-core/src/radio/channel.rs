//! What happens between sending and receiving.

use crate::RobotId;
use crate::noise::Radio;
use crate::time::Time;

use super::{Address, Arrived, Delivery, Loss, Member, Model, Sending, air_time};

/// The channel between all robots of a run.
#[derive(Clone, Debug, Default)]
pub struct Channel {
    model: Model,
    seed: u64,
    /// What it does to each receiver's messages, in the order of their ids; shorter: nothing to the others.
    errors: Vec<Radio>,
    /// Stations that are on, in the order of their robots.
    members: Vec<Member>,
}

impl Channel {
    /// The channel of a run with `seed`; `errors` in the order of the receivers' ids.
    pub fn new(model: Model, seed: u64, errors: Vec<Radio>) -> Self {
        Self { model, seed, errors, members: Vec::new() }
    }

    /// What carries the messages.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The stations that were on at the start of the slot, in the order of their robots.
    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// The station of `robot` is on from the end of the present slot on, or off (`None`).
    pub fn set_member(&mut self, robot: RobotId, member: Option<Member>) {
        let place = self.members.binary_search_by_key(&robot, |member| member.robot);
        match (place, member) {
            (Ok(place), Some(member)) => self.members[place] = member,
            (Ok(place), None) => drop(self.members.remove(place)),
            (Err(place), Some(member)) => self.members.insert(place, member),
            (Err(_), None) => {}
        }
    }

    /// Takes what was sent in the slot that ends at `slot_end`, in any order, and decides what can be decided by then: in order of
    /// (visible, receiver, arrives, sender, sequence).
    pub fn exchange(&mut self, slot_end: Time, sendings: Vec<Sending>) -> Vec<Delivery> {
        let _ = (self.seed, &self.errors);
        let mut deliveries = Vec::new();
        for sending in &sendings {
            let begins = sending.begins.unwrap_or(sending.sent);
            let arrives = begins + air_time(sending.payload.len(), sending.baud) + self.model.latency;
            let delivery = |to: RobotId, outcome| Delivery {
                to,
                from: sending.from,
                address: sending.address,
                sequence: sending.sequence,
                arrives,
                visible: arrives.max(slot_end),
                outcome,
            };
            let is_meant = |member: &&Member| match sending.to {
                Address::All => member.robot != sending.from,
                Address::One(address) => member.address == address && member.robot != sending.from,
            };
            let count = deliveries.len();
            for member in self.members.iter().filter(is_meant) {
                let reach = sending.out_of_reach.binary_search_by_key(&member.robot, |(robot, _)| *robot);
                let outcome = match reach {
                    Ok(place) => Err(sending.out_of_reach[place].1),
                    Err(_) => Ok(Arrived { payload: sending.payload.clone(), bit_errors: 0 }),
                };
                deliveries.push(delivery(member.robot, outcome));
            }
            if deliveries.len() == count {
                deliveries.push(delivery(sending.from, Err(Loss::Nobody)));
            }
        }
        deliveries.sort_by_key(|it| (it.visible, it.to, it.arrives, it.from, it.sequence));
        deliveries
    }

    /// When the channel next has something to decide, though nobody sends: the slot that holds this instant is to be run.
    /// [`Time::NEVER`] for nothing.
    pub fn due(&self) -> Time {
        Time::NEVER
    }
}
