//! Serial interfaces: what is sent is recorded and goes nowhere, and nothing is ever received.
//!
//! Source: RoBIOS 6 library, RS-232; that nothing is connected is our choice.

use robios_sys::Robios6Call as Call;
use robios_sys::robios6::{
    NONE, RTSCTS, SER4800, SER9600, SER19200, SER38400, SER57600, SER115200, SERIAL1, SERIAL2, SERIAL3,
};
use sim_core::time::Time;

use super::caller::Poll;
use super::robot::{Robot, Waits};
use crate::record::Event;

/// The interfaces: their names and numbers.
const PORTS: [(&str, i32); 3] = [("SERIAL1", SERIAL1), ("SERIAL2", SERIAL2), ("SERIAL3", SERIAL3)];

/// Rates that an interface can be set to.
const RATES: [i32; 6] = [SER4800, SER9600, SER19200, SER38400, SER57600, SER115200];

/// The interfaces of a robot.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial {
    is_open: [bool; PORTS.len()],
}

impl Serial {
    /// Opens the interface of this number; false if there is none.
    pub fn open(&mut self, number: i32) -> bool {
        let port = PORTS.iter().position(|(_, port)| *port == number);
        port.inspect(|port| self.is_open[*port] = true).is_some()
    }

    /// Name of an interface that was opened.
    pub fn opened(&self, number: i32) -> Option<&'static str> {
        let ports = PORTS.iter().zip(self.is_open);
        ports.filter(|(_, is_open)| *is_open).find(|((_, port), _)| *port == number).map(|((name, _), _)| *name)
    }
}

/// `OSInitRS232`
pub fn init(robot: &mut Robot, baud: i32, handshake: i32, number: i32) -> i32 {
    let is_setting = RATES.contains(&baud) && [NONE, RTSCTS].contains(&handshake);
    if is_setting && robot.devices.serial.open(number) { 0 } else { robot.failed(Call::OSInitRS232, -1) }
}

/// `OSSendCharRS232`, `OSSendRS232`
pub fn send(robot: &mut Robot, call: Call, data: Option<&[u8]>, number: i32) -> i32 {
    let (Some(data), Some(port)) = (data, robot.devices.serial.opened(number)) else { return robot.failed(call, -1) };
    robot.record(Event::SerialSent { port, data });
    0
}

/// `OSRecvRS232`: waits, for ever.
pub fn receive(robot: &mut Robot, is_null: bool, number: i32) -> Poll<i32> {
    match robot.devices.serial.opened(number) {
        Some(port) if !is_null => {
            let waits_for = Waits::Input(format!("a byte on {port}, to which nothing is connected"));
            Poll::Until { at: Time::NEVER, waits_for }
        }
        _ => Poll::Ready(robot.failed(Call::OSRecvRS232, -1)),
    }
}

/// `OSFlushInRS232`, `OSFlushOutRS232`, `OSCheckInRS232`, `OSCheckOutRS232`: buffers are always empty.
pub fn check(robot: &mut Robot, call: Call, number: i32) -> i32 {
    if robot.devices.serial.opened(number).is_some() { 0 } else { robot.failed(call, -1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interfaces_are_used_after_they_are_opened() {
        let mut serial = Serial::default();
        assert_eq!(serial.opened(SERIAL2), None);
        assert!(serial.open(SERIAL2) && !serial.open(0) && !serial.open(4));
        assert_eq!(serial.opened(SERIAL2), Some("SERIAL2"));
        assert_eq!([serial.opened(SERIAL1), serial.opened(0), serial.opened(-1)], [None; 3]);
    }
}
