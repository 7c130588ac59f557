//! Results of a finished run.

use std::sync::Arc;

use sim_core::ObjectId;
use sim_core::pose::Pose;
use sim_core::record::Outcome;
use sim_core::spec::{ObjectSpec, RobotSpec, SceneSpec};
use sim_core::time::Time;
use sim_core::world::Lifetime;

use super::settings::Settings;
use crate::executive::scheduler::{Ended, RobotEnd};
use crate::program::scene::shown_name;
use crate::record::Report;
use crate::record::notes::Notes;
use crate::record::report::{DrawnReport, Input, ObjectReport, REPORT_SCHEMA, RobotReport};
use crate::scenery::LazyScenery;

/// A finished run.
pub struct Finished {
    /// Settings of the run from the scene and the options.
    pub settings: Settings,
    /// The scene.
    pub scene: Arc<SceneSpec>,
    /// Scenery of its cameras.
    pub scenery: Arc<LazyScenery>,
    /// State at the end of the run: world and robots.
    pub ended: Ended,
    /// The results as a report, which can be written to a file.
    pub report: Report,
    /// Messages to the user about metrics that programs printed, and about programs that did not use their robots; one
    /// line each.
    pub remarks: Vec<String>,
}

/// Remarks on the programs that ended well without any call of RoBIOS.
pub(super) fn remarks_on_idle_programs(ended: &Ended, report: &Report) -> impl Iterator<Item = String> {
    /// Maximum number of robots that are named.
    const MAX: usize = 3;
    let is_idle = |(end, _): &(&RobotEnd, &RobotReport)| end.outcome == Outcome::Finished && !end.has_called;
    ended.robots.iter().zip(&report.robots).filter(is_idle).take(MAX).map(|(_, robot)| {
        format!("r{} (`{}`) has called no function of RoBIOS: its robot has done nothing", robot.id, robot.program)
    })
}

/// Report of the run with these inputs.
pub(super) fn report(
    settings: &Settings,
    scene: &SceneSpec,
    ended: &Ended,
    inputs: Vec<Input>,
    notes: &Notes,
) -> Report {
    let spawner = ended.run.spawner();
    let world = ended.run.world();
    let added = |lifetime: Lifetime| (lifetime.since >= Time::ZERO).then(|| lifetime.since.seconds());
    let removed = |lifetime: Lifetime| (lifetime.until < Time::NEVER).then(|| lifetime.until.seconds());
    let robot = |(spec, end): (&RobotSpec, &RobotEnd)| RobotReport {
        id: spec.id.0,
        name: spec.robi.name.clone(),
        program: shown_name(spec, scene),
        outcome: end.outcome,
        reason: end.reason.clone(),
        exit_code: end.exit_code,
        virtual_time_s: end.virtual_time.seconds(),
        start: spec.start.into(),
        pose: end.pose.into(),
        depth_m: end.depth,
        odometry: Some(end.odometry.into()),
        path_m: end.path,
        contacts: u64::from(end.contacts),
        contact_times_s: notes.of(spec.id).contact_times.clone(),
        hints: notes.of(spec.id).hints.clone(),
        metrics: notes.of(spec.id).metrics.clone(),
        forbidden_calls: notes.of(spec.id).forbidden_calls.clone(),
        left_floor_s: end.left_floor.map(Time::seconds),
        footfalls: end.steps.map(|[footfalls, _]| footfalls),
        touches: end.steps.map(|[_, touches]| touches),
        lcd: end.panel.lines(),
        output_cut_bytes: end.output_cut,
        added_s: added(world.robot_lifetime(spec.id)),
        removed_s: removed(world.robot_lifetime(spec.id)),
    };
    let object = |(id, (spec, end)): (u32, (&ObjectSpec, &Pose))| ObjectReport {
        id,
        name: spec.kind.name.clone(),
        start: spec.pose.into(),
        pose: (*end).into(),
        added_s: added(world.object_lifetime(ObjectId(id))),
        removed_s: removed(world.object_lifetime(ObjectId(id))),
    };
    Report {
        schema: REPORT_SCHEMA,
        eyesim_version: env!("CARGO_PKG_VERSION").into(),
        argv: std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect(),
        inputs,
        seed: settings.seed,
        slot_us: settings.slot.0,
        sim_time_s: ended.time.seconds(),
        real_time_s: ended.real_time.as_secs_f64(),
        digest: ended.digest,
        robots: spawner.roster().robots().iter().zip(&ended.robots).map(robot).collect(),
        objects: (1..).zip(spawner.roster().objects().iter().zip(&ended.objects)).map(object).collect(),
        drawn: scene
            .drawn
            .iter()
            .map(|drawn| DrawnReport { path: drawn.path.clone(), value: drawn.value.clone() })
            .collect(),
        checks: Vec::new(),
        sandbox: None,
        points: 0.0,
        max_points: 0.0,
    }
}
