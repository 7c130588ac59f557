//! Virtual token ring: position of the token over time.
//!
//! The stations that are on pass the token round in the order of their robots. A holder with a message sends one
//! message, which also passes the token on. A holder without a message sends a token frame, a header without payload.
//! Stations join and leave at the end of a simulation slot.
//!
//! A token that the next holder does not receive is lost, and a silence follows that all stations hear. The time-out of
//! a station grows with the number of stations between the last sender and that station, so the station that missed its
//! turn acts first. After [`SILENCE_FRAMES`] frames that station polls with a wild card (a frame to all stations), and
//! all other stations answer in turn. The polling station then continues with a new token. A station that missed the
//! token therefore sends next, and no station starves.
//!
//! Source: the network of the EyeBot has token, time-out and wild card. The choice of the polling station and the
//! durations are ours. These simplifications are ours too: polls are never lost, and neither a station's baud rate, nor
//! its distance, nor a wall affects its reception of tokens and polls.

use std::collections::{BTreeMap, VecDeque};

use crate::RobotId;
use crate::math::ln;
use crate::noise::{Purpose, RadioNoise, Stream};
use crate::time::Time;

use super::{HEADER_BYTES, OutgoingMessage, StationInfo, SwitchedOff, air_time};

/// Duration of the silence after which the stations regard the token as lost, in token frames.
pub const SILENCE_FRAMES: i64 = 2;

/// State of the token ring.
///
/// A token has a life, a random number from the exponential distribution with mean 1 that is drawn when the token is
/// created. The hazard of a pass is -ln of the probability that the token frame arrives. The token is lost on the pass
/// at which the sum of the hazards since its creation exceeds its life.
#[derive(Clone, Debug, Default)]
pub(super) struct Ring {
    seed: u64,
    /// Stations in the order of their robots.
    stations: Vec<RingStation>,
    /// Duration of a round without messages, and the sum of its hazards.
    round: (Time, u128),
    /// `None` without stations.
    token: Option<Token>,
    /// Number of the next token if the ring has none: the number of tokens created so far.
    next_token: u64,
    /// Messages that wait for the token, by sender.
    queues: BTreeMap<RobotId, VecDeque<Queued>>,
}

/// A station in the ring.
#[derive(Clone, Copy, Debug)]
struct RingStation {
    robot: RobotId,
    /// Duration of its token frame.
    frame: Time,
    /// Hazard of passing the token to this station.
    hazard: u128,
}

#[derive(Clone, Copy, Debug)]
struct Token {
    /// Index of the present or next holder in the ring's stations.
    holder_index: usize,
    /// Time from which the holder has the token.
    at: Time,
    /// Number of tokens created before this one.
    number: u64,
    /// Remaining life. The token is lost on the first pass whose hazard exceeds this value.
    life: u128,
}

#[derive(Clone, Debug)]
struct Queued {
    message: OutgoingMessage,
    /// No transmission of the message begins after this time.
    until: Time,
}

impl Ring {
    pub fn new(seed: u64) -> Self {
        Self { seed, ..Self::default() }
    }

    /// Queues messages that wait for the token. The messages of each sender must be in the order of their sequence
    /// numbers.
    pub fn queue(&mut self, messages: impl IntoIterator<Item = OutgoingMessage>) {
        for message in messages {
            self.queues.entry(message.from).or_default().push_back(Queued { message, until: Time::NEVER });
        }
    }

    /// Handles a station that was switched off: messages that it had queued before then are not transmitted after
    /// `off.at`.
    pub fn stop(&mut self, off: &SwitchedOff) {
        for queued in self.queues.get_mut(&off.robot).into_iter().flatten() {
            if queued.message.sequence <= off.last_sequence {
                queued.until = queued.until.min(off.at);
            }
        }
    }

    /// Passes the token round until `time`; returns the messages whose transmission begins before then, each with this
    /// instant.
    pub fn advance(&mut self, time: Time) -> Vec<(OutgoingMessage, Time)> {
        let mut started = Vec::new();
        let Some(mut token) = self.token else { return started };
        loop {
            self.go_round(&mut token, time);
            if token.at >= time {
                break;
            }
            let holder = self.stations[token.holder_index];
            let queue = self.queues.get_mut(&holder.robot).expect("the holder has a message");
            let index = queue.iter().position(|queued| token.at <= queued.until).expect("the holder has a message");
            let Queued { message, .. } = queue.remove(index).expect("the index is valid");
            let ends = token.at + air_time(message.payload.len(), message.baud);
            started.push((message, token.at));
            self.pass(&mut token, ends);
        }
        self.token = Some(token);
        started
    }

    /// End of the next transmission if no other message is queued before; [`Time::NEVER`] if no message is queued.
    /// Every queued message must be transmitted at some time ([`Ring::take_untransmitted`]).
    pub fn next_end(&self) -> Time {
        let Some(mut token) = self.token.filter(|_| !self.queues.is_empty()) else { return Time::NEVER };
        self.go_round(&mut token, Time::NEVER);
        let message = self.next_message(self.stations[token.holder_index].robot, token.at);
        message.map_or(Time::NEVER, |message| token.at + air_time(message.payload.len(), message.baud))
    }

