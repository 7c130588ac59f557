//! What each RoBIOS call does: one file a family of functions, over models of the devices.
#![forbid(unsafe_code)]

pub mod audio;
pub mod caller;
pub mod compass;
pub mod cost;
pub mod cycle;
pub mod handle;
pub mod hint;
pub mod image;
pub mod key;
pub mod latch;
pub mod lcd;
pub mod psd;
pub mod robot;
pub mod serial;
pub mod support;

/// The devices of one robot, as RoBIOS shows them.
pub struct Devices {
    /// The display.
    pub lcd: lcd::Lcd,
    /// The keys under it.
    pub keys: key::Keys,
}

impl Devices {
    /// The devices of a robot of type `spec`, with the presses of its keys.
    pub fn new(_spec: &sim_core::format::RobiSpec, keys: key::Keys) -> Self {
        Self { lcd: lcd::Lcd::default(), keys }
    }
}
