//! What a hand does to a run, at the start of a slot, while nobody runs: first checked, then recorded, then carried out.

use sim_core::RobotId;
use sim_core::time::Time;
use sim_core::world::World;
use sim_view::protocol::Action;

use super::run::Run;
use crate::record::Journal;
use crate::robios::key::{self, Touch};

/// Why an action is refused, in words for who asked for it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Refusal(pub String);

impl Refusal {
    /// The run ends before the action.
    pub fn over() -> Self {
        Self("the run is over by then".to_owned())
    }
}

/// An action that has been checked: it cannot fail any more.
pub enum Deed {
    /// A robot's key is pressed, its display touched, or a key of a remote control pressed.
    Press(RobotId, Touch),
    /// The run ends.
    End,
}

/// Whom an action concerns.
pub enum Effect {
    /// No robot.
    World,
    /// This robot: what it waits for may have come, its motion may have changed.
    Robot(RobotId),
    /// The run ends.
    End,
}

/// What `action` means in this run.
///
/// # Errors
/// [`Refusal`] for what is not there or makes no sense; nothing changes then.
pub fn check(action: &Action, run: &Run, _world: &World) -> Result<Deed, Refusal> {
    match action {
        Action::Press { robot, key } => {
            let touch = key::parse_touch(key).map_err(|error| Refusal(error.to_string()))?;
            Ok(Deed::Press(robot_of(*robot, run)?, touch))
        }
        Action::End {} => Ok(Deed::End),
        _ => Err(Refusal("this cannot be done to a run".to_owned())),
    }
}

/// Does what was checked, at the start of the slot at `at`; what is to be recorded of the world goes to `_journal`.
pub fn carry_out(deed: Deed, at: Time, run: &Run, _world: &mut World, _journal: &mut Journal) -> Effect {
    match deed {
        Deed::Press(robot, touch) => {
            run.robot(robot).press(at, touch);
            Effect::Robot(robot)
        }
        Deed::End => Effect::End,
    }
}

/// The robot of this number.
fn robot_of(number: u32, run: &Run) -> Result<RobotId, Refusal> {
    let count = run.robot_count();
    let is_there = (1..=count).contains(&(number as usize));
    is_there.then_some(RobotId(number)).ok_or_else(|| Refusal(format!("there is no robot {number}")))
}
