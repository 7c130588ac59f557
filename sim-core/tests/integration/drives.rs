//! Drives end at their targets: odometry and true pose equal the command, for every slot length, sign and size.

use std::{
    f64::consts::{PI, TAU},
    sync::Arc,
};

use glam::DVec2;
use proptest::prelude::*;
use sim_core::{
    RobotId,
    drive::{Command, CommandError, DriveKind, Gains, Model, Motion, Pid, Wheels, arc_to},
    math,
    pose::{Heading, Pose, Twist},
    scene::Walls,
    time::{TICK, Time},
    world::World,
};

/// Tolerance between a command and the robot's final pose: metres and radians.
const MARK: f64 = 1e-6;

/// Model of a LabBot.
fn model() -> Model {
    Model {
        kind: DriveKind::Differential,
        wheel_diameter: 0.055,
        max_wheel_rate: 60.0,
        ticks_per_turn: 540.0,
        track: 0.14,
        wheelbase: 0.1,
        axis_offset: 0.03,
        max_speed: 0.6,
        max_turn: 5.0,
        body_radius: 0.1,
        wheel_lag: 0.0,
        max_steering: PI / 4.0,
        mass: 1.0,
        traction: 0.6,
    }
}

/// Model of a LabBot with such high limits that every drive ends soon.
fn racer() -> Model {
    Model { max_wheel_rate: 1e4, max_speed: 200.0, max_turn: 400.0, ..model() }
}

/// A robot alone in the plane, driven by a program that waits for each drive.
struct Rig {
    world: World,
    motion: Motion,
    at: Time,
}

impl Rig {
    fn new(model: Model, slot: Time, start: Pose) -> Self {
        model.check().expect("a valid model");
        let walls = Arc::new(Walls::new(vec![]));
        let mut motion = Motion::new(RobotId(1), Arc::new(model), walls.clone(), start);
        let world = World::new(walls, slot, [&mut motion]);
        Self { world, motion, at: Time(1_234) }
    }

    /// Advances to `at`, slot by slot as long as the robot moves.
    fn advance_to(&mut self, at: Time) {
        while self.world.slot_end() <= at {
            if self.motion.is_active() {
                self.world.advance(&mut [&mut self.motion]);
            } else {
                let slot_start = at.floor_to(self.world.slot());
                self.world.advance_to(slot_start);
            }
        }
        self.at = at;
    }

    fn command(&mut self, command: Command) {
        self.motion.command(self.at, command, &[]).expect("a valid command");
    }

    /// Drives to the end at a speed in m/s, or in rad/s for a turn on the spot, but within 4 s if possible; checks that
    /// the remaining distance never increases.
    fn drive(&mut self, displacement: Twist, speed: f64) {
        let whole = if displacement.vx == 0.0 { displacement.omega } else { displacement.vx };
        self.command(Command::Drive { displacement, duration: (whole.abs() / speed).min(4.0) });
        let start = self.at;
        let end = self.motion.drive_end().expect("the drive ends");
        let mut remaining = self.motion.drive_remaining(start);
        assert!((remaining - whole.abs()).abs() <= 1e-15 * whole.abs(), "{remaining} m or rad of {displacement:?}");
        for part in 1..=5 {
            self.advance_to(Time(start.0 + (end - start).0 * part / 5));
            let to_go = self.motion.drive_remaining(self.at);
            assert!((0.0..=remaining).contains(&to_go), "{to_go} after {remaining} of {displacement:?}");
            remaining = to_go;
        }
        assert!(remaining == 0.0 && self.motion.is_drive_done(end) && self.motion.drive_end() == Some(end));
        assert_eq!(self.motion.speed(end), Twist::ZERO, "it stands");
    }

    /// Drives, and checks odometry and true pose against the command.
    fn check(&mut self, displacement: Twist, speed: f64) {
        let before = self.motion.state(self.at);
        self.drive(displacement, speed);
        let after = self.motion.state(self.at);
        assert_close(after.odometry, before.odometry.moved(displacement), displacement);
        assert_close(after.world_from_axle, before.world_from_axle.moved(displacement), displacement);
        let path = after.path_length - before.path_length;
        let rounding = 1e-9 + 1e-12 * after.path_length;
        assert!((path - displacement.speed()).abs() <= rounding, "{path} m of {displacement:?}");
    }
}

