//! Randomness: distributions, random streams keyed so that no reader, robot or device changes the numbers of another, and the noise
//! models of a profile. Models that act on numbers alone are applied here; `drive` and `device` apply the others.

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

pub use angle::{Angle, AngleErrors};
pub use blur::blur;
pub use image::{Image, ImageErrors};
pub use motion::{Motion, Resolution, TwistNoise};
pub use normal::normal_quantile;
pub use parameter::{Parameter, ParameterError};
pub use profile::{Place, Profile, RangeKind};
pub use radio::Radio;
pub use range::{Range, RangeErrors, ScanErrors};
pub use stream::{Events, Purpose, Stream, name_key};
