//! Collisions, compared with Abramson's formula.

use super::*;
use crate::math::{exp, ln};
use crate::noise::{Purpose, Stream};

const ALOHA: RadioModel =
    RadioModel { medium: Medium::Aloha, baud: BAUD, latency: Time::ZERO, range: None, line_of_sight: false };

/// Fraction of the messages that robot 1 receives at an offered load `g`, and the half width of its 99.9 % interval.
/// Messages begin at random instants (Poisson), each from another robot; on average `g` messages begin in the air time
/// of one message.
///
/// Outcomes of neighbouring messages are correlated, so the variance is that of the means of batches, which are much
/// longer than the correlation.
fn received_fraction(g: f64, slot: Time) -> (f64, f64) {
    const BATCHES: usize = 200;
    const BATCH: usize = 500;
    let air = air_time(35, BAUD);
    let mut channel = channel(ALOHA, Vec::new(), 1);
    let mut stream = Stream::new(3, RobotId(1), Purpose::Program, 0, g.to_bits());
    let mut batches = [0.0; BATCHES];
    let mut count = |deliveries: Vec<Delivery>| {
        for delivery in deliveries {
            let message = (delivery.sequence - 1) as usize;
            batches[message / BATCH] += f64::from(u8::from(delivery.outcome.is_ok())) / BATCH as f64;
        }
    };
    let (mut at, mut slot_end, mut messages) = (0.0, slot, Vec::new());
    for message in 0..BATCHES * BATCH {
        at -= ln(1.0 - stream.unit()) * air.seconds() / g;
        let sent = Time::from_seconds_ceil(at);
        while sent >= slot_end {
            count(channel.exchange(slot_end, std::mem::take(&mut messages)));
            slot_end += slot;
        }
        let from = 2 + (message % 10_000) as u32;
        messages.push(message_from(from, message as u64 + 1, Address::One(1), vec![0; 35], sent));
    }
    count(channel.exchange(Time::NEVER, messages));
    let mean = batches.iter().sum::<f64>() / BATCHES as f64;
    let variance = batches.iter().map(|fraction| (fraction - mean).powi(2)).sum::<f64>() / (BATCHES - 1) as f64;
    // Student's quantile for 199 degrees of freedom.
    (mean, 3.34 * (variance / BATCHES as f64).sqrt())
}

/// Source: Abramson, "The ALOHA System", 1970: S = G exp(-2 G).
#[test]
fn throughput_matches_abramsons_formula() {
    for g in [0.05, 0.2, 0.5, 1.0, 1.5] {
        let (fraction, half_width) = received_fraction(g, Time::from_millis(50));
        let expected = exp(-2.0 * g);
        assert!(
            (fraction - expected).abs() < half_width,
            "S = {} +- {}, not {} at G = {g}",
            g * fraction,
            g * half_width,
            g * expected
        );
        assert!(half_width < 0.03 * expected.max(0.2), "the interval is too wide: {half_width}");
        // The test has power: slotted ALOHA lies outside the interval.
        assert!((fraction - exp(-g)).abs() > half_width, "at G = {g}");
    }
}

#[test]
fn collisions_are_independent_of_slot_length() {
    let fractions =
        [Time(100), Time::from_millis(50), Time::from_millis(10_000)].map(|slot| received_fraction(0.5, slot).0);
    assert_eq!(fractions, [fractions[0]; 3]);
}

/// Robots 1 and 3 are out of each other's reach; robot 2 receives the messages of both.
#[test]
fn hidden_terminal_interferes_only_within_its_reach() {
    let mut channel = channel(ALOHA, Vec::new(), 4);
    let far = |robot: u32| (RobotId(robot), Loss::Range);
    let message = |from, to, at, out_of_reach| OutgoingMessage {
        out_of_reach,
        ..message_from(from, 1, Address::One(to), b"hello".to_vec(), Time(at))
    };
    // The messages from robot 1 to 2 and from robot 3 to 4 overlap. Both reach robot 2, which receives neither. The
    // message of robot 1 does not reach robot 4.
    let messages = vec![message(1, 2, 0, vec![far(3), far(4)]), message(3, 4, 500, vec![far(1)])];
    let deliveries = channel.exchange(Time::from_millis(50), messages);
    let is_received = |robot: u32| {
        deliveries.iter().find(|delivery| delivery.to == RobotId(robot)).map(|delivery| delivery.outcome.is_ok())
    };
    assert_eq!([is_received(2), is_received(4)], [Some(false), Some(true)]);
    assert_eq!(deliveries[0].outcome, Err(Loss::Collision));
}

