//! `eyesim check` and `eyesim explain`: output formats, exit codes, folders, and invalid files.

use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::PermissionsExt;

use serde_json::Value;
use tests::{Ran, Scratch};

const GOOD: &str = "floor 1000 1000\n";
/// World with one warning, in line 2.
const WARNED: &str = "floor 1000 1000\n0 0 1000\n";
/// World with one error, in line 2.
const WRONG: &str = "floor 1000 1000\nposition inf 0 0\n";

fn with(files: &[(&str, &str)]) -> Scratch {
    let scratch = Scratch::new();
    for (name, text) in files {
        scratch.write(name, text);
    }
    scratch
}

fn check(scratch: &Scratch, args: &[&str]) -> Ran {
    let all: Vec<&str> = [&["check"], args].concat();
    let ran = scratch.eyesim(&all);
    assert!(!ran.stderr.contains("panicked"), "{ran:#?}");
    ran
}

fn json(ran: &Ran) -> Vec<Value> {
    serde_json::from_str(&ran.stdout).unwrap_or_else(|error| panic!("{error}: {ran:#?}"))
}

/// The codes reported for one file.
fn codes(scratch: &Scratch, name: &str) -> Vec<String> {
    let ran = check(scratch, &[name, "--format", "json"]);
    json(&ran).iter().map(|diagnostic| diagnostic["code"].as_str().expect("a code").to_owned()).collect()
}

#[test]
fn the_exit_code_reports_errors_and_with_strict_also_warnings() {
    let scratch = with(&[("good.wld", GOOD), ("warned.wld", WARNED), ("wrong.wld", WRONG)]);
    for (args, code) in [
        (&["good.wld"][..], 0),
        (&["good.wld", "--strict"], 0),
        (&["warned.wld"], 0),
        (&["warned.wld", "--strict"], 2),
        (&["wrong.wld"], 2),
        (&["good.wld", "warned.wld", "wrong.wld"], 2),
        (&["missing.wld"], 2),
        (&["."], 2),
        (&[], 2),
    ] {
        for format in ["human", "short", "json"] {
            let ran = check(&scratch, &[args, &["--format", format]].concat());
            assert_eq!(ran.code, Some(code), "{args:?} {ran:#?}");
        }
    }
}

#[test]
fn without_a_terminal_there_is_one_line_for_each_mistake() {
    let scratch = with(&[("warned.wld", WARNED), ("wrong.wld", WRONG)]);
    let ran = check(&scratch, &["wrong.wld", "warned.wld"]);
    let expected = "wrong.wld:2:10: error[number-range]: x `inf` is out of range; expected a number in mm from -1000000000 to \
                    1000000000\n\
                    warned.wld:2:1: warning[wld-wall-arity]: a wall of 3 numbers; the line is left out; `push 0 0 1000`, if a frame is meant\n\
                    2 files checked: 1 error, 1 warning in 2 files\n";
    assert_eq!(ran.stdout, expected);
    assert_eq!(check(&scratch, &["wrong.wld", "warned.wld", "--format", "short"]).stdout, expected);
}

#[test]
fn the_short_format_says_what_to_write() {
    let suite = "[suite]\nscene = \"a.sim\"\n[matrix]\nseed = \"0..400000\"\n";
    let sim = "world=good.wld\ncan 1000\nball\nsettings FOO\n";
    let scratch = with(&[("a.sim", sim), ("a.suite.toml", suite), ("good.wld", GOOD)]);
    for (file, line) in [
        ("a.sim", "a.sim:1:1: error[sim-keyword]: `=` follows the keyword `world`; write `world good.wld`"),
        (
            "a.sim",
            "a.sim:2:1: error[sim-place-arity]: `can` has 1 of 3 numbers; expected `NAME X Y PHI` in mm and degrees",
        ),
        (
            "a.sim",
            "a.sim:3:1: warning[sim-keyword]: unknown keyword `ball`; expected one of world, maze, settings, robi, robot, obj, object, marker, or the name of a type with `X Y PHI`",
        ),
        ("a.sim", "a.sim:4:10: warning[sim-setting]: `FOO` is not a setting; expected any of VIS and TRACE"),
        ("a.suite.toml", "a.suite.toml:4:8: error[suite-cases]: `0..400000` has 400001 seeds; expected at most 400000"),
    ] {
        let ran = check(&scratch, &[file, "--format", "short"]);
        assert!(ran.stdout.lines().any(|found| found == line), "{line}: {ran:#?}");
    }
}

