//! A clone of a running world evolves bit-identically to its source, and neither affects the other.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use sim_core::{
    ObjectId, RobotId,
    drive::{
        Command, DriveKind, Imperfection, Model, Motion,
        legged::{Gait, Leg, Legs},
    },
    noise::{RadioNoise, TwistNoise},
    object::{Figure, Part, Properties, Resistance, Shape},
    pose::{Pose, Twist},
    radio::{Address, Channel, Medium, RadioModel, Station},
    scene::{Ground, Segment, Surface, Walls},
    time::Time,
    world::{Ray, Space, World},
};

/// Half of the side length of the room, m.
const HALF_SIDE: f64 = 1.2;

/// A pose in the room: x and y, m, and the heading, rad.
type Start = (f64, f64, f64);

/// An operation on a world at an instant of a slot.
#[derive(Clone, Debug)]
enum Action {
    Go(f64, f64),
    Drive(f64, f64),
    Halt,
    Send(bool),
    Switch,
    Kick(f64, f64),
    PlaceObject(Start),
    PlaceRobot(Start),
    AddObject(Start),
    AddRobot(Start),
    RemoveObject,
    RemoveRobot,
}

/// Slot, index of the robot or object, time as a fraction of the slot, and the action.
type Entry = (usize, usize, f64, Action);

#[derive(Clone, Debug)]
struct Script {
    slot: Time,
    medium: Medium,
    seed: u64,
    is_perfect: bool,
    robots: Vec<(Start, bool)>,
    objects: Vec<(Start, usize)>,
    entries: Vec<Entry>,
}

const SLOTS: usize = 40;

fn start() -> impl Strategy<Value = Start> {
    (-0.9..0.9, -0.9..0.9, -PI..PI)
}

fn action() -> impl Strategy<Value = Action> {
    prop_oneof![
        6 => (-0.6..0.6, -3.0..3.0).prop_map(|(v, w)| Action::Go(v, w)),
        3 => (-0.5..0.5, -2.0..2.0).prop_map(|(distance, turn)| Action::Drive(distance, turn)),
        1 => Just(Action::Halt),
        6 => any::<bool>().prop_map(Action::Send),
        2 => Just(Action::Switch),
        2 => (-1.0..1.0, -9.0..9.0).prop_map(|(v, w)| Action::Kick(v, w)),
        1 => start().prop_map(Action::PlaceObject),
        1 => start().prop_map(Action::PlaceRobot),
        1 => start().prop_map(Action::AddObject),
        1 => start().prop_map(Action::AddRobot),
        1 => Just(Action::RemoveObject),
        1 => Just(Action::RemoveRobot),
    ]
}

fn script() -> impl Strategy<Value = Script> {
    let slot = prop_oneof![Just(7), Just(20), Just(50)].prop_map(Time::from_millis);
    let medium = prop_oneof![Just(Medium::Free), Just(Medium::Aloha), Just(Medium::TokenRing)];
    let robots = prop::collection::vec((start(), prop::bool::weighted(0.2)), 1..5);
    let objects = prop::collection::vec((start(), 0_usize..3), 0..6);
    let entries = prop::collection::vec((0..SLOTS, 0_usize..16, 0.0..1.0, action()), 0..60);
    (slot, medium, any::<u64>(), any::<bool>(), robots, objects, entries).prop_map(
        |(slot, medium, seed, is_perfect, robots, objects, entries)| Script {
            slot,
            medium,
            seed,
            is_perfect,
            robots,
            objects,
            entries,
        },
    )
}

fn model(kind: DriveKind) -> Model {
    Model {
        kind,
        wheel_diameter: 0.05,
        max_wheel_rate: 60.0,
        ticks_per_turn: 540.0,
        track: 0.1,
        wheelbase: 0.1,
        axis_offset: 0.0,
        max_speed: 1.0,
        max_turn: 4.0,
        body_radius: 0.1,
        wheel_lag: 0.0,
        max_steering: 0.7,
        mass: 1.0,
        traction: 0.6,
    }
}

