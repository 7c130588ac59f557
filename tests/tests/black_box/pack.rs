//! Archives: equal digests on another machine without the packed files, and archives that cannot be trusted.

use serde_json::Value;
use tests::{Scratch, root};

/// Folder `course/` with a scene, its world, a program with a header, a suite, and a robi.
fn course() -> Scratch {
    let scratch = Scratch::new();
    scratch.write(
        "course/worlds/room.wld",
        "floor 3000 2000\n0 0 3000 0\n3000 0 3000 2000\n3000 2000 0 2000\n0 2000 0 0\n",
    );
    scratch.write(
        "course/lab/lab.scene.toml",
        "[world]\nfile = \"../worlds/room.wld\"\n\n[[robot]]\ntype = \"S4\"\nprogram = \"drive.c\"\nx_mm = 500\ny_mm = 500\n",
    );
    scratch.write("course/lab/lib/way.h", "#define WAY 700\n");
    let program =
        "#include \"eyebot.h\"\n#include \"lib/way.h\"\nint main() { VWStraight(WAY, 200); VWWait(); return 0; }\n";
    scratch.write("course/lab/drive.c", program);
    scratch.write(
        "mine/main.c",
        "#include \"eyebot.h\"\nint way(void);\nint main() { VWStraight(way(), 200); VWWait(); return 0; }\n",
    );
    scratch.write("mine/way.c", "int way(void) { return 400; }\n");
    scratch.write("mine/other.c", &program.replace("#include \"lib/way.h\"\n", "").replace("WAY", "300"));
    scratch.write(
        "course/lab/lab.suite.toml",
        "[suite]\nscene = \"lab.scene.toml\"\n[matrix]\nnoise = [\"none\", \"mild\"]\nseed = \"1..3\"\n\
         [[check]]\nkind = \"reach\"\nat_mm = [1200, 500]\nwithin_mm = 60\n",
    );
    scratch
}

fn report(scratch: &Scratch, args: &[&str]) -> Value {
    let ran = scratch.eyesim(&[args, &["--report", "r.json"]].concat());
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    serde_json::from_str(&scratch.read("r.json")).expect("a report")
}

/// Creates a folder that contains only this file of `from`.
fn elsewhere(from: &Scratch, name: &str) -> Scratch {
    let scratch = Scratch::new();
    std::fs::copy(from.path().join(name), scratch.path().join(name)).expect("a copy");
    scratch
}

#[test]
fn a_packed_scene_has_the_same_digest_elsewhere() {
    let course = course();
    // `mine/other.x` is found as `mine/other.c`.
    let programs = ["1=mine/other.c", "1=mine/other.x", "1=mine/main.c,mine/way.c"];
    for programs in [&[][..], &["--program", programs[0]], &["--program", programs[1]], &["--program", programs[2]]] {
        let scene = ["run", "course/lab/lab.scene.toml", "--seed", "7", "--noise", "real"];
        let there = report(&course, &[&scene, programs].concat());
        let pack = ["pack", "course/lab/lab.scene.toml", "-o", "lab.zip", "--seed", "7"];
        let packed = course.eyesim(&[&pack, programs].concat());
        assert_eq!(packed.code, Some(0), "{packed:#?}");
        let here = report(&elsewhere(&course, "lab.zip"), &["run", "lab.zip", "--noise", "real"]);
        assert_eq!(here["digest"], there["digest"]);
        assert_eq!(here["seed"], 7);
    }
}

#[test]
fn pictures_of_archives_and_examples_are_those_of_their_scenes() {
    let course = course();
    let packed = course.eyesim(&["pack", "course/lab/lab.scene.toml", "-o", "lab.zip"]);
    assert_eq!(packed.code, Some(0), "{packed:#?}");
    let shot = |scene: &[&str]| {
        let ran = course.eyesim(&[&["shot"], scene, &["--at", "1", "-o", "view.png"]].concat());
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        std::fs::read(course.path().join("view.png")).expect("a picture")
    };
    let parade = root().join("sims/parade.scene.toml");
    assert!(shot(&["lab.zip"]) == shot(&["course/lab/lab.scene.toml"]));
    assert!(shot(&["--example", "parade"]) == shot(&[parade.to_str().expect("a path")]));
}

