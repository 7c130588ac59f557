//! Descriptions of charts (curves over a pair of axes), which the caller renders.

#[cfg(feature = "studies")]
use crate::study::Row;

/// Chart of several curves over one pair of axes.
#[derive(Clone, Debug)]
pub struct Figure {
    /// File name without the extension.
    pub name: String,
    /// Title above the chart.
    pub title: String,
    /// Label of the x axis, with its unit.
    pub x_label: String,
    /// Label of the y axis, with its unit.
    pub y_label: String,
    /// Scale of the x axis.
    pub x_scale: Scale,
    /// Scale of the y axis.
    pub y_scale: Scale,
    /// Curves, in the order of the legend.
    pub series: Vec<Series>,
}

/// Scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps.
    Linear,
    /// Equal factors; values that are not positive are drawn at the lower edge.
    Logarithmic,
}

/// Style in which points are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A line through the points.
    Line,
    /// A dot at each point.
    Dots,
    /// A line and dots.
    LineAndDots,
    /// A dashed line and dots, for values of another origin.
    DashedLineAndDots,
    /// A bar from 0 to each point, as wide as the distance between points: a histogram.
    Bars,
}

/// One curve of a figure.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Style of the points.
    pub mark: Mark,
    /// Points (x, y); a point that is not finite interrupts a line.
    pub points: Vec<(f64, f64)>,
}

#[cfg(feature = "studies")]
impl Figure {
    /// Chart of error against time, both on logarithmic axes, with one curve for each method and its points in the
    /// order of the rows. If error and time of a method are not monotonic, its points are not connected.
    ///
    /// `None` without rows. All rows must belong to one study.
    pub fn of_rows(title: &str, rows: &[Row]) -> Option<Self> {
        let first = rows.first()?;
        let mut series: Vec<Series> = Vec::new();
        for row in rows {
            let point = (row.time_ns, row.error);
            match series.iter_mut().find(|series| series.name == row.method) {
                Some(series) => series.points.push(point),
                None => {
                    series.push(Series { name: row.method.clone(), mark: Mark::LineAndDots, points: vec![point] });
                }
            }
        }
        for Series { mark, points, .. } in &mut series {
            // The tolerance of about a fifth is for errors of measured times.
            let is_monotonic = |sign: f64| points.windows(2).all(|pair| sign * (pair[1].0 / pair[0].0).log2() > -0.25);
            let times = || points.iter().map(|point| point.0);
            let is_wide = times().fold(0.0, f64::max) > 1.5 * times().fold(f64::INFINITY, f64::min);
            *mark = if is_wide && (is_monotonic(1.0) || is_monotonic(-1.0)) { Mark::LineAndDots } else { Mark::Dots };
        }
        Some(Self {
            name: first.study.to_owned(),
            title: title.to_owned(),
            x_label: format!("time of one {}, ns", first.per),
            y_label: format!("error, {}", first.unit),
            x_scale: Scale::Logarithmic,
            y_scale: Scale::Logarithmic,
            series,
        })
    }
}

#[cfg(all(test, feature = "studies"))]
mod tests {
    use super::*;

    #[test]
    fn each_method_becomes_a_curve() {
        let row = |method: &str, time_ns, error| Row {
            study: "s",
            method: method.to_owned(),
            setting: String::new(),
            error,
            unit: "m",
            time_ns,
            per: "ray",
        };
        let rows = [row("a", 1.0, 0.1), row("b", 2.0, 0.2), row("a", 3.0, 0.0)];
        let figure = Figure::of_rows("t", &rows).expect("there are rows");
        let curves: Vec<_> = figure.series.iter().map(|series| (&*series.name, &*series.points)).collect();
        assert_eq!(curves, [("a", &[(1.0, 0.1), (3.0, 0.0)][..]), ("b", &[(2.0, 0.2)][..])]);
        assert_eq!((&*figure.x_label, &*figure.y_label), ("time of one ray, ns", "error, m"));
        assert_eq!(figure.series[0].mark, Mark::LineAndDots);
        let settings = [row("a", 1.0, 0.1), row("a", 3.0, 0.2), row("a", 2.0, 0.1)];
        assert_eq!(Figure::of_rows("t", &settings).expect("there are rows").series[0].mark, Mark::Dots);
        assert!(Figure::of_rows("t", &[]).is_none());
    }
}
