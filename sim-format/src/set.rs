//! Settings: values that override values in the text of a scene in TOML, by the path of their keys.
//!
//! A path such as `robot[0].x_mm` consists of keys separated by dots, and indices of array entries from 0.

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use super::Span;
use super::code::Code;
use super::diagnostic::{Diagnostic, Severity};
use super::table::{Reader, SET};

/// A value that overrides one in the text of a scene in TOML.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Setting {
    path: String,
    value: String,
}

/// Error for a text that is not a setting.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingError {
    /// The text does not have the form `PATH=VALUE`.
    #[error("`{0}` is not a setting: expected `PATH=VALUE`, such as `robot[0].x_mm=500`")]
    Form(String),
    /// The path cannot be read.
    #[error("`{0}` is not a path: expected names of keys and indices of arrays, such as `robot[0].x_mm`")]
    Path(String),
    /// The value cannot be read.
    #[error("`{value}` is not a value of TOML: {error}; a text is written between quotes")]
    Value {
        /// The value.
        value: String,
        /// The mistake in the value.
        error: String,
    },
}

impl Setting {
    /// The setting of `path`, such as `robot[0].x_mm`, to `value`, in TOML syntax.
    ///
    /// # Errors
    /// Path or value cannot be read.
    pub fn new(path: &str, value: &str) -> Result<Self, SettingError> {
        steps(path).ok_or_else(|| SettingError::Path(path.to_owned()))?;
        let described = |error: toml::de::Error| error.message().trim().replace('\n', " ");
        DeValue::parse(value)
            .map_err(|error| SettingError::Value { value: value.to_owned(), error: described(error) })?;
        Ok(Self { path: path.to_owned(), value: value.to_owned() })
    }

    /// Parses `PATH=VALUE`.
    ///
    /// # Errors
    /// [`SettingError`].
    pub fn parse(text: &str) -> Result<Self, SettingError> {
        let (path, value) = text.split_once('=').ok_or_else(|| SettingError::Form(text.to_owned()))?;
        Self::new(path.trim(), value.trim())
    }
}

impl std::fmt::Display for Setting {
    /// Formats the setting in the syntax of the command line.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}={}", self.path, self.value)
    }
}

/// Step of a path: into a table, or into an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step<'p> {
    Key(&'p str),
    Index(usize),
}

/// Steps of a path, of which the first is a key.
fn steps(path: &str) -> Option<Vec<Step<'_>>> {
    let mut steps = Vec::new();
    for part in path.split('.') {
        let mut pieces = part.split('[');
        let name = pieces.next().filter(|name| !name.is_empty())?;
        let is_plain = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
        steps.push(is_plain.then_some(Step::Key(name))?);
        for index in pieces {
            steps.push(Step::Index(index.strip_suffix(']')?.parse().ok()?));
        }
    }
    Some(steps)
}

impl Reader {
    /// Writes the values of `settings` into the table of the whole text.
    pub(super) fn set<'t>(&mut self, root: &mut DeTable<'t>, settings: &'t [Setting]) {
        for setting in settings {
            let value = DeValue::parse(&setting.value).map(Spanned::into_inner).ok();
            let steps = steps(&setting.path);
            // Both are valid: settings were parsed when they were created.
            let (Some(value), Some(steps)) = (value, steps) else { continue };
            if let Some((Step::Key(first), rest)) = steps.split_first()
                && let Err(message) = set_in_table(root, first, rest, value)
            {
                let message = format!("`{setting}`: {message}");
                self.sink.error(Code::SetPath, Span::default(), message, "the path of a value of the scene");
            }
        }
    }
}

/// Sets the value at the path `key`, `rest` in `table`; adds missing tables.
fn set_in_table<'t>(
    table: &mut DeTable<'t>,
    key: &'t str,
    rest: &[Step<'t>],
    value: DeValue<'t>,
) -> Result<(), String> {
    let entry = table.iter_mut().find(|(known, _)| known.get_ref() == key).map(|(_, value)| value);
    match (entry, rest) {
        (Some(entry), _) => set_value(entry, key, rest, value),
        (None, []) => {
            table.insert(Spanned::new(SET, key.into()), Spanned::new(SET, without_location(value)));
            Ok(())
        }
        (None, [Step::Key(next), rest @ ..]) => {
            let mut subtable = DeTable::new();
            set_in_table(&mut subtable, next, rest, value)?;
            table.insert(Spanned::new(SET, key.into()), Spanned::new(SET, DeValue::Table(subtable)));
            Ok(())
        }
        (None, [Step::Index(_), ..]) => Err(format!("there is no `{key}`")),
    }
}

