//! Hard cases.

use super::*;

const MEDIA: [Medium; 3] = [Medium::Free, Medium::Aloha, Medium::TokenRing];

/// Robots 1 and 2, both on, with their stations.
struct Pair {
    channel: Channel,
    stations: [Station; 2],
}

impl Pair {
    fn new(model: RadioModel) -> Self {
        let stations = [1, 2].map(|robot| {
            let mut station = Station::new(RobotId(robot), &model);
            station.switch_on(robot, model.baud);
            station
        });
        Self { channel: Channel::new(model, 1, Vec::new()), stations }
    }

    fn send(&mut self, at: Time, payload: &[u8]) -> u64 {
        self.stations[0].send(at, Address::One(2), payload, Vec::new()).expect("there is room").sequence
    }

    /// Ends the slot; returns the channel's deliveries.
    fn end_slot(&mut self, slot_end: Time) -> Vec<Delivery> {
        let mut sendings = Vec::new();
        for station in &mut self.stations {
            station.take_change().into_iter().for_each(|change| self.channel.change(change));
            sendings.append(&mut station.take_sent());
        }
        let fates = self.channel.exchange(slot_end, sendings);
        for (robot, sequence) in self.channel.take_departed() {
            self.stations[robot.index()].has_left(sequence);
        }
        fates
    }

    /// Runs the due slots until none is left.
    fn run(&mut self, slot: Time) -> Vec<Delivery> {
        let mut fates = self.end_slot(slot);
        while self.channel.due() < Time::NEVER - slot {
            fates.extend(self.end_slot(self.channel.due().floor_to(slot) + slot));
        }
        fates
    }
}

fn outcomes(fates: &[Delivery]) -> Vec<(u64, Result<(), Loss>)> {
    fates.iter().map(|fate| (fate.sequence, fate.outcome.clone().map(|_| ()))).collect()
}

#[test]
fn the_time_on_the_air_is_that_of_its_bits() {
    // 35 + 7 bytes of 10 bits at 9600 baud; rounded up.
    assert_eq!(air_time(35, 9_600), Time(43_750));
    assert_eq!(air_time(0, 115_200), Time(608));
    assert_eq!([air_time(0, u32::MAX), air_time(0, 1)], [Time(1), Time::from_millis(70_000)]);
    assert_eq!([air_time(usize::MAX, 1), air_time(usize::MAX, u32::MAX)], [Time::NEVER, Time(42_949_672_970_000_001)]);
    assert_eq!(air_time(1_000_000, 1), Time(10_000_070_000_000));
}

#[test]
fn a_day_on_the_air_and_hours_of_latency_take_a_slot_each() {
    for medium in MEDIA {
        for slot in [Time(1_000), Time::from_millis(50), Time::from_millis(10_000)] {
            let model =
                RadioModel { medium, baud: 1, latency: Time::from_millis(3 * 3_600_000), ..RadioModel::default() };
            let mut pair = Pair::new(model);
            pair.end_slot(slot);
            let sent = slot + Time(17);
            pair.send(sent, &[7; 1_000]);
            let fates = pair.run(slot + slot);
            assert_eq!(outcomes(&fates), [(1, Ok(()))], "{medium:?}");
            let delay = Time::from_millis(10_070_000) + model.latency;
            let begins = if medium == Medium::TokenRing { slot + Time(4 * 70_000_000) } else { sent };
            assert_eq!(fates[0].arrives, begins + delay, "{medium:?}");
        }
    }
}

#[test]
fn the_end_of_time_is_never_reached() {
    for medium in MEDIA {
        let late = Time(i64::MAX - 1_000);
        let mut pair = Pair::new(RadioModel { medium, latency: Time::NEVER, ..RadioModel::default() });
        pair.end_slot(Time(i64::MAX - 2_000));
        pair.send(late, b"too late");
        let mut fates = pair.end_slot(Time::NEVER - Time(1));
        assert_eq!(pair.channel.due(), Time::NEVER, "{medium:?}");
        fates.extend(pair.channel.finish(Time::NEVER - Time(1)));
        assert!(fates.iter().all(|fate| fate.arrives == Time::NEVER), "{fates:?}");
        let expected = if medium == Medium::Free { Ok(()) } else { Err(Loss::End) };
        assert_eq!(outcomes(&fates), [(1, expected)], "{medium:?}");
    }
}

#[test]
fn what_has_not_begun_when_its_station_is_switched_off_is_never_sent() {
    let slot = Time::from_millis(50);
    for medium in MEDIA {
        let mut pair = Pair::new(RadioModel { medium, ..RadioModel::default() });
        pair.end_slot(slot);
        // The token arrives only 4 frames after the slot's end.
        for _ in 0..3 {
            pair.send(slot, &[0; 100]);
        }
        pair.stations[0].switch_off(slot + Time(1));
        pair.stations[0].switch_on(1, RadioModel::default().baud);
        pair.send(slot + Time(20), b"again");
        let fates = pair.end_slot(slot + slot);
        let all: Vec<_> = {
            let mut all = outcomes(&fates);
            all.sort_by_key(|(sequence, _)| *sequence);
            all
        };
        let first = if medium == Medium::TokenRing { Err(Loss::Unsent) } else { Ok(()) };
        assert_eq!(all, [(1, first), (2, Err(Loss::Unsent)), (3, Err(Loss::Unsent)), (4, Ok(()))], "{medium:?}");
        for fate in fates.iter().filter(|fate| fate.outcome == Err(Loss::Unsent)) {
            assert_eq!((fate.to, fate.visible), (RobotId(1), slot + slot));
        }
    }
}

