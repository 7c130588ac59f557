//! Terrain of a world: a mesh, an image, a function with a seed, or blocks and stairs.

use glam::DVec2;
use serde_json::{Value as Json, json};
use toml::Value;
use toml::de::DeValue;

use super::kind::{Custom, Flag, IMAGE, Kind, ReadContext, TABLES, TEXT, Word, Words};
use super::object::MESH_UNIT;
use super::place::POINT;
use super::sensor::POINT_3D;
use super::shape::rotation_key;
use super::{Definitions, Form, Keys, definition, print_non_defaults, reference};
use crate::code::Code;
use crate::line::Quantity;
use crate::spec::{
    DEFAULT_BOULDERS, DEFAULT_HILL_LENGTH, DEFAULT_RELIEF_HEIGHT, DEFAULT_TERRAIN_CELL, DEFAULT_TERRAIN_SCALE,
    ModelSpec, TerrainImage, TerrainShape, TerrainSpec,
};
use crate::table::{Reader, Section};
use sim_core::scene::{Block, Bounds, Disc, MAX_BOULDERS, MAX_STEPS, RandomTerrain, Stairs, StairsDirection, Steps};

/// Keys that select the source of a terrain.
const SOURCE_KEYS: [&str; 5] = ["file", "image", "function", "stairs", "block"];
/// Keys of the function for boulders.
const BOULDER_KEYS: [&str; 3] = ["boulders", "radius_mm", "height_mm"];
/// Directions in which stairs rise, in degrees, in the order of [`StairsDirection::ALL`].
const DIRECTIONS_DEG: [f64; 4] = [0.0, 90.0, 180.0, 270.0];
/// Kinds of terrain: a key that selects the kind, and a description of the kind.
const SOURCES: [(&str, &str); 4] = [
    ("file", "A mesh file with its place in the world."),
    ("image", "A grey image."),
    ("function", "A function with a seed."),
    ("stairs", "Stairs and blocks."),
];
const DIRECTION: Quantity = Quantity::number("direction", -360.0, 360.0);
const SIDES: [Quantity; 2] = [Quantity::size("width"), Quantity::size("depth")];

/// Kind of the key `terrain`: `"FILE"` or a table. The field is the floor's size, which is the default size of a
/// terrain.
pub(crate) struct TerrainTable(pub(crate) DVec2);

impl Kind<TerrainSpec> for TerrainTable {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&TerrainSpec>) -> Option<TerrainSpec> {
        let ReadContext { reader, section, key } = context;
        let span = reader.key_span(section, key);
        let is_table = section.get(key).is_some_and(|value| matches!(value.get_ref(), DeValue::Table(_)));
        if !is_table {
            let model = ModelSpec { path: reader.reference(section, key)?, ..ModelSpec::default() };
            return Some(TerrainSpec::new(TerrainShape::Mesh { model, scale: DEFAULT_TERRAIN_SCALE }, span));
        }
        let section = reader.section(section, key)?;
        let mut shape = self.default_shape(reader.terrain_kind(&section)?);
        reader.table(section, |keys| terrain_keys(&mut shape, keys)).then(|| TerrainSpec::new(shape, span))
    }

    fn print(&self, terrain: &TerrainSpec) -> Value {
        let kind = match &terrain.shape {
            TerrainShape::Mesh { .. } => "file",
            TerrainShape::Image(_) => "image",
            TerrainShape::Random(_) => "function",
            TerrainShape::Steps(_) => "stairs",
        };
        let table = print_non_defaults(
            |keys| terrain_keys(&mut terrain.shape.clone(), keys),
            |keys| terrain_keys(&mut self.default_shape(kind), keys),
        );
        match &terrain.shape {
            TerrainShape::Mesh { model, .. } if table.len() == 1 => TEXT.print(&model.path),
            _ => table.into(),
        }
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        definition(definitions, "TerrainForm", |definitions| {
            let about = "A mesh file whose unit is 1 m and whose origin is that of the world.";
            let mut kinds = vec![json!({ "description": about, "type": "string" })];
            kinds.extend(SOURCES.map(|(kind, about)| {
                let mut schema = reference(definitions, |keys| terrain_keys(&mut self.default_shape(kind), keys));
                schema["description"] = about.into();
                schema
            }));
            json!({ "description": "Ground that is not the plane.", "anyOf": kinds })
        })
    }
}

