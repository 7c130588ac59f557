//! Entities of a scene: single robots and groups of robots, objects, starts and markers.

use glam::DVec2;
use serde_json::{Value as Json, json};
use toml::Value;

use super::kind::{Bounded, Channels, Custom, Kind, ReadContext, TEXT, Word, Words};
use super::noise::NOISE;
use super::{Definitions, Form, Keys, Variant, Variants, print, reference};
use crate::code::Code;
use crate::line::Quantity;
use crate::path;
use crate::print::number;
use crate::spec::{
    Layout, MarkerSpec, ObjectLine, PositionRef, ReachableSpec, RobotLine, Scatter, SpannedText, StartRef, StartSpec,
    TypeRef,
};
use crate::table::{Reader, Section};
use sim_core::RobotId;
use sim_core::pose::{Heading, Pose};

/// Maximum number of robots in a scene.
pub(crate) const MAX_ROBOTS: u32 = 100_000;

/// References to robot types and to object types, with the extensions of the files that define them.
const ROBOT_TYPE: TypeReference = TypeReference(&["robi"]);
const OBJECT_TYPE: TypeReference = TypeReference(&["esobj", "obj", "ms3d", "iv"]);

/// Default colour of a marker: red, as in sim files.
const MARKER_COLOUR: [u8; 3] = [255, 0, 0];

pub(crate) const POINT: [Quantity; 2] = [Quantity::coordinate("x"), Quantity::coordinate("y")];
const HEADING: Quantity = Quantity::angle("heading");

/// Reference to a type: a file if it has one of these extensions or begins with a folder such as `.`, otherwise a name.
struct TypeReference(&'static [&'static str]);

impl TypeReference {
    fn is_file(&self, text: &str) -> bool {
        let first_folder = text.split_once(['/', '\\']).map(|(folder, _)| folder.to_lowercase());
        self.0.contains(&path::extension(text).as_str())
            || matches!(first_folder.as_deref(), Some("." | ".." | "" | "%sim%"))
    }
}

impl Kind<TypeRef> for TypeReference {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&TypeRef>) -> Option<TypeRef> {
        let reference = context.reader.reference(context.section, context.key)?;
        Some(if self.is_file(&reference.text) { TypeRef::File(reference) } else { TypeRef::Name(reference) })
    }

    fn print(&self, kind: &TypeRef) -> Value {
        match kind {
            TypeRef::File(file) if !self.is_file(&file.text) => format!("./{}", file.text).into(),
            _ => TEXT.print(kind.written()),
        }
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        Kind::<SpannedText>::describe(&TEXT, definitions)
    }
}

/// Heading that keeps whole turns.
const HEADING_WITH_TURNS: Custom<Heading> = Custom {
    read: |context| context.reader.number(context.section, context.key, &HEADING).map(Heading::new),
    print: |heading| number::heading(*heading).into(),
    describe: |definitions| HEADING.describe(definitions),
};

/// Letters of maze cells at which a robot may start.
impl Words for char {
    const NAME: &'static str = "LetterForm";
    const ABOUT: &'static str = "A start letter.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        ('S', "S", "Up, the start."),
        ('U', "U", "Up."),
        ('R', "R", "To the right."),
        ('D', "D", "Down."),
        ('L', "L", "To the left."),
    ];
}

/// Array of strings, even empty ones, and numbers.
const ARGUMENTS: Custom<Vec<String>> = Custom {
    read: |context| Some(context.reader.words(context.section, context.key)),
    print: |texts| texts.clone().into(),
    describe: |_| json!({ "type": "array", "items": { "type": ["string", "number"] } }),
};

