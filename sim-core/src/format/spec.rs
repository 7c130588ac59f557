//! What the files say, in SI units: metres, radians, seconds. The frames are those of `docs/conventions.md`.
//!
//! Every value in a spec is a finite number within its documented range, whatever the text was.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::Span;
use super::noise::NoiseRef;
use crate::RobotId;
pub use crate::drive::DriveKind;
pub use crate::format::mount::{BODY, LinkSpec, MountSpec, RangeSpec, ServoRef, Solid, TerrainSpec, TurnSpec};
use crate::pose::Pose;
pub use crate::scene::Surface;
use crate::time::Time;

/// Height of a wall whose line does not say, in metres: what EyeSim VR shows of its walls.
pub const DEFAULT_WALL_HEIGHT: f64 = 0.2;

/// Cell size of a maze that does not say, in metres.
pub const DEFAULT_CELL: f64 = 0.36;

/// Greatest distance of a PSD sensor without a companion file, in metres: the Sharp GP2D02 of the EyeBot robots.
pub const DEFAULT_PSD_RANGE: f64 = 0.8;

/// Greatest distance of a PSD sensor in a robot file of EyeSim VR, in metres: where EyeSim VR caps its readings.
pub const VR_PSD_RANGE: f64 = 9.999;

/// Mass of a robot type that does not say, in kg. Source: our choice.
pub const DEFAULT_ROBOT_MASS: f64 = 1.0;

/// Friction between wheels and floor of a robot type that does not say: rubber on a hard floor. Source: our choice.
pub const DEFAULT_TRACTION: f64 = 0.6;

/// Mass of an object type that does not say, in kg, as in EyeSim VR's graphics library.
pub const DEFAULT_OBJECT_MASS: f64 = 1.0;

/// Friction between floor and an object type that does not say: cardboard on a hard floor. Source: our choice.
pub const DEFAULT_FRICTION: f64 = 0.4;

/// Rolling resistance of an object type of spheres alone that does not say: a ball on short carpet. Source: our choice.
pub const DEFAULT_ROLLING: f64 = 0.02;

/// Restitution of an object type that does not say. Source: our choice.
pub const DEFAULT_RESTITUTION: f64 = 0.3;

/// Points of a laser scanner that does not say.
pub const DEFAULT_LIDAR_POINTS: u32 = 360;

/// Height of a laser scanner that does not say, in metres. Source: our choice.
pub const DEFAULT_LIDAR_HEIGHT: f64 = 0.1;

/// Greatest distance of a laser scanner that does not say, in metres: the 9999 mm that stand for nothing.
pub const DEFAULT_LIDAR_RANGE: f64 = 9.999;

/// Metres per unit of a terrain's mesh that does not say. Source: our choice, as meshes of robots have.
pub const DEFAULT_TERRAIN_SCALE: f64 = 1.0;

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
    /// How it reflects; `None`: as the world says.
    pub surface: Option<Surface>,
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

/// A mesh file and how it is put into the frame of the body that it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelSpec {
    /// The mesh file.
    pub path: PathRef,
    /// Place of the mesh's origin in the body's frame (x forward, y left, z up), in metres.
    pub offset: DVec3,
    /// Turns about the axes of the mesh file (X right, Y up, Z forward), in radians, as the line gives them.
    pub turns: DVec3,
}

/// An axis of a body's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Forward.
    X,
    /// To the left.
    Y,
    /// Upwards.
    Z,
}

/// A part of a body's shape, in the body's frame (x forward, y left, z up), in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Collider {
    /// A box along the axes.
    Box {
        /// Its centre.
        centre: DVec3,
        /// Its full sizes; all positive.
        size: DVec3,
    },
    /// A sphere.
    Sphere {
        /// Its centre.
        centre: DVec3,
        /// Its radius; positive.
        radius: f64,
    },
    /// A cylinder with half spheres at its ends.
    Capsule {
        /// Its centre.
        centre: DVec3,
        /// Its radius; positive.
        radius: f64,
        /// Its full length with the half spheres; at least twice the radius.
        height: f64,
        /// Along which it lies.
        axis: Axis,
    },
    /// An upright cylinder.
    Cylinder {
        /// Its centre.
        centre: DVec3,
        /// Its radius; positive.
        radius: f64,
        /// Its full height; positive.
        height: f64,
    },
}

impl Collider {
    /// Height of its highest point in the frame of its body, in metres.
    pub fn top(&self) -> f64 {
        match *self {
            Collider::Box { centre, size } => centre.z + 0.5 * size.z,
            Collider::Sphere { centre, radius } => centre.z + radius,
            Collider::Capsule { centre, height, axis: Axis::Z, .. } | Collider::Cylinder { centre, height, .. } => {
                centre.z + 0.5 * height
            }
            Collider::Capsule { centre, radius, .. } => centre.z + radius,
        }
    }

