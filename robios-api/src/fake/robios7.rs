//! RoBIOS-7 calls of the fake robot; calls that are not implemented fail as documented.

use std::time::Duration;

use robios_sys::robios7::{Char, Flag, NOKEY, Timer as TimerNumber, VEHICLE};
use robios_sys::{Callback, Out, OutBytes, OutFloats, OutInts, Robios7, Stop};

use super::camera::{gray_of_colors, is_resolution};
use super::leg::leg_functions;
use super::motion::Pose;
use super::robot::{FakeRobot, State, TICKS_PER_METRE, TimerEntry};
use super::{Fake, Moment, PsdName};
use crate::robios7::{Color, ImageSize, RobotNumber};
use crate::unit::{Angle, Length};

/// Period of the timer grid: 1 ms.
const TICK_US: u64 = 1_000;
/// Reading of a sensor with nothing in range, in millimetres.
const OUT_OF_RANGE_MM: i32 = 9999;

/// Value of a sensor in whole millimetres.
fn millimetres(distance: Option<Length>) -> i32 {
    distance.map_or(OUT_OF_RANGE_MM, |distance| (distance.as_millimetres().round() as i32).clamp(0, OUT_OF_RANGE_MM))
}

/// Converts a pose to whole millimetres and degrees, with the heading from -180 to 180.
fn pose_to_robios7(pose: Pose) -> [i32; 3] {
    let position = pose.position();
    [position.x.to_robios7(), position.y.to_robios7(), position.phi.wrapped().to_robios7()]
}

/// Index of a wheel (0 left, 1 right) by the number of its motor or encoder.
fn wheel_index(number: i32) -> Option<usize> {
    matches!(number, 1 | 2).then(|| number as usize - 1)
}

impl FakeRobot {
    /// Starts a drive that takes `span_s` seconds; returns 1 if `span_s` is not finite.
    fn start_drive7(&self, length_mm: i32, angle_deg: i32, span_s: f64) -> Result<i32, Stop> {
        self.act(|state| {
            if !span_s.is_finite() {
                return 1;
            }
            let (length, angle) = (Length::from_robios7(length_mm), Angle::from_robios7(angle_deg));
            state.motion.drive(state.now_us, length.as_metres(), angle.as_radians(), span_s);
            0
        })
    }

    /// Stores a file that the program can read again; `kind` is the digit of its format.
    fn write_image(
        &self,
        name: Option<&[u8]>,
        [columns, rows]: [i32; 2],
        kind: i32,
        image: Option<&[u8]>,
    ) -> Result<i32, Stop> {
        let (Some(name), Some(image)) = (name, image) else { return Ok(1) };
        let size = ImageSize::new(columns as u16, rows as u16);
        self.act(|state| _ = state.image_files.insert(name.to_owned(), (size, kind, image.to_owned())))?;
        Ok(0)
    }

    /// Takes the next unread touch, if its time has come.
    fn take_touch(&self, state: &mut State) -> Option<(i32, i32)> {
        let (time, pixel) = self.fake.touches.get(state.touches_read)?;
        if time.as_micros() > u128::from(state.now_us) {
            return None;
        }
        state.touches_read += 1;
        Some((pixel.x, pixel.y))
    }
}

/// Duration in seconds of a drive over a length at a speed, or over an angle at a rate of turn, whatever their signs;
/// not finite for a speed of 0.
fn span_s(distance: i32, speed: i32) -> f64 {
    f64::from(distance).abs() / f64::from(speed).abs()
}

/// Label of a key. An empty text becomes a blank: in RoBIOS-7 it clears the label, while
/// [`LcdBuffer::menu`](super::lcd::LcdBuffer::menu) ignores it, as RoBIOS 6 does.
fn key_label(text: Option<&[u8]>) -> &[u8] {
    text.filter(|text| !text.is_empty()).unwrap_or(b" ")
}

