//! Recorder: merges the robots' journals at the end of each slot and computes the run's digest.

use super::digest::{Digest, RunDigest};
use super::event::{KindSet, Record};
use super::journal::{EventPosition, Journal, SlotEvents};
use crate::RobotId;
use crate::time::Time;

/// Recorder of a run: merges the journals of a slot and computes the digest.
///
/// At each slot's end, call [`Self::collect`] for the robots that may have recorded events, in order of their ids, then
/// [`Self::end_slot`].
#[derive(Clone, Debug)]
pub struct Recorder {
    digest: RunDigest,
    interest: KindSet,
    /// Events of the robots in this slot (the first `used` elements), followed by unused buffers.
    collected: Vec<(RobotId, SlotEvents)>,
    used: usize,
    order: Vec<MergedEntry>,
}

/// Position of an event in the merged order.
#[derive(Clone, Copy, Debug)]
struct MergedEntry {
    time: Time,
    robot_index: u32,
    entry: u32,
}

impl Recorder {
    /// Recorder of a run with `seed` and slots of length `slot`, before the first slot. The observer gets the events of
    /// the kinds in `interest`.
    pub fn new(seed: u64, slot: Time, interest: KindSet) -> Self {
        Self { digest: RunDigest::new(seed, slot), interest, collected: Vec::new(), used: 0, order: Vec::new() }
    }

    /// Sets the kinds of events that the observer gets, from this slot on.
    pub fn set_interest(&mut self, interest: KindSet) {
        self.interest = interest;
    }

    /// Takes the events of `journal` in this slot and begins the journal's next slot. Must be called in the order of
    /// the robots' ids; robots without events may be skipped.
    pub fn collect(&mut self, journal: &mut Journal) {
        if journal.is_empty() {
            return;
        }
        if !journal.events().is_empty() {
            self.digest.add(journal.robot(), journal.events());
        }
        if !journal.kinds().intersects(self.interest) {
            journal.clear_slot();
            return;
        }
        if self.used == self.collected.len() {
            self.collected.push((journal.robot(), SlotEvents::default()));
        }
        let (robot, events) = &mut self.collected[self.used];
        *robot = journal.robot();
        journal.take_slot(events);
        let is_of_interest = |(_, entry): &(usize, &EventPosition)| self.interest.contains(entry.kind);
        let merged_entry = |(index, entry): (usize, &EventPosition)| MergedEntry {
            time: entry.time,
            robot_index: self.used as u32,
            entry: index as u32,
        };
        self.order.extend(events.entries().iter().enumerate().filter(is_of_interest).map(merged_entry));
        self.used += 1;
    }

