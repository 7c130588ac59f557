//! Kinds of parameters of a call: their form in the ABI, and their form for the host's method.
//!
//! A program's pointer is dereferenced only while the host's method does not run: inputs are copied before it starts,
//! outputs are written after it has returned. A wild pointer thus crashes the program while the host holds no lock, and
//! the host keeps no pointer of a program.

use std::ffi::c_void;
use std::fmt::{self, Display, Formatter};

use crate::abi::{Status, Stop};
use crate::wire::{Malformed, NULL, Plain, Reader, Request, put_bytes};

/// A kind of parameter: the type in the list of functions.
pub trait Param {
    /// Form in the ABI, passed by value.
    type Abi: Copy;
    /// Form held by the thunk while the method runs.
    type Storage;
    /// Form passed to the method.
    type View<'a>;

    /// Reads the argument of the program, before the method runs.
    ///
    /// # Safety
    /// A pointer in `abi` is null or may be read as its kind requires.
    unsafe fn take(abi: Self::Abi) -> Self::Storage;

    /// Argument for the method.
    fn view(held: &mut Self::Storage) -> Self::View<'_>;

    /// Writes the outputs set by the method, after it has returned.
    ///
    /// # Safety
    /// A pointer in `abi` is null or may be written as its kind requires.
    unsafe fn give(abi: Self::Abi, held: Self::Storage) {
        let _ = (abi, held);
    }

