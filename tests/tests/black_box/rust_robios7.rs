//! Rust programs of RoBIOS-7 in the simulator: results of calls whose return values have other meanings than 0 for
//! success.

use tests::{Scratch, root, write_package};

const PROGRAM: &str = r#"use robios_api::robios7::prelude::*;
use robios_api::robios7::{ColorImage, ImageSize};

robios_api::program!(main);

fn main(robot: &Robot) -> Result {
    let (images, size) = (robot.images(), ImageSize::new(3, 2));
    let mut color = ColorImage::new(size);
    color.bytes_mut()[3..6].copy_from_slice(&[30, 60, 90]);
    let gray = images.to_gray(&color);
    images.write_color("color.ppm", &color)?;
    images.write_gray("gray.pgm", &gray)?;
    assert_eq!(images.read_color("color.ppm", size)?, color);
    assert_eq!(images.read_gray("gray.pgm", size)?, gray);
    assert_eq!(images.read_gray("color.ppm", size)?, gray);
    assert_eq!(images.read_color("gray.pgm", size)?, images.to_color(&gray));
    assert!(images.read_gray("nowhere.pgm", size).is_err());

    robot.wait_for_key(Key::Key3);
    writeln!(robot.console(), "key at {:.1} s", robot.now().as_secs_f64());

    let lidar = robot.lidar();
    let scan = lidar.scan()?;
    writeln!(robot.console(), "{} points, {:.2} ahead", scan.distances().len(), scan.towards(Angle::ZERO).unwrap());
    lidar.set(180.degrees(), Angle::ZERO, 5)?;
    let scan = lidar.scan()?;
    writeln!(robot.console(), "{} points, {:.2} right", scan.distances().len(), scan.towards(-90.degrees()).unwrap());

    let drive = robot.drive();
    drive.straight(-200.millimetres(), 100.millimetres_per_second())?;
    assert!(drive.turn(90.degrees(), 0.degrees_per_second()).is_err());
    robot.sleep(500.millis());
    writeln!(robot.console(), "{:?}", drive.remaining());
    Ok(())
}
"#;

#[test]
fn calls_return_what_the_program_asks_for() {
    let scratch = Scratch::new();
    write_package(&scratch, "asks", PROGRAM);
    let robi = std::fs::read_to_string(root().join("robis/feeler.robi")).expect("a robi");
    scratch.write("own.robi", &robi);
    scratch.write("own.toml", "[lidar]\npoints = 90\ntilt_deg = 0\n");
    scratch.write(
        "asks.scene.toml",
        "[world]\nfile = \"%sim%/worlds/empty.wld\"\n\
         [[robot]]\ntype = \"own.robi\"\nprogram = \"asks\"\nx_mm = 1000\ny_mm = 1000\n",
    );
    let ran = scratch.eyesim(&["run", "asks.scene.toml", "--keys", "2:KEY1,3:KEY3"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    let lines = ran.stdout.lines().filter(|line| line.starts_with("[r1 "));
    let said: Vec<&str> = lines.filter_map(|line| Some(line.split_once("] ")?.1)).collect();
    assert_eq!(said, ["key at 3.0 s", "90 points, 3.00 m ahead", "5 points, 1.00 m right", "Length(Length(0.15))"]);
}
