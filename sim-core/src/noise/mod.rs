//! Randomness: keyed streams, so that no reader, robot or device changes what another one draws, and the error models on top.

mod normal;
mod stream;

pub use normal::normal_quantile;
pub use stream::{Events, Purpose, Stream, name_key};
