//! The simulation as a value: stepped in any interleaving, copied and restored, it gives the same bits.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::{Arc, LazyLock};

use proptest::prelude::*;
use sim_core::build::{NoMeshes, Visuals};
use sim_core::camera::Label;
use sim_core::device::Devices;
use sim_core::device::camera::Setting;
use sim_core::device::range::Scanner;
use sim_core::drive::Command;
use sim_core::pose::Twist;
use sim_core::radio::Address;
use sim_core::record::{Action, Event, KindSet, Record};
use sim_core::simulation::{Options, Refusal, Robot, Simulation};
use sim_core::spec::SceneSpec;
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};
use sim_format::{Code, MemoryFiles, load_scene};

/// Robots of several kinds with noise, a lossy radio, and movable objects.
const SCENE: &str = r#"
[world]
floor_mm = [4000, 3000]
wall = [{ from_mm = [4000, 0], to_mm = [4000, 3000] }, { from_mm = [0, 0], to_mm = [0, 3000] }]

[radio]
medium = "aloha"

[[robot]]
type = "LabBot"
x_mm = 800
y_mm = 800
noise = "harsh"

[[robot]]
type = "S4"
x_mm = 2000
y_mm = 1500
heading_deg = 120
noise = "real"

[[robot]]
type = "Walker"
x_mm = 3200
y_mm = 800
heading_deg = 90
noise = "mild"

[[object]]
type = "Soccer"
x_mm = 1400
y_mm = 800

[[object]]
type = "Can"
x_mm = 2000
y_mm = 2100

[[object]]
type = "Crate"
x_mm = 2600
y_mm = 1500

[[robot_type]]
name = "Walker"
diameter_mm = 400
drive = { kind = "legged" }
leg = [
    { name = "LEFT", y_mm = 150, z_mm = 800, thigh_mm = 440, shank_mm = 440 },
    { name = "RIGHT", y_mm = -150, z_mm = 800, thigh_mm = 440, shank_mm = 440 },
]
"#;

fn scene(text: &str) -> Arc<SceneSpec> {
    let files: MemoryFiles = [("a.scene.toml", text)].into_iter().collect();
    let loaded = load_scene("a.scene.toml", &files);
    assert_eq!(loaded.diagnostics, []);
    Arc::new(loaded.scene)
}

static CROWD: LazyLock<Arc<SceneSpec>> = LazyLock::new(|| scene(SCENE));

/// Camera view of the scene, built once.
static VISUALS: LazyLock<Visuals> = LazyLock::new(|| Visuals::new(&CROWD, &mut NoMeshes));

fn simulation(seed: u64, slot_ms: i64) -> Simulation {
    let options = Options { seed: Some(seed), slot: Some(Time::from_millis(slot_ms)) };
    let mut simulation = Simulation::new(&CROWD, &options).expect("robots that can be simulated");
    simulation.set_visuals(VISUALS.clone());
    let size = Setting { size: [24, 18], ..Setting::default() };
    simulation.with_robot(RobotId(1), |robot, _| robot.devices.camera.switch_on(size));
    simulation
}

/// Actions of a robot in step `step`: drives, reads, sends and receives.
fn act(robot: &mut Robot, world: &World, step: u64) {
    let turn = f64::from((step as u32 * 7 + robot.id.0 * 3) % 11) / 5.0 - 1.0;
    if step.is_multiple_of(5) {
        robot.command(world, Command::Twist(Twist::new(0.3 * (1.0 + turn), turn))).expect("a twist");
    }
    for index in 0..robot.spec.psds.len() {
        let distance_m = robot.read_range(world, index).distance;
        let measured_s = robot.now.seconds();
        robot.record(Event::Distance { device: "PSD", distance_m, measured_s });
    }
    if step.is_multiple_of(7) && robot.camera_setting().is_ok() {
        robot.take_grey(world, VISUALS.scenery()).expect("an image");
    }
    let _ = robot.devices.keys.take_any(robot.now).map(|key| robot.record(Event::Key { key: &key.to_string() }));
    match step % 4 {
        0 if robot.radio_member().is_none() => robot.switch_radio_on(world, robot.id.0, 9_600),
        1 => {
            robot.devices.psds.start(0b111, step.is_multiple_of(8), robot.now);
        }
        2 if robot.radio_member().is_some() => drop(robot.send_message(world, Address::All, &step.to_le_bytes())),
        _ => while robot.receive_message().is_some() {},
    }
}

