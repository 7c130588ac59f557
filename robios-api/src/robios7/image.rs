//! Image files and filters of RoBIOS-7.

use robios_sys::{ByteBuffer, ByteSlice};

use super::Robot;
use crate::device::Device;
use crate::error::checked;
use crate::image::{ColorImage, GrayImage, ImageSize};
use crate::robot::robios7;
use crate::{Error, Result};

/// Image files and filters; each call costs virtual time like every call of RoBIOS.
#[derive(Clone, Copy, Debug)]
pub struct Images<'r>(pub(super) &'r Robot);

/// Image of a file.
enum Picture {
    Gray(GrayImage),
    Color(ColorImage),
}

impl Images<'_> {
    /// Reads a PNM file as a colour image of this size, cropped or padded with black. A grey file is converted.
    ///
    /// # Errors
    /// [`Error::Refused`] if the file cannot be read.
    #[track_caller]
    pub fn read_color(&self, path: &str, size: ImageSize) -> Result<ColorImage> {
        match self.read(path, size)? {
            Picture::Gray(image) => Ok(self.to_color(&image)),
            Picture::Color(image) => Ok(image),
        }
    }

    /// Reads a PNM file as a grey image of this size, cropped or padded with black. A colour file is converted.
    ///
    /// # Errors
    /// [`Error::Refused`] if the file cannot be read.
    #[track_caller]
    pub fn read_gray(&self, path: &str, size: ImageSize) -> Result<GrayImage> {
        match self.read(path, size)? {
            Picture::Gray(image) => Ok(image),
            Picture::Color(image) => Ok(self.to_gray(&image)),
        }
    }

    #[track_caller]
    fn read(&self, path: &str, size: ImageSize) -> Result<Picture> {
        let mut bytes = vec![0; 3 * size.pixels()];
        let (columns, rows) = size.to_robios7();
        // The digit of the formats P1 to P6.
        match robios7!(self.0, IPReadFile(ByteSlice::from(path), columns, rows, ByteBuffer::from(&mut bytes[..]))) {
            3 | 6 => Ok(Picture::Color(ColorImage { size, bytes })),
            1 | 2 | 4 | 5 => {
                bytes.truncate(size.pixels());
                Ok(Picture::Gray(GrayImage { size, bytes }))
            }
            code => Err(Error::Refused { call: "IPReadFile", device: Device::Image, code }),
        }
    }

    /// Writes a colour image as PPM.
    ///
    /// # Errors
    /// [`Error::Refused`] if the file cannot be written.
    #[track_caller]
    pub fn write_color(&self, path: &str, image: &ColorImage) -> Result {
        let (columns, rows) = image.size.to_robios7();
        let bytes = ByteSlice::from(image.bytes());
        checked(
            "IPWriteFile",
            Device::Image,
            robios7!(self.0, IPWriteFile(ByteSlice::from(path), columns, rows, bytes)),
        )
    }

    /// Writes a grey image as PGM.
    ///
    /// # Errors
    /// [`Error::Refused`] if the file cannot be written.
    #[track_caller]
    pub fn write_gray(&self, path: &str, image: &GrayImage) -> Result {
        let (columns, rows) = image.size.to_robios7();
        let bytes = ByteSlice::from(image.bytes());
        let code = robios7!(self.0, IPWriteFileGray(ByteSlice::from(path), columns, rows, bytes));
        checked("IPWriteFileGray", Device::Image, code)
    }

    /// Laplace edge filter.
    #[track_caller]
    pub fn laplace(&self, image: &GrayImage) -> GrayImage {
        let mut edges = GrayImage::new(image.size);
        let (columns, rows) = image.size.to_robios7();
        let (from, to) = (ByteSlice::from(image.bytes()), ByteBuffer::from(&mut edges.bytes[..]));
        let () = robios7!(self.0, IPLaplace(columns, rows, from, to));
        edges
    }

    /// Sobel edge filter.
    #[track_caller]
    pub fn sobel(&self, image: &GrayImage) -> GrayImage {
        let mut edges = GrayImage::new(image.size);
        let (columns, rows) = image.size.to_robios7();
        let (from, to) = (ByteSlice::from(image.bytes()), ByteBuffer::from(&mut edges.bytes[..]));
        let () = robios7!(self.0, IPSobel(columns, rows, from, to));
        edges
    }

    /// Converts a colour image to a grey image.
    #[track_caller]
    pub fn to_gray(&self, image: &ColorImage) -> GrayImage {
        let mut gray = GrayImage::new(image.size);
        let (from, to) = (ByteSlice::from(image.bytes()), ByteBuffer::from(&mut gray.bytes[..]));
        let () = robios7!(self.0, IPCol2Gray(from, to));
        gray
    }

    /// Converts a grey image to a colour image.
    #[track_caller]
    pub fn to_color(&self, image: &GrayImage) -> ColorImage {
        let mut color = ColorImage::new(image.size);
        let (from, to) = (ByteSlice::from(image.bytes()), ByteBuffer::from(&mut color.bytes[..]));
        let () = robios7!(self.0, IPGray2Col(from, to));
        color
    }

    /// Hue, saturation and intensity of a colour image, as one image each.
    #[track_caller]
    pub fn to_hsi(&self, image: &ColorImage) -> [GrayImage; 3] {
        let mut parts = [(); 3].map(|()| GrayImage::new(image.size));
        let [hue, saturation, intensity] = parts.each_mut().map(|part| ByteBuffer::from(&mut part.bytes[..]));
        let () = robios7!(self.0, IPCol2HSI(ByteSlice::from(image.bytes()), hue, saturation, intensity));
        parts
    }

    /// Lays `above` over `below` where `above` is not black.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if their sizes differ.
    #[track_caller]
    pub fn overlay(&self, below: &ColorImage, above: &ColorImage) -> Result<ColorImage> {
        if below.size != above.size {
            return Err(Error::OutOfRange {
                what: "image to lay over another",
                value: format!("{}x{}", above.size.columns(), above.size.rows()),
                accepted: "one of the same size",
            });
        }
        let mut overlaid = ColorImage::new(below.size);
        let (lower, upper) = (ByteSlice::from(below.bytes()), ByteSlice::from(above.bytes()));
        let () = robios7!(self.0, IPOverlay(lower, upper, ByteBuffer::from(&mut overlaid.bytes[..])));
        Ok(overlaid)
    }
}
