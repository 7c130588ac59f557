//! `eyesim view`: runs a scene in the window, and restarts it on request.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::hash::{BuildHasher as _, Hasher as _};
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::process::{ExitCode, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime};

use anyhow::{Context as _, ensure};
use clap::Args;
use parking_lot::Mutex;
use sim_core::time::Time;
use sim_format::print_current_scene;
use sim_host::executive::dispatcher::EndReason;
use sim_host::executive::interrupt::{self, Interrupt};
use sim_host::executive::program::Exec;
use sim_host::files::DiskFiles;
use sim_host::launch::settings::TYPED;
use sim_host::launch::{Error, Observers, Ready, Rejected, Scene};
use sim_host::program::find::ProgramSource;
use sim_host::record::{EventStore, Sink, TraceReader, Trails};
use sim_view::page::Page;
use sim_view::protocol::{Build, RunState, Seed};
use sim_view::window::{Access, Download, OpenError, Options, PendingCommand, Window, random_token};

use super::EXIT_INTERRUPTED;
use super::diagnostic::{self, Format, Screen};
use super::output::{causes, say, tell};
use super::pack::open_for_run;
use super::run::{self, ConsoleRun, FinishedRun, RunArgs, Speed, explain, parse_seconds};
use super::table::{self, TableScreen};
use crate::window::control::Control;
use crate::window::control_panel::{ControlPanel, RunStarter, SPEEDS};
use crate::window::driver::Driver;
use crate::window::feed::Feed;
use crate::window::recording::recording;
use crate::window::scene::title;
use crate::window::show::{BodyPoses, Moment, Show, ShowParts};

/// Arguments of `eyesim view`: those of a run, and how it is watched.
#[derive(Args)]
#[command(after_help = AFTER_HELP)]
#[command(mut_arg("speed", |arg| arg.default_value("1")))]
#[command(mut_arg("linger", |arg| arg.default_value("1e9")))]
#[command(mut_arg("until", |arg| arg.help("Simulated seconds at which the run ends [default: that of the scene, else never]")))]
#[command(mut_arg("frames", |arg| arg.hide(true)), mut_arg("repeat", |arg| arg.hide(true)))]
pub struct ViewArgs {
    #[command(flatten)]
    run: RunArgs,
    /// Do not open a browser
    #[arg(long)]
    no_open: bool,
    /// Port of the pages, 0 for any free port [default: 7351, or any free port if 7351 is in use]
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true)]
    port: Option<u16>,
    /// For a class: allow others to watch over the network, at this address of this machine (0.0.0.0: all), optionally
    /// with a port: `0.0.0.0:7412`
    #[arg(long, value_name = "ADDRESS[:PORT]", value_parser = parse_listen)]
    listen: Option<ListenAddress>,
    /// With --listen, token that allows a page to act; pages without it only watch [default: a random token]
    #[arg(long, value_name = "TOKEN", requires = "listen", value_parser = parse_token)]
    token: Option<String>,
    /// Wait before the first slot until a user continues the run
    #[arg(long)]
    paused: bool,
    /// Run at full speed to this simulated second, then wait until a user continues the run
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_hyphen_values = true)]
    at: Option<Time>,
    /// Start again with the same seed whenever a program or a file of the scene is saved
    #[arg(long)]
    watch: bool,
}

const AFTER_HELP: &str = "The window stays open when the run is over, until Ctrl-C. `--listen 0.0.0.0` prints two addresses: the \
                          class's address, which may only watch, and the teacher's address, which may act.";

/// Address at which other machines may watch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ListenAddress {
    ip: IpAddr,
    /// The port, if the address has one.
    port: Option<u16>,
}

/// Default port of the window.
const DEFAULT_PORT: u16 = 7351;

/// Minimum interval between two checks for changed files with --watch.
const WATCH_PERIOD: Duration = Duration::from_millis(50);

/// Minimum interval between two searches for new files after a failed build.
const SEARCH_PERIOD: Duration = Duration::from_secs(1);

