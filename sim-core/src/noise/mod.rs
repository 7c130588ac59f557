//! Randomness: distributions, random streams, and the noise models of a profile. Each stream has its own key, so no
//! robot or device changes the random numbers of another. This module applies the models that need only numbers;
//! `drive` and `device` apply the other models.

mod angle;
mod blur;
mod image;
pub mod keys;
mod motion;
mod normal;
mod parameter;
mod profile;
mod radio;
mod range;
mod stream;

pub use angle::{CompassErrors, CompassNoise};
pub use blur::blur;
pub use image::{ImageErrors, ImageNoise};
pub use motion::{DriveBound, MotionNoise, Resolution, TwistNoise};
pub use normal::normal_quantile;
pub use parameter::{Parameter, ParameterError};
pub use profile::{Accessor, Profile, RangeKind};
pub use radio::RadioNoise;
pub use range::{RangeErrors, RangeNoise, ScanErrors};
pub use stream::{EventStreams, Purpose, Stream, name_key};
