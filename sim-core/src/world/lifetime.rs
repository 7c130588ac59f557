//! Addition and removal of bodies in a running world.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec2;

use super::{Quiescence, World, objects::Objects, track::Track};
use crate::{
    ObjectId, RobotId,
    contact::{TOUCH, Thing},
    drive::Motion,
    object::{Figure, Properties},
    pose::{PlacementError, Pose},
    scene::{Bounds, WallId},
    time::Time,
};

/// Time for which a body is in the world: from `since`, inclusive, to `until`, exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lifetime {
    /// First instant of the body.
    pub since: Time,
    /// First instant without the body; [`Time::NEVER`] while it is present.
    pub until: Time,
}

impl Lifetime {
    /// Lifetime of a body that was present at the start and has not been removed.
    pub const ALWAYS: Self = Self::since(Time(i64::MIN));

    /// Lifetime of a body that has not been removed.
    pub const fn since(since: Time) -> Self {
        Self { since, until: Time::NEVER }
    }

    /// Returns true if the body is present at `at`.
    pub fn contains(&self, at: Time) -> bool {
        self.since <= at && at < self.until
    }
}

/// Bodies are added and removed between two slots, at the start of the present slot. Queries about earlier instants
/// return the world as it was at that instant. Ids are never reused.
impl World {
    /// Adds a robot from the start of the present slot on; its motion must [start](Motion::starting_at) at that time.
    /// `figure` is its shape for three-dimensional rays (default: an upright cylinder of unlimited height).
    ///
    /// # Panics
    /// If the robot's id is not the next one.
    pub fn add_robot(&mut self, motion: &mut Motion, figure: Option<Arc<Figure>>) {
        assert_eq!(motion.id().index(), self.tracks.len(), "the id is the next one");
        if let Some(figure) = figure {
            Arc::make_mut(&mut self.indexed_space).add_robot(figure, self.tracks.iter().map(Track::radius));
        }
        let (now, end) = (self.now, self.slot_end());
        self.tracks.push(Track::new(motion, Lifetime::since(now), (now, end)));
        self.publish_stance(motion, now);
        self.quiescence = Quiescence::default();
        self.refresh_index();
    }

    /// Removes the body of a robot from the start of the present slot on. Its motion must not be passed to
    /// [`World::advance`] again.
    ///
    /// # Panics
    /// If the robot does not exist.
    pub fn remove_robot(&mut self, robot: RobotId) {
        let track = &mut self.tracks[robot.index()];
        if track.lifetime.until < Time::NEVER {
            return;
        }
        track.end(self.now);
        self.are_resting[robot.index()] = false;
        if let Some(objects) = &mut self.objects {
            objects.remove_robot(robot);
        }
        self.quiescence = Quiescence::default();
        self.refresh_index();
    }

    /// Adds a movable object at `world_from_object` from the start of the present slot on, at rest and awake. `figure`
    /// is its shape for three-dimensional rays (default: its footprint, unlimited in height). Any pose is allowed: an
    /// object inside a wall or a body is pushed out.
    ///
    /// # Errors
    /// [`PlacementError`] for a position that is not finite or beyond 10^9 m.
    ///
    /// # Panics
    /// In a build without the feature `objects`.
    pub fn add_object(
        &mut self,
        properties: Arc<Properties>,
        world_from_object: Pose,
        figure: Option<Arc<Figure>>,
    ) -> Result<ObjectId, PlacementError> {
        world_from_object.check_placement()?;
        let (walls, now, end) = (&self.walls, self.now, self.slot_end());
        let objects = self.objects.get_or_insert_with(|| Box::new(Objects::new(walls, [])));
        if let Some(figure) = figure {
            let all_properties = (0..objects.len()).map(|index| objects.properties(ObjectId::from_index(index)));
            Arc::make_mut(&mut self.indexed_space).add_object(figure, all_properties);
        }
        objects.skip_to(now);
        let object = objects.add(properties, world_from_object, now);
        objects.publish(now, end);
        self.quiescence = Quiescence::default();
        // If there was only one robot and no object, the robot may not be in the index yet.
        self.refresh_index();
        Ok(object)
    }

