//! Random schedules: stations and channel against the oracle, and against the timing rules directly.

use accuracy::world::Random;

use super::oracle::{Deed, Schedule, Story, tell};
use super::*;

/// Variation of the slots and of the order in which messages are handed in.
#[derive(Clone, Copy, Debug)]
struct Manner {
    /// True to run every slot, not only due slots.
    is_every_slot_run: bool,
    /// True to hand in sent messages from the last robot to the first.
    is_backwards: bool,
}

const PLAIN: Manner = Manner { is_every_slot_run: false, is_backwards: false };

/// Runs a schedule with stations and a channel, slot by slot.
fn run(schedule: &Schedule, manner: Manner) -> Story {
    let Schedule { model, slot, .. } = *schedule;
    let mut channel = Channel::new(model, schedule.seed, schedule.errors.clone());
    let mut stations: Vec<Station> =
        (0..schedule.errors.len()).map(|index| Station::new(RobotId::from_index(index), &model)).collect();
    let mut story = Story::default();
    let mut deeds = schedule.deeds.iter().peekable();
    let mut start = Time::ZERO;
    while start < schedule.end {
        let slot_end = start + slot;
        while let Some((at, robot, deed)) = deeds.next_if(|(at, ..)| *at < slot_end) {
            let station = &mut stations[robot.index()];
            story.fates.extend(station.settle(*at));
            match deed {
                Deed::On { address, baud } => station.switch_on(*address, *baud),
                Deed::Off => story.fates.extend(station.switch_off(*at)),
                Deed::Send { to, payload } => {
                    if station.member().is_some() {
                        let far = schedule.out_of_reach[robot.index()].clone();
                        station.send(*at, *to, payload, far).expect("schedules are too short to fill a buffer");
                    }
                }
                Deed::Read => {
                    let message = if station.member().is_some() { station.receive() } else { None };
                    story.read.extend(message.map(|message| (*at, *robot, message.from, message.sequence)));
                }
            }
        }
        let mut sendings = Vec::new();
        for station in &mut stations {
            story.fates.extend(station.settle(slot_end - Time(1)));
            station.take_change().into_iter().for_each(|change| channel.change(change));
            sendings.extend(station.take_sent());
        }
        if manner.is_backwards {
            sendings.reverse();
        }
        for delivery in channel.exchange(slot_end, sendings) {
            stations[delivery.to.index()].deliver(delivery);
        }
        channel.take_departed().into_iter().for_each(|(robot, sequence)| stations[robot.index()].has_left(sequence));
        let next_visible = stations.iter().map(Station::next_visible).min().unwrap_or(Time::NEVER);
        let next_deed = deeds.peek().map_or(Time::NEVER, |(at, ..)| *at);
        let due = next_visible.min(next_deed).min(channel.due());
        start = if manner.is_every_slot_run { slot_end } else { due.min(schedule.end).floor_to(slot).max(slot_end) };
    }
    story.fates.sort_by_key(|it| (it.visible, it.to, it.arrives, it.from, it.sequence));
    story
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
    let mut far = |from: usize| {
        let far = (0..robots).filter(|to| *to != from && is_hidden && random.chance(0.4));
        far.map(|to| (RobotId::from_index(to), if to % 2 == 0 { Loss::Range } else { Loss::Sight })).collect()
    };
    let out_of_reach = (0..robots).map(&mut far).collect();
    // Mostly, each robot has its own address and all have the same speed.
    let is_odd = random.chance(0.2);
    let on = |robot: usize, random: &mut Random| Deed::On {
        address: if is_odd { random.below(3) as u32 } else { robot as u32 + 1 },
        baud: BAUDS[usize::from(is_odd && random.chance(0.3))],
    };
    let is_steady = random.chance(0.4);
    let busy = 1 + random.below(60);
    let mut deeds = Vec::new();
    for robot in 0..robots {
        let id = RobotId::from_index(robot);
        let mut at = if is_steady { 0 } else { random.below(end as usize / 2) as i64 };
        deeds.push((Time(at), id, on(robot, &mut random)));
        loop {
            // Operations often coincide with other operations, or with a slot's end.
            at += 1 + random.below(busy) as i64;
            if random.chance(0.2) {
                at = Time(at + slot.0 - 1).floor_to(slot).0;
            }
            if at >= end / 2 + 50 {
                break;
            }
            let deed = match random.below(10) {
                0 if !is_steady => Deed::Off,
                1 if !is_steady => on(robot, &mut random),
                0..=6 if deeds.len() < 60 => Deed::Send {
                    to: if random.chance(0.4) { Address::All } else { Address::One(random.below(robots + 2) as u32) },
                    payload: (0..random.below(30)).map(|_| random.below(256) as u8).collect(),
                },
                _ => Deed::Read,
            };
            deeds.push((Time(at), id, deed));
        }
    }
    deeds.sort_by_key(|(at, robot, _)| (*at, *robot));
    let model = RadioModel { medium, latency: Time(latency), baud: BAUDS[0], ..RadioModel::default() };
    Schedule { model, slot, seed, errors, out_of_reach, deeds, end: Time(end) }
}

