//! Builds C programs with the system's compiler and runs them in a small host that records their calls.

#![allow(dead_code, reason = "each test file uses a part")]

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::ffi::{CString, c_char, c_int, c_void};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::ptr::{from_ref, null};
use std::sync::{Mutex, OnceLock};

use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
use robios_sys::c;
use robios_sys::robios6::*;
use robios_sys::{
    CallContext, CallRecord, Callback, Host, In, InOut, Out, OutBytes, PROGRAM_SYMBOL, Program, Robios6, Robios6Table,
    Stop, Support, SupportTable, support,
};

/// Returns true if there is a C compiler; otherwise prints why the test is skipped.
pub fn has_compiler() -> bool {
    static HAS: OnceLock<bool> = OnceLock::new();
    let has = *HAS.get_or_init(|| Command::new("cc").arg("--version").output().is_ok_and(|out| out.status.success()));
    if !has {
        println!("skipped: there is no C compiler `cc`");
    }
    has
}

/// A folder with the files of the C side for RoBIOS 6.
pub fn folder() -> tempfile::TempDir {
    folder_with(c::HEADERS6)
}

/// A folder with these headers and the shim.
pub fn folder_with(headers: &[c::SourceFile]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("the temporary folder is writable");
    for file in headers.iter().chain(c::SHIM) {
        let path = folder.path().join(file.name);
        std::fs::create_dir_all(path.parent().expect("a file has a folder")).expect("the temporary folder is writable");
        std::fs::write(path, file.text).expect("the temporary folder is writable");
    }
    folder
}

/// Runs the compiler in a folder.
///
/// # Panics
/// If the compiler fails or warns, with its messages.
pub fn compile(folder: &Path, arguments: &[&str]) {
    let compiler = if arguments.iter().any(|argument| argument.starts_with("-std=c++")) { "c++" } else { "cc" };
    let output = Command::new(compiler).current_dir(folder).args(arguments).output().expect("the compiler can be run");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.is_empty(), "{compiler} {}:\n{said}", arguments.join(" "));
}

/// The shim's object file for the flags, compiled once in each test process.
fn shim(flags: &[&str]) -> String {
    static COMPILED: Mutex<BTreeMap<String, String>> = Mutex::new(BTreeMap::new());
    let mut compiled = COMPILED.lock().expect("nobody panics while compiling the shim");
    let (key, number) = (flags.concat(), compiled.len());
    let object = compiled.entry(key).or_insert_with(|| {
        let object = format!("{}/shim-{}-{number}.o", env!("CARGO_TARGET_TMPDIR"), std::process::id());
        let arguments = ["-Wall", "-Wextra", "-I.", "-c", c::SHIM_SOURCE, "-o", &object];
        compile(folder().path(), &[c::SHIM_FLAGS, flags, &arguments].concat());
        object
    });
    object.clone()
}

/// A program's library, whose file is removed when the value is dropped.
pub struct Built {
    folder: tempfile::TempDir,
    library: PathBuf,
}

/// Builds a program from the texts of C files. `flags` apply to these files, `shim_flags` to the shim.
pub fn build(files: &[&str], flags: &[&str], shim_flags: &[&str]) -> Built {
    let folder = folder();
    let mut objects = vec![shim(shim_flags)];
    for (index, text) in files.iter().enumerate() {
        let (source, object) = (format!("program{index}.c"), format!("program{index}.o"));
        std::fs::write(folder.path().join(&source), text).expect("the temporary folder is writable");
        compile(folder.path(), &[c::COMPILE_FLAGS, flags, &["-I.", "-c", &source, "-o", &object]].concat());
        objects.push(object);
    }
    let objects: Vec<_> = objects.iter().map(String::as_str).collect();
    compile(folder.path(), &[c::LINK_FLAGS, &objects, c::LIBRARIES, &["-o", "program.so"]].concat());
    let library = folder.path().join("program.so");
    Built { folder, library }
}

