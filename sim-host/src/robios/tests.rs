//! Results of the RoBIOS functions for a robot in a world, compared with hand-computed values.

use std::sync::Arc;

use robios_sys::robios6::hdt_type::{HDT_MOTOR, HDT_PSD, HDT_SERVO};
use robios_sys::robios6::semantics::*;
use robios_sys::robios6::{
    ANYKEY, FALSE, HDTEntry, KEY2, KEY3, PSD_OUT_OF_RANGE, PositionType, SER9600, SERIAL1, SpeedType,
};
use robios_sys::support::layer::{MAX_LAYERS, ODOMETRY, WORLD};
use robios_sys::{Out, OutBytes, Robios6Call as Call};
use sim_core::RobotId;
use sim_core::build;
use sim_core::device::Devices;
use sim_core::device::key::UserInput;
use sim_core::drive::Motion;
use sim_core::pose::Pose;
use sim_core::simulation;
use sim_core::time::Time;
use sim_format::{read_companion, read_robi, read_world};

use super::caller::Poll;
use super::robot::{Ending, WaitReason};
use super::*;

/// A robot of 200 mm diameter centred on its axle, with wheels of 100 mm diameter, 1,000 encoder counts for each wheel
/// turn, and at most 10 wheel turns a second.
const ROVER: &str = "name Rover
diameter 200
speed 5000
turn 720
psd PSD_FRONT -200 60 0 0 0
psd PSD_LEFT 2 0 50 0 90
psd PSD_BACK 3 -60 0 0 180
wheel 100 3600 1000 100
drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT
";

const COMPANION: &str = r#"
[[bumper]]
name = "BUMP_FRONT"
from_deg = -30
to_deg = 30
[[bumper]]
name = "BUMP_BACK"
from_deg = 150
to_deg = 210
[[infrared]]
name = "IR_FRONT"
x_mm = 100
y_mm = 0
angle_deg = 0
range_mm = 150
[compass]
north_deg = 90
[input]
analog = { 1 = 820 }
latch = { 2 = 5 }
"#;

const CAR: &str = "name Car
diameter 200
wheel 100 3600 1000 100
drive ACKERMANN_DRIVE MOTOR_DRIVE QUAD_DRIVE SERVO_STEER
camera 0 0 0 SERVO1(-90,90) SERVO2(-45,45) 80 60
";

struct Bench {
    robot: Robot,
    world: World,
}

impl Bench {
    /// The robot in the middle of a closed field of 2 m by 1 m, facing along x.
    fn new(robi: &str, companion: &str) -> Self {
        let (field, _) = read_world("field.wld", "0 0 2000 0\n2000 0 2000 1000\n2000 1000 0 1000\n0 1000 0 0\n");
        let (mut spec, _) = read_robi("rover.robi", robi);
        assert!(read_companion("rover.toml", companion, &mut spec).is_empty());
        let walls = build::walls(&field);
        let model = Arc::new(build::model(&spec));
        let mut motion = Motion::new(RobotId(1), model, walls.clone(), Pose::new(1.0, 0.5, 0.0));
        // The whole test is one slot: for a single robot, the results do not depend on the slot length.
        let world = World::new(walls, Time::from_millis(100_000), [&mut motion]);
        let robios = Robios::new(&spec);
        let devices = Devices::new(&spec);
        let mut state = simulation::Robot::new(motion, (Arc::new(spec), devices), Time::ZERO, 0, false);
        state.devices.press(Time(2_500_000), UserInput::Key(1));
        state.devices.press(Time(3_000_000), UserInput::Key(3));
        let robot = Robot::new(state, robios, "test".to_owned());
        Self { robot, world }
    }

    fn rover() -> Self {
        Self::new(ROVER, COMPANION)
    }

    /// Advances to virtual time `ms`.
    fn at_ms(&mut self, ms: i64) -> &mut Self {
        self.robot.now = Time::from_millis(ms);
        self.robot.settle(&self.world);
        self
    }

    /// Opens the rover's driving interface.
    fn open_vw(&mut self) -> i32 {
        let handle = vw::init(&mut self.robot, &self.world, VW_DRIVE, 1);
        assert_eq!(handle, vw::HANDLE);
        handle
    }
}

/// Time and reason of a wait.
fn wait_of<R>(poll: Poll<R>) -> (Time, WaitReason) {
    match poll {
        Poll::Ready(_) => panic!("there is nothing to wait for"),
        Poll::Pending { at, reason } => (at, reason),
    }
}

fn ready<R>(poll: Poll<R>) -> R {
    match poll {
        Poll::Ready(result) => result,
        Poll::Pending { reason, .. } => panic!("{reason}"),
    }
}

#[test]
fn a_handle_that_is_not_open_gives_one_hint_unless_its_init_has_given_the_reason() {
    let mut bench = Bench::rover();
    let Bench { robot, world } = &mut bench;
    assert_eq!(vw::drive_straight(robot, world, 0, 1.0, 0.5), -1);
    assert_eq!(ready(vw::drive_wait(robot, 0)), -1);
    assert_eq!(motor::drive(robot, world, 3, 50), -1);
    assert_eq!(servo::set(robot, world, 1, 128), -1);
    assert_eq!(ir::read(robot, world, 1), -1);
    assert_eq!(
        robot.new_hints,
        [
            "`VWDriveStraight`: handle 0 is not open: pass the one that `VWInit` returns",
            "`MOTORDrive`: handle 3 is not open: pass the one that `MOTORInit` returns",
            "`SERVOSet`: handle 1 is not open: pass the one that `SERVOInit` returns",
            "`IRRead`: handle 1 is not open: pass the one that `IRInit` returns",
        ]
    );
    robot.new_hints.clear();
    assert_eq!(motor::quad_init(robot, MOTOR_LEFT), 0);
    assert_eq!(motor::quad_read(robot, 0), 0);
    assert_eq!(robot.new_hints.len(), 1, "{:?}", robot.new_hints);
}

