//! Scenes: contents of a sim file or of a scene in TOML, and the scene after all its files have been read.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec2;

use super::{CheckSpec, FaultSpec, LooksSpec, NoiseRef, ObjectType, RobiSpec, SpannedText, WorldSpec};
use crate::RobotId;
use crate::pose::{Heading, Pose};
use crate::radio;
use crate::spec::Span;
use crate::time::Time;

/// A line that places a passive object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectLine {
    /// Type of the object.
    pub kind: TypeRef,
    /// Pose in the world frame.
    pub pose: Pose,
    /// Friction given by the line (classic `object` lines); `None` for the friction of the type.
    pub friction: Option<f64>,
    /// Name of the line within the scene.
    pub name: Option<String>,
    /// Path of the line in a scene in TOML, such as `object.2`; key of its random numbers.
    pub path: String,
    /// Random placement, if the pose is drawn.
    pub scatter: Option<Scatter>,
    /// Location in the file.
    pub span: Span,
}

/// A passive object of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectSpec {
    /// Type of the object, shared by all objects of this type.
    pub kind: Arc<ObjectType>,
    /// Pose in the world frame.
    pub pose: Pose,
    /// Coefficient of sliding friction on the floor.
    pub friction: f64,
    /// Path of its line in a scene in TOML, such as `object.2`; otherwise empty.
    pub line: String,
    /// Location in the file.
    pub span: Span,
}

/// A flat spot of colour on the floor, without contacts and invisible to distance sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MarkerSpec {
    /// Centre in the world frame, in metres.
    pub position: DVec2,
    /// Red, green, blue and opacity.
    pub colour: [u8; 4],
    /// Location of its line in the file.
    pub span: Span,
}

/// Reference to the type of a robot or an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TypeRef {
    /// The file of the type.
    File(SpannedText),
    /// The name of a built-in type or of a type that the scene has loaded.
    Name(SpannedText),
}

impl Default for TypeRef {
    fn default() -> Self {
        Self::Name(SpannedText::default())
    }
}

impl TypeRef {
    /// Name of the file or type as written.
    pub fn written(&self) -> &SpannedText {
        match self {
            TypeRef::File(reference) | TypeRef::Name(reference) => reference,
        }
    }
}

/// Kind of the file from which a sim file takes its world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorldKind {
    /// A `.wld`.
    World,
    /// A `.maz`.
    Maze,
}

/// The line of a sim file that names the world.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldLine {
    /// World or maze.
    pub kind: WorldKind,
    /// The file.
    pub path: SpannedText,
    /// Cell size of a maze in metres; takes precedence over the maze file.
    pub cell: Option<f64>,
    /// Appearance of the world, from the scene; world files do not describe it.
    pub looks: LooksSpec,
}

/// Start pose of a robot, or of a group, as a scene gives it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum StartRef {
    /// The next start of the world that no earlier robot has taken.
    #[default]
    Next,
    /// This pose of the robot's centre in the world frame.
    Pose(Pose),
    /// The maze cell with a start letter.
    Letter {
        /// The letter, in upper case.
        letter: char,
        /// Heading in radians; `None` for the heading that the letter implies.
        heading: Option<f64>,
    },
    /// A group of robots that differ only in their start.
    Many {
        /// Number of robots; at least 1.
        count: u32,
        /// Arrangement of the group.
        layout: Layout,
    },
}

/// Arrangement of a group of robots. Lengths in metres, angles in radians, world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Layout {
    /// Each robot takes the next start of the world that no earlier robot has taken.
    #[default]
    Starts,
    /// The robots are on a line at equal distances, the first and the last at its ends.
    Line {
        /// Position of the first robot.
        from: DVec2,
        /// Position of the last robot.
        to: DVec2,
        /// Heading of all robots.
        heading: f64,
    },
    /// The robots are in rows along x, each filled from left to right, with the next row above.
    Grid {
        /// Position of the first robot.
        from: DVec2,
        /// Distance between columns and between rows.
        spacing: DVec2,
        /// Number of robots in a row; `None` for a square arrangement.
        columns: Option<u32>,
        /// Heading of all robots.
        heading: f64,
    },
    /// The robots are on a circle at equal angles, counter-clockwise.
    Circle {
        /// Centre of the circle.
        centre: DVec2,
        /// Radius; positive.
        radius: f64,
        /// Direction of the first robot from the centre.
        first: f64,
        /// Heading of each robot relative to its direction from the centre: 0 faces outwards, pi inwards.
        facing: f64,
    },
    /// The robots are at random free positions, drawn from the seed.
    Random(Scatter),
}

