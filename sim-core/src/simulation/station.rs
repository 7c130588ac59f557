//! Radio of a robot in the simulation: its station, and the events that are recorded for messages.

use super::Robot;
use crate::radio::{
    Address, BufferFull, Delivery, Loss, Medium, OutgoingMessage, ReceivedMessage, Station, StationInfo,
};
use crate::record::Event;
use crate::time::Time;
use crate::world::World;

impl Robot {
    /// Address and speed of the radio; `None` while it is off.
    pub fn radio_member(&self) -> Option<StationInfo> {
        self.station.as_ref()?.member()
    }

    /// Number of received messages that have not been read yet.
    pub fn radio_waiting(&mut self) -> usize {
        self.settle_radio(self.now);
        self.station.as_ref().map_or(0, |station| station.waiting())
    }

    /// Time when the next message in transit becomes visible; [`Time::NEVER`] if there is none.
    pub fn next_message(&self) -> Time {
        self.station.as_ref().map_or(Time::NEVER, |station| station.next_visible())
    }

    /// Switches the radio on.
    pub fn switch_radio_on(&mut self, world: &World, address: u32, baud: u32) {
        let id = self.id;
        let station = self.station.get_or_insert_with(|| Box::new(Station::new(id, world.radio().model())));
        station.switch_on(address, baud);
    }

    /// Switches the radio off, see [`Station::switch_off`]; returns the number of messages that will never be
    /// transmitted, see [`Station::unsent_count`].
    pub fn switch_radio_off(&mut self) -> Option<usize> {
        self.switch_radio_off_after(|_, now| now)
    }

    /// Switches the radio off after it has transmitted its messages, see [`Station::switch_off_after`]; messages that
    /// wait for a token are never transmitted. Returns the same number as [`Robot::switch_radio_off`].
    pub fn retire_radio(&mut self) -> Option<usize> {
        self.switch_radio_off_after(|station, now| station.last_start(now))
    }

    fn switch_radio_off_after(&mut self, off_time: impl FnOnce(&Station, Time) -> Time) -> Option<usize> {
        let now = self.now;
        self.settle_radio(now);
        let Some(station) = self.station_on() else { return Some(0) };
        let off_time = off_time(station, now);
        let unsent = station.unsent_count(off_time);
        let undelivered = station.switch_off_after(off_time);
        self.record_outcomes(&undelivered, |_| now);
        unsent
    }

    /// Ends the radio's use by the program, after the radio was switched off with `unsent` messages, see
    /// [`Station::unsent_count`]. A hint gives the number of messages that will never be transmitted; in a token ring
    /// it is recorded with the losses.
    pub fn end_radio(&mut self, unsent: Option<usize>) {
        self.has_ended_radio = true;
        self.hint_unsent(self.now, unsent.unwrap_or(0));
    }

    fn hint_unsent(&mut self, at: Time, count: usize) {
        let messages = match count {
            0 => return,
            1 => "a message was".to_owned(),
            _ => format!("{count} messages were"),
        };
        let text = format!("the program ended before {messages} sent: its radio needs the time for it");
        self.journal.record(at, &Event::Hint { text: &text });
    }

    /// Sends a message now.
    ///
    /// # Errors
    /// [`BufferFull`] if the station's buffer has no space for the message.
    ///
    /// # Panics
    /// If the radio is off.
    pub fn send_message(&mut self, world: &World, to: Address, payload: &[u8]) -> Result<(), BufferFull> {
        let now = self.now;
        self.settle_radio(now);
        let unreachable = world.unreachable_robots(self.id, self.motion.pose(now).position, now);
        let Self { station, journal, .. } = self;
        let station = station.as_deref_mut().expect("the radio is on");
        let OutgoingMessage { sequence, to, begins, payload, .. } = station.send(now, to, payload, unreachable)?;
        let to = match to {
            Address::All => None,
            Address::One(address) => Some(*address),
        };
        let begins_s = begins.map(Time::seconds);
        journal.record(now, &Event::RadioSent { message: *sequence, to, begins_s, data: payload });
        Ok(())
    }

    /// Removes and returns the next message that has been received.
    pub fn receive_message(&mut self) -> Option<ReceivedMessage> {
        self.settle_radio(self.now);
        let message = self.station_on()?.receive()?;
        self.record(Event::RadioReceived { from: message.from.0, message: message.sequence, data: &message.payload });
        Some(message)
    }

    /// Moves the messages that are visible at `at` into the station's buffer.
    pub fn settle_radio(&mut self, at: Time) {
        let Some(station) = &mut self.station else { return };
        let visible = station.collect_visible(at);
        self.record_outcomes(&visible, |delivery| delivery.visible);
    }

    /// Queues a message in transit to this robot.
    pub(super) fn deliver(&mut self, delivery: Delivery) {
        if let Some(station) = &mut self.station {
            station.deliver(delivery);
        }
    }

    /// Records the outcomes of the messages that are in transit at the end of the run.
    pub(super) fn finish_radio(&mut self, end: Time) {
        let Some(station) = &mut self.station else { return };
        let undelivered = station.finish();
        self.record_outcomes(&undelivered, |_| end);
    }

    fn station_on(&mut self) -> Option<&mut Station> {
        self.station.as_deref_mut().filter(|station| station.member().is_some())
    }

    /// Records the outcomes of messages, each at the instant `at`.
    fn record_outcomes(&mut self, deliveries: &[Delivery], at: impl Fn(&Delivery) -> Time) {
        for delivery in deliveries {
            let (from, message, arrived_s) = (delivery.from.0, delivery.sequence, delivery.arrives.seconds());
            let event = match &delivery.outcome {
                Ok(arrived) => Event::RadioArrived { from, message, arrived_s, bit_errors: arrived.bit_errors },
                Err(loss) => Event::RadioLost { from, message, arrived_s, cause: loss.name() },
            };
            self.journal.record(at(delivery), &event);
        }
        let in_ring = |station: &Station| station.medium() == Medium::TokenRing;
        if self.has_ended_radio && self.station.as_deref().is_some_and(in_ring) {
            let is_unsent = |delivery: &&Delivery| delivery.outcome == Err(Loss::Unsent);
            let unsent = deliveries.iter().filter(is_unsent);
            self.hint_unsent(unsent.clone().next_back().map_or(self.now, &at), unsent.count());
        }
    }
}
