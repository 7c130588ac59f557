//! Oracle for stations and channel: evaluates their rules microsecond by microsecond, and shares no code with the
//! channel.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::*;
use crate::math::{ln, ln_1p};
use crate::noise::{Purpose, Stream};

/// One operation of a program on its radio.
#[derive(Clone, Debug)]
pub enum Operation {
    On {
        address: u32,
        baud: u32,
    },
    Off,
    Send {
        to: Address,
        payload: Vec<u8>,
    },
    /// Reads a message, if there is one.
    Read,
}

/// A run as a list of operations with times and robots.
#[derive(Clone, Debug)]
pub struct Schedule {
    pub model: RadioModel,
    pub slot: Time,
    pub seed: u64,
    /// Noise model of each robot.
    pub errors: Vec<RadioNoise>,
    /// For each robot, the robots that cannot receive its messages.
    pub out_of_reach: Vec<Vec<(RobotId, Loss)>>,
    /// Operations in order of time; operations of one robot are at different instants.
    pub operations: Vec<(Time, RobotId, Operation)>,
    pub end: Time,
}

/// Result of a run: the deliveries, and the messages read as (time, reader, sender, sequence).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Sorted by (visible, receiver, arrives, sender, sequence).
    pub deliveries: Vec<Delivery>,
    pub read: Vec<(Time, RobotId, RobotId, u64)>,
}

/// A message that a program has queued.
struct Message {
    from: RobotId,
    sequence: u64,
    to: Address,
    payload: Vec<u8>,
    address: u32,
    baud: u32,
    queued_at: Time,
    begins: Option<Time>,
    /// Receivers at which another transmission was on the air at the same time.
    disturbed: BTreeSet<RobotId>,
    is_decided: bool,
}

struct Oracle<'a> {
    schedule: &'a Schedule,
    now: Time,
    messages: Vec<Message>,
    /// Address and speed by robot.
    on: BTreeMap<RobotId, (u32, u32)>,
    /// Indices of messages whose transmission has not begun, by robot.
    queues: Vec<VecDeque<usize>>,
    ring: Vec<(RobotId, u32)>,
    token: Option<(RobotId, Time, f64)>,
    token_count: u64,
    outcome_of_run: Outcome,
    /// Deliveries that are not yet visible, by robot.
    in_transit: Vec<Vec<Delivery>>,
    /// Visible messages that are not yet read, by robot.
    inbox: Vec<Vec<Delivery>>,
}

/// Simulates a schedule.
pub fn simulate(schedule: &Schedule) -> Outcome {
    let robots = schedule.errors.len();
    let mut oracle = Oracle {
        schedule,
        now: Time::ZERO,
        messages: Vec::new(),
        on: BTreeMap::new(),
        queues: vec![VecDeque::new(); robots],
        ring: Vec::new(),
        token: None,
        token_count: 0,
        outcome_of_run: Outcome::default(),
        in_transit: vec![Vec::new(); robots],
        inbox: vec![Vec::new(); robots],
    };
    let mut operations = schedule.operations.iter().peekable();
    while oracle.now < schedule.end {
        oracle.make_visible();
        let mut switched_off = Vec::new();
        while let Some((_, robot, operation)) = operations.next_if(|(at, ..)| *at == oracle.now) {
            match operation {
                Operation::Off => switched_off.push(*robot),
                operation => oracle.execute(*robot, operation),
            }
        }
        oracle.transmit();
        switched_off.into_iter().for_each(|robot| oracle.switch_off(robot));
        oracle.record_overlaps();
        oracle.now += Time(1);
        if oracle.now.0 % schedule.slot.0 == 0 {
            oracle.end_slot();
        }
    }
    let key = |it: &Delivery| (it.visible, it.to, it.arrives, it.from, it.sequence);
    oracle.outcome_of_run.deliveries.sort_by_key(key);
    oracle.outcome_of_run
}

