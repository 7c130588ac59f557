//! Serial interfaces. Output is recorded; input comes from the device that the robi's companion connects.
//!
//! A byte takes 10 bits at the baud rate. A loop-back returns all output; a connected file is sent from the opening of
//! the interface on. An interface with nothing connected never receives anything. Sources: RoBIOS 6 library, RS-232;
//! RoBIOS-7 library, serial communication; the transmission time of bytes is our choice.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use robios_sys::robios6::{NONE, RTSCTS, SER4800, SER9600, SER19200, SER38400, SER57600, SER115200};
use robios_sys::robios7::{Char, Flag, MAX_SERIAL};
use robios_sys::{Out, OutBytes, Robios6Call, Robios7Call};
use sim_core::spec::{SerialLine, SerialSpec};
use sim_core::time::Time;

use super::call::Call;
use super::caller::Poll;
use super::robot::{Robot, WaitReason};
use sim_core::record::Event;

/// Names of the interfaces from 1 on, in records.
const NAMES: [&str; 16] = [
    "SERIAL1", "SERIAL2", "SERIAL3", "SERIAL4", "SERIAL5", "SERIAL6", "SERIAL7", "SERIAL8", "SERIAL9", "SERIAL10",
    "SERIAL11", "SERIAL12", "SERIAL13", "SERIAL14", "SERIAL15", "SERIAL16",
];

/// Number of interfaces of RoBIOS 6: `SERIAL1` to `SERIAL3`.
const INTERFACES_OF_6: i32 = 3;

/// Baud rates of RoBIOS 6.
const RATES_OF_6: [i32; 6] = [SER4800, SER9600, SER19200, SER38400, SER57600, SER115200];

/// Maximum baud rate of RoBIOS-7; our choice.
const MAX_BAUD: i32 = 4_000_000;

/// Transmission time of a byte in microseconds, times the baud rate.
const BYTE_US_BAUD: i64 = 10_000_000;

/// Capacity of a loop-back in bytes; further bytes are lost. Our choice.
const LOOPBACK_CAPACITY: usize = 1 << 16;

/// The interfaces of a robot.
#[derive(Clone, Debug, Default)]
pub struct Serial {
    peers: BTreeMap<i32, Peer>,
    open: BTreeMap<i32, OpenInterface>,
}

/// Device at the other end of an interface.
#[derive(Clone, Debug)]
enum Peer {
    Loopback,
    /// A device that sends `bytes`; it had sent the first `sent` of them before the interface was last opened.
    Device {
        bytes: Arc<[u8]>,
        sent: usize,
    },
}

/// An open interface.
#[derive(Clone, Debug)]
struct OpenInterface {
    baud: i64,
    /// Time at which the interface was opened.
    opened_at: Time,
    /// Bytes in transmission, with their arrival times.
    incoming: VecDeque<(Time, u8)>,
    /// Number of the device's bytes that were taken since the interface was opened.
    read_count: usize,
}

impl Serial {
    /// Interfaces of a robot with the given connections.
    pub fn new(specs: &[SerialSpec]) -> Self {
        let peer = |line: &SerialLine| match line {
            SerialLine::Loopback => Peer::Loopback,
            SerialLine::File { bytes, .. } => Peer::Device { bytes: Arc::clone(bytes), sent: 0 },
        };
        let peers = specs.iter().map(|spec| (spec.interface.into(), peer(&spec.line))).collect();
        Self { peers, open: BTreeMap::new() }
    }

    /// Opens an interface, or opens it again with another rate; received bytes are discarded.
    pub fn open(&mut self, number: i32, baud: i32, now: Time) {
        self.close(number, now);
        let interface = OpenInterface { baud: baud.into(), opened_at: now, incoming: VecDeque::new(), read_count: 0 };
        self.open.insert(number, interface);
    }

    /// Closes an interface; returns false if it is not open.
    pub fn close(&mut self, number: i32, now: Time) -> bool {
        let Some(interface) = self.open.remove(&number) else { return false };
        if let Some(Peer::Device { bytes, sent }) = self.peers.get_mut(&number) {
            *sent += interface.arrived_count(now, bytes.len() - *sent);
        }
        true
    }