#[test]
fn a_packed_suite_has_the_same_rows_elsewhere() {
    let course = course();
    let there = report(&course, &["test", "course/lab/lab.suite.toml"]);
    assert_eq!(course.eyesim(&["pack", "course/lab/lab.suite.toml", "-o", "lab.zip"]).code, Some(0));
    let here = report(&elsewhere(&course, "lab.zip"), &["test", "lab.zip"]);
    let digests = |report: &Value| -> Vec<Value> {
        report["suites"][0]["rows"].as_array().expect("rows").iter().map(|row| row["digest"].clone()).collect()
    };
    assert_eq!(digests(&here), digests(&there));
    assert_eq!(digests(&here).len(), 6);
    // No temporary file of the archive or of the processes remains.
    let temporary = tempfile::tempdir().expect("a folder");
    let other = elsewhere(&course, "lab.zip");
    let ran =
        other.command(&["test", "lab.zip", "-q"]).env("TMPDIR", temporary.path()).status().expect("eyesim starts");
    assert!(ran.success());
    let remaining: Vec<_> = std::fs::read_dir(temporary.path()).expect("a folder").flatten().collect();
    assert!(remaining.is_empty(), "{remaining:?}");
}

#[test]
fn runs_of_archives_are_repeated() {
    let course = course();
    let pack = ["pack", "course/lab/lab.scene.toml", "-o", "lab.zip", "--program", "1=mine/main.c,mine/way.c"];
    assert_eq!(course.eyesim(&pack).code, Some(0));
    assert_eq!(course.eyesim(&["run", "lab.zip", "--trace", "t.jsonl"]).code, Some(0));
    // The archive is beside the trace, in another folder.
    std::fs::create_dir(course.path().join("traces")).expect("a folder");
    std::fs::rename(course.path().join("t.jsonl"), course.path().join("traces/t.jsonl")).expect("a move");
    std::fs::rename(course.path().join("lab.zip"), course.path().join("traces/lab.zip")).expect("a move");
    let ran = course.eyesim(&["replay", "traces/t.jsonl", "--verify"]);
    assert!(ran.code == Some(0) && ran.stdout.starts_with("the same digest: "), "{ran:#?}");
    let is_remarked = ["is not read any more", "has changed"].iter().any(|part| ran.stderr.contains(part));
    assert!(!is_remarked, "{ran:#?}");
    // A case of a suite that fails.
    let suite = course.read("course/lab/lab.suite.toml").replace("[1200, 500]", "[1300, 500]");
    course.write("course/lab/lab.suite.toml", &suite);
    assert_eq!(course.eyesim(&["pack", "course/lab/lab.suite.toml", "-o", "lab.zip"]).code, Some(0));
    let ran = course.eyesim(&["test", "lab.zip", "-k", "none and seed=2"]);
    let command = ran.stdout.lines().find_map(|line| line.split_once("to see it: eyesim view ")).expect("a command").1;
    assert!(command.starts_with("lab.zip/lab/lab.scene.toml --seed=2 "), "{ran:#?}");
    let words: Vec<&str> = command.split(' ').take_while(|word| *word != "--at").collect();
    let ran = course.eyesim(&[&["run"], &words[..]].concat());
    assert!(ran.code == Some(1) && ran.stdout.contains("1300"), "{ran:#?}");
    let ran = course.eyesim(&["test", "lab.zip", "--lf"]);
    assert!(ran.stdout.contains("5 deselected / 1 selected"), "{ran:#?}");
}

#[test]
fn a_scene_of_the_repository_is_packed_with_its_files() {
    let scratch = Scratch::new();
    let scene = root().canonicalize().expect("the root").join("sims/park.sim");
    let scene = scene.to_str().expect("plain text");
    let there = report(&scratch, &["run", scene]);
    assert_eq!(scratch.eyesim(&["pack", scene, "-o", "park.zip"]).code, Some(0));
    let other = elsewhere(&scratch, "park.zip");
    assert_eq!(report(&other, &["run", "park.zip"])["digest"], there["digest"]);
}

