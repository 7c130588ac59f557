//! Randomness: distributions, random streams keyed so that no reader, robot or device changes the numbers of another, and the noise models
//! of a profile. This room applies the models that need only numbers; `drive` and `device` apply the rest.

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

pub use angle::{AngleErrors, AngleNoise};
pub use blur::blur;
pub use image::{ImageErrors, ImageNoise};
pub use motion::{DriveBound, MotionNoise, Resolution, TwistNoise};
pub use normal::normal_quantile;
pub use parameter::{Parameter, ParameterError};
pub use profile::{Accessor, Profile, RangeKind};
pub use radio::RadioNoise;
pub use range::{RangeErrors, RangeNoise, ScanErrors};
pub use stream::{Events, Purpose, Stream, name_key};