    /// Name of an open interface; `None` if it is not open.
    pub fn name_if_open(&self, number: i32) -> Option<&'static str> {
        let index = usize::try_from(number).ok()?.checked_sub(1)?;
        self.open.contains_key(&number).then(|| NAMES.get(index).copied())?
    }

    /// Sends bytes through an open interface.
    fn send(&mut self, number: i32, now: Time, bytes: &[u8]) {
        if let (Some(interface), Some(Peer::Loopback)) = (self.open.get_mut(&number), self.peers.get(&number)) {
            let mut arrival = interface.incoming.back().map_or(now, |(last, _)| now.max(*last));
            for byte in bytes.iter().take(LOOPBACK_CAPACITY - interface.incoming.len()) {
                arrival += Time(BYTE_US_BAUD.div_euclid(interface.baud).max(1));
                interface.incoming.push_back((arrival, *byte));
            }
        }
    }

    /// An open interface to a device, and the bytes that the device had not sent before the interface was opened.
    fn device(&self, number: i32) -> Option<(&OpenInterface, &[u8])> {
        let (interface, peer) = (self.open.get(&number)?, self.peers.get(&number)?);
        let Peer::Device { bytes, sent } = peer else { return None };
        Some((interface, &bytes[*sent..]))
    }

    /// Number of bytes that were received by `now` and not taken.
    pub fn received_count(&self, number: i32, now: Time) -> usize {
        if let Some((interface, bytes)) = self.device(number) {
            return interface.arrived_count(now, bytes.len()) - interface.read_count;
        }
        self.open.get(&number).map_or(0, |interface| interface.incoming.partition_point(|(arrival, _)| *arrival <= now))
    }

    /// Takes up to `max_count` of the bytes received by `now`, the earliest first.
    fn take(&mut self, number: i32, now: Time, max_count: usize) -> Vec<u8> {
        let count = self.received_count(number, now).min(max_count);
        let from_device = self
            .device(number)
            .map(|(interface, bytes)| bytes[interface.read_count..interface.read_count + count].to_vec());
        let Some(interface) = self.open.get_mut(&number) else { return Vec::new() };
        match from_device {
            Some(bytes) => {
                interface.read_count += count;
                bytes
            }
            None => interface.incoming.drain(..count).map(|(_, byte)| byte).collect(),
        }
    }

    /// Arrival time of the next byte; [`Time::NEVER`] if none is in transmission.
    fn next_arrival(&self, number: i32) -> Time {
        match self.device(number) {
            Some((interface, bytes)) if interface.read_count < bytes.len() => interface.arrival(interface.read_count),
            Some(_) => Time::NEVER,
            None => {
                let next = self.open.get(&number).and_then(|interface| interface.incoming.front());
                next.map_or(Time::NEVER, |(arrival, _)| *arrival)
            }
        }
    }
}

impl OpenInterface {
    /// Arrival time of byte `index` of a device, counted from the opening.
    fn arrival(&self, index: usize) -> Time {
        let bits = i128::from(BYTE_US_BAUD) * (index as i128 + 1);
        self.opened_at + Time((bits + i128::from(self.baud) - 1).div_euclid(i128::from(self.baud)) as i64)
    }

    /// Number of bytes of a device, at most `count`, that have arrived by `now`.
    fn arrived_count(&self, now: Time, count: usize) -> usize {
        let bits = i128::from((now - self.opened_at).0) * i128::from(self.baud);
        usize::try_from(bits.div_euclid(i128::from(BYTE_US_BAUD))).unwrap_or_default().min(count)
    }
}

/// `OSInitRS232`
pub fn init_6(robot: &mut Robot, baud: i32, handshake: i32, number: i32) -> i32 {
    let is_valid_setting = RATES_OF_6.contains(&baud) && [NONE, RTSCTS].contains(&handshake);
    if !is_valid_setting || !(1..=INTERFACES_OF_6).contains(&number) {
        return robot.fail_call(Robios6Call::OSInitRS232, -1);
    }
    open(robot, number, baud);
    0
}

/// `SERInit`
pub fn init_7(robot: &mut Robot, number: i32, baud: i32, handshake: i32) -> i32 {
    let is_valid_setting = (1..=MAX_BAUD).contains(&baud) && [NONE, RTSCTS].contains(&handshake);
    if !is_valid_setting || !(1..=NAMES.len() as i32).contains(&number) {
        return robot.refuse_call(Robios7Call::SERInit, 1, |_| {
            format!(
                "interface {number}, {baud} baud, handshake {handshake}: expected 1 to {}, 1 to {MAX_BAUD}, 0 or 1",
                NAMES.len()
            )
        });
    }
    open(robot, number, baud);
    0
}

