//! Edge cases.

use super::*;

const MEDIA: [Medium; 3] = [Medium::Free, Medium::Aloha, Medium::TokenRing];

/// A channel with the stations of the robots 1 and 2, both on.
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
        let mut messages = Vec::new();
        for station in &mut self.stations {
            station.take_change().into_iter().for_each(|change| self.channel.report_change(change));
            messages.append(&mut station.take_outgoing());
        }
        let deliveries = self.channel.exchange(slot_end, messages);
        for (robot, sequence) in self.channel.take_transmitted() {
            self.stations[robot.index()].release(sequence);
        }
        deliveries
    }

    /// Runs the due slots until none is left.
    fn run(&mut self, slot: Time) -> Vec<Delivery> {
        let mut deliveries = self.end_slot(slot);
        while self.channel.due() < Time::NEVER - slot {
            deliveries.extend(self.end_slot(self.channel.due().floor_to(slot) + slot));
        }
        deliveries
    }
}

fn outcomes(deliveries: &[Delivery]) -> Vec<(u64, Result<(), Loss>)> {
    deliveries.iter().map(|delivery| (delivery.sequence, delivery.outcome.clone().map(|_| ()))).collect()
}

#[test]
fn air_time_is_bits_over_baud() {
    // 35 + 7 bytes of 10 bits at 9600 baud; rounded up.
    assert_eq!(air_time(35, 9_600), Time(43_750));
    assert_eq!(air_time(0, 115_200), Time(608));
    assert_eq!([air_time(0, u32::MAX), air_time(0, 1)], [Time(1), Time::from_millis(70_000)]);
    assert_eq!([air_time(usize::MAX, 1), air_time(usize::MAX, u32::MAX)], [Time::NEVER, Time(42_949_672_970_000_001)]);
    assert_eq!(air_time(1_000_000, 1), Time(10_000_070_000_000));
}

#[test]
fn hours_of_air_time_and_latency_are_exact() {
    for medium in MEDIA {
        for slot in [Time(1_000), Time::from_millis(50), Time::from_millis(10_000)] {
            let model =
                RadioModel { medium, baud: 1, latency: Time::from_millis(3 * 3_600_000), ..RadioModel::default() };
            let mut pair = Pair::new(model);
            pair.end_slot(slot);
            let sent = slot + Time(17);
            pair.send(sent, &[7; 1_000]);
            let deliveries = pair.run(slot + slot);
            assert_eq!(outcomes(&deliveries), [(1, Ok(()))], "{medium:?}");
            let delay = Time::from_millis(10_070_000) + model.latency;
            let begins = if medium == Medium::TokenRing { slot + Time(4 * 70_000_000) } else { sent };
            assert_eq!(deliveries[0].arrives, begins + delay, "{medium:?}");
        }
    }
}

#[test]
fn times_near_the_maximum_do_not_overflow() {
    for medium in MEDIA {
        let late = Time(i64::MAX - 1_000);
        let mut pair = Pair::new(RadioModel { medium, latency: Time::NEVER, ..RadioModel::default() });
        pair.end_slot(Time(i64::MAX - 2_000));
        pair.send(late, b"too late");
        let mut deliveries = pair.end_slot(Time::NEVER - Time(1));
        assert_eq!(pair.channel.due(), Time::NEVER, "{medium:?}");
        deliveries.extend(pair.channel.finish(Time::NEVER - Time(1)));
        assert!(deliveries.iter().all(|delivery| delivery.arrives == Time::NEVER), "{deliveries:?}");
        let expected = if medium == Medium::Free { Ok(()) } else { Err(Loss::End) };
        assert_eq!(outcomes(&deliveries), [(1, expected)], "{medium:?}");
    }
}

#[test]
fn switching_off_cancels_transmissions_that_have_not_begun() {
    let slot = Time::from_millis(50);
    for medium in MEDIA {
        let mut pair = Pair::new(RadioModel { medium, ..RadioModel::default() });
        pair.end_slot(slot);
        // In a token ring, the token arrives only 4 frames after the slot's end.
        for _ in 0..3 {
            pair.send(slot, &[0; 100]);
        }
        pair.stations[0].switch_off(slot + Time(1));
        pair.stations[0].switch_on(1, RadioModel::default().baud);
        pair.send(slot + Time(20), b"again");
        let deliveries = pair.end_slot(slot + slot);
        let mut outcomes = outcomes(&deliveries);
        outcomes.sort_by_key(|(sequence, _)| *sequence);
        let first = if medium == Medium::TokenRing { Err(Loss::Unsent) } else { Ok(()) };
        assert_eq!(outcomes, [(1, first), (2, Err(Loss::Unsent)), (3, Err(Loss::Unsent)), (4, Ok(()))], "{medium:?}");
        for delivery in deliveries.iter().filter(|delivery| delivery.outcome == Err(Loss::Unsent)) {
            assert_eq!((delivery.to, delivery.visible), (RobotId(1), slot + slot));
        }
    }
}

