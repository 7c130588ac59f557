//! Walking: standing feet do not slide, joints are continuous, and queries do not affect the result.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use sim_core::{
    RobotId, build,
    drive::{
        Command, DriveKind, Model, Motion,
        legged::{Foot, Gait, Leg, LegCommand, LegCommandError, Legs, Stance, natural_angles},
    },
    math,
    pose::{Link, Pose, Pose3, Twist, link_pose},
    scene::{Ground, HeightField, Walls},
    sensor::Posture,
    time::Time,
};
use sim_format::{content, print, read_companion, read_robi};

const ROBOT: RobotId = RobotId(1);

fn model(legs: &Legs) -> Model {
    let gait = &legs.gaits[0];
    Model {
        kind: DriveKind::Legged,
        wheel_diameter: 0.05,
        max_wheel_rate: 60.0,
        ticks_per_turn: 1000.0,
        track: 0.1,
        wheelbase: 0.1,
        axis_offset: 0.0,
        max_speed: legs.max_speed(gait),
        max_turn: legs.max_turn_rate(gait),
        body_radius: 0.3,
        wheel_lag: 0.0,
        max_steering: 0.7,
        mass: 10.0,
        traction: 0.6,
    }
}

fn leg(name: &str, x: f64, y: f64, foot: Option<Foot>) -> Leg {
    let hip = DVec3::new(x, y, if foot.is_some() { 0.9 } else { 0.8 });
    Leg { name: name.to_owned(), hip, thigh: 0.44, shank: 0.44, foot, wheel: None }
}

fn biped() -> Legs {
    let foot = Some(Foot { heel: 0.05, toe: 0.15, height: 0.07 });
    Legs {
        legs: vec![leg("LEFT", 0.0, 0.1, foot), leg("RIGHT", 0.0, -0.1, foot)],
        gaits: vec![Gait {
            name: "walk".to_owned(),
            period: Time(1_100_000),
            duty: 0.6,
            offsets: vec![0.0, 0.5],
            is_natural: true,
        }],
        step_height: 0.03,
        radius: 0.03,
        underside: 0.9,
    }
}

fn four_legs() -> Legs {
    let gait = |name: &str, period, duty, offsets: [f64; 4]| Gait {
        name: name.to_owned(),
        period: Time(period),
        duty,
        offsets: offsets.to_vec(),
        is_natural: false,
    };
    Legs {
        legs: vec![
            leg("FRONT_LEFT", 0.5, 0.3, None),
            leg("FRONT_RIGHT", 0.5, -0.3, None),
            leg("BACK_LEFT", -0.5, 0.3, None),
            leg("BACK_RIGHT", -0.5, -0.3, None),
        ],
        gaits: vec![
            gait("creep", 2_000_000, 0.8, [0.25, 0.75, 0.0, 0.5]),
            gait("trot", 1_000_000, 0.6, [0.0, 0.5, 0.5, 0.0]),
        ],
        step_height: 0.05,
        radius: 0.03,
        underside: 0.8,
    }
}

fn walker(legs: &Arc<Legs>) -> Motion {
    walker_on(legs, Ground::Flat)
}

fn walker_on(legs: &Arc<Legs>, ground: Ground) -> Motion {
    let walls = Arc::new(Walls::new(Vec::new()));
    let motion = Motion::new(ROBOT, Arc::new(model(legs)), walls, Pose::new(1.0, -2.0, 0.7));
    motion.with_legs(Arc::clone(legs), Arc::new(ground))
}

/// Ground with bumps of up to 0.1 m every 0.3 m, and a step of 0.15 m up across the way.
fn rough() -> Ground {
    let mut xs: Vec<f64> = (-40..=40).map(|index| f64::from(index) * 0.3).collect();
    // A step: the same coordinate twice.
    let step = 46;
    xs.insert(step, xs[step]);
    let ys: Vec<f64> = (-40..=40).map(|index| f64::from(index) * 0.3).collect();
    let mut heights = Vec::new();
    for row in 0..ys.len() {
        for column in 0..xs.len() {
            let bump = ((row * 7919 + (column - usize::from(column > step)) * 104_729) % 101) as f64 / 1010.0;
            heights.push(bump + if column > step { 0.15 } else { 0.0 });
        }
    }
    Ground::Field(Arc::new(HeightField::new(xs, ys, heights).expect("a field")))
}

