//! Built-in types: the robots and objects that EyeSim VR provides without files.
//!
//! Each type is a file in one of the usual formats, which is compiled in and read once per process. Sizes and devices
//! are those of the published robots. Values without a source (masses, friction, colours, the sensor at the back) are
//! our choice, documented in docs/formats.

use std::sync::{Arc, OnceLock};

use super::form::robot::read_robot_type;
use super::spec::{ObjectType, RobiSpec};
use super::{Diagnostic, read_companion, read_esobj, read_robi};

/// Names of the built-in robot types.
pub const ROBOTS: [&str; 3] = ["LabBot", "S4", "Mako"];

pub use sim_core::spec::BUILT_IN_OBJECTS as OBJECTS;

/// Built-in robot type called `name`, case-insensitive.
pub fn robot(name: &str) -> Option<Arc<RobiSpec>> {
    static CACHE: [OnceLock<Option<Arc<RobiSpec>>>; ROBOTS.len()] = [const { OnceLock::new() }; ROBOTS.len()];
    let index = index_of(&ROBOTS, name)?;
    CACHE[index].get_or_init(|| read_robot(ROBOTS[index]).map(|(robi, _)| Arc::new(robi))).clone()
}

/// Built-in object type called `name`, case-insensitive.
pub fn object(name: &str) -> Option<Arc<ObjectType>> {
    static CACHE: [OnceLock<Option<Arc<ObjectType>>>; OBJECTS.len()] = [const { OnceLock::new() }; OBJECTS.len()];
    let index = index_of(&OBJECTS, name)?;
    CACHE[index].get_or_init(|| read_object(OBJECTS[index]).map(|(object, _)| Arc::new(object))).clone()
}

fn read_robot(name: &str) -> Option<(RobiSpec, Vec<Diagnostic>)> {
    let name = ROBOTS[index_of(&ROBOTS, name)?];
    let (robi, companion) = match name {
        // A robi can describe neither a hull nor PSDs that point down.
        "Mako" => return Some(read_robot_type(name, include_str!("builtin/mako.toml"))),
        "LabBot" => (include_str!("builtin/labbot.robi"), include_str!("builtin/labbot.toml")),
        _ => (include_str!("builtin/s4.robi"), include_str!("builtin/s4.toml")),
    };
    let (mut spec, mut diagnostics) = read_robi(name, robi);
    diagnostics.extend(read_companion(name, companion, &mut spec));
    Some((spec, diagnostics))
}

fn read_object(name: &str) -> Option<(ObjectType, Vec<Diagnostic>)> {
    let name = OBJECTS[index_of(&OBJECTS, name)?];
    let text = match name {
        "Can" => include_str!("builtin/can.esObj"),
        "Soccer" => include_str!("builtin/soccer.esObj"),
        "Crate" => include_str!("builtin/crate.esObj"),
        _ => include_str!("builtin/golf.esObj"),
    };
    Some(read_esobj(name, text))
}

fn index_of(names: &[&str], name: &str) -> Option<usize> {
    names.iter().position(|known| known.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_files_cause_no_diagnostics() {
        for name in ROBOTS {
            let (robi, diagnostics) = read_robot(name).expect("a built-in robot");
            assert_eq!((diagnostics, robi.name.as_str(), robi.file.as_str()), (vec![], name, name));
            let ids: Vec<_> = robi.psds.iter().map(|psd| (psd.name.as_str(), psd.id)).collect();
            let expected: &[&str] = match name {
                "Mako" => {
                    &["PSD_FRONT", "PSD_FRONT_LEFT", "PSD_FRONT_RIGHT", "PSD_BACK_LEFT", "PSD_BACK_RIGHT", "PSD_DOWN"]
                }
                _ => &["PSD_FRONT", "PSD_LEFT", "PSD_RIGHT", "PSD_BACK"],
            };
            assert_eq!(ids, expected.iter().copied().zip((1..).map(Some)).collect::<Vec<_>>());
        }
        for name in OBJECTS {
            let (object, diagnostics) = read_object(name).expect("a built-in object");
            assert_eq!((diagnostics, object.name.as_str(), object.colliders.len()), (vec![], name, 1));
        }
    }

    #[test]
    fn names_are_case_insensitive() {
        assert_eq!(robot("labbot").map(|robi| robi.diameter), Some(0.26));
        assert_eq!(object("CRATE").map(|object| object.mass), Some(1.0));
        assert_eq!((robot("Can"), object("S4")), (None, None));
    }
}
