//! Robot types: `.robi`.

use glam::DVec3;

use super::code::Code;
use super::diagnostic::{Diagnostic, Severity, Sink};
use super::line::{self, Line, Quantity, Word};
use super::spec::{
    CameraSpec, DEFAULT_PSD_RANGE, DEFAULT_ROBOT_MASS, DEFAULT_TRACTION, DriveKind, DriveSpec, InputSpec, JointSpec,
    ModelSpec, MotorSpec, PsdSpec, RobiSpec, WheelSpec,
};
use super::{Span, path};
use crate::unit;

/// Body of a robot that does not say, in metres. With the other defaults: a small robot with two wheels.
const DEFAULT_DIAMETER: f64 = 0.18;
const DEFAULT_MAX_SPEED: f64 = 0.6;
const DEFAULT_MAX_TURN_DEG: f64 = 300.0;
const DEFAULT_WHEEL_DIAMETER: f64 = 0.05;
const DEFAULT_MAX_RATE_DEG: f64 = 3600.0;
const DEFAULT_TICKS: f64 = 1000.0;
const DEFAULT_TRACK: f64 = 0.09;
/// Distance of the axles of an Ackermann robot, as a part of its diameter, where no companion says it.
const WHEELBASE_OF_DIAMETER: f64 = 0.6;
const MAX_STEER_DEG: f64 = 45.0;

const KEYWORDS: [&str; 10] = ["name", "diameter", "speed", "turn", "model", "axis", "psd", "camera", "wheel", "drive"];
/// Keywords of EyeSim VR's robot files.
const VR_KEYWORDS: [&str; 7] = ["collider", "mass", "axel", "lidar", "fisheye", "stereo", "payload"];

impl RobiSpec {
    /// A robot type with the defaults for all that a file leaves out, named by the file's stem.
    pub fn with_defaults(file: &str) -> Self {
        Self {
            file: file.to_owned(),
            name: path::stem(file).to_owned(),
            diameter: DEFAULT_DIAMETER,
            max_speed: DEFAULT_MAX_SPEED,
            max_turn: unit::radians_from_degrees(DEFAULT_MAX_TURN_DEG),
            axis_offset: 0.0,
            wheel: WheelSpec {
                diameter: DEFAULT_WHEEL_DIAMETER,
                max_rate: unit::radians_from_degrees(DEFAULT_MAX_RATE_DEG),
                ticks_per_turn: DEFAULT_TICKS,
                track: DEFAULT_TRACK,
            },
            drive: DriveSpec {
                kind: DriveKind::Differential,
                motors: pairs(&["MOTOR_LEFT", "QUAD_LEFT", "MOTOR_RIGHT", "QUAD_RIGHT"]),
                steering: None,
                wheelbase: DEFAULT_TRACK,
                max_steer: unit::radians_from_degrees(MAX_STEER_DEG),
                wheel_lag: 0.0,
            },
            psds: Vec::new(),
            camera: None,
            lidar: None,
            colliders: Vec::new(),
            mass: DEFAULT_ROBOT_MASS,
            centre_of_mass: DVec3::ZERO,
            traction: DEFAULT_TRACTION,
            model: None,
            infrareds: Vec::new(),
            bumpers: Vec::new(),
            servos: Vec::new(),
            compass: None,
            inputs: InputSpec::default(),
            hdt: Vec::new(),
        }
    }
}

/// Reads a robi file, without its companion ([`super::read_companion`]).
///
/// What the file leaves out has the defaults of docs/formats/robi.md; a missing `wheel` or `drive` line is warned about. The
/// wheelbase is that which the geometry suggests: 0.6 of the diameter for Ackermann, the track otherwise.
pub fn read_robi(file: &str, text: &str) -> (RobiSpec, Vec<Diagnostic>) {
    let mut reader =
        Reader { sink: Sink::new(file), robi: RobiSpec::with_defaults(file), wheel: None, drive: None, vr: None };
    for line in line::lines(text) {
        let words = line.words();
        if let Some((first, rest)) = words.split_first() {
            reader.line(&line, first, rest);
        }
    }
    reader.finish()
}