impl Robios7 for FakeRobot {
    fn LCDPrintf(&self, text: Option<&[u8]>) -> Result<i32, Stop> {
        self.act(|state| state.lcd.write(text.unwrap_or_default()))?;
        Ok(0)
    }

    fn LCDSetPrintf(&self, row: i32, column: i32, text: Option<&[u8]>) -> Result<i32, Stop> {
        self.act(|state| {
            if state.lcd.move_cursor(row, column) {
                state.lcd.write(text.unwrap_or_default());
            }
            0
        })
    }

    fn LCDClear(&self) -> Result<i32, Stop> {
        self.act(|state| {
            state.lcd.clear();
            state.pixels.clear();
        })?;
        Ok(0)
    }

    fn LCDSetPos(&self, row: i32, column: i32) -> Result<i32, Stop> {
        self.act(|state| state.lcd.move_cursor(row, column))?;
        Ok(0)
    }

    fn LCDGetPos(&self, row: &mut Out<i32>, column: &mut Out<i32>) -> Result<i32, Stop> {
        let (cursor_row, cursor_column) = self.act(|state| state.lcd.cursor())?;
        row.set(cursor_row);
        column.set(cursor_column);
        Ok(0)
    }

    fn LCDSetColor(&self, _: i32, _: i32) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn LCDSetFont(&self, font: i32, variation: i32) -> Result<i32, Stop> {
        self.act(|_| i32::from(!(0..=2).contains(&font) || !(0..=2).contains(&variation)))
    }

    fn LCDSetFontSize(&self, size: i32) -> Result<i32, Stop> {
        self.act(|_| i32::from(![8, 12, 14, 18, 24].contains(&size)))
    }

    fn LCDMenu(
        &self,
        st1: Option<&[u8]>,
        st2: Option<&[u8]>,
        st3: Option<&[u8]>,
        st4: Option<&[u8]>,
    ) -> Result<i32, Stop> {
        self.act(|state| {
            for (key, text) in [st1, st2, st3, st4].into_iter().enumerate() {
                state.lcd.menu(key, key_label(text));
            }
        })?;
        Ok(0)
    }

    fn LCDMenuI(&self, pos: i32, text: Option<&[u8]>, _: i32, _: i32) -> Result<i32, Stop> {
        self.act(|state| match pos {
            1..=4 => {
                state.lcd.menu(pos as usize - 1, key_label(text));
                0
            }
            _ => 1,
        })
    }

    fn LCDGetSize(&self, x: &mut Out<i32>, y: &mut Out<i32>) -> Result<i32, Stop> {
        self.act(|_| ())?;
        x.set(480);
        y.set(320);
        Ok(0)
    }

    fn LCDPixel(&self, x: i32, y: i32, color: i32) -> Result<i32, Stop> {
        self.act(|state| state.pixels.insert((x, y), Color::from_robios(color)))?;
        Ok(0)
    }

    fn LCDGetPixel(&self, x: i32, y: i32) -> Result<i32, Stop> {
        self.act(|state| state.pixels.get(&(x, y)).map_or(0, |color| color.to_robios()))
    }

    fn LCDLine(&self, _: i32, _: i32, _: i32, _: i32, _: i32) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn LCDArea(&self, _: i32, _: i32, _: i32, _: i32, _: i32, _: i32) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn LCDCircle(&self, _: i32, _: i32, _: i32, _: i32, _: i32) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn LCDRefresh(&self) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn KEYGet(&self) -> Result<i32, Stop> {
        self.wait_for_key("KEYGet", !0)
    }

    fn KEYRead(&self) -> Result<i32, Stop> {
        self.act(|state| match self.fake.keys.get(state.keys_read) {
            Some((time, key)) if time.as_micros() <= u128::from(state.now_us) => {
                state.keys_read += 1;
                key.code()
            }
            _ => NOKEY,
        })
    }

    fn KEYWait(&self, key: i32) -> Result<i32, Stop> {
        self.wait_for_key("KEYWait", key)
    }

