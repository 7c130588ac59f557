//! A sensing task beside a control task: the first measures periodically; the second waits on a semaphore for each
//! measurement and steers by it. The robot drives about for a minute and avoids all obstacles.

use robios_api::prelude::*;
use robios_api::{Priority, Semaphore, Shared, TaskMode};

robios_api::program!(main);

/// A cycle of the sensors.
const PERIOD: Duration = Duration::from_millis(60);
const SPEED: Speed = Speed::metres_per_second(0.3);
const RATE: TurnRate = TurnRate::radians_per_second(2.0);
/// Free distance below which the robot turns on the spot.
const NEAR: Length = Length::millimetres(220.0);
const FAR: Length = Length::millimetres(600.0);

/// State shared by both tasks.
#[derive(Clone, Copy, Default)]
struct Measurements {
    /// Distances from left to right, [`FAR`] at most.
    distances: [Length; 5],
    measurements: u32,
    commands: u32,
}

fn main(robot: &Robot) -> Result {
    let tasks = robot.multi_tasking(TaskMode::Preemptive)?;
    let latest = tasks.shared(Measurements::default())?;
    let measured = tasks.semaphore(0)?;

    let (to_tell, done) = (latest.clone(), measured.clone());
    tasks.spawn("sense", Priority::P4, move |robot| sense(robot, &to_tell, &done))?.ready(robot)?;
    let to_ask = latest.clone();
    tasks.spawn("steer", Priority::P5, move |robot| steer(robot, &to_ask, &measured))?.ready(robot)?;
    tasks.permit()?;

    tasks.sleep(60.seconds())?;
    let Measurements { measurements, commands, .. } = latest.get(robot);
    writeln!(robot.console(), "{measurements} measurements, {commands} commands");
    Ok(())
}

fn sense(robot: &Robot, latest: &Shared<Measurements>, measured: &Semaphore) -> Result {
    let mounts = [PsdAt::LeftDiagonal, PsdAt::FrontLeft, PsdAt::Front, PsdAt::FrontRight, PsdAt::RightDiagonal];
    let psds = robot.psds(mounts)?;
    loop {
        let distances = psds.each_ref().map(|psd| psd.distance().unwrap_or(FAR).min(FAR));
        {
            let mut latest = latest.lock(robot);
            latest.distances = distances;
            latest.measurements += 1;
        }
        measured.signal(robot);
        robot.tasks().sleep(PERIOD)?;
    }
}

fn steer(robot: &Robot, latest: &Shared<Measurements>, measured: &Semaphore) -> Result {
    let drive = robot.drive()?;
    let mut side = 1.0;
    loop {
        measured.wait(robot);
        let [left_diagonal, front_left, front, front_right, right_diagonal] = latest.get(robot).distances;
        let (left, right) = (left_diagonal.min(front_left), right_diagonal.min(front_right));
        let ahead = front.min(front_left).min(front_right);
        if ahead < NEAR {
            drive.set_speed(0.metres_per_second(), side * RATE)?;
        } else {
            // The side with more room, kept until the way is free.
            side = if left < right { -1.0 } else { 1.0 };
            drive.set_speed(SPEED * (ahead.min(left + right) / FAR), RATE * ((left - right) / FAR))?;
        }
        latest.lock(robot).commands += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robios_api::fake::Fake;

    /// A wall ahead, and more room at the right.
    #[test]
    fn it_turns_before_a_wall() {
        let ahead = |now: &robios_api::fake::Moment| Some(1.5.metres() - now.position.x);
        let fake = Fake::new().until(70.seconds()).psd(PsdAt::Front, ahead).psd(PsdAt::FrontLeft, ahead);
        let fake = fake.psd(PsdAt::LeftDiagonal, |_| Some(500.millimetres())).psd(PsdAt::FrontRight, |_| None);
        let run = fake.psd(PsdAt::RightDiagonal, |_| None).run(main).expect_finished();
        assert!(run.position().x < 1.5.metres() - 150.millimetres(), "{:?}", run.position());
        assert!(run.position().phi < 0.degrees(), "to the right");
        let counts: Vec<u32> = run.console().split(' ').filter_map(|word| word.parse().ok()).collect();
        assert!(matches!(counts[..], [measurements, commands] if measurements - commands < 2 && commands > 800));
    }
}
