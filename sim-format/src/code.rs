//! Registry of diagnostic codes: one for every kind of mistake, each with a page in docs/formats/codes/.

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

/// Defines the enum of all codes from lines `Variant = "name": "meaning",`.
macro_rules! codes {
    ($($variant:ident = $name:literal: $meaning:literal,)+) => {
        /// Stable short name of a kind of mistake, such as `wld-wall-arity`; displayed and serialised as this text.
        ///
        /// Its page docs/formats/codes/CODE.md explains the meaning and the consequences and gives an example.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $(#[doc = $meaning] $variant,)+
        }

        impl Code {
            /// All codes, in alphabetical order.
            pub const ALL: &[Code] = &[$(Code::$variant),+];

            /// The code as text.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Code::$variant => $name,)+
                }
            }

            /// Page of the code in docs/formats/codes/, in Markdown: meaning, consequences, an example.
            pub const fn page(self) -> &'static str {
                match self {
                    $(Code::$variant => include_str!(concat!("../../docs/formats/codes/", $name, ".md")),)+
                }
            }

            /// Meaning of the code, in one line without a full stop.
            pub const fn meaning(self) -> &'static str {
                match self {
                    $(Code::$variant => $meaning,)+
                }
            }
        }
    };
}

// Codes in alphabetical order. A new code needs its page, docs/formats/codes/CODE.md, otherwise compilation fails; the page's third line
// repeats the meaning, and tests/codes.rs runs its examples.
codes! {
    CheckBody = "check-body": "a check names a robot or an object that there is not",
    CheckFunction = "check-function": "a check counts calls of a function that there is not",
    CheckName = "check-name": "two checks of one name",
    CheckProgram = "check-program": "the program of a check is missing or cannot be started",
    ConvertKind = "convert-kind": "a file that cannot become one of the kind asked for",
    ConvertLost = "convert-lost": "the target of a conversion has no place for something",
    ConvertMaze = "convert-maze": "a world that is no maze",
    CostFunction = "cost-function": "a cost table names a function that there is not",
    EsobjArity = "esobj-arity": "a keyword of an object file with a wrong number of values",
    EsobjColliderKind = "esobj-collider-kind": "a collider of an unknown shape or axis",
    EsobjColliderMissing = "esobj-collider-missing": "an object file without a collider",
    EsobjKeyword = "esobj-keyword": "an unknown keyword in an object file",
    EsobjMassMissing = "esobj-mass-missing": "an object file without a mass",
    FaultName = "fault-name": "two faults of one name",
    FaultTarget = "fault-target": "a fault concerns something that there is not",
    FileCase = "file-case": "a file is found only when upper and lower case are not told apart",
    FileEncoding = "file-encoding": "the file is not UTF-8",
    FileKind = "file-kind": "the name does not say which kind of file this is",
    FileMissing = "file-missing": "a file is not found",
    FileMore = "file-more": "the file has more mistakes than are listed",
    FileMoved = "file-moved": "an absolute path leads nowhere, but there is such a file near the one that mentions it",
    FileNameMissing = "file-name-missing": "a file name is missing or empty",
    FileUnreadable = "file-unreadable": "a file is there but cannot be read",
    FolderEmpty = "folder-empty": "a folder without a file that eyesim reads",
    ForbidFunction = "forbid-function": "`forbid` names a function that there is not",
    LegDrive = "leg-drive": "legs on a robot that drives on wheels, or none on one that is to walk",
    LegGait = "leg-gait": "a gait that does not fit the legs",
    LegReach = "leg-reach": "a leg that cannot stand with its hip at the height given",
    LinkCycle = "link-cycle": "links that hang on each other in a circle",
    LinkServo = "link-servo": "a link is turned by a servo that the robot has not",
    LinkTwice = "link-twice": "two links of one name, or a link named as the body",
    LinkUnknown = "link-unknown": "a sensor or link sits on a link that there is not",
    MapCell = "map-cell": "a character that means nothing in a map",
    MapImage = "map-image": "the image of a map cannot be read",
    MapKey = "map-key": "a key of a map is missing, unknown or without a usable value",
    MapSize = "map-size": "a map of another size than it states, or too large",
    MazBlank = "maz-blank": "a blank line inside a maze",
    MazBorder = "maz-border": "the upper border of a maze is missing",
    MazBytes = "maz-bytes": "a binary maze of another size or layout",
    MazCellFirst = "maz-cell-first": "a cell size that not every EyeSim reads",
    MazCellTwice = "maz-cell-twice": "two cell sizes that differ in one maze",
    MazEmpty = "maz-empty": "a maze file without a maze",
    MazGap = "maz-gap": "the border of a maze has a gap",
    MazIndent = "maz-indent": "a maze that is indented by an odd number of characters",
    MazLetter = "maz-letter": "a character that means nothing in a maze",
    MazLine = "maz-line": "a line that is no row of a maze",
    MazNumbers = "maz-numbers": "a line of a maze by numbers that is no cell",
    MazPosts = "maz-posts": "a maze of posts and walls that is not regular",
    MazShared = "maz-shared": "a wall of a maze that only one of its two cells has",
    MazWallColumn = "maz-wall-column": "a `|` in the middle of a cell of a maze",
    MazWide = "maz-wide": "a maze whose cells are two characters wide",
    MeshEmpty = "mesh-empty": "a mesh file without a triangle",
    MeshFormat = "mesh-format": "a mesh of a kind that is not read",
    MeshIndex = "mesh-index": "a face of a mesh names a corner that is not there",
    MeshLine = "mesh-line": "a line of a mesh that cannot be read",
    MeshMaterial = "mesh-material": "a mesh names a material that is not there",
    MeshSize = "mesh-size": "a mesh or material file that is too large",
    MeshSolid = "mesh-solid": "range sensors are to see a mesh that cannot be read",
    MtlLine = "mtl-line": "a line of a material file that cannot be read",
    NoiseEmpty = "noise-empty": "a noise profile in which nothing is written",
    NoiseSensor = "noise-sensor": "a noise profile names a sensor that no robot has",
    NumberInvalid = "number-invalid": "a word where a number is expected",
    NumberRange = "number-range": "a number out of its range, infinite or NaN",
    ProgramGeneration = "program-generation": "a robot's program calls functions of two generations of RoBIOS",
    ProgramMissing = "program-missing": "a robot's program is not found",
    QuoteUnclosed = "quote-unclosed": "a quotation mark is not closed",
    RobiAxelKind = "robi-axel-kind": "`axel` or `wheel` names neither the axle that drives nor the one that turns",
    RobiAxelOrder = "robi-axel-order": "the axle that turns is not ahead of the one that drives",
    RobiBodyMissing = "robi-body-missing": "a file of EyeSim VR with neither `diameter` nor `collider`",
    RobiCameraArity = "robi-camera-arity": "`camera` with a wrong number of values",
    RobiCameraMissing = "robi-camera-missing": "`fisheye` without a camera",
    RobiCameraServo = "robi-camera-servo": "an angle of the camera is neither a number nor a servo with its range",
    RobiColliderKind = "robi-collider-kind": "an unknown shape of a collider",
    RobiDeviceTwice = "robi-device-twice": "two devices of one kind with the same name or number",
    RobiDriveArity = "robi-drive-arity": "`drive` with a wrong number of devices",
    RobiDriveFirst = "robi-drive-first": "`drive` is not the first keyword of a file of EyeSim VR",
    RobiDriveKind = "robi-drive-kind": "an unknown kind of drive",
    RobiDriveMissing = "robi-drive-missing": "a robot file without a `drive` line",
    RobiKeyword = "robi-keyword": "an unknown keyword in a robot file",
    RobiNameMissing = "robi-name-missing": "`name` without a name",
    RobiNameReserved = "robi-name-reserved": "the name of a built-in robot in a file of EyeSim VR",
    RobiNumberMissing = "robi-number-missing": "a keyword of a robot file with too few numbers",
    RobiPsdArity = "robi-psd-arity": "`psd` with too few values",
    RobiPsdId = "robi-psd-id": "the number of a PSD is no integer",
    RobiPsdName = "robi-psd-name": "the name of a PSD is a number",
    RobiPsdOrder = "robi-psd-order": "the PSDs of a file of EyeSim VR are not numbered 1, 2, 3 and so on",
    RobiPsdTurn = "robi-psd-turn": "a turn of a PSD out of the floor plane",
    RobiRange = "robi-range": "the least distance of a sensor is not below its greatest",
    RobiTrackWide = "robi-track-wide": "in a file of EyeSim VR the wheels would stand outside the body",
    RobiWheelArity = "robi-wheel-arity": "`wheel` with too few values",
    RobiWheelMissing = "robi-wheel-missing": "a robot file without a `wheel` line",
    RobotIdGap = "robot-id-gap": "a robot's number is greater than the number of robots",
    RobotIdTwice = "robot-id-twice": "two robots of one number",
    ScenLength = "scen-length": "a scenario whose length is not that of a shortest path",
    ScenLine = "scen-line": "a line of scenarios that cannot be read",
    SceneCount = "scene-count": "more robots than a scene may have",
    SceneDraw = "scene-draw": "a random value that cannot be drawn",
    SceneName = "scene-name": "two robots or two objects of a scene have one name",
    SceneReach = "scene-reach": "a place of a scene that must be reachable is not",
    SceneRoom = "scene-room": "a layout has no room for all its robots, objects or walls",
    SdfShape = "sdf-shape": "something of an SDF world that is left out or changed",
    SdfSyntax = "sdf-syntax": "a file that is no SDF world",
    SetPath = "set-path": "a setting whose path leads nowhere in a scene, or whose value cannot be read",
    SimKeyword = "sim-keyword": "an unknown keyword in a sim file",
    SimMarkerArity = "sim-marker-arity": "`marker` with a wrong number of values",
    SimObjectArity = "sim-object-arity": "`object` with a wrong number of values",
    SimObjectOutside = "sim-object-outside": "an object starts outside the floor",
    SimObjectOverlap = "sim-object-overlap": "an object starts inside a robot or another object",
    SimObjectShape = "sim-object-shape": "the shape of an object is not known",
    SimObjectWall = "sim-object-wall": "an object starts inside a wall",
    SimPlaceArity = "sim-place-arity": "a line that places a robot or an object with too few values",
    SimRobiArity = "sim-robi-arity": "`robi` with a wrong number of values",
    SimRobotMissing = "sim-robot-missing": "a scene without a robot",
    SimSetting = "sim-setting": "an unknown word in `settings`",
    SimStartLetter = "sim-start-letter": "a start letter that the maze has not",
    SimStartMissing = "sim-start-missing": "a robot without a start",
    SimStartOutside = "sim-start-outside": "a robot starts outside the floor",
    SimStartOverlap = "sim-start-overlap": "a robot starts inside another robot or an object",
    SimStartWall = "sim-start-wall": "a robot starts inside a wall",
    SimTypeBelow = "sim-type-below": "a type is loaded only below the line that uses it",
    SimTypeCase = "sim-type-case": "the name of a type is written in another case",
    SimTypeTwice = "sim-type-twice": "two types of one name, or a type of a built-in name",
    SimTypeUnknown = "sim-type-unknown": "the name of a type that is not loaded",
    SimWorldMissing = "sim-world-missing": "a scene without a world",
    SimWorldTwice = "sim-world-twice": "a second world in one scene",
    SonarBus = "sonar-bus": "more sonars on a bus than it has addresses",
    SuiteAxis = "suite-axis": "a matrix names a list that there is not, or joins lists that do not fit",
    SuiteCases = "suite-cases": "a suite with too many cases, or with none",
    SuiteParameter = "suite-parameter": "a parameter of a matrix that no argument uses, or the other way round",
    TerrainClear = "terrain-clear": "boulders of a terrain find no place",
    TerrainColour = "terrain-colour": "the image of a terrain has colours",
    TerrainImage = "terrain-image": "the image of a terrain cannot be read",
    TerrainSize = "terrain-size": "a terrain with too few or too many places",
    TerrainWheels = "terrain-wheels": "wheels do not follow a terrain",
    TextureFormat = "texture-format": "an image of a kind that is not read, or a broken one",
    TextureSize = "texture-size": "an image that is too large",
    TomlChoice = "toml-choice": "a word that is none of those a key may have",
    TomlConflict = "toml-conflict": "two keys that exclude each other",
    TomlKey = "toml-key": "an unknown key in a TOML file",
    TomlMissing = "toml-missing": "a required key is missing in a TOML file",
    TomlSyntax = "toml-syntax": "a file that is not TOML",
    TomlType = "toml-type": "a value of the wrong type in a TOML file",
    WaterMissing = "water-missing": "a robot with thrusters has no water, or too little",
    WldFloorArity = "wld-floor-arity": "`floor` with too few numbers",
    WldFloorMissing = "wld-floor-missing": "a world without the size of its floor",
    WldHeightArity = "wld-height-arity": "`height` without its number",
    WldKeyword = "wld-keyword": "an unknown keyword in a world",
    WldPopEmpty = "wld-pop-empty": "`pop` without an open `push`",
    WldPositionArity = "wld-position-arity": "`position` with too few numbers",
    WldPushArity = "wld-push-arity": "`push` with too few numbers",
    WldWallArity = "wld-wall-arity": "a wall of neither 4, 6 nor 9 numbers",
    WldWallLength = "wld-wall-length": "a wall whose ends are equal",
    WldWaterArity = "wld-water-arity": "`water` without its number",
    WldWidthArity = "wld-width-arity": "`width` without its number",
    WordExtra = "word-extra": "a word too many in a line",
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl Serialize for Code {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Error for a name that no code has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no code `{name}`{}", .nearest.map(|code| format!(", but there is `{code}`")).unwrap_or_default())]
pub struct UnknownCode {
    /// Name that was looked up.
    pub name: String,
    /// Code with the most similar name.
    pub nearest: Option<Code>,
}

impl FromStr for Code {
    type Err = UnknownCode;

    fn from_str(name: &str) -> Result<Self, UnknownCode> {
        let find = |name: &str| Code::ALL.iter().copied().find(|code| code.name() == name);
        find(name).ok_or_else(|| {
            let nearest = super::line::nearest(name, Code::ALL.iter().map(|code| code.name())).and_then(find);
            UnknownCode { name: name.to_owned(), nearest }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_sorted_and_well_formed() {
        assert!(Code::ALL.windows(2).all(|pair| pair[0].name() < pair[1].name()), "sort the list");
        for code in Code::ALL {
            let name = code.name();
            assert!(name.chars().all(|c| c == '-' || c.is_ascii_lowercase()) && name.contains('-'), "{name}");
            assert!(!code.meaning().ends_with('.') && !code.meaning().contains('\n'), "{name}");
            assert_eq!(name.replace('-', ""), format!("{code:?}").to_lowercase(), "the variant says the same");
        }
    }

    #[test]
    fn codes_are_found_by_name() {
        assert!(Code::ALL.iter().all(|code| code.name().parse() == Ok(*code)));
        let error = "wld-wall-arty".parse::<Code>().expect_err("misspelt");
        assert_eq!(error.to_string(), "there is no code `wld-wall-arty`, but there is `wld-wall-arity`");
        assert_eq!("banana".parse::<Code>().expect_err("no code").to_string(), "there is no code `banana`");
    }
}
