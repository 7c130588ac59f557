//! Executor that chooses the kind of flow for each robot: fibers for robots whose programs support them, threads for
//! all other robots.

use std::io;
use std::sync::Arc;

use sim_core::RobotId;

use super::Executor;
use super::failure::Failure;
use super::fiber::FiberExecutor;
use super::notifier::Notifier;
use super::process::Child;
use super::program::RobotProgram;
use super::run::Member;
use super::shared_loop::Job;
use super::thread::ThreadExecutor;

/// Executor that forwards each call to the executor for the robot's kind of flow.
pub struct MixedExecutor {
    threads: ThreadExecutor,
    fibers: FiberExecutor,
    /// For each robot, true if its flows are fibers.
    are_fibers: boxcar::Vec<bool>,
}

impl MixedExecutor {
    /// Creates an executor for `count` robots, with ids from 1, on `workers` workers; `flows` is the number of flows
    /// that will be started.
    pub fn new(count: usize, flows: usize, workers: usize) -> Self {
        Self {
            threads: ThreadExecutor::new(count, flows, workers),
            fibers: FiberExecutor::new(workers),
            are_fibers: boxcar::Vec::new(),
        }
    }

    /// The executor of the robot's flows.
    fn executor_of(&self, robot: RobotId) -> &dyn Executor {
        if self.are_fibers.get(robot.index()).is_some_and(|is_fiber| *is_fiber) { &self.fibers } else { &self.threads }
    }
}

impl Executor for MixedExecutor {
    fn begin(&self, notifier: &Arc<Notifier>) {
        self.threads.begin(notifier);
        self.fibers.begin(notifier);
    }

    fn end(&self, has_departed: &dyn Fn(RobotId) -> bool) -> bool {
        let are_complete = [self.threads.end(has_departed), self.fibers.end(has_departed)];
        are_complete == [true, true]
    }

    fn must_end(&self) -> bool {
        self.threads.must_end() || self.fibers.must_end()
    }

    fn admit(&self, robot: RobotId, program: &RobotProgram, member: Option<&Arc<Member>>) {
        while self.are_fibers.count() < robot.index() {
            self.are_fibers.push(false);
        }
        if self.are_fibers.count() == robot.index() {
            self.are_fibers.push(program.is_fiber());
        }
        self.executor_of(robot).admit(robot, program, member);
    }

    fn start(&self, robot: RobotId, task: u32, flow: Box<dyn FnOnce() -> Option<u32> + Send>) -> io::Result<()> {
        self.executor_of(robot).start(robot, task, flow)
    }

    fn serve(&self, robot: RobotId, child: Arc<Child>) {
        self.executor_of(robot).serve(robot, child);
    }

    fn resume(&self, robot: RobotId, worker: u32) {
        self.executor_of(robot).resume(robot, worker);
    }

    fn suspend(&self, robot: RobotId) {
        self.executor_of(robot).suspend(robot);
    }

    fn continue_running(&self, robot: RobotId) {
        self.executor_of(robot).continue_running(robot);
    }

    fn switch(&self, robot: RobotId, task: u32) {
        self.executor_of(robot).switch(robot, task);
    }

    fn helping_workers(&self) -> usize {
        self.fibers.helping_workers()
    }

    fn run_loop(&self, job: &Job<'_>) {
        self.fibers.run_loop(job);
    }

    fn failures(&self) -> Vec<(RobotId, Failure)> {
        let mut all = self.threads.failures();
        all.extend(self.fibers.failures());
        all
    }

    fn is_overdue(&self, robot: RobotId, timeout: f64) -> bool {
        self.executor_of(robot).is_overdue(robot, timeout)
    }

    fn backtrace(&self, robot: RobotId) -> Vec<usize> {
        self.executor_of(robot).backtrace(robot)
    }

    fn break_overdue(&self, robot: RobotId) {
        self.executor_of(robot).break_overdue(robot);
    }
}
