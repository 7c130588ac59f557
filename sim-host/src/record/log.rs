//! Sink that prints lines to the terminal during a run: `[r1 2.350 s] text`, in the order of the record.
//!
//! The log shows output of programs and hints; with `-v` it also shows RoBIOS calls, crashes and reasons of ends.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};
use std::io::{self, Write};

use sim_core::RobotId;
use sim_core::time::Time;

use super::hint_locations::HintLocations;
use super::sink::{RecordError, Sink};
use sim_core::record::{Digest, Event, Kind, KindSet, Record};

/// Selection of the lines to show.
#[derive(Clone, Debug, Default)]
pub struct Filter {
    /// True to show calls, crashes and reasons of ends as well.
    pub is_verbose: bool,
    /// Patterns of the calls to show (`VW*`); all if empty.
    pub only: Vec<Pattern>,
    /// The robots to show; all if empty.
    pub robots: Vec<RobotId>,
}

impl Filter {
    /// Returns true if lines of `robot` are shown.
    pub fn shows_robot(&self, robot: RobotId) -> bool {
        self.robots.is_empty() || self.robots.contains(&robot)
    }

    /// Returns true if calls of `function` by `robot` are shown.
    pub fn shows_call(&self, robot: RobotId, function: &str) -> bool {
        let is_selected = self.only.is_empty() || self.only.iter().any(|pattern| pattern.matches(function));
        self.is_verbose && is_selected && self.shows_robot(robot)
    }
}

/// A pattern of names: `*` matches any sequence of characters, `?` one character; case is ignored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern(String);

impl Pattern {
    /// Parses patterns separated by commas; blanks around them and empty patterns are dropped.
    pub fn parse_list(list: &str) -> Vec<Self> {
        list.split(',').map(str::trim).filter(|word| !word.is_empty()).map(|word| Self(word.to_owned())).collect()
    }

    /// Returns true if the pattern matches the whole of `name`.
    pub fn matches(&self, name: &str) -> bool {
        let (pattern, name) = (self.0.as_bytes(), name.as_bytes());
        let (mut pattern_index, mut name_index) = (0, 0);
        // Backtracking point of the last `*`: the next position in the pattern, and the end of the part of `name` that
        // the `*` covers.
        let mut retry: Option<(usize, usize)> = None;
        while name_index < name.len() {
            match pattern.get(pattern_index) {
                Some(b'*') => {
                    retry = Some((pattern_index + 1, name_index));
                    pattern_index += 1;
                }
                Some(letter) if *letter == b'?' || letter.eq_ignore_ascii_case(&name[name_index]) => {
                    pattern_index += 1;
                    name_index += 1;
                }
                _ => {
                    let Some((after_star, star_end)) = retry else { return false };
                    retry = Some((after_star, star_end + 1));
                    (pattern_index, name_index) = (after_star, star_end + 1);
                }
            }
        }
        pattern[pattern_index..].iter().all(|letter| *letter == b'*')
    }
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// A stream of the process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stream {
    Out,
    Err,
}

/// Prints lines: standard output of programs to `out`, everything else to `err`.
pub struct Log {
    filter: Filter,
    out: Box<dyn Write + Send>,
    err: Box<dyn Write + Send>,
    /// Lines of this slot for `stream` that are not yet written.
    pending: String,
    stream: Stream,
    /// Number of times that each hint was recorded.
    hints: BTreeMap<String, u32>,
    hint_locations: HintLocations,
}

impl Log {
    /// A log of the lines that `filter` selects.
    pub fn new(filter: Filter, out: Box<dyn Write + Send>, err: Box<dyn Write + Send>) -> Self {
        Self {
            filter,
            out,
            err,
            pending: String::new(),
            stream: Stream::Out,
            hints: BTreeMap::new(),
            hint_locations: HintLocations::default(),
        }
    }

    /// Shows hints with the lines in `hint_locations`.
    #[must_use]
    pub fn with_hint_locations(self, hint_locations: HintLocations) -> Self {
        Self { hint_locations, ..self }
    }

    /// Selects the stream for the next lines; writes the pending lines if it changes.
    fn select_stream(&mut self, stream: Stream) -> Result<(), RecordError> {
        if self.stream != stream {
            self.write_pending()?;
            self.stream = stream;
        }
        Ok(())
    }

