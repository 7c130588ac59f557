//! Standard input of a program: a copy of a text given to the run, or lines that the user types during the run.

use std::sync::Arc;

use sim_core::time::Time;

use super::caller::Poll;
use super::robot::{Robot, WaitReason};

/// Standard input of the programs of a run.
#[derive(Clone, Debug, Default)]
pub enum Source {
    /// No input: it is at its end.
    #[default]
    Empty,
    /// A text; each program reads a copy.
    Text(Arc<[u8]>),
    /// Lines that the user types; programs wait for them.
    Typed,
}

/// Standard input of a robot's program.
#[derive(Clone, Debug, Default)]
pub struct Input {
    source: Source,
    /// The lines typed so far.
    typed: Vec<u8>,
    /// Number of bytes that the program has read.
    read: usize,
    /// Number of reads at the end of the text in quick succession, and the time of the last of them.
    reads_at_end: u32,
    last_read_at_end: Time,
    /// The program has read at the end of the text.
    has_ended: bool,
}

/// Result of a read.
pub enum Read {
    /// The rest of a line with its end, or as much of it as fits into the buffer.
    Bytes(Vec<u8>),
    /// The input is at its end.
    End,
    /// The program only reads at the end of its input, in a loop.
    Loop,
}

/// Number of reads at the end of the input, each within [`MAX_LOOP_PERIOD`] of the previous one, that are regarded as
/// an endless loop. Source: our choice.
const MAX_READS_AT_END: u32 = 1000;
/// Maximum virtual time between two reads of such a loop. Source: our choice.
const MAX_LOOP_PERIOD: Time = Time::from_millis(5);

/// Reason for ending a program that reads in a loop at the end of its input.
pub const LOOP_REASON: &str =
    "it reads its standard input in a loop, although the input has ended: `--stdin in.txt` gives it the text of a file";

/// Hint to a program that reads from an empty input.
pub const EMPTY_HINT: &str = "the program waits for typed input (standard input), but there is none: write the input into a file `in.txt` and run with \
                         `--stdin in.txt`";

impl Input {
    /// Input from the source of the run.
    pub fn new(source: Source) -> Self {
        Self { source, ..Self::default() }
    }

    /// Returns true if the program reads lines that the user types.
    pub fn is_typed(&self) -> bool {
        matches!(self.source, Source::Typed)
    }

    /// Adds a line, and its end, that the user has typed.
    pub fn type_line(&mut self, line: &str) {
        self.typed.extend(line.bytes().chain([b'\n']));
    }

    /// Returns true if the program has read at the end of its input.
    pub fn has_ended(&self) -> bool {
        self.has_ended
    }

    /// The next bytes up to the end of a line, at most `max_bytes`; empty at the end of the text.
    fn next(&mut self, max_bytes: usize) -> &[u8] {
        let text = if let Source::Text(text) = &self.source { text } else { &self.typed[..] };
        let rest = text.get(self.read..).unwrap_or_default();
        let line_length = rest.iter().position(|byte| *byte == b'\n').map_or(rest.len(), |end| end + 1);
        let bytes = &rest[..line_length.min(max_bytes)];
        self.read += bytes.len();
        bytes
    }
}

/// Reads standard input at the end of a call.
pub(super) fn read(robot: &mut Robot, max_bytes: usize) -> Poll<Read> {
    let now = robot.now;
    let input = &mut robot.robios.input;
    let bytes = input.next(max_bytes);
    if !bytes.is_empty() || max_bytes == 0 {
        let bytes = bytes.to_vec();
        input.reads_at_end = 0;
        return Poll::Ready(Read::Bytes(bytes));
    }
    if input.is_typed() {
        let reason = WaitReason::Input("a line typed to its standard input".to_owned());
        return Poll::Pending { at: Time::NEVER, reason };
    }
    let is_close = now - input.last_read_at_end <= MAX_LOOP_PERIOD;
    input.reads_at_end = if is_close { input.reads_at_end + 1 } else { 1 };
    input.last_read_at_end = now;
    let (is_loop, has_text) = (input.reads_at_end >= MAX_READS_AT_END, matches!(input.source, Source::Text(_)));
    if !std::mem::replace(&mut input.has_ended, true) && !has_text {
        robot.hint(EMPTY_HINT);
    }
    Poll::Ready(if is_loop { Read::Loop } else { Read::End })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_read_line_by_line_and_has_an_end() {
        let mut input = Input::new(Source::Text(Arc::from(&b"one\ntwo three"[..])));
        let mut next = |max_bytes| String::from_utf8_lossy(input.next(max_bytes)).into_owned();
        assert_eq!([next(80), next(3), next(80), next(80), next(80)], ["one\n", "two", " three", "", ""]);
        assert_eq!(Input::new(Source::Empty).next(80), b"");
        let mut input = Input::new(Source::Typed);
        assert_eq!(input.next(80), b"");
        input.type_line("three");
        input.type_line("");
        assert_eq!([input.next(80).to_vec(), input.next(80).to_vec()], [b"three\n".to_vec(), b"\n".to_vec()]);
    }
}
