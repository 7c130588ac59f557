//! Errors for options of a run that do not fit the scene, or whose files cannot be read.

use sim_format::PRESETS;

use crate::program::words::WordsError;
use crate::robios::cost::CostError;
use crate::robios::key::ScriptError;

/// An option of a run that does not fit the scene, or whose file cannot be read. The message names the option of the
/// command line, except for cost tables.
#[derive(Debug, thiserror::Error)]
pub enum OptionError {
    /// A script of key presses cannot be read.
    #[error("--keys: {0}")]
    Keys(ScriptError),
    /// An option names a robot that the scene does not have.
    #[error("{option}: {robot}")]
    UnknownRobot {
        /// The option, as on the command line.
        option: &'static str,
        /// The robot.
        robot: UnknownRobot,
    },
    /// Two options assign a program to one robot.
    #[error("--program: robot {robot} gets two programs")]
    TwoPrograms {
        /// Number of the robot.
        robot: u32,
    },
    /// Two options assign a program to all robots that have none.
    #[error("--program: only one program can be given for the robots that have none, not `{first}` and `{second}`")]
    TwoProgramsForAll {
        /// The first program.
        first: String,
        /// The second program.
        second: String,
    },
    /// A program is given for the robots that have none, but every robot has one.
    #[error("--program {program}: every robot has a program; `--program 1={program}` replaces that of robot 1")]
    UnneededProgram {
        /// The program.
        program: String,
    },
    /// A program is given for the robots with a certain program or type, but no robot has it.
    #[error("--program: no robot has a program or a type `{name}`: the scene has {known}")]
    UnknownName {
        /// Name of the program or type.
        name: String,
        /// The programs and types of the scene.
        known: String,
    },
    /// The arguments of a program cannot be split into words.
    #[error("--args {text}: {error}")]
    Words {
        /// The option's value.
        text: String,
        /// The error in it.
        error: WordsError,
    },
    /// Arguments are given for a robot without a program.
    #[error("--args: robot {robot} has no program: `--program {robot}=FILE` gives it one")]
    NoProgram {
        /// Number of the robot.
        robot: u32,
    },
    /// The noise profile is neither a preset nor a file.
    #[error("--noise: `{name}` is not a noise profile: expected one of {}, or a file NAME.toml", PRESETS.join(", "))]
    UnknownNoise {
        /// The option's value.
        name: String,
    },
    /// The cell size of a maze is given, but the scene's world is not a maze file.
    #[error("--maze-cell: the world of `{scene}` is not a maze file")]
    NoMazeFile {
        /// The scene.
        scene: String,
    },
    /// A function that an option names is unknown.
    #[error(
        "{option}: there is no function `{pattern}`{}",
        suggestion.as_ref().map(|name| format!(", did you mean `{name}`?")).unwrap_or_default()
    )]
    UnknownFunction {
        /// The option.
        option: &'static str,
        /// Name or pattern.
        pattern: String,
        /// Name or pattern that was probably meant.
        suggestion: Option<String>,
    },
    /// The text for standard input cannot be read.
    #[error("--stdin `{file}`: {error}")]
    Stdin {
        /// The option's value.
        file: String,
        /// The reason.
        error: std::io::Error,
    },
    /// The suite with further checks cannot be read.
    #[error("--checks `{file}`: {error}")]
    Checks {
        /// The option's value.
        file: String,
        /// The reason.
        error: std::io::Error,
    },
    /// A file with the costs of calls cannot be used.
    #[error("cost table `{file}`: {reason}")]
    Costs {
        /// The file.
        file: String,
        /// The reason.
        reason: CostFileError,
    },
    /// The costs in the scene cannot be used.
    #[error("cost table in `{file}`: {error}")]
    SceneCosts {
        /// The file with the table.
        file: String,
        /// The error in it.
        error: CostError,
    },
}

// The message contains that of the inner error. `#[from]` would also make the inner error the source, and error chains
// would then print it twice.
impl From<ScriptError> for OptionError {
    fn from(error: ScriptError) -> Self {
        Self::Keys(error)
    }
}

impl OptionError {
    /// Function for `map_err` that adds the name of `option` to an [`UnknownRobot`].
    pub(super) fn unknown_robot(option: &'static str) -> impl Fn(UnknownRobot) -> Self {
        move |robot| Self::UnknownRobot { option, robot }
    }
}

/// The scene has no robot with this number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no robot {robot}: the scene has {}", known_robots(*count))]
pub struct UnknownRobot {
    /// The number.
    pub robot: u32,
    /// Number of robots in the scene.
    pub count: usize,
}

/// Reasons why a file with costs cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum CostFileError {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// The file is not UTF-8 text.
    #[error(transparent)]
    Text(#[from] std::str::Utf8Error),
    /// The table has an error.
    #[error(transparent)]
    Table(#[from] CostError),
}

fn known_robots(count: usize) -> String {
    match count {
        0 => "no robots".to_owned(),
        1 => "only robot 1".to_owned(),
        count => format!("robots 1 to {count}"),
    }
}
