//! Final status of robot programs, as values and as text for the user.

use parking_lot::MutexGuard;
use sim_core::time::Time;

use super::dispatcher::EndReason;
use super::failure::{
    Failure, ILLEGAL_DIVISION, ILLEGAL_INSTRUCTION, INVALID_POINTER, NULL_POINTER, STACK_OVERFLOW, live_words,
};
use super::process::CodeLocation;
use super::program::RobotProgram;
use super::reason;
use crate::program::access::{Accesses, accesses_of};
use crate::program::code::code_only;
use crate::program::plain::is_empty_clause;
use crate::robios::call::Call;
use crate::robios::robot::{Ending, Robot, Wait, WaitReason};
use sim_core::record::{Event, Outcome};

/// Status of a program at the end of the run.
pub struct ProgramStatus {
    /// The outcome in one word.
    pub outcome: Outcome,
    /// Reason for the outcome, unless the outcome explains itself.
    pub reason: Option<String>,
    /// Exit code of the program, if it gave one.
    pub exit_code: Option<i32>,
    /// Description of the failure, if the program failed.
    pub failure_report: Option<FailureReport>,
}

impl ProgramStatus {
    /// Records the status in the journal of `robot` at the end of the run.
    pub fn record(&self, robot: &mut Robot) {
        let (now, journal) = (robot.now, &mut robot.state.journal);
        if let Some(FailureReport { description, location, last_call }) = &self.failure_report {
            journal.record(now, &Event::ProgramFailed { what: description, location, last_call });
        }
        journal.record(now, &Event::ProgramEnded { outcome: self.outcome, exit_code: self.exit_code });
        if let Some(text) = &self.reason {
            journal.record(now, &Event::Reason { text });
        }
    }

    /// Status of a robot that was removed while its program ran.
    pub fn removed() -> Self {
        Self { outcome: Outcome::Removed, reason: None, exit_code: None, failure_report: None }
    }

    /// Status of a robot that was halted while its program ran.
    pub fn halted() -> Self {
        Self { outcome: Outcome::Halted, reason: None, exit_code: None, failure_report: None }
    }

    /// Status of a robot without a program.
    pub fn without_program() -> Self {
        Self { outcome: Outcome::NoProgram, reason: None, exit_code: None, failure_report: None }
    }
}

/// Failure of a program: description, location and last call.
pub struct FailureReport {
    /// Description of the failure, without the location.
    pub description: String,
    /// Source file and line; empty if unknown.
    pub location: String,
    /// The last RoBIOS call; empty if there was none.
    pub last_call: &'static str,
}

/// End of a run, as far as it matters to the status of every robot.
pub struct RunEnd<'a> {
    /// Reason for the end of the run.
    pub end: &'a EndReason,
    /// Virtual time at the end of the run.
    pub time: Time,
    /// Number of robots.
    pub robots: usize,
    /// Programs that could still have sent a message.
    pub senders: PossibleSenders,
}

/// Programs that could still send a message to a robot that waits for one when the run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PossibleSenders {
    /// No other robot has a program.
    None,
    /// All other programs have ended.
    Ended,
    /// Some other programs have not ended, but all of them wait for messages.
    Waiting,
    /// Another program has not ended, and waits for something else.
    Other,
}

impl PossibleSenders {
    /// Classifies the programs of `robots`, which are all the robots that have one.
    pub fn among<'a>(robots: impl Iterator<Item = MutexGuard<'a, Robot>>) -> Self {
        let (mut programs, mut living, mut listening) = (0, 0, 0);
        for robot in robots {
            programs += 1;
            if matches!(robot.ending, None | Some(Ending::Stopped)) {
                living += 1;
                listening += usize::from(robot.tasks.are_all_waiting_one_for(&WaitReason::Message));
            }
        }
        match living {
            1 if programs == 1 => Self::None,
            1 => Self::Ended,
            _ if listening == living => Self::Waiting,
            _ => Self::Other,
        }
    }

    /// Remark about the possible senders, appended to the description of a wait for a message.
    fn remark(self) -> &'static str {
        match self {
            Self::None => " (no other robot has a program)",
            Self::Ended => " (all other programs have ended)",
            Self::Waiting => " (all programs that have not ended wait for messages from each other)",
            Self::Other => "",
        }
    }
}

/// Minimum length of a wait that is reported when a run reaches its time limit. Source: our choice.
const LONG_WAIT: Time = Time::from_millis(1000);

