//! Hides a library's constructors from the dynamic linker, so that they run as a part of the program.
//!
//! Constructors of static C++ objects may call RoBIOS, print and throw, but there is no robot yet while the library is loaded. The
//! shim therefore calls them when the robot's program starts.

use std::fs;
use std::io;
use std::path::Path;

use object::elf;
use object::read::elf::{Dyn as _, FileHeader as _, ProgramHeader as _};
use robios_sys::CONSTRUCTOR_TAGS;

/// Replaces the tags `DT_INIT_ARRAY` and `DT_INIT_ARRAYSZ` of the library at `path` by those that the shim looks for.
///
/// # Errors
/// The file cannot be read or written, or is no library of this system.
pub fn defer_constructors(path: &Path) -> io::Result<()> {
    let mut bytes = fs::read(path)?;
    let tags = constructor_tags(&bytes).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
    for (at, tag) in tags {
        bytes[at..at + 8].copy_from_slice(&u64::from(tag).to_ne_bytes());
    }
    fs::write(path, bytes)
}

/// Offsets in the file of the constructors' tags, and their replacements.
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