#[test]
fn a_failure_without_a_reason_does_not_suppress_the_hint_of_a_later_one() {
    let robot = &mut Bench::rover().robot;
    assert_eq!(audio::play_sample_7(robot, None), 1);
    assert_eq!(robot.new_hints.len(), 0);
    for _ in 0..2 {
        assert_eq!(audio::play_sample_7(robot, Some(b"missing.wav")), 1);
        assert_eq!(robot.new_hints.len(), 1, "{:?}", robot.new_hints);
    }
}

#[test]
fn a_heading_that_is_too_large_is_refused() {
    let mut bench = Bench::rover();
    let handle = bench.open_vw();
    let robot = &mut bench.robot;
    for phi in [f32::NAN, f32::INFINITY, 1e30, -1e30] {
        assert_eq!(vw::set_position(robot, handle, 0.0, 0.0, phi), -1, "{phi}");
    }
    assert_eq!(robot.new_hints.len(), 1, "{:?}", robot.new_hints);
    assert_eq!(vw::set_position(robot, handle, 0.0, 0.0, 1e9), 0);
    assert!((vw::odometry(robot).heading.remainder() - 0.577).abs() < 0.001, "1e9 rad is 0.577 rad");
}

#[test]
fn layers_use_the_odometry_frame_that_the_program_has_set() {
    let mut bench = Bench::rover();
    let frame = |bench: &mut Bench| {
        let label = layer::Label { name: Some(b"map"), frame: ODOMETRY };
        assert_eq!(layer::show_points(&mut bench.robot, label, [2, 0], None), 0);
        let Pose { position, heading } = bench.robot.robios.layers["map"].world_from_frame;
        [position.x, position.y, heading.radians()]
    };
    assert_eq!(frame(&mut bench), [1.0, 0.5, 0.0], "the frame at the start");
    let handle = bench.open_vw();
    assert_eq!(vw::set_position(&mut bench.robot, handle, 0.25, 0.0, std::f32::consts::FRAC_PI_2), 0);
    // A quarter turn to the right, about the robot.
    let expected = [1.0, 0.75, -std::f64::consts::FRAC_PI_2];
    let found = frame(&mut bench);
    assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-6), "{found:?}");
    bench.at_ms(100).robot.state.motion.place(Time::from_millis(100), Pose::new(0.3, 0.3, 1.0)).unwrap();
    assert_eq!(frame(&mut bench), found, "an intervention moves the robot, not its odometry");
}

#[test]
fn a_refused_layer_does_not_change_the_others() {
    let mut bench = Bench::rover();
    let mut show = |name: &[u8], frame| {
        let label = layer::Label { name: Some(name), frame };
        let extent = layer::Extent { corner: [0.0; 2], cell: 0.1, size: [1, 1] };
        (layer::show_grid(&mut bench.robot, label, extent, Some(&[7])), bench.robot.robios.layers.len())
    };
    for (name, frame) in [(&b""[..], WORLD), (&[b'a'; 33], WORLD), (b"\xff", WORLD), (b"a", 2), (b"a", -1)] {
        assert_eq!(show(name, frame), (1, 0), "{name:?} {frame}");
    }
    for number in 1..=MAX_LAYERS {
        assert_eq!(show(number.to_string().as_bytes(), WORLD), (0, number));
    }
    assert_eq!(show(b"one more", WORLD), (1, MAX_LAYERS));
    assert_eq!(show(b"3", ODOMETRY), (0, MAX_LAYERS), "replaces the earlier layer");
}

#[test]
fn devices_are_found_by_robi_number_and_by_header_constant() {
    let table = Bench::rover().robot.robios.table;
    let name = |number| table.find(HDT_PSD, number).map(|device| device.name.as_str());
    assert_eq!([name(PSD_FRONT), name(2), name(PSD_LEFT)], [Some("PSD_FRONT"), Some("PSD_LEFT"), Some("PSD_LEFT")]);
    assert_eq!([name(PSD_RIGHT), name(0), name(MOTOR_LEFT)], [None; 3]);
    assert_eq!(table.find(0, QUAD_RIGHT).unwrap().index, 1);

    let mut bench = Bench::new(CAR, "");
    let table = &bench.robot.robios.table;
    let servos: Vec<&str> = table.of_kind(HDT_SERVO).map(|device| device.name.as_str()).collect();
    assert_eq!(servos, ["SERVO_STEER", "SERVO1", "SERVO2"]);
    let mut entry = Out::<HDTEntry>::wanted();
    assert_eq!(hdt::find_entry(&mut bench.robot, 0, SERVO1, &mut entry), 1);
    let found = entry.value().unwrap();
    assert_eq!((found.type_id, found.semantics, &found.name[..7]), (HDT_SERVO, SERVO1, b"SERVO1\0".as_slice()));
    assert_eq!(hdt::find_entry(&mut bench.robot, HDT_PSD, SERVO1, &mut entry), 0);
    assert_eq!([hdt::count(&bench.robot, HDT_SERVO), hdt::count(&bench.robot, 99)], [3, 0]);
    assert_eq!(hdt::find_nth(&mut bench.robot, HDT_SERVO, 2, &mut entry), 0);
    assert_eq!(hdt::find_nth(&mut bench.robot, HDT_SERVO, 3, &mut entry), -1);
    assert_eq!(hdt::find_nth(&mut bench.robot, HDT_SERVO, i32::MIN, &mut entry), -1);
    assert_eq!(hdt::find_nth(&mut bench.robot, HDT_SERVO, 0, &mut Out::null()), -1);
}