#[test]
fn station_receives_nothing_while_it_transmits() {
    let outcome = |start_in_air_times: i64| {
        let mut channel = channel(ALOHA, Vec::new(), 3);
        let air = air_time(5, BAUD);
        // Robot 2 sends to robot 3 and reaches no other robot. The message from robot 1 to 2 is lost only because robot
        // 2 itself is transmitting.
        let from_2 = OutgoingMessage {
            out_of_reach: vec![(RobotId(1), Loss::Sight)],
            ..message_from(2, 1, Address::One(3), b"12345".to_vec(), Time(10_000))
        };
        let from_1 = OutgoingMessage {
            out_of_reach: vec![(RobotId(3), Loss::Sight)],
            ..message_from(1, 1, Address::One(2), b"12345".to_vec(), Time(10_000 + start_in_air_times * air.0))
        };
        let later = OutgoingMessage { queued_at: Time(from_1.queued_at.0 + start_in_air_times.signum()), ..from_1 };
        let later = OutgoingMessage { begins: Some(later.queued_at), ..later };
        let deliveries = channel.exchange(Time::from_millis(50), vec![from_2, later]);
        assert!(
            deliveries.iter().any(|delivery| delivery.to == RobotId(3) && delivery.outcome.is_ok()),
            "robot 3 receives the message of robot 2"
        );
        deliveries
            .into_iter()
            .find(|delivery| delivery.to == RobotId(2))
            .expect("robot 2 is the destination")
            .outcome
            .map(|_| ())
    };
    assert_eq!([outcome(-1), outcome(0), outcome(1)], [Ok(()), Err(Loss::Collision), Ok(())]);
}

#[test]
fn adjacent_transmissions_do_not_collide() {
    let air = air_time(1, BAUD).0;
    let outcomes = |gap: i64| {
        let mut channel = channel(ALOHA, Vec::new(), 1);
        let message = |from, at| message_from(from, 1, Address::One(1), vec![1], Time(at));
        let deliveries = channel.exchange(Time::from_millis(50), vec![message(2, 0), message(3, air + gap)]);
        [0, 1].map(|index: usize| deliveries[index].outcome.clone().map(|_| ()))
    };
    assert_eq!(outcomes(0), [Ok(()), Ok(())]);
    assert_eq!(outcomes(-1), [Err(Loss::Collision), Err(Loss::Collision)]);
}

/// A message collides with an overlapping one even if it ended slots before the other is decided.
#[test]
fn collisions_are_remembered_across_slots() {
    let model = RadioModel { latency: Time::from_millis(500), ..ALOHA };
    let mut channel = channel(model, Vec::new(), 1);
    let slot = |index: i64| Time(1_000 * index);
    let mut outcomes = Vec::new();
    for index in 1..=600 {
        let sent = match index {
            1 => vec![message_from(2, 1, Address::One(1), vec![0; 93], Time(0))],
            9 => vec![message_from(3, 1, Address::One(1), vec![0; 1], Time(8_600))],
            20 => vec![message_from(3, 2, Address::One(1), vec![0; 1], Time(19_000))],
            _ => Vec::new(),
        };
        let is_due = channel.due() < slot(index) && channel.due() >= slot(index - 1);
        let deliveries = channel.exchange(slot(index), sent);
        assert!(deliveries.is_empty() || is_due, "at {}", slot(index));
        outcomes.extend(deliveries.into_iter().map(|delivery| (delivery.from.0, delivery.outcome.map(|_| ()))));
    }
    assert_eq!(outcomes, [(2, Err(Loss::Collision)), (3, Err(Loss::Collision)), (3, Ok(()))]);
    assert_eq!(channel.due(), Time::NEVER);
}
