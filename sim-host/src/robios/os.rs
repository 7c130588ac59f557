//! System functions: name, errors, variables and clock of the machine.
//!
//! Source: RoBIOS 6 library, system functions and timer.

use robios_sys::robios6::ANYKEY;
use robios_sys::{Callback, Out, OutBytes, Robios6Call as Call, Robios7Call, Stop};
use sim_core::time::{TICK, Time};

use super::caller::{Caller, Poll};
use super::flow::Flow;
use super::robot::{Ending, Robot, WaitReason};
use super::{call, display, display7, key, text};
use sim_core::record::Event;

/// Version of RoBIOS that is simulated: the last version with a known manual.
pub const VERSION: &str = "6.5";

/// Clock rate of the processor in Hz. Source: EyeBot, Motorola 68332.
pub const MACHINE_SPEED: i32 = 25_000_000;

const DAY: Time = Time(24 * 3600 * 1_000_000);

/// Number of system variables.
const VARIABLES: usize = 16;

/// State of the system functions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Os {
    variables: [i32; VARIABLES],
    /// Time of day at virtual time 0; less than a day.
    clock_start: Time,
    /// The program may run commands on the host machine.
    pub may_execute: bool,
    /// The program has run a command.
    pub has_executed: bool,
}

impl<F: Flow> Caller<F> {
    /// `OSWait`, `OSSleep`: waits `span` after the call's own cost.
    pub(super) fn wait_span(&self, call: impl Into<call::Call>, span: Time) -> Result<i32, Stop> {
        let mut end = None;
        self.wait(call, |robot, _| {
            let end = *end.get_or_insert(robot.now + span);
            wait_until(robot, end)
        })
    }

    /// `OSError`: shows the error; then the program ends, or waits for a key.
    pub(super) fn show_error(
        &self,
        call: impl Into<call::Call>,
        message: Option<&[u8]>,
        number: i32,
        is_fatal: bool,
    ) -> Result<i32, Stop> {
        let mut is_shown = false;
        let result = self.wait(call, |robot, _| {
            if !std::mem::replace(&mut is_shown, true) {
                error(robot, message, number, is_fatal);
            }
            if is_fatal { Poll::Ready(0) } else { wait_for_acknowledgement(robot) }
        });
        if is_fatal { Err(Stop) } else { result }
    }
}

/// Whole hundredths of a second, in 32 bits that wrap after 248 days.
pub fn hundredths(time: Time) -> i32 {
    (time.0 / TICK.0) as i32
}

/// Span of `n` hundredths of a second; zero if `n` is negative.
pub fn span_of_hundredths(n: i32) -> Time {
    Time(i64::from(n.max(0)) * TICK.0)
}

/// `OSVersion`: returns the length of the text.
pub fn version(text: &mut OutBytes) -> i32 {
    text.set(VERSION.as_bytes());
    VERSION.len() as i32
}

/// `OSMachineName`: returns the length of the text.
pub fn machine_name(robot: &Robot, text: &mut OutBytes) -> i32 {
    text.set(robot.spec.name.as_bytes());
    robot.spec.name.len() as i32
}

/// `OSMachineID`: the lowest byte of the robot's number.
pub fn machine_id(robot: &Robot) -> u8 {
    robot.id.0 as u8
}

/// `OSError`: shows message and number at the cursor of the display. Ends the program if `is_fatal`.
pub fn error(robot: &mut Robot, message: Option<&[u8]>, number: i32, is_fatal: bool) {
    let message = String::from_utf8_lossy(message.unwrap_or_default()).into_owned();
    let screen_text = format!("{message}\nError {number}\n");
    show(robot, screen_text.as_bytes());
    if is_fatal {
        let reason = format!("{}OSError {number}: {}", robot.tasks.prefix(), text(message.as_bytes()));
        robot.ending.get_or_insert(Ending::Failed { reason });
    }
}

/// Writes at the cursor of the robot's display, of either generation.
fn show(robot: &mut Robot, text: &[u8]) {
    if robot.robios.screen.is_some() {
        display7::put(robot, Robios7Call::LCDPrintf, Some(text));
    } else {
        display::write(robot, text);
    }
}

/// Waits for any key, after an `OSError` that does not end the program.
pub fn wait_for_acknowledgement(robot: &mut Robot) -> Poll<i32> {
    key::wait_for(robot, ANYKEY).map(|_| 0)
}

