//! Oracle for stations and channel: evaluates the same rules microsecond by microsecond, and shares no code with the
//! channel.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::*;
use crate::math::{ln, ln_1p};
use crate::noise::{Purpose, Stream};

/// One operation of a program on its radio.
#[derive(Clone, Debug)]
pub enum Deed {
    On {
        address: u32,
        baud: u32,
    },
    Off,
    Send {
        to: Address,
        payload: Vec<u8>,
    },
    /// Takes a message, if there is one.
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
    /// Robots that each robot cannot reach.
    pub out_of_reach: Vec<Vec<(RobotId, Loss)>>,
    /// Operations in order of time; operations of one robot are at different instants.
    pub deeds: Vec<(Time, RobotId, Deed)>,
    pub end: Time,
}

/// Outcomes of the messages, and the messages read: (time, reader, sender, number).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Story {
    /// Deliveries in order of (visible, receiver, arrives, sender, sequence).
    pub fates: Vec<Delivery>,
    pub read: Vec<(Time, RobotId, RobotId, u64)>,
}

/// A message that was sent.
struct Sent {
    from: RobotId,
    sequence: u64,
    to: Address,
    payload: Vec<u8>,
    address: u32,
    baud: u32,
    at: Time,
    begins: Option<Time>,
    /// Receivers at which another transmission was on the air at the same time.
    disturbed: BTreeSet<RobotId>,
    is_decided: bool,
}

struct Oracle<'a> {
    schedule: &'a Schedule,
    now: Time,
    sent: Vec<Sent>,
    /// Address and speed by robot.
    on: BTreeMap<RobotId, (u32, u32)>,
    /// Messages that wait to be sent, by robot.
    queues: Vec<VecDeque<usize>>,
    ring: Vec<(RobotId, u32)>,
    token: Option<(RobotId, Time, f64)>,
    tokens: u64,
    story: Story,
    /// Messages decided but not yet visible, and messages waiting to be read, by robot.
    coming: Vec<Vec<Delivery>>,
    inbox: Vec<Vec<Delivery>>,
}

/// Computes the outcome of a schedule.
pub fn tell(schedule: &Schedule) -> Story {
    let robots = schedule.errors.len();
    let mut oracle = Oracle {
        schedule,
        now: Time::ZERO,
        sent: Vec::new(),
        on: BTreeMap::new(),
        queues: vec![VecDeque::new(); robots],
        ring: Vec::new(),
        token: None,
        tokens: 0,
        story: Story::default(),
        coming: vec![Vec::new(); robots],
        inbox: vec![Vec::new(); robots],
    };
    let mut deeds = schedule.deeds.iter().peekable();
    while oracle.now < schedule.end {
        oracle.show();
        let mut offs = Vec::new();
        while let Some((_, robot, deed)) = deeds.next_if(|(at, ..)| *at == oracle.now) {
            match deed {
                Deed::Off => offs.push(*robot),
                deed => oracle.act(*robot, deed),
            }
        }
        oracle.transmit();
        offs.into_iter().for_each(|robot| oracle.switch_off(robot));
        oracle.listen();
        oracle.now += Time(1);
        if oracle.now.0 % schedule.slot.0 == 0 {
            oracle.end_slot();
        }
    }
    let key = |it: &Delivery| (it.visible, it.to, it.arrives, it.from, it.sequence);
    oracle.story.fates.sort_by_key(key);
    oracle.story
}

