//! Checks: conditions that a run of a scene must meet.

use glam::DVec2;
use serde_json::json;
use toml::Value;
use toml::de::DeValue;

use super::kind::{Bounded, Custom, ReadContext, TEXT, Word, Words, array_schema};
use super::place::POINT;
use super::scene::UNTIL;
use super::suite::TEXTS;
use super::{Form, Keys, Variant, Variants, definition};
use crate::code::Code;
use crate::line::Quantity;
use crate::print::number::{self, in_unit};
use crate::spec::{
    BodyRef, CheckKind, CheckSpec, CountLimits, ExpectedOutput, Neighbours, ObstacleFilter, ProgramOutput, Region,
    SpannedText, SwarmMetric,
};
use crate::table::Reader;
use sim_core::record::{Kind as EventKind, Outcome};
use sim_core::time::Time;
use sim_core::unit::metres_from_mm;
use sim_core::{ObjectId, RobotId};

/// Maximum number of corners of an area, of places, and of numbers in a row or column.
const MAX_ITEMS: usize = 1000;
/// Maximum count.
const MAX_COUNT: i64 = 1_000_000_000;
const SCORE: Bounded = Bounded(Quantity::number("points", 0.0, 1e6));
const DISTANCE: Quantity = Quantity::length("distance");
const SHARE: Bounded = Bounded(Quantity::percent("share", 0.0, 100.0));
const ANY_NUMBER: Quantity = Quantity::number("number", -1e300, 1e300);
const DURATION: Quantity = Quantity::seconds("time");
/// Default side of the squares whose centres represent an area, m.
const DEFAULT_CELL: f64 = 0.05;

impl Form for CheckSpec {
    fn bare(&self) -> Self {
        Self::VARIANTS[self.variant_index()].2()
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("CheckForm", "A condition that a run must meet; docs/checks.md has an example of each kind.");
        if !keys.variant(self) {
            return;
        }
        keys.span(&mut self.span);
        let mut name = (!self.name.is_empty()).then(|| self.name.clone());
        keys.key("name", "Its name in the table and the report; default: the kind.").nullable(TEXT, &mut name);
        self.name = name.unwrap_or_default();
        keys.key("points", "Points for a run that meets the check; default: 1.").optional(SCORE, &mut self.points);
        keys.key("required", "A run that does not meet the check gets no points at all; default: false.")
            .flag(&mut self.is_required);
        kind_keys(&mut self.kind, keys);
    }
}