impl Built {
    /// Runs a private copy of the program for a robot; returns the exit code and the robot.
    pub fn run(&self, robot: Robot, arguments: &[&str]) -> (c_int, Robot) {
        static COPIES: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let number = COPIES.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let copy = self.folder.path().join(format!("copy{number}.so"));
        std::fs::copy(&self.library, &copy).expect("the temporary folder is writable");
        // SAFETY: loading the library runs only the constructors of the shim and of the program.
        let library = unsafe { Library::open(Some(&copy), RTLD_NOW | RTLD_LOCAL) }.expect("the program can be loaded");
        // SAFETY: the shim defines the symbol with this type.
        let program = unsafe { library.get::<*const Program>(PROGRAM_SYMBOL.as_bytes()) }.expect("the symbol exists");
        // SAFETY: it points to a constant of the library, which is still loaded.
        let program = unsafe { &**program };
        program.check().expect("built with this crate");
        let arguments: Vec<_> =
            ["program"].iter().chain(arguments).map(|a| CString::new(*a).expect("no 0 in arguments")).collect();
        let mut pointers: Vec<*const c_char> = arguments.iter().map(|a| a.as_ptr()).collect();
        pointers.push(null());
        let context: *mut c_void = from_ref(&robot).cast_mut().cast();
        // SAFETY: host, robot and arguments live until `run` has returned.
        let code = unsafe { (program.run)(&HOST, context, arguments.len() as c_int, pointers.as_ptr()) };
        (code, robot)
    }

    /// The library's file.
    pub fn path(&self) -> &Path {
        &self.library
    }
}

static SUPPORT: SupportTable = SupportTable::of::<Robot>();
static ROBIOS6: Robios6Table = Robios6Table::of::<Robot>();
static HOST: Host = Host::of_robios6(&SUPPORT, &ROBIOS6);

/// One robot of the small host.
#[derive(Default)]
pub struct Robot {
    /// Seeds its random numbers.
    pub number: u64,
    /// Calls of RoBIOS, as logged.
    pub calls: RefCell<Vec<String>>,
    /// Standard output and error: one entry for each call of `console`.
    pub out: RefCell<Vec<String>>,
    pub err: RefCell<Vec<String>>,
    /// Arguments of `failed`.
    pub failures: RefCell<Vec<(i32, String)>>,
    pub now_us: Cell<i64>,
    /// Stops the program at the first call at or after this time; 0: never.
    pub stop_at_us: i64,
    /// Timer function, called at each tick during an `OSWait`.
    pub timer: Cell<Option<Callback>>,
    pub seeds: RefCell<BTreeMap<u32, (u64, u64)>>,
}

impl Robot {
    /// A robot with its number.
    pub fn numbered(number: u64) -> Self {
        Self { number, ..Self::default() }
    }

    /// Text printed on standard output.
    pub fn printed(&self) -> String {
        self.out.borrow().concat()
    }

    fn advance(&self, span_us: i64) -> Result<(), Stop> {
        self.now_us.set(self.now_us.get().saturating_add(span_us));
        if self.stop_at_us > 0 && self.now_us.get() >= self.stop_at_us { Err(Stop) } else { Ok(()) }
    }
}

impl CallContext for Robot {
    fn is_logging(&self) -> bool {
        true
    }
    fn log_call(&self, record: &CallRecord<'_>) {
        if Robios6Call::from_name(record.name).is_some() {
            self.calls.borrow_mut().push(record.to_string());
        }
    }
}

