//! Cameras: images in programs of both generations, which are equal for all numbers of threads and all executors; image
//! files; rejected input and its messages.

use std::path::Path;

use serde_json::Value;
use tests::{Ran, Scratch};

/// Writes a scene `a.sim` with these robots: a room of 4 m with a box.
fn scratch(robots: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("room.wld", "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n");
    scratch.write("box.esObj", "name Box\nmass 1 0 100 0\ncollider box 0 100 0 200 200 200\n");
    scratch.write("a.sim", &format!("world room.wld\nobject box.esObj\n{robots}Box 1800 2000 0\n"));
    scratch
}

/// A robot type without a camera.
const BLIND: &str = "name Blind\ndiameter 180\nspeed 600\nturn 300\nwheel 54 3600 1100 90\n\
                     drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";

/// Lines printed by robot 1.
fn said(trace: &[Value]) -> Vec<String> {
    let is_said = |event: &&Value| event["event"] == "stdout" && event["robot"] == 1;
    trace.iter().filter(is_said).map(|event| event["text"].as_str().expect("text").to_owned()).collect()
}

/// Runs `a.sim` and returns the lines that robot 1 prints, and the digest.
fn printed(scratch: &Scratch, args: &[&str]) -> (Vec<String>, String) {
    let report = scratch.report("a.sim", &[args, &["--trace", "t.jsonl"]].concat(), 0);
    (said(&scratch.trace("t.jsonl")), report["digest"].as_str().expect("a digest").to_owned())
}

/// Standard error of a run that must end with the exit code `code`.
fn refused(scratch: &Scratch, args: &[&str], code: i32) -> String {
    let ran: Ran = scratch.eyesim(args);
    assert_eq!(ran.code, Some(code), "{ran:#?}");
    ran.stderr
}

/// Width, height, bit depth and colour type in the header of a PNG.
fn head(scratch: &Scratch, name: &str) -> (u32, u32, u8, u8) {
    let bytes = std::fs::read(scratch.path().join(name)).unwrap_or_else(|error| panic!("`{name}`: {error}"));
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    (number(16), number(20), bytes[24], bytes[25])
}

/// The files in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let name =
        |entry: std::io::Result<std::fs::DirEntry>| entry.expect("an entry").file_name().into_string().expect("text");
    let mut names: Vec<String> = std::fs::read_dir(folder).expect("a folder").map(name).collect();
    names.sort_unstable();
    names
}

