//! The units of RoBIOS-7 and SI: whole millimetres and degrees.
//!
//! Numbers are rounded to the nearest, halves away from 0, and saturate at the ends of `int`.

use sim_core::pose::Pose;
use sim_core::unit;

/// Metres, or m/s, from whole millimetres.
pub fn metres(mm: i32) -> f64 {
    unit::metres_from_mm(mm.into())
}

/// Radians, or rad/s, from whole degrees.
pub fn radians(degrees: i32) -> f64 {
    unit::radians_from_degrees(degrees.into())
}

/// Whole millimetres, or mm/s, from metres.
pub fn mm(metres: f64) -> i32 {
    unit::mm_from_metres(metres).round() as i32
}

/// Whole degrees, or degrees/s, from radians.
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

/// What is left of a length in millimetres or an angle in degrees, rounded up, so that it is 0 only when nothing is left.
pub fn left(rest: f64) -> i32 {
    // What is less than a millionth too much has come from rounding.
    if rest > 0.0 { ((rest - 1e-6).ceil() as i32).max(1) } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_whatever_their_size() {
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
    fn something_left_is_never_0() {
        assert_eq!(
            [left(0.0), left(1e-9), left(0.2), left(499.2), left(500.0), left(500.000_000_01)],
            [0, 1, 1, 500, 500, 500]
        );
    }
}
