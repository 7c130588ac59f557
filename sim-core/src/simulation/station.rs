//! Radio of a robot within the simulation: its station, and the events recorded for messages.

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

    /// Number of messages that wait to be read now.
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

    /// Switches the radio off, see [`Station::switch_off`]; returns the number of messages that are never sent.
    pub fn switch_radio_off(&mut self) -> usize {
        self.switch_radio_off_after(|_, now| now)
    }

    /// Switches the radio off after it has sent its messages, see [`Station::switch_off_after`]; returns the number of messages that are
    /// never sent because they wait for a token.
    pub fn retire_radio(&mut self) -> usize {
        self.switch_radio_off_after(|station, now| station.last_start(now))
    }

    fn switch_radio_off_after(&mut self, last: impl FnOnce(&Station, Time) -> Time) -> usize {
        let now = self.now;
        self.settle_radio(now);
        let Some(station) = self.station_on() else { return 0 };
        let last = last(station, now);
        let unsent = station.unsent_count(last);
        let unheard = station.switch_off_after(last);
        unheard.iter().for_each(|fate| self.record_fate(now, fate));
        unsent
    }

    /// Sends a message now.
    ///
    /// # Errors
    /// [`BufferFull`] if the station's buffer has no room for it.
    ///
    /// # Panics
    /// If the radio is off.
    pub fn send_message(&mut self, world: &World, to: Address, payload: &[u8]) -> Result<(), BufferFull> {
        let now = self.now;
        self.settle_radio(now);
        let out_of_reach = world.unreachable_robots(self.id, self.motion.pose(now).position, now);
        let Self { station, journal, .. } = self;
        let station = station.as_deref_mut().expect("only a station that is on sends");
        let OutgoingMessage { sequence, to, begins, payload, .. } = station.send(now, to, payload, out_of_reach)?;
        let to = match to {
            Address::All => None,
            Address::One(address) => Some(*address),
        };
        let begins_s = begins.map(Time::seconds);
        journal.record(now, &Event::RadioSent { message: *sequence, to, begins_s, data: payload });
        Ok(())
    }

    /// Removes and returns the next message received by now.
    pub fn receive_message(&mut self) -> Option<ReceivedMessage> {
        self.settle_radio(self.now);
        let message = self.station_on()?.receive()?;
        self.record(Event::RadioReceived { from: message.from.0, message: message.sequence, data: &message.payload });
        Some(message)
    }

    /// Moves messages that are visible at `by` into the station's buffer.
    pub fn settle_radio(&mut self, by: Time) {
        let Some(station) = &mut self.station else { return };
        for fate in station.collect_visible(by) {
            self.record_fate(fate.visible, &fate);
        }
    }

    /// Queues a message in transit to this robot.
    pub(super) fn deliver(&mut self, delivery: Delivery) {
        if let Some(station) = &mut self.station {
            station.deliver(delivery);
        }
    }

    /// Records the outcomes of the messages in transit at the end of the run.
    pub(super) fn finish_radio(&mut self, end: Time) {
        let Some(station) = &mut self.station else { return };
        for fate in station.finish() {
            self.record_fate(end, &fate);
        }
    }

    fn station_on(&mut self) -> Option<&mut Station> {
        self.station.as_deref_mut().filter(|station| station.member().is_some())
    }

    fn record_fate(&mut self, at: Time, fate: &Delivery) {
        let (from, message, arrived_s) = (fate.from.0, fate.sequence, fate.arrives.seconds());
        let event = match &fate.outcome {
            Ok(arrived) => Event::RadioArrived { from, message, arrived_s, bit_errors: arrived.bit_errors },
            Err(loss) => Event::RadioLost { from, message, arrived_s, cause: loss.name() },
        };
        self.journal.record(at, &event);
    }
}