/// User intervention at the start of step `step`, if that is the start of a slot.
fn intervention(step: u64) -> Option<Action> {
    let [x_m, y_m, phi_rad] = [0.5 + 0.1 * (step % 30) as f64, 0.4 + 0.1 * (step % 20) as f64, step as f64];
    let named = |name: &str| name.to_owned();
    Some(match step % 18 {
        0 => Action::PlaceObject { object: 1 + (step % 3) as u32, x_m, y_m, phi_rad },
        2 => Action::SetNoise { robot: None, parameter: named("psd.sigma_mm"), value: step as f64 },
        4 => Action::SwitchSensor { robot: 1, sensor: named("CAMERA"), on: step.is_multiple_of(4) },
        6 => Action::AddObject { kind: named("Can"), x_m, y_m, phi_rad },
        8 => Action::PlaceRobot { robot: 2, x_m, y_m, phi_rad },
        10 => Action::Press { robot: 1, key: named("KEY2") },
        12 => Action::AddRobot { kind: named("S4"), program_of: None, x_m, y_m, phi_rad },
        14 => Action::RemoveObject { object: 4 },
        16 => Action::RemoveRobot { robot: 4 },
        _ => return None,
    })
}

/// Advances by 30 ms per step, from step `from` to before step `to`.
fn steps(simulation: &mut Simulation, from: u64, to: u64) {
    for step in from..to {
        // Refused interventions (missing robot, no room) are refused in a copy, too.
        let _ = intervention(step).map(|action| simulation.act(&action));
        for id in (0..simulation.robot_count()).map(RobotId::from_index) {
            // A full send buffer is part of the run, too.
            if !simulation.robot(id).is_removed {
                simulation.with_robot(id, |robot, world| act(robot, world, step));
            }
        }
        if step.is_multiple_of(5) {
            simulation.image(RobotId(1)).expect("an image");
        }
        simulation.advance_to(Time::from_millis(30 * (step as i64 + 1)));
    }
}

/// The complete observable state, to the bit.
fn seen(simulation: &Simulation) -> String {
    let robots = (0..simulation.robot_count()).map(|index| {
        let mut robot = simulation.robot(RobotId::from_index(index)).clone();
        let labels = robot.take_labels().map(|labels| labels.pixels().to_vec());
        let depth = robot.take_depth().map(|depth| depth.pixels().to_vec());
        let (now, position) = (robot.now, robot.motion.pose(robot.now));
        format!(
            "{now} {position:?} {labels:?} {depth:?} {:?} {:?}",
            robot.motion.odometry(robot.now),
            robot.radio_waiting()
        )
    });
    let world = simulation.world();
    let objects = (1..=world.object_count() as u32).map(|id| format!("{:?}", world.object_state(ObjectId(id))));
    format!("{} {:?}", simulation.digest(), robots.chain(objects).collect::<Vec<_>>())
}

const STEPS: u64 = 60;

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_copy_continues_like_its_original_and_does_not_affect_it(
        seed in 0_u64..1_000, slot_ms in prop::sample::select(vec![1_i64, 7, 20, 50, 100]), at in 0..STEPS,
    ) {
        let mut alone = simulation(seed, slot_ms);
        steps(&mut alone, 0, STEPS);

        let mut simulation = simulation(seed, slot_ms);
        steps(&mut simulation, 0, at);
        let snapshot = simulation.clone();
        let mut copy = snapshot.clone();
        for step in at..STEPS {
            steps(&mut simulation, step, step + 1);
            steps(&mut copy, step, step + 1);
        }
        prop_assert_eq!(seen(&simulation), seen(&alone));
        prop_assert_eq!(seen(&copy), seen(&alone));
        // Restored after advancing.
        simulation.clone_from(&snapshot);
        steps(&mut simulation, at, STEPS);
        prop_assert_eq!(seen(&simulation), seen(&alone));
    }
}

#[test]
fn another_seed_is_another_run() {
    let [mut one, mut other] = [simulation(1, 50), simulation(2, 50)];
    steps(&mut one, 0, STEPS);
    steps(&mut other, 0, STEPS);
    assert_ne!(one.digest(), other.digest());
}

