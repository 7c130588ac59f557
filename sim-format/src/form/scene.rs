//! Scenes: settings of the run, types, robots and other content.

use std::collections::BTreeSet;

use serde_json::{Value as Json, json};
use toml::Value;
use toml::de::DeValue;

use super::device::sorted_table;
use super::kind::{
    Bounded, Custom, Kind, ReadContext, TABLE, TABLES, TEXT, TableWithExample, Word, Words, integer_schema,
};
use super::noise::NOISE;
use super::suite::REFERENCES;
use super::world::WorldTable;
use super::{Definitions, Form, Keys, definition, print};
use crate::Span;
use crate::code::Code;
use crate::line::Quantity;
use crate::print::number::shortest;
use crate::spec::{
    ContactKind, CostEntry, CostTable, CostsRef, Dialect, RobotLine, RunSpec, Settings, SimSpec, SpannedText,
};
use crate::table::{Reader, Section};
use sim_core::radio::{Medium, RadioModel};
use sim_core::time::Time;

/// Maximum cost of a call: an hour, in microseconds.
const MAX_COST_US: i64 = 3_600_000_000;
/// Longest slot: an hour, in milliseconds.
const MAX_SLOT_MS: f64 = 3.6e6;
/// Longest run: 31 years, in seconds.
const MAX_UNTIL_S: f64 = 1e9;
/// Maximum baud rate of the radio, bits per second.
const MAX_BAUD: i64 = 1_000_000_000;

impl Form for SimSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form(
            "SceneFormat",
            "A scene of eyesim: a world, robots with their programs, objects, and settings of the run.",
        );
        keys.key("scene", "Settings of the run; the command line overrides them.").optional(TABLE, &mut self.run);
        let mut world = WorldTable::from_sim(self);
        keys.key("world", "The world: a file, or an inline description by walls or by the drawing of a maze.")
            .required(TABLE, &mut world);
        if keys.reading().is_some() {
            world.store_in(self);
        }
        keys.key("settings", "Settings of EyeSim's window, without effect.").optional(TABLE, &mut self.settings);
        keys.key("radio", "Medium of the messages between robots.")
            .optional(TableWithExample("medium = \"aloha\", baud = 9600"), &mut self.radio);
        type_and_robot_keys(keys, self);
        keys.key("object", "Passive objects.").list(TABLES, &mut self.objects);
        keys.key("marker", "Flat spots of colour on the floor.").list(TABLES, &mut self.markers);
        keys.key("fault", "Injected faults.").list(TABLES, &mut self.faults);
        keys.key("reachable", "Requirements that routes lead from one place to another.")
            .list(TABLES, &mut self.reachable);
        keys.key("check", "Conditions that a run must meet.").list(TABLES, &mut self.checks);
    }
}

impl Form for RunSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("RunForm", "Settings of the run of a scene.");
        keys.key("seed", "Seed of all random numbers; default: 0.").nullable(SEED, &mut self.seed);
        let slot = Quantity::milliseconds("length of a slot").within(1e-3, MAX_SLOT_MS);
        keys.key("slot_ms", "Length of a time slot in milliseconds, a multiple of 0.001; default: 50.")
            .nullable(WholeMicros(slot), &mut self.slot);
        keys.key("until_s", "Simulated seconds at which the run ends; default: 600.").nullable(UNTIL, &mut self.until);
        keys.key("costs", "Virtual time that RoBIOS calls take: a file, or a table for each generation of the API.")
            .nullable(COSTS, &mut self.costs);
        keys.key(
            "forbid",
            "Functions of RoBIOS that fail for all programs: names, in which `*` stands for any letters.",
        )
        .list(REFERENCES, &mut self.forbid);
        keys.key(
            "api",
            "Generation of the RoBIOS API that programs are written for, 6 or 7; default: from the functions that they call.",
        )
        .nullable(6..=7, &mut self.api);
        keys.key(
            "dialect",
            "Version of EyeSim whose conventions the scene and its programs follow; default: `vr2023`.",
        )
        .nullable(Word, &mut self.dialect);
        keys.key(
            "noise",
            "Errors of devices and drives: `none` (default), `mild`, `real`, `harsh`, `course`, a file, or an inline profile.",
        )
        .nullable(NOISE, &mut self.noise);
        keys.key("contact", "Motion of a robot that is pushed against a wall; default: `slide`.")
            .nullable(Word, &mut self.contact);
        keys.key("wall_friction", "Coefficient of friction of the walls; between a robot and a wall, the lower coefficient applies; default: the robot's value.")
            .nullable(Bounded(Quantity::number("friction of the walls", 0.0, 100.0)), &mut self.wall_friction);
    }
}

