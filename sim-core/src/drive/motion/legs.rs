//! Commands and queries of the legs of a walking robot.

use std::sync::Arc;

use super::{Motion, Stage};
use crate::{
    drive::legged::{Footfall, LegCommand, LegCommandError, Legs, MotionPiece, Plan, Stance, Walk},
    scene::Ground,
    time::Time,
};

impl Motion {
    /// Returns true if the height of the robot's frame above the floor can change: for legs and hulls.
    pub fn has_variable_height(&self) -> bool {
        self.walk.is_some() || self.vehicle.hull.is_some()
    }

    /// Adds `legs` that walk on `ground` to this motion, which must have no command yet.
    pub fn with_legs(mut self, legs: Arc<Legs>, ground: Arc<Ground>) -> Self {
        self.walk = Some(Box::new(Walk::new(legs, ground)));
        self
    }

    /// The robot's legs, if it has any.
    pub fn legs(&self) -> Option<&Legs> {
        self.walk.as_ref().map(|walk| walk.legs())
    }

    /// The ground under the robot's feet; `None` for a robot without legs.
    pub fn ground(&self) -> Option<&Ground> {
        self.walk.as_ref().map(|walk| walk.ground())
    }

    /// Index of the gait in force at `at`; 0 without legs.
    pub fn gait(&self, at: Time) -> usize {
        self.walk.as_ref().map_or(0, |walk| walk.settings_at(at).gait)
    }

    /// Applies a leg command at `at`, which must not precede the last leg command.
    ///
    /// # Errors
    /// A [`LegCommandError`] for a command that these legs cannot carry out; nothing changes then.
    pub fn command_legs(&mut self, at: Time, command: LegCommand) -> Result<(), LegCommandError> {
        let walk = self.walk.as_mut().ok_or(LegCommandError::NoLegs)?;
        walk.command(at, command)
    }

    /// Feet, joints and height of the robot's frame at `at`. A robot without legs has no feet and joints; its height is
    /// 0, except for a hull in the water.
    pub fn stance(&mut self, at: Time) -> Stance {
        let Some(mut walk) = self.walk.take() else {
            let is_hull = self.hull().is_some();
            return Stance { lift: if is_hull { self.stage_at(at).hull_height(at) } else { 0.0 }, ..Stance::default() };
        };
        let world_from_robot = self.pose(at);
        let stance = walk.stance(self, at, &world_from_robot);
        self.walk = Some(walk);
        stance
    }

    /// Height of the robot's frame above the plane z = 0 at `at`, m; 0 for a robot that has neither legs nor a hull.
    pub fn lift(&mut self, at: Time) -> f64 {
        if self.has_variable_height() { self.stance(at).lift } else { 0.0 }
    }

    /// Depth of the top of a hull under the surface of the water at `at`, m. It is 0 for a hull at the surface, and
    /// `None` for robots that are not in the water.
    pub fn depth(&mut self, at: Time) -> Option<f64> {
        let ceiling = self.hull()?.ceiling;
        Some(ceiling - self.lift(at))
    }

    /// The footfalls before `until` that no earlier call has returned, in the order of time, then of the legs.
    pub fn take_footfalls(&mut self, until: Time) -> Vec<Footfall> {
        let Some(mut walk) = self.walk.take() else { return Vec::new() };
        let footfalls = walk.take_footfalls(self, until);
        self.walk = Some(walk);
        footfalls
    }
}

impl Plan for Motion {
    fn revision(&self) -> u64 {
        Motion::revision(self)
    }

    fn pieces(&mut self, from: Time, to: Time) -> Vec<MotionPiece> {
        let last = self.index_at(to);
        let first = self.stages.iter().rposition(|stage| stage.piece.start <= from).unwrap_or(0).min(last);
        for index in first..last {
            let until = self.stages[index + 1].piece.start;
            let stage = &mut self.stages[index];
            stage.explore(&self.vehicle, &self.walls, (until - stage.piece.start).seconds());
        }
        let axis_offset = self.vehicle.model.axis_offset;
        let piece = |stage: &Stage| MotionPiece { piece: stage.piece, axis_offset, is_placed: stage.is_placed };
        self.stages.range(first..=last).map(piece).collect()
    }
}
