//! Settings of a run: the options combined with the scene.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Read as _;
use std::path::Path;

use sim_core::simulation::DEFAULT_SLOT;
use sim_core::spec::{CostsRef, NoiseRef, Preset, RobotSpec, SceneSpec};
use sim_core::time::Time;
use sim_format::{InputFile, Loaded, load_noise, preset, unknown_sensors};

use super::Options;
use super::option_error::{CostFileError, OptionError, UnknownRobot};
use crate::files::{DiskFiles, read_regular, slashed};
use crate::program::Generation;
use crate::program::scene::program_of_command_line;
use crate::program::words::split_words;
use crate::robios::cost::Costs;
use crate::robios::forbidden::{self, Forbidden};
use crate::robios::input::Source;
use crate::robios::key::{Press, parse_script};

/// Value of `--stdin` for lines that the user types.
pub const TYPED: &str = "typed";

/// Settings of a run from its scene and options; the options take precedence.
pub struct Settings {
    /// Seed of all randomness.
    pub seed: u64,
    /// Length of a slot.
    pub slot: Time,
    /// Virtual time at which the run ends.
    pub until: Time,
    /// True if neither the scene nor the options set `until`.
    pub is_until_default: bool,
    /// Key presses.
    pub keys: Vec<Press>,
    /// Costs of calls.
    pub costs: Costs,
    /// File with the costs, if the options name one.
    pub costs_input: Option<InputFile>,
    /// Functions that programs must not call.
    pub forbidden: Forbidden,
    /// Standard input of the programs.
    pub stdin: Source,
    /// File with the standard input, if it is a file.
    pub stdin_input: Option<InputFile>,
}

impl Settings {
    /// Computes the settings of a run of `scene`, and assigns the programs and arguments of `options` to its robots.
    ///
    /// # Errors
    /// A robot or a forbidden function does not exist; keys, arguments, costs or standard input cannot be read; or the
    /// programs of the options do not fit the robots.
    pub fn new(options: &Options, scene: &mut SceneSpec) -> Result<Self, OptionError> {
        let mut keys = Vec::new();
        for script in &options.keys {
            keys.extend(parse_script(script)?);
        }
        for press in &keys {
            press
                .robot
                .map_or(Ok(0), |robot| index_of(scene, robot.0))
                .map_err(OptionError::unknown_robot("--keys"))?;
        }
        assign_programs(scene, &options.programs)?;
        scene.robots.iter_mut().for_each(|robot| robot.api = options.api.map(Generation::number).or(robot.api));
        assign_arguments(scene, &options.arguments)?;
        let (costs, costs_input) = match &options.costs {
            Some(path) => read_costs(path)?,
            None => (scene_costs(scene)?, None),
        };
        if let Some((pattern, suggestion)) = options.forbid.iter().flat_map(|text| forbidden::mistakes(text)).next() {
            return Err(OptionError::UnknownFunction { option: "--forbid", pattern, suggestion });
        }
        let scene_patterns = scene.run.forbid.iter().map(|pattern| pattern.text.as_str());
        let forbidden = Forbidden::new(scene_patterns.chain(options.forbid.iter().map(String::as_str)));
        let (stdin, stdin_input) = options.stdin.as_deref().map(read_stdin).transpose()?.unzip();
        let run = &scene.run;
        let until = options.until.or(run.until);
        Ok(Self {
            seed: options.seed.or(run.seed).unwrap_or_default(),
            slot: options.slot.or(run.slot).unwrap_or(DEFAULT_SLOT),
            until: until.unwrap_or(options.default_until),
            is_until_default: until.is_none(),
            keys,
            costs,
            costs_input,
            forbidden,
            stdin: stdin.unwrap_or_default(),
            stdin_input: stdin_input.flatten(),
        })
    }
}

/// Option that assigns a program to robots of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramOption {
    selector: RobotSelector,
    /// Reference to the program, as in a sim file.
    program: String,
}

/// Robots that get the program.
#[derive(Clone, Debug, PartialEq, Eq)]
enum RobotSelector {
    /// All robots without a program.
    WithoutProgram,
    /// One robot.
    Robot(u32),
    /// All robots whose program in the scene has this name; if there are none, all robots of the type with this name.
    Name(String),
}

