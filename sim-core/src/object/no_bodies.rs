//! Placeholder for the rigid bodies in a build without the feature `objects`: an uninhabited type.

use std::convert::Infallible;
use std::sync::Arc;

use glam::DVec2;

use super::{Properties, Push, Pusher, State};
use crate::{ObjectId, RobotId, pose::Pose, scene::Walls, time::Time};

/// Objects of a scene as rigid bodies; cannot be constructed in this build.
#[derive(Clone, Debug)]
pub struct Bodies(Infallible);

#[expect(missing_docs, reason = "documented in the module with the solver")]
impl Bodies {
    /// False, because this build has no rigid bodies: the feature `objects` is off.
    pub const ARE_BUILT: bool = false;

    /// # Panics
    /// Always.
    pub fn new(_: &Walls, _: impl IntoIterator<Item = (Arc<Properties>, Pose)>) -> Self {
        panic!("movable objects need the feature `objects` of sim-core")
    }

    pub fn add(&mut self, _: Arc<Properties>, _: Pose) -> ObjectId {
        match self.0 {}
    }

    pub fn remove(&mut self, _: ObjectId) {
        match self.0 {}
    }

    pub fn remove_robot(&mut self, _: RobotId) {
        match self.0 {}
    }

    pub fn is_removed(&self, _: ObjectId) -> bool {
        match self.0 {}
    }

    pub fn len(&self) -> usize {
        match self.0 {}
    }

    pub fn is_empty(&self) -> bool {
        match self.0 {}
    }

    pub fn properties(&self, _: ObjectId) -> &Arc<Properties> {
        match self.0 {}
    }

    pub fn state(&self, _: ObjectId) -> State {
        match self.0 {}
    }

    pub fn set_velocity(&mut self, _: ObjectId, _: DVec2, _: f64) {
        match self.0 {}
    }

    pub fn place(&mut self, _: ObjectId, _: Pose) {
        match self.0 {}
    }

    pub fn is_asleep(&self, _: ObjectId) -> bool {
        match self.0 {}
    }

    pub fn awake(&self) -> impl Iterator<Item = ObjectId> + '_ {
        std::iter::from_fn(|| match self.0 {})
    }

    pub fn energy(&self) -> f64 {
        match self.0 {}
    }

    pub fn set_step(&mut self, _: Time) {
        match self.0 {}
    }

    pub fn step(&mut self, _: &[Pusher], _: &mut Vec<Push>) {
        match self.0 {}
    }
}
