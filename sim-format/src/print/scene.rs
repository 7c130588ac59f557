//! Printing of scenes in our own form, and their JSON schema.

use toml::{Table, Value};

use super::text;
use crate::form::robot::companion;
use crate::form::{Definitions, Form, Keys, print, schema as schema_of};
use crate::spec::{NoiseSpec, RobiSpec, SimSpec};

/// Text of a scene. The format represents everything that a spec contains.
///
/// Lines that name a type without stating whether it is a robot or an object are printed as robots.
pub fn print_scene(sim: &SimSpec) -> String {
    text::document(&print(sim))
}

/// JSON schema of [`print_scene`]'s texts, for completion in editors.
pub fn scene_schema() -> String {
    schema("eyesim scene", |keys| SimSpec::default().keys(keys))
}

/// JSON schema of noise profiles.
pub fn noise_schema() -> String {
    schema("eyesim noise profile", |keys| NoiseSpec::default().keys(keys))
}

/// JSON schema of companions, but for `[psd]`, whose keys are the names of the robot's sensors.
pub fn companion_schema() -> String {
    schema("eyesim companion", |keys| companion(keys, &mut RobiSpec::default()))
}

/// JSON schema of the files whose keys `declare` declares.
pub(crate) fn schema(title: &str, declare: impl FnOnce(&mut Keys<'_>)) -> String {
    let mut definitions = Definitions::default();
    let mut schema = schema_of(&mut definitions, declare);
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = title.into();
    schema["$defs"] = definitions.into();
    serde_json::to_string_pretty(&schema).unwrap_or_default() + "\n"
}

/// Text of the section `[[key]]` with the content of `form`.
pub(crate) fn section<F: Form>(key: &str, form: &F) -> String {
    text::document(&Table::from_iter([(key.to_owned(), Value::Array(vec![print(form).into()]))]))
}