impl Support for Robot {
    fn console(&self, stream: i32, bytes: Option<&[u8]>) -> Result<i32, Stop> {
        let text = String::from_utf8_lossy(bytes.expect("the shim passes bytes")).into_owned();
        let lines = if stream == support::stream::OUT { &self.out } else { &self.err };
        lines.borrow_mut().push(text);
        self.advance(1)?;
        Ok(0)
    }
    fn random(&self, purpose: u32) -> Result<u64, Stop> {
        let mut seeds = self.seeds.borrow_mut();
        let (seed, drawn) = seeds.entry(purpose).or_insert((0, 0));
        *drawn += 1;
        // Any mixing function is good enough here.
        let mut x = (self.number << 48) ^ (u64::from(purpose) << 40) ^ (*seed << 20) ^ *drawn;
        for _ in 0..3 {
            x = (x ^ (x >> 31)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        }
        Ok(x ^ (x >> 29))
    }
    fn seed(&self, purpose: u32, seed: u64) -> Result<i32, Stop> {
        self.seeds.borrow_mut().insert(purpose, (seed + 1, 0));
        Ok(0)
    }
    fn time_us(&self) -> Result<i64, Stop> {
        self.advance(1)?;
        Ok(self.now_us.get())
    }
    fn sleep_us(&self, span_us: i64) -> Result<i32, Stop> {
        self.advance(span_us.max(0))?;
        Ok(0)
    }
    fn failed(&self, kind: i32, text: Option<&[u8]>, _: Option<&[u8]>) -> Result<i32, Stop> {
        let text = String::from_utf8_lossy(text.unwrap_or_default()).into_owned();
        self.failures.borrow_mut().push((kind, text));
        Ok(0)
    }
    fn program_name(&self, name: &mut OutBytes) -> Result<i32, Stop> {
        Ok(name.set(b"square") as i32)
    }
}

impl Robios6 for Robot {
    fn OSVersion(&self, text: &mut OutBytes) -> Result<i32, Stop> {
        Ok(text.set(b"6.5") as i32)
    }
    fn OSMachineID(&self) -> Result<u8, Stop> {
        Ok(self.number as u8)
    }
    fn LCDPrintf(&self, text: Option<&[u8]>) -> Result<i32, Stop> {
        Ok(if text.is_some() { 0 } else { -1 })
    }
    fn LCDPutString(&self, s: Option<&[u8]>) -> Result<i32, Stop> {
        Ok(if s.is_some() { 0 } else { -1 })
    }
    fn OSGetTime(
        &self,
        h: &mut Out<i32>,
        m: &mut Out<i32>,
        s: &mut Out<i32>,
        ticks: &mut Out<i32>,
    ) -> Result<i32, Stop> {
        for (out, value) in [(h, 1), (m, 2), (s, 3), (ticks, 4)] {
            out.set(value);
        }
        Ok(0)
    }
    fn VWInit(&self, _: i32, _: i32) -> Result<i32, Stop> {
        Ok(1)
    }
    fn VWDriveStraight(&self, handle: i32, _: f32, _: f32) -> Result<i32, Stop> {
        Ok(if handle == 1 { 0 } else { -1 })
    }
    fn VWGetPosition(&self, _: i32, pos: &mut Out<PositionType>) -> Result<i32, Stop> {
        if pos.is_null() {
            return Ok(-1);
        }
        pos.set(PositionType { x: 1.5, y: -2.5, phi: 0.5 });
        Ok(0)
    }
    fn OSAttachTimer(&self, _: i32, f: Option<Callback>) -> Result<i32, Stop> {
        self.timer.set(f);
        Ok(i32::from(f.is_some()))
    }
    fn OSWait(&self, n: i32) -> Result<i32, Stop> {
        for _ in 0..n {
            self.advance(10_000)?;
            if let Some(timer) = self.timer.get() {
                // SAFETY: inside a call of the program that passed it, on its thread, with nothing borrowed.
                unsafe { timer.call() }?;
            }
        }
        Ok(0)
    }
    fn OSGetCount(&self) -> Result<i32, Stop> {
        Ok((self.now_us.get() / 10_000) as i32)
    }
    fn IPLaplace(&self, src: Option<&Image>, dest: &mut Out<Image>) -> Result<i32, Stop> {
        let Some(src) = src else { return Ok(-1) };
        dest.set(src.map(|row| row.map(|grey| 255 - grey)));
        Ok(0)
    }
    fn LCDPutColorGraphic(&self, buf: Option<&mut ColImage>) -> Result<i32, Stop> {
        let Some(buf) = buf else { return Ok(-1) };
        buf[61][81] = [7, 8, 9];
        Ok(0)
    }
    fn HDT_FindEntry(&self, type_id: i32, semantics: i32, entry: &mut Out<HDTEntry>) -> Result<i32, Stop> {
        if semantics != semantics::PSD_FRONT {
            return Ok(0);
        }
        entry.set(HDTEntry { type_id, semantics, name: *b"front\0\0\0\0\0\0\0\0\0\0\0" });
        Ok(1)
    }
    fn RADIORecv(&self, id: &mut Out<u8>, received: &mut Out<i32>, buffer: &mut OutBytes) -> Result<i32, Stop> {
        id.set(9);
        received.set(buffer.set(b"hello") as i32);
        Ok(0)
    }
    fn AUPlaySample(&self, sample: Option<&[u8]>) -> Result<i32, Stop> {
        Ok(sample.map_or(0, |sample| sample.len() as i32))
    }
}

/// Uses the marker types, so that a change of their names breaks this test too.
pub type Markers = (In<Image>, InOut<ColImage>);
