//! Detects the features with which the kernel can close areas.

use std::ptr;

use super::{Area, Level, UnsupportedLevel};

/// First version of Landlock that keeps signals within the sandbox.
const SCOPED_SIGNALS: i32 = 6;

/// Features of the running kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kernel {
    /// Version of Landlock's interface, 0 without Landlock.
    pub landlock: i32,
    /// The kernel filters system calls.
    pub has_seccomp: bool,
}

impl Kernel {
    /// Probes the kernel.
    pub fn probe() -> Self {
        // SAFETY: with this flag the call reads no attributes and only returns the version; the second call reads only
        // its own arguments, and fails with EFAULT for the null filter if filters are supported.
        let (landlock, has_seccomp) = unsafe {
            let no_attributes = ptr::null::<libc::c_void>();
            let version = libc::syscall(libc::SYS_landlock_create_ruleset, no_attributes, 0_usize, 1_u32);
            let filter = libc::prctl(libc::PR_SET_SECCOMP, libc::SECCOMP_MODE_FILTER, no_attributes, 0, 0);
            (version, filter < 0 && std::io::Error::last_os_error().raw_os_error() == Some(libc::EFAULT))
        };
        Self { landlock: i32::try_from(landlock).unwrap_or_default().max(0), has_seccomp }
    }

    /// Describes the means that close an area.
    ///
    /// # Errors
    /// The missing feature, if the area cannot be closed.
    pub fn describe_means(&self, area: Area) -> Result<String, &'static str> {
        let landlock = format!("Landlock {}", self.landlock);
        match area {
            Area::Resources => Ok("resource limits".to_owned()),
            _ if !self.has_seccomp => Err("it has no seccomp filters"),
            // Seccomp closes what Landlock does not control, such as modes and times of files.
            Area::Files if self.landlock > 0 => Ok(format!("{landlock}, seccomp")),
            Area::Files => Err("it has no Landlock"),
            Area::Signals if self.landlock >= SCOPED_SIGNALS => Ok(format!("{landlock}, seccomp")),
            Area::Network | Area::Signals | Area::Memory => Ok("seccomp".to_owned()),
        }
    }

    /// Returns true if Landlock keeps the signals of a sandbox within it.
    pub fn has_scoped_signals(&self) -> bool {
        self.landlock >= SCOPED_SIGNALS
    }

    /// The strongest level that the kernel supports.
    pub fn strongest_level(&self) -> Level {
        let is_supported = |level: &Level| level.areas().all(|area| self.describe_means(area).is_ok());
        Level::ALL.into_iter().rev().find(is_supported).unwrap_or(Level::Limits)
    }

    /// Checks that all areas of `level` can be closed.
    ///
    /// # Errors
    /// [`UnsupportedLevel`] with the first area that stays open.
    pub fn check(&self, level: Level) -> Result<(), UnsupportedLevel> {
        let open = level.areas().find_map(|area| Some((area, self.describe_means(area).err()?)));
        match open {
            Some((area, missing)) => Err(UnsupportedLevel { level, area, missing, strongest: self.strongest_level() }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unsupported_level_is_refused_with_the_strongest_one() {
        let modern = Kernel { landlock: 7, has_seccomp: true };
        let old = Kernel { landlock: 0, ..modern };
        let bare = Kernel { landlock: 0, has_seccomp: false };
        assert_eq!(
            [modern, old, bare].map(|kernel| kernel.strongest_level()),
            [Level::Full, Level::Calls, Level::Limits]
        );
        assert_eq!(modern.check(Level::Full), Ok(()));
        assert_eq!(
            old.check(Level::Full).unwrap_err().to_string(),
            "this kernel cannot close files to programs (it has no Landlock), which the sandbox level `full` requires: the \
             strongest level here is `--sandbox=calls`"
        );
        let refused = bare.check(Level::Calls).unwrap_err().to_string();
        assert!(refused.contains("network") && refused.contains("`--sandbox=limits`"), "{refused}");
        assert_eq!(bare.check(Level::Limits), Ok(()));
        let early = Kernel { landlock: 3, has_seccomp: true };
        assert_eq!(early.describe_means(Area::Signals), Ok("seccomp".to_owned()));
        assert_eq!(early.strongest_level(), Level::Full);
    }
}