/// Status of the program of `robot`, given the end of the run and the failure of its flow, if any.
pub fn judge(
    robot: &mut Robot,
    run_end: &RunEnd<'_>,
    failure: Option<&Failure>,
    program: &RobotProgram,
) -> ProgramStatus {
    let status = |outcome, reason| ProgramStatus { outcome, reason, exit_code: None, failure_report: None };
    if let Some(failure) = failure {
        let report = failure_report(failure, program);
        let outcome = if failure.is_overdue { Outcome::Timeout } else { Outcome::Failed };
        let reason = Some(format!("{report}{}", advice(&report, failure, robot, program)));
        return ProgramStatus { reason, failure_report: Some(report), ..status(outcome, None) };
    }
    match &robot.ending {
        Some(Ending::Exited { code: 0 }) => ProgramStatus { exit_code: Some(0), ..status(Outcome::Finished, None) },
        Some(Ending::Exited { code }) => {
            let reason = format!("{}exit code {code}", robot.tasks.prefix());
            ProgramStatus { exit_code: Some(*code), ..status(Outcome::Failed, Some(reason)) }
        }
        Some(Ending::Failed { reason }) => {
            let words = reason::explain(reason, |line| program.text_of(line));
            // `std::string(argv[1])`
            let is_null = reason.contains("construction from null");
            let line = reason::source_line(reason).filter(|_| is_null).and_then(|line| program.text_of(&line));
            let missing = line.and_then(|line| missing_argument(&line, robot, program)).unwrap_or_default();
            status(Outcome::Failed, Some(words.unwrap_or_else(|| format!("{reason}{missing}"))))
        }
        _ if matches!(run_end.end, EndReason::Stuck) && robot.tasks.are_all_waiting() => {
            status(Outcome::Waiting, Some(describe_waits(robot, program, run_end)))
        }
        // A wait that has just begun is not worth a report: every loop with a pause has one.
        _ if matches!(run_end.end, EndReason::Until) && robot.tasks.have_all_waited_since(run_end.time - LONG_WAIT) => {
            status(Outcome::Running, Some(describe_waits(robot, program, run_end)))
        }
        _ => match run_end.end {
            EndReason::Interrupted => status(Outcome::Interrupted, None),
            EndReason::ProgramFailed => status(Outcome::Interrupted, Some("another robot's program failed".into())),
            EndReason::HeapLost => {
                let reason = "a program of another run in this process crashed within the heap of the C library";
                status(Outcome::Interrupted, Some(reason.into()))
            }
            EndReason::Record(_) => status(Outcome::Interrupted, Some("the record could not be written".into())),
            EndReason::Until | EndReason::Stuck | EndReason::Finished => status(Outcome::Running, None),
        },
    }
}

/// Describes the wait of each task:
/// `task 1 waits for the end of task 2 since 0.500 s at maze.c:31; task 2 waits for ...`.
fn describe_waits(robot: &mut Robot, program: &RobotProgram, run_end: &RunEnd<'_>) -> String {
    if robot.tasks.scheduler().is_some() && robot.tasks.has_others() {
        return describe_tasks(robot, program, run_end.senders);
    }
    let waits: Vec<_> = robot.tasks.iter().filter_map(|task| Some((task.number, task.waiting.clone()?))).collect();
    let is_single = waits.len() == 1;
    let words = waits.iter().map(|(task, waiting)| {
        let words = describe_wait(robot, waiting, program, run_end);
        if is_single { words } else { format!("task {task} {words}") }
    });
    words.collect::<Vec<_>>().join("; ")
}

/// Describes the waits of a robot's tasks during the run, without locations: `waits for KEY4 since 2.310 s`; empty if a
/// task does not wait.
pub fn waits_now(robot: &Robot) -> String {
    if !robot.tasks.are_all_waiting() {
        return String::new();
    }
    let waits: Vec<_> = robot.tasks.iter().filter_map(|task| Some((task.number, task.waiting.as_ref()?))).collect();
    let words = waits.iter().map(|(task, waiting)| {
        let words = format!("{} since {}", waiting.reason, waiting.since);
        if waits.len() == 1 { words } else { format!("{} {words}", robot.tasks.name(*task)) }
    });
    words.collect::<Vec<_>>().join("; ")
}

