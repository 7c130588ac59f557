//! Which function of which family answers each RoBIOS-7 call.
//!
//! Units are converted in [`unit7`](super::unit7). A function that stands nowhere here answers as for a robot without that device.

use robios_sys::{Out, Robios7, Robios7Call as Call, Stop};

use super::caller::Caller;
use super::vw7;

impl Robios7 for Caller {
    // LCD.

    // KEY.

    // CAM.

    // IP.

    // OS.

    // SER.

    // AU.

    // PSD.

    // LIDAR.

    // SERVO.

    // MOTOR, ENCODER.

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
}