    /// Radius of the smallest disc about the origin of the floor plane that holds all of it, seen from above, in metres.
    pub fn reach(&self) -> f64 {
        match *self {
            Collider::Box { centre, size } => (centre.truncate().abs() + 0.5 * size.truncate()).length(),
            Collider::Sphere { centre, radius } | Collider::Cylinder { centre, radius, .. } => {
                centre.truncate().length() + radius
            }
            Collider::Capsule { centre, radius, height, axis } => {
                let half = (0.5 * height - radius).max(0.0);
                let core = match axis {
                    Axis::X => DVec2::new(half, 0.0),
                    Axis::Y => DVec2::new(0.0, half),
                    Axis::Z => DVec2::ZERO,
                };
                (centre.truncate().abs() + core).length() + radius
            }
        }
    }
}

/// A type of passive object: built in, or an `.esObj` file, or a mesh alone.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectType {
    /// The file that describes it: an `.esObj`, or the sim file that names a mesh alone; of a built-in type, its name.
    pub file: String,
    /// Name under which scenes place it.
    pub name: String,
    /// Its looks.
    pub model: Option<ModelSpec>,
    /// Factor on the lengths of the mesh, in metres per unit of the mesh file; positive.
    pub scale: f64,
    /// Its shape; where the file gives none, a default.
    pub colliders: Vec<Collider>,
    /// Mass in kg; positive.
    pub mass: f64,
    /// Centre of mass in the object's frame, in metres.
    pub centre_of_mass: DVec3,
    /// True for what nothing can move.
    pub is_fixed: bool,
    /// Coefficient of sliding friction on the floor; not negative.
    pub friction: f64,
    /// Coefficient of rolling resistance: deceleration over gravity; `None` for what slides.
    pub rolling: Option<f64>,
    /// Coefficient of restitution, 0 to 1.
    pub restitution: f64,
    /// Red, green, blue where no mesh shows it.
    pub colour: Option<[u8; 3]>,
    /// How it reflects.
    pub surface: Surface,
    /// What range sensors in space see of it.
    pub solid: Solid,
    /// Volume in cubic metres by which it floats; 0 for none. Without meaning on dry land.
    pub buoyancy: f64,
}

/// A passive object as a line places it.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectLine {
    /// Its type.
    pub kind: TypeRef,
    /// Pose in the world frame.
    pub pose: Pose,
    /// Friction where the line gives one (classic `object` lines), else that of the type.
    pub friction: Option<f64>,
    /// Where it is written.
    pub span: Span,
}

/// A passive object of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectSpec {
    /// Its type; objects of one type share it.
    pub kind: Arc<ObjectType>,
    /// Pose in the world frame.
    pub pose: Pose,
    /// Coefficient of sliding friction on the floor.
    pub friction: f64,
    /// Where it is written.
    pub span: Span,
}

/// A flat spot of colour on the floor, which nothing touches and no distance sensor sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerSpec {
    /// Its middle in the world frame, in metres.
    pub position: DVec2,
    /// Red, green, blue and opacity.
    pub colour: [u8; 4],
    /// Its line.
    pub span: Span,
}

/// How a line names the type of a robot or an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TypeRef {
    /// By its file.
    File(PathRef),
    /// By its name: a built-in type or one that the scene has loaded.
    Name(PathRef),
}

