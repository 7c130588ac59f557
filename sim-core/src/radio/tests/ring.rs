//! The token ring.

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

fn frame() -> Time {
    air_time(0, BAUD)
}

/// Start of the token in a ring of `members` stations formed at the end of the first slot: silence, poll, answers.
fn start(members: i64) -> Time {
    SLOT + Time((SILENCE + members) * frame().0)
}

fn waiting(from: u32, sequence: u64, to: Address, bytes: usize, sent: Time) -> SentMessage {
    SentMessage { begins: None, ..sending(from, sequence, to, vec![0; bytes], sent) }
}

/// Each of `count` robots has `each` messages of its own length from the start; returns (sender, begin, end) in order.
fn saturated(errors: RadioNoise, count: u32, each: u64) -> Vec<(u32, Time, Time)> {
    let mut channel = ring(vec![errors; count as usize], count);
    let messages = (1..=count).flat_map(|from| (1..=each).map(move |sequence| (from, sequence)));
    let bytes = |from: u32| 3 * from as usize;
    let sendings =
        messages.map(|(from, sequence)| waiting(from, sequence, Address::One(0), bytes(from), SLOT)).collect();
    let mut fates = channel.exchange(SLOT + SLOT, sendings);
    while channel.due() < Time::NEVER {
        let slot_end = channel.due().floor_to(SLOT) + SLOT;
        fates.extend(channel.exchange(slot_end, Vec::new()));
    }
    assert_eq!(fates.len() as u64, u64::from(count) * each, "all are sent");
    fates.sort_by_key(|fate| fate.arrives);
    let span = |fate: &Delivery| {
        assert_eq!(fate.outcome, Err(Loss::Nobody));
        (fate.from.0, Time(fate.arrives.0 - air_time(bytes(fate.from.0), BAUD).0), fate.arrives)
    };
    fates.iter().map(span).collect()
}

#[test]
fn one_at_a_time_sends_and_all_in_turn() {
    let sent = saturated(RadioNoise::default(), 7, 30);
    assert_eq!(sent[0].1, start(7));
    for (index, pair) in sent.windows(2).enumerate() {
        assert_eq!(pair[0].0, index as u32 % 7 + 1, "in the order of their numbers");
        assert_eq!(pair[1].1, pair[0].2, "who has sent hands the token on with it");
    }
}

#[test]
fn a_lost_token_is_made_anew_and_nobody_starves() {
    for (bit_error_rate, packet_loss) in [(0.0, 0.2), (0.01, 0.0), (0.001, 0.9), (0.0, 1.0), (1.0, 0.0)] {
        let radio = RadioNoise { bit_error_rate, packet_loss };
        let sent = saturated(radio, 5, 400);
        let mut lost = 0;
        for (index, pair) in sent.windows(2).enumerate() {
            assert_eq!(pair[0].0, index as u32 % 5 + 1, "whoever missed the token is next");
            let silence = pair[1].1 - pair[0].2;
            let is_lost = silence > Time::ZERO;
            assert!(!is_lost || silence == Time((SILENCE + 5) * frame().0), "{silence}");
            lost += u64::from(is_lost);
        }
        let success_rate = (1.0 - packet_loss) * f64::powi(1.0 - bit_error_rate, 56);
        let p = binomial(lost, sent.len() as u64 - 1, 1.0 - success_rate);
        assert!(p > 0.001, "{lost} tokens lost of {} at {success_rate}: {p}", sent.len());
    }
}

#[test]
fn an_idle_ring_costs_nothing_and_is_where_it_must_be() {
    // Ten years: 5e11 token frames.
    for (members, hours) in [(1, 1), (4, 1), (4, 87_600), (1_000, 1)] {
        let mut channel = ring(Vec::new(), members);
        let later = Time(hours * 3_600_000_000).floor_to(SLOT);
        let passes = (later.0 - start(members.into()).0).div_euclid(frame().0);
        let messages = (1..=members).map(|from| waiting(from, 1, Address::All, 0, later)).collect();
        let mut fates = channel.exchange(later + SLOT, messages);
        fates.retain(|fate| fate.to.0 == if fate.from.0 == 1 { 2.min(members) } else { 1 });
        let first = fates.iter().min_by_key(|fate| fate.arrives).expect("there are messages");
        let owner = (passes + 1) % i64::from(members) + 1;
        assert_eq!(i64::from(first.from.0), owner, "{members} for {hours} hours");
        assert_eq!(first.arrives, start(members.into()) + Time((passes + 2) * frame().0));
    }
}

#[test]
fn an_idle_ring_loses_its_token_as_often_however_it_is_asked() {
    let begin = |packet_loss: f64, step: Time| {
        let mut channel = ring(vec![RadioNoise { bit_error_rate: 1e-5, packet_loss }; 3], 3);
        let end = Time::from_millis(600_000);
        let mut time = SLOT;
        while time + step < end {
            time += step;
            assert_eq!(channel.exchange(time, Vec::new()), []);
        }
        let fates = channel.exchange(end + SLOT, vec![waiting(2, 1, Address::One(0), 0, end)]);
        fates[0].arrives
    };
    let expected = begin(1e-4, SLOT);
    for step in [Time(700), Time(12_345), Time::from_millis(1_000_000)] {
        assert_eq!(begin(1e-4, step), expected, "{step}");
    }
    let losses = (0..10).map(|tenth| begin(1e-4 * f64::from(tenth), SLOT));
    assert!(losses.collect::<std::collections::BTreeSet<_>>().len() > 1, "none is ever lost");
}

