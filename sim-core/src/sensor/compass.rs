use std::f64::consts::TAU;

use crate::pose::Heading;

/// Reading of a compass on the robot: the angle from north, clockwise, in [0, 2 pi), rad.
///
/// `north` is a direction of the world, rad counter-clockwise from x.
pub fn bearing_from_north(heading: Heading, north: f64) -> f64 {
    let bearing = Heading::new(north - heading.remainder()).remainder();
    let bearing = if bearing < 0.0 { bearing + TAU } else { bearing };
    // A heading just left of north rounds to a full turn.
    if bearing >= TAU { 0.0 } else { bearing }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    #[test]
    fn bearings_are_clockwise_from_north() {
        let reading = |heading: f64| bearing_from_north(Heading::new(heading), FRAC_PI_2);
        assert_eq!(reading(FRAC_PI_2), 0.0);
        assert_eq!(reading(0.0), FRAC_PI_2);
        assert_eq!(reading(-FRAC_PI_2), PI);
        assert_eq!(reading(PI), 1.5 * PI);
        assert!(reading(FRAC_PI_2 + 1e-3) > TAU - 2e-3 && reading(FRAC_PI_2 + 1e-3) < TAU);
        assert_eq!(bearing_from_north(Heading::new(1.0 + 1e-17), 1.0), 0.0);
        assert!((bearing_from_north(Heading::new(100.0), -200.0) - (TAU * 48.0 - 300.0)).abs() < 1e-12);
    }
}
