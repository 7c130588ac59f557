//! Drives about at random and avoids obstacles, forever: reads eight PSD sensors and sets its speed every 50 ms.

use robios_api::prelude::*;

robios_api::program!(main);

/// Control period.
const PERIOD: Duration = Duration::from_millis(50);
/// The sensors: from the left through the front to the right, then the back.
const SENSORS: [PsdAt; 8] = [
    PsdAt::Left,
    PsdAt::LeftDiagonal,
    PsdAt::FrontLeft,
    PsdAt::Front,
    PsdAt::FrontRight,
    PsdAt::RightDiagonal,
    PsdAt::Right,
    PsdAt::Back,
];
/// Readings beyond this distance count as free space.
const MAX_DISTANCE: Length = Length::metres(2.0);
/// Free distance ahead below which the robot turns on the spot.
const NEAR: Length = Length::metres(0.25);
/// Number of periods for which the robot keeps a random curve when nothing is near.
const CURVE_PERIODS: u32 = 40;
const CRUISE: Speed = Speed::metres_per_second(0.3);
const TURN: TurnRate = TurnRate::radians_per_second(1.5);

fn main(robot: &Robot) -> Result {
    let drive = robot.drive()?;
    let sensors = robot.psds(SENSORS)?;
    let ticker = robot.ticker(PERIOD);
    let mut state = State::Cruise { curve: TurnRate::ZERO, left: 0 };
    loop {
        let distances = sensors.each_ref().map(|psd| psd.distance().unwrap_or(MAX_DISTANCE).min(MAX_DISTANCE));
        state = state.next(&distances, robot);
        let (forward, turn) = state.command(&distances);
        drive.set_speed(forward, turn)?;
        ticker.wait();
    }
}

/// State of the behaviour.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// Drives along a curve for `left` more periods.
    Cruise { curve: TurnRate, left: u32 },
    /// Turns on the spot until the way is free.
    Turn { rate: TurnRate },
}

impl State {
    fn next(self, distances: &[Length; 8], robot: &Robot) -> Self {
        let ahead = ahead(distances);
        match self {
            Self::Turn { .. } if ahead < NEAR * 1.5 => self,
            Self::Cruise { .. } if ahead < NEAR => Self::Turn { rate: away(distances, robot) },
            Self::Cruise { curve, left: left @ 1.. } => Self::Cruise { curve, left: left - 1 },
            _ => Self::Cruise { curve: robot.random().within(TURN * -0.4..TURN * 0.4), left: CURVE_PERIODS },
        }
    }

    /// Forward speed and turn rate in this state.
    fn command(self, distances: &[Length; 8]) -> (Speed, TurnRate) {
        match self {
            // Slower towards an obstacle: full speed at four times `NEAR`.
            Self::Cruise { curve, .. } => (CRUISE * (ahead(distances) / (NEAR * 4.0)).min(1.0), curve),
            Self::Turn { rate } => (Speed::ZERO, rate),
        }
    }
}

/// Free distance ahead.
fn ahead(distances: &[Length; 8]) -> Length {
    let [_, left_diagonal, front_left, front, front_right, right_diagonal, _, _] = *distances;
    // A diagonal reading of 1 m leaves as much room as 1.4 m ahead: obstacles there are partly beside the way.
    front.min(front_left).min(front_right).min(left_diagonal * 1.4).min(right_diagonal * 1.4)
}

/// Turn rate to the side with more room; a random side if both have the same.
fn away(distances: &[Length; 8], robot: &Robot) -> TurnRate {
    let room = |side: &[Length]| side.iter().fold(Length::ZERO, |sum, distance| sum + *distance);
    let (left, right) = (room(&distances[..3]), room(&distances[4..7]));
    let is_left = if left == right { robot.random().flip() } else { left > right };
    if is_left { TURN } else { -TURN }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robios_api::fake::{Fake, Run};

    /// Directions of the sensors of the robot `ring`, in the order of [`SENSORS`].
    const DIRECTIONS_DEG: [i32; 8] = [90, 45, 20, 0, -20, -45, -90, 180];

    /// A robot in a free plane with a single wall at x = 1 m.
    fn drive_at_a_wall(seed: u64) -> Run {
        let mut fake = Fake::new().seed(seed).until(20.seconds());
        for (at, direction_deg) in SENSORS.into_iter().zip(DIRECTIONS_DEG) {
            fake = fake.psd(at, move |now| {
                let cosine = (now.position.phi + direction_deg.degrees()).cos();
                (cosine > 0.01)
                    .then(|| (1.metres() - now.position.x) / cosine)
                    .filter(|distance| *distance < MAX_DISTANCE)
            });
        }
        fake.run(main).expect_time_up()
    }

    #[test]
    fn keeps_clear_of_a_wall() {
        for seed in 0..5 {
            let run = drive_at_a_wall(seed);
            assert!(run.position().x < 0.95.metres(), "seed {seed}: {:?}", run.position());
        }
    }

    #[test]
    fn sets_its_speed_every_50_ms() {
        let run = drive_at_a_wall(1);
        // 20 s, less the first cycle of the sensors.
        assert!((395..=400).contains(&run.calls_of("VWSetSpeed").count()));
        let times: Vec<Duration> = run.calls_of("sleep_us").skip(20).take(3).map(|call| call.time).collect();
        assert!(times.iter().all(|time| time.as_micros().is_multiple_of(50_000)), "{times:?}");
    }

    #[test]
    fn turns_are_a_function_of_the_seed() {
        assert_eq!(drive_at_a_wall(7).position(), drive_at_a_wall(7).position());
        assert_ne!(drive_at_a_wall(7).position(), drive_at_a_wall(8).position());
    }
}
