//! Our own form of a scene, in TOML: it says everything that the other forms say together, and what a run needs besides.
//!
//! This room turns its text into the same spec as a sim file; worlds, types and cost tables in files of their own are
//! read by [`super::load_scene`].

pub(super) mod form;
mod looks;
mod place;
mod radio;
mod room;
mod terrain;
mod types;
mod world;

use std::collections::{BTreeMap, BTreeSet};

use toml::de::{DeTable, DeValue};

use super::code::Code;
use super::diagnostic::Diagnostic;
use super::line::Quantity;
use super::spec::{CostEntry, CostTable, CostsRef, MarkerSpec, PathRef, RobotLine, SceneForm, SimSpec, TypeRef};
use super::table::{Reader, Section, has_top_key};
use super::{Span, path};
use place::MAX_ROBOTS;
pub(super) use room::Room;
use sim_core::RobotId;
use sim_core::time::Time;
pub(super) use types::default_wheelbase;

/// Ending of the names of scenes that need no look at their content.
pub const SCENE_EXTENSION: &str = ".scene.toml";

/// Keys of which a scene has one at least, and no companion or cost table any.
const MARKS: [&str; 3] = ["scene", "world", "robot"];

/// Generations of the API that a cost table may have a section for.
const GENERATIONS: [&str; 2] = ["robios6", "robios7"];

/// Greatest cost of a call: an hour, in microseconds.
const MAX_COST_US: i64 = 3_600_000_000;

/// Longest slot: an hour, in milliseconds; longest run: 31 years, in seconds.
const MAX_SLOT_MS: f64 = 3.6e6;
const MAX_UNTIL_S: f64 = 1e9;

/// Colour of a marker that does not say: red, opaque, as in sim files.
const MARKER_COLOUR: [u8; 3] = [255, 0, 0];

/// True for a TOML file that is a scene, not the companion of a robi or a cost table: its name ends in `.scene.toml`, or it
/// has `scene`, `world` or `robot` at its top level.
pub fn is_scene(path: &str, text: &str) -> bool {
    if path.to_lowercase().ends_with(SCENE_EXTENSION) {
        return true;
    }
    path::extension(path) == "toml" && has_marks(text)
}

/// True for a TOML text with what only a scene has at its top level.
pub(super) fn has_marks(text: &str) -> bool {
    has_top_key(text, &MARKS)
}

/// Reads a scene, and none of the files that it names (that is [`super::load_scene`]).
///
/// Unknown keys are warned about; a value of the wrong type or out of range is an error.
pub fn read_scene(file: &str, text: &str) -> (SimSpec, Vec<Diagnostic>) {
    let (mut reader, root) = Reader::parse(file, text);
    let mut sim = SimSpec { file: file.to_owned(), form: SceneForm::Toml, ..SimSpec::default() };
    reader.scene(&root, &mut sim);
    (sim, reader.sink.finish())
}

/// Reads a cost table. Whether there are functions of the names that it gives is not known here.
pub fn read_costs(file: &str, text: &str) -> (CostTable, Vec<Diagnostic>) {
    let (mut reader, root) = Reader::parse(file, text);
    let entries = reader.generations(Section::root(&root));
    (CostTable { file: file.to_owned(), entries }, reader.sink.finish())
}

