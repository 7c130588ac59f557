//! Help on the TOML formats: their JSON schemas describe each key.

use lsp_types::{CompletionItem, CompletionItemKind};
use serde_json::Value as Json;
use sim_format::{Files, print, suite};

use super::documents::Document;
use super::toml_cursor::{CursorPosition, Outline, Table};
use super::{item, pages};

/// Explanation of the key at `offset`, or of the key whose value is at `offset`.
pub fn hover(document: &Document, offset: usize) -> Option<String> {
    let schema = Schema::of(document)?;
    let outline = Outline::of(&document.text);
    let (schemas, key) = match outline.cursor(offset, &document.text) {
        CursorPosition::Header(path, key) => (schema.table_schemas(&path), key?),
        CursorPosition::Key(table, before) => {
            let is_at_cursor = |entry: &&super::toml_cursor::TableEntry| {
                entry.key_bytes.start <= offset && offset <= entry.key_bytes.end
            };
            let key = table.entries.iter().find(is_at_cursor)?.key.get(before.len())?.clone();
            (schema.table_schemas_of(table, &before, &document.text), key)
        }
        CursorPosition::Value(table, entry) => {
            let (key, before) = entry.key.split_last()?;
            (schema.table_schemas_of(table, before, &document.text), key.clone())
        }
    };
    let property = schemas.iter().find_map(|schema| schema["properties"].get(&key))?;
    let mut text = format!("`{key}`: {}", schema.description(property));
    if let Some(kind) = schema.kind_name(property) {
        text.push_str(&format!("\n\n*{kind}*"));
    }
    for (word, description) in schema.words(property) {
        text.push_str(&format!("\n- `{word}`: {description}"));
    }
    Some(text)
}

/// Completions at `offset`: keys, headers, words or files.
pub fn completions(document: &Document, offset: usize, files: &dyn Files) -> Vec<CompletionItem> {
    let Some(schema) = Schema::of(document) else { return Vec::new() };
    let outline = Outline::of(&document.text);
    match outline.cursor(offset, &document.text) {
        CursorPosition::Header(before, _) => {
            let schemas = schema.table_schemas(&before);
            let tables = properties(&schemas).filter(|(_, property)| schema.is_table(property));
            tables.map(|(key, property)| item(key, CompletionItemKind::MODULE, schema.description(property))).collect()
        }
        CursorPosition::Key(table, before) => {
            let schemas = schema.table_schemas_of(table, &before, &document.text);
            let is_at_cursor = |bytes: &std::ops::Range<usize>| bytes.start <= offset && offset <= bytes.end;
            let is_taken = |key: &str| {
                table
                    .entries
                    .iter()
                    .any(|entry| entry.key.first().is_some_and(|first| first == key) && !is_at_cursor(&entry.key_bytes))
            };
            let unused = properties(&schemas).filter(|(key, _)| !before.is_empty() || !is_taken(key));
            let complete = |(key, property): (&String, &Json)| CompletionItem {
                detail: schema.kind_name(property),
                insert_text: Some(format!("{key} = ")),
                ..item(key, CompletionItemKind::PROPERTY, schema.description(property))
            };
            unused.map(complete).collect()
        }
        CursorPosition::Value(table, entry) => {
            let Some((key, before)) = entry.key.split_last() else { return Vec::new() };
            let schemas = schema.table_schemas_of(table, before, &document.text);
            let Some(property) = schemas.iter().find_map(|schema| schema["properties"].get(key)) else {
                return Vec::new();
            };
            let mut words = schema.words(property);
            if key == "kind" {
                // The kinds of all variants are offered, not only the written one.
                let path = [&table.path[..], before].concat();
                words = schema.table_schemas(&path).iter().flat_map(|schema| variant_of(schema)).collect();
            }
            let is_quoted = is_in_string(&document.text[..offset]);
            let quoted = |word: &str| if is_quoted { word.to_owned() } else { format!("\"{word}\"") };
            let words =
                words.iter().map(|(word, description)| item(&quoted(word), CompletionItemKind::VALUE, description));
            let mut items: Vec<CompletionItem> = words.collect();
            match schema.kind_name(property).as_deref() {
                Some("boolean") => {
                    items.extend(["true", "false"].map(|word| item(word, CompletionItemKind::VALUE, "")))
                }
                Some("string") if is_quoted && items.is_empty() => items = pages::files_at(document, offset, files),
                _ => {}
            }
            items
        }
    }
}

