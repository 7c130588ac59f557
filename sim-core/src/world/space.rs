//! Geometry that only three-dimensional rays and legs can touch: shapes of bodies, upper faces of walls, and surfaces.

use std::sync::Arc;

use glam::DVec2;

use crate::{
    ObjectId, math,
    object::{Figure, Properties, Shape, Solid},
    pose::Pose,
    scene::{Bounds, BoundsIndex, Segment, Surface, WallId, Walls},
};

/// Geometry for three-dimensional rays and legs, in addition to the planar walls and bodies; by default only a smooth
/// floor.
///
/// If the list `walls` is shorter than the number of walls, the other walls have the default surface. If a list of
/// bodies is shorter than their number, the other bodies have the default surface and unlimited height.
#[derive(Clone, Debug)]
pub struct Space {
    /// Surface of the floor, the unbounded plane z = 0; `None` if the first of the fixed bodies is the ground.
    pub floor: Option<Surface>,
    /// Surfaces of the walls, in the order of their ids.
    pub walls: Vec<Surface>,
    /// First wall that belongs to the outline of a fixed body; all later walls also belong to such outlines. Robots
    /// touch these walls; three-dimensional rays hit the bodies instead.
    pub outlines: Option<WallId>,
    /// Walls with a thickness. Their sides are walls in the plane; this list adds their upper faces.
    pub thick_walls: Vec<ThickWall>,
    /// Fixed bodies, each with its pose in the world.
    pub fixed: Vec<(Pose, Arc<Figure>)>,
    /// Shapes of the robots around their centres, in the order of their ids.
    pub robots: Vec<Arc<Figure>>,
    /// Shapes of the movable objects, in the order of their ids.
    pub objects: Vec<Arc<Figure>>,
}

impl Default for Space {
    fn default() -> Self {
        Self {
            floor: Some(Surface::SMOOTH),
            walls: Vec::new(),
            outlines: None,
            thick_walls: Vec::new(),
            fixed: Vec::new(),
            robots: Vec::new(),
            objects: Vec::new(),
        }
    }
}

/// A wall with a thickness.
#[derive(Clone, Debug)]
pub struct ThickWall {
    /// The first of the four sides of the wall.
    pub wall: WallId,
    /// Pose of the wall's frame; its origin is the midpoint of the wall.
    pub world_from_wall: Pose,
    /// Shape: one prism.
    pub figure: Figure,
}

impl ThickWall {
    /// Creates a wall with the given centre line, `thickness` metres thick and `height` metres high; `wall` is the
    /// first of its sides.
    pub fn new(wall: WallId, centre_line: &Segment, thickness: f64, height: f64) -> Self {
        let along = centre_line.b - centre_line.a;
        let middle = 0.5 * (centre_line.a + centre_line.b);
        let footprint = Shape::Rectangle { half: 0.5 * DVec2::new(centre_line.length(), thickness) };
        let solid = Solid::Prism { footprint, body_from_footprint: Pose::default(), bottom: 0.0, top: height };
        Self {
            wall,
            world_from_wall: Pose::new(middle.x, middle.y, math::atan2(along.y, along.x)),
            figure: Figure { solids: vec![solid], surface: Surface::default() },
        }
    }
}

/// A [`Space`] with data derived from it: indices and flags.
#[derive(Clone, Debug)]
pub(super) struct IndexedSpace {
    pub space: Space,
    /// Index over the bounds of `space.fixed`.
    pub fixed: BoundsIndex<u32>,
    /// Index over the bounds of `space.thick_walls`.
    pub thick_walls: BoundsIndex<u32>,
    /// Height in metres up to which all walls and bodies are prisms that stand on the floor.
    pub prisms_below: f64,
    /// True if at least one body has a mesh.
    pub has_meshes: bool,
    /// Objects with a mesh. Their meshes may extend beyond the footprints, so the index of the objects does not bound
    /// them.
    pub mesh_objects: Vec<ObjectId>,
}

impl IndexedSpace {
    pub fn new(space: Space, walls: &Walls) -> Self {
        let plane_walls = space.outlines.map_or(walls.len(), |first| first.0 as usize) as u32;
        let heights = (0..plane_walls).map(|wall| walls.height(WallId(wall)));
        let figures = space.fixed.iter().map(|(_, figure)| figure).chain(&space.robots).chain(&space.objects);
        let has_meshes = figures.clone().any(|figure| figure.has_mesh());
        let prisms_below = heights.chain(figures.map(|figure| figure.prism_top())).fold(f64::INFINITY, f64::min);
        let fixed = index(space.fixed.iter().map(|(pose, figure)| figure.bounds(pose)));
        let thick_walls = index(space.thick_walls.iter().map(|wall| wall.figure.bounds(&wall.world_from_wall)));
        let objects = (1..).map(ObjectId).zip(&space.objects);
        let mesh_objects = objects.filter(|(_, figure)| figure.has_mesh()).map(|(object, _)| object).collect();
        Self { space, fixed, thick_walls, prisms_below, has_meshes, mesh_objects }
    }

    /// Adds a robot with the shape `figure`; `radii` are the radii of the earlier robots.
    pub fn add_robot(&mut self, figure: Arc<Figure>, radii: impl Iterator<Item = f64>) {
        let without_figure = radii.skip(self.space.robots.len());
        self.space.robots.extend(without_figure.map(|radius| Arc::new(Figure::infinite_cylinder(radius))));
        self.include(&figure);
        self.space.robots.push(figure);
    }

    /// Adds a movable object with the shape `figure`; `properties` are the properties of the earlier objects.
    pub fn add_object<'a>(&mut self, figure: Arc<Figure>, properties: impl Iterator<Item = &'a Arc<Properties>>) {
        let without_figure = properties.skip(self.space.objects.len());
        self.space
            .objects
            .extend(without_figure.map(|properties| Figure::infinite_prism(properties, Surface::default())));
        self.include(&figure);
        self.space.objects.push(figure);
        if self.space.objects.last().is_some_and(|figure| figure.has_mesh()) {
            self.mesh_objects.push(ObjectId::from_index(self.space.objects.len() - 1));
        }
    }

    /// Updates the derived data for an added body.
    fn include(&mut self, figure: &Figure) {
        self.has_meshes |= figure.has_mesh();
        self.prisms_below = self.prisms_below.min(figure.prism_top());
    }

    /// The surface of a wall.
    pub fn wall_surface(&self, wall: WallId) -> Surface {
        self.space.walls.get(wall.0 as usize).copied().unwrap_or_default()
    }

    /// Returns true if three-dimensional rays hit this wall; false if the wall is the outline of a body, because the
    /// rays hit that body instead.
    pub fn is_hit_by_rays(&self, wall: WallId) -> bool {
        self.space.outlines.is_none_or(|first| wall < first)
    }
}

fn index(bounds: impl Iterator<Item = Bounds>) -> BoundsIndex<u32> {
    let mut index = BoundsIndex::default();
    index.rebuild(&(0..).zip(bounds).collect::<Vec<_>>());
    index
}
