//! The four keys under the display, and touches of the display.

use std::time::Duration;

use robios_sys::robios7::KEY_INVALID;

use super::Robot;
use crate::key::Key;
use crate::lcd::Pixel;
use crate::robot::robios7;

impl Robot {
    /// Waits for any key.
    #[track_caller]
    pub fn wait_for_any_key(&self) -> Key {
        loop {
            if let Some(key) = Key::from_code(robios7!(self, KEYGet())) {
                return key;
            }
            // On a host without keys the call fails immediately; the sleep lets virtual time pass.
            self.sleep(Duration::from_millis(10));
        }
    }

    /// Waits for a certain key; other keys are discarded.
    #[track_caller]
    pub fn wait_for_key(&self, key: Key) {
        while robios7!(self, KEYWait(key.code())) == KEY_INVALID {
            self.sleep(Duration::from_millis(10));
        }
    }

    /// The key that is pressed and has not been read yet, without waiting.
    #[track_caller]
    pub fn key(&self) -> Option<Key> {
        Key::from_code(robios7!(self, KEYRead()))
    }

    /// Waits for a touch of the display and returns its position.
    #[track_caller]
    pub fn wait_for_touch(&self) -> Pixel {
        let mut pixel = Pixel { x: 0, y: 0 };
        while robios7!(self, KEYGetXY(&mut pixel.x, &mut pixel.y)) != 0 {
            self.sleep(Duration::from_millis(10));
        }
        pixel
    }

    /// Position of a touch of the display that has not been read yet, without waiting.
    #[track_caller]
    pub fn touch(&self) -> Option<Pixel> {
        let mut pixel = Pixel { x: 0, y: 0 };
        let code: i32 = robios7!(self, KEYReadXY(&mut pixel.x, &mut pixel.y));
        (code == 0).then_some(pixel)
    }
}
