//! RoBIOS 6 calls of the fake robot; calls that are not implemented fail as documented.

use std::time::Duration;

use robios_sys::robios6::{
    BayerFrame, COLCAM, Char, ColorFrame, FALSE, INITERROR, MonoFrame, MotorHandle, NOCAM, NOKEY, NORMAL,
    PSD_OUT_OF_RANGE, PositionType, QuadHandle, RadioIOParameters, RadioStatus, SCROLLING, SpeedType, TELE, TRUE,
    VEHICLE, WIDE, semantics,
};
use robios_sys::{Callback, Out, OutBytes, OutFloats, OutInts, Robios6, Stop};

use super::PsdName;
use super::leg::leg_functions;
use super::motion::Pose;
use super::radio::MAX_MESSAGE_ROBIOS6;
use super::robot::{DRIVE_HANDLE, FakeRobot, PSD_CYCLE_US, PsdMeasurement, TICKS_PER_METRE, TIMER_TICK_US, TimerEntry};
use crate::device::{BumperAt, InfraredAt, PsdAt};
use crate::image::ImageSize;
use crate::os::RobotNumber;

/// Writes an image to a buffer; returns 0, or -1 if there is no image.
fn write_frame<const N: usize>(bytes: Option<Vec<u8>>, buffer: &mut Out<[u8; N]>) -> i32 {
    match bytes.and_then(|bytes| bytes.try_into().ok()) {
        Some(frame) => {
            buffer.set(frame);
            0
        }
        None => -1,
    }
}

impl Robios6 for FakeRobot {
    fn OSVersion(&self, text: &mut OutBytes) -> Result<i32, Stop> {
        self.act(|_| text.set(b"6.5") as i32)
    }

    fn OSMachineName(&self, text: &mut OutBytes) -> Result<i32, Stop> {
        self.act(|_| text.set(b"Fake") as i32)
    }

    fn OSMachineID(&self) -> Result<u8, Stop> {
        self.act(|_| 1)
    }

    fn OSMachineType(&self) -> Result<i32, Stop> {
        self.act(|_| VEHICLE)
    }

