//! Cache of the robots' discs at the instant of the last query. All sensors of a robot and of its neighbours usually
//! measure at the same instant. Each disc is then computed once, and later queries read only its few bytes, not the
//! robot's track.

use std::sync::atomic::{AtomicU64, Ordering, fence};

use glam::DVec2;

use crate::{RobotId, time::Time};

/// Centre, m, and radius, m, of a robot's body at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Disc {
    pub centre: DVec2,
    pub radius: f64,
}

/// The cached disc of each robot. Robots on several threads query it at the same time.
#[derive(Debug, Default)]
pub(super) struct DiscCache {
    /// Number of changes of the published motion; an entry is valid only in its epoch.
    epoch: u64,
    entries: Vec<Entry>,
}

/// A sequence lock: `version` is odd while a thread writes.
#[derive(Debug, Default)]
struct Entry {
    version: AtomicU64,
    /// Epoch, instant, then x, y and radius as bits; the radius is NaN for a robot that is not present.
    words: [AtomicU64; 5],
}

impl Clone for DiscCache {
    /// An empty cache for as many robots.
    fn clone(&self) -> Self {
        let mut clone = Self::default();
        clone.renew(self.entries.len());
        clone
    }
}

impl DiscCache {
    /// Empties the cache after a change of the published motion, for `count` robots.
    pub fn renew(&mut self, count: usize) {
        // New entries have epoch 0, so they are invalid in all later epochs.
        self.epoch += 1;
        self.entries.resize_with(count, Entry::default);
    }

    /// The disc of `robot` at `at`; `None` if the robot is not present. If the cache has no entry for this instant,
    /// `compute` computes the disc.
    pub fn get(&self, robot: RobotId, at: Time, compute: impl FnOnce() -> Option<Disc>) -> Option<Disc> {
        let Some(entry) = self.entries.get(robot.index()) else { return compute() };
        let key = [self.epoch, at.0 as u64];
        let version = entry.version.load(Ordering::Acquire);
        let [epoch, instant, x, y, radius] = entry.words.each_ref().map(|word| word.load(Ordering::Relaxed));
        fence(Ordering::Acquire);
        let is_consistent = version % 2 == 0 && entry.version.load(Ordering::Relaxed) == version;
        if is_consistent && [epoch, instant] == key {
            let [x, y, radius] = [x, y, radius].map(f64::from_bits);
            return (!radius.is_nan()).then_some(Disc { centre: DVec2::new(x, y), radius });
        }
        let disc = compute();
        let begin =
            |version| entry.version.compare_exchange(version, version + 1, Ordering::Acquire, Ordering::Relaxed);
        // If another thread writes this entry, the cache keeps the disc of that thread.
        if is_consistent && begin(version).is_ok() {
            fence(Ordering::Release);
            let Disc { centre, radius } = disc.unwrap_or(Disc { centre: DVec2::ZERO, radius: f64::NAN });
            let [x, y, radius] = [centre.x, centre.y, radius].map(f64::to_bits);
            let [epoch, instant] = key;
            let words = [epoch, instant, x, y, radius];
            entry.words.iter().zip(words).for_each(|(word, value)| word.store(value, Ordering::Relaxed));
            entry.version.store(version + 2, Ordering::Release);
        }
        disc
    }
}

#[cfg(test)]
mod tests {
    use std::thread;

    use super::*;

    /// A disc that depends on robot and instant; absent at instant 0.
    fn disc(robot: RobotId, at: Time) -> Option<Disc> {
        let value = f64::from(robot.0) + 1e3 * at.0 as f64;
        (at != Time::ZERO).then_some(Disc { centre: DVec2::new(value, -value), radius: value + 0.5 })
    }

    #[test]
    fn a_disc_is_computed_once_for_an_instant_and_again_after_a_change() {
        let mut cache = DiscCache::default();
        cache.renew(2);
        let robot = RobotId::from_index(1);
        let known = || panic!("the disc is known");
        for at in [Time::ZERO, Time(7)] {
            assert_eq!(cache.get(robot, at, || disc(robot, at)), disc(robot, at));
            assert_eq!(cache.get(robot, at, known), disc(robot, at));
        }
        cache.renew(2);
        let moved = Some(Disc { centre: DVec2::ONE, radius: 0.1 });
        assert_eq!(cache.get(robot, Time(7), || moved), moved);
        assert_eq!(cache.clone().get(robot, Time(7), || None), None, "a clone is empty");
        assert_eq!(cache.get(robot, Time(7), known), moved);
        assert_eq!(cache.get(RobotId::from_index(5), Time(7), || moved), moved, "a robot that is not in the cache");
    }

    #[test]
    fn threads_never_read_a_torn_disc() {
        let mut cache = DiscCache::default();
        cache.renew(3);
        thread::scope(|scope| {
            for offset in 0..4 {
                let cache = &cache;
                scope.spawn(move || {
                    for round in 0..20_000_i64 {
                        let robot = RobotId::from_index((round % 3) as usize);
                        let at = Time((round / 7 + offset) % 3);
                        assert_eq!(cache.get(robot, at, || disc(robot, at)), disc(robot, at));
                    }
                });
            }
        });
    }
}
