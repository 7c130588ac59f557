//! Latches, A/D converter and parallel port: inputs read the values of the robi's companion, outputs hold the value
//! written.
//!
//! Source: RoBIOS 6 library, latches and A/D converter; the numbers of latches and channels are the EyeBot's.

use robios_sys::Robios6Call as Call;
use sim_core::spec::InputSpec;

use super::robot::Robot;
use sim_core::record::Event;

/// Number of input latches, and of output latches, numbered from 0; our choice.
pub const LATCHES: usize = 4;

/// Number of A/D channels. Source: RoBIOS 6 library.
pub const CHANNELS: i32 = 16;

/// State of the outputs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Latches {
    outputs: [u8; LATCHES],
    /// Control register of the parallel port.
    pub parallel_control: u8,
    /// Data last written to the parallel port; `None` before the first write.
    pub parallel_data: Option<u8>,
}

impl Latches {
    /// Value of output latch `number`; 0 if there is no such latch.
    pub fn output(&self, number: i32) -> u8 {
        usize::try_from(number).ok().and_then(|number| self.outputs.get(number)).copied().unwrap_or(0)
    }

    /// Writes output latch `number`: keeps the bits of `mask` and ORs in `value`. Returns the old and the new value;
    /// `None` if there is no such latch.
    pub fn write(&mut self, number: i32, mask: u8, value: u8) -> Option<(u8, u8)> {
        let latch = self.outputs.get_mut(usize::try_from(number).ok()?)?;
        let old = *latch;
        *latch = old & mask | value;
        Some((old, *latch))
    }
}

/// Value of input latch `number`; 0 if the companion does not set it.
pub fn input(inputs: &InputSpec, number: i32) -> u8 {
    inputs.latches.iter().find(|(latch, _)| i32::from(*latch) == number).map_or(0, |(_, value)| *value)
}

/// Value of A/D channel `channel`, 0 to 1023; 0 if the companion does not set it, `None` if there is no such channel.
pub fn analog(inputs: &InputSpec, channel: i32) -> Option<u16> {
    let value = inputs.analog.iter().find(|(number, _)| i32::from(*number) == channel).map_or(0, |(_, value)| *value);
    (0..CHANNELS).contains(&channel).then_some(value)
}

/// `OSReadInLatch`
pub fn read_input(robot: &mut Robot, number: i32) -> u8 {
    let value = input(&robot.spec.inputs, number);
    robot.record(Event::Reading { device: "input latch", value: value.into() });
    value
}

/// `OSWriteOutLatch`
pub fn write_output(robot: &mut Robot, number: i32, mask: u8, value: u8) -> u8 {
    match robot.robios.latches.write(number, mask, value) {
        Some((old, new)) => {
            robot.record(Event::Output { device: "output latch", value: new.into() });
            old
        }
        None => {
            robot.fail_call(Call::OSWriteOutLatch, 0);
            0
        }
    }
}

/// `OSReadParData`: the value written last; before the first write, the companion's value.
pub fn read_parallel(robot: &mut Robot) -> u8 {
    let value = robot.robios.latches.parallel_data.unwrap_or(robot.spec.inputs.parallel_data);
    robot.record(Event::Reading { device: "parallel data", value: value.into() });
    value
}

/// `OSWriteParData`
pub fn write_parallel(robot: &mut Robot, value: u8) {
    robot.robios.latches.parallel_data = Some(value);
    robot.record(Event::Output { device: "parallel data", value: value.into() });
}

/// `OSReadParSR`
pub fn read_parallel_status(robot: &mut Robot) -> u8 {
    let value = robot.spec.inputs.parallel_status;
    robot.record(Event::Reading { device: "parallel status", value: value.into() });
    value
}

/// `OSWriteParCTRL`
pub fn write_parallel_control(robot: &mut Robot, value: u8) {
    robot.robios.latches.parallel_control = value;
    robot.record(Event::Output { device: "parallel control", value: value.into() });
}

/// `OSGetAD`
pub fn read_analog(robot: &mut Robot, channel: i32) -> i32 {
    let Some(value) = analog(&robot.spec.inputs, channel) else { return robot.fail_call(Call::OSGetAD, -1) };
    robot.record(Event::Reading { device: "A/D", value: value.into() });
    value.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_keep_the_masked_bits() {
        let mut latches = Latches::default();
        assert_eq!(latches.write(1, 0, 0b1100), Some((0, 0b1100)));
        assert_eq!(latches.write(1, 0b0100, 0b0001), Some((0b1100, 0b0101)));
        assert_eq!([latches.output(1), latches.output(0), latches.output(-1), latches.output(4)], [0b0101, 0, 0, 0]);
        assert_eq!(latches.write(4, 0, 1), None);
        assert_eq!(latches.write(i32::MIN, 0, 1), None);
    }

    #[test]
    fn inputs_read_the_companion() {
        let inputs = InputSpec { analog: vec![(3, 700)], latches: vec![(0, 0x5a)], ..InputSpec::default() };
        assert_eq!([input(&inputs, 0), input(&inputs, 1), input(&inputs, -1)], [0x5a, 0, 0]);
        assert_eq!([analog(&inputs, 3), analog(&inputs, 15)], [Some(700), Some(0)]);
        assert_eq!([analog(&inputs, 16), analog(&inputs, -1)], [None, None]);
    }
}