#[test]
fn who_leaves_with_the_token_does_not_keep_it() {
    // The slot boundary falls into the turn of each of the three robots, twice each. Robot 2 leaves; twice it has the
    // token then.
    let mut has_left_with_it = 0;
    for passes in 0..6 {
        let mut channel = ring(Vec::new(), 3);
        let boundary = start(3) + Time(passes * frame().0 + 1);
        channel.set_member(RobotId(2), None);
        channel.exchange(boundary, Vec::new());
        // The holder at the boundary finishes its frame and passes the token to the next.
        let owner = (passes + 1) % 3 + 1;
        let at = boundary - Time(1) + frame();
        let messages = vec![waiting(1, 1, Address::One(0), 0, boundary), waiting(3, 1, Address::One(0), 0, boundary)];
        let fates = channel.exchange(boundary + SLOT, messages);
        let begins = |from: u32| {
            let fate = fates.iter().find(|fate| fate.from == RobotId(from)).expect("it is sent");
            Time(fate.arrives.0 - frame().0)
        };
        if owner == 2 {
            has_left_with_it += 1;
            // Robot 3 waits and polls, and robot 1 answers.
            assert_eq!(begins(3), at + Time((SILENCE + 2) * frame().0));
            assert_eq!(begins(1), begins(3) + frame());
        } else {
            let (first, second) = if owner == 1 { (1, 3) } else { (3, 1) };
            assert_eq!((begins(first), begins(second)), (at, at + frame()));
        }
    }
    assert_eq!(has_left_with_it, 2);
}

#[test]
fn a_ring_that_all_have_left_begins_anew() {
    let mut channel = ring(Vec::new(), 2);
    channel.set_member(RobotId(1), None);
    channel.set_member(RobotId(2), None);
    assert_eq!(channel.exchange(Time::from_millis(100), Vec::new()), []);
    let member = |robot| Some(StationInfo { robot: RobotId(robot), address: robot, baud: BAUD });
    channel.set_member(RobotId(2), member(2));
    assert_eq!(channel.exchange(Time::from_millis(1_000), Vec::new()), []);
    let fates =
        channel.exchange(Time::from_millis(1_050), vec![waiting(2, 1, Address::All, 0, Time::from_millis(1_000))]);
    let begins = Time::from_millis(1_000) + Time((SILENCE + 1) * frame().0);
    assert_eq!((fates[0].arrives, &fates[0].outcome), (begins + frame(), &Err(Loss::Nobody)));
}

#[test]
fn the_speed_of_each_is_that_of_its_frames() {
    let mut channel = Channel::new(RING, 1, Vec::new());
    for (robot, baud) in [(1, 9_600), (2, 115_200)] {
        channel.set_member(RobotId(robot), Some(StationInfo { robot: RobotId(robot), address: robot, baud }));
    }
    channel.exchange(SLOT, Vec::new());
    let start = SLOT + Time((SILENCE + 2) * air_time(0, 9_600).0);
    let of = |from, baud| SentMessage { baud, ..waiting(from, 1, Address::All, 10, start) };
    let fates = channel.exchange(Time::from_millis(1_000), vec![of(1, 9_600), of(2, 115_200)]);
    let first = start + air_time(10, 9_600);
    assert_eq!(fates.iter().map(|fate| fate.arrives).collect::<Vec<_>>(), [first + air_time(10, 115_200), first]);
    // Tokens are received at every speed; messages are not.
    assert!(fates.iter().all(|fate| fate.outcome == Err(Loss::Baud)));
}

#[test]
fn the_buffer_is_free_once_a_message_was_sent() {
    let mut channel = ring(Vec::new(), 1);
    let mut station = Station::new(RobotId(1), &RING);
    station.switch_on(1, BAUD);
    let mut time = SLOT;
    let long = vec![0; BUFFER / 2];
    for _ in 0..2 {
        station.send(time, Address::All, &long, Vec::new()).expect("there is room");
    }
    assert_eq!(station.send(time, Address::All, &[1], Vec::new()).err(), Some(Full));
    assert_eq!(station.unsent(time), 2);
    let sendings = station.take_sent();
    let mut left = Vec::new();
    // Each message takes 45 ms.
    for slot in 0..3 {
        time += SLOT;
        channel.exchange(time, if slot == 0 { sendings.clone() } else { Vec::new() });
        for (robot, sequence) in channel.take_departed() {
            assert_eq!(robot, RobotId(1));
            station.has_left(sequence);
            left.push((sequence, slot));
        }
    }
    assert_eq!(left, [(1, 0), (2, 1)]);
    assert!(station.send(time, Address::All, &long, Vec::new()).is_ok());
}
