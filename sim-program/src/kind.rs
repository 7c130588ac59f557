//! Determines the kind of a file from its bytes: a library for this system, a program for another system, or another
//! file.

use object::elf;
use object::read::elf::ProgramHeader as _;

/// The kind of a file that a program reference names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A shared library for this system and processor.
    Library,
    /// A file that the simulator cannot load; the text completes "it is ...".
    Foreign(String),
}

/// Number of bytes at the start of a file that [`file_kind`] needs.
pub const HEAD_BYTES: usize = 64 * 1024;

/// The kind of a file, from its first bytes ([`HEAD_BYTES`] of them are enough).
pub fn file_kind(head: &[u8]) -> FileKind {
    match head {
        [] => FileKind::Foreign("an empty file".into()),
        [0x7f, b'E', b'L', b'F', ..] => elf_kind(head),
        _ => FileKind::Foreign(foreign_kind(head)),
    }
}

fn foreign_kind(head: &[u8]) -> String {
    let windows = || {
        let cygwin = [&b"cygwin1.dll"[..], b"CYGWIN1.DLL"].iter().any(|name| contains(head, name));
        let kind = if cygwin { "a Windows (Cygwin) library or program" } else { "a Windows library or program" };
        kind.to_owned()
    };
    match head {
        [b'M', b'Z', ..] => windows(),
        [0xfe, 0xed, 0xfa, 0xce | 0xcf, ..] | [0xce | 0xcf, 0xfa, 0xed, 0xfe, ..] => {
            "a macOS library or program".into()
        }
        [0xca, 0xfe, 0xba, 0xbe, 0, 0, 0, 1..=20, ..] => "a macOS universal library or program".into(),
        [0xca, 0xfe, 0xba, 0xbe, ..] => "a Java class file".into(),
        [b'!', b'<', b'a', b'r', b'c', b'h', b'>', b'\n', ..] => "an archive of object files (`.a`)".into(),
        [0, b'a', b's', b'm', ..] => "a WebAssembly module".into(),
        [0x01, 0x50, ..] => "a 68k COFF program".into(),
        [0x00, _, 0x01, 0x07 | 0x08 | 0x0b, ..] => "an a.out program".into(),
        [b'B', b'C', 0xc0, 0xde, ..] => "LLVM bitcode".into(),
        [b'P', b'K', 3, 4, ..] => "a zip archive".into(),
        [0x1f, 0x8b, ..] => "a gzip archive".into(),
        [b'#', b'!', ..] => "a script".into(),
        _ if is_record(head, b"S", b"0123456789") => "a 68k program in S-records (the robot's `.hex`)".into(),
        _ if is_record(head, b":", b"0123456789abcdefABCDEF") => "a program in Intel hex".into(),
        _ if is_text(head) => "a text file".into(),
        _ => "of an unknown kind".into(),
    }
}

/// Returns true if the first line is `start`, one of `next`, and hex digits to its end, as in S-record and Intel hex
/// files.
fn is_record(head: &[u8], start: &[u8], next: &[u8]) -> bool {
    let line = head.split(|&byte| byte == b'\n' || byte == b'\r').next().unwrap_or_default();
    line.len() >= 8
        && line.strip_prefix(start).is_some_and(|rest| {
            next.contains(&rest[0]) && rest.trim_ascii_end().iter().all(|byte| byte.is_ascii_hexdigit())
        })
}

fn is_text(head: &[u8]) -> bool {
    !head.iter().any(|&byte| byte < 0x20 && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0c | 0x1a | 0x1b))
}

fn contains(bytes: &[u8], part: &[u8]) -> bool {
    bytes.windows(part.len()).any(|window| window == part)
}

fn elf_kind(head: &[u8]) -> FileKind {
    let (is_64_bit, is_little_endian) = match head.get(4..6) {
        Some([elf::ELFCLASS32, elf::ELFDATA2LSB]) => (false, true),
        Some([elf::ELFCLASS32, elf::ELFDATA2MSB]) => (false, false),
        Some([elf::ELFCLASS64, elf::ELFDATA2LSB]) => (true, true),
        Some([elf::ELFCLASS64, elf::ELFDATA2MSB]) => (true, false),
        _ => return FileKind::Foreign("a broken ELF file".into()),
    };
    let half = |offset: usize| {
        let bytes = [*head.get(offset)?, *head.get(offset + 1)?];
        Some(if is_little_endian { u16::from_le_bytes(bytes) } else { u16::from_be_bytes(bytes) })
    };
    let (Some(kind), Some(machine)) = (half(16), half(18)) else {
        return FileKind::Foreign("a broken ELF file".into());
    };
    let is_native = is_64_bit == cfg!(target_pointer_width = "64")
        && is_little_endian == cfg!(target_endian = "little")
        && machine == native_machine();
    let machine = machine_name(machine, is_64_bit);
    match kind {
        elf::ET_DYN if is_native && !has_interpreter(head) => FileKind::Library,
        elf::ET_REL => FileKind::Foreign(format!("an object file (`.o`) for {machine}, not linked to a library")),
        elf::ET_EXEC => {
            FileKind::Foreign(format!("an executable for {machine}, as EyeSim VR runs them, and no library"))
        }
        elf::ET_DYN if has_interpreter(head) => {
            FileKind::Foreign(format!("an executable for {machine}, as EyeSim VR runs them, and no library"))
        }
        elf::ET_CORE => FileKind::Foreign("a core dump".into()),
        _ => {
            FileKind::Foreign(format!("a library for {machine}, and this is {}", machine_name(native_machine(), true)))
        }
    }
}