#[test]
fn a_psd_reading_is_taken_at_the_end_of_its_cycle() {
    let mut bench = Bench::rover();
    let robot = &mut bench.robot;
    let (front, left) = (psd::init(robot, PSD_FRONT), psd::init(robot, PSD_LEFT));
    assert_eq!([front, left, psd::init(robot, PSD_FRONT), psd::init(robot, PSD_RIGHT)], [1, 2, 1, 0]);
    assert_eq!(psd::get(robot, &bench.world, front), PSD_OUT_OF_RANGE, "nothing measured yet");
    assert_eq!(psd::get(robot, &bench.world, 0), 0);
    assert_eq!([psd::start(robot, 8, true), psd::start(robot, front | left, true)], [-1, 0]);
    assert_eq!([psd::start(robot, front, true), psd::check(robot)], [1, 0]);
    let vw = bench.open_vw();
    // Towards the wall at x = 2 m. The sensor at x = 1.06 m is 0.94 m from it, beyond its range of 0.8 m. After 1.98 s,
    // the end of cycle 33, it is 0.1 m/s * 1.98 s nearer.
    assert_eq!(vw::drive_straight(&mut bench.robot, &bench.world, vw, 0.5, 0.1), 0);
    bench.at_ms(60);
    assert_eq!([psd::check(&mut bench.robot), psd::get(&mut bench.robot, &bench.world, front)], [1, PSD_OUT_OF_RANGE]);
    bench.at_ms(2_039);
    assert_eq!(psd::get(&mut bench.robot, &bench.world, front), 742);
    assert_eq!(psd::get(&mut bench.robot, &bench.world, left), 450);
    assert_eq!(psd::get(&mut bench.robot, &bench.world, 0), 198);
    assert_eq!(psd::get_raw(&mut bench.robot, &bench.world, front), 27, "20400 / 742");
    bench.at_ms(2_040);
    assert_eq!(psd::get(&mut bench.robot, &bench.world, front), 736);
    assert_eq!(psd::get(&mut bench.robot, &bench.world, front | left), PSD_OUT_OF_RANGE, "two at once");
    psd::release(&mut bench.robot);
    assert_eq!(psd::get(&mut bench.robot, &bench.world, front), PSD_OUT_OF_RANGE);
    let wrong = [front, 0, 8].map(|handle| psd::start(&mut bench.robot, handle, true));
    assert_eq!(wrong, [-1; 3], "no handle is open any more");
}

#[test]
fn drives_end_at_the_commanded_place_and_time() {
    let mut bench = Bench::rover();
    let handle = bench.open_vw();
    let Bench { robot, world } = &mut bench;
    assert_eq!(vw::drive_done(robot, handle), 1, "no drive was commanded");
    assert_eq!(vw::drive_straight(robot, world, handle, -0.25, 0.125), 0);
    assert_eq!(vw::drive_done(robot, handle), 0);
    assert_eq!(wait_of(vw::drive_wait(robot, handle)), (Time(2_000_000), WaitReason::Drive));
    bench.at_ms(500);
    assert_eq!(vw::drive_remain(&mut bench.robot, handle), 0.1875);
    let mut speed = Out::<SpeedType>::wanted();
    vw::speed(&mut bench.robot, handle, &mut speed);
    assert_eq!(speed.value(), Some(&SpeedType { v: -0.125, w: 0.0 }));
    bench.at_ms(2_000);
    assert_eq!(ready(vw::drive_wait(&mut bench.robot, handle)), 0);
    let mut position = Out::<PositionType>::wanted();
    assert_eq!(vw::position(&mut bench.robot, handle, &mut position), 0);
    assert_eq!(position.value(), Some(&PositionType { x: -0.25, y: 0.0, phi: 0.0 }));
    // A turn (the sign of its rate is ignored) and a curve of 1 rad.
    let Bench { robot, world } = &mut bench;
    assert_eq!(vw::drive_turn(robot, world, handle, 0.5, -0.25), 0);
    assert_eq!(wait_of(vw::drive_wait(robot, handle)).0, Time(4_000_000));
    assert_eq!(vw::drive_remain(robot, handle), 0.5);
    assert_eq!(vw::drive_curve(robot, world, handle, [0.25, 1.0, 0.125]), 0, "replaces the turn at once");
    bench.at_ms(4_000);
    assert_eq!(vw::drive_done(&mut bench.robot, handle), 1);
    assert!((bench.robot.motion.pose(Time(4_000_000)).heading.radians() - 1.0).abs() < 1e-12);
}

