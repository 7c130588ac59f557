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

/// The list of one robot's events in the slot in progress. Recording an event takes a few stores, and no allocation
/// once the buffers have grown.
///
/// Events are kept in their canonical form (postcard of time and event), which the digest covers and the sinks decode.
/// While a slot runs, only the robot itself writes. At the slot's end poses and contacts are added, and
/// [`super::Recorder::collect`] takes the events.
#[derive(Clone, Debug)]
pub struct Journal {
    robot: RobotId,
    next_sequence: u64,
    page: Page,
    is_sealed: bool,
    is_verbose: bool,
}

/// Buffers of a journal, which the recorder may hold while it merges.
#[derive(Clone, Debug, Default)]
pub(super) struct Page {
    /// The chain value before the slot, followed by the canonical form of the events: hashed as a whole.
    events: Vec<u8>,
    /// Canonical form of the notes.
    notes: Vec<u8>,
    entries: Vec<Entry>,
    first_sequence: u64,
    pub(super) kinds: KindSet,
}

/// Result of the end of a slot for one journal.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum EndedJournal {
    /// The journal holds nothing for the recorder, and the next slot has begun.
    #[default]
    Empty,
    /// The journal has this new chain value and no event to show, and the next slot has begun.
    Chain([u8; CHAIN_LEN]),
    /// The recorder still has to collect the journal.
    Sealed,
}

/// Index entry of an event in its page.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) time: Time,
    start: usize,
    sequence: u32,
    pub(super) kind: Kind,
}

impl Journal {
    /// Number of journals that [`Journal::seal_all`] hashes at one time.
    pub const LANES: usize = lanes::LANES;

    /// The empty journal of `robot`; `is_verbose` turns the recording of calls on.
    pub fn new(robot: RobotId, is_verbose: bool) -> Self {
        let mut page = Page::default();
        page.events.extend_from_slice(&digest::chain_start(robot));
        Self { robot, next_sequence: 0, page, is_sealed: false, is_verbose }
    }

    /// Robot of this journal.
    pub fn robot(&self) -> RobotId {
        self.robot
    }

    /// Returns true if [`Event::Call`] is recorded; if not, callers can skip the formatting of the arguments.
    pub fn is_verbose(&self) -> bool {
        self.is_verbose
    }

    /// Turns the recording of [`Event::Call`] on or off.
    pub fn set_verbose(&mut self, is_verbose: bool) {
        self.is_verbose = is_verbose;
    }

    /// Addresses of the heap memory that [`Journal::record`] writes to.
    pub(crate) fn hot_memory(&self) -> [Range<*const u8>; 2] {
        let Page { events, entries, .. } = &self.page;
        let entries = entries.as_ptr()..entries.as_ptr().wrapping_add(entries.capacity());
        [events.as_ptr()..events.as_ptr().wrapping_add(events.capacity()), entries.start.cast()..entries.end.cast()]
    }

    /// Returns true if nothing has been recorded in this slot.
    pub fn is_empty(&self) -> bool {
        self.page.entries.is_empty()
    }

    /// Appends `event`, which happened at virtual time `time`.
    ///
    /// # Panics
    /// Between [`Self::seal`] and the collection by the recorder.
    pub fn record(&mut self, time: Time, event: &Event<'_>) {
        assert!(!self.is_sealed, "the journal of {} is sealed", self.robot);
        let kind = event.kind();
        let bytes = if kind.is_note() { &mut self.page.notes } else { &mut self.page.events };
        let start = bytes.len();
        // Enough for most events, so that their fields need no further look at the capacity.
        bytes.reserve(64);
        time.0.write(bytes);
        event.write(bytes);
        let sequence = (self.next_sequence - self.page.first_sequence) as u32;
        self.next_sequence += u64::from(!kind.is_note());
        self.page.entries.push(Entry { time, start, sequence, kind });
        self.page.kinds = self.page.kinds.union(kind.set());
    }

    /// Ends the slot for this robot: adds its events to its chain. A robot without events keeps its chain value.
    ///
    /// Hashing is the larger part of recording. Workers may call this method in parallel; the recorder seals the
    /// remaining journals.
    pub fn seal(&mut self) {
        self.seal_with(|events| *blake3::hash(events).as_bytes());
    }

