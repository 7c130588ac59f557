//! All state of one robot: its virtual time, its motion, its devices, what it waits for and how it ended.

use std::sync::Arc;

use robios_sys::{Robios6Call, SupportCall};
use sim_core::RobotId;
use sim_core::contact::Thing;
use sim_core::drive::legged::{Footfall, Stance, Touching};
use sim_core::drive::{Command, HISTORY, ModelError, Motion};
use sim_core::noise::Parameter;
use sim_core::noise::{Profile, RangeKind};
use sim_core::pose::Pose;
use sim_core::spec::RobiSpec;
use sim_core::time::Time;
use sim_core::world::{Contact, LegTouch, Seen, World};

use super::Devices;
use super::caller::Call;
use super::key::Touch;
use super::motor;
use super::support::Generators;
use super::switch::{self, Sensor};
use super::task::{TaskWait, Tasks};
use super::timer::Timers;
use super::truth::Placement;
use crate::executive::fault::Broken;
use crate::executive::program::Site;
use crate::executive::standing::Standing;
use sim_core::record::{Event, Journal, Numbers, Obstacle};

/// One robot, as its calls and the slot loop see it; one lock guards it all.
pub struct Robot {
    /// Its number.
    pub id: RobotId,
    /// Its virtual time: the end of its last call, or the beginning of the one in progress.
    pub now: Time,
    /// The name of its program; empty for a robot without one.
    pub program: String,
    /// Where it is and how it moves.
    pub motion: Motion,
    /// What its robi file says.
    pub spec: Arc<RobiSpec>,
    /// What its program did and read in the present slot.
    pub journal: Journal,
    /// The devices that RoBIOS shows.
    pub devices: Devices,
    /// The generators that its program draws from.
    pub generators: Generators,
    /// The timers that its program has attached.
    pub timers: Timers,
    /// Its tasks; a program that starts none has one.
    pub tasks: Tasks,
    /// How its program ended, once that is known.
    pub ending: Option<Ending>,
    /// What its program has asked for in the present slot to be put elsewhere, in order.
    pub placements: Vec<Placement>,
    /// The errors of its devices, its drive and its radio.
    noise: Profile,
    /// Seed of the run.
    seed: u64,
    /// The pose that was recorded last.
    recorded_pose: Option<Pose>,
    /// How it walked and held itself, of a robot with legs.
    pub walk: WalkRecord,
}

/// What a robot is made of.
pub struct RobotParts {
    /// The name of its program; empty for a robot without one.
    pub program: String,
    /// When it starts.
    pub start: Time,
    /// Where it starts.
    pub motion: Motion,
    /// What its robi file says.
    pub spec: Arc<RobiSpec>,
    /// Its devices.
    pub devices: Devices,
    /// Seed of the run.
    pub seed: u64,
    /// True when its calls are to be recorded.
    pub is_verbose: bool,
}

/// A wait in progress.
#[derive(Clone, Debug)]
pub struct Waiting {
    /// The call that waits.
    pub call: Call,
    /// What for.
    pub waits_for: Waits,
    /// Since when, in virtual time.
    pub since: Time,
    /// Where the program called it.
    pub site: Site,
}

/// What a robot can wait for.
#[derive(Clone, Debug, PartialEq)]
pub enum Waits {
    /// A point in virtual time.
    Time(Time),
    /// The end of the drive in progress.
    Drive,
    /// A key, as the user calls it.
    Key(String),
    /// Something else that only the outside could give, as the user calls it.
    Input(String),
    /// A message by radio.
    Message,
    /// Something that only another task could give.
    Task(TaskWait),
    /// The semaphore of RoBIOS 6 with this number.
    Semaphore(u32),
    /// To be made ready by another task.
    Ready,
}

/// How often is looked at what legs touch. Source: our choice.
const TOUCH_GRID: Time = Time::from_millis(10);

/// What has been recorded of a robot's legs.
#[derive(Clone, Debug, Default)]
pub struct WalkRecord {
    /// The posture that was recorded last.
    posture: Option<(f64, Vec<f64>)>,
    /// What its parts touched when that was looked at last, and when that was.
    touching: Vec<(Touching, Seen)>,
    looked_at: Time,
    /// How often a foot has come down.
    pub footfalls: u64,
    /// How often a part has begun to touch something.
    pub touches: u64,
}

