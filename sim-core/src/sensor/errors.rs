//! Noise models applied to readings of range sensors.

use super::{RangeModel, Reading};
use crate::{
    noise::{RangeErrors, RangeKind},
    time::Time,
};

impl From<&RangeModel> for RangeKind {
    fn from(model: &RangeModel) -> Self {
        match model {
            RangeModel::Psd { .. } => Self::Psd,
            RangeModel::Laser(_) => Self::Laser,
            RangeModel::Ultrasonic(_) => Self::Ultrasonic,
            RangeModel::Reflectance(_) => Self::Reflectance,
            RangeModel::Sonar(_) => Self::Sonar,
        }
    }
}

impl RangeErrors {
    /// Applies [`RangeErrors::reading`] to `exact`, the reading of a sensor of type `model` before these errors.
    /// `exact` may contain the noise N of France et al.
    ///
    /// An exact reading without signal is treated as no return; no return gives a reading without signal. An outlier
    /// without a return has signal 1.
    pub fn reading_of(&self, index: u64, at: Time, model: &RangeModel, exact: Reading) -> Reading {
        if self.has_exact_readings() {
            return exact;
        }
        let echo = exact.distance.filter(|_| exact.signal > 0.0);
        match self.reading(index, at, model.limits(), echo) {
            None => model.no_return(),
            distance => Reading { distance, signal: if echo.is_some() { exact.signal } else { 1.0 } },
        }
    }
}
