//! Features that are missing in a build with `--no-default-features`.

use std::ffi::OsString;

/// Arguments of a subcommand that this build lacks: any arguments are accepted.
#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub struct AbsentArgs {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    _any: Vec<OsString>,
}

/// Returns the error for a request that needs `feature`, in a build without it.
pub fn error(feature: &str) -> anyhow::Error {
    anyhow::anyhow!(
        "this eyesim is built without {feature}: build it with all features by `cargo build --release`, \
         without `--no-default-features`"
    )
}
