//! Zstandard compression of traces, as a sequence of complete frames.

use std::io::{self, BufRead, Read};

use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};

/// First bytes of a frame.
pub const MAGIC: [u8; 4] = [0x28, 0xB5, 0x2F, 0xFD];

/// Length of the text in a frame, in bytes. Our choice: longer frames hardly improve the compression.
pub const FRAME: usize = 1 << 20;

/// Compresses `text` into a frame.
pub fn frame(text: &[u8]) -> Vec<u8> {
    compress_to_vec(text, CompressionLevel::Fastest)
}

/// Reads the text of all frames of `input`. An incomplete last frame, as left by a killed run, is omitted unless it is
/// the only one.
pub struct Frames<R> {
    input: R,
    decoder: FrameDecoder,
    is_open: bool,
    /// True if text has been read.
    has_text: bool,
}

impl<R: BufRead> Frames<R> {
    /// Creates a reader of the frames of `input`.
    pub fn new(input: R) -> Self {
        Self { input, decoder: FrameDecoder::new(), is_open: false, has_text: false }
    }

    /// Returns the error of a frame, or 0 bytes if the input ended within the frame and text precedes it.
    fn error(&mut self, error: impl std::fmt::Display) -> io::Result<usize> {
        self.is_open = false;
        if self.input.fill_buf()?.is_empty() {
            let truncated = || io::Error::new(io::ErrorKind::UnexpectedEof, "it is truncated, before its first line");
            return if self.has_text { Ok(0) } else { Err(truncated()) };
        }
        Err(io::Error::new(io::ErrorKind::InvalidData, format!("its compression (Zstandard) is damaged: {error}")))
    }
}

impl<R: BufRead> Read for Frames<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while !buffer.is_empty() {
            if self.is_open && self.decoder.can_collect() > 0 {
                self.has_text = true;
                return self.decoder.read(buffer);
            }
            if self.is_open && !self.decoder.is_finished() {
                let strategy = BlockDecodingStrategy::UptoBytes(buffer.len());
                if let Err(error) = self.decoder.decode_blocks(&mut self.input, strategy) {
                    return self.error(error);
                }
                continue;
            }
            self.is_open = false;
            if self.input.fill_buf()?.is_empty() {
                break;
            }
            if let Err(error) = self.decoder.reset(&mut self.input) {
                return self.error(error);
            }
            self.is_open = true;
        }
        Ok(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> io::Result<String> {
        let mut text = String::new();
        Frames::new(bytes).read_to_string(&mut text).map(|_| text)
    }

    #[test]
    fn compressed_text_is_restored() {
        let long: String = (0..100_000).map(|line| format!("{{\"t_s\":{line},\"event\":\"pose\"}}\n")).collect();
        let bytes = [frame(long.as_bytes()), frame(b""), frame(b"the end")].concat();
        assert!(bytes.starts_with(&MAGIC));
        assert!(bytes.len() * 4 < long.len(), "{} of {}", bytes.len(), long.len());
        assert_eq!(read(&bytes).expect("frames"), long.clone() + "the end");
        assert_eq!(read(b"").expect("no frame"), "");
        // A run was killed while it wrote the last frame.
        let cut = [frame(b"whole"), frame(long.as_bytes())].concat();
        let text = read(&cut[..cut.len() - 1000]).expect("a cut frame");
        assert!(text.starts_with("whole") && (long + "whole").len() > text.len(), "{}", text.len());
        for length in [MAGIC.len(), 20] {
            let error = read(&frame(b"{\"event\":\"header\"}")[..length]).expect_err("a cut frame");
            assert_eq!(error.to_string(), "it is truncated, before its first line", "{length} bytes");
        }
    }

    #[test]
    fn damaged_frame_gives_an_error() {
        let bytes = [frame(b"whole"), b"no frame at all, but long enough".to_vec()].concat();
        let error = read(&bytes).expect_err("damaged").to_string();
        assert!(error.starts_with("its compression (Zstandard) is damaged: "), "{error}");
    }
}
