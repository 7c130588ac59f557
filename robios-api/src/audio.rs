//! Loudspeaker and microphone.

use std::time::Duration;

use robios_sys::robios6::FALSE;
use robios_sys::{ByteBuffer, ByteSlice};

use crate::device::Device;
use crate::error::checked;
use crate::robot::robios;
use crate::unit::Frequency;
use crate::{Error, Result, Robot};

/// Loudspeaker and microphone.
#[derive(Clone, Copy, Debug)]
pub struct Audio<'r>(pub(crate) &'r Robot);

/// Level of the microphone at an instant, 0 to 1023; 512 is silence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SoundLevel(pub i32);

impl Audio<'_> {
    /// Plays a short tone; does not wait.
    #[track_caller]
    pub fn beep(&self) {
        let _: i32 = robios!(self.0, AUBeep());
    }

    /// Plays a tone of 65 to 21,000 Hz; does not wait.
    ///
    /// # Errors
    /// [`Error::Refused`] for any other frequency.
    #[track_caller]
    pub fn tone(&self, frequency: Frequency, span: Duration) -> Result {
        let span_ms = i32::try_from(span.as_millis()).unwrap_or(i32::MAX);
        let frequency_hz = frequency.as_hertz().round() as i32;
        checked("AUTone", Device::Speaker, robios!(self.0, AUTone(frequency_hz, span_ms)))
    }

    /// Returns true if a tone is being played.
    #[track_caller]
    pub fn is_sounding(&self) -> bool {
        let is_silent: i32 = robios!(self.0, AUCheckTone());
        is_silent == FALSE
    }

    /// Plays a sample, a WAV file in memory, and returns its sampling rate; does not wait.
    ///
    /// # Errors
    /// [`Error::Refused`] if the bytes are not a sample.
    #[track_caller]
    pub fn play(&self, sample: &[u8]) -> Result<Frequency> {
        let rate: i32 = robios!(self.0, AUPlaySample(ByteSlice::from(sample)));
        rate_of("AUPlaySample", Device::Speaker, rate)
    }

    /// Returns true if a sample is being played.
    #[track_caller]
    pub fn is_playing(&self) -> bool {
        let is_silent: i32 = robios!(self.0, AUCheckSample());
        is_silent == FALSE
    }

    /// Records from the microphone until the buffer is full; returns the sampling rate.
    ///
    /// # Errors
    /// [`Error::Refused`] if nothing can be recorded.
    #[track_caller]
    pub fn record(&self, buffer: &mut [u8], rate: Frequency) -> Result<Frequency> {
        let rate: i32 = robios!(self.0, AURecordSample(ByteBuffer::from(buffer), rate.as_hertz().round() as i64));
        rate_of("AURecordSample", Device::Microphone, rate)
    }

    /// Returns true if a recording is in progress.
    #[track_caller]
    pub fn is_recording(&self) -> bool {
        let is_idle: i32 = robios!(self.0, AUCheckRecord());
        is_idle == FALSE
    }

    /// Current level of the microphone.
    #[track_caller]
    pub fn level(&self) -> SoundLevel {
        SoundLevel(robios!(self.0, AUCaptureMic()))
    }
}

/// Converts the sampling rate returned by a call to a result; a rate of 0 or less is a failure.
fn rate_of(call: &'static str, device: Device, rate: i32) -> Result<Frequency> {
    if rate > 0 { Ok(Frequency::hertz(rate.into())) } else { Err(Error::Refused { call, device, code: rate }) }
}
