//! Sensors of a robot file: `psd`, `camera`, `fisheye` and `lidar` in all dialects.

use std::f64::consts::TAU;

use glam::DVec3;

use super::body::values_of;
use super::dialect::Dialect;
use super::{Reader, span_of};
use crate::code::Code;
use crate::diagnostic::Severity;
use crate::line::{self, Line, Quantity, Word};
use crate::spec::{CameraSpec, DEFAULT_PSD_RANGE, JointSpec, Lens, LidarSpec, PsdSpec};
use sim_core::unit;

/// Upper bound of the maximum pan and tilt in a `camera` line of EyeSim VR; larger numbers are the size of an image.
const MAX_JOINT_DEG: f64 = 180.0;
/// Image size of the EyeBot's camera in classic files; never read as maximum pan and tilt.
const CLASSIC_IMAGE: [u32; 2] = [80, 60];
/// Servos that move the camera of EyeSim VR.
const PAN_SERVO: &str = "SERVO1";
const TILT_SERVO: &str = "SERVO2";

impl Reader {
    pub(super) fn psd(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = span_of(keyword, rest);
        let is_number = |index: usize| rest.get(index).is_some_and(|word| line::looks_numeric(word.text));
        let has_id_first = is_number(0) && rest.len() > 1 && !is_number(1);
        let (expected_count, syntax) = if has_id_first { (8, VR2022_PSD_SYNTAX) } else { (6, PSD_SYNTAX) };
        if rest.len() < 5 || has_id_first && rest.len() < 8 {
            let message = format!("`psd` has {} of {expected_count} values", rest.len());
            let line = std::iter::once(keyword).chain(rest);
            self.sink.warn(Code::RobiPsdArity, span, message, syntax).suggestion =
                line::without_commas(line, |words| matches!(words.len(), 6 | 7 | 9));
            return;
        }
        self.warn_extra(keyword, rest, expected_count, syntax);
        let (name, id, pose): (_, _, Vec<Word<'_>>) = match rest {
            // The rotations RX and RZ would turn the beam out of the floor plane.
            [id, name, x, y, z, rx, pan, rz, ..] if has_id_first => {
                self.warn_turns(&[*rx, *rz], syntax);
                (name, Some(id), vec![*x, *y, *z, *pan])
            }
            // Files older than hdt_sem.h have no id.
            [name, pose @ ..] if pose.len() == 4 => (name, None, pose.to_vec()),
            [name, id, pose @ ..] => (name, Some(id), pose.iter().take(4).copied().collect()),
            _ => return,
        };
        if line::looks_numeric(name.text) {
            let message = format!("`{}` is not the name of a sensor", name.text);
            self.sink.warn(Code::RobiPsdName, name.span, message, syntax);
            return;
        }
        let id = match id.map(|word| (word, word.text.parse::<i32>())) {
            None => None,
            Some((_, Ok(id))) => Some(id),
            Some((word, Err(_))) => {
                let message = format!("`{}` is not a device number", word.text);
                let guess = line::guessed_number(word.text).and_then(|text| text.parse::<f64>().ok());
                let number = guess.map(|guess| guess.to_string()).filter(|text| text.parse::<i32>().is_ok());
                self.sink.warn(Code::RobiPsdId, word.span, message, syntax).suggestion =
                    number.map(|number| format!("write `{number}`"));
                return;
            }
        };
        if let Some(line) = self.psds.line_of(name.text, id) {
            let message = format!("the name or number of PSD `{}` was already given in line {line}", name.text);
            self.sink.warn(Code::RobiDeviceTwice, span, message, "each name and each number once");
            return;
        }
        if let Some([x, y, z, angle]) = line::numbers(&mut self.sink, Severity::Warning, &pose, &PSD_POSE) {
            let position = DVec3::new(x, y, z);
            self.psds.add(name.text, id, span.line);
            let name = name.text.to_owned();
            let (pitch, link, range) = (0.0, None, DEFAULT_PSD_RANGE);
            self.robi.psds.push(PsdSpec { name, id, position, angle, pitch, link, range, span });
        }
    }

