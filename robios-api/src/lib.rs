//! The safe Rust RoBIOS API for robot programs.
//!
//! A program is a function that takes a [`Robot`]. Devices are obtained from the robot and released when they are
//! dropped. Lengths, angles, speeds and times are quantities with units. A program is built as a library
//! (`crate-type = ["cdylib"]`); [`program!`] exports its entry point.
//!
//! ```standalone_crate
//! # mod program {
//! use robios_api::prelude::*;
//!
//! robios_api::program!(main);
//!
//! fn main(robot: &Robot) -> Result {
//!     let drive = robot.drive()?;
//!     let front = robot.psd(PsdAt::Front)?;
//!     drive.set_speed(0.2.metres_per_second(), 0.radians_per_second())?;
//!     while front.distance().is_none_or(|distance| distance > 0.1.metres()) {
//!         robot.sleep(50.millis());
//!     }
//!     writeln!(robot.lcd(), "stopped at x = {:.2}", drive.position().x);
//!     Ok(())
//! }
//! # pub fn check() {
//! #     let fake = robios_api::fake::Fake::new().psd(PsdAt::Front, |now| Some(1.metres() - now.position.x));
//! #     assert!(fake.run(main).expect_finished().lcd_line(0).starts_with("stopped at x = "));
//! # }
//! # }
//! # fn main() {
//! #     program::check();
//! # }
//! ```
//!
//! This is the API of RoBIOS 6; [`robios7`] is the API of RoBIOS-7. The two share quantities, errors, console, random
//! numbers and time. The parameter of the program's function, [`Robot`] or [`robios7::Robot`], selects the generation.
//!
//! [`fake`] runs a program in a unit test without a simulator.
//!
//! # Sources of nondeterminism
//! A run is reproducible from its files and its seed only if its programs are deterministic. Parts of `std` are not:
//!
//! | instead of | use |
//! |---|---|
//! | `std::time::Instant`, `SystemTime` | [`Robot::now`] |
//! | `std::thread::sleep` | [`Robot::sleep`], [`Robot::ticker`] |
//! | `println!`, `eprintln!`, which write to the simulator's own output | `writeln!` to [`Robot::console`] |
//! | `HashMap` and `HashSet`, whose order is random | `BTreeMap`, `BTreeSet` |
//! | random numbers of the system | [`Robot::random`] |
//! | threads | [tasks](Robot::multi_tasking), [`Robot::every`] |
//! | `std::process::exit`, which would end the simulator | return from the program's function |
//!
//! # Features
//! `serde`: sends and receives serialisable values by radio, with `send_as` and `receive_as` of [`Radio`].
//!
//! Image processing of RoBIOS 6 is not offered yet.

#![warn(missing_docs)]

mod actuator;
mod audio;
mod call_site;
mod camera;
mod console;
mod device;
mod drive;
#[cfg(feature = "serde")]
mod encoding;
pub mod entry;
mod error;
pub mod fake;
mod image;
mod key;
mod layer;
mod lcd;
mod leg;
mod os;
mod port;
mod psd;
mod radio;
mod random;
pub mod robios7;
mod robot;
mod sensor;
mod serial;
mod task;
mod time;
mod tv_remote;
mod unit;

pub use actuator::{Encoder, Motor, Servo, ServoPosition, Ticks};
pub use audio::{Audio, SoundLevel};
pub use camera::{Camera, CameraLens, FrameRate, Levels};
pub use console::Console;
pub use device::{BumperAt, Device, EncoderAt, InfraredAt, MotorAt, PsdAt, ServoAt};
pub use drive::{ControlGains, Drive, Position, Remaining, Velocity};
pub use error::{Error, Result};
pub use image::{ColorImage, DepthImage, GrayImage, ImageSize, LabelImage, Seen};
pub use key::Key;
pub use layer::{LayerFrame, LayerGrid, LayerPoint, Layers};
pub use lcd::{Cursor, Ink, Lcd, LcdPlace, Overflow, Pixel};
pub use leg::{Gait, Leg, LegJoint, LegLink, Legs, LinkPose};
pub use os::{DeviceEntry, MachineType, RobotNumber};
pub use port::{AnalogValue, Ports};
pub use psd::{Psd, RawDistance, Signal};
pub use radio::{MAX_MESSAGE, Message, Radio, RadioSettings, RadioStatus};
pub use random::Random;
pub use robot::Robot;
pub use sensor::{Bumper, Calibration, Compass, Infrared};
pub use serial::{Baud, Handshake, Serial, SerialAt};
pub use task::{
    Permit, PreemptionGuard, Priority, Semaphore, Shared, SharedGuard, Task, TaskMode, TaskSettings, Tasks,
};
pub use time::{Ticker, TimeOfDay, Timer, TimerGuard};
pub use tv_remote::{TvCode, TvCoding, TvMode, TvRemote, TvSettings};
pub use unit::{Angle, Frequency, Length, Ratio, Speed, TurnRate, Units};

/// Items that most programs import: `use robios_api::prelude::*;`.
pub mod prelude {
    pub use std::time::Duration;

    pub use crate::{
        Angle, BumperAt, Compass, Drive, EncoderAt, Error, InfraredAt, Key, Length, MotorAt, Psd, PsdAt, Result, Robot,
        ServoAt, Speed, TurnRate, Units,
    };
}
