//! Published motion of one robot, with the versions that were published in the last 100 ms.

use std::{collections::VecDeque, sync::OnceLock};

use glam::DVec2;

use super::{Lifetime, passage_at};
use crate::{
    drive::{HISTORY, Motion, Passage, Passages},
    pose::Pose,
    scene::Bounds,
    time::Time,
};

/// A plan that was published at the start of a slot and is valid until the next publication.
#[derive(Clone, Debug)]
struct Publication {
    since: Time,
    /// Passages in the order of time, never empty. If they are not known, the first query computes them from `plan`.
    passages: OnceLock<Passages>,
    /// The plan and the end of its slot, if the passages may not be known.
    plan: Option<(Box<Motion>, Time)>,
    /// Bounds of the centre while the publication was valid; set when the next publication replaces it.
    past: Bounds,
}

impl Publication {
    fn new(since: Time, passages: Passages) -> Self {
        Self { since, passages: OnceLock::from(passages), plan: None, past: Bounds::EMPTY }
    }

    fn passages(&self) -> &[Passage] {
        self.passages.get_or_init(|| {
            let mut passages = Passages::new();
            if let Some((plan, until)) = &self.plan {
                Motion::clone(plan).passages(self.since, *until, &mut passages);
            }
            passages
        })
    }
}

/// The publications of one robot, and the radius of its body.
#[derive(Clone, Debug)]
pub(super) struct Track {
    pub lifetime: Lifetime,
    /// True if the body is the only one in the world.
    pub is_alone: bool,
    radius: f64,
    /// Publications in the order of time, never empty.
    publications: VecDeque<Publication>,
    /// Revision of the motion's plan that was published last.
    revision: u64,
    /// Bounds of the body over the published history and the present slot.
    bounds: Bounds,
    /// True if the body's centre has been at rest throughout the published history; the body may turn.
    is_resting: bool,
    /// Spare memory for the next plan.
    spare_plan: Option<Box<Motion>>,
}

impl Track {
    /// Track of a body with the motion `motion`, published for the slot from `from` to `until`.
    pub fn new(motion: &mut Motion, lifetime: Lifetime, (from, until): (Time, Time)) -> Self {
        let mut passages = Passages::new();
        motion.passages(from, until, &mut passages);
        let publications = VecDeque::from([Publication::new(Time(i64::MIN), passages)]);
        Self {
            lifetime,
            is_alone: false,
            radius: motion.radius(),
            publications,
            revision: motion.revision(),
            bounds: Bounds::EMPTY,
            is_resting: false,
            spare_plan: None,
        }
    }

    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Published centre of the body at `at`.
    pub fn centre(&self, at: Time) -> DVec2 {
        self.passage(at).centre(at.min(self.lifetime.until))
    }

    /// Published pose of the body at `at`.
    pub fn pose(&self, at: Time) -> Pose {
        self.passage(at).pose(at.min(self.lifetime.until))
    }

    /// Published passage at `at`; for a removed body, the passage at its removal.
    fn passage(&self, at: Time) -> &Passage {
        let at = at.min(self.lifetime.until);
        let current = self.publications.iter().rposition(|publication| publication.since <= at);
        passage_at(self.publications[current.unwrap_or(0)].passages(), at)
    }

    /// The passages of the last publication.
    pub fn passages(&self) -> &[Passage] {
        self.publications.back().expect("a track has a publication").passages()
    }

    /// Returns true if the passages of the last publication may not be known yet; false for a removed body.
    pub fn has_plan(&self) -> bool {
        self.lifetime.until == Time::NEVER && self.publications.back().is_some_and(|last| last.plan.is_some())
    }

