//! Table printed for users at the end of a run; programs read the report instead.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use console::{Style, Term, measure_text_width, truncate_str};

use sim_core::record::Outcome;
use sim_host::record::log::Printable;
use sim_host::record::report::{CheckReport, PlanarPose, Report, RobotReport};

/// With more robots than this, only the first and the failed ones are shown.
const MAX_ROWS: usize = 24;
/// Number of first robots that are shown in that case, in addition to the failed ones.
const FIRST_ROWS: usize = 10;
/// Width in columns to which the paths of programs are cut before any column of the table moves below the rows.
const PROGRAM_WIDTH: usize = 20;
/// Gap between two cells.
const GAP: &str = "  ";
/// Indentation of the lines below a robot's row.
const INDENT: &str = "    ";

/// Capabilities of the terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableScreen {
    /// Columns per line.
    pub width: usize,
    /// True if colours may be used; nothing is shown by colour alone.
    pub has_colour: bool,
}

impl TableScreen {
    /// The terminal on standard output; without one, lines of any length and no colour.
    pub fn of_stdout() -> Self {
        let width = Term::stdout().size_checked().map_or(usize::MAX, |(_, columns)| usize::from(columns).max(40));
        Self { width, has_colour: console::colors_enabled() }
    }
}

/// Renders the table of robots, and below it lines about the whole run and the checks.
pub fn render(report: &Report, screen: TableScreen) -> String {
    let robots = shown_robots(&report.robots);
    let mut text = String::new();
    for line in Table::fitting(&robots, screen).lines(&robots, screen) {
        push_line(&mut text, &line);
    }
    if report.robots.len() > 1 {
        push_line(&mut text, &counts(&report.robots, robots.len()));
    }
    push_line(&mut text, &summary(report));
    checks(report, screen).iter().for_each(|line| push_line(&mut text, line));
    text
}

/// Results of the checks: a line with their number and points, then a line for each check.
pub fn checks(report: &Report, screen: TableScreen) -> Vec<String> {
    if report.checks.is_empty() {
        return Vec::new();
    }
    let passed_count = report.checks.iter().filter(|check| check.passed).count();
    let (points, max_points) = (points(report.points), points(report.max_points));
    let is_failed = report.robots.iter().any(|robot| robot.outcome.is_failure());
    let restriction = if is_failed { " (none in `eyesim test`, since a program failed)" } else { "" };
    let mut lines = vec![format!(
        "checks: {passed_count} of {} passed, {points} of {max_points} points{restriction}",
        report.checks.len()
    )];
    let width = |cell: &dyn Fn(&CheckReport) -> String| {
        report.checks.iter().map(|check| measure_text_width(&cell(check))).max().unwrap_or_default()
    };
    let (name, fraction_text) = (
        |check: &CheckReport| Printable(&check.name).to_string(),
        |check: &CheckReport| format!("{}/{}", self::points(check.points), self::points(check.max_points)),
    );
    let (name_width, fraction_width) = (width(&name).min(PROGRAM_WIDTH), width(&fraction_text));
    for check in &report.checks {
        let (word, style) =
            if check.passed { ("passed", Style::new().green()) } else { ("FAILED", Style::new().red().bold()) };
        let (name, fraction_text) = (name(check), fraction_text(check));
        let blanks = |width: usize, text: &str| " ".repeat(width.saturating_sub(measure_text_width(text)));
        let (after, before) = (blanks(name_width, &name), blanks(fraction_width, &fraction_text));
        let line = format!("{word}  {name}{after}  {before}{fraction_text}  {}", Printable(&check.message));
        lines.push(fold(&line, screen).trim_start().replacen(word, &paint(style, screen, word), 1));
    }
    lines
}

/// Points with at most two digits after the point, rounded down.
fn points(points: f64) -> String {
    ((points * 100.0 + 1e-6).floor() / 100.0).to_string()
}

/// Appends a line without blanks at its end.
fn push_line(text: &mut String, line: &str) {
    text.push_str(line.trim_end());
    text.push('\n');
}

/// All robots, or the first and the failed ones.
fn shown_robots(robots: &[RobotReport]) -> Vec<&RobotReport> {
    if robots.len() <= MAX_ROWS {
        return robots.iter().collect();
    }
    let is_shown = |(index, robot): &(usize, &RobotReport)| *index < FIRST_ROWS || robot.outcome.is_failure();
    robots.iter().enumerate().filter(is_shown).map(|(_, robot)| robot).collect()
}

