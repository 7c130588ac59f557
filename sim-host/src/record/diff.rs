//! Comparison of two recorded runs: the first difference between their events, and the maximum distance between the
//! robots' positions.

use std::collections::BTreeMap;
use std::io::BufRead;

use glam::DVec2;
use sim_core::math;
use sim_core::record::Kind;
use sim_core::time::Time;

use super::read::{Line, RecordedEvent, TraceError, TraceReader};
use super::trail::Trail;

/// Comparison of two traces, A and B.
#[derive(Debug, Default)]
pub struct TraceDiff {
    /// Differences between the headers, such as `seed: 1 in A, 2 in B`. They may explain other differences;
    /// [`TraceDiff::is_equal`] ignores them.
    pub headers: Vec<String>,
    /// Lengths of the slots of A and B. If they differ, only positions are compared, at the ends of slots of both runs:
    /// events that belong to the end of a slot, such as poses, have no counterparts.
    pub slots: [Time; 2],
    /// First difference between the events; none if all events are equal. A truncated trace is compared only as far as
    /// it goes.
    pub first: Option<Difference>,
    /// Ends of the runs A and B; none for a truncated trace.
    pub ends: [Option<Time>; 2],
    /// End of the last slot that was compared.
    pub compared_until: Time,
    /// Paths of each robot with poses in either trace, by its number.
    pub paths: BTreeMap<u32, PathPair>,
}

/// First difference between the events of two runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Virtual time of the earlier of the two events.
    pub at: Time,
    /// End of the slot of the two events.
    pub slot_end: Time,
    /// Number of the robot; none for the world.
    pub robot: Option<u32>,
    /// The robot's last event before the difference, equal in both runs.
    pub last_common: Option<RecordedEvent>,
    /// The events in A and in B; none if the robot has no further event in this slot.
    pub events: [Option<RecordedEvent>; 2],
}

/// Paths of one robot in both runs.
#[derive(Clone, Debug, Default)]
pub struct PathPair {
    /// Paths in A and in B, in the world, m; none if the trace has no pose of the robot.
    pub trails: [Option<Trail>; 2],
    /// Maximum distance in m between the positions at an instant at which a slot ends in both runs, and that instant;
    /// none if the positions never differ, or if a trace has no pose of the robot.
    pub farthest: Option<(f64, Time)>,
    positions: [Option<DVec2>; 2],
}

/// Events of one slot.
struct Slot {
    end: Time,
    events: Vec<RecordedEvent>,
}

impl TraceDiff {
    /// Compares two traces from after their headers. Notes (events without `seq`, which are not in the digest) are not
    /// compared. Also lists the differences between the headers.
    ///
    /// # Errors
    /// [`TraceError`] for an invalid line.
    pub fn of<R: BufRead>(mut readers: [TraceReader<R>; 2]) -> Result<Self, TraceError> {
        let slots = readers.each_ref().map(|reader| Time(reader.header().slot_us));
        let mut diff = Self { headers: header_differences(&readers), slots, ..Self::default() };
        let mut last_events = BTreeMap::new();
        let mut next = [diff.next_slot(&mut readers, 0)?, diff.next_slot(&mut readers, 1)?];
        // A truncated trace is compared up to its last complete slot.
        while (0..2).all(|run| next[run].is_some() || diff.ends[run].is_some()) {
            let Some(end) = next.iter().flatten().map(|slot| slot.end).min() else { break };
            let mut slots = [Vec::new(), Vec::new()];
            for run in 0..2 {
                if let Some(slot) = next[run].take_if(|slot| slot.end == end) {
                    slots[run] = slot.events;
                    next[run] = diff.next_slot(&mut readers, run)?;
                }
            }
            diff.compare(end, slots, &mut last_events);
        }
        let [a, b] = diff.ends;
        diff.measure_by(a.zip(b).map_or(diff.compared_until, |(a, b)| a.max(b)));
        Ok(diff)
    }

    /// Returns true if the events were compared and no difference was found, and the ends are equal or one of them is
    /// unknown.
    pub fn is_equal(&self) -> bool {
        self.compares_events() && self.first.is_none() && !self.ends_differ()
    }

    /// Returns true if the events are compared: the slots of both runs have the same length.
    pub fn compares_events(&self) -> bool {
        self.slots[0] == self.slots[1]
    }

    /// Returns true if both runs have an end, and these differ.
    pub fn ends_differ(&self) -> bool {
        matches!(self.ends, [Some(a), Some(b)] if a != b)
    }

    /// The next slot of a run; none at its end or at the end of a truncated trace.
    fn next_slot<R: BufRead>(
        &mut self,
        readers: &mut [TraceReader<R>; 2],
        run: usize,
    ) -> Result<Option<Slot>, TraceError> {
        let mut events = Vec::new();
        while let Some(line) = readers[run].next_line()? {
            match line {
                // Notes have no sequence number.
                Line::Event(event) if event.fields["seq"].is_null() => {}
                Line::Event(event) => events.push(event),
                Line::Slot { end, .. } => return Ok(Some(Slot { end, events })),
                Line::End { end, .. } => self.ends[run] = Some(end),
            }
        }
        Ok(None)
    }

