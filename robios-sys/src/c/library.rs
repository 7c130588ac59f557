//! Interposed functions of the C library, as data: for messages, for warnings about libraries built elsewhere, and for
//! `docs/c-library.md`.

/// Interposed symbols of the C library, and their behaviour in the shim.
///
/// If a library built without the shim imports one of them, its calls act outside of its robot or of virtual time.
pub const INTERPOSED: &[(&str, &str)] = &[
    ("exit", ENDS),
    ("_exit", ENDS_AT_ONCE),
    ("_Exit", ENDS_AT_ONCE),
    ("quick_exit", ENDS_AT_ONCE),
    ("abort", FAILS),
    ("atexit", REGISTERS),
    ("at_quick_exit", REGISTERS),
    ("on_exit", REGISTERS),
    ("__cxa_atexit", REGISTERS),
    ("__cxa_thread_atexit_impl", REGISTERS),
    ("__assert_fail", FAILS),
    ("__assert", FAILS),
    ("__assert_perror_fail", FAILS),
    ("__stack_chk_fail", FAILS),
    ("__chk_fail", FAILS),
    ("err", ENDS),
    ("errx", ENDS),
    ("verr", ENDS),
    ("verrx", ENDS),
    ("error", ENDS),
    ("warn", PRINTS),
    ("warnx", PRINTS),
    ("vwarn", PRINTS),
    ("vwarnx", PRINTS),
    ("stdin", READS),
    ("stdout", PRINTS),
    ("stderr", PRINTS),
    ("fputc", PRINTS_ANY),
    ("putc", PRINTS_ANY),
    ("_IO_putc", PRINTS_ANY),
    ("fputs", PRINTS_ANY),
    ("fwrite", PRINTS_ANY),
    ("fprintf", PRINTS_ANY),
    ("__fprintf_chk", PRINTS_ANY),
    ("printf", PRINTS),
    ("vprintf", PRINTS),
    ("__printf_chk", PRINTS),
    ("__vprintf_chk", PRINTS),
    ("wprintf", PRINTS),
    ("vwprintf", PRINTS),
    ("__wprintf_chk", PRINTS),
    ("__vwprintf_chk", PRINTS),
    ("puts", PRINTS),
    ("putchar", PRINTS),
    ("putchar_unlocked", PRINTS),
    ("putwchar", PRINTS),
    ("perror", PRINTS),
    ("fflush", "without an argument flushes the robot's own streams"),
    ("dprintf", PRINTS_TO),
    ("vdprintf", PRINTS_TO),
    ("__dprintf_chk", PRINTS_TO),
    ("__vdprintf_chk", PRINTS_TO),
    ("write", WRITES),
    ("writev", WRITES),
    ("fileno", "the robot's own streams have the descriptors 0 to 2"),
    ("read", "descriptor 0 is the robot's standard input"),
    ("__read_chk", "descriptor 0 is the robot's standard input"),
    ("close", "does not close descriptors 0 to 2, which belong to the host"),
    ("isatty", "always returns 0"),
    ("tcgetattr", "returns a zeroed termios"),
    ("tcsetattr", "succeeds without effect: no descriptor is a terminal"),
    ("fopen", OPENS),
    ("fopen64", OPENS_STREAM),
    ("fgetc", READS_ANY),
    ("getc", READS_ANY),
    ("_IO_getc", READS_ANY),
    ("fgets", READS_ANY),
    ("fread", READS_ANY),
    ("getdelim", READS_ANY),
    ("__getdelim", READS_ANY),
    ("getline", READS_ANY),
    ("fscanf", READS_ANY),
    ("__isoc99_fscanf", READS_ANY),
    ("__isoc23_fscanf", READS_ANY),
    ("getchar", READS),
    ("getchar_unlocked", READS),
    ("getwchar", READS),
    ("gets", READS),
    ("scanf", READS),
    ("vscanf", READS),
    ("__isoc99_scanf", READS),
    ("__isoc99_vscanf", READS),
    ("__isoc23_scanf", READS),
    ("__isoc23_vscanf", READS),
    ("__memcpy_chk", CHECKS),
    ("__mempcpy_chk", CHECKS),
    ("__memmove_chk", CHECKS),
    ("__memset_chk", CHECKS),
    ("__strcpy_chk", CHECKS),
    ("__stpcpy_chk", CHECKS),
    ("__strncpy_chk", CHECKS),
    ("__stpncpy_chk", CHECKS),
    ("__strcat_chk", CHECKS),
    ("__strncat_chk", CHECKS),
    ("__sprintf_chk", CHECKS),
    ("__vsprintf_chk", CHECKS),
    ("__snprintf_chk", CHECKS),
    ("__vsnprintf_chk", CHECKS),
    ("__fgets_chk", CHECKS),
    ("__fread_chk", CHECKS),
    ("longjmp", JUMPS),
    ("siglongjmp", JUMPS),
    ("__longjmp_chk", JUMPS),
    ("rand", DRAWS),
    ("srand", "restarts the robot's own stream of random numbers"),
    ("random", DRAWS),
    ("srandom", "restarts the robot's own stream of random numbers"),
    ("drand48", DRAWS48),
    ("lrand48", DRAWS48),
    ("mrand48", DRAWS48),
    ("erand48", STATE_GIVEN),
    ("nrand48", STATE_GIVEN),
    ("jrand48", STATE_GIVEN),
    ("srand48", "starts the sequence specified by POSIX"),
    ("seed48", "starts the sequence specified by POSIX"),
    ("lcong48", "starts the sequence specified by POSIX"),
    ("getrandom", DRAWS),
    ("getentropy", DRAWS),
    ("arc4random", DRAWS),
    ("arc4random_buf", DRAWS),
    ("arc4random_uniform", DRAWS),
    ("time", RETURNS_TIME),
    ("clock", RETURNS_TIME),
    ("gettimeofday", RETURNS_TIME),
    ("clock_gettime", RETURNS_TIME),
    ("clock_getres", "returns one microsecond"),
    ("timespec_get", RETURNS_TIME),
    ("times", RETURNS_TIME),
    ("ftime", RETURNS_TIME),
    ("sleep", PASSES),
    ("usleep", PASSES),
    ("nanosleep", PASSES),
    ("clock_nanosleep", PASSES),
    ("thrd_sleep", PASSES),
    ("pause", "blocks forever: no signal is delivered"),
    ("select", "without descriptors lets virtual time pass; with descriptors fails, with a message on the console"),
    ("poll", "without descriptors lets virtual time pass; with descriptors fails, with a message on the console"),
    ("__poll_chk", "without descriptors lets virtual time pass; with descriptors fails, with a message on the console"),
    ("alarm", REFUSES),
    ("ualarm", REFUSES),
    ("setitimer", REFUSES),
    ("timer_create", REFUSES),
    ("clock_settime", REFUSES),
    ("settimeofday", REFUSES),
    ("strtok", OWN_STATE),
    ("gmtime", OWN_STATE),
    ("localtime", UTC),
    ("localtime_r", UTC),
    ("mktime", UTC),
    ("asctime", OWN_STATE),
    ("ctime", UTC),
    ("ctime_r", UTC),
    ("ecvt", OWN_STATE),
    ("fcvt", OWN_STATE),
    ("getopt", OWN_STATE),
    ("getopt_long", OWN_STATE),
    ("optarg", OWN_STATE),
    ("optind", OWN_STATE),
    ("opterr", OWN_STATE),
    ("optopt", OWN_STATE),
    ("pthread_create", STARTS_TASK),
    ("pthread_join", ACTS_ON_TASKS),
    ("pthread_tryjoin_np", ACTS_ON_TASKS),
    ("pthread_timedjoin_np", ACTS_ON_TASKS),
    ("pthread_clockjoin_np", ACTS_ON_TASKS),
    ("pthread_detach", ACTS_ON_TASKS),
    ("pthread_exit", ACTS_ON_TASKS),
    ("pthread_self", ACTS_ON_TASKS),
    ("pthread_equal", ACTS_ON_TASKS),
    ("sched_yield", ACTS_ON_TASKS),
    ("pthread_yield", ACTS_ON_TASKS),
    ("pthread_once", ACTS_ON_TASKS),
    ("pthread_cancel", CANCELS),
    ("pthread_testcancel", CANCELS),
    ("pthread_setcancelstate", CANCELS),
    ("pthread_setcanceltype", CANCELS),
    ("__pthread_register_cancel", CANCELS),
    ("__pthread_unregister_cancel", CANCELS),
    ("__pthread_register_cancel_defer", CANCELS),
    ("__pthread_unregister_cancel_restore", CANCELS),
    ("__pthread_unwind_next", CANCELS),
    ("pthread_mutex_init", ACTS_ON_TASKS),
    ("pthread_mutex_destroy", ACTS_ON_TASKS),
    ("pthread_mutex_lock", ACTS_ON_TASKS),
    ("pthread_mutex_trylock", ACTS_ON_TASKS),
    ("pthread_mutex_timedlock", ACTS_ON_TASKS),
    ("pthread_mutex_clocklock", ACTS_ON_TASKS),
    ("pthread_mutex_unlock", ACTS_ON_TASKS),
    ("pthread_mutex_consistent", ACTS_ON_TASKS),
    ("pthread_spin_init", ACTS_ON_TASKS),
    ("pthread_spin_destroy", ACTS_ON_TASKS),
    ("pthread_spin_lock", ACTS_ON_TASKS),
    ("pthread_spin_trylock", ACTS_ON_TASKS),
    ("pthread_spin_unlock", ACTS_ON_TASKS),
    ("pthread_cond_init", ACTS_ON_TASKS),
    ("pthread_cond_destroy", ACTS_ON_TASKS),
    ("pthread_cond_wait", WAITS_TASK),
    ("pthread_cond_timedwait", WAITS_TASK),
    ("pthread_cond_clockwait", WAITS_TASK),
    ("pthread_cond_signal", ACTS_ON_TASKS),
    ("pthread_cond_broadcast", ACTS_ON_TASKS),
    ("flockfile", LOCKS_STREAM),
    ("ftrylockfile", LOCKS_STREAM),
    ("funlockfile", LOCKS_STREAM),
    ("sem_init", ACTS_ON_TASKS),
    ("sem_destroy", ACTS_ON_TASKS),
    ("sem_wait", WAITS_TASK),
    ("sem_trywait", ACTS_ON_TASKS),
    ("sem_clockwait", WAITS_TASK),
    ("sem_timedwait", WAITS_TASK),
    ("sem_post", ACTS_ON_TASKS),
    ("sem_getvalue", ACTS_ON_TASKS),
    ("sem_open", REFUSES),
    ("pthread_rwlock_init", ACTS_ON_TASKS),
    ("pthread_rwlock_destroy", ACTS_ON_TASKS),
    ("pthread_rwlock_rdlock", ACTS_ON_TASKS),
    ("pthread_rwlock_tryrdlock", ACTS_ON_TASKS),
    ("pthread_rwlock_timedrdlock", ACTS_ON_TASKS),
    ("pthread_rwlock_clockrdlock", ACTS_ON_TASKS),
    ("pthread_rwlock_wrlock", ACTS_ON_TASKS),
    ("pthread_rwlock_trywrlock", ACTS_ON_TASKS),
    ("pthread_rwlock_timedwrlock", ACTS_ON_TASKS),
    ("pthread_rwlock_clockwrlock", ACTS_ON_TASKS),
    ("pthread_rwlock_unlock", ACTS_ON_TASKS),
    ("pthread_barrier_init", ACTS_ON_TASKS),
    ("pthread_barrier_destroy", ACTS_ON_TASKS),
    ("pthread_barrier_wait", WAITS_TASK),
    ("pthread_key_create", ACTS_ON_TASKS),
    ("pthread_key_delete", ACTS_ON_TASKS),
    ("pthread_setspecific", ACTS_ON_TASKS),
    ("pthread_getspecific", ACTS_ON_TASKS),
    ("pthread_setname_np", ACCEPTED),
    ("pthread_getname_np", ACCEPTED),
    ("pthread_getattr_np", ACCEPTED),
    ("pthread_setschedparam", ACCEPTED),
    ("pthread_getschedparam", ACCEPTED),
    ("pthread_setschedprio", ACCEPTED),
    ("pthread_setaffinity_np", ACCEPTED),
    ("pthread_getaffinity_np", ACCEPTED),
    ("pthread_getcpuclockid", ACCEPTED),
    ("pthread_kill", REFUSES_SIGNAL),
    ("thrd_create", STARTS_TASK),
    ("thrd_join", ACTS_ON_TASKS),
    ("thrd_detach", ACTS_ON_TASKS),
    ("thrd_exit", ACTS_ON_TASKS),
    ("thrd_current", ACTS_ON_TASKS),
    ("thrd_equal", ACTS_ON_TASKS),
    ("thrd_yield", ACTS_ON_TASKS),
    ("mtx_init", ACTS_ON_TASKS),
    ("mtx_destroy", ACTS_ON_TASKS),
    ("mtx_lock", ACTS_ON_TASKS),
    ("mtx_trylock", ACTS_ON_TASKS),
    ("mtx_timedlock", ACTS_ON_TASKS),
    ("mtx_unlock", ACTS_ON_TASKS),
    ("call_once", ACTS_ON_TASKS),
    ("cnd_init", ACTS_ON_TASKS),
    ("cnd_destroy", ACTS_ON_TASKS),
    ("cnd_signal", ACTS_ON_TASKS),
    ("cnd_broadcast", ACTS_ON_TASKS),
    ("cnd_wait", WAITS_TASK),
    ("cnd_timedwait", WAITS_TASK),
    ("tss_create", ACTS_ON_TASKS),
    ("tss_delete", ACTS_ON_TASKS),
    ("tss_set", ACTS_ON_TASKS),
    ("tss_get", ACTS_ON_TASKS),
];

