//! The picture of a run: the world from above, to scale, with the robots' trails.
//!
//! Takes plain data, so that it knows nothing of worlds and programs. Colours are those of Okabe & Ito that stand out on
//! white; they can be told apart by people with any kind of colour vision, and ids are written beside the robots too.

use std::collections::BTreeSet;
use std::path::Path;

use glam::DVec2;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use sim_core::pose::Pose;

use super::recorder::RecordError;
use super::report::write_whole;

/// What is drawn. Lengths are in metres, in the world's frame.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    /// The line above the picture.
    pub title: String,
    /// Opposite corners of the floor, where the world has one.
    pub floor: Option<[DVec2; 2]>,
    /// The walls from end to end.
    pub walls: Vec<[DVec2; 2]>,
    /// The robots in order of their ids.
    pub robots: Vec<PlotRobot>,
    /// Points where bodies touched.
    pub contacts: Vec<DVec2>,
}

/// A robot of a [`Plot`].
#[derive(Clone, Debug)]
pub struct PlotRobot {
    /// Its number.
    pub id: u32,
    /// Its name.
    pub name: String,
    /// Radius of the circle around its body.
    pub radius: f64,
    /// Where it started.
    pub start: Pose,
    /// Where it ended.
    pub end: Pose,
    /// Where it has been.
    pub trail: Vec<DVec2>,
}

/// Colours of the robots, in order of their places in the list, again from the first after the last.
const PALETTE: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];
const WALL: RGBColor = RGBColor(51, 51, 51);
const FLOOR: RGBColor = RGBColor(248, 247, 243);
const GRID: RGBColor = RGBColor(226, 226, 226);
const INK: RGBColor = RGBColor(34, 34, 34);

/// Drawing units a pixel: plotters rounds to whole units, so this gives a quarter of a pixel.
const UNIT: i32 = 4;
/// Longer side of the world's picture, pixels.
const LONG_SIDE: f64 = 800.0;
/// Least length of its shorter side, pixels: enough for the legend of one robot.
const SHORT_SIDE: f64 = 150.0;
/// Widths around the picture, pixels.
const TOP: i32 = 36;
const RIGHT: i32 = 14;
const BOTTOM: i32 = 50;
const LEFT: i32 = 72;
/// Part of it that stays empty.
const EDGE: i32 = 10;
/// Width of the legend, pixels, and height of its lines.
const LEGEND: i32 = 190;
const LINE: i32 = 18;
/// Least radius of the mark of a robot, pixels.
const MARK: f64 = 4.0;
/// With more robots than this, ids beside the robots would hide the picture.
const MAX_LABELS: usize = 100;
const TEXT: i32 = 12;

/// The world's picture: which part of the world, how large.
struct Frame {
    min: DVec2,
    max: DVec2,
    /// Pixels a metre, the same in both directions.
    scale: f64,
}

impl Frame {
    /// The frame that shows all of `plot` with some room around it.
    fn around(plot: &Plot) -> Self {
        let around_robot = |robot: &PlotRobot| {
            [robot.start, robot.end]
                .map(|pose| [-1.0, 1.0].map(|side| pose.position + DVec2::splat(side * robot.radius)))
        };
        let points = plot.floor.iter().chain(&plot.walls).flatten().copied();
        let points = points.chain(plot.robots.iter().flat_map(around_robot).flatten());
        let points = points.chain(plot.robots.iter().flat_map(|robot| robot.trail.iter().copied()));
        let points = points.chain(plot.contacts.iter().copied()).filter(|point| point.is_finite());
        let bounds = points.fold(None, |bounds: Option<(DVec2, DVec2)>, point| {
            let (min, max) = bounds.unwrap_or((point, point));
            Some((min.min(point), max.max(point)))
        });
        let (min, max) = bounds.unwrap_or((DVec2::ZERO, DVec2::ONE));
        let (centre, size) = (0.5 * (min + max), (max - min).max(DVec2::splat(1e-3)));
        let size = size + DVec2::splat(0.05 * size.max_element());
        let scale = LONG_SIDE / size.max_element();
        // Whole pixels, so that both directions have the same scale.
        let size = (size * scale).max(DVec2::splat(SHORT_SIDE)).ceil() / scale;
        Self { min: centre - 0.5 * size, max: centre + 0.5 * size, scale }
    }

