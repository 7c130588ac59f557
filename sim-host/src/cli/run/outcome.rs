//! A run that is over, and the files that tell of it.

use std::path::Path;
use std::sync::Arc;

use glam::DVec2;
use parking_lot::Mutex;
use sim_core::ObjectId;
use sim_core::build;
use sim_core::pose::Pose;
use sim_core::spec::{ObjectSpec, RobotSpec, SceneSpec};
use sim_core::time::Time;
use sim_core::world::Presence;

use super::RunArgs;
use super::stage::given;
use crate::cli::options::Options;
use crate::cli::output;
use crate::executive::scheduler::{Ended, RobotEnd};
use crate::plot::{self, RunObject, RunPicture, RunRobot};
use crate::record::report::{Input, ObjectReport, REPORT_SCHEMA, RobotReport};
use crate::record::trail::Way;
use crate::record::{Report, Trails};
use crate::scenery::LazyScenery;

/// A run that is over.
pub struct Ran {
    /// What the command line and the scene said of it.
    pub options: Options,
    /// What was run.
    pub scene: Arc<SceneSpec>,
    /// What its cameras see.
    pub scenery: Arc<LazyScenery>,
    /// How it ended.
    pub ended: Ended,
    /// The same for people and programs.
    pub report: Report,
    pub(super) trails: Option<Arc<Mutex<Trails>>>,
}

impl Ran {
    /// Writes the report and the plot that the arguments ask for.
    ///
    /// # Errors
    /// The first file that cannot be written; it keeps no other from being written.
    pub fn write_files(&self, args: &RunArgs) -> anyhow::Result<()> {
        if self.scenery.built().is_some() {
            // Images that cameras have seen meanwhile are inputs, too.
            let outputs = [("--report", &args.report), ("--plot", &args.plot)];
            output::check_outputs(&given(&outputs), self.report.inputs.iter().map(|input| input.path.as_str()))?;
        }
        let plot = args.plot.as_ref().zip(self.trails.as_ref());
        let written = [
            args.report.as_ref().map(|path| Ok(self.report.write(path)?)),
            plot.map(|(path, trails)| write_plot(path, &self.scene, &trails.lock(), &self.ended)),
        ];
        written.into_iter().flatten().collect()
    }
}

/// All robots and movable objects that ever were in the run, in order of their ids.
fn cast(scene: &SceneSpec, ended: &Ended) -> (Vec<RobotSpec>, Vec<ObjectSpec>) {
    match &*ended.run.workshop() {
        Some(workshop) => (workshop.roster().robots().to_vec(), workshop.roster().objects().to_vec()),
        None => (scene.robots.clone(), build::movable(scene).cloned().collect()),
    }
}

/// What became of the run, with these inputs.
pub(super) fn report(options: &Options, scene: &SceneSpec, ended: &Ended, inputs: Vec<Input>) -> Report {
    let (robots, objects) = cast(scene, ended);
    let world = ended.run.world();
    let added = |presence: Presence| (presence.since >= Time::ZERO).then(|| presence.since.seconds());
    let removed = |presence: Presence| (presence.until < Time::NEVER).then(|| presence.until.seconds());
    let robot = |(spec, end): (&RobotSpec, &RobotEnd)| RobotReport {
        id: spec.id.0,
        name: spec.robi.name.clone(),
        program: spec.program_name().to_owned(),
        outcome: end.outcome,
        reason: end.reason.clone(),
        exit_code: end.exit_code,
        virtual_time_s: end.virtual_time.seconds(),
        pose: end.pose.into(),
        odometry: Some(end.odometry.into()),
        path_m: end.path,
        contacts: u64::from(end.contacts),
        footfalls: end.steps.map(|[footfalls, _]| footfalls),
        touches: end.steps.map(|[_, touches]| touches),
        lcd: end.panel.lines(),
        added_s: added(world.robot_presence(spec.id)),
        removed_s: removed(world.robot_presence(spec.id)),
    };
    let object = |(id, (spec, end)): (u32, (&ObjectSpec, &Pose))| ObjectReport {
        id,
        name: spec.kind.name.clone(),
        start: spec.pose.into(),
        pose: (*end).into(),
        added_s: added(world.object_presence(ObjectId(id))),
        removed_s: removed(world.object_presence(ObjectId(id))),
    };
    Report {
        schema: REPORT_SCHEMA,
        eyesim_version: env!("CARGO_PKG_VERSION").into(),
        argv: std::env::args().collect(),
        inputs,
        seed: options.seed,
        slot_us: options.slot.0,
        sim_time_s: ended.time.seconds(),
        real_time_s: ended.real_time.as_secs_f64(),
        digest: ended.digest,
        robots: robots.iter().zip(&ended.robots).map(robot).collect(),
        objects: (1..).zip(objects.iter().zip(&ended.objects)).map(object).collect(),
    }
}

/// Writes the picture of the run.
fn write_plot(path: &Path, scene: &SceneSpec, trails: &Trails, ended: &Ended) -> anyhow::Result<()> {
    let (robots, movable) = cast(scene, ended);
    let robot = |((spec, end), trail): ((&RobotSpec, &RobotEnd), &Way)| RunRobot {
        id: spec.id.0,
        robi: Arc::clone(&spec.robi),
        start: spec.start,
        end: end.pose,
        trails: trail.lines(),
    };
    let robots: Vec<RunRobot> = robots.iter().zip(&ended.robots).zip(trails.trails()).map(robot).collect();
    let object = |object: &ObjectSpec, end: Pose, trails: Vec<Vec<DVec2>>| RunObject {
        kind: Arc::clone(&object.kind),
        start: object.pose,
        end,
        trails,
    };
    let fixed = scene.objects.iter().filter(|spec| spec.kind.is_fixed);
    let fixed = fixed.map(|spec| object(spec, spec.pose, Vec::new()));
    let moved = movable.iter().zip(ended.objects.iter().zip(trails.objects()));
    let moved = moved.map(|(spec, (end, trail))| object(spec, *end, trail.lines()));
    let objects: Vec<RunObject> = fixed.chain(moved).collect();
    let drawing = plot::draw_run(&RunPicture {
        title: &scene.file,
        world: &scene.world,
        markers: &scene.markers,
        robots: &robots,
        objects: &objects,
        contacts: trails.contacts(),
    });
    Ok(plot::write(&drawing, path, None)?)
}
