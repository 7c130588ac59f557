//! The four keys under the LCD.

use std::time::Duration;

use robios_sys::robios6::{KEY1, KEY2, KEY3, KEY4};

use crate::Robot;
use crate::robot::robios;

/// A key, from left to right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Key {
    /// The left one.
    Key1,
    /// The second from the left.
    Key2,
    /// The third from the left.
    Key3,
    /// The right one.
    Key4,
}

impl Key {
    /// All keys from left to right.
    pub const ALL: [Self; 4] = [Self::Key1, Self::Key2, Self::Key3, Self::Key4];

    /// Code of the key in RoBIOS.
    pub const fn code(self) -> i32 {
        match self {
            Self::Key1 => KEY1,
            Self::Key2 => KEY2,
            Self::Key3 => KEY3,
            Self::Key4 => KEY4,
        }
    }

    /// The key with this code; `None` for no key, or several.
    pub fn from_code(code: i32) -> Option<Self> {
        Self::ALL.into_iter().find(|key| key.code() == code)
    }
}

impl Robot {
    /// Waits for any key.
    #[track_caller]
    pub fn wait_for_any_key(&self) -> Key {
        loop {
            if let Some(key) = Key::from_code(robios!(self, KEYGet())) {
                return key;
            }
            // On a host without keys the call fails immediately; the sleep lets virtual time pass.
            self.sleep(Duration::from_millis(10));
        }
    }

    /// Waits for a certain key; other keys are discarded.
    #[track_caller]
    pub fn wait_for_key(&self, key: Key) {
        while robios!(self, KEYWait(key.code())) != 0 {
            self.sleep(Duration::from_millis(10));
        }
    }

    /// The key that is pressed and has not been read yet, without waiting.
    #[track_caller]
    pub fn key(&self) -> Option<Key> {
        Key::from_code(robios!(self, KEYRead()))
    }
}
