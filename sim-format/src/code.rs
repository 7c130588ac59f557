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

// Codes in alphabetical order. A new code needs its page, docs/formats/codes/CODE.md, otherwise compilation fails; the
// page's third line repeats the meaning, and tests/codes.rs runs its examples.
codes! {
    CheckBody = "check-body": "a check names a robot or an object that does not exist",
    CheckFunction = "check-function": "a check counts calls of an unknown function",
    CheckName = "check-name": "two checks with the same name",
    CheckProgram = "check-program": "the program of a check is missing or cannot be started",
    ConvertKind = "convert-kind": "a file that cannot be converted to the requested format",
    ConvertLost = "convert-lost": "the target format of a conversion cannot express something",
    ConvertMaze = "convert-maze": "a world that cannot be written as a maze",
    CostFunction = "cost-function": "a cost table names an unknown function",
    EsobjArity = "esobj-arity": "a keyword of an object file with a wrong number of values",
    EsobjColliderKind = "esobj-collider-kind": "a collider of an unknown shape or axis",
    EsobjColliderMissing = "esobj-collider-missing": "an object file without a collider",
    EsobjKeyword = "esobj-keyword": "an unknown keyword in an object file",
    EsobjMassMissing = "esobj-mass-missing": "an object file without a mass",
    FaultName = "fault-name": "two faults with the same name",
    FaultTarget = "fault-target": "a fault refers to something that does not exist",
    FileCase = "file-case": "a file name that differs from the file on disk in upper and lower case",
    FileEncoding = "file-encoding": "the file is not UTF-8",
    FileKind = "file-kind": "a file of another kind than expected, or of an unknown kind",
    FileMissing = "file-missing": "a file is not found",
    FileMore = "file-more": "the file has more mistakes than are listed",
    FileMoved = "file-moved": "a file is not found under its name; a similar one is used",
    FileNameMissing = "file-name-missing": "a file name is missing or empty",
    FileUnreadable = "file-unreadable": "a file exists but cannot be read",
    FolderEmpty = "folder-empty": "a folder without a file that eyesim reads",
    ForbidFunction = "forbid-function": "`forbid` names an unknown function",
    KeywordTwice = "keyword-twice": "a keyword that a file has at most once",
    LegDrive = "leg-drive": "legs on a robot with wheels, or a walking robot without legs",
    LegGait = "leg-gait": "a gait that does not fit the legs",
    LegReach = "leg-reach": "a leg that is too short or too long for the height of its hip",
    LinkCycle = "link-cycle": "a cycle of links: each is mounted on the next",
    LinkServo = "link-servo": "a link refers to a servo that the robot does not have",
    LinkTwice = "link-twice": "two links with the same name, or a link named `body`",
    LinkUnknown = "link-unknown": "a sensor or link is mounted on a link that does not exist",
    MapCell = "map-cell": "an unknown character in a map",
    MapImage = "map-image": "the image of a map cannot be read",
    MapKey = "map-key": "a key of a map is missing, unknown or without a usable value",
    MapSize = "map-size": "a map whose size differs from the stated one, or is too large",
    MazBlank = "maz-blank": "a blank line inside a maze",
    MazBorder = "maz-border": "the upper border of a maze is missing",
    MazBytes = "maz-bytes": "a binary maze with an unexpected size or layout",
    MazCellFirst = "maz-cell-first": "a cell size that some versions of EyeSim do not read",
    MazCellTwice = "maz-cell-twice": "two different cell sizes in one maze",
    MazEmpty = "maz-empty": "a maze file without a maze",
    MazGap = "maz-gap": "the border of a maze has a gap",
    MazIndent = "maz-indent": "a maze that is indented by an odd number of characters",
    MazLetter = "maz-letter": "an unknown character in a maze",
    MazLine = "maz-line": "a line that is not a row of a maze",
    MazNumbers = "maz-numbers": "a line that does not describe a cell of a numeric maze",
    MazPosts = "maz-posts": "a maze of posts and walls that is not regular",
    MazShared = "maz-shared": "the two cells beside a wall of a maze disagree about the wall",
    MazWallColumn = "maz-wall-column": "a `|` in the middle of a cell of a maze",
    MazWide = "maz-wide": "a maze whose cells are two characters wide",
    MeshEmpty = "mesh-empty": "a mesh file without a triangle",
    MeshFormat = "mesh-format": "a mesh format that is not supported",
    MeshIndex = "mesh-index": "a face of a mesh refers to a corner that does not exist",
    MeshLine = "mesh-line": "a line of a mesh that cannot be read",
    MeshMaterial = "mesh-material": "a mesh refers to a material that does not exist",
    MeshSize = "mesh-size": "a mesh or material file that is too large",
    MeshSolid = "mesh-solid": "a mesh that range sensors detect cannot be read",
    MtlLine = "mtl-line": "a line of a material file that cannot be read",
    NoiseEmpty = "noise-empty": "an empty noise profile",
    NoiseSensor = "noise-sensor": "a noise profile names a sensor that no robot has",
    NumberInvalid = "number-invalid": "a word where a number is expected",
    NumberRange = "number-range": "a number out of its range, infinite or NaN",
    ProgramGeneration = "program-generation": "a robot's program calls functions of both RoBIOS 6 and RoBIOS-7",
    ProgramMissing = "program-missing": "a robot's program is not found",
    QuoteUnclosed = "quote-unclosed": "a quotation mark is not closed",
    RobiAxelKind = "robi-axel-kind": "`axel` or `wheel` names neither the driven nor the steered axle",
    RobiAxelOrder = "robi-axel-order": "the steered axle is not ahead of the driven axle",
    RobiBodyMissing = "robi-body-missing": "a robot file of EyeSim VR with neither `diameter` nor `collider`",
    RobiCameraArity = "robi-camera-arity": "`camera` with a wrong number of values",
    RobiCameraMissing = "robi-camera-missing": "`fisheye` without a camera",
    RobiCameraServo = "robi-camera-servo": "an angle of the camera is neither a number nor a servo with its range",
    RobiColliderKind = "robi-collider-kind": "an unknown shape of a collider",
    RobiDeviceTwice = "robi-device-twice": "two devices of one kind with the same name or number",
    RobiDriveArity = "robi-drive-arity": "`drive` with a wrong number of devices",
    RobiDriveFirst = "robi-drive-first": "`drive` is not the first keyword of a robot file of EyeSim VR",
    RobiDriveKind = "robi-drive-kind": "an unknown kind of drive",
    RobiDriveMissing = "robi-drive-missing": "a robot file without a `drive` line",
    RobiKeyword = "robi-keyword": "an unknown keyword in a robot file",
    RobiNameMissing = "robi-name-missing": "`name` without a name",
    RobiNameReserved = "robi-name-reserved": "a robot file of EyeSim VR with the name of a built-in robot",
    RobiNumberMissing = "robi-number-missing": "a keyword of a robot file with too few numbers",
    RobiPsdArity = "robi-psd-arity": "`psd` with too few values",
    RobiPsdId = "robi-psd-id": "the number of a PSD is not an integer",
    RobiPsdName = "robi-psd-name": "the name of a PSD is a number",
    RobiPsdOrder = "robi-psd-order": "the PSDs of a robot file of EyeSim VR are not numbered 1, 2, 3 and so on",
    RobiPsdTurn = "robi-psd-turn": "a PSD that points out of the floor plane",
    RobiRange = "robi-range": "the minimum distance of a sensor is not below its maximum",
    RobiTrackWide = "robi-track-wide": "wheels outside the body in a robot file of EyeSim VR",
    RobiWheelArity = "robi-wheel-arity": "`wheel` with too few values",
    RobiWheelMissing = "robi-wheel-missing": "a robot file without a `wheel` line",
    RobotIdGap = "robot-id-gap": "a robot's number is greater than the number of robots",
    RobotIdTwice = "robot-id-twice": "two robots with the same number",
    ScenLength = "scen-length": "the length of a scenario differs from the shortest path",
    ScenLine = "scen-line": "a line of a scenario file that cannot be read",
    SceneCount = "scene-count": "more robots than a scene may have",
    SceneDraw = "scene-draw": "a random value that cannot be drawn",
    SceneName = "scene-name": "two robots or two objects of a scene have the same name",
    SceneReach = "scene-reach": "a place that must be reachable cannot be reached",
    SceneRoom = "scene-room": "a layout has no room for all its robots, objects or walls",
    SdfShape = "sdf-shape": "part of an SDF world is ignored or changed",
    SdfSyntax = "sdf-syntax": "a file that is not an SDF world",
    SetPath = "set-path": "a path that does not exist in the scene, or a value that cannot be read",
    SimKeyword = "sim-keyword": "an unknown keyword in a sim file",
    SimMarkerArity = "sim-marker-arity": "`marker` with a wrong number of values",
    SimObjectArity = "sim-object-arity": "`object` with a wrong number of values",
    SimObjectOutside = "sim-object-outside": "an object starts outside the floor",
    SimObjectOverlap = "sim-object-overlap": "an object starts inside a robot or another object",
    SimObjectShape = "sim-object-shape": "an object of unknown shape",
    SimObjectWall = "sim-object-wall": "an object starts inside a wall",
    SimPlaceArity = "sim-place-arity": "a line that places a robot or an object with too few values",
    SimRobiArity = "sim-robi-arity": "`robi` with a wrong number of values",
    SimRobotMissing = "sim-robot-missing": "a scene without a robot",
    SimSetting = "sim-setting": "an unknown word in `settings`",
    SimStartLetter = "sim-start-letter": "a start letter that the maze does not have",
    SimStartMissing = "sim-start-missing": "a robot without a start",
    SimStartOutside = "sim-start-outside": "a robot starts outside the floor",
    SimStartOverlap = "sim-start-overlap": "a robot starts inside another robot or an object",
    SimStartWall = "sim-start-wall": "a robot starts inside a wall",
    SimTypeBelow = "sim-type-below": "a type is used above the line that loads it",
    SimTypeCase = "sim-type-case": "the name of a type differs in upper and lower case",
    SimTypeTwice = "sim-type-twice": "two types with the same name, or a type with the name of a built-in type",
    SimTypeUnknown = "sim-type-unknown": "an unknown type",
    SimWorldMissing = "sim-world-missing": "a scene without a world",
    SimWorldTwice = "sim-world-twice": "a second world in one scene",
    SonarBus = "sonar-bus": "more sonars on a bus than the bus has addresses",
    SuiteAxis = "suite-axis": "a matrix refers to an unknown list or value, or joins lists of different lengths",
    SuiteCases = "suite-cases": "a suite with too many cases, or with none",
    SuiteParameter = "suite-parameter": "a parameter that no argument uses, or an argument with an unknown parameter",
    TerrainClear = "terrain-clear": "boulders of a terrain for which no free position was found",
    TerrainColour = "terrain-colour": "the image of a terrain is not grey",
    TerrainImage = "terrain-image": "the image of a terrain cannot be read",
    TerrainSize = "terrain-size": "a terrain with too few or too many cells",
    TerrainWheels = "terrain-wheels": "robots with wheels do not follow the terrain",
    TextureFormat = "texture-format": "an image in an unsupported format, or a broken image",
    TextureSize = "texture-size": "an image that is too large",
    TomlChoice = "toml-choice": "a word that is not one of the accepted words",
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
    WldWallArity = "wld-wall-arity": "the number of values of a wall is not 4, 6 or 9",
    WldWallLength = "wld-wall-length": "a wall whose ends are equal",
    WldWaterArity = "wld-water-arity": "`water` without its number",
    WldWidthArity = "wld-width-arity": "`width` without its number",
    WordExtra = "word-extra": "unexpected words at the end of a line",
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
