//! The written texts and plots contain the measured numbers.

use super::sample::{Measured, Sample};
use super::{methods, page, panels, plot, systems, table};

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
            residual: (k > 0).then_some(1e-16 * (k + 1) as f64),
            growth: (k > 0).then_some(1.0 + k as f64),
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

#[test]
fn every_method_has_a_colour_of_its_own() {
    let count = methods::all(&[]).len();
    // The bare factorization is the unit of the panels, not a line.
    assert!(plot::COLOURS.len() >= count && panels::COLOURS.len() >= count - 1, "{count} methods");
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
    let mut samples = samples(&methods);
    samples.iter_mut().for_each(|sample| sample.family = "windows, many combinations");
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
        assert_eq!((text("family"), text("size"), text("method")), (sample.family, "50 %", sample.method));
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
        is("residual", m.and_then(|m| m.residual));
        is("growth", m.and_then(|m| m.growth));
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
        (0, ["1.00", "0.50-3.00", "1.00", "-", "right", "0", "0", "-", "-", "-"]),
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
fn the_pictures_show_every_method_that_was_measured() {
    let methods = methods::all(&[]);
    let samples = samples(&methods);
    let plots = plot::all(&samples, &methods).expect("drawn");
    for (k, method) in methods.iter().enumerate().skip(1) {
        assert!(plots[0].1.contains(&format!(">{}</text>", method.name)), "{} in trade.svg", method.name);
        let is_measured = k + 1 < methods.len();
        assert_eq!(plots[1].1.contains(&format!("\n{}: ", method.name)), is_measured, "{} in growth.svg", method.name);
    }
    // The method whose time is the unit of the axis and the method that was given up have no dot; the dot of the method with a wrong rank
    // is empty.
    assert_eq!(plots[0].1.matches("<circle").count(), methods.len() - 2);
    assert_eq!(plots[0].1.matches("fill=\"none\" stroke=\"#").count(), 1);
}

#[test]
fn the_advice_has_the_numbers_of_each_effort() {
    let methods = methods::all(&[]);
    let page = page::markdown((&samples(&methods), &[]), &methods, &[], "qless bench");
    assert!(page.contains("| quick | 2.00, 2.00 to 2.00 | 1 | 1 | 0 | 2e-16 | 1 |"), "{page}");
    assert!(page.contains("| checked | 3.00, 3.00 to 3.00 | 1 | 0 | 1 | 3e-16 | 2 |"), "{page}");
}

#[test]
fn there_is_no_plot_without_data() {
    let methods = methods::all(&[]);
    let mut samples = samples(&methods);
    samples.iter_mut().for_each(|sample| sample.family = "chain");
    let names =
        |samples: &[Sample]| plot::all(samples, &methods).expect("drawn").iter().map(|p| p.0).collect::<Vec<_>>();
    assert_eq!(names(&samples), [panels::FILE]);
    samples.iter_mut().for_each(|sample| sample.result = Err("no reason".to_owned()));
    assert!(names(&samples).is_empty());
    assert!(!page::markdown((&samples, &[]), &methods, &[], "qless bench").contains(".svg"));
}

#[test]
fn an_exponent_comes_with_its_error_or_not_at_all() {
    let methods = methods::all(&["checked".to_owned()]);
    let with_times = |times: &[f64]| {
        let sample = |(k, &time): (i32, &f64)| {
            let mut sample = samples(&methods::all(&[])).swap_remove(2);
            sample.equations = 100 << k;
            sample.result = sample.result.map(|result| Measured { time, ..result });
            sample
        };
        table::exponents(&(0..).zip(times).map(sample).collect::<Vec<_>>(), &methods)
    };
    assert_eq!(with_times(&[1e-3, 4e-3, 16e-3, 64e-3]), "checked: exponent 2.00 ± 0.00");
    let none = "checked: runs too short, few or noisy for an exponent";
    assert_eq!(with_times(&[1e-3, 4e-3, 16e-3]), none);
    assert_eq!(with_times(&[1e-3, 30e-3, 2e-3, 64e-3]), none);
    assert_eq!(with_times(&[1e-6, 2e-6, 4e-6, 8e-6]), none);
}