/// Returns true if the text ends within a string of its last line.
fn is_in_string(text: &str) -> bool {
    let line = text.lines().next_back().unwrap_or_default();
    let mut quote = None;
    for letter in line.chars().filter(|letter| ['"', '\''].contains(letter)) {
        quote = if quote == Some(letter) { None } else { quote.or(Some(letter)) };
    }
    !text.ends_with('\n') && quote.is_some()
}

/// The properties of several schemas, without duplicates.
fn properties<'s>(schemas: &[&'s Json]) -> impl Iterator<Item = (&'s String, &'s Json)> {
    let mut pairs: Vec<(&String, &Json)> =
        schemas.iter().filter_map(|schema| schema["properties"].as_object()).flatten().collect();
    pairs.sort_by_key(|(key, _)| key.as_str());
    pairs.dedup_by_key(|(key, _)| key.as_str());
    pairs.into_iter()
}

/// The value of `kind` of a variant, and the variant's description.
fn variant_of(schema: &Json) -> Option<(&str, &str)> {
    let kind = schema["properties"]["kind"]["const"].as_str()?;
    Some((kind, schema["description"].as_str().unwrap_or_default()))
}

/// JSON schema of a kind of file.
struct Schema(Json);

impl Schema {
    /// Schema of a scene, a suite, a noise profile or a companion.
    fn of(document: &Document) -> Option<Self> {
        let text = if sim_format::is_scene(&document.name, &document.text) {
            print::scene_schema()
        } else if suite::is_suite(&document.name, &document.text) {
            suite::suite_schema()
        } else if sim_format::is_noise(&document.name, &document.text) {
            print::noise_schema()
        } else {
            print::companion_schema()
        };
        serde_json::from_str(&text).ok().map(Self)
    }

    /// Schemas of the table at `path`, one for each variant.
    fn table_schemas(&self, path: &[String]) -> Vec<&Json> {
        path.iter().fold(vec![&self.0], |schemas, key| {
            let children = schemas.iter().filter_map(|schema| schema["properties"].get(key));
            children.flat_map(|property| self.table_schemas_below(property)).collect()
        })
    }

    /// Schemas of the table below `table` at the keys `before`. Without keys, and if `table` has a known `kind`, only
    /// those of this kind.
    fn table_schemas_of(&self, table: &Table, before: &[String], text: &str) -> Vec<&Json> {
        let mut schemas = self.table_schemas(&[&table.path[..], before].concat());
        if let Some(kind) = Outline::text_of(table, "kind", text).filter(|_| before.is_empty())
            && schemas.iter().any(|schema| variant_of(schema).is_some_and(|(known, _)| known == kind))
        {
            schemas.retain(|schema| variant_of(schema).is_none_or(|(known, _)| known == kind));
        }
        schemas
    }

    /// Schemas of all tables that a value of this schema can be, or can contain in an array.
    fn table_schemas_below<'s>(&'s self, schema: &'s Json) -> Vec<&'s Json> {
        let mut schemas: Vec<&Json> = Vec::new();
        self.visit(schema, &mut |part| {
            if part["properties"].is_object() {
                schemas.push(part);
            }
        });
        schemas
    }

    /// Returns true if a value can be a table, other than one that draws a value at random.
    fn is_table(&self, schema: &Json) -> bool {
        let random_schemas = self.table_schemas_below(&self.0["$defs"]["DrawForm"]);
        self.table_schemas_below(schema)
            .iter()
            .any(|schema| !random_schemas.iter().any(|random| std::ptr::eq(*random, *schema)))
    }

    /// Visits a schema's alternatives, following references and arrays.
    fn visit<'s>(&'s self, schema: &'s Json, visitor: &mut dyn FnMut(&'s Json)) {
        visitor(schema);
        if let Some(target) = self.target(schema) {
            self.visit(target, visitor);
        }
        for alternatives in [&schema["oneOf"], &schema["anyOf"]] {
            alternatives.as_array().into_iter().flatten().for_each(|part| self.visit(part, visitor));
        }
        if schema["items"].is_object() {
            self.visit(&schema["items"], visitor);
        }
    }

    fn target(&self, schema: &Json) -> Option<&Json> {
        self.0["$defs"].get(schema["$ref"].as_str()?.strip_prefix("#/$defs/")?)
    }

    fn description<'s>(&'s self, schema: &'s Json) -> &'s str {
        let description = schema["description"].as_str();
        description.or_else(|| self.target(schema)?["description"].as_str()).unwrap_or_default()
    }

    /// Words that the value can be, each with its description.
    fn words<'s>(&'s self, schema: &'s Json) -> Vec<(&'s str, &'s str)> {
        let mut words = Vec::new();
        self.visit(schema, &mut |part| {
            if let Some(word) = part["const"].as_str() {
                words.push((word, part["description"].as_str().unwrap_or_default()));
            }
            words.extend(part["enum"].as_array().into_iter().flatten().filter_map(|word| Some((word.as_str()?, ""))));
        });
        words
    }

    /// Type of the value: the first one in the schema that is not `null`, with its bounds.
    fn kind_name(&self, schema: &Json) -> Option<String> {
        let mut found = None;
        self.visit(schema, &mut |part| {
            let kinds = [&part["type"]].into_iter().chain(part["type"].as_array().into_iter().flatten());
            let kind = kinds.filter_map(Json::as_str).find(|kind| *kind != "null");
            if found.is_none()
                && let Some(kind) = kind
            {
                let bounds = [&part["minimum"], &part["maximum"]].map(|bound| bound.as_f64());
                found = Some(match bounds {
                    [Some(min), Some(max)] => format!("{kind}, {min} to {max}"),
                    _ => kind.to_owned(),
                });
            }
        });
        found
    }
}