#[test]
fn human_format_shows_the_line_and_colour_only_on_request() {
    let scratch = with(&[("warned.wld", WARNED)]);
    let plain = check(&scratch, &["warned.wld", "--format", "human"]).stdout;
    for part in [
        "! warning[wld-wall-arity]: a wall of 3 numbers; the line is left out",
        "╭─[warned.wld:2:1]",
        "2 │ 0 0 1000",
        "help: ",
        "expected `X1 Y1 X2 Y2`",
    ] {
        assert!(plain.contains(part), "{part} in {plain}");
    }
    assert!(plain.ends_with("1 warning in 1 file\nSee `eyesim explain wld-wall-arity`\n"), "{plain}");
    assert!(!plain.contains('\x1b'), "{plain:?}");
    let coloured = check(&scratch, &["warned.wld", "--format", "human", "--color", "always"]).stdout;
    assert!(coloured.contains("\x1b[38;5;32;1mwarning[wld-wall-arity]\x1b[0m"), "{coloured:?}");
    let narrow = scratch.command(&["check", "warned.wld", "--format", "human"]).env("COLUMNS", "40").output();
    let narrow = Ran::from(narrow.expect("eyesim starts")).stdout;
    let reports = narrow.split("1 file checked").next().expect("reports");
    assert!(reports.lines().all(|line| line.chars().count() <= 40) && reports.lines().count() > 8, "{narrow}");
}

#[test]
fn json_is_an_array_with_the_documented_keys() {
    let scratch = with(&[("warned.wld", WARNED), ("good.wld", GOOD)]);
    let said = json(&check(&scratch, &["warned.wld", "--format", "json"]));
    let keys: Vec<&str> = said[0].as_object().expect("an object").keys().map(String::as_str).collect();
    let mut expected =
        ["severity", "code", "file", "start", "end", "line", "column", "message", "expected", "suggestion"];
    expected.sort_unstable();
    assert_eq!(keys, expected);
    assert_eq!(
        (&said[0]["line"], &said[0]["start"], &said[0]["code"]),
        (&2.into(), &16.into(), &"wld-wall-arity".into())
    );
    assert_eq!(check(&scratch, &["good.wld", "--format", "json"]).stdout, "[]\n");
}

#[test]
fn a_folder_stands_for_all_files_below_it() {
    let scratch = with(&[
        ("b.wld", WARNED),
        ("a/c.MAZ", " _\n|_|\n"),
        ("a/notes.txt", "nothing"),
        (".git/d.wld", WRONG),
        ("e/scene.sim", "world ../b.wld\nrobi r.robi prog.c 500 500 0\n"),
        ("e/r.robi", "wheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n"),
        ("e/r.toml", "[drive]\nlag = 1\n"),
        ("e/prog.c", "int main() { return 0; }\n"),
        ("e/Cargo.toml", "[package]\nname = \"e\"\n"),
        (
            "f/all.scene.toml",
            "[world]\nfile = \"../b.wld\"\n\n[[robot]]\ntype = \"S4\"\nx_mm = 500\ny_mm = 500\nnickname = \"Bob\"\n",
        ),
    ]);
    std::os::unix::fs::symlink(scratch.path(), scratch.path().join("a/circle")).expect("a link");
    let ran = check(&scratch, &[".", "--format", "short"]);
    let lines: Vec<&str> = ran.stdout.lines().collect();
    assert_eq!(lines.len(), 4, "{ran:#?}");
    assert!(lines[0].starts_with("b.wld:2:1: warning[wld-wall-arity]"), "{ran:#?}");
    assert!(lines[1].starts_with("e/r.toml:2:1: warning[toml-key]"), "{ran:#?}");
    assert!(lines[2].starts_with("f/all.scene.toml:8:1: warning[toml-key]"), "{ran:#?}");
    assert_eq!(lines[3], "6 files checked: 3 warnings in 3 files");
    fs::create_dir(scratch.path().join("empty")).expect("a folder");
    assert_eq!(codes(&scratch, "empty"), ["folder-empty"]);
    assert_eq!(check(&scratch, &["empty"]).code, Some(2));
}

