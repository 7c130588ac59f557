//! What stands near a place, with its shape.

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

/// The geometry of a thing where it stands.
pub(super) enum Geometry<'a> {
    /// A face up to this height.
    Wall(&'a Segment, f64),
    /// A body of this shape.
    Body(&'a Pose, &'a Figure),
}

impl Geometry<'_> {
    /// Visits the point nearest to `point` of each convex part, in a fixed order.
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
    /// The shape of a robot's body, and where it is; what it looks like from which side does not matter.
    pub(super) fn robot_figure(&self, robot: RobotId, at: Time) -> (Pose, Arc<Figure>) {
        let body = self.body(robot, at);
        let pose = Pose { position: body.centre, ..Pose::default() };
        let figure = self.stage.space.robots.get(robot.index()).map(Arc::clone);
        (pose, figure.unwrap_or_else(|| Arc::new(Figure::upright(body.radius))))
    }

    pub(super) fn object_figure(&self, object: ObjectId) -> Arc<Figure> {
        let figure = self.stage.space.objects.get(object.index()).map(Arc::clone);
        figure.unwrap_or_else(|| Figure::endless(self.objects().properties(object), Surface::default()))
    }

    /// Whether all that a level ray at the height `z` may meet stands upright and reaches up to it, so that nothing above
    /// or below a thing is nearer than the thing itself at that height; of the floor, see [`Space::floor`](super::Space).
    pub(crate) fn is_upright_at(&self, z: f64) -> bool {
        z >= 0.0 && z <= self.stage.plain_below
    }

    /// Whether there is a mesh among the bodies.
    pub(crate) fn has_meshes(&self) -> bool {
        self.stage.has_meshes
    }

    /// What the floor is made of; `None` where a body is the ground.
    pub(crate) fn floor_surface(&self) -> Option<Surface> {
        self.stage.space.floor
    }

    /// Visits the point nearest to `point` of the floor, and of each wall and of each part of a body, but meshes, that may come within
    /// `reach` metres of it, at the instant `at`, in a fixed order.
    pub(crate) fn for_each_nearest(
        &self,
        by: RobotId,
        point: DVec3,
        reach: f64,
        at: Time,
        mut visit: impl FnMut(DVec3),
    ) {
        if self.stage.space.floor.is_some() {
            visit(point.with_z(point.z.min(0.0)));
        }
        let near = Bounds::of_disc(point.truncate(), reach);
        self.for_each_geometry(by, near, at, |_, geometry| geometry.for_each_nearest(point, &mut visit));
    }

    /// Visits each thing but the floor and robot `by` that may reach into `near` at the instant `at`, in a fixed order.
    pub(super) fn for_each_geometry(
        &self,
        by: RobotId,
        near: Bounds,
        at: Time,
        mut visit: impl FnMut(Thing, &Geometry<'_>),
    ) {
        let stage = &self.stage;
        self.walls.for_each_in(near, |wall, segment| {
            if stage.is_wall(wall) {
                visit(Thing::Wall(wall), &Geometry::Wall(segment, self.walls.height(wall)));
            }
        });
        stage.blocks.for_each_in(near, |place| {
            let block = &stage.space.blocks[place as usize];
            visit(Thing::Wall(block.wall), &Geometry::Body(&block.world_from_block, &block.figure));
        });
        stage.fixed.for_each_in(near, |place| {
            let (pose, figure) = &stage.space.fixed[place as usize];
            visit(Thing::Fixed(place), &Geometry::Body(pose, figure));
        });
        self.for_each_near(near, at, |robot| {
            if robot != by {
                let (pose, figure) = self.robot_figure(robot, at);
                visit(Thing::Robot(robot), &Geometry::Body(&pose, &figure));
            }
        });
        let Some(objects) = &self.objects else { return };
        objects.for_each_in(near, at, |object| {
            let figure = self.object_figure(object);
            visit(Thing::Object(object), &Geometry::Body(&objects.pose(object, at), &figure));
        });
    }
}
