//! Programs on the fake robot: calls and releases, ends of programs, and containment of panics.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use robios_api::fake::{End, Fake};
use robios_api::prelude::*;
use robios_api::{AnalogValue, Ink, LayerFrame, LayerGrid, Pixel, Remaining, Ticks, TimeOfDay, Timer};

/// Result of a program that is a closure; it fixes the type of the closure's errors.
const DONE: Result = Ok(());

#[test]
fn errors_name_the_device_and_the_call() {
    let run = Fake::new().run(|robot| robot.psd(PsdAt::Back).map(|_| ()));
    assert_eq!(
        run.expect_failed(),
        "the robot has no PSD sensor `PsdAt::Back` (`PSD_BACK`), or it is in use already (the robi file lists its devices)"
    );
    let run = Fake::new().run(|robot| {
        robot.drive()?.straight(1.metres(), 0.metres_per_second())?;
        DONE
    });
    assert_eq!(run.expect_failed(), "`VWDriveStraight` was refused for the driving interface `VW_DRIVE` with -1");
    let run = Fake::new().run(|robot| robot.motor(MotorAt::Left)?.set(robios_api::Ratio::percent(120.0)));
    assert_eq!(run.expect_failed(), "`120 %` is not a valid power of a motor, accepted: -100 to 100 %");
    let run = Fake::new().run(|robot| robot.every(15.millis(), |_| ()).map(|_| ()));
    assert_eq!(
        run.expect_failed(),
        "`15ms` is not a valid period of a timer, accepted: multiples of 10 ms from 10 ms on"
    );
}

#[test]
fn layers_beyond_the_limits_are_refused() {
    fn map(columns: usize, cells: &[u8]) -> LayerGrid<'_> {
        LayerGrid { corner: [Length::ZERO; 2], cell: 50.millimetres(), columns, cells }
    }
    let frame = LayerFrame::Odometry;
    let run = Fake::new().run(|robot| {
        let before = [robot.now(), robot.now()];
        robot.layers().grid("map", frame, &map(2, &[0, 100, LayerGrid::UNKNOWN, LayerGrid::cell_of(0.5)]))?;
        robot.layers().points("hits", LayerFrame::World, &[[1.0, 2.0, 3.0]])?;
        robot.layers().line("way", frame, &[[0.0, 0.0], [1.0, 2.0]])?;
        robot.layers().points::<[f64; 2]>("hits", frame, &[])?;
        assert_eq!(robot.now() - before[1], before[1] - before[0], "only reading the clock takes time");
        for grid in [map(0, &[0]), map(2, &[0; 3]), map(1, &[]), map(1, &[0; (1 << 20) + 1])] {
            assert!(matches!(robot.layers().grid("map", frame, &grid), Err(Error::OutOfRange { .. })));
        }
        let many = vec![[0.0; 2]; (1 << 16) + 1];
        assert!(matches!(robot.layers().line("way", frame, &many), Err(Error::OutOfRange { .. })));
        assert!(matches!(robot.layers().line("", frame, &[[0.0; 2]]), Err(Error::Refused { .. })));
        robot.layers().points("hits", frame, &[[0.0, f64::NAN]])
    });
    assert_eq!(run.expect_failed(), "`show_points` was refused for the layers of the window with 1");
    assert_eq!(run.calls_of("show_line").count(), 2, "the API refuses the long one itself");
    assert_eq!([-1.0, 0.004, 0.5, 2.0, f64::NAN].map(LayerGrid::cell_of), [0, 0, 50, 100, LayerGrid::UNKNOWN]);
}

#[test]
fn devices_are_released_when_they_are_dropped() {
    let run = Fake::new()
        .psd(PsdAt::Left, |_| Some(0.3.metres()))
        .psd(PsdAt::Right, |_| Some(0.4.metres()))
        .run(|robot| {
            let left = robot.psd(PsdAt::Left)?;
            {
                let right = robot.psd(PsdAt::Right)?;
                assert_eq!((left.distance(), right.distance()), (Some(0.3.metres()), Some(0.4.metres())));
            }
            assert_eq!(left.distance(), Some(300.millimetres()));
            assert!(robot.motor(MotorAt::Left).is_ok());
            let drive = robot.drive()?;
            assert_eq!(robot.drive().unwrap_err(), Error::Unavailable(robios_api::Device::Drive));
            assert!(robot.motor(MotorAt::Left).is_err());
            drop(drive);
            robot.drive()?;
            DONE
        })
        .expect_finished();
    let released: Vec<&str> =
        run.calls().iter().map(|call| call.name).filter(|name| name.ends_with("Release")).collect();
    assert_eq!(released, ["MOTORRelease", "VWRelease", "VWRelease", "PSDRelease"]);
}

