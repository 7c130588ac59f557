//! Three-dimensional shapes for ray casts: prisms over footprints, capsules, and meshes.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{Properties, Shape};
use crate::{
    pose::Pose,
    scene::{Bounds, MeshIndex, Surface},
};

/// A geometric primitive: a part of a body's three-dimensional shape, in the body's frame (x forward, y left, z up), in
/// metres.
#[derive(Clone, Debug)]
pub enum Solid {
    /// A footprint that is extruded between two heights, such as a box or an upright cylinder.
    Prism {
        /// The footprint, in its own frame.
        footprint: Shape,
        /// Pose of the footprint in the body's frame.
        body_from_footprint: Pose,
        /// Height of the lower face.
        bottom: f64,
        /// Height of the upper face; infinite for a body without a top.
        top: f64,
    },
    /// All points within `radius` of a segment; a sphere if the ends of the segment are equal.
    Capsule {
        /// Ends of the segment.
        ends: [DVec3; 2],
        /// Distance from the segment; positive.
        radius: f64,
    },
    /// The triangles of a mesh: a hollow surface that rays hit from either side.
    Mesh(Arc<MeshIndex>),
}

/// Three-dimensional shape of a body and its surface.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// The parts, in the body's frame.
    pub solids: Vec<Solid>,
    /// Surface of all parts.
    pub surface: Surface,
}

/// Hit of a ray on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// Distance from the ray's origin, m; 0 if the origin is inside a prism or capsule.
    pub distance: f64,
    /// Unit normal of the surface, on the side from which the ray comes; opposite to the ray's direction if the origin
    /// is inside a prism or capsule.
    pub normal: DVec3,
    /// Principal curvatures of the surface, 1/m: 0 for a plane, 1 / radius for a convex surface.
    pub curvature: DVec2,
}

impl Figure {
    /// An upright cylinder around the body's origin, from the floor up to `top`.
    pub fn cylinder(radius: f64, top: f64, surface: Surface) -> Self {
        let footprint = Shape::Disc { radius };
        let solid = Solid::Prism { footprint, body_from_footprint: Pose::default(), bottom: 0.0, top };
        Self { solids: vec![solid], surface }
    }

    /// An upright cylinder of infinite height around the body's origin, with the default surface.
    pub fn infinite_cylinder(radius: f64) -> Self {
        Self::cylinder(radius, f64::INFINITY, Surface::default())
    }

    /// The footprint of `properties`, extruded to infinite height.
    pub fn infinite_prism(properties: &Properties, surface: Surface) -> Arc<Self> {
        let solids = properties.parts.iter().map(|part| Solid::Prism {
            footprint: part.shape,
            body_from_footprint: part.object_from_part,
            bottom: 0.0,
            top: f64::INFINITY,
        });
        Arc::new(Self { solids: solids.collect(), surface })
    }

    /// First hit of a ray (in the world frame) on a body of this shape at `world_from_body`. Hits beyond `range` metres
    /// may be omitted.
    ///
    /// `direction` is a unit vector. A ray that starts inside or on a prism or capsule hits it at distance 0; a mesh is
    /// hollow.
    pub fn cast(&self, world_from_body: &Pose, origin: DVec3, direction: DVec3, range: f64) -> Option<SurfaceHit> {
        self.first_hit(world_from_body, origin, direction, |solid, origin, direction| {
            solid.cast(origin, direction, range)
        })
    }

    /// [`Figure::cast`] for meshes only.
    pub fn cast_meshes(
        &self,
        world_from_body: &Pose,
        origin: DVec3,
        direction: DVec3,
        range: f64,
    ) -> Option<SurfaceHit> {
        self.first_hit(world_from_body, origin, direction, |solid, origin, direction| match solid {
            Solid::Mesh(mesh) => cast_mesh(mesh, origin, direction, range),
            _ => None,
        })
    }

    /// Returns true if a part of the figure is a mesh.
    pub fn has_mesh(&self) -> bool {
        self.solids.iter().any(|solid| matches!(solid, Solid::Mesh(_)))
    }

    /// [`Figure::cast`] for prisms only, as hollow bodies: the hit of a ray that starts inside is where the ray leaves
    /// the prism.
    pub fn cast_hollow(&self, world_from_body: &Pose, origin: DVec3, direction: DVec3) -> Option<SurfaceHit> {
        self.first_hit(world_from_body, origin, direction, Solid::cast_hollow)
    }

