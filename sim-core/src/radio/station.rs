//! Radio station of one robot, with the buffers of its outgoing and its received messages.

use std::collections::VecDeque;

use crate::RobotId;
use crate::time::Time;

use super::{
    Address, Delivery, Loss, Medium, OutgoingMessage, RadioModel, StationChange, StationInfo, SwitchedOff, air_time,
};

/// Capacity of the sender's buffer and of the receiver's buffer of a station, in bytes; our choice. An empty message
/// takes one byte.
pub const BUFFER_BYTES: usize = 1024;

/// The sender's buffer has no room for the message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BufferFull;

/// A received message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReceivedMessage {
    /// The sender.
    pub from: RobotId,
    /// Address of the sender's station.
    pub address: u32,
    /// Sequence number of the message.
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
    /// Messages in the sender's buffer, in the order of their sequence numbers.
    send_buffer: VecDeque<BufferedMessage>,
    /// Messages not yet taken for the channel.
    untaken: Vec<OutgoingMessage>,
    /// Decided deliveries that are not yet visible, sorted by (visible, arrives, sender, sequence).
    in_transit: VecDeque<Delivery>,
    /// Visible messages that are not yet read, sorted by (arrived, sender, sequence).
    inbox: VecDeque<ReceivedMessage>,
}