fn open(robot: &mut Robot, number: i32, baud: i32) {
    robot.robios.serial.open(number, baud, robot.now);
    wake_receivers(robot, number);
}

/// Makes the tasks that wait for a byte from an interface check at the arrival of the next byte, which has changed.
fn wake_receivers(robot: &mut Robot, number: i32) {
    robot.tasks.recheck_input(robot.robios.serial.next_arrival(number));
}

/// `OSSendCharRS232`, `OSSendRS232`, `SERSendChar`, `SERSend`
pub fn send(robot: &mut Robot, call: impl Into<Call>, failure: i32, data: Option<&[u8]>, number: i32) -> i32 {
    let (Some(data), Some(port)) = (data, robot.robios.serial.name_if_open(number)) else {
        return robot.fail_call(call, failure);
    };
    robot.robios.serial.send(number, robot.now, data);
    wake_receivers(robot, number);
    robot.record(Event::SerialSent { port, data });
    0
}

/// `OSRecvRS232`
pub fn receive_6(robot: &mut Robot, buffer: &mut Out<u8>, number: i32) -> Poll<i32> {
    if buffer.is_null() || robot.robios.serial.name_if_open(number).is_none() {
        return Poll::Ready(robot.fail_call(Robios6Call::OSRecvRS232, -1));
    }
    receive(robot, number).map(|byte| {
        buffer.set(byte);
        0
    })
}

/// `SERReceiveChar`
pub fn receive_char(robot: &mut Robot, number: i32) -> Poll<Char> {
    if robot.robios.serial.name_if_open(number).is_none() {
        robot.fail_call(Robios7Call::SERReceiveChar, 0);
        return Poll::Ready(0);
    }
    receive(robot, number)
}

/// Waits for a byte from an open interface.
fn receive(robot: &mut Robot, number: i32) -> Poll<u8> {
    if let [byte] = take(robot, number, 1)[..] {
        return Poll::Ready(byte);
    }
    let serial = &robot.robios.serial;
    let (name, at) = (serial.name_if_open(number).unwrap_or_default(), serial.next_arrival(number));
    let connection = match serial.peers.get(&number) {
        None => "to which nothing is connected",
        Some(Peer::Loopback) => "which returns all bytes that are sent",
        Some(Peer::Device { .. }) => "whose file is at its end",
    };
    Poll::Pending { at, reason: WaitReason::Input(format!("a byte on {name}, {connection}")) }
}

/// Takes up to `max_count` received bytes and records them.
fn take(robot: &mut Robot, number: i32, max_count: usize) -> Vec<u8> {
    let now = robot.now;
    let data = robot.robios.serial.take(number, now, max_count);
    if let (false, Some(port)) = (data.is_empty(), robot.robios.serial.name_if_open(number)) {
        robot.record(Event::SerialReceived { port, data: &data });
    }
    data
}

/// `SERReceive`: stores the received bytes and a final 0; returns the number of received bytes.
pub fn receive_all(robot: &mut Robot, number: i32, buffer: &mut OutBytes) -> i32 {
    if buffer.is_null() || robot.robios.serial.name_if_open(number).is_none() {
        return robot.fail_call(Robios7Call::SERReceive, 0);
    }
    let mut data = take(robot, number, buffer.capacity().min(MAX_SERIAL).saturating_sub(1));
    let count = data.len();
    data.push(0);
    buffer.set(&data);
    count as i32
}

/// `OSCheckInRS232`: number of received bytes.
pub fn check_in(robot: &mut Robot, number: i32) -> i32 {
    if robot.robios.serial.name_if_open(number).is_none() {
        return robot.fail_call(Robios6Call::OSCheckInRS232, -1);
    }
    robot.robios.serial.received_count(number, robot.now) as i32
}

/// `SERCheck`
pub fn has_input(robot: &mut Robot, number: i32) -> Flag {
    if robot.robios.serial.name_if_open(number).is_none() {
        robot.fail_call(Robios7Call::SERCheck, 0);
    }
    (robot.robios.serial.received_count(number, robot.now) > 0).into()
}