/// Contact point of each foot by forward kinematics: the point of the sole named by its state, in the world frame.
fn touched(legs: &Legs, links: &[Link], stance: &Stance, pose: &Pose) -> Vec<DVec3> {
    let world_from_robot = Pose3::from_planar(pose, stance.lift);
    let mut first = 0;
    let mut points = Vec::new();
    for (leg, foot) in legs.legs.iter().zip(&stance.feet) {
        let (last, point) = match leg.foot {
            Some(shape) => (first + 4, DVec3::new(foot.sole.from_ankle, 0.0, -shape.height)),
            None => (first + 3, DVec3::new(0.0, 0.0, -leg.shank)),
        };
        points.push(world_from_robot.transform_point(link_pose(links, &stance.joints, last).transform_point(point)));
        first += leg.link_count();
    }
    points
}

/// Walks for `seconds`, queried every 5 ms, and checks that feet on the ground touch it and do not move, by forward
/// kinematics. Returns the number of steps and the maximum joint rate, rad/s.
fn check(legs: &Arc<Legs>, motion: &mut Motion, from: Time, seconds: f64) -> (usize, f64) {
    check_on(legs, &Ground::Flat, motion, from, seconds)
}

fn check_on(legs: &Arc<Legs>, ground: &Ground, motion: &mut Motion, from: Time, seconds: f64) -> (usize, f64) {
    let links = legs.links(0, 0);
    let mut before: Option<(Stance, Vec<DVec3>)> = None;
    let (mut steps, mut rate) = (0, 0.0f64);
    let every = Time(5_000);
    for index in 0..(seconds / every.seconds()) as i64 {
        let at = from + Time(index * every.0);
        let pose = motion.pose(at);
        let stance = motion.stance(at);
        let points = touched(legs, &links, &stance, &pose);
        assert_eq!(stance.joints.len(), legs.joint_count());
        assert!(stance.lift.is_finite() && stance.joints.iter().all(|angle| angle.is_finite()), "{stance:?}");
        for (index, (foot, point)) in stance.feet.iter().zip(&points).enumerate() {
            let foot_before = before.as_ref().map(|(stance, points)| (stance.feet[index], points[index]));
            if foot.is_down {
                let off = (*point - foot.point).length();
                assert!(off < 1e-3, "{at}: foot {index} is {off} m from where it stands, lift {}", stance.lift);
                // The whole sole is at the height of the ground under the ankle.
                let (sin, cos) = math::sin_cos(foot.heading);
                let ankle = foot.point.truncate() - DVec2::new(cos, sin) * foot.sole.from_ankle;
                let above = point.z - ground.height(ankle);
                assert!(above.abs() < 1e-3, "{at}: foot {index} at {point}, {above} m above the ground");
                if let Some((earlier, point_before)) = foot_before.filter(|(earlier, _)| earlier.is_down)
                    && earlier.sole.from_ankle == foot.sole.from_ankle
                {
                    let slid = (*point - point_before).length();
                    assert!(slid < 1e-3, "{at}: foot {index} slid by {slid} m");
                }
            } else {
                steps += usize::from(foot_before.is_none_or(|(earlier, _)| earlier.is_down));
                let is_flat = matches!(ground, Ground::Flat);
                assert!(!is_flat || point.z > -1e-3, "{at}: foot {index} in the ground, {point}");
            }
        }
        if let Some((earlier, _)) = &before {
            assert!((earlier.lift - stance.lift).abs() < 0.06, "{at}: from {} to {}", earlier.lift, stance.lift);
            for (a, b) in earlier.joints.iter().zip(&stance.joints) {
                rate = rate.max((a - b).abs() / every.seconds());
            }
        }
        before = Some((stance, points));
    }
    (steps, rate)
}

