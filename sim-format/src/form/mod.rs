//! Forms: schemas of the tables in our own TOML files.
//!
//! Each key is declared once, with its name, its meaning, the kind of its values and its default. Three passes use the
//! declarations: one reads a table, one prints it, and one describes it in the JSON schema. [`kind`] defines the kinds
//! of values.

pub(crate) mod check;
pub(crate) mod device;
pub(crate) mod fault;
pub(crate) mod kind;
pub(crate) mod legs;
pub(crate) mod noise;
pub(crate) mod object;
pub(crate) mod place;
pub(crate) mod robot;
pub(crate) mod scene;
pub(crate) mod sensor;
pub(crate) mod shape;
pub(crate) mod suite;
pub(crate) mod terrain;
pub(crate) mod world;

use std::mem::discriminant;

use serde_json::{Map, Value as Json, json};
use toml::{Table, Value};

use crate::Span;
use crate::table::{Reader, Section};
use kind::{Flag, Kind, ReadContext};

/// Spec that is written as a TOML table.
pub(crate) trait Form: Clone + Default {
    /// Value of a table without any key.
    fn defaults() -> Self {
        Self::default()
    }

    /// Value of a table whose only key is `kind`.
    fn bare(&self) -> Self {
        Self::defaults()
    }

    /// Declares the form and its keys, in the order in which they are printed.
    fn keys(&mut self, keys: &mut Keys<'_>);
}

/// Form with several variants, selected by the key `kind`.
pub(crate) trait Variants: Form + 'static {
    /// The variants.
    const VARIANTS: &'static [Variant<Self>];

    /// Index of this variant in `VARIANTS`.
    fn variant_index(&self) -> usize {
        let has_same_variant = |variant: Self| discriminant(&variant) == discriminant(self);
        Self::VARIANTS.iter().position(|(.., make)| has_same_variant(make())).unwrap_or_default()
    }
}

/// Variant: its word in files, its description, and a constructor of its default.
pub(crate) type Variant<F> = (&'static str, &'static str, fn() -> F);

/// One pass over the keys of a table.
pub(crate) struct Keys<'k> {
    pass: Pass<'k>,
    /// True as long as no required key is missing and no value makes the table unusable.
    is_complete: bool,
    /// True if no further keys can be declared, such as those of an unknown variant.
    is_abandoned: bool,
}

