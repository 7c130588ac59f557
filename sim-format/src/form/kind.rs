//! Kinds of values, each with its reading, printing and schema.

use std::ops::RangeInclusive;

use serde_json::{Value as Json, json};
use toml::Value;

use super::{Definitions, Form, Keys, definition, print, print_non_defaults, reference};
use crate::line::Quantity;
use crate::print::number::in_unit;
use crate::spec::SpannedText;
use crate::table::{Reader, Section};

/// Context in which a value is read: reader, table and key.
pub(crate) struct ReadContext<'r, 's> {
    pub(crate) reader: &'r mut Reader,
    pub(crate) section: &'r mut Section<'s, 's>,
    pub(crate) key: &'static str,
}

/// Kind of the value of a key.
pub(crate) trait Kind<T> {
    /// Reads the value; `None` if it is missing or invalid. The keys of a table replace those of the `old` value.
    fn read(&self, context: ReadContext<'_, '_>, old: Option<&T>) -> Option<T>;

    /// Prints the value.
    fn print(&self, value: &T) -> Value;

    /// Schema of the value.
    fn describe(&self, definitions: &mut Definitions) -> Json;
}

/// Kind that three functions define.
pub(crate) struct Custom<T> {
    pub(crate) read: fn(ReadContext<'_, '_>) -> Option<T>,
    pub(crate) print: fn(&T) -> Value,
    pub(crate) describe: fn(&mut Definitions) -> Json,
}

impl<T> Kind<T> for Custom<T> {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&T>) -> Option<T> {
        (self.read)(context)
    }

    fn print(&self, value: &T) -> Value {
        (self.print)(value)
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        (self.describe)(definitions)
    }
}

/// A number with a unit.
impl Kind<f64> for Quantity {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&f64>) -> Option<f64> {
        context.reader.number(context.section, context.key, self)
    }

    fn print(&self, value: &f64) -> Value {
        in_unit(self, *value).into()
    }

    fn describe(&self, _: &mut Definitions) -> Json {
        json!({ "type": "number", "format": "double" })
    }
}

/// Number with a unit whose bounds appear in the schema.
pub(crate) struct Bounded(pub(crate) Quantity);

impl Kind<f64> for Bounded {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&f64>) -> Option<f64> {
        context.reader.number(context.section, context.key, &self.0)
    }

    fn print(&self, value: &f64) -> Value {
        self.0.print(value)
    }

    fn describe(&self, _: &mut Definitions) -> Json {
        let [minimum, maximum] = self.0.bounds();
        json!({ "type": "number", "format": "double", "minimum": minimum, "maximum": maximum })
    }
}

/// A point, or another fixed number of quantities.
impl<P: Copy + From<[f64; N]> + Into<[f64; N]>, const N: usize> Kind<P> for [Quantity; N] {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&P>) -> Option<P> {
        context.reader.numbers(context.section, context.key, self).map(P::from)
    }

    fn print(&self, point: &P) -> Value {
        let numbers = self.iter().zip((*point).into());
        Value::Array(numbers.map(|(quantity, number)| quantity.print(&number)).collect())
    }

    fn describe(&self, _: &mut Definitions) -> Json {
        array_schema(json!({ "type": "number", "format": "double" }), N)
    }
}

/// Schema of an array of `length` items.
pub(crate) fn array_schema(items: Json, length: usize) -> Json {
    json!({ "type": "array", "items": items, "minItems": length, "maxItems": length })
}

/// Non-empty string; the field describes it in messages.
#[derive(Clone, Copy)]
pub(crate) struct Text(&'static str);

pub(crate) const TEXT: Text = Text("a text that is not empty, between double quotes");
pub(crate) const IMAGE: Text = Text("the name of an image file, between double quotes");

impl Kind<String> for Text {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&String>) -> Option<String> {
        context.reader.text_of(context.section, context.key, self.0)
    }

    fn print(&self, value: &String) -> Value {
        value.as_str().into()
    }

    fn describe(&self, _: &mut Definitions) -> Json {
        json!({ "type": "string" })
    }
}

/// Name, or reference to a file, with its location.
impl Kind<SpannedText> for Text {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&SpannedText>) -> Option<SpannedText> {
        context.reader.reference_to(context.section, context.key, self.0)
    }

    fn print(&self, value: &SpannedText) -> Value {
        value.text.as_str().into()
    }

    fn describe(&self, _: &mut Definitions) -> Json {
        json!({ "type": "string" })
    }
}

/// `true` or `false`.
pub(crate) struct Flag;

impl Kind<bool> for Flag {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&bool>) -> Option<bool> {
        context.reader.flag(context.section, context.key)
    }

    fn print(&self, value: &bool) -> Value {
        (*value).into()
    }

    fn describe(&self, _: &mut Definitions) -> Json {
        json!({ "type": "boolean" })
    }
}

/// Integer type.
pub(crate) trait Integer: Copy + TryFrom<i64> {
    /// Name of the type in the schema.
    const FORMAT: &'static str;
    /// Minimum and maximum of the type, as far as the schema states them.
    const LIMITS: [Option<i64>; 2];
    /// The value as `i64`.
    fn number(self) -> i64;
}

macro_rules! impl_integer {
    ($($number:ty, $format:literal, $limits:expr;)+) => {
        $(impl Integer for $number {
            const FORMAT: &'static str = $format;
            const LIMITS: [Option<i64>; 2] = $limits;
            fn number(self) -> i64 {
                self as i64
            }
        })+
    };
}

impl_integer! {
    u8, "uint8", [Some(0), Some(255)];
    u16, "uint16", [Some(0), Some(65_535)];
    u32, "uint32", [Some(0), None];
    u64, "uint64", [Some(0), None];
    i32, "int32", [None; 2];
}

