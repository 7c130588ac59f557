//! Services for the language runtimes of programs (Rust, Python, shim): console, random numbers, virtual time, reasons
//! of failures, tasks.

use std::collections::BTreeMap;

use robios_sys::support::failure;
use robios_sys::{Callback, OutBytes, Stop, Support, SupportCall};
use sim_core::RobotId;
use sim_core::noise::{Purpose, Stream};
use sim_core::time::Time;

use super::caller::{Caller, Poll};
use super::console::print_lines;
use super::flow::Flow;
use super::hint::Mistake;
use super::input::{self, Read};
use super::layer::{self, Extent, Label};
use super::lidar;
use super::robot::{Ending, Robot, WaitReason};
use super::task::TaskWait;
use crate::program::site::{RemoteSite, Site};

/// Random generators of a program, one per purpose.
#[derive(Clone, Debug)]
pub struct Generators {
    seed: u64,
    robot: RobotId,
    streams: BTreeMap<u32, Stream>,
}

impl Generators {
    /// The generators of `robot` in a run with `seed`.
    pub fn new(seed: u64, robot: RobotId) -> Self {
        Self { seed, robot, streams: BTreeMap::new() }
    }

    /// The next 64 bits for `purpose`.
    pub fn bits(&mut self, purpose: u32) -> u64 {
        let (seed, robot) = (self.seed, self.robot);
        self.streams.entry(purpose).or_insert_with(|| Stream::new(seed, robot, Purpose::Program, purpose, 0)).bits()
    }

    /// Restarts the stream for `purpose` with the program's seed, as its substream `program_seed` + 1; substream 0 is
    /// for programs that set no seed.
    pub fn seed(&mut self, purpose: u32, program_seed: u64) {
        let substream = program_seed.wrapping_add(1);
        self.streams.insert(purpose, Stream::new(self.seed, self.robot, Purpose::Program, purpose, substream));
    }
}

impl<F: Flow> Support for Caller<F> {
    fn console(&self, stream: i32, bytes: Option<&[u8]>) -> Result<i32, Stop> {
        let text = String::from_utf8_lossy(bytes.unwrap_or_default());
        // The output of a program that must stop is still recorded, but costs no virtual time.
        let result = if self.flow().is_exiting() { Ok(()) } else { self.spend_on_console() };
        self.act_untimed(SupportCall::console, |robot| print_lines(robot, stream, &text));
        result.map(|()| 0)
    }

    fn random(&self, purpose: u32) -> Result<u64, Stop> {
        self.call(SupportCall::random, |robot, _| robot.generators.bits(purpose))
    }

    fn seed(&self, purpose: u32, seed: u64) -> Result<i32, Stop> {
        self.call(SupportCall::seed, |robot, _| {
            robot.generators.seed(purpose, seed);
            0
        })
    }

    fn time_us(&self) -> Result<i64, Stop> {
        self.call(SupportCall::time_us, |robot, _| robot.now.0)
    }

    fn sleep_us(&self, span_us: i64) -> Result<i32, Stop> {
        self.sleep(Time(span_us.max(0))).map(|()| 0)
    }

    fn failed(&self, kind: i32, text: Option<&[u8]>, stack: Option<&[u8]>) -> Result<i32, Stop> {
        let text = String::from_utf8_lossy(text.unwrap_or_default());
        let location = self.flow().line_of(&addresses(stack)).map(|line| format!(" at {line}"));
        let reason = match kind {
            failure::ABORT => "the program called abort".to_owned(),
            failure::ASSERTION => format!("assertion failed: {text}"),
            failure::PANIC => format!("panicked: {text}"),
            failure::STACK => "the program wrote over the end of a local array (stack smashed)".to_owned(),
            _ => text.into_owned(),
        };
        self.act_untimed(SupportCall::failed, |robot| {
            let reason = robot.tasks.prefix() + &reason + &location.unwrap_or_default();
            robot.ending.get_or_insert(Ending::Failed { reason });
        });
        Ok(0)
    }

    fn open_failed(&self, name: Option<&[u8]>, error: i32) -> Result<i32, Stop> {
        let name = String::from_utf8_lossy(name.unwrap_or_default());
        self.act_untimed(SupportCall::open_failed, |robot| robot.robios.storage.note_open_failure(&name, error));
        Ok(0)
    }

    fn hint(&self, text: Option<&[u8]>) -> Result<i32, Stop> {
        let text = String::from_utf8_lossy(text.unwrap_or_default());
        self.act_untimed(SupportCall::hint, |robot| robot.hint(&text));
        Ok(0)
    }

    fn open_failed_at(&self, name: Option<&[u8]>, error: i32, stack: Option<&[u8]>) -> Result<i32, Stop> {
        let name = String::from_utf8_lossy(name.unwrap_or_default());
        let line = self.flow().line_of(&addresses(stack));
        self.act_untimed(SupportCall::open_failed_at, |robot| {
            robot.robios.storage.note_open_failure(&name, error);
            if !robot.robios.hints.is_first(Mistake::Unopened) {
                return;
            }
            let reason = robot.robios.storage.open_failure().unwrap_or_default();
            robot.state.hint(reason);
            line.as_deref().and_then(RemoteSite::of_line).into_iter().for_each(|site| {
                self.flow().note_hint(reason, &Site::Reported(site));
            });
        });
        Ok(0)
    }

    fn read_at_end(&self, stack: Option<&[u8]>) -> Result<i32, Stop> {
        let line = self.flow().line_of(&addresses(stack));
        self.act_untimed(SupportCall::read_at_end, |_| {
            line.as_deref().and_then(RemoteSite::of_line).into_iter().for_each(|site| {
                self.flow().note_hint(input::EMPTY_HINT, &Site::Reported(site));
            });
        });
        Ok(0)
    }

