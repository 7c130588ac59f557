//! `eyesim doctor`: lists tools and limits of this system, each with its purpose and the command that installs a
//! missing one.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::Duration;

use clap::Args;
use sim_format::Files as _;
use sim_host::files::DiskFiles;
use sim_host::host;
use sim_host::program::command::{COMMAND_TIMEOUT, build_output};
use sim_host::program::compiler::{Compiler, CompilerError};
use sim_host::program::language::Language;
use sim_host::program::python::{Python, PythonError};
use sim_host::program::sandbox::Kernel;
use sim_host::program::{Cache, Tools};

use super::output::print;

/// Arguments of `eyesim doctor`.
#[derive(Args)]
pub struct DoctorArgs {}

/// Maximum time for a tool to print its version.
const VERSION_TIMEOUT: Duration = Duration::from_secs(20);
/// Number of memory mappings below which only few robots can have private copies of their programs; the default of
/// Linux.
const MAPPINGS: u64 = 65_530;
/// Number of file watches below which editors may run out of them.
const WATCHES: u64 = 8_192;
/// Memory in MiB below which builds of Rust programs may fail.
const MEMORY_MEBIBYTES: u64 = 1_024;

/// Result for one tool or limit.
struct Finding {
    subject: &'static str,
    answer: Answer,
    purpose: &'static str,
    /// Instruction for the user if it is missing.
    remedy: String,
}

/// Result of the search for a tool or a limit.
enum Answer {
    /// Description of what was found.
    Found(String),
    Missing,
    /// It exists, but did not answer within this time.
    Silent(Duration),
}

impl From<Option<String>> for Answer {
    fn from(found: Option<String>) -> Self {
        found.map_or(Self::Missing, Self::Found)
    }
}

impl Answer {
    /// Answer of a tool that could not be run or did not answer within `timeout`.
    fn of_error(error: &io::Error, timeout: Duration) -> Self {
        if error.kind() == io::ErrorKind::TimedOut { Self::Silent(timeout) } else { Self::Missing }
    }
}

impl Finding {
    fn new(subject: &'static str, purpose: &'static str, answer: impl Into<Answer>, remedy: impl Into<String>) -> Self {
        Self { subject, answer: answer.into(), purpose, remedy: remedy.into() }
    }
}

/// Runs the command.
///
/// # Errors
/// If the standard output cannot be written.
pub fn run(_: &DoctorArgs) -> anyhow::Result<ExitCode> {
    let installer = Installer::of_system();
    let (tools, cache) = (Tools::of_environment(), Cache::of_user());
    let mut findings = vec![Finding::new(
        "installation",
        "what `%sim%` stands for: worlds, robots, examples",
        DiskFiles::of_environment().home().filter(|home| Path::new(home).join("worlds").is_dir()).map(str::to_owned),
        "set EYESIM_HOME to a folder with `worlds` and `robis`",
    )];
    match &cache {
        Ok(cache) => findings.extend(compilers(&tools, cache, &installer)),
        Err(error) => findings.push(Finding::new("cache", "built programs", None, error.to_string())),
    }
    findings.extend(other_tools(&installer));
    findings.push(sandbox());
    findings.extend(limits());
    findings.extend(cache.ok().map(|cache| {
        let root = cache.root().display().to_string();
        Finding::new("cache", "built programs; EYESIM_CACHE names another folder", Some(root), "")
    }));
    print(&render(&findings))?;
    Ok(ExitCode::SUCCESS)
}

fn render(findings: &[Finding]) -> String {
    let mut text = String::new();
    for Finding { subject, answer, purpose, remedy } in findings {
        // Writing to a string does not fail.
        let _ = match answer {
            Answer::Found(found) => writeln!(text, "ok       {subject:13} {found}\n         {:13} for {purpose}", ""),
            Answer::Missing => writeln!(text, "missing  {subject:13} for {purpose}\n         {:13} {remedy}", ""),
            Answer::Silent(timeout) => writeln!(
                text,
                "slow     {subject:13} for {purpose}\n         {:13} it did not answer in {} s: try again when the machine is less busy",
                "",
                timeout.as_secs_f64()
            ),
        };
    }
    text
}

