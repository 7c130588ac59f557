//! One robot: its virtual time, motion, devices and journal.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec2;

use crate::RobotId;
use crate::contact::Thing;
use crate::device::Devices;
use crate::device::compass;
use crate::device::psd::{Measure, Measured, members};
use crate::device::range::Ranges;
use crate::device::servo::Servos;
use crate::device::switch::{self, SensorId, Switches};
use crate::drive::legged::{BodyPart, Footfall, Stance};
use crate::drive::{Command, CommandError, HISTORY, ModelError, Motion};
use crate::noise::{Parameter, Profile, RangeKind};
use crate::pose::Pose;
use crate::radio::Station;
use crate::record::{Event, FloatList, Journal, Obstacle};
use crate::sensor::Reading;
use crate::spec::RobiSpec;
use crate::time::Time;
use crate::unit;
use crate::world::{Contact, LegContact, RayCaster, World};

use super::Placement;

/// State of a robot in the simulation; the state of a running program is not part of it.
///
/// During a slot a robot changes only its own state, at its own virtual time, and reads the world as published at the
/// start of the slot.
///
/// The fields are stored in the declared order. The fields that the end of each slot and most calls access come first,
/// side by side.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Robot {
    /// Id of the robot.
    pub id: RobotId,
    /// True once the robot has been removed from the world.
    pub is_removed: bool,
    /// True once the robot has failed: its drive obeys no command, and its radio stays silent.
    pub is_halted: bool,
    /// True once the program of the robot has ended its use of the radio.
    pub(super) has_ended_radio: bool,
    /// Virtual time: the end of the last call, or the start of the call in progress.
    pub now: Time,
    /// Radio; `None` until it is first switched on.
    pub station: Option<Box<Station>>,
    /// Placements that the robot has requested in the present slot, in the order of the requests.
    pub placements: Vec<Placement>,
    /// Last recorded pose.
    recorded_pose: Option<Pose>,
    /// Events of the present slot.
    pub journal: Journal,
    /// Pose and motion.
    pub motion: Motion,
    /// Devices.
    pub devices: Devices,
    /// Robot type, from the robi file.
    pub spec: Arc<RobiSpec>,
    /// Noise models of devices, drive and radio.
    noise: Profile,
    /// Seed of the run.
    seed: u64,
    /// Recorded posture and contacts of a robot with legs or in the water.
    pub walk: WalkRecord,
    /// Detects that the robot leaves the floor; `None` in a world without a floor.
    floor: Option<FloorMonitor>,
}

/// Detects that a robot leaves the floor over its edge, where a wall is missing.
#[derive(Clone, Debug)]
struct FloorMonitor {
    /// Lower left and upper right corner, m.
    corners: (DVec2, DVec2),
    /// Time at which the detection started, or of the last placement.
    since: Time,
    /// True once the robot's centre has been on the floor at `since` or at the end of a later slot.
    has_been_on: bool,
    /// Instant at which the robot first left the floor.
    left_at: Option<Time>,
}

impl FloorMonitor {
    fn contains(&self, point: DVec2) -> bool {
        let (low, high) = self.corners;
        point.cmpge(low).all() && point.cmple(high).all()
    }
}

/// Interval between checks of the contacts of legs. Our choice.
const TOUCH_INTERVAL: Time = Time::from_millis(10);

/// Recorded posture and contacts of a robot with legs or in the water.
#[derive(Clone, Debug, Default)]
pub struct WalkRecord {
    /// Last recorded posture: height, m, and joint angles, rad.
    posture: Option<(f64, Vec<f64>)>,
    /// Contacts of the robot's parts at the last check.
    touching: Vec<(BodyPart, Thing)>,
    /// Time of the last check of contacts.
    checked_at: Time,
    /// Number of footfalls.
    pub footfalls: u64,
    /// Number of new contacts of parts.
    pub touches: u64,
}

impl Robot {
    /// Creates a robot with this spec and these devices at virtual time `start`, in a run with `seed`; `is_verbose`
    /// turns on the recording of its calls.
    pub fn new(
        mut motion: Motion,
        (spec, devices): (Arc<RobiSpec>, Devices),
        start: Time,
        seed: u64,
        is_verbose: bool,
    ) -> Self {
        let id = motion.id();
        let recorded_pose = Some(motion.pose(start));
        Self {
            id,
            now: start,
            motion,
            devices,
            spec,
            journal: Journal::new(id, is_verbose),
            station: None,
            has_ended_radio: false,
            placements: Vec::new(),
            is_removed: false,
            is_halted: false,
            noise: Profile::default(),
            seed,
            recorded_pose,
            walk: WalkRecord::default(),
            floor: None,
        }
    }

