//! Random scripts of commands: bodies never overlap with walls or each other, and all numbers stay finite.

use std::{f64::consts::PI, sync::Arc};

use accuracy::{oracle, world::room_with_boxes};
use glam::DVec2;
use proptest::prelude::*;
use sim_core::{
    RobotId,
    drive::{Command, DriveKind, Gains, Model, Motion},
    pose::{Pose, Twist},
    scene::{Segment, Walls},
    time::Time,
    world::World,
};

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => -2.0..2.0,
        1 => prop_oneof![Just(0.0), Just(-0.0), Just(1e-300), Just(5e-324), Just(1e-6), Just(-1e-9)],
        1 => prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(-1e12), Just(1e300), Just(1e4), Just(-1e4)],
    ]
}

fn command() -> impl Strategy<Value = Command> {
    let twist = (number(), number(), number(), any::<bool>()).prop_map(|(vx, vy, omega, sideways)| Twist {
        vx,
        vy: if sideways { vy } else { 0.0 },
        omega,
    });
    let drive = (number(), number(), prop_oneof![0.0..3.0, number()])
        .prop_map(|(vx, omega, duration)| Command::Drive { displacement: Twist::new(vx, omega), duration });
    prop_oneof![
        4 => twist.prop_map(Command::Twist),
        4 => drive,
        2 => [number(), number(), number(), number()].prop_map(|rates| Command::Wheels(rates.map(|rate| rate * 20.0))),
        1 => number().prop_map(Command::Steer),
        1 => Just(Command::Halt),
    ]
}

fn model() -> impl Strategy<Value = Model> {
    let kind = prop_oneof![Just(DriveKind::Differential), Just(DriveKind::Ackermann), Just(DriveKind::Omni)];
    let lag = prop_oneof![2 => Just(0.0), 1 => 0.01..0.3];
    (kind, -0.08..0.08, lag, 0.05..0.15).prop_map(|(kind, axis_offset, wheel_lag, body_radius)| Model {
        kind,
        wheel_diameter: 0.05,
        max_wheel_rate: 60.0,
        ticks_per_turn: 1000.0,
        track: 0.1,
        wheelbase: 0.12,
        axis_offset,
        max_speed: 1.2,
        max_turn: 8.0,
        body_radius,
        wheel_lag,
        max_steering: PI / 4.0,
        mass: 1.0,
        traction: 0.6,
    })
}

/// Entries of a script: microseconds since the previous entry, robot, command.
fn script() -> impl Strategy<Value = Vec<(i64, usize, Command)>> {
    prop::collection::vec((1_i64..200_000, 0_usize..4, command()), 1..60)
}

