//! The door through which somebody outside paces a run, ends it or takes part in it: between two slots, while nobody runs.

use sim_core::record::Action;
use sim_core::time::Time;
use sim_core::world::World;

use super::conductor::End;
use super::intervene::Refusal;
use super::run::Run;

/// Decides when the run goes on, and what happens to it before.
///
/// The slot loop asks before each slot, also before the first. It holds the world's lock meanwhile, while the robots' are free;
/// a wait must end soon after [the user interrupts](super::signal::is_interrupted).
pub trait Gate: Send {
    /// Waits until the run may go on from `boundary`, and says how. After a [`Pass::Act`] it is asked again, with the boundary that
    /// the acts have made.
    fn wait(&mut self, boundary: &Boundary<'_>) -> Pass;
}

/// Where a run stands between two slots.
pub struct Boundary<'a> {
    /// The run; all its robots are suspended.
    pub run: &'a Run,
    /// Its world, at the start of the slot at `following`.
    pub world: &'a World,
    /// Start of the slot after the one that has ended.
    pub following: Time,
    /// Start of the next slot in which anything happens, `following` or later; none when nothing happens any more unless
    /// somebody acts: no program is alive, or all wait for what cannot come.
    pub next: Option<Time>,
    /// When the run ends: at or after it no slot begins.
    pub until: Time,
}

/// How a run goes on.
pub enum Pass {
    /// The next slot begins; without one, or with none before the run's limit, the run is over.
    Begin,
    /// These actions happen at `at`, in order.
    Act {
        /// Start of a slot, from [`Boundary::following`] to [`Boundary::next`].
        at: Time,
        /// What is done.
        actions: Vec<Intervention>,
    },
    /// The run is over.
    End(End),
}

/// What somebody does to the run, and who wants to know what becomes of it.
pub struct Intervention {
    /// What is done.
    pub action: Action,
    /// Is called once, when the action has been carried out or refused.
    pub answer: Answer,
}

/// Takes what became of an action.
pub type Answer = Box<dyn FnOnce(Result<(), Refusal>) + Send>;

impl Intervention {
    /// An action of which nobody wants to know what becomes.
    pub fn unanswered(action: Action) -> Self {
        Self { action, answer: Box::new(|_| ()) }
    }
}
