//! Printing of noise profiles as TOML.

use super::text;
use crate::form::print;
use crate::spec::NoiseSpec;

/// Text of a noise profile.
pub fn print_noise(spec: &NoiseSpec) -> String {
    text::document(&print(spec))
}
