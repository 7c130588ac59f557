//! The fake robot that the function tables call: its state, its virtual time, and the services for its program's
//! language runtime.

use std::any::Any;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use robios_sys::robios6::PSDHandle;
use robios_sys::support::layer::MAX_NAME;
use robios_sys::{CallContext, CallRecord, Callback, OutBytes, Stop, Support};

use super::lcd::LcdBuffer;
use super::motion::{FULL_SPEED_MPS, Motion, Pose, TRACK_M};
use super::radio::RadioState;
use super::task::{RunToken, TaskTable};
use super::{Call, End, Fake, Moment, Run};
use crate::call_site::LastCallSite;
use crate::robios7::{Color, ImageSize};

/// Virtual time that a call takes if it does not wait, in microseconds. It is as long as on a slow processor, so that
/// polling loops soon reach the limit.
const CALL_COST_US: u64 = 100;
pub(super) const PSD_CYCLE_US: u64 = 60_000;
pub(super) const TIMER_TICK_US: u64 = 10_000;
/// Resolution of the encoders, in counts per metre.
pub(super) const TICKS_PER_METRE: f64 = 1000.0;
/// The only handle of the driving interface.
pub(super) const DRIVE_HANDLE: i32 = 1;

/// A robot that follows the script of a [`Fake`].
pub(super) struct FakeRobot {
    pub fake: Fake,
    pub last_call_site: Arc<LastCallSite>,
    pub run_token: RunToken,
    /// Never borrowed across a callback.
    pub state: RefCell<State>,
}

pub(super) struct State {
    pub now_us: u64,
    /// The program must end.
    pub is_over: bool,
    pub failure: Option<String>,
    pub motion: Motion,
    /// True pose, and the pose that the program set, at the last `VWSetPosition` or `VWInit`.
    pub origin: (Pose, Pose),
    pub has_drive: bool,
    /// Power of the motors, left and right, as a fraction of full power.
    pub power: [f64; 2],
    /// Distances rolled by the wheels when the counts of their encoders were last reset, in metres.
    pub rolled_at_tick_reset: [f64; 2],
    /// Distances rolled by the wheels when the distances of their encoders were last reset, in metres.
    pub rolled_at_distance_reset: [f64; 2],
    pub servos: Vec<i32>,
    pub psd: Option<PsdMeasurement>,
    pub bumps_read: Vec<usize>,
    pub keys_read: usize,
    pub touches_read: usize,
    pub pixels: BTreeMap<(i32, i32), Color>,
    /// Setting of a scan: angle in degrees, and number of points.
    pub scan: (i32, i32),
    /// Image files that the program has written: size, digit of the format, and pixels.
    pub image_files: BTreeMap<Vec<u8>, (ImageSize, i32, Vec<u8>)>,
    /// The camera, while it is on.
    pub camera: Option<super::camera::CameraState>,
    pub radio: RadioState,
    pub tasks: TaskTable,
    /// The digital lines, line 1 in the lowest bit.
    pub lines: i32,
    /// The lines that are outputs.
    pub outputs: i32,
    pub is_compass_ready: bool,
    pub timers: Vec<TimerEntry>,
    pub next_timer: i32,
    pub are_timers_held: bool,
    pub is_in_callback: bool,
    pub lcd: LcdBuffer,
    pub console: String,
    /// Bytes of the standard input that the program has read.
    pub input_read: usize,
    /// State of each stream of random numbers, by purpose.
    pub random: BTreeMap<u32, u64>,
    pub variables: [i32; 16],
    pub clock_offset_us: i64,
    pub calls: Vec<Call>,
}

/// Measurement of the distance sensors.
#[derive(Clone, Copy)]
pub(super) struct PsdMeasurement {
    pub start_us: u64,
    pub mask: PSDHandle,
    /// Number of the last cycle, from 1; `None` in continuous mode.
    pub last: Option<u64>,
}

impl PsdMeasurement {
    /// Number of complete cycles.
    pub(super) fn cycles(self, now_us: u64) -> u64 {
        let cycles = now_us.saturating_sub(self.start_us) / PSD_CYCLE_US;
        self.last.map_or(cycles, |last| cycles.min(last))
    }
}

pub(super) struct TimerEntry {
    pub handle: i32,
    pub period_us: u64,
    pub next_us: u64,
    pub callback: Callback,
}

