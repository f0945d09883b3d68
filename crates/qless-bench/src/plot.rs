//! Two plots as SVG: error against time with the Pareto front, and time against the number of equations (the paper's Figure 15).

use std::collections::BTreeMap;

use plotters::coord::combinators::IntoLogRange;
use plotters::prelude::*;

use super::labels::PlotLabels;
use super::methods::BenchMethod;
use super::sample::{Sample, series, verdict};

/// Colours that can be distinguished in print too.
pub const COLOURS: [RGBColor; 10] = [
    RGBColor(31, 78, 140),
    RGBColor(217, 95, 2),
    RGBColor(27, 138, 90),
    RGBColor(170, 45, 120),
    RGBColor(90, 90, 90),
    RGBColor(180, 140, 0),
    RGBColor(0, 140, 170),
    RGBColor(140, 60, 30),
    RGBColor(110, 70, 190),
    RGBColor(230, 110, 150),
];

/// Errors below this are drawn there.
const LEAST: f64 = 1e-17;

/// The files' names.
pub const TRADE: &str = "trade.svg";
pub const GROWTH: &str = "growth.svg";

/// File names and their content; no plot without data. The error is what the plotting library says.
pub fn all(samples: &[Sample], methods: &[BenchMethod]) -> Result<Vec<(&'static str, String)>, String> {
    let text = |error: &dyn std::fmt::Display| format!("a plot cannot be drawn: {error}");
    let mut plots = Vec::new();
    if !points(samples, methods).is_empty() {
        plots.push((TRADE, trade(samples, methods).map_err(|error| text(&error))?));
    }
    if has_growth(samples, methods) {
        plots.push((GROWTH, growth(samples, methods).map_err(|error| text(&error))?));
    }
    Ok(plots)
}

/// Whether there is a time to draw against the number of equations.
pub fn has_growth(samples: &[Sample], methods: &[BenchMethod]) -> bool {
    methods.iter().any(|method| method.is_drawn && !series(samples, method.name).0.is_empty())
}

/// A method over all systems: mean time relative to the default (geometric), and the worst error: 1 where a rank is wrong without a
/// warning, else the residual.
pub struct PlotPoint {
    pub method: &'static str,
    pub time: f64,
    pub error: f64,
    /// How many of the systems it did, ...
    pub done: usize,
    /// ... and how many the default did.
    pub of: usize,
}

impl PlotPoint {
    /// Whether it gave none up: what it gave up would have cost most time.
    fn is_whole(&self) -> bool {
        self.done == self.of
    }

    fn label(&self) -> String {
        if self.is_whole() { self.method.to_owned() } else { format!("{} ({} of {})", self.method, self.done, self.of) }
    }
}

/// Methods that did any system, with those that they did.
pub fn points(samples: &[Sample], methods: &[BenchMethod]) -> Vec<PlotPoint> {
    let default: BTreeMap<(&str, &str), f64> = samples
        .iter()
        .filter(|sample| sample.method == methods[0].name)
        .filter_map(|sample| Some(((sample.family, sample.size.as_str()), sample.measured()?.time)))
        .collect();
    let point = |method: &BenchMethod| {
        let (mut logs, mut done, mut error) = (0.0, 0, LEAST);
        for sample in samples.iter().filter(|sample| sample.method == method.name) {
            let (Some(measured), Some(time)) =
                (&sample.measured(), default.get(&(sample.family, sample.size.as_str())))
            else {
                continue;
            };
            logs += (measured.time / time).ln();
            done += 1;
            let is_right = verdict(sample, measured) == "right" || measured.ambiguous;
            error = f64::max(error, if is_right { measured.residual } else { 1.0 });
        }
        let time = f64::exp(logs / done as f64);
        (done > 0).then(|| PlotPoint { method: method.name, time, error: error.min(1.0), done, of: default.len() })
    };
    methods.iter().filter_map(point).collect()
}

/// Points of methods that did every system that no other such point beats in both, from the fastest on.
pub fn front(points: &[PlotPoint]) -> Vec<&PlotPoint> {
    let mut sorted: Vec<&PlotPoint> = points.iter().filter(|point| point.is_whole()).collect();
    sorted.sort_by(|a, b| a.time.total_cmp(&b.time).then(a.error.total_cmp(&b.error)));
    let mut least = f64::INFINITY;
    sorted.retain(|point| {
        let is_better = point.error < least;
        least = least.min(point.error);
        is_better
    });
    sorted
}

pub type Drawn = Result<String, Box<dyn std::error::Error>>;

