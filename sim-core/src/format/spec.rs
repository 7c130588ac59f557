//! What the files say, in SI units: metres, radians, seconds. The frames are those of `docs/conventions.md`.
//!
//! Every value in a spec is a finite number within its documented range, whatever the text was.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::Span;
use crate::RobotId;
pub use crate::drive::DriveKind;
use crate::pose::Pose;

/// Height of a wall whose line does not say, in metres: what EyeSim VR shows of its walls.
pub const DEFAULT_WALL_HEIGHT: f64 = 0.2;

/// Cell size of a maze that does not say, in metres.
pub const DEFAULT_CELL: f64 = 0.36;

/// Greatest distance of a PSD sensor without a companion file, in metres: the Sharp GP2D02 of the EyeBot robots.
pub const DEFAULT_PSD_RANGE: f64 = 0.8;

/// Largest coordinate or size that a file may have, in metres.
pub const MAX_LENGTH: f64 = 1e6;

/// A file named in another file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PathRef {
    /// As written, without quotes.
    pub text: String,
    /// Where it is written.
    pub span: Span,
}

/// A wall: the straight piece from `from` to `to`, standing on the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSpec {
    /// One end, in metres, world frame.
    pub from: DVec2,
    /// The other end; never equal to `from`.
    pub to: DVec2,
    /// Thickness in metres, half of it on either side; 0 for a wall given by four numbers, which is a mere line.
    pub thickness: f64,
    /// Height of the upper edge above the floor, in metres; positive.
    pub height: f64,
    /// Red, green, blue.
    pub colour: Option<[u8; 3]>,
    /// The wall's line (in a maze: its first character).
    pub span: Span,
}

/// A place where a robot may start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartSpec {
    /// Pose of the robot's centre in the world frame.
    pub pose: Pose,
    /// The maze's letter, in upper case; `None` for a `position` line.
    pub letter: Option<char>,
    /// Where it is written.
    pub span: Span,
}

/// What a passive object is.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ObjectKind {
    /// A ball (maze letter `o`).
    Ball,
    /// A box (maze letter `x`).
    Box,
    /// A body given by a mesh file (`object` line).
    Mesh(PathRef),
}

/// A passive object of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectSpec {
    /// What it is.
    pub kind: ObjectKind,
    /// Pose in the world frame.
    pub pose: Pose,
    /// Friction as the `object` line gives it, 0 otherwise.
    pub friction: f64,
    /// Where it is written.
    pub span: Span,
}

/// A world (`.wld`) or a maze (`.maz`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorldSpec {
    /// Name of the file.
    pub file: String,
    /// Width (along x) and height (along y) of the floor, in metres; one corner is the origin.
    pub floor: DVec2,
    /// Image stretched over the whole floor.
    pub texture: Option<PathRef>,
    /// Side of a maze's cells, in metres; `None` for a `.wld`.
    pub cell: Option<f64>,
    /// Walls in the order of the file; in a maze, the vertical ones from left to right, then the horizontal ones from
    /// top to bottom.
    pub walls: Vec<WallSpec>,
    /// Start places in the order of the file.
    pub starts: Vec<StartSpec>,
    /// Objects in the order of the file.
    pub objects: Vec<ObjectSpec>,
}

impl WorldSpec {
    /// Lower left and upper right corner of the box around floor and walls, in metres.
    pub fn bounds(&self) -> (DVec2, DVec2) {
        let ends = self.walls.iter().flat_map(|wall| [wall.from, wall.to]);
        ends.fold((DVec2::ZERO, self.floor), |(low, high), end| (low.min(end), high.max(end)))
    }
}

/// A motor of the drive and what belongs to it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MotorSpec {
    /// Name of the motor, `MOTOR_LEFT`.
    pub motor: String,
    /// Name of its encoder, `QUAD_LEFT`; `None` where the file names none.
    pub encoder: Option<String>,
}

/// The drive: its kind and the names of its devices.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveSpec {
    /// How the robot drives.
    pub kind: DriveKind,
    /// Motors in the order that [`DriveKind`] gives.
    pub motors: Vec<MotorSpec>,
    /// Name of the servo that steers; only for [`DriveKind::Ackermann`].
    pub steering: Option<String>,
    /// Distance between front and rear axle in metres; for [`DriveKind::Differential`] without meaning.
    pub wheelbase: f64,
    /// Steering angle at the servo's ends (0 and 255), in radians; for [`DriveKind::Ackermann`].
    pub max_steer: f64,
    /// Time constant of the first-order lag between a wheel's command and its speed, in seconds; 0 for none.
    pub wheel_lag: f64,
}

/// The wheels, all alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelSpec {
    /// Diameter in metres.
    pub diameter: f64,
    /// Largest turning rate in rad/s.
    pub max_rate: f64,
    /// Encoder ticks per turn of the wheel.
    pub ticks_per_turn: f64,
    /// Distance between left and right wheels in metres.
    pub track: f64,
}