/// `5 robots: 3 finished, 2 failed`, and the number of robots without a row.
fn counts(robots: &[RobotReport], shown: usize) -> String {
    let mut by_outcome: BTreeMap<Outcome, usize> = BTreeMap::new();
    robots.iter().for_each(|robot| *by_outcome.entry(robot.outcome).or_default() += 1);
    let parts: Vec<_> = by_outcome.iter().map(|(outcome, count)| format!("{count} {}", word(*outcome))).collect();
    let mut line = format!("{} robots: {}", robots.len(), parts.join(", "));
    if shown < robots.len() {
        // Writing to a string cannot fail.
        _ = write!(line, "; {} not shown, all are in the report (--report FILE)", robots.len() - shown);
    }
    line
}

/// Line with simulated and wall-clock time, their ratio and the digest.
fn summary(report: &Report) -> String {
    let (simulated, real) = (report.sim_time_s, report.real_time_s);
    let factor = simulated / real;
    let speed = match factor {
        factor if !factor.is_finite() || simulated <= 0.0 => String::new(),
        factor if factor < 10.0 => format!(", {factor:.1} times real time"),
        factor => format!(", {factor:.0} times real time"),
    };
    format!("simulated {simulated:.3} s in {real:.3} s{speed}\ndigest {}", report.digest)
}

/// Column of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    Robot,
    Program,
    Outcome,
    Time,
    Path,
    Contacts,
    Pose,
    Odometry,
}

impl Column {
    const ALL: [Self; 8] =
        [Self::Robot, Self::Program, Self::Outcome, Self::Time, Self::Path, Self::Contacts, Self::Pose, Self::Odometry];

    fn heading(self) -> &'static str {
        match self {
            Self::Robot => "robot",
            Self::Program => "program",
            Self::Outcome => "outcome",
            Self::Time => "time/s",
            Self::Path => "path/m",
            Self::Contacts => "contacts",
            Self::Pose => "pose: x/m, y/m, phi/rad",
            Self::Odometry => "odometry",
        }
    }

    fn cell(self, robot: &RobotReport) -> String {
        match self {
            Self::Robot => format!("r{} {}", robot.id, Printable(&robot.name)),
            Self::Program if robot.program.is_empty() => "none".to_owned(),
            Self::Program => Printable(&robot.program).to_string(),
            Self::Outcome => outcome(robot),
            Self::Time => format!("{:.3}", robot.virtual_time_s),
            Self::Path => format!("{:.3}", robot.path_m),
            Self::Contacts => robot.contacts.to_string(),
            Self::Pose => pose(&robot.pose),
            Self::Odometry => robot.odometry.as_ref().map_or_else(|| "none".to_owned(), pose),
        }
    }

    fn is_number(self) -> bool {
        matches!(self, Self::Time | Self::Path | Self::Contacts)
    }
}

/// `failed (3)`: the outcome, and the exit code unless it is 0.
fn outcome(robot: &RobotReport) -> String {
    match robot.exit_code {
        Some(code) if code != 0 => format!("{} ({code})", word(robot.outcome)),
        _ => word(robot.outcome),
    }
}

/// The outcome in words: `no program`.
fn word(outcome: Outcome) -> String {
    outcome.name().replace('_', " ")
}

fn pose(pose: &PlanarPose) -> String {
    // No minus sign before a value rounded to zero.
    let without_minus_zero = |value: f64| if value.abs() < 5e-4 { 0.0 } else { value };
    format!(
        "{:7.3} {:7.3} {:6.3}",
        without_minus_zero(pose.x_m),
        without_minus_zero(pose.y_m),
        without_minus_zero(pose.phi_rad)
    )
}

/// Columns of a table with their widths, and the columns that are printed below each row instead.
struct Table {
    columns: Vec<(Column, usize)>,
    columns_below: Vec<Column>,
}

impl Table {
    /// Creates a table of `robots` that fits the screen. Until it fits, it first cuts the programs, then moves the
    /// odometry and the pose below the rows, and then cuts the names.
    fn fitting(robots: &[&RobotReport], screen: TableScreen) -> Self {
        let width = |column: Column| {
            let cells = robots.iter().map(|robot| measure_text_width(&column.cell(robot)));
            cells.fold(column.heading().len(), usize::max)
        };
        let mut table =
            Self { columns: Column::ALL.map(|column| (column, width(column))).to_vec(), columns_below: vec![] };
        table.cut(Column::Program, PROGRAM_WIDTH, screen);
        while table.width() > screen.width && table.columns_below.len() < 2 {
            if let Some((column, _)) = table.columns.pop() {
                table.columns_below.insert(0, column);
            }
        }
        table.cut(Column::Program, Column::Program.heading().len(), screen);
        table.cut(Column::Robot, Column::Robot.heading().len(), screen);
        table
    }

