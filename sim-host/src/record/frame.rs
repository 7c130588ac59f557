//! Images of robots' cameras as files: what `eyesim run --frames` and `eyesim shot` write; images and scans for a recording.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use parking_lot::Mutex;
use sim_core::RobotId;
use sim_core::pose::Pose3;
use sim_core::time::Time;

use super::png;
use super::report::write_whole;
use super::sink::{RecordError, Sink};
use sim_core::record::{Digest, KindSet, Record};

/// An image that a program gets.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Its number among the images of its camera, from 1.
    pub number: u64,
    /// When it was exposed.
    pub exposed: Time,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Its pixels, row by row from the top.
    pub pixels: Pixels<'a>,
}

/// The pixels of an image.
#[derive(Clone, Copy, Debug)]
pub enum Pixels<'a> {
    /// Red, green and blue of each.
    Colour(&'a [u8]),
    /// A level of each.
    Grey(&'a [u8]),
    /// A level of each, behind the camera's colour filter.
    Bayer(&'a [u8]),
    /// The distance of what each shows, mm; infinite for the sky.
    Depth(&'a [f32]),
    /// The number of what each shows.
    Labels(&'a [i32]),
}

impl Pixels<'_> {
    /// What they are: the word of the trace.
    pub fn form(&self) -> &'static str {
        match self {
            Self::Colour(_) => "colour",
            Self::Grey(_) => "grey",
            Self::Bayer(_) => "bayer",
            Self::Depth(_) => "depth",
            Self::Labels(_) => "labels",
        }
    }

    /// Their bytes as a program gets them; numbers of more than one byte are little endian.
    pub fn bytes(&self) -> Cow<'_, [u8]> {
        match self {
            Self::Colour(bytes) | Self::Grey(bytes) | Self::Bayer(bytes) => Cow::Borrowed(bytes),
            Self::Depth(numbers) => numbers.iter().flat_map(|number| number.to_le_bytes()).collect(),
            Self::Labels(numbers) => numbers.iter().flat_map(|number| number.to_le_bytes()).collect(),
        }
    }

    /// The picture as a file of PNG: colours and greys with 8 bits; depths with 16, in mm, 0 for the sky, 65535 for that and
    /// all beyond; labels as they are, with colours to look at up to 255, above with 16 bits.
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

/// A scan that a program gets.
#[derive(Clone, Debug)]
pub struct KeptScan {
    /// Where the scanner is.
    pub world_from_scanner: Pose3,
    /// Where the first and the last ray look, counter-clockwise from ahead in the scanner's plane; those between evenly.
    pub bearings: [f64; 2],
    /// What each ray measures, m; none for nothing within range.
    pub metres: Vec<Option<f64>>,
}

/// An image as a file of PNG.
#[derive(Clone, Debug)]
pub struct KeptFrame {
    /// Its number among the images of its camera.
    pub number: u64,
    /// The word of the trace.
    pub form: &'static str,
    /// The file.
    pub png: Vec<u8>,
}

/// What a program got of which the trace has but a summary.
#[derive(Clone, Debug)]
pub enum Kept {
    /// An image.
    Frame(KeptFrame),
    /// A scan.
    Scan(KeptScan),
}

/// Where all images and scans go that programs take: images into a folder, each written when it is taken; both into memory,
/// for a recording that takes them at the slot's end.
#[derive(Debug, Default)]
pub struct Frames {
    folder: Option<Folder>,
    /// Of this slot, with its time.
    kept: Option<Mutex<Vec<(Time, RobotId, Kept)>>>,
    /// The first image in order of (time, robot) that could not be written.
    failure: Mutex<Option<Failure>>,
}

#[derive(Debug)]
struct Folder {
    path: PathBuf,
    /// Digits of the greatest number of a robot.
    robot_digits: usize,
}

#[derive(Debug)]
struct Failure {
    image: (Time, RobotId),
    error: RecordError,
}

/// Why a folder for images is refused.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// There is something in it.
    #[error("the folder is not empty: images of two runs would mix")]
    NotEmpty,
    /// It is no folder.
    #[error("this is a file: expected a folder for the images, which may be new")]
    File,
    /// It cannot be made or read.
    #[error(transparent)]
    Unusable(#[from] std::io::Error),
}

impl Frames {
    /// The folder `folder` for the images of `robots` robots, made if it is not there.
    ///
    /// # Errors
    /// [`FolderError`] if it is not empty, or no folder.
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

    /// Keeps images and scans, too, for [`Self::take`].
    pub fn keeping(self) -> Self {
        Self { kept: Some(Mutex::default()), ..self }
    }

    /// What has been kept since the last time, in order of (time, robot).
    pub fn take(&self) -> Vec<(Time, RobotId, Kept)> {
        let mut kept = self.kept.as_ref().map(|kept| std::mem::take(&mut *kept.lock())).unwrap_or_default();
        // Stable: what one robot took at one time stays in its order.
        kept.sort_by_key(|(time, robot, _)| (*time, *robot));
        kept
    }

    /// Keeps a scan that `robot` takes at `now`, if scans are kept.
    pub fn keep_scan(&self, robot: RobotId, now: Time, scan: impl FnOnce() -> KeptScan) {
        if let Some(kept) = &self.kept {
            kept.lock().push((now, robot, Kept::Scan(scan())));
        }
    }

    /// Writes and keeps an image that `robot` takes. Into the folder goes none after the first that could not be written, of which
    /// [`FrameFailures`] tells. Those before it are still tried, so that which one is the first does not depend on threads.
    pub fn write(&self, robot: RobotId, frame: &Frame<'_>) {
        let png = frame.pixels.png(frame.size);
        if let Some(folder) = &self.folder {
            self.write_into(folder, robot, frame, &png);
        }
        if let Some(kept) = &self.kept {
            let image = KeptFrame { number: frame.number, form: frame.pixels.form(), png };
            kept.lock().push((frame.exposed, robot, Kept::Frame(image)));
        }
    }

    fn write_into(&self, folder: &Folder, robot: RobotId, frame: &Frame<'_>, png: &[u8]) {
        let image = (frame.exposed, robot);
        let is_first = |failure: &Option<Failure>| failure.as_ref().is_none_or(|failure| image < failure.image);
        if !is_first(&self.failure.lock()) {
            return;
        }
        let path = folder.path.join(folder.name(robot, frame));
        if let Err(error) = write_whole(&path, png) {
            let mut failure = self.failure.lock();
            if is_first(&failure) {
                *failure = Some(Failure { image, error: RecordError::write("image", &path, error) });
            }
        }
    }
}

impl Folder {
    /// Name of an image's file: sorted by names, files are sorted by robot, number and time of exposure.
    fn name(&self, robot: RobotId, frame: &Frame<'_>) -> String {
        let Time(us) = frame.exposed;
        let (seconds, us) = (us / 1_000_000, us % 1_000_000);
        let behind = match frame.pixels {
            Pixels::Depth(_) | Pixels::Labels(_) => format!("-{}", frame.pixels.form()),
            _ => String::new(),
        };
        let digits = self.robot_digits;
        format!("r{:0digits$}-{:06}-{seconds:05}.{us:06}{behind}.png", robot.0, frame.number)
    }
}

/// Ends the run where an image could not be written.
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
