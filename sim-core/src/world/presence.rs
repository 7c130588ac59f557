//! Bodies that come into a running world, and bodies that leave it.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec2;

use super::{Calm, World, objects::Objects, track::Track};
use crate::{
    ObjectId, RobotId,
    contact::{TOUCH, Thing},
    drive::Motion,
    object::{Figure, Properties},
    pose::{PlaceError, Pose},
    scene::{Bounds, WallId},
    time::Time,
};

/// When a body is in the world: from `since` on, before `until`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Presence {
    /// Its first instant.
    pub since: Time,
    /// The first instant without it; [`Time::NEVER`] as long as it is there.
    pub until: Time,
}

impl Presence {
    /// That of a body which was there at the start and has not left.
    pub const ALWAYS: Self = Self::since(Time(i64::MIN));

    /// That of a body which has not left.
    pub const fn since(since: Time) -> Self {
        Self { since, until: Time::NEVER }
    }

    /// Whether the body is there at `at`.
    pub fn holds(&self, at: Time) -> bool {
        self.since <= at && at < self.until
    }
}

/// Bodies come and leave between two slots, at the start of the present one. Who is asked about an instant before it answers as
/// the world was then. Numbers are never used again.
impl World {
    /// One more robot from the start of the present slot on, at which its motion [starts](Motion::starting_at), with this shape for
    /// rays in space (by default an upright cylinder as high as it takes).
    ///
    /// # Panics
    /// If its id is not the next one.
    pub fn add_robot(&mut self, motion: &mut Motion, figure: Option<Arc<Figure>>) {
        assert_eq!(motion.id().index(), self.tracks.len(), "ids of robots go on after the last");
        if let Some(figure) = figure {
            Arc::make_mut(&mut self.stage).add_robot(figure, self.tracks.iter().map(Track::radius));
        }
        let (now, end) = (self.now, self.slot_end());
        self.tracks.push(Track::new(motion, Presence::since(now), (now, end)));
        self.hold(motion, now);
        self.calm = Calm::default();
        self.refresh_index();
    }

    /// Takes the body of a robot out of the world, from the start of the present slot on. Its motion
    /// is not to be given to [`World::advance`] again.
    ///
    /// # Panics
    /// If there is no such robot.
    pub fn remove_robot(&mut self, robot: RobotId) {
        let track = &mut self.tracks[robot.index()];
        if track.presence.until < Time::NEVER {
            return;
        }
        track.end(self.now);
        if let Some(objects) = &mut self.objects {
            objects.remove_robot(robot);
        }
        self.calm = Calm::default();
        self.refresh_index();
    }

    /// One more movable object at `world_from_object` from the start of the present slot on, at rest and awake, with this shape for
    /// rays in space (by default its footprint, as high as it takes). Any place will do: in a wall or a body it is pushed out.
    ///
    /// # Errors
    /// [`PlaceError`] for a position that is not finite or beyond 10^9 m.
    ///
    /// # Panics
    /// In a build without the feature `objects`.
    pub fn add_object(
        &mut self,
        properties: Arc<Properties>,
        world_from_object: Pose,
        figure: Option<Arc<Figure>>,
    ) -> Result<ObjectId, PlaceError> {
        world_from_object.check_place()?;
        let (walls, now, end) = (&self.walls, self.now, self.slot_end());
        let objects = self.objects.get_or_insert_with(|| Box::new(Objects::new(walls, [])));
        if let Some(figure) = figure {
            let known = (0..objects.len()).map(|index| objects.properties(ObjectId::from_index(index)));
            Arc::make_mut(&mut self.stage).add_object(figure, known);
        }
        objects.skip_to(now);
        let object = objects.add(properties, world_from_object, now);
        objects.publish(now, end);
        self.calm = Calm::default();
        Ok(object)
    }

    /// Takes a movable object out of the world, from the start of the present slot on.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn remove_object(&mut self, object: ObjectId) {
        let now = self.now;
        self.objects.as_mut().expect("the scene has this object").remove(object, now);
    }

    /// Number of robots, those that are gone included.
    pub fn robot_count(&self) -> usize {
        self.tracks.len()
    }

    /// When a robot is in the world.
    ///
    /// # Panics
    /// If there never was such a robot.
    pub fn robot_presence(&self, robot: RobotId) -> Presence {
        self.tracks[robot.index()].presence
    }

    /// When a movable object is in the world.
    ///
    /// # Panics
    /// If there never was such an object.
    pub fn object_presence(&self, object: ObjectId) -> Presence {
        self.objects().presence(object)
    }

    /// Whether there is a robot of this number at `at`.
    pub fn is_robot_there(&self, robot: RobotId, at: Time) -> bool {
        self.tracks.get(robot.index()).is_some_and(|track| track.presence.holds(at))
    }

    /// Whether there is a movable object of this number at `at`.
    pub fn is_object_there(&self, object: ObjectId, at: Time) -> bool {
        object.index() < self.object_count() && self.object_presence(object).holds(at)
    }

    /// What a body of this radius in metres around `centre` would overlap at the start of the present slot: a wall or a fixed body,
    /// of which it may be wholly inside, a robot or a movable object. What it only touches does not count.
    pub fn overlapped(&self, centre: DVec2, radius: f64) -> Option<Thing> {
        let inner = (radius - TOUCH).max(0.0);
        let mut wall = self.surrounding(centre);
        self.walls.for_each_in(Bounds::of_disc(centre, inner), |id, segment| {
            if wall.is_none() && (segment.nearest_point(centre) - centre).length() < inner {
                wall = Some(id);
            }
        });
        let robots = (0..self.tracks.len()).map(RobotId::from_index);
        let robot = || {
            let mut there = robots.filter(|robot| self.is_robot_there(*robot, self.now));
            there.find(|robot| {
                let body = self.body(*robot, self.now);
                (body.centre - centre).length() < body.radius + inner
            })
        };
        let object = || self.objects.as_ref()?.first_within(centre, inner);
        wall.map(Thing::Wall).or_else(|| robot().map(Thing::Robot)).or_else(|| object().map(Thing::Object))
    }

    /// A side of the thick wall or the fixed body that `point` lies in.
    fn surrounding(&self, point: DVec2) -> Option<WallId> {
        let space = &self.stage.space;
        let blocks = space.blocks.iter().map(|block| block.wall.0..block.wall.0 + 4);
        let outlines = space.outlines.map(|first| first.0..self.walls.len() as u32);
        blocks.chain(outlines).find(|walls| self.winds_around(walls.clone(), point)).map(|walls| WallId(walls.start))
    }

    /// Whether closed outlines, all of one sense, wind around `point`.
    fn winds_around(&self, walls: Range<u32>, point: DVec2) -> bool {
        let turn = |wall| {
            let segment = self.walls.segment(WallId(wall));
            let (a, b) = (segment.a - point, segment.b - point);
            match (a.y <= 0.0, b.y <= 0.0) {
                (true, false) if a.perp_dot(b) > 0.0 => 1,
                (false, true) if a.perp_dot(b) < 0.0 => -1,
                _ => 0,
            }
        };
        walls.map(turn).sum::<i32>() != 0
    }
}