#[test]
fn a_robot_that_stands_has_its_feet_under_its_hips() {
    let legs = Arc::new(biped());
    let mut motion = walker(&legs);
    let stance = motion.stance(Time::ZERO);
    assert_eq!(stance.lift, 0.0);
    for (found, standing) in stance.joints.iter().zip(legs.standing_joints()) {
        assert!((found - standing).abs() < 1e-12);
    }
    let left = Pose::new(1.0, -2.0, 0.7).transform_point(DVec2::new(0.0, 0.1));
    assert!((stance.feet[0].point - left.extend(0.0)).length() < 1e-12 && stance.feet.iter().all(|foot| foot.is_down));
    assert_eq!(motion.take_footfalls(Time(1_000_000)), []);
}

#[test]
fn standing_feet_do_not_move_on_straight_paths_curves_and_turns() {
    for legs in [Arc::new(biped()), Arc::new(four_legs())] {
        let (speed, turn) = (model(&legs).max_speed, model(&legs).max_turn);
        for twist in [
            Twist::new(speed, 0.0),
            Twist::new(-0.5 * speed, 0.0),
            Twist { vx: 0.0, vy: 0.4 * speed, omega: 0.0 },
            Twist::new(0.0, turn),
            Twist::new(0.5 * speed, 0.5 * turn),
            Twist { vx: 0.3 * speed, vy: -0.3 * speed, omega: -0.3 * turn },
        ] {
            let mut motion = walker(&legs);
            motion.command(Time(123_457), Command::Twist(twist), &[]).expect("can be driven");
            let (steps, rate) = check(&legs, &mut motion, Time::ZERO, 6.0);
            assert!(steps >= 5, "{steps} steps with {twist:?}");
            assert!(rate < 60.0, "{rate} rad/s with {twist:?}");
        }
    }
}

#[test]
fn a_walk_that_stops_ends_with_the_feet_under_the_hips() {
    for legs in [Arc::new(biped()), Arc::new(four_legs())] {
        let mut motion = walker(&legs);
        let displacement = Twist::new(1.7, 0.4);
        motion.command(Time(1), Command::Drive { displacement, duration: 8.0 }, &[]).expect("can be driven");
        check(&legs, &mut motion, Time::ZERO, 14.0);
        let (pose, stance) = (motion.pose(Time(14_000_000)), motion.stance(Time(14_000_000)));
        for (leg, foot) in legs.legs.iter().zip(&stance.feet) {
            let hip = pose.transform_point(leg.hip.truncate());
            assert!((foot.point.truncate() - hip).length() < 6e-3 && foot.is_down, "{foot:?} {hip}");
        }
        assert!(stance.lift.abs() < 1e-3);
        // The robot then rests.
        assert_eq!(motion.stance(Time(20_000_000)), stance);
    }
}

#[test]
fn one_foot_of_a_creeping_robot_is_in_the_air_at_a_time() {
    let legs = Arc::new(four_legs());
    let mut motion = walker(&legs);
    motion.command(Time(0), Command::Twist(Twist::new(0.2, 0.0)), &[]).expect("can be driven");
    for index in 0..2000 {
        let stance = motion.stance(Time(index * 5_000));
        assert!(stance.feet.iter().filter(|foot| !foot.is_down).count() <= 1);
    }
    let falls = motion.take_footfalls(Time(10_000_000));
    assert!(falls.windows(2).all(|pair| pair[0].time <= pair[1].time));
    // Order of the legs: back left, front left, back right, front right.
    assert!(falls.windows(4).all(|four| (0..4).all(|leg| four.iter().any(|fall| fall.leg == leg))), "{falls:?}");
    assert_eq!(falls[0].leg, 2);
    // At full walk the stride of a foot is speed times period.
    let of_first: Vec<_> = falls.iter().filter(|fall| fall.leg == 0).collect();
    let stride = (of_first[3].point - of_first[2].point).length();
    assert!((stride - 0.4).abs() < 1e-9, "{stride}");
    assert_eq!(of_first[3].time - of_first[2].time, Time(2_000_000));
}