    fn first_hit(
        &self,
        world_from_body: &Pose,
        origin: DVec3,
        direction: DVec3,
        cast: impl Fn(&Solid, DVec3, DVec3) -> Option<SurfaceHit>,
    ) -> Option<SurfaceHit> {
        let axis = world_from_body.heading.direction();
        let (origin, direction) =
            (to_local(world_from_body.position, axis, origin), to_local(DVec2::ZERO, axis, direction));
        let hit = self.solids.iter().filter_map(|solid| cast(solid, origin, direction));
        let nearest = hit.min_by(|one, other| one.distance.total_cmp(&other.distance))?;
        Some(SurfaceHit { normal: axis.rotate(nearest.normal.truncate()).extend(nearest.normal.z), ..nearest })
    }

    /// The body's bounding rectangle in plan view.
    pub fn bounds(&self, world_from_body: &Pose) -> Bounds {
        self.solids.iter().map(|solid| solid.bounds(world_from_body)).fold(Bounds::EMPTY, Bounds::union)
    }

    /// Calls `visit` for each part with its nearest point to `point`, both in the world frame; skips meshes.
    pub fn for_each_nearest(&self, world_from_body: &Pose, point: DVec3, mut visit: impl FnMut(DVec3)) {
        let axis = world_from_body.heading.direction();
        let local = to_local(world_from_body.position, axis, point);
        for solid in &self.solids {
            if let Some(nearest) = solid.nearest_point(local) {
                visit((world_from_body.position + axis.rotate(nearest.truncate())).extend(nearest.z));
            }
        }
    }

    /// Height up to which the outline is the same as at the floor, m; 0 if a part is not a prism that stands on the
    /// floor.
    pub fn prism_top(&self) -> f64 {
        let top = |solid: &Solid| match *solid {
            Solid::Prism { bottom, top, .. } if bottom <= 0.0 => top,
            _ => 0.0,
        };
        self.solids.iter().map(top).fold(f64::INFINITY, f64::min)
    }
}

impl Solid {
    /// First hit of a ray in the body's frame.
    fn cast(&self, origin: DVec3, direction: DVec3, range: f64) -> Option<SurfaceHit> {
        match self {
            Self::Prism { .. } => {
                let interval = self.interval(origin, direction).filter(|interval| interval.leave >= 0.0)?;
                Some(if interval.enter < 0.0 { hit_from_inside(direction) } else { interval.hit() })
            }
            Self::Capsule { ends, radius } => cast_capsule(origin, direction, *ends, *radius),
            Self::Mesh(mesh) => cast_mesh(mesh, origin, direction, range),
        }
    }

    fn cast_hollow(&self, origin: DVec3, direction: DVec3) -> Option<SurfaceHit> {
        let interval = self.interval(origin, direction).filter(|interval| interval.leave >= 0.0)?;
        Some(if interval.enter < 0.0 {
            SurfaceHit { distance: interval.leave, ..hit_from_inside(direction) }
        } else {
            interval.hit()
        })
    }

    /// Interval of the ray's line inside a prism; `None` if the line misses the prism, and for other solids.
    fn interval(&self, origin: DVec3, direction: DVec3) -> Option<Interval> {
        let Self::Prism { footprint, body_from_footprint, bottom, top } = self else { return None };
        let axis = body_from_footprint.heading.direction();
        let local = to_local(body_from_footprint.position, axis, origin);
        let planar = interval_of_shape(footprint, local.truncate(), to_local(DVec2::ZERO, axis, direction).truncate())?;
        let planar = Interval { normal: axis.rotate(planar.normal.truncate()).extend(0.0), ..planar };
        let (enter, leave) = slab(*bottom, *top, origin.z, direction.z)?;
        let leave = leave.min(planar.leave);
        let interval = if enter > planar.enter {
            Interval { enter, leave, normal: DVec3::new(0.0, 0.0, -direction.z.signum()), curvature: 0.0 }
        } else {
            Interval { leave, ..planar }
        };
        (interval.enter <= interval.leave).then_some(interval)
    }

