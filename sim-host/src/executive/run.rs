//! One run: its robots, its world and its slot loop, started, supervised and brought to an end.

use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};
use std::sync::{Arc, Weak};
use std::time::{Duration, Instant};

use parking_lot::{MappedRwLockReadGuard, Mutex, MutexGuard, RwLock, RwLockReadGuard};
use robios_sys::{Callback, Stop};
use sim_core::pose::Pose;
use sim_core::simulation::Environment;
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};

use super::Executor;
use super::bell::Bell;
use super::conductor::{Conductor, End, HandOver, Plan};
use super::fault::Broken;
use super::gate::Gate;
use super::program::{RobotProgram, Site};
use super::standing::{Finish, Senders, Standing};
use super::{signal, standing, watchdog};
use crate::record::Sinks;
use crate::robios::caller::{Call, Caller};
use crate::robios::cost::Costs;
use crate::robios::panel::Panel;
use crate::robios::radio;
use crate::robios::robot::{Ending, Robot};
use crate::robios::task::MAIN;
use crate::workshop::Workshop;
use sim_core::record::{Digest, Outcome, Recorder};

/// Everything that the robots' flows share.
pub struct Run {
    /// What all robots share; written only between slots, when no robot runs.
    pub(crate) environment: RwLock<Environment>,
    /// All robots that ever were in the run, in the order of their ids.
    members: boxcar::Vec<Member>,
    /// What more of them are made of, where the run can grow.
    workshop: Mutex<Option<Workshop>>,
    conductor: Mutex<Conductor>,
    executor: Box<dyn Executor>,
    /// Robots whose processes broke, and how: nobody else is harmed.
    lost: Mutex<Vec<(RobotId, Broken)>>,
    costs: Costs,
    bell: Bell,
    /// Bounds of the present slot in microseconds: a copy that calls read without the world's lock.
    slot_start: AtomicI64,
    slot_end: AtomicI64,
    is_stopping: AtomicBool,
    is_verbose: bool,
    /// Somebody has wanted to see the calls of single robots: their journals say of which.
    has_listeners: AtomicBool,
    /// This run, to be shared with the flows of robots that come later.
    own: Weak<Run>,
}

/// A robot in a run.
pub(super) struct Member {
    robot: Mutex<Robot>,
    /// None for a robot that only stands there.
    program: Option<RobotProgram>,
    /// It has been taken out of the world: its program is to leave.
    is_removed: AtomicBool,
}

impl Member {
    pub fn new(robot: Robot, program: Option<RobotProgram>) -> Self {
        Self { robot: Mutex::new(robot), program, is_removed: AtomicBool::new(false) }
    }
}

/// What a run is made of.
pub struct Parts {
    /// The world at time 0.
    pub world: World,
    /// All robots, in the order of their ids.
    pub robots: Vec<Robot>,
    /// Their programs, in the same order; none for a robot that only stands there.
    pub programs: Vec<Option<RobotProgram>>,
    /// What robots and objects that come later are made of; none where nobody can come.
    pub workshop: Option<Workshop>,
    /// How flows are run.
    pub executor: Box<dyn Executor>,
    /// What calls cost.
    pub costs: Costs,
    /// Where events go.
    pub recorder: Recorder,
    /// Who wants to see them.
    pub sinks: Sinks<'static>,
    /// Who decides when the run goes on; none where it goes as fast as possible and nobody takes part.
    pub gate: Option<Box<dyn Gate>>,
}

/// What a run is told by its user.
#[derive(Clone, Debug)]
pub struct Limits {
    /// How many robots may run at one time.
    pub lanes: usize,
    /// Simulated time at which the run ends.
    pub until: Time,
    /// Processor time in seconds that a program may use within one slot.
    pub timeout: f64,
    /// True when every call is to be recorded.
    pub is_verbose: bool,
}

/// How a run ended.
pub struct Ended {
    /// Why it ended.
    pub end: End,
    /// Simulated time at the end.
    pub time: Time,
    /// Real time that it took.
    pub real_time: Duration,
    /// Digest of everything recorded.
    pub digest: Digest,
    /// For each robot how it stands, in the order of ids.
    pub robots: Vec<RobotEnd>,
    /// Where each movable object is, in the order of ids.
    pub objects: Vec<Pose>,
    /// The run itself, at rest: its world and its robots, whose displays have been taken out.
    pub run: Arc<Run>,
}

