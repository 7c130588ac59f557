//! Names of a robot's devices, as in `hdt_sem.h` and the robi file.

use std::fmt::{self, Display, Formatter};

use robios_sys::robios6::{DeviceSemantics, semantics};

macro_rules! names {
    ($($(#[$attribute:meta])* $Name:ident { $($Variant:ident = $CONSTANT:ident),* $(,)? })*) => {$(
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $Name {
            $(
                #[doc = concat!("`", stringify!($CONSTANT), "`")]
                $Variant,
            )*
            /// Device named only in the robi file, by its number there.
            Other(DeviceSemantics),
        }

        impl $Name {
            /// Number of the name in `hdt_sem.h`.
            pub const fn semantics(self) -> DeviceSemantics {
                match self {
                    $(Self::$Variant => semantics::$CONSTANT,)*
                    Self::Other(semantics) => semantics,
                }
            }

            /// Name with this number.
            pub const fn from_semantics(semantics: DeviceSemantics) -> Self {
                match semantics {
                    $(semantics::$CONSTANT => Self::$Variant,)*
                    other => Self::Other(other),
                }
            }

            /// Name in Rust, followed by the name in the robi file: `` `PsdAt::Front` (`PSD_FRONT`) ``. A device with
            /// only a number is shown by this number.
            fn with_robi_name(self) -> String {
                match self {
                    Self::Other(semantics) => format!("`{semantics}`"),
                    at => format!("`{}::{at:?}` (`{at}`)", stringify!($Name)),
                }
            }
        }

        impl Display for $Name {
            fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
                match self {
                    $(Self::$Variant => f.write_str(stringify!($CONSTANT)),)*
                    Self::Other(semantics) => semantics.fmt(f),
                }
            }
        }
    )*};
}

names! {
    /// Name of a PSD distance sensor.
    PsdAt {
        Front = PSD_FRONT, FrontLeft = PSD_FRONTLEFT, FrontRight = PSD_FRONTRIGHT, LeftDiagonal = PSD_LEFTDIAG,
        RightDiagonal = PSD_RIGHTDIAG, Left = PSD_LEFT, LeftFront = PSD_LEFTFRONT, LeftBack = PSD_LEFTBACK,
        RightFront = PSD_RIGHTFRONT, RightBack = PSD_RIGHTBACK, Right = PSD_RIGHT, Front2 = PSD_FRONT2,
        Back = PSD_BACK, BackLeft = PSD_BACKLEFT, BackRight = PSD_BACKRIGHT,
    }
    /// Name of a motor.
    MotorAt {
        Left = MOTOR_LEFT, Right = MOTOR_RIGHT, FrontLeft = MOTOR_FL, FrontRight = MOTOR_FR, BackLeft = MOTOR_BL,
        BackRight = MOTOR_BR, Drive = MOTOR_DRIVE,
    }
    /// Name of a wheel encoder.
    EncoderAt {
        Left = QUAD_LEFT, Right = QUAD_RIGHT, FrontLeft = QUAD_FL, FrontRight = QUAD_FR, BackLeft = QUAD_BL,
        BackRight = QUAD_BR, Drive = QUAD_DRIVE,
    }
    /// Name of a servo.
    ServoAt {
        Servo1 = SERVO1, Servo2 = SERVO2, Servo3 = SERVO3, Servo4 = SERVO4, Servo5 = SERVO5, Servo6 = SERVO6,
        Servo7 = SERVO7, Servo8 = SERVO8, Servo9 = SERVO9, Servo10 = SERVO10, Servo11 = SERVO11, Servo12 = SERVO12,
        Servo13 = SERVO13, Servo14 = SERVO14, Servo15 = SERVO15, Servo16 = SERVO16, Steer = SERVO_STEER,
        Camera = SERVO_CAMERA,
    }
    /// Name of a bumper.
    BumperAt {
        Right = BUMP_RIGHT, Left = BUMP_LEFT, Front = BUMP_FRONT, Back = BUMP_BACK, FrontLeft = BUMP_FRONTLEFT,
        FrontRight = BUMP_FRONTRIGHT, BackLeft = BUMP_BACKLEFT, BackRight = BUMP_BACKRIGHT,
    }
    /// Name of an infrared proximity sensor.
    InfraredAt {
        Front = IR_FRONT, Left = IR_LEFT, Right = IR_RIGHT, Back = IR_BACK, LeftDiagonal = IR_LEFTDIAG,
        RightDiagonal = IR_RIGHTDIAG, FrontLeft = IR_FRONTLEFT, FrontRight = IR_FRONTRIGHT, BackLeft = IR_BACKLEFT,
        BackRight = IR_BACKRIGHT,
    }
}

