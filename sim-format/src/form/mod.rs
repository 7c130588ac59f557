//! Forms: what the tables of our own files in TOML may say.
//!
//! Each key is declared in one place, with its name, its meaning, the kind of its values and its default. Three walks go over
//! the declarations: one reads a table, one prints it, one describes it in the JSON schema. [`kind`] has the kinds of values.

pub(crate) mod device;
pub(crate) mod kind;
pub(crate) mod legs;
pub(crate) mod noise;
pub(crate) mod object;
pub(crate) mod place;
pub(crate) mod robot;
pub(crate) mod scene;
pub(crate) mod sensor;
pub(crate) mod shape;
pub(crate) mod terrain;
pub(crate) mod world;

use std::mem::discriminant;

use serde_json::{Map, Value as Json, json};
use toml::{Table, Value};

use crate::Span;
use crate::table::{Reader, Section};
use kind::{At, Flag, Kind};

/// A spec that a table of TOML says.
pub(crate) trait Form: Clone + Default {
    /// What a table without any key says.
    fn usual() -> Self {
        Self::default()
    }

    /// The same of a table that says nothing but which variant it is.
    fn bare(&self) -> Self {
        Self::usual()
    }

    /// Declares the form and its keys, in the order in which they are printed.
    fn keys(&mut self, keys: &mut Keys<'_>);
}

/// A form of several variants, which the key `kind` tells apart.
pub(crate) trait Variants: Form + 'static {
    /// The variants.
    const KINDS: &'static [Variant<Self>];

    /// The place of this variant among them.
    fn place(&self) -> usize {
        let is_same = |made: Self| discriminant(&made) == discriminant(self);
        Self::KINDS.iter().position(|(.., make)| is_same(make())).unwrap_or_default()
    }
}

/// A variant: its word, what it is, and one about which nothing else is said.
pub(crate) type Variant<F> = (&'static str, &'static str, fn() -> F);

/// One walk over the keys of a table.
pub(crate) struct Keys<'k> {
    walk: Walk<'k>,
    /// Whether nothing that is required is missing.
    is_complete: bool,
    /// Whether the table cannot be understood, so that nothing is known of its other keys.
    is_abandoned: bool,
}