fn kind_keys(kind: &mut CheckKind, keys: &mut Keys<'_>) {
    match kind {
        CheckKind::Reach { body, region, by, stay } => {
            body_keys(keys, body);
            region_keys(keys, region);
            by_key(keys, by);
            let mut seconds = stay.seconds();
            keys.key("stay_s", "Seconds for which the body must stay there; default: 0.")
                .optional(Bounded(DURATION), &mut seconds);
            *stay = Time::from_seconds_ceil(seconds);
        }
        CheckKind::Visits { body, places, within, by, any_order } => {
            body_keys(keys, body);
            keys.key("places_mm", "The places, [x, y] each, in mm.").required(FLOOR_POINTS, places);
            keys.key("within_mm", "Maximum distance of the body's centre from a place, in mm.")
                .required(DISTANCE, within);
            by_key(keys, by);
            keys.key("any_order", "The order does not matter; default: false.").flag(any_order);
            refuse_few(keys, "places_mm", places.len(), 1);
        }
        CheckKind::StaysIn { body, region } => {
            body_keys(keys, body);
            region_keys(keys, region);
        }
        CheckKind::Laps { body, gate, min, by } => {
            body_keys(keys, body);
            let mut ends = gate.to_vec();
            keys.key(
                "gate_mm",
                "Both ends of the gate, [x, y] each, in mm. A passage counts from the right side to the left side, looking from the first end to the second; passages in the opposite direction are subtracted.",
            )
            .required(FLOOR_POINTS, &mut ends);
            if let [from, to] = ends[..] {
                *gate = [from, to];
            } else {
                refuse(keys, "gate_mm", "is not a gate", "two different points");
            }
            if gate[0] == gate[1] && keys.is_complete() && keys.reading().is_some() {
                refuse(keys, "gate_mm", "is not a gate", "two different points");
            }
            keys.key("min", "Minimum number of passages; default: 1.").optional(1..=MAX_COUNT, min);
            by_key(keys, by);
        }
        CheckKind::Clearance { robot, min, to } => {
            robot_key(keys, robot);
            keys.key("min_mm", "Minimum gap between the body's disc and the others, in mm.").required(DISTANCE, min);
            keys.key("to", "Bodies to which the gap is measured; default: `all`.").optional(Word, to);
        }
        CheckKind::FollowsWall { robot, gap, share } => {
            robot_key(keys, robot);
            keys.key("gap_mm", "Minimum and maximum gap between the body's disc and the nearest wall, in mm.")
                .required([DISTANCE; 2], gap);
            keys.key("share_percent", "Minimum fraction of the length of the path in percent; default: 100.")
                .optional(SHARE, share);
            if gap[0] > gap[1] {
                refuse(keys, "gap_mm", "has its least value above its greatest", "the least value first");
            }
        }
        CheckKind::Coverage { robots, width, area, cell, share, by } => {
            keys.key("robots", "Numbers of the robots; default: all of the scene.")
                .non_empty_list(ROBOT_NUMBERS, robots);
            keys.key("width_mm", "Width of the tool, a disc around each robot's centre, in mm.")
                .required(Quantity::size("width"), width);
            keys.key("area_mm", "The area: two opposite corners of a rectangle or the corners of a polygon, [x, y] each, in mm; default: the floor.")
                .nullable(AREA, area);
            keys.key("cell_mm", "Side of the squares by whose centres the area is measured, in mm; default: 50.")
                .optional(Bounded(Quantity::size("side").within(1.0, 1e6)), cell);
            keys.key("share_percent", "Minimum share of the area in percent; default: 100.").optional(SHARE, share);
            by_key(keys, by);
        }
        CheckKind::Swarm { robots, metric, min, max, since, at_end } => {
            swarm_keys(keys, robots, metric, [min, max], since, at_end)
        }
        CheckKind::OdometryError { robot, max, at_end } => {
            robot_key(keys, robot);
            keys.key("max_mm", "Maximum distance between the position by odometry and the true one, in mm.")
                .required(DISTANCE, max);
            keys.key("at_end", "Limits apply only at the end of the run; default: false.").flag(at_end);
        }
        CheckKind::Contacts { robot, with, max } => {
            any_robot_key(keys, "robot", "Number of the robot; default: all robots together.", robot);
            keys.key("with", "The obstacles that count; default: `anything`.").optional(Word, with);
            keys.key("max", "Maximum number of contacts; default: 0.").optional(0..=MAX_COUNT, max);
        }
        CheckKind::Metric { path, min, max, full, zero } => metric_keys(keys, path, [min, max, full, zero]),
        CheckKind::Prints { robot, output, expected } => {
            robot_key(keys, robot);
            keys.key("on", "Output to which the program prints; default: `stdout`.").optional(Word, output);
            expected_output_keys(keys, expected);
        }
        CheckKind::Outcome { robot, outcome } => {
            any_robot_key(keys, "robot", "Number of the robot; default: each robot with a program.", robot);
            keys.key("is", "The outcome; default: `finished`.").optional(Word, outcome);
        }
        CheckKind::Event { robot, event, count, by } => {
            any_robot_key(keys, "robot", "Number of the robot; default: all robots together.", robot);
            keys.key("event", "Kind of the events, as in docs/trace.md.").required(EVENT, event);
            count_keys(keys, count);
            by_key(keys, by);
        }
        CheckKind::Calls { robot, function, count } => {
            any_robot_key(keys, "robot", "Number of the robot; default: all robots together.", robot);
            keys.key("function", "Name of a RoBIOS function.").required(TEXT, function);
            count_keys(keys, count);
        }
        CheckKind::Message { from, to, text, count } => {
            any_robot_key(keys, "from", "Number of the sender; default: any.", from);
            any_robot_key(keys, "to", "Number of the receiver; default: any.", to);
            keys.key("text", "Text that the message contains; default: anything.").nullable(TEXT, text);
            count_keys(keys, count);
        }
        CheckKind::Script { program, arguments, timeout, .. } => {
            keys.key(
                "program",
                "The program, relative to this file's folder: a Python program or any executable file.",
            )
            .required(TEXT, program);
            keys.key("arguments", "Arguments before the paths of report and trace.").list(TEXTS, arguments);
            let mut seconds = timeout.seconds();
            keys.key("timeout_s", "Seconds of real time after which the program is stopped; default: 60.")
                .optional(Bounded(Quantity::seconds("time").within(0.1, 3600.0)), &mut seconds);
            *timeout = Time::from_seconds_ceil(seconds);
        }
    }
}