    /// Ends the slot as [`Journal::seal`] does for each of `journals`, whose events are hashed side by side.
    pub fn seal_all<'a>(journals: impl IntoIterator<Item = &'a mut Self>) {
        let is_short = |journal: &&mut Self| journal.page.events.len() <= lanes::MAX_LEN;
        let mut journals = journals.into_iter().filter(|journal| journal.has_events() && !journal.is_sealed);
        loop {
            let mut few: [Option<&mut Self>; lanes::LANES] = Default::default();
            few.iter_mut().zip(&mut journals).for_each(|(slot, journal)| *slot = Some(journal));
            let count = few.iter().flatten().count();
            // Empty lanes cost as much as full ones.
            if 2 * count > lanes::LANES && few.iter().flatten().all(is_short) {
                let messages = few.each_ref().map(|journal| journal.as_ref().map_or(&[][..], |it| &it.page.events));
                let chains = lanes::hash(Level::new(), &messages);
                few.into_iter().flatten().zip(&chains).for_each(|(journal, chain)| journal.seal_with(|_| *chain));
            } else {
                few.into_iter().flatten().for_each(|journal| journal.seal());
            }
            if count < lanes::LANES {
                return;
            }
        }
    }

    /// Seals the journal; `hash` gives the hash of its events and the chain value before.
    fn seal_with(&mut self, hash: impl FnOnce(&[u8]) -> [u8; CHAIN_LEN]) {
        if !self.is_sealed && self.has_events() {
            let chain = hash(&self.page.events);
            self.page.events[..CHAIN_LEN].copy_from_slice(&chain);
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
        if self.page.kinds.intersects(interest) {
            return EndedJournal::Sealed;
        }
        let ended = self.changed_chain().map_or(EndedJournal::Empty, |chain| EndedJournal::Chain(*chain));
        self.clear_page();
        ended
    }

    /// Returns true if the slot has an event that is not a note.
    fn has_events(&self) -> bool {
        self.page.events.len() > CHAIN_LEN
    }

    /// The chain value, if the sealed slot has changed it.
    pub(super) fn changed_chain(&self) -> Option<&[u8; CHAIN_LEN]> {
        if self.has_events() { self.page.events.first_chunk() } else { None }
    }

    /// The kinds recorded in this slot.
    pub(super) fn kinds(&self) -> KindSet {
        self.page.kinds
    }

    /// Begins the next slot: swaps the buffers of the last slot with the emptied buffers of `spare`.
    pub(super) fn turn_page(&mut self, spare: &mut Page) {
        spare.clear();
        spare.events.extend_from_slice(&self.page.events[..CHAIN_LEN]);
        std::mem::swap(&mut self.page, spare);
        self.begin_slot();
    }

    /// Begins the next slot and drops the events of the last one.
    pub(super) fn clear_page(&mut self) {
        self.page.events.truncate(CHAIN_LEN);
        self.page.notes.clear();
        self.page.entries.clear();
        self.page.kinds = KindSet::NONE;
        self.begin_slot();
    }

    fn begin_slot(&mut self) {
        self.page.first_sequence = self.next_sequence;
        self.is_sealed = false;
    }
}

impl Page {
    /// Empties the buffers, including the chain value.
    fn clear(&mut self) {
        self.events.clear();
        self.notes.clear();
        self.entries.clear();
        self.kinds = KindSet::NONE;
    }

    /// Index of the events, in the order in which they were recorded.
    pub(super) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Decodes the record at `entry` of this page of `robot`.
    ///
    /// # Panics
    /// If the bytes are not what [`Journal::record`] wrote, which would be a bug in this module.
    pub(super) fn decode(&self, robot: RobotId, entry: &Entry) -> Record<'_> {
        let is_note = entry.kind.is_note();
        let bytes = if is_note { &self.notes } else { &self.events };
        let ((_, event), _): ((i64, Event<'_>), _) =
            postcard::take_from_bytes(&bytes[entry.start..]).expect("a journal decodes what it encoded");
        let sequence = (!is_note).then(|| self.first_sequence + u64::from(entry.sequence));
        Record { time: entry.time, robot, sequence, event }
    }
}