/// What is done with each key.
enum Walk<'k> {
    /// It is read from a table.
    Read(&'k mut Reader, Section<'k, 'k>),
    /// It is printed, unless it says what is so without it, as in the second table.
    Print(Table, Option<Table>),
    /// Its description is added to that of the form.
    Describe(&'k mut Definitions, Description),
}

/// The named parts of a JSON schema (`$defs`), to which other parts refer.
pub(crate) type Definitions = Map<String, Json>;

/// What the JSON schema says of a form.
#[derive(Default)]
struct Description {
    name: &'static str,
    about: &'static str,
    properties: Map<String, Json>,
    /// The keys that must be there.
    required: Vec<&'static str>,
    /// What the variant is that is described; `None` for the whole form.
    variant: Option<&'static str>,
    /// The variants of the whole form.
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

/// A key that is being declared: its last method says what is behind it.
pub(crate) struct Key<'w, 'k> {
    keys: &'w mut Keys<'k>,
    name: &'static str,
    about: &'static str,
}

/// Whether a key must be there.
#[derive(Clone, Copy, PartialEq)]
enum Need {
    Required,
    /// It may be `null` in JSON, which stands for a key that is left out.
    Nullable,
    /// The same; it is left out where it is as usual.
    Usual,
    Optional,
}

impl<'k> Keys<'k> {
    fn new(walk: Walk<'k>) -> Self {
        Self { walk, is_complete: true, is_abandoned: false }
    }

    /// Declares the form: its name in the JSON schema, and what it is in a sentence.
    pub(crate) fn form(&mut self, name: &'static str, about: &'static str) {
        if let Walk::Describe(_, description) = &mut self.walk {
            (description.name, description.about) = (name, about);
        }
    }

    /// Declares a key; `about` is what editors show of it.
    pub(crate) fn key(&mut self, name: &'static str, about: &'static str) -> Key<'_, 'k> {
        Key { keys: self, name, about }
    }

    /// Declares the key `kind` of `form`, which has that variant then; false if there is none such.
    pub(crate) fn variant<F: Variants>(&mut self, form: &mut F) -> bool {
        let word = |form: &F| F::KINDS[form.place()].0;
        match &mut self.walk {
            Walk::Read(reader, section) => {
                let words: Vec<&str> = F::KINDS.iter().map(|(word, ..)| *word).collect();
                if !section.has("kind") {
                    reader.missing(section, "kind");
                }
                let place = reader.choice(section, "kind", &words);
                place.into_iter().for_each(|place| *form = F::KINDS[place].2());
                self.is_abandoned = place.is_none();
                self.is_complete &= !self.is_abandoned;
            }
            Walk::Print(table, _) => drop(table.insert("kind".to_owned(), word(form).into())),
            Walk::Describe(_, description) if description.variant.is_some() => {
                description.properties.insert("kind".to_owned(), json!({ "type": "string", "const": word(form) }));
                description.required.push("kind");
            }
            Walk::Describe(definitions, description) => {
                let kinds = F::KINDS.iter().map(|(_, about, make)| {
                    let part = Description { variant: Some(about), ..Description::default() };
                    describe(definitions, part, |keys| make().keys(keys)).schema()
                });
                description.variants = kinds.collect();
                self.is_abandoned = true;
            }
        }
        !self.is_abandoned
    }

    /// Lets messages name these keys before those that follow.
    pub(crate) fn mention(&mut self, names: &[&'static str]) {
        if let Some((_, section)) = self.reading() {
            names.iter().for_each(|name| _ = section.get(name));
        }
    }

    /// Where the table is written, for what has no place yet.
    pub(crate) fn span(&mut self, span: &mut Span) {
        if let Some((_, section)) = self.reading()
            && *span == Span::default()
        {
            *span = section.span;
        }
    }

    /// The reader and the table while one is read: for what one key alone does not tell.
    pub(crate) fn reading(&mut self) -> Option<(&mut Reader, &mut Section<'k, 'k>)> {
        match &mut self.walk {
            Walk::Read(reader, section) => Some((reader, section)),
            _ => None,
        }
    }

    /// Whether nothing is missing so far that is required.
    pub(crate) fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// Leaves the table out that is being read: it says nothing that can be used.
    pub(crate) fn refuse(&mut self) {
        self.is_complete = false;
    }
}

impl Key<'_, '_> {
    /// A value that must be there.
    pub(crate) fn required<T>(self, kind: impl Kind<T>, value: &mut T) {
        self.needed(&kind, value, Need::Required);
    }

    /// A value that must be there unless another key, which excludes all others, stands for the whole table.
    pub(crate) fn expected<T>(self, kind: impl Kind<T>, value: &mut T) {
        self.needed(&kind, value, Need::Nullable);
    }

    /// A value that may be left out, but is always printed.
    pub(crate) fn always<T>(mut self, kind: impl Kind<T>, value: &mut T) {
        self.read(&kind, Some(value)).into_iter().for_each(|read| *value = read);
        self.tell(&kind, Some(value), Need::Nullable);
    }

    /// A value that is left out where a table without any key says the same.
    pub(crate) fn optional<T>(mut self, kind: impl Kind<T>, value: &mut T) {
        self.read(&kind, Some(value)).into_iter().for_each(|read| *value = read);
        self.tell(&kind, Some(value), Need::Usual);
    }

    /// The same, but one that is no good spoils the whole table.
    pub(crate) fn strictly<T>(mut self, kind: impl Kind<T>, value: &mut T) {
        let name = self.name;
        let is_said = self.keys.reading().is_some_and(|(_, section)| section.has(name));
        match self.read(&kind, None) {
            Some(read) => *value = read,
            None if is_said => self.keys.refuse(),
            None => {}
        }
        self.tell(&kind, Some(value), Need::Usual);
    }

    /// A value without a default.
    pub(crate) fn maybe<T>(mut self, kind: impl Kind<T>, value: &mut Option<T>) {
        *value = self.read(&kind, value.as_ref()).or(value.take());
        self.tell(&kind, value.as_ref(), Need::Nullable);
    }

    /// Values that are added to others; left out where there are none.
    pub(crate) fn list<T>(mut self, kind: impl Kind<Vec<T>>, values: &mut Vec<T>) {
        values.extend(self.read(&kind, None).into_iter().flatten());
        self.tell(&kind, Some(values), Need::Optional);
    }

    /// Values that others replace; left out where there are none.
    pub(crate) fn items<T>(mut self, kind: impl Kind<Vec<T>>, values: &mut Vec<T>) {
        let read = self.read(&kind, None).filter(|read| !read.is_empty());
        read.into_iter().for_each(|read| *values = read);
        self.tell(&kind, Some(values), Need::Optional);
    }

    /// `true`, or left out.
    pub(crate) fn flag(mut self, value: &mut bool) {
        *value = self.read(&Flag, None).unwrap_or(*value);
        self.tell(&Flag, Some(&*value).filter(|value| **value), Need::Optional);
    }

    fn needed<T>(mut self, kind: &impl Kind<T>, value: &mut T, need: Need) {
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
        self.tell(kind, Some(value), need);
    }

    fn read<T>(&mut self, kind: &impl Kind<T>, old: Option<&T>) -> Option<T> {
        let (reader, section) = self.keys.reading()?;
        kind.read(At { reader, section, key: self.name }, old)
    }

    /// Prints the value where there is one, or describes what it may be.
    fn tell<T>(self, kind: &impl Kind<T>, value: Option<&T>, need: Need) {
        match &mut self.keys.walk {
            Walk::Read(..) => {}
            Walk::Print(table, usual) => {
                let Some(printed) = value.map(|value| kind.print(value)) else { return };
                let is_as_usual = || usual.as_ref().is_some_and(|usual| usual.get(self.name) == Some(&printed));
                let is_left_out = match need {
                    Need::Required | Need::Nullable => false,
                    Need::Usual => is_as_usual(),
                    Need::Optional => is_empty(&printed),
                };
                if !is_left_out {
                    table.insert(self.name.to_owned(), printed);
                }
            }
            Walk::Describe(definitions, description) => {
                let mut schema = kind.describe(definitions);
                if need == Need::Required {
                    description.required.push(self.name);
                } else if need != Need::Optional {
                    schema = or_null(schema);
                }
                schema["description"] = self.about.into();
                description.properties.insert(self.name.to_owned(), schema);
            }
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

/// A schema that allows `null`, too.
pub(crate) fn or_null(mut schema: Json) -> Json {
    match schema.get("type").cloned() {
        Some(kind) => {
            schema["type"] = json!([kind, "null"]);
            schema
        }
        None => json!({ "anyOf": [schema, { "type": "null" }] }),
    }
}

/// The table that says what `form` says.
pub(crate) fn print<F: Form>(form: &F) -> Table {
    print_beside(|keys| form.clone().keys(keys), |keys| form.bare().keys(keys))
}

/// The table with the keys that `declare` declares, but for those that say the same in the `bare` form.
pub(crate) fn print_beside(declare: impl FnOnce(&mut Keys<'_>), bare: impl FnOnce(&mut Keys<'_>)) -> Table {
    let usual = print_table(None, bare);
    print_table(Some(usual), declare)
}

fn print_table(usual: Option<Table>, declare: impl FnOnce(&mut Keys<'_>)) -> Table {
    let mut keys = Keys::new(Walk::Print(Table::new(), usual));
    declare(&mut keys);
    match keys.walk {
        Walk::Print(table, _) => table,
        _ => Table::new(),
    }
}

fn describe(
    definitions: &mut Definitions,
    description: Description,
    declare: impl FnOnce(&mut Keys<'_>),
) -> Description {
    let mut keys = Keys::new(Walk::Describe(definitions, description));
    declare(&mut keys);
    match keys.walk {
        Walk::Describe(_, description) => description,
        _ => Description::default(),
    }
}

/// The schema of the form that `declare` declares.
pub(crate) fn schema(definitions: &mut Definitions, declare: impl FnOnce(&mut Keys<'_>)) -> Json {
    describe(definitions, Description::default(), declare).schema()
}

/// A reference to the form that `declare` declares, among the definitions of the schema.
pub(crate) fn reference(definitions: &mut Definitions, declare: impl FnOnce(&mut Keys<'_>)) -> Json {
    let description = describe(definitions, Description::default(), declare);
    definition(definitions, description.name, |_| description.schema())
}

/// A reference to the definition `name` of the schema, which `make` describes.
pub(crate) fn definition(
    definitions: &mut Definitions,
    name: &str,
    make: impl FnOnce(&mut Definitions) -> Json,
) -> Json {
    if !definitions.contains_key(name) {
        let schema = make(definitions);
        definitions.insert(name.to_owned(), schema);
    }
    json!({ "$ref": format!("#/$defs/{name}") })
}

impl Reader {
    /// Reads a table on top of what `form` says without it; `None` where something is missing that is required.
    pub(crate) fn form<F: Form>(&mut self, section: Section<'_, '_>, mut form: F) -> Option<F> {
        self.table(section, |keys| form.keys(keys)).then_some(form)
    }

    /// Reads the keys that `declare` declares and reports all others; false where something is missing that is required.
    pub(crate) fn table(&mut self, section: Section<'_, '_>, declare: impl FnOnce(&mut Keys<'_>)) -> bool {
        let mut keys = Keys::new(Walk::Read(self, section));
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
