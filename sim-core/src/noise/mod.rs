//! Randomness: keyed streams, so that no reader, robot or device changes what another one draws.
//!
//! Every random number of a run comes from a [`Stream`] with a key of its own: the run's seed, the robot, the purpose and a
//! number within the purpose. Error models come later and stand on this.

mod stream;

pub use stream::{Purpose, Stream};