impl TerrainTable {
    /// Default terrain of the kind that the key `kind` selects.
    fn default_shape(&self, kind: &str) -> TerrainShape {
        let (origin, size, base) = (DVec2::ZERO, self.0, 0.0);
        match kind {
            "image" => TerrainShape::Image(TerrainImage { size, ..TerrainImage::default() }),
            "function" => TerrainShape::Random(RandomTerrain {
                seed: 0,
                origin,
                size,
                base,
                cell: DEFAULT_TERRAIN_CELL,
                relief_height: DEFAULT_RELIEF_HEIGHT,
                hill_length: DEFAULT_HILL_LENGTH,
                boulders: Some(DEFAULT_BOULDERS),
                clear: Vec::new(),
            }),
            "stairs" | "block" => TerrainShape::Steps(Steps { size, ..Steps::default() }),
            _ => TerrainShape::Mesh { model: ModelSpec::default(), scale: DEFAULT_TERRAIN_SCALE },
        }
    }
}

fn terrain_keys(shape: &mut TerrainShape, keys: &mut Keys<'_>) {
    match shape {
        TerrainShape::Mesh { model, scale } => mesh_keys(keys, model, scale),
        TerrainShape::Image(terrain) => image_keys(keys, terrain),
        TerrainShape::Random(terrain) => random_keys(keys, terrain),
        TerrainShape::Steps(terrain) => steps_keys(keys, terrain),
    }
}

impl Reader {
    /// The key that selects the source of the terrain; `None`, with an error, if two keys conflict.
    fn terrain_kind(&mut self, section: &Section<'_, '_>) -> Option<&'static str> {
        let mut kinds = SOURCE_KEYS.into_iter().filter(|kind| section.has(kind));
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
}

fn mesh_keys(keys: &mut Keys<'_>, model: &mut ModelSpec, scale: &mut f64) {
    keys.form("PlacedTerrainForm", "A mesh file with its place in the world.");
    keys.mention_first(&["scale_mm"]);
    keys.key("file", "The mesh file.").required(TEXT, &mut model.path);
    keys.key("offset_mm", "Position of the mesh's origin in the world in mm; default: 0.")
        .optional(POINT_3D, &mut model.offset);
    rotation_key(keys, &mut model.rotations);
    keys.key("scale_mm", "Length of the mesh's unit in mm; default: 1000.").optional(MESH_UNIT, scale);
}

/// Declares the extent of a terrain: the corner with the minimum x and y, and the size along x and y.
fn extent_keys(keys: &mut Keys<'_>, about: &'static str, (origin, base): (&mut DVec2, &mut f64), size: &mut DVec2) {
    let mut offset = origin.extend(*base);
    keys.key("offset_mm", about).optional(POINT_3D, &mut offset);
    (*origin, *base) = (offset.truncate(), offset.z);
    keys.key("size_mm", "Width along x and along y in mm; default: that of the floor.").optional(SIDES, size);
}

fn image_keys(keys: &mut Keys<'_>, image: &mut TerrainImage) {
    keys.form("ImageTerrainForm", "Ground whose height is the brightness of a grey image.");
    let TerrainImage { path, origin, size, base, height } = image;
    keys.key(
        "image",
        "The image file: a grey png of 8 or 16 bits. The centres of its pixels are the corners of the terrain's cells.",
    )
    .required(IMAGE, path);
    let about = "Position of the lower left corner in mm, and height of black; default: 0.";
    extent_keys(keys, about, (origin, base), size);
    keys.key("height_mm", "Height of white above black, in mm.").required(Quantity::coordinate("height"), height);
}

