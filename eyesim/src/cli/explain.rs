//! `eyesim explain`: prints the meaning of a diagnostic's code.

use std::process::ExitCode;

use clap::Args;
use owo_colors::{OwoColorize, Style};
use sim_format::{Code, Severity, UnknownCode};

use super::EXIT_USAGE;
use super::diagnostic::{Colour, Screen};
use super::output::{print, print_error};

/// Maximum width of prose, in columns.
const MAX_WIDTH: usize = 100;
/// Indentation of an example.
const INDENT: &str = "    ";

/// Arguments of `eyesim explain`.
#[derive(Args)]
pub struct ExplainArgs {
    /// A code such as wld-wall-arity; without one, all codes are listed
    pub code: Option<String>,
    /// When colours are used
    #[arg(long, value_enum, default_value_t, value_name = "WHEN")]
    pub color: Colour,
}

/// Runs the command: exit code 0, or 2 if there is no such code.
///
/// # Errors
/// If standard output cannot be written to.
pub fn run(args: &ExplainArgs) -> anyhow::Result<ExitCode> {
    let screen = Screen::of_stdout(args.color);
    match args.code.as_deref().map(parse_code).transpose() {
        Ok(Some(code)) => print(&page(code, screen))?,
        Ok(None) => print(&list("", screen))?,
        Err(error) => {
            let list = match family(&error.name) {
                "" => "`eyesim explain` lists all codes\n".to_owned(),
                family => format!("there are\n{}", list(family, Screen::of_stderr(args.color))),
            };
            print_error(&format!("error: {error}; {list}"));
            return Ok(ExitCode::from(EXIT_USAGE));
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Parses a code, bare or as in a message: `error[CODE]`.
fn parse_code(text: &str) -> Result<Code, UnknownCode> {
    let inner = text.split_once('[').map_or(text, |(_, rest)| rest.trim_end_matches([':', ']']));
    inner.trim().to_lowercase().parse()
}

/// Prefix of the codes most similar to `name`: the first part of `name` if any code begins with that part, otherwise
/// empty.
fn family(name: &str) -> &str {
    let family = name.split('-').next().unwrap_or_default();
    if Code::ALL.iter().any(|code| code.name().split('-').next() == Some(family)) { family } else { "" }
}

/// All codes that begin with `family`, with their meanings.
fn list(family: &str, screen: Screen) -> String {
    let codes = || Code::ALL.iter().filter(|code| code.name().starts_with(family));
    let width = codes().map(|code| code.name().len()).max().unwrap_or_default();
    let line = |code: &Code| format!("{}  {}\n", format!("{code:width$}").style(screen.bold()), code.meaning());
    codes().map(line).collect()
}

/// The page of a code formatted for a terminal: paragraphs wrapped, examples indented, links as file names.
fn page(code: Code, screen: Screen) -> String {
    let width = screen.width.min(MAX_WIDTH);
    let mut out = String::new();
    let mut blocks = code.page().split("```");
    while let Some(prose) = blocks.next() {
        for paragraph in prose.split("\n\n").map(str::trim).filter(|paragraph| !paragraph.is_empty()) {
            out.push_str(&wrapped(paragraph, width, screen));
            out.push('\n');
        }
        let Some((tag, example)) = blocks.next().and_then(|block| block.split_once('\n')) else { continue };
        if let Some((_, role)) = tag.split_once(' ') {
            out.push_str(&format!("{}\n", format!("{role}:").style(screen.bold())));
        }
        out.extend(example.lines().map(|line| format!("{INDENT}{line}\n")));
        out.push('\n');
    }
    out.trim_end().to_owned() + "\n"
}

/// Wraps a paragraph into lines of at most `width` columns.
fn wrapped(paragraph: &str, width: usize, screen: Screen) -> String {
    if let Some(heading) = paragraph.strip_prefix("# ") {
        return format!("{}\n", heading.style(screen.bold()));
    }
    let text = plain_links(paragraph);
    let mut lines = String::new();
    let mut column = 0;
    for word in text.split_whitespace() {
        let (shown, style) = emphasis(word, screen);
        let length = console::measure_text_width(&shown);
        if column > 0 {
            let is_full = column + 1 + length > width;
            lines.push(if is_full { '\n' } else { ' ' });
            column = if is_full { 0 } else { column + 1 };
        }
        lines.push_str(&shown.style(style).to_string());
        column += length;
    }
    lines + "\n"
}

/// A word without its asterisks, and its style: plain without asterisks, otherwise that of a severity, or bold.
fn emphasis(word: &str, screen: Screen) -> (String, Style) {
    if !word.contains("**") {
        return (word.to_owned(), Style::new());
    }
    let text = word.replace("**", "");
    let style = match text.trim_end_matches(':') {
        "error" => screen.severity(Severity::Error),
        "warning" => screen.severity(Severity::Warning),
        _ => screen.bold(),
    };
    (text, style)
}

/// Replaces Markdown links: `[text](../wld.md#push)` by `text (docs/formats/wld.md#push)`, a link to another code by
/// its name.
fn plain_links(text: &str) -> String {
    let mut parts = text.split('[');
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        match part.split_once("](").and_then(|(name, rest)| Some((name, rest.split_once(')')?))) {
            Some((name, (target, rest))) => {
                out.push_str(name);
                if let Some(target) = target.strip_prefix("../") {
                    let path =
                        target.strip_prefix("../").map_or(format!("docs/formats/{target}"), |t| format!("docs/{t}"));
                    out.push_str(&format!(" ({path})"));
                }
                out.push_str(rest);
            }
            None => {
                out.push('[');
                out.push_str(part);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREEN: Screen = Screen { is_terminal: false, width: 60, has_colour: false };

    #[test]
    fn a_page_is_readable_without_markdown() {
        insta::assert_snapshot!(page(Code::WldWallArity, SCREEN));
    }

    #[test]
    fn pages_fit_and_contain_no_markup() {
        for code in Code::ALL {
            let text = page(*code, SCREEN);
            let prose = text.lines().filter(|line| !line.starts_with(INDENT));
            assert!(prose.clone().all(|line| line.chars().count() <= 60), "{text}");
            assert!(prose.clone().all(|line| !line.contains("**") && !line.contains("](")), "{text}");
            assert!(text.starts_with(code.name()) && text.contains("\nSee "), "{text}");
        }
    }

    #[test]
    fn codes_are_parsed_as_copied_from_messages() {
        for text in ["wld-wall-arity", "WLD-WALL-ARITY", "warning[wld-wall-arity]", "error[wld-wall-arity]:"] {
            assert_eq!(parse_code(text), Ok(Code::WldWallArity), "{text}");
        }
        assert_eq!(parse_code("wld-wall-airty").expect_err("misspelt").nearest, Some(Code::WldWallArity));
    }

    #[test]
    fn lists_contain_all_codes_or_a_family() {
        assert_eq!(list("", SCREEN).lines().count(), Code::ALL.len());
        assert_eq!((family("wld-wal"), family("maz"), family("banana"), family("")), ("wld", "maz", "", ""));
        assert!(list("wld", SCREEN).lines().all(|line| line.starts_with("wld-")));
    }
}
