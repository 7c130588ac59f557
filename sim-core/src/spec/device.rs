//! Devices of a robot: sensors, servos, display, and what is connected to its inputs.

use std::f64::consts::{FRAC_PI_3, TAU};
use std::sync::Arc;

use glam::DVec3;

use super::{JointSpec, MountSpec, PathRef};
use crate::camera::Lens;
use crate::sensor::{Echo, PAPER_SIGMA, RangeModel};
use crate::spec::Span;

/// Greatest distance of a PSD sensor without a companion file, in metres: the Sharp GP2D02 of the EyeBot robots.
pub const DEFAULT_PSD_RANGE: f64 = 0.8;

/// Greatest distance of a PSD sensor in a robot file of EyeSim VR, in metres: where EyeSim VR caps its readings.
pub const VR_PSD_RANGE: f64 = 9.999;

/// Name of the laser scanner among the sensors, in noise profiles.
pub const LIDAR: &str = "LIDAR";

/// Points of a laser scanner that does not say.
pub const DEFAULT_LIDAR_POINTS: u32 = 360;

/// Height of a laser scanner that does not say, in metres. Source: our choice.
pub const DEFAULT_LIDAR_HEIGHT: f64 = 0.1;

/// Greatest distance of a laser scanner that does not say, in metres: the 9999 mm that stand for nothing.
pub const DEFAULT_LIDAR_RANGE: f64 = 9.999;

/// A PSD distance sensor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PsdSpec {
    /// Name, `PSD_FRONT`.
    pub name: String,
    /// Number under which programs ask for it; `None`: the number that `hdt_sem.h` gives to the name.
    pub id: Option<i32>,
    /// Origin of the beam in the robot's frame (x forward, y left, z up), in metres.
    pub position: DVec3,
    /// Direction of the beam in the floor plane, counter-clockwise from forward, in radians.
    pub angle: f64,
    /// Angle of the beam above the floor plane of what it sits on, in radians.
    pub pitch: f64,
    /// The link that it sits on; `None`: the body.
    pub on: Option<PathRef>,
    /// Greatest distance that it measures, in metres.
    pub range: f64,
    /// Its line.
    pub span: Span,
}

/// Most sonars on one bus: the SRF08 can be given 16 addresses. Source: Gois & Hiller, section 6.
pub const MAX_SONARS_ON_BUS: usize = 16;

/// A range sensor beside the PSDs.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeSpec {
    /// Name, `US_FRONT`.
    pub name: String,
    /// Number under which programs ask for it; `None`: the number that `hdt_sem.h` gives to the name.
    pub id: Option<i32>,
    /// Where it sits; x is the middle of its beam.
    pub mount: MountSpec,
    /// How it measures.
    pub model: RangeModel,
    /// Standard deviation of its noise N, a share of what it measures.
    pub sigma: f64,
    /// Mean of N.
    pub mean: f64,
    /// The bus that a sonar is on, from 1; `None` for sensors of other kinds, which are on none.
    pub bus: Option<u32>,
    /// Where it is written.
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
            sigma: PAPER_SIGMA,
            mean: 0.0,
            bus: None,
            span: Span::default(),
        }
    }
}

/// Horizontal field of view of a camera that does not say, in radians: 60 degrees, near that of the EyeCam. Source: our choice;
/// the files do not say.
pub const DEFAULT_FIELD_OF_VIEW: f64 = FRAC_PI_3;

/// Widest horizontal field of view of a pinhole camera, in degrees: beyond, the edges of its images show hardly anything else.
pub const MAX_FIELD_OF_VIEW_DEG: f64 = 170.0;

/// Points per side of a pixel at which a camera looks that does not say. Source: our choice, see docs/camera.md.
pub const DEFAULT_SAMPLES: u32 = 2;

/// Most of them.
pub const MAX_SAMPLES: u32 = 8;

/// The lens of a camera that does not say.
pub const DEFAULT_LENS: Lens = Lens::Pinhole { fov: DEFAULT_FIELD_OF_VIEW };

