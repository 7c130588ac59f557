//! The world of a scene: a file, or described in place by walls or by the text of a maze.

use glam::DVec2;
use toml::Spanned;
use toml::de::DeValue;

use crate::code::Code;
use crate::diagnostic::Diagnostic;
use crate::line::Quantity;
use crate::spec::{DEFAULT_WALL_HEIGHT, SimSpec, StartSpec, WallSpec, WorldKind, WorldLine, WorldSpec};
use crate::table::{Reader, Section};
use crate::{Span, path, read_maze};
use sim_core::pose::Pose;

/// Keys that describe a world by its walls.
const OF_WALLS: [&str; 3] = ["floor_mm", "wall", "cell_mm"];
/// Keys that describe a world in place.
const INLINE: [&str; 9] = ["floor_mm", "wall", "maze", "cell_mm", "texture", "surface", "terrain", "start", "object"];

const KINDS: [&str; 2] = ["world", "maze"];
/// Length of the unit of a mesh.
pub(super) const MESH_UNIT: Quantity = Quantity::coordinate("length of the mesh's unit").within(1e-6, 1e9);
pub(super) const POINT: [Quantity; 2] = [Quantity::coordinate("x"), Quantity::coordinate("y")];

impl Reader<'_> {
    pub(super) fn world(&mut self, mut section: Section<'_, '_>, sim: &mut SimSpec) {
        if section.has("file") {
            let kind = self.choice(&mut section, "kind", &KINDS);
            if let Some(path) = self.reference(&mut section, "file") {
                let kind = match (path::extension(&path.text).as_str(), kind) {
                    ("maz" | "maze", _) | (_, Some(1)) => WorldKind::Maze,
                    _ => WorldKind::World,
                };
                sim.world = Some(WorldLine { kind, path, looks: self.looks(&mut section) });
            }
            self.exclude(&mut section, "file", &INLINE);
            self.unknown_keys(&section);
            return;
        }
        section.get("file");
        let mut world = if section.has("maze") { self.maze(&mut section, sim) } else { self.walls(&mut section, sim) };
        world.texture = self.reference_to(&mut section, "texture", "the name of an image file, between double quotes");
        if let Some(surface) = self.section_like(&mut section, "surface", "reflectivity = 1, specular = 0.5") {
            world.surface = Some(self.surface(surface));
        }
        world.terrain = self.terrain(&mut section, world.floor);
        world.looks = self.looks(&mut section);
        for start in self.sections(&mut section, "start") {
            world.starts.extend(self.start_place(start));
        }
        for object in self.sections(&mut section, "object") {
            world.objects.extend(self.object(object));
        }
        self.unknown_keys(&section);
        sim.inline.world = Some(world);
    }

    fn walls(&mut self, section: &mut Section<'_, '_>, sim: &SimSpec) -> WorldSpec {
        let sides = [Quantity::size("width"), Quantity::size("height")];
        let floor = self.required_numbers(section, "floor_mm", &sides).map(DVec2::from).unwrap_or_default();
        let cell = self.number(section, "cell_mm", &Quantity::size("cell size"));
        section.get("maze");
        let mut walls = Vec::new();
        for wall in self.sections(section, "wall") {
            walls.extend(self.wall(wall));
        }
        WorldSpec { file: sim.file.clone(), floor, cell, walls, ..WorldSpec::default() }
    }

    fn wall(&mut self, mut section: Section<'_, '_>) -> Option<WallSpec> {
        let from = self.required_numbers(&mut section, "from_mm", &POINT).map(DVec2::from);
        let to = self.required_numbers(&mut section, "to_mm", &POINT).map(DVec2::from);
        let [mut thickness, mut height] = [0.0, DEFAULT_WALL_HEIGHT];
        self.set(&mut section, "thickness_mm", &Quantity::length("thickness"), &mut thickness);
        self.set(&mut section, "height_mm", &Quantity::size("height"), &mut height);
        let colour = self.shades(&mut section, "colour");
        let surface = self.section(&mut section, "surface").map(|surface| self.surface(surface));
        self.unknown_keys(&section);
        let (from, to) = (from?, to?);
        if from == to {
            let message = "both ends of the wall are equal; it is left out";
            self.sink.warn(Code::WldWallLength, section.span, message, "two different ends");
            return None;
        }
        Some(WallSpec { from, to, thickness, height, colour, surface, span: section.span })
    }

    fn start_place(&mut self, mut section: Section<'_, '_>) -> Option<StartSpec> {
        let x = self.required(&mut section, "x_mm", &POINT[0]);
        let y = self.required(&mut section, "y_mm", &POINT[1]);
        let heading = self.number(&mut section, "heading_deg", &Quantity::angle("heading")).unwrap_or_default();
        let letter = self.choice(&mut section, "letter", &["S", "U", "R", "D", "L"]);
        self.unknown_keys(&section);
        let letter = letter.map(|place| ['S', 'U', 'R', 'D', 'L'][place]);
        Some(StartSpec { pose: Pose::new(x?, y?, heading), letter, span: section.span })
    }

    /// A world drawn as the text of a `.maz`.
    fn maze(&mut self, section: &mut Section<'_, '_>, sim: &SimSpec) -> WorldSpec {
        self.exclude(section, "maze", &OF_WALLS);
        let value = section.get("maze");
        let drawing = self.text(section, "maze").unwrap_or_default();
        let Some(value) = value.filter(|_| !drawing.is_empty()) else {
            return WorldSpec { file: sim.file.clone(), ..WorldSpec::default() };
        };
        let (mut world, diagnostics) = read_maze(&sim.file, &drawing);
        let place = self.place_of(value, &drawing);
        for diagnostic in diagnostics {
            let Diagnostic { severity, code, span, message, expected, suggestion, .. } = diagnostic;
            self.sink.report(severity, code, place.of(span), message, expected).suggestion = suggestion;
        }
        for span in world.walls.iter_mut().map(|wall| &mut wall.span) {
            *span = place.of(*span);
        }
        world.starts.iter_mut().for_each(|start| start.span = place.of(start.span));
        world.objects.iter_mut().for_each(|object| object.span = place.of(object.span));
        world
    }

    /// Where the characters of a text stand in the file.
    fn place_of(&self, value: &Spanned<DeValue<'_>>, text: &str) -> TextPlace {
        let whole = self.span(value.span());
        let written = self.text.get(value.span()).unwrap_or_default();
        // Only a text that is written as it is read has its characters one after the other.
        let first = written.find(text).filter(|_| !text.is_empty());
        let first_line = first.map(|first| written[..first].matches('\n').count() as u32);
        match (first, first_line) {
            (Some(first), Some(lines)) if lines > 0 => TextPlace::Written {
                start: whole.start + first,
                end: whole.start + first + text.len(),
                line: whole.line + lines,
            },
            _ => TextPlace::Whole(whole),
        }
    }
}

/// How places in a text that is a value become places in the file.
enum TextPlace {
    /// The text begins a line of the file and stands there as it is.
    Written { start: usize, end: usize, line: u32 },
    /// It is written in another way: only the value as a whole has a place.
    Whole(Span),
}

impl TextPlace {
    fn of(&self, span: Span) -> Span {
        match *self {
            TextPlace::Written { start, end, line } if span.line > 0 => Span {
                start: (start + span.start).min(end),
                end: (start + span.end).min(end),
                line: line + span.line - 1,
                column: span.column,
            },
            TextPlace::Written { start, end, line } => Span { start, end, line, column: 1 },
            TextPlace::Whole(whole) => whole,
        }
    }
}
