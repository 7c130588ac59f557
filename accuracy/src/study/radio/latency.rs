//! `radio-latency`: delay from the arrival of a message at the receiver's radio until the program can read it (until it
//! is *visible*), as a function of the slot length.
//!
//! "Slot" always means a slot of the simulator. ALOHA is the unslotted protocol here.

use sim_core::radio::{Medium, air_time};
use sim_core::time::Time;

use super::medium::{exchange, traffic};
use super::*;

pub const STUDY: Study = Study {
    name: "radio-latency",
    title: "Delay from the arrival of a message until it is visible, as a function of the slot length",
    run,
};

const SLOTS_MS: [i64; 8] = [1, 2, 5, 10, 20, 50, 100, 200];
/// Number of messages.
const COUNT: usize = 5_000;
/// Offered load; it is so low that messages rarely collide.
const LOAD: f64 = 0.01;
const STATIONS: u32 = 5;

fn run(effort: Effort) -> Outcome {
    let (mut rows, mut curves, mut points) = (Vec::new(), Vec::new(), Vec::new());
    for (medium, name) in [(Medium::Free, "free"), (Medium::Aloha, "ALOHA"), (Medium::TokenRing, "token ring")] {
        let mut curve = Vec::new();
        for slot_ms in SLOTS_MS {
            let slot = Time::from_millis(slot_ms);
            let mut delays = Vec::new();
            let time_ns = nanoseconds(effort.of(5), COUNT, || delays = measure(medium, slot));
            let batches: Vec<f64> =
                delays.chunks(100).map(|batch| batch.iter().sum::<f64>() / batch.len() as f64).collect();
            let (mean, half_width) = mean_of(&batches);
            rows.push(Row {
                study: STUDY.name,
                method: name.to_owned(),
                setting: format!("slot of {slot_ms} ms"),
                // The error column contains the measured value itself: the mean delay.
                error: mean,
                unit: "s",
                time_ns,
                per: "message",
            });
            let expected = 1e3 * expected(medium, slot);
            points.push(Point { x: slot_ms as f64, measured: 1e3 * mean, half_width: 1e3 * half_width, expected });
            curve.push((slot_ms as f64, expected));
        }
        if medium != Medium::TokenRing {
            curves.push((if medium == Medium::Free { "free" } else { "ALOHA, token ring" }.to_owned(), curve));
        }
    }
    let labels = ["slot length, ms", "mean delay from arrival to visibility, ms"];
    let (name, x_scale) = ("radio-latency-slot", Scale::Linear);
    let picture = Comparison { name, title: STUDY.title, labels, x_scale, curves, points };
    Outcome { rows, figures: vec![picture.figure()] }
}

/// Expected delay of a message that is sent at a random time in a slot, s.
///
/// On [`Medium::Free`], which has no collisions, a message is visible at its arrival, but not before the end of the
/// slot in which it is sent. On other media it is visible at the end of the slot in which it arrives.
fn expected(medium: Medium, slot: Time) -> f64 {
    let (slot, air) = (slot.seconds(), air_time(BYTES, BAUD).seconds());
    match medium {
        Medium::Free => (slot - air).max(0.0).powi(2) / (2.0 * slot),
        Medium::Aloha | Medium::TokenRing => 0.5 * slot,
    }
}

/// Delay of each of [`COUNT`] messages from its arrival until it is visible, s.
fn measure(medium: Medium, slot: Time) -> Vec<f64> {
    let receivers = if medium == Medium::TokenRing { STATIONS } else { 1 };
    let deliveries = exchange(medium, receivers, slot, &traffic(medium, STATIONS, LOAD, COUNT));
    deliveries.into_iter().map(|(_, delivery)| (delivery.visible - delivery.arrives).seconds()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_delay_matches_the_formula_and_no_delay_exceeds_a_slot() {
        for medium in [Medium::Free, Medium::Aloha, Medium::TokenRing] {
            for slot_ms in SLOTS_MS {
                let slot = Time::from_millis(slot_ms);
                let delays = measure(medium, slot);
                assert_eq!(delays.len(), COUNT);
                assert!(delays.iter().all(|delay| (0.0..=slot.seconds()).contains(delay)));
                let mean = delays.iter().sum::<f64>() / COUNT as f64;
                let expected = expected(medium, slot);
                // The standard deviation of a delay is at most that of a uniform one, 0.29 slots; the bound is four
                // standard errors of the mean.
                assert!(
                    (mean - expected).abs() < 1.2 * slot.seconds() / (COUNT as f64).sqrt(),
                    "{medium:?} {slot}: {mean}"
                );
            }
        }
    }
}