/// Interval between two checks for requests once the run is over.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Runs the command until Ctrl-C.
///
/// # Errors
/// If files or arguments are wrong, or the port is taken.
pub fn run(mut args: ViewArgs) -> anyhow::Result<ExitCode> {
    let _unpacked = open_for_run(&mut args.run)?;
    ensure!(args.run.frames.is_none(), "--frames: it is for `eyesim run`, since the window may start the run again");
    ensure!(args.run.repeat.is_none(), "--repeat: it is for `eyesim run`; `eyesim replay` shows a recorded run");
    if let Speed::Factor(factor) = args.run.speed {
        ensure!(
            SPEEDS.contains(&factor),
            "--speed {factor}: expected {} to {}, or `max`",
            SPEEDS.start(),
            SPEEDS.end()
        );
    }
    let begun = SystemTime::now();
    let (ready, files) = prepare(&args.run)?;
    let window = Arc::new(open(&args, &title(ready.scene()))?);
    announce_address(&args, &window);
    let control = Arc::new(Control::default());
    control.update(|requests| {
        requests.is_paused = args.paused || args.at.is_some();
        requests.skip_to = args.at;
        requests.speed = match args.run.speed {
            Speed::Max => None,
            Speed::Factor(factor) => Some(factor),
        };
    });
    let session = Arc::new(Session {
        window: Arc::clone(&window),
        control: Arc::clone(&control),
        interrupt: interrupt::of_process().context("cannot install signal handlers")?,
        args: Mutex::new(args.run.clone()),
        next: Mutex::new(None),
        is_building: AtomicBool::new(false),
        files: Mutex::new(WatchedFiles::of(files, begun)),
        failed: Mutex::new(None),
    });
    let last_check = args.watch.then(Instant::now);
    let control_panel =
        ControlPanel::open(window, control, RestartHandler { session: Arc::clone(&session), last_check })?;
    let code = session.run_all(ready);
    drop(control_panel);
    code
}

/// Reads, builds and loads the scene of the arguments; also returns the files that a user edits to change the run.
fn prepare(args: &RunArgs) -> anyhow::Result<(Ready, Vec<PathBuf>)> {
    let stdin = args.stdin.clone().or_else(|| Some(TYPED.into()));
    let args = RunArgs { default_until: Time::NEVER, stdin, ..args.clone() };
    let built = run::build(run::open(&args)?, &args)?;
    let files = built.edited_files();
    Ok((built.load()?, files))
}

/// Opens the window with the access and address of the arguments.
fn open(args: &ViewArgs, title: &str) -> anyhow::Result<Window> {
    let page = Page::load(|text| say(text));
    if let Some(why) = page.why_missing() {
        say(why);
    }
    let access = match (&args.token, args.listen) {
        (Some(token), _) => Access::Class { token: token.clone() },
        (None, Some(_)) => Access::Class { token: random_token()? },
        (None, None) => Access::Local,
    };
    let port = args.listen.and_then(|listen| listen.port);
    if let (Some(listen_port), Some(port)) = (port, args.port) {
        ensure!(listen_port == port, "--listen has the port {listen_port}, and --port says {port}: give one of them");
    }
    let ip = args.listen.map_or(Ipv4Addr::LOCALHOST.into(), |listen| listen.ip);
    open_window(page, access, ip, port.or(args.port), title)
}

/// Opens a window at `ip` and `port`; without a port at `DEFAULT_PORT`, or at any free port if `DEFAULT_PORT` is taken.
///
/// # Errors
/// If the port is taken, or the address belongs to another machine.
pub fn open_window(page: Page, access: Access, ip: IpAddr, port: Option<u16>, title: &str) -> anyhow::Result<Window> {
    let open = |port, page| {
        let (access, title, version) = (access.clone(), title.to_owned(), env!("CARGO_PKG_VERSION").to_owned());
        Window::open(Options { address: SocketAddr::new(ip, port), access, title, version }, page)
    };
    match (open(port.unwrap_or(DEFAULT_PORT), page.clone()), port) {
        (Err(OpenError::Taken(_)), None) => Ok(open(0, page)?),
        (window, _) => Ok(window?),
    }
}