impl Form for RobotLine {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("RobotForm", "A robot, or several robots that differ only in their start.");
        keys.span(&mut self.span);
        keys.key("name", "Its name in the paths of drawn values; default: its number in the file.")
            .nullable(TEXT, &mut self.name);
        keys.key("type", "`LabBot`, `S4`, `Mako`, the name of a type of the scene, or a `.robi` file.")
            .required(ROBOT_TYPE, &mut self.kind);
        keys.key(
            "program",
            "Its program: a library, a C or C++ file, several of them with commas, or the folder of a program.",
        )
        .nullable(TEXT, &mut self.program);
        keys.key("arguments", "Arguments of the program, after its name.").list(ARGUMENTS, &mut self.arguments);
        keys.key(
            "api",
            "Generation of the RoBIOS API that the program is written for, 6 or 7; default: from the scene.",
        )
        .nullable(6..=7, &mut self.api);
        keys.key("noise", "Errors of its devices and its drive; default: from the scene.")
            .nullable(NOISE, &mut self.noise);
        let mut id = self.id.map(|id| id.0);
        keys.key("id", "Its number, from 1 to the number of robots; default: the next free number. Excludes `count`.")
            .nullable(1..=i64::from(MAX_ROBOTS), &mut id);
        let Some((reader, section)) = keys.reading() else { return start_keys(keys, &self.start) };
        let start = reader.start(section);
        if let Some(StartRef::Many { count: 2.., .. }) = start {
            reader.exclude(section, "count", &["id"]);
            id = None;
        }
        if self.program.is_none() && !self.arguments.is_empty() {
            let span = reader.key_span(section, "arguments");
            let message = "`arguments` without a `program`; one of the command line gets them";
            reader.sink.warn(Code::TomlMissing, span, message, "a line `program = ...`");
        }
        self.id = id.map(RobotId);
        match start {
            Some(start) => self.start = start,
            None => keys.refuse(),
        }
    }
}

/// Declares the keys of a start for printing and for the schema; `Reader::start` reads them.
fn start_keys(keys: &mut Keys<'_>, start: &StartRef) {
    let pose = match start {
        StartRef::Pose(pose) => Some(*pose),
        _ => None,
    };
    let (mut letter, mut heading) = match *start {
        // In a sim file of EyeSim VR of 2018, any letter means the next start.
        StartRef::Letter { letter, heading } => {
            let is_known = char::WORDS.iter().any(|(known, ..)| *known == letter);
            (Some(if is_known { letter } else { 'S' }), heading)
        }
        _ => (None, None),
    };
    let (mut count, mut layout) = match *start {
        StartRef::Many { count, layout } => (Some(count), Some(layout)),
        _ => (None, None),
    };
    let [mut x, mut y] = [pose.map(|pose| pose.position.x), pose.map(|pose| pose.position.y)];
    let max = i64::from(MAX_ROBOTS);
    keys.key("x_mm", "Position of its centre along x in mm.").nullable(POINT[0], &mut x);
    keys.key("y_mm", "Position of its centre along y in mm.").nullable(POINT[1], &mut y);
    let key = keys.key(
        "heading_deg",
        "Heading in degrees, counter-clockwise from x; default: 0 with `x_mm`, the letter's heading with `start`.",
    );
    match pose {
        Some(pose) => {
            key.nullable(HEADING_WITH_TURNS, &mut Some(pose.heading).filter(|heading| *heading != Heading::default()))
        }
        None => key.nullable(HEADING, &mut heading),
    }
    keys.key("start", "Letter of the start of the world.").nullable(Word, &mut letter);
    keys.key("count", "Number of robots; default: 1. Without a `layout` they take the next free starts of the world.")
        .nullable(1..=max, &mut count);
    keys.key("layout", "Their arrangement.").nullable(LAYOUT, &mut layout);
}