#[test]
fn a_drive_against_a_wall_stalls_and_never_ends() {
    let mut bench = Bench::rover();
    let handle = bench.open_vw();
    let front = bump::init(&mut bench.robot, BUMP_FRONT);
    let back = bump::init(&mut bench.robot, BUMP_BACK);
    let Bench { robot, world } = &mut bench;
    // The body of 0.1 m radius meets the wall after 0.9 m, at 1.8 s.
    vw::drive_straight(robot, world, handle, 2.0, 0.5);
    assert_eq!(wait_of(vw::drive_wait(robot, handle)), (Time::NEVER, WaitReason::Drive));
    bench.at_ms(1_799);
    assert_eq!(vw::stalled(&mut bench.robot, handle), 0);
    let mut stamp = Out::wanted();
    assert_eq!(bump::check(&mut bench.robot, front, &mut stamp), -1);
    bench.at_ms(5_000);
    assert_eq!([vw::stalled(&mut bench.robot, handle), vw::drive_done(&mut bench.robot, handle)], [1, 0]);
    assert!((vw::drive_remain(&mut bench.robot, handle) - 1.1).abs() < 1e-5, "skin and single precision");
    assert_eq!(bump::check(&mut bench.robot, back, &mut stamp), -1);
    assert_eq!((bump::check(&mut bench.robot, front, &mut stamp), stamp.value()), (0, Some(&179)));
    assert_eq!(bump::check(&mut bench.robot, front, &mut Out::null()), -1, "reported once");
    assert_eq!([bump::check(&mut bench.robot, 4, &mut stamp), bump::init(&mut bench.robot, BUMP_LEFT)], [-1, 0]);
}

#[test]
fn wrong_arguments_of_the_driving_interface_are_refused() {
    let mut bench = Bench::rover();
    let Bench { robot, world } = &mut bench;
    assert_eq!(vw::init(robot, world, PSD_FRONT, 1), 0);
    assert_eq!(vw::init(robot, world, VW_DRIVE, 0), 0);
    assert_eq!(vw::set_speed(robot, world, vw::HANDLE, 0.1, 0.0), -1, "not open");
    let handle = vw::init(robot, world, VW_DRIVE, 1);
    assert_eq!(vw::init(robot, world, VW_DRIVE, 1), 0, "only one");
    for wrong in [0, 1, -1, i32::MIN, i32::MAX] {
        assert_eq!(vw::set_speed(robot, world, wrong, 0.1, 0.0), -1);
        assert_eq!(vw::speed(robot, wrong, &mut Out::wanted()), -1);
        assert_eq!(vw::position(robot, wrong, &mut Out::wanted()), -1);
        assert_eq!(vw::set_position(robot, wrong, 0.0, 0.0, 0.0), -1);
        assert_eq!(vw::start_control(robot, wrong, [7.0, 0.3, 10.0, 0.1]), -1);
        assert_eq!(vw::stop_control(robot, wrong), -1);
        assert_eq!(vw::drive_straight(robot, world, wrong, 1.0, 1.0), -1);
        assert_eq!(vw::drive_turn(robot, world, wrong, 1.0, 1.0), -1);
        assert_eq!(vw::drive_curve(robot, world, wrong, [1.0; 3]), -1);
        assert_eq!(vw::drive_remain(robot, wrong), 0.0);
        assert_eq!(
            [vw::drive_done(robot, wrong), vw::stalled(robot, wrong), vw::release(robot, world, wrong)],
            [-1; 3]
        );
        assert_eq!(ready(vw::drive_wait(robot, wrong)), -1);
    }
    assert_eq!([vw::speed(robot, handle, &mut Out::null()), vw::position(robot, handle, &mut Out::null())], [-1; 2]);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(vw::set_speed(robot, world, handle, bad, 0.0), -1);
        assert_eq!(vw::set_speed(robot, world, handle, 0.0, bad), -1);
        assert_eq!(vw::set_position(robot, handle, 0.0, 0.0, bad), -1);
        assert_eq!(vw::set_position(robot, handle, bad, 0.0, 0.0), -1);
        assert_eq!(vw::drive_straight(robot, world, handle, bad, 0.1), -1);
        assert_eq!(vw::drive_turn(robot, world, handle, bad, 0.1), -1);
        assert_eq!(vw::drive_curve(robot, world, handle, [0.1, bad, 0.1]), -1);
        assert_eq!(vw::start_control(robot, handle, [bad, 0.3, 10.0, 0.1]), -1);
    }
    assert_eq!(vw::drive_straight(robot, world, handle, 1.0, 0.0), -1);
    assert_eq!(vw::drive_straight(robot, world, handle, 1.0, f32::NAN), -1);
    assert_eq!(vw::drive_curve(robot, world, handle, [0.0, 1.0, 0.1]), -1);
    assert_eq!(vw::drive_straight(robot, world, handle, 0.0, 0.1), 0);
    assert_eq!(vw::drive_done(robot, handle), 1);
    assert_eq!([vw::release(robot, world, handle), vw::release(robot, world, handle)], [0, -1]);
}

