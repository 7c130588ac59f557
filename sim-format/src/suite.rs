//! Suites: a scene, programs and checks, and a matrix of seeds, worlds, noise and parameters; each combination is a
//! case.
//!
//! This module reads a suite and lists its cases; it runs nothing.

use std::collections::{BTreeMap, BTreeSet};

use sim_core::spec::CheckSpec;
use sim_core::time::Time;

use super::code::Code;
use super::diagnostic::{Diagnostic, Sink};
use super::form::{Form, print};
use super::noise::{PRESETS, preset, unknown_sensors};
use super::print::{document, schema};
use super::set::Setting;
use super::spec::SpannedText;
use super::table::{Reader, Section, has_top_key};
use super::{Files, InputFile, Loaded, Overrides, Span, line, load_noise, load_scene_with, path};

/// Suffix of file names that identifies a suite without reading its content.
pub const SUITE_EXTENSION: &str = ".suite.toml";

/// Maximum number of cases of a suite. Our choice: an hour of work at a hundred cases a second.
pub const MAX_CASES: u64 = 400_000;

/// A suite.
#[derive(Clone, Debug, PartialEq)]
pub struct SuiteSpec {
    /// Path of its file.
    pub file: String,
    /// Folder of its file.
    pub folder: String,
    /// The scene of its cases, unless the matrix has scenes.
    pub scene: Option<SpannedText>,
    /// Programs of robots, as options `--program` of the command line.
    pub programs: Vec<SpannedText>,
    /// RoBIOS functions that fail for all programs, in addition to the scene's.
    pub forbid: Vec<SpannedText>,
    /// Files of a submission that become programs of robots.
    pub submit: Vec<SubmitSpec>,
    /// End of each case.
    pub until: Option<Time>,
    /// Time for which a case continues after its last program has ended.
    pub linger: Time,
    /// Keys and touches, as options `--keys` of the command line.
    pub keys: Vec<String>,
    /// Arguments of programs, as options `--args` of the command line; `{NAME}` is replaced with a parameter of the
    /// matrix.
    pub arguments: Vec<String>,
    /// File with the standard input of the programs.
    pub stdin: Option<SpannedText>,
    /// Fraction of seeds that must pass, 0 to 1.
    pub pass_rate: f64,
    /// Values in which the cases differ.
    pub matrix: Matrix,
    /// Limits of each case.
    pub limits: LimitSpec,
    /// Checks in addition to the scene's.
    pub checks: Vec<CheckSpec>,
}

impl Default for SuiteSpec {
    fn default() -> Self {
        Self {
            file: String::new(),
            folder: String::new(),
            scene: None,
            programs: Vec::new(),
            forbid: Vec::new(),
            submit: Vec::new(),
            until: None,
            linger: Time::ZERO,
            keys: Vec::new(),
            arguments: Vec::new(),
            stdin: None,
            pass_rate: 1.0,
            matrix: Matrix::default(),
            limits: LimitSpec::default(),
            checks: Vec::new(),
        }
    }
}

/// Files of a submission that become the program of one or several robots.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SubmitSpec {
    /// The robots, in the words before `=` of an option `--program`: a number, or the name of a program or type.
    pub robots: String,
    /// Patterns for names of files, `*.c`; with a slash, patterns for the end of their paths, `src/*.c`.
    pub patterns: Vec<String>,
    /// Location of the entry in the file.
    pub span: Span,
}

/// Limits of each case.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitSpec {
    /// Processor time that a program may use within one slot, s.
    pub slot_processor: f64,
    /// Processor time of a whole case, s.
    pub processor: f64,
    /// Memory of the process in which a case runs, in bytes; `None` if unlimited.
    pub memory: Option<u64>,
    /// Bytes that each program may print.
    pub output: u64,
}

impl Default for LimitSpec {
    fn default() -> Self {
        Self { slot_processor: 10.0, processor: 60.0, memory: None, output: 10_000_000 }
    }
}

