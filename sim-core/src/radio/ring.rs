//! The virtual token ring: who has the token when.
//!
//! The stations that are on hand the token round in the order of their robots. Who gets it and has something to send sends one
//! message, which passes it on; who has not sends a token frame, a header without payload. A station joins and leaves at the end of
//! a slot. A token that its next owner does not hear is lost. All hear the silence that follows, and each waits the longer the farther
//! behind the last sender it stands: so the one that missed its turn is the first to act. After [`SILENCE`] frames it polls with
//! a wild card, to which each of the others answers in turn, and goes on with a new token. Whoever missed the token is thus served
//! next, and nobody starves.
//!
//! Source: the network of the EyeBot has token, time-out and wild card; who polls, and how long it takes, is our choice, as is that
//! only a token is lost, never a poll, and that the ring hears it at whatever speed, distance and wall.

use std::collections::{BTreeMap, VecDeque};

use crate::RobotId;
use crate::math::ln;
use crate::noise::{Purpose, Radio, Stream};
use crate::time::Time;

use super::{HEADER, Member, Off, Sending, air_time};

/// So many token frames long is nothing heard before the token is taken for lost.
pub const SILENCE: i64 = 2;

/// The ring as it stands at some instant, which is that of the token.
#[derive(Clone, Debug, Default)]
pub(super) struct Ring {
    seed: u64,
    /// In the order of their robots.
    nodes: Vec<Node>,
    /// What a round without messages takes, and what it takes off the token's life.
    round: (Time, u128),
    /// None without stations.
    token: Option<Token>,
    /// How many tokens there were before the ring was last without stations.
    tokens: u64,
    /// What waits for the token, sender by sender.
    queues: BTreeMap<RobotId, VecDeque<Queued>>,
}

/// A station in the ring.
#[derive(Clone, Copy, Debug)]
struct Node {
    robot: RobotId,
    /// How long its token frame is on the air.
    frame: Time,
    /// What passing the token to it takes off the token's life.
    hazard: u128,
}

#[derive(Clone, Copy, Debug)]
struct Token {
    /// Who has it, or gets it next: its place among the nodes.
    place: usize,
    /// From when on.
    at: Time,
    /// How many there were before it.
    number: u64,
    /// It is lost on the pass whose hazard is greater than what is left of this.
    life: u128,
}

#[derive(Clone, Debug)]
struct Queued {
    sending: Sending,
    /// It is not sent after this.
    until: Time,
}

impl Ring {
    pub fn new(seed: u64) -> Self {
        Self { seed, ..Self::default() }
    }

    /// Takes messages that wait for the token, those of each sender in the order of their numbers.
    pub fn queue(&mut self, sendings: impl IntoIterator<Item = Sending>) {
        for sending in sendings {
            self.queues.entry(sending.from).or_default().push_back(Queued { sending, until: Time::NEVER });
        }
    }

    /// Whose station was switched off sends nothing of what it had after that.
    pub fn stop(&mut self, off: &Off) {
        for queued in self.queues.get_mut(&off.robot).into_iter().flatten() {
            if queued.sending.sequence <= off.last_sequence {
                queued.until = queued.until.min(off.at);
            }
        }
    }

    /// Lets the token go round until `time`: what is sent on the way, and when each begins.
    pub fn advance(&mut self, time: Time) -> Vec<(Sending, Time)> {
        let mut sent = Vec::new();
        let Some(mut token) = self.token else { return sent };
        loop {
            self.go_round(&mut token, time);
            if token.at >= time {
                break;
            }
            let holder = self.nodes[token.place];
            let queue = self.queues.get_mut(&holder.robot).expect("it has something to send");
            let place = queue.iter().position(|queued| token.at <= queued.until).expect("it has something to send");
            let Queued { sending, .. } = queue.remove(place).expect("it is there");
            let ends = token.at + air_time(sending.payload.len(), sending.baud);
            sent.push((sending, token.at));
            self.pass(&mut token, ends);
        }
        self.token = Some(token);
        sent
    }

    /// When the next message has been sent, if nobody sends another one until then; [`Time::NEVER`] without any.
    pub fn next_end(&self) -> Time {
        let Some(mut token) = self.token.filter(|_| !self.queues.is_empty()) else { return Time::NEVER };
        self.go_round(&mut token, Time::NEVER);
        let ready = self.ready(self.nodes[token.place].robot, token.at);
        ready.map_or(Time::NEVER, |sending| token.at + air_time(sending.payload.len(), sending.baud))
    }

