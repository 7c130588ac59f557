//! Turns a sonar on a servo from the right to the left and prints each echo: direction, distance, energy.

use robios_api::prelude::*;
use robios_api::{ServoAt, ServoPosition, Signal};

robios_api::program!(main);

/// The sonar's number in the robot's companion.
const SONAR: PsdAt = PsdAt::Other(5);
/// Number of servo positions between two directions.
const STEP: i32 = 14;
/// Number of directions to either side.
const TO_EITHER_SIDE: i32 = 9;
/// Degrees per servo position: 90 degrees are 127 positions.
const DEGREES: f64 = 90.0 / 127.0;
/// Two sensor cycles of 60 ms: the first may have begun before the servo turned, the second began afterwards.
const TWO_CYCLES: Duration = Duration::from_millis(120);

fn main(robot: &Robot) -> Result {
    let servo = robot.servo(ServoAt::Servo1)?;
    let sonar = robot.psd(SONAR)?;
    for direction in -TO_EITHER_SIDE..=TO_EITHER_SIDE {
        let steps = STEP * direction;
        // The middle is two positions wide: 127 and 128.
        let position = if steps > 0 { 128 + steps } else { 127 + steps };
        servo.set(ServoPosition(position as u8))?;
        robot.sleep(TWO_CYCLES);
        let degrees = DEGREES * f64::from(steps);
        match (sonar.distance(), sonar.signal()) {
            (Some(distance), Some(Signal(energy))) => {
                let distance_mm = distance.as_millimetres().round();
                writeln!(robot.console(), "{degrees:.1} degrees: {distance_mm} mm, energy {energy:.4}");
            }
            _ => writeln!(robot.console(), "{degrees:.1} degrees: no echo"),
        }
    }
    Ok(())
}