/// Lists of values; the cases are their combinations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matrix {
    /// Scenes, which replace the suite's scene.
    pub scene: Vec<String>,
    /// Files of worlds, which replace the scene's world.
    pub world: Vec<String>,
    /// Values of the scene, by the path of their keys.
    pub set: Vec<Values>,
    /// Values for `{NAME}` in the arguments of programs.
    pub parameter: Vec<Values>,
    /// Noise profiles.
    pub noise: Vec<String>,
    /// Lengths of slots, ms, as written.
    pub slot: Vec<String>,
    /// Seeds.
    pub seed: Vec<u64>,
    /// Axes that advance together.
    pub zip: Vec<Vec<String>>,
    /// Excluded combinations: labels of values by the names of their axes.
    pub exclude: Vec<BTreeMap<String, String>>,
    /// Location of the matrix in the file.
    pub span: Span,
}

/// Values of a named axis, as in TOML.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values {
    /// Name of the axis.
    pub name: String,
    /// The values.
    pub values: Vec<String>,
    /// Location of the axis in the file.
    pub span: Span,
}

/// Property that an axis of the matrix changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisKind {
    /// The scene.
    Scene,
    /// File of the world.
    World,
    /// Value of the scene, selected by its path.
    Set,
    /// Parameter of the arguments.
    Parameter,
    /// Noise profile.
    Noise,
    /// Length of slots.
    Slot,
    /// Seed.
    Seed,
}

/// Axis of the matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Property that the axis changes.
    pub kind: AxisKind,
    /// Name of the axis: a key of the matrix such as `seed`, the path of a value of the scene, or the name of a
    /// parameter.
    pub name: String,
    /// Values of the axis, in the syntax of the command line.
    pub values: Vec<String>,
}

impl Axis {
    /// Label of the value `index` in names of cases: the value without quotes.
    pub fn label(&self, index: usize) -> &str {
        label(&self.values[index])
    }

    /// Indices of the values that equal `value`, numbers as numbers: 20 equals 20.0.
    fn indices_of(&self, value: &str) -> Vec<usize> {
        let number = |text: &str| text.replace('_', "").parse::<f64>().ok();
        let wanted = number(value);
        let is_equal = |label: &str| label == value || wanted.is_some() && number(label) == wanted;
        (0..self.values.len()).filter(|index| is_equal(self.label(*index))).collect()
    }

    /// Text that is equal for all values that mean the same as the value `index`; `None` if there is no such value.
    fn normalised(&self, index: usize) -> Option<String> {
        let text = label(self.values.get(index)?);
        Some(match self.kind {
            // Slots are multiples of a microsecond.
            AxisKind::Slot => text.parse().map_or(text.to_owned(), |ms: f64| ((ms * 1e3).round() / 1e3).to_string()),
            AxisKind::Scene => path::join("", text),
            _ => text.to_owned(),
        })
    }
}

/// A value of TOML without its quotes.
fn label(value: &str) -> &str {
    let unquoted = |quote| value.strip_prefix(quote).and_then(|rest| rest.strip_suffix(quote));
    unquoted('"').or_else(|| unquoted('\'')).unwrap_or(value)
}

impl Matrix {
    /// The axes that have values. From case to case, the last axis, the seeds, varies fastest.
    pub fn axes(&self) -> Vec<Axis> {
        let axis =
            |kind, name: &str, values: &[String]| Axis { kind, name: name.to_owned(), values: values.to_owned() };
        let named =
            |kind, lists: &[Values]| lists.iter().map(|it| axis(kind, &it.name, &it.values)).collect::<Vec<_>>();
        let seeds: Vec<String> = self.seed.iter().map(u64::to_string).collect();
        let mut axes = vec![axis(AxisKind::Scene, "scene", &self.scene), axis(AxisKind::World, "world", &self.world)];
        axes.extend(named(AxisKind::Set, &self.set));
        axes.extend(named(AxisKind::Parameter, &self.parameter));
        axes.push(axis(AxisKind::Noise, "noise", &self.noise));
        axes.push(axis(AxisKind::Slot, "slot_ms", &self.slot));
        axes.push(axis(AxisKind::Seed, "seed", &seeds));
        axes.retain(|axis| !axis.values.is_empty());
        axes
    }

