//! One robot: its virtual time, its motion, its devices and what it has recorded.

use std::sync::Arc;

use crate::RobotId;
use crate::contact::Thing;
use crate::device::Devices;
use crate::device::psd::Measured;
use crate::device::switch::{self, Sensor};
use crate::device::{compass, psd};
use crate::drive::legged::{Footfall, Stance, Touching};
use crate::drive::{Command, CommandError, HISTORY, ModelError, Motion};
use crate::noise::{Parameter, Profile, RangeKind};
use crate::pose::Pose;
use crate::radio::Station;
use crate::record::{Event, Journal, Numbers, Obstacle};
use crate::sensor::Reading;
use crate::spec::RobiSpec;
use crate::time::Time;
use crate::world::{Contact, LegTouch, World};

use super::Placement;

/// A robot with all that the simulation knows of it; what a running program keeps is not part of it.
///
/// Within a slot it changes only itself, at its own virtual time, and looks at the world as it was made public at the slot's start.
#[derive(Clone, Debug)]
pub struct Robot {
    /// Its number.
    pub id: RobotId,
    /// Its virtual time: the end of its last call, or the beginning of the one in progress.
    pub now: Time,
    /// Where it is and how it moves.
    pub motion: Motion,
    /// What its robi file says.
    pub spec: Arc<RobiSpec>,
    /// What it did and read in the present slot.
    pub journal: Journal,
    /// What it carries.
    pub devices: Devices,
    /// Its radio; none before it was first switched on.
    pub station: Option<Box<Station>>,
    /// What it has asked for in the present slot to be put elsewhere, in order.
    pub placements: Vec<Placement>,
    /// It has been taken out of the world.
    pub is_removed: bool,
    /// The errors of its devices, its drive and its radio.
    noise: Profile,
    /// Seed of the run.
    seed: u64,
    /// The pose that was recorded last.
    recorded_pose: Option<Pose>,
    /// How it walked and held itself, of a robot with legs.
    pub walk: WalkRecord,
}

/// How often is looked at what legs touch. Source: our choice.
const TOUCH_GRID: Time = Time::from_millis(10);

/// What has been recorded of a robot's legs.
#[derive(Clone, Debug, Default)]
pub struct WalkRecord {
    /// The posture that was recorded last.
    posture: Option<(f64, Vec<f64>)>,
    /// What its parts touched when that was looked at last, and when that was.
    touching: Vec<(Touching, Thing)>,
    looked_at: Time,
    /// How often a foot has come down.
    pub footfalls: u64,
    /// How often a part has begun to touch something.
    pub touches: u64,
}

