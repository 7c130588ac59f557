//! World of a scene: a file, or an inline description by walls or by the drawing of a maze.

use glam::DVec2;

use super::kind::{Bounded, Channels, Flag, IMAGE, TABLE, TABLES, TEXT, TableWithExample, Word, Words};
use super::place::{MAX_REPETITIONS, POINT, SCATTER};
use super::terrain::TerrainTable;
use super::{Form, Keys};
use crate::code::Code;
use crate::line::Quantity;
use crate::map;
use crate::path;
use crate::print::print_maze;
use crate::spec::{
    DEFAULT_WALL_HEIGHT, LightSpec, LooksSpec, Scatter, SimSpec, SkySpec, SpannedText, WallSpec, WorldKind, WorldLine,
    WorldSpec,
};
use crate::world::WATER;

/// Keys that describe an inline world by its walls.
const WALL_KEYS: [&str; 3] = ["floor_mm", "wall", "cell_mm"];
/// Keys that describe an inline world.
const INLINE_KEYS: [&str; 10] =
    ["floor_mm", "wall", "maze", "texture", "texture_turned", "surface", "terrain", "water_mm", "start", "object"];

/// World of a scene, structured like the table `world`.
#[derive(Clone, Default)]
pub(crate) struct WorldTable {
    file: Option<SpannedText>,
    kind: Option<WorldKind>,
    maze: Option<String>,
    floor: Option<DVec2>,
    spec: WorldSpec,
    is_inline: bool,
}

impl WorldTable {
    /// The world of `sim`. An inline maze becomes a drawing if the drawing reproduces it exactly.
    pub(crate) fn from_sim(sim: &SimSpec) -> Self {
        match (&sim.inline.world, &sim.world) {
            (Some(spec), _) => match spec.cell.and_then(|_| print_maze(spec).ok()) {
                Some(maze) => {
                    let spec = WorldSpec {
                        cell: None,
                        walls: Vec::new(),
                        starts: Vec::new(),
                        objects: Vec::new(),
                        ..spec.clone()
                    };
                    Self { maze: Some(maze), spec, ..Self::default() }
                }
                None => Self { floor: Some(spec.floor), spec: spec.clone(), ..Self::default() },
            },
            (None, Some(line)) => {
                let kind = match (line.kind, path::extension(&line.path.text).as_str()) {
                    (WorldKind::Maze, "maz" | "maze") | (WorldKind::World, "wld") => None,
                    (kind, _) => Some(kind),
                };
                let spec = WorldSpec { looks: line.looks, cell: line.cell, ..WorldSpec::default() };
                Self { file: Some(line.path.clone()), kind, spec, ..Self::default() }
            }
            (None, None) => Self::default(),
        }
    }

    /// Makes the world that was read the world of `sim`.
    pub(crate) fn store_in(self, sim: &mut SimSpec) {
        if self.is_inline {
            sim.inline.world = Some(self.spec);
        } else if let Some(path) = self.file {
            let kind = kind_of_file(&path, self.kind);
            sim.world = Some(WorldLine { kind, path, cell: self.spec.cell, looks: self.spec.looks });
        }
    }
}

/// Kind of a world file: a maze if it has the extension of one, otherwise as stated, and a world if nothing is stated.
fn kind_of_file(path: &SpannedText, stated: Option<WorldKind>) -> WorldKind {
    match path::extension(&path.text).as_str() {
        "maz" | "maze" => WorldKind::Maze,
        _ => stated.unwrap_or(WorldKind::World),
    }
}