const ENDS: &str = "ends the robot's program after its `atexit` functions";
const ENDS_AT_ONCE: &str = "ends the robot's program immediately";
const FAILS: &str = "ends the robot's program as failed, with a message";
const REGISTERS: &str = "the function is called when the robot's program ends";
const PRINTS: &str = "prints to the robot's console, line by line";
const PRINTS_ANY: &str = "unchanged; on the robot's console, the robot can be stopped during the call";
const PRINTS_TO: &str = "descriptors 1 and 2 are the robot's console; others fail";
const WRITES: &str = "descriptors 1 and 2 are the robot's console";
const READS: &str = "reads the robot's standard input, `--stdin`";
const READS_ANY: &str = "unchanged; standard input is the robot's own";
const OPENS: &str = "opens the file; if this fails and the program then crashes, the message names the file";
const OPENS_STREAM: &str = "opens the file; in C++, whose streams call it, a failure is reported immediately";
const JUMPS: &str = "jumps; a jump out of a timer's function ends the robot's program as failed";
const CHECKS: &str = "a failed check ends the robot's program as failed, with a message";
const DRAWS: &str = "draws from the robot's own stream of random numbers";
const DRAWS48: &str = "the sequence specified by POSIX; without a seed each robot starts at its own position";
const STATE_GIVEN: &str = "the sequence specified by POSIX, from the given state";
const RETURNS_TIME: &str = "returns the robot's virtual time";
const PASSES: &str = "lets virtual time pass";
const REFUSES: &str = "does nothing, with a message on the console";
const OWN_STATE: &str = "state and result belong to the program's copy of the library, not to the process";
const UTC: &str = "local time is UTC on every machine; state and result belong to the program's copy of the library";
const STARTS_TASK: &str = "starts a task of the robot, see [Tasks](programs.md#tasks)";
const WAITS_TASK: &str = "waits; the robot's other tasks run in the meantime";
const ACTS_ON_TASKS: &str = "acts on the robot's tasks, in virtual time";
const LOCKS_STREAM: &str =
    "locks a stream against other tasks that request the lock; output lines are not interleaved even without it";
