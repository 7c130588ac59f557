//! Stop and wait: a sender repeats each message until it is acknowledged.

use sim_core::RobotId;
use sim_core::math::{exp, ln_1p};
use sim_core::noise::RadioNoise;
use sim_core::radio::{Address, Channel, RadioModel, Station, air_time};
use sim_core::time::Time;

use super::*;

/// Number of messages transferred at each setting.
const COUNT: u64 = 2_000;
const LOSSES: [f64; 7] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8];
const RATES: [f64; 6] = [1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3];
/// Length of an acknowledgement in bytes; it contains only the number of the acknowledged message.
const ACK: usize = 1;
/// Slot lengths.
const SLOTS: [(Time, &str); 3] =
    [(Time(1), "slot of 1 us"), (Time::from_millis(10), "slot of 10 ms"), (Time::from_millis(50), "slot of 50 ms")];

/// Throughput against the packet loss P_p.
pub fn against_loss(effort: Effort) -> Part {
    let errors = |packet_loss| RadioNoise { packet_loss, bit_error_rate: 0.0 };
    let steps: Vec<f64> = (0..=80).map(|step| f64::from(step) / 100.0).collect();
    let title = "Stop and wait: messages of 35 bytes transferred, as a function of packet loss";
    let labels = ["packet loss P_p", "messages a second"];
    measure(effort, ("radio-stop-and-wait", title, labels), Scale::Linear, "P_p", &LOSSES, &steps, errors)
}

/// Throughput against the bit error rate P_b.
pub fn against_bit_errors(effort: Effort) -> Part {
    let errors = |bit_error_rate| RadioNoise { packet_loss: 0.0, bit_error_rate };
    let steps: Vec<f64> = (0..=70).map(|step| 1e-6 * ten_to(f64::from(step) / 20.0)).collect();
    let title = "Stop and wait: messages of 35 bytes transferred, as a function of the bit error rate";
    let labels = ["bit error rate P_b", "messages a second"];
    measure(effort, ("radio-stop-and-wait-bits", title, labels), Scale::Logarithmic, "P_b", &RATES, &steps, errors)
}

fn measure(
    effort: Effort,
    (name, title, labels): (&'static str, &'static str, [&'static str; 2]),
    x_scale: Scale,
    symbol: &str,
    settings: &[f64],
    steps: &[f64],
    errors: impl Fn(f64) -> RadioNoise,
) -> Part {
    let (mut rows, mut points, mut curves) = (Vec::new(), Vec::new(), Vec::new());
    for (slot, slot_name) in SLOTS {
        let best = 1.0 / round_trip(slot).seconds();
        for &setting in settings {
            let mut seconds = 0.0;
            let time_ns =
                nanoseconds(effort.of(3), COUNT as usize, || seconds = transfer_seconds(errors(setting), slot));
            let (expected, half_width) = expected_throughput(errors(setting));
            let measured = COUNT as f64 / best / seconds;
            let relative = Point { x: setting, measured, half_width, expected };
            rows.push(row(
                &format!("stop and wait, {slot_name}"),
                format!("{symbol} {}", format_number(setting)),
                &relative,
                time_ns,
            ));
            points.push(Point {
                x: setting,
                measured: best * relative.measured,
                half_width: best * relative.half_width,
                expected: best * relative.expected,
            });
        }
        curves.push((
            slot_name.to_owned(),
            steps.iter().map(|x| (*x, best * expected_throughput(errors(*x)).0)).collect(),
        ));
    }
    Part { rows, picture: Comparison { name, title, labels, x_scale, curves, points } }
}

/// Time from sending a message until its acknowledgement is visible, if neither is lost. Each is sent at the start of a
/// slot and becomes available after its air time, but not before the end of that slot.
fn round_trip(slot: Time) -> Time {
    let one_way = |bytes| air_time(bytes, BAUD).max(slot);
    one_way(BYTES) + one_way(ACK)
}

/// Timeout of the sender: twice the round trip.
fn timeout(slot: Time) -> Time {
    round_trip(slot) + round_trip(slot)
}

/// Expected throughput relative to one message per round trip, and half the width of the 99.9 % interval in which
/// the measured value should be.
///
/// Message and acknowledgement both arrive intact with probability p. The number of failed attempts is geometric, and
/// each failed attempt costs one timeout.
fn expected_throughput(errors: RadioNoise) -> (f64, f64) {
    let RadioNoise { bit_error_rate, packet_loss } = errors;
    let p = (1.0 - packet_loss).powi(2) * exp(8.0 * (BYTES + ACK) as f64 * ln_1p(-bit_error_rate));
    let (round_trips, deviation) = (1.0 + 2.0 * (1.0 - p) / p, 2.0 * (1.0 - p).sqrt() / p);
    let throughput = 1.0 / round_trips;
    (throughput, throughput * throughput * SIGMAS * deviation / (COUNT as f64).sqrt())
}

/// Transfers [`COUNT`] messages from robot 1 to robot 2 and returns the duration of the transfer in seconds. Corrupted
/// messages are discarded, as by a perfect checksum.
fn transfer_seconds(errors: RadioNoise, slot: Time) -> f64 {
    let model = RadioModel { baud: BAUD, ..RadioModel::default() };
    let mut channel = Channel::new(model, SEED, vec![errors; 2]);
    let mut stations = [1, 2].map(|robot| Station::new(RobotId(robot), &model));
    for (station, address) in stations.iter_mut().zip([1, 2]) {
        station.switch_on(address, BAUD);
        station.take_change().into_iter().for_each(|change| channel.report_change(change));
    }
    // The station with index 0 has the address 1 and sends to 2; the station with index 1 does the reverse.
    let send = |stations: &mut [Station; 2], index: usize, at: Time, payload: &[u8]| {
        let to = Address::One(2 - index as u32);
        stations[index].send(at, to, payload, Vec::new()).expect("the previous message has left the transmit buffer");
    };
    let payload = |number: u64| [number as u8; BYTES];
    let (mut number, mut now) = (0, Time::ZERO);
    send(&mut stations, 0, now, &payload(number));
    let mut alarm = now + timeout(slot);
    while number < COUNT {
        // End of the slot in which a station sent or received.
        let slot_end = now.floor_to(slot) + slot;
        let sent = stations.iter_mut().flat_map(Station::take_outgoing).collect();
        for delivery in channel.exchange(slot_end, sent) {
            stations[delivery.to.index()].deliver(delivery);
        }
        // The next delivery or timeout wakes a robot.
        let [first, second] = [0, 1].map(|index: usize| stations[index].next_visible());
        now = first.min(second).min(alarm);
        stations.iter_mut().for_each(|station| drop(station.collect_visible(now)));
        while let Some(message) = stations[1].receive() {
            if message.payload == payload(number) {
                send(&mut stations, 1, now, &[number as u8; ACK]);
            }
        }
        let is_acknowledged = stations[0].receive().is_some_and(|message| message.payload == [number as u8; ACK]);
        if is_acknowledged {
            number += 1;
        }
        if is_acknowledged || now == alarm {
            send(&mut stations, 0, now, &payload(number));
            alarm = now + timeout(slot);
        }
    }
    now.seconds()
}
