//! Suites: settings of all cases, the matrix, limits.

use std::collections::BTreeMap;

use serde_json::json;
use toml::de::DeValue;
use toml::{Spanned, Table, Value};

use super::kind::{Bounded, Custom, PartialTable, ReadContext, TABLE, TABLES, TEXT};
use super::scene::UNTIL;
use super::{Form, Keys};
use crate::code::Code;
use crate::line::Quantity;
use crate::set::Setting;
use crate::spec::SpannedText;
use crate::suite::{LimitSpec, MAX_CASES, Matrix, SubmitSpec, SuiteSpec, Values};
use crate::table::Reader;
use sim_core::time::Time;

/// Upper bound of the limits of processor time: a day, in seconds.
const MAX_PROCESSOR_S: f64 = 86_400.0;
/// Upper bound of the limits of memory and output, megabytes.
const MAX_MEGABYTES: f64 = 1e6;
const LINGER_TIME: Bounded = Bounded(Quantity::seconds("time").within(0.0, 1e9));

impl Form for SuiteSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("SuiteForm", "A suite of eyesim: a scene, and the cases in which it is run and judged.");
        keys.key("suite", "Settings of all cases.").required(PartialTable(common_keys), self);
        keys.key("matrix", "Lists of values; the cases are their combinations.").optional(TABLE, &mut self.matrix);
        keys.key("limits", "Limits of each case.").optional(TABLE, &mut self.limits);
        keys.key("check", "Conditions that a case must meet, in addition to those of the scene.")
            .list(TABLES, &mut self.checks);
    }
}

/// Declares the keys of `[suite]`.
fn common_keys(suite: &mut SuiteSpec, keys: &mut Keys<'_>) {
    keys.form("CommonForm", "Settings of all cases of a suite.");
    keys.key("scene", "The scene, relative to the suite's folder; optional only if the matrix has scenes.")
        .nullable(TEXT, &mut suite.scene);
    keys.key(
        "programs",
        "Programs of robots instead of the scene's: `1=solve.c`, or `solve.c` for robots without one.",
    )
    .list(REFERENCES, &mut suite.programs);
    keys.key("forbid", "RoBIOS functions that fail for all programs, in addition to those of the scene: names, in which `*` stands for any letters.")
        .list(REFERENCES, &mut suite.forbid);
    keys.key(
        "submit",
        "Files of a submission that become programs in `eyesim grade`: `{ 1 = [\"*.c\", \"*.cpp\"] }` for robot 1.",
    )
    .list(SUBMIT, &mut suite.submit);
    keys.key("until_s", "Simulated seconds at which a case ends; default: from the scene.")
        .nullable(UNTIL, &mut suite.until);
    let mut linger = suite.linger.seconds();
    keys.key("linger_s", "Simulated seconds for which a case continues after its last program has ended; default: 0.")
        .optional(LINGER_TIME, &mut linger);
    suite.linger = Time::from_seconds_ceil(linger);
    keys.key("keys", "Keys and touches: `2.5:KEY1`, `3:TOUCH(60,40)`, for robot 2 `2:2.5:KEY1`.")
        .list(TEXTS, &mut suite.keys);
    keys.key(
        "arguments",
        "Arguments of programs: `--kp {kp}`, for robot 1 `1:--kp {kp}`; `{kp}` is a parameter of the matrix.",
    )
    .list(TEXTS, &mut suite.arguments);
    keys.key("stdin", "File with the standard input of the programs.").nullable(TEXT, &mut suite.stdin);
    keys.key("pass_rate", "Fraction of seeds that must pass, 0 to 1; default: 1.")
        .optional(Bounded(Quantity::number("pass_rate", 0.0, 1.0)), &mut suite.pass_rate);
}