const CANCELS: &str = "takes effect in RoBIOS calls, and in calls of the C library that may wait";
const ACCEPTED: &str = "accepted without effect: names and attributes of tasks";
const REFUSES_SIGNAL: &str = "does nothing, with a message on the console unless the signal is 0";

/// Symbols that are not interposed although their effects reach beyond the robot or virtual time, with the reason.
pub const OUTSIDE_GUARANTEE: &[(&str, &str)] = &[
    ("fork", PROCESS),
    ("vfork", PROCESS),
    ("_Fork", PROCESS),
    ("clone", PROCESS),
    ("daemon", PROCESS),
    ("execl", PROCESS),
    ("execle", PROCESS),
    ("execlp", PROCESS),
    ("execv", PROCESS),
    ("execve", PROCESS),
    ("execvp", PROCESS),
    ("execvpe", PROCESS),
    ("posix_spawn", PROCESS),
    ("posix_spawnp", PROCESS),
    ("system", PROCESS),
    ("popen", PROCESS),
    ("execveat", PROCESS),
    ("fexecve", PROCESS),
    ("forkpty", PROCESS),
    ("setsid", PROCESS),
    ("setpgid", PROCESS),
    ("setpgrp", PROCESS),
    ("ptrace", PROCESS),
    ("unshare", PROCESS),
    ("wait", PROCESS),
    ("waitpid", PROCESS),
    ("kill", SIGNAL),
    ("killpg", SIGNAL),
    ("raise", SIGNAL),
    ("gsignal", SIGNAL),
    ("tgkill", SIGNAL),
    ("sigqueue", SIGNAL),
    ("signal", SIGNAL),
    ("__sysv_signal", SIGNAL),
    ("bsd_signal", SIGNAL),
    ("ssignal", SIGNAL),
    ("sigset", SIGNAL),
    ("sigignore", SIGNAL),
    ("sigaction", SIGNAL),
    ("sigaltstack", SIGNAL),
    ("sigprocmask", SIGNAL),
    ("pthread_sigmask", SIGNAL),
    ("sigsuspend", SIGNAL),
    ("sigwait", SIGNAL),
    ("GOMP_parallel", THREAD),
    ("__kmpc_fork_call", THREAD),
    ("setenv", SHARED),
    ("putenv", SHARED),
    ("unsetenv", SHARED),
    ("clearenv", SHARED),
    ("getenv", "reads the environment, which differs between machines"),
    ("secure_getenv", "reads the environment, which differs between machines"),
    ("setlocale", SHARED),
    ("uselocale", SHARED),
    ("tzset", SHARED),
    ("chdir", FOLDER),
    ("fchdir", FOLDER),
    ("chroot", FOLDER),
    ("setuid", RIGHTS),
    ("seteuid", RIGHTS),
    ("setreuid", RIGHTS),
    ("setresuid", RIGHTS),
    ("setgid", RIGHTS),
    ("setegid", RIGHTS),
    ("setregid", RIGHTS),
    ("setresgid", RIGHTS),
    ("umask", SHARED),
    ("setrlimit", LIMIT),
    ("setrlimit64", LIMIT),
    ("prlimit", LIMIT),
    ("prlimit64", LIMIT),
    ("prctl", LIMIT),
    ("freopen", "may redirect a robot's stream"),
    ("dup", DESCRIPTOR),
    ("dup2", DESCRIPTOR),
    ("dup3", DESCRIPTOR),
    ("close_range", DESCRIPTOR),
    ("closefrom", DESCRIPTOR),
    ("readv", DESCRIPTOR),
    ("ioctl", "changes the terminal of the host"),
    ("dlopen", "the functions of a library loaded this way are not interposed"),
    ("dlmopen", "the functions of a library loaded this way are not interposed"),
    ("initstate", GENERATOR),
    ("setstate", GENERATOR),
    ("hcreate", SHARED),
    ("socket", NETWORK),
    ("connect", NETWORK),
    ("gethostname", "differs between machines"),
    ("getpid", "differs between runs"),
    ("getrusage", REAL_TIME),
    ("ppoll", REAL_TIME),
    ("pselect", REAL_TIME),
    ("epoll_wait", REAL_TIME),
    ("timerfd_create", REAL_TIME),
    ("syscall", SYSTEM),
    ("_ZSt4cout", STREAMS),
    ("_ZSt4cerr", STREAMS),
    ("_ZSt4clog", STREAMS),
    ("_ZSt3cin", STREAMS),
];

