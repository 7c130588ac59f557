//! One mistake of each kind, and what is said about it.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::super::*;
use super::{Memory, S4};

const WHEELS: &str = "wheel 54 3600 1100 90\n";
const DRIVE: &str = "drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";

/// A kind of mistake and a text that has it. Robis get the line in place of one of S4's where a whole robot is needed.
const MISTAKES: &[(&str, &str, &str)] = &[
    ("file-encoding", "a.wld", "floor 1 1\n; \u{fffd}"),
    ("file-name-missing", "a.wld", "floor 1 1\nfloor_texture\n"),
    ("file-name-missing", "a.sim", "world\n"),
    ("maz-blank", "a.maz", " _\n| |\n\n|_|\n"),
    ("maz-border", "a.maz", "| |\n|_|\n"),
    ("maz-cell-twice", "a.maz", "360\n _\n|_|\n720\n"),
    ("maz-empty", "a.maz", "# nothing\n360\n"),
    ("maz-letter", "a.maz", " _\n|F|\n|_|\n"),
    ("maz-line", "a.maz", "maze\n _\n|_|\n"),
    ("maz-wall-column", "a.maz", " ___\n||_||\n"),
    ("number-invalid", "a.wld", "floor 1 1\n0 0 1OO 0\n"),
    ("number-invalid", "a.sim", "robi a.robi a.so 100 2,5 east\n"),
    ("number-range", "a.wld", "floor 1 1\n0 0 nan 1e300\n0 0 1 1 10 10 256 0 0\n"),
    ("number-range", "a.maz", " ___\n|___|\n6e8\n"),
    ("number-range", "a.robi", "wheel 0 3600 1100 90\ndiameter -5\n"),
    ("number-range", "a.toml", "[drive]\nwheel_lag_ms = -1\n[input]\nparallel_data = 256\n"),
    ("quote-unclosed", "a.wld", "floor 1 1\nfloor_texture \"a.png\n"),
    ("robi-camera-arity", "a.robi", "camera 0 0\n"),
    ("robi-camera-servo", "a.robi", "camera 0 0 0 SERVO1(-90) 0\n"),
    ("robi-device-twice", "a.robi", "psd PSD_A 1 0 0 0 0\npsd PSD_B 1 0 0 0 0\n"),
    ("robi-device-twice", "a.toml", "[[servo]]\nname = \"S\"\n[[servo]]\nname = \"S\"\n"),
    ("robi-dialect", "a.robi", "collider box 1 2 3 4 5 6\nmass 1 0 0 0\n"),
    ("robi-dialect-track", "a.robi", "axis 22.7 10.8\n"),
    ("robi-drive-arity", "a.robi", "drive OMNI_DRIVE MOTOR_FL QUAD_FL\n"),
    ("robi-drive-kind", "a.robi", "drive DIFERENTIAL_DRIVE A B C D\n"),
    ("robi-drive-missing", "a.robi", ""),
    ("robi-keyword", "a.robi", "diamter 180\nRobi file:\n"),
    ("robi-name-missing", "a.robi", "name ; nobody\n"),
    ("robi-number-missing", "a.robi", "speed\n"),
    ("robi-psd-arity", "a.robi", "psd PSD_FRONT 1 2 3\n"),
    ("robi-psd-id", "a.robi", "psd PSD_FRONT one 1 2 3 4\n"),
    ("robi-psd-name", "a.robi", "psd 1 PSD_FRONT 1 2 3 4\npsd 1 2 3 4 5 6\n"),
    ("robi-wheel-arity", "a.robi", "wheel 54 3600\n"),
    ("robi-wheel-missing", "a.robi", ""),
    ("sim-dialect", "a.sim", "settings VIS\nS4 100 100 0\nrobi a.robi\na 1 2 3\n"),
    ("sim-keyword", "a.sim", "robbi a.robi a.so\nfrobnicate\n"),
    ("sim-object-arity", "a.sim", "object 1 2 3 can.ms3d\n"),
    ("sim-robi-arity", "a.sim", "robi a.robi a.so 1 2\n"),
    ("sim-world-twice", "a.sim", "world a.wld\nmaze b.maz\n"),
    ("toml-key", "a.toml", "[drive]\nwheelbase = 1\n[psd]\nPSD_FRNT = {}\n[input]\nanalog = { 16 = 1 }\n[sonar]\n"),
    ("toml-missing", "a.toml", "[[bumper]]\nid = 3\nfrom_deg = 1\n"),
    ("toml-syntax", "a.toml", "[drive\nwheelbase_mm = = 3\n"),
    ("toml-type", "a.toml", "psd = 3\n[drive]\nwheel_lag_ms = \"fast\"\n[hdt]\nMOTOR_LEFT = 1.5\n"),
    ("wld-floor-arity", "a.wld", "floor 1000\n"),
    ("wld-floor-missing", "a.wld", "0 0 10 10\n"),
    ("wld-height-arity", "a.wld", "width 10\nheight\n"),
    ("wld-keyword", "a.wld", "floor 1 1\nush 1 2 3\nbanana\n"),
    ("wld-pop-empty", "a.wld", "floor 1 1\npop\n"),
    ("wld-position-arity", "a.wld", "floor 1 1\nposition 1 2\n"),
    ("wld-push-arity", "a.wld", "floor 1 1\npush\n0 0 1 1\npop\n"),
    ("wld-wall-arity", "a.wld", "floor 1 1\n0 0 1\n0 0 1 1 wall\n"),
    ("wld-wall-length", "a.wld", "floor 1 1\n5 5 5 5\n"),
    ("wld-width-arity", "a.wld", "width\nheight 10\n"),
    ("word-extra", "a.wld", "floor 1 1 1\npop up\n"),
    ("word-extra", "a.sim", "world my world.wld\n"),
];

