//! Which function of which family answers each RoBIOS-7 call.
//!
//! Units are converted in [`unit7`](super::unit7). A function that stands nowhere here answers as for a robot without that device.

use robios_sys::{Out, OutInts, Robios7, Robios7Call as Call, Stop};

use super::caller::Caller;
use super::screen::canvas::{Canvas, Ink, rgb};
use super::{display7 as display, key, lidar, motor7, psd7, servo7, truth, vw7};

type Text<'a> = Option<&'a [u8]>;
type Bytes<'a> = Option<&'a [u8]>;

impl Robios7 for Caller {
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
        fn LCDImageSize(resolution: i32) -> i32 = |robot, _| display::set_resolution(robot, resolution);
        fn LCDImageStart(x: i32, y: i32, width: i32, height: i32) -> i32 =
            |robot, _| display::set_image(robot, [x, y], [width, height]);
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
        fn KEYReadXY(x: &mut Out<i32>, y: &mut Out<i32>) -> i32 = |robot, _| key::read_place(robot, x, y);
    }
    wait! {
        fn KEYGet() -> i32 = |robot, _| key::wait_for(robot, key::all_keys());
        fn KEYWait(codes: i32) -> i32 = |robot, _| key::wait_for_one(robot, codes);
        fn KEYGetXY(x: &mut Out<i32>, y: &mut Out<i32>) -> i32 = |robot, _| key::touched(robot, x, y);
    }

    // CAM.

    // IP.

    // OS.

    // SER.

    // AU.

    // PSD.
    act! {
        fn PSDGet(psd: i32) -> i32 = |robot, world| psd7::get(robot, world, psd);
        fn PSDGetRaw(psd: i32) -> i32 = |robot, world| psd7::get_raw(robot, world, psd);
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

    // ANALOG.

    // IRTV.

    // RADIO.

    // SIM.
    act! {
        fn SIMGetRobot(id: i32, x: &mut Out<i32>, y: &mut Out<i32>, z: &mut Out<i32>, phi: &mut Out<i32>) -> () =
            |robot, world| truth::robot_pose(robot, world, id, [x, y, z, phi]);
        fn SIMSetRobot(id: i32, x: i32, y: i32, _z: i32, phi: i32) -> () =
            |robot, _| truth::set_robot(robot, id, [x, y, phi]);
        fn SIMGetObject(id: i32, x: &mut Out<i32>, y: &mut Out<i32>, z: &mut Out<i32>, phi: &mut Out<i32>) -> () =
            |robot, world| truth::object_pose(robot, world, id, [x, y, z, phi]);
        fn SIMSetObject(id: i32, x: i32, y: i32, _z: i32, phi: i32) -> () =
            |robot, _| truth::set_object(robot, id, [x, y, phi]);
        fn SIMGetRobotCount() -> i32 = |robot, _| truth::robot_count(robot);
        fn SIMGetObjectCount() -> i32 = |robot, _| truth::object_count(robot);
    }
}