/// Describes the wait of each task of RoBIOS 6: `` task `left` waits for semaphore 2 (made at deadlock.c:12), last
/// passed by task `right` (deadlock.c:31), since 0.500 s at deadlock.c:20; ... ``.
pub fn describe_tasks(robot: &Robot, program: &RobotProgram, senders: PossibleSenders) -> String {
    let tasks = &robot.tasks;
    let location_suffix =
        |site| program.location_of(site).map(|location| format!(" at {location}")).unwrap_or_default();
    let words = tasks.iter().map(|task| {
        let name = tasks.name(task.number);
        let Some(Wait { reason, since, site, .. }) = &task.waiting else {
            return match tasks.scheduler() {
                Some(scheduler) if scheduler.is_ready(task.number) => {
                    format!("{name} is ready, but it is not its turn")
                }
                _ => format!("{name}, spawned{}, is not ready", location_suffix(&task.origin.site)),
            };
        };
        let semaphore = match reason {
            WaitReason::Semaphore(number) => tasks.semaphores.get(*number),
            _ => None,
        };
        let semaphore_details = semaphore.map(|semaphore| {
            let made_at = program.location_of(&semaphore.made_at).map(|location| format!(" (made at {location})"));
            let last = semaphore.last.as_ref().map(|(by, site)| {
                let location = program.location_of(site).map(|location| format!(" ({location})")).unwrap_or_default();
                format!(", last passed by {by}{location},")
            });
            made_at.unwrap_or_default() + &last.unwrap_or_default()
        });
        let suspended = match tasks.scheduler() {
            Some(scheduler) if *reason != WaitReason::Ready && scheduler.is_suspended(task.number) => {
                "is suspended and "
            }
            _ => "",
        };
        let advice = if *reason == WaitReason::Message { senders.remark() } else { "" };
        let what = match reason {
            WaitReason::Task(wait) => format!("waits for {}", wait.describe(|number| tasks.name(number))),
            reason => reason.to_string(),
        };
        format!(
            "{name} {suspended}{what}{} since {since}{}{advice}",
            semaphore_details.unwrap_or_default(),
            location_suffix(site)
        )
    });
    words.collect::<Vec<_>>().join("; ")
}

/// Describes one wait: `waits for KEY4 since 2.310 s at maze.c:88 (try --keys "3:KEY4")`.
fn describe_wait(robot: &mut Robot, waiting: &Wait, program: &RobotProgram, run_end: &RunEnd<'_>) -> String {
    let Wait { call, reason, since, site } = waiting;
    let mut location = program.location_of(site).map(|site| format!(" at {site}")).unwrap_or_default();
    if *reason == WaitReason::Message {
        location = format!(" in {}{location}", call.name());
    }
    let advice = match reason {
        WaitReason::Key(key) => {
            let seconds = since.seconds().ceil();
            let key = key.split(' ').find(|word| word.starts_with("KEY")).unwrap_or("KEY1");
            let robot = if run_end.robots == 1 { String::new() } else { format!("{}:", robot.id.0) };
            format!(" (try --keys \"{robot}{seconds}:{key}\")")
        }
        WaitReason::Message => run_end.senders.remark().into(),
        WaitReason::Drive if robot.motion.is_stalled(run_end.time) => {
            " (its wheels stall: something is in its way)".into()
        }
        _ => String::new(),
    };
    format!("{reason} since {since}{location}{advice}")
}

fn failure_report(failure: &Failure, program: &RobotProgram) -> FailureReport {
    let location = if has_lost_heap(failure, program) {
        // The reason names the line that allocated the block; the overrun may have happened anywhere after that.
        String::new()
    } else if failure.location.is_empty() {
        line_of(&failure.addresses, program).unwrap_or_default()
    } else {
        failure.location.clone()
    };
    let last_call = Call::of_robios_number(failure.last_call).map_or("", Call::name);
    let description = match reason_of_trap(failure, program) {
        Some(reason) => reason,
        None if failure.description == ILLEGAL_INSTRUCTION && is_at_division(failure, program) => ILLEGAL_DIVISION,
        None => &failure.description,
    };
    let description = description.to_owned();
    FailureReport { description, location, last_call }
}

/// Reads and writes of the line at which the program's own code failed. `None` if the program failed elsewhere, if the
/// line may have further accesses, or if the program is in Rust.
fn accesses_at(failure: &Failure, program: &RobotProgram) -> Option<Accesses> {
    let line = program.own_source_line(failure.addresses.get(..1)?)?;
    let is_rust = line.file.extension().is_some_and(|extension| extension == "rs");
    accesses_of(&program.source_of(&line).filter(|_| !is_rust)?, usize::try_from(line.line).ok()?)
}

