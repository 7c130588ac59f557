//! Tests of pictures as SVG text and as pixels: contents, positions and scale.

use std::sync::Arc;

use glam::DVec2;
use sim_core::math;
use sim_core::pose::Pose;
use sim_core::spec::{RobiSpec, WorldSpec};
use sim_format::{read_esobj, read_robi, read_world};

use super::run::{RunObject, RunPicture, RunRobot, draw_run};
use super::viewport::Viewport;
use super::{Drawing, PictureKind, PlotError, render};

fn robi(name: &str) -> Arc<RobiSpec> {
    let text = format!(
        "name {name}\ndiameter 180\nwheel 54 3600 1100 90\n\
         drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n"
    );
    Arc::new(read_robi("r.robi", &text).0)
}

fn square(side: f64) -> WorldSpec {
    let mm = side * 1000.0;
    let walls = format!("0 0 {mm} 0\n{mm} 0 {mm} {mm}\n{mm} {mm} 0 {mm}\n0 {mm} 0 0\n");
    read_world("w.wld", &format!("floor {mm} {mm}\n{walls}")).0
}

/// `count` robots in a square world, each on an arc of its own.
fn drawing(side: f64, count: u32) -> Drawing {
    let columns = f64::from(count).sqrt().ceil();
    let robot = |id: u32| {
        let cell = DVec2::new(f64::from(id - 1) % columns + 0.5, (f64::from(id - 1) / columns).floor() + 0.5);
        let (centre, radius) = (cell * side / columns, 0.3 * side / columns);
        let at = |angle: f64| centre + radius * DVec2::new(math::cos(angle), math::sin(angle));
        let end = 1.0 + 0.04 * f64::from(id);
        let trail: Vec<_> = (0..=40).map(|i| at(f64::from(i) / 40.0 * end)).collect();
        let quarter = std::f64::consts::FRAC_PI_2;
        let name = if id == 2 { "a robot with a very long name".into() } else { format!("S{id}") };
        RunRobot {
            id,
            robi: robi(&name),
            start: Pose::new(trail[0].x, trail[0].y, quarter),
            end: Pose::new(trail[40].x, trail[40].y, quarter + end),
            depth: None,
            joints: Vec::new(),
            trails: vec![trail],
        }
    };
    let robots: Vec<RunRobot> = (1..=count).map(robot).collect();
    let contacts = [DVec2::new(0.0, 0.25 * side), DVec2::new(0.0, 0.25 * side), DVec2::new(side, 0.5 * side)];
    picture("square.sim, 12.500 s", &square(side), &robots, &contacts)
}

fn picture(title: &str, world: &WorldSpec, robots: &[RunRobot], contacts: &[DVec2]) -> Drawing {
    draw_run(&RunPicture { title, world, floor: None, markers: &[], robots, objects: &[], contacts })
}

fn svg(drawing: &Drawing) -> String {
    render::to_svg(drawing, None).expect("a picture")
}

/// The elements of `svg` called `tag` that have `attribute`.
fn elements<'s>(svg: &'s str, tag: &str, attribute: &str) -> Vec<&'s str> {
    let opening = format!("<{tag} ");
    let contents = svg.split(&opening).skip(1).map(|rest| rest.split('>').next().expect("an element ends"));
    contents.filter(|element| element.contains(attribute)).collect()
}

/// The points of a polyline in drawing units.
fn points(element: &str) -> Vec<(f64, f64)> {
    let list = element.split("points=\"").nth(1).expect("a polyline").split('"').next().expect("an attribute ends");
    let number = |word: &str| word.parse().expect("a number");
    let pair = |word: &str| word.split_once(',').map(|(x, y)| (number(x), number(y))).expect("x and y");
    list.split_whitespace().map(pair).collect()
}

#[test]
fn everything_is_drawn_once() {
    let svg = svg(&drawing(2.0, 3));
    // Four walls, and one line in the legend.
    assert_eq!(elements(&svg, "polyline", "#333333").len(), 4 + 1, "walls");
    assert_eq!(elements(&svg, "polygon", "#F8F7F3").len(), 1, "floor");
    for colour in ["#0072B2", "#D55E00", "#009E73"] {
        // Trail and line of the legend.
        let lines = elements(&svg, "polyline", colour);
        assert_eq!(lines.len(), 2, "{colour}");
        assert_eq!(lines.iter().filter(|line| points(line).len() == 41).count(), 1, "{colour}");
        assert_eq!(elements(&svg, "circle", colour).len(), 3, "{colour}: start, end, end filled");
    }
    assert_eq!(elements(&svg, "polyline", "stroke-width=\"5\"").len(), 2 * 3, "headings");
    // Two contacts at one place give one mark; the legend has one more. A cross has two strokes.
    let crosses = elements(&svg, "polyline", "stroke=\"#222222\" stroke-width=\"6\"");
    assert_eq!(crosses.len(), 2 * (2 + 1));
    for word in ["square.sim, 12.500 s", "x in m", "y in m", "start", "end", "contact", "r1", "r1 S1", "r3 S3"] {
        assert!(svg.contains(&format!("\n{word}\n")), "`{word}` in {svg}");
    }
}

#[test]
fn y_points_up_in_the_picture() {
    let mut robot = RunRobot {
        id: 1,
        robi: robi("S4"),
        start: Pose::new(0.5, 0.5, 0.0),
        end: Pose::new(0.5, 1.5, 0.0),
        depth: None,
        joints: Vec::new(),
        trails: vec![vec![DVec2::new(0.5, 0.5), DVec2::new(0.5, 1.5)]],
    };
    let up = svg(&picture("", &square(2.0), std::slice::from_ref(&robot), &[]));
    let trail = points(elements(&up, "polyline", "#0072B2")[0]);
    assert!(trail[1].1 < trail[0].1 && trail[1].0 == trail[0].0, "{trail:?}");
    // A trail that leaves the world is still in the picture.
    robot.trails[0].push(DVec2::new(-7.0, 9.0));
    let wide = picture("", &square(2.0), &[robot], &[]);
    assert_eq!(wide.extent(), (DVec2::new(-7.0, 0.0), DVec2::new(2.0, 9.0)));
}

