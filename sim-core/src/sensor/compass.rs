use std::f64::consts::{FRAC_PI_2, TAU};

use crate::pose::Heading;

/// What a compass on the robot shows: the angle from north, clockwise, in [0, 2 pi), rad.
///
/// North is the world's y axis, up on the map: our choice, as the sources name none.
pub fn bearing_from_north(heading: Heading) -> f64 {
    let clockwise = FRAC_PI_2 - heading.remainder();
    let bearing = if clockwise < 0.0 { clockwise + TAU } else { clockwise };
    // A heading just left of north rounds to the full turn.
    if bearing >= TAU { 0.0 } else { bearing }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn the_four_winds() {
        let shown = |heading: f64| bearing_from_north(Heading::new(heading));
        assert_eq!(shown(FRAC_PI_2), 0.0);
        assert_eq!(shown(0.0), FRAC_PI_2);
        assert_eq!(shown(-FRAC_PI_2), PI);
        assert_eq!(shown(PI), 1.5 * PI);
        assert_eq!(shown(FRAC_PI_2 + 1e-17), 0.0);
        assert!(shown(FRAC_PI_2 + 1e-3) > TAU - 2e-3);
    }
}
