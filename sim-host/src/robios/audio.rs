//! Loudspeaker and microphone. Sounds play in the background for their duration in virtual time; the microphone reads
//! the constant value set in the robi's companion (default: silence).
//!
//! Sources: RoBIOS 6 library, audio; RoBIOS-7 library, audio.

use robios_sys::{OutBytes, Robios6Call, Robios7Call};
use sim_core::time::Time;

use super::call::Call;
use super::robot::Robot;
use sim_core::record::Event;

/// Frequencies that `AUTone` plays, in Hz. Source: RoBIOS 6 library.
pub const TONE_HZ: std::ops::RangeInclusive<i32> = 65..=21_000;

/// Duration of a beep (`AUBeep`); our choice.
pub const BEEP: Time = Time::from_millis(100);

/// State of loudspeaker and microphone. A new sound replaces the sound in progress.
#[derive(Clone, Copy, Debug, Default)]
pub struct Audio {
    tone_end: Time,
    sample_end: Time,
    recording_end: Time,
}

impl Audio {
    /// Plays a tone from `now` on.
    pub fn play_tone(&mut self, now: Time, duration: Time) {
        self.tone_end = now + duration;
        self.sample_end = Time::ZERO;
    }

    /// Plays a sample from `now` on.
    pub fn play_sample(&mut self, now: Time, duration: Time) {
        self.sample_end = now + duration;
        self.tone_end = Time::ZERO;
    }

    /// Records from `now` on.
    pub fn record(&mut self, now: Time, duration: Time) {
        self.recording_end = now + duration;
    }

    /// Returns true if no tone or beep is playing.
    pub fn is_tone_done(&self, now: Time) -> bool {
        self.tone_end <= now
    }

    /// Returns true if no sample is playing.
    pub fn is_sample_done(&self, now: Time) -> bool {
        self.sample_end <= now
    }

    /// Returns true if neither tone nor sample is playing.
    pub fn is_silent(&self, now: Time) -> bool {
        self.is_tone_done(now) && self.is_sample_done(now)
    }

    /// Returns true if nothing is being recorded.
    pub fn is_recording_done(&self, now: Time) -> bool {
        self.recording_end <= now
    }
}

/// Maximum size of a recorded sample, in bytes; our choice, within a message of 32 MB.
const MAX_RECORDING: usize = 1 << 24;

/// Maximum rate of a recording in Hz.
const MAX_RATE: i64 = 44_100;

/// `AUPlaySample`: returns the sample's rate in Hz, 0 if there is no WAV file.
pub fn play_sample_6(robot: &mut Robot, sample: Option<&[u8]>) -> i32 {
    play_sample(robot, Robios6Call::AUPlaySample, 0, sample).map_or_else(|failure| failure, |wave| wave.rate_hz)
}

/// `AUPlay`
pub fn play_sample_7(robot: &mut Robot, sample: Option<&[u8]>) -> i32 {
    play_sample(robot, Robios7Call::AUPlay, 1, sample).map_or_else(|failure| failure, |_| 0)
}

/// Plays a WAV file in memory, or the WAV file that `sample` names; returns `failure` if there is none.
fn play_sample(robot: &mut Robot, call: impl Into<Call>, failure: i32, sample: Option<&[u8]>) -> Result<Wave, i32> {
    let Some(sample) = sample else { return Err(robot.fail_call(call, failure)) };
    let read = || {
        let file = robot.robios.storage.read(sample).map_err(|error| error.to_string())?;
        Wave::parse(&file).ok_or_else(|| "it is not a WAV file".to_owned())
    };
    let wave = match Wave::parse(sample).map_or_else(read, Ok) {
        Ok(wave) => wave,
        Err(reason) => return Err(robot.refuse_call(call, failure, |_| format!("`{}`: {reason}", super::text(sample)))),
    };
    let duration = Time((u64::from(wave.bytes) * 1_000_000 / u64::from(wave.bytes_per_second)) as i64);
    robot.robios.audio.play_sample(robot.now, duration);
    robot.record(Event::Sample { length_bytes: wave.bytes.into() });
    Ok(wave)
}

/// `AUTone`
pub fn play_tone(robot: &mut Robot, call: impl Into<Call>, failure: i32, frequency_hz: i32, span_ms: i32) -> i32 {
    if !TONE_HZ.contains(&frequency_hz) || span_ms < 0 {
        return robot.fail_call(call, failure);
    }
    let duration = Time::from_millis(span_ms.into());
    robot.robios.audio.play_tone(robot.now, duration);
    robot.record(Event::Tone { frequency_hz: frequency_hz.into(), duration_s: duration.seconds() });
    0
}

/// `AUBeep`
pub fn beep(robot: &mut Robot) -> i32 {
    robot.robios.audio.play_tone(robot.now, BEEP);
    robot.record(Event::Beep {});
    0
}

/// `AURecordSample`: returns the rate in Hz.
pub fn record_6(robot: &mut Robot, buffer: &mut OutBytes, rate_hz: i64) -> i32 {
    record(robot, Robios6Call::AURecordSample, 0, buffer, rate_hz).unwrap_or_else(|failure| failure)
}

