//! How a robot's program stands at the end of a run, and the words in which the user is told.

use parking_lot::MutexGuard;
use sim_core::time::Time;

use super::conductor::End;
use super::fault::Broken;
use super::program::RobotProgram;
use crate::robios::call::Call;
use crate::robios::robot::{Ending, Robot, Waiting, Waits};
use sim_core::record::{Event, Outcome};

/// How a program stands.
pub struct Standing {
    /// In one word.
    pub outcome: Outcome,
    /// Why, where there is more to say.
    pub reason: Option<String>,
    /// Its exit code, where it gave one.
    pub exit_code: Option<i32>,
    /// Where it broke, and what it called last.
    pub fault: Option<Place>,
}

impl Standing {
    /// Records it at the end of the run of `robot`.
    pub fn record(&self, robot: &mut Robot) {
        let (now, journal) = (robot.now, &mut robot.state.journal);
        if let Some(Place { what, location, last_call }) = &self.fault {
            journal.record(now, &Event::Fault { what, location, last_call });
        }
        journal.record(now, &Event::ProgramEnded { outcome: self.outcome, exit_code: self.exit_code });
        if let Some(text) = &self.reason {
            journal.record(now, &Event::Reason { text });
        }
    }

    /// That of a robot that was taken out of the world while its program ran.
    pub fn removed() -> Self {
        Self { outcome: Outcome::Removed, reason: None, exit_code: None, fault: None }
    }

    /// That of a robot without a program.
    pub fn without_program() -> Self {
        Self { outcome: Outcome::NoProgram, reason: None, exit_code: None, fault: None }
    }
}

/// Where a program broke.
pub struct Place {
    /// What happened, without the place.
    pub what: String,
    /// Source file and line, empty where unknown.
    pub location: String,
    /// The last RoBIOS call, empty where there was none.
    pub last_call: &'static str,
}

/// What the end of a run is to all its robots.
pub struct Finish<'a> {
    /// Why the run ended.
    pub end: &'a End,
    /// Simulated time at its end.
    pub time: Time,
    /// Number of robots.
    pub robots: usize,
    /// Who could still have sent a message.
    pub senders: Senders,
}

/// Who could still send a message to a robot that waits for one when the run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Senders {
    /// Nobody: its program is the only one.
    None,
    /// Nobody: all other programs have ended.
    Ended,
    /// The other programs that have not ended, and they all wait for messages.
    Waiting,
    /// A program that waits for something else.
    Other,
}

impl Senders {
    /// Who they are, given the robots that have a program.
    pub fn among<'a>(robots: impl Iterator<Item = MutexGuard<'a, Robot>>) -> Self {
        let (mut programs, mut living, mut listening) = (0, 0, 0);
        for robot in robots {
            programs += 1;
            if matches!(robot.ending, None | Some(Ending::Stopped)) {
                living += 1;
                listening += usize::from(robot.tasks.wait_for(&Waits::Message));
            }
        }
        match living {
            1 if programs == 1 => Self::None,
            1 => Self::Ended,
            _ if listening == living => Self::Waiting,
            _ => Self::Other,
        }
    }

    /// What to say of them behind the message that is waited for.
    fn advice(self) -> &'static str {
        match self {
            Self::None => " (no other robot has a program)",
            Self::Ended => " (all other programs have ended)",
            Self::Waiting => " (all programs that have not ended wait for messages from each other)",
            Self::Other => "",
        }
    }
}

/// How the program of `robot` stands, given how the run finished and whether its flow broke.
pub fn judge(robot: &mut Robot, finish: &Finish<'_>, broken: Option<&Broken>, program: &RobotProgram) -> Standing {
    let standing = |outcome, reason| Standing { outcome, reason, exit_code: None, fault: None };
    if let Some(broken) = broken {
        let place = place(broken, program);
        let outcome = if broken.is_overdue { Outcome::Timeout } else { Outcome::Failed };
        return Standing { reason: Some(place.to_string()), fault: Some(place), ..standing(outcome, None) };
    }
    match &robot.ending {
        Some(Ending::Exited { code: 0 }) => Standing { exit_code: Some(0), ..standing(Outcome::Finished, None) },
        Some(Ending::Exited { code }) => {
            let reason = format!("{}exit code {code}", robot.tasks.prefix());
            Standing { exit_code: Some(*code), ..standing(Outcome::Failed, Some(reason)) }
        }
        Some(Ending::Failed { reason }) => standing(Outcome::Failed, Some(reason.clone())),
        _ if matches!(finish.end, End::Stuck) && robot.tasks.are_waiting() => {
            standing(Outcome::Waiting, Some(waits_in_words(robot, program, finish)))
        }
        _ => match finish.end {
            End::Interrupted => standing(Outcome::Interrupted, None),
            End::Broken => standing(Outcome::Interrupted, Some("another robot's program broke".into())),
            End::HeapLost => {
                let reason = "a program of another run in this process broke within the heap of the C library";
                standing(Outcome::Interrupted, Some(reason.into()))
            }
            End::Record(_) => standing(Outcome::Interrupted, Some("the record could not be written".into())),
            End::Until | End::Stuck | End::Finished => standing(Outcome::Running, None),
        },
    }
}