#[test]
fn a_correction_shifts_the_foothold_and_lifts_the_foot() {
    let legs = Arc::new(four_legs());
    let fall = |correct: Option<Time>| {
        let mut motion = walker(&legs);
        motion.command(Time(0), Command::Twist(Twist::new(0.2, 0.0)), &[]).expect("can be driven");
        if let Some(at) = correct {
            let command = LegCommand::ShiftFoothold { leg: 2, shift: DVec2::new(0.03, -0.02), lift: 0.1 };
            motion.command_legs(at, command).expect("small enough");
        }
        check(&legs, &mut motion, Time::ZERO, 3.0);
        let top = (0..600).map(|index| motion.stance(Time(index * 1_000)).feet[2].point.z).fold(0.0, f64::max);
        (motion.take_footfalls(Time(3_000_000))[0], top)
    };
    let (plain, low) = fall(None);
    let shift = Pose::new(0.0, 0.0, 0.7).transform_point(DVec2::new(0.03, -0.02)).extend(0.0);
    // Before the foot lifts off, and in the middle of its swing.
    for at in [Time(0), Time(80_000)] {
        let (corrected, high) = fall(Some(at));
        assert_eq!((corrected.leg, corrected.time), (plain.leg, plain.time));
        assert!((corrected.point - plain.point - shift).length() < 1e-12, "{corrected:?} {plain:?}");
        assert!(high > low + 0.05, "{high} {low}");
    }
}

#[test]
fn legs_refuse_what_they_cannot_do() {
    let legs = Arc::new(biped());
    let mut motion = walker(&legs);
    let at = Time(5);
    assert_eq!(motion.command_legs(at, LegCommand::Gait(1)), Err(LegCommandError::NoGait { gaits: 1 }));
    let correct = |leg, x| LegCommand::ShiftFoothold { leg, shift: DVec2::new(x, 0.0), lift: 0.0 };
    assert_eq!(motion.command_legs(at, correct(2, 0.0)), Err(LegCommandError::NoLeg { legs: 2 }));
    for wrong in [f64::NAN, f64::INFINITY, 3.0] {
        assert_eq!(motion.command_legs(at, correct(0, wrong)), Err(LegCommandError::Length));
        assert_eq!(motion.command_legs(at, LegCommand::StepHeight(wrong)), Err(LegCommandError::Length));
    }
    assert_eq!(motion.command_legs(at, LegCommand::StepHeight(-0.01)), Err(LegCommandError::Length));
    let walls = Arc::new(Walls::new(Vec::new()));
    let mut none = Motion::new(ROBOT, Arc::new(model(&legs)), walls, Pose::default());
    assert_eq!(none.command_legs(at, LegCommand::Gait(0)), Err(LegCommandError::NoLegs));
    assert_eq!(none.stance(at), Stance::default());
    assert!(none.command(at, Command::Wheels([1.0; 4]), &[]).is_err());
}

/// A program's command to its robot.
#[derive(Clone, Copy, Debug)]
enum LegInput {
    Twist(Twist),
    Drive(Twist, f64),
    Halt,
    Place(Pose),
    Legs(LegCommand),
}

fn apply_input(motion: &mut Motion, at: Time, input: LegInput) {
    match input {
        LegInput::Twist(twist) => motion.command(at, Command::Twist(twist), &[]).expect("can be driven"),
        LegInput::Drive(displacement, duration) => {
            motion.command(at, Command::Drive { displacement, duration }, &[]).expect("can be driven");
        }
        LegInput::Halt => motion.command(at, Command::Halt, &[]).expect("can be driven"),
        LegInput::Place(pose) => motion.place(at, pose).expect("a place"),
        // Another robot may not have this leg or gait.
        LegInput::Legs(command) => drop(motion.command_legs(at, command)),
    }
}