    /// Width and height in pixels.
    fn pixels(&self) -> (i32, i32) {
        let size = ((self.max - self.min) * self.scale).round();
        (size.x as i32, size.y as i32)
    }
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type DrawResult<'a> = Result<(), DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>>;

impl Plot {
    /// The picture as SVG text.
    ///
    /// # Errors
    /// [`RecordError::Plot`] if the drawing library refuses it.
    pub fn to_svg(&self) -> Result<String, RecordError> {
        let frame = Frame::around(self);
        let (width, height) = frame.pixels();
        let size = (LEFT + width + RIGHT + LEGEND, TOP + height + BOTTOM);
        let units = ((size.0 * UNIT) as u32, (size.1 * UNIT) as u32);
        let mut svg = String::new();
        let area = SVGBackend::with_string(&mut svg, units).into_drawing_area();
        self.draw(&area, &frame).and_then(|()| area.present()).map_err(|error| RecordError::Plot(error.to_string()))?;
        drop(area);
        // Drawn in fine units, shown at its size in pixels.
        let fine = format!("width=\"{}\" height=\"{}\"", units.0, units.1);
        Ok(svg.replacen(&fine, &format!("width=\"{}\" height=\"{}\"", size.0, size.1), 1))
    }

    /// Writes the picture to `path`, as a whole or not at all.
    ///
    /// # Errors
    /// [`RecordError::Write`] if it cannot be written, [`RecordError::Plot`] as for [`Self::to_svg`].
    pub fn write(&self, path: &Path) -> Result<(), RecordError> {
        write_whole(path, self.to_svg()?.as_bytes()).map_err(|source| RecordError::write("plot", path, source))
    }