    /// Formats the argument for a log of calls.
    ///
    /// # Errors
    /// Errors of the formatter.
    fn show(held: &Self::Storage, f: &mut Formatter<'_>) -> fmt::Result;

    /// In the program's process: appends to a request the part of the argument that the method needs.
    fn write_request(held: &Self::Storage, request: &mut Vec<u8>);

    /// In the host: reads an argument written by [`write_request`](Self::write_request).
    ///
    /// # Errors
    /// [`Malformed`] if the bytes do not encode such an argument.
    fn read_request(request: &mut Request<'_>) -> Result<Self::Storage, Malformed>;

    /// In the host: appends to a reply the outputs set by the method.
    fn write_reply(held: &Self::Storage, reply: &mut Vec<u8>) {
        let _ = (held, reply);
    }

    /// In the program's process: reads outputs written by [`write_reply`](Self::write_reply).
    ///
    /// # Errors
    /// [`Malformed`] if the bytes do not encode such outputs.
    fn read_reply(held: &mut Self::Storage, reply: &mut Reader<'_>) -> Result<(), Malformed> {
        let _ = (held, reply);
        Ok(())
    }
}

/// Result type of a function.
pub trait Return: Copy {
    /// Appends the result to a reply.
    fn write_reply(&self, reply: &mut Vec<u8>);

    /// Reads the result from a reply.
    ///
    /// # Errors
    /// [`Malformed`] if there are too few bytes.
    fn read_reply(reply: &mut Reader<'_>) -> Result<Self, Malformed>;

    /// Formats the result for a log of calls; nothing for `()`.
    ///
    /// # Errors
    /// Errors of the formatter.
    fn show(&self, f: &mut Formatter<'_>) -> fmt::Result;
}

macro_rules! plain {
    ($($number:ty),*) => {$(
        impl Param for $number {
            type Abi = Self;
            type Storage = Self;
            type View<'a> = Self;
            #[inline]
            unsafe fn take(abi: Self) -> Self {
                abi
            }
            #[inline]
            fn view(held: &mut Self) -> Self {
                *held
            }
            fn show(held: &Self, f: &mut Formatter<'_>) -> fmt::Result {
                held.fmt(f)
            }
            fn write_request(held: &Self, request: &mut Vec<u8>) {
                held.put(request);
            }
            fn read_request(request: &mut Request<'_>) -> Result<Self, Malformed> {
                request.arguments.get()
            }
        }
        impl Return for $number {
            fn write_reply(&self, reply: &mut Vec<u8>) {
                self.put(reply);
            }
            fn read_reply(reply: &mut Reader<'_>) -> Result<Self, Malformed> {
                reply.get()
            }
            fn show(&self, f: &mut Formatter<'_>) -> fmt::Result {
                self.fmt(f)
            }
        }
    )*};
}
plain!(u8, i32, u32, i64, u64, f32, f64);

impl Return for () {
    fn write_reply(&self, _: &mut Vec<u8>) {}
    fn read_reply(_: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(())
    }
    fn show(&self, _: &mut Formatter<'_>) -> fmt::Result {
        Ok(())
    }
}

/// Bytes of a program in the ABI: pointer and length. A null pointer means "none", for any length.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct ByteSlice {
    /// First byte, or null.
    pub data: *const u8,
    /// Number of bytes.
    pub len: usize,
}

impl ByteSlice {
    /// "None", as a null pointer of a C program.
    pub const NULL: Self = Self { data: std::ptr::null(), len: 0 };
}

impl From<&[u8]> for ByteSlice {
    fn from(bytes: &[u8]) -> Self {
        Self { data: bytes.as_ptr(), len: bytes.len() }
    }
}

impl From<&str> for ByteSlice {
    fn from(text: &str) -> Self {
        text.as_bytes().into()
    }
}

/// Buffer of a program in the ABI: pointer and length. A null pointer means "not wanted".
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct ByteBuffer {
    /// First byte, or null.
    pub data: *mut u8,
    /// Number of bytes that may be written.
    pub len: usize,
}

impl From<&mut [u8]> for ByteBuffer {
    fn from(buffer: &mut [u8]) -> Self {
        Self { data: buffer.as_mut_ptr(), len: buffer.len() }
    }
}

/// Text: a string that ends in 0 in C, [`ByteSlice`] without the 0 in the ABI, `Option<&[u8]>` for the host.
///
/// The bytes are in the encoding chosen by the program; `None` for a null pointer.
#[derive(Debug)]
pub enum Text {}

impl Param for Text {
    type Abi = ByteSlice;
    type Storage = Option<Vec<u8>>;
    type View<'a> = Option<&'a [u8]>;

    unsafe fn take(abi: ByteSlice) -> Self::Storage {
        // SAFETY: the caller vouches for pointer and length.
        unsafe { copied(abi) }
    }
    fn view(held: &mut Self::Storage) -> Option<&[u8]> {
        held.as_deref()
    }
    fn show(held: &Self::Storage, f: &mut Formatter<'_>) -> fmt::Result {
        match held {
            Some(bytes) => write!(f, "\"{}\"", bytes.escape_ascii()),
            None => f.write_str("NULL"),
        }
    }
    fn write_request(held: &Self::Storage, request: &mut Vec<u8>) {
        put_bytes(held.as_deref(), request);
    }
    fn read_request(request: &mut Request<'_>) -> Result<Self::Storage, Malformed> {
        Ok(request.arguments.bytes()?.map(<[u8]>::to_vec))
    }
}

/// Bytes with a length: [`ByteSlice`] in the ABI, `Option<&[u8]>` for the host, `None` for a null pointer.
#[derive(Debug)]
pub enum Bytes {}

impl Param for Bytes {
    type Abi = ByteSlice;
    type Storage = Option<Vec<u8>>;
    type View<'a> = Option<&'a [u8]>;

    unsafe fn take(abi: ByteSlice) -> Self::Storage {
        // SAFETY: the caller vouches for pointer and length.
        unsafe { copied(abi) }
    }
    fn view(held: &mut Self::Storage) -> Option<&[u8]> {
        held.as_deref()
    }
    fn show(held: &Self::Storage, f: &mut Formatter<'_>) -> fmt::Result {
        match held {
            Some(bytes) => write!(f, "[{} bytes]", bytes.len()),
            None => f.write_str("NULL"),
        }
    }
    fn write_request(held: &Self::Storage, request: &mut Vec<u8>) {
        put_bytes(held.as_deref(), request);
    }
    fn read_request(request: &mut Request<'_>) -> Result<Self::Storage, Malformed> {
        Ok(request.arguments.bytes()?.map(<[u8]>::to_vec))
    }
}

/// Copies a program's bytes.
///
/// # Safety
/// `slice` is null or readable.
unsafe fn copied(slice: ByteSlice) -> Option<Vec<u8>> {
    if slice.data.is_null() {
        return None;
    }
    // SAFETY: not null, and the caller vouches for the length.
    Some(unsafe { std::slice::from_raw_parts(slice.data, slice.len) }.to_vec())
}

/// A pointer to exactly one `T` that is read: for the host `Option<&T>`, `None` for a null pointer.
#[derive(Debug)]
pub struct In<T>(std::marker::PhantomData<T>);

impl<T: Plain> Param for In<T> {
    type Abi = *const T;
    type Storage = Option<T>;
    type View<'a> = Option<&'a T>;

    unsafe fn take(abi: *const T) -> Option<T> {
        // SAFETY: not null, and the caller vouches that it can be read; C may have aligned it badly.
        (!abi.is_null()).then(|| unsafe { abi.read_unaligned() })
    }
    fn view(held: &mut Option<T>) -> Option<&T> {
        held.as_ref()
    }
    fn show(held: &Option<T>, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(if held.is_some() { "..." } else { "NULL" })
    }
    fn write_request(held: &Option<T>, request: &mut Vec<u8>) {
        put_option(held.as_ref(), request);
    }
    fn read_request(request: &mut Request<'_>) -> Result<Option<T>, Malformed> {
        get_option(&mut request.arguments)
    }
}

/// Appends a flag, and the value if there is one.
fn put_option<T: Plain>(value: Option<&T>, buffer: &mut Vec<u8>) {
    buffer.push(u8::from(value.is_some()));
    if let Some(value) = value {
        value.put(buffer);
    }
}

/// Reads an option written by [`put_option`].
fn get_option<T: Plain>(reader: &mut Reader<'_>) -> Result<Option<T>, Malformed> {
    if reader.get::<u8>()? == 0 { Ok(None) } else { reader.get().map(Some) }
}

/// A pointer to exactly one `T` that is read and written: for the host `Option<&mut T>`.
///
/// The value is written back after the method has returned without [`Stop`], even if it is unchanged.
#[derive(Debug)]
pub struct InOut<T>(std::marker::PhantomData<T>);

impl<T: Plain> Param for InOut<T> {
    type Abi = *mut T;
    type Storage = Option<T>;
    type View<'a> = Option<&'a mut T>;

    unsafe fn take(abi: *mut T) -> Option<T> {
        // SAFETY: not null, and the caller vouches that it can be read; C may have aligned it badly.
        (!abi.is_null()).then(|| unsafe { abi.read_unaligned() })
    }
    fn view(held: &mut Option<T>) -> Option<&mut T> {
        held.as_mut()
    }
    unsafe fn give(abi: *mut T, held: Option<T>) {
        if let Some(value) = held {
            // SAFETY: held only if not null, and the caller vouches that it can be written.
            unsafe { abi.write_unaligned(value) };
        }
    }
    fn show(held: &Option<T>, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(if held.is_some() { "..." } else { "NULL" })
    }
    fn write_request(held: &Option<T>, request: &mut Vec<u8>) {
        put_option(held.as_ref(), request);
    }
    fn read_request(request: &mut Request<'_>) -> Result<Option<T>, Malformed> {
        get_option(&mut request.arguments)
    }
    fn write_reply(held: &Option<T>, reply: &mut Vec<u8>) {
        put_option(held.as_ref(), reply);
    }
    fn read_reply(held: &mut Option<T>, reply: &mut Reader<'_>) -> Result<(), Malformed> {
        // The value is kept only if there is a pointer to write it to.
        if let (Some(held), Some(value)) = (held.as_mut(), get_option(reply)?) {
            *held = value;
        }
        Ok(())
    }
}

/// A pointer to exactly one `T` that is written: the host gets `&mut Out<T>` and [sets](Self::set) the value.
///
/// The thunk writes it after the method has returned without [`Stop`]; a value that was not set leaves the program's
/// variable unchanged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Out<T> {
    is_null: bool,
    value: Option<T>,
}

impl<T> Out<T> {
    /// Output for a valid pointer.
    pub const fn wanted() -> Self {
        Self { is_null: false, value: None }
    }

    /// Output for a null pointer.
    pub const fn null() -> Self {
        Self { is_null: true, value: None }
    }

    /// Returns true if the program passed a null pointer.
    pub fn is_null(&self) -> bool {
        self.is_null
    }

    /// Sets the value to be written; without effect on a null pointer.
    pub fn set(&mut self, value: T) {
        self.value = Some(value);
    }

    /// The value that has been set.
    pub fn value(&self) -> Option<&T> {
        self.value.as_ref()
    }
}

impl<T: Plain + ShowOut> Param for Out<T> {
    type Abi = *mut T;
    type Storage = Self;
    type View<'a> = &'a mut Self;

    unsafe fn take(abi: *mut T) -> Self {
        Self { is_null: abi.is_null(), value: None }
    }
    fn view(held: &mut Self) -> &mut Self {
        held
    }
    unsafe fn give(abi: *mut T, held: Self) {
        if let (false, Some(value)) = (held.is_null, held.value) {
            // SAFETY: not null, and the caller vouches that it can be written; C may have aligned it badly.
            unsafe { abi.write_unaligned(value) };
        }
    }
    fn show(held: &Self, f: &mut Formatter<'_>) -> fmt::Result {
        match &held.value {
            _ if held.is_null => f.write_str("NULL"),
            Some(value) => {
                f.write_str("&")?;
                value.show_out(f)
            }
            None => f.write_str("&?"),
        }
    }
    fn write_request(held: &Self, request: &mut Vec<u8>) {
        request.push(u8::from(!held.is_null));
    }
    fn read_request(request: &mut Request<'_>) -> Result<Self, Malformed> {
        Ok(Self { is_null: request.arguments.get::<u8>()? == 0, value: None })
    }
    fn write_reply(held: &Self, reply: &mut Vec<u8>) {
        put_option(held.value.as_ref(), reply);
    }
    fn read_reply(held: &mut Self, reply: &mut Reader<'_>) -> Result<(), Malformed> {
        held.value = get_option(reply)?;
        Ok(())
    }
}

/// Formatting of output values for a log of calls.
pub trait ShowOut {
    /// Writes the value.
    ///
    /// # Errors
    /// Errors of the formatter.
    fn show_out(&self, f: &mut Formatter<'_>) -> fmt::Result;
}

macro_rules! shown_as_itself {
    ($($number:ty),*) => {$(
        impl ShowOut for $number {
            fn show_out(&self, f: &mut Formatter<'_>) -> fmt::Result {
                self.fmt(f)
            }
        }
    )*};
}
shown_as_itself!(u8, i32, u32, f32);

impl<T, const N: usize> ShowOut for [T; N] {
    fn show_out(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("...")
    }
}

/// Length of the longest bytes that are shown as a text: those of a radio message. Longer ones are images and samples.
const LONGEST_TEXT: usize = 1024;

/// Buffer for bytes, with its capacity: the host gets `&mut OutBytes` and [sets](Self::set) the bytes.
///
/// The thunk writes as many as fit, after the method has returned without [`Stop`]; the rest of the buffer is
/// unchanged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutBytes {
    is_null: bool,
    capacity: usize,
    bytes: Vec<u8>,
}

impl OutBytes {
    /// Buffer with a capacity in bytes.
    pub const fn with_capacity(capacity: usize) -> Self {
        Self { is_null: false, capacity, bytes: Vec::new() }
    }

    /// Output for a null pointer.
    pub const fn null() -> Self {
        Self { is_null: true, capacity: 0, bytes: Vec::new() }
    }

    /// Returns true if the program passed a null pointer.
    pub fn is_null(&self) -> bool {
        self.is_null
    }

    /// Number of bytes that fit; 0 for a null pointer.
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// Sets the bytes to be written and drops those that do not fit. Returns the number that fit.
    pub fn set(&mut self, bytes: &[u8]) -> usize {
        self.bytes.clear();
        self.bytes.extend_from_slice(&bytes[..bytes.len().min(self.capacity)]);
        self.bytes.len()
    }

    /// The bytes that have been set.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

impl Param for OutBytes {
    type Abi = ByteBuffer;
    type Storage = Self;
    type View<'a> = &'a mut Self;

    unsafe fn take(abi: ByteBuffer) -> Self {
        if abi.data.is_null() { Self::null() } else { Self::with_capacity(abi.len) }
    }
    fn view(held: &mut Self) -> &mut Self {
        held
    }
    unsafe fn give(abi: ByteBuffer, held: Self) {
        if !held.bytes.is_empty() {
            // SAFETY: bytes are kept only if there is room for them, so the pointer is not null, and the caller
            // vouches for the length.
            unsafe { std::ptr::copy_nonoverlapping(held.bytes.as_ptr(), abi.data, held.bytes.len()) };
        }
    }
    fn show(held: &Self, f: &mut Formatter<'_>) -> fmt::Result {
        match held.bytes.len() {
            _ if held.is_null => f.write_str("NULL"),
            length if length > LONGEST_TEXT => write!(f, "&[{length} bytes]"),
            _ => write!(f, "&\"{}\"", held.bytes.escape_ascii()),
        }
    }
    fn write_request(held: &Self, request: &mut Vec<u8>) {
        put_capacity((!held.is_null).then_some(held.capacity), request);
    }
    fn read_request(request: &mut Request<'_>) -> Result<Self, Malformed> {
        Ok(get_capacity(&mut request.arguments)?.map_or(Self::null(), Self::with_capacity))
    }
    fn write_reply(held: &Self, reply: &mut Vec<u8>) {
        put_bytes(Some(&held.bytes), reply);
    }
    fn read_reply(held: &mut Self, reply: &mut Reader<'_>) -> Result<(), Malformed> {
        held.set(reply.bytes()?.unwrap_or_default());
        Ok(())
    }
}

/// Appends a capacity, or the marker of a null pointer.
fn put_capacity(capacity: Option<usize>, buffer: &mut Vec<u8>) {
    capacity.map_or(NULL, |capacity| u32::try_from(capacity).unwrap_or(NULL - 1).min(NULL - 1)).put(buffer);
}

/// Reads a capacity written by [`put_capacity`].
fn get_capacity(reader: &mut Reader<'_>) -> Result<Option<usize>, Malformed> {
    let capacity: u32 = reader.get()?;
    Ok((capacity != NULL).then_some(capacity as usize))
}

/// Buffer for numbers: [`ByteBuffer`] with a capacity of `len` numbers in the ABI; the host gets `&mut OutNumbers` and
/// [sets](Self::set) them. The lists of functions use [`OutInts`] and [`OutFloats`].
///
/// The thunk writes as many as fit, after the method has returned without [`Stop`]; the rest of the buffer is
/// unchanged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutNumbers<T> {
    is_null: bool,
    capacity: usize,
    numbers: Vec<T>,
}

/// Buffer for whole numbers.
pub type OutInts = OutNumbers<i32>;

/// Buffer for floating-point numbers.
pub type OutFloats = OutNumbers<f32>;

impl<T> OutNumbers<T> {
    /// Buffer with a capacity in numbers.
    pub const fn with_capacity(capacity: usize) -> Self {
        Self { is_null: false, capacity, numbers: Vec::new() }
    }

    /// Output for a null pointer.
    pub const fn null() -> Self {
        Self { is_null: true, capacity: 0, numbers: Vec::new() }
    }

    /// Returns true if the program passed a null pointer.
    pub fn is_null(&self) -> bool {
        self.is_null
    }

    /// Number of numbers that fit; 0 for a null pointer.
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// The numbers that have been set.
    pub fn numbers(&self) -> &[T] {
        &self.numbers
    }
}

impl<T: Copy> OutNumbers<T> {
    /// Sets the numbers to be written and drops those that do not fit. Returns the number that fit.
    pub fn set(&mut self, numbers: &[T]) -> usize {
        self.numbers.clear();
        self.numbers.extend_from_slice(&numbers[..numbers.len().min(self.capacity)]);
        self.numbers.len()
    }
}

impl<T: Plain> Param for OutNumbers<T> {
    type Abi = ByteBuffer;
    type Storage = Self;
    type View<'a> = &'a mut Self;

    unsafe fn take(abi: ByteBuffer) -> Self {
        if abi.data.is_null() { Self::null() } else { Self::with_capacity(abi.len) }
    }
    fn view(held: &mut Self) -> &mut Self {
        held
    }
    unsafe fn give(abi: ByteBuffer, held: Self) {
        if !held.numbers.is_empty() {
            let bytes = held.numbers.len() * size_of::<T>();
            // SAFETY: numbers are kept only if there is room for them, so the pointer is not null, and the caller
            // vouches for the length; copied as bytes, as C may have aligned it badly.
            unsafe { std::ptr::copy_nonoverlapping(held.numbers.as_ptr().cast::<u8>(), abi.data, bytes) };
        }
    }
    fn show(held: &Self, f: &mut Formatter<'_>) -> fmt::Result {
        if held.is_null { f.write_str("NULL") } else { write!(f, "&[{} numbers]", held.numbers.len()) }
    }
    fn write_request(held: &Self, request: &mut Vec<u8>) {
        put_capacity((!held.is_null).then_some(held.capacity), request);
    }
    fn read_request(request: &mut Request<'_>) -> Result<Self, Malformed> {
        Ok(get_capacity(&mut request.arguments)?.map_or(Self::null(), Self::with_capacity))
    }
    fn write_reply(held: &Self, reply: &mut Vec<u8>) {
        (held.numbers.len() as u32).put(reply);
        held.numbers.iter().for_each(|number| number.put(reply));
    }
    fn read_reply(held: &mut Self, reply: &mut Reader<'_>) -> Result<(), Malformed> {
        let count: u32 = reply.get()?;
        let numbers: Vec<T> = (0..count).map(|_| reply.get()).collect::<Result<_, _>>()?;
        held.set(&numbers);
        Ok(())
    }
}

/// A function of the program that the host calls later, on the robot's own thread and inside a call of the program.
///
/// Code and data belong to the program and are valid until [`Program::run`](crate::Program::run) has returned.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Callback {
    /// Called with `data`; returns [`Status::STOP`] when the program must end: then the call in progress returns
    /// [`Stop`] too. It never unwinds and never jumps over the host's frames. Null: none.
    pub code: Option<unsafe extern "C" fn(data: *mut c_void) -> Status>,
    /// Passed back to `code`.
    pub data: *mut c_void,
}

// SAFETY: a host only stores the pointers; callers uphold the contract of `call`.
unsafe impl Send for Callback {}
// SAFETY: as for `Send`.
unsafe impl Sync for Callback {}

impl Callback {
    /// No function.
    pub const NONE: Self = Self { code: None, data: std::ptr::null_mut() };