/// Sets the value at the path `rest` in `target`; `name` is the path of `target`, for messages.
fn set_value<'t>(
    target: &mut Spanned<DeValue<'t>>,
    name: &str,
    rest: &[Step<'t>],
    value: DeValue<'t>,
) -> Result<(), String> {
    let kind = target.get_ref().type_str();
    match (rest, target.get_mut()) {
        ([], old) => {
            *old = without_location(value);
            Ok(())
        }
        ([Step::Key(key), rest @ ..], DeValue::Table(table)) => set_in_table(table, key, rest, value),
        ([Step::Index(index), rest @ ..], DeValue::Array(items)) => {
            let count = items.len();
            let item = items.get_mut(*index);
            let item = item.ok_or_else(|| format!("`{name}` has {count} entries, counted from 0"))?;
            set_value(item, &format!("{name}[{index}]"), rest, value)
        }
        ([Step::Key(key), ..], _) => Err(format!("`{name}` is of type {kind} and has no `{key}`")),
        ([Step::Index(_), ..], _) => Err(format!("`{name}` is of type {kind} and has no entries")),
    }
}

/// Copy of a value in which all parts have the location [`SET`].
fn without_location(value: DeValue<'_>) -> DeValue<'_> {
    match value {
        DeValue::Array(items) => {
            let mut array = DeArray::new();
            items.iter().cloned().for_each(|item| array.push(Spanned::new(SET, without_location(item.into_inner()))));
            DeValue::Array(array)
        }
        DeValue::Table(table) => {
            let mut copy = DeTable::new();
            for (key, value) in table {
                copy.insert(
                    Spanned::new(SET, key.into_inner()),
                    Spanned::new(SET, without_location(value.into_inner())),
                );
            }
            DeValue::Table(copy)
        }
        other => other,
    }
}

/// Diagnostic for settings of a scene that is not in TOML.
pub(super) fn not_toml(file: &str) -> Diagnostic {
    let message = "settings by path are for scenes in TOML".to_owned();
    Diagnostic {
        severity: Severity::Error,
        code: Code::SetPath,
        file: file.to_owned(),
        span: Span::default(),
        message,
        expected: "a scene in TOML: `eyesim convert` makes one of a sim file".to_owned(),
        suggestion: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_keys_and_indices() {
        assert_eq!(steps("a.b[2].c"), Some(vec![Step::Key("a"), Step::Key("b"), Step::Index(2), Step::Key("c")]));
        for invalid in ["", ".", "a.", "[1]", "a[x]", "a[1", "a b", "a[-1]"] {
            assert_eq!(steps(invalid), None, "{invalid}");
        }
    }

    #[test]
    fn invalid_settings_are_rejected() {
        let error = |text: &str| Setting::parse(text).expect_err(text).to_string();
        assert!(error("robot").contains("expected `PATH=VALUE`"));
        assert!(error("robot[=1").contains("is not a path"));
        assert!(error("a=real").contains("a text is written between quotes"));
        assert_eq!(Setting::parse("a.b = [1, 2]").expect("a setting").to_string(), "a.b=[1, 2]");
    }

    /// Debug text of the table of `text` with `settings`, and the messages.
    fn apply(text: &str, settings: &[&str]) -> (String, Vec<String>) {
        let settings: Vec<Setting> = settings.iter().map(|text| Setting::parse(text).expect("a setting")).collect();
        let (mut reader, mut root) = Reader::parse("a.toml", text);
        reader.set(&mut root, &settings);
        let messages = reader.sink.finish().into_iter().map(|diagnostic| diagnostic.message).collect();
        (format!("{root:?}").replace("Cow", ""), messages)
    }

    #[test]
    fn values_are_replaced_and_added() {
        let text = "a = 1\n[[robot]]\nx = 2\n";
        let (root, messages) = apply(text, &["a='b'", "robot[0].x=7", "robot[0].y=[8]", "c.d=9"]);
        assert!(messages.is_empty(), "{messages:?}");
        for part in ["\"b\"", "\"7\"", "\"8\"", "\"9\"", "\"y\"", "\"d\""] {
            assert!(root.contains(part), "{part} in {root}");
        }
        assert!(!root.contains("\"2\""), "{root}");
    }

    #[test]
    fn missing_paths_are_reported() {
        let (_, messages) = apply("a = 1\nb = [1]\n", &["a.x=1", "b[1]=2", "c[0]=3", "a[0]=4"]);
        assert_eq!(
            messages,
            [
                "`a.x=1`: `a` is of type integer and has no `x`",
                "`b[1]=2`: `b` has 1 entries, counted from 0",
                "`c[0]=3`: there is no `c`",
                "`a[0]=4`: `a` is of type integer and has no entries",
            ]
        );
    }
}
