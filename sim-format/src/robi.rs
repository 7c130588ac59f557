//! Robot types: `.robi` files of EyeSim 5 and 6 and of EyeSim VR.

mod body;
mod device;
mod dialect;
mod whole;

use super::Span;
use super::code::Code;
use super::diagnostic::{Diagnostic, Severity, Sink};
use super::line::{self, Line, Quantity, SingleKeywords, Word};
use super::spec::{DriveKind, DriveSpec, MotorSpec, RobiSpec, WheelSpec};
use super::used_names::UsedNames;
use body::values_of;
pub(super) use device::{LIDAR_SWEEP, LIDAR_TILT, MAX_LIDAR_POINTS};
use dialect::Dialect;
pub(super) use whole::default_wheelbase;

pub(crate) const KEYWORDS: [&str; 15] = [
    "name", "diameter", "speed", "turn", "model", "axis", "psd", "camera", "wheel", "drive", "mass", "collider",
    "axel", "lidar", "fisheye",
];
/// Names of the robots that are built into EyeSim VR.
const RESERVED: [&str; 2] = ["LabBot", "S4"];

/// Reads a robi file of any dialect, without its companion ([`super::read_companion`]).
///
/// The newest dialect that any line requires applies to the whole file. Missing values get the defaults of
/// docs/formats/robi.md; a missing `wheel` or `drive` line gives a warning. The wheelbase is the distance between the
/// two `axel` lines. Without them it is estimated from the geometry: 0.6 of the diameter for Ackermann, the track
/// otherwise.
pub fn read_robi(file: &str, text: &str) -> (RobiSpec, Vec<Diagnostic>) {
    let lines: Vec<(Line<'_>, Vec<Word<'_>>)> = line::lines(text).map(|line| (line, line.words())).collect();
    let mut reader = Reader::new(file, Dialect::of(lines.iter().map(|(_, words)| words.as_slice())));
    for (line, words) in &lines {
        if let Some((first, rest)) = words.split_first() {
            reader.line(line, first, rest);
        }
    }
    reader.finish()
}

/// State while the lines of a robi file are read.
struct Reader {
    sink: Sink,
    dialect: Dialect,
    robi: RobiSpec,
    /// Names and numbers of the PSDs.
    psds: UsedNames,
    single: SingleKeywords,
    /// Span of the first keyword of the file.
    first_keyword: Option<Span>,
    /// Span of the line of the driven wheels.
    wheel_line: Option<Span>,
    is_wheel_read: bool,
    /// Span of the drive line.
    drive_line: Option<Span>,
    /// Position of the driven and of the steered axle on the robot's x axis, with their spans.
    axles: [Option<(f64, Span)>; 2],
    has_diameter: bool,
    /// Field of view of the fisheye lens in radians, with its span.
    fisheye: Option<(f64, Span)>,
}

impl Reader {
    fn new(file: &str, dialect: Dialect) -> Self {
        Self {
            sink: Sink::new(file),
            dialect,
            robi: RobiSpec::with_defaults(file),
            psds: UsedNames::default(),
            single: SingleKeywords::default(),
            first_keyword: None,
            wheel_line: None,
            is_wheel_read: false,
            drive_line: None,
            axles: [None; 2],
            has_diameter: false,
            fisheye: None,
        }
    }

