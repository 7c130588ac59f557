//! Faults of a scene, converted to timed interventions.

use std::collections::VecDeque;

use crate::RobotId;
use crate::math;
use crate::noise::{Profile, Purpose, Stream, name_key};
use crate::record::Action;
use crate::spec::{FaultKind, FaultSpec, FaultTime, SlippingWheels};
use crate::time::Time;

/// Maximum number of times that a random fault begins.
const MAX_OCCURRENCES: usize = 10_000;

/// Pending faults of a run: interventions in order of time.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    actions: VecDeque<(Time, Action)>,
}

impl Faults {
    /// The faults of a run with `seed` until `until`. `noise_of` returns the initial noise models of a robot; the end
    /// of a noise fault restores them.
    ///
    /// Each fault draws its random numbers from its own stream, keyed by the seed and its name.
    pub fn new(faults: &[FaultSpec], seed: u64, until: Time, noise_of: impl Fn(RobotId) -> Profile) -> Self {
        let mut actions: Vec<(Time, Action)> = Vec::new();
        for fault in faults {
            let noise = noise_of(fault.robot);
            let mut schedule = |at: f64, is_begin: bool| {
                let at = Time::from_seconds_ceil(at);
                if let Some(action) = action(fault, &noise, is_begin).filter(|_| at < until) {
                    let name = fault.title().to_owned();
                    actions.push((at, Action::Fault { name, action: Box::new(action) }));
                }
            };
            for at in start_times(fault, seed, until.seconds()) {
                schedule(at, true);
                fault.duration.into_iter().for_each(|duration| schedule(at + duration, false));
            }
        }
        actions.sort_by_key(|(at, _)| *at);
        Self { actions: actions.into() }
    }

    /// Instant of the next intervention.
    pub fn next(&self) -> Option<Time> {
        self.actions.front().map(|(at, _)| *at)
    }

    /// Removes and returns the next intervention.
    pub fn pop(&mut self) -> Option<(Time, Action)> {
        self.actions.pop_front()
    }
}

/// Times at which `fault` begins, s.
fn start_times(fault: &FaultSpec, seed: u64, until: f64) -> Vec<f64> {
    let mut stream = Stream::new(seed, RobotId(0), Purpose::Fault, 0, name_key(fault.title()));
    match fault.time {
        FaultTime::Once { at, probability } => {
            if stream.unit() < probability {
                vec![at]
            } else {
                Vec::new()
            }
        }
        FaultTime::Random { per_minute } => {
            let mut instants = Vec::new();
            let mut at = 0.0;
            while instants.len() < MAX_OCCURRENCES {
                at -= math::ln(1.0 - stream.unit()) * 60.0 / per_minute;
                if at >= until {
                    break;
                }
                instants.push(at);
                match fault.duration {
                    Some(duration) => at += duration,
                    None => break,
                }
            }
            instants
        }
    }
}

/// The intervention with which `fault` begins or ends; `None` for the end of a fault that cannot end.
fn action(fault: &FaultSpec, noise: &Profile, is_begin: bool) -> Option<Action> {
    let robot = fault.robot.0;
    let set_noise = |parameter: &str, value: f64| {
        let initial = noise.parameters().into_iter().find(|known| known.name() == parameter);
        let value = if is_begin { value } else { initial.map_or(0.0, |known| known.value) };
        Action::SetNoise { robot: Some(robot), parameter: parameter.to_owned(), value }
    };
    Some(match &fault.kind {
        FaultKind::Dies if is_begin => Action::HaltRobot { robot },
        FaultKind::Dies => return None,
        FaultKind::SensorOff { sensor } => Action::SwitchSensor { robot, sensor: sensor.clone(), on: !is_begin },
        FaultKind::SensorStuck { sensor } => Action::StickSensor { robot, sensor: sensor.clone(), on: is_begin },
        FaultKind::Slip { wheels, share } => match wheels {
            SlippingWheels::All => set_noise("drive.slip_percent", 100.0 * share),
            // A wheel that loses a fraction of its distance moves as far as a wheel whose diameter is smaller by this
            // fraction.
            SlippingWheels::Left => set_noise("drive.left_percent", -100.0 * share),
            SlippingWheels::Right => set_noise("drive.right_percent", -100.0 * share),
        },
        FaultKind::RadioOff => Action::SwitchRadio { robot, on: !is_begin },
        FaultKind::Noise { parameter, value } => set_noise(parameter, *value),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(name: &str, time: FaultTime, duration: Option<f64>) -> FaultSpec {
        FaultSpec {
            name: name.into(),
            robot: RobotId(1),
            time,
            duration,
            kind: FaultKind::RadioOff,
            ..Default::default()
        }
    }

    fn times(faults: &[FaultSpec], seed: u64) -> Vec<(Time, bool)> {
        let mut faults = Faults::new(faults, seed, Time::from_seconds_ceil(60_000.0), |_| Profile::default());
        std::iter::from_fn(|| faults.pop())
            .map(|(at, action)| {
                let Action::Fault { action, .. } = action else { panic!("a fault") };
                (at, matches!(*action, Action::SwitchRadio { on: false, .. }))
            })
            .collect()
    }

    #[test]
    fn random_faults_occur_at_their_rate_without_overlap() {
        let radio = fault("radio", FaultTime::Random { per_minute: 2.0 }, Some(3.0));
        let times = times(std::slice::from_ref(&radio), 7);
        // On average 30 s without the fault and 3 s with it.
        let begun = times.iter().filter(|(_, is_begin)| *is_begin).count() as f64;
        assert!((begun - 60_000.0 / 33.0).abs() < 4.0 * (60_000.0_f64 / 33.0).sqrt(), "{begun}");
        assert!(times.windows(2).all(|pair| pair[0].1 != pair[1].1), "begin and end alternate");
    }

    #[test]
    fn random_times_depend_only_on_seed_and_name() {
        let named = |name| fault(name, FaultTime::Random { per_minute: 1.0 }, Some(1.0));
        let both = times(&[named("a"), named("b")], 3);
        let [a, b] = ["a", "b"].map(|name| times(&[named(name)], 3));
        assert_ne!(a, b);
        assert!(a.iter().chain(&b).all(|fault| both.contains(fault)) && both.len() == a.len() + b.len());
        assert_ne!(a, times(&[named("a")], 4));
    }

    #[test]
    fn fault_occurs_with_its_probability() {
        let rare = fault("rare", FaultTime::Once { at: 2.0, probability: 0.25 }, None);
        let count = (0..1000).filter(|seed| !times(std::slice::from_ref(&rare), *seed).is_empty()).count();
        assert!((190..310).contains(&count), "{count} of 1000 at 0.25");
    }
}
