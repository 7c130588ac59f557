//! Forms of robot types: body, drive and devices.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::{
    ColliderForm, EchoForm, LegForm, LegsForm, LinkForm, ModelForm, MountForm, Number, SonarForm, SurfaceForm,
};

/// A robot type: a file alone, or all that a `.robi` and its companion can say.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RobotTypeForm {
    /// A `.robi`, with the companion beside it; no other key then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) file: Option<String>,
    /// Name under which robots have it; required without a `file`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    /// Diameter of the body in mm; 180 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) diameter_mm: Option<Number>,
    /// Largest speed in mm/s; 600 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) max_speed_mm_per_s: Option<Number>,
    /// Largest turning speed in degrees/s; 300 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) max_turn_deg_per_s: Option<Number>,
    /// Place of the wheel axis on the robot's x axis in mm, positive ahead of the centre; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) axis_mm: Option<Number>,
    /// Centre of mass, x forward, y left, z up, in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) centre_of_mass_mm: Option<[Number; 3]>,
    /// The body's looks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) model: Option<ModelForm>,
    /// The body's shape in space; contacts are those of the disc.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) collider: Vec<ColliderForm>,
    /// Mass and traction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) body: Option<BodyForm>,
    /// The wheels, all alike.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) wheel: Option<WheelForm>,
    /// The drive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) drive: Option<DriveForm>,
    /// How the body reflects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) surface: Option<SurfaceForm>,
    /// Links: parts that sensors sit on.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) link: Vec<LinkForm>,
    /// What the legs do; for `kind = "legged"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) legs: Option<LegsForm>,
    /// The legs.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) leg: Vec<LegForm>,
    /// PSD distance sensors.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) psd: Vec<PsdForm>,
    /// Laser range finders.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) laser: Vec<EchoForm>,
    /// Ultrasonic range sensors with one ray.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) ultrasonic: Vec<EchoForm>,
    /// Reflectance sensors.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) reflectance: Vec<EchoForm>,
    /// Sonars: ultrasonic range sensors with a beam.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) sonar: Vec<SonarForm>,
    /// The camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) camera: Option<CameraForm>,
    /// The laser scanner.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) lidar: Option<LidarForm>,
    /// Infrared switches.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) infrared: Vec<InfraredForm>,
    /// Bumpers.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) bumper: Vec<ArcForm>,
    /// Servos.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) servo: Vec<ServoForm>,
    /// The compass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) compass: Option<CompassForm>,
    /// The colour display of RoBIOS-7.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) lcd: Option<LcdForm>,
    /// What inputs read that nothing simulated drives.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) input: Option<InputForm>,
    /// What is connected to serial interfaces 1 to 16.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub(crate) serial: BTreeMap<String, SerialForm>,
    /// Numbers under which programs ask for devices.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub(crate) hdt: BTreeMap<String, i32>,
}

/// Mass and traction of a robot.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BodyForm {
    /// Mass in kg; 1 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub(crate) mass_kg: Option<Number>,
    /// Coefficient of friction between wheels and floor; 0.6 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 100.0))]
    pub(crate) traction: Option<Number>,
}

/// The wheels.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WheelForm {
    /// Diameter in mm; 50 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) diameter_mm: Option<Number>,
    /// Largest turning rate in degrees/s; 3600 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) max_rate_deg_per_s: Option<Number>,
    /// Encoder ticks per turn; 1000 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) ticks_per_turn: Option<Number>,
    /// Distance between left and right wheels in mm; 90 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) track_mm: Option<Number>,
}

/// The drive.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct DriveForm {
    /// Its kind; differential if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) kind: Option<DriveKindForm>,
    /// Motors: left, right; of a car one; of an omni drive front left, front right, back left, back right.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) motor: Vec<MotorForm>,
    /// The servo that steers a car.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) steering: Option<String>,
    /// Distance between front and rear wheels in mm; of a car 0.6 of the diameter if left out, else the track.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) wheelbase_mm: Option<Number>,
    /// Steering angle at the servo's ends in degrees; 45 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.1, max = 85.0))]
    pub(crate) max_steer_deg: Option<Number>,
    /// Time constant between a wheel's command and its speed in ms; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 3.6e6))]
    pub(crate) wheel_lag_ms: Option<Number>,
}

/// Kinds of drives.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum DriveKindForm {
    /// Two wheels.
    Differential,
    /// A car.
    Ackermann,
    /// Four Mecanum wheels.
    Omni,
    /// Legs.
    Legged,
}

/// A motor with its encoder.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MotorForm {
    /// Its name, such as `MOTOR_LEFT`.
    pub(crate) name: String,
    /// The name of its encoder, such as `QUAD_LEFT`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) encoder: Option<String>,
}

/// A PSD distance sensor.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PsdForm {
    /// Its name, such as `PSD_FRONT`.
    pub(crate) name: String,
    /// Its number for programs; that of `hdt_sem.h` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) id: Option<i32>,
    /// The link that it sits on; `body` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) on: Option<String>,
    /// Place forward of the robot's centre in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) x_mm: Option<Number>,
    /// Place to the left in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) y_mm: Option<Number>,
    /// Height in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) z_mm: Option<Number>,
    /// Direction in degrees, counter-clockwise from forward; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) angle_deg: Option<Number>,
    /// Angle of the beam upwards in degrees; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) pitch_deg: Option<Number>,
    /// Range in mm; 800 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) range_mm: Option<Number>,
}