    fn KEYGetXY(&self, x: &mut Out<i32>, y: &mut Out<i32>) -> Result<i32, Stop> {
        self.act(|_| ())?;
        let next = self.state.borrow().touches_read;
        let time_us = self.fake.touches.get(next).map(|(time, _)| time.as_micros() as u64);
        let now_us = self.state.borrow().now_us;
        if time_us.is_none_or(|time_us| time_us > now_us) {
            self.wait("KEYGetXY", time_us)?;
        }
        if let Some((touch_x, touch_y)) = self.take_touch(&mut self.state.borrow_mut()) {
            x.set(touch_x);
            y.set(touch_y);
        }
        Ok(0)
    }

    fn KEYReadXY(&self, x: &mut Out<i32>, y: &mut Out<i32>) -> Result<i32, Stop> {
        let touch = self.act(|state| self.take_touch(state))?;
        let Some((touch_x, touch_y)) = touch else { return Ok(1) };
        x.set(touch_x);
        y.set(touch_y);
        Ok(0)
    }

    fn IPReadFile(
        &self,
        name: Option<&[u8]>,
        width_px: i32,
        height_px: i32,
        image: &mut OutBytes,
    ) -> Result<i32, Stop> {
        self.act(|state| {
            let Some((size, kind, bytes)) = state.image_files.get(name.unwrap_or_default()) else { return -1 };
            let depth = bytes.len() / size.pixels().max(1);
            let pixel = |at| size.index_of(at).map_or(&[0; 3][..depth], |index| &bytes[depth * index..][..depth]);
            let wanted_size = ImageSize::new(width_px as u16, height_px as u16);
            image.set(&wanted_size.places().flat_map(pixel).copied().collect::<Vec<u8>>());
            *kind
        })
    }

    fn IPWriteFile(
        &self,
        name: Option<&[u8]>,
        width_px: i32,
        height_px: i32,
        image: Option<&[u8]>,
    ) -> Result<i32, Stop> {
        self.write_image(name, [width_px, height_px], 6, image)
    }

    fn IPWriteFileGray(
        &self,
        name: Option<&[u8]>,
        width_px: i32,
        height_px: i32,
        image: Option<&[u8]>,
    ) -> Result<i32, Stop> {
        self.write_image(name, [width_px, height_px], 5, image)
    }

    fn IPCol2Gray(&self, image: Option<&[u8]>, gray: &mut OutBytes) -> Result<(), Stop> {
        self.act(|_| _ = gray.set(&gray_of_colors(image.unwrap_or_default())))
    }

    fn IPGray2Col(&self, gray: Option<&[u8]>, image: &mut OutBytes) -> Result<(), Stop> {
        self.act(|_| _ = image.set(&gray.unwrap_or_default().iter().flat_map(|level| [*level; 3]).collect::<Vec<u8>>()))
    }

    fn OSVersion(&self, text: &mut OutBytes) -> Result<i32, Stop> {
        self.act(|_| text.set(b"1.0\0"))?;
        Ok(0)
    }

    fn OSMachineName(&self, text: &mut OutBytes) -> Result<i32, Stop> {
        self.act(|_| text.set(b"Fake\0"))?;
        Ok(0)
    }

    fn OSMachineID(&self) -> Result<i32, Stop> {
        self.act(|_| 1)
    }

    fn OSMachineType(&self) -> Result<i32, Stop> {
        self.act(|_| VEHICLE)
    }

    fn OSMachineSpeed(&self) -> Result<i32, Stop> {
        self.act(|_| 700_000_000)
    }

    fn OSError(&self, message: Option<&[u8]>, number: i32, dead: i32) -> Result<i32, Stop> {
        self.act(|state| {
            let text = String::from_utf8_lossy(message.unwrap_or_default()).into_owned();
            state.lcd.write(format!("{text}{number}").as_bytes());
        })?;
        if dead != 0 {
            self.wait("OSError", None)?;
        }
        self.wait_for_key("OSError", !0)?;
        Ok(0)
    }