/// The camera.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraSpec {
    /// Position in the robot's frame, in metres.
    pub position: DVec3,
    /// Turn about the vertical axis, counter-clockwise.
    pub pan: JointSpec,
    /// Turn upwards.
    pub tilt: JointSpec,
    /// Largest image: width and height in pixels; `None` where the line does not say.
    pub image: Option<[u32; 2]>,
    /// Its lens.
    pub lens: Lens,
    /// Points per side of a pixel at which it looks, 1 to [`MAX_SAMPLES`]; their colours are averaged.
    pub samples: u32,
    /// Its line.
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

/// A laser scanner: distances all around, at equal angles.
#[derive(Clone, Debug, PartialEq)]
pub struct LidarSpec {
    /// Where it sits; x is the middle of its scan.
    pub mount: MountSpec,
    /// Greatest distance that it measures along a ray, in metres.
    pub range: f64,
    /// Number of points of a scan.
    pub points: u32,
    /// Angle of the scanning plane above the floor plane, in radians.
    pub tilt: f64,
    /// Angle that a scan covers, half of it to either side of forward, in radians: a whole turn where nothing says less.
    pub sweep: f64,
    /// Its line.
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

/// An infrared proximity switch: tells whether something is nearer than its range.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InfraredSpec {
    /// Name, `IR_LF`.
    pub name: String,
    /// Number under which programs ask for it; `None`: that of `hdt_sem.h`.
    pub id: Option<i32>,
    /// Origin of the beam in the robot's frame, in metres.
    pub position: DVec3,
    /// Direction of the beam, counter-clockwise from forward, in radians.
    pub angle: f64,
    /// Distance below which it answers, in metres.
    pub range: f64,
    /// Where it is written.
    pub span: Span,
}

/// A bumper: an arc of the robot's circumference that feels contacts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BumperSpec {
    /// Name, `BUMP_FRONT`.
    pub name: String,
    /// Number under which programs ask for it; `None`: that of `hdt_sem.h`.
    pub id: Option<i32>,
    /// Where the arc begins, in radians counter-clockwise from forward.
    pub from: f64,
    /// Where it ends, counter-clockwise from `from`: `from < to <= from + 2 pi`.
    pub to: f64,
    /// Where it is written.
    pub span: Span,
}

/// A servo.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ServoSpec {
    /// Name, `SERVO1`.
    pub name: String,
    /// Number under which programs ask for it; `None`: that of `hdt_sem.h`.
    pub id: Option<i32>,
    /// Angle at position 0, in radians.
    pub from: f64,
    /// Angle at position 255, in radians.
    pub to: f64,
    /// Where it is written.
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
        Self { width: 320, height: 240 }
    }
}

/// The compass.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompassSpec {
    /// Name, `COMPASS`.
    pub name: String,
    /// Number under which programs ask for it; `None`: that of `hdt_sem.h`.
    pub id: Option<i32>,
    /// World direction (radians counter-clockwise from x) in which the compass reads 0.
    pub north: f64,
    /// Where it is written.
    pub span: Span,
}

/// Voltage of the battery where nobody says, in volts: two lithium cells. Source: our choice.
pub const DEFAULT_VOLTAGE: f64 = 7.2;

/// What the microphone reads in silence: the middle of its range.
pub const DEFAULT_MICROPHONE: u8 = 128;

/// What the inputs read that are connected to nothing simulated.
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
    /// What the microphone reads.
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

/// What is connected to a serial interface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialSpec {
    /// Number of the interface, 1..=16.
    pub interface: u8,
    /// What is at the line's other end.
    pub line: SerialLine,
}

/// The other end of a serial line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SerialLine {
    /// Everything that is sent comes back.
    Loopback,
    /// A device that sends the bytes of a file.
    File {
        /// The file.
        path: PathRef,
        /// Its bytes; empty where it has not been read.
        bytes: Arc<[u8]>,
    },
}