    fn draw<'b>(&self, area: &Area<'b>, frame: &Frame) -> DrawResult<'b> {
        area.fill(&WHITE)?;
        let (width, _) = frame.pixels();
        let (picture, legend) = area.split_horizontally((LEFT + width + RIGHT) * UNIT);
        area.draw(&Text::new(self.title.clone(), (LEFT * UNIT, 12 * UNIT), text(14)))?;
        let mut chart = ChartBuilder::on(&picture)
            .margin_top(TOP * UNIT)
            .margin_right(RIGHT * UNIT)
            .margin_left(EDGE * UNIT)
            .x_label_area_size(BOTTOM * UNIT)
            .y_label_area_size((LEFT - EDGE) * UNIT)
            .build_cartesian_2d(frame.min.x..frame.max.x, frame.min.y..frame.max.y)?;
        self.draw_ground(&mut chart, frame)?;
        self.draw_robots(&mut chart, frame)?;
        self.draw_contacts(&mut chart, frame)?;
        self.draw_legend(&legend, frame)
    }

    /// Floor, axes, walls.
    fn draw_ground<'b>(&self, chart: &mut Chart<'_, 'b>, frame: &Frame) -> DrawResult<'b> {
        if let Some(corners) = self.floor {
            chart.draw_series([Rectangle::new(corners.map(xy), FLOOR.filled())])?;
        }
        let (width, height) = frame.pixels();
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(GRID.stroke_width(UNIT as u32))
            .axis_style(INK.stroke_width(UNIT as u32))
            .set_all_tick_mark_size(5 * UNIT)
            .x_labels((width / 80).clamp(2, 12) as usize)
            .y_labels((height / 40).clamp(2, 20) as usize)
            .label_style(text(TEXT))
            .axis_desc_style(text(TEXT))
            .x_desc("x in m")
            .y_desc("y in m")
            .draw()?;
        let line = WALL.stroke_width(2 * UNIT as u32);
        chart.draw_series(self.walls.iter().map(|ends| PathElement::new(ends.map(xy).to_vec(), line)))?;
        Ok(())
    }

    /// Trails, then start and end above all trails.
    fn draw_robots<'b>(&self, chart: &mut Chart<'_, 'b>, frame: &Frame) -> DrawResult<'b> {
        for (index, robot) in self.robots.iter().enumerate() {
            let line = colour(index).stroke_width(3 * UNIT as u32 / 2);
            let points: Vec<_> = robot.trail.iter().map(|point| xy(*point)).collect();
            if points.len() > 1 {
                chart.draw_series([PathElement::new(points, line)])?;
            }
        }
        for (index, robot) in self.robots.iter().enumerate() {
            let radius = (robot.radius * frame.scale).max(MARK);
            let units = (radius * f64::from(UNIT)).round() as i32;
            let line = colour(index).stroke_width(3 * UNIT as u32 / 2);
            let nose = |pose: &Pose| {
                let tip = pose.position + pose.heading.direction() * (radius / frame.scale);
                PathElement::new(vec![xy(pose.position), xy(tip)], INK.stroke_width(5 * UNIT as u32 / 4))
            };
            chart.draw_series([Circle::new(xy(robot.start.position), units, line)])?;
            chart.draw_series([Circle::new(xy(robot.end.position), units, colour(index).mix(0.35).filled())])?;
            chart.draw_series([Circle::new(xy(robot.end.position), units, line)])?;
            chart.draw_series([nose(&robot.start), nose(&robot.end)])?;
        }
        if self.robots.len() <= MAX_LABELS {
            chart.draw_series(self.robots.iter().map(|robot| label(robot, frame)))?;
        }
        Ok(())
    }

    /// A cross for each pixel in which something touched.
    fn draw_contacts<'b>(&self, chart: &mut Chart<'_, 'b>, frame: &Frame) -> DrawResult<'b> {
        let pixel = |point: &&DVec2| {
            let place = ((**point - frame.min) * frame.scale).round();
            (place.x as i64, place.y as i64)
        };
        let mut seen = BTreeSet::new();
        let marks = self.contacts.iter().filter(|point| seen.insert(pixel(point)));
        chart.draw_series(marks.map(|point| cross(xy(*point))))?;
        Ok(())
    }

    /// What the marks mean, and the robots' names as far as there is room.
    fn draw_legend<'b>(&self, area: &Area<'b>, frame: &Frame) -> DrawResult<'b> {
        let lines = ((frame.pixels().1 / LINE) as usize).max(4);
        let y = |line: usize| (TOP + LINE / 2 + line as i32 * LINE) * UNIT;
        let write = |line: usize, words: String| {
            let style = text(TEXT).pos(Pos::new(HPos::Left, VPos::Center));
            area.draw(&Text::new(words, (34 * UNIT, y(line)), style))
        };
        let ring = INK.stroke_width(3 * UNIT as u32 / 2);
        area.draw(&Circle::new((16 * UNIT, y(0)), 5 * UNIT, ring))?;
        write(0, "start".into())?;
        area.draw(&Circle::new((16 * UNIT, y(1)), 5 * UNIT, INK.mix(0.35).filled()))?;
        area.draw(&Circle::new((16 * UNIT, y(1)), 5 * UNIT, ring))?;
        write(1, "end".into())?;
        area.draw(&cross((16 * UNIT, y(2))))?;
        write(2, "contact".into())?;
        let room = lines - 3;
        let named = if self.robots.len() > room { room - 1 } else { self.robots.len() };
        for (index, robot) in self.robots.iter().take(named).enumerate() {
            let line = colour(index).stroke_width(3 * UNIT as u32);
            area.draw(&PathElement::new([6, 26].map(|x| (x * UNIT, y(3 + index))).to_vec(), line))?;
            write(3 + index, shortened(&format!("r{} {}", robot.id, robot.name), 22))?;
        }
        if named < self.robots.len() {
            write(3 + named, format!("and {} more", self.robots.len() - named))?;
        }
        Ok(())
    }
}

/// The colour of the robot at `index` of the list.
fn colour(index: usize) -> RGBColor {
    PALETTE[index % PALETTE.len()]
}

/// The style of text of `pixels` height.
fn text(pixels: i32) -> TextStyle<'static> {
    ("sans-serif", pixels * UNIT).into_font().color(&INK)
}

