//! Robot files of every dialect.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::super::*;
use super::codes;
use glam::DVec3;
use sim_core::math;

fn robi(text: &str) -> RobiSpec {
    let (robi, diagnostics) = read_robi("r.robi", text);
    assert_eq!(diagnostics, [], "{text}");
    robi
}

fn mm(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z) / 1000.0
}

/// Asserts equality to within a nanometre.
fn assert_close(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-9, "{a} is not {b}");
}

pub(super) const VR: &str = "drive DIFFERENTIAL_DRIVE\nname Probe\nmass 5 10 30 -50\nmodel \"a b.obj\" 14 20 30 0 90 0\n\
    collider box 180 145 200 10 82 20\ncollider capsule 10 50 0 25 -60\ncollider sphere 10 -20 30 40\n\
    axis 22.5 10.8\npsd PSD_FRONT 1 30 0 80 0\npsd PSD_LEFT 2 45 27 40 90\ncamera 40 50 70 10 0 90 45\n\
    wheel 45 3600 540 70\nlidar 180 -10\n";

pub(super) const NEWEST: &str = "drive DIFFERENTIAL_DRIVE\nname Probe\nmass 50 0 30 -30\nmodel p.obj 0 0 0 0 90 0\n\
    collider box 95 74 65 0 46 -50\naxis 22.7 10.8\npsd 1 PSD_FRONT 60 20 30 0 0 0\npsd 2 PSD_BACK 61 20 30 0 180 0\n\
    camera 0 62 60 0 -5 482 162\nfisheye 150\nwheel 54 3600 1100 45\n";

const CAR: &str = "drive ACKERMANN_DRIVE\nname Car\ncollider box 100 82 200 0 82 0\naxel drive 22.7 -94\n\
    axel turn 12.6 66\nwheel drive 40 7200 640 44.5\nwheel turn 28 7200 640 40\n";

#[test]
fn robis_of_all_dialects_match_snapshots() {
    insta::assert_debug_snapshot!("robi_vr", robi(VR));
    insta::assert_debug_snapshot!("robi_newest", robi(NEWEST));
    insta::assert_debug_snapshot!("robi_car", robi(CAR));
}

#[test]
fn unity_axes_are_converted() {
    let robi = robi(VR);
    assert_eq!((robi.mass, robi.centre_of_mass), (5.0, mm(-50.0, -10.0, 30.0)));
    let model = robi.model.expect("a model");
    assert_eq!((model.path.text.as_str(), model.offset), ("a b.obj", mm(30.0, -14.0, 20.0)));
    assert_eq!(model.rotations, DVec3::new(0.0, FRAC_PI_2, 0.0));
    let expected = [
        Collider::Box { centre: mm(20.0, -10.0, 82.0), size: mm(200.0, 180.0, 145.0) },
        Collider::Capsule { centre: mm(-60.0, 0.0, 25.0), radius: 0.01, height: 0.05, axis: Axis::Z },
        Collider::Sphere { centre: mm(40.0, 20.0, 30.0), radius: 0.01 },
    ];
    assert_eq!(robi.colliders, expected);
    assert_eq!(robi.axis_offset, 0.0108);
}

#[test]
fn a_short_capsule_is_a_sphere() {
    let robi = robi("drive DIFFERENTIAL_DRIVE\ncollider capsule 30 10 0 0 0\nwheel 54 3600 1100 20\n");
    let [Collider::Capsule { radius, height, .. }] = robi.colliders[..] else { panic!("{:?}", robi.colliders) };
    assert_eq!((radius, height, robi.diameter), (0.03, 0.06, 0.06));
}

#[test]
fn the_body_is_the_smallest_disc_around_all_colliders() {
    // The far corner of the box: 100 + 20 mm forward, 90 + 10 mm to the right.
    assert_close(robi(VR).diameter, 2.0 * math::hypot(0.12, 0.1));
    // A diameter takes precedence over the colliders.
    assert_eq!(robi(&VR.replace("name Probe", "diameter 260")).diameter, 0.26);
}