impl TypeRef {
    /// The file's or the type's name as written.
    pub fn written(&self) -> &PathRef {
        match self {
            TypeRef::File(reference) | TypeRef::Name(reference) => reference,
        }
    }
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
    /// How the floor reflects, and walls that do not say; else the floor is smooth and walls are rough.
    pub surface: Option<Surface>,
    /// A mesh that range sensors see as the ground; robots drive on the plane z = 0 all the same.
    pub terrain: Option<TerrainSpec>,
    /// Side of a maze's cells, in metres; `None` for a `.wld`.
    pub cell: Option<f64>,
    /// Walls in the order of the file; in a maze, the vertical ones from left to right, then the horizontal ones from
    /// top to bottom.
    pub walls: Vec<WallSpec>,
    /// Start places in the order of the file.
    pub starts: Vec<StartSpec>,
    /// Objects in the order of the file.
    pub objects: Vec<ObjectLine>,
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
    /// Angle of the beam above the floor plane of what it sits on, in radians.
    pub pitch: f64,
    /// The link that it sits on; `None`: the body.
    pub on: Option<PathRef>,
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
    /// Field of view of a fisheye lens, in radians; `None` for an ordinary lens.
    pub fisheye: Option<f64>,
    /// Its line.
    pub span: Span,
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

impl LidarSpec {
    /// A scanner written at `span` that says nothing about itself.
    pub fn new(span: Span) -> Self {
        let position = DVec3::new(0.0, 0.0, DEFAULT_LIDAR_HEIGHT);
        let mount = MountSpec { position, ..MountSpec::default() };
        Self { mount, range: DEFAULT_LIDAR_RANGE, points: DEFAULT_LIDAR_POINTS, tilt: 0.0, sweep: TAU, span }
    }
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

/// A robot type: a `.robi` and the `.toml` beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct RobiSpec {
    /// Name of the `.robi` file; of a built-in type, its name.
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
    /// Links in the order of the file; none hangs on itself.
    pub links: Vec<LinkSpec>,
    /// PSD sensors in the order of the file.
    pub psds: Vec<PsdSpec>,
    /// Range sensors beside the PSDs: lasers, ultrasonic, reflectance sensors, sonars, each in the order of the file.
    pub ranges: Vec<RangeSpec>,
    /// The camera.
    pub camera: Option<CameraSpec>,
    /// The laser scanner.
    pub lidar: Option<LidarSpec>,
    /// The body's looks.
    pub model: Option<ModelSpec>,
    /// The body's shape in space where the file gives it; contacts are those of the disc of `diameter`.
    pub colliders: Vec<Collider>,
    /// How the body reflects.
    pub surface: Surface,
    /// Mass in kg; positive.
    pub mass: f64,
    /// Centre of mass in the robot's frame, in metres.
    pub centre_of_mass: DVec3,
    /// Coefficient of friction between wheels and floor: what the robot can push with, over its weight.
    pub traction: f64,
    /// Infrared switches.
    pub infrareds: Vec<InfraredSpec>,
    /// Bumpers.
    pub bumpers: Vec<BumperSpec>,
    /// Servos beyond those of camera and steering, and those two where the companion says more about them.
    pub servos: Vec<ServoSpec>,
    /// The compass.
    pub compass: Option<CompassSpec>,
    /// The colour display of RoBIOS-7.
    pub lcd: LcdSpec,
    /// What unconnected inputs read.
    pub inputs: InputSpec,
    /// What is connected to the serial interfaces, in order of their numbers; nothing where none is listed.
    pub serials: Vec<SerialSpec>,
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

/// Where a robot of a scene starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StartRef {
    /// At the next start of the world that no robot before has taken.
    Next,
    /// With its centre at this pose in the world frame.
    Pose(Pose),
    /// In the cell of the maze that bears a start letter.
    Letter {
        /// The letter, in upper case.
        letter: char,
        /// Heading in radians; `None`: that of the letter.
        heading: Option<f64>,
    },
    /// Several robots that differ in nothing but their start.
    Many {
        /// How many; at least 1.
        count: u32,
        /// How they stand.
        layout: Layout,
    },
}

/// How several robots stand. Lengths in metres, angles in radians, world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layout {
    /// Each at the next start of the world that no robot before has taken.
    Starts,
    /// On a line at equal distances, the first and the last at its ends.
    Line {
        /// Place of the first.
        from: DVec2,
        /// Place of the last.
        to: DVec2,
        /// Heading of all.
        heading: f64,
    },
    /// In rows along x, filled from left to right, then the next one above.
    Grid {
        /// Place of the first.
        from: DVec2,
        /// Distance of columns and of rows.
        spacing: DVec2,
        /// How many stand in a row; `None`: as many as make rows and columns alike.
        columns: Option<u32>,
        /// Heading of all.
        heading: f64,
    },
    /// On a circle at equal angles, counter-clockwise.
    Circle {
        /// Its middle.
        centre: DVec2,
        /// Its radius; positive.
        radius: f64,
        /// Direction in which the first stands, seen from the middle.
        first: f64,
        /// Heading of each against its direction from the middle: 0 looks outwards, pi inwards.
        facing: f64,
    },
    /// At random places where there is room, drawn from the seed.
    Random {
        /// Lower left and upper right corner of the rectangle that the bodies stand in; `None`: the floor.
        area: Option<[DVec2; 2]>,
        /// Smallest distance from walls and others.
        clearance: f64,
        /// Heading of all; `None`: drawn, too.
        heading: Option<f64>,
    },
}

/// What a scene says about its run; the command line goes before it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunSpec {
    /// Seed of all random numbers.
    pub seed: Option<u64>,
    /// Length of a time slot; positive.
    pub slot: Option<Time>,
    /// When the run ends at the latest; positive.
    pub until: Option<Time>,
    /// How much virtual time calls take.
    pub costs: Option<CostsRef>,
    /// Generation of the RoBIOS API that the robots' programs are written for: 6 or 7.
    pub api: Option<u32>,
    /// What errors devices and drives have.
    pub noise: Option<NoiseRef>,
}

