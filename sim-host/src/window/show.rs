//! Shows a run to the pages of a window, whenever it stands between two slots.

use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::build;
use sim_core::format::SceneSpec;
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};
use sim_view::protocol::{Detail, RunState, Snapshot, Workshop};
use sim_view::window::{Look, Window};

use super::detail::Details;
use super::feed::Feed;
use super::scene::{ObjectSubject, RobotSubject, Subject};
use super::snapshot;
use crate::executive::run::{RobotEnd, Run};
use crate::scenery::LazyScenery;

/// What is shown of a run, and what pages have got already.
pub struct Show {
    window: Arc<Window>,
    run: u32,
    seed: u64,
    slot: Time,
    spec: Arc<SceneSpec>,
    scenery: Arc<LazyScenery>,
    feed: Arc<Mutex<Feed>>,
    workshop: Workshop,
    /// The bodies of the scene that pages have got.
    cast: Option<Cast>,
    /// Robots of which pages have chosen to see more.
    looks: Vec<Look>,
    details: Details,
}

/// The robots and the movable objects that are in the world.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Cast {
    robots: Vec<RobotId>,
    objects: Vec<ObjectId>,
}

/// What a show is made of.
pub struct ShowParts {
    /// Where it is shown.
    pub window: Arc<Window>,
    /// Number of the run since the window was opened, from 1.
    pub run: u32,
    /// Seed of the run.
    pub seed: u64,
    /// Length of a slot.
    pub slot: Time,
    /// Its scene.
    pub spec: Arc<SceneSpec>,
    /// What its cameras see.
    pub scenery: Arc<LazyScenery>,
    /// What happens in it.
    pub feed: Arc<Mutex<Feed>>,
    /// What can be added to it.
    pub workshop: Workshop,
}

/// How a run stands when it is shown.
pub struct Moment<'a> {
    /// The run; all its robots are suspended.
    pub run: &'a Run,
    /// Its world.
    pub world: &'a World,
    /// The time to which it has come: the start of a slot, not before that of the world's.
    pub now: Time,
    /// How it stands.
    pub state: RunState,
    /// The speed that was asked for.
    pub speed: Option<f64>,
    /// The speed that it has.
    pub rate: f64,
    /// How its robots ended, once it is over.
    pub ends: &'a [RobotEnd],
}

impl Show {
    /// A show of which nothing has been seen.
    pub fn new(parts: ShowParts) -> Self {
        let ShowParts { window, run, seed, slot, spec, scenery, feed, workshop } = parts;
        let (cast, looks, details) = (None, Vec::new(), Details::default());
        Self { window, run, seed, slot, spec, scenery, feed, workshop, cast, looks, details }
    }

    /// Shows the run as it stands; without pages only what has happened is kept for those to come.
    pub fn present(&mut self, moment: Moment<'_>) {
        let Moment { run, world, now, state, speed, rate, ends } = moment;
        self.look(run);
        let events = self.feed.lock().take_events();
        if !self.window.has_pages() {
            self.window.tell(events);
            return;
        }
        self.set_scene(run, world);
        self.window.tell(events);
        let Some(Cast { robots, objects }) = self.cast.clone() else { return };
        let chosen = self.looks.iter().map(|look| RobotId(look.robot)).filter(|id| robots.contains(id));
        let chosen: Vec<RobotId> = chosen.collect();
        let others = robots.iter().copied().filter(|id| !chosen.contains(id));
        let snapshot = Snapshot {
            run: self.run,
            t_s: now.seconds(),
            state,
            speed,
            rate,
            robots: snapshot::robots(run, world, robots.iter().copied()),
            objects: snapshot::objects(world, objects.into_iter()),
            beams: snapshot::beams(run, world, chosen.iter().copied().chain(others)),
        };
        let details = self.looks.clone().into_iter().filter(|look| chosen.contains(&RobotId(look.robot)));
        let details = details.map(|look| self.detail(run, world, look, ends)).collect();
        self.window.show(snapshot, details);
    }

    /// Whether pages have chosen other robots since they were last shown anything, or have come.
    pub fn has_new_looks(&self) -> bool {
        self.window.looks() != self.looks || self.cast.is_none() && self.window.has_pages()
    }

    /// Lets the calls of those robots be recorded whose calls a page wants to see.
    fn look(&mut self, run: &Run) {
        let looks = self.window.looks();
        if looks == self.looks {
            return;
        }
        let wants_calls = |looks: &[Look], robot| looks.iter().any(|look| look.robot == robot && look.calls);
        for Look { robot, .. } in self.looks.iter().chain(&looks) {
            if (1..=run.robot_count()).contains(&(*robot as usize)) {
                run.listen_to(RobotId(*robot), wants_calls(&looks, *robot));
            }
        }
        self.looks = looks;
    }

    /// Shows what there is to see, if pages have not got it or bodies have come or gone.
    fn set_scene(&mut self, run: &Run, world: &World) {
        let at = world.slot_start();
        let robots = (0..world.robot_count()).map(RobotId::from_index).filter(|id| world.is_robot_there(*id, at));
        let objects = (0..world.object_count()).map(ObjectId::from_index).filter(|id| world.is_object_there(*id, at));
        let cast = Cast { robots: robots.collect(), objects: objects.collect() };
        if self.cast.as_ref() == Some(&cast) {
            return;
        }
        let robot = |id: &RobotId| {
            let robot = run.robot(*id);
            let program = self.spec.robots.get(id.index()).map_or("", |spec| spec.program_name());
            RobotSubject {
                id: *id,
                robi: Arc::clone(&robot.spec),
                program: if program.is_empty() { robot.program.clone() } else { program.to_owned() },
                position: world.robot_pose(*id, at).position,
                has_colours: robot.devices.screen.is_some(),
            }
        };
        let kinds: Vec<_> = build::movable(&self.spec).map(|object| Arc::clone(&object.kind)).collect();
        let object = |id: &ObjectId| {
            let position = world.object_pose(*id, at).position;
            Some(ObjectSubject { id: *id, kind: Arc::clone(kinds.get(id.index())?), position })
        };
        let subject = Subject {
            run: self.run,
            seed: self.seed,
            slot: self.slot,
            spec: &self.spec,
            scenery: &self.scenery.get(),
            robots: cast.robots.iter().map(robot).collect(),
            objects: cast.objects.iter().filter_map(object).collect(),
            workshop: self.workshop.clone(),
        };
        self.window.show_scene(subject.scene());
        self.cast = Some(cast);
    }

    fn detail(&mut self, run: &Run, world: &World, look: Look, ends: &[RobotEnd]) -> Detail {
        let id = RobotId(look.robot);
        let panel = ends.get(id.index()).map(|end| end.panel.as_ref());
        let detail = self.details.of(run, world, id, panel);
        let camera = look.camera.then(|| self.details.camera(run, world, id, &self.scenery)).flatten();
        Detail { run: self.run, camera, readings: self.feed.lock().readings(id), ..detail }
    }
}