/// Words of the swarm metrics.
#[derive(Clone, Copy, PartialEq)]
enum SwarmMetricWord {
    Spread,
    Order,
    Groups,
    Coverage,
}

impl Words for SwarmMetricWord {
    const NAME: &'static str = "SwarmForm";
    const ABOUT: &'static str = "A metric of a swarm of robots.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (SwarmMetricWord::Spread, "spread", "Mean distance of the robots from their centroid, in mm."),
        (
            SwarmMetricWord::Order,
            "order",
            "Length of the mean of the directions of all moving robots: 1 if all directions are equal.",
        ),
        (SwarmMetricWord::Groups, "groups", "Number of groups that are connected by distances of at most `within_mm`."),
        (
            SwarmMetricWord::Coverage,
            "coverage",
            "Fraction of an area over which a tool at each robot has passed, 0 to 1.",
        ),
    ];
}

fn swarm_keys(
    keys: &mut Keys<'_>,
    robots: &mut Vec<RobotId>,
    metric: &mut SwarmMetric,
    [min, max]: [&mut Option<f64>; 2],
    since: &mut Time,
    at_end: &mut bool,
) {
    keys.key("robots", "Numbers of the robots; default: all of the scene.").non_empty_list(ROBOT_NUMBERS, robots);
    let (mut word, mut reach, mut tool_width, mut covered_area, mut cell_size) = match metric.clone() {
        SwarmMetric::Spread => (SwarmMetricWord::Spread, None, None, None, DEFAULT_CELL),
        SwarmMetric::Order => (SwarmMetricWord::Order, None, None, None, DEFAULT_CELL),
        SwarmMetric::Groups { reach } => (SwarmMetricWord::Groups, Some(reach), None, None, DEFAULT_CELL),
        SwarmMetric::Coverage { width, area, cell } => (SwarmMetricWord::Coverage, None, Some(width), area, cell),
    };
    keys.key("of", "The number, sampled every 100 ms.").required(Word, &mut word);
    let declares_all = keys.reading().is_none();
    if declares_all || word == SwarmMetricWord::Groups {
        keys.key("within_mm", "For `groups`: maximum distance between the centres of neighbours, in mm.")
            .nullable(Bounded(Quantity::size("distance")), &mut reach);
        refuse_missing(keys, "within_mm");
    }
    if declares_all || word == SwarmMetricWord::Coverage {
        keys.key("width_mm", "For `coverage`: width of the tool, a disc around each robot's centre, in mm.")
            .nullable(Bounded(Quantity::size("width")), &mut tool_width);
        keys.key("area_mm", "For `coverage`: corners of the area in mm; default: the floor.")
            .nullable(AREA, &mut covered_area);
        keys.key(
            "cell_mm",
            "For `coverage`: side of the squares by whose centres the area is measured, in mm; default: 50.",
        )
        .optional(Bounded(Quantity::size("side").within(1.0, 1e6)), &mut cell_size);
        refuse_missing(keys, "width_mm");
    }
    let is_length = word == SwarmMetricWord::Spread;
    let mut limits = [*min, *max].map(|limit| limit.map(|limit| if is_length { number::mm(limit) } else { limit }));
    keys.key("min", "Minimum value; in mm for `spread`.").nullable(ANY_NUMBER, &mut limits[0]);
    keys.key("max", "Maximum value; in mm for `spread`.").nullable(ANY_NUMBER, &mut limits[1]);
    let mut start = since.seconds();
    keys.key("from_s", "Simulated seconds from which the limits apply; default: 0.")
        .optional(Bounded(DURATION), &mut start);
    keys.key("at_end", "Limits apply only at the end of the run; default: false.").flag(at_end);
    if declares_all {
        return;
    }
    *since = Time::from_seconds_ceil(start);
    let to_si = |limit: Option<f64>| limit.map(|limit| if is_length { metres_from_mm(limit) } else { limit });
    (*min, *max) = (to_si(limits[0]), to_si(limits[1]));
    *metric = match word {
        SwarmMetricWord::Spread => SwarmMetric::Spread,
        SwarmMetricWord::Order => SwarmMetric::Order,
        SwarmMetricWord::Groups => SwarmMetric::Groups { reach: reach.unwrap_or_default() },
        SwarmMetricWord::Coverage => {
            SwarmMetric::Coverage { width: tool_width.unwrap_or_default(), area: covered_area, cell: cell_size }
        }
    };
    if limits[0].zip(limits[1]).is_some_and(|(min, max)| min > max) {
        refuse(keys, "max", "is less than `min`", "a number that is not less");
    }
}

