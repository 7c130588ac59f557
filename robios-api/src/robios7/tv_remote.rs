//! The receiver of a TV remote control.

use super::Robot;
use crate::robot::robios7;
use crate::tv_remote::TvCode;

/// The receiver of a TV remote control.
#[derive(Clone, Copy, Debug)]
pub struct TvRemote<'r>(pub(super) &'r Robot);

impl TvRemote<'_> {
    /// Returns true if the robot has a receiver.
    #[track_caller]
    pub fn is_there(&self) -> bool {
        let status: i32 = robios7!(self.0, IRTVGetStatus());
        status == 1
    }

    /// The next code that has been received, without waiting.
    #[track_caller]
    pub fn read(&self) -> Option<TvCode> {
        let code: i32 = robios7!(self.0, IRTVRead());
        (code != 0).then_some(TvCode(code))
    }

    /// Waits for the next code; `None` immediately if the receiver is off.
    #[track_caller]
    pub fn wait(&self) -> Option<TvCode> {
        let code: i32 = robios7!(self.0, IRTVGet());
        (code != 0).then_some(TvCode(code))
    }

    /// Discards received codes.
    #[track_caller]
    pub fn drop_received(&self) {
        let _: i32 = robios7!(self.0, IRTVFlush());
    }
}