/// Seed, at most 2^63 - 1 as every TOML integer.
const SEED: Custom<u64> = Custom {
    read: |context| context.reader.integer(context.section, context.key, 0, i64::MAX).map(i64::unsigned_abs),
    print: |seed| (*seed as i64).into(),
    describe: |_| json!({ "type": "integer", "format": "int64", "minimum": 0 }),
};

/// Duration in whole microseconds.
struct WholeMicros(Quantity);

impl Kind<Time> for WholeMicros {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&Time>) -> Option<Time> {
        let ReadContext { reader, section, key } = context;
        let seconds = reader.number(section, key, &self.0)?;
        let micros = (seconds * 1e6).round();
        // The tolerance allows for rounding errors; any decimal fraction of a microsecond in the file is larger.
        if (seconds * 1e6 - micros).abs() > 1e-5 {
            let span = reader.key_span(section, key);
            let message = format!("{} `{}` ms is not a whole number of microseconds", self.0.name, seconds * 1e3);
            reader.sink.error(Code::NumberRange, span, message, "a multiple of 0.001");
            return None;
        }
        Some(Time(micros as i64))
    }

    fn print(&self, time: &Time) -> Value {
        shortest(time.0 as f64 / 1e3, |ms| (ms * 1e3).round() as i64 == time.0).into()
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        Bounded(self.0).describe(definitions)
    }
}

const RUN_END: Bounded = Bounded(Quantity::seconds("end of the run").within(1e-6, MAX_UNTIL_S));

/// The end of a run, in seconds.
pub(crate) const UNTIL: Custom<Time> = Custom {
    read: |context| RUN_END.read(context, None).map(Time::from_seconds_ceil),
    print: |time| shortest(time.0 as f64 / 1e6, |seconds| Time::from_seconds_ceil(seconds) == *time).into(),
    describe: |definitions| RUN_END.describe(definitions),
};

/// Cost table: a file, or inline.
const COSTS: Custom<CostsRef> = Custom {
    read: |context| {
        let ReadContext { reader, section, key } = context;
        if !section.get(key).is_some_and(|value| matches!(value.get_ref(), DeValue::Table(_))) {
            return reader.reference(section, key).map(CostsRef::File);
        }
        let table = CostTable { file: reader.sink.file().to_owned(), ..CostTable::default() };
        let part = reader.section(section, key)?;
        reader.form(part, table).map(CostsRef::Table)
    },
    print: |costs| match costs {
        CostsRef::File(path) => TEXT.print(path),
        CostsRef::Table(table) => print(table).into(),
    },
    describe: |definitions| {
        definition(definitions, "CostsForm", |definitions| {
            let mut table = Kind::<CostTable>::describe(&TABLE, definitions);
            table["description"] = "Inline table.".into();
            let file = json!({ "description": "A file.", "type": "string" });
            json!({ "description": "A cost table.", "anyOf": [file, table] })
        })
    },
};

impl Words for Dialect {
    const NAME: &'static str = "DialectForm";
    const ABOUT: &'static str = "Version of EyeSim whose conventions a scene and its programs follow.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (
            Dialect::Classic,
            "classic",
            "EyeSim 5 and 6: programs use RoBIOS 6 if their calls do not determine the generation.",
        ),
        (
            Dialect::Vr2018,
            "vr2018",
            "EyeSim VR of 2017 and 2018: headings of the SIM functions count from y; the size of a maze's cells is on the last line.",
        ),
        (
            Dialect::Vr2023,
            "vr2023",
            "Later EyeSim VR: programs use RoBIOS-7 if their calls do not determine the generation.",
        ),
    ];
}

