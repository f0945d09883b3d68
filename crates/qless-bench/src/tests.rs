//! The written texts and plots contain the measured numbers.

use super::sample::{Measured, Sample};
use super::{methods, page, plot, systems, table};

/// Samples of one system: method k took k + 1 milliseconds, and the last one was given up.
fn samples(methods: &[methods::BenchMethod]) -> Vec<Sample> {
    let result = |k: usize| {
        let time = 1e-3 * (k + 1) as f64;
        let given_up = Err("dense 9 x 9 are 0 MiB; stopped at the limit of 10 s".to_owned());
        let measured = Measured {
            time,
            quartiles: (time / 2.0, 3.0 * time),
            rank: if k == 1 { 6 } else { 7 },
            ambiguous: k == 2,
            false_drops: if k == 1 { 2 } else { 0 },
            false_keeps: usize::from(k == 1),
            residual: 1e-16 * (k + 1) as f64,
            growth: 1.0 + k as f64,
            error: (k > 0).then_some(1e-15 * k as f64),
            memory: (k > 0).then_some((k as u64) << 20),
        };
        if k + 1 < methods.len() { Ok(measured) } else { given_up }
    };
    let sample = |(k, method): (usize, &methods::BenchMethod)| Sample {
        family: systems::TIE,
        size: "50 %".into(),
        equations: 9,
        method: method.name,
        rank: 7,
        result: result(k),
    };
    methods.iter().enumerate().map(sample).collect()
}

/// The fields of a line; commas within quotes do not count.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.last_mut().expect("one at least").push(c),
        }
    }
    fields
}

#[test]
fn the_csv_has_every_number_under_its_name() {
    let methods = methods::all(&[]);
    let samples = samples(&methods);
    let csv = table::csv(&samples, &methods);
    let lines: Vec<Vec<String>> = csv.lines().map(fields).collect();
    let columns = fields(table::COLUMNS);
    assert_eq!(lines[0], columns);
    assert_eq!(lines.len(), methods.len() + 1);
    for (sample, line) in samples.iter().zip(&lines[1..]) {
        assert_eq!(line.len(), columns.len(), "{line:?}");
        let text = |name: &str| line[columns.iter().position(|column| *column == name).expect(name)].as_str();
        let is = |name: &str, value: Option<f64>| match value {
            Some(value) => {
                let found: f64 = text(name).parse().expect(name);
                assert!((found - value).abs() <= 1e-3 * value.abs(), "{name}: {found} for {value}");
            }
            None => assert_eq!(text(name), "", "{name}"),
        };
        let m = sample.measured();
        assert_eq!((text("family"), text("size"), text("method")), ("tie", "50 %", sample.method));
        is("equations", Some(9.0));
        is("rank_true", Some(7.0));
        is("ms", m.map(|m| 1e3 * m.time));
        is("ms_lower_quartile", m.map(|m| 1e3 * m.quartiles.0));
        is("ms_upper_quartile", m.map(|m| 1e3 * m.quartiles.1));
        is("times_first", m.map(|m| m.time / 1e-3));
        is("peak_bytes", m.and_then(|m| m.memory).map(|bytes| bytes as f64));
        is("rank", m.map(|m| m.rank as f64));
        is("false_drops", m.map(|m| m.false_drops as f64));
        is("false_keeps", m.map(|m| m.false_keeps as f64));
        is("residual", m.map(|m| m.residual));
        is("growth", m.map(|m| m.growth));
        is("error", m.and_then(|m| m.error));
        assert_eq!(text("ambiguous"), m.map_or(String::new(), |m| m.ambiguous.to_string()));
        let verdict = m.map_or("given up", |m| if m.rank == 7 { "right" } else { "drops" });
        assert_eq!(text("verdict"), verdict);
        assert_eq!(text("reason"), sample.result.as_ref().err().map_or("", |reason| reason));
    }
}

#[test]
fn the_table_for_people_has_the_same_numbers() {
    let methods = methods::all(&[]);
    let samples = samples(&methods);
    let text = table::text(&samples, &methods);
    assert!(table::HEAD.iter().all(|head| text.contains(head)));
    let expected = [
        (0, ["1.00", "0.50-3.00", "1.00", "-", "right", "0", "0", "1.0e-16", "1.00", "-"]),
        (1, ["2.00", "1.00-6.00", "2.00", "1.0", "drops", "2", "1", "2.0e-16", "2.00", "1.0e-15"]),
        (2, ["3.00", "1.50-9.00", "3.00", "2.0", "right, unsure", "0", "0", "3.0e-16", "3.00", "2.0e-15"]),
    ];
    for (k, cells) in expected {
        let name = methods[k].name;
        let plain = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
        let row = format!("{name} {}", cells.join(" "));
        assert!(text.lines().any(|line| plain(line) == row), "{row} is not in the text");
    }
    let last = methods[methods.len() - 1].name;
    let given_up = "given up: dense 9 x 9 are 0 MiB; stopped at the limit of 10 s";
    assert!(text.lines().any(|line| line.contains(last) && line.contains(given_up)));
}