/// Reports the key if the table that is being read lacks it, and makes the table unusable.
fn refuse_missing(keys: &mut Keys<'_>, key: &'static str) {
    if let Some((reader, section)) = keys.reading()
        && !section.has(key)
    {
        reader.missing(section, key);
        keys.refuse();
    }
}

/// Reports that the value of a key cannot be used, and makes the table unusable.
fn refuse(keys: &mut Keys<'_>, key: &'static str, problem: &str, expected: &str) {
    let Some((reader, section)) = keys.reading() else { return };
    if section.has(key) {
        let span = reader.value_span(section, key);
        reader.sink.error(Code::TomlType, span, format!("`{key}` {problem}"), expected.to_owned());
    }
    keys.refuse();
}

/// Reports a list with fewer than `min` points.
fn refuse_few(keys: &mut Keys<'_>, key: &'static str, count: usize, min: usize) {
    if count < min && keys.reading().is_some() {
        refuse(keys, key, "is empty", "at least one point");
    }
}

fn by_key(keys: &mut Keys<'_>, by: &mut Option<Time>) {
    keys.key("by_s", "Simulated seconds by which the condition must be met; default: the end of the run.")
        .nullable(UNTIL, by);
}

fn robot_key(keys: &mut Keys<'_>, robot: &mut RobotId) {
    keys.key("robot", "Number of the robot; default: 1.").optional(ROBOT_NUMBER, robot);
}

fn any_robot_key(keys: &mut Keys<'_>, name: &'static str, about: &'static str, robot: &mut Option<RobotId>) {
    keys.key(name, about).nullable(ROBOT_NUMBER, robot);
}

fn body_keys(keys: &mut Keys<'_>, body: &mut BodyRef) {
    let (mut robot, mut object) = match *body {
        BodyRef::Robot(RobotId(1)) => (None, None),
        BodyRef::Robot(robot) => (Some(robot), None),
        BodyRef::Object(object) => (None, Some(object)),
    };
    any_robot_key(keys, "robot", "Number of the robot; 1 if neither robot nor object is given.", &mut robot);
    keys.key("object", "Number of a movable object instead of a robot, counted from 1 in the order of the file.")
        .nullable(OBJECT_NUMBER, &mut object);
    if let Some((reader, section)) = keys.reading()
        && section.has("object")
        && !reader.exclude(section, "object", &["robot"])
    {
        keys.refuse();
    }
    *body = match (robot, object) {
        (_, Some(object)) => BodyRef::Object(object),
        (robot, None) => BodyRef::Robot(robot.unwrap_or(RobotId(1))),
    };
}

fn region_keys(keys: &mut Keys<'_>, region: &mut Region) {
    let (mut centre, mut radius, mut area) = match region.clone() {
        Region::Disc { centre, radius } => (Some(centre), Some(radius), None),
        Region::Polygon(corners) => (None, None, Some(corners)),
    };
    if keys.reading().is_some() {
        (centre, radius) = (None, None);
    }
    keys.key("at_mm", "The place: its centre, [x, y], in mm.").nullable(POINT, &mut centre);
    keys.key("within_mm", "Maximum distance of the body's centre from `at_mm`, in mm.").nullable(DISTANCE, &mut radius);
    keys.key("area_mm", "The place, instead of `at_mm`: two opposite corners of a rectangle or the corners of a polygon, [x, y] each, in mm.")
        .nullable(AREA, &mut area);
    let Some((reader, section)) = keys.reading() else { return };
    if section.has("area_mm") {
        let is_clean = reader.exclude(section, "area_mm", &["at_mm", "within_mm"]);
        match area.filter(|_| is_clean) {
            Some(corners) => *region = Region::Polygon(corners),
            None => keys.refuse(),
        }
        return;
    }
    for key in ["at_mm", "within_mm"] {
        if !section.has(key) {
            let message = format!("a check has no `{key}`");
            let expected = "`at_mm = [x, y]` with `within_mm`, or `area_mm` with the corners of an area";
            reader.sink.error(Code::TomlMissing, section.span, message, expected);
        }
    }
    match centre.zip(radius) {
        Some((centre, radius)) => *region = Region::Disc { centre, radius },
        None => keys.refuse(),
    }
}