    fn OSWait(&self, n: i32) -> Result<i32, Stop> {
        let end_us = self.state.borrow().now_us + n.max(0) as u64 * 1_000;
        self.wait("OSWait", Some(end_us))?;
        Ok(0)
    }

    fn OSAttachTimer(&self, scale: i32, function: Option<Callback>) -> Result<TimerNumber, Stop> {
        self.act(|state| {
            let (Ok(scale @ 1..), Some(callback)) = (u64::try_from(scale), function) else { return 0 };
            let period_us = scale * TICK_US;
            let handle = state.next_timer;
            state.next_timer += 1;
            let next_us = state.now_us / TICK_US * TICK_US + period_us;
            state.timers.push(TimerEntry { handle, period_us, next_us, callback });
            handle
        })
    }

    fn OSDetachTimer(&self, handle: TimerNumber) -> Result<i32, Stop> {
        self.act(|state| {
            let count = state.timers.len();
            state.timers.retain(|timer| timer.handle != handle);
            i32::from(state.timers.len() == count)
        })
    }

    fn OSSetTime(&self, hrs: i32, mins: i32, secs: i32) -> Result<i32, Stop> {
        self.act(|state| {
            if !((0..24).contains(&hrs) && (0..60).contains(&mins) && (0..60).contains(&secs)) {
                return 1;
            }
            state.clock_offset_us = i64::from(hrs * 3600 + mins * 60 + secs) * 1_000_000 - state.now_us as i64;
            0
        })
    }

    fn OSGetTime(
        &self,
        hrs: &mut Out<i32>,
        mins: &mut Out<i32>,
        secs: &mut Out<i32>,
        ticks: &mut Out<i32>,
    ) -> Result<i32, Stop> {
        let millis = self.act(|state| (state.now_us as i64 + state.clock_offset_us) / 1_000)?;
        hrs.set((millis / 3_600_000 % 24) as i32);
        mins.set((millis / 60_000 % 60) as i32);
        secs.set((millis / 1_000 % 60) as i32);
        ticks.set((millis % 1_000) as i32);
        Ok(0)
    }

    fn OSGetCount(&self) -> Result<i32, Stop> {
        self.act(|state| (state.now_us / 1_000) as i32)
    }

    fn SERCheck(&self, _: i32) -> Result<Flag, Stop> {
        self.act(|_| 0)
    }

    fn RADIOInit(&self) -> Result<i32, Stop> {
        let was_on = self.switch_radio(true)?;
        Ok(i32::from(was_on))
    }

    fn RADIOGetID(&self) -> Result<i32, Stop> {
        self.radio_id()
    }

    fn RADIOSend(&self, id: i32, buf: Option<&[u8]>) -> Result<i32, Stop> {
        let Ok(id) = u8::try_from(id) else { return Ok(1) };
        let is_sent = self.radio_send(RobotNumber(id), buf, crate::robios7::MAX_MESSAGE)?;
        Ok(i32::from(!is_sent))
    }

    fn RADIOReceive(&self, id: &mut Out<i32>, buf: &mut OutBytes) -> Result<i32, Stop> {
        let Some(message) = self.radio_receive("RADIOReceive")? else { return Ok(1) };
        id.set(message.from.0.into());
        let len = message.bytes.iter().position(|byte| *byte == 0).unwrap_or(message.bytes.len());
        let max_len = buf.capacity().saturating_sub(1);
        buf.set(&[&message.bytes[..len.min(max_len)], &[0]].concat());
        Ok(0)
    }

    fn RADIOCheck(&self) -> Result<i32, Stop> {
        self.radio_waiting()
    }

    fn RADIOStatus(&self, ids: &mut OutInts) -> Result<i32, Stop> {
        let id = self.radio_id()?;
        ids.set(&[id]);
        Ok(1)
    }

