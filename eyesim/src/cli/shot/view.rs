//! Picture of a finished run by a robot's camera or by a free camera.

use anyhow::Context;
use glam::{DVec2, DVec3};
use sim_core::RobotId;
use sim_core::camera::{Camera, Lens, View};
use sim_core::drive::HISTORY;
use sim_core::math;
use sim_core::pose::Pose3;
use sim_core::spec::{DEFAULT_FIELD_OF_VIEW, DEFAULT_LENS, MAX_FIELD_OF_VIEW_DEG};
use sim_core::time::Time;
use sim_host::launch::settings::index_of;
use sim_host::record::frame::Pixels;
use sim_host::robios::camera::{self, ImageUnavailable};

use crate::cli::run::FinishedRun;

/// Maximum width and height of a picture in pixels.
pub const MAX_SIDE: u32 = 4096;

/// Maximum field of view of a picture, in degrees.
pub const MAX_FOV_DEG: f64 = MAX_FIELD_OF_VIEW_DEG;

/// Default size of a picture of a free camera.
const SIZE: [u32; 2] = [640, 480];

/// Default number of samples of a free camera along each side of a pixel.
const SAMPLES: u32 = 4;

/// Size of the area in a picture from above, relative to the floor: the camera sees walls at the floor's edge from the
/// side.
const MARGIN: f64 = 1.15;

/// Camera of a picture.
pub enum ShotCamera {
    /// The camera of this robot.
    Robot(u32),
    /// A free camera: pose and lens.
    Point((Pose3, Lens)),
    /// A free camera straight above the middle of the floor, so high that it sees all of it.
    Above,
}

/// Content of a picture's pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Colour.
    Colour {
        /// Samples along each side of a pixel; `None` for the camera's default.
        samples: Option<u32>,
    },
    /// Distance.
    Depth,
    /// Label of the visible object.
    Labels,
}

/// A picture to be taken.
pub struct Shot<'a> {
    /// Camera of the picture.
    pub camera: &'a ShotCamera,
    /// Time of the picture; `None` for the run's end.
    pub at: Option<Time>,
    /// Width and height in pixels; `None` for the camera's default.
    pub size: Option<[u32; 2]>,
    /// Content of its pixels.
    pub content: Content,
}

/// A picture that has been taken.
pub struct ShotPicture {
    /// Contents of the PNG file.
    pub file: Vec<u8>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Time of the picture; differs from the requested time if the run ended earlier or the stored motion of the world
    /// begins later.
    pub time: Time,
}

impl ShotCamera {
    /// A camera at `from` that looks at `to`, with a horizontal field of view of `fov` rad or else the default lens.
    ///
    /// # Errors
    /// If the two points are equal.
    pub fn looking(from: DVec3, to: DVec3, fov: Option<f64>) -> anyhow::Result<Self> {
        let pose =
            View::look_at(from, to).context("--from and --to are one point: expected two, which give a direction")?;
        Ok(Self::Point((pose, fov.map_or(DEFAULT_LENS, |fov| Lens::Pinhole { fov }))))
    }
}

/// Pose of a camera with the default lens that looks straight down on a whole floor and a margin around it; y points to
/// the top of the picture. The size of the floor is in metres, that of the picture in pixels.
fn pose_above(floor: DVec2, [width, height]: [u32; 2]) -> anyhow::Result<Pose3> {
    // Length of the floor, in metres, that a pixel must cover at least.
    let metres_per_pixel = (floor.x / f64::from(width)).max(floor.y / f64::from(height)) * MARGIN;
    let height_above = 0.5 * f64::from(width) * metres_per_pixel / math::tan(0.5 * DEFAULT_FIELD_OF_VIEW);
    let middle = (0.5 * floor).extend(0.0);
    View::look_at(middle + height_above * DVec3::Z, middle)
        .context("the floor has no size: `--from` and `--to` say what is shown")
}

impl Shot<'_> {
    /// Takes the picture of a finished run.
    ///
    /// # Errors
    /// If the robot or its camera does not exist, or the view is invalid.
    pub fn take(&self, finished_run: &FinishedRun) -> anyhow::Result<ShotPicture> {
        let run = &finished_run.finished.ended.run;
        let world = run.world();
        // Nothing moves after the end. Motion before the end is kept for `HISTORY`.
        let time = self
            .at
            .unwrap_or(finished_run.finished.ended.time)
            .min(finished_run.finished.ended.time)
            .max(world.slot_start() - HISTORY);
        let (view, viewer) = match self.camera {
            ShotCamera::Robot(number) => {
                let id = RobotId::from_index(index_of(&finished_run.finished.scene, *number).context("--robot")?);
                let view = run.robot(id).camera_view(time, self.size).map_err(ImageUnavailable::from);
                (view.with_context(|| format!("--robot {number}"))?, Some(id))
            }
            ShotCamera::Point((pose, lens)) => (View::new(*pose, *lens, self.size.unwrap_or(SIZE))?, None),
            ShotCamera::Above => {
                let size = self.size.unwrap_or(SIZE);
                let floor = finished_run.finished.scene.world.floor;
                (View::new(pose_above(floor, size)?, DEFAULT_LENS, size)?, None)
            }
        };
        let scenery = finished_run.finished.scenery.get();
        let posed_scenery = scenery.pose_at(&world, time);
        let mut renderer = Camera::default();
        let size = view.size();
        let file = match self.content {
            Content::Colour { samples } => {
                let default_samples = viewer.map_or(SAMPLES, |id| run.robot(id).camera_samples());
                let mut picture = renderer.colour(&posed_scenery, &view, viewer, samples.unwrap_or(default_samples));
                if let Some(id) = viewer {
                    let camera = &run.robot(id).devices.camera;
                    camera.develop(camera.number_at(time), &mut picture);
                }
                Pixels::Colour(picture.pixels().as_flattened()).png(size)
            }
            Content::Depth => {
                Pixels::Depth(&camera::mm_of_depth(&renderer.depth(&posed_scenery, &view, viewer))).png(size)
            }
            Content::Labels => {
                let labels = renderer.labels(&posed_scenery, &view, viewer);
                let entity_numbers = sim_host::robios::ground_truth::EntityNumbers::of(&finished_run.finished.scene);
                Pixels::Labels(&camera::numbers_of_labels(&labels, &entity_numbers)).png(size)
            }
        };
        Ok(ShotPicture { file, size, time })
    }
}