#[test]
fn default_body_encloses_the_wheels() {
    let text = "drive DIFFERENTIAL_DRIVE\naxis 27 -10\nwheel 54 3600 1100 45\n";
    let (robi, diagnostics) = read_robi("r.robi", text);
    assert_eq!(codes(&diagnostics), ["robi-body-missing"]);
    assert_close(robi.diameter, 2.0 * math::hypot(0.037, 0.045));
    let (robi, diagnostics) = read_robi("r.robi", &CAR.replace("collider", ";"));
    assert_eq!(codes(&diagnostics), ["robi-body-missing"]);
    assert_close(robi.diameter, 2.0 * math::hypot(0.114, 0.0445));
    // In a classic file the default applies.
    let classic = "wheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE A B C D\n";
    assert_eq!(read_robi("r.robi", classic).0.diameter, 0.18);
}

#[test]
fn only_eyesim_vr_states_half_the_track() {
    let wheel = "wheel 54 3600 1100 45\ndiameter 200\n";
    let classic = "drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\naxis 10\n";
    assert_eq!(robi(&format!("{classic}{wheel}")).wheel.track, 0.045);
    let named = "drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";
    for line in
        ["axis 20 10\n", "mass 1 0 0 0\n", "collider sphere 90 0 0 0\n", "lidar 360 0\n", "model a.obj 0 0 0 0 0 0\n"]
    {
        assert_eq!(robi(&format!("{named}{line}{wheel}")).wheel.track, 0.09, "{line}");
        // The dialect applies to the whole file, wherever the decisive line is.
        assert_eq!(robi(&format!("{named}{wheel}{line}")).wheel.track, 0.09, "{line}");
    }
    let unnamed = robi(&format!("drive DIFFERENTIAL_DRIVE\n{wheel}"));
    assert_eq!(unnamed.wheel.track, 0.09);
    assert_eq!(unnamed.drive.motors, RobiSpec::with_defaults("r").drive.motors);
    assert_eq!(unnamed.drive.wheelbase, 0.09);
}

#[test]
fn half_the_track_must_fit_the_body() {
    let wide = |track: f64| format!("drive DIFFERENTIAL_DRIVE\ndiameter 200\nwheel 54 3600 1100 {track}\n");
    assert_eq!(robi(&wide(100.0)).wheel.track, 0.2);
    let (robi, diagnostics) = read_robi("r.robi", &wide(145.0));
    assert_eq!((codes(&diagnostics), robi.wheel.track), (vec!["robi-track-wide"], 0.145));
}

#[test]
fn omni_drive_states_the_whole_track() {
    let robi = robi("drive OMNI_DRIVE\ndiameter 375\nwheel 100 360 7300 220\n");
    assert_eq!((robi.wheel.track, robi.drive.wheelbase, robi.drive.motors.len()), (0.22, 0.22, 4));
}

#[test]
fn axel_lines_describe_a_car() {
    let robi = robi(CAR);
    assert_eq!(robi.axis_offset, -0.094);
    assert_close(robi.drive.wheelbase, 0.16);
    assert_eq!((robi.wheel.diameter, robi.wheel.track), (0.04, 0.089));
    assert_eq!(robi.drive.steering.as_deref(), Some("SERVO_STEER"));
}

#[test]
fn three_forms_of_psd_are_read() {
    let other_lines = "diameter 186\nwheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE A B C D\n";
    for (line, id) in [("psd P -200 60 20 30 90", Some(-200)), ("psd P 60 20 30 90", None)] {
        let psd = robi(&format!("{line}\n{other_lines}")).psds.remove(0);
        assert_eq!((psd.name.as_str(), psd.id, psd.position), ("P", id, mm(60.0, 20.0, 30.0)), "{line}");
        assert_eq!(psd.angle, FRAC_PI_2, "{line}");
    }
    let newest = robi(NEWEST);
    let psd = &newest.psds[1];
    assert_eq!((psd.name.as_str(), psd.id, psd.position), ("PSD_BACK", Some(2), mm(61.0, 20.0, 30.0)));
    assert_eq!(psd.angle, PI);
}

