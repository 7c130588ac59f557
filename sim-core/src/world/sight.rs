//! Rays in space: what they meet first of walls, floor, bodies and objects.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{Slope, World};
use crate::{
    ObjectId, RobotId,
    object::{Figure, Met},
    pose::Pose,
    scene::{Bounds, Segment, Surface, WallId},
    time::Time,
};

/// What a ray in space meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Seen {
    /// A wall; of a thick one, one of its sides, also for its upper face.
    Wall(WallId),
    /// The floor.
    Floor,
    /// A body that never moves, by its place in [`Space::fixed`](super::Space::fixed).
    Fixed(u32),
    /// The body of a robot.
    Robot(RobotId),
    /// A movable object.
    Object(ObjectId),
}

/// What a ray in space meets first, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Distance from the ray's origin, m; 0 when the origin lies inside a body.
    pub distance: f64,
    /// What is met.
    pub thing: Seen,
    /// Unit vector perpendicular to the surface, on the side from which the ray comes; against the ray when the origin lies
    /// inside.
    pub normal: DVec3,
    /// What the surface is made of.
    pub surface: Surface,
    /// Principal curvatures of the surface, 1/m: 0 where it is plane, 1 over the radius where it bulges.
    pub curvature: DVec2,
}

/// Factor on a range along the floor that keeps what lies at its very end; distances are compared again along the ray.
const END: f64 = 1.0 + 4.0 * f64::EPSILON;

/// A ray in space, and its trace on the floor.
struct Ray {
    origin: DVec3,
    direction: DVec3,
    /// Unit vector of the trace; that of x for a vertical ray.
    trace: DVec2,
    /// Distance along the trace over distance along the ray.
    level: f64,
    /// How far it is followed: the range, or the distance of the nearest thing so far.
    range: f64,
    nearest: Option<Sighting>,
}

impl Ray {
    fn new(origin: DVec3, direction: DVec3, range: f64) -> Option<Self> {
        let is_ray = (direction.length_squared() - 1.0).abs() < 1e-6 && origin.is_finite() && range >= 0.0;
        if !is_ray {
            return None;
        }
        let across = direction.truncate();
        // A level ray is its own trace, to the bit.
        let level = if direction.z == 0.0 { 1.0 } else { across.length() };
        let trace = if level > 0.0 { across / level } else { DVec2::X };
        Some(Self { origin, direction, trace, level, range, nearest: None })
    }

    /// How far the trace is followed, m.
    fn reach(&self) -> f64 {
        if self.range == f64::INFINITY && self.level > 0.0 { f64::INFINITY } else { self.range * self.level * END }
    }

    /// Distance along the ray of a point of the trace.
    fn along(&self, distance: f64) -> f64 {
        if distance > 0.0 { distance / self.level } else { 0.0 }
    }

    /// Takes what is met into account, if it is nearest.
    fn meet(&mut self, met: Met, thing: Seen, surface: Surface) {
        let is_nearer = match &self.nearest {
            Some(nearest) => (met.distance, thing) < (nearest.distance, nearest.thing),
            None => met.distance <= self.range,
        };
        if is_nearer {
            let Met { distance, normal, curvature } = met;
            self.range = distance;
            self.nearest = Some(Sighting { distance, thing, normal, surface, curvature });
        }
    }
}

/// A way of meeting a figure at a pose with a ray: origin, direction and range.
type Cast = fn(&Figure, &Pose, DVec3, DVec3, f64) -> Option<Met>;

impl World {
    /// What a ray from `origin` along the unit vector `direction`, both in the world frame, meets first within `range`
    /// metres, that included, at the instant `at`: a wall up to its height, the floor, a fixed body, the body of another
    /// robot than `by`, or a movable object, by their public trajectories.
    ///
    /// Walls are faces, met from either side; bodies are full, and read 0 from inside. The floor is met by falling rays
    /// alone, at 0 from below it. At equal distances the thing that comes first in [`Seen`] is met. Any direction will do,
    /// straight up and down too. `None` also for what is no ray: a coordinate or range that is NaN, a direction whose
    /// length is not 1 within 10^-6.
    ///
    /// Source: France et al. 1999, section 4.1 (one ray, the first surface, its normal); the rest: our choice.
    pub fn sight(&self, by: RobotId, origin: DVec3, direction: DVec3, range: f64, at: Time) -> Option<Sighting> {
        let mut ray = Ray::new(origin, direction, range)?;
        self.sight_floor(&mut ray);
        self.sight_walls(&mut ray);
        self.sight_bodies(&mut ray, by, at, Figure::cast);
        ray.nearest
    }

    fn sight_floor(&self, ray: &mut Ray) {
        if let Some(surface) = self.stage.space.floor.filter(|_| ray.direction.z < 0.0) {
            let distance = (ray.origin.z / -ray.direction.z).max(0.0);
            ray.meet(plane(distance, DVec3::Z), Seen::Floor, surface);
        }
    }