/// How a robot's program ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// `main` returned, or the program called `exit`.
    Exited {
        /// Its exit code; 0 is success.
        code: i32,
    },
    /// It broke off: a panic, `abort`, a call that the simulator refuses.
    Failed {
        /// Why, as the user is told.
        reason: String,
    },
    /// It was stopped by the watchdog.
    Overdue {
        /// Where, as the user is told.
        reason: String,
    },
    /// It was stopped with the run.
    Stopped,
}

impl Robot {
    /// A robot at its start.
    pub fn new(parts: RobotParts) -> Self {
        let RobotParts { program, start, mut motion, spec, devices, seed, is_verbose } = parts;
        let id = motion.id();
        let recorded_pose = Some(motion.pose(start));
        Self {
            id,
            now: start,
            program,
            motion,
            spec,
            journal: Journal::new(id, is_verbose),
            devices,
            generators: Generators::new(seed, id),
            timers: Timers::default(),
            tasks: Tasks::default(),
            ending: None,
            placements: Vec::new(),
            noise: Profile::default(),
            seed,
            recorded_pose,
            walk: WalkRecord::default(),
        }
    }

    /// Somebody presses a key, touches the display or uses a remote control at `at`, the start of a slot.
    pub fn press(&mut self, at: Time, touch: Touch) {
        match touch.remote_key() {
            Some(code) => self.devices.remote.press(at, code),
            None => self.devices.keys.press(at, touch),
        }
        self.tasks.look_at_input(at);
    }

    /// This robot, to which nothing has happened yet, with these errors.
    ///
    /// # Errors
    /// The first number that makes no sense for its drive.
    pub fn with_noise(mut self, profile: &Profile) -> Result<Self, ModelError> {
        self.set_noise(self.now, profile)?;
        Ok(self)
    }

    /// From `at` on, the start of the present slot, it has these errors; those of its radio are the channel's.
    ///
    /// # Errors
    /// The first number that makes no sense for its drive; nothing changes then.
    pub fn set_noise(&mut self, at: Time, profile: &Profile) -> Result<(), ModelError> {
        let imperfection = profile.motion.imperfection(self.motion.model().kind, self.seed, self.id);
        if imperfection != self.motion.imperfection() {
            self.motion.set_imperfection(at, self.seed, imperfection)?;
        }
        self.devices.set_errors(&self.spec, profile, self.seed, self.id);
        self.noise = profile.clone();
        Ok(())
    }

    /// The errors of its devices, its drive and its radio.
    pub fn noise(&self) -> &Profile {
        &self.noise
    }

    /// The numbers of its errors that concern what it has.
    pub fn noise_parameters(&self) -> Vec<Parameter> {
        let spec = &*self.spec;
        let has_table = |table: &str| match table {
            "psd" => !spec.psds.is_empty(),
            "lidar" => spec.lidar.is_some(),
            "compass" => spec.compass.is_some(),
            "camera" => spec.camera.is_some(),
            "drive" | "odometry" | "radio" => true,
            kind => spec.ranges.iter().any(|range| RangeKind::from(&range.model).name() == kind),
        };
        let parameters = self.noise.parameters().into_iter();
        parameters.filter(|parameter| has_table(parameter.table)).collect()
    }

    /// Its sensors by name, and whether they are switched on.
    pub fn sensors_on(&self) -> Vec<(&str, bool)> {
        switch::sensors(&self.spec).map(|(name, sensor)| (name, self.devices.switches.is_on(sensor))).collect()
    }

    /// Switches its sensors of this name on or off at `at`, the start of a slot; false if it has none.
    pub fn switch_sensor(&mut self, at: Time, name: &str, is_on: bool) -> bool {
        let spec = Arc::clone(&self.spec);
        let mut has_any = false;
        for (_, sensor) in switch::sensors(&spec).filter(|(known, _)| *known == name) {
            has_any = true;
            self.devices.switches.set(sensor, is_on);
            if let Sensor::Encoder(index) = sensor {
                motor::switch_encoder(self, index, is_on, at);
            }
        }
        has_any
    }