    fn line(&mut self, line: &Line<'_>, first: &Word<'_>, rest: &[Word<'_>]) {
        if let Some((keyword, line)) = line::without_equals_sign(&KEYWORDS, first, rest) {
            let message = format!("`=` follows the keyword `{keyword}`");
            self.sink.warn(Code::RobiKeyword, first.span, message, keyword_syntax()).suggestion =
                Some(format!("write `{line}`"));
            return;
        }
        if KEYWORDS.contains(&first.text) {
            self.first_keyword.get_or_insert(first.span);
            self.check_single(first, rest);
        }
        match first.text {
            "name" => self.name(line, first, rest),
            "diameter" => {
                self.has_diameter |=
                    self.single_number(first, rest, Quantity::size("diameter"), |robi| &mut robi.diameter);
            }
            "speed" => {
                self.single_number(first, rest, Quantity::speed("largest speed"), |robi| &mut robi.max_speed);
            }
            "turn" => {
                self.single_number(first, rest, Quantity::rate("largest turning speed"), |robi| &mut robi.max_turn);
            }
            "model" => self.model(first, rest),
            "axis" => self.axis(first, rest),
            "axel" => self.axel(first, rest),
            "psd" => self.psd(first, rest),
            "camera" => self.camera(line, first),
            "fisheye" => self.fisheye(first, rest),
            "lidar" => self.lidar(first, rest),
            "collider" => self.collider(first, rest),
            "mass" => self.mass(first, rest),
            "wheel" => self.wheel(first, rest),
            "drive" => self.drive(first, rest),
            _ => self.unknown(first),
        }
    }

    /// Warns about a second line with a keyword; a car has an `axel` and a `wheel` for each of both axles.
    fn check_single(&mut self, first: &Word<'_>, rest: &[Word<'_>]) {
        match (first.text, rest.first().map(|word| word.text)) {
            ("psd" | "collider", _) => {}
            ("axel" | "wheel", Some(axle @ ("drive" | "turn"))) => {
                self.single.add(&mut self.sink, &format!("{} {axle}", first.text), first.span);
            }
            _ => self.single.add(&mut self.sink, first.text, first.span),
        }
    }