fn count_keys(keys: &mut Keys<'_>, count: &mut CountLimits) {
    let default_min = |count: &CountLimits| if count.max.is_some() { 0 } else { 1 };
    let mut min = Some(count.min).filter(|min| keys.reading().is_none() && *min != default_min(count));
    keys.key("min", "Minimum number; default: 1, or 0 if only `max` is given.").nullable(0..=MAX_COUNT, &mut min);
    keys.key("max", "Maximum number; default: any.").nullable(0..=MAX_COUNT, &mut count.max);
    if keys.reading().is_none() {
        return;
    }
    count.min = min.unwrap_or_else(|| default_min(count));
    if count.max.is_some_and(|max| max < count.min) {
        refuse(keys, "max", "is less than `min`", "a number that is not less");
    }
}

fn metric_keys(keys: &mut Keys<'_>, path: &mut String, [min, max, full, zero]: [&mut Option<f64>; 4]) {
    keys.key("path", "Path into the report, such as `robots[0].path_m`.").required(TEXT, path);
    keys.key("min", "Minimum value.").nullable(ANY_NUMBER, min);
    keys.key("max", "Maximum value.").nullable(ANY_NUMBER, max);
    keys.key("full", "Value for all points.").nullable(ANY_NUMBER, full);
    keys.key("zero", "Value for no points; between it and `full`, points are proportional.").nullable(ANY_NUMBER, zero);
    let Some((reader, section)) = keys.reading() else { return };
    let (has_limits, has_scale) = (min.is_some() || max.is_some(), full.is_some() || zero.is_some());
    let problem = if has_limits && has_scale {
        Some((Code::TomlConflict, "`min` and `max` exclude `full` and `zero`"))
    } else if !has_limits && full.is_none() | zero.is_none() {
        Some((Code::TomlMissing, "a metric has no limit"))
    } else if full.is_some() && full == zero {
        Some((Code::TomlConflict, "`full` and `zero` are equal"))
    } else if min.zip(*max).is_some_and(|(min, max)| min > max) {
        Some((Code::TomlConflict, "`min` is greater than `max`"))
    } else {
        None
    };
    if let Some((code, message)) = problem {
        let expected = "`min`, `max` or both; or `full` and `zero`, which differ";
        reader.sink.error(code, section.span, message, expected);
        keys.refuse();
    }
}

fn expected_output_keys(keys: &mut Keys<'_>, expected: &mut ExpectedOutput) {
    let (mut text, mut pattern, mut rows, mut tolerance) = (None, None, None, 0.0);
    match expected.clone() {
        _ if keys.reading().is_some() => {}
        ExpectedOutput::Text(old) => text = Some(old),
        ExpectedOutput::Pattern(old) => pattern = Some(old),
        ExpectedOutput::Numbers { rows: old_rows, tolerance: old_tolerance } => {
            (rows, tolerance) = (Some(old_rows), old_tolerance);
        }
    }
    keys.key("text", "Text within a line.").nullable(TEXT, &mut text);
    keys.key("pattern", "A whole line, in which `*` stands for any text.").nullable(TEXT, &mut pattern);
    keys.key("numbers", "Numbers row by row, such as [1, 2, 3] or [[1, 2], [3, 4]]; other words may be between them.")
        .nullable(ROWS, &mut rows);
    keys.key("tolerance", "Maximum deviation of a number; default: 0.")
        .optional(Bounded(Quantity::number("tolerance", 0.0, 1e300)), &mut tolerance);
    let Some((reader, section)) = keys.reading() else { return };
    let key_count = ["text", "pattern", "numbers"].into_iter().filter(|key| section.has(key)).count();
    if key_count != 1 {
        let code = if key_count == 0 { Code::TomlMissing } else { Code::TomlConflict };
        let message = format!("a check of `prints` has {key_count} of `text`, `pattern` and `numbers`");
        reader.sink.error(code, section.span, message, "one of them");
    }
    let printed = match (text, pattern, rows) {
        (Some(text), None, None) => Some(ExpectedOutput::Text(text)),
        (None, Some(pattern), None) => Some(ExpectedOutput::Pattern(pattern)),
        (None, None, Some(rows)) => Some(ExpectedOutput::Numbers { rows, tolerance }),
        _ => None,
    };
    match printed {
        Some(printed) if key_count == 1 => *expected = printed,
        _ => keys.refuse(),
    }
}

