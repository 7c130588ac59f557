//! The machine: its type, system variables, errors and device table.

use std::time::Duration;

use robios_sys::robios6::{HDTEntry, PLATFORM, WALKER, hdt_type};
use robios_sys::{ByteBuffer, ByteSlice};

use crate::device::{BumperAt, Device, EncoderAt, InfraredAt, MotorAt, PsdAt, ServoAt};
use crate::error::checked;
use crate::robot::robios;
use crate::unit::Frequency;
use crate::{Result, Robot};

/// The robot's number, unique in the scene; also its address on the radio.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RobotNumber(pub u8);

impl std::fmt::Display for RobotNumber {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// Type of machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MachineType {
    /// Driving robot.
    Vehicle,
    /// Stationary robot.
    Platform,
    /// Walking robot.
    Walker,
}

/// A row of the device table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceEntry {
    /// The device.
    pub device: Device,
    /// Name of the device in the robi file.
    pub name: String,
}

impl Robot {
    /// Version of RoBIOS, such as `6.5`.
    #[track_caller]
    pub fn version(&self) -> String {
        let mut text = [0; 64];
        let len: i32 = robios!(self, OSVersion(ByteBuffer::from(&mut text[..])));
        text_of(&text, len)
    }

    /// The robot's name.
    #[track_caller]
    pub fn name(&self) -> String {
        let mut text = [0; 64];
        let len: i32 = robios!(self, OSMachineName(ByteBuffer::from(&mut text[..])));
        text_of(&text, len)
    }

    /// The robot's number.
    #[track_caller]
    pub fn id(&self) -> RobotNumber {
        RobotNumber(robios!(self, OSMachineID()))
    }

    /// Type of machine.
    #[track_caller]
    pub fn machine_type(&self) -> MachineType {
        match robios!(self, OSMachineType()) {
            PLATFORM => MachineType::Platform,
            WALKER => MachineType::Walker,
            _ => MachineType::Vehicle,
        }
    }

    /// Clock rate of the robot's processor.
    #[track_caller]
    pub fn machine_speed(&self) -> Frequency {
        let rate: i32 = robios!(self, OSMachineSpeed());
        Frequency::hertz(rate.into())
    }

    /// Shows an error on the LCD and in the record of the run, and waits for a key.
    #[track_caller]
    pub fn show_error(&self, message: &str, number: i32) {
        let _: i32 = robios!(self, OSError(ByteSlice::from(message), number, 0));
    }

    /// Shows an error and blocks the robot forever.
    #[track_caller]
    pub fn halt(&self, message: &str, number: i32) -> ! {
        let _: i32 = robios!(self, OSError(ByteSlice::from(message), number, 1));
        // Reached only if the host returns from a fatal error.
        loop {
            self.sleep(Duration::from_secs(1));
        }
    }

    /// Value of a system variable, 0 to 15; 0 if it was never set.
    #[track_caller]
    pub fn variable(&self, number: u8) -> i32 {
        robios!(self, OSGetVar(number.into()))
    }

    /// Sets a system variable of this robot, 0 to 15.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) for any other number.
    #[track_caller]
    pub fn set_variable(&self, number: u8, value: i32) -> Result {
        checked("OSPutVar", Device::Variables, robios!(self, OSPutVar(number.into(), value)))
    }

    /// The devices in the robot's device table, except those of unknown kinds.
    #[track_caller]
    pub fn devices(&self) -> Vec<DeviceEntry> {
        let mut devices = Vec::new();
        for kind in hdt_type::HDT_MOTOR..=hdt_type::HDT_IRTV {
            let count: i32 = robios!(self, HDT_TypeCount(kind));
            for index in 0..count {
                let mut entry = HDTEntry::default();
                let code: i32 = robios!(self, HDT_FindTable(kind, index, &mut entry));
                if let (0, Some(device)) = (code, device_of(&entry)) {
                    let len = entry.name.iter().position(|byte| *byte == 0).unwrap_or(entry.name.len());
                    devices.push(DeviceEntry { device, name: text_of(&entry.name, len as i32) });
                }
            }
        }
        devices
    }

    /// Returns true if the device table is valid.
    #[track_caller]
    pub fn has_valid_devices(&self) -> bool {
        let code: i32 = robios!(self, HDT_Validate());
        code == 0
    }
}

/// Device of a row of the device table.
fn device_of(entry: &HDTEntry) -> Option<Device> {
    let semantics = entry.semantics;
    Some(match entry.type_id {
        hdt_type::HDT_MOTOR => Device::Motor(MotorAt::from_semantics(semantics)),
        hdt_type::HDT_QUAD => Device::Encoder(EncoderAt::from_semantics(semantics)),
        hdt_type::HDT_SERVO => Device::Servo(ServoAt::from_semantics(semantics)),
        hdt_type::HDT_PSD => Device::Psd(PsdAt::from_semantics(semantics)),
        hdt_type::HDT_BUMP => Device::Bumper(BumperAt::from_semantics(semantics)),
        hdt_type::HDT_IR => Device::Infrared(InfraredAt::from_semantics(semantics)),
        hdt_type::HDT_VW => Device::Drive,
        hdt_type::HDT_COMPASS => Device::Compass,
        hdt_type::HDT_IRTV => Device::TvRemote,
        _ => return None,
    })
}

/// Text that a call has written to a buffer, with the length that the call has returned.
pub(crate) fn text_of(buffer: &[u8], len: i32) -> String {
    let len = usize::try_from(len).unwrap_or(0).min(buffer.len());
    String::from_utf8_lossy(&buffer[..len]).into_owned()
}
