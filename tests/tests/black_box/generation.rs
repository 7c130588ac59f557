//! Selection of the RoBIOS generation with which a program is built.

use tests::{Ran, Scratch, write_scene};

const OF_6: &str = "#include \"eyebot.h\"\nint main(void) { VWHandle vw = VWInit(VW_DRIVE, 1); return vw == 0; }\n";
const OF_7: &str = "#include \"eyebot.h\"\nint main(void) { VWStraight(100, 100); VWWait(); return 0; }\n";
const OF_BOTH: &str = "#include \"eyebot.h\"\n// VWInit()\nint main(void) { LCDPrintf(\"VWStraight()\"); return 0; }\n";

/// Runs `text` as `maze.c` in a classic sim file.
fn run(text: &str, args: &[&str]) -> (Scratch, Ran) {
    let scratch = Scratch::new();
    scratch.write("maze.c", text);
    write_scene(&scratch, &["maze.c"]);
    let ran = scratch.eyesim(&[&["run", "scene.sim"], args].concat());
    (scratch, ran)
}

#[test]
fn the_generation_is_printed_once_at_compilation() {
    let (scratch, ran) = run(OF_7, &[]);
    assert!(ran.stderr.contains("maze.c: RoBIOS-7 (VWStraight, VWWait)\n"), "{ran:#?}");
    let again = scratch.eyesim(&["run", "scene.sim"]);
    assert!(!again.stderr.contains("RoBIOS"), "{again:#?}");
    let (_, ran) = run(OF_6, &[]);
    assert!(ran.stderr.contains("maze.c: RoBIOS 6 (VWInit)\n"), "{ran:#?}");
}

#[test]
fn the_dialect_determines_the_generation_if_functions_do_not() {
    let (scratch, ran) = run(OF_BOTH, &[]);
    assert!(ran.stderr.contains("maze.c: RoBIOS 6, as the sim file is"), "{ran:#?}");
    scratch.write("vr.sim", "world room.wld\nS4 1000 1000 0 maze.x\n");
    let ran = scratch.eyesim(&["run", "vr.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stderr.contains("maze.c: RoBIOS-7, as the sim file is; its calls are in RoBIOS 6 as well"), "{ran:#?}");
    scratch.write("maze.c", OF_6);
    let ran = scratch.eyesim(&["run", "vr.sim"]);
    assert!(ran.stderr.contains("maze.c: RoBIOS 6 (VWInit)"), "what it calls goes first: {ran:#?}");
}

#[test]
fn the_command_line_and_the_scene_set_it() {
    let (scratch, ran) = run(OF_BOTH, &["--api", "7"]);
    assert!(ran.stderr.contains("maze.c: RoBIOS-7\n"), "{ran:#?}");
    let robots = "[[robot]]\ntype = \"S4\"\nprogram = \"maze.c\"\nx_mm = 500\ny_mm = 500\n\
                  [[robot]]\ntype = \"S4\"\nprogram = \"maze.c\"\nx_mm = 1500\ny_mm = 500\napi = 6\n";
    scratch.write("a.scene.toml", &format!("[scene]\napi = 7\n[world]\nfloor_mm = [4000, 3000]\n{robots}"));
    scratch.write("maze.c", &format!("{OF_BOTH}\n/* new */"));
    let ran = scratch.eyesim(&["run", "a.scene.toml"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stderr.contains("maze.c: RoBIOS-7\n") && ran.stderr.contains("maze.c: RoBIOS 6\n"), "{ran:#?}");
    let (_, refused) = run(OF_BOTH, &["--api", "5"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("expected 6 or 7"), "{refused:#?}");
}

#[test]
fn a_program_of_the_other_generation_is_reported_with_its_functions() {
    let (scratch, ran) = run(OF_7, &["--api", "6"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    let expected = "error: program `maze.c`: the program calls `VWStraight`, `VWWait` of RoBIOS-7, but `--api` or the \
                    scene states RoBIOS 6: leave that out\n";
    assert!(ran.stderr.starts_with(expected), "{ran:#?}");
    let ran = scratch.eyesim(&["cc", "maze.c", "-o", "maze.so", "--api", "6"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("`VWWait` of RoBIOS-7"), "{ran:#?}");
    // Another mistake in a program of the stated generation is reported alone.
    let (_, ran) = run(&OF_7.replace("return 0", "return x"), &["--api", "7"]);
    assert!(ran.code == Some(2) && !ran.stderr.contains("RoBIOS"), "{ran:#?}");
}

#[test]
fn functions_of_both_generations_are_a_mistake_that_names_them() {
    let mixed = "#include \"eyebot.h\"\nint main(void) { VWInit(VW_DRIVE, 1); VWStraight(1, 2); return 0; }\n";
    let (scratch, ran) = run(mixed, &[]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("`VWInit`") && ran.stderr.contains("`VWStraight`"), "{ran:#?}");
    assert!(ran.stderr.contains("program-generation"), "{ran:#?}");
    let checked = scratch.eyesim(&["check", "--strict", "scene.sim"]);
    assert_eq!(checked.code, Some(2), "{checked:#?}");
    assert!(checked.stdout.contains("program-generation"), "{checked:#?}");
    let checked = scratch.eyesim(&["check", "--api", "6", "scene.sim"]);
    assert!(!checked.stdout.contains("program-generation"), "{checked:#?}");
    let (_, ran) = run(mixed, &["--api", "6"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    let hint = "RoBIOS-7 has `VWStraight`; this program is built for RoBIOS 6 (`--api 7` changes that)";
    assert!(ran.stderr.contains(hint), "{ran:#?}");
}

#[test]
fn cc_builds_for_the_generation_that_is_given_or_detected() {
    let scratch = Scratch::new();
    scratch.write("maze.c", OF_7);
    let ran = scratch.eyesim(&["cc", "maze.c", "-o", "maze.so"]);
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), "maze.c: RoBIOS-7 (VWStraight, VWWait)\n"));
    let refused = scratch.eyesim(&["cc", "--api", "6", "maze.c", "-o", "maze.so"]);
    assert!(refused.stderr.contains("this program is built for RoBIOS 6"), "{refused:#?}");
    // The compiled library contains its generation.
    write_scene(&scratch, &["maze.so"]);
    std::fs::remove_file(scratch.path().join("maze.c")).expect("the source");
    assert_eq!(scratch.eyesim(&["run", "scene.sim"]).code, Some(0));
}
