//! Conversion between SI and the units of RoBIOS-7: whole millimetres and degrees.
//!
//! Results are rounded to the nearest integer, halves away from 0, and saturate at the limits of `int`.

use sim_core::pose::Pose;
use sim_core::unit;

/// Converts whole millimetres (or mm/s) to metres (or m/s).
pub fn metres(mm: i32) -> f64 {
    unit::metres_from_mm(mm.into())
}

/// Converts whole degrees (or degrees/s) to radians (or rad/s).
pub fn radians(degrees: i32) -> f64 {
    unit::radians_from_degrees(degrees.into())
}

/// Converts metres (or m/s) to whole millimetres (or mm/s).
pub fn mm(metres: f64) -> i32 {
    unit::mm_from_metres(metres).round() as i32
}

/// Converts radians (or rad/s) to whole degrees (or degrees/s).
pub fn degrees(radians: f64) -> i32 {
    unit::degrees_from_radians(radians).round() as i32
}

/// A pose from millimetres and degrees.
pub fn pose([x_mm, y_mm, phi_degrees]: [i32; 3]) -> Pose {
    Pose::new(metres(x_mm), metres(y_mm), radians(phi_degrees))
}

/// A pose in millimetres and degrees, the heading from -179 to 180.
pub fn pose_numbers(pose: &Pose) -> [i32; 3] {
    let phi = degrees(pose.heading.remainder());
    [mm(pose.position.x), mm(pose.position.y), if phi == -180 { 180 } else { phi }]
}

/// Rounds a remaining length in millimetres or angle in degrees up, so that the result is 0 only if nothing remains.
pub fn remaining(rest: f64) -> i32 {
    // An excess below a millionth is a rounding error.
    if rest > 0.0 { ((rest - 1e-6).ceil() as i32).max(1) } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversions_to_si_and_back_keep_all_integers() {
        for number in [0, 1, -1, 7, -333, 32_768, -40_000, 1_234_567, i32::MAX, i32::MIN] {
            assert_eq!(mm(metres(number)), number);
            assert_eq!(degrees(radians(number)), number);
        }
        assert_eq!(
            [mm(0.0005), mm(-0.0005), mm(0.000_499), mm(1e12), mm(f64::NEG_INFINITY)],
            [1, -1, 0, i32::MAX, i32::MIN]
        );
    }

    #[test]
    fn headings_are_from_minus_179_to_180() {
        let heading = |degrees| pose_numbers(&pose([1, -2, degrees]));
        assert_eq!(heading(180), [1, -2, 180]);
        assert_eq!(heading(-180), [1, -2, 180]);
        assert_eq!(heading(-179), [1, -2, -179]);
        assert_eq!(heading(350), [1, -2, -10]);
        assert_eq!(heading(3_600_000), [1, -2, 0]);
    }

    #[test]
    fn a_remainder_above_0_is_never_rounded_to_0() {
        assert_eq!(
            [
                remaining(0.0),
                remaining(1e-9),
                remaining(0.2),
                remaining(499.2),
                remaining(500.0),
                remaining(500.000_000_01)
            ],
            [0, 1, 1, 500, 500, 500]
        );
    }
}
