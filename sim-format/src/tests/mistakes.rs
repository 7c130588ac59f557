//! One mistake of each kind, and its diagnostic.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::super::*;
use super::{Memory, S4};

const WHEELS: &str = "wheel 54 3600 1100 90\n";
const DRIVE: &str = "drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";

/// A companion with sonars of these names.
macro_rules! sonars {
    ($($name:literal)*) => { concat!($("[[sonar]]\nname = \"", $name, "\"\n"),*) };
}

/// Kind of a mistake, file name, and text that contains the mistake. Wheels and a drive are added to a robi without
/// them.
const MISTAKES: &[(Code, &str, &str)] = &[
    (
        Code::EsobjArity,
        "a.esObj",
        "box 0 100 0 200 200\nmass\nmass 1 0 0\nname\ncollider\ncapsule 0 0 0 1 4 y\nfixed\n",
    ),
    (Code::EsobjColliderKind, "a.esObj", "fixed\ncollider spere 0 0 0 5\ncapsule 0 0 0 1 5 w\ncolider\n"),
    (Code::EsobjColliderMissing, "a.esObj", "mass 1\n"),
    (Code::EsobjKeyword, "a.esObj", "fixed\nsphere 0 0 0 5\n0\nmas 3\n"),
    (Code::EsobjMassMissing, "a.esObj", "sphere 0 0 0 5\n"),
    (Code::FileEncoding, "a.wld", "floor 1 1\n; \u{fffd}"),
    (Code::FileNameMissing, "a.wld", "floor 1 1\nfloor_texture\n"),
    (Code::FileNameMissing, "a.sim", "world\n"),
    (Code::KeywordTwice, "a.wld", "floor 1 1\nfloor 2 2\n"),
    (Code::KeywordTwice, "a.esObj", "mass 1\nsphere 0 0 0 5\nsphere 0 0 0 6\nmass 2\n"),
    (Code::KeywordTwice, "a.robi", "diameter 180\ndiameter 90\n"),
    (
        Code::LinkCycle,
        "a.toml",
        "[[link]]\nname = \"a\"\non = \"b\"\n[[link]]\nname = \"b\"\non = \"c\"\n[[link]]\nname = \"c\"\non = \"b\"\n",
    ),
    (Code::LinkCycle, "a.toml", "[[link]]\nname = \"a\"\non = \"a\"\n"),
    (Code::LinkServo, "a.toml", "[[servo]]\nname = \"SERVO1\"\n[[link]]\nname = \"a\"\nservo = \"SERVO2\"\n"),
    (Code::LinkTwice, "a.toml", "[[link]]\nname = \"body\"\n[[link]]\nname = \"a\"\n[[link]]\nname = \"a\"\n"),
    (
        Code::LinkUnknown,
        "a.toml",
        "[[link]]\nname = \"head\"\n[[laser]]\nname = \"L\"\non = \"haed\"\n[lidar]\non = \"x\"\n",
    ),
    (Code::MazBlank, "a.maz", " _\n| |\n\n|_|\n"),
    (Code::MazBorder, "a.maz", "| |\n|_|\n"),
    (Code::MazCellFirst, "a.maz", "720\n _\n|_|\n"),
    (Code::MazCellTwice, "a.maz", "360\n _\n|_|\n720\n"),
    (Code::MazEmpty, "a.maz", "# nothing\n360\n"),
    (Code::MazGap, "a.maz", " _\n|S|\n| |\n|s|\n"),
    (Code::MazIndent, "a.maz", "  _\n | |\n |_|\n"),
    (Code::MazLetter, "a.maz", " _ _ # two cells\n|F|#|\n|_|_|\n"),
    (Code::MazLine, "a.maz", "maze\n _\n|_|\n"),
    (Code::MazWallColumn, "a.maz", " ___\n||_||\n"),
    (Code::MazWide, "a.maz", " __ __\n|  |  |\n|__|__|\n"),
    (Code::NumberInvalid, "a.wld", "floor 1 1\n0 0 1OO 0\n"),
    (Code::NumberInvalid, "a.sim", "robi a.robi a.so 100 2,5 east\n"),
    (Code::NumberRange, "a.wld", "floor 1 1\n0 0 nan 1e300\n0 0 1 1 10 10 256 0 0\n"),
    (Code::NumberRange, "a.wld", "floor 0 0\n"),
    (Code::NumberRange, "a.maz", " ___\n|___|\n6e8\n"),
    (Code::NumberRange, "a.robi", "wheel 0 3600 1100 90\ndiameter -5\n"),
    (Code::NumberRange, "a.toml", "[drive]\nwheel_lag_ms = -1\n[input]\nparallel_data = 256\n"),
    (Code::NumberRange, "a.esObj", "mass 0 0 0 0\nmass -1\nscale 0\nbox 0 0 0 1 1 0\nsphere 0 0 0 1e14\n"),
    (Code::QuoteUnclosed, "a.wld", "floor 1 1\nfloor_texture \"a.png\n"),
    (Code::RobiAxelKind, "a.robi", "axel front 1 2\nwheel dirve 40 7200 640 44\naxel\n"),
    (Code::RobiAxelOrder, "a.robi", "diameter 200\ndrive ACKERMANN_DRIVE\naxel drive 20 60\naxel turn 20 -60\n"),
    (Code::RobiBodyMissing, "a.robi", "drive DIFFERENTIAL_DRIVE\nwheel 54 3600 1100 45\n"),
    (Code::RobiCameraArity, "a.robi", "camera 0 0\n"),
    (Code::RobiCameraMissing, "a.robi", "diameter 180\ndrive DIFFERENTIAL_DRIVE\nfisheye 150\n"),
    (Code::RobiCameraServo, "a.robi", "camera 0 0 0 SERVO1(-90) 0\n"),
    (Code::RobiColliderKind, "a.robi", "diameter 180\ndrive DIFFERENTIAL_DRIVE\ncollider boxx 1 2 3 4 5 6\ncollider\n"),
    (Code::RobiDeviceTwice, "a.robi", "psd PSD_A 1 0 0 0 0\npsd PSD_B 1 0 0 0 0\n"),
    (Code::RobiDeviceTwice, "a.robi", "drive DIFFERENTIAL_DRIVE M Q M P\n"),
    (Code::RobiDeviceTwice, "a.toml", "[[servo]]\nname = \"S\"\n[[servo]]\nname = \"S\"\n"),
    (Code::RobiDeviceTwice, "a.toml", "[[laser]]\nname = \"S\"\n[[sonar]]\nname = \"S\"\n"),
    (Code::RobiDeviceTwice, "a.toml", "[lidar]\n[[sonar]]\nname = \"LIDAR\"\n"),
    (Code::RobiDriveArity, "a.robi", "drive OMNI_DRIVE MOTOR_FL QUAD_FL\n"),
    (Code::RobiDriveFirst, "a.robi", "name A\ndiameter 180\ndrive DIFFERENTIAL_DRIVE\n"),
    (Code::RobiDriveKind, "a.robi", "drive DIFERENTIAL_DRIVE A B C D\ndrive differential\n"),
    (Code::RobiDriveMissing, "a.robi", ""),
    (Code::RobiKeyword, "a.robi", "diamter 180\nRobi file:\n"),
    (Code::RobiKeyword, "a.robi", "speed = 300\n// none\nturn 300 // fast\n"),
    (Code::RobiNameMissing, "a.robi", "name ; nobody\n"),
    (Code::RobiNameReserved, "a.robi", "drive DIFFERENTIAL_DRIVE\nname \"S4\"\ndiameter 180\n"),
    (Code::RobiNumberMissing, "a.robi", "speed\n"),
    (
        Code::RobiNumberMissing,
        "a.robi",
        "drive OMNI_DRIVE\ndiameter 9\nmass 2\ncollider box 1 2 3\nlidar\nfisheye\naxel turn 3\n",
    ),
    (
        Code::RobiNumberMissing,
        "a.robi",
        "drive OMNI_DRIVE\ndiameter 9\nmass 2,0,0,0\ncollider sphere 10,0,0,0\naxel drive 10,20\n",
    ),
    (Code::RobiPsdArity, "a.robi", "psd PSD_FRONT 1 2 3\n"),
    (Code::RobiPsdArity, "a.robi", "psd A 1 0 0 0 0\npsd B 2 60 20 30\n"),
    (Code::RobiPsdArity, "a.robi", "psd A,1,0,0,0,0\npsd B 1, 0 0 0 0\nwheel 54,3600,1100,90\n"),
    (Code::RobiPsdArity, "a.robi", "diameter 180\npsd 1 PSD_FRONT 1 2 3 4\n"),
    (Code::RobiPsdId, "a.robi", "psd PSD_FRONT one 1 2 3 4\npsd A 1.0 1 2 3 4\npsd B 1.5 1 2 3 4\n"),
    (Code::RobiPsdName, "a.robi", "psd 1 2 3 4 5 6\n"),
    (
        Code::RobiPsdOrder,
        "a.robi",
        "drive DIFFERENTIAL_DRIVE\ndiameter 180\npsd A 1 2 3 4 5\npsd B 2 3 4 5\npsd C 3 2 3 4 5\n",
    ),
    (Code::RobiPsdTurn, "a.robi", "drive DIFFERENTIAL_DRIVE\ndiameter 180\npsd 1 A 1 2 3 10 90 20\n"),
    (
        Code::RobiRange,
        "a.toml",
        "[[laser]]\nname = \"L\"\nmin_mm = 3000\n[[ultrasonic]]\nname = \"U\"\nmin_mm = 500\nmax_mm = 500\n",
    ),
    (Code::RobiTrackWide, "a.robi", "drive DIFFERENTIAL_DRIVE\ndiameter 180\nwheel 54 3600 1100 91\n"),
    (Code::RobiWheelArity, "a.robi", "wheel 54 3600\n"),
    (Code::RobiWheelMissing, "a.robi", ""),
    (Code::SimMarkerArity, "a.sim", "marker 5\nmarker 1 2 3 4\nmarker 1 2 3 4 5 6 7\n"),
    (
        Code::SimPlaceArity,
        "a.sim",
        "S4 100 200\nLabBot\nS4 1 2 a.py\ncan 5 5\nSign 100 100\nS4 1 x y\nS4 a.c 500 500 0\nS4 Goal 5 5 0 a.c\n",
    ),
    (
        Code::SimPlaceArity,
        "a.sim",
        "S4 maze 5 5 0\nS4 a.c 5 5 0 b.c\nHexapod a.c 5 5 0\nGoal Post 5 5 0\nS4 100,5 200,5 a.c\nS4 \u{2013}2,000 5 0\n",
    ),
    (
        Code::SimPlaceArity,
        "a.sim",
        "S4 500,500,90 a.c\ncan 800,800,0\nLabBot 5,5 0 a.c\nS4 5 5 north a.c\nS4 5 5 \u{2013}90\n",
    ),
    (Code::SimMarkerArity, "a.sim", "marker 700 500 255,0,0\n"),
    (Code::SimSetting, "a.sim", "settings VIS TRACK\n"),
    (Code::SimKeyword, "a.sim", "robbi a.robi a.so\nfrobnicate\nfloor 2000 2000\n"),
    (Code::SimPlaceArity, "a.sim", "MyBot a.c 5 5 0\nmyrobot a.py 5 5 0\nlabbott a.c 5 5 0\n"),
    (Code::SimKeyword, "a.sim", "// S4 5 5 0\n//S4 5 5 0\n/* none */\nS4 5 5 0 a.c // north\nworld a.wld // box\n"),
    (Code::SimKeyword, "a.sim", "0 0 4000 0\n0 0 600 0 20 150 255 0 0\n"),
    (Code::SimKeyword, "a.sim", "world=a.wld\nrobi = \"my bot.robi\" a.so\n"),
    (Code::SimObjectArity, "a.sim", "object 1 2 3 can.ms3d\n"),
    (Code::SimObjectArity, "a.sim", "object can 8 8 0\nobject can.ms3d 8 8 0 0.1\ncan 8 8 0 red\n"),
    (
        Code::SimObjectArity,
        "a.sim",
        "object can 8 8 0 red\nobject stop.esObj 8 8 0\nobj 100 200 0 0.5 can.obj\nobj 100 200 0 can.obj\n",
    ),
    (
        Code::SimRobiArity,
        "a.sim",
        "robi a.robi a.so 1 2\nrobi my bot.robi drive.c 1 2 3\nrobot a.robi 1 2 3 a.so\nrobi s4 1 2 3 a.so\n",
    ),
    (Code::SimRobiArity, "a.sim", "robot s4 5 5 0\nrobot MyBot 5 5 0 a.c\nrobi a.c 5 5 0\n"),
    (Code::SimRobiArity, "a.sim", "robi a.c a.robi 5 5 0\nrobi a.c 5 5 0 a.robi\nrobi a.robi 5 5 0\n"),
    (Code::SimWorldTwice, "a.sim", "world a.wld\nmaze b.maz\n"),
    (
        Code::TomlKey,
        "a.toml",
        "[drive]\nwheelbase = 1\n[psd]\nPSD_FRNT = {}\n[input]\nanalog = { 16 = 1 }\ndigital = { 0 = 1 }\n[serial]\n17 = \"loopback\"\n[radar]\n",
    ),
    (
        Code::NumberRange,
        "a.toml",
        "[[sonar]]\nname = \"S\"\nmin_mm = -1\nmax_mm = 1e300\nthreshold = nan\nrays = 0\nhalf_angle_deg = inf\nsigma = -1\n\
         side_lobes = { angle_deg = 100, gain = 2 }\n[surface]\nspecular = 1.5\n",
    ),
    (Code::SonarBus, "a.toml", sonars!("a" "b" "c" "d" "e" "f" "g" "h" "i" "j" "k" "l" "m" "n" "o" "p" "q" "r")),
    (
        Code::TomlMissing,
        "a.toml",
        "[[laser]]\nid = 3\n[[link]]\naxis = \"y\"\n[[sonar]]\nname = \"\"\npreset = \"SRF8\"\n",
    ),
    (Code::TomlMissing, "a.toml", "[[bumper]]\nid = 3\nfrom_deg = 1\n"),
    (Code::TomlSyntax, "a.toml", "[drive\nwheelbase_mm = = 3\n"),
    (Code::TomlSyntax, "a.toml", "[drive]\nwheel_lag_ms = 50ms\n"),
    (
        Code::TomlSyntax,
        "a.toml",
        "[drive]\nwheel_lag_ms = 090\nwheelbase_mm = .5\nmax_steer_deg = 5.\n[hull]\ndrag_up = [2,000, 3,000]\ndrag_turn = [1,05, 2]\n",
    ),
    (Code::TomlSyntax, "a.toml", "[drive]\nwheel_lag_ms = 3,5\nwheelbase_mm = 50mm\nmax_steer_deg = 2,000\n"),
    (Code::TomlType, "a.toml", "[drive]\nwheel_lag_ms = { uniform = [0, 5] }\n"),
    (Code::TomlType, "a.toml", "psd = 3\n[drive]\nwheel_lag_ms = \"fast\"\n[hdt]\nMOTOR_LEFT = 1.5\n"),
    (Code::WldFloorArity, "a.wld", "floor 1000\n"),
    (Code::WldFloorArity, "a.wld", "floor 2000,3000\npush 1,2,3\n"),
    (Code::WldFloorMissing, "a.wld", "0 0 10 10\n"),
    (Code::WldFloorMissing, "a.wld", "0 0 10 0\n"),
    (Code::WldFloorMissing, "a.wld", "; nothing\n"),
    (Code::WldFloorMissing, "a.wld", "0 0 -10 0\n"),
    (Code::WldHeightArity, "a.wld", "width 10\nheight\n"),
    (Code::WldKeyword, "a.wld", "floor 1 1\nush 1 2 3\nbanana\n"),
    (Code::WldKeyword, "a.wld", "floor = 1 1\nFloor=2 2\n// none\n0 0 1 1 // wall 2\npop // all\n"),
    (Code::WldPopEmpty, "a.wld", "floor 1 1\npop\n"),
    (Code::WldPositionArity, "a.wld", "floor 1 1\nposition 1 2\n"),
    (Code::WldPushArity, "a.wld", "floor 1 1\npush\n0 0 1 1\npop\n"),
    (Code::WldWallArity, "a.wld", "floor 1 1\n5000 0 0\n0,0,0,3000\n0 0 1 1 wall\n0 0 1 1 10\n0 0 1 1 10 200 255\n"),
    (Code::WldWallLength, "a.wld", "floor 1 1\n5 5 5 5\n"),
    (Code::WldWidthArity, "a.wld", "width\nheight 10\n"),
    (Code::WordExtra, "a.wld", "floor 1 1 1\npop up\n"),
    (Code::WordExtra, "a.sim", "S4 1 2 3 a.py fast\ncan 1 2 3 4\nrobi a.robi a.so 1 2 3 4\nobject My Sign.esObj\n"),
    (Code::WordExtra, "a.esObj", "fixed fast\nsphere 0 0 0 5 5\n"),
    (Code::WordExtra, "a.sim", "world my world.wld\n"),
];