    /// Removes a movable object from the start of the present slot on.
    ///
    /// # Panics
    /// If the object does not exist.
    pub fn remove_object(&mut self, object: ObjectId) {
        let now = self.now;
        self.objects.as_mut().expect("the scene has this object").remove(object, now);
    }

    /// Number of robots, including removed ones.
    pub fn robot_count(&self) -> usize {
        self.tracks.len()
    }

    /// Lifetime of a robot in the world.
    ///
    /// # Panics
    /// If the robot never existed.
    pub fn robot_lifetime(&self, robot: RobotId) -> Lifetime {
        self.tracks[robot.index()].lifetime
    }

    /// Lifetime of a movable object in the world.
    ///
    /// # Panics
    /// If the object never existed.
    pub fn object_lifetime(&self, object: ObjectId) -> Lifetime {
        self.objects().lifetime(object)
    }

    /// Returns true if a robot with this id is present at `at`.
    pub fn is_robot_present(&self, robot: RobotId, at: Time) -> bool {
        self.tracks.get(robot.index()).is_some_and(|track| track.lifetime.contains(at))
    }

    /// Returns true if a movable object with this id is present at `at`.
    pub fn is_object_present(&self, object: ObjectId, at: Time) -> bool {
        object.index() < self.object_count() && self.object_lifetime(object).contains(at)
    }

    /// An obstacle that a disc of `radius` metres around `centre` would overlap at the start of the present slot. If
    /// there are several, the result is the first one in this order: a wall or fixed body (also if the disc is
    /// completely inside it), a robot, a movable object. A touching obstacle does not overlap the disc.
    pub fn overlapped_by_disc(&self, centre: DVec2, radius: f64) -> Option<Thing> {
        let overlap_radius = (radius - TOUCH).max(0.0);
        let mut wall = self.surrounding_wall(centre);
        self.walls.for_each_in(Bounds::of_disc(centre, overlap_radius), |id, segment| {
            if wall.is_none() && (segment.nearest_point(centre) - centre).length() < overlap_radius {
                wall = Some(id);
            }
        });
        let robots = (0..self.tracks.len()).map(RobotId::from_index);
        let robot = || {
            let mut present = robots.filter(|robot| self.is_robot_present(*robot, self.now));
            present.find(|robot| {
                let body = self.body(*robot, self.now);
                (body.centre - centre).length() < body.radius + overlap_radius
            })
        };
        let object = || self.objects.as_ref()?.first_within(centre, overlap_radius);
        wall.map(Thing::Wall).or_else(|| robot().map(Thing::Robot)).or_else(|| object().map(Thing::Object))
    }

    /// The first side of the thick wall that contains `point`. If there is none but a fixed body contains `point`, the
    /// first wall of the outlines of all fixed bodies; otherwise `None`.
    fn surrounding_wall(&self, point: DVec2) -> Option<WallId> {
        let space = &self.indexed_space.space;
        let thick_walls = space.thick_walls.iter().map(|block| block.wall.0..block.wall.0 + 4);
        let outlines = space.outlines.map(|first| first.0..self.walls.len() as u32);
        thick_walls.chain(outlines).find(|walls| self.encloses(walls.clone(), point)).map(|walls| WallId(walls.start))
    }

    /// Returns true if `point` has a winding number other than 0 with respect to `walls`, closed outlines of the same
    /// orientation.
    fn encloses(&self, walls: Range<u32>, point: DVec2) -> bool {
        let winding = |wall| {
            let segment = self.walls.segment(WallId(wall));
            let (a, b) = (segment.a - point, segment.b - point);
            match (a.y <= 0.0, b.y <= 0.0) {
                (true, false) if a.perp_dot(b) > 0.0 => 1,
                (false, true) if a.perp_dot(b) < 0.0 => -1,
                _ => 0,
            }
        };
        walls.map(winding).sum::<i32>() != 0
    }
}
