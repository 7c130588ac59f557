//! Multi-tasking of RoBIOS 6: the schedule is equal for all slot lengths, thread counts and executors.

use serde_json::Value;
use tests::{Ran, Scratch, write_scene};

/// Result and report of a run of one robot with the program `source`.
fn run_one(source: &str, args: &[&str]) -> (Ran, Value) {
    run_as("prog.c", source, args)
}

fn run_as(name: &str, source: &str, args: &[&str]) -> (Ran, Value) {
    let scratch = Scratch::new();
    scratch.write(name, &with_headers(source));
    write_scene(&scratch, &[name]);
    let mut all = vec!["run", "scene.sim", "--report", "r.json"];
    all.extend(args);
    let ran = scratch.eyesim(&all);
    (ran, serde_json::from_str(&scratch.read("r.json")).expect("a report is JSON"))
}

/// Adds the first lines that every program here needs, so that its own lines start at line 4.
fn with_headers(source: &str) -> String {
    format!("#include \"eyebot.h\"\n#include <stdio.h>\n#include <stdlib.h>\n{}", source.trim_start())
}

/// Output of the robot, without times.
fn lines_of(ran: &Ran) -> Vec<String> {
    let lines = ran.stdout.lines().filter(|line| line.starts_with("[r1 "));
    lines.filter_map(|line| Some(line.split_once("] ")?.1.to_owned())).collect()
}

/// Output lines of a program that ends well, equal on threads and in a process.
fn output_of(source: &str) -> Vec<String> {
    let [one, other] = ["thread", "process"].map(|exec| {
        let (ran, report) = run_one(source, &["--exec", exec]);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        (lines_of(&ran), report["digest"].clone())
    });
    assert_eq!(one, other, "threads, and a process");
    one.0
}

/// Reason of the only robot in a run that fails, equal on threads and in a process.
fn reason_of(source: &str) -> String {
    let [one, other] = ["thread", "process"].map(|exec| {
        let (ran, report) = run_one(source, &["--exec", exec]);
        assert_eq!(ran.code, Some(1), "{ran:#?}");
        let reason = report["robots"][0]["reason"].as_str().unwrap_or_else(|| panic!("a reason: {ran:#?}"));
        // The reason contains the last call of the thread, or of the whole process, and then advice; both are removed.
        let reason = reason.split("; put a call").next().unwrap_or_default();
        let reason = reason.split("; a function calls itself").next().unwrap_or_default();
        reason.split(", last RoBIOS call").next().unwrap_or_default().to_owned()
    });
    assert_eq!(one, other, "threads, and a process");
    one
}

