//! Device specs of a robot: sensors, servos, display, and connections of its inputs.

use std::f64::consts::{FRAC_PI_3, TAU};
use std::sync::Arc;

use glam::DVec3;

use super::{JointSpec, MountSpec, SpannedText};
use crate::camera::Lens;
use crate::sensor::{Echo, FRANCE_1999_SIGMA, RangeModel};
use crate::spec::Span;

/// Maximum distance of a PSD sensor without a companion file, in metres: the Sharp GP2D02 of the EyeBot robots.
pub const DEFAULT_PSD_RANGE: f64 = 0.8;

/// Maximum distance of a PSD sensor in a robot file of EyeSim VR, in metres: the cap of EyeSim VR's readings.
pub const VR_PSD_RANGE: f64 = 9.999;

/// Name of the laser scanner in lists of sensors and in noise profiles.
pub const LIDAR: &str = "LIDAR";

/// Default number of points of a laser scanner.
pub const DEFAULT_LIDAR_POINTS: u32 = 360;

/// Default height of a laser scanner, in metres. Source: our choice.
pub const DEFAULT_LIDAR_HEIGHT: f64 = 0.1;

/// Default maximum distance of a laser scanner, in metres: the 9999 mm that programs get for no return.
pub const DEFAULT_LIDAR_RANGE: f64 = 9.999;

/// A PSD distance sensor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PsdSpec {
    /// Name, such as `PSD_FRONT`.
    pub name: String,
    /// Number by which programs address it; `None` for the number of this name in `hdt_sem.h`.
    pub id: Option<i32>,
    /// Origin of the beam in the frame of the body or link that carries the sensor (x forward, y left, z up), in
    /// metres.
    pub position: DVec3,
    /// Direction of the beam in the x-y plane of the frame of `position`, counter-clockwise from forward, in radians.
    pub angle: f64,
    /// Angle of the beam above the x-y plane of the frame of `position`, in radians.
    pub pitch: f64,
    /// Link that carries the sensor; `None` for the body.
    pub link: Option<SpannedText>,
    /// Maximum measurable distance, in metres.
    pub range: f64,
    /// Location of its line in the file.
    pub span: Span,
}

/// Maximum number of sonars on one bus: the SRF08 has 16 addresses. Source: Gois & Hiller, section 6.
pub const MAX_SONARS_ON_BUS: usize = 16;

/// A range sensor other than a PSD.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeSpec {
    /// Name, such as `US_FRONT`.
    pub name: String,
    /// Number by which programs address it; `None` for the number of this name in `hdt_sem.h`.
    pub id: Option<i32>,
    /// Mounting pose; x is the axis of the beam.
    pub mount: MountSpec,
    /// Measuring principle.
    pub model: RangeModel,
    /// Standard deviation of the noise N, relative to the measured value.
    pub sigma: f64,
    /// Mean of the noise N, relative to the measured value.
    pub mean: f64,
    /// Bus of a sonar, from 1; `None` for other sensors.
    pub bus: Option<u32>,
    /// Location in the file.
    pub span: Span,
}

impl Default for RangeSpec {
    /// A laser range finder.
    fn default() -> Self {
        Self {
            name: String::new(),
            id: None,
            mount: MountSpec::default(),
            model: RangeModel::Laser(Echo::LASER),
            sigma: FRANCE_1999_SIGMA,
            mean: 0.0,
            bus: None,
            span: Span::default(),
        }
    }
}

/// Default horizontal field of view of a camera, in radians: 60 degrees, similar to the EyeCam. Source: our choice,
/// since robot files do not state it.
pub const DEFAULT_FIELD_OF_VIEW: f64 = FRAC_PI_3;

/// Maximum horizontal field of view of a pinhole camera, in degrees: beyond it, the edges of the view fill almost all
/// of the image.
pub const MAX_FIELD_OF_VIEW_DEG: f64 = 170.0;

/// Default number of samples per side of a pixel. Source: our choice, see docs/camera.md.
pub const DEFAULT_SAMPLES: u32 = 2;

/// Maximum number of samples per side of a pixel.
pub const MAX_SAMPLES: u32 = 8;

/// Default lens of a camera.
pub const DEFAULT_LENS: Lens = Lens::Pinhole { fov: DEFAULT_FIELD_OF_VIEW };

/// The camera.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraSpec {
    /// Position in the robot's frame, in metres.
    pub position: DVec3,
    /// Rotation about the vertical axis, counter-clockwise.
    pub pan: JointSpec,
    /// Rotation upwards.
    pub tilt: JointSpec,
    /// Largest image: width and height in pixels; `None` if the line does not state it.
    pub image: Option<[u32; 2]>,
    /// Its lens.
    pub lens: Lens,
    /// Samples per side of a pixel, 1 to [`MAX_SAMPLES`]; their colours are averaged.
    pub samples: u32,
    /// Location of its line in the file.
    pub span: Span,
}

impl Default for CameraSpec {
    fn default() -> Self {
        Self {
            position: DVec3::ZERO,
            pan: JointSpec::default(),
            tilt: JointSpec::default(),
            image: None,
            lens: DEFAULT_LENS,
            samples: DEFAULT_SAMPLES,
            span: Span::default(),
        }
    }
}