#[test]
fn free_medium_transmits_taken_messages_and_aloha_cancels_them() {
    for (medium, second_outcome) in [(Medium::Free, Ok(())), (Medium::Aloha, Err(Loss::Unsent))] {
        let slot = Time::from_millis(1);
        let mut pair = Pair::new(RadioModel { medium, ..RadioModel::default() });
        // Each transmission takes 9.3 ms.
        pair.send(Time::ZERO, &[0; 100]);
        pair.send(Time::ZERO, &[0; 100]);
        let mut deliveries = pair.end_slot(slot);
        assert_eq!(pair.stations[0].unsent_count(Time(1_500)), Some(usize::from(medium == Medium::Aloha)));
        pair.stations[0].switch_off(Time(1_500));
        deliveries.extend(pair.run(slot + slot));
        deliveries.sort_by_key(|delivery| delivery.sequence);
        assert_eq!(outcomes(&deliveries), [(1, Ok(())), (2, second_outcome)]);
        // The transmitter stays busy with outgoing messages even if the station is switched on again.
        pair.stations[0].switch_on(1, BAUD);
        let busy_air_times = if medium == Medium::Free { 2 } else { 1 };
        let message = pair.stations[0].send(Time(2_000), Address::All, &[1], Vec::new()).expect("there is room");
        assert_eq!(message.begins, Some(Time(busy_air_times * air_time(100, BAUD).0)));
    }
}

#[test]
fn switching_off_loses_messages_in_transit() {
    let slot = Time::from_millis(50);
    let mut pair = Pair::new(RadioModel { latency: Time::from_millis(100), ..RadioModel::default() });
    pair.send(Time::ZERO, b"one");
    pair.end_slot(slot).into_iter().for_each(|delivery| pair.stations[1].deliver(delivery));
    let lost = pair.stations[1].switch_off(Time::from_millis(60));
    assert_eq!(outcomes(&lost), [(1, Err(Loss::Off))]);
    assert_eq!(
        (pair.stations[1].switch_off(Time::from_millis(61)), pair.stations[1].next_visible()),
        (vec![], Time::NEVER)
    );
    // A message of a station to its own address has no receiver.
    pair.stations[0].send(Time::from_millis(70), Address::One(1), b"me", Vec::new()).expect("there is room");
    assert_eq!(outcomes(&pair.end_slot(slot + slot)), [(2, Err(Loss::Nobody))]);
}

#[test]
fn full_buffers_reject_messages() {
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
    for (sequence, bytes) in [(1, BUFFER_BYTES - 1), (2, 2), (3, 0), (4, 0)] {
        station.deliver(delivery(sequence, bytes));
    }
    let collected = station.collect_visible(Time(100));
    let full = Err(Loss::Overflow);
    assert_eq!(outcomes(&collected), [(1, Ok(())), (2, full), (3, Ok(())), (4, full)]);
    assert_eq!(station.waiting(), 2);
    // The outgoing buffer also frees space as transmissions end.
    let baud = RadioModel::default().baud;
    pair.send(Time::ZERO, &[0; BUFFER_BYTES]);
    let end = air_time(BUFFER_BYTES, baud);
    assert_eq!(pair.stations[0].send(end - Time(1), Address::All, &[], Vec::new()).err(), Some(BufferFull));
    assert!(pair.stations[0].send(end, Address::All, &[], Vec::new()).is_ok());
}

#[test]
fn simultaneous_messages_are_in_the_order_of_their_senders() {
    for medium in [Medium::Free, Medium::TokenRing] {
        let mut channel = channel(RadioModel { medium, ..RadioModel::default() }, Vec::new(), 50);
        channel.exchange(Time(1), Vec::new());
        let broadcast = |from| message_from(from, 1, Address::All, vec![0; 4], Time(1));
        let deliveries = channel.exchange(Time::from_millis(10_000), (1..=50).rev().map(broadcast).collect());
        assert_eq!(deliveries.len(), 50 * 49);
        let senders_at_robot_3: Vec<u32> =
            deliveries.iter().filter(|delivery| delivery.to == RobotId(3)).map(|delivery| delivery.from.0).collect();
        assert_eq!(senders_at_robot_3, (1..=50).filter(|from| *from != 3).collect::<Vec<_>>());
    }
}

#[test]
fn all_stations_with_the_address_receive_the_message() {
    let mut channel = channel(RadioModel::default(), Vec::new(), 4);
    let member = |robot, address, baud| Some(StationInfo { robot: RobotId(robot), address, baud });
    channel.set_member(RobotId(2), member(2, 7, BAUD));
    channel.set_member(RobotId(4), member(4, 7, 9_600));
    channel.set_member(RobotId(3), None);
    let send_to = |address| {
        channel.clone().exchange(Time(1), vec![message_from(1, 1, Address::One(address), vec![], Time::ZERO)])
    };
    let outcomes =
        |deliveries: Vec<Delivery>| deliveries.into_iter().map(|it| (it.to.0, it.outcome.err())).collect::<Vec<_>>();
    assert_eq!(outcomes(send_to(7)), [(2, None), (4, Some(Loss::Baud))]);
    assert_eq!(
        [outcomes(send_to(2)), outcomes(send_to(3)), outcomes(send_to(4))],
        [const { &[(1, Some(Loss::Nobody))] }; 3]
    );
}