#[test]
fn motors_turn_wheels_and_encoders_count_them() {
    let mut bench = Bench::rover();
    let Bench { robot, world } = &mut bench;
    let (left, right) = (motor::init(robot, MOTOR_LEFT), motor::init(robot, MOTOR_RIGHT));
    let (left_quad, right_quad) = (motor::quad_init(robot, QUAD_LEFT), motor::quad_init(robot, QUAD_RIGHT));
    assert_eq!([left, right, left_quad, right_quad, motor::init(robot, MOTOR_FL)], [1, 2, 1, 2, 0]);
    assert_eq!(motor::quad_motor(robot, QUAD_RIGHT), MOTOR_RIGHT);
    assert_eq!(motor::quad_motor(robot, PSD_FRONT), 0);
    assert_eq!(vw::init(robot, world, VW_DRIVE, 1), 0, "the motors are taken");
    assert_eq!([motor::drive(robot, world, 4, 50), motor::drive(robot, world, 0, 50)], [-1, -1]);
    // 10 % of 10 turns a second is one turn a second: forwards on the left, backwards on the right.
    assert_eq!(motor::drive(robot, world, left, 10), 0);
    assert_eq!(motor::drive(robot, world, right, -10), 0);
    bench.at_ms(1_500);
    let Bench { robot, world } = &mut bench;
    assert_eq!([motor::quad_read(robot, left_quad), motor::quad_read(robot, right_quad)], [1_500, -1_500]);
    assert_eq!([motor::quad_read(robot, 3), motor::quad_read(robot, 4)], [0, 0]);
    assert!((motor::odometer_read(robot, left_quad) - 1.5 * std::f32::consts::PI * 0.1).abs() < 1e-6);
    assert_eq!([motor::quad_reset(robot, left_quad), motor::quad_reset(robot, 4)], [0, -1]);
    assert_eq!(motor::odometer_reset(robot, right_quad), 0);
    assert_eq!(motor::drive(robot, world, left | right, 1_000), 0, "limited to 100");
    bench.at_ms(1_600);
    let Bench { robot, world } = &mut bench;
    assert_eq!([motor::quad_read(robot, left_quad), motor::quad_read(robot, right_quad)], [1_000, -500]);
    assert!((motor::odometer_read(robot, right_quad) - std::f32::consts::PI * 0.1).abs() < 1e-6);
    assert_eq!([motor::release(robot, world, 8), motor::release(robot, world, 9)], [handle::WRONG_HANDLE, 8]);
    assert_eq!(motor::release(robot, world, left | right), 0);
    assert!(!robot.state.motion.is_moving(robot.state.now), "released motors stop");
    let vw = vw::init(robot, world, VW_DRIVE, 1);
    assert_eq!((vw, motor::init(robot, MOTOR_LEFT)), (vw::HANDLE, 0));
    vw::release(robot, world, vw);
    assert_eq!(motor::init(robot, MOTOR_LEFT), 1);
    assert_eq!([motor::quad_release(robot, left_quad), motor::quad_release(robot, left_quad)], [0, -1]);
}

#[test]
fn a_car_steers_and_cannot_turn_on_the_spot() {
    let mut bench = Bench::new(CAR, "");
    let Bench { robot, world } = &mut bench;
    let (motor, servo) = (motor::init(robot, MOTOR_DRIVE), servo::init(robot, SERVO_STEER));
    assert_eq!(servo::set(robot, world, servo, 0), 0);
    motor::drive(robot, world, motor, 5);
    let steering = robot.state.motion.steering(robot.state.now);
    assert!((steering - std::f64::consts::FRAC_PI_4).abs() < 1e-12, "45 degrees to the left: {steering}");
    assert!(robot.state.motion.speed(robot.state.now).omega > 0.0);
    for straight in [127, 128] {
        servo::set(robot, world, servo, straight);
        assert_eq!(robot.state.motion.steering(robot.state.now), 0.0);
    }
    assert_eq!([servo::set(robot, world, servo, 256), servo::set(robot, world, servo, -1)], [-1, -1]);
    assert_eq!([servo::set(robot, world, 2, 0), servo::init(robot, SERVO9)], [-1, 0]);
    let camera = servo::init(robot, SERVO2);
    assert_eq!((servo::set(robot, world, camera, 200), robot.devices.servos.position(2)), (0, 200));
    assert_eq!(servo::release(robot, servo | camera), 0);
    motor::release(robot, world, motor);
    let vw = bench.open_vw();
    let Bench { robot, world } = &mut bench;
    assert_eq!(vw::drive_turn(robot, world, vw, 1.0, 1.0), -1);
    assert_eq!(vw::set_speed(robot, world, vw, 0.0, 1.0), -1);
    assert_eq!(vw::drive_straight(robot, world, vw, 0.1, 0.1), 0);
}

