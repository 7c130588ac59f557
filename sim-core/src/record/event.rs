//! The events of a run, in one list from which enum, kinds, JSON names and the check of `docs/trace.md` come.

mod field;
mod line;
mod set;

use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize};

pub use field::{ActionText, Numbers, Obstacle, Outcome};
pub use line::{Record, WORLD};
pub use set::KindSet;

/// Defines [`Event`] and what depends on the list of its variants.
macro_rules! events {
    ($(
        $(#[$doc:meta])*
        $name:ident = $tag:literal { $( $(#[$field_doc:meta])* $field:ident: $type:ty, )* }
    )*) => {
        /// One thing that a robot did, read or met. Strings are borrowed, so that recording allocates nothing.
        ///
        /// SI units; the unit is in each field's name. The order of variants and fields is part of the digest: a change
        /// to it changes the digest of every run.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        pub enum Event<'a> {
            $( $(#[$doc])* $name { $( $(#[$field_doc])* $field: $type, )* }, )*
        }

        /// Which [`Event`]; the number is the first byte of its canonical form.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum Kind {
            $( $(#[$doc])* $name, )*
        }

        impl Kind {
            /// All kinds in the order of their numbers.
            pub const ALL: &[Self] = &[$( Self::$name, )*];

            /// The name in the trace, such as `lcd_text`.
            pub fn name(self) -> &'static str {
                match self { $( Self::$name => $tag, )* }
            }

            /// The names of the fields in the trace.
            pub fn fields(self) -> &'static [&'static str] {
                match self { $( Self::$name => &[$( stringify!($field), )*], )* }
            }
        }

        impl Event<'_> {
            /// Which variant this is.
            pub fn kind(&self) -> Kind {
                match self { $( Self::$name { .. } => Kind::$name, )* }
            }

            /// Writes the event's fields as entries of a map.
            fn serialize_fields<M: SerializeMap>(&self, map: &mut M) -> Result<(), M::Error> {
                match self {
                    $( Self::$name { $( $field, )* } => { $( map.serialize_entry(stringify!($field), $field)?; )* } )*
                }
                Ok(())
            }
        }
    };
}

events! {
    /// A program begins.
    ProgramStarted = "program_started" {
        /// The name of the program; empty for a robot without one.
        program: &'a str,
    }
    /// A program has ended, or the run has ended before it.
    ProgramEnded = "program_ended" {
        /// How it stands.
        outcome: Outcome,
        /// Its exit code, where it gave one.
        exit_code: Option<i32>,
    }
    /// Where a body that moved is at the end of a slot.
    Pose = "pose" {
        /// World coordinate to the right, m.
        x_m: f64,
        /// World coordinate upwards, m.
        y_m: f64,
        /// Heading within the turn, counter-clockwise from x, in [-pi, pi), rad.
        phi_rad: f64,
        /// Whole turns of the heading.
        turns: i64,
    }
    /// A body touched something.
    Contact = "contact" {
        /// The instant, s: the event's time before rounding to microseconds.
        at_s: f64,
        /// What it touched.
        with: Obstacle,
        /// Point of contact, m.
        x_m: f64,
        /// Point of contact, m.
        y_m: f64,
    }
    /// Command: drive at these speeds until further notice.
    DriveSpeed = "drive_speed" {
        /// Forward speed, m/s.
        v_m_per_s: f64,
        /// Turning speed, rad/s.
        omega_rad_per_s: f64,
    }
    /// Command: drive a straight line.
    DriveStraight = "drive_straight" {
        /// Length, negative backwards, m.
        distance_m: f64,
        /// Speed, m/s.
        v_m_per_s: f64,
    }
    /// Command: turn on the spot.
    DriveTurn = "drive_turn" {
        /// Angle, counter-clockwise positive, rad.
        angle_rad: f64,
        /// Turning speed, rad/s.
        omega_rad_per_s: f64,
    }
    /// Command: drive an arc.
    DriveCurve = "drive_curve" {
        /// Arc length, m.
        distance_m: f64,
        /// Angle turned on it, rad.
        angle_rad: f64,
        /// Speed, m/s.
        v_m_per_s: f64,
    }
    /// Command: the odometry takes these values.
    SetOdometry = "set_odometry" {
        /// m
        x_m: f64,
        /// m
        y_m: f64,
        /// rad
        phi_rad: f64,
    }
    /// The speed controller starts with these gains.
    ControlStarted = "control_started" {
        /// Proportional gain of the forward speed.
        v_gain: f64,
        /// Reset time of the forward speed, s.
        v_reset_s: f64,
        /// Proportional gain of the turning speed.
        omega_gain: f64,
        /// Reset time of the turning speed, s.
        omega_reset_s: f64,
    }
    /// The speed controller stops.
    ControlStopped = "control_stopped" {}
    /// A motor is set.
    Motor = "motor" {
        /// Name of the motor.
        device: &'a str,
        /// -100 to 100.
        percent: i32,
    }
    /// A servo is set.
    Servo = "servo" {
        /// Name of the servo.
        device: &'a str,
        /// 0 to 255.
        position: i32,
    }
    /// A latch, port or other output is set.
    Output = "output" {
        /// Name of the device.
        device: &'a str,
        /// In the device's own unit.
        value: i64,
    }
    /// A PSD sensor is read.
    Distance = "distance" {
        /// Name of the sensor.
        device: &'a str,
        /// The measured distance; none when it saw nothing within its range.
        distance_m: Option<f64>,
        /// When it was measured, s.
        measured_s: f64,
    }
    /// A compass is read.
    Angle = "angle" {
        /// Name of the sensor.
        device: &'a str,
        /// The measured angle, none when there is none yet.
        angle_rad: Option<f64>,
    }
    /// An encoder, bumper, infrared sensor, latch, A/D channel or other counter is read.
    Reading = "reading" {
        /// Name of the sensor.
        device: &'a str,
        /// In the sensor's own unit: ticks, counts, 0 or 1.
        value: i64,
    }
    /// The position by odometry is read.
    Odometry = "odometry" {
        /// m
        x_m: f64,
        /// m
        y_m: f64,
        /// rad
        phi_rad: f64,
    }
    /// The speed by odometry is read.
    OdometrySpeed = "odometry_speed" {
        /// Forward speed, m/s.
        v_m_per_s: f64,
        /// Turning speed, rad/s.
        omega_rad_per_s: f64,
    }
    /// Text is written on the display.
    LcdText = "lcd_text" {
        /// 0 to 6.
        row: u8,
        /// 0 to 15.
        column: u8,
        /// What is written.
        text: &'a str,
    }
    /// The display is cleared.
    LcdClear = "lcd_clear" {}
    /// Something is drawn on the display.
    LcdGraphics = "lcd_graphics" {
        /// The RoBIOS function.
        function: &'a str,
        /// Number of pixels that it changed.
        changed_pixels: u32,
    }
    /// A text of the menu line is set.
    LcdMenu = "lcd_menu" {
        /// 1 to 4, from the left.
        position: u8,
        /// The text.
        text: &'a str,
    }
    /// The loudspeaker plays a tone.
    Tone = "tone" {
        /// Hz
        frequency_hz: f64,
        /// s
        duration_s: f64,
    }
    /// The loudspeaker beeps.
    Beep = "beep" {}
    /// The loudspeaker plays a sample.
    Sample = "sample" {
        /// Size of the sample, bytes.
        length_bytes: u64,
    }
    /// The program takes a key press.
    Key = "key" {
        /// `KEY1` to `KEY4`.
        key: &'a str,
    }
    /// Bytes leave by a serial interface.
    SerialSent = "serial_sent" {
        /// `SERIAL1` to `SERIAL16`.
        port: &'a str,
        /// The bytes.
        data: &'a [u8],
    }
    /// The program takes bytes from a serial interface.
    SerialReceived = "serial_received" {
        /// `SERIAL1` to `SERIAL16`.
        port: &'a str,
        /// The bytes.
        data: &'a [u8],
    }
    /// A timer begins.
    TimerAttached = "timer_attached" {
        /// Handle.
        timer: u32,
        /// s
        period_s: f64,
    }
    /// A timer ends.
    TimerDetached = "timer_detached" {
        /// Handle.
        timer: u32,
    }
    /// The program writes a line to its standard output.
    Stdout = "stdout" {
        /// The line without its end.
        text: &'a str,
    }
    /// Where a movable object that moved is at the end of a slot; of the world, not of a robot.
    Object = "object" {
        /// Its number.
        object: u32,
        /// World coordinate to the right, m.
        x_m: f64,
        /// World coordinate upwards, m.
        y_m: f64,
        /// Heading within the turn, counter-clockwise from x, in [-pi, pi), rad.
        phi_rad: f64,
        /// Whole turns of the heading.
        turns: i64,
    }
    /// A laser scanner is read.
    Scan = "scan" {
        /// Number of points.
        points: u32,
        /// The nearest distance; none when it saw nothing within its range.
        nearest_m: Option<f64>,
        /// Where that is, counter-clockwise from ahead, rad.
        bearing_rad: Option<f64>,
        /// All distances as the program gets them, added up, mm.
        sum_mm: i64,
    }
    /// A robot is put at another place.
    Placed = "placed" {
        /// Number of the robot whose program did it.
        by: u32,
        /// World coordinate to the right, m.
        x_m: f64,
        /// World coordinate upwards, m.
        y_m: f64,
        /// rad
        phi_rad: f64,
    }
    /// A movable object is put at another place; of the world, not of a robot.
    ObjectPlaced = "object_placed" {
        /// Its number.
        object: u32,
        /// Number of the robot whose program did it.
        by: u32,
        /// World coordinate to the right, m.
        x_m: f64,
        /// World coordinate upwards, m.
        y_m: f64,
        /// rad
        phi_rad: f64,
    }
    /// The signal of a range sensor is read.
    Signal = "signal" {
        /// Name of the sensor.
        device: &'a str,
        /// In the unit of the sensor: 1/m of a reflectance sensor, of a sonar what a perfect reflector 1 m ahead returns.
        signal: f64,
        /// When it was measured, s.
        measured_s: f64,
    }
    /// The camera's image is taken, or what it shows is read.
    Frame = "frame" {
        /// Number of the image among those of its camera, from 1.
        frame: u64,
        /// `colour`, `grey`, `bayer`; `depth` or `labels` of what it shows.
        form: &'a str,
        /// Pixels of a row.
        width_px: u32,
        /// Rows.
        height_px: u32,
        /// When it was exposed, s.
        exposed_s: f64,
        /// BLAKE3 hash of its bytes as the program gets them.
        hash: &'a str,
    }
    /// A message is sent by radio.
    RadioSent = "radio_sent" {
        /// Its number among those of the sender, from 1.
        message: u64,
        /// The address it goes to; none for everybody.
        to: Option<u32>,
        /// When its transmission begins, s; none where the medium decides that later.
        begins_s: Option<f64>,
        /// The bytes.
        data: &'a [u8],
    }
    /// A message comes to a robot's radio and waits there to be read.
    RadioArrived = "radio_arrived" {
        /// Number of the robot that sent it.
        from: u32,
        /// Its number among those of the sender.
        message: u64,
        /// When it arrived, s: the end of its transmission and the latency.
        arrived_s: f64,
        /// How many of its bits are inverted.
        bit_errors: u32,
    }
    /// A message does not come; recorded with the robot that was to hear it, else with the sender.
    RadioLost = "radio_lost" {
        /// Number of the robot that sent it.
        from: u32,
        /// Its number among those of the sender.
        message: u64,
        /// When it would have arrived, s.
        arrived_s: f64,
        /// `packet`, `range`, `sight`, `collision`, `baud`, `nobody`, `off`, `overflow`, `unsent` or `end`.
        cause: &'a str,
    }
    /// The program takes a message from its radio.
    RadioReceived = "radio_received" {
        /// Number of the robot that sent it.
        from: u32,
        /// Its number among those of the sender.
        message: u64,
        /// The bytes, as they arrived.
        data: &'a [u8],
    }
    /// Somebody has taken part in the run from outside; of the world, not of a robot.
    Intervention = "intervention" {
        /// What was done.
        #[serde(borrow)]
        action: ActionText<'a>,
    }
    /// Command: walk in another gait.
    Gait = "gait" {
        /// Its number, from 1.
        gait: u32,
        /// Its name.
        name: &'a str,
    }
    /// Command: walk at these speeds until further notice.
    LegSpeed = "leg_speed" {
        /// Forward speed, m/s.
        vx_m_per_s: f64,
        /// Speed to the left, m/s.
        vy_m_per_s: f64,
        /// Turning speed, rad/s.
        omega_rad_per_s: f64,
    }
    /// Command: lift the feet this high.
    StepHeight = "step_height" {
        /// m
        height_m: f64,
    }
    /// Command: move where a leg treads.
    LegCorrection = "leg_correction" {
        /// Name of the leg.
        leg: &'a str,
        /// Forward, m.
        dx_m: f64,
        /// To the left, m.
        dy_m: f64,
        /// How much higher its foot is lifted, m.
        dz_m: f64,
    }
    /// The angle of a joint is read.
    Joint = "joint" {
        /// Name of leg and joint.
        joint: &'a str,
        /// rad
        angle_rad: f64,
    }
    /// The pose of a link in the body's frame is read.
    Link = "link" {
        /// Name of leg and link.
        link: &'a str,
        /// m
        x_m: f64,
        /// m
        y_m: f64,
        /// m
        z_m: f64,
        /// rad
        roll_rad: f64,
        /// rad
        pitch_rad: f64,
        /// rad
        yaw_rad: f64,
    }
    /// The height of the body is read.
    BodyHeight = "body_height" {
        /// m
        height_m: f64,
    }
    /// How a legged robot holds itself at the end of a slot, where that has changed.
    Posture = "posture" {
        /// How high the body's frame is above the plane of the floor, m.
        lift_m: f64,
        /// Angles of all joints, leg by leg, rad.
        #[serde(borrow)]
        joints_rad: Numbers<'a>,
    }
    /// A foot comes down.
    Footfall = "footfall" {
        /// Name of the leg.
        leg: &'a str,
        /// Where it treads, m.
        x_m: f64,
        /// m
        y_m: f64,
        /// m
        z_m: f64,
    }
    /// A part of a legged robot begins to touch something with which it must not.
    Touch = "touch" {
        /// Name of leg and link, or `body`.
        part: &'a str,
        /// What it touches.
        with: Obstacle,
        /// Point of contact, m.
        x_m: f64,
        /// m
        y_m: f64,
        /// m
        z_m: f64,
    }
    /// The program writes a line to its standard error. A note.
    Stderr = "stderr" {
        /// The line without its end.
        text: &'a str,
    }
    /// A program is broken. A note.
    Fault = "fault" {
        /// What happened, such as `SIGSEGV` or `panic`.
        what: &'a str,
        /// Source file and line, empty where unknown.
        location: &'a str,
        /// The last RoBIOS call before it, empty where there was none.
        last_call: &'a str,
    }
    /// Why a program ended, or what it waits for, in words. A note.
    Reason = "reason" {
        /// The words.
        text: &'a str,
    }
    /// A likely mistake in the program. A note.
    Hint = "hint" {
        /// The words.
        text: &'a str,
    }
    /// A RoBIOS call, recorded in verbose runs only. A note.
    Call = "call" {
        /// Name of the function.
        function: &'a str,
        /// The arguments as the caller would write them, separated by commas.
        arguments: &'a str,
        /// The result, empty for none.
        result: &'a str,
    }
}

impl Kind {
    /// True for what may differ between equal runs (source paths, thread numbers in a panic's message, whether the user
    /// asked for calls): it has no sequence number and is not part of the digest.
    pub fn is_note(self) -> bool {
        matches!(self, Self::Stderr | Self::Fault | Self::Reason | Self::Hint | Self::Call)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kind_is_the_first_byte_of_the_canonical_form() {
        for event in [
            Event::ProgramStarted { program: "square.c" },
            Event::Beep {},
            Event::Call { function: "OSWait", arguments: "5", result: "0" },
        ] {
            let bytes = postcard::to_stdvec(&event).unwrap();
            assert_eq!(bytes[0], event.kind() as u8);
            assert_eq!(postcard::from_bytes::<Event<'_>>(&bytes).unwrap(), event);
        }
    }

    #[test]
    fn names_are_unique_and_kinds_are_numbered_in_order() {
        let names: std::collections::BTreeSet<_> = Kind::ALL.iter().map(|kind| kind.name()).collect();
        assert_eq!(names.len(), Kind::ALL.len());
        for (number, kind) in Kind::ALL.iter().enumerate() {
            assert_eq!(*kind as usize, number);
        }
    }
}
