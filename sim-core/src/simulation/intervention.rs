//! User interventions at the start of a slot, while no robot acts: an intervention is first validated, then recorded,
//! then applied.

use std::sync::Arc;

use super::{Environment, Robot, Roster};
use crate::build;
use crate::contact::Thing;
use crate::device::key::{UnknownKey, UserInput};
use crate::device::switch::{self, SensorId};
use crate::noise::{ParameterError, Profile, RadioNoise};
use crate::pose::Pose;
use crate::record::{Action, ActionText, Event, WORLD};
use crate::spec::ObjectSpec;
use crate::time::Time;
use crate::world::World;
use crate::{ObjectId, RobotId};

/// Maximum coordinate of a placement, m; larger than any world.
const MAX_COORDINATE: f64 = 1e6;

/// Maximum heading of a placement, rad.
const MAX_HEADING: f64 = 1e6;

/// Reason why an action is rejected, as a message to the user.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The run ends before the time of the action.
    #[error("the run is over by then")]
    Over,
    /// The present time is within a slot; the value is the start of the next one.
    #[error("an intervention acts at the start of a slot: the next one starts at {0}")]
    WithinSlot(Time),
    /// The robot does not exist.
    #[error("there is no robot {0}")]
    NoRobot(u32),
    /// The object does not exist.
    #[error("there is no movable object {0}")]
    NoObject(u32),
    /// The robot has no such sensor.
    #[error("robot {robot} has no sensor `{sensor}`: it has {known}")]
    NoSensor {
        /// The robot.
        robot: u32,
        /// The requested name.
        sensor: String,
        /// Names of the robot's sensors.
        known: String,
    },
    /// The type does not exist.
    #[error("there is no type of {what} `{name}`, accepted: {known}")]
    NoType {
        /// Word for the entities of this type: robots or movable objects.
        what: &'static str,
        /// The requested name.
        name: String,
        /// Known names.
        known: String,
    },
    /// The pose is out of range.
    #[error(
        "x {x_m} m, y {y_m} m, phi {phi_rad} rad is not a valid pose: expected up to 1e6 m from the origin, and a heading up to 1e6 rad"
    )]
    Place {
        /// World x, m.
        x_m: f64,
        /// World y, m.
        y_m: f64,
        /// Heading, rad.
        phi_rad: f64,
    },
    /// An obstacle overlaps the body of a new robot at its position.
    #[error("there is no room for a robot: {} in its place", obstacle_text(.0))]
    Occupied(Thing),
    /// The sensor is not a range sensor; only range sensors can be made to repeat a reading.
    #[error("`{sensor}` of robot {robot} cannot stick: only PSDs and other distance sensors can")]
    CannotStick {
        /// The robot.
        robot: u32,
        /// The sensor.
        sensor: String,
    },
    /// The last robot cannot be removed.
    #[error("robot {0} is the last one: a world has at least one robot")]
    LastRobot(u32),
    /// The limit of added robots or objects is reached.
    #[error("{most} {what} have been added to this run, and no more may be")]
    Full {
        /// The limit.
        most: usize,
        /// Robots or movable objects.
        what: &'static str,
    },
    /// The text does not name a key.
    #[error(transparent)]
    Key(#[from] UnknownKey),
    /// The name does not exist in noise profiles, or the value is out of range.
    #[error(transparent)]
    Noise(#[from] ParameterError),
    /// The simulation cannot apply the action: for example, the action needs a program. The value is the message.
    #[error("{0}")]
    Other(String),
}

fn obstacle_text(thing: &Thing) -> String {
    match thing {
        Thing::Wall(_) | Thing::Floor | Thing::Fixed(_) => "a wall or a fixed object is".to_owned(),
        Thing::Robot(id) => format!("robot {} is", id.0),
        Thing::Object(id) => format!("movable object {} is", id.0),
    }
}

/// A validated action: it can be applied without an error.
#[derive(Clone, Debug)]
pub enum Intervention {
    /// Presses a robot's key, touches its display, or presses a key of a remote control.
    Press(RobotId, UserInput),
    /// Moves a robot to another pose.
    PlaceRobot(RobotId, Pose),
    /// Moves a movable object to another pose.
    PlaceObject(ObjectId, Pose),
    /// Sets the noise profiles of robots.
    SetNoise(Vec<(RobotId, Profile)>),
    /// Switches the sensors of this name of a robot on or off.
    SwitchSensor(RobotId, String, bool),
    /// Removes a robot; the caller has halted it and switches its radio off.
    RemoveRobot(RobotId),
    /// Adds a movable object.
    AddObject(Box<ObjectSpec>),
    /// Removes a movable object.
    RemoveObject(ObjectId),
    /// Makes a robot that the caller has halted fail: its radio is silent, and it does not drive again.
    HaltRobot(RobotId),
    /// Makes the range sensors of this name repeat their reading, or measure again.
    StickSensor(RobotId, String, bool),
    /// Switches a robot's radio on (true) or off; the radio of a halted robot stays off.
    SwitchRadio(RobotId, bool),
}

/// Effect of an intervention.
#[derive(Clone, Debug, Default)]
pub struct Effect {
    /// Robots whose wait may have ended, or whose motion has changed.
    pub robots: Vec<RobotId>,
    /// The movable object that was added.
    pub added_object: Option<ObjectId>,
}

/// Access to robots, one at a time.
pub trait Robots {
    /// Calls `act` with robot `id`.
    fn with<R>(&mut self, id: RobotId, act: impl FnOnce(&mut Robot) -> R) -> R;
}

impl Robots for [Robot] {
    fn with<R>(&mut self, id: RobotId, act: impl FnOnce(&mut Robot) -> R) -> R {
        act(&mut self[id.index()])
    }
}

impl Intervention {
    /// Validates `action` for `world`, at the start of its present slot or of a later slot until which nothing happens.
    /// The caller must handle the actions that type a line to a program, add a robot or end the run; this function
    /// rejects them with [`Refusal::Other`].
    ///
    /// # Errors
    /// [`Refusal`] for unknown robots, objects, types or sensors, and for invalid values.
    pub fn validate(
        action: &Action,
        robots: &mut (impl Robots + ?Sized),
        roster: &Roster,
        world: &World,
    ) -> Result<Self, Refusal> {
        Ok(match action {
            Action::Press { robot, key } => Self::Press(find_robot(*robot, world)?, key.parse()?),
            Action::PlaceRobot { robot, x_m, y_m, phi_rad } => {
                Self::PlaceRobot(find_robot(*robot, world)?, checked_pose([*x_m, *y_m, *phi_rad])?)
            }
            Action::PlaceObject { object, x_m, y_m, phi_rad } => {
                Self::PlaceObject(find_object(*object, world)?, checked_pose([*x_m, *y_m, *phi_rad])?)
            }
            Action::SetNoise { robot, parameter, value } => {
                let ids = match robot {
                    Some(robot) => vec![find_robot(*robot, world)?],
                    None => present_robots(world).collect(),
                };
                let changed = |id: RobotId| {
                    let mut profile = robots.with(id, |robot| robot.noise().clone());
                    profile.set_parameter(parameter, *value).map(|()| (id, profile))
                };
                Self::SetNoise(ids.into_iter().map(changed).collect::<Result<_, _>>()?)
            }
            Action::SwitchSensor { robot, sensor, on } => {
                let id = find_robot(*robot, world)?;
                robots.with(id, |robot| check_sensor(robot, sensor))?;
                Self::SwitchSensor(id, sensor.clone(), *on)
            }
            Action::RemoveRobot { robot } => {
                let id = find_robot(*robot, world)?;
                if present_robots(world).nth(1).is_none() {
                    return Err(Refusal::LastRobot(*robot));
                }
                Self::RemoveRobot(id)
            }
            Action::AddObject { .. } if !crate::object::Bodies::ARE_BUILT => {
                return Err(Refusal::Other("movable objects need the feature `objects` of sim-core".to_owned()));
            }
            Action::AddObject { kind, x_m, y_m, phi_rad } => {
                let pose = checked_pose([*x_m, *y_m, *phi_rad])?;
                Self::AddObject(Box::new(roster.object(kind, pose)?))
            }
            Action::RemoveObject { object } => Self::RemoveObject(find_object(*object, world)?),
            Action::HaltRobot { robot } => Self::HaltRobot(find_robot(*robot, world)?),
            Action::StickSensor { robot, sensor, on } => {
                let id = find_robot(*robot, world)?;
                robots.with(id, |robot| {
                    check_sensor(robot, sensor)?;
                    let can = |(name, kind): (&str, SensorId)| name == sensor && matches!(kind, SensorId::Range(_));
                    let is_range = switch::sensors(&robot.spec).any(can);
                    let refusal = || Refusal::CannotStick { robot: robot.id.0, sensor: sensor.clone() };
                    is_range.then_some(()).ok_or_else(refusal)
                })?;
                Self::StickSensor(id, sensor.clone(), *on)
            }
            Action::SwitchRadio { robot, on } => Self::SwitchRadio(find_robot(*robot, world)?, *on),
            Action::Fault { action, .. } => return Self::validate(action, robots, roster, world),
            Action::Type { robot, .. } => {
                find_robot(*robot, world)?;
                return Err(Refusal::Other(format!("robot {robot} runs no program that could read a line")));
            }
            Action::AddRobot { .. } => return Err(Refusal::Other("a robot comes by who owns the run".to_owned())),
            Action::End {} => return Err(Refusal::Other("a simulation ends where its owner leaves it".to_owned())),
        })
    }
}

impl Environment {
    /// Advances the world to `at`, the start of a slot until which nothing happens, and records a validated `action`.
    pub fn record_intervention(&mut self, at: Time, action: &Action) {
        self.world.advance_to(at);
        self.record_starts();
        let text = serde_json::to_string(action).unwrap_or_default();
        self.journal().record(at, &Event::Intervention { action: ActionText(&text) });
    }

    /// Applies a validated and recorded intervention at the start of the world's present slot.
    pub fn intervene(&mut self, intervention: &Intervention, robots: &mut (impl Robots + ?Sized)) -> Effect {
        let world = &mut self.world;
        let at = world.slot_start();
        match intervention {
            Intervention::Press(id, touch) => {
                robots.with(*id, |robot| robot.devices.press(at, *touch));
                return Effect::of_robot(*id);
            }
            Intervention::PlaceRobot(id, pose) => {
                robots.with(*id, |robot| {
                    let result = robot.motion.place(at, *pose);
                    debug_assert!(result.is_ok(), "the pose was validated");
                    robot.record_placed(at, WORLD, pose);
                    world.republish(&mut robot.motion);
                });
                return Effect::of_robot(*id);
            }
            Intervention::PlaceObject(object, pose) => {
                let result = world.place_object_now(*object, *pose);
                debug_assert!(result.is_ok(), "the pose was validated");
                let (x_m, y_m, phi_rad) = (pose.position.x, pose.position.y, pose.heading.remainder());
                self.journal().record(at, &Event::ObjectPlaced { object: object.0, by: WORLD.0, x_m, y_m, phi_rad });
                self.record_object(at, *object);
            }
            Intervention::SetNoise(profiles) => {
                for (id, profile) in profiles {
                    robots.with(*id, |robot| {
                        let result = robot.set_noise(at, profile);
                        debug_assert!(result.is_ok(), "a validated profile is valid for every drive");
                        world.radio_mut().set_errors(*id, profile.radio);
                        world.republish(&mut robot.motion);
                    });
                }
                return Effect { robots: profiles.iter().map(|(id, _)| *id).collect(), added_object: None };
            }
            Intervention::SwitchSensor(id, sensor, is_on) => {
                robots.with(*id, |robot| robot.switch_sensor(at, sensor, *is_on));
            }
            Intervention::RemoveRobot(id) => {
                robots.with(*id, |robot| {
                    robot.is_removed = true;
                    // A removed robot stays where it is, even if its motors run, or its hull has momentum. (A robot
                    // beyond 10^9 m is too far away to be placed, and only comes to rest.)
                    let pose = robot.motion.pose(at);
                    let _ = robot.motion.place(at, pose);
                });
                world.remove_robot(*id);
                self.forget_robot(*id);
            }
            Intervention::AddObject(spec) => {
                let figure = Arc::new(build::figure(&spec.kind));
                let Ok(object) = world.add_object(build::properties(spec), spec.pose, Some(figure)) else {
                    unreachable!("the pose was validated")
                };
                self.record_object(at, object);
                return Effect { added_object: Some(object), ..Effect::default() };
            }
            Intervention::RemoveObject(object) => world.remove_object(*object),
            Intervention::HaltRobot(id) => {
                world.radio_mut().set_silent(*id, true);
                robots.with(*id, |robot| {
                    robot.is_halted = true;
                    world.republish(&mut robot.motion);
                });
                return Effect::of_robot(*id);
            }
            Intervention::StickSensor(id, sensor, is_stuck) => {
                robots.with(*id, |robot| robot.stick_sensor(world, at, sensor, *is_stuck));
            }
            Intervention::SwitchRadio(id, is_on) => {
                let is_halted = robots.with(*id, |robot| robot.is_halted);
                world.radio_mut().set_silent(*id, !is_on || is_halted);
            }
        }
        Effect::default()
    }

    /// Adds `robot`, whose id must be the next one, at the start of the present slot; `reception_noise` is the noise
    /// model of its radio.
    pub fn admit(&mut self, robot: &mut Robot, reception_noise: RadioNoise) {
        let figure = Arc::new(build::robot_figure(&robot.spec));
        self.world.add_robot(&mut robot.motion, Some(figure));
        self.world.radio_mut().set_errors(robot.id, reception_noise);
        robot.record_arrival(&self.world);
    }
}

impl Effect {
    fn of_robot(id: RobotId) -> Self {
        Self { robots: vec![id], added_object: None }
    }
}

/// Robots that are in the world at the start of the present slot.
fn present_robots(world: &World) -> impl Iterator<Item = RobotId> {
    let all = (0..world.robot_count()).map(RobotId::from_index);
    all.filter(|id| world.is_robot_present(*id, world.slot_start()))
}

fn find_robot(number: u32, world: &World) -> Result<RobotId, Refusal> {
    present_robots(world).find(|id| id.0 == number).ok_or(Refusal::NoRobot(number))
}

fn find_object(number: u32, world: &World) -> Result<ObjectId, Refusal> {
    let valid_id = (1..=world.object_count()).contains(&(number as usize)).then_some(ObjectId(number));
    valid_id.filter(|id| world.is_object_present(*id, world.slot_start())).ok_or(Refusal::NoObject(number))
}

/// Pose of a placement, if its coordinates and heading are within their ranges.
pub(super) fn checked_pose([x_m, y_m, phi_rad]: [f64; 3]) -> Result<Pose, Refusal> {
    // NaN fails these comparisons.
    let is_valid = x_m.abs() <= MAX_COORDINATE && y_m.abs() <= MAX_COORDINATE && phi_rad.abs() <= MAX_HEADING;
    if is_valid { Ok(Pose::new(x_m, y_m, phi_rad)) } else { Err(Refusal::Place { x_m, y_m, phi_rad }) }
}

fn check_sensor(robot: &Robot, sensor: &str) -> Result<(), Refusal> {
    let sensors = robot.sensors_on();
    if sensors.iter().any(|(name, _)| *name == sensor) {
        return Ok(());
    }
    let names: Vec<String> = sensors.iter().map(|(name, _)| format!("`{name}`")).collect();
    let list = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    Err(Refusal::NoSensor { robot: robot.id.0, sensor: sensor.to_owned(), known: list })
}
