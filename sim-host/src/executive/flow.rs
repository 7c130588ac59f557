//! A robot's flow as the implementation of the calls uses it, for threads and fibers alike.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use parking_lot::MutexGuard;
use robios_sys::{Callback, Stop};
use sim_core::RobotId;
use sim_core::time::Time;
use sim_core::world::World;

use super::run::{Member, Run};
use super::signal::FlowBlock;
use super::{fiber, program_status};
use crate::program::site::Site;
use crate::robios::call::Call;
use crate::robios::flow::Flow;
use crate::robios::forbidden::Forbidden;
use crate::robios::robot::Robot;

/// Flow of a robot in its run, independent of the executor.
pub(super) struct RobotFlow {
    pub run: Arc<Run>,
    pub member: Arc<Member>,
    pub id: RobotId,
}

impl Flow for RobotFlow {
    fn id(&self) -> RobotId {
        self.id
    }

    #[inline]
    fn robot(&self) -> MutexGuard<'_, Robot> {
        self.member.robot()
    }

    #[inline]
    fn world(&self) -> &World {
        self.run.world_in_slot()
    }

    #[inline]
    fn cost(&self, call: Call) -> Time {
        self.run.cost(call)
    }

    #[inline]
    fn forbidden(&self) -> &Forbidden {
        self.run.forbidden()
    }

    #[inline]
    fn slot_start(&self) -> Time {
        self.run.slot_start()
    }

    #[inline]
    fn slot_end(&self) -> Time {
        self.run.slot_end()
    }

    fn suspend(&self, wake: Time) -> Result<(), Stop> {
        self.run.suspend(self.id, wake)
    }

    #[inline]
    fn run_effect(&self, effect: &mut dyn FnMut()) {
        fiber::run_on_host_stack(effect);
    }

    #[inline]
    fn is_exiting(&self) -> bool {
        self.run.is_stopping() || self.member.is_removed()
    }

    #[inline]
    fn is_verbose(&self) -> bool {
        self.run.is_verbose(&self.member)
    }

    #[inline]
    fn enter(&self, call: Call) -> bool {
        enter(call)
    }

    #[inline]
    fn leave(&self) {
        FlowBlock::current().leave_host();
    }

    fn switch(&self, task: u32) {
        self.run.executor().switch(self.id, task);
    }

    fn start_task(&self, task: u32, code: Callback) -> std::io::Result<()> {
        self.run.start_task(self.id, task, code)
    }

    fn call_back(&self, callback: Callback) -> Result<(), Stop> {
        call_back(callback)
    }

    fn call_site(&self) -> Site {
        self.run.call_site(self.id)
    }

    fn location_of(&self, site: &Site) -> Option<String> {
        self.run.program(self.id)?.location_of(site)
    }

    fn line_of(&self, stack: &[usize]) -> Option<String> {
        program_status::line_of_stack(stack, self.run.program(self.id)?)
    }

    fn note_hint(&self, text: &str, site: &Site) {
        self.location_of(site).into_iter().for_each(|location| self.run.hint_locations.note(self.id, text, location));
    }

    fn waits_of(&self, robot: &Robot) -> String {
        self.run.waits_of(robot)
    }
}

/// Stack that a RoBIOS call may need, in bytes, including the scheduler step; a program with less remaining stack has
/// overflowed it.
const STACK_RESERVE: usize = 128 << 10;

/// Marks the calling flow as inside `call`; returns false if too little of its stack is left for the call.
#[inline]
fn enter(call: Call) -> bool {
    let block = FlowBlock::current();
    if let Some(number) = call.robios_number() {
        block.last_call.store(number, Ordering::Relaxed);
    }
    if block.remaining_stack() < STACK_RESERVE {
        return false;
    }
    block.enter_host();
    true
}

/// Returns true if the calling flow has called a function of RoBIOS.
pub(super) fn has_called() -> bool {
    FlowBlock::current().last_call.load(Ordering::Relaxed) != u16::MAX
}

/// Calls a function of the robot's program from within a call of the calling flow, or at the beginning of a task. The
/// flow holds its robot's run token and no lock.
///
/// # Errors
/// [`Stop`] if the program must exit: the call in progress returns it.
pub(super) fn call_back(callback: Callback) -> Result<(), Stop> {
    let block = FlowBlock::current();
    block.leave_host();
    // SAFETY: the calling flow is in a call of its program, or at the beginning of a task that such a call started; its
    // frames keep the run and thus the program alive.
    let result = unsafe { callback.call() };
    block.enter_host();
    result
}