/// A message in the sender's buffer.
#[derive(Clone, Copy, Debug)]
struct BufferedMessage {
    sequence: u64,
    size: usize,
    /// Start and end of the transmission; `None` in a token ring, which decides them later.
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
            send_buffer: VecDeque::new(),
            untaken: Vec::new(),
            in_transit: VecDeque::new(),
            inbox: VecDeque::new(),
        }
    }

    /// The medium.
    pub fn medium(&self) -> Medium {
        self.medium
    }

    /// Switches the station on.
    pub fn switch_on(&mut self, address: u32, baud: u32) {
        self.member = Some(StationInfo { robot: self.robot, address, baud });
        self.has_changed = true;
    }

    /// Switches the station off. Unread messages are dropped and messages in transit are lost. Messages whose
    /// transmission has not begun are never transmitted, unless a free medium has already taken them (at the end of a
    /// slot). Returns the outcomes of the messages in transit; the channel reports the messages that are never
    /// transmitted. Does nothing if the station is off.
    pub fn switch_off(&mut self, now: Time) -> Vec<Delivery> {
        self.switch_off_after(now)
    }

    /// Switches the station off like [`Station::switch_off`], but still transmits messages whose transmission begins by
    /// `last`.
    pub fn switch_off_after(&mut self, last: Time) -> Vec<Delivery> {
        if self.member.take().is_none() {
            return Vec::new();
        }
        self.has_changed = true;
        self.send_buffer = self.send_buffer.iter().filter(|it| self.is_transmitted(it, last)).copied().collect();
        self.switched_off.push(SwitchedOff { robot: self.robot, at: last, last_sequence: self.last_sequence });
        self.inbox.clear();
        let lose = |delivery: Delivery| Delivery { outcome: delivery.outcome.and(Err(Loss::Off)), ..delivery };
        self.in_transit.drain(..).map(lose).collect()
    }

    /// The later of `now` and the start of the last buffered message's transmission; `now` in a token ring, which
    /// decides this start later.
    pub fn last_start(&self, now: Time) -> Time {
        self.send_buffer.back().and_then(|it| it.span).map_or(now, |(begins, _)| begins.max(now))
    }

    /// Number of messages that would never be transmitted if the station were switched off at `now`; `None` in a token
    /// ring, which decides this at the end of the slot ([`Loss::Unsent`]).
    pub fn unsent_count(&self, now: Time) -> Option<usize> {
        let count = || self.send_buffer.iter().filter(|it| !self.is_transmitted(it, now)).count();
        (self.medium != Medium::TokenRing).then(count)
    }

    /// Returns true if the message is transmitted even if the station is switched off at `now`: its transmission has
    /// begun, or a free medium has taken it.
    fn is_transmitted(&self, message: &BufferedMessage, now: Time) -> bool {
        let first_untaken = self.untaken.first().map_or(u64::MAX, |message| message.sequence);
        let is_taken = self.medium == Medium::Free && message.sequence < first_untaken;
        message.span.is_some_and(|(begins, _)| begins <= now || is_taken)
    }

    /// Present state for the channel; `None` while the station is off.
    pub fn member(&self) -> Option<StationInfo> {
        self.member
    }

    /// Removes and returns the report for the channel; `None` if the station was not switched since the last call.
    pub fn take_change(&mut self) -> Option<StationChange> {
        let switched_off = std::mem::take(&mut self.switched_off);
        let change = StationChange { robot: self.robot, member: self.member, switched_off };
        std::mem::take(&mut self.has_changed).then_some(change)
    }

    /// Queues a message for transmission at `now`; returns it with its sequence number.
    ///
    /// # Errors
    /// [`BufferFull`] if the sender's buffer has no room for the message.
    ///
    /// # Panics
    /// If the station is off.
    pub fn send(
        &mut self,
        now: Time,
        to: Address,
        payload: &[u8],
        out_of_reach: Vec<(RobotId, Loss)>,
    ) -> Result<&OutgoingMessage, BufferFull> {
        let member = self.member.expect("only a station that is on sends");
        while self.send_buffer.front().is_some_and(|it| it.span.is_some_and(|(_, ends)| ends <= now)) {
            self.send_buffer.pop_front();
        }
        let size = payload.len().max(1);
        if self.send_buffer.iter().map(|it| it.size).sum::<usize>() + size > BUFFER_BYTES {
            return Err(BufferFull);
        }
        let begins = match self.medium {
            Medium::Free | Medium::Aloha => {
                let last_span = self.send_buffer.back().and_then(|it| it.span);
                Some(last_span.map_or(now, |(_, ends)| ends.max(now)))
            }
            Medium::TokenRing => None,
        };
        self.last_sequence += 1;
        let span = begins.map(|begins| (begins, begins + air_time(payload.len(), member.baud)));
        self.send_buffer.push_back(BufferedMessage { sequence: self.last_sequence, size, span });
        self.untaken.push(OutgoingMessage {
            from: self.robot,
            address: member.address,
            sequence: self.last_sequence,
            to,
            payload: payload.to_vec(),
            queued_at: now,
            begins,
            baud: member.baud,
            out_of_reach,
        });
        Ok(&self.untaken[self.untaken.len() - 1])
    }

    /// Removes and returns the messages queued since the last call.
    pub fn take_outgoing(&mut self) -> Vec<OutgoingMessage> {
        std::mem::take(&mut self.untaken)
    }

    /// Frees the buffer space of the message with this sequence number, which the token ring has transmitted.
    pub fn release(&mut self, sequence: u64) {
        self.send_buffer.retain(|it| it.sequence != sequence);
    }

    /// Adds a decided delivery to this station.
    pub fn deliver(&mut self, delivery: Delivery) {
        let key = |it: &Delivery| (it.visible, it.arrives, it.from, it.sequence);
        let index = self.in_transit.partition_point(|it| key(it) <= key(&delivery));
        self.in_transit.insert(index, delivery);
    }

    /// Time when the next delivery becomes visible; [`Time::NEVER`] if there is none.
    pub fn next_visible(&self) -> Time {
        self.in_transit.front().map_or(Time::NEVER, |delivery| delivery.visible)
    }

    /// Moves messages that are visible at `now` into the receiver's buffer; returns their final outcomes, in order.
    pub fn collect_visible(&mut self, now: Time) -> Vec<Delivery> {
        let mut collected = Vec::new();
        if self.next_visible() > now {
            return collected;
        }
        let size_of_payload = |payload: &[u8]| payload.len().max(1);
        let mut used: usize = self.inbox.iter().map(|message| size_of_payload(&message.payload)).sum();
        while self.next_visible() <= now
            && let Some(mut delivery) = self.in_transit.pop_front()
        {
            if let Ok(arrived) = &delivery.outcome {
                let size = size_of_payload(&arrived.payload);
                if used + size > BUFFER_BYTES {
                    delivery.outcome = Err(Loss::Overflow);
                } else {
                    used += size;
                    let message = ReceivedMessage {
                        from: delivery.from,
                        address: delivery.address,
                        sequence: delivery.sequence,
                        arrived: delivery.arrives,
                        payload: arrived.payload.clone(),
                    };
                    let key = |it: &ReceivedMessage| (it.arrived, it.from, it.sequence);
                    let index = self.inbox.partition_point(|it| key(it) <= key(&message));
                    self.inbox.insert(index, message);
                }
            }
            collected.push(delivery);
        }
        collected
    }

    /// Ends the run: returns the outcomes of the messages in transit, in order.
    pub fn finish(&mut self) -> Vec<Delivery> {
        let lose = |it: Delivery| Delivery { outcome: it.outcome.and(Err(Loss::End)), ..it };
        self.in_transit.drain(..).map(lose).collect()
    }

    /// Number of unread messages.
    pub fn waiting(&self) -> usize {
        self.inbox.len()
    }

    /// Removes and returns the next unread message, in order of (arrived, sender, sequence).
    pub fn receive(&mut self) -> Option<ReceivedMessage> {
        self.inbox.pop_front()
    }
}
