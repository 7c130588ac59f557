//! The radio of one robot: what it has sent, what it has received.

use std::collections::VecDeque;

use crate::RobotId;
use crate::time::Time;

use super::{Address, Change, Delivery, Loss, Medium, Member, Model, Off, Sending, air_time};

/// How many bytes of messages a station keeps that are not yet sent, and how many that are not yet read; our choice. A message
/// without any counts as one.
pub const BUFFER: usize = 1024;

/// The sender's buffer has no room for the message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;

/// A message that was received.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Who sent it.
    pub from: RobotId,
    /// The address of the sender's station.
    pub address: u32,
    /// Its number among those of the sender.
    pub sequence: u64,
    /// When it arrived.
    pub arrived: Time,
    /// The bytes as they arrived.
    pub payload: Vec<u8>,
}

/// The radio of one robot.
#[derive(Clone, Debug)]
pub struct Station {
    robot: RobotId,
    medium: Medium,
    /// Address and speed while it is on.
    member: Option<Member>,
    has_changed: bool,
    offs: Vec<Off>,
    last_sequence: u64,
    /// In the order of their numbers.
    outgoing: VecDeque<Outgoing>,
    /// Not yet told to the channel.
    sent: Vec<Sending>,
    /// On their way, in order of (visible, arrives, sender, sequence).
    coming: VecDeque<Delivery>,
    /// Waiting to be read, in order of (arrived, sender, sequence).
    inbox: VecDeque<Message>,
}

/// A message in the sender's buffer.
#[derive(Clone, Copy, Debug)]
struct Outgoing {
    sequence: u64,
    size: usize,
    /// When its transmission begins and ends; none where the medium decides.
    span: Option<(Time, Time)>,
}

impl Station {
    /// The station of `robot`, switched off.
    pub fn new(robot: RobotId, model: &Model) -> Self {
        Self {
            robot,
            medium: model.medium,
            member: None,
            has_changed: false,
            offs: Vec::new(),
            last_sequence: 0,
            outgoing: VecDeque::new(),
            sent: Vec::new(),
            coming: VecDeque::new(),
            inbox: VecDeque::new(),
        }
    }

    /// Switches it on.
    pub fn switch_on(&mut self, address: u32, baud: u32) {
        self.member = Some(Member { robot: self.robot, address, baud });
        self.has_changed = true;
    }

    /// Switches it off: what waits to be read is gone, what is on its way is not heard, and what it has not begun to send is never
    /// sent, unless the channel has taken it (a free medium does so at the end of each slot). What becomes of what was on its way;
    /// of what is not sent the channel tells. Nothing if it is off.
    pub fn switch_off(&mut self, now: Time) -> Vec<Delivery> {
        if self.member.take().is_none() {
            return Vec::new();
        }
        self.has_changed = true;
        self.outgoing = self.outgoing.iter().filter(|it| self.goes_out(it, now)).copied().collect();
        self.offs.push(Off { robot: self.robot, at: now, last_sequence: self.last_sequence });
        self.inbox.clear();
        let unheard = |delivery: Delivery| Delivery { outcome: delivery.outcome.and(Err(Loss::Off)), ..delivery };
        self.coming.drain(..).map(unheard).collect()
    }

    /// How many of its messages would never be sent if it were switched off at `now`; all that wait for a token.
    pub fn unsent(&self, now: Time) -> usize {
        self.outgoing.iter().filter(|it| !self.goes_out(it, now)).count()
    }

    /// True if the message is sent even if it is switched off at `now`: its transmission has begun, or the channel has taken it.
    fn goes_out(&self, message: &Outgoing, now: Time) -> bool {
        let untaken = self.sent.first().map_or(u64::MAX, |sending| sending.sequence);
        let is_taken = self.medium == Medium::Free && message.sequence < untaken;
        message.span.is_some_and(|(begins, _)| begins <= now || is_taken)
    }

    /// What it tells the channel; none while it is off.
    pub fn member(&self) -> Option<Member> {
        self.member
    }

    /// What the channel is to know, once, after it was switched.
    pub fn take_change(&mut self) -> Option<Change> {
        let offs = std::mem::take(&mut self.offs);
        let change = Change { robot: self.robot, member: self.member, offs };
        std::mem::take(&mut self.has_changed).then_some(change)
    }