impl Reader {
    /// Reads the start of a robot or of a group; reports an invalid start and returns `None`.
    fn start<'s>(&mut self, section: &mut Section<'s, 's>) -> Option<StartRef> {
        let has_count = section.has("count");
        let count = self.integer(section, "count", 1, i64::from(MAX_ROBOTS)).map(|count| count as u32);
        if has_count && count.is_none() {
            for key in ["x_mm", "y_mm", "heading_deg", "start", "layout"] {
                section.get(key);
            }
            return None;
        }
        if section.has("layout") {
            let layout = LAYOUT.read(ReadContext { reader: self, section, key: "layout" }, None);
            self.exclude(section, "layout", &["x_mm", "y_mm", "heading_deg", "start"]);
            return Some(StartRef::Many { count: count.unwrap_or(1), layout: layout? });
        }
        section.get("layout");
        if has_count {
            let is_clean = self.exclude(section, "count", &["x_mm", "y_mm", "heading_deg", "start"]);
            return count.filter(|_| is_clean).map(|count| StartRef::Many { count, layout: Layout::Starts });
        }
        if section.has("start") {
            let letter = Word.read(ReadContext { reader: self, section, key: "start" }, None);
            self.exclude(section, "start", &["x_mm", "y_mm"]);
            let heading = self.number(section, "heading_deg", &HEADING);
            return letter.map(|letter| StartRef::Letter { letter, heading });
        }
        section.get("start");
        if section.has("x_mm") || section.has("y_mm") || section.has("heading_deg") {
            return self.pose(section).map(StartRef::Pose);
        }
        for key in ["x_mm", "y_mm", "heading_deg"] {
            section.get(key);
        }
        Some(StartRef::Next)
    }

    /// Reads `x_mm`, `y_mm` and `heading_deg` (default 0).
    fn pose(&mut self, section: &mut Section<'_, '_>) -> Option<Pose> {
        let x = self.required(section, "x_mm", &POINT[0]);
        let y = self.required(section, "y_mm", &POINT[1]);
        let has_heading = section.has("heading_deg");
        let heading = self.number(section, "heading_deg", &HEADING);
        if has_heading && heading.is_none() {
            return None;
        }
        Some(Pose::new(x?, y?, heading.unwrap_or_default()))
    }
}

/// Layout: a table, or the word `random` for a random layout without other keys.
const LAYOUT: Custom<Layout> = Custom {
    read: |context| {
        let ReadContext { reader, section, key } = context;
        match section.get(key).map(|value| value.get_ref()) {
            Some(value) if value.as_str() == Some("random") => Some(Layout::Random(Scatter::default())),
            _ => {
                let example = "kind = \"random\"";
                let part = reader.section_like(section, key, example)?;
                reader.form(part, Layout::defaults())
            }
        }
    },
    print: |layout| print(layout).into(),
    describe: |definitions| {
        let table = reference(definitions, |keys| Layout::defaults().keys(keys));
        json!({ "anyOf": [{ "type": "string", "const": "random" }, table] })
    },
};

/// Layout of a single entity, which can only be random.
pub(crate) const SCATTER: Custom<Scatter> = Custom {
    read: |context| {
        let ReadContext { reader, section, key } = context;
        let span = section.get(key).map_or(section.span, |value| reader.span(value.span()));
        match LAYOUT.read(ReadContext { reader: &mut *reader, section: &mut *section, key }, None)? {
            Layout::Random(scatter) => Some(scatter),
            _ => {
                let message = "only robots have a layout other than `random`";
                reader.sink.error(Code::TomlChoice, span, message, "`layout = \"random\"`, or a table of this kind");
                None
            }
        }
    },
    print: |scatter| print(&Layout::Random(*scatter)).into(),
    describe: |definitions| LAYOUT.describe(definitions),
};

impl Form for Layout {
    fn bare(&self) -> Self {
        Self::VARIANTS[self.variant_index()].2()
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("LayoutForm", "Arrangement of several robots.");
        if !keys.variant(self) {
            return;
        }
        match self {
            Self::Starts => {}
            Self::Line { from, to, heading } => {
                keys.key("from_mm", "Position of the first, x and y in mm.").required(POINT, from);
                keys.key("to_mm", "Position of the last, x and y in mm.").required(POINT, to);
                keys.key("heading_deg", "Heading of all robots in degrees; default: 0.").optional(HEADING, heading);
            }
            Self::Grid { from, spacing, columns, heading } => {
                let distances = [Quantity::size("distance of columns"), Quantity::size("distance of rows")];
                keys.key("from_mm", "Position of the first, x and y in mm.").required(POINT, from);
                keys.key("spacing_mm", "Distance between columns and between rows in mm.").required(distances, spacing);
                keys.key("columns", "Number of robots in a row; default: equal to the number of rows.")
                    .nullable(1..=i64::from(MAX_ROBOTS), columns);
                keys.key("heading_deg", "Heading of all robots in degrees; default: 0.").optional(HEADING, heading);
            }
            Self::Circle { centre, radius, first, facing } => {
                keys.key("centre_mm", "Its centre, x and y in mm.").required(POINT, centre);
                keys.key("radius_mm", "Its radius in mm.").required(Bounded(Quantity::size("radius")), radius);
                keys.key("first_deg", "Direction of the first robot from the centre, in degrees; default: 0.")
                    .optional(Quantity::angle("direction of the first"), first);
                keys.key(
                    "facing_deg",
                    "Heading of each robot relative to its direction from the centre, in degrees: 0 (default) outwards, 180 inwards.",
                )
                .optional(HEADING, facing);
            }
            Self::Random(Scatter { area, clearance, heading }) => {
                if !area_keys(keys, area) {
                    return;
                }
                keys.key("clearance_mm", "Minimum distance from walls and other bodies in mm; default: 0.")
                    .optional(Bounded(Quantity::length("clearance")), clearance);
                keys.key("heading_deg", "Heading of all bodies in degrees; default: random.")
                    .nullable(HEADING, heading);
            }
        }
    }
}

