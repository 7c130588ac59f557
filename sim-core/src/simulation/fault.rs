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
    /// of a noise fault restores them. Of several faults that act on one target (a sensor, the radio or a noise
    /// parameter of a robot) the one that began last takes effect, and the target is restored when none is left.
    ///
    /// Each fault draws its random numbers from its own stream, keyed by the seed and its name.
    pub fn new(faults: &[FaultSpec], seed: u64, until: Time, noise_of: impl Fn(RobotId) -> Profile) -> Self {
        let episodes: Vec<Vec<Episode>> = faults.iter().map(|fault| episodes(fault, seed, until)).collect();
        let mut actions: Vec<(Time, Action)> = Vec::new();
        for (fault, own) in faults.iter().zip(&episodes) {
            let noise = noise_of(fault.robot);
            let end_without_others = end_action(fault, &noise);
            let mut schedule = |at: Time, action: Option<Action>| {
                if let Some(action) = action.filter(|_| at < until) {
                    let name = fault.title().to_owned();
                    actions.push((at, Action::Fault { name, action: Box::new(action) }));
                }
            };
            for episode in own {
                schedule(episode.begin, Some(begin_action(fault)));
                let Some(end) = episode.end else { continue };
                // Of the other faults of the same target, the one that began last takes over.
                let others = faults.iter().zip(&episodes).filter(|(other, _)| has_same_target(fault, other));
                let active = others.filter_map(|(other, all)| Some((last_active(all, end)?.begin, other)));
                let heir = active.max_by_key(|(begin, _)| *begin).map(|(_, other)| begin_action(other));
                schedule(end, heir.or_else(|| end_without_others.clone()));
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

/// Instants at which `fault` begins, s.
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

/// One occurrence of a fault.
struct Episode {
    begin: Time,
    /// `None` if it lasts to the end of the run.
    end: Option<Time>,
}

/// The occurrences of `fault` in order of time; they do not overlap.
fn episodes(fault: &FaultSpec, seed: u64, until: Time) -> Vec<Episode> {
    let instant = Time::from_seconds_ceil;
    let episode = |at: f64| Episode { begin: instant(at), end: fault.duration.map(|duration| instant(at + duration)) };
    start_times(fault, seed, until.seconds()).into_iter().map(episode).collect()
}

/// The episode of a fault that is active right after `at`.
fn last_active(episodes: &[Episode], at: Time) -> Option<&Episode> {
    let begun = episodes.partition_point(|episode| episode.begin <= at);
    episodes[..begun].last().filter(|last| last.end.is_none_or(|end| end > at))
}

/// Returns true if two faults act on the same sensor, radio or noise parameter of a robot.
fn has_same_target(fault: &FaultSpec, other: &FaultSpec) -> bool {
    let is_same_kind = match (begin_action(fault), begin_action(other)) {
        (Action::SetNoise { parameter, .. }, Action::SetNoise { parameter: other, .. }) => parameter == other,
        (Action::SwitchSensor { sensor, .. }, Action::SwitchSensor { sensor: other, .. })
        | (Action::StickSensor { sensor, .. }, Action::StickSensor { sensor: other, .. }) => sensor == other,
        (Action::SwitchRadio { .. }, Action::SwitchRadio { .. }) => true,
        _ => false,
    };
    is_same_kind && fault.robot == other.robot
}

/// The intervention with which `fault` begins.
fn begin_action(fault: &FaultSpec) -> Action {
    let robot = fault.robot.0;
    let set_noise =
        |parameter: &str, value| Action::SetNoise { robot: Some(robot), parameter: parameter.to_owned(), value };
    match &fault.kind {
        FaultKind::Dies => Action::HaltRobot { robot },
        FaultKind::SensorOff { sensor } => Action::SwitchSensor { robot, sensor: sensor.clone(), on: false },
        FaultKind::SensorStuck { sensor } => Action::StickSensor { robot, sensor: sensor.clone(), on: true },
        FaultKind::Slip { wheels, share } => match wheels {
            SlippingWheels::All => set_noise("drive.slip_percent", 100.0 * share),
            // A wheel that loses a fraction of its distance moves as far as a wheel whose diameter is smaller by this
            // fraction.
            SlippingWheels::Left => set_noise("drive.left_percent", -100.0 * share),
            SlippingWheels::Right => set_noise("drive.right_percent", -100.0 * share),
        },
        FaultKind::RadioOff => Action::SwitchRadio { robot, on: false },
        FaultKind::Noise { parameter, value } => set_noise(parameter, *value),
    }
}

/// The intervention that restores the target of `fault`, with the robot's initial `noise`; `None` for a fault that
/// cannot end.
fn end_action(fault: &FaultSpec, noise: &Profile) -> Option<Action> {
    Some(match begin_action(fault) {
        Action::SwitchSensor { robot, sensor, .. } => Action::SwitchSensor { robot, sensor, on: true },
        Action::StickSensor { robot, sensor, .. } => Action::StickSensor { robot, sensor, on: false },
        Action::SwitchRadio { robot, .. } => Action::SwitchRadio { robot, on: true },
        Action::SetNoise { robot, parameter, .. } => {
            let initial = noise.parameters().into_iter().find(|known| known.name() == parameter);
            Action::SetNoise { robot, parameter, value: initial.map_or(0.0, |known| known.value) }
        }
        _ => return None,
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
        // On average, each cycle has 30 s without the fault and 3 s with it.
        let begun = times.iter().filter(|(_, is_begin)| *is_begin).count() as f64;
        assert!((begun - 60_000.0 / 33.0).abs() < 4.0 * (60_000.0_f64 / 33.0).sqrt(), "{begun}");
        assert!(times.windows(2).all(|pair| pair[0].1 != pair[1].1), "begin and end alternate");
    }

    #[test]
    fn random_times_depend_only_on_seed_and_name() {
        // Each fault acts on another robot, because overlapping faults of one radio would end together.
        let named = |name: &str| FaultSpec {
            robot: RobotId(if name == "a" { 1 } else { 2 }),
            ..fault(name, FaultTime::Random { per_minute: 1.0 }, Some(1.0))
        };
        let both = times(&[named("a"), named("b")], 3);
        let [a, b] = ["a", "b"].map(|name| times(&[named(name)], 3));
        assert_ne!(a, b);
        assert!(a.iter().chain(&b).all(|fault| both.contains(fault)) && both.len() == a.len() + b.len());
        assert_ne!(a, times(&[named("a")], 4));
    }

    #[test]
    fn a_target_is_restored_when_its_last_fault_ends() {
        let noise = |name: &str, at: f64, duration, value| FaultSpec {
            kind: FaultKind::Noise { parameter: "psd.sigma_mm".into(), value },
            ..fault(name, FaultTime::Once { at, probability: 1.0 }, duration)
        };
        let elsewhere = FaultSpec { robot: RobotId(2), ..noise("d", 0.0, None, 50.0) };
        let all =
            [noise("a", 1.0, Some(4.0), 10.0), noise("b", 2.0, Some(1.0), 20.0), noise("c", 4.0, Some(3.0), 30.0)];
        let values = |faults: &[FaultSpec]| {
            let mut faults = Faults::new(faults, 1, Time::from_seconds_ceil(60.0), |_| Profile::default());
            std::iter::from_fn(|| faults.pop())
                .map(|(at, action)| {
                    let Action::Fault { action, .. } = action else { panic!("a fault") };
                    let Action::SetNoise { value, .. } = *action else { panic!("a noise") };
                    (at.seconds(), value)
                })
                .collect::<Vec<_>>()
        };
        let expected = [(1.0, 10.0), (2.0, 20.0), (3.0, 10.0), (4.0, 30.0), (5.0, 30.0), (7.0, 0.0)];
        assert_eq!(values(&all), expected);
        assert_eq!(values(&[&all[..], &[elsewhere]].concat())[1..], expected);
        // The second fault begins at the instant at which the first one ends, in either order of the file.
        let pair = [noise("a", 1.0, Some(1.0), 10.0), noise("b", 2.0, Some(1.0), 20.0)];
        let reversed = [pair[1].clone(), pair[0].clone()];
        let expected = [(1.0, 10.0), (2.0, 20.0), (2.0, 20.0), (3.0, 0.0)];
        assert_eq!(values(&pair), expected);
        assert_eq!(values(&reversed), expected);
    }

    #[test]
    fn fault_occurs_with_its_probability() {
        let rare = fault("rare", FaultTime::Once { at: 2.0, probability: 0.25 }, None);
        let count = (0..1000).filter(|seed| !times(std::slice::from_ref(&rare), *seed).is_empty()).count();
        assert!((190..310).contains(&count), "{count} of 1000 at 0.25");
    }
}
