//! Errors of what range sensors read.

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
    /// As [`RangeErrors::reading`] for a sensor of which more is known than a distance: `exact` is what its `model` reads there.
    ///
    /// A reading without a signal is one of nothing, and the other way round; an outlier where nothing is has the signal 1.
    pub fn reading_of(&self, index: u64, at: Time, model: &RangeModel, exact: Reading) -> Reading {
        if self.is_exact() {
            return exact;
        }
        let seen = exact.distance.filter(|_| exact.signal > 0.0);
        match self.reading(index, at, model.limits(), seen) {
            None => model.nothing(),
            distance => Reading { distance, signal: if seen.is_some() { exact.signal } else { 1.0 } },
        }
    }
}