    fn compare(
        &mut self,
        end: Time,
        slots: [Vec<RecordedEvent>; 2],
        last_events: &mut BTreeMap<Option<u32>, RecordedEvent>,
    ) {
        // Robots without an event in a slot stay where they are.
        self.measure_by(end - Time(1));
        self.compared_until = end;
        for (run, events) in slots.iter().enumerate() {
            for event in events.iter().filter(|event| is_position(event)) {
                self.paths.entry(event.robot.unwrap_or_default()).or_default().push(run, event);
            }
        }
        if self.first.is_none() && self.compares_events() {
            self.first = first_difference(end, slots, last_events);
        }
    }

    /// Measures the distances at the last instant, not after `end`, at which slots of both runs end, unless events after
    /// this instant have been compared.
    fn measure_by(&mut self, end: Time) {
        let [a, b] = self.slots.map(|slot| slot.0.max(1));
        let common = (a / gcd(a, b)).checked_mul(b).map_or(Time::NEVER, Time);
        let at = end.floor_to(common);
        if at >= self.compared_until {
            self.paths.values_mut().for_each(|paths| paths.measure(at));
        }
    }
}

/// Greatest common divisor of two positive numbers.
fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

impl PathPair {
    fn push(&mut self, run: usize, event: &RecordedEvent) {
        let coordinate = |name: &str| event.fields[name].as_f64().unwrap_or(f64::NAN);
        let position = DVec2::new(coordinate("x_m"), coordinate("y_m"));
        self.positions[run] = Some(position);
        match &mut self.trails[run] {
            Some(trail) => trail.push(position),
            trail => *trail = Some(Trail::new(position)),
        }
    }

    fn measure(&mut self, at: Time) {
        let [Some(a), Some(b)] = self.positions else { return };
        let distance = math::hypot(a.x - b.x, a.y - b.y);
        if distance > self.farthest.map_or(0.0, |(farthest, _)| farthest) {
            self.farthest = Some((distance, at));
        }
    }
}

fn is_position(event: &RecordedEvent) -> bool {
    event.robot.is_some() && (event.kind == Kind::Pose.name() || event.kind == Kind::Placed.name())
}

/// First difference in the slot that ends at `slot_end`: the earliest by time, then by robot. Stores in `last_events`
/// the last event of each robot before its first difference.
fn first_difference(
    slot_end: Time,
    slots: [Vec<RecordedEvent>; 2],
    last_events: &mut BTreeMap<Option<u32>, RecordedEvent>,
) -> Option<Difference> {
    // Within a slot robots are independent of each other, so the events of each robot are compared separately.
    let mut events_by_robot: BTreeMap<Option<u32>, [Vec<RecordedEvent>; 2]> = BTreeMap::new();
    for (run, events) in slots.into_iter().enumerate() {
        for event in events {
            events_by_robot.entry(event.robot).or_default()[run].push(event);
        }
    }
    let mut first: Option<Difference> = None;
    for (robot, [a, b]) in events_by_robot {
        let equal_count = a.iter().zip(&b).take_while(|(a, b)| a.fields == b.fields).count();
        if let Some(event) = equal_count.checked_sub(1).and_then(|last| a.get(last)) {
            last_events.insert(robot, event.clone());
        }
        let events = [a.into_iter().nth(equal_count), b.into_iter().nth(equal_count)];
        let at = events.iter().flatten().map(|event| event.at).min();
        if let Some(at) = at.filter(|at| first.as_ref().is_none_or(|first| *at < first.at)) {
            first = Some(Difference { at, slot_end, robot, last_common: last_events.get(&robot).cloned(), events });
        }
    }
    first
}

fn header_differences<R: BufRead>(readers: &[TraceReader<R>; 2]) -> Vec<String> {
    let mut differences = Vec::new();
    let mut compare = |name: &str, a: String, b: String| {
        if a != b {
            differences.push(format!("{name}: {a} in A, {b} in B"));
        }
    };
    let [a, b] = readers;
    compare("eyesim", a.version().to_owned(), b.version().to_owned());
    let (a, b) = (a.header(), b.header());
    compare("seed", a.seed.to_string(), b.seed.to_string());
    compare("slot", Time(a.slot_us).to_string(), Time(b.slot_us).to_string());
    compare("robots", a.robots.len().to_string(), b.robots.len().to_string());
    compare("arguments", a.run.join(" "), b.run.join(" "));
    for input in &a.inputs {
        let other = b.inputs.iter().find(|other| other.path == input.path);
        if other.is_some_and(|other| other.sha256 != input.sha256) {
            differences.push(format!("`{}` has other contents", input.path));
        }
    }
    differences
}
