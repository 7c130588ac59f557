//! Output of a program, limited so that an endless loop does not flood terminal and disk.

use robios_sys::support::stream;
use robios_sys::{Stop, SupportCall};
use sim_core::record::Event;
use sim_core::time::Time;

use super::caller::Caller;
use super::flow::Flow;
use super::robot::Robot;

/// Default limit of a program's output in a run, in bytes; our choice.
pub const DEFAULT_OUTPUT_LIMIT: u64 = 10_000_000;

/// Virtual time that a line beyond the limit costs, 1 ms; our choice.
const CUT_LINE_COST: Time = Time(1000);

/// Counters of a program's output in bytes.
#[derive(Clone, Debug)]
pub struct Console {
    limit: u64,
    printed: u64,
    cut: u64,
}

impl Default for Console {
    fn default() -> Self {
        Self::new(DEFAULT_OUTPUT_LIMIT)
    }
}

impl Console {
    /// Creates a console that accepts `limit` bytes.
    pub fn new(limit: u64) -> Self {
        Self { limit, printed: 0, cut: 0 }
    }

    /// Bytes printed beyond the limit, which are not recorded.
    pub fn cut_bytes(&self) -> u64 {
        self.cut
    }

    /// Counts a line of `bytes` bytes; returns false if it is cut.
    fn accept(&mut self, bytes: u64) -> bool {
        let fits = self.cut == 0 && self.printed + bytes <= self.limit;
        *(if fits { &mut self.printed } else { &mut self.cut }) += bytes;
        fits
    }
}

impl<F: Flow> Caller<F> {
    /// Lets the virtual time that a line costs pass. Beyond the limit a line costs more, so that a program that only
    /// prints reaches the end of its run.
    ///
    /// # Errors
    /// [`Stop`] if the program must end.
    pub(super) fn spend_on_console(&self) -> Result<(), Stop> {
        let call = SupportCall::console;
        if self.call(call, |robot, _| robot.robios.console.cut > 0)? {
            self.run_in_call(call.into(), |caller| caller.spend_time(CUT_LINE_COST).map(drop))?;
        }
        Ok(())
    }
}

/// Records `text` line by line up to the limit; the first line that is cut is reported.
pub(crate) fn print_lines(robot: &mut Robot, stream: i32, text: &str) {
    let now = robot.now;
    for line in text.split_inclusive('\n') {
        let was_cut = robot.robios.console.cut > 0;
        let fits = robot.robios.console.accept(line.len() as u64);
        let line = line.strip_suffix('\n').unwrap_or(line);
        let text = line.strip_suffix('\r').unwrap_or(line);
        if fits {
            let event = if stream == stream::ERR { Event::Stderr { text } } else { Event::Stdout { text } };
            robot.journal.record(now, &event);
        } else if !was_cut {
            let limit = robot.robios.console.limit as f64 / 1e6;
            robot.hint(&format!(
                "the program has printed {limit} MB: what it prints from now on is cut and counted (`--output-limit` allows more)"
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_beyond_the_limit_are_counted() {
        let mut console = Console::new(10);
        assert!(console.accept(4) && console.accept(6));
        assert_eq!(console.cut_bytes(), 0);
        assert!(!console.accept(3) && !console.accept(0), "once cut, nothing more is shown");
        assert_eq!(console.cut_bytes(), 3);
    }
}
