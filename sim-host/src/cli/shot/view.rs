//! Picture of a robot's camera, or of a free camera, at the end of a run.

use anyhow::Context;
use glam::{DVec2, DVec3};
use sim_core::RobotId;
use sim_core::camera::{Camera, Lens, View};
use sim_core::drive::HISTORY;
use sim_core::math;
use sim_core::pose::Pose3;
use sim_core::spec::{DEFAULT_FIELD_OF_VIEW, DEFAULT_LENS, MAX_FIELD_OF_VIEW_DEG};
use sim_core::time::Time;

use crate::cli::run::FinishedRun;
use crate::launch::settings::index_of;
use crate::record::frame::Pixels;
use crate::robios::camera::{self, ImageUnavailable};

/// Maximum width and height of a picture in pixels.
pub const MAX_SIDE: u32 = 4096;

/// Maximum field of view of a picture, in degrees.
pub const MAX_FOV_DEG: f64 = MAX_FIELD_OF_VIEW_DEG;

/// Default size of a picture of a free camera.
const SIZE: [u32; 2] = [640, 480];

/// Default number of samples of a free camera along each side of a pixel.
const SAMPLES: u32 = 4;

/// Ratio of the area's size that a picture from above shows to the floor's: walls at the floor's edge are seen from the
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
    /// Its camera.
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
    /// A camera at `from` that looks at `to`, with a horizontal field of view of `fov` rad.
    ///
    /// # Errors
    /// If the two points are equal.
    pub fn looking(from: DVec3, to: DVec3, fov: Option<f64>) -> anyhow::Result<Self> {
        let pose =
            View::look_at(from, to).context("--from and --to are one point: expected two, which give a direction")?;
        Ok(Self::Point((pose, fov.map_or(DEFAULT_LENS, |fov| Lens::Pinhole { fov }))))
    }
}

/// Pose of a camera with the default lens that looks straight down on the whole of a floor with a margin, its y to the
/// top; the floor's size is in metres, the picture's in pixels.
fn above(floor: DVec2, [width, height]: [u32; 2]) -> anyhow::Result<Pose3> {
    // Metres of the floor that a pixel covers, at least.
    let metres = (floor.x / f64::from(width)).max(floor.y / f64::from(height)) * MARGIN;
    let up = 0.5 * f64::from(width) * metres / math::tan(0.5 * DEFAULT_FIELD_OF_VIEW);
    let middle = (0.5 * floor).extend(0.0);
    View::look_at(middle + up * DVec3::Z, middle)
        .context("the floor has no size: `--from` and `--to` say what is shown")
}

impl Shot<'_> {
    /// Takes the picture of a finished run.
    ///
    /// # Errors
    /// If the robot or its camera does not exist, or the view is invalid.
    pub fn take(&self, ran: &FinishedRun) -> anyhow::Result<ShotPicture> {
        let run = &ran.finished.ended.run;
        let world = run.world();
        // Nothing moves after the end. Motion before the end is kept for `HISTORY`.
        let time =
            self.at.unwrap_or(ran.finished.ended.time).min(ran.finished.ended.time).max(world.slot_start() - HISTORY);
        let (view, by) = match self.camera {
            ShotCamera::Robot(number) => {
                let id = RobotId::from_index(index_of(&ran.finished.scene, *number).context("--robot")?);
                let view = run.robot(id).camera_view(time, self.size).map_err(ImageUnavailable::from);
                (view.with_context(|| format!("--robot {number}"))?, Some(id))
            }
            ShotCamera::Point((pose, lens)) => (View::new(*pose, *lens, self.size.unwrap_or(SIZE))?, None),
            ShotCamera::Above => {
                let size = self.size.unwrap_or(SIZE);
                let floor = ran.finished.scene.world.floor;
                (View::new(above(floor, size)?, DEFAULT_LENS, size)?, None)
            }
        };
        let scenery = ran.finished.scenery.get();
        let posed = scenery.pose_at(&world, time);
        let mut renderer = Camera::default();
        let size = view.size();
        let file = match self.content {
            Content::Colour { samples } => {
                let own = by.map_or(SAMPLES, |id| run.robot(id).camera_samples());
                let mut picture = renderer.colour(&posed, &view, by, samples.unwrap_or(own));
                if let Some(id) = by {
                    let camera = &run.robot(id).devices.camera;
                    camera.develop(camera.number_at(time), &mut picture);
                }
                Pixels::Colour(picture.pixels().as_flattened()).png(size)
            }
            Content::Depth => Pixels::Depth(&camera::mm_of_depth(&renderer.depth(&posed, &view, by))).png(size),
            Content::Labels => {
                let labels = renderer.labels(&posed, &view, by);
                let entity_numbers = crate::robios::ground_truth::EntityNumbers::of(&ran.finished.scene);
                Pixels::Labels(&camera::numbers_of_labels(&labels, &entity_numbers)).png(size)
            }
        };
        Ok(ShotPicture { file, size, time })
    }
}