#[test]
fn ten_thousand_schedules_are_as_the_oracle_tells() {
    let mut causes = std::collections::BTreeMap::new();
    let mut read = 0;
    for seed in 0..10_000 {
        let schedule = schedule(seed);
        let mut truth = tell(&schedule);
        let manner = Manner { is_every_slot_run: seed % 3 == 0, ..PLAIN };
        let mut found = run(&schedule, manner);
        // The last slot may extend beyond the schedule's end.
        truth.fates.retain(|fate| fate.visible < schedule.end);
        found.fates.retain(|fate| fate.visible < schedule.end);
        let differ = found.fates.iter().zip(&truth.fates).find(|(found, truth)| found != truth);
        assert!(found == truth, "schedule {seed}: {differ:#?}");
        for fate in &found.fates {
            *causes.entry(fate.outcome.as_ref().map_or_else(|loss| loss.name(), |_| "heard")).or_insert(0) += 1;
        }
        read += found.read.len();
        check_times(&schedule, &found);
    }
    // Every kind of outcome occurs.
    let expected = ["baud", "collision", "heard", "nobody", "off", "packet", "range", "sight", "unsent"];
    assert!(causes.keys().copied().eq(expected) && causes.values().all(|count| *count > 100), "{causes:?}");
    assert!(read > 10_000, "{read}");
}

/// Checks the timing rules: no arrival before send + delay, and visible no later than design section 7 says.
fn check_times(schedule: &Schedule, story: &Story) {
    let Schedule { model, slot, .. } = *schedule;
    let boundary = |time: Time| (time + slot - Time(1)).floor_to(slot);
    for fate in &story.fates {
        let mut sent = sends(schedule, fate.from);
        let (at, bytes, baud) = sent.nth(fate.sequence as usize - 1).expect("it was sent");
        let delay = air_time(bytes, baud) + model.latency;
        assert!(fate.arrives >= at + delay, "{fate:?} before {at} + {delay}");
        if fate.outcome == Err(Loss::Unsent) {
            continue;
        }
        let sent_by = at.floor_to(slot) + slot;
        let latest = match model.medium {
            Medium::Free => fate.arrives.max(sent_by),
            Medium::Aloha | Medium::TokenRing => boundary(fate.arrives),
        };
        assert_eq!(fate.visible, latest, "{fate:?} with slots of {slot}");
    }
    for pair in story.read.windows(2).filter(|pair| pair[0].1 == pair[1].1) {
        assert!(pair[0].0 < pair[1].0);
    }
    for (at, reader, from, sequence) in &story.read {
        let of = |fate: &&Delivery| (fate.to, fate.from, fate.sequence) == (*reader, *from, *sequence);
        let fate = story.fates.iter().find(of).expect("it was heard");
        assert!(fate.visible <= *at && fate.outcome.is_ok());
        // Every message that was visible and had arrived earlier was read before this one.
        let is_earlier = |it: &&Delivery| {
            (it.arrives, it.from, it.sequence) < (fate.arrives, fate.from, fate.sequence)
                && (it.to, it.outcome.is_ok()) == (*reader, true)
                && it.visible <= *at
        };
        let offs = schedule
            .deeds
            .iter()
            .filter(|(when, robot, deed)| robot == reader && when <= at && matches!(deed, Deed::Off));
        let last_off = offs.map(|(when, ..)| *when).max().unwrap_or(Time(-1));
        for earlier in story.fates.iter().filter(is_earlier).filter(|it| it.visible > last_off) {
            let was_read = story.read.iter().any(|(when, robot, from, sequence)| {
                (robot, from, sequence) == (reader, &earlier.from, &earlier.sequence) && when < at
            });
            assert!(was_read, "{earlier:?} waits while {fate:?} is read");
        }
    }
}