struct Reader {
    sink: Sink,
    robi: RobiSpec,
    /// The wheel line.
    wheel: Option<Span>,
    /// The drive line.
    drive: Option<Span>,
    /// The first line that only EyeSim VR knows.
    vr: Option<Span>,
}

impl Reader {
    fn line(&mut self, line: &Line<'_>, first: &Word<'_>, rest: &[Word<'_>]) {
        match first.text {
            "name" => self.name(line, first),
            "diameter" => self.one(first, rest, Quantity::size("diameter"), |robi| &mut robi.diameter),
            "speed" => self.one(first, rest, Quantity::speed("largest speed"), |robi| &mut robi.max_speed),
            "turn" => self.one(first, rest, Quantity::rate("largest turning speed"), |robi| &mut robi.max_turn),
            "model" => self.model(first, rest),
            "axis" if rest.len() == 2 => self.vr(first, rest),
            "axis" => self.one(first, rest, Quantity::coordinate("axis offset"), |robi| &mut robi.axis_offset),
            "psd" if rest.len() == 8 => self.vr(first, rest),
            "psd" => self.psd(first, rest),
            "camera" => self.camera(line, first),
            "wheel" => self.wheel(first, rest),
            "drive" => self.drive(first, rest),
            word if VR_KEYWORDS.contains(&word) => self.vr(first, rest),
            _ => self.unknown(first),
        }
    }

    fn name(&mut self, line: &Line<'_>, keyword: &Word<'_>) {
        let name = line.rest_after(keyword).trim_matches('"').trim();
        if name.is_empty() {
            self.sink.warn(Code::RobiNameMissing, keyword.span, "`name` gives no name", "`name NAME`");
        } else {
            self.robi.name = name.to_owned();
        }
    }

    /// A keyword with one number.
    fn one(&mut self, keyword: &Word<'_>, rest: &[Word<'_>], quantity: Quantity, place: fn(&mut RobiSpec) -> &mut f64) {
        let form = format!("`{} NUMBER`: {}", keyword.text, quantity.expected());
        let Some(word) = rest.first() else {
            let message = format!("`{}` gives no number", keyword.text);
            self.sink.warn(Code::RobiNumberMissing, keyword.span, message, form);
            return;
        };
        self.extra(keyword, rest, 1, &form);
        if let Some(value) = line::number(&mut self.sink, Severity::Warning, word, &quantity) {
            *place(&mut self.robi) = value;
        }
    }