impl Oracle<'_> {
    fn duration(bytes: usize, baud: u32) -> Time {
        let bits = 10.0 * (bytes as f64 + 7.0);
        Time((bits * 1e6 / f64::from(baud)).ceil() as i64)
    }

    fn ends(sent: &Sent) -> Option<Time> {
        Some(sent.begins? + Self::duration(sent.payload.len(), sent.baud))
    }

    /// Moves messages that are visible now to their receivers.
    fn show(&mut self) {
        for (coming, inbox) in self.coming.iter_mut().zip(&mut self.inbox) {
            let is_due = |it: &mut Delivery| it.visible <= self.now;
            for fate in coming.extract_if(.., is_due) {
                if fate.outcome.is_ok() {
                    inbox.push(fate.clone());
                }
                self.story.fates.push(fate);
            }
        }
    }

    fn act(&mut self, robot: RobotId, deed: &Deed) {
        match deed {
            Deed::On { address, baud } => {
                self.on.insert(robot, (*address, *baud));
            }
            Deed::Send { to, payload } => {
                let Some(&(address, baud)) = self.on.get(&robot) else { return };
                let sequence = 1 + self.sent.iter().filter(|sent| sent.from == robot).count() as u64;
                self.queues[robot.index()].push_back(self.sent.len());
                self.sent.push(Sent {
                    from: robot,
                    sequence,
                    to: *to,
                    payload: payload.clone(),
                    address,
                    baud,
                    at: self.now,
                    begins: None,
                    disturbed: BTreeSet::new(),
                    is_decided: false,
                });
            }
            Deed::Read => {
                let inbox = &mut self.inbox[robot.index()];
                let first = (0..inbox.len()).min_by_key(|index| {
                    let it = &inbox[*index];
                    (it.arrives, it.from, it.sequence)
                });
                if let Some(index) = first.filter(|_| self.on.contains_key(&robot)) {
                    let message = inbox.remove(index);
                    self.story.read.push((self.now, robot, message.from, message.sequence));
                }
            }
            Deed::Off => {}
        }
    }

    fn switch_off(&mut self, robot: RobotId) {
        if self.on.remove(&robot).is_none() {
            return;
        }
        self.inbox[robot.index()].clear();
        for fate in self.coming[robot.index()].drain(..) {
            self.story.fates.push(Delivery { outcome: fate.outcome.and(Err(Loss::Off)), ..fate });
        }
        let slot_start = self.now.floor_to(self.schedule.slot);
        let is_kept = |index: &usize| self.schedule.model.medium == Medium::Free && self.sent[*index].at < slot_start;
        let queue = std::mem::take(&mut self.queues[robot.index()]);
        self.queues[robot.index()] = queue.iter().copied().filter(is_kept).collect();
        // The reported arrival assumes that the transmission begins as soon as the transmitter is free.
        let mut free = self.sent.iter().filter(|sent| sent.from == robot).filter_map(Self::ends).max();
        for index in queue {
            let is_kept = self.queues[robot.index()].contains(&index);
            let slot_end = slot_start + self.schedule.slot;
            let sent = &mut self.sent[index];
            let begins = match self.schedule.model.medium {
                Medium::TokenRing => slot_end,
                _ => free.map_or(sent.at, |free| free.max(sent.at)),
            };
            let ends = begins + Self::duration(sent.payload.len(), sent.baud);
            free = Some(ends);
            if !is_kept {
                sent.is_decided = true;
                self.tell_sender(index, ends, slot_end, Loss::Unsent);
            }
        }
    }

    fn tell_sender(&mut self, index: usize, ends: Time, visible: Time, loss: Loss) {
        let sent = &self.sent[index];
        self.coming[sent.from.index()].push(Delivery {
            to: sent.from,
            from: sent.from,
            address: sent.address,
            sequence: sent.sequence,
            arrives: ends + self.schedule.model.latency,
            visible,
            outcome: Err(loss),
        });
    }

    /// Starts transmissions of stations that may send.
    fn transmit(&mut self) {
        if self.schedule.model.medium == Medium::TokenRing {
            return self.turn();
        }
        for robot in 0..self.queues.len() {
            let own = self.sent.iter().filter(|sent| sent.from.index() == robot);
            let is_busy = own.filter_map(Self::ends).any(|ends| ends > self.now);
            if !is_busy && let Some(index) = self.queues[robot].pop_front() {
                self.sent[index].begins = Some(self.now);
            }
        }
    }

    /// Lets the holder of the token send a message or pass the token on.
    fn turn(&mut self) {
        let Some((owner, at, life)) = self.token else { return };
        if at != self.now {
            return;
        }
        let index = self.ring.iter().position(|(robot, _)| *robot == owner).expect("it is in the ring");
        let mut frame = Self::duration(0, self.ring[index].1);
        if let Some(message) = self.queues[owner.index()].pop_front() {
            self.sent[message].begins = Some(at);
            frame = Self::duration(self.sent[message].payload.len(), self.sent[message].baud);
        }
        let (next, _) = self.ring[(index + 1) % self.ring.len()];
        let RadioNoise { bit_error_rate, packet_loss } = self.schedule.errors[next.index()];
        let mut risk = 0.0;
        if self.ring.len() > 1 {
            risk -= if packet_loss > 0.0 { ln_1p(-packet_loss) } else { 0.0 };
            risk -= if bit_error_rate > 0.0 { 56.0 * ln_1p(-bit_error_rate) } else { 0.0 };
        }
        if risk <= life {
            self.token = Some((next, at + frame, life - risk));
        } else {
            self.make_token(next, at + frame);
        }
    }

    /// Creates a token at `maker` after silence that began at `silent`.
    fn make_token(&mut self, maker: RobotId, silent: Time) {
        let (_, baud) = *self.ring.iter().find(|(robot, _)| *robot == maker).expect("it is in the ring");
        // Two frames of silence, a poll, and an answer from each other station.
        let frames = 2 + 1 + (self.ring.len() as i64 - 1);
        let mut stream = Stream::new(self.schedule.seed, RobotId(0), Purpose::Token, 0, self.tokens);
        self.tokens += 1;
        let at = silent + Time(frames * Self::duration(0, baud).0);
        self.token = Some((maker, at, -ln(1.0 - stream.unit())));
    }

    /// Records overlapping transmissions at each receiver.
    fn listen(&mut self) {
        let is_on_air = |sent: &Sent| {
            sent.begins.is_some_and(|begins| begins <= self.now) && Self::ends(sent).is_some_and(|ends| ends > self.now)
        };
        let on_air: Vec<usize> = (0..self.sent.len()).filter(|index| is_on_air(&self.sent[*index])).collect();
        for receiver in (0..self.queues.len()).map(RobotId::from_index) {
            let is_heard = |index: &&usize| {
                let from = self.sent[**index].from;
                let reaches = |(robot, _): &(RobotId, Loss)| *robot != receiver;
                from == receiver || self.schedule.out_of_reach[from.index()].iter().all(reaches)
            };
            let audible: Vec<usize> = on_air.iter().filter(is_heard).copied().collect();
            for index in &on_air {
                if audible.iter().any(|other| other != index) {
                    self.sent[*index].disturbed.insert(receiver);
                }
            }
        }
    }

    /// Processes the end of a slot at `now`.
    fn end_slot(&mut self) {
        let Schedule { model, .. } = *self.schedule;
        let owner = self.token.map(|(owner, at, _)| (owner, at));
        self.ring = self.on.iter().map(|(robot, (_, baud))| (*robot, *baud)).collect();
        match owner {
            _ if self.ring.is_empty() => self.token = None,
            None if model.medium == Medium::TokenRing => self.make_token(self.ring[0].0, self.now),
            Some((owner, at)) if self.ring.iter().all(|(robot, _)| *robot != owner) => {
                let following = self.ring.iter().find(|(robot, _)| *robot > owner).unwrap_or(&self.ring[0]);
                self.make_token(following.0, at);
            }
            _ => {}
        }
        // A free medium takes every message at once; its transmitters then work through them independently.
        let mut free = vec![Time::ZERO; self.queues.len()];
        for index in 0..self.sent.len() {
            let sent = &self.sent[index];
            let duration = Self::duration(sent.payload.len(), sent.baud);
            let is_kept = sent.begins.is_some() || self.queues[sent.from.index()].contains(&index);
            let ends = match model.medium {
                Medium::Free => sent.begins.unwrap_or(free[sent.from.index()].max(sent.at)) + duration,
                _ => Self::ends(sent).unwrap_or(Time::NEVER),
            };
            if is_kept {
                free[sent.from.index()] = ends;
            }
            let is_due = model.medium == Medium::Free || ends + model.latency <= self.now;
            if is_kept && !sent.is_decided && is_due {
                self.sent[index].is_decided = true;
                self.decide(index, ends);
            }
        }
    }

    fn decide(&mut self, index: usize, ends: Time) {
        let arrives = ends + self.schedule.model.latency;
        let visible = arrives.max(self.now);
        let mut is_nobody = true;
        for (robot, (address, baud)) in self.on.clone() {
            let sent = &self.sent[index];
            if robot == sent.from || (sent.to != Address::All && sent.to != Address::One(address)) {
                continue;
            }
            is_nobody = false;
            let far = self.schedule.out_of_reach[sent.from.index()].iter().find(|(other, _)| *other == robot);
            let is_met = self.schedule.model.medium == Medium::Aloha && sent.disturbed.contains(&robot);
            let radio = self.schedule.errors[robot.index()];
            let mut stream = Stream::new(self.schedule.seed, robot, Purpose::Radio, sent.from.0, sent.sequence);
            let outcome = if let Some((_, loss)) = far {
                Err(*loss)
            } else if sent.baud != baud {
                Err(Loss::Baud)
            } else if is_met {
                Err(Loss::Collision)
            } else if stream.unit() < radio.packet_loss {
                Err(Loss::Packet)
            } else {
                // At an error rate of 1 every bit is wrong.
                let mask = if radio.bit_error_rate == 1.0 { 0xff } else { 0 };
                let payload: Vec<u8> = sent.payload.iter().map(|byte| byte ^ mask).collect();
                let bit_errors = if mask == 0 { 0 } else { 8 * payload.len() as u32 };
                Ok(Arrived { payload, bit_errors })
            };
            let Sent { from, address, sequence, .. } = *sent;
            self.coming[robot.index()].push(Delivery { to: robot, from, address, sequence, arrives, visible, outcome });
        }
        if is_nobody {
            self.tell_sender(index, ends, visible, Loss::Nobody);
        }
    }
}
