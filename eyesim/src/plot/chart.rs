//! Line charts with two axes: the figures of `eyesim accuracy`.

use accuracy::figure::{Figure, Mark, Scale, Series};
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;

use super::PlotError;
use super::canvas::{TEXT, TITLE, register_fonts};

/// Width and height of a figure, in pixels.
const SIZE: (u32, u32) = (860, 440);
/// Colours legible on white: seven that are distinct with any kind of colour vision (Okabe and Ito), then two less
/// distinct ones.
const COLOURS: [RGBColor; 9] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
    RGBColor(136, 136, 136),
    RGBColor(136, 34, 85),
];
/// Length of a dash in pixels.
const DASH: i32 = 7;
/// Length of the gap after a dash in pixels.
const GAP: i32 = 5;
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
    // The legend is beside the chart, so that it hides no curve.
    let widths = figure.series.iter().map(|series| root.estimate_text_size(&series.name, &text).map(|size| size.0));
    let legend_width = if figure.series.len() > 1 {
        LEGEND + widths.collect::<Result<Vec<_>, _>>()?.into_iter().max().unwrap_or(0)
    } else {
        0
    };
    let (area, legend_area) = root.split_horizontally(SIZE.0 - legend_width);
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
            for part in finite_parts(points()) {
                chart.draw_series([PathElement::new(part, colour.stroke_width(2))])?;
            }
        }
        if series.mark == Mark::DashedLineAndDots {
            for part in finite_parts(points()) {
                chart.draw_series([DashedPathElement::new(part, DASH, GAP, colour.stroke_width(2))])?;
            }
        }
        if matches!(series.mark, Mark::Dots | Mark::LineAndDots | Mark::DashedLineAndDots) {
            let radius = match series.points.len() {
                ..=60 => 3,
                61..=200 => 2,
                _ => 1,
            };
            chart.draw_series(points().filter(is_drawn).map(|point| Circle::new(point, radius, colour.filled())))?;
        }
        if series.mark == Mark::Bars {
            let half_width = 0.5 * bar_width(series);
            let bar = |(x, y)| Rectangle::new([(x - half_width, 0.0), (x + half_width, y)], colour.mix(0.45).filled());
            chart.draw_series(points().filter(is_drawn).map(bar))?;
        }
        if legend_width > 0 {
            let top = 36 + 20 * index as i32;
            if series.mark == Mark::DashedLineAndDots {
                for left in [4, 13] {
                    legend_area.draw(&Rectangle::new([(left, top + 3), (left + 5, top + 5)], colour.filled()))?;
                }
            } else {
                legend_area.draw(&Rectangle::new([(4, top), (18, top + 8)], colour.filled()))?;
            }
            legend_area.draw(&Text::new(series.name.as_str(), (24, top - 2), text.clone()))?;
        }
    }
    root.present()?;
    Ok(())
}

fn is_drawn(point: &(f64, f64)) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// Splits a line at points that are not finite.
fn finite_parts(points: impl Iterator<Item = (f64, f64)>) -> Vec<Vec<(f64, f64)>> {
    let mut parts = vec![Vec::new()];
    for point in points {
        match parts.last_mut() {
            Some(part) if is_drawn(&point) => part.push(point),
            _ => parts.push(Vec::new()),
        }
    }
    parts.retain(|part| !part.is_empty());
    parts
}

/// Width of the bars of a histogram: the distance of the first two points along x.
fn bar_width(series: &Series) -> f64 {
    series.points.windows(2).next().map_or(1.0, |pair| pair[1].0 - pair[0].0)
}

/// An axis; a logarithmic axis is a linear axis of the exponents.
#[derive(Clone)]
struct Axis {
    scale: Scale,
    range: RangedCoordf64,
    low: f64,
    /// True if the axis shows 0. On a logarithmic axis, numbers that are not positive are drawn at the lower edge,
    /// which is labelled 0.
    shows_zero: bool,
}

