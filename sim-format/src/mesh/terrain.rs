//! Terrains: their height fields and meshes, from the description in a world.

use std::sync::Arc;

use super::texture::{self, TextureError};
use super::{MeshReader, NEEDED_BY_SENSORS};
use crate::code::Code;
use crate::diagnostic::Sink;
use crate::spec::{TerrainImage, TerrainShape, TerrainSpec, WorldSpec};
use crate::{InputFile, path};
use sim_core::scene::{FieldError, HeightField, MAX_CELLS};

/// A grey image whose shades, 0 to 65535, are heights.
struct HeightImage {
    size: [usize; 2],
    /// Shades row by row from the top.
    shades: Vec<u16>,
    /// True if the file has colours, not only shades of grey.
    has_colours: bool,
}

impl MeshReader<'_> {
    /// Builds the surface of a world's terrain. After a mistake, which is reported, the terrain has no surface.
    pub fn terrain(&mut self, world: &mut WorldSpec) {
        let Some(mut terrain) = world.terrain.take() else { return };
        if let TerrainShape::Mesh { model, scale } = &terrain.shape {
            terrain.mesh = self.mesh(&world.file, model, *scale, NEEDED_BY_SENSORS);
            if terrain.mesh.is_none() {
                let message = format!("range sensors are to see the mesh `{}`, which cannot be read", model.path.text);
                let mut sink = Sink::new(&world.file);
                sink.error(Code::MeshSolid, model.path.span, message, "an .obj file with triangles");
                self.loader.diagnostics.extend(sink.finish());
            }
        } else if let Some(field) = self.height_field(world, &terrain) {
            terrain.mesh = Some(Arc::new(field.mesh(world.looks.colour)));
            terrain.field = Some(Arc::new(field));
        }
        world.terrain = Some(terrain);
    }

    fn height_field(&mut self, world: &WorldSpec, terrain: &TerrainSpec) -> Option<HeightField> {
        let field = match &terrain.shape {
            TerrainShape::Mesh { .. } => return None,
            TerrainShape::Image(image) => self.read_image(&world.file, image)?.height_field(image),
            TerrainShape::Random(random) => random.field().map(|(field, left_out)| {
                if left_out > 0 {
                    let message = format!("{left_out} boulders have no free position outside the clear discs");
                    let mut sink = Sink::new(&world.file);
                    sink.warn(Code::TerrainClear, terrain.span, message, "fewer or smaller boulders, or smaller discs");
                    self.loader.diagnostics.extend(sink.finish());
                }
                field
            }),
            TerrainShape::Steps(steps) => steps.field(),
        };
        field.map_err(|error| self.report_size(&world.file, terrain, &error)).ok()
    }

    fn report_size(&mut self, file: &str, terrain: &TerrainSpec, error: &FieldError) {
        let expected = match (&terrain.shape, error) {
            (TerrainShape::Random(_), FieldError::Large(_)) => {
                format!("a larger `cell_mm`, so that there are at most {MAX_CELLS} cells")
            }
            (TerrainShape::Image(_), _) => {
                format!("an image of 2 x 2 pixels to {MAX_CELLS} of them, such as 1024 x 1024")
            }
            _ => format!("a terrain with a size and at most {MAX_CELLS} cells"),
        };
        let mut sink = Sink::new(file);
        sink.error(Code::TerrainSize, terrain.span, format!("no terrain can be made: {error}"), expected);
        self.loader.diagnostics.extend(sink.finish());
    }

    fn read_image(&mut self, file: &str, image: &TerrainImage) -> Option<HeightImage> {
        let (path, bytes) = self.loader.find(file, path::folder_of(file), &image.path)?;
        let grey = HeightImage::read(&bytes);
        self.loader.inputs.push(InputFile { path: path.clone(), bytes });
        let mut sink = Sink::new(file);
        match &grey {
            Err(error) => {
                let message = format!("`{path}` cannot be a terrain: {error}");
                sink.error(Code::TerrainImage, image.path.span, message, "a grey png of 8 or 16 bits");
            }
            Ok(grey) if grey.has_colours => {
                let message = format!("`{path}` has colours; their brightness is used");
                sink.warn(Code::TerrainColour, image.path.span, message, "a grey png of 8 or 16 bits");
            }
            Ok(_) => {}
        }
        self.loader.diagnostics.extend(sink.finish());
        grey.ok()
    }
}

impl HeightImage {
    /// Reads the shades of an image. Colours become their brightness, (2126 red + 7152 green + 722 blue) / 10000 of the
    /// stored values; opacity is ignored.
    ///
    /// Source of the weights: Recommendation ITU-R BT.709.
    fn read(bytes: &[u8]) -> Result<Self, TextureError> {
        let image = texture::decode(bytes)?;
        let mut has_colours = false;
        let shades = image.rgb16().into_iter().map(|pixel| {
            let [red, green, blue] = pixel.map(u32::from);
            has_colours |= red != green || green != blue;
            ((2126 * red + 7152 * green + 722 * blue + 5000) / 10000) as u16
        });
        let shades = shades.collect();
        Ok(Self { size: image.size.map(|side| side as usize), shades, has_colours })
    }

    fn height_field(&self, image: &TerrainImage) -> Result<HeightField, FieldError> {
        let [columns, rows] = self.size;
        if columns < 2 || rows < 2 {
            return Err(FieldError::Small);
        }
        let cells = (columns - 1) * (rows - 1);
        if cells > MAX_CELLS {
            return Err(FieldError::Large(cells));
        }
        let axis = |low: f64, size: f64, count: usize| -> Vec<f64> {
            (0..count).map(|index| low + size * (index as f64 / (count - 1) as f64)).collect()
        };
        let xs = axis(image.origin.x, image.size.x, columns);
        let ys = axis(image.origin.y, image.size.y, rows);
        let height = |shade: &u16| image.base + image.height * (f64::from(*shade) / f64::from(u16::MAX));
        let heights = self.shades.chunks_exact(columns).rev().flatten().map(height).collect();
        HeightField::new(xs, ys, heights)
    }
}
