//! The archive that Gradescope runs. It contains `setup.sh`, `run_autograder`, this binary and the suite.
//!
//! Source: the specification of Gradescope's autograders, gradescope-autograders.readthedocs.io/en/latest/specs.

use std::fs;
use std::io::{Cursor, Write as _};
use std::path::Path;

use anyhow::Context as _;
use sim_host::host;
use sim_host::program::sandbox::Level;
use sim_host::record::report::write_atomically;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::pack::Pack;

const SETUP: &str = include_str!("setup.sh");
const RUN: &str = include_str!("run_autograder");

/// Writes the archive, which grades in a sandbox of `level`.
///
/// # Errors
/// This binary or the seeds cannot be read, or the archive cannot be written.
pub(super) fn write(file: &Path, suite: &Pack, seeds: Option<&Path>, level: Level) -> anyhow::Result<()> {
    let binary = host::script().context("no path of this command")?;
    anyhow::ensure!(
        host::current().is_none(),
        "--gradescope: the archive holds the binary `eyesim`; this is the command of the Python package"
    );
    let binary = fs::read(&binary).with_context(|| format!("`{}`", binary.display()))?;
    let mut entries: Vec<(&str, u32, Vec<u8>)> = vec![
        ("setup.sh", 0o755, SETUP.into()),
        ("run_autograder", 0o755, RUN.replace("LEVEL", level.word()).into()),
        ("suite.zip", 0o644, suite.to_bytes()?),
        ("eyesim", 0o755, binary),
    ];
    if let Some(seeds) = seeds {
        let bytes = fs::read(seeds).with_context(|| format!("`{}`", seeds.display()))?;
        entries.push(("hidden-seeds.txt", 0o600, bytes));
    }
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, mode, bytes) in entries {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default())
            .unix_permissions(mode);
        writer.start_file(name, options)?;
        writer.write_all(&bytes)?;
    }
    let bytes = writer.finish()?.into_inner();
    write_atomically(file, &bytes).with_context(|| format!("--gradescope: cannot write `{}`", file.display()))
}