    fn write_pending(&mut self) -> Result<(), RecordError> {
        if self.pending.is_empty() {
            return Ok(());
        }
        let (writer, stream) = match self.stream {
            Stream::Out => (&mut self.out, "standard output"),
            Stream::Err => (&mut self.err, "standard error"),
        };
        let written = writer.write_all(self.pending.as_bytes()).and_then(|()| writer.flush());
        self.pending.clear();
        match written {
            // The reader has closed the pipe (`| head`): the run continues without it.
            Err(source) if source.kind() == io::ErrorKind::BrokenPipe => {
                *writer = Box::new(io::sink());
                Ok(())
            }
            written => written.map_err(|source| RecordError::Print { stream, source }),
        }
    }

    /// Counts a hint; returns true if it is the first one with this text.
    fn count_hint(&mut self, text: &str) -> bool {
        match self.hints.get_mut(text) {
            Some(count) => {
                *count += 1;
                false
            }
            None => self.hints.insert(text.to_owned(), 1).is_none(),
        }
    }
}

impl Sink for Log {
    fn interest(&self) -> KindSet {
        let always = KindSet::of(&[Kind::Stdout, Kind::Stderr, Kind::Hint]);
        let verbose = KindSet::of(&[Kind::Call, Kind::ProgramFailed, Kind::Reason]);
        if self.filter.is_verbose { always.union(verbose) } else { always }
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        let is_shown = match record.event {
            Event::Call { function, .. } => self.filter.shows_call(record.robot, function),
            Event::Hint { text } => self.filter.shows_robot(record.robot) && self.count_hint(text),
            _ => self.filter.shows_robot(record.robot),
        };
        if is_shown {
            let is_output = matches!(record.event, Event::Stdout { .. });
            self.select_stream(if is_output { Stream::Out } else { Stream::Err })?;
            let location = match record.event {
                Event::Hint { text } => self.hint_locations.of(record.robot, text),
                _ => None,
            };
            push_line(&mut self.pending, record, location.as_deref());
        }
        Ok(())
    }

    fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
        self.write_pending()
    }

    /// Prints each hint that was recorded more than once, with the number of times.
    fn finish(&mut self, _: Time, _: Digest) -> Result<(), RecordError> {
        self.select_stream(Stream::Err)?;
        for (text, count) in std::mem::take(&mut self.hints) {
            if count > 1 {
                // Writing to a string cannot fail.
                _ = writeln!(self.pending, "hint, {count} times in all: {}", Printable(&text));
            }
        }
        self.write_pending()
    }
}

/// Appends the line of `record` to `lines`; the line of a hint includes `hint_location`, its source line. Appends
/// nothing for kinds that are not shown on the terminal.
fn push_line(lines: &mut String, record: &Record<'_>, hint_location: Option<&str>) {
    let start = lines.len();
    _ = write!(lines, "[{} {}] ", record.robot, record.time);
    // Writing to a string cannot fail.
    _ = match record.event {
        Event::Stdout { text } | Event::Stderr { text } => write!(lines, "{}", Printable(text)),
        Event::Hint { text } => {
            hint_location.iter().for_each(|hint_location| _ = write!(lines, "{}: ", Printable(hint_location)));
            write!(lines, "hint: {}", Printable(text))
        }
        Event::Reason { text } => write!(lines, "end: {}", Printable(text)),
        Event::Call { function, arguments, result: "" } => write!(lines, "{function}({})", Printable(arguments)),
        Event::Call { function, arguments, result } => {
            write!(lines, "{function}({}) = {}", Printable(arguments), Printable(result))
        }
        Event::ProgramFailed { what, location, last_call } => {
            let at = if location.is_empty() { "" } else { " at " };
            let after = if last_call.is_empty() { "" } else { ", last call " };
            write!(lines, "{what}{at}{location}{after}{last_call}")
        }
        _ => {
            lines.truncate(start);
            return;
        }
    };
    lines.push('\n');
}

/// Returns true for a character that could control a terminal or reorder the words of a text.
pub fn is_terminal_control(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}')
}

/// Displays text of a program with control characters other than tabs escaped, so that it cannot control the terminal.
pub struct Printable<'a>(
    /// The text.
    pub &'a str,
);