/// Compilers and interpreters of programs.
fn compilers(tools: &Tools, cache: &Cache, installer: &Installer) -> Vec<Finding> {
    let compiler = |language: Language, subject, purpose, setting: Option<&str>, packages| {
        let found = Compiler::find(language, setting, cache);
        let remedy = found.as_ref().err().map(ToString::to_string).unwrap_or_default();
        let remedy = installer.command(packages).unwrap_or(remedy);
        let installer_without_root =
            host::current().map(|host| host.zig_installer.as_str()).filter(|installer| !installer.is_empty());
        let remedy = installer_without_root
            .map_or_else(|| remedy.clone(), |installer| format!("{remedy}; without root: {installer}"));
        let answer = match &found {
            Ok(compiler) => Answer::Found(compiler.description()),
            Err(CompilerError::Silent { error, .. } | CompilerError::Io(error)) => {
                Answer::of_error(error, COMMAND_TIMEOUT)
            }
            Err(_) => Answer::Missing,
        };
        Finding::new(subject, purpose, answer, remedy)
    };
    let python = match Python::find(tools.python.as_deref(), cache).and_then(|python| python.check().map(|()| python)) {
        Ok(python) => Answer::Found(python.interpreter().display().to_string()),
        Err(PythonError::Missing { error, .. }) => Answer::of_error(&error, COMMAND_TIMEOUT),
        Err(_) => Answer::Missing,
    };
    vec![
        compiler(
            Language::C,
            "C compiler",
            "programs in C",
            tools.cc.as_deref(),
            ["gcc libc6-dev", "gcc glibc-devel", "gcc"],
        ),
        compiler(
            Language::Cpp,
            "C++ compiler",
            "programs in C++",
            tools.cxx.as_deref(),
            ["g++", "gcc-c++ libstdc++-static", "gcc"],
        ),
        Finding::new("Python", "programs in Python", python, installer.text(["python3", "python3", "python"])),
    ]
}

/// Tools that only some commands need.
fn other_tools(installer: &Installer) -> Vec<Finding> {
    let tool = |subject, purpose, command: &str, packages| {
        Finding::new(subject, purpose, version(command, VERSION_TIMEOUT), installer.text(packages))
    };
    let browser = std::env::var("BROWSER").ok().filter(|browser| !browser.is_empty());
    let browser = browser.or_else(|| on_path("xdg-open"));
    vec![
        Finding::new("cargo", "programs in Rust", version("cargo", VERSION_TIMEOUT), "see https://rustup.rs"),
        tool("gdb", "`eyesim debug`", "gdb", ["gdb", "gdb", "gdb"]),
        Finding::new(
            "browser",
            "`eyesim view`, which otherwise prints an address to open",
            browser,
            "set BROWSER to the command of a browser",
        ),
    ]
}

/// The strongest sandbox of this kernel, with the means that close each area.
fn sandbox() -> Finding {
    let kernel = Kernel::probe();
    let level = kernel.strongest_level();
    let closed: Vec<String> = level
        .areas()
        .filter_map(|area| Some(format!("{} by {}", area.word(), kernel.describe_means(area).ok()?)))
        .collect();
    let found = format!("{}: closes {}", level.word(), closed.join("; "));
    Finding::new("sandbox", "untrusted programs: `eyesim run --sandbox`", Some(found), "")
}

/// Limits and environment of this process.
fn limits() -> Vec<Finding> {
    let number = |path: &str| fs::read_to_string(path).ok()?.trim().parse::<u64>().ok();
    let at_least = |value: Option<u64>, min: u64| value.filter(|value| *value >= min).map(|value| value.to_string());
    let cores = host::processors();
    let locale = ["LC_ALL", "LC_CTYPE", "LANG"]
        .iter()
        .find_map(|name| std::env::var(name).ok().filter(|locale| !locale.is_empty()));
    let is_utf8 = |locale: &String| locale.to_lowercase().replace('-', "").ends_with("utf8");
    let memory = memory_mebibytes();
    vec![
        Finding::new("cores", "robots that run at one time", Some(cores.to_string()), ""),
        Finding::new(
            "memory",
            "many robots, and builds of Rust programs",
            at_least(memory, MEMORY_MEBIBYTES).map(|mebibytes| format!("{mebibytes} MiB")),
            format!(
                "{} MiB are left: close other programs, or raise the container's limit",
                memory.unwrap_or_default()
            ),
        ),
        Finding::new(
            "mappings",
            "thousands of robots on threads, each with a copy of its program",
            at_least(number("/proc/sys/vm/max_map_count"), MAPPINGS),
            format!("sudo sysctl vm.max_map_count={MAPPINGS}"),
        ),
        Finding::new(
            "file watches",
            "editors that follow changes of files",
            at_least(number("/proc/sys/fs/inotify/max_user_watches"), WATCHES),
            "sudo sysctl fs.inotify.max_user_watches=524288",
        ),
        Finding::new(
            "locale",
            "umlauts and other letters in the output of programs",
            locale.filter(is_utf8),
            "export LC_ALL=C.UTF-8",
        ),
        Finding::new("system", "your questions to others: mention it", Some(system_description()), ""),
    ]
}

/// Available memory in MiB: the minimum for the machine and for the control group of this process.
fn memory_mebibytes() -> Option<u64> {
    let information = fs::read_to_string("/proc/meminfo").ok()?;
    let line = information.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let machine = line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()? / 1024;
    let group_value =
        |file: &str| fs::read_to_string(Path::new("/sys/fs/cgroup").join(file)).ok()?.trim().parse::<u64>().ok();
    let group =
        group_value("memory.max").map(|max| max.saturating_sub(group_value("memory.current").unwrap_or(0)) >> 20);
    Some(group.map_or(machine, |group| group.min(machine)))
}

