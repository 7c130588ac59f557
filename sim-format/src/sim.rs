//! Scenes: `.sim`, with the world, the robots and their programs, the objects and the markers.
//!
//! One reader reads all dialects; it distinguishes them by number and kind of a line's values. A line that starts with
//! the name of a loaded type may place a robot or an object; [`super::load_scene`] determines which of both after the
//! type's file is read.

use super::code::Code;
use super::diagnostic::{Diagnostic, Severity, Sink};
use super::line::{self, Quantity, Word};
use super::spec::{
    Dialect, LooksSpec, MarkerSpec, ObjectLine, RobotLine, SimSpec, SpannedText, StartRef, TypeRef, WorldKind,
    WorldLine,
};
use super::{Span, builtin, path, world};
use sim_core::pose::Pose;

/// First words of lines, except for the names of types.
pub(super) const KEYWORDS: [&str; 8] = ["world", "maze", "settings", "robi", "robot", "obj", "object", "marker"];
/// Keywords of lines that a scene must not lose: misspelt, they cause an error instead of a warning.
const ESSENTIAL: [&str; 4] = ["world", "maze", "robi", "robot"];
/// Letters of maze cells at which a robot may start.
const START_LETTERS: [char; 5] = ['S', 'U', 'R', 'D', 'L'];
/// Words on a `settings` line.
const SETTINGS: [&str; 2] = ["VIS", "TRACE"];
/// Default colour of a marker: red, opaque. Source: our choice.
const MARKER_COLOUR: [u8; 4] = [255, 0, 0, 255];

/// Reads a sim file, but none of the files that it refers to (see [`super::load_scene`]).
pub fn read_sim(file: &str, text: &str) -> (SimSpec, Vec<Diagnostic>) {
    let sim = SimSpec { file: file.to_owned(), ..SimSpec::default() };
    let mut reader = Reader { sink: Sink::new(file), sim, has_syntax_of_2018: false, has_newer_syntax: false };
    let mut is_first = true;
    for line in line::lines(text) {
        let words = line.words();
        if let Some((first, rest)) = words.split_first() {
            if is_first && first.text.starts_with('[') {
                let diagnostic = reader.sink.error(
                    Code::SimKeyword,
                    first.span,
                    "the file is TOML, and no sim file",
                    KEYWORD_SYNTAX,
                );
                diagnostic.suggestion = Some(format!("name it `{}.scene.toml`", path::stem(file)));
                break;
            }
            is_first = false;
            reader.read_line(first, rest);
        }
    }
    reader.sim.run.dialect = (reader.has_syntax_of_2018 && !reader.has_newer_syntax).then_some(Dialect::Vr2018);
    (reader.sim, reader.sink.finish())
}

struct Reader {
    sink: Sink,
    sim: SimSpec,
    /// True if a line has a syntax of EyeSim VR of 2018 that newer versions lack.
    has_syntax_of_2018: bool,
    /// True if a line has a syntax that EyeSim VR of 2018 lacks.
    has_newer_syntax: bool,
}