    /// Warns about rotations that would turn a beam out of the floor plane.
    fn warn_turns(&mut self, turns: &[Word<'_>], syntax: &str) {
        for word in turns {
            if let Some(angle) =
                line::number(&mut self.sink, Severity::Warning, word, &Quantity::angle("turn of the PSD"))
                && angle != 0.0
            {
                let message =
                    format!("the turn `{}` would lift the beam out of the floor plane; it is left out", word.text);
                self.sink.warn(Code::RobiPsdTurn, word.span, message, syntax);
            }
        }
    }

    /// Warns about the first PSD whose id is not its position in the file, since programs of EyeSim VR address PSDs by
    /// position.
    pub(super) fn check_psd_order(&mut self) {
        let mut next_number = 1_i32..;
        let misnumbered = self.robi.psds.iter().zip(&mut next_number).find(|(psd, number)| psd.id != Some(*number));
        if let Some((psd, number)) = misnumbered {
            let id = psd.id.map_or("no number".to_owned(), |id| format!("the number {id}"));
            let message = format!("`{}` has {id}: EyeSim VR numbers its PSDs 1, 2, 3, ...", psd.name);
            self.sink.warn(Code::RobiPsdOrder, psd.span, message, format!("the number {number} here"));
        }
    }

    /// Warns about a PSD without a number whose x continues the number of the PSD above: it is probably its number, and
    /// another value is missing.
    pub(super) fn check_psd_numbers(&mut self) {
        let continues = |above: &PsdSpec, psd: &PsdSpec| {
            let x_mm = unit::mm_from_metres(psd.position.x);
            psd.id.is_none() && above.id.is_some_and(|id| ((x_mm - f64::from(id)).abs() - 1.0).abs() < 1e-6)
        };
        if let Some(pair) = self.robi.psds.windows(2).find(|pair| continues(&pair[0], &pair[1])) {
            let psd = &pair[1];
            let message = format!("`psd` has 5 of 6 values: `{}` is read without a number", psd.name);
            self.sink.warn(Code::RobiPsdArity, psd.span, message, PSD_SYNTAX);
        }
    }

    pub(super) fn camera(&mut self, line: &Line<'_>, keyword: &Word<'_>) {
        let words = camera_words(line);
        let rest = &words[1..];
        let span = span_of(keyword, rest);
        if rest.len() < 3 || rest.len() == 4 || rest.len() == 6 {
            let message = format!("`camera` has {} values, not 3, 5 or 7", rest.len());
            self.sink.warn(Code::RobiCameraArity, span, message, CAMERA_SYNTAX);
            return;
        }
        self.warn_extra(keyword, rest, 7, CAMERA_SYNTAX);
        let position = line::numbers(&mut self.sink, Severity::Warning, &rest[..3], &CAMERA_POSITION);
        let joints = [3, 4].map(|i| rest.get(i).map_or(Some(JointSpec::Fixed(0.0)), |word| self.joint(word)));
        let tail: Option<[Word<'_>; 2]> = rest.get(5..7).and_then(|words| words.try_into().ok());
        let tail = match tail {
            None => Some(CameraTail::Nothing),
            Some(words) => self.camera_tail(&words),
        };
        if let (Some([x, y, z]), [Some(pan), Some(tilt)], Some(tail)) = (position, joints, tail) {
            let position = match self.dialect {
                Dialect::Vr2022 => DVec3::new(y, 0.0, z),
                _ => DVec3::new(x, y, z),
            };
            let (pan, tilt, image) = match tail {
                CameraTail::Nothing => (pan, tilt, None),
                CameraTail::Image(size) => (pan, tilt, Some(size)),
                CameraTail::MaxAngles([max_pan, max_tilt]) => {
                    (with_servo(pan, PAN_SERVO, max_pan), with_servo(tilt, TILT_SERVO, max_tilt), None)
                }
            };
            self.robi.camera = Some(CameraSpec { position, pan, tilt, image, span, ..CameraSpec::default() });
        }
    }

    /// Interprets the last two numbers of a `camera` line: the size of the image, or in files of EyeSim VR the maximum
    /// pan and tilt.
    ///
    /// Files of EyeSim VR contain sizes too, in lines that were copied from classic files. In such files, the classic
    /// size and numbers that are too large for angles are read as a size.
    fn camera_tail(&mut self, words: &[Word<'_>; 2]) -> Option<CameraTail> {
        let values = [0, 1].map(|i| words[i].text.parse::<f64>().unwrap_or(f64::NAN));
        let is_classic_image = [0, 1].map(|i| words[i].text.parse().ok()) == CLASSIC_IMAGE.map(Some);
        let is_range = self.dialect >= Dialect::Vr2017
            && !is_classic_image
            && values.iter().all(|value| (0.0..=MAX_JOINT_DEG).contains(value));
        if is_range {
            return Some(CameraTail::MaxAngles(values.map(unit::radians_from_degrees)));
        }
        line::numbers(&mut self.sink, Severity::Warning, words, &IMAGE)
            .map(|size| CameraTail::Image(size.map(|pixels| pixels as u32)))
    }

    /// Reads a fixed angle, or a servo with its range, such as `SERVO1(-90,+90)`.
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

    pub(super) fn fisheye(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = span_of(keyword, rest);
        let values = values_of(&mut self.sink, "fisheye", rest, span, &FISHEYE, "`fisheye DEGREES`: the field of view");
        self.fisheye = values.map(|[angle]| (angle, keyword.span)).or(self.fisheye);
    }

    /// Adds the fisheye lens to the camera.
    pub(super) fn mount_fisheye(&mut self) {
        match (&mut self.robi.camera, self.fisheye) {
            (Some(camera), Some((fov, _))) => camera.lens = Lens::Fisheye { fov },
            (None, Some((_, span))) => {
                self.sink.warn(Code::RobiCameraMissing, span, "`fisheye` without a camera", CAMERA_SYNTAX);
            }
            (_, None) => {}
        }
    }

    pub(super) fn lidar(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = span_of(keyword, rest);
        let lidar = |points: f64, tilt, sweep| {
            Some(LidarSpec { points: points as u32, tilt, sweep, span, ..LidarSpec::default() })
        };
        let read = match rest.len() {
            3 => values_of(&mut self.sink, "lidar", rest, span, &SWEPT_LIDAR, LIDAR_SYNTAX)
                .and_then(|[sweep, points, tilt]| lidar(points, tilt, sweep)),
            _ => values_of(&mut self.sink, "lidar", rest, span, &LIDAR, LIDAR_SYNTAX)
                .and_then(|[points, tilt]| lidar(points, tilt, TAU)),
        };
        self.robi.lidar = read.or(self.robi.lidar.take());
    }
}

/// Meaning of the last two numbers of a `camera` line.
enum CameraTail {
    Nothing,
    Image([u32; 2]),
    /// Maximum pan and tilt in radians.
    MaxAngles([f64; 2]),
}

/// Replaces a fixed angle by a servo that turns by up to `max_angle` to either side of this angle.
fn with_servo(joint: JointSpec, servo: &str, max_angle: f64) -> JointSpec {
    match joint {
        JointSpec::Fixed(angle) if max_angle > 0.0 => {
            JointSpec::Servo { name: servo.to_owned(), from: angle - max_angle, to: angle + max_angle }
        }
        joint => joint,
    }
}

/// Words of a camera line; blanks inside parentheses do not separate words.
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

const PSD_SYNTAX: &str = "`psd NAME ID X Y Z ANGLE` in mm and degrees, or without ID";
const VR2022_PSD_SYNTAX: &str = "`psd ID NAME X Y Z RX PAN RZ` in mm and degrees";
const CAMERA_SYNTAX: &str = "`camera X Y Z`, `camera X Y Z PAN TILT` or `camera X Y Z PAN TILT WIDTH HEIGHT` in mm, degrees and \
                           pixels; in files of EyeSim VR also `camera X Y Z PAN TILT MAX_PAN MAX_TILT`";
const LIDAR_SYNTAX: &str = "`lidar POINTS TILT` or `lidar SWEEP POINTS TILT`, angles in degrees";

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
const FISHEYE: [Quantity; 1] = [Quantity::angle("field of view").within(1.0, 360.0).minor()];
/// Maximum number of points of a scan.
pub(crate) const MAX_LIDAR_POINTS: u32 = 65_536;
pub(crate) const LIDAR_TILT: Quantity = Quantity::angle("tilt of the scanner").within(-90.0, 90.0).minor();
pub(crate) const LIDAR_SWEEP: Quantity = Quantity::angle("angle of a scan").within(1.0, 360.0).minor();
const LIDAR_POINTS: Quantity = Quantity::number("number of points of a scan", 1.0, MAX_LIDAR_POINTS as f64).minor();
const LIDAR: [Quantity; 2] = [LIDAR_POINTS, LIDAR_TILT];
const SWEPT_LIDAR: [Quantity; 3] = [LIDAR_SWEEP, LIDAR_POINTS, LIDAR_TILT];
