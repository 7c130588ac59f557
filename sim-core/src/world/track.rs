//! What is public of one robot: its trajectory, as it was known at each instant of the last 100 ms.

use std::collections::VecDeque;

use glam::DVec2;

use super::{Presence, leg_at};
use crate::{
    drive::{Leg, Motion},
    pose::Pose,
    scene::Bounds,
    time::Time,
};

/// A plan made public at the start of a slot: in force until the next one.
#[derive(Clone, Debug)]
struct Publication {
    since: Time,
    /// Never empty; in the order of time.
    legs: Vec<Leg>,
}

/// The publications of one robot, and its disc.
#[derive(Clone, Debug)]
pub(super) struct Track {
    pub presence: Presence,
    radius: f64,
    /// Never empty.
    publications: VecDeque<Publication>,
    /// Of the motion's plan that was published last.
    revision: u64,
    /// Rectangle of the body in the time that the world remembers and publishes.
    bounds: Bounds,
    /// The body stays where it is, and has done so for as long as the world remembers.
    is_resting: bool,
    /// Legs that are not in use, for the next publication.
    spare: Vec<Leg>,
}

impl Track {
    /// That of a body with this motion, which is public from `from` to `until`.
    pub fn new(motion: &mut Motion, presence: Presence, (from, until): (Time, Time)) -> Self {
        let mut legs = Vec::new();
        motion.legs(from, until, &mut legs);
        let publications = VecDeque::from([Publication { since: Time(i64::MIN), legs }]);
        Self {
            presence,
            radius: motion.radius(),
            publications,
            revision: motion.revision(),
            bounds: Bounds::EMPTY,
            is_resting: false,
            spare: Vec::new(),
        }
    }

    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Centre of the body at `at`, as it was public at `at`.
    pub fn centre(&self, at: Time) -> DVec2 {
        self.leg(at).centre(at.min(self.presence.until))
    }

    /// Pose of the body at `at`, as it was public at `at`.
    pub fn pose(&self, at: Time) -> Pose {
        self.leg(at).pose(at.min(self.presence.until))
    }

    /// The leg in force at `at`, as it was public at `at`; of a body that is gone, when it left.
    fn leg(&self, at: Time) -> &Leg {
        let at = at.min(self.presence.until);
        let in_force = self.publications.iter().rposition(|publication| publication.since <= at);
        leg_at(&self.publications[in_force.unwrap_or(0)].legs, at)
    }

    /// The legs published last.
    pub fn legs(&self) -> &[Leg] {
        &self.publications.back().expect("a track has a publication").legs
    }

    /// Makes public what `motion` plans for the slot from `since` to `until`.
    pub fn publish(&mut self, motion: &mut Motion, since: Time, until: Time) {
        let mut legs = std::mem::take(&mut self.spare);
        motion.legs(since, until, &mut legs);
        if legs == self.legs() {
            self.spare = legs;
            return;
        }
        self.is_resting = false;
        let last = self.publications.back_mut().expect("a track has a publication");
        if self.revision == motion.revision() && legs.len() == 1 && last.legs.len() == 1 {
            // The same plan, seen farther ahead: its past is what it was.
            self.spare = std::mem::replace(&mut last.legs, legs);
        } else {
            self.revision = motion.revision();
            self.publications.push_back(Publication { since, legs });
        }
    }

    /// Rectangle of the body in all that is public, as of the last [`Track::refresh`].
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The body is gone from `at` on.
    pub fn end(&mut self, at: Time) {
        self.presence.until = at;
        self.is_resting = false;
    }

    /// True when the body stays where it is, as of the last [`Track::refresh`], and nothing has been published since.
    pub fn is_resting(&self) -> bool {
        self.is_resting
    }

    /// Finds the bounds of what is public from `from` to `to`, and forgets what is older. A resting track has no need, unless it is
    /// gone.
    pub fn refresh(&mut self, from: Time, to: Time) {
        if self.presence.until <= from {
            self.bounds = Bounds::EMPTY;
            self.is_resting = true;
            return;
        }
        while self.publications.len() > 1 && self.publications[1].since <= from {
            self.spare = self.publications.pop_front().expect("more than one publication").legs;
        }
        let mut bounds = Bounds::EMPTY;
        self.is_resting = self.publications.len() == 1 && self.presence.until == Time::NEVER;
        for (index, publication) in self.publications.iter().enumerate() {
            let next = self.publications.get(index + 1).map_or(to, |next| next.since);
            let (from, to) = (from.max(publication.since), to.min(next));
            if from <= to {
                bounds = bounds.union(legs_bounds(&publication.legs, from, to));
            }
            self.is_resting &=
                publication.legs.iter().all(|leg| leg.path.is_resting() || leg.elapsed(from) >= leg.after);
        }
        self.bounds = bounds.grown(self.radius);
    }
}

/// The rectangle of the centre on `legs` from `from` to `to`.
pub(super) fn legs_bounds(legs: &[Leg], from: Time, to: Time) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    for leg in legs {
        let (from, to) = (from.max(leg.start), to.min(leg.until));
        if from <= to || leg.start > from && legs.len() == 1 {
            bounds = bounds.union(leg.path.bounds(leg.elapsed(from), leg.elapsed(to)));
        }
    }
    bounds
}