/// Mistakes that are detected only when the files of a scene are read.
const SCENES: &[(Code, &str)] = &[
    (Code::FileCase, "world W.WLD\nrobi S4.robi p.so 1 1 0\n"),
    (Code::FileMissing, "world u.wld\nrobi S4.robi p.so 1 1 0\n"),
    (Code::FileKind, "world S4.robi\nrobi v.wld p.so 1 1 0\nobject m.maz\n"),
    (Code::FileMissing, "world w.wld\nrobi S4 p.so 1 1 0\n"),
    (Code::FileMissing, "world w.wld\nrobi %sim%/S5.robi p.so 1 1 0\n"),
    (Code::FileMoved, "world C:\\x\\w.wld\nrobi S4.robi p.so 1 1 0\n"),
    (Code::FileMoved, "world ../../worlds/small/w.wld\nrobi ..\\S4.robi p.so 1 1 0\n"),
    (Code::FileUnreadable, "world locked.wld\nrobi S4.robi p.so 1 1 0\n"),
    (Code::FileMissing, "world w.wld\nobject no.esObj\nrobot no.robi\n"),
    (Code::FileMoved, "world w.wld\nobject C:\\x\\signs/sign.esObj\nS4 5 5 0\n"),
    (Code::SimObjectOutside, "world w.wld\nS4 5 5 0\ncan 500 5 0\n"),
    (Code::SimObjectOverlap, "world v.wld\nS4 500 500 0\ncan 600 500 0\ncan 620 500 0\ngolf 620 560 0\n"),
    (Code::SimObjectShape, "world v.wld\nS4 500 500 0\nobject 800 500 0 0 chair.ms3d\n"),
    (Code::SimObjectWall, "world v.wld\nS4 500 500 0\ncrate 950 200 45\n"),
    (Code::SimPlaceArity, "world m.maz\nS4 U\nobject signs/sign.esObj\nStopSign u\n"),
    (Code::SimRobotMissing, "world w.wld\n"),
    (Code::SimStartLetter, "maze m.maz\nS4 L 90 a.py\nS4 S\nS4 U 45\n"),
    (Code::SimStartLetter, "world w.wld\nS4 S\n"),
    (Code::SimStartOutside, "world w.wld\nS4 11 5 0\n"),
    (Code::SimTypeBelow, "world v.wld\nStopSign 800 800 0\nS4 500 500 0\nobject signs/sign.esObj\n"),
    (Code::SimTypeCase, "world v.wld\nobject signs/sign.esObj\nstopSign 800 800 0\ns4 500 500 0\n"),
    (
        Code::SimTypeTwice,
        "world v.wld\nrobi S4.robi\nobject signs/sign.esObj\nobject ./signs/sign.esObj\nobject stop.esObj\nS4 500 500 0\n",
    ),
    (
        Code::SimTypeUnknown,
        "world v.wld\nStopSign 800 800 0\nLabot 500 500 0 a.py\nwonder S\nobject stop.esObj\nstop 1 2 3\nsoccr 1 2 3\n",
    ),
    (Code::SimTypeUnknown, "world v.wld\nS4 500 500 0\npush 500 700 45\n"),
    (
        Code::SimTypeUnknown,
        "world v.wld\nobject Cone.esObj\nrobot no.robi\nCone 100 100 0\nno 500 500 0 a.py\nother 200 200 0 a.py\n",
    ),
    (Code::SimStartMissing, "world w.wld\nrobi S4.robi p.so\n"),
    (
        Code::SimStartOverlap,
        "world w.wld\nrobi S4.robi p.so 0 0 0\nrobi S4.robi p.so 185 0 0\nrobi S4.robi p.so 371.1 0 0\n",
    ),
    (
        Code::SimStartWall,
        "world v.wld\nrobi S4.robi p.so 906 500 0\nrobi S4.robi p.so 500 500 0\nrobi S4.robi p.so 500 102 0\n",
    ),
    (Code::SimWorldMissing, "robi S4.robi p.so 1 1 0\n"),
    (Code::SimWorldMissing, "labbot 1000 1000 0\n"),
];