#[test]
fn panic_is_reported_with_location_and_text() {
    fn fall(_: &Robot) {
        panic!("no {}", "floor");
    }
    let line = line!() - 2;
    let run = Fake::new().run(fall);
    let location = format!("panicked at {}:{line}:", file!());
    assert!(run.expect_failed().starts_with(&location), "{}", run.expect_failed());
    assert!(run.expect_failed().ends_with(": no floor"));
}

#[test]
fn error_is_reported_with_its_sources() {
    #[derive(Debug, thiserror::Error)]
    #[error("cannot start")]
    struct Outer(#[source] Error);
    let run = Fake::new().run(|robot| robot.bumper(BumperAt::Left).map(|_| ()).map_err(Outer));
    assert!(run.expect_failed().starts_with("cannot start: the robot has no bumper `BumperAt::Left` (`BUMP_LEFT`)"));
}

#[test]
fn stopped_program_runs_its_destructors_whose_calls_are_harmless() {
    struct Guard(Robot, Rc<Cell<bool>>);
    impl Drop for Guard {
        fn drop(&mut self) {
            self.0.sleep(1.seconds());
            self.1.set(true);
        }
    }
    let dropped = Rc::new(Cell::new(false));
    let seen = dropped.clone();
    let run = Fake::new().until(2.seconds()).run(move |robot| {
        let _guard = Guard(robot.clone(), seen);
        robot.sleep(10.seconds());
    });
    assert_eq!(run.expect_time_up().time(), 2.seconds());
    assert!(dropped.get());
}

#[test]
fn program_that_catches_the_stop_is_stopped_at_the_next_call() {
    fn stubborn(robot: &Robot) {
        let slept = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| robot.sleep(2.seconds())));
        assert!(slept.is_err());
        robot.sleep(1.millis());
        unreachable!("it was left");
    }
    Fake::new().until(1.seconds()).run(stubborn).expect_time_up();
}

#[test]
fn waiting_call_is_reported_with_its_line() {
    let line = line!() + 1;
    let run = Fake::new().key(1.seconds(), Key::Key1).run(|robot| robot.wait_for_key(Key::Key4)).expect_time_up();
    let End::TimeUp { during } = run.end() else { unreachable!() };
    assert!(during.starts_with(&format!("KEYWait(8) at {}:{line}:", file!())), "{during}");
}

#[test]
fn keys_are_received_when_they_are_pressed() {
    Fake::new()
        .key(2.seconds(), Key::Key3)
        .key(1.seconds(), Key::Key1)
        .run(|robot| {
            assert_eq!(robot.key(), None);
            assert_eq!(robot.wait_for_any_key(), Key::Key1);
            assert_eq!(robot.now().as_millis(), 1000);
            robot.sleep(2.seconds());
            assert_eq!((robot.key(), robot.key()), (Some(Key::Key3), None));
        })
        .expect_finished();
}

#[test]
fn a_timer_runs_inside_the_calls_of_the_program_until_it_is_dropped() {
    let times = Rc::new(RefCell::new(Vec::new()));
    let seen = times.clone();
    let run = Fake::new().run(move |robot| {
        let drive = Rc::new(robot.drive()?);
        let alarm = drive.clone();
        let timer = robot.every(500.millis(), move |robot| {
            seen.borrow_mut().push(robot.now().as_millis());
            if alarm.position().x > 0.9.metres() {
                alarm.stop().expect("a drive stops");
            }
        })?;
        drive.straight(3.metres(), 1.metres_per_second())?.wait()?;
        drop(timer);
        robot.sleep(5.seconds());
        DONE
    });
    assert_eq!(run.expect_finished().position().x.as_metres().round(), 1.0);
    assert_eq!(times.borrow()[..2], [500, 1000]);
    assert!(times.borrow().len() <= 6, "{:?}", times.borrow());
    assert_eq!(Rc::strong_count(&times), 1, "its function is freed");
}

#[test]
fn a_timer_may_drop_itself() {
    let run = Fake::new().run(|robot| {
        let held_timer: Rc<RefCell<Option<Timer>>> = Rc::default();
        let count = Rc::new(Cell::new(0));
        let (inner, counted) = (held_timer.clone(), count.clone());
        let timer = robot.every(10.millis(), move |_| {
            counted.set(counted.get() + 1);
            drop(inner.take());
            counted.set(counted.get() + 10);
        })?;
        held_timer.replace(Some(timer));
        robot.sleep(1.seconds());
        assert_eq!((count.get(), Rc::strong_count(&count)), (11, 1));
        DONE
    });
    run.expect_finished();
}

