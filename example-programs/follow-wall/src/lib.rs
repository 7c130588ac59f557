//! Follows the wall at its left at a distance of 0.2 m, for ever: turns away from walls ahead and around corners.

use robios_api::prelude::*;

robios_api::program!(main);

/// The distance that it keeps to the wall.
const KEPT: Length = Length::metres(0.2);
const CRUISE: Speed = Speed::metres_per_second(0.2);
/// The fastest turn.
const TURN: TurnRate = TurnRate::radians_per_second(1.2);

fn main(robot: &Robot) -> Result {
    let drive = robot.drive()?;
    let [left, front] = robot.psds([PsdAt::Left, PsdAt::Front])?;
    let ticker = robot.ticker(50.millis());
    let mut last = None;
    loop {
        let (forward, turn) = steer(left.distance(), front.distance(), last);
        drive.set_speed(forward, turn)?;
        last = left.distance();
        ticker.wait();
    }
}

/// Speed and rate of turn for what the sensors see now, and the left one saw a period before.
fn steer(left: Option<Length>, front: Option<Length>, last: Option<Length>) -> (Speed, TurnRate) {
    if front.is_some_and(|front| front < KEPT * 1.25) {
        return (Speed::ZERO, -TURN);
    }
    // Nothing at the left: the wall has ended, or it is an outer corner. Around it.
    let Some(left) = left.filter(|left| *left < KEPT * 2.5) else { return (CRUISE, TURN * 0.5) };
    // Towards the wall if it is too far, and against the change of the distance.
    let change = last.map_or(Length::ZERO, |last| left - last);
    let push = (left - KEPT) / KEPT + 25.0 * (change / KEPT);
    (CRUISE, TURN * push.clamp(-1.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use robios_api::fake::Fake;

    #[test]
    fn comes_to_the_distance_along_a_straight_wall() {
        // The wall is at y = 0.3 m; the sensor looks along the robot's y axis.
        let run = Fake::new()
            .psd(PsdAt::Left, |now| {
                let slope = now.position.phi.cos();
                (slope > 0.1).then(|| (0.3.metres() - now.position.y) / slope).filter(|left| *left < 1.metres())
            })
            .psd(PsdAt::Front, |_| None)
            .until(30.seconds())
            .run(main)
            .expect_time_up();
        let end = run.position();
        assert!((end.y - 0.1.metres()).abs() < 10.millimetres(), "{end:?}");
        assert!(end.phi.abs() < 5.degrees() && end.x > 5.metres(), "{end:?}");
    }

    #[test]
    fn turns_right_in_front_of_a_wall_and_left_where_the_wall_ends() {
        assert_eq!(steer(Some(KEPT), Some(0.1.metres()), None), (Speed::ZERO, -TURN));
        let (forward, turn) = steer(None, None, None);
        assert!(forward > Speed::ZERO && turn > TurnRate::ZERO);
    }

    #[test]
    fn drives_straight_at_the_right_distance() {
        assert_eq!(steer(Some(KEPT), None, Some(KEPT)), (CRUISE, TurnRate::ZERO));
    }
}
