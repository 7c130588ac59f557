//! The radio, as far as both generations have it: switching it, sending, waiting for a message.
//!
//! A robot sends and receives by its own station; what the stations have sent goes to the others at the slot's end, see
//! [`crate::executive::radio`]. Sources: RoBIOS 6 library, radio communication; RoBIOS-7 library, radio communication.

use robios_sys::robios6::{BROADCAST, RadioIOParameters};
use sim_core::RobotId;
use sim_core::radio::{Address, Change, Delivery, Member, Message, Sending, Station};
use sim_core::time::Time;
use sim_core::world::World;

use super::caller::{Call, Poll};
use super::hint::Mistake;
use super::robot::{Robot, Waits};
use sim_core::record::Event;

/// The radio of one robot.
#[derive(Clone, Debug, Default)]
pub struct Radio {
    /// Since it was first switched on.
    station: Option<Box<Station>>,
    /// What a program of RoBIOS 6 has set.
    pub settings: Option<RadioIOParameters>,
    /// How many messages the program has sent.
    pub sent: i32,
    /// How many messages the program has taken.
    pub taken: i32,
}

/// What the slot loop has to tell the channel of a station.
#[derive(Clone, Debug)]
pub struct News {
    /// What the channel is to know, if it was switched.
    pub change: Option<Change>,
    /// What it has sent.
    pub sendings: Vec<Sending>,
}

impl Radio {
    /// Its station while it is on.
    fn on(&mut self) -> Option<&mut Station> {
        self.station.as_deref_mut().filter(|station| station.member().is_some())
    }

    /// Address and speed while it is on.
    pub fn member(&self) -> Option<Member> {
        self.station.as_ref()?.member()
    }

    /// How many messages wait to be taken.
    pub fn waiting(&self) -> i32 {
        self.station.as_ref().map_or(0, |station| station.waiting() as i32)
    }

    /// What has happened since this was asked last.
    pub fn take_news(&mut self) -> Option<News> {
        let station = self.station.as_mut()?;
        let change = station.take_change();
        let sendings = station.take_sent();
        (change.is_some() || !sendings.is_empty()).then_some(News { change, sendings })
    }

    /// The medium has sent the message of this number.
    pub fn has_left(&mut self, sequence: u64) {
        if let Some(station) = &mut self.station {
            station.has_left(sequence);
        }
    }
}

/// `RADIOInit`: as the station of `address` that sends with `baud`.
pub fn init(robot: &mut Robot, world: &World, call: impl Into<Call>, failure: i32, address: u32, baud: u32) -> i32 {
    if robot.devices.radio.member().is_some() {
        return robot.refused(call, failure, |_| "the radio is on already".to_owned());
    }
    let id = robot.id;
    let station = &mut robot.devices.radio.station;
    let station = station.get_or_insert_with(|| Box::new(Station::new(id, world.radio().model())));
    station.switch_on(address, baud);
    0
}

/// `RADIOTerm`, `RADIORelease`
pub fn release(robot: &mut Robot, call: impl Into<Call>, failure: i32) -> i32 {
    if robot.devices.radio.member().is_none() {
        return is_off(robot, call, failure);
    }
    switch_off(robot);
    0
}

/// The answer of a call that needs the radio to be on.
pub fn is_off(robot: &mut Robot, call: impl Into<Call>, failure: i32) -> i32 {
    robot.refused(call, failure, |_| "the radio is off: `RADIOInit` switches it on".to_owned())
}

/// Switches the radio off; how many messages are left unsent.
fn switch_off(robot: &mut Robot) -> usize {
    settle(robot, robot.now);
    let now = robot.now;
    let Some(station) = robot.devices.radio.on() else { return 0 };
    let unsent = station.unsent(now);
    let unheard = station.switch_off(now);
    robot.tasks.look_at_radio(now);
    unheard.iter().for_each(|fate| record_fate(robot, now, fate));
    unsent
}

