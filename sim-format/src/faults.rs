//! Validation of a scene's faults: existing robots, sensors and noise parameters, unique names.

use std::collections::BTreeMap;

use sim_core::device::switch::{self, SensorId};
use sim_core::drive::DriveKind;
use sim_core::noise::Profile;

use super::code::Code;
use super::diagnostic::{Diagnostic, Sink};
use super::line;
use super::spec::{FaultKind, RobiSpec, SceneSpec, SlippingWheels};

/// Mistakes in the faults of a scene whose robots are known.
pub(super) fn check(scene: &SceneSpec) -> Vec<Diagnostic> {
    let mut sink = Sink::new(&scene.file);
    let mut names: BTreeMap<&str, u32> = BTreeMap::new();
    for fault in &scene.faults {
        if let Some(line) = names.insert(fault.title(), fault.span.line) {
            let message = format!("the fault of line {line} is named `{}`, too", fault.title());
            sink.error(Code::FaultName, fault.span, message, "each `name` once: random instants are drawn by it");
        }
        let Some(robot) = scene.robots.iter().find(|robot| robot.id == fault.robot) else {
            let message = format!("fault `{}` is one of {}, which the scene does not have", fault.title(), fault.robot);
            let expected = format!("a number from 1 to {}", scene.robots.len());
            sink.error(Code::FaultTarget, fault.span, message, expected);
            continue;
        };
        let mistake = match &fault.kind {
            FaultKind::SensorOff { sensor } => unknown_sensor(&robot.robi, sensor, |_| true),
            FaultKind::SensorStuck { sensor } => {
                unknown_sensor(&robot.robi, sensor, |kind| matches!(kind, SensorId::Range(_)))
            }
            FaultKind::Noise { parameter, value } => {
                let error = Profile::default().set_parameter(parameter, *value).err();
                error.map(|error| {
                    let parameters = Profile::default().parameters();
                    let names: Vec<String> = parameters.into_iter().map(|parameters| parameters.name()).collect();
                    let nearest = line::nearest(parameter, names.iter().map(String::as_str)).map(str::to_owned);
                    (
                        error.to_string(),
                        "a table and a key of docs/noise.md, and a value in its range".to_owned(),
                        nearest,
                    )
                })
            }
            FaultKind::Slip { wheels, .. } => immune_wheels(&robot.robi, *wheels),
            FaultKind::Dies | FaultKind::RadioOff => None,
        };
        if let Some((message, expected, nearest)) = mistake {
            let nearest = nearest.map(|nearest| format!("write `{nearest}`"));
            sink.error(Code::FaultTarget, fault.span, message, expected).suggestion = nearest;
        }
    }
    sink.finish()
}

/// Message, expectation and suggestion if these wheels of the robot cannot slip.
fn immune_wheels(robi: &RobiSpec, wheels: SlippingWheels) -> Option<(String, String, Option<String>)> {
    match robi.drive.kind {
        DriveKind::Legged | DriveKind::Thrusters => {
            let message = format!("`{}` has no wheels with a motor that could slip", robi.name);
            Some((message, "another fault, or a robot with another drive".to_owned(), None))
        }
        DriveKind::Ackermann if wheels != SlippingWheels::All => {
            let message = format!("the wheels of `{}` have one motor: those of one side do not slip alone", robi.name);
            Some((message, "a slip of all wheels".to_owned(), Some("wheels = \"all\"".to_owned())))
        }
        _ => None,
    }
}

/// Message, expectation and most similar name if the robot does not have the sensor.
fn unknown_sensor(
    robi: &RobiSpec,
    name: &str,
    is_suitable: impl Fn(SensorId) -> bool,
) -> Option<(String, String, Option<String>)> {
    let sensors: Vec<&str> =
        switch::sensors(robi).filter(|(_, kind)| is_suitable(*kind)).map(|(name, _)| name).collect();
    if sensors.contains(&name) {
        return None;
    }
    let message = format!("`{}` has no sensor `{name}` that this fault could concern", robi.name);
    let list = sensors.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let expected = if sensors.is_empty() { "another fault: it has none".to_owned() } else { format!("one of {list}") };
    Some((message, expected, line::nearest(name, sensors).map(str::to_owned)))
}