impl FakeRobot {
    pub(super) fn new(mut fake: Fake, generation: u32) -> Self {
        let state = State {
            now_us: 0,
            is_over: false,
            failure: None,
            motion: Motion::new(),
            origin: Default::default(),
            has_drive: false,
            power: [0.0; 2],
            rolled_at_tick_reset: [0.0; 2],
            rolled_at_distance_reset: [0.0; 2],
            servos: Vec::new(),
            psd: None,
            bumps_read: vec![0; fake.bumpers.len()],
            keys_read: 0,
            touches_read: 0,
            pixels: BTreeMap::new(),
            scan: (360, 360),
            image_files: BTreeMap::new(),
            camera: None,
            radio: RadioState::new(&mut fake),
            tasks: TaskTable::new(),
            lines: 0,
            outputs: 0,
            is_compass_ready: false,
            timers: Vec::new(),
            next_timer: 1,
            are_timers_held: false,
            is_in_callback: false,
            lcd: if generation == 7 { LcdBuffer::large() } else { LcdBuffer::new() },
            console: String::new(),
            input_read: 0,
            random: BTreeMap::new(),
            variables: [0; 16],
            clock_offset_us: 0,
            calls: Vec::new(),
        };
        Self { fake, last_call_site: Arc::default(), run_token: RunToken::default(), state: RefCell::new(state) }
    }

    /// Record of the run, after the program has returned its exit code.
    pub(super) fn finish(self, exit_code: i32) -> Run {
        let state = self.state.into_inner();
        let end = match state.failure {
            Some(reason) => End::Failed { exit_code, reason },
            None if state.is_over => {
                let during = state.calls.iter().find(|call| call.text.ends_with(" stopped"));
                End::TimeUp { during: during.map_or_else(String::new, text_with_location) }
            }
            None if exit_code == 0 => End::Finished,
            None => End::Failed { exit_code, reason: "it returned an exit code other than 0".to_owned() },
        };
        Run {
            end,
            time: Duration::from_micros(state.now_us),
            position: state.motion.pose(state.now_us).position(),
            lcd: state.lcd.lines(),
            console: state.console,
            sent: state.radio.into_sent(),
            calls: state.calls,
        }
    }

    /// Advances virtual time by the cost of a call, then runs `act`.
    pub(super) fn act<R>(&self, act: impl FnOnce(&mut State) -> R) -> Result<R, Stop> {
        let end_us = self.state.borrow().now_us + CALL_COST_US;
        self.advance(end_us)?;
        Ok(act(&mut self.state.borrow_mut()))
    }

    /// Waits until a time; `None` waits forever. Fails inside a timer's function.
    pub(super) fn wait(&self, name: &str, until_us: Option<u64>) -> Result<(), Stop> {
        if self.state.borrow().is_in_callback {
            return Err(self.state.borrow_mut().refuse_wait(name));
        }
        self.advance(until_us.unwrap_or(u64::MAX))
    }

    /// Advances virtual time; in preemptive mode other tasks run meanwhile.
    pub(super) fn advance(&self, mut until_us: u64) -> Result<(), Stop> {
        loop {
            until_us = until_us.saturating_add(self.advance_with_timers(self.slice_end(until_us))?);
            self.yield_if_preempted()?;
            if self.state.borrow().now_us >= until_us {
                return Ok(());
            }
        }
    }

    /// Advances virtual time and calls the timers that are due; returns the time taken by their functions.
    pub(super) fn advance_with_timers(&self, until_us: u64) -> Result<u64, Stop> {
        let mut delay_us = 0;
        let limit_us = self.fake.limit.as_micros() as u64;
        let mut until_us = until_us.min(limit_us);
        loop {
            let due = self.state.borrow_mut().take_due_timer(until_us)?;
            let Some(callback) = due else { break };
            let start_us = self.state.borrow().now_us;
            self.state.borrow_mut().is_in_callback = true;
            // SAFETY: the program is in this call, on this thread, and the state is not borrowed.
            let outcome = unsafe { callback.call() };
            let state = &mut *self.state.borrow_mut();
            state.is_in_callback = false;
            if let Err(stop) = outcome {
                state.is_over = true;
                return Err(stop);
            }
            // Calls made by the timer's function delay the end of the interrupted call.
            delay_us += state.now_us - start_us;
            until_us = (until_us + state.now_us - start_us).min(limit_us);
        }
        let state = &mut *self.state.borrow_mut();
        state.now_us = state.now_us.max(until_us);
        state.is_over |= state.now_us >= limit_us;
        if state.is_over { Err(Stop) } else { Ok(delay_us) }
    }

    /// Index of the device with this handle; a handle has exactly one bit set.
    pub(super) fn index_of(handle: i32, count: usize) -> Option<usize> {
        (0..count.min(31)).find(|index| handle == 1 << index)
    }

