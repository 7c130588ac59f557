//! `eyesim child`: the process of one robot, started only by `eyesim run --exec process`.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use clap::Args;
use sim_host::executive::process::client;

/// Arguments of `eyesim child`.
#[derive(Args)]
pub struct ChildArgs {
    /// The program, a shared library
    pub library: PathBuf,
    /// A debugger has started it
    #[arg(long)]
    pub debugged: bool,
}

/// Runs the command; standard input is the connection to the host.
///
/// # Errors
/// If `eyesim run` has not started it.
pub fn run(args: &ChildArgs) -> anyhow::Result<ExitCode> {
    client::run(&args.library, args.debugged).context("only `eyesim run --exec process` starts `eyesim child`")
}
