//! Handles of devices, as `...Init` returns them: one bit per device, so that programs can OR them.

/// Return value of a release if none of the handles is open. Source: RoBIOS 6 library, `SERVORelease`.
pub const WRONG_HANDLE: i32 = 0x1111_0000;

/// Number of devices of one kind that can have a handle: the bits of a positive C `int` (our choice; the manual
/// describes 8).
pub const MAX_DEVICES: usize = 31;

/// Open handles of one kind of device: device `i` of the robi has bit `i`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Handles {
    open: u32,
}

impl Handles {
    /// Returns the handle of device `index`, always the same for one device; 0 from index [`MAX_DEVICES`] on.
    pub fn open(&mut self, index: usize) -> i32 {
        if index >= MAX_DEVICES {
            return 0;
        }
        self.open |= 1 << index;
        1 << index
    }

    /// Index of the device of a handle that names exactly one open device.
    pub fn device(self, handle: i32) -> Option<usize> {
        let bits = handle as u32;
        (bits.is_power_of_two() && bits & self.open != 0).then_some(bits.trailing_zeros() as usize)
    }

    /// Indices of the devices in an OR of handles, in the order of the robi; `None` if the OR is 0 or has a bit that is
    /// not open.
    pub fn devices(self, handles: i32) -> Option<impl Iterator<Item = usize> + use<>> {
        let bits = handles as u32;
        (bits != 0 && bits & !self.open == 0).then(|| (0..MAX_DEVICES).filter(move |index| bits >> index & 1 == 1))
    }

    /// Returns true if any handle is open.
    pub fn is_any_open(self) -> bool {
        self.open != 0
    }

    /// Returns true if device `index` has an open handle.
    pub fn is_open(self, index: usize) -> bool {
        index < MAX_DEVICES && self.open >> index & 1 == 1
    }

    /// Releases an OR of handles and returns 0. If a bit is not open, nothing is released and the answer is
    /// [`WRONG_HANDLE`] (no bit is open) or the bits that are not open.
    ///
    /// Source: RoBIOS 6 library, `SERVORelease`.
    pub fn release(&mut self, handles: i32) -> i32 {
        let bits = handles as u32;
        if bits & self.open == 0 {
            return WRONG_HANDLE;
        }
        let unknown = bits & !self.open;
        if unknown == 0 {
            self.open &= !bits;
        }
        unknown as i32
    }

    /// Releases all handles.
    pub fn release_all(&mut self) {
        self.open = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_handle_of_a_device_is_always_the_same_bit() {
        let mut handles = Handles::default();
        assert_eq!([handles.open(0), handles.open(2), handles.open(0)], [1, 4, 1]);
        assert_eq!(handles.device(4), Some(2));
        assert_eq!(handles.device(2), None, "never opened");
        assert_eq!(handles.device(5), None, "two at once");
        assert_eq!(handles.devices(5).map(Iterator::collect), Some(vec![0, 2]));
        assert!(handles.devices(7).is_none() && handles.devices(0).is_none() && handles.devices(-1).is_none());
        assert_eq!(handles.open(31), 0);
    }

    #[test]
    fn release_is_all_or_nothing() {
        let mut handles = Handles::default();
        handles.open(0);
        handles.open(1);
        assert_eq!(handles.release(0), WRONG_HANDLE);
        assert_eq!(handles.release(8), WRONG_HANDLE);
        assert_eq!(handles.release(9), 8);
        assert_eq!(handles.device(1), Some(0), "nothing was released");
        assert_eq!(handles.release(3), 0);
        assert!(!handles.is_any_open());
    }
}
