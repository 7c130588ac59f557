//! Shows a run to the pages of a window between two slots.

use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::simulation::Roster;
use sim_core::spec::SceneSpec;
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};
use sim_format::LiveEntity;
use sim_host::check::{self, Progress, Standing, Tally};
use sim_host::executive::run::Run;
use sim_host::executive::scheduler::RobotEnd;
use sim_host::record::report::CheckReport;
use sim_host::robios::panel::Panel;
use sim_host::scenery::LazyScenery;
use sim_view::protocol::{AddableTypes, CheckState, CheckVerdict, Detail, Reading, RunState, Scene, Snapshot};
use sim_view::window::{Look, Window};

use super::detail::Details;
use super::feed::Feed;
use super::layer::ShownLayers;
use super::scene::{ObjectInput, RobotInput, SceneInput};
use super::snapshot;

/// Shows a run to its pages, and stores what they have already received.
pub struct Show {
    window: Arc<Window>,
    run: u32,
    seed: u64,
    slot: Time,
    spec: Arc<SceneSpec>,
    scenery: Arc<LazyScenery>,
    feed: Arc<Mutex<Feed>>,
    tally: Option<Arc<Mutex<Tally>>>,
    /// The bodies in the scene that pages received last.
    bodies: Option<BodySet>,
    /// All bodies of the run so far, including removed ones, at their starts.
    roster: (Vec<RobotInput>, Vec<ObjectInput>),
    /// Poses of the bodies when the run was shown last.
    body_poses: BodyPoses,
    /// Robots whose details pages request.
    looks: Vec<Look>,
    details: Details,
    layers: ShownLayers,
}

/// The robots and the movable objects that are in the world.
#[derive(Clone, Debug, PartialEq, Eq)]
struct BodySet {
    robots: Vec<RobotId>,
    objects: Vec<ObjectId>,
}

/// Parts of a [`Show`].
pub struct ShowParts {
    /// Window that shows the run.
    pub window: Arc<Window>,
    /// Number of the run since the window was opened, from 1.
    pub run: u32,
    /// Seed of the run.
    pub seed: u64,
    /// Length of a slot.
    pub slot: Time,
    /// Its scene.
    pub spec: Arc<SceneSpec>,
    /// Scenery that its cameras see.
    pub scenery: Arc<LazyScenery>,
    /// Events and readings of the run.
    pub feed: Arc<Mutex<Feed>>,
    /// Events that its checks count.
    pub tally: Option<Arc<Mutex<Tally>>>,
}

/// Types and poses of the robots and movable objects in the world.
#[derive(Clone, Debug, Default)]
pub struct BodyPoses {
    /// Robots in the order of their numbers.
    pub robots: Vec<LiveEntity>,
    /// Objects in the order of their numbers.
    pub objects: Vec<LiveEntity>,
}

/// State of a run when it is shown.
pub struct Moment<'a> {
    /// The run; all its robots are suspended.
    pub run: &'a Run,
    /// Its world.
    pub world: &'a World,
    /// Simulated time that the run has reached: the start of a slot, at or after the world's slot.
    pub now: Time,
    /// State of the run.
    pub state: RunState,
    /// Requested speed: simulated seconds per second of wall-clock time; none for as fast as possible.
    pub speed: Option<f64>,
    /// Measured speed: simulated seconds per second of wall-clock time.
    pub rate: f64,
    /// Ends of its robots, once the run is over.
    pub ends: &'a [RobotEnd],
    /// Results of its checks, once the run is over.
    pub results: Option<&'a [CheckReport]>,
}

impl Show {
    /// Begins a run of which pages have received nothing yet.
    pub fn new(parts: ShowParts) -> Self {
        let ShowParts { window, run, seed, slot, spec, scenery, feed, tally } = parts;
        window.begin_run(run);
        Self {
            window,
            run,
            seed,
            slot,
            spec,
            scenery,
            feed,
            tally,
            bodies: None,
            roster: Default::default(),
            body_poses: BodyPoses::default(),
            looks: Vec::new(),
            details: Details::default(),
            layers: ShownLayers::default(),
        }
    }