    fn unfinished(&self, stream: i32, bytes: Option<&[u8]>) -> Result<i32, Stop> {
        let text = String::from_utf8_lossy(bytes.unwrap_or_default());
        self.act_untimed(SupportCall::unfinished, |robot| print_lines(robot, stream, &text));
        Ok(0)
    }

    fn show_grid(
        &self,
        name: Option<&[u8]>,
        frame: i32,
        x_m: f64,
        y_m: f64,
        cell_m: f64,
        columns: i32,
        rows: i32,
        cells: Option<&[u8]>,
    ) -> Result<i32, Stop> {
        let extent = Extent { corner: [x_m, y_m], cell: cell_m, size: [columns, rows] };
        let label = Label { name, frame };
        Ok(self.act_untimed(SupportCall::show_grid, |robot| layer::show_grid(robot, label, extent, cells)))
    }

    fn show_points(
        &self,
        name: Option<&[u8]>,
        frame: i32,
        dimensions: i32,
        count: i32,
        coordinates: Option<&[u8]>,
    ) -> Result<i32, Stop> {
        let (label, size) = (Label { name, frame }, [dimensions, count]);
        Ok(self.act_untimed(SupportCall::show_points, |robot| layer::show_points(robot, label, size, coordinates)))
    }

    fn show_line(
        &self,
        name: Option<&[u8]>,
        frame: i32,
        dimensions: i32,
        count: i32,
        coordinates: Option<&[u8]>,
    ) -> Result<i32, Stop> {
        let (label, size) = (Label { name, frame }, [dimensions, count]);
        Ok(self.act_untimed(SupportCall::show_line, |robot| layer::show_line(robot, label, size, coordinates)))
    }

    fn lidar_points(&self) -> Result<i32, Stop> {
        Ok(self.act_untimed(SupportCall::lidar_points, |robot| lidar::point_count(robot)))
    }

    fn program_name(&self, name: &mut OutBytes) -> Result<i32, Stop> {
        let length = self.act_untimed(SupportCall::program_name, |robot| {
            name.set(robot.program.as_bytes());
            robot.program.len()
        });
        Ok(i32::try_from(length).unwrap_or(i32::MAX))
    }

    fn task_self(&self) -> Result<i32, Stop> {
        self.call(SupportCall::task_self, |robot, _| robot.tasks.current().number.cast_signed())
    }

    fn task_spawn(&self, code: Option<Callback>) -> Result<i32, Stop> {
        code.map_or(Ok(0), |code| self.spawn(SupportCall::task_spawn, code))
    }

    fn task_wait(&self, key: u64, kind: i32, holder: i32, deadline_us: i64) -> Result<i32, Stop> {
        let holder = u32::try_from(holder).unwrap_or(0);
        self.wait_untimed(SupportCall::task_wait, |robot, _| {
            if robot.tasks.enqueue_or_check(key) {
                Poll::Ready(1)
            } else if robot.now >= Time(deadline_us) {
                Poll::Ready(0)
            } else {
                Poll::Pending { at: Time(deadline_us), reason: WaitReason::Task(TaskWait { kind, holder }) }
            }
        })
    }

    fn task_wake(&self, key: u64) -> Result<i32, Stop> {
        Ok(self.act_untimed(SupportCall::task_wake, |robot| robot.tasks.wake_first(key).map_or(0, u32::cast_signed)))
    }

    fn task_wake_all(&self, key: u64) -> Result<i32, Stop> {
        let wake_all = |robot: &mut Robot| std::iter::from_fn(|| robot.tasks.wake_first(key)).count();
        Ok(self.act_untimed(SupportCall::task_wake_all, wake_all) as i32)
    }

    fn task_interrupt(&self, task: i32) -> Result<i32, Stop> {
        let number = u32::try_from(task).unwrap_or(0);
        Ok(i32::from(self.act_untimed(SupportCall::task_interrupt, |robot| robot.tasks.interrupt(number))))
    }

    fn task_yield(&self) -> Result<i32, Stop> {
        self.yield_turn(SupportCall::task_yield).map(|()| 0)
    }

    fn task_turn(&self) -> Result<i32, Stop> {
        self.yield_if_due(SupportCall::task_turn).map(|()| 0)
    }

    fn input(&self, bytes: &mut OutBytes) -> Result<i32, Stop> {
        let read = self.wait(SupportCall::input, |robot, _| input::read(robot, bytes.capacity()))?;
        match read {
            Read::Bytes(line) => Ok(bytes.set(&line) as i32),
            Read::End => Ok(0),
            Read::Loop => Err(self.fail(self.robot(), input::LOOP_REASON.to_owned())),
        }
    }
}

/// The addresses of a call stack, which the program passes as bytes.
fn addresses(stack: Option<&[u8]>) -> Vec<usize> {
    let chunks = stack.unwrap_or_default().as_chunks().0;
    chunks.iter().map(|address| usize::from_ne_bytes(*address)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_restarts_the_sequence_and_robots_differ() {
        let draw = |generators: &mut Generators| (0..3).map(|_| generators.bits(1)).collect::<Vec<_>>();
        let mut one = Generators::new(5, RobotId(1));
        let unseeded = draw(&mut one);
        one.seed(1, 0);
        let seeded = draw(&mut one);
        one.seed(1, 0);
        assert_eq!(draw(&mut one), seeded);
        assert_ne!(unseeded, seeded);
        assert_eq!(draw(&mut Generators::new(5, RobotId(1))), unseeded);
        assert_ne!(draw(&mut Generators::new(5, RobotId(2))), unseeded);
        assert_ne!(draw(&mut Generators::new(6, RobotId(1))), unseeded);
    }
}