/// Number of a robot.
pub(super) const ROBOT_NUMBER: Custom<RobotId> = Custom {
    read: |context| {
        context
            .reader
            .integer(context.section, context.key, 1, i64::from(u32::MAX))
            .map(|number| RobotId(number as u32))
    },
    print: |robot| i64::from(robot.0).into(),
    describe: |_| json!({ "type": "integer", "format": "uint32", "minimum": 1 }),
};

/// Number of an object.
const OBJECT_NUMBER: Custom<ObjectId> = Custom {
    read: |context| {
        context
            .reader
            .integer(context.section, context.key, 1, i64::from(u32::MAX))
            .map(|number| ObjectId(number as u32))
    },
    print: |object| i64::from(object.0).into(),
    describe: |_| json!({ "type": "integer", "format": "uint32", "minimum": 1 }),
};

/// Numbers of robots.
const ROBOT_NUMBERS: Custom<Vec<RobotId>> = Custom {
    read: |ReadContext { reader, section, key }| {
        let items = reader.array(section, key, "an array of numbers of robots")?;
        let number = |item| reader.as_integer(key, item, 1, i64::from(u32::MAX));
        Some(items.iter().filter_map(number).map(|number| RobotId(number as u32)).collect())
    },
    print: |robots| Value::Array(robots.iter().map(|robot| i64::from(robot.0).into()).collect()),
    describe: |_| json!({ "type": "array", "items": { "type": "integer", "format": "uint32", "minimum": 1 } }),
};

/// Points on the floor.
const FLOOR_POINTS: Custom<Vec<DVec2>> = Custom {
    read: |ReadContext { reader, section, key }| {
        let items = reader.array(section, key, "an array of points [x, y]")?;
        if items.len() > MAX_ITEMS {
            let span = reader.value_span(section, key);
            let message = format!("`{key}` has {} points", items.len());
            reader.sink.error(Code::TomlType, span, message, format!("at most {MAX_ITEMS} points"));
            return None;
        }
        let mut points = Vec::with_capacity(items.len());
        for item in items {
            let numbers = match item.get_ref() {
                DeValue::Array(numbers) if numbers.len() == 2 => numbers,
                _ => {
                    reader.wrong_type(key, item, "a point [x, y]");
                    return None;
                }
            };
            let [x, y] = [0, 1].map(|index| reader.as_number(key, &numbers[index], &POINT[index]));
            points.push(DVec2::new(x?, y?));
        }
        Some(points)
    },
    print: |points| {
        let point = |point: &DVec2| {
            let numbers = POINT.iter().zip(point.to_array());
            Value::Array(numbers.map(|(quantity, number)| in_unit(quantity, number).into()).collect())
        };
        Value::Array(points.iter().map(point).collect())
    },
    describe: |_| {
        let point = array_schema(json!({ "type": "number", "format": "double" }), 2);
        json!({ "type": "array", "items": point })
    },
};

/// Corners of an area; two points are opposite corners of a rectangle.
const AREA: Custom<Vec<DVec2>> = Custom {
    read: |context| {
        let span = context.reader.value_span(context.section, context.key);
        let corners = (FLOOR_POINTS.read)(ReadContext {
            reader: &mut *context.reader,
            section: &mut *context.section,
            key: context.key,
        })?;
        let corners = match corners[..] {
            [a, b] => vec![a, DVec2::new(b.x, a.y), b, DVec2::new(a.x, b.y)],
            _ => corners,
        };
        let area: f64 = corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum();
        if corners.len() < 3 || area == 0.0 {
            let message = format!("`{}` is not an area", context.key);
            context.reader.sink.error(
                Code::TomlType,
                span,
                message,
                "two opposite corners, or three or more that enclose an area",
            );
            return None;
        }
        Some(corners)
    },
    print: FLOOR_POINTS.print,
    describe: FLOOR_POINTS.describe,
};

