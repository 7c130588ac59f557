//! What the parts of a robot's legs touch.

use glam::DVec3;

use super::{World, near::Geometry};
use crate::{
    RobotId,
    contact::Thing,
    drive::{Motion, legged::Touching},
    scene::{Bounds, Capsule},
    time::Time,
};

/// Rounds of the search for the place of a stretch that is nearest to a convex body: each leaves two thirds, so that of
/// stretches of some metres all but 10^-12 m is gone.
const ROUNDS: u32 = 70;

/// A part of a legged robot that touches something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegTouch {
    /// The part.
    pub part: Touching,
    /// What it touches; the terrain is [`Thing::Floor`].
    pub thing: Thing,
    /// Where, in the world, m: a point of what is touched, on the ground below the part's axis.
    pub point: DVec3,
}

/// How near a legged robot is to what it should not touch.
#[derive(Clone, Debug, PartialEq)]
pub struct Closeness {
    /// What its parts touch, in the order of parts and things.
    pub touches: Vec<LegTouch>,
    /// Least distance of thighs, shanks and body from the ground, m; negative where one is in it, and at most what was asked for.
    pub clearance: f64,
}

impl World {
    /// What thighs, shanks and body of a legged robot touch at `at`, and their clearance from the ground up to `within` metres;
    /// `None` for a robot without legs. With `within` 0 only what touches is looked for, which is fastest.
    ///
    /// The ground counts for thighs, for the body, and for shanks down to three radii of the limb above their lower ends: there,
    /// a leg may lean by up to 70 degrees, and feet may touch the ground. Feet themselves do not count. All else counts for the
    /// whole of thighs and shanks; what the body meets beside the ground are contacts. Our choice.
    ///
    /// For the ground the body is a disc at the height of its underside, and cells that the disc's edge crosses count as a
    /// whole; a limb is exact, but see [`HeightField::clearance`](crate::scene::HeightField::clearance) for the ground beyond
    /// a terrain's border.
    pub fn closeness(&self, motion: &mut Motion, at: Time, within: f64) -> Option<Closeness> {
        motion.legs()?;
        let by = motion.id();
        let world_from_robot = motion.pose(at);
        let stance = motion.stance(at);
        let radius = motion.radius();
        let (legs, ground) = (motion.legs()?, motion.ground()?);
        let mut touches = Vec::new();
        let mut clearance = within;
        let underside = world_from_robot.position.extend(stance.lift + legs.belly);
        let (_, highest) = ground.range_in(underside.truncate(), radius);
        clearance = clearance.min(underside.z - highest);
        if underside.z <= highest {
            touches.push(LegTouch { part: Touching::Body, thing: Thing::Floor, point: underside.with_z(highest) });
        }
        for limb in legs.limbs(&stance, &world_from_robot) {
            let Capsule { ends: [upper, lower], radius } = limb.capsule;
            let way = lower - upper;
            let counted = 1.0 - (limb.bare / way.length()).min(1.0);
            let piece = [upper, upper + counted * way];
            let distance = ground.clearance(piece, within + radius) - radius;
            clearance = clearance.min(distance);
            // Where nothing is within reach, the distance is the reach.
            if distance < 0.0 {
                let (_, point) = ground.least_gap(piece);
                let point = point.with_z(ground.height(point.truncate()));
                touches.push(LegTouch { part: limb.part, thing: Thing::Floor, point });
            }
            let things = self.touched(by, &limb.capsule, at);
            touches.extend(things.into_iter().map(|(thing, point)| LegTouch { part: limb.part, thing, point }));
        }
        touches.sort_by_key(|touch| (touch.part, touch.thing));
        Some(Closeness { touches, clearance })
    }

    /// What a capsule, part of robot `by`, touches at `at`, and a point of each where it does; in the order of [`Thing`] and each
    /// once: walls up to their heights, fixed bodies, the bodies of other robots, movable objects, by their public
    /// trajectories. The ground is not among them.
    ///
    /// Exact to 10^-9 m for walls, boxes, cylinders, spheres and capsules; bodies that are meshes count where the capsule's
    /// axis goes through their surface.
    pub fn touched(&self, by: RobotId, capsule: &Capsule, at: Time) -> Vec<(Thing, DVec3)> {
        let Capsule { ends: [from, to], radius } = *capsule;
        let near = Bounds::of_points([from.truncate(), to.truncate()]).grown(radius);
        let mut things = Vec::new();
        self.for_each_geometry(by, near, at, |thing, geometry| {
            // Without a floor the first of the fixed bodies is the ground.
            let is_ground = thing == Thing::Fixed(0) && self.stage.space.floor.is_none();
            if !is_ground {
                things.extend(touch_geometry(geometry, capsule).map(|point| (thing, point)));
            }
        });
        things.sort_by_key(|(thing, _)| *thing);
        things.dedup_by_key(|(thing, _)| *thing);
        things
    }
}

/// Where a thing of this geometry comes as near to the capsule's axis as its radius, if it does.
fn touch_geometry(geometry: &Geometry<'_>, capsule: &Capsule) -> Option<DVec3> {
    // The parts are always visited in the same order.
    let mut count = 0;
    geometry.for_each_nearest(capsule.ends[0], |_| count += 1);
    let touch_part = |part: usize| {
        touch_convex(capsule, |point| {
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
    (0..count).find_map(touch_part).or_else(|| {
        let Geometry::Body(pose, figure) = geometry else { return None };
        let way = capsule.ends[1] - capsule.ends[0];
        let direction = way.try_normalize().filter(|_| figure.has_mesh())?;
        let met = figure.cast_meshes(pose, capsule.ends[0], direction, way.length())?;
        Some(capsule.ends[0] + met.distance * direction)
    })
}

/// Where a convex body comes as near to the capsule's axis as its radius, if it does; `nearest` is the body's point that is
/// nearest to another one. The distance of a convex body is convex along a stretch, so thirds of it can be left out.
fn touch_convex(capsule: &Capsule, nearest: impl Fn(DVec3) -> DVec3) -> Option<DVec3> {
    let Capsule { ends: [from, to], radius } = *capsule;
    let length = from.distance(to);
    let distance = |share: f64| {
        let point = from.lerp(to, share);
        nearest(point).distance(point)
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..ROUNDS {
        let [first, second] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        let [before, after] = [first, second].map(distance);
        let (least, share) = if before < after { (before, first) } else { (after, second) };
        if least <= radius {
            return Some(nearest(from.lerp(to, share)));
        }
        // From one place to another the distance changes no more than the place does.
        if least - (high - low) * length > radius {
            return None;
        }
        if before < after {
            high = second;
        } else {
            low = first;
        }
    }
    None
}

#[cfg(test)]
mod tests;