    /// Sets the members of the ring from `time` on, in the order of their robots.
    pub fn set_members(&mut self, members: &[StationInfo], noise_of: impl Fn(RobotId) -> RadioNoise, time: Time) {
        let previous = self.token.map(|token| (self.stations[token.holder_index].robot, token));
        self.stations.clear();
        self.stations.extend(members.iter().map(|member| RingStation {
            robot: member.robot,
            frame: air_time(0, member.baud),
            // A single station passes the token to itself, without a reception, so the token cannot be lost.
            hazard: if members.len() > 1 { hazard(noise_of(member.robot)) } else { 0 },
        }));
        let sum = |(duration, hazard_sum): (Time, u128), station: &RingStation| {
            (duration + station.frame, hazard_sum.saturating_add(station.hazard))
        };
        self.round = self.stations.iter().fold((Time::ZERO, 0), sum);
        self.next_token = previous.map_or(self.next_token, |(_, token)| token.number + 1);
        self.token = match previous {
            _ if self.stations.is_empty() => None,
            None => Some(self.new_token(0, time, self.next_token)),
            Some((holder, token)) => Some(match self.stations.binary_search_by_key(&holder, |station| station.robot) {
                Ok(holder_index) => Token { holder_index, ..token },
                // The holder has left the ring, and its token is lost.
                Err(holder_index) => self.new_token(holder_index % self.stations.len(), token.at, token.number + 1),
            }),
        };
    }

    /// Removes and returns all messages that wait for the token.
    pub fn take_queued(&mut self) -> Vec<OutgoingMessage> {
        std::mem::take(&mut self.queues).into_values().flatten().map(|queued| queued.message).collect()
    }

    /// Removes and returns messages that are never transmitted: those with a time limit ([`Ring::stop`]), and those of
    /// robots that are not in the ring.
    pub fn take_untransmitted(&mut self) -> Vec<OutgoingMessage> {
        let is_in_ring = |robot| self.stations.binary_search_by_key(&robot, |station| station.robot).is_ok();
        let mut untransmitted = Vec::new();
        for (robot, queue) in &mut self.queues {
            let is_outside = !is_in_ring(*robot);
            let (expired, kept) = queue.drain(..).partition(|queued| is_outside || queued.until < Time::NEVER);
            *queue = kept;
            untransmitted.extend(VecDeque::into_iter(expired).map(|queued| queued.message));
        }
        self.queues.retain(|_, queue| !queue.is_empty());
        untransmitted
    }

    /// Passes the token on until a holder has a message to send or `time` is reached. If `time` is [`Time::NEVER`],
    /// each queued message must have a member of the ring as its sender and no time limit, or the loop does not end.
    fn go_round(&self, token: &mut Token, time: Time) {
        let mut earliest_message = None;
        while token.at < time && self.next_message(self.stations[token.holder_index].robot, token.at).is_none() {
            let earliest = *earliest_message.get_or_insert_with(|| {
                self.queues.values().filter_map(VecDeque::front).map(|queued| queued.message.queued_at).min()
            });
            // Skips whole rounds in which no message is transmitted and no token is lost.
            let idle = earliest.map_or(time, |queued_at| queued_at.min(time)) - token.at;
            let (round, hazard) = self.round;
            let rounds = if idle < round { 0 } else { (idle.0 / round.0).min(survivable_times(token.life, hazard)) };
            if rounds > 0 {
                token.at += Time(round.0 * rounds);
                token.life -= hazard * u128::from(rounds.unsigned_abs());
            } else {
                self.pass(token, token.at + self.stations[token.holder_index].frame);
            }
        }
    }

    /// Message that `robot` transmits if it has the token at `time`.
    fn next_message(&self, robot: RobotId, time: Time) -> Option<&OutgoingMessage> {
        let queued = self.queues.get(&robot)?.iter().find(|queued| time <= queued.until)?;
        (queued.message.queued_at <= time).then_some(&queued.message)
    }

    /// Passes the token on from its holder, which sends until `ends`.
    fn pass(&self, token: &mut Token, ends: Time) {
        let holder_index = (token.holder_index + 1) % self.stations.len();
        let RingStation { hazard, .. } = self.stations[holder_index];
        *token = if hazard <= token.life {
            Token { holder_index, at: ends, life: token.life - hazard, ..*token }
        } else {
            self.new_token(holder_index, ends, token.number + 1)
        };
    }

    /// New token for the holder at `holder_index`, created after a silence that begins at `time`.
    fn new_token(&self, holder_index: usize, time: Time, number: u64) -> Token {
        // The frames of the silence, one of the poll, and one of the answer of each other station.
        let frames = SILENCE_FRAMES + self.stations.len() as i64;
        let at = time + Time(self.stations[holder_index].frame.0.saturating_mul(frames));
        let mut stream = Stream::new(self.seed, RobotId(0), Purpose::Token, 0, number);
        Token { holder_index, at, number, life: fixed(-ln(1.0 - stream.unit())) }
    }
}

/// Hazard of passing a token frame to a receiver with the noise model `noise`: -ln of the probability that the frame
/// arrives without error.
fn hazard(noise: RadioNoise) -> u128 {
    fixed(noise.hazard(8 * HEADER_BYTES as u32))
}

/// Fixed-point number with 80 fractional bits. Its sums are exact, so the remaining life does not depend on the
/// grouping of passes.
fn fixed(number: f64) -> u128 {
    // `as` saturates.
    (number * (1_u128 << 80) as f64) as u128
}

/// Number of times that `life` can be reduced by `hazard`.
fn survivable_times(life: u128, hazard: u128) -> i64 {
    life.checked_div(hazard).and_then(|count| i64::try_from(count).ok()).unwrap_or(i64::MAX)
}
