//! Ray casts against walls, floor, bodies and objects.

use glam::{DVec2, DVec3};

use super::{World, discs::Disc, objects::Objects};
use crate::{
    RobotId,
    contact::Thing,
    math,
    object::{Figure, SurfaceHit, cast_disc},
    pose::Pose,
    scene::{Nearby, Segment, Surface},
    time::Time,
};

/// The first hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Distance from the ray's origin, m; 0 for an origin inside a body.
    pub distance: f64,
    /// The wall, floor or body that was hit.
    pub thing: Thing,
    /// The surface at the hit. `None` if only the distance is known: for [`Ray::flat`] and [`Ray::tilted`], on the side
    /// of a wall, and on a robot or object that they treat as unlimited in height.
    pub face: Option<HitSurface>,
}

/// Surface at the point where a ray hits it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HitSurface {
    /// Unit normal of the surface on the side from which the ray comes; opposite to the ray's direction if its origin
    /// is inside the body.
    pub normal: DVec3,
    /// Acoustic properties of the surface.
    pub surface: Surface,
    /// Principal curvatures of the surface, 1/m: 0 for a plane, 1 / radius for a convex surface.
    pub curvature: DVec2,
}

/// The elevation angle of a ray above the horizontal, with its sine, cosine and tangent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilt {
    cos: f64,
    sin: f64,
    tan: f64,
}

impl Tilt {
    /// The tilt by `angle` rad, which must be less than a right angle up or down.
    pub fn new(angle: f64) -> Self {
        Self { cos: math::cos(angle), sin: math::sin(angle), tan: math::tan(angle) }
    }

    /// Direction of the ray with this tilt and the horizontal direction `trace`, a unit vector.
    pub fn direction(&self, trace: DVec2) -> DVec3 {
        (trace * self.cos).extend(self.sin)
    }
}

/// Obstacles that a ray treats as unlimited in height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum UnlimitedHeight {
    /// Walls, robots and objects.
    All,
    /// Robots and objects.
    Bodies,
    /// Nothing.
    Nothing,
}

/// A three-dimensional ray. Its trace is its projection onto the floor.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    origin: DVec3,
    direction: DVec3,
    /// Unit vector of the trace; the x axis for a vertical ray.
    trace: DVec2,
    /// Distance along the trace divided by distance along the ray.
    trace_per_distance: f64,
    /// Increase of the height per metre of the trace.
    rise: f64,
    /// Distance along the ray to the floor; infinite if the ray does not reach it.
    floor_distance: f64,
    range: f64,
    unlimited: UnlimitedHeight,
}

/// Factor by which the range along the trace is increased, so that rounding does not exclude obstacles at its end. The
/// distances along the ray are compared with the range again.
const RANGE_FACTOR: f64 = 1.0 + 4.0 * f64::EPSILON;

impl Ray {
    /// The ray from `origin` along the unit vector `direction` that hits obstacles up to and including `range` metres.
    ///
    /// Walls are vertical faces up to their heights that are hit from either side. Bodies are solid: for a ray that
    /// starts inside a body, the distance is 0. Only rays with a downward direction hit the floor; the distance is 0
    /// for a ray that starts below the floor. Any direction is allowed, also straight up and down. An invalid ray hits
    /// nothing: a ray with a coordinate or a range that is NaN, or with a direction whose length is not 1 within 10^-6.
    ///
    /// Source: France et al. 1999, section 4.1 (one ray, the first surface, its normal); the rest is our choice.
    pub fn new(origin: DVec3, direction: DVec3, range: f64) -> Self {
        let is_ray = (direction.length_squared() - 1.0).abs() < 1e-6 && origin.is_finite();
        let planar = direction.truncate();
        // A level ray is bit-identical to its trace.
        let horizontal = if direction.z == 0.0 { 1.0 } else { planar.length() };
        let trace = if horizontal > 0.0 { planar / horizontal } else { DVec2::X };
        // The trace of a vertical ray has length 0, so the quotient is not finite; its rise is set to 0.
        let rise = Some(direction.z / horizontal).filter(|rise| rise.is_finite()).unwrap_or_default();
        let floor_distance = if direction.z < 0.0 { (origin.z / -direction.z).max(0.0) } else { f64::INFINITY };
        let range = if is_ray { range } else { f64::NAN };
        Self {
            origin,
            direction,
            trace,
            trace_per_distance: horizontal,
            rise,
            floor_distance,
            range,
            unlimited: UnlimitedHeight::Nothing,
        }
    }

