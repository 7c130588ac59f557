//! Hides a library's constructors from the dynamic linker, so that they run as a part of the program.
//!
//! Constructors of static C++ objects may call RoBIOS, print and throw, but while the library is being loaded there is
//! neither a robot nor a thread that may loop or crash. The shim therefore calls them when the robot's program starts;
//! for Rust programs the host calls them.

use std::ffi::{c_char, c_int};
use std::fs;
use std::io;
use std::path::Path;
use std::ptr;

use object::elf;
use object::read::elf::{Dyn as _, FileHeader as _, ProgramHeader as _};
use robios_sys::CONSTRUCTOR_TAGS;

/// Hides the constructors of the library at `path`, see [`hide`].
///
/// # Errors
/// The file cannot be read or written, or is not a library of this system.
pub fn defer_constructors(path: &Path) -> io::Result<()> {
    let mut bytes = fs::read(path)?;
    hide(&mut bytes).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
    fs::write(path, bytes)
}

/// Replaces the tags `DT_INIT_ARRAY` and `DT_INIT_ARRAYSZ` in the bytes of a library by [`CONSTRUCTOR_TAGS`].
///
/// # Errors
/// The bytes are not a library of this system.
pub fn hide(bytes: &mut [u8]) -> Result<(), object::Error> {
    for (offset, tag) in constructor_tags(bytes)? {
        bytes[offset..offset + 8].copy_from_slice(&u64::from(tag).to_ne_bytes());
    }
    Ok(())
}

/// Runs the hidden constructors of the library at `base`, which has no shim for this, on this thread; does nothing if
/// there are none. Their arguments are empty.
///
/// # Safety
/// A library of this system is mapped at `base`, as the dynamic linker does it, and stays mapped; its constructors have
/// not run.
pub unsafe fn run_hidden(base: usize) {
    type Constructor = unsafe extern "C" fn(c_int, *const *const c_char, *const *const c_char);
    type Word = elf::Dyn64<object::Endianness>;
    let endian = object::Endianness::default();
    let pointer_to = ptr::with_exposed_provenance::<u8>;
    // SAFETY: the file's header begins the first mapping, and the program headers follow it there; the dynamic section
    // is mapped where they say and ends with a null tag. These addresses, laid out for the kernel, satisfy the
    // alignment of the types.
    unsafe {
        let header = &*pointer_to(base).cast::<elf::FileHeader64<object::Endianness>>();
        let headers =
            pointer_to(base + header.e_phoff(endian) as usize).cast::<elf::ProgramHeader64<object::Endianness>>();
        let headers = std::slice::from_raw_parts(headers, header.e_phnum(endian).into());
        let Some(dynamic) = headers.iter().find(|header| header.p_type(endian) == elf::PT_DYNAMIC) else { return };
        let mut entry = pointer_to(base + dynamic.p_vaddr(endian) as usize).cast::<Word>();
        let (mut start, mut size) = (0, 0);
        while (*entry).d_tag.get(endian) != elf::DT_NULL {
            let value = (*entry).d_val.get(endian) as usize;
            match u32::try_from((*entry).d_tag.get(endian)) {
                Ok(tag) if tag == CONSTRUCTOR_TAGS[0] => start = value,
                Ok(tag) if tag == CONSTRUCTOR_TAGS[1] => size = value,
                _ => {}
            }
            entry = entry.add(1);
        }
        let constructors = pointer_to(base + start).cast::<Option<Constructor>>();
        let empty_list = [ptr::null()];
        for index in 0..size / size_of::<Constructor>() {
            if let Some(constructor) = *constructors.add(index) {
                constructor(0, empty_list.as_ptr(), empty_list.as_ptr());
            }
        }
    }
}

/// Offsets of the constructors' tags in the file, and their replacements.
fn constructor_tags(bytes: &[u8]) -> Result<Vec<(usize, u32)>, object::Error> {
    let header = elf::FileHeader64::<object::Endianness>::parse(bytes)?;
    let endian = header.endian()?;
    let mut tags = Vec::new();
    for segment in header.program_headers(endian, bytes)? {
        let start = segment.p_offset(endian) as usize;
        for (index, entry) in segment.dynamic(endian, bytes)?.unwrap_or_default().iter().enumerate() {
            let tag = match entry.d_tag(endian) {
                elf::DT_INIT_ARRAY => CONSTRUCTOR_TAGS[0],
                elf::DT_INIT_ARRAYSZ => CONSTRUCTOR_TAGS[1],
                _ => continue,
            };
            tags.push((start + index * size_of::<elf::Dyn64<object::Endianness>>(), tag));
        }
    }
    Ok(tags)
}
