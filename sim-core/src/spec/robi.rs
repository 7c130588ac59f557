//! Robot types: body, drive and devices.

use std::collections::BTreeMap;
use std::collections::BTreeSet;

use glam::DVec3;

use super::{
    BumperSpec, CameraSpec, Collider, CompassSpec, DriveKind, InfraredSpec, InputSpec, JointSpec, LcdSpec, LegsSpec,
    LidarSpec, LinkSpec, ModelSpec, PsdSpec, RangeSpec, SerialSpec, ServoSpec, Surface, stem,
};

use crate::drive::Drag;
use crate::unit::radians_from_degrees;

/// Default mass of a robot type, in kg. Source: our choice.
pub const DEFAULT_ROBOT_MASS: f64 = 1.0;

/// Default coefficient of friction between wheels and floor: rubber on a hard floor. Source: our choice.
pub const DEFAULT_TRACTION: f64 = 0.6;

/// Default coefficient of friction between body and walls: plastic on painted wood, as between objects. Source: our
/// choice.
pub const DEFAULT_BODY_FRICTION: f64 = 0.3;

/// Default diameter of the body, in metres. With the other defaults: a small robot with two wheels.
const DEFAULT_DIAMETER: f64 = 0.18;
const DEFAULT_MAX_SPEED: f64 = 0.6;
const DEFAULT_MAX_TURN_DEG: f64 = 300.0;
const DEFAULT_WHEEL_DIAMETER: f64 = 0.05;
const DEFAULT_MAX_RATE_DEG: f64 = 3600.0;
const DEFAULT_TICKS: f64 = 1000.0;
const DEFAULT_TRACK: f64 = 0.09;
const MAX_STEER_DEG: f64 = 45.0;

/// Hull of a robot with [`DriveKind::Thrusters`], which stays upright and neither rises nor sinks by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullSpec {
    /// Force of a thruster at its maximum rate, in N.
    pub thrust: f64,
    /// Drag of motion ahead, sideways, of rotation about the vertical axis, and of motion upwards.
    pub drag: [Drag; 4],
}

impl Default for HullSpec {
    /// The hull of the built-in Mako. Source: our choice.
    fn default() -> Self {
        let drag = |linear, quadratic| Drag { linear, quadratic };
        Self { thrust: 20.0, drag: [drag(10.0, 40.0), drag(30.0, 150.0), drag(4.0, 12.0), drag(30.0, 150.0)] }
    }
}

/// A motor of the drive and its encoder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MotorSpec {
    /// Name of the motor, such as `MOTOR_LEFT`.
    pub motor: String,
    /// Name of its encoder, such as `QUAD_LEFT`; `None` if the file does not name it.
    pub encoder: Option<String>,
}

impl MotorSpec {
    /// Motors with their encoders, from alternating names.
    pub fn pairs(names: &[&str]) -> Vec<Self> {
        let motor =
            |pair: &[&str]| MotorSpec { motor: pair[0].to_owned(), encoder: pair.get(1).map(|&name| name.to_owned()) };
        names.chunks(2).map(motor).collect()
    }
}

/// The drive: its kind and the names of its devices.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveSpec {
    /// Kind of the drive.
    pub kind: DriveKind,
    /// Motors in the order of [`DriveKind`].
    pub motors: Vec<MotorSpec>,
    /// Name of the servo that steers; only for [`DriveKind::Ackermann`].
    pub steering: Option<String>,
    /// Distance between front and rear axle in metres; unused for [`DriveKind::Differential`].
    pub wheelbase: f64,
    /// Steering angle at the servo's positions 0 and 255, in radians; for [`DriveKind::Ackermann`].
    pub max_steer: f64,
    /// Time constant of the first-order lag between a wheel's command and its speed, in seconds; 0 for none.
    pub wheel_lag: f64,
}

/// The wheels, which are all equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelSpec {
    /// Diameter in metres.
    pub diameter: f64,
    /// Maximum rate of rotation in rad/s.
    pub max_rate: f64,
    /// Encoder counts per turn of the wheel.
    pub ticks_per_turn: f64,
    /// Distance between left and right wheels in metres.
    pub track: f64,
}

impl Default for WheelSpec {
    fn default() -> Self {
        Self {
            diameter: DEFAULT_WHEEL_DIAMETER,
            max_rate: radians_from_degrees(DEFAULT_MAX_RATE_DEG),
            ticks_per_turn: DEFAULT_TICKS,
            track: DEFAULT_TRACK,
        }
    }
}