#[cfg(test)]
mod tests {
    use super::super::documents::Encoding;
    use super::*;
    use sim_format::MemoryFiles;

    fn at_cursor(name: &str, text: &str) -> (Document, usize) {
        let offset = text.find('|').expect("a cursor");
        let text = text.replacen('|', "", 1);
        (Document { name: name.to_owned(), text, encoding: Encoding::Utf8 }, offset)
    }

    fn labels(name: &str, text: &str) -> Vec<String> {
        let (document, offset) = at_cursor(name, text);
        let files = MemoryFiles::from_iter([("/lab/a.wld", ""), ("/lab/drive.c", "")]);
        completions(&document, offset, &files).into_iter().map(|item| item.label).collect()
    }

    fn hovered(name: &str, text: &str) -> String {
        let (document, offset) = at_cursor(name, text);
        hover(&document, offset).unwrap_or_default()
    }

    const SCENE: &str = "/lab/a.scene.toml";

    #[test]
    fn keys_headers_words_and_files_complete() {
        let first = labels(SCENE, "|");
        assert!(
            ["scene", "world", "robot", "check"].iter().all(|key| first.iter().any(|label| label == key)),
            "{first:?}"
        );
        let headers = labels(SCENE, "[|]");
        assert!(
            headers.iter().any(|label| label == "robot") && !headers.iter().any(|label| label == "title"),
            "{headers:?}"
        );
        let world_tables = labels(SCENE, "[world.|]");
        assert!(
            world_tables.iter().any(|label| label == "light") && !world_tables.iter().any(|label| label == "floor_mm"),
            "{world_tables:?}"
        );
        let draws = labels(SCENE, "[[robot]]\nx_mm = { | }");
        assert!(draws.iter().any(|label| label == "uniform"), "{draws:?}");
        let robot = labels(SCENE, "[[robot]]\nx_mm = 1\n|");
        assert!(robot.iter().any(|key| key == "y_mm") && !robot.iter().any(|key| key == "x_mm"), "{robot:?}");
        let kinds = labels(SCENE, "[[check]]\nkind = \"|\"");
        assert!(kinds.iter().any(|kind| kind == "reach") && kinds.iter().any(|kind| kind == "laps"), "{kinds:?}");
        let reach_keys = labels(SCENE, "[[check]]\nkind = \"reach\"\n|");
        let contact_keys = labels(SCENE, "[[check]]\nkind = \"contacts\"\n|");
        assert!(
            reach_keys.iter().any(|key| key == "at_mm") && !contact_keys.iter().any(|key| key == "at_mm"),
            "{contact_keys:?}"
        );
        assert_eq!(labels(SCENE, "[world]\nfile = \"|\"\n"), ["a.wld", "drive.c"]);
        assert!(labels("/lab/x.suite.toml", "[matrix]\n|").iter().any(|key| key == "seed"));
        assert!(labels("/lab/x.noise.toml", "|").iter().any(|key| key == "base"));
        assert!(labels("/lab/S4.toml", "[[leg]]\n|").iter().any(|key| key == "thigh_mm"));
    }

    #[test]
    fn keys_are_explained() {
        assert!(hovered(SCENE, "[[ro|bot]]\n").contains("numbered 1, 2"), "{}", hovered(SCENE, "[[ro|bot]]\n"));
        assert!(hovered(SCENE, "[[check]]\nkind = \"reach\"\nby|_s = 3").contains("Simulated seconds"));
        assert!(hovered(SCENE, "[[check]]\nkind = \"reach\"\nby_s = 3|").contains("number"));
        assert_eq!(hovered(SCENE, "[[check]]\nnothing| = 3"), "");
    }
}