/// Prints the address of the window, and opens it in the user's browser.
fn announce_address(args: &ViewArgs, window: &Window) {
    let url = window.url();
    if args.listen.is_some() {
        tell(format_args!("class:   {}\nteacher: {url}", window.public_url()));
    } else {
        tell(&url);
    }
    if !args.no_open && !open_browser(&url) {
        say("no browser could be opened: open the address above in one, or set BROWSER");
    }
}

/// Opens an address in the user's browser; returns false if there is none.
pub fn open_browser(url: &str) -> bool {
    let user_commands = std::env::var("BROWSER").unwrap_or_default();
    // `BROWSER` may contain several commands, separated by colons; `%s` is replaced by the address.
    let user_commands = user_commands.split(':').filter(|command| !command.is_empty()).map(str::to_owned);
    user_commands.chain(["xdg-open".to_owned()]).any(|command| {
        let mut parts = command.split_whitespace();
        let Some(program) = parts.next() else { return false };
        let mut arguments: Vec<String> = parts.map(|word| word.replace("%s", url)).collect();
        if !command.contains("%s") {
            arguments.push(url.to_owned());
        }
        let [input, output, errors] = [Stdio::null(), Stdio::null(), Stdio::null()];
        std::process::Command::new(program).args(arguments).stdin(input).stdout(output).stderr(errors).spawn().is_ok()
    })
}

/// State shared by all runs of a window.
struct Session {
    window: Arc<Window>,
    control: Arc<Control>,
    /// Ends the current run; no further run begins.
    interrupt: Interrupt,
    /// Arguments of the current run.
    args: Mutex<RunArgs>,
    /// The run that begins when the current run has ended, and its arguments.
    next: Mutex<Option<(Ready, RunArgs)>>,
    is_building: AtomicBool,
    files: Mutex<WatchedFiles>,
    /// The last build, if it failed: a file that it misses may come into being.
    failed: Mutex<Option<FailedBuild>>,
}

impl Session {
    /// Runs `ready`, and each run that follows it, until the user interrupts.
    fn run_all(&self, mut ready: Ready) -> anyhow::Result<ExitCode> {
        for number in 1.. {
            let args = self.args.lock().clone();
            let (show, feed) = self.create_show(&ready, number);
            self.control.update(|requests| {
                (requests.is_over, requests.is_ending, requests.steps) = (false, false, 0);
            });
            let event_store = self.offer(&ready, &show)?;
            let trails = Arc::new(Mutex::new(Trails::of_scene(ready.scene())));
            self.offer_trails(number, &trails);
            let sinks: Vec<Box<dyn Sink>> = vec![Box::new(feed), Box::new(event_store), Box::new(trails)];
            let observers = Observers { sinks, interrupt: self.interrupt.clone(), ..Observers::default() };
            let mut running = ConsoleRun::start(ready, &args, observers, true)?;
            Driver::new(Arc::clone(&self.control), Arc::clone(&show)).drive(running.scheduler());
            let finished_run = running.finish(|| {});
            // Pending interventions are refused: dropping them answers their commands.
            drop(self.control.update(|requests| {
                requests.is_over = true;
                std::mem::take(&mut requests.actions)
            }));
            if matches!(finished_run.finished.ended.end, EndReason::ProgramFailed | EndReason::HeapLost) {
                // The broken program may have left locks of the C library in this process, so later programs get
                // processes.
                self.args.lock().exec = Exec::Process;
            }
            finished_run.write_files(&args)?;
            let is_restart = self.next.lock().is_some();
            if !is_restart {
                explain(&finished_run.finished);
                table::checks(&finished_run.finished.report, TableScreen::of_stdout()).iter().for_each(tell);
            }
            match self.wait_for_next(&finished_run, &show) {
                Some((next, args)) => {
                    *self.args.lock() = args;
                    ready = next;
                }
                None => break,
            }
        }
        Ok(ExitCode::from(EXIT_INTERRUPTED))
    }