#[test]
fn files_that_cannot_be_packed_or_opened_are_reported() {
    let course = course();
    let reports = |args: &[&str], part: &str| {
        let ran = course.eyesim(args);
        assert_eq!(ran.code, Some(2), "{ran:#?}");
        assert!(ran.stderr.contains(part), "{part}: {ran:#?}");
    };
    reports(&["pack", "course/lab/lab.scene.toml", "-o", "lab.tar"], "ends in .zip");
    let world = course.path().join("course/worlds/room.wld");
    let text =
        course.read("course/lab/lab.scene.toml").replace("../worlds/room.wld", world.to_str().expect("plain text"));
    course.write("course/lab/absolute.scene.toml", &text);
    reports(&["pack", "course/lab/absolute.scene.toml", "-o", "a.zip"], "absolute path");
    course.write("broken.zip", "PK\x03\x04 and no more");
    reports(&["run", "broken.zip"], "not a readable archive");
    reports(&["test", "broken.zip"], "not a readable archive");
    reports(&["run", "nowhere.zip"], "nowhere.zip");
}

#[test]
fn programs_of_checks_are_packed_and_run_only_with_permission() {
    let course = course();
    let scene = course.read("course/lab/lab.scene.toml");
    let check = "[[check]]\nkind = \"script\"\nprogram = \"tools/grade.py\"\n";
    course.write("course/lab/lab.scene.toml", &format!("{scene}\n{check}"));
    course.write(
        "course/lab/tools/grade.py",
        "import json, answer\nfrom parts import end\nprint(answer.text + end.text)\n",
    );
    course.write("course/lab/tools/answer.py", "text = '{\"passed\": '\n");
    course.write("course/lab/tools/parts/end.py", "from parts.last import text\n");
    course.write("course/lab/tools/parts/last.py", "text = 'true}'\n");
    let packed = course.eyesim(&["pack", "course/lab/lab.scene.toml", "-o", "lab.zip"]);
    assert_eq!(packed.code, Some(0), "{packed:#?}");
    let here = elsewhere(&course, "lab.zip");
    let ran = here.eyesim(&["run", "lab.zip"]);
    assert!(ran.code == Some(1) && ran.stdout.contains("`--allow-execute` allows it"), "{ran:#?}");
    assert_eq!(report(&here, &["run", "lab.zip", "--allow-execute"])["checks"][0]["passed"], true);
}

/// Archives contain no permissions, owners or paths of the machine on which they were written.
#[test]
fn another_user_gets_the_same_digest() {
    let is_root = std::process::Command::new("id").arg("-u").output().is_ok_and(|output| output.stdout == b"0\n");
    let has_setpriv = std::process::Command::new("setpriv").arg("--version").output().is_ok();
    if !(is_root && has_setpriv) {
        println!("skipped: needs root and setpriv");
        return;
    }
    let course = course();
    let there = report(&course, &["run", "course/lab/lab.scene.toml", "--noise", "real"]);
    assert_eq!(course.eyesim(&["pack", "course/lab/lab.scene.toml", "-o", "lab.zip"]).code, Some(0));
    // A folder that every user can access, with a copy of the binary.
    let folder = tempfile::Builder::new().prefix("eyesim-other-user-").tempdir_in("/tmp").expect("a folder");
    let all = std::os::unix::fs::PermissionsExt::from_mode(0o777);
    std::fs::set_permissions(folder.path(), all).expect("rights");
    let path_of = |name: &str| folder.path().join(name);
    tests::copy_eyesim(&path_of("eyesim"));
    std::fs::copy(course.path().join("lab.zip"), path_of("lab.zip")).expect("a copy");
    let mut command = std::process::Command::new("setpriv");
    command.args(["--reuid=65534", "--regid=65534", "--clear-groups", "./eyesim", "run", "lab.zip", "--noise", "real"]);
    command.args(["--report", "r.json"]).current_dir(folder.path());
    let kept = ["PATH", "LANG"].into_iter().filter_map(|name| Some((name, std::env::var_os(name)?)));
    command.env_clear().envs(kept).env("HOME", folder.path()).env("TMPDIR", folder.path());
    let ran = command.output().expect("a run");
    assert!(ran.status.success(), "{ran:#?}");
    let here: Value = serde_json::from_slice(&std::fs::read(path_of("r.json")).expect("a report")).expect("JSON");
    assert_eq!(here["digest"], there["digest"]);
}