/// Declares two corners of a rectangle; reports a missing corner and returns false if only one is given.
fn area_keys(keys: &mut Keys<'_>, area: &mut Option<[DVec2; 2]>) -> bool {
    let [mut from, mut to] = [area.map(|[from, _]| from), area.map(|[_, to]| to)];
    let mut is_given = false;
    if let Some((reader, section)) = keys.reading() {
        is_given = section.has("from_mm") || section.has("to_mm");
        let missing = ["from_mm", "to_mm"].into_iter().filter(|key| is_given && !section.has(key));
        missing.for_each(|key| reader.missing(section, key));
    }
    keys.key("from_mm", "A corner of the rectangle that contains the bodies, x and y in mm; default: the floor.")
        .nullable(POINT, &mut from);
    keys.key("to_mm", "The opposite corner.").nullable(POINT, &mut to);
    *area = from.zip(to).map(|(from, to)| [from.min(to), from.max(to)]);
    let is_valid = !is_given || area.is_some();
    if !is_valid {
        keys.refuse();
    }
    is_valid
}

impl Variants for Layout {
    const VARIANTS: &'static [Variant<Self>] = &[
        ("starts", "Each at the next start of the world.", || Self::Starts),
        ("line", "On a line at equal distances, the first and the last at its ends.", || Self::Line {
            from: DVec2::ZERO,
            to: DVec2::ZERO,
            heading: 0.0,
        }),
        ("grid", "In rows along x, filled from left to right, then the next one above.", || Self::Grid {
            from: DVec2::ZERO,
            spacing: DVec2::ZERO,
            columns: None,
            heading: 0.0,
        }),
        ("circle", "On a circle at equal angles, counter-clockwise.", || Self::Circle {
            centre: DVec2::ZERO,
            radius: 0.0,
            first: 0.0,
            facing: 0.0,
        }),
        ("random", "At random free positions, drawn from the seed.", || {
            Self::Random(Scatter { area: None, clearance: 0.0, heading: None })
        }),
    ];
}

impl Form for ObjectLine {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("ObjectForm", "A passive object.");
        keys.span(&mut self.span);
        keys.key("name", "Its name in the paths of drawn values; default: its number in the file.")
            .nullable(TEXT, &mut self.name);
        keys.key(
            "type",
            "`Can`, `Soccer`, `Crate`, `Golf`, the name of a type of the scene, an `.esObj` file or a mesh.",
        )
        .required(OBJECT_TYPE, &mut self.kind);
        keys.mention_first(&["count"]);
        if keys.reading().is_none() {
            // Entries with a `count` are repeated before they are read.
            keys.key("count", "Number of copies; default: 1. Each copy has its own random values.")
                .nullable(0..=MAX_REPETITIONS, &mut None::<u32>);
        }
        if !scatter_keys(keys, &mut self.scatter, &["x_mm", "y_mm", "heading_deg"]) {
            let position = &mut self.pose.position;
            keys.key("x_mm", "Position along x in mm.").required_or_replaced(POINT[0], &mut position.x);
            keys.key("y_mm", "Position along y in mm.").required_or_replaced(POINT[1], &mut position.y);
            keys.key("heading_deg", "Heading in degrees, counter-clockwise from x; default: 0.")
                .strict(HEADING_WITH_TURNS, &mut self.pose.heading);
        }
        keys.key("friction", "Coefficient of friction on the floor; default: from the type.")
            .nullable(Bounded(Quantity::number("friction", 0.0, 1e6)), &mut self.friction);
    }
}

