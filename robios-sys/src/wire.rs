//! Encoding of calls as bytes, for programs in separate processes: little endian, without padding, outputs before the
//! result.
//!
//! The layout of each kind of parameter is in `docs/protocol.md`. This module neither waits nor maps memory: on the
//! program's side a [`HostConnection`] carries a request to the host and returns the reply.

use std::ffi::c_void;

use crate::abi::{Status, Stop};
use crate::param::Callback;

#[cfg(target_endian = "big")]
compile_error!("what crosses to another process is little endian");

/// Value of a length that stands for a null pointer.
pub const NULL: u32 = u32::MAX;

/// Error for bytes that violate the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Malformed;

impl std::fmt::Display for Malformed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("an invalid message")
    }
}

impl std::error::Error for Malformed {}

/// The program's end of a connection to its host, used by the entries of a remote table.
pub trait HostConnection {
    /// The connection of the calling thread; `None` answers the call with [`Status::STOP`].
    ///
    /// # Safety
    /// `context` is the pointer passed to the program's `run`, which has not returned.
    unsafe fn from_context<'a>(context: *mut c_void) -> Option<&'a Self>
    where
        Self: Sized;

    /// Sends a call with its arguments and returns the bytes of the reply. The host may call back into the program
    /// meanwhile.
    ///
    /// # Errors
    /// [`Stop`] when the program must end.
    fn exchange(&self, table: u32, function: u32, arguments: &dyn Fn(&mut Vec<u8>)) -> Result<Vec<u8>, Stop>;
}

/// A value transferred as its bytes in memory.
///
/// # Safety
/// The type has no padding, and every bit pattern is valid.
pub unsafe trait Plain: Copy + 'static {
    /// Appends the value.
    fn put(&self, buffer: &mut Vec<u8>) {
        // SAFETY: all bytes of a value without padding are initialised.
        buffer.extend_from_slice(unsafe {
            std::slice::from_raw_parts((&raw const *self).cast::<u8>(), size_of::<Self>())
        });
    }

    /// Reads a value.
    ///
    /// # Errors
    /// [`Malformed`] if there are too few bytes.
    fn get(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        let bytes = reader.take(size_of::<Self>())?;
        // SAFETY: there are as many bytes as the type has, every bit pattern is valid, and the read is unaligned.
        Ok(unsafe { bytes.as_ptr().cast::<Self>().read_unaligned() })
    }
}

macro_rules! plain {
    ($($number:ty),*) => {$(
        // SAFETY: numbers have no padding and no forbidden values.
        unsafe impl Plain for $number {}
    )*};
}
plain!(u8, i8, u16, i16, i32, u32, i64, u64, f32, f64);

// SAFETY: an array has no padding between elements that have none.
unsafe impl<T: Plain, const N: usize> Plain for [T; N] {}

/// Sequential reader of bytes.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    /// A reader at the start of `bytes`.
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    /// The next `len` bytes.
    ///
    /// # Errors
    /// [`Malformed`] if there are fewer.
    pub fn take(&mut self, len: usize) -> Result<&'a [u8], Malformed> {
        let (taken, rest) = self.bytes.split_at_checked(len).ok_or(Malformed)?;
        self.bytes = rest;
        Ok(taken)
    }

    /// The next value.
    ///
    /// # Errors
    /// [`Malformed`] if there are too few bytes.
    pub fn get<T: Plain>(&mut self) -> Result<T, Malformed> {
        T::get(self)
    }

    /// The next length-prefixed bytes; `None` for a null pointer.
    ///
    /// # Errors
    /// [`Malformed`] if there are too few bytes.
    pub fn bytes(&mut self) -> Result<Option<&'a [u8]>, Malformed> {
        match self.get()? {
            NULL => Ok(None),
            len => self.take(len as usize).map(Some),
        }
    }

    /// The bytes not yet read.
    pub const fn rest(&self) -> &'a [u8] {
        self.bytes
    }
}

/// Appends length-prefixed bytes, or the marker of a null pointer.
///
/// # Panics
/// If there are 4 GiB or more of them, which no robot program passes.
pub fn put_bytes(bytes: Option<&[u8]>, buffer: &mut Vec<u8>) {
    match bytes {
        None => NULL.put(buffer),
        Some(bytes) => {
            u32::try_from(bytes.len())
                .ok()
                .filter(|len| *len != NULL)
                .expect("bytes of a call fit in a message")
                .put(buffer);
            buffer.extend_from_slice(bytes);
        }
    }
}

/// A call received by the host.
pub struct Request<'a> {
    /// Arguments not yet read.
    pub arguments: Reader<'a>,
    /// Converts code and data of a function of the program, both as numbers, to a callback that the host can call.
    pub callback: &'a dyn Fn(u64, u64) -> Callback,
}

impl std::fmt::Debug for Request<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Request").field("arguments", &self.arguments).finish_non_exhaustive()
    }
}

impl From<Stop> for Status {
    fn from(_: Stop) -> Self {
        Self::STOP
    }
}