#[test]
fn infrared_sensor_compass_and_inputs() {
    let mut bench = Bench::rover();
    let infrared = ir::init(&mut bench.robot, IR_FRONT);
    assert_eq!(ir::read(&mut bench.robot, &bench.world, infrared), 0);
    assert_eq!(ir::read(&mut bench.robot, &bench.world, 2), -1);
    assert_eq!([compass::start(&mut bench.robot, true), compass::get(&mut bench.robot)], [1, -1]);
    assert_eq!([compass::init(&mut bench.robot, IR_FRONT), compass::init(&mut bench.robot, COMPASS)], [1, 0]);
    assert_eq!([compass::start(&mut bench.robot, true), compass::check(&mut bench.robot)], [0, 0]);
    let vw = bench.open_vw();
    // The sensor is 0.1 m ahead of the robot's centre, and its range is 0.15 m. After 0.7 m it is 0.2 m from the wall,
    // after 0.8 m 0.1 m.
    vw::drive_straight(&mut bench.robot, &bench.world, vw, 0.7, 7.0);
    bench.at_ms(300);
    assert_eq!(ir::read(&mut bench.robot, &bench.world, infrared), 0);
    assert_eq!([compass::check(&mut bench.robot), compass::get(&mut bench.robot)], [1, 90], "along x is east");
    vw::drive_straight(&mut bench.robot, &bench.world, vw, 0.1, 7.0);
    bench.at_ms(400);
    assert_eq!(ir::read(&mut bench.robot, &bench.world, infrared), 1);
    let robot = &mut bench.robot;
    assert_eq!(
        [latch::read_analog(robot, 1), latch::read_analog(robot, 2), latch::read_analog(robot, 16)],
        [820, 0, -1]
    );
    assert_eq!([latch::read_input(robot, 2), latch::read_input(robot, 9)], [5, 0]);
    assert_eq!([latch::write_output(robot, 1, 0, 9), latch::write_output(robot, 1, 1, 4)], [0, 9]);
    assert_eq!(robot.robios.latches.output(1), 5);
    assert_eq!(latch::read_parallel(robot), 0);
    latch::write_parallel(robot, 7);
    assert_eq!(latch::read_parallel(robot), 7);
}

#[test]
fn waits_for_keys_end_at_the_press() {
    let mut bench = Bench::rover();
    assert_eq!(key::read(&mut bench.robot), 0);
    let any_key = WaitReason::Key("any key".to_owned());
    assert_eq!(wait_of(key::wait_for(&mut bench.robot, ANYKEY)), (Time(2_500_000), any_key));
    assert_eq!(wait_of(key::wait(&mut bench.robot, KEY3)).0, Time(3_000_000));
    assert_eq!(wait_of(key::wait(&mut bench.robot, 2)), (Time::NEVER, WaitReason::Key("KEY2".to_owned())));
    assert_eq!(ready(key::wait(&mut bench.robot, 0)), -1);
    assert_eq!(ready(key::get_into(&mut bench.robot, &mut Out::null())), -1);
    bench.at_ms(2_500);
    let mut code = Out::wanted();
    assert_eq!((ready(key::get_into(&mut bench.robot, &mut code)), code.value()), (0, Some(&1)));
    bench.at_ms(3_000);
    assert_eq!(ready(key::wait(&mut bench.robot, KEY3)), 0);
    assert_eq!(wait_of(key::wait_for(&mut bench.robot, ANYKEY)).0, Time::NEVER);
}

#[test]
fn waiting_for_one_key_discards_earlier_presses_of_others() {
    let mut bench = Bench::rover();
    bench.robot.devices.press(Time(2_700_000), UserInput::Key(2));
    bench.at_ms(2_600);
    let key2 = (Time(2_700_000), WaitReason::Key("KEY2".to_owned()));
    assert_eq!(wait_of(key::wait(&mut bench.robot, KEY2)), key2, "KEY1 has been pressed before");
    bench.at_ms(2_700);
    assert_eq!(ready(key::wait(&mut bench.robot, KEY2)), 0);
    bench.at_ms(3_000);
    assert_eq!(key::read(&mut bench.robot), KEY3, "KEY1 is discarded");
}

#[test]
fn the_display_takes_text_and_numbers() {
    let mut bench = Bench::rover();
    let robot = &mut bench.robot;
    assert_eq!(display::put(robot, Call::LCDPutString, Some(b"ab\n")), 0);
    assert_eq!(display::put(robot, Call::LCDPutString, None), -1);
    display::put_int(robot, -7, 5);
    display::put_float(robot, 2.5, 8, 2);
    display::put(robot, Call::LCDPutString, Some(b"\n"));
    for (value, spaces, decimals) in [(f32::NAN, 4, 1), (f32::INFINITY, 4, 1), (1.0, i32::MIN, i32::MIN)] {
        assert_eq!(display::put_float(robot, value, spaces, decimals), 0);
    }
    assert_eq!(display::put_at(robot, Call::LCDSetString, [5, 14], Some(b"x")), 0);
    assert_eq!(display::put_at(robot, Call::LCDSetString, [7, 0], Some(b"x")), -1);
    assert_eq!(display::set_menu(robot, [Some(b"A"), None, Some(b""), Some(b"END")]), 0);
    assert_eq!(display::set_menu_entry(robot, 5, Some(b"x")), -1);
    assert_eq!(display::set_menu_entry(robot, 1, None), -1);
    let expected = ["ab", "   -7    2.50", " nan inf1", "", "", "              x", "A           END"];
    assert_eq!(robot.robios.lcd.lines(), expected);
    let (mut row, mut column) = (Out::wanted(), Out::wanted());
    assert_eq!(display::position(robot, &mut row, &mut column), 0);
    assert_eq!((row.value(), column.value()), (Some(&5), Some(&15)));
    assert_eq!(display::position(robot, &mut row, &mut Out::null()), -1);
    assert_eq!(
        [display::put_grey(robot, None), display::put_colour(robot, None), display::put_picture(robot, None)],
        [-1; 3]
    );
    assert_eq!(display::put_float(robot, f32::MAX, i32::MAX, i32::MAX), 0, "fills the display, does no harm");
    assert_eq!(display::clear(robot), 0);
    let mut colour = [[[0; 3]; 82]; 62];
    colour[1][1] = [255; 3];
    display::put_colour(robot, Some(&mut colour));
    assert_eq!([display::pixel(robot, 0, 0), display::pixel(robot, 0, 1), display::pixel(robot, 54, 0)], [0, 1, 0]);
    assert_eq!([display::pixel(robot, 64, 0), display::pixel(robot, 0, -1)], [-1; 2]);
    assert_eq!(colour[1][1], [255; 3]);
}

