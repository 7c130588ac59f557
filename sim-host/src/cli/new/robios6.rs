//! Drives to each of four walls and turns left before it.

use robios_api::prelude::*;

robios_api::program!(main);

fn main(robot: &Robot) -> Result {
    let near = 0.3.metres();
    let drive = robot.drive()?;
    let front = robot.psd(PsdAt::Front)?;
    writeln!(robot.lcd(), "@NAME@");

    for wall in 1..=4 {
        drive.set_speed(0.3.metres_per_second(), 0.radians_per_second())?;
        while front.distance().is_none_or(|distance| distance > near) {
            robot.sleep(50.millis());
        }
        drive.stop()?;
        writeln!(robot.lcd(), "wall {wall}");

        drive.turn(90.degrees(), 60.degrees_per_second())?.wait()?;
    }

    let position = drive.position();
    let (x_mm, y_mm) = (position.x.as_millimetres(), position.y.as_millimetres());
    writeln!(robot.lcd(), "x {x_mm:.0} y {y_mm:.0} mm");
    Ok(())
}