impl Words for ContactKind {
    const NAME: &'static str = "ContactForm";
    const ABOUT: &'static str = "Motion of a robot that is pushed against a wall.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (ContactKind::Slide, "slide", "It slides outside the friction cone, and its wheels slip over the floor."),
        (ContactKind::Stall, "stall", "It rests, its wheels stall, and the command stays in force."),
    ];
}

impl Form for CostTable {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("GenerationsForm", "An inline cost table: microseconds per call, by the name of a function or by a prefix of names followed by `*`.");
        keys.key("robios6", "RoBIOS 6.").list(GenerationCosts("robios6"), &mut self.entries);
        keys.key("robios7", "RoBIOS 7.").list(GenerationCosts("robios7"), &mut self.entries);
        self.entries.sort_by_key(|entry| entry.span);
    }
}

/// Costs of one generation of the API.
struct GenerationCosts(&'static str);

impl Kind<Vec<CostEntry>> for GenerationCosts {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&Vec<CostEntry>>) -> Option<Vec<CostEntry>> {
        let mut entries = Vec::new();
        for (function, cost) in context.reader.section(context.section, context.key)?.table {
            if let Some(micros) = context.reader.as_integer(function.get_ref(), cost, 1, MAX_COST_US) {
                let (generation, name) = (self.0.to_owned(), function.get_ref().to_string());
                let span = context.reader.span(function.span());
                entries.push(CostEntry { generation, function: name, cost: Time(micros), span });
            }
        }
        Some(entries)
    }

    fn print(&self, entries: &Vec<CostEntry>) -> Value {
        let of_generation = entries.iter().filter(|entry| entry.generation == self.0);
        sorted_table(of_generation.map(|entry| (entry.function.clone(), entry.cost.0.into())))
    }

    fn describe(&self, _: &mut Definitions) -> Json {
        json!({ "type": "object", "additionalProperties": integer_schema::<u32>() })
    }
}

impl Form for Settings {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("SettingsForm", "Settings of EyeSim's window, without effect.");
        keys.key("beams", "`VIS` of sim files, without effect: the window shows beams anyway; default: false.")
            .flag(&mut self.shows_beams);
        keys.key("trace", "`TRACE` of sim files, without effect: the window shows paths anyway; default: false.")
            .flag(&mut self.shows_trace);
    }
}

impl Form for RadioModel {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("RadioForm", "Medium of the messages between robots.");
        keys.key("medium", "Access of the robots to the medium; default: `free`.").optional(Word, &mut self.medium);
        keys.key("baud", "Baud rate, bits per second, ten bits per byte; default: 115200.")
            .optional(1..=MAX_BAUD, &mut self.baud);
        keys.key(
            "latency_ms",
            "Time from the end of a transmission to its arrival in milliseconds, a multiple of 0.001; default: 0.",
        )
        .optional(WholeMicros(Quantity::milliseconds("latency")), &mut self.latency);
        keys.key("range_mm", "Maximum distance at which a message is received, in mm; default: unlimited.")
            .nullable(Bounded(Quantity::size("range")), &mut self.range);
        keys.key("line_of_sight", "Walls block messages; default: false.").flag(&mut self.line_of_sight);
    }
}

impl Words for Medium {
    const NAME: &'static str = "MediumForm";
    const ABOUT: &'static str = "Access of the robots to the radio medium.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Medium::Free, "free", "Nobody disturbs anybody."),
        (Medium::Aloha, "aloha", "Messages that overlap at a receiver are lost."),
        (Medium::TokenRing, "token_ring", "Only the station that has the token sends."),
    ];
}

/// Entry of a type in a scene.
enum TypeEntry<F> {
    File(SpannedText),
    /// Inline type, with the spans of its table and of its name.
    Inline(F, Span, Span),
}

/// Array of type entries.
struct TypeEntries;

