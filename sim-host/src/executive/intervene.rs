//! Interventions in a run, carried out at the start of a slot while no robot runs: their effects on the simulation
//! ([`sim_core::simulation::Intervention`]), on programs and on tasks.
//!
//! Everything that can fail happens during validation: the program of a spawned robot is loaded, and its flow is
//! created, suspended. Carrying out a validated action cannot fail.

use sim_core::RobotId;
use sim_core::record::Action;
use sim_core::simulation::{self, Environment, Intervention, Robots};
use sim_core::time::Time;
use sim_core::world::World;

use super::run::{Member, Run};
use super::spawn::NewRobot;
use crate::robios::robot::Robot;
pub use sim_core::simulation::Refusal;

/// A validated action: carrying it out cannot fail.
pub enum ValidatedAction {
    /// An intervention in the simulation that involves no program.
    Intervention(Intervention),
    /// Types a line to the standard input of a robot's program.
    Type(RobotId, String),
    /// Spawns a robot; the flow of its program is suspended.
    AddRobot(Box<NewRobot>),
    /// Ends the run.
    End,
}

/// Effect of an action on the robots and the run.
#[derive(Default)]
pub struct RunEffect {
    /// Robots whose motion has changed, or for which an awaited input may have arrived.
    pub robots: Vec<RobotId>,
    /// The spawned robot, and true if it has a program.
    pub spawned: Option<(RobotId, bool)>,
    /// The removed or halted robot, whose program must exit.
    pub removed: Option<RobotId>,
    /// The action ends the run.
    pub ends_run: bool,
}

/// The robots of a run, for the simulation.
pub(super) struct Members<'a>(pub &'a Run);

impl Robots for Members<'_> {
    fn with<R>(&mut self, id: RobotId, act: impl FnOnce(&mut simulation::Robot) -> R) -> R {
        act(&mut self.0.robot(id).state)
    }
}

/// Validates `action` for the start of the slot at `at`; for a spawned robot, loads its program and creates its flow.
///
/// # Errors
/// [`Refusal`] if the action names something unknown or is invalid, or if its program cannot be loaded; nothing changes
/// then.
pub fn validate(action: &Action, at: Time, run: &Run, world: &World) -> Result<ValidatedAction, Refusal> {
    match action {
        Action::AddRobot { kind, program_of, x_m, y_m, phi_rad } => {
            let mut spawner = run.spawner();
            let spec = spawner.roster().robot(kind, *program_of, [*x_m, *y_m, *phi_rad], world)?;
            let new_robot = spawner.robot(spec, program_of.map(RobotId), at);
            let new_robot = new_robot.map_err(|error| Refusal::Other(error.to_string()))?;
            if let Some((program, _)) = &new_robot.program {
                let started = run.start_program(new_robot.spec.id, program);
                started.map_err(|error| Refusal::Other(format!("the system has no room for its program: {error}")))?;
            }
            Ok(ValidatedAction::AddRobot(Box::new(new_robot)))
        }
        Action::Type { robot, line } if world.is_robot_present(RobotId(*robot), at) => {
            let id = RobotId(*robot);
            if !run.has_program(id) || run.robot(id).ending.is_some() {
                Err(Refusal::Other(format!("robot {robot} runs no program that could read a line")))
            } else if !run.robot(id).robios.input.is_typed() {
                Err(Refusal::Other("programs read the text of `--stdin`, and nothing else".to_owned()))
            } else {
                Ok(ValidatedAction::Type(id, line.clone()))
            }
        }
        Action::End {} => Ok(ValidatedAction::End),
        Action::Fault { action, .. } => validate(action, at, run, world),
        action => {
            let roster = run.spawner().roster().clone();
            let intervention = Intervention::validate(action, &mut Members(run), &roster, world)?;
            Ok(ValidatedAction::Intervention(intervention))
        }
    }
}

/// Carries out a validated action at the start of the slot at `at`, the world's current slot.
pub fn carry_out(action: ValidatedAction, at: Time, run: &Run, environment: &mut Environment) -> RunEffect {
    match action {
        ValidatedAction::Intervention(intervention) => intervene(intervention, at, run, environment),
        ValidatedAction::Type(id, line) => {
            let mut robot = run.robot(id);
            robot.robios.input.type_line(&line);
            robot.tasks.recheck_input(at);
            RunEffect { robots: vec![id], ..RunEffect::default() }
        }
        ValidatedAction::AddRobot(new_robot) => {
            let NewRobot { spec, mut robot, radio_noise, program } = *new_robot;
            let (program, prepared) = program.unzip();
            environment.admit(&mut robot.state, radio_noise);
            let effect = RunEffect { spawned: Some((spec.id, program.is_some())), ..RunEffect::default() };
            run.admit(Member::new(robot, program));
            run.spawner().register_robot(spec, prepared);
            effect
        }
        ValidatedAction::End => RunEffect { ends_run: true, ..RunEffect::default() },
    }
}

/// Carries out an intervention in the simulation at `at`, with its effects on programs.
fn intervene(intervention: Intervention, at: Time, run: &Run, environment: &mut Environment) -> RunEffect {
    let mut removed = None;
    match &intervention {
        Intervention::Press(id, _) => run.robot(*id).tasks.recheck_input(at),
        Intervention::RemoveRobot(id) => {
            halt(&mut run.robot(*id), run.has_program(*id), at, &environment.world);
            run.mark_removed(*id);
            removed = Some(*id);
        }
        Intervention::HaltRobot(id) => {
            halt(&mut run.robot(*id), run.has_program(*id), at, &environment.world);
            run.mark_removed(*id);
            removed = Some(*id);
        }
        _ => {}
    }
    let effect = environment.intervene(&intervention, &mut Members(run));
    if let (Intervention::AddObject(spec), Some(id)) = (intervention, effect.added_object) {
        run.spawner().register_object(id, *spec);
    }
    RunEffect { robots: effect.robots, removed, ..RunEffect::default() }
}

/// Stops the motors of a robot with a program, which run on after a program of RoBIOS-7 has ended.
fn halt(robot: &mut Robot, has_program: bool, at: Time, world: &World) {
    if has_program {
        // The time of a program that has ended is its end, which the report gives.
        let ended_at = robot.ending.is_some().then_some(robot.now);
        robot.now = robot.now.max(at);
        robot.halt(world);
        robot.now = ended_at.unwrap_or(robot.now);
    }
}