#[test]
fn a_restarted_simulation_equals_a_new_one() {
    let mut old = simulation(1, 50);
    steps(&mut old, 0, STEPS);
    let mut scene = SceneSpec::clone(&CROWD);
    scene.robots[1].start = scene.robots[0].start.moved(Twist::new(0.5, 0.3));
    let options = Options { seed: Some(2), slot: Some(Time::from_millis(20)) };
    let digest = |made: Result<Simulation, _>| {
        let mut simulation: Simulation = made.expect("robots that can be simulated");
        for step in 0..STEPS {
            (1..=3).for_each(|id| simulation.with_robot(RobotId(id), |robot, world| act_unseen(robot, world, step)));
            simulation.advance_to(simulation.now() + Time::from_millis(37));
        }
        simulation.digest()
    };
    assert_eq!(digest(old.restarted(&scene, &options)), digest(Simulation::new(&scene, &options)));
    assert_ne!(digest(old.restarted(&scene, &options)), digest(old.restarted(&CROWD, &options)));
}

/// Like [`act`], for a robot whose camera is off.
fn act_unseen(robot: &mut Robot, world: &World, step: u64) {
    assert!(robot.camera_setting().is_err());
    act(robot, world, step);
}

#[test]
fn each_of_a_thousand_interleaved_simulations_runs_as_if_alone() {
    const FEW: u64 = 8;
    let alone: Vec<String> = (0..10)
        .map(|seed| {
            let mut simulation = simulation(seed, 50);
            steps(&mut simulation, 0, FEW);
            seen(&simulation)
        })
        .collect();
    std::thread::scope(|scope| {
        for half in 0..2 {
            let alone = &alone;
            scope.spawn(move || {
                let mut many: Vec<_> = (0..500).map(|index| (simulation(index % 10, 50), 0_u64, index % 10)).collect();
                // A linear congruential generator chooses the order of steps.
                let mut state: u64 = half;
                while !many.is_empty() {
                    state = state.wrapping_mul(6_364_136_223_846_793_005_u64).wrapping_add(1_442_695_040_888_963_407);
                    let index = (state >> 33) as usize % many.len();
                    let (simulation, step, _) = &mut many[index];
                    steps(simulation, *step, *step + 1);
                    *step += 1;
                    if *step == FEW {
                        let (simulation, _, seed) = many.swap_remove(index);
                        assert_eq!(seen(&simulation), alone[seed as usize]);
                    }
                }
            });
        }
    });
}

#[test]
fn a_robot_drives_the_distance_of_its_twist() {
    let scene = scene(
        "[world]\nfloor_mm = [9000, 3000]\nwall = [{ from_mm = [9000, 0], to_mm = [9000, 3000] }]\n[[robot]]\ntype = \"S4\"\nx_mm = 1000\ny_mm = 1500\n",
    );
    let mut simulation = Simulation::new(&scene, &Options::default()).expect("a robot");
    let id = RobotId(1);
    simulation.command(id, Command::Twist(Twist::new(0.2, 0.0))).expect("a twist");
    // To the middle of a slot, without skipping any, since the robot moves.
    simulation.advance_to(Time(1_234_567));
    assert_eq!(simulation.now(), Time(1_234_567));
    let mut robot = simulation.robot(id).clone();
    let x = robot.motion.pose(simulation.now()).position.x;
    assert!((x - (1.0 + 0.2 * 1.234_567)).abs() < 1e-12, "{x}");
    // The sensor ahead sees the wall at x = 9 m from its mounting point at the edge.
    let ahead = robot.spec.psds.iter().position(|psd| psd.angle.abs() < 1e-9).expect("a sensor ahead");
    let (reach, sits) = (robot.spec.psds[ahead].range, robot.spec.psds[ahead].position.x);
    let expected = 9.0 - x - sits;
    let read = simulation.range(id, ahead);
    assert!(read.map_or(expected > reach, |read| (read - expected).abs() < 1e-9), "{read:?} {expected} {reach}");
}

#[test]
fn time_in_which_nothing_happens_is_skipped() {
    let scene = scene("[world]\nfloor_mm = [4000, 3000]\n[[robot]]\ntype = \"S4\"\nx_mm = 1000\ny_mm = 1500\n");
    let mut simulation = Simulation::new(&scene, &Options::default()).expect("a robot");
    let mut starts = 0;
    simulation.set_interest(KindSet::ALL);
    let count = |record: &Record<'_>| -> Result<(), String> {
        starts += u32::from(matches!(record.event, Event::ProgramStarted { .. }));
        Ok(())
    };
    // A million seconds in 20 million slots, of which only one is executed.
    simulation.advance_with(Time::from_millis(1_000_000_000), count).expect("no error is shown");
    assert_eq!((simulation.now(), starts), (Time::from_millis(1_000_000_000), 1));
    let mut fresh = Simulation::new(&scene, &Options::default()).expect("a robot");
    fresh.set_interest(KindSet::ALL);
    assert_eq!(fresh.advance_with(Time::from_millis(1_000), |_| Err("full")), Err("full"));
    assert_eq!(fresh.now(), Time::from_millis(50), "it stands at the end of the slot that could not be shown");
    let full = simulation.advance_with(Time::from_millis(1_000_000_100), |_| Err("nothing is recorded"));
    assert_eq!(full, Ok(()));
}