fn diagnostics(file: &str, text: &str) -> Vec<Diagnostic> {
    match path::extension(file).as_str() {
        "wld" => {
            // U+FFFD replaces a byte that is not UTF-8.
            let bytes: Vec<u8> = text.chars().map(|c| if c == '\u{fffd}' { 0xff } else { c as u8 }).collect();
            let mut files = Memory::new(&[]);
            files.files.insert(file.to_owned(), bytes);
            load_world(file, &files).diagnostics
        }
        "esobj" => read_esobj(file, text).1,
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
        ("m.maz", " ___\n|U _|\n|___|\n"),
        ("S4.robi", S4),
        ("signs/sign.esObj", "name StopSign\nscale 0.025\nmass 2 0 0 0\ncollider capsule 0 7500 0 150 14200 y\n"),
        ("stop.esObj", "name StopSign\nmass 1\nsphere 0 5 0 5\n"),
        ("locked.wld", ""),
    ]);
    load_scene("a.sim", &files).diagnostics
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

/// One snapshot for each kind of file.
#[test]
fn all_kinds_of_mistakes_match_snapshots() {
    let mut kinds: BTreeMap<String, String> = BTreeMap::new();
    for (code, file, text) in MISTAKES {
        let diagnostics = diagnostics(file, text);
        assert!(diagnostics.iter().any(|diagnostic| diagnostic.code == *code), "{code}: {diagnostics:#?}");
        describe(kinds.entry(path::extension(file)).or_default(), text, &diagnostics);
    }
    for (code, text) in SCENES {
        let diagnostics = scene_diagnostics(text);
        assert!(diagnostics.iter().any(|diagnostic| diagnostic.code == *code), "{code}: {diagnostics:#?}");
        describe(kinds.entry("scene".to_owned()).or_default(), text, &diagnostics);
    }
    for (kind, out) in kinds {
        insta::assert_snapshot!(format!("mistakes-{kind}"), out);
    }
}