impl std::fmt::Display for Printable<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let is_harmless = |c: char| !is_terminal_control(c) || c == '\t';
        if self.0.chars().all(is_harmless) {
            return f.write_str(self.0);
        }
        self.0
            .chars()
            .try_for_each(|c| if is_harmless(c) { f.write_char(c) } else { write!(f, "{}", c.escape_default()) })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use parking_lot::Mutex;

    use super::*;

    fn pattern_matches(pattern: &str, name: &str) -> bool {
        Pattern(pattern.to_owned()).matches(name)
    }

    #[test]
    fn patterns_match_whole_names() {
        for (pattern, name) in [
            ("PSDGet", "PSDGet"),
            ("vw*", "VWDriveWait"),
            ("*Get*", "PSDGetRaw"),
            ("OS????", "OSWait"),
            ("*", "x"),
            ("a*b*c", "aXbYbZc"),
        ] {
            assert!(pattern_matches(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in
            [("PSDGet", "PSDGetRaw"), ("VW*", "OSVW"), ("*Get", "PSDGetRaw"), ("OS?", "OSWait"), ("", "x")]
        {
            assert!(!pattern_matches(pattern, name), "{pattern} {name}");
        }
        assert_eq!(Pattern::parse_list(" PSDGet, ,VW*"), [Pattern("PSDGet".into()), Pattern("VW*".into())]);
    }

    /// Terminal that merges both streams, each line marked by its stream.
    #[derive(Clone)]
    struct Terminal(Arc<Mutex<String>>, &'static str);

    impl Write for Terminal {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            for line in std::str::from_utf8(bytes).unwrap().lines() {
                _ = writeln!(self.0.lock(), "{}{line}", self.1);
            }
            Ok(bytes.len())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn shown(filter: Filter) -> String {
        let text = Arc::new(Mutex::new(String::new()));
        let stream = |mark| Box::new(Terminal(text.clone(), mark));
        let mut log = Log::new(filter, stream("1> "), stream("2> "));
        let events = [
            (1, Event::Call { function: "VWDriveStraight", arguments: "1, 0.5, 0.2", result: "0" }),
            (1, Event::Stdout { text: "wall\tahead \u{1b}[31m" }),
            (2, Event::Stdout { text: "mine" }),
            (2, Event::Hint { text: "0 is not a handle" }),
            (1, Event::Hint { text: "0 is not a handle" }),
            (2, Event::Call { function: "LCDClear", arguments: "", result: "" }),
            (2, Event::Stderr { text: "oh" }),
            (2, Event::ProgramFailed { what: "SIGSEGV", location: "maze.c:88", last_call: "PSDGet" }),
            (1, Event::Reason { text: "waits for KEY4" }),
        ];
        for (id, event) in events {
            let record = Record { time: Time(2_350_000), robot: RobotId(id), sequence: None, event };
            if log.interest().contains(event.kind()) {
                log.record(&record).unwrap();
            }
        }
        log.end_slot(Time(2_400_000), None).unwrap();
        log.finish(Time(2_400_000), Digest([0; 32])).unwrap();
        drop(log);
        Arc::into_inner(text).unwrap().into_inner()
    }

    #[test]
    fn lines_come_in_order_on_their_streams() {
        insta::assert_snapshot!(shown(Filter { is_verbose: true, ..Filter::default() }));
    }

    #[test]
    fn a_quiet_log_shows_output_and_hints() {
        insta::assert_snapshot!(shown(Filter::default()));
    }

    #[test]
    fn filters_choose_calls_and_robots() {
        let filter = Filter { is_verbose: true, only: Pattern::parse_list("LCD*"), robots: vec![RobotId(2)] };
        insta::assert_snapshot!(shown(filter));
    }

    #[test]
    fn a_closed_pipe_does_not_end_the_run() {
        struct Closed;
        impl Write for Closed {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::BrokenPipe.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let mut log = Log::new(Filter::default(), Box::new(Closed), Box::new(io::sink()));
        let record = Record { time: Time(0), robot: RobotId(1), sequence: None, event: Event::Stdout { text: "x" } };
        for _ in 0..2 {
            log.record(&record).unwrap();
            log.end_slot(Time(1), None).unwrap();
        }
    }
}
