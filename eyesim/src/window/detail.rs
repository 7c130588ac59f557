//! Details of the robots that pages have selected.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use glam::DVec3;
use sim_core::RobotId;
use sim_core::camera::Camera;
use sim_core::device::switch::SensorId;
use sim_core::noise::Parameter;
use sim_core::world::World;
use sim_host::executive::run::Run;
use sim_host::record::frame::Pixels;
use sim_host::robios::lidar;
use sim_host::robios::panel::PanelRef;
use sim_host::robios::robot::Robot;
use sim_host::scenery::LazyScenery;
use sim_view::protocol::{self, Detail, Picture, Scan, SensorState};

use super::{planar, png_url};

/// Minimum time between two pictures of one camera.
const CAMERA_PERIOD: Duration = Duration::from_millis(100);

/// Creates details, and stores what pages have already received.
#[derive(Default)]
pub struct Details {
    /// Hash of the last picture of each robot's display.
    displays: BTreeMap<RobotId, [u8; 32]>,
    /// Last picture of each camera and the time of its rendering.
    cameras: BTreeMap<RobotId, (Instant, Picture)>,
    renderer: Camera,
}

impl Details {
    /// Detail of robot `id` at the start of the slot. `panel` is the robot's last display if the run has ended.
    pub fn robot(&mut self, run: &Run, world: &World, id: RobotId, panel: Option<PanelRef<'_>>) -> Detail {
        let at = world.slot_start();
        let mut robot = run.robot(id);
        let (pose, odometry) = (planar(&robot.motion.pose(at)), planar(&robot.motion.odometry(at)));
        let points = |(origin, points): (DVec3, Vec<DVec3>)| Scan {
            from_m: origin.to_array(),
            points_m: points.iter().map(DVec3::to_array).collect(),
        };
        let is_scanning = robot.devices.switches.is_on(SensorId::Lidar);
        let scan = lidar::points(&mut robot, world, at).filter(|_| is_scanning).map(points);
        let panel = panel.unwrap_or_else(|| robot.robios.panel());
        let (lcd, lcd_text) = (self.display(id, panel), panel.lines());
        Detail {
            robot: id.0,
            t_s: at.seconds(),
            pose,
            odometry,
            lcd,
            lcd_text,
            scan,
            sensors: sensors(&robot),
            noise: robot.noise_parameters().iter().map(parameter).collect(),
            ..Detail::default()
        }
    }

    /// Picture of a display; none if it is unchanged since the last call.
    fn display(&mut self, id: RobotId, panel: PanelRef<'_>) -> Option<Picture> {
        let canvas = panel.picture();
        let hash = *blake3::hash(canvas.pixels().as_flattened()).as_bytes();
        if self.displays.insert(id, hash) == Some(hash) {
            return None;
        }
        Some(picture(canvas.size().map(|side| side as u32), canvas.pixels().as_flattened()))
    }

    /// Noise-free picture of the camera of robot `id` now; while the run `goes_on`, the last picture if it is younger
    /// than `CAMERA_PERIOD`. None without a camera.
    pub fn camera(
        &mut self,
        run: &Run,
        world: &World,
        id: RobotId,
        scenery: &LazyScenery,
        goes_on: bool,
    ) -> Option<Picture> {
        let last = self.cameras.get(&id).filter(|(rendered, _)| goes_on && rendered.elapsed() < CAMERA_PERIOD);
        if let Some((_, picture)) = last {
            return Some(picture.clone());
        }
        let image = self.render(&mut run.robot(id), world, scenery)?;
        self.cameras.insert(id, (Instant::now(), image.clone()));
        Some(image)
    }

    fn render(&mut self, robot: &mut Robot, world: &World, scenery: &LazyScenery) -> Option<Picture> {
        let at = world.slot_start();
        let view = robot.camera_view(at, None).ok()?;
        let scenery = scenery.get();
        let posed_scenery = scenery.pose_at(world, at);
        let image = self.renderer.colour(&posed_scenery, &view, Some(robot.id), robot.camera_samples());
        Some(picture(image.size(), image.pixels().as_flattened()))
    }
}

/// Sensors of the robot in the order of the scene.
fn sensors(robot: &Robot) -> Vec<SensorState> {
    robot.sensors_on().into_iter().map(|(name, is_on)| SensorState { name: name.to_owned(), is_on }).collect()
}

/// Bound on noise parameters, beyond any sensible value: JSON has no infinite numbers.
const MAX_PARAMETER: f64 = 1e6;

fn parameter(parameter: &Parameter) -> protocol::Parameter {
    protocol::Parameter {
        name: parameter.name(),
        what: parameter.description.to_owned(),
        value: parameter.value.clamp(-MAX_PARAMETER, MAX_PARAMETER),
        range: parameter.range.map(|bound| bound.clamp(-MAX_PARAMETER, MAX_PARAMETER)),
        unit: parameter.unit.to_owned(),
    }
}

fn picture(size_px: [u32; 2], bytes: &[u8]) -> Picture {
    Picture { url: png_url(&Pixels::Colour(bytes).png(size_px)), size_px }
}
