//! The robot of RoBIOS-7 on the fake host: units, errors, and the behaviour of each device.

use robios_api::fake::Fake;
use robios_api::robios7::prelude::*;
use robios_api::robios7::{ColorImage, Direction, ImageSize, MotorGains};
use robios_api::{Frequency, Position, Ratio, Remaining};

/// Runs a program that must return without an error.
fn run(fake: Fake, main: impl FnOnce(&Robot) -> Result) -> robios_api::fake::Run {
    fake.run_robios7(main).expect_finished()
}

#[test]
fn drives_are_passed_in_whole_millimetres_and_degrees() {
    let run = run(Fake::new(), |robot| {
        let drive = robot.drive();
        drive.straight(0.5004.metres(), 0.2.metres_per_second())?;
        assert!(drive.turn(90.degrees(), 0.degrees_per_second()).is_err());
        assert!(matches!(drive.remaining(), Remaining::Length(_)));
        drive.wait()?;
        drive.turn(90.degrees(), 60.degrees_per_second())?;
        robot.sleep(750.millis());
        assert_eq!(drive.remaining(), Remaining::Angle(45.degrees()));
        assert!(!drive.is_done());
        drive.wait()?;
        drive.curve(300.millimetres(), -(90.degrees()), 100.millimetres_per_second())?.wait()?;
        assert_eq!(drive.remaining(), Remaining::Length(0.metres()));
        drive.drive_to(200.millimetres(), 100.millimetres(), 100.millimetres_per_second())?.wait()
    });
    let texts: Vec<&str> =
        run.calls().iter().map(|call| call.text.as_str()).filter(|text| text.starts_with("VW")).collect();
    assert_eq!(texts[0], "VWStraight(500, 200) = 0");
    assert!(texts.contains(&"VWTurn(90, 60) = 0"), "{texts:?}");
    assert!(texts.contains(&"VWCurve(300, -90, 100) = 0"), "{texts:?}");
    // Straight to (0.5, 0), a turn to +y, a quarter of a circle to the right, then 0.2 m ahead and 0.1 m to the left.
    let radius = 0.3 / std::f64::consts::FRAC_PI_2;
    let end = run.position();
    assert!((end.x - (0.5 + radius + 0.2).metres()).abs() < 1e-6.metres(), "{end:?}");
    assert!((end.y - (radius + 0.1).metres()).abs() < 1e-6.metres(), "{end:?}");
}

#[test]
fn signs_of_speeds_are_ignored_and_points_behind_are_reached_backwards() {
    run(Fake::new(), |robot| {
        let drive = robot.drive();
        drive.straight(-200.millimetres(), -100.millimetres_per_second())?;
        robot.sleep(500.millis());
        assert_eq!(drive.remaining(), Remaining::Length(150.millimetres()));
        drive.wait()?;
        drive.turn(-90.degrees(), -45.degrees_per_second())?.wait()?;
        assert_eq!(drive.position(), Position { x: -200.millimetres(), y: 0.metres(), phi: -90.degrees() });
        drive.set_position(Position::default())?;
        drive.drive_to(-100.millimetres(), 100.millimetres(), -50.millimetres_per_second())?.wait()?;
        assert_eq!(drive.position(), Position { x: -100.millimetres(), y: 100.millimetres(), phi: -90.degrees() });
        assert!(drive.curve(0.metres(), 90.degrees(), 50.millimetres_per_second()).is_err());
        assert!(drive.straight(100.millimetres(), 0.metres_per_second()).is_err());
        Ok(())
    });
}

#[test]
fn positions_are_passed_in_whole_numbers() {
    run(Fake::new(), |robot| {
        let drive = robot.drive();
        let start = Position { x: 1.metres(), y: -0.5.metres(), phi: 90.degrees() };
        drive.set_position(start)?;
        assert!(drive.position().distance_to(start) < 1e-9.metres());
        drive.set_speed(0.25.metres_per_second(), 0.degrees_per_second())?;
        robot.sleep(2.seconds());
        assert_eq!(drive.velocity().forward, 0.25.metres_per_second());
        let distance = drive.position().y - start.y;
        assert!((distance - 0.5.metres()).abs() < 1.5.millimetres(), "{distance}");
        assert_eq!(drive.stall(), None);
        let (ahead, left) =
            drive.position().offset_to(Position { x: 0.metres(), y: distance + start.y, phi: 0.degrees() });
        assert!(ahead.abs() < 2.millimetres() && (left - 1.metres()).abs() < 2.millimetres(), "{ahead} {left}");
        drive.stop()
    });
}