#[test]
fn interventions_are_refused_with_reasons() {
    let mut simulation = simulation(1, 50);
    simulation.advance_to(Time(120_000));
    let end = Action::End {};
    assert_eq!(simulation.act(&end), Err(Refusal::WithinSlot(Time(150_000))));
    simulation.advance_to(Time(150_000));
    let digest = simulation.digest();
    let refused = |action: &Action, simulation: &mut Simulation| simulation.act(action).unwrap_err().to_string();
    let [kind, sensor, key] = ["Tank", "SONAR", "KEY9"].map(str::to_owned);
    let parameter = "psd.sigma".to_owned();
    let s4 = |program_of| Action::AddRobot { kind: "S4".to_owned(), program_of, x_m: 0.8, y_m: 0.8, phi_rad: 0.0 };
    for (action, reason) in [
        (end, "a simulation ends where its owner leaves it"),
        (s4(Some(1)), "a simulation runs no programs"),
        (s4(None), "there is no room for a robot: robot 1 is in its place"),
        (
            Action::AddObject { kind, x_m: 1.0, y_m: 1.0, phi_rad: 0.0 },
            "there is no type of movable objects `Tank`, accepted: ",
        ),
        (Action::SwitchSensor { robot: 2, sensor, on: false }, "robot 2 has no sensor `SONAR`: it has `PSD_FRONT`"),
        (Action::Press { robot: 1, key }, "`KEY9` is not a key"),
        (Action::RemoveRobot { robot: 7 }, "there is no robot 7"),
        (Action::RemoveObject { object: 0 }, "there is no movable object 0"),
        (
            Action::PlaceRobot { robot: 1, x_m: f64::NAN, y_m: 0.0, phi_rad: 0.0 },
            "x NaN m, y 0 m, phi 0 rad is not a valid pose",
        ),
        (Action::SetNoise { robot: None, parameter, value: 1.0 }, "`psd.sigma`"),
    ] {
        let found = refused(&action, &mut simulation);
        assert!(found.contains(reason), "{found}");
    }
    simulation.advance_to(Time(200_000));
    let mut alone = self::simulation(1, 50);
    alone.advance_to(Time(200_000));
    assert_eq!(simulation.digest(), alone.digest(), "nothing has changed since {digest}");
}

#[test]
fn cameras_see_spawned_entities_and_not_removed_ones() {
    let mut simulation = simulation(1, 50);
    simulation.advance_to(Time::from_millis(50));
    let sees = |simulation: &mut Simulation, label: Label| {
        simulation.advance_to(simulation.now() + Time::from_millis(100));
        simulation.image(RobotId(1)).expect("an image");
        simulation.labels(RobotId(1)).expect("labels").pixels().contains(&label)
    };
    let [robot, object] = [Label::Robot(RobotId(4)), Label::Object(ObjectId(4))];
    assert_eq!([sees(&mut simulation, robot), sees(&mut simulation, object)], [false, false]);
    let [s4, can] = ["S4", "Can"].map(str::to_owned);
    let act = |simulation: &mut Simulation, action| simulation.act(&action).expect("it is done");
    act(&mut simulation, Action::AddRobot { kind: s4, program_of: None, x_m: 1.4, y_m: 1.1, phi_rad: 0.0 });
    act(&mut simulation, Action::AddObject { kind: can, x_m: 1.3, y_m: 0.6, phi_rad: 0.0 });
    assert_eq!([sees(&mut simulation, robot), sees(&mut simulation, object)], [true, true]);
    // A simulation that gets its visuals only now shows them, too.
    let mut late = Simulation::new(&CROWD, &Options::default()).expect("robots that can be simulated");
    for (x_m, y_m) in [(1.4, 1.1), (1.3, 0.6)] {
        let [s4, can] = ["S4", "Can"].map(str::to_owned);
        act(&mut late, Action::AddRobot { kind: s4, program_of: None, x_m, y_m, phi_rad: 0.0 });
        act(&mut late, Action::AddObject { kind: can, x_m: 1.4, y_m: 0.5, phi_rad: 0.0 });
    }
    late.set_visuals(VISUALS.clone());
    assert_eq!([sees(&mut late, robot), sees(&mut late, object)], [true, true]);
    act(&mut simulation, Action::RemoveRobot { robot: 4 });
    act(&mut simulation, Action::RemoveObject { object: 4 });
    assert_eq!([sees(&mut simulation, robot), sees(&mut simulation, object)], [false, false]);
}