/// Random placement of robots, objects or walls in free space. Lengths in metres, angles in radians, world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scatter {
    /// Lower left and upper right corner of the rectangle that contains the bodies; `None` for the floor.
    pub area: Option<[DVec2; 2]>,
    /// Minimum distance from walls and other bodies.
    pub clearance: f64,
    /// Heading of all bodies; `None` for random headings.
    pub heading: Option<f64>,
}

/// A value of a scene that was drawn from the seed.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// Path of the value in the scene, such as `robot.1.x_mm`.
    pub path: String,
    /// The value, in the unit of its key.
    pub value: serde_json::Value,
}

/// A position in a scene, to which a requirement refers.
#[derive(Clone, Debug, PartialEq)]
pub enum PositionRef {
    /// A point in the world frame, in metres.
    Point(DVec2),
    /// The start of the robot or object with this path, such as `robot.1`.
    Start(SpannedText),
}

impl Default for PositionRef {
    fn default() -> Self {
        Self::Point(DVec2::ZERO)
    }
}

/// A requirement: a disc can move between two positions of a scene without touching walls or objects.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReachableSpec {
    /// Start of the route.
    pub from: PositionRef,
    /// End of the route.
    pub to: PositionRef,
    /// Diameter of the disc in metres; `None` for the diameter of the robot at the start.
    pub width: Option<f64>,
    /// Location in the file.
    pub span: Span,
}

impl Layout {
    /// Pose of the robot at `index` of `count`; `None` for layouts that depend on the world.
    pub fn pose(&self, index: u32, count: u32) -> Option<Pose> {
        let (position, heading) = match *self {
            Layout::Starts | Layout::Random(_) => return None,
            Layout::Line { from, to, heading } => {
                let fraction = if count > 1 { f64::from(index) / f64::from(count - 1) } else { 0.0 };
                // The last robot is exactly at `to`, in spite of rounding.
                (if fraction == 1.0 { to } else { from + (to - from) * fraction }, heading)
            }
            Layout::Grid { from, spacing, columns, heading } => {
                let columns = columns.unwrap_or_else(|| smallest_square(count));
                let cell = DVec2::new(f64::from(index % columns), f64::from(index / columns));
                (from + spacing * cell, heading)
            }
            Layout::Circle { centre, radius, first, facing } => {
                let direction = first + TAU * f64::from(index) / f64::from(count.max(1));
                (centre + radius * Heading::new(direction).direction(), direction + facing)
            }
        };
        Some(Pose::new(position.x, position.y, heading))
    }
}

/// Side of the smallest square with at least `count` cells.
fn smallest_square(count: u32) -> u32 {
    let root = count.isqrt();
    (if root * root < count { root + 1 } else { root }).max(1)
}

/// Run options of a scene; the command line takes precedence.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunSpec {
    /// Seed of all random numbers.
    pub seed: Option<u64>,
    /// Length of a slot; positive.
    pub slot: Option<Time>,
    /// Time limit of the run; positive.
    pub until: Option<Time>,
    /// Virtual time that calls take.
    pub costs: Option<CostsRef>,
    /// RoBIOS functions that fail for all programs: names, in which `*` matches any text.
    pub forbid: Vec<SpannedText>,
    /// Generation of the RoBIOS API for which the robots' programs are written: 6 or 7.
    pub api: Option<u32>,
    /// The EyeSim version whose conventions the scene and its programs follow.
    pub dialect: Option<Dialect>,
    /// Noise profile of devices and drives.
    pub noise: Option<NoiseRef>,
    /// Motion of a robot that is pushed against a wall.
    pub contact: Option<ContactKind>,
    /// Coefficient of friction of the walls. Between a robot and a wall, the smaller coefficient applies.
    pub wall_friction: Option<f64>,
}

