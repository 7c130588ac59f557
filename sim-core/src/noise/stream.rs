//! A stream of random bits with a key.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

use crate::RobotId;

/// What a stream is for; the number is part of the key and never changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u32)]
pub enum Purpose {
    /// The generators that a robot's program draws from (`rand` of C and the like).
    Program = 1,
    /// Where a robot of a random layout starts.
    Layout = 2,
}

/// Random bits that are a function of their key alone.
///
/// ChaCha with 8 rounds; the key is (seed, robot, purpose, number, sub-number) in 32 bytes, so different keys never meet. Source:
/// design section 6; the generator is our choice, for its independence between keys and its speed.
#[derive(Clone, Debug)]
pub struct Stream {
    generator: ChaCha8Rng,
}

impl Stream {
    /// The stream of a run with `seed`, for `purpose` of `robot`; `number` and `sub_number` tell its streams apart (a device,
    /// a seed that a program has set).
    pub fn new(seed: u64, robot: RobotId, purpose: Purpose, number: u32, sub_number: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..12].copy_from_slice(&robot.0.to_le_bytes());
        key[12..16].copy_from_slice(&(purpose as u32).to_le_bytes());
        key[16..20].copy_from_slice(&number.to_le_bytes());
        key[20..28].copy_from_slice(&sub_number.to_le_bytes());
        Self { generator: ChaCha8Rng::from_seed(key) }
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.generator.next_u64()
    }

    /// The next number from [0, 1), a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(seed: u64, robot: u32, number: u32, sub_number: u64) -> u64 {
        Stream::new(seed, RobotId(robot), Purpose::Program, number, sub_number).bits()
    }

    #[test]
    fn every_part_of_the_key_counts() {
        let streams = [first(0, 1, 1, 0), first(1, 1, 1, 0), first(0, 2, 1, 0), first(0, 1, 2, 0), first(0, 1, 1, 1)];
        for (index, bits) in streams.iter().enumerate() {
            assert!(!streams[..index].contains(bits), "{streams:x?}");
        }
    }

    #[test]
    fn the_values_are_golden() {
        let mut stream = Stream::new(42, RobotId(3), Purpose::Program, 1, 7);
        assert_eq!([stream.bits(), stream.bits()], GOLDEN);
    }

    /// First bits of the stream above: a change of generator or key changes every recorded run.
    const GOLDEN: [u64; 2] = [3_252_954_896_834_025_347, 14_015_292_282_578_683_744];
}