/// An infrared switch.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct InfraredForm {
    /// Its name, such as `IR_LEFT`.
    pub(crate) name: String,
    /// Its number for programs; that of `hdt_sem.h` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) id: Option<i32>,
    /// Place forward of the robot's centre in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) x_mm: Option<Number>,
    /// Place to the left in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) y_mm: Option<Number>,
    /// Height in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) z_mm: Option<Number>,
    /// Direction in degrees, counter-clockwise from forward; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) angle_deg: Option<Number>,
    /// Range in mm; 100 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) range_mm: Option<Number>,
}

/// A bumper: an arc of the body.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ArcForm {
    /// Its name, such as `BUMP_FRONT`.
    pub(crate) name: String,
    /// Its number for programs; that of `hdt_sem.h` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) id: Option<i32>,
    /// Where the arc begins, in degrees counter-clockwise from forward.
    #[schemars(range(min = -360.0, max = 360.0))]
    pub(crate) from_deg: Number,
    /// Where it ends, counter-clockwise.
    #[schemars(range(min = -360.0, max = 360.0))]
    pub(crate) to_deg: Number,
}

/// A servo.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ServoForm {
    /// Its name, such as `SERVO1`.
    pub(crate) name: String,
    /// Its number for programs; that of `hdt_sem.h` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) id: Option<i32>,
    /// Angle at position 0 in degrees; -90 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub(crate) from_deg: Option<Number>,
    /// Angle at position 255 in degrees; 90 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub(crate) to_deg: Option<Number>,
}

/// The camera.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CameraForm {
    /// Place forward of the robot's centre in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) x_mm: Option<Number>,
    /// Place to the left in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) y_mm: Option<Number>,
    /// Height in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) z_mm: Option<Number>,
    /// Turn about the vertical axis in degrees, counter-clockwise; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) pan_deg: Option<Number>,
    /// The servo that pans, in place of `pan_deg`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) pan_servo: Option<JointForm>,
    /// Turn upwards in degrees; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) tilt_deg: Option<Number>,
    /// The servo that tilts, in place of `tilt_deg`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) tilt_servo: Option<JointForm>,
    /// Largest image: width and height in pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) image_px: Option<[u32; 2]>,
    /// Horizontal field of view in degrees; 60 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1.0, max = 170.0))]
    pub(crate) fov_deg: Option<Number>,
    /// Horizontal field of view of a fisheye lens in degrees, in place of `fov_deg`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1.0, max = 360.0))]
    pub(crate) fisheye_deg: Option<Number>,
    /// Points per side of a pixel whose colours are averaged; 2 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 8))]
    pub(crate) samples: Option<u32>,
}

/// A servo that turns the camera.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointForm {
    /// Its name, such as `SERVO1`.
    pub(crate) name: String,
    /// Angle at position 0 in degrees.
    #[schemars(range(min = -360.0, max = 360.0))]
    pub(crate) from_deg: Number,
    /// Angle at position 255 in degrees.
    #[schemars(range(min = -360.0, max = 360.0))]
    pub(crate) to_deg: Number,
}

/// The laser scanner.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LidarForm {
    #[serde(flatten)]
    pub(crate) mount: MountForm,
    /// Greatest distance along a ray in mm; 9999 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) range_mm: Option<Number>,
    /// Points of a scan; 360 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) points: Option<u32>,
    /// Angle of the scanning plane above the floor plane in degrees; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) tilt_deg: Option<Number>,
    /// Angle that a scan covers in degrees; 360 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) sweep_deg: Option<Number>,
}

/// The compass.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CompassForm {
    /// Its name; `COMPASS` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    /// Its number for programs; that of `hdt_sem.h` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) id: Option<i32>,
    /// Direction in the world in which it reads 0, in degrees; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) north_deg: Option<Number>,
}

/// The colour display of RoBIOS-7.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LcdForm {
    /// Pixels in a row; 320 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 64, max = 1920))]
    pub(crate) width_px: Option<u16>,
    /// Rows of pixels; 240 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 64, max = 1200))]
    pub(crate) height_px: Option<u16>,
}

/// What inputs read that nothing simulated drives.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct InputForm {
    /// A/D converter: values 0 to 1023 by channels 0 to 15.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub(crate) analog: BTreeMap<String, u16>,
    /// Input latches: values 0 to 255 by numbers.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub(crate) latch: BTreeMap<String, u8>,
    /// Digital lines: 0 or 1 by numbers 1 to 16.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub(crate) digital: BTreeMap<String, u8>,
    /// Voltage of the battery; 7.2 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) voltage_v: Option<Number>,
    /// What the microphone reads; 128 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) microphone: Option<u8>,
    /// Data register of the parallel port; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) parallel_data: Option<u8>,
    /// Status register of the parallel port; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) parallel_status: Option<u8>,
}

/// What is at the other end of a serial line.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum SerialForm {
    /// A word.
    Word(SerialWord),
    /// A device that sends the bytes of a file.
    File {
        /// The file.
        file: String,
    },
}

/// What needs no file.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum SerialWord {
    /// Everything that is sent comes back.
    Loopback,
}
