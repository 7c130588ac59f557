//! The report of a run: one JSON file, written at the end. Its schema is in `docs/report.md`.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use serde::{Deserialize, Serialize, Serializer};
use sha2::{Digest as _, Sha256};
use sim_core::pose::Pose;

use super::sink::RecordError;
use crate::program::sandbox::SandboxReport;
use sim_core::record::{Digest, Outcome};

/// Version of the report's schema.
pub const REPORT_SCHEMA: u32 = 1;

/// Report of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// [`REPORT_SCHEMA`].
    pub schema: u32,
    /// Version of eyesim.
    pub eyesim_version: String,
    /// The command line.
    pub argv: Vec<String>,
    /// Every file that was read.
    pub inputs: Vec<Input>,
    /// Seed of the run.
    pub seed: u64,
    /// Length of a slot, us.
    pub slot_us: i64,
    /// Virtual time at the end, s.
    #[serde(serialize_with = "finite")]
    pub sim_time_s: f64,
    /// Real time that the run took, s.
    #[serde(serialize_with = "finite")]
    pub real_time_s: f64,
    /// Digest of all records of the run.
    pub digest: Digest,
    /// All robots in order of their ids.
    pub robots: Vec<RobotReport>,
    /// All movable objects in order of their ids.
    pub objects: Vec<ObjectReport>,
    /// Values of the scene that were drawn from the seed, in the order of the file.
    pub drawn: Vec<DrawnReport>,
    /// Results of the scene's checks, in the order of the file.
    pub checks: Vec<CheckReport>,
    /// Restrictions of the programs; none if they were not restricted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sandbox: Option<SandboxReport>,
    /// Sum of the points of all checks.
    #[serde(serialize_with = "finite")]
    pub points: f64,
    /// Maximum sum of points, for a run that passes all checks.
    #[serde(serialize_with = "finite")]
    pub max_points: f64,
}

/// A value of the scene that was drawn from the seed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawnReport {
    /// Path of the value in the scene, such as `robot.1.x_mm`.
    pub path: String,
    /// The value in the unit of its key: a number, a text, true or false, or a list or table of them.
    pub value: serde_json::Value,
}

/// Result of a check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CheckReport {
    /// Name of the check; its kind if it has no name.
    pub name: String,
    /// Kind of the check.
    pub kind: String,
    /// True if the condition is met.
    pub passed: bool,
    /// True if the check's program gave no verdict: the check is faulty, not the run.
    pub broken: bool,
    /// Points of the run.
    #[serde(serialize_with = "finite")]
    pub points: f64,
    /// Points for a run that passes the check.
    #[serde(serialize_with = "finite")]
    pub max_points: f64,
    /// Instant of the verdict, s; none if the check has no single instant.
    pub at_s: Option<f64>,
    /// World x of the body at that instant, m; none if unknown.
    pub x_m: Option<f64>,
    /// World y of the body at that instant, m; none if unknown.
    pub y_m: Option<f64>,
    /// The measured quantity; none for a check without one.
    pub value: Option<f64>,
    /// Instants (s) at which the metric of a swarm changed, each with the new value; none for other checks.
    pub series: Option<Vec<[f64; 2]>>,
    /// The result in words.
    pub message: String,
}

/// Final state of a movable object.
#[derive(Clone, Debug, Serialize)]
pub struct ObjectReport {
    /// Number in the scene.
    pub id: u32,
    /// Name of the object's type.
    pub name: String,
    /// Pose at the start, or when it was added.
    pub start: PlanarPose,
    /// Pose at the end, or when it was removed.
    pub pose: PlanarPose,
    /// Time at which it was added, s; none if it was there from the start.
    pub added_s: Option<f64>,
    /// Time at which it was removed, s; none if it was not.
    pub removed_s: Option<f64>,
}

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// Path as the user or another file names it, resolved.
    pub path: String,
    /// SHA-256 of the file, 64 lower-case hexadecimal digits.
    pub sha256: String,
}