impl Form for WorldTable {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("WorldForm", "The world.");
        let is_reading = keys.reading().is_some();
        let mut is_given = |key: &str| keys.reading().is_some_and(|(_, section)| section.has(key));
        let (has_file, has_drawing) = (is_given("file"), is_given("maze"));
        if has_file {
            keys.mention_first(&["kind"]);
        }
        keys.key("file", "A `.wld`, a `.maz` or a map of another program; excludes all other keys except `kind`, `cell_mm`, `colour`, `light` and `sky`.")
            .nullable(TEXT, &mut self.file);
        if has_file || !is_reading {
            keys.key("kind", "Kind of a file whose extension does not determine it; default: `world`.")
                .nullable(Word, &mut self.kind);
        }
        if has_file {
            if let Some(file) = &self.file {
                let is_maze =
                    kind_of_file(file, self.kind) == WorldKind::Maze || map::WorldFormat::may_have_cells(&file.text);
                cell_key(keys, &mut self.spec.cell);
                looks_keys(keys, &mut self.spec.looks);
                if let Some((reader, section)) = keys.reading()
                    && section.has("cell_mm")
                    && !is_maze
                {
                    let message = format!(
                        "`cell_mm` is the size of cells that a file does not state, and `{}` has none",
                        file.text
                    );
                    let span = reader.key_span(section, "cell_mm");
                    reader.sink.error(
                        Code::TomlConflict,
                        span,
                        message,
                        "a `.maz`, `.map`, `.pgm` or `.pbm`, or `kind = \"maze\"`",
                    );
                }
            }
            if let Some((reader, section)) = keys.reading() {
                reader.exclude(section, "file", &INLINE_KEYS);
            }
            return;
        }
        self.inline_keys(keys, has_drawing);
    }
}

impl WorldTable {
    /// Declares the keys of an inline world.
    fn inline_keys(&mut self, keys: &mut Keys<'_>, has_drawing: bool) {
        let sides = [Quantity::size("width"), Quantity::size("height")];
        if let Some((reader, section)) = keys.reading() {
            self.is_inline = true;
            if has_drawing {
                reader.exclude(section, "maze", &WALL_KEYS);
                self.spec = reader.maze(section, "maze");
            } else if !section.has("floor_mm") {
                reader.missing(section, "floor_mm");
            }
            reader.sink.file().clone_into(&mut self.spec.file);
        }
        if !has_drawing {
            keys.mention_first(&["floor_mm", "cell_mm", "maze", "wall"]);
            keys.key("floor_mm", "Width and height of the floor in mm.").nullable(sides, &mut self.floor);
        }
        if keys.reading().is_some() && !has_drawing {
            self.spec.floor = self.floor.unwrap_or_default();
        }
        let world = &mut self.spec;
        keys.key("texture", "Image stretched over the whole floor.").nullable(IMAGE, &mut world.texture);
        keys.key("texture_turned", "The image is turned by 180 degrees, as in a `.wld`.")
            .flag(&mut world.texture_is_turned);
        keys.key("surface", "Reflection properties of the floor, and of walls without their own.")
            .nullable(TableWithExample("reflectivity = 1, specular = 0.5"), &mut world.surface);
        keys.key(
            "terrain",
            "Ground that is not the plane: sensors and cameras see it, legs walk on it; wheels drive on the plane all the \
             same.",
        )
        .nullable(TerrainTable(world.floor), &mut world.terrain);
        keys.key("water_mm", "Depth of the water over the floor in mm; default: dry land.")
            .nullable(WATER, &mut world.water);
        looks_keys(keys, &mut world.looks);
        if keys.reading().is_none() {
            keys.key("maze", "The drawing of a maze, as in a `.maz`.").nullable(TEXT, &mut self.maze);
        }
        if !has_drawing {
            cell_key(keys, &mut world.cell);
            keys.key("wall", "Walls.").list(TABLES, &mut world.walls);
        }
        keys.key("start", "Start poses of robots without a pose.").list(TABLES, &mut world.starts);
        keys.key("object", "Objects of the world; they come before those of the scene.")
            .list(TABLES, &mut world.objects);
    }
}

impl Words for WorldKind {
    const NAME: &'static str = "WorldKindForm";
    const ABOUT: &'static str = "How a file is read.";
    const WORDS: &'static [(Self, &'static str, &'static str)] =
        &[(WorldKind::World, "world", "As a `.wld`."), (WorldKind::Maze, "maze", "As a `.maz`.")];
}

/// Declares the size of a maze's cells.
fn cell_key(keys: &mut Keys<'_>, cell: &mut Option<f64>) {
    keys.key(
        "cell_mm",
        "Cell size in mm: of a world that is a maze of walls; of a `.maz`, overriding the file; of a `.map`; or of the pixels of an image.",
    )
    .nullable(Quantity::size("cell size"), cell);
}

/// Declares the properties of a world that affect only camera images.
fn looks_keys(keys: &mut Keys<'_>, looks: &mut LooksSpec) {
    keys.key("colour", "Red, green and blue of a floor without an image, 0 to 255.")
        .nullable(Channels, &mut looks.colour);
    keys.key("light", "The light for cameras.")
        .optional(TableWithExample("azimuth_deg = -120, shadows = true"), &mut looks.light);
    keys.key("sky", "Background of camera images.")
        .optional(TableWithExample("horizon = [200, 210, 220], ground = [90, 90, 80]"), &mut looks.sky);
}

