//! Conversion of EyeSim files to the specs of `sim-core` in SI units, with diagnostics, and back.
//!
//! Every reader is a total function: for any text it returns a spec of finite numbers, reports all mistakes and never
//! panics. This library does no I/O: [`load_scene`] gets its files through [`Files`]. It neither finds nor builds
//! programs. One reader per kind of file reads the dialects of all EyeSim versions; it distinguishes them by number
//! and kind of the values. docs/formats/ describes the formats.
#![forbid(unsafe_code)]

pub mod builtin;
mod checks;
mod clearance;
mod code;
mod companion;
pub mod content;
mod convert;
mod device_checks;
mod diagnostic;
mod esobj;
mod faults;
mod form;
mod line;
mod load;
pub mod map;
mod maze;
mod mesh;
mod noise;
pub mod path;
mod place;
pub mod print;
mod robi;
mod scene;
mod set;
mod sim;
pub mod suite;
mod table;
#[cfg(test)]
mod tests;
mod types;
mod used_names;
mod world;

pub use code::{Code, UnknownCode};
pub use companion::read_companion;
pub use convert::{
    ConvertOptions, Converted, GenerationOf, LiveEntity, Output, convert, convert_with, print_current_scene,
};
pub use diagnostic::{Diagnostic, Severity, has_errors};
pub use esobj::read_esobj;
pub use load::{
    FileError, Files, InputFile, Loaded, MemoryFiles, Overrides, check_scene, decode, load_costs, load_noise,
    load_object, load_robi, load_scene, load_scene_with, load_world, load_world_with,
};
pub use maze::{CellRules, read_maze, read_maze_with};
pub use mesh::MeshReader;
pub use noise::{LEVELS, NOISE_EXTENSION, PRESETS, is_noise, preset, preset_text, read_noise, unknown_sensors};
pub use robi::read_robi;
pub use scene::{SCENE_EXTENSION, is_costs, is_scene, read_costs, read_scene};
pub use set::{Setting, SettingError};
pub use sim::read_sim;
pub use world::read_world;

use sim_core::spec::{self, *};
use sim_core::unit;

/// First words of the lines of each classic format, by the extension of its files.
pub const KEYWORDS: [(&str, &[&str]); 4] =
    [("sim", &sim::KEYWORDS), ("wld", &world::KEYWORDS), ("robi", &robi::KEYWORDS), ("esobj", &esobj::KEYWORDS)];
