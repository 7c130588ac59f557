//! Draws the random values of a scene: replaces each draw by a value before the scene is read.
//!
//! A draw is a table such as `{ uniform = [500, 3500] }` in place of a value. Its random numbers come from a separate
//! stream, keyed by the seed and the path of the value (`robot.2.x_mm`), so they do not depend on the rest of the
//! scene. Before the draws, entries of lists with a `count` are repeated, so that each copy has its own draws
//! (`object.1.3.x_mm`).

use std::cell::{Cell, OnceCell};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use serde_json::Value as Json;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use super::labyrinth;
use crate::code::Code;
use crate::form::place::MAX_REPETITIONS;
use crate::line::{Quantity, nearest};
use crate::spec::Drawn;
use crate::table::{Reader, Section};
use sim_core::RobotId;
use sim_core::noise::{Purpose, Stream, name_key};

/// Keys that make a table a draw.
pub(crate) const DRAWS: [&str; 5] = ["uniform", "choice", "normal", "same_as", "random_maze"];

/// Lists of a scene whose entries have paths and may be repeated.
const LISTS: [&str; 6] = ["robot", "object", "marker", "world.wall", "world.object", "world.start"];

/// Maximum number of columns and of rows of a random maze.
const MAX_MAZE_SIDE: i64 = 200;

/// Maximum number of draws from a normal distribution until one lies within its limits; without success, an error is
/// reported.
const MAX_TRIES: u32 = 1000;

/// Number of a draw. Our choice of the bounds, beyond those of all values that can be drawn.
const ANY_NUMBER: Quantity = Quantity::number("number", -1e12, 1e12);

/// Origin of the drawn values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Draw {
    /// Random values from this seed, or from the seed of the scene if it is `None`, and from the number of the attempt.
    Seed(Option<u64>, u32),
    /// Extreme values, to find mistakes, for the case with this number. All ranges have their minimum if the number is
    /// even and their maximum if it is odd; of all choices, the one with this index is taken.
    Extreme(usize),
}

/// Texts of drawn numbers. The values of a document borrow them.
#[derive(Default)]
pub(crate) struct Texts {
    /// Each block is twice as long as the previous one.
    blocks: [OnceCell<Vec<OnceCell<String>>>; 32],
    count: Cell<usize>,
}

impl Texts {
    /// Stores a text and borrows it.
    fn keep(&self, text: String) -> &str {
        let index = self.count.get() + 1;
        self.count.set(index);
        let (block, size) = (index.ilog2() as usize, 1 << index.ilog2());
        let cells = self.blocks[block].get_or_init(|| vec![OnceCell::new(); size]);
        cells[index - size].get_or_init(|| text)
    }