    /// The ray in the plane from `origin` along the unit vector `direction`. It hits walls, robots and objects as if
    /// their height were unlimited, and fixed bodies at their outlines; it does not hit meshes.
    ///
    /// Source: Koestler & Bräunl, section 4.1. The distance 0 for a ray that starts inside another body is our choice.
    pub fn flat(origin: DVec2, direction: DVec2, range: f64) -> Self {
        Self {
            origin: origin.extend(f64::NAN),
            direction: direction.extend(0.0),
            trace: direction,
            trace_per_distance: 1.0,
            rise: 0.0,
            floor_distance: f64::INFINITY,
            range,
            unlimited: UnlimitedHeight::All,
        }
    }

    /// This planar ray at `height` metres above the floor. It then also hits meshes at that height, and hits a floating
    /// object only at the object's true height.
    pub fn at_height(mut self, height: f64) -> Self {
        self.origin.z = height;
        self
    }

    /// The ray from `origin` with the horizontal direction `trace`, a unit vector, and the elevation angle `tilt`. It
    /// passes over walls that are [lower](crate::scene::Walls::height) than the ray at their distance, and can hit the
    /// upper faces of walls and the floor. It hits robots and objects as if their height were unlimited, except
    /// floating objects, which have their true height. It also hits meshes.
    pub fn tilted(origin: DVec3, trace: DVec2, tilt: &Tilt, range: f64) -> Self {
        let floor_distance = if tilt.tan < 0.0 { origin.z / -tilt.tan / tilt.cos } else { f64::INFINITY };
        let direction = tilt.direction(trace);
        Self {
            origin,
            direction,
            trace,
            trace_per_distance: tilt.cos,
            rise: tilt.tan,
            floor_distance,
            range,
            unlimited: UnlimitedHeight::Bodies,
        }
    }

    /// Height above the floor, m, at the point `distance` metres along the trace.
    fn height_at(&self, distance: f64) -> f64 {
        self.origin.z + self.rise * distance
    }

    /// Distance along the ray of the point `distance` metres along the trace.
    fn ray_distance(&self, distance: f64) -> f64 {
        if distance > 0.0 { distance / self.trace_per_distance } else { 0.0 }
    }
}

/// The rays of one robot at one instant.
pub struct RayCaster<'a> {
    world: &'a World,
    robot: RobotId,
    at: Time,
    /// The moving and the resting robots near the origin of the rays, if they have been collected.
    nearby: Option<Nearby<RobotId>>,
}

/// Minimum number of rays for which collecting the nearby robots saves time. Our choice.
const MIN_RAYS: usize = 4;

/// The state of a ray cast: the ray and its nearest hit so far.
struct RayCast<'a> {
    world: &'a World,
    ray: &'a Ray,
    caster: &'a RayCaster<'a>,
    /// Distance up to which hits are searched: the range, or the distance of the nearest hit so far.
    range: f64,
    nearest: Option<RayHit>,
}

impl World {
    /// First hit of a ray of the robot `caster` at the instant `at`: a wall, the floor, a fixed body, the body of
    /// another robot, or a movable object, by their published motion. If several obstacles are at the same distance,
    /// the result is the first one in the order of [`Thing`]: our choice.
    pub fn cast(&self, caster: RobotId, ray: &Ray, at: Time) -> Option<RayHit> {
        self.caster(caster, at).cast(ray)
    }

    /// A caster for single rays of `robot` at the instant `at`.
    pub fn caster(&self, robot: RobotId, at: Time) -> RayCaster<'_> {
        RayCaster { world: self, robot, at, nearby: None }
    }

    /// A caster for `count` rays of `robot` at the instant `at`. The rays should stay within `reach` metres of
    /// `centre`; a ray that leaves this disc is also correct, but slower.
    pub fn caster_near(&self, robot: RobotId, at: Time, count: usize, centre: DVec2, reach: f64) -> RayCaster<'_> {
        let mut caster = self.caster(robot, at);
        if count >= MIN_RAYS && self.tracks.len() > 1 && reach.is_finite() {
            // The factor prevents rounding from excluding a ray that just stays within `reach`.
            let nearby = caster.nearby.insert(Nearby::new(centre, reach * (1.0 + 1e-6), robot));
            if !(self.moving.add_to(nearby) && self.resting.add_to(nearby)) {
                caster.nearby = None;
            }
        }
        caster
    }
}