#[test]
fn a_refused_call_is_reported_with_its_line() {
    let source = "static void work(void) { }
int main(void)
{
    OSSpawn(\"work\", work, 0, 3, 1);
    OSKill(0);
    OSYield();
    return 0;
}";
    let (ran, _) = run_one(source, &[]);
    for said in ["prog.c:7: hint: `OSSpawn`", "prog.c:8: hint: `OSKill`", "prog.c:9: hint: `OSYield`"] {
        assert!(ran.stderr.contains(said), "{said}: {ran:#?}");
    }
}

#[test]
fn forbidden_calls_end_neither_a_task_nor_the_program() {
    let source = "static void work(void) { printf(\"kill self %d exit %d\\n\", OSKill(0), OSExit(3)); OSSleep(50); printf(\"alive\\n\"); }
int main(void)
{
    struct tcb *task;
    OSMTInit(PREEMPT);
    task = OSSpawn(\"work\", work, 4096, 3, 1);
    OSReady(task);
    OSPermit();
    OSSleep(20);
    printf(\"kill %d exit %d panic %d\\n\", OSKill(task), OSExit(3), OSPanic(\"no\"));
    OSSleep(100);
    return 0;
}";
    let (ran, _) = run_one(source, &["--forbid", "OSKill,OSExit,OSPanic"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert_eq!(lines_of(&ran), ["kill self -1 exit -1", "kill -1 exit -1 panic -1", "alive"]);
}

#[test]
fn releasing_the_drive_ends_the_wait_for_it_at_once() {
    let source = "static VWHandle vw;
static void drive(void)
{
    VWDriveStraight(vw, 1, 0.1);
    VWDriveWait(vw);
    printf(\"at %d\\n\", OSGetCount());
}
static void release(void)
{
    OSSleep(32);
    VWRelease(vw);
    OSSleep(100);
}
int main(void)
{
    vw = VWInit(VW_DRIVE, 1);
    OSMTInit(PREEMPT);
    OSReady(OSSpawn(\"drive\", drive, 4096, 3, 1));
    OSReady(OSSpawn(\"release\", release, 4096, 3, 2));
    OSPermit();
    OSSleep(200);
    return 0;
}";
    for slot in ["1", "200"] {
        let (ran, _) = run_one(source, &["--slot", slot]);
        assert_eq!(lines_of(&ran), ["at 34"], "slot {slot}: {ran:#?}");
    }
}

/// The classic example: a master creates three slave tasks that share one semaphore.
const CLASSIC: &str = "
#define SSIZE 4096
struct tcb *slaves[3], *last;
struct sem printer;
void slave(void)
{
    int id = OSGetUID(0), i;
    for (i = 1; i <= 3; i++) {
        OSSemP(&printer);
        printf(\"slave %d : %d at %d\\n\", id, i, OSGetCount());
        OSWait(2);
        OSSemV(&printer);
        OSReschedule();
    }
    printf(\"slave %d ends\\n\", id);
    OSKill(0);
}
void urgent(void)
{
    int i;
    for (i = 0; i < 3; i++) {
        OSSleep(5);
        printf(\"urgent at %d\\n\", OSGetCount());
    }
}
int main(void)
{
    int i;
    OSMTInit(MODE);
    OSSemInit(&printer, 1);
    for (i = 0; i < 3; i++)
        if (!(slaves[i] = OSSpawn(\"slave\", slave, SSIZE, MIN_PRI + (i == 2), i + 1)))
            OSPanic(\"spawn failed\");
    last = OSSpawn(\"urgent\", urgent, SSIZE, MAX_PRI, 4);
    for (i = 0; i < 3; i++)
        OSReady(slaves[i]);
    OSReady(last);
    printf(\"start\\n\");
    START;
    printf(\"back to main\\n\");
    OSSleep(20);
    return 0;
}
";

/// The classic example in a mode, with the call that starts it.
fn classic(mode: &str, start: &str) -> String {
    CLASSIC.replace("MODE", mode).replace("START", start)
}

fn assert_same_everywhere(source: &str, expected: &[&str]) {
    let settings: [&[&str]; 7] = [
        &[],
        &["--threads", "1"],
        &["--threads", "2"],
        &["--slot", "1"],
        &["--slot", "200"],
        &["--exec", "process"],
        &["--exec", "process", "--slot", "200", "--threads", "2"],
    ];
    for args in settings {
        let (ran, _) = run_one(source, args);
        assert_eq!(ran.code, Some(0), "{args:?}: {ran:#?}");
        assert_eq!(lines_of(&ran), expected, "{args:?}");
    }
}

#[test]
fn the_classic_example_interleaves_identically_every_time() {
    let expected = [
        "start",
        "slave 3 : 1 at 0",
        "slave 3 : 2 at 2",
        "slave 3 : 3 at 4",
        "urgent at 5",
        "slave 3 ends",
        "slave 1 : 1 at 6",
        "slave 2 : 1 at 8",
        "urgent at 10",
        "slave 1 : 2 at 10",
        "slave 2 : 2 at 12",
        "slave 1 : 3 at 14",
        "urgent at 15",
        "slave 2 : 3 at 16",
        "slave 1 ends",
        "slave 2 ends",
        "back to main",
    ];
    assert_same_everywhere(&classic("PREEMPT", "OSPermit()"), &expected);
}

#[test]
fn the_classic_example_in_cooperative_mode() {
    let expected = [
        "start",
        "slave 3 : 1 at 0",
        "slave 3 : 2 at 2",
        "slave 3 : 3 at 4",
        "urgent at 6",
        "slave 3 ends",
        "slave 1 : 1 at 6",
        "slave 2 : 1 at 8",
        "slave 1 : 2 at 10",
        "urgent at 12",
        "slave 2 : 2 at 12",
        "slave 1 : 3 at 14",
        "slave 2 : 3 at 16",
        "urgent at 18",
        "slave 1 ends",
        "slave 2 ends",
        "back to main",
    ];
    assert_same_everywhere(&classic("COOP", "OSReschedule()"), &expected);
}

#[test]
fn robots_with_tasks_give_one_digest() {
    let scratch = Scratch::new();
    scratch.write("prog.c", &with_headers(&classic("PREEMPT", "OSPermit()")));
    write_scene(&scratch, &["prog.c"; 3]);
    let digests: Vec<String> = (0..6)
        .map(|run| {
            let threads = ["1", "2"][run % 2];
            let report = scratch.report("scene.sim", &["--threads", threads], 0);
            report["digest"].as_str().expect("a digest").to_owned()
        })
        .collect();
    assert!(digests.iter().all(|digest| *digest == digests[0]), "{digests:?}");
    let ran = scratch.eyesim(&["run", "scene.sim", "-v", "--trace", "t.jsonl"]);
    assert!(ran.stdout.contains(&digests[0]), "watching changes nothing: {ran:#?}");
}

#[test]
fn slices_end_at_ticks_and_priorities_are_strict() {
    let lines = output_of(
        "
static char turns[64];
static int used;
static void busy(void)
{
    char me = 'a' + OSGetUID(0);
    while (OSGetCount() < 12)
        if (used < 60 && (used == 0 || turns[used - 1] != me))
            turns[used++] = me;
}
int main(void)
{
    OSMTInit(PREEMPT);
    for (int i = 0; i < 3; i++)
        OSReady(OSSpawn(\"busy\", busy, 4096, 3, i));
    OSReady(OSSpawn(\"low\", busy, 4096, 2, 9));
    OSPermit();
    printf(\"%s\\n\", turns);
    return 0;
}
",
    );
    assert_eq!(lines, ["abcabcabcabcab"], "a tick each, and what was begun before the end; the low one comes too late");
}

#[test]
fn busy_waits_use_up_slices_and_sleeps_do_not() {
    let lines = output_of(
        "
static void waits(void) { int from = OSGetCount(); OSWait(30); printf(\"waited %d\\n\", OSGetCount() - from); }
static void works(void) { int n = 0; while (OSGetCount() < 40) n++; printf(\"%s\\n\", n > 10 ? \"worked\" : \"starved\"); }
static void sleeps(void) { int from = OSGetCount(); OSSleep(30); printf(\"slept %d\\n\", OSGetCount() - from); }
static void low(void) { printf(\"low at %d\\n\", OSGetCount()); }
int main(void)
{
    OSMTInit(PREEMPT);
    OSReady(OSSpawn(\"waits\", waits, 0, 3, 0));
    OSReady(OSSpawn(\"works\", works, 0, 3, 0));
    OSReady(OSSpawn(\"sleeps\", sleeps, 0, 4, 0));
    OSReady(OSSpawn(\"low\", low, 0, 2, 0));
    OSPermit();
    return 0;
}
",
    );
    assert_eq!(lines, ["slept 30", "waited 30", "worked", "low at 40"]);
}

#[test]
fn a_wait_keeps_the_processor_from_cooperative_tasks() {
    let lines = output_of(
        "
static void one(void) { printf(\"one\\n\"); OSWait(10); printf(\"waited\\n\"); OSSleep(10); printf(\"slept\\n\"); }
static void other(void) { printf(\"other at %d\\n\", OSGetCount()); }
int main(void)
{
    OSMTInit(COOP);
    OSReady(OSSpawn(\"one\", one, 0, 1, 0));
    OSReady(OSSpawn(\"other\", other, 0, 8, 0));
    struct tcb *third = OSSpawn(\"one\", one, 0, 5, 0);
    OSWait(5);
    OSReschedule();
    printf(\"main at %d\\n\", OSGetCount());
    OSRun(third);
    OSSleep(30);
    return 0;
}
",
    );
    let expected = ["other at 5", "one", "waited", "main at 15", "one", "waited", "slept", "slept"];
    assert_eq!(lines, expected);
}

#[test]
fn forbid_holds_tasks_back_and_ready_calls_the_more_urgent() {
    let lines = output_of(
        "
static struct tcb *urgent;
static void high(void) { for (;;) { printf(\"high\\n\"); OSYield(); } }
static void low(void)
{
    OSReady(urgent);
    printf(\"after the first\\n\");
    OSForbid();
    OSReady(urgent);
    OSWait(5);
    printf(\"forbidden\\n\");
    OSPermit();
    printf(\"permitted %d\\n\", OSMTStatus() == PREEMPT);
}
int main(void)
{
    OSMTInit(PREEMPT);
    urgent = OSSpawn(\"high\", high, 0, 8, 0);
    OSReady(OSSpawn(\"low\", low, 0, 1, 0));
    OSPermit();
    return 0;
}
",
    );
    assert_eq!(lines, ["high", "after the first", "forbidden", "high", "permitted 1"]);
}

#[test]
fn a_killed_task_unwinds_before_its_killer_continues() {
    let source = "
struct Guard {
    const char *name;
    ~Guard() { printf(\"%s released at %d\\n\", name, OSGetCount()); OSSemV(&held); }
    static struct sem held;
};
struct sem Guard::held;
static void waits() { Guard guard = {\"waiter\"}; OSSemP(&Guard::held); OSSleep(100); printf(\"never\\n\"); }
static void works() { Guard guard = {\"worker\"}; for (;;) OSGetCount(); }
static void ends() { Guard guard = {\"ender\"}; OSExit(3); }
int main()
{
    struct tcb *all[4];
    OSMTInit(PREEMPT);
    OSSemInit(&Guard::held, 1);
    all[0] = OSSpawn(\"waits\", waits, 0, 5, 0);
    all[1] = OSSpawn(\"works\", works, 0, 1, 0);
    all[2] = OSSpawn(\"ends\", ends, 0, 5, 0);
    all[3] = OSSpawn(\"new\", works, 0, 5, 0);
    OSReady(all[0]); OSReady(all[1]);
    OSPermit();
    OSSleep(1);
    printf(\"slept\\n\");
    return 0;
}
";
    let source = source.replace("OSSleep(1);\n", "").replace(
        "    printf(\"slept",
        "    /* the worker starves main: main comes back only from here */\n    printf(\"slept",
    );
    // `main` cannot kill the tasks since the worker starves it, so a task of priority 8 kills them.
    let source = source.replace("int main()\n{\n    struct tcb *all[4];", "static struct tcb *all[4];\nstatic void kills()\n{\n    OSSleep(5);\n    printf(\"kills\\n\");\n    printf(\"%d\", OSKill(all[0])); printf(\"%d\", OSKill(all[1])); printf(\"%d\", OSKill(all[3])); printf(\"%d\\n\", OSKill(all[1]));\n    OSReady(all[2]);\n    OSSleep(1);\n    printf(\"passes %d\\n\", OSSemP(&Guard::held));\n}\nint main()\n{")
        .replace("OSPermit();", "OSReady(OSSpawn(\"kills\", kills, 0, 8, 0));\n    OSPermit();");
    for exec in ["thread", "process"] {
        let (ran, _) = run_as("prog.cpp", &source, &["--exec", exec]);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        let expected =
            ["kills", "waiter released at 5", "0worker released at 5", "00-1", "ender released at 5", "slept"];
        assert_eq!(lines_of(&ran)[..expected.len()], expected, "{ran:#?}");
    }
}

#[test]
fn a_task_killed_at_a_lock_does_not_pass_it() {
    let source = "
#include <pthread.h>
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static pthread_rwlock_t rwlock = PTHREAD_RWLOCK_INITIALIZER;
static pthread_barrier_t barrier;
static void at_mutex(void) { pthread_mutex_lock(&mutex); printf(\"passed the mutex\\n\"); pthread_mutex_unlock(&mutex); }
static void at_reader(void) { pthread_rwlock_rdlock(&rwlock); printf(\"reads\\n\"); pthread_rwlock_unlock(&rwlock); }
static void at_writer(void) { pthread_rwlock_wrlock(&rwlock); printf(\"writes\\n\"); pthread_rwlock_unlock(&rwlock); }
static void at_barrier(void) { pthread_barrier_wait(&barrier); printf(\"passed the barrier\\n\"); }
static void meets(void) { printf(\"meets %d\\n\", pthread_barrier_wait(&barrier) != 0); }
int main()
{
    void (*codes[])(void) = {at_mutex, at_reader, at_writer, at_barrier};
    struct tcb *tasks[4];
    int i;
    OSMTInit(COOP);
    pthread_barrier_init(&barrier, NULL, 2);
    pthread_mutex_lock(&mutex);
    pthread_rwlock_wrlock(&rwlock);
    for (i = 0; i < 4; i++) OSReady(tasks[i] = OSSpawn(\"task\", codes[i], 0, 1, i));
    OSReschedule();
    for (i = 0; i < 4; i++) printf(\"kill %d\\n\", OSKill(tasks[i]));
    printf(\"still locked %d\\n\", pthread_mutex_trylock(&mutex) != 0);
    pthread_rwlock_unlock(&rwlock);
    printf(\"free %d\\n\", pthread_rwlock_trywrlock(&rwlock));
    OSReady(OSSpawn(\"one\", meets, 0, 1, 0));
    OSReady(OSSpawn(\"other\", meets, 0, 1, 0));
    OSReschedule();
    return 0;
}";
    let expected = ["kill 0", "kill 0", "kill 0", "kill 0", "still locked 1", "free 0", "meets 1", "meets 0"];
    assert_eq!(output_of(source), expected);
}

#[test]
fn a_task_continues_to_end_for_any_call_of_its_handlers() {
    let source = "
#include <pthread.h>
static struct tcb none;
static void leave(void *text) { printf(\"%s\\n\", (char *)text); OSExit(3); }
static void work(void)
{
    pthread_cleanup_push(leave, \"first\");
    pthread_cleanup_push(leave, \"second\");
    OSSleep(100);
    pthread_cleanup_pop(0);
    pthread_cleanup_pop(0);
}
int main()
{
    struct tcb *task;
    OSMTInit(PREEMPT);
    OSReady(task = OSSpawn(\"work\", work, 0, 1, 0));
    OSPermit();
    printf(\"kill %d\\n\", OSKill(task));
    printf(\"no task: %d %d\\n\", OSKill(&none), OSReady(&none));
    return 0;
}";
    assert_eq!(output_of(source), ["second", "first", "kill 0", "no task: -1 -1"]);
}

#[test]
fn a_task_that_receives_learns_that_the_radio_is_off() {
    // The listening task keeps the processor, so a timer switches the radio off.
    let source = "
static void off(void) { RADIOTerm(); }
static void listen(void)
{
    BYTE id, buffer[MAXMSGLEN];
    int count;
    printf(\"received %d\\n\", RADIORecv(&id, &count, buffer));
}
int main()
{
    OSMTInit(PREEMPT);
    RADIOInit();
    OSAttachTimer(20, off);
    OSReady(OSSpawn(\"listen\", listen, 0, 1, 0));
    OSPermit();
    return 0;
}";
    assert_eq!(output_of(source), ["received -1"]);
}

#[test]
fn a_timer_wakes_tasks_and_may_not_wait() {
    let lines = output_of(
        "
static struct sem ticks;
static struct tcb *sleeper;
static int n;
static void tick(void) { OSSemV(&ticks); if (++n == 3) OSReady(sleeper); }
static void counts(void) { for (int i = 0; i < 3; i++) { OSSemP(&ticks); printf(\"tick %d\\n\", OSGetCount()); } }
static void sleeps(void) { OSSuspend(0); printf(\"woken %d\\n\", OSGetCount()); }
int main(void)
{
    OSMTInit(PREEMPT);
    OSSemInit(&ticks, 0);
    OSReady(OSSpawn(\"counts\", counts, 0, 3, 0));
    OSReady(sleeper = OSSpawn(\"sleeps\", sleeps, 0, 4, 0));
    OSPermit();
    OSAttachTimer(5, tick);
    OSSleep(20);
    printf(\"%d\\n\", n);
    return 0;
}
",
    );
    assert_eq!(lines, ["tick 5", "tick 10", "woken 15", "tick 15", "4"]);
    let blocks = |what: &str| {
        let program = "
#include <unistd.h>
static struct sem none;
static void tick(void) { WHAT; none.count++; }
int main(void) { OSMTInit(COOP); OSSemInit(&none, 0); OSAttachTimer(1, tick); OSSleep(100); return 0; }
";
        reason_of(&program.replace("WHAT", what))
    };
    assert_eq!(blocks("OSSemP(&none)"), "`OSSemP` would wait inside a timer callback at prog.c:6");
    assert_eq!(blocks("OSSleep(1)"), "`OSSleep` would wait inside a timer callback at prog.c:6");
    assert_eq!(blocks("OSYield()"), "`OSYield` would wait inside a timer callback at prog.c:6");
    assert_eq!(blocks("usleep(1000)"), "a function of the C library would wait inside a timer callback");
    assert_eq!(blocks("OSKill(0)"), "a timer's function would end `main`, which it interrupts at prog.c:6");
}

#[test]
fn a_deadlock_is_reported_with_tasks_and_semaphores() {
    let source = "
static struct sem one, two;
static void left(void) { OSSemP(&one); OSSleep(10); OSSemP(&two); OSSemV(&one); }
static void right(void) { OSSemP(&two); OSSleep(10); OSSemP(&one); OSSemV(&two); }
int main(void)
{
    OSMTInit(PREEMPT);
    OSSemInit(&one, 1);
    OSSemInit(&two, 1);
    OSReady(OSSpawn(\"left\", left, 0, 3, 0));
    OSReady(OSSpawn(\"right\", right, 0, 3, 0));
    OSPermit();
    VWSetSpeed(VWInit(VW_DRIVE, 1), 0.1, 1);
    OSSuspend(0);
    return 0;
}
";
    let expected = "deadlock: `main` waits to be made ready since 0.002 s at prog.c:16; \
                    task `left` waits for semaphore 2 (made at prog.c:11), last passed by task `right` (prog.c:6), since 0.101 s \
                    at prog.c:5; \
                    task `right` waits for semaphore 1 (made at prog.c:10), last passed by task `left` (prog.c:5), since 0.101 s \
                    at prog.c:6";
    // The robot drives in a circle forever; the deadlock is reported at once all the same.
    assert_eq!(reason_of(source), expected);
}

#[test]
fn other_robots_continue_after_a_deadlock_and_endless_waits_end_the_run() {
    let scratch = Scratch::new();
    scratch.write("stuck.c", &with_headers("int main(void) { OSMTInit(COOP); OSSuspend(0); return 0; }\n"));
    scratch.write("works.c", &with_headers("int main(void) { OSWait(100); printf(\"worked\\n\"); return 0; }\n"));
    write_scene(&scratch, &["stuck.c", "works.c"]);
    let report = scratch.report("scene.sim", &[], 1);
    assert_eq!(report["robots"][0]["reason"], "deadlock: `main` waits to be made ready since 0.000 s at stuck.c:4");
    assert_eq!(report["robots"][1]["outcome"], "finished");

    let (ran, report) = run_one(
        "
static void waits(void) { KEYGet(); }
int main(void)
{
    OSMTInit(PREEMPT);
    OSReady(OSSpawn(\"a\", waits, 0, 3, 0));
    OSReady(OSSpawn(\"b\", waits, 0, 3, 0));
    OSPermit();
    return 0;
}
",
        &[],
    );
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    let reason = report["robots"][0]["reason"].as_str().expect("a reason");
    assert!(reason.contains("task `a` waits for") && reason.contains("task `b` waits for"), "{reason}");
    assert_eq!(report["robots"][0]["outcome"], "waiting");
}

#[test]
fn turns_of_two_hundred_tasks_in_busy_waits_are_computed() {
    let lines = output_of(
        "
static int ended;
static void waits(void) { OSWait(10000); ended++; }
int main(void)
{
    OSMTInit(PREEMPT);
    for (int i = 0; i < 200; i++)
        OSReady(OSSpawn(NULL, waits, 65536, 3, i));
    OSPermit();
    printf(\"%d ended by %d s\\n\", ended, OSGetCount() / 100);
    return 0;
}
",
    );
    assert_eq!(lines, ["200 ended by 102 s"]);
}

#[test]
fn faults_and_overflows_name_the_task() {
    let program = "
static volatile int zero;
static int deep(int n) { volatile char room[4096]; room[n % 4096] = 1; return n > 1000000 ? 0 : deep(n + 1) + room[n % 4096]; }
static void breaks(void) { WHAT; }
int main(void)
{
    OSMTInit(PREEMPT);
    OSReady(OSSpawn(\"breaks\", breaks, 4096, 3, 0));
    OSPermit();
    return deep(zero) > 5;
}
";
    let fault = reason_of(&program.replace("WHAT", "*(volatile int *)16L = 1"));
    assert!(
        fault.starts_with("null pointer used (segmentation fault at address 0x10) in task `breaks` at prog.c:6"),
        "{fault}"
    );
    let overflow = reason_of(&program.replace("WHAT", "deep(zero)"));
    assert!(overflow.starts_with("stack overflow in task `breaks` at prog.c:5"), "{overflow}");
    let endless = {
        let source = program.replace("WHAT", "for (;;) ;");
        let (_, report) = run_one(&source, &["--timeout", "0.3"]);
        report["robots"][0]["reason"].as_str().expect("a reason").to_owned()
    };
    assert!(
        endless.starts_with("endless loop, or too long without a RoBIOS call in task `breaks` at prog.c:6"),
        "{endless}"
    );
    assert_eq!(reason_of(&program.replace("WHAT", "OSPanic(\"out\")")), "task `breaks`: OSPanic: out");
    assert_eq!(reason_of(&program.replace("WHAT", "OSError(\"out\", 7, TRUE)")), "task `breaks`: OSError 7: out");
    assert_eq!(reason_of(&program.replace("WHAT", "exit(3)")), "task `breaks`: exit code 3");
    assert_eq!(reason_of(&program.replace("WHAT", "abort()")), "task `breaks`: the program called abort at prog.c:6");
}

#[test]
fn wrong_calls_are_refused_and_reported() {
    let lines = output_of(
        "
#define SHOW(call) printf(\"%d \", call)
static void task(void) {}
static void keeps(void) { OSYield(); }
int main(void)
{
    struct sem sem = {0, 0}, none = {77, 0};
    struct tcb *ended, *kept, wrong = {.id = 99};
    SHOW(OSMTStatus()); SHOW(OSReady(NULL)); SHOW(OSSuspend(NULL)); SHOW(OSYield()); SHOW(OSReschedule());
    SHOW(OSKill(NULL)); SHOW(OSPermit()); SHOW(OSSpawn(\"t\", task, 0, 1, 0) == NULL); SHOW(OSGetUID(0)); SHOW(OSSleep(1));
    printf(\"before\\n\");
    SHOW(OSSemInit(&sem, 1)); SHOW(OSSemP(&sem)); SHOW(OSSemV(&sem)); SHOW(OSSemP(&sem));
    SHOW(OSSemInit(NULL, 1)); SHOW(OSSemInit(&sem, -1)); SHOW(OSSemP(&none)); SHOW(OSSemV(NULL));
    printf(\"semaphores\\n\");
    SHOW(OSMTInit(NOTASK)); SHOW(OSMTInit(PREEMPT)); SHOW(OSMTInit(COOP));
    printf(\"init\\n\");
    SHOW(OSSpawn(\"t\", task, 0, 0, 0) == NULL); SHOW(OSSpawn(\"t\", task, 0, 9, 0) == NULL);
    SHOW(OSSpawn(\"t\", task, -1, 1, 0) == NULL); SHOW(OSSpawn(\"t\", task, 2000000000, 1, 0) == NULL);
    SHOW(OSSpawn(\"t\", NULL, 0, 1, 0) == NULL);
    printf(\"spawn\\n\");
    ended = OSSpawn(NULL, task, 0, 1, 42);
    kept = OSSpawn(\"kept\", keeps, 0, 1, 43);
    SHOW(OSGetUID(ended)); SHOW(OSGetUID(kept)); SHOW(OSGetUID(0));
    printf(\"uid\\n\");
    OSReady(ended);
    OSReady(kept);
    OSPermit();
    SHOW(OSReady(ended)); SHOW(OSSuspend(ended)); SHOW(OSKill(ended)); SHOW(OSGetUID(ended));
    SHOW(OSRun(&wrong)); SHOW(OSReady(kept));
    printf(\"ended\\n\");
    return 0;
}
",
    );
    let expected = [
        "255 -1 -1 -1 -1 -1 -1 1 0 0 before",
        "0 0 0 0 -1 -1 -1 -1 semaphores",
        "-1 0 -1 init",
        "1 1 1 1 1 spawn",
        "42 43 0 uid",
        "-1 -1 -1 0 -1 0 ended",
    ];
    assert_eq!(lines, expected);
}

#[test]
fn tasks_that_main_leaves_behind_are_reported() {
    let source = "
static void waits(void) { OSSleep(100); }
int main(void) { OSMTInit(PREEMPT); OSReady(OSSpawn(\"late\", waits, 0, 1, 0)); OSPermit(); return 0; }
";
    let (ran, _) = run_one(source, &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    let hint = "the program ended with `main`, before task `late`: `OSSuspend(0)` lets `main` wait";
    assert!(ran.stderr.contains(hint) || ran.stdout.contains(hint), "{ran:#?}");
}

#[test]
fn hostile_task_programs_end_with_a_message() {
    // Kills between all tasks, from destructors and timers, never cause a hang or another exit code.
    let ends = |source: &str| {
        for exec in ["thread", "process"] {
            let (ran, _) = run_one(source, &["--exec", exec, "--until", "2"]);
            assert!(matches!(ran.code, Some(0 | 1)), "{source}: {ran:#?}");
        }
    };
    let program = "
static struct tcb *all[8];
static struct sem sem;
static void task(void) { WHAT; }
static void tick(void) { TICK; }
int main(void)
{
    OSMTInit(PREEMPT);
    OSSemInit(&sem, 1);
    for (int i = 0; i < 8; i++)
        all[i] = OSSpawn(\"t\", task, 0, 1 + i % 3, i);
    for (int i = 0; i < 8; i++)
        OSReady(all[i]);
    OSAttachTimer(3, tick);
    OSPermit();
    MAIN;
}
";
    for (what, tick, main) in [
        ("for (;;) OSKill(all[rand() % 8])", "", "return 0"),
        (
            "for (;;) { OSSuspend(all[rand() % 8]); OSReady(all[rand() % 8]); OSReschedule(); }",
            "OSReady(all[1])",
            "return 0",
        ),
        ("OSSleep(5); OSExit(1)", "OSKill(all[2])", "OSSuspend(0); return 0"),
        ("OSSemP(&sem); OSSleep(1); OSSemV(&sem); OSKill(0)", "OSKill(0)", "OSSuspend(0); return 0"),
        ("for (;;) OSWait(1)", "OSExit(0)", "OSSuspend(0); return 0"),
        ("OSSemP(&sem); OSSleep(rand() % 5)", "OSKill(all[rand() % 8])", "OSSleep(100); OSSemInit(&sem, 1); return 0"),
        ("for (;;) { OSForbid(); OSSleep(1); OSPermit(); }", "OSRun(all[3]); OSReschedule()", "for (;;) OSSleep(1)"),
        ("OSSpawn(\"u\", task, 0, 3, 1); for (;;) OSRun(OSSpawn(\"u\", task, 0, 3, 1))", "", "return 0"),
    ] {
        ends(&program.replace("WHAT", what).replace("TICK", tick).replace("MAIN", main));
    }
}
