//! What a scene in TOML may hold, as types: they are what is printed, and the JSON schema that editors complete from.
//!
//! The reader does not go through them, since it reports all mistakes with their places; tests hold the two together.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::sensor_form::{EchoForm, LinkForm, MountForm, SolidForm, SonarForm, SurfaceForm, TerrainForm};
use crate::format::noise::form::NoiseForm;

/// A number; a whole one is written without a point.
pub(crate) type Number = f64;

/// A scene of eyesim: a world, robots with their programs, objects, and what a run needs besides.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "eyesim scene")]
pub(crate) struct SceneForm {
    /// What the scene says about its run; the command line goes before it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) scene: Option<RunForm>,
    /// The world: a file, or described in place by its walls or by the drawing of a maze.
    pub(crate) world: WorldForm,
    /// What the window shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) settings: Option<SettingsForm>,
    /// Robot types: files, or described in place.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) robot_type: Vec<RobotTypeForm>,
    /// Object types: files, or described in place.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) object_type: Vec<ObjectTypeForm>,
    /// Robots, alone and in groups; they are numbered 1, 2, ... in this order.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) robot: Vec<RobotForm>,
    /// Passive objects.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) object: Vec<ObjectForm>,
    /// Flat spots of colour on the floor.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) marker: Vec<MarkerForm>,
}

/// What a scene says about its run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunForm {
    /// Seed of all random numbers; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub(crate) seed: Option<i64>,
    /// Length of a time slot in milliseconds, a multiple of 0.001; 50 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 3_600_000.0))]
    pub(crate) slot_ms: Option<Number>,
    /// Simulated seconds at which the run ends; 600 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e9))]
    pub(crate) until_s: Option<Number>,
    /// Virtual time that RoBIOS calls take: a file, or a table for each generation of the API.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) costs: Option<CostsForm>,
    /// Generation of the RoBIOS API that programs are written for, 6 or 7; that of the functions they call if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 6, max = 7))]
    pub(crate) api: Option<u32>,
    /// What errors devices and drives have: `none` (if left out), `mild`, `real`, `harsh`, a file, or a profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) noise: Option<NoiseForm>,
}

/// A cost table.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum CostsForm {
    /// A file.
    File(String),
    /// In place.
    Table(GenerationsForm),
}

/// A cost table in place: microseconds of a call by the name of the function, or by the beginning of names and `*`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct GenerationsForm {
    /// RoBIOS 6.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub(crate) robios6: BTreeMap<String, u32>,
    /// RoBIOS 7.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub(crate) robios7: BTreeMap<String, u32>,
}

/// The world.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WorldForm {
    /// A `.wld` or a `.maz`; no other key but `kind` then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) file: Option<String>,
    /// How a file is read whose extension does not say: `world` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) kind: Option<WorldKindForm>,
    /// Width and height of the floor in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) floor_mm: Option<[Number; 2]>,
    /// Image stretched over the whole floor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) texture: Option<String>,
    /// How the floor reflects, and walls that do not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) surface: Option<SurfaceForm>,
    /// A mesh that range sensors see as the ground; robots drive on the plane all the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) terrain: Option<TerrainForm>,
    /// The drawing of a maze, as in a `.maz`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) maze: Option<String>,
    /// Side of the cells of a world that is a maze of walls, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cell_mm: Option<Number>,
    /// Walls.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) wall: Vec<WallForm>,
    /// Places where robots without a pose start.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) start: Vec<StartForm>,
    /// Objects of the world; they come before those of the scene.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) object: Vec<ObjectForm>,
}

/// How a file is read.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum WorldKindForm {
    /// As a `.wld`.
    World,
    /// As a `.maz`.
    Maze,
}

/// A wall: a straight piece between two points.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WallForm {
    /// One end, x and y in mm.
    pub(crate) from_mm: [Number; 2],
    /// The other end, x and y in mm.
    pub(crate) to_mm: [Number; 2],
    /// Thickness in mm, half of it on either side; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e9))]
    pub(crate) thickness_mm: Option<Number>,
    /// Height above the floor in mm; 200 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 1e9))]
    pub(crate) height_mm: Option<Number>,
    /// Red, green and blue, 0 to 255.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) colour: Option<[u8; 3]>,
    /// How it reflects; as the world says if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) surface: Option<SurfaceForm>,
}