/// Simulation of a scene with this text, with slots of this length.
fn simulate(text: &str, slot_ms: i64) -> Simulation {
    let options = Options { slot: Some(Time::from_millis(slot_ms)), ..Options::default() };
    Simulation::new(&scene(text), &options).expect("robots that can be simulated")
}

/// A robot in the middle of a floor of 4 x 3 m, with a wall 1.5 m in front of it.
const ALONE: &str = "[world]\nfloor_mm = [4000, 3000]\nwall = [{ from_mm = [3500, 0], to_mm = [3500, 3000] }]\n\
                     [[robot]]\ntype = \"S4\"\nx_mm = 2000\ny_mm = 1500\n";

const ONE: RobotId = RobotId(1);

/// Commands a speed ahead, m/s.
fn drive(simulation: &mut Simulation, speed: f64) {
    simulation.command(ONE, Command::Twist(Twist::new(speed, 0.0))).expect("a twist");
}

/// Texts of the hints until `time`.
fn hints(simulation: &mut Simulation, time: Time) -> Vec<String> {
    let mut hints = Vec::new();
    simulation.set_interest(KindSet::ALL);
    let keep = |record: &Record<'_>| -> Result<(), String> {
        if let Event::Hint { text } = record.event {
            hints.push(text.to_owned());
        }
        Ok(())
    };
    simulation.advance_with(time, keep).expect("no error is shown");
    hints
}

#[test]
fn a_submarine_meets_a_wall_at_every_slot_length() {
    let text = "[world]\nfloor_mm = [20000, 6000]\nwater_mm = 2000\nwall = [{ from_mm = [19000, 0], to_mm = [19000, 6000] }]\n\
                [[robot]]\ntype = \"Mako\"\nx_mm = 1000\ny_mm = 3000\nheading_deg = 5\n";
    let poses = [50, 1_000, 60_000].map(|slot_ms| {
        let mut simulation = simulate(text, slot_ms);
        simulation.with_robot(ONE, |robot, world| robot.set_motors(world, [0, 2], 100));
        simulation.advance_to(Time::from_millis(60_000));
        let robot = &mut simulation.robot(ONE).clone();
        (robot.motion.pose(robot.now), robot.motion.speed(robot.now).vx)
    });
    assert!(poses[0].0.position.x > 18.0 && poses[0].1 < 0.2, "it lies at the wall: {poses:?}");
    assert!(poses.iter().all(|it| (it.0.position - poses[0].0.position).length() < 1e-9), "{poses:?}");
}

#[test]
fn a_submarine_that_a_robot_blocks_can_sink() {
    let text = "[world]\nfloor_mm = [10000, 6000]\nwater_mm = 4000\n[[robot]]\ntype = \"Mako\"\nx_mm = 1000\ny_mm = 3000\n\
                [[robot]]\ntype = \"Mako\"\nx_mm = 4000\ny_mm = 3000\n";
    let [short, long] = [50, 500].map(|slot_ms| {
        let mut simulation = simulate(text, slot_ms);
        simulation.with_robot(ONE, |robot, world| robot.set_motors(world, [0, 2], 100));
        simulation.advance_to(Time::from_millis(12_000));
        simulation.with_robot(ONE, |robot, world| robot.set_motors(world, [1, 3], -50));
        simulation.advance_to(Time::from_millis(14_000));
        let robot = &mut simulation.robot(ONE).clone();
        assert!(robot.motion.is_stalled(robot.now));
        (robot.motion.pose(robot.now).position.x, robot.motion.lift(robot.now), robot.motion.contacts(robot.now))
    });
    assert!(short.1 < 3.5 && short.2 == 1, "{short:?}");
    assert!((short.0 - long.0).abs() < 1e-6 && (short.1 - long.1).abs() < 1e-6 && short.2 == long.2, "{long:?}");
}