/// The robot's id in front of it, where its trail is not.
fn label(robot: &PlotRobot, frame: &Frame) -> Text<'static, (f64, f64), String> {
    let beside = ((robot.radius * frame.scale).max(MARK) + 4.0) / frame.scale;
    let ahead = robot.end.heading.direction();
    let horizontal = match ahead.x {
        x if x < -0.4 => HPos::Right,
        x if x > 0.4 => HPos::Left,
        _ => HPos::Center,
    };
    let vertical = match ahead.y {
        y if y < -0.4 => VPos::Top,
        y if y > 0.4 => VPos::Bottom,
        _ => VPos::Center,
    };
    let anchor = Pos::new(horizontal, vertical);
    Text::new(format!("r{}", robot.id), xy(robot.end.position + ahead * beside), text(TEXT).pos(anchor))
}

/// The mark of a contact.
fn cross<C>(place: C) -> Cross<C, i32> {
    Cross::new(place, 4 * UNIT, INK.stroke_width(3 * UNIT as u32 / 2))
}

fn xy(point: DVec2) -> (f64, f64) {
    (point.x, point.y)
}

/// `words` cut to `length` letters, the cut marked.
fn shortened(words: &str, length: usize) -> String {
    if words.chars().count() <= length {
        return words.to_owned();
    }
    words.chars().take(length - 1).chain(['\u{2026}']).collect()
}

#[cfg(test)]
mod tests {
    use sim_core::math;

    use super::*;