/// The pointers that the line uses at which the program's own code failed, if there are at most two: one of them was
/// NULL.
fn null_pointer(failure: &Failure, program: &RobotProgram) -> Option<String> {
    let pointers = accesses_at(failure, program)?.pointers;
    (1..=2).contains(&pointers.len()).then(|| format!("`{}`", pointers.join("` or `")))
}

/// Advice on the arguments of the program, if the `line` at which it ended uses one that it does not have: `argv[1]`.
fn missing_argument(line: &str, robot: &Robot, program: &RobotProgram) -> Option<String> {
    let count = program.argument_count()?;
    let index = first_missing_argument(&code_only(line), count)?;
    let arguments = match count {
        0 => "no arguments".to_owned(),
        1 => "only 1 argument".to_owned(),
        count => format!("only {count} arguments"),
    };
    let words = match index {
        1..=9 => vec!["VALUE"; index].join(" "),
        _ => "VALUE ... VALUE".to_owned(),
    };
    let (quote, number) = if index > 1 { ("\"", index.to_string()) } else { ("", "one".to_owned()) };
    Some(format!(
        "; `argv[{index}]` is NULL, since the program has {arguments}: `--args {}:{quote}{words}{quote}` gives it {number}",
        robot.id.0
    ))
}

/// The first index in `code` of an argument beyond the `count` arguments of a program.
fn first_missing_argument(code: &str, count: usize) -> Option<usize> {
    let indices = code.split("argv[").skip(1).filter_map(|rest| rest.split(']').next()?.trim().parse().ok());
    indices.filter(|index| *index > count).min()
}

/// Question about an index out of range, if the line at which the program's own code failed indexes one array and uses
/// no pointer.
fn index_out_of_range(failure: &Failure, program: &RobotProgram) -> Option<String> {
    let Accesses { pointers, arrays } = accesses_at(failure, program)?;
    let [array] = arrays.as_slice() else { return None };
    let len = array.len.filter(|_| pointers.is_empty() && !array.is_inside)?;
    Some(format!("; is an index of `{}` outside of its {len} elements, 0 to {}?", array.name, len.checked_sub(1)?))
}

/// Returns true if the line at which the program failed divides, and uses no pointer.
fn is_at_division(failure: &Failure, program: &RobotProgram) -> bool {
    let code = code_only(&code_of(failure, program, 0).unwrap_or_default());
    code.contains(['/', '%']) && !code.contains(['*', '[']) && !code.contains("->")
}

/// The line of the program at which it failed, or the line that is `lines_above` lines above it.
fn code_of(failure: &Failure, program: &RobotProgram, lines_above: u32) -> Option<String> {
    let mut line = program.own_source_line(&without_stale(&failure.addresses, program))?;
    line.line = line.line.checked_sub(lines_above)?;
    program.text_of(&line)
}

/// Returns true if the program failed in a loop without a body, `while (...);`, that is not the end of a `do` loop.
fn is_in_empty_loop(failure: &Failure, program: &RobotProgram) -> bool {
    let code = |lines_above: u32| Some(code_only(&code_of(failure, program, lines_above)?).trim().to_owned());
    let is_loop = |line: &String| !line.starts_with(['}', 'i']) && is_empty_clause(line);
    let previous_lines: Vec<String> = (1..=3).map_while(code).filter(|line| !line.is_empty()).collect();
    let begins_do = |line: &String| line == "do" || line.starts_with("do ") || line.starts_with("do{");
    code(0).as_ref().is_some_and(is_loop)
        && !previous_lines.first().is_some_and(|line| line.ends_with('}'))
        && !previous_lines.iter().any(begins_do)
}

