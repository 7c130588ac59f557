//! Drives to 300 mm before the wall, turns left, and leaves in an arc. RoBIOS-7 in Rust: quantities with their units.

use robios_api::robios7::prelude::*;

robios_api::program!(main);

fn main(robot: &Robot) -> Result {
    let drive = robot.drive();
    let distance = robot.psd(PsdAt::Front)?.distance().unwrap_or(Length::metres(9.999));
    writeln!(robot.lcd(), "wall: {:.0} mm", distance.as_millimetres());

    drive.straight(distance - 300.millimetres(), 0.2.metres_per_second())?.wait()?;
    drive.turn(90.degrees(), 60.degrees_per_second())?.wait()?;
    drive.curve(400.millimetres(), -90.degrees(), 0.2.metres_per_second())?.wait()?;

    let position = drive.position();
    write!(robot.lcd(), "x {:.0} y {:.0}", position.x.as_millimetres(), position.y.as_millimetres());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use robios_api::fake::Fake;

    #[test]
    fn stops_before_the_wall_and_leaves() {
        let run = Fake::new().psd(PsdAt::Front, |_| Some(800.millimetres())).run_robios7(main).expect_finished();
        // An arc of 400 mm through 90 degrees has a radius of 254.6 mm.
        assert_eq!((run.lcd_line(0), run.lcd_line(1)), ("wall: 800 mm", "x 755 y 255"));
    }
}