    /// Shows the run; if no page is connected, only events are kept, for later pages.
    pub fn present(&mut self, moment: Moment<'_>) {
        let Moment { run, world, now, state, speed, rate, ends, results } = moment;
        self.update_looks(run);
        self.body_poses = body_poses(run, world);
        self.update_roster(run, ends);
        let (events, omitted) = self.feed.lock().take_events();
        if !self.window.has_pages() {
            self.window.add_events(events, omitted);
            return;
        }
        self.set_scene(run, world);
        self.window.add_events(events, omitted);
        let Some(BodySet { robots, objects }) = self.bodies.clone() else { return };
        let is_at_rest = state != RunState::Running;
        // An idle run is shown again and again, as a running one.
        let goes_on = matches!(state, RunState::Running | RunState::Idle);
        let selected = self.looks.iter().map(|look| RobotId(look.robot)).filter(|id| robots.contains(id));
        let selected: Vec<RobotId> = selected.collect();
        let others = robots.iter().copied().filter(|id| !selected.contains(id));
        let snapshot = Snapshot {
            run: self.run,
            t_s: now.seconds(),
            state,
            speed,
            rate,
            robots: snapshot::robots(run, world, robots.iter().copied()),
            objects: snapshot::objects(world, objects.into_iter()),
            beams: snapshot::beams(run, world, selected.iter().copied().chain(others)),
            checks: self.checks(run, now, results),
        };
        let details = self.looks.clone().into_iter().filter(|look| selected.contains(&RobotId(look.robot)));
        let details = details.map(|look| self.detail(run, world, look, ends, goes_on)).collect();
        self.window.show(snapshot, details);
        self.window.show_layers(self.layers.changed(run, selected.into_iter(), self.run, is_at_rest));
    }

    /// States of the checks of the scene; `results` are the final results of a run that is over.
    fn checks(&self, run: &Run, now: Time, results: Option<&[CheckReport]>) -> Vec<CheckState> {
        if self.spec.checks.is_empty() {
            return Vec::new();
        }
        let environment = run.environment();
        let tally = self.tally.as_ref().map(|tally| tally.lock());
        let standings = check::standings(&self.spec.checks, environment.monitor(), tally.as_deref(), now);
        let state = |(index, standing): (usize, Standing)| {
            let (verdict, text) = match results.and_then(|results| results.get(index)) {
                Some(result) if result.passed => (CheckVerdict::Met, result.message.clone()),
                Some(result) => (CheckVerdict::Failed, result.message.clone()),
                None => (verdict(standing.progress), standing.message),
            };
            CheckState { name: self.spec.checks[index].title().to_owned(), verdict, text, value: standing.value }
        };
        standings.into_iter().enumerate().map(state).collect()
    }

    /// Returns true if pages have selected other robots since the last update, or if the first page has connected.
    pub fn has_new_looks(&self) -> bool {
        self.window.looks() != self.looks || self.bodies.is_none() && self.window.has_pages()
    }

    /// Adopts the pages' selection of robots. Of the robots that are or were selected, records the RoBIOS calls of
    /// exactly those whose calls a page requests or a check counts.
    fn update_looks(&mut self, run: &Run) {
        let looks = self.window.looks();
        if looks == self.looks {
            return;
        }
        let tally = self.tally.as_ref().map(|tally| tally.lock());
        let wants_calls = |robot| {
            looks.iter().any(|look| look.robot == robot && look.calls)
                || tally.as_ref().is_some_and(|tally| tally.counts_calls_of(RobotId(robot)))
        };
        for Look { robot, .. } in self.looks.iter().chain(&looks) {
            if (1..=run.robot_count()).contains(&(*robot as usize)) {
                run.set_verbose(RobotId(*robot), wants_calls(*robot));
            }
        }
        drop(tally);
        self.looks = looks;
    }

    /// Shows the scene if pages have not received it or if bodies were added or removed.
    fn set_scene(&mut self, run: &Run, world: &World) {
        let bodies = BodySet::of(world);
        if self.bodies.as_ref() == Some(&bodies) {
            return;
        }
        let at = world.slot_start();
        let (robots, objects) = &self.roster;
        let robot =
            |id: &RobotId| RobotInput { position: world.robot_pose(*id, at).position, ..robots[id.index()].clone() };
        let object = |id: &ObjectId| ObjectInput {
            position: world.object_pose(*id, at).position,
            ..objects[id.index()].clone()
        };
        let input = SceneInput {
            run: self.run,
            seed: self.seed,
            slot: self.slot,
            spec: &self.spec,
            scenery: &self.scenery.get(),
            robots: bodies.robots.iter().map(robot).collect(),
            objects: bodies.objects.iter().map(object).collect(),
            addable_types: addable_types(run.spawner().roster()),
        };
        self.window.show_scene(input.scene());
        self.bodies = Some(bodies);
    }