/// Rows of numbers; a single row may be written without the outer array.
const ROWS: Custom<Vec<Vec<f64>>> = Custom {
    read: |ReadContext { reader, section, key }| {
        let span = reader.value_span(section, key);
        let items = reader.array(section, key, "an array of numbers, or of rows of numbers")?;
        let is_nested = items.iter().any(|item| matches!(item.get_ref(), DeValue::Array(_)));
        let row = |reader: &mut Reader, items: &[toml::Spanned<DeValue<'_>>]| -> Option<Vec<f64>> {
            items.iter().map(|item| reader.as_number(key, item, &ANY_NUMBER)).collect()
        };
        let rows: Vec<Vec<f64>> = if is_nested {
            let mut rows = Vec::new();
            for item in items {
                match item.get_ref() {
                    DeValue::Array(numbers) => rows.push(row(reader, numbers)?),
                    _ => {
                        reader.wrong_type(key, item, "a row of numbers");
                        return None;
                    }
                }
            }
            rows
        } else {
            vec![row(reader, items)?]
        };
        if rows.is_empty() || rows.len() > MAX_ITEMS || rows.iter().any(|row| row.is_empty() || row.len() > MAX_ITEMS) {
            let message = format!("`{key}` has an empty row, or too many numbers");
            reader.sink.error(
                Code::TomlType,
                span,
                message,
                format!("1 to {MAX_ITEMS} rows of 1 to {MAX_ITEMS} numbers"),
            );
            return None;
        }
        Some(rows)
    },
    print: |rows| {
        let row = |row: &Vec<f64>| Value::Array(row.iter().map(|number| (*number).into()).collect());
        Value::Array(rows.iter().map(row).collect())
    },
    describe: |_| {
        let row = json!({ "type": "array", "items": { "type": "number", "format": "double" } });
        json!({ "type": "array", "items": { "anyOf": [{ "type": "number", "format": "double" }, row] } })
    },
};

/// Kind of an event of the trace.
const EVENT: Custom<EventKind> = Custom {
    read: |context| {
        let names: Vec<&str> = event_kinds().map(EventKind::name).collect();
        let index = context.reader.choice(context.section, context.key, &names)?;
        event_kinds().nth(index)
    },
    print: |kind| kind.name().into(),
    describe: |definitions| {
        definition(definitions, "EventForm", |_| {
            let names: Vec<&str> = event_kinds().map(EventKind::name).collect();
            json!({ "description": "Kind of an event of the trace.", "type": "string", "enum": names })
        })
    },
};

/// Kinds of events that a check of kind `event` can count; calls have a check of their own.
fn event_kinds() -> impl Iterator<Item = EventKind> {
    EventKind::ALL.iter().copied().filter(|kind| *kind != EventKind::Call)
}

impl Words for Neighbours {
    const NAME: &'static str = "NeighboursForm";
    const ABOUT: &'static str = "Bodies to which a clearance is measured.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Neighbours::All, "all", "Walls, fixed objects and robots."),
        (Neighbours::Walls, "walls", "Walls and fixed objects."),
        (Neighbours::Robots, "robots", "Other robots."),
    ];
}

impl Words for ObstacleFilter {
    const NAME: &'static str = "ContactedForm";
    const ABOUT: &'static str = "Obstacles that a count of contacts includes.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (ObstacleFilter::Anything, "anything", "Walls, terrain, robots and objects."),
        (ObstacleFilter::Walls, "walls", "Walls, fixed objects and terrain."),
        (ObstacleFilter::Robots, "robots", "Robots."),
        (ObstacleFilter::Objects, "objects", "Movable objects."),
    ];
}

impl Words for ProgramOutput {
    const NAME: &'static str = "ScreenForm";
    const ABOUT: &'static str = "Where a program prints.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (ProgramOutput::Stdout, "stdout", "Standard output, during the whole run."),
        (ProgramOutput::Display, "display", "The display, as it is at the end of the run."),
    ];
}

impl Words for Outcome {
    const NAME: &'static str = "OutcomeForm";
    const ABOUT: &'static str = "End of a program.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Outcome::Finished, "finished", "It returned 0."),
        (Outcome::Running, "running", "The run ended while it ran."),
        (Outcome::Waiting, "waiting", "It waits for an event that can no longer occur."),
        (Outcome::Interrupted, "interrupted", "The user ended the run."),
        (Outcome::Failed, "failed", "It panicked, crashed or returned a code other than 0."),
        (Outcome::Timeout, "timeout", "It computed for too long without a RoBIOS call."),
        (Outcome::NoProgram, "no_program", "The robot has no program."),
        (Outcome::Removed, "removed", "The robot was removed before its program ended."),
        (Outcome::Halted, "halted", "A fault of the scene (`dies`) ended the program."),
    ];
}