#[test]
fn machine_name_variables_clock_and_errors() {
    let mut bench = Bench::rover();
    let mut text = OutBytes::with_capacity(3);
    assert_eq!((os::machine_name(&bench.robot, &mut text), text.bytes()), (5, b"Rov".as_slice()));
    assert_eq!(os::machine_id(&bench.robot), 1);
    assert_eq!([os::set_variable(&mut bench.robot, 15, 4), os::set_variable(&mut bench.robot, 16, 4)], [0, -1]);
    assert_eq!([os::variable(&mut bench.robot, 15), os::variable(&mut bench.robot, -1)], [4, 0]);
    bench.at_ms(2_340);
    assert_eq!(os::hundredths(bench.robot.now), 234);
    assert_eq!(os::set_time(&mut bench.robot, [23, 59, 59]), 0);
    assert_eq!(os::set_time(&mut bench.robot, [24, 0, 0]), -1);
    bench.at_ms(3_360);
    let mut out: [Out<i32>; 4] = [Out::wanted(); 4];
    let [h, m, s, ticks] = &mut out;
    os::time(&bench.robot, [h, m, s, ticks]);
    assert_eq!(out.map(|value| *value.value().unwrap()), [0, 0, 0, 2], "past midnight");
    let end = bench.robot.now + os::span_of_hundredths(5);
    assert_eq!(wait_of(os::wait_until(&bench.robot, end)), (end, WaitReason::Time(end)));
    assert_eq!([os::span_of_hundredths(-1), os::span_of_hundredths(i32::MIN)], [Time::ZERO; 2]);
    os::error(&mut bench.robot, Some(b"motor"), 7, true);
    assert_eq!(bench.robot.ending, Some(Ending::Failed { reason: "OSError 7: motor".to_owned() }));
    assert_eq!(bench.robot.robios.lcd.lines()[..2], ["motor", "Error 7"]);
}

#[test]
fn receivers_without_a_sender_wait_for_ever() {
    let mut bench = Bench::rover();
    let robot = &mut bench.robot;
    assert_eq!(ready(serial::receive_6(robot, &mut Out::wanted(), SERIAL1)), -1, "not open");
    assert_eq!(
        [serial::init_6(robot, SER9600, 0, 4), serial::init_6(robot, 1, 0, 1), serial::init_6(robot, SER9600, 0, 1)],
        [-1, -1, 0]
    );
    assert_eq!(wait_of(serial::receive_6(robot, &mut Out::wanted(), SERIAL1)).0, Time::NEVER);
    assert_eq!(ready(serial::receive_6(robot, &mut Out::null(), SERIAL1)), -1);
    assert_eq!(serial::send(robot, Call::OSSendRS232, -1, Some(b"hello"), SERIAL1), 0);
    assert_eq!(serial::send(robot, Call::OSSendRS232, -1, None, SERIAL1), -1);
    assert_eq!(ready(irtv::get(robot)), 0, "off");
    assert_eq!([irtv::init_standard(robot, COMPASS), irtv::init_standard(robot, IRTV)], [-1, 0]);
    assert_eq!(wait_of(irtv::get(robot)).0, Time::NEVER);
    assert_eq!(
        [
            audio::play_tone(robot, Call::AUTone, -1, 64, 100),
            audio::play_tone(robot, Call::AUTone, -1, 440, -1),
            audio::play_tone(robot, Call::AUTone, -1, 440, 100)
        ],
        [-1, -1, 0]
    );
    assert_eq!(i32::from(robot.robios.audio.is_tone_done(robot.now)), FALSE);
    let mut buffer = OutBytes::with_capacity(4);
    assert_eq!((audio::record_6(robot, &mut buffer, 8_000), buffer.bytes()), (8_000, [128; 4].as_slice()));
    assert_eq!(audio::record_6(robot, &mut OutBytes::null(), 8_000), 0);
    assert_eq!(audio::record_7(robot, &mut OutBytes::with_capacity(1 << 25), 8_000), 1, "more than a message has");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("beep.wav");
    let header = b"RIFF\0\0\0\0WAVEfmt \x10\0\0\0\x01\0\x01\0\x40\x1f\0\0\x40\x1f\0\0\x01\0\x08\0data\xa0\x0f\0\0";
    std::fs::write(&path, header).unwrap();
    let name = path.to_str().unwrap().as_bytes();
    assert_eq!([audio::play_sample_6(robot, Some(name)), audio::play_sample_6(robot, Some(b"none"))], [8_000, 0]);
    assert_eq!(robot.robios.table.name(HDT_MOTOR, 7), "");
}

/// Pseudo-random arguments from a linear congruential generator, mostly edge cases.
struct Fuzzer(u64);

impl Fuzzer {
    fn next(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % end
    }

    fn int(&mut self) -> i32 {
        [0, 1, 2, 3, -1, 4, 7, 60, 127, 255, 256, vw::HANDLE, i32::MIN, i32::MAX, PSD_FRONT, MOTOR_LEFT][self.next(16)]
    }