#[test]
fn a_robot_that_has_failed_or_was_removed_obeys_no_command() {
    let radio = "[[fault]]\nkind = \"radio_off\"\nat_s = 0.5\nfor_s = 1\n";
    let second = "[[robot]]\ntype = \"S4\"\nx_mm = 1000\ny_mm = 500\n";
    let mut simulation = simulate(&format!("{ALONE}{second}[[fault]]\nkind = \"dies\"\nat_s = 1\n{radio}"), 50);
    for step in 1..20 {
        drive(&mut simulation, 0.1);
        simulation.advance_to(Time::from_millis(100 * step));
    }
    assert!((simulation.pose(ONE).position.x - 2.1).abs() < 1e-9, "{:?}", simulation.pose(ONE));
    for number in 1..=2 {
        simulation.with_robot(RobotId(number), |robot, world| robot.switch_radio_on(world, number, 9_600));
    }
    simulation.advance_to(Time::from_millis(2_000));
    simulation.with_robot(ONE, |robot, world| robot.send_message(world, Address::All, b"a").expect("there is room"));
    simulation.advance_to(Time::from_millis(3_000));
    assert_eq!(simulation.with_robot(RobotId(2), |robot, _| robot.receive_message()), None, "its radio stays silent");
    let mut simulation = simulate(&format!("{ALONE}{second}"), 50);
    simulation.act(&Action::RemoveRobot { robot: 1 }).expect("it is done");
    drive(&mut simulation, 0.1);
    simulation.advance_to(Time::from_millis(1_000));
    assert_eq!(simulation.pose(ONE).position.x, 2.0);
}

#[test]
fn a_removed_robot_stays_where_it_was_and_hears_nothing() {
    let text = "[world]\nfloor_mm = [9000, 4000]\nwater_mm = 1000\n\
                [[robot]]\ntype = \"Mako\"\nx_mm = 1000\ny_mm = 1000\n\
                [[robot]]\ntype = \"Mako\"\nx_mm = 1000\ny_mm = 3000\n";
    let mut simulation = simulate(text, 50);
    for number in 1..=2 {
        simulation.with_robot(RobotId(number), |robot, world| {
            robot.switch_radio_on(world, number, 9_600);
            robot.set_motors(world, [0, 2], 100);
        });
    }
    simulation.advance_to(Time::from_millis(2_000));
    let removed_at = simulation.pose(ONE);
    simulation.act(&Action::RemoveRobot { robot: 1 }).expect("it is done");
    simulation.advance_to(Time::from_millis(2_100));
    simulation.with_robot(RobotId(2), |robot, world| {
        robot.send_message(world, Address::All, b"a").expect("there is room");
    });
    simulation.advance_to(Time::from_millis(4_000));
    assert_eq!(simulation.pose(ONE), removed_at, "a submarine has momentum");
    assert!(simulation.pose(RobotId(2)).position.x > removed_at.position.x + 1.0);
    assert_eq!(simulation.with_robot(ONE, |robot, _| robot.receive_message()), None);
    assert!(simulation.world().radio().members().iter().all(|member| member.robot != ONE));
}

#[test]
fn a_fault_acts_from_the_start_of_its_slot() {
    for (at_ms, at) in [(0, "0"), (1_000, "1.02")] {
        let mut simulation =
            simulate(&format!("{ALONE}[[fault]]\nkind = \"sensor_off\"\nsensor = \"PSD_FRONT\"\nat_s = {at}\n"), 50);
        simulation.advance_to(Time::from_millis(at_ms - 50));
        assert_eq!(simulation.range(ONE, 0).is_some(), at_ms > 0);
        simulation.advance_to(Time::from_millis(at_ms));
        assert_eq!(simulation.range(ONE, 0), None, "{at}");
    }
}

/// The mistake in a scene of a robot of the type `kind` with a slip fault of these `wheels`.
fn slip_mistake(kind: &str, wheels: &str) -> Option<String> {
    let text = format!(
        "[world]\nfloor_mm = [4000, 4000]\nwater_mm = 1000\n\
         [[robot_type]]\nname = \"Car\"\ndrive = {{ kind = \"ackermann\", motor = [{{ name = \"MOTOR\" }}] }}\n\
         [[robot]]\ntype = \"{kind}\"\nx_mm = 1000\ny_mm = 1000\n\
         [[fault]]\nkind = \"slip\"\nslip_percent = 50\nat_s = 1\nwheels = \"{wheels}\"\n"
    );
    let files: MemoryFiles = [("room.scene.toml", &*text)].into_iter().collect();
    let diagnostics = load_scene("room.scene.toml", &files).diagnostics;
    diagnostics.into_iter().find(|diagnostic| diagnostic.code == Code::FaultTarget).map(|diagnostic| diagnostic.message)
}

