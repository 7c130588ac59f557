//! C programs, built as `eyesim` builds them, loaded and run in a small host.

mod common;

use common::{Robot, build, has_compiler};
use robios_sys::robios6::{ColImage, HDTEntry, Image, PositionType, RadioIOParameters, RadioStatus, SpeedType};
use robios_sys::{
    ByteBuffer, ByteSlice, Callback, Console, EXIT_ABORTED, EXIT_STOPPED, Host, Program, Robios6Table, SupportTable, c,
    support,
};

/// Compiler options that a student may use.
const LEVELS: [&[&str]; 6] = [
    &["-O0"],
    &["-O1"],
    &["-O2"],
    &["-O3"],
    &["-O2", "-U_FORTIFY_SOURCE", "-D_FORTIFY_SOURCE=2"],
    &["-O2", "-fstack-protector-all", "-ansi"],
];

/// Runs one file with default flags and no arguments.
fn run(text: &str) -> (i32, Robot) {
    build(&[text], &[], &[]).run(Robot::default(), &[])
}

#[test]
fn robios_calls_carry_strings_numbers_outputs_and_images() {
    if !has_compiler() {
        return;
    }
    let (code, robot) = run(r#"
#include "eyebot.h"
#include <string.h>
image grey, laplace;
colimage colour;
int main(void)
{
    PositionType pos = {0, 0, 0};
    SpeedType speed;
    int h, m, s, ticks, received;
    BYTE id, message[MAXMSGLEN];
    HDT_entry_type *entry;
    VWHandle vw = VWInit(VW_DRIVE, 1);
    if (strcmp(OSVersion(), "6.5") != 0 || OSVersion() != OSVersion()) return 1;
    if (LCDPrintf("%s %5.2f %c\n", "x", 1.5, 'y') != 0) return 2;
    if (LCDPutString(0) != -1) return 3;
    if (VWDriveStraight(vw, -0.5, 0.2) != 0 || VWDriveStraight(7, 1, 1) != -1) return 4;
    if (VWGetPosition(vw, &pos) != 0 || pos.x != 1.5f || pos.y != -2.5f || pos.phi != 0.5f) return 5;
    if (VWGetPosition(vw, 0) != -1) return 6;
    if (OSGetTime(&h, &m, &s, &ticks) != 0 || h != 1 || m != 2 || s != 3 || ticks != 4) return 7;
    if (OSGetTime(0, 0, 0, 0) != 0) return 8;
    grey[61][81] = 55;
    if (IPLaplace(&grey, &laplace) != 0 || laplace[61][81] != 200 || laplace[0][0] != 255) return 9;
    if (IPLaplace(0, &laplace) != -1) return 10;
    if (LCDPutColorGraphic(&colour) != 0 || colour[61][81][2] != 9) return 11;
    entry = HDT_FindEntry(4, PSD_FRONT);
    if (entry == 0 || entry->semantics != -200 || strcmp(entry->device_name, "front") != 0) return 12;
    if (HDT_FindEntry(4, PSD_BACK) != 0) return 13;
    if (RADIORecv(&id, &received, message) != 0 || id != 9 || received != 5 || memcmp(message, "hello", 5)) return 14;
    if (RADIOSend(1, 1000000, message) != 1 || RADIOSend(1, -1, message) != 1) return 15;
    if (AUPlaySample("RIFF\4\0\0\0WAVE") != 12 || AUPlaySample("RI") != 2 || AUPlaySample(0) != 0) return 16;
    if (CAMInit(NORMAL) != NOCAM || VWGetSpeed(vw, &speed) != -1 || OSSpawn("t", 0, 0, 0, 0) != 0) return 17;
    OSWriteParData(3);
    return 0;
}"#
    .replace("\"eyebot.h\"", "\"eyebot.h\"\n#include \"hdt.h\"")
    .as_str());
    assert_eq!(code, 0, "{:?}", robot.calls);
    let calls = robot.calls.borrow();
    assert_eq!(calls[0], "VWInit(-700, 1) = 1");
    assert!(calls.contains(&r#"LCDPrintf("x  1.50 y\n") = 0"#.to_owned()), "{calls:?}");
    assert!(calls.contains(&"VWDriveStraight(1, -0.5, 0.2) = 0".to_owned()), "{calls:?}");
    assert!(calls.contains(&"VWGetPosition(1, &{1.5, -2.5, 0.5}) = 0".to_owned()), "{calls:?}");
    assert!(calls.contains(&"RADIOSend(1, [36 bytes]) = 1".to_owned()), "{calls:?}");
    assert_eq!(calls.last().map(String::as_str), Some("OSWriteParData(3) = "));
}

#[test]
fn long_text_is_formatted_whole() {
    if !has_compiler() {
        return;
    }
    let (code, robot) = run("#include \"eyebot.h\"\nint main(void) { return LCDPrintf(\"%2000d\", 7); }");
    assert_eq!(code, 0);
    assert_eq!(robot.calls.borrow()[0].len(), "LCDPrintf(\"\") = 0".len() + 2000);
}

#[test]
fn every_form_of_main_in_old_and_new_c_works() {
    if !has_compiler() {
        return;
    }
    let quiet: &[&str] = &["-std=gnu89", "-w"];
    for (text, flags, expected_code) in [
        ("int main(void) { return 42; }", &[][..], 42),
        ("int main() { return -1; }", &[], -1),
        ("main() { return 3; }", quiet, 3),
        ("int main(argc, argv) int argc; char **argv; { return argc + argv[1][0]; }", quiet, 2 + i32::from(b'a')),
        ("int main(int n, char *a[]) { a[1][0]++; return a[n] == 0 ? a[1][0] : 1; }", &[], i32::from(b'b')),
        ("int main(int n, char **a, char **e) { return n != 2 || a == 0 || e[0] != 0; }", &[], 0),
        // Without `return`, C99 defines the result 0.
        ("int main(void) { }", &[], 0),
    ] {
        let (exit_code, _) = build(&[text], flags, &[]).run(Robot::default(), &["a"]);
        assert_eq!(exit_code, expected_code, "{text}");
    }
    let void = build(&["int f(void) { return 77; }\nvoid main() { f(); }"], &["-w"], &[c::VOID_MAIN_FLAG]);
    assert_eq!(void.run(Robot::default(), &[]).0, 0);
}

#[test]
fn stopped_program_ends_at_any_call_depth() {
    if !has_compiler() {
        return;
    }
    let program = build(
        &[r#"
#include "eyebot.h"
#include <stdio.h>
#include <stdlib.h>
static void never(void) { printf("at exit\n"); }
static void deep(int n) { volatile char frame[1000]; frame[0] = n; if (n > 0) deep(n - 1); else OSWait(1000000); frame[1] = 1; }
int main(void)
{
    atexit(never);
    printf("begun");
    deep(50);
    printf("never\n");
    return 0;
}"#],
        &[],
        &[],
    );
    let (code, robot) = program.run(Robot { stop_at_us: 500_000, ..Robot::default() }, &[]);
    assert_eq!(code, EXIT_STOPPED);
    assert_eq!(robot.printed(), "begun");
    assert_eq!(robot.now_us.get(), 500_000 + 1);
}

#[test]
fn a_program_that_only_prints_can_be_stopped() {
    if !has_compiler() {
        return;
    }
    for print in [
        "printf(\"x\\n\")",
        "puts(\"x\")",
        "putc(10, stdout)",
        "fputs(\"x\\n\", stderr)",
        "fprintf(stdout, \"%d\\n\", 1)",
    ] {
        for level in [&["-O0"][..], &["-O2"]] {
            let text = format!("#include <stdio.h>\nint main(void) {{ for (;;) {print}; }}");
            let robot = Robot { stop_at_us: 100, ..Robot::default() };
            let (code, robot) = build(&[&text], level, &[]).run(robot, &[]);
            assert_eq!((code, robot.now_us.get()), (EXIT_STOPPED, 100), "{print}");
        }
    }
}

#[test]
fn a_timer_function_runs_inside_a_call_and_can_end_the_program() {
    if !has_compiler() {
        return;
    }
    let text = r#"
#include "eyebot.h"
#include <stdlib.h>
static int ticks;
static void tick(void) { ticks++; LCDPutString("tick"); if (ticks == LIMIT) exit(7); }
int main(void)
{
    TimerHandle timer = OSAttachTimer(1, tick);
    OSWait(5);
    return timer == 1 ? ticks : -1;
}"#;
    let (code, robot) = run(&text.replace("LIMIT", "100"));
    assert_eq!(code, 5);
    // The timer's calls return before the call that they interrupt.
    assert_eq!(robot.calls.borrow()[1], r#"LCDPutString("tick") = 0"#);
    assert_eq!(robot.calls.borrow()[6], "OSWait(5) = 0");

    let (code, robot) = run(&text.replace("LIMIT", "3"));
    assert_eq!(code, 7);
    assert_eq!(robot.calls.borrow().last().map(String::as_str), Some("OSWait(5) stopped"));
}

#[test]
fn exit_runs_exit_handlers_once_in_reverse_order() {
    if !has_compiler() {
        return;
    }
    for (end, expected_code, printed) in [
        ("return 4;", 4, "three\ntwo\none\n"),
        ("exit(5);", 5, "three\ntwo\none\n"),
        ("_exit(6);", 6, ""),
        ("_Exit(6);", 6, ""),
        ("quick_exit(8);", 8, "quick\n"),
    ] {
        let (exit_code, robot) = run(&format!(
            r#"
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
static void one(void) {{ puts("one"); }}
static void two(void) {{ puts("two"); exit(99); }}
static void three(int code, void *data) {{ puts(data); }}
static void quick(void) {{ puts("quick"); }}
int main(void)
{{
    atexit(one);
    atexit(two);
    on_exit(three, "three");
    at_quick_exit(quick);
    {end}
}}"#
        ));
        let expected_code = if printed.starts_with("three") { 99 } else { expected_code };
        assert_eq!((exit_code, robot.printed().as_str()), (expected_code, printed), "{end}");
    }
}

#[test]
fn abort_and_failed_assertions_end_the_robot_as_failed() {
    if !has_compiler() {
        return;
    }
    for level in LEVELS {
        let text = "#include <assert.h>\nint main(int n, char **a)\n{\n    assert(n == 2 && a);\n    return 0;\n}";
        let (code, robot) = build(&[text], level, &[]).run(Robot::default(), &[]);
        assert_eq!(code, EXIT_ABORTED);
        let expected = "program0.c:4: main: assertion `n == 2 && a` failed".to_owned();
        assert_eq!(*robot.failures.borrow(), [(support::failure::ASSERTION, expected)]);
    }
    let (code, robot) = run("#include <stdlib.h>\n#include <stdio.h>\nint main(void) { printf(\"last\"); abort(); }");
    assert_eq!((code, robot.printed().as_str()), (EXIT_ABORTED, "last"));
    assert_eq!(*robot.failures.borrow(), [(support::failure::ABORT, "abort() was called".to_owned())]);
}

#[test]
fn an_overrun_array_ends_the_robot_and_not_the_host() {
    if !has_compiler() {
        return;
    }
    let fortified = &["-O2", "-U_FORTIFY_SOURCE", "-D_FORTIFY_SOURCE=2", "-w"];
    let text = "#include <string.h>\n#include <stdio.h>\n\
                int main(int n, char **a) { char b[4]; strcpy(b, a[1]); puts(b); return 0; }";
    let (code, robot) = build(&[text], fortified, &[]).run(Robot::default(), &["far too long"]);
    assert_eq!(code, EXIT_ABORTED);
    let expected = "buffer overflow detected in strcpy: 13 bytes into 4".to_owned();
    assert_eq!(*robot.failures.borrow(), [(support::failure::STACK, expected)]);

    let protected = &["-O0", "-fstack-protector-all", "-w"];
    let text = "int f(volatile int n) { volatile char b[8]; for (int i = 0; i < n; i++) b[i] = 1; return b[0]; }\n\
                int main(void) { return f(40); }";
    let (code, robot) = build(&[text], protected, &[]).run(Robot::default(), &[]);
    assert_eq!((code, robot.failures.borrow().len()), (EXIT_ABORTED, 1));
}

#[test]
fn all_output_goes_to_the_robots_console_line_by_line() {
    if !has_compiler() {
        return;
    }
    let text = r#"
#define _GNU_SOURCE
#include <stdio.h>
#include <stdarg.h>
#include <unistd.h>
#include <errno.h>
#include <err.h>
static void say(const char *format, ...) { va_list a; va_start(a, format); vprintf(format, a); va_end(a); }
int main(int n, char **a)
{
    char name[20];
    int number = 5;
    printf("plain\n");
    printf("%d %s\n", n, a[0]);
    printf("%c", 'c');
    printf("%s\n", "string");
    puts("puts");
    putchar('p');
    putc('q', stdout);
    fputc('r', stdout);
    putchar('\n');
    say("%s", "vprintf\n");
    fprintf(stdout, "fprintf\n");
    fprintf(stdout, "%d fprintf\n", n);
    fputs("fputs\n", stdout);
    fwrite("fwrite\n", 1, 7, stdout);
    dprintf(1, "dprintf %d\n", n);
    write(1, "write\n", 6);
    fflush(NULL);
    fflush(stdout);
    fprintf(stderr, "error\n");
    errno = ENOENT;
    perror("maze.map");
    warnx("warned %d", 3);
    if (scanf("%d", &number) != EOF || number != 5 || getchar() != EOF || getc(stdin) != EOF) return 1;
    if (fgets(name, 20, stdin) != NULL || read(0, name, 20) != 0 || feof(stdin) == 0) return 2;
    setvbuf(stdout, NULL, _IOFBF, 4096);
    printf("buffered\nrest");
    return 0;
}"#;
    let expected = "plain\n1 program\ncstring\nputs\npqr\nvprintf\nfprintf\n1 fprintf\nfputs\nfwrite\ndprintf 1\nwrite\n\
                buffered\nrest";
    for level in LEVELS {
        let flags = [level, &["-w"]].concat();
        let (code, robot) = build(&[text], &flags, &[]).run(Robot::default(), &[]);
        assert_eq!((code, robot.printed().as_str()), (0, expected), "{level:?}");
        let lines: Vec<_> = expected.split_inclusive('\n').collect();
        assert_eq!(*robot.out.borrow(), lines, "{level:?}");
        let errors = "error\nmaze.map: No such file or directory\nsquare: warned 3\n";
        assert_eq!(robot.err.borrow().concat(), errors, "{level:?}");
    }
}

#[test]
fn each_copy_has_its_own_random_numbers() {
    if !has_compiler() {
        return;
    }
    let text = r#"
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <sys/random.h>
int main(int n, char **a)
{
    int i, first;
    unsigned short state[3] = {1, 2, 3};
    unsigned char bytes[11] = {0};
    if (n > 1) { srand(atoi(a[1])); srandom(atoi(a[1])); }
    for (i = 0; i < 5; i++) printf("%d %ld %ld ", rand(), random(), lrand48());
    srand48(1);
    printf("| %ld ", lrand48());
    printf("%.6f %ld", drand48(), nrand48(state));
    if (getrandom(bytes, 11, 0) != 11 || getentropy(bytes, 300) != -1) return 1;
    srand(5); first = rand(); rand(); srand(5);
    if (rand() != first || first < 0 || random() < 0) return 2;
    return 0;
}"#;
    let program = build(&[text], &["-O2", "-w"], &[]);
    let printed = |robot, seed: &[&str]| {
        let (code, robot) = program.run(Robot::numbered(robot), seed);
        assert_eq!(code, 0);
        robot.printed()
    };
    assert_eq!(printed(1, &[]), printed(1, &[]), "a run is a function of its seed");
    assert_ne!(printed(1, &[]), printed(2, &[]), "robots differ");
    assert_ne!(printed(1, &["3"]), printed(1, &["4"]), "seeds differ");
    assert_ne!(printed(1, &["3"]), printed(2, &["3"]), "robots with one seed differ");
    // The generator fixed by POSIX: X = 0x5DEECE66D X + 0xB from 0x1330E, the high 31 bits.
    let x1 = (0x5_DEEC_E66D_u64.wrapping_mul(0x1330E) + 0xB) & 0xFFFF_FFFF_FFFF;
    assert!(printed(1, &[]).contains(&format!("| {} ", x1 >> 17)));
    let argument = 0x0003_0002_0001_u64;
    let next = (0x5_DEEC_E66D_u64.wrapping_mul(argument) + 0xB) & 0xFFFF_FFFF_FFFF;
    assert!(printed(1, &[]).ends_with(&format!(" {}", next >> 17)));

    // Two copies that run at the same time give the same numbers as each copy by itself.
    let alone = [printed(1, &["3"]), printed(2, &["3"])];
    let together = std::thread::scope(|scope| {
        let threads = [1, 2].map(|robot| scope.spawn(move || printed(robot, &["3"])));
        threads.map(|thread| thread.join().expect("the program ends"))
    });
    assert_eq!(alone, together);
}

#[test]
fn each_copy_has_its_own_globals() {
    if !has_compiler() {
        return;
    }
    let program =
        build(&["static int n;\nint count;\nint main(void) { n++; count++; return 10 * n + count; }"], &[], &[]);
    assert_eq!([(); 3].map(|()| program.run(Robot::default(), &[]).0), [11, 11, 11]);
}

#[test]
fn time_is_virtual_and_sleeping_passes_it() {
    if !has_compiler() {
        return;
    }
    let (code, robot) = run(r#"
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>
#include <sys/select.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
#define START 946684800
int main(void)
{
    struct timespec now, half = {0, 500000000}, wrong = {0, -1};
    struct timeval tv, quarter = {0, 250000};
    int point, negative;
    time_t then = START + 86400;
    if (time(NULL) != START) return 1;
    if (sleep(2) != 0 || usleep(500000) != 0 || nanosleep(&half, NULL) != 0) return 2;
    if (clock_gettime(CLOCK_MONOTONIC, &now) != 0 || now.tv_sec != 3 || now.tv_nsec > 10000) return 3;
    if (gettimeofday(&tv, NULL) != 0 || tv.tv_sec != START + 3) return 4;
    if (clock() / CLOCKS_PER_SEC != 3) return 5;
    if (nanosleep(&wrong, NULL) != -1) return 6;
    now.tv_sec = 4; now.tv_nsec = 0;
    if (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &now, NULL) != 0) return 7;
    if (select(0, NULL, NULL, NULL, &quarter) != 0) return 8;
    while (clock() < 4300000) { }
    if (localtime(&then)->tm_mday != 2 || mktime(localtime(&then)) != then) return 9;
    if (strcmp(ctime(&then), "Sun Jan  2 00:00:00 2000\n") != 0) return 10;
    if (alarm(1) != 0) return 11;
    if (strcmp(fcvt(2.5, 1, &point, &negative), "25") != 0 || point != 1 || negative) return 12;
    return 0;
}"#);
    assert_eq!(code, 0);
    assert!((4_300_000..4_300_100).contains(&robot.now_us.get()), "{} us", robot.now_us.get());
    assert_eq!(
        robot.err.borrow().concat(),
        "alarm is not available to robot programs: OSAttachTimer calls a function at intervals\n"
    );
}

#[test]
fn strtok_and_getopt_keep_their_state_in_the_copy() {
    if !has_compiler() {
        return;
    }
    let program = build(
        &[r#"
#define _GNU_SOURCE
#include <getopt.h>
#include <stdio.h>
#include <string.h>
int main(int n, char **a)
{
    static const struct option options[] = {{"kp", 1, 0, 'k'}, {"fast", 0, 0, 'f'}, {0, 0, 0, 0}};
    char text[] = "a,b;c", *part;
    int c, i;
    for (part = strtok(text, ",;"); part; part = strtok(NULL, ",;")) printf("%s ", part);
    while ((c = getopt_long(n, a, "xy:z", options, NULL)) != -1) printf("%c=%s ", c, optarg ? optarg : "-");
    for (i = optind; i < n; i++) printf("[%s]", a[i]);
    return 0;
}"#],
        &["-O2"],
        &[],
    );
    let arguments = ["one", "-xy", "5", "two", "--kp=0.5", "-z", "--kp", "0.7", "--fast", "-q", "--", "-x"];
    for _ in 0..2 {
        let (code, robot) = program.run(Robot::default(), &arguments);
        assert_eq!(code, 0);
        assert_eq!(robot.printed(), "a b c x=- y=5 k=0.5 z=- k=0.7 f=- ?=- [one][two][-x]");
        assert_eq!(robot.err.borrow().concat(), "program: invalid option -- 'q'\n");
    }
}

#[test]
fn functions_of_a_program_take_precedence_over_the_c_library_in_all_its_files() {
    if !has_compiler() {
        return;
    }
    let own = "int time(int x) { return x + 1; }\ndouble y1(double x) { return 2 * x; }\nint index(int a) { return a; }\n\
               int remove(int a) { return a; }\nint send(int a) { return a; }\nint exit_code;\nint rand(void) { return 4; }\n\
               int write(int a) { return 3 * a; }\nint LCDClear(void) { return 6; }\n";
    let main = "#include <stdio.h>\nint main(void) { printf(\"%d %.1f %d %d %d %d %d %d\\n\", time(1), y1(1.5), index(3),\
                remove(4), send(5), rand(), write(7), LCDClear()); return 0; }\n";
    let declared = "int time(int); double y1(double); int index(int); int remove(int); int send(int); int rand(void);\
                    int write(int); int LCDClear(void);\nint printf(const char *, ...);\n";
    let alone = format!("{own}{}", main.replace("#include <stdio.h>", "int printf(const char *, ...);"));
    let user = format!("{declared}{}", main.replace("#include <stdio.h>", ""));
    for level in LEVELS {
        let flags = [level, &["-w"]].concat();
        for files in [&[alone.as_str()][..], &[own, &user], &[&user, own]] {
            let (code, robot) = build(files, &flags, &[]).run(Robot::default(), &[]);
            assert_eq!((code, robot.printed().as_str()), (0, "2 3.0 3 4 5 4 21 6\n"), "{level:?}");
        }
    }
}

#[test]
fn old_programs_share_variables_without_extern() {
    if !has_compiler() {
        return;
    }
    let files = [
        "int shared;\nvoid set(void);\nint main(void) { set(); return shared; }",
        "int shared;\nvoid set(void) { shared = 9; }",
    ];
    assert_eq!(build(&files, &[], &[]).run(Robot::default(), &[]).0, 9);
}

#[test]
fn calls_of_a_constructor_before_the_run_are_harmless() {
    if !has_compiler() {
        return;
    }
    let (code, robot) = run(r#"
#include "eyebot.h"
#include <stdio.h>
#include <stdlib.h>
static int early = 1;
static void at_end(void) { printf("end\n"); }
__attribute__((constructor)) static void begin(void) { early = LCDClear() + rand(); printf("early\n"); atexit(at_end); }
__attribute__((destructor)) static void unload(void) { LCDClear(); printf("late\n"); }
int main(void) { return early; }"#);
    assert_eq!((code, robot.printed().as_str()), (0, "end\n"));
}

#[test]
fn c_and_rust_agree_on_every_layout() {
    if !has_compiler() {
        return;
    }
    let sizes = [
        ("struct eyesim_host", size_of::<Host>()),
        ("struct eyesim_program", size_of::<Program>()),
        ("struct eyesim_support", size_of::<SupportTable>()),
        ("struct eyesim_robios6", size_of::<Robios6Table>()),
        ("struct eyesim_bytes", size_of::<ByteSlice>()),
        ("struct eyesim_room", size_of::<ByteBuffer>()),
        ("struct eyesim_callback", size_of::<Callback>()),
        ("struct eyesim_console", size_of::<Console>()),
        ("struct eyesim_program", size_of::<Program>()),
        ("image", size_of::<Image>()),
        ("colimage", size_of::<ColImage>()),
        ("PositionType", size_of::<PositionType>()),
        ("SpeedType", size_of::<SpeedType>()),
        ("RadioIOParameters", size_of::<RadioIOParameters>()),
        ("RadioStatus", size_of::<RadioStatus>()),
        ("HDT_entry_type", size_of::<HDTEntry>()),
    ];
    let mut text = "#include \"eyebot.h\"\n#include \"abi.h\"\n".to_owned();
    for (name, size) in sizes {
        text += &format!("_Static_assert(sizeof({name}) == {size}, \"{name}\");\n");
    }
    let offset = std::mem::offset_of!(Robios6Table, VWStalled);
    text += &format!("_Static_assert(offsetof(struct eyesim_robios6, VWStalled) == {offset}, \"VWStalled\");\n");
    build(&[&(text + "int main(void) { return 0; }\n")], &[], &[]);
}

#[test]
fn every_interposed_symbol_is_in_a_programs_library() {
    if !has_compiler() {
        return;
    }
    let program = build(&["int main(void) { return 0; }"], &[], &[]);
    // SAFETY: only the shim's constructor runs.
    let library = unsafe { libloading::Library::new(program.path()) }.expect("the program can be loaded");
    let address_of = |name: &str| {
        // SAFETY: only the address of the symbol is used.
        *unsafe { library.get::<*const ()>(name.as_bytes()) }.expect("the symbol exists") as usize
    };
    // A look-up falls back to libc, so the addresses are checked: all must lie in the library's image.
    let (shim_address, max_offset) = (address_of("VWInit"), 1 << 20);
    let is_of_cpp = |name: &str| ["__cxa_thread_atexit_impl", "fopen64"].contains(&name);
    for (name, _) in c::INTERPOSED.iter().filter(|(name, _)| !is_of_cpp(name)) {
        assert!(address_of(name).abs_diff(shim_address) < max_offset, "{name} is not the shim's");
    }
}
