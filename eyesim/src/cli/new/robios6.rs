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

#[cfg(test)]
mod tests {
    use super::*;
    use robios_api::fake::{Fake, Moment};

    /// Distance from the wall ahead in a room of 2 m, in the middle of which the robot starts.
    fn ahead(now: &Moment) -> Option<Length> {
        let to_wall = |at: Length, along: f64| match along {
            -1e-6..1e-6 => f64::INFINITY,
            _ => (along.signum() - at.as_metres()) / along,
        };
        let at = now.position;
        Some(to_wall(at.x, at.phi.cos()).min(to_wall(at.y, at.phi.sin())).metres())
    }

    /// `cargo test` runs it on a fake robot, without eyesim.
    #[test]
    fn it_turns_before_four_walls() {
        let run = Fake::new().psd(PsdAt::Front, ahead).run(main).expect_finished();
        assert_eq!(run.lcd_line(4), "wall 4");
        assert!(run.position().x.as_metres().abs() < 1.0, "{:?}", run.position());
    }
}
