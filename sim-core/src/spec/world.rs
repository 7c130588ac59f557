//! Worlds: walls, starts, the ground.

use std::sync::Arc;

use glam::DVec2;

use super::{LooksSpec, ModelSpec, ObjectLine, Scatter, SpannedText, Surface};
use crate::pose::Pose;
use crate::scene::{Boulders, HeightField, Mesh, RandomTerrain, Steps};
use crate::spec::Span;

/// Default height of a wall, in metres: the wall height of EyeSim VR.
pub const DEFAULT_WALL_HEIGHT: f64 = 0.2;

/// Default cell size of a maze, in metres.
pub const DEFAULT_CELL: f64 = 0.36;

/// Default scale of a terrain's mesh, in metres per unit. Source: our choice, the same as for meshes of robots.
pub const DEFAULT_TERRAIN_SCALE: f64 = 1.0;

/// A wall on the floor along the segment from `from` to `to`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallSpec {
    /// One end, in metres, world frame.
    pub from: DVec2,
    /// The other end; never equal to `from`.
    pub to: DVec2,
    /// Thickness in metres, half of it on either side of the segment; 0 for a wall given by four numbers.
    pub thickness: f64,
    /// Height of the upper edge above the floor, in metres; positive.
    pub height: f64,
    /// Red, green, blue.
    pub colour: Option<[u8; 3]>,
    /// Reflection properties; `None`: the world's properties.
    pub surface: Option<Surface>,
    /// Length in metres and random placement, if the wall's position is drawn.
    pub scatter: Option<(f64, Scatter)>,
    /// Location of the wall's line (in a maze: of its first character).
    pub span: Span,
}

/// A start pose for a robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartSpec {
    /// Pose of the robot's centre in the world frame.
    pub pose: Pose,
    /// The maze's letter, in upper case; `None` for a `position` line.
    pub letter: Option<char>,
    /// Location in the file.
    pub span: Span,
}

/// A world (`.wld`) or a maze (`.maz`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorldSpec {
    /// Name of the file.
    pub file: String,
    /// Width (along x) and height (along y) of the floor, in metres; the lower left corner is the origin.
    pub floor: DVec2,
    /// Image stretched over the whole floor.
    pub texture: Option<SpannedText>,
    /// True if the image is turned by 180 degrees, so that its upper left pixel lies at (width, 0), as in worlds of
    /// EyeSim VR.
    pub texture_is_turned: bool,
    /// Reflection properties of the floor, and of walls without their own; `None`: the floor is smooth and walls are
    /// rough.
    pub surface: Option<Surface>,
    /// Ground other than the plane z = 0: sensors and cameras see it, legs walk on it, but wheels drive on the plane.
    pub terrain: Option<TerrainSpec>,
    /// Depth of the water over the floor, in metres; `None` for dry land.
    pub water: Option<f64>,
    /// Light, sky and colour of the floor.
    pub looks: LooksSpec,
    /// Side of a maze's cells, in metres; `None` for a `.wld`.
    pub cell: Option<f64>,
    /// Walls in the order of the file; in a maze, vertical walls from left to right, then horizontal walls from top to
    /// bottom.
    pub walls: Vec<WallSpec>,
    /// Start poses in the order of the file.
    pub starts: Vec<StartSpec>,
    /// Objects in the order of the file.
    pub objects: Vec<ObjectLine>,
}

impl WorldSpec {
    /// Lower left and upper right corner of the bounding rectangle of floor and walls, in metres.
    pub fn bounds(&self) -> (DVec2, DVec2) {
        let ends = self.walls.iter().flat_map(|wall| [wall.from, wall.to]);
        ends.fold((DVec2::ZERO, self.floor), |(low, high), end| (low.min(end), high.max(end)))
    }
}

/// Ground other than the plane z = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct TerrainSpec {
    /// Source of the shape.
    pub shape: TerrainShape,
    /// Surface in the world frame, for range sensors and cameras; `None` until it has been generated.
    pub mesh: Option<Arc<Mesh>>,
    /// The surface as a height field, for legs; `None` for a mesh file, and until it has been generated.
    pub field: Option<Arc<HeightField>>,
    /// Location in the file.
    pub span: Span,
}

/// Source of a terrain's shape.
#[derive(Clone, Debug, PartialEq)]
pub enum TerrainShape {
    /// A mesh.
    Mesh {
        /// The mesh file and its pose in the world.
        model: ModelSpec,
        /// Factor on the lengths of the mesh, in metres per unit of the mesh file; positive.
        scale: f64,
    },
    /// A grey image.
    Image(TerrainImage),
    /// Random terrain.
    Random(RandomTerrain),
    /// Blocks and stairs.
    Steps(Steps),
}

/// A height field from an image: the centres of its pixels are the nodes of the grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TerrainImage {
    /// The image file.
    pub path: SpannedText,
    /// Position of the lower left pixel, in metres, world frame.
    pub origin: DVec2,
    /// Offset from `origin` to the upper right pixel, in metres; positive.
    pub size: DVec2,
    /// Height of black, in metres.
    pub base: f64,
    /// Height of white above black, in metres; may be negative.
    pub height: f64,
}

/// Default maximum side of the cells of a random terrain, in metres. Source: our choice.
pub const DEFAULT_TERRAIN_CELL: f64 = 0.05;

/// Default height of the relief of a random terrain, in metres. Source: our choice.
pub const DEFAULT_RELIEF_HEIGHT: f64 = 0.1;

/// Default length of the longest hills of a random terrain, in metres. Source: our choice.
pub const DEFAULT_HILL_LENGTH: f64 = 2.0;

/// Default boulders of a random terrain. Source: our choice.
pub const DEFAULT_BOULDERS: Boulders = Boulders { count: 40, radius: [0.1, 0.4], height: [0.05, 0.3] };

impl TerrainSpec {
    /// A terrain whose surface has not been generated yet.
    pub fn new(shape: TerrainShape, span: Span) -> Self {
        Self { shape, mesh: None, field: None, span }
    }

    /// The file that the terrain names, if any.
    pub fn path_mut(&mut self) -> Option<&mut SpannedText> {
        match &mut self.shape {
            TerrainShape::Mesh { model, .. } => Some(&mut model.path),
            TerrainShape::Image(image) => Some(&mut image.path),
            TerrainShape::Random(_) | TerrainShape::Steps(_) => None,
        }
    }
}
