//! Random schedules: stations and channel, compared with the oracle and with the timing rules.

use accuracy::world::Random;

use super::oracle::{Operation, Outcome, Schedule, simulate};
use super::*;

/// Selection of the slots to run, and the order in which messages are passed to the channel.
#[derive(Clone, Copy, Debug)]
struct RunOrder {
    /// True to run every slot, not only due slots.
    is_every_slot_run: bool,
    /// True to pass messages to the channel from the last robot to the first.
    is_backwards: bool,
}

const PLAIN: RunOrder = RunOrder { is_every_slot_run: false, is_backwards: false };

/// Runs a schedule with stations and a channel, slot by slot.
fn run(schedule: &Schedule, order: RunOrder) -> Outcome {
    let Schedule { model, slot, .. } = *schedule;
    let mut channel = Channel::new(model, schedule.seed, schedule.errors.clone());
    let mut stations: Vec<Station> =
        (0..schedule.errors.len()).map(|index| Station::new(RobotId::from_index(index), &model)).collect();
    let mut outcome = Outcome::default();
    let mut operations = schedule.operations.iter().peekable();
    let mut start = Time::ZERO;
    while start < schedule.end {
        let slot_end = start + slot;
        while let Some((at, robot, operation)) = operations.next_if(|(at, ..)| *at < slot_end) {
            let station = &mut stations[robot.index()];
            outcome.deliveries.extend(station.collect_visible(*at));
            match operation {
                Operation::On { address, baud } => station.switch_on(*address, *baud),
                Operation::Off => outcome.deliveries.extend(station.switch_off(*at)),
                Operation::Send { to, payload } => {
                    if station.member().is_some() {
                        let unreachable = schedule.out_of_reach[robot.index()].clone();
                        station.send(*at, *to, payload, unreachable).expect("schedules are too short to fill a buffer");
                    }
                }
                Operation::Read => {
                    let message = if station.member().is_some() { station.receive() } else { None };
                    outcome.read.extend(message.map(|message| (*at, *robot, message.from, message.sequence)));
                }
            }
        }
        let mut messages = Vec::new();
        for station in &mut stations {
            outcome.deliveries.extend(station.collect_visible(slot_end - Time(1)));
            station.take_change().into_iter().for_each(|change| channel.report_change(change));
            messages.extend(station.take_outgoing());
        }
        if order.is_backwards {
            messages.reverse();
        }
        for delivery in channel.exchange(slot_end, messages) {
            stations[delivery.to.index()].deliver(delivery);
        }
        channel.take_transmitted().into_iter().for_each(|(robot, sequence)| stations[robot.index()].release(sequence));
        let next_visible = stations.iter().map(Station::next_visible).min().unwrap_or(Time::NEVER);
        let next_operation = operations.peek().map_or(Time::NEVER, |(at, ..)| *at);
        let due = next_visible.min(next_operation).min(channel.due());
        start = if order.is_every_slot_run { slot_end } else { due.min(schedule.end).floor_to(slot).max(slot_end) };
    }
    outcome.deliveries.sort_by_key(|it| (it.visible, it.to, it.arrives, it.from, it.sequence));
    outcome
}

const BAUDS: [u32; 2] = [10_000_000, 7_000_000];

fn schedule(seed: u64) -> Schedule {
    let mut random = Random::new(seed);
    let robots = 1 + random.below(5);
    let end = 100 + random.below(700) as i64;
    let medium = [Medium::Free, Medium::Aloha, Medium::TokenRing][random.below(3)];
    let latency = [0, 0, random.below(20) as i64, random.below(300) as i64][random.below(4)];
    let slot = Time([1, 1 + random.below(20) as i64, 1 + random.below(100) as i64, 1000][random.below(4)]);
    let rate = [0.0, 0.0, 0.3, 1.0];
    let is_noisy = random.chance(0.5);
    let error = |random: &mut Random| RadioNoise {
        bit_error_rate: if is_noisy && random.chance(0.2) { 1.0 } else { 0.0 },
        packet_loss: if is_noisy { rate[random.below(4)] } else { 0.0 },
    };
    let errors = (0..robots).map(|_| error(&mut random)).collect();
    let is_hidden = random.chance(0.3);
    let mut unreachable = |from: usize| {
        let unreachable = (0..robots).filter(|to| *to != from && is_hidden && random.chance(0.4));
        unreachable.map(|to| (RobotId::from_index(to), if to % 2 == 0 { Loss::Range } else { Loss::Sight })).collect()
    };
    let out_of_reach = (0..robots).map(&mut unreachable).collect();
    // Mostly, each robot has its own address and all have the same speed.
    let has_mixed_settings = random.chance(0.2);
    let on = |robot: usize, random: &mut Random| Operation::On {
        address: if has_mixed_settings { random.below(3) as u32 } else { robot as u32 + 1 },
        baud: BAUDS[usize::from(has_mixed_settings && random.chance(0.3))],
    };
    let is_always_on = random.chance(0.4);
    let max_pause = 1 + random.below(60);
    let mut operations = Vec::new();
    for robot in 0..robots {
        let id = RobotId::from_index(robot);
        let mut at = if is_always_on { 0 } else { random.below(end as usize / 2) as i64 };
        operations.push((Time(at), id, on(robot, &mut random)));
        loop {
            // Operations often coincide with other operations, or with a slot's end.
            at += 1 + random.below(max_pause) as i64;
            if random.chance(0.2) {
                at = Time(at + slot.0 - 1).floor_to(slot).0;
            }
            if at >= end / 2 + 50 {
                break;
            }
            let operation = match random.below(10) {
                0 if !is_always_on => Operation::Off,
                1 if !is_always_on => on(robot, &mut random),
                0..=6 if operations.len() < 60 => Operation::Send {
                    to: if random.chance(0.4) { Address::All } else { Address::One(random.below(robots + 2) as u32) },
                    payload: (0..random.below(30)).map(|_| random.below(256) as u8).collect(),
                },
                _ => Operation::Read,
            };
            operations.push((Time(at), id, operation));
        }
    }
    operations.sort_by_key(|(at, robot, _)| (*at, *robot));
    let model = RadioModel { medium, latency: Time(latency), baud: BAUDS[0], ..RadioModel::default() };
    Schedule { model, slot, seed, errors, out_of_reach, operations, end: Time(end) }
}

