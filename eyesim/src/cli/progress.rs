//! Progress display on standard error if it is a terminal: the programs being built, then a bar with simulated time and
//! the states of the robots.

use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use parking_lot::Mutex;
use sim_core::time::Time;
use sim_host::program::build::BuildObserver;
use sim_host::program::find::ProgramSource;

/// Minimum time between two updates of the bar.
const PERIOD: Duration = Duration::from_millis(100);

/// Line with the programs that are being built; it disappears when dropped.
#[derive(Debug)]
pub struct Building {
    bar: ProgressBar,
    names: Mutex<Vec<String>>,
}

impl Building {
    /// Creates the line on standard error, hidden if standard error is not a terminal.
    pub fn on_stderr() -> Self {
        Self::with_target(ProgressDrawTarget::stderr_with_hz(10))
    }

    fn with_target(target: ProgressDrawTarget) -> Self {
        let bar = ProgressBar::with_draw_target(None, target);
        // The template is valid; if it were not, the default style would do.
        let style = ProgressStyle::with_template("{spinner} building {wide_msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        Self { bar, names: Mutex::default() }
    }

    fn show(&self, names: &[String]) {
        self.bar.set_message(names.join(", "));
    }
}

impl BuildObserver for Building {
    fn begin(&self, source: &ProgramSource) {
        let mut names = self.names.lock();
        names.push(name(source.path()));
        self.show(&names);
        self.bar.enable_steady_tick(PERIOD);
    }

    fn end(&self, source: &ProgramSource) {
        let mut names = self.names.lock();
        let name = name(source.path());
        if let Some(index) = names.iter().position(|other| *other == name) {
            names.remove(index);
        }
        // The last name stays visible until something else is shown.
        if !names.is_empty() {
            self.show(&names);
        }
    }
}

impl Drop for Building {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// The name of a source file or of a package's folder.
fn name(source: &Path) -> String {
    source.file_name().unwrap_or(source.as_os_str()).to_string_lossy().into_owned()
}

/// Numbers of robots in each state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Robots whose programs compute or drive.
    pub running: usize,
    /// Robots that wait for something.
    pub waiting: usize,
    /// Robots whose programs have ended.
    pub ended: usize,
}

/// Progress bar, drawn at most ten times per second. It costs one clock reading per slot, or nothing if it is hidden.
pub struct Progress {
    bar: Option<ProgressBar>,
    until: Time,
    start: Instant,
    next_update: Instant,
}

impl Progress {
    /// Creates the bar of a run that ends at `until` at the latest ([`Time::NEVER`] if unknown), hidden if standard
    /// error is not a terminal.
    pub fn new(until: Time) -> Self {
        Self::with_target(until, ProgressDrawTarget::stderr_with_hz(10))
    }

    /// A hidden bar.
    pub fn hidden() -> Self {
        Self::with_target(Time::NEVER, ProgressDrawTarget::hidden())
    }

