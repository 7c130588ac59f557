//! The commands `eyesim convert` and `eyesim schema`.

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
fn keys_that_a_sim_file_cannot_express_are_named() {
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

/// A program whose calls exist in both generations: it waits 20 ms in RoBIOS-7 and 200 ms in RoBIOS 6.
const OF_BOTH: &str =
    "#include \"eyebot.h\"\nint main(void) { OSWait(20); LCDPrintf(\"%d\", OSGetCount()); return 0; }\n";
const OF_7: &str = "#include \"eyebot.h\"\nint main(void) { VWStraight(100, 100); return VWWait(); }\n";

#[test]
fn generations_survive_a_conversion() {
    let scratch = scene();
    scratch.write("seven.c", OF_7);
    scratch.write("both.c", OF_BOTH);
    scratch.write("later.sim", "world room.wld\nS4 1000 1000 0 later.x\n");
    let sims = [
        ("vr", "S4 500 500 0 seven.x\nLabBot 1500 500 90 seven.x\n", "api = 7\n"),
        ("unsure", "S4 500 500 0 both.x\n", "dialect = \"vr2023\"\n"),
        ("mixed", "S4 500 500 0 both.x\nLabBot 1500 500 90 prog.c\n", "api = 6\n"),
        ("classic", "robi bot.robi both.c 500 500 0\n", "dialect = \"classic\"\n"),
        ("both", "robi bot.robi prog.c 500 500 0\nS4 1500 500 90 seven.x\n", "api = 7\n"),
        ("old", "robi bot.robi\nBot 500 500 0 both.x\n", "dialect = \"vr2018\"\n"),
    ];
    for (name, lines, stated) in sims {
        let (sim, toml, back) = (format!("{name}.sim"), format!("{name}.scene.toml"), format!("{name}-back.sim"));
        scratch.write(&sim, &format!("world room.wld\n{lines}"));
        for (from, to) in [(&sim, &toml), (&toml, &back)] {
            let ran = scratch.eyesim(&["convert", from, "-o", to]);
            assert_eq!(ran.code, Some(0), "{ran:#?}");
        }
        assert!(scratch.read(&toml).contains(stated), "{name}: {}", scratch.read(&toml));
        let digests = [&sim, &toml, &back].map(|scene| scratch.report(scene, &[], 0)["digest"].clone());
        assert!(digests[0].is_string() && digests.iter().all(|digest| *digest == digests[0]), "{name}: {digests:?}");
    }
    // A program that is missing at the time of conversion may later be of either generation.
    assert_eq!(scratch.eyesim(&["convert", "later.sim", "-o", "later.scene.toml"]).code, Some(0));
    for program in [OF_7, PROGRAM, OF_BOTH] {
        scratch.write("later.c", program);
        let digests = ["later.sim", "later.scene.toml"].map(|scene| scratch.report(scene, &[], 0)["digest"].clone());
        assert_eq!(digests[0], digests[1], "{program}");
    }
}

#[test]
fn converted_scenes_run_to_the_same_digests() {
    let scratch = Scratch::new();
    scratch.write("both.c", OF_BOTH);
    let corpus = root().join("../shared/eyesim/corpus");
    if !corpus.is_dir() {
        println!("skipped in part: there are no files of EyeSim at {}", corpus.display());
    }
    let mut sims = sims_below(&root().join("sims"));
    let own = sims.len();
    sims.extend(sims_below(&corpus));
    assert!(own > 20);
    let mut compared = 0;
    for (index, sim) in sims.iter().enumerate() {
        let toml = format!("{index}.scene.toml");
        let path = sim.to_str().expect("UTF-8");
        if scratch.eyesim(&["convert", path, "-o", &toml]).code != Some(0) {
            assert!(index >= own, "{path} converts");
            continue;
        }
        // The programs of the corpus are missing; `both.c` replaces them.
        let robots = if index < own { 0 } else { scratch.read(&toml).matches("[[robot]]").count() };
        let programs: Vec<String> = (1..=robots).map(|robot| format!("--program={robot}=both.c")).collect();
        let args: Vec<&str> = programs.iter().map(String::as_str).collect();
        let both = [path, &toml].map(|scene| {
            let report = format!("{index}.json");
            let ran = scratch.eyesim(&[&["run", scene, "--until", "1", "-q", "--report", &report], &args[..]].concat());
            let read = std::fs::read_to_string(scratch.path().join(&report)).unwrap_or_default();
            let _ = std::fs::remove_file(scratch.path().join(&report));
            let report: serde_json::Value = serde_json::from_str(&read).unwrap_or_default();
            (ran.code, report["digest"].clone())
        });
        assert_eq!(both[0], both[1], "{path}");
        assert!(index >= own || both[0].1.is_string(), "{path} runs");
        compared += usize::from(both[0].1.is_string());
    }
    assert!(compared >= own);
}

/// The sim files below a folder.
fn sims_below(folder: &std::path::Path) -> Vec<std::path::PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    let below = |path: std::path::PathBuf| {
        if path.is_dir() {
            sims_below(&path)
        } else {
            Some(path).filter(|path| path.extension() == Some("sim".as_ref())).into_iter().collect()
        }
    };
    paths.into_iter().flat_map(below).collect()
}