    fn name(&mut self, line: &Line<'_>, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let name = match rest {
            [word] => word.text.trim(),
            [first, .., last] => {
                let mut whole = *first;
                whole.extend_to(line, last);
                whole.text
            }
            [] => "",
        };
        if name.is_empty() {
            self.sink.warn(Code::RobiNameMissing, keyword.span, "`name` gives no name", "`name NAME`");
            return;
        }
        if self.dialect >= Dialect::Vr2017 && RESERVED.contains(&name) {
            let message = format!("`{name}` is a built-in robot of EyeSim VR, which refuses another one of this name");
            self.sink.warn(Code::RobiNameReserved, span_of(keyword, rest), message, "another name");
        }
        self.robi.name = name.to_owned();
    }

    /// Reads a keyword with one number; returns true if the number is valid.
    fn single_number(
        &mut self,
        keyword: &Word<'_>,
        rest: &[Word<'_>],
        quantity: Quantity,
        field: fn(&mut RobiSpec) -> &mut f64,
    ) -> bool {
        let syntax = format!("`{} NUMBER`: {}", keyword.text, quantity.expected());
        let Some(word) = rest.first() else {
            let message = format!("`{}` gives no number", keyword.text);
            self.sink.warn(Code::RobiNumberMissing, keyword.span, message, syntax);
            return false;
        };
        self.warn_extra(keyword, rest, 1, &syntax);
        let value = line::number(&mut self.sink, Severity::Warning, word, &quantity);
        if let Some(value) = value {
            *field(&mut self.robi) = value;
        }
        value.is_some()
    }

    /// Warns about words after the first `count` values of a keyword.
    fn warn_extra(&mut self, keyword: &Word<'_>, rest: &[Word<'_>], count: usize, syntax: &str) {
        if let Some(extra) = rest.get(count) {
            let message = format!("`{}` is left over after the values of `{}`", extra.text, keyword.text);
            self.sink.warn(Code::WordExtra, extra.span, message, syntax).suggestion = line::comment_hint(extra.text);
        }
    }

    /// Reads `axis FORWARD` or `axis HEIGHT FORWARD`. The height is ignored, since the wheels' diameter determines it.
    fn axis(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let forward = Quantity::coordinate("axis offset");
        if rest.len() < 2 {
            self.single_number(keyword, rest, forward, |robi| &mut robi.axis_offset);
            return;
        }
        let quantities = [Quantity::coordinate("height of the axis"), forward];
        let syntax = "`axis FORWARD` or `axis HEIGHT FORWARD` in mm";
        if let Some([_, forward]) = values_of(&mut self.sink, "axis", rest, span_of(keyword, rest), &quantities, syntax)
        {
            self.robi.axis_offset = forward;
        }
    }

    /// Reads `axel drive|turn HEIGHT FORWARD`: an axle of a car.
    fn axel(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let syntax = "`axel drive HEIGHT FORWARD` and `axel turn HEIGHT FORWARD` in mm";
        let Some((axle, values)) = self.axle_index(keyword, rest, syntax) else {
            return;
        };
        let quantities = [Quantity::coordinate("height of the axle"), Quantity::coordinate("position of the axle")];
        let span = span_of(keyword, rest);
        let words = format!("axel {}", rest[0].text);
        if let Some([_, forward]) = values_of(&mut self.sink, &words, values, span, &quantities, syntax) {
            self.axles[axle] = Some((forward, span));
        }
    }

    /// Index of the axle that a line describes, 0 for the driven and 1 for the steered one, and the remaining words.
    fn axle_index<'r, 'a>(
        &mut self,
        keyword: &Word<'_>,
        rest: &'r [Word<'a>],
        syntax: &str,
    ) -> Option<(usize, &'r [Word<'a>])> {
        match rest.split_first() {
            Some((word, values)) if word.text == "drive" => Some((0, values)),
            Some((word, values)) if word.text == "turn" => Some((1, values)),
            _ => {
                let word = rest.first().unwrap_or(keyword);
                let message = format!("`{}` names neither the axle that drives nor the one that turns", keyword.text);
                self.sink.warn(Code::RobiAxelKind, word.span, message, syntax);
                None
            }
        }
    }

    fn wheel(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = span_of(keyword, rest);
        let names_axle = rest.first().is_some_and(|word| word.text.starts_with(|c: char| c.is_ascii_alphabetic()));
        let (axle, values) = match names_axle {
            true => match self.axle_index(keyword, rest, VR_WHEEL_SYNTAX) {
                Some(found) => found,
                None => return,
            },
            false => (0, rest),
        };
        // Only driven wheels are simulated; steered wheels roll freely.
        if axle == 0 {
            self.wheel_line = Some(span);
        }
        let syntax = if names_axle { VR_WHEEL_SYNTAX } else { WHEEL_SYNTAX };
        if values.len() < 4 {
            let message = format!("`wheel` has {} of 4 numbers; defaults are used", values.len());
            let line = std::iter::once(keyword).chain(rest);
            self.sink.warn(Code::RobiWheelArity, span, message, syntax).suggestion =
                line::without_commas(line, |words| words.len() == 5);
            return;
        }
        self.warn_extra(keyword, values, 4, syntax);
        let values = line::numbers(&mut self.sink, Severity::Warning, &values[..4], &WHEEL);
        if let Some([diameter, max_rate, ticks_per_turn, track]) = values.filter(|_| axle == 0) {
            self.robi.wheel = WheelSpec { diameter, max_rate, ticks_per_turn, track };
            self.is_wheel_read = true;
        }
    }

    fn drive(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = span_of(keyword, rest);
        self.drive_line = Some(span);
        let word = rest.first().unwrap_or(keyword);
        let name = rest.first().map_or("", |word| word.text);
        let Some((_, kind, default)) = DRIVES.iter().find(|(word, ..)| *word == name) else {
            let message = format!("unknown drive `{name}`");
            let diagnostic = self.sink.error(Code::RobiDriveKind, word.span, message, DRIVE_SYNTAX);
            let words = DRIVES.iter().map(|(word, ..)| *word);
            let begun = DRIVES
                .iter()
                .map(|(word, ..)| *word)
                .find(|word| !name.is_empty() && word.starts_with(&name.to_uppercase()));
            let kind = begun.or_else(|| line::nearest(name, words));
            diagnostic.suggestion = kind.map(|kind| format!("write `{kind}`"));
            return;
        };
        let names: Vec<&str> = rest[1..].iter().map(|word| word.text).collect();
        if !names.is_empty() && names.len() != default.len() {
            let message = format!("`{}` has {} of {} devices", rest[0].text, names.len(), default.len());
            self.sink.warn(Code::RobiDriveArity, span, message, DRIVE_SYNTAX);
        }
        if let Some(twice) = rest
            .iter()
            .enumerate()
            .find_map(|(index, word)| rest[..index].iter().any(|earlier| earlier.text == word.text).then_some(word))
        {
            let message = format!("`{}` is named twice", twice.text);
            self.sink.warn(Code::RobiDeviceTwice, twice.span, message, "another name for each device");
        }
        let names = if names.len() == default.len() { &names } else { *default };
        let (motors, steering) = motors_and_steering(*kind, names);
        self.robi.drive = DriveSpec { kind: *kind, motors, steering, ..self.robi.drive.clone() };
    }

    fn unknown(&mut self, word: &Word<'_>) {
        let message = format!("unknown keyword `{}`", word.text);
        let diagnostic = self.sink.warn(Code::RobiKeyword, word.span, message, keyword_syntax());
        let nearest = line::nearest(word.text, KEYWORDS).map(|keyword| format!("write `{keyword}`"));
        diagnostic.suggestion = line::comment_hint(word.text).or(nearest);
    }

    fn finish(mut self) -> (RobiSpec, Vec<Diagnostic>) {
        self.check_file();
        self.mount_fisheye();
        self.derive_values();
        (self.robi, self.sink.finish())
    }
}