#[test]
fn moved_objects_are_drawn_at_start_and_end() {
    let kind = Arc::new(read_esobj("tub.esObj", "name Tub\nmass 1\ncollider sphere 0 0 0 100\n").0);
    let object = |x: f64| RunObject {
        kind: Arc::clone(&kind),
        start: Pose::new(0.5, 0.5, 0.0),
        end: Pose::new(x, 0.5, 0.0),
        trails: Vec::new(),
    };
    let count = |x: f64| {
        let (world, objects) = (square(2.0), [object(x)]);
        let (floor, objects) = (None, objects.as_slice());
        let run = RunPicture { title: "", world: &world, floor, markers: &[], robots: &[], objects, contacts: &[] };
        let svg = svg(&draw_run(&run));
        (elements(&svg, "circle", "#F0E442").len(), svg.contains("\nwhere an object was\n"))
    };
    // One in the world, one in the legend.
    assert_eq!((count(0.5), count(1.5)), ((2, false), (2, true)));
}

#[test]
fn legend_of_a_hundred_robots_fits_the_picture() {
    let crowd = svg(&drawing(100.0, 100));
    let height: f64 = crowd
        .split("viewBox=\"")
        .nth(1)
        .and_then(|rest| rest.split([' ', '"']).nth(3))
        .expect("a size")
        .parse()
        .expect("a number");
    for element in elements(&crowd, "text", "y=") {
        let y: f64 = element
            .split(" y=\"")
            .nth(1)
            .and_then(|rest| rest.split('"').next())
            .expect("y")
            .parse()
            .expect("a number");
        assert!(y <= height, "{element}");
    }
    // The legend names three symbols and the wall before the robots.
    assert!(crowd.contains(" more\n"), "the legend says what it leaves out");
    assert!(crowd.contains("\nr100\n"), "a label beside each robot");
    assert!(!svg(&drawing(100.0, 101)).contains("\nr100\n"), "no labels beside too many robots");
}

#[test]
fn names_are_escaped_and_shortened() {
    let robot = |id, name: &str| RunRobot {
        id,
        robi: robi(name),
        start: Pose::new(0.5, 0.5, 0.0),
        end: Pose::new(0.5, 0.5, 0.0),
        depth: None,
        joints: Vec::new(),
        trails: Vec::new(),
    };
    let robots = [robot(1, "<b>&"), robot(2, "a robot with a very long name that nobody reads to its end")];
    let svg = svg(&picture("", &square(1.0), &robots, &[]));
    assert!(svg.contains("r1 &lt;b&gt;&amp;"), "{svg}");
    assert!(svg.contains("\nr2 a robot with a very lo") && svg.contains("\u{2026}\n"), "{svg}");
}

#[test]
fn empty_world_can_be_drawn() {
    let empty = picture("", &WorldSpec::default(), &[], &[]);
    assert!(svg(&empty).contains("x in m"));
    assert!(render::to_png(&empty, None).is_ok());
}

/// A picture as rows of pixels.
fn pixels(drawing: &Drawing, size: Option<(u32, u32)>) -> image::RgbImage {
    let bytes = render::to_png(drawing, size).expect("a picture");
    image::load_from_memory(&bytes).expect("a png").into_rgb8()
}

#[test]
fn walls_and_floor_have_the_right_pixels() {
    let drawing = drawing(2.0, 0);
    for size in [None, Some((900, 600)), Some((600, 900)), Some((3000, 2000))] {
        let (low, high) = drawing.extent();
        let frame = Viewport::around(low, high, size);
        let image = pixels(&drawing, size);
        assert_eq!(image.dimensions(), frame.picture_size());
        let at = |x: f64, y: f64| {
            let pixel = frame.pixel_of(DVec2::new(x, y));
            image.get_pixel(pixel.x as u32, pixel.y as u32).0
        };
        for point in [(0.0, 1.03), (2.0, 1.03), (1.03, 0.0), (1.03, 2.0)] {
            let wall = at(point.0, point.1);
            assert!(wall[0] < 130, "{size:?}: a wall at {point:?} is {wall:?}");
        }
        assert_eq!(at(1.03, 1.03), [248, 247, 243], "{size:?}: floor");
        assert_eq!(at(-0.04, 1.03), [255, 255, 255], "{size:?}: paper");
    }
}

#[test]
fn pictures_are_deterministic() {
    let (first, second) = (drawing(2.0, 5), drawing(2.0, 5));
    assert_eq!(render::to_png(&first, None).expect("a picture"), render::to_png(&second, None).expect("a picture"));
    assert_eq!(svg(&first), svg(&second));
}

#[test]
fn file_extension_selects_the_format() {
    use std::path::Path;
    assert_eq!(PictureKind::of(Path::new("a/b.SVG")).expect("a kind"), PictureKind::Svg);
    assert_eq!(PictureKind::of(Path::new("b.png")).expect("a kind"), PictureKind::Png);
    assert_eq!(PictureKind::of(Path::new("/dev/stdout")).expect("a kind"), PictureKind::Svg);
    for name in ["a.pdf", "a", "svg", ".png"] {
        let error = PictureKind::of(Path::new(name)).expect_err("no kind");
        assert!(matches!(error, PlotError::Kind(_)));
        assert!(error.to_string().contains(".svg or .png"), "{error}");
    }
}