/// Declares a position on the floor.
fn place_keys(keys: &mut Keys<'_>, point: &mut DVec2) {
    keys.key("x_mm", "Position along x in mm.").required(POINT[0], &mut point.x);
    keys.key("y_mm", "Position along y in mm.").required(POINT[1], &mut point.y);
}

/// Maximum number of repetitions of an entry.
pub(crate) const MAX_REPETITIONS: i64 = 100_000;

/// Declares `layout`, which replaces the keys `others`; returns true if the position is random.
pub(crate) fn scatter_keys(keys: &mut Keys<'_>, scatter: &mut Option<Scatter>, others: &[&'static str]) -> bool {
    let has_layout = keys.reading().is_some_and(|(_, section)| section.has("layout"));
    keys.key("layout", "Random position instead of x_mm, y_mm.").nullable(SCATTER, scatter);
    if has_layout {
        if scatter.is_none() {
            keys.refuse();
        }
        if let Some((reader, section)) = keys.reading() {
            reader.exclude(section, "layout", others);
        }
        return true;
    }
    scatter.is_some()
}

impl Form for ReachableSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form(
            "ReachableForm",
            "A requirement that a route leads from one place to another; if it is not met, random places are drawn again.",
        );
        keys.span(&mut self.span);
        keys.key("from", "Start of the route: the path of a robot or object, such as `robot.1`, or [x, y] in mm.")
            .required(POSITION_REF, &mut self.from);
        keys.key("to", "End of the route: the path of a robot or object, such as `object.1`, or [x, y] in mm.")
            .required(POSITION_REF, &mut self.to);
        keys.key("width_mm", "Width of the route in mm; default: the diameter of the robot `from`.")
            .nullable(Bounded(Quantity::size("width")), &mut self.width);
    }
}

/// A point, or the path of a robot or object.
const POSITION_REF: Custom<PositionRef> = Custom {
    read: |context| match context.section.get(context.key).map(|value| value.get_ref()) {
        Some(value) if value.is_array() => {
            context.reader.numbers(context.section, context.key, &POINT).map(|point| PositionRef::Point(point.into()))
        }
        _ => {
            let expected = "the path of a robot or object, as \"robot.1\", or [x, y] in mm";
            context.reader.reference_to(context.section, context.key, expected).map(PositionRef::Start)
        }
    },
    print: |position| match position {
        PositionRef::Point(point) => POINT.print(point),
        PositionRef::Start(path) => TEXT.print(path),
    },
    describe: |definitions| json!({ "anyOf": [Kind::<DVec2>::describe(&POINT, definitions), { "type": "string" }] }),
};

impl Form for StartSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("StartForm", "A place where a robot may start.");
        keys.span(&mut self.span);
        place_keys(keys, &mut self.pose.position);
        keys.key("heading_deg", "Heading in degrees, counter-clockwise from x; default: 0.")
            .optional(HEADING_WITH_TURNS, &mut self.pose.heading);
        keys.key("letter", "Letter by which robots refer to the start.").nullable(Word, &mut self.letter);
    }
}

impl Form for MarkerSpec {
    fn defaults() -> Self {
        let [red, green, blue] = MARKER_COLOUR;
        Self { colour: [red, green, blue, 255], ..Self::default() }
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("MarkerForm", "A flat spot of colour on the floor.");
        let [red, green, blue, mut opacity] = self.colour;
        let mut colour = [red, green, blue];
        keys.span(&mut self.span);
        place_keys(keys, &mut self.position);
        keys.key("colour", "Red, green and blue, 0 to 255; default: red.").optional(Channels, &mut colour);
        keys.key("opacity", "Opacity, 0 (invisible) to 255 (opaque); default: 255.").optional(0..=255, &mut opacity);
        let [red, green, blue] = colour;
        self.colour = [red, green, blue, opacity];
    }
}