/// How a robot stands at the end of a run.
pub struct RobotEnd {
    /// How its program stands.
    pub outcome: Outcome,
    /// Why, where there is more to say.
    pub reason: Option<String>,
    /// The exit code of its program, where it gave one.
    pub exit_code: Option<i32>,
    /// Its virtual time.
    pub virtual_time: Time,
    /// True pose of its centre in the world.
    pub pose: Pose,
    /// Pose by its odometry.
    pub odometry: Pose,
    /// Length of its path, m.
    pub path: f64,
    /// How often it touched something.
    pub contacts: u32,
    /// How often a foot came down, and how often another part touched something; none of a robot without legs.
    pub steps: Option<[u64; 2]>,
    /// Its display.
    pub panel: Panel,
}

/// How often the supervisor looks at the programs and shows progress.
const LOOK: Duration = Duration::from_millis(50);

/// Processor time in seconds that a program may still compute once the user has interrupted the run.
const PATIENCE: f64 = 0.5;

/// How long a stopped program may take to leave before it is left behind.
const LEAVE: Duration = Duration::from_secs(1);

impl Run {
    /// Runs all programs from time 0 to the end; `watch` is called about twenty times a second with the run.
    ///
    /// # Errors
    /// When the system has no room for the robots' flows.
    pub fn execute(parts: Parts, limits: &Limits, mut watch: impl FnMut(&Run)) -> std::io::Result<Ended> {
        let start = Instant::now();
        let bell = Bell::new()?;
        signal::install(&bell)?;
        let has_program: Vec<bool> = parts.programs.iter().map(Option::is_some).collect();
        let plan = Plan { has_program, lanes: limits.lanes, until: limits.until };
        let run = Arc::new_cyclic(|own| Self {
            slot_start: AtomicI64::new(parts.world.slot_start().0),
            slot_end: AtomicI64::new(parts.world.slot_end().0),
            environment: RwLock::new(Environment::new(parts.world, parts.recorder)),
            members: parts
                .robots
                .into_iter()
                .zip(parts.programs)
                .map(|(robot, program)| Member::new(robot, program))
                .collect(),
            workshop: Mutex::new(parts.workshop),
            conductor: Mutex::new(Conductor::new(&plan, parts.sinks, parts.gate)),
            executor: parts.executor,
            lost: Mutex::default(),
            costs: parts.costs,
            bell,
            is_stopping: AtomicBool::new(false),
            is_verbose: limits.is_verbose,
            has_listeners: AtomicBool::new(false),
            own: Weak::clone(own),
        });
        for id in run.ids_with_program() {
            run.program(id).map_or(Ok(()), |program| run.start_program(id, program))?;
        }
        let hand_over = run.conductor.lock().begin(&run);
        run.resume(&hand_over);
        let mut broken = run.supervise(limits, &mut watch);
        // Nothing of a broken process runs on: another program may wait for a lock that the broken one holds.
        if broken.is_empty() {
            run.stop_all();
        }
        broken.append(&mut run.lost.lock());
        let ended = run.conclude(&broken, start);
        let deadline = Instant::now() + LEAVE;
        run.members.iter().filter_map(|(_, member)| member.program.as_ref()).for_each(|program| program.end(deadline));
        Ok(ended)
    }

    /// Gives the program of robot `id` its first flow, suspended.
    ///
    /// # Errors
    /// When the system has no room for it.
    pub(super) fn start_program(&self, id: RobotId, program: &RobotProgram) -> std::io::Result<()> {
        let own = Weak::clone(&self.own);
        self.executor.admit(id);
        self.executor.start(id, MAIN, Box::new(move || own.upgrade()?.live(id)))?;
        if let Some(child) = program.child() {
            self.executor.serve(id, Arc::clone(child));
        }
        Ok(())
    }

    /// Takes a robot in, which has the next id.
    pub(super) fn admit(&self, member: Member) {
        self.members.push(member);
    }

    /// The program of robot `id` is to leave: it is turned back from the call that it is in.
    pub(super) fn dismiss(&self, id: RobotId) {
        self.members[id.index()].is_removed.store(true, Ordering::Release);
    }