/// A place where a robot may start.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct StartForm {
    /// Place along x in mm.
    pub(crate) x_mm: Number,
    /// Place along y in mm.
    pub(crate) y_mm: Number,
    /// Heading in degrees, counter-clockwise from x; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) heading_deg: Option<Number>,
    /// Letter by which robots choose it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) letter: Option<LetterForm>,
}

/// A start letter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub(crate) enum LetterForm {
    /// Up, the start.
    S,
    /// Up.
    U,
    /// To the right.
    R,
    /// Down.
    D,
    /// To the left.
    L,
}

/// What the window shows.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SettingsForm {
    /// The beams of distance sensors; false if left out.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub(crate) beams: bool,
    /// The paths of the robots; false if left out.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub(crate) trace: bool,
}

/// A robot, or several that differ only in where they start.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RobotForm {
    /// `LabBot`, `S4`, the name of a type of the scene, or a `.robi` file.
    #[serde(rename = "type")]
    pub(crate) kind: String,
    /// Its program: a library, a C or C++ file, several of them with commas, or the folder of a program.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) program: Option<String>,
    /// What the program gets behind its name.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) arguments: Vec<String>,
    /// Generation of the RoBIOS API that the program is written for, 6 or 7; that of the scene if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 6, max = 7))]
    pub(crate) api: Option<u32>,
    /// What errors its devices and its drive have; those of the scene if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) noise: Option<NoiseForm>,
    /// Place of its centre along x in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) x_mm: Option<Number>,
    /// Place of its centre along y in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) y_mm: Option<Number>,
    /// Heading in degrees, counter-clockwise from x; with `x_mm` 0 if left out, with `start` that of the letter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) heading_deg: Option<Number>,
    /// Letter of the start of the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) start: Option<LetterForm>,
    /// How many robots; 1 if left out. Without a `layout` they take the next starts of the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 100_000))]
    pub(crate) count: Option<u32>,
    /// How they stand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) layout: Option<LayoutForm>,
}

/// How several robots stand.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum LayoutForm {
    /// Each at the next start of the world.
    Starts {},
    /// On a line at equal distances, the first and the last at its ends.
    Line {
        /// Place of the first, x and y in mm.
        from_mm: [Number; 2],
        /// Place of the last, x and y in mm.
        to_mm: [Number; 2],
        /// Heading of all in degrees; 0 if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        heading_deg: Option<Number>,
    },
    /// In rows along x, filled from left to right, then the next one above.
    Grid {
        /// Place of the first, x and y in mm.
        from_mm: [Number; 2],
        /// Distance of columns and of rows in mm.
        spacing_mm: [Number; 2],
        /// How many stand in a row; as many as there are rows if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 1, max = 100_000))]
        columns: Option<u32>,
        /// Heading of all in degrees; 0 if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        heading_deg: Option<Number>,
    },
    /// On a circle at equal angles, counter-clockwise.
    Circle {
        /// Its middle, x and y in mm.
        centre_mm: [Number; 2],
        /// Its radius in mm.
        #[schemars(range(min = 0.001, max = 1e9))]
        radius_mm: Number,
        /// Direction in degrees in which the first stands, seen from the middle; 0 if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        first_deg: Option<Number>,
        /// Heading of each against its direction from the middle, in degrees: 0, if left out, looks outwards, 180 inwards.
        #[serde(skip_serializing_if = "Option::is_none")]
        facing_deg: Option<Number>,
    },
    /// At random places where there is room, drawn from the seed.
    Random {
        /// A corner of the rectangle that the bodies stand in, x and y in mm; the floor if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        from_mm: Option<[Number; 2]>,
        /// The opposite corner.
        #[serde(skip_serializing_if = "Option::is_none")]
        to_mm: Option<[Number; 2]>,
        /// Smallest distance from walls and others in mm; 0 if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0, max = 1e9))]
        clearance_mm: Option<Number>,
        /// Heading of all in degrees; drawn, too, if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        heading_deg: Option<Number>,
    },
}