#[test]
fn a_world_becomes_an_occupancy_grid_and_a_world_again() {
    let scratch = Scratch::new();
    scratch.write(
        "room.wld",
        "floor 1000 500\n0 0 1000 0\n1000 0 1000 500\n1000 500 0 500\n0 500 0 0\nposition 200 200 0\n",
    );
    let ran = scratch.eyesim(&["convert", "room.wld", "-o", "map.yaml", "--map-cell", "100"]);
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(0), "map.yaml\nmap.pgm\n"), "{ran:#?}");
    let image = std::fs::read(scratch.path().join("map.pgm")).expect("an image");
    assert!(image.starts_with(b"P5\n12 7\n255\n") && image.len() == 12 + 12 * 7, "{}", image.escape_ascii());
    let ran = scratch.eyesim(&["check", "map.yaml"]);
    let note = "map.yaml: 12 x 7 cells of 100 mm: 50 free, 30 occupied, 4 unknown; 4 walls; (0, 0) of the file is at (100, 100) mm";
    assert!(ran.code == Some(0) && ran.stdout.contains(note), "{ran:#?}");
    let ran = scratch.eyesim(&["convert", "map.yaml", "-o", "again.wld"]);
    assert!(ran.code == Some(0) && ran.stderr.contains("50 free"), "{ran:#?}");
    let mm = |line: &str| line.split(' ').map(|word| word.parse::<f64>().expect("a number").round() as i64).collect();
    let walls: Vec<Vec<i64>> = scratch.read("again.wld").lines().skip(1).map(mm).collect();
    assert_eq!(walls, [[100, 600, 100, 100], [1100, 100, 1100, 600], [100, 100, 1100, 100], [1100, 600, 100, 600]]);
    // A pipe as the image of a map is rejected at once.
    std::fs::remove_file(scratch.path().join("map.pgm")).expect("the image");
    let pipe = scratch.path().join("map.pgm");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    let ran = scratch.eyesim(&["check", "map.yaml"]);
    assert!(ran.code == Some(2) && ran.stdout.contains("it is not a file"), "{ran:#?}");
}

#[test]
fn a_robot_drives_all_scenarios_of_a_map() {
    let scratch = Scratch::new();
    scratch.write("hall.map", "type octile\nheight 2\nwidth 6\nmap\n......\n@@@@@.\n");
    scratch.write("hall.map.scen", "version 1\n0\thall.map\t6\t2\t0\t0\t4\t0\t4\n0\thall.map\t6\t2\t1\t0\t2\t0\t1\n");
    let program = "#include \"eyebot.h\"\n#include <stdlib.h>\n\
                   int main(int argc, char **argv) { VWStraight(atoi(argv[7]), 200); VWWait(); return 0; }\n";
    scratch.write("go.c", program);
    let ran = scratch.eyesim(&["check", "hall.map.scen"]);
    assert!(ran.code == Some(0) && ran.stdout.contains("2 of 2 lengths"), "{ran:#?}");
    let ran = scratch.eyesim(&["convert", "hall.map.scen", "-o", "hall.suite.toml"]);
    assert_eq!(ran.stdout, "hall.suite.toml\nhall.scene.toml\n", "{ran:#?}");
    let ran = scratch.eyesim(&["test", "hall.suite.toml", "--program", "1=go.c"]);
    assert!(ran.code == Some(0) && ran.stdout.contains("2 passed"), "{ran:#?}");
}

#[test]
fn the_drive_through_a_field_of_cylinders_gets_its_score() {
    let suite = root().join("docs/examples/barn/barn.suite.toml");
    let scratch = Scratch::new();
    let ran = scratch.eyesim(&["test", suite.to_str().expect("a path"), "-v"]);
    assert!(ran.code == Some(0) && ran.stdout.contains("2 passed"), "{ran:#?}");
    // The world equals the output of its generator.
    let generator = root().join("docs/examples/barn/generate.py");
    let status = std::process::Command::new("python3").arg(generator).arg("7").output().expect("python3");
    let committed = std::fs::read(root().join("docs/examples/barn/field.world")).expect("the world");
    assert!(status.status.success() && status.stdout == committed, "{}", String::from_utf8_lossy(&status.stderr));
}