    /// Number of combinations before any is excluded.
    pub fn count(&self) -> u64 {
        let lengths = self.zip_groups(&self.axes()).into_iter().map(|(_, length)| length as u64);
        lengths.fold(1, u64::saturating_mul)
    }

    /// Groups of axes that advance together, as indices of axes, with the number of their values.
    fn zip_groups(&self, axes: &[Axis]) -> Vec<(Vec<usize>, usize)> {
        let mut zip_groups: Vec<(Vec<usize>, usize)> = Vec::new();
        for (index, axis) in axes.iter().enumerate() {
            let zip = self.zip.iter().find(|names| names.contains(&axis.name));
            let group = zip.and_then(|names| {
                zip_groups
                    .iter()
                    .position(|(members, _)| members.iter().any(|&member| names.contains(&axes[member].name)))
            });
            match group {
                Some(group) => zip_groups[group].0.push(index),
                None => zip_groups.push((vec![index], axis.values.len())),
            }
        }
        zip_groups
    }

    /// The cases, at most [`MAX_CASES`]: for each of [`Matrix::axes`], the index of its value.
    pub fn cases(&self) -> Vec<Vec<usize>> {
        let axes = self.axes();
        let zip_groups = self.zip_groups(&axes);
        let total = self.count().min(MAX_CASES);
        let case = |number: u64| {
            let (mut indices, mut rest) = (vec![0; axes.len()], number);
            for (members, length) in zip_groups.iter().rev() {
                let index = (rest % *length as u64) as usize;
                rest /= *length as u64;
                members.iter().for_each(|&member| indices[member] = index);
            }
            indices
        };
        // For each excluded combination, its axes and the indices of their values.
        let values_of = |(name, value): (&String, &String)| {
            let axis_index = axes.iter().position(|axis| axis.name == *name);
            axis_index.map_or((0, Vec::new()), |axis_index| (axis_index, axes[axis_index].indices_of(value)))
        };
        let exclude: Vec<Vec<(usize, Vec<usize>)>> =
            self.exclude.iter().map(|combination| combination.iter().map(values_of).collect()).collect();
        let is_excluded = |indices: &Vec<usize>| {
            let has_value = |(axis_index, values): &(usize, Vec<usize>)| {
                indices.get(*axis_index).is_some_and(|index| values.contains(index))
            };
            exclude.iter().any(|combination| combination.iter().all(has_value))
        };
        (0..total).map(case).filter(|indices| !is_excluded(indices)).collect()
    }
}

impl SuiteSpec {
    /// Values of the scene for a case with these indices into `axes`.
    pub fn settings(&self, axes: &[Axis], indices: &[usize]) -> Vec<Setting> {
        let scene = self.scene_of(axes, indices);
        let setting = |(axis, &index): (&Axis, &usize)| {
            let value = &axis.values[index];
            match axis.kind {
                // The reader has already reported invalid paths and values.
                AxisKind::Set => Setting::new(&axis.name, value).ok(),
                AxisKind::World => {
                    let file = toml::Value::from(path::moved(value, &self.folder, path::folder_of(&scene)));
                    Setting::new("world", &format!("{{ file = {file} }}")).ok()
                }
                _ => None,
            }
        };
        axes.iter().zip(indices).filter_map(setting).collect()
    }

    /// Arguments of the programs for a case with these indices into `axes`.
    pub fn arguments(&self, axes: &[Axis], indices: &[usize]) -> Vec<String> {
        let mut arguments = self.arguments.clone();
        for (axis, &index) in axes.iter().zip(indices).filter(|(axis, _)| axis.kind == AxisKind::Parameter) {
            let name = format!("{{{}}}", axis.name);
            arguments.iter_mut().for_each(|text| *text = text.replace(&name, axis.label(index)));
        }
        arguments
    }