/// `OSPanic`
pub fn panic(robot: &mut Robot, message: Option<&[u8]>) {
    let reason = format!("{}OSPanic: {}", robot.tasks.prefix(), text(message.unwrap_or_default()));
    show(robot, message.unwrap_or_default());
    robot.ending.get_or_insert(Ending::Failed { reason });
}

/// `OSExit`
pub fn exit(robot: &mut Robot, code: i32) {
    robot.ending.get_or_insert(Ending::Exited { code });
}

/// `OSGetVar`
pub fn variable(robot: &mut Robot, number: i32) -> i32 {
    let index = usize::try_from(number).ok();
    match index.and_then(|index| robot.robios.os.variables.get(index)) {
        Some(value) => *value,
        None => robot.fail_call(Call::OSGetVar, 0),
    }
}

/// `OSPutVar`
pub fn set_variable(robot: &mut Robot, number: i32, value: i32) -> i32 {
    let index = usize::try_from(number).ok();
    match index.and_then(|index| robot.robios.os.variables.get_mut(index)) {
        Some(variable) => {
            *variable = value;
            0
        }
        None => robot.fail_call(Call::OSPutVar, -1),
    }
}

/// `OSSetTime`
pub fn set_time(robot: &mut Robot, time: [i32; 3]) -> i32 {
    if set_clock(robot, time) { 0 } else { robot.fail_call(Call::OSSetTime, -1) }
}

/// Sets the robot's clock; returns false and changes nothing if the arguments are not a time of day.
pub fn set_clock(robot: &mut Robot, [hours, minutes, seconds]: [i32; 3]) -> bool {
    let is_time = (0..24).contains(&hours) && (0..60).contains(&minutes) && (0..60).contains(&seconds);
    if is_time {
        let clock = Time((i64::from(hours) * 3600 + i64::from(minutes) * 60 + i64::from(seconds)) * 1_000_000);
        robot.robios.os.clock_start = Time((clock - robot.now).0.rem_euclid(DAY.0));
    }
    is_time
}

/// `OSGetTime`
pub fn time(robot: &Robot, out: [&mut Out<i32>; 4]) -> i32 {
    out.into_iter().zip(clock(robot, TICK)).for_each(|(out, value)| out.set(value));
    0
}

/// `OSShowTime`: hours, minutes and seconds at the cursor of the display.
pub fn show_time(robot: &mut Robot) -> i32 {
    let [hours, minutes, seconds, _] = clock(robot, TICK);
    show(robot, format!("{hours:02}:{minutes:02}:{seconds:02}").as_bytes());
    0
}

/// Hours, minutes, seconds and ticks of the robot's clock.
pub fn clock(robot: &Robot, tick: Time) -> [i32; 4] {
    const SECOND: i64 = 1_000_000;
    let clock = (robot.robios.os.clock_start + robot.now).0.rem_euclid(DAY.0);
    let seconds = clock / SECOND;
    [seconds / 3600, seconds / 60 % 60, seconds % 60, clock % SECOND / tick.0].map(|value| value as i32)
}

/// Waits until `end`, for `OSWait` and `OSSleep`.
pub fn wait_until(robot: &Robot, end: Time) -> Poll<i32> {
    if robot.now >= end { Poll::Ready(0) } else { Poll::Pending { at: end, reason: WaitReason::Time(end) } }
}

/// `OSAttachTimer`: calls back at every `scale`-th tick.
pub fn attach_timer(
    robot: &mut Robot,
    call: impl Into<call::Call>,
    tick: Time,
    scale: i32,
    callback: Option<Callback>,
) -> i32 {
    let handle = callback.map_or(0, |callback| robot.timers.attach(robot.now, tick, scale, callback));
    if handle == 0 {
        return robot.fail_call(call, 0);
    }
    let period_s = Time(i64::from(scale) * tick.0).seconds();
    robot.record(Event::TimerAttached { timer: handle.unsigned_abs(), period_s });
    handle
}

/// `OSDetachTimer`: returns false if there is no timer with this number.
pub fn detach_timer(robot: &mut Robot, handle: i32) -> bool {
    let is_found = robot.timers.detach(handle);
    if is_found {
        robot.record(Event::TimerDetached { timer: handle.unsigned_abs() });
    }
    is_found
}
