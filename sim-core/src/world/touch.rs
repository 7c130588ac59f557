//! What the parts of a robot's legs touch.

use glam::DVec3;

use super::{Seen, World};
use crate::{
    RobotId,
    object::Figure,
    pose::Pose,
    scene::{Bounds, Capsule},
    time::Time,
};

/// Rounds of the search for the place of a stretch that is nearest to a convex body: each leaves two thirds, so that of
/// stretches of some metres all but 10^-12 m is gone.
const ROUNDS: u32 = 70;

impl World {
    /// What a capsule, part of robot `by`, touches at `at`, in the order of [`Seen`] and each once: walls up to their heights, fixed
    /// bodies, the bodies of other robots, movable objects, by their public trajectories. The ground is not among them.
    ///
    /// Exact to 10^-9 m for walls, boxes, cylinders, spheres and capsules; bodies that are meshes count where the capsule's
    /// axis goes through their surface.
    pub fn touched(&self, by: RobotId, capsule: &Capsule, at: Time) -> Vec<Seen> {
        let Capsule { ends: [from, to], radius } = *capsule;
        let near = Bounds::of_points([from.truncate(), to.truncate()]).grown(radius);
        let mut things = Vec::new();
        self.walls.for_each_in(near, |wall, segment| {
            let height = self.walls.height(wall);
            let nearest = |point: DVec3| segment.nearest_point(point.truncate()).extend(point.z.clamp(0.0, height));
            if self.stage.is_wall(wall) && is_within(capsule, nearest) {
                things.push(Seen::Wall(wall));
            }
        });
        self.stage.blocks.for_each_in(near, |RobotId(number)| {
            let block = &self.stage.space.blocks[number as usize - 1];
            if figure_touches(&block.figure, &block.world_from_block, capsule) {
                things.push(Seen::Wall(block.wall));
            }
        });
        self.stage.fixed.for_each_in(near, |RobotId(number)| {
            // Without a floor the first of them is the ground.
            let is_ground = number == 1 && self.stage.space.floor.is_none();
            let (pose, figure) = &self.stage.space.fixed[number as usize - 1];
            if !is_ground && figure_touches(figure, pose, capsule) {
                things.push(Seen::Fixed(number - 1));
            }
        });
        self.for_each_near(near, at, |robot| {
            let (pose, figure) = self.robot_figure(robot, at);
            if robot != by && figure_touches(&figure, &pose, capsule) {
                things.push(Seen::Robot(robot));
            }
        });
        if let Some(objects) = &self.objects {
            objects.for_each_in(near, at, |object| {
                if figure_touches(&self.object_figure(object), &objects.pose(object, at), capsule) {
                    things.push(Seen::Object(object));
                }
            });
        }
        things.sort_unstable();
        things.dedup();
        things
    }
}

/// Whether a body of this shape at `world_from_body` comes as near to the capsule's axis as its radius.
fn figure_touches(figure: &Figure, world_from_body: &Pose, capsule: &Capsule) -> bool {
    let mut touches = false;
    // The parts of a figure are always visited in the same order.
    let mut count = 0;
    figure.for_each_nearest(world_from_body, capsule.ends[0], |_| count += 1);
    for part in 0..count {
        touches |= is_within(capsule, |point| {
            let (mut number, mut found) = (0, point);
            figure.for_each_nearest(world_from_body, point, |nearest| {
                if number == part {
                    found = nearest;
                }
                number += 1;
            });
            found
        });
    }
    let way = capsule.ends[1] - capsule.ends[0];
    touches
        || figure.has_mesh()
            && way.try_normalize().is_some_and(|direction| {
                figure.cast_meshes(world_from_body, capsule.ends[0], direction, way.length()).is_some()
            })
}

/// Whether a convex body comes as near to the capsule's axis as its radius; `nearest` is the body's point that is nearest to
/// another one. The distance of a convex body is convex along a stretch, so thirds of it can be left out.
fn is_within(capsule: &Capsule, nearest: impl Fn(DVec3) -> DVec3) -> bool {
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
        let least = before.min(after);
        // From one place to another the distance changes no more than the place does.
        if least <= radius || least - (high - low) * length > radius {
            return least <= radius;
        }
        if before < after {
            high = second;
        } else {
            low = first;
        }
    }
    false
}

#[cfg(test)]
mod tests;