impl Input {
    /// Input for the file `path` with these bytes.
    pub fn new(path: &Path, bytes: &[u8]) -> Self {
        use std::fmt::Write as _;
        let mut sha256 = String::with_capacity(64);
        for byte in Sha256::digest(bytes) {
            // Writing to a string cannot fail.
            _ = write!(sha256, "{byte:02x}");
        }
        Self { path: path.display().to_string(), sha256 }
    }
}

/// Final state of a robot.
#[derive(Clone, Debug, Serialize)]
pub struct RobotReport {
    /// Number in the scene.
    pub id: u32,
    /// Name of the robot's type.
    pub name: String,
    /// Program as the sim file or the command line names it. For the `Cargo.toml` of a package, it is the name of the
    /// package's folder; for a robot without a program, it is empty.
    pub program: String,
    /// State of the program.
    pub outcome: Outcome,
    /// Reason for the outcome, as text.
    pub reason: Option<String>,
    /// The program's exit code, if it returned one.
    pub exit_code: Option<i32>,
    /// Virtual time of the robot, s.
    #[serde(serialize_with = "finite")]
    pub virtual_time_s: f64,
    /// Pose at the start, or when it was added.
    pub start: PlanarPose,
    /// True pose at the end, or when it was removed.
    pub pose: PlanarPose,
    /// Depth of the top of the hull below the surface of the water, m; none for a robot that is not in the water.
    pub depth_m: Option<f64>,
    /// Pose by odometry, in the odometry frame; reports of runs have it also for programs without `VWInit`.
    pub odometry: Option<PlanarPose>,
    /// Length of the path of the axle's centre, m.
    #[serde(serialize_with = "finite")]
    pub path_m: f64,
    /// Number of contacts that began.
    pub contacts: u64,
    /// Instants at which the first [`MAX_CONTACT_TIMES`](super::notes::MAX_CONTACT_TIMES) contacts of the trace began,
    /// s.
    pub contact_times_s: Vec<f64>,
    /// The first [`MAX_HINTS`](super::notes::MAX_HINTS) hints for the robot's program.
    pub hints: Vec<HintReport>,
    /// Last values of the metrics that the program printed, by name. No check uses them, since the program could print
    /// any value.
    pub metrics: BTreeMap<String, f64>,
    /// Number of the program's calls of each forbidden function, by name.
    pub forbidden_calls: BTreeMap<String, u64>,
    /// Time at which the robot's centre first left the floor, s; none if it never did.
    pub left_floor_s: Option<f64>,
    /// Number of footfalls; none for a robot without legs.
    pub footfalls: Option<u64>,
    /// Number of touches by parts other than the soles; none for a robot without legs.
    pub touches: Option<u64>,
    /// The text lines of the display, from the top.
    pub lcd: Vec<String>,
    /// Number of bytes that the program printed beyond `--output-limit` and that were cut.
    pub output_cut_bytes: u64,
    /// Time at which it was added, s; none if it was there from the start.
    pub added_s: Option<f64>,
    /// Time at which it was removed, s; none if it was not.
    pub removed_s: Option<f64>,
}

/// Hint about a likely mistake in a program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HintReport {
    /// Time of the call that caused the hint, s.
    pub at_s: f64,
    /// Source line of the call, such as `maze.c:12`; none if unknown.
    pub at: Option<String>,
    /// The hint.
    pub text: String,
}

/// A pose in the units of the report.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlanarPose {
    /// World x, to the right, m.
    #[serde(serialize_with = "finite")]
    pub x_m: f64,
    /// World y, to the top as seen from above, m.
    #[serde(serialize_with = "finite")]
    pub y_m: f64,
    /// Heading in [-pi, pi), counter-clockwise from x, rad.
    #[serde(serialize_with = "finite")]
    pub phi_rad: f64,
}

impl From<Pose> for PlanarPose {
    /// Drops whole turns.
    fn from(pose: Pose) -> Self {
        Self { x_m: pose.position.x, y_m: pose.position.y, phi_rad: pose.heading.remainder() }
    }
}

/// Serialises a finite number. JSON cannot represent other numbers, and a correct run has none.
fn finite<S: Serializer>(number: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if number.is_finite() {
        serializer.serialize_f64(*number)
    } else {
        Err(serde::ser::Error::custom(format!("a number of the report is {number}")))
    }
}

