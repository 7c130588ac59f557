//! The constants of RoBIOS 6. Numbers that occur in programs or data files are those of the original RoBIOS; this
//! simulator chooses the others.

use crate::constant::constants;

constants! {
    /// Constants of `eyebot.h`.
    list CONSTANTS;
    /// `BOOL`: yes.
    TRUE: i32 = 1;
    /// `BOOL`: no.
    FALSE: i32 = 0;

    /// `KEYRead`: no key is pressed.
    NOKEY: i32 = 0;
    /// The left key under the LCD.
    KEY1: i32 = 1;
    /// The second key from the left.
    KEY2: i32 = 2;
    /// The third key from the left.
    KEY3: i32 = 4;
    /// The right key.
    KEY4: i32 = 8;
    /// `KEYWait`: any key.
    ANYKEY: i32 = -1;

    /// `LCDMode`: text that leaves the last line starts again in the first.
    NONSCROLLING: i32 = 0;
    /// The same as `NONSCROLLING`.
    NOSCROLLING: i32 = 0;
    /// `LCDMode`: text that leaves the last line moves all lines up.
    SCROLLING: i32 = 1;
    /// `LCDMode`: the cursor is not shown.
    NOCURSOR: i32 = 0;
    /// `LCDMode`: the cursor is shown.
    CURSOR: i32 = 2;

    /// `CAMInit`: normal angle of view.
    NORMAL: i32 = 0;
    /// `CAMInit`: wide angle of view.
    WIDE: i32 = 1;
    /// `CAMInit`: narrow angle of view.
    TELE: i32 = 2;
    /// `CAMInit` returns at least this for a colour camera.
    COLCAM: i32 = 16;
    /// `CAMInit`: the camera could not be initialised; 200 and more are failures.
    INITERROR: i32 = 200;
    /// `CAMInit`: there is no camera.
    NOCAM: i32 = 255;
    /// `CAMMode`: brightness as set by `CAMSet`.
    NOAUTOBRIGHTNESS: i32 = 0;
    /// `CAMMode`: brightness follows the scene.
    AUTOBRIGHTNESS: i32 = 1;
    /// `CAMGetLabels`: nothing.
    CAM_SKY: i32 = 0;
    /// `CAMGetLabels`: the floor, with what is painted on it, or a terrain.
    CAM_FLOOR: i32 = 1;
    /// `CAMGetLabels`: a wall.
    CAM_WALL: i32 = 2;
    /// `CAMGetLabels`: robot or object n is this + n.
    CAM_BODY: i32 = 10;
    /// `CAMSet`: 60 frames per second.
    FPS60: i32 = 0;
    /// `CAMSet`: 30 frames per second.
    FPS30: i32 = 1;
    /// `CAMSet`: 15 frames per second.
    FPS15: i32 = 2;
    /// `CAMSet`: 7.5 frames per second.
    FPS7_5: i32 = 3;
    /// `CAMSet`: 3.75 frames per second.
    FPS3_75: i32 = 4;
    /// `CAMSet`: 1.875 frames per second.
    FPS1_875: i32 = 5;
    /// `CAMSet`: 0.9375 frames per second.
    FPS0_9375: i32 = 6;
    /// `CAMSet`: 0.46875 frames per second.
    FPS0_46875: i32 = 7;

    /// `OSMachineType`: a vehicle.
    VEHICLE: i32 = 1;
    /// `OSMachineType`: a platform.
    PLATFORM: i32 = 2;
    /// `OSMachineType`: a walking machine.
    WALKER: i32 = 3;

    /// `OSMTInit`: tasks switch only when one yields or waits.
    COOP: i32 = 0;
    /// `OSMTInit`: the same as `COOP`.
    DEFAULT: i32 = 0;
    /// `OSMTInit`: tasks take turns.
    PREEMPT: i32 = 1;
    /// `OSMTStatus`: no multi-tasking.
    NOTASK: i32 = 255;
    /// State of a task: created.
    TASK_NEW: i32 = 0;
    /// State of a task: ready to run.
    TASK_READY: i32 = 1;
    /// State of a task: suspended.
    TASK_SUSPEND: i32 = 2;
    /// State of a task: running.
    TASK_RUNNING: i32 = 3;
    /// `OSSpawn`: the highest priority.
    MAX_PRI: i32 = 8;
    /// `OSSpawn`: the lowest priority.
    MIN_PRI: i32 = 1;
    /// Priority of the idle task.
    IDLE_PRI: i32 = 0;
    /// Stack of the idle task in bytes.
    IDLE_STACKSIZE: i32 = 128;
    /// `OSSpawn`: a small stack, in bytes.
    SMALL_STACKSIZE: i32 = 2048;
    /// `OSSpawn`: the usual stack, in bytes.
    DEFAULT_STACKSIZE: i32 = 4096;

    /// `OSInitRS232`: 4,800 baud. The constant is the rate, so that plain numbers do as well.
    SER4800: i32 = 4_800;
    /// `OSInitRS232`: 9,600 baud.
    SER9600: i32 = 9_600;
    /// `OSInitRS232`: 19,200 baud.
    SER19200: i32 = 19_200;
    /// `OSInitRS232`: 38,400 baud.
    SER38400: i32 = 38_400;
    /// `OSInitRS232`: 57,600 baud.
    SER57600: i32 = 57_600;
    /// `OSInitRS232`: 115,200 baud.
    SER115200: i32 = 115_200;
    /// `OSInitRS232`: no handshake.
    NONE: i32 = 0;
    /// `OSInitRS232`: handshake by RTS and CTS.
    RTSCTS: i32 = 1;
    /// The first serial interface.
    SERIAL1: i32 = 1;
    /// The second serial interface.
    SERIAL2: i32 = 2;
    /// The third serial interface.
    SERIAL3: i32 = 3;

    /// `PSDGet`: nothing within the sensor's range.
    PSD_OUT_OF_RANGE: i32 = 9999;

    /// `RADIOSend`: to every robot.
    BROADCAST: i32 = 0;
    /// The longest message of the radio, in bytes.
    MAXMSGLEN: i32 = 35;

    /// `IRTVInit`: bits are distinguished by the length of the pause between pulses.
    SPACE_CODE: i32 = 0;
    /// `IRTVInit`: bits are distinguished by the length of the pulses.
    PULSE_CODE: i32 = 1;
    /// `IRTVInit`: bits are distinguished by the direction of an edge.
    MANCHESTER_CODE: i32 = 2;
    /// `IRTVInit`: codes are a raw sequence of lengths.
    RAW_CODE: i32 = 3;
    /// `IRTVInit`: only complete codes count.
    DEFAULT_MODE: i32 = 0;
    /// `IRTVInit`: incomplete codes count.
    SLOPPY_MODE: i32 = 1;
    /// `IRTVInit`: a special code repeats the last one.
    REPCODE_MODE: i32 = 2;
}