/// A PSD distance sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct PsdSpec {
    /// Name, `PSD_FRONT`.
    pub name: String,
    /// Number under which programs ask for it; `None`: the number that `hdt_sem.h` gives to the name.
    pub id: Option<i32>,
    /// Origin of the beam in the robot's frame (x forward, y left, z up), in metres.
    pub position: DVec3,
    /// Direction of the beam in the floor plane, counter-clockwise from forward, in radians.
    pub angle: f64,
    /// Greatest distance that it measures, in metres.
    pub range: f64,
    /// Its line.
    pub span: Span,
}

/// Pan or tilt of a camera.
#[derive(Clone, Debug, PartialEq)]
pub enum JointSpec {
    /// Fixed angle in radians.
    Fixed(f64),
    /// Driven by a servo.
    Servo {
        /// Name of the servo, `SERVO1`.
        name: String,
        /// Angle at position 0, in radians.
        from: f64,
        /// Angle at position 255, in radians.
        to: f64,
    },
}

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
    /// Its line.
    pub span: Span,
}

/// An infrared proximity switch: tells whether something is nearer than its range.
#[derive(Clone, Debug, PartialEq)]
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
#[derive(Clone, Debug, PartialEq)]
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
#[derive(Clone, Debug, PartialEq)]
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

/// The compass.
#[derive(Clone, Debug, PartialEq)]
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

/// What the inputs read that are connected to nothing simulated.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct InputSpec {
    /// A/D converter: (channel 0..=15, value 0..=1023), in order of the channels.
    pub analog: Vec<(u8, u16)>,
    /// Digital input latches: (number, value), in order of the numbers.
    pub latches: Vec<(u8, u8)>,
    /// Data register of the parallel port.
    pub parallel_data: u8,
    /// Status register of the parallel port.
    pub parallel_status: u8,
}

/// A robot type: a `.robi` and the `.toml` beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct RobiSpec {
    /// Name of the `.robi` file.
    pub file: String,
    /// Name of the robot type; the file's stem where it does not say.
    pub name: String,
    /// Diameter of the body, a circle about the robot's centre, in metres.
    pub diameter: f64,
    /// Largest speed in m/s.
    pub max_speed: f64,
    /// Largest turning speed in rad/s.
    pub max_turn: f64,
    /// Place of the wheel axis on the robot's x axis, in metres; positive: ahead of the centre.
    pub axis_offset: f64,
    /// The wheels.
    pub wheel: WheelSpec,
    /// The drive.
    pub drive: DriveSpec,
    /// PSD sensors in the order of the file.
    pub psds: Vec<PsdSpec>,
    /// The camera.
    pub camera: Option<CameraSpec>,
    /// File of the body's mesh.
    pub model: Option<PathRef>,
    /// Infrared switches.
    pub infrareds: Vec<InfraredSpec>,
    /// Bumpers.
    pub bumpers: Vec<BumperSpec>,
    /// Servos beyond those of camera and steering, and those two where the companion says more about them.
    pub servos: Vec<ServoSpec>,
    /// The compass.
    pub compass: Option<CompassSpec>,
    /// What unconnected inputs read.
    pub inputs: InputSpec,
    /// Further entries of the hardware description table: (name of a device, number under which programs ask for it), in
    /// order of the names. They go before `hdt_sem.h`.
    pub hdt: Vec<(String, i32)>,
}

/// Which kind of file a sim file takes its world from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorldKind {
    /// A `.wld`.
    World,
    /// A `.maz`.
    Maze,
}

/// The line of a sim file that names the world.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorldLine {
    /// World or maze.
    pub kind: WorldKind,
    /// The file.
    pub path: PathRef,
}

/// One robot of a sim file.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotLine {
    /// The robot type's file.
    pub robi: PathRef,
    /// The program.
    pub program: PathRef,
    /// Start pose in the world frame; `None`: the next free start of the world.
    pub start: Option<Pose>,
    /// The line.
    pub span: Span,
}

/// A sim file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimSpec {
    /// Name of the file.
    pub file: String,
    /// The world; `None` where no usable line names one.
    pub world: Option<WorldLine>,
    /// Robots in the order of the file.
    pub robots: Vec<RobotLine>,
    /// Objects in the order of the file.
    pub objects: Vec<ObjectSpec>,
}

/// A robot of a scene, ready to be built.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSpec {
    /// Its number: its place among the robots of the sim file, from 1.
    pub id: RobotId,
    /// Its type; robots of one file share it.
    pub robi: Arc<RobiSpec>,
    /// Where it starts: pose of its centre in the world frame.
    pub start: Pose,
    /// Its program, not yet looked for.
    pub program: PathRef,
    /// Its line in the sim file.
    pub span: Span,
}

/// A whole scene: what a sim file and all that it names say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneSpec {
    /// Name of the sim file.
    pub file: String,
    /// Folder of the sim file, against which program references are resolved first; empty: the working folder.
    pub folder: String,
    /// The world.
    pub world: WorldSpec,
    /// Robots in order of their ids. A robot whose line or robi cannot be used is missing (and there is an error).
    pub robots: Vec<RobotSpec>,
    /// Objects of the world and of the sim file.
    pub objects: Vec<ObjectSpec>,
}