    fn sight_walls(&self, ray: &mut Ray) {
        let (walls, stage) = (&self.walls, &self.stage);
        let rise = if ray.direction.z == 0.0 { 0.0 } else { ray.direction.z / ray.level };
        // Of a vertical ray, there is only the origin: no height to gain.
        let slope = Slope { height: ray.origin.z, rise: if rise.is_finite() { rise } else { 0.0 } };
        let hit = walls.cast_where(ray.origin.truncate(), ray.trace, ray.reach(), |wall, distance| {
            stage.is_wall(wall) && slope.height_at(distance) <= walls.height(wall)
        });
        if let Some(hit) = hit {
            let normal = wall_normal(walls.segment(hit.wall), ray.origin.truncate(), ray.trace);
            ray.meet(plane(ray.along(hit.distance), normal), Seen::Wall(hit.wall), stage.wall_surface(hit.wall));
        }
        // Without a slope, the sides are all there is to meet.
        if ray.direction.z != 0.0 && !stage.blocks.is_empty() {
            self.sight_blocks(ray);
        }
    }

    fn sight_blocks(&self, ray: &mut Ray) {
        let (origin, trace, reach) = (ray.origin.truncate(), ray.trace, ray.reach());
        self.stage.blocks.along_ray(origin, trace, reach, |place| {
            let block = &self.stage.space.blocks[place as usize];
            if let Some(met) = block.figure.cast_hollow(&block.world_from_block, ray.origin, ray.direction) {
                ray.meet(met, Seen::Wall(block.wall), self.stage.wall_surface(block.wall));
            }
        });
    }

    /// What a ray meets first of what the plane of walls and footprints does not tell: meshes and, where the ray rises or
    /// falls, upper faces of walls. Nothing is looked for in a scene without.
    pub fn sight_off_plane(
        &self,
        by: RobotId,
        origin: DVec3,
        direction: DVec3,
        range: f64,
        at: Time,
    ) -> Option<Sighting> {
        let has_blocks = direction.z != 0.0 && !self.stage.blocks.is_empty();
        if !has_blocks && !self.stage.has_meshes {
            return None;
        }
        let mut ray = Ray::new(origin, direction, range)?;
        if has_blocks {
            self.sight_blocks(&mut ray);
        }
        if self.stage.has_meshes {
            self.sight_bodies(&mut ray, by, at, Figure::cast_meshes);
        }
        ray.nearest
    }

    fn sight_bodies(&self, ray: &mut Ray, by: RobotId, at: Time, cast: Cast) {
        let (origin, trace, reach) = (ray.origin.truncate(), ray.trace, ray.reach());
        let mut look_at = |thing: Seen, pose: &Pose, figure: &Figure| {
            if let Some(met) = cast(figure, pose, ray.origin, ray.direction, ray.range) {
                ray.meet(met, thing, figure.surface);
            }
        };
        self.stage.fixed.along_ray(origin, trace, reach, |place| {
            let (pose, figure) = &self.stage.space.fixed[place as usize];
            look_at(Seen::Fixed(place), pose, figure);
        });
        let mut look_at_robot = |robot: RobotId| {
            if robot != by && self.is_robot_there(robot, at) {
                let (pose, figure) = self.robot_figure(robot, at);
                look_at(Seen::Robot(robot), &pose, &figure);
            }
        };
        self.resting.along_ray(origin, trace, reach, &mut look_at_robot);
        self.moving.along_ray(origin, trace, reach, &mut look_at_robot);
        let Some(objects) = &self.objects else { return };
        let mut look_at_object = |object, figure: &Figure| {
            look_at(Seen::Object(object), &objects.pose(object, at), figure);
        };
        objects.along_ray(origin, trace, reach, at, |object| {
            let figure = self.object_figure(object);
            if !figure.has_mesh() {
                look_at_object(object, &figure);
            }
        });
        for object in self.stage.mesh_objects.iter().filter(|object| objects.presence(**object).holds(at)) {
            look_at_object(*object, &self.object_figure(*object));
        }
    }

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
        let near = Bounds::of_disc(point.truncate(), reach);
        if self.stage.space.floor.is_some() {
            visit(point.with_z(point.z.min(0.0)));
        }
        self.walls.for_each_in(near, |wall, segment| {
            if self.stage.is_wall(wall) {
                let height = self.walls.height(wall);
                visit(segment.nearest_point(point.truncate()).extend(point.z.clamp(0.0, height)));
            }
        });
        self.stage.blocks.for_each_in(near, |place| {
            let block = &self.stage.space.blocks[place as usize];
            block.figure.for_each_nearest(&block.world_from_block, point, &mut visit);
        });
        self.stage.fixed.for_each_in(near, |place| {
            let (pose, figure) = &self.stage.space.fixed[place as usize];
            figure.for_each_nearest(pose, point, &mut visit);
        });
        self.for_each_near(near, at, |robot| {
            if robot != by {
                let (pose, figure) = self.robot_figure(robot, at);
                figure.for_each_nearest(&pose, point, &mut visit);
            }
        });
        let Some(objects) = &self.objects else { return };
        objects.for_each_in(near, at, |object| {
            self.object_figure(object).for_each_nearest(&objects.pose(object, at), point, &mut visit);
        });
    }
}

fn plane(distance: f64, normal: DVec3) -> Met {
    Met { distance, normal, curvature: DVec2::ZERO }
}

/// The normal of a wall on the side from which the ray comes; against the ray, where the wall has no length.
fn wall_normal(segment: &Segment, origin: DVec2, trace: DVec2) -> DVec3 {
    let normal = (segment.b - segment.a).perp().normalize_or(-trace);
    let side = normal.dot(origin - segment.a);
    (if side < 0.0 || side == 0.0 && normal.dot(trace) > 0.0 { -normal } else { normal }).extend(0.0)
}