impl Axis {
    /// Axis that covers these coordinates and, if `shows_zero`, 0.
    fn new(scale: Scale, coordinates: impl Iterator<Item = f64>, shows_zero: bool) -> Self {
        let coordinates: Vec<f64> = coordinates.filter(|c| c.is_finite()).collect();
        let is_log = scale == Scale::Logarithmic;
        let plotted = coordinates.iter().filter(|c| !is_log || **c > 0.0).map(|c| if is_log { c.log10() } else { *c });
        let (mut low, mut high) = plotted.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), c| (a.min(c), b.max(c)));
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let shows_zero = if is_log { coordinates.iter().any(|c| *c <= 0.0) } else { shows_zero };
        if is_log {
            let is_short = high - low < FEW_DECADES;
            let ticks: &[f64] = if is_short { &TICKS } else { &TICKS[..1] };
            // The axis extends to the next ticks outside, and by one more decade if it shows 0.
            let tick_outside = |coordinate: f64, up: f64| {
                let candidates = (-1..=1)
                    .flat_map(|d| ticks.iter().map(move |tick| coordinate.floor() + f64::from(d) + tick.log10()));
                let outside = candidates.filter(|tick| up * (tick - coordinate) >= 0.0);
                outside.min_by(|a, b| (a - coordinate).abs().total_cmp(&(b - coordinate).abs())).unwrap_or(coordinate)
            };
            (low, high) = (tick_outside(low - 0.02, -1.0), tick_outside(high + 0.02, 1.0));
            if shows_zero {
                low = low.floor() - 1.0;
            }
            low = low.max(high.ceil() - DECADES);
        } else {
            if shows_zero {
                low = low.min(0.0);
            }
            let margin = if high > low { 0.04 * (high - low) } else { 0.5 * high.abs().max(1.0) };
            low = if shows_zero && low == 0.0 { 0.0 } else { low - margin };
            high += margin;
        }
        Self { scale, range: RangedCoordf64::from(low..high), low, shows_zero }
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
            Scale::Logarithmic if self.shows_zero && coordinate == self.low => "0".to_owned(),
            Scale::Logarithmic => {
                let decade = (coordinate + 1e-9).floor();
                let distance = |tick: &f64| (coordinate - decade - tick.log10()).abs();
                let tick = TICKS.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(1.0);
                format!("{tick:.0}e{decade:.0}")
            }
        }
    }
}

/// A logarithmic axis of fewer decades than this has ticks between the powers of ten.
const FEW_DECADES: f64 = 2.0;
/// The ticks of a decade.
const TICKS: [f64; 3] = [1.0, 2.0, 5.0];

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
        let (step, ticks) = if decades <= 3 { (1, &TICKS[..]) } else { (decades.div_ceil(10), &TICKS[..1]) };
        let exponents =
            (0..=decades).step_by(step).flat_map(|decade| ticks.iter().map(move |tick| (decade, tick.log10())));
        let exponents = exponents.map(|(decade, tick)| first + decade as f64 + tick);
        exponents.filter(|coordinate| (range.start - 1e-9..=range.end + 1e-9).contains(coordinate)).collect()
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
        let extreme = vec![(0.0, 0.0), (f64::NAN, 1.0), (1e-300, 1e300), (-1.0, f64::INFINITY), (5.0, 5.0)];
        for points in [Vec::new(), vec![(1.0, 0.0)], vec![(1.0, 1.0), (2.0, 4.0)], extreme] {
            for scale in [Scale::Linear, Scale::Logarithmic] {
                for mark in [Mark::Line, Mark::Dots, Mark::LineAndDots, Mark::DashedLineAndDots, Mark::Bars] {
                    let svg = to_svg(&figure(points.clone(), scale, mark)).expect("a picture");
                    assert!(svg.contains("Title") && svg.ends_with("</svg>\n"), "{scale:?} {mark:?} {points:?}");
                }
            }
        }
    }

    #[test]
    fn powers_of_ten_are_at_whole_coordinates() {
        let axis = Axis::new(Scale::Logarithmic, [1.1e-9, 0.0, 0.9e-3].into_iter(), false);
        assert_eq!((axis.range().start, axis.range().end), (-10.0, -3.0));
        assert_eq!([1e-9, 1e-3, 0.0, -4.0].map(|c| axis.coordinate_on(c).round()), [-9.0, -3.0, -10.0, -10.0]);
        assert_eq!([-10.0, -9.0].map(|coordinate| axis.label(coordinate)), ["0", "1e-9"]);
    }

    #[test]
    fn short_logarithmic_axis_has_ticks_between_powers_of_ten() {
        let axis = Axis::new(Scale::Logarithmic, [0.012, 0.34].into_iter(), false);
        let ticks = axis.key_points(plotters::coord::ranged1d::LightPoints::new(5, 5));
        let labels: Vec<_> = ticks.iter().map(|tick| axis.label(*tick)).collect();
        assert_eq!(labels, ["1e-2", "2e-2", "5e-2", "1e-1", "2e-1", "5e-1"]);
    }
}
