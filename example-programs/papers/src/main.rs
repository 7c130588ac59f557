//! The command `papers`: see `papers --help` and `docs/papers.md`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail};
use clap::{Parser, ValueEnum};
use papers::doc::Doc;
use papers::page::Page;
use papers::run::Job;
use papers::{alduro, eyesim, france, wu};

/// The host does not use libc's heap: a crashed robot program may leave libc's heap locked or corrupt.
#[global_allocator]
static HEAP: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// A claim that must hold does not, or a page of the docs differs from the results.
const EXIT_CLAIM: u8 = 1;
/// The command line is wrong, or something could not be run, read or written.
const EXIT_ERROR: u8 = 2;

/// Runs the scenes of a paper, writes its figures and tables, and sets what we find beside what the paper says.
#[derive(Parser)]
#[command(name = "papers", version, after_help = EXIT_CODES)]
struct Args {
    /// The paper
    #[arg(value_enum)]
    paper: Choice,
    /// The folder for pages, figures, tables and traces; it is made if it is not there
    #[arg(long, value_name = "DIR", default_value = "target/papers")]
    out: PathBuf,
    /// Seed of all random numbers
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    seed: u64,
    /// Number of random terrains of each kind, if not as on the page of the docs
    #[arg(long, value_name = "NUMBER", value_parser = at_least_one)]
    terrains: Option<usize>,
    /// Write the tables into a Markdown page: each between its `<!-- papers: PAPER -->` and `<!-- end -->`
    #[arg(long, value_name = "FILE")]
    doc: Option<PathBuf>,
    /// Compare the tables with those of a Markdown page
    #[arg(long, value_name = "FILE", conflicts_with = "doc")]
    check: Option<PathBuf>,
}

const EXIT_CODES: &str = "Exit codes: 0 every claim that must hold does, 1 one does not or --check finds another table, \
                          2 usage, file or run errors.";

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Choice {
    /// Koestler and Bräunl: the simulator's own paper
    Eyesim,
    /// France et al. 1999: proximity sensors on a walking robot
    France,
    /// France et al. 1999: number and place of sensors over holes, stairs and uneven floor
    Floors,
    /// Gois and Hiller: walks of ALDURO by a map from sonar
    Alduro,
    /// Gois and Hiller: comparison of maps from sonar
    Fusion,
    /// Gois and Hiller: the planner's equations, one by one
    Planner,
    /// Wu et al. 2013: grid maps from seven sonars
    Wu,
    /// Wu et al. 2013: the same maps with real odometry, and with corrected poses
    Odometry,
    /// All of them
    All,
}

type Reproduce = fn(&Job, Option<usize>) -> anyhow::Result<Page>;

impl Choice {
    fn papers(self) -> Vec<(&'static str, Reproduce)> {
        let all: [(Self, &str, Reproduce); 8] = [
            (Self::Eyesim, "eyesim", |job, _| eyesim::run(job)),
            (Self::France, "france", |job, _| france::run(job)),
            (Self::Floors, "floors", france::floors::run),
            (Self::Alduro, "alduro", alduro::run),
            (Self::Fusion, "fusion", alduro::fusion),
            (Self::Planner, "planner", alduro::planner),
            (Self::Wu, "wu", |job, _| wu::run(job)),
            (Self::Odometry, "odometry", |job, _| wu::odometry::run(job)),
        ];
        let chosen = all.into_iter().filter(|(choice, ..)| self == Self::All || self == *choice);
        chosen.map(|(_, name, reproduce)| (name, reproduce)).collect()
    }
}

/// Parses a number of terrains.
fn at_least_one(word: &str) -> Result<usize, String> {
    word.parse().ok().filter(|number| *number > 0).ok_or_else(|| "expected a number from 1".to_owned())
}

fn main() -> ExitCode {
    reproduce(&Args::parse()).unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        ExitCode::from(EXIT_ERROR)
    })
}

fn reproduce(args: &Args) -> anyhow::Result<ExitCode> {
    check_folder(&args.out).with_context(|| format!("--out `{}`", args.out.display()))?;
    let mut doc = args.doc.as_deref().map(Doc::read).transpose().context("--doc")?;
    let checked = args.check.as_deref().map(Doc::read).transpose().context("--check")?;
    let mut fails = false;
    for (name, reproduce) in args.paper.papers() {
        let job = Job::new(name, &args.out.join(name), args.seed)?;
        let page = reproduce(&job, args.terrains)?;
        let index = page.write(job.folder())?;
        print!("{}  {}\n\n", page.summary(), index.display());
        fails |= page.has_failed();
        if let Some(doc) = &mut doc {
            doc.set(name, &page).context("--doc")?;
            doc.write_linked(&page).context("--doc")?;
        }
        if let Some(checked) = &checked {
            for difference in checked.differences(name, &page).context("--check")? {
                eprintln!("--check: {difference}");
                fails = true;
            }
        }
    }
    doc.map(|doc| doc.write()).transpose().context("--doc")?;
    Ok(if fails { ExitCode::from(EXIT_CLAIM) } else { ExitCode::SUCCESS })
}

/// Makes a folder if it does not exist, and checks that files can be made in it.
fn check_folder(folder: &Path) -> anyhow::Result<()> {
    if folder.exists() && !folder.is_dir() {
        bail!("it is a file, expected a folder");
    }
    std::fs::create_dir_all(folder).context("the folder cannot be made")?;
    tempfile::tempfile_in(folder).context("no file can be made in it")?;
    Ok(())
}