    /// Narrows `column` as far as the screen demands, but not below `min_width` columns.
    fn cut(&mut self, column: Column, min_width: usize, screen: TableScreen) {
        let excess = self.width().saturating_sub(screen.width);
        if let Some((_, width)) = self.columns.iter_mut().find(|(other, _)| *other == column) {
            *width = width.saturating_sub(excess).max(min_width.min(*width));
        }
    }

    fn width(&self) -> usize {
        self.columns.iter().map(|(_, width)| width + GAP.len()).sum::<usize>() - GAP.len()
    }

    fn lines(&self, robots: &[&RobotReport], screen: TableScreen) -> Vec<String> {
        let mut lines = vec![paint(Style::new().bold(), screen, &self.row(|column| column.heading().to_owned(), None))];
        for robot in robots {
            lines.push(self.row(|column| column.cell(robot), Some((robot.outcome, screen))));
            lines.extend(self.details(robot).iter().map(|line| fold(line, screen)));
        }
        lines
    }

    /// A line with a cell in each column; the outcome is coloured if `painted` names it.
    fn row(&self, cell: impl Fn(Column) -> String, painted: Option<(Outcome, TableScreen)>) -> String {
        let padded_cell = |(column, width): &(Column, usize)| {
            let text = cell(*column);
            let text = match column {
                Column::Program => keep_end(&text, *width),
                _ => truncate_str(&text, *width, "\u{2026}").into_owned(),
            };
            let blanks = " ".repeat(width.saturating_sub(measure_text_width(&text)));
            match painted {
                _ if column.is_number() => blanks + &text,
                Some((outcome, screen)) if *column == Column::Outcome => {
                    paint(outcome_style(outcome), screen, &text) + &blanks
                }
                _ => text + &blanks,
            }
        };
        self.columns.iter().map(padded_cell).collect::<Vec<_>>().join(GAP)
    }

    /// Lines below the row of a robot.
    fn details(&self, robot: &RobotReport) -> Vec<String> {
        let mut lines: Vec<_> =
            self.columns_below.iter().map(|column| format!("{}  {}", column.heading(), column.cell(robot))).collect();
        lines.extend(robot.reason.iter().map(|reason| Printable(reason).to_string()));
        let lcd: Vec<_> = robot.lcd.iter().map(|line| line.trim_end()).filter(|line| !line.is_empty()).collect();
        if !lcd.is_empty() {
            lines.push(format!("lcd: {}", Printable(&lcd.join(" | "))));
        }
        lines
    }
}

/// The last `width` columns of a path, with a marker at the cut.
fn keep_end(path: &str, width: usize) -> String {
    if measure_text_width(path) <= width {
        return path.to_owned();
    }
    let fits = |(start, _): &(usize, char)| measure_text_width(&path[*start..]) < width;
    path.char_indices().find(fits).map_or_else(String::new, |(start, _)| format!("\u{2026}{}", &path[start..]))
}

/// Indents `line`, and breaks it between words if it is wider than the screen.
fn fold(line: &str, screen: TableScreen) -> String {
    let mut folded = INDENT.to_owned();
    let mut column = INDENT.len();
    for word in line.split_inclusive(' ') {
        let width = measure_text_width(word.trim_end());
        if column + width > screen.width && column > INDENT.len() {
            folded.truncate(folded.trim_end().len());
            folded.push('\n');
            folded.push_str(INDENT);
            column = INDENT.len();
        }
        folded.push_str(word);
        column += measure_text_width(word);
    }
    folded
}

fn outcome_style(outcome: Outcome) -> Style {
    match outcome {
        Outcome::Finished => Style::new().green(),
        Outcome::Running | Outcome::NoProgram | Outcome::Removed | Outcome::Halted => Style::new(),
        Outcome::Interrupted => Style::new().yellow(),
        Outcome::Waiting | Outcome::Failed | Outcome::Timeout => Style::new().red(),
    }
}