    fn RADIORelease(&self) -> Result<i32, Stop> {
        let was_on = self.switch_radio(false)?;
        Ok(i32::from(!was_on))
    }

    fn AUBeep(&self) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn AUTone(&self, freq_hz: i32, _: i32) -> Result<i32, Stop> {
        self.act(|_| i32::from(!(65..=21_000).contains(&freq_hz)))
    }

    fn PSDGet(&self, psd: i32) -> Result<i32, Stop> {
        self.act(|state| {
            let sensor = self
                .fake
                .psds
                .iter()
                .find(|(name, _)| matches!(name, PsdName::Number(number) if i32::from(*number) == psd));
            sensor.map_or(0, |(_, distance)| millimetres(distance(&state.moment(state.now_us))))
        })
    }

    fn PSDGetSignal(&self, psd: i32) -> Result<f32, Stop> {
        self.act(|state| {
            let has_number = |name: &PsdName| matches!(name, PsdName::Number(number) if i32::from(*number) == psd);
            let index = self.fake.psds.iter().position(|(name, _)| has_number(name))?;
            Some(self.fake.signal_of(index, &state.moment(state.now_us)))
        })
        .map(|signal| signal.unwrap_or(-1.0))
    }

    fn CAMInit(&self, resolution: i32, width_px: i32, height_px: i32) -> Result<i32, Stop> {
        self.act(|state| {
            let (Ok(columns), Ok(rows)) = (u16::try_from(width_px), u16::try_from(height_px)) else { return 1 };
            let is_supported = is_resolution(resolution) && columns > 0 && rows > 0;
            i32::from(!(is_supported && self.switch_camera_on(state, ImageSize::new(columns, rows))))
        })
    }

    fn CAMRelease(&self) -> Result<i32, Stop> {
        self.act(|state| i32::from(state.camera.take().is_none()))
    }

    fn CAMGet(&self, buf: &mut OutBytes) -> Result<i32, Stop> {
        self.act(|state| write_value(self.colors(state, None), |bytes| _ = buf.set(&bytes)))
    }

    fn CAMGetGray(&self, buf: &mut OutBytes) -> Result<i32, Stop> {
        self.act(|state| write_value(self.grays(state), |bytes| _ = buf.set(&bytes)))
    }

    fn CAMGetDepth(&self, mm: &mut OutFloats) -> Result<i32, Stop> {
        self.act(|state| write_value(self.depths(state), |depths| _ = mm.set(&depths)))
    }

    fn CAMGetLabels(&self, labels: &mut OutInts) -> Result<i32, Stop> {
        self.act(|state| write_value(self.labels(state), |numbers| _ = labels.set(&numbers)))
    }

    fn LIDARGet(&self, distance: &mut OutInts) -> Result<i32, Stop> {
        self.act(|state| {
            let Some(distances) = self.fake.scan(state) else { return 1 };
            distance.set(&distances);
            0
        })
    }

    fn LIDARSet(&self, range: i32, _: i32, points: i32) -> Result<(), Stop> {
        self.act(|state| state.scan = (range, points))
    }

    fn SERVOSet(&self, servo: i32, angle: i32) -> Result<i32, Stop> {
        self.act(|_| i32::from(!(1..=14).contains(&servo) || !(0..=255).contains(&angle)))
    }

    fn MOTORDrive(&self, motor: i32, speed: i32) -> Result<i32, Stop> {
        self.act(|state| match wheel_index(motor) {
            Some(side) if (-100..=100).contains(&speed) => {
                state.power[side] = f64::from(speed) / 100.0;
                state.apply_power();
                0
            }
            _ => 1,
        })
    }

    fn ENCODERRead(&self, quad: i32) -> Result<i32, Stop> {
        self.act(|state| {
            let ticks = |side: usize| {
                (state.motion.rolled(state.now_us)[side] - state.rolled_at_tick_reset[side]) * TICKS_PER_METRE
            };
            wheel_index(quad).map_or(0, |side| ticks(side).floor() as i32)
        })
    }

