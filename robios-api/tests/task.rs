//! Tasks, semaphores and shared values on the fake robot.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use robios_api::fake::{End, Fake, Run};
use robios_api::prelude::*;
use robios_api::{Priority, TaskMode};

/// Computes for `span` of virtual time; the task never waits.
fn work(robot: &Robot, span: Duration) {
    let end = robot.now() + span;
    while robot.now() < end {}
}

/// Texts that a program has written to the console.
fn lines(run: &Run) -> Vec<&str> {
    run.console().lines().collect()
}

#[test]
fn the_highest_priority_runs_first_and_equals_take_turns() {
    fn program(robot: &Robot) -> Result {
        let tasks = robot.multi_tasking(TaskMode::Preemptive)?;
        for (name, priority) in [("low", Priority::P1), ("one", Priority::P3), ("other", Priority::P3)] {
            let steps = move |robot: &Robot| {
                for step in 1..=3 {
                    writeln!(robot.console(), "{name} {step}");
                    work(robot, 10.millis());
                }
            };
            tasks.spawn(name, priority, steps)?.ready(robot)?;
        }
        let urgent = tasks.spawn("urgent", Priority::P8, |robot| -> Result {
            writeln!(robot.console(), "urgent");
            robot.tasks().sleep(30.millis())?;
            writeln!(robot.console(), "urgent again");
            Ok(())
        })?;
        urgent.ready(robot)?;
        writeln!(robot.console(), "main");
        tasks.permit()?;
        writeln!(robot.console(), "main again");
        Ok(())
    }
    let first = Fake::new().run(program).expect_finished();
    assert_eq!(
        lines(&first),
        [
            "main",
            "urgent",
            "one 1",
            "other 1",
            "one 2",
            "other 2",
            "urgent again",
            "one 3",
            "other 3",
            "low 1",
            "low 2",
            "low 3",
            "main again"
        ]
    );
    for _ in 0..20 {
        let again = Fake::new().run(program).expect_finished();
        assert_eq!((again.console(), again.time()), (first.console(), first.time()));
    }
}

#[test]
fn cooperative_tasks_switch_only_when_they_yield() {
    let run = Fake::new().run(|robot| -> Result {
        let tasks = robot.multi_tasking(TaskMode::Cooperative)?;
        assert_eq!(tasks.mode(), Some(TaskMode::Cooperative));
        let count = tasks.shared(0)?;
        for uid in 1..=3 {
            let count = count.clone();
            let settings = robios_api::TaskSettings { uid, ..robios_api::TaskSettings::new("task", Priority::P2) };
            let task = tasks.spawn_with(settings, move |robot| -> Result {
                for _ in 0..2 {
                    work(robot, 100.millis());
                    *count.lock(robot) += 1;
                    writeln!(robot.console(), "{} {}", robot.tasks().uid(), count.get(robot));
                    robot.tasks().reschedule()?;
                }
                Ok(())
            })?;
            assert_eq!(task.uid(robot), uid);
            task.ready(robot)?;
        }
        tasks.reschedule()?;
        assert_eq!(count.get(robot), 6, "`main` continues when no task is ready");
        Ok(())
    });
    let run = run.expect_finished();
    assert_eq!(lines(&run), ["1 1", "2 2", "3 3", "1 4", "2 5", "3 6"]);
}

#[test]
fn a_panic_or_an_error_in_a_task_ends_the_program() {
    fn program(task: fn(&Robot) -> Result) -> Run {
        Fake::new().run(move |robot: &Robot| -> Result {
            let tasks = robot.multi_tasking(TaskMode::Preemptive)?;
            tasks.spawn("doomed", Priority::P1, task)?.ready(robot)?;
            tasks.permit()?;
            robot.sleep(100.seconds());
            Ok(())
        })
    }
    let run = program(|robot| {
        robot.sleep(1.seconds());
        panic!("out of cheese")
    });
    let End::Failed { exit_code, reason } = run.end() else { panic!("{}", run.end()) };
    assert_eq!(*exit_code, 101);
    assert!(reason.contains("tests/task.rs:") && reason.ends_with(": out of cheese"), "{reason}");
    assert!((1.0..1.1).contains(&run.time().as_secs_f64()));
    let run = program(|robot| robot.psd(PsdAt::Front).map(drop));
    assert!(run.expect_failed().contains("no PSD sensor `PsdAt::Front`"));
}

