//! What was read, as short text, and its analysis.

use qless::{Analysis, ConstraintSystem, Options, analyse};
use qless_io::deck::Model;

/// Equations as `1 1:1 -1 2:1`.
pub fn equations(model: &Model) -> Vec<String> {
    let text = |i| {
        let equation = model.equation(i).expect("an equation");
        let term = |(&j, a): (&u32, &f64)| format!("{a} {}", model.dof_name(model.dofs()[j as usize]));
        equation.columns.iter().zip(equation.coefficients).map(term).collect::<Vec<_>>().join(" ")
    };
    (0..model.equations()).map(text).collect()
}

/// Prescribed values as `1:3=0`, with the time history if it has a name.
pub fn prescribed(model: &Model) -> Vec<String> {
    let histories: Vec<_> = model.histories().collect();
    let history = |at: u32| histories[at as usize].map(|name| format!(" {name}")).unwrap_or_default();
    let case = &model.cases()[0];
    let text = |given: &qless_io::deck::Prescribed| {
        format!("{}={}{}", model.dof_name(given.dof), given.value, history(given.history))
    };
    case.prescribed.iter().map(text).collect()
}

/// Constraints that were left out, with their lines.
pub fn left_out(model: &Model) -> Vec<String> {
    model.left_out().map(|warning| format!("{}: {}", model.place_of(warning), warning.text)).collect()
}

pub fn system(model: &Model) -> ConstraintSystem {
    model.system(&model.cases()[0]).expect("a system")
}

pub fn analysis(model: &Model) -> Analysis {
    analyse(&system(model), &Options::default()).expect("an analysis")
}
