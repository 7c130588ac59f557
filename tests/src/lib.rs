//! Helpers for the black-box tests: they run the real binary in a fresh folder and read its output and files.

pub mod radio;
pub mod stranger;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use serde_json::Value;
use tempfile::TempDir;

/// The checkout's root.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// Writes these headers of the C API into a folder.
///
/// # Panics
/// If they cannot be written.
pub fn write_headers(folder: &Path, headers: &[robios_sys::c::SourceFile]) {
    for header in headers {
        let path = folder.join(header.name);
        std::fs::create_dir_all(path.parent().expect("a file has a folder")).expect("a folder for a file");
        std::fs::write(path, header.text).expect("a header");
    }
}

/// Path of the binary `eyesim` of the profile under test; builds it if necessary.
///
/// # Panics
/// If the binary cannot be built.
pub fn eyesim_path() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| {
        let mut build = Command::new(env!("CARGO"));
        // Builds the whole workspace and a test, so that dependencies have the same features as in the build by
        // `cargo test --workspace`.
        build.args(["build", "--quiet", "--workspace", "--bin", "eyesim", "--test", "arrows"]).current_dir(root());
        if !cfg!(debug_assertions) {
            build.arg("--release");
        }
        let status = build.status().expect("cargo runs");
        assert!(status.success(), "eyesim does not build");
        // The test's path is target/PROFILE/deps/TEST.
        let test = std::env::current_exe().expect("a test knows its own path");
        let profile = test.ancestors().nth(2).expect("tests lie in target/PROFILE/deps");
        profile.join(format!("eyesim{}", std::env::consts::EXE_SUFFIX))
    })
}

/// Writes a copy of the binary to `copy`.
///
/// # Panics
/// If it cannot be written.
pub fn copy_eyesim(copy: &Path) {
    // By a process of its own: if this process wrote it, a child that another thread starts meanwhile would keep the
    // copy open for writing, and it could not be executed.
    let copied = Command::new("cp").arg(eyesim_path()).arg(copy).status();
    assert!(copied.expect("cp starts").success(), "a copy of the binary");
}

/// A fresh folder in which tests run `eyesim`; it is removed at the end of the test.
pub struct Scratch {
    folder: TempDir,
}

/// Result of a run of `eyesim`.
#[derive(Debug)]
pub struct Ran {
    /// Exit code; `None` if a signal ended the run.
    pub code: Option<i32>,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Scratch {
    /// Creates an empty folder.
    ///
    /// # Panics
    /// If the folder cannot be created.
    #[allow(clippy::new_without_default, reason = "makes a folder on the disk")]
    pub fn new() -> Self {
        Self { folder: TempDir::new().expect("a folder for a test") }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Writes a file and creates the folders above it.
    ///
    /// # Panics
    /// If the file cannot be written.
    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path().join(name);
        std::fs::create_dir_all(path.parent().expect("a file has a folder")).expect("a folder for a file");
        std::fs::write(&path, text).expect("a file for a test");
        path
    }

    /// Reads a file that a run has written.
    ///
    /// # Panics
    /// If the file does not exist.
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path().join(name)).unwrap_or_else(|error| panic!("`{name}`: {error}"))
    }

    /// The command `eyesim` with `args`, in this folder.
    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(eyesim_path());
        command.args(args).current_dir(self.path());
        command
    }

    /// Runs `eyesim` with `args` in this folder to its end.
    ///
    /// # Panics
    /// If `eyesim` cannot be started.
    pub fn eyesim(&self, args: &[&str]) -> Ran {
        Ran::from(self.command(args).output().expect("eyesim starts"))
    }

    /// Runs a scene with a report, checks the exit code and returns the report.
    ///
    /// # Panics
    /// If the exit code differs or the report cannot be read.
    pub fn report(&self, sim: &str, args: &[&str], expected_code: i32) -> Value {
        let mut all = vec!["run", sim, "--report", "report.json"];
        all.extend(args);
        let ran = self.eyesim(&all);
        assert_eq!(ran.code, Some(expected_code), "{ran:#?}");
        serde_json::from_str(&self.read("report.json")).expect("a report is JSON")
    }

    /// The lines of a trace.
    ///
    /// # Panics
    /// If a line is not JSON.
    pub fn trace(&self, name: &str) -> Vec<Value> {
        self.read(name).lines().map(|line| serde_json::from_str(line).expect("a line of a trace is JSON")).collect()
    }
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