    /// Calls the program's function, if there is one.
    ///
    /// # Errors
    /// [`Stop`] when the program must end: the call in progress must return it.
    ///
    /// # Safety
    /// The program is still inside its `run`, in a call that this thread carries out for the robot that passed the
    /// callback, and the host holds no lock that a call needs.
    pub unsafe fn call(self) -> Result<(), Stop> {
        let Some(code) = self.code else { return Ok(()) };
        // SAFETY: the caller vouches for the time and the thread; the shim that made the pair vouches for code and
        // data.
        if unsafe { code(self.data) } == Status::OK { Ok(()) } else { Err(Stop) }
    }
}

impl Param for Callback {
    type Abi = Self;
    type Storage = Self;
    type View<'a> = Option<Self>;

    unsafe fn take(abi: Self) -> Self {
        abi
    }
    fn view(held: &mut Self) -> Option<Self> {
        held.code.map(|_| *held)
    }
    fn show(held: &Self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(if held.code.is_some() { "function" } else { "NULL" })
    }
    fn write_request(held: &Self, request: &mut Vec<u8>) {
        (held.code.map_or(0, |code| code as usize) as u64).put(request);
        (held.data.expose_provenance() as u64).put(request);
    }
    fn read_request(request: &mut Request<'_>) -> Result<Self, Malformed> {
        let (code, data): (u64, u64) = (request.arguments.get()?, request.arguments.get()?);
        Ok(if code == 0 { Self::NONE } else { (request.callback)(code, data) })
    }
}

/// An argument, displayed for a log of calls.
pub(crate) struct ShownArgument<'a, P: Param>(pub &'a P::Storage);

impl<P: Param> Display for ShownArgument<'_, P> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        P::show(self.0, f)
    }
}

/// A result, displayed for a log of calls.
pub(crate) struct ShownResult<R>(pub R);

impl<R: Return> Display for ShownResult<R> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.0.show(f)
    }
}
