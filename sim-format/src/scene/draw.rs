//! Draws random values of a scene from the seed and replaces them before the scene is read.
//!
//! A draw is a table such as `{ uniform = [500, 3500] }` in the position of a value. Its random numbers come from a separate stream, keyed
//! by the seed and the path of the value (`robot.2.x_mm`), so they do not depend on the rest of the scene. Entries of lists with a `count`
//! are repeated first, so that each has its own draws (`object.1.3.x_mm`).

use std::cell::{Cell, OnceCell};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use serde_json::Value as Json;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use super::labyrinth;
use crate::code::Code;
use crate::line::{Quantity, nearest};
use crate::spec::Drawn;
use crate::table::{Reader, Section};
use sim_core::RobotId;
use sim_core::noise::{Purpose, Stream, name_key};

/// Keys that make a table a draw.
const DRAWS: [&str; 5] = ["uniform", "choice", "normal", "same_as", "random_maze"];

/// Lists of a scene whose entries have paths and may be repeated.
const LISTS: [&str; 6] = ["robot", "object", "marker", "world.wall", "world.object", "world.start"];

/// Maximum number of repetitions of an entry.
const MAX_REPETITIONS: i64 = 100_000;

/// Maximum number of columns and of rows of a random maze.
const MAX_MAZE_SIDE: i64 = 200;

/// Number of draws from a normal distribution after which its limits count as out of reach.
const TRIES: u32 = 1000;

/// Any finite number.
const ANY_NUMBER: Quantity = Quantity::number("number", -1e300, 1e300);

/// Origin of the drawn values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Draw {
    /// Random values from the seed of the scene, or from this seed instead, and from the number of an attempt.
    Seed(Option<u64>, u32),
    /// Extreme values, to find mistakes: the minimum of all ranges for even numbers, the maximum for odd ones, and the choice with this
    /// number.
    Extreme(usize),
}

/// Texts of drawn numbers, to which the values of a document refer.
#[derive(Default)]
pub(crate) struct Texts {
    /// Each block is twice as long as the previous one.
    blocks: [OnceCell<Vec<OnceCell<String>>>; 32],
    count: Cell<usize>,
}

impl Texts {
    fn keep(&self, text: String) -> &str {
        let index = self.count.get() + 1;
        self.count.set(index);
        let (block, size) = (index.ilog2() as usize, 1 << index.ilog2());
        let cells = self.blocks[block].get_or_init(|| vec![OnceCell::new(); size]);
        cells[index - size].get_or_init(|| text)
    }

    fn number(&self, text: String) -> DeValue<'_> {
        DeValue::parse_recoverable(self.keep(text)).0.into_inner()
    }
}

/// A document whose values have been drawn.
pub(crate) struct DrawnDocument<'i> {
    pub(crate) root: DeTable<'i>,
    pub(crate) drawn: Vec<Drawn>,
    /// Paths of the entries of lists, by the path of the list.
    pub(crate) paths: BTreeMap<String, Vec<String>>,
}

/// Maximum number of choices of a draw in the document; 0 if nothing is drawn.
pub(crate) fn choices(root: &DeTable<'_>) -> usize {
    root.iter().map(|(_, value)| choices_of(value.get_ref())).max().unwrap_or_default()
}

fn choices_of(value: &DeValue<'_>) -> usize {
    match value {
        DeValue::Array(items) => items.iter().map(|item| choices_of(item.get_ref())).max().unwrap_or_default(),
        DeValue::Table(table) if is_draw(table) => {
            let own = match get(table, "choice").map(Spanned::get_ref) {
                Some(DeValue::Array(items)) => items.len().max(1),
                _ => 2,
            };
            own.max(choices(table))
        }
        DeValue::Table(table) => choices(table),
        _ => 0,
    }
}

fn is_draw(table: &DeTable<'_>) -> bool {
    table.iter().any(|(key, _)| DRAWS.contains(&key.get_ref().as_ref()))
}

