//! Common mistakes of beginners: the message says what is wrong and what to do.

use tests::{Scratch, write_scene};

/// Standard error of a run of one program, and the exit code.
fn messages(program: &str) -> (String, Option<i32>) {
    let scratch = Scratch::new();
    scratch.write("mine.c", program);
    write_scene(&scratch, &["mine.c"]);
    let ran = scratch.eyesim(&["run", "scene.sim"]);
    (ran.stderr, ran.code)
}

#[test]
fn the_program_is_named_in_place_of_the_scene() {
    let scratch = Scratch::new();
    scratch.write("mine.c", "int main(void) { return 0; }\n");
    let ran = scratch.eyesim(&["run", "mine.c"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert_eq!(ran.stderr.lines().count(), 1, "{ran:#?}");
    assert!(ran.stderr.contains("`mine.c` is no scene"), "{ran:#?}");
    let ran = scratch.eyesim(&["run", "."]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("`.` is a folder"), "{ran:#?}");
}

#[test]
fn a_sensor_is_read_before_it_is_initialised() {
    let (messages, code) = messages("#include \"eyebot.h\"\nint main(void) { PSDGet(PSD_FRONT); return 0; }\n");
    assert_eq!(code, Some(0), "{messages}");
    assert!(messages.contains("`PSDGet` with a handle that `PSDInit` did not give"), "{messages}");
}

#[test]
fn millimetres_are_given_for_metres() {
    let program = "#include \"eyebot.h\"\nint main(void)\n{\n    VWHandle vw = VWInit(VW_DRIVE, 1);\n    \
                   VWDriveStraight(vw, 1000, 0.2);\n    return 0;\n}\n";
    let (messages, code) = messages(program);
    assert_eq!(code, Some(0), "{messages}");
    assert!(messages.contains("RoBIOS 6 takes metres, not millimetres"), "{messages}");
}

#[test]
fn a_function_is_misspelt() {
    let program = "#include \"eyebot.h\"\nint main(void) { LCDPrint(\"hi\"); return 0; }\n";
    let (messages, code) = messages(program);
    assert_eq!(code, Some(2), "{messages}");
    assert!(messages.contains("`LCDPrint` is not defined; did you mean `LCDPrintf`?"), "{messages}");
}

#[test]
fn a_device_is_not_on_this_robot() {
    let (messages, _) = messages("#include \"eyebot.h\"\nint main(void) { PSDInit(PSD_LEFT); return 0; }\n");
    assert!(messages.contains("has no `PSD_LEFT`; of this kind it has: PSD_FRONT"), "{messages}");
}

#[test]
fn a_scene_comes_from_windows() {
    let scratch = Scratch::new();
    scratch.write("sub/mine.c", "int main(void) { return 0; }\r\n");
    write_scene(&scratch, &["sub\\mine.dll"]);
    let scene = scratch.read("scene.sim").replace('\n', "\r\n");
    scratch.write("scene.sim", &scene);
    let ran = scratch.eyesim(&["run", "scene.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
}