/// A device of the robot, as named in errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Device {
    /// A PSD distance sensor.
    Psd(PsdAt),
    /// A motor.
    Motor(MotorAt),
    /// A wheel encoder.
    Encoder(EncoderAt),
    /// A servo.
    Servo(ServoAt),
    /// A bumper.
    Bumper(BumperAt),
    /// An infrared proximity sensor.
    Infrared(InfraredAt),
    /// The driving interface.
    Drive,
    /// The compass.
    Compass,
    /// The receiver of a TV remote control.
    TvRemote,
    /// The display.
    Lcd,
    /// A timer.
    Timer,
    /// The robot's clock.
    Clock,
    /// The system variables.
    Variables,
    /// The loudspeaker.
    Speaker,
    /// The microphone.
    Microphone,
    /// A serial interface.
    Serial,
    /// The analogue inputs.
    Analog,
    /// The laser scanner.
    Lidar,
    /// The legs.
    Legs,
    /// The camera.
    Camera,
    /// Image files.
    Image,
    /// Shell commands of the computer that runs the simulator.
    Shell,
    /// The radio.
    Radio,
    /// Multi-tasking.
    Tasks,
    /// A semaphore.
    Semaphore,
    /// Layers of the simulator's window.
    Layers,
    /// A numbered device of RoBIOS-7: its kind and its number.
    Numbered(&'static str, u8),
}

impl Display for Device {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Psd(at) => write!(f, "PSD sensor {}", at.with_robi_name()),
            Self::Motor(at) => write!(f, "motor {}", at.with_robi_name()),
            Self::Encoder(at) => write!(f, "encoder {}", at.with_robi_name()),
            Self::Servo(at) => write!(f, "servo {}", at.with_robi_name()),
            Self::Bumper(at) => write!(f, "bumper {}", at.with_robi_name()),
            Self::Infrared(at) => write!(f, "infrared sensor {}", at.with_robi_name()),
            Self::Drive => f.write_str("driving interface `VW_DRIVE`"),
            Self::Compass => f.write_str("compass `COMPASS`"),
            Self::TvRemote => f.write_str("receiver `IRTV`"),
            Self::Lcd => f.write_str("LCD"),
            Self::Timer => f.write_str("timer"),
            Self::Clock => f.write_str("clock"),
            Self::Variables => f.write_str("system variable"),
            Self::Speaker => f.write_str("speaker"),
            Self::Microphone => f.write_str("microphone"),
            Self::Serial => f.write_str("serial interface"),
            Self::Analog => f.write_str("analogue input"),
            Self::Lidar => f.write_str("laser scanner"),
            Self::Legs => f.write_str("legs"),
            Self::Camera => f.write_str("camera"),
            Self::Image => f.write_str("image"),
            Self::Shell => f.write_str("shell"),
            Self::Radio => f.write_str("radio"),
            Self::Tasks => f.write_str("task"),
            Self::Semaphore => f.write_str("semaphore"),
            Self::Layers => f.write_str("layers of the window"),
            Self::Numbered(kind, number) => write!(f, "{kind} {number}"),
        }
    }
}
