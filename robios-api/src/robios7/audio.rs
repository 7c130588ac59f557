//! Loudspeaker and microphone.

use std::time::Duration;

use robios_sys::{ByteBuffer, ByteSlice};

use super::Robot;
use crate::Result;
use crate::device::Device;
use crate::error::checked;
use crate::robot::robios7;
use crate::unit::Frequency;

/// Loudspeaker and microphone.
#[derive(Clone, Copy, Debug)]
pub struct Audio<'r>(pub(super) &'r Robot);

/// Level of the microphone at an instant, 0 to 255; 128 is silence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SoundLevel(pub u8);

impl Audio<'_> {
    /// Plays a short tone; does not wait.
    #[track_caller]
    pub fn beep(&self) {
        let _: i32 = robios7!(self.0, AUBeep());
    }

    /// Plays a tone; does not wait.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) for a frequency that cannot be played.
    #[track_caller]
    pub fn tone(&self, frequency: Frequency, span: Duration) -> Result {
        let span_ms = i32::try_from(span.as_millis()).unwrap_or(i32::MAX);
        let frequency_hz = frequency.as_hertz().round() as i32;
        checked("AUTone", Device::Speaker, robios7!(self.0, AUTone(frequency_hz, span_ms)))
    }

    /// Returns true if a tone is being played.
    #[track_caller]
    pub fn is_sounding(&self) -> bool {
        let is_silent: i32 = robios7!(self.0, AUCheckTone());
        is_silent == 0
    }

    /// Plays a sound file by its name, or a WAV file in memory; does not wait.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if it is not a sound.
    #[track_caller]
    pub fn play(&self, sample: impl AsRef<[u8]>) -> Result {
        checked("AUPlay", Device::Speaker, robios7!(self.0, AUPlay(ByteSlice::from(sample.as_ref()))))
    }

    /// Returns true if a sound is being played.
    #[track_caller]
    pub fn is_playing(&self) -> bool {
        let is_silent: i32 = robios7!(self.0, AUDone());
        is_silent == 0
    }

    /// Records from the microphone until the buffer is full; does not wait.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if nothing can be recorded.
    #[track_caller]
    pub fn record(&self, buffer: &mut [u8], rate: Frequency) -> Result {
        let rate_hz = rate.as_hertz().round() as i64;
        checked("AURecord", Device::Microphone, robios7!(self.0, AURecord(ByteBuffer::from(buffer), rate_hz)))
    }

    /// Returns true if a recording is in progress.
    #[track_caller]
    pub fn is_recording(&self) -> bool {
        let is_idle: i32 = robios7!(self.0, AUCheckRecord());
        is_idle == 0
    }

    /// Current level of the microphone.
    #[track_caller]
    pub fn level(&self) -> SoundLevel {
        let level: i32 = robios7!(self.0, AUMicrophone());
        SoundLevel(level.clamp(0, 255) as u8)
    }
}