    /// Sends a message at `now`; its number.
    ///
    /// # Errors
    /// [`Full`] when [`BUFFER`] has no room for it.
    ///
    /// # Panics
    /// If the station is off.
    pub fn send(
        &mut self,
        now: Time,
        to: Address,
        payload: &[u8],
        out_of_reach: Vec<(RobotId, Loss)>,
    ) -> Result<&Sending, Full> {
        let member = self.member.expect("only a station that is on sends");
        while self.outgoing.front().is_some_and(|it| it.span.is_some_and(|(_, ends)| ends <= now)) {
            self.outgoing.pop_front();
        }
        let size = payload.len().max(1);
        if self.outgoing.iter().map(|it| it.size).sum::<usize>() + size > BUFFER {
            return Err(Full);
        }
        let begins = match self.medium {
            Medium::Free | Medium::Aloha => {
                let free = self.outgoing.back().and_then(|it| it.span);
                Some(free.map_or(now, |(_, ends)| ends.max(now)))
            }
            Medium::TokenRing => None,
        };
        self.last_sequence += 1;
        let span = begins.map(|begins| (begins, begins + air_time(payload.len(), member.baud)));
        self.outgoing.push_back(Outgoing { sequence: self.last_sequence, size, span });
        self.sent.push(Sending {
            from: self.robot,
            address: member.address,
            sequence: self.last_sequence,
            to,
            payload: payload.to_vec(),
            sent: now,
            begins,
            baud: member.baud,
            out_of_reach,
        });
        Ok(&self.sent[self.sent.len() - 1])
    }

    /// What it has sent since this was asked last.
    pub fn take_sent(&mut self) -> Vec<Sending> {
        std::mem::take(&mut self.sent)
    }

    /// The medium has sent the message of this number.
    pub fn has_left(&mut self, sequence: u64) {
        self.outgoing.retain(|it| it.sequence != sequence);
    }

    /// A message is on its way.
    pub fn deliver(&mut self, delivery: Delivery) {
        let key = |it: &Delivery| (it.visible, it.arrives, it.from, it.sequence);
        let place = self.coming.partition_point(|it| key(it) <= key(&delivery));
        self.coming.insert(place, delivery);
    }

    /// From when on the next message on its way is visible; [`Time::NEVER`] for none.
    pub fn next_visible(&self) -> Time {
        self.coming.front().map_or(Time::NEVER, |delivery| delivery.visible)
    }

    /// Puts what is visible at `now` into the buffer; what became of each, in order.
    pub fn settle(&mut self, now: Time) -> Vec<Delivery> {
        let mut settled = Vec::new();
        if self.next_visible() > now {
            return settled;
        }
        let room_of = |payload: &[u8]| payload.len().max(1);
        let mut used: usize = self.inbox.iter().map(|message| room_of(&message.payload)).sum();
        while self.next_visible() <= now
            && let Some(mut delivery) = self.coming.pop_front()
        {
            if let Ok(arrived) = &delivery.outcome {
                let room = room_of(&arrived.payload);
                if used + room > BUFFER {
                    delivery.outcome = Err(Loss::Overflow);
                } else {
                    used += room;
                    let message = Message {
                        from: delivery.from,
                        address: delivery.address,
                        sequence: delivery.sequence,
                        arrived: delivery.arrives,
                        payload: arrived.payload.clone(),
                    };
                    let key = |it: &Message| (it.arrived, it.from, it.sequence);
                    let place = self.inbox.partition_point(|it| key(it) <= key(&message));
                    self.inbox.insert(place, message);
                }
            }
            settled.push(delivery);
        }
        settled
    }

    /// The run ends: what becomes of the messages that are on their way, in order.
    pub fn finish(&mut self) -> Vec<Delivery> {
        let fate = |it: Delivery| Delivery { outcome: it.outcome.and(Err(Loss::End)), ..it };
        self.coming.drain(..).map(fate).collect()
    }

    /// How many messages wait to be read.
    pub fn waiting(&self) -> usize {
        self.inbox.len()
    }

    /// The next message, in order of (arrived, sender, sequence).
    pub fn receive(&mut self) -> Option<Message> {
        self.inbox.pop_front()
    }
}
