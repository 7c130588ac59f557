//! The catalogue of hostile robot programs as data; some are composed of parts.

/// Language of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// C of RoBIOS 6.
    C,
    /// C of RoBIOS-7.
    C7,
    Cpp,
    Python,
    Rust,
}

/// A hostile program.
#[derive(Clone, Debug)]
pub struct Case {
    pub class: &'static str,
    pub name: String,
    pub language: Language,
    /// Source text; for Rust the name of a case in [`RUST`], or `constructor NAME` (see [`CONSTRUCTOR`]).
    pub source: String,
    /// The message must contain one of these texts; empty if the program may end well.
    pub expected: &'static [&'static str],
}

use Language::{C, C7, Cpp, Python, Rust};

/// Crashes: name, statements in C, expected texts.
const CRASHES: &[(&str, &str, &[&str])] = &[
    ("null write", "*(volatile int *)0 = 1;", &["segmentation fault at address 0x0"]),
    ("null read", "sink = *(volatile int *)8;", &["segmentation fault at address 0x8"]),
    ("null call", "((void (*)(void))(intptr_t)sink0)();", &["segmentation fault at address 0x0"]),
    ("wild pointer", "*(volatile int *)0x4141414141414141 = 1;", &["segmentation fault"]),
    ("constant written", "*(volatile char *)(intptr_t)\"text\" = 1;", &["segmentation fault"]),
    ("division by zero", "sink = 100 / sink0;", &["integer division by zero"]),
    ("stack overflow", "sink = deep(1);", &["stack overflow"]),
    ("illegal instruction", "__builtin_trap();", &["illegal instruction"]),
    ("breakpoint", "__asm__ volatile(\"int3\");", &["trap instruction"]),
    ("abort", "abort();", &["called abort"]),
    ("assertion", "assert(sink0 == 1);", &["assertion failed"]),
    ("endless loop", "for (;;) ;", &["too long without a RoBIOS call"]),
    (
        "floating-point trap",
        "feenableexcept(FE_DIVBYZERO); sinkd = 1 / zero; sink = sinkd;",
        &["floating-point division by zero"],
    ),
    ("exit with 3", "exit(3);", &["exit code 3"]),
];

/// Places of a crash: name, and the program around `CRASH`.
const PLACES: &[(&str, &str)] = &[
    ("main", "int main(void) { OSWait(20); CRASH return 0; }"),
    ("timer", "static void f(void) { CRASH } int main(void) { OSAttachTimer(10, f); OSWait(50); return 0; }"),
    (
        "task",
        "static void *f(void *p) { CRASH return p; } int main(void) { pthread_t t; OSWait(20); pthread_create(&t, 0, f, 0); pthread_join(t, 0); return 0; }",
    ),
    (
        "constructor",
        "__attribute__((constructor)) static void f(void) { CRASH } int main(void) { OSWait(20); return 0; }",
    ),
    ("atexit", "static void f(void) { CRASH } int main(void) { OSWait(20); atexit(f); return 0; }"),
    (
        "qsort",
        "static int f(const void *a, const void *b) { CRASH return a < b; } int main(void) { int l[2] = {2, 1}; OSWait(20); qsort(l, 2, sizeof *l, f); return 0; }",
    ),
];