impl ProgramOption {
    /// Parses `2=maze.c`, `search.x=maze.c` or `maze.c`.
    ///
    /// # Errors
    /// The text does not name a program.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (selector, program) = match (split_robot(text, '='), text.split_once('=')) {
            ((Some(robot), program), _) => (RobotSelector::Robot(robot), program),
            (_, Some((name, program))) if !name.trim().is_empty() => {
                (RobotSelector::Name(name.trim().to_owned()), program)
            }
            (_, Some((_, program))) => (RobotSelector::WithoutProgram, program),
            _ => (RobotSelector::WithoutProgram, text),
        };
        if program.trim().is_empty() {
            return Err(
                "expected a program, such as `maze.c`; `2=maze.c` is that of robot 2, `search.x=maze.c` that of \
                        all robots whose program is `search.x`"
                    .into(),
            );
        }
        Ok(Self { selector, program: program.to_owned() })
    }

    /// Reference to the program, as in a sim file.
    pub fn program(&self) -> &str {
        &self.program
    }

    /// The option with another program for the same robots.
    pub fn with_program(&self, program: &str) -> Self {
        Self { program: program.to_owned(), ..self.clone() }
    }

    /// Returns true if both options select robots by the same number or name, or both select the robots without a
    /// program.
    pub fn selects_same_robots(&self, other: &Self) -> bool {
        self.selector == other.selector
    }
}

impl std::fmt::Display for ProgramOption {
    /// Writes the option in the syntax of the command line.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.selector {
            RobotSelector::WithoutProgram if self.program.contains('=') => write!(f, "={}", self.program),
            RobotSelector::WithoutProgram => f.write_str(&self.program),
            RobotSelector::Robot(robot) => write!(f, "{robot}={}", self.program),
            RobotSelector::Name(name) => write!(f, "{name}={}", self.program),
        }
    }
}

/// Assigns the programs of the command line to the robots of `scene`. An option with a robot's number takes precedence
/// over one with the name of a program, and an option with the name of a program over one with the name of a type.
///
/// # Errors
/// An option matches no robot, or two options of equal precedence match one robot.
pub fn assign_programs(scene: &mut SceneSpec, options: &[ProgramOption]) -> Result<(), OptionError> {
    let mut by_robot: BTreeMap<usize, (Precedence, &str)> = BTreeMap::new();
    for option in options {
        let (precedence, robots) = select_robots(scene, &option.selector)?;
        for index in robots {
            let previous = by_robot.get(&index).filter(|(previous, _)| *previous >= precedence);
            if previous.is_some_and(|(previous, _)| *previous == precedence) {
                return Err(OptionError::TwoPrograms { robot: scene.robots[index].id.0 });
            }
            if previous.is_none() {
                by_robot.insert(index, (precedence, &option.program));
            }
        }
    }
    let mut unselective = options.iter().filter(|option| option.selector == RobotSelector::WithoutProgram);
    if let Some(option) = unselective.next() {
        if let Some(second) = unselective.next() {
            let (first, second) = (option.program.clone(), second.program.clone());
            return Err(OptionError::TwoProgramsForAll { first, second });
        }
        let has_no_program = |index: &usize| scene.robots[*index].program.is_none() && !by_robot.contains_key(index);
        let robots: Vec<usize> = (0..scene.robots.len()).filter(has_no_program).collect();
        if robots.is_empty() {
            return Err(OptionError::UnneededProgram { program: option.program.clone() });
        }
        by_robot.extend(robots.into_iter().map(|index| (index, (Precedence::Type, option.program.as_str()))));
    }
    for (index, (_, program)) in by_robot {
        scene.robots[index].program = Some(program_of_command_line(program));
    }
    Ok(())
}

/// Removes the programs of `robots`, which are selected as in options `--program`.
///
/// # Errors
/// The scene has no such robots.
pub fn remove_programs<'r>(scene: &mut SceneSpec, robots: impl Iterator<Item = &'r str>) -> Result<(), OptionError> {
    // A name that no file can have.
    const REMOVED: &str = "\0removed";
    let removal_option = |robots: &str| {
        let named = ProgramOption::parse(&format!("{robots}={REMOVED}")).ok();
        named.unwrap_or(ProgramOption { selector: RobotSelector::WithoutProgram, program: REMOVED.to_owned() })
    };
    let options: Vec<ProgramOption> = robots.map(removal_option).collect();
    assign_programs(scene, &options)?;
    for robot in &mut scene.robots {
        robot.program = robot.program.take().filter(|program| program.text != REMOVED);
    }
    Ok(())
}