/// Four robots in a room of 3 m with boxes, clear of all obstacles and of each other.
fn scene(model: &Model, walls: &[Segment], slot: Time, gains: Option<Gains>) -> (World, Vec<Motion>) {
    let starts = (0..30).flat_map(|i| (0..30).map(move |j| DVec2::new(f64::from(i), f64::from(j)) * 0.1));
    let is_clear = |point: &DVec2| {
        point.min_element() > 0.2
            && point.max_element() < 2.8
            && oracle::clearance(walls, *point, model.body_radius) > 0.01
    };
    let mut positions: Vec<DVec2> = Vec::new();
    for start in starts.filter(is_clear) {
        if positions.len() < 4 && positions.iter().all(|point| point.distance(start) > 2.0 * model.body_radius + 0.01) {
            positions.push(start);
        }
    }
    let (shared, model) = (Arc::new(Walls::new(walls.to_vec())), Arc::new(model.clone()));
    let mut motions: Vec<_> = (0..)
        .map(RobotId::from_index)
        .zip(positions)
        .map(|(id, position)| {
            let pose = Pose { position, ..Pose::new(0.0, 0.0, f64::from(id.0)) };
            let mut motion = Motion::new(id, model.clone(), shared.clone(), pose);
            if let Some(gains) = gains {
                motion.start_control(Time::ZERO, gains).expect("valid gains");
            }
            motion
        })
        .collect();
    let world = World::new(shared, slot, &mut motions);
    (world, motions)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bodies_never_overlap_walls_or_each_other(
        model in model(),
        script in script(),
        room in 0_u64..1000,
        slot in prop_oneof![Just(1_000_i64), Just(50_000), Just(333_333), Just(1_000_000)],
        controlled in any::<bool>(),
    ) {
        let walls = room_with_boxes(room, DVec2::ZERO, 3.0, 3);
        let gains = controlled.then_some(Gains { vv: 7.0, tv: 0.3, vw: 7.0, tw: 0.1 });
        let (mut world, mut motions) = scene(&model, &walls, Time(slot), gains);
        prop_assume!(motions.len() == 4);
        let mut at = Time::ZERO;
        for (wait, robot, command) in script {
            at += Time(wait);
            while at >= world.slot_end() {
                world.advance(&mut motions.iter_mut().collect::<Vec<_>>());
                let now = world.slot_start();
                let poses: Vec<_> = motions.iter_mut().map(|motion| motion.pose(now)).collect();
                for (a, pose) in poses.iter().enumerate() {
                    prop_assert!(pose.position.is_finite() && pose.heading.radians().is_finite(), "{pose:?}");
                    let clearance = oracle::clearance(&walls, pose.position, model.body_radius);
                    prop_assert!(clearance > 0.0, "robot {a} is {} m in a wall at {now:?}", -clearance);
                    for (b, other) in poses[..a].iter().enumerate() {
                        let gap = pose.position.distance(other.position) - 2.0 * model.body_radius;
                        prop_assert!(gap > 0.0, "{a} is {} m in {b} at {now:?}", -gap);
                    }
                }
            }
            let motion = &mut motions[robot];
            let touching = world.touching(motion, at);
            let before = motion.state(at);
            if motion.command(at, command, &touching).is_err() {
                prop_assert_eq!(motion.state(at), before);
            }
            let after = motion.state(at);
            prop_assert_eq!(after.world_from_axle, before.world_from_axle, "a command moves nothing at its instant");
            prop_assert!(motion.is_drive_done(at) || motion.drive_end().is_none_or(|end| end > at));
            prop_assert!(motion.drive_remaining(at) >= 0.0 && motion.speed(at).is_finite());
            prop_assert!(motion.wheel_angles(at).iter().all(|angle| angle.is_finite()));
        }
    }

    #[test]
    fn scripts_of_a_single_robot_are_bit_identical_for_every_slot_length(
        model in model(),
        script in script(),
        room in 0_u64..1000,
        controlled in any::<bool>(),
    ) {
        let walls = room_with_boxes(room, DVec2::ZERO, 3.0, 3);
        let gains = controlled.then_some(Gains { vv: 3.0, tv: 0.3, vw: 3.0, tw: 0.1 });
        let run = |slot: i64| {
            let (_, mut motions) = scene(&model, &walls, Time(slot), gains);
            motions.truncate(1);
            let mut world = World::new(Arc::new(Walls::new(walls.clone())), Time(slot), &mut motions);
            let mut at = Time::ZERO;
            let mut states = Vec::new();
            for (wait, _, command) in &script {
                at += Time(*wait);
                while at >= world.slot_end() {
                    world.advance(&mut motions.iter_mut().collect::<Vec<_>>());
                }
                // Rejected commands are part of the script.
                let _ = motions[0].command(at, *command, &[]);
                // An end more than 1,000 s ahead may be the time of the next query, which is not part of the motion.
                let end = motions[0].drive_end().filter(|end| *end < at + Time::from_millis(1_000_000));
                states.push((motions[0].state(at), end, motions[0].contacts(at)));
            }
            states
        };
        let reference = run(50_000);
        for slot in [700, 10_000, 200_000, 1_000_000] {
            prop_assert_eq!(&run(slot), &reference, "slots of {} us", slot);
        }
    }
}