/// More programs in C: class, name, statements of `main` after a wait, expected texts.
const BODIES: &[(&str, &str, &str, &[&str])] = &[
    ("loops", "asleep in the kernel", "for (;;) syscall(SYS_pause);", &["too long without a RoBIOS call"]),
    (
        "loops",
        "futex that nobody wakes",
        "{ int w = 0; syscall(SYS_futex, &w, 0, 0, 0); }",
        &["too long without a RoBIOS call"],
    ),
    (
        "loops",
        "read of a pipe without a writer",
        "{ int p[2]; char c; pipe(p); syscall(SYS_read, p[0], &c, 1); }",
        &["too long without a RoBIOS call"],
    ),
    (
        "loops",
        "spin on a locked mutex",
        "{ pthread_mutex_t m = PTHREAD_MUTEX_INITIALIZER; pthread_mutex_lock(&m); pthread_mutex_lock(&m); }",
        &[],
    ),
    ("loops", "loop around a call", "for (;;) OSGetCount();", &[]),
    ("loops", "busy wait for a key", "while (KEYRead() == 0) ;", &[]),
    ("loops", "key that is never pressed", "KEYWait(KEY4);", &[]),
    (
        "loops",
        "loop without virtual time in setjmp",
        "{ jmp_buf j; setjmp(j); longjmp(j, 1); }",
        &["too long without a RoBIOS call"],
    ),
    ("stack", "array overrun by a little", "overrun(24);", &["segmentation fault", "illegal"]),
    (
        "stack",
        "array overrun far",
        "overrun(6000);",
        &["beyond the top of its stack", "segmentation fault", "an invalid message"],
    ),
    ("stack", "array overrun, protected", "smash(24);", &["stack smashed"]),
    ("stack", "array overrun far, protected", "smash(600);", &["stack smashed"]),
    (
        "stack",
        "array overrun into the host, protected",
        "smash(6000);",
        &["beyond the top of its stack", "stack smashed", "an invalid message", "has overwritten"],
    ),
    (
        "stack",
        "array of 1 GB",
        "{ volatile char big[1 << 30]; big[0] = 1; sink = big[0]; }",
        &["segmentation fault", "stack overflow"],
    ),
    (
        "stack",
        "alloca of 100 MB",
        "{ volatile char *p = alloca(100 << 20); p[0] = 1; }",
        &["segmentation fault", "stack overflow"],
    ),
    (
        "stack",
        "own alternate stack taken away",
        "{ stack_t s = {.ss_flags = SS_DISABLE}; sigaltstack(&s, 0); sink = deep(1); }",
        &["killed by signal 11", "stack overflow", "segmentation fault"],
    ),
    ("heap", "freed twice", "sinkp = malloc(100); free(sinkp); free(sinkp);", &["aborted by the C library"]),
    (
        "heap",
        "freed twice, with the allocator locked",
        "{ char *p = sinkp = malloc(1440); sinkp = malloc(4); free(p); free(p); }",
        &["aborted by the C library", "segmentation fault"],
    ),
    ("heap", "freed wildly", "free((void *)(intptr_t)0x1000);", &["segmentation fault", "aborted"]),
    ("heap", "freed in the middle", "sinkp = malloc(100); free((char *)sinkp + 8);", &["aborted", "none of `malloc`"]),
    (
        "heap",
        "written beyond the end",
        "{ char *p = sinkp = malloc(24), *q = malloc(24); memset(p, 255, 4096); sinkp = q; free(q); free(p); sinkp = malloc(5000); }",
        &["aborted", "segmentation fault", "written beyond its end", "finished"],
    ),
    (
        "heap",
        "used after free",
        "{ char *p = malloc(100); free(p); memset(p, 65, 100); malloc(100); malloc(100); free(malloc(100)); }",
        &[],
    ),
    (
        "heap",
        "all memory",
        "for (;;) { volatile char *p = malloc(1 << 20); if (!p) abort(); p[0] = 1; }",
        &["called abort", "killed by signal", "without a RoBIOS call"],
    ),
    (
        "heap",
        "mapping of everything unmapped",
        "munmap((void *)((intptr_t)&sink & -4096), 4096); sink = 2;",
        &["segmentation fault"],
    ),
    (
        "signals",
        "SIGSEGV handler that returns",
        "signal(SIGSEGV, nothing); *(volatile int *)0 = 1;",
        &["segmentation fault", "too long without a RoBIOS call"],
    ),
    (
        "signals",
        "SIGSEGV handler that returns, in a call",
        "signal(SIGSEGV, nothing); VWGetPosition(VWInit(VW_DRIVE, 1), (PositionType *)16);",
        &["segmentation fault", "too long without a RoBIOS call"],
    ),
    (
        "signals",
        "SIGSEGV handler that jumps",
        "signal(SIGSEGV, jumps); if (sigsetjmp(place, 1) == 0) *(volatile int *)0 = 1;",
        &[],
    ),
    (
        "signals",
        "SIGSEGV ignored",
        "signal(SIGSEGV, SIG_IGN); *(volatile int *)0 = 1;",
        &["segmentation fault", "killed by signal 11"],
    ),
    (
        "signals",
        "SIGSEGV by default",
        "signal(SIGSEGV, SIG_DFL); *(volatile int *)0 = 1;",
        &["segmentation fault", "killed by signal 11"],
    ),
    (
        "signals",
        "SIGFPE handler that returns",
        "signal(SIGFPE, nothing); sink = 100 / sink0;",
        &["arithmetic fault", "too long without a RoBIOS call"],
    ),
    (
        "signals",
        "all signals blocked",
        "{ unsigned long all = ~0UL; syscall(SYS_rt_sigprocmask, SIG_BLOCK, &all, 0, 8); for (;;) ; }",
        &["too long without a RoBIOS call"],
    ),
    ("signals", "SIGURG ignored", "signal(SIGURG, SIG_IGN); for (;;) ;", &["too long without a RoBIOS call"]),
    ("signals", "SIGURG handled", "signal(SIGURG, nothing); for (;;) ;", &["too long without a RoBIOS call"]),
    (
        "signals",
        "Ctrl-C ignored",
        "signal(SIGINT, SIG_IGN); signal(SIGTERM, SIG_IGN); for (;;) ;",
        &["too long without a RoBIOS call"],
    ),
    ("signals", "raise(SIGSEGV)", "raise(SIGSEGV);", &["the signal SIGSEGV", "killed by signal 11"]),
    ("signals", "raise(SIGFPE)", "raise(SIGFPE);", &["the signal SIGFPE", "killed by signal 8"]),
    ("signals", "raise(SIGTRAP)", "raise(SIGTRAP);", &["the signal SIGTRAP", "killed by signal 5"]),
    ("signals", "raise(SIGSTOP)", "raise(SIGSTOP);", &["SIGSTOP"]),
    ("signals", "raise(SIGTSTP)", "raise(SIGTSTP);", &[]),
    ("signals", "raise(SIGKILL)", "raise(SIGKILL);", &["killed by signal 9"]),
    ("signals", "raise(SIGTERM)", "raise(SIGTERM);", &[]),
    ("signals", "raise(SIGINT)", "raise(SIGINT);", &[]),
    ("signals", "raise(SIGHUP)", "raise(SIGHUP);", &[]),
    ("signals", "raise(SIGPIPE)", "raise(SIGPIPE);", &[]),
    ("signals", "raise(SIGUSR1)", "raise(SIGUSR1);", &["killed by signal 10"]),
    ("signals", "raise(SIGALRM)", "raise(SIGALRM);", &["killed by signal 14"]),
    ("signals", "raise(SIGABRT)", "raise(SIGABRT);", &["aborted", "killed by signal 6"]),
    ("signals", "SIGKILL to its process", "kill(getpid(), SIGKILL);", &["killed by signal 9"]),
    ("signals", "SIGKILL to its group", "kill(0, SIGKILL);", &["killed by signal 9"]),
    ("signals", "SIGTERM to its group", "kill(0, SIGTERM);", &[]),
    ("signals", "alarm", "alarm(1); OSWait(300);", &[]),
    (
        "signals",
        "timer of the kernel",
        "{ struct itimerval t = {{0, 1000}, {0, 1000}}; syscall(SYS_setitimer, ITIMER_REAL, &t, 0); for (;;) ; }",
        &["killed by signal 14", "too long without a RoBIOS call"],
    ),
    (
        "signals",
        "limit of processor time",
        "{ struct rlimit l = {1, 1}; syscall(SYS_setrlimit, RLIMIT_CPU, &l); for (;;) ; }",
        &["too long without a RoBIOS call", "killed by signal"],
    ),
    ("ends", "exit(0)", "exit(0);", &[]),
    ("ends", "_exit(0)", "_exit(0);", &[]),
    ("ends", "quick_exit(2)", "quick_exit(2);", &["exit code 2"]),
    ("ends", "raw exit_group(0)", "syscall(SYS_exit_group, 0);", &["without a message", "exit_group"]),
    ("ends", "raw exit_group(7)", "syscall(SYS_exit_group, 7);", &["exit code 7", "exit_group"]),
    ("ends", "raw exit of the thread", "syscall(SYS_exit, 0);", &["ended its own thread", "without a message"]),
    ("ends", "pthread_exit", "pthread_exit(0);", &[]),
    ("ends", "execve", "{ char *a[] = {\"true\", 0}; execve(\"/bin/true\", a, 0); }", &["without a message", "execve"]),
    (
        "ends",
        "execvp of what is not there",
        "{ char *a[] = {\"nothing\", 0}; if (execvp(\"/nothing/there\", a) < 0) exit(4); }",
        &["exit code 4", "execve"],
    ),
    (
        "ends",
        "raw execve",
        "{ char *a[] = {\"true\", 0}; syscall(SYS_execve, \"/bin/true\", a, 0); }",
        &["without a message", "execve"],
    ),
    (
        "ends",
        "longjmp to a function that has returned",
        "keep(); longjmp(place, 1);",
        &["segmentation fault", "without a RoBIOS call", "stack", "illegal", "aborted", "cannot be left"],
    ),
    ("ends", "exit within exit", "atexit(again); exit(5);", &["exit code 5", "exit code 6"]),
    ("ends", "ten thousand atexit", "{ int i; for (i = 0; i < 10000; i++) atexit(quiet); }", &[]),
    (
        "descriptors",
        "dup2 over all",
        "{ int i, n = open(\"/dev/null\", O_RDWR); for (i = 0; i < 256; i++) if (i != n) dup2(n, i); } OSWait(50);",
        &[],
    ),
    ("descriptors", "close_range over all", "close_range(0, ~0U, 0); OSWait(50);", &[]),
    ("descriptors", "close of all", "{ int i; for (i = 3; i < 256; i++) close(i); } OSWait(50);", &[]),
    ("descriptors", "trace deleted", "unlink(\"t.jsonl\"); OSWait(50);", &["not complete"]),
    ("descriptors", "trace cut", "truncate(\"t.jsonl\", 10); OSWait(50);", &["not complete"]),
    ("descriptors", "trace replaced", "rename(\"scene.sim\", \"t.jsonl\"); OSWait(50);", &["not complete"]),
    ("descriptors", "folder removed", "rmdir(\".\"); chdir(\"/\"); OSWait(50);", &[]),
    ("descriptors", "descriptors used up", "while (open(\"/dev/null\", O_RDONLY) >= 0) ; OSWait(50);", &[]),
    ("descriptors", "standard output closed", "fclose(stdout); printf(\"x\"); OSWait(5);", &[]),
    ("descriptors", "standard input read", "while (getchar() != EOF) ; OSWait(5);", &[]),
    (
        "descriptors",
        "host's memory read",
        "{ int f = open(\"/proc/self/mem\", O_RDWR); int one = 1; lseek(f, (long)&sink, SEEK_SET); write(f, &one, 4); }",
        &[],
    ),
    (
        "descriptors",
        "channel of the process cut",
        "{ int i; for (i = 0; i < 64; i++) ftruncate(i, 0); } OSWait(50);",
        &[],
    ),
    ("limits", "file size 0", "{ struct rlimit l = {0, 0}; setrlimit(RLIMIT_FSIZE, &l); } OSWait(50);", &[]),
    ("limits", "no descriptors", "{ struct rlimit l = {0, 0}; setrlimit(RLIMIT_NOFILE, &l); } OSWait(50);", &[]),
    (
        "limits",
        "no memory",
        "{ struct rlimit l = {1 << 20, 1 << 20}; setrlimit(RLIMIT_AS, &l); } OSWait(50); malloc(1 << 24);",
        &[],
    ),
    ("limits", "no stack", "{ struct rlimit l = {4096, 4096}; setrlimit(RLIMIT_STACK, &l); } OSWait(50);", &[]),
    ("limits", "nice to nobody", "syscall(SYS_setpriority, 0, 0, 19); OSWait(50);", &[]),
    ("floods", "prints for ever", "for (;;) printf(\"flood\\n\");", &[]),
    ("floods", "prints one endless line", "for (;;) printf(\"flood\");", &[]),
    ("floods", "prints to standard error", "for (;;) fprintf(stderr, \"flood\\n\");", &[]),
    ("floods", "draws for ever", "for (;;) LCDPrintf(\"flood\\n\");", &[]),
    (
        "floods",
        "escapes of the terminal",
        "printf(\"\\033]0;owned\\007\\033[2J\\n\"); OSPanic(\"\\033[2Jpanic\");",
        &["panic"],
    ),
    (
        "floods",
        "line of a megabyte",
        "{ char *p = malloc(1 << 20); memset(p, 'x', 1 << 20); p[(1 << 20) - 1] = 0; puts(p); }",
        &[],
    ),
    (
        "threads",
        "detached thread that loops",
        "{ pthread_t t; pthread_create(&t, 0, spin, 0); pthread_detach(t); OSWait(20); }",
        &[],
    ),
    ("threads", "join with itself", "pthread_join(pthread_self(), 0);", &[]),
    (
        "threads",
        "two locks crossed",
        "{ pthread_t t; pthread_mutex_lock(&one); pthread_create(&t, 0, crossed, 0); OSWait(10); pthread_mutex_lock(&two); }",
        &[],
    ),
    (
        "threads",
        "two hundred and fifty tasks",
        "{ int i; pthread_t t; for (i = 0; i < 250; i++) pthread_create(&t, 0, idle, 0); OSWait(20); }",
        &[],
    ),
    ("threads", "tasks without end", "{ pthread_t t; while (pthread_create(&t, 0, idle, 0) == 0) ; OSWait(20); }", &[]),
    ("threads", "semaphore that nobody posts", "{ sem_t s; sem_init(&s, 0, 0); sem_wait(&s); }", &[]),
    (
        "threads",
        "foreign thread that crashes",
        "foreign(crashes); OSWait(300);",
        &["started by itself", "segmentation", "killed by signal 11"],
    ),
    ("threads", "foreign thread that loops", "foreign(spins); OSWait(20);", &[]),
    ("threads", "foreign thread that calls", "foreign(calls); OSWait(20);", &[]),
    ("forks", "fork that loops", "if (fork() == 0) for (;;) ; OSWait(50);", &[]),
    ("forks", "fork that calls", "if (fork() == 0) { OSWait(10); exit(0); } OSWait(50);", &[]),
    ("forks", "fork that crashes", "if (fork() == 0) *(volatile int *)0 = 1; OSWait(50);", &[]),
    ("forks", "raw fork", "if (syscall(SYS_fork) == 0) for (;;) syscall(SYS_pause); OSWait(50);", &[]),
    (
        "forks",
        "daemon with a session",
        "if (fork() == 0) { setsid(); if (fork() == 0) for (;;) syscall(SYS_pause); syscall(SYS_exit_group, 0); } OSWait(50);",
        &[],
    ),
    (
        "forks",
        "vfork that hangs",
        "if (vfork() == 0) for (;;) syscall(SYS_pause); OSWait(50);",
        &["too long without a RoBIOS call"],
    ),
    (
        "forks",
        "thirty forks",
        "{ int i; for (i = 0; i < 30; i++) if (fork() == 0) for (;;) syscall(SYS_pause); } OSWait(50);",
        &[],
    ),
    ("forks", "system", "if (system(\"exit 3\") != 0x300) exit(9); OSWait(5);", &[]),
    ("forks", "system that hangs", "system(\"sleep 1000\"); OSWait(5);", &[]),
    (
        "forks",
        "popen",
        "{ char b[9]; FILE *f = popen(\"echo hi\", \"r\"); if (!f || !fgets(b, 9, f)) exit(9); pclose(f); }",
        &[],
    ),
    ("forks", "wait for a child that is not", "wait(0); OSWait(5);", &[]),
    (
        "jumps",
        "longjmp out of a timer",
        "if (setjmp(place) == 0) { OSAttachTimer(10, jump_out); OSWait(50); } OSWait(50);",
        &["longjmp out of a timer"],
    ),
    (
        "jumps",
        "longjmp between tasks",
        "{ pthread_t t; if (setjmp(place) == 0) { pthread_create(&t, 0, jump_task, 0); OSWait(50); } }",
        &[],
    ),
    (
        "jumps",
        "own stack",
        "{ static char s[65536]; ucontext_t a, b; getcontext(&b); b.uc_stack.ss_sp = s; b.uc_stack.ss_size = sizeof s; b.uc_link = &a; makecontext(&b, on_own_stack, 0); swapcontext(&a, &b); }",
        &[],
    ),
    ("calls", "wait of the longest time", "OSWait(2147483647);", &[]),
    ("calls", "negative wait", "OSWait(-2147483647 - 1);", &[]),
    ("calls", "timer of every tick", "{ int i; for (i = 0; i < 1000; i++) OSAttachTimer(1, quiet); } OSWait(20);", &[]),
    ("calls", "timer that waits", "OSAttachTimer(1, waits); OSWait(20);", &["timer", "OSWait"]),
    ("calls", "null into every call", "NULLS", &[]),
    (
        "calls",
        "drive of not a number",
        "{ VWHandle v = VWInit(VW_DRIVE, 1); VWDriveStraight(v, 0.0 / zero, 1 / zero); VWDriveWait(v); }",
        &[],
    ),
    (
        "calls",
        "drive of infinite speed",
        "{ VWHandle v = VWInit(VW_DRIVE, 1); VWSetSpeed(v, 1e300 * 1e300, -1e300 * 1e300); OSWait(50); }",
        &[],
    ),
    ("calls", "drive with a wild handle", "VWDriveStraight(0x7fffffff, 1, 1); VWDriveWait(0x7fffffff);", &[]),
    (
        "calls",
        "position to a wild pointer",
        "VWGetPosition(VWInit(VW_DRIVE, 1), (PositionType *)16);",
        &["segmentation fault at address 0x1"],
    ),
    (
        "calls",
        "text without an end",
        "{ char *p = mmap(0, 8192, 3, 34, -1, 0); memset(p, 'x', 8192); mprotect(p + 4096, 4096, 0); LCDPutString(p); }",
        &["segmentation fault"],
    ),
    ("calls", "format of a wild string", "LCDPrintf(\"%s\", (char *)16);", &["segmentation fault at address 0x1"]),
    ("calls", "format that writes", "{ int n; LCDPrintf(\"%s%n\", \"abc\", &n); }", &[]),
    ("calls", "every number into every call", "NUMBERS", &[]),
    ("libraries", "dlopen of what is not there", "if (dlopen(\"/nothing\", RTLD_NOW)) exit(9); OSWait(5);", &[]),
    ("libraries", "dlclose of itself", "{ void *h = dlopen(0, RTLD_NOW); dlclose(h); dlclose(h); } OSWait(5);", &[]),
    (
        "memory",
        "own text zeroed through /proc/self/mem",
        "{ static char z[4096]; int f = open(\"/proc/self/mem\", O_RDWR); pwrite(f, z, 4096, (long)&crashes & -4096); crashes(0); }",
        &["segmentation fault", "illegal"],
    ),
    (
        "memory",
        "own stack unmapped",
        "munmap((void *)(((intptr_t)&sinkp, (intptr_t)__builtin_frame_address(0)) & -4096), 4096); sink = 1;",
        &["segmentation fault", "killed by signal 11"],
    ),
    (
        "memory",
        "zeros mapped over the own stack",
        "{ intptr_t at = (intptr_t)__builtin_frame_address(0) & -4096; mmap((void *)(at - 65536), 65536 + 4096, 3, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0); }",
        &["segmentation fault", "killed by signal 11", "smashed"],
    ),
    (
        "memory",
        "own stack read-only",
        "mprotect((void *)(((intptr_t)__builtin_frame_address(0) & -4096) - 8192), 8192, PROT_READ); OSWait(5); sink = deep(1);",
        &["segmentation fault", "stack overflow", "killed by signal 11", "harmed eyesim"],
    ),
    (
        "memory",
        "own variables read-only",
        "mprotect((void *)((intptr_t)&sink & -4096), 4096, PROT_READ); sink = 7;",
        &["segmentation fault"],
    ),
    (
        "memory",
        "own text unmapped",
        "munmap((void *)((intptr_t)&crashes & -4096), 4096); crashes(0);",
        &["segmentation fault"],
    ),
    (
        "memory",
        "memfd of a terabyte",
        "{ int f = memfd_create(\"big\", 0); volatile char *p; if (ftruncate(f, 1L << 40) < 0) exit(4); p = mmap(0, 1L << 40, 3, MAP_SHARED, f, 0); p[0] = 1; }",
        &["exit code 4", "segmentation fault", "killed by signal"],
    ),
    (
        "memory",
        "mappings without end",
        "while (mmap(0, 4096, sink++ % 2 ? 1 : 3, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) != MAP_FAILED) ; OSWait(50);",
        &[],
    ),
    (
        "memory",
        "stack below by a gigabyte",
        "{ volatile char *p = (volatile char *)&p - (1 << 30); p[0] = 1; }",
        &["segmentation fault", "killed by signal 11", "stack overflow", "illegal instruction"],
    ),
    (
        "signals",
        "alternate stack in a variable",
        "{ static char s[2048]; stack_t t = {.ss_sp = s, .ss_size = sizeof s}; sigaltstack(&t, 0); *(volatile int *)0 = 1; }",
        &["segmentation fault", "killed by signal 11"],
    ),
    (
        "signals",
        "alternate stack that is not mapped",
        "{ stack_t t = {.ss_sp = (void *)4096, .ss_size = 65536}; sigaltstack(&t, 0); *(volatile int *)0 = 1; }",
        &["segmentation fault", "killed by signal 11"],
    ),
    (
        "signals",
        "storm of SIGURG from a thread",
        "victim = syscall(SYS_gettid); foreign(storm); for (;;) OSWait(1);",
        &[],
    ),
    (
        "signals",
        "kernel timer that kills",
        "{ timer_t t; struct sigevent e = {.sigev_notify = SIGEV_SIGNAL, .sigev_signo = SIGKILL}; struct itimerspec i = {{0, 0}, {0, 1000000}}; timer_create(CLOCK_REALTIME, &e, &t); timer_settime(t, 0, &i, 0); for (;;) ; }",
        &["timer_create", "too long without a RoBIOS call"],
    ),
    (
        "signals",
        "timer of the kernel during calls",
        "{ struct itimerval t = {{0, 100}, {0, 100}}; int i; signal(SIGALRM, nothing); syscall(SYS_setitimer, ITIMER_REAL, &t, 0); for (i = 0; i < 100; i++) OSWait(1); }",
        &[],
    ),
    ("signals", "SIGABRT handled, then abort", "signal(SIGABRT, nothing); abort();", &["abort"]),
    ("signals", "SIGSTOP to the parent", "kill(getppid(), SIGSTOP); OSWait(50);", &[]),
    ("signals", "SIGKILL to the parent", "kill(getppid(), SIGKILL); OSWait(50);", &[]),
    ("signals", "SIGSTOP to everybody", "kill(-1, SIGSTOP); OSWait(50);", &[]),
    ("ends", "exit_group(0) in assembly", "RAW(SYS_exit_group, 0);", &["without a message", "exit_group"]),
    (
        "ends",
        "exit_group(0) in assembly, on another thread",
        "foreign(leaves); OSWait(300);",
        &["without a message", "exit_group", "started by itself"],
    ),
    (
        "ends",
        "exit_group(0) in assembly of 32 bits",
        "__asm__ volatile(\"int $0x80\" : : \"a\"(252), \"b\"(0) : \"memory\");",
        &[],
    ),
    (
        "ends",
        "execve in assembly",
        "{ static char *a[] = {\"/bin/true\", 0}; register char **e __asm__(\"rdx\") = 0; __asm__ volatile(\"syscall\" : : \"a\"(SYS_execve), \"D\"(*a), \"S\"(a), \"r\"(e) : \"rcx\", \"r11\", \"memory\"); }",
        &["without a message", "execve"],
    ),
    ("ends", "atexit that registers itself", "atexit(anew);", &["too long without a RoBIOS call", "exit"]),
    ("ends", "_exit in a timer", "OSAttachTimer(10, leave_raw); OSWait(50);", &[]),
    (
        "tracing",
        "ptrace(TRACEME), then a loop",
        "ptrace(PTRACE_TRACEME, 0, 0, 0); for (;;) ;",
        &["too long without a RoBIOS call", "ptrace"],
    ),
    (
        "tracing",
        "ptrace(TRACEME), then a signal",
        "ptrace(PTRACE_TRACEME, 0, 0, 0); raise(SIGUSR1); OSWait(50);",
        &["signal", "ptrace", "stopped"],
    ),
    (
        "tracing",
        "traced by its own child, then a loop",
        "{ pid_t own = getpid(); prctl(PR_SET_PTRACER, -1L, 0, 0, 0); if (fork() == 0) { ptrace(PTRACE_SEIZE, own, 0, 0); for (;;) syscall(SYS_pause); } for (;;) ; }",
        &["too long without a RoBIOS call"],
    ),
    (
        "tracing",
        "no dumps and no death signal",
        "prctl(PR_SET_DUMPABLE, 0); prctl(PR_SET_PDEATHSIG, 0); for (;;) ;",
        &["too long without a RoBIOS call"],
    ),
    (
        "tracing",
        "name like a state",
        "prctl(PR_SET_NAME, \") T 1 (\"); for (;;) ;",
        &["too long without a RoBIOS call"],
    ),
    (
        "tracing",
        "seccomp against all",
        "prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0); prctl(PR_SET_SECCOMP, 1); OSWait(50);",
        &[],
    ),
    (
        "limits",
        "all limits 0",
        "{ int i; struct rlimit l = {0, 0}; for (i = 0; i < 16; i++) setrlimit(i, &l); } OSWait(50); for (;;) ;",
        &["Too many open files", "too long without a RoBIOS call", "killed by signal"],
    ),
    (
        "limits",
        "lowest scheduling class",
        "{ int zero = 0; syscall(SYS_sched_setscheduler, 0, 5, &zero); } OSWait(50); for (;;) ;",
        &["too long without a RoBIOS call"],
    ),
    (
        "limits",
        "bound to no processor of the others",
        "{ unsigned long one_only = 1; syscall(SYS_sched_setaffinity, 0, 8, &one_only); } for (;;) ;",
        &["too long without a RoBIOS call"],
    ),
    (
        "descriptors",
        "trace changed in place",
        "{ int f = open(\"t.jsonl\", O_WRONLY); pwrite(f, \"x\", 1, 0); } OSWait(50);",
        &["not complete"],
    ),
    ("descriptors", "channel overwritten with ones", "CHANNELS({ memset((void *)p, 255, 4096); }) OSWait(50);", &[]),
    ("descriptors", "channel overwritten with zeros", "CHANNELS({ memset((void *)p, 0, 4096); }) OSWait(50);", &[]),
    (
        "descriptors",
        "channel that imports for ever",
        "CHANNELS({ p[8] = 1; p[9] = 0xffffffff; }) for (;;) ;",
        &["too long without a RoBIOS call"],
    ),
    (
        "descriptors",
        "channel with a foreign thread",
        "CHANNELS({ p[5] = 1; }) OSWait(50); for (;;) ;",
        &["too long without a RoBIOS call", "its own thread"],
    ),
    ("descriptors", "channel whose turn flies back and forth", "CHANNELS({ for (;;) p[2] ^= 1; }) for (;;) ;", &[]),
    (
        "descriptors",
        "channel with forged calls",
        "CHANNELS({ int k; for (k = 0; k < 2000; k++) { unsigned w; for (w = 16; w < 64; w++) p[w] = w < 18 ? w & 7 : k * 2654435761u >> w % 16; p[3] = 3; p[4] = 200; p[2] = 1; while (p[2] == 1) ; } }) OSWait(50); for (;;) ;",
        &[],
    ),
    (
        "descriptors",
        "all sockets and files passed on",
        "{ int i; for (i = 0; i < 100; i++) fcntl(i, F_SETFL, O_NONBLOCK | O_ASYNC); } OSWait(50);",
        &[],
    ),
    ("forks", "vfork that returns", "if (vfork() == 0) OSWait(1); OSWait(50);", &[]),
    (
        "forks",
        "clone that shares everything",
        "{ static char s[65536]; clone(shares, s + sizeof s, CLONE_VM | CLONE_FS | CLONE_FILES | SIGCHLD, 0); } OSWait(50);",
        &[],
    ),
    ("forks", "unshare of all", "unshare(CLONE_NEWNS | CLONE_NEWPID | CLONE_FS | CLONE_FILES); OSWait(50);", &[]),
    (
        "forks",
        "session of its own, then a loop",
        "setsid(); setpgid(0, 0); for (;;) ;",
        &["too long without a RoBIOS call"],
    ),
];