fn leg_input() -> impl Strategy<Value = LegInput> {
    let twist = (-1.0..1.0, -1.0..1.0, -2.0..2.0).prop_map(|(vx, vy, omega)| Twist { vx, vy, omega });
    let correction = (0..4usize, -0.1..0.1, -0.1..0.1, 0.0..0.1);
    let correction =
        correction.prop_map(|(leg, x, y, lift)| LegCommand::ShiftFoothold { leg, shift: DVec2::new(x, y), lift });
    prop_oneof![
        6 => twist.clone().prop_map(LegInput::Twist),
        3 => (twist, 0.0..3.0).prop_map(|(twist, duration)| LegInput::Drive(twist, duration)),
        2 => Just(LegInput::Halt),
        1 => (-9.0..9.0, -9.0..9.0, -PI..PI).prop_map(|(x, y, phi)| LegInput::Place(Pose::new(x, y, phi))),
        2 => correction.prop_map(LegInput::Legs),
        1 => (0.0..0.2).prop_map(|height| LegInput::Legs(LegCommand::StepHeight(height))),
        1 => (0..2usize).prop_map(|gait| LegInput::Legs(LegCommand::Gait(gait))),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn feet_stand_whatever_is_commanded(
        script in prop::collection::vec((1_000..1_500_000i64, leg_input()), 1..12),
        is_biped: bool,
    ) {
        let legs = Arc::new(if is_biped { biped() } else { four_legs() });
        let mut motion = walker(&legs);
        let mut now = Time::ZERO;
        for (wait, input) in script {
            apply_input(&mut motion, now, input);
            check(&legs, &mut motion, now, Time(wait).seconds());
            now += Time(wait);
        }
    }

    #[test]
    fn stances_do_not_depend_on_queries(
        script in prop::collection::vec((1_000..900_000i64, leg_input()), 1..8),
        asked in prop::collection::vec(0..3_000_000i64, 0..20),
        slots in prop_oneof![Just(1_000i64), Just(50_000), Just(64_003)],
    ) {
        let legs = Arc::new(four_legs());
        let mut lazy = walker(&legs);
        let mut busy = walker(&legs);
        let mut now = Time::ZERO;
        let mut slot = Time::ZERO;
        for (wait, input) in script {
            for ahead in &asked {
                busy.stance(now + Time(*ahead));
            }
            apply_input(&mut lazy, now, input);
            apply_input(&mut busy, now, input);
            for ahead in &asked {
                busy.stance(now + Time(*ahead));
            }
            now += Time(wait);
            while slot + Time(slots) <= now {
                slot += Time(slots);
                busy.stance(slot);
            }
            for back in [0, 1, 777, 12_345] {
                let at = (now - Time(back)).max(Time::ZERO);
                prop_assert_eq!(lazy.stance(at), busy.stance(at));
            }
        }
    }
}

#[test]
fn a_turn_on_the_spot_turns_each_foot_by_as_much() {
    let legs = Arc::new(biped());
    let mut motion = walker(&legs);
    motion.command(Time(0), Command::Drive { displacement: Twist::new(0.0, TAU), duration: 9.0 }, &[]).expect("turns");
    check(&legs, &mut motion, Time::ZERO, 13.0);
    let stance = motion.stance(Time(13_000_000));
    for foot in &stance.feet {
        assert!((foot.heading - 0.7).abs() < 6e-3, "{foot:?}");
    }
}

#[test]
fn a_natural_walk_is_close_to_the_published_angles() {
    let legs = Arc::new(person());
    let speed = legs.natural_speed(&legs.gaits[0]).expect("a natural gait");
    let mut motion = walker(&legs);
    motion.command(Time(0), Command::Twist(Twist::new(speed, 0.0)), &[]).expect("can be driven");
    check(&legs, &mut motion, Time::ZERO, 8.0);
    let falls = motion.take_footfalls(Time(8_000_000));
    let strike = falls.iter().rfind(|fall| fall.leg == 0 && fall.time < Time(6_500_000)).expect("it walks").time;
    let (mut squares, mut max_error) = ([0.0; 3], [0.0f64; 3]);
    for percent in 0..100 {
        let phase = f64::from(percent) / 100.0;
        let stance = motion.stance(strike + Time(i64::from(percent) * legs.gaits[0].period.0 / 100));
        for (joint, (found, source)) in stance.joints[2..5].iter().zip(natural_angles(phase)).enumerate() {
            let off = (found - source).to_degrees();
            squares[joint] += off * off / 100.0;
            max_error[joint] = max_error[joint].max(off.abs());
        }
    }
    let rms = squares.map(f64::sqrt);
    println!("{speed} m/s: thigh, knee, ankle differ by {rms:?} degrees (rms), {max_error:?} (most)");
    assert!(
        rms.iter().all(|rms| *rms < 6.0) && max_error.iter().all(|max_error| *max_error < 18.0),
        "{rms:?} {max_error:?}"
    );
}

#[test]
fn the_body_of_a_placed_robot_does_not_bob() {
    let legs = Arc::new(person());
    let speed = legs.natural_speed(&legs.gaits[0]).expect("a natural gait");
    // One placement in a steady walk, one while the walk begins.
    for placed_at in [Time(4_000_000), Time(300_000)] {
        let mut motion = walker(&legs);
        motion.command(Time(0), Command::Twist(Twist::new(speed, 0.0)), &[]).expect("can be driven");
        let before = motion.lift(placed_at - Time(1));
        motion.place(placed_at, Pose::default()).expect("a pose");
        let mut lift = |ms: i64| motion.lift(placed_at + Time(1_000 * ms));
        assert!((lift(-1) - before).abs() < 3e-4 && before.abs() > 5e-4, "{before}");
        assert_eq!([0, 1, 100, 200, 300, 1_000, 5_000].map(&mut lift), [0.0; 7]);
    }
}

/// Biped of 1.75 m height, as in robis/biped.toml.
fn person() -> Legs {
    let foot = Some(Foot { heel: 0.055, toe: 0.16, height: 0.068 });
    let leg =
        |name: &str, y| Leg { hip: DVec3::new(0.0, y, 0.9), thigh: 0.429, shank: 0.43, ..leg(name, 0.0, y, foot) };
    Legs { legs: vec![leg("LEFT", 0.09), leg("RIGHT", -0.09)], step_height: 0.0, ..biped() }
}

/// A sensor on the shank looks ahead at right angles to the shank, with a range of 2 m, while the robot walks at its
/// full natural speed. In France et al. 1999, section 6.3, its incidence angle on the floor runs from 33 to 78 degrees.
#[test]
fn a_sensor_on_the_shank_meets_the_floor_as_in_the_paper() {
    let legs = Arc::new(person());
    let links = legs.links(0, 0);
    let speed = legs.natural_speed(&legs.gaits[0]).expect("a natural gait");
    let mut motion = walker(&legs);
    motion.command(Time(0), Command::Twist(Twist::new(speed, 0.0)), &[]).expect("can be driven");
    let mount = Pose3 { position: DVec3::new(0.05, 0.0, -0.03), ..Pose3::IDENTITY };
    let (mut min_height, mut max_height, mut heights) = (f64::MAX, 0.0f64, [f64::MAX, 0.0f64]);
    for index in 0..4400 {
        let at = Time(4_400_000 + index * 1_000);
        let (pose, stance) = (motion.pose(at), motion.stance(at));
        let world_from_robot = Pose3::from_planar(&pose, stance.lift);
        let sensor = world_from_robot.then(&link_pose(&links, &stance.joints, 8)).then(&mount);
        let down = -sensor.forward().z;
        heights = [heights[0].min(sensor.position.z), heights[1].max(sensor.position.z)];
        if down > 0.0 && sensor.position.z / down <= 2.0 {
            let incidence = math::atan2((1.0 - down * down).sqrt(), down).to_degrees();
            (min_height, max_height) = (min_height.min(incidence), max_height.max(incidence));
        }
    }
    println!("incidence {min_height} to {max_height} degrees at {speed} m/s, sensor {heights:?} m high");
    assert!((min_height - 33.0).abs() < 5.0 && (max_height - 78.0).abs() < 5.0, "{min_height} to {max_height}");
}

#[test]
fn feet_rest_on_rough_ground_and_steps() {
    for legs in [Arc::new(biped()), Arc::new(four_legs())] {
        let (speed, turn) = (model(&legs).max_speed, model(&legs).max_turn);
        for twist in [Twist::new(0.6 * speed, 0.0), Twist::new(-0.4 * speed, 0.2 * turn), Twist::new(0.0, 0.5 * turn)] {
            let ground = rough();
            let mut motion = walker_on(&legs, ground.clone());
            motion.command(Time(0), Command::Twist(twist), &[]).expect("can be driven");
            let (steps, _) = check_on(&legs, &ground, &mut motion, Time::ZERO, 8.0);
            assert!(steps >= 8, "{steps} steps with {twist:?}");
            motion.command(Time(8_000_000), Command::Halt, &[]).expect("stops");
            check_on(&legs, &ground, &mut motion, Time(8_000_000), 4.0);
        }
    }
}

#[test]
fn wheels_in_place_of_feet_roll_along() {
    let mut legs = four_legs();
    for leg in &mut legs.legs[2..] {
        leg.wheel = Some(0.1);
    }
    let legs = Arc::new(legs);
    let mut motion = walker(&legs);
    motion.command(Time(0), Command::Twist(Twist::new(0.2, 0.1)), &[]).expect("can be driven");
    for index in 0..200 {
        let at = Time(index * 20_000);
        let (pose, stance) = (motion.pose(at), motion.stance(at));
        for (leg, foot) in legs.legs.iter().zip(&stance.feet).skip(2) {
            let hip = pose.transform_point(leg.hip.truncate());
            assert!(foot.is_down && (foot.point - hip.extend(0.0)).length() < 1e-12);
        }
    }
    assert!(motion.take_footfalls(Time(4_000_000)).iter().all(|fall| fall.leg < 2));
}

/// Robot types with legs.
const TYPES: [(&str, &str, &str); 3] = [
    ("biped.robi", include_str!("../../robis/biped.robi"), include_str!("../../robis/biped.toml")),
    ("alduro.robi", include_str!("../../robis/alduro.robi"), include_str!("../../robis/alduro.toml")),
    (
        "alduro-wheels.robi",
        include_str!("../../robis/alduro-wheels.robi"),
        include_str!("../../robis/alduro-wheels.toml"),
    ),
];

#[test]
fn types_with_legs_are_read_printed_and_read_again() {
    for (file, text, companion) in TYPES {
        let read = |text: &str, companion: &str| {
            let (mut robi, mut reported) = read_robi(file, text);
            reported.extend(read_companion(file, companion, &mut robi));
            assert_eq!(reported, [], "{file}");
            robi
        };
        let robi = read(text, companion);
        assert_eq!(robi.drive.kind, DriveKind::Legged);
        let printed = print::print_robi(&robi);
        assert_eq!(printed.lost, Vec::<String>::new(), "{file}");
        assert_eq!(content::robi(&read(&printed.text, &print::print_companion(&robi))), content::robi(&robi), "{file}");
        let legs = build::legs(&robi).expect("it has legs");
        assert_eq!(build::model(&robi).check(), Ok(()));
        let motors = robi.all_servos().len();
        let links = build::links(&robi);
        let joints = links.iter().filter_map(|link| link.joint).collect::<Vec<_>>();
        assert_eq!(joints, (motors..motors + legs.joint_count()).collect::<Vec<_>>(), "{file}");
        // The robot can walk.
        let walls = Arc::new(Walls::new(Vec::new()));
        let model = Arc::new(build::model(&robi));
        let speed = model.max_speed.min(robi.max_speed);
        let mut motion =
            Motion::new(ROBOT, model, walls, Pose::default()).with_legs(Arc::clone(&legs), Arc::new(Ground::Flat));
        motion.command(Time(0), Command::Twist(Twist::new(speed, 0.0)), &[]).expect("can be driven");
        let seconds = 4.0 * legs.gaits[0].period.seconds();
        if legs.legs.iter().all(|leg| leg.wheel.is_none()) {
            check(&legs, &mut motion, Time::ZERO, seconds);
        }
        println!("{file}: {speed} m/s, {} rad/s", motion.model().max_turn);
    }
}

#[test]
fn sensors_sit_on_the_links_of_legs() {
    let (file, text, companion) = TYPES[0];
    let (mut robi, _) = read_robi(file, text);
    read_companion(file, companion, &mut robi);
    let sensors = build::range_sensors(&robi);
    // The links yaw, roll, thigh, shank and foot of the left leg come before.
    assert_eq!(sensors[0].link, Some(5 + 3));
    let (links, legs) = (build::links(&robi), build::legs(&robi).expect("it has legs"));
    let posture = Posture { links: &links, angles: &legs.standing_joints(), lift: 0.25, ..Posture::default() };
    let pose = sensors[0].world_from_sensor(&posture);
    assert!((pose.position.z - 0.25 - 0.4).abs() < 0.05, "{pose:?}");
    assert!((pose.position.y + 0.09).abs() < 1e-12);
}