    fn ENCODERReset(&self, quad: i32) -> Result<i32, Stop> {
        self.act(|state| {
            let Some(side) = wheel_index(quad) else { return 1 };
            state.rolled_at_tick_reset[side] = state.motion.rolled(state.now_us)[side];
            0
        })
    }

    fn VWSetSpeed(&self, lin_speed: i32, ang_speed: i32) -> Result<i32, Stop> {
        self.act(|state| {
            let (v, w) = (f64::from(lin_speed) / 1000.0, f64::from(ang_speed).to_radians());
            state.motion.set_speed(state.now_us, v, w);
            0
        })
    }

    fn VWGetSpeed(&self, lin_speed: &mut Out<i32>, ang_speed: &mut Out<i32>) -> Result<i32, Stop> {
        let (v, w) = self.act(|state| state.motion.speed(state.now_us))?;
        lin_speed.set((v * 1000.0).round() as i32);
        ang_speed.set(w.to_degrees().round() as i32);
        Ok(0)
    }

    fn VWSetPosition(&self, x: i32, y: i32, phi: i32) -> Result<i32, Stop> {
        self.act(|state| {
            let odometry =
                Pose { x: f64::from(x) / 1000.0, y: f64::from(y) / 1000.0, phi: f64::from(phi).to_radians() };
            state.origin = (state.motion.pose(state.now_us), odometry);
            0
        })
    }

    fn VWGetPosition(&self, x: &mut Out<i32>, y: &mut Out<i32>, phi: &mut Out<i32>) -> Result<i32, Stop> {
        let [x_mm, y_mm, phi_deg] = pose_to_robios7(self.act(|state| state.odometry_pose())?);
        x.set(x_mm);
        y.set(y_mm);
        phi.set(phi_deg);
        Ok(0)
    }

    fn VWStraight(&self, dist: i32, lin_speed: i32) -> Result<i32, Stop> {
        self.start_drive7(dist, 0, span_s(dist, lin_speed))
    }

    fn VWTurn(&self, angle: i32, ang_speed: i32) -> Result<i32, Stop> {
        self.start_drive7(0, angle, span_s(angle, ang_speed))
    }

    fn VWCurve(&self, dist: i32, angle: i32, lin_speed: i32) -> Result<i32, Stop> {
        let is_turn_on_the_spot = dist == 0 && angle != 0;
        let span_s = if is_turn_on_the_spot { f64::INFINITY } else { span_s(dist, lin_speed) };
        self.start_drive7(dist, angle, span_s)
    }

    fn VWDrive(&self, dx: i32, dy: i32, lin_speed: i32) -> Result<i32, Stop> {
        // An arc that starts along x and ends at (dx, dy) changes the heading by twice the direction of (dx, dy). An
        // arc to a point behind is driven backwards.
        let sign = if dx < 0 { -1.0 } else { 1.0 };
        let (ahead, left) = (Length::from_robios7(dx).abs(), Length::from_robios7(dy));
        let (direction, chord) = (Angle::towards(ahead, left), Length::of_vector(ahead, left));
        let is_straight = direction.abs() < Angle::degrees(1e-9);
        let length = if is_straight { chord } else { chord * (direction.as_radians() / direction.sin()) };
        let span_s = length.as_millimetres() / f64::from(lin_speed).abs();
        self.act(|state| {
            if !span_s.is_finite() {
                return 1;
            }
            state.motion.drive(state.now_us, sign * length.as_metres(), sign * 2.0 * direction.as_radians(), span_s);
            0
        })
    }

    fn VWRemain(&self) -> Result<i32, Stop> {
        self.act(|state| {
            let remaining = state.motion.remaining(state.now_us);
            let is_turn = state.motion.is_turn(state.now_us);
            // Rounded up: 0 only when nothing remains.
            ((if is_turn { remaining.to_degrees() } else { remaining * 1000.0 }) - 1e-6).ceil() as i32
        })
    }

