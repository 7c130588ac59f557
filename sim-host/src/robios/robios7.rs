//! Dispatch of the RoBIOS-7 calls to the functions of the families.
//!
//! Units are converted in [`unit7`](super::unit7). A function that is missing here fails as on a robot without that
//! device.

use robios_sys::robios7::{ANYKEY, Char, Color, Flag, Timer, VEHICLE};
use robios_sys::{Callback, Out, OutBytes, OutFloats, OutInts, Robios7, Robios7Call as Call, Stop};

use super::caller::Caller;
use super::flow::Flow;
use super::screen::canvas::{Canvas, Ink, rgb};
use super::{
    audio, camera7 as camera, display7 as display, ground_truth, image7, irtv, key, leg, lidar, motor7, os, os7,
    picture, port7, psd7, radio, radio7, serial, servo7, vw7,
};

type Text<'a> = Option<&'a [u8]>;
type Bytes<'a> = Option<&'a [u8]>;

impl<F: Flow> Robios7 for Caller<F> {
    // LCD.
    act! {
        fn LCDPrintf(text: Text<'_>) -> i32 = |robot, _| display::put(robot, Call::LCDPrintf, text);
        fn LCDSetPrintf(row: i32, column: i32, text: Text<'_>) -> i32 =
            |robot, _| display::put_at(robot, [row, column], text);
        fn LCDClear() -> i32 = |robot, _| display::clear(robot);
        fn LCDSetPos(row: i32, column: i32) -> i32 = |robot, _| display::set_position(robot, [row, column]);
        fn LCDGetPos(row: &mut Out<i32>, column: &mut Out<i32>) -> i32 =
            |robot, _| display::position(robot, row, column);
        fn LCDSetColor(fg: i32, bg: i32) -> i32 = |robot, _| display::set_colours(robot, fg, bg);
        fn LCDSetFont(font: i32, variation: i32) -> i32 = |robot, _| display::set_font(robot, font, variation);
        fn LCDSetFontSize(size: i32) -> i32 = |robot, _| display::set_font_size(robot, size);
        fn LCDSetMode(mode: i32) -> i32 = |robot, _| display::set_mode(robot, mode);
        fn LCDMenu(first: Text<'_>, second: Text<'_>, third: Text<'_>, fourth: Text<'_>) -> i32 =
            |robot, _| display::set_menu(robot, [first, second, third, fourth]);
        fn LCDMenuI(position: i32, text: Text<'_>, fg: i32, bg: i32) -> i32 =
            |robot, _| display::set_menu_entry(robot, position, text, [fg, bg]);
        fn LCDListLine(line: i32, key: i32, text: Text<'_>, fg: i32, bg: i32) -> i32 =
            |robot, _| display::set_list_line(robot, [line, key], text, [fg, bg]);
        fn LCDGetSize(x: &mut Out<i32>, y: &mut Out<i32>) -> i32 = |robot, _| display::size(robot, x, y);
        fn LCDPixel(x: i32, y: i32, colour: i32) -> i32 = |robot, _| {
            display::draw(robot, Call::LCDPixel, |canvas| canvas.draw_pixel(x, y, Ink::Colour(rgb(colour))))
        };
        fn LCDGetPixel(x: i32, y: i32) -> i32 = |robot, _| display::pixel(robot, x, y);
        fn LCDLine(x1: i32, y1: i32, x2: i32, y2: i32, colour: i32) -> i32 = |robot, _| {
            display::draw(robot, Call::LCDLine, |canvas| canvas.draw_line([x1, y1], [x2, y2], Ink::Colour(rgb(colour))))
        };
        fn LCDArea(x1: i32, y1: i32, x2: i32, y2: i32, colour: i32, fill: i32) -> i32 =
            |robot, _| display::draw_area(robot, [x1, y1], [x2, y2], colour, fill != 0);
        fn LCDCircle(x: i32, y: i32, radius: i32, colour: i32, fill: i32) -> i32 = |robot, _| {
            let shape = if fill != 0 { Canvas::fill_circle } else { Canvas::draw_circle };
            display::draw(robot, Call::LCDCircle, |canvas| shape(canvas, [x, y], radius, Ink::Colour(rgb(colour))))
        };
        fn LCDPixelInvert(x: i32, y: i32) -> i32 =
            |robot, _| display::draw(robot, Call::LCDPixelInvert, |canvas| canvas.draw_pixel(x, y, Ink::Invert));
        fn LCDLineInvert(x1: i32, y1: i32, x2: i32, y2: i32) -> i32 = |robot, _| {
            display::draw(robot, Call::LCDLineInvert, |canvas| canvas.draw_line([x1, y1], [x2, y2], Ink::Invert))
        };
        fn LCDAreaInvert(x1: i32, y1: i32, x2: i32, y2: i32) -> i32 = |robot, _| {
            display::draw(robot, Call::LCDAreaInvert, |canvas| canvas.fill_area([x1, y1], [x2, y2], Ink::Invert))
        };
        fn LCDCircleInvert(x: i32, y: i32, radius: i32) -> i32 = |robot, _| {
            display::draw(robot, Call::LCDCircleInvert, |canvas| canvas.fill_circle([x, y], radius, Ink::Invert))
        };
        fn LCDImageSize(resolution: i32) -> i32 = |robot, _| image7::set_resolution(robot, Call::LCDImageSize, resolution);
        fn LCDImageStart(x: i32, y: i32, width: i32, height: i32) -> i32 =
            |robot, _| display::set_image_start(robot, [x, y], [width, height]);
        fn LCDImage(width: i32, height: i32, image: Bytes<'_>) -> i32 =
            |robot, _| display::show_colours(robot, [width, height], image);
        fn LCDImageGray(width: i32, height: i32, image: Bytes<'_>) -> i32 =
            |robot, _| display::show_grey(robot, [width, height], image);
        fn LCDImageBinary(width: i32, height: i32, image: Bytes<'_>) -> i32 =
            |robot, _| display::show_binary(robot, [width, height], image);
        fn LCDRefresh() -> i32 = |robot, _| display::refresh(robot);
    }

    // KEY.
    act! {
        fn KEYRead() -> i32 = |robot, _| key::read(robot);
        fn KEYReadXY(x: &mut Out<i32>, y: &mut Out<i32>) -> i32 = |robot, _| key::read_touch(robot, x, y);
    }
    wait! {
        fn KEYGet() -> i32 = |robot, _| key::wait_for(robot, ANYKEY);
        fn KEYWait(codes: i32) -> i32 = |robot, _| key::wait_for_one(robot, codes);
        fn KEYGetXY(x: &mut Out<i32>, y: &mut Out<i32>) -> i32 = |robot, _| key::wait_for_touch(robot, x, y);
    }

    // CAM.
    act! {
        fn CAMInit(resolution: i32, width_px: i32, height_px: i32) -> i32 =
            |robot, _| camera::init(robot, resolution, [width_px, height_px]);
        fn CAMRelease() -> i32 = |robot, _| camera::release(robot);
        fn CAMGet(buf: &mut OutBytes) -> i32 = |robot, world| camera::get(robot, world, buf);
        fn CAMGetGray(buf: &mut OutBytes) -> i32 = |robot, world| camera::get_grey(robot, world, buf);
        fn CAMGetDepth(mm: &mut OutFloats) -> i32 = |robot, _| camera::depth(robot, mm);
        fn CAMGetLabels(labels: &mut OutInts) -> i32 = |robot, _| camera::labels(robot, labels);
    }

    // IP.
    act! {
        fn IPSetSize(resolution: i32) -> i32 = |robot, _| image7::set_resolution(robot, Call::IPSetSize, resolution);
        fn IPReadFile(filename: Text<'_>, width_px: i32, height_px: i32, img: &mut OutBytes) -> i32 =
            |robot, _| image7::read_file(robot, filename, [width_px, height_px], img);
        fn IPWriteFile(filename: Text<'_>, width_px: i32, height_px: i32, img: Bytes<'_>) -> i32 =
            |robot, _| image7::write_file(robot, Call::IPWriteFile, filename, [width_px, height_px], img);
        fn IPWriteFileGray(filename: Text<'_>, width_px: i32, height_px: i32, gray: Bytes<'_>) -> i32 =
            |robot, _| image7::write_file(robot, Call::IPWriteFileGray, filename, [width_px, height_px], gray);
        fn IPLaplace(width_px: i32, height_px: i32, gray_in: Bytes<'_>, gray_out: &mut OutBytes) -> () = |robot, _| {
            image7::filter(robot, Call::IPLaplace, [width_px, height_px], gray_in, gray_out, picture::laplace);
        };
        fn IPSobel(width_px: i32, height_px: i32, gray_in: Bytes<'_>, gray_out: &mut OutBytes) -> () = |robot, _| {
            image7::filter(robot, Call::IPSobel, [width_px, height_px], gray_in, gray_out, picture::sobel);
        };
        fn IPCol2Gray(img_in: Bytes<'_>, gray_out: &mut OutBytes) -> () = |robot, _| {
            image7::store(robot, Call::IPCol2Gray, [gray_out], img_in.map(|image| [picture::grey_of_colour(image)]));
        };
        fn IPGray2Col(gray_in: Bytes<'_>, col_out: &mut OutBytes) -> () = |robot, _| {
            image7::store(robot, Call::IPGray2Col, [col_out], gray_in.map(|image| [picture::colour_of_grey(image)]));
        };
        fn IPRGB2Col(r: Bytes<'_>, g: Bytes<'_>, b: Bytes<'_>, img_out: &mut OutBytes) -> () = |robot, _| {
            let image = image7::channels([r, g, b]).map(|channels| [picture::colour_of_channels(channels)]);
            image7::store(robot, Call::IPRGB2Col, [img_out], image);
        };
        fn IPCol2HSI(img: Bytes<'_>, h: &mut OutBytes, s: &mut OutBytes, i: &mut OutBytes) -> () =
            |robot, _| image7::store(robot, Call::IPCol2HSI, [h, s, i], img.map(picture::hsi_of_colour));
        fn IPOverlay(c1: Bytes<'_>, c2: Bytes<'_>, c_out: &mut OutBytes) -> () = |robot, _| {
            image7::store(robot, Call::IPOverlay, [c_out], c1.zip(c2).map(|(c1, c2)| [picture::overlay(c1, c2)]));
        };
        fn IPOverlayGray(g1: Bytes<'_>, g2: Bytes<'_>, col: Color, c_out: &mut OutBytes) -> () = |robot, _| {
            image7::store(robot, Call::IPOverlayGray, [c_out], image7::overlay_grey(g1, g2, col));
        };
        fn IPPRGB2Col(r: u8, g: u8, b: u8) -> Color = |_, _| picture::number_of_rgb([r, g, b]);
        fn IPPCol2RGB(col: Color, r: &mut Out<u8>, g: &mut Out<u8>, b: &mut Out<u8>) -> () =
            |_, _| image7::put_channels([r, g, b], picture::rgb_of_number(col));
        fn IPPCol2HSI(c: Color, h: &mut Out<u8>, s: &mut Out<u8>, i: &mut Out<u8>) -> () =
            |_, _| image7::put_channels([h, s, i], picture::hsi(picture::rgb_of_number(c)));
        fn IPPRGB2Hue(r: u8, g: u8, b: u8) -> u8 = |_, _| picture::hue([r, g, b]);
        fn IPPRGB2HSI(r: u8, g: u8, b: u8, h: &mut Out<u8>, s: &mut Out<u8>, i: &mut Out<u8>) -> () =
            |_, _| image7::put_channels([h, s, i], picture::hsi([r, g, b]));
    }

    // OS.
    act! {
        fn OSExecute(command: Text<'_>, out: &mut OutBytes) -> i32 = |robot, _| os7::execute(robot, command, out);
        fn OSVersion(buf: &mut OutBytes) -> i32 = |robot, _| os7::version(robot, Call::OSVersion, buf);
        fn OSVersionIO(buf: &mut OutBytes) -> i32 = |robot, _| os7::version(robot, Call::OSVersionIO, buf);
        fn OSMachineSpeed() -> i32 = |_, _| os7::MACHINE_SPEED;
        fn OSMachineType() -> i32 = |_, _| VEHICLE;
        fn OSMachineName(buf: &mut OutBytes) -> i32 = |robot, _| os7::machine_name(robot, buf);
        fn OSMachineID() -> i32 = |robot, _| os7::machine_id(robot);
        fn OSAttachTimer(scale: i32, fct: Option<Callback>) -> Timer = |robot, _| os7::attach_timer(robot, scale, fct);
        fn OSDetachTimer(t: Timer) -> i32 = |robot, _| os7::detach_timer(robot, t);
        fn OSSetTime(hrs: i32, mins: i32, secs: i32) -> i32 = |robot, _| os7::set_time(robot, [hrs, mins, secs]);
        fn OSGetTime(hrs: &mut Out<i32>, mins: &mut Out<i32>, secs: &mut Out<i32>, ticks: &mut Out<i32>) -> i32 =
            |robot, _| os7::time(robot, [hrs, mins, secs, ticks]);
        fn OSShowTime() -> i32 = |robot, _| os::show_time(robot);
        fn OSGetCount() -> i32 = |robot, _| os7::milliseconds(robot.now);
    }

    fn OSWait(&self, n: i32) -> Result<i32, Stop> {
        self.wait_span(Call::OSWait, os7::span_of_milliseconds(n))
    }

    fn OSError(&self, message: Text<'_>, number: i32, dead: i32) -> Result<i32, Stop> {
        self.show_error(Call::OSError, message, number, dead != 0)
    }

    // SER.
    act! {
        fn SERInit(interface: i32, baud: i32, handshake: i32) -> i32 =
            |robot, _| serial::init_7(robot, interface, baud, handshake);
        fn SERSendChar(interface: i32, ch: Char) -> i32 =
            |robot, _| serial::send(robot, Call::SERSendChar, 1, Some(&[ch]), interface);
        fn SERSend(interface: i32, buf: Bytes<'_>) -> i32 =
            |robot, _| serial::send(robot, Call::SERSend, 1, buf, interface);
        fn SERReceive(interface: i32, buf: &mut OutBytes) -> i32 =
            |robot, _| serial::receive_all(robot, interface, buf);
        fn SERCheck(interface: i32) -> Flag = |robot, _| serial::has_input(robot, interface);
        fn SERFlush(interface: i32) -> i32 = |robot, _| serial::flush(robot, Call::SERFlush, 1, interface);
        fn SERClose(interface: i32) -> i32 = |robot, _| serial::close(robot, interface);
    }
    wait! {
        fn SERReceiveChar(interface: i32) -> Char = |robot, _| serial::receive_char(robot, interface);
    }

    // AU.
    act! {
        fn AUBeep() -> i32 = |robot, _| audio::beep(robot);
        fn AUPlay(sample: Bytes<'_>) -> i32 = |robot, _| audio::play_sample_7(robot, sample);
        fn AUDone() -> i32 = |robot, _| robot.robios.audio.is_silent(robot.now).into();
        fn AUMicrophone() -> i32 = |robot, _| audio::microphone_7(robot);
        fn AUTone(freq_hz: i32, time_ms: i32) -> i32 =
            |robot, _| audio::play_tone(robot, Call::AUTone, 1, freq_hz, time_ms);
        fn AUCheckTone() -> i32 = |robot, _| robot.robios.audio.is_tone_done(robot.now).into();
        fn AUCheckPlay() -> i32 = |robot, _| robot.robios.audio.is_sample_done(robot.now).into();
        fn AURecord(buf: &mut OutBytes, freq_hz: i64) -> i32 = |robot, _| audio::record_7(robot, buf, freq_hz);
        fn AUCheckRecord() -> i32 = |robot, _| robot.robios.audio.is_recording_done(robot.now).into();
    }

    // PSD.
    act! {
        fn PSDGet(psd: i32) -> i32 = |robot, world| psd7::get(robot, world, psd);
        fn PSDGetRaw(psd: i32) -> i32 = |robot, world| psd7::get_raw(robot, world, psd);
        fn PSDGetSignal(psd: i32) -> f32 = |robot, world| psd7::get_signal(robot, world, psd);
    }

    // LIDAR.
    act! {
        fn LIDARGet(distances: &mut OutInts) -> i32 = |robot, world| lidar::get(robot, world, distances);
        fn LIDARSet(range: i32, tilt: i32, points: i32) -> () = |robot, _| lidar::set(robot, range, tilt, points);
    }

    // SERVO.
    act! {
        fn SERVOSet(servo: i32, angle: i32) -> i32 = |robot, world| servo7::set(robot, world, servo, angle);
        fn SERVOSetRaw(servo: i32, angle: i32) -> i32 = |robot, world| servo7::set_raw(robot, world, servo, angle);
        fn SERVORange(servo: i32, low: i32, high: i32) -> i32 = |robot, _| servo7::set_range(robot, servo, [low, high]);
        fn SERVOGet(servo: i32) -> i32 = |robot, _| servo7::position(robot, servo);
    }

    // MOTOR, ENCODER.
    act! {
        fn MOTORDrive(motor: i32, speed: i32) -> i32 = |robot, world| motor7::drive(robot, world, motor, speed);
        fn MOTORDriveRaw(motor: i32, speed: i32) -> i32 = |robot, world| motor7::drive_raw(robot, world, motor, speed);
        fn MOTORSpeed(motor: i32, ticks: i32) -> i32 = |robot, world| motor7::speed(robot, world, motor, ticks);
        fn MOTORPID(motor: i32, p: i32, i: i32, d: i32) -> i32 =
            |robot, _| motor7::start_control(robot, motor, [p, i, d]);
        fn MOTORPIDOff(motor: i32) -> i32 = |robot, _| motor7::stop_control(robot, motor);
        fn ENCODERRead(quad: i32) -> i32 = |robot, _| motor7::encoder(robot, quad);
        fn ENCODERReset(quad: i32) -> i32 = |robot, _| motor7::reset_encoder(robot, quad);
    }

    // VW.
    act! {
        fn VWSetSpeed(lin_speed: i32, ang_speed: i32) -> i32 =
            |robot, world| vw7::set_speed(robot, world, lin_speed, ang_speed);
        fn VWGetSpeed(lin_speed: &mut Out<i32>, ang_speed: &mut Out<i32>) -> i32 =
            |robot, _| vw7::speed(robot, [lin_speed, ang_speed]);
        fn VWSetPosition(x: i32, y: i32, phi: i32) -> i32 = |robot, _| vw7::set_position(robot, [x, y, phi]);
        fn VWGetPosition(x: &mut Out<i32>, y: &mut Out<i32>, phi: &mut Out<i32>) -> i32 =
            |robot, _| vw7::position(robot, [x, y, phi]);
        fn VWStraight(dist: i32, lin_speed: i32) -> i32 = |robot, world| vw7::straight(robot, world, dist, lin_speed);
        fn VWTurn(angle: i32, ang_speed: i32) -> i32 = |robot, world| vw7::turn(robot, world, angle, ang_speed);
        fn VWCurve(dist: i32, angle: i32, lin_speed: i32) -> i32 =
            |robot, world| vw7::curve(robot, world, [dist, angle], lin_speed);
        fn VWDrive(dx: i32, dy: i32, lin_speed: i32) -> i32 =
            |robot, world| vw7::drive(robot, world, [dx, dy], lin_speed);
        fn VWRemain() -> i32 = |robot, _| vw7::remain(robot);
        fn VWDone() -> i32 = |robot, _| vw7::done(robot);
        fn VWStalled() -> i32 = |robot, _| vw7::stalled(robot);
        fn VWControl(vv: i32, tv: i32, vw: i32, tw: i32) -> i32 = |robot, _| vw7::start_control(robot, [vv, tv, vw, tw]);
        fn VWControlOff() -> i32 = |robot, _| vw7::stop_control(robot);
    }
    wait! {
        fn VWWait() -> i32 = |robot, _| vw7::wait(robot);
    }

    // DIGITAL.
    act! {
        fn DIGITALSetup(io: i32, direction: Char) -> i32 = |robot, _| port7::set_up(robot, io, direction);
        fn DIGITALRead(io: i32) -> i32 = |robot, _| port7::read(robot, io);
        fn DIGITALReadAll() -> i32 = |robot, _| port7::read_all(robot);
        fn DIGITALWrite(io: i32, state: i32) -> i32 = |robot, _| port7::write(robot, io, state);
    }

    // ANALOG.
    act! {
        fn ANALOGRead(channel: i32) -> i32 = |robot, _| port7::read_analog(robot, channel);
        fn ANALOGVoltage() -> i32 = |robot, _| port7::read_voltage(robot);
        fn ANALOGRecord(channel: i32, iterations: i32) -> i32 = |robot, _| port7::record(robot, channel, iterations);
        fn ANALOGTransfer(buffer: &mut OutBytes) -> i32 = |robot, _| port7::transfer(robot, buffer);
    }

    // IRTV: the receiver is always on.
    act! {
        fn IRTVRead() -> i32 = |robot, _| irtv::read_7(robot);
        fn IRTVFlush() -> i32 = |robot, _| irtv::flush_7(robot);
        fn IRTVGetStatus() -> i32 = |_, _| 1;
    }
    wait! {
        fn IRTVGet() -> i32 = |robot, _| irtv::get_7(robot);
    }

    // RADIO.
    act! {
        fn RADIOInit() -> i32 = radio7::init;
        fn RADIOGetID() -> i32 = |robot, _| os7::machine_id(robot);
        fn RADIOSend(id: i32, buf: Text<'_>) -> i32 = |robot, world| radio7::send(robot, world, id, buf);
        fn RADIOCheck() -> i32 = |robot, _| radio::check(robot, Call::RADIOCheck);
        fn RADIORelease() -> i32 = |robot, _| radio7::release(robot);
    }
    wait! {
        fn RADIOReceive(id: &mut Out<i32>, buf: &mut OutBytes) -> i32 = |robot, _| radio7::receive(robot, id, buf);
        fn RADIOStatus(id_list: &mut OutInts) -> i32 = |robot, world| radio7::status(robot, world, id_list);
    }

    // SIM.
    act! {
        fn SIMGetRobot(id: i32, x: &mut Out<i32>, y: &mut Out<i32>, z: &mut Out<i32>, phi: &mut Out<i32>) -> () =
            |robot, world| ground_truth::robot_pose(robot, world, id, [x, y, z, phi]);
        fn SIMSetRobot(id: i32, x: i32, y: i32, _z: i32, phi: i32) -> () =
            |robot, world| ground_truth::set_robot(robot, world, id, [x, y, phi]);
        fn SIMGetObject(id: i32, x: &mut Out<i32>, y: &mut Out<i32>, z: &mut Out<i32>, phi: &mut Out<i32>) -> () =
            |robot, world| ground_truth::object_pose(robot, world, id, [x, y, z, phi]);
        fn SIMSetObject(id: i32, x: i32, y: i32, _z: i32, phi: i32) -> () =
            |robot, world| ground_truth::set_object(robot, world, id, [x, y, phi]);
        fn SIMGetRobotCount() -> i32 = |robot, _| ground_truth::robot_count(robot);
        fn SIMGetObjectCount() -> i32 = |robot, _| ground_truth::object_count(robot);
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