/// Instant, size and speed of each message of a robot.
fn sends(schedule: &Schedule, robot: RobotId) -> impl Iterator<Item = (Time, usize, u32)> {
    let mut speed = None;
    schedule.deeds.iter().filter(move |(_, by, _)| *by == robot).filter_map(move |(at, _, deed)| match deed {
        Deed::On { baud, .. } => {
            speed = Some(*baud);
            None
        }
        Deed::Off => {
            speed = None;
            None
        }
        Deed::Send { payload, .. } => Some((*at, payload.len(), speed?)),
        Deed::Read => None,
    })
}

#[test]
fn who_hands_in_first_and_which_slots_are_run_changes_nothing() {
    for seed in 0..2_000 {
        let schedule = schedule(seed);
        let plain = run(&schedule, PLAIN);
        for (is_every_slot_run, is_backwards) in [(false, true), (true, false)] {
            let mut other = run(&schedule, Manner { is_every_slot_run, is_backwards });
            let mut plain = plain.clone();
            plain.fates.retain(|fate| fate.visible < schedule.end);
            other.fates.retain(|fate| fate.visible < schedule.end);
            assert_eq!(other, plain, "schedule {seed}");
        }
    }
}

#[test]
fn a_listener_more_changes_nothing_for_others() {
    let mut messages = 0;
    for seed in (0..3_000).filter(|seed| schedule(*seed).model.medium != Medium::TokenRing) {
        let mut schedule = schedule(seed);
        let before = run(&schedule, PLAIN);
        schedule.errors.push(RadioNoise { bit_error_rate: 0.2, packet_loss: 0.5 });
        schedule.out_of_reach.push(Vec::new());
        let listener = RobotId::from_index(schedule.errors.len() - 1);
        schedule.deeds.insert(0, (Time::ZERO, listener, Deed::On { address: 99, baud: BAUDS[0] }));
        schedule.deeds.sort_by_key(|(at, robot, _)| (*at, *robot));
        let after = run(&schedule, PLAIN);
        let others = |story: &Story| {
            let fates = story.fates.iter().filter(|it| it.to != listener && it.outcome != Err(Loss::Nobody));
            fates.cloned().collect::<Vec<_>>()
        };
        assert_eq!(others(&after), others(&before), "schedule {seed}");
        assert_eq!(after.read, before.read);
        messages += others(&before).len();
    }
    assert!(messages > 10_000, "{messages}");
}

#[test]
fn among_those_that_stay_on_the_length_of_a_slot_changes_no_arrival() {
    // All stations are on from here on, for any slot length.
    const FIRST: Time = Time(1_000);
    for seed in 0..2_000 {
        let mut plain = schedule(seed);
        plain.deeds.retain(|(_, _, deed)| matches!(deed, Deed::Send { .. }));
        plain.deeds.iter_mut().for_each(|(at, ..)| *at += FIRST);
        plain.end = Time(1_000_000);
        let arrivals = |slot: Time| {
            let mut schedule = Schedule { slot, ..plain.clone() };
            let ons = (0..schedule.errors.len()).map(|robot| {
                let deed = Deed::On { address: robot as u32 + 1, baud: BAUDS[0] };
                (FIRST - slot, RobotId::from_index(robot), deed)
            });
            schedule.deeds.splice(0..0, ons);
            let fates = run(&schedule, PLAIN).fates.into_iter();
            let mut arrivals: Vec<_> = fates.map(|it| (it.arrives, it.from, it.sequence, it.to, it.outcome)).collect();
            arrivals.sort_by_key(|(arrives, from, sequence, to, _)| (*arrives, *from, *sequence, *to));
            arrivals
        };
        let expected = arrivals(FIRST);
        assert!(plain.deeds.is_empty() || !expected.is_empty());
        assert!(arrivals(Time(10)) == expected && arrivals(Time(500)) == expected, "schedule {seed}");
    }
}
