//! Printing of scenes as `.sim`.

use std::fmt::Write;

use super::LOOKS;
use super::Printed;
use super::number::{heading, written, written_degrees, written_mm};
use crate::path;
use crate::spec::{
    Dialect, Layout, LooksSpec, ObjectLine, RobotLine, RobotSpec, SceneSpec, SimSpec, SpannedText, StartRef, TypeRef,
    WorldKind,
};
use sim_core::RobotId;
use sim_core::pose::Pose;
use sim_core::radio::RadioModel;

/// Text of a sim file. A robot with a program whose type is a file gets a classic line; all other entities get lines of
/// EyeSim VR.
///
/// `scene` must be loaded from `sim`; it provides the robots of groups and the names of types. Inline parts of `sim`
/// are lost unless the caller has moved them to files.
pub fn print_sim(sim: &SimSpec, scene: &SceneSpec) -> Printed {
    let mut printer = Printer { out: Printed::default(), scene, has_letters: true };
    printer.write_sim(sim);
    printer.out
}

struct Printer<'a> {
    out: Printed,
    scene: &'a SceneSpec,
    /// True if the starts of the world may have letters.
    has_letters: bool,
}

/// Returns true if the scene follows the conventions of EyeSim VR of 2018.
fn is_of_2018(sim: &SimSpec) -> bool {
    sim.run.dialect == Some(Dialect::Vr2018)
}

