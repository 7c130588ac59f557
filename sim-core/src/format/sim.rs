//! Scenes: `.sim`, the world and the robots with their programs.

use super::code::Code;
use super::diagnostic::{Diagnostic, Severity, Sink};
use super::line::{self, Quantity, Word};
use super::path;
use super::spec::{ObjectLine, RobotLine, SimSpec, StartRef, TypeRef, WorldKind, WorldLine};
use crate::pose::Pose;

const KEYWORDS: [&str; 4] = ["world", "maze", "robi", "object"];
/// First words of lines that EyeSim VR knows.
const VR_KEYWORDS: [&str; 10] =
    ["settings", "obj", "robot", "labbot", "s4", "can", "soccer", "crate", "golf", "marker"];
/// Those that place a robot.
const VR_ROBOTS: [&str; 2] = ["labbot", "s4"];

/// Reads a sim file, and none of the files that it names (that is [`super::load_sim`]).
pub fn read_sim(file: &str, text: &str) -> (SimSpec, Vec<Diagnostic>) {
    let mut reader = Reader {
        sink: Sink::new(file),
        sim: SimSpec { file: file.to_owned(), ..SimSpec::default() },
        loaded: Vec::new(),
    };
    for line in line::lines(text) {
        let words = line.words();
        if let Some((first, rest)) = words.split_first() {
            reader.line(first, rest);
        }
    }
    (reader.sim, reader.sink.finish())
}

struct Reader {
    sink: Sink,
    sim: SimSpec,
    /// Names of types that lines of EyeSim VR load, in lower case, and whether they are robots.
    loaded: Vec<(String, bool)>,
}

impl Reader {
    fn line(&mut self, first: &Word<'_>, rest: &[Word<'_>]) {
        let keyword = first.text.to_lowercase();
        match keyword.as_str() {
            "world" => self.world(first, rest, WorldKind::World),
            "maze" => self.world(first, rest, WorldKind::Maze),
            "robi" if rest.len() == 1 => self.vr(first, rest),
            "robi" => self.robi(first, rest),
            "object" if rest.len() == 1 => self.vr(first, rest),
            "object" => self.object(first, rest),
            word if VR_KEYWORDS.contains(&word) || self.loaded.iter().any(|(name, _)| name == word) => {
                self.vr(first, rest)
            }
            _ => self.unknown(first),
        }
    }

    fn world(&mut self, keyword: &Word<'_>, rest: &[Word<'_>], kind: WorldKind) {
        let form = "`world FILE.wld` or `maze FILE.maz`";
        let Some(path) = path::reference(&mut self.sink, Severity::Error, keyword, rest, form) else {
            return;
        };
        let kind = match path::extension(&path.text).as_str() {
            "wld" => WorldKind::World,
            "maz" | "maze" => WorldKind::Maze,
            _ => kind,
        };
        if let Some(old) = &self.sim.world {
            let message = format!("a second world `{}`; it replaces that of line {}", path.text, old.path.span.line);
            self.sink.warn(Code::SimWorldTwice, path.span, message, "one `world` or `maze` line");
        }
        self.sim.world = Some(WorldLine { kind, path });
    }

    fn robi(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = rest.last().map_or(keyword.span, |last| keyword.span.to(last.span));
        let [robi, program, pose @ ..] = rest else {
            let message = "`robi` names neither a robot file nor a program";
            self.sink.error(Code::SimRobiArity, span, message, ROBI_FORM);
            return;
        };
        if !matches!(pose.len(), 0 | 3) {
            let message = format!("the start pose of `{}` has {} of 3 numbers", program.text, pose.len());
            self.sink.error(Code::SimRobiArity, span, message, ROBI_FORM);
            return;
        }
        let start = line::numbers(&mut self.sink, Severity::Error, pose, &POSE).map(|[x, y, phi]| Pose::new(x, y, phi));
        let robi = path::named(&mut self.sink, Severity::Error, robi, ROBI_FORM);
        let program = path::named(&mut self.sink, Severity::Error, program, ROBI_FORM);
        let start = match start {
            Some(pose) => StartRef::Pose(pose),
            None if pose.is_empty() => StartRef::Next,
            None => return,
        };
        if let (Some(robi), Some(program)) = (robi, program) {
            let kind = TypeRef::File(robi);
            self.sim.robots.push(RobotLine { kind, program: Some(program), arguments: Vec::new(), start, span });
        }
    }

    fn object(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = rest.last().map_or(keyword.span, |last| keyword.span.to(last.span));
        let [pose @ .., mesh] = rest else {
            self.sink.warn(Code::SimObjectArity, span, "`object` has no values", OBJECT_FORM);
            return;
        };
        if pose.len() != 4 {
            let message = format!("`object` has {} of 5 values", rest.len());
            self.sink.warn(Code::SimObjectArity, span, message, OBJECT_FORM);
            return;
        }
        let values = line::numbers(&mut self.sink, Severity::Warning, pose, &OBJECT);
        let mesh = path::named(&mut self.sink, Severity::Warning, mesh, OBJECT_FORM);
        if let (Some([x, y, phi, friction]), Some(mesh)) = (values, mesh) {
            self.sim.objects.push(ObjectLine {
                kind: TypeRef::File(mesh),
                pose: Pose::new(x, y, phi),
                friction: Some(friction),
                span,
            });
        }
    }

    /// A line of EyeSim VR: `settings`, a robot or an object by the name of its type, or one that loads a type.
    fn vr(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = rest.last().map_or(keyword.span, |last| keyword.span.to(last.span));
        let word = keyword.text.to_lowercase();
        let mut is_robot = VR_ROBOTS.contains(&word.as_str()) || self.loaded.contains(&(word.clone(), true));
        if let ("robi" | "robot" | "object" | "obj", [file]) = (word.as_str(), rest) {
            is_robot = matches!(word.as_str(), "robi" | "robot");
            self.loaded.push((path::stem(file.text).to_lowercase(), is_robot));
        }
        let severity = if is_robot { Severity::Error } else { Severity::Warning };
        let message = format!("this `{}` line is of EyeSim VR, whose sim files are not read yet", keyword.text);
        let expected = "a classic line: `robi FILE.robi PROGRAM [X Y PHI]` or `object X Y PHI FRICTION MESH`";
        self.sink.report(severity, Code::SimDialect, span, message, expected);
    }

    fn unknown(&mut self, word: &Word<'_>) {
        let nearest = line::nearest(word.text, KEYWORDS);
        // A misspelt world or robot is one that is missing.
        let is_lost = matches!(nearest, Some("world" | "maze" | "robi"));
        let severity = if is_lost { Severity::Error } else { Severity::Warning };
        let message = format!("unknown keyword `{}`", word.text);
        let expected = "one of world, maze, robi, object";
        let diagnostic = self.sink.report(severity, Code::SimKeyword, word.span, message, expected);
        diagnostic.suggestion = nearest.map(|keyword| format!("write `{keyword}`"));
    }
}

const ROBI_FORM: &str = "`robi FILE.robi PROGRAM`, then nothing or `X Y PHI` in mm and degrees";
const OBJECT_FORM: &str = "`object X Y PHI FRICTION MESH` in mm and degrees";
const POSE: [Quantity; 3] = [Quantity::coordinate("x"), Quantity::coordinate("y"), Quantity::angle("phi")];
const OBJECT: [Quantity; 4] = [
    Quantity::coordinate("x"),
    Quantity::coordinate("y"),
    Quantity::angle("phi"),
    Quantity::number("friction", 0.0, 1e6).minor(),
];
