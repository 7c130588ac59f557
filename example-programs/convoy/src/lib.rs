//! A convoy: robot 1 drives a figure of eight and half a circle; every other robot follows the trail of the robot with
//! the next lower number.
//!
//! Each robot broadcasts its position ten times a second, and ends when the robot ahead has been silent for two
//! seconds. Arguments: the start pose, in mm and degrees, so that all robots share one frame. `convoy-c` is the same
//! program in C; both programs can drive in one convoy.

use std::collections::VecDeque;
use std::error::Error;

use robios_api::prelude::*;
use robios_api::{Position, Radio, RobotNumber};

robios_api::program!(main);

const LEADER: RobotNumber = RobotNumber(1);
/// Radius of each half of the eight.
const RADIUS: Length = Length::metres(0.8);
/// Gap to the robot ahead, along its trail.
const GAP: Length = Length::metres(0.35);
/// Distance to the target point on the trail.
const AHEAD: Length = Length::metres(0.12);
const PERIOD: Duration = Duration::from_millis(100);
/// Silence after which the robot ahead counts as ended.
const SILENCE: Duration = Duration::from_secs(2);

fn main(robot: &Robot) -> Result<(), Box<dyn Error>> {
    let [x, y, phi] = robot.arguments() else {
        return Err("where it starts: x and y in mm, heading in degrees".into());
    };
    let drive = robot.drive()?;
    drive.set_position(Position {
        x: x.parse::<f64>()?.millimetres(),
        y: y.parse::<f64>()?.millimetres(),
        phi: phi.parse::<f64>()?.degrees(),
    })?;
    let radio = robot.radio()?;
    match robot.id() {
        LEADER => lead(robot, &drive, &radio)?,
        RobotNumber(me) => follow(robot, &drive, &radio, RobotNumber(me - 1))?,
    }
    Ok(drive.stop()?)
}

fn lead(robot: &Robot, drive: &Drive, radio: &Radio) -> Result {
    for angle in [360.degrees(), -360.degrees(), 180.degrees()] {
        let arc_length = RADIUS * angle.abs().as_radians();
        drive.curve(arc_length, angle, 0.2.metres_per_second())?;
        while !drive.is_done() {
            broadcast_pose(drive, radio)?;
            robot.sleep(PERIOD);
        }
    }
    Ok(())
}

fn follow(robot: &Robot, drive: &Drive, radio: &Radio, leader: RobotNumber) -> Result {
    let mut trail = Trail::default();
    let mut last = robot.now() + 10.seconds();
    while robot.now() < last + SILENCE {
        while let Some(message) = radio.try_receive()? {
            if let (true, Some(position)) = (message.from == leader, position_of(&message.bytes)) {
                trail.0.push_back(position);
                last = robot.now();
            }
        }
        if let Some((speed, rate)) = trail.steer(drive.position()) {
            drive.set_speed(speed, rate)?;
        }
        broadcast_pose(drive, radio)?;
        robot.sleep(PERIOD);
    }
    Ok(())
}

/// Broadcasts the position: x and y in mm, two bytes each, the lower byte first.
fn broadcast_pose(drive: &Drive, radio: &Radio) -> Result {
    let at = drive.position();
    let [x, y] = [at.x, at.y].map(|length| (length.as_millimetres().round() as i16).to_le_bytes());
    radio.broadcast(&[x, y].concat())
}

fn position_of(message: &[u8]) -> Option<Position> {
    let &[a, b, c, d] = message else { return None };
    let [x, y] = [[a, b], [c, d]].map(|bytes| f64::from(i16::from_le_bytes(bytes)).millimetres());
    Some(Position { x, y, ..Position::default() })
}

/// Part of the trail of the robot ahead that this robot has not driven yet.
#[derive(Default)]
struct Trail(VecDeque<Position>);

impl Trail {
    /// Speeds that follow the trail: faster if more of the trail lies ahead.
    fn steer(&mut self, at: Position) -> Option<(Speed, TurnRate)> {
        while self.0.front()?.distance_to(at) <= AHEAD {
            self.0.pop_front();
        }
        let target = *self.0.front()?;
        let distance = target.distance_to(at);
        let positions = self.0.iter();
        let length = positions
            .clone()
            .zip(positions.skip(1))
            .fold(distance, |length, (from, to)| length + from.distance_to(*to));
        let speed = (1.5 * (length - GAP).as_metres()).clamp(0.0, 0.35);
        let angle = Angle::towards(target.x - at.x, target.y - at.y) - at.phi;
        // An arc through the target point.
        let rate = speed * 2.0 * angle.sin() / distance.as_metres();
        Some((speed.metres_per_second(), rate.radians_per_second()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robios_api::fake::Fake;

    /// The fake robot has the number 1.
    #[test]
    fn the_leader_sends_its_positions() {
        let run =
            Fake::new().argument("500").argument("0").argument("0").until(200.seconds()).run(main).expect_finished();
        assert!((run.position().y - 2.0 * RADIUS).abs() < 1.millimetres());
        let path: Vec<Position> = run.sent().iter().filter_map(|sent| position_of(&sent.bytes)).collect();
        let lowest = path.iter().map(|at| at.y).fold(0.metres(), Length::min);
        assert!((lowest + 2.0 * RADIUS).abs() < 5.millimetres());
        assert_eq!(path[0].x, 500.millimetres());
    }

    #[test]
    fn a_trail_is_followed_with_a_gap() {
        let position_at = |x: f64| Position { x: x.metres(), ..Position::default() };
        let trail = || Trail((1..=10).map(|index| position_at(0.1 * f64::from(index))).collect());
        let (speed, rate) = trail().steer(position_at(0.0)).expect("a trail");
        assert_eq!((speed, rate), (0.35.metres_per_second(), 0.radians_per_second()));
        let (_, rate) = trail().steer(Position { y: 0.05.metres(), ..position_at(0.0) }).expect("a trail");
        assert!(rate < 0.radians_per_second(), "back to it, to the right");
        let mut rest = Trail((6..=10).map(|index| position_at(0.1 * f64::from(index))).collect());
        let (speed, _) = rest.steer(position_at(0.69)).expect("a trail");
        assert_eq!((speed, rest.0.len()), (0.metres_per_second(), 2), "near enough");
        assert!(Trail::default().steer(position_at(0.0)).is_none());
    }
}
