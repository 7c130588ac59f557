//! Conversion of millimetres, degrees and other units of files to SI units and back. All such conversions are in this
//! module.
//!
//! The readers of files, the RoBIOS functions of the host and noise profiles use those units. All other code of the
//! core uses SI units.

mod quantity;

use std::f64::consts::PI;

pub use quantity::{MAX_LENGTH, Quantity};

/// Metres from millimetres.
pub fn metres_from_mm(mm: f64) -> f64 {
    mm / 1000.0
}

/// Millimetres from metres.
pub fn mm_from_metres(metres: f64) -> f64 {
    metres * 1000.0
}

/// Radians from degrees. For multiples of 90 degrees the result is the `f64` nearest to the exact angle.
pub fn radians_from_degrees(degrees: f64) -> f64 {
    degrees / 180.0 * PI
}

/// Degrees from radians.
pub fn degrees_from_radians(radians: f64) -> f64 {
    radians / PI * 180.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_convert_to_the_nearest_double() {
        assert_eq!(radians_from_degrees(90.0), PI / 2.0);
        assert_eq!(radians_from_degrees(-180.0), -PI);
        assert_eq!(degrees_from_radians(PI / 2.0), 90.0);
    }
}
