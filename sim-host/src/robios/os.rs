//! The machine: its name, errors, variables and clock.
//!
//! Source: RoBIOS 6 library, system functions and timer.

use robios_sys::robios6::ANYKEY;
use robios_sys::{Callback, Out, OutBytes, Robios6Call as Call};
use sim_core::time::{TICK, Time};

use super::caller::Poll;
use super::robot::{Ending, Robot, Waits};
use super::{display, key, text};
use crate::record::Event;

/// Version of RoBIOS that is imitated: the last one for which a manual is known.
pub const VERSION: &str = "6.5";

/// Clock rate of the processor in Hz. Source: EyeBot, Motorola 68332.
pub const MACHINE_SPEED: i32 = 25_000_000;

const DAY: Time = Time(24 * 3600 * 1_000_000);

/// Number of system variables.
const VARIABLES: usize = 16;

/// What the system keeps for a program.
#[derive(Clone, Copy, Debug, Default)]
pub struct Os {
    variables: [i32; VARIABLES],
    /// What the clock shows when virtual time begins; less than a day.
    clock_start: Time,
}

/// Whole hundredths of a second, in the 32 bits of a counter that wraps after 248 days.
pub fn hundredths(time: Time) -> i32 {
    (time.0 / TICK.0) as i32
}

/// The span of `n` hundredths of a second; nothing if negative.
pub fn span_of_hundredths(n: i32) -> Time {
    Time(i64::from(n.max(0)) * TICK.0)
}

/// `OSVersion`; the length of the text.
pub fn version(text: &mut OutBytes) -> i32 {
    text.set(VERSION.as_bytes());
    VERSION.len() as i32
}

/// `OSMachineName`; the length of the text.
pub fn machine_name(robot: &Robot, text: &mut OutBytes) -> i32 {
    text.set(robot.spec.name.as_bytes());
    robot.spec.name.len() as i32
}

/// `OSMachineID`: the robot's number, from robot 256 on its lowest byte.
pub fn machine_id(robot: &Robot) -> u8 {
    robot.id.0 as u8
}

/// `OSError`: shows message and number at the cursor of the display. When the robot is to stop, its program ends.
pub fn error(robot: &mut Robot, message: Option<&[u8]>, number: i32, is_dead: bool) {
    let message = String::from_utf8_lossy(message.unwrap_or_default()).into_owned();
    let shown = format!("{message}\nError {number}\n");
    display::write(robot, shown.as_bytes());
    if is_dead {
        let reason = format!("OSError {number}: {}", text(message.as_bytes()));
        robot.ending.get_or_insert(Ending::Failed { reason });
    }
}

/// The wait of an `OSError` that is not deadly: for any key.
pub fn acknowledge(robot: &mut Robot) -> Poll<i32> {
    match key::wait_for(robot, ANYKEY) {
        Poll::Ready(_) => Poll::Ready(0),
        until => until,
    }
}

/// `OSPanic`
pub fn panic(robot: &mut Robot, message: Option<&[u8]>) {
    let reason = format!("OSPanic: {}", text(message.unwrap_or_default()));
    display::write(robot, message.unwrap_or_default());
    robot.ending.get_or_insert(Ending::Failed { reason });
}

/// `OSExit`
pub fn exit(robot: &mut Robot, code: i32) {
    robot.ending.get_or_insert(Ending::Exited { code });
}

/// `OSGetVar`
pub fn variable(robot: &mut Robot, number: i32) -> i32 {
    let index = usize::try_from(number).ok();
    match index.and_then(|index| robot.devices.os.variables.get(index)) {
        Some(value) => *value,
        None => robot.failed(Call::OSGetVar, 0),
    }
}

/// `OSPutVar`
pub fn set_variable(robot: &mut Robot, number: i32, value: i32) -> i32 {
    let index = usize::try_from(number).ok();
    match index.and_then(|index| robot.devices.os.variables.get_mut(index)) {
        Some(variable) => {
            *variable = value;
            0
        }
        None => robot.failed(Call::OSPutVar, -1),
    }
}

/// `OSSetTime`
pub fn set_time(robot: &mut Robot, [hours, minutes, seconds]: [i32; 3]) -> i32 {
    let is_time = (0..24).contains(&hours) && (0..60).contains(&minutes) && (0..60).contains(&seconds);
    if !is_time {
        return robot.failed(Call::OSSetTime, -1);
    }
    let clock = Time((i64::from(hours) * 3600 + i64::from(minutes) * 60 + i64::from(seconds)) * 1_000_000);
    robot.devices.os.clock_start = Time((clock - robot.now).0.rem_euclid(DAY.0));
    0
}

/// `OSGetTime`
pub fn time(robot: &Robot, out: [&mut Out<i32>; 4]) -> i32 {
    out.into_iter().zip(clock(robot)).for_each(|(out, value)| out.set(value));
    0
}

/// `OSShowTime`: hours, minutes and seconds at the cursor of the display.
pub fn show_time(robot: &mut Robot) -> i32 {
    let [hours, minutes, seconds, _] = clock(robot);
    display::write(robot, format!("{hours:02}:{minutes:02}:{seconds:02}").as_bytes());
    0
}

/// Hours, minutes, seconds and hundredths of a second of the robot's clock.
fn clock(robot: &Robot) -> [i32; 4] {
    let ticks = (robot.devices.os.clock_start + robot.now).0.rem_euclid(DAY.0) / TICK.0;
    [ticks / 360_000, ticks / 6_000 % 60, ticks / 100 % 60, ticks % 100].map(|value| value as i32)
}

/// The wait of `OSWait`: until `end`.
pub fn wait_until(robot: &Robot, end: Time) -> Poll<i32> {
    if robot.now >= end { Poll::Ready(0) } else { Poll::Until { at: end, waits_for: Waits::Time(end) } }
}

/// `OSAttachTimer`
pub fn attach_timer(robot: &mut Robot, scale: i32, callback: Option<Callback>) -> i32 {
    let handle = callback.map_or(0, |callback| robot.timers.attach(robot.now, scale, callback));
    if handle == 0 {
        return robot.failed(Call::OSAttachTimer, 0);
    }
    let period_s = span_of_hundredths(scale).seconds();
    robot.record(Event::TimerAttached { timer: handle.unsigned_abs(), period_s });
    handle
}

/// `OSDetachTimer`
pub fn detach_timer(robot: &mut Robot, handle: i32) -> i32 {
    if !robot.timers.detach(handle) {
        return robot.failed(Call::OSDetachTimer, 0);
    }
    robot.record(Event::TimerDetached { timer: handle.unsigned_abs() });
    1
}