fn get<'t, 'i>(table: &'t DeTable<'i>, key: &str) -> Option<&'t Spanned<DeValue<'i>>> {
    table.iter().find(|(name, _)| name.get_ref() == key).map(|(_, value)| value)
}

impl Reader {
    /// Draws the values of a scene.
    pub(crate) fn draw<'i>(&mut self, root: DeTable<'i>, draw: Draw, texts: &'i Texts) -> DrawnDocument<'i> {
        let (seed, attempt, extreme) = match draw {
            Draw::Seed(seed, attempt) => (seed.or_else(|| seed_of(&root)).unwrap_or_default(), attempt, None),
            Draw::Extreme(number) => (number as u64, 0, Some(number)),
        };
        let mut artist = Artist {
            reader: self,
            texts,
            seed,
            attempt,
            extreme,
            drawn: Vec::new(),
            values: BTreeMap::new(),
            references: BTreeMap::new(),
            paths: BTreeMap::new(),
        };
        let mut root = artist.table(root, "");
        if !artist.references.is_empty() {
            root = artist.resolved(root, "");
        }
        DrawnDocument { root, drawn: artist.drawn, paths: artist.paths }
    }
}

/// The `id` that an entry of a list states.
fn id_of(item: &DeValue<'_>) -> Option<i64> {
    let DeValue::Table(table) = item else { return None };
    let DeValue::Integer(digits) = get(table, "id")?.get_ref() else { return None };
    i64::from_str_radix(digits.as_str(), digits.radix()).ok()
}

/// The seed that a scene states.
fn seed_of(root: &DeTable<'_>) -> Option<u64> {
    let DeValue::Table(scene) = get(root, "scene")?.get_ref() else { return None };
    let DeValue::Integer(digits) = get(scene, "seed")?.get_ref() else { return None };
    let seed = i64::from_str_radix(digits.as_str(), digits.radix()).ok();
    seed.and_then(|seed| u64::try_from(seed).ok())
}

/// One pass that draws the values of a document.
struct Artist<'r, 'i> {
    reader: &'r mut Reader,
    texts: &'i Texts,
    seed: u64,
    attempt: u32,
    /// Number of the extreme case to use instead of random values; see [`Draw::Extreme`].
    extreme: Option<usize>,
    drawn: Vec<Drawn>,
    /// Drawn values by their paths.
    values: BTreeMap<String, DeValue<'i>>,
    /// References `same_as` by the path of their own value: the other path, and the bytes of the text that state it.
    references: BTreeMap<String, (String, Range<usize>)>,
    paths: BTreeMap<String, Vec<String>>,
}