/// Complete programs: class, name, language, source text, expected texts.
const WHOLE: &[(&str, &str, Language, &str, &[&str])] = &[
    (
        "libraries",
        "IFUNC that loops",
        C,
        "static void (*r(void))(void) { for (;;) ; } void f(void) __attribute__((ifunc(\"r\"))); int main(void) { f(); return 0; }",
        &["does not return"],
    ),
    (
        "libraries",
        "IFUNC that crashes",
        C,
        "static void (*r(void))(void) { *(volatile int *)0 = 1; return 0; } void f(void) __attribute__((ifunc(\"r\"))); int main(void) { f(); return 0; }",
        &["segmentation fault"],
    ),
    (
        "libraries",
        "destructor that loops",
        C,
        "__attribute__((destructor)) static void f(void) { for (;;) ; } int main(void) { OSWait(20); return 0; }",
        &[],
    ),
    (
        "libraries",
        "destructor that crashes",
        C,
        "__attribute__((destructor)) static void f(void) { *(volatile int *)0 = 1; } int main(void) { OSWait(20); return 0; }",
        &[],
    ),
    (
        "libraries",
        "own malloc that fails",
        C,
        "void *malloc(size_t n) { (void)n; return 0; } int main(void) { OSWait(20); printf(\"x\\n\"); return 0; }",
        &[],
    ),
    (
        "libraries",
        "own write and exit",
        C,
        "ssize_t write(int f, const void *b, size_t n) { (void)f, (void)b; return (ssize_t)n; } int main(void) { OSWait(20); printf(\"x\\n\"); return 0; }",
        &[],
    ),
    (
        "libraries",
        "own longjmp",
        C,
        "void longjmp(struct __jmp_buf_tag *b, int v) { (void)b, (void)v; abort(); } int main(void) { OSWait(20); exit(0); }",
        &["called abort", ""],
    ),
    (
        "libraries",
        "own OSWait",
        C,
        "int OSWait(int n) { (void)n; for (;;) ; } int main(void) { return OSWait(20); }",
        &["too long without a RoBIOS call"],
    ),
    (
        "libraries",
        "own symbols of the shim",
        C,
        "int eyesim_program = 1; int main(void) { return 0; }",
        &["eyesim_program"],
    ),
    ("libraries", "no main", C, "int nothing(void) { return 0; }", &["main"]),
    ("libraries", "does not compile", C, "int main(void) { return }", &["does not", "error"]),
    ("libraries", "includes itself", C, "#include \"bad.c\"\nint main(void) { return 0; }", &["include"]),
    (
        "libraries",
        "macros without end",
        C,
        "#define A B B B B B B B B\n#define B C C C C C C C C\n#define C D D D D D D D D\n#define D E E E E E E E E\n#define E 0 +\nint main(void) { return A A 0; }",
        &[],
    ),
    (
        "calls",
        "SERSend beyond its buffer",
        C7,
        "int main(void) { static char b[8]; SERSend(1, b, 1u << 30); return 0; }",
        &["segmentation fault"],
    ),
    ("calls", "camera into a wild pointer", C7, "int main(void) { CAMInit(QVGA); CAMGet((BYTE *)16); return 0; }", &[]),
    (
        "calls",
        "image size beyond all",
        C7,
        "int main(void) { LCDImageSize(1000000); LCDImage((BYTE *)16); return 0; }",
        &[],
    ),
    (
        "calls",
        "drive to infinity in RoBIOS-7",
        C7,
        "int main(void) { VWStraight(2147483647, 2147483647); VWWait(); return 0; }",
        &[],
    ),
    ("calls", "scan into a null pointer", C7, "int main(void) { LIDARGet(0); return 0; }", &[]),
    (
        "calls",
        "radio to nobody",
        C7,
        "int main(void) { char b[9]; int id; RADIOInit(); RADIOReceive(&id, b, 9); return 0; }",
        &[],
    ),
    ("C++", "uncaught exception", Cpp, "int main() { OSWait(5); throw std::runtime_error(\"thrown\"); }", &["thrown"]),
    ("C++", "uncaught number", Cpp, "int main() { OSWait(5); throw 42; }", &["uncaught exception `int`"]),
    (
        "C++",
        "exception in a static constructor",
        Cpp,
        "struct A { A() { throw std::runtime_error(\"built wrongly\"); } } a; int main() { OSWait(5); return 0; }",
        &["built wrongly"],
    ),
    (
        "C++",
        "exception in a static destructor",
        Cpp,
        "struct A { ~A() noexcept(false) { throw std::runtime_error(\"ended wrongly\"); } } a; int main() { OSWait(5); return 0; }",
        &["ended wrongly"],
    ),
    (
        "C++",
        "exception while unwinding",
        Cpp,
        "struct A { ~A() noexcept(false) { throw 2; } }; int main() { OSWait(5); try { A a; throw 1; } catch (...) {} return 0; }",
        &["uncaught exception", "terminate"],
    ),
    (
        "C++",
        "exception out of noexcept",
        Cpp,
        "void f() noexcept { throw std::runtime_error(\"out\"); } int main() { OSWait(5); try { f(); } catch (...) {} return 0; }",
        &["out"],
    ),
    (
        "C++",
        "exception out of a timer",
        Cpp,
        "static void f() { throw std::runtime_error(\"ticked\"); } int main() { OSAttachTimer(10, f); OSWait(50); return 0; }",
        &["ticked"],
    ),
    (
        "C++",
        "exception out of a thread",
        Cpp,
        "int main() { OSWait(5); std::thread t([] { throw std::runtime_error(\"spun\"); }); t.join(); return 0; }",
        &["spun"],
    ),
    (
        "C++",
        "thread that nobody joins",
        Cpp,
        "int main() { OSWait(5); std::thread t([] { OSWait(5); }); return 0; }",
        &["terminate"],
    ),
    (
        "C++",
        "pure virtual call",
        Cpp,
        "struct A { A() { g(); } void g() { f(); } virtual void f() = 0; }; struct B : A { void f() override {} }; int main() { OSWait(5); B b; return 0; }",
        &["terminate", "abort", "pure virtual"],
    ),
    (
        "C++",
        "bad_alloc",
        Cpp,
        "int main() { OSWait(5); std::vector<char> v; v.reserve(SIZE_MAX / 4); return 0; }",
        &["bad_alloc"],
    ),
    (
        "C++",
        "vector beyond its end",
        Cpp,
        "int main() { OSWait(5); std::vector<int> v; return v.at(3); }",
        &["out_of_range"],
    ),
    (
        "C++",
        "destructor that loops",
        Cpp,
        "struct A { ~A() { for (;;) ; } } a; int main() { OSWait(5); return 0; }",
        &["too long without a RoBIOS call"],
    ),
    ("C++", "stop swallowed for ever", Cpp, "int main() { for (;;) { try { OSWait(5); } catch (...) { } } }", &[]),
    (
        "C++",
        "own terminate handler that loops",
        Cpp,
        "int main() { OSWait(5); std::set_terminate([] { for (;;) ; }); throw 1; }",
        &["too long without a RoBIOS call"],
    ),
    (
        "C++",
        "own operator new",
        Cpp,
        "void *operator new(std::size_t) { throw std::bad_alloc(); } int main() { OSWait(5); std::string s(1000, 'x'); return (int)s.size(); }",
        &["bad_alloc"],
    ),
    (
        "C++",
        "deep recursion of destructors",
        Cpp,
        "struct N { std::unique_ptr<N> next; }; int main() { OSWait(5); auto n = std::make_unique<N>(); for (int i = 0; i < 3000000; i++) { auto m = std::make_unique<N>(); m->next = std::move(n); n = std::move(m); } return 0; }",
        &["stack overflow"],
    ),
    (
        "C++",
        "dangling reference",
        Cpp,
        "int &f() { int *p = nullptr; return *p; } int main() { OSWait(5); return f(); }",
        &["segmentation fault at address 0x0"],
    ),
    ("Python", "exception", Python, "raise ValueError('wrong')", &["ValueError: wrong"]),
    (
        "Python",
        "exception in a timer",
        Python,
        "def f():\n    raise ValueError('ticked')\nOSAttachTimer(10, f)\nOSWait(100)",
        &["ticked"],
    ),
    (
        "Python",
        "exception in a thread",
        Python,
        "import threading\ndef f():\n    raise ValueError('spun')\nt = threading.Thread(target=f)\nt.start()\nt.join()",
        &[],
    ),
    ("Python", "endless loop", Python, "OSWait(10)\nwhile True:\n    pass", &["too long without a RoBIOS call"]),
    (
        "Python",
        "endless loop in a module",
        Python,
        "import re\nre.match(r'(a+)+$', 'a' * 60 + 'b')",
        &["too long without a RoBIOS call"],
    ),
    ("Python", "exit code", Python, "import sys\nsys.exit(3)", &["exit code 3"]),
    ("Python", "raw exit", Python, "import os\nos._exit(0)", &["without a message"]),
    ("Python", "raw exit with 7", Python, "import os\nos._exit(7)", &["exit code 7"]),
    ("Python", "abort", Python, "import os\nos.abort()", &["signal 6"]),
    ("Python", "SIGKILL", Python, "import os\nos.kill(os.getpid(), 9)", &["signal 9", "without a RoBIOS call"]),
    ("Python", "SIGSTOP", Python, "import os\nos.kill(os.getpid(), 19)", &["SIGSTOP"]),
    (
        "Python",
        "signals ignored",
        Python,
        "import signal\nfor s in range(1, 30):\n    if s not in (9, 19):\n        signal.signal(s, signal.SIG_IGN)\nwhile True:\n    pass",
        &["too long without a RoBIOS call"],
    ),
    (
        "Python",
        "SystemExit swallowed",
        Python,
        "while True:\n    try:\n        OSWait(10)\n    except BaseException:\n        pass",
        &[],
    ),
    ("Python", "recursion", Python, "def f():\n    return f()\nf()", &["RecursionError"]),
    (
        "Python",
        "recursion without a limit",
        Python,
        "import sys\nsys.setrecursionlimit(10**9)\ndef f(n):\n    return f(n + 1) + str([n] * 2).count('x')\nf(0)",
        &["signal 11", "RecursionError", "MemoryError", "without a RoBIOS call"],
    ),
    ("Python", "null pointer", Python, "import ctypes\nctypes.string_at(0)", &["signal 11", "without a RoBIOS call"]),
    (
        "Python",
        "all memory",
        Python,
        "a = []\nwhile True:\n    a.append(bytearray(1 << 26))",
        &["MemoryError", "signal 9", "without a RoBIOS call"],
    ),
    ("Python", "execv", Python, "import os\nos.execv('/bin/true', ['true'])", &["without a message"]),
    ("Python", "fork", Python, "import os\nif os.fork() == 0:\n    while True:\n        pass\nOSWait(50)", &[]),
    (
        "Python",
        "fork that calls",
        Python,
        "import os\nif os.fork() == 0:\n    OSWait(10)\n    os._exit(0)\nOSWait(50)",
        &[],
    ),
    (
        "Python",
        "daemon",
        Python,
        "import os, time\nif os.fork() == 0:\n    os.setsid()\n    time.sleep(1000)\nOSWait(50)",
        &[],
    ),
    ("Python", "descriptors closed", Python, "import os\nos.closerange(0, 256)\nOSWait(50)", &[]),
    ("Python", "trace deleted", Python, "import os\nos.unlink('t.jsonl')\nOSWait(50)", &["not complete"]),
    ("Python", "prints for ever", Python, "while True:\n    print('flood')", &[]),
    ("Python", "escapes", Python, "print('\\033[2J')\nraise ValueError('\\033[2J')", &["ValueError"]),
    ("Python", "does not parse", Python, "def f(:", &["SyntaxError"]),
    (
        "Python",
        "extremes into calls",
        Python,
        "for n in (0, -1, 2**31 - 1, -2**31):\n    VWSetSpeed(n, n)\n    VWStraight(n, n)\n    PSDGet(n)\n    LCDPixel(n, n, n)\n    OSWait(n % 100)",
        &[],
    ),
    ("Python", "objects into calls", Python, "VWSetSpeed('a', None)", &["Error"]),
    ("Rust", "panic", Rust, "panic", &["panicked"]),
    ("Rust", "index", Rust, "index", &["out of bounds"]),
    ("Rust", "overflow of the stack", Rust, "stack", &["stack overflow", "segmentation fault"]),
    ("Rust", "endless loop", Rust, "loop", &["too long without a RoBIOS call"]),
    ("Rust", "null write", Rust, "null", &["segmentation fault"]),
    ("Rust", "abort", Rust, "abort", &["aborted"]),
    ("Rust", "exit with 0", Rust, "exit0", &["called `exit`", "without a message"]),
    ("Rust", "exit with 7", Rust, "exit7", &["called `exit`", "exit code 7"]),
    ("Rust", "panic while panicking", Rust, "twice", &["aborted", "panicked"]),
    ("Rust", "all memory", Rust, "memory", &["aborted", "panicked", "signal"]),
    ("Rust", "panic caught for ever", Rust, "caught", &[]),
    ("Rust", "command", Rust, "command", &[]),
    (
        "libraries",
        "fork in a constructor",
        C,
        "__attribute__((constructor)) static void f(void) { if (fork() == 0) for (;;) syscall(SYS_pause); } int main(void) { unused; OSWait(20); return 0; }",
        &[],
    ),
    (
        "libraries",
        "exit_group(0) in assembly in a constructor",
        C,
        "__attribute__((constructor)) static void f(void) { RAW(SYS_exit_group, 0); } int main(void) { unused; OSWait(20); return 0; }",
        &["exit_group", "without a message"],
    ),
    (
        "libraries",
        "own dl_iterate_phdr and __tls_get_addr",
        C,
        "void *__tls_get_addr(void *p) { (void)p; abort(); } int dl_iterate_phdr(void *f, void *d) { (void)f, (void)d; abort(); } int main(void) { unused; OSWait(20); return 0; }",
        &[],
    ),
    (
        "libraries",
        "LD_PRELOAD in the environment, then system",
        C,
        "int main(void) { unused; OSWait(20); setenv(\"LD_PRELOAD\", \"/nothing/there.so\", 1); setenv(\"LD_DEBUG\", \"all\", 1); if (system(\"true\") != 0) exit(9); return 0; }",
        &[],
    ),
    (
        "C++",
        "destructor of a thread_local that loops",
        Cpp,
        "struct A { int n = 1; ~A() { for (;;) ; } }; thread_local A a; int main() { OSWait(5); return a.n - 1; }",
        &[],
    ),
    (
        "C++",
        "destructor of a thread_local in a task that loops",
        Cpp,
        "struct A { int n = 1; ~A() { for (;;) ; } }; thread_local A a; int main() { OSWait(5); std::thread t([] { a.n = 2; OSWait(1); }); t.join(); return 0; }",
        &["too long without a RoBIOS call"],
    ),
    (
        "C++",
        "exception through qsort",
        Cpp,
        "static int f(const void *, const void *) { throw std::runtime_error(\"sorted\"); } int main() { int l[2] = {2, 1}; OSWait(5); try { qsort(l, 2, sizeof *l, f); } catch (...) { OSWait(1); throw; } return 0; }",
        &["sorted"],
    ),
    (
        "C++",
        "exception in a destructor of a thread_local",
        Cpp,
        "struct A { int n = 1; ~A() noexcept(false) { throw 3; } }; thread_local A a; int main() { OSWait(5); return a.n - 1; }",
        &[],
    ),
    (
        "C++",
        "a hundred thousand exceptions",
        Cpp,
        "int main() { for (int i = 0; i < 100000; i++) try { throw std::string(100, 'x'); } catch (...) { } return 0; }",
        &[],
    ),
    (
        "C++",
        "exception of an exception",
        Cpp,
        "struct A { A() {} A(const A &) { throw 1; } }; int main() { OSWait(5); A a; throw a; }",
        &["uncaught", "terminate"],
    ),
    (
        "C++",
        "threads without end",
        Cpp,
        "int main() { OSWait(5); std::vector<std::thread> v; for (;;) v.emplace_back([] { OSWait(1000); }); }",
        &[],
    ),
    (
        "Python",
        "trace function that loops",
        Python,
        "import sys\ndef f(*a):\n    while True:\n        pass\nsys.settrace(f)\ndef g():\n    pass\ng()",
        &["too long without a RoBIOS call"],
    ),
    (
        "Python",
        "profile function that raises",
        Python,
        "import sys\ndef f(*a):\n    raise ValueError('profiled')\nsys.setprofile(f)\nOSWait(10)",
        &["profiled"],
    ),
    (
        "Python",
        "collector that raises",
        Python,
        "import gc\ndef f(*a):\n    raise ValueError('collected')\ngc.callbacks.append(f)\ngc.collect()\nOSWait(10)",
        &[],
    ),
    (
        "Python",
        "atexit that loops",
        Python,
        "import atexit\ndef f():\n    while True:\n        pass\natexit.register(f)\nOSWait(10)",
        &[],
    ),
    ("Python", "atexit that calls", Python, "import atexit\natexit.register(lambda: OSWait(100000))\nOSWait(10)", &[]),
    (
        "Python",
        "faulthandler that exits with 0",
        Python,
        "import faulthandler\nfaulthandler.dump_traceback_later(0.05, exit=True, file=open('dump', 'w'))\nwhile True:\n    pass",
        &["exit code 1", "without a RoBIOS call"],
    ),
    (
        "Python",
        "timer of the kernel that raises",
        Python,
        "import signal\ndef f(*a):\n    raise ValueError('alarmed')\nsignal.signal(signal.SIGALRM, f)\nsignal.setitimer(signal.ITIMER_REAL, 0.01, 0.01)\nfor i in range(10**9):\n    pass",
        &["alarmed"],
    ),
    ("Python", "one line of 50 MB", Python, "print('x' * 50_000_000)\nOSWait(10)", &[]),
    (
        "Python",
        "finaliser that loops",
        Python,
        "class A:\n    def __del__(self):\n        while True:\n            pass\na = A()\ndel a",
        &["too long without a RoBIOS call"],
    ),
    (
        "Python",
        "finaliser at the end that raises",
        Python,
        "class A:\n    def __del__(self):\n        raise ValueError('late')\na = A()\nOSWait(10)",
        &[],
    ),
    (
        "Python",
        "thread that outlives main",
        Python,
        "import threading, time\nthreading.Thread(target=lambda: time.sleep(1000)).start()\nOSWait(10)",
        &[],
    ),
    (
        "Python",
        "daemon thread that calls for ever",
        Python,
        "import threading\ndef f():\n    while True:\n        OSWait(1)\nthreading.Thread(target=f, daemon=True).start()\nOSWait(10)",
        &[],
    ),
    (
        "Python",
        "exit in a thread",
        Python,
        "import os, threading\nthreading.Thread(target=lambda: os._exit(0)).start()\nwhile True:\n    OSWait(1)",
        &["without a message"],
    ),
    ("Python", "null pointer written", Python, "import ctypes\nctypes.memset(0, 1, 1)", &["signal 11"]),
    (
        "Python",
        "interpreter's own object destroyed",
        Python,
        "import ctypes\nctypes.memset(id(None), 65, 16)\nOSWait(10)\nx = [None] * 3",
        &[],
    ),
    ("Python", "modules cleared", Python, "import sys\nsys.modules.clear()\nOSWait(10)", &[]),
    (
        "Python",
        "library of calls overwritten",
        Python,
        "import eye\nfor n in list(vars(eye)):\n    if not n.startswith('__'):\n        setattr(eye, n, None)\nOSWait(10)",
        &[],
    ),
    (
        "Python",
        "memory by little",
        Python,
        "a = {}\nwhile True:\n    a[len(a)] = [object() for _ in range(100)]",
        &["MemoryError", "signal 9", "without a RoBIOS call"],
    ),
    (
        "Python",
        "big number",
        Python,
        "n = 10\nwhile True:\n    n = n ** 10",
        &["too long without a RoBIOS call", "MemoryError"],
    ),
    (
        "Python",
        "SIGSTOP to the parent",
        Python,
        "import os, signal\nos.kill(os.getppid(), signal.SIGSTOP)\nOSWait(10)",
        &["PermissionError", "not permitted"],
    ),
    (
        "Python",
        "standard streams closed",
        Python,
        "import sys, os\nsys.stdout.close()\nsys.stderr.close()\nos.close(1)\nos.close(2)\nOSWait(10)\nraise ValueError('unheard')",
        &["unheard", "exit code"],
    ),
    (
        "Python",
        "exception whose text raises",
        Python,
        "class E(Exception):\n    def __str__(self):\n        raise ValueError('again')\nraise E()",
        &["E"],
    ),
    (
        "Python",
        "exception whose text loops",
        Python,
        "class E(Exception):\n    def __str__(self):\n        while True:\n            pass\nraise E()",
        &["too long without a RoBIOS call", "exit code"],
    ),
    (
        "Python",
        "generator that swallows its end",
        Python,
        "def g():\n    while True:\n        try:\n            yield OSWait(1)\n        except BaseException:\n            pass\nfor _ in g():\n    pass",
        &[],
    ),
    ("Rust", "panic in a destructor", Rust, "bomb", &["again", "panicked"]),
    ("Rust", "panic in a thread", Rust, "thread", &[]),
    ("Rust", "thread that outlives main", Rust, "outlive", &[]),
    ("Rust", "thread-local whose destructor loops", Rust, "local", &[]),
    ("Rust", "thread-local whose destructor panics", Rust, "local-panic", &[]),
    ("Rust", "panic hook that loops", Rust, "hook", &["too long without a RoBIOS call"]),
    ("Rust", "panic hook that panics", Rust, "hook-panic", &["abort", "panicked"]),
    ("Rust", "payload that panics when dropped", Rust, "payload", &["panicked", "again", "abort"]),
    ("Rust", "exit_group(0) in assembly", Rust, "raw", &["exit_group", "without a message"]),
    ("Rust", "memory leaked for ever", Rust, "leak", &["abort", "panicked", "signal", "without a RoBIOS call"]),
    ("Rust", "mutex locked twice", Rust, "mutex", &["too long without a RoBIOS call", "panicked"]),
    ("Rust", "channel that nobody sends to", Rust, "receive", &["too long without a RoBIOS call"]),
    ("Rust", "prints for ever", Rust, "print", &[]),
    ("Rust", "destructor that loops while panicking", Rust, "drop-loop", &["too long without a RoBIOS call"]),
    ("Rust", "constructor that loops", Rust, "constructor loop", &["too long without a RoBIOS call"]),
    ("Rust", "constructor that crashes", Rust, "constructor null", &["segmentation fault at address 0x4"]),
    ("Rust", "constructor that panics", Rust, "constructor panic", &["abort"]),
    ("Rust", "constructor that exits with 0", Rust, "constructor exit", &["called `exit`", "without a message"]),
    (
        "Rust",
        "constructor with exit_group(0) in assembly",
        Rust,
        "constructor raw",
        &["exit_group", "without a message"],
    ),
    ("Rust", "constructor in order", Rust, "constructor in order", &[]),
];