    /// Creates the show of run `number`, and the feed of its events.
    fn create_show(&self, ready: &Ready, number: u32) -> (Arc<Mutex<Show>>, Arc<Mutex<Feed>>) {
        let feed = Arc::new(Mutex::new(Feed::default()));
        let show = Show::new(ShowParts {
            window: Arc::clone(&self.window),
            run: number,
            seed: ready.settings().seed,
            slot: ready.settings().slot,
            spec: Arc::clone(ready.scene()),
            scenery: Arc::clone(ready.scenery()),
            feed: Arc::clone(&feed),
            tally: ready.tally().cloned(),
        });
        (Arc::new(Mutex::new(show)), feed)
    }

    /// Offers the robots' trails of run `number` so far, for pages that are opened later.
    fn offer_trails(&self, number: u32, trails: &Arc<Mutex<Trails>>) {
        let trails = Arc::clone(trails);
        let json = move || {
            let lines: Vec<Vec<Vec<[f64; 2]>>> = {
                let trails = trails.lock();
                let line = |line: Vec<glam::DVec2>| line.into_iter().map(<[f64; 2]>::from).collect();
                trails.trails().iter().map(|body| body.lines().into_iter().map(line).collect()).collect()
            };
            serde_json::to_vec(&serde_json::json!({"run": number, "trails": lines})).map_err(|error| error.to_string())
        };
        self.window.offer("trails.json", Download::new("application/json", json));
    }

    /// Offers the downloads of the run to pages; returns the temporary file that contains its trace.
    fn offer(&self, ready: &Ready, show: &Arc<Mutex<Show>>) -> anyhow::Result<Arc<Mutex<EventStore>>> {
        let event_store =
            Arc::new(Mutex::new(EventStore::new(ready.trace_header()).context("no room for temporary files")?));
        let trace_store = Arc::clone(&event_store);
        let trace = move || EventStore::trace(&trace_store).map_err(|error| error.to_string());
        self.window.offer("trace.jsonl", Download::new("application/jsonl", trace.clone()));
        let (recorded_show, spec) = (Arc::clone(show), Arc::clone(ready.scene()));
        // Not `recording.json`: its presence tells pages that they show a replay and not a live run.
        self.window.offer(
            "run.recording.json",
            Download::new("application/json", move || {
                let scene = Show::recorded_scene(&recorded_show);
                let trace = trace()?;
                let reader = TraceReader::new(&*trace, Path::new("trace.jsonl")).map_err(|error| error.to_string())?;
                let recording = recording(reader, scene, &spec, Vec::new()).map_err(|error| error.to_string())?;
                serde_json::to_vec(&recording).map_err(|error| error.to_string())
            }),
        );
        let (current_show, file) = (Arc::clone(show), ready.scene().file.clone());
        self.window.offer(
            "scene.toml",
            Download::new("application/toml", move || {
                let BodyPoses { robots, objects } = current_show.lock().body_poses().clone();
                let text = print_current_scene(&file, &DiskFiles::of_environment(), &robots, &objects);
                text.map(String::into_bytes).map_err(|diagnostics| {
                    let messages = diagnostics.iter().map(|diagnostic| diagnostic.message.clone());
                    messages.collect::<Vec<_>>().join("\n")
                })
            }),
        );
        Ok(event_store)
    }

    /// Shows the end of the run until the next run is ready; returns `None` if the user interrupts.
    fn wait_for_next(&self, finished_run: &FinishedRun, show: &Mutex<Show>) -> Option<(Ready, RunArgs)> {
        let mut is_shown = false;
        loop {
            if self.interrupt.is_set() {
                return None;
            }
            if let Some(next) = self.next.lock().take() {
                return Some(next);
            }
            let speed = {
                let mut requests = self.control.requests();
                requests.is_show_due = false;
                requests.speed
            };
            if !is_shown || show.lock().has_new_looks() {
                is_shown = true;
                self.show_end(finished_run, &mut show.lock(), speed);
            }
            self.control.wait(POLL_INTERVAL);
        }
    }