    fn extra(&mut self, keyword: &Word<'_>, rest: &[Word<'_>], count: usize, form: &str) {
        if let Some(extra) = rest.get(count) {
            let message = format!("`{}` is left over after the {count} values of `{}`", extra.text, keyword.text);
            self.sink.warn(Code::WordExtra, extra.span, message, form);
        }
    }

    fn model(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        if rest.len() == 7 {
            self.vr.get_or_insert(keyword.span);
        }
        // EyeSim VR puts the mesh's position and turn behind its name.
        let name = if rest.len() == 7 { &rest[..1] } else { rest };
        let form = "`model FILE`: a mesh file";
        let path = path::reference(&mut self.sink, Severity::Warning, keyword, name, form);
        self.robi.model = path.map(|path| ModelSpec { path, offset: DVec3::ZERO, turns: DVec3::ZERO });
    }

    fn psd(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = rest.last().map_or(keyword.span, |last| keyword.span.to(last.span));
        if rest.len() < 5 {
            let message = format!("`psd` has {} of 6 values", rest.len());
            self.sink.warn(Code::RobiPsdArity, span, message, PSD_FORM);
            return;
        }
        self.extra(keyword, rest, 6, PSD_FORM);
        let (name, id, pose) = match rest {
            // The id is left out in files older than hdt_sem.h.
            [name, pose @ ..] if rest.len() == 5 => (name, None, pose),
            [name, id, pose @ ..] => (name, Some(id), &pose[..4]),
            _ => return,
        };
        let id = match id.map(|id| (id, id.text.parse::<i32>())) {
            None => None,
            Some((_, Ok(id))) => Some(id),
            Some((word, Err(_))) => {
                let message = format!("`{}` is not a device number", word.text);
                self.sink.warn(Code::RobiPsdId, word.span, message, PSD_FORM);
                return;
            }
        };
        if line::looks_numeric(name.text) {
            let message = format!("`{}` is not the name of a sensor", name.text);
            self.sink.warn(Code::RobiPsdName, name.span, message, PSD_FORM);
            return;
        }
        if let Some(old) = self.robi.psds.iter().find(|psd| psd.name == name.text || id.is_some() && psd.id == id) {
            let message =
                format!("the name or number of PSD `{}` was already given in line {}", name.text, old.span.line);
            self.sink.warn(Code::RobiDeviceTwice, span, message, "each name and each number once");
            return;
        }
        if let Some([x, y, z, angle]) = line::numbers(&mut self.sink, Severity::Warning, pose, &PSD_POSE) {
            let position = DVec3::new(x, y, z);
            let name = name.text.to_owned();
            self.robi.psds.push(PsdSpec { name, id, position, angle, range: DEFAULT_PSD_RANGE, span });
        }
    }

    fn camera(&mut self, line: &Line<'_>, keyword: &Word<'_>) {
        let words = camera_words(line);
        let rest = &words[1..];
        let span = rest.last().map_or(keyword.span, |last| keyword.span.to(last.span));
        if rest.len() < 3 || rest.len() == 4 || rest.len() == 6 {
            let message = format!("`camera` has {} of 7 values", rest.len());
            self.sink.warn(Code::RobiCameraArity, span, message, CAMERA_FORM);
            return;
        }
        self.extra(keyword, rest, 7, CAMERA_FORM);
        let position = line::numbers(&mut self.sink, Severity::Warning, &rest[..3], &CAMERA_POSITION);
        let joints = [3, 4].map(|i| rest.get(i).map_or(Some(JointSpec::Fixed(0.0)), |word| self.joint(word)));
        let image = match rest.get(5..7) {
            None => Some(None),
            Some(size) => line::numbers(&mut self.sink, Severity::Warning, size, &IMAGE)
                .map(|size| Some(size.map(|pixels| pixels as u32))),
        };
        if let (Some([x, y, z]), [Some(pan), Some(tilt)], Some(image)) = (position, joints, image) {
            self.robi.camera =
                Some(CameraSpec { position: DVec3::new(x, y, z), pan, tilt, image, fisheye: None, span });
        }
    }

    /// A fixed angle, or `SERVO1(-90,+90)`.
    fn joint(&mut self, word: &Word<'_>) -> Option<JointSpec> {
        let Some((name, range)) = word.text.split_once('(') else {
            return line::number(&mut self.sink, Severity::Warning, word, &Quantity::angle("camera angle"))
                .map(JointSpec::Fixed);
        };
        let angles = range.strip_suffix(')').and_then(|range| range.split_once(','));
        let angles = angles.and_then(|(from, to)| Some([degrees(from)?, degrees(to)?]));
        let Some([from, to]) = angles.filter(|_| !name.is_empty()) else {
            let message = format!("`{}` is neither an angle nor a servo with its range", word.text);
            self.sink.warn(Code::RobiCameraServo, word.span, message, "an angle in degrees or `SERVO1(-90,+90)`");
            return None;
        };
        Some(JointSpec::Servo { name: name.to_owned(), from, to })
    }

    fn wheel(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        if matches!(rest.first().map(|word| word.text), Some("drive" | "turn")) {
            self.vr(keyword, rest);
            return;
        }
        let span = rest.last().map_or(keyword.span, |last| keyword.span.to(last.span));
        self.wheel = Some(span);
        if rest.len() < 4 {
            let message = format!("`wheel` has {} of 4 numbers; defaults are taken", rest.len());
            self.sink.warn(Code::RobiWheelArity, span, message, WHEEL_FORM);
            return;
        }
        self.extra(keyword, rest, 4, WHEEL_FORM);
        let values = line::numbers(&mut self.sink, Severity::Warning, &rest[..4], &WHEEL);
        if let Some([diameter, max_rate, ticks_per_turn, track]) = values {
            self.robi.wheel = WheelSpec { diameter, max_rate, ticks_per_turn, track };
        }
    }

    fn drive(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = rest.last().map_or(keyword.span, |last| keyword.span.to(last.span));
        self.drive = Some(span);
        let (kind, default): (_, &[&str]) = match rest.first().map(|word| word.text) {
            Some("DIFFERENTIAL_DRIVE") => {
                (DriveKind::Differential, &["MOTOR_LEFT", "QUAD_LEFT", "MOTOR_RIGHT", "QUAD_RIGHT"])
            }
            Some("ACKERMANN_DRIVE") => (DriveKind::Ackermann, &["MOTOR_DRIVE", "QUAD_DRIVE", "SERVO_STEER"]),
            Some("OMNI_DRIVE") => (DriveKind::Omni, &OMNI),
            other => {
                let word = rest.first().unwrap_or(keyword);
                let message = format!("unknown drive `{}`; a differential drive is taken", other.unwrap_or_default());
                let diagnostic = self.sink.error(Code::RobiDriveKind, word.span, message, DRIVE_FORM);
                diagnostic.suggestion =
                    line::nearest(other.unwrap_or_default(), DRIVES).map(|kind| format!("write `{kind}`"));
                return;
            }
        };
        let names: Vec<&str> = rest[1..].iter().map(|word| word.text).collect();
        if names.is_empty() {
            self.vr(keyword, rest);
        } else if names.len() != default.len() {
            let message = format!("`{}` has {} of {} devices", rest[0].text, names.len(), default.len());
            self.sink.warn(Code::RobiDriveArity, span, message, DRIVE_FORM);
        }
        let names = if names.len() == default.len() { &names } else { default };
        let (motors, steering) = match kind {
            DriveKind::Ackermann => (&names[..2], Some(names[2].to_owned())),
            _ => (names, None),
        };
        self.robi.drive = DriveSpec { kind, motors: pairs(motors), steering, ..self.robi.drive.clone() };
    }

    /// A line that only EyeSim VR knows.
    fn vr(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = rest.last().map_or(keyword.span, |last| keyword.span.to(last.span));
        if self.vr.is_none() {
            let message = format!("this `{}` line is of EyeSim VR, whose robot files are not read yet", keyword.text);
            let expected = "a classic robi: name, diameter, speed, turn, model, axis, psd, camera, wheel, drive";
            self.sink.warn(Code::RobiDialect, span, message, expected);
        }
        self.vr.get_or_insert(span);
    }

    fn unknown(&mut self, word: &Word<'_>) {
        let expected = "one of name, diameter, speed, turn, model, axis, psd, camera, wheel, drive";
        let message = format!("unknown keyword `{}`", word.text);
        let diagnostic = self.sink.warn(Code::RobiKeyword, word.span, message, expected);
        diagnostic.suggestion = line::nearest(word.text, KEYWORDS).map(|keyword| format!("write `{keyword}`"));
    }

    fn finish(mut self) -> (RobiSpec, Vec<Diagnostic>) {
        match (self.wheel, self.vr) {
            (None, _) => {
                let wheel = &self.robi.wheel;
                let message = format!(
                    "no `wheel` line: wheels of {} mm, {} ticks a turn, {} mm apart are taken",
                    unit::mm_from_metres(wheel.diameter),
                    wheel.ticks_per_turn,
                    unit::mm_from_metres(wheel.track)
                );
                self.sink.warn(Code::RobiWheelMissing, Span::default(), message, WHEEL_FORM);
            }
            (Some(span), Some(_)) => {
                let message =
                    "in files of EyeSim VR the last number is half the distance of the wheels; it is read as all";
                self.sink.warn(Code::RobiDialectTrack, span, message, WHEEL_FORM);
            }
            (Some(_), None) => {}
        }
        if self.drive.is_none() {
            let message = "no `drive` line: a differential drive is taken";
            self.sink.warn(Code::RobiDriveMissing, Span::default(), message, DRIVE_FORM);
        }
        let robi = &mut self.robi;
        robi.drive.wheelbase = match robi.drive.kind {
            DriveKind::Ackermann => WHEELBASE_OF_DIAMETER * robi.diameter,
            DriveKind::Differential | DriveKind::Omni => robi.wheel.track,
        };
        (self.robi, self.sink.finish())
    }
}