/// The system's name, and whether it is a container or runs within Windows.
fn system_description() -> String {
    let name = release().and_then(|text| release_value(&text, "PRETTY_NAME")).unwrap_or_else(|| "Linux".to_owned());
    let kernel = fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
    let is_container = Path::new("/.dockerenv").exists() || Path::new("/run/.containerenv").exists();
    let environment = match (kernel.to_lowercase().contains("microsoft"), is_container) {
        (true, _) => " in WSL",
        (false, true) => " in a container",
        (false, false) => "",
    };
    format!("{name}{environment}, kernel {}", kernel.trim())
}

fn release() -> Option<String> {
    fs::read_to_string("/etc/os-release").ok()
}

/// Value of a key of `/etc/os-release`, without quotes.
fn release_value(text: &str, key: &str) -> Option<String> {
    let value = text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix('='))?;
    Some(value.trim().trim_matches('"').to_owned())
}

/// The path of a command.
fn on_path(command: &str) -> Option<String> {
    let path = std::env::var_os("PATH")?;
    let found = std::env::split_paths(&path).map(|folder| folder.join(command)).find(|file| file.is_file())?;
    Some(found.display().to_string())
}

/// First line of the version that a command prints within `timeout`.
fn version(command: &str, timeout: Duration) -> Answer {
    match build_output(Command::new(command).arg("--version"), timeout) {
        Ok(output) if output.status.success() => {
            String::from_utf8_lossy(&output.stdout).lines().next().map(|line| line.trim().to_owned()).into()
        }
        Ok(_) => Answer::Missing,
        Err(error) => Answer::of_error(&error, timeout),
    }
}

/// Package installer of this system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Installer {
    Apt,
    Dnf,
    Pacman,
    Unknown,
}

impl Installer {
    fn of_system() -> Self {
        Self::of_release(&release().unwrap_or_default())
    }

    /// Installer of the system that `/etc/os-release` names.
    fn of_release(text: &str) -> Self {
        let names = ["ID", "ID_LIKE"].map(|key| release_value(text, key).unwrap_or_default()).join(" ");
        let is_any = |known: &[&str]| names.split_whitespace().any(|name| known.contains(&name));
        match () {
            () if is_any(&["debian", "ubuntu"]) => Self::Apt,
            () if is_any(&["fedora", "rhel", "centos"]) => Self::Dnf,
            () if is_any(&["arch"]) => Self::Pacman,
            () => Self::Unknown,
        }
    }

    /// Command that installs the packages, given by their names in Debian, Fedora and Arch.
    fn command(self, [debian, fedora, arch]: [&str; 3]) -> Option<String> {
        match self {
            Self::Apt => Some(format!("sudo apt install {debian}")),
            Self::Dnf => Some(format!("sudo dnf install {fedora}")),
            Self::Pacman => Some(format!("sudo pacman -S {arch}")),
            Self::Unknown => None,
        }
    }

    /// The command of [`Installer::command`]; on an unknown system, a text with the package to look for.
    fn text(self, packages: [&str; 3]) -> String {
        self.command(packages).unwrap_or_else(|| format!("install the package `{}`, or one like it", packages[0]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_have_the_names_of_the_system() {
        let command = |text: &str| Installer::of_release(text).text(["g++", "gcc-c++", "gcc"]);
        assert_eq!(command("NAME=x\nID=ubuntu\nID_LIKE=debian\n"), "sudo apt install g++");
        assert_eq!(command("ID=\"rocky\"\nID_LIKE=\"rhel centos fedora\"\n"), "sudo dnf install gcc-c++");
        assert_eq!(command("ID=arch\n"), "sudo pacman -S gcc");
        assert_eq!(command(""), "install the package `g++`, or one like it");
    }

    #[test]
    fn silent_tool_is_not_reported_as_missing() {
        let folder = tempfile::tempdir().expect("a folder");
        let tool = folder.path().join("tool");
        fs::write(&tool, "#!/bin/sh\nsleep 1000\n").expect("a script");
        fs::set_permissions(&tool, std::os::unix::fs::PermissionsExt::from_mode(0o755)).expect("a script");
        let answer = version(&tool.display().to_string(), Duration::from_millis(50));
        let text = render(&[Finding::new("gdb", "`eyesim debug`", answer, "")]);
        let expected = "slow     gdb           for `eyesim debug`\n                       it did not answer in 0.05 s: try \
                        again when the machine is less busy\n";
        assert_eq!(text, expected);
        assert!(matches!(version("no-such-tool", VERSION_TIMEOUT), Answer::Missing));
    }

    #[test]
    fn missing_tool_has_a_remedy() {
        let findings = [
            Finding::new("gdb", "`eyesim debug`", Answer::Missing, "sudo apt install gdb"),
            Finding::new("cores", "robots", Some("2".to_owned()), ""),
        ];
        let expected = "missing  gdb           for `eyesim debug`\n                       sudo apt install gdb\n\
                        ok       cores         2\n                       for robots\n";
        assert_eq!(render(&findings), expected);
    }
}
