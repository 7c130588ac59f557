//! The robot's console. It replaces `println!`, which would write to the host's own output.

use std::fmt::Arguments;

use robios_sys::ByteSlice;
use robios_sys::support::stream;

use crate::Robot;
use crate::robot::support;

/// The robot's console, written to with `writeln!`; writing returns no result.
///
/// ```
/// # use robios_api::prelude::*;
/// fn hello(robot: &Robot) {
///     writeln!(robot.console(), "robot {} here", robot.id());
/// }
/// # assert_eq!(robios_api::fake::Fake::new().run(hello).console(), "robot 1 here\n");
/// ```
#[derive(Debug)]
pub struct Console<'r> {
    robot: &'r Robot,
    stream: i32,
}

impl<'r> Console<'r> {
    pub(crate) fn output(robot: &'r Robot) -> Self {
        Self { robot, stream: stream::OUT }
    }

    pub(crate) fn error(robot: &'r Robot) -> Self {
        Self { robot, stream: stream::ERR }
    }

    /// Writes formatted text; called by `write!` and `writeln!`.
    #[track_caller]
    pub fn write_fmt(&self, text: Arguments<'_>) {
        let text = text.to_string();
        let _: i32 = support!(self.robot, console(self.stream, ByteSlice::from(text.as_str())));
    }
}