    /// Sets the lower left and the upper right corner of the floor, m. From now on, an event is recorded when the robot
    /// leaves the floor for the first time. For a floor of area 0, nothing is recorded.
    pub fn watch_floor(&mut self, corners: (DVec2, DVec2)) {
        let has_area = corners.0.cmplt(corners.1).all();
        let (since, start) = (self.now, self.motion.pose(self.now).position);
        self.floor = has_area.then(|| {
            let watch = FloorMonitor { corners, since, has_been_on: false, left_at: None };
            FloorMonitor { has_been_on: watch.contains(start), ..watch }
        });
    }

    /// Instant at which the robot's centre first left the floor.
    pub fn left_floor(&self) -> Option<Time> {
        self.floor.as_ref()?.left_at
    }

    /// Sets the noise models from `at` on; `at` must be the start of the present slot. The caller must also set the
    /// radio's noise model in the channel.
    ///
    /// # Errors
    /// [`ModelError`] with the first number that is invalid for the drive; nothing changes then.
    pub fn set_noise(&mut self, at: Time, profile: &Profile) -> Result<(), ModelError> {
        let imperfection = profile.motion.imperfection(self.motion.model().kind, self.seed, self.id);
        if imperfection != self.motion.imperfection() {
            self.motion.set_imperfection(at, self.seed, imperfection)?;
        }
        self.devices.set_errors(&self.spec, profile, self.seed, self.id);
        self.noise = profile.clone();
        Ok(())
    }

    /// Seed of the run.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Noise models of devices, drive and radio.
    pub fn noise(&self) -> &Profile {
        &self.noise
    }

    /// Noise parameters that apply to the devices of this robot.
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

    /// Names of the sensors, each with a flag that is true if the sensor is switched on.
    pub fn sensors_on(&self) -> Vec<(&str, bool)> {
        switch::sensors(&self.spec).map(|(name, sensor)| (name, self.devices.switches.is_on(sensor))).collect()
    }

    /// Switches the sensors with this name on or off at `at`, the start of a slot; returns false if there is no such
    /// sensor.
    pub fn switch_sensor(&mut self, at: Time, name: &str, is_on: bool) -> bool {
        let spec = Arc::clone(&self.spec);
        let mut is_found = false;
        self.devices.psds.forget_unread();
        for (_, sensor) in switch::sensors(&spec).filter(|(known, _)| *known == name) {
            is_found = true;
            self.devices.switches.set(sensor, is_on);
            if let SensorId::Encoder(index) = sensor {
                self.devices.encoders.switch(index, is_on, &mut self.motion, at);
            }
        }
        is_found
    }

    /// If `is_stuck`, makes the range sensors with this name repeat their reading at `at`, the start of a slot, from
    /// then on; a stuck sensor keeps the reading that it repeats. Otherwise makes them measure again.
    pub(super) fn stick_sensor(&mut self, world: &World, at: Time, name: &str, is_stuck: bool) {
        let spec = Arc::clone(&self.spec);
        self.devices.psds.forget_unread();
        for (_, sensor) in switch::sensors(&spec).filter(|(known, _)| *known == name) {
            let SensorId::Range(index) = sensor else { continue };
            let Self { motion, devices: Devices { ranges, servos, switches, .. }, .. } = self;
            let reading = is_stuck.then(|| {
                let measure =
                    || measure_range((ranges, servos, switches), motion, &world.caster(motion.id(), at), index);
                switches.stuck_reading(index).unwrap_or_else(measure)
            });
            switches.set_stuck(index, reading);
        }
    }

    /// Address ranges of the heap memory that the robot's commands and readings access; a caller may prefetch it.
    pub fn hot_memory(&self) -> impl Iterator<Item = Range<*const u8>> {
        let readings = [self.devices.psds.hot_memory()];
        readings.into_iter().chain(self.motion.hot_memory()).chain(self.journal.hot_memory())
    }

    /// Commands the drive at the robot's present virtual time. A robot that has failed or was removed does not obey.
    ///
    /// # Errors
    /// [`CommandError`] for a command that the drive cannot carry out; nothing changes then.
    pub fn command(&mut self, world: &World, command: Command) -> Result<(), CommandError> {
        if self.is_halted || self.is_removed {
            return Ok(());
        }
        let touching = world.touching(&mut self.motion, self.now);
        self.motion.command(self.now, command, &touching)
    }

    /// Reading of range sensor `index` now; a reading without a return if the sensor is switched off.
    pub fn read_range(&mut self, world: &World, index: usize) -> Reading {
        let Self { now, motion, devices, .. } = self;
        let Devices { ranges, servos, switches, .. } = devices;
        measure_range((ranges, servos, switches), motion, &world.caster(motion.id(), *now), index)
    }