impl Reader {
    fn read_line(&mut self, first: &Word<'_>, rest: &[Word<'_>]) {
        if self.report_equals_sign(first, rest) || self.report_comment(first) {
            return;
        }
        match first.text.to_lowercase().as_str() {
            "world" => self.read_world(first, rest, WorldKind::World),
            "maze" => self.read_world(first, rest, WorldKind::Maze),
            "settings" => self.read_settings(rest),
            "robi" | "robot" if rest.len() == 1 => self.read_robot_type(first, rest),
            "robi" | "robot" => self.read_classic_robot(first, rest),
            "object" if rest.first().is_none_or(is_number) => {
                self.read_classic_object(first, rest);
            }
            "obj" | "object" => self.read_object_type(first, rest),
            "marker" => self.read_marker(first, rest),
            word if is_built_in_robot(word) => self.read_robot(first, rest),
            word if builtin::OBJECTS.iter().any(|name| name.eq_ignore_ascii_case(word)) => {
                self.read_object(first, rest)
            }
            _ => self.read_line_of_type(first, rest),
        }
    }

    /// Reports a keyword with `=`, such as `world=box.wld`; returns false if the line has none.
    fn report_equals_sign(&mut self, first: &Word<'_>, rest: &[Word<'_>]) -> bool {
        let Some((keyword, line)) = line::without_equals_sign(&KEYWORDS, first, rest) else {
            return false;
        };
        let message = format!("`=` follows the keyword `{keyword}`");
        self.sink.error(Code::SimKeyword, line_span(first, rest), message, KEYWORD_SYNTAX).suggestion =
            Some(format!("write `{line}`"));
        true
    }

    /// Warns about a line that begins with a comment mark of C; returns false for any other line.
    fn report_comment(&mut self, first: &Word<'_>) -> bool {
        let hint = line::comment_hint(first.text);
        if hint.is_some() {
            let message = format!("unknown keyword `{}`", first.text);
            self.sink.warn(Code::SimKeyword, first.span, message, KEYWORD_SYNTAX).suggestion = hint.clone();
        }
        hint.is_some()
    }

    fn read_world(&mut self, keyword: &Word<'_>, rest: &[Word<'_>], kind: WorldKind) {
        let syntax = "`world FILE.wld` or `maze FILE.maz`";
        let Some(path) = path::reference(&mut self.sink, Severity::Error, keyword, rest, syntax) else {
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
        self.sim.world = Some(WorldLine { kind, path, cell: None, looks: LooksSpec::default() });
    }

    fn read_settings(&mut self, rest: &[Word<'_>]) {
        for word in rest {
            match word.text.to_uppercase().as_str() {
                "VIS" => self.sim.settings.shows_beams = true,
                "TRACE" => self.sim.settings.shows_trace = true,
                _ => {
                    let message = format!("`{}` is not a setting", word.text);
                    let diagnostic = self.sink.warn(Code::SimSetting, word.span, message, "any of VIS and TRACE");
                    diagnostic.suggestion = line::nearest(word.text, SETTINGS).map(|name| format!("write `{name}`"));
                }
            }
        }
    }

    /// Reads `robi FILE` or `robot FILE`, which loads a robot type.
    fn read_robot_type(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let path = path::reference(&mut self.sink, Severity::Error, keyword, rest, "`robi FILE.robi`");
        self.record_version(keyword, "robi");
        self.sim.robot_types.extend(path);
    }

    /// Reads `obj FILE` or `object FILE`, which loads an object type.
    fn read_object_type(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let syntax = "`object FILE.esObj`, or the classic `object X Y PHI FRICTION MESH`";
        if rest.len() > 1 && is_number(&rest[0]) {
            let message = format!("`{}` loads a type, and a pose follows", keyword.text);
            let line = rest.iter().map(Word::quoted).collect::<Vec<_>>().join(" ");
            self.sink.warn(Code::SimObjectArity, line_span(keyword, rest), message, syntax).suggestion =
                (rest.len() == 5 && count_numbers(rest) == 4).then(|| format!("write `object {line}`"));
            return;
        }
        if let [name, x, y, phi, after_pose @ ..] = rest
            && [x, y, phi].into_iter().all(is_number)
        {
            let message = format!("`{}` has a name before the pose", keyword.text);
            let pose = [x, y, phi].map(|word| word.text).join(" ");
            let friction = after_pose.first().filter(|word| is_number(word)).map_or("FRICTION", |word| word.text);
            // A file has an extension, the name of a type has none.
            let suggestion = match path::extension(name.text).as_str() {
                "" => format!("write `{} {pose}`", name.quoted()),
                _ => format!("write `object {pose} {friction} {}`", name.quoted()),
            };
            let span = line_span(keyword, rest);
            self.sink.warn(Code::SimObjectArity, span, message, syntax).suggestion = Some(suggestion);
            return;
        }
        let path = path::reference(&mut self.sink, Severity::Warning, keyword, rest, syntax);
        self.record_version(keyword, "obj");
        self.sim.object_types.extend(path);
    }

    /// Records the version of EyeSim VR to which the `keyword` of a line that loads a type belongs; `old` is the
    /// keyword of 2018.
    fn record_version(&mut self, keyword: &Word<'_>, old: &str) {
        let is_keyword_of_2018 = keyword.text.eq_ignore_ascii_case(old);
        self.has_syntax_of_2018 |= is_keyword_of_2018;
        self.has_newer_syntax |= !is_keyword_of_2018;
    }

    /// Reads `robi FILE PROGRAM [X Y PHI]`.
    fn read_classic_robot(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = line_span(keyword, rest);
        let [robi, program, pose @ ..] = rest else {
            let message = format!("`{}` names no robot file", keyword.text);
            self.sink.error(Code::SimRobiArity, span, message, ROBI_SYNTAX);
            return;
        };
        let name_count = rest.iter().take_while(|word| !is_number(word)).count();
        let is_robi = |word: &Word<'_>| path::extension(word.text) == "robi";
        if name_count == 2 && is_robi(program) && !is_robi(robi) {
            let message = format!("`{}` has its program before the robot file", keyword.text);
            let words = [program, robi].into_iter().chain(pose).map(Word::quoted).collect::<Vec<_>>().join(" ");
            self.sink.error(Code::SimRobiArity, span, message, ROBI_SYNTAX).suggestion =
                Some(format!("write `{} {words}`", keyword.text));
            return;
        }
        if let [x, y, phi, after_pose @ ..] = &rest[1..]
            && [x, y, phi].into_iter().all(is_number)
            && !after_pose.first().is_some_and(is_number)
        {
            let pose = [x, y, phi].map(|word| word.text).join(" ");
            let (robi, program) = match after_pose.first() {
                Some(last) if is_robi(last) => (last, Some(robi)),
                program => (robi, program),
            };
            let (kind, file) = (keyword.text, robi.quoted());
            let (fault, line) = match program.map(Word::quoted) {
                program if path::extension(robi.text).is_empty() => {
                    let name = builtin::ROBOTS.into_iter().find(|name| name.eq_ignore_ascii_case(&file));
                    let program = program.map(|program| format!(" {program}")).unwrap_or_default();
                    ("has the name of a type, and no file", format!("{} {pose}{program}", name.unwrap_or(&file)))
                }
                Some(program) => ("has its program after the start pose", format!("{kind} {file} {program} {pose}")),
                None if is_robi(robi) => ("names no program", format!("{kind} {file} PROGRAM {pose}")),
                None => ("names no robot file", format!("{kind} FILE.robi {file} {pose}")),
            };
            let message = format!("`{kind}` {fault}");
            self.sink.error(Code::SimRobiArity, span, message, ROBI_SYNTAX).suggestion =
                Some(format!("write `{line}`"));
            return;
        }
        if name_count > 2 && count_numbers(&rest[name_count..]) >= 3 {
            let message = format!("`{}` is followed by {name_count} names, not 2", keyword.text);
            let quoted = |words: &[Word<'_>]| {
                let text = words.iter().map(|word| word.text).collect::<Vec<_>>().join(" ");
                if words.len() > 1 { format!("\"{text}\"") } else { text }
            };
            let ends_type = |word: &Word<'_>| word.text.to_ascii_lowercase().ends_with(".robi");
            let type_word_count = rest[..name_count - 1].iter().position(ends_type).map_or(1, |index| index + 1);
            let line = [quoted(&rest[..type_word_count]), quoted(&rest[type_word_count..name_count])].join(" ");
            let numbers = rest[name_count..].iter().map(|word| word.text).collect::<Vec<_>>().join(" ");
            self.sink.error(Code::SimRobiArity, span, message, ROBI_SYNTAX).suggestion =
                Some(format!("put a file name with blanks between double quotes: `{} {line} {numbers}`", keyword.text));
            return;
        }
        if matches!(pose.len(), 1 | 2) {
            let message = format!("the start pose of `{}` has {} of 3 numbers", program.text, pose.len());
            let line = std::iter::once(keyword).chain(rest);
            self.sink.error(Code::SimRobiArity, span, message, ROBI_SYNTAX).suggestion =
                line::without_commas(line, |words| words.len() == 6);
            return;
        }
        self.warn_of_extra_words(pose, 3, ROBI_SYNTAX);
        let pose = &pose[..pose.len().min(3)];
        let start = line::numbers(&mut self.sink, Severity::Error, pose, &POSE).map(|[x, y, phi]| Pose::new(x, y, phi));
        let robi = path::file_reference(&mut self.sink, Severity::Error, robi, ROBI_SYNTAX);
        let program = path::file_reference(&mut self.sink, Severity::Error, program, ROBI_SYNTAX);
        let start = match start {
            Some(pose) => StartRef::Pose(pose),
            None if pose.is_empty() => StartRef::Next,
            None => return,
        };
        if let (Some(robi), Some(program)) = (robi, program) {
            let kind = TypeRef::File(robi);
            self.sim.robots.push(RobotLine { kind, program: Some(program), start, span, ..RobotLine::default() });
        }
    }

    /// Reads `object X Y PHI FRICTION MESH`.
    fn read_classic_object(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = line_span(keyword, rest);
        let [pose @ .., mesh] = rest else {
            self.sink.warn(Code::SimObjectArity, span, "`object` has no values", OBJECT_SYNTAX);
            return;
        };
        if pose.len() != 4 {
            let message = format!("`object` has {} of 5 values", rest.len());
            let line = std::iter::once(keyword).chain(rest);
            self.sink.warn(Code::SimObjectArity, span, message, OBJECT_SYNTAX).suggestion =
                line::without_commas(line, |words| words.len() == 6);
            return;
        }
        let values = line::numbers(&mut self.sink, Severity::Warning, pose, &OBJECT);
        let mesh = path::file_reference(&mut self.sink, Severity::Warning, mesh, OBJECT_SYNTAX);
        if let (Some([x, y, phi, friction]), Some(mesh)) = (values, mesh) {
            self.sim.objects.push(ObjectLine {
                kind: TypeRef::File(mesh),
                pose: Pose::new(x, y, phi),
                friction: Some(friction),
                span,
                ..ObjectLine::default()
            });
        }
    }

    /// Reads a line that places a built-in robot.
    fn read_robot(&mut self, name: &Word<'_>, rest: &[Word<'_>]) {
        if let Some(line) = self.read_placement(name, rest, PLACE_ROBOT) {
            self.sim.robots.push(line);
        }
    }

    /// Reads a line that places a built-in object.
    fn read_object(&mut self, name: &Word<'_>, rest: &[Word<'_>]) {
        let span = line_span(name, rest);
        if rest.len() < 3 {
            self.report_short_pose(Severity::Error, name, rest, PLACE_OBJECT);
            return;
        }
        self.warn_of_extra_words(rest, 3, PLACE_OBJECT);
        if let Some([x, y, phi]) = line::numbers(&mut self.sink, Severity::Error, &rest[..3], &POSE) {
            let kind = TypeRef::Name(spanned_text(name));
            self.sim.objects.push(ObjectLine { kind, pose: Pose::new(x, y, phi), span, ..ObjectLine::default() });
        }
    }

    /// Reads a line that may place a robot or an object of a loaded type; reports a line that has another form.
    fn read_line_of_type(&mut self, first: &Word<'_>, rest: &[Word<'_>]) {
        if is_number(first) && rest.len() >= 3 && rest.iter().all(is_number) {
            let message = "a line of numbers describes a wall of a world";
            self.sink.warn(Code::SimKeyword, line_span(first, rest), message, KEYWORD_SYNTAX).suggestion =
                Some(OF_WORLD.to_owned());
            return;
        }
        let is_pose = count_numbers(rest) >= 3;
        let is_letter = rest.first().and_then(letter).is_some_and(|letter| START_LETTERS.contains(&letter));
        if (is_pose || is_letter) && !first.text.trim().is_empty() {
            if let Some(line) = self.read_placement(first, rest, PLACE_NAMED) {
                self.sim.named.push(line);
            }
            return;
        }
        let keywords = KEYWORDS.iter().chain(&builtin::ROBOTS).chain(&builtin::OBJECTS).copied();
        let nearest = line::nearest(first.text, keywords);
        let initial = |word: &str| word.chars().next().map(|letter| letter.to_ascii_lowercase());
        let is_keyword = nearest.is_some_and(|keyword| initial(keyword) == initial(first.text));
        if !is_keyword && has_word_before_pose(rest) && !path::extension(rest[0].text).is_empty() {
            self.report_word_before_pose(Severity::Error, first, rest, PLACE_NAMED);
            return;
        }
        // Without a misspelt line of a world or robot, the scene lacks this world or robot.
        let is_essential = nearest.is_some_and(|word| ESSENTIAL.contains(&word) || builtin::ROBOTS.contains(&word));
        let severity = if is_essential { Severity::Error } else { Severity::Warning };
        let is_type = |word: &Word<'_>| {
            builtin::ROBOTS.iter().chain(&builtin::OBJECTS).any(|name| name.eq_ignore_ascii_case(word.text))
        };
        if let Some((kind, pose)) = rest.split_first().filter(|(kind, pose)| is_type(kind) && count_numbers(pose) > 0) {
            let message = format!("the line begins with `{}`, and not with the type", first.text);
            let span = line_span(first, rest);
            let words: Vec<&str> = pose.iter().map(|word| word.text).collect();
            self.sink.error(Code::SimKeyword, span, message, PLACE_NAMED).suggestion =
                Some(format!("write `{} {} {}`", kind.text, words.join(" "), first.text));
            return;
        }
        if world::KEYWORDS.iter().any(|word| word.eq_ignore_ascii_case(first.text)) {
            let message = format!("`{}` describes a world", first.text);
            self.sink.report(severity, Code::SimKeyword, first.span, message, KEYWORD_SYNTAX).suggestion =
                Some(OF_WORLD.to_owned());
            return;
        }
        if nearest.is_none() && has_word_before_pose(rest) {
            self.report_word_before_pose(severity, first, rest, PLACE_NAMED);
            return;
        }
        if nearest.is_none() && count_numbers(rest) > 1 {
            self.report_short_pose(severity, first, rest, PLACE_NAMED);
            return;
        }
        let message = format!("unknown keyword `{}`", first.text);
        let diagnostic = self.sink.report(severity, Code::SimKeyword, first.span, message, KEYWORD_SYNTAX);
        diagnostic.suggestion = nearest.map(|keyword| format!("write `{keyword}`"));
    }

    /// Reads `NAME X Y PHI [PROGRAM]` or `NAME LETTER [PHI] [PROGRAM]`.
    fn read_placement(&mut self, name: &Word<'_>, rest: &[Word<'_>], syntax: &str) -> Option<RobotLine> {
        let span = line_span(name, rest);
        let (start, program) = match rest.first().and_then(letter) {
            Some(letter) => {
                let has_heading = rest.get(1).is_some_and(is_number);
                self.has_newer_syntax |= has_heading;
                let heading = match rest.get(1).filter(|_| has_heading) {
                    Some(word) => Some(line::number(&mut self.sink, Severity::Error, word, &POSE[2])?),
                    None => None,
                };
                (Some(StartRef::Letter { letter, heading }), &rest[1 + usize::from(has_heading)..])
            }
            None if is_short(rest) => {
                self.report_short_pose(Severity::Error, name, rest, syntax);
                return None;
            }
            None if has_word_before_pose(rest) => {
                self.report_word_before_pose(Severity::Error, name, rest, syntax);
                return None;
            }
            None => {
                let pose = line::numbers(&mut self.sink, Severity::Error, &rest[..3], &POSE);
                (pose.map(|[x, y, phi]| StartRef::Pose(Pose::new(x, y, phi))), &rest[3..])
            }
        };
        self.warn_of_extra_words(program, 1, syntax);
        let program = match program.first() {
            Some(word) => Some(path::file_reference(&mut self.sink, Severity::Error, word, syntax)?),
            None => None,
        };
        let kind = TypeRef::Name(spanned_text(name));
        let arguments = Vec::new();
        Some(RobotLine { kind, program, arguments, start: start?, span, ..RobotLine::default() })
    }

    /// Reports a line with a word between the name and the pose: its program, or the second word of the name.
    fn report_word_before_pose(&mut self, severity: Severity, name: &Word<'_>, rest: &[Word<'_>], syntax: &str) {
        let (word, pose) = (&rest[0], &rest[1..]);
        let is_program = is_built_in_robot(name.text) || !path::extension(word.text).is_empty();
        let line = pose.iter().map(Word::quoted).collect::<Vec<_>>().join(" ");
        let message = format!("`{}` stands before the start pose", word.text);
        self.sink.report(severity, Code::SimPlaceArity, line_span(name, rest), message, syntax).suggestion =
            match (is_program, pose.len()) {
                (true, 3) => Some(format!("write `{} {line} {}`", name.quoted(), word.quoted())),
                (true, _) => None,
                (false, _) => Some(format!(
                    "a name of two words stands between double quotes: `\"{} {}\" {line}`",
                    name.text, word.text
                )),
            };
    }

    /// Reports a line whose pose has fewer than three numbers.
    fn report_short_pose(&mut self, severity: Severity, name: &Word<'_>, rest: &[Word<'_>], syntax: &str) {
        let count = count_numbers(rest);
        let missing = if count == 2 { ": the heading phi in degrees is missing" } else { "" };
        let message = format!("`{}` has {count} of 3 numbers{missing}", name.text);
        let line = std::iter::once(name).chain(rest);
        self.sink.report(severity, Code::SimPlaceArity, line_span(name, rest), message, syntax).suggestion =
            line::without_commas(line, |words| {
                words.iter().skip(1).take_while(|word| word.parse::<f64>().is_ok()).count() == 3
            });
    }

    fn read_marker(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = line_span(keyword, rest);
        if !matches!(rest.len(), 2 | 5 | 6) {
            let message = format!("`marker` has {} values", rest.len());
            let line = std::iter::once(keyword).chain(rest);
            self.sink.error(Code::SimMarkerArity, span, message, MARKER_SYNTAX).suggestion =
                line::without_commas(line, |words| matches!(words.len(), 3 | 6 | 7));
            return;
        }
        let (coordinates, shades) = rest.split_at(2);
        let position = line::numbers(&mut self.sink, Severity::Error, coordinates, &[POSE[0], POSE[1]]);
        let mut colour = MARKER_COLOUR;
        for ((shade, word), quantity) in colour.iter_mut().zip(shades).zip(&COLOUR) {
            if let Some(value) = line::number(&mut self.sink, Severity::Error, word, quantity) {
                *shade = value as u8;
            }
        }
        if let Some(position) = position {
            self.sim.markers.push(MarkerSpec { position: position.into(), colour, span });
        }
    }

    /// Warns about the words that follow the first `count` of `words`.
    fn warn_of_extra_words(&mut self, words: &[Word<'_>], count: usize, syntax: &str) {
        if let Some(extra) = words.get(count) {
            let message = format!("`{}` is left over", extra.text);
            let may_be_name = syntax != PLACE_OBJECT && !line::looks_numeric(extra.text);
            let suggestion = "put a file name with blanks between double quotes; `--args` gives a program arguments";
            self.sink.warn(Code::WordExtra, extra.span, message, syntax).suggestion =
                line::comment_hint(extra.text).or_else(|| may_be_name.then(|| suggestion.to_owned()));
        }
    }
}