/// `AURecord`
pub fn record_7(robot: &mut Robot, buffer: &mut OutBytes, rate_hz: i64) -> i32 {
    record(robot, Robios7Call::AURecord, 1, buffer, rate_hz).map_or_else(|failure| failure, |_| 0)
}

/// Records the microphone; returns the rate in Hz, or `failure` if buffer or rate is invalid.
fn record(
    robot: &mut Robot,
    call: impl Into<Call>,
    failure: i32,
    buffer: &mut OutBytes,
    rate_hz: i64,
) -> Result<i32, i32> {
    let length = buffer.capacity();
    if buffer.is_null() || length == 0 || rate_hz <= 0 {
        return Err(robot.fail_call(call, failure));
    }
    if length > MAX_RECORDING {
        return Err(robot.refuse_call(call, failure, |_| {
            format!("a recording of {length} bytes is too long: it has at most {MAX_RECORDING}, 380 s at {MAX_RATE} Hz")
        }));
    }
    let rate_hz = rate_hz.min(MAX_RATE) as i32;
    buffer.set(&vec![robot.spec.inputs.microphone; length]);
    robot.robios.audio.record(robot.now, duration_of(length as i32, rate_hz));
    Ok(rate_hz)
}

/// `AUCaptureMic`: returns the microphone's value, scaled from 8 to 10 bits, and records it.
pub fn microphone_6(robot: &mut Robot) -> i32 {
    read_microphone(robot, 4)
}

/// `AUMicrophone`: returns the microphone's value, which has 8 bits, and records it.
pub fn microphone_7(robot: &mut Robot) -> i32 {
    read_microphone(robot, 1)
}

fn read_microphone(robot: &mut Robot, scale: i32) -> i32 {
    let value = scale * i32::from(robot.spec.inputs.microphone);
    robot.record(Event::Reading { device: "microphone", value: value.into() });
    value
}

/// Rate and length of the sample in a WAV file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Wave {
    rate_hz: i32,
    bytes_per_second: u32,
    bytes: u32,
}

impl Wave {
    /// Parses the header of a WAV file; `None` for any other file.
    fn parse(file: &[u8]) -> Option<Self> {
        let word = |bytes: &[u8], offset: usize| {
            bytes.get(offset..offset + 4).and_then(|word| word.try_into().ok()).map(u32::from_le_bytes)
        };
        let mut rest = file.strip_prefix(b"RIFF")?.get(4..)?.strip_prefix(b"WAVE")?;
        let mut format = None;
        while let Some((name, size)) = rest.get(..4).zip(word(rest, 4)) {
            let content = &rest[8..];
            if name == b"fmt " {
                format = word(content, 4).zip(word(content, 8));
            }
            if name == b"data" {
                let (rate, bytes_per_second) = format?;
                let rate_hz = i32::try_from(rate).ok().filter(|rate| *rate > 0)?;
                return (bytes_per_second > 0).then_some(Self { rate_hz, bytes_per_second, bytes: size });
            }
            // Chunks have even lengths.
            rest = content.get(usize::try_from(size).ok()?.checked_next_multiple_of(2)?..)?;
        }
        None
    }
}

/// Duration of `count` values at `rate_hz`; zero for a rate that is not positive.
pub fn duration_of(count: i32, rate_hz: i32) -> Time {
    if rate_hz <= 0 { Time::ZERO } else { Time(i64::from(count.max(0)) * 1_000_000 / i64::from(rate_hz)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sounds_end_by_themselves() {
        let mut audio = Audio::default();
        assert!(audio.is_tone_done(Time(0)) && audio.is_sample_done(Time(0)) && audio.is_recording_done(Time(0)));
        audio.play_tone(Time(10), Time(100));
        assert!(!audio.is_tone_done(Time(109)) && audio.is_tone_done(Time(110)));
        audio.play_sample(Time(20), Time(100));
        assert!(audio.is_tone_done(Time(20)) && !audio.is_sample_done(Time(119)), "the sample replaces the tone");
        audio.record(Time(0), Time(5));
        assert!(!audio.is_recording_done(Time(4)) && audio.is_recording_done(Time(5)));
    }

    #[test]
    fn the_header_of_a_wav_file_is_parsed() {
        let mut file = b"RIFF\x28\0\0\0WAVEfmt \x10\0\0\0\x01\0\x01\0".to_vec();
        file.extend(8_000_u32.to_le_bytes());
        file.extend(16_000_u32.to_le_bytes());
        file.extend(b"\x02\0\x10\0data\x10\x27\0\0");
        assert_eq!(Wave::parse(&file), Some(Wave { rate_hz: 8_000, bytes_per_second: 16_000, bytes: 10_000 }));
        for length in 0..file.len() {
            assert_eq!(Wave::parse(&file[..length]), None, "cut after {length} bytes");
        }
        assert_eq!(Wave::parse(b"tune.wav"), None);
    }

    #[test]
    fn durations_of_samples() {
        assert_eq!(duration_of(8_000, 8_000), Time(1_000_000));
        assert_eq!([duration_of(-1, 8_000), duration_of(10, 0), duration_of(10, -5)], [Time::ZERO; 3]);
    }
}
