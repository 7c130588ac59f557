//! Infrared proximity sensors: binary sensors that detect a surface within their range.
//!
//! Source: RoBIOS 6 library, bumper and infrared sensors.

use robios_sys::Robios6Call as Call;
use robios_sys::robios6::hdt_type::HDT_IR;
use sim_core::pose::Pose3;
use sim_core::sensor::{Beam, Mount};
use sim_core::spec::InfraredSpec;
use sim_core::time::Time;
use sim_core::world::World;

use super::robot::Robot;
use sim_core::device::range::SensorView;
use sim_core::device::switch::SensorId;
use sim_core::record::Event;

/// Pose of each infrared sensor in the world at time `at`, and the distance to the surface in front of it.
pub fn views(robot: &mut Robot, world: &World, at: Time) -> Vec<SensorView> {
    let (world_from_robot, lift) = (robot.motion.pose(at), robot.motion.lift(at));
    let view = |infrared: &InfraredSpec| {
        let mount = Mount::new(infrared.position.x, infrared.position.y, infrared.angle);
        let beam = Beam { mount, range: infrared.range };
        let world_from_sensor =
            Pose3::from_planar(&world_from_robot.compose(&mount.robot_from_sensor), infrared.position.z + lift);
        SensorView {
            world_from_sensor,
            range: beam.range,
            distance: beam.distance(world, robot.id, &world_from_robot, at),
        }
    };
    robot.spec.infrareds.iter().map(view).collect()
}

/// `IRInit`
pub fn init(robot: &mut Robot, semantics: i32) -> i32 {
    match robot.robios.table.find(HDT_IR, semantics).map(|device| device.index) {
        Some(index) => robot.robios.infrareds.open(index),
        None => robot.refuse_missing_device(Call::IRInit, 0, HDT_IR, semantics),
    }
}

/// `IRRelease`
pub fn release(robot: &mut Robot, handles: i32) -> i32 {
    match robot.robios.infrareds.release(handles) {
        0 => 0,
        unopened => robot.fail_call(Call::IRRelease, unopened),
    }
}

/// `IRRead`
pub fn read(robot: &mut Robot, world: &World, handle: i32) -> i32 {
    let index = robot.robios.infrareds.device(handle);
    let Some((index, infrared)) = index.and_then(|index| Some((index, robot.spec.infrareds.get(index)?))) else {
        return robot.refuse_handle(Call::IRRead, -1, handle, Call::IRInit);
    };
    let mount = Mount::new(infrared.position.x, infrared.position.y, infrared.angle);
    let beam = Beam { mount, range: infrared.range };
    let is_on = robot.devices.switches.is_on(SensorId::Infrared(index));
    let value =
        i32::from(is_on && beam.is_interrupted(world, robot.id, &robot.state.motion.pose(robot.now), robot.state.now));
    let device = robot.robios.table.name(HDT_IR, index);
    robot.state.journal.record(robot.state.now, &Event::Reading { device, value: value.into() });
    value
}
