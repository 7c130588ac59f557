//! Drives a square of 0.4 m sides and comes back to its start; an argument is another side in metres.

use robios_api::prelude::*;

robios_api::program!(main);

fn main(robot: &Robot) -> Result<(), Box<dyn std::error::Error>> {
    let side = match robot.arguments().first() {
        Some(argument) => argument.parse::<f64>().map_err(|error| format!("side `{argument}`: {error}"))?.metres(),
        None => 0.4.metres(),
    };
    let drive = robot.drive()?;
    for corner in 1..=4 {
        drive.straight(side, 0.2.metres_per_second())?.wait()?;
        drive.turn(90.degrees(), 90.degrees_per_second())?.wait()?;
        let position = drive.position();
        writeln!(robot.lcd(), "{corner}: {:.3} {:.3}", position.x.as_metres(), position.y.as_metres());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use robios_api::fake::Fake;

    #[test]
    fn ends_where_it_started() {
        let run = Fake::new().run(main).expect_finished();
        let end = run.position();
        assert!(end.x.abs() < 0.001.millimetres() && end.y.abs() < 0.001.millimetres(), "{end:?}");
        assert!((end.phi - 360.degrees()).abs() < 0.000_001.radians());
        assert_eq!(run.calls_of("VWDriveStraight").count(), 4);
        assert_eq!(run.lcd_line(1), "2: 0.400 0.400");
    }

    #[test]
    fn the_side_is_an_argument() {
        let run = Fake::new().argument("0.1").run(main).expect_finished();
        assert_eq!(run.lcd_line(0), "1: 0.100 0.000");
        let run = Fake::new().argument("wide").run(main);
        assert_eq!(run.expect_failed(), "side `wide`: invalid float literal");
    }
}
