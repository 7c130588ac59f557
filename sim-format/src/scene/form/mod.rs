//! What a scene in TOML may hold, as types: they are what is printed, and the JSON schema that editors complete from.
//!
//! The reader does not go through them, since it reports all mistakes with their places; tests hold the two together.

mod body;
mod legs;
mod looks;
mod robot;
mod sensor;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::noise::form::NoiseForm;
pub(crate) use body::*;
pub(crate) use legs::*;
pub(crate) use looks::*;
pub(crate) use robot::*;
pub(crate) use sensor::*;

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
    /// What carries messages between robots.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) radio: Option<RadioForm>,
    /// Robot types: files, or described in place.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) robot_type: Vec<RobotTypeForm>,
    /// Object types: files, or described in place.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) object_type: Vec<ObjectTypeForm>,
    /// Robots, alone and in groups; those without an `id` are numbered 1, 2, ... in this order.
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
    /// A `.wld` or a `.maz`; no other key but `kind`, `colour`, `light` and `sky` then.
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
    /// Ground that is not the plane: sensors and cameras see it, legs walk on it; wheels drive on the plane all the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) terrain: Option<TerrainForm>,
    /// Red, green and blue of a floor without an image, 0 to 255.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) colour: Option<[u8; 3]>,
    /// The light that cameras see by.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) light: Option<LightForm>,
    /// What cameras see where nothing stands.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) sky: Option<SkyForm>,
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

/// What carries messages between robots.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RadioForm {
    /// How the robots share the medium; `free` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) medium: Option<MediumForm>,
    /// Bits a second, of which a byte takes ten; 115200 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000_000))]
    pub(crate) baud: Option<u32>,
    /// Time from the end of a transmission to its arrival in milliseconds, a multiple of 0.001; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 3_600_000.0))]
    pub(crate) latency_ms: Option<Number>,
    /// How far a message is heard in mm; everywhere if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 1e9))]
    pub(crate) range_mm: Option<Number>,
    /// Walls stop messages; false if left out.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub(crate) line_of_sight: bool,
}

/// How robots share the medium that carries their messages.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum MediumForm {
    /// Nobody disturbs anybody.
    #[allow(dead_code, reason = "the default is left out in print")]
    Free,
    /// Of messages that overlap at a receiver none is heard.
    Aloha,
    /// Who has the token sends.
    TokenRing,
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
    /// Its number, 1 to the number of robots; the next free one if left out. Not of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 100_000))]
    pub(crate) id: Option<u32>,
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
