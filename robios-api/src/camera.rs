//! The camera of RoBIOS 6: images of 80 x 60 pixels.

use std::sync::MutexGuard;

use robios_sys::ByteBuffer;
use robios_sys::robios6::{
    AUTOBRIGHTNESS, FPS0_9375, FPS0_46875, FPS1_875, FPS3_75, FPS7_5, FPS15, FPS30, FPS60, INITERROR, NOAUTOBRIGHTNESS,
    NORMAL, TELE, WIDE,
};

use crate::device::Device;
use crate::error::checked;
use crate::image::{ColorImage, DepthImage, GrayImage, ImageSize, LabelImage};
use crate::robot::{locked, release, robios};
use crate::{Error, Result, Robot};

/// The camera; dropping the value switches it off.
///
/// An image shows the scene 1/60 s before the end of the call that takes it. Row 0 is at the top. Images lack the
/// border of one pixel that `CAMGetFrame` of RoBIOS adds.
#[derive(Debug)]
pub struct Camera {
    robot: Robot,
}

/// Angle of view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CameraLens {
    /// Angle of view of the robi file.
    #[default]
    Normal,
    /// Wide angle: objects appear half as large.
    Wide,
    /// Telephoto: objects appear twice as large.
    Tele,
}

/// Frame rate, in images per second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameRate {
    /// 60.
    Fps60,
    /// 30.
    Fps30,
    /// 15.
    Fps15,
    /// 7.5.
    Fps7_5,
    /// 3.75.
    Fps3_75,
    /// 1.875.
    Fps1_875,
    /// 0.9375.
    Fps0_9375,
    /// 0.46875.
    Fps0_46875,
}

/// Adjustment of image levels: 128 leaves a level unchanged, lower values reduce it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Levels {
    /// Brightness.
    pub brightness: u8,
    /// Hue of colour images. For grey images 128 plus the offset that is added to the grey levels.
    pub hue_or_offset: u8,
    /// Saturation of colour images; contrast of grey images.
    pub saturation_or_contrast: u8,
}

impl Default for Levels {
    fn default() -> Self {
        Self { brightness: 128, hue_or_offset: 128, saturation_or_contrast: 128 }
    }
}

impl FrameRate {
    const fn number(self) -> i32 {
        match self {
            Self::Fps60 => FPS60,
            Self::Fps30 => FPS30,
            Self::Fps15 => FPS15,
            Self::Fps7_5 => FPS7_5,
            Self::Fps3_75 => FPS3_75,
            Self::Fps1_875 => FPS1_875,
            Self::Fps0_9375 => FPS0_9375,
            Self::Fps0_46875 => FPS0_46875,
        }
    }
}

impl Robot {
    /// Switches the camera on.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has none.
    #[track_caller]
    pub fn camera(&self, lens: CameraLens) -> Result<Camera> {
        let mode = match lens {
            CameraLens::Normal => NORMAL,
            CameraLens::Wide => WIDE,
            CameraLens::Tele => TELE,
        };
        let version: i32 = robios!(self, CAMInit(mode));
        if version >= INITERROR { Err(Error::Unavailable(Device::Camera)) } else { Ok(Camera { robot: self.clone() }) }
    }
}

#[allow(clippy::missing_errors_doc, reason = "the first method that can fail documents the errors of all")]
impl Camera {
    /// Size of images.
    pub const SIZE: ImageSize = ImageSize::EYECAM;

    /// Size of images with the colour filter.
    pub const BAYER_SIZE: ImageSize = ImageSize::QQVGA;

    /// Takes a grey image and waits for it.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no image; the same applies to the functions below.
    #[track_caller]
    pub fn gray(&self) -> Result<GrayImage> {
        let mut frame = [0; 4800];
        checked("CAMGetFrameMono", Device::Camera, robios!(&self.robot, CAMGetFrameMono(&mut frame)))?;
        *self.last_size() = Self::SIZE;
        Ok(GrayImage { size: Self::SIZE, bytes: frame.to_vec() })
    }

    /// Takes a colour image and waits for it.
    #[track_caller]
    pub fn color(&self) -> Result<ColorImage> {
        let mut frame = [0; 14400];
        checked("CAMGetFrameColor", Device::Camera, robios!(&self.robot, CAMGetFrameColor(&mut frame)))?;
        *self.last_size() = Self::SIZE;
        Ok(ColorImage { size: Self::SIZE, bytes: frame.to_vec() })
    }

    /// Takes a Bayer image of 160 x 120 pixels and waits for it. Rows of green and blue alternate with rows of red and
    /// green.
    #[track_caller]
    pub fn bayer(&self) -> Result<GrayImage> {
        let mut frame = [0; 19200];
        checked("CAMGetFrameBayer", Device::Camera, robios!(&self.robot, CAMGetFrameBayer(&mut frame)))?;
        *self.last_size() = Self::BAYER_SIZE;
        Ok(GrayImage { size: Self::BAYER_SIZE, bytes: frame.to_vec() })
    }

    /// Sets the frame rate; calls then wait for the next image.
    #[track_caller]
    pub fn set_frame_rate(&self, rate: FrameRate) -> Result {
        checked("CAMSet", Device::Camera, robios!(&self.robot, CAMSet(rate.number(), 0, 0)))
    }