const FIRST_ROBOT: BodyRef = BodyRef::Robot(RobotId(1));
const EMPTY_DISC: Region = Region::Disc { centre: DVec2::ZERO, radius: 0.0 };

impl Variants for CheckSpec {
    const VARIANTS: &'static [Variant<Self>] = &[
        ("reach", "The centre of a robot or object reaches a place.", || {
            Self::new(CheckKind::Reach { body: FIRST_ROBOT, region: EMPTY_DISC, by: None, stay: Time::ZERO })
        }),
        ("visits", "The centre of a robot or object reaches several places.", || {
            let places = Vec::new();
            Self::new(CheckKind::Visits { body: FIRST_ROBOT, places, within: 0.0, by: None, any_order: false })
        }),
        ("stays_in", "The centre of a robot or object never leaves a place.", || {
            Self::new(CheckKind::StaysIn { body: FIRST_ROBOT, region: EMPTY_DISC })
        }),
        ("laps", "The centre of a robot or object passes a gate at least `min` times.", || {
            Self::new(CheckKind::Laps { body: FIRST_ROBOT, gate: [DVec2::ZERO; 2], min: 1, by: None })
        }),
        ("clearance", "The gap between a robot's body and others is never smaller than a limit.", || {
            Self::new(CheckKind::Clearance { robot: RobotId(1), min: 0.0, to: Neighbours::All })
        }),
        ("follows_wall", "A robot drives along walls.", || {
            Self::new(CheckKind::FollowsWall { robot: RobotId(1), gap: [0.0; 2], share: 1.0 })
        }),
        ("coverage", "Robots cover a fraction of an area.", || {
            let robots = Vec::new();
            Self::new(CheckKind::Coverage { robots, width: 0.0, area: None, cell: DEFAULT_CELL, share: 1.0, by: None })
        }),
        ("swarm", "A metric of a swarm of robots stays within limits.", || {
            let (robots, metric, since) = (Vec::new(), SwarmMetric::Spread, Time::ZERO);
            Self::new(CheckKind::Swarm { robots, metric, min: None, max: None, since, at_end: false })
        }),
        ("odometry_error", "Odometry never deviates from the truth by more than a limit.", || {
            Self::new(CheckKind::OdometryError { robot: RobotId(1), max: 0.0, at_end: false })
        }),
        ("contacts", "Robots touch obstacles at most `max` times.", Self::default),
        ("metric", "A number of the report is within limits.", || {
            let path = String::new();
            Self::new(CheckKind::Metric { path, min: None, max: None, full: None, zero: None })
        }),
        ("prints", "A program prints something.", || {
            let expected = ExpectedOutput::Text(String::new());
            Self::new(CheckKind::Prints { robot: RobotId(1), output: ProgramOutput::Stdout, expected })
        }),
        ("outcome", "Programs end with a given outcome.", || {
            Self::new(CheckKind::Outcome { robot: None, outcome: Outcome::Finished })
        }),
        ("event", "Events of a kind occur between `min` and `max` times.", || {
            let count = CountLimits::default();
            Self::new(CheckKind::Event { robot: None, event: EventKind::Beep, count, by: None })
        }),
        ("calls", "A RoBIOS function is called between `min` and `max` times.", || {
            let (function, count) = (String::new(), CountLimits::default());
            Self::new(CheckKind::Calls { robot: None, function, count })
        }),
        ("message", "Radio messages are read between `min` and `max` times.", || {
            let count = CountLimits::default();
            Self::new(CheckKind::Message { from: None, to: None, text: None, count })
        }),
        ("script", "A program of the user judges the report and the trace.", || {
            let (program, arguments, folder) = (SpannedText::default(), Vec::new(), String::new());
            Self::new(CheckKind::Script { program, arguments, timeout: Time::from_millis(60_000), folder })
        }),
    ];

    fn variant_index(&self) -> usize {
        let word = self.kind.word();
        Self::VARIANTS.iter().position(|(known, ..)| *known == word).unwrap_or_default()
    }
}