    fn with_target(until: Time, target: ProgressDrawTarget) -> Self {
        let length = (until != Time::NEVER).then_some(until.0.unsigned_abs());
        let bar = (!target.is_hidden()).then(|| {
            let bar = ProgressBar::with_draw_target(length, target);
            let template = if length.is_some() { "{wide_bar} {msg}" } else { "{msg}" };
            // Both templates are valid; if one were not, the default style would do.
            bar.set_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        let now = Instant::now();
        Self { bar, until, start: now, next_update: now }
    }

    /// Returns true if the bar is visible.
    pub fn is_visible(&self) -> bool {
        self.bar.is_some()
    }

    /// Shows the simulated time `now`; calls `counts` only if the bar is drawn.
    pub fn update(&mut self, now: Time, counts: impl FnOnce() -> Counts) {
        let Some(bar) = &self.bar else { return };
        let instant = Instant::now();
        if instant < self.next_update {
            return;
        }
        self.next_update = instant + PERIOD;
        let factor = now.seconds() / (instant - self.start).as_secs_f64().max(1e-9);
        bar.set_position(now.0.clamp(0, self.until.0).unsigned_abs());
        bar.set_message(message(now, self.until, factor, counts()));
        bar.tick();
    }

    /// Returns a function that shows a text about a program that computes within a slot, instead of the robots' states;
    /// `None` if the bar is hidden.
    pub fn computing(&self) -> Option<impl FnMut(&str) + Send + use<>> {
        let bar = self.bar.clone()?;
        let (mut time, mut last_message) = (String::new(), String::new());
        Some(move |text: &str| {
            let message = bar.message();
            if message != last_message {
                time = message.split_inclusive(", ").next().unwrap_or_default().to_owned();
            }
            last_message = format!("{time}{text}");
            bar.set_message(last_message.clone());
            bar.tick();
        })
    }

    /// Removes the bar from the screen permanently.
    pub fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }

    /// Standard output, whose lines appear above the bar.
    pub fn stdout(&self) -> Box<dyn Write + Send> {
        self.above_bar(io::stdout(), io::stdout().is_terminal())
    }

    /// Standard error, whose lines appear above the bar.
    pub fn stderr(&self) -> Box<dyn Write + Send> {
        self.above_bar(Lossy(io::stderr()), true)
    }

    fn above_bar(&self, stream: impl Write + Send + 'static, is_same_screen: bool) -> Box<dyn Write + Send> {
        match &self.bar {
            Some(bar) if is_same_screen => Box::new(StreamAboveBar { bar: bar.clone(), stream }),
            _ => Box::new(stream),
        }
    }
}

/// Message of the bar: `12.500 s of 600.000 s, 5200 times real time; 3 running, 1 waiting`.
fn message(now: Time, until: Time, factor: f64, counts: Counts) -> String {
    let end = if until == Time::NEVER { String::new() } else { format!(" of {until}") };
    let speed = if factor < 10.0 { format!("{factor:.1}") } else { format!("{factor:.0}") };
    let parts = [(counts.running, "running"), (counts.waiting, "waiting"), (counts.ended, "ended")];
    let parts: Vec<_> =
        parts.iter().filter(|(count, _)| *count > 0).map(|(count, word)| format!("{count} {word}")).collect();
    let robots = if parts.is_empty() { String::new() } else { format!("; {}", parts.join(", ")) };
    format!("{now}{end}, {speed} times real time{robots}")
}

/// Stream whose errors are ignored: a full or closed standard error is no reason to end a run.
struct Lossy<W>(W);

impl<W: Write> Write for Lossy<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        _ = self.0.write_all(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        _ = self.0.flush();
        Ok(())
    }
}

/// Stream on the same screen as a bar, which is hidden during each write.
struct StreamAboveBar<W> {
    bar: ProgressBar,
    stream: W,
}

impl<W: Write> Write for StreamAboveBar<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let stream = &mut self.stream;
        self.bar.suspend(|| {
            let written = stream.write(bytes)?;
            // Flushed before the bar is drawn again.
            stream.flush().map(|()| written)
        })
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use indicatif::TermLike;

    use super::*;

    /// Terminal that records its output.
    #[derive(Clone, Debug, Default)]
    struct Screen(Arc<Mutex<String>>);

    impl Screen {
        fn write(&self, text: &str) -> io::Result<()> {
            self.0.lock().push_str(text);
            Ok(())
        }
    }

    impl TermLike for Screen {
        fn width(&self) -> u16 {
            100
        }
        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn write_line(&self, text: &str) -> io::Result<()> {
            self.write(text).and_then(|()| self.write("\n"))
        }
        fn write_str(&self, text: &str) -> io::Result<()> {
            self.write(text)
        }
        fn clear_line(&self) -> io::Result<()> {
            self.write("<clear>")
        }
        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    fn progress(until: Time) -> (Progress, Screen) {
        let screen = Screen::default();
        (Progress::with_target(until, ProgressDrawTarget::term_like(Box::new(screen.clone()))), screen)
    }