impl Form for LimitSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("LimitsForm", "Limits of each case of a suite.");
        let processor = |name| Bounded(Quantity::seconds(name).within(1e-3, MAX_PROCESSOR_S));
        keys.key("slot_processor_s", "Processor seconds that a program may compute within one slot; default: 10.")
            .optional(processor("processor time"), &mut self.slot_processor);
        keys.key("processor_s", "Processor seconds of a whole case; default: 60.")
            .optional(processor("processor time"), &mut self.processor);
        let megabytes = |name, min| Bounded(Quantity::number(name, min, MAX_MEGABYTES));
        let mut memory = self.memory.map(|bytes| bytes as f64 / 1e6);
        keys.key("memory_mb", "Megabytes of memory of a case; each case then runs in its own process.")
            .nullable(megabytes("memory", 64.0), &mut memory);
        self.memory = memory.map(|megabytes| (megabytes * 1e6).round() as u64);
        let mut output = self.output as f64 / 1e6;
        keys.key("output_mb", "Megabytes that each program may print; further output is discarded; default: 10.")
            .optional(megabytes("output", 0.0), &mut output);
        self.output = (output * 1e6).round() as u64;
    }
}

impl Form for Matrix {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form(
            "MatrixForm",
            "Lists of values; the cases are their combinations; the values of the last list vary fastest.",
        );
        keys.span(&mut self.span);
        keys.key("scene", "Scenes, instead of the suite's scene.").list(TEXTS, &mut self.scene);
        keys.key("world", "Files of worlds, instead of the scene's world.").list(TEXTS, &mut self.world);
        keys.key("set", "Values of the scene by the path of their keys: `\"robot[0].x_mm\" = [500, 900]`.")
            .list(VALUES_OF_SCENE, &mut self.set);
        keys.key("parameter", "Values for `{NAME}` in the arguments of programs.").list(VALUES, &mut self.parameter);
        keys.key("noise", "Noise profiles: presets or files.").list(TEXTS, &mut self.noise);
        keys.key("slot_ms", "Lengths of slots in ms.").list(SLOTS, &mut self.slot);
        keys.key("seed", "Seeds: numbers and ranges such as `\"1..20\"`, both ends included.")
            .list(SEEDS, &mut self.seed);
        keys.key("zip", "Names of lists that advance together: `[[\"world\", \"noise\"]]`.").list(ZIP, &mut self.zip);
        keys.key("exclude", "Combinations to omit: `[{ seed = 3, noise = \"real\" }]`.")
            .list(EXCLUDE, &mut self.exclude);
    }
}

/// Array of non-empty texts; a single text is read as an array.
pub(super) const TEXTS: Custom<Vec<String>> = Custom {
    read: |ReadContext { reader, section, key }| {
        let value = section.get(key)?;
        Some(items(value).iter().filter_map(|item| reader.plain_text(key, item)).collect())
    },
    print: |texts| Value::Array(texts.iter().map(|text| text.as_str().into()).collect()),
    describe: |_| one_or_array_schema(json!({ "type": "string" })),
};

/// Array of texts with their locations in the file; a single text is read as an array.
pub(super) const REFERENCES: Custom<Vec<SpannedText>> = Custom {
    read: |ReadContext { reader, section, key }| {
        let value = section.get(key)?;
        let reference = |item: &Spanned<DeValue<'_>>| {
            let text = reader.plain_text(key, item)?;
            Some(SpannedText { text, span: reader.span(item.span()) })
        };
        Some(items(value).iter().filter_map(reference).collect())
    },
    print: |references| Value::Array(references.iter().map(|reference| reference.text.as_str().into()).collect()),
    describe: TEXTS.describe,
};

/// Table of the file patterns of each robot.
const SUBMIT: Custom<Vec<SubmitSpec>> = Custom {
    read: |ReadContext { reader, section, key }| {
        let table = reader.section(section, key)?;
        let mut submit = Vec::new();
        for (name, value) in table.table {
            let (span, robots) = (reader.span(name.span()), name.get_ref().trim().to_owned());
            let patterns: Vec<String> = items(value).iter().filter_map(|item| reader.plain_text(key, item)).collect();
            if patterns.is_empty() || robots.is_empty() {
                let message = format!("`{}` names no files", name.get_ref());
                reader.sink.error(
                    Code::TomlMissing,
                    span,
                    message,
                    "a robot with patterns: `1 = [\"*.c\", \"*.cpp\"]`",
                );
            }
            submit.push(SubmitSpec { robots, patterns, span });
        }
        Some(submit)
    },
    print: |submit| {
        let patterns =
            |submit: &SubmitSpec| Value::Array(submit.patterns.iter().map(|text| text.as_str().into()).collect());
        Value::Table(submit.iter().map(|submit| (submit.robots.clone(), patterns(submit))).collect())
    },
    describe: |_| json!({ "type": "object", "additionalProperties": one_or_array_schema(json!({ "type": "string" })) }),
};

