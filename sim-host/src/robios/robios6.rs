//! Dispatch of the RoBIOS 6 calls to the functions of the families.

use robios_sys::robios6::{
    BayerFrame, BitImage, ColImage, ColorFrame, FALSE, HDTEntry, Image, MonoFrame, PositionType, RadioIOParameters,
    RadioStatus, SpeedType, VEHICLE,
};
use robios_sys::{Callback, Out, OutBytes, OutFloats, OutInts, Robios6, Robios6Call as Call, Stop};
use sim_core::time::TICK;

use super::caller::Caller;
use super::flow::Flow;
use super::multitasking::Spawn;
use super::{
    audio, bump, camera6 as camera, compass, display, hdt, image, ir, irtv, key, latch, leg, lidar, motor,
    multitasking, os, psd, radio, radio6, serial, servo, vw,
};

type Text<'a> = Option<&'a [u8]>;

impl<F: Flow> Robios6 for Caller<F> {
    // The machine.
    act! {
        fn OSVersion(text: &mut OutBytes) -> i32 = |_, _| os::version(text);
        fn OSMachineType() -> i32 = |_, _| VEHICLE;
        fn OSMachineSpeed() -> i32 = |_, _| os::MACHINE_SPEED;
        fn OSMachineName(text: &mut OutBytes) -> i32 = |robot, _| os::machine_name(robot, text);
        fn OSMachineID() -> u8 = |robot, _| os::machine_id(robot);
        fn OSGetVar(number: i32) -> i32 = |robot, _| os::variable(robot, number);
        fn OSPutVar(number: i32, value: i32) -> i32 = |robot, _| os::set_variable(robot, number, value);
        fn HDT_Validate() -> i32 = |_, _| 0;
        fn HDT_FindEntry(kind: i32, semantics: i32, entry: &mut Out<HDTEntry>) -> i32 =
            |robot, _| hdt::find_entry(robot, kind, semantics, entry);
        fn HDT_FindTable(kind: i32, index: i32, entry: &mut Out<HDTEntry>) -> i32 =
            |robot, _| hdt::find_nth(robot, kind, index, entry);
        fn HDT_TypeCount(kind: i32) -> i32 = |robot, _| hdt::count(robot, kind);
    }

    fn OSError(&self, message: Text<'_>, number: i32, dead: i32) -> Result<i32, Stop> {
        self.show_error(Call::OSError, message, number, dead != FALSE)
    }

    fn OSPanic(&self, message: Text<'_>) -> Result<i32, Stop> {
        self.call(Call::OSPanic, |robot, _| os::panic(robot, message))?;
        Err(Stop)
    }

    fn OSExit(&self, code: i32) -> Result<i32, Stop> {
        self.exit(code)
    }

    // Time and timers.
    act! {
        fn OSEnable() -> i32 = |robot, _| { robot.timers.are_held = false; 0 };
        fn OSDisable() -> i32 = |robot, _| { robot.timers.are_held = true; 0 };
        fn OSSetTime(h: i32, m: i32, s: i32) -> i32 = |robot, _| os::set_time(robot, [h, m, s]);
        fn OSGetTime(h: &mut Out<i32>, m: &mut Out<i32>, s: &mut Out<i32>, ticks: &mut Out<i32>) -> i32 =
            |robot, _| os::time(robot, [h, m, s, ticks]);
        fn OSShowTime() -> i32 = |robot, _| os::show_time(robot);
        fn OSGetCount() -> i32 = |robot, _| os::hundredths(robot.now);
        fn OSAttachTimer(scale: i32, callback: Option<Callback>) -> i32 =
            |robot, _| os::attach_timer(robot, Call::OSAttachTimer, TICK, scale, callback);
        fn OSDetachTimer(handle: i32) -> i32 =
            |robot, _| if os::detach_timer(robot, handle) { 1 } else { robot.fail_call(Call::OSDetachTimer, 0) };
    }

    fn OSWait(&self, n: i32) -> Result<i32, Stop> {
        self.wait_span(Call::OSWait, os::span_of_hundredths(n))
    }

