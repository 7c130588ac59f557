//! `eyesim convert` and `eyesim schema` as commands.

use tests::{Scratch, root, write_scene};

const PROGRAM: &str = "#include \"eyebot.h\"\n\
    int main(void) { VWHandle vw = VWInit(VW_DRIVE, 1); VWDriveStraight(vw, 0.3, 0.2); VWDriveWait(vw); return 0; }\n";

/// A folder with a scene of two robots and a can.
fn scene() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("prog.c", PROGRAM);
    write_scene(&scratch, &["prog.c", "prog.c"]);
    let sim = scratch.read("scene.sim");
    scratch.write("scene.sim", &format!("{sim}\ncan 1500 1500 90\nmarker 500 500 255 0 0\n"));
    scratch
}

#[test]
fn a_converted_scene_runs_to_the_same_digest() {
    let scratch = scene();
    for (from, to) in [("scene.sim", "deeper/copy.scene.toml"), ("deeper/copy.scene.toml", "back.sim")] {
        std::fs::create_dir_all(scratch.path().join("deeper")).expect("a folder");
        let ran = scratch.eyesim(&["convert", from, "-o", to]);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        assert!(ran.stdout.contains(to), "the path of what was written: {ran:#?}");
    }
    let digests =
        ["scene.sim", "deeper/copy.scene.toml", "back.sim"].map(|sim| scratch.report(sim, &[], 0)["digest"].clone());
    assert!(digests[0].is_string(), "{digests:?}");
    assert_eq!(digests[0], digests[1]);
    assert_eq!(digests[0], digests[2]);
}

#[test]
fn files_are_replaced_only_by_force_and_sources_never() {
    let scratch = scene();
    let precious = scratch.write("out.scene.toml", "precious");
    let ran = scratch.eyesim(&["convert", "scene.sim", "-o", "out.scene.toml"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert_eq!(std::fs::read_to_string(&precious).expect("it is still there"), "precious");
    let ran = scratch.eyesim(&["convert", "scene.sim", "-o", "out.scene.toml", "--force"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(scratch.read("out.scene.toml").contains("[[robot]]"));
    for input in ["scene.sim", "./scene.sim", "deeper/../scene.sim"] {
        let before = scratch.read("scene.sim");
        let ran = scratch.eyesim(&["convert", "scene.sim", "-o", input, "--force"]);
        assert_ne!(ran.code, Some(0), "{ran:#?}");
        assert_eq!(scratch.read("scene.sim"), before);
    }
}

#[test]
fn what_a_sim_cannot_hold_is_named() {
    let scratch = scene();
    let toml = "[scene]\nseed = 7\n[world]\nfile = \"room.wld\"\n[[robot]]\ntype = \"S4\"\nprogram = \"prog.c\"\n\
                arguments = [\"--fast\"]\nx_mm = 500\ny_mm = 500\n";
    scratch.write("own.scene.toml", toml);
    let ran = scratch.eyesim(&["convert", "own.scene.toml", "-o", "own.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    let said = format!("{}{}", ran.stdout, ran.stderr);
    assert!(said.contains("convert-lost") && said.contains("seed") && said.contains("arguments"), "{ran:#?}");
    assert!(scratch.read("own.sim").contains("500 500"));
}

#[test]
fn nothing_is_written_for_a_scene_with_errors() {
    let scratch = Scratch::new();
    scratch.write("broken.sim", "world missing.wld\nrobi missing.robi prog.c 1 2 3\n");
    for to in ["out.scene.toml", "out.txt", "missing/out.scene.toml"] {
        let ran = scratch.eyesim(&["convert", "broken.sim", "-o", to]);
        assert_eq!(ran.code, Some(2), "{to}: {ran:#?}");
        assert!(!scratch.path().join(to).exists(), "{to}");
    }
}

#[test]
fn the_schema_is_the_one_of_the_docs() {
    let ran = Scratch::new().eyesim(&["schema"]);
    let committed = std::fs::read_to_string(root().join("docs/formats/scene.schema.json")).expect("it is committed");
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert_eq!(ran.stdout.trim(), committed.trim());
}
