//! Random scenes give the same digest on fibers, threads and processes, with one worker and two.
//!
//! The programs have tasks, globals, cameras, radio and random numbers. The environment variable `EYESIM_SCENES=200`
//! sets the number of scenes; by default there are a few.

use std::fmt::Write as _;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use tests::Scratch;

/// Default number of scenes.
const FEW: u64 = 2;

/// A source of random choices, seeded by the scene's number.
struct Choices {
    scene: u64,
    count: u64,
}

impl Choices {
    fn of(scene: u64) -> Self {
        Self { scene, count: 0 }
    }

    fn below(&mut self, end: u64) -> u64 {
        self.count += 1;
        let mut hasher = DefaultHasher::new();
        (self.scene, self.count).hash(&mut hasher);
        hasher.finish() % end
    }

    fn between(&mut self, first: i64, last: i64) -> i64 {
        first + self.below((last - first + 1) as u64) as i64
    }
}

/// A random statement of a RoBIOS-7 program in the task `task`.
fn statement(choices: &mut Choices, task: usize) -> String {
    match choices.below(15) {
        0 => format!("VWSetSpeed({}, {});", choices.between(-200, 300), choices.between(-60, 60)),
        1 => format!("VWStraight({}, {}); VWWait();", choices.between(-150, 300), choices.between(50, 300)),
        2 => format!("VWTurn({}, {}); VWWait();", choices.between(-90, 90), choices.between(20, 80)),
        3 => format!("mix(PSDGet({}));", choices.between(1, 3)),
        4 => "CAMGet(image); mix(image[sum % QQVGA_SIZE]);".to_owned(),
        5 => "LIDARGet(scan); mix(scan[sum % 360]);".to_owned(),
        6 => format!("LCDPrintf(\"{task} %u\\n\", sum);"),
        7 => format!("printf(\"{task} %u%s\", sum, sum % 3 ? \"\" : \"\\n\");"),
        8 => format!("sprintf(text, \"%u\", sum); RADIOSend({}, text);", choices.between(1, 4)),
        9 => "if (RADIOCheck()) { int from; RADIOReceive(&from, text, sizeof text); mix(from + text[0]); }".to_owned(),
        10 => format!("OSWait({});", choices.between(1, 120)),
        11 => "mix(rand());".to_owned(),
        12 => "mix(OSGetCount());".to_owned(),
        13 => "{ int x, y, phi; VWGetPosition(&x, &y, &phi); mix(x + 7 * y + 31 * phi); }".to_owned(),
        _ => format!("for (volatile int i = 0; i < {}; i++) mix(i);", choices.between(1, 3000)),
    }
}

/// The statements of a task, repeated forever. A wait in each round lets virtual time pass.
fn body(choices: &mut Choices, task: usize) -> String {
    let mut text = String::from("for (;;) {\n");
    for _ in 0..choices.between(2, 8) {
        let _ = writeln!(text, "    {}", statement(choices, task));
    }
    let _ = writeln!(text, "    OSWait({});\n  }}", choices.between(1, 60));
    text
}

/// A RoBIOS-7 program with additional threads that share its globals.
fn program(choices: &mut Choices) -> String {
    let tasks = choices.below(3) as usize;
    let mut text = String::from(
        "#include <pthread.h>\n#include <stdio.h>\n#include <stdlib.h>\n#include \"eyebot.h\"\n\n\
         static unsigned sum = 1;\nstatic BYTE image[QQVGA_SIZE];\nstatic int scan[360];\nstatic char text[200];\n\
         static void mix(unsigned value) { sum = sum * 31 + value; }\n\n",
    );
    for task in 1..=tasks {
        let _ = writeln!(text, "static void *task{task}(void *_)\n{{\n  {}  return _;\n}}\n", body(choices, task));
    }
    text += "int main(void)\n{\n  pthread_t thread;\n  CAMInit(QQVGA);\n  RADIOInit();\n";
    for task in 1..=tasks {
        let _ = writeln!(text, "  pthread_create(&thread, NULL, task{task}, NULL);");
    }
    let _ = writeln!(text, "  {}  return 0;\n}}", body(choices, 0));
    text
}

/// Writes scene `number` to `scratch`.
fn write_scene(number: u64, scratch: &Scratch) {
    let mut choices = Choices::of(number);
    let noise = ["", "noise = \"mild\"\n", "noise = \"real\"\n"][choices.below(3) as usize];
    let mut text = format!(
        "[scene]\nseed = {number}\nuntil_s = 4\n{noise}slot_ms = {}\n\n[world]\nfloor_mm = [3000, 3000]\nwall = [\n",
        choices.between(1, 4) * 25
    );
    for [x1, y1, x2, y2] in [[0, 0, 3000, 0], [3000, 0, 3000, 3000], [3000, 3000, 0, 3000], [0, 3000, 0, 0]] {
        let _ = writeln!(text, "    {{ from_mm = [{x1}, {y1}], to_mm = [{x2}, {y2}] }},");
    }
    text += "]\n";
    let programs = 1 + choices.below(2);
    for program_number in 0..programs {
        scratch.write(&format!("p{program_number}.c"), &program(&mut choices));
    }
    for robot in 0..choices.between(2, 6) {
        let (x, y) = (500 + 700 * (robot % 3), 600 + 900 * (robot / 3));
        let (phi, which) = (choices.between(0, 359), choices.below(programs));
        let _ = writeln!(
            text,
            "\n[[robot]]\ntype = \"S4\"\nprogram = \"p{which}.c\"\nx_mm = {x}\ny_mm = {y}\nphi_deg = {phi}"
        );
    }
    let _ = writeln!(text, "\n[[object]]\ntype = \"Soccer\"\nx_mm = 1500\ny_mm = 2600");
    scratch.write("scene.toml", &text);
}

#[test]
fn random_scenes_have_one_digest_on_every_kind_of_flow() {
    let count = std::env::var("EYESIM_SCENES").map_or(FEW, |count| count.parse().expect("a number of scenes"));
    for number in 0..count {
        let scratch = Scratch::new();
        write_scene(number, &scratch);
        let digest = |args: &[&str]| {
            let mut all = vec!["run", "scene.toml", "--quiet", "--report", "report.json"];
            all.extend(args);
            let ran = scratch.eyesim(&all);
            assert!(ran.code.is_some_and(|code| code < 2), "scene {number}, {args:?}: {}", ran.stderr);
            let report: serde_json::Value =
                serde_json::from_str(&scratch.read("report.json")).expect("a report is JSON");
            let digest = report["digest"].as_str().expect("a digest").to_owned();
            (digest, ran.stderr)
        };
        let (first, output) = digest(&["--exec", "fiber", "--threads", "1"]);
        assert!(!output.contains("runs on a thread"), "scene {number}: {output}");
        for (exec, threads) in [("fiber", "2"), ("thread", "1"), ("thread", "2"), ("process", "2"), ("auto", "2")] {
            let other = digest(&["--exec", exec, "--threads", threads]).0;
            assert_eq!(other, first, "scene {number} with --exec {exec} --threads {threads}");
        }
    }
}
