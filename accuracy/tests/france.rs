//! The France paper's three sensors on one sweep over a floor and a step, compared with section 6.3 of the paper.

use std::f64::consts::{FRAC_PI_4, PI};

use accuracy::study::france::{Sample, walk};

fn samples() -> Vec<Sample> {
    walk(0.01)
}

#[test]
fn the_sweep_is_that_of_the_paper() {
    let floor: Vec<_> = samples().into_iter().filter(|sample| !sample.is_on_step).collect();
    let degrees = |sample: &Sample| sample.incidence * 180.0 / PI;
    let least = floor.iter().map(degrees).fold(f64::INFINITY, f64::min);
    let greatest = floor.iter().map(degrees).fold(0.0, f64::max);
    assert!((least - 33.0).abs() < 0.1 && (greatest - 78.0).abs() < 0.1, "{least} to {greatest} degrees");
    assert_eq!(samples().len(), 1200);
    let step = samples().iter().filter(|sample| sample.is_on_step).count();
    assert!((100..600).contains(&step), "{step} of the samples lie on the step");
}

#[test]
fn the_laser_loses_the_floor_beyond_45_degrees() {
    let (mut seen, mut lost) = (0, 0);
    for sample in samples() {
        let expected = if sample.incidence <= FRAC_PI_4 && sample.exact <= 2.0 { sample.exact } else { 2.0 };
        assert!((sample.laser - expected).abs() < 1e-15, "{sample:?}");
        if !sample.is_on_step {
            (seen, lost) = if expected < 2.0 { (seen + 1, lost) } else { (seen, lost + 1) };
        }
    }
    assert!(seen > 200 && lost > 400, "{seen} seen, {lost} lost");
}

#[test]
fn the_ultrasonic_sensor_sees_only_the_step() {
    let mut seen = 0;
    for sample in samples() {
        if sample.ultrasonic < 1.0 {
            assert!(sample.is_on_step && sample.incidence <= PI / 12.0, "{sample:?}");
            assert_eq!(sample.ultrasonic, sample.exact);
            seen += 1;
        }
    }
    assert!(seen > 20, "{seen} samples see the step");
}

#[test]
fn the_reflectance_sensor_is_biased_as_eq_1_says() {
    let mut greatest: f64 = 0.0;
    for sample in samples() {
        let Sample { exact: d, incidence, reflectance, .. } = sample;
        if d >= 1.0 {
            assert_eq!(reflectance, 1.0);
            continue;
        }
        // The printed root is accurate enough here, as the signal is not small.
        let cos = sim_core::math::cos(incidence);
        let s = (1.0 - d) / (d * d) * cos * cos;
        let printed = (-1.0 + (1.0 + 4.0 * s).sqrt()) / (2.0 * s);
        assert!((reflectance - printed).abs() < 1e-11 / s, "{sample:?}: {printed}");
        assert!(reflectance > d, "less light seems farther: {sample:?}");
        greatest = greatest.max(reflectance - d);
    }
    assert!(greatest > 0.2, "by {greatest} m at most");
}
