//! Pictures from above, to scale, of files (`eyesim plot`) and of finished runs (`eyesim run --plot`), and charts of
//! measurements (`eyesim accuracy --plots`).
//!
//! `scene` and `run` describe a picture as a [`Drawing`] in metres; `render` renders it. Nothing here changes the
//! simulation or depends on fonts or libraries of the machine.

mod canvas;
pub mod chart;
mod colour;
mod drawing;
mod ground;
mod label;
mod object;
mod render;
mod robot;
mod run;
mod scene;
mod terrain;
#[cfg(test)]
mod tests;
mod viewport;

use std::path::{Path, PathBuf};

pub use drawing::Drawing;
pub use run::{RunObject, RunPicture, RunRobot, draw_finished, draw_paths, draw_run, draw_trials};
pub use scene::{draw_ground, draw_object_type, draw_robi, draw_scene};
use sim_host::record::report::write_atomically;

/// Error when making a picture.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The file's extension is not that of a supported picture format.
    #[error("`{0}` is not the name of a picture: expected a name that ends in .svg or .png")]
    Kind(String),
    /// Error of the drawing library.
    #[error("cannot draw the picture: {0}")]
    Draw(String),
    /// Error of the operating system when writing.
    #[error("cannot write the picture `{}`: {source}", path.display())]
    Write {
        /// The file as the user named it.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
}

/// Format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureKind {
    /// Scalable Vector Graphics.
    Svg,
    /// Portable Network Graphics.
    Png,
}

impl PictureKind {
    /// Format selected by the extension of the file name. A name without an extension in `/dev`, such as
    /// `/dev/stdout`, selects SVG, which is text.
    ///
    /// # Errors
    /// [`PlotError::Kind`] for another extension, or none.
    pub fn of(path: &Path) -> Result<Self, PlotError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "svg" => Ok(Self::Svg),
            "png" => Ok(Self::Png),
            "" if path.starts_with("/dev") => Ok(Self::Svg),
            _ => Err(PlotError::Kind(path.display().to_string())),
        }
    }

    /// Renders a picture in this format, with a total size of `size` pixels, or a suitable size if it is `None`.
    ///
    /// # Errors
    /// [`PlotError::Draw`] if the drawing library fails.
    pub fn render(self, drawing: &Drawing, size: Option<(u32, u32)>) -> Result<Vec<u8>, PlotError> {
        match self {
            Self::Svg => render::to_svg(drawing, size).map(String::into_bytes),
            Self::Png => render::to_png(drawing, size),
        }
    }
}

/// Writes a picture to `path`, completely or not at all, in the format of its extension. `size` is in pixels, as for
/// [`PictureKind::render`].
///
/// # Errors
/// [`PlotError`] for an unsupported format, or a picture that cannot be drawn or written.
pub fn write(drawing: &Drawing, path: &Path, size: Option<(u32, u32)>) -> Result<(), PlotError> {
    let bytes = PictureKind::of(path)?.render(drawing, size)?;
    write_atomically(path, &bytes).map_err(|source| PlotError::Write { path: path.to_owned(), source })
}