/// The EyeSim version whose conventions a scene and its programs follow. See `docs/dialects.md`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    /// EyeSim 5 and 6.
    Classic,
    /// EyeSim VR of 2017 and 2018.
    Vr2018,
    /// Later EyeSim VR, and EyeSim X.
    #[default]
    Vr2023,
}

impl Dialect {
    /// All dialects, the oldest first.
    pub const ALL: [Self; 3] = [Self::Classic, Self::Vr2018, Self::Vr2023];

    /// Word for the dialect in files and on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Classic => "classic",
            Self::Vr2018 => "vr2018",
            Self::Vr2023 => "vr2023",
        }
    }

    /// Generation of the RoBIOS API that this EyeSim has: 6 or 7.
    pub fn generation(self) -> u32 {
        match self {
            Self::Classic => 6,
            Self::Vr2018 | Self::Vr2023 => 7,
        }
    }
}

/// Motion of a robot that is pushed against a wall. See `docs/motion.md`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactKind {
    /// The robot slides if it is pushed outside the friction cone, while its wheels slip over the floor.
    #[default]
    Slide,
    /// The robot is at rest, its wheels stall, and the command stays in force.
    Stall,
}

impl ContactKind {
    /// Both kinds.
    pub const ALL: [Self; 2] = [Self::Slide, Self::Stall];

    /// Word for the kind in files and on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Slide => "slide",
            Self::Stall => "stall",
        }
    }
}

/// Source of the cost table of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum CostsRef {
    /// A file.
    File(SpannedText),
    /// A table given in the scene, or read from a file.
    Table(CostTable),
}

/// A cost table: the virtual time that calls take. The host checks the names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CostTable {
    /// Name of the file.
    pub file: String,
    /// Entries in the order of the file.
    pub entries: Vec<CostEntry>,
}

/// One entry of a cost table.
#[derive(Clone, Debug, PartialEq)]
pub struct CostEntry {
    /// Generation of the API: the name of its section, such as `robios6`.
    pub generation: String,
    /// Name of a function, or a prefix followed by `*`.
    pub function: String,
    /// Duration of a call, 1 us to an hour.
    pub cost: Time,
    /// Location in the file.
    pub span: Span,
}

/// Descriptions within a scene that replace files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InlineSpec {
    /// The world.
    pub world: Option<WorldSpec>,
    /// Robot types, each with the location of its description.
    pub robot_types: Vec<(RobiSpec, Span)>,
    /// Object types, each with the location of its description.
    pub object_types: Vec<(ObjectType, Span)>,
}

/// A line of a sim file that places a robot or a group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotLine {
    /// Number given by the scene, unique among its lines. Robots without a number take the free numbers from 1, in the
    /// order of the file. A group has no number.
    pub id: Option<RobotId>,
    /// Type of the robot.
    pub kind: TypeRef,
    /// Program; `None` for a robot without a program.
    pub program: Option<SpannedText>,
    /// Command-line arguments of the program.
    pub arguments: Vec<String>,
    /// Generation of the RoBIOS API for which the program is written, 6 or 7; `None`: the scene's generation.
    pub api: Option<u32>,
    /// Noise profile of devices and drive; `None` for the scene's profile.
    pub noise: Option<NoiseRef>,
    /// Start pose.
    pub start: StartRef,
    /// Name of the line within the scene.
    pub name: Option<String>,
    /// Path of the line in a scene in TOML, such as `robot.2`; key of its random numbers.
    pub path: String,
    /// Location of its line in the file.
    pub span: Span,
}

/// Display options of the window, from EyeSim VR's `settings` line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settings {
    /// True to show the beams of distance sensors (`VIS`); kept for conversions, without effect.
    pub shows_beams: bool,
    /// True to show the paths of the robots (`TRACE`); kept for conversions, without effect.
    pub shows_trace: bool,
}

/// File format of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SceneFormat {
    /// Lines of a `.sim`, in which a type is loaded before it is used.
    #[default]
    Sim,
    /// A scene in TOML, in which the order of the sections has no meaning.
    Toml,
}

