//! Line charts with two axes: the figures of `eyesim accuracy`.

use accuracy::figure::{Figure, Mark, Scale, Series};
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::PlotError;
use super::canvas::{TEXT, TITLE, register_fonts};

/// Width and height of a figure, in pixels.
const SIZE: (u32, u32) = (860, 440);
/// Colours legible on white and distinct with any kind of colour vision (Okabe and Ito).
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
];
/// Width of the legend's column in pixels, to which the width of its longest name is added.
const LEGEND: u32 = 34;
/// Maximum number of powers of ten on a logarithmic axis.
const DECADES: f64 = 20.0;

/// Renders a figure as SVG.
///
/// # Errors
/// [`PlotError::Draw`] if the drawing library fails.
pub fn to_svg(figure: &Figure) -> Result<String, PlotError> {
    register_fonts();
    let mut svg = String::new();
    draw(figure, SVGBackend::with_string(&mut svg, SIZE)).map_err(|error| PlotError::Draw(error.to_string()))?;
    Ok(svg)
}

fn draw(figure: &Figure, backend: SVGBackend<'_>) -> Result<(), Box<dyn std::error::Error>> {
    let root = backend.into_drawing_area();
    root.fill(&WHITE)?;
    let text = TextStyle::from(("sans-serif", TEXT).into_font());
    // The legend is beside the curves, so that it hides none.
    let widths = figure.series.iter().map(|series| root.estimate_text_size(&series.name, &text).map(|size| size.0));
    let legend = if figure.series.len() > 1 {
        LEGEND + widths.collect::<Result<Vec<_>, _>>()?.into_iter().max().unwrap_or(0)
    } else {
        0
    };
    let (area, beside) = root.split_horizontally(SIZE.0 - legend);
    let coordinates = |pick: fn(&(f64, f64)) -> f64| figure.series.iter().flat_map(|s| &s.points).map(pick);
    let is_histogram = figure.series.iter().any(|series| series.mark == Mark::Bars);
    let x_axis = Axis::new(figure.x_scale, coordinates(|point| point.0), false);
    let y_axis = Axis::new(figure.y_scale, coordinates(|point| point.1), is_histogram);
    let mut chart = ChartBuilder::on(&area)
        .caption(&figure.title, ("sans-serif", TITLE))
        .margin(10)
        .x_label_area_size(42)
        .y_label_area_size(66)
        .build_cartesian_2d(x_axis.clone(), y_axis.clone())?;
    chart
        .configure_mesh()
        .x_desc(&figure.x_label)
        .y_desc(&figure.y_label)
        .axis_desc_style(text.clone())
        .label_style(text.clone())
        .x_label_formatter(&|x| x_axis.label(*x))
        .y_label_formatter(&|y| y_axis.label(*y))
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.15))
        .draw()?;
    for (index, (series, &colour)) in figure.series.iter().zip(COLOURS.iter().cycle()).enumerate() {
        let points = || series.points.iter().map(|(x, y)| (x_axis.coordinate_on(*x), y_axis.coordinate_on(*y)));
        if matches!(series.mark, Mark::Line | Mark::LineAndDots) {
            for run in stretches(points()) {
                chart.draw_series([PathElement::new(run, colour.stroke_width(2))])?;
            }
        }
        if matches!(series.mark, Mark::Dots | Mark::LineAndDots) {
            let radius = match series.points.len() {
                ..=60 => 3,
                61..=200 => 2,
                _ => 1,
            };
            chart.draw_series(points().filter(is_drawn).map(|point| Circle::new(point, radius, colour.filled())))?;
        }
        if series.mark == Mark::Bars {
            let half = 0.5 * bar_width(series);
            let bar = |(x, y)| Rectangle::new([(x - half, 0.0), (x + half, y)], colour.mix(0.45).filled());
            chart.draw_series(points().filter(is_drawn).map(bar))?;
        }
        if legend > 0 {
            let top = 36 + 20 * index as i32;
            beside.draw(&Rectangle::new([(4, top), (18, top + 8)], colour.filled()))?;
            beside.draw(&Text::new(series.name.as_str(), (24, top - 2), text.clone()))?;
        }
    }
    root.present()?;
    Ok(())
}

fn is_drawn(point: &(f64, f64)) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// Splits a line at points that are not finite.
fn stretches(points: impl Iterator<Item = (f64, f64)>) -> Vec<Vec<(f64, f64)>> {
    let mut runs = vec![Vec::new()];
    for point in points {
        match runs.last_mut() {
            Some(run) if is_drawn(&point) => run.push(point),
            _ => runs.push(Vec::new()),
        }
    }
    runs.retain(|run| !run.is_empty());
    runs
}

/// Distance between the first two points along x.
fn bar_width(series: &Series) -> f64 {
    series.points.windows(2).next().map_or(1.0, |pair| pair[1].0 - pair[0].0)
}

/// An axis; a logarithmic axis is a linear axis of the exponents.
#[derive(Clone)]
struct Axis {
    scale: Scale,
    range: RangedCoordf64,
    low: f64,
    /// Whether a logarithmic axis shows 0: numbers that are not positive are drawn at its lower edge, which is labelled
    /// 0.
    holds_zero: bool,
}

