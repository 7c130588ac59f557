//! The safe Rust RoBIOS API for robot programs.