    /// Ends the slot: passes the collected events of interest to `observe`, in order of (virtual time, robot,
    /// sequence). Returns true if the slot has changed the digest.
    ///
    /// # Errors
    /// The first error of `observe`, which then does not get the remaining events of the slot.
    pub fn end_slot<E>(&mut self, end: Time, mut observe: impl FnMut(&Record<'_>) -> Result<(), E>) -> Result<bool, E> {
        let has_changed = self.digest.end_slot(end);
        // The robots are in the order of their ids, the entries of a robot in the order of recording.
        self.order.sort_unstable_by_key(|entry| (entry.time, entry.robot_index, entry.entry));
        self.used = 0;
        for entry in self.order.drain(..) {
            let (robot, events) = &self.collected[entry.robot_index as usize];
            observe(&events.decode(*robot, &events.entries()[entry.entry as usize]))?;
        }
        Ok(has_changed)
    }

    /// Digest of the run up to the last ended slot. Must not be called between [`Self::collect`] and
    /// [`Self::end_slot`].
    pub fn digest(&self) -> Digest {
        self.digest.value()
    }

    /// Returns [`Self::digest`]; faster than this function if the digest is needed after each slot.
    pub fn update_digest(&mut self) -> Digest {
        self.digest.update_value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    use crate::record::event::{Event, Kind, Obstacle};

    /// Output of a run: the JSON of its records, and the digest after each slot.
    #[derive(Default)]
    struct RunOutput(Vec<String>, Vec<Option<Digest>>);

    fn end_slot(recorder: &mut Recorder, end: Time, output: &mut RunOutput) {
        let observe = |record: &Record<'_>| -> Result<(), Infallible> {
            output.0.push(serde_json::to_string(record).unwrap());
            Ok(())
        };
        let Ok(has_changed) = recorder.end_slot(end, observe);
        output.1.push(has_changed.then(|| recorder.digest()));
    }

    const SLOT: Time = Time::from_millis(50);

    /// Records two slots of two robots; `order` is the order in which their "threads" run.
    fn run(order: [usize; 2], is_verbose: bool, interest: KindSet) -> (Digest, RunOutput) {
        let mut journals = [1, 2].map(|id| Journal::new(RobotId(id), is_verbose));
        let mut recorder = Recorder::new(7, SLOT, interest);
        let mut output = RunOutput::default();
        for slot in 0..2 {
            let begin = Time(50_000 * slot);
            for robot in order {
                let journal = &mut journals[robot];
                if journal.is_verbose() {
                    journal.record(begin, &Event::Call { function: "KEYRead", arguments: "", result: "0" });
                }
                journal.record(begin + Time(100 * robot as i64), &Event::Reading { device: "ENCODER", value: slot });
                journal.record(begin + Time(100), &Event::DriveSpeed { v_m_per_s: 0.1 + 0.2, omega_rad_per_s: -0.0 });
            }
            let (x_m, y_m) = (0.5, 0.25);
            let contact = Event::Contact { at_s: begin.seconds(), with: Obstacle::Robot(1), x_m, y_m };
            journals[1].record(begin, &contact);
            journals.iter_mut().for_each(|journal| recorder.collect(journal));
            end_slot(&mut recorder, begin + SLOT, &mut output);
        }
        (recorder.digest(), output)
    }

    #[test]
    fn records_are_ordered_by_time_robot_and_sequence() {
        let (_, output) = run([1, 0], false, KindSet::ALL);
        insta::assert_snapshot!(output.0.join("\n"));
    }

    #[test]
    fn observer_gets_only_kinds_of_interest() {
        let (_, output) = run([0, 1], true, Kind::Contact.set());
        assert_eq!(output.0.len(), 2, "{:?}", output.0);
        assert_eq!(output.1.len(), 2);
    }

    #[test]
    fn error_of_the_observer_ends_the_slot_without_changing_the_digest() {
        let mut recorder = Recorder::new(7, SLOT, KindSet::ALL);
        let mut journal = Journal::new(RobotId(1), false);
        journal.record(Time(1), &Event::Beep {});
        journal.record(Time(2), &Event::Beep {});
        recorder.collect(&mut journal);
        let mut count = 0;
        let result = recorder.end_slot(SLOT, |_| {
            count += 1;
            Err("full")
        });
        assert_eq!((result, count), (Err("full"), 1));
        let (digest, mut output) = (recorder.digest(), RunOutput::default());
        end_slot(&mut recorder, SLOT + SLOT, &mut output);
        assert_eq!((recorder.digest(), output.0.len()), (digest, 0));
    }

    #[test]
    fn digest_is_independent_of_observers_threads_and_verbosity() {
        let (digest, _) = run([0, 1], false, KindSet::NONE);
        let (digest_with_observer, output) = run([1, 0], false, KindSet::ALL);
        assert_eq!(digest, digest_with_observer);
        assert_eq!(digest, run([1, 0], true, Kind::Contact.set()).0);
        assert_eq!(output.1.last(), Some(&Some(digest)));
    }

    #[test]
    fn slots_without_events_do_not_change_the_digest() {
        let mut recorder = Recorder::new(7, SLOT, KindSet::ALL);
        let empty = recorder.digest();
        let mut journal = Journal::new(RobotId(1), false);
        journal.record(Time(1), &Event::Hint { text: "PSDGet before PSDInit" });
        recorder.collect(&mut journal);
        end_slot(&mut recorder, SLOT, &mut RunOutput::default());
        assert_eq!(recorder.digest(), empty);
        assert_ne!(empty, Recorder::new(8, SLOT, KindSet::ALL).digest());
    }

    #[test]
    fn digest_has_the_documented_construction() {
        let mut recorder = Recorder::new(7, SLOT, KindSet::ALL);
        let mut journal = Journal::new(RobotId(3), false);
        journal.record(Time(1), &Event::Reading { device: "IR", value: -1 });
        recorder.collect(&mut journal);
        end_slot(&mut recorder, SLOT, &mut RunOutput::default());

        // Time 1 in zigzag form, number of the kind, length and letters of the device's name, value -1 in zigzag form.
        let events = [2, Kind::Reading as u8, 2, b'I', b'R', 1];
        let head: &[&[u8]] = &[b"eyesim record 2", &7_u64.to_le_bytes(), &50_000_i64.to_le_bytes()];
        let block: &[&[u8]] = &[&3_u32.to_le_bytes(), &(events.len() as u64).to_le_bytes(), &events];
        let end: &[&[u8]] = &[&u32::MAX.to_le_bytes(), &50_000_i64.to_le_bytes()];
        let expected = *blake3::hash(&[head, block, end].concat().concat()).as_bytes();
        assert_eq!(recorder.digest(), Digest(expected));
    }

    #[test]
    fn digest_matches_the_golden_value() {
        assert_eq!(
            run([0, 1], false, KindSet::NONE).0.to_string(),
            "ff9e1b1f91e0efdb02edf2aca73cca9bb0c69463b6792e62e4a1ce161febcf38"
        );
    }
}
