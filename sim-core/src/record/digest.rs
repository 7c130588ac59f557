//! Digest of a run: a hash over the canonical bytes of its events.
//!
//! The digest after a slot is BLAKE3 of the run's bytes up to the end of this slot. These bytes are a head (name of the
//! construction, seed, slot length), and for each slot with events the blocks of the robots that recorded an event, in
//! order of the ids (id, number of bytes, canonical bytes of the events), followed by the end of the slot. Slots and
//! robots without events add no bytes; they only affect the times of later events. The digest of a run is the digest
//! after its last slot, so it equals the digest in the last slot line of the trace.
//!
//! Canonical bytes: postcard of (virtual time in us, event), with floating-point numbers as their bits. Notes, wall
//! time and the order of threads are excluded. The construction is our choice: one long message is hashed in parallel
//! (SIMD), the events of many slots at once.

use std::fmt;

use crate::RobotId;
use crate::time::Time;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Version of the construction; changes with every change of the construction or of the events.
pub const VERSION: u32 = 2;

/// Name and version of the construction.
const DOMAIN: &[u8] = b"eyesim record 2";
const _: () = assert!(DOMAIN[DOMAIN.len() - 1] == b'0' + VERSION as u8);

/// A 256-bit hash of everything recorded so far.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Digest(pub [u8; 32]);

impl fmt::Display for Digest {
    /// Formats the digest as 64 lower-case hexadecimal digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Digest({self})")
    }
}

impl Serialize for Digest {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Digest {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let digits = text.as_bytes().as_chunks::<2>().0;
        let byte = |pair: &[u8; 2]| {
            let is_digit = |digit: &u8| digit.is_ascii_digit() || (b'a'..=b'f').contains(digit);
            let digits = std::str::from_utf8(pair).ok().filter(|_| pair.iter().all(is_digit))?;
            u8::from_str_radix(digits, 16).ok()
        };
        let bytes: Option<Vec<u8>> = digits.iter().map(byte).collect();
        let bytes = bytes.filter(|_| text.len() == 2 * DIGEST_LEN).and_then(|bytes| bytes.try_into().ok());
        bytes.map(Self).ok_or_else(|| D::Error::custom("a digest has 64 lower-case hexadecimal digits"))
    }
}

/// Length of a digest in bytes.
const DIGEST_LEN: usize = blake3::OUT_LEN;

/// Number of bytes that are hashed at once: chunks of BLAKE3's tree for the widest SIMD registers.
const BATCH_LEN: usize = 16 * blake3::CHUNK_LEN;

/// Marks the end of a slot, in place of the id of a robot.
const SLOT_END: u32 = u32::MAX;

/// Computes the digest of a run.
#[derive(Clone, Debug)]
pub struct RunDigest {
    /// Hasher of the run's bytes before `pending`.
    hasher: Box<blake3::Hasher>,
    /// The bytes of the run that are not hashed yet, fewer than [`BATCH_LEN`].
    pending: Vec<u8>,
    /// True if a robot has recorded an event in the slot in progress.
    has_events: bool,
}

impl RunDigest {
    /// Digest of a run before its first slot; it depends on the seed and the slot length.
    pub fn new(seed: u64, slot: Time) -> Self {
        let mut digest = Self { hasher: Box::default(), pending: Vec::with_capacity(BATCH_LEN), has_events: false };
        digest.append(DOMAIN);
        digest.append(&seed.to_le_bytes());
        digest.append(&slot.0.to_le_bytes());
        digest
    }

    /// Adds the canonical bytes of the events that a robot recorded in this slot. Must be called in the order of the
    /// robots' ids.
    pub fn add(&mut self, robot: RobotId, events: &[u8]) {
        self.append(&robot.0.to_le_bytes());
        self.append(&(events.len() as u64).to_le_bytes());
        self.append(events);
        self.has_events = true;
    }

    /// Ends the slot at `end`. Returns true if a robot recorded an event in it, which changes the digest.
    pub fn end_slot(&mut self, end: Time) -> bool {
        let has_events = std::mem::take(&mut self.has_events);
        if has_events {
            self.append(&SLOT_END.to_le_bytes());
            self.append(&end.0.to_le_bytes());
        }
        has_events
    }

    /// Appends to the bytes of the run.
    fn append(&mut self, mut bytes: &[u8]) {
        while let Some((rest_of_batch, others)) = bytes.split_at_checked(BATCH_LEN - self.pending.len()) {
            self.pending.extend_from_slice(rest_of_batch);
            self.hasher.update(&self.pending);
            self.pending.clear();
            bytes = others;
        }
        self.pending.extend_from_slice(bytes);
    }

    /// Digest after the last ended slot. Computing the digest takes a few microseconds. Must not be called while a slot
    /// ends.
    pub fn value(&self) -> Digest {
        debug_assert!(!self.has_events, "the slot has not ended");
        let mut hasher = (*self.hasher).clone();
        Digest(*hasher.update(&self.pending).finalize().as_bytes())
    }

    /// Returns [`Self::value`] and removes the pending bytes after hashing them: faster if the digest is needed after
    /// each slot.
    pub fn update_value(&mut self) -> Digest {
        debug_assert!(!self.has_events, "the slot has not ended");
        let digest = Digest(*self.hasher.update(&self.pending).finalize().as_bytes());
        self.pending.clear();
        digest
    }
}
