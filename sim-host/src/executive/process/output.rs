//! Output that a robot's process writes to its own standard output and error, bypassing the simulator.

use std::io::{self, PipeReader, Read, Write};
use std::thread::{self, JoinHandle};

use crate::record::log::is_terminal_control;

/// Maximum number of bytes of this output that are shown per process; our choice.
const MAX_BYTES: usize = 1 << 20;

/// Forwards the output in `pipe` to this process's standard error on a new thread: at most [`MAX_BYTES`] bytes, and
/// without control characters, which could change the terminal. The rest is read and dropped, so that the writer does
/// not block.
///
/// # Errors
/// The system lacks the resources for the thread.
pub fn forward(pipe: PipeReader) -> io::Result<JoinHandle<()>> {
    thread::Builder::new().name("output".to_owned()).spawn(move || copy(pipe, io::stderr()))
}

/// Copies `from` to `to` until the end, as [`forward`] does. If `to` is closed, the output is dropped.
fn copy(mut from: impl Read, mut to: impl Write) {
    let mut remaining = MAX_BYTES;
    let mut is_truncated = false;
    let mut buffer = [0; 1 << 14];
    // Bytes at the beginning of the buffer that are not printed yet: a character without its end.
    let mut kept = 0;
    loop {
        let count = match from.read(&mut buffer[kept..]) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Ok(count) => count,
            Err(_) => 0,
        };
        let len = kept + count;
        kept = if count == 0 { 0 } else { incomplete_len(&buffer[..len]) };
        let complete = len - kept;
        let printed = complete.min(remaining);
        remaining -= printed;
        let _ = to.write_all(printable(&buffer[..printed]).as_bytes());
        buffer.copy_within(complete..len, 0);
        if count == 0 {
            return;
        }
        if printed < complete && !is_truncated {
            is_truncated = true;
            let _ = writeln!(to, "\n... a program has printed more than {} kB past the simulator", MAX_BYTES / 1000);
        }
    }
}

/// The text in `bytes`, with `?` for each control character other than line feed and tab.
fn printable(bytes: &[u8]) -> String {
    let shown = |c| if is_terminal_control(c) && !matches!(c, '\n' | '\t') { '?' } else { c };
    String::from_utf8_lossy(bytes).chars().map(shown).collect()
}

/// Number of bytes at the end of `bytes` that begin a character of UTF-8 without its end.
fn incomplete_len(bytes: &[u8]) -> usize {
    let end = bytes.utf8_chunks().last().map_or(&[][..], |chunk| chunk.invalid());
    let is_incomplete = std::str::from_utf8(end).is_err_and(|error| error.error_len().is_none());
    if is_incomplete { end.len() } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escape_sequences_are_removed() {
        assert_eq!(printable(b"a\x1b[2J\tb\r\n"), "a?[2J\tb?\n");
        assert_eq!(printable("ä\u{9b}2J\u{202e}".as_bytes()), "ä?2J?");
        assert_eq!(printable(b"\x9b2J"), "\u{fffd}2J");
    }

    #[test]
    fn character_in_two_parts_is_kept_until_its_end() {
        let euro = "€".as_bytes();
        assert_eq!([1, 2, 3].map(|len| incomplete_len(&euro[..len])), [1, 2, 0]);
        assert_eq!([&b"a\xC2"[..], b"a\x9b", b"a\xFF", b""].map(incomplete_len), [1, 0, 0, 0]);
    }

    #[test]
    fn one_message_tells_that_output_is_dropped() {
        for dropped in [0, 1, 20_000, 40_000] {
            let mut shown = Vec::new();
            copy(&*vec![b'x'; MAX_BYTES + dropped], &mut shown);
            let count = String::from_utf8_lossy(&shown).matches("more than 1048 kB").count();
            assert_eq!(count, usize::from(dropped > 0), "{dropped} bytes are dropped");
        }
    }
}
