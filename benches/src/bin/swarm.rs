//! Writes the scene of the swarm: `swarm ROBOTS FOLDER` creates `FOLDER/swarm.sim` for `eyesim run`.
#![forbid(unsafe_code)]

use std::env;
use std::path::Path;
use std::process::ExitCode;

use benches::swarm;

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let (robots, folder) = match arguments.as_slice() {
        [robots, folder] => (robots.parse::<usize>().ok().filter(|robots| *robots > 0), Path::new(folder)),
        _ => (None, Path::new("")),
    };
    let Some(robots) = robots else {
        eprintln!("usage: swarm ROBOTS FOLDER");
        return ExitCode::from(2);
    };
    match swarm::write(robots, folder) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("cannot write to `{}`: {error}", folder.display());
            ExitCode::from(2)
        }
    }
}
