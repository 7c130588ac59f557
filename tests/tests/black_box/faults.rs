//! Injected faults: each kind is on its page, and gives the same results for every executor.

use serde_json::Value;
use tests::{Scratch, root};

/// Blocks of a page in this language.
fn blocks<'a>(page: &'a str, language: &str) -> Vec<&'a str> {
    let fence = format!("```{language}\n");
    page.split(&fence).skip(1).filter_map(|rest| rest.split_once("\n```")).map(|(block, _)| block).collect()
}

/// The scene of docs/faults.md without faults, in a folder with its programs, and the faults.
fn room() -> (Scratch, String, Vec<String>) {
    let page = std::fs::read_to_string(root().join("docs/faults.md")).expect("the page");
    let scratch = Scratch::new();
    for program in blocks(&page, "c") {
        let name = program.lines().next().and_then(|line| line.strip_prefix("// ")).expect("the name of a program");
        scratch.write(name, program);
    }
    let faults = blocks(&page, "toml").into_iter().map(str::to_owned).collect();
    (scratch, blocks(&page, "scene.toml").concat(), faults)
}

fn printed(scratch: &Scratch, trace: &str) -> String {
    let lines = scratch.read(trace);
    let events = lines.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let texts = events.filter(|event| event["event"] == "stdout");
    texts.filter_map(|event| Some(event["text"].as_str()?.to_owned() + "\n")).collect()
}

#[test]
fn faults_act_as_documented() {
    let (scratch, scene, faults) = room();
    let with =
        |word: &str| faults.iter().find(|fault| fault.contains(&format!("kind = \"{word}\""))).expect("an example");
    let run = |name: &str, fault: &str| {
        scratch.write(&format!("{name}.scene.toml"), &format!("{scene}\n{fault}"));
        let report = scratch.report(&format!("{name}.scene.toml"), &["--trace", &format!("{name}.jsonl")], 0);
        (report, printed(&scratch, &format!("{name}.jsonl")))
    };
    let (plain, plain_text) = run("plain", "");
    assert!(plain_text.contains("start") && plain_text.contains("alive 19"), "{plain_text}");

    let (dead, text) = run("dies", with("dies"));
    assert_eq!(dead["robots"][1]["outcome"], "halted", "{dead:#?}");
    assert!(text.contains("alive 3") && !text.contains("alive 6"), "{text}");

    // A stuck sensor reads at the end of the drive the same as at 1 s, before the drive.
    let (_, text) = run("stuck", with("sensor_stuck"));
    let number = |text: &str, word: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(word)).expect("a line");
        line.split_whitespace().next().and_then(|word| word.parse::<i32>().ok()).expect("a number")
    };
    assert_eq!(number(&text, "start "), number(&text, "end "), "{text}");
    assert!((number(&plain_text, "start ") - number(&plain_text, "end ")).abs() > 100, "{plain_text}");

    let off = "[[fault]]\nkind = \"sensor_off\"\nsensor = \"PSD_FRONT\"\nat_s = 0\n";
    let (_, text) = run("off", off);
    assert_eq!(number(&text, "start "), 9999, "{text}");

    // For 1 s at 250 mm/s the robot loses half of the wheels' rolled distance; the odometry does not measure this.
    let (slipped, text) = run("slip", with("slip"));
    let x = |report: &Value| report["robots"][0]["pose"]["x_m"].as_f64().expect("x");
    assert!((x(&plain) - x(&slipped) - 0.125).abs() < 0.005, "{} {}", x(&plain), x(&slipped));
    assert!(text.contains("at 1000") || text.contains("at 999"), "{text}");
}

#[test]
fn faults_are_the_same_for_every_way_of_running_and_repeat() {
    let (scratch, scene, faults) = room();
    scratch.write("all.scene.toml", &format!("{scene}\n{}", faults.join("\n")));
    let digest = |words: &[&str]| scratch.report("all.scene.toml", words, 0)["digest"].clone();
    let first = digest(&["--trace", "t.jsonl"]);
    for words in [&["--exec", "thread"][..], &["--exec", "fiber"], &["--exec", "process"], &["--threads", "2"]] {
        assert_eq!(digest(words), first, "{words:?}");
    }
    assert_eq!(digest(&["--repeat", "t.jsonl"]), first);
    assert_ne!(digest(&["--seed", "8"]), first, "random instants follow the seed");
    let trace = scratch.read("t.jsonl");
    assert!(trace.contains(r#""do":"fault","name":"dies""#), "{trace}");
}

#[test]
fn a_silent_radio_is_not_heard() {
    let scratch = Scratch::new();
    scratch.write(
        "send.c",
        "#include \"eyebot.h\"\nint main() { RADIOInit(); for (int i = 0; i < 8; i++) { OSWait(1000); RADIOSend(2, \"on\"); } return 0; }\n",
    );
    scratch.write(
        "hear.c",
        "#include \"eyebot.h\"\nint main() { int from; char text[32]; RADIOInit();\n\
         for (int i = 0; i < 10; i++) { OSWait(1000); while (RADIOCheck() > 0) { RADIOReceive(&from, text, 32); printf(\"heard\\n\"); } } return 0; }\n",
    );
    let scene = |fault: &str| {
        format!(
            "[world]\nfloor_mm = [3000, 2000]\n[[robot]]\ntype = \"S4\"\nprogram = \"send.c\"\nx_mm = 500\ny_mm = 500\n\
             [[robot]]\ntype = \"S4\"\nprogram = \"hear.c\"\nx_mm = 1500\ny_mm = 500\n{fault}"
        )
    };
    let heard = |name: &str, fault: &str| {
        scratch.write(&format!("{name}.scene.toml"), &scene(fault));
        scratch.report(&format!("{name}.scene.toml"), &["--trace", "t.jsonl"], 0);
        printed(&scratch, "t.jsonl").matches("heard").count()
    };
    assert_eq!(heard("plain", ""), 8);
    for robot in [1, 2] {
        let fault = format!("[[fault]]\nkind = \"radio_off\"\nrobot = {robot}\nat_s = 2.5\nfor_s = 3\n");
        assert_eq!(heard("off", &fault), 5, "robot {robot}: three of eight are lost");
    }
}
