//! Factory that creates the robots and the world of a simulation from a scene.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use super::Robot;
use crate::build;
use crate::device::Devices;
use crate::drive::{Model, ModelError, Motion};
use crate::noise::{Profile, RadioNoise};
use crate::object::Bodies;
use crate::radio::Channel;
use crate::scene::{Ground, Walls};
use crate::spec::{ContactKind, NoiseRef, RobotSpec, SceneSpec};
use crate::time::Time;
use crate::world::World;

/// Factory that creates the robots of a scene, at the start and during the run.
#[derive(Clone, Debug)]
pub struct RobotFactory {
    seed: u64,
    slot: Time,
    is_verbose: bool,
    walls: Arc<Walls>,
    /// Depth of the water, m; `None` in a world without water.
    water: Option<f64>,
    /// Ground for legged robots.
    ground: Arc<Ground>,
    /// Rule of contacts with walls, and the coefficient of friction of the walls.
    contact: ContactKind,
    wall_friction: f64,
    /// Corners of the bounding rectangle of floor and walls, m.
    floor: (DVec2, DVec2),
    /// Cache of models by the files of the robot types.
    models: BTreeMap<String, Arc<Model>>,
    /// Cache of initial devices, by the files of the robot types; robots share the constant parts.
    devices: BTreeMap<String, Devices>,
    /// Cache of noise profiles, by their references in the scene.
    profiles: Vec<(NoiseRef, Option<Arc<Profile>>)>,
}

/// Reason why a scene cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FactoryError {
    /// A robot type, or the noise model of its drive, has an invalid value.
    #[error("robot type `{file}`: {part}{error}")]
    Robot {
        /// The file of the robot type.
        file: String,
        /// `noise of the drive: ` if the noise model is invalid; empty if the robot type is invalid.
        part: &'static str,
        /// The invalid value.
        error: ModelError,
    },
    /// The scene has movable objects (the value is their number), and this build has no [rigid bodies](Bodies).
    #[error("movable objects (the scene has {0}) need the feature `objects` of sim-core")]
    Objects(usize),
}

impl RobotFactory {
    /// Factory for a run of `scene` with `seed` and slots of length `slot`; `is_verbose` turns the recording of calls
    /// on.
    pub fn new(scene: &SceneSpec, seed: u64, slot: Time, is_verbose: bool) -> Self {
        Self {
            seed,
            slot,
            is_verbose,
            walls: build::obstacles(scene),
            water: scene.world.water,
            ground: build::ground(&scene.world),
            contact: scene.run.contact.unwrap_or_default(),
            wall_friction: scene.run.wall_friction.unwrap_or(f64::INFINITY),
            floor: scene.world.bounds(),
            models: BTreeMap::new(),
            devices: BTreeMap::new(),
            profiles: Vec::new(),
        }
    }

    /// This factory for a run with `seed` and slots of length `slot`.
    pub(super) fn with_seed(self, seed: u64, slot: Time) -> Self {
        Self { seed, slot, ..self }
    }

    /// Creates the robot of `spec`, which enters the world at `since`; also returns the noise model of its radio.
    ///
    /// # Errors
    /// [`FactoryError::Robot`] if the robot type, or the noise model of its drive, has an invalid value.
    pub fn robot(&mut self, spec: &RobotSpec, since: Time) -> Result<(Robot, RadioNoise), FactoryError> {
        let invalid = |part| move |error| FactoryError::Robot { file: spec.robi.file.clone(), part, error };
        let new_model = || Arc::new(build::model(&spec.robi));
        let model = Arc::clone(self.models.entry(spec.robi.file.clone()).or_insert_with(new_model));
        model.check().map_err(invalid(""))?;
        let motion = Motion::new(spec.id, model, Arc::clone(&self.walls), spec.start).starting_at(since);
        let rule = build::contact_rule(self.contact, self.wall_friction, &spec.robi);
        let mut motion = motion.with_contact(rule).map_err(invalid(""))?;
        if spec.robi.bumpers.is_empty() {
            motion = motion.without_impact_log();
        }
        if let Some(legs) = build::legs(&spec.robi) {
            motion = motion.with_legs(legs, Arc::clone(&self.ground));
        }
        // A hull starts at the surface of the water. In a world without water, its check fails.
        if let Some(hull) = build::hull(&spec.robi, self.water.unwrap_or_default()) {
            motion = motion.with_hull(hull, hull.ceiling).map_err(invalid(""))?;
        }
        let devices = self.devices.entry(spec.robi.file.clone()).or_insert_with(|| Devices::new(&spec.robi)).clone();
        let mut robot = Robot::new(motion, (Arc::clone(&spec.robi), devices), since, self.seed, self.is_verbose);
        robot.watch_floor(self.floor);
        let Some(profile) = self.profile(spec) else { return Ok((robot, RadioNoise::default())) };
        robot.set_noise(since, &profile).map_err(invalid("noise of the drive: "))?;
        Ok((robot, profile.radio))
    }

    /// Creates the world of `scene`, which must be the scene of this factory, at time 0 with the given robots, in the
    /// order of their ids. `reception_noise` are the noise models of their radios.
    ///
    /// # Errors
    /// [`FactoryError::Objects`] in a build without the feature `objects`.
    pub fn world<'a>(
        &self,
        scene: &SceneSpec,
        robots: impl IntoIterator<Item = &'a mut Robot>,
        reception_noise: Vec<RadioNoise>,
    ) -> Result<World, FactoryError> {
        let movable = build::movable_objects(scene).count();
        if movable > 0 && !Bodies::ARE_BUILT {
            return Err(FactoryError::Objects(movable));
        }
        let motions = robots.into_iter().map(|robot| &mut robot.motion);
        let objects = build::movable_objects(scene).map(|object| (build::properties(object), object.pose));
        let radio = Channel::new(scene.radio, self.seed, reception_noise);
        let world = World::new(Arc::clone(&self.walls), self.slot, motions);
        Ok(world.with_objects(objects).with_space(build::space(scene)).with_radio(radio))
    }

    /// Noise profile of a robot; `None` if it has no errors.
    fn profile(&mut self, robot: &RobotSpec) -> Option<Arc<Profile>> {
        let noise = robot.noise.as_ref()?;
        if let Some((_, profile)) = self.profiles.iter().find(|(known, _)| known == noise) {
            return profile.clone();
        }
        let profile = noise.profile().map(Arc::new);
        self.profiles.push((noise.clone(), profile.clone()));
        profile
    }
}