/// What each task waits for: `task 1 waits for the end of task 2 since 0.500 s at maze.c:31; task 2 waits for ...`.
fn waits_in_words(robot: &mut Robot, program: &RobotProgram, finish: &Finish<'_>) -> String {
    if robot.tasks.scheduler().is_some() && robot.tasks.has_others() {
        return tasks_in_words(robot, program, finish.senders);
    }
    let waits: Vec<_> = robot.tasks.iter().filter_map(|task| Some((task.number, task.waiting.clone()?))).collect();
    let is_alone = waits.len() == 1;
    let words = waits.iter().map(|(task, waiting)| {
        let words = wait_in_words(robot, waiting, program, finish);
        if is_alone { words } else { format!("task {task} {words}") }
    });
    words.collect::<Vec<_>>().join("; ")
}

/// What the tasks of a robot wait for while it runs, in words without places: `waits for KEY4 since 2.310 s`; empty where one of
/// them does not wait.
pub fn waits_now(robot: &Robot) -> String {
    if !robot.tasks.are_waiting() {
        return String::new();
    }
    let waits: Vec<_> = robot.tasks.iter().filter_map(|task| Some((task.number, task.waiting.as_ref()?))).collect();
    let words = waits.iter().map(|(task, waiting)| {
        let words = format!("waits for {} since {}", waiting.waits_for, waiting.since);
        if waits.len() == 1 { words } else { format!("{} {words}", robot.tasks.name(*task)) }
    });
    words.collect::<Vec<_>>().join("; ").replace("waits for to be", "waits to be")
}

/// What each task of RoBIOS 6 waits for: `` task `left` waits for semaphore 2 (made at deadlock.c:12), last passed by task `right`
/// (deadlock.c:31), since 0.500 s at deadlock.c:20; ... ``.
pub fn tasks_in_words(robot: &Robot, program: &RobotProgram, senders: Senders) -> String {
    let tasks = &robot.tasks;
    let at = |site| program.place_of(site).map(|place| format!(" at {place}")).unwrap_or_default();
    let words = tasks.iter().map(|task| {
        let name = tasks.name(task.number);
        let Some(Waiting { waits_for, since, site, .. }) = &task.waiting else {
            return match tasks.scheduler() {
                Some(scheduler) if scheduler.is_ready(task.number) => {
                    format!("{name} is ready, but it is not its turn")
                }
                _ => format!("{name}, spawned{}, is not ready", at(&task.origin.site)),
            };
        };
        let semaphore = match waits_for {
            Waits::Semaphore(number) => tasks.semaphores.get(*number),
            _ => None,
        };
        let more = semaphore.map(|semaphore| {
            let made = program.place_of(&semaphore.made_at).map(|place| format!(" (made at {place})"));
            let last = semaphore.last.as_ref().map(|(by, site)| {
                let place = program.place_of(site).map(|place| format!(" ({place})")).unwrap_or_default();
                format!(", last passed by {by}{place},")
            });
            made.unwrap_or_default() + &last.unwrap_or_default()
        });
        let suspended = match tasks.scheduler() {
            Some(scheduler) if *waits_for != Waits::Ready && scheduler.is_suspended(task.number) => "is suspended and ",
            _ => "",
        };
        let advice = if *waits_for == Waits::Message { senders.advice() } else { "" };
        let what = match waits_for {
            Waits::Task(wait) => wait.words(|number| tasks.name(number)),
            waits_for => waits_for.to_string(),
        };
        format!("{name} {suspended}waits for {what}{} since {since}{}{advice}", more.unwrap_or_default(), at(site))
    });
    words.collect::<Vec<_>>().join("; ").replace("waits for to be", "waits to be")
}

/// `waits for KEY4 since 2.310 s at maze.c:88 (try --keys "3:KEY4")`.
fn wait_in_words(robot: &mut Robot, waiting: &Waiting, program: &RobotProgram, finish: &Finish<'_>) -> String {
    let Waiting { call, waits_for, since, site } = waiting;
    let mut place = program.place_of(site).map(|site| format!(" at {site}")).unwrap_or_default();
    if *waits_for == Waits::Message {
        place = format!(" in {}{place}", call.name());
    }
    let advice = match waits_for {
        Waits::Key(key) => {
            let seconds = since.seconds().ceil();
            let key = key.split(' ').find(|word| word.starts_with("KEY")).unwrap_or("KEY1");
            let robot = if finish.robots == 1 { String::new() } else { format!("{}:", robot.id.0) };
            format!(" (try --keys \"{robot}{seconds}:{key}\")")
        }
        Waits::Message => finish.senders.advice().into(),
        Waits::Drive if robot.motion.is_stalled(finish.time) => " (its wheels stall: something is in its way)".into(),
        _ => String::new(),
    };
    format!("waits for {waits_for} since {since}{place}{advice}")
}

fn place(broken: &Broken, program: &RobotProgram) -> Place {
    let location = if broken.place.is_empty() {
        program.own_source_line(&broken.addresses).map(|line| line.to_string()).unwrap_or_default()
    } else {
        broken.place.clone()
    };
    let last_call = Call::of_robios_number(broken.last_call).map_or("", Call::name);
    Place { what: broken.what.clone(), location, last_call }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.what)?;
        if !self.location.is_empty() {
            write!(f, " at {}", self.location)?;
        }
        if !self.last_call.is_empty() {
            write!(f, ", last RoBIOS call `{}`", self.last_call)?;
        }
        Ok(())
    }
}
