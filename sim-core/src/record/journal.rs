//! Journal: the list of a robot's events in the slot in progress.

use std::ops::Range;

use crate::RobotId;
use crate::time::Time;

use super::event::{Canonical, Event, Kind, KindSet, Record};

/// The list of one robot's events in the slot in progress. Recording an event takes a few stores and no allocation
/// once the buffers have grown.
///
/// Events are stored in their canonical form (postcard of time and event), which is hashed for the digest and decoded
/// for the observer. During a slot only the robot's thread records events. At the slot's end poses and contacts are
/// added, and [`super::Recorder::collect`] takes the events.
#[derive(Clone, Debug)]
pub struct Journal {
    robot: RobotId,
    next_sequence: u64,
    slot: SlotEvents,
    is_verbose: bool,
}

/// Events of a journal in one slot. The recorder takes the buffers while it merges the journals.
#[derive(Clone, Debug, Default)]
pub(super) struct SlotEvents {
    /// Canonical form of the events.
    events: Vec<u8>,
    /// Canonical form of the notes.
    notes: Vec<u8>,
    entries: Vec<EventPosition>,
    first_sequence: u64,
    kinds: KindSet,
}

/// Position of an event in [`SlotEvents`].
#[derive(Clone, Copy, Debug)]
pub(super) struct EventPosition {
    pub(super) time: Time,
    start: usize,
    sequence: u32,
    pub(super) kind: Kind,
}

impl Journal {
    /// The empty journal of `robot`; `is_verbose` turns the recording of calls on.
    pub fn new(robot: RobotId, is_verbose: bool) -> Self {
        Self { robot, next_sequence: 0, slot: SlotEvents::default(), is_verbose }
    }

    /// Robot of this journal.
    pub fn robot(&self) -> RobotId {
        self.robot
    }

    /// Returns true if [`Event::Call`] is recorded; otherwise callers need not format the arguments.
    pub fn is_verbose(&self) -> bool {
        self.is_verbose
    }

    /// Turns the recording of [`Event::Call`] on or off.
    pub fn set_verbose(&mut self, is_verbose: bool) {
        self.is_verbose = is_verbose;
    }

    /// Addresses of the heap memory that [`Journal::record`] writes to.
    pub(crate) fn hot_memory(&self) -> [Range<*const u8>; 2] {
        let SlotEvents { events, entries, .. } = &self.slot;
        let entries = entries.as_ptr()..entries.as_ptr().wrapping_add(entries.capacity());
        [events.as_ptr()..events.as_ptr().wrapping_add(events.capacity()), entries.start.cast()..entries.end.cast()]
    }

    /// Returns true if nothing has been recorded in this slot.
    pub fn is_empty(&self) -> bool {
        self.slot.entries.is_empty()
    }

    /// Appends `event`, which happened at virtual time `time`.
    pub fn record(&mut self, time: Time, event: &Event<'_>) {
        let kind = event.kind();
        let bytes = if kind.is_note() { &mut self.slot.notes } else { &mut self.slot.events };
        let start = bytes.len();
        // Sufficient for most events, whose fields then need no further check of the capacity.
        bytes.reserve(64);
        time.0.write(bytes);
        event.write(bytes);
        let sequence = (self.next_sequence - self.slot.first_sequence) as u32;
        self.next_sequence += u64::from(!kind.is_note());
        self.slot.entries.push(EventPosition { time, start, sequence, kind });
        self.slot.kinds = self.slot.kinds.union(kind.set());
    }

    /// Canonical form of the events in this slot, without the notes.
    pub(super) fn events(&self) -> &[u8] {
        &self.slot.events
    }

    /// The kinds recorded in this slot.
    pub(super) fn kinds(&self) -> KindSet {
        self.slot.kinds
    }

    /// Moves the events of the ended slot to `spare`, whose buffers are reused, and begins the next slot.
    pub(super) fn take_slot(&mut self, spare: &mut SlotEvents) {
        spare.clear();
        std::mem::swap(&mut self.slot, spare);
        self.begin_slot();
    }

    /// Drops the events of the ended slot and begins the next one.
    pub(super) fn clear_slot(&mut self) {
        self.slot.clear();
        self.begin_slot();
    }

    fn begin_slot(&mut self) {
        self.slot.first_sequence = self.next_sequence;
    }
}

impl SlotEvents {
    /// Empties the buffers.
    fn clear(&mut self) {
        self.events.clear();
        self.notes.clear();
        self.entries.clear();
        self.kinds = KindSet::NONE;
    }

    /// Positions of the events, in the order of recording.
    pub(super) fn entries(&self) -> &[EventPosition] {
        &self.entries
    }

    /// Decodes the event at `entry`; `robot` is the robot of the journal.
    ///
    /// # Panics
    /// If the bytes are not those that [`Journal::record`] wrote: a bug in this module.
    pub(super) fn decode(&self, robot: RobotId, entry: &EventPosition) -> Record<'_> {
        let is_note = entry.kind.is_note();
        let bytes = if is_note { &self.notes } else { &self.events };
        let ((_, event), _): ((i64, Event<'_>), _) =
            postcard::take_from_bytes(&bytes[entry.start..]).expect("a journal decodes what it encoded");
        let sequence = (!is_note).then(|| self.first_sequence + u64::from(entry.sequence));
        Record { time: entry.time, robot, sequence, event }
    }
}