#[test]
fn the_plots_show_every_method_that_was_measured() {
    let methods = methods::all(&[]);
    let samples = samples(&methods);
    let plots = plot::all(&samples, &methods).expect("drawn");
    for (k, method) in methods.iter().enumerate() {
        let is_measured = k + 1 < methods.len();
        let name = format!("\n{}\n", method.name.replace('\'', "&apos;"));
        assert_eq!(plots[0].1.contains(&name), is_measured, "{name} in trade.svg");
        assert_eq!(plots[1].1.contains(&name), method.is_drawn, "{name} in growth.svg");
        let series = super::sample::series(&samples, method.name).0;
        let expected: Vec<_> = is_measured.then_some((9.0, (k + 1) as f64)).into_iter().collect();
        assert_eq!(series.len(), expected.len(), "{name}");
        for (found, expected) in series.iter().zip(&expected) {
            assert!(found.0 == expected.0 && (found.1 - expected.1).abs() < 1e-12, "{found:?} for {expected:?}");
        }
    }
    let points = plot::points(&samples, &methods);
    assert_eq!((points[1].time, points[1].error), (2.0, 1.0), "a wrong rank is an error of 1");
    assert!((points[2].time - 3.0).abs() < 1e-12);
}

#[test]
fn the_advice_has_the_numbers_of_its_methods() {
    let methods = methods::all(&[]);
    let mut all = samples(&methods);
    let place = |name: &str| methods.iter().position(|method| method.name == name).expect(name);
    let (first, again) = (place("gauss"), samples(&methods));
    // On a second system one method takes ten times as long and finds a wrong rank; then this rank is ambiguous.
    all.extend(again);
    let second = methods.len() + first;
    all[second].result = all[second].result.clone().map(|found| Measured { time: 10.0 * found.time, rank: 5, ..found });
    let page = page::markdown(&all, &methods, &[], "qless bench");
    let n = (first + 1) as f64;
    let row = format!("| `--backend gauss` | {:.2}, {n:.2} to {:.2} | 1, 1, 2 |", 10.0 * n, 10.0 * n);
    assert!(page.contains(&row), "{row} is not in the page");
    all[second].result = all[second].result.clone().map(|found| Measured { ambiguous: true, ..found });
    let page = page::markdown(&all, &methods, &[], "qless bench");
    assert!(page.contains(&row.replace("1, 1, 2", "0, 1, 2")));
}

#[test]
fn there_is_no_plot_without_data() {
    let methods = methods::all(&[]);
    let mut samples = samples(&methods);
    samples.iter_mut().for_each(|sample| sample.family = "chain");
    let names =
        |samples: &[Sample]| plot::all(samples, &methods).expect("drawn").iter().map(|p| p.0).collect::<Vec<_>>();
    assert_eq!(names(&samples), [plot::TRADE]);
    let page = page::markdown(&samples, &methods, &[], "qless bench");
    assert!(page.contains(plot::TRADE) && !page.contains(plot::GROWTH));
    samples.iter_mut().for_each(|sample| sample.result = Err("no reason".to_owned()));
    assert!(names(&samples).is_empty());
    assert!(!page::markdown(&samples, &methods, &[], "qless bench").contains(".svg"));
}

#[test]
fn the_exponent_is_that_of_the_series() {
    let methods = methods::all(&["default".to_owned()]);
    let mut samples: Vec<Sample> = Vec::new();
    for (size, time) in [(100, 1e-3), (200, 4e-3), (400, 16e-3)] {
        let mut sample = samples_of_one();
        sample.equations = size;
        sample.result = sample.result.map(|result| Measured { time, ..result });
        samples.push(sample);
    }
    assert_eq!(table::exponents(&samples, &methods), "default 2.00");
    assert!(table::text(&samples, &methods).ends_with("to the power of: default 2.00\n"));
}

fn samples_of_one() -> Sample {
    let methods = methods::all(&[]);
    samples(&methods).swap_remove(0)
}
