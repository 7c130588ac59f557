//! Shared media: ALOHA and the token ring.

use std::collections::BTreeMap;

use sim_core::math::exp;
use sim_core::noise::RadioNoise;
use sim_core::radio::{Address, Delivery, Medium, OutgoingMessage, air_time};
use sim_core::time::Time;

use super::*;

const SLOT: Time = Time::from_millis(50);
const COUNT: usize = 50_000;
/// Number of messages in a batch; successive messages are correlated, batches nearly uncorrelated.
const BATCH: usize = 1_000;
const OFFERED: [f64; 8] = [0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5];
const STATIONS: [u32; 4] = [2, 5, 10, 20];
const LOADS: [f64; 6] = [0.05, 0.2, 0.4, 0.6, 0.7, 0.8];

/// Throughput of unslotted ALOHA: many stations send messages at random instants to another station.
///
/// The formula is S = G exp(-2 G); source: Abramson 1970.
pub fn aloha(effort: Effort) -> Part {
    let (mut rows, mut points) = (Vec::new(), Vec::new());
    for g in OFFERED {
        let traffic = traffic(Medium::Aloha, 10_000, g, COUNT);
        let mut deliveries = Vec::new();
        let time_ns = nanoseconds(effort.of(3), COUNT, || deliveries = exchange(Medium::Aloha, 1, SLOT, &traffic));
        let received: Vec<f64> =
            deliveries.iter().map(|(_, delivery)| f64::from(u8::from(delivery.outcome.is_ok()))).collect();
        let (share, half_width) = batch_mean(&received);
        let point = Point { x: g, measured: g * share, half_width: g * half_width, expected: g * exp(-2.0 * g) };
        rows.push(row("ALOHA", format!("G = {g}"), &point, time_ns));
        points.push(point);
    }
    let curve = |name: &str, formula: fn(f64) -> f64| {
        let points = (0..=150).map(|step| f64::from(step) / 100.0).map(|g| (g, formula(g)));
        (name.to_owned(), points.collect())
    };
    let curves = vec![curve("G exp(-2 G)", |g| g * exp(-2.0 * g))];
    let labels = ["offered load G, messages in the time of one", "throughput S"];
    let title = "ALOHA: throughput against offered load";
    let picture = Comparison { name: "radio-aloha", title, labels, x_scale: Scale::Linear, curves, points };
    Part { rows, picture }
}

/// Waiting time of messages for the token.
///
/// Source of the formula: Takagi 1986, "Analysis of Polling Systems": symmetric stations, one message per visit,
/// Poisson arrivals.
pub fn token_ring(effort: Effort) -> Part {
    let air = air_time(BYTES, BAUD);
    let (mut rows, mut points, mut curves) = (Vec::new(), Vec::new(), Vec::new());
    for stations in STATIONS {
        for load in LOADS {
            let traffic = traffic(Medium::TokenRing, stations, load, COUNT);
            let mut deliveries = Vec::new();
            let time_ns =
                nanoseconds(effort.of(3), COUNT, || deliveries = exchange(Medium::TokenRing, stations, SLOT, &traffic));
            let wait = |(sent, delivery): &(Time, Delivery)| (delivery.arrives - air - *sent).seconds();
            let waits: Vec<f64> = deliveries.iter().map(wait).collect();
            let ((mean, half_width), expected) = (batch_mean(&waits), expected_wait(stations, load));
            let share = Point { x: load, measured: mean / expected, half_width: half_width / expected, expected: 1.0 };
            rows.push(row(&format!("token ring of {stations}"), format!("load {load}"), &share, time_ns));
            points.push(Point {
                x: load,
                measured: 1e3 * mean,
                half_width: 1e3 * half_width,
                expected: 1e3 * expected,
            });
        }
        let loads = (1..=80).map(|step| f64::from(step) / 100.0);
        curves.push((
            format!("{stations} stations"),
            loads.map(|load| (load, 1e3 * expected_wait(stations, load))).collect(),
        ));
    }
    let labels = ["load, share of the time on the air", "wait for the token, ms"];
    let title = "Token ring: mean wait for the token against load";
    let picture = Comparison { name: "radio-token-ring", title, labels, x_scale: Scale::Linear, curves, points };
    Part { rows, picture }
}

/// Mean wait in a ring of `stations`, s. The service time is the air time of a message minus that of a token frame,
/// since a token frame is sent from each station to the next in any case.
fn expected_wait(stations: u32, load: f64) -> f64 {
    let frame = air_time(0, BAUD).seconds();
    let service = air_time(BYTES, BAUD).seconds() - frame;
    let rate = load / (service + frame);
    let busy = rate * service;
    (rate * service * service + frame * (f64::from(stations) + busy)) / (2.0 * (1.0 - load))
}

/// Messages at random times with the offered load `load`, the mean number of messages in the air time of one message.
/// In a token ring each message goes from a random station to the next one. On other media the robots from 2 on send in
/// turn to robot 1.
pub fn traffic(medium: Medium, stations: u32, load: f64, count: usize) -> Vec<OutgoingMessage> {
    let mut stream = stream(stations, load.to_bits());
    let mean = air_time(BYTES, BAUD).seconds() / load;
    let mut seconds = 1.0;
    let message = |sequence: u64| {
        seconds += interarrival_time(&mut stream, mean);
        let sent = Time::from_seconds_ceil(seconds);
        let draw = (stream.unit() * f64::from(stations)) as u32;
        let (from, to, begins) = match medium {
            Medium::TokenRing => (1 + draw, 1 + (1 + draw) % stations, None),
            Medium::Free | Medium::Aloha => (2 + sequence as u32 % stations, 1, Some(sent)),
        };
        OutgoingMessage { begins, ..sent_message(from, sequence, Address::One(to), vec![0; BYTES], sent) }
    };
    (1..=count as u64).map(message).collect()
}

/// Sends `traffic` through a channel on which the stations 1 to `receivers` listen. Returns the time of sending and the
/// delivery of each message, in the order of sending.
pub fn exchange(medium: Medium, receivers: u32, slot: Time, traffic: &[OutgoingMessage]) -> Vec<(Time, Delivery)> {
    let mut channel = channel(medium, RadioNoise::default(), receivers);
    let mut deliveries = BTreeMap::new();
    let mut messages = traffic.iter().peekable();
    let mut slot_end = slot;
    loop {
        let sent = std::iter::from_fn(|| messages.next_if(|message| message.queued_at < slot_end)).cloned().collect();
        deliveries.extend(channel.exchange(slot_end, sent).into_iter().map(|delivery| (delivery.sequence, delivery)));
        let next = messages.peek().map_or(Time::NEVER, |message| message.queued_at).min(channel.due());
        if next == Time::NEVER {
            return traffic.iter().map(|message| message.queued_at).zip(deliveries.into_values()).collect();
        }
        slot_end = next.floor_to(slot) + slot;
    }
}

/// Mean of the values, and half of its 99.9 % interval.
fn batch_mean(values: &[f64]) -> (f64, f64) {
    let batches: Vec<f64> = values.chunks(BATCH).map(|batch| batch.iter().sum::<f64>() / batch.len() as f64).collect();
    mean_of(&batches)
}
