//! Lines of programs at which hints were given: shown to users, not part of the record and its digest.

use std::collections::BTreeMap;
use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::RobotId;

/// Lines of programs by robot and text of the hint that was given there. A run notes them; its sinks show them.
#[derive(Clone, Debug, Default)]
pub struct HintPlaces(Arc<Mutex<BTreeMap<RobotId, BTreeMap<String, String>>>>);

/// Maximum number of hints whose lines are kept for a robot.
const MAX_PLACES: usize = 200;

impl HintPlaces {
    /// Notes that the program of `robot` was given the hint `text` at `place`, such as `maze.c:12`; the first place counts.
    pub(crate) fn note(&self, robot: RobotId, text: &str, place: String) {
        let mut robots = self.0.lock();
        let places = robots.entry(robot).or_default();
        if places.len() < MAX_PLACES && !places.contains_key(text) {
            places.insert(text.to_owned(), place);
        }
    }

    /// The line of the program of `robot` at which it was given the hint `text`; `None` if the line is not known.
    pub fn of(&self, robot: RobotId, text: &str) -> Option<String> {
        self.0.lock().get(&robot)?.get(text).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_place_of_a_hint_counts() {
        let places = HintPlaces::default();
        places.note(RobotId(1), "a", "maze.c:1".to_owned());
        places.note(RobotId(1), "a", "maze.c:2".to_owned());
        assert_eq!(places.of(RobotId(1), "a").as_deref(), Some("maze.c:1"));
        assert_eq!(places.of(RobotId(2), "a"), None);
        for number in 0..2 * MAX_PLACES {
            places.note(RobotId(2), &number.to_string(), "maze.c:1".to_owned());
        }
        assert!(places.of(RobotId(2), "0").is_some() && places.of(RobotId(2), "399").is_none());
    }
}
