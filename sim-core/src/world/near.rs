//! Geometry of the bodies and walls near a point.

use std::sync::Arc;

use glam::DVec3;

use super::World;
use crate::{
    ObjectId, RobotId,
    contact::Thing,
    object::Figure,
    pose::Pose,
    scene::{Bounds, Segment, Surface},
    time::Time,
};

/// Geometry of an obstacle at its current pose.
pub(super) enum Geometry<'a> {
    /// A vertical face from the floor up to the given height, m.
    Wall(&'a Segment, f64),
    /// A body with the given pose and shape.
    Body(&'a Pose, &'a Figure),
}

impl Geometry<'_> {
    /// Height up to which the outline is the same as at the floor, m; 0 if a part is not a prism that stands on the
    /// floor.
    fn prism_top(&self) -> f64 {
        match self {
            Self::Wall(_, height) => *height,
            Self::Body(_, figure) => figure.prism_top(),
        }
    }

    /// Calls `visit` for each convex part of the geometry, in a fixed order, with its nearest point to `point`.
    pub fn for_each_nearest(&self, point: DVec3, mut visit: impl FnMut(DVec3)) {
        match self {
            Self::Wall(segment, height) => {
                visit(segment.nearest_point(point.truncate()).extend(point.z.clamp(0.0, *height)));
            }
            Self::Body(pose, figure) => figure.for_each_nearest(pose, point, visit),
        }
    }
}

impl World {
    /// Shape and pose of a robot's body. The heading is 0, because the shape is rotationally symmetric.
    pub(super) fn robot_figure(&self, robot: RobotId, at: Time) -> (Pose, Arc<Figure>) {
        let body = self.body(robot, at);
        let pose = Pose { position: body.centre, ..Pose::default() };
        let figure = self.indexed_space.space.robots.get(robot.index()).map(Arc::clone);
        (pose, figure.unwrap_or_else(|| Arc::new(Figure::infinite_cylinder(body.radius))))
    }

    pub(super) fn object_figure(&self, object: ObjectId) -> Arc<Figure> {
        let figure = self.indexed_space.space.objects.get(object.index()).map(Arc::clone);
        figure.unwrap_or_else(|| Figure::infinite_prism(self.objects().properties(object), Surface::default()))
    }

    /// Returns true if all walls and bodies within `max_distance` metres of `point` in plan view, at the instant `at`,
    /// are prisms from the floor up to at least the height of `point`. Then such an obstacle has no point above or
    /// below this height that is nearer than its points at this height. The robot `excluded` and the floor are not
    /// included: see [`Space::floor`](super::Space).
    pub(crate) fn is_upright_near(&self, excluded: RobotId, point: DVec3, max_distance: f64, at: Time) -> bool {
        if point.z < 0.0 || point.z <= self.indexed_space.prisms_below {
            return point.z >= 0.0;
        }
        if !self.indexed_space.mesh_objects.is_empty() {
            return false;
        }
        let mut lowest_top = f64::INFINITY;
        let bounds = Bounds::of_disc(point.truncate(), max_distance);
        self.for_each_geometry(excluded, bounds, at, |_, geometry| lowest_top = lowest_top.min(geometry.prism_top()));
        point.z <= lowest_top
    }

    /// Returns true if any body has a mesh.
    pub(crate) fn has_meshes(&self) -> bool {
        self.indexed_space.has_meshes
    }

    /// Acoustic properties of the floor; `None` if a fixed body is the ground.
    pub(crate) fn floor_surface(&self) -> Option<Surface> {
        self.indexed_space.space.floor
    }

    /// Calls `visit`, in a fixed order, for the floor and for each wall and each convex part of a body that may be
    /// within `max_distance` metres of `point` at the instant `at`. The argument is the nearest point of the floor,
    /// wall or part. Skips meshes and the robot `excluded`.
    pub(crate) fn for_each_nearest(
        &self,
        excluded: RobotId,
        point: DVec3,
        max_distance: f64,
        at: Time,
        mut visit: impl FnMut(DVec3),
    ) {
        if self.indexed_space.space.floor.is_some() {
            visit(point.with_z(point.z.min(0.0)));
        }
        let bounds = Bounds::of_disc(point.truncate(), max_distance);
        self.for_each_geometry(excluded, bounds, at, |_, geometry| geometry.for_each_nearest(point, &mut visit));
    }

    /// Calls `visit` for each obstacle that may overlap `bounds` at the instant `at`, in a fixed order; skips the floor
    /// and the robot `excluded`.
    pub(super) fn for_each_geometry(
        &self,
        excluded: RobotId,
        bounds: Bounds,
        at: Time,
        mut visit: impl FnMut(Thing, &Geometry<'_>),
    ) {
        let indexed_space = &self.indexed_space;
        self.walls.for_each_in(bounds, |wall, segment| {
            if indexed_space.is_hit_by_rays(wall) {
                visit(Thing::Wall(wall), &Geometry::Wall(segment, self.walls.height(wall)));
            }
        });
        indexed_space.thick_walls.for_each_in(bounds, |index| {
            let block = &indexed_space.space.thick_walls[index as usize];
            visit(Thing::Wall(block.wall), &Geometry::Body(&block.world_from_wall, &block.figure));
        });
        indexed_space.fixed.for_each_in(bounds, |index| {
            let (pose, figure) = &indexed_space.space.fixed[index as usize];
            visit(Thing::Fixed(index), &Geometry::Body(pose, figure));
        });
        self.for_each_near(bounds, at, |robot| {
            if robot != excluded {
                let (pose, figure) = self.robot_figure(robot, at);
                visit(Thing::Robot(robot), &Geometry::Body(&pose, &figure));
            }
        });
        let Some(objects) = &self.objects else { return };
        objects.for_each_in(bounds, at, |object| {
            let figure = self.object_figure(object);
            visit(Thing::Object(object), &Geometry::Body(&objects.pose(object, at), &figure));
        });
    }
}