#[test]
fn ten_thousand_schedules_match_the_oracle() {
    let mut causes = std::collections::BTreeMap::new();
    let mut read = 0;
    for seed in 0..10_000 {
        let schedule = schedule(seed);
        let mut expected = simulate(&schedule);
        let order = RunOrder { is_every_slot_run: seed % 3 == 0, ..PLAIN };
        let mut actual = run(&schedule, order);
        // The last slot may extend beyond the schedule's end.
        expected.deliveries.retain(|delivery| delivery.visible < schedule.end);
        actual.deliveries.retain(|delivery| delivery.visible < schedule.end);
        let difference =
            actual.deliveries.iter().zip(&expected.deliveries).find(|(actual, expected)| actual != expected);
        assert!(actual == expected, "schedule {seed}: {difference:#?}");
        for delivery in &actual.deliveries {
            *causes.entry(delivery.outcome.as_ref().map_or_else(|loss| loss.name(), |_| "heard")).or_insert(0) += 1;
        }
        read += actual.read.len();
        check_times(&schedule, &actual);
    }
    // Every kind of outcome occurs.
    let expected = ["baud", "collision", "heard", "nobody", "off", "packet", "range", "sight", "unsent"];
    assert!(causes.keys().copied().eq(expected) && causes.values().all(|count| *count > 100), "{causes:?}");
    assert!(read > 10_000, "{read}");
}

/// Checks the timing rules of docs/radio.md: no message arrives before the time of queuing plus the delay, and each
/// becomes visible at the right time.
fn check_times(schedule: &Schedule, outcome: &Outcome) {
    let Schedule { model, slot, .. } = *schedule;
    let boundary = |time: Time| (time + slot - Time(1)).floor_to(slot);
    for delivery in &outcome.deliveries {
        let mut messages = queued_messages(schedule, delivery.from);
        let (at, bytes, baud) = messages.nth(delivery.sequence as usize - 1).expect("the message was queued");
        let delay = air_time(bytes, baud) + model.latency;
        assert!(delivery.arrives >= at + delay, "{delivery:?} before {at} + {delay}");
        if delivery.outcome == Err(Loss::Unsent) {
            continue;
        }
        let taken_at = at.floor_to(slot) + slot;
        let visible = match model.medium {
            Medium::Free => delivery.arrives.max(taken_at),
            Medium::Aloha | Medium::TokenRing => boundary(delivery.arrives),
        };
        assert_eq!(delivery.visible, visible, "{delivery:?} with slots of {slot}");
    }
    for pair in outcome.read.windows(2).filter(|pair| pair[0].1 == pair[1].1) {
        assert!(pair[0].0 < pair[1].0);
    }
    for (at, reader, from, sequence) in &outcome.read {
        let is_read =
            |delivery: &&Delivery| (delivery.to, delivery.from, delivery.sequence) == (*reader, *from, *sequence);
        let delivery = outcome.deliveries.iter().find(is_read).expect("the message was delivered");
        assert!(delivery.visible <= *at && delivery.outcome.is_ok());
        // Every message that was visible and had arrived earlier was read before this one.
        let is_earlier = |it: &&Delivery| {
            (it.arrives, it.from, it.sequence) < (delivery.arrives, delivery.from, delivery.sequence)
                && (it.to, it.outcome.is_ok()) == (*reader, true)
                && it.visible <= *at
        };
        let switched_off = schedule
            .operations
            .iter()
            .filter(|(time, robot, operation)| robot == reader && time <= at && matches!(operation, Operation::Off));
        let last_off = switched_off.map(|(time, ..)| *time).max().unwrap_or(Time(-1));
        for earlier in outcome.deliveries.iter().filter(is_earlier).filter(|it| it.visible > last_off) {
            let was_read = outcome.read.iter().any(|(time, robot, from, sequence)| {
                (robot, from, sequence) == (reader, &earlier.from, &earlier.sequence) && time < at
            });
            assert!(was_read, "{earlier:?} is unread when {delivery:?} is read");
        }
    }
}