    /// Parses the text of a number.
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

/// Maximum number of choices of a draw in the document, where a draw without choices has two, its extremes; 0 if
/// nothing is drawn.
pub(crate) fn max_choices(root: &DeTable<'_>) -> usize {
    root.iter().map(|(_, value)| max_choices_in(value.get_ref())).max().unwrap_or_default()
}

fn max_choices_in(value: &DeValue<'_>) -> usize {
    match value {
        DeValue::Array(items) => items.iter().map(|item| max_choices_in(item.get_ref())).max().unwrap_or_default(),
        DeValue::Table(table) if is_draw(table) => {
            let count = match get(table, "choice").map(Spanned::get_ref) {
                Some(DeValue::Array(items)) => items.len().max(1),
                _ => 2,
            };
            count.max(max_choices(table))
        }
        DeValue::Table(table) => max_choices(table),
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
        self.has_draws = true;
        let (seed, attempt, extreme) = match draw {
            Draw::Seed(seed, attempt) => (seed.or_else(|| stated_seed(&root)).unwrap_or_default(), attempt, None),
            Draw::Extreme(number) => (number as u64, 0, Some(number)),
        };
        let mut pass = DrawPass {
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
        let mut root = pass.draw_table(root, "");
        if !pass.references.is_empty() {
            root = pass.resolve_table(root, "");
        }
        DrawnDocument { root, drawn: pass.drawn, paths: pass.paths }
    }
}

/// `id` of an entry of a list, if it has one.
fn stated_id(item: &DeValue<'_>) -> Option<i64> {
    let DeValue::Table(table) = item else { return None };
    let DeValue::Integer(digits) = get(table, "id")?.get_ref() else { return None };
    i64::from_str_radix(digits.as_str(), digits.radix()).ok()
}

/// Seed of a scene, if it has one.
fn stated_seed(root: &DeTable<'_>) -> Option<u64> {
    let DeValue::Table(scene) = get(root, "scene")?.get_ref() else { return None };
    let DeValue::Integer(digits) = get(scene, "seed")?.get_ref() else { return None };
    let seed = i64::from_str_radix(digits.as_str(), digits.radix()).ok();
    seed.and_then(|seed| u64::try_from(seed).ok())
}

/// Pass that draws the values of a document.
struct DrawPass<'r, 'i> {
    reader: &'r mut Reader,
    texts: &'i Texts,
    seed: u64,
    attempt: u32,
    /// Number of the extreme case to use instead of random values; see [`Draw::Extreme`].
    extreme: Option<usize>,
    drawn: Vec<Drawn>,
    /// Drawn values by their paths.
    values: BTreeMap<String, DeValue<'i>>,
    /// References `same_as`, by the paths at which they are written. Each has the path that it names, and its range of
    /// bytes in the text.
    references: BTreeMap<String, (String, Range<usize>)>,
    paths: BTreeMap<String, Vec<String>>,
}

impl<'i> DrawPass<'_, 'i> {
    fn draw_table(&mut self, table: DeTable<'i>, path: &str) -> DeTable<'i> {
        let mut result = DeTable::new();
        for (key, value) in table {
            let path = join(path, key.get_ref());
            result.insert(key, self.draw_value(value, &path));
        }
        result
    }

    fn draw_value(&mut self, value: Spanned<DeValue<'i>>, path: &str) -> Spanned<DeValue<'i>> {
        let span = value.span();
        let new = match value.into_inner() {
            DeValue::Table(table) if is_draw(&table) => self.draw(&table, &span, path),
            // A single `[robot]` is a list with one entry.
            DeValue::Table(table) if LISTS.contains(&path) => {
                let mut items = DeArray::new();
                items.push(Spanned::new(span.clone(), DeValue::Table(table)));
                DeValue::Array(self.draw_items(items, path))
            }
            DeValue::Table(table) => DeValue::Table(self.draw_table(table, path)),
            DeValue::Array(items) => DeValue::Array(self.draw_items(items, path)),
            plain => plain,
        };
        Spanned::new(span, new)
    }

    fn draw_items(&mut self, items: DeArray<'i>, path: &str) -> DeArray<'i> {
        let mut result = DeArray::new();
        let mut names = BTreeSet::new();
        let is_list = LISTS.contains(&path);
        let ids: BTreeSet<i64> = items.iter().filter_map(|item| stated_id(item.get_ref())).collect();
        let mut free_numbers = (1..).filter(|number| !ids.contains(number));
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
            // An entry with a name takes a free number too.
            let number = stated_id(item.get_ref()).or_else(|| free_numbers.next()).unwrap_or_default();
            let entry_path = join(path, &name.map_or_else(|| number.to_string(), str::to_owned));
            match self.repetitions(&item, path, &entry_path) {
                None => {
                    self.paths.entry(path.to_owned()).or_default().push(entry_path.clone());
                    result.push(self.draw_value(item, &entry_path));
                }
                Some((single, count)) => {
                    for number in 1..=count {
                        let copy_path = join(&entry_path, &number.to_string());
                        result.push(self.draw_value(single.clone(), &copy_path));
                        self.paths.entry(path.to_owned()).or_default().push(copy_path);
                    }
                }
            }
        }
        result
    }

    /// The entry without its `count`, and the count; `None` if the entry is not repeated.
    fn repetitions(
        &mut self,
        item: &Spanned<DeValue<'i>>,
        list: &str,
        path: &str,
    ) -> Option<(Spanned<DeValue<'i>>, u32)> {
        let DeValue::Table(table) = item.get_ref() else { return None };
        let count = get(table, "count").filter(|_| LISTS.contains(&list))?;
        let rest = || table.iter().filter(|(key, _)| key.get_ref() != "count");
        // A robot entry with a layout or without draws describes a group and is not repeated.
        let is_drawn = || rest().any(|(_, value)| max_choices_in(value.get_ref()) > 0);
        if list == "robot" && (get(table, "layout").is_some() || !is_drawn()) {
            return None;
        }
        let count = self.draw_value(count.clone(), &join(path, "count"));
        let count = self.reader.as_integer("count", &count, 0, MAX_REPETITIONS).unwrap_or(1);
        let single: DeTable<'i> = rest().map(|(key, value)| (key.clone(), value.clone())).collect();
        Some((Spanned::new(item.span(), DeValue::Table(single)), count as u32))
    }

    /// Value of a draw. If the draw has a mistake, reports it and returns some valid value.
    fn draw(&mut self, table: &DeTable<'i>, span: &Range<usize>, path: &str) -> DeValue<'i> {
        let mut section = Section::root(table);
        section.name = "draw";
        section.span = self.reader.span(span.clone());
        let ways = DRAWS.into_iter().filter(|key| section.has(key)).collect::<Vec<_>>();
        let [key] = ways[..] else {
            let message = format!("a value is drawn by several keys: {}", ways.join(", "));
            self.report(&section, message, "one of uniform, choice, normal, same_as, random_maze");
            return self.float(1.0);
        };
        if path == "scene.seed" {
            self.report(&section, "the seed cannot be drawn from itself".to_owned(), "an integer, or no seed");
            return self.integer(0);
        }
        let mut stream = Stream::new(self.seed, RobotId(0), Purpose::Scene, self.attempt, name_key(path));
        let value = match key {
            "uniform" => self.uniform(&mut section, &mut stream),
            "normal" => self.normal(&mut section, &mut stream),
            "choice" => self.choice(&mut section, &mut stream, path),
            "random_maze" => self.maze(&mut section, &mut stream),
            _ => {
                if let Some(target) = self.reader.text(&mut section, "same_as") {
                    self.references.insert(path.to_owned(), (target, span.clone()));
                }
                Some(self.integer(1))
            }
        };
        self.reader.unknown_keys(&section);
        let Some(value) = value else { return self.float(1.0) };
        if key != "same_as" {
            self.record(path, &value);
        }
        value
    }

    fn integer(&self, number: i64) -> DeValue<'i> {
        self.texts.number(number.to_string())
    }

    fn float(&self, number: f64) -> DeValue<'i> {
        self.texts.number(format!("{number:?}"))
    }

    fn record(&mut self, path: &str, value: &DeValue<'i>) {
        self.drawn.push(Drawn { path: path.to_owned(), value: json(value) });
        self.values.insert(path.to_owned(), value.clone());
    }

    fn report(&mut self, section: &Section<'_, '_>, message: String, expected: &str) {
        self.reader.sink.error(Code::SceneDraw, section.span, message, expected);
    }

    /// Uniformly distributed number between both ends; if both ends are integers, an integer, ends included.
    fn uniform(&mut self, section: &mut Section<'_, '_>, stream: &mut Stream) -> Option<DeValue<'i>> {
        let [low, high] = self.reader.numbers(section, "uniform", &[ANY_NUMBER, ANY_NUMBER])?;
        if low > high {
            let message = format!("`uniform` begins at {low} and ends at {high}");
            self.report(section, message, "the least number first");
            return Some(self.float(low));
        }
        let integer_ends = section.get("uniform").and_then(|value| match value.get_ref() {
            DeValue::Array(ends) if ends.iter().all(|end| end.get_ref().is_integer()) => Some([low, high]),
            _ => None,
        });
        let fraction = match self.extreme {
            Some(number) if number % 2 == 0 => 0.0,
            Some(_) => 1.0,
            None => stream.unit(),
        };
        Some(match integer_ends.map(|ends| ends.map(|end| end as i64)) {
            Some([low, high]) => {
                let count = (i128::from(high) - i128::from(low) + 1) as f64;
                let offset = ((count * fraction).floor() as i128).min(i128::from(high) - i128::from(low));
                self.integer((i128::from(low) + offset) as i64)
            }
            None => self.float(low + (high - low) * fraction),
        })
    }

    /// Normally distributed number, truncated at its limits.
    fn normal(&mut self, section: &mut Section<'_, '_>, stream: &mut Stream) -> Option<DeValue<'i>> {
        let spread = Quantity::number("standard deviation", 0.0, 1e12);
        let [mean, sigma] = self.reader.numbers(section, "normal", &[ANY_NUMBER, spread])?;
        let [min, max] = ["min", "max"].map(|key| (section.has(key), self.reader.number(section, key, &ANY_NUMBER)));
        if [min, max].iter().any(|(is_given, value)| *is_given && value.is_none()) {
            return None;
        }
        let (low, high) = (min.1.unwrap_or(f64::NEG_INFINITY), max.1.unwrap_or(f64::INFINITY));
        if low > high {
            self.report(section, format!("`min` {low} is greater than `max` {high}"), "the least number as `min`");
            return None;
        }
        let sample = match self.extreme {
            Some(number) => {
                let end = if number % 2 == 0 { low } else { high };
                Some(if end.is_finite() { end } else { mean.clamp(low, high) })
            }
            None => (0..MAX_TRIES).map(|_| mean + sigma * stream.normal()).find(|sample| (low..=high).contains(sample)),
        };
        if sample.is_none() {
            let message = format!("of {MAX_TRIES} numbers of this distribution none lies between its `min` and `max`");
            self.report(section, message, "limits within some standard deviations of the mean");
        }
        sample.map(|sample| self.float(sample))
    }