/// Where a scene takes its cost table from.
#[derive(Clone, Debug, PartialEq)]
pub enum CostsRef {
    /// A file.
    File(PathRef),
    /// The scene itself; or a file that was read.
    Table(CostTable),
}

/// A cost table: how much virtual time calls take. The names are those of the host, not checked here.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CostTable {
    /// Name of the file.
    pub file: String,
    /// In the order of the file.
    pub entries: Vec<CostEntry>,
}

/// One entry of a cost table.
#[derive(Clone, Debug, PartialEq)]
pub struct CostEntry {
    /// Generation of the API: the name of its section, `robios6`.
    pub generation: String,
    /// Name of a function, or the beginning of names and `*`.
    pub function: String,
    /// What a call takes, 1 us to an hour.
    pub cost: Time,
    /// Where it is written.
    pub span: Span,
}

/// What a scene describes itself instead of naming a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InlineSpec {
    /// The world.
    pub world: Option<WorldSpec>,
    /// Robot types, each with the place where it is described.
    pub robot_types: Vec<(RobiSpec, Span)>,
    /// Object types, likewise.
    pub object_types: Vec<(ObjectType, Span)>,
}

/// One robot of a sim file.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotLine {
    /// Its type.
    pub kind: TypeRef,
    /// Its program; `None` for a robot that only stands there.
    pub program: Option<PathRef>,
    /// What the program gets behind its name.
    pub arguments: Vec<String>,
    /// Generation of the RoBIOS API that the program is written for: 6 or 7; `None`: that of the scene.
    pub api: Option<u32>,
    /// What errors its devices and its drive have; `None`: those of the scene.
    pub noise: Option<NoiseRef>,
    /// Where it starts.
    pub start: StartRef,
    /// The line.
    pub span: Span,
}

/// What EyeSim VR's `settings` line asks the window to show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settings {
    /// The beams of distance sensors (`VIS`).
    pub shows_beams: bool,
    /// The paths of the robots (`TRACE`).
    pub shows_trace: bool,
}

/// In which form a scene is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SceneForm {
    /// Lines of a `.sim`, where a type is loaded before it is used.
    #[default]
    Sim,
    /// Our own, in TOML, where the order of the sections means nothing.
    Toml,
}

/// A sim file or a scene of our own form.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimSpec {
    /// Name of the file.
    pub file: String,
    /// How it is written.
    pub form: SceneForm,
    /// The world; `None` where no usable line names one.
    pub world: Option<WorldLine>,
    /// What the window shows.
    pub settings: Settings,
    /// Files of robot types that lines load, in the order of the file.
    pub robot_types: Vec<PathRef>,
    /// Files of object types that lines load, in the order of the file.
    pub object_types: Vec<PathRef>,
    /// Robots of built-in types and of types that their own line names by a file, in the order of the file.
    pub robots: Vec<RobotLine>,
    /// Objects of built-in types and of types that their own line names by a file, in the order of the file.
    pub objects: Vec<ObjectLine>,
    /// Robots and objects of types that other lines load, in the order of the file. Which of both a line places shows when
    /// the type's file is read.
    pub named: Vec<RobotLine>,
    /// Markers in the order of the file.
    pub markers: Vec<MarkerSpec>,
    /// What the scene describes itself; only our own form does.
    pub inline: InlineSpec,
    /// What it says about its run; only our own form does.
    pub run: RunSpec,
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
    /// Its program, not yet looked for; `None` for a robot that only stands there.
    pub program: Option<PathRef>,
    /// What the program gets behind its name.
    pub arguments: Vec<String>,
    /// Generation of the RoBIOS API that the program is written for, 6 or 7, where the scene says it.
    pub api: Option<u32>,
    /// What errors its devices and its drive have: its own, else the scene's. A profile that is a file has been read.
    pub noise: Option<NoiseRef>,
    /// Generation of the RoBIOS API of the simulator in whose dialect its line is written: 6 for `robi` lines, 7 for those of
    /// EyeSim VR; `None` in our own form.
    pub dialect: Option<u32>,
    /// Its line in the sim file.
    pub span: Span,
}

impl RobotSpec {
    /// The program as the scene names it; empty where it names none.
    pub fn program_name(&self) -> &str {
        self.program.as_ref().map_or("", |program| &program.text)
    }
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
    /// Objects of the world and of the sim file. One whose type cannot be used is missing (and there is a warning).
    pub objects: Vec<ObjectSpec>,
    /// Markers of the sim file.
    pub markers: Vec<MarkerSpec>,
    /// What the window shows.
    pub settings: Settings,
    /// What the scene says about its run. A cost table and a noise profile that are files have been read.
    pub run: RunSpec,
}