    /// Path of the scene of a case with these indices into `axes`, from the suite's folder.
    pub fn scene_of(&self, axes: &[Axis], indices: &[usize]) -> String {
        let matrix_scene = axes.iter().zip(indices).find(|(axis, _)| axis.kind == AxisKind::Scene);
        let suite_scene = || self.scene.as_ref().map_or("", |scene| &scene.text);
        let text = matrix_scene.map_or_else(suite_scene, |(axis, &index)| &axis.values[index]);
        if path::is_absolute(text) { text.to_owned() } else { path::join(&self.folder, text) }
    }
}

/// Returns true for a TOML file that is a suite: its name ends in `.suite.toml`, or it has `suite` at its top level.
pub fn is_suite(file: &str, text: &str) -> bool {
    file.to_lowercase().ends_with(SUITE_EXTENSION) || path::extension(file) == "toml" && has_top_key(text, &["suite"])
}

/// Reads a suite, but not its scenes (see [`load_suite`]).
pub fn read_suite(file: &str, text: &str) -> (SuiteSpec, Vec<Diagnostic>) {
    let (mut reader, root) = Reader::parse(file, text);
    let folder = path::folder_of(file).to_owned();
    let mut suite = SuiteSpec { file: file.to_owned(), folder, ..SuiteSpec::default() };
    reader.table(Section::root(&root), |keys| suite.keys(keys));
    reader.check_suite(&suite);
    super::checks::set_folder(&mut suite.checks, &suite.folder);
    (suite, reader.sink.finish())
}

/// Text of a suite.
pub fn print_suite(suite: &SuiteSpec) -> String {
    document(&print(suite))
}

/// JSON schema of suites, for completion in editors.
pub fn suite_schema() -> String {
    schema("eyesim suite", |keys| SuiteSpec::default().keys(keys))
}

/// A suite that was read, with its scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadedSuite {
    /// The suite; complete if there are no errors.
    pub suite: SuiteSpec,
    /// The scene of its first case, with the mistakes and files of suite and scene, the suite's first.
    pub loaded: Loaded,
}

/// Reads a suite and the scene of its first case.
pub fn load_suite(file: &str, files: &dyn Files) -> LoadedSuite {
    let bytes = match files.read(file) {
        Ok(bytes) => bytes,
        Err(_) => {
            return LoadedSuite { loaded: load_scene_with(file, Overrides::default(), files), ..Default::default() };
        }
    };
    let (suite, mut diagnostics) = read_suite(file, &super::decode(&bytes).0);
    let mut inputs = vec![InputFile { path: file.to_owned(), bytes }];
    if super::has_errors(&diagnostics) {
        return LoadedSuite { suite, loaded: Loaded { diagnostics, inputs, ..Loaded::default() } };
    }
    let axes = suite.matrix.axes();
    let first = suite.matrix.cases().into_iter().next().unwrap_or_else(|| vec![0; axes.len()]);
    let mut loaded = suite.load_case(&axes, &first, files);
    diagnostics.append(&mut loaded.diagnostics);
    inputs.append(&mut loaded.inputs);
    LoadedSuite { suite, loaded: Loaded { diagnostics, inputs, ..loaded } }
}

/// Maximum number of cases that [`check_suite`] loads. Our choice: seconds for usual scenes.
const MAX_CHECKED_CASES: usize = 1000;

