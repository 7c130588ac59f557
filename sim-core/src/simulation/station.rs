//! A robot's radio within the simulation: its station, and what is recorded of messages.

use super::Robot;
use crate::radio::{Address, Delivery, Full, Member, Message, Sending, Station};
use crate::record::Event;
use crate::time::Time;
use crate::world::World;

impl Robot {
    /// Address and speed of its radio; `None` while that is off.
    pub fn radio_member(&self) -> Option<Member> {
        self.station.as_ref()?.member()
    }

    /// How many messages wait to be read by now.
    pub fn radio_waiting(&mut self) -> usize {
        self.settle_radio(self.now);
        self.station.as_ref().map_or(0, |station| station.waiting())
    }

    /// From when on the next message on its way is visible; [`Time::NEVER`] for none.
    pub fn next_message(&self) -> Time {
        self.station.as_ref().map_or(Time::NEVER, |station| station.next_visible())
    }

    /// Switches its radio on.
    pub fn switch_radio_on(&mut self, world: &World, address: u32, baud: u32) {
        let id = self.id;
        let station = self.station.get_or_insert_with(|| Box::new(Station::new(id, world.radio().model())));
        station.switch_on(address, baud);
    }

    /// Switches its radio off, see [`Station::switch_off`]; how many messages are never sent.
    pub fn switch_radio_off(&mut self) -> usize {
        let now = self.now;
        self.settle_radio(now);
        let Some(station) = self.station_on() else { return 0 };
        let unsent = station.unsent(now);
        let unheard = station.switch_off(now);
        unheard.iter().for_each(|fate| self.record_fate(now, fate));
        unsent
    }

    /// Sends a message now.
    ///
    /// # Errors
    /// [`Full`] when the station has no room for it.
    ///
    /// # Panics
    /// If its radio is off.
    pub fn send_message(&mut self, world: &World, to: Address, payload: &[u8]) -> Result<(), Full> {
        let now = self.now;
        self.settle_radio(now);
        let out_of_reach = world.out_of_reach(self.id, self.motion.pose(now).position, now);
        let Self { station, journal, .. } = self;
        let station = station.as_deref_mut().expect("only a station that is on sends");
        let Sending { sequence, to, begins, payload, .. } = station.send(now, to, payload, out_of_reach)?;
        let to = match to {
            Address::All => None,
            Address::One(address) => Some(*address),
        };
        let begins_s = begins.map(Time::seconds);
        journal.record(now, &Event::RadioSent { message: *sequence, to, begins_s, data: payload });
        Ok(())
    }

    /// Takes the next message that it has received by now.
    pub fn receive_message(&mut self) -> Option<Message> {
        self.settle_radio(self.now);
        let message = self.station_on()?.receive()?;
        self.record(Event::RadioReceived { from: message.from.0, message: message.sequence, data: &message.payload });
        Some(message)
    }

    /// Puts what is visible at `by` into the buffer of its station.
    pub fn settle_radio(&mut self, by: Time) {
        let Some(station) = &mut self.station else { return };
        for fate in station.settle(by) {
            self.record_fate(fate.visible, &fate);
        }
    }

    /// A message is on its way to it.
    pub(super) fn deliver(&mut self, delivery: Delivery) {
        if let Some(station) = &mut self.station {
            station.deliver(delivery);
        }
    }

    /// The run ends: records what becomes of the messages that are on their way.
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
