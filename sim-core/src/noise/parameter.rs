//! Access to the parameters of a profile by table and key.

use super::keys::{CAMERA, COMPASS, DEVICE_NOISE, DRIVE, Key, Keys, ODOMETRY, RADIO, RANGE};
use super::{Profile, RangeKind};
use crate::nearest::nearest;
use crate::unit::Quantity;

/// A parameter of a noise profile.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its table, such as `psd`.
    pub table: &'static str,
    /// Its key, such as `sigma_mm`.
    pub key: &'static str,
    /// Description in a few words.
    pub description: &'static str,
    /// Its value, in its unit.
    pub value: f64,
    /// Minimum and maximum value, in its unit.
    pub range: [f64; 2],
    /// Unit such as `mm`; empty for a pure number.
    pub unit: &'static str,
}

impl Parameter {
    /// Table and key: `psd.sigma_mm`.
    pub fn name(&self) -> String {
        format!("{}.{}", self.table, self.key)
    }
}

/// Reason why a parameter of a profile cannot be set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// No parameter has this name.
    #[error("a noise profile has no number `{name}`{}", nearest.as_ref().map(|it| format!(": `{it}`?")).unwrap_or_default())]
    Unknown {
        /// The name.
        name: String,
        /// Most similar known name.
        nearest: Option<String>,
    },
    /// The value is out of range.
    #[error("`{name}` cannot be {value}: expected {expected}")]
    Range {
        /// The name.
        name: String,
        /// The value.
        value: f64,
        /// Allowed values.
        expected: String,
    },
}

impl Profile {
    /// All parameters except those set for individual sensors, in the order of `docs/noise.md`.
    pub fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = Vec::new();
        visit_parameters(&mut self.clone(), &mut |table, key, quantity, value| {
            let unit = quantity.unit();
            parameters.push(Parameter {
                table,
                key,
                description: quantity.name,
                value: quantity.in_own_unit(*value),
                range: quantity.bounds(),
                unit,
            });
        });
        parameters
    }

    /// Sets the parameter `name`, such as `psd.sigma_mm`, to `value` in its unit.
    ///
    /// # Errors
    /// [`ParameterError`]; the profile is then unchanged.
    pub fn set_parameter(&mut self, name: &str, value: f64) -> Result<(), ParameterError> {
        let mut outcome = None;
        visit_parameters(self, &mut |table, key, quantity, stored| {
            if name.strip_prefix(table).and_then(|rest| rest.strip_prefix('.')) != Some(key) {
                return;
            }
            outcome = Some(match quantity.check(value) {
                Some(si) => {
                    *stored = si;
                    Ok(())
                }
                None => Err(ParameterError::Range { name: name.to_owned(), value, expected: quantity.expected() }),
            });
        });
        outcome.unwrap_or_else(|| {
            let names: Vec<String> = self.parameters().iter().map(Parameter::name).collect();
            let nearest = nearest(name, names.iter().map(String::as_str)).map(str::to_owned);
            Err(ParameterError::Unknown { name: name.to_owned(), nearest })
        })
    }
}

/// Calls `visit` for each parameter of a profile with its table, key, quantity and value.
fn visit_parameters(profile: &mut Profile, visit: &mut impl FnMut(&'static str, &'static str, &Quantity, &mut f64)) {
    for kind in RangeKind::ALL {
        let device_noise: Keys<_> = if kind.has_device_noise() { DEVICE_NOISE } else { &[] };
        visit_keys(kind.name(), &[RANGE, device_noise], &mut profile.ranges[kind as usize], visit);
    }
    visit_keys("compass", &[COMPASS], &mut profile.compass, visit);
    visit_keys("camera", &[CAMERA], &mut profile.camera, visit);
    visit_keys("drive", &[DRIVE], &mut profile.motion, visit);
    visit_keys("odometry", &[ODOMETRY], &mut profile.motion, visit);
    visit_keys("radio", &[RADIO], &mut profile.radio, visit);
}

/// Calls `visit` for the parameter of each key.
fn visit_keys<M>(
    table: &'static str,
    keys: &[Keys<M>],
    model: &mut M,
    visit: &mut impl FnMut(&'static str, &'static str, &Quantity, &mut f64),
) {
    for Key { name, quantity, accessor, .. } in keys.iter().copied().flatten() {
        visit(table, name, quantity, accessor(model));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_have_unique_names_and_are_documented() {
        let page = include_str!("../../../docs/noise.md");
        let mut names: Vec<String> = Vec::new();
        for parameter in Profile::default().parameters() {
            assert!(page.contains(&format!("`{}`", parameter.key)), "{parameter:?}");
            names.push(parameter.name());
        }
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }

    #[test]
    fn invalid_values_are_rejected_and_change_nothing() {
        let mut profile = Profile::default();
        let before = profile.parameters();
        for (name, value) in [("radio.packet_loss", 1.1), ("psd.sigma_mm", f64::NAN), ("psd.sigma_mm", -1.0)] {
            assert!(matches!(profile.set_parameter(name, value), Err(ParameterError::Range { .. })), "{name} {value}");
        }
        let error = |name: &str| Profile::default().set_parameter(name, 0.0).expect_err("no number").to_string();
        assert_eq!(error("psd.sigma_m"), "a noise profile has no number `psd.sigma_m`: `psd.sigma_mm`?");
        for name in ["", "psd", "psd.", "psd.device", "sigma_mm", "sensor.PSD_FRONT.sigma_mm"] {
            assert!(error(name).starts_with("a noise profile has no number"), "{name}");
        }
        assert_eq!(profile.parameters(), before);
        let error = profile.set_parameter("psd.sigma_mm", 2e6).expect_err("too much").to_string();
        assert_eq!(error, "`psd.sigma_mm` cannot be 2000000: expected a number in mm from 0 to 1000000");
    }
}