    /// Adds new bodies to the roster. At the end of the run, the displays are in `ends`.
    fn update_roster(&mut self, run: &Run, ends: &[RobotEnd]) {
        let spawner = run.spawner();
        let (robots, objects) = (spawner.roster().robots(), spawner.roster().objects());
        if (self.roster.0.len(), self.roster.1.len()) == (robots.len(), objects.len()) {
            return;
        }
        let robot = |spec| {
            let robot = RobotInput::at_start(spec);
            let end = ends.get(robot.id.index());
            let has_colours = end.map_or_else(
                || run.robot(robot.id).robios.is_of_robios7(),
                |end| matches!(end.panel, Panel::Colour(_)),
            );
            RobotInput { has_colours, ..robot }
        };
        let objects = (1..).map(ObjectId).zip(objects);
        self.roster =
            (robots.iter().map(robot).collect(), objects.map(|(id, spec)| ObjectInput::at_start(id, spec)).collect());
    }

    /// Scene with all bodies of the run so far, including removed ones. The run continues while it is built.
    pub fn recorded_scene(show: &Mutex<Self>) -> Scene {
        let show = show.lock();
        let (run, seed, slot, (robots, objects)) = (show.run, show.seed, show.slot, show.roster.clone());
        let (spec, scenery) = (Arc::clone(&show.spec), Arc::clone(&show.scenery));
        drop(show);
        let (spec, scenery, addable_types) = (&*spec, &*scenery.get(), AddableTypes::default());
        SceneInput { run, seed, slot, spec, scenery, robots, objects, addable_types }.scene()
    }

    /// Types and poses of the bodies when the run was shown last.
    pub fn body_poses(&self) -> &BodyPoses {
        &self.body_poses
    }

    fn detail(&mut self, run: &Run, world: &World, look: Look, ends: &[RobotEnd], goes_on: bool) -> Detail {
        let id = RobotId(look.robot);
        let panel = ends.get(id.index()).map(|end| end.panel.as_ref());
        let detail = self.details.robot(run, world, id, panel);
        let camera = look.camera.then(|| self.details.camera(run, world, id, &self.scenery, goes_on)).flatten();
        let mut readings = self.feed.lock().readings(id);
        let at = world.slot_start();
        let depth = run.robot(id).motion.depth(at);
        readings.extend(depth.map(|depth| Reading {
            name: "depth".to_owned(),
            value: Some(depth),
            unit: "m".to_owned(),
            at_s: at.seconds(),
        }));
        Detail { run: self.run, camera, readings, ..detail }
    }
}

fn verdict(progress: Progress) -> CheckVerdict {
    match progress {
        Progress::Open => CheckVerdict::Open,
        Progress::Met => CheckVerdict::Met,
        Progress::Failed => CheckVerdict::Failed,
    }
}

impl BodySet {
    fn of(world: &World) -> Self {
        let at = world.slot_start();
        let robots = (0..world.robot_count()).map(RobotId::from_index).filter(|id| world.is_robot_present(*id, at));
        let objects = (0..world.object_count()).map(ObjectId::from_index).filter(|id| world.is_object_present(*id, at));
        Self { robots: robots.collect(), objects: objects.collect() }
    }
}

/// Types of robots and objects that can be added.
fn addable_types(roster: &Roster) -> AddableTypes {
    let robots = roster.robot_types.names().map(str::to_owned).collect();
    AddableTypes { robots, objects: roster.object_types.names().map(str::to_owned).collect() }
}

fn body_poses(run: &Run, world: &World) -> BodyPoses {
    let spawner = run.spawner();
    let (BodySet { robots, objects }, at) = (BodySet::of(world), world.slot_start());
    let robot = |id: &RobotId| {
        let (kind, pose) = (spawner.roster().robots()[id.index()].robi.name.clone(), world.robot_pose(*id, at));
        LiveEntity { number: id.0, kind, pose }
    };
    let object = |id: &ObjectId| {
        let (kind, pose) = (spawner.roster().objects()[id.index()].kind.name.clone(), world.object_pose(*id, at));
        LiveEntity { number: id.0, kind, pose }
    };
    BodyPoses { robots: robots.iter().map(robot).collect(), objects: objects.iter().map(object).collect() }
}