impl Form for LightSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("LightForm", "The light: a sun, and uniform ambient light.");
        let azimuth = Quantity::angle("azimuth of the sun").within(-360.0, 360.0);
        let elevation = Quantity::angle("elevation of the sun").within(1.0, 90.0);
        let ambient = Quantity::number("share of ambient light", 0.0, 1.0);
        keys.key("azimuth_deg", "Direction of the sun in degrees, counter-clockwise from x; default: -120.")
            .optional(Bounded(azimuth), &mut self.azimuth);
        keys.key("elevation_deg", "Its angle above the floor in degrees; default: 50.")
            .optional(Bounded(elevation), &mut self.elevation);
        keys.key("ambient", "Fraction of the light that is uniform; default: 0.4.")
            .optional(Bounded(ambient), &mut self.ambient);
        keys.key("shadows", "Bodies cast shadows; default: false.").optional(Flag, &mut self.shadows);
    }
}

impl Form for SkySpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("SkyForm", "Colours of the background: red, green and blue, 0 to 255.");
        keys.key("horizon", "The sky at the horizon.").optional(Channels, &mut self.horizon);
        keys.key("zenith", "The sky straight above.").optional(Channels, &mut self.zenith);
        keys.key("ground", "The ground beyond the floor.").optional(Channels, &mut self.ground);
    }
}

impl Form for WallSpec {
    fn defaults() -> Self {
        Self { height: DEFAULT_WALL_HEIGHT, ..Self::default() }
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("WallForm", "A wall: a straight piece between two points.");
        keys.span(&mut self.span);
        if !random_wall_keys(keys, &mut self.scatter) {
            keys.key("from_mm", "One end, x and y in mm.").required_or_replaced(POINT, &mut self.from);
            keys.key("to_mm", "The other end, x and y in mm.").required_or_replaced(POINT, &mut self.to);
        }
        keys.key("thickness_mm", "Thickness in mm, half of it on either side; default: 0.")
            .optional(Bounded(Quantity::length("thickness")), &mut self.thickness);
        keys.key("height_mm", "Height above the floor in mm; default: 200.")
            .optional(Bounded(Quantity::size("height")), &mut self.height);
        keys.key("colour", "Red, green and blue, 0 to 255.").nullable(Channels, &mut self.colour);
        keys.key("surface", "Reflection of sound; default: from the world.").nullable(TABLE, &mut self.surface);
        let is_point = keys.is_complete() && self.from == self.to && self.scatter.is_none();
        if let Some((reader, section)) = keys.reading()
            && is_point
        {
            let message = "both ends of the wall are equal; it is left out";
            reader.sink.warn(Code::WldWallLength, section.span, message, "two different ends");
            keys.refuse();
        }
    }
}

/// Declares the keys of a wall with a random position: length and layout; returns true if the wall has a random
/// position.
fn random_wall_keys(keys: &mut Keys<'_>, random: &mut Option<(f64, Scatter)>) -> bool {
    let (mut length, mut scatter) = random.unzip();
    let has_layout = keys.reading().is_some_and(|(_, section)| section.has("layout"));
    keys.mention_first(&["count"]);
    if keys.reading().is_none() {
        // Entries with a `count` are repeated before they are read.
        keys.key("count", "Number of copies; default: 1. Each copy has its own random values.")
            .nullable(0..=MAX_REPETITIONS, &mut None::<u32>);
    }
    if has_layout || keys.reading().is_none() {
        keys.key("length_mm", "Length in mm of a wall with a random place.")
            .nullable(Bounded(Quantity::size("length")), &mut length);
    }
    keys.key("layout", "Random position instead of both ends.").nullable(SCATTER, &mut scatter);
    if !has_layout {
        return random.is_some();
    }
    *random = length.zip(scatter);
    if let Some((reader, section)) = keys.reading() {
        reader.exclude(section, "layout", &["from_mm", "to_mm"]);
        if !section.has("length_mm") {
            reader.missing(section, "length_mm");
        }
    }
    if random.is_none() {
        keys.refuse();
    }
    true
}
