//! Threads of C programs are tasks of their robot: they share its virtual time and take turns, and every run gives
//! equal results.

use serde_json::Value;
use tests::{Ran, Scratch, write_scene};

/// Result and report of a run of one robot with the program `source`.
fn run_one(source: &str, args: &[&str]) -> (Ran, Value) {
    let scratch = Scratch::new();
    scratch.write("prog.c", &with_headers(source));
    write_scene(&scratch, &["prog.c"]);
    let mut all = vec!["run", "scene.sim", "--report", "r.json"];
    all.extend(args);
    let ran = scratch.eyesim(&all);
    (ran, serde_json::from_str(&scratch.read("r.json")).expect("a report is JSON"))
}

/// Adds the first lines that every program here needs, so that its own lines start at line 10.
fn with_headers(source: &str) -> String {
    let headers = ["eyebot.h", "errno.h", "pthread.h", "semaphore.h", "stdio.h", "stdlib.h", "threads.h", "time.h"];
    let includes: String = headers.iter().map(|header| format!("#include \"{header}\"\n")).collect();
    format!("#define _GNU_SOURCE\n{includes}{source}")
}

/// Output lines of a program that ends well, without their times.
fn output_of(source: &str) -> Vec<String> {
    let (ran, _) = run_one(source, &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(!ran.stderr.contains("outside"), "{ran:#?}");
    let lines = ran.stdout.lines().filter(|line| line.starts_with("[r1 "));
    lines.filter_map(|line| Some(line.split_once("] ")?.1.to_owned())).collect()
}

/// Reason of the only robot in the report.
fn reason(report: &Value) -> &str {
    report["robots"][0]["reason"].as_str().expect("a reason")
}

const PRODUCER_CONSUMER: &str = "
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t changed = PTHREAD_COND_INITIALIZER;
static int queue[4], used, sum;
static void *produce(void *p) {
    for (int i = 1; i <= 200; i++) {
        pthread_mutex_lock(&mutex);
        while (used == 4)
            pthread_cond_wait(&changed, &mutex);
        queue[used++] = i;
        pthread_cond_broadcast(&changed);
        pthread_mutex_unlock(&mutex);
        if (rand() % 16 == 0)
            OSWait(1);
    }
    return p;
}
static void *consume(void *p) {
    for (int i = 0; i < 100; i++) {
        pthread_mutex_lock(&mutex);
        while (used == 0)
            pthread_cond_wait(&changed, &mutex);
        sum += queue[--used];
        pthread_cond_broadcast(&changed);
        pthread_mutex_unlock(&mutex);
        if (i % 20 == 0)
            printf(\"%s has %d\\n\", (char *)p, sum);
    }
    return (void *)1L;
}
int main(void) {
    pthread_t all[3];
    void *one, *other;
    VWHandle vw = VWInit(VW_DRIVE, 1);
    VWSetSpeed(vw, 0.1, 0.2);
    pthread_create(&all[0], NULL, consume, \"a\");
    pthread_create(&all[1], NULL, consume, \"b\");
    pthread_create(&all[2], NULL, produce, NULL);
    pthread_join(all[2], NULL);
    pthread_join(all[0], &one);
    pthread_join(all[1], &other);
    printf(\"sum %d, %ld joined\\n\", sum, (long)one + (long)other);
    return 0;
}
";

#[test]
fn three_robots_with_tasks_give_one_digest_twenty_times() {
    let scratch = Scratch::new();
    scratch.write("prog.c", &with_headers(PRODUCER_CONSUMER));
    write_scene(&scratch, &["prog.c"; 3]);
    let mut first = None;
    for run in 0..20 {
        let threads = ["1", "2"][run % 2];
        let report = scratch.report("scene.sim", &["--threads", threads], 0);
        let digest = report["digest"].as_str().expect("a digest").to_owned();
        assert_eq!(*first.get_or_insert(digest.clone()), digest, "run {run}, {threads} threads");
    }
    let ran = scratch.eyesim(&["run", "scene.sim", "-v", "--trace", "t.jsonl"]);
    assert_eq!(ran.stdout.matches("sum 20100, 2 joined").count(), 3, "{ran:#?}");
    assert!(ran.stdout.contains(&first.expect("twenty runs")), "watching changes nothing: {ran:#?}");
}

#[test]
fn philosophers_dine_in_turn() {
    let lines = output_of(
        "
static pthread_mutex_t forks[5];
static int meals[5];
static void *dine(void *p) {
    long i = (long)p;
    int left = i, right = (i + 1) % 5;
    for (int n = 0; n < 10; n++) {
        pthread_mutex_lock(&forks[left < right ? left : right]);
        pthread_mutex_lock(&forks[left < right ? right : left]);
        OSWait(1);
        meals[i]++;
        pthread_mutex_unlock(&forks[left]);
        pthread_mutex_unlock(&forks[right]);
        OSWait(1);
    }
    return NULL;
}
int main(void) {
    pthread_t all[5];
    for (long i = 0; i < 5; i++)
        pthread_mutex_init(&forks[i], NULL);
    for (long i = 0; i < 5; i++)
        pthread_create(&all[i], NULL, dine, (void *)i);
    for (int i = 0; i < 5; i++)
        pthread_join(all[i], NULL);
    printf(\"%d %d %d %d %d\\n\", meals[0], meals[1], meals[2], meals[3], meals[4]);
    return OSGetCount() < 100 ? 0 : 1;
}
",
    );
    assert_eq!(lines, ["10 10 10 10 10"]);
}

#[test]
fn tasks_wait_independently_and_share_the_clock() {
    let lines = output_of(
        "
static void *drive(void *p) {
    VWHandle vw = VWInit(VW_DRIVE, 1);
    VWDriveStraight(vw, 0.2, 0.2);
    VWDriveWait(vw);
    printf(\"arrived %d\\n\", OSGetCount() / 10);
    return p;
}
static void *look(void *p) {
    for (int i = 0; i < 3; i++) {
        OSWait(20);
        printf(\"looked %d\\n\", OSGetCount());
    }
    return p;
}
int main(void) {
    pthread_t a, b;
    pthread_create(&a, NULL, drive, NULL);
    pthread_create(&b, NULL, look, NULL);
    struct timespec half = {0, 500000000};
    nanosleep(&half, NULL);
    printf(\"slept %d\\n\", OSGetCount());
    pthread_join(a, NULL);
    pthread_join(b, NULL);
    return 0;
}
",
    );
    assert_eq!(lines, ["looked 20", "looked 40", "slept 50", "looked 60", "arrived 10"]);
}

#[test]
fn a_stop_by_another_task_ends_the_wait_for_a_drive() {
    let lines = output_of(
        "
static VWHandle vw;
static void *stop(void *p) { OSWait(50); VWSetSpeed(vw, 0, 0); return p; }
int main(void) {
    pthread_t other;
    vw = VWInit(VW_DRIVE, 1);
    pthread_create(&other, NULL, stop, NULL);
    VWDriveStraight(vw, 1, 0.1);
    VWDriveWait(vw);
    printf(\"%d\\n\", OSGetCount() / 10);
    return 0;
}
",
    );
    assert_eq!(lines, ["5"]);
}

#[test]
fn turns_are_taken_at_ticks_by_number() {
    // Each task counts its calls; no other task runs within a tick of 10 ms.
    let lines = output_of(
        "
static int who[4000], at[4000], n;
static void *busy(void *p) {
    while (OSGetCount() < 12) {
        if (n < 4000 && (n == 0 || who[n - 1] != (int)(long)p)) {
            who[n] = (int)(long)p;
            at[n++] = OSGetCount();
        }
    }
    return p;
}
int main(void) {
    pthread_t all[3];
    for (long i = 0; i < 3; i++)
        pthread_create(&all[i], NULL, busy, (void *)(i + 2));
    for (int i = 0; i < 3; i++)
        pthread_join(all[i], NULL);
    for (int i = 0; i < 9; i++)
        printf(\"%d at %d\\n\", who[i], at[i]);
    return 0;
}
",
    );
    let expected: Vec<String> = (0..9).map(|turn| format!("{} at {turn}", 2 + turn % 3)).collect();
    assert_eq!(lines, expected);
}

#[test]
fn barriers_conditions_with_deadlines_and_recursive_mutexes() {
    let lines = output_of(
        "
static pthread_barrier_t barrier;
static pthread_mutex_t mutex;
static pthread_cond_t condition = PTHREAD_COND_INITIALIZER;
static int serial, arrived;
static void *meet(void *p) {
    OSWait((int)(long)p);
    arrived++;
    if (pthread_barrier_wait(&barrier) == PTHREAD_BARRIER_SERIAL_THREAD)
        serial++;
    return (void *)(long)(arrived == 4);
}
int main(void) {
    pthread_t all[3];
    pthread_mutexattr_t recursive;
    struct timespec at;
    void *saw_all;
    int all_saw = 1;
    pthread_barrier_init(&barrier, NULL, 4);
    for (long i = 0; i < 3; i++)
        pthread_create(&all[i], NULL, meet, (void *)(i * 7));
    all_saw &= (long)meet((void *)5L);
    for (int i = 0; i < 3; i++) {
        pthread_join(all[i], &saw_all);
        all_saw &= (long)saw_all;
    }
    printf(\"barrier %d %d\\n\", serial, all_saw);

    pthread_mutexattr_init(&recursive);
    pthread_mutexattr_settype(&recursive, PTHREAD_MUTEX_RECURSIVE);
    pthread_mutex_init(&mutex, &recursive);
    pthread_mutex_lock(&mutex);
    pthread_mutex_lock(&mutex);
    pthread_mutex_unlock(&mutex);
    printf(\"recursive %d\\n\", pthread_mutex_destroy(&mutex) == EBUSY);

    int start = OSGetCount();
    clock_gettime(CLOCK_REALTIME, &at);
    at.tv_sec += 2;
    printf(\"timed %d\", pthread_cond_timedwait(&condition, &mutex, &at) == ETIMEDOUT);
    printf(\" %d\\n\", OSGetCount() - start);
    pthread_mutex_unlock(&mutex);
    printf(\"unlocked %d\\n\", pthread_mutex_unlock(&mutex) == EPERM);
    return 0;
}
",
    );
    assert_eq!(lines, ["barrier 1 1", "recursive 1", "timed 1 200", "unlocked 1"]);
}

#[test]
fn waiters_are_woken_first_come_first_served() {
    let lines = output_of(
        "
static sem_t sem;
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t condition = PTHREAD_COND_INITIALIZER;
static void *take(void *p) {
    OSWait(10 - 2 * (int)(long)p);
    sem_wait(&sem);
    printf(\"sem %ld\\n\", (long)p);
    pthread_mutex_lock(&mutex);
    pthread_cond_wait(&condition, &mutex);
    printf(\"condition %ld\\n\", (long)p);
    pthread_mutex_unlock(&mutex);
    return p;
}
int main(void) {
    pthread_t all[3];
    int value;
    sem_init(&sem, 0, 0);
    for (long i = 0; i < 3; i++)
        pthread_create(&all[i], NULL, take, (void *)i);
    OSWait(20);
    for (int i = 0; i < 4; i++) {
        sem_post(&sem);
        OSWait(1);
    }
    sem_getvalue(&sem, &value);
    printf(\"left %d, %d\\n\", value, sem_trywait(&sem) == 0 && sem_trywait(&sem) == -1 && errno == EAGAIN);
    pthread_cond_signal(&condition);
    OSWait(1);
    pthread_cond_broadcast(&condition);
    for (int i = 0; i < 3; i++)
        pthread_join(all[i], NULL);
    return 0;
}
",
    );
    // A broadcast makes all waiting tasks ready at once; they take turns by number.
    let expected = ["sem 2", "sem 1", "sem 0", "left 1, 1", "condition 2", "condition 0", "condition 1"];
    assert_eq!(lines, expected);
}

#[test]
fn results_detached_tasks_values_and_thread_locals() {
    let lines = output_of(
        "
static pthread_key_t key;
static pthread_once_t once = PTHREAD_ONCE_INIT;
static __thread int mine = 7;
static void done(void *value) { printf(\"destroyed %ld\\n\", (long)value); }
static void make_key(void) { printf(\"once\\n\"); pthread_key_create(&key, done); }
static void *work(void *p) {
    pthread_once(&once, make_key);
    pthread_setspecific(key, p);
    mine += (int)(long)p;
    errno = mine;
    OSWait(1 + (int)(long)p);
    if (errno != mine || pthread_getspecific(key) != p)
        exit(9);
    return (void *)(long)mine;
}
int main(void) {
    pthread_t a, b, c;
    pthread_attr_t detached;
    void *ra, *rb;
    pthread_attr_init(&detached);
    pthread_attr_setdetachstate(&detached, PTHREAD_CREATE_DETACHED);
    pthread_attr_setstacksize(&detached, 1 << 16);
    pthread_create(&a, NULL, work, (void *)1L);
    pthread_create(&b, NULL, work, (void *)2L);
    pthread_create(&c, &detached, work, (void *)3L);
    printf(\"%d %d\\n\", pthread_join(c, NULL) == EINVAL, pthread_equal(pthread_self(), a));
    pthread_join(b, &rb);
    pthread_join(a, &ra);
    printf(\"%ld %ld %d %d\\n\", (long)ra, (long)rb, mine, pthread_join(a, NULL) == ESRCH);
    pthread_exit(NULL);
}
",
    );
    assert_eq!(lines, ["1 0", "once", "destroyed 1", "destroyed 2", "8 9 7 1", "destroyed 3"]);
}

#[test]
fn threads_of_c11() {
    let lines = output_of(
        "
static mtx_t mutex;
static cnd_t condition;
static once_flag once = ONCE_FLAG_INIT;
static int go;
static void hello(void) { printf(\"hello\\n\"); }
static int work(void *p) {
    call_once(&once, hello);
    mtx_lock(&mutex);
    while (!go)
        cnd_wait(&condition, &mutex);
    mtx_unlock(&mutex);
    thrd_yield();
    return *(int *)p;
}
int main(void) {
    thrd_t a, b;
    int two = 2, three = 3, ra, rb;
    struct timespec at;
    mtx_init(&mutex, mtx_timed);
    cnd_init(&condition);
    thrd_create(&a, work, &two);
    thrd_create(&b, work, &three);
    thrd_sleep(&(struct timespec){.tv_sec = 1}, NULL);
    mtx_lock(&mutex);
    timespec_get(&at, TIME_UTC);
    at.tv_sec++;
    printf(\"%d\\n\", cnd_timedwait(&condition, &mutex, &at) == thrd_timedout);
    go = 1;
    cnd_broadcast(&condition);
    mtx_unlock(&mutex);
    thrd_join(a, &ra);
    thrd_join(b, &rb);
    printf(\"%d %d\\n\", ra, rb);
    return 0;
}
",
    );
    assert_eq!(lines, ["hello", "1", "2 3"]);
}

#[test]
fn a_cancelled_task_runs_its_handlers_at_the_next_call() {
    let lines = output_of(
        "
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t condition = PTHREAD_COND_INITIALIZER;
static void clean(void *p) { printf(\"clean %s\\n\", (char *)p); pthread_mutex_unlock(&mutex); }
static void *wait(void *p) {
    pthread_mutex_lock(&mutex);
    pthread_cleanup_push(clean, p);
    for (;;)
        pthread_cond_wait(&condition, &mutex);
    pthread_cleanup_pop(1);
    return p;
}
static void *key(void *p) { KEYGet(); return p; }
static void *busy(void *p) {
    pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, NULL);
    OSWait(50);
    printf(\"not yet\\n\");
    pthread_setcancelstate(PTHREAD_CANCEL_ENABLE, NULL);
    pthread_testcancel();
    return p;
}
int main(void) {
    pthread_t all[3];
    void *result;
    int cancelled = 0;
    pthread_create(&all[0], NULL, wait, \"waiter\");
    pthread_create(&all[1], NULL, key, NULL);
    pthread_create(&all[2], NULL, busy, NULL);
    OSWait(5);
    for (int i = 0; i < 3; i++)
        pthread_cancel(all[i]);
    for (int i = 0; i < 3; i++) {
        pthread_join(all[i], &result);
        cancelled += result == PTHREAD_CANCELED;
    }
    printf(\"%d at %d\\n\", cancelled, OSGetCount());
    return pthread_mutex_trylock(&mutex);
}
",
    );
    assert_eq!(lines, ["clean waiter", "not yet", "3 at 50"]);
}

#[test]
fn readers_share_and_writers_do_not() {
    let lines = output_of(
        "
static pthread_rwlock_t lock = PTHREAD_RWLOCK_INITIALIZER;
static int readers, most;
static void *read_it(void *p) {
    pthread_rwlock_rdlock(&lock);
    if (++readers > most)
        most = readers;
    OSWait(3);
    readers--;
    pthread_rwlock_unlock(&lock);
    return p;
}
static void *write_it(void *p) {
    pthread_rwlock_wrlock(&lock);
    printf(\"%d readers\\n\", readers);
    OSWait(3);
    pthread_rwlock_unlock(&lock);
    return p;
}
int main(void) {
    pthread_t all[4];
    struct timespec at = {0, 0};
    pthread_create(&all[0], NULL, read_it, NULL);
    pthread_create(&all[1], NULL, read_it, NULL);
    pthread_create(&all[2], NULL, write_it, NULL);
    pthread_create(&all[3], NULL, write_it, NULL);
    OSWait(1);
    printf(\"%d\\n\", pthread_rwlock_trywrlock(&lock) == EBUSY && pthread_rwlock_timedwrlock(&lock, &at) == ETIMEDOUT);
    for (int i = 0; i < 4; i++)
        pthread_join(all[i], NULL);
    printf(\"most %d\\n\", most);
    return 0;
}
",
    );
    assert_eq!(lines, ["1", "0 readers", "0 readers", "most 2"]);
}

#[test]
fn readers_continue_when_the_preferred_writer_gives_up() {
    let lines = output_of(
        "
static pthread_rwlock_t lock;
static void *read_it(void *p) {
    pthread_rwlock_rdlock(&lock);
    printf(\"reads at %d\\n\", OSGetCount());
    pthread_rwlock_unlock(&lock);
    return p;
}
static void *write_it(void *p) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += 100000000;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    if (pthread_rwlock_timedwrlock(&lock, &until) == ETIMEDOUT)
        printf(\"gives up at %d\\n\", OSGetCount());
    return p;
}
int main(void) {
    pthread_t writer, reader;
    pthread_rwlockattr_t kind;
    pthread_rwlockattr_init(&kind);
    pthread_rwlockattr_setkind_np(&kind, PTHREAD_RWLOCK_PREFER_WRITER_NONRECURSIVE_NP);
    pthread_rwlock_init(&lock, &kind);
    pthread_rwlock_rdlock(&lock);
    pthread_create(&writer, NULL, write_it, NULL);
    pthread_create(&reader, NULL, read_it, NULL);
    OSWait(50);
    pthread_rwlock_unlock(&lock);
    pthread_join(writer, NULL);
    pthread_join(reader, NULL);
    return pthread_rwlock_trywrlock(&lock);
}
",
    );
    assert_eq!(lines, ["gives up at 10", "reads at 10"]);
}

#[test]
fn a_deadlock_is_reported_with_the_waiting_tasks() {
    let (ran, report) = run_one(
        "static pthread_mutex_t a = PTHREAD_MUTEX_INITIALIZER, b = PTHREAD_MUTEX_INITIALIZER;
static void *other(void *p) {
    pthread_mutex_lock(&b);
    OSWait(10);
    pthread_mutex_lock(&a);
    return p;
}
int main(void) {
    pthread_t t;
    pthread_mutex_lock(&a);
    pthread_create(&t, NULL, other, NULL);
    OSWait(20);
    pthread_mutex_lock(&b);
    return 0;
}
",
        &[],
    );
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    assert_eq!(report["robots"][0]["outcome"], "waiting");
    assert_eq!(
        reason(&report),
        "task 1 waits for a mutex held by task 2 since 0.200 s at prog.c:22; \
         task 2 waits for a mutex held by task 1 since 0.100 s at prog.c:14"
    );
    assert!((ran.stdout + &ran.stderr).contains("task 2 waits for a mutex held by task 1"));
}

#[test]
fn a_fault_in_a_task_names_task_and_line() {
    let (ran, report) = run_one(
        "static void *bad(void *p) {
    OSWait(10);
    *(volatile int *)p = 1;
    return p;
}
int main(void) { pthread_t t; pthread_create(&t, NULL, bad, NULL); for (;;) OSWait(10); }
",
        &[],
    );
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    let reason = reason(&report);
    for word in ["null pointer used (segmentation fault at address 0x0) in task 2", "prog.c:12", "OSWait"] {
        assert!(reason.contains(word), "`{word}`: {reason}");
    }
}

#[test]
fn an_endless_loop_in_a_task_is_stopped_with_its_line() {
    let (ran, report) = run_one(
        "static void *bad(void *p) {
    OSWait(10);
    for (;;)
        ;
    return p;
}
int main(void) { pthread_t t; pthread_create(&t, NULL, bad, NULL); for (;;) OSWait(10); }
",
        &["--timeout", "0.5"],
    );
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    assert_eq!(report["robots"][0]["outcome"], "timeout");
    let reason = reason(&report);
    assert!(reason.contains("in task 2") && (reason.contains("prog.c:12") || reason.contains("prog.c:13")), "{reason}");
}

#[test]
fn a_stack_overflow_in_a_task_is_reported() {
    let (_, report) = run_one(
        "static int deep(int n) { volatile char pad[4096]; pad[0] = n; return deep(n + 1) + pad[0]; }
static void *bad(void *p) { OSWait(1); deep(0); return p; }
int main(void) { pthread_t t; pthread_create(&t, NULL, bad, NULL); pthread_join(t, NULL); return 0; }
",
        &[],
    );
    assert!(reason(&report).contains("stack overflow in task 2"), "{}", reason(&report));
}

#[test]
fn exit_in_a_task_ends_the_program_and_a_return_of_main_the_tasks() {
    let idle = "static void *idle(void *p) { for (;;) OSWait(1); return p; }\n";
    let (ran, report) = run_one(
        &format!(
            "{idle}static void bye(void) {{ printf(\"bye\\n\"); }}
static void *quit(void *p) {{ OSWait(10); exit(3); return p; }}
int main(void) {{
    pthread_t t;
    atexit(bye);
    pthread_create(&t, NULL, idle, NULL);
    pthread_create(&t, NULL, quit, NULL);
    pthread_create(&t, NULL, idle, NULL);
    for (;;)
        OSWait(10);
}}
"
        ),
        &[],
    );
    assert_eq!((ran.code, report["robots"][0]["exit_code"].as_i64()), (Some(1), Some(3)), "{ran:#?}");
    assert_eq!(ran.stdout.matches("bye").count(), 1, "{ran:#?}");
    let lines = output_of(&format!(
        "{idle}int main(void) {{
    pthread_t t;
    pthread_create(&t, NULL, idle, NULL);
    OSWait(5);
    pthread_create(&t, NULL, idle, NULL);
    printf(\"main\\n\");
    return 0;
}}
"
    ));
    assert_eq!(lines, ["main"]);
    // The end of the run ends every task, wherever it is.
    let (ran, report) = run_one(
        &format!(
            "{idle}int main(void) {{ pthread_t t; pthread_create(&t, NULL, idle, NULL); pthread_join(t, NULL); return 0; }}\n"
        ),
        &["--until", "1"],
    );
    assert_eq!((ran.code, &report["robots"][0]["outcome"]), (Some(0), &Value::from("running")), "{ran:#?}");
}

#[test]
fn tasks_that_only_print_take_turns_and_lines_stay_whole() {
    let lines = output_of(
        "
static int done;
static void *print(void *p) { while (!done) printf(\"%s\\n\", (char *)p); return p; }
static void *stop(void *p) { done = 1; return p; }
int main(void) {
    pthread_t a, b, c;
    pthread_create(&a, NULL, print, \"aaaaaaaa\");
    pthread_create(&b, NULL, print, \"bbbbbbbb\");
    pthread_create(&c, NULL, stop, NULL);
    pthread_join(a, NULL);
    pthread_join(b, NULL);
    pthread_join(c, NULL);
    return 0;
}
",
    );
    let count = |text: &str| lines.iter().filter(|line| *line == text).count();
    assert!(count("aaaaaaaa") > 1 && count("bbbbbbbb") > 1);
    assert_eq!(count("aaaaaaaa") + count("bbbbbbbb"), lines.len());
}

#[test]
fn thousands_of_tasks_one_after_the_other_and_too_many_at_a_time() {
    let lines = output_of(
        "
static sem_t never;
static void *work(void *p) { return p; }
static void *wait(void *p) { sem_wait(&never); return p; }
int main(void) {
    pthread_t t;
    long sum = 0, count = 0;
    void *result;
    for (long i = 0; i < 2000; i++) {
        pthread_create(&t, NULL, work, (void *)i);
        pthread_join(t, &result);
        sum += (long)result;
    }
    sem_init(&never, 0, 0);
    while (pthread_create(&t, NULL, wait, NULL) == 0)
        count++;
    printf(\"%ld %ld\\n\", sum, count);
    return 0;
}
",
    );
    assert_eq!(lines, ["1999000 255"]);
}

#[test]
fn timers_run_in_whichever_task_calls() {
    let lines = output_of(
        "
static sem_t sem;
static int ticks;
static void tick(void) { if (++ticks % 5 == 0) sem_post(&sem); }
static void *work(void *p) {
    for (int i = 0; i < 3; i++) {
        sem_wait(&sem);
        printf(\"%s %d\\n\", (char *)p, OSGetCount());
    }
    return p;
}
int main(void) {
    pthread_t a, b;
    sem_init(&sem, 0, 0);
    OSAttachTimer(1, tick);
    pthread_create(&a, NULL, work, \"a\");
    pthread_create(&b, NULL, work, \"b\");
    pthread_join(a, NULL);
    pthread_join(b, NULL);
    return 0;
}
",
    );
    assert_eq!(lines, ["a 5", "b 10", "a 15", "b 20", "a 25", "b 30"]);
}
