//! Suites as a library: the cases of a suite, a pool that runs the cases, and the rows with their results.
//!
//! [`Suite::open`] reads a suite, and [`Suite::cases`] lists its cases. [`run_case`] runs one case in this process and
//! returns its [`CaseResult`] with the [`Row`]; [`Pool`] runs many cases in forks of this process. [`summary`] computes
//! pass rates over seeds, and [`table`] converts rows to tables, for CSV and Parquet.

mod case;
#[cfg(feature = "parquet")]
pub mod parquet;
mod pool;
mod prepare;
mod row;
mod select;
pub mod summary;
pub mod table;

#[cfg(feature = "grading")]
pub(crate) use case::unfinished_case_result;
pub use case::{Case, Keep, PrepareError, Session, run_case};
pub use pool::{Pool, PoolError, PoolOptions};
pub use prepare::Preparation;
pub use row::{CaseResult, ROW_SCHEMA, Row, RowOutcome, RowRobot, Trace};
pub use select::{Selection, SelectionError};
use sim_host::executive::program::Exec;
use sim_host::files::{DiskFiles, slashed};
use sim_host::launch::settings::ProgramOption;
use sim_host::launch::{Error, Options, Scene, UnpackedArchive, check};
use sim_host::program::sandbox::Sandbox;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use sim_core::spec::SceneSpec;
use sim_core::time::Time;
use sim_format::suite::{Axis, AxisKind, LoadedSuite, MAX_CASES, SuiteSpec, load_suite, print_suite};
use sim_format::{Diagnostic, InputFile};

/// A suite that has been read.
pub struct Suite {
    /// The suite.
    pub spec: SuiteSpec,
    /// Mistakes in the suite and in the scene of its first case.
    pub diagnostics: Vec<Diagnostic>,
    /// The files of the suite and of the scene of its first case.
    pub inputs: Vec<InputFile>,
    /// True if the programs of checks may run; for a suite from an archive, the user must allow it.
    pub may_run_checks: bool,
    /// Archive with the files of the suite.
    pub archive: Option<UnpackedArchive>,
    /// Restrictions of the programs and of the compilers that build them.
    pub sandbox: Option<Sandbox>,
    axes: Vec<Axis>,
    /// The checks of the suite as text, independent of the file's path and line numbers.
    checks_text: String,
    /// Programs that replace the suite's.
    programs: Vec<ProgramOption>,
}

impl Suite {
    /// Reads the suite at `path`; `programs` take precedence over the suite's.
    pub fn open(path: &Path, programs: Vec<ProgramOption>) -> Self {
        let mut files = DiskFiles::of_environment();
        let LoadedSuite { suite: spec, mut loaded } = load_suite(&files.name(path), &files);
        let check_scene = SceneSpec { file: spec.file.clone(), checks: spec.checks.clone(), ..SceneSpec::default() };
        loaded.diagnostics.extend(check::unknown_forbidden_functions(&spec.file, &spec.forbid));
        loaded.diagnostics.extend(check::invalid_checks(&check_scene));
        let axes = spec.matrix.axes();
        let checks_text = print_suite(&SuiteSpec { checks: spec.checks.clone(), ..SuiteSpec::default() });
        Self {
            spec,
            diagnostics: loaded.diagnostics,
            inputs: loaded.inputs,
            may_run_checks: true,
            archive: None,
            sandbox: None,
            axes,
            checks_text,
            programs,
        }
    }

    /// Adds seeds to the matrix, which may already contain them.
    ///
    /// # Errors
    /// The matrix zips the seeds with other values, or there would be too many cases.
    pub fn add_seeds(&mut self, seeds: impl Iterator<Item = u64>) -> Result<(), String> {
        let matrix = &mut self.spec.matrix;
        let new_seeds: Vec<u64> = seeds.filter(|seed| !matrix.seed.contains(seed)).collect();
        if new_seeds.is_empty() {
            return Ok(());
        }
        if matrix.zip.iter().flatten().any(|name| name == "seed") {
            return Err("seeds cannot be added: `zip` lets them advance together with other values".to_owned());
        }
        matrix.seed.extend(new_seeds);
        if matrix.count() > MAX_CASES {
            return Err(format!("with all seeds the matrix has {} cases, at most {MAX_CASES}", matrix.count()));
        }
        self.axes = matrix.axes();
        Ok(())
    }

