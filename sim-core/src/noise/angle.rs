//! Errors of a compass.

use super::range::stepped;
use super::{Events, Purpose};
use crate::RobotId;

/// Noise model of a compass. The default has no errors.
///
/// An angle a becomes a + `bias` + B + `sigma` G, rounded to a multiple of `step`. G is standard normal for each
/// reading; B is normal with the standard deviation `bias_sigma`, drawn once for each compass. Source: our choice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AngleNoise {
    /// Standard deviation of each reading, rad.
    pub sigma: f64,
    /// Error of all readings of all compasses, rad.
    pub bias: f64,
    /// Standard deviation of B, the constant error that differs between compasses, rad.
    pub bias_sigma: f64,
    /// Step of the readings, rad; 0 for none.
    pub step: f64,
}

/// The errors of one compass.
#[derive(Clone, Debug)]
pub struct AngleErrors {
    model: AngleNoise,
    readings: Events,
    /// Constant error of this compass, rad.
    offset: f64,
}

impl AngleErrors {
    /// The errors of the compass called `device` on `robot`, in a run with `seed`.
    pub fn new(model: AngleNoise, seed: u64, robot: RobotId, device: &str) -> Self {
        let deviate = Events::new(seed, robot, Purpose::Make, device).at(0).normal();
        let offset = model.bias + model.bias_sigma * deviate;
        Self { model, readings: Events::new(seed, robot, Purpose::Compass, device), offset }
    }

    /// Reading of the compass in radians for the true angle `exact`, not wrapped; a function of `exact` and of the
    /// [index](Events::index) of the reading.
    pub fn reading(&self, index: u64, exact: f64) -> f64 {
        if self.model == AngleNoise::default() {
            return exact;
        }
        stepped(exact + self.offset + self.model.sigma * self.readings.at(index).normal(), self.model.step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_compass_has_a_bias_a_spread_and_steps() {
        let read = |model, index| AngleErrors::new(model, 7, RobotId(1), "COMPASS").reading(index, 1.0);
        assert_eq!(read(AngleNoise::default(), 5), 1.0);
        assert_eq!(read(AngleNoise { step: 0.3, ..AngleNoise::default() }, 5), 3.0 * 0.3);
        assert_eq!(read(AngleNoise { bias: 0.25, ..AngleNoise::default() }, 5), 1.25);
        let made = AngleNoise { bias_sigma: 0.1, ..AngleNoise::default() };
        assert_eq!(read(made, 5), read(made, 6));
        assert_ne!(read(made, 5), 1.0);
        let spread = AngleNoise { sigma: 0.1, ..AngleNoise::default() };
        assert_ne!(read(spread, 5), read(spread, 6));
    }
}