/// Span of a line, from its first word to its last.
fn line_span(first: &Word<'_>, rest: &[Word<'_>]) -> Span {
    rest.last().map_or(first.span, |last| first.span.to(last.span))
}

fn spanned_text(word: &Word<'_>) -> SpannedText {
    SpannedText { text: word.text.to_owned(), span: word.span }
}

/// Returns true for a number and for a malformed number, but not for a file name that begins with a digit.
fn is_number(word: &Word<'_>) -> bool {
    line::looks_numeric(word.text) && (word.text.parse::<f64>().is_ok() || line::guessed_number(word.text).is_some())
}

/// Returns true for the name of a built-in robot.
fn is_built_in_robot(name: &str) -> bool {
    builtin::ROBOTS.iter().any(|known| known.eq_ignore_ascii_case(name))
}

/// Returns true for a word and the three numbers of a pose.
fn has_word_before_pose(words: &[Word<'_>]) -> bool {
    words.split_first().is_some_and(|(word, pose)| !is_number(word) && count_numbers(pose) >= 3)
}

/// Returns true if a pose has fewer than three numbers because some are missing, not because one is misspelt.
fn is_short(pose: &[Word<'_>]) -> bool {
    let count = count_numbers(pose);
    // Of four words the third is the heading, and the fourth the program.
    let is_heading = count == 2 && pose.len() > 3 && (line::looks_numeric(pose[2].text) || !pose[2].text.contains('.'));
    pose.len() < 3 || count < 3 && !is_heading && !pose[count..3].iter().any(is_number)
}

/// Number of leading words of `words` that are numbers.
fn count_numbers(words: &[Word<'_>]) -> usize {
    words.iter().take_while(|word| is_number(word)).count()
}

/// The single letter that `word` consists of, in upper case.
fn letter(word: &Word<'_>) -> Option<char> {
    let mut characters = word.text.chars();
    let letter = characters.next().filter(char::is_ascii_alphabetic)?;
    characters.next().is_none().then(|| letter.to_ascii_uppercase())
}

/// Suggestion for a line of a world.
pub(super) const OF_WORLD: &str = "write this line into the file `NAME.wld` that `world NAME.wld` names";

const KEYWORD_SYNTAX: &str =
    "one of world, maze, settings, robi, robot, obj, object, marker, or the name of a type with `X Y PHI`";
const ROBI_SYNTAX: &str = "`robi FILE.robi PROGRAM`, then nothing or `X Y PHI` in mm and degrees";
const OBJECT_SYNTAX: &str = "`object X Y PHI FRICTION MESH` in mm and degrees";
const PLACE_ROBOT: &str = "`NAME X Y PHI` in mm and degrees or `NAME LETTER [PHI]`, then nothing or a program";
const PLACE_OBJECT: &str = "`NAME X Y PHI` in mm and degrees";
const PLACE_NAMED: &str = "the name of a type and `X Y PHI` in mm and degrees; for a robot also a program";
const MARKER_SYNTAX: &str =
    "`marker X Y`, `marker X Y RED GREEN BLUE` or `marker X Y RED GREEN BLUE OPACITY`, colours 0 to 255";
const POSE: [Quantity; 3] = [Quantity::coordinate("x"), Quantity::coordinate("y"), Quantity::angle("phi")];
const OBJECT: [Quantity; 4] = [
    Quantity::coordinate("x"),
    Quantity::coordinate("y"),
    Quantity::angle("phi"),
    Quantity::number("friction", 0.0, 1e6).minor(),
];
const COLOUR: [Quantity; 4] = [
    Quantity::number("red", 0.0, 255.0).minor(),
    Quantity::number("green", 0.0, 255.0).minor(),
    Quantity::number("blue", 0.0, 255.0).minor(),
    Quantity::number("opacity", 0.0, 255.0).minor(),
];
