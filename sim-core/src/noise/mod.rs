//! Randomness: keyed streams, so that no reader, robot or device changes what another one draws, distributions, and the errors that a
//! profile describes, as far as they are numbers alone; what they do to drives and to readings of sensors is theirs.

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
