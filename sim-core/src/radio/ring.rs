//! Virtual token ring: position of the token over time.
//!
//! The stations that are on pass the token round in the order of their robots. A holder with a message sends one
//! message, which also passes the token on. A holder without a message sends a token frame, a header without payload.
//! Stations join and leave at the end of a slot.
//!
//! A token that its next owner does not receive is lost, and a silence follows that all stations hear. The time-out of
//! a station grows with its distance behind the last sender, so the station that missed its turn acts first. After
//! [`SILENCE`] frames that station polls with a wild card (a frame to all stations), which each other station answers
//! in turn. The polling station then continues with a new token. So a station that missed the token is served next, and
//! no station starves.
//!
//! Source: the network of the EyeBot has token, time-out and wild card. The choice of the polling station and the
//! durations are our own. We also chose that polls are never lost, and that the ring hears tokens and polls at any
//! speed and distance and through walls.

use std::collections::{BTreeMap, VecDeque};

use crate::RobotId;
use crate::math::ln;
use crate::noise::{Purpose, RadioNoise, Stream};
use crate::time::Time;

use super::{HEADER, SentMessage, StationInfo, SwitchedOff, air_time};

/// Length of the silence after which the token counts as lost, in token frames.
pub const SILENCE: i64 = 2;

/// State of the token ring.
///
/// Losses of tokens are drawn once per token, as its life: an exponential random number. The hazard of a pass is -ln of
/// the probability that the token frame arrives; the token is lost when the sum of hazards exceeds its life.
#[derive(Clone, Debug, Default)]
pub(super) struct Ring {
    seed: u64,
    /// Stations in the order of their robots.
    nodes: Vec<Node>,
    /// Duration of a round without messages, and the sum of its hazards.
    round: (Time, u128),
    /// `None` without stations.
    token: Option<Token>,
    /// Number of tokens made before the ring was last without stations.
    tokens: u64,
    /// Messages that wait for the token, by sender.
    queues: BTreeMap<RobotId, VecDeque<Queued>>,
}

/// A station in the ring.
#[derive(Clone, Copy, Debug)]
struct Node {
    robot: RobotId,
    /// Duration of its token frame.
    frame: Time,
    /// Hazard of passing the token to this station.
    hazard: u128,
}

#[derive(Clone, Copy, Debug)]
struct Token {
    /// Index of the present or next holder among the nodes.
    holder_index: usize,
    /// Time from which the holder has the token.
    at: Time,
    /// Number of tokens before this one.
    number: u64,
    /// Remaining life. The token is lost on the first pass whose hazard exceeds this value.
    life: u128,
}

#[derive(Clone, Debug)]
struct Queued {
    sending: SentMessage,
    /// The message is not sent after this time.
    until: Time,
}

impl Ring {
    pub fn new(seed: u64) -> Self {
        Self { seed, ..Self::default() }
    }

    /// Queues messages that wait for the token; those of each sender in the order of their numbers.
    pub fn queue(&mut self, sendings: impl IntoIterator<Item = SentMessage>) {
        for sending in sendings {
            self.queues.entry(sending.from).or_default().push_back(Queued { sending, until: Time::NEVER });
        }
    }

    /// Handles a station that was switched off: messages queued by then are not sent later.
    pub fn stop(&mut self, off: &SwitchedOff) {
        for queued in self.queues.get_mut(&off.robot).into_iter().flatten() {
            if queued.sending.sequence <= off.last_sequence {
                queued.until = queued.until.min(off.at);
            }
        }
    }

    /// Passes the token round until `time`; returns the messages sent on the way with the start of each transmission.
    pub fn advance(&mut self, time: Time) -> Vec<(SentMessage, Time)> {
        let mut sent = Vec::new();
        let Some(mut token) = self.token else { return sent };
        loop {
            self.go_round(&mut token, time);
            if token.at >= time {
                break;
            }
            let holder = self.nodes[token.holder_index];
            let queue = self.queues.get_mut(&holder.robot).expect("it has something to send");
            let index = queue.iter().position(|queued| token.at <= queued.until).expect("it has something to send");
            let Queued { sending, .. } = queue.remove(index).expect("it is there");
            let ends = token.at + air_time(sending.payload.len(), sending.baud);
            sent.push((sending, token.at));
            self.pass(&mut token, ends);
        }
        self.token = Some(token);
        sent
    }

    /// End of the next transmission if no other message is queued before; [`Time::NEVER`] if no message is queued.
    pub fn next_end(&self) -> Time {
        let Some(mut token) = self.token.filter(|_| !self.queues.is_empty()) else { return Time::NEVER };
        self.go_round(&mut token, Time::NEVER);
        let ready = self.ready(self.nodes[token.holder_index].robot, token.at);
        ready.map_or(Time::NEVER, |sending| token.at + air_time(sending.payload.len(), sending.baud))
    }

