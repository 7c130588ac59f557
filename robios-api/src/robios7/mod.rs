//! API of RoBIOS-7, as far as it differs from RoBIOS 6.
//!
//! A program whose function takes this module's [`Robot`] is a program of RoBIOS-7. Devices are numbered from 1 and
//! need no initialisation. Lengths, angles, speeds and times are quantities with units, as in RoBIOS 6; they are passed
//! to RoBIOS as whole millimetres, degrees, mm/s, degrees/s and milliseconds, rounded.
//!
//! ```standalone_crate
//! # mod program {
//! use robios_api::robios7::prelude::*;
//!
//! robios_api::program!(main);
//!
//! fn main(robot: &Robot) -> Result {
//!     let drive = robot.drive();
//!     let front = robot.psd(PsdAt::Front)?;
//!     drive.set_speed(0.2.metres_per_second(), 0.degrees_per_second())?;
//!     while front.distance().is_none_or(|distance| distance > 0.1.metres()) {
//!         robot.sleep(50.millis());
//!     }
//!     drive.stop()?;
//!     writeln!(robot.lcd(), "stopped at x = {:.2}", drive.position().x);
//!     Ok(())
//! }
//! # pub fn check() {
//! #     let fake = robios_api::fake::Fake::new().psd(PsdAt::Front, |now| Some(1.metres() - now.position.x));
//! #     assert!(fake.run_robios7(main).expect_finished().lcd_line(0).starts_with("stopped at x = "));
//! # }
//! # }
//! # fn main() {
//! #     program::check();
//! # }
//! ```

mod actuator;
mod audio;
mod camera;
mod distance;
mod drive;
mod image;
mod key;
mod lcd;
mod os;
mod port;
mod radio;
mod robot;
mod serial;
mod simulation;
mod tv_remote;

pub use actuator::{Encoder, Motor, MotorGains, Servo};
pub use audio::{Audio, SoundLevel};
pub use camera::Camera;
pub use distance::{Lidar, Psd, PsdAt, Scan};
pub use drive::{Drive, Stall};
pub use image::Images;
pub use lcd::{Color, Fill, Font, FontSize, FontStyle, Lcd, LcdMode, LcdPlace};
pub use port::{Direction, Ports, Voltage};
pub use radio::{MAX_MESSAGE, Radio};
pub use robot::Robot;
pub use serial::{Baud, Serial};
pub use simulation::{ObjectNumber, Simulation, TruePose};
pub use tv_remote::TvRemote;

pub use crate::RobotNumber;
pub use crate::image::{ColorImage, DepthImage, GrayImage, ImageSize, LabelImage, Seen};
pub use crate::leg::{Gait, Leg, LegJoint, LegLink, Legs, LinkPose};
pub use crate::radio::Message;

pub(crate) use robot::DeviceSettings;

/// Items that most programs import: `use robios_api::robios7::prelude::*;`.
pub mod prelude {
    pub use std::time::Duration;

    pub use super::{Color, PsdAt, Robot};
    pub use crate::{Angle, Error, Key, Length, Pixel, Position, Result, Speed, TurnRate, Units};
}