/// Devices of each kind: arguments of the `...Init` functions.
pub mod semantics {
    use crate::constant::constants;

    constants! {
        /// Constants of `hdt_sem.h`.
        list SEMANTICS;
        /// Motor of the left wheel.
        MOTOR_LEFT: i32 = -100;
        /// Motor of the right wheel.
        MOTOR_RIGHT: i32 = -101;
        /// Motor of the front left wheel.
        MOTOR_FL: i32 = -102;
        /// Motor of the front right wheel.
        MOTOR_FR: i32 = -103;
        /// Motor of the back left wheel.
        MOTOR_BL: i32 = -104;
        /// Motor of the back right wheel.
        MOTOR_BR: i32 = -105;
        /// The motor that drives an Ackermann robot.
        MOTOR_DRIVE: i32 = -106;

        /// PSD sensor to the front.
        PSD_FRONT: i32 = -200;
        /// PSD sensor to the front, left of the middle.
        PSD_FRONTLEFT: i32 = -201;
        /// PSD sensor to the front, right of the middle.
        PSD_FRONTRIGHT: i32 = -202;
        /// PSD sensor diagonally to the left.
        PSD_LEFTDIAG: i32 = -203;
        /// PSD sensor diagonally to the right.
        PSD_RIGHTDIAG: i32 = -204;
        /// PSD sensor to the left.
        PSD_LEFT: i32 = -205;
        /// PSD sensor to the left, at the front.
        PSD_LEFTFRONT: i32 = -206;
        /// PSD sensor to the left, at the back.
        PSD_LEFTBACK: i32 = -207;
        /// PSD sensor to the right, at the front.
        PSD_RIGHTFRONT: i32 = -208;
        /// PSD sensor to the right, at the back.
        PSD_RIGHTBACK: i32 = -209;
        /// PSD sensor to the right.
        PSD_RIGHT: i32 = -210;
        /// Second PSD sensor to the front.
        PSD_FRONT2: i32 = -211;
        /// PSD sensor to the back.
        PSD_BACK: i32 = -212;
        /// PSD sensor to the back, left of the middle.
        PSD_BACKLEFT: i32 = -213;
        /// PSD sensor to the back, right of the middle.
        PSD_BACKRIGHT: i32 = -214;

        /// Encoder of the left wheel.
        QUAD_LEFT: i32 = -300;
        /// Encoder of the right wheel.
        QUAD_RIGHT: i32 = -301;
        /// Encoder of the front left wheel.
        QUAD_FL: i32 = -302;
        /// Encoder of the front right wheel.
        QUAD_FR: i32 = -303;
        /// Encoder of the back left wheel.
        QUAD_BL: i32 = -304;
        /// Encoder of the back right wheel.
        QUAD_BR: i32 = -305;
        /// Encoder of the wheels that drive an Ackermann robot.
        QUAD_DRIVE: i32 = -306;

        /// Servo 1.
        SERVO1: i32 = -401;
        /// Servo 2.
        SERVO2: i32 = -402;
        /// Servo 3.
        SERVO3: i32 = -403;
        /// Servo 4.
        SERVO4: i32 = -404;
        /// Servo 5.
        SERVO5: i32 = -405;
        /// Servo 6.
        SERVO6: i32 = -406;
        /// Servo 7.
        SERVO7: i32 = -407;
        /// Servo 8.
        SERVO8: i32 = -408;
        /// Servo 9.
        SERVO9: i32 = -409;
        /// Servo 10.
        SERVO10: i32 = -410;
        /// Servo 11.
        SERVO11: i32 = -411;
        /// Servo 12.
        SERVO12: i32 = -412;
        /// Servo 13.
        SERVO13: i32 = -413;
        /// Servo 14.
        SERVO14: i32 = -414;
        /// Servo 15.
        SERVO15: i32 = -415;
        /// Servo 16.
        SERVO16: i32 = -416;
        /// The servo that steers an Ackermann robot.
        SERVO_STEER: i32 = -420;
        /// The servo that turns the camera.
        SERVO_CAMERA: i32 = -421;

        /// Bumper to the right.
        BUMP_RIGHT: i32 = -500;
        /// Bumper to the left.
        BUMP_LEFT: i32 = -501;
        /// Bumper to the front.
        BUMP_FRONT: i32 = -502;
        /// Bumper to the back.
        BUMP_BACK: i32 = -503;
        /// Bumper to the front, left of the middle.
        BUMP_FRONTLEFT: i32 = -504;
        /// Bumper to the front, right of the middle.
        BUMP_FRONTRIGHT: i32 = -505;
        /// Bumper to the back, left of the middle.
        BUMP_BACKLEFT: i32 = -506;
        /// Bumper to the back, right of the middle.
        BUMP_BACKRIGHT: i32 = -507;

        /// Infrared proximity sensor to the front.
        IR_FRONT: i32 = -600;
        /// Infrared proximity sensor to the left.
        IR_LEFT: i32 = -601;
        /// Infrared proximity sensor to the right.
        IR_RIGHT: i32 = -602;
        /// Infrared proximity sensor to the back.
        IR_BACK: i32 = -603;
        /// Infrared proximity sensor diagonally to the left.
        IR_LEFTDIAG: i32 = -604;
        /// Infrared proximity sensor diagonally to the right.
        IR_RIGHTDIAG: i32 = -605;
        /// Infrared proximity sensor to the front, left of the middle.
        IR_FRONTLEFT: i32 = -606;
        /// Infrared proximity sensor to the front, right of the middle.
        IR_FRONTRIGHT: i32 = -607;
        /// Infrared proximity sensor to the back, left of the middle.
        IR_BACKLEFT: i32 = -608;
        /// Infrared proximity sensor to the back, right of the middle.
        IR_BACKRIGHT: i32 = -609;

        /// The driving interface over motors and encoders.
        VW_DRIVE: i32 = -700;
        /// The older name of `VW_DRIVE`.
        VW: i32 = -700;

        /// The compass.
        COMPASS: i32 = -800;
        /// The receiver of a TV remote control.
        IRTV: i32 = -900;
    }
}

/// Kinds of devices in the hardware description table.
pub mod hdt_type {
    use crate::constant::constants;

    constants! {
        /// Constants of `hdt.h`.
        list HDT_TYPES;
        /// Motors.
        HDT_MOTOR: i32 = 1;
        /// Encoders.
        HDT_QUAD: i32 = 2;
        /// Servos.
        HDT_SERVO: i32 = 3;
        /// PSD distance sensors.
        HDT_PSD: i32 = 4;
        /// Bumpers.
        HDT_BUMP: i32 = 5;
        /// Infrared proximity sensors.
        HDT_IR: i32 = 6;
        /// Driving interfaces.
        HDT_VW: i32 = 7;
        /// Compasses.
        HDT_COMPASS: i32 = 8;
        /// Receivers of TV remote controls.
        HDT_IRTV: i32 = 9;
    }
}