fn legs() -> Arc<Legs> {
    let leg = |name: &str, y: f64| Leg {
        name: name.to_owned(),
        hip: DVec3::new(0.0, y, 0.18),
        thigh: 0.1,
        shank: 0.1,
        foot: None,
        wheel: None,
    };
    let gait =
        Gait { name: "walk".to_owned(), period: Time(600_000), duty: 0.6, offsets: vec![0.0, 0.5], is_natural: false };
    Arc::new(Legs {
        legs: vec![leg("LEFT", 0.05), leg("RIGHT", -0.05)],
        gaits: vec![gait],
        step_height: 0.01,
        radius: 0.005,
        underside: 0.15,
    })
}

/// A ball, a crate, or a can of two parts.
fn properties(kind: usize) -> Arc<Properties> {
    let part = |shape, x: f64| Part { shape, object_from_part: Pose::new(x, 0.0, 0.3) };
    let (parts, resistance) = match kind {
        0 => (vec![part(Shape::Disc { radius: 0.03 }, 0.0)], Resistance::Rolling(0.02)),
        1 => (vec![part(Shape::Rectangle { half: DVec2::splat(0.06) }, 0.0)], Resistance::Sliding(0.3)),
        _ => {
            let parts = vec![part(Shape::Disc { radius: 0.03 }, 0.0), part(Shape::Disc { radius: 0.02 }, 0.04)];
            (parts, Resistance::Sliding(0.2))
        }
    };
    let centre_of_mass = DVec2::new(if kind == 2 { 0.01 } else { 0.0 }, 0.0);
    Arc::new(Properties {
        mass: 0.1,
        centre_of_mass,
        parts,
        resistance,
        restitution: 0.5,
        contact_friction: 0.3,
        lift: 0.0,
    })
}

fn pose((x, y, heading): Start) -> Pose {
    Pose::new(x, y, heading)
}

/// A world with its robots, stations and script.
#[derive(Clone)]
struct Simulation {
    script: Arc<Script>,
    walls: Arc<Walls>,
    world: World,
    motions: Vec<Motion>,
    stations: Vec<Station>,
    slot: usize,
}

impl Simulation {
    fn new(script: Script) -> Self {
        let corners =
            [(-HALF_SIDE, -HALF_SIDE), (HALF_SIDE, -HALF_SIDE), (HALF_SIDE, HALF_SIDE), (-HALF_SIDE, HALF_SIDE)]
                .map(DVec2::from);
        let mut segments: Vec<_> = (0..4).map(|side| Segment::new(corners[side], corners[(side + 1) % 4])).collect();
        segments.push(Segment::new(DVec2::new(-0.2, 0.3), DVec2::new(0.4, 0.5)));
        let walls = Arc::new(Walls::new(segments).with_heights(vec![0.5, 0.5, 0.5, 0.5, 0.2]));
        let motion = |(index, (start, has_legs)): (usize, &(Start, bool))| {
            motion(&script, &walls, RobotId::from_index(index), *start, *has_legs)
        };
        let mut motions: Vec<_> = script.robots.iter().enumerate().map(motion).collect();
        let objects = script.objects.iter().map(|(start, kind)| (properties(*kind), pose(*start)));
        let radio = RadioModel {
            medium: script.medium,
            baud: 19_200,
            latency: Time(1500),
            range: (script.seed.is_multiple_of(2)).then_some(1.5),
            line_of_sight: script.seed.is_multiple_of(3),
        };
        let errors = vec![RadioNoise { bit_error_rate: 0.01, packet_loss: 0.2 }; 3];
        let figure = Arc::new(Figure::cylinder(0.1, 0.25, Surface::default()));
        let world = World::new(Arc::clone(&walls), script.slot, &mut motions)
            .with_objects(objects)
            .with_space(Space { robots: vec![figure; script.robots.len()], ..Space::default() })
            .with_radio(Channel::new(radio, script.seed, errors));
        let mut stations: Vec<_> = motions.iter().map(|motion| Station::new(motion.id(), &radio)).collect();
        (10..).zip(&mut stations).for_each(|(address, station)| station.switch_on(address, 19_200));
        Self { script: Arc::new(script), walls, world, motions, stations, slot: 0 }
    }

