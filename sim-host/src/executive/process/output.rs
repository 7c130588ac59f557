//! Output that a robot's process writes to its own standard output and error, bypassing the simulator.

use std::io::{self, PipeReader, Read as _, Write as _};
use std::thread::{self, JoinHandle};

/// Maximum number of bytes of this output that are shown per process; our choice.
const MAX_BYTES: usize = 1 << 20;

/// Forwards the output in `pipe` to this process's standard error on a new thread: at most [`MAX_BYTES`] bytes, and
/// without control characters, which could change the terminal. The rest is read and dropped, so that the writer does
/// not block.
///
/// # Errors
/// The system lacks the resources for the thread.
pub fn forward(mut pipe: PipeReader) -> io::Result<JoinHandle<()>> {
    let copy = move || {
        let mut remaining = MAX_BYTES;
        let mut buffer = [0; 1 << 14];
        loop {
            let count = match pipe.read(&mut buffer) {
                Ok(0) => return,
                Ok(count) => count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(_) => return,
            };
            let printed = count.min(remaining);
            remaining -= printed;
            // If standard error is closed, the output is dropped.
            let _ = io::stderr().write_all(printable(&mut buffer[..printed]));
            if printed < count && printed > 0 {
                let _ = writeln!(
                    io::stderr(),
                    "\n... a program has printed more than {} kB past the simulator",
                    MAX_BYTES / 1000
                );
            }
        }
    };
    thread::Builder::new().name("output".to_owned()).spawn(copy)
}

/// Replaces control characters other than line feed and tab by `?`.
fn printable(bytes: &mut [u8]) -> &[u8] {
    let is_control = |byte: &u8| byte.is_ascii_control() && !matches!(byte, b'\n' | b'\t');
    bytes.iter_mut().filter(|byte| is_control(byte)).for_each(|byte| *byte = b'?');
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escape_sequences_are_removed() {
        let mut bytes = *b"a\x1b[2J\tb\r\n";
        assert_eq!(printable(&mut bytes), b"a?[2J\tb?\n");
    }
}
