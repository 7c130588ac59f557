//! Radio of a fake robot: scripted incoming messages, and the messages sent.

use std::time::Duration;

use robios_sys::Stop;
use robios_sys::robios6::{MAXMSGLEN, RadioIOParameters, RadioStatus, SER115200, SERIAL1};

use super::Fake;
use super::robot::{FakeRobot, State};
use crate::os::RobotNumber;
use crate::radio::Message;

/// A message sent by the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sent {
    /// Virtual time at which it was sent.
    pub time: Duration,
    /// Receiver; [`RobotNumber::ALL`] for a broadcast.
    pub to: RobotNumber,
    /// Payload.
    pub bytes: Vec<u8>,
}

/// Script of the other robots: the delay of the answer to a message, and the answer.
pub(super) type Answers = Box<dyn FnMut(&Sent) -> Option<(Duration, Message)> + Send>;

/// State of the radio.
pub(super) struct RadioState {
    answers: Option<Answers>,
    settings: RadioIOParameters,
    is_on: bool,
    /// Incoming messages with their times in microseconds, in order of time.
    incoming: Vec<(u64, Message)>,
    sent: Vec<Sent>,
    received: i32,
}

impl RadioState {
    pub(super) fn new(fake: &mut Fake) -> Self {
        let settings =
            RadioIOParameters { interface: SERIAL1, speed: SER115200, id: 1, ..RadioIOParameters::default() };
        let incoming = std::mem::take(&mut fake.messages);
        Self { answers: fake.answers.take(), settings, is_on: false, incoming, sent: Vec::new(), received: 0 }
    }

    /// Messages sent in the run.
    pub(super) fn into_sent(self) -> Vec<Sent> {
        self.sent
    }

    fn add(&mut self, time_us: u64, message: Message) {
        let index = self.incoming.partition_point(|(time, _)| *time <= time_us);
        self.incoming.insert(index, (time_us, message));
    }

    fn waiting(&self, now_us: u64) -> i32 {
        self.incoming.iter().take_while(|(time_us, _)| *time_us <= now_us).count() as i32
    }

    fn status(&self, now_us: u64) -> RadioStatus {
        RadioStatus {
            id: self.settings.id,
            sent: self.sent.len() as i32,
            received: self.received,
            waiting: self.waiting(now_us),
        }
    }
}

impl Fake {
    /// Delivers a message at the given time; the message is lost unless the radio is on by then.
    pub fn message(mut self, time: Duration, from: RobotNumber, bytes: impl Into<Vec<u8>>) -> Self {
        self.messages.push((time.as_micros() as u64, Message { from, bytes: bytes.into() }));
        self.messages.sort_by_key(|(time_us, _)| *time_us);
        self
    }

    /// Sets the script by which the other robots answer the program's messages. The script returns an answer with its
    /// delay, or `None` for no answer, as after the loss of a message.
    ///
    /// ```
    /// use robios_api::fake::Fake;
    /// use robios_api::prelude::*;
    /// use robios_api::{Message, RobotNumber};
    ///
    /// fn ask_until_answered(robot: &Robot) -> Result {
    ///     let radio = robot.radio()?;
    ///     loop {
    ///         radio.send(RobotNumber(2), b"?")?;
    ///         if radio.receive_within(100.millis())?.is_some() {
    ///             return Ok(());
    ///         }
    ///     }
    /// }
    ///
    /// let mut to_lose = 3;
    /// let fake = Fake::new().answer(move |sent| {
    ///     to_lose -= 1;
    ///     (to_lose < 0).then(|| (20.millis(), Message { from: sent.to, bytes: b"!".to_vec() }))
    /// });
    /// assert_eq!(fake.run(ask_until_answered).expect_finished().sent().len(), 4);
    /// ```
    pub fn answer(mut self, answers: impl FnMut(&Sent) -> Option<(Duration, Message)> + Send + 'static) -> Self {
        self.answers = Some(Box::new(answers));
        self
    }
}

impl FakeRobot {
    /// Switches the radio on or off and discards earlier messages; returns true if it was on.
    pub(super) fn switch_radio(&self, is_on: bool) -> Result<bool, Stop> {
        self.act(|state| {
            let now_us = state.now_us;
            let was_on = std::mem::replace(&mut state.radio.is_on, is_on);
            state.radio.incoming.retain(|(time_us, _)| *time_us > now_us);
            was_on
        })
    }

    /// Sends a message; returns false if the radio is off or the message too long.
    pub(super) fn radio_send(&self, to: RobotNumber, bytes: Option<&[u8]>, max_len: usize) -> Result<bool, Stop> {
        self.act(|state| {
            let State { radio, now_us, .. } = state;
            let Some(bytes) = bytes.filter(|bytes| radio.is_on && bytes.len() <= max_len) else { return false };
            let sent = Sent { time: Duration::from_micros(*now_us), to, bytes: bytes.to_vec() };
            let answer = radio.answers.as_mut().and_then(|answers| answers(&sent));
            if let Some((delay, message)) = answer {
                radio.add(*now_us + delay.as_micros() as u64, message);
            }
            radio.sent.push(sent);
            true
        })
    }

    /// Number of messages that wait to be received.
    pub(super) fn radio_waiting(&self) -> Result<i32, Stop> {
        self.act(|state| if state.radio.is_on { state.radio.waiting(state.now_us) } else { 0 })
    }

    /// Waits for a message; `None` if the radio is off.
    pub(super) fn radio_receive(&self, name: &str) -> Result<Option<Message>, Stop> {
        if !self.act(|state| state.radio.is_on)? {
            return Ok(None);
        }
        loop {
            let (next_us, now_us) = {
                let state = self.state.borrow();
                (state.radio.incoming.first().map(|(time_us, _)| *time_us), state.now_us)
            };
            if next_us.is_some_and(|next_us| next_us <= now_us) {
                let radio = &mut self.state.borrow_mut().radio;
                radio.received += 1;
                return Ok(Some(radio.incoming.remove(0).1));
            }
            self.wait(name, next_us)?;
        }
    }

    pub(super) fn radio_settings(&self) -> Result<RadioIOParameters, Stop> {
        self.act(|state| state.radio.settings)
    }

    /// Changes the settings; returns false and changes nothing while the radio is on.
    pub(super) fn set_radio(&self, settings: RadioIOParameters) -> Result<bool, Stop> {
        self.act(|state| {
            if !state.radio.is_on {
                state.radio.settings = settings;
            }
            !state.radio.is_on
        })
    }

    pub(super) fn radio_status(&self) -> Result<RadioStatus, Stop> {
        self.act(|state| state.radio.status(state.now_us))
    }

    /// The radio's address.
    pub(super) fn radio_id(&self) -> Result<i32, Stop> {
        self.act(|state| state.radio.settings.id)
    }
}

/// Maximum length of a message in RoBIOS 6, in bytes.
pub(super) const MAX_MESSAGE_ROBIOS6: usize = MAXMSGLEN as usize;