/// A field of a robot in a report, found by a path such as `pose.x_m`.
///
/// # Panics
/// If the field is not a number.
pub fn number(robot: &Value, path: &str) -> f64 {
    let value = path.split('.').fold(robot, |value, key| &value[key]);
    value.as_f64().unwrap_or_else(|| panic!("`{path}` in {robot:#}"))
}

/// Writes a Rust package with the robot program `program` into the folder `name`.
pub fn write_package(scratch: &Scratch, name: &str, program: &str) {
    let api = root().join("robios-api");
    let manifest = format!(
        "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n[lib]\ncrate-type = [\"cdylib\"]\n\
         [dependencies]\nrobios-api = {{ path = {api:?} }}\n[workspace]\n"
    );
    scratch.write(&format!("{name}/Cargo.toml"), &manifest);
    scratch.write(&format!("{name}/src/lib.rs"), program);
}

/// Writes a small scene: a robi with one PSD sensor ahead, an empty room of 4 m, and a sim file with one robot for each
/// of `programs`.
pub fn write_scene(scratch: &Scratch, programs: &[&str]) -> PathBuf {
    scratch.write("room.wld", "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n");
    scratch.write(
        "bot.robi",
        "name Bot\ndiameter 180\nspeed 600\nturn 300\naxis 0\npsd PSD_FRONT -200 60 0 30 0\nwheel 54 3600 1100 90\n\
         drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n",
    );
    let mut sim = String::from("world room.wld\n");
    for (index, program) in programs.iter().enumerate() {
        let (column, row) = (index % 8, index / 8);
        sim += &format!("robi bot.robi {program} {} {} 0\n", 400 + 400 * column, 400 + 400 * row);
    }
    scratch.write("scene.sim", &sim)
}

/// Writes a scene of `robots` robots of type `%sim%/robis/ring.robi`, one per square metre, in a room without
/// obstacles. All run `program`.
pub fn write_crowd(scratch: &Scratch, robots: usize, program: &str) -> PathBuf {
    let columns = robots.isqrt().max(1);
    let (width, height) = (1000 * columns, 1000 * robots.div_ceil(columns));
    scratch.write(
        "crowd.wld",
        &format!(
            "floor {width} {height}\n0 0 {width} 0\n{width} 0 {width} {height}\n{width} {height} 0 {height}\n\
             0 {height} 0 0\n"
        ),
    );
    let mut sim = String::from("world crowd.wld\n");
    for index in 0..robots {
        let (x, y) = (1000 * (index % columns) + 500, 1000 * (index / columns) + 500);
        // Successive headings differ by the golden angle of 137.5 degrees, so all directions occur.
        let phi = (index as f64 * 137.5) % 360.0;
        sim += &format!("robi %sim%/robis/ring.robi {program} {x} {y} {phi}\n");
    }
    scratch.write("crowd.sim", &sim)
}

/// Returns true and prints the reason if the kernel does not support the full sandbox.
///
/// # Panics
/// If eyesim cannot be run.
pub fn lacks_sandbox() -> bool {
    let ran = Scratch::new().eyesim(&["doctor"]);
    let line =
        ran.stdout.lines().find(|line| line.contains(" sandbox ")).unwrap_or_else(|| panic!("{ran:#?}")).to_owned();
    let is_full = line.contains(" full: ");
    if !is_full {
        println!("skipped: {line}");
    }
    !is_full
}