    /// Handle of the device at an index; 0 for none.
    pub(super) fn handle_of(index: Option<usize>) -> i32 {
        index.filter(|index| *index < 31).map_or(0, |index| 1 << index)
    }

    /// Time and code of the next unread key in a mask; keys before it that are not in the mask are discarded.
    pub(super) fn next_key(&self, mask: i32) -> Option<(u64, i32)> {
        let state = &mut *self.state.borrow_mut();
        while let Some((time, key)) = self.fake.keys.get(state.keys_read) {
            if key.code() & mask != 0 {
                return Some((time.as_micros() as u64, key.code()));
            }
            state.keys_read += 1;
        }
        None
    }

    pub(super) fn wait_for_key(&self, name: &str, mask: i32) -> Result<i32, Stop> {
        self.act(|_| ())?;
        let Some((time_us, code)) = self.next_key(mask) else {
            self.wait(name, None)?;
            return Err(Stop);
        };
        let now_us = self.state.borrow().now_us;
        if time_us > now_us {
            self.wait(name, Some(time_us))?;
        }
        self.state.borrow_mut().keys_read += 1;
        Ok(code)
    }

    /// Starts a drive over `length` and `angle`, as long as `distance` (one of the two) takes at `speed`, whatever
    /// their signs.
    pub(super) fn drive(&self, handle: i32, length: f32, angle: f32, speed: f32, distance: f32) -> Result<i32, Stop> {
        self.act(|state| {
            let span = f64::from(distance.abs()) / f64::from(speed.abs());
            let is_arc = [length, angle, speed].iter().all(|number| number.is_finite()) && span.is_finite();
            let is_turn_in_a_curve = distance == 0.0 && angle != 0.0;
            if !(handle == DRIVE_HANDLE && state.has_drive && is_arc) || is_turn_in_a_curve {
                return -1;
            }
            state.motion.drive(state.now_us, length.into(), angle.into(), span);
            0
        })
    }

    pub(super) fn with_drive(&self, handle: i32, act: impl FnOnce(&mut State)) -> Result<i32, Stop> {
        self.act(|state| {
            if handle != DRIVE_HANDLE || !state.has_drive {
                return -1;
            }
            act(state);
            0
        })
    }
}

impl State {
    /// Ends the program because a call would wait inside a timer's function.
    pub(super) fn refuse_wait(&mut self, name: &str) -> Stop {
        self.is_over = true;
        self.failure = Some(format!("{name} waits inside of a timer's function"));
        Stop
    }

    pub(super) fn moment(&self, time_us: u64) -> Moment {
        Moment { time: Duration::from_micros(time_us), position: self.motion.pose(time_us).position() }
    }

    /// Pose of the program's odometry.
    pub(super) fn odometry_pose(&self) -> Pose {
        let (true_origin, odometry_origin) = self.origin;
        odometry_origin.compose(true_origin.relative(self.motion.pose(self.now_us)))
    }

    /// Advances the clock to the first timer that is due and returns its callback. Returns `None` while timers are held
    /// back or a timer's function runs.
    pub(super) fn take_due_timer(&mut self, until_us: u64) -> Result<Option<Callback>, Stop> {
        if self.is_over || self.tasks.must_running_task_end() {
            return Err(Stop);
        }
        if self.is_in_callback || self.are_timers_held {
            return Ok(None);
        }
        let due = self.timers.iter_mut().filter(|timer| timer.next_us <= until_us);
        let Some(timer) = due.min_by_key(|timer| (timer.next_us, timer.handle)) else { return Ok(None) };
        self.now_us = self.now_us.max(timer.next_us);
        // Missed ticks are skipped.
        timer.next_us += timer.period_us * ((self.now_us - timer.next_us) / timer.period_us + 1);
        Ok(Some(timer.callback))
    }

    /// Sets the speed that follows from the power of the motors.
    pub(super) fn apply_power(&mut self) {
        let [left, right] = self.power.map(|power| power * FULL_SPEED_MPS);
        self.motion.set_speed(self.now_us, (left + right) / 2.0, (right - left) / TRACK_M);
    }