impl<'i> Artist<'_, 'i> {
    fn table(&mut self, table: DeTable<'i>, path: &str) -> DeTable<'i> {
        let mut result = DeTable::new();
        for (key, value) in table {
            let path = join(path, key.get_ref());
            result.insert(key, self.value(value, &path));
        }
        result
    }

    fn value(&mut self, value: Spanned<DeValue<'i>>, path: &str) -> Spanned<DeValue<'i>> {
        let span = value.span();
        let new = match value.into_inner() {
            DeValue::Table(table) if is_draw(&table) => self.draw(&table, &span, path),
            // A single `[robot]` is a list with one entry.
            DeValue::Table(table) if LISTS.contains(&path) => {
                let mut items = DeArray::new();
                items.push(Spanned::new(span.clone(), DeValue::Table(table)));
                DeValue::Array(self.items(items, path))
            }
            DeValue::Table(table) => DeValue::Table(self.table(table, path)),
            DeValue::Array(items) => DeValue::Array(self.items(items, path)),
            plain => plain,
        };
        Spanned::new(span, new)
    }

    fn items(&mut self, items: DeArray<'i>, path: &str) -> DeArray<'i> {
        let mut result = DeArray::new();
        let mut names = BTreeSet::new();
        let is_list = LISTS.contains(&path);
        let ids: BTreeSet<i64> = items.iter().filter_map(|item| id_of(item.get_ref())).collect();
        let mut free = (1..).filter(|number| !ids.contains(number));
        for item in items {
            let name = match item.get_ref() {
                DeValue::Table(table) => get(table, "name").and_then(|name| name.get_ref().as_str()),
                _ => None,
            };
            if let Some(name) = name.filter(|name| is_list && !names.insert((*name).to_owned())) {
                let span = self.reader.span(item.span());
                let message = format!("a second `{path}` is named `{name}`");
                self.reader.sink.error(Code::SceneName, span, message, "each name once");
            }
            // Entries with a name also use up the next free number.
            let number = id_of(item.get_ref()).or_else(|| free.next()).unwrap_or_default();
            let own = join(path, &name.map_or_else(|| number.to_string(), str::to_owned));
            match self.repetitions(&item, path, &own) {
                None => {
                    self.paths.entry(path.to_owned()).or_default().push(own.clone());
                    result.push(self.value(item, &own));
                }
                Some((single, count)) => {
                    for number in 1..=count {
                        let own = join(&own, &number.to_string());
                        result.push(self.value(single.clone(), &own));
                        self.paths.entry(path.to_owned()).or_default().push(own);
                    }
                }
            }
        }
        result
    }

    /// An entry of a list that is repeated: the entry without its `count`, and the count.
    fn repetitions(
        &mut self,
        item: &Spanned<DeValue<'i>>,
        list: &str,
        path: &str,
    ) -> Option<(Spanned<DeValue<'i>>, u32)> {
        let DeValue::Table(table) = item.get_ref() else { return None };
        let count = get(table, "count").filter(|_| LISTS.contains(&list))?;
        let rest = || table.iter().filter(|(key, _)| key.get_ref() != "count");
        // Robots of one entry are a group, unless each is drawn separately.
        let is_drawn = || rest().any(|(_, value)| choices_of(value.get_ref()) > 0);
        if list == "robot" && (get(table, "layout").is_some() || !is_drawn()) {
            return None;
        }
        let count = self.value(count.clone(), &join(path, "count"));
        let count = self.reader.as_integer("count", &count, 0, MAX_REPETITIONS).unwrap_or(1);
        let single: DeTable<'i> = rest().map(|(key, value)| (key.clone(), value.clone())).collect();
        Some((Spanned::new(item.span(), DeValue::Table(single)), count as u32))
    }

    /// The value of a draw; after a mistake, which is reported, a possible result.
    fn draw(&mut self, table: &DeTable<'i>, span: &Range<usize>, path: &str) -> DeValue<'i> {
        let mut section = Section::root(table);
        section.name = "draw";
        section.span = self.reader.span(span.clone());
        let used = DRAWS.into_iter().filter(|key| section.has(key)).collect::<Vec<_>>();
        let [key] = used[..] else {
            let message = format!("a value is drawn in several ways: {}", used.join(", "));
            self.mistake(&section, message, "one of uniform, choice, normal, same_as, random_maze");
            return self.number(1.0);
        };
        if path == "scene.seed" {
            self.mistake(&section, "the seed cannot be drawn from itself".to_owned(), "an integer, or no seed");
            return self.whole(0);
        }
        let mut stream = Stream::new(self.seed, RobotId(0), Purpose::Scene, self.attempt, name_key(path));
        let value = match key {
            "uniform" => self.uniform(&mut section, &mut stream),
            "normal" => self.normal(&mut section, &mut stream),
            "choice" => self.choice(&mut section, &mut stream, path),
            "random_maze" => self.maze(&mut section, &mut stream),
            _ => {
                if let Some(other) = self.reader.text(&mut section, "same_as") {
                    self.references.insert(path.to_owned(), (other, span.clone()));
                }
                Some(self.whole(1))
            }
        };
        self.reader.unknown_keys(&section);
        let Some(value) = value else { return self.number(1.0) };
        if key != "same_as" {
            self.keep(path, &value);
        }
        value
    }

    fn whole(&self, number: i64) -> DeValue<'i> {
        self.texts.number(number.to_string())
    }

    fn number(&self, number: f64) -> DeValue<'i> {
        self.texts.number(format!("{number:?}"))
    }

    fn keep(&mut self, path: &str, value: &DeValue<'i>) {
        self.drawn.push(Drawn { path: path.to_owned(), value: json(value) });
        self.values.insert(path.to_owned(), value.clone());
    }

    fn mistake(&mut self, section: &Section<'_, '_>, message: String, expected: &str) {
        self.reader.sink.error(Code::SceneDraw, section.span, message, expected);
    }

    /// A number between both ends; a whole number, ends included, if both ends are whole.
    fn uniform(&mut self, section: &mut Section<'_, '_>, stream: &mut Stream) -> Option<DeValue<'i>> {
        let [low, high] = self.reader.numbers(section, "uniform", &[ANY_NUMBER, ANY_NUMBER])?;
        if low > high {
            let message = format!("`uniform` begins at {low} and ends at {high}");
            self.mistake(section, message, "the least number first");
            return Some(self.number(low));
        }
        let ends = section.get("uniform").and_then(|value| match value.get_ref() {
            DeValue::Array(ends) if ends.iter().all(|end| end.get_ref().is_integer()) => Some([low, high]),
            _ => None,
        });
        let fraction = match self.extreme {
            Some(number) if number % 2 == 0 => 0.0,
            Some(_) => 1.0,
            None => stream.unit(),
        };
        Some(match ends.map(|ends| ends.map(|end| end as i64)) {
            Some([low, high]) => {
                let count = (i128::from(high) - i128::from(low) + 1) as f64;
                let offset = ((count * fraction).floor() as i128).min(i128::from(high) - i128::from(low));
                self.whole((i128::from(low) + offset) as i64)
            }
            None => self.number(low + (high - low) * fraction),
        })
    }

    /// A number of a normal distribution, truncated at its limits.
    fn normal(&mut self, section: &mut Section<'_, '_>, stream: &mut Stream) -> Option<DeValue<'i>> {
        let spread = Quantity::number("standard deviation", 0.0, 1e300);
        let [mean, sigma] = self.reader.numbers(section, "normal", &[ANY_NUMBER, spread])?;
        let [min, max] = ["min", "max"].map(|key| (section.has(key), self.reader.number(section, key, &ANY_NUMBER)));
        if [min, max].iter().any(|(is_said, value)| *is_said && value.is_none()) {
            return None;
        }
        let (low, high) = (min.1.unwrap_or(f64::NEG_INFINITY), max.1.unwrap_or(f64::INFINITY));
        if low > high {
            self.mistake(section, format!("`min` {low} is greater than `max` {high}"), "the least number as `min`");
            return None;
        }
        let picked = match self.extreme {
            Some(number) => {
                let end = if number % 2 == 0 { low } else { high };
                Some(if end.is_finite() { end } else { mean.clamp(low, high) })
            }
            None => (0..TRIES).map(|_| mean + sigma * stream.normal()).find(|picked| (low..=high).contains(picked)),
        };
        if picked.is_none() {
            let message = format!("of {TRIES} numbers of this distribution none lies between its `min` and `max`");
            self.mistake(section, message, "limits within some standard deviations of the mean");
        }
        picked.map(|picked| self.number(picked))
    }

    fn choice(&mut self, section: &mut Section<'_, 'i>, stream: &mut Stream, path: &str) -> Option<DeValue<'i>> {
        let items = self.reader.array(section, "choice", "an array of values")?;
        if items.is_empty() {
            self.mistake(section, "`choice` has nothing to choose from".to_owned(), "at least one value");
            return None;
        }
        let index = match self.extreme {
            Some(number) => number % items.len(),
            None => ((stream.unit() * items.len() as f64) as usize).min(items.len() - 1),
        };
        Some(self.value(items[index].clone(), path).into_inner())
    }

    fn maze(&mut self, section: &mut Section<'_, '_>, stream: &mut Stream) -> Option<DeValue<'i>> {
        let items = self.reader.array(section, "random_maze", "an array of 2 integers: columns and rows")?;
        let [columns, rows] = items else {
            let message = format!("`random_maze` has {} values", items.len());
            self.mistake(section, message, "an array of 2 integers: columns and rows");
            return None;
        };
        let columns = self.reader.as_integer("columns", columns, 1, MAX_MAZE_SIDE)?;
        let rows = self.reader.as_integer("rows", rows, 1, MAX_MAZE_SIDE)?;
        let loops = Quantity::percent("share of opened walls", 0.0, 100.0);
        let loops = self.reader.number(section, "loops_percent", &loops).unwrap_or_default();
        let cell = self.reader.number(section, "cell_mm", &Quantity::size("cell size"));
        let text = labyrinth::drawing(columns as usize, rows as usize, loops, cell, stream);
        Some(DeValue::String(text.into()))
    }

    /// Replaces references with the values of the draws that they name.
    fn resolved(&mut self, table: DeTable<'i>, path: &str) -> DeTable<'i> {
        let mut result = DeTable::new();
        for (key, value) in table {
            let path = join(path, key.get_ref());
            let value = self.resolved_value(value, &path);
            result.insert(key, value);
        }
        result
    }

    fn resolved_value(&mut self, value: Spanned<DeValue<'i>>, path: &str) -> Spanned<DeValue<'i>> {
        let span = value.span();
        if let Some(found) = self.referred(path) {
            return Spanned::new(span, found);
        }
        let new = match value.into_inner() {
            DeValue::Table(table) => DeValue::Table(self.resolved(table, path)),
            DeValue::Array(items) => {
                let paths = self.paths.get(path).cloned().unwrap_or_default();
                let mut result = DeArray::new();
                for (item, path) in items.into_iter().zip(paths) {
                    result.push(self.resolved_value(item, &path));
                }
                DeValue::Array(result)
            }
            plain => plain,
        };
        Spanned::new(span, new)
    }

    /// Value of the draw to which the reference at `path` leads; `None` if the reference does not exist or leads nowhere, which is
    /// reported.
    fn referred(&mut self, path: &str) -> Option<DeValue<'i>> {
        let (first, span) = self.references.get(path)?.clone();
        let mut other = first;
        let mut seen = BTreeSet::from([path.to_owned()]);
        while let Some((next, _)) = self.references.get(&other) {
            if !seen.insert(other.clone()) {
                let message = format!("`same_as` leads back to `{other}`");
                let span = self.reader.span(span);
                self.reader.sink.error(Code::SceneDraw, span, message, "the path of a value that is drawn");
                return None;
            }
            other.clone_from(next);
        }
        let found = self.values.get(&other).cloned();
        if let Some(value) = &found {
            self.drawn.push(Drawn { path: path.to_owned(), value: json(value) });
        } else {
            let span = self.reader.span(span);
            let message = format!("no value `{other}` is drawn");
            let expected = "the path of a value that is drawn, as `robot.1.x_mm`: list, name or number, key";
            let close = nearest(&other, self.values.keys().map(String::as_str)).map(|path| format!("write `{path}`"));
            self.reader.sink.error(Code::SceneDraw, span, message, expected).suggestion = close;
        }
        found
    }
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

fn json(value: &DeValue<'_>) -> Json {
    match value {
        DeValue::String(text) => text.as_ref().into(),
        DeValue::Integer(digits) => i64::from_str_radix(digits.as_str(), digits.radix()).unwrap_or_default().into(),
        DeValue::Float(digits) => digits.as_str().parse::<f64>().unwrap_or_default().into(),
        DeValue::Boolean(flag) => (*flag).into(),
        DeValue::Datetime(time) => time.to_string().into(),
        DeValue::Array(items) => items.iter().map(|item| json(item.get_ref())).collect(),
        DeValue::Table(table) => {
            Json::Object(table.iter().map(|(key, value)| (key.get_ref().to_string(), json(value.get_ref()))).collect())
        }
    }
}
