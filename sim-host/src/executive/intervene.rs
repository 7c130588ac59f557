//! What a hand does to a run, at the start of a slot, while nobody runs: first checked, then recorded, then carried out.

use sim_core::noise::ParameterError;
use sim_core::noise::Profile;
use sim_core::pose::Pose;
use sim_core::record::{Action, Event, WORLD};
use sim_core::simulation::Environment;
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};

use super::cast;
use super::run::Run;
use crate::robios::key::{ScriptError, Touch, parse_touch};
use crate::robios::robot::Robot;

/// Farthest from the origin that a hand can put anything, m: farther than any world reaches.
const FAR: f64 = 1e6;

/// Greatest heading that a hand can give, rad.
const MAX_HEADING: f64 = 1e6;

/// Why an action is refused, in words for who asked for it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The run ends before it.
    #[error("the run is over by then")]
    Over,
    /// There is no such robot.
    #[error("there is no robot {0}")]
    NoRobot(u32),
    /// There is no such object.
    #[error("there is no movable object {0}")]
    NoObject(u32),
    /// A robot has no such sensor.
    #[error("robot {robot} has no sensor `{sensor}`: it has {known}")]
    NoSensor {
        /// The robot.
        robot: u32,
        /// The name that was asked for.
        sensor: String,
        /// Those that it has.
        known: String,
    },
    /// Nothing can be there.
    #[error(
        "x {x_m} m, y {y_m} m, phi {phi_rad} rad is no place: expected up to 1e6 m from the origin, and a heading up to 1e6 rad"
    )]
    Place {
        /// m
        x_m: f64,
        /// m
        y_m: f64,
        /// rad
        phi_rad: f64,
    },
    /// No key.
    #[error(transparent)]
    Key(#[from] ScriptError),
    /// No number of a noise profile, or a value that it cannot have.
    #[error(transparent)]
    Noise(#[from] ParameterError),
    /// Nothing that can be done to this run.
    #[error("{0}")]
    Other(String),
}

/// An action that has been checked: it cannot fail any more.
pub enum Deed {
    /// A robot's key is pressed, its display touched, or a key of a remote control pressed.
    Press(RobotId, Touch),
    /// A robot is put elsewhere.
    PlaceRobot(RobotId, Pose),
    /// A movable object is put elsewhere.
    PlaceObject(ObjectId, Pose),
    /// Robots get these errors.
    SetNoise(Vec<(RobotId, Profile)>),
    /// Sensors of a robot are switched on or off.
    SwitchSensor(RobotId, String, bool),
    /// A robot or a movable object comes into the world or leaves it.
    Cast(cast::Change),
    /// The run ends.
    End,
}

/// Whom an action has concerned.
#[derive(Default)]
pub struct Effect {
    /// What these robots wait for may have come, or their motion has changed.
    pub robots: Vec<RobotId>,
    /// This object has been put elsewhere, or has come into the world.
    pub object: Option<ObjectId>,
    /// This robot has come into the world, with a program or without.
    pub came: Option<(RobotId, bool)>,
    /// This robot has been taken out of it: its program is to leave.
    pub left: Option<RobotId>,
    /// The run ends.
    pub is_end: bool,
}

/// What `action` means in this run, at the start of the slot at `at`.
///
/// # Errors
/// [`Refusal`] for what is not there or makes no sense; nothing changes then.
pub fn check(action: &Action, at: Time, run: &Run, world: &World) -> Result<Deed, Refusal> {
    Ok(match action {
        Action::Press { robot, key } => Deed::Press(robot_of(*robot, world)?, parse_touch(key)?),
        Action::PlaceRobot { robot, x_m, y_m, phi_rad } => {
            Deed::PlaceRobot(robot_of(*robot, world)?, pose_of([*x_m, *y_m, *phi_rad])?)
        }
        Action::PlaceObject { object, x_m, y_m, phi_rad } => {
            Deed::PlaceObject(object_of(*object, world)?, pose_of([*x_m, *y_m, *phi_rad])?)
        }
        Action::SetNoise { robot, parameter, value } => {
            let robots = match robot {
                Some(robot) => vec![robot_of(*robot, world)?],
                None => present_robots(world).collect(),
            };
            let changed = |id: RobotId| {
                let mut profile = run.robot(id).noise().clone();
                profile.set_parameter(parameter, *value).map(|()| (id, profile))
            };
            Deed::SetNoise(robots.into_iter().map(changed).collect::<Result<_, _>>()?)
        }
        Action::SwitchSensor { robot, sensor, on } => {
            let id = robot_of(*robot, world)?;
            let state = run.robot(id);
            let sensors = state.sensors_on();
            if sensors.iter().all(|(name, _)| name != sensor) {
                return Err(no_sensor(&state, sensor));
            }
            Deed::SwitchSensor(id, sensor.clone(), *on)
        }
        Action::AddRobot { .. }
        | Action::RemoveRobot { .. }
        | Action::AddObject { .. }
        | Action::RemoveObject { .. } => cast::check(action, at, run, world).map(Deed::Cast)?,
        Action::End {} => Deed::End,
    })
}

/// Does what was checked, at the start of the slot at `at`, the world's present one.
pub fn carry_out(deed: Deed, at: Time, run: &Run, environment: &mut Environment) -> Effect {
    let world = &mut environment.world;
    match deed {
        Deed::Press(id, touch) => {
            run.robot(id).press(at, touch);
            Effect::of_robot(id)
        }
        Deed::PlaceRobot(id, pose) => {
            let mut robot = run.robot(id);
            let placed = robot.motion.place(at, pose);
            debug_assert!(placed.is_ok(), "the place was checked");
            robot.record_placed(at, WORLD, &pose);
            world.republish(&mut robot.motion);
            Effect::of_robot(id)
        }
        Deed::PlaceObject(object, pose) => {
            let placed = world.place_object_now(object, pose);
            debug_assert!(placed.is_ok(), "the place was checked");
            let (x_m, y_m, phi_rad) = (pose.position.x, pose.position.y, pose.heading.remainder());
            environment.journal().record(at, &Event::ObjectPlaced { object: object.0, by: WORLD.0, x_m, y_m, phi_rad });
            Effect { object: Some(object), ..Effect::default() }
        }
        Deed::SetNoise(profiles) => {
            let robots = profiles.iter().map(|(id, _)| *id).collect();
            for (id, profile) in profiles {
                let mut robot = run.robot(id);
                let set = robot.set_noise(at, &profile);
                debug_assert!(set.is_ok(), "what a profile may hold makes sense for every drive");
                world.radio_mut().set_errors(id, profile.radio);
                world.republish(&mut robot.motion);
            }
            Effect { robots, ..Effect::default() }
        }
        Deed::SwitchSensor(id, sensor, is_on) => {
            run.robot(id).switch_sensor(at, &sensor, is_on);
            Effect::default()
        }
        Deed::Cast(change) => cast::carry_out(change, at, run, world),
        Deed::End => Effect { is_end: true, ..Effect::default() },
    }
}

impl Effect {
    /// An action that has concerned one robot.
    pub fn of_robot(id: RobotId) -> Self {
        Self { robots: vec![id], ..Self::default() }
    }
}

/// The robots that are in the world now.
pub(super) fn present_robots(world: &World) -> impl Iterator<Item = RobotId> {
    let all = (0..world.robot_count()).map(RobotId::from_index);
    all.filter(|id| world.is_robot_there(*id, world.slot_start()))
}

/// The robot of this number.
pub(super) fn robot_of(number: u32, world: &World) -> Result<RobotId, Refusal> {
    present_robots(world).find(|id| id.0 == number).ok_or(Refusal::NoRobot(number))
}

/// The movable object of this number.
pub(super) fn object_of(number: u32, world: &World) -> Result<ObjectId, Refusal> {
    let known = (1..=world.object_count()).contains(&(number as usize)).then_some(ObjectId(number));
    known.filter(|id| world.is_object_there(*id, world.slot_start())).ok_or(Refusal::NoObject(number))
}

/// A place that a hand can mean.
pub(super) fn pose_of([x_m, y_m, phi_rad]: [f64; 3]) -> Result<Pose, Refusal> {
    // Not a number is not within.
    let is_place = x_m.abs() <= FAR && y_m.abs() <= FAR && phi_rad.abs() <= MAX_HEADING;
    if is_place { Ok(Pose::new(x_m, y_m, phi_rad)) } else { Err(Refusal::Place { x_m, y_m, phi_rad }) }
}

fn no_sensor(robot: &Robot, sensor: &str) -> Refusal {
    let names: Vec<String> = robot.sensors_on().iter().map(|(name, _)| format!("`{name}`")).collect();
    let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    Refusal::NoSensor { robot: robot.id.0, sensor: sensor.to_owned(), known }
}
