//! Drives until a wall is near, then turns round and comes back.

use robios_api::prelude::*;

robios_api::program!(main);

fn main(robot: &Robot) -> Result {
    let drive = robot.drive()?;
    let front = robot.psd(PsdAt::Front)?;

    drive.set_speed(0.2.metres_per_second(), 0.radians_per_second())?;
    while front.distance().is_none_or(|distance| distance > 0.2.metres()) {
        robot.sleep(50.millis());
    }
    drive.stop()?;

    let x = drive.position().x;
    writeln!(robot.lcd(), "wall at {x:.2}");
    drive.turn(180.degrees(), 1.radians_per_second())?.wait()?;
    drive.straight(x, 0.2.metres_per_second())?.wait()
}

#[cfg(test)]
mod tests {
    use super::*;
    use robios_api::fake::Fake;

    #[test]
    fn it_returns_to_its_start() {
        let run = Fake::new().psd(PsdAt::Front, |now| Some(1.metres() - now.position.x)).run(main).expect_finished();
        assert!(run.position().distance_to(Default::default()) < 1.millimetres());
        assert!(run.lcd_line(0).starts_with("wall at 0.8"));
    }
}
