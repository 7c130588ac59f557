//! Scenes of EyeSim VR without other files: built-in robots and objects in the default world, a box.

use tests::{Scratch, number};

/// Reads the PSDs by their numbers in both generations, turns the camera's servo, and drives 0.3 m.
const PROGRAM: &str = r#"
#include "eyebot.h"

int main(void) {
    PSDHandle front = PSDInit(1), back = PSDInit(PSD_BACK);
    VWHandle vw = VWInit(VW_DRIVE, 1);
    PositionType at;
    if (front != PSDInit(PSD_FRONT) || back != PSDInit(4) || front == back) return 1;
    if (PSDInit(2) != PSDInit(PSD_LEFT) || PSDInit(3) != PSDInit(PSD_RIGHT)) return 2;
    PSDStart(front | back, TRUE);
    OSWait(20);
    LCDPrintf("%d %d\n", PSDGet(front), PSDGet(back));
    if (SERVOInit(1) != SERVOInit(SERVO1)) return 3;
    VWDriveStraight(vw, 0.3, 0.2);
    VWDriveWait(vw);
    VWGetPosition(vw, &at);
    return at.x > 0.299 && at.x < 0.301 ? 0 : 4;
}
"#;

#[test]
fn built_in_robots_drive_in_the_box_of_eyesim_vr() {
    let scratch = Scratch::new();
    scratch.write("drive.c", PROGRAM);
    scratch
        .write("scene.sim", "settings VIS trace\nS4 500 1500 0 drive.c\nlabbot 500 500 0 drive.c\ncan 1500 1000 0\n");
    let report = scratch.report("scene.sim", &[], 0);
    // The sensors of S4 are 60 mm ahead of and behind its centre, those of LabBot 30 and 40 mm. The walls are at 0 and
    // 2000 mm.
    for (robot, seen) in [(0, "1440 440"), (1, "1470 460")] {
        let robot = &report["robots"][robot];
        assert_eq!(robot["exit_code"], 0, "{robot:#}");
        assert_eq!(robot["lcd"][0].as_str().map(str::trim_end), Some(seen), "{robot:#}");
        assert!((number(robot, "pose.x_m") - 0.8).abs() < 1e-6, "{robot:#}");
    }
}
