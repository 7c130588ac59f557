//! Layout of TOML for human readers.

use std::fmt::Write;

use toml::{Table, Value};

use super::number::written;

/// Maximum length of a line that is not broken.
const WIDTH: usize = 110;

/// Text of a document: a section `[key]` for each table of the root, and `[[key]]` for each item of an array of tables
/// in the root; deeper tables are inline.
pub(crate) fn document(root: &Table) -> String {
    let mut out = String::new();
    for (key, value) in root {
        match value {
            Value::Table(table) => section(&mut out, &format!("[{}]", key_text(key)), table),
            Value::Array(items) if items.iter().all(Value::is_table) => {
                let header = format!("[[{}]]", key_text(key));
                items.iter().filter_map(Value::as_table).for_each(|table| section(&mut out, &header, table));
            }
            value => key_line(&mut out, key, value),
        }
    }
    out
}

fn section(out: &mut String, header: &str, table: &Table) {
    if !out.is_empty() {
        out.push('\n');
    }
    out.push_str(header);
    out.push('\n');
    table.iter().for_each(|(key, value)| key_line(out, key, value));
}

fn key_line(out: &mut String, key: &str, value: &Value) {
    let key = key_text(key);
    let text = inline(value);
    match value {
        Value::String(text) if text.contains('\n') => {
            let _ = writeln!(out, "{key} = {}", multi_line(text));
        }
        Value::Array(items)
            if key.len() + text.len() + 3 > WIDTH || items.len() > 1 && items.iter().all(Value::is_table) =>
        {
            let _ = writeln!(out, "{key} = [");
            items.iter().for_each(|item| {
                let _ = writeln!(out, "    {},", inline(item));
            });
            out.push_str("]\n");
        }
        _ => {
            let _ = writeln!(out, "{key} = {text}");
        }
    }
}

fn inline(value: &Value) -> String {
    match value {
        Value::String(text) => quoted(text),
        Value::Integer(number) => number.to_string(),
        Value::Float(number) => written(*number),
        Value::Boolean(flag) => flag.to_string(),
        Value::Datetime(time) => time.to_string(),
        Value::Array(items) => format!("[{}]", items.iter().map(inline).collect::<Vec<_>>().join(", ")),
        Value::Table(table) if table.is_empty() => "{}".to_owned(),
        Value::Table(table) => {
            let entries: Vec<String> =
                table.iter().map(|(key, value)| format!("{} = {}", key_text(key), inline(value))).collect();
            format!("{{ {} }}", entries.join(", "))
        }
    }
}

fn key_text(key: &str) -> String {
    let is_bare = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'));
    if is_bare { key.to_owned() } else { quoted(key) }
}

/// Quotes a string, with control characters as escapes.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for character in text.chars() {
        match character {
            '"' | '\\' => {
                out.push('\\');
                out.push(character);
            }
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            '\r' => out.push_str("\\r"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// Multi-line string, unescaped if possible.
fn multi_line(text: &str) -> String {
    let is_plain = text.chars().all(|c| !c.is_control() || matches!(c, '\n' | '\t'));
    if is_plain && !text.contains("'''") && !text.ends_with('\'') { format!("'''\n{text}'''") } else { quoted(text) }
}
