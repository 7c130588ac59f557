//! Events of a run. One list generates the enum, the kinds and the JSON names; a test compares `docs/trace.md` with it.

mod canonical;
mod cell;
mod field;
mod line;
mod set;

use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize};

pub(super) use canonical::Canonical;
use cell::Tabular;
pub use cell::{Cell, CellType};
pub use field::{ActionText, FloatList, Obstacle, Outcome};
pub use line::{Record, WORLD};
pub use set::KindSet;

/// Defines [`Event`] and the items derived from the list of its variants.
macro_rules! events {
    ($(
        $(#[$doc:meta])*
        $name:ident = $tag:literal { $( $(#[$field_doc:meta])* $field:ident: $type:ty, )* }
    )*) => {
        /// An action, reading or contact of a robot. Strings are borrowed, so that recording does not allocate.
        ///
        /// SI units; the unit is in each field's name. The order of variants and fields is part of the digest: a change
        /// to it changes the digest of every run.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        pub enum Event<'a> {
            $( $(#[$doc])* $name { $( $(#[$field_doc])* $field: $type, )* }, )*
        }

        /// Kind of an [`Event`]. The number of the kind is the first byte of the event's canonical form.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum Kind {
            $( $(#[$doc])* $name, )*
        }

        impl Kind {
            /// All kinds in the order of their numbers.
            pub const ALL: &[Self] = &[$( Self::$name, )*];

            /// Name in the trace, such as `lcd_text`.
            pub fn name(self) -> &'static str {
                match self { $( Self::$name => $tag, )* }
            }

            /// Names of the fields in the trace.
            pub fn fields(self) -> &'static [&'static str] {
                match self { $( Self::$name => &[$( stringify!($field), )*], )* }
            }
        }

        impl<'a> Event<'a> {
            /// Types of the cells of events of a kind, in the order of [`Kind::fields`].
            pub fn cell_types(kind: Kind) -> &'static [CellType] {
                match kind { $( Kind::$name => const { &[$( <$type as Tabular>::TYPE, )*] }, )* }
            }
        }

        impl Canonical for Event<'_> {
            fn write(&self, bytes: &mut Vec<u8>) {
                u32::from(self.kind() as u8).write(bytes);
                match self {
                    $( Self::$name { $( $field, )* } => { $( $field.write(bytes); )* } )*
                }
            }
        }

        impl Event<'_> {
            /// Kind of this event.
            pub fn kind(&self) -> Kind {
                match self { $( Self::$name { .. } => Kind::$name, )* }
            }

            /// Passes the cells of the fields to `visit`, in the order of [`Kind::fields`].
            pub fn for_each_cell(&self, mut visit: impl FnMut(Cell<'_>)) {
                match self { $( Self::$name { $( $field, )* } => { $( visit($field.cell()); )* } )* }
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
    /// A program starts.
    ProgramStarted = "program_started" {
        /// The name of the program; empty for a robot without one.
        program: &'a str,
    }
    /// A program has ended, or the run has ended while the program was running.
    ProgramEnded = "program_ended" {
        /// State of the program.
        outcome: Outcome,
        /// Exit code, if the program has one.
        exit_code: Option<i32>,
    }
    /// Pose of a robot at the end of a slot in which it moved.
    Pose = "pose" {
        /// World x, m.
        x_m: f64,
        /// World y, m.
        y_m: f64,
        /// Heading, counter-clockwise from x, wrapped to [-pi, pi), rad.
        phi_rad: f64,
        /// Whole turns of the heading.
        turns: i64,
    }
    /// A robot touched an obstacle.
    Contact = "contact" {
        /// Instant of the contact, s, rounded up to a microsecond; equal to the event's time.
        at_s: f64,
        /// The obstacle.
        with: Obstacle,
        /// World x of the point of contact, m.
        x_m: f64,
        /// World y of the point of contact, m.
        y_m: f64,
    }
    /// Command: drive at these speeds until the next command.
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
        /// Angle turned along the arc, rad.
        angle_rad: f64,
        /// Speed, m/s.
        v_m_per_s: f64,
    }
    /// Command: set the odometry to this pose.
    SetOdometry = "set_odometry" {
        /// x in the odometry frame, m.
        x_m: f64,
        /// y in the odometry frame, m.
        y_m: f64,
        /// Heading in the odometry frame, rad.
        phi_rad: f64,
    }
    /// The speed controller is started with these gains.
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
    /// The speed controller is stopped.
    ControlStopped = "control_stopped" {}
    /// A motor is set.
    Motor = "motor" {
        /// Name of the motor.
        device: &'a str,
        /// Percentage of the maximum rate, -100 to 100.
        percent: i32,
    }
    /// A servo is set.
    Servo = "servo" {
        /// Name of the servo.
        device: &'a str,
        /// Position, 0 to 255.
        position: i32,
    }
    /// A latch, port or other output is set.
    Output = "output" {
        /// Name of the device.
        device: &'a str,
        /// Value in the device's unit.
        value: i64,
    }
    /// A PSD sensor is read.
    Distance = "distance" {
        /// Name of the sensor.
        device: &'a str,
        /// The measured distance; `None` if out of range.
        distance_m: Option<f64>,
        /// Time of the measurement, s.
        measured_s: f64,
    }
    /// A compass is read.
    Compass = "angle" {
        /// Name of the sensor.
        device: &'a str,
        /// The measured angle; `None` before the first measurement.
        angle_rad: Option<f64>,
    }
    /// An encoder, bumper, infrared sensor, latch or A/D channel is read.
    Reading = "reading" {
        /// Name of the sensor.
        device: &'a str,
        /// Value in the sensor's unit: counts, 0 or 1.
        value: i64,
    }
    /// The odometry's pose is read.
    Odometry = "odometry" {
        /// x in the odometry frame, m.
        x_m: f64,
        /// y in the odometry frame, m.
        y_m: f64,
        /// Heading in the odometry frame, rad.
        phi_rad: f64,
    }
    /// The odometry's velocity is read.
    OdometrySpeed = "odometry_speed" {
        /// Forward speed, m/s.
        v_m_per_s: f64,
        /// Turning speed, rad/s.
        omega_rad_per_s: f64,
    }
    /// Text is written on the display.
    LcdText = "lcd_text" {
        /// Row, 0 to 6.
        row: u8,
        /// Column, 0 to 15.
        column: u8,
        /// The text.
        text: &'a str,
    }
    /// The display is cleared.
    LcdClear = "lcd_clear" {}
    /// A graphics function draws on the display.
    LcdGraphics = "lcd_graphics" {
        /// Name of the RoBIOS function.
        function: &'a str,
        /// Number of pixels that were changed.
        changed_pixels: u32,
    }
    /// A text of the menu line is set.
    LcdMenu = "lcd_menu" {
        /// Position in the menu line, 1 to 4, from the left.
        position: u8,
        /// The text.
        text: &'a str,
    }
    /// The loudspeaker plays a tone.
    Tone = "tone" {
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Duration, s.
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
        /// Name of the key, `KEY1` to `KEY4`.
        key: &'a str,
    }
    /// Bytes are sent through a serial interface.
    SerialSent = "serial_sent" {
        /// Name of the interface, `SERIAL1` to `SERIAL16`.
        port: &'a str,
        /// The bytes.
        data: &'a [u8],
    }
    /// The program takes bytes from a serial interface.
    SerialReceived = "serial_received" {
        /// Name of the interface, `SERIAL1` to `SERIAL16`.
        port: &'a str,
        /// The bytes.
        data: &'a [u8],
    }
    /// A timer is started.
    TimerAttached = "timer_attached" {
        /// Handle of the timer.
        timer: u32,
        /// Period, s.
        period_s: f64,
    }
    /// A timer is stopped.
    TimerDetached = "timer_detached" {
        /// Handle of the timer.
        timer: u32,
    }
    /// The program writes a line to its standard output.
    Stdout = "stdout" {
        /// The line without its line ending.
        text: &'a str,
    }
    /// Pose of a movable object at the end of a slot in which it moved; an event of the world.
    Object = "object" {
        /// Number of the object.
        object: u32,
        /// World x, m.
        x_m: f64,
        /// World y, m.
        y_m: f64,
        /// Heading, counter-clockwise from x, wrapped to [-pi, pi), rad.
        phi_rad: f64,
        /// Whole turns of the heading.
        turns: i64,
    }
    /// A laser scanner is read.
    Scan = "scan" {
        /// Number of points.
        points: u32,
        /// The shortest distance; `None` if no ray has a return.
        nearest_m: Option<f64>,
        /// Direction of that ray, counter-clockwise from the robot's forward direction, rad.
        bearing_rad: Option<f64>,
        /// Sum of all distances as the program gets them, mm.
        sum_mm: i64,
    }
    /// A robot is moved to another pose.
    Placed = "placed" {
        /// Number of the robot whose program requested it; 0 for an intervention.
        by: u32,
        /// World x, m.
        x_m: f64,
        /// World y, m.
        y_m: f64,
        /// Heading, rad.
        phi_rad: f64,
    }
    /// A movable object is moved to another pose; an event of the world.
    ObjectPlaced = "object_placed" {
        /// Number of the object.
        object: u32,
        /// Number of the robot whose program requested it; 0 for an intervention.
        by: u32,
        /// World x, m.
        x_m: f64,
        /// World y, m.
        y_m: f64,
        /// Heading, rad.
        phi_rad: f64,
    }
    /// The signal of a range sensor is read.
    Signal = "signal" {
        /// Name of the sensor.
        device: &'a str,
        /// Signal in the sensor's unit: 1/m for a reflectance sensor; for a sonar, relative to the echo of a perfect
        /// reflector at 1 m.
        signal: f64,
        /// Time of the measurement, s.
        measured_s: f64,
    }
    /// An image is taken by the camera, or depths or labels of the last image are read.
    Image = "frame" {
        /// Number of the image; each camera counts its images from 1.
        frame: u64,
        /// Kind of data: `colour`, `grey` or `bayer` for an image; `depth` or `labels` of the last image.
        form: &'a str,
        /// Width of the image in pixels.
        width_px: u32,
        /// Height of the image in pixels.
        height_px: u32,
        /// Time of the exposure, s.
        exposed_s: f64,
        /// BLAKE3 hash of the bytes as the program gets them.
        hash: &'a str,
    }
    /// A message is sent by radio.
    RadioSent = "radio_sent" {
        /// Number of the message; each sender numbers its messages from 1.
        message: u64,
        /// Destination address; `None` for all stations.
        to: Option<u32>,
        /// Start of the transmission, s; `None` if it is not known when the message is sent.
        begins_s: Option<f64>,
        /// The bytes.
        data: &'a [u8],
    }
    /// A message arrives at a robot's radio, from which the program can read it.
    RadioArrived = "radio_arrived" {
        /// Number of the robot that sent the message.
        from: u32,
        /// Number of the message.
        message: u64,
        /// Time of arrival, s: the end of the transmission plus the latency.
        arrived_s: f64,
        /// Number of inverted bits.
        bit_errors: u32,
    }
    /// A message is lost; recorded for the intended receiver if there is one, otherwise for the sender.
    RadioLost = "radio_lost" {
        /// Number of the robot that sent the message.
        from: u32,
        /// Number of the message.
        message: u64,
        /// Time at which the message would have arrived, s.
        arrived_s: f64,
        /// Cause: `packet`, `range`, `sight`, `collision`, `baud`, `nobody`, `off`, `overflow`, `unsent` or `end`.
        cause: &'a str,
    }
    /// The program reads a message from its radio.
    RadioReceived = "radio_received" {
        /// Number of the robot that sent the message.
        from: u32,
        /// Number of the message.
        message: u64,
        /// The bytes as received.
        data: &'a [u8],
    }
    /// A user, or a fault of the scene, has intervened in the run; an event of the world.
    Intervention = "intervention" {
        /// The action.
        #[serde(borrow)]
        action: ActionText<'a>,
    }
    /// Command: change the gait.
    Gait = "gait" {
        /// Number of the gait, from 1.
        gait: u32,
        /// Name of the gait.
        name: &'a str,
    }
    /// Command: walk at these speeds until the next command.
    LegSpeed = "leg_speed" {
        /// Forward speed, m/s.
        vx_m_per_s: f64,
        /// Speed to the left, m/s.
        vy_m_per_s: f64,
        /// Turning speed, rad/s.
        omega_rad_per_s: f64,
    }
    /// Command: set the height to which the feet are lifted.
    StepHeight = "step_height" {
        /// Height, m.
        height_m: f64,
    }
    /// Command: shift the footholds of a leg.
    LegCorrection = "leg_correction" {
        /// Name of the leg.
        leg: &'a str,
        /// Shift forwards, m.
        dx_m: f64,
        /// Shift to the left, m.
        dy_m: f64,
        /// Additional height to which the foot is lifted, m.
        dz_m: f64,
    }
    /// The angle of a joint is read.
    Joint = "joint" {
        /// Name of the leg and joint.
        joint: &'a str,
        /// Angle of the joint, rad.
        angle_rad: f64,
    }
    /// The pose of a link in the body's frame is read.
    Link = "link" {
        /// Name of the leg and link.
        link: &'a str,
        /// Position forwards, m.
        x_m: f64,
        /// Position to the left, m.
        y_m: f64,
        /// Position upwards, m.
        z_m: f64,
        /// Roll, rad.
        roll_rad: f64,
        /// Pitch, rad.
        pitch_rad: f64,
        /// Yaw, rad.
        yaw_rad: f64,
    }
    /// The height of the body is read.
    BodyHeight = "body_height" {
        /// Height, m.
        height_m: f64,
    }
    /// Posture of a robot with legs or in the water, at the end of a slot in which the posture changed.
    Posture = "posture" {
        /// Height of the body's frame above the plane of the floor, m.
        lift_m: f64,
        /// Angles of all joints, leg by leg, rad.
        #[serde(borrow)]
        joints_rad: FloatList<'a>,
    }
    /// A foot touches down.
    Footfall = "footfall" {
        /// Name of the leg.
        leg: &'a str,
        /// World x of the foothold, m.
        x_m: f64,
        /// World y, m.
        y_m: f64,
        /// World z, m.
        z_m: f64,
    }
    /// Start of an unintended contact of a legged robot's part with an obstacle.
    LegContact = "touch" {
        /// Name of the leg and link, or `body`.
        part: &'a str,
        /// The obstacle.
        with: Obstacle,
        /// World x of the point of contact, m.
        x_m: f64,
        /// World y, m.
        y_m: f64,
        /// World z, m.
        z_m: f64,
    }
    /// The program writes a line to its standard error. A note: not part of the digest.
    Stderr = "stderr" {
        /// The line without its line ending.
        text: &'a str,
    }
    /// A program has failed. A note: not part of the digest.
    ProgramFailed = "fault" {
        /// Kind of the failure, such as `SIGSEGV` or `panic`.
        what: &'a str,
        /// Source file and line; empty if unknown.
        location: &'a str,
        /// Last RoBIOS call before the failure; empty if there was none.
        last_call: &'a str,
    }
    /// Explanation of why a program ended or what it waits for. A note: not part of the digest.
    Reason = "reason" {
        /// The explanation.
        text: &'a str,
    }
    /// A likely mistake in the program. A note: not part of the digest.
    Hint = "hint" {
        /// The hint.
        text: &'a str,
    }
    /// A RoBIOS call, recorded in verbose runs only. A note: not part of the digest.
    Call = "call" {
        /// Name of the function.
        function: &'a str,
        /// Arguments as the caller would write them, separated by commas.
        arguments: &'a str,
        /// Result; empty for none.
        result: &'a str,
    }
    /// The program calls a function that the scene forbids: the call fails without any effect.
    Forbidden = "forbidden" {
        /// Name of the function.
        function: &'a str,
    }
}

impl Kind {
    /// Returns true for a note: an event that may differ between equal runs (source paths, thread numbers in a panic's
    /// message, calls recorded on request). Notes have no sequence number and are not part of the digest.
    pub fn is_note(self) -> bool {
        matches!(self, Self::Stderr | Self::ProgramFailed | Self::Reason | Self::Hint | Self::Call)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn canonical_form_begins_with_the_kind() {
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
