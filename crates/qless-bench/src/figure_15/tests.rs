//! The text and the plot of Gauss and QR show the measured numbers.

use super::crossing::{Pair, crossings, papers_pairs, sentence};
use super::plot::{LETTERS, below, lines, marks, plots};
use super::{FigureLevel, FigureSide, GAUSS, Way, csv, markdown, section};

/// Pairs with these ratios of the times of Gauss and QR, on 100, 200, 400 equations and so on.
fn pairs(ratios: &[f64]) -> Vec<Pair> {
    let pair = |(k, &ratio): (usize, &f64)| Pair {
        size: format!("level {k}"),
        equations: 100.0 * f64::from(1 << k),
        gauss: ratio,
        qr: 1.0,
    };
    ratios.iter().enumerate().map(pair).collect()
}

#[test]
fn a_crossing_is_where_the_lines_meet() {
    let found = crossings(&pairs(&[0.25, 0.5, 2.0, 4.0]));
    assert_eq!((found.len(), found[0].after), (1, 1));
    // Halfway between 200 and 400 in logarithms, where both take one second.
    assert!((found[0].equations - 200.0 * 2.0_f64.sqrt()).abs() < 1e-9 && (found[0].time - 1.0).abs() < 1e-12);
    assert!(crossings(&pairs(&[0.5, 0.9])).is_empty() && crossings(&pairs(&[2.0])).is_empty());
    assert_eq!(crossings(&pairs(&[0.5, 2.0, 0.5])).len(), 2);
}

#[test]
fn the_sentence_says_who_is_faster_where() {
    let says = |ratios: &[f64], words: &str| {
        let said = sentence(&pairs(ratios)).expect("two levels at least");
        assert!(said.starts_with(words), "{said}");
    };
    says(&[0.5, 0.8], "Gauss is faster on every level (Gauss takes 0.50 times as long as QR at level 0, 0.80");
    says(&[2.0, 1.5], "QR is faster on every level (");
    says(&[0.25, 0.5, 2.0], "Gauss is faster up to level 1, QR from level 2 on; they cross at about 300 equations (");
    says(&[4.0, 0.25], "QR is faster up to level 0, Gauss from level 1 on");
    says(&[0.5, 2.0, 0.5], "they cross 2 times, at about 100 and 300 equations; from there on Gauss is faster (");
    assert_eq!((sentence(&[]), sentence(&pairs(&[1.0]))), (None, None));
}

#[test]
fn the_papers_own_times_cross_between_80_and_90_percent() {
    let found = crossings(&papers_pairs());
    assert_eq!((found.len(), found[0].after), (1, 3));
    assert!((17_408.0..22_360.0).contains(&found[0].equations), "{:?}", found[0]);
}

/// Three levels of both couplings; on the last level, Gauss takes `ratio` times as long as the QR.
fn levels(ratio: f64) -> Vec<FigureLevel> {
    let way = |backend, side, time: f64| Way { backend, side, result: Ok((time, 7)) };
    let level = |family, k: i32| FigureLevel {
        family,
        size: format!("{k}0 %"),
        equations: 1000 << k,
        rank: 7,
        blocks: 2,
        largest: (5, 6),
        ways: FigureSide::BOTH
            .into_iter()
            .flat_map(|side| [way(GAUSS, side, 1e-3 * ratio.powi(k - 1)), way("qless-qr", side, 1e-3)])
            .collect(),
    };
    ["tie", "mortar"].iter().flat_map(|family| (0..3).map(move |k| level(*family, k))).collect()
}

#[test]
fn the_tables_have_every_number_and_why_there_is_none() {
    let mut levels = levels(2.0);
    levels[0].ways[0].result = Err("no \"memory\"".into());
    levels[1].ways[1].result = Ok((12.345e-3, 9));
    let page = markdown(&levels) + &section::text(&levels);
    for text in [
        "## Figure 15: Gauss against QR",
        "(figure-15.svg)",
        "| mortar | C^T | qless-qr | Gauss is faster up to 00 %, QR from 10 % on; they cross at about 2,000 equations (",
        "| level | equations | blocks | largest | Gauss, C | qless-qr, C | Gauss, C^T | qless-qr, C^T |",
        "| 00 % | 1,000 | 2 | 5 x 6 | given up: no \"memory\" | 1.00 | 0.50 | 1.00 |",
        "| 10 % | 2,000 | 2 | 5 x 6 | 1.00 | 12.3, rank +2 | 1.00 | 1.00 |",
    ] {
        assert!(page.contains(text), "{text} is not in {page}");
    }
    let csv = csv(&levels);
    assert_eq!(csv.lines().count(), 1 + 6 * 4);
    assert!(csv.contains("\ntie,00 %,1000,7,2,Gauss,C,,,\"no 'memory'\"\n"), "{csv}");
    assert!(csv.contains("\ntie,10 %,2000,7,2,qless-qr,C,12.3450,9,\n"), "{csv}");
}

/// Left edge and height of every text of this name, in pixels.
fn places(svg: &str, label: &str) -> Vec<(f64, f64)> {
    let texts: Vec<&str> = svg.split("<text ").collect();
    let number = |text: &str, name: &str| text.split_once(name)?.1.split_once('"')?.0.parse().ok();
    let own = texts.iter().filter(|text| text.contains(&format!("\n{label}\n")));
    own.filter_map(|text| Some((number(text, "x=\"")?, number(text, "y=\"")?))).collect()
}

#[test]
fn the_plot_names_every_line_once_and_no_two_labels_meet() {
    // With this ratio, the lines of a coupling end within a few pixels of each other, so that their labels have to be moved.
    let levels = levels(1.01);
    let (name, svg) = plots(&levels).expect("drawn").expect("data");
    assert_eq!((name, plots(&[]).expect("nothing to draw")), ("figure-15.svg", None));
    for family in ["tie", "mortar"] {
        let all: Vec<String> =
            lines(&levels, family).into_iter().map(|line| line.label.replace('\'', "&apos;")).collect();
        let panel = usize::from(family == "mortar");
        let mut heights: Vec<f64> = Vec::new();
        for label in &all {
            let own: Vec<f64> =
                places(&svg, label).iter().filter(|p| (p.0 > 560.0) == (panel == 1)).map(|p| p.1).collect();
            assert_eq!(own.len(), 1, "{label} in {family}");
            heights.extend(own);
        }
        heights.sort_by(f64::total_cmp);
        assert!(heights.windows(2).all(|pair| pair[1] - pair[0] >= f64::from(LETTERS)), "{all:?}: {heights:?}");
    }
    assert_eq!(below(100, 20), 94);
    assert_eq!(below(100, 90), 90 + LETTERS);
}

#[test]
fn crosses_stand_where_the_lines_cross() {
    let all = levels(2.0);
    // One mark for C and one for its transpose; the tie has a third one, for the paper's times.
    assert_eq!((marks(&all, "mortar").len(), marks(&all, "tie").len()), (2, 3));
    let (equations, ms) = marks(&all, "mortar")[0];
    assert!((equations - 2000.0).abs() < 1e-6 && (ms - 1.0).abs() < 1e-9, "{equations} {ms}");
}