    /// Advances by one slot; returns all observable state.
    fn step(&mut self) -> Vec<String> {
        let mut observations = Vec::new();
        let start = self.world.slot_start();
        let script = Arc::clone(&self.script);
        let mut entries: Vec<&Entry> = script.entries.iter().filter(|(slot, ..)| *slot == self.slot).collect();
        entries.sort_by(|one, other| one.2.total_cmp(&other.2));
        for (_, index, fraction, action) in entries {
            let at = start + Time((fraction * script.slot.0 as f64) as i64);
            observations.push(self.act(*index, at, action));
        }
        self.look(&mut observations);
        let end = self.world.slot_end();
        self.exchange(end, &mut observations);
        let is_present = |motion: &&mut Motion| self.world.is_robot_present(motion.id(), start);
        let mut active: Vec<_> =
            self.motions.iter_mut().filter(is_present).filter(|motion| motion.is_active()).collect();
        observations.extend(self.world.advance(&mut active).iter().map(|contact| format!("{contact:?}")));
        for motion in &mut self.motions {
            observations.push(format!("{:?} {:?}", motion.state(end), motion.stance(end)));
        }
        for object in (0..self.world.object_count()).map(ObjectId::from_index) {
            observations.push(format!("{:?}", self.world.object_state(object)));
        }
        observations.push(format!("{:?} {}", self.world.moved_objects(), self.world.is_object_moving()));
        self.slot += 1;
        observations
    }

    /// Applies an action if possible; returns the result.
    fn act(&mut self, index: usize, at: Time, action: &Action) -> String {
        let start = self.world.slot_start();
        let robot = RobotId::from_index(index % self.motions.len());
        let is_present = self.world.is_robot_present(robot, start);
        let object = self.world.object_count().checked_sub(1).map(|last| ObjectId::from_index(index % (last + 1)));
        let object = object.filter(|object| self.world.is_object_present(*object, start));
        let motion = &mut self.motions[robot.index()];
        let command = match *action {
            Action::Go(v, w) => Command::Twist(Twist::new(v, w)),
            Action::Drive(distance, turn) => Command::Drive { displacement: Twist::new(distance, turn), duration: 0.6 },
            Action::Halt => Command::Halt,
            _ => return self.intervene(robot, object, at, action),
        };
        if !is_present {
            return String::new();
        }
        let touching = self.world.touching(motion, at);
        format!("{:?} {touching:?}", motion.command(at, command, &touching))
    }

    fn intervene(&mut self, robot: RobotId, object: Option<ObjectId>, at: Time, action: &Action) -> String {
        let is_present = self.world.is_robot_present(robot, self.world.slot_start());
        let station = &mut self.stations[robot.index()];
        match (action, object) {
            (Action::Send(is_to_all), _) if is_present && station.member().is_some() => {
                let position = self.world.robot_pose(robot, at).position;
                let to = if *is_to_all { Address::All } else { Address::One(10) };
                format!(
                    "{:?}",
                    station.send(at, to, b"Eyebots talk", self.world.unreachable_robots(robot, position, at))
                )
            }
            (Action::Switch, _) if station.member().is_some() => format!("{:?}", station.switch_off(at)),
            (Action::Switch, _) => {
                station.switch_on(20 + robot.0, 19_200);
                String::new()
            }
            (Action::Kick(v, w), Some(object)) => {
                self.world.set_object_velocity(object, DVec2::new(*v, 0.3), *w);
                String::new()
            }
            (Action::PlaceObject(start), Some(object)) => {
                format!("{:?}", self.world.place_object(object, pose(*start)))
            }
            (Action::PlaceRobot(start), _) if is_present => {
                format!("{:?}", self.motions[robot.index()].place(at, pose(*start)))
            }
            (Action::AddObject(start), _) => {
                let figure = Figure::cylinder(0.05, 0.15, Surface::SMOOTH);
                format!("{:?}", self.world.add_object(properties(0), pose(*start), Some(Arc::new(figure))))
            }
            (Action::AddRobot(start), _) => {
                let id = RobotId::from_index(self.motions.len());
                let motion = motion(&self.script, &self.walls, id, *start, false);
                let mut motion = motion.starting_at(self.world.slot_start());
                self.world.add_robot(&mut motion, None);
                self.motions.push(motion);
                self.stations.push(Station::new(id, self.world.radio().model()));
                String::new()
            }
            (Action::RemoveObject, Some(object)) => {
                self.world.remove_object(object);
                String::new()
            }
            (Action::RemoveRobot, _) => {
                self.world.remove_robot(robot);
                String::new()
            }
            _ => String::new(),
        }
    }

