//! Worlds: walls, starts, the ground.

use std::sync::Arc;

use glam::DVec2;

use super::{LooksSpec, ModelSpec, ObjectLine, PathRef, Surface};
use crate::pose::Pose;
use crate::scene::{Boulders, HeightField, Mesh, Relief, Steps};
use crate::spec::Span;

/// Height of a wall whose line does not say, in metres: what EyeSim VR shows of its walls.
pub const DEFAULT_WALL_HEIGHT: f64 = 0.2;

/// Cell size of a maze that does not say, in metres.
pub const DEFAULT_CELL: f64 = 0.36;

/// Metres per unit of a terrain's mesh that does not say. Source: our choice, as meshes of robots have.
pub const DEFAULT_TERRAIN_SCALE: f64 = 1.0;

/// A wall: the straight piece from `from` to `to`, standing on the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallSpec {
    /// One end, in metres, world frame.
    pub from: DVec2,
    /// The other end; never equal to `from`.
    pub to: DVec2,
    /// Thickness in metres, half of it on either side; 0 for a wall given by four numbers, which is a mere line.
    pub thickness: f64,
    /// Height of the upper edge above the floor, in metres; positive.
    pub height: f64,
    /// Red, green, blue.
    pub colour: Option<[u8; 3]>,
    /// How it reflects; `None`: as the world says.
    pub surface: Option<Surface>,
    /// The wall's line (in a maze: its first character).
    pub span: Span,
}

/// A place where a robot may start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartSpec {
    /// Pose of the robot's centre in the world frame.
    pub pose: Pose,
    /// The maze's letter, in upper case; `None` for a `position` line.
    pub letter: Option<char>,
    /// Where it is written.
    pub span: Span,
}

/// A world (`.wld`) or a maze (`.maz`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorldSpec {
    /// Name of the file.
    pub file: String,
    /// Width (along x) and height (along y) of the floor, in metres; one corner is the origin.
    pub floor: DVec2,
    /// Image stretched over the whole floor.
    pub texture: Option<PathRef>,
    /// How the floor reflects, and walls that do not say; else the floor is smooth and walls are rough.
    pub surface: Option<Surface>,
    /// Ground that is not the plane z = 0: sensors and cameras see it, legs walk on it; wheels drive on the plane all the same.
    pub terrain: Option<TerrainSpec>,
    /// Light, sky and colour of the floor.
    pub looks: LooksSpec,
    /// Side of a maze's cells, in metres; `None` for a `.wld`.
    pub cell: Option<f64>,
    /// Walls in the order of the file; in a maze, the vertical ones from left to right, then the horizontal ones from
    /// top to bottom.
    pub walls: Vec<WallSpec>,
    /// Start places in the order of the file.
    pub starts: Vec<StartSpec>,
    /// Objects in the order of the file.
    pub objects: Vec<ObjectLine>,
}

impl WorldSpec {
    /// Lower left and upper right corner of the box around floor and walls, in metres.
    pub fn bounds(&self) -> (DVec2, DVec2) {
        let ends = self.walls.iter().flat_map(|wall| [wall.from, wall.to]);
        ends.fold((DVec2::ZERO, self.floor), |(low, high), end| (low.min(end), high.max(end)))
    }
}

/// Ground that is not the plane z = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct TerrainSpec {
    /// What it is made from.
    pub shape: TerrainShape,
    /// Its surface in the world frame, which range sensors and cameras see; `None` as long as it has not been made.
    pub mesh: Option<Arc<Mesh>>,
    /// The same as heights, on which legs walk; `None` for a mesh file, and as long as it has not been made.
    pub field: Option<Arc<HeightField>>,
    /// Where it is written.
    pub span: Span,
}

/// What a terrain is made from.
#[derive(Clone, Debug, PartialEq)]
pub enum TerrainShape {
    /// A mesh.
    Mesh {
        /// The mesh file and its place in the world.
        model: ModelSpec,
        /// Factor on the lengths of the mesh, in metres per unit of the mesh file; positive.
        scale: f64,
    },
    /// A grey image.
    Image(TerrainImage),
    /// A function with a seed.
    Relief(Relief),
    /// Blocks and stairs.
    Steps(Steps),
}

/// A height field from an image: the middles of its pixels are the corners of the grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TerrainImage {
    /// The image file.
    pub path: PathRef,
    /// Place of the lower left pixel, in metres, world frame.
    pub origin: DVec2,
    /// From there to the upper right pixel, in metres; positive.
    pub size: DVec2,
    /// Height where it is black, in metres.
    pub base: f64,
    /// As much higher it is where it is white, in metres; may be negative.
    pub height: f64,
}

/// Greatest side of the cells of a random terrain that does not say, in metres. Source: our choice.
pub const DEFAULT_TERRAIN_CELL: f64 = 0.05;

/// Height of the relief of a random terrain that does not say, in metres. Source: our choice.
pub const DEFAULT_RELIEF: f64 = 0.1;

/// Length of the longest hills of a random terrain that does not say, in metres. Source: our choice.
pub const DEFAULT_HILL_LENGTH: f64 = 2.0;

/// The boulders of a random terrain that does not say. Source: our choice.
pub const DEFAULT_BOULDERS: Boulders = Boulders { count: 40, radius: [0.1, 0.4], height: [0.05, 0.3] };

impl TerrainSpec {
    /// A terrain that has not been made yet.
    pub fn new(shape: TerrainShape, span: Span) -> Self {
        Self { shape, mesh: None, field: None, span }
    }

    /// The file that it names.
    pub fn path_mut(&mut self) -> Option<&mut PathRef> {
        match &mut self.shape {
            TerrainShape::Mesh { model, .. } => Some(&mut model.path),
            TerrainShape::Image(image) => Some(&mut image.path),
            TerrainShape::Relief(_) | TerrainShape::Steps(_) => None,
        }
    }
}