    /// Tells the user when the program has ended before a drive that it commanded.
    pub fn hint_at_pending_drive(&mut self) {
        if self.motion.drive_end().is_some_and(|end| end > self.now) {
            let wait = if self.devices.vw.begun.is_some() { "VWWait" } else { "VWDriveWait" };
            self.hint(&format!(
                "the program ended while it drove, which stops the motors: `{wait}` waits for the end of a drive"
            ));
        }
    }

    /// Tells the user when `main` has ended before other tasks of RoBIOS 6, which end with it.
    pub fn hint_at_living_tasks(&mut self) {
        let is_by_main = !self.tasks.is_leaving() && matches!(self.ending, None | Some(Ending::Exited { .. }));
        if is_by_main && self.tasks.scheduler().is_some() && self.tasks.has_others() {
            let others = self.tasks.others_in_words();
            self.hint(&format!("the program ended with `main`, before {others}: `OSSuspend(0)` lets `main` wait"));
        }
    }

    /// Stops its motors, at the end of its program.
    pub fn halt(&mut self, world: &World) {
        let touching = world.touching(&mut self.motion, self.now);
        if let Err(error) = self.motion.command(self.now, Command::Halt, &touching) {
            unreachable!("a halt is never refused: {error}");
        }
    }

    /// Records where it is when it comes into a running world; of a robot that is there from the start the scene says it.
    pub fn record_arrival(&mut self, world: &World) {
        self.recorded_pose = None;
        self.record_walk(world, self.now);
        self.record_pose(self.now);
    }

    /// Records where it is at the end of a slot, if it has moved since the last record.
    pub fn record_pose(&mut self, slot_end: Time) {
        let pose = self.motion.pose(slot_end);
        if self.recorded_pose != Some(pose) {
            self.recorded_pose = Some(pose);
            let Pose { position, heading } = pose;
            let event =
                Event::Pose { x_m: position.x, y_m: position.y, phi_rad: heading.remainder(), turns: heading.turns() };
            self.journal.record(slot_end, &event);
        }
    }

    /// Records where the feet of a robot with legs have trod in the slot, and how it holds itself at its end, if that has
    /// changed since the last record.
    pub fn record_walk(&mut self, world: &World, slot_end: Time) {
        if self.motion.legs().is_none() {
            return;
        }
        for Footfall { time, leg, point } in self.motion.take_footfalls(slot_end) {
            let name = self.motion.legs().and_then(|legs| legs.legs.get(leg)).map_or("", |leg| &leg.name);
            self.journal.record(time, &Event::Footfall { leg: name, x_m: point.x, y_m: point.y, z_m: point.z });
            self.walk.footfalls += 1;
        }
        self.record_touches(world, slot_end);
        let Stance { lift, joints, .. } = self.motion.stance(slot_end);
        let posture = Some((lift, joints));
        if self.walk.posture != posture {
            let bytes: Vec<[u8; 8]> =
                posture.iter().flat_map(|(_, joints)| joints).map(|angle| angle.to_le_bytes()).collect();
            self.journal.record(slot_end, &Event::Posture { lift_m: lift, joints_rad: Numbers::new(&bytes) });
            self.walk.posture = posture;
        }
    }

    /// Records what thighs, shanks and body have begun to touch since that was looked at last, each [`TOUCH_GRID`]; of slots
    /// longer than what the world remembers only the end is looked at.
    fn record_touches(&mut self, world: &World, slot_end: Time) {
        let first = self.walk.looked_at.max(slot_end - HISTORY);
        let mut at = Time((first.0.div_euclid(TOUCH_GRID.0) + 1) * TOUCH_GRID.0);
        while at <= slot_end {
            let touches = world.closeness(&mut self.motion, at, 0.0).map(|near| near.touches).unwrap_or_default();
            for LegTouch { part, thing, point } in &touches {
                if !self.walk.touching.contains(&(*part, *thing)) {
                    let part = self.part_name(*part);
                    let with = match thing {
                        Seen::Wall(_) | Seen::Fixed(_) => Obstacle::Wall,
                        Seen::Floor => Obstacle::Terrain,
                        Seen::Robot(id) => Obstacle::Robot(id.0),
                        Seen::Object(id) => Obstacle::Object(id.0),
                    };
                    let event = Event::Touch { part: &part, with, x_m: point.x, y_m: point.y, z_m: point.z };
                    self.journal.record(at, &event);
                    self.walk.touches += 1;
                }
            }
            self.walk.touching = touches.iter().map(|touch| (touch.part, touch.thing)).collect();
            self.walk.looked_at = at;
            at += TOUCH_GRID;
        }
    }

