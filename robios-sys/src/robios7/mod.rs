//! RoBIOS-7 of EyeBot 7 and EyeSim VR: types, constants, functions.
//!
//! Units are millimetres, degrees and milliseconds; devices are numbered from 1, nothing has a handle.

mod constant;
mod function;

pub use constant::*;
pub use function::{Robios7, Robios7Call, Robios7Table};

/// `COLOR`: `0xRRGGBB`.
pub type Color = i32;
/// `TIMER`: a timer of `OSAttachTimer`; 0 is none.
pub type Timer = i32;
/// `char` used as a character: its bits, independent of the signedness of C's `char`.
pub type Char = u8;
/// C's `bool`: 0 is false, 1 true.
pub type Flag = u8;

/// The `types.h` value for each resolution: name, number, columns, rows.
pub const RESOLUTIONS: &[(&str, i32, usize, usize)] = &[
    ("QQVGA", QQVGA, 160, 120),
    ("QVGA", QVGA, 320, 240),
    ("VGA", VGA, 640, 480),
    ("CAM1MP", CAM1MP, 1296, 730),
    ("CAMHD", CAMHD, 1920, 1080),
    ("CAM5MP", CAM5MP, 2592, 1944),
];

/// Maximum number of points of a LIDAR scan.
pub const MAX_LIDAR_POINTS: usize = 65_536;
/// Maximum number of bytes written by `OSVersion` and the like, including the final 0.
pub const MAX_NAME: usize = 32;
/// Maximum number of bytes written by `OSExecute`, including the final 0.
pub const MAX_OUTPUT: usize = 4_096;
/// Maximum number of bytes written by `SERReceive`, including the final 0.
pub const MAX_SERIAL: usize = 256;
/// Maximum number of ids written by `RADIOStatus`.
pub const MAX_RADIO_IDS: usize = 256;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique() {
        let mut names: Vec<_> = Robios7Call::ALL.iter().map(|call| call.name()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), Robios7Call::ALL.len());
        assert!(Robios7Call::ALL.iter().enumerate().all(|(index, call)| call.index() == index));
    }
}
