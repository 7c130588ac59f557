//! The commands on the pages for beginners work, print the output on the page, and write its pictures.
//!
//! A page is a script. A line that ends in `NAME`: before a block makes the test write the block to the file NAME, or
//! change this file if the block is a `diff`. The test runs each line of a `sh` block by itself, in a folder that
//! contains the folders of the checkout. `<!-- exit 1 -->` above the block means that its last line fails. A `text`
//! block after it is its output: these lines in this order, with `...` for any other lines. The committed pictures of a
//! page must equal those that its commands write; `INSTA_UPDATE=always` updates them.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use tests::{Scratch, eyesim_path, root};

/// A fenced block of a page.
struct Block<'a> {
    language: &'a str,
    text: String,
    /// The last non-empty line of text above the block.
    above: &'a str,
    line: usize,
}

fn blocks(page: &str) -> Vec<Block<'_>> {
    let mut blocks: Vec<Block<'_>> = Vec::new();
    let (mut above, mut open) = ("", None);
    for (index, line) in page.lines().enumerate() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(language), None) => {
                open = Some(Block { language, text: String::new(), above, line: index + 1 });
            }
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (None, Some(block)) => {
                block.text += line;
                block.text += "\n";
            }
            (None, None) if line.trim().is_empty() => {}
            (None, None) => above = line,
        }
        // A block does not count as the text above the next block.
        if line == "```" {
            above = "";
        }
    }
    blocks
}

/// The file that the line above a block names: its last word in backquotes, if the line ends in a colon.
fn named(above: &str) -> Option<&str> {
    above.strip_suffix(':')?.rsplit('`').nth(1).filter(|name| name.contains('.') && !name.contains(' '))
}

/// State of a run of a page.
struct Run {
    scratch: Scratch,
    /// The working folder of the next command.
    folder: PathBuf,
    printed: String,
}

impl Run {
    fn new() -> Self {
        let scratch = Scratch::new();
        for folder in ["sims", "worlds", "robis", "example-programs", "docs"] {
            std::os::unix::fs::symlink(root().join(folder), scratch.path().join(folder)).expect("a link");
        }
        fs::create_dir(scratch.path().join("target")).expect("a folder");
        let folder = scratch.path().to_owned();
        Self { scratch, folder, printed: String::new() }
    }

    /// Executes a block; `Err` describes what is wrong.
    fn step(&mut self, block: &Block<'_>) -> Result<(), String> {
        match (block.language, named(block.above)) {
            ("sh", _) => self.commands(block),
            ("diff", Some(name)) => self.change(name, &block.text),
            (_, Some(name)) => {
                fs::write(self.folder.join(name), &block.text).map_err(|error| format!("`{name}`: {error}"))
            }
            ("text", None) if !self.printed.is_empty() => self.compare(&block.text),
            _ => Ok(()),
        }
    }

    fn change(&self, name: &str, diff: &str) -> Result<(), String> {
        let side = |without: char| -> String {
            let lines = diff.lines().filter(|line| !line.starts_with(without));
            lines.map(|line| format!("{}\n", line.get(1..).unwrap_or_default())).collect()
        };
        let (old, new) = (side('+'), side('-'));
        let path = self.folder.join(name);
        let text = fs::read_to_string(&path).map_err(|error| format!("`{name}`: {error}"))?;
        if text.matches(&old).count() != 1 {
            return Err(format!("`{name}` has not once\n{old}"));
        }
        fs::write(path, text.replace(&old, &new)).map_err(|error| format!("`{name}`: {error}"))
    }

    fn commands(&mut self, block: &Block<'_>) -> Result<(), String> {
        let expected = block.above.strip_prefix("<!-- exit ").map_or("0", |rest| rest.trim_end_matches(" -->"));
        self.printed.clear();
        // A line that ends in a backslash continues in the next line.
        let text = block.text.replace("\\\n", "");
        let lines: Vec<String> = text.lines().filter_map(command).collect();
        for (index, line) in lines.iter().enumerate() {
            if line.starts_with("eyesim view ") {
                self.view(line)?;
                continue;
            }
            let script = format!("{line}\ncode=$?\npwd >\"$FOLDER\"\nexit $code");
            let mut shell = self.shell(&script);
            let note = self.scratch.path().join(".folder");
            let output = shell.env("FOLDER", &note).output().map_err(|error| error.to_string())?;
            self.printed += &String::from_utf8_lossy(&output.stdout);
            self.printed += &String::from_utf8_lossy(&output.stderr);
            let code = output.status.code().map_or("a signal".to_owned(), |code| code.to_string());
            if code != if index + 1 == lines.len() { expected } else { "0" } {
                return Err(format!("`{line}` ended with {code}:\n{}", self.printed));
            }
            self.folder = fs::read_to_string(note).map_err(|error| error.to_string())?.trim_end().into();
        }
        Ok(())
    }

    fn shell(&self, script: &str) -> Command {
        let programs = eyesim_path().parent().expect("a folder").display().to_string();
        let path = std::env::var("PATH").unwrap_or_default();
        let mut shell = Command::new("sh");
        shell.args(["-c", script]).current_dir(&self.folder).env("PATH", format!("{programs}:{path}"));
        shell
    }