fn random_keys(keys: &mut Keys<'_>, terrain: &mut RandomTerrain) {
    keys.form(
        "FunctionTerrainForm",
        "Ground that is generated from a seed: a smooth relief, with or without boulders.",
    );
    let RandomTerrain { seed, origin, size, base, cell, relief_height, hill_length, boulders, clear } = terrain;
    let mut function = if boulders.is_some() { Function::Boulders } else { Function::Hills };
    keys.key("function", "Function that generates the terrain.").required(Word, &mut function);
    keys.key("seed", "Seed of its random numbers; default: 0.").optional(0..=i64::MAX, seed);
    let about = "Position of the lower left corner in mm, and height of the lowest ground; default: 0.";
    extent_keys(keys, about, (origin, base), size);
    keys.key("cell_mm", "Maximum side of a cell in mm; default: 50.").optional(Quantity::size("side of a cell"), cell);
    keys.key("relief_mm", "Height difference of the smooth relief in mm; default: 100.")
        .optional(Quantity::length("height of the relief"), relief_height);
    keys.key("length_mm", "Length of the longest hills in mm; default: 2000.")
        .optional(Quantity::size("length of a hill"), hill_length);
    let mut parameters = boulders.unwrap_or(DEFAULT_BOULDERS);
    if let Some((reader, section)) = keys.reading()
        && function == Function::Hills
    {
        reader.exclude(section, "function = \"hills\"", &BOULDER_KEYS);
    } else {
        keys.key("boulders", "Number of boulders; default: 40.")
            .optional(0..=i64::from(MAX_BOULDERS), &mut parameters.count);
        keys.key("radius_mm", "Minimum and maximum half length of a boulder in mm; default: 100 and 400.")
            .optional(MinMax(Quantity::size("half length of a boulder")), &mut parameters.radius);
        keys.key("height_mm", "Minimum and maximum height of a boulder in mm; default: 50 and 300.")
            .optional(MinMax(Quantity::length("height of a boulder")), &mut parameters.height);
    }
    *boulders = Some(parameters).filter(|_| function == Function::Boulders);
    keys.key("clear", "Discs in which the ground is level and low.").list(TABLES, clear);
}

/// Function that generates a terrain.
#[derive(Clone, Copy, PartialEq)]
enum Function {
    Hills,
    Boulders,
}

impl Words for Function {
    const NAME: &'static str = "FunctionForm";
    const ABOUT: &'static str = "A function that generates heights from a seed.";
    const WORDS: &'static [(Self, &'static str, &'static str)] =
        &[(Function::Hills, "hills", "A smooth relief."), (Function::Boulders, "boulders", "The same with boulders.")];
}

/// Minimum and maximum of a quantity.
struct MinMax(Quantity);

impl Kind<[f64; 2]> for MinMax {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&[f64; 2]>) -> Option<[f64; 2]> {
        let ReadContext { reader, section, key } = context;
        let [min, max] = reader.numbers(section, key, &[self.0; 2])?;
        if min > max {
            let span = section.get(key).map_or(section.span, |value| reader.span(value.span()));
            let message = format!("`{key}` begins with the greater number");
            let expected = "the least and the greatest value, in this order";
            reader.sink.error(Code::NumberRange, span, message, expected);
            return None;
        }
        Some([min, max])
    }

    fn print(&self, limits: &[f64; 2]) -> Value {
        [self.0; 2].print(limits)
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        Kind::<[f64; 2]>::describe(&[self.0; 2], definitions)
    }
}

impl Form for Disc {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("DiscForm", "A disc of level ground.");
        keys.key("x_mm", "Its centre along x in mm.").required(POINT[0], &mut self.centre.x);
        keys.key("y_mm", "Its centre along y in mm.").required(POINT[1], &mut self.centre.y);
        keys.key("radius_mm", "Its radius in mm.").required(Quantity::size("radius"), &mut self.radius);
    }
}