#[test]
fn a_free_medium_sends_what_it_has_taken_and_aloha_stops() {
    for (medium, second) in [(Medium::Free, Ok(())), (Medium::Aloha, Err(Loss::Unsent))] {
        let slot = Time::from_millis(1);
        let mut pair = Pair::new(RadioModel { medium, ..RadioModel::default() });
        // Each transmission takes 9.3 ms.
        pair.send(Time::ZERO, &[0; 100]);
        pair.send(Time::ZERO, &[0; 100]);
        let mut fates = pair.end_slot(slot);
        assert_eq!(pair.stations[0].unsent(Time(1_500)), usize::from(medium == Medium::Aloha));
        pair.stations[0].switch_off(Time(1_500));
        fates.extend(pair.run(slot + slot));
        fates.sort_by_key(|fate| fate.sequence);
        assert_eq!(outcomes(&fates), [(1, Ok(())), (2, second)]);
        // The transmitter stays busy with outgoing messages even if the station is switched on again.
        pair.stations[0].switch_on(1, BAUD);
        let busy = if medium == Medium::Free { 2 } else { 1 };
        let sending = pair.stations[0].send(Time(2_000), Address::All, &[1], Vec::new()).expect("there is room");
        assert_eq!(sending.begins, Some(Time(busy * air_time(100, BAUD).0)));
    }
}

#[test]
fn who_is_switched_off_hears_nothing_of_what_was_on_its_way() {
    let slot = Time::from_millis(50);
    let mut pair = Pair::new(RadioModel { latency: Time::from_millis(100), ..RadioModel::default() });
    pair.send(Time::ZERO, b"one");
    pair.end_slot(slot).into_iter().for_each(|fate| pair.stations[1].deliver(fate));
    let off = pair.stations[1].switch_off(Time::from_millis(60));
    assert_eq!(outcomes(&off), [(1, Err(Loss::Off))]);
    assert_eq!(
        (pair.stations[1].switch_off(Time::from_millis(61)), pair.stations[1].next_visible()),
        (vec![], Time::NEVER)
    );
    // A message of a station to its own address has no receiver.
    pair.stations[0].send(Time::from_millis(70), Address::One(1), b"me", Vec::new()).expect("there is room");
    assert_eq!(outcomes(&pair.end_slot(slot + slot)), [(2, Err(Loss::Nobody))]);
}

#[test]
fn a_buffer_that_is_full_takes_nothing_more() {
    let mut pair = Pair::new(RadioModel::default());
    let mut station = pair.stations[1].clone();
    let delivery = |sequence: u64, bytes: usize| Delivery {
        to: RobotId(2),
        from: RobotId(1),
        address: 1,
        sequence,
        arrives: Time(sequence as i64),
        visible: Time(100),
        outcome: Ok(Arrived { payload: vec![0; bytes], bit_errors: 0 }),
    };
    for (sequence, bytes) in [(1, BUFFER - 1), (2, 2), (3, 0), (4, 0)] {
        station.deliver(delivery(sequence, bytes));
    }
    let settled = station.settle(Time(100));
    let full = Err(Loss::Overflow);
    assert_eq!(outcomes(&settled), [(1, Ok(())), (2, full), (3, Ok(())), (4, full)]);
    assert_eq!(station.waiting(), 2);
    // The outgoing buffer also frees space as transmissions end.
    let baud = RadioModel::default().baud;
    pair.send(Time::ZERO, &[0; BUFFER]);
    let end = air_time(BUFFER, baud);
    assert_eq!(pair.stations[0].send(end - Time(1), Address::All, &[], Vec::new()).err(), Some(Full));
    assert!(pair.stations[0].send(end, Address::All, &[], Vec::new()).is_ok());
}

#[test]
fn all_at_one_instant_are_in_the_order_of_their_senders() {
    for medium in [Medium::Free, Medium::TokenRing] {
        let mut channel = channel(RadioModel { medium, ..RadioModel::default() }, Vec::new(), 50);
        channel.exchange(Time(1), Vec::new());
        let own = |from| sending(from, 1, Address::All, vec![0; 4], Time(1));
        let fates = channel.exchange(Time::from_millis(10_000), (1..=50).rev().map(own).collect());
        assert_eq!(fates.len(), 50 * 49);
        let heard_by_3: Vec<u32> = fates.iter().filter(|fate| fate.to == RobotId(3)).map(|fate| fate.from.0).collect();
        assert_eq!(heard_by_3, (1..=50).filter(|from| *from != 3).collect::<Vec<_>>());
    }
}

#[test]
fn messages_of_one_address_go_to_all_who_have_it() {
    let mut channel = channel(RadioModel::default(), Vec::new(), 4);
    let member = |robot, address, baud| Some(StationInfo { robot: RobotId(robot), address, baud });
    channel.set_member(RobotId(2), member(2, 7, BAUD));
    channel.set_member(RobotId(4), member(4, 7, 9_600));
    channel.set_member(RobotId(3), None);
    let to =
        |address| channel.clone().exchange(Time(1), vec![sending(1, 1, Address::One(address), vec![], Time::ZERO)]);
    let outcomes = |fates: Vec<Delivery>| fates.into_iter().map(|it| (it.to.0, it.outcome.err())).collect::<Vec<_>>();
    assert_eq!(outcomes(to(7)), [(2, None), (4, Some(Loss::Baud))]);
    assert_eq!([outcomes(to(2)), outcomes(to(3)), outcomes(to(4))], [const { &[(1, Some(Loss::Nobody))] }; 3]);
}