fn paint(style: Style, screen: TableScreen, text: &str) -> String {
    if screen.has_colour { style.force_styling(true).apply_to(text).to_string() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use sim_core::record::Digest;
    use sim_host::record::report::REPORT_SCHEMA;

    use super::*;

    fn robot(id: u32, outcome: Outcome) -> RobotReport {
        let lcd = ["Square", "", "", "", "", "side 4", "GO          END"].map(str::to_owned).to_vec();
        RobotReport {
            id,
            name: "eve".into(),
            program: "square.c".into(),
            outcome,
            reason: None,
            exit_code: Some(0),
            virtual_time_s: 12.345_678,
            start: PlanarPose { x_m: 0.0, y_m: 0.0, phi_rad: 0.0 },
            pose: PlanarPose { x_m: 0.5, y_m: -1.25, phi_rad: -1e-9 },
            depth_m: None,
            odometry: None,
            path_m: 1.6,
            contacts: 0,
            contact_times_s: Vec::new(),
            hints: Vec::new(),
            metrics: Default::default(),
            forbidden_calls: Default::default(),
            left_floor_s: None,
            footfalls: None,
            touches: None,
            lcd: if id == 1 { lcd } else { vec![String::new(); 7] },
            output_cut_bytes: 0,
            added_s: None,
            removed_s: None,
        }
    }

    fn report(robots: Vec<RobotReport>) -> Report {
        Report {
            sandbox: None,
            schema: REPORT_SCHEMA,
            eyesim_version: "0.1.0".into(),
            argv: vec![],
            inputs: vec![],
            seed: 1,
            slot_us: 50_000,
            sim_time_s: 12.35,
            real_time_s: 0.0025,
            digest: Digest([0xab; 32]),
            robots,
            objects: Vec::new(),
            drawn: Vec::new(),
            checks: Vec::new(),
            points: 0.0,
            max_points: 0.0,
        }
    }

    fn report_of_three() -> Report {
        let odometry = Some(PlanarPose { x_m: 10.125, y_m: 0.0, phi_rad: 3.125 });
        let waiting = RobotReport {
            reason: Some("waits for KEY4 since 2.31 s at maze.c:88 (try --keys \"3:KEY4\")".into()),
            exit_code: None,
            program: "a/program/with/a/long/path/maze-left-hand.c".into(),
            odometry,
            ..robot(2, Outcome::Waiting)
        };
        let failed = RobotReport {
            reason: Some("returned 3".into()),
            exit_code: Some(3),
            contacts: 12,
            left_floor_s: None,
            ..robot(3, Outcome::Failed)
        };
        report(vec![RobotReport { odometry, ..robot(1, Outcome::Finished) }, waiting, failed])
    }

    fn report_of_many() -> Report {
        let outcome = |id| if id % 50 == 0 { Outcome::Timeout } else { Outcome::Running };
        report((1..=120).map(|id| robot(id, outcome(id))).collect())
    }

    fn widest(text: &str) -> usize {
        text.lines().filter(|line| !line.starts_with("digest")).map(measure_text_width).max().unwrap()
    }

    #[test]
    fn wide_screen_shows_one_row_per_robot() {
        insta::assert_snapshot!(render(&report_of_three(), TableScreen { width: usize::MAX, has_colour: false }));
    }

    #[test]
    fn table_fits_80_columns() {
        let text = render(&report_of_three(), TableScreen { width: 80, has_colour: false });
        assert!(widest(&text) <= 80, "{text}");
        insta::assert_snapshot!(text);
    }

    #[test]
    fn narrow_screen_breaks_reasons_between_words() {
        let text = render(&report_of_three(), TableScreen { width: 60, has_colour: false });
        assert!(widest(&text) <= 60, "{text}");
        assert!(text.contains("waits for KEY4 since 2.31 s at maze.c:88 (try --keys\n    \"3:KEY4\")"), "{text}");
    }

    #[test]
    fn many_robots_are_summarised() {
        let text = render(&report_of_many(), TableScreen { width: 120, has_colour: false });
        insta::assert_snapshot!(text);
    }

    #[test]
    fn coloured_table_has_the_text_of_the_plain_one() {
        for report in [report_of_three(), report_of_many()] {
            let plain = render(&report, TableScreen { width: 100, has_colour: false });
            let painted = render(&report, TableScreen { width: 100, has_colour: true });
            assert_ne!(plain, painted);
            let stripped: Vec<_> =
                painted.lines().map(|line| console::strip_ansi_codes(line).trim_end().to_owned()).collect();
            assert_eq!(plain.lines().collect::<Vec<_>>(), stripped);
        }
    }

    #[test]
    fn robot_without_a_program_is_marked() {
        let without_program = RobotReport { program: String::new(), exit_code: None, ..robot(2, Outcome::NoProgram) };
        let text = render(
            &report(vec![robot(1, Outcome::Finished), without_program]),
            TableScreen { width: 120, has_colour: false },
        );
        let row = text.lines().find(|line| line.starts_with("r2")).expect("a row");
        assert_eq!(row.split_whitespace().collect::<Vec<_>>()[2..5], ["none", "no", "program"], "{text}");
        assert!(text.contains("2 robots: 1 finished, 1 no program\n"), "{text}");
    }

    #[test]
    fn control_characters_of_programs_are_escaped() {
        let mut report = report(vec![robot(1, Outcome::Finished)]);
        report.robots[0].lcd[0] = "\u{1b}[2J".into();
        let text = render(&report, TableScreen { width: 80, has_colour: false });
        assert!(text.contains("\\u{1b}[2J") && !text.contains('\u{1b}'), "{text}");
    }
}
