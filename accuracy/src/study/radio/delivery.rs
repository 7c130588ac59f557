//! Fraction of messages that arrive intact.

use sim_core::math::{exp, ln_1p};
use sim_core::noise::RadioNoise;
use sim_core::radio::{Address, Medium};
use sim_core::time::Time;

use super::*;

/// Message lengths in bytes.
const LENGTHS: [usize; 4] = [1, BYTES, 200, 1_000];
/// Bit error rates.
const RATES: [f64; 8] = [0.0, 1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2];
const PACKET_LOSS: f64 = 0.05;
/// Number of messages at each setting.
const COUNT: usize = 10_000;
/// Position of a rate of 0 on the logarithmic axis of the picture.
const ZERO_RATE_X: f64 = 1e-7;

pub fn measure(effort: Effort) -> Part {
    let mut rows = Vec::new();
    let mut points = Vec::new();
    for bytes in LENGTHS {
        for bit_error_rate in RATES {
            let errors = RadioNoise { bit_error_rate, packet_loss: PACKET_LOSS };
            let mut intact = 0;
            let time_ns = nanoseconds(effort.of(5), COUNT, || intact = through_channel(errors, bytes));
            let point = point(errors, bytes, intact);
            rows.push(row(&length(bytes), format!("P_b {}", format_number(bit_error_rate)), &point, time_ns));
            points.push(point);
        }
    }
    for bit_error_rate in [1e-6, 1e-4, 1e-2] {
        let errors = RadioNoise { bit_error_rate, packet_loss: PACKET_LOSS };
        let mut intact = 0;
        let time_ns = nanoseconds(effort.of(5), COUNT, || intact = bit_by_bit(errors, BYTES));
        let method = format!("{BYTES} bytes, bit by bit");
        rows.push(row(
            &method,
            format!("P_b {}", format_number(bit_error_rate)),
            &point(errors, BYTES, intact),
            time_ns,
        ));
    }
    let curve = |bytes: usize| {
        let x = |step: i32| ZERO_RATE_X * ten_to(f64::from(step) / 20.0);
        let points = (0..=100).map(|step| {
            let errors = RadioNoise { bit_error_rate: x(step), packet_loss: PACKET_LOSS };
            (x(step), expected(errors, bytes))
        });
        (length(bytes), points.collect())
    };
    let title = "Share of sent messages that arrive intact, with a packet loss of 5 %";
    let labels = ["bit error rate P_b (0 at the left edge)", "share of messages"];
    let curves = LENGTHS.map(curve).to_vec();
    let picture = Comparison { name: "radio-delivery", title, labels, x_scale: Scale::Logarithmic, curves, points };
    Part { rows, picture }
}

fn length(bytes: usize) -> String {
    if bytes == 1 { "1 byte".to_owned() } else { format!("{bytes} bytes") }
}

/// Expected fraction of intact messages: (1 - P_p) (1 - P_b)^(8 n), for packet loss P_p, bit error rate P_b and n
/// bytes.
fn expected(errors: RadioNoise, bytes: usize) -> f64 {
    (1.0 - errors.packet_loss) * exp(8.0 * bytes as f64 * ln_1p(-errors.bit_error_rate))
}

fn point(errors: RadioNoise, bytes: usize, intact: usize) -> Point {
    let (measured, expected) = (intact as f64 / COUNT as f64, expected(errors, bytes));
    let half_width = SIGMAS * (expected * (1.0 - expected) / COUNT as f64).sqrt();
    Point { x: errors.bit_error_rate.max(ZERO_RATE_X), measured, half_width, expected }
}

/// Number of the [`COUNT`] messages that the channel delivers intact.
fn through_channel(errors: RadioNoise, bytes: usize) -> usize {
    let mut channel = channel(Medium::Free, errors, 1);
    let payload = vec![0x55; bytes];
    let mut intact = 0;
    for batch in 0..COUNT / 100 {
        let sequences = 100 * batch as u64 + 1..=100 * (batch as u64 + 1);
        let messages =
            sequences.map(|sequence| sent_message(2, sequence, Address::One(1), payload.clone(), Time::ZERO));
        for delivery in channel.exchange(Time::ZERO, messages.collect()) {
            intact += usize::from(delivery.outcome.is_ok_and(|arrived| arrived.payload == payload));
        }
    }
    intact
}

/// Number of intact messages by a simulation without the channel, with one random number per bit.
fn bit_by_bit(errors: RadioNoise, bytes: usize) -> usize {
    let payload = vec![0x55; bytes];
    let is_intact = |sequence: &u64| {
        let mut stream = stream(1, *sequence);
        let is_lost = stream.unit() < errors.packet_loss;
        let mut arrived = payload.clone();
        for byte in &mut arrived {
            for bit in 0..8 {
                *byte ^= u8::from(stream.unit() < errors.bit_error_rate) << bit;
            }
        }
        !is_lost && arrived == payload
    };
    (0..COUNT as u64).filter(is_intact).count()
}