    /// The axes of the matrix.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// All cases, in the order of the matrix: the cases of a variant follow each other.
    ///
    /// # Errors
    /// A program of the suite cannot be read as an option `--program`.
    pub fn cases(&self) -> Result<Vec<Case>, String> {
        let suite_programs = self.spec.programs.iter().map(|program| self.program(&program.text));
        let mut programs: Vec<ProgramOption> = suite_programs.collect::<Result<_, _>>()?;
        for program in &self.programs {
            programs.retain(|other| !other.selects_same_robots(program));
            programs.push(program.clone());
        }
        let case = |indices: Vec<usize>| {
            let settings: Vec<(String, String)> = self.settings_of(&indices);
            let without_seed: Vec<&(String, String)> = settings.iter().filter(|(name, _)| name != "seed").collect();
            let variant = name_of(without_seed.iter().copied());
            Case {
                name: name_of(settings.iter()),
                variant,
                scene: PathBuf::from(self.spec.scene_of(&self.axes, &indices)),
                options: self.options(&indices, &programs),
                settings,
            }
        };
        Ok(self.spec.matrix.cases().into_iter().map(case).collect())
    }

    /// Checks that the options of `cases` fit their scenes, and that a robot has a program; each scene is read once.
    ///
    /// # Errors
    /// The message of the first mistake. Mistakes in a scene itself are reported by its cases.
    pub fn check_options(&self, cases: &[Case]) -> Result<(), String> {
        let mut seen = BTreeSet::new();
        for case in cases.iter().filter(|case| seen.insert(&case.scene)) {
            let mut scene = match Scene::open(&case.scene, case.options.clone()) {
                Ok(scene) if !scene.is_rejected() => scene,
                Err(error @ Error::Option(_)) => return Err(error.to_string()),
                _ => continue,
            };
            scene.settings().map_err(|error| error.to_string())?;
            if scene.spec().robots.iter().all(|robot| robot.program.is_none()) {
                return Err(format!(
                    "no robot of `{}` has a program: `programs = [\"1=FILE\"]` in `[suite]`, or `--program 1=FILE`, gives it one",
                    slashed(&case.scene)
                ));
            }
        }
        Ok(())
    }

    fn settings_of(&self, indices: &[usize]) -> Vec<(String, String)> {
        let setting = |(axis, &index): (&Axis, &usize)| (axis.name.clone(), axis.label(index).to_owned());
        self.axes.iter().zip(indices).map(setting).collect()
    }

    /// Parses a program option of the suite. A path that exists relative to the suite's folder is resolved there.
    fn program(&self, text: &str) -> Result<ProgramOption, String> {
        let option = ProgramOption::parse(text)?;
        let path = Path::new(&self.spec.folder).join(option.program());
        Ok(if path.exists() { option.with_program(&slashed(&path)) } else { option })
    }

    fn options(&self, indices: &[usize], programs: &[ProgramOption]) -> Options {
        let spec = &self.spec;
        let value = |kind| {
            let found = self.axes.iter().zip(indices).find(|(axis, _)| axis.kind == kind);
            found.map(|(axis, &index)| axis.values[index].as_str())
        };
        let in_folder = |name: &str| {
            let path = Path::new(&spec.folder).join(name);
            if path.exists() { slashed(&path) } else { name.to_owned() }
        };
        Options {
            seed: value(AxisKind::Seed).and_then(|seed| seed.parse().ok()),
            slot: value(AxisKind::Slot)
                .and_then(|slot| slot.parse::<f64>().ok())
                .map(|milliseconds| Time((milliseconds * 1e3).round() as i64)),
            until: spec.until,
            linger: spec.linger,
            workers: std::num::NonZeroUsize::new(1),
            exec: if self.sandbox.is_some() { Exec::Process } else { Exec::Auto },
            sandbox: self.sandbox.clone(),
            timeout: spec.limits.slot_processor,
            programs: programs.to_vec(),
            forbid: spec.forbid.iter().map(|functions| functions.text.clone()).collect(),
            keys: spec.keys.clone(),
            arguments: spec.arguments(&self.axes, indices),
            stdin: spec.stdin.as_ref().map(|file| PathBuf::from(in_folder(&file.text))),
            noise: value(AxisKind::Noise).map(in_folder),
            settings: spec.settings(&self.axes, indices),
            may_run_checks: self.may_run_checks,
            output_limit: spec.limits.output,
            archive: self.archive.clone(),
            ..Options::default()
        }
    }
}

/// Name of a case or variant: `noise=real,seed=3`; `run` without settings.
fn name_of<'s>(settings: impl Iterator<Item = &'s (String, String)>) -> String {
    let parts: Vec<String> = settings.map(|(name, value)| format!("{name}={value}")).collect();
    if parts.is_empty() { "run".to_owned() } else { parts.join(",") }
}