/// Motors with their encoders from names in turns.
fn pairs(names: &[&str]) -> Vec<MotorSpec> {
    let motor =
        |pair: &[&str]| MotorSpec { motor: pair[0].to_owned(), encoder: pair.get(1).map(|&name| name.to_owned()) };
    names.chunks(2).map(motor).collect()
}

/// The words of a camera line; blanks inside parentheses do not separate.
fn camera_words<'a>(line: &Line<'a>) -> Vec<Word<'a>> {
    let mut words: Vec<Word<'a>> = Vec::new();
    for word in line.words() {
        match words.last_mut() {
            Some(open) if open.text.contains('(') && !open.text.contains(')') => open.extend_to(line, &word),
            _ => words.push(word),
        }
    }
    words
}

fn degrees(text: &str) -> Option<f64> {
    let degrees = text.trim().parse::<f64>().ok()?;
    (degrees.abs() <= 360.0).then(|| unit::radians_from_degrees(degrees))
}

const PSD_FORM: &str = "`psd NAME ID X Y Z ANGLE` in mm and degrees, or without ID";
const CAMERA_FORM: &str = "`camera X Y Z PAN TILT WIDTH HEIGHT` in mm, degrees and pixels";
const WHEEL_FORM: &str = "`wheel DIAMETER MAX_RATE TICKS TRACK` in mm, degrees/s, ticks a turn, mm";
const DRIVE_FORM: &str = "`drive DIFFERENTIAL_DRIVE MOTOR QUAD MOTOR QUAD`, `drive OMNI_DRIVE` with four pairs (front left, \
                          front right, back left, back right), or `drive ACKERMANN_DRIVE MOTOR QUAD SERVO`";
