//! Radio of a robot in the simulation: its station, and the events that are recorded for messages.

use super::Robot;
use crate::radio::{Address, BufferFull, Delivery, OutgoingMessage, ReceivedMessage, Station, StationInfo};
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
    /// transmitted.
    pub fn switch_radio_off(&mut self) -> usize {
        self.switch_radio_off_after(|_, now| now)
    }

    /// Switches the radio off after it has transmitted its messages, see [`Station::switch_off_after`]. Returns the
    /// number of messages that will never be transmitted, because they wait for a token.
    pub fn retire_radio(&mut self) -> usize {
        self.switch_radio_off_after(|station, now| station.last_start(now))
    }

    fn switch_radio_off_after(&mut self, off_time: impl FnOnce(&Station, Time) -> Time) -> usize {
        let now = self.now;
        self.settle_radio(now);
        let Some(station) = self.station_on() else { return 0 };
        let off_time = off_time(station, now);
        let unsent = station.unsent_count(off_time);
        let undelivered = station.switch_off_after(off_time);
        undelivered.iter().for_each(|delivery| self.record_outcome(now, delivery));
        unsent
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
        for delivery in station.collect_visible(at) {
            self.record_outcome(delivery.visible, &delivery);
        }
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
        for delivery in station.finish() {
            self.record_outcome(end, &delivery);
        }
    }

    fn station_on(&mut self) -> Option<&mut Station> {
        self.station.as_deref_mut().filter(|station| station.member().is_some())
    }

    fn record_outcome(&mut self, at: Time, delivery: &Delivery) {
        let (from, message, arrived_s) = (delivery.from.0, delivery.sequence, delivery.arrives.seconds());
        let event = match &delivery.outcome {
            Ok(arrived) => Event::RadioArrived { from, message, arrived_s, bit_errors: arrived.bit_errors },
            Err(loss) => Event::RadioLost { from, message, arrived_s, cause: loss.name() },
        };
        self.journal.record(at, &event);
    }
}