#[test]
fn deadlock_report_names_what_each_task_waits_for() {
    let run = Fake::new().run(|robot| -> Result {
        let tasks = robot.multi_tasking(TaskMode::Cooperative)?;
        let (one, other) = (tasks.semaphore(1)?, tasks.semaphore(1)?);
        for (name, first, second) in [("left", one.clone(), other.clone()), ("right", other, one)] {
            let take_both = move |robot: &Robot| -> Result {
                let _first = first.acquire(robot);
                robot.tasks().reschedule()?;
                let _second = second.acquire(robot);
                Ok(())
            };
            tasks.spawn(name, Priority::P2, take_both)?.ready(robot)?;
        }
        tasks.suspend_self()
    });
    let reason = run.expect_failed();
    let expected = "no task can run: `main` is suspended, `left` waits at semaphore 2, `right` waits at semaphore 1";
    assert_eq!(reason, expected);
}

#[test]
fn locked_value_is_exclusive() {
    let run = Fake::new().run(|robot| -> Result {
        let tasks = robot.multi_tasking(TaskMode::Preemptive)?;
        let pair = tasks.shared((0, 0))?;
        for _ in 0..4 {
            let pair = pair.clone();
            let add = move |robot: &Robot| {
                for _ in 0..20 {
                    let mut pair = pair.lock(robot);
                    assert_eq!(pair.0, pair.1);
                    pair.0 += 1;
                    work(robot, 7.millis());
                    pair.1 += 1;
                }
            };
            tasks.spawn("adder", Priority::P4, add)?.ready(robot)?;
        }
        tasks.permit()?;
        assert_eq!(pair.get(robot), (80, 80));
        Ok(())
    });
    run.expect_finished();
}

#[test]
fn killed_task_releases_its_resources() {
    struct DropCounter(Arc<AtomicU32>);
    impl Drop for DropCounter {
        fn drop(&mut self) {
            self.0.fetch_add(1, Ordering::Relaxed);
        }
    }
    let dropped = Arc::new(AtomicU32::new(0));
    let counter = || DropCounter(Arc::clone(&dropped));
    let (in_holder, in_unready, in_waiting) = (counter(), counter(), counter());
    let run = Fake::new().run(move |robot| -> Result {
        let tasks = robot.multi_tasking(TaskMode::Preemptive)?;
        let value = tasks.shared(0)?;
        let shared_value = value.clone();
        let holder = tasks.spawn("holder", Priority::P4, move |robot| -> Result {
            let _counter = in_holder;
            let mut value = shared_value.lock(robot);
            *value = 7;
            robot.tasks().suspend_self()
        })?;
        holder.ready(robot)?;
        let unready = tasks.spawn("never", Priority::P4, move |_: &Robot| drop(in_unready))?;
        let waits = tasks.spawn("waits", Priority::P4, move |robot| -> Result {
            let _counter = in_waiting;
            robot.tasks().suspend_self()
        })?;
        waits.ready(robot)?;
        tasks.permit()?;
        holder.kill(robot)?;
        assert_eq!(*value.lock(robot), 7, "the killed task has released its lock");
        assert!(holder.ready(robot).is_err(), "it has ended");
        assert!(holder.kill(robot).is_err(), "it has ended");
        unready.kill(robot)?;
        assert!(unready.kill(robot).is_err(), "it has ended");
        Ok(())
    });
    run.expect_finished();
    assert_eq!(dropped.load(Ordering::Relaxed), 3, "including that of the task that still waits when `main` ends");
}

#[test]
fn suspended_task_continues_after_both_its_wait_and_its_suspension() {
    let run = Fake::new().run(|robot| -> Result {
        let tasks = robot.multi_tasking(TaskMode::Cooperative)?;
        let gate = tasks.semaphore(0)?;
        let to_pass = gate.clone();
        let task = tasks.spawn("waits", Priority::P4, move |robot: &Robot| -> Result {
            to_pass.wait(robot);
            writeln!(robot.console(), "passed");
            robot.tasks().sleep(100.millis())?;
            writeln!(robot.console(), "awake");
            Ok(())
        })?;
        task.run(robot)?;
        task.suspend(robot)?;
        gate.signal(robot);
        tasks.sleep(100.millis())?;
        writeln!(robot.console(), "made ready");
        task.run(robot)?;
        task.suspend(robot)?;
        task.run(robot)?;
        writeln!(robot.console(), "still asleep");
        tasks.sleep(200.millis())
    });
    assert_eq!(lines(&run.expect_finished()), ["made ready", "passed", "still asleep", "awake"]);
}

