//! Legs on a fake robot, of both generations.

use robios_api::fake::{Fake, FakeLeg};
use robios_api::prelude::*;
use robios_api::{Gait, Leg, LegJoint, LegLink, Legs, LinkPose};

/// Two legs: one with a bent knee, lifted from 1 s on, and one without joints and links; the body sinks by 10 mm/s.
fn biped() -> Fake {
    let shank = LinkPose { x: 10.millimetres(), z: -0.4.metres(), pitch: -20.degrees(), ..LinkPose::default() };
    Fake::new()
        .leg(move |now| FakeLeg {
            joints: vec![Angle::ZERO, Angle::ZERO, 20.degrees(), 40.degrees()],
            links: vec![LinkPose::default(), shank],
            is_on_ground: now.time < 1.seconds(),
        })
        .leg(|_| FakeLeg::default())
        .body_height(|now| -0.01.metres() * now.time.as_secs_f64())
}

fn check(legs: &Legs, wait: impl Fn(Duration)) -> Result {
    let [left, right] = [Leg(1), Leg(2)];
    assert_eq!(legs.all().collect::<Vec<_>>(), [left, right]);
    legs.set_gait(Gait(2))?;
    legs.set_step_height(50.millimetres())?;
    legs.correct(right, 20.millimetres(), -10.millimetres(), Length::ZERO)?;
    legs.set_speed(0.2.metres_per_second(), 0.1.metres_per_second(), TurnRate::ZERO)?;
    assert!(legs.is_on_ground(left)?);
    wait(2.seconds());
    assert!(!legs.is_on_ground(left)? && legs.is_on_ground(right)?);
    assert!((legs.height()? + 20.millimetres()).abs() < 1.millimetres());
    assert!((legs.joint(left, LegJoint::Knee)? - 40.degrees()).abs() < 1e-4.degrees());
    let shank = legs.link(left, LegLink::Shank)?;
    assert!((shank.z + 400.millimetres()).abs() < 0.001.millimetres() && shank.x > Length::ZERO);
    assert!((shank.pitch + 20.degrees()).abs() < 1e-4.degrees() && shank.yaw == Angle::ZERO);
    let refused = |result: Result<()>, call: &str| {
        let error = result.expect_err("there is none");
        assert_eq!(error.to_string(), format!("`{call}` was refused for the legs with -1"));
    };
    refused(legs.set_gait(Gait(0)), "LEGSetGait");
    refused(legs.set_step_height(-1.millimetres()), "LEGSetStep");
    refused(legs.correct(Leg(3), Length::ZERO, Length::ZERO, Length::ZERO), "LEGCorrect");
    refused(legs.joint(left, LegJoint::Ankle).map(drop), "LEGGetJoint");
    refused(legs.joint(Leg(0), LegJoint::Yaw).map(drop), "LEGGetJoint");
    refused(legs.link(right, LegLink::Thigh).map(drop), "LEGGetLink");
    refused(legs.is_on_ground(Leg(99)).map(drop), "LEGGetFoot");
    legs.stop()
}

#[test]
fn legs_walk_and_report_their_state_in_both_generations() {
    let six = biped().run(|robot| check(&robot.legs()?, |span| robot.sleep(span))).expect_finished();
    let seven = biped().run_robios7(|robot| check(&robot.legs()?, |span| robot.sleep(span))).expect_finished();
    for run in [six, seven] {
        // 2 s and some calls of 100 us.
        let position = run.position();
        assert!((position.x - 0.4.metres()).abs() < 1.millimetres(), "{position:?}");
        assert!((position.y - 0.2.metres()).abs() < 1.millimetres(), "{position:?}");
        let speed = run.calls_of("LEGSetSpeed").next().expect("it walked").text.clone();
        assert_eq!(speed, "LEGSetSpeed(200, 100, 0) = 0");
    }
}

#[test]
fn wheeled_robot_has_no_legs() {
    let run = Fake::new().run(|robot| robot.legs().map(drop));
    assert!(run.expect_failed().starts_with("the robot has no legs"), "{}", run.expect_failed());
}
