//! Drawings of the modelling cases of Figures 2 to 5: readings as arcs, with lines and cells.

use std::fmt::Write as _;

use mapping::grid::{Cell, GridGeometry};
use mapping::line::{dda, point_by_point, supercover};
use mapping::math;
use mapping::pose::{Point, direction};
use mapping::sector::{Case, Model};

use super::maps::FAN;
use crate::page::{Figure, Page, Picture};

/// Readings of the sectors C, D and E, as distances from the robot's centre in metres, with their case.
struct Example {
    title: &'static str,
    readings: [Option<f64>; 3],
    case: Case,
    /// The wall behind the readings, as points in metres, if there is one: x ahead, y to the left.
    wall: Vec<Point>,
}

/// Pixels per metre.
const METRE: f64 = 180.0;
/// Size of a panel, in pixels.
const PANEL: (f64, f64) = (440.0, 320.0);
/// Position of the robot in a panel, in pixels.
const ROBOT: (f64, f64) = (220.0, 290.0);

/// Adds Figures 2 to 5.
///
/// # Errors
/// If an example is modelled as another case.
pub fn figures(page: &mut Page) -> anyhow::Result<()> {
    page.text(
        "Sectors C (right), D (ahead) and E (left) of 30 degrees each: their readings as arcs, the lines that are modelled within D in \
         red, and in grey the walls from which the readings come: the nearest point of each sector.",
    );
    let walls = vec![
        Example::of_walls("2a: wall beside", Case::WallBeside, &[(-15.0, 0.9)]),
        Example::of_walls("2b: wall ahead", Case::WallAhead, &[(3.0, 1.0)]),
        Example::of_walls("2c: corner", Case::Corner, &[(-40.0, 0.9), (40.0, 0.9)]),
    ];
    page.figure(panels("figure-2", "Figure 2", "Continuous on both sides.", walls)?);
    let faults = vec![
        Example {
            title: "3a: fault beyond",
            readings: [Some(0.9), Some(0.95), Some(1.4)],
            case: Case::FaultBeyond,
            wall: Vec::new(),
        },
        Example {
            title: "3b: fault before",
            readings: [Some(1.05), Some(0.95), None],
            case: Case::FaultBefore,
            wall: Vec::new(),
        },
    ];
    page.figure(panels("figure-3", "Figure 3", "Continuous on one side alone.", faults)?);
    let both = vec![
        Example {
            title: "4: gap and gap",
            readings: [Some(1.4), Some(0.8), Some(1.3)],
            case: Case::FaultBothSides,
            wall: Vec::new(),
        },
        Example {
            title: "4: interval and open",
            readings: [Some(0.7), Some(0.9), None],
            case: Case::FaultBothSides,
            wall: Vec::new(),
        },
        Example {
            title: "left out: open and open",
            readings: [None, Some(0.9), None],
            case: Case::FaultBothSides,
            wall: Vec::new(),
        },
    ];
    page.figure(panels("figure-4", "Figure 4", "Continuous on no side.", both)?);
    page.figure(cells());
    Ok(())
}

impl Example {
    /// The readings of straight walls by sonars whose beams are as wide as their sectors. A wall is the direction of
    /// its foot (degrees from the axis of sector D) and its distance.
    fn of_walls(title: &'static str, case: Case, walls: &[(f64, f64)]) -> Self {
        let nearest = |sector: f64, (foot, distance): (f64, f64)| {
            let off = ((foot.to_radians() - sector).abs() - 0.5 * FAN.sector).max(0.0);
            distance / math::cos(off)
        };
        let readings = [-FAN.sector, 0.0, FAN.sector]
            .map(|sector| walls.iter().map(|wall| nearest(sector, *wall)).min_by(f64::total_cmp));
        // A wall is visible only where no other wall is nearer.
        let points = (-45..=45).map(|degrees| {
            let angle = f64::from(degrees).to_radians();
            let along = walls.iter().map(|(foot, distance)| distance / math::cos(angle - foot.to_radians()));
            Point::from(direction(angle) * along.fold(f64::INFINITY, f64::min))
        });
        Self { title, readings, case, wall: points.collect() }
    }