    fn OSSleep(&self, n: i32) -> Result<i32, Stop> {
        self.wait_span(Call::OSSleep, os::span_of_hundredths(n))
    }

    // The display.
    act! {
        fn LCDPrintf(text: Text<'_>) -> i32 = |robot, _| display::put(robot, Call::LCDPrintf, text);
        fn LCDSetPrintf(row: i32, column: i32, text: Text<'_>) -> i32 =
            |robot, _| display::put_at(robot, Call::LCDSetPrintf, [row, column], text);
        fn LCDClear() -> i32 = |robot, _| display::clear(robot);
        fn LCDPutChar(c: u8) -> i32 = |robot, _| display::put(robot, Call::LCDPutChar, Some(&[c]));
        fn LCDSetChar(row: i32, column: i32, c: u8) -> i32 =
            |robot, _| display::put_at(robot, Call::LCDSetChar, [row, column], Some(&[c]));
        fn LCDPutString(s: Text<'_>) -> i32 = |robot, _| display::put(robot, Call::LCDPutString, s);
        fn LCDSetString(row: i32, column: i32, s: Text<'_>) -> i32 =
            |robot, _| display::put_at(robot, Call::LCDSetString, [row, column], s);
        fn LCDPutHex(v: i32) -> i32 =
            |robot, _| display::put(robot, Call::LCDPutHex, Some(format!("{v:08X}").as_bytes()));
        fn LCDPutHex1(v: i32) -> i32 =
            |robot, _| display::put(robot, Call::LCDPutHex1, Some(format!("{:02X}", v as u8).as_bytes()));
        fn LCDPutInt(v: i32) -> i32 = |robot, _| display::put(robot, Call::LCDPutInt, Some(v.to_string().as_bytes()));
        fn LCDPutIntS(v: i32, spaces: i32) -> i32 = |robot, _| display::put_int(robot, v, spaces);
        fn LCDPutFloat(v: f32) -> i32 = |robot, _| display::put_float(robot, v, 0, 6);
        fn LCDPutFloatS(v: f32, spaces: i32, decimals: i32) -> i32 =
            |robot, _| display::put_float(robot, v, spaces, decimals);
        fn LCDMode(mode: i32) -> i32 = |robot, _| display::set_mode(robot, mode);
        fn LCDSetPos(row: i32, column: i32) -> i32 = |robot, _| display::set_position(robot, row, column);
        fn LCDGetPos(row: &mut Out<i32>, column: &mut Out<i32>) -> i32 =
            |robot, _| display::position(robot, row, column);
        fn LCDPutGraphic(image: Option<&Image>) -> i32 = |robot, _| display::put_grey(robot, image);
        fn LCDPutImage(picture: Option<&BitImage>) -> i32 = |robot, _| display::put_picture(robot, picture);
        fn LCDMenu(s1: Text<'_>, s2: Text<'_>, s3: Text<'_>, s4: Text<'_>) -> i32 =
            |robot, _| display::set_menu(robot, [s1, s2, s3, s4]);
        fn LCDMenuI(position: i32, s: Text<'_>) -> i32 = |robot, _| display::set_menu_entry(robot, position, s);
        fn LCDSetPixel(row: i32, column: i32, ink: i32) -> i32 = |robot, _| {
            display::draw(robot, Call::LCDSetPixel, ink, |lcd, ink| lcd.draw_pixel(row, column, ink))
        };
        fn LCDInvertPixel(row: i32, column: i32) -> i32 = |robot, _| {
            display::draw(robot, Call::LCDInvertPixel, 2, |lcd, ink| lcd.draw_pixel(row, column, ink))
        };
        fn LCDGetPixel(row: i32, column: i32) -> i32 = |robot, _| display::pixel(robot, row, column);
        fn LCDLine(x1: i32, y1: i32, x2: i32, y2: i32, ink: i32) -> i32 = |robot, _| {
            display::draw(robot, Call::LCDLine, ink, |lcd, ink| Ok(lcd.draw_line([x1, y1], [x2, y2], ink)))
        };
        fn LCDArea(x1: i32, y1: i32, x2: i32, y2: i32, ink: i32) -> i32 = |robot, _| {
            display::draw(robot, Call::LCDArea, ink, |lcd, ink| lcd.draw_area([x1, y1], [x2, y2], ink))
        };
    }
    fn LCDPutColorGraphic(&self, mut image: Option<&mut ColImage>) -> Result<i32, Stop> {
        self.call(Call::LCDPutColorGraphic, |robot, _| display::put_colour(robot, image.as_deref_mut()))
    }

    // Keys.
    wait! {
        fn KEYGetBuf(buffer: &mut Out<u8>) -> i32 = |robot, _| key::get_into(robot, buffer);
        fn KEYGet() -> i32 = |robot, _| key::wait_for(robot, key::all_keys());
        fn KEYWait(codes: i32) -> i32 = |robot, _| key::wait(robot, codes);
    }
    act! {
        fn KEYRead() -> i32 = |robot, _| key::read(robot);
    }

    // Image processing.
    act! {
        fn IPLaplace(source: Option<&Image>, result: &mut Out<Image>) -> i32 =
            |robot, _| image::process(robot, Call::IPLaplace, result, || Some(image::laplace(source?)));
        fn IPSobel(source: Option<&Image>, result: &mut Out<Image>) -> i32 =
            |robot, _| image::process(robot, Call::IPSobel, result, || Some(image::sobel(source?)));
        fn IPDither(source: Option<&Image>, result: &mut Out<Image>) -> i32 =
            |robot, _| image::process(robot, Call::IPDither, result, || Some(image::dither(source?)));
        fn IPDiffer(current: Option<&Image>, last: Option<&Image>, result: &mut Out<Image>) -> i32 =
            |robot, _| image::process(robot, Call::IPDiffer, result, || Some(image::differ(current?, last?)));
        fn IPColor2Grey(source: Option<&ColImage>, result: &mut Out<Image>) -> i32 =
            |robot, _| image::process(robot, Call::IPColor2Grey, result, || Some(image::grey_from_colour(source?)));
    }

    // Serial interfaces.
    act! {
        fn OSInitRS232(baud: i32, handshake: i32, interface: i32) -> i32 =
            |robot, _| serial::init_6(robot, baud, handshake, interface);
        fn OSSendCharRS232(c: u8, interface: i32) -> i32 =
            |robot, _| serial::send(robot, Call::OSSendCharRS232, -1, Some(&[c]), interface);
        fn OSSendRS232(s: Text<'_>, interface: i32) -> i32 =
            |robot, _| serial::send(robot, Call::OSSendRS232, -1, s, interface);
        fn OSFlushInRS232(interface: i32) -> i32 = |robot, _| serial::flush(robot, Call::OSFlushInRS232, -1, interface);
        fn OSFlushOutRS232(interface: i32) -> i32 =
            |robot, _| serial::check_out(robot, Call::OSFlushOutRS232, interface);
        fn OSCheckInRS232(interface: i32) -> i32 = |robot, _| serial::check_in(robot, interface);
        fn OSCheckOutRS232(interface: i32) -> i32 =
            |robot, _| serial::check_out(robot, Call::OSCheckOutRS232, interface);
        fn USRStart() -> i32 = |robot, _| robot.fail_call(Call::USRStart, -1);
        fn USRResident(_name: Text<'_>, _mode: i32) -> i32 = |robot, _| robot.fail_call(Call::USRResident, -1);
        fn OSDownload(_name: &mut Out<[u8; 16]>, _bytes: &mut Out<i32>, _baud: i32, _handshake: i32, _interface: i32)
            -> i32 = |robot, _| robot.fail_call(Call::OSDownload, 1);
    }
    wait! {
        fn OSRecvRS232(buffer: &mut Out<u8>, interface: i32) -> i32 =
            |robot, _| serial::receive_6(robot, buffer, interface);
    }

    // Sound.
    act! {
        fn AUPlaySample(sample: Option<&[u8]>) -> i32 = |robot, _| audio::play_sample_6(robot, sample);
        fn AUCheckSample() -> i32 = |robot, _| robot.robios.audio.is_sample_done(robot.now).into();
        fn AUTone(frequency_hz: i32, span_ms: i32) -> i32 =
            |robot, _| audio::play_tone(robot, Call::AUTone, -1, frequency_hz, span_ms);
        fn AUCheckTone() -> i32 = |robot, _| robot.robios.audio.is_tone_done(robot.now).into();
        fn AUBeep() -> i32 = |robot, _| audio::beep(robot);
        fn AURecordSample(buffer: &mut OutBytes, rate_hz: i64) -> i32 =
            |robot, _| audio::record_6(robot, buffer, rate_hz);
        fn AUCheckRecord() -> i32 = |robot, _| robot.robios.audio.is_recording_done(robot.now).into();
        fn AUCaptureMic() -> i32 = |robot, _| audio::microphone_6(robot);
    }

    // PSD sensors.
    act! {
        fn PSDInit(semantics: i32) -> i32 = |robot, _| psd::init(robot, semantics);
        fn PSDRelease() -> i32 = |robot, _| psd::release(robot);
        fn PSDStart(handles: i32, cycle: i32) -> i32 = |robot, _| psd::start(robot, handles, cycle != FALSE);
        fn PSDStop() -> i32 = |robot, _| psd::stop(robot);
        fn PSDCheck() -> i32 = |robot, _| psd::check(robot);
        fn PSDGet(handle: i32) -> i32 = |robot, world| psd::get(robot, world, handle);
        fn PSDGetRaw(handle: i32) -> i32 = |robot, world| psd::get_raw(robot, world, handle);
        fn PSDGetSignal(handle: i32) -> f32 = |robot, world| psd::get_signal(robot, world, handle);
        fn LIDARScan(distances: &mut OutInts) -> i32 = |robot, world| lidar::scan6(robot, world, distances);
    }

    // Servos, motors, encoders.
    act! {
        fn SERVOInit(semantics: i32) -> i32 = |robot, _| servo::init(robot, semantics);
        fn SERVORelease(handles: i32) -> i32 = |robot, _| servo::release(robot, handles);
        fn SERVOSet(handles: i32, angle: i32) -> i32 = |robot, world| servo::set(robot, world, handles, angle);
        fn MOTORInit(semantics: i32) -> i32 = |robot, _| motor::init(robot, semantics);
        fn MOTORRelease(handles: i32) -> i32 = |robot, world| motor::release(robot, world, handles);
        fn MOTORDrive(handles: i32, percent: i32) -> i32 = |robot, world| motor::drive(robot, world, handles, percent);
        fn QUADInit(semantics: i32) -> i32 = |robot, _| motor::quad_init(robot, semantics);
        fn QUADRelease(handles: i32) -> i32 = |robot, _| motor::quad_release(robot, handles);
        fn QUADReset(handles: i32) -> i32 = |robot, _| motor::quad_reset(robot, handles);
        fn QUADRead(handle: i32) -> i32 = |robot, _| motor::quad_read(robot, handle);
        fn QUADGetMotor(semantics: i32) -> i32 = |robot, _| motor::quad_motor(robot, semantics);
        fn QUADODORead(handle: i32) -> f32 = |robot, _| motor::odometer_read(robot, handle);
        fn QUADODOReset(handles: i32) -> i32 = |robot, _| motor::odometer_reset(robot, handles);
    }

    // Driving.
    act! {
        fn VWInit(semantics: i32, timescale: i32) -> i32 =
            |robot, world| vw::init(robot, world, semantics, timescale);
        fn VWRelease(handle: i32) -> i32 = |robot, world| vw::release(robot, world, handle);
        fn VWSetSpeed(handle: i32, v: f32, w: f32) -> i32 = |robot, world| vw::set_speed(robot, world, handle, v, w);
        fn VWGetSpeed(handle: i32, speed: &mut Out<SpeedType>) -> i32 = |robot, _| vw::speed(robot, handle, speed);
        fn VWSetPosition(handle: i32, x: f32, y: f32, phi: f32) -> i32 =
            |robot, _| vw::set_position(robot, handle, x, y, phi);
        fn VWGetPosition(handle: i32, position: &mut Out<PositionType>) -> i32 =
            |robot, _| vw::position(robot, handle, position);
        fn VWStartControl(handle: i32, vv: f32, tv: f32, vw: f32, tw: f32) -> i32 =
            |robot, _| vw::start_control(robot, handle, [vv, tv, vw, tw]);
        fn VWStopControl(handle: i32) -> i32 = |robot, _| vw::stop_control(robot, handle);
        fn VWDriveStraight(handle: i32, delta: f32, v: f32) -> i32 =
            |robot, world| vw::drive_straight(robot, world, handle, delta, v);
        fn VWDriveTurn(handle: i32, delta: f32, w: f32) -> i32 =
            |robot, world| vw::drive_turn(robot, world, handle, delta, w);
        fn VWDriveCurve(handle: i32, length: f32, angle: f32, v: f32) -> i32 =
            |robot, world| vw::drive_curve(robot, world, handle, [length, angle, v]);
        fn VWDriveRemain(handle: i32) -> f32 = |robot, _| vw::drive_remain(robot, handle);
        fn VWDriveDone(handle: i32) -> i32 = |robot, _| vw::drive_done(robot, handle);
        fn VWStalled(handle: i32) -> i32 = |robot, _| vw::stalled(robot, handle);
    }
    wait! {
        fn VWDriveWait(handle: i32) -> i32 = |robot, _| vw::drive_wait(robot, handle);
    }

    // Bumpers, infrared, compass.
    act! {
        fn BUMPInit(semantics: i32) -> i32 = |robot, _| bump::init(robot, semantics);
        fn BUMPRelease(handles: i32) -> i32 = |robot, _| bump::release(robot, handles);
        fn BUMPCheck(handle: i32, stamp: &mut Out<i32>) -> i32 = |robot, _| bump::check(robot, handle, stamp);
        fn IRInit(semantics: i32) -> i32 = |robot, _| ir::init(robot, semantics);
        fn IRRelease(handles: i32) -> i32 = |robot, _| ir::release(robot, handles);
        fn IRRead(handle: i32) -> i32 = |robot, world| ir::read(robot, world, handle);
        fn COMPASSInit(semantics: i32) -> i32 = |robot, _| compass::init(robot, semantics);
        fn COMPASSStart(cycle: i32) -> i32 = |robot, _| compass::start(robot, cycle != FALSE);
        fn COMPASSCheck() -> i32 = |robot, _| compass::check(robot);
        fn COMPASSStop() -> i32 = |robot, _| compass::stop(robot);
        fn COMPASSRelease() -> i32 = |robot, _| compass::release(robot);
        fn COMPASSGet() -> i32 = |robot, _| compass::get(robot);
        fn COMPASSCalibrate(_mode: i32) -> i32 = |robot, _| compass::calibrate(robot);
    }

    // Latches, parallel port, A/D.
    act! {
        fn OSReadInLatch(number: i32) -> u8 = |robot, _| latch::read_input(robot, number);
        fn OSWriteOutLatch(number: i32, mask: u8, value: u8) -> u8 =
            |robot, _| latch::write_output(robot, number, mask, value);
        fn OSReadOutLatch(number: i32) -> u8 = |robot, _| robot.robios.latches.output(number);
        fn OSReadParData() -> u8 = |robot, _| latch::read_parallel(robot);
        fn OSWriteParData(value: u8) -> () = |robot, _| latch::write_parallel(robot, value);
        fn OSReadParSR() -> u8 = |robot, _| latch::read_parallel_status(robot);
        fn OSWriteParCTRL(value: u8) -> () = |robot, _| latch::write_parallel_control(robot, value);
        fn OSReadParCTRL() -> u8 = |robot, _| robot.robios.latches.parallel_control;
        fn OSGetAD(channel: i32) -> i32 = |robot, _| latch::read_analog(robot, channel);
        fn OSOffAD(_mode: i32) -> i32 = |_, _| 0;
    }

    // Remote control: no code ever arrives.
    act! {
        fn IRTVInitHDT(semantics: i32) -> i32 = |robot, _| irtv::init_standard(robot, semantics);
        fn IRTVInit(
            type_code: i32, length: i32, tog_mask: i32, inv_mask: i32, mode: i32, bufsize: i32, delay: i32
        ) -> i32 = |robot, _| {
            irtv::init(robot, irtv::Settings { type_code, length, tog_mask, inv_mask, mode, bufsize, delay })
        };
        fn IRTVTerm() -> () = |robot, _| robot.robios.irtv = None;
        fn IRTVPressed() -> i32 = |_, _| 0;
        fn IRTVRead() -> i32 = |_, _| 0;
        fn IRTVFlush() -> () = |_, _| ();
        fn IRTVGetStatus(
            type_code: &mut Out<i32>, length: &mut Out<i32>, tog_mask: &mut Out<i32>, inv_mask: &mut Out<i32>,
            mode: &mut Out<i32>, bufsize: &mut Out<i32>, delay: &mut Out<i32>
        ) -> () = |robot, _| irtv::status(robot, [type_code, length, tog_mask, inv_mask, mode, bufsize, delay]);
    }
    wait! {
        fn IRTVGet() -> i32 = |robot, _| irtv::get(robot);
    }

    // Camera.
    act! {
        fn CAMInit(mode: i32) -> i32 = |robot, _| camera::init(robot, mode);
        fn CAMRelease() -> i32 = |robot, _| camera::release(robot);
        fn CAMSet(p1: i32, p2: i32, p3: i32) -> i32 = |robot, _| camera::set(robot, [p1, p2, p3]);
        fn CAMGet(p1: &mut Out<i32>, p2: &mut Out<i32>, p3: &mut Out<i32>) -> i32 =
            |robot, _| camera::get(robot, [p1, p2, p3]);
        fn CAMMode(mode: i32) -> i32 = |robot, _| camera::set_mode(robot, mode);
        fn CAMGetDepth(mm: &mut OutFloats) -> i32 = |robot, _| camera::depth(robot, mm);
        fn CAMGetLabels(labels: &mut OutInts) -> i32 = |robot, _| camera::labels(robot, labels);
    }
    wait! {
        fn CAMGetFrame(buffer: &mut Out<Image>) -> i32 = |robot, world| camera::frame(robot, world, buffer);
        fn CAMGetColFrame(buffer: &mut Out<ColImage>, convert: i32) -> i32 =
            |robot, world| camera::colour_frame(robot, world, buffer, convert);
        fn CAMGetFrameMono(buffer: &mut Out<MonoFrame>) -> i32 = |robot, world| camera::mono_frame(robot, world, buffer);
        fn CAMGetFrameColor(buffer: &mut Out<ColorFrame>) -> i32 =
            |robot, world| camera::rgb_frame(robot, world, Call::CAMGetFrameColor, buffer);
        fn CAMGetFrameRGB(buffer: &mut Out<ColorFrame>) -> i32 =
            |robot, world| camera::rgb_frame(robot, world, Call::CAMGetFrameRGB, buffer);
        fn CAMGetFrameBayer(buffer: &mut Out<BayerFrame>) -> i32 =
            |robot, world| camera::bayer_frame(robot, world, buffer);
    }

    // Radio.
    act! {
        fn RADIOInit() -> i32 = radio6::init;
        fn RADIOTerm() -> i32 = |robot, _| radio6::release(robot);
        fn RADIOSend(id: u8, buffer: Option<&[u8]>) -> i32 = |robot, world| radio6::send(robot, world, id, buffer);
        fn RADIOCheck() -> i32 = |robot, _| radio::check(robot, Call::RADIOCheck);
        fn RADIOGetIoctl(parameters: &mut Out<RadioIOParameters>) -> i32 =
            |robot, world| radio6::get_settings(robot, world, parameters);
        fn RADIOSetIoctl(parameters: Option<&RadioIOParameters>) -> i32 =
            |robot, world| radio6::set_settings(robot, world, parameters);
        fn RADIOGetStatus(status: &mut Out<RadioStatus>) -> i32 = |robot, _| radio6::status(robot, status);
    }
    wait! {
        fn RADIORecv(id: &mut Out<u8>, received: &mut Out<i32>, buffer: &mut OutBytes) -> i32 =
            |robot, _| radio6::receive(robot, id, received, buffer);
    }

    // Multi-tasking.
    act! {
        fn OSMTInit(mode: u8) -> i32 = |robot, _| multitasking::start(robot, mode);
        fn OSMTStatus() -> i32 = |robot, _| multitasking::status(robot);
        fn OSReady(task: i32) -> i32 = |robot, _| multitasking::make_ready(robot, Call::OSReady, task);
        fn OSGetUID(task: i32) -> i32 = |robot, _| multitasking::uid(robot, task);
        fn OSForbid() -> i32 = |robot, _| multitasking::set_preemption(robot, Call::OSForbid, false);
        fn OSPermit() -> i32 = |robot, _| multitasking::set_preemption(robot, Call::OSPermit, true);
        fn OSSemV(semaphore: i32) -> i32 = |robot, _| multitasking::release_semaphore(robot, semaphore);
    }

    fn OSSpawn(
        &self,
        name: Text<'_>,
        code: Option<Callback>,
        stack_bytes: i32,
        priority: i32,
        uid: i32,
    ) -> Result<i32, Stop> {
        self.create_task(&Spawn { name, code, stack_bytes, priority, uid })
    }

    fn OSSuspend(&self, task: i32) -> Result<i32, Stop> {
        self.suspend_task(task)
    }

    fn OSReschedule(&self) -> Result<i32, Stop> {
        self.reschedule()
    }

    fn OSYield(&self) -> Result<i32, Stop> {
        self.yield_task()
    }

    fn OSRun(&self, task: i32) -> Result<i32, Stop> {
        self.run_task(task)
    }

    fn OSKill(&self, task: i32) -> Result<i32, Stop> {
        self.kill_task(task)
    }

    fn OSSemInit(&self, semaphore: Option<&mut i32>, count: i32) -> Result<i32, Stop> {
        self.make_semaphore(semaphore, count)
    }

    fn OSSemP(&self, semaphore: i32) -> Result<i32, Stop> {
        self.pass_semaphore(semaphore)
    }

    // Legs.
    act! {
        fn LEGCount() -> i32 = |robot, _| leg::count(robot);
        fn LEGSetGait(gait: i32) -> i32 = |robot, _| leg::set_gait(robot, Call::LEGSetGait, gait);
        fn LEGSetSpeed(vx: i32, vy: i32, omega: i32) -> i32 =
            |robot, world| leg::set_speed(robot, world, Call::LEGSetSpeed, [vx, vy, omega]);
        fn LEGSetStep(height: i32) -> i32 = |robot, _| leg::set_step(robot, Call::LEGSetStep, height);
        fn LEGGetJoint(leg: i32, joint: i32, degrees: &mut Out<f32>) -> i32 =
            |robot, _| leg::joint(robot, Call::LEGGetJoint, [leg, joint], degrees);
        fn LEGGetLink(leg: i32, link: i32, pose: &mut OutFloats) -> i32 =
            |robot, _| leg::link(robot, Call::LEGGetLink, [leg, link], pose);
        fn LEGGetHeight(mm: &mut Out<f32>) -> i32 = |robot, _| leg::height(robot, Call::LEGGetHeight, mm);
        fn LEGGetFoot(leg: i32) -> i32 = |robot, _| leg::foot(robot, Call::LEGGetFoot, leg);
        fn LEGCorrect(leg: i32, dx: i32, dy: i32, dz: i32) -> i32 =
            |robot, _| leg::correct(robot, Call::LEGCorrect, leg, [dx, dy, dz]);
    }
}
