//! Loudspeaker and microphone: sounds are events that take virtual time in the background; the microphone hears silence.
//!
//! Source: RoBIOS 6 library, audio.

use sim_core::time::Time;

/// Frequencies that `AUTone` plays, in Hz. Source: RoBIOS 6 library.
pub const TONE_HZ: std::ops::RangeInclusive<i32> = 65..=21_000;

/// How long `AUBeep` sounds; our choice.
pub const BEEP: Time = Time::from_millis(100);

/// A byte of silence in an unsigned 8 bit sample.
pub const SILENT_BYTE: u8 = 128;

/// A 10 bit value of the microphone in silence: the middle of the range.
pub const SILENT_VALUE: i32 = 512;

/// What loudspeaker and microphone are doing. A new sound replaces the one in progress.
#[derive(Clone, Copy, Debug, Default)]
pub struct Audio {
    tone_end: Time,
    sample_end: Time,
    record_end: Time,
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
        self.record_end = now + duration;
    }

    /// True when no tone or beep sounds.
    pub fn is_tone_done(&self, now: Time) -> bool {
        self.tone_end <= now
    }

    /// True when no sample sounds.
    pub fn is_sample_done(&self, now: Time) -> bool {
        self.sample_end <= now
    }

    /// True when nothing is being recorded.
    pub fn is_record_done(&self, now: Time) -> bool {
        self.record_end <= now
    }
}

/// How long `count` values at `rate_hz` last; nothing for a rate that is not positive.
pub fn duration_of(count: i32, rate_hz: i32) -> Time {
    if rate_hz <= 0 { Time::ZERO } else { Time(i64::from(count.max(0)) * 1_000_000 / i64::from(rate_hz)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sounds_end_by_themselves() {
        let mut audio = Audio::default();
        assert!(audio.is_tone_done(Time(0)) && audio.is_sample_done(Time(0)) && audio.is_record_done(Time(0)));
        audio.play_tone(Time(10), Time(100));
        assert!(!audio.is_tone_done(Time(109)) && audio.is_tone_done(Time(110)));
        audio.play_sample(Time(20), Time(100));
        assert!(audio.is_tone_done(Time(20)) && !audio.is_sample_done(Time(119)), "the sample replaces the tone");
        audio.record(Time(0), Time(5));
        assert!(!audio.is_record_done(Time(4)) && audio.is_record_done(Time(5)));
    }

    #[test]
    fn lengths() {
        assert_eq!(duration_of(8_000, 8_000), Time(1_000_000));
        assert_eq!([duration_of(-1, 8_000), duration_of(10, 0), duration_of(10, -5)], [Time::ZERO; 3]);
    }
}