/// Returns true if an ELF file names an interpreter, as executables do, position-independent ones included.
fn has_interpreter(head: &[u8]) -> bool {
    let has_interp_segment = |headers: Option<Vec<u32>>| headers.is_some_and(|types| types.contains(&elf::PT_INTERP));
    has_interp_segment(segment_types::<elf::FileHeader64<object::Endianness>>(head))
        || has_interp_segment(segment_types::<elf::FileHeader32<object::Endianness>>(head))
}

fn segment_types<Header: object::read::elf::FileHeader>(head: &[u8]) -> Option<Vec<u32>> {
    let header = Header::parse(head).ok()?;
    let endian = header.endian().ok()?;
    let segments = header.program_headers(endian, head).ok()?;
    Some(segments.iter().map(|segment| segment.p_type(endian)).collect())
}

/// The ELF machine number of this binary's processor.
const fn native_machine() -> u16 {
    if cfg!(target_arch = "x86_64") {
        elf::EM_X86_64
    } else if cfg!(target_arch = "aarch64") {
        elf::EM_AARCH64
    } else if cfg!(target_arch = "riscv64") {
        elf::EM_RISCV
    } else if cfg!(target_arch = "arm") {
        elf::EM_ARM
    } else if cfg!(target_arch = "x86") {
        elf::EM_386
    } else {
        elf::EM_NONE
    }
}

fn machine_name(machine: u16, is_64_bit: bool) -> String {
    match machine {
        elf::EM_X86_64 => "x86-64".into(),
        elf::EM_AARCH64 => "64-bit ARM".into(),
        elf::EM_ARM => "32-bit ARM (as in EyeBot 7)".into(),
        elf::EM_386 => "32-bit x86".into(),
        elf::EM_68K => "the 68k (as in EyeBot 1 to 5)".into(),
        elf::EM_RISCV => format!("{}-bit RISC-V", if is_64_bit { 64 } else { 32 }),
        other => format!("the processor with ELF number {other}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(head: &[u8], expected: &str) {
        match file_kind(head) {
            FileKind::Foreign(what) => assert!(what.contains(expected), "`{what}` does not say `{expected}`"),
            FileKind::Library => panic!("taken for a library of this system, expected `{expected}`"),
        }
    }

    fn elf(class: u8, data: u8, kind: u16, machine: u16) -> Vec<u8> {
        let half = |value: u16| if data == elf::ELFDATA2LSB { value.to_le_bytes() } else { value.to_be_bytes() };
        let mut head = vec![0x7f, b'E', b'L', b'F', class, data, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        head.extend(half(kind));
        head.extend(half(machine));
        head
    }

    #[test]
    fn files_of_other_systems_are_described() {
        check(b"", "empty");
        check(b"MZ\x90\0\x03", "a Windows library");
        check(b"MZ\x90\0\x03 .... cygwin1.dll", "Cygwin");
        check(b"\xcf\xfa\xed\xfe\x07\0\0\x01", "macOS");
        check(b"S00600004844521B\r\nS1130000285F245F2212226A000424290008237C2A\r\n", "S-records");
        check(b":10010000214601360121470136007EFE09D2190140\n", "Intel hex");
        check(b"!<arch>\n/ 0 ", "archive");
        check(b"#!/usr/bin/env python\n", "script");
        check(b"hello, robots\n", "text file");
        check(b"Speed is not an S-record\n", "text file");
        check(b"\x01\x02\x00\x00", "unknown");
        check(b"\x7fELF", "broken ELF");
    }

    #[test]
    fn elf_files_are_described_by_machine_and_kind() {
        check(&elf(1, elf::ELFDATA2MSB, elf::ET_EXEC, elf::EM_68K), "executable for the 68k");
        check(&elf(1, elf::ELFDATA2LSB, elf::ET_DYN, elf::EM_ARM), "32-bit ARM");
        check(&elf(2, elf::ELFDATA2LSB, elf::ET_REL, native_machine()), "object file");
        let native = elf(2, elf::ELFDATA2LSB, elf::ET_DYN, native_machine());
        assert_eq!(file_kind(&native), FileKind::Library);
    }

    #[test]
    fn position_independent_executable_is_not_a_library() {
        let path = std::env::current_exe().expect("this program");
        let head = std::fs::read(path).expect("its bytes");
        check(&head[..HEAD_BYTES], "an executable for");
    }
}