    fn model(&self) -> anyhow::Result<Model> {
        let [right, own, left] = self.readings.map(|reading| reading.map(|distance| distance - FAN.radius));
        let model = FAN.model(right, own, left);
        anyhow::ensure!(model.case == self.case, "{}: modelled as {:?}", self.title, model.case);
        Ok(model)
    }

    /// Distance of the ends of the model's lines from the walls, in metres; `None` without walls.
    fn error(&self, model: &Model) -> Option<f64> {
        let distance_to_nearest = |point: Point| {
            let along = |pair: &[Point]| {
                let segment = pair[1] - pair[0];
                let fraction = ((point - pair[0]).dot(&segment) / segment.norm_squared()).clamp(0.0, 1.0);
                (point - (pair[0] + fraction * segment)).norm()
            };
            self.wall.windows(2).map(along).min_by(f64::total_cmp)
        };
        let ends = model.lines.iter().flat_map(|line| [line.from, line.to]);
        ends.filter_map(distance_to_nearest).max_by(f64::total_cmp)
    }
}

/// Position in a panel of a point in the robot's frame: x up, y to the left.
fn place(point: Point) -> String {
    format!("{:.1},{:.1}", ROBOT.0 - METRE * point.y, ROBOT.1 - METRE * point.x)
}

fn polyline(points: impl IntoIterator<Item = Point>, style: &str) -> String {
    let points: Vec<String> = points.into_iter().map(place).collect();
    format!("<polyline points=\"{}\" fill=\"none\" {style}/>\n", points.join(" "))
}

fn text(x: f64, y: f64, size: f64, words: &str) -> String {
    let words = crate::page::escaped(words);
    format!(
        "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" font-family=\"DejaVu Sans, sans-serif\" text-anchor=\"middle\">{words}</text>\n"
    )
}

fn panels(name: &str, label: &str, caption: &str, examples: Vec<Example>) -> anyhow::Result<Figure> {
    let mut body = String::new();
    let mut worst: Option<f64> = None;
    for (index, example) in examples.iter().enumerate() {
        let model = example.model()?;
        worst = example.error(&model).into_iter().chain(worst).max_by(f64::total_cmp);
        // Writing to a string cannot fail.
        let _ =
            write!(body, "<g transform=\"translate({} 0)\">\n{}</g>\n", PANEL.0 * index as f64, panel(example, &model));
    }
    let (claim, number) = match worst {
        Some(worst) => ("Farthest end of a line from its wall".to_owned(), format!("{:.1} mm", 1e3 * worst)),
        None => ("Lines in D".to_owned(), examples.iter().map(|_| "1").collect::<Vec<_>>().join(", ")),
    };
    Ok(Figure {
        name: name.to_owned(),
        label: label.to_owned(),
        caption: caption.to_owned(),
        claim,
        number,
        picture: Picture::Svg(svg(PANEL.0 * examples.len() as f64, PANEL.1, &body)),
    })
}

fn svg(width: f64, height: f64, body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n{body}</svg>\n"
    )
}