/// Task of a pass, with its state.
enum Pass<'k> {
    /// Reads the key from a table.
    Read(&'k mut Reader, Section<'k, 'k>),
    /// Adds the key to the first table unless it equals the default in the second.
    Print(Table, Option<Table>),
    /// Adds the schema of the key to the description of the form.
    Describe(&'k mut Definitions, Description),
}

/// Named parts of a JSON schema (`$defs`), to which other parts refer.
pub(crate) type Definitions = Map<String, Json>;

/// Description of a form in the JSON schema.
#[derive(Default)]
struct Description {
    name: &'static str,
    about: &'static str,
    properties: Map<String, Json>,
    /// Required keys.
    required: Vec<&'static str>,
    /// Description of the variant if this describes a single variant; `None` for the whole form.
    variant: Option<&'static str>,
    /// Schemas of the variants of the whole form.
    variants: Vec<Json>,
}

impl Description {
    fn schema(self) -> Json {
        if !self.variants.is_empty() {
            return json!({ "description": self.about, "oneOf": self.variants });
        }
        let mut schema = json!({
            "description": self.variant.unwrap_or(self.about),
            "type": "object",
            "properties": self.properties,
            "additionalProperties": false,
        });
        if !self.required.is_empty() {
            schema["required"] = self.required.into();
        }
        schema
    }
}

/// A key that is being declared. The last method of the chain takes the kind of its values and the variable for the
/// value.
pub(crate) struct Key<'w, 'k> {
    keys: &'w mut Keys<'k>,
    name: &'static str,
    about: &'static str,
}

/// Rule by which a key may be omitted.
#[derive(Clone, Copy, PartialEq)]
enum Need {
    Required,
    /// Printed if it has a value; in JSON, `null` is equivalent to an omitted key.
    Nullable,
    /// Not printed if it equals the default; may be `null` in JSON.
    OmittedIfDefault,
    /// Not printed if it is an empty list or table.
    OmittedIfEmpty,
}

impl<'k> Keys<'k> {
    fn new(pass: Pass<'k>) -> Self {
        Self { pass, is_complete: true, is_abandoned: false }
    }

    /// Declares the form: its name and its description in the JSON schema.
    pub(crate) fn form(&mut self, name: &'static str, about: &'static str) {
        if let Pass::Describe(_, description) = &mut self.pass {
            (description.name, description.about) = (name, about);
        }
    }

    /// Declares a key; `about` is its description in editors.
    pub(crate) fn key(&mut self, name: &'static str, about: &'static str) -> Key<'_, 'k> {
        Key { keys: self, name, about }
    }

    /// Declares the key `kind`, which sets `form` to its variant. Returns false if the caller must not declare further
    /// keys.
    pub(crate) fn variant<F: Variants>(&mut self, form: &mut F) -> bool {
        let word = |form: &F| F::VARIANTS[form.variant_index()].0;
        match &mut self.pass {
            Pass::Read(reader, section) => {
                let words: Vec<&str> = F::VARIANTS.iter().map(|(word, ..)| *word).collect();
                if !section.has("kind") {
                    reader.missing(section, "kind");
                }
                let index = reader.choice(section, "kind", &words);
                index.into_iter().for_each(|index| *form = F::VARIANTS[index].2());
                self.is_abandoned = index.is_none();
                self.is_complete &= !self.is_abandoned;
            }
            Pass::Print(table, _) => drop(table.insert("kind".to_owned(), word(form).into())),
            Pass::Describe(_, description) if description.variant.is_some() => {
                description.properties.insert("kind".to_owned(), json!({ "type": "string", "const": word(form) }));
                description.required.push("kind");
            }
            Pass::Describe(definitions, description) => {
                let kinds = F::VARIANTS.iter().map(|(_, about, make)| {
                    let part = Description { variant: Some(about), ..Description::default() };
                    describe(definitions, part, |keys| make().keys(keys)).schema()
                });
                description.variants = kinds.collect();
                self.is_abandoned = true;
            }
        }
        !self.is_abandoned
    }

    /// Makes messages list these keys before keys that are declared later.
    pub(crate) fn mention_first(&mut self, names: &[&'static str]) {
        if let Some((_, section)) = self.reading() {
            names.iter().for_each(|name| _ = section.get(name));
        }
    }

    /// Sets `span` to the table's span if it is still unset.
    pub(crate) fn span(&mut self, span: &mut Span) {
        if let Some((_, section)) = self.reading()
            && *span == Span::default()
        {
            *span = section.span;
        }
    }

    /// Reader and table if the pass reads, for checks that involve several keys.
    pub(crate) fn reading(&mut self) -> Option<(&mut Reader, &mut Section<'k, 'k>)> {
        match &mut self.pass {
            Pass::Read(reader, section) => Some((reader, section)),
            _ => None,
        }
    }

    /// Returns true as long as no required key is missing and no value makes the table unusable.
    pub(crate) fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// Marks the table that is being read as unusable.
    pub(crate) fn refuse(&mut self) {
        self.is_complete = false;
    }
}

impl Key<'_, '_> {
    /// Required value.
    pub(crate) fn required<T>(self, kind: impl Kind<T>, value: &mut T) {
        self.declare_required(&kind, value, Need::Required);
    }

    /// Value that is required unless the table has the single key that replaces all other keys, such as `file`.
    pub(crate) fn required_or_replaced<T>(self, kind: impl Kind<T>, value: &mut T) {
        self.declare_required(&kind, value, Need::Nullable);
    }

    /// Optional value that is always printed.
    pub(crate) fn always_printed<T>(mut self, kind: impl Kind<T>, value: &mut T) {
        self.read(&kind, Some(value)).into_iter().for_each(|read| *value = read);
        self.emit(&kind, Some(value), Need::Nullable);
    }

    /// Optional value, printed unless it is the default.
    pub(crate) fn optional<T>(mut self, kind: impl Kind<T>, value: &mut T) {
        self.read(&kind, Some(value)).into_iter().for_each(|read| *value = read);
        self.emit(&kind, Some(value), Need::OmittedIfDefault);
    }

    /// Optional value, printed unless it is the default; an invalid value makes the whole table unusable.
    pub(crate) fn strict<T>(mut self, kind: impl Kind<T>, value: &mut T) {
        let name = self.name;
        let is_given = self.keys.reading().is_some_and(|(_, section)| section.has(name));
        match self.read(&kind, None) {
            Some(read) => *value = read,
            None if is_given => self.keys.refuse(),
            None => {}
        }
        self.emit(&kind, Some(value), Need::OmittedIfDefault);
    }

    /// Optional value without a default.
    pub(crate) fn nullable<T>(mut self, kind: impl Kind<T>, value: &mut Option<T>) {
        *value = self.read(&kind, value.as_ref()).or(value.take());
        self.emit(&kind, value.as_ref(), Need::Nullable);
    }

    /// Values appended to the existing values; not printed if empty.
    pub(crate) fn list<T>(mut self, kind: impl Kind<Vec<T>>, values: &mut Vec<T>) {
        values.extend(self.read(&kind, None).into_iter().flatten());
        self.emit(&kind, Some(values), Need::OmittedIfEmpty);
    }

    /// Values that replace the existing values unless they are empty; not printed if empty.
    pub(crate) fn non_empty_list<T>(mut self, kind: impl Kind<Vec<T>>, values: &mut Vec<T>) {
        let read = self.read(&kind, None).filter(|read| !read.is_empty());
        read.into_iter().for_each(|read| *values = read);
        self.emit(&kind, Some(values), Need::OmittedIfEmpty);
    }

    /// Flag, printed only if true.
    pub(crate) fn flag(mut self, value: &mut bool) {
        *value = self.read(&Flag, None).unwrap_or(*value);
        self.emit(&Flag, Some(&*value).filter(|value| **value), Need::OmittedIfEmpty);
    }

    /// Declares a required value; reports a missing or invalid one and makes the table unusable.
    fn declare_required<T>(mut self, kind: &impl Kind<T>, value: &mut T, need: Need) {
        let name = self.name;
        if let Some((reader, section)) = self.keys.reading()
            && !section.has(name)
        {
            reader.missing(section, name);
        }
        match self.read(kind, Some(value)) {
            Some(read) => *value = read,
            None if self.keys.reading().is_some() => self.keys.refuse(),
            None => {}
        }
        self.emit(kind, Some(value), need);
    }

    /// Reads the value if the pass reads.
    fn read<T>(&mut self, kind: &impl Kind<T>, old: Option<&T>) -> Option<T> {
        let (reader, section) = self.keys.reading()?;
        kind.read(ReadContext { reader, section, key: self.name }, old)
    }

    /// Prints the value if there is one, or adds it to the schema; does nothing while reading.
    fn emit<T>(self, kind: &impl Kind<T>, value: Option<&T>, need: Need) {
        match &mut self.keys.pass {
            Pass::Read(..) => {}
            Pass::Print(..) => {
                if let Some(value) = value {
                    self.print_value(kind.print(value), need);
                }
            }
            Pass::Describe(definitions, _) => {
                let schema = kind.describe(definitions);
                self.add_schema(schema, need);
            }
        }
    }

    /// Adds a printed value to the table.
    fn print_value(self, printed: Value, need: Need) {
        match &mut self.keys.pass {
            Pass::Print(table, defaults) => {
                let is_default = || defaults.as_ref().is_some_and(|defaults| defaults.get(self.name) == Some(&printed));
                let is_omitted = match need {
                    Need::Required | Need::Nullable => false,
                    Need::OmittedIfDefault => is_default(),
                    Need::OmittedIfEmpty => is_empty(&printed),
                };
                if !is_omitted {
                    table.insert(self.name.to_owned(), printed);
                }
            }
            Pass::Read(..) | Pass::Describe(..) => {}
        }
    }

    /// Adds the schema of the value to the description of the form.
    fn add_schema(self, mut schema: Json, need: Need) {
        match &mut self.keys.pass {
            Pass::Describe(_, description) => {
                if need == Need::Required {
                    description.required.push(self.name);
                } else if need != Need::OmittedIfEmpty {
                    schema = or_null(schema);
                }
                schema["description"] = self.about.into();
                description.properties.insert(self.name.to_owned(), schema);
            }
            Pass::Read(..) | Pass::Print(..) => {}
        }
    }
}

fn is_empty(value: &Value) -> bool {
    match value {
        Value::Array(items) => items.is_empty(),
        Value::Table(table) => table.is_empty(),
        _ => false,
    }
}

/// Schema that also allows `null`.
pub(crate) fn or_null(mut schema: Json) -> Json {
    match schema.get("type").cloned() {
        Some(kind) => {
            schema["type"] = json!([kind, "null"]);
            schema
        }
        None => json!({ "anyOf": [schema, { "type": "null" }] }),
    }
}

/// Table of `form`, without default values.
pub(crate) fn print<F: Form>(form: &F) -> Table {
    print_non_defaults(|keys| form.clone().keys(keys), |keys| form.bare().keys(keys))
}

/// Table of the keys that `declare` declares, without keys for which `bare` prints the same value.
pub(crate) fn print_non_defaults(declare: impl FnOnce(&mut Keys<'_>), bare: impl FnOnce(&mut Keys<'_>)) -> Table {
    let defaults = print_table(None, bare);
    print_table(Some(defaults), declare)
}

fn print_table(defaults: Option<Table>, declare: impl FnOnce(&mut Keys<'_>)) -> Table {
    let mut keys = Keys::new(Pass::Print(Table::new(), defaults));
    declare(&mut keys);
    keys.into_table()
}

fn describe(
    definitions: &mut Definitions,
    description: Description,
    declare: impl FnOnce(&mut Keys<'_>),
) -> Description {
    let mut keys = Keys::new(Pass::Describe(definitions, description));
    declare(&mut keys);
    keys.into_description()
}

impl Keys<'_> {
    /// The table that the pass has printed.
    fn into_table(self) -> Table {
        match self.pass {
            Pass::Print(table, _) => table,
            _ => Table::new(),
        }
    }

    /// The description that the pass has made.
    fn into_description(self) -> Description {
        match self.pass {
            Pass::Describe(_, description) => description,
            _ => Description::default(),
        }
    }
}

/// Schema of the form that `declare` declares.
pub(crate) fn schema(definitions: &mut Definitions, declare: impl FnOnce(&mut Keys<'_>)) -> Json {
    describe(definitions, Description::default(), declare).schema()
}

/// Reference to the schema of the form that `declare` declares, which is added to the definitions.
pub(crate) fn reference(definitions: &mut Definitions, declare: impl FnOnce(&mut Keys<'_>)) -> Json {
    let description = describe(definitions, Description::default(), declare);
    definition(definitions, description.name, |_| description.schema())
}

/// Reference to the definition `name` of the schema; `make` creates the definition.
pub(crate) fn definition(
    definitions: &mut Definitions,
    name: &str,
    make: impl FnOnce(&mut Definitions) -> Json,
) -> Json {
    if !definitions.contains_key(name) {
        let schema = make(definitions);
        definitions.insert(name.to_owned(), schema);
    }
    link(name)
}

/// Reference to the definition `name`.
fn link(name: &str) -> Json {
    json!({ "$ref": format!("#/$defs/{name}") })
}

impl Reader {
    /// Reads a table, with `form` as defaults; `None` if a required key is missing or the table is unusable.
    pub(crate) fn form<F: Form>(&mut self, section: Section<'_, '_>, mut form: F) -> Option<F> {
        self.table(section, |keys| form.keys(keys)).then_some(form)
    }

    /// Reads the keys that `declare` declares and reports all other keys; returns false if a required key is missing or
    /// the table is unusable.
    pub(crate) fn table(&mut self, section: Section<'_, '_>, declare: impl FnOnce(&mut Keys<'_>)) -> bool {
        let mut keys = Keys::new(Pass::Read(self, section));
        declare(&mut keys);
        let (is_complete, is_abandoned) = (keys.is_complete, keys.is_abandoned);
        if let Some((reader, section)) = keys.reading()
            && !is_abandoned
        {
            reader.unknown_keys(section);
        }
        is_complete
    }
}
