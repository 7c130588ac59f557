//! Tests that the claims of France et al. 1999 on sensors on the leg of a walking robot hold in our walks.

use papers::france::{self, Kind, MountPoint, Noise, Thing, Walks};
use papers::page::Weight;
use papers::run::Job;

#[test]
fn claims_of_the_paper_hold() {
    let folder = tempfile::tempdir().expect("a folder");
    let job = Job::new("france", folder.path(), 1).expect("a job");
    let walks = Walks::run(&job).expect("all walks end by themselves");
    for claim in france::claims(&walks) {
        assert!(claim.holds || claim.weight == Weight::Told, "{claim:#?}");
    }

    let tibia = |kind| walks.of(MountPoint::Tibia, kind, Noise::Without);
    // Section 5: the laser reads the true distance at incidence angles up to 45 degrees, otherwise 2 m.
    let mut lost = 0;
    for sample in &tibia(Kind::Laser).samples {
        let is_seen = sample.truth.distance <= 2.0 && sample.truth.incidence <= std::f64::consts::FRAC_PI_4;
        // The truth is interpolated between two slots, so within a tenth of a degree it may lie on the other side of 45
        // degrees.
        let is_sure = (sample.truth.incidence - std::f64::consts::FRAC_PI_4).abs() > 2e-3;
        assert!(sample.point.is_some() == is_seen || !is_sure || sample.truth.distance > 1.99, "{sample:?}");
        lost += usize::from(sample.truth.thing == Thing::Floor && sample.truth.distance < 1.99 && !is_seen);
    }
    assert!(lost > 0, "the laser loses some of the ground");
    // On slanting ground the reflectance sensor reads too far, never too near; readings are whole millimetres.
    for sample in tibia(Kind::Reflectance).samples.iter().filter(|sample| sample.point.is_some()) {
        assert!(sample.distance > sample.truth.distance - 2e-3, "{sample:?}");
    }
    // The sensor on the body sees no ground and no small obstacle; the sensor on the thigh never sees the obstacle head
    // on.
    let ground = |place| walks.of(place, Kind::Ideal, Noise::Without).points_on(Thing::Floor).count();
    assert!(ground(MountPoint::Tibia) > 0 && ground(MountPoint::Thigh) > 0);
    assert_eq!(ground(MountPoint::Body), 0);
    assert_eq!(walks.of(MountPoint::Thigh, Kind::Ultrasonic, Noise::Without).points_on(Thing::Obstacle).count(), 0);
}