/// Text in front of each RoBIOS 6 C program that has a `main`.
const HEAD: &str = r#"#define _GNU_SOURCE
#include <alloca.h>
#include <assert.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <fenv.h>
#include <pthread.h>
#include <semaphore.h>
#include <sched.h>
#include <setjmp.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <ucontext.h>
#include <unistd.h>
#include "eyebot.h"
static volatile int sink, sink0;
static volatile double sinkd, zero;
static void *volatile sinkp;
static jmp_buf place;
static pthread_mutex_t one = PTHREAD_MUTEX_INITIALIZER, two = PTHREAD_MUTEX_INITIALIZER;
static __attribute__((noinline)) int deep(int n) { volatile char pad[4096]; pad[0] = n; return n ? deep(n + 1) + pad[0] : 0; }
static __attribute__((noinline)) void overrun(int n) { volatile char b[8]; memset((void *)b, 65, n); __asm__ volatile("" : : "r"(b) : "memory"); }
static __attribute__((noinline, optimize("stack-protector-all"))) void smash(int n) { volatile char b[8]; memset((void *)b, 65, n); __asm__ volatile("" : : "r"(b) : "memory"); }
static __attribute__((noinline)) void keep(void) { volatile char pad[512]; pad[0] = 1; if (setjmp(place)) OSWait(1); pad[1] = 2; }
static void nothing(int s) { (void)s; }
static void jumps(int s) { (void)s; siglongjmp(place, 1); }
static void quiet(void) {}
static void waits(void) { OSWait(10); }
static void again(void) { exit(6); }
static void jump_out(void) { longjmp(place, 1); }
static void on_own_stack(void) { OSWait(10); }
static void *idle(void *p) { OSWait(100); return p; }
static void *spin(void *p) { (void)p; for (;;) OSGetCount(); }
static void *crossed(void *p) { pthread_mutex_lock(&two); OSWait(20); pthread_mutex_lock(&one); return p; }
static void *jump_task(void *p) { longjmp(place, 1); return p; }
static void *crashes(void *p) { *(volatile int *)0 = 1; return p; }
static void *spins(void *p) { for (;;) sink = 1; return p; }
static volatile long victim;
#define RAW(number, code) __asm__ volatile("syscall" : : "a"((long)(number)), "D"((long)(code)) : "rcx", "r11", "memory")
#define CHANNELS(HARM) { int i; for (i = 3; i < 64; i++) { volatile unsigned *p = mmap(0, 4096, 3, MAP_SHARED, i, 0); \
    if (p != MAP_FAILED && p[0] == 0x53455945) HARM } }