fn trade(samples: &[Sample], methods: &[BenchMethod]) -> Drawn {
    let points = points(samples, methods);
    let range = |values: &dyn Fn(&PlotPoint) -> f64, room: f64| {
        let low = points.iter().map(values).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(values).fold(0.0, f64::max);
        low / room..high * room
    };
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (900, 560)).into_drawing_area();
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&root)
            .caption("Error against time", ("sans-serif", 20))
            .margin(16)
            .x_label_area_size(44)
            .y_label_area_size(64)
            .build_cartesian_2d(range(&|p| p.time, 2.5).log_scale(), range(&|p| p.error, 8.0).log_scale())?;
        chart
            .configure_mesh()
            .x_desc("time, relative to the default (geometric mean over the systems)")
            .y_desc("worst residual; 1 where a rank is wrong without a warning")
            .x_label_formatter(&|x| x.to_string())
            .y_label_formatter(&|y| format!("{y:.0e}"))
            .light_line_style(WHITE)
            .draw()?;
        let along = front(&points).into_iter().map(|p| (p.time, p.error));
        chart
            .draw_series(LineSeries::new(along, COLOURS[4].stroke_width(2)))?
            .label("Pareto front")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 20, y)], COLOURS[4].stroke_width(2)));
        let mut labels = PlotLabels::default();
        for (k, point) in points.iter().enumerate() {
            let colour = COLOURS[k % COLOURS.len()];
            let (at, label) = ((point.time, point.error), point.label());
            let lift = labels.place(chart.backend_coord(&at), label.len());
            let style = if point.is_whole() { colour.filled() } else { colour.stroke_width(1) };
            chart.draw_series([Circle::new(at, 5, style)])?;
            chart.draw_series([
                EmptyElement::at(at) + Text::new(label, (8, lift), ("sans-serif", 12).into_font().color(&colour))
            ])?;
        }
        chart.configure_series_labels().border_style(BLACK.mix(0.3)).background_style(WHITE).draw()?;
        root.present()?;
    }
    Ok(svg)
}

fn growth(samples: &[Sample], methods: &[BenchMethod]) -> Drawn {
    let drawn: Vec<&BenchMethod> = methods.iter().filter(|method| method.is_drawn).collect();
    let all: Vec<(f64, f64)> = drawn.iter().flat_map(|method| series(samples, method.name).0).collect();
    let low = |k: fn(&(f64, f64)) -> f64| all.iter().map(k).fold(f64::INFINITY, f64::min);
    let high = |k: fn(&(f64, f64)) -> f64| all.iter().map(k).fold(0.0, f64::max);
    let (x, y) = (low(|p| p.0) / 1.2..high(|p| p.0) * 1.2, low(|p| p.1) / 2.0..high(|p| p.1) * 2.0);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (900, 560)).into_drawing_area();
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&root)
            .caption("Time of the elimination, tie of Table 1", ("sans-serif", 20))
            .margin(16)
            .x_label_area_size(44)
            .y_label_area_size(64)
            .build_cartesian_2d(x.log_scale(), y.log_scale())?;
        chart
            .configure_mesh()
            .x_desc("equations")
            .y_desc("ms")
            .x_label_formatter(&|x| x.to_string())
            .y_label_formatter(&|y| y.to_string())
            .light_line_style(WHITE)
            .draw()?;
        for (k, method) in drawn.iter().enumerate() {
            let (points, exponent) = series(samples, method.name);
            let colour = COLOURS[k % COLOURS.len()];
            let label = match exponent {
                Some(exponent) => format!("{}: exponent {exponent:.2}", method.name),
                None => method.name.to_owned(),
            };
            chart
                .draw_series(LineSeries::new(points.clone(), colour.stroke_width(2)))?
                .label(label)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
            chart.draw_series(points.into_iter().map(|at| Circle::new(at, 4, colour.filled())))?;
        }
        let place = SeriesLabelPosition::MiddleRight;
        chart.configure_series_labels().position(place).border_style(BLACK.mix(0.3)).background_style(WHITE).draw()?;
        root.present()?;
    }
    Ok(svg)
}

#[cfg(test)]
mod tests {
    use super::{PlotPoint, front};

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let point = |method, time, error| PlotPoint { method, time, error, done: 7, of: 7 };
        let given_up = PlotPoint { done: 6, ..point("e", 0.1, 1e-12) };
        let points =
            [point("a", 1.0, 1e-3), point("b", 2.0, 1e-3), point("c", 3.0, 1e-9), point("d", 0.5, 1.0), given_up];
        assert_eq!(front(&points).iter().map(|p| p.method).collect::<Vec<_>>(), ["d", "a", "c"]);
        assert_eq!(points[4].label(), "e (6 of 7)");
    }
}