    fn float(&mut self) -> f32 {
        let extremes =
            [0.0, -0.0, 0.1, -0.3, 1.0, 1e-30, f32::MAX, f32::MIN, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        extremes[self.next(extremes.len())]
    }

    fn text(&mut self) -> Option<&'static [u8]> {
        [None, Some(b"".as_slice()), Some(b"abc\n"), Some(&[0xff; 300]), Some(b"\x0c\t\x08\r\x01")][self.next(5)]
    }
}

#[test]
fn no_argument_panics_or_drives_the_robot_through_a_wall() {
    let (mut bench, mut fuzzer) = (Bench::rover(), Fuzzer(1));
    for step in 0..4_000 {
        bench.robot.state.now += Time(fuzzer.next(22_000) as i64);
        bench.robot.settle(&bench.world);
        let Bench { robot, world } = &mut bench;
        let ints: [i32; 7] = std::array::from_fn(|_| fuzzer.int());
        let [a, b, c, d, ..] = ints;
        let floats: [f32; 4] = std::array::from_fn(|_| fuzzer.float());
        let [x, y, z, _] = floats;
        let handle = if step % 3 == 0 { a } else { vw::HANDLE };
        match fuzzer.next(54) {
            0 => _ = vw::init(robot, world, VW_DRIVE, a),
            1 => _ = vw::set_speed(robot, world, handle, x, y),
            2 => _ = vw::set_position(robot, handle, x, y, z),
            3 => _ = vw::start_control(robot, handle, floats),
            4 => _ = vw::drive_straight(robot, world, handle, x, y),
            5 => _ = vw::drive_turn(robot, world, handle, x, y),
            6 => _ = vw::drive_curve(robot, world, handle, [x, y, z]),
            7 => _ = vw::drive_remain(robot, handle),
            8 => _ = vw::drive_wait(robot, handle),
            9 => _ = vw::stalled(robot, handle),
            10 => _ = vw::stop_control(robot, handle),
            11 if step % 20 == 0 => _ = vw::release(robot, world, handle),
            12 => _ = motor::init(robot, a),
            13 => _ = motor::drive(robot, world, a, b),
            14 => _ = motor::release(robot, world, a),
            15 => _ = motor::quad_init(robot, a),
            16 => _ = motor::quad_read(robot, a),
            17 => _ = motor::quad_reset(robot, a),
            18 => _ = motor::odometer_read(robot, a),
            19 => _ = servo::init(robot, a),
            20 => _ = servo::set(robot, world, a, b),
            21 => _ = psd::init(robot, [PSD_FRONT, 2, 3, a][fuzzer.next(4)]),
            22 => _ = psd::start(robot, a, b != 0),
            23 => _ = psd::get(robot, world, a),
            24 => _ = psd::get_raw(robot, world, a),
            25 => _ = psd::stop(robot),
            26 if step % 20 == 0 => _ = psd::release(robot),
            27 => _ = bump::init(robot, [BUMP_FRONT, BUMP_BACK, a][fuzzer.next(3)]),
            28 => _ = bump::check(robot, a, &mut Out::null()),
            29 => _ = ir::init(robot, [IR_FRONT, a][fuzzer.next(2)]),
            30 => _ = ir::read(robot, world, a),
            31 => _ = compass::init(robot, [COMPASS, a][fuzzer.next(2)]),
            32 => _ = compass::start(robot, a != 0),
            33 => _ = compass::get(robot),
            34 => _ = compass::stop(robot),
            35 => _ = display::put_at(robot, Call::LCDSetString, [a, b], fuzzer.text()),
            36 => _ = display::put(robot, Call::LCDPutString, fuzzer.text()),
            37 => _ = display::put_float(robot, x, a, b),
            38 => _ = display::put_int(robot, a, b),
            39 => _ = display::set_menu_entry(robot, a, fuzzer.text()),
            40 => _ = display::draw(robot, Call::LCDLine, d, |lcd, ink| Ok(lcd.draw_line([a, b], [c, d], ink))),
            41 => _ = display::draw(robot, Call::LCDArea, d, |lcd, ink| lcd.draw_area([a, b], [c, d], ink)),
            42 => _ = display::pixel(robot, a, b),
            43 => _ = display::set_mode(robot, a),
            44 => _ = key::wait(robot, a),
            45 => _ = os::set_time(robot, [a, b, c]),
            46 => _ = os::show_time(robot),
            47 => _ = os::set_variable(robot, a, b),
            48 => _ = latch::write_output(robot, a, b as u8, c as u8),
            49 => _ = latch::read_analog(robot, a),
            50 => _ = serial::init_6(robot, a, b, c),
            51 => _ = audio::play_tone(robot, Call::AUTone, -1, a, b),
            52 => _ = audio::play_sample_6(robot, fuzzer.text()),
            _ => _ = hdt::find_nth(robot, a, b, &mut Out::wanted()),
        }
        let pose = robot.state.motion.pose(robot.state.now);
        let margin = 0.1 - 1e-6;
        let is_inside = |coordinate: f64, size: f64| (margin..=size - margin).contains(&coordinate);
        assert!(is_inside(pose.position.x, 2.0) && is_inside(pose.position.y, 1.0), "step {step}: {pose:?}");
    }
}
