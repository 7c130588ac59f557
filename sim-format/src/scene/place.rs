//! What stands in a scene: robots, alone and in groups, and objects.

use glam::DVec2;

use super::type_ref;
use crate::code::Code;
use crate::line::Quantity;
use crate::spec::{Layout, ObjectLine, RobotLine, StartRef, TypeRef};
use crate::table::{Reader, Section};
use sim_core::RobotId;
use sim_core::pose::Pose;

/// Robots that a scene may have at most.
pub(crate) const MAX_ROBOTS: u32 = 100_000;

/// Kinds of layouts.
pub(crate) const LAYOUTS: [&str; 5] = ["starts", "line", "grid", "circle", "random"];

/// Letters of mazes that a robot may start at.
const START_LETTERS: [&str; 5] = ["S", "U", "R", "D", "L"];

/// Extensions of files that are robot types, and of those that are object types.
const ROBOT_FILES: [&str; 1] = ["robi"];
const OBJECT_FILES: [&str; 4] = ["esobj", "obj", "ms3d", "iv"];

const POINT: [Quantity; 2] = [Quantity::coordinate("x"), Quantity::coordinate("y")];
const HEADING: Quantity = Quantity::angle("heading");

impl Reader<'_> {
    /// A robot of the scene `file`, or a group of them; and how many it would be if all was well.
    pub(super) fn robot(&mut self, mut section: Section<'_, '_>, file: &str) -> (Option<RobotLine>, u32) {
        let kind = self.required_reference(&mut section, "type").map(|kind| type_ref(kind, &ROBOT_FILES));
        let program = self.reference(&mut section, "program");
        let arguments = self.texts(&mut section, "arguments");
        let api = self.api(&mut section);
        let noise = self.noise_ref(&mut section, file);
        let id = self.integer(&mut section, "id", 1, i64::from(MAX_ROBOTS)).map(|id| RobotId(id as u32));
        let start = self.start(&mut section);
        let count = match start {
            Some(StartRef::Many { count, .. }) => count,
            _ => 1,
        };
        if count > 1 {
            self.exclude(&mut section, "count", &["id"]);
        }
        if program.is_none() && !arguments.is_empty() {
            let span = self.key_span(&section, "arguments");
            let message = "`arguments` without a `program`; one of the command line gets them";
            self.sink.warn(Code::TomlMissing, span, message, "a line `program = ...`");
        }
        self.unknown_keys(&section);
        let line = |kind: TypeRef, start: StartRef| RobotLine {
            id: id.filter(|_| count == 1),
            kind,
            program,
            arguments,
            api,
            noise,
            start,
            span: section.span,
        };
        (kind.zip(start).map(|(kind, start)| line(kind, start)), count)
    }

    /// Where a robot or the robots of a group start; `None` if that cannot be read, which has been told.
    fn start(&mut self, section: &mut Section<'_, '_>) -> Option<StartRef> {
        let has_count = section.has("count");
        let count = self.integer(section, "count", 1, i64::from(MAX_ROBOTS)).map(|count| count as u32);
        if has_count && count.is_none() {
            return None;
        }
        if section.has("layout") {
            let layout = self.section(section, "layout").and_then(|layout| self.layout(layout));
            self.exclude(section, "layout", &["x_mm", "y_mm", "heading_deg", "start"]);
            return Some(StartRef::Many { count: count.unwrap_or(1), layout: layout? });
        }
        section.get("layout");
        if has_count {
            let is_clean = self.exclude(section, "count", &["x_mm", "y_mm", "heading_deg", "start"]);
            return count.filter(|_| is_clean).map(|count| StartRef::Many { count, layout: Layout::Starts });
        }
        if section.has("start") {
            let letter = self.choice(section, "start", &START_LETTERS);
            self.exclude(section, "start", &["x_mm", "y_mm"]);
            let heading = self.number(section, "heading_deg", &HEADING);
            let letter = letter.and_then(|place| START_LETTERS[place].chars().next())?;
            return Some(StartRef::Letter { letter, heading });
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

    /// `x_mm`, `y_mm` and `heading_deg`, which is 0 where it is left out.
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

    fn layout(&mut self, mut section: Section<'_, '_>) -> Option<Layout> {
        let kind = self.required_choice(&mut section, "kind", &LAYOUTS);
        let section = &mut section;
        let layout = match LAYOUTS[kind?] {
            "line" => self.line(section),
            "grid" => self.grid(section),
            "circle" => self.circle(section),
            "random" => self.random(section),
            _ => Some(Layout::Starts),
        };
        self.unknown_keys(section);
        layout
    }

    fn line(&mut self, section: &mut Section<'_, '_>) -> Option<Layout> {
        let from = self.required_numbers(section, "from_mm", &POINT).map(DVec2::from);
        let to = self.required_numbers(section, "to_mm", &POINT).map(DVec2::from);
        let heading = self.number(section, "heading_deg", &HEADING).unwrap_or_default();
        Some(Layout::Line { from: from?, to: to?, heading })
    }

    fn grid(&mut self, section: &mut Section<'_, '_>) -> Option<Layout> {
        let spacing = [Quantity::size("distance of columns"), Quantity::size("distance of rows")];
        let from = self.required_numbers(section, "from_mm", &POINT).map(DVec2::from);
        let spacing = self.required_numbers(section, "spacing_mm", &spacing).map(DVec2::from);
        let columns = self.integer(section, "columns", 1, i64::from(MAX_ROBOTS)).map(|columns| columns as u32);
        let heading = self.number(section, "heading_deg", &HEADING).unwrap_or_default();
        Some(Layout::Grid { from: from?, spacing: spacing?, columns, heading })
    }

    fn circle(&mut self, section: &mut Section<'_, '_>) -> Option<Layout> {
        let centre = self.required_numbers(section, "centre_mm", &POINT).map(DVec2::from);
        let radius = self.required(section, "radius_mm", &Quantity::size("radius"));
        let first = self.number(section, "first_deg", &Quantity::angle("direction of the first")).unwrap_or_default();
        let facing = self.number(section, "facing_deg", &HEADING).unwrap_or_default();
        Some(Layout::Circle { centre: centre?, radius: radius?, first, facing })
    }

    fn random(&mut self, section: &mut Section<'_, '_>) -> Option<Layout> {
        let has_area = section.has("from_mm") || section.has("to_mm");
        let area = if has_area {
            let from = self.required_numbers(section, "from_mm", &POINT).map(DVec2::from);
            let to = self.required_numbers(section, "to_mm", &POINT).map(DVec2::from);
            let [from, to] = [from?, to?];
            Some([from.min(to), from.max(to)])
        } else {
            section.get("from_mm");
            section.get("to_mm");
            None
        };
        let clearance = self.number(section, "clearance_mm", &Quantity::length("clearance")).unwrap_or_default();
        let heading = self.number(section, "heading_deg", &HEADING);
        Some(Layout::Random { area, clearance, heading })
    }

    /// A passive object, of the scene or of its world.
    pub(super) fn object(&mut self, mut section: Section<'_, '_>) -> Option<ObjectLine> {
        let kind = self.required_reference(&mut section, "type").map(|kind| type_ref(kind, &OBJECT_FILES));
        let pose = self.pose(&mut section);
        let friction = self.number(&mut section, "friction", &Quantity::number("friction", 0.0, 1e6));
        self.unknown_keys(&section);
        Some(ObjectLine { kind: kind?, pose: pose?, friction, span: section.span })
    }
}
