//! Certainty against time: a panel for each family, with a line for each method, so that labels do not overlap.

use std::fmt::Write;

use super::methods::{BenchMethod, EFFORTS, UNIT};
use super::sample::{Sample, verdict};

/// Name of the file with the panels.
pub const FILE: &str = "trade.svg";

/// Sizes in pixels: width of a panel, left edge and width of its plot, height of a line.
const PANEL: f64 = 440.0;
const LEFT: f64 = 120.0;
const WIDTH: f64 = 290.0;
const LINE: f64 = 18.0;
const COLUMNS: usize = 2;

/// Colours of the methods in order, light enough for a dark page and dark enough for a light one.
pub(super) const COLOURS: [&str; 10] =
    ["#d95f02", "#3b7dd8", "#1b9e77", "#9a5fd0", "#8a8a8a", "#b8860b", "#c2478f", "#008ba3", "#a0522d", "#6a9a1f"];

const STYLE: &str = "<style>text{font:12px sans-serif;fill:#222}.t{font-weight:bold}.a{fill:#777;font-size:10px}.g{stroke:#ddd}\
.f{fill:none;stroke:#888;stroke-width:1.5}@media(prefers-color-scheme:dark){text{fill:#ddd}.a{fill:#999}.g{stroke:#444}}</style>";

/// A method in a panel: quartiles and median relative to the time of the bare factorization, and whether the rank is right or in doubt.
struct Mark {
    line: usize,
    quartiles: [f64; 3],
    is_trusted: bool,
}

/// The largest system of each family on which the bare factorization and at least one other method were measured.
fn panels<'a>(samples: &'a [Sample], methods: &[BenchMethod]) -> Vec<(&'a Sample, Vec<Mark>)> {
    let mut panels: Vec<(&Sample, Vec<Mark>)> = Vec::new();
    for block in samples.chunks(methods.len()) {
        let marks = marks(block);
        if marks.is_empty() {
            continue;
        }
        panels.retain(|(sample, _)| sample.family != block[0].family);
        panels.push((&block[0], marks));
    }
    panels
}

fn marks(block: &[Sample]) -> Vec<Mark> {
    let Some(unit) = block.iter().find(|sample| sample.method == UNIT).and_then(Sample::measured) else {
        return Vec::new();
    };
    let mark = |(line, sample): (usize, &Sample)| {
        let measured = sample.measured()?;
        let quartiles = [measured.quartiles.0, measured.time, measured.quartiles.1].map(|time| time / unit.time);
        let is_trusted = verdict(sample, &measured) == "right" || measured.ambiguous;
        Some(Mark { line, quartiles, is_trusted })
    };
    block.iter().filter(|sample| sample.method != UNIT).enumerate().filter_map(mark).collect()
}

/// The picture; `None` without measurements.
pub fn svg(samples: &[Sample], methods: &[BenchMethod]) -> Option<String> {
    let panels = panels(samples, methods);
    let names: Vec<&str> = methods.iter().map(|method| method.name).filter(|&name| name != UNIT).collect();
    let times = panels.iter().flat_map(|(_, marks)| marks).flat_map(|mark| mark.quartiles);
    let (least, most) = times.fold((1.0_f64, 1.0_f64), |(least, most), x| (least.min(x), most.max(x)));
    let (low, high) = (least.log10().floor(), most.log10().ceil().max(1.0));
    let height = 24.0 + LINE * names.len() as f64 + 30.0;
    let rows = panels.len().div_ceil(COLUMNS);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\">{STYLE}\n",
        PANEL * COLUMNS as f64,
        height * rows as f64
    );
    for (k, (sample, marks)) in panels.iter().enumerate() {
        let (x, y) = (PANEL * (k % COLUMNS) as f64, height * (k / COLUMNS) as f64);
        _ = writeln!(out, "<g transform=\"translate({x},{y})\">");
        panel(&mut out, sample, marks, &names, (low, high));
        out += "</g>\n";
    }
    (!panels.is_empty()).then(|| out + "</svg>\n")
}

fn panel(out: &mut String, sample: &Sample, marks: &[Mark], names: &[&str], (low, high): (f64, f64)) {
    let at = |time: f64| LEFT + WIDTH * (time.log10() - low) / (high - low);
    let level = |line: usize| 32.0 + LINE * line as f64;
    let bottom = level(names.len()) - 8.0;
    _ = writeln!(out, "<text class=\"t\" x=\"8\" y=\"16\">{} {}</text>", sample.family, sample.size);
    for power in low as i32..=high as i32 {
        let x = at(10_f64.powi(power));
        _ = writeln!(out, "<line class=\"g\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"24\" y2=\"{bottom:.1}\"/>");
        let text = if power < 0 {
            format!("{:.*}", -power as usize, 10_f64.powi(power))
        } else {
            10_f64.powi(power).to_string()
        };
        _ = writeln!(
            out,
            "<text class=\"a\" x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{text}</text>",
            bottom + 12.0
        );
    }
    for (line, name) in names.iter().enumerate() {
        _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{name}</text>",
            LEFT - 12.0,
            level(line) + 4.0
        );
    }
    let of_efforts = marks.iter().filter(|mark| EFFORTS.iter().any(|effort| effort.name() == names[mark.line]));
    let front: Vec<String> =
        of_efforts.map(|mark| format!("{:.1},{:.1}", at(mark.quartiles[1]), level(mark.line))).collect();
    _ = writeln!(out, "<polyline class=\"f\" points=\"{}\"/>", front.join(" "));
    for Mark { line, quartiles, is_trusted } in marks {
        let (colour, y) = (COLOURS[line % COLOURS.len()], level(*line));
        let [from, median, to] = quartiles.map(at);
        let fill = if *is_trusted { colour } else { "none" };
        _ = writeln!(
            out,
            "<line x1=\"{from:.1}\" x2=\"{to:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"{colour}\" stroke-width=\"4\"/>"
        );
        _ = writeln!(
            out,
            "<circle cx=\"{median:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"2\"/>"
        );
    }
}
