//! Digest of a run: a hash chain per robot, a digest per slot, and a digest of the run.
//!
//! A robot's chain value after a slot is BLAKE3(previous chain value || canonical bytes of its events in the slot). The
//! digest after a slot is BLAKE3(previous digest || end of the slot || (id, chain value) of each robot that recorded an
//! event, in order of the ids). Slots and robots without events do not enter the digest; they only affect the times of
//! later events. The digest of a run is the digest after its last slot, so it equals the last slot line of the trace.
//!
//! Canonical bytes: postcard of (virtual time in us, event), with floating-point numbers as their bits. Notes, wall
//! time and the order of threads are excluded. The construction is our choice.

use std::fmt;

use crate::RobotId;
use crate::time::Time;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Name and version of the construction; change the version with every change of the construction or of the events.
const DOMAIN: &[u8] = b"eyesim record 1";

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

/// Initial value of a robot's chain.
pub(super) fn chain_start(robot: RobotId) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    hasher.update(DOMAIN).update(b" robot").update(&robot.0.to_le_bytes());
    *hasher.finalize().as_bytes()
}

/// Combines the robots' chains, slot by slot.
#[derive(Clone, Debug)]
pub struct RunDigest {
    /// The digest so far, followed by the chain values of the slot in progress: both are hashed in one call, without a
    /// copy.
    bytes: Vec<u8>,
}

/// Length of a digest in bytes.
const DIGEST_LEN: usize = 32;

impl RunDigest {
    /// Initial digest of a run; it depends on the seed and the slot length.
    pub fn new(seed: u64, slot: Time) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(DOMAIN).update(b" run").update(&seed.to_le_bytes()).update(&slot.0.to_le_bytes());
        Self { bytes: hasher.finalize().as_bytes().to_vec() }
    }

    /// Adds the chain value of a robot that recorded events in this slot. Must be called in the order of the robots' ids.
    pub fn add(&mut self, robot: RobotId, chain: &[u8; 32]) {
        self.bytes.extend_from_slice(&robot.0.to_le_bytes());
        self.bytes.extend_from_slice(chain);
    }

    /// Ends the slot at `end` and returns the new digest; `None` if no robot recorded an event in the slot.
    pub fn end_slot(&mut self, end: Time) -> Option<Digest> {
        if self.bytes.len() == DIGEST_LEN {
            return None;
        }
        self.bytes.extend_from_slice(&end.0.to_le_bytes());
        let digest = *blake3::hash(&self.bytes).as_bytes();
        self.bytes.clear();
        self.bytes.extend_from_slice(&digest);
        Some(Digest(digest))
    }

    /// Digest after the last ended slot.
    pub fn value(&self) -> Digest {
        let mut digest = [0; DIGEST_LEN];
        digest.copy_from_slice(&self.bytes[..DIGEST_LEN]);
        Digest(digest)
    }
}