    /// Publishes the plan of `motion`, the only robot in the world, for the slot from `since` to `until`, without
    /// computing its passages. The passages are often never needed, because a command at the start of the slot replaces
    /// the plan. Returns false, without an effect, for a plan without ticks.
    pub fn publish_plan(&mut self, motion: &mut Motion, since: Time, until: Time) -> bool {
        let Some(plan) = motion.plan_at(since, until, &mut self.spare_plan) else { return false };
        self.drop_until(since - HISTORY);
        self.is_resting = false;
        self.revision = motion.revision();
        let last = self.publications.back_mut().expect("a track has a publication");
        if last.plan.is_none() {
            last.past = passages_bounds(last.passages(), last.since.max(since - HISTORY), since);
        }
        let plan = Some((plan, until));
        self.publications.push_back(Publication { since, passages: OnceLock::new(), plan, past: Bounds::EMPTY });
        true
    }

    /// Drops the publications that other ones have replaced before or at `from`.
    fn drop_until(&mut self, from: Time) {
        while self.publications.len() > 1 && self.publications[1].since <= from {
            let dropped = self.publications.pop_front().expect("more than one publication");
            self.spare_plan = dropped.plan.map(|(plan, _)| plan).or(self.spare_plan.take());
        }
    }

    /// Publishes the plan of `motion` for the slot from `since` to `until`.
    pub fn publish(&mut self, motion: &mut Motion, since: Time, until: Time) {
        let mut passages = Passages::new();
        motion.passages(since, until, &mut passages);
        let is_same = passages[..] == *self.passages();
        let last = self.publications.back_mut().expect("a track has a publication");
        // The passages of the last publication are known now, so its plan is not needed.
        self.spare_plan = last.plan.take().map(|(plan, _)| plan).or(self.spare_plan.take());
        if is_same {
            return;
        }
        self.is_resting = false;
        if self.revision == motion.revision()
            && let ([next], [present]) = (&passages[..], last.passages())
            && next.begin_time() == present.begin_time()
        {
            // The plan is unchanged and only its published end is later, so the new publication replaces the last one.
            last.passages = OnceLock::from(passages);
        } else {
            self.revision = motion.revision();
            last.past = passages_bounds(last.passages(), last.since.max(since - HISTORY), since);
            self.publications.push_back(Publication::new(since, passages));
        }
    }

    /// Bounds of the body during all published motion, computed by the last [`Track::refresh`].
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Ends the lifetime of the body at `at`.
    pub fn end(&mut self, at: Time) {
        self.lifetime.until = at;
        self.is_resting = false;
    }

    /// Returns true if the body's centre was at rest at the last [`Track::refresh`] and nothing has been published
    /// since.
    pub fn is_resting(&self) -> bool {
        self.is_resting
    }

    /// Computes the bounds of the published motion from `from` to `to`, and drops the publications that ended before. A
    /// track at rest needs this only after its body was removed.
    pub fn refresh(&mut self, from: Time, to: Time) {
        if self.lifetime.until <= from {
            self.bounds = Bounds::EMPTY;
            self.is_resting = true;
            return;
        }
        self.drop_until(from);
        let last = self.publications.back().expect("a track has a publication");
        let current = from.max(last.since);
        let mut bounds = if current <= to { passages_bounds(last.passages(), current, to) } else { Bounds::EMPTY };
        for (earlier, next) in self.publications.iter().zip(self.publications.iter().skip(1)) {
            let computed = |_: &_| passages_bounds(earlier.passages(), earlier.since.max(from), next.since);
            bounds = bounds.union(earlier.plan.as_ref().map_or(earlier.past, computed));
        }
        self.bounds = bounds.grown(self.radius);
        let is_at_rest = |passage: &Passage| passage.path.is_resting() || passage.has_ended(current);
        self.is_resting = self.publications.len() == 1
            && self.lifetime.until == Time::NEVER
            && last.passages().iter().all(is_at_rest);
    }
}

/// Bounds of the centre on `passages` in the time from `from` to `to`.
pub(super) fn passages_bounds(passages: &[Passage], from: Time, to: Time) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    for passage in passages {
        let (from, to) = (from.max(passage.start), to.min(passage.until));
        if from <= to || passage.start > from && passages.len() == 1 {
            bounds = bounds.union(passage.path.bounds(passage.elapsed(from), passage.elapsed(to)));
        }
    }
    bounds
}