fn keyword_syntax() -> String {
    format!("one of {}", KEYWORDS.join(", "))
}

/// Span from a keyword to the last of its values.
fn span_of(keyword: &Word<'_>, rest: &[Word<'_>]) -> Span {
    rest.last().map_or(keyword.span, |last| keyword.span.to(last.span))
}

const WHEEL_SYNTAX: &str = "`wheel DIAMETER MAX_RATE TICKS TRACK` in mm, degrees/s, ticks a turn, mm; in files of EyeSim VR \
                          half the track";
const VR_WHEEL_SYNTAX: &str =
    "`wheel drive DIAMETER MAX_RATE TICKS HALF_TRACK` and `wheel turn ...` in mm, degrees/s, ticks a turn, mm";
const DRIVE_SYNTAX: &str = "`drive DIFFERENTIAL_DRIVE MOTOR QUAD MOTOR QUAD`, `drive OMNI_DRIVE` with four pairs (front left, \
                          front right, back left, back right), `drive ACKERMANN_DRIVE MOTOR QUAD SERVO`, \
                          `drive THRUSTER_DRIVE` with four motors (left, front, right, back), or `drive LEGGED_DRIVE` \
                          with legs in the companion";
/// Drives: keyword, kind, and default names of the devices.
pub(super) const DRIVES: [(&str, DriveKind, &[&str]); 5] = [
    ("DIFFERENTIAL_DRIVE", DriveKind::Differential, &["MOTOR_LEFT", "QUAD_LEFT", "MOTOR_RIGHT", "QUAD_RIGHT"]),
    ("ACKERMANN_DRIVE", DriveKind::Ackermann, &["MOTOR_DRIVE", "QUAD_DRIVE", "SERVO_STEER"]),
    (
        "OMNI_DRIVE",
        DriveKind::Omni,
        &["MOTOR_FL", "QUAD_FL", "MOTOR_FR", "QUAD_FR", "MOTOR_BL", "QUAD_BL", "MOTOR_BR", "QUAD_BR"],
    ),
    ("LEGGED_DRIVE", DriveKind::Legged, &[]),
    ("THRUSTER_DRIVE", DriveKind::Thrusters, &["MOTOR_LEFT", "MOTOR_FRONT", "MOTOR_RIGHT", "MOTOR_BACK"]),
];

/// Default motors and steering servo of a drive.
pub(super) fn drive_devices(kind: DriveKind) -> (Vec<MotorSpec>, Option<String>) {
    let names = DRIVES.iter().find(|(_, known, _)| *known == kind).map_or(&[] as &[&str], |(.., names)| *names);
    motors_and_steering(kind, names)
}

/// Motors and steering servo of a drive from the names of its devices.
fn motors_and_steering(kind: DriveKind, names: &[&str]) -> (Vec<MotorSpec>, Option<String>) {
    match (kind, names) {
        (DriveKind::Ackermann, [motors @ .., servo]) => (MotorSpec::pairs(motors), Some((*servo).to_owned())),
        // Thrusters have no encoders.
        (DriveKind::Thrusters, _) => (names.iter().flat_map(|name| MotorSpec::pairs(&[name])).collect(), None),
        _ => (MotorSpec::pairs(names), None),
    }
}

const WHEEL: [Quantity; 4] = [
    Quantity::size("wheel diameter"),
    Quantity::rate("largest turning rate of the wheel"),
    Quantity::number("encoder ticks a turn", 1e-3, 1e9),
    Quantity::size("distance of the wheels"),
];
