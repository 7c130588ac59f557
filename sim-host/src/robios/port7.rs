//! Digital lines and analog channels of RoBIOS-7: inputs read the values of the robi's companion, outputs hold the
//! value written.
//!
//! Source: RoBIOS-7 library, digital and analog I/O; our choices: the initial direction of the lines, and recordings of
//! the upper 8 bits of each value.

use robios_sys::robios7::Char;
use robios_sys::{OutBytes, Robios7Call as Call};
use sim_core::spec::InputSpec;
use sim_core::time::Time;

use super::robot::Robot;
use super::timer::MILLISECOND;
use sim_core::record::Event;

/// Number of digital lines, numbered from 1.
const LINES: usize = 16;

/// Number of analog channels, numbered from 0; the last is the microphone.
const CHANNELS: i32 = 9;

/// The channel of the microphone. Source: RoBIOS-7 library.
const MICROPHONE: i32 = 8;

/// Maximum number of values of a recording, as in `eyebot.h`.
const MAX_RECORDING: i32 = 1 << 20;

/// Names of the digital lines in records.
const NAMES: [&str; LINES] = [
    "DIGITAL1",
    "DIGITAL2",
    "DIGITAL3",
    "DIGITAL4",
    "DIGITAL5",
    "DIGITAL6",
    "DIGITAL7",
    "DIGITAL8",
    "DIGITAL9",
    "DIGITAL10",
    "DIGITAL11",
    "DIGITAL12",
    "DIGITAL13",
    "DIGITAL14",
    "DIGITAL15",
    "DIGITAL16",
];

/// Direction of a digital line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Direction {
    /// Input that reads 0 if nothing is connected.
    #[default]
    In,
    /// Input that reads 1 if nothing is connected.
    PullUp,
    /// Output with its state.
    Out(bool),
}

/// Digital lines of a robot and its recording of an analog channel.
#[derive(Clone, Debug, Default)]
pub struct Ports {
    lines: [Direction; LINES],
    recording: Option<Recording>,
}

/// A recording of an analog channel.
#[derive(Clone, Copy, Debug)]
struct Recording {
    end: Time,
    value: u8,
    count: usize,
}

impl Ports {
    /// The state of the line at `index`, from 0.
    fn state(&self, inputs: &InputSpec, index: usize) -> bool {
        let level =
            inputs.digital.iter().find(|(line, _)| usize::from(*line) == index + 1).map(|(_, value)| *value != 0);
        match self.lines[index] {
            Direction::In => level.unwrap_or(false),
            Direction::PullUp => level.unwrap_or(true),
            Direction::Out(state) => state,
        }
    }
}

/// Index of the line with this number; `None` if there is none.
fn index_of(line: i32) -> Option<usize> {
    usize::try_from(line).ok()?.checked_sub(1).filter(|index| *index < LINES)
}

/// `DIGITALSetup`
pub fn set_up(robot: &mut Robot, line: i32, direction: Char) -> i32 {
    let direction = match direction {
        b'i' | b'J' => Some(Direction::In),
        b'I' => Some(Direction::PullUp),
        b'o' => Some(Direction::Out(false)),
        _ => None,
    };
    let (Some(index), Some(direction)) = (index_of(line), direction) else {
        let reason = |_: &Robot| format!("expected a line from 1 to {LINES}, and 'i', 'o', 'I' or 'J'");
        return robot.refuse_call(Call::DIGITALSetup, 1, reason);
    };
    robot.robios.ports.lines[index] = direction;
    0
}

/// `DIGITALRead`
pub fn read(robot: &mut Robot, line: i32) -> i32 {
    let Some(index) = index_of(line) else { return robot.fail_call(Call::DIGITALRead, -1) };
    let state = robot.robios.ports.state(&robot.spec.inputs, index);
    robot.record(Event::Reading { device: NAMES[index], value: state.into() });
    state.into()
}

/// `DIGITALReadAll`
pub fn read_all(robot: &mut Robot) -> i32 {
    let state = |index: usize| i32::from(robot.robios.ports.state(&robot.spec.inputs, index)) << index;
    let states = (0..LINES).map(state).sum();
    robot.record(Event::Reading { device: "DIGITAL", value: i64::from(states) });
    states
}

/// `DIGITALWrite`
pub fn write(robot: &mut Robot, line: i32, state: i32) -> i32 {
    let output_index =
        |robot: &Robot| index_of(line).filter(|index| matches!(robot.robios.ports.lines[*index], Direction::Out(_)));
    let (Some(index), 0 | 1) = (output_index(robot), state) else {
        return robot.refuse_call(Call::DIGITALWrite, 1, |_| {
            format!("expected 0 or 1, and a line that `DIGITALSetup({line}, 'o')` has made an output")
        });
    };
    robot.robios.ports.lines[index] = Direction::Out(state == 1);
    robot.record(Event::Output { device: NAMES[index], value: state.into() });
    0
}

/// Value of an analog channel, 0 to 1023; `None` if there is no such channel.
fn analog(inputs: &InputSpec, channel: i32) -> Option<u16> {
    let level = inputs.analog.iter().find(|(number, _)| i32::from(*number) == channel).map(|(_, value)| *value);
    let default = if channel == MICROPHONE { 4 * u16::from(inputs.microphone) } else { 0 };
    (0..CHANNELS).contains(&channel).then(|| level.unwrap_or(default))
}

/// `ANALOGRead`
pub fn read_analog(robot: &mut Robot, channel: i32) -> i32 {
    let Some(value) = analog(&robot.spec.inputs, channel) else { return robot.fail_call(Call::ANALOGRead, -1) };
    robot.record(Event::Reading { device: "A/D", value: value.into() });
    value.into()
}

/// `ANALOGVoltage`
pub fn read_voltage(robot: &mut Robot) -> i32 {
    let hundredths = (100.0 * robot.spec.inputs.voltage).round() as i32;
    robot.record(Event::Reading { device: "battery", value: hundredths.into() });
    hundredths
}

/// `ANALOGRecord`
pub fn record(robot: &mut Robot, channel: i32, count: i32) -> i32 {
    let is_busy = robot.robios.ports.recording.is_some_and(|recording| recording.end > robot.now);
    let value = analog(&robot.spec.inputs, channel).filter(|_| !is_busy && (1..=MAX_RECORDING).contains(&count));
    let Some(value) = value else { return robot.fail_call(Call::ANALOGRecord, 1) };
    let end = robot.now + Time(i64::from(count) * MILLISECOND.0);
    robot.robios.ports.recording = Some(Recording { end, value: (value >> 2) as u8, count: count as usize });
    0
}

/// `ANALOGTransfer`
pub fn transfer(robot: &mut Robot, buffer: &mut OutBytes) -> i32 {
    let now = robot.now;
    match robot.robios.ports.recording.take_if(|recording| recording.end <= now && !buffer.is_null()) {
        Some(Recording { value, count, .. }) => buffer.set(&vec![value; count]) as i32,
        None => 0,
    }
}