/// A laser scanner: measures distances in many directions at equal angles.
#[derive(Clone, Debug, PartialEq)]
pub struct LidarSpec {
    /// Mounting pose; x points to the middle of the scan.
    pub mount: MountSpec,
    /// Maximum measurable distance along a ray, in metres.
    pub range: f64,
    /// Number of points of a scan.
    pub points: u32,
    /// Angle of the scanning plane above the floor plane, in radians.
    pub tilt: f64,
    /// Angle that a scan covers, half of it on either side of x, in radians; default: a full turn.
    pub sweep: f64,
    /// Location of its line in the file.
    pub span: Span,
}

impl Default for LidarSpec {
    fn default() -> Self {
        let span = Span::default();
        let position = DVec3::new(0.0, 0.0, DEFAULT_LIDAR_HEIGHT);
        let mount = MountSpec { position, ..MountSpec::default() };
        Self { mount, range: DEFAULT_LIDAR_RANGE, points: DEFAULT_LIDAR_POINTS, tilt: 0.0, sweep: TAU, span }
    }
}

/// An infrared proximity switch: detects bodies nearer than its range.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InfraredSpec {
    /// Name, such as `IR_LF`.
    pub name: String,
    /// Number by which programs address it; `None` for the number of this name in `hdt_sem.h`.
    pub id: Option<i32>,
    /// Origin of the beam in the robot's frame, in metres.
    pub position: DVec3,
    /// Direction of the beam, counter-clockwise from forward, in radians.
    pub angle: f64,
    /// Detection distance, in metres.
    pub range: f64,
    /// Location in the file.
    pub span: Span,
}

/// A bumper: an arc of the robot's circumference that detects contacts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BumperSpec {
    /// Name, such as `BUMP_FRONT`.
    pub name: String,
    /// Number by which programs address it; `None` for the number of this name in `hdt_sem.h`.
    pub id: Option<i32>,
    /// Start of the arc, in radians counter-clockwise from forward.
    pub from: f64,
    /// End of the arc, counter-clockwise from `from`: `from < to <= from + 2 pi`.
    pub to: f64,
    /// Location in the file.
    pub span: Span,
}

/// A servo.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ServoSpec {
    /// Name, such as `SERVO1`.
    pub name: String,
    /// Number by which programs address it; `None` for the number of this name in `hdt_sem.h`.
    pub id: Option<i32>,
    /// Angle at position 0, in radians.
    pub from: f64,
    /// Angle at position 255, in radians.
    pub to: f64,
    /// Location in the file.
    pub span: Span,
}

/// The colour display of RoBIOS-7.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LcdSpec {
    /// Pixels in a row.
    pub width: u16,
    /// Rows of pixels.
    pub height: u16,
}

impl Default for LcdSpec {
    /// The window of EyeSim VR.
    fn default() -> Self {
        Self { width: 480, height: 320 }
    }
}

/// The compass.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompassSpec {
    /// Name, such as `COMPASS`.
    pub name: String,
    /// Number by which programs address it; `None` for the number of this name in `hdt_sem.h`.
    pub id: Option<i32>,
    /// World direction (radians counter-clockwise from x) in which the compass reads 0.
    pub north: f64,
    /// Location in the file.
    pub span: Span,
}

/// Default voltage of the battery, in volts: two lithium cells. Source: our choice.
pub const DEFAULT_VOLTAGE: f64 = 7.2;

/// Reading of the microphone in silence: the middle of its range.
pub const DEFAULT_MICROPHONE: u8 = 128;

/// Readings of inputs that are not connected to a simulated device.
#[derive(Clone, Debug, PartialEq)]
pub struct InputSpec {
    /// A/D converter: (channel 0..=15, value 0..=1023), in order of the channels.
    pub analog: Vec<(u8, u16)>,
    /// Digital input latches: (number, value), in order of the numbers.
    pub latches: Vec<(u8, u8)>,
    /// Digital lines: (number 1..=16, 0 or 1), in order of the numbers.
    pub digital: Vec<(u8, u8)>,
    /// Voltage of the battery in volts.
    pub voltage: f64,
    /// Reading of the microphone.
    pub microphone: u8,
    /// Data register of the parallel port.
    pub parallel_data: u8,
    /// Status register of the parallel port.
    pub parallel_status: u8,
}

impl Default for InputSpec {
    fn default() -> Self {
        Self {
            analog: Vec::new(),
            latches: Vec::new(),
            digital: Vec::new(),
            voltage: DEFAULT_VOLTAGE,
            microphone: DEFAULT_MICROPHONE,
            parallel_data: 0,
            parallel_status: 0,
        }
    }
}

/// Connection of a serial interface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialSpec {
    /// Number of the interface, 1..=16.
    pub interface: u8,
    /// Device at the other end of the line.
    pub line: SerialLine,
}

/// Device at the other end of a serial line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SerialLine {
    /// A device that sends every byte back.
    Loopback,
    /// A device that sends the bytes of a file.
    File {
        /// The file.
        path: SpannedText,
        /// Contents of the file; empty if it has not been read.
        bytes: Arc<[u8]>,
    },
}
