//! Plots times against equations, a panel for each coupling: solid lines for C, dashed lines for `C^T`, crosses where Gauss and QR cross.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::combinators::IntoLogRange;
use plotters::prelude::*;

use super::super::plot::{COLOURS, Drawn};
use super::super::systems::TIE;
use super::crossing::{Pair, crossings, pairs, papers_pairs};
use super::{FigureLevel, FigureSide, GAUSS, backends, families, series};

/// Name of the file with the plot.
pub const FILE: &str = "figure-15.svg";

/// Lengths of dashes and gaps of the lines for `C^T`, in pixels.
const DASH: (i32, i32) = (6, 4);

/// Vertical distance of two labels, in pixels.
pub const LETTERS: i32 = 13;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A line of the plot: seconds against equations.
pub struct PlotLine {
    pub label: String,
    pub points: Vec<(f64, f64)>,
    pub colour: RGBColor,
    pub is_broken: bool,
}

impl PlotLine {
    fn last(&self) -> (f64, f64) {
        self.points.last().copied().unwrap_or_default()
    }
}

/// Name and content of the plot, if anything was measured. The error is that of the plotting library.
pub fn plots(levels: &[FigureLevel]) -> Result<Option<(&'static str, String)>, String> {
    if levels.is_empty() {
        return Ok(None);
    }
    let svg = draw(levels).map_err(|error| format!("a plot cannot be drawn: {error}"))?;
    Ok(Some((FILE, svg)))
}

fn draw(levels: &[FigureLevel]) -> Drawn {
    let families = families(levels);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (560 * families.len() as u32, 560)).into_drawing_area();
        root.fill(&WHITE)?;
        let panels = root.split_evenly((1, families.len()));
        for (family, area) in families.iter().zip(&panels) {
            panel(area, levels, family)?;
        }
        root.present()?;
    }
    Ok(svg)
}

/// The lines of a coupling; the tie has the paper's numbers of equations, so its panel also shows the paper's times.
pub fn lines(levels: &[FigureLevel], family: &str) -> Vec<PlotLine> {
    let of = |(k, backend): (usize, &'static str)| {
        FigureSide::BOTH.map(|side| PlotLine {
            label: format!("{backend}, {}", side.name()),
            points: series(levels, family, backend, side),
            colour: COLOURS[k],
            is_broken: side == FigureSide::Transposed,
        })
    };
    let mut lines: Vec<PlotLine> = backends(levels).into_iter().enumerate().flat_map(of).collect();
    if family == TIE {
        let own = |label: &str, time: fn(&Pair) -> f64, is_broken| PlotLine {
            label: label.to_owned(),
            points: papers_pairs().iter().map(|pair| (pair.equations, time(pair))).collect(),
            colour: COLOURS[4],
            is_broken,
        };
        lines.extend([own("the paper's Gauss", |pair| pair.gauss, false), own("the paper's QR", |pair| pair.qr, true)]);
    }
    lines.retain(|line| !line.points.is_empty());
    // In descending order of time, so that shifted labels keep the order of their lines.
    lines.sort_by(|a, b| b.last().1.total_cmp(&a.last().1));
    lines
}

/// Ranges of the axes for all points, with space for the labels on the right.
fn ranges(lines: &[PlotLine]) -> (Range<f64>, Range<f64>) {
    let all = || lines.iter().flat_map(|line| &line.points);
    let low = |k: fn(&(f64, f64)) -> f64| all().map(k).fold(f64::INFINITY, f64::min);
    let high = |k: fn(&(f64, f64)) -> f64| all().map(k).fold(0.0, f64::max);
    (low(|p| p.0) / 1.3..high(|p| p.0) * 6.0, low(|p| 1e3 * p.1) / 2.0..high(|p| 1e3 * p.1) * 2.0)
}

fn panel(area: &Area, levels: &[FigureLevel], family: &str) -> Result<(), Box<dyn std::error::Error>> {
    let lines = lines(levels, family);
    if lines.is_empty() {
        return Ok(());
    }
    let (x, y) = ranges(&lines);
    let mut chart = ChartBuilder::on(area)
        .caption(format!("{family}: bare factorizations"), ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d(x.log_scale(), y.log_scale())?;
    let mut mesh = chart.configure_mesh();
    mesh.x_desc("equations").y_desc("ms").x_label_formatter(&|x| x.to_string());
    mesh.y_label_formatter(&|y| y.to_string()).light_line_style(WHITE).draw()?;
    let mut taken = i32::MIN / 2;
    for line in &lines {
        let points = line.points.iter().map(|&(n, time)| (n, 1e3 * time));
        let style = line.colour.stroke_width(2);
        if line.is_broken {
            chart.draw_series(DashedLineSeries::new(points.clone(), DASH.0, DASH.1, style))?;
        } else {
            chart.draw_series(LineSeries::new(points.clone(), style))?;
        }
        chart.draw_series(points.map(|at| Circle::new(at, 3, line.colour.filled())))?;
        let (n, time) = line.last();
        let end = (n, 1e3 * time);
        let height = chart.backend_coord(&end).1;
        taken = below(height, taken);
        let font = ("sans-serif", 12).into_font().color(&line.colour);
        chart.draw_series([EmptyElement::at(end) + Text::new(line.label.clone(), (8, taken - height), font)])?;
    }
    chart.draw_series(marks(levels, family).into_iter().map(|at| Cross::new(at, 6, BLACK.stroke_width(2))))?;
    Ok(())
}

/// The height of the top of a label, in pixels: beside the end of its line, which is at `height`, or else directly below the label at
/// `above`.
pub fn below(height: i32, above: i32) -> i32 {
    (height - 6).max(above + LETTERS)
}

/// Crossings of Gauss and a QR on the same matrix: equations and milliseconds.
pub fn marks(levels: &[FigureLevel], family: &str) -> Vec<(f64, f64)> {
    let others = backends(levels).into_iter().filter(|name| *name != GAUSS);
    let mut all: Vec<Vec<Pair>> =
        others.flat_map(|qr| FigureSide::BOTH.map(|side| pairs(levels, family, side, qr))).collect();
    if family == TIE {
        all.push(papers_pairs());
    }
    all.iter().flat_map(|pairs| crossings(pairs)).map(|crossing| (crossing.equations, 1e3 * crossing.time)).collect()
}