#[test]
fn time_limit_inside_a_timer_stops_the_interrupted_call() {
    fn sleeper(robot: &Robot) {
        let _timer = robot.every(500.millis(), |robot| {
            loop {
                robot.now();
            }
        });
        robot.sleep(10.seconds());
        unreachable!("it was left");
    }
    Fake::new().until(1.seconds()).run(sleeper).expect_time_up();
}

#[test]
fn waiting_in_a_timer_is_a_failure() {
    let run = Fake::new().run(|robot| {
        let _timer = robot.every(100.millis(), |robot| robot.sleep(1.seconds()));
        robot.sleep(1.seconds());
    });
    assert_eq!(run.expect_failed(), "sleep waits inside of a timer's function");
}

#[test]
fn timers_are_held_back() {
    let run = Fake::new().run(|robot| {
        let count = Rc::new(Cell::new(0));
        let counted = count.clone();
        let _timer = robot.every(100.millis(), move |_| counted.set(counted.get() + 1))?;
        let held = robot.hold_timers();
        robot.sleep(1.seconds());
        assert_eq!(count.get(), 0);
        drop(held);
        robot.sleep(1.seconds());
        // One call for all missed times, then ten.
        assert_eq!(count.get(), 11);
        DONE
    });
    run.expect_finished();
}

#[test]
fn devices_that_outlive_the_program_do_nothing() {
    thread_local! {
        static KEPT: RefCell<Option<(Robot, Drive)>> = const { RefCell::new(None) };
    }
    let run = Fake::new().run(|robot| {
        KEPT.set(Some((robot.clone(), robot.drive()?)));
        DONE
    });
    let calls = run.expect_finished().calls().len();
    let (robot, drive) = KEPT.take().expect("it was kept");
    assert_eq!(robot.now(), Duration::ZERO);
    assert_eq!(drive.position(), Default::default());
    drop(drive);
    assert!(calls > 0);
}

#[test]
fn random_numbers_depend_on_the_seed() {
    let draw = |seed| {
        let numbers = Rc::new(RefCell::new(Vec::new()));
        let drawn = numbers.clone();
        let run = Fake::new().seed(seed).run(move |robot| {
            use rand_core::Rng;
            let mut random = robot.random();
            drawn.borrow_mut().extend([random.next_u64(), u64::from(random.next_u32()), random.bits()]);
            assert!((0.0..1.0).contains(&random.fraction()));
            assert!([1, 2, 3].contains(random.choice(&[1, 2, 3]).expect("there are some")));
            assert_eq!(random.choice::<u8>(&[]), None);
        });
        run.expect_finished();
        numbers.take()
    };
    assert_eq!(draw(1), draw(1));
    assert_ne!(draw(1), draw(2));
}

#[test]
fn motors_and_encoders_agree() {
    let run = Fake::new().run(|robot| {
        let motors = [robot.motor(MotorAt::Left)?, robot.motor(MotorAt::Right)?];
        let encoder = robot.encoder(EncoderAt::Left)?;
        assert_eq!(robot.motor_of(EncoderAt::Left), Some(MotorAt::Left));
        for motor in &motors {
            motor.set(50.percent())?;
        }
        robot.sleep(2.seconds());
        // 0.25 m/s, less the call costs of some 100 us each.
        assert!((encoder.distance() - 0.5.metres()).abs() < 1.millimetres());
        assert!((499..=500).contains(&encoder.ticks().0));
        encoder.reset()?;
        assert_eq!(encoder.ticks(), Ticks(0));
        DONE
    });
    run.expect_finished();
}

#[test]
fn drives_report_what_remains() {
    let run = Fake::new().run(|robot| {
        let drive = robot.drive()?;
        drive.turn(-90.degrees(), 45.degrees_per_second())?;
        robot.sleep(1.seconds());
        let Remaining::Angle(angle) = drive.remaining() else { panic!("a turn remains as an angle") };
        assert!((angle - 45.degrees()).abs() < 0.1.degrees() && !drive.is_done());
        drive.curve(1.metres(), 180.degrees(), -0.5.metres_per_second())?.wait()?;
        assert!(drive.is_done() && !drive.is_stalled());
        assert_eq!(drive.remaining(), Remaining::Length(Length::ZERO));
        drive.set_position(Default::default())?;
        drive.straight(-0.5.metres(), 0.5.metres_per_second())?;
        assert!(drive.turn(90.degrees(), 0.degrees_per_second()).is_err());
        assert!(matches!(drive.remaining(), Remaining::Length(_)));
        drive.wait()?;
        assert!((drive.position().x + 0.5.metres()).abs() < 0.001.millimetres());
        drive.set_speed(0.1.metres_per_second(), 0.radians_per_second())?;
        assert!((drive.velocity().forward - 0.1.metres_per_second()).abs() < 1e-6.metres_per_second());
        DONE
    });
    run.expect_finished();
}

