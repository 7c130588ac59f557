//! Worlds: `.wld`, the line format of Saphira with EyeSim's extensions.

use glam::DVec2;

use super::code::Code;
use super::diagnostic::{Diagnostic, Severity, Sink};
use super::line::{self, Quantity, SingleKeywords, Word};
use super::spec::{DEFAULT_WALL_HEIGHT, MAX_LENGTH, StartSpec, WallSpec, WorldSpec};
use crate::path;
use sim_core::pose::Pose;

pub(crate) const KEYWORDS: [&str; 8] =
    ["floor", "width", "height", "floor_texture", "water", "position", "push", "pop"];

/// Depth of the water over the floor.
pub(crate) const WATER: Quantity = Quantity::size("depth of the water");

/// Reads a world file.
///
/// `file` is the name for the diagnostics. The spec has only finite numbers for any text: a line with a mistake is
/// reported and skipped.
pub fn read_world(file: &str, text: &str) -> (WorldSpec, Vec<Diagnostic>) {
    let mut reader = Reader {
        sink: Sink::new(file),
        world: WorldSpec { file: file.to_owned(), ..WorldSpec::default() },
        width: None,
        height: None,
        has_wrong_size: false,
        single: SingleKeywords::default(),
        frames: vec![Pose::default()],
    };
    for line in line::lines(text) {
        let words = line.words();
        if let Some((first, rest)) = words.split_first() {
            reader.read_line(&words, first, rest);
        }
    }
    reader.finish()
}

struct Reader {
    sink: Sink,
    world: WorldSpec,
    width: Option<f64>,
    height: Option<f64>,
    /// True if a line with the size of the floor has a mistake.
    has_wrong_size: bool,
    single: SingleKeywords,
    /// World poses of the open frames, the world frame first.
    frames: Vec<Pose>,
}

