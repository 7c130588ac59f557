//! Contacts of the legs of a robot, and their clearance from the ground.

use glam::DVec3;

use super::{World, near::Geometry};
use crate::{
    RobotId,
    contact::Thing,
    drive::{Motion, legged::BodyPart},
    scene::{Bounds, Capsule},
    sort::sort_few,
    time::Time,
};

/// Number of steps of the ternary search for the point of a segment that is nearest to a convex body. Each step reduces
/// the interval to two thirds, so the final interval of a segment of up to 2 m is shorter than 10^-12 m.
const MAX_SEARCH_STEPS: u32 = 70;

/// A part of a legged robot in contact with an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegContact {
    /// The part.
    pub part: BodyPart,
    /// The obstacle; the ground is [`Thing::Floor`].
    pub thing: Thing,
    /// Point of contact on the obstacle, in the world frame, m; for the ground, a point vertically above or below the
    /// axis of the part. For the body on the ground, this point has the height of the highest ground under the body.
    pub point: DVec3,
}

/// Contacts and ground clearance of a legged robot.
#[derive(Clone, Debug, PartialEq)]
pub struct LegClearance {
    /// Contacts of the parts, in the order of parts, then of obstacles.
    pub contacts: Vec<LegContact>,
    /// Minimum distance of thighs, shanks and body from the ground, m; negative if a part is below the ground, and at
    /// most the requested bound.
    pub clearance: f64,
}

impl World {
    /// Contacts of thighs, shanks and body of a legged robot at `at`, and their clearance from the ground, at most
    /// `max_clearance` metres. `None` for a robot without legs. If `max_clearance` is 0, the function searches only for
    /// contacts, which is fastest.
    ///
    /// The body, the thighs and the shanks are tested for contacts with the ground. The lowest part of a shank, three
    /// radii long, is not tested, so that a leg can lean by up to 70 degrees while its foot is on the ground. Feet are
    /// not tested. Thighs and shanks are tested for contacts with other obstacles on their whole length. The body's
    /// contacts with other obstacles are reported as they are for any robot. Our choice.
    ///
    /// For contacts with the ground, the body is a disc at the height of its underside. A cell of the ground that the
    /// edge of the disc crosses is tested as a whole. The clearance of a limb is exact, except beyond a terrain's
    /// border, see [`HeightField::clearance`](crate::scene::HeightField::clearance).
    pub fn leg_clearance(&self, motion: &mut Motion, at: Time, max_clearance: f64) -> Option<LegClearance> {
        motion.legs()?;
        let robot = motion.id();
        let world_from_robot = motion.pose(at);
        let stance = motion.stance(at);
        let radius = motion.radius();
        let (legs, ground) = (motion.legs()?, motion.ground()?);
        let mut contacts = Vec::new();
        let mut clearance = max_clearance;
        let underside = world_from_robot.position.extend(stance.lift + legs.underside);
        let (_, highest) = ground.height_bounds_in(underside.truncate(), radius);
        clearance = clearance.min(underside.z - highest);
        if underside.z <= highest {
            contacts.push(LegContact { part: BodyPart::Body, thing: Thing::Floor, point: underside.with_z(highest) });
        }
        for limb in legs.limbs(&stance, &world_from_robot) {
            let Capsule { ends: [upper, lower], radius } = limb.capsule;
            let axis = lower - upper;
            let tested_fraction = 1.0 - (limb.ground_margin / axis.length()).min(1.0);
            let tested_segment = [upper, upper + tested_fraction * axis];
            let distance = ground.clearance(tested_segment, max_clearance + radius) - radius;
            clearance = clearance.min(distance);
            // If no ground is near, `distance` is at least `max_clearance`, so it is not negative.
            if distance < 0.0 {
                let (_, point) = ground.min_height_above(tested_segment);
                let point = point.with_z(ground.height(point.truncate()));
                contacts.push(LegContact { part: limb.part, thing: Thing::Floor, point });
            }
            let things = self.capsule_contacts(robot, &limb.capsule, at);
            contacts.extend(things.into_iter().map(|(thing, point)| LegContact { part: limb.part, thing, point }));
        }
        sort_few(&mut contacts, |contact| (contact.part, contact.thing));
        Some(LegClearance { contacts, clearance })
    }