    pub(super) fn draw_bits(&mut self, purpose: u32, seed: u64) -> u64 {
        // SplitMix64.
        let start = seed ^ u64::from(purpose).wrapping_mul(0xD134_2543_DE82_EF95);
        let state = self.random.entry(purpose).or_insert(start);
        *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (*state ^ (*state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }
}

/// Text of a call with its location.
fn text_with_location(call: &Call) -> String {
    let text = call.text.trim_end_matches(" stopped");
    match call.location {
        Some(location) => format!("{text} at {location}"),
        None => text.to_owned(),
    }
}

impl CallContext for FakeRobot {
    fn is_logging(&self) -> bool {
        true
    }

    fn log_call(&self, record: &CallRecord<'_>) {
        let state = &mut *self.state.borrow_mut();
        let call = Call {
            time: Duration::from_micros(state.now_us),
            name: record.name,
            text: record.to_string(),
            location: self.last_call_site.get(),
        };
        state.calls.push(call);
    }

    fn panicked(&self, name: &'static str, payload: Box<dyn Any + Send>) {
        let state = &mut *self.state.borrow_mut();
        state.is_over = true;
        let text = panic_text(&*payload);
        state.failure = Some(format!("the script of the test panicked in {name}: {text}"));
    }
}

fn panic_text(payload: &(dyn Any + Send)) -> &str {
    payload.downcast_ref::<String>().map(String::as_str).or(payload.downcast_ref::<&str>().copied()).unwrap_or("")
}

impl Support for FakeRobot {
    fn console(&self, _: i32, bytes: Option<&[u8]>) -> Result<i32, Stop> {
        self.act(|state| state.console.push_str(&String::from_utf8_lossy(bytes.unwrap_or_default())))?;
        Ok(0)
    }

    fn random(&self, purpose: u32) -> Result<u64, Stop> {
        self.act(|state| state.draw_bits(purpose, self.fake.seed))
    }

    fn seed(&self, purpose: u32, seed: u64) -> Result<i32, Stop> {
        self.act(|state| state.random.insert(purpose, seed ^ self.fake.seed.rotate_left(32)))?;
        Ok(0)
    }

    fn time_us(&self) -> Result<i64, Stop> {
        self.act(|state| state.now_us as i64)
    }

    fn sleep_us(&self, span_us: i64) -> Result<i32, Stop> {
        let end_us = self.state.borrow().now_us.saturating_add(span_us.max(0) as u64);
        self.sleep_until("sleep", end_us)
    }

    fn failed(&self, kind: i32, text: Option<&[u8]>, _: Option<&[u8]>) -> Result<i32, Stop> {
        let text = String::from_utf8_lossy(text.unwrap_or_default());
        let kind = if kind == robios_sys::support::failure::PANIC { "panicked at " } else { "" };
        self.state.borrow_mut().failure.get_or_insert(format!("{kind}{text}"));
        Ok(0)
    }

    fn program_name(&self, name: &mut OutBytes) -> Result<i32, Stop> {
        self.act(|_| name.set(b"program"))?;
        Ok(7)
    }

    fn show_grid(
        &self,
        name: Option<&[u8]>,
        _: i32,
        x_m: f64,
        y_m: f64,
        cell_m: f64,
        _: i32,
        _: i32,
        _: Option<&[u8]>,
    ) -> Result<i32, Stop> {
        let is_shown = is_layer_name(name) && cell_m > 0.0 && [x_m, y_m, cell_m].into_iter().all(f64::is_finite);
        Ok(i32::from(!is_shown))
    }

    fn show_points(
        &self,
        name: Option<&[u8]>,
        _: i32,
        _: i32,
        _: i32,
        coordinates: Option<&[u8]>,
    ) -> Result<i32, Stop> {
        let (numbers, _) = coordinates.unwrap_or_default().as_chunks();
        let is_shown = is_layer_name(name) && numbers.iter().all(|number| f64::from_le_bytes(*number).is_finite());
        Ok(i32::from(!is_shown))
    }

    fn show_line(
        &self,
        name: Option<&[u8]>,
        frame: i32,
        dimensions: i32,
        count: i32,
        coordinates: Option<&[u8]>,
    ) -> Result<i32, Stop> {
        self.show_points(name, frame, dimensions, count, coordinates)
    }

    fn input(&self, bytes: &mut OutBytes) -> Result<i32, Stop> {
        self.act(|state| {
            let unread = &self.fake.input.as_bytes()[state.input_read..];
            let line_len = unread.iter().position(|byte| *byte == b'\n').map_or(unread.len(), |end| end + 1);
            let count = bytes.set(&unread[..line_len]);
            state.input_read += count;
            count as i32
        })
    }
}

/// Returns true for the name of a layer.
fn is_layer_name(name: Option<&[u8]>) -> bool {
    name.is_some_and(|name| (1..=MAX_NAME).contains(&name.len()))
}