/// A robot type: a `.robi` and its companion file, a `.toml`.
#[derive(Clone, Debug, PartialEq)]
pub struct RobiSpec {
    /// Name of the `.robi` file; for a built-in type, the type's name.
    pub file: String,
    /// Name of the robot type; by default the file's stem.
    pub name: String,
    /// Diameter of the body, a circle about the robot's centre, in metres.
    pub diameter: f64,
    /// Maximum speed in m/s.
    pub max_speed: f64,
    /// Maximum angular speed in rad/s.
    pub max_turn: f64,
    /// Position of the wheel axis on the robot's x axis, in metres; positive: ahead of the centre.
    pub axis_offset: f64,
    /// The wheels.
    pub wheel: WheelSpec,
    /// The drive.
    pub drive: DriveSpec,
    /// Links in the order of the file; without cycles.
    pub links: Vec<LinkSpec>,
    /// PSD sensors in the order of the file.
    pub psds: Vec<PsdSpec>,
    /// Range sensors other than PSDs: lasers, ultrasonic, reflectance sensors, sonars, each in the order of the file.
    pub ranges: Vec<RangeSpec>,
    /// The camera.
    pub camera: Option<CameraSpec>,
    /// The laser scanner.
    pub lidar: Option<LidarSpec>,
    /// Mesh of the body that cameras and the window show.
    pub model: Option<ModelSpec>,
    /// Three-dimensional shape of the body, if the file describes it; contacts use the disc of `diameter`.
    pub colliders: Vec<Collider>,
    /// Reflection properties of the body.
    pub surface: Surface,
    /// Mass in kg; positive.
    pub mass: f64,
    /// Centre of mass in the robot's frame, in metres.
    pub centre_of_mass: DVec3,
    /// Coefficient of friction between wheels and floor: maximum pushing force divided by the robot's weight.
    pub traction: f64,
    /// Coefficient of friction between body and walls.
    pub friction: f64,
    /// Legs of a robot with [`DriveKind::Legged`]; `None` if no file describes them.
    pub legs: Option<LegsSpec>,
    /// Hull of a robot with [`DriveKind::Thrusters`]; unused for other drives.
    pub hull: HullSpec,
    /// Infrared switches.
    pub infrareds: Vec<InfraredSpec>,
    /// Bumpers.
    pub bumpers: Vec<BumperSpec>,
    /// Servos that are not camera or steering servos, and the camera and steering servos that the companion file
    /// describes.
    pub servos: Vec<ServoSpec>,
    /// The compass.
    pub compass: Option<CompassSpec>,
    /// The colour display of RoBIOS-7.
    pub lcd: LcdSpec,
    /// Readings of unconnected inputs.
    pub inputs: InputSpec,
    /// Connections of the serial interfaces, in order of their numbers; interfaces that are not listed are not
    /// connected.
    pub serials: Vec<SerialSpec>,
    /// Further entries of the hardware description table: (name of a device, number by which programs address it), in
    /// order of the names. They take precedence over `hdt_sem.h`.
    pub hdt: Vec<(String, i32)>,
}

/// A servo of a robot, from the entries of the robot type that name it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoRef<'r> {
    /// Name of the servo.
    pub name: &'r str,
    /// Number by which programs address it, if the files state it.
    pub id: Option<i32>,
    /// Angles at positions 0 and 255, in radians.
    pub swing: [f64; 2],
}

impl Default for RobiSpec {
    /// The type of a file without any entries.
    fn default() -> Self {
        Self {
            file: String::new(),
            name: String::new(),
            diameter: DEFAULT_DIAMETER,
            max_speed: DEFAULT_MAX_SPEED,
            max_turn: radians_from_degrees(DEFAULT_MAX_TURN_DEG),
            axis_offset: 0.0,
            wheel: WheelSpec::default(),
            drive: DriveSpec {
                kind: DriveKind::Differential,
                motors: MotorSpec::pairs(&["MOTOR_LEFT", "QUAD_LEFT", "MOTOR_RIGHT", "QUAD_RIGHT"]),
                steering: None,
                wheelbase: DEFAULT_TRACK,
                max_steer: radians_from_degrees(MAX_STEER_DEG),
                wheel_lag: 0.0,
            },
            links: Vec::new(),
            legs: None,
            hull: HullSpec::default(),
            psds: Vec::new(),
            ranges: Vec::new(),
            camera: None,
            lidar: None,
            colliders: Vec::new(),
            surface: Surface::default(),
            mass: DEFAULT_ROBOT_MASS,
            centre_of_mass: DVec3::ZERO,
            traction: DEFAULT_TRACTION,
            friction: DEFAULT_BODY_FRICTION,
            model: None,
            infrareds: Vec::new(),
            bumpers: Vec::new(),
            servos: Vec::new(),
            compass: None,
            lcd: LcdSpec::default(),
            inputs: InputSpec::default(),
            serials: Vec::new(),
            hdt: Vec::new(),
        }
    }
}

impl RobiSpec {
    /// A robot type with all defaults, named by the file's stem.
    pub fn with_defaults(file: &str) -> Self {
        Self { file: file.to_owned(), name: stem(file).to_owned(), ..Self::default() }
    }

    /// Name of range sensor `index`: PSDs come first, then the other range sensors; empty if the sensor does not exist.
    pub fn range_name(&self, index: usize) -> &str {
        match self.psds.get(index) {
            Some(psd) => &psd.name,
            None => self.ranges.get(index - self.psds.len()).map_or("", |range| &range.name),
        }
    }

    /// All servos in the order in which programs number them: the steering servo, the servos of the companion file,
    /// then the camera's servos.
    ///
    /// For a servo that is named twice, the entry in its own table takes precedence.
    pub fn all_servos(&self) -> Vec<ServoRef<'_>> {
        let camera = self.camera.iter().flat_map(|camera| [&camera.pan, &camera.tilt]);
        let joints = camera.filter_map(|joint| match joint {
            JointSpec::Servo { name, from, to } => Some((name.as_str(), [*from, *to])),
            JointSpec::Fixed(_) => None,
        });
        // Position 0 steers to the left.
        let steer = self.drive.max_steer;
        let steering = self.drive.steering.iter().map(|name| (name.as_str(), [steer, -steer]));
        let listed = self.servos.iter().map(|servo| (servo.name.as_str(), [servo.from, servo.to]));
        let mut servos: Vec<ServoRef<'_>> = Vec::new();
        let mut names: BTreeSet<&str> = BTreeSet::new();
        let tables: BTreeMap<&str, &ServoSpec> = self.servos.iter().rev().map(|servo| (&*servo.name, servo)).collect();
        for (name, swing) in steering.chain(listed).chain(joints) {
            if names.insert(name) {
                let table = tables.get(name);
                let swing = table.map_or(swing, |servo| [servo.from, servo.to]);
                servos.push(ServoRef { name, id: table.and_then(|servo| servo.id), swing });
            }
        }
        servos
    }
}
