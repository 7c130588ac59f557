//! Check that the pages of docs/formats/ name every key that the forms declare.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::print::scene_schema;

/// Collects the keys of a schema at any depth.
fn keys(schema: &Value, declared: &mut BTreeSet<String>) {
    match schema {
        Value::Object(entries) => {
            let properties = entries.get("properties").and_then(Value::as_object);
            declared.extend(properties.into_iter().flat_map(|properties| properties.keys().cloned()));
            entries.values().for_each(|value| keys(value, declared));
        }
        Value::Array(items) => items.iter().for_each(|item| keys(item, declared)),
        _ => {}
    }
}

#[test]
fn pages_describe_all_keys() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let pages = ["formats/scene.md", "formats/companion.md", "noise.md", "checks.md", "faults.md"];
    let pages = pages.map(|page| fs::read_to_string(docs.join(page)).expect("a page")).concat();
    let words = |text: &str| text.split(|c: char| !(c.is_alphanumeric() || c == '_')).map(str::to_owned).collect();
    let quoted: BTreeSet<String> =
        pages.split('`').skip(1).step_by(2).flat_map(|quoted| -> Vec<String> { words(quoted) }).collect();
    let mut declared = BTreeSet::new();
    keys(&serde_json::from_str(&scene_schema()).expect("JSON"), &mut declared);
    let undocumented: Vec<&String> = declared.iter().filter(|key| !quoted.contains(*key)).collect();
    assert!(
        declared.len() > 150 && undocumented.is_empty(),
        "{} keys; not on the pages: {undocumented:?}",
        declared.len()
    );
}