static void *storm(void *p) { for (;;) syscall(SYS_tgkill, getpid(), victim, SIGURG); return p; }
static void *leaves(void *p) { RAW(SYS_exit_group, 0); return p; }
static int shares(void *p) { (void)p; for (;;) syscall(SYS_pause); }
static void anew(void) { atexit(anew); }
static void leave_raw(void) { _exit(0); }
static void *calls(void *p) { int i; for (i = 0; i < 1000; i++) { OSWait(1); LCDPrintf("x"); } return p; }
static void foreign(void *(*f)(void *)) {
    pthread_t t;
    int (*create)(pthread_t *, void *, void *(*)(void *), void *) = dlsym(dlopen("libc.so.6", RTLD_NOW), "pthread_create");
    create(&t, 0, f, 0);
}
#define unused (void)one, (void)two, (void)deep, (void)smash, (void)overrun, (void)keep, (void)nothing, (void)jumps, (void)quiet, (void)waits, \
    (void)again, (void)jump_out, (void)on_own_stack, (void)idle, (void)spin, (void)crossed, (void)jump_task, (void)crashes, \
    (void)spins, (void)calls, (void)victim, (void)storm, (void)leaves, (void)shares, (void)anew, (void)leave_raw, (void)foreign, (void)sinkd, (void)zero, (void)sinkp, (void)place