#[test]
fn bumpers_infrared_and_compass_follow_the_script() {
    let run = Fake::new()
        .bumper(BumperAt::Front, [1.seconds(), 1.5.seconds()])
        .infrared(InfraredAt::Left, |now| now.time > 1.seconds())
        .run(|robot| {
            let (bumper, infrared) = (robot.bumper(BumperAt::Front)?, robot.infrared(InfraredAt::Left)?);
            let compass = robot.compass()?;
            assert!(robot.compass().is_err(), "there is one already, which continues");
            assert_eq!((bumper.bumped(), infrared.is_near()), (None, false));
            robot.sleep(2.seconds());
            assert_eq!((bumper.bumped(), bumper.bumped(), infrared.is_near()), (Some(1.seconds()), None, true));
            assert_eq!(compass.bearing(), Some(90.degrees()));
            robot.drive()?.turn(90.degrees(), 1.radians_per_second())?.wait()?;
            assert_eq!(compass.bearing(), Some(Angle::ZERO));
            DONE
        });
    run.expect_finished();
}

#[test]
fn distance_is_from_the_last_complete_cycle() {
    let run = Fake::new().psd(PsdAt::Front, |now| Some(now.time.as_secs_f64().metres())).run(|robot| {
        let front = robot.psd(PsdAt::Front)?;
        let first = front.distance().expect("a distance");
        robot.sleep(30.millis());
        assert!(front.distance().expect("a distance") - first < 61.millimetres());
        robot.sleep(600.millis());
        let later = front.distance().expect("a distance");
        let cycles = (later - first) / 60.millimetres();
        assert!((cycles - cycles.round()).abs() < 0.02, "{cycles}");
        assert!(robot.now() - front.measured_at() < 71.millis());
        DONE
    });
    run.expect_finished();
}

#[test]
fn the_display_shows_text_menu_and_pixels() {
    let run = Fake::new().run(|robot| {
        let lcd = robot.lcd();
        write!(lcd, "x = {:.1}", 0.25.metres());
        write!(lcd.at(2, 12), "end")?;
        assert_eq!(lcd.cursor(), (2, 15));
        lcd.menu(["GO", "", "", "STOP"]);
        lcd.menu_entry(Key::Key2, "TURN");
        assert!(write!(lcd.at(7, 0), "?").is_err());
        lcd.line(Pixel { x: 0, y: 0 }, Pixel { x: 10, y: 10 }, Ink::Black);
        lcd.set_pixel(Pixel { x: 5, y: 5 }, Ink::Invert)?;
        let pixels = [4, 5, 200].map(|x| lcd.pixel(Pixel { x, y: x }));
        assert_eq!(pixels, [Some(true), Some(false), None]);
        DONE
    });
    let run = run.expect_finished();
    assert_eq!(run.lcd_line(0), "x = 0.2 m");
    assert_eq!(run.lcd_line(2), "            end");
    assert_eq!(run.lcd_line(6), "GO  TURN    STOP");
}

#[test]
fn unimplemented_devices_fail_as_documented() {
    let run = Fake::new().run(|robot| {
        assert!(robot.tv_remote().is_err());
        assert!(robot.ports().analog(0).is_err());
        assert!(robot.audio().play(b"").is_err());
        assert_eq!(AnalogValue(1023).fraction(), 1.0);
        assert!(robot.devices().is_empty());
        robot.set_variable(3, 7)?;
        assert_eq!((robot.variable(3), robot.variable(4)), (7, 0));
        assert!(robot.set_variable(99, 1).is_err());
        robot.set_clock(TimeOfDay { hours: 23, minutes: 59, seconds: 59, hundredths: 0 })?;
        robot.sleep(1.seconds());
        assert_eq!(robot.clock().hours, 0);
        assert_eq!((robot.version(), robot.name()), ("6.5".to_owned(), "Fake".to_owned()));
        DONE
    });
    run.expect_finished();
}

#[test]
fn panic_of_a_script_is_reported_as_such() {
    let run = Fake::new().psd(PsdAt::Front, |_| panic!("bad script")).run(|robot| {
        let front = robot.psd(PsdAt::Front)?;
        front.distance();
        DONE
    });
    assert_eq!(run.expect_failed(), "the script of the test panicked in PSDGet: bad script");
}
