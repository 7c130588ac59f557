//! Follows the wall at its left, forever: turns away from walls ahead and around corners.
//!
//! The diagonal sensor sees the wall a little ahead of the robot. Its reading depends on the distance and on the
//! heading, so one gain is enough to steer.

use robios_api::prelude::*;

robios_api::program!(main);

/// The distance that the diagonal sensor keeps.
const KEPT: Length = Length::metres(0.3);
/// Readings beyond this distance are not from the followed wall.
const LOST: Length = Length::metres(0.5);
/// The minimum distance to a wall ahead.
const AHEAD: Length = Length::metres(0.25);
const CRUISE: Speed = Speed::metres_per_second(0.2);
/// Maximum turn rate, reached at a distance error of half of `KEPT`.
const TURN: TurnRate = TurnRate::radians_per_second(1.0);
/// Turn rate around a corner: with `CRUISE` a circle of 0.36 m radius.
const CORNER: TurnRate = TurnRate::radians_per_second(0.55);

fn main(robot: &Robot) -> Result {
    let drive = robot.drive()?;
    let [diagonal, front] = robot.psds([PsdAt::LeftDiagonal, PsdAt::Front])?;
    let ticker = robot.ticker(50.millis());
    loop {
        let (forward, turn) = steer(diagonal.distance(), front.distance());
        drive.set_speed(forward, turn)?;
        ticker.wait();
    }
}

/// Speed and turn rate for the sensors' readings.
fn steer(diagonal: Option<Length>, front: Option<Length>) -> (Speed, TurnRate) {
    if front.is_some_and(|front| front < AHEAD) {
        return (Speed::ZERO, -TURN);
    }
    match diagonal.filter(|wall| *wall < LOST) {
        Some(wall) => (CRUISE, TURN * ((wall - KEPT) / (KEPT * 0.5)).clamp(-1.0, 1.0)),
        None => (CRUISE, CORNER),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robios_api::fake::Fake;

    #[test]
    fn comes_to_its_distance_along_a_straight_wall() {
        // The wall is at y = 0.4 m; the sensor looks from the robot's centre.
        let run = Fake::new()
            .psd(PsdAt::LeftDiagonal, |now| {
                let slope = (now.position.phi + 45.degrees()).sin();
                (slope > 0.1).then(|| (0.4.metres() - now.position.y) / slope).filter(|wall| *wall < 1.metres())
            })
            .psd(PsdAt::Front, |_| None)
            .until(30.seconds())
            .run(main)
            .expect_time_up();
        let end = run.position();
        let kept = 0.4.metres() - KEPT * 45.degrees().sin();
        assert!((end.y - kept).abs() < 5.millimetres(), "{end:?}");
        assert!(end.phi.abs() < 2.degrees() && end.x > 5.metres(), "{end:?}");
    }

    #[test]
    fn turns_right_in_front_of_a_wall_and_left_where_the_wall_ends() {
        assert_eq!(steer(Some(KEPT), Some(0.1.metres())), (Speed::ZERO, -TURN));
        assert_eq!(steer(Some(0.6.metres()), None), (CRUISE, CORNER));
        assert_eq!(steer(None, None), (CRUISE, CORNER));
    }

    #[test]
    fn drives_straight_at_its_distance() {
        assert_eq!(steer(Some(KEPT), None), (CRUISE, TurnRate::ZERO));
    }
}