"#;

/// Texts in front of each program in RoBIOS-7 C, and in C++.
const HEAD7: &str = "#include <stdio.h>\n#include <stdlib.h>\n#include \"eyebot.h\"\n";
const HEAD_CPP: &str = "#include <cstdint>\n#include <exception>\n#include <memory>\n#include <new>\n#include <stdexcept>\n#include <string>\n\
                        #include <thread>\n#include <vector>\n#include \"eyebot.h\"\n";

/// Calls of RoBIOS 6; an argument replaces each `@`.
const WITH_ARGUMENTS: &str = "LCDPutString((char *)(intptr_t)@); LCDPutChar(@); LCDSetPos(@, @); LCDPutInt(@); LCDPutHex(@); \
    LCDPutFloat(@); LCDSetPixel(@, @, @); LCDLine(@, @, @, @, @); LCDArea(@, @, @, @, @); LCDMode(@); KEYRead(); \
    PSDGet(@); PSDStart(@, @); PSDRelease(); MOTORDrive(@, @); QUADRead(@); QUADReset(@); SERVOSet(@, @); BUMPCheck(@, 0); \
    OSWait((@) & 7); OSGetCount(); OSDetachTimer(@); AUTone((@) & 4095, (@) & 255); VWSetSpeed(@, @, @); VWDriveStraight(@, @, @); \
    VWDriveTurn(@, @, @); VWDriveCurve(@, @, @, @); VWDriveDone(@); VWStalled(@); VWRelease(@); OSMachineID();";

