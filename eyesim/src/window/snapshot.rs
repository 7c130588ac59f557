//! State of bodies, programs and sensors at the start of a slot.

use sim_core::device::range::SensorView;
use sim_core::device::switch::SensorId;
use sim_core::simulation;
use sim_core::time::Time;
use sim_core::world::{PublishedPiece, World};
use sim_core::{ObjectId, RobotId};
use sim_host::executive::program_status::waits_now;
use sim_host::executive::run::Run;
use sim_host::robios::ir;
use sim_host::robios::robot::{Ending, Robot};
use sim_view::protocol::{Beam, MotionPiece, ObjectState, RobotState, Standing};

use super::planar;

/// Maximum number of beams of a snapshot; beams of the robots that pages have selected come first.
const MAX_BEAMS: usize = 600;

/// States of the robots `ids`.
pub fn robots(run: &Run, world: &World, ids: impl Iterator<Item = RobotId>) -> Vec<RobotState> {
    let at = world.slot_start();
    let state = |id| {
        let mut robot = run.robot(id);
        let (standing, why) = standing(&robot, run.has_program(id));
        let (now_s, is_stalled) = (robot.now.seconds(), robot.motion.is_stalled(at));
        let (lift_m, joints_rad) =
            world.stance(id).map(|stance| (stance.lift, stance.joints.clone())).unwrap_or_default();
        RobotState { id: id.0, motion: motion(world, id), lift_m, joints_rad, standing, now_s, why, is_stalled }
    };
    ids.map(state).collect()
}

/// State of a robot's program, and the reason for it.
fn standing(robot: &Robot, has_program: bool) -> (Standing, String) {
    match &robot.ending {
        _ if !has_program => (Standing::NoProgram, String::new()),
        Some(Ending::Exited { code: 0 }) => (Standing::Finished, String::new()),
        Some(Ending::Exited { code }) => (Standing::Failed, format!("exit code {code}")),
        Some(Ending::Failed { reason } | Ending::Overdue { reason }) => (Standing::Failed, reason.clone()),
        Some(Ending::Stopped) | None if !robot.tasks.are_all_waiting() => (Standing::Running, String::new()),
        Some(Ending::Stopped) | None => (Standing::Waiting, waits_now(robot)),
    }
}

/// Pieces of motion of a robot from the slot's start to its end.
fn motion(world: &World, id: RobotId) -> Vec<MotionPiece> {
    let end = world.slot_end();
    let piece = |PublishedPiece { start, world_from_robot, twist, duration }: PublishedPiece| MotionPiece {
        t_s: start.seconds(),
        from: planar(&world_from_robot),
        v_m_per_s: twist.vx,
        left_m_per_s: twist.vy,
        omega_rad_per_s: twist.omega,
        lasts_s: duration.min((end - start).seconds()),
    };
    world.published_pieces(id).map(piece).collect()
}

/// Poses of the movable objects `ids`.
pub fn objects(world: &World, ids: impl Iterator<Item = ObjectId>) -> Vec<ObjectState> {
    let at = world.slot_start();
    ids.map(|id| ObjectState { id: id.0, pose: planar(&world.object_pose(id, at)) }).collect()
}

/// Noise-free beams of the range and infrared sensors of the robots `ids`, in this order, until the beams of the next
/// robot would exceed `MAX_BEAMS`.
pub fn beams(run: &Run, world: &World, ids: impl Iterator<Item = RobotId>) -> Vec<Beam> {
    let at = world.slot_start();
    let mut beams = Vec::new();
    for id in ids {
        let mut robot = run.robot(id);
        let views = views(&mut robot, world, at);
        if beams.len() + views.len() > MAX_BEAMS {
            break;
        }
        beams.extend(views.iter().map(|(sensor, view)| beam(id, *sensor, view)));
    }
    beams
}

/// Views of the robot's range sensors, then of its infrared sensors, without sensors that are switched off. Each view
/// has the index of its sensor in the robot's list of sensors.
fn views(robot: &mut Robot, world: &World, at: Time) -> Vec<(u32, SensorView)> {
    let simulation::Robot { devices, motion, .. } = &mut robot.state;
    let ranges = devices.ranges.views(&devices.servos, motion, world, at);
    let kinds = (0..ranges.len()).map(SensorId::Range);
    let infrareds = ir::views(robot, world, at);
    let kinds: Vec<SensorId> = kinds.chain((0..infrareds.len()).map(SensorId::Infrared)).collect();
    let all_views = (0..).zip(ranges.into_iter().chain(infrareds)).zip(kinds);
    all_views.filter(|(_, sensor)| robot.devices.switches.is_on(*sensor)).map(|(view, _)| view).collect()
}

fn beam(RobotId(robot): RobotId, sensor: u32, view: &SensorView) -> Beam {
    let from = view.world_from_sensor.position;
    let to = from + view.world_from_sensor.forward() * view.distance.unwrap_or(view.range);
    Beam { robot, sensor, from_m: from.to_array(), to_m: to.to_array(), is_hit: view.distance.is_some() }
}