/// Program that calls every camera function of RoBIOS-7 and prints each wrong result.
const EVERY_FUNCTION_7: &str = r#"#include <math.h>
#include "eyebot.h"
static int failures;
#define IS(call, expected) \
    do { long got_ = (long)(call); if (got_ != (expected)) { failures++; printf("%s: %ld\n", #call, got_); } } while (0)
static BYTE colours[QQVGA_SIZE], again[QQVGA_SIZE], grey[QQVGA_PIXELS];
static float depths[QQVGA_PIXELS];
static int labels[QQVGA_PIXELS];
int main(void)
{
    int i, same = 0, boxes = 0;
    IS(CAMGet(colours), 1);
    IS(CAMRelease(), 1);
    IS(CAMInit(99), 1);
    IS(CAMInit(-1), 1);
    IS(CAMInit(QQVGA), 0);
    IS(CAMWIDTH, 160); IS(CAMHEIGHT, 120); IS(CAMPIXELS, QQVGA_PIXELS); IS(CAMSIZE, QQVGA_SIZE); IS(CAMMODE, QQVGA);
    IS(IP_WIDTH, 160);
    IS(CAMGetDepth(depths), 1);
    IS(CAMGetLabels(labels), 1);
    IS(CAMGet(0), 1); IS(CAMGetGray(0), 1); IS(CAMGetDepth(0), 1); IS(CAMGetLabels(0), 1);
    IS(CAMGet(colours), 0);
    IS(CAMGetDepth(depths), 0);
    IS(CAMGetLabels(labels), 0);
    IS(CAMGet(again), 0);
    IS(memcmp(colours, again, sizeof again), 0);
    IS(CAMGetGray(grey), 0);
    for (i = 0; i < QQVGA_PIXELS; i++)
        same += grey[i] == (colours[3 * i] + colours[3 * i + 1] + colours[3 * i + 2]) / 3;
    IS(same, QQVGA_PIXELS);
    /* Sky on top, floor below, the box ahead: two robots, so it is object 3. */
    IS(labels[80], CAM_SKY);
    IS(isinf(depths[80]), 1);
    IS(labels[QQVGA_PIXELS - 80], CAM_FLOOR);
    for (i = 0; i < QQVGA_PIXELS; i++)
        boxes += labels[i] == CAM_BODY + SIMGetRobotCount() + 1;
    IS(boxes > 400 && boxes < 4000, 1);
    /* From 1000 + 62 (camera of the S4) to the box's side at 1700 mm. */
    IS(labels[QQVGA_PIXELS / 2 + 80], CAM_BODY + 3);
    i = (int)depths[QQVGA_PIXELS / 2 + 80];
    IS(i >= 630 && i <= 645, 1);
    CAMWIDTH = 7; CAMHEIGHT = 5;
    IS(CAMInit(CUSTOM), 0);
    IS(CAMSIZE, 105);
    memset(colours, 77, sizeof colours);
    IS(CAMGet(colours), 0);
    IS(colours[105], 77);
    CAMWIDTH = 0;
    IS(CAMInit(CUSTOM), 1);
    CAMWIDTH = 5000; CAMHEIGHT = 10;
    IS(CAMInit(CUSTOM), 1);
    IS(CAMGet(colours), 1);
    IS(CAMInit(VGA), 0); IS(CAMSIZE, VGA_SIZE);
    IS(CAMRelease(), 0);
    IS(CAMRelease(), 1);
    IS(CAMGet(colours), 1);
    printf("%d failures\n", failures);
    return 0;
}
"#;

/// Program that calls every camera function of RoBIOS 6.
const EVERY_FUNCTION_6: &str = r#"#include <math.h>
#include <stdio.h>
#include <string.h>
#include "eyebot.h"
static int failures;
#define IS(call, expected) \
    do { long got_ = (long)(call); if (got_ != (expected)) { failures++; printf("%s: %ld\n", #call, got_); } } while (0)
static image grey, more;
static colimage colours, converted;
static BYTE mono[4800], rgb[14400], bayer[19200];
static float depths[4800];
static int labels[4800];
static long mean(void)
{
    long i, sum = 0;
    IS(CAMGetFrameMono(mono), 0);
    for (i = 0; i < 4800; i++) sum += mono[i];
    return sum / 4800;
}
int main(void)
{
    int row, column, a, b, c, start, i;
    long plain, wide = 0, normal = 0;
    IS(CAMGetFrame(&grey), -1);
    IS(CAMRelease(), -1);
    IS(CAMSet(128, 128, 128), -1);
    IS(CAMGet(&a, &b, &c), -1);
    IS(CAMMode(AUTOBRIGHTNESS), -1);
    IS(CAMInit(7), INITERROR);
    IS(CAMInit(NORMAL) > COLCAM, 1);
    IS(CAMGetDepth(depths), -1);
    IS(CAMGetFrame(0), -1); IS(CAMGetColFrame(0, 0), -1); IS(CAMGetFrameMono(0), -1); IS(CAMGetFrameColor(0), -1);
    IS(CAMGetFrameRGB(0), -1); IS(CAMGetFrameBayer(0), -1); IS(CAMGetDepth(0), -1); IS(CAMGetLabels(0), -1);
    IS(CAMGetFrame(&grey), 0);
    IS(CAMGetColFrame(&colours, 0), 0);
    ((BYTE *)converted)[sizeof grey] = 7;
    IS(CAMGetColFrame(&converted, 1), 0);
    IS(CAMGetFrameMono(mono), 0);
    IS(CAMGetFrameColor(rgb), 0);
    IS(memcmp(converted, grey, sizeof grey), 0);
    IS(((BYTE *)converted)[sizeof grey], 7);
    for (row = 0; row < 60; row++) {
        for (column = 0; column < 80; column++) {
            BYTE *pixel = colours[row + 1][column + 1];
            failures += grey[row + 1][column + 1] != (pixel[0] + pixel[1] + pixel[2]) / 3;
            failures += mono[80 * row + column] != grey[row + 1][column + 1];
            failures += memcmp(pixel, rgb + 3 * (80 * row + column), 3) != 0;
        }
    }
    for (column = 0; column < imagecolumns; column++)
        failures += grey[0][column] != 0 || grey[imagerows - 1][column] != 0;
    IS(CAMGetFrameRGB(rgb), 0);
    IS(CAMGetFrameBayer(bayer), 0);
    /* The sky is bluer than red: rows of green and blue, of red and green. */
    IS(bayer[1] > bayer[160], 1);
    IS(CAMGetDepth(depths), 0);
    IS(CAMGetLabels(labels), 0);
    IS(labels[40], CAM_SKY);
    IS(isinf(depths[40]), 1);
    IS(labels[4799], CAM_FLOOR);
    for (i = 0; i < 4800; i++) normal += labels[i] == CAM_BODY + 3;
    /* Levels. */
    plain = mean();
    IS(CAMSet(64, 128, 128), 0);
    IS(CAMGet(&a, &b, &c), 0);
    IS(a, 64); IS(b, 128); IS(c, 128);
    IS(CAMGet(0, &b, &c), -1);
    IS(labs(mean() - plain / 2) <= 1, 1);
    IS(CAMSet(300, 0, 0), -1);
    IS(CAMSet(128, 128, -1), -1);
    IS(CAMSet(128, 128, 0), 0);
    IS(CAMGetFrameColor(rgb), 0);
    IS(abs(rgb[0] - rgb[2]) <= 1, 1);
    IS(CAMGetFrameMono(mono), 0);
    IS(mono[0], 128);
    /* The brightness follows. */
    IS(CAMSet(30, 128, 128), 0);
    IS(CAMMode(9), -1);
    IS(CAMMode(AUTOBRIGHTNESS), 0);
    IS(mean() < 60, 1);
    for (i = 0; i < 8; i++) mean();
    plain = mean();
    IS(plain >= 123 && plain <= 133, 1);
    IS(CAMGet(&a, &b, &c), 0);
    IS(a > 80, 1);
    IS(CAMMode(NOAUTOBRIGHTNESS), 0);
    /* Frame rates: 3.75 a second. */
    IS(CAMSet(FPS3_75, 0, 0), 0);
    IS(CAMGet(&a, &b, &c), 0);
    IS(a, FPS3_75); IS(b, 0);
    IS(CAMGetFrame(&grey), 0);
    start = OSGetCount();
    for (i = 0; i < 15; i++) IS(CAMGetFrame(&grey), 0);
    IS(OSGetCount() - start, 400);
    /* Lenses: things are half as large. */
    IS(CAMInit(WIDE) < INITERROR, 1);
    IS(CAMGet(&a, &b, &c), 0);
    IS(a, 128);
    IS(CAMGetFrame(&more), 0);
    IS(CAMGetLabels(labels), 0);
    for (i = 0; i < 4800; i++) wide += labels[i] == CAM_BODY + 3;
    IS(normal > 100 && labs(normal - 4 * wide) < normal / 4, 1);
    IS(CAMInit(TELE) < INITERROR, 1);
    IS(CAMRelease(), 0);
    IS(CAMGetFrame(&grey), -1);
    printf("%d failures\n", failures);
    return 0;
}
"#;

const ROBOTS: &str = "S4 1000 2000 0 one.c\nS4 3000 3000 180 two.c\n";

/// Program that drives about and takes images.
const WANDERER: &str = r#"#include "eyebot.h"
static BYTE image[3 * 80 * 60];
static float depths[80 * 60];
static int labels[80 * 60];
int main(void)
{
    int i;
    CAMWIDTH = 80;
    CAMHEIGHT = 60;
    CAMInit(CUSTOM);
    VWSetSpeed(100, 30);
    for (i = 0; i < 4; i++) {
        SERVOSet(1, 128 + 20 * i);
        CAMGet(image);
        printf("%d %d %d\n", image[0], image[4800], image[12000]);
        CAMGetDepth(depths);
        CAMGetLabels(labels);
        CAMGetGray(image);
        OSWait(37);
    }
    return 0;
}
"#;

#[test]
fn every_camera_function_of_robios7_works_as_documented() {
    let scratch = scratch(ROBOTS);
    scratch.write("one.c", EVERY_FUNCTION_7);
    scratch.write("two.c", "#include \"eyebot.h\"\nint main(void) { OSWait(1); return 0; }\n");
    for exec in ["thread", "process"] {
        assert_eq!(printed(&scratch, &["--exec", exec]).0, ["0 failures"], "{exec}");
    }
}

#[test]
fn every_camera_function_of_robios6_works_as_documented() {
    let scratch = scratch(ROBOTS);
    scratch.write("one.c", EVERY_FUNCTION_6);
    scratch.write("two.c", "#include \"eyebot.h\"\nint main(void) { OSWait(1); return 0; }\n");
    for exec in ["thread", "process"] {
        assert_eq!(printed(&scratch, &["--exec", exec, "--api", "6"]).0, ["0 failures"], "{exec}");
    }
}

#[test]
fn calls_are_shown_without_the_bytes_of_images() {
    let scratch = scratch(ROBOTS);
    let program = "#include \"eyebot.h\"\nstatic QVGAcol image;\nstatic QVGAgray grey;\nint main(void)\n{\n    char name[80];\n    \
                   CAMInit(QVGA); CAMGet(image); IPCol2Gray(image, grey); OSMachineName(name); return 0;\n}\n";
    scratch.write("one.c", program);
    scratch.write("two.c", program);
    let ran = scratch.eyesim(&["run", "a.sim", "-v", "--robot", "1"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    for expected in ["CAMGet(&[230400 bytes]) = 0", "IPCol2Gray([230400 bytes], &[76800 bytes])", "OSMachineName(&\""] {
        assert!(ran.stderr.contains(expected), "{expected}: {:.2000}", ran.stderr);
    }
}

#[test]
fn images_are_the_same_however_a_run_is_run() {
    let scratch = scratch(ROBOTS);
    scratch.write("one.c", WANDERER);
    scratch.write("two.c", WANDERER);
    let (lines, digest) = printed(&scratch, &["--threads", "1", "--noise", "real"]);
    assert_eq!(lines.len(), 4);
    for args in [&["--threads", "2"][..], &["--exec", "process"], &["--frames", "images"], &["-v"]] {
        assert_eq!(
            printed(&scratch, &[args, &["--noise", "real"]].concat()),
            (lines.clone(), digest.clone()),
            "{args:?}"
        );
    }
    let without = scratch.report("a.sim", &["--noise", "real"], 0);
    assert_eq!(without["digest"].as_str(), Some(digest.as_str()), "without a trace");
    assert_ne!(printed(&scratch, &["--noise", "none"]).1, digest, "the digest covers the pixels");

    // Names of the image files, sorted by robot, number and time.
    let names = names(&scratch.path().join("images"));
    assert_eq!(names.len(), 2 * 4 * 4, "{names:?}");
    assert!(names[0].starts_with("r1-000001-00000.") && names[0].ends_with("-depth.png"), "{names:?}");
    assert_eq!(head(&scratch, &format!("images/{}", names[0])), (80, 60, 16, 0));
    assert_eq!(head(&scratch, &format!("images/{}", names[1])), (80, 60, 8, 3), "labels have a palette");
    assert_eq!(head(&scratch, &format!("images/{}", names[2])), (80, 60, 8, 2));
    assert_eq!(head(&scratch, &format!("images/{}", names[3])), (80, 60, 8, 0), "grey");
    let second = scratch.eyesim(&["run", "a.sim", "--noise", "real", "--frames", "again"]);
    assert_eq!(second.code, Some(0), "{second:#?}");
    for name in &names {
        let read = |folder: &str| std::fs::read(scratch.path().join(folder).join(name)).expect("an image");
        assert!(read("images") == read("again"), "{name}");
    }
    // The frames in the trace equal those in the files.
    let trace = scratch.trace("t.jsonl");
    let frames: Vec<&Value> = trace.iter().filter(|event| event["event"] == "frame").collect();
    assert_eq!(frames.len(), names.len());
    let exposed = frames[0]["exposed_s"].as_f64().expect("seconds");
    assert!((frames[0]["t_s"].as_f64().expect("seconds") - exposed - 0.016_667).abs() < 1e-9);
    assert!(names[2].contains(&format!("{exposed:012.6}")), "{} {exposed}", names[2]);
}

/// The test of all camera functions in Python, through `eye.py`.
const PYTHON: &str = r#"
from eye import *

assert len(CAMGetGray()) == CAMPIXELS and max(CAMGetGray()) == 0, "black without CAMInit"
assert CAMInit(CUSTOM, 80, 60) == 0
assert CAMGetDepth() is None and CAMGetLabels() is None
image = CAMGet()
assert (len(image), image.width, image.height) == (3 * 80 * 60, 80, 60)
depth, labels = CAMGetDepth(), CAMGetLabels()
assert len(depth) == len(labels) == 80 * 60 and (depth.width, labels.height) == (80, 60)
assert depth[40] == float("inf") and labels[40] == CAM_SKY
assert labels[4799] == CAM_FLOOR and 0 < depth[4799] < 1000
box = CAM_BODY + SIMGetRobotCount() + 1
assert labels.count(box) > 100, labels.count(box)
gray = CAMGetGray()
assert all(gray[i] == sum(image[3 * i : 3 * i + 3]) // 3 for i in range(80 * 60))
assert CAMRelease() == 0 and CAMRelease() == 1
print("done")
"#;

#[test]
fn camera_functions_give_the_same_in_python() {
    if !std::process::Command::new("python3").arg("--version").output().is_ok_and(|out| out.status.success()) {
        println!("skipped: there is no `python3`");
        return;
    }
    let scratch = scratch("S4 1000 2000 0 one.py\nS4 3000 3000 180\n");
    scratch.write("one.py", PYTHON);
    assert_eq!(printed(&scratch, &[]).0, ["done"]);
}

#[test]
fn a_shot_is_what_the_program_gets() {
    let scratch = scratch(ROBOTS);
    scratch.write("one.c", WANDERER);
    scratch.write("two.c", WANDERER);
    let args = ["run", "a.sim", "--noise", "real", "--frames", "images"];
    assert_eq!(scratch.eyesim(&args).code, Some(0));
    let first = names(&scratch.path().join("images"))
        .into_iter()
        .find(|name| name.starts_with("r2-000001") && !name.contains("depth") && !name.contains("labels"));
    let first = first.expect("an image of robot 2");
    let at = first.split('-').nth(2).expect("a time").trim_end_matches(".png");
    let shot = |output: &str, more: &[&str]| {
        let args = [&["shot", "a.sim", "--noise", "real", "--at", at, "--robot", "2", "-o", output], more].concat();
        let ran = scratch.eyesim(&args);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        std::fs::read(scratch.path().join(output)).expect("a picture")
    };
    let image = std::fs::read(scratch.path().join("images").join(&first)).expect("an image");
    assert!(shot("a.png", &[]) == image, "{first}");
    assert!(shot("b.png", &["--threads", "1"]) == image, "the same twice");
    shot("c.png", &["--size", "64x40"]);
    assert_eq!(head(&scratch, "c.png"), (64, 40, 8, 2));
    shot("d.png", &["--depth"]);
    assert_eq!(head(&scratch, "d.png"), (80, 60, 16, 0));
    shot("l.png", &["--labels"]);
    assert_eq!(head(&scratch, "l.png"), (80, 60, 8, 3));
}

#[test]
fn an_image_too_large_for_a_local_array_ends_only_its_program() {
    let scratch = scratch("S4 500 500 0 small.c\nS4 500 1500 0 other.c\n");
    let small =
        "int main(void)\n{\n    BYTE image[100];\n    CAMInit(VGA);\n    CAMGet(image);\n    return image[0];\n}\n";
    scratch.write("small.c", &format!("#include \"eyebot.h\"\n{small}"));
    scratch.write("other.c", "#include \"eyebot.h\"\nint main(void) { OSWait(2000); return 0; }\n");
    for exec in ["thread", "process"] {
        let report = scratch.report("a.sim", &["--exec", exec], 1);
        let robots = report["robots"].as_array().expect("robots");
        let reason = robots[0]["reason"].as_str().expect("a reason");
        let expected = "an image of 640 x 480 pixels has 921600 bytes, more than the local array that it should be written to at small.c:6";
        assert_eq!(reason, expected, "{exec}");
        assert_eq!(robots[1]["outcome"], "finished", "{exec}: {report:#}");
    }
}

#[test]
fn a_scene_is_seen_from_anywhere_without_programs() {
    let scratch = scratch("S4 1000 2000 0\nS4 3000 3000 180\n");
    let shot = |output: &str, more: &[&str]| {
        let ran = scratch.eyesim(&[&["shot", "a.sim", "-o", output], more].concat());
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        std::fs::read(scratch.path().join(output)).expect("a picture")
    };
    let view = ["--from", "-500,-500,2000", "--to", "2000,2000,0", "--size", "96x64"];
    assert!(shot("a.png", &view) == shot("b.png", &view));
    assert!(shot("a.png", &[&view[..], &["--fov", "90"]].concat()) != shot("b.png", &view));
    assert_eq!(head(&scratch, "b.png"), (96, 64, 8, 2));
    // The view straight down.
    shot("down.png", &["--from", "2000,2000,3000", "--to", "2000,2000,0", "--size", "40x40", "--labels"]);
    assert_eq!(head(&scratch, "down.png"), (40, 40, 8, 3));
    shot("robot.png", &["--robot", "2", "--size", "32x24"]);
    shot("above.png", &["--size", "60x20", "--labels"]);
    assert_eq!(head(&scratch, "above.png"), (60, 20, 8, 3));
}

#[test]
fn wrong_shots_are_refused() {
    let scratch = scratch("S4 1000 2000 0\nrobi blind.robi\nBlind 3000 3000 180\n");
    scratch.write("blind.robi", BLIND);
    let says = |args: &[&str], text: &str| {
        let stderr = refused(&scratch, &[&["shot", "a.sim"], args].concat(), 2);
        assert!(stderr.contains(text), "{args:?}: {stderr}");
    };
    says(
        &["--robot", "2"],
        "--robot 2: `blind.robi` has no camera; its line in a robi file is `camera X Y Z PAN TILT`",
    );
    says(&["--robot", "3"], "--robot: there is no robot 3");
    says(&["--robot", "1", "--lcd"], "`--lcd 1` shows its display");
    says(&["--robot", "1", "--from", "0,0,0", "--to", "1,1,1"], "are two views");
    says(&["--from", "1,2,3", "--to", "1,2,3"], "--from and --to are one point");
    says(&["--from", "1,2", "--to", "1,2,3"], "expected three numbers of millimetres");
    says(&["--from", "1,2,nan", "--to", "1,2,3"], "expected three numbers of millimetres");
    says(&["--from", "1,2,3"], "--to <X,Y,Z>");
    says(&["--robot", "1", "--size", "0x40"], "expected WIDTHxHEIGHT");
    says(&["--robot", "1", "--size", "9000x40"], "expected WIDTHxHEIGHT");
    says(&["--from", "0,0,0", "--to", "1,1,1", "--fov", "180"], "expected 1 to 170 degrees");
    says(&["--robot", "1", "--fov", "50"], "--from <X,Y,Z>");
    says(&["--robot", "1", "--depth", "--labels"], "cannot be used with");
    says(&["--robot", "1", "-o", "a.jpg"], "expected a name that ends in .png");
    says(&["--robot", "1", "-o", "nowhere/a.png"], "there is no folder");
    let late = refused(&scratch, &["shot", "a.sim", "--robot", "1", "--at", "9", "--size", "8x6"], 0);
    assert!(late.contains("the run was over at 0.000 s, before --at 9.000"), "{late}");
}

#[test]
fn wrong_folders_for_images_are_refused() {
    let scratch = scratch(ROBOTS);
    scratch.write("one.c", WANDERER);
    scratch.write("two.c", WANDERER);
    let stderr = refused(&scratch, &["run", "a.sim", "--frames", "."], 2);
    assert!(stderr.contains("--frames `.`: the folder is not empty: images of two runs would mix"), "{stderr}");
    let stderr = refused(&scratch, &["run", "a.sim", "--frames", "room.wld"], 2);
    assert!(stderr.contains("--frames `room.wld`: this is a file: expected a folder for the images"), "{stderr}");
    let stderr = refused(&scratch, &["run", "a.sim", "--robot", "1"], 2);
    assert!(stderr.contains("--robot selects the robot whose calls are shown, and needs --verbose"), "{stderr}");
}

#[test]
fn an_image_that_cannot_be_written_ends_the_run() {
    let scratch = scratch(ROBOTS);
    // Both robots take images after the slot in which the second one removes the folder; the first robot takes its
    // image a little earlier.
    let begun = |more: &str| WANDERER.replace("CAMInit(CUSTOM);", &format!("CAMInit(CUSTOM); {more} OSWait(100);"));
    scratch.write("one.c", &begun(""));
    scratch.write("two.c", &begun("OSExecute(\"rm -r images\", (char *)image);"));
    for threads in ["1", "2", "2", "2"] {
        let args = ["run", "a.sim", "--frames", "images", "--allow-execute", "--threads", threads];
        let stderr = refused(&scratch, &args, 2);
        assert!(stderr.contains("error: cannot write the image `images/r1-000001-"), "{stderr}");
    }
}

#[test]
fn images_and_meshes_are_not_read_without_a_camera() {
    let scratch = Scratch::new();
    let walls =
        "floor_texture missing.png\nfloor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n";
    scratch.write("room.wld", walls);
    std::fs::write(scratch.path().join("floor.bmp"), bitmap([200, 30, 30])).expect("an image");
    scratch.write("a.sim", "world room.wld\nS4 1000 2000 0 one.c\nS4 3000 3000 180 one.c\n");
    scratch.write(
        "one.c",
        "#include \"eyebot.h\"\nint main(void) { OSWait(100); VWStraight(100, 100); VWWait(); return 0; }\n",
    );
    let quiet = scratch.eyesim(&["run", "a.sim"]);
    assert_eq!(quiet.code, Some(0), "{quiet:#?}");
    assert!(!quiet.stderr.contains("missing.png"), "{quiet:#?}");

    // With a camera, either robot's first image causes one warning, in its slot.
    scratch.write("one.c", WANDERER);
    scratch.eyesim(&["run", "a.sim", "-q"]);
    let runs: Vec<Ran> =
        ["1", "2"].iter().map(|threads| scratch.eyesim(&["run", "a.sim", "-q", "--threads", threads])).collect();
    assert_eq!(
        runs[0].stderr.matches("missing.png").count(),
        runs[1].stderr.matches("missing.png").count(),
        "{runs:#?}"
    );
    assert!(runs[0].stderr.contains("missing.png"), "{runs:#?}");
    assert_eq!(runs[0].stderr, runs[1].stderr);
    let strict = refused(&scratch, &["run", "a.sim", "--strict", "-q"], 2);
    assert!(strict.contains("the run does not continue: 1 warning"), "{strict}");

    // Files that cameras need are inputs of the run.
    scratch.write("room.wld", &walls.replace("missing.png", "floor.bmp"));
    let inputs = |scratch: &Scratch| -> Vec<String> {
        let report = scratch.report("a.sim", &[], 0);
        let path = |input: &Value| input["path"].as_str().expect("a path").to_owned();
        report["inputs"].as_array().expect("inputs").iter().map(path).collect()
    };
    assert!(inputs(&scratch).contains(&"floor.bmp".to_owned()));
    let stderr = refused(&scratch, &["shot", "a.sim", "--robot", "1", "-o", "floor.png", "-q"], 0);
    assert!(!stderr.contains("error"), "{stderr}");
    scratch.write("one.c", "#include \"eyebot.h\"\nint main(void) { OSWait(100); return 0; }\n");
    assert!(!inputs(&scratch).contains(&"floor.bmp".to_owned()));
}

/// A BMP file of one pixel.
fn bitmap([red, green, blue]: [u8; 3]) -> Vec<u8> {
    let head = [58_u32, 0, 54, 40, 1, 1, 1 | 24 << 16, 0, 4, 0, 0, 0, 0];
    let head = head.iter().flat_map(|number| number.to_le_bytes());
    b"BM".iter().copied().chain(head).chain([blue, green, red, 0]).collect()
}
