//! Who records a run: those whom the arguments ask for.

use std::path::Path;
use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::ObjectId;
use sim_core::build;
use sim_core::pose::Pose;
use sim_core::spec::{ObjectSpec, SceneSpec};
use sim_core::time::Time;
use sim_view::protocol;

use super::RunArgs;
use crate::cli::options::Options;
use crate::cli::progress::Progress;
use crate::record::frame::Frames;
use crate::record::mcap::Beginning;
use crate::record::report::Input;
use crate::record::trace::{TraceHeader, TraceRobot};
use crate::record::{Log, Mcap, Sink, Trails};
use crate::scenery::LazyScenery;
use crate::window::scene::{ObjectSubject, RobotSubject, Subject};

/// The first line of a trace of the run that `args` ask for.
pub fn trace_header(
    args: &RunArgs,
    options: &Options,
    scene: &SceneSpec,
    until: Time,
    inputs: &[Input],
) -> TraceHeader {
    let robot = |robot: &sim_core::spec::RobotSpec| TraceRobot {
        id: robot.id.0,
        name: robot.robi.name.clone(),
        program: robot.program_name().to_owned(),
    };
    TraceHeader {
        seed: options.seed,
        slot_us: options.slot.0,
        robots: scene.robots.iter().map(robot).collect(),
        run: args.words(options.seed, options.slot, until),
        inputs: inputs.to_vec(),
    }
}

/// Sinks, and the trails among them that are looked at after the run.
type SinksAndTrails = (Vec<Box<dyn Sink>>, Option<Arc<Mutex<Trails>>>);

/// The sinks that the arguments ask for, and the one of them that the plot shows at the end.
pub(super) fn sinks(args: &RunArgs, options: &Options, scene: &SceneSpec, progress: &Progress) -> SinksAndTrails {
    let mut all: Vec<Box<dyn Sink>> = Vec::new();
    if !args.is_silent {
        all.push(Box::new(Log::new(options.filter.clone(), progress.stdout(), progress.stderr())));
    }
    let trails = args.plot.is_some().then(|| {
        let starts: Vec<Pose> = scene.robots.iter().map(|robot| robot.start).collect();
        let objects: Vec<Pose> = build::movable(scene).map(|object| object.pose).collect();
        Arc::new(Mutex::new(Trails::new(&starts, &objects)))
    });
    all.extend(trails.iter().map(|trails| Box::new(Arc::clone(trails)) as Box<dyn Sink>));
    (all, trails)
}

/// The recording at `path`, of what `frames` keeps beside the events.
pub(super) fn recording(
    path: &Path,
    options: &Options,
    scene: &SceneSpec,
    scenery: &LazyScenery,
    frames: Arc<Frames>,
) -> anyhow::Result<Mcap> {
    let robot = |robot: &sim_core::spec::RobotSpec| RobotSubject {
        id: robot.id,
        robi: Arc::clone(&robot.robi),
        program: robot.program_name().to_owned(),
        position: robot.start.position,
        has_colours: false,
    };
    let object = |(id, object): (u32, &ObjectSpec)| ObjectSubject {
        id: ObjectId(id),
        kind: Arc::clone(&object.kind),
        position: object.pose.position,
    };
    let shown = Subject {
        run: 1,
        seed: options.seed,
        slot: options.slot,
        spec: scene,
        scenery: &scenery.get(),
        robots: scene.robots.iter().map(robot).collect(),
        objects: (1..).zip(build::movable(scene)).map(object).collect(),
        workshop: protocol::Workshop::default(),
    };
    let beginning = Beginning {
        seed: options.seed,
        slot: options.slot,
        scene: shown.scene(),
        robots: scene.robots.iter().map(|robot| robot.start).collect(),
        objects: build::movable(scene).map(|object| object.pose).collect(),
        frames,
    };
    Ok(Mcap::create(path, beginning)?)
}
