//! User interventions in a simulation.

use serde::{Deserialize, Serialize};

/// User intervention at the start of a slot. Traces contain it in this form, so that a run can be repeated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Action {
    /// Presses a key of a robot, touches its display or uses a remote control.
    Press {
        /// Number of the robot.
        robot: u32,
        /// Key in the notation of `--keys`: `KEY1` to `KEY4`, `TOUCH(120,40)`, `IRTV_OK`.
        key: String,
    },
    /// Types a line to the standard input of a robot's program.
    Type {
        /// Number of the robot.
        robot: u32,
        /// The line, without its line break.
        line: String,
    },
    /// Places a robot at a pose.
    PlaceRobot {
        /// Number of the robot.
        robot: u32,
        /// World x coordinate.
        x_m: f64,
        /// World y coordinate.
        y_m: f64,
        /// Heading, counter-clockwise from x.
        phi_rad: f64,
    },
    /// Places a movable object at a pose, at rest.
    PlaceObject {
        /// Number of the object.
        object: u32,
        /// World x coordinate.
        x_m: f64,
        /// World y coordinate.
        y_m: f64,
        /// Heading, counter-clockwise from x.
        phi_rad: f64,
    },
    /// Sets a parameter of the noise models.
    SetNoise {
        /// Number of the robot; none for all.
        robot: Option<u32>,
        /// Table and key of the noise profile, such as `psd.sigma_mm`.
        parameter: String,
        /// Value in the profile's unit.
        value: f64,
    },
    /// Switches a sensor off, so that it detects nothing, or on again.
    SwitchSensor {
        /// Number of the robot.
        robot: u32,
        /// Name of the sensor.
        sensor: String,
        /// True to switch it on.
        on: bool,
    },
    /// Adds a robot of a type that the scene knows.
    AddRobot {
        /// Name of the type, one of those that can be added (`addable_types` of the scene).
        kind: String,
        /// Number of the robot whose program it runs; none for a robot without a program.
        program_of: Option<u32>,
        /// World x coordinate.
        x_m: f64,
        /// World y coordinate.
        y_m: f64,
        /// Heading, counter-clockwise from x.
        phi_rad: f64,
    },
    /// Removes a robot from the world; its program ends and its number is not reused.
    RemoveRobot {
        /// Number of the robot.
        robot: u32,
    },
    /// Adds a movable object of a type that the scene knows.
    AddObject {
        /// Name of the type, one of those that can be added (`addable_types` of the scene).
        kind: String,
        /// World x coordinate.
        x_m: f64,
        /// World y coordinate.
        y_m: f64,
        /// Heading, counter-clockwise from x.
        phi_rad: f64,
    },
    /// Removes a movable object from the world; its number is not reused.
    RemoveObject {
        /// Number of the object.
        object: u32,
    },
    /// Ends the run.
    End {},
}