impl Robot {
    /// A robot of this type at its start, at virtual time `start`, in a run with `seed`; `is_verbose` says whether somebody wants to
    /// see its calls.
    pub fn new(mut motion: Motion, spec: Arc<RobiSpec>, start: Time, seed: u64, is_verbose: bool) -> Self {
        let id = motion.id();
        let recorded_pose = Some(motion.pose(start));
        Self {
            id,
            now: start,
            motion,
            devices: Devices::new(&spec),
            spec,
            journal: Journal::new(id, is_verbose),
            station: None,
            placements: Vec::new(),
            is_removed: false,
            noise: Profile::default(),
            seed,
            recorded_pose,
            walk: WalkRecord::default(),
        }
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

    /// Seed of its run.
    pub fn seed(&self) -> u64 {
        self.seed
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
                self.devices.encoders.switch(index, is_on, &mut self.motion, at);
            }
        }
        has_any
    }

    /// Gives its drive a command now.
    ///
    /// # Errors
    /// [`CommandError`] for what the drive cannot do; nothing changes then.
    pub fn command(&mut self, world: &World, command: Command) -> Result<(), CommandError> {
        let touching = world.touching(&mut self.motion, self.now);
        self.motion.command(self.now, command, &touching)
    }

    /// What range sensor `index` reads now; nothing while it is switched off.
    pub fn read_range(&mut self, world: &World, index: usize) -> Reading {
        let Self { now, motion, devices, .. } = self;
        measure_range(devices, motion, world, index, *now)
    }

    /// The value of range sensor `index` that its driver measured last; `None` before the end of a first cycle.
    pub fn measured_range(&mut self, world: &World, index: usize) -> Option<Measured> {
        let now = self.now;
        self.with_psds(world, |psds, measure| psds.read(index, now, measure))
    }

    /// The angle that the compass measured last, rad clockwise from north; `None` before the end of a first cycle.
    pub fn read_compass(&mut self) -> Option<f64> {
        let Self { now, motion, spec, devices, .. } = self;
        let errors = devices.compass.errors.clone();
        devices.compass.read(*now, |at| compass::measure(spec.compass.as_ref(), motion, at, errors.as_ref()))
    }

    /// Computes what sensors have measured that end to measure now.
    ///
    /// To be called when virtual time reaches [`Devices::due`]: the world remembers for 100 ms only what a sensor saw, and a
    /// value may be asked for much later. Sensors that measure without end need it not.
    pub fn settle(&mut self, world: &World) {
        if self.now < self.devices.due() {
            return;
        }
        let now = self.now;
        self.with_psds(world, |psds, measure| psds.settle(now, measure));
        if now >= self.devices.compass.due() {
            self.read_compass();
        }
    }

    /// Lets the driver of the range sensors act with what a sensor sees at an instant.
    fn with_psds<R>(
        &mut self,
        world: &World,
        act: impl FnOnce(&mut psd::Psds, &mut dyn FnMut(usize, Time) -> Reading) -> R,
    ) -> R {
        let mut psds = std::mem::take(&mut self.devices.psds);
        let Self { motion, devices, .. } = self;
        let result = act(&mut psds, &mut |index, at| measure_range(devices, motion, world, index, at));
        self.devices.psds = psds;
        result
    }

    /// Stops its motors, as at the end of its program.
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
                    let with = obstacle(*thing);
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
        let with = obstacle(contact.with);
        let event = Event::Contact { at_s: contact.time.seconds(), with, x_m: contact.point.x, y_m: contact.point.y };
        self.journal.record(contact.time, &event);
    }

    /// Records that robot `by` has put it at `pose` at `at`.
    pub fn record_placed(&mut self, at: Time, by: RobotId, pose: &Pose) {
        let Pose { position, heading } = pose;
        let event = Event::Placed { by: by.0, x_m: position.x, y_m: position.y, phi_rad: heading.remainder() };
        self.journal.record(at, &event);
    }

    /// Records that its program, of this name, begins; the name is empty for a robot without one.
    pub fn record_start(&mut self, program: &str) {
        self.record(Event::ProgramStarted { program });
    }

    /// Tells the user of a likely mistake.
    pub fn hint(&mut self, text: &str) {
        self.journal.record(self.now, &Event::Hint { text });
    }

    /// Records an event now.
    pub fn record(&mut self, event: Event<'_>) {
        self.journal.record(self.now, &event);
    }
}

/// What range sensor `index` reads at `at`; nothing while it is switched off.
fn measure_range(devices: &Devices, motion: &mut Motion, world: &World, index: usize, at: Time) -> Reading {
    let Devices { ranges, servos, switches, .. } = devices;
    let is_on = switches.is_on(Sensor::Range(index));
    if is_on { ranges.read(index, servos, motion, world, at) } else { ranges.nothing(index) }
}

/// What was met, as it is recorded.
fn obstacle(thing: Thing) -> Obstacle {
    match thing {
        Thing::Wall(_) | Thing::Fixed(_) => Obstacle::Wall,
        Thing::Floor => Obstacle::Terrain,
        Thing::Robot(id) => Obstacle::Robot(id.0),
        Thing::Object(id) => Obstacle::Object(id.0),
    }
}