#[test]
fn errors_name_missing_devices() {
    let failed = |main: fn(&Robot) -> Result| Fake::new().run_robios7(main).expect_failed().to_owned();
    let error = failed(|robot| robot.psd(PsdAt::Other(6)).map(|_| ()));
    assert!(error.contains("no PSD sensor 6"), "{error}");
    let error = failed(|robot| robot.motor(4).set(Ratio::percent(10.0)));
    assert_eq!(error, "`MOTORDrive` was refused for the motor 4 with 1");
    let error = failed(|robot| robot.motor(1).set(Ratio::percent(101.0)));
    assert!(error.contains("accepted: -100 to 100 %"), "{error}");
    let error = failed(|robot| robot.lidar().scan().map(|_| ()));
    assert_eq!(error, "`LIDARGet` was refused for the laser scanner with 1");
    let error = failed(|robot| robot.lidar().set(400.degrees(), 0.degrees(), 100));
    assert!(error.contains("`400° in 100 points, tilted by 0°`"), "{error}");
    let error = failed(|robot| robot.lidar().set(90.degrees(), 91.degrees(), 100));
    assert!(error.contains("tilted by 91°"), "{error}");
    let error = failed(|robot| robot.every(1.5.millis(), |_| ()).map(|_| ()));
    assert!(error.contains("multiples of 1 ms"), "{error}");
    let error = failed(|robot| robot.motor(1).start_control(MotorGains { p: 1, i: 2, d: 3 }));
    assert_eq!(error, "`MOTORPID` was refused for the motor 1 with 1");
}

#[test]
fn scan_goes_from_left_to_right_with_its_middle_straight_ahead() {
    // The corner of a room: a wall 1 m ahead, one 2 m to the left.
    let corner = |_: &robios_api::fake::Moment, direction: Angle| {
        let (sin, cos) = (direction.sin(), direction.cos());
        let ahead = (cos > 1e-9).then(|| 1.metres() / cos);
        let left = (sin > 1e-9).then(|| 2.metres() / sin);
        let nearest = [ahead, left].into_iter().flatten().reduce(Length::min);
        nearest.filter(|distance| *distance < 9.metres())
    };
    run(Fake::new().lidar(corner), |robot| {
        let lidar = robot.lidar();
        let whole = lidar.scan()?;
        assert_eq!(whole.distances().len(), 360);
        assert_eq!(whole.distances()[180], Some(1.metres()));
        assert_eq!(whole.towards(90.degrees()), Some(2.metres()));
        assert_eq!(whole.towards(-90.degrees()), None);
        assert_eq!(whole.nearest(45.degrees(), 135.degrees()), Some(1.414.metres()));
        lidar.set(180.degrees(), 0.degrees(), 181)?;
        let half = lidar.scan()?;
        let points: Vec<(Angle, Option<Length>)> = half.points().collect();
        assert!((points[0].0 - 90.degrees()).abs() < 1e-9.degrees());
        assert_eq!((points[0].1, points[90].1), (Some(2.metres()), Some(1.metres())));
        assert_eq!(half.towards(120.degrees()), None);
        Ok(())
    });
}

#[test]
fn psd_sensor_may_touch_an_obstacle() {
    run(Fake::new().psd(PsdAt::Front, |_| Some(Length::ZERO)), |robot| {
        assert_eq!(robot.psd(PsdAt::Front)?.distance(), Some(Length::ZERO));
        Ok(())
    });
}

