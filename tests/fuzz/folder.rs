//! A case folder made from decoded values instead of raw bytes: sizes, coefficients, right-hand sides, prescribed values, labels, and
//! lists of preferred equations and DOFs. Most inputs are valid and reach the analysis and the reduction.

use std::path::Path;

use arbitrary::{Arbitrary, Unstructured};
use qless::{Analysis, AnalysisError, ConstraintSystem, Form, Options, Preferences, analyse};
use qless_io::{read_case, write_case};

/// The content of the folder, and the options of the analysis.
#[derive(Arbitrary, Debug)]
struct Folder {
    rows: u8,
    columns: u8,
    entries: Vec<(u8, u8, Number)>,
    rhs: Option<Vec<Number>>,
    prescribed: Option<Vec<(u8, Number)>>,
    row_labels: Option<Vec<String>>,
    column_labels: Option<Vec<String>>,
    keep: Vec<u8>,
    prefer: Vec<u8>,
    avoid: Vec<u8>,
    presolve: bool,
    factored: bool,
}

/// A coefficient: mostly a small whole number, so that equations are dependent; sometimes near the limits of doubles.
#[derive(Arbitrary, Debug)]
enum Number {
    Whole(i8),
    Quarter(i8),
    Any(f64),
    Power(i16),
    Text(String),
}

impl Number {
    fn text(&self) -> String {
        match self {
            Self::Whole(number) => (number % 4).to_string(),
            Self::Quarter(number) => (f64::from(*number) / 4.0).to_string(),
            Self::Any(number) => format!("{number:?}"),
            Self::Power(power) => format!("1e{}", power % 330),
            Self::Text(text) => text.clone(),
        }
    }
}

/// Largest number of rows and of columns.
const SIZE: u8 = 24;

/// Reads, writes, analyses and reduces the case.
pub fn folder(data: &[u8]) {
    let Ok(folder) = Folder::arbitrary_take_rest(Unstructured::new(data)) else { return };
    let place = tempfile::tempdir().expect("a temporary folder");
    let path = place.path().join("case");
    folder.put(&path);
    let Ok(system) = read_case(&path, None, None) else { return };
    let copy = place.path().join("copy");
    if write_case(&copy, &system).is_ok() {
        assert_eq!(read_case(&copy, None, None).expect("what was written is read"), system);
    }
    match analyse(&system, &folder.options()) {
        Ok(analysis) => folder.check(&system, &analysis),
        Err(AnalysisError::Option(_)) => folder.assert_listed_wrongly(&system),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

impl Folder {
    fn put(&self, path: &Path) {
        std::fs::create_dir(path).expect("a new folder");
        let put = |name: &str, lines: Vec<String>| std::fs::write(path.join(name), lines.concat()).expect("written");
        let (m, n) = (self.rows % (SIZE + 1), self.columns % SIZE + 1);
        let head = format!("%%MatrixMarket matrix coordinate real general\n{m} {n} {}\n", self.entries.len());
        let entry = |(i, j, v): &(u8, u8, Number)| format!("{} {} {}\n", i % m.max(1) + 1, j % n + 1, v.text());
        put("C.mtx", [head].into_iter().chain(self.entries.iter().map(entry)).collect());
        if let Some(rhs) = &self.rhs {
            let zero = Number::Whole(0);
            put("b.txt", (0..m.into()).map(|i| rhs.get(i).unwrap_or(&zero).text() + "\n").collect());
        }
        if let Some(prescribed) = &self.prescribed {
            put("prescribed.txt", prescribed.iter().map(|(j, v)| format!("{} {}\n", j % n + 1, v.text())).collect());
        }
        for (name, labels, count) in [("rows.txt", &self.row_labels, m), ("cols.txt", &self.column_labels, n)] {
            if let Some(labels) = labels {
                let label =
                    |k: usize| labels.get(k).map_or("", |label: &String| label.lines().next().unwrap_or_default());
                put(name, (0..count.into()).map(|k| format!("{}\n", label(k))).collect());
            }
        }
    }

    fn options(&self) -> Options {
        let list = |numbers: &[u8]| numbers.iter().map(|&number| usize::from(number % (SIZE + 2))).collect();
        let preferences =
            Preferences { equations: list(&self.keep), slaves: list(&self.prefer), masters: list(&self.avoid) };
        Options { preferences, presolve: self.presolve, ..Options::default() }
    }

    /// Options are refused if a list names a DOF or equation that does not exist, or a DOF twice.
    fn assert_listed_wrongly(&self, system: &ConstraintSystem) {
        let Preferences { equations, slaves, masters, .. } = self.options().preferences;
        let is_beyond = equations.iter().any(|&i| i >= system.equations())
            || slaves.iter().chain(&masters).any(|&j| j >= system.dofs());
        assert!(is_beyond || slaves.iter().any(|slave| masters.contains(slave)));
    }

    /// A reduction satisfies the equations, or there is a typed error.
    fn check(&self, system: &ConstraintSystem, analysis: &Analysis) {
        assert_eq!(analysis.kinds().len(), system.equations());
        assert_eq!(analysis.rank() + analysis.dependent().len(), system.equations());
        for k in 0..system.equations() {
            assert!(analysis.because(k).is_ok());
        }
        let form = if self.factored { Form::Factored } else { Form::Explicit };
        let Ok(reduction) = analysis.reduction_in(form) else { return };
        assert_eq!(reduction.slaves().len() + reduction.masters().len() + reduction.prescribed().len(), system.dofs());
        let residual = analysis.residual(&reduction).expect("of this analysis");
        assert!(residual <= 1e-10, "residual {residual:e}");
    }
}