    fn show_end(&self, finished_run: &FinishedRun, show: &mut Show, speed: Option<f64>) {
        let state =
            RunState::Ended { why: end_text(finished_run), digest: finished_run.finished.ended.digest.to_string() };
        let (run, ends) = (&*finished_run.finished.ended.run, &finished_run.finished.ended.robots[..]);
        let world = run.world();
        let (now, results) = (finished_run.finished.ended.time, Some(&finished_run.finished.report.checks[..]));
        show.present(Moment { run, world: &world, now, state, speed, rate: 0.0, ends, results });
    }

    /// Builds a run with these arguments to replace the current one; answers `pending` when that is done.
    fn build(self: &Arc<Self>, args: RunArgs, pending: Option<PendingCommand>) {
        if self.is_building.swap(true, Ordering::AcqRel) {
            return pending.into_iter().for_each(|pending| pending.refuse("a run is being built"));
        }
        let session = Arc::clone(self);
        self.window.build(Build::Running);
        let build = move || {
            let begun = SystemTime::now();
            match prepare(&args) {
                Ok((ready, files)) => {
                    session.files.lock().update(files, begun);
                    *session.failed.lock() = None;
                    {
                        // Both happen under one lock, so that the current run is ended and not the next run.
                        let mut next = session.next.lock();
                        *next = Some((ready, args));
                        session.control.update(|requests| requests.is_ending = true);
                    }
                    session.window.build(Build::Done);
                    pending.into_iter().for_each(PendingCommand::accept);
                }
                Err(error) => {
                    say(format_args!("error: {}", causes(&error)));
                    let failed = FailedBuild::new(&args, &error);
                    session.files.lock().add(failed.files(), begun);
                    *session.failed.lock() = Some(failed);
                    let output = match error.downcast_ref::<Error>() {
                        Some(Error::Rejected(rejected)) => full_message(rejected),
                        _ => causes(&error),
                    };
                    pending.into_iter().for_each(|pending| pending.refuse("the run cannot be built"));
                    session.window.build(Build::Failed { output });
                }
            }
            session.is_building.store(false, Ordering::Release);
        };
        if let Err(error) = std::thread::Builder::new().name("build".to_owned()).spawn(build) {
            self.is_building.store(false, Ordering::Release);
            self.window.build(Build::Failed { output: format!("no room for another thread: {error}") });
        }
    }
}

/// A run that could not be prepared.
struct FailedBuild {
    /// Files of the scene.
    inputs: Vec<PathBuf>,
    /// Programs that were found.
    programs: Vec<ProgramSource>,
    /// Time of the last search for new files.
    last_search: Instant,
}

impl FailedBuild {
    fn new(args: &RunArgs, error: &anyhow::Error) -> Self {
        let scene = Scene::open(&args.sim, args.options()).ok();
        let inputs = scene.iter().flat_map(|scene| scene.inputs()).map(|input| PathBuf::from(&input.path)).collect();
        let programs = match error.downcast_ref() {
            Some(Error::Programs(error)) => error.sources.clone(),
            _ => Vec::new(),
        };
        Self { inputs, programs, last_search: Instant::now() }
    }

    /// Files that a user edits to mend the run, as far as they exist.
    fn files(&self) -> Vec<PathBuf> {
        self.inputs.iter().cloned().chain(self.programs.iter().flat_map(ProgramSource::sources)).collect()
    }
}

/// Reason for rejecting a scene, with all its diagnostics, for a page.
fn full_message(rejected: &Rejected) -> String {
    let Rejected { diagnostics, inputs } = rejected;
    let text = diagnostic::render(diagnostics, inputs, Format::Auto, Screen::of_page());
    format!("{rejected}\n{}", text.unwrap_or_default())
}