impl Reader {
    fn read_line(&mut self, words: &[Word<'_>], first: &Word<'_>, rest: &[Word<'_>]) {
        if let Some((keyword, line)) = line::without_equals_sign(&KEYWORDS, first, rest) {
            let message = format!("`=` follows the keyword `{keyword}`");
            self.sink.warn(Code::WldKeyword, first.span, message, KEYWORD_SYNTAX).suggestion =
                Some(format!("write `{line}`"));
            return;
        }
        if matches!(first.text, "floor" | "width" | "height" | "floor_texture" | "water") {
            self.single.add(&mut self.sink, first.text, first.span);
        }
        match first.text {
            "floor" => self.read_floor(first, rest),
            "width" => self.width = self.read_side(first, rest, Code::WldWidthArity).or(self.width),
            "height" => self.height = self.read_side(first, rest, Code::WldHeightArity).or(self.height),
            "floor_texture" => self.read_texture(first, rest),
            "water" => self.read_water(first, rest),
            "position" => self.read_position(first, rest),
            "push" => self.read_push(first, rest),
            "pop" => self.read_pop(first, rest),
            word if line::looks_numeric(word) => self.read_wall(words, first, rest),
            _ => self.report_unknown(first, rest),
        }
    }

    /// Values of a keyword's line. A line with too few values is skipped, extra values are ignored, both with a warning
    /// (EyeSim gives none).
    fn arguments<const N: usize>(
        &mut self,
        keyword: &Word<'_>,
        rest: &[Word<'_>],
        quantities: &[Quantity; N],
        code: Code,
        syntax: &str,
    ) -> Option<[f64; N]> {
        if rest.len() < N {
            let span = rest.last().map_or(keyword.span, |last| keyword.span.to(last.span));
            let message = format!("`{}` has {} of {N} numbers", keyword.text, rest.len());
            let line = std::iter::once(keyword).chain(rest);
            self.sink.warn(code, span, message, syntax).suggestion =
                line::without_commas(line, |words| words.len() == 1 + N);
            return None;
        }
        if let Some(extra) = rest.get(N) {
            let message = format!("`{}` is left over after the values of `{}`", extra.text, keyword.text);
            self.sink.warn(Code::WordExtra, extra.span, message, syntax).suggestion = line::comment_hint(extra.text);
        }
        line::numbers(&mut self.sink, Severity::Warning, &rest[..N], quantities)
    }

    fn read_floor(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let quantities = [Quantity::size("floor width"), Quantity::size("floor height")];
        let syntax = "`floor WIDTH HEIGHT` in mm";
        match self.arguments(keyword, rest, &quantities, Code::WldFloorArity, syntax) {
            Some([width, height]) => (self.width, self.height) = (Some(width), Some(height)),
            None => self.has_wrong_size = true,
        }
    }

    fn read_side(&mut self, keyword: &Word<'_>, rest: &[Word<'_>], code: Code) -> Option<f64> {
        let syntax = format!("`{} SIZE` in mm", keyword.text);
        let size = self.arguments(keyword, rest, &[Quantity::size("floor size")], code, &syntax);
        self.has_wrong_size |= size.is_none();
        size.map(|[size]| size)
    }

    fn read_texture(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let syntax = "`floor_texture IMAGE`: a png, bmp or jpg file";
        self.world.texture = path::reference(&mut self.sink, Severity::Warning, keyword, rest, syntax);
        // The walls of worlds saved by EyeSim VR lie on the lines of the image only if the image is turned.
        self.world.texture_is_turned = self.world.texture.is_some();
    }

    /// Reads the depth of the water. The line is our extension, since no file of EyeSim VR with water is known.
    fn read_water(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let depth = self.arguments(keyword, rest, &[WATER], Code::WldWaterArity, "`water DEPTH` in mm");
        self.world.water = depth.map(|[depth]| depth).or(self.world.water);
    }

    fn read_position(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let syntax = "`position X Y PHI` in mm and degrees counter-clockwise";
        if let Some([x, y, phi]) = self.arguments(keyword, rest, &POSE, Code::WldPositionArity, syntax) {
            let pose = self.frame().compose(&Pose::new(x, y, phi));
            self.world.starts.push(StartSpec { pose, letter: None, span: keyword.span });
        }
    }

    fn read_push(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let syntax = "`push X Y PHI` in mm and degrees clockwise";
        let frame = match self.arguments(keyword, rest, &POSE, Code::WldPushArity, syntax) {
            // Clockwise, unlike all other angles: the data files are consistent only with this sign.
            Some([x, y, phi]) => self.frame().compose(&Pose::new(x, y, -phi)),
            // Still opens a frame, so that the matching `pop` does not close another frame.
            None => self.frame(),
        };
        let is_near = frame.position.abs().max_element() <= MAX_LENGTH;
        if !is_near {
            self.report_too_far(keyword);
        }
        self.frames.push(if is_near { frame } else { self.frame() });
    }

    fn read_pop(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        if let Some(extra) = rest.first() {
            let message = format!("`{}` is left over after `pop`", extra.text);
            self.sink.warn(Code::WordExtra, extra.span, message, "`pop` alone").suggestion =
                line::comment_hint(extra.text);
        }
        if self.frames.len() > 1 {
            self.frames.pop();
        } else {
            self.sink.warn(Code::WldPopEmpty, keyword.span, "`pop` closes no `push`", "a `push X Y PHI` before it");
        }
    }

    fn read_wall(&mut self, words: &[Word<'_>], first: &Word<'_>, rest: &[Word<'_>]) {
        let span = rest.last().map_or(first.span, |last| first.span.to(last.span));
        let count = words.iter().position(|word| !line::looks_numeric(word.text)).unwrap_or(words.len());
        if !matches!(words.len(), 4 | 6 | 9) {
            let message = match words.get(count) {
                Some(word) => format!("a wall of {count} numbers and the word `{}`; the line is left out", word.text),
                None => format!("a wall of {count} numbers; the line is left out"),
            };
            let push = match (words, count) {
                ([x, y, phi], 3) => Some(format!("`push {} {} {}`, if a frame is meant", x.text, y.text, phi.text)),
                _ => None,
            };
            let comment = || words.get(count).and_then(|word| line::comment_hint(word.text));
            self.sink.warn(Code::WldWallArity, span, message, WALL_SYNTAX).suggestion =
                line::without_commas(words, |words| matches!(words.len(), 4 | 6 | 9)).or(push).or_else(comment);
            return;
        }
        let quantities = &WALL[..words.len()];
        let values: Vec<Option<f64>> = words
            .iter()
            .zip(quantities)
            .map(|(word, quantity)| line::number(&mut self.sink, Severity::Warning, word, quantity))
            .collect();
        let Some(values) = values.into_iter().collect::<Option<Vec<f64>>>() else {
            return;
        };
        let frame = self.frame();
        let [from, to] = [0, 2].map(|i| frame.transform_point(DVec2::new(values[i], values[i + 1])));
        if from.abs().max(to.abs()).max_element() > MAX_LENGTH {
            self.report_too_far(first);
        } else if from == to {
            let expected = "two different ends";
            self.sink.warn(Code::WldWallLength, span, "the wall has no length: both its ends are equal", expected);
        } else {
            self.world.walls.push(WallSpec {
                from,
                to,
                thickness: values.get(4).copied().unwrap_or(0.0),
                height: values.get(5).copied().unwrap_or(DEFAULT_WALL_HEIGHT),
                colour: values.get(6..9).map(|rgb| [rgb[0] as u8, rgb[1] as u8, rgb[2] as u8]),
                surface: None,
                scatter: None,
                span,
            });
        }
    }

    fn report_unknown(&mut self, word: &Word<'_>, rest: &[Word<'_>]) {
        let message = format!("unknown keyword `{}`", word.text);
        let diagnostic = self.sink.warn(Code::WldKeyword, word.span, message, KEYWORD_SYNTAX);
        let is_wall =
            word.text.eq_ignore_ascii_case("wall") && rest.first().is_some_and(|it| line::looks_numeric(it.text));
        diagnostic.suggestion = if is_wall {
            Some("write the wall's numbers without the word `wall`".to_owned())
        } else {
            let nearest = line::nearest(word.text, KEYWORDS).map(|keyword| format!("write `{keyword}`"));
            line::comment_hint(word.text).or(nearest)
        };
    }

    fn report_too_far(&mut self, word: &Word<'_>) {
        let message = "the open `push` frames carry this beyond 1000 km".to_owned();
        self.sink.error(Code::NumberRange, word.span, message, "places within 1e9 mm of the origin");
    }

    /// World pose of the innermost open frame.
    fn frame(&self) -> Pose {
        self.frames.last().copied().unwrap_or_default()
    }

    fn finish(mut self) -> (WorldSpec, Vec<Diagnostic>) {
        let (_, extent) = self.world.bounds();
        // The floor of walls that are all on one axis is a square.
        let extent = if extent.min_element() > 0.0 { extent } else { DVec2::splat(extent.max_element()) };
        self.world.floor = DVec2::new(self.width.unwrap_or(extent.x), self.height.unwrap_or(extent.y));
        if self.world.floor.min_element() <= 0.0 && !self.has_wrong_size {
            let message = if self.world.walls.is_empty() {
                "the size of the floor is not given, and there are no walls to take it from"
            } else {
                "the size of the floor is not given, and no wall has a coordinate above 0"
            };
            self.sink.error(Code::WldFloorMissing, Default::default(), message, FLOOR_SYNTAX);
        } else if (self.width.is_none() || self.height.is_none()) && !self.has_wrong_size {
            let (width, height) = (self.world.floor.x * 1000.0, self.world.floor.y * 1000.0);
            let message =
                format!("the size of the floor is not given; taken from the walls: {width:.0} x {height:.0} mm");
            self.sink.warn(Code::WldFloorMissing, Default::default(), message, FLOOR_SYNTAX);
        }
        (self.world, self.sink.finish())
    }
}

const KEYWORD_SYNTAX: &str =
    "a wall of 4, 6 or 9 numbers, or one of floor, width, height, floor_texture, water, position, push, pop";
const WALL_SYNTAX: &str =
    "`X1 Y1 X2 Y2`, `X1 Y1 X2 Y2 THICKNESS HEIGHT` or `X1 Y1 X2 Y2 THICKNESS HEIGHT RED GREEN BLUE`, lengths in mm";

const POSE: [Quantity; 3] = [Quantity::coordinate("x"), Quantity::coordinate("y"), Quantity::angle("phi")];

const FLOOR_SYNTAX: &str = "`floor WIDTH HEIGHT`, or `width WIDTH` and `height HEIGHT`, in mm";

const WALL: [Quantity; 9] = [
    Quantity::coordinate("x of the wall's first end"),
    Quantity::coordinate("y of the wall's first end"),
    Quantity::coordinate("x of the wall's second end"),
    Quantity::coordinate("y of the wall's second end"),
    Quantity::length("thickness of the wall").minor(),
    Quantity::size("height of the wall").minor(),
    Quantity::number("red", 0.0, 255.0).minor(),
    Quantity::number("green", 0.0, 255.0).minor(),
    Quantity::number("blue", 0.0, 255.0).minor(),
];
