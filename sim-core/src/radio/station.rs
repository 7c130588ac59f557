//! Radio station of one robot: its sent and received messages.

use std::collections::VecDeque;

use crate::RobotId;
use crate::time::Time;

use super::{
    Address, Delivery, Loss, Medium, RadioModel, SentMessage, StationChange, StationInfo, SwitchedOff, air_time,
};

/// Capacity in bytes of the buffer of unsent messages, and of the buffer of unread messages; our choice. An empty
/// message counts as one byte.
pub const BUFFER: usize = 1024;

/// The sender's buffer has no room for the message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;

/// A received message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// The sender.
    pub from: RobotId,
    /// Address of the sender's station.
    pub address: u32,
    /// Number of the message, counted per sender.
    pub sequence: u64,
    /// Time of arrival.
    pub arrived: Time,
    /// Payload as received.
    pub payload: Vec<u8>,
}

/// Radio station of one robot.
#[derive(Clone, Debug)]
pub struct Station {
    robot: RobotId,
    medium: Medium,
    /// Address and speed; `None` while the station is off.
    member: Option<StationInfo>,
    has_changed: bool,
    switched_off: Vec<SwitchedOff>,
    last_sequence: u64,
    /// Messages in the sender's buffer, in the order of their numbers.
    outgoing: VecDeque<Outgoing>,
    /// Messages not yet passed to the channel.
    sent: Vec<SentMessage>,
    /// Messages in transit, in order of (visible, arrives, sender, sequence).
    coming: VecDeque<Delivery>,
    /// Messages that wait to be read, in order of (arrived, sender, sequence).
    inbox: VecDeque<Message>,
}

/// A message in the sender's buffer.
#[derive(Clone, Copy, Debug)]
struct Outgoing {
    sequence: u64,
    size: usize,
    /// Start and end of the transmission; `None` if the medium decides it.
    span: Option<(Time, Time)>,
}

impl Station {
    /// The station of `robot`, switched off.
    pub fn new(robot: RobotId, model: &RadioModel) -> Self {
        Self {
            robot,
            medium: model.medium,
            member: None,
            has_changed: false,
            switched_off: Vec::new(),
            last_sequence: 0,
            outgoing: VecDeque::new(),
            sent: Vec::new(),
            coming: VecDeque::new(),
            inbox: VecDeque::new(),
        }
    }

    /// Switches the station on.
    pub fn switch_on(&mut self, address: u32, baud: u32) {
        self.member = Some(StationInfo { robot: self.robot, address, baud });
        self.has_changed = true;
    }

    /// Switches the station off. Unread messages are dropped and messages in transit are lost. Messages whose
    /// transmission has not begun are never sent, unless the channel has already taken them (a free medium takes
    /// messages at the end of each slot). Returns the outcomes of the messages in transit; the channel reports unsent
    /// messages. Does nothing if the station is off.
    pub fn switch_off(&mut self, now: Time) -> Vec<Delivery> {
        self.switch_off_after(now)
    }

    /// Switches the station off like [`Station::switch_off`], but still sends messages whose transmission begins by
    /// `last`.
    pub fn switch_off_after(&mut self, last: Time) -> Vec<Delivery> {
        if self.member.take().is_none() {
            return Vec::new();
        }
        self.has_changed = true;
        self.outgoing = self.outgoing.iter().filter(|it| self.goes_out(it, last)).copied().collect();
        self.switched_off.push(SwitchedOff { robot: self.robot, at: last, last_sequence: self.last_sequence });
        self.inbox.clear();
        let unheard = |delivery: Delivery| Delivery { outcome: delivery.outcome.and(Err(Loss::Off)), ..delivery };
        self.coming.drain(..).map(unheard).collect()
    }

    /// The later of `now` and the start of the last transmission; in a token ring, which decides this start later, `now`.
    pub fn last_start(&self, now: Time) -> Time {
        self.outgoing.back().and_then(|it| it.span).map_or(now, |(begins, _)| begins.max(now))
    }

    /// Number of messages that would never be sent if the station were switched off at `now`, including messages that
    /// wait for a token.
    pub fn unsent(&self, now: Time) -> usize {
        self.outgoing.iter().filter(|it| !self.goes_out(it, now)).count()
    }

    /// Returns true if the message is sent even if the station is switched off at `now`: its transmission has begun, or the channel
    /// has taken it.
    fn goes_out(&self, message: &Outgoing, now: Time) -> bool {
        let untaken = self.sent.first().map_or(u64::MAX, |sending| sending.sequence);
        let is_taken = self.medium == Medium::Free && message.sequence < untaken;
        message.span.is_some_and(|(begins, _)| begins <= now || is_taken)
    }

    /// Present state for the channel; `None` while the station is off.
    pub fn member(&self) -> Option<StationInfo> {
        self.member
    }

    /// Takes the report for the channel; `None` if the station was not switched since the last call.
    pub fn take_change(&mut self) -> Option<StationChange> {
        let switched_off = std::mem::take(&mut self.switched_off);
        let change = StationChange { robot: self.robot, member: self.member, switched_off };
        std::mem::take(&mut self.has_changed).then_some(change)
    }

    /// Sends a message at `now`; returns it with its number.
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
    ) -> Result<&SentMessage, Full> {
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
        self.sent.push(SentMessage {
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

    /// Takes the messages sent since the last call.
    pub fn take_sent(&mut self) -> Vec<SentMessage> {
        std::mem::take(&mut self.sent)
    }

    /// Frees the buffer space of the message with this number, which the medium has transmitted.
    pub fn has_left(&mut self, sequence: u64) {
        self.outgoing.retain(|it| it.sequence != sequence);
    }

    /// Queues a message in transit to this station.
    pub fn deliver(&mut self, delivery: Delivery) {
        let key = |it: &Delivery| (it.visible, it.arrives, it.from, it.sequence);
        let index = self.coming.partition_point(|it| key(it) <= key(&delivery));
        self.coming.insert(index, delivery);
    }

    /// Time when the next message in transit becomes visible; [`Time::NEVER`] if there is none.
    pub fn next_visible(&self) -> Time {
        self.coming.front().map_or(Time::NEVER, |delivery| delivery.visible)
    }

    /// Moves messages that are visible at `now` into the buffer; returns the outcome of each, in order.
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
                    let index = self.inbox.partition_point(|it| key(it) <= key(&message));
                    self.inbox.insert(index, message);
                }
            }
            settled.push(delivery);
        }
        settled
    }

    /// Ends the run: returns the outcomes of the messages in transit, in order.
    pub fn finish(&mut self) -> Vec<Delivery> {
        let fate = |it: Delivery| Delivery { outcome: it.outcome.and(Err(Loss::End)), ..it };
        self.coming.drain(..).map(fate).collect()
    }

    /// Number of messages that wait to be read.
    pub fn waiting(&self) -> usize {
        self.inbox.len()
    }

    /// Takes the next message, in order of (arrived, sender, sequence).
    pub fn receive(&mut self) -> Option<Message> {
        self.inbox.pop_front()
    }
}
