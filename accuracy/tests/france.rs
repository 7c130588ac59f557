//! Compares readings of the three sensors of France et al. with section 6.3 of the paper. The sensors are on the leg of
//! a robot that walks over a floor towards a step.

use std::f64::consts::{FRAC_PI_4, PI};

use accuracy::study::france::{Sample, walk};

fn samples() -> Vec<Sample> {
    walk(0.01)
}

#[test]
fn incidence_angles_match_the_paper() {
    let floor: Vec<_> = samples().into_iter().filter(|sample| !sample.is_on_step).collect();
    let degrees = |sample: &Sample| sample.incidence * 180.0 / PI;
    let min = floor.iter().map(degrees).fold(f64::INFINITY, f64::min);
    let max = floor.iter().map(degrees).fold(0.0, f64::max);
    assert!((min - 33.0).abs() < 0.1 && (max - 78.0).abs() < 0.1, "{min} to {max} degrees");
    assert_eq!(samples().len(), 1200);
    let step = samples().iter().filter(|sample| sample.is_on_step).count();
    assert!((100..600).contains(&step), "{step} of the samples lie on the step");
}

#[test]
fn laser_has_no_return_from_the_floor_beyond_45_degrees() {
    let (mut detected, mut lost) = (0, 0);
    for sample in samples() {
        let expected = if sample.incidence <= FRAC_PI_4 && sample.exact <= 2.0 { sample.exact } else { 2.0 };
        assert!((sample.laser - expected).abs() < 1e-15, "{sample:?}");
        if !sample.is_on_step {
            (detected, lost) = if expected < 2.0 { (detected + 1, lost) } else { (detected, lost + 1) };
        }
    }
    assert!(detected > 200 && lost > 400, "{detected} detected, {lost} lost");
}

#[test]
fn ultrasonic_sensor_detects_only_the_step() {
    let mut detected = 0;
    for sample in samples() {
        if sample.ultrasonic < 1.0 {
            assert!(sample.is_on_step && sample.incidence <= PI / 12.0, "{sample:?}");
            assert_eq!(sample.ultrasonic, sample.exact);
            detected += 1;
        }
    }
    assert!(detected > 20, "the step is detected in {detected} samples");
}

#[test]
fn reflectance_sensor_has_the_bias_of_eq_1() {
    let mut max_bias: f64 = 0.0;
    for sample in samples() {
        let Sample { exact: d, incidence, reflectance, .. } = sample;
        if d >= 1.0 {
            assert_eq!(reflectance, 1.0);
            continue;
        }
        // The paper's formula loses digits if the signal s is small; the tolerance allows for this.
        let cos = sim_core::math::cos(incidence);
        let s = (1.0 - d) / (d * d) * cos * cos;
        let by_paper = (-1.0 + (1.0 + 4.0 * s).sqrt()) / (2.0 * s);
        assert!((reflectance - by_paper).abs() < 1e-11 / s, "{sample:?}: {by_paper}");
        assert!(reflectance > d, "the bias is not positive: {sample:?}");
        max_bias = max_bias.max(reflectance - d);
    }
    assert!(max_bias > 0.2, "maximum bias {max_bias} m");
}
