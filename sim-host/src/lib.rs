//! The host of robot programs: files, programs, the scheduler and its flows, what each RoBIOS call does, recording.

pub mod cli;
pub mod executive;
pub mod files;
pub mod launch;
pub mod plot;
pub mod program;
pub mod record;
pub mod robios;
pub mod scenery;

pub mod window;