#[test]
fn a_missing_program_is_a_warning_to_check_and_an_error_to_run() {
    let sim = "world a.wld\nrobi r.robi gone.c 500 500 0\nrobi r.robi lost.c 200 200 0\n";
    let robi =
        "diameter 100\nwheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";
    let scratch = with(&[("a.sim", sim), ("a.wld", GOOD), ("r.robi", robi)]);
    let ran = check(&scratch, &["a.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stdout.contains("a.sim:2:13: warning[program-missing]: program `gone.c` is not found"), "{ran:#?}");
    let ran = scratch.eyesim(&["run", "a.sim"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    for location in ["a.sim:2:13: error[program-missing]", "a.sim:3:13: error[program-missing]"] {
        assert!(ran.stderr.contains(location), "{ran:#?}");
    }
    assert!(ran.stderr.ends_with("error: the scene is not run: 2 errors in 1 file\n"), "{ran:#?}");
}

#[test]
fn scenes_worlds_and_programs_saved_with_txt_are_read() {
    let scratch = with(&[
        ("a.sim.txt", "world w.wld\nS4 500 500 0 go.c\nS4 900 500 0 turn.py\n"),
        ("w.wld.txt", "floor 2000 2000\n0 0 100 0 10 200 255\n"),
        ("go.c.txt", "#include \"eyebot.h\"\nint main(void)\n{\n  VWStraight(100, 100);\n  return VWWait();\n}\n"),
        ("turn.py.txt", "from eye import *\nprint(OSMachineID())\n"),
    ]);
    assert_eq!(codes(&scratch, "w.wld.txt"), ["wld-wall-arity"]);
    let has_python = std::process::Command::new("python3").arg("-V").output().is_ok();
    let sim = if has_python { "a.sim.txt" } else { "b.sim.txt" };
    scratch.write("b.sim.txt", "world w.wld\nS4 500 500 0 go.c\n");
    assert_eq!(codes(&scratch, sim), ["file-moved", "wld-wall-arity"]);
    let ran = scratch.eyesim(&["run", sim]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stderr.contains("`go.c.txt` is used for `go.c`"), "{ran:#?}");
    assert_eq!(scratch.eyesim(&["plot", sim, "-o", "a.svg"]).code, Some(0));
    let listed = check(&scratch, &["."]).stdout;
    assert!(listed.contains("w.wld.txt:2:1: warning[wld-wall-arity]"), "{listed}");
}

#[test]
fn use_of_an_installed_world_is_reported() {
    let scratch = with(&[("a.sim", "world empty.wld\nS4 500 500 0\n")]);
    let told = |ran: &Ran| (ran.stdout.clone() + &ran.stderr).contains("`empty.wld` is that of the installation, `");
    assert!(told(&check(&scratch, &["a.sim", "--strict"])));
    assert!(told(&scratch.eyesim(&["run", "a.sim", "-v", "--until", "1"])));
    let quiet = scratch.eyesim(&["run", "a.sim", "--until", "1"]);
    assert_eq!((quiet.code, told(&quiet)), (Some(0), false), "{quiet:#?}");
    scratch.write("maps/empty.wld", GOOD);
    let warned = scratch.eyesim(&["run", "a.sim", "--until", "1"]);
    assert!(told(&warned) && warned.stderr.contains("write `maps/empty.wld`, if that file is meant"), "{warned:#?}");
}

#[test]
fn a_strict_run_does_not_start_with_a_warning() {
    let sim = "world a.wld\nrobi r.robi p.c 500 500 0\n";
    let robi =
        "diameter 100\nwheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";
    let scratch = with(&[("a.sim", sim), ("a.wld", WARNED), ("r.robi", robi), ("p.c", "int main() { return 0; }\n")]);
    let ran = scratch.eyesim(&["run", "a.sim", "--strict"]);
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{ran:#?}");
    assert!(ran.stderr.contains("a.wld:2:1: warning[wld-wall-arity]"), "{ran:#?}");
    assert!(ran.stderr.ends_with("error: the scene is not run: 1 warning in 1 file\n"), "{ran:#?}");
    let ran = scratch.eyesim(&["run", "a.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stderr.contains("a.wld:2:1: warning[wld-wall-arity]"), "{ran:#?}");
}

#[test]
fn files_that_are_not_text_and_folders_are_reported() {
    let scratch = with(&[("empty.wld", ""), ("empty.sim", ""), ("empty.maz", ""), ("empty.robi", "")]);
    scratch.write("nul.wld", "floor 9 9\n\0\0\n");
    scratch.write("cr.wld", "floor 9 9\r0 0 1\r");
    fs::write(scratch.path().join("latin.wld"), b"floor 9 9\n; gr\xfcn\n").expect("a file");
    fs::create_dir(scratch.path().join("folder.wld")).expect("a folder");
    fs::create_dir_all(scratch.path().join("world.sim")).expect("a folder");
    scratch.write("named.sim", "world folder.wld\nrobi empty.robi p.c 1 1 0\n");
    assert_eq!(codes(&scratch, "empty.wld"), ["wld-floor-missing"]);
    assert_eq!(codes(&scratch, "empty.sim"), ["sim-world-missing", "sim-robot-missing"]);
    assert_eq!(codes(&scratch, "empty.maz"), ["maz-empty"]);
    assert_eq!(codes(&scratch, "empty.robi"), ["robi-wheel-missing", "robi-drive-missing"]);
    assert_eq!(codes(&scratch, "nul.wld"), ["wld-keyword"]);
    assert_eq!(codes(&scratch, "cr.wld"), ["wld-wall-arity"]);
    assert_eq!(codes(&scratch, "latin.wld"), ["file-encoding"]);
    assert_eq!(codes(&scratch, "folder.wld"), ["folder-empty"]);
    assert_eq!(codes(&scratch, "a.xyz"), ["file-missing"]);
    scratch.write("b.xyz", "");
    assert_eq!(codes(&scratch, "b.xyz"), ["file-kind"]);
    assert!(codes(&scratch, "named.sim").contains(&"file-unreadable".to_owned()));
    // The same check with output for humans.
    let ran = check(&scratch, &[".", "--format", "human"]);
    assert!(ran.stdout.contains("cr.wld:2:1") && !ran.stdout.contains('\0'), "{ran:#?}");
}

#[test]
fn a_file_that_may_not_be_read_is_reported() {
    let scratch = with(&[("locked.wld", GOOD)]);
    let path = scratch.path().join("locked.wld");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o000)).expect("permissions");
    if fs::read(&path).is_ok() {
        println!("skipped: this user may read everything");
        return;
    }
    assert_eq!(codes(&scratch, "locked.wld"), ["file-unreadable"]);
}

#[test]
fn file_names_need_not_be_text() {
    let scratch = Scratch::new();
    let names: [&[u8]; 2] = [b"a\xff.wld", b"back\\slash.wld"];
    for name in names {
        fs::write(scratch.path().join(std::ffi::OsStr::from_bytes(name)), WARNED).expect("a file");
    }
    for name in names {
        let mut command = scratch.command(&["check", "--strict"]);
        let ran = Ran::from(command.arg(std::ffi::OsStr::from_bytes(name)).output().expect("eyesim starts"));
        assert_eq!(ran.code, Some(2), "{ran:#?}");
        assert!(ran.stdout.contains(":2:1: warning[wld-wall-arity]"), "{ran:#?}");
    }
    let ran = check(&scratch, &["."]);
    assert!(ran.stdout.ends_with("2 files checked: 2 warnings in 2 files\n"), "{ran:#?}");
}

/// A huge file of one line must fill neither the screen nor the memory.
#[test]
fn one_line_of_many_megabytes_is_handled() {
    let scratch = Scratch::new();
    let size = 4 << 20;
    scratch.write("word.wld", &format!("floor 9 9\n{}", "x".repeat(size)));
    scratch.write("numbers.wld", &format!("floor 9 9\n{}", "1 ".repeat(size / 2)));
    scratch.write("quote.sim", &format!("world \"{}", "y ".repeat(size / 2)));
    scratch.write("row.maz", &format!(" _\n|{}", "|_".repeat(size / 6)));
    scratch.write("key.robi", &"z".repeat(size));
    let huge = fs::File::create(scratch.path().join("huge.wld")).expect("a file");
    huge.set_len(100 << 20).expect("100 MB of nothing");
    assert_eq!(codes(&scratch, "huge.wld"), ["file-unreadable"]);
    for name in ["word.wld", "numbers.wld", "quote.sim", "row.maz", "key.robi"] {
        for format in ["human", "short", "json"] {
            let ran = check(&scratch, &[name, "--format", format]);
            assert!(ran.code.is_some() && ran.stdout.len() < 1 << 20, "{name} {} bytes", ran.stdout.len());
        }
    }
}

#[test]
fn unread_output_is_not_a_failure() {
    let scratch = with(&[("many.wld", &format!("floor 9 9\n{}", "0 0 1\n".repeat(900)))]);
    let mut child = scratch
        .command(&["check", "many.wld", "many.wld"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("eyesim starts");
    drop(child.stdout.take());
    let ran = Ran::from(child.wait_with_output().expect("the process ends"));
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""), "{ran:#?}");
}

#[test]
fn codes_are_explained() {
    let scratch = Scratch::new();
    let ran = scratch.eyesim(&["explain", "wld-wall-arity"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(
        ran.stdout.starts_with("wld-wall-arity\n\nwarning: the number of values of a wall is not 4, 6 or 9\n"),
        "{ran:#?}"
    );
    let all = scratch.eyesim(&["explain"]).stdout;
    assert!(all.lines().count() > 50 && all.contains("wld-wall-arity"), "{all}");
    let ran = scratch.eyesim(&["explain", "wld-wall-airty"]);
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{ran:#?}");
    assert!(ran.stderr.contains("no code `wld-wall-airty`, but there is `wld-wall-arity`"), "{ran:#?}");
}
