//! Prints the readers' diagnostics on a terminal, in one line each, or as JSON.

use std::collections::BTreeMap;
use std::fmt;
use std::io::IsTerminal;

use clap::ValueEnum;
use console::Term;
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, SourceCode, ThemeCharacters, ThemeStyles};
use owo_colors::{OwoColorize, Style};
use sim_format::{Diagnostic, InputFile, Severity};

use super::excerpt::{Excerpt, printable};

/// Maximum number of diagnostics of one file in the human-readable format; the other formats list all.
const MAX_SHOWN: usize = 20;
/// Width in columns if neither the terminal nor `COLUMNS` gives one.
const DEFAULT_WIDTH: usize = 100;
/// Minimum readable width, in columns.
const MIN_WIDTH: usize = 30;
/// Maximum width of prose, in columns: longer lines are hard to read.
const MAX_PROSE: usize = 120;

/// Format in which diagnostics are printed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// `human` on a terminal, else `short`
    #[default]
    Auto,
    /// For people: the line of the file with the mistake underlined, and the expected form
    Human,
    /// For editors and logs: `file:line:column: severity[code]: message`
    Short,
    /// For programs: one array of objects
    Json,
}

impl Format {
    /// Returns true if `screen` gets the human-readable format.
    pub fn is_human(self, screen: Screen) -> bool {
        self == Format::Human || self == Format::Auto && screen.is_terminal
    }
}

/// Condition for the use of colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Colour {
    /// On a terminal, unless NO_COLOR is set
    #[default]
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

/// Output stream for diagnostics, and its capabilities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Screen {
    /// True if the stream is a terminal.
    pub is_terminal: bool,
    /// Width in columns.
    pub width: usize,
    /// True if colours may be used; nothing is shown by colour alone.
    pub has_colour: bool,
}

impl Screen {
    /// Standard output.
    pub fn of_stdout(colour: Colour) -> Self {
        Self::of(&Term::stdout(), std::io::stdout().is_terminal(), colour)
    }

    /// Standard error.
    pub fn of_stderr(colour: Colour) -> Self {
        Self::of(&Term::stderr(), std::io::stderr().is_terminal(), colour)
    }

    /// A page of the window.
    pub fn of_page() -> Self {
        Self { is_terminal: false, width: DEFAULT_WIDTH, has_colour: false }
    }

    fn of(term: &Term, is_terminal: bool, colour: Colour) -> Self {
        let variable = |name| std::env::var(name).unwrap_or_default();
        let is_terminal = is_terminal && variable("TERM") != "dumb";
        let terminal_columns =
            term.size_checked().map(|(_, columns)| usize::from(columns)).filter(|columns| *columns > 0);
        let width =
            terminal_columns.or_else(|| variable("COLUMNS").parse().ok()).unwrap_or(DEFAULT_WIDTH).max(MIN_WIDTH);
        let has_colour = match colour {
            Colour::Always => true,
            Colour::Never => false,
            Colour::Auto => is_terminal && variable("NO_COLOR").is_empty(),
        };
        Self { is_terminal, width, has_colour }
    }

    /// Style of a severity: errors orange, warnings blue, distinct with any kind of colour vision, on black and on
    /// white.
    pub fn severity(&self, severity: Severity) -> Style {
        match (self.has_colour, severity) {
            (false, _) => Style::new(),
            (true, Severity::Error) => Style::new().color(owo_colors::XtermColors::from(166)).bold(),
            (true, Severity::Warning) => Style::new().color(owo_colors::XtermColors::from(32)).bold(),
        }
    }

    /// Style of emphasised text.
    pub fn bold(&self) -> Style {
        if self.has_colour { Style::new().bold() } else { Style::new() }
    }

    /// Style of secondary text.
    pub fn dim(&self) -> Style {
        if self.has_colour { Style::new().dimmed() } else { Style::new() }
    }
}

/// Renders the `diagnostics` of the files `inputs` in a format.
///
/// # Errors
/// If they cannot be serialised as JSON.
pub fn render(
    diagnostics: &[Diagnostic],
    inputs: &[InputFile],
    format: Format,
    screen: Screen,
) -> serde_json::Result<String> {
    match format {
        Format::Json => serde_json::to_string_pretty(diagnostics).map(|json| json + "\n"),
        _ if format.is_human(screen) => Ok(human(diagnostics, inputs, screen)),
        _ => Ok(diagnostics.iter().map(|diagnostic| short(diagnostic) + "\n").collect()),
    }
}

/// Formats a diagnostic as one line, for editors.
fn short(diagnostic: &Diagnostic) -> String {
    let mut text = diagnostic.to_string();
    // The messages of these codes say what was found, but not what was expected.
    let code = diagnostic.code.name();
    let lacks_form = ["number-", "toml-"].iter().any(|start| code.starts_with(start))
        || ["-arity", "-cases", "-keyword", "-setting"].iter().any(|end| code.ends_with(end));
    match &diagnostic.suggestion {
        Some(suggestion) => text.push_str(&format!("; {suggestion}")),
        None if lacks_form => {
            text.push_str(&format!("; expected {}", diagnostic.expected));
        }
        None => {}
    }
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    printable(&lines.join("; "))
}