fn steps_keys(keys: &mut Keys<'_>, steps: &mut Steps) {
    keys.form("StepsTerrainForm", "Level ground with stairs and blocks.");
    let Steps { origin, size, base, stairs, blocks } = steps;
    let about = "Position of the lower left corner in mm, and height of the ground; default: 0.";
    extent_keys(keys, about, (origin, base), size);
    // Without blocks this key must be printed, since it selects the source of the terrain.
    let mut flights = Some(std::mem::take(stairs)).filter(|stairs| !stairs.is_empty() || blocks.is_empty());
    keys.key("stairs", "Flights of stairs; optional if there are blocks.").nullable(TABLES, &mut flights);
    *stairs = flights.unwrap_or_default();
    keys.key("block", "Single blocks.").list(TABLES, blocks);
}

impl Form for Stairs {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("StairsForm", "A flight of stairs.");
        keys.key("from_mm", "Midpoint of the lower edge of the first step, x and y in mm.")
            .required(POINT, &mut self.from);
        keys.key("direction_deg", "Direction in which the stairs go up: 0, 90, 180 or 270 degrees; default: 0.")
            .strict(STAIRS_DIRECTION, &mut self.uphill);
        keys.key("count", "Number of steps.").required(1..=i64::from(MAX_STEPS), &mut self.count);
        keys.key("step_height_mm", "Height of each step in mm.")
            .required(Quantity::size("height of a step"), &mut self.rise);
        keys.key("step_depth_mm", "Depth of each step in mm.")
            .required(Quantity::size("depth of a step"), &mut self.depth);
        keys.key("width_mm", "Width perpendicular to the direction in mm.")
            .required(Quantity::size("width"), &mut self.width);
        let mut landing = Some(self.landing).filter(|landing| *landing != self.depth && keys.reading().is_none());
        keys.key("landing_mm", "Depth of the last step in mm; default: that of the other steps.")
            .nullable(Quantity::size("depth of the landing"), &mut landing);
        self.landing = landing.unwrap_or(self.depth);
        keys.key("down", "Stairs go down again with the same number of steps; default: false.")
            .optional(Flag, &mut self.goes_down);
    }
}

/// Direction of stairs, in degrees.
const STAIRS_DIRECTION: Custom<StairsDirection> = Custom {
    read: |context| {
        let ReadContext { reader, section, key } = context;
        let degrees = reader.number(section, key, &DIRECTION)?;
        let index = DIRECTIONS_DEG.iter().position(|direction| *direction == degrees.rem_euclid(360.0));
        if index.is_none() {
            let span = section.get(key).map_or(section.span, |value| reader.span(value.span()));
            let message = format!("direction `{degrees}` is not a multiple of a quarter turn");
            reader.sink.error(Code::NumberRange, span, message, "0, 90, 180 or 270 degrees");
        }
        index.map(|index| StairsDirection::ALL[index])
    },
    print: |direction| {
        let directions = StairsDirection::ALL.iter().zip(DIRECTIONS_DEG);
        directions
            .filter(|(known, _)| *known == direction)
            .map(|(_, degrees)| degrees)
            .next()
            .unwrap_or_default()
            .into()
    },
    describe: |definitions| DIRECTION.describe(definitions),
};

impl Form for Block {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("BlockForm", "A block with level top and vertical sides.");
        let Bounds { min: mut from, max: mut to } = self.bounds;
        keys.key("from_mm", "One corner, x and y in mm.").required(POINT, &mut from);
        keys.key("to_mm", "The opposite corner, x and y in mm.").required(POINT, &mut to);
        let is_flat = keys.is_complete() && from.cmpeq(to).any();
        keys.key("height_mm", "Its height above the ground in mm.")
            .required(Quantity::size("height"), &mut self.height);
        if let Some((reader, section)) = keys.reading()
            && is_flat
        {
            let message = "the block has no extent; two of its sides are one";
            reader.sink.error(Code::NumberRange, section.span, message, "two opposite corners");
            keys.refuse();
        }
        self.bounds = Bounds::of_points([from, to]);
    }
}