#[test]
fn keys_touches_and_colours_follow_the_script() {
    let fake = Fake::new()
        .key(1.seconds(), Key::Key2)
        .touch(2.seconds(), Pixel { x: 30, y: 40 })
        .key(3.seconds(), Key::Key1)
        .key(4.seconds(), Key::Key3);
    let run = run(fake, |robot| {
        let lcd = robot.lcd();
        assert_eq!(lcd.size(), Pixel { x: 480, y: 320 });
        lcd.menu(["GO", "", "", "END"]);
        assert_eq!(robot.wait_for_any_key(), Key::Key2);
        assert_eq!(robot.touch(), None);
        let touched = robot.wait_for_touch();
        assert_eq!(touched, Pixel { x: 30, y: 40 });
        lcd.set_pixel(touched, Color::ORANGE);
        assert_eq!(lcd.pixel(touched), Color::rgb(255, 165, 0));
        robot.wait_for_key(Key::Key3);
        lcd.move_cursor(20, 0)?;
        write!(lcd.at(2, 40), "beside the display")?;
        write!(lcd.at(2, 3), "at {:.0} s", robot.now().as_secs_f64())
    });
    assert_eq!(run.lcd_line(2), "   at 4 s");
    assert!(run.lcd_line(19).starts_with("GO"));
}

#[test]
fn motors_encoders_lines_and_the_clock_work() {
    run(Fake::new(), |robot| {
        let (left, right) = (robot.motor(1), robot.motor(2));
        let encoder = robot.encoder(2);
        encoder.reset()?;
        left.set(Ratio::percent(100.0))?;
        right.set(Ratio::percent(100.0))?;
        robot.sleep(1.seconds());
        // 0.5 m/s and 1,000 counts per metre.
        let ticks = encoder.ticks().0;
        assert!((499..=501).contains(&ticks), "{ticks}");
        assert_eq!(robot.simulation().own_pose().position.y, 0.metres());
        assert_eq!(robot.simulation().robots().count(), 1);
        let ports = robot.ports();
        assert!(ports.set(3, true).is_err(), "it is an input");
        ports.set_direction(3, Direction::Out)?;
        ports.set(3, true)?;
        assert_eq!((ports.is_high(3)?, ports.is_high(4)?, ports.lines()), (true, false, 0b100));
        assert!(ports.is_high(17).is_err());
        robot.audio().tone(Frequency::hertz(440.0), 100.millis())?;
        assert_eq!(robot.clock().seconds, 1);
        assert_eq!((robot.id().0, robot.name().as_str()), (1, "Fake"));
        assert_eq!(robot.machine_speed(), Frequency::hertz(700e6));
        Ok(())
    });
}

#[test]
fn images_have_the_requested_size() {
    run(Fake::new(), |robot| {
        let images = robot.images();
        let small = ColorImage::new(ImageSize::new(4, 3));
        assert_eq!(small.bytes().len(), 36);
        assert_eq!(small.pixel(Pixel { x: 3, y: 2 }), Some(Color::BLACK));
        assert_eq!(small.pixel(Pixel { x: 4, y: 2 }), None);
        let large = ColorImage::new(ImageSize::QQVGA);
        let error = images.overlay(&small, &large).expect_err("sizes differ");
        assert!(error.to_string().contains("`160x120`"), "{error}");
        assert!(images.read_color("nowhere.ppm", ImageSize::QVGA).is_err());
        Ok(())
    });
}

#[test]
fn image_files_are_read_in_color_and_in_gray() {
    run(Fake::new(), |robot| {
        let images = robot.images();
        let size = ImageSize::new(3, 2);
        let mut color = ColorImage::new(size);
        color.bytes_mut()[3..6].copy_from_slice(&[30, 60, 90]);
        let gray = images.to_gray(&color);
        assert_eq!(gray.bytes(), [0, 60, 0, 0, 0, 0]);
        images.write_color("color.ppm", &color)?;
        images.write_gray("gray.pgm", &gray)?;
        assert_eq!(images.read_color("color.ppm", size)?, color);
        assert_eq!(images.read_gray("gray.pgm", size)?, gray);
        assert_eq!(images.read_gray("color.ppm", size)?, gray);
        assert_eq!(images.read_color("gray.pgm", size)?, images.to_color(&gray));
        // Cropped at the right and padded at the bottom.
        assert_eq!(images.read_gray("gray.pgm", ImageSize::new(2, 3))?.bytes(), [0, 60, 0, 0, 0, 0]);
        let error = images.read_gray("nowhere.pgm", size).expect_err("no file");
        assert_eq!(error.to_string(), "`IPReadFile` was refused for the image with -1");
        Ok(())
    });
}
