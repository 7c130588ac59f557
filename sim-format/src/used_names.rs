//! Names and numbers of devices of one kind in a file, for the detection of duplicates.

use std::collections::BTreeMap;

/// Names and numbers recorded so far, with their lines.
#[derive(Debug, Default)]
pub(super) struct UsedNames {
    names: BTreeMap<String, u32>,
    ids: BTreeMap<i32, u32>,
}

impl UsedNames {
    /// Line of an earlier device with this name or this number.
    pub(super) fn line_of(&self, name: &str, id: Option<i32>) -> Option<u32> {
        let by_name = self.names.get(name);
        let by_id = id.and_then(|id| self.ids.get(&id));
        [by_name, by_id].into_iter().flatten().min().copied()
    }

    /// Records a device.
    pub(super) fn add(&mut self, name: &str, id: Option<i32>, line: u32) {
        self.names.entry(name.to_owned()).or_insert(line);
        if let Some(id) = id {
            self.ids.entry(id).or_insert(line);
        }
    }
}
