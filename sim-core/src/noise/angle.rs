//! Errors of a compass.

use super::range::quantised;
use super::{EventStreams, Purpose};
use crate::RobotId;

/// Noise model of a compass. The default has no errors.
///
/// An angle a becomes a + `bias` + B + `sigma` G, rounded to a multiple of `step`. G is standard normal for each
/// reading; B is normal with the standard deviation `bias_sigma`, drawn once for each compass. Our choice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CompassNoise {
    /// Standard deviation of each reading, rad.
    pub sigma: f64,
    /// Error of all readings of all compasses, rad.
    pub bias: f64,
    /// Standard deviation of B, the constant error that differs between compasses, rad.
    pub bias_sigma: f64,
    /// Step to which readings are rounded, rad; 0: not rounded.
    pub step: f64,
}

/// The errors of one compass.
#[derive(Clone, Debug)]
pub struct CompassErrors {
    model: CompassNoise,
    reading_streams: EventStreams,
    /// Constant error of this compass, rad.
    offset: f64,
}

impl CompassErrors {
    /// The errors of the compass called `device` on `robot`, in a run with `seed`.
    pub fn new(model: CompassNoise, seed: u64, robot: RobotId, device: &str) -> Self {
        let deviate = EventStreams::new(seed, robot, Purpose::DeviceConstant, device).at(0).normal();
        let offset = model.bias + model.bias_sigma * deviate;
        Self { model, reading_streams: EventStreams::new(seed, robot, Purpose::Compass, device), offset }
    }

    /// Reading of the compass in radians for the true angle `exact`, not wrapped. It depends only on `exact` and on the
    /// [index](EventStreams::index) of the reading.
    pub fn reading(&self, index: u64, exact: f64) -> f64 {
        if self.model == CompassNoise::default() {
            return exact;
        }
        quantised(exact + self.offset + self.model.sigma * self.reading_streams.at(index).normal(), self.model.step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compass_readings_have_bias_random_error_and_steps() {
        let read = |model, index| CompassErrors::new(model, 7, RobotId(1), "COMPASS").reading(index, 1.0);
        assert_eq!(read(CompassNoise::default(), 5), 1.0);
        assert_eq!(read(CompassNoise { step: 0.3, ..CompassNoise::default() }, 5), 3.0 * 0.3);
        assert_eq!(read(CompassNoise { bias: 0.25, ..CompassNoise::default() }, 5), 1.25);
        let biased = CompassNoise { bias_sigma: 0.1, ..CompassNoise::default() };
        assert_eq!(read(biased, 5), read(biased, 6));
        assert_ne!(read(biased, 5), 1.0);
        let noisy = CompassNoise { sigma: 0.1, ..CompassNoise::default() };
        assert_ne!(read(noisy, 5), read(noisy, 6));
    }
}
