//! The camera: images of any size, with their depths and labels.

use robios_sys::ByteBuffer;
use robios_sys::robios7::{CUSTOM, RESOLUTIONS};

use super::Robot;
use crate::Result;
use crate::device::Device;
use crate::error::checked;
use crate::image::{ColorImage, DepthImage, GrayImage, ImageSize, LabelImage};
use crate::robot::{release, robios7};

/// The camera; dropping the value switches it off.
///
/// An image shows the scene 1/60 s before the end of the call that takes it. Row 0 is at the top.
#[derive(Debug)]
pub struct Camera<'r> {
    robot: &'r Robot,
    size: ImageSize,
}

impl Robot {
    /// Switches the camera on, with images of this size.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if the robot has no camera, or if RoBIOS does not support the size:
    /// each side must have 1 to 4096 pixels, and the image at most 2592 * 1944 pixels in total.
    #[track_caller]
    pub fn camera(&self, size: ImageSize) -> Result<Camera<'_>> {
        let (columns, rows) = size.to_robios7();
        let is_same = |x: usize, y: usize| (x, y) == (size.columns().into(), size.rows().into());
        let entry = RESOLUTIONS.iter().find(|(_, _, x, y)| is_same(*x, *y));
        let resolution = entry.map_or(CUSTOM, |(_, resolution, ..)| *resolution);
        checked("CAMInit", Device::Camera, robios7!(self, CAMInit(resolution, columns, rows)))?;
        Ok(Camera { robot: self, size })
    }
}

#[allow(clippy::missing_errors_doc, reason = "the first method that can fail documents the errors of all")]
impl Camera<'_> {
    /// Size of images.
    pub fn size(&self) -> ImageSize {
        self.size
    }

    /// Takes a colour image.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if there is no image; the same applies to all methods below.
    #[track_caller]
    pub fn color(&self) -> Result<ColorImage> {
        let mut image = ColorImage::new(self.size);
        self.color_into(&mut image)?;
        Ok(image)
    }

    /// Takes a colour image into an existing one, reusing its memory if it has the camera's size.
    #[track_caller]
    pub fn color_into(&self, image: &mut ColorImage) -> Result {
        if image.size != self.size {
            *image = ColorImage::new(self.size);
        }
        let buffer = ByteBuffer::from(&mut image.bytes[..]);
        checked("CAMGet", Device::Camera, robios7!(self.robot, CAMGet(buffer)))
    }

    /// Takes a grey image.
    #[track_caller]
    pub fn gray(&self) -> Result<GrayImage> {
        let mut image = GrayImage::new(self.size);
        self.gray_into(&mut image)?;
        Ok(image)
    }

    /// Takes a grey image into an existing one, reusing its memory if it has the camera's size.
    #[track_caller]
    pub fn gray_into(&self, image: &mut GrayImage) -> Result {
        if image.size != self.size {
            *image = GrayImage::new(self.size);
        }
        let buffer = ByteBuffer::from(&mut image.bytes[..]);
        checked("CAMGetGray", Device::Camera, robios7!(self.robot, CAMGetGray(buffer)))
    }

    /// Depths of the last image, without noise. An extension of this simulator.
    #[track_caller]
    pub fn depth(&self) -> Result<DepthImage> {
        let mut mm = vec![f32::INFINITY; self.size.pixels()];
        let buffer = ByteBuffer { data: mm.as_mut_ptr().cast(), len: mm.len() };
        checked("CAMGetDepth", Device::Camera, robios7!(self.robot, CAMGetDepth(buffer)))?;
        Ok(DepthImage { size: self.size, mm })
    }

    /// Labels of the last image. An extension of this simulator.
    #[track_caller]
    pub fn labels(&self) -> Result<LabelImage> {
        let mut numbers = vec![0; self.size.pixels()];
        let buffer = ByteBuffer { data: numbers.as_mut_ptr().cast(), len: numbers.len() };
        checked("CAMGetLabels", Device::Camera, robios7!(self.robot, CAMGetLabels(buffer)))?;
        Ok(LabelImage { size: self.size, numbers })
    }
}

impl Drop for Camera<'_> {
    fn drop(&mut self) {
        release!(&self.robot.0, robios7, CAMRelease());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fake::Fake;
    use crate::image::Seen;
    use crate::robios7::Color;
    use crate::{Error, Length, Pixel};

    /// Fake with a camera: red grows with time, depth shrinks from left to right, robot 2 fills the left column.
    fn fake() -> Fake {
        let camera = |now: &crate::fake::Moment, at: Pixel| Color {
            red: now.time.as_millis() as u8,
            green: at.x as u8,
            blue: at.y as u8,
        };
        let depth =
            |_: &crate::fake::Moment, at: Pixel| (at.x > 0).then(|| Length::millimetres(1000.0 - f64::from(at.x)));
        let labels = |_: &crate::fake::Moment, at: Pixel| if at.x == 0 { Seen::Body(2) } else { Seen::Wall };
        Fake::new().camera(camera).depth(depth).labels(labels)
    }

    #[test]
    fn images_have_the_requested_size() {
        let run = fake().run_robios7(|robot| {
            for size in [ImageSize::QQVGA, ImageSize::new(20, 10)] {
                let camera = robot.camera(size)?;
                let image = camera.color()?;
                assert_eq!((camera.size(), image.size(), image.bytes().len()), (size, size, 3 * size.pixels()));
                let pixel = image.pixel(Pixel { x: 7, y: 9 }).expect("a pixel");
                assert_eq!((pixel.green, pixel.blue), (7, 9));
                let gray = camera.gray()?;
                assert_eq!(gray.size(), size);
            }
            Ok::<_, Error>(())
        });
        let run = run.expect_finished();
        let calls: Vec<String> = run.calls_of("CAMInit").map(|call| call.text.clone()).collect();
        assert_eq!(calls, ["CAMInit(0, 160, 120) = 0", "CAMInit(10, 20, 10) = 0"]);
        assert_eq!(run.calls_of("CAMRelease").count(), 2);
    }

    #[test]
    fn existing_images_are_reused() {
        fake()
            .run_robios7(|robot| {
                let camera = robot.camera(ImageSize::new(4, 3))?;
                let (mut color, mut gray) = (ColorImage::new(ImageSize::VGA), GrayImage::new(ImageSize::new(4, 3)));
                camera.color_into(&mut color)?;
                camera.gray_into(&mut gray)?;
                assert_eq!(color.size(), ImageSize::new(4, 3));
                Ok::<_, Error>(())
            })
            .expect_finished();
    }

    #[test]
    fn depths_and_labels_belong_to_the_last_image() {
        fake()
            .run_robios7(|robot| {
                let camera = robot.camera(ImageSize::new(4, 2))?;
                assert!(matches!(camera.depth(), Err(Error::Refused { call: "CAMGetDepth", .. })));
                camera.gray()?;
                let depth = camera.depth()?;
                assert_eq!(depth.distance(Pixel { x: 0, y: 0 }), None);
                assert_eq!(depth.distance(Pixel { x: 3, y: 1 }), Some(Length::millimetres(997.0)));
                let bodies = camera.labels()?.pixels().filter(|(_, seen)| *seen == Seen::Body(2)).count();
                assert_eq!(bodies, 2);
                Ok::<_, Error>(())
            })
            .expect_finished();
    }

    #[test]
    fn missing_camera_is_an_error() {
        let run = Fake::new().run_robios7(|robot| robot.camera(ImageSize::QVGA).map(drop));
        let text = run.expect_failed().to_owned();
        assert!(text.contains("`CAMInit` was refused for the camera with 1"), "{text}");
    }
}