/// `OSFlushInRS232`, `SERFlush`: discards received bytes.
pub fn flush(robot: &mut Robot, call: impl Into<Call>, failure: i32, number: i32) -> i32 {
    if robot.robios.serial.name_if_open(number).is_none() {
        return robot.fail_call(call, failure);
    }
    robot.robios.serial.take(number, robot.now, usize::MAX);
    0
}

/// `OSFlushOutRS232`, `OSCheckOutRS232`: the output buffers are always empty.
pub fn check_out(robot: &mut Robot, call: Robios6Call, number: i32) -> i32 {
    if robot.robios.serial.name_if_open(number).is_some() { 0 } else { robot.fail_call(call, -1) }
}

/// `SERClose`
pub fn close(robot: &mut Robot, number: i32) -> i32 {
    let now = robot.now;
    if !robot.robios.serial.close(number, now) {
        return robot.fail_call(Robios7Call::SERClose, 1);
    }
    // A task that waits for a byte fails now.
    robot.tasks.recheck_input(now);
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn serial(line: SerialLine) -> Serial {
        Serial::new(&[SerialSpec { interface: 2, line }])
    }

    fn device(bytes: &[u8]) -> Serial {
        let path = sim_core::spec::SpannedText { text: String::new(), span: sim_core::spec::Span::default() };
        serial(SerialLine::File { path, bytes: bytes.into() })
    }

    #[test]
    fn an_interface_is_usable_only_while_it_is_open() {
        let mut serial = Serial::default();
        assert_eq!(serial.name_if_open(2), None);
        serial.open(2, 9_600, Time(0));
        assert_eq!(serial.name_if_open(2), Some("SERIAL2"));
        assert_eq!([serial.name_if_open(1), serial.name_if_open(0), serial.name_if_open(-1)], [None; 3]);
        assert_eq!(
            (serial.received_count(2, Time(1_000_000)), serial.next_arrival(2)),
            (0, Time::NEVER),
            "nothing is connected"
        );
        assert!(serial.close(2, Time(0)) && !serial.close(2, Time(0)));
    }

    #[test]
    fn a_loop_back_returns_each_byte_after_its_ten_bits() {
        let mut serial = serial(SerialLine::Loopback);
        serial.send(2, Time(0), b"lost, as it is not open");
        // 10 bits at 10,000 baud: 1 ms.
        serial.open(2, 10_000, Time(0));
        serial.send(2, Time(500), b"abc");
        assert_eq!(serial.next_arrival(2), Time(1_500));
        assert_eq!(
            [0, 1_499, 1_500, 2_499, 2_500, 9_000].map(|now| serial.received_count(2, Time(now))),
            [0, 0, 1, 1, 2, 3]
        );
        assert_eq!(serial.take(2, Time(2_500), 9), b"ab");
        assert_eq!(serial.take(2, Time(9_000), 9), b"c");
        serial.send(2, Time(9_000), &vec![7; 2 * LOOPBACK_CAPACITY]);
        assert_eq!(serial.received_count(2, Time(1_000_000_000)), LOOPBACK_CAPACITY);
    }

    #[test]
    fn a_device_sends_its_file_while_the_interface_is_open() {
        let mut serial = device(b"abcdef");
        serial.open(2, 10_000, Time(5_000));
        assert_eq!(serial.next_arrival(2), Time(6_000));
        assert_eq!(serial.take(2, Time(7_500), 1), b"a");
        assert_eq!((serial.received_count(2, Time(7_999)), serial.received_count(2, Time(8_000))), (1, 2));
        // Opened again after 3 bytes: the two received bytes that were not taken are discarded.
        serial.open(2, 5_000, Time(8_500));
        assert_eq!(serial.next_arrival(2), Time(10_500));
        assert_eq!(serial.take(2, Time(1_000_000), 99), b"def");
        assert_eq!(serial.next_arrival(2), Time::NEVER);
    }

    #[test]
    fn arrival_times_and_received_counts_agree() {
        for baud in [300, 9_600, 115_200, MAX_BAUD] {
            let mut serial = device(&[0; 500]);
            serial.open(2, baud, Time(17));
            for index in 0..500 {
                let at = serial.next_arrival(2);
                assert!(
                    serial.received_count(2, at - Time(1)) == 0 && serial.received_count(2, at) > 0,
                    "byte {index} at {baud} baud"
                );
                assert_eq!(serial.take(2, at, 1).len(), 1);
            }
        }
    }
}
