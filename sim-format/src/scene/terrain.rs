//! The terrain of a world: a mesh, an image, a function with a seed, or blocks and stairs.

use glam::{DVec2, DVec3};
use toml::de::DeValue;

use crate::Span;
use crate::code::Code;
use crate::line::Quantity;
use crate::spec::{
    DEFAULT_BOULDERS, DEFAULT_HILL_LENGTH, DEFAULT_RELIEF, DEFAULT_TERRAIN_CELL, DEFAULT_TERRAIN_SCALE, ModelSpec,
    TerrainImage, TerrainShape, TerrainSpec,
};
use crate::table::{Reader, Section};
use sim_core::scene::{Block, Boulders, Bounds, Disc, MAX_BOULDERS, MAX_STEPS, Relief, Stairs, Steps, Way};

use super::world::{MESH_UNIT, POINT};

/// Keys that say what a terrain is made from.
const KINDS: [&str; 5] = ["file", "image", "function", "stairs", "block"];
/// Functions of places and a seed.
const FUNCTIONS: [&str; 2] = ["hills", "boulders"];
/// Keys of boulders.
const OF_BOULDERS: [&str; 3] = ["boulders", "radius_mm", "height_mm"];
/// Directions in which stairs go up, in the order of [`Way::ALL`].
const WAYS: [f64; 4] = [0.0, 90.0, 180.0, 270.0];

const SIDES: [Quantity; 2] = [Quantity::size("width"), Quantity::size("depth")];
const PLACE: [Quantity; 3] = [Quantity::coordinate("x"), Quantity::coordinate("y"), Quantity::coordinate("z")];

/// Where a terrain lies: the corner with the least x and y, and its extent from there.
struct Extent {
    origin: DVec2,
    base: f64,
    size: DVec2,
}