    /// Sets the adjustment of image levels.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if the brightness is at most 7 and the other values are 0: RoBIOS takes such values as a
    /// frame rate.
    #[track_caller]
    pub fn set_levels(&self, levels: Levels) -> Result {
        let Levels { brightness, hue_or_offset, saturation_or_contrast } = levels;
        if let (0..=7, 0, 0) = (brightness, hue_or_offset, saturation_or_contrast) {
            return Err(Error::OutOfRange {
                what: "setting of the camera",
                value: format!("{brightness}, 0, 0"),
                accepted: "a brightness above 7, or another value that is not 0",
            });
        }
        let numbers = [brightness, hue_or_offset, saturation_or_contrast].map(i32::from);
        checked("CAMSet", Device::Camera, robios!(&self.robot, CAMSet(numbers[0], numbers[1], numbers[2])))
    }

    /// Current levels, including automatic brightness. If the last setting was a frame rate, these are its three
    /// parameters.
    #[track_caller]
    pub fn levels(&self) -> Result<Levels> {
        let mut numbers = [0; 3];
        let [p1, p2, p3] = &mut numbers;
        checked("CAMGet", Device::Camera, robios!(&self.robot, CAMGet(p1, p2, p3)))?;
        let [brightness, hue_or_offset, saturation_or_contrast] = numbers.map(|number| number.clamp(0, 255) as u8);
        Ok(Levels { brightness, hue_or_offset, saturation_or_contrast })
    }

    /// Switches automatic brightness on or off.
    #[track_caller]
    pub fn set_auto_brightness(&self, is_automatic: bool) -> Result {
        let mode = if is_automatic { AUTOBRIGHTNESS } else { NOAUTOBRIGHTNESS };
        checked("CAMMode", Device::Camera, robios!(&self.robot, CAMMode(mode)))
    }

    /// Size of the robot's last image, of any camera value.
    fn last_size(&self) -> MutexGuard<'_, ImageSize> {
        locked(&self.robot.0.common.image_size)
    }

    /// Depths of the last image, without noise. An extension of this simulator.
    #[track_caller]
    pub fn depth(&self) -> Result<DepthImage> {
        let size = *self.last_size();
        let mut mm = vec![f32::INFINITY; size.pixels()];
        let buffer = ByteBuffer { data: mm.as_mut_ptr().cast(), len: mm.len() };
        checked("CAMGetDepth", Device::Camera, robios!(&self.robot, CAMGetDepth(buffer)))?;
        Ok(DepthImage { size, mm })
    }

    /// Labels of the last image. An extension of this simulator.
    #[track_caller]
    pub fn labels(&self) -> Result<LabelImage> {
        let size = *self.last_size();
        let mut numbers = vec![0; size.pixels()];
        let buffer = ByteBuffer { data: numbers.as_mut_ptr().cast(), len: numbers.len() };
        checked("CAMGetLabels", Device::Camera, robios!(&self.robot, CAMGetLabels(buffer)))?;
        Ok(LabelImage { size, numbers })
    }
}

impl Drop for Camera {
    fn drop(&mut self) {
        release!(&self.robot, CAMRelease());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fake::{Fake, Moment};
    use crate::image::Seen;
    use crate::robios7::Color;
    use crate::{Length, Pixel};

    fn fake() -> Fake {
        let camera = |_: &Moment, pixel: Pixel| Color { red: pixel.x as u8, green: pixel.y as u8, blue: 30 };
        Fake::new().camera(camera).depth(|_, _| Some(Length::metres(1.5))).labels(|_, _| Seen::Floor)
    }

    #[test]
    fn images_are_80_by_60() {
        fake()
            .run(|robot| {
                let camera = robot.camera(CameraLens::Wide)?;
                let (color, gray, bayer) = (camera.color()?, camera.gray()?, camera.bayer()?);
                assert_eq!(color.pixel(Pixel { x: 79, y: 59 }), Some(Color { red: 79, green: 59, blue: 30 }));
                assert_eq!(gray.pixel(Pixel { x: 3, y: 6 }), Some(13), "the mean");
                let filtered =
                    [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| bayer.pixel(Pixel { x: 100 + x, y: 50 + y }));
                // First row green and blue, second row red and green.
                assert_eq!(filtered, [Some(50), Some(30), Some(100), Some(51)]);
                let at = Pixel { x: 159, y: 119 };
                assert_eq!(camera.depth()?.distance(at), Some(Length::metres(1.5)), "of the Bayer image");
                assert_eq!(camera.labels()?.seen(at), Some(Seen::Floor));
                camera.gray()?;
                assert_eq!((camera.depth()?.size(), camera.labels()?.size()), (Camera::SIZE, Camera::SIZE));
                Ok::<_, Error>(())
            })
            .expect_finished();
    }

    #[test]
    fn settings_are_passed_to_robios() {
        let run = fake().run(|robot| {
            let camera = robot.camera(CameraLens::default())?;
            let levels = Levels { brightness: 100, ..Levels::default() };
            camera.set_levels(levels)?;
            assert_eq!(camera.levels()?, levels);
            camera.set_frame_rate(FrameRate::Fps7_5)?;
            camera.set_auto_brightness(true)?;
            let black = Levels { brightness: 3, hue_or_offset: 0, saturation_or_contrast: 0 };
            assert!(matches!(camera.set_levels(black), Err(Error::OutOfRange { .. })));
            Ok::<_, Error>(())
        });
        let run = run.expect_finished();
        let calls: Vec<&str> =
            run.calls_of("CAMSet").chain(run.calls_of("CAMMode")).map(|call| call.text.as_str()).collect();
        assert_eq!(calls, ["CAMSet(100, 128, 128) = 0", "CAMSet(3, 0, 0) = 0", "CAMMode(1) = 0"]);
    }

    #[test]
    fn missing_camera_is_an_error() {
        let run = Fake::new().run(|robot| robot.camera(CameraLens::Normal).map(drop));
        assert!(run.expect_failed().contains("the robot has no camera"));
    }
}
