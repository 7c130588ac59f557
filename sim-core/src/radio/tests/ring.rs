//! Tests of the token ring.

use accuracy::statistics::binomial;

use super::*;

const RING: RadioModel =
    RadioModel { medium: Medium::TokenRing, baud: BAUD, latency: Time::ZERO, range: None, line_of_sight: false };
const SLOT: Time = Time::from_millis(50);

/// A ring of `members` stations, formed at the end of the first slot.
fn ring(errors: Vec<RadioNoise>, members: u32) -> Channel {
    let mut channel = channel(RING, errors, members);
    assert_eq!(channel.exchange(SLOT, Vec::new()), []);
    channel
}

fn frame_time() -> Time {
    air_time(0, BAUD)
}

/// Time of the first token in a ring of `members` stations formed at the end of the first slot: after the silence, the
/// poll and the answers.
fn first_token(members: i64) -> Time {
    SLOT + Time((SILENCE_FRAMES + members) * frame_time().0)
}

fn message_for_token(from: u32, sequence: u64, to: Address, bytes: usize, queued_at: Time) -> OutgoingMessage {
    OutgoingMessage { begins: None, ..message_from(from, sequence, to, vec![0; bytes], queued_at) }
}

/// Saturated ring: each of `count` robots has queued `messages_each` messages, of a length that depends on the robot,
/// when the ring is formed. Returns (sender, begin, end) of the transmissions in the order of time.
fn saturated(errors: RadioNoise, count: u32, messages_each: u64) -> Vec<(u32, Time, Time)> {
    let mut channel = ring(vec![errors; count as usize], count);
    let messages = (1..=count).flat_map(|from| (1..=messages_each).map(move |sequence| (from, sequence)));
    let bytes = |from: u32| 3 * from as usize;
    let messages = messages
        .map(|(from, sequence)| message_for_token(from, sequence, Address::One(0), bytes(from), SLOT))
        .collect();
    let mut deliveries = channel.exchange(SLOT + SLOT, messages);
    while channel.due() < Time::NEVER {
        let slot_end = channel.due().floor_to(SLOT) + SLOT;
        deliveries.extend(channel.exchange(slot_end, Vec::new()));
    }
    assert_eq!(deliveries.len() as u64, u64::from(count) * messages_each, "all are sent");
    deliveries.sort_by_key(|delivery| delivery.arrives);
    let span = |delivery: &Delivery| {
        assert_eq!(delivery.outcome, Err(Loss::Nobody));
        (delivery.from.0, Time(delivery.arrives.0 - air_time(bytes(delivery.from.0), BAUD).0), delivery.arrives)
    };
    deliveries.iter().map(span).collect()
}

#[test]
fn stations_send_one_at_a_time_in_turn() {
    let sent = saturated(RadioNoise::default(), 7, 30);
    assert_eq!(sent[0].1, first_token(7));
    for (index, pair) in sent.windows(2).enumerate() {
        assert_eq!(pair[0].0, index as u32 % 7 + 1, "in the order of their ids");
        assert_eq!(pair[1].1, pair[0].2, "a message also passes the token on");
    }
}

#[test]
fn lost_token_is_replaced_and_no_station_starves() {
    for (bit_error_rate, packet_loss) in [(0.0, 0.2), (0.01, 0.0), (0.001, 0.9), (0.0, 1.0), (1.0, 0.0)] {
        let radio = RadioNoise { bit_error_rate, packet_loss };
        let sent = saturated(radio, 5, 400);
        let mut lost = 0;
        for (index, pair) in sent.windows(2).enumerate() {
            assert_eq!(pair[0].0, index as u32 % 5 + 1, "the station that missed the token is next");
            let silence = pair[1].1 - pair[0].2;
            let is_lost = silence > Time::ZERO;
            assert!(!is_lost || silence == Time((SILENCE_FRAMES + 5) * frame_time().0), "{silence}");
            lost += u64::from(is_lost);
        }
        // A token has 56 bits.
        let success_rate = (1.0 - packet_loss) * f64::powi(1.0 - bit_error_rate, 56);
        let p = binomial(lost, sent.len() as u64 - 1, 1.0 - success_rate);
        assert!(p > 0.001, "{lost} tokens lost of {} at {success_rate}: {p}", sent.len());
    }
}

#[test]
fn idle_ring_skips_rounds_and_has_the_right_holder() {
    // 87,600 hours are ten years, in which 5e11 tokens are passed.
    for (members, hours) in [(1, 1), (4, 1), (4, 87_600), (1_000, 1)] {
        let mut channel = ring(Vec::new(), members);
        let later = Time(hours * 3_600_000_000).floor_to(SLOT);
        let passes = (later.0 - first_token(members.into()).0).div_euclid(frame_time().0);
        let messages = (1..=members).map(|from| message_for_token(from, 1, Address::All, 0, later)).collect();
        let mut deliveries = channel.exchange(later + SLOT, messages);
        // Keeps one delivery of each broadcast.
        deliveries.retain(|delivery| delivery.to.0 == if delivery.from.0 == 1 { 2.min(members) } else { 1 });
        let first = deliveries.iter().min_by_key(|delivery| delivery.arrives).expect("there are messages");
        let holder = (passes + 1) % i64::from(members) + 1;
        assert_eq!(i64::from(first.from.0), holder, "{members} for {hours} hours");
        assert_eq!(first.arrives, first_token(members.into()) + Time((passes + 2) * frame_time().0));
    }
}