    #[test]
    fn bar_shows_time_and_robots() {
        let (mut progress, screen) = progress(Time::from_millis(600_000));
        progress.update(Time::from_millis(12_500), || Counts { running: 3, waiting: 1, ended: 0 });
        let text = screen.0.lock().clone();
        assert!(text.contains("12.500 s of 600.000 s, "), "{text}");
        assert!(text.contains("times real time; 3 running, 1 waiting"), "{text}");
    }

    #[test]
    fn bar_is_drawn_at_most_ten_times_per_second() {
        let (mut progress, _) = progress(Time::NEVER);
        let start = progress.start;
        let mut drawn = 0;
        for slot in 0..100_000 {
            progress.update(Time(50_000 * slot), || {
                drawn += 1;
                Counts::default()
            });
        }
        let max_count = 1 + start.elapsed().as_millis() / PERIOD.as_millis();
        assert!((1..=max_count).contains(&drawn), "{drawn} times, at the most {max_count}");
    }

    #[test]
    fn computing_program_is_shown_until_the_next_slot() {
        let (mut progress, screen) = progress(Time::NEVER);
        let mut computing = progress.computing().unwrap();
        for location in ["loop.c:5", "loop.c:6"] {
            computing(&format!("r1 computes at {location}"));
            assert_eq!(progress.bar.as_ref().unwrap().message(), format!("r1 computes at {location}"));
        }
        progress.update(Time::from_millis(2_500), || Counts { running: 1, waiting: 0, ended: 0 });
        for location in ["loop.c:5", "loop.c:6"] {
            computing(&format!("r1 computes at {location}"));
            assert_eq!(progress.bar.as_ref().unwrap().message(), format!("2.500 s, r1 computes at {location}"));
            assert!(screen.0.lock().contains(&format!("2.500 s, r1 computes at {location}")), "{:?}", screen.0.lock());
        }
        assert!(Progress::hidden().computing().is_none());
    }

    #[test]
    fn lines_appear_above_the_bar() {
        let (mut progress, screen) = progress(Time::NEVER);
        progress.update(Time(1), Counts::default);
        let before = screen.0.lock().len();
        struct Stream(Screen);
        impl Write for Stream {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                self.0.write(std::str::from_utf8(bytes).unwrap()).map(|()| bytes.len())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        progress.above_bar(Stream(screen.clone()), true).write_all(b"[r1 0.000 s] hello\n").unwrap();
        let text = screen.0.lock()[before..].to_owned();
        let (cleared, line) = (text.find("<clear>"), text.find("[r1 0.000 s] hello"));
        assert!(cleared.is_some() && cleared < line, "{text}");
    }

    #[test]
    fn cleared_bar_leaves_no_text() {
        let (mut progress, screen) = progress(Time(1));
        progress.update(Time(1), Counts::default);
        progress.clear();
        assert!(screen.0.lock().ends_with("<clear>"), "{:?}", screen.0.lock());
        assert!(!progress.is_visible());
    }

    #[test]
    fn programs_are_named_while_they_are_built() {
        let screen = Screen::default();
        let building = Building::with_target(ProgressDrawTarget::term_like(Box::new(screen.clone())));
        assert_eq!(*screen.0.lock(), "", "nothing is shown where everything was built before");
        let maze = ProgramSource::of_files(vec!["sims/maze.c".into(), "sims/map.c".into()]);
        let avoid = ProgramSource::Cargo("example-programs/avoid".into());
        building.begin(&maze);
        building.begin(&avoid);
        assert_eq!(building.bar.message(), "maze.c, avoid");
        assert!(screen.0.lock().contains("building maze.c"), "{:?}", screen.0.lock());
        building.end(&maze);
        assert_eq!(building.bar.message(), "avoid");
        building.end(&avoid);
        drop(building);
        assert!(screen.0.lock().ends_with("<clear>"), "{:?}", screen.0.lock());
    }

    #[test]
    fn hidden_bar_does_not_count_robots() {
        let mut progress = Progress::hidden();
        progress.update(Time(1), || unreachable!("the bar is hidden"));
        assert!(!progress.is_visible());
    }
}