    /// Starts `eyesim view` without a browser and waits until it prints its address.
    fn view(&mut self, line: &str) -> Result<(), String> {
        if !has_page() {
            println!("skipped: `{line}` needs node and npm");
            return Ok(());
        }
        let mut shell = self.shell(&format!("exec {line} --no-open"));
        let mut child =
            shell.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().map_err(|error| error.to_string())?;
        let lines = BufReader::new(child.stdout.take().expect("its output")).lines().map_while(Result::ok);
        let mut found = false;
        for printed in lines {
            self.printed += &format!("{printed}\n");
            found |= printed.contains("http://");
            if found {
                break;
            }
        }
        let _ = child.kill();
        let output = child.wait_with_output().map_err(|error| error.to_string())?;
        self.printed += &String::from_utf8_lossy(&output.stderr);
        found.then_some(()).ok_or_else(|| format!("`{line}` says no address:\n{}", self.printed))
    }

    fn compare(&self, expected: &str) -> Result<(), String> {
        let mut printed = self.printed.lines();
        for line in expected.lines().filter(|line| line.trim() != "...") {
            if !printed.any(|other| other.trim_end() == line.trim_end()) {
                return Err(format!("`{line}` is not printed, or not there:\n{}", self.printed));
            }
        }
        Ok(())
    }

    /// Compares the pictures of the page with the files of the same names that its commands have written.
    fn pictures(&self, page: &Path, text: &str) -> Result<(), String> {
        for target in text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target) {
            let committed = page.parent().expect("a folder").join(target);
            let Some(name) = committed.file_name().filter(|_| target.ends_with(".svg") || target.ends_with(".png"))
            else {
                continue;
            };
            let written = [&self.folder, &self.scratch.path().to_owned(), &self.scratch.path().join("target")]
                .map(|folder| folder.join(name))
                .into_iter()
                .find(|path| path.is_file());
            let Some(written) = written else {
                if target.starts_with("tutorial/") {
                    return Err(format!("no command of the page writes `{target}`"));
                }
                continue;
            };
            if std::env::var("INSTA_UPDATE").is_ok_and(|value| value == "always") {
                fs::create_dir_all(committed.parent().expect("a folder")).expect("a folder");
                fs::copy(&written, &committed).expect("the picture is writable");
            }
            if fs::read(&written).ok() != fs::read(&committed).ok() {
                return Err(format!("`{target}` is not what the page's command draws: INSTA_UPDATE=always renews it"));
            }
        }
        Ok(())
    }
}

/// The command that the test runs for a line of a page; `None` if the command has run already or has tests elsewhere.
fn command(line: &str) -> Option<String> {
    if let Some((_, words)) = line.split_once(" -- ").filter(|(cargo, _)| cargo.starts_with("cargo run --release")) {
        // The papers have their own tests.
        return (!line.contains("-p papers")).then(|| format!("eyesim {words}"));
    }
    let done = ["cargo build", "cargo test", "export PATH="];
    (!line.trim().is_empty() && !done.iter().any(|start| line.starts_with(start))).then(|| line.to_owned())
}

fn has_page() -> bool {
    ["node", "npm"].iter().all(|name| Command::new(name).arg("--version").output().is_ok_and(|it| it.status.success()))
}

/// Runs a whole page.
fn check(name: &str) {
    let path = root().join(name);
    let text = fs::read_to_string(&path).expect("a page");
    let blocks = blocks(&text);
    assert!(blocks.iter().any(|block| block.language == "sh"), "{name} has commands");
    let mut run = Run::new();
    for block in &blocks {
        if let Err(message) = run.step(block) {
            panic!("{name}:{}: {message}", block.line);
        }
    }
    run.pictures(&path, &text).unwrap_or_else(|message| panic!("{name}: {message}"));
}

#[test]
fn the_readme() {
    check("README.md");
}

#[test]
fn the_tutorial() {
    check("docs/tutorial.md");
}

#[test]
fn the_page_for_students() {
    check("docs/for-students.md");
}

#[test]
fn the_page_for_lecturers() {
    check("docs/for-lecturers.md");
}

#[test]
fn the_page_for_researchers() {
    check("docs/for-researchers.md");
}

#[test]
fn the_page_for_rust_programmers() {
    check("docs/for-rust-programmers.md");
}

#[test]
fn the_examples_of_the_references() {
    check("docs/examples/README.md");
}

#[test]
fn mistakes_of_a_page_are_detected() {
    let page = "`a.txt`:\n\n```text\none\ntwo\n```\n\nIn `a.txt`:\n\n```diff\n one\n-two\n+three\n```\n\n\
                ```sh\ncat a.txt\n```\n\n```text\none\n...\nthree\n```\n\n<!-- exit 2 -->\n```sh\nexit 2\n```\n";
    let steps = |page: &str| {
        let mut run = Run::new();
        blocks(page).iter().try_for_each(|block| run.step(block))
    };
    assert_eq!(steps(page), Ok(()));
    assert!(
        steps(&page.replace("...\nthree", "...\ntwo")).is_err_and(|message| message.contains("`two` is not printed"))
    );
    assert!(steps(&page.replace("-two", "-four")).is_err_and(|message| message.contains("has not once")));
    assert!(steps(&page.replace("exit 2 --", "exit 0 --")).is_err_and(|message| message.contains("ended with 2")));
}
