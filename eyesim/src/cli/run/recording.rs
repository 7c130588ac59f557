//! Creates the MCAP recording of a run.

use std::path::Path;
use std::sync::Arc;

use sim_core::ObjectId;
use sim_core::build;
use sim_core::spec::ObjectSpec;
use sim_host::launch::Ready;
use sim_host::record::Mcap;
use sim_host::record::mcap::InitialContents;
use sim_view::protocol;

use crate::window::scene::{ObjectInput, RobotInput, SceneInput};

/// Creates the recording of a run at `path`; the run must keep its frames.
pub(super) fn create(path: &Path, ready: &Ready) -> anyhow::Result<Mcap> {
    let (scene, settings) = (ready.scene(), ready.settings());
    let robot = |robot: &sim_core::spec::RobotSpec| RobotInput {
        id: robot.id,
        robi: Arc::clone(&robot.robi),
        program: robot.program_name().to_owned(),
        position: robot.start.position,
        has_colours: false,
    };
    let object = |(id, object): (u32, &ObjectSpec)| ObjectInput {
        id: ObjectId(id),
        kind: Arc::clone(&object.kind),
        position: object.pose.position,
    };
    let scene_input = SceneInput {
        run: 1,
        seed: settings.seed,
        slot: settings.slot,
        spec: scene,
        scenery: &ready.scenery().get(),
        robots: scene.robots.iter().map(robot).collect(),
        objects: (1..).zip(build::movable_objects(scene)).map(object).collect(),
        addable_types: protocol::AddableTypes::default(),
    };
    let contents = InitialContents {
        seed: settings.seed,
        slot: settings.slot,
        scene: scene_input.scene(),
        robots: scene.robots.iter().map(|robot| (robot.start, ready.start_height(robot.id))).collect(),
        objects: build::movable_objects(scene).map(|object| object.pose).collect(),
        frames: ready.frames().cloned().unwrap_or_default(),
    };
    Ok(Mcap::create(path, contents)?)
}