/// Human-readable form of the diagnostics, at most [`MAX_SHOWN`] of each file.
fn human(diagnostics: &[Diagnostic], inputs: &[InputFile], screen: Screen) -> String {
    let mut out = String::new();
    let mut texts: BTreeMap<&str, Option<String>> = BTreeMap::new();
    let (shown, omitted) = choose(diagnostics);
    for diagnostic in shown {
        let text = texts.entry(&diagnostic.file).or_insert_with(|| {
            let input = inputs.iter().find(|input| input.path == diagnostic.file);
            input.map(|input| sim_format::decode(&input.bytes).0)
        });
        let text = text.as_deref().filter(|_| diagnostic.span.line > 0);
        let excerpt = text.map(|text| Excerpt::new(&diagnostic.file, text, diagnostic.span, screen.width));
        let report = Report { diagnostic, excerpt, screen };
        // Writing to a string cannot fail.
        _ = handler(diagnostic.severity, screen).render_report(&mut out, &report);
        out.push('\n');
    }
    for (file, omitted) in omitted {
        let line = format!("... and {} more in {file}: `--format short` lists all", omitted);
        out.push_str(&format!("{}\n\n", printable(&line).style(screen.dim())));
    }
    // miette leaves blanks at the ends of lines.
    out.lines().map(|line| format!("{}\n", line.trim_end())).collect()
}

/// Diagnostics to show, and the number omitted of each file; if a file has too many, errors take precedence over
/// warnings.
fn choose(diagnostics: &[Diagnostic]) -> (Vec<&Diagnostic>, BTreeMap<&str, usize>) {
    let mut by_severity: Vec<(usize, &Diagnostic)> = diagnostics.iter().enumerate().collect();
    by_severity.sort_by_key(|(_, diagnostic)| std::cmp::Reverse(diagnostic.severity));
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    by_severity.retain(|(_, diagnostic)| {
        let count = counts.entry(&diagnostic.file).or_default();
        *count += 1;
        *count <= MAX_SHOWN
    });
    by_severity.sort_by_key(|(index, _)| *index);
    let omitted =
        counts.into_iter().filter(|(_, count)| *count > MAX_SHOWN).map(|(file, count)| (file, count - MAX_SHOWN));
    (by_severity.into_iter().map(|(_, diagnostic)| diagnostic).collect(), omitted.collect())
}

/// Renderer in the colours of a severity.
fn handler(severity: Severity, screen: Screen) -> GraphicalReportHandler {
    let style = screen.severity(severity);
    let styles = ThemeStyles {
        error: style,
        warning: style,
        advice: style,
        help: screen.bold(),
        link: screen.bold(),
        linum: screen.dim(),
        highlights: vec![style],
    };
    // Unlike the warning sign, `!` is one column wide in every font; a heavy line is visible without colour.
    let characters = ThemeCharacters { warning: "!".to_owned(), underline: '━', ..ThemeCharacters::unicode() };
    GraphicalReportHandler::new_themed(GraphicalTheme { characters, styles })
        .with_width(screen.width.min(MAX_PROSE))
        .with_context_lines(1)
        .without_syntax_highlighting()
}

/// Adapter from a diagnostic to miette.
#[derive(Debug)]
struct Report<'a> {
    diagnostic: &'a Diagnostic,
    excerpt: Option<Excerpt>,
    screen: Screen,
}

impl fmt::Display for Report<'_> {
    /// `error[wld-floor-arity]: ...`, preceded by the file's name if no line of the file is shown.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Diagnostic { severity, code, message, file, span, .. } = self.diagnostic;
        if self.excerpt.is_none() {
            write!(f, "{}", printable(file).style(self.screen.bold()))?;
            if span.line > 0 {
                write!(f, ":{}:{}", span.line, span.column)?;
            }
            f.write_str(": ")?;
        }
        let heading = format!("{severity}[{code}]");
        write!(f, "{}: {}", heading.style(self.screen.severity(*severity)), printable(message))
    }
}

impl std::error::Error for Report<'_> {}

