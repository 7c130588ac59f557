//! Counters of events for checks: contacts, lines, events, calls, messages.

use sim_core::RobotId;
use sim_core::record::{Digest, Event, Kind, KindSet, Obstacle, Record, WORLD};
use sim_core::spec::{CheckKind, CheckSpec, CountLimits, ObstacleFilter, ProgramOutput, SceneSpec};
use sim_core::time::Time;

use super::prints::Search;
use crate::record::{RecordError, Sink};

/// Sink that counts the events of a scene's checks.
#[derive(Clone, Debug)]
pub struct Tally {
    /// Index, kind and count of each check on events.
    checks: Vec<(usize, CheckKind, Count)>,
    interest: KindSet,
}

/// Count of the events of one check.
#[derive(Clone, Debug, Default)]
pub(super) struct Count {
    /// Number of events.
    pub number: u64,
    /// Instant of the deciding event, s: the first event beyond the maximum, or the event that reaches the minimum.
    pub at: Option<f64>,
    /// Point of that event, m.
    pub position: Option<[f64; 2]>,
    /// Robot of that event.
    pub robot: Option<RobotId>,
    /// Obstacle of that event, if it is a contact.
    pub obstacle: Option<Obstacle>,
    /// Search in the lines of a program.
    pub search: Option<Search>,
}

impl Tally {
    /// Tally for the checks of `scene`; `None` if no check counts events.
    pub fn new(scene: &SceneSpec) -> Option<Self> {
        let counted = |(index, check): (usize, &CheckSpec)| {
            let interest = interest(&check.kind)?;
            let search = match &check.kind {
                CheckKind::Prints { expected, .. } => Some(Search::new(expected)),
                _ => None,
            };
            Some((interest, (index, check.kind.clone(), Count { search, ..Count::default() })))
        };
        let (kinds, checks): (Vec<KindSet>, Vec<_>) = scene.checks.iter().enumerate().filter_map(counted).unzip();
        let interest = kinds.into_iter().fold(KindSet::NONE, KindSet::union);
        (!checks.is_empty()).then_some(Self { checks, interest })
    }

    /// Returns true if a check counts calls of `id`.
    pub fn counts_calls_of(&self, id: RobotId) -> bool {
        self.checks.iter().any(|(_, kind, _)| kind.counts_calls_of(id))
    }

    /// Count of the check at `index` of the scene.
    pub(super) fn count(&self, index: usize) -> Option<&Count> {
        self.checks.iter().find(|(number, ..)| *number == index).map(|(.., count)| count)
    }
}

/// Kinds of events that decide a check of this kind; `None` for a check that does not count events.
fn interest(kind: &CheckKind) -> Option<KindSet> {
    match kind {
        CheckKind::Contacts { .. } => Some(Kind::Contact.set()),
        CheckKind::Prints { output: ProgramOutput::Stdout, .. } => Some(Kind::Stdout.set()),
        CheckKind::Event { event, .. } => Some(event.set()),
        CheckKind::Calls { .. } => Some(Kind::Call.set()),
        CheckKind::Message { .. } => Some(Kind::RadioReceived.set()),
        _ => None,
    }
}

impl Sink for Tally {
    fn interest(&self) -> KindSet {
        self.interest
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        for (_, kind, count) in &mut self.checks {
            count.update(kind, record);
        }
        Ok(())
    }

    fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
        Ok(())
    }
}

impl Count {
    fn update(&mut self, kind: &CheckKind, record: &Record<'_>) {
        let concerns = |robot: &Option<RobotId>| robot.is_none_or(|robot| robot == record.robot);
        match (kind, record.event) {
            (CheckKind::Contacts { robot, with, max }, Event::Contact { at_s, with: obstacle, x_m, y_m })
                if concerns(robot) && matches_filter(*with, obstacle) =>
            {
                self.number += 1;
                if self.number == max + 1 {
                    (self.at, self.position, self.obstacle) = (Some(at_s), Some([x_m, y_m]), Some(obstacle));
                    self.robot = Some(record.robot);
                }
            }
            (CheckKind::Prints { robot, .. }, Event::Stdout { text })
                if *robot == record.robot && self.search.as_mut().is_some_and(|search| search.take(text)) =>
            {
                self.number = 1;
                self.at = Some(record.time.seconds());
            }
            (CheckKind::Event { robot, event, count, .. }, found) if *event == found.kind() && concerns(robot) => {
                self.add(*count, record);
            }
            (CheckKind::Calls { robot, function, count }, Event::Call { function: called, .. })
                if function == called && concerns(robot) =>
            {
                self.add(*count, record);
            }
            (CheckKind::Message { from, to, text, count }, Event::RadioReceived { from: sender, data, .. }) => {
                let is_from = from.is_none_or(|from| from.0 == sender);
                let has_text = |text: &String| String::from_utf8_lossy(data).contains(text.as_str());
                if is_from && concerns(to) && text.as_ref().is_none_or(has_text) {
                    self.add(*count, record);
                }
            }
            _ => {}
        }
    }

    fn add(&mut self, limits: CountLimits, record: &Record<'_>) {
        self.number += 1;
        if self.number == limits.min || limits.max.is_some_and(|max| self.number == max + 1) {
            self.at = Some(record.time.seconds());
            self.robot = Some(record.robot).filter(|robot| *robot != WORLD);
        }
    }

    /// Returns true if the check of this kind is met.
    pub fn is_met(&self, kind: &CheckKind) -> bool {
        match kind {
            CheckKind::Contacts { max, .. } => self.number <= *max,
            CheckKind::Prints { .. } => self.search.as_ref().is_some_and(Search::is_found),
            CheckKind::Event { count, by, .. } => count.contains(self.number) && !self.is_late(*count, *by),
            CheckKind::Calls { count, .. } | CheckKind::Message { count, .. } => count.contains(self.number),
            _ => false,
        }
    }

    /// Returns true if there are more events than the maximum of this kind.
    pub fn is_too_many(&self, kind: &CheckKind) -> bool {
        let max = match kind {
            CheckKind::Contacts { max, .. } => Some(*max),
            CheckKind::Event { count, .. } | CheckKind::Calls { count, .. } | CheckKind::Message { count, .. } => {
                count.max
            }
            _ => None,
        };
        max.is_some_and(|max| self.number > max)
    }

    /// Returns true if the number is within the limits, but the minimum was reached only after `by`.
    pub fn is_late(&self, count: CountLimits, by: Option<Time>) -> bool {
        let is_enough = count.min > 0 && count.contains(self.number);
        is_enough && by.zip(self.at).is_some_and(|(by, at)| at > by.seconds())
    }
}

fn matches_filter(filter: ObstacleFilter, obstacle: Obstacle) -> bool {
    match filter {
        ObstacleFilter::Anything => true,
        ObstacleFilter::Walls => matches!(obstacle, Obstacle::Wall | Obstacle::Terrain),
        ObstacleFilter::Robots => matches!(obstacle, Obstacle::Robot(_)),
        ObstacleFilter::Objects => matches!(obstacle, Obstacle::Object(_)),
    }
}