impl Printer<'_> {
    fn write_sim(&mut self, sim: &SimSpec) {
        if let Some(world) = &sim.world {
            let extension = path::extension(&world.path.text);
            // The keyword `maze` is only needed if the extension does not identify a maze.
            let keyword = match world.kind {
                WorldKind::Maze if !matches!(extension.as_str(), "maz" | "maze") => "maze",
                _ => "world",
            };
            let file = self.quoted_word(&world.path.text);
            self.write_line(&[keyword, &file]);
        }
        let settings = [(sim.settings.shows_beams, "VIS"), (sim.settings.shows_trace, "TRACE")];
        let settings: Vec<&str> = settings.into_iter().filter_map(|(shows, word)| shows.then_some(word)).collect();
        if !settings.is_empty() {
            self.write_line(&[&["settings"][..], &settings].concat());
        }
        let robots = self.extra_type_files(sim);
        // Readers recognise the dialect of a sim file by these keywords.
        let [robot, object] = if is_of_2018(sim) { ["robi", "obj"] } else { ["robot", "object"] };
        for path in sim.robot_types.iter().chain(&robots) {
            let file = self.quoted_word(&path.text);
            self.write_line(&[robot, &file]);
        }
        for path in &sim.object_types {
            let file = self.quoted_word(&path.text);
            self.write_line(&[object, &file]);
        }
        self.list_lost_properties(sim);
        // Starts in a `.wld` have no letters.
        self.has_letters = sim.world.as_ref().is_none_or(|line| path::extension(&line.path.text) != "wld");
        self.write_robots(sim);
        sim.objects.iter().for_each(|line| self.write_object(line));
        for marker in &sim.markers {
            let [x, y] = marker.position.to_array().map(written_mm);
            let shades = marker.colour.map(|shade| shade.to_string());
            self.write_line(&["marker", &x, &y, &shades[0], &shades[1], &shades[2], &shades[3]]);
        }
    }

    /// Files of the robot types that need a line of their own, since no classic line names them.
    fn extra_type_files(&self, sim: &SimSpec) -> Vec<SpannedText> {
        let mut files: Vec<SpannedText> = Vec::new();
        for line in &sim.robots {
            if let TypeRef::File(path) = &line.kind
                && !is_classic(line)
                && files.iter().chain(&sim.robot_types).all(|known| known.text != path.text)
            {
                files.push(path.clone());
            }
        }
        files
    }

    /// Lists the settings of the run, and other properties of the scene, that a sim file cannot represent.
    fn list_lost_properties(&mut self, sim: &SimSpec) {
        let run = &sim.run;
        let has_types =
            !self.extra_type_files(sim).is_empty() || !sim.robot_types.is_empty() || !sim.object_types.is_empty();
        let has_names =
            sim.robots.iter().any(|line| line.name.is_some()) || sim.objects.iter().any(|line| line.name.is_some());
        let lost_properties = [
            (sim.world.as_ref().is_some_and(|line| line.looks != LooksSpec::default()), LOOKS),
            (run.seed.is_some(), "the seed"),
            (run.slot.is_some(), "the length of a slot"),
            (run.until.is_some(), "the end of the run"),
            (run.costs.is_some(), "the cost table"),
            (!run.forbid.is_empty(), "the forbidden functions"),
            (run.api.is_some(), "the generation of the API"),
            (is_of_2018(sim) && !has_types, "the dialect"),
            (sim.world.as_ref().is_some_and(|line| line.cell.is_some()), "the size of the maze's cells"),
            (run.noise.is_some(), "the noise profile"),
            (sim.radio != RadioModel::default(), "the radio"),
            (!sim.checks.is_empty(), "the checks"),
            (!sim.faults.is_empty(), "the faults"),
            (!sim.reachable.is_empty(), "the required routes"),
            (run.contact.is_some(), "the contact of robots with walls"),
            (run.wall_friction.is_some(), "the friction of the walls"),
            (has_names, "the names of robots and objects"),
            (sim.inline.world.is_some(), "the inline world"),
            (!sim.inline.robot_types.is_empty(), "inline robot types"),
            (!sim.inline.object_types.is_empty(), "inline object types"),
        ];
        self.out.lost.extend(
            lost_properties.into_iter().filter(|(is_lost, _)| *is_lost).map(|(_, property)| property.to_owned()),
        );
    }

    /// Adds the lines of the robots in the order of their numbers: in a sim file the order of the lines determines the
    /// numbers.
    fn write_robots(&mut self, sim: &SimSpec) {
        let lines = || sim.robots.iter().chain(&sim.named);
        // Robots of a `starts` layout are printed with poses, so other robots would take their starts.
        let takes_starts = |line: &RobotLine| matches!(line.start, StartRef::Many { layout: Layout::Starts, .. });
        let are_starts_taken = lines().any(takes_starts);
        let mut robots: Vec<(RobotId, String)> =
            lines().flat_map(|line| self.robot_lines(line, are_starts_taken)).collect();
        robots.sort_by_key(|(id, _)| *id);
        robots.iter().for_each(|(_, line)| self.write_line(&[line]));
    }

    /// Lines of the robots that one entry of the scene describes, with their numbers.
    fn robot_lines(&mut self, line: &RobotLine, are_starts_taken: bool) -> Vec<(RobotId, String)> {
        let robots: Vec<&RobotSpec> = self.scene.robots.iter().filter(|robot| robot.span == line.span).collect();
        let name = robots.first().map_or_else(|| "a robot".to_owned(), |robot| robot.id.to_string());
        if let StartRef::Many { count, .. } = line.start {
            self.out
                .lost
                .push(format!("that {count} robots of line {} are a group: each has its own line", line.span.line));
        }
        if !line.arguments.is_empty() {
            self.out.lost.push(format!("the arguments of {name}"));
        }
        if line.noise.is_some() {
            self.out.lost.push(format!("the noise profile of {name}"));
        }
        if let Some(api) = line.api {
            self.out.lost.push(format!("that the program of {name} is written for RoBIOS {api}"));
        }
        let program = line.program.as_ref().map(|program| self.quoted_word(&program.text));
        let first = match &line.kind {
            TypeRef::File(file) if is_classic(line) => vec!["robi".to_owned(), self.quoted_word(&file.text)],
            TypeRef::Name(name) => vec![self.quoted_word(&name.text)],
            TypeRef::File(_) => robots.first().map(|robot| self.quoted_word(&robot.robi.name)).into_iter().collect(),
        };
        let robot_line = |robot: &&RobotSpec| {
            let start = match line.start {
                StartRef::Next if is_classic(line) && !are_starts_taken => Vec::new(),
                StartRef::Letter { letter, heading } if self.has_letters => {
                    [letter.to_string()].into_iter().chain(heading.map(written_degrees)).collect()
                }
                _ => pose(&robot.start).to_vec(),
            };
            let words = match is_classic(line) {
                true => [first.as_slice(), program.as_slice(), &start].concat(),
                false => [first.as_slice(), &start, program.as_slice()].concat(),
            };
            (robot.id, words.join(" "))
        };
        robots.iter().map(robot_line).collect()
    }

    fn write_object(&mut self, line: &ObjectLine) {
        let [x, y, phi] = pose(&line.pose);
        match (&line.kind, line.friction) {
            (TypeRef::File(file), friction) => {
                let scene_object = self.scene.objects.iter().find(|object| object.span == line.span);
                let friction = friction.or(scene_object.map(|object| object.friction)).unwrap_or_default();
                let file = self.quoted_word(&file.text);
                self.write_line(&["object", &x, &y, &phi, &written(friction), &file]);
            }
            (TypeRef::Name(name), friction) => {
                if friction.is_some() {
                    self.out.lost.push(format!("the friction of the `{}` in line {}", name.text, line.span.line));
                }
                let name = self.quoted_word(&name.text);
                self.write_line(&[&name, &x, &y, &phi]);
            }
        }
    }

    /// Word of a line, quoted if necessary.
    fn quoted_word(&mut self, text: &str) -> String {
        let word = quoted(text);
        word.unwrap_or_else(|| {
            self.out.lost.push(format!("the quotation marks in `{text}`"));
            format!("\"{}\"", text.replace('"', "").replace(['\n', '\r'], " "))
        })
    }

    fn write_line(&mut self, words: &[&str]) {
        let _ = writeln!(self.out.text, "{}", words.join(" "));
    }
}

/// Returns true for a line that `robi FILE PROGRAM [X Y PHI]` can represent.
pub(crate) fn is_classic(line: &RobotLine) -> bool {
    matches!(line.kind, TypeRef::File(_)) && line.program.is_some() && !matches!(line.start, StartRef::Letter { .. })
}

fn pose(pose: &Pose) -> [String; 3] {
    [written_mm(pose.position.x), written_mm(pose.position.y), written(heading(pose.heading))]
}

/// Quotes a word for the line formats if necessary; `None` if no kind of quotes can represent it.
pub(super) fn quoted(text: &str) -> Option<String> {
    if text.contains(['\n', '\r']) {
        return None;
    }
    let needs_quotes = text.is_empty()
        || text.starts_with('#')
        || text.contains(|c: char| c.is_whitespace() || matches!(c, '"' | '\'' | ';'));
    match text {
        text if !needs_quotes => Some(text.to_owned()),
        text if !text.contains('"') => Some(format!("\"{text}\"")),
        text if !text.contains('\'') => Some(format!("'{text}'")),
        _ => None,
    }
}