/// Sets the noise profile `name` of the command line for all robots of a scene: a preset or a file. Mistakes in the
/// file are added to the scene's diagnostics.
///
/// # Errors
/// `name` is neither a preset nor a file.
pub fn assign_noise(loaded: &mut Loaded, name: &str, files: &mut DiskFiles) -> Result<(), OptionError> {
    let noise = match preset(name) {
        Some(preset) => NoiseRef::Preset(preset),
        None => {
            let path = Path::new(name);
            let is_file = path.extension().is_some_and(|it| it.eq_ignore_ascii_case("toml")) || path.exists();
            if !is_file {
                return Err(OptionError::UnknownNoise { name: name.to_owned() });
            }
            let (noise, read) = load_noise(&files.name(path), files);
            loaded.diagnostics.extend(read.diagnostics);
            // The scene may name the same file.
            let is_unknown = |input: &InputFile| loaded.inputs.iter().all(|other| other.path != input.path);
            let new: Vec<InputFile> = read.inputs.into_iter().filter(is_unknown).collect();
            loaded.inputs.extend(new);
            noise.unwrap_or(NoiseRef::Preset(Preset::default()))
        }
    };
    let robots = &mut loaded.scene.robots;
    robots.iter_mut().for_each(|robot| robot.noise = Some(noise.clone()));
    loaded.scene.run.noise = Some(noise);
    loaded.diagnostics.extend(unknown_sensors(&loaded.scene.robots));
    Ok(())
}

/// Precedence of an option by the way in which it selects a robot, lowest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Precedence {
    Type,
    Program,
    Number,
}

/// Indices in the scene of the robots that `selector` names; empty for [`RobotSelector::WithoutProgram`], which
/// [`assign_programs`] handles.
fn select_robots(scene: &SceneSpec, selector: &RobotSelector) -> Result<(Precedence, Vec<usize>), OptionError> {
    match selector {
        RobotSelector::WithoutProgram => Ok((Precedence::Type, Vec::new())),
        RobotSelector::Robot(robot) => {
            Ok((Precedence::Number, vec![index_of(scene, *robot).map_err(OptionError::unknown_robot("--program"))?]))
        }
        RobotSelector::Name(name) => {
            let matching_robots = |matches_name: &dyn Fn(&RobotSpec) -> bool| -> Vec<usize> {
                (0..scene.robots.len()).filter(|index| matches_name(&scene.robots[*index])).collect()
            };
            let by_program = matching_robots(&|robot| names_of_file(robot.program_name()).any(|other| other == name));
            if !by_program.is_empty() {
                return Ok((Precedence::Program, by_program));
            }
            let by_type = matching_robots(&|robot| {
                robot.robi.name == *name || names_of_file(&robot.robi.file).any(|other| other == name)
            });
            if by_type.is_empty() {
                return Err(OptionError::UnknownName { name: name.clone(), known: available_names(scene) });
            }
            Ok((Precedence::Type, by_type))
        }
    }
}

/// Names that an option may use for a file: as written, without folder, or without folder and extension. Sim files
/// contain paths in the syntax of Windows or of Unix.
fn names_of_file(path: &str) -> impl Iterator<Item = &str> {
    let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
    let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    [path, file, stem].into_iter().filter(|name| !name.is_empty())
}

/// The programs and types of a scene, each once, for a message.
fn available_names(scene: &SceneSpec) -> String {
    let list = |names: BTreeSet<&str>| names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let programs: BTreeSet<&str> =
        scene.robots.iter().map(RobotSpec::program_name).filter(|name| !name.is_empty()).collect();
    let types: BTreeSet<&str> = scene.robots.iter().map(|robot| robot.robi.name.as_str()).collect();
    match (programs.is_empty(), types.is_empty()) {
        (_, true) => "no robots".to_owned(),
        (true, false) => format!("no programs, and the types {}", list(types)),
        (false, false) => format!("the programs {} and the types {}", list(programs), list(types)),
    }
}

/// Replaces the arguments of the robots that `options` name. Several options for one robot are concatenated.
fn assign_arguments(scene: &mut SceneSpec, options: &[String]) -> Result<(), OptionError> {
    let mut replaced = vec![false; scene.robots.len()];
    for text in options {
        let (robot, words) = split_robot(text, ':');
        let words = split_words(words).map_err(|error| OptionError::Words { text: text.clone(), error })?;
        let robots = match robot {
            Some(robot) => {
                let index = index_of(scene, robot).map_err(OptionError::unknown_robot("--args"))?;
                if scene.robots[index].program.is_none() {
                    return Err(OptionError::NoProgram { robot });
                }
                index..index + 1
            }
            None => 0..scene.robots.len(),
        };
        for index in robots {
            let arguments = &mut scene.robots[index].arguments;
            if !std::mem::replace(&mut replaced[index], true) {
                arguments.clear();
            }
            arguments.extend(words.iter().cloned());
        }
    }
    Ok(())
}

