//! Scenes of our own form, and their JSON schema.

use toml::{Table, Value};

use super::text;
use crate::form::{Definitions, Form, print, schema as schema_of};
use crate::spec::SimSpec;

/// The text of a scene. All that a spec can say has its place in it.
///
/// Lines whose type only a loaded file tells to be a robot or an object are taken for robots.
pub fn print_scene(sim: &SimSpec) -> String {
    text::document(&print(sim))
}

/// The JSON schema of [`print_scene`]'s texts, from which editors complete.
pub fn scene_schema() -> String {
    let mut definitions = Definitions::default();
    let mut schema = schema_of(&mut definitions, |keys| SimSpec::default().keys(keys));
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = "eyesim scene".into();
    schema["$defs"] = definitions.into();
    serde_json::to_string_pretty(&schema).unwrap_or_default() + "\n"
}

/// The text of the section `[[key]]` that says what `form` says.
pub(crate) fn section<F: Form>(key: &str, form: &F) -> String {
    text::document(&Table::from_iter([(key.to_owned(), Value::Array(vec![print(form).into()]))]))
}