/// Time of queuing, payload size and speed of each message of a robot.
fn queued_messages(schedule: &Schedule, robot: RobotId) -> impl Iterator<Item = (Time, usize, u32)> {
    let mut station_baud = None;
    schedule.operations.iter().filter(move |(_, by, _)| *by == robot).filter_map(move |(at, _, operation)| {
        match operation {
            Operation::On { baud, .. } => {
                station_baud = Some(*baud);
                None
            }
            Operation::Off => {
                station_baud = None;
                None
            }
            Operation::Send { payload, .. } => Some((*at, payload.len(), station_baud?)),
            Operation::Read => None,
        }
    })
}

#[test]
fn outcome_is_independent_of_message_order_and_of_skipped_slots() {
    for seed in 0..2_000 {
        let schedule = schedule(seed);
        let plain = run(&schedule, PLAIN);
        for (is_every_slot_run, is_backwards) in [(false, true), (true, false)] {
            let mut other = run(&schedule, RunOrder { is_every_slot_run, is_backwards });
            let mut plain = plain.clone();
            plain.deliveries.retain(|delivery| delivery.visible < schedule.end);
            other.deliveries.retain(|delivery| delivery.visible < schedule.end);
            assert_eq!(other, plain, "schedule {seed}");
        }
    }
}

#[test]
fn additional_listener_does_not_change_other_deliveries() {
    let mut messages = 0;
    for seed in (0..3_000).filter(|seed| schedule(*seed).model.medium != Medium::TokenRing) {
        let mut schedule = schedule(seed);
        let before = run(&schedule, PLAIN);
        schedule.errors.push(RadioNoise { bit_error_rate: 0.2, packet_loss: 0.5 });
        schedule.out_of_reach.push(Vec::new());
        let listener = RobotId::from_index(schedule.errors.len() - 1);
        schedule.operations.insert(0, (Time::ZERO, listener, Operation::On { address: 99, baud: BAUDS[0] }));
        schedule.operations.sort_by_key(|(at, robot, _)| (*at, *robot));
        let after = run(&schedule, PLAIN);
        let others = |outcome: &Outcome| {
            let deliveries =
                outcome.deliveries.iter().filter(|it| it.to != listener && it.outcome != Err(Loss::Nobody));
            deliveries.cloned().collect::<Vec<_>>()
        };
        assert_eq!(others(&after), others(&before), "schedule {seed}");
        assert_eq!(after.read, before.read);
        messages += others(&before).len();
    }
    assert!(messages > 10_000, "{messages}");
}

#[test]
fn arrivals_are_independent_of_slot_length_while_stations_stay_on() {
    // Time from which all stations are on, for any slot length.
    const ON_TIME: Time = Time(1_000);
    for seed in 0..2_000 {
        let mut plain = schedule(seed);
        plain.operations.retain(|(_, _, operation)| matches!(operation, Operation::Send { .. }));
        plain.operations.iter_mut().for_each(|(at, ..)| *at += ON_TIME);
        plain.end = Time(1_000_000);
        let arrivals = |slot: Time| {
            let mut schedule = Schedule { slot, ..plain.clone() };
            let switch_ons = (0..schedule.errors.len()).map(|robot| {
                let operation = Operation::On { address: robot as u32 + 1, baud: BAUDS[0] };
                (ON_TIME - slot, RobotId::from_index(robot), operation)
            });
            schedule.operations.splice(0..0, switch_ons);
            let deliveries = run(&schedule, PLAIN).deliveries.into_iter();
            let mut arrivals: Vec<_> =
                deliveries.map(|it| (it.arrives, it.from, it.sequence, it.to, it.outcome)).collect();
            arrivals.sort_by_key(|(arrives, from, sequence, to, _)| (*arrives, *from, *sequence, *to));
            arrivals
        };
        let expected = arrivals(ON_TIME);
        assert!(plain.operations.is_empty() || !expected.is_empty());
        assert!(arrivals(Time(10)) == expected && arrivals(Time(500)) == expected, "schedule {seed}");
    }
}
