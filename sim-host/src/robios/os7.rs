//! System functions of RoBIOS-7; the functions of both generations are in [`os`].
//!
//! Source: RoBIOS-7 library, system functions and timer; versions and clock rate are EyeSim VR's.

use std::ffi::OsStr;
use std::io;
use std::os::unix::ffi::OsStrExt;
use std::process::Command;
use std::time::Duration;

use robios_sys::robios7::{MAX_NAME, MAX_OUTPUT};
use robios_sys::{Callback, Out, OutBytes, Robios7Call as Call};
use sim_core::time::Time;

use super::os;
use super::robot::Robot;
use super::timer::MILLISECOND;
use crate::program::command::output_apart;

/// Version of RoBIOS, and of the input and output board.
const VERSION: &str = "1.0";

/// Clock rate of the processor in Hz.
pub const MACHINE_SPEED: i32 = 700_000_000;

/// Wall-clock time that a command of `OSExecute` may take; our choice.
const EXECUTE_TIMEOUT: Duration = Duration::from_secs(10);

/// Whole milliseconds, in 32 bits that wrap after 24 days.
pub fn milliseconds(time: Time) -> i32 {
    (time.0 / MILLISECOND.0) as i32
}

/// Span of `n` milliseconds; zero if `n` is negative.
pub fn span_of_milliseconds(n: i32) -> Time {
    Time::from_millis(n.max(0).into())
}

/// `OSVersion`, `OSVersionIO`
pub fn version(robot: &mut Robot, call: Call, text: &mut OutBytes) -> i32 {
    put_text(robot, call, text, VERSION)
}

/// `OSMachineName`: the robi's name.
pub fn machine_name(robot: &mut Robot, text: &mut OutBytes) -> i32 {
    let spec = robot.spec.clone();
    put_text(robot, Call::OSMachineName, text, &spec.name)
}

/// Stores a text with a final 0, truncated to the buffer's capacity.
fn put_text(robot: &mut Robot, call: Call, out: &mut OutBytes, text: &str) -> i32 {
    let room = out.capacity().min(MAX_NAME);
    if out.is_null() || room == 0 {
        return robot.fail_call(call, 1);
    }
    out.set(&terminated(text.as_bytes(), room));
    0
}

/// The part of a text that fits into `room` bytes with a final 0, followed by the 0.
pub fn terminated(text: &[u8], room: usize) -> Vec<u8> {
    let mut bytes = text[..text.len().min(room.saturating_sub(1))].to_vec();
    bytes.push(0);
    bytes
}

/// `OSMachineID`
pub fn machine_id(robot: &Robot) -> i32 {
    i32::try_from(robot.id.0).unwrap_or(i32::MAX)
}

/// `OSAttachTimer`
pub fn attach_timer(robot: &mut Robot, scale: i32, callback: Option<Callback>) -> i32 {
    os::attach_timer(robot, Call::OSAttachTimer, MILLISECOND, scale, callback)
}

/// `OSDetachTimer`
pub fn detach_timer(robot: &mut Robot, timer: i32) -> i32 {
    if os::detach_timer(robot, timer) { 0 } else { robot.fail_call(Call::OSDetachTimer, 1) }
}

/// `OSSetTime`
pub fn set_time(robot: &mut Robot, time: [i32; 3]) -> i32 {
    if os::set_clock(robot, time) { 0 } else { robot.fail_call(Call::OSSetTime, 1) }
}

/// `OSGetTime`
pub fn time(robot: &Robot, out: [&mut Out<i32>; 4]) -> i32 {
    out.into_iter().zip(os::clock(robot, MILLISECOND)).for_each(|(out, value)| out.set(value));
    0
}

/// `OSExecute`: runs a command if the user has allowed it, and waits for its end for at most [`EXECUTE_TIMEOUT`] of
/// wall-clock time.
pub fn execute(robot: &mut Robot, command: Option<&[u8]>, out: &mut OutBytes) -> i32 {
    let Some(command) = command else { return robot.fail_call(Call::OSExecute, 1) };
    if !robot.robios.os.may_execute {
        return robot.refuse_call(Call::OSExecute, 1, |_| {
            format!("`{}` is not run: `--allow-execute` on the command line allows it", super::text(command))
        });
    }
    if !std::mem::replace(&mut robot.robios.os.has_executed, true) {
        robot.hint("`OSExecute` runs commands, which are outside of the simulation: a run with them need not repeat");
    }
    let mut shell = Command::new("sh");
    shell.arg("-c").arg(OsStr::from_bytes(command));
    match output_apart(shell, EXECUTE_TIMEOUT) {
        Ok(output) => {
            let room = out.capacity().min(MAX_OUTPUT);
            if room > 0 {
                out.set(&terminated(&output.stdout, room));
            }
            if output.status.success() { 0 } else { robot.fail_call(Call::OSExecute, 1) }
        }
        Err(error) if matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::Interrupted) => {
            robot.refuse_call(Call::OSExecute, 1, |_| format!("`{}`: {error}", super::text(command)))
        }
        Err(error) => robot.refuse_call(Call::OSExecute, 1, |_| format!("there is no shell: {error}")),
    }
}