/// All cases, in a fixed order.
pub fn all() -> Vec<Case> {
    let c = |text: String| format!("{HEAD}{text}\n");
    let mut cases = Vec::new();
    for (index, program) in PLACES {
        for (crash, statements, expected) in CRASHES {
            let source = c(program.replace("CRASH", statements).replacen("{ ", "{ unused; ", 1));
            cases.push(Case { class: "crashes", name: format!("{crash} in {index}"), language: C, source, expected });
        }
    }
    for (class, name, statements, expected) in BODIES {
        let statements = match *statements {
            "NULLS" => WITH_ARGUMENTS.replace('@', "0"),
            "NUMBERS" => ["-1", "2147483647", "-2147483647 - 1", "65536"]
                .map(|number| WITH_ARGUMENTS.replace("(char *)(intptr_t)@", "\"\"").replace('@', number))
                .concat(),
            statements => statements.to_owned(),
        };
        let source = c(format!("int main(void) {{ unused; OSWait(20); {statements} return 0; }}"));
        cases.push(Case { class, name: (*name).to_owned(), language: C, source, expected });
    }
    for (class, name, language, text, expected) in WHOLE {
        let source = match language {
            C if text.contains("int main(void)") => c((*text).to_owned()),
            C => (*text).to_owned(),
            C7 => format!("{HEAD7}{text}\n"),
            Cpp => format!("{HEAD_CPP}{text}\n"),
            Python => format!("from eye import *\n{text}\n"),
            Rust => (*text).to_owned(),
        };
        cases.push(Case { class, name: (*name).to_owned(), language: *language, source, expected });
    }
    cases
}