/// Index of robot `robot` in the scene.
///
/// # Errors
/// The scene has no robot with this number.
pub fn index_of(scene: &SceneSpec, robot: u32) -> Result<usize, UnknownRobot> {
    let index = scene.robots.iter().position(|spec| spec.id.0 == robot);
    index.ok_or(UnknownRobot { robot, count: scene.robots.len() })
}

/// Splits `text` into the robot's number before `separator`, if there is one, and the rest.
fn split_robot(text: &str, separator: char) -> (Option<u32>, &str) {
    let split = || {
        let (robot, rest) = text.split_once(separator)?;
        let digits = robot.trim().strip_prefix(['r', 'R']).unwrap_or(robot.trim());
        Some((digits.parse().ok()?, rest))
    };
    split().map_or((None, text), |(robot, rest)| (Some(robot), rest))
}

fn read_costs(path: &Path) -> Result<(Costs, Option<InputFile>), OptionError> {
    let costs_error = |reason: CostFileError| OptionError::Costs { file: path.display().to_string(), reason };
    let bytes = read_regular(path).map_err(|error| costs_error(error.into()))?;
    let text = std::str::from_utf8(&bytes).map_err(|error| costs_error(error.into()))?;
    let costs = Costs::with(text).map_err(|error| costs_error(error.into()))?;
    Ok((costs, Some(InputFile { path: slashed(path), bytes })))
}

/// Standard input of the programs for the option `path`: the lines that the user types for `typed`, this process's
/// standard input, read to its end, for `-`, and otherwise the text of the file, which is returned too.
fn read_stdin(path: &Path) -> Result<(Source, Option<InputFile>), OptionError> {
    if path.as_os_str() == TYPED {
        return Ok((Source::Typed, None));
    }
    let stdin_error = |error| OptionError::Stdin { file: path.display().to_string(), error };
    if path.as_os_str() == "-" {
        let mut bytes = Vec::new();
        std::io::stdin().lock().read_to_end(&mut bytes).map_err(stdin_error)?;
        return Ok((Source::Text(bytes.into()), None));
    }
    let bytes = read_regular(path).map_err(stdin_error)?;
    Ok((Source::Text(bytes.as_slice().into()), Some(InputFile { path: slashed(path), bytes })))
}

