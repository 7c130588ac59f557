//! What each RoBIOS call does: one file a family of functions, over models of the devices.
#![forbid(unsafe_code)]

pub mod audio;
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
pub mod serial;