impl Reader<'_> {
    /// `terrain = "FILE"`, or a table; `floor` is as large as a terrain that does not say.
    pub(super) fn terrain(&mut self, section: &mut Section<'_, '_>, floor: DVec2) -> Option<TerrainSpec> {
        let span = self.key_span(section, "terrain");
        let is_table = section.get("terrain").is_some_and(|value| matches!(value.get_ref(), DeValue::Table(_)));
        if !is_table {
            let path = self.reference(section, "terrain")?;
            let model = ModelSpec { path, offset: DVec3::ZERO, turns: DVec3::ZERO };
            return Some(TerrainSpec::new(TerrainShape::Mesh { model, scale: DEFAULT_TERRAIN_SCALE }, span));
        }
        let section = self.section(section, "terrain")?;
        let shape = match self.kind(&section)? {
            "image" => self.terrain_image(section, floor).map(TerrainShape::Image),
            "function" => self.relief(section, floor).map(TerrainShape::Relief),
            "stairs" | "block" => Some(TerrainShape::Steps(self.steps(section, floor))),
            _ => self.terrain_mesh(section),
        };
        Some(TerrainSpec::new(shape?, span))
    }

    /// The key that says what the terrain is made from; `None`, with an error, where two of them do not go together.
    fn kind(&mut self, section: &Section<'_, '_>) -> Option<&'static str> {
        let mut kinds = KINDS.into_iter().filter(|kind| section.has(kind));
        let first = kinds.next().unwrap_or("file");
        match kinds.next() {
            Some("block") if first == "stairs" => Some(first),
            Some(second) => {
                let span = self.key_span(section, second);
                let message = format!("`{second}` and `{first}` exclude each other");
                let expected = "one of file, image and function, or stairs and block";
                self.sink.error(Code::TomlConflict, span, message, expected);
                None
            }
            None => Some(first),
        }
    }

    fn terrain_mesh(&mut self, mut section: Section<'_, '_>) -> Option<TerrainShape> {
        let mut scale = DEFAULT_TERRAIN_SCALE;
        self.set(&mut section, "scale_mm", &MESH_UNIT, &mut scale);
        Some(TerrainShape::Mesh { model: self.model(section)?, scale })
    }

    fn extent(&mut self, section: &mut Section<'_, '_>, floor: DVec2) -> Extent {
        let offset = self.numbers(section, "offset_mm", &PLACE).map_or(DVec3::ZERO, DVec3::from);
        let size = self.numbers(section, "size_mm", &SIDES).map_or(floor, DVec2::from);
        Extent { origin: offset.truncate(), base: offset.z, size }
    }

    fn terrain_image(&mut self, mut section: Section<'_, '_>, floor: DVec2) -> Option<TerrainImage> {
        let path = self.reference_to(&mut section, "image", "the name of an image file, between double quotes");
        let Extent { origin, base, size } = self.extent(&mut section, floor);
        let height = self.required(&mut section, "height_mm", &Quantity::coordinate("height"));
        self.unknown_keys(&section);
        Some(TerrainImage { path: path?, origin, size, base, height: height? })
    }

    fn relief(&mut self, mut section: Section<'_, '_>, floor: DVec2) -> Option<Relief> {
        let function = self.choice(&mut section, "function", &FUNCTIONS);
        let seed = self.integer(&mut section, "seed", 0, i64::MAX).map_or(0, i64::unsigned_abs);
        let Extent { origin, base, size } = self.extent(&mut section, floor);
        let [mut cell, mut relief, mut length] = [DEFAULT_TERRAIN_CELL, DEFAULT_RELIEF, DEFAULT_HILL_LENGTH];
        self.set(&mut section, "cell_mm", &Quantity::size("side of a cell"), &mut cell);
        self.set(&mut section, "relief_mm", &Quantity::length("height of the relief"), &mut relief);
        self.set(&mut section, "length_mm", &Quantity::size("length of a hill"), &mut length);
        let boulders = match function {
            Some(0) => {
                self.exclude(&mut section, "function = \"hills\"", &OF_BOULDERS);
                None
            }
            _ => Some(self.boulders(&mut section)),
        };
        let clear = self.sections(&mut section, "clear");
        let clear = clear.into_iter().filter_map(|disc| self.disc(disc)).collect();
        self.unknown_keys(&section);
        function.map(|_| Relief { seed, origin, size, base, cell, relief, length, boulders, clear })
    }

    fn boulders(&mut self, section: &mut Section<'_, '_>) -> Boulders {
        let usual = DEFAULT_BOULDERS;
        let count = self.integer(section, "boulders", 0, i64::from(MAX_BOULDERS));
        let radius = self.range_of(section, "radius_mm", Quantity::size("half length of a boulder"));
        let height = self.range_of(section, "height_mm", Quantity::length("height of a boulder"));
        Boulders {
            count: count.map_or(usual.count, |count| count as u32),
            radius: radius.unwrap_or(usual.radius),
            height: height.unwrap_or(usual.height),
        }
    }

    /// A least and a greatest value.
    fn range_of(&mut self, section: &mut Section<'_, '_>, key: &'static str, quantity: Quantity) -> Option<[f64; 2]> {
        let [low, high] = self.numbers(section, key, &[quantity; 2])?;
        if low > high {
            let span = section.get(key).map_or(section.span, |value| self.span(value.span()));
            let message = format!("`{key}` begins with the greater number");
            self.sink.error(Code::NumberRange, span, message, "the least and the greatest value, in this order");
            return None;
        }
        Some([low, high])
    }

    fn disc(&mut self, mut section: Section<'_, '_>) -> Option<Disc> {
        let x = self.required(&mut section, "x_mm", &POINT[0]);
        let y = self.required(&mut section, "y_mm", &POINT[1]);
        let radius = self.required(&mut section, "radius_mm", &Quantity::size("radius"));
        self.unknown_keys(&section);
        Some(Disc { centre: DVec2::new(x?, y?), radius: radius? })
    }

    fn steps(&mut self, mut section: Section<'_, '_>, floor: DVec2) -> Steps {
        let Extent { origin, base, size } = self.extent(&mut section, floor);
        let stairs = self.sections(&mut section, "stairs");
        let stairs = stairs.into_iter().filter_map(|stairs| self.flight(stairs)).collect();
        let blocks = self.sections(&mut section, "block");
        let blocks = blocks.into_iter().filter_map(|block| self.block(block)).collect();
        self.unknown_keys(&section);
        Steps { origin, size, base, stairs, blocks }
    }

    fn flight(&mut self, mut section: Section<'_, '_>) -> Option<Stairs> {
        let from = self.required_numbers(&mut section, "from_mm", &POINT).map(DVec2::from);
        let way = self.way(&mut section);
        if !section.has("count") {
            self.missing(&section, "count");
        }
        let count = self.integer(&mut section, "count", 1, i64::from(MAX_STEPS));
        let rise = self.required(&mut section, "step_height_mm", &Quantity::size("height of a step"));
        let depth = self.required(&mut section, "step_depth_mm", &Quantity::size("depth of a step"));
        let width = self.required(&mut section, "width_mm", &Quantity::size("width"));
        let landing = self.number(&mut section, "landing_mm", &Quantity::size("depth of the landing"));
        let goes_down = self.flag(&mut section, "down").unwrap_or_default();
        self.unknown_keys(&section);
        let (depth, count) = (depth?, count? as u32);
        let landing = landing.unwrap_or(depth);
        Some(Stairs { from: from?, way: way?, count, rise: rise?, depth, landing, width: width?, goes_down })
    }

    /// `direction_deg`: whole quarter turns.
    fn way(&mut self, section: &mut Section<'_, '_>) -> Option<Way> {
        let direction = Quantity::number("direction", -360.0, 360.0);
        let degrees = match section.has("direction_deg") {
            true => self.number(section, "direction_deg", &direction)?,
            false => {
                section.get("direction_deg");
                0.0
            }
        };
        let place = WAYS.iter().position(|way| *way == degrees.rem_euclid(360.0));
        if place.is_none() {
            let span = section.get("direction_deg").map_or(Span::default(), |value| self.span(value.span()));
            let message = format!("direction `{degrees}` is no multiple of a quarter turn");
            self.sink.error(Code::NumberRange, span, message, "0, 90, 180 or 270 degrees");
        }
        place.map(|place| Way::ALL[place])
    }

    fn block(&mut self, mut section: Section<'_, '_>) -> Option<Block> {
        let from = self.required_numbers(&mut section, "from_mm", &POINT).map(DVec2::from);
        let to = self.required_numbers(&mut section, "to_mm", &POINT).map(DVec2::from);
        let height = self.required(&mut section, "height_mm", &Quantity::size("height"));
        self.unknown_keys(&section);
        let (from, to) = (from?, to?);
        if from.cmpeq(to).any() {
            let message = "the block has no extent; two of its sides are one";
            self.sink.error(Code::NumberRange, section.span, message, "two opposite corners");
            return None;
        }
        Some(Block { bounds: Bounds::of_points([from, to]), height: height? })
    }
}