/// Advice to the user about a failure, appended to its report.
fn advice(report: &FailureReport, failure: &Failure, robot: &Robot, program: &RobotProgram) -> String {
    let is_null = report.description.starts_with(NULL_POINTER);
    let open_failure = robot.robios.storage.open_failure().filter(|_| is_null);
    if failure.is_overdue && robot.robios.input.has_ended() {
        let file =
            robot.robios.storage.open_failure().map(|why| format!("; before that it could not open a file: {why}"));
        format!("; it has read its standard input, which has come to its end (`--stdin`){}", file.unwrap_or_default())
    } else if failure.is_overdue {
        let call = if report.location.contains(".rs:") { "robot.sleep(10.millis())" } else { "OSWait(10)" };
        if robot.timers.in_callback || robot.timers.was_stopped_in_callback {
            return "; the program and its other timers wait until this function of a timer returns".to_owned();
        }
        if !robot.timers.is_empty() {
            return format!(
                "; functions of timers run only during calls: put a call that waits into the loop, such as `{call}`"
            );
        }
        if robot.tasks.has_others() {
            return format!(
                "; other tasks run only during calls: put a call that waits into the loop, such as `{call}`"
            );
        }
        let empty =
            if is_in_empty_loop(failure, program) { "the `;` ends the loop here: leave it out, or " } else { "" };
        format!("; {empty}put a call that waits into the loop, such as `{call}`")
    } else if report.description.starts_with(STACK_OVERFLOW) {
        "; a function calls itself without end, or a local array is too large, which `static` moves off the stack"
            .to_owned()
    } else {
        let line = code_of(failure, program, 0).filter(|_| is_null);
        if let Some(missing) = line.and_then(|line| missing_argument(&line, robot, program)) {
            return missing;
        }
        let null = null_pointer(failure, program).filter(|_| is_null).map(|pointer| format!("; {pointer} is NULL"));
        // A NULL file is used within the C library, so that no line of the program shows the pointer.
        let null_file =
            open_failure.filter(|_| null.is_none()).map(|why| format!("; `fopen` has returned NULL before: {why}"));
        let may_be_out_of_range =
            report.description.contains(INVALID_POINTER) || report.description.contains("an array overrun");
        let index = index_out_of_range(failure, program).filter(|_| may_be_out_of_range);
        [null, null_file, index].into_iter().flatten().collect()
    }
}

/// The line in the program's own sources to which the addresses of a failure or of a backtrace lead: `maze.c:88`.
pub(super) fn line_of(addresses: &[usize], program: &RobotProgram) -> Option<String> {
    program.own_source_line(&without_stale(addresses, program)).map(|line| line.to_string())
}

/// The line in the program's own sources to which return addresses lead, the innermost first.
pub(super) fn line_of_stack(addresses: &[usize], program: &RobotProgram) -> Option<String> {
    // Address 0 contains no code; it takes the place of the program counter.
    let addresses: Vec<usize> = std::iter::once(0).chain(addresses.iter().copied()).collect();
    program.own_source_line(&addresses).map(|line| line.to_string())
}

/// The line at which a program in a process of its own computes.
pub(super) fn line_of_location(location: &CodeLocation, program: &RobotProgram) -> Option<String> {
    match location {
        CodeLocation::Addresses(addresses) => line_of(&addresses.map(|address| address as usize), program),
        CodeLocation::Line { file, line } => Some(format!("{file}:{line}")),
    }
}

/// Returns the addresses of a failure without words that are left over from earlier calls. A program in its own process
/// has already omitted them.
fn without_stale(addresses: &[usize], program: &RobotProgram) -> Vec<usize> {
    let mut addresses = addresses.to_vec();
    if let RobotProgram::InHost { program: thread, .. } = program
        && let Some((pc, words)) = addresses.split_first_mut()
        && !thread.addresses().contains(pc)
    {
        let live = live_words(words, thread.call_site().address.addr()).to_vec();
        addresses.splice(1.., live);
    }
    addresses
}

/// Returns true if the program failed because it had overwritten the heap's data between blocks, as its shim found
/// (`TRAP` in shim.c).
pub(super) fn has_lost_heap(failure: &Failure, program: &RobotProgram) -> bool {
    let function = || program.function_at(*failure.addresses.first()?);
    function().as_deref() == Some("eyesim_trap_heap_lost")
}

/// The reason for a trap of the shim, by the name of the function in which the program failed (`TRAP` in shim.c).
fn reason_of_trap(failure: &Failure, program: &RobotProgram) -> Option<&'static str> {
    match program.function_at(*failure.addresses.first()?)?.as_str() {
        "eyesim_trap_stack_smashed" => Some(
            "the program wrote over the end of a local array, and over what lies above it on the stack (stack smashed)",
        ),
        "eyesim_trap_off_task" => Some(
            "the program cannot be left: it ended on a thread that is not a task of the robot, or after a jump out of a function that the \
             host has called",
        ),
        _ => None,
    }
}

impl std::fmt::Display for FailureReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.description)?;
        if !self.location.is_empty() {
            write!(f, " at {}", self.location)?;
        }
        if !self.last_call.is_empty() {
            write!(f, ", last RoBIOS call `{}`", self.last_call)?;
        }
        Ok(())
    }
}