/// Text for the page: why the run has ended, the first robot that failed, and the results of its checks.
fn end_text(finished_run: &FinishedRun) -> String {
    let checks = &finished_run.finished.report.checks;
    let failed: Vec<String> = checks
        .iter()
        .filter(|check| !check.passed)
        .map(|check| format!("; failed: {} ({})", check.name, check.message))
        .collect();
    let passed_count = checks.len() - failed.len();
    let summary =
        if checks.is_empty() { String::new() } else { format!("; {passed_count} of {} checks passed", checks.len()) };
    let failures = run::failures(&finished_run.finished.report);
    let failure = match &failures[..] {
        [] => String::new(),
        [first] => format!("; {first}"),
        [first, others @ ..] => format!("; {first} (and {} more)", others.len()),
    };
    end_reason(finished_run) + &failure.replace('\n', " ") + &summary + &failed.concat()
}

fn end_reason(finished_run: &FinishedRun) -> String {
    match &finished_run.finished.ended.end {
        EndReason::Finished => "all programs have ended".to_owned(),
        EndReason::Until => format!("the limit of {} is reached", finished_run.finished.ended.time),
        EndReason::Stuck => "every program waits for an event that cannot occur".to_owned(),
        EndReason::Interrupted => "interrupted".to_owned(),
        EndReason::ProgramFailed | EndReason::HeapLost => "a program failed".to_owned(),
        EndReason::Record(error) => error.to_string(),
    }
}

/// Restarts runs when a page requests it or a file is saved.
struct RestartHandler {
    session: Arc<Session>,
    /// Time of the last check of the files, with --watch.
    last_check: Option<Instant>,
}

impl RunStarter for RestartHandler {
    fn restart(&mut self, seed: Seed, pending: PendingCommand) {
        let mut args = self.session.args.lock().clone();
        match seed {
            Seed::Same => {}
            Seed::New => args.seed = Some(new_seed()),
            Seed::Number(text) => match text.trim().parse() {
                Ok(seed) => args.seed = Some(seed),
                Err(_) => {
                    return pending.refuse(format!("`{text}` is not a seed: expected a number from 0 to {}", u64::MAX));
                }
            },
        }
        self.session.build(args, Some(pending));
    }

    fn tick(&mut self) {
        if self.last_check.is_none_or(|last| last.elapsed() < WATCH_PERIOD) {
            return;
        }
        self.last_check = Some(Instant::now());
        if let Some(failed) = &mut *self.session.failed.lock()
            && failed.last_search.elapsed() >= SEARCH_PERIOD
        {
            failed.last_search = Instant::now();
            self.session.files.lock().add(failed.files(), SystemTime::UNIX_EPOCH);
        }
        if !self.session.is_building.load(Ordering::Acquire) && self.session.files.lock().have_changed() {
            let args = self.session.args.lock().clone();
            self.session.build(args, None);
        }
    }
}

/// Random seed, short enough to be written down.
fn new_seed() -> u64 {
    // The keys of the standard library's hash maps come from the system's random numbers.
    u64::from(std::hash::RandomState::new().build_hasher().finish() as u32)
}

/// Files that a user edits to change the run, each with its state at the last check.
struct WatchedFiles(BTreeMap<PathBuf, Option<FileState>>);

/// Time of modification and length of a file.
type FileState = (SystemTime, u64);

impl WatchedFiles {
    /// Files of a build that began at `begun`. A file that was modified since counts as changed.
    fn of(paths: Vec<PathBuf>, begun: SystemTime) -> Self {
        let mut files = Self(BTreeMap::new());
        files.add(paths, begun);
        files
    }

    /// Replaces the list by the files of a build that began at `begun`. The stored state of a file that was already in
    /// the list is kept, so that a change during the build is not missed.
    fn update(&mut self, paths: Vec<PathBuf>, begun: SystemTime) {
        let new = paths.iter().collect::<BTreeSet<_>>();
        self.0.retain(|known, _| new.contains(known));
        self.add(paths, begun);
    }

