//! Images of robots' cameras as files, for `eyesim run --frames` and `eyesim shot`; images, scans and layers for
//! recordings.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::RobotId;
use sim_core::pose::Pose3;
use sim_core::time::Time;

use super::layer::Layer;
use super::png;
use super::report::write_atomically;
use super::sink::{RecordError, Sink};
use sim_core::record::{Digest, KindSet, Record};

/// Image taken by a program.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Number of the image among those of its camera, from 1.
    pub number: u64,
    /// Time of the exposure.
    pub exposed: Time,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Pixels, row by row from the top.
    pub pixels: Pixels<'a>,
}

/// The pixels of an image.
#[derive(Clone, Copy, Debug)]
pub enum Pixels<'a> {
    /// Red, green and blue of each pixel.
    Colour(&'a [u8]),
    /// Grey level of each pixel.
    Grey(&'a [u8]),
    /// Level of each pixel, through the camera's colour filter.
    Bayer(&'a [u8]),
    /// Distance of the surface in each pixel, mm; infinite for the sky.
    Depth(&'a [f32]),
    /// Label of each pixel: the number of a body, or of sky, floor or wall.
    Labels(&'a [i32]),
}

impl Pixels<'_> {
    /// Name of the format in the trace.
    pub fn form(&self) -> &'static str {
        match self {
            Self::Colour(_) => "colour",
            Self::Grey(_) => "grey",
            Self::Bayer(_) => "bayer",
            Self::Depth(_) => "depth",
            Self::Labels(_) => "labels",
        }
    }

    /// Bytes of the pixels as a program receives them; numbers of several bytes are little endian.
    pub fn bytes(&self) -> Cow<'_, [u8]> {
        match self {
            Self::Colour(bytes) | Self::Grey(bytes) | Self::Bayer(bytes) => Cow::Borrowed(bytes),
            Self::Depth(numbers) => numbers.iter().flat_map(|number| number.to_le_bytes()).collect(),
            Self::Labels(numbers) => numbers.iter().flat_map(|number| number.to_le_bytes()).collect(),
        }
    }

    /// Encodes the image as PNG. Colours and greys have 8 bits. Depths have 16 bits, in mm; 0 is the sky, and 65535 is
    /// this distance or a larger one. Labels are stored as their numbers, with a palette if none exceeds 255, otherwise
    /// with 16 bits.
    pub fn png(&self, size: [u32; 2]) -> Vec<u8> {
        match self {
            Self::Colour(bytes) => png::colour(size, bytes),
            Self::Grey(bytes) | Self::Bayer(bytes) => png::grey(size, bytes),
            Self::Depth(numbers) => {
                // A conversion to an integer saturates.
                let mm = |mm: &f32| if mm.is_finite() { mm.round() as u16 } else { 0 };
                png::grey16(size, &numbers.iter().map(mm).collect::<Vec<_>>())
            }
            Self::Labels(numbers) => png::labels(size, numbers),
        }
    }
}

/// Scan taken by a program.
#[derive(Clone, Debug)]
pub struct StoredScan {
    /// Pose of the scanner.
    pub world_from_scanner: Pose3,
    /// Bearings of the first and the last ray, counter-clockwise from the scanner's forward direction in its plane,
    /// rad; the rays between are evenly spaced.
    pub bearings: [f64; 2],
    /// Distance measured by each ray, m; none if nothing is within range.
    pub metres: Vec<Option<f64>>,
}

/// Image encoded as PNG.
#[derive(Clone, Debug)]
pub struct StoredFrame {
    /// Number of the image among those of its camera.
    pub number: u64,
    /// Name of the format in the trace.
    pub form: &'static str,
    /// The PNG file.
    pub png: Vec<u8>,
}

/// Image, scan or layer of a program. The trace contains only a summary of an image or scan, and no layers.
#[derive(Clone, Debug)]
pub enum StoredCapture {
    /// An image.
    Frame(StoredFrame),
    /// A scan.
    Scan(StoredScan),
    /// The robot's layer of this name.
    Layer(String, Arc<Layer>),
}

/// Destination of all images, scans and layers of programs. Images are written to a folder when they are taken. For a
/// recording, images, scans and layers are stored in memory until the recording takes them at the slot's end.
#[derive(Debug, Default)]
pub struct Frames {
    folder: Option<Folder>,
    /// Images, scans and layers of this slot, with time and robot.
    captures: Option<Mutex<Vec<(Time, RobotId, StoredCapture)>>>,
    /// The first image in order of (time, robot) that could not be written.
    failure: Mutex<Option<Failure>>,
}

#[derive(Debug)]
struct Folder {
    path: PathBuf,
    /// Number of digits of the largest robot number.
    robot_digits: usize,
}

#[derive(Debug)]
struct Failure {
    image: (Time, RobotId),
    error: RecordError,
}

/// Error for a folder that cannot take the images.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// The folder is not empty.
    #[error("the folder is not empty: images of two runs would mix")]
    NotEmpty,
    /// The path is a file.
    #[error("this is a file: expected a folder for the images, which may be new")]
    File,
    /// The folder cannot be created or read.
    #[error(transparent)]
    Unusable(#[from] std::io::Error),
}

impl Frames {
    /// Opens `folder` for the images of `robots` robots; creates it if it does not exist.
    ///
    /// # Errors
    /// [`FolderError`] if it is not empty or not a folder.
    pub fn create(folder: &Path, robots: usize) -> Result<Self, FolderError> {
        if folder.exists() && !folder.is_dir() {
            return Err(FolderError::File);
        }
        std::fs::create_dir_all(folder)?;
        if std::fs::read_dir(folder)?.next().is_some() {
            return Err(FolderError::NotEmpty);
        }
        let folder = Folder { path: folder.to_owned(), robot_digits: robots.to_string().len() };
        Ok(Self { folder: Some(folder), ..Self::default() })
    }

    /// Also stores images, scans and layers in memory, for [`Self::take`].
    pub fn storing(self) -> Self {
        Self { captures: Some(Mutex::default()), ..self }
    }

    /// Removes and returns the images, scans and layers stored since the last call, in order of (time, robot).
    pub fn take(&self) -> Vec<(Time, RobotId, StoredCapture)> {
        let mut captures =
            self.captures.as_ref().map(|captures| std::mem::take(&mut *captures.lock())).unwrap_or_default();
        // The sort is stable: captures of one robot at one time keep their order.
        captures.sort_by_key(|(time, robot, _)| (*time, *robot));
        captures
    }

    /// Stores a scan that `robot` takes at `now`, if scans are stored.
    pub fn store_scan(&self, robot: RobotId, now: Time, scan: impl FnOnce() -> StoredScan) {
        if let Some(captures) = &self.captures {
            captures.lock().push((now, robot, StoredCapture::Scan(scan())));
        }
    }

    /// Stores a layer that `robot` shows; it replaces an earlier layer of the same name in this slot.
    pub fn store_layer(&self, robot: RobotId, name: &str, layer: Arc<Layer>) {
        let Some(captures) = &self.captures else { return };
        let mut captures = captures.lock();
        let is_earlier = |(_, shown_by, capture): &(Time, RobotId, StoredCapture)| {
            *shown_by == robot && matches!(capture, StoredCapture::Layer(of, _) if of == name)
        };
        captures.retain(|capture| !is_earlier(capture));
        captures.push((layer.at, robot, StoredCapture::Layer(name.to_owned(), layer)));
    }

    /// Writes and stores an image that `robot` takes. After an image that could not be written (see [`FrameFailures`]),
    /// images that are later in order of (time, robot) are not written. Earlier ones are, so that the first failure
    /// does not depend on threads.
    pub fn write(&self, robot: RobotId, frame: &Frame<'_>) {
        let png = frame.pixels.png(frame.size);
        if let Some(folder) = &self.folder {
            self.write_into(folder, robot, frame, &png);
        }
        if let Some(captures) = &self.captures {
            let image = StoredFrame { number: frame.number, form: frame.pixels.form(), png };
            captures.lock().push((frame.exposed, robot, StoredCapture::Frame(image)));
        }
    }

    fn write_into(&self, folder: &Folder, robot: RobotId, frame: &Frame<'_>, png: &[u8]) {
        let image = (frame.exposed, robot);
        let is_first = |failure: &Option<Failure>| failure.as_ref().is_none_or(|failure| image < failure.image);
        if !is_first(&self.failure.lock()) {
            return;
        }
        let path = folder.path.join(folder.name(robot, frame));
        if let Err(error) = write_atomically(&path, png) {
            let mut failure = self.failure.lock();
            if is_first(&failure) {
                *failure = Some(Failure { image, error: RecordError::write("image", &path, error) });
            }
        }
    }
}

impl Folder {
    /// Name of an image's file; names sort by robot, number and time of exposure.
    fn name(&self, robot: RobotId, frame: &Frame<'_>) -> String {
        let Time(us) = frame.exposed;
        let (seconds, us) = (us / 1_000_000, us % 1_000_000);
        let suffix = match frame.pixels {
            Pixels::Depth(_) | Pixels::Labels(_) => format!("-{}", frame.pixels.form()),
            _ => String::new(),
        };
        let digits = self.robot_digits;
        format!("r{:0digits$}-{:06}-{seconds:05}.{us:06}{suffix}.png", robot.0, frame.number)
    }
}

/// Sink that ends the run if an image could not be written.
#[derive(Debug)]
pub struct FrameFailures(pub std::sync::Arc<Frames>);

impl Sink for FrameFailures {
    fn interest(&self) -> KindSet {
        KindSet::NONE
    }

    fn record(&mut self, _: &Record<'_>) -> Result<(), RecordError> {
        Ok(())
    }

    fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
        self.0.failure.lock().take().map_or(Ok(()), |failure| Err(failure.error))
    }
}
