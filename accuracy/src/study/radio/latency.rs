//! `radio-latency`: delay from a message's arrival until it is visible, against the slot length.

use sim_core::radio::{Medium, air_time};
use sim_core::time::Time;

use super::medium::{exchange, traffic};
use super::*;

pub const STUDY: Study = Study {
    name: "radio-latency",
    title: "How long after its arrival a message is seen, against the length of the slot",
    run,
};

const SLOTS_MS: [i64; 8] = [1, 2, 5, 10, 20, 50, 100, 200];
const COUNT: usize = 5_000;
/// Offered load, low enough that messages hardly ever collide.
const LOAD: f64 = 0.01;
const STATIONS: u32 = 5;

fn run(effort: Effort) -> Outcome {
    let (mut rows, mut curves, mut points) = (Vec::new(), Vec::new(), Vec::new());
    for (medium, name) in [(Medium::Free, "free"), (Medium::Aloha, "ALOHA"), (Medium::TokenRing, "token ring")] {
        let mut curve = Vec::new();
        for slot_ms in SLOTS_MS {
            let slot = Time::from_millis(slot_ms);
            let mut lags = Vec::new();
            let time_ns = nanoseconds(effort.of(5), COUNT, || lags = measure(medium, slot));
            let batches: Vec<f64> = lags.chunks(100).map(|lags| lags.iter().sum::<f64>() / lags.len() as f64).collect();
            let (mean, half) = mean_of(&batches);
            rows.push(Row {
                study: STUDY.name,
                method: name.to_owned(),
                setting: format!("slot of {slot_ms} ms"),
                error: mean,
                unit: "s",
                time_ns,
                per: "message",
            });
            let expected = 1e3 * expected(medium, slot);
            points.push(Point { x: slot_ms as f64, measured: 1e3 * mean, half: 1e3 * half, expected });
            curve.push((slot_ms as f64, expected));
        }
        if medium != Medium::TokenRing {
            curves.push((if medium == Medium::Free { "free" } else { "ALOHA, token ring" }.to_owned(), curve));
        }
    }
    let labels = ["length of the slot, ms", "mean time from arrival to being seen, ms"];
    let (name, x_scale) = ("radio-latency-slot", Scale::Linear);
    let picture = Picture { name, title: STUDY.title, labels, x_scale, curves, points };
    Outcome { rows, figures: vec![picture.figure()] }
}

/// Expected delay of a message sent at a random instant of a slot. On a free medium it is visible at its arrival, but not before the
/// end of the slot in which it is sent; on others at the end of the slot in which it arrives.
fn expected(medium: Medium, slot: Time) -> f64 {
    let (slot, air) = (slot.seconds(), air_time(BYTES, BAUD).seconds());
    match medium {
        Medium::Free => (slot - air).max(0.0).powi(2) / (2.0 * slot),
        Medium::Aloha | Medium::TokenRing => 0.5 * slot,
    }
}

/// Delay of each of [`COUNT`] messages from its arrival until it is visible, s.
fn measure(medium: Medium, slot: Time) -> Vec<f64> {
    let members = if medium == Medium::TokenRing { STATIONS } else { 1 };
    let fates = exchange(medium, members, slot, &traffic(medium, STATIONS, LOAD, COUNT));
    fates.into_iter().map(|(_, fate)| (fate.visible - fate.arrives).seconds()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lag_is_half_a_slot_or_less() {
        for medium in [Medium::Free, Medium::Aloha, Medium::TokenRing] {
            for slot_ms in SLOTS_MS {
                let slot = Time::from_millis(slot_ms);
                let lags = measure(medium, slot);
                assert_eq!(lags.len(), COUNT);
                assert!(lags.iter().all(|lag| (0.0..=slot.seconds()).contains(lag)));
                let mean = lags.iter().sum::<f64>() / COUNT as f64;
                let expected = expected(medium, slot);
                // A uniform delay has a standard deviation of 0.29 slots; this is four of the mean's.
                assert!(
                    (mean - expected).abs() < 1.2 * slot.seconds() / (COUNT as f64).sqrt(),
                    "{medium:?} {slot}: {mean}"
                );
            }
        }
    }
}
