//! Ends the processes that robot programs have started, after the run.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::ptr;
use std::time::{Duration, Instant};

/// Maximum time that [`Subreaper::end_all`] takes.
const TIMEOUT: Duration = Duration::from_secs(1);

/// The subreaper of this process: adopts descendants whose parents end, such as daemons, and kills them after the run.
#[derive(Debug)]
pub struct Subreaper {
    /// Children of this process that existed at the start.
    children_before: BTreeSet<i32>,
}

impl Subreaper {
    /// Makes this process adopt orphaned descendants from now on; a binary calls it before its run.
    pub fn start() -> Self {
        // SAFETY: prctl takes no pointer here; if the kernel refuses, daemons of programs outlive the run.
        unsafe { libc::prctl(libc::PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0) };
        Self { children_before: children() }
    }

    /// Kills all children of this process that did not exist at the start, and their descendants; returns how many
    /// processes were killed. Call it after the run has ended its own processes.
    pub fn end_all(&self) -> usize {
        let start = Instant::now();
        let mut killed = BTreeSet::new();
        while start.elapsed() < TIMEOUT {
            let orphans: Vec<i32> = children().difference(&self.children_before).copied().collect();
            if orphans.is_empty() {
                break;
            }
            for pid in orphans {
                // SAFETY: neither call takes a pointer; no other code waits for a process that a program has started,
                // so that its process id still identifies it.
                unsafe {
                    libc::kill(pid, libc::SIGKILL);
                    libc::waitpid(pid, ptr::null_mut(), libc::WNOHANG);
                }
                killed.insert(pid);
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        killed.len()
    }
}

/// The processes whose parent is this process.
fn children() -> BTreeSet<i32> {
    // It is fast to check whether there are children; to list them requires reading the status of every process of the
    // machine.
    if !has_children() {
        return BTreeSet::new();
    }
    let own = std::process::id();
    let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
    let pids = processes.filter_map(|entry| entry.file_name().to_str()?.parse::<i32>().ok());
    pids.filter(|pid| parent_of(*pid) == Some(own)).collect()
}

fn has_children() -> bool {
    // SAFETY: a `siginfo_t` is plain data, for which zeros are valid; the call writes only to it and, because of
    // `WNOWAIT`, does not reap an ended child.
    let result = unsafe {
        let mut info = std::mem::zeroed();
        libc::waitid(libc::P_ALL, 0, &raw mut info, libc::WEXITED | libc::WNOHANG | libc::WNOWAIT | libc::__WALL)
    };
    result == 0 || io::Error::last_os_error().raw_os_error() != Some(libc::ECHILD)
}

fn parent_of(pid: i32) -> Option<u32> {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // "pid (name) S parent ...": the name may contain blanks and brackets.
    stat.rsplit_once(')')?.1.split_whitespace().nth(1)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use std::process::{Command, Stdio};

    use super::*;

    #[test]
    fn children_are_found() {
        let mut child = Command::new("sleep").arg("100").stdin(Stdio::null()).spawn().unwrap();
        assert!(children().contains(&(child.id() as i32)));
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(!children().contains(&(child.id() as i32)));
    }
}
