//! Invariants that every reader must keep for any input.
//!
//! Each [`Target`] passes one input to one reader. It panics if the reader panics or the reader's result breaks an
//! invariant: a number that is not finite or outside its documented range, a span outside the text, a diagnostic
//! without a message. The reader of the target `turn` is the host's side of the channel to a robot's process. The fuzz
//! targets in `fuzz/` only call these functions; normal tests call them with the committed inputs. This crate generates
//! no inputs and reads no files.
#![forbid(unsafe_code)]

pub mod archive;
mod reader;
mod spec;
mod text;
mod turn;

/// A reader and the invariants of its result.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Name in `cargo fuzz run NAME`; also the name of the folders with its inputs.
    pub name: &'static str,
    /// Panics if the input breaks an invariant.
    pub check: fn(&[u8]),
}

impl Target {
    const fn new(name: &'static str, check: fn(&[u8])) -> Self {
        Self { name, check }
    }
}

/// All targets. An input is a file of the reader's kind. For `load_scene`, `mesh` and `map` it is an [`archive`] of
/// several files, for `turn` a list of messages.
pub const TARGETS: &[Target] = &[
    Target::new("world", reader::world),
    Target::new("maze", reader::maze),
    Target::new("robi", reader::robi),
    Target::new("companion", reader::companion),
    Target::new("esobj", reader::esobj),
    Target::new("sim", reader::sim),
    Target::new("scene", reader::scene),
    Target::new("costs", reader::costs),
    Target::new("noise", reader::noise),
    Target::new("mesh", reader::mesh),
    Target::new("load_scene", reader::load_scene),
    Target::new("suite", reader::suite),
    Target::new("pack", reader::pack),
    Target::new("turn", turn::turn),
    Target::new("map", reader::map),
    Target::new("netpbm", reader::netpbm),
    Target::new("contest", reader::contest),
    Target::new("sdf", reader::sdf),
    Target::new("scenarios", reader::scenarios),
];

/// Checks `input` with the target named `target`.
///
/// # Panics
/// If there is no such target, or the input breaks an invariant.
pub fn check(target: &str, input: &[u8]) {
    let entry = TARGETS.iter().find(|entry| entry.name == target);
    let target = entry.unwrap_or_else(|| panic!("`{target}` is not a target"));
    (target.check)(input);
}