#[test]
fn task_timers_wake_tasks() {
    let run = Fake::new().run(|robot| -> Result {
        let timer = robot.every(100.millis(), |_| {})?;
        let refused = robot.multi_tasking(TaskMode::Cooperative).map(drop);
        assert!(
            matches!(refused, Err(Error::Unsuitable { .. })),
            "the function of such a timer may belong to this thread"
        );
        drop(timer);
        let tasks = robot.multi_tasking(TaskMode::Cooperative)?;
        assert!(matches!(robot.every(100.millis(), |_| {}), Err(Error::Unsuitable { .. })));
        let tick = tasks.semaphore(0)?;
        let to_signal = tick.clone();
        let _timer = tasks.every(100.millis(), move |robot| to_signal.signal(robot))?;
        let task = tasks.spawn("ticks", Priority::P4, move |robot| {
            for _ in 0..3 {
                tick.wait(robot);
                writeln!(robot.console(), "{}", robot.now().as_millis() / 10);
            }
        })?;
        task.ready(robot)?;
        tasks.reschedule()?;
        tasks.sleep(1.seconds())
    });
    let run = run.expect_finished();
    assert_eq!(lines(&run), ["10", "20", "30"]);
}

#[test]
fn a_timer_must_not_wait() {
    let run = Fake::new().run(|robot| -> Result {
        let tasks = robot.multi_tasking(TaskMode::Cooperative)?;
        let closed = tasks.semaphore(0)?;
        let _timer = tasks.every(100.millis(), move |robot| closed.wait(robot))?;
        tasks.sleep(1.seconds())
    });
    assert_eq!(run.expect_failed(), "OSSemP waits inside of a timer's function");
}

#[test]
fn pre_emption_can_be_deferred() {
    let order = Arc::new(Mutex::new(Vec::new()));
    let written_order = Arc::clone(&order);
    let run = Fake::new().run(move |robot| -> Result {
        let tasks = robot.multi_tasking(TaskMode::Preemptive)?;
        let (wake, written) = (tasks.semaphore(0)?, Arc::clone(&written_order));
        let note = move |text: &'static str| written.lock().expect("nobody panics").push(text);
        let (waits, to_note) = (wake.clone(), note.clone());
        let task = tasks.spawn("waits", Priority::P8, move |robot: &Robot| {
            loop {
                waits.wait(robot);
                to_note("task");
            }
        })?;
        task.ready(robot)?;
        tasks.permit()?;
        let forbidden = tasks.forbid()?;
        wake.signal(robot);
        work(robot, 50.millis());
        note("main");
        drop(forbidden);
        note("main again");
        wake.signal(robot);
        note("end");
        Ok(())
    });
    run.expect_finished();
    assert_eq!(*order.lock().expect("nobody panics"), ["main", "task", "main again", "task", "end"]);
}

#[test]
fn without_multi_tasking_there_are_no_tasks() {
    let run = Fake::new().run(|robot| -> Result {
        assert_eq!(robot.tasks().mode(), None);
        assert!(robot.tasks().spawn("early", Priority::P1, |_: &Robot| ()).is_err());
        assert!(robot.tasks().reschedule().is_err());
        assert!(robot.tasks().suspend_self().is_err());
        robot.multi_tasking(TaskMode::Preemptive)?;
        assert!(robot.multi_tasking(TaskMode::Preemptive).is_err(), "only once");
        Ok(())
    });
    run.expect_finished();
}

#[test]
fn tasks_may_switch_the_radio_on_simultaneously() {
    fn program(robot: &Robot, before_us: u64) -> Result {
        let tasks = robot.multi_tasking(TaskMode::Preemptive)?;
        for name in ["one", "other"] {
            let listen = move |robot: &Robot| -> Result {
                work(robot, Duration::from_micros(before_us));
                let radio = robot.radio()?;
                writeln!(robot.console(), "{name} {}", radio.waiting());
                robot.sleep(30.millis());
                Ok(())
            };
            tasks.spawn(name, Priority::P3, listen)?.ready(robot)?;
        }
        tasks.permit()
    }
    // For one of these durations, the time slice ends with the call that switches the radio on, and the other task
    // requests the radio before this call returns.
    for before_us in (0..10_000).step_by(50) {
        let run = Fake::new().run(move |robot: &Robot| program(robot, before_us)).expect_finished();
        assert_eq!(lines(&run).len(), 2, "{before_us} us: {:?}", lines(&run));
    }
}
