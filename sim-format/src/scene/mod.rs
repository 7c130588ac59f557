//! Our own TOML format for scenes. It can represent every property of the other formats, and the settings of a run.
//!
//! This module reads the text into the same spec as a sim file; [`super::load_scene`] reads worlds, types and cost
//! tables from separate files.

mod draw;
mod drawing;
mod free_space;
mod labyrinth;
mod reach;

use std::collections::BTreeMap;

use super::code::Code;
use super::diagnostic::Diagnostic;
use super::form::Form;
use super::form::place::MAX_ROBOTS;
use super::set::Setting;
use super::spec::{CostTable, RobotLine, SceneFormat, SimSpec, StartRef};
use super::table::{Reader, Section, has_top_key};
use super::{Span, path};
pub(super) use draw::{DRAWS, Draw};
pub(super) use free_space::FreeSpace;
pub(super) use reach::is_reachable;
use sim_core::RobotId;

/// Suffix of file names that identifies a scene without reading its content.
pub const SCENE_EXTENSION: &str = ".scene.toml";

/// Top-level keys of scenes: a scene has at least one of them, a companion or a cost table has none.
const SCENE_KEYS: [&str; 3] = ["scene", "world", "robot"];

/// Returns true for a TOML file that is a scene, not the companion of a robi or a cost table: its name ends in
/// `.scene.toml`, or it has `scene`, `world` or `robot` at its top level.
pub fn is_scene(path: &str, text: &str) -> bool {
    if path.to_lowercase().ends_with(SCENE_EXTENSION) {
        return true;
    }
    path::extension(path) == "toml" && has_scene_key(text)
}

/// Returns true for a TOML text with a key at its top level that only scenes have.
pub(super) fn has_scene_key(text: &str) -> bool {
    has_top_key(text, &SCENE_KEYS)
}

/// Reads a scene, but none of the files that it refers to (see [`super::load_scene`]).
///
/// Unknown keys give a warning; a value of the wrong type or out of range is an error.
///
/// Random values are drawn with the seed in the scene.
pub fn read_scene(file: &str, text: &str) -> (SimSpec, Vec<Diagnostic>) {
    read_scene_with(file, text, &[], Draw::Seed(None, 0))
}

/// Reads a scene like [`read_scene`], with `settings` that override values of its text, and random values from `draw`.
pub(super) fn read_scene_with(file: &str, text: &str, settings: &[Setting], draw: Draw) -> (SimSpec, Vec<Diagnostic>) {
    let (mut reader, mut root) = Reader::parse(file, text);
    reader.set(&mut root, settings);
    let texts = draw::Texts::default();
    let document = reader.draw(root, draw, &texts);
    let drawn = document.drawn;
    let mut sim = SimSpec { file: file.to_owned(), format: SceneFormat::Toml, drawn, ..SimSpec::default() };
    reader.table(Section::root(&document.root), |keys| sim.keys(keys));
    let paths = |list: &str| document.paths.get(list).cloned().unwrap_or_default();
    sim.robots.iter_mut().zip(paths("robot")).for_each(|(line, path)| line.path = path);
    sim.objects.iter_mut().zip(paths("object")).for_each(|(line, path)| line.path = path);
    sim.wall_paths = paths("world.wall");
    if let Some(world) = &mut sim.inline.world {
        world.objects.iter_mut().zip(paths("world.object")).for_each(|(line, path)| line.path = path);
    }
    (sim, reader.sink.finish())
}

/// Maximum number of choices of a draw in a scene in TOML; 0 if the text has no draws.
pub(super) fn choices(text: &str) -> usize {
    draw::max_choices(&Reader::parse("", text).1)
}

/// Returns true for a TOML file that is a cost table: it has `robios6` or `robios7` at its top level.
pub fn is_costs(path: &str, text: &str) -> bool {
    path::extension(path) == "toml" && has_top_key(text, &["robios6", "robios7"])
}

/// Reads a cost table without checking the names of the functions.
pub fn read_costs(file: &str, text: &str) -> (CostTable, Vec<Diagnostic>) {
    let (mut reader, root) = Reader::parse(file, text);
    let table = CostTable { file: file.to_owned(), ..CostTable::default() };
    let table = reader.form(Section::root(&root), table).unwrap_or_default();
    (table, reader.sink.finish())
}

impl Reader {
    /// Reads the robots of a scene and checks that their numbers are unique.
    pub(crate) fn robots(&mut self, root: &mut Section<'_, '_>, key: &'static str) -> Vec<RobotLine> {
        let (mut count, mut robots) = (0, Vec::new());
        for section in self.sections(root, key) {
            let id_span = self.key_span(&section, "id");
            let mut line = RobotLine::defaults();
            let is_complete = self.table(section, |keys| line.keys(keys));
            count += match line.start {
                StartRef::Many { count, .. } => u64::from(count),
                _ => 1,
            };
            robots.extend(is_complete.then_some((line, id_span)));
        }
        self.check_robot_ids(&mut robots, count);
        if count > u64::from(MAX_ROBOTS) {
            let message = format!("the scene has {count} robots");
            let span = self.key_span(root, key);
            self.sink.error(Code::SceneCount, span, message, format!("at most {MAX_ROBOTS} robots in a scene"));
            robots.clear();
        }
        robots.into_iter().map(|(line, _)| line).collect()
    }

    /// Reports and removes robot numbers that are used twice or exceed `count`, the number of robots. The span is that
    /// of the number.
    fn check_robot_ids(&mut self, robots: &mut [(RobotLine, Span)], count: u64) {
        let mut ids: BTreeMap<RobotId, u32> = BTreeMap::new();
        for (robot, span) in robots {
            let Some(id) = robot.id else { continue };
            let (code, message) = if let Some(line) = ids.get(&id) {
                (Code::RobotIdTwice, format!("the number {} is that of the robot of line {line}", id.0))
            } else if u64::from(id.0) > count {
                (Code::RobotIdGap, format!("the number {} leaves a gap", id.0))
            } else {
                ids.insert(id, span.line);
                continue;
            };
            let expected = format!("robot numbers go from 1 to the number of robots, {count}, each once");
            self.sink.error(code, *span, message, expected);
            robot.id = None;
        }
    }
}
