//! Time against the number of equations as SVG, with the exponents and their errors in the legend.

use plotters::coord::combinators::IntoLogRange;
use plotters::prelude::*;

use super::methods::BenchMethod;
use super::panels;
use super::sample::{Sample, Series};

/// Colours that can be distinguished in print too.
pub const COLOURS: [RGBColor; 11] = [
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
    RGBColor(100, 150, 30),
];

/// Name of the file with the plot of times against equations.
pub const GROWTH: &str = "growth.svg";

/// File names and contents of the plots that have data. The error is the message of the plotting library.
pub fn all(samples: &[Sample], methods: &[BenchMethod]) -> Result<Vec<(&'static str, String)>, String> {
    let mut plots: Vec<_> = panels::svg(samples, methods).map(|svg| (panels::FILE, svg)).into_iter().collect();
    if has_growth(samples, methods) {
        plots.push((GROWTH, growth(samples, methods).map_err(|error| format!("a plot cannot be drawn: {error}"))?));
    }
    Ok(plots)
}

/// Returns true if there is a time to draw against the number of equations.
pub fn has_growth(samples: &[Sample], methods: &[BenchMethod]) -> bool {
    methods.iter().any(|method| has_points(samples, method))
}

fn has_points(samples: &[Sample], method: &BenchMethod) -> bool {
    !Series::new(samples, method.name).points.is_empty()
}

pub type Drawn = Result<String, Box<dyn std::error::Error>>;

fn growth(samples: &[Sample], methods: &[BenchMethod]) -> Drawn {
    let all: Vec<(f64, f64)> = methods.iter().flat_map(|method| Series::new(samples, method.name).points).collect();
    let low = |k: fn(&(f64, f64)) -> f64| all.iter().map(k).fold(f64::INFINITY, f64::min);
    let high = |k: fn(&(f64, f64)) -> f64| all.iter().map(k).fold(0.0, f64::max);
    let (least, most) = (low(|p| p.1) / 2.0, high(|p| p.1) * 2.0);
    // The legend stands above all points, and each of its lines is a 27th of the height.
    let legend = (methods.iter().filter(|method| has_points(samples, method)).count() + 1) as f64 / 27.0;
    let (x, y) = (low(|p| p.0) / 1.2..high(|p| p.0) * 1.2, least..most * (most / least).powf(legend / (1.0 - legend)));
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (900, 560)).into_drawing_area();
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&root)
            .caption("Time of the verdict, tie of Table 1", ("sans-serif", 20))
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
        for (k, method) in methods.iter().filter(|method| has_points(samples, method)).enumerate() {
            let series = Series::new(samples, method.name);
            let (label, points) = (format!("{}: {}", method.name, series.words()), series.points);
            let colour = COLOURS[k % COLOURS.len()];
            chart
                .draw_series(LineSeries::new(points.clone(), colour.stroke_width(2)))?
                .label(label)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
            chart.draw_series(points.into_iter().map(|at| Circle::new(at, 4, colour.filled())))?;
        }
        let place = SeriesLabelPosition::UpperLeft;
        chart.configure_series_labels().position(place).border_style(BLACK.mix(0.3)).background_style(WHITE).draw()?;
        root.present()?;
    }
    Ok(svg)
}
