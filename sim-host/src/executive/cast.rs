//! Robots and movable objects come into a running world, and leave it.
//!
//! Everything that can fail is done when the action is checked: a program is loaded and its flow started, suspended. What is carried
//! out then cannot fail any more.

use std::sync::Arc;

use sim_core::contact::Thing;
use sim_core::record::Action;
use sim_core::spec::ObjectSpec;
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId, build};

use super::intervene::{Effect, Refusal, object_of, pose_of, present_robots, robot_of};
use super::run::{Member, Run};
use super::spawn::NewRobot;

/// Who comes or leaves: checked.
pub enum Change {
    /// A robot comes; the flow of its program is suspended.
    AddRobot(Box<NewRobot>),
    /// A robot leaves.
    RemoveRobot(RobotId),
    /// A movable object comes.
    AddObject(Box<ObjectSpec>),
    /// A movable object leaves.
    RemoveObject(ObjectId),
}

/// What `action` means at `at`, the start of the next slot.
///
/// # Errors
/// [`Refusal`] for what is not known, does not fit in, or cannot be loaded; nothing changes then.
pub fn check(action: &Action, at: Time, run: &Run, world: &World) -> Result<Change, Refusal> {
    Ok(match action {
        Action::AddRobot { kind, program_of, x_m, y_m, phi_rad } => {
            let start = pose_of([*x_m, *y_m, *phi_rad])?;
            // The program of one that has been removed is still known.
            let is_known = |number: &u32| (1..=world.robot_count()).contains(&(*number as usize));
            if let Some(number) = program_of.filter(|number| !is_known(number)) {
                return Err(Refusal::NoRobot(number));
            }
            let mut spawner = run.spawner();
            let robi = spawner.types().robot(kind).map_err(Refusal::Other)?;
            if let Some(thing) = world.overlapped(start.position, 0.5 * robi.diameter) {
                return Err(Refusal::Other(in_the_way(thing)));
            }
            let new = spawner.robot(robi, program_of.map(RobotId), start, at);
            let new = new.map_err(|error| Refusal::Other(format!("{error:#}")))?;
            if let Some((program, _)) = &new.program {
                let started = run.start_program(new.spec.id, program);
                started.map_err(|error| Refusal::Other(format!("the system has no room for its program: {error}")))?;
            }
            Change::AddRobot(Box::new(new))
        }
        Action::RemoveRobot { robot } => {
            let id = robot_of(*robot, world)?;
            if present_robots(world).nth(1).is_none() {
                return Err(Refusal::Other(format!("robot {robot} is the last one: a world has at least one robot")));
            }
            Change::RemoveRobot(id)
        }
        Action::AddObject { kind, x_m, y_m, phi_rad } => {
            let pose = pose_of([*x_m, *y_m, *phi_rad])?;
            let spawner = run.spawner();
            let kind = spawner.types().object(kind).map_err(Refusal::Other)?;
            let new = spawner.object(kind, pose).map_err(|error| Refusal::Other(error.to_string()))?;
            Change::AddObject(Box::new(new))
        }
        Action::RemoveObject { object } => Change::RemoveObject(object_of(*object, world)?),
        _ => return Err(Refusal::Other("nobody comes or leaves by this action".to_owned())),
    })
}

fn in_the_way(thing: Thing) -> String {
    let what = match thing {
        Thing::Wall(_) | Thing::Floor | Thing::Fixed(_) => "a wall or a fixed object is".to_owned(),
        Thing::Robot(id) => format!("robot {} is", id.0),
        Thing::Object(id) => format!("movable object {} is", id.0),
    };
    format!("there is no room for a robot: {what} in its place")
}

/// Lets it happen at the start of the slot at `at`, the world's present one.
pub fn carry_out(change: Change, at: Time, run: &Run, world: &mut World) -> Effect {
    let mut spawner = run.spawner();
    match change {
        Change::AddRobot(new) => {
            let NewRobot { spec, mut robot, heard, program } = *new;
            let id = spec.id;
            let (program, prepared) = program.unzip();
            world.add_robot(&mut robot.motion, Some(Arc::new(build::robot_figure(&spec.robi))));
            world.radio_mut().set_errors(id, heard);
            robot.record_arrival(world);
            let effect = Effect { came: Some((id, program.is_some())), ..Effect::default() };
            run.admit(Member::new(robot, program));
            spawner.keep_robot(spec, prepared);
            effect
        }
        Change::RemoveRobot(id) => {
            let mut robot = run.robot(id);
            if run.has_program(id) && robot.ending.is_none() {
                robot.now = robot.now.max(at);
                robot.halt(world);
            }
            robot.is_removed = true;
            world.remove_robot(id);
            run.dismiss(id);
            Effect { left: Some(id), ..Effect::default() }
        }
        Change::AddObject(spec) => {
            let figure = Arc::new(build::figure(&spec.kind));
            let Ok(id) = world.add_object(build::properties(&spec), spec.pose, Some(figure)) else {
                unreachable!("the place was checked")
            };
            spawner.keep_object(id, *spec);
            Effect { object: Some(id), ..Effect::default() }
        }
        Change::RemoveObject(id) => {
            world.remove_object(id);
            Effect::default()
        }
    }
}
