//! Journal: the list of a robot's events in the slot in progress.

use std::ops::Range;

use crate::RobotId;
use crate::time::Time;

use fearless_simd::Level;

use super::digest;
use super::event::{Canonical, Event, Kind, KindSet, Record};
use super::lanes;

/// Length of a chain value in bytes.
const CHAIN_LEN: usize = 32;

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
    is_sealed: bool,
    is_verbose: bool,
}

/// Events of a journal in one slot. The recorder takes the buffers while it merges the journals.
#[derive(Clone, Debug, Default)]
pub(super) struct SlotEvents {
    /// The chain value before the slot, followed by the canonical form of the events; the hash of all is the new chain value.
    events: Vec<u8>,
    /// Canonical form of the notes.
    notes: Vec<u8>,
    entries: Vec<EventPosition>,
    first_sequence: u64,
    pub(super) kinds: KindSet,
}

/// State of a journal after [`Journal::end_slot`].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum EndedJournal {
    /// The journal has nothing for the recorder; its next slot has begun.
    #[default]
    Empty,
    /// The journal has this new chain value and no event for the observer; its next slot has begun.
    Chain([u8; CHAIN_LEN]),
    /// The recorder must still collect the journal.
    Sealed,
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
    /// Number of journals that [`Journal::seal_all`] hashes in parallel.
    pub const LANES: usize = lanes::LANES;

    /// The empty journal of `robot`; `is_verbose` turns the recording of calls on.
    pub fn new(robot: RobotId, is_verbose: bool) -> Self {
        let mut slot = SlotEvents::default();
        slot.events.extend_from_slice(&digest::chain_start(robot));
        Self { robot, next_sequence: 0, slot, is_sealed: false, is_verbose }
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
    ///
    /// # Panics
    /// Between [`Self::seal`] and the collection by the recorder.
    pub fn record(&mut self, time: Time, event: &Event<'_>) {
        assert!(!self.is_sealed, "the journal of {} is sealed", self.robot);
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

    /// Ends the slot for this robot: computes its new chain value. A robot without events keeps its chain value.
    ///
    /// Hashing is the larger part of recording. Workers may call this method in parallel; the recorder seals the
    /// remaining journals.
    pub fn seal(&mut self) {
        self.seal_with(|events| *blake3::hash(events).as_bytes());
    }

    /// Seals each of `journals` like [`Journal::seal`], with several hashes computed in parallel (SIMD).
    pub fn seal_all<'a>(journals: impl IntoIterator<Item = &'a mut Self>) {
        let is_short = |journal: &&mut Self| journal.slot.events.len() <= lanes::MAX_LEN;
        let mut journals = journals.into_iter().filter(|journal| journal.has_events() && !journal.is_sealed);
        loop {
            let mut group: [Option<&mut Self>; lanes::LANES] = Default::default();
            group.iter_mut().zip(&mut journals).for_each(|(lane, journal)| *lane = Some(journal));
            let count = group.iter().flatten().count();
            // An unused lane takes as long as a used one, so few journals are hashed one by one.
            if 2 * count > lanes::LANES && group.iter().flatten().all(is_short) {
                let messages = group.each_ref().map(|journal| journal.as_ref().map_or(&[][..], |it| &it.slot.events));
                let chains = lanes::hash(Level::new(), &messages);
                group.into_iter().flatten().zip(&chains).for_each(|(journal, chain)| journal.seal_with(|_| *chain));
            } else {
                group.into_iter().flatten().for_each(|journal| journal.seal());
            }
            if count < lanes::LANES {
                return;
            }
        }
    }

    /// Seals the journal; `hash` computes the new chain value from the old one followed by the events.
    fn seal_with(&mut self, hash: impl FnOnce(&[u8]) -> [u8; CHAIN_LEN]) {
        if !self.is_sealed && self.has_events() {
            let chain = hash(&self.slot.events);
            self.slot.events[..CHAIN_LEN].copy_from_slice(&chain);
        }
        self.is_sealed = true;
    }

    /// Ends the slot for this robot, sealed or not, and begins the next slot unless the robot has recorded an event of a kind in
    /// `interest`.
    pub(crate) fn end_slot(&mut self, interest: KindSet) -> EndedJournal {
        if self.is_empty() {
            self.is_sealed = false;
            return EndedJournal::Empty;
        }
        self.seal();
        if self.slot.kinds.intersects(interest) {
            return EndedJournal::Sealed;
        }
        let ended = self.changed_chain().map_or(EndedJournal::Empty, |chain| EndedJournal::Chain(*chain));
        self.clear_slot();
        ended
    }

    /// Returns true if the slot has an event that is not a note.
    fn has_events(&self) -> bool {
        self.slot.events.len() > CHAIN_LEN
    }

    /// The chain value, if the sealed slot has changed it.
    pub(super) fn changed_chain(&self) -> Option<&[u8; CHAIN_LEN]> {
        if self.has_events() { self.slot.events.first_chunk() } else { None }
    }

    /// The kinds recorded in this slot.
    pub(super) fn kinds(&self) -> KindSet {
        self.slot.kinds
    }

    /// Moves the events of the ended slot to `spare`, whose buffers are reused, and begins the next slot.
    pub(super) fn take_slot(&mut self, spare: &mut SlotEvents) {
        spare.clear();
        spare.events.extend_from_slice(&self.slot.events[..CHAIN_LEN]);
        std::mem::swap(&mut self.slot, spare);
        self.begin_slot();
    }

    /// Drops the events of the ended slot and begins the next one.
    pub(super) fn clear_slot(&mut self) {
        self.slot.events.truncate(CHAIN_LEN);
        self.slot.notes.clear();
        self.slot.entries.clear();
        self.slot.kinds = KindSet::NONE;
        self.begin_slot();
    }

    fn begin_slot(&mut self) {
        self.slot.first_sequence = self.next_sequence;
        self.is_sealed = false;
    }
}

impl SlotEvents {
    /// Empties the buffers, including the chain value.
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