    fn bounds(&self, world_from_body: &Pose) -> Bounds {
        match self {
            Self::Prism { footprint, body_from_footprint, .. } => {
                footprint.bounds(&world_from_body.compose(body_from_footprint))
            }
            Self::Capsule { ends, radius } => {
                Bounds::of_points(ends.map(|end| world_from_body.transform_point(end.truncate()))).grown(*radius)
            }
            Self::Mesh(mesh) => mesh.bounds().map_or(Bounds::EMPTY, |(low, high)| {
                let corners = [low, low.with_x(high.x), low.with_y(high.y), high];
                let bounds =
                    Bounds::of_points(corners.map(|corner| world_from_body.transform_point(corner.truncate())));
                // A margin for rounding errors; the exact test uses the BVH of the mesh.
                bounds.grown(1e-9)
            }),
        }
    }

    /// Point of the solid that is nearest to `point`: `point` itself if it is inside, `None` for a mesh.
    fn nearest_point(&self, point: DVec3) -> Option<DVec3> {
        match self {
            Self::Prism { footprint, body_from_footprint, bottom, top } => {
                let local = body_from_footprint.inverse_transform_point(point.truncate());
                let nearest = body_from_footprint.transform_point(footprint.nearest_point(local));
                Some(nearest.extend(point.z.clamp(*bottom, *top)))
            }
            Self::Capsule { ends, radius } => {
                let core = nearest_on_segment(point, *ends);
                let offset = point - core;
                Some(if offset.length() <= *radius { point } else { core + offset * (*radius / offset.length()) })
            }
            Self::Mesh(_) => None,
        }
    }
}

/// Interval of a line inside a convex shape, as distances from the ray's origin; negative distances are behind the
/// origin.
#[derive(Clone, Copy, Debug)]
struct Interval {
    /// Distance to the entry.
    enter: f64,
    /// Distance to the exit.
    leave: f64,
    /// Outward normal at the entry.
    normal: DVec3,
    /// Curvature of the surface at the entry, in the floor plane, 1/m.
    curvature: f64,
}

impl Interval {
    /// Hit at the entry.
    fn hit(&self) -> SurfaceHit {
        SurfaceHit { distance: self.enter, normal: self.normal, curvature: DVec2::new(self.curvature, 0.0) }
    }
}

fn hit_from_inside(direction: DVec3) -> SurfaceHit {
    SurfaceHit { distance: 0.0, normal: -direction, curvature: DVec2::ZERO }
}

/// Transforms `point` into the frame at `position` whose x axis is `axis`; heights are unchanged.
fn to_local(position: DVec2, axis: DVec2, point: DVec3) -> DVec3 {
    DVec2::new(axis.x, -axis.y).rotate(point.truncate() - position).extend(point.z)
}

