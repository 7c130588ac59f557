//! Random streams, each determined by its key alone.

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};

use super::normal_quantile;
use crate::RobotId;
use crate::time::Time;

/// Purpose of a stream; the number is part of the key and never changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u32)]
pub enum Purpose {
    /// Random numbers that a robot's program requests (such as with `rand` of C).
    Program = 1,
    /// Poses of robots, objects and walls in a random layout.
    Layout = 2,
    /// Constant of a device (manufacturing tolerance), drawn once, as event 0.
    DeviceConstant = 3,
    /// Readings of a distance sensor, scans of a lidar.
    Range = 4,
    /// Noise term of a sensor model.
    Signal = 5,
    /// Readings of a compass.
    Compass = 6,
    /// Frames of a camera.
    Image = 7,
    /// Noise of the true motion at a commanded speed, and slip of the wheels.
    Command = 8,
    /// Noise of odometry.
    Odometry = 9,
    /// Loss and bit errors of a message to one receiver.
    Radio = 10,
    /// Losses of the token of a token ring.
    Token = 11,
    /// Shape of a terrain; uses the terrain's own seed.
    Terrain = 12,
    /// Values of a scene that are drawn from the seed.
    Scene = 13,
    /// Times at which faults occur.
    Fault = 14,
    /// Error of the distance and angle of a drive command, such as `VWStraight`.
    Drive = 15,
}

/// Key of a stream: (seed of the run, robot, purpose, number, sub-number), in 32 bytes.
fn key(seed: u64, robot: RobotId, purpose: Purpose, number: u32, sub_number: u64) -> [u8; 32] {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..12].copy_from_slice(&robot.0.to_le_bytes());
    key[12..16].copy_from_slice(&(purpose as u32).to_le_bytes());
    key[16..20].copy_from_slice(&number.to_le_bytes());
    key[20..28].copy_from_slice(&sub_number.to_le_bytes());
    key
}

/// Random bits that depend only on the key of the stream, (seed, robot, purpose, number, sub-number).
///
/// The generator is ChaCha with 8 rounds: our choice, because it is fast, and streams with different keys are
/// independent.
#[derive(Clone, Debug)]
pub struct Stream {
    generator: ChaCha8Rng,
}

impl Stream {
    /// Stream of a run with `seed`, for `purpose` of `robot`; `number` and `sub_number` distinguish several such
    /// streams, for example those of the seeds that a program sets. Devices use [`EventStreams`] instead.
    pub fn new(seed: u64, robot: RobotId, purpose: Purpose, number: u32, sub_number: u64) -> Self {
        Self { generator: ChaCha8Rng::from_seed(key(seed, robot, purpose, number, sub_number)) }
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.generator.next_u64()
    }

    /// The next number from [0, 1), a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The next number with the standard normal distribution, between -8.21 and 8.21.
    pub fn normal(&mut self) -> f64 {
        // The argument is exactly the midpoint of one of 2^52 equal intervals of (0, 1). It is symmetric about 0.5 and
        // never 0 or 1.
        normal_quantile(((self.bits() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64)
    }
}

/// Random streams of a device's events. An event is a reading, a scan, a frame or a tick of the drive.
///
/// The stream of an event depends only on (seed, robot, purpose, name of the device, index of the event). The first
/// four form the key, with the name hashed by [`name_key`]; the index is ChaCha's 64-bit stream number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EventStreams {
    key: [u8; 32],
}

impl EventStreams {
    /// Streams of the device called `device` on `robot`. The drive of a robot has the name `""`; the slip of its wheels
    /// has the name `"slip"`.
    pub fn new(seed: u64, robot: RobotId, purpose: Purpose, device: &str) -> Self {
        Self { key: key(seed, robot, purpose, 0, name_key(device)) }
    }

    /// Stream of the event with this index.
    pub fn at(&self, index: u64) -> Stream {
        let mut generator = ChaCha8Rng::from_seed(self.key);
        generator.set_stream(index);
        Stream { generator }
    }

