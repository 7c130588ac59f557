//! A class of submissions: honest ones in every file format, and those that crash, hang, cheat or attack.

use std::io::{Cursor, Write as _};
use std::path::Path;

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// A submission: its name, its files, and the expected content of its row.
pub struct Case {
    /// Name of the student.
    pub name: String,
    /// The submitted files.
    pub form: Form,
    /// The verdict, `passed`, `failed` or `error`, and a part of the message of the first failure.
    pub expected: (&'static str, &'static str),
}

/// The submitted files.
pub enum Form {
    /// A folder with these files.
    Folder(Vec<(&'static str, Vec<u8>)>),
    /// One file, whose name follows that of the student.
    File(&'static str, Vec<u8>),
    /// A folder with one entry that is not a regular file.
    Special(&'static str, Special),
}

/// An entry that is not a regular file.
#[derive(Clone, Copy)]
pub enum Special {
    Fifo,
    Link(&'static str),
}

impl Case {
    /// Writes the submission into `folder`, with `prefix` before its name.
    pub fn write(&self, folder: &Path, prefix: &str) {
        let target = folder.join(format!("{prefix}{}", self.name));
        let write = |path: &Path, bytes: &[u8]| {
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            std::fs::write(path, bytes).expect("a file");
        };
        match &self.form {
            Form::Folder(files) => {
                std::fs::create_dir_all(&target).expect("a folder");
                files.iter().for_each(|(name, bytes)| write(&target.join(name), bytes));
            }
            Form::File(ending, bytes) => write(&folder.join(format!("{prefix}{}{ending}", self.name)), bytes),
            Form::Special(name, special) => {
                std::fs::create_dir_all(&target).expect("a folder");
                let path = target.join(name);
                match special {
                    Special::Link(to) => std::os::unix::fs::symlink(to, path).expect("a link"),
                    Special::Fifo => {
                        let status = std::process::Command::new("mkfifo").arg(path).status().expect("mkfifo");
                        assert!(status.success());
                    }
                }
            }
        }
    }
}

/// A program with these statements in `main`.
pub fn program(body: &str) -> Vec<u8> {
    format!(
        "#include \"eyebot.h\"\n#include <stdio.h>\n#include <stdlib.h>\n#include <string.h>\n#include <signal.h>\n\
         #include <unistd.h>\nint main(void) {{\n{body}\nreturn 0;\n}}\n"
    )
    .into_bytes()
}

/// A program that drives to the goal at this speed.
pub fn honest(speed: u32) -> Vec<u8> {
    program(&format!("VWStraight(900, {speed}); VWWait();"))
}

/// A zip archive.
pub fn zip_of(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        writer.start_file(*name, SimpleFileOptions::default()).expect("an entry");
        writer.write_all(bytes).expect("bytes");
    }
    writer.finish().expect("an archive").into_inner()
}

/// A tar archive.
pub fn tar_of(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut builder = tar::Builder::new(Vec::new());
    for (name, bytes) in entries {
        let mut header = tar::Header::new_gnu();
        header.set_size(bytes.len() as u64);
        header.set_mode(0o644);
        builder.append_data(&mut header, name, *bytes).expect("an entry");
    }
    builder.into_inner().expect("an archive")
}

/// The bytes compressed by gzip.
pub fn gz(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("bytes");
    encoder.finish().expect("an archive")
}

/// The submissions, for grading in `folder`. This folder contains `home` with a `diary.txt`, `lab` with the suite and a
/// `hidden.h`, `in` with the submissions, and `out` with the results.
pub fn class(folder: &Path) -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name: &str, form: Form, verdict: &'static str, message: &'static str| {
        cases.push(Case { name: name.to_owned(), form, expected: (verdict, message) });
    };
    forms(&mut add);
    refused(&mut add);
    not_built(&mut add);
    broken(&mut add);
    liars(&mut add);
    attackers(&mut add, folder);
    for speed in 0..24 {
        add(&format!("honest-{speed}"), Form::Folder(vec![("solve.c", honest(150 + 5 * speed))]), "passed", "");
    }
    cases
}

type Add<'a> = &'a mut dyn FnMut(&str, Form, &'static str, &'static str);

/// Honest programs in every file format.
fn forms(add: Add<'_>) {
    let mine = honest(200);
    add("form-zip", Form::File(".zip", zip_of(&[("lab/solve.c", &mine)])), "passed", "");
    add("form-tar", Form::File(".tar", tar_of(&[("solve.c", &mine)])), "passed", "");
    add("form-tar-gz", Form::File(".tar.gz", gz(&tar_of(&[("./lab/solve.c", &mine)]))), "passed", "");
    add("form-tgz", Form::File(".tgz", gz(&tar_of(&[("solve.c", &mine)]))), "passed", "");
    add("form-file", Form::File(".c", mine.clone()), "passed", "");
    add("form-cpp", Form::File(".cpp", mine.clone()), "passed", "");
    let inner = zip_of(&[("solve.c", &mine)]);
    add("form-nested", Form::File(".zip", zip_of(&[("x/lab.zip", &inner)])), "passed", "");
    add("form-folder-zip", Form::Folder(vec![("lab.zip", inner.clone())]), "passed", "");
    let mac: [(&str, &[u8]); 3] = [("lab/solve.c", &mine), ("__MACOSX/lab/._solve.c", b"x"), ("lab/.DS_Store", b"x")];
    add("form-mac", Form::File(".zip", zip_of(&mac)), "passed", "");
    add("form-windows", Form::File(".zip", zip_of(&[("lab\\solve.c", &mine)])), "passed", "");
    for name in ["Ana María Núñez", "王小明", "محمد", "Ω 🙂", "a, b = c", "<b>bold<b>", "=SUM(A1)", "\u{1b}[31mred"]
    {
        add(name, Form::Folder(vec![("Übung 1, neu/lösung = 1.c", mine.clone())]), "passed", "");
    }
    let several = vec![
        ("src/main.c", b"#include \"eyebot.h\"\n#include \"../inc/way.h\"\nint main() { return go(WAY); }\n".to_vec()),
        (
            "src/go.c",
            b"#include \"eyebot.h\"\nint go(int way) { VWStraight(way, 200); VWWait(); return 0; }\n".to_vec(),
        ),
        ("inc/way.h", b"#define WAY 900\nint go(int);\n".to_vec()),
    ];
    add("form-several", Form::Folder(several), "passed", "");
    add("form-copy", Form::Folder(vec![("solve.c", mine.clone()), ("lab.zip", inner)]), "passed", "");
}

/// Submissions that are not unpacked or contain nothing to build.
fn refused(add: Add<'_>) {
    let mine = honest(200);
    add("refused-empty-folder", Form::Folder(vec![]), "error", "no file fits");
    add("refused-empty-zip", Form::File(".zip", zip_of(&[])), "error", "no file fits");
    add("refused-no-zip", Form::File(".zip", Vec::new()), "error", "not a readable archive");
    add(
        "refused-cut-zip",
        Form::File(".zip", zip_of(&[("solve.c", &mine)])[..60].to_vec()),
        "error",
        "not a readable archive",
    );
    add(
        "refused-cut-tgz",
        Form::File(".tgz", gz(&tar_of(&[("solve.c", &mine)]))[..40].to_vec()),
        "error",
        "not a readable archive",
    );
    add(
        "refused-outside",
        Form::File(".zip", zip_of(&[("../../solve.c", &mine)])),
        "error",
        "leads out of the archive",
    );
    add(
        "refused-absolute",
        Form::File(".zip", zip_of(&[("/tmp/solve.c", &mine)])),
        "error",
        "leads out of the archive",
    );
    let zeros = vec![b' '; 64 << 20];
    let bomb: Vec<(String, &[u8])> = (0..5).map(|index| (format!("{index}.c"), &zeros[..])).collect();
    let bomb: Vec<(&str, &[u8])> = bomb.iter().map(|(name, bytes)| (name.as_str(), *bytes)).collect();
    add("refused-bomb", Form::File(".zip", zip_of(&bomb)), "error", "more than 256 MiB");
    let mut deep = zip_of(&[("solve.c", &mine)]);
    for _ in 0..5 {
        deep = zip_of(&[("a.zip", &deep)]);
    }
    add("refused-deep", Form::File(".zip", deep), "error", "lies too deep");
    add("refused-rar", Form::File(".rar", b"Rar!".to_vec()), "error", "no file fits");
    add("refused-text", Form::Folder(vec![("essay.txt", b"I drove well".to_vec())]), "error", "no file fits");
    add("refused-fifo", Form::Special("solve.c", Special::Fifo), "error", "no file fits");
    add("refused-link", Form::Special("solve.c", Special::Link("/etc/passwd")), "error", "no file fits");
    add("refused-link-to-folder", Form::Special("lab", Special::Link("/etc")), "error", "no file fits");
    let two = vec![("v1/solve.c", mine.clone()), ("v2/solve.c", honest(150))];
    add("refused-two-versions", Form::Folder(two), "error", "have the same name");
    let kinds = vec![("solve.c", mine), ("solve.so", b"\x7fELF".to_vec())];
    add("refused-two-kinds", Form::Folder(kinds), "error", "several kinds");
}

/// Programs that cannot be built or loaded.
fn not_built(add: Add<'_>) {
    let text = |text: &str| text.as_bytes().to_vec();
    add("build-mistake", Form::File(".c", program("VWStraight(900, 200) VWWait();")), "error", "error:");
    add(
        "build-no-header",
        Form::File(".c", text("#include \"mine.h\"\nint main() { return 0; }\n")),
        "error",
        "mine.h",
    );
    let mains = vec![("a.c", program("VWWait();")), ("b.c", program("VWWait();"))];
    add("build-two-mains", Form::Folder(mains), "error", "main");
    add("build-empty", Form::File(".c", Vec::new()), "error", "");
    add("build-binary", Form::File(".c", (0..=255).collect()), "error", "");
    add("build-includes-itself", Form::File(".c", text("#include __FILE__\n")), "error", "");
    let mut elf = vec![0; 64];
    elf[..20].copy_from_slice(&[0x7f, b'E', b'L', b'F', 2, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 183, 0]);
    add("build-wrong-architecture", Form::Folder(vec![("solve.so", elf)]), "error", "");
}

/// Programs that fail or hang.
fn broken(add: Add<'_>) {
    let mut file = |name: &str, body: &str, message| add(name, Form::File(".c", program(body)), "failed", message);
    file("run-nothing", "", "goal");
    file("run-exit-0", "exit(0);", "goal");
    file("run-exit-3", "exit(3);", "exit code 3");
    file("run-abort", "abort();", "abort");
    file("run-null", "volatile int *p = 0; *p = 1;", "segmentation fault");
    file("run-loop", "for (volatile int i = 0;; i++);", "too long without");
    file("run-waits", "KEYWait(KEY4);", "KEY4");
    file("run-divides", "volatile int x = 0; x = 7 / x;", "arithmetic");
    file(
        "run-recursion",
        "volatile char a[1 << 20]; memset((void *)a, 1, sizeof a); main(); a[0]++;",
        "stack overflow",
    );
    file(
        "run-signals-blocked",
        "sigset_t s; sigfillset(&s); sigprocmask(SIG_BLOCK, &s, 0); for (;;);",
        "too long without",
    );
    file("run-wrong-way", "VWStraight(-300, 200); VWWait();", "goal");
}

/// Programs that drive honestly but pretend to have better results, or attack the readers of the results.
fn liars(add: Add<'_>) {
    let drive = "VWStraight(900, 200); VWWait();";
    let mut file = |name: &str, body: &str, verdict, message| {
        add(name, Form::File(".c", program(&body.replace("DRIVE", drive))), verdict, message);
    };
    file(
        "lie-prints-html",
        "printf(\"\\033[31m</pre><script>alert(1)</script>\\n\"); VWStraight(100, 100); VWWait();",
        "failed",
        "goal",
    );
    // The reason is a long time without a call or too much processor time, whichever occurs first.
    file(
        "lie-gigabytes",
        "char a[4096]; memset(a, 'x', sizeof a); for (long i = 0; i < 1L << 28; i++) fwrite(a, 1, sizeof a, stdout); DRIVE",
        "failed",
        "",
    );
    file(
        "lie-long-lines",
        "char a[4096]; memset(a, 'x', sizeof a); for (int i = 0; i < 100; i++) fwrite(a, 1, sizeof a, stdout); DRIVE",
        "passed",
        "",
    );
    file(
        "lie-forged-report",
        "FILE *f = fopen(\"report.json\", \"w\"); if (f) { fputs(\"{\\\"points\\\": 99}\", f); fclose(f); } exit(0);",
        "failed",
        "goal",
    );
    file("lie-sets-robot", "SIMSetRobot(0, 1400, 500, 0, 0); OSWait(1000);", "failed", "goal");
    file("lie-prints-verdict", "puts(\"PASSED 4 of 4 points\");", "failed", "goal");
    let scene =
        b"[world]\nfloor_mm = [9000, 9000]\n[[robot]]\ntype = \"S4\"\nprogram = \"solve.c\"\nx_mm = 1400\ny_mm = 500\n"
            .to_vec();
    let files = vec![
        ("solve.c", program("")),
        ("lab.scene.toml", scene.clone()),
        ("lab.suite.toml", b"[suite]\nscene = \"lab.scene.toml\"\n".to_vec()),
        ("room.wld", b"floor 1 1\n".to_vec()),
    ];
    add("lie-own-scene", Form::Folder(files), "failed", "goal");
    let outside = zip_of(&[("solve.c", &program("")), ("../lab.scene.toml", &scene)]);
    add("lie-scene-outside", Form::File(".zip", outside), "error", "leads out of the archive");
    let early =
        b"#include \"eyebot.h\"\n__attribute__((constructor)) static void early(void) { VWStraight(900, 200); }\n\
                  int main(void) { return 0; }\n";
    add("lie-constructor", Form::File(".c", early.to_vec()), "passed", "");
}

/// A program that attempts forbidden actions: `CLOSED(attempt)` exits with 40 if the attempt succeeds. It exits with 7
/// if none succeeds.
fn attack(body: &str, folder: &Path) -> Vec<u8> {
    let text = format!(
        "#define _GNU_SOURCE\n#include \"eyebot.h\"\n#include <errno.h>\n#include <fcntl.h>\n#include <pthread.h>\n#include <signal.h>\n\
         #include <stdio.h>\n#include <stdlib.h>\n#include <string.h>\n#include <sys/mman.h>\n#include <sys/ptrace.h>\n\
         #include <sys/socket.h>\n#include <sys/stat.h>\n#include <sys/syscall.h>\n#include <sys/uio.h>\n#include <time.h>\n\
         #include <unistd.h>\n\
         #define PLACE \"{}/\"\n\
         #define CLOSED(attempt) do {{ if ((attempt) >= 0) exit(40); }} while (0)\n\
         extern char **environ;\n\
         static void *idle(void *x) {{ for (;;) pause(); return x; }}\n\
         static double now(void) {{ struct timespec t; syscall(SYS_clock_gettime, 1, &t); return t.tv_sec + t.tv_nsec / 1e9; }}\n\
         int main(void) {{\nchar name[4096];\n(void)name; (void)idle; (void)now;\n{body}\nexit(7);\n}}\n",
        folder.display()
    );
    text.into_bytes()
}

/// Programs that attack the machine, the grader, its files or other submissions. Loops are bounded, so a hole in the
/// sandbox harms no machine.
fn attackers(add: Add<'_>, folder: &Path) {
    const FAILS: &str = "exit code 7";
    let mut file = |name: &str, body: &str, verdict, message| {
        add(&format!("attack-{name}"), Form::File(".c", attack(body, folder)), verdict, message);
    };
    file(
        "fork-bomb",
        "for (int i = 0; i < 500; i++) { int p = fork(); if (p < 0) exit(7); if (!p) for (;;) pause(); }\nexit(40);",
        "failed",
        FAILS,
    );
    // If a limit on processes applies, creating threads fails; otherwise the simulator counts them.
    file(
        "thread-bomb",
        "for (int i = 0; i < 2000; i++) { pthread_t t; if (pthread_create(&t, 0, idle, 0)) break; }\nfor (;;) pause();",
        "failed",
        "",
    );
    file(
        "memory-bomb",
        "for (int i = 0; i < 200; i++) { char *p = malloc(64 << 20); if (!p) exit(7); *p = 1; }\nexit(40);",
        "failed",
        FAILS,
    );
    file("stop", "raise(SIGSTOP); VWStraight(900, 200); VWWait();", "failed", "stopped its own process");
    file("signals-parent", "CLOSED(kill(getppid(), SIGTERM)); CLOSED(kill(getppid(), SIGSTOP));", "failed", FAILS);
    file(
        "deletes-home",
        "CLOSED(unlink(PLACE \"home/diary.txt\")); CLOSED(rmdir(PLACE \"home/photos\")); CLOSED(rename(PLACE \"home\", PLACE \"gone\"));\n\
         CLOSED(truncate(PLACE \"home/diary.txt\", 0)); CLOSED(open(PLACE \"home\", O_RDONLY | O_DIRECTORY));\n\
         snprintf(name, sizeof name, \"%s/diary.txt\", getenv(\"HOME\")); CLOSED(open(name, O_RDWR));",
        "failed",
        FAILS,
    );
    file(
        "network",
        "for (int family = 0; family < 48; family++) { CLOSED(socket(family, SOCK_STREAM, 0)); CLOSED(socket(family, SOCK_DGRAM, 0)); }\n\
         int pair[2]; CLOSED(socketpair(AF_UNIX, SOCK_STREAM, 0, pair));",
        "failed",
        FAILS,
    );
    // The reason is a long time without a call or too much processor time, whichever occurs first.
    file(
        "gigabyte",
        "static char b[1 << 20]; memset(b, 'x', sizeof b); for (int i = 0; i < 65536; i++) if (write(1, b, sizeof b) < 0) break;",
        "failed",
        "",
    );
    file(
        "judge",
        "CLOSED(open(PLACE \"lab/lab.suite.toml\", O_RDWR)); CLOSED(open(PLACE \"lab/lab.scene.toml\", O_RDONLY));\n\
         CLOSED(open(PLACE \"lab/hidden.h\", O_RDONLY)); CLOSED(open(PLACE \"out/grades.csv\", O_WRONLY | O_CREAT, 0600));\n\
         CLOSED(open(PLACE \"out/graded/forged.json\", O_WRONLY | O_CREAT, 0600)); CLOSED(open(PLACE \"in\", O_RDONLY));\n\
         snprintf(name, sizeof name, \"/proc/%d/mem\", getppid()); CLOSED(open(name, O_RDWR));\n\
         for (int f = 0; f < 64; f++) { snprintf(name, sizeof name, \"/proc/%d/fd/%d\", getppid(), f); CLOSED(open(name, O_RDWR)); }",
        "failed",
        FAILS,
    );
    file(
        "own-page",
        "OSWait(10); for (int f = 3; f < 9; f++) { unsigned *p = mmap(0, 4096, 3, MAP_SHARED, f, 0); if (p != MAP_FAILED) {\n\
         p[3] = 0xffffff; p[4] = 0xffffffff; p[2] = 1; for (;;); } }",
        "failed",
        "an invalid message",
    );
    file(
        "other-page",
        "for (int p = getppid() - 50; p < getppid() + 200; p++) { snprintf(name, sizeof name, \"/proc/self/task/%d\", p);\n\
         if (!access(name, F_OK)) continue; for (int f = 3; f < 20; f++) {\n\
         snprintf(name, sizeof name, \"/proc/%d/fd/%d\", p, f); CLOSED(open(name, O_RDWR)); } }",
        "failed",
        FAILS,
    );
    file(
        "ptrace",
        "long word; struct iovec own = { &word, 8 }, other = { environ, 8 };\n\
         CLOSED(ptrace(PTRACE_ATTACH, getppid(), 0, 0)); CLOSED(ptrace(PTRACE_SEIZE, getppid(), 0, 0)); CLOSED(ptrace(PTRACE_TRACEME, 0, 0, 0));\n\
         CLOSED(syscall(SYS_process_vm_readv, getppid(), &own, 1, &other, 1, 0)); CLOSED(syscall(SYS_pidfd_open, getppid(), 0));",
        "failed",
        FAILS,
    );
    file(
        "shell",
        "setenv(\"LD_PRELOAD\", \"/tmp/x.so\", 1); execl(\"/bin/sh\", \"sh\", \"-c\", \"echo x > \" PLACE \"home/diary.txt; rm -rf \" PLACE \"home\", NULL);",
        "failed",
        "",
    );
    // Programs that drive honestly and look for signs that they are being graded.
    file(
        "environment",
        "if (getenv(\"LD_PRELOAD\")) exit(41);\n\
         for (char **e = environ; *e; e++) if (strstr(*e, \"SECRET\") || strstr(*e, \"GRADE\")) exit(42);\n\
         if (time(0) > 1700000000) exit(43);\nVWStraight(900, 200); VWWait(); exit(0);",
        "passed",
        "",
    );
    file(
        "clock",
        "double begin = now(); OSWait(15000); if (now() - begin < 14) exit(7); VWStraight(900, 900); VWWait();",
        "failed",
        FAILS,
    );
    let mut text = |name: &str, text: String, message| {
        add(&format!("attack-{name}"), Form::File(".c", text.into_bytes()), "error", message);
    };
    let main = "int main(void) { return 0; }\n";
    text("includes-hidden", format!("#include \"{}/lab/hidden.h\"\n{main}", folder.display()), "hidden.h");
    text("includes-passwd", format!("#include \"/etc/passwd\"\n{main}"), "passwd");
    text("incbin", format!("__asm__(\".incbin \\\"/etc/passwd\\\"\");\n{main}"), "does not compile");
    text("incbin-shadow", format!("__asm__(\".incbin \\\"/etc/shadow\\\"\");\n{main}"), "does not compile");
}
