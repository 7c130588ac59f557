//! Lookup of the report's numbers by path, such as `robots[0].path_m`.

use serde_json::Value;

use super::Verdict;

/// Judges the number at `path` of `report`: it must be within `limits`. With `partial`, the limits are ignored; the
/// fraction of the points is interpolated between the number for all points and the number for none.
pub(super) fn judge(report: &Value, path: &str, limits: [Option<f64>; 2], partial: Option<(f64, f64)>) -> Verdict {
    let number = match find(report, path).and_then(|value| number(value, path)) {
        Ok(number) => number,
        Err(message) => return Verdict::new(false, message),
    };
    let [min, max] = limits;
    let (fraction, message) = match partial {
        Some((full, zero)) => {
            let fraction = ((number - zero) / (full - zero)).clamp(0.0, 1.0);
            (fraction, format!("{}; all points for {full}, none for {zero}", short(number)))
        }
        None if min.is_some_and(|min| number < min) => {
            (0.0, format!("{} is less than {}", short(number), min.unwrap_or_default()))
        }
        None if max.is_some_and(|max| number > max) => {
            (0.0, format!("{} is more than {}", short(number), max.unwrap_or_default()))
        }
        None => (1.0, short(number)),
    };
    Verdict { fraction, value: Some(number), ..Verdict::new(fraction >= 1.0, message) }
}

/// Returns the value at a path: field names separated by dots, with indices from 0 in brackets.
fn find<'v>(report: &'v Value, path: &str) -> Result<&'v Value, String> {
    let (mut value, mut found_path) = (report, String::new());
    for part in path.split('.') {
        // A program prints its metrics itself, so a check must not depend on them.
        if part == "metrics" && found_path.starts_with("robots") {
            return Err(format!("`{path}`: checks cannot use metrics that the program itself prints"));
        }
        let (name, mut indices) = part.split_once('[').map_or((part, ""), |(name, rest)| (name, rest));
        let fields = value.as_object().map(|fields| fields.keys().map(String::as_str).collect::<Vec<_>>());
        let Some(next) = value.get(name) else {
            let parent = if found_path.is_empty() { "the report".to_owned() } else { format!("`{found_path}`") };
            return Err(match fields {
                Some(fields) => format!("{parent} has no `{name}`; it has {}", fields.join(", ")),
                None => format!("{parent} has no parts"),
            });
        };
        value = next;
        found_path.push_str(if found_path.is_empty() { "" } else { "." });
        found_path.push_str(name);
        while !indices.is_empty() {
            let (index, rest) = indices.split_once(']').ok_or_else(|| format!("`{path}` has no `]`"))?;
            let Ok(index) = index.trim().parse::<usize>() else {
                return Err(format!("`{index}` in `{path}` is not an index from 0"));
            };
            let count = value.as_array().map(Vec::len);
            value = value.get(index).ok_or_else(|| match count {
                Some(count) => format!("`{found_path}` has {count} entries, counted from 0"),
                None => format!("`{found_path}` is not a list"),
            })?;
            found_path.push_str(&format!("[{index}]"));
            indices = match rest.strip_prefix('[') {
                Some(rest) => rest,
                None if rest.is_empty() => "",
                None => return Err(format!("`{path}`: expected `.` or `[` after `{found_path}`")),
            };
        }
    }
    Ok(value)
}

/// Returns a number; true and false become 1 and 0.
fn number(value: &Value, path: &str) -> Result<f64, String> {
    match value {
        Value::Number(number) => number.as_f64().ok_or_else(|| format!("`{path}` is too large")),
        Value::Bool(flag) => Ok(f64::from(u8::from(*flag))),
        Value::Null => Err(format!("`{path}` has no value in this run")),
        Value::String(text) => Err(format!("`{path}` is the text `{text}`, not a number")),
        Value::Array(_) | Value::Object(_) => Err(format!("`{path}` is a list or an object, not a number")),
    }
}

/// Formats a number with at most six decimals; very small and very large numbers keep all digits.
fn short(number: f64) -> String {
    let rounded = format!("{number:.6}");
    let trimmed = rounded.trim_end_matches('0').trim_end_matches('.');
    if number.abs() < 1e-3 && number != 0.0 || number.abs() > 1e9 { number.to_string() } else { trimmed.to_owned() }
}