    fn square(side: f64) -> Vec<[DVec2; 2]> {
        let corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| DVec2::new(x, y));
        (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]).collect()
    }

    /// `count` robots in a square world, each on an arc of its own.
    fn plot(side: f64, count: u32) -> Plot {
        let columns = f64::from(count).sqrt().ceil();
        let robot = |id: u32| {
            let cell = DVec2::new(f64::from(id - 1) % columns + 0.5, (f64::from(id - 1) / columns).floor() + 0.5);
            let (centre, radius) = (cell * side / columns, 0.3 * side / columns);
            let at = |angle: f64| centre + radius * DVec2::new(math::cos(angle), math::sin(angle));
            let end = 1.0 + 0.04 * f64::from(id);
            let trail: Vec<_> = (0..=40).map(|i| at(f64::from(i) / 40.0 * end)).collect();
            let quarter = std::f64::consts::FRAC_PI_2;
            PlotRobot {
                id,
                name: if id == 2 { "a robot with a very long name".into() } else { format!("S{id}") },
                radius: 0.09,
                start: Pose::new(trail[0].x, trail[0].y, quarter),
                end: Pose::new(trail[40].x, trail[40].y, quarter + end),
                trail,
            }
        };
        Plot {
            title: "square.sim, 12.500 s".into(),
            floor: Some([DVec2::ZERO, DVec2::splat(side)]),
            walls: square(side),
            robots: (1..=count).map(robot).collect(),
            contacts: vec![DVec2::new(0.0, 0.25 * side), DVec2::new(0.0, 0.25 * side), DVec2::new(side, 0.5 * side)],
        }
    }

    /// The elements of `svg` called `tag` that have `attribute`.
    fn elements<'s>(svg: &'s str, tag: &str, attribute: &str) -> Vec<&'s str> {
        let opening = format!("<{tag} ");
        svg.split(&opening)
            .skip(1)
            .map(|rest| rest.split('>').next().unwrap())
            .filter(|e| e.contains(attribute))
            .collect()
    }

    /// The points of a polyline in drawing units.
    fn points(element: &str) -> Vec<(f64, f64)> {
        let list = element.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
        let pair = |word: &str| word.split_once(',').map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap())).unwrap();
        list.split_whitespace().map(pair).collect()
    }

    #[test]
    fn everything_is_drawn_once() {
        let svg = plot(2.0, 3).to_svg().unwrap();
        assert_eq!(elements(&svg, "polyline", "#333333").len(), 4, "walls");
        assert_eq!(elements(&svg, "rect", "#F8F7F3").len(), 1, "floor");
        for colour in ["#0072B2", "#D55E00", "#009E73"] {
            // Trail and line of the legend.
            let lines = elements(&svg, "polyline", colour);
            assert_eq!(lines.len(), 2, "{colour}");
            assert_eq!(lines.iter().filter(|line| points(line).len() == 41).count(), 1, "{colour}");
            assert_eq!(elements(&svg, "circle", colour).len(), 3, "{colour}: start, end, end filled");
        }
        assert_eq!(elements(&svg, "polyline", "stroke-width=\"5\"").len(), 2 * 3, "headings");
        // Two contacts at one place are one mark; the legend has one more. A cross has two strokes.
        assert_eq!(elements(&svg, "line", "stroke-width=\"6\"").len(), 2 * (2 + 1));
        for word in ["square.sim, 12.500 s", "x in m", "y in m", "start", "end", "contact", "r1", "r1 S1", "r3 S3"] {
            assert!(svg.contains(&format!("\n{word}\n")), "`{word}` in {svg}");
        }
    }

    #[test]
    fn both_directions_have_the_same_scale() {
        for mut world in [plot(2.0, 1), plot(100.0, 1)] {
            // A long corridor: the picture does not become a thread.
            world.walls.push([DVec2::ZERO, DVec2::new(7.0, 0.0)]);
            let svg = world.to_svg().unwrap();
            let walls = elements(&svg, "polyline", "#333333");
            let across = points(walls[0]);
            let up = points(walls[1]);
            let (width, height) = (across[1].0 - across[0].0, up[0].1 - up[1].1);
            assert!(width > 400.0, "{width}");
            assert!((width - height).abs() <= 1.0, "{width} and {height} drawing units");
        }
    }

    #[test]
    fn up_in_the_world_is_up_in_the_picture() {
        let mut world = plot(2.0, 1);
        world.robots[0].trail = vec![DVec2::new(0.5, 0.5), DVec2::new(0.5, 1.5)];
        let svg = world.to_svg().unwrap();
        let trail = points(elements(&svg, "polyline", "#0072B2")[0]);
        assert!(trail[1].1 < trail[0].1 && trail[1].0 == trail[0].0, "{trail:?}");
    }

    #[test]
    fn a_hundred_robots_leave_the_legend_in_the_picture() {
        let svg = plot(100.0, 100).to_svg().unwrap();
        let height: f64 = svg.split("viewBox=\"").nth(1).unwrap().split([' ', '"']).nth(3).unwrap().parse().unwrap();
        for element in elements(&svg, "text", "y=") {
            let y: f64 = element.split(" y=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap();
            assert!(y <= height, "{element}");
        }
        assert!(svg.contains("and 60 more\n"), "of the legend");
        assert!(svg.contains("\nr100\n"), "a label beside each robot");
        assert!(!plot(100.0, 101).to_svg().unwrap().contains("\nr100\n"), "no labels beside too many robots");
    }

    #[test]
    fn an_empty_world_has_a_picture() {
        assert!(Plot::default().to_svg().unwrap().contains("x in m"));
    }

    #[test]
    fn names_are_escaped_and_shortened() {
        let mut world = plot(1.0, 2);
        world.robots[0].name = "<b>&".into();
        let svg = world.to_svg().unwrap();
        assert!(svg.contains("r1 &lt;b&gt;&amp;"), "{svg}");
        assert!(svg.contains("\nr2 a robot with a ver\u{2026}\n"), "{svg}");
    }

    /// Writes pictures to look at to the folder in `EYESIM_PLOTS`.
    #[test]
    fn pictures_for_the_eye() {
        let Some(folder) = std::env::var_os("EYESIM_PLOTS") else { return };
        for (side, count) in [(1.0, 1), (2.0, 4), (10.0, 30), (100.0, 100)] {
            plot(side, count).write(&Path::new(&folder).join(format!("{side}m-{count}.svg"))).unwrap();
        }
        let mut corridor = plot(1.0, 1);
        corridor.floor = None;
        corridor.walls = [0.0, 1.0].map(|y| [DVec2::new(0.0, y), DVec2::new(30.0, y)]).to_vec();
        corridor.write(&Path::new(&folder).join("corridor.svg")).unwrap();
    }
}
