//! Latches, A/D converter and parallel port: inputs read what the robi's companion says, outputs hold what was written.
//!
//! Source: RoBIOS 6 library, latches and A/D converter; the numbers of latches and channels are those of the EyeBot.

use robios_sys::Robios6Call as Call;
use sim_core::spec::InputSpec;

use super::robot::Robot;
use sim_core::record::Event;

/// Input latches, and output latches, numbered from 0; our choice.
pub const LATCHES: usize = 4;

/// A/D channels. Source: RoBIOS 6 library.
pub const CHANNELS: i32 = 16;

/// What outputs hold.
#[derive(Clone, Copy, Debug, Default)]
pub struct Latches {
    outputs: [u8; LATCHES],
    /// Control register of the parallel port.
    pub parallel_control: u8,
    /// Data written to the parallel port, once any was.
    pub parallel_data: Option<u8>,
}

impl Latches {
    /// What output latch `number` holds; 0 for one that does not exist.
    pub fn output(&self, number: i32) -> u8 {
        usize::try_from(number).ok().and_then(|number| self.outputs.get(number)).copied().unwrap_or(0)
    }

    /// Writes output latch `number`: the bits of `mask` are kept, `value` is ORed in. The old value and the new one;
    /// `None` for a latch that does not exist.
    pub fn write(&mut self, number: i32, mask: u8, value: u8) -> Option<(u8, u8)> {
        let latch = self.outputs.get_mut(usize::try_from(number).ok()?)?;
        let old = *latch;
        *latch = old & mask | value;
        Some((old, *latch))
    }
}

/// What input latch `number` reads; 0 where the companion says nothing.
pub fn input(inputs: &InputSpec, number: i32) -> u8 {
    inputs.latches.iter().find(|(latch, _)| i32::from(*latch) == number).map_or(0, |(_, value)| *value)
}

/// What A/D channel `channel` reads, 0 to 1023; 0 where the companion says nothing, `None` for a channel that does not
/// exist.
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
            robot.failed(Call::OSWriteOutLatch, 0);
            0
        }
    }
}

/// `OSReadParData`: what was written last; before that, what the companion says.
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
    let Some(value) = analog(&robot.spec.inputs, channel) else { return robot.failed(Call::OSGetAD, -1) };
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