/// `RADIOSend`
pub fn send(robot: &mut Robot, world: &World, call: impl Into<Call>, to: u32, payload: Result<&[u8], String>) -> i32 {
    const FAILURE: i32 = 1;
    if robot.devices.radio.member().is_none() {
        return is_off(robot, call, FAILURE);
    }
    let payload = match payload {
        Ok(payload) => payload,
        Err(reason) => return robot.refused(call, FAILURE, |_| reason),
    };
    if !is_known(robot, world, to) {
        let text = format!("`RADIOSend` to {to}: no other robot has this address, nobody hears the message");
        robot.hint_once(Mistake::UnknownAddress, &text);
    }
    settle(robot, robot.now);
    let now = robot.now;
    let out_of_reach = world.out_of_reach(robot.id, robot.motion.pose(now).position, now);
    let to = if to == BROADCAST as u32 { Address::All } else { Address::One(to) };
    let Robot { devices, journal, .. } = robot;
    let Some(station) = devices.radio.on() else { return FAILURE };
    let Ok(sending) = station.send(now, to, payload, out_of_reach) else { return robot.failed(call, FAILURE) };
    let event = Event::RadioSent {
        message: sending.sequence,
        to: match sending.to {
            Address::All => None,
            Address::One(address) => Some(address),
        },
        begins_s: sending.begins.map(Time::seconds),
        data: &sending.payload,
    };
    journal.record(now, &event);
    devices.radio.sent = devices.radio.sent.saturating_add(1);
    0
}

/// True for the address of another robot of the scene, as far as is known, and for that of all.
fn is_known(robot: &Robot, world: &World, address: u32) -> bool {
    let is_own = robot.devices.radio.member().is_some_and(|member| member.address == address);
    let is_number = address > 0 && world.is_robot_there(RobotId(address), robot.now);
    let is_on = || world.radio().members().iter().any(|member| member.address == address);
    address == BROADCAST as u32 || !is_own && (is_number || is_on())
}

/// `RADIOCheck`
pub fn check(robot: &mut Robot, call: impl Into<Call>) -> i32 {
    if robot.devices.radio.member().is_none() {
        return is_off(robot, call, 0);
    }
    settle(robot, robot.now);
    robot.devices.radio.waiting()
}

/// Waits for a message, which `give` hands to the program.
pub fn receive(robot: &mut Robot, call: impl Into<Call>, failure: i32, give: impl FnOnce(&Message)) -> Poll<i32> {
    settle(robot, robot.now);
    let Some(station) = robot.devices.radio.on() else { return Poll::Ready(is_off(robot, call, failure)) };
    let Some(message) = station.receive() else {
        return Poll::Until { at: station.next_visible(), waits_for: Waits::Message };
    };
    robot.devices.radio.taken = robot.devices.radio.taken.saturating_add(1);
    robot.record(Event::RadioReceived { from: message.from.0, message: message.sequence, data: &message.payload });
    give(&message);
    Poll::Ready(0)
}

/// Puts the messages that are visible by `by` into the buffer, and records what became of each at its time.
pub fn settle(robot: &mut Robot, by: Time) {
    let Some(station) = &mut robot.devices.radio.station else { return };
    for fate in station.settle(by) {
        record_fate(robot, fate.visible, &fate);
    }
}

/// A message, or the news of its loss, is on its way to the robot.
pub fn deliver(robot: &mut Robot, delivery: Delivery) {
    if let Some(station) = &mut robot.devices.radio.station {
        robot.tasks.look_at_radio(delivery.visible);
        station.deliver(delivery);
    }
}

/// Ends the radio with the program.
pub fn end(robot: &mut Robot) {
    let unsent = switch_off(robot);
    if unsent > 0 {
        let messages = if unsent == 1 { "a message was".to_owned() } else { format!("{unsent} messages were") };
        robot.hint(&format!("the program ended before {messages} sent: its radio needs the time for it"));
    }
}

/// Records what becomes of the messages that are still on their way when the run ends.
pub fn finish(robot: &mut Robot, end: Time) {
    let Some(station) = &mut robot.devices.radio.station else { return };
    for fate in station.finish() {
        record_fate(robot, end, &fate);
    }
}

fn record_fate(robot: &mut Robot, at: Time, fate: &Delivery) {
    let (from, message, arrived_s) = (fate.from.0, fate.sequence, fate.arrives.seconds());
    let event = match &fate.outcome {
        Ok(arrived) => Event::RadioArrived { from, message, arrived_s, bit_errors: arrived.bit_errors },
        Err(loss) => Event::RadioLost { from, message, arrived_s, cause: loss.name() },
    };
    robot.journal.record(at, &event);
}