fn assert_close(found: Pose, expected: Pose, command: Twist) {
    let angle = found.heading.turned(-expected.heading.remainder()).remainder();
    assert!(
        (found.position - expected.position).length() < MARK && angle.abs() < MARK,
        "{found:?} instead of {expected:?} after {command:?}"
    );
    // A heading of almost exactly half a turn may be counted as the next turn.
    assert!(
        (found.heading.turns() - expected.heading.turns()).abs() <= i64::from(expected.heading.remainder().abs() > 3.0)
    );
}

fn slot() -> impl Strategy<Value = Time> {
    prop_oneof![Just(1_000_i64), Just(7_919), Just(50_000), Just(1_000_000)].prop_map(Time)
}

/// Lengths and angles of all sizes and both signs.
fn length() -> impl Strategy<Value = f64> {
    let sizes = prop_oneof![4 => 0.001..2.0_f64, 1 => 1e-9..1e-3_f64, 1 => 2.0..500.0_f64, 1 => Just(40.0)];
    (sizes, any::<bool>()).prop_map(|(size, is_back)| if is_back { -size } else { size })
}

fn angle() -> impl Strategy<Value = f64> {
    let sizes = prop_oneof![
        4 => 0.01..TAU,
        1 => 1e-12..1e-2_f64,
        1 => TAU..1e3,
        1 => Just(PI),
        1 => Just(PI / 2.0),
        1 => Just(20.0 * PI),
    ];
    (sizes, any::<bool>()).prop_map(|(size, is_right)| if is_right { -size } else { size })
}