#[test]
fn token_losses_in_an_idle_ring_are_independent_of_the_query_times() {
    let arrival_after = |packet_loss: f64, step: Time| {
        let mut channel = ring(vec![RadioNoise { bit_error_rate: 1e-5, packet_loss }; 3], 3);
        let end = Time::from_millis(600_000);
        let mut time = SLOT;
        while time + step < end {
            time += step;
            assert_eq!(channel.exchange(time, Vec::new()), []);
        }
        let deliveries = channel.exchange(end + SLOT, vec![message_for_token(2, 1, Address::One(0), 0, end)]);
        deliveries[0].arrives
    };
    let expected = arrival_after(1e-4, SLOT);
    for step in [Time(700), Time(12_345), Time::from_millis(1_000_000)] {
        assert_eq!(arrival_after(1e-4, step), expected, "{step}");
    }
    let losses = (0..10).map(|tenth| arrival_after(1e-4 * f64::from(tenth), SLOT));
    assert!(losses.collect::<std::collections::BTreeSet<_>>().len() > 1, "no token is ever lost");
}

#[test]
fn token_is_replaced_if_its_holder_leaves() {
    // In the six cases, the next holder of the token after the slot boundary is each of the three robots twice. Robot 2
    // leaves at the boundary.
    let mut cases_with_leaving_holder = 0;
    for passes in 0..6 {
        let mut channel = ring(Vec::new(), 3);
        let boundary = first_token(3) + Time(passes * frame_time().0 + 1);
        channel.set_member(RobotId(2), None);
        channel.exchange(boundary, Vec::new());
        // The holder at the boundary finishes its frame and passes the token to the next.
        let holder = (passes + 1) % 3 + 1;
        let passed_at = boundary - Time(1) + frame_time();
        let messages = vec![
            message_for_token(1, 1, Address::One(0), 0, boundary),
            message_for_token(3, 1, Address::One(0), 0, boundary),
        ];
        let deliveries = channel.exchange(boundary + SLOT, messages);
        let begins = |from: u32| {
            let delivery =
                deliveries.iter().find(|delivery| delivery.from == RobotId(from)).expect("the message is transmitted");
            Time(delivery.arrives.0 - frame_time().0)
        };
        if holder == 2 {
            cases_with_leaving_holder += 1;
            // Robot 3 waits and polls, and robot 1 answers.
            assert_eq!(begins(3), passed_at + Time((SILENCE_FRAMES + 2) * frame_time().0));
            assert_eq!(begins(1), begins(3) + frame_time());
        } else {
            let (first, second) = if holder == 1 { (1, 3) } else { (3, 1) };
            assert_eq!((begins(first), begins(second)), (passed_at, passed_at + frame_time()));
        }
    }
    assert_eq!(cases_with_leaving_holder, 2);
}

#[test]
fn empty_ring_restarts_with_a_new_token() {
    let mut channel = ring(Vec::new(), 2);
    channel.set_member(RobotId(1), None);
    channel.set_member(RobotId(2), None);
    assert_eq!(channel.exchange(Time::from_millis(100), Vec::new()), []);
    let member = |robot| Some(StationInfo { robot: RobotId(robot), address: robot, baud: BAUD });
    channel.set_member(RobotId(2), member(2));
    assert_eq!(channel.exchange(Time::from_millis(1_000), Vec::new()), []);
    let deliveries = channel
        .exchange(Time::from_millis(1_050), vec![message_for_token(2, 1, Address::All, 0, Time::from_millis(1_000))]);
    let begins = Time::from_millis(1_000) + Time((SILENCE_FRAMES + 1) * frame_time().0);
    assert_eq!((deliveries[0].arrives, &deliveries[0].outcome), (begins + frame_time(), &Err(Loss::Nobody)));
}

#[test]
fn frames_have_the_baud_rate_of_their_sender() {
    let mut channel = Channel::new(RING, 1, Vec::new());
    for (robot, baud) in [(1, 9_600), (2, 115_200)] {
        channel.set_member(RobotId(robot), Some(StationInfo { robot: RobotId(robot), address: robot, baud }));
    }
    channel.exchange(SLOT, Vec::new());
    let first_token = SLOT + Time((SILENCE_FRAMES + 2) * air_time(0, 9_600).0);
    let broadcast = |from, baud| OutgoingMessage { baud, ..message_for_token(from, 1, Address::All, 10, first_token) };
    let deliveries = channel.exchange(Time::from_millis(1_000), vec![broadcast(1, 9_600), broadcast(2, 115_200)]);
    let first = first_token + air_time(10, 9_600);
    assert_eq!(
        deliveries.iter().map(|delivery| delivery.arrives).collect::<Vec<_>>(),
        [first + air_time(10, 115_200), first]
    );
    // A station receives tokens at every baud rate, but messages only at its own.
    assert!(deliveries.iter().all(|delivery| delivery.outcome == Err(Loss::Baud)));
}

#[test]
fn buffer_space_is_free_after_the_transmission() {
    let mut channel = ring(Vec::new(), 1);
    let mut station = Station::new(RobotId(1), &RING);
    station.switch_on(1, BAUD);
    let mut time = SLOT;
    let long = vec![0; BUFFER_BYTES / 2];
    for _ in 0..2 {
        station.send(time, Address::All, &long, Vec::new()).expect("there is room");
    }
    assert_eq!(station.send(time, Address::All, &[1], Vec::new()).err(), Some(BufferFull));
    assert_eq!(station.unsent_count(time), None);
    let messages = station.take_outgoing();
    let mut released = Vec::new();
    // Each message takes 45 ms.
    for slot in 0..3 {
        time += SLOT;
        channel.exchange(time, if slot == 0 { messages.clone() } else { Vec::new() });
        for (robot, sequence) in channel.take_transmitted() {
            assert_eq!(robot, RobotId(1));
            station.release(sequence);
            released.push((sequence, slot));
        }
    }
    assert_eq!(released, [(1, 0), (2, 1)]);
    assert!(station.send(time, Address::All, &long, Vec::new()).is_ok());
}