impl<F: Form> Kind<Vec<TypeEntry<F>>> for TypeEntries {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&Vec<TypeEntry<F>>>) -> Option<Vec<TypeEntry<F>>> {
        let sections = context.reader.sections(context.section, context.key);
        Some(sections.into_iter().filter_map(|section| context.reader.type_entry(section)).collect())
    }

    fn print(&self, types: &Vec<TypeEntry<F>>) -> Value {
        let entry = |entry: &TypeEntry<F>| match entry {
            TypeEntry::File(path) => sorted_table([("file".to_owned(), TEXT.print(path))].into_iter()),
            TypeEntry::Inline(form, ..) => print(form).into(),
        };
        Value::Array(types.iter().map(entry).collect())
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        Kind::<Vec<F>>::describe(&TABLES, definitions)
    }
}

impl Reader {
    fn type_entry<F: Form>(&mut self, mut section: Section<'_, '_>) -> Option<TypeEntry<F>> {
        if section.has("file") {
            let path = self.reference(&mut section, "file");
            self.reject_other_keys(&section);
            return path.map(TypeEntry::File);
        }
        let (span, name) = (section.span, self.value_span(&section, "name"));
        self.form(section, F::defaults()).map(|form| TypeEntry::Inline(form, span, name))
    }

    /// Reports keys beside `file`.
    fn reject_other_keys(&mut self, section: &Section<'_, '_>) {
        for (key, _) in section.table {
            if key.get_ref() != "file" {
                let span = self.span(key.span());
                let message = format!("`{}` and `file` exclude each other", key.get_ref());
                self.sink.error(Code::TomlConflict, span, message, "either `file` alone or an inline type");
            }
        }
    }

    /// Appends the files to `files` and returns the inline types; reports and drops a type with the name of an earlier
    /// type.
    fn split_types<F>(
        &mut self,
        types: Vec<TypeEntry<F>>,
        name_and_file: fn(&mut F) -> (&str, &mut String),
        names: &mut BTreeSet<String>,
        files: &mut Vec<SpannedText>,
    ) -> Vec<(F, Span)> {
        let mut inline = Vec::new();
        for entry in types {
            match entry {
                TypeEntry::File(path) => files.push(path),
                TypeEntry::Inline(mut form, span, name_span) => {
                    let (name, file) = name_and_file(&mut form);
                    if names.insert(name.to_owned()) {
                        // This makes the file name of each inline type unique.
                        *file = format!("{}#{}", self.sink.file(), name.replace(['/', '\\'], "_"));
                        inline.push((form, span));
                    } else {
                        let message = format!("a second type named `{name}`; it is left out");
                        self.sink.warn(Code::SimTypeTwice, name_span, message, "each name once");
                    }
                }
            }
        }
        inline
    }
}

/// Entries of all types, those with a file first.
fn entries<F: Clone>(files: &[SpannedText], inline: &[(F, Span)]) -> Vec<TypeEntry<F>> {
    let files = files.iter().cloned().map(TypeEntry::File);
    files.chain(inline.iter().map(|(form, span)| TypeEntry::Inline(form.clone(), *span, Span::default()))).collect()
}

/// Declares robot types, object types and robots.
fn type_and_robot_keys(keys: &mut Keys<'_>, sim: &mut SimSpec) {
    let mut robot_types = entries(&sim.robot_types, &sim.inline.robot_types);
    let mut object_types = entries(&sim.object_types, &sim.inline.object_types);
    keys.key("robot_type", "Robot types: files, or inline descriptions.").list(TypeEntries, &mut robot_types);
    keys.key("object_type", "Object types: files, or inline descriptions.").list(TypeEntries, &mut object_types);
    let mut lines: Vec<RobotLine> = sim.robots.iter().chain(&sim.named).cloned().collect();
    if let Some((reader, section)) = keys.reading() {
        let mut names = BTreeSet::new();
        sim.inline.robot_types =
            reader.split_types(robot_types, |robi| (&robi.name, &mut robi.file), &mut names, &mut sim.robot_types);
        sim.inline.object_types = reader.split_types(
            object_types,
            |object| (&object.name, &mut object.file),
            &mut names,
            &mut sim.object_types,
        );
        sim.robots = reader.robots(section, "robot");
    } else {
        keys.key("robot", "Robots, alone and in groups; those without an `id` are numbered 1, 2, ... in this order.")
            .list(TABLES, &mut lines);
    }
}