fn displacement() -> impl Strategy<Value = Twist> {
    let coordinate = || prop_oneof![3 => -2.0..2.0_f64, 1 => -60.0..60.0_f64, 1 => Just(0.0)];
    prop_oneof![
        length().prop_map(|length| Twist::new(length, 0.0)),
        angle().prop_map(|angle| Twist::new(0.0, angle)),
        (length(), angle()).prop_map(|(length, angle)| Twist::new(length, angle)),
        (coordinate(), coordinate()).prop_map(|(x, y)| arc_to(DVec2::new(x, y))),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn drives_end_at_their_targets(
        drives in prop::collection::vec((displacement(), 0.01..2.0_f64, 0_i64..300_000), 1..6),
        slot in slot(),
        heading in -PI..PI,
    ) {
        let mut rig = Rig::new(racer(), slot, Pose::new(3.0, -2.0, heading));
        for (displacement, speed, pause) in drives {
            rig.check(displacement, speed);
            rig.advance_to(rig.at + Time(pause));
        }
    }

    #[test]
    fn wheel_lag_does_not_move_the_target(
        displacement in displacement(),
        speed in 0.1..2.0_f64,
        lag in 0.005..0.3_f64,
        slot in slot(),
    ) {
        let mut rig = Rig::new(Model { wheel_lag: lag, ..racer() }, slot, Pose::new(1.0, 1.0, 0.4));
        rig.check(displacement, speed);
    }

    #[test]
    fn vw_drive_ends_at_its_point(x in -40.0..40.0_f64, y in -40.0..40.0_f64, slot in slot(), speed in 0.05..0.5_f64) {
        let start = Pose::new(1.0, 2.0, 0.7);
        let mut rig = Rig::new(Model { axis_offset: 0.0, ..racer() }, slot, start);
        let displacement = arc_to(DVec2::new(x, y));
        rig.drive(displacement, speed);
        let (odometry, truth) = (rig.motion.odometry(rig.at), rig.motion.pose(rig.at));
        prop_assert!((odometry.position - DVec2::new(x, y)).length() < MARK, "{odometry:?}");
        let heading = Heading::new(2.0 * math::atan2(y, x));
        let angle = odometry.heading.turned(-heading.remainder()).remainder();
        prop_assert!(angle.abs() < MARK, "{odometry:?} instead of {heading:?}");
        prop_assert!((truth.position - start.transform_point(DVec2::new(x, y))).length() < MARK, "{truth:?}");
    }

    #[test]
    fn arcs_end_at_their_points_with_constant_curvature(
        x in prop_oneof![-2.0..2.0_f64, -1e4..1e4_f64, Just(0.0), Just(1e-9)],
        y in prop_oneof![-2.0..2.0_f64, -1e4..1e4_f64, Just(0.0), Just(-1e-9), Just(1e-100)],
    ) {
        let point = DVec2::new(x, y);
        let arc = arc_to(point);
        let end = Pose::default().moved(arc);
        prop_assert!((end.position - point).length() <= 4e-15 * point.length(), "{end:?}");
        prop_assert!(arc.omega.abs() <= PI && arc.vx * x >= 0.0);
        if point != DVec2::ZERO {
            let curvature = 2.0 * y / point.length_squared();
            prop_assert!((arc.omega - curvature * arc.vx).abs() <= 1e-14 * arc.omega.abs(), "{arc:?}");
        }
    }

    #[test]
    fn replaced_drive_keeps_the_distance_covered(
        first in displacement(),
        second in displacement(),
        share in 0.0..1.0_f64,
        slot in slot(),
    ) {
        let mut rig = Rig::new(racer(), slot, Pose::default());
        rig.command(Command::Drive { displacement: first, duration: 0.0 });
        let (start, end) = (rig.at, rig.motion.drive_end().expect("the drive ends"));
        rig.advance_to(Time(start.0 + ((end - start).0 as f64 * share) as i64));
        rig.check(second, 0.4);
    }
}

#[test]
fn textbook_commands_end_at_their_targets() {
    // VWStraight(500, 200), VWTurn(90, 60), VWCurve(-300, 90, 100), VWDrive(400, -300, 150).
    let commands = [
        (Twist::new(0.5, 0.0), 0.2),
        (Twist::new(0.0, PI / 2.0), PI / 3.0),
        (Twist::new(-0.3, PI / 2.0), 0.1),
        (arc_to(DVec2::new(0.4, -0.3)), 0.15),
    ];
    for slot in [1_000, 20_000, 50_000, 333_333] {
        let mut rig = Rig::new(model(), Time(slot), Pose::new(1.0, 1.0, 0.0));
        for (displacement, speed) in commands {
            rig.check(displacement, speed);
        }
    }
}

#[test]
fn drive_with_lag_and_controllers_ends_at_its_target() {
    let gains = Gains { vv: 7.0, tv: 0.3, vw: 10.0, tw: 0.1 };
    for displacement in [Twist::new(0.5, 0.0), Twist::new(0.0, -2.0), Twist::new(-4.0, 0.0)] {
        let mut rig = Rig::new(Model { wheel_lag: 0.1, ..model() }, Time(50_000), Pose::default());
        rig.motion.start_control(Time::ZERO, gains).expect("valid gains");
        rig.check(displacement, 0.3);
    }
}

#[test]
fn command_to_one_motor_keeps_the_other_rates() {
    let mut rig = Rig::new(Model { max_speed: 9.0, ..model() }, Time(50_000), Pose::default());
    let rates = |motion: &mut Motion, at: Time| {
        let (before, after) = (motion.wheel_angles(at), motion.wheel_angles(at + Time(1_000_000)));
        [0, 1].map(|wheel: usize| ((after[wheel] - before[wheel]) * 1e9).round() / 1e9)
    };
    rig.command(Command::Twist(Twist::new(0.11, 0.0)));
    assert_eq!(rates(&mut rig.motion, rig.at), [4.0, 4.0]);
    rig.command(Command::Wheel { wheel: 0, rate: -2.5 });
    assert_eq!(rates(&mut rig.motion, rig.at), [-2.5, 4.0]);
    rig.command(Command::WheelSpeed { wheel: 1, rate: 7.0 });
    assert_eq!(rates(&mut rig.motion, rig.at), [-2.5, 7.0]);
    rig.command(Command::Wheel { wheel: 1, rate: 1e9 });
    assert_eq!(rates(&mut rig.motion, rig.at), [-2.5, 60.0], "within the limit of the wheels");
    rig.command(Command::Halt);
    rig.command(Command::Wheel { wheel: 1, rate: 1.0 });
    assert_eq!(rates(&mut rig.motion, rig.at), [0.0, 1.0]);
    // A command to one motor replaces a drive.
    rig.command(Command::Drive { displacement: Twist::new(1.1, 0.0), duration: 4.0 });
    rig.command(Command::Wheel { wheel: 0, rate: 0.0 });
    assert_eq!(rates(&mut rig.motion, rig.at), [0.0, 10.0]);
    assert!(rig.motion.is_drive_done(rig.at));

    for (command, error) in [
        (Command::Wheel { wheel: 2, rate: 1.0 }, CommandError::NoWheel { wheels: 2 }),
        (Command::WheelSpeed { wheel: 9, rate: 1.0 }, CommandError::NoWheel { wheels: 2 }),
        (Command::Wheel { wheel: 0, rate: f64::NAN }, CommandError::NotFinite),
        (Command::WheelSpeed { wheel: 0, rate: f64::INFINITY }, CommandError::NotFinite),
    ] {
        assert_eq!(rig.motion.command(rig.at, command, &[]), Err(error));
    }
    let pid = Pid { p: 1.0, i: 1.0, d: 0.0 };
    assert_eq!(rig.motion.start_wheel_control(rig.at, 2, pid), Err(CommandError::NoWheel { wheels: 2 }));
    assert_eq!(rig.motion.stop_wheel_control(rig.at, 2), Err(CommandError::NoWheel { wheels: 2 }));
    for bad in [f64::NAN, -1.0, f64::INFINITY, 1e13] {
        let pid = Pid { i: bad, ..pid };
        assert_eq!(rig.motion.start_wheel_control(rig.at, 0, pid), Err(CommandError::Controller));
    }
}

/// Rates of the wheels in each tick for `ticks` ticks after the command.
fn wheel_rates(motion: &mut Motion, ticks: i64) -> Vec<Wheels> {
    let mut rates = Vec::new();
    for tick in 1..=ticks {
        let (before, after) =
            (motion.wheel_angles(Time(tick * TICK.0)), motion.wheel_angles(Time((tick + 1) * TICK.0)));
        rates.push(std::array::from_fn(|wheel| (after[wheel] - before[wheel]) / TICK.seconds()));
    }
    rates
}

#[test]
fn wheel_with_controller_reaches_its_rate_and_wheel_without_follows_its_lag() {
    let lame = Model { wheel_lag: 0.1, ..model() };
    let pid = Pid { p: 4.0, i: 40.0, d: 0.02 };
    let mut rig = Rig::new(lame, Time(50_000), Pose::default());
    rig.motion.start_wheel_control(Time::ZERO, 0, pid).expect("valid");
    rig.at = Time(3_000);
    rig.command(Command::WheelSpeed { wheel: 0, rate: 20.0 });
    rig.command(Command::WheelSpeed { wheel: 1, rate: 20.0 });
    let rates = wheel_rates(&mut rig.motion, 400);
    // The difference equation, written out for the first ticks.
    let gain = 1.0 - math::exp(-0.1);
    let (mut rate, mut last, mut sum) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (tick, found) in rates.iter().take(8).enumerate() {
        let error = 20.0 - rate;
        let grown = sum + 0.01 * error;
        let out = 4.0 * error + 40.0 * grown - 0.02 * (rate - last) / 0.01;
        if out <= 60.0 {
            sum = grown;
        }
        last = rate;
        rate += gain * (out.min(60.0) - rate);
        assert!((found[0] - rate).abs() < 1e-9, "tick {tick}: {} instead of {rate}", found[0]);
        let open = 20.0 * (1.0 - math::exp(-0.1 * (tick as f64 + 1.0)));
        assert!((found[1] - open).abs() < 1e-9, "tick {tick}: {}", found[1]);
    }
    let within = |wheel: usize| rates.iter().rposition(|rates| (rates[wheel] - 20.0).abs() > 0.2).unwrap() + 1;
    assert!(within(0) * 2 < within(1), "controlled {} ticks, open loop {} ticks to 1 %", within(0), within(1));
    assert!((rates[399][0] - 20.0).abs() < 1e-9, "{:?}", rates[399]);
    // Settled: there are no further pieces, and the encoder counts at exactly this rate.
    let at = Time(6_000_000);
    assert!((rig.motion.wheel_angles(at + Time(1_000_000))[0] - rig.motion.wheel_angles(at)[0] - 20.0).abs() < 1e-12);
}

#[test]
fn proportional_controller_has_steady_state_error_and_no_windup() {
    let lame = Model { wheel_lag: 0.1, ..model() };
    let mut rig = Rig::new(lame.clone(), Time(50_000), Pose::default());
    rig.motion.start_wheel_control(Time::ZERO, 0, Pid { p: 3.0, i: 0.0, d: 0.0 }).expect("valid");
    rig.at = Time::ZERO;
    rig.command(Command::WheelSpeed { wheel: 0, rate: 12.0 });
    let rates = wheel_rates(&mut rig.motion, 300);
    assert!((rates[299][0] - 12.0 * 3.0 / 4.0).abs() < 1e-9, "{:?}", rates[299]);
    // Open-loop commands (MOTORDrive) bypass the controller.
    let mut rig = Rig::new(lame, Time(50_000), Pose::default());
    rig.motion.start_wheel_control(Time::ZERO, 0, Pid { p: 3.0, i: 20.0, d: 0.0 }).expect("valid");
    rig.at = Time::ZERO;
    rig.command(Command::Wheel { wheel: 0, rate: 12.0 });
    let rates = wheel_rates(&mut rig.motion, 20);
    assert!((rates[9][0] - 12.0 * (1.0 - math::exp(-1.1))).abs() < 1e-9, "{:?}", rates[9]);
    // Two seconds at the limit, then a low set point: there is no integrator windup.
    rig.advance_to(Time(1_000_000));
    rig.command(Command::WheelSpeed { wheel: 0, rate: 60.0 });
    rig.advance_to(Time(3_000_000));
    rig.command(Command::WheelSpeed { wheel: 0, rate: 6.0 });
    let at = Time(3_500_000);
    let rate = (rig.motion.wheel_angles(at + TICK)[0] - rig.motion.wheel_angles(at)[0]) / 0.01;
    assert!((rate - 6.0).abs() < 1.0, "{rate} rad/s half a second after the command");
    // With the controller stopped, the wheel follows open-loop commands at once.
    rig.at = Time(6_000_000);
    rig.motion.stop_wheel_control(rig.at, 0).expect("valid");
    rig.command(Command::WheelSpeed { wheel: 0, rate: 0.0 });
    let rates = |motion: &mut Motion, at: Time| (motion.wheel_angles(at + TICK)[0] - motion.wheel_angles(at)[0]) / 0.01;
    let (first, tenth) = (rates(&mut rig.motion, Time(6_000_000)), rates(&mut rig.motion, Time(6_090_000)));
    assert!((tenth / first - math::exp(-0.9)).abs() < 1e-9, "{first}, {tenth}");
}

#[test]
fn stalled_wheels_are_the_commanded_wheels() {
    use sim_core::scene::Segment;
    let wall = Segment::new(DVec2::new(0.5, -9.0), DVec2::new(0.5, 9.0));
    let walls = Arc::new(Walls::new(vec![wall]));
    let mut motion = Motion::new(RobotId(1), Arc::new(model()), walls, Pose::default());
    let at = Time(9_000_000);
    motion.command(Time::ZERO, Command::Twist(Twist::new(0.3, 0.0)), &[]).expect("valid");
    assert_eq!(motion.stalled_wheels(Time(1)), [false; 4]);
    assert_eq!(motion.stalled_wheels(at), [true, true, false, false]);
    motion.command(at, Command::Wheels([0.0, 5.0, 0.0, 0.0]), &[]).expect("valid");
    assert_eq!(motion.stalled_wheels(at), [false, true, false, false]);
    motion.command(at, Command::Halt, &[]).expect("valid");
    assert_eq!(motion.stalled_wheels(at), [false; 4]);
}