    /// Adds the files of a build that are not in the list yet.
    fn add(&mut self, paths: Vec<PathBuf>, begun: SystemTime) {
        // A time in the future is that of another machine's clock.
        let is_saved_since = |(modified, _): &FileState| (begun..=SystemTime::now()).contains(modified);
        for path in paths {
            if let Entry::Vacant(entry) = self.0.entry(path) {
                let state = file_state(entry.key()).filter(|state| !is_saved_since(state));
                entry.insert(state);
            }
        }
    }

    /// Returns true if a file has changed since the last check.
    fn have_changed(&mut self) -> bool {
        let mut is_changed = false;
        for (path, last) in &mut self.0 {
            let now = file_state(path);
            // A missing file is probably being replaced by an editor.
            if now.is_some() && now != *last {
                (*last, is_changed) = (now, true);
            }
        }
        is_changed
    }
}

/// State of a file; `None` if there is no such file.
fn file_state(path: &Path) -> Option<FileState> {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

fn parse_listen(text: &str) -> Result<ListenAddress, String> {
    let alone = text.parse::<IpAddr>().map(|ip| ListenAddress { ip, port: None });
    let with_port = |text: &str| {
        text.parse::<SocketAddr>().map(|address| ListenAddress { ip: address.ip(), port: Some(address.port()) })
    };
    alone.or_else(|_| with_port(text)).map_err(|_not_an_address| {
        "expected an address of this machine, alone or with a port: `0.0.0.0` (all), `192.168.1.20:7412`, `[::]:7412`".to_owned()
    })
}

fn parse_token(text: &str) -> Result<String, String> {
    let is_word =
        !text.is_empty() && text.chars().all(|letter| letter.is_ascii_alphanumeric() || "-_.".contains(letter));
    if is_word { Ok(text.to_owned()) } else { Err("expected letters, digits, `-`, `_` and `.`".into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_saved_since_the_start_of_a_build_has_changed_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let [old, new] = ["old", "new"].map(|name| folder.path().join(name));
        let hour = Duration::from_secs(3600);
        let begun = SystemTime::now();
        let save = |path: &Path, time: SystemTime| {
            std::fs::write(path, "text").expect("a file");
            let file = std::fs::File::options().write(true).open(path).expect("the file");
            file.set_modified(time).expect("a file with a time");
        };
        save(&old, begun - hour);
        save(&new, begun);
        let mut files = WatchedFiles::of(vec![old.clone()], begun);
        assert!(!files.have_changed());
        files.update(vec![old.clone(), new.clone()], begun);
        assert!(files.have_changed() && !files.have_changed());
        files.update(vec![old.clone(), new.clone()], begun);
        assert!(!files.have_changed(), "the new file is known");
        save(&old, begun);
        files.update(vec![old.clone(), new], SystemTime::now());
        assert!(files.have_changed(), "it was saved before the build of this list, but after the last check");
        std::fs::remove_file(&old).expect("the file");
        assert!(!files.have_changed());
        save(&old, SystemTime::now() + hour);
        assert!(!WatchedFiles::of(vec![old], begun).have_changed(), "the clock of the file's machine differs");
    }

    #[test]
    fn listen_address_may_have_a_port() {
        let parsed = |text| parse_listen(text).map(|ListenAddress { ip, port }| (ip.to_string(), port));
        assert_eq!(parsed("0.0.0.0"), Ok(("0.0.0.0".to_owned(), None)));
        assert_eq!(parsed("0.0.0.0:7412"), Ok(("0.0.0.0".to_owned(), Some(7412))));
        assert_eq!(parsed("[::1]:7412"), Ok(("::1".to_owned(), Some(7412))));
        assert_eq!(parsed("::"), Ok(("::".to_owned(), None)));
        for wrong in ["7412", "localhost", "0.0.0.0:", "1.2.3.4:99999"] {
            assert!(parsed(wrong).is_err_and(|why| why.contains("`192.168.1.20:7412`")), "{wrong}");
        }
    }
}