    fn choice(&mut self, section: &mut Section<'_, 'i>, stream: &mut Stream, path: &str) -> Option<DeValue<'i>> {
        let items = self.reader.array(section, "choice", "an array of values")?;
        if items.is_empty() {
            self.report(section, "`choice` has nothing to choose from".to_owned(), "at least one value");
            return None;
        }
        let index = match self.extreme {
            Some(number) => number % items.len(),
            None => ((stream.unit() * items.len() as f64) as usize).min(items.len() - 1),
        };
        Some(self.draw_value(items[index].clone(), path).into_inner())
    }

    fn maze(&mut self, section: &mut Section<'_, '_>, stream: &mut Stream) -> Option<DeValue<'i>> {
        let items = self.reader.array(section, "random_maze", "an array of 2 integers: columns and rows")?;
        let [columns, rows] = items else {
            let message = format!("`random_maze` has {} values", items.len());
            self.report(section, message, "an array of 2 integers: columns and rows");
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

    /// Replaces references with the drawn values that they name.
    fn resolve_table(&mut self, table: DeTable<'i>, path: &str) -> DeTable<'i> {
        let mut result = DeTable::new();
        for (key, value) in table {
            let path = join(path, key.get_ref());
            let value = self.resolve_value(value, &path);
            result.insert(key, value);
        }
        result
    }

    fn resolve_value(&mut self, value: Spanned<DeValue<'i>>, path: &str) -> Spanned<DeValue<'i>> {
        let span = value.span();
        if let Some(found) = self.referenced_value(path) {
            return Spanned::new(span, found);
        }
        let new = match value.into_inner() {
            DeValue::Table(table) => DeValue::Table(self.resolve_table(table, path)),
            DeValue::Array(items) => {
                let paths = self.paths.get(path).cloned().unwrap_or_default();
                let mut result = DeArray::new();
                for (item, path) in items.into_iter().zip(paths) {
                    result.push(self.resolve_value(item, &path));
                }
                DeValue::Array(result)
            }
            plain => plain,
        };
        Spanned::new(span, new)
    }

    /// Drawn value that the reference at `path` names, even through further references; `None` if there is no
    /// reference. Reports a reference that names no drawn value, and returns `None`.
    fn referenced_value(&mut self, path: &str) -> Option<DeValue<'i>> {
        let (mut target, span) = self.references.get(path)?.clone();
        let mut seen = BTreeSet::from([path.to_owned()]);
        while let Some((next, _)) = self.references.get(&target) {
            if !seen.insert(target.clone()) {
                let message = format!("`same_as` leads back to `{target}`");
                let span = self.reader.span(span);
                self.reader.sink.error(Code::SceneDraw, span, message, "the path of a value that is drawn");
                return None;
            }
            target.clone_from(next);
        }
        let value = self.values.get(&target).cloned();
        if let Some(value) = &value {
            self.drawn.push(Drawn { path: path.to_owned(), value: json(value) });
        } else {
            let span = self.reader.span(span);
            let message = format!("no value `{target}` is drawn");
            let expected = "the path of a value that is drawn, as `robot.1.x_mm`: list, name or number, key";
            let suggestion =
                nearest(&target, self.values.keys().map(String::as_str)).map(|path| format!("write `{path}`"));
            self.reader.sink.error(Code::SceneDraw, span, message, expected).suggestion = suggestion;
        }
        value
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