    /// From `time` on these are in the ring, in the order of their robots.
    pub fn set_members(&mut self, members: &[Member], radio_of: impl Fn(RobotId) -> Radio, time: Time) {
        let was = self.token.map(|token| (self.nodes[token.place].robot, token));
        self.nodes.clear();
        self.nodes.extend(members.iter().map(|member| Node {
            robot: member.robot,
            frame: air_time(0, member.baud),
            // Nobody is to hear what the only one hands to itself.
            hazard: if members.len() > 1 { hazard(radio_of(member.robot)) } else { 0 },
        }));
        let sum = |(time, all): (Time, u128), node: &Node| (time + node.frame, all.saturating_add(node.hazard));
        self.round = self.nodes.iter().fold((Time::ZERO, 0), sum);
        self.tokens = was.map_or(self.tokens, |(_, token)| token.number + 1);
        self.token = match was {
            _ if self.nodes.is_empty() => None,
            None => Some(self.renewed(0, time, self.tokens)),
            Some((owner, token)) => Some(match self.nodes.binary_search_by_key(&owner, |node| node.robot) {
                Ok(place) => Token { place, ..token },
                // It went to nobody.
                Err(place) => self.renewed(place % self.nodes.len(), token.at, token.number + 1),
            }),
        };
    }

    /// Takes away all that waits for the token.
    pub fn take_queued(&mut self) -> Vec<Sending> {
        std::mem::take(&mut self.queues).into_values().flatten().map(|queued| queued.sending).collect()
    }

    /// Takes away what is never sent: what was stopped, and what those have who are not in the ring.
    pub fn take_unsent(&mut self) -> Vec<Sending> {
        let is_in = |robot| self.nodes.binary_search_by_key(&robot, |node| node.robot).is_ok();
        let mut unsent = Vec::new();
        for (robot, queue) in &mut self.queues {
            let is_out = !is_in(*robot);
            let (over, kept) = queue.drain(..).partition(|queued| is_out || queued.until < Time::NEVER);
            *queue = kept;
            unsent.extend(VecDeque::into_iter(over).map(|queued| queued.sending));
        }
        self.queues.retain(|_, queue| !queue.is_empty());
        unsent
    }

    /// Hands the token on until somebody who has it has something to send, or `time` is reached.
    fn go_round(&self, token: &mut Token, time: Time) {
        let mut first_sent = None;
        while token.at < time && self.ready(self.nodes[token.place].robot, token.at).is_none() {
            let first = *first_sent.get_or_insert_with(|| {
                self.queues.values().filter_map(VecDeque::front).map(|queued| queued.sending.sent).min()
            });
            // Whole rounds in which nothing is sent and nothing lost.
            let idle = first.map_or(time, |first| first.min(time)) - token.at;
            let (round, hazard) = self.round;
            let rounds = if idle < round { 0 } else { (idle.0 / round.0).min(lives(token.life, hazard)) };
            if rounds > 0 {
                token.at += Time(round.0 * rounds);
                token.life -= hazard * u128::from(rounds.unsigned_abs());
            } else {
                self.pass(token, token.at + self.nodes[token.place].frame);
            }
        }
    }

    /// What `robot` sends if it has the token at `time`.
    fn ready(&self, robot: RobotId, time: Time) -> Option<&Sending> {
        let queued = self.queues.get(&robot)?.iter().find(|queued| time <= queued.until)?;
        (queued.sending.sent <= time).then_some(&queued.sending)
    }

    /// The owner of the token, who sends until `ends`, hands it on.
    fn pass(&self, token: &mut Token, ends: Time) {
        let place = (token.place + 1) % self.nodes.len();
        let Node { hazard, .. } = self.nodes[place];
        *token = if hazard <= token.life {
            Token { place, at: ends, life: token.life - hazard, ..*token }
        } else {
            self.renewed(place, ends, token.number + 1)
        };
    }

    /// The token that is made after nobody has heard anything from `time` on.
    fn renewed(&self, place: usize, time: Time, number: u64) -> Token {
        // The silence, the poll, and an answer of each of the others.
        let frames = SILENCE + self.nodes.len() as i64;
        let at = time + Time(self.nodes[place].frame.0.saturating_mul(frames));
        let mut stream = Stream::new(self.seed, RobotId(0), Purpose::Token, 0, number);
        Token { place, at, number, life: fixed(-ln(1.0 - stream.unit())) }
    }
}

/// How much of a token's life it takes that `radio` is to hear its frame: it survives with the probability that no bit of it is lost.
fn hazard(radio: Radio) -> u128 {
    fixed(radio.hazard(8 * HEADER as u32))
}

/// With 80 bits behind the point, so that what is left of a life is the same however its passes are counted up.
fn fixed(number: f64) -> u128 {
    // `as` saturates.
    (number * (1_u128 << 80) as f64) as u128
}

/// How often `hazard` fits into `life`.
fn lives(life: u128, hazard: u128) -> i64 {
    life.checked_div(hazard).and_then(|count| i64::try_from(count).ok()).unwrap_or(i64::MAX)
}