    /// Obstacles in contact at `at` with a capsule that is a part of `robot`: walls up to their heights, fixed bodies,
    /// the bodies of other robots and movable objects, by their published motion. Each obstacle is listed once, with a
    /// point of contact, in the order of [`Thing`]; the ground is excluded.
    ///
    /// Exact to 10^-9 m for walls, boxes, cylinders, spheres and capsules. A mesh is in contact if the axis of the
    /// capsule crosses its surface.
    pub fn capsule_contacts(&self, robot: RobotId, capsule: &Capsule, at: Time) -> Vec<(Thing, DVec3)> {
        let Capsule { ends: [from, to], radius } = *capsule;
        let bounds = Bounds::of_points([from.truncate(), to.truncate()]).grown(radius);
        let mut things = Vec::new();
        self.for_each_geometry(robot, bounds, at, |thing, geometry| {
            // If there is no floor, the first fixed body is the ground.
            let is_ground = thing == Thing::Fixed(0) && self.indexed_space.space.floor.is_none();
            if !is_ground {
                things.extend(geometry_contact(geometry, capsule).map(|point| (thing, point)));
            }
        });
        sort_few(&mut things, |(thing, _)| *thing);
        things.dedup_by_key(|(thing, _)| *thing);
        things
    }
}

/// A point of the geometry in the capsule; `None` if there is no such point.
fn geometry_contact(geometry: &Geometry<'_>, capsule: &Capsule) -> Option<DVec3> {
    // Every call visits the parts in the same order, so their number identifies them.
    let mut count = 0;
    geometry.for_each_nearest(capsule.ends[0], |_| count += 1);
    let part_contact = |part: usize| {
        convex_contact(capsule, |point| {
            let (mut number, mut found) = (0, point);
            geometry.for_each_nearest(point, |nearest| {
                if number == part {
                    found = nearest;
                }
                number += 1;
            });
            found
        })
    };
    (0..count).find_map(part_contact).or_else(|| {
        let Geometry::Body(pose, figure) = geometry else { return None };
        let axis = capsule.ends[1] - capsule.ends[0];
        let direction = axis.try_normalize().filter(|_| figure.has_mesh())?;
        let hit = figure.cast_meshes(pose, capsule.ends[0], direction, axis.length())?;
        Some(capsule.ends[0] + hit.distance * direction)
    })
}

/// A point of a convex body in the capsule; `None` if there is no such point. `nearest` maps a point to the nearest
/// point of the body. The distance from a convex body is a convex function along a segment, so a ternary search finds
/// its minimum.
fn convex_contact(capsule: &Capsule, nearest: impl Fn(DVec3) -> DVec3) -> Option<DVec3> {
    let Capsule { ends: [from, to], radius } = *capsule;
    let length = from.distance(to);
    let distance = |fraction: f64| {
        let point = from.lerp(to, fraction);
        nearest(point).distance(point)
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..MAX_SEARCH_STEPS {
        let [first, second] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        let [first_distance, second_distance] = [first, second].map(distance);
        let is_first_nearer = first_distance < second_distance;
        let (min_distance, fraction) =
            if is_first_nearer { (first_distance, first) } else { (second_distance, second) };
        if min_distance <= radius {
            return Some(nearest(from.lerp(to, fraction)));
        }
        // Between two points, the distance changes by at most their separation. So no point of the interval is near
        // enough.
        if min_distance - (high - low) * length > radius {
            return None;
        }
        if is_first_nearer {
            high = second;
        } else {
            low = first;
        }
    }
    None
}

#[cfg(test)]
mod tests;