/// Reads a suite like [`load_suite`], and so many of its cases that each scene, world, noise profile and value of a
/// scene is read at least once.
pub fn check_suite(file: &str, files: &dyn Files) -> LoadedSuite {
    let LoadedSuite { suite, mut loaded } = load_suite(file, files);
    if loaded.has_errors() {
        return LoadedSuite { suite, loaded };
    }
    let axes = suite.matrix.axes();
    let mut seen = BTreeSet::new();
    let has_new_value = |case: &&Vec<usize>| {
        let mut is_new = false;
        for (axis, index) in axes.iter().zip(case.iter()) {
            let is_read = matches!(axis.kind, AxisKind::Scene | AxisKind::World | AxisKind::Set | AxisKind::Noise);
            is_new |= is_read && seen.insert((&axis.name, *index));
        }
        is_new
    };
    let mut known = loaded.diagnostics.clone();
    for case in suite.matrix.cases().iter().filter(has_new_value).take(MAX_CHECKED_CASES) {
        let mut of_case = suite.load_case(&axes, case, files);
        suite.read_noise(&axes, case, files, &mut of_case);
        let settings: Vec<String> =
            axes.iter().zip(case).map(|(axis, &index)| format!("{}={}", axis.name, axis.label(index))).collect();
        for new in of_case.diagnostics {
            if !known.contains(&new) {
                known.push(new.clone());
                let message = format!("{} (case {})", new.message, settings.join(","));
                loaded.diagnostics.push(Diagnostic { message, ..new });
            }
        }
        let new_inputs = of_case.inputs.into_iter().filter(|input| !loaded.inputs.contains(input)).collect::<Vec<_>>();
        loaded.inputs.extend(new_inputs);
    }
    LoadedSuite { suite, loaded }
}

impl SuiteSpec {
    /// Loads the scene of a case, and checks the suite's checks with it.
    fn load_case(&self, axes: &[Axis], indices: &[usize], files: &dyn Files) -> Loaded {
        let settings = self.settings(axes, indices);
        let overrides = Overrides { settings: &settings, ..Overrides::default() };
        let mut loaded = load_scene_with(&self.scene_of(axes, indices), overrides, files);
        loaded.diagnostics.extend(check_of_suite(self, &loaded.scene));
        loaded
    }

    /// Reads the noise profile of a case, and reports its mistakes and those in its use by the scene of `loaded`.
    fn read_noise(&self, axes: &[Axis], indices: &[usize], files: &dyn Files, loaded: &mut Loaded) {
        let Some((axis, &index)) = axes.iter().zip(indices).find(|(axis, _)| axis.kind == AxisKind::Noise) else {
            return;
        };
        let name = &axis.values[index];
        if preset(name).is_some() {
            return;
        }
        let in_folder = path::moved(name, &self.folder, "");
        let Some(file) = [in_folder, name.clone()].into_iter().find(|file| files.read(file).is_ok()) else {
            let mut sink = Sink::new(&self.file);
            let message = format!("there is no noise profile `{name}`");
            let expected = format!("one of {}, or a file", PRESETS.join(", "));
            let nearest = line::nearest(name, PRESETS).map(|preset| format!("write `{preset}`"));
            sink.error(Code::FileMissing, self.matrix.span, message, expected).suggestion = nearest;
            loaded.diagnostics.extend(sink.finish());
            return;
        };
        let (noise, read) = load_noise(&file, files);
        loaded.scene.robots.iter_mut().for_each(|robot| robot.noise.clone_from(&noise));
        loaded.diagnostics.extend(read.diagnostics);
        loaded.diagnostics.extend(unknown_sensors(&loaded.scene.robots));
        loaded.inputs.extend(read.inputs);
    }
}

/// Mistakes in the checks of a suite for this scene.
pub fn check_of_suite(suite: &SuiteSpec, scene: &super::SceneSpec) -> Vec<Diagnostic> {
    let scene = super::SceneSpec { file: suite.file.clone(), checks: suite.checks.clone(), ..scene.clone() };
    super::checks::check(&scene)
}