/// A passive object.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ObjectForm {
    /// `Can`, `Soccer`, `Crate`, `Golf`, the name of a type of the scene, an `.esObj` file or a mesh.
    #[serde(rename = "type")]
    pub(crate) kind: String,
    /// Place along x in mm.
    pub(crate) x_mm: Number,
    /// Place along y in mm.
    pub(crate) y_mm: Number,
    /// Heading in degrees, counter-clockwise from x; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) heading_deg: Option<Number>,
    /// Coefficient of friction on the floor; that of the type if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub(crate) friction: Option<Number>,
}

/// A flat spot of colour on the floor.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MarkerForm {
    /// Place along x in mm.
    pub(crate) x_mm: Number,
    /// Place along y in mm.
    pub(crate) y_mm: Number,
    /// Red, green and blue, 0 to 255; red if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) colour: Option<[u8; 3]>,
    /// 0 for nothing to see, 255, if left out, for nothing to see through.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) opacity: Option<u8>,
}

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
    /// Field of view of a fisheye lens in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1.0, max = 360.0))]
    pub(crate) fisheye_deg: Option<Number>,
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

/// A mesh file and how it is put into the body's frame.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModelForm {
    /// The mesh file.
    pub(crate) file: String,
    /// Place of the mesh's origin, x forward, y left, z up, in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) offset_mm: Option<[Number; 3]>,
    /// Turns about the axes of the mesh file, in degrees; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) turns_deg: Option<[Number; 3]>,
}

/// A part of a body's shape.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum ColliderForm {
    /// A box along the axes.
    Box {
        /// Its centre, x forward, y left, z up, in mm; 0 if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        centre_mm: Option<[Number; 3]>,
        /// Its full sizes along x, y and z in mm.
        size_mm: [Number; 3],
    },
    /// A sphere.
    Sphere {
        /// Its centre, x forward, y left, z up, in mm; 0 if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        centre_mm: Option<[Number; 3]>,
        /// Its radius in mm.
        radius_mm: Number,
    },
    /// A cylinder with half spheres at its ends.
    Capsule {
        /// Its centre, x forward, y left, z up, in mm; 0 if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        centre_mm: Option<[Number; 3]>,
        /// Its radius in mm.
        radius_mm: Number,
        /// Its full length in mm, with the half spheres.
        height_mm: Number,
        /// Along which it lies; z if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        axis: Option<AxisForm>,
    },
    /// An upright cylinder.
    Cylinder {
        /// Its centre, x forward, y left, z up, in mm; 0 if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        centre_mm: Option<[Number; 3]>,
        /// Its radius in mm.
        radius_mm: Number,
        /// Its full height in mm.
        height_mm: Number,
    },
}

/// An axis of a body's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum AxisForm {
    /// Forward.
    X,
    /// To the left.
    Y,
    /// Upwards.
    Z,
}

/// An object type: a file alone, or all that an `.esObj` can say.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ObjectTypeForm {
    /// An `.esObj`; no other key then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) file: Option<String>,
    /// Name under which objects have it; required without a `file`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    /// Its looks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) model: Option<ModelForm>,
    /// Length of the mesh's unit in mm; 1000 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) scale_mm: Option<Number>,
    /// Its shape; an upright cylinder 100 mm wide and high if left out.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) collider: Vec<ColliderForm>,
    /// Mass in kg; 1 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub(crate) mass_kg: Option<Number>,
    /// Centre of mass, x forward, y left, z up, in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) centre_of_mass_mm: Option<[Number; 3]>,
    /// Nothing can move it; false if left out.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub(crate) fixed: bool,
    /// Coefficient of sliding friction on the floor; 0.4 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub(crate) friction: Option<Number>,
    /// Coefficient of rolling resistance; 0.02 if left out of a type of spheres alone, which rolls, else none: it slides.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub(crate) rolling: Option<Number>,
    /// Coefficient of restitution; 0.3 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub(crate) restitution: Option<Number>,
    /// Red, green and blue, 0 to 255.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) colour: Option<[u8; 3]>,
    /// How it reflects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) surface: Option<SurfaceForm>,
    /// What range sensors see of it; its colliders if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) solid: Option<SolidForm>,
    /// Volume in cubic metres by which it floats; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub(crate) buoyancy_m3: Option<Number>,
}