#[test]
fn all_forms_of_camera_are_read() {
    let classic = "diameter 186\nwheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE A B C D\n";
    let vr = "drive DIFFERENTIAL_DRIVE\ndiameter 186\nwheel 54 3600 1100 45\n";
    let camera = |text: String| robi(&text).camera.expect("a camera");
    let fixed = JointSpec::Fixed(0.0);
    // Eight words: an image's size in every dialect.
    for robi_lines in [classic, vr] {
        let camera = camera(format!("{robi_lines}camera 45 1 72 0 0 80 60\n"));
        assert_eq!((camera.position, camera.pan, camera.image), (mm(45.0, 1.0, 72.0), fixed.clone(), Some([80, 60])));
    }
    // Servos, also with blanks.
    let servos = camera(format!("{classic}camera 45 0 72 SERVO1(-90,+90) SERVO2(-90, +45) 80 60\n"));
    assert_eq!(servos.pan, JointSpec::Servo { name: "SERVO1".to_owned(), from: -FRAC_PI_2, to: FRAC_PI_2 });
    assert_eq!(servos.tilt, JointSpec::Servo { name: "SERVO2".to_owned(), from: -FRAC_PI_2, to: PI / 4.0 });
    // Three numbers.
    let short = camera(format!("{classic}camera 45 0 72\n"));
    assert_eq!((short.pan, short.tilt, short.image), (fixed.clone(), fixed.clone(), None));
    // Numbers in the range of angles are angles only in a file of EyeSim VR.
    let ranged = camera(format!("{vr}camera 40 50 70 10 0 90 45\n"));
    let [from, to] = [-80.0_f64, 100.0].map(f64::to_radians);
    let JointSpec::Servo { name, from: low, to: high } = ranged.pan else { panic!("{:?}", ranged.pan) };
    assert_eq!(name, "SERVO1");
    assert_close(low, from);
    assert_close(high, to);
    assert_eq!(ranged.tilt, JointSpec::Servo { name: "SERVO2".to_owned(), from: -PI / 4.0, to: PI / 4.0 });
    assert_eq!((ranged.image, ranged.position), (None, mm(40.0, 50.0, 70.0)));
    assert_eq!(camera(format!("{classic}camera 40 50 70 10 0 90 45\n")).image, Some([90, 45]));
    // Too large for angles: the size of an image.
    let large = camera(format!("{vr}camera 62 0 60 0 0 482 162\n"));
    assert_eq!((large.position, large.image), (mm(62.0, 0.0, 60.0), Some([482, 162])));
    // In the newest files the first number is ignored; forward and up follow.
    let newest = camera(NEWEST.to_owned());
    assert_eq!((newest.position, newest.image), (mm(62.0, 0.0, 60.0), Some([482, 162])));
    assert_eq!(newest.lens, Lens::Fisheye { fov: 150.0_f64.to_radians() });
}

#[test]
fn lidar_lines_with_two_and_three_numbers_are_read() {
    let lidar = robi(VR).lidar.expect("a scanner");
    assert_eq!((lidar.points, lidar.tilt, lidar.sweep), (180, -PI / 18.0, TAU));
    let lidar = robi(&VR.replace("lidar 180 -10", "lidar 90 45 5")).lidar.expect("a scanner");
    assert_eq!((lidar.points, lidar.tilt, lidar.sweep), (45, PI / 36.0, FRAC_PI_2));
}

#[test]
fn names_are_words_or_the_rest_of_the_line() {
    let named = |name: &str| robi(&format!("drive OMNI_DRIVE\nname {name}\ndiameter 9\n wheel 1 2 3 4\n")).name;
    assert_eq!(named("\"LabBot 2\" ; mine"), "LabBot 2");
    assert_eq!(named("LabBot  2\t# mine"), "LabBot  2");
}

#[test]
fn companion_sets_mass_and_scanner() {
    let mut robi = robi("wheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE A B C D\n");
    let text = "[body]\nmass_kg = 2.5\ntraction = 0.8\n[lidar]\npoints = 90\nsweep_deg = 180\n";
    assert_eq!(read_companion("r.toml", text, &mut robi), []);
    assert_eq!((robi.mass, robi.traction), (2.5, 0.8));
    assert_eq!(robi.lidar.map(|lidar| (lidar.points, lidar.tilt, lidar.sweep)), Some((90, 0.0, PI)));
}

#[test]
fn companion_sets_the_size_of_the_display() {
    let mut robi = robi("wheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE A B C D\n");
    assert_eq!((robi.lcd.width, robi.lcd.height), (480, 320));
    assert_eq!(read_companion("r.toml", "[lcd]\nwidth_px = 320\nheight_px = 240\n", &mut robi), []);
    assert_eq!((robi.lcd.width, robi.lcd.height), (320, 240));
    let diagnostics = read_companion("r.toml", "[lcd]\nwidth_px = 63\nheight_px = 1201\ndepth = 24\n", &mut robi);
    assert_eq!(diagnostics.len(), 3, "{diagnostics:?}");
    assert_eq!((robi.lcd.width, robi.lcd.height), (320, 240), "what is wrong changes nothing");
}