/// Environment variable that selects the behaviour of the Rust package's constructor, by the value `constructor NAME`.
pub const CONSTRUCTOR: &str = "HOSTILE_CONSTRUCTOR";

/// The Rust package with the Rust cases; its first argument names the case.
pub const RUST: &str = r#"use robios_api::prelude::*;
robios_api::program!(main);
struct Bomb;
impl Drop for Bomb { fn drop(&mut self) { panic!("again"); } }
#[used]
#[unsafe(link_section = ".init_array")]
static START: extern "C" fn() = start;
extern "C" fn start() {
    match std::env::var("HOSTILE_CONSTRUCTOR").unwrap_or_default().as_str() {
        "constructor loop" => loop { std::hint::black_box(1); },
        "constructor null" => unsafe { std::ptr::null_mut::<u32>().wrapping_add(1).write_volatile(1) },
        "constructor panic" => panic!("built"),
        "constructor exit" => std::process::exit(0),
        "constructor raw" => unsafe { std::arch::asm!("syscall", in("rax") 231, in("rdi") 0, out("rcx") _, out("r11") _) },
        _ => {}
    }
}
struct Spin;
impl Drop for Spin { fn drop(&mut self) { loop { std::hint::black_box(1); } } }
struct Looping(std::cell::Cell<u8>);
impl Drop for Looping { fn drop(&mut self) { loop { std::hint::black_box(1); } } }
struct Panicking(std::cell::Cell<u8>);
impl Drop for Panicking { fn drop(&mut self) { panic!("again"); } }
thread_local! {
    static LOOPS: Looping = const { Looping(std::cell::Cell::new(0)) };
    static PANICS: Panicking = const { Panicking(std::cell::Cell::new(0)) };
}
#[inline(never)]
fn deep(n: u64) -> u64 { let pad = std::hint::black_box([n; 512]); deep(n + 1) + pad[3] }
fn main(robot: &Robot) -> Result {
    robot.sleep(Duration::from_millis(200));
    match robot.arguments().first().map_or("", String::as_str) {
        "panic" => panic!("on purpose"),
        "index" => { let list = vec![1, 2, 3]; robot.console().write_fmt(format_args!("{}", list[robot.arguments().len() + 7])); }
        "stack" => { robot.console().write_fmt(format_args!("{}", deep(1))); }
        "loop" => loop { std::hint::black_box(1); },
        "null" => unsafe { std::ptr::null_mut::<u32>().wrapping_add(1).write_volatile(1) },
        "abort" => std::process::abort(),
        "exit0" => std::process::exit(0),
        "exit7" => std::process::exit(7),
        "twice" => { let _bomb = Bomb; panic!("first"); }
        "memory" => { let mut all = Vec::new(); loop { all.push(Vec::<u8>::with_capacity(1 << 28)); std::hint::black_box(&all); } }
        "caught" => loop {
            let _ = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| robot.sleep(Duration::from_millis(10))));
        },
        "bomb" => { let _bomb = Bomb; }
        "thread" => { let _ = std::thread::spawn(|| panic!("spun")).join(); }
        "outlive" => { std::thread::spawn(|| loop { std::thread::sleep(Duration::from_millis(1)); }); }
        "local" => { LOOPS.with(|one| one.0.set(1)); }
        "local-panic" => { PANICS.with(|one| one.0.set(1)); }
        "hook" => { std::panic::set_hook(Box::new(|_| loop { std::hint::black_box(1); })); panic!("hooked"); }
        "hook-panic" => { std::panic::set_hook(Box::new(|_| panic!("again"))); panic!("hooked"); }
        "payload" => std::panic::panic_any(Bomb),
        "raw" => unsafe { std::arch::asm!("syscall", in("rax") 231, in("rdi") 0, out("rcx") _, out("r11") _) },
        "leak" => loop { std::mem::forget(vec![1_u8; 1 << 20]); },
        "mutex" => { let one = std::sync::Mutex::new(1); let _first = one.lock(); let _second = one.lock(); }
        "receive" => { let (sender, receiver) = std::sync::mpsc::channel::<u8>(); let _ = receiver.recv(); drop(sender); }
        "print" => loop { println!("flood"); },
        "drop-loop" => { let _spin = Spin; panic!("first"); }
        "command" => { let _ = std::process::Command::new("true").status(); }
        _ => {}
    }
    Ok(())
}
"#;