impl Report {
    /// This report with the results of checks.
    pub fn with_checks(self, checks: Vec<CheckReport>) -> Self {
        // Starts at 0, since `sum` gives -0 for an empty list.
        let add =
            |[points, max_sum]: [f64; 2], check: &CheckReport| [points + check.points, max_sum + check.max_points];
        let [points, max_points] = checks.iter().fold([0.0; 2], add);
        Self { checks, points, max_points, ..self }
    }

    /// Text of the report.
    ///
    /// # Errors
    /// [`RecordError::Report`] if a number is not finite.
    pub fn to_json(&self) -> Result<String, RecordError> {
        let mut json = serde_json::to_string_pretty(self).map_err(RecordError::Report)?;
        json.push('\n');
        Ok(json)
    }

    /// Writes the report to `path`, completely or not at all.
    ///
    /// # Errors
    /// [`RecordError::Write`] if it cannot be written, [`RecordError::Report`] if a number is not finite.
    pub fn write(&self, path: &Path) -> Result<(), RecordError> {
        let json = self.to_json()?;
        write_atomically(path, json.as_bytes()).map_err(|source| RecordError::write("report", path, source))
    }
}

/// Replaces the file `path` atomically by one with these bytes.
///
/// If the file is not regular, or is in `/dev` (where standard output may be a regular file), the bytes are appended to
/// it instead. A symbolic link is followed.
///
/// # Errors
/// The file cannot be written.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(metadata) if !metadata.is_file() || path.starts_with("/dev") => {
            fs::OpenOptions::new().append(true).open(path)?.write_all(bytes)
        }
        Ok(metadata) => replace(&path.canonicalize()?, bytes, metadata.permissions()),
        Err(_) => replace(path, bytes, new_file_permissions()),
    }
}

/// Writes a temporary file beside `path` and renames it.
fn replace(path: &Path, bytes: &[u8], permissions: fs::Permissions) -> io::Result<()> {
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let mut file = tempfile::Builder::new().prefix(".eyesim-").permissions(permissions).tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.persist(path)?;
    Ok(())
}

