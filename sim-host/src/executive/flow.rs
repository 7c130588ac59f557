//! A robot's flow as seen by the calls of its program.

use std::sync::Arc;

use parking_lot::{MappedRwLockReadGuard, MutexGuard};
use robios_sys::{Callback, Stop};
use sim_core::RobotId;
use sim_core::time::Time;
use sim_core::world::World;

use super::run::Run;
use crate::program::site::Site;
use crate::robios::call::Call;
use crate::robios::flow::Flow;
use crate::robios::robot::Robot;

/// Flow of a robot in its run, independent of the executor.
pub(super) struct RobotFlow {
    pub run: Arc<Run>,
    pub id: RobotId,
}

impl Flow for RobotFlow {
    fn id(&self) -> RobotId {
        self.id
    }

    fn robot(&self) -> MutexGuard<'_, Robot> {
        self.run.robot(self.id)
    }

    fn world(&self) -> MappedRwLockReadGuard<'_, World> {
        self.run.world()
    }

    fn cost(&self, call: Call) -> Time {
        self.run.cost(call)
    }

    fn slot_start(&self) -> Time {
        self.run.slot_start()
    }

    fn slot_end(&self) -> Time {
        self.run.slot_end()
    }

    fn suspend(&self, wake: Time) -> Result<(), Stop> {
        self.run.suspend(self.id, wake)
    }

    fn is_exiting(&self) -> bool {
        self.run.is_exiting(self.id)
    }

    fn is_verbose(&self) -> bool {
        self.run.is_verbose(self.id)
    }

    fn enter(&self, call: Call) -> bool {
        self.run.executor().enter(self.id, call)
    }

    fn leave(&self) {
        self.run.executor().leave(self.id);
    }

    fn switch(&self, task: u32) {
        self.run.executor().switch(self.id, task);
    }

    fn start_task(&self, task: u32, code: Callback) -> std::io::Result<()> {
        self.run.start_task(self.id, task, code)
    }

    fn call_back(&self, callback: Callback) -> Result<(), Stop> {
        self.run.executor().call_back(self.id, callback)
    }

    fn call_site(&self) -> Site {
        self.run.call_site(self.id)
    }

    fn waits_of(&self, robot: &Robot) -> String {
        self.run.waits_of(robot)
    }
}