impl miette::Diagnostic for Report<'_> {
    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.diagnostic.severity {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        let expected = printable(&self.diagnostic.expected);
        Some(Box::new(match &self.diagnostic.suggestion {
            Some(suggestion) => format!("{}\nexpected {expected}", printable(suggestion)),
            None => format!("expected {expected}"),
        }))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|excerpt| excerpt as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let excerpt = self.excerpt.as_ref()?;
        Some(Box::new(std::iter::once(LabeledSpan::new_primary_with_span(None, excerpt.label()))))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sim_core::spec::Span;
    use sim_format::Code;

    use super::*;

    const PLAIN: Screen = Screen { is_terminal: true, width: 80, has_colour: false };

    fn input(text: &str) -> Vec<InputFile> {
        vec![InputFile { path: "a.wld".to_owned(), bytes: text.as_bytes().to_vec() }]
    }

    fn diagnostics_of(text: &str) -> Vec<Diagnostic> {
        sim_format::read_world("a.wld", text).1
    }

    fn rendered(text: &str, screen: Screen) -> String {
        render(&diagnostics_of(text), &input(text), Format::Human, screen).expect("plain text")
    }

    fn widest(text: &str) -> usize {
        text.lines().map(console::measure_text_width).max().unwrap_or_default()
    }

    #[test]
    fn reports_fit_into_any_terminal() {
        let text = "floor 4000 3000\n0 0 4000\t0 ; a wall\nfloor 1OO 100 ; 世界 is wide\nush 100 100 0\npush 0 0 inf\n";
        for width in [40, 80, 200] {
            let output = rendered(text, Screen { width, ..PLAIN });
            assert!(widest(&output) <= width, "{output}");
            insta::assert_snapshot!(format!("report-{width}"), output);
        }
    }

    #[test]
    fn colours_are_added_to_words_and_signs() {
        let text = "floor 10 10\n0 0 1\npush 0 0 inf\n";
        let coloured = rendered(text, Screen { has_colour: true, ..PLAIN });
        assert_eq!(console::strip_ansi_codes(&coloured), rendered(text, PLAIN));
        // Orange and blue of the 256 colours, which do not depend on the user's palette of red and green.
        for sign in ["\x1b[38;5;166;1merror[number-range]", "\x1b[38;5;32;1mwarning[wld-wall-arity]"] {
            assert!(coloured.contains(sign), "{coloured:?}");
        }
        assert!(!coloured.contains("\x1b[31") && !coloured.contains("\x1b[32m"), "neither red nor green");
        insta::assert_snapshot!("report-in-colour", coloured.replace('\x1b', "ESC"));
    }

    #[test]
    fn only_some_of_many_mistakes_are_shown() {
        let text = format!("floor 9 9\n{}0 0 inf 0\n", "0 0 1\n".repeat(99));
        let output = rendered(&text, PLAIN);
        assert_eq!(output.matches("warning[wld-wall-arity]").count(), 19);
        assert_eq!(output.matches("error[number-range]").count(), 1, "errors come before warnings");
        assert!(output.ends_with("... and 80 more in a.wld: `--format short` lists all\n\n"), "{output}");
        assert_eq!(sim_host::launch::check::count(&diagnostics_of(&text)), "1 error, 99 warnings in 1 file");
    }

    #[test]
    fn short_format_has_one_line_per_diagnostic() {
        let mut diagnostics = diagnostics_of("floor 9 9\n0 0 1\nush 1 2 3\nwater\n");
        diagnostics[0].message = "not found\n  tried `a`\n  tried `\x1bb`".to_owned();
        let short = render(&diagnostics, &[], Format::Short, PLAIN).expect("plain text");
        let expected = "a.wld:2:1: warning[wld-wall-arity]: not found; tried `a`; tried `\u{fffd}b`; \
                        `push 0 0 1`, if a frame is meant\n\
                        a.wld:3:1: warning[wld-keyword]: unknown keyword `ush`; write `push`\n\
                        a.wld:4:1: warning[wld-water-arity]: `water` has 0 of 1 numbers; expected `water DEPTH` in mm\n";
        assert_eq!(short, expected);
        let logged = Screen { is_terminal: false, ..PLAIN };
        assert_eq!(render(&diagnostics, &[], Format::Auto, logged).expect("plain text"), expected);
        assert_eq!(render(&[], &[], Format::Json, PLAIN).expect("JSON"), "[]\n");
    }

    #[test]
    fn lines_of_100_kb_are_truncated() {
        let text = format!("floor 9 9\n{}\n0 0 1 {}\n", "x".repeat(100_000), "1 ".repeat(50_000));
        let output = rendered(&text, PLAIN);
        assert!(widest(&output) <= 80 && output.len() < 4000, "{output}");
        assert!(output.contains("╭─[a.wld:2:1]") && output.contains('…'), "{output}");
    }

    proptest! {
        /// Any text with any position of the mistake: no panic, no line that is too wide, no control character.
        #[test]
        fn any_text_with_any_span_is_rendered(
            text in "[a-c \t\r\n\u{0}\u{1b}\u{feff}é世\u{301}\u{1f916}]{0,80}",
            long in 0usize..3,
            (start, length) in (0usize..120, 0usize..120),
            (line, column) in (1u32..2000, 1u32..200),
            width in 30usize..220,
        ) {
            let text = text.repeat(1 + 40 * long);
            let span = Span { start, end: start + length, line, column };
            let diagnostic = Diagnostic {
                severity: Severity::Warning,
                code: Code::WldKeyword,
                file: "a.wld".to_owned(),
                span,
                message: format!("`{}`", text.chars().take(40).collect::<String>()),
                expected: "a word".to_owned(),
                suggestion: None,
            };
            let screen = Screen { width, ..PLAIN };
            let output = render(&[diagnostic], &input(&text), Format::Human, screen).expect("plain text");
            prop_assert!(widest(&output) <= width, "{} of {width} columns\n{output}", widest(&output));
            prop_assert!(!output.chars().any(|c| c.is_control() && c != '\n'), "{output:?}");
        }
    }
}