    /// Who is in the run, and what more of them are made of; none where nobody can come.
    pub fn workshop(&self) -> MutexGuard<'_, Option<Workshop>> {
        self.workshop.lock()
    }

    /// The state of robot `id`.
    pub fn robot(&self, id: RobotId) -> MutexGuard<'_, Robot> {
        self.members[id.index()].robot.lock()
    }

    /// The world, as it was made public at the start of the present slot.
    pub fn world(&self) -> MappedRwLockReadGuard<'_, World> {
        RwLockReadGuard::map(self.environment.read(), |environment| &environment.world)
    }

    /// Number of robots, those that have been removed included: the last has this id.
    pub fn robot_count(&self) -> usize {
        self.members.count()
    }

    fn program(&self, id: RobotId) -> Option<&RobotProgram> {
        self.members[id.index()].program.as_ref()
    }

    /// True for a robot that has a program, be it over.
    pub fn has_program(&self, id: RobotId) -> bool {
        self.program(id).is_some()
    }

    /// The robots that have a program; the others only stand there.
    pub fn ids_with_program(&self) -> impl Iterator<Item = RobotId> {
        self.members.iter().filter(|(_, member)| member.program.is_some()).map(|(index, _)| RobotId::from_index(index))
    }

    /// Start of the present slot.
    pub fn slot_start(&self) -> Time {
        Time(self.slot_start.load(Ordering::Acquire))
    }

    /// End of the present slot.
    pub fn slot_end(&self) -> Time {
        Time(self.slot_end.load(Ordering::Acquire))
    }

    /// What runs the flows.
    pub(crate) fn executor(&self) -> &dyn Executor {
        &*self.executor
    }

    /// Virtual time that `call` takes.
    pub(crate) fn cost(&self, call: Call) -> Time {
        self.costs.of(call)
    }

    /// True when the calls of robot `id` are recorded.
    pub(crate) fn is_verbose(&self, id: RobotId) -> bool {
        self.is_verbose || self.has_listeners.load(Ordering::Relaxed) && self.robot(id).journal.is_verbose()
    }

    /// Lets the calls of robot `id` be recorded, or no longer, between two slots.
    pub fn listen_to(&self, id: RobotId, is_wanted: bool) {
        self.robot(id).journal.set_verbose(is_wanted);
        self.has_listeners.fetch_or(is_wanted, Ordering::Relaxed);
    }

    /// True once all programs are to leave.
    fn is_stopping(&self) -> bool {
        self.is_stopping.load(Ordering::Acquire)
    }

    /// True once robot `id` has been taken out of the world.
    pub fn is_removed(&self, id: RobotId) -> bool {
        self.members[id.index()].is_removed.load(Ordering::Acquire)
    }

    /// True once the program of robot `id` is to leave: every call is turned back.
    pub(crate) fn is_leaving(&self, id: RobotId) -> bool {
        self.is_stopping() || self.is_removed(id)
    }

    /// What wakes the supervisor.
    pub(super) fn bell(&self) -> &Bell {
        &self.bell
    }

    /// Tells the robots' calls the bounds of the present slot.
    pub(super) fn publish_slot(&self, world: &World) {
        self.slot_start.store(world.slot_start().0, Ordering::Release);
        self.slot_end.store(world.slot_end().0, Ordering::Release);
    }

    /// Suspends the calling flow, `robot`'s, until the slot that contains `wake`, or earlier if what it waits for changes.
    ///
    /// # Errors
    /// [`Stop`] when the run has ended meanwhile.
    pub(crate) fn suspend(&self, robot: RobotId, wake: Time) -> Result<(), Stop> {
        let hand_over = self.conductor.lock().suspend(self, robot, wake);
        self.resume(&hand_over);
        if hand_over.goes_on {
            self.executor.go_on(robot);
        } else {
            self.executor.suspend(robot);
        }
        if self.is_leaving(robot) { Err(Stop) } else { Ok(()) }
    }

    fn resume(&self, hand_over: &HandOver) {
        for (robot, lane) in &hand_over.resume {
            self.executor.resume(*robot, *lane);
        }
    }

    /// The life of a robot's first flow, which runs `main`.
    fn live(self: Arc<Self>, id: RobotId) -> Option<u32> {
        if let (false, Some(program)) = (self.is_leaving(id), self.program(id)) {
            let caller = Caller::new(Arc::clone(&self), id);
            let result = program.run(&caller);
            if result.is_ok() && !self.is_leaving(id) {
                self.robot(id).hint_at_living_tasks();
            }
            // The other tasks return through calls that `caller` answers.
            self.end_tasks(id);
            let ending = match result {
                Err(broken) if broken.is_overdue && self.is_removed(id) => self.leave_behind(id),
                Err(broken) if !program.child().is_some_and(|child| child.is_ending()) => {
                    let task = self.robot(id).tasks.first_to_leave();
                    let broken = self.with_task(id, if let Some(task) = task { broken.in_task(task) } else { broken });
                    let ending = Ending::broken(&broken);
                    self.lost.lock().push((id, broken));
                    ending
                }
                _ if self.is_leaving(id) => Ending::Stopped,
                Ok(code) => Ending::Exited { code },
                Err(_) => Ending::Stopped,
            };
            self.robot(id).ending.get_or_insert(ending);
        } else if self.is_removed(id) {
            self.robot(id).ending.get_or_insert(Ending::Stopped);
        }
        if self.is_stopping() {
            self.conductor.lock().leave(id);
            self.bell.ring();
        } else {
            self.bury(id);
        }
        if let Some(program) = self.program(id) {
            program.end(Instant::now() + LEAVE);
        }
        None
    }

    /// The program of robot `id`, which has been removed, has not left in time: nobody waits for it any more.
    fn leave_behind(&self, id: RobotId) -> Ending {
        self.robot(id).hint("the robot has been removed and its program did not leave: it is left behind");
        Ending::Stopped
    }

    /// The same, told with the name of the task that broke.
    fn with_task(&self, id: RobotId, mut broken: Broken) -> Broken {
        if let Some(task) = broken.task.take() {
            broken.what += &format!(" in {}", self.robot(id).tasks.name(task));
        }
        broken
    }

    /// Starts the flow of task `task` of robot `id`, which runs `code` when its turn comes.
    ///
    /// # Errors
    /// When the system has no room for another flow.
    pub(crate) fn start_task(self: &Arc<Self>, id: RobotId, task: u32, code: Callback) -> std::io::Result<()> {
        let run = Arc::clone(self);
        self.executor.start(id, task, Box::new(move || Some(run.live_task(id, code))))
    }

    /// The life of a further flow of robot `id`; the task that goes on after it.
    fn live_task(&self, id: RobotId, code: Callback) -> u32 {
        let is_left = {
            let tasks = &self.robot(id).tasks;
            self.is_leaving(id) || tasks.is_leaving() || tasks.is_killed()
        };
        let result = if is_left { Err(Stop) } else { self.executor.call_back(id, code) };
        let mut robot = self.robot(id);
        if result.is_err() && !robot.tasks.is_killed() {
            robot.tasks.begin_leaving();
        }
        let now = robot.now;
        robot.tasks.end_current(now)
    }

    /// Lets all tasks of robot `id` leave, whose `main` has been left: one after the other.
    fn end_tasks(&self, id: RobotId) {
        loop {
            let mut robot = self.robot(id);
            robot.tasks.begin_leaving();
            let Some(task) = robot.tasks.next_to_leave() else { return };
            let now = robot.now;
            robot.tasks.switch_to(task, now);
            drop(robot);
            self.executor.switch(id, task);
        }
    }

    /// Where the program of robot `id` is, in its own words; asked by a flow of the robot on behalf of the program.
    pub(crate) fn call_site(&self, id: RobotId) -> Site {
        self.program(id).map(RobotProgram::call_site).unwrap_or_default()
    }

    /// What each task of `robot` waits for, in words.
    pub(crate) fn waits_of(&self, robot: &Robot) -> String {
        let words = |program| standing::tasks_in_words(robot, program, Senders::Other);
        self.program(robot.id).map(words).unwrap_or_default()
    }

    /// Ends robot `id` in the world: its motors stop, its end is recorded, the slot loop goes on without it.
    fn bury(&self, id: RobotId) {
        {
            let mut robot = self.robot(id);
            if matches!(robot.ending, Some(Ending::Exited { .. })) {
                robot.hint_at_pending_drive();
            }
            robot.halt(&self.world());
            radio::end(&mut robot);
        }
        let hand_over = self.conductor.lock().depart(self, id);
        self.resume(&hand_over);
    }

    /// Watches over the run until it is over; returns the robots that broke.
    fn supervise(&self, limits: &Limits, watch: &mut impl FnMut(&Run)) -> Vec<(RobotId, Broken)> {
        let mut all_broken = Vec::new();
        // Removed robots whose programs do not leave: nobody waits for them any more.
        let mut left_behind: Vec<RobotId> = Vec::new();
        loop {
            self.bell.wait(LOOK);
            for (id, broken) in self.executor.broken() {
                if left_behind.contains(&id) {
                    continue;
                }
                if broken.is_overdue && self.is_removed(id) {
                    left_behind.push(id);
                    let ending = self.leave_behind(id);
                    self.robot(id).ending.get_or_insert(ending);
                    self.bury(id);
                    continue;
                }
                if all_broken.iter().all(|(known, _)| *known != id) {
                    let broken = self.with_task(id, broken);
                    self.robot(id).ending.get_or_insert(Ending::broken(&broken));
                    all_broken.push((id, broken));
                    self.conductor.lock().end_with(End::Broken);
                    self.bury(id);
                }
            }
            watch(self);
            // The slot loop keeps the lock while it waits for real time; nobody runs then.
            let Some(mut conductor) = self.conductor.try_lock_for(LOOK) else { continue };
            if conductor.is_over() {
                return all_broken;
            }
            let mut timeout = limits.timeout;
            if signal::is_interrupted() {
                conductor.end_with(End::Interrupted);
                timeout = timeout.min(PATIENCE);
            }
            let running: Vec<_> = conductor.running().collect();
            drop(conductor);
            if !watchdog::is_debugged() {
                for id in running {
                    let timeout = if self.is_removed(id) { timeout.min(LEAVE.as_secs_f64()) } else { timeout };
                    if self.executor.is_overdue(id, timeout) {
                        self.executor.break_overdue(id);
                    }
                }
            }
        }
    }

    /// Lets every program that has not ended leave, one after the other in the order of ids.
    fn stop_all(&self) {
        self.is_stopping.store(true, Ordering::Release);
        for id in self.ids_with_program() {
            if self.conductor.lock().has_departed(id) {
                continue;
            }
            self.executor.resume(id, 0);
            let deadline = Instant::now() + LEAVE;
            while !self.conductor.lock().has_departed(id) && Instant::now() < deadline {
                self.bell.wait(deadline.saturating_duration_since(Instant::now()));
            }
        }
    }

    /// What the run has come to, once nobody runs any more.
    fn conclude(self: &Arc<Self>, broken: &[(RobotId, Broken)], start: Instant) -> Ended {
        let mut conductor = self.conductor.lock();
        let mut environment = self.environment.write();
        let time = conductor.time(&environment.world);
        let end = conductor.take_end();
        let senders = Senders::among(self.ids_with_program().map(|id| self.robot(id)));
        let finish = Finish { end: &end, time, robots: self.robot_count(), senders };
        environment.finish(time);
        let mut robots = Vec::with_capacity(self.robot_count());
        for (index, Member { program, .. }) in &self.members {
            let id = RobotId::from_index(index);
            let mut robot = self.robot(id);
            let broken = broken.iter().find(|(other, _)| *other == id).map(|(_, broken)| broken);
            let standing = match program {
                Some(_) if broken.is_none() && self.is_removed(id) && robot.ending == Some(Ending::Stopped) => {
                    Standing::removed()
                }
                Some(program) => standing::judge(&mut robot, &finish, broken, program),
                None => Standing::without_program(),
            };
            environment.finish_radio(&mut robot.state);
            robot.record_standing(&standing);
            environment.recorder().collect(&mut robot.journal);
            robots.push(RobotEnd {
                virtual_time: robot.now,
                pose: robot.motion.pose(time),
                odometry: robot.motion.odometry(time),
                path: robot.motion.path_length(time),
                contacts: robot.motion.contacts(time),
                steps: robot.motion.legs().map(|_| [robot.walk.footfalls, robot.walk.touches]),
                panel: robot.robios.take_panel(),
                outcome: standing.outcome,
                reason: standing.reason,
                exit_code: standing.exit_code,
            });
        }
        let (digest, completed) = conductor.sinks().finish_record(environment.recorder(), time);
        let end = completed.map_or_else(End::Record, |()| end);
        signal::uninstall();
        let world = &environment.world;
        let objects =
            (0..world.object_count()).map(|index| world.object_pose(ObjectId::from_index(index), time)).collect();
        let run = Arc::clone(self);
        Ended { end, time, real_time: start.elapsed(), digest, robots, objects, run }
    }
}