fn panel(example: &Example, model: &Model) -> String {
    let half = 0.5 * FAN.sector;
    let mut body = polyline(example.wall.iter().copied(), "stroke=\"#bbb\" stroke-width=\"7\"");
    for edge in [-3.0, -1.0, 1.0, 3.0] {
        let edge = direction(edge * half);
        body += &polyline([Point::origin(), Point::from(1.5 * edge)], "stroke=\"#999\" stroke-dasharray=\"3 4\"");
    }
    for (sector, (reading, letter)) in (-1..=1).zip(example.readings.iter().zip(["C", "D", "E"])) {
        let middle = f64::from(sector) * FAN.sector;
        let at = reading.unwrap_or(1.2);
        if reading.is_some() {
            let arc = (-8..=8).map(|step| Point::from(at * direction(middle + f64::from(step) / 8.0 * half)));
            body += &polyline(arc, "stroke=\"#06c\" stroke-width=\"2.5\"");
        }
        let word = reading.map_or(format!("{letter}: open"), |at| format!("{letter} {at:.2} m"));
        let label = (at - 0.12) * direction(middle);
        body += &text(ROBOT.0 - METRE * label.y, ROBOT.1 - METRE * label.x, 11.0, &word);
    }
    for line in &model.lines {
        body += &polyline([line.from, line.to], "stroke=\"#d00\" stroke-width=\"3.5\"");
        for end in [line.from, line.to] {
            let (x, y) = (ROBOT.0 - METRE * end.y, ROBOT.1 - METRE * end.x);
            let _ = writeln!(body, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"#d00\"/>");
        }
    }
    let _ = writeln!(
        body,
        "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"#ddd\" stroke=\"#444\"/>",
        ROBOT.0,
        ROBOT.1,
        METRE * FAN.radius
    );
    body + &text(ROBOT.0, 16.0, 14.0, example.title)
}

/// Figure 5: the cells of a line by point-by-point comparison, by DDA, and by the exact test (all cells that the line
/// touches).
fn cells() -> Figure {
    const SIDE: f64 = 22.0;
    const CELLS: (usize, usize) = (13, 8);
    let frame = GridGeometry::new(Point::origin(), 1.0, CELLS.0, CELLS.1);
    let (from, to) = (Cell::new(1, 1), Cell::new(11, 5));
    let touched = supercover(&frame, frame.centre(from), frame.centre(to));
    let (by_points, by_dda) = (point_by_point(from, to), dda(from, to));
    let extra = by_points.iter().filter(|cell| !touched.contains(cell)).count();
    let lists = [("point by point", &by_points), ("DDA", &by_dda), ("all that it touches", &touched)];
    let panel = (SIDE * (CELLS.0 as f64 + 1.0), SIDE * (CELLS.1 as f64 + 2.0));
    let y = |row: f64| panel.1 - SIDE * (row + 0.5);
    let mut body = String::new();
    for (index, (title, cells)) in lists.iter().enumerate() {
        let left = panel.0 * index as f64 + 0.5 * SIDE;
        for cell in frame.cells() {
            let colour = match (cells.contains(&cell), touched.contains(&cell)) {
                (true, true) => "#888",
                (true, false) => "#e66",
                _ => "white",
            };
            let _ = writeln!(
                body,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{SIDE}\" height=\"{SIDE}\" fill=\"{colour}\" stroke=\"#ccc\"/>",
                left + SIDE * cell.column as f64,
                y(cell.row as f64 + 1.0)
            );
        }
        let middle = |cell: Cell| (left + SIDE * (cell.column as f64 + 0.5), y(cell.row as f64 + 0.5));
        let ((x1, y1), (x2, y2)) = (middle(from), middle(to));
        let _ = writeln!(
            body,
            "<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\" stroke=\"#d00\" stroke-width=\"2\"/>"
        );
        body += &text(left + 0.5 * SIDE * CELLS.0 as f64, 18.0, 14.0, &format!("{title}: {} cells", cells.len()));
    }
    Figure {
        name: "figure-5".to_owned(),
        label: "Figure 5".to_owned(),
        caption: "A line in the grid. Point by point makes |dx| + |dy| steps, each along one axis; DDA max(|dx|, |dy|), some of them \
                  diagonal."
            .to_owned(),
        claim: "Cells that the line does not touch, point by point and DDA".to_owned(),
        number: format!("{extra} (red), {}", by_dda.iter().filter(|cell| !touched.contains(cell)).count()),
        picture: Picture::Svg(svg(panel.0 * lists.len() as f64, panel.1, &body)),
    }
}
