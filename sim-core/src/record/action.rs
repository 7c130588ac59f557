//! Actions of users on a running simulation (interventions).

use serde::{Deserialize, Serialize};

/// An intervention: one user action, which takes effect at the start of a slot.
///
/// The JSON form is the canonical text in digest and trace, with which a run can be repeated. The names and the order
/// of variants and fields are therefore frozen. Other modules translate other notations, such as that of the window's
/// page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Action {
    /// Presses a key of a robot, touches its display or presses a key of a remote control.
    Press {
        /// Number of the robot.
        robot: u32,
        /// Key in the notation of a `--keys` script: `KEY1` to `KEY4`, `TOUCH(120,40)`, `IRTV_OK`.
        key: String,
    },
    /// Types a line to the standard input of a robot's program.
    Type {
        /// Number of the robot.
        robot: u32,
        /// The line, without its end.
        line: String,
    },
    /// Moves a robot to another pose.
    PlaceRobot {
        /// Number of the robot.
        robot: u32,
        /// World x, m.
        x_m: f64,
        /// World y, m.
        y_m: f64,
        /// Heading, counter-clockwise from x, rad.
        phi_rad: f64,
    },
    /// Moves a movable object to another pose, at rest.
    PlaceObject {
        /// Number of the object.
        object: u32,
        /// World x, m.
        x_m: f64,
        /// World y, m.
        y_m: f64,
        /// Heading, counter-clockwise from x, rad.
        phi_rad: f64,
    },
    /// Sets a parameter of the noise models.
    SetNoise {
        /// Number of the robot; `None` for all robots.
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
    /// Adds a robot of a type known to the scene.
    AddRobot {
        /// Name of the type in the scene.
        kind: String,
        /// Number of the robot whose program the new robot runs; `None` for a robot without a program.
        program_of: Option<u32>,
        /// World x, m.
        x_m: f64,
        /// World y, m.
        y_m: f64,
        /// Heading, counter-clockwise from x, rad.
        phi_rad: f64,
    },
    /// Removes a robot from the world; its program ends and its number is not reused.
    RemoveRobot {
        /// Number of the robot.
        robot: u32,
    },
    /// Adds a movable object of a type known to the scene.
    AddObject {
        /// Name of the type in the scene.
        kind: String,
        /// World x, m.
        x_m: f64,
        /// World y, m.
        y_m: f64,
        /// Heading, counter-clockwise from x, rad.
        phi_rad: f64,
    },
    /// Removes a movable object from the world; its number is not reused.
    RemoveObject {
        /// Number of the object.
        object: u32,
    },
    /// Ends the run.
    End {},
    /// Ends a robot's program, stops its motors and silences its radio; its body stays where it is.
    HaltRobot {
        /// Number of the robot.
        robot: u32,
    },
    /// Makes a range sensor repeat its present reading, or lets it measure again.
    StickSensor {
        /// Number of the robot.
        robot: u32,
        /// Name of the sensor.
        sensor: String,
        /// True to repeat the reading.
        on: bool,
    },
    /// Silences a robot's radio, so that it receives nothing and no other robot receives its messages, or ends the
    /// silence.
    SwitchRadio {
        /// Number of the robot.
        robot: u32,
        /// True to end the silence.
        on: bool,
    },
    /// Carries out another action as a fault of the scene.
    Fault {
        /// Name of the fault.
        name: String,
        /// The action.
        action: Box<Action>,
    },
}

impl Action {
    /// The action with this JSON form. (Serde's decoder is generic; this function is compiled once, in this crate.)
    ///
    /// # Errors
    /// If the value is not an action.
    pub fn from_json(value: &serde_json::Value) -> Result<Self, serde_json::Error> {
        Self::deserialize(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn canonical_text_is_frozen() {
        let canonical = [
            (Action::Press { robot: 1, key: "KEY1".into() }, r#"{"do":"press","robot":1,"key":"KEY1"}"#),
            (Action::Type { robot: 1, line: "3 4".into() }, r#"{"do":"type","robot":1,"line":"3 4"}"#),
            (
                Action::PlaceRobot { robot: 2, x_m: 1.0, y_m: 0.1, phi_rad: -0.5 },
                r#"{"do":"place_robot","robot":2,"x_m":1.0,"y_m":0.1,"phi_rad":-0.5}"#,
            ),
            (
                Action::PlaceObject { object: 3, x_m: 1e-7, y_m: 0.0, phi_rad: 0.0 },
                r#"{"do":"place_object","object":3,"x_m":1e-7,"y_m":0.0,"phi_rad":0.0}"#,
            ),
            (
                Action::SetNoise { robot: None, parameter: "psd.sigma_mm".into(), value: 20.0 },
                r#"{"do":"set_noise","robot":null,"parameter":"psd.sigma_mm","value":20.0}"#,
            ),
            (
                Action::SwitchSensor { robot: 1, sensor: "PSD_FRONT".into(), on: false },
                r#"{"do":"switch_sensor","robot":1,"sensor":"PSD_FRONT","on":false}"#,
            ),
            (
                Action::AddRobot { kind: "S4".into(), program_of: Some(1), x_m: 0.0, y_m: 0.0, phi_rad: 0.0 },
                r#"{"do":"add_robot","kind":"S4","program_of":1,"x_m":0.0,"y_m":0.0,"phi_rad":0.0}"#,
            ),
            (Action::RemoveRobot { robot: 4 }, r#"{"do":"remove_robot","robot":4}"#),
            (
                Action::AddObject { kind: "Can".into(), x_m: 0.0, y_m: 0.0, phi_rad: 0.0 },
                r#"{"do":"add_object","kind":"Can","x_m":0.0,"y_m":0.0,"phi_rad":0.0}"#,
            ),
            (Action::RemoveObject { object: 5 }, r#"{"do":"remove_object","object":5}"#),
            (Action::End {}, r#"{"do":"end"}"#),
            (Action::HaltRobot { robot: 1 }, r#"{"do":"halt_robot","robot":1}"#),
            (
                Action::StickSensor { robot: 1, sensor: "PSD_FRONT".into(), on: true },
                r#"{"do":"stick_sensor","robot":1,"sensor":"PSD_FRONT","on":true}"#,
            ),
            (
                Action::Fault { name: "quiet".into(), action: Box::new(Action::SwitchRadio { robot: 2, on: false }) },
                r#"{"do":"fault","name":"quiet","action":{"do":"switch_radio","robot":2,"on":false}}"#,
            ),
        ];
        for (action, text) in canonical {
            assert_eq!(serde_json::to_string(&action).unwrap(), text);
            assert_eq!(serde_json::from_str::<Action>(text).unwrap(), action);
        }
    }
}
