//! Scenes: what a sim file or a scene in TOML says, and what it is once all its files are read.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec2;

use super::{LooksSpec, NoiseRef, ObjectType, PathRef, RobiSpec, WorldSpec};
use crate::RobotId;
use crate::pose::{Heading, Pose};
use crate::radio;
use crate::spec::Span;
use crate::time::Time;

/// A passive object as a line places it.
#[derive(Clone, Debug, Default, PartialEq)]
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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

impl Default for TypeRef {
    fn default() -> Self {
        Self::Name(PathRef::default())
    }
}

impl TypeRef {
    /// The file's or the type's name as written.
    pub fn written(&self) -> &PathRef {
        match self {
            TypeRef::File(reference) | TypeRef::Name(reference) => reference,
        }
    }
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
#[derive(Clone, Debug, PartialEq)]
pub struct WorldLine {
    /// World or maze.
    pub kind: WorldKind,
    /// The file.
    pub path: PathRef,
    /// What the scene says about the looks of the world; the file itself says nothing.
    pub looks: LooksSpec,
}

/// Where a robot of a scene starts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum StartRef {
    /// At the next start of the world that no robot before has taken.
    #[default]
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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Layout {
    /// Each at the next start of the world that no robot before has taken.
    #[default]
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

impl Layout {
    /// The pose of the robot at `index` of `count`; `None` for those layouts that need to know the world.
    pub fn pose(&self, index: u32, count: u32) -> Option<Pose> {
        let (place, heading) = match *self {
            Layout::Starts | Layout::Random { .. } => return None,
            Layout::Line { from, to, heading } => {
                let share = if count > 1 { f64::from(index) / f64::from(count - 1) } else { 0.0 };
                // Exactly `to` at the end, whatever rounding does.
                (if share == 1.0 { to } else { from + (to - from) * share }, heading)
            }
            Layout::Grid { from, spacing, columns, heading } => {
                let columns = columns.unwrap_or_else(|| smallest_square(count));
                let place = DVec2::new(f64::from(index % columns), f64::from(index / columns));
                (from + spacing * place, heading)
            }
            Layout::Circle { centre, radius, first, facing } => {
                let direction = first + TAU * f64::from(index) / f64::from(count.max(1));
                (centre + radius * Heading::new(direction).direction(), direction + facing)
            }
        };
        Some(Pose::new(place.x, place.y, heading))
    }
}

/// Side of the smallest square that holds `count`.
fn smallest_square(count: u32) -> u32 {
    let root = count.isqrt();
    (if root * root < count { root + 1 } else { root }).max(1)
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
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotLine {
    /// Its number where the scene gives it one; no other line has the same. Robots without take the free numbers from 1, in the
    /// order of the file. A group has none.
    pub id: Option<RobotId>,
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
    /// What carries messages between robots; only our own form says it.
    pub radio: radio::Model,
}

/// A robot of a scene, ready to be built.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSpec {
    /// Its number, from 1: the one that the scene gives it, else its place among the robots of the file.
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
    /// What carries messages between robots.
    pub radio: radio::Model,
}
