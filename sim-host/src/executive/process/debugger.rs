//! Start of gdb around a robot's process, and the user's settings for it.

use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::host;

/// Name of the debugger's binary, found by the search path.
const GDB: &str = "gdb";

/// The user's settings for the debugger.
#[derive(Clone, Debug, Default)]
pub struct Debugger {
    /// Breakpoints at which the program stops: `FILE:LINE` or a function.
    pub breakpoints: Vec<String>,
    /// Further arguments of gdb; its commands run once the program has stopped or ended.
    pub arguments: Vec<OsString>,
}

impl Debugger {
    /// Returns true if gdb is installed.
    pub fn is_installed() -> bool {
        let mut command = Command::new(GDB);
        command.arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    }

    /// The command that runs `eyesim child` under gdb for the program in `library`, with the file `channels` as its
    /// standard input.
    ///
    /// gdb gets the terminal. Breakpoints are set before the program's library is loaded; gdb does not ask whether to
    /// make them pending.
    ///
    /// # Errors
    /// The path of this executable cannot be determined.
    pub fn command(&self, library: &Path, channels: &Path) -> io::Result<Command> {
        let mut command = Command::new(GDB);
        command.arg("-q");
        let words = host::words()?;
        let arguments_before: String = words[1..].iter().map(|word| format!("{} ", quoted(Path::new(word)))).collect();
        let child = format!("set args {arguments_before}child --debugged {} <> {}", quoted(library), quoted(channels));
        let settings = ["set breakpoint pending on", "set debuginfod enabled off", "set startup-with-shell on", &child];
        let breakpoints = self.breakpoints.iter().map(|location| format!("break {location}"));
        for line in settings.map(str::to_owned).into_iter().chain(breakpoints).chain(["run".to_owned()]) {
            command.arg("-ex").arg(line);
        }
        // gdb starts the program with a shell that must support `<>`, as every POSIX shell does.
        command.env("SHELL", "/bin/sh").args(&self.arguments).arg(&words[0]);
        Ok(command)
    }
}

/// The path in single quotes, as one word of a shell command.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.display().to_string().replace('\'', r"'\''"))
}

/// Path at which another process can open descriptor `fd` of this process.
pub fn file_of(fd: i32) -> PathBuf {
    PathBuf::from(format!("/proc/{}/fd/{fd}", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gdb_gets_its_commands_in_order() {
        let debugger = Debugger { breakpoints: vec!["maze.c:12".into()], arguments: vec!["-batch".into()] };
        let command = debugger.command(Path::new("/tmp/it's.so"), Path::new("/proc/1/fd/5")).expect("a command");
        let arguments: Vec<String> =
            command.get_args().map(|argument| argument.to_string_lossy().into_owned()).collect();
        let position_of =
            |text: &str| arguments.iter().position(|argument| argument == text).unwrap_or_else(|| panic!("{text}"));
        assert!(position_of(r"set args child --debugged '/tmp/it'\''s.so' <> '/proc/1/fd/5'") < position_of("run"));
        assert!(position_of("set breakpoint pending on") < position_of("break maze.c:12"));
        assert!(position_of("break maze.c:12") < position_of("run"));
        assert!(position_of("run") < position_of("-batch"));
    }
}