    /// Latest sample that the driver of range sensor `index` has taken; `None` before the end of the first cycle.
    pub fn measured_range(&mut self, world: &World, index: usize) -> Option<Measured> {
        let Self { now, motion, devices: Devices { psds, ranges, servos, switches, .. }, .. } = self;
        psds.read(index, *now, motion.revision(), measure_set((ranges, servos, switches), motion, world))
    }

    /// Latest sample of the compass, rad clockwise from north; `None` before the end of the first cycle.
    pub fn read_compass(&mut self) -> Option<f64> {
        let Self { now, motion, spec, devices, .. } = self;
        let errors = devices.compass.errors.clone();
        devices.compass.read(*now, |at| compass::measure(spec.compass.as_ref(), motion, at, errors.as_ref()))
    }

    /// Computes the values of the measurements that have ended by now.
    ///
    /// Must be called when virtual time reaches [`Devices::due`], because a value may be read much later and the world
    /// keeps a history of only 100 ms. Continuous measurements do not need this call.
    pub fn settle(&mut self, world: &World) {
        if self.now < self.devices.due() {
            return;
        }
        let Self { now, motion, devices: Devices { psds, ranges, servos, switches, .. }, .. } = self;
        psds.settle(*now, motion.revision(), measure_set((ranges, servos, switches), motion, world));
        if self.now >= self.devices.compass.due() {
            self.read_compass();
        }
    }

    /// Stops the motors, as at the end of a program.
    pub fn halt(&mut self, world: &World) {
        let touching = world.touching(&mut self.motion, self.now);
        if let Err(error) = self.motion.command(self.now, Command::Halt, &touching) {
            unreachable!("a halt is never rejected: {error}");
        }
    }

    /// Records the initial pose of a robot that is added to a running world. The initial poses of the other robots are
    /// in the scene.
    pub fn record_arrival(&mut self, world: &World) {
        self.recorded_pose = None;
        self.record_walk(world, self.now);
        self.record_pose(self.now);
    }

    /// Records the pose at the end of a slot, if it has changed since the last record.
    pub fn record_pose(&mut self, slot_end: Time) {
        let pose = self.motion.pose(slot_end);
        if self.recorded_pose != Some(pose) {
            self.recorded_pose = Some(pose);
            self.check_floor(slot_end, &pose);
            let Pose { position, heading } = pose;
            let event =
                Event::Pose { x_m: position.x, y_m: position.y, phi_rad: heading.remainder(), turns: heading.turns() };
            self.journal.record(slot_end, &event);
        }
    }

    /// Records an event if the robot has left the floor, at the instant at which its centre crossed the edge. In a slot
    /// that is longer than the world's history, only the last part is searched.
    fn check_floor(&mut self, slot_end: Time, pose: &Pose) {
        let Some(floor) = self.floor.as_mut().filter(|floor| floor.left_at.is_none()) else { return };
        if floor.contains(pose.position) {
            floor.has_been_on = true;
            return;
        }
        if !floor.has_been_on {
            return;
        }
        let (mut inside, mut outside) = (floor.since.max(slot_end - HISTORY), slot_end);
        if !floor.contains(self.motion.pose(inside).position) {
            outside = inside;
        }
        while outside - inside > Time(1) {
            let middle = Time(inside.0 + (outside - inside).0 / 2);
            let bound = if floor.contains(self.motion.pose(middle).position) { &mut inside } else { &mut outside };
            *bound = middle;
        }
        floor.left_at = Some(outside);
        let DVec2 { x, y } = self.motion.pose(outside).position;
        // Adding 0 turns -0 into 0.
        let [x, y] = [x, y].map(|metres| unit::mm_from_metres(metres).round() + 0.0);
        let text =
            format!("the robot has left the floor at ({x}, {y}) mm: a wall or a piece of the border is missing there");
        self.journal.record(outside, &Event::Hint { text: &text });
    }

    /// Returns true if the robot may have requested placements or sent messages in the present slot.
    pub fn has_requests(&self) -> bool {
        self.station.is_some() || !self.placements.is_empty()
    }

    /// Ends the slot at `at`: records the outcomes of messages, the posture if `world` is given, and the pose. Returns
    /// true if the end of the next slot affects the robot, even if its program does not act.
    pub(super) fn end_slot(&mut self, world: Option<&World>, at: Time) -> bool {
        self.settle_radio(at - Time(1));
        if self.is_removed {
            return false;
        }
        if let Some(world) = world {
            self.record_walk(world, at);
        }
        self.record_pose(at);
        self.motion.is_active()
    }

    /// Records the footfalls and the new contacts of a legged robot in the slot. For a robot with legs or in the water,
    /// also records the posture at the end of the slot if it has changed since the last record.
    pub fn record_walk(&mut self, world: &World, slot_end: Time) {
        if !self.motion.has_variable_height() {
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
            self.journal.record(slot_end, &Event::Posture { lift_m: lift, joints_rad: FloatList::new(&bytes) });
            self.walk.posture = posture;
        }
    }