/// Array of lengths of slots in milliseconds, kept as texts.
const SLOTS: Custom<Vec<String>> = Custom {
    read: |ReadContext { reader, section, key }| {
        let value = section.get(key)?;
        let slot = |item: &Spanned<DeValue<'_>>| {
            let quantity = Quantity::number("length of a slot", 1e-3, 3.6e6);
            reader.as_number(key, item, &quantity).map(|milliseconds| milliseconds.to_string())
        };
        Some(items(value).iter().filter_map(slot).collect())
    },
    print: |slots| Value::Array(slots.iter().map(|slot| slot.parse::<f64>().unwrap_or_default().into()).collect()),
    describe: |_| one_or_array_schema(json!({ "type": "number" })),
};

/// Array of seeds and of ranges of seeds.
const SEEDS: Custom<Vec<u64>> = Custom {
    read: |ReadContext { reader, section, key }| {
        let value = section.get(key)?;
        let mut seeds: Vec<u64> = Vec::new();
        for item in items(value) {
            match item.get_ref().as_str() {
                Some(text) => match seed_range(text) {
                    Some((first, last)) if first > last => {
                        let message = format!("the range `{text}` runs backwards");
                        let span = reader.span(item.span());
                        reader.sink.error(Code::NumberRange, span, message, format!("\"{last}..{first}\""));
                        return None;
                    }
                    Some((first, last)) if last - first < MAX_CASES => seeds.extend(first..=last),
                    Some((first, last)) => {
                        let message = format!("`{text}` has {} seeds", u128::from(last - first) + 1);
                        let span = reader.span(item.span());
                        reader.sink.error(Code::SuiteCases, span, message, format!("at most {MAX_CASES}"));
                        return None;
                    }
                    None => {
                        let message = format!("`{text}` is not a range of seeds");
                        let span = reader.span(item.span());
                        reader.sink.error(Code::TomlType, span, message, "a number, or a range such as \"1..20\"");
                    }
                },
                None => seeds.extend(reader.as_integer(key, item, 0, i64::MAX).map(i64::unsigned_abs)),
            }
        }
        let mut sorted = seeds.clone();
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            let span = reader.value_span(section, key);
            reader.sink.error(Code::TomlConflict, span, format!("seed {} is listed twice", pair[0]), "each seed once");
            return None;
        }
        Some(seeds)
    },
    print: |seeds| {
        let is_range = seeds.len() > 2 && seeds.windows(2).all(|pair| pair[0] + 1 == pair[1]);
        match (is_range, seeds.first(), seeds.last()) {
            (true, Some(first), Some(last)) => format!("{first}..{last}").into(),
            _ => Value::Array(seeds.iter().map(|seed| (*seed as i64).into()).collect()),
        }
    },
    describe: |_| one_or_array_schema(json!({ "type": ["integer", "string"] })),
};

/// First and last seed of a range such as `1..20`.
fn seed_range(text: &str) -> Option<(u64, u64)> {
    let (first, last) = text.split_once("..")?;
    let [first, last] = [first, last].map(|number| number.trim().parse::<u64>().ok());
    first.zip(last).filter(|(first, last)| *first.max(last) <= i64::MAX as u64)
}

/// Table of lists of values, by name.
const VALUES: Custom<Vec<Values>> = Custom {
    read: |ReadContext { reader, section, key }| {
        let table = reader.section(section, key)?;
        let mut lists = Vec::new();
        for (name, value) in table.table {
            let values = items(value).iter().map(|item| reader.text_in_file(item)).collect::<Vec<_>>();
            let span = reader.span(name.span());
            if values.is_empty() {
                reader.sink.error(Code::TomlMissing, span, format!("`{}` has no values", name.get_ref()), "a value");
            }
            lists.push(Values { name: name.get_ref().to_string(), values, span });
        }
        Some(lists)
    },
    print: |lists| {
        let value = |text: &String| {
            let parsed = toml::from_str::<Table>(&format!("v = {text}")).ok();
            parsed.and_then(|mut table| table.remove("v")).unwrap_or_else(|| text.as_str().into())
        };
        let list = |list: &Values| (list.name.clone(), Value::Array(list.values.iter().map(value).collect()));
        Value::Table(lists.iter().map(list).collect())
    },
    describe: |_| json!({ "type": "object", "additionalProperties": true }),
};