impl Axis {
    /// Axis that covers these coordinates and, if `holds_zero`, 0.
    fn new(scale: Scale, coordinates: impl Iterator<Item = f64>, holds_zero: bool) -> Self {
        let coordinates: Vec<f64> = coordinates.filter(|c| c.is_finite()).collect();
        let is_log = scale == Scale::Logarithmic;
        let plotted = coordinates.iter().filter(|c| !is_log || **c > 0.0).map(|c| if is_log { c.log10() } else { *c });
        let (mut low, mut high) = plotted.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), c| (a.min(c), b.max(c)));
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let holds_zero = if is_log { coordinates.iter().any(|c| *c <= 0.0) } else { holds_zero };
        if is_log {
            let is_short = high - low < SHORT;
            let marks: &[f64] = if is_short { &MARKS } else { &MARKS[..1] };
            // The axis extends to the next ticks outside, and by one more decade if it shows 0.
            let mark = |coordinate: f64, up: f64| {
                let candidates = (-1..=1)
                    .flat_map(|d| marks.iter().map(move |mark| coordinate.floor() + f64::from(d) + mark.log10()));
                let outside = candidates.filter(|mark| up * (mark - coordinate) >= 0.0);
                outside.min_by(|a, b| (a - coordinate).abs().total_cmp(&(b - coordinate).abs())).unwrap_or(coordinate)
            };
            (low, high) = (mark(low - 0.02, -1.0), mark(high + 0.02, 1.0));
            if holds_zero {
                low = low.floor() - 1.0;
            }
            low = low.max(high.ceil() - DECADES);
        } else {
            if holds_zero {
                low = low.min(0.0);
            }
            let margin = if high > low { 0.04 * (high - low) } else { 0.5 * high.abs().max(1.0) };
            low = if holds_zero && low == 0.0 { 0.0 } else { low - margin };
            high += margin;
        }
        Self { scale, range: RangedCoordf64::from(low..high), low, holds_zero }
    }

    /// Position of a coordinate along the axis.
    fn coordinate_on(&self, coordinate: f64) -> f64 {
        match self.scale {
            Scale::Linear => coordinate,
            Scale::Logarithmic if coordinate > 0.0 => coordinate.log10().max(self.low),
            Scale::Logarithmic if coordinate.is_nan() => coordinate,
            Scale::Logarithmic => self.low,
        }
    }

    fn label(&self, coordinate: f64) -> String {
        match self.scale {
            // The steps of plotters have few digits, but their sums carry rounding errors.
            Scale::Linear => format!("{}", (coordinate * 1e9).round() / 1e9),
            Scale::Logarithmic if self.holds_zero && coordinate == self.low => "0".to_owned(),
            Scale::Logarithmic => {
                let decade = (coordinate + 1e-9).floor();
                let off = |mark: &f64| (coordinate - decade - mark.log10()).abs();
                let mark = MARKS.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(1.0);
                format!("{mark:.0}e{decade:.0}")
            }
        }
    }
}

/// A logarithmic axis of fewer decades than this has ticks between the powers of ten.
const SHORT: f64 = 2.0;
/// The ticks of a decade.
const MARKS: [f64; 3] = [1.0, 2.0, 5.0];

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.range.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if self.scale == Scale::Linear {
            return self.range.key_points(hint);
        }
        let range = self.range.range();
        let first = range.start.floor();
        let decades = (range.end.ceil() - first).max(1.0) as usize;
        let (step, marks) = if decades <= 3 { (1, &MARKS[..]) } else { (decades.div_ceil(10), &MARKS[..1]) };
        let all = (0..=decades).step_by(step).flat_map(|decade| marks.iter().map(move |mark| (decade, mark.log10())));
        let all = all.map(|(decade, mark)| first + decade as f64 + mark);
        all.filter(|coordinate| (range.start - 1e-9..=range.end + 1e-9).contains(coordinate)).collect()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.range.range()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(points: Vec<(f64, f64)>, scale: Scale, mark: Mark) -> Figure {
        Figure {
            name: "f".to_owned(),
            title: "Title".to_owned(),
            x_label: "x".to_owned(),
            y_label: "y".to_owned(),
            x_scale: scale,
            y_scale: scale,
            series: vec![Series { name: "curve".to_owned(), mark, points }],
        }
    }

    #[test]
    fn any_points_can_be_drawn() {
        let ugly = vec![(0.0, 0.0), (f64::NAN, 1.0), (1e-300, 1e300), (-1.0, f64::INFINITY), (5.0, 5.0)];
        for points in [Vec::new(), vec![(1.0, 0.0)], vec![(1.0, 1.0), (2.0, 4.0)], ugly] {
            for scale in [Scale::Linear, Scale::Logarithmic] {
                for mark in [Mark::Line, Mark::Dots, Mark::LineAndDots, Mark::Bars] {
                    let svg = to_svg(&figure(points.clone(), scale, mark)).expect("a picture");
                    assert!(svg.contains("Title") && svg.ends_with("</svg>\n"), "{scale:?} {mark:?} {points:?}");
                }
            }
        }
    }

    #[test]
    fn a_power_of_ten_stands_on_its_line() {
        let axis = Axis::new(Scale::Logarithmic, [1.1e-9, 0.0, 0.9e-3].into_iter(), false);
        assert_eq!((axis.range().start, axis.range().end), (-10.0, -3.0));
        assert_eq!([1e-9, 1e-3, 0.0, -4.0].map(|c| axis.coordinate_on(c).round()), [-9.0, -3.0, -10.0, -10.0]);
        assert_eq!([-10.0, -9.0].map(|coordinate| axis.label(coordinate)), ["0", "1e-9"]);
    }

    #[test]
    fn a_short_logarithmic_axis_has_marks_between_the_powers_of_ten() {
        let axis = Axis::new(Scale::Logarithmic, [0.012, 0.34].into_iter(), false);
        let marks = axis.key_points(plotters::coord::ranged1d::LightPoints::new(5, 5));
        let labels: Vec<_> = marks.iter().map(|mark| axis.label(*mark)).collect();
        assert_eq!(labels, ["1e-2", "2e-2", "5e-2", "1e-1", "2e-1", "5e-1"]);
    }
}