impl<'a> RayCaster<'a> {
    /// World of the rays.
    pub fn world(&self) -> &'a World {
        self.world
    }

    /// Robot whose body the rays do not hit.
    pub fn robot(&self) -> RobotId {
        self.robot
    }

    /// Instant of the rays.
    pub fn at(&self) -> Time {
        self.at
    }

    /// First hit of a ray, as [`World::cast`] returns it.
    pub fn cast(&self, ray: &Ray) -> Option<RayHit> {
        let Self { world, robot, .. } = *self;
        let mut cast = RayCast { world, ray, caster: self, range: ray.range, nearest: None };
        cast.cast_floor();
        cast.cast_walls();
        if cast.hits_figures() {
            cast.cast_fixed();
        }
        // The ray does not hit the body of its own robot.
        let has_other_robots = world.tracks.len() > usize::from(robot == RobotId::from_index(0));
        if has_other_robots {
            cast.cast_robots();
        }
        if let Some(objects) = &world.objects {
            cast.cast_objects(objects);
        }
        cast.nearest
    }
}

impl RayCast<'_> {
    /// Distance along the trace up to which hits are searched, m.
    fn trace_range(&self) -> f64 {
        match self.ray.trace_per_distance {
            0.0 => 0.0,
            _ if self.range == f64::INFINITY => f64::INFINITY,
            ratio => self.range * ratio * RANGE_FACTOR,
        }
    }

    /// Records a hit if it is the nearest.
    fn record(&mut self, distance: f64, thing: Thing, face: impl FnOnce() -> Option<HitSurface>) {
        let is_nearer = match &self.nearest {
            Some(nearest) => (distance, thing) < (nearest.distance, nearest.thing),
            None => distance <= self.range,
        };
        if is_nearer {
            self.range = distance;
            self.nearest = Some(RayHit { distance, thing, face: face() });
        }
    }

    fn record_surface(&mut self, hit: Option<SurfaceHit>, thing: Thing, surface: Surface) {
        if let Some(SurfaceHit { distance, normal, curvature }) = hit {
            self.record(distance, thing, || Some(HitSurface { normal, surface, curvature }));
        }
    }

    fn cast_floor(&mut self) {
        if let Some(surface) = self.world.indexed_space.space.floor.filter(|_| self.ray.floor_distance < f64::INFINITY)
        {
            let face = HitSurface { normal: DVec3::Z, surface, curvature: DVec2::ZERO };
            self.record(self.ray.floor_distance, Thing::Floor, || Some(face));
        }
    }

    fn cast_walls(&mut self) {
        let (world, ray, trace_range) = (self.world, self.ray, self.trace_range());
        let (walls, indexed_space, origin) = (&world.walls, &world.indexed_space, ray.origin.truncate());
        let hit = if ray.unlimited == UnlimitedHeight::All {
            walls.cast(origin, ray.trace, trace_range)
        } else {
            walls.cast_where(origin, ray.trace, trace_range, |wall, distance| {
                let is_hit = ray.unlimited == UnlimitedHeight::Bodies || indexed_space.is_hit_by_rays(wall);
                is_hit && ray.height_at(distance) <= walls.height(wall)
            })
        };
        if let Some(hit) = hit {
            self.record(ray.ray_distance(hit.distance), Thing::Wall(hit.wall), || {
                let normal = wall_normal(walls.segment(hit.wall), origin, ray.trace);
                let face = HitSurface { normal, surface: indexed_space.wall_surface(hit.wall), curvature: DVec2::ZERO };
                (ray.unlimited == UnlimitedHeight::Nothing).then_some(face)
            });
        }
        // A level ray can hit only the sides of thick walls.
        if ray.direction.z != 0.0 && !indexed_space.thick_walls.is_empty() {
            indexed_space.thick_walls.along_ray(origin, ray.trace, self.trace_range(), |index| {
                let block = &indexed_space.space.thick_walls[index as usize];
                let hit = block.figure.cast_hollow(&block.world_from_wall, ray.origin, ray.direction);
                self.record_surface(hit, Thing::Wall(block.wall), indexed_space.wall_surface(block.wall));
                self.trace_range()
            });
        }
    }

    /// Returns true if the ray hits bodies as three-dimensional shapes, not only as footprints.
    fn hits_figures(&self) -> bool {
        self.ray.unlimited == UnlimitedHeight::Nothing
            || self.world.indexed_space.has_meshes && !self.ray.origin.z.is_nan()
    }

    /// Records the hit on a body of this shape; if bodies are treated as unlimited in height, only a hit on a mesh.
    fn cast_figure(&mut self, thing: Thing, pose: &Pose, figure: &Figure) {
        let cast = if self.ray.unlimited == UnlimitedHeight::Nothing { Figure::cast } else { Figure::cast_meshes };
        let hit = cast(figure, pose, self.ray.origin, self.ray.direction, self.range);
        self.record_surface(hit, thing, figure.surface);
    }

    fn cast_fixed(&mut self) {
        let indexed_space = &self.world.indexed_space;
        indexed_space.fixed.along_ray(self.ray.origin.truncate(), self.ray.trace, self.trace_range(), |index| {
            let (pose, figure) = &indexed_space.space.fixed[index as usize];
            self.cast_figure(Thing::Fixed(index), pose, figure);
            self.trace_range()
        });
    }

    // Not inlined, because the search along the walls, in the same calling function, needs the registers.
    #[inline(never)]
    fn cast_robots(&mut self) {
        let (world, origin, trace) = (self.world, self.ray.origin.truncate(), self.ray.trace);
        if world.has_published_plan_only() {
            _ = self.cast_robot(RobotId::from_index(0));
            return;
        }
        let range = self.trace_range();
        if let Some(nearby) = &self.caster.nearby
            && nearby.contains(origin, range)
        {
            nearby.along_ray(origin, trace, range, |robot| _ = self.cast_robot(robot));
            return;
        }
        world.resting.along_ray(origin, trace, self.trace_range(), |robot| self.cast_robot(robot));
        world.moving.along_ray(origin, trace, self.trace_range(), |robot| self.cast_robot(robot));
    }

    /// Records the hit on a robot, and returns the new distance along the trace up to which hits are searched.
    fn cast_robot(&mut self, robot: RobotId) -> f64 {
        let (world, ray, at) = (self.world, self.ray, self.caster.at);
        if robot == self.caster.robot {
            return self.trace_range();
        }
        let (thing, disc) = (Thing::Robot(robot), world.discs.get(robot, at, || world.disc(robot, at)));
        let Some(Disc { centre, radius }) = disc else { return self.trace_range() };
        if ray.unlimited != UnlimitedHeight::Nothing
            && let Some(distance) = cast_disc(ray.origin.truncate(), ray.trace, centre, radius)
        {
            self.record(ray.ray_distance(distance), thing, || None);
        }
        if self.hits_figures() {
            let (pose, figure) = world.robot_figure(robot, at);
            self.cast_figure(thing, &pose, &figure);
        }
        self.trace_range()
    }

    fn cast_objects(&mut self, objects: &Objects) {
        let (world, ray, at) = (self.world, self.ray, self.caster.at);
        let origin = ray.origin.truncate();
        objects.along_ray(origin, ray.trace, self.trace_range(), at, |object| {
            let (thing, pose) = (Thing::Object(object), objects.pose(object, at));
            let properties = objects.properties(object);
            // A ray can pass below an object that floats.
            let has_true_height = properties.lift > 0.0 && !ray.origin.z.is_nan();
            if ray.unlimited == UnlimitedHeight::Nothing || has_true_height {
                let figure = world.object_figure(object);
                if !figure.has_mesh() {
                    let hit = figure.cast(&pose, ray.origin, ray.direction, self.range);
                    self.record_surface(hit, thing, figure.surface);
                }
            } else if let Some(distance) = properties.cast(&pose, origin, ray.trace) {
                self.record(ray.ray_distance(distance), thing, || None);
            }
            self.trace_range()
        });
        let hits_meshes = self.hits_figures();
        let meshes = world.indexed_space.mesh_objects.iter().filter(|_| hits_meshes);
        for object in meshes.filter(|object| objects.lifetime(**object).contains(at)) {
            self.cast_figure(Thing::Object(*object), &objects.pose(*object, at), &world.object_figure(*object));
        }
    }
}

/// Normal of a wall on the side from which the ray comes; opposite to the ray for a wall of no length.
fn wall_normal(segment: &Segment, origin: DVec2, trace: DVec2) -> DVec3 {
    let normal = (segment.b - segment.a).perp().normalize_or(-trace);
    let side = normal.dot(origin - segment.a);
    (if side < 0.0 || side == 0.0 && normal.dot(trace) > 0.0 { -normal } else { normal }).extend(0.0)
}
