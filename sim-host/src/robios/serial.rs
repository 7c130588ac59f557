//! Serial interfaces: what is sent is recorded and goes nowhere, and nothing is ever received.
//!
//! Source: RoBIOS 6 library, RS-232; that nothing is connected is our choice.

/// Names of the interfaces, `SERIAL1` to `SERIAL3`, in order of their numbers 0 to 2.
pub const PORTS: [&str; 3] = ["SERIAL1", "SERIAL2", "SERIAL3"];

/// Bits that a byte takes on the line: start, eight of data, stop.
pub const BITS_PER_BYTE: i64 = 10;

/// The interfaces of a robot.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial {
    /// Baud rate of each interface that was opened.
    baud: [Option<i32>; PORTS.len()],
}

impl Serial {
    /// Opens an interface; false if there is none of this number.
    pub fn open(&mut self, port: usize, baud: i32) -> bool {
        let Some(place) = self.baud.get_mut(port) else { return false };
        *place = Some(baud);
        true
    }

    /// Name and baud rate of an interface that was opened.
    pub fn opened(&self, port: usize) -> Option<(&'static str, i32)> {
        Some((PORTS.get(port)?, (*self.baud.get(port)?)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interfaces_are_used_after_they_are_opened() {
        let mut serial = Serial::default();
        assert_eq!(serial.opened(1), None);
        assert!(serial.open(1, 9_600) && !serial.open(3, 9_600));
        assert_eq!(serial.opened(1), Some(("SERIAL2", 9_600)));
        assert_eq!(serial.opened(3), None);
    }
}