    /// Records the hits of rays around each robot, in the plane and in three dimensions.
    fn look(&self, seen: &mut Vec<String>) {
        let at = self.world.slot_start() + Time(self.script.slot.0 / 3);
        for motion in &self.motions {
            let origin = self.world.robot_pose(motion.id(), at).position;
            for ray in 0..6 {
                let direction = Pose::new(0.0, 0.0, f64::from(ray)).heading.direction();
                let level = self.world.cast(motion.id(), &Ray::flat(origin, direction, 3.0), at);
                let tilted = direction.extend(0.1 * f64::from(ray - 3)).normalize_or_zero();
                seen.push(format!(
                    "{level:?} {:?}",
                    self.world.cast(motion.id(), &Ray::new(origin.extend(0.1), tilted, 3.0), at)
                ));
            }
        }
    }

    /// Exchanges the messages of the slot that ends at `end`.
    fn exchange(&mut self, end: Time, seen: &mut Vec<String>) {
        let mut messages = Vec::new();
        let channel = self.world.radio_mut();
        for station in &mut self.stations {
            if let Some(change) = station.take_change() {
                channel.report_change(change);
            }
            messages.extend(station.take_outgoing());
        }
        let deliveries = channel.exchange(end, messages);
        seen.push(format!("{deliveries:?} {:?}", channel.due()));
        for (robot, sequence) in channel.take_transmitted() {
            self.stations[robot.index()].release(sequence);
        }
        for delivery in deliveries {
            self.stations[delivery.to.index()].deliver(delivery);
        }
        for station in &mut self.stations {
            seen.push(format!("{:?} {:?}", station.collect_visible(end - Time(1)), station.receive()));
        }
    }

    fn run(&mut self, slots: usize) -> Vec<Vec<String>> {
        (0..slots).map(|_| self.step()).collect()
    }
}

fn motion(script: &Script, walls: &Arc<Walls>, id: RobotId, start: Start, has_legs: bool) -> Motion {
    let kind = if has_legs { DriveKind::Legged } else { DriveKind::Differential };
    let motion = Motion::new(id, Arc::new(model(kind)), Arc::clone(walls), pose(start));
    let motion = if has_legs { motion.with_legs(legs(), Arc::new(Ground::Flat)) } else { motion };
    if script.is_perfect {
        return motion;
    }
    let command = TwistNoise { speed: 0.01, speed_share: 0.05, turn: 0.02, turn_share: 0.05 };
    let imperfection = Imperfection { slip: 0.02, slip_deviation: 0.05, command, ..Imperfection::default() };
    motion.with_imperfection(script.seed, imperfection).expect("a valid imperfection")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn clone_evolves_like_its_source(script in script(), at in 0..SLOTS, other in script()) {
        let alone = Simulation::new(script.clone()).run(SLOTS);
        let mut original = Simulation::new(script);
        original.run(at);
        let (mut copy, mut kept) = (original.clone(), original.clone());
        // A clone that follows another script.
        let mut diverging = original.clone();
        diverging.script = Arc::new(Script { entries: other.entries, ..Script::clone(&diverging.script) });
        for expected in &alone[at..] {
            prop_assert_eq!(&copy.step(), expected);
            diverging.step();
            prop_assert_eq!(&original.step(), expected);
        }
        prop_assert_eq!(&kept.run(SLOTS - at), &alone[at..]);
    }
}
