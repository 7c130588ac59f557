//! `moving-target`: a sensor at rest measures the distance to a robot whose program changes its speed.
//!
//! The sensor measures the motion published at the start of the slot, so a command has an effect only after the slot's
//! end. The error is at most the change of speed times the slot's length, and zero in a slot without a command. The
//! method for comparison is a simulator that freezes other robots at their poses at the start of the slot; its error
//! grows with the speed, in every slot. Errors are root mean squares.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec2;
use sim_core::RobotId;
use sim_core::drive::{Command, Motion};
use sim_core::pose::{Pose, Twist};
use sim_core::scene::Walls;
use sim_core::time::Time;
use sim_core::world::{Ray, World};

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::course::model;

pub const STUDY: Study = Study {
    name: "moving-target",
    title: "Distance to a robot that changes its speed, against the length of the slot",
    run,
};

/// Slot lengths, ms.
const SLOTS_MS: [i64; 8] = [1, 2, 5, 10, 20, 50, 100, 200];
/// Interval between commands of the target; not a multiple of a slot, so that the time of commands in a slot varies.
const COMMAND_INTERVAL: Time = Time(137_731);
/// Interval between readings.
const READING_INTERVAL: Time = Time(1_003);
/// Cycle of the target's speeds, m/s.
const SPEEDS: [f64; 4] = [0.2, 0.5, -0.1, -0.6];
/// Initial distance from the sensor to the target, m.
const START_DISTANCE: f64 = 20.0;
/// Range of the sensor, m.
const RANGE: f64 = 100.0;

fn run(effort: Effort) -> Outcome {
    let duration = Time::from_millis(1_000 * effort.of(60) as i64);
    let measure = |method: &str, state: TargetState| {
        let rows = SLOTS_MS.map(|slot_ms| {
            let slot = Time::from_millis(slot_ms);
            let mut error = 0.0;
            let time_ns = nanoseconds(3, 1, || error = errors(slot, duration, state).root_mean_square());
            Row {
                study: STUDY.name,
                method: method.to_owned(),
                setting: format!("slot of {slot_ms} ms"),
                error,
                unit: "m",
                time_ns: time_ns / duration.seconds(),
                per: "simulated second",
            }
        });
        rows.to_vec()
    };
    [measure("published motion", TargetState::Published), measure("frozen at the slot's start", TargetState::Frozen)]
        .concat()
        .into()
}

/// State of the target that the sensor measures.
#[derive(Clone, Copy)]
enum TargetState {
    /// Published motion at the instant of the reading.
    Published,
    /// Pose at the start of the slot.
    Frozen,
}

/// Errors of readings, m.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    count: f64,
    squares: f64,
    largest: f64,
}

impl Errors {
    fn add(&mut self, error: f64) {
        self.count += 1.0;
        self.squares += error * error;
        self.largest = self.largest.max(error.abs());
    }

    fn root_mean_square(&self) -> f64 {
        (self.squares / self.count.max(1.0)).sqrt()
    }
}

/// Errors of the readings: each minus the true distance at the instant of the reading.
fn errors(slot: Time, duration: Time, state: TargetState) -> Errors {
    let (model, walls) = (Arc::new(model()), Arc::new(Walls::new(Vec::new())));
    let robot = |id, pose| Motion::new(RobotId(id), Arc::clone(&model), Arc::clone(&walls), pose);
    let mut sensor_robot = robot(1, Pose::new(0.0, 0.0, 0.0));
    let mut target = robot(2, Pose::new(START_DISTANCE, 0.0, PI));
    let mut world = World::new(walls, slot, [&mut sensor_robot, &mut target]);
    let mut commands =
        (0_i64..).map(|index| (Time(index * COMMAND_INTERVAL.0), SPEEDS[index as usize % SPEEDS.len()])).peekable();
    let mut readings = (0_i64..).map(|index| Time(index * READING_INTERVAL.0)).peekable();
    let mut errors = Errors::default();
    while world.slot_start() < duration {
        let (start, end) = (world.slot_start(), world.slot_end());
        while let Some((at, speed)) = commands.next_if(|(at, _)| *at < end) {
            let twist = Command::Twist(Twist::new(speed, 0.0));
            target.command(at, twist, &[]).expect("a differential drive obeys any twist");
        }
        while let Some(at) = readings.next_if(|at| *at < end) {
            let target_time = match state {
                TargetState::Published => at,
                TargetState::Frozen => start,
            };
            let hit = world.cast(RobotId(1), &Ray::flat(DVec2::ZERO, DVec2::X, RANGE), target_time);
            let measured = hit.expect("the target stays within range").distance;
            let truth = target.pose(at).position.x - model.body_radius;
            errors.add(measured - truth);
        }
        world.advance(&mut [&mut target]);
    }
    errors
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_is_bounded_by_the_change_of_speed_times_the_slot() {
        for slot_ms in [1, 20, 200] {
            let (slot, duration) = (Time::from_millis(slot_ms), Time::from_millis(5_000));
            let [published, frozen] =
                [TargetState::Published, TargetState::Frozen].map(|state| errors(slot, duration, state));
            let is_better = published.root_mean_square() < 0.7 * frozen.root_mean_square();
            assert!(is_better || slot > COMMAND_INTERVAL, "{published:?} {frozen:?}");
            let (published, frozen) = (published.largest, frozen.largest);
            // A slot of 200 ms may contain two commands, with a change from 0.5 to -0.6 m/s.
            assert!(published > 0.0 && published <= 1.1 * slot.seconds() + 1e-12, "{published} with {slot_ms} ms");
            assert!(frozen <= 0.6 * slot.seconds() + 1e-12 && frozen > 0.4 * slot.seconds(), "{frozen}");
        }
    }
}