impl Oracle<'_> {
    fn duration(bytes: usize, baud: u32) -> Time {
        let bits = 10.0 * (bytes as f64 + 7.0);
        Time((bits * 1e6 / f64::from(baud)).ceil() as i64)
    }

    fn ends(message: &Message) -> Option<Time> {
        Some(message.begins? + Self::duration(message.payload.len(), message.baud))
    }

    /// Moves messages that are visible now to their receivers.
    fn make_visible(&mut self) {
        for (in_transit, inbox) in self.in_transit.iter_mut().zip(&mut self.inbox) {
            let is_due = |it: &mut Delivery| it.visible <= self.now;
            for delivery in in_transit.extract_if(.., is_due) {
                if delivery.outcome.is_ok() {
                    inbox.push(delivery.clone());
                }
                self.outcome_of_run.deliveries.push(delivery);
            }
        }
    }

    fn execute(&mut self, robot: RobotId, operation: &Operation) {
        match operation {
            Operation::On { address, baud } => {
                self.on.insert(robot, (*address, *baud));
            }
            Operation::Send { to, payload } => {
                let Some(&(address, baud)) = self.on.get(&robot) else { return };
                let sequence = 1 + self.messages.iter().filter(|message| message.from == robot).count() as u64;
                self.queues[robot.index()].push_back(self.messages.len());
                self.messages.push(Message {
                    from: robot,
                    sequence,
                    to: *to,
                    payload: payload.clone(),
                    address,
                    baud,
                    queued_at: self.now,
                    begins: None,
                    disturbed: BTreeSet::new(),
                    is_decided: false,
                });
            }
            Operation::Read => {
                let inbox = &mut self.inbox[robot.index()];
                let first = (0..inbox.len()).min_by_key(|index| {
                    let it = &inbox[*index];
                    (it.arrives, it.from, it.sequence)
                });
                if let Some(index) = first.filter(|_| self.on.contains_key(&robot)) {
                    let message = inbox.remove(index);
                    self.outcome_of_run.read.push((self.now, robot, message.from, message.sequence));
                }
            }
            Operation::Off => {}
        }
    }

    fn switch_off(&mut self, robot: RobotId) {
        if self.on.remove(&robot).is_none() {
            return;
        }
        self.inbox[robot.index()].clear();
        for delivery in self.in_transit[robot.index()].drain(..) {
            self.outcome_of_run.deliveries.push(Delivery { outcome: delivery.outcome.and(Err(Loss::Off)), ..delivery });
        }
        let slot_start = self.now.floor_to(self.schedule.slot);
        let is_kept =
            |index: &usize| self.schedule.model.medium == Medium::Free && self.messages[*index].queued_at < slot_start;
        let queue = std::mem::take(&mut self.queues[robot.index()]);
        self.queues[robot.index()] = queue.iter().copied().filter(is_kept).collect();
        // The reported arrival assumes that the transmission begins as soon as the transmitter is free.
        let mut transmitter_free =
            self.messages.iter().filter(|message| message.from == robot).filter_map(Self::ends).max();
        for index in queue {
            let is_kept = self.queues[robot.index()].contains(&index);
            let slot_end = slot_start + self.schedule.slot;
            let message = &mut self.messages[index];
            let begins = match self.schedule.model.medium {
                Medium::TokenRing => slot_end,
                _ => transmitter_free
                    .map_or(message.queued_at, |transmitter_free| transmitter_free.max(message.queued_at)),
            };
            let ends = begins + Self::duration(message.payload.len(), message.baud);
            transmitter_free = Some(ends);
            if !is_kept {
                message.is_decided = true;
                self.report_to_sender(index, ends, slot_end, Loss::Unsent);
            }
        }
    }

    fn report_to_sender(&mut self, index: usize, ends: Time, visible: Time, loss: Loss) {
        let message = &self.messages[index];
        self.in_transit[message.from.index()].push(Delivery {
            to: message.from,
            from: message.from,
            address: message.address,
            sequence: message.sequence,
            arrives: ends + self.schedule.model.latency,
            visible,
            outcome: Err(loss),
        });
    }

    /// Starts transmissions of stations that may send.
    fn transmit(&mut self) {
        if self.schedule.model.medium == Medium::TokenRing {
            return self.pass_token();
        }
        for robot in 0..self.queues.len() {
            let of_robot = self.messages.iter().filter(|message| message.from.index() == robot);
            let is_busy = of_robot.filter_map(Self::ends).any(|ends| ends > self.now);
            if !is_busy && let Some(index) = self.queues[robot].pop_front() {
                self.messages[index].begins = Some(self.now);
            }
        }
    }

    /// Lets the holder of the token send a message or pass the token on.
    fn pass_token(&mut self) {
        let Some((holder, at, life)) = self.token else { return };
        if at != self.now {
            return;
        }
        let index = self.ring.iter().position(|(robot, _)| *robot == holder).expect("the holder is in the ring");
        let mut frame = Self::duration(0, self.ring[index].1);
        if let Some(message) = self.queues[holder.index()].pop_front() {
            self.messages[message].begins = Some(at);
            frame = Self::duration(self.messages[message].payload.len(), self.messages[message].baud);
        }
        let (next, _) = self.ring[(index + 1) % self.ring.len()];
        let RadioNoise { bit_error_rate, packet_loss } = self.schedule.errors[next.index()];
        let mut hazard = 0.0;
        if self.ring.len() > 1 {
            hazard -= if packet_loss > 0.0 { ln_1p(-packet_loss) } else { 0.0 };
            hazard -= if bit_error_rate > 0.0 { 56.0 * ln_1p(-bit_error_rate) } else { 0.0 };
        }
        if hazard <= life {
            self.token = Some((next, at + frame, life - hazard));
        } else {
            self.create_token(next, at + frame);
        }
    }

    /// Creates a token at `holder` after a silence that began at `silence_start`.
    fn create_token(&mut self, holder: RobotId, silence_start: Time) {
        let (_, baud) = *self.ring.iter().find(|(robot, _)| *robot == holder).expect("the holder is in the ring");
        // Two frames of silence, a poll, and an answer from each other station.
        let frames = 2 + 1 + (self.ring.len() as i64 - 1);
        let mut stream = Stream::new(self.schedule.seed, RobotId(0), Purpose::Token, 0, self.token_count);
        self.token_count += 1;
        let at = silence_start + Time(frames * Self::duration(0, baud).0);
        self.token = Some((holder, at, -ln(1.0 - stream.unit())));
    }

    /// Records overlapping transmissions at each receiver.
    fn record_overlaps(&mut self) {
        let is_on_air = |message: &Message| {
            message.begins.is_some_and(|begins| begins <= self.now)
                && Self::ends(message).is_some_and(|ends| ends > self.now)
        };
        let on_air: Vec<usize> = (0..self.messages.len()).filter(|index| is_on_air(&self.messages[*index])).collect();
        for receiver in (0..self.queues.len()).map(RobotId::from_index) {
            let is_heard = |index: &&usize| {
                let from = self.messages[**index].from;
                let reaches = |(robot, _): &(RobotId, Loss)| *robot != receiver;
                from == receiver || self.schedule.out_of_reach[from.index()].iter().all(reaches)
            };
            let audible: Vec<usize> = on_air.iter().filter(is_heard).copied().collect();
            for index in &on_air {
                if audible.iter().any(|other| other != index) {
                    self.messages[*index].disturbed.insert(receiver);
                }
            }
        }
    }

    /// Processes the end of a slot at `now`.
    fn end_slot(&mut self) {
        let Schedule { model, .. } = *self.schedule;
        let holder = self.token.map(|(holder, at, _)| (holder, at));
        self.ring = self.on.iter().map(|(robot, (_, baud))| (*robot, *baud)).collect();
        match holder {
            _ if self.ring.is_empty() => self.token = None,
            None if model.medium == Medium::TokenRing => self.create_token(self.ring[0].0, self.now),
            Some((holder, at)) if self.ring.iter().all(|(robot, _)| *robot != holder) => {
                let next = self.ring.iter().find(|(robot, _)| *robot > holder).unwrap_or(&self.ring[0]);
                self.create_token(next.0, at);
            }
            _ => {}
        }
        // A free medium takes every message at once; each station then transmits its messages one after the other.
        let mut transmitter_free = vec![Time::ZERO; self.queues.len()];
        for index in 0..self.messages.len() {
            let message = &self.messages[index];
            let duration = Self::duration(message.payload.len(), message.baud);
            let is_kept = message.begins.is_some() || self.queues[message.from.index()].contains(&index);
            let ends = match model.medium {
                Medium::Free => {
                    message.begins.unwrap_or(transmitter_free[message.from.index()].max(message.queued_at)) + duration
                }
                _ => Self::ends(message).unwrap_or(Time::NEVER),
            };
            if is_kept {
                transmitter_free[message.from.index()] = ends;
            }
            let is_due = model.medium == Medium::Free || ends + model.latency <= self.now;
            if is_kept && !message.is_decided && is_due {
                self.messages[index].is_decided = true;
                self.decide(index, ends);
            }
        }
    }

    fn decide(&mut self, index: usize, ends: Time) {
        let arrives = ends + self.schedule.model.latency;
        let visible = arrives.max(self.now);
        let mut has_no_receiver = true;
        for (robot, (address, baud)) in self.on.clone() {
            let message = &self.messages[index];
            if robot == message.from || (message.to != Address::All && message.to != Address::One(address)) {
                continue;
            }
            has_no_receiver = false;
            let loss = self.schedule.out_of_reach[message.from.index()].iter().find(|(other, _)| *other == robot);
            let is_disturbed = self.schedule.model.medium == Medium::Aloha && message.disturbed.contains(&robot);
            let radio = self.schedule.errors[robot.index()];
            let mut stream = Stream::new(self.schedule.seed, robot, Purpose::Radio, message.from.0, message.sequence);
            let outcome = if let Some((_, loss)) = loss {
                Err(*loss)
            } else if message.baud != baud {
                Err(Loss::Baud)
            } else if is_disturbed {
                Err(Loss::Collision)
            } else if stream.unit() < radio.packet_loss {
                Err(Loss::Packet)
            } else {
                // At an error rate of 1 every bit is wrong.
                let mask = if radio.bit_error_rate == 1.0 { 0xff } else { 0 };
                let payload: Vec<u8> = message.payload.iter().map(|byte| byte ^ mask).collect();
                let bit_errors = if mask == 0 { 0 } else { 8 * payload.len() as u32 };
                Ok(Arrived { payload, bit_errors })
            };
            let Message { from, address, sequence, .. } = *message;
            self.in_transit[robot.index()].push(Delivery {
                to: robot,
                from,
                address,
                sequence,
                arrives,
                visible,
                outcome,
            });
        }
        if has_no_receiver {
            self.report_to_sender(index, ends, visible, Loss::Nobody);
        }
    }
}
