//! Source lines of programs to which hints refer; shown to users, but not part of the record and its digest.

use std::collections::BTreeMap;
use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::RobotId;

/// Source lines of programs to which hints refer, by robot and text of the hint. A run adds them; its sinks show them.
#[derive(Clone, Debug, Default)]
pub struct HintLocations(Arc<Mutex<BTreeMap<RobotId, BTreeMap<String, String>>>>);

/// Maximum number of lines that are stored for a robot.
const MAX_LOCATIONS: usize = 200;

impl HintLocations {
    /// Stores that the hint `text` for the program of `robot` refers to `location`, such as `maze.c:12`. A stored
    /// location is not replaced.
    pub(crate) fn note(&self, robot: RobotId, text: &str, location: String) {
        let mut robots = self.0.lock();
        let locations = robots.entry(robot).or_default();
        if locations.len() < MAX_LOCATIONS && !locations.contains_key(text) {
            locations.insert(text.to_owned(), location);
        }
    }

    /// Source line to which the hint `text` for the program of `robot` refers; `None` if unknown.
    pub fn of(&self, robot: RobotId, text: &str) -> Option<String> {
        self.0.lock().get(&robot)?.get(text).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_location_of_a_hint_is_kept() {
        let locations = HintLocations::default();
        locations.note(RobotId(1), "a", "maze.c:1".to_owned());
        locations.note(RobotId(1), "a", "maze.c:2".to_owned());
        assert_eq!(locations.of(RobotId(1), "a").as_deref(), Some("maze.c:1"));
        assert_eq!(locations.of(RobotId(2), "a"), None);
        for number in 0..2 * MAX_LOCATIONS {
            locations.note(RobotId(2), &number.to_string(), "maze.c:1".to_owned());
        }
        assert!(locations.of(RobotId(2), "0").is_some() && locations.of(RobotId(2), "399").is_none());
    }
}