#[test]
fn only_wheels_that_can_slip_are_accepted() {
    assert_eq!(slip_mistake("S4", "left"), None);
    assert_eq!(slip_mistake("Car", "all"), None);
    let expected = "the wheels of `Car` have one motor: those of one side do not slip alone";
    assert_eq!(slip_mistake("Car", "right").as_deref(), Some(expected));
    let expected = "`Mako` has no wheels with a motor that could slip";
    assert_eq!(slip_mistake("Mako", "all").as_deref(), Some(expected));
}

#[test]
fn a_stuck_sensor_keeps_its_reading_while_it_is_off() {
    let fault = |name: &str, kind: &str, at: u32, lasts: u32| {
        format!(
            "[[fault]]\nname = \"{name}\"\nkind = \"{kind}\"\nsensor = \"PSD_FRONT\"\nat_s = {at}\nfor_s = {lasts}\n"
        )
    };
    let faults = [fault("a", "sensor_stuck", 1, 3), fault("b", "sensor_stuck", 2, 6), fault("c", "sensor_off", 3, 2)];
    let mut simulation = simulate(&format!("{ALONE}{}", faults.concat()), 50);
    drive(&mut simulation, 0.05);
    let readings = [500, 1_000, 2_000, 3_000, 6_000, 8_000].map(|ms| {
        simulation.advance_to(Time::from_millis(ms));
        simulation.range(ONE, 0)
    });
    let [before, stuck, .., after] = readings;
    assert!(before > stuck && stuck > after && after.is_some(), "{readings:?}");
    assert_eq!(readings[1..5], [stuck, stuck, None, stuck]);
}

#[test]
fn a_robot_that_is_placed_outside_has_not_left_the_floor() {
    let mut simulation = simulate(ALONE, 50);
    simulation.advance_to(Time::from_millis(100));
    simulation.act(&Action::PlaceRobot { robot: 1, x_m: 6.0, y_m: 1.0, phi_rad: 0.0 }).expect("it is done");
    drive(&mut simulation, 0.1);
    assert_eq!(hints(&mut simulation, Time::from_millis(1_000)), [""; 0]);
    simulation.act(&Action::PlaceRobot { robot: 1, x_m: 2.0, y_m: 2.9, phi_rad: 1.57 }).expect("it is done");
    drive(&mut simulation, 0.2);
    let hints = hints(&mut simulation, Time::from_millis(3_000));
    assert!(hints.len() == 1 && hints[0].contains("has left the floor"), "{hints:?}");
}

#[test]
fn a_motor_does_not_start_the_others_of_a_placed_robot() {
    let mut simulation = simulate(ALONE, 50);
    let set = |simulation: &mut Simulation, motors: &[usize], percent| {
        simulation.with_robot(ONE, |robot, world| robot.set_motors(world, motors.iter().copied(), percent));
    };
    set(&mut simulation, &[0, 1], 20);
    simulation.advance_to(Time::from_millis(500));
    simulation.act(&Action::PlaceRobot { robot: 1, x_m: 2.0, y_m: 1.0, phi_rad: 0.0 }).expect("it is done");
    let angles = |simulation: &Simulation| simulation.robot(ONE).clone().motion.wheel_angles(simulation.now());
    let before = angles(&simulation);
    assert!(before[0] > 0.0 && before[0] == before[1]);
    set(&mut simulation, &[0], 20);
    simulation.advance_to(Time::from_millis(1_000));
    let after = angles(&simulation);
    assert!((after[0] - 2.0 * before[0]).abs() < 1e-9 && after[1] == before[1], "{before:?} {after:?}");
}