/// Table of lists of values of a scene, by the path of the value.
const VALUES_OF_SCENE: Custom<Vec<Values>> = Custom {
    read: |ReadContext { reader, section, key }| {
        let lists = (VALUES.read)(ReadContext { reader: &mut *reader, section, key })?;
        for list in &lists {
            let error = list.values.iter().find_map(|value| Setting::new(&list.name, value).err());
            if let Some(error) = error {
                let expected = "the path of a value in the scene, such as \"robot[0].x_mm\", and values of TOML";
                reader.sink.error(Code::SetPath, list.span, error.to_string(), expected);
            }
        }
        Some(lists)
    },
    print: VALUES.print,
    describe: VALUES.describe,
};

/// Array of arrays of names; a single array needs no outer array.
const ZIP: Custom<Vec<Vec<String>>> = Custom {
    read: |ReadContext { reader, section, key }| {
        let value = section.get(key)?;
        let is_nested = items(value).iter().all(|item| matches!(item.get_ref(), DeValue::Array(_)));
        let groups = if is_nested { items(value) } else { std::slice::from_ref(value) };
        let mut zip = Vec::new();
        for group in groups {
            zip.push(items(group).iter().filter_map(|item| reader.plain_text(key, item)).collect());
        }
        Some(zip)
    },
    print: |zip| {
        let names = |names: &Vec<String>| Value::Array(names.iter().map(|name| name.as_str().into()).collect());
        Value::Array(zip.iter().map(names).collect())
    },
    describe: |_| {
        let names = json!({ "type": "array", "items": { "type": "string" } });
        json!({ "type": "array", "items": { "anyOf": [{ "type": "string" }, names] } })
    },
};

/// Array of combinations: tables of values by the names of lists.
const EXCLUDE: Custom<Vec<BTreeMap<String, String>>> = Custom {
    read: |ReadContext { reader, section, key }| {
        let mut exclude = Vec::new();
        for part in reader.sections(section, key) {
            let entry = |(name, value): (&Spanned<_>, &Spanned<DeValue<'_>>)| {
                let text = value.get_ref().as_str().map_or_else(|| reader.text_in_file(value), str::to_owned);
                (ToString::to_string(name.get_ref() as &std::borrow::Cow<'_, str>), text)
            };
            let combination: BTreeMap<String, String> = part.table.iter().map(entry).collect();
            if combination.is_empty() {
                let expected = "names of lists with a value of each";
                reader.sink.error(Code::TomlMissing, part.span, "`exclude` has a table without values", expected);
                continue;
            }
            exclude.push(combination);
        }
        Some(exclude)
    },
    print: |exclude| {
        let value = |text: &String| match text.parse::<i64>() {
            Ok(number) => number.into(),
            Err(_) => text.as_str().into(),
        };
        let table = |combination: &BTreeMap<String, String>| {
            Value::Table(combination.iter().map(|(name, text)| (name.clone(), value(text))).collect())
        };
        Value::Array(exclude.iter().map(table).collect())
    },
    describe: |_| json!({ "type": "array", "items": { "type": "object" } }),
};

/// Items of an array, or the value itself.
fn items<'v, 'i>(value: &'v Spanned<DeValue<'i>>) -> &'v [Spanned<DeValue<'i>>] {
    match value.get_ref() {
        DeValue::Array(items) => items,
        _ => std::slice::from_ref(value),
    }
}

/// Schema of an item, or of an array of such items.
fn one_or_array_schema(item: serde_json::Value) -> serde_json::Value {
    json!({ "anyOf": [item, { "type": "array", "items": item }] })
}

impl Reader {
    /// Reads a non-empty text; reports anything else.
    fn plain_text(&mut self, key: &str, item: &Spanned<DeValue<'_>>) -> Option<String> {
        let text = item.get_ref().as_str().filter(|text| !text.trim().is_empty());
        if text.is_none() {
            self.wrong_type(key, item, "a text that is not empty, between double quotes");
        }
        text.map(str::to_owned)
    }

    /// A value as written in the file.
    fn text_in_file(&self, item: &Spanned<DeValue<'_>>) -> String {
        self.text.get(item.span()).unwrap_or_default().trim().to_owned()
    }
}