    /// The name of a part in events: that of its link, or `body`.
    fn part_name(&self, part: Touching) -> String {
        let (leg, link) = match part {
            Touching::Body => return "body".to_owned(),
            Touching::Thigh(leg) => (leg, "thigh"),
            Touching::Shank(leg) => (leg, "shank"),
        };
        let name = self.motion.legs().and_then(|legs| legs.legs.get(leg)).map_or("", |leg| &leg.name);
        format!("{name}.{link}")
    }

    /// Records a contact that began in the present slot.
    pub fn record_contact(&mut self, contact: &Contact) {
        let with = match contact.with {
            Thing::Wall(_) => Obstacle::Wall,
            Thing::Robot(id) => Obstacle::Robot(id.0),
            Thing::Object(id) => Obstacle::Object(id.0),
        };
        let event = Event::Contact { at_s: contact.time.seconds(), with, x_m: contact.point.x, y_m: contact.point.y };
        self.journal.record(contact.time, &event);
    }

    /// Records that the program of robot `by` has put it at `pose` at `at`.
    pub fn record_placed(&mut self, at: Time, by: RobotId, pose: &Pose) {
        let Pose { position, heading } = pose;
        let event = Event::Placed { by: by.0, x_m: position.x, y_m: position.y, phi_rad: heading.remainder() };
        self.journal.record(at, &event);
    }

    /// Records that its program begins.
    pub fn record_start(&mut self) {
        self.journal.record(self.now, &Event::ProgramStarted { program: &self.program });
    }

    /// Records how its program stands at the end of the run.
    pub fn record_standing(&mut self, standing: &Standing) {
        let now = self.now;
        if let Some(fault) = &standing.fault {
            let event = Event::Fault { what: &fault.what, location: &fault.location, last_call: fault.last_call };
            self.journal.record(now, &event);
        }
        self.journal.record(now, &Event::ProgramEnded { outcome: standing.outcome, exit_code: standing.exit_code });
        if let Some(reason) = &standing.reason {
            self.journal.record(now, &Event::Reason { text: reason });
        }
    }

    /// Tells the user of a likely mistake in the program.
    pub fn hint(&mut self, text: &str) {
        self.journal.record(self.now, &Event::Hint { text });
    }
}

impl Ending {
    /// The ending of a program that broke.
    pub fn broken(broken: &Broken) -> Self {
        let reason = broken.what.clone();
        if broken.is_overdue { Self::Overdue { reason } } else { Self::Failed { reason } }
    }
}

impl Waiting {
    /// True where the task leaves the processor to others under the scheduler of RoBIOS 6; in any other wait it keeps what it has.
    pub fn leaves_processor(&self) -> bool {
        let is_sleep = matches!(self.call, Call::Robios6(Robios6Call::OSSleep) | Call::Support(SupportCall::sleep_us));
        is_sleep || self.waits_for.is_for_task()
    }
}

impl Waits {
    /// True for what only another task of the robot could give.
    pub fn is_for_task(&self) -> bool {
        matches!(self, Self::Task(_) | Self::Semaphore(_) | Self::Ready)
    }

    /// True where another task may end the wait by force.
    pub fn is_interruptible(&self) -> bool {
        match self {
            Self::Task(wait) => wait.is_interruptible(),
            Self::Semaphore(_) | Self::Ready => false,
            _ => true,
        }
    }
}

impl std::fmt::Display for Waits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Time(time) => write!(f, "{time} of virtual time"),
            Self::Drive => f.write_str("the end of its drive"),
            Self::Key(key) => f.write_str(key),
            Self::Input(what) => f.write_str(what),
            Self::Message => f.write_str("a message"),
            Self::Task(wait) => wait.fmt(f),
            Self::Semaphore(number) => write!(f, "semaphore {number}"),
            Self::Ready => f.write_str("to be made ready"),
        }
    }
}
