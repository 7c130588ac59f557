//! Long runs of many robots use no more memory than short ones.
//!
//! `EYESIM_HOUR=1` runs 1,000 robots for an hour of virtual time; by default some robots run for some minutes.

use std::io::{BufRead as _, BufReader};
use std::process::{Command, Stdio};

use tests::{Scratch, eyesim_path, write_crowd};

/// Drives about; the first robot prints a line each minute.
const PROGRAM: &str = r#"
#include "eyebot.h"
static unsigned periods;
int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PSDHandle psd = PSDInit(PSD_FRONT);

  PSDStart(psd, TRUE);
  for (;;) {
    int near = PSDGet(psd) < 250;
    VWSetSpeed(vw, near ? 0 : 0.2, near ? 1.5 : 0.1);
    if (++periods % 1200 == 0 && OSMachineID() == 1)
      printf("minute %u\n", periods / 1200);
    OSWait(5 - OSGetCount() % 5);
  }
}
"#;

#[test]
fn resident_memory_stays_within_one_percent_after_the_first_minute() {
    let (robots, minutes) = if std::env::var_os("EYESIM_HOUR").is_some() { (1_000, 60) } else { (60, 3) };
    let scratch = Scratch::new();
    scratch.write("drive.c", PROGRAM);
    write_crowd(&scratch, robots, "drive.c");
    let mut command = Command::new(eyesim_path());
    command.args(["run", "crowd.sim", "--threads", "2", "--until", "1e8"]);
    let mut child = command.current_dir(scratch.path()).stdout(Stdio::piped()).spawn().expect("eyesim starts");
    let stdout = BufReader::new(child.stdout.take().expect("it is piped"));
    let mut sizes = Vec::new();
    for line in stdout.lines() {
        let line = line.expect("a line of text");
        if line.contains("[r1 ") && line.contains("minute ") {
            sizes.push(resident_kib(child.id()));
        }
        if sizes.len() == minutes {
            break;
        }
    }
    child.kill().expect("a signal");
    child.wait().expect("eyesim ends");
    assert_eq!(sizes.len(), minutes, "{sizes:?} KiB");
    let (first, last) = (sizes[0], sizes[minutes - 1]);
    println!("{robots} robots: {first} KiB after a minute, {last} KiB after {minutes}");
    assert!(last * 100 <= first * 101, "{sizes:?} KiB");
}

/// Resident memory of a process, in KiB.
fn resident_kib(process: u32) -> u64 {
    // The kernel sums this value exactly, unlike `VmRSS` in `status`.
    let sums = std::fs::read_to_string(format!("/proc/{process}/smaps_rollup")).expect("the process runs");
    let line = sums.lines().find_map(|line| line.strip_prefix("Rss:")).expect("a process has memory");
    line.trim().trim_end_matches(" kB").parse().expect("a number of KiB")
}