/// Schema of all values of an integer type.
pub(crate) fn integer_schema<T: Integer>() -> Json {
    let mut schema = json!({ "type": "integer", "format": T::FORMAT });
    for (name, limit) in ["minimum", "maximum"].into_iter().zip(T::LIMITS) {
        limit.into_iter().for_each(|limit| schema[name] = limit.into());
    }
    schema
}

/// Integer within bounds.
impl<T: Integer> Kind<T> for RangeInclusive<i64> {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&T>) -> Option<T> {
        context
            .reader
            .integer(context.section, context.key, *self.start(), *self.end())
            .and_then(|number| T::try_from(number).ok())
    }

    fn print(&self, value: &T) -> Value {
        value.number().into()
    }

    fn describe(&self, _: &mut Definitions) -> Json {
        let mut schema = integer_schema::<T>();
        (schema["minimum"], schema["maximum"]) = ((*self.start()).into(), (*self.end()).into());
        schema
    }
}

/// Integer within bounds that do not appear in the schema.
pub(crate) struct HiddenBounds(pub(crate) RangeInclusive<i64>);

impl<T: Integer> Kind<T> for HiddenBounds {
    fn read(&self, context: ReadContext<'_, '_>, old: Option<&T>) -> Option<T> {
        self.0.read(context, old)
    }

    fn print(&self, value: &T) -> Value {
        self.0.print(value)
    }

    fn describe(&self, _: &mut Definitions) -> Json {
        integer_schema::<T>()
    }
}

/// Colour channels, 0 to 255.
pub(crate) struct Channels;

impl<const N: usize> Kind<[u8; N]> for Channels {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&[u8; N]>) -> Option<[u8; N]> {
        context.reader.shades(context.section, context.key)
    }

    fn print(&self, value: &[u8; N]) -> Value {
        Value::Array(value.iter().map(|shade| i64::from(*shade).into()).collect())
    }

    fn describe(&self, _: &mut Definitions) -> Json {
        array_schema(integer_schema::<u8>(), N)
    }
}

/// Enumeration whose values are written as words in files.
pub(crate) trait Words: Copy + PartialEq + 'static {
    /// Name of the enumeration in the JSON schema.
    const NAME: &'static str;
    /// Description of the enumeration, one sentence.
    const ABOUT: &'static str;
    /// Each value with its word and its description.
    const WORDS: &'static [(Self, &'static str, &'static str)];
}

/// Value of an enumeration, written as its word.
pub(crate) struct Word;

impl<W: Words> Kind<W> for Word {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&W>) -> Option<W> {
        let words: Vec<&str> = W::WORDS.iter().map(|(_, word, _)| *word).collect();
        context.reader.choice(context.section, context.key, &words).map(|index| W::WORDS[index].0)
    }

    fn print(&self, value: &W) -> Value {
        let word = W::WORDS.iter().find(|(known, ..)| known == value);
        word.map_or("", |(_, word, _)| *word).into()
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        definition(definitions, W::NAME, |_| {
            let word =
                |(_, word, about): &(W, &str, &str)| json!({ "description": about, "type": "string", "const": word });
            json!({ "description": W::ABOUT, "oneOf": W::WORDS.iter().map(word).collect::<Vec<_>>() })
        })
    }
}

/// Table; the field is an example of its content for messages, or empty.
pub(crate) struct TableWithExample(pub(crate) &'static str);

pub(crate) const TABLE: TableWithExample = TableWithExample("");

impl<F: Form> Kind<F> for TableWithExample {
    fn read(&self, context: ReadContext<'_, '_>, old: Option<&F>) -> Option<F> {
        let part = context.reader.section_like(context.section, context.key, self.0)?;
        context.reader.form(part, old.cloned().unwrap_or_else(F::defaults))
    }

    fn print(&self, value: &F) -> Value {
        print(value).into()
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        reference(definitions, |keys| F::defaults().keys(keys))
    }
}

/// Table with some properties of a spec; the function declares its keys.
pub(crate) struct PartialTable<T>(pub(crate) fn(&mut T, &mut Keys<'_>));

impl<T: Clone + Default> Kind<T> for PartialTable<T> {
    fn read(&self, context: ReadContext<'_, '_>, old: Option<&T>) -> Option<T> {
        let part = context.reader.section(context.section, context.key)?;
        let mut spec = old.cloned().unwrap_or_default();
        context.reader.table(part, |keys| (self.0)(&mut spec, keys)).then_some(spec)
    }

    fn print(&self, spec: &T) -> Value {
        print_non_defaults(|keys| (self.0)(&mut spec.clone(), keys), |keys| (self.0)(&mut T::default(), keys)).into()
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        reference(definitions, |keys| (self.0)(&mut T::default(), keys))
    }
}

/// Array of at most this many tables; further and incomplete tables are dropped.
pub(crate) struct TablesUpTo(pub(crate) usize);

pub(crate) const TABLES: TablesUpTo = TablesUpTo(usize::MAX);

impl<F: Form> Kind<Vec<F>> for TablesUpTo {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&Vec<F>>) -> Option<Vec<F>> {
        let parts = context.reader.sections(context.section, context.key).into_iter().take(self.0);
        Some(parts.filter_map(|part| context.reader.form(part, F::defaults())).collect())
    }

    fn print(&self, values: &Vec<F>) -> Value {
        Value::Array(values.iter().map(|value| print(value).into()).collect())
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        json!({ "type": "array", "items": Kind::<F>::describe(&TABLE, definitions) })
    }
}