impl Reader {
    /// Reports mistakes that involve several keys of a suite.
    fn check_suite(&mut self, suite: &SuiteSpec) {
        let matrix = &suite.matrix;
        if suite.scene.is_none() && matrix.scene.is_empty() && self.sink.is_empty() {
            let message = "the suite names no scene";
            self.sink.error(Code::TomlMissing, Span::default(), message, "`scene = \"NAME.scene.toml\"` in `[suite]`");
        }
        let axes = matrix.axes();
        let mut names = BTreeSet::new();
        for axis in &axes {
            if !names.insert(axis.name.as_str()) {
                let message = format!("two axes are named `{}`", axis.name);
                self.sink.error(Code::SuiteAxis, matrix.span, message, "each name once");
            }
        }
        let list = || names.iter().copied().collect::<Vec<_>>().join(", ");
        let zipped_names = matrix.zip.iter().flatten();
        for name in zipped_names.chain(matrix.exclude.iter().flat_map(BTreeMap::keys)) {
            if !names.contains(name.as_str()) {
                let message = format!("the matrix has no values of `{name}`");
                self.sink.error(Code::SuiteAxis, matrix.span, message, format!("one of {}", list()));
            }
        }
        let mut zipped = BTreeSet::new();
        for zip in &matrix.zip {
            let lengths: Vec<usize> =
                axes.iter().filter(|axis| zip.contains(&axis.name)).map(|axis| axis.values.len()).collect();
            if lengths.windows(2).any(|pair| pair[0] != pair[1]) {
                let message = format!("`zip` of {} joins lists of different lengths: {lengths:?}", zip.join(", "));
                self.sink.error(Code::SuiteAxis, matrix.span, message, "as many values in each");
            }
            if let Some(twice) = zip.iter().find(|name| !zipped.insert(name.as_str())) {
                let message = format!("`{twice}` is in `zip` twice");
                self.sink.error(Code::SuiteAxis, matrix.span, message, "each name once");
            }
        }
        for (members, length) in matrix.zip_groups(&axes) {
            let values = |index| members.iter().filter_map(|&axis| axes[axis].normalised(index)).collect::<Vec<_>>();
            let mut seen = BTreeSet::new();
            if let Some(twice) = (0..length).map(values).find(|values| !seen.insert(values.clone())) {
                let names: Vec<&str> = members.iter().map(|&axis| axes[axis].name.as_str()).collect();
                let message = format!("{} of {} is listed twice", twice.join(", "), names.join(", "));
                self.sink.error(Code::TomlConflict, matrix.span, message, "each value once");
            }
        }
        self.check_parameters(suite);
        if matrix.count() > MAX_CASES {
            let message = format!("the matrix has {} cases", matrix.count());
            self.sink.error(Code::SuiteCases, matrix.span, message, format!("at most {MAX_CASES}"));
        } else if self.sink.is_empty() && matrix.cases().is_empty() {
            self.sink.error(Code::SuiteCases, matrix.span, "`exclude` leaves no case", "at least one case");
        }
        for (name, value) in matrix.exclude.iter().flatten() {
            let Some(axis) = axes.iter().find(|axis| axis.name == *name) else { continue };
            if axis.indices_of(value).is_empty() {
                let message = format!("`exclude` has `{value}`, which is no value of `{name}`");
                let labels = (0..axis.values.len()).map(|index| axis.label(index));
                let suggestion = line::nearest(value, labels).map(|label| format!("write `{label}`"));
                let expected = "values of the lists of the matrix";
                self.sink.warn(Code::SuiteAxis, matrix.span, message, expected).suggestion = suggestion;
            }
        }
    }

    /// Reports parameters that no argument uses, and placeholders of unknown parameters.
    fn check_parameters(&mut self, suite: &SuiteSpec) {
        let parameters = &suite.matrix.parameter;
        for parameter in parameters {
            let placeholder = format!("{{{}}}", parameter.name);
            if !suite.arguments.iter().any(|text| text.contains(&placeholder)) {
                let message = format!("no argument of a program has the parameter `{placeholder}`");
                let expected = format!("`arguments = [\"--{} {placeholder}\"]` in `[suite]`", parameter.name);
                self.sink.error(Code::SuiteParameter, parameter.span, message, expected);
            }
        }
        for text in &suite.arguments {
            let names = text.split('{').skip(1).filter_map(|rest| Some(rest.split_once('}')?.0));
            let is_unknown = |name: &&str| parameters.iter().all(|parameter| parameter.name != **name);
            for name in names.filter(is_unknown) {
                let message =
                    format!("the arguments have a place for `{name}`, which is not a parameter of the matrix");
                let expected = format!("`[matrix.parameter]` with `{name} = [...]`");
                self.sink.error(Code::SuiteParameter, Span::default(), message, expected);
            }
        }
    }
}
