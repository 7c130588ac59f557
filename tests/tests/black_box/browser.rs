//! The window's page in a real browser: Node.js runs `sim-view/page/tests` with Debian's Chromium and the binary under
//! test.

use std::path::Path;
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use sim_view::page::Page;
use tests::{eyesim_path, root};

/// Allows one browser at a time: without a graphics card each browser uses all cores.
static BROWSER: Mutex<()> = Mutex::new(());

#[test]
fn panels() {
    run("panel");
}

#[test]
fn every_control_acts_on_the_simulation() {
    run("view");
}

#[test]
fn access_reconnection_keyboard_and_watched_programs() {
    run("access");
}

#[test]
fn bodies_are_dragged() {
    run("scene");
}

#[test]
fn layers_messages_time_and_memory() {
    run("layer");
}

#[test]
fn recordings() {
    run("replay");
}

/// Runs `NAME.test.mjs`, or prints the reason why it cannot be run.
fn run(name: &str) {
    let _one_at_a_time = BROWSER.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(why) = missing() {
        eprintln!("skipped: {why}");
        return;
    }
    let output = Command::new("node")
        .args(["--test", &format!("tests/{name}.test.mjs")])
        .current_dir(root().join("sim-view/page"))
        .env("EYESIM", eyesim_path())
        .env("CHROMIUM", chromium())
        .output()
        .expect("Node.js runs");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}\n{}", String::from_utf8_lossy(&output.stderr));
    let passed_count =
        said.lines().filter_map(|line| line.rsplit_once(" pass ")).find_map(|(_, count)| count.parse().ok());
    assert!(passed_count > Some(0), "no test has run:\n{said}");
}

fn chromium() -> String {
    std::env::var("CHROMIUM").unwrap_or_else(|_| "/usr/bin/chromium".to_owned())
}

/// The missing prerequisite of these tests; `None` if nothing is missing.
fn missing() -> Option<String> {
    if Command::new("node").arg("--version").output().is_err() {
        return Some("there is no Node.js".to_owned());
    }
    if !Path::new(&chromium()).exists() {
        return Some(format!("there is no `{}`", chromium()));
    }
    if let Some(why) = Page::load(|words| eprintln!("{words}")).why_missing() {
        return Some(why.to_owned());
    }
    let playwright = root().join("sim-view/page/node_modules/playwright-core");
    (!playwright.is_dir()).then(|| "playwright-core is not installed: `npm ci` in sim-view/page".to_owned())
}