#[test]
fn a_ring_hints_at_messages_that_are_never_sent() {
    let text = format!(
        "{ALONE}[[robot]]\ntype = \"S4\"\nx_mm = 1000\ny_mm = 500\n[radio]\nmedium = \"token_ring\"\nbaud = 115200\n"
    );
    for (wait_ms, count) in [(0, 1), (20, 0)] {
        let mut simulation = simulate(&text, 50);
        for number in 1..=2 {
            simulation.with_robot(RobotId(number), |robot, world| robot.switch_radio_on(world, number, 115_200));
        }
        simulation.advance_to(Time::from_millis(1_000));
        simulation
            .with_robot(ONE, |robot, world| robot.send_message(world, Address::All, b"a").expect("there is room"));
        simulation.advance_to(Time::from_millis(1_000 + wait_ms));
        simulation.with_robot(ONE, |robot, _| {
            let unsent = robot.retire_radio();
            robot.end_radio(unsent);
        });
        let hints = hints(&mut simulation, Time::from_millis(1_200));
        assert_eq!(hints.len(), count, "{hints:?}");
        let heard = simulation.with_robot(RobotId(2), |robot, _| robot.receive_message());
        assert_eq!(heard.is_none(), count == 1);
    }
}

/// Scan of the laser scanner of robot 1, and the function that gives the bearing of a ray.
fn scan(simulation: &mut Simulation) -> (Vec<Option<f64>>, Vec<f64>) {
    simulation.with_robot(ONE, |robot, world| {
        let lidar = robot.spec.lidar.as_ref().expect("a scanner");
        let scanner = Scanner::new(&robot.spec, lidar, [TAU, 0.0], 4);
        let Devices { ranges, servos, .. } = &robot.devices;
        let (_, distances) = ranges.scan(&scanner, servos, &mut robot.motion, world, robot.now);
        let bearings = (0..4).map(|ray| ranges.bearing(&scanner, ray, servos, &mut robot.motion, robot.now)).collect();
        (distances, bearings)
    })
}

#[test]
fn bearings_of_a_scan_are_in_the_frame_of_the_robot() {
    let room = "[world]\nfloor_mm = [9000, 9000]\nwall = [{ from_mm = [0, 3400], to_mm = [6000, 3400] }]\n";
    let robot = "[[robot]]\ntype = \"L\"\nx_mm = 2000\ny_mm = 3000\n";
    for mount in ["yaw_deg = 90", "yaw_deg = 90\non = \"top\"\n[[robot_type.link]]\nname = \"top\""] {
        let kind = format!("[[robot_type]]\nname = \"L\"\n[robot_type.lidar]\n{mount}\n");
        let (distances, bearings) = scan(&mut simulate(&format!("{room}{kind}{robot}"), 50));
        let expected = [-FRAC_PI_2, -PI, FRAC_PI_2, 0.0];
        let is_near = |(found, expected): (&f64, f64)| sim_core::math::cos(found - expected) > 1.0 - 1e-12;
        assert!(bearings.iter().zip(expected).all(is_near), "{mount}: {bearings:?}");
        assert!(distances[2].is_some() && distances[3].is_none(), "{mount}: {distances:?}");
    }
}

#[test]
fn a_scanner_rises_with_its_submarine() {
    let text = "[world]\nfloor_mm = [6000, 6000]\nwater_mm = 2000\nwall = [{ from_mm = [4000, 0], to_mm = [4000, 6000], height_mm = 500 }, \
                { from_mm = [6000, 0], to_mm = [6000, 6000], height_mm = 3000 }]\n\
                [[robot_type]]\nname = \"Sub\"\ndiameter_mm = 600\n[robot_type.drive]\nkind = \"thrusters\"\n\
                [robot_type.body]\nmass_kg = 40\n[[robot_type.collider]]\nkind = \"box\"\nsize_mm = [500, 300, 300]\ncentre_mm = [0, 0, 150]\n\
                [robot_type.wheel]\ntrack_mm = 300\n[robot_type.hull]\nthrust_n = 20\n\
                drag_ahead = [10, 40]\ndrag_aside = [30, 150]\ndrag_turn = [4, 12]\ndrag_up = [30, 150]\n\
                [robot_type.lidar]\nrange_mm = 9000\nz_mm = 150\n[[robot]]\ntype = \"Sub\"\nx_mm = 2000\ny_mm = 3000\n";
    let mut simulation = simulate(text, 50);
    let ahead = scan(&mut simulation).0[2].expect("a wall");
    assert!(ahead > 3.0, "it looks over the low wall: {ahead}");
    simulation.with_robot(ONE, |robot, world| robot.set_motors(world, [1, 3], -100));
    simulation.advance_to(Time::from_millis(60_000));
    let ahead = scan(&mut simulation).0[2].expect("a wall");
    assert!(ahead < 2.5, "{ahead}");
}