    fn OSMachineSpeed(&self) -> Result<i32, Stop> {
        self.act(|_| 25_000_000)
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

    fn OSEnable(&self) -> Result<i32, Stop> {
        self.act(|state| state.are_timers_held = false)?;
        Ok(0)
    }

    fn OSDisable(&self) -> Result<i32, Stop> {
        self.act(|state| state.are_timers_held = true)?;
        Ok(0)
    }

    fn OSGetVar(&self, num: i32) -> Result<i32, Stop> {
        self.act(|state| usize::try_from(num).ok().and_then(|num| state.variables.get(num).copied()).unwrap_or(0))
    }

    fn OSPutVar(&self, num: i32, value: i32) -> Result<i32, Stop> {
        self.act(|state| match usize::try_from(num).ok().and_then(|num| state.variables.get_mut(num)) {
            Some(variable) => {
                *variable = value;
                0
            }
            None => -1,
        })
    }

    fn LCDPutString(&self, s: Option<&[u8]>) -> Result<i32, Stop> {
        self.act(|state| {
            s.map_or(-1, |s| {
                state.lcd.write(s);
                0
            })
        })
    }

    fn LCDPrintf(&self, text: Option<&[u8]>) -> Result<i32, Stop> {
        self.LCDPutString(text)
    }

    fn LCDSetString(&self, row: i32, column: i32, s: Option<&[u8]>) -> Result<i32, Stop> {
        self.act(|state| match s {
            Some(s) if state.lcd.move_cursor(row, column) => {
                state.lcd.write(s);
                0
            }
            _ => -1,
        })
    }

    fn LCDSetPrintf(&self, row: i32, column: i32, text: Option<&[u8]>) -> Result<i32, Stop> {
        self.LCDSetString(row, column, text)
    }

    fn LCDClear(&self) -> Result<i32, Stop> {
        self.act(|state| state.lcd.clear())?;
        Ok(0)
    }

    fn LCDMode(&self, mode: i32) -> Result<i32, Stop> {
        self.act(|state| state.lcd.is_scrolling = mode & SCROLLING != 0)?;
        Ok(0)
    }

    fn LCDSetPos(&self, row: i32, column: i32) -> Result<i32, Stop> {
        self.act(|state| if state.lcd.move_cursor(row, column) { 0 } else { -1 })
    }

    fn LCDGetPos(&self, row: &mut Out<i32>, column: &mut Out<i32>) -> Result<i32, Stop> {
        let (cursor_row, cursor_column) = self.act(|state| state.lcd.cursor())?;
        row.set(cursor_row);
        column.set(cursor_column);
        Ok(0)
    }

    fn LCDMenu(&self, s1: Option<&[u8]>, s2: Option<&[u8]>, s3: Option<&[u8]>, s4: Option<&[u8]>) -> Result<i32, Stop> {
        self.act(|state| {
            for (key, text) in [s1, s2, s3, s4].into_iter().enumerate() {
                state.lcd.menu(key, text.unwrap_or_default());
            }
        })?;
        Ok(0)
    }

    fn LCDMenuI(&self, pos: i32, s: Option<&[u8]>) -> Result<i32, Stop> {
        self.act(|state| match (pos, s) {
            (1..=4, Some(s)) => {
                state.lcd.menu(pos as usize - 1, s);
                0
            }
            _ => -1,
        })
    }

    fn LCDSetPixel(&self, row: i32, col: i32, val: i32) -> Result<i32, Stop> {
        self.act(|state| if state.lcd.draw(col, row, val) { 0 } else { -1 })
    }

    fn LCDInvertPixel(&self, row: i32, col: i32) -> Result<i32, Stop> {
        self.LCDSetPixel(row, col, 2)
    }

    fn LCDGetPixel(&self, row: i32, col: i32) -> Result<i32, Stop> {
        self.act(|state| state.lcd.pixel(col, row).map_or(-1, i32::from))
    }

    fn LCDLine(&self, x1: i32, y1: i32, x2: i32, y2: i32, col: i32) -> Result<i32, Stop> {
        self.act(|state| state.lcd.line((x1, y1), (x2, y2), col))?;
        Ok(0)
    }

    fn LCDArea(&self, x1: i32, y1: i32, x2: i32, y2: i32, col: i32) -> Result<i32, Stop> {
        self.act(|state| {
            if x1 >= x2 || y1 >= y2 {
                return -1;
            }
            for y in y1.max(0)..=y2.min(63) {
                for x in x1.max(0)..=x2.min(127) {
                    state.lcd.draw(x, y, col);
                }
            }
            0
        })
    }

    fn KEYGet(&self) -> Result<i32, Stop> {
        self.wait_for_key("KEYGet", !0)
    }

    fn KEYGetBuf(&self, buf: &mut Out<Char>) -> Result<i32, Stop> {
        buf.set(self.wait_for_key("KEYGetBuf", !0)? as Char);
        Ok(0)
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

    fn KEYWait(&self, excode: i32) -> Result<i32, Stop> {
        self.wait_for_key("KEYWait", excode)?;
        Ok(0)
    }

    fn OSSetTime(&self, h: i32, m: i32, s: i32) -> Result<i32, Stop> {
        self.act(|state| {
            if !((0..24).contains(&h) && (0..60).contains(&m) && (0..60).contains(&s)) {
                return -1;
            }
            state.clock_offset_us = i64::from(h * 3600 + m * 60 + s) * 1_000_000 - state.now_us as i64;
            0
        })
    }

    fn OSGetTime(
        &self,
        h: &mut Out<i32>,
        m: &mut Out<i32>,
        s: &mut Out<i32>,
        ticks: &mut Out<i32>,
    ) -> Result<i32, Stop> {
        let hundredths = self.act(|state| (state.now_us as i64 + state.clock_offset_us) / 10_000)?;
        h.set((hundredths / 360_000 % 24) as i32);
        m.set((hundredths / 6_000 % 60) as i32);
        s.set((hundredths / 100 % 60) as i32);
        ticks.set((hundredths % 100) as i32);
        Ok(0)
    }

    fn OSGetCount(&self) -> Result<i32, Stop> {
        self.act(|state| (state.now_us / TIMER_TICK_US) as i32)
    }

    fn OSWait(&self, n: i32) -> Result<i32, Stop> {
        let end_us = self.state.borrow().now_us + n.max(0) as u64 * TIMER_TICK_US;
        self.wait("OSWait", Some(end_us))?;
        Ok(0)
    }

    fn OSAttachTimer(&self, scale: i32, f: Option<Callback>) -> Result<i32, Stop> {
        self.act(|state| {
            let (Ok(scale @ 1..), Some(callback)) = (u64::try_from(scale), f) else { return 0 };
            let period_us = scale * TIMER_TICK_US;
            let handle = state.next_timer;
            state.next_timer += 1;
            let next_us = state.now_us / TIMER_TICK_US * TIMER_TICK_US + period_us;
            state.timers.push(TimerEntry { handle, period_us, next_us, callback });
            handle
        })
    }

    fn OSDetachTimer(&self, handle: i32) -> Result<i32, Stop> {
        self.act(|state| {
            let count = state.timers.len();
            state.timers.retain(|timer| timer.handle != handle);
            i32::from(state.timers.len() < count)
        })
    }

    fn OSMTInit(&self, mode: u8) -> Result<i32, Stop> {
        self.start_tasks(mode)
    }

    fn OSSpawn(&self, name: Option<&[u8]>, code: Option<Callback>, _: i32, pri: i32, uid: i32) -> Result<i32, Stop> {
        code.map_or(Ok(0), |code| self.spawn_task(name, code, pri, uid))
    }

    fn OSMTStatus(&self) -> Result<i32, Stop> {
        self.task_mode()
    }

    fn OSReady(&self, thread: i32) -> Result<i32, Stop> {
        self.ready_task(thread)
    }

    fn OSSuspend(&self, thread: i32) -> Result<i32, Stop> {
        self.suspend_task("OSSuspend", thread)
    }

    fn OSReschedule(&self) -> Result<i32, Stop> {
        self.reschedule()
    }

    fn OSYield(&self) -> Result<i32, Stop> {
        self.suspend_task("OSYield", 0)
    }

    fn OSRun(&self, thread: i32) -> Result<i32, Stop> {
        self.run_task(thread)
    }

    fn OSGetUID(&self, thread: i32) -> Result<i32, Stop> {
        self.task_uid(thread)
    }

    fn OSKill(&self, thread: i32) -> Result<i32, Stop> {
        self.kill_task(thread)
    }

    fn OSSleep(&self, n: i32) -> Result<i32, Stop> {
        self.sleep_task(n)
    }

    fn OSForbid(&self) -> Result<i32, Stop> {
        self.permit_tasks(false)
    }

    fn OSPermit(&self) -> Result<i32, Stop> {
        self.permit_tasks(true)
    }

    fn OSSemInit(&self, sem: Option<&mut i32>, val: i32) -> Result<i32, Stop> {
        let (Some(sem), Some(number)) = (sem, self.make_semaphore(val)?) else { return Ok(-1) };
        *sem = number;
        Ok(0)
    }

    fn OSSemP(&self, sem: i32) -> Result<i32, Stop> {
        self.take_permit(sem)
    }

    fn OSSemV(&self, sem: i32) -> Result<i32, Stop> {
        self.return_permit(sem)
    }

    fn RADIOInit(&self) -> Result<i32, Stop> {
        let was_on = self.switch_radio(true)?;
        Ok(if was_on { -1 } else { 0 })
    }

    fn RADIOTerm(&self) -> Result<i32, Stop> {
        let was_on = self.switch_radio(false)?;
        Ok(if was_on { 0 } else { -1 })
    }

    fn RADIOSend(&self, id: u8, buffer: Option<&[u8]>) -> Result<i32, Stop> {
        let is_sent = self.radio_send(RobotNumber(id), buffer, MAX_MESSAGE_ROBIOS6)?;
        Ok(i32::from(!is_sent))
    }

    fn RADIOCheck(&self) -> Result<i32, Stop> {
        self.radio_waiting()
    }

    fn RADIORecv(&self, id: &mut Out<u8>, received: &mut Out<i32>, buffer: &mut OutBytes) -> Result<i32, Stop> {
        let Some(message) = self.radio_receive("RADIORecv")? else { return Ok(-1) };
        id.set(message.from.0);
        received.set(message.bytes.len().min(MAX_MESSAGE_ROBIOS6) as i32);
        buffer.set(&message.bytes[..message.bytes.len().min(MAX_MESSAGE_ROBIOS6)]);
        Ok(0)
    }

    fn RADIOGetIoctl(&self, p: &mut Out<RadioIOParameters>) -> Result<i32, Stop> {
        p.set(self.radio_settings()?);
        Ok(0)
    }

    fn RADIOSetIoctl(&self, p: Option<&RadioIOParameters>) -> Result<i32, Stop> {
        let Some(settings) = p else { return Ok(-1) };
        let is_set = self.set_radio(*settings)?;
        Ok(if is_set { 0 } else { -1 })
    }

    fn RADIOGetStatus(&self, s: &mut Out<RadioStatus>) -> Result<i32, Stop> {
        s.set(self.radio_status()?);
        Ok(0)
    }

    fn AUTone(&self, freq_hz: i32, _: i32) -> Result<i32, Stop> {
        self.act(|_| if (65..=21_000).contains(&freq_hz) { 0 } else { -1 })
    }

    fn AUBeep(&self) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn PSDInit(&self, semantics: i32) -> Result<i32, Stop> {
        let position = PsdAt::from_semantics(semantics);
        self.act(|_| Self::handle_of(self.fake.psds.iter().position(|(at, _)| *at == PsdName::At(position))))
    }

    fn PSDRelease(&self) -> Result<i32, Stop> {
        self.act(|state| state.psd = None)?;
        Ok(0)
    }

    fn PSDStart(&self, mask: i32, cycle: i32) -> Result<i32, Stop> {
        self.act(|state| {
            if mask >> self.fake.psds.len().min(31) != 0 {
                return -1;
            }
            let is_busy = state.psd.is_some_and(|psd| psd.last.is_none_or(|last| psd.cycles(state.now_us) < last));
            if is_busy {
                return 1;
            }
            let last = if cycle == FALSE { Some(1) } else { None };
            state.psd = Some(PsdMeasurement { start_us: state.now_us, mask, last });
            0
        })
    }

    fn PSDStop(&self) -> Result<i32, Stop> {
        self.act(|state| {
            let now_us = state.now_us;
            if let Some(psd) = &mut state.psd {
                psd.last = psd.last.or(Some(psd.cycles(now_us) + 1));
            }
        })?;
        Ok(0)
    }

    fn PSDCheck(&self) -> Result<i32, Stop> {
        self.act(|state| if state.psd.is_some_and(|psd| psd.cycles(state.now_us) > 0) { TRUE } else { FALSE })
    }

    fn PSDGet(&self, handle: i32) -> Result<i32, Stop> {
        self.act(|state| {
            let Some(psd) = state.psd else { return if handle == 0 { 0 } else { PSD_OUT_OF_RANGE } };
            let time_us = psd.start_us + psd.cycles(state.now_us) * PSD_CYCLE_US;
            if handle == 0 {
                return (time_us / TIMER_TICK_US) as i32;
            }
            let distance = Self::index_of(handle & psd.mask, self.fake.psds.len())
                .filter(|_| psd.cycles(state.now_us) > 0)
                .and_then(|index| self.fake.psds[index].1(&state.moment(time_us)));
            distance.map_or(PSD_OUT_OF_RANGE, |distance| distance.as_millimetres().round().max(0.0) as i32)
        })
    }

    fn PSDGetSignal(&self, handle: i32) -> Result<f32, Stop> {
        self.act(|state| {
            let psd = state.psd.filter(|psd| psd.cycles(state.now_us) > 0)?;
            let time_us = psd.start_us + psd.cycles(state.now_us) * PSD_CYCLE_US;
            let index = Self::index_of(handle & psd.mask, self.fake.psds.len())?;
            Some(self.fake.signal_of(index, &state.moment(time_us)))
        })
        .map(|signal| signal.unwrap_or(-1.0))
    }

    fn CAMInit(&self, mode: i32) -> Result<i32, Stop> {
        self.act(|state| match mode {
            NORMAL | WIDE | TELE if self.switch_camera_on(state, ImageSize::EYECAM) => COLCAM,
            NORMAL | WIDE | TELE => NOCAM,
            _ => INITERROR,
        })
    }

    fn CAMRelease(&self) -> Result<i32, Stop> {
        self.act(|state| if state.camera.take().is_some() { 0 } else { -1 })
    }

    fn CAMGetFrameMono(&self, buf: &mut Out<MonoFrame>) -> Result<i32, Stop> {
        self.act(|state| write_frame(self.grays(state), buf))
    }

    fn CAMGetFrameColor(&self, buf: &mut Out<ColorFrame>) -> Result<i32, Stop> {
        self.act(|state| write_frame(self.colors(state, None), buf))
    }

    fn CAMGetFrameRGB(&self, buf: &mut Out<ColorFrame>) -> Result<i32, Stop> {
        self.act(|state| write_frame(self.colors(state, None), buf))
    }

    fn CAMGetFrameBayer(&self, buf: &mut Out<BayerFrame>) -> Result<i32, Stop> {
        self.act(|state| {
            let filtered = self.colors(state, Some(ImageSize::QQVGA)).map(|colors| {
                let rows = colors.chunks_exact(3 * 160).enumerate();
                let channel =
                    |row: usize, column: usize| if row.is_multiple_of(2) { 1 + column % 2 } else { column % 2 };
                let row = |(row, colors): (usize, &[u8])| -> Vec<u8> {
                    colors.chunks_exact(3).enumerate().map(|(column, rgb)| rgb[channel(row, column)]).collect()
                };
                rows.flat_map(row).collect::<Vec<u8>>()
            });
            write_frame(filtered, buf)
        })
    }

    fn CAMSet(&self, p1: i32, p2: i32, p3: i32) -> Result<i32, Stop> {
        self.act(|state| {
            state.camera.as_mut().map_or(-1, |camera| {
                camera.parameters = [p1, p2, p3];
                0
            })
        })
    }

    fn CAMGet(&self, p1: &mut Out<i32>, p2: &mut Out<i32>, p3: &mut Out<i32>) -> Result<i32, Stop> {
        self.act(|state| {
            state.camera.map_or(-1, |camera| {
                [p1, p2, p3].into_iter().zip(camera.parameters).for_each(|(out, value)| out.set(value));
                0
            })
        })
    }

    fn CAMMode(&self, _: i32) -> Result<i32, Stop> {
        self.act(|state| if state.camera.is_some() { 0 } else { -1 })
    }

    fn CAMGetDepth(&self, mm: &mut OutFloats) -> Result<i32, Stop> {
        self.act(|state| match self.depths(state) {
            Some(depths) => {
                mm.set(&depths);
                0
            }
            None => -1,
        })
    }

    fn CAMGetLabels(&self, labels: &mut OutInts) -> Result<i32, Stop> {
        self.act(|state| match self.labels(state) {
            Some(numbers) => {
                labels.set(&numbers);
                0
            }
            None => -1,
        })
    }

    fn LIDARScan(&self, distance: &mut OutInts) -> Result<i32, Stop> {
        self.act(|state| match self.fake.scan(state) {
            Some(distances) if !distance.is_null() => {
                distance.set(&distances);
                distances.len() as i32
            }
            _ => -1,
        })
    }

    fn SERVOInit(&self, semantics: i32) -> Result<i32, Stop> {
        self.act(|state| {
            let known_index = state.servos.iter().position(|servo| *servo == semantics);
            let index = known_index.unwrap_or_else(|| {
                state.servos.push(semantics);
                state.servos.len() - 1
            });
            Self::handle_of(Some(index))
        })
    }

    fn SERVORelease(&self, _: i32) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn SERVOSet(&self, handle: i32, angle: i32) -> Result<i32, Stop> {
        self.act(|state| {
            let is_known = Self::index_of(handle, state.servos.len()).is_some();
            if is_known && (0..=255).contains(&angle) { 0 } else { -1 }
        })
    }

    fn MOTORInit(&self, semantics: i32) -> Result<MotorHandle, Stop> {
        self.act(|state| match semantics {
            semantics::MOTOR_LEFT if !state.has_drive => 1,
            semantics::MOTOR_RIGHT if !state.has_drive => 2,
            _ => 0,
        })
    }

    fn MOTORRelease(&self, handle: MotorHandle) -> Result<i32, Stop> {
        self.MOTORDrive(handle, 0)
    }

    fn MOTORDrive(&self, handle: MotorHandle, speed_percent: i32) -> Result<i32, Stop> {
        self.act(|state| {
            if !(1..=3).contains(&handle) || !(-100..=100).contains(&speed_percent) {
                return -1;
            }
            for side in (0..2).filter(|side| handle & (1 << side) != 0) {
                state.power[side] = f64::from(speed_percent) / 100.0;
            }
            state.apply_power();
            0
        })
    }

    fn QUADInit(&self, semantics: i32) -> Result<QuadHandle, Stop> {
        let side = match semantics {
            semantics::QUAD_LEFT => 0,
            semantics::QUAD_RIGHT => 1,
            _ => return self.act(|_| 0),
        };
        self.QUADReset(1 << side)?;
        Ok(1 << side)
    }

    fn QUADRelease(&self, _: QuadHandle) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn QUADReset(&self, handle: QuadHandle) -> Result<i32, Stop> {
        self.act(|state| {
            let rolled = state.motion.rolled(state.now_us);
            for side in (0..2).filter(|side| handle & (1 << side) != 0) {
                state.rolled_at_tick_reset[side] = rolled[side];
            }
            0
        })
    }

    fn QUADRead(&self, handle: QuadHandle) -> Result<i32, Stop> {
        self.act(|state| {
            Self::index_of(handle, 2).map_or(0, |side| {
                let rolled = state.motion.rolled(state.now_us)[side] - state.rolled_at_tick_reset[side];
                (rolled * TICKS_PER_METRE).floor() as i32
            })
        })
    }

    fn QUADGetMotor(&self, semantics: i32) -> Result<i32, Stop> {
        self.act(|_| match semantics {
            semantics::QUAD_LEFT => semantics::MOTOR_LEFT,
            semantics::QUAD_RIGHT => semantics::MOTOR_RIGHT,
            _ => 0,
        })
    }

    fn QUADODORead(&self, handle: QuadHandle) -> Result<f32, Stop> {
        self.act(|state| {
            Self::index_of(handle, 2).map_or(0.0, |side| {
                (state.motion.rolled(state.now_us)[side] - state.rolled_at_distance_reset[side]) as f32
            })
        })
    }

    fn QUADODOReset(&self, handle: QuadHandle) -> Result<i32, Stop> {
        self.act(|state| {
            let rolled = state.motion.rolled(state.now_us);
            for side in (0..2).filter(|side| handle & (1 << side) != 0) {
                state.rolled_at_distance_reset[side] = rolled[side];
            }
            0
        })
    }

    fn VWInit(&self, semantics: i32, timescale: i32) -> Result<i32, Stop> {
        self.act(|state| {
            if semantics != semantics::VW_DRIVE || timescale < 1 || state.has_drive {
                return 0;
            }
            state.has_drive = true;
            state.origin = (state.motion.pose(state.now_us), Pose::default());
            DRIVE_HANDLE
        })
    }

    fn VWRelease(&self, handle: i32) -> Result<i32, Stop> {
        self.with_drive(handle, |state| {
            state.has_drive = false;
            state.motion.set_speed(state.now_us, 0.0, 0.0);
        })
    }

    fn VWSetSpeed(&self, handle: i32, v_mps: f32, w_radps: f32) -> Result<i32, Stop> {
        self.with_drive(handle, |state| state.motion.set_speed(state.now_us, v_mps.into(), w_radps.into()))
    }

    fn VWGetSpeed(&self, handle: i32, vw: &mut Out<SpeedType>) -> Result<i32, Stop> {
        self.with_drive(handle, |state| {
            let (v, w) = state.motion.speed(state.now_us);
            vw.set(SpeedType { v: v as f32, w: w as f32 });
        })
    }

    fn VWSetPosition(&self, handle: i32, x_m: f32, y_m: f32, phi_rad: f32) -> Result<i32, Stop> {
        self.with_drive(handle, |state| {
            let odometry = Pose { x: x_m.into(), y: y_m.into(), phi: phi_rad.into() };
            state.origin = (state.motion.pose(state.now_us), odometry);
        })
    }

    fn VWGetPosition(&self, handle: i32, pos: &mut Out<PositionType>) -> Result<i32, Stop> {
        self.with_drive(handle, |state| {
            let Pose { x, y, phi } = state.odometry_pose();
            let turns = (phi / std::f64::consts::TAU).round();
            let phi = phi - turns * std::f64::consts::TAU;
            pos.set(PositionType { x: x as f32, y: y as f32, phi: phi as f32 });
        })
    }

    fn VWStartControl(&self, handle: i32, _: f32, _: f32, _: f32, _: f32) -> Result<i32, Stop> {
        self.with_drive(handle, |_| ())
    }

    fn VWStopControl(&self, handle: i32) -> Result<i32, Stop> {
        self.with_drive(handle, |_| ())
    }

    fn VWDriveStraight(&self, handle: i32, delta_m: f32, v_mps: f32) -> Result<i32, Stop> {
        self.drive(handle, delta_m, 0.0, v_mps, delta_m)
    }

    fn VWDriveTurn(&self, handle: i32, delta_rad: f32, w_radps: f32) -> Result<i32, Stop> {
        self.drive(handle, 0.0, delta_rad, w_radps, delta_rad)
    }

    fn VWDriveCurve(&self, handle: i32, delta_l_m: f32, delta_phi_rad: f32, v_mps: f32) -> Result<i32, Stop> {
        self.drive(handle, delta_l_m, delta_phi_rad, v_mps, delta_l_m)
    }

    fn VWDriveRemain(&self, handle: i32) -> Result<f32, Stop> {
        self.act(|state| if handle == DRIVE_HANDLE { state.motion.remaining(state.now_us) as f32 } else { 0.0 })
    }

    fn VWDriveDone(&self, handle: i32) -> Result<i32, Stop> {
        self.act(|state| match handle {
            DRIVE_HANDLE if state.has_drive => i32::from(state.motion.drive_end_us(state.now_us).is_none()),
            _ => -1,
        })
    }

    fn VWDriveWait(&self, handle: i32) -> Result<i32, Stop> {
        let code = self.with_drive(handle, |_| ())?;
        let end_us = {
            let state = self.state.borrow();
            state.motion.drive_end_us(state.now_us)
        };
        if code == 0 && end_us.is_some() {
            self.wait("VWDriveWait", end_us)?;
        }
        Ok(code)
    }

    fn VWStalled(&self, handle: i32) -> Result<i32, Stop> {
        self.act(|state| if handle == DRIVE_HANDLE && state.has_drive { 0 } else { -1 })
    }

    fn BUMPInit(&self, semantics: i32) -> Result<i32, Stop> {
        let position = BumperAt::from_semantics(semantics);
        self.act(|_| Self::handle_of(self.fake.bumpers.iter().position(|(at, _)| *at == position)))
    }

    fn BUMPRelease(&self, _: i32) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn BUMPCheck(&self, handle: i32, timestamp: &mut Out<i32>) -> Result<i32, Stop> {
        self.act(|state| {
            let Some(index) = Self::index_of(handle, self.fake.bumpers.len()) else { return -1 };
            let has_passed = |time: &&Duration| time.as_micros() <= u128::from(state.now_us);
            let unread = &self.fake.bumpers[index].1[state.bumps_read[index]..];
            let count = unread.iter().take_while(has_passed).count();
            state.bumps_read[index] += count;
            match unread.first() {
                Some(first) if count > 0 => {
                    timestamp.set((first.as_millis() / 10) as i32);
                    0
                }
                _ => -1,
            }
        })
    }

    fn IRInit(&self, semantics: i32) -> Result<i32, Stop> {
        let position = InfraredAt::from_semantics(semantics);
        self.act(|_| Self::handle_of(self.fake.infrareds.iter().position(|(at, _)| *at == position)))
    }

    fn IRRelease(&self, _: i32) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn IRRead(&self, handle: i32) -> Result<i32, Stop> {
        self.act(|state| {
            Self::index_of(handle, self.fake.infrareds.len())
                .map_or(-1, |index| i32::from(self.fake.infrareds[index].1(&state.moment(state.now_us))))
        })
    }

    fn COMPASSInit(&self, _: i32) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn COMPASSStart(&self, _: i32) -> Result<i32, Stop> {
        self.act(|state| i32::from(std::mem::replace(&mut state.is_compass_ready, true)))
    }

    fn COMPASSCheck(&self) -> Result<i32, Stop> {
        self.act(|state| i32::from(state.is_compass_ready))
    }

    fn COMPASSStop(&self) -> Result<i32, Stop> {
        self.act(|_| 0)
    }

    fn COMPASSRelease(&self) -> Result<i32, Stop> {
        self.act(|state| state.is_compass_ready = false)?;
        Ok(0)
    }

    fn COMPASSGet(&self) -> Result<i32, Stop> {
        self.act(|state| {
            if !state.is_compass_ready {
                return -1;
            }
            let heading_deg = state.motion.pose(state.now_us).phi.to_degrees();
            (90.0 - heading_deg).rem_euclid(360.0).round() as i32 % 360
        })
    }

    leg_functions!();
}