const DRIVES: [&str; 3] = ["DIFFERENTIAL_DRIVE", "ACKERMANN_DRIVE", "OMNI_DRIVE"];
const OMNI: [&str; 8] = ["MOTOR_FL", "QUAD_FL", "MOTOR_FR", "QUAD_FR", "MOTOR_BL", "QUAD_BL", "MOTOR_BR", "QUAD_BR"];

const PSD_POSE: [Quantity; 4] = [
    Quantity::coordinate("x of the PSD"),
    Quantity::coordinate("y of the PSD"),
    Quantity::coordinate("z of the PSD"),
    Quantity::angle("angle of the PSD"),
];
const CAMERA_POSITION: [Quantity; 3] = [
    Quantity::coordinate("x of the camera"),
    Quantity::coordinate("y of the camera"),
    Quantity::coordinate("z of the camera"),
];
const IMAGE: [Quantity; 2] =
    [Quantity::number("image width", 1.0, 65_536.0).minor(), Quantity::number("image height", 1.0, 65_536.0).minor()];
const WHEEL: [Quantity; 4] = [
    Quantity::size("wheel diameter"),
    Quantity::rate("largest turning rate of the wheel"),
    Quantity::number("encoder ticks a turn", 1e-3, 1e9),
    Quantity::size("distance of the wheels"),
];
