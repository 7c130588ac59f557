//! Names and numbers that a file has given to devices of one kind, to find those given twice.

use std::collections::BTreeMap;

/// What has been given so far, with the lines.
#[derive(Debug, Default)]
pub(super) struct Given {
    names: BTreeMap<String, u32>,
    ids: BTreeMap<i32, u32>,
}

impl Given {
    /// The line that has given this name or this number before.
    pub(super) fn line_of(&self, name: &str, id: Option<i32>) -> Option<u32> {
        let by_name = self.names.get(name);
        let by_id = id.and_then(|id| self.ids.get(&id));
        [by_name, by_id].into_iter().flatten().min().copied()
    }

    /// Remembers a device.
    pub(super) fn add(&mut self, name: &str, id: Option<i32>, line: u32) {
        self.names.entry(name.to_owned()).or_insert(line);
        if let Some(id) = id {
            self.ids.entry(id).or_insert(line);
        }
    }
}
