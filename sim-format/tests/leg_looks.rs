//! Legged robots seen by cameras: each part at the pose given by the robot's joints.

use std::sync::Arc;

use glam::DVec3;
use sim_core::build;
use sim_core::camera::{Attachment, Label};
use sim_core::drive::{Command, Motion};
use sim_core::pose::Twist;
use sim_core::time::Time;
use sim_core::world::World;
use sim_format::{FileError, Files, MeshReader, load_scene};

struct Scene;

impl Files for Scene {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        const TEXT: &str = r#"
[world]
floor_mm = [8000, 8000]

[[robot_type]]
name = "Walker"
diameter_mm = 400
drive = { kind = "legged" }
leg = [
    { name = "LEFT", y_mm = 150, z_mm = 800, thigh_mm = 440, shank_mm = 440 },
    { name = "RIGHT", y_mm = -150, z_mm = 820, thigh_mm = 430, shank_mm = 400, foot = { heel_mm = 50, toe_mm = 150, height_mm = 70 } },
]

[[robot]]
type = "Walker"
x_mm = 2000
y_mm = 3000
heading_deg = 30
"#;
        if path == "a.scene.toml" { Ok(TEXT.into()) } else { Err(FileError::Missing) }
    }

    fn list(&self, _: &str) -> Vec<String> {
        Vec::new()
    }

    fn home(&self) -> Option<&str> {
        None
    }
}

#[test]
fn cameras_see_legs_at_the_poses_of_their_joints() {
    let loaded = load_scene("a.scene.toml", &Scene);
    assert_eq!(loaded.diagnostics, []);
    let spec = &loaded.scene.robots[0];
    let legs = build::legs(&spec.robi).expect("legs");
    let walls = build::obstacles(&loaded.scene);
    let model = Arc::new(build::model(&spec.robi));
    let motion = Motion::new(spec.id, model, Arc::clone(&walls), spec.start);
    let mut motion = motion.with_legs(legs, build::ground(&loaded.scene.world));
    let slot = Time::from_millis(10);
    let mut world = World::new(walls, slot, [&mut motion]);
    let scenery = build::scenery(&loaded.scene, &mut MeshReader::new(&Scene));
    let of_legs: Vec<usize> = (0..scenery.parts().len())
        .filter(|part| matches!(scenery.parts()[*part].attachment, Attachment::Leg(..)))
        .collect();
    assert_eq!(of_legs.len(), 5, "two thighs, two shanks, a foot");
    assert!(of_legs.iter().all(|part| scenery.parts()[*part].label == Label::Robot(spec.id)));
    let twist = Command::Twist(Twist { vx: 0.2, vy: 0.05, omega: 0.1 });
    motion.command(Time::ZERO, twist, &[]).expect("a walk");
    let mut positions = Vec::new();
    for _ in 0..300 {
        let at = world.slot_start();
        let posed = scenery.pose_at(&world, at);
        let stance = motion.stance(at);
        let pose = |part: usize| posed.poses()[of_legs[part]].expect("it is there");
        // Tip of the left shank, and the contact point of the right foot's sole with the ground.
        let tip = pose(1).transform_point(DVec3::new(0.0, 0.0, -0.44));
        let sole = pose(4).transform_point(DVec3::new(stance.feet[1].sole.from_ankle, 0.0, -0.07));
        for (point, foot) in [tip, sole].into_iter().zip(&stance.feet).filter(|(_, foot)| foot.is_down) {
            assert!(point.distance(foot.point) < 1e-3, "at {at}: {point} is not on the foot's place {}", foot.point);
        }
        positions.push(tip);
        world.advance(&mut [&mut motion]);
    }
    let highest = positions.iter().map(|position| position.z).fold(0.0, f64::max);
    assert!(highest > 0.01, "the leg is lifted, by {highest} m");
    assert!(positions[0].distance(positions[299]) > 0.3, "it walks");
}