/// Permissions of a new file before the user's umask.
fn new_file_permissions() -> fs::Permissions {
    use std::os::unix::fs::PermissionsExt as _;
    fs::Permissions::from_mode(0o666)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report() -> Report {
        let lcd = ["Square", "", "", "", "", "done", "GO          END"].map(str::to_owned).to_vec();
        let robot = RobotReport {
            id: 1,
            name: "eve".into(),
            program: "square.c".into(),
            outcome: Outcome::Waiting,
            reason: Some("waits for KEY4 since 2.31 s at maze.c:88 (try --keys \"3:KEY4\")".into()),
            exit_code: None,
            virtual_time_s: 2.35,
            start: Pose::new(0.5, 0.5, 0.0).into(),
            pose: Pose::new(0.1, 0.2, 7.0).into(),
            depth_m: None,
            odometry: None,
            path_m: 1.6,
            contacts: 2,
            contact_times_s: vec![1.25, 2.0],
            hints: vec![HintReport { at_s: 0.5, at: Some("square.c:12".into()), text: "a drive of km".into() }],
            metrics: BTreeMap::new(),
            forbidden_calls: BTreeMap::new(),
            left_floor_s: None,
            footfalls: Some(7),
            touches: None,
            lcd,
            output_cut_bytes: 0,
            added_s: None,
            removed_s: Some(4.5),
        };
        let odometry = Some(PlanarPose { x_m: 0.0, y_m: -0.0, phi_rad: 1.0 });
        let other = RobotReport {
            id: 2,
            outcome: Outcome::Finished,
            reason: None,
            exit_code: Some(0),
            depth_m: None,
            odometry,
            ..robot.clone()
        };
        Report {
            sandbox: None,
            schema: REPORT_SCHEMA,
            eyesim_version: "0.1.0".into(),
            argv: ["eyesim", "run", "square.sim"].map(str::to_owned).to_vec(),
            inputs: vec![Input::new(Path::new("sims/square.sim"), b"abc")],
            seed: u64::MAX,
            slot_us: 50_000,
            sim_time_s: 2.35,
            real_time_s: 0.001,
            digest: Digest([0xab; 32]),
            robots: vec![robot, other],
            objects: vec![ObjectReport {
                id: 1,
                name: "Golf".into(),
                start: Pose::new(1.0, 1.0, 0.0).into(),
                pose: Pose::new(1.5, 1.0, 0.5).into(),
                added_s: Some(1.0),
                removed_s: None,
            }],
            drawn: Vec::new(),
            checks: Vec::new(),
            points: 0.0,
            max_points: 0.0,
        }
        .with_checks(vec![CheckReport {
            name: "touches nothing".into(),
            kind: "contacts".into(),
            passed: false,
            broken: false,
            points: 0.0,
            max_points: 3.0,
            at_s: Some(5.25),
            x_m: Some(1.25),
            y_m: Some(0.83),
            value: Some(1.0),
            series: None,
            message: "r1 touched a wall at 5.250 s at (1250, 830) mm (first)".into(),
        }])
    }

    #[test]
    fn report_has_the_documented_schema() {
        insta::assert_snapshot!(report().to_json().unwrap());
    }

    /// Names of all keys in `value`.
    fn keys(value: &serde_json::Value, found: &mut std::collections::BTreeSet<String>) {
        match value {
            serde_json::Value::Object(map) => map.iter().for_each(|(key, value)| {
                found.insert(key.clone());
                keys(value, found);
            }),
            serde_json::Value::Array(list) => list.iter().for_each(|value| keys(value, found)),
            _ => {}
        }
    }

    #[test]
    fn page_documents_every_field() {
        let page = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/report.md")).unwrap();
        let mut found = std::collections::BTreeSet::new();
        keys(&serde_json::to_value(report()).unwrap(), &mut found);
        assert!(found.len() > 20);
        for key in found {
            assert!(page.contains(&format!("| `{key}` |")), "docs/report.md has no row of `{key}`");
        }
        for outcome in ["finished", "running", "waiting", "interrupted", "failed", "timeout", "no_program"] {
            assert!(page.contains(&format!("`{outcome}`")), "docs/report.md does not explain `{outcome}`");
        }
    }

    #[test]
    fn poses_are_written_exactly() {
        let mut report = report();
        let x_m = 0.1 + 0.2;
        report.robots[0].pose = PlanarPose { x_m, y_m: 1e-300, phi_rad: -0.0 };
        let value: serde_json::Value = serde_json::from_str(&report.to_json().unwrap()).unwrap();
        let pose = &value["robots"][0]["pose"];
        assert_eq!(pose["x_m"].as_f64().map(f64::to_bits), Some(x_m.to_bits()));
        assert_eq!(pose["y_m"].as_f64().map(f64::to_bits), Some(1e-300_f64.to_bits()));
        assert_eq!(pose["phi_rad"].as_f64().map(f64::to_bits), Some((-0.0_f64).to_bits()));
    }

    #[test]
    fn non_finite_number_gives_an_error() {
        let mut report = report();
        report.robots[1].path_m = f64::NAN;
        assert_eq!(report.to_json().unwrap_err().to_string(), "cannot write the report: a number of the report is NaN");
    }

    #[test]
    fn report_replaces_the_old_file_without_leftovers() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.json");
        fs::write(&path, "old").unwrap();
        report().write(&path).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), report().to_json().unwrap());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn symbolic_link_is_followed() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("r.json"), folder.path().join("latest.json"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink("r.json", &link).unwrap();
        write_atomically(&link, b"new").unwrap();
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        write_atomically(Path::new("/dev/null"), b"new").unwrap();
    }

    #[test]
    fn write_error_names_the_path() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing/r.json");
        let message = report().write(&path).unwrap_err().to_string();
        assert!(message.starts_with(&format!("cannot write the report `{}`: ", path.display())), "{message}");
    }

    #[test]
    fn inputs_are_hashed_with_sha256() {
        // The test vector of FIPS 180-2 for "abc".
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(Input::new(Path::new("a"), b"abc"), Input { path: "a".into(), sha256: expected.into() });
    }
}