    /// Records new contacts of thighs, shanks and body since the last check. Contacts are checked every
    /// [`TOUCH_INTERVAL`]; in a slot that is longer than the world's history, only the last part is checked.
    fn record_touches(&mut self, world: &World, slot_end: Time) {
        let unchecked_from = self.walk.checked_at.max(slot_end - HISTORY);
        let mut at = Time((unchecked_from.0.div_euclid(TOUCH_INTERVAL.0) + 1) * TOUCH_INTERVAL.0);
        while at <= slot_end {
            let contacts =
                world.leg_clearance(&mut self.motion, at, 0.0).map(|clearance| clearance.contacts).unwrap_or_default();
            for LegContact { part, thing, point } in &contacts {
                if !self.walk.touching.contains(&(*part, *thing)) {
                    let part = self.part_name(*part);
                    let with = obstacle(*thing);
                    let event = Event::LegContact { part: &part, with, x_m: point.x, y_m: point.y, z_m: point.z };
                    self.journal.record(at, &event);
                    self.walk.touches += 1;
                }
            }
            self.walk.touching = contacts.iter().map(|contact| (contact.part, contact.thing)).collect();
            self.walk.checked_at = at;
            at += TOUCH_INTERVAL;
        }
    }

    /// Name of a part in events: the name of its link, or `body`.
    fn part_name(&self, part: BodyPart) -> String {
        let (leg, link) = match part {
            BodyPart::Body => return "body".to_owned(),
            BodyPart::Thigh(leg) => (leg, "thigh"),
            BodyPart::Shank(leg) => (leg, "shank"),
        };
        let name = self.motion.legs().and_then(|legs| legs.legs.get(leg)).map_or("", |leg| &leg.name);
        format!("{name}.{link}")
    }

    /// Records that the robot `by`, or an intervention if `by` is [`WORLD`](crate::record::WORLD), has placed this
    /// robot at `pose` at the time `at`. A robot that is placed outside the floor has not left it.
    pub fn record_placed(&mut self, at: Time, by: RobotId, pose: &Pose) {
        if let Some(floor) = &mut self.floor {
            (floor.since, floor.has_been_on) = (at, floor.contains(pose.position));
        }
        let Pose { position, heading } = pose;
        let event = Event::Placed { by: by.0, x_m: position.x, y_m: position.y, phi_rad: heading.remainder() };
        self.journal.record(at, &event);
    }

    /// Records the start of the program `program`; the name is empty for a robot without a program.
    pub fn record_start(&mut self, program: &str) {
        self.record(Event::ProgramStarted { program });
    }

    /// Records a hint to the user about a likely mistake.
    pub fn hint(&mut self, text: &str) {
        self.journal.record(self.now, &Event::Hint { text });
    }

    /// Records an event now.
    pub fn record(&mut self, event: Event<'_>) {
        self.journal.record(self.now, &event);
    }
}

/// Returns a function that measures with a set of range sensors at an instant, for the driver of the PSD sensors.
fn measure_set<'a>(
    devices: (&'a Ranges, &'a Servos, &'a Switches),
    motion: &'a mut Motion,
    world: &'a World,
) -> impl Measure + 'a {
    move |sensors, at, store| {
        let caster = devices.0.caster(sensors, motion, world, at);
        members(sensors).for_each(|index| store(index, measure_range(devices, motion, &caster, index)));
    }
}

/// Reading of range sensor `index` at the instant of `caster`; a reading without a return if the sensor is switched
/// off.
fn measure_range(
    (ranges, servos, switches): (&Ranges, &Servos, &Switches),
    motion: &mut Motion,
    caster: &RayCaster,
    index: usize,
) -> Reading {
    let is_on = switches.is_on(SensorId::Range(index));
    if let Some(stuck) = switches.stuck_reading(index).filter(|_| is_on) {
        return stuck;
    }
    if is_on { ranges.read(index, servos, motion, caster) } else { ranges.no_return(index) }
}

/// Records a contact that began in the present slot in the journal of its robot.
pub(super) fn record_contact(journal: &mut Journal, contact: &Contact) {
    let with = obstacle(contact.with);
    let event = Event::Contact { at_s: contact.time.seconds(), with, x_m: contact.point.x, y_m: contact.point.y };
    journal.record(contact.time, &event);
}

/// Obstacle in its recorded form.
fn obstacle(thing: Thing) -> Obstacle {
    match thing {
        Thing::Wall(_) | Thing::Fixed(_) => Obstacle::Wall,
        Thing::Floor => Obstacle::Terrain,
        Thing::Robot(id) => Obstacle::Robot(id.0),
        Thing::Object(id) => Obstacle::Object(id.0),
    }
}