const PROCESS: &str = "starts or waits for processes, which are copies of the host";
const SIGNAL: &str = "signals belong to the process, which is the host";
const THREAD: &str = "threads other than the robot's tasks do not run in virtual time";
const LIMIT: &str = "changes the limits of the process, which is the host";
const SYSTEM: &str = "bypasses the shim";
const SHARED: &str = "changes state that all robots and the host share";
const FOLDER: &str = "changes the folder to which paths of all robots and the host refer";
const RIGHTS: &str = "changes the rights of the process, which is the host";
const DESCRIPTOR: &str = "affects the host's input and output";
const GENERATOR: &str = "changes the generator that all robots share";
const NETWORK: &str = "data from a network differ between runs";
const REAL_TIME: &str = "waits for or returns real time";
const STREAMS: &str = "streams of C++ print to the host's standard output";

/// Reason why calls of `symbol` by a library built without the shim may act outside of the robot or of virtual time;
/// `None` if they do not.
///
/// In such a library this holds for most [interposed](INTERPOSED) symbols too. Exceptions are symbols that almost every
/// library imports, and symbols whose original functions are harmless there.
pub fn outside_guarantee(symbol: &str) -> Option<&'static str> {
    let reason = |list: &[(&str, &'static str)]| list.iter().find(|(name, _)| *name == symbol).map(|(_, text)| *text);
    let is_harmless = |behaviour: &str| {
        [PRINTS_ANY, OPENS, OPENS_STREAM, CHECKS, JUMPS, STATE_GIVEN, ACTS_ON_TASKS, LOCKS_STREAM, CANCELS, ACCEPTED]
            .contains(&behaviour)
    };
    let is_common = ["__cxa_atexit", "__cxa_thread_atexit_impl", "__stack_chk_fail", "__chk_fail"].contains(&symbol);
    match reason(INTERPOSED) {
        Some(behaviour) if is_harmless(behaviour) || is_common => None,
        Some(_) => Some("acts on the process, not on the robot, in a library built without the shim"),
        None => reason(OUTSIDE_GUARANTEE),
    }
}

/// Returns the reason why a program that imports `symbol` could end the host, or disturb all robots, if it ran on a
/// thread of the host; `None` for other symbols.
///
/// A library without the shim that imports `exit` or a function of the same kind ends the process itself.
pub fn endangers_host(symbol: &str) -> Option<&'static str> {
    const PROCESS_ENDING: [&str; 9] = ["exit", "_exit", "_Exit", "quick_exit", "err", "errx", "verr", "verrx", "error"];
    if PROCESS_ENDING.contains(&symbol) {
        return Some("ends the process, which is the host");
    }
    let reason = OUTSIDE_GUARANTEE.iter().find(|(name, _)| *name == symbol).map(|(_, text)| *text)?;
    [PROCESS, SIGNAL, DESCRIPTOR, LIMIT, FOLDER, RIGHTS, SYSTEM].contains(&reason).then_some(reason)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_that_end_the_host_are_distinguished_from_those_that_differ_between_runs() {
        for dangerous in
            ["execve", "fork", "dup2", "close_range", "sigaction", "syscall", "prlimit", "_exit", "setsid", "chdir"]
        {
            assert!(endangers_host(dangerous).is_some(), "{dangerous}");
        }
        for harmless in ["getenv", "time", "printf", "malloc", "abort", "pthread_create", "VWInit", "dlopen"] {
            assert_eq!(endangers_host(harmless), None, "{harmless}");
        }
    }

    #[test]
    fn symbols_that_every_library_imports_cause_no_warning() {
        for harmless in
            ["__cxa_atexit", "__stack_chk_fail", "fwrite", "__memcpy_chk", "erand48", "fopen", "strlen", "VWInit"]
        {
            assert_eq!(outside_guarantee(harmless), None, "{harmless}");
        }
        for warned in ["exit", "rand", "time", "printf", "stdout", "fork", "pthread_create"] {
            assert!(outside_guarantee(warned).is_some(), "{warned}");
        }
    }

    #[test]
    fn no_symbol_is_in_both_lists_or_twice() {
        let mut names: Vec<_> = INTERPOSED.iter().chain(OUTSIDE_GUARANTEE).map(|(name, _)| name).collect();
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