    /// Event index of a device with `period` at `time`: the number of whole periods since the start of the run. It does
    /// not depend on how often or by which program the device is read. Devices without a period use a period of 1 us.
    ///
    /// # Panics
    /// If the period is not positive.
    pub fn index(time: Time, period: Time) -> u64 {
        assert!(period > Time::ZERO, "a period is positive, this one is {period}");
        time.0.div_euclid(period.0) as u64
    }
}

/// Hash of a name as part of a key: FNV-1a with 64 bits over its UTF-8 bytes.
///
/// Source: Fowler, Noll and Vo; RFC 9923.
pub const fn name_key(name: &str) -> u64 {
    let (bytes, mut hash, mut index) = (name.as_bytes(), 0xcbf2_9ce4_8422_2325_u64, 0);
    while index < bytes.len() {
        hash = (hash ^ bytes[index] as u64).wrapping_mul(0x0100_0000_01b3);
        index += 1;
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first_bits(seed: u64, robot: u32, number: u32, sub_number: u64) -> u64 {
        Stream::new(seed, RobotId(robot), Purpose::Program, number, sub_number).bits()
    }

    #[test]
    fn every_part_of_the_key_changes_the_stream() {
        let streams = [
            first_bits(0, 1, 1, 0),
            first_bits(1, 1, 1, 0),
            first_bits(0, 2, 1, 0),
            first_bits(0, 1, 2, 0),
            first_bits(0, 1, 1, 1),
        ];
        for (index, bits) in streams.iter().enumerate() {
            assert!(!streams[..index].contains(bits), "{streams:x?}");
        }
    }

    #[test]
    fn every_part_of_an_event_key_changes_the_stream() {
        let event = |seed, robot, purpose, device, index| {
            EventStreams::new(seed, RobotId(robot), purpose, device).at(index).bits()
        };
        let streams = [
            event(0, 1, Purpose::Range, "PSD_FRONT", 0),
            event(1, 1, Purpose::Range, "PSD_FRONT", 0),
            event(0, 2, Purpose::Range, "PSD_FRONT", 0),
            event(0, 1, Purpose::Signal, "PSD_FRONT", 0),
            event(0, 1, Purpose::Range, "PSD_LEFT", 0),
            event(0, 1, Purpose::Range, "PSD_FRONT", 1),
            event(0, 1, Purpose::Range, "PSD_FRONT", 1 << 32),
        ];
        for (index, bits) in streams.iter().enumerate() {
            assert!(!streams[..index].contains(bits), "{streams:x?}");
        }
    }

    #[test]
    fn bits_match_golden_values() {
        let mut stream = Stream::new(42, RobotId(3), Purpose::Program, 1, 7);
        assert_eq!([stream.bits(), stream.bits()], GOLDEN);
    }

    /// First bits of the stream in the test above. A change of generator or key would change every recorded run.
    const GOLDEN: [u64; 2] = [3_252_954_896_834_025_347, 14_015_292_282_578_683_744];

    #[test]
    fn event_streams_match_golden_values() {
        let mut found = [0; 9];
        let purposes = [
            Purpose::Program,
            Purpose::Layout,
            Purpose::DeviceConstant,
            Purpose::Range,
            Purpose::Signal,
            Purpose::Compass,
            Purpose::Image,
            Purpose::Command,
            Purpose::Odometry,
        ];
        for (index, purpose) in purposes.into_iter().enumerate() {
            assert_eq!(purpose as usize, index + 1);
            found[index] = EventStreams::new(42, RobotId(3), purpose, "PSD_FRONT").at(7).bits();
        }
        assert_eq!(found, GOLDEN_EVENTS, "{found:#x?}");
        let mut stream = EventStreams::new(42, RobotId(3), Purpose::Range, "PSD_FRONT").at(u64::MAX);
        let drawn = (stream.unit(), stream.normal(), stream.normal());
        assert_eq!(drawn, GOLDEN_DRAWN, "{drawn:?}");
    }

    /// Source: an independent implementation of ChaCha.
    const GOLDEN_EVENTS: [u64; 9] = [
        0xa631_bd5f_95b4_d7b2,
        0x551d_90f5_eea6_9fba,
        0xd8b6_267d_df72_96b2,
        0x8fe5_6b92_a43c_6ad5,
        0x55ee_a2f8_648e_624f,
        0xf184_490b_f0a7_ecd6,
        0xa99d_2a23_3a74_46ba,
        0x6939_f77c_a17a_132a,
        0x6e21_fa97_fbbf_4fd1,
    ];
    const GOLDEN_DRAWN: (f64, f64, f64) = (0.6329601650520771, 0.047532769841789946, -0.49639295803043604);

    #[test]
    fn event_0_of_the_empty_name_equals_the_stream_with_its_key() {
        let mut event = EventStreams::new(5, RobotId(1), Purpose::DeviceConstant, "").at(0);
        let mut stream = Stream::new(5, RobotId(1), Purpose::DeviceConstant, 0, name_key(""));
        assert_eq!(event.bits(), stream.bits());
    }

    #[test]
    fn event_index_is_the_number_of_whole_periods() {
        let period = Time::from_millis(60);
        let indices = [0, 59_999, 60_000, 119_999, 120_000].map(|time| EventStreams::index(Time(time), period));
        assert_eq!(indices, [0, 0, 1, 1, 2]);
        assert_eq!(EventStreams::index(Time::NEVER, Time(1)), i64::MAX as u64);
    }

    #[test]
    fn name_key_matches_the_test_vectors_of_its_authors() {
        assert_eq!(
            ["", "a", "foobar"].map(name_key),
            [0xcbf2_9ce4_8422_2325, 0xaf63_dc4c_8601_ec8c, 0x8594_4171_f739_67e8]
        );
    }
}
