//! Faults of a scene, converted to timed interventions.

use crate::RobotId;
use crate::math;
use crate::noise::{Profile, Purpose, Stream, name_key};
use crate::record::Action;
use crate::spec::{FaultKind, FaultSpec, FaultTime, SlippingWheels};
use crate::time::Time;

/// Pending faults of a run: interventions in order of time.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    pending: Vec<Pending>,
    /// No fault begins or ends at this instant or later.
    until: Time,
}

/// A fault whose occurrences are drawn one after the other.
#[derive(Clone, Debug)]
struct Pending {
    fault: FaultSpec,
    /// The intervention that restores the target if no other fault acts on it; `None` for a fault that cannot end.
    end_action: Option<Action>,
    stream: Stream,
    /// The present or next occurrence; `None` if there is no other.
    episode: Option<Episode>,
    /// True if the occurrence has begun.
    has_begun: bool,
}

/// One occurrence of a fault.
#[derive(Clone, Copy, Debug)]
struct Episode {
    begin: Time,
    /// Its end, also in seconds; `None` if it lasts to the end of the run.
    end: Option<(Time, f64)>,
}

impl Faults {
    /// The faults of a run with `seed` until `until`. `noise_of` returns the initial noise models of a robot; the end
    /// of a noise fault restores them. Of several faults that act on one target (a sensor, the radio or a noise
    /// parameter of a robot) the one that began last takes effect, and the target is restored when none is left.
    ///
    /// Each fault draws its random numbers from its own stream, keyed by the seed and its name.
    pub fn new(faults: &[FaultSpec], seed: u64, until: Time, noise_of: impl Fn(RobotId) -> Profile) -> Self {
        let pending = faults.iter().map(|fault| {
            let mut stream = Stream::new(seed, RobotId(0), Purpose::Fault, 0, name_key(fault.title()));
            let begin = match fault.time {
                FaultTime::Once { at, probability } => (stream.unit() < probability).then_some(at),
                FaultTime::Random { per_minute } => Some(random_time(&mut stream, 0.0, per_minute)),
            };
            let episode = begin.map(|begin| Episode::new(fault, begin));
            let end_action = end_action(fault, &noise_of(fault.robot));
            Pending { fault: fault.clone(), end_action, stream, episode, has_begun: false }
        });
        Self { pending: pending.collect(), until }
    }

    /// Instant of the next intervention.
    pub fn next(&self) -> Option<Time> {
        self.first().map(|(at, _)| at)
    }

    /// Removes and returns the next intervention.
    pub fn pop(&mut self) -> Option<(Time, Action)> {
        let (at, index) = self.first()?;
        let pending = &mut self.pending[index];
        let action = if pending.has_begun {
            pending.end();
            let pending = &self.pending[index];
            // Of the other faults of the same target, the one that began last takes over.
            let others = self.pending.iter().filter(|other| has_same_target(&pending.fault, &other.fault));
            let active = others.filter_map(|other| Some((other.active(at)?.begin, &other.fault)));
            let heir = active.max_by_key(|(begin, _)| *begin).map(|(_, other)| begin_action(other));
            heir.or_else(|| pending.end_action.clone())?
        } else {
            pending.has_begun = true;
            begin_action(&pending.fault)
        };
        let name = self.pending[index].fault.title().to_owned();
        Some((at, Action::Fault { name, action: Box::new(action) }))
    }

    /// Instant of the next intervention, and index of its fault. Of simultaneous ones, the first fault comes first.
    fn first(&self) -> Option<(Time, usize)> {
        let instants = self.pending.iter().enumerate().filter_map(|(index, pending)| Some((pending.next()?, index)));
        instants.min().filter(|(at, _)| *at < self.until)
    }
}

impl Pending {
    /// Instant at which the fault next begins or ends.
    fn next(&self) -> Option<Time> {
        let Episode { begin, end } = self.episode?;
        if !self.has_begun {
            return Some(begin);
        }
        end.filter(|_| self.end_action.is_some()).map(|(end, _)| end)
    }

    /// Ends the present occurrence and draws the next one.
    fn end(&mut self) {
        let end = self.episode.take().and_then(|episode| episode.end);
        self.has_begun = false;
        if let (FaultTime::Random { per_minute }, Some((_, end))) = (self.fault.time, end) {
            let begin = random_time(&mut self.stream, end, per_minute);
            self.episode = Some(Episode::new(&self.fault, begin));
        }
    }

    /// The occurrence that is active right after `at`.
    fn active(&self, at: Time) -> Option<Episode> {
        self.episode.filter(|episode| episode.begin <= at && episode.end.is_none_or(|(end, _)| end > at))
    }
}

impl Episode {
    /// The occurrence of `fault` that begins `begin` seconds after the start of the run.
    fn new(fault: &FaultSpec, begin: f64) -> Self {
        let end = fault.duration.map(|duration| begin + duration);
        Self { begin: Time::from_seconds_ceil(begin), end: end.map(|end| (Time::from_seconds_ceil(end), end)) }
    }
}

/// The first instant after `since` at which a fault with this rate begins, in seconds.
fn random_time(stream: &mut Stream, since: f64, per_minute: f64) -> f64 {
    since - math::ln(1.0 - stream.unit()) * 60.0 / per_minute
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
    fn random_faults_occur_until_the_end_of_the_run() {
        let radio = fault("radio", FaultTime::Random { per_minute: 1000.0 }, Some(0.01));
        // On average, each cycle has 60 ms without the fault and 10 ms with it.
        let until = 1_000.0;
        let mut faults = Faults::new(&[radio], 7, Time::from_seconds_ceil(until), |_| Profile::default());
        let begun = 0.5 * std::iter::from_fn(|| faults.pop()).count() as f64;
        assert!((begun - until / 0.07).abs() < 4.0 * (until / 0.07).sqrt(), "{begun}");
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