impl Reader<'_> {
    fn scene(&mut self, table: &DeTable<'_>, sim: &mut SimSpec) {
        let mut root = Section::root(table);
        if let Some(section) = self.section(&mut root, "scene") {
            self.run(section, sim);
        }
        if !root.has("world") {
            self.missing(&root, "world");
        }
        if let Some(section) = self.section(&mut root, "world") {
            self.world(section, sim);
        }
        if let Some(section) = self.section(&mut root, "settings") {
            self.settings(section, sim);
        }
        if let Some(section) = self.section_like(&mut root, "radio", "medium = \"aloha\", baud = 9600") {
            sim.radio = self.radio(section);
        }
        let mut names = BTreeSet::new();
        for section in self.sections(&mut root, "robot_type") {
            self.robot_type(section, &mut names, sim);
        }
        for section in self.sections(&mut root, "object_type") {
            self.object_type(section, &mut names, sim);
        }
        let mut count = 0;
        let mut robots = Vec::new();
        for section in self.sections(&mut root, "robot") {
            let id_span = self.key_span(&section, "id");
            let (line, standing) = self.robot(section, &sim.file);
            robots.extend(line.map(|line| (line, id_span)));
            count += u64::from(standing);
        }
        self.robot_ids(&mut robots, count);
        sim.robots = robots.into_iter().map(|(line, _)| line).collect();
        if count > u64::from(MAX_ROBOTS) {
            let message = format!("the scene has {count} robots");
            let span = self.key_span(&root, "robot");
            self.sink.error(Code::SceneCount, span, message, format!("at most {MAX_ROBOTS} robots in a scene"));
            sim.robots.clear();
        }
        for section in self.sections(&mut root, "object") {
            sim.objects.extend(self.object(section));
        }
        for section in self.sections(&mut root, "marker") {
            sim.markers.extend(self.marker(section));
        }
        self.unknown_keys(&root);
    }

    /// Takes the numbers from those of `count` robots that cannot have them; with each robot comes the place of its number.
    fn robot_ids(&mut self, robots: &mut [(RobotLine, Span)], count: u64) {
        let mut given: BTreeMap<RobotId, u32> = BTreeMap::new();
        for (robot, span) in robots {
            let Some(id) = robot.id else { continue };
            let (code, message) = if let Some(line) = given.get(&id) {
                (Code::RobotIdTwice, format!("the number {} is that of the robot of line {line}", id.0))
            } else if u64::from(id.0) > count {
                (Code::RobotIdGap, format!("the number {} leaves a gap", id.0))
            } else {
                given.insert(id, span.line);
                continue;
            };
            let expected = format!("robot numbers go from 1 to the number of robots, {count}, each once");
            self.sink.error(code, *span, message, expected);
            robot.id = None;
        }
    }

    fn run(&mut self, mut section: Section<'_, '_>, sim: &mut SimSpec) {
        sim.run.seed = self.integer(&mut section, "seed", 0, i64::MAX).map(i64::unsigned_abs);
        let slot = Quantity::milliseconds("length of a slot").within(1e-3, MAX_SLOT_MS);
        let until = Quantity::seconds("end of the run").within(1e-6, MAX_UNTIL_S);
        sim.run.slot = self.whole_micros(&mut section, "slot_ms", &slot);
        sim.run.until = self.number(&mut section, "until_s", &until).map(Time::from_seconds_ceil);
        let is_table = section.get("costs").is_some_and(|value| matches!(value.get_ref(), DeValue::Table(_)));
        sim.run.costs = if is_table {
            let table = self.section(&mut section, "costs").map(|section| self.generations(section));
            table.map(|entries| CostsRef::Table(CostTable { file: sim.file.clone(), entries }))
        } else {
            self.reference(&mut section, "costs").map(CostsRef::File)
        };
        sim.run.api = self.api(&mut section);
        sim.run.noise = self.noise_ref(&mut section, &sim.file);
        self.unknown_keys(&section);
    }

    /// A generation of the RoBIOS API.
    fn api(&mut self, section: &mut Section<'_, '_>) -> Option<u32> {
        self.integer(section, "api", 6, 7).map(|api| api as u32)
    }

    /// A span of time that is a whole number of microseconds.
    fn whole_micros(&mut self, section: &mut Section<'_, '_>, key: &'static str, quantity: &Quantity) -> Option<Time> {
        let seconds = self.number(section, key, quantity)?;
        let micros = (seconds * 1e6).round();
        // Closer than any decimal of a ms that is meant as something else.
        if (seconds * 1e6 - micros).abs() > 1e-5 {
            let span = self.key_span(section, key);
            let message = format!("{} `{}` ms is no whole number of microseconds", quantity.name, seconds * 1e3);
            self.sink.error(Code::NumberRange, span, message, "a multiple of 0.001");
            return None;
        }
        Some(Time(micros as i64))
    }

    /// The sections of a cost table.
    fn generations(&mut self, mut section: Section<'_, '_>) -> Vec<CostEntry> {
        let mut entries = Vec::new();
        for generation in GENERATIONS {
            let Some(section) = self.section(&mut section, generation) else { continue };
            for (function, cost) in section.table {
                if let Some(micros) = self.as_integer(function.get_ref(), cost, 1, MAX_COST_US) {
                    let (generation, function_name) = (generation.to_owned(), function.get_ref().to_string());
                    let span = self.span(function.span());
                    entries.push(CostEntry { generation, function: function_name, cost: Time(micros), span });
                }
            }
        }
        self.unknown_keys(&section);
        entries.sort_by_key(|entry| entry.span);
        entries
    }

    fn settings(&mut self, mut section: Section<'_, '_>, sim: &mut SimSpec) {
        sim.settings.shows_beams = self.flag(&mut section, "beams").unwrap_or_default();
        sim.settings.shows_trace = self.flag(&mut section, "trace").unwrap_or_default();
        self.unknown_keys(&section);
    }

    fn marker(&mut self, mut section: Section<'_, '_>) -> Option<MarkerSpec> {
        let x = self.required(&mut section, "x_mm", &Quantity::coordinate("x"));
        let y = self.required(&mut section, "y_mm", &Quantity::coordinate("y"));
        let [red, green, blue] = self.shades(&mut section, "colour").unwrap_or(MARKER_COLOUR);
        let opacity = self.integer(&mut section, "opacity", 0, 255).map_or(255, |opacity| opacity as u8);
        self.unknown_keys(&section);
        let position = (x?, y?).into();
        Some(MarkerSpec { position, colour: [red, green, blue, opacity], span: section.span })
    }
}

/// What stands for the file of the type `name` that the scene `file` describes: no two types have the same.
fn inline_file(file: &str, name: &str) -> String {
    format!("{file}#{}", name.replace(['/', '\\'], "_"))
}

/// What a name in a scene means: a file where it ends as such files do, else the name of a type.
fn type_ref(reference: PathRef, extensions: &[&str]) -> TypeRef {
    if extensions.contains(&path::extension(&reference.text).as_str()) {
        TypeRef::File(reference)
    } else {
        TypeRef::Name(reference)
    }
}