    /// Sets the members of the ring from `time` on, in the order of their robots.
    pub fn set_members(&mut self, members: &[StationInfo], radio_of: impl Fn(RobotId) -> RadioNoise, time: Time) {
        let was = self.token.map(|token| (self.nodes[token.holder_index].robot, token));
        self.nodes.clear();
        self.nodes.extend(members.iter().map(|member| Node {
            robot: member.robot,
            frame: air_time(0, member.baud),
            // A single station passes the token to itself: no reception, no loss.
            hazard: if members.len() > 1 { hazard(radio_of(member.robot)) } else { 0 },
        }));
        let sum = |(time, all): (Time, u128), node: &Node| (time + node.frame, all.saturating_add(node.hazard));
        self.round = self.nodes.iter().fold((Time::ZERO, 0), sum);
        self.tokens = was.map_or(self.tokens, |(_, token)| token.number + 1);
        self.token = match was {
            _ if self.nodes.is_empty() => None,
            None => Some(self.renewed(0, time, self.tokens)),
            Some((owner, token)) => Some(match self.nodes.binary_search_by_key(&owner, |node| node.robot) {
                Ok(holder_index) => Token { holder_index, ..token },
                // The holder has left the ring, and its token is lost.
                Err(holder_index) => self.renewed(holder_index % self.nodes.len(), token.at, token.number + 1),
            }),
        };
    }

    /// Removes and returns all messages that wait for the token.
    pub fn take_queued(&mut self) -> Vec<SentMessage> {
        std::mem::take(&mut self.queues).into_values().flatten().map(|queued| queued.sending).collect()
    }

    /// Removes and returns messages that are never sent: stopped ones, and those of robots that are not in the ring.
    pub fn take_unsent(&mut self) -> Vec<SentMessage> {
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

    /// Passes the token on until a holder has a message to send, or `time` is reached.
    fn go_round(&self, token: &mut Token, time: Time) {
        let mut first_sent = None;
        while token.at < time && self.ready(self.nodes[token.holder_index].robot, token.at).is_none() {
            let first = *first_sent.get_or_insert_with(|| {
                self.queues.values().filter_map(VecDeque::front).map(|queued| queued.sending.sent).min()
            });
            // Skips whole rounds in which nothing is sent or lost.
            let idle = first.map_or(time, |first| first.min(time)) - token.at;
            let (round, hazard) = self.round;
            let rounds = if idle < round { 0 } else { (idle.0 / round.0).min(lives(token.life, hazard)) };
            if rounds > 0 {
                token.at += Time(round.0 * rounds);
                token.life -= hazard * u128::from(rounds.unsigned_abs());
            } else {
                self.pass(token, token.at + self.nodes[token.holder_index].frame);
            }
        }
    }

    /// Message that `robot` sends if it has the token at `time`.
    fn ready(&self, robot: RobotId, time: Time) -> Option<&SentMessage> {
        let queued = self.queues.get(&robot)?.iter().find(|queued| time <= queued.until)?;
        (queued.sending.sent <= time).then_some(&queued.sending)
    }

    /// Passes the token on from its holder, which sends until `ends`.
    fn pass(&self, token: &mut Token, ends: Time) {
        let holder_index = (token.holder_index + 1) % self.nodes.len();
        let Node { hazard, .. } = self.nodes[holder_index];
        *token = if hazard <= token.life {
            Token { holder_index, at: ends, life: token.life - hazard, ..*token }
        } else {
            self.renewed(holder_index, ends, token.number + 1)
        };
    }

    /// New token, created after a silence that began at `time`.
    fn renewed(&self, holder_index: usize, time: Time, number: u64) -> Token {
        // The silence, the poll, and an answer from each other station.
        let frames = SILENCE + self.nodes.len() as i64;
        let at = time + Time(self.nodes[holder_index].frame.0.saturating_mul(frames));
        let mut stream = Stream::new(self.seed, RobotId(0), Purpose::Token, 0, number);
        Token { holder_index, at, number, life: fixed(-ln(1.0 - stream.unit())) }
    }
}

/// Hazard of receiving a token frame with `radio`: -ln of the probability that the frame arrives without error.
fn hazard(radio: RadioNoise) -> u128 {
    fixed(radio.hazard(8 * HEADER as u32))
}

/// Fixed-point number with 80 fractional bits. Its sums are exact, so the remaining life does not depend on the
/// grouping of passes.
fn fixed(number: f64) -> u128 {
    // `as` saturates.
    (number * (1_u128 << 80) as f64) as u128
}

/// Number of passes with `hazard` that `life` lasts.
fn lives(life: u128, hazard: u128) -> i64 {
    life.checked_div(hazard).and_then(|count| i64::try_from(count).ok()).unwrap_or(i64::MAX)
}
