//! The camera of a fake robot.

use robios_sys::robios7::{CAM5MP, CUSTOM};

use super::robot::{FakeRobot, State};
use super::{Fake, Moment};
use crate::image::Seen;
use crate::lcd::Pixel;
use crate::robios7::{Color, ImageSize};
use crate::unit::Length;

/// Script of a camera: a function that returns the value of a pixel at a moment.
type PixelScript<T> = Box<dyn Fn(&Moment, Pixel) -> T + Send>;

/// Scripts of the camera.
#[derive(Default)]
pub(super) struct CameraScripts {
    color: Option<PixelScript<Color>>,
    depth: Option<PixelScript<Option<Length>>>,
    labels: Option<PixelScript<Seen>>,
}

/// Settings of the camera while it is on.
#[derive(Clone, Copy)]
pub(super) struct CameraState {
    pub size: ImageSize,
    /// The parameters of the last `CAMSet`.
    pub parameters: [i32; 3],
    /// Time and size of the last image.
    taken: Option<(u64, ImageSize)>,
}

impl Fake {
    /// Adds a camera with the script of its colours; the program chooses the size of images.
    pub fn camera(mut self, color: impl Fn(&Moment, Pixel) -> Color + Send + 'static) -> Self {
        self.camera.color = Some(Box::new(color));
        self
    }

    /// Sets the script of depths; `None` is the sky.
    pub fn depth(mut self, depth: impl Fn(&Moment, Pixel) -> Option<Length> + Send + 'static) -> Self {
        self.camera.depth = Some(Box::new(depth));
        self
    }

    /// Sets the script of labels.
    pub fn labels(mut self, labels: impl Fn(&Moment, Pixel) -> Seen + Send + 'static) -> Self {
        self.camera.labels = Some(Box::new(labels));
        self
    }
}

impl FakeRobot {
    /// Switches the camera on; returns false if the robot has none.
    pub(super) fn switch_camera_on(&self, state: &mut State, size: ImageSize) -> bool {
        let has_camera = self.fake.camera.color.is_some();
        state.camera = has_camera.then_some(CameraState { size, parameters: [128; 3], taken: None });
        has_camera
    }

    /// Takes an image of `size`, by default of the camera's size: red, green and blue of each pixel; `None` if the
    /// camera is off.
    pub(super) fn colors(&self, state: &mut State, size: Option<ImageSize>) -> Option<Vec<u8>> {
        let (script, now_us) = (self.fake.camera.color.as_ref()?, state.now_us);
        let camera = state.camera.as_mut()?;
        let size = size.unwrap_or(camera.size);
        camera.taken = Some((now_us, size));
        let moment = state.moment(now_us);
        let rgb = |pixel| {
            let Color { red, green, blue } = script(&moment, pixel);
            [red, green, blue]
        };
        Some(size.places().flat_map(rgb).collect())
    }

    /// Takes a grey image: the mean of the colours.
    pub(super) fn grays(&self, state: &mut State) -> Option<Vec<u8>> {
        Some(gray_of_colors(&self.colors(state, None)?))
    }

    /// Depths of the last image, in millimetres.
    pub(super) fn depths(&self, state: &State) -> Option<Vec<f32>> {
        let (script, (taken_us, size)) = (self.fake.camera.depth.as_ref()?, state.camera?.taken?);
        let moment = state.moment(taken_us);
        let mm = |pixel| script(&moment, pixel).map_or(f32::INFINITY, |distance| distance.as_millimetres() as f32);
        Some(size.places().map(mm).collect())
    }

    /// Label numbers of the last image.
    pub(super) fn labels(&self, state: &State) -> Option<Vec<i32>> {
        let (script, (taken_us, size)) = (self.fake.camera.labels.as_ref()?, state.camera?.taken?);
        let moment = state.moment(taken_us);
        Some(size.places().map(|pixel| script(&moment, pixel).number()).collect())
    }
}

/// Mean of red, green and blue of each pixel.
pub(super) fn gray_of_colors(colors: &[u8]) -> Vec<u8> {
    let mean = |rgb: &[u8]| (rgb.iter().map(|level| u16::from(*level)).sum::<u16>() / 3) as u8;
    colors.chunks_exact(3).map(mean).collect()
}

/// Returns true for a resolution of RoBIOS-7.
pub(super) fn is_resolution(number: i32) -> bool {
    (0..=CAM5MP).contains(&number) || number == CUSTOM
}