/// Contents of a sim file, or of a scene in TOML.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimSpec {
    /// Name of the file.
    pub file: String,
    /// File format.
    pub format: SceneFormat,
    /// The world; `None` if no usable line names one.
    pub world: Option<WorldLine>,
    /// Display options of the window.
    pub settings: Settings,
    /// Files of robot types that lines load, in the order of the file.
    pub robot_types: Vec<SpannedText>,
    /// Files of object types that lines load, in the order of the file.
    pub object_types: Vec<SpannedText>,
    /// Robots of built-in types, and of types whose file is named in the robot's own line, in the order of the file.
    pub robots: Vec<RobotLine>,
    /// Objects of built-in types, and of types whose file is named in the object's own line, in the order of the file.
    pub objects: Vec<ObjectLine>,
    /// Robots and objects of types that other lines load, in the order of the file. The type's file determines whether
    /// a line places a robot or an object.
    pub named: Vec<RobotLine>,
    /// Markers in the order of the file.
    pub markers: Vec<MarkerSpec>,
    /// Descriptions within the scene; only in a scene in TOML.
    pub inline: InlineSpec,
    /// Run options; only in a scene in TOML.
    pub run: RunSpec,
    /// Radio model; only in a scene in TOML.
    pub radio: radio::RadioModel,
    /// Checks in the order of the file; only in a scene in TOML.
    pub checks: Vec<CheckSpec>,
    /// Faults in the order of the file; only in a scene in TOML.
    pub faults: Vec<FaultSpec>,
    /// Reachability requirements; only in a scene in TOML.
    pub reachable: Vec<ReachableSpec>,
    /// Values of the text that were drawn; only in a scene in TOML.
    pub drawn: Vec<Drawn>,
    /// Paths of the walls of an inline world, in the order of its walls.
    pub wall_paths: Vec<String>,
}

/// A robot of a scene, ready to be built.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSpec {
    /// Number from 1: the number that the scene sets, otherwise the next free number in the order of the file.
    pub id: RobotId,
    /// Type of the robot, shared by robots of one file.
    pub robi: Arc<RobiSpec>,
    /// Start pose of the robot's centre in the world frame.
    pub start: Pose,
    /// Program, not yet resolved; `None` for a robot without a program.
    pub program: Option<SpannedText>,
    /// Command-line arguments of the program.
    pub arguments: Vec<String>,
    /// Generation of the RoBIOS API for which the program is written, 6 or 7; `None` if the scene does not state it.
    pub api: Option<u32>,
    /// Noise profile of devices and drive: that of the robot's line, otherwise that of the scene. A profile in a file
    /// has been read.
    pub noise: Option<NoiseRef>,
    /// Generation of the RoBIOS API that corresponds to the dialect of the robot's line: 6 for `robi` lines, 7 for
    /// lines of EyeSim VR. In a scene in TOML, it is the generation of the scene's dialect.
    pub dialect: Option<u32>,
    /// Path of its line in a scene in TOML, such as `robot.2`; otherwise empty.
    pub line: String,
    /// Location of its line in the sim file.
    pub span: Span,
}

impl RobotSpec {
    /// Program as named in the scene; empty if there is none.
    pub fn program_name(&self) -> &str {
        self.program.as_ref().map_or("", |program| &program.text)
    }
}

/// A whole scene: a sim file and all files that it names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneSpec {
    /// Name of the sim file.
    pub file: String,
    /// Folder of the sim file, against which program references are resolved first; if empty, the working folder.
    pub folder: String,
    /// The world.
    pub world: WorldSpec,
    /// Robots in order of their ids. A robot whose line or robi is unusable is missing (and there is an error).
    pub robots: Vec<RobotSpec>,
    /// Objects of the world and of the sim file. An object whose type is unusable is missing (and there is a warning).
    pub objects: Vec<ObjectSpec>,
    /// Markers of the sim file.
    pub markers: Vec<MarkerSpec>,
    /// Display options of the window.
    pub settings: Settings,
    /// Run options. A cost table or noise profile in a file has been read.
    pub run: RunSpec,
    /// Radio model.
    pub radio: radio::RadioModel,
    /// Checks on a run of the scene, in the order of the file.
    pub checks: Vec<CheckSpec>,
    /// Injected faults, in the order of the file.
    pub faults: Vec<FaultSpec>,
    /// Values that were drawn from the seed, in the order of the file.
    pub drawn: Vec<Drawn>,
}