    fn VWDone(&self) -> Result<i32, Stop> {
        self.act(|state| i32::from(state.motion.drive_end_us(state.now_us).is_none()))
    }

    fn VWWait(&self) -> Result<i32, Stop> {
        let end_us = self.act(|state| state.motion.drive_end_us(state.now_us))?;
        if end_us.is_some() {
            self.wait("VWWait", end_us)?;
        }
        Ok(0)
    }

    fn VWStalled(&self) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn VWControl(&self, _: i32, _: i32, _: i32, _: i32) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn VWControlOff(&self) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn DIGITALSetup(&self, io: i32, direction: Char) -> Result<i32, Stop> {
        self.act(|state| {
            if !(1..=16).contains(&io) {
                return 1;
            }
            let line = 1 << (io - 1);
            // An input with a resistor to the supply voltage is high; everything else is low at first.
            state.lines = if direction == b'I' { state.lines | line } else { state.lines & !line };
            state.outputs = if direction == b'o' { state.outputs | line } else { state.outputs & !line };
            0
        })
    }

    fn DIGITALRead(&self, io: i32) -> Result<i32, Stop> {
        self.act(|state| if (1..=16).contains(&io) { i32::from(state.lines & (1 << (io - 1)) != 0) } else { -1 })
    }

    fn DIGITALReadAll(&self) -> Result<i32, Stop> {
        self.act(|state| state.lines)
    }

    fn DIGITALWrite(&self, io: i32, value: i32) -> Result<i32, Stop> {
        self.act(|state| {
            if !(1..=16).contains(&io) || state.outputs & (1 << (io - 1)) == 0 {
                return 1;
            }
            let line = 1 << (io - 1);
            state.lines = if value == 0 { state.lines & !line } else { state.lines | line };
            0
        })
    }

    fn SIMGetRobot(
        &self,
        id: i32,
        x: &mut Out<i32>,
        y: &mut Out<i32>,
        z: &mut Out<i32>,
        phi: &mut Out<i32>,
    ) -> Result<(), Stop> {
        let pose = self.act(|state| state.motion.pose(state.now_us))?;
        if matches!(id, 0 | 1) {
            let [x_mm, y_mm, phi_deg] = pose_to_robios7(pose);
            x.set(x_mm);
            y.set(y_mm);
            z.set(0);
            phi.set(phi_deg);
        }
        Ok(())
    }

    fn SIMGetRobotCount(&self) -> Result<i32, Stop> {
        self.act(|_| 1)
    }

    fn SIMGetObjectCount(&self) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    leg_functions!();
}

/// Passes a value to `write`; returns 0, or 1 if there is no value.
fn write_value<T>(value: Option<T>, write: impl FnOnce(T)) -> i32 {
    i32::from(value.map(write).is_none())
}

/// Script of a laser scanner: distance by direction in the robot's frame.
pub type Scanner = Box<dyn Fn(&Moment, Angle) -> Option<Length> + Send>;

/// Times and places of touches.
pub type Touches = Vec<(Duration, crate::Pixel)>;

impl Fake {
    /// Current scan in millimetres; `None` without a laser scanner.
    pub(super) fn scan(&self, state: &State) -> Option<Vec<i32>> {
        let scanner = self.lidar.as_ref()?;
        let (range_deg, points) = state.scan;
        let spacings = if range_deg == 360 || points % 2 == 0 { points } else { points - 1 };
        let spacing = Angle::degrees(f64::from(range_deg) / f64::from(spacings.max(1)));
        let moment = state.moment(state.now_us);
        let direction = |index: i32| spacing * f64::from(points / 2 - index);
        Some((0..points).map(|index| millimetres(scanner(&moment, direction(index)))).collect())
    }
}
