//! Landlock: the files that a restricted process may read, run and write, its TCP ports, and the reach of its signals.

use std::ffi::CString;
use std::fs::File;
use std::io;
use std::os::fd::{AsRawFd as _, FromRawFd as _, OwnedFd};
use std::os::unix::ffi::OsStrExt as _;
use std::path::Path;

use landlock::{
    ABI, Access as _, AccessFs, AccessNet, BitFlags, PathBeneath, PathFd, Ruleset, RulesetAttr as _, RulesetCreated,
    RulesetCreatedAttr as _, Scope,
};

use super::Grant;

/// Newest version of Landlock whose rights are requested. Older kernels support fewer rights;
/// [`Kernel`](super::Kernel) determines whether these suffice.
const VERSION: ABI = ABI::V7;

/// Folders of the system with libraries, headers and tools.
const SYSTEM: [&str; 9] = ["/usr", "/lib", "/lib64", "/lib32", "/libx32", "/bin", "/sbin", "/nix/store", "/gnu/store"];

/// Files of the system that libraries and interpreters read.
const SYSTEM_FILES: [&str; 14] = [
    "/etc/alternatives",
    "/etc/ld.so.cache",
    "/etc/ld.so.conf",
    "/etc/ld.so.conf.d",
    "/etc/localtime",
    "/etc/locale.alias",
    "/dev/urandom",
    "/dev/random",
    "/proc/cpuinfo",
    "/proc/meminfo",
    "/proc/filesystems",
    "/proc/sys/vm/overcommit_memory",
    "/sys/devices/system/cpu",
    "/sys/kernel/mm/transparent_hugepage",
];

/// Devices that any process may write to.
const DEVICES: [&str; 3] = ["/dev/null", "/dev/zero", "/dev/full"];

/// Opens the file `name` in `folder` for reading, on behalf of a program that must not leave the folder, neither by
/// `..` nor by an absolute name nor by a link. Does not wait for the other end of a pipe.
///
/// # Errors
/// Errors of the system, also for a name that leads out of the folder.
pub fn open_beneath(folder: &Path, name: &Path) -> io::Result<File> {
    let folder = File::open(folder)?;
    let name = CString::new(name.as_os_str().as_bytes())?;
    // SAFETY: `open_how` is plain data, for which zeros are a value.
    let mut how: libc::open_how = unsafe { std::mem::zeroed() };
    how.flags = (libc::O_RDONLY | libc::O_CLOEXEC | libc::O_NONBLOCK) as u64;
    how.resolve = libc::RESOLVE_BENEATH | libc::RESOLVE_NO_MAGICLINKS;
    let size = size_of_val(&how);
    // SAFETY: the descriptor is open, the name ends in 0, the arguments have their size; a descriptor that is not
    // negative is new and has no other owner.
    unsafe {
        match libc::syscall(libc::SYS_openat2, folder.as_raw_fd(), name.as_ptr(), &raw const how, size) {
            file if file >= 0 => Ok(File::from_raw_fd(file as i32)),
            _ => Err(io::Error::last_os_error()),
        }
    }
}

/// The rules of a process, as a Landlock descriptor.
pub(super) fn rules(grant: &Grant<'_>) -> io::Result<OwnedFd> {
    let read = AccessFs::ReadFile | AccessFs::ReadDir | AccessFs::Execute;
    let all = AccessFs::from_all(VERSION);
    let created = Ruleset::default()
        .handle_access(all)
        .and_then(|rules| rules.handle_access(AccessNet::from_all(VERSION)))
        .and_then(|rules| rules.scope(Scope::from_all(VERSION)))
        .and_then(|rules| rules.create())
        .map_err(io::Error::other)?;
    let exists = |path: &&Path| path.exists();
    let system = SYSTEM.iter().chain(&SYSTEM_FILES).map(Path::new).filter(exists);
    let granted = grant.readable.iter().map(|path| path.as_path()).filter(exists);
    let mut rules = created;
    for path in system.chain(granted) {
        rules = add(rules, path, read)?;
    }
    for path in DEVICES.iter().map(Path::new).filter(exists) {
        rules = add(rules, path, AccessFs::ReadFile | AccessFs::WriteFile)?;
    }
    // Sockets, pipes and devices are not needed in a folder of files.
    let unneeded = AccessFs::MakeChar | AccessFs::MakeBlock | AccessFs::MakeSock | AccessFs::MakeFifo;
    rules = add(rules, grant.scratch, all & !unneeded)?;
    Option::<OwnedFd>::from(rules).ok_or_else(|| io::Error::from_raw_os_error(libc::EOPNOTSUPP))
}

/// Allows `access` to the file, or to all files in the folder, at `path`.
fn add(rules: RulesetCreated, path: &Path, access: BitFlags<AccessFs>) -> io::Result<RulesetCreated> {
    let path_error = |error: &dyn std::fmt::Display| io::Error::other(format!("`{}`: {error}", path.display()));
    let access = if path.is_dir() { access } else { access & AccessFs::from_file(VERSION) };
    let file = PathFd::new(path).map_err(|error| path_error(&error))?;
    rules.add_rule(PathBeneath::new(file, access)).map_err(|error| path_error(&error))
}