/// Mistakes that show only when files are looked for.
const SCENES: &[(&str, &str)] = &[
    ("file-case", "world W.WLD\nrobi S4.robi p.so 1 1 0\n"),
    ("file-missing", "world u.wld\nrobi S4.robi p.so 1 1 0\n"),
    ("file-missing", "world w.wld\nrobi %sim%/S5.robi p.so 1 1 0\n"),
    ("file-moved", "world C:\\x\\w.wld\nrobi S4.robi p.so 1 1 0\n"),
    ("file-unreadable", "world locked.wld\nrobi S4.robi p.so 1 1 0\n"),
    ("sim-robot-missing", "world w.wld\n"),
    ("sim-start-missing", "world w.wld\nrobi S4.robi p.so\n"),
    (
        "sim-start-overlap",
        "world w.wld\nrobi S4.robi p.so 0 0 0\nrobi S4.robi p.so 185 0 0\nrobi S4.robi p.so 371.1 0 0\n",
    ),
    (
        "sim-start-wall",
        "world v.wld\nrobi S4.robi p.so 906 500 0\nrobi S4.robi p.so 500 500 0\nrobi S4.robi p.so 500 102 0\n",
    ),
    ("sim-world-missing", "robi S4.robi p.so 1 1 0\n"),
];

fn diagnostics(file: &str, text: &str) -> Vec<Diagnostic> {
    match path::extension(file).as_str() {
        "wld" => {
            // Stands for bytes that are not UTF-8.
            let bytes: Vec<u8> = text.chars().map(|c| if c == '\u{fffd}' { 0xff } else { c as u8 }).collect();
            let mut files = Memory::new(&[]);
            files.files.insert(file.to_owned(), bytes);
            load_world(file, &files).diagnostics
        }
        "maz" => read_maze(file, text).1,
        "sim" => read_sim(file, text).1,
        "toml" => read_companion(file, text, &mut read_robi("a.robi", S4).0),
        _ => {
            let wheels = if text.is_empty() || text.contains("wheel") { "" } else { WHEELS };
            let drive = if text.is_empty() || text.contains("drive") { "" } else { DRIVE };
            read_robi(file, &format!("{text}{wheels}{drive}")).1
        }
    }
}

fn scene_diagnostics(text: &str) -> Vec<Diagnostic> {
    let files = Memory::new(&[
        ("a.sim", text),
        ("w.wld", "floor 10 10"),
        ("v.wld", "floor 9 9\n1000 0 1000 900\n0 0 900 0 20 100\n"),
        ("S4.robi", S4),
        ("locked.wld", ""),
    ]);
    load_sim("a.sim", &files).diagnostics
}

fn describe(out: &mut String, text: &str, diagnostics: &[Diagnostic]) {
    writeln!(out, "{text:?}").unwrap();
    for diagnostic in diagnostics {
        writeln!(out, "  {diagnostic}\n    expected: {}", diagnostic.expected).unwrap();
        if let Some(suggestion) = &diagnostic.suggestion {
            writeln!(out, "    suggestion: {suggestion}").unwrap();
        }
    }
    out.push('\n');
}

#[test]
fn every_kind_of_mistake() {
    let mut out = String::new();
    for (code, file, text) in MISTAKES {
        let diagnostics = diagnostics(file, text);
        assert!(diagnostics.iter().any(|diagnostic| diagnostic.code == *code), "{code}: {diagnostics:#?}");
        describe(&mut out, text, &diagnostics);
    }
    for (code, text) in SCENES {
        let diagnostics = scene_diagnostics(text);
        assert!(diagnostics.iter().any(|diagnostic| diagnostic.code == *code), "{code}: {diagnostics:#?}");
        describe(&mut out, text, &diagnostics);
    }
    insta::assert_snapshot!("mistakes", out);
}

#[test]
fn a_flood_of_mistakes_is_cut_off() {
    let (_, diagnostics) = read_world("a.wld", &"floor 1 1\nx\n0 0 inf 0\n".repeat(1000));
    assert_eq!(diagnostics.len(), 1001);
    let last = diagnostics.last().expect("a last one");
    assert_eq!((last.code, last.severity), ("file-more", Severity::Error));
    assert_eq!(last.message, "1000 more mistakes in this file are left out");
}

/// Codes in the readers' sources: string literals such as `"wld-keyword"`.
fn codes_in_source() -> BTreeSet<&'static str> {
    let sources = [
        include_str!("../clearance.rs"),
        include_str!("../companion.rs"),
        include_str!("../diagnostic.rs"),
        include_str!("../line.rs"),
        include_str!("../load.rs"),
        include_str!("../maze.rs"),
        include_str!("../path.rs"),
        include_str!("../robi.rs"),
        include_str!("../sim.rs"),
        include_str!("../world.rs"),
    ];
    let families = ["file-", "maz-", "number-", "quote-", "robi-", "sim-", "toml-", "wld-", "word-"];
    let is_code = |text: &&str| {
        families.iter().any(|family| text.starts_with(family))
            && text.chars().all(|c| c == '-' || c.is_ascii_lowercase())
    };
    sources.iter().flat_map(|source| source.split('"')).filter(is_code).collect()
}

#[test]
fn every_code_is_tried_and_documented() {
    let tried =
        MISTAKES.iter().map(|(code, ..)| *code).chain(SCENES.iter().map(|(code, _)| *code)).chain(["file-more"]);
    assert_eq!(tried.collect::<BTreeSet<_>>(), codes_in_source());
    let page = include_str!("../../../../docs/formats.md");
    for code in codes_in_source() {
        assert!(page.contains(&format!("| `{code}` |")), "docs/formats.md has no row for {code}");
    }
}