#[test]
fn number_of_diagnostics_is_limited() {
    let (_, diagnostics) = read_world("a.wld", &format!("floor 1 1\n{}", "x\n0 0 inf 0\n".repeat(1000)));
    assert_eq!(diagnostics.len(), 1001);
    let last = diagnostics.last().expect("a last one");
    assert_eq!((last.code, last.severity), (Code::FileMore, Severity::Error));
    assert_eq!(last.message, "1000 more mistakes in this file are left out");
}

#[test]
fn long_quotations_are_shortened() {
    let word = "é".repeat(1_000_000);
    let (_, diagnostics) =
        read_world("a.wld", &format!("floor 1 1\n{word}\n0 0 1 {word}\n0 0 1 1{}\n", "0".repeat(99_999)));
    assert_eq!(codes_of(&diagnostics), [Code::WldKeyword, Code::NumberInvalid, Code::NumberRange]);
    assert!(diagnostics[0].message.starts_with("unknown keyword `ééé"), "{}", diagnostics[0].message);
    assert!(diagnostics[0].message.ends_with("ééé`"), "{}", diagnostics[0].message);
    assert!(diagnostics.iter().all(|diagnostic| diagnostic.message.len() < 400), "{diagnostics:?}");
}

fn codes_of(diagnostics: &[Diagnostic]) -> Vec<Code> {
    diagnostics.iter().map(|diagnostic| diagnostic.code).collect()
}