/// Interval of ray parameters t for which `origin + t * direction` is between `low` and `high`, inclusive.
fn slab(low: f64, high: f64, origin: f64, direction: f64) -> Option<(f64, f64)> {
    if direction == 0.0 {
        return (low <= origin && origin <= high).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (one, other) = ((low - origin) / direction, (high - origin) / direction);
    Some((one.min(other), one.max(other)))
}

/// Interval of a line inside an infinite prism over a footprint; `direction` is the horizontal part of a unit vector
/// and can be zero.
fn interval_of_shape(shape: &Shape, origin: DVec2, direction: DVec2) -> Option<Interval> {
    match *shape {
        Shape::Disc { radius } => interval_of_disc(origin, direction, DVec2::ZERO, radius),
        Shape::Rectangle { half } => interval_of_rectangle(origin, direction, half),
        Shape::Capsule { half_length, radius } => {
            let middle = interval_of_rectangle(origin, direction, DVec2::new(half_length, radius));
            let end = |x: f64| interval_of_disc(origin, direction, DVec2::new(x, 0.0), radius);
            // The shape is convex, so the line is inside from the first entry to the last exit.
            [middle, end(-half_length), end(half_length)].into_iter().flatten().reduce(|one, other| {
                let first = if other.enter < one.enter { other } else { one };
                Interval { leave: one.leave.max(other.leave), ..first }
            })
        }
    }
}

fn interval_of_rectangle(origin: DVec2, direction: DVec2, half: DVec2) -> Option<Interval> {
    let (x_enter, x_leave) = slab(-half.x, half.x, origin.x, direction.x)?;
    let (y_enter, y_leave) = slab(-half.y, half.y, origin.y, direction.y)?;
    let normal = if x_enter > y_enter {
        DVec3::new(-direction.x.signum(), 0.0, 0.0)
    } else {
        DVec3::new(0.0, -direction.y.signum(), 0.0)
    };
    let (enter, leave) = (x_enter.max(y_enter), x_leave.min(y_leave));
    (enter <= leave).then_some(Interval { enter, leave, normal, curvature: 0.0 })
}

fn interval_of_disc(origin: DVec2, direction: DVec2, centre: DVec2, radius: f64) -> Option<Interval> {
    let offset = centre - origin;
    let horizontal_length = direction.length();
    if horizontal_length == 0.0 {
        let unbounded = Interval { enter: f64::NEG_INFINITY, leave: f64::INFINITY, normal: DVec3::Z, curvature: 0.0 };
        return (offset.length_squared() <= radius * radius).then_some(unbounded);
    }
    let (along, half_chord) = chord(offset.extend(0.0), (direction / horizontal_length).extend(0.0), radius)?;
    let enter = along - half_chord;
    let normal = (direction / horizontal_length * enter - offset) / radius;
    Some(Interval {
        enter: enter / horizontal_length,
        leave: (along + half_chord) / horizontal_length,
        normal: normal.extend(0.0).normalize_or_zero(),
        curvature: 1.0 / radius,
    })
}

/// Distance along a line to the point nearest to a sphere's centre, and half the length of the line's chord in the
/// sphere. `offset` is the vector from the line's origin to the centre. `None` if the line misses the sphere.
fn chord(offset: DVec3, direction: DVec3, radius: f64) -> Option<(f64, f64)> {
    let along = offset.dot(direction);
    // Computed from the point of the line that is nearest to the centre; this preserves precision for a distant sphere.
    let distance_squared = (offset - direction * along).length_squared();
    let half_chord_squared = radius * radius - distance_squared;
    (half_chord_squared >= 0.0).then(|| (along, half_chord_squared.sqrt()))
}

fn cast_mesh(mesh: &MeshIndex, origin: DVec3, direction: DVec3, range: f64) -> Option<SurfaceHit> {
    let hit = mesh.cast(origin, direction, range)?;
    Some(SurfaceHit { distance: hit.distance, normal: hit.normal, curvature: DVec2::ZERO })
}

fn cast_capsule(origin: DVec3, direction: DVec3, ends: [DVec3; 2], radius: f64) -> Option<SurfaceHit> {
    if (origin - nearest_on_segment(origin, ends)).length_squared() <= radius * radius {
        return Some(hit_from_inside(direction));
    }
    let end_hit = |centre: DVec3| {
        let (along, half_chord) = chord(centre - origin, direction, radius)?;
        let distance = along - half_chord;
        let normal = (origin + direction * distance - centre).normalize_or_zero();
        (along > 0.0).then_some(SurfaceHit { distance, normal, curvature: DVec2::splat(1.0 / radius) })
    };
    let side_hit = || {
        let segment = ends[1] - ends[0];
        let length = segment.length();
        if length == 0.0 {
            return None;
        }
        let axis = segment / length;
        let perpendicular = direction - axis * axis.dot(direction);
        let perpendicular_length = perpendicular.length();
        if perpendicular_length == 0.0 {
            return None;
        }
        let offset = ends[0] - origin;
        let perpendicular_offset = offset - axis * axis.dot(offset);
        let (along, half_chord) = chord(perpendicular_offset, perpendicular / perpendicular_length, radius)?;
        let distance = (along - half_chord) / perpendicular_length;
        let point = origin + direction * distance;
        let height = axis.dot(point - ends[0]);
        let is_hit = distance >= 0.0 && (0.0..=length).contains(&height);
        let normal = (point - ends[0] - axis * height).normalize_or_zero();
        is_hit.then_some(SurfaceHit { distance, normal, curvature: DVec2::new(1.0 / radius, 0.0) })
    };
    // The origin is outside, so the nearest hit on a part is the first hit on the capsule.
    let hit = [end_hit(ends[0]), end_hit(ends[1]), side_hit()].into_iter().flatten();
    hit.min_by(|one, other| one.distance.total_cmp(&other.distance))
        .map(|hit| SurfaceHit { distance: hit.distance.max(0.0), ..hit })
}

fn nearest_on_segment(point: DVec3, ends: [DVec3; 2]) -> DVec3 {
    let segment = ends[1] - ends[0];
    let length_squared = segment.length_squared();
    if length_squared == 0.0 {
        return ends[0];
    }
    ends[0] + segment * ((point - ends[0]).dot(segment) / length_squared).clamp(0.0, 1.0)
}
