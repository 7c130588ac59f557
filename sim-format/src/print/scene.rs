//! Printing of scenes in our own format, and JSON schemas.

use serde_json::{Value as Json, json};
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
    let mut schema = schema_value("eyesim scene", |keys| SimSpec::default().keys(keys));
    allow_draws(&mut schema);
    schema["$defs"]["DrawForm"] = draw_schema();
    text_of(&schema)
}

/// JSON schema of noise profiles.
pub fn noise_schema() -> String {
    schema("eyesim noise profile", |keys| NoiseSpec::default().keys(keys))
}

/// JSON schema of companions, except for `[psd]`, whose keys are the names of the robot's sensors.
pub fn companion_schema() -> String {
    schema("eyesim companion", |keys| companion(keys, &mut RobiSpec::default()))
}

/// JSON schema of the files whose keys `declare` declares.
pub(crate) fn schema(title: &str, declare: impl FnOnce(&mut Keys<'_>)) -> String {
    text_of(&schema_value(title, declare))
}

fn schema_value(title: &str, declare: impl FnOnce(&mut Keys<'_>)) -> Json {
    let mut definitions = Definitions::default();
    let mut schema = schema_of(&mut definitions, declare);
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = title.into();
    schema["$defs"] = definitions.into();
    schema
}

fn text_of(schema: &Json) -> String {
    serde_json::to_string_pretty(schema).unwrap_or_default() + "\n"
}

/// Allows a draw in place of each number, text, truth value and list in the schema.
fn allow_draws(schema: &mut Json) {
    let draw = || json!({ "$ref": "#/$defs/DrawForm" });
    match schema {
        Json::Object(entries) => {
            entries.values_mut().for_each(allow_draws);
            if let Some(Json::Object(properties)) = entries.get_mut("properties") {
                let values = properties.iter_mut().filter(|(key, _)| *key != "seed" && *key != "kind");
                for (_, value) in values.filter(|(_, value)| is_value(value)) {
                    let mut plain = value.take();
                    let about = plain.as_object_mut().and_then(|plain| plain.remove("description"));
                    *value = json!({ "description": about, "anyOf": [plain, draw()] });
                }
            }
            if let Some(items) = entries.get_mut("items").filter(|items| is_value(items)) {
                *items = json!({ "anyOf": [items.take(), draw()] });
            }
        }
        Json::Array(items) => items.iter_mut().for_each(allow_draws),
        _ => {}
    }
}

/// Returns true for the schema of a number, a text, a truth value or a list.
fn is_value(schema: &Json) -> bool {
    let is_plain = |kind: &Json| kind.as_str().is_some_and(|kind| kind != "object");
    match &schema["type"] {
        Json::Array(kinds) => kinds.iter().all(is_plain),
        kind => is_plain(kind),
    }
}

/// Schema of the tables that represent random values.
fn draw_schema() -> Json {
    let pair = json!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 });
    let number = json!({ "type": "number" });
    let table = |about: &str, required: &str, properties: Json| {
        json!({
            "description": about, "type": "object", "properties": properties, "required": [required],
            "additionalProperties": false,
        })
    };
    json!({
        "description": "A value that is drawn from the seed.",
        "oneOf": [
            table("A number between both ends; an integer if both ends are integers.", "uniform", json!({ "uniform": pair })),
            table(
                "A number of the normal distribution with this mean and standard deviation, drawn again until it is within the limits.",
                "normal",
                json!({ "normal": pair, "min": number, "max": number }),
            ),
            table("One of these values.", "choice", json!({ "choice": { "type": "array", "minItems": 1 } })),
            table("The value drawn at this path.", "same_as", json!({ "same_as": { "type": "string" } })),
            table(
                "The drawing of a maze: columns and rows.",
                "random_maze",
                json!({ "random_maze": pair, "loops_percent": number, "cell_mm": number }),
            ),
        ],
    })
}

/// Text of the section `[[key]]` with the content of `form`.
pub(crate) fn section<F: Form>(key: &str, form: &F) -> String {
    text::document(&Table::from_iter([(key.to_owned(), Value::Array(vec![print(form).into()]))]))
}