/// The costs given by the scene, with the built-in costs for all other calls.
fn scene_costs(scene: &SceneSpec) -> Result<Costs, OptionError> {
    let Some(CostsRef::Table(table)) = &scene.run.costs else { return Ok(Costs::default()) };
    Costs::of_table(table).map_err(|error| OptionError::SceneCosts { file: table.file.clone(), error })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use sim_core::RobotId;
    use sim_core::pose::Pose;
    use sim_core::spec::{Span, SpannedText};
    use sim_format::read_robi;

    use super::*;

    const SCENE_ARGUMENTS: [&str; 2] = ["--own", "1"];

    /// Three robots, of which the first has a program with arguments.
    fn scene() -> SceneSpec {
        let robi = Arc::new(read_robi("r.robi", "").0);
        let span = Span { start: 0, end: 1, line: 3, column: 1 };
        let robot = |index| RobotSpec {
            id: RobotId::from_index(index),
            robi: Arc::clone(&robi),
            start: Pose::new(0.0, 0.0, 0.0),
            program: (index == 0).then(|| SpannedText { text: "own.c".into(), span }),
            arguments: if index == 0 { SCENE_ARGUMENTS.map(str::to_owned).to_vec() } else { Vec::new() },
            api: None,
            noise: None,
            dialect: None,
            line: String::new(),
            span,
        };
        SceneSpec { robots: (0..3).map(robot).collect(), ..SceneSpec::default() }
    }

    fn programs(options: &[&str]) -> Result<Vec<String>, String> {
        let mut scene = scene();
        let options: Vec<_> = options.iter().map(|text| ProgramOption::parse(text).expect("a program")).collect();
        assign_programs(&mut scene, &options).map_err(|error| error.to_string())?;
        Ok(scene.robots.iter().map(|robot| robot.program_name().to_owned()).collect())
    }

    fn arguments(options: &[&str]) -> Result<Vec<Vec<String>>, String> {
        let mut scene = scene();
        scene.robots[1].program = Some(program_of_command_line("b.c"));
        let options: Vec<String> = options.iter().map(|&text| text.to_owned()).collect();
        assign_arguments(&mut scene, &options).map_err(|error| error.to_string())?;
        Ok(scene.robots.into_iter().map(|robot| robot.arguments).collect())
    }

    #[test]
    fn programs_are_assigned_to_robots_without_one_and_by_number() {
        assert_eq!(programs(&["x.c"]).unwrap(), ["own.c", "x.c", "x.c"]);
        assert_eq!(programs(&["1=x.c"]).unwrap(), ["x.c", "", ""]);
        assert_eq!(programs(&["y.c", "r3=x.c"]).unwrap(), ["own.c", "y.c", "x.c"]);
        assert_eq!(programs(&["=./2=x.c"]).unwrap(), ["own.c", "./2=x.c", "./2=x.c"], "a file of that name");
    }

    #[test]
    fn programs_are_assigned_by_program_or_type_name() {
        let mut scene = scene();
        scene.robots[1].program = Some(program_of_command_line(r"..\Progs\maze.x"));
        scene.robots[2].program = Some(program_of_command_line("progs/maze.x"));
        let programs = |options: &[&str]| {
            let mut scene = scene.clone();
            let options: Vec<_> = options.iter().map(|text| ProgramOption::parse(text).expect("a program")).collect();
            assign_programs(&mut scene, &options).map_err(|error| error.to_string())?;
            Ok::<_, String>(scene.robots.iter().map(|robot| robot.program_name().to_owned()).collect::<Vec<_>>())
        };
        for name in ["maze", "maze.x"] {
            assert_eq!(programs(&[&format!("{name}=x.c")]).unwrap(), ["own.c", "x.c", "x.c"], "{name}");
        }
        assert_eq!(programs(&["progs/maze.x=x.c"]).unwrap(), ["own.c", r"..\Progs\maze.x", "x.c"]);
        assert_eq!(programs(&["r=x.c"]).unwrap(), ["x.c", "x.c", "x.c"], "a type");
        // In any order: number before program before type.
        for options in [["r=t.c", "maze=p.c", "3=n.c"], ["3=n.c", "maze=p.c", "r=t.c"]] {
            assert_eq!(programs(&options).unwrap(), ["t.c", "p.c", "n.c"]);
        }
        assert_eq!(programs(&["maze=x.c", "maze.x=y.c"]).unwrap_err(), "--program: robot 2 gets two programs");
        assert_eq!(
            programs(&["labyrinth=x.c"]).unwrap_err(),
            "--program: no robot has a program or a type `labyrinth`: the scene has the programs `..\\Progs\\maze.x`, \
             `own.c`, `progs/maze.x` and the types `r`"
        );
    }

    #[test]
    fn programs_that_match_no_robot_are_rejected() {
        let error = |options: &[&str]| programs(options).expect_err("refused");
        assert_eq!(error(&["4=x.c"]), "--program: there is no robot 4: the scene has robots 1 to 3");
        assert_eq!(error(&["2=x.c", "2=y.c"]), "--program: robot 2 gets two programs");
        assert!(error(&["x.c", "y.c"]).contains("not `x.c` and `y.c`"));
        let mut empty = SceneSpec::default();
        let option = ProgramOption::parse("1=x.c").expect("a program");
        let error_of_empty = assign_programs(&mut empty, &[option]).expect_err("refused");
        assert_eq!(format!("{error_of_empty:#}"), "--program: there is no robot 1: the scene has no robots");
        assert!(error(&["2=x.c", "3=x.c", "z.c"]).contains("every robot has a program; `--program 1=z.c` replaces"));
        assert!(ProgramOption::parse("2=").unwrap_err().contains("expected a program"));
    }

    #[test]
    fn arguments_replace_those_of_the_scene() {
        assert_eq!(arguments(&[]).unwrap(), [&SCENE_ARGUMENTS[..], &[], &[]]);
        assert_eq!(arguments(&["1:a 'b c'", "1:d"]).unwrap(), [&["a", "b c", "d"][..], &[], &[]]);
        assert_eq!(arguments(&["2:a"]).unwrap(), [&SCENE_ARGUMENTS[..], &["a"], &[]]);
        assert_eq!(arguments(&["x", "2:y"]).unwrap(), [&["x"][..], &["x", "y"], &["x"]]);
        assert_eq!(arguments(&["1:"]).unwrap(), [const { &[] as &[&str] }; 3]);
    }

    #[test]
    fn arguments_that_match_no_robot_are_rejected() {
        let error = arguments(&["3:a"]).expect_err("robot 3 has no program");
        assert_eq!(error, "--args: robot 3 has no program: `--program 3=FILE` gives it one");
        assert!(arguments(&["0:a"]).expect_err("no robot 0").contains("robots 1 to 3"));
    }
}
