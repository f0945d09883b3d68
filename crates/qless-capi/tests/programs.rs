//! C programs against the header and the shared library: the example, misuse, CalculiX's arrays, and the corpus to the last bit.

mod support;

use std::fmt::Write;

use qless::{Analysis, ConstraintSystem, Elimination, Form, Kind, Options, analyse};
use qless_io::read_case;
use support::{build, compile, output, valgrind};

#[test]
fn the_example_prints_what_its_page_says() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/c.md");
    let page = std::fs::read_to_string(page).expect("the page");
    assert!(page.contains(include_str!("c/example.c")), "docs/c.md has another example");
    let program = compile("example", &[]);
    assert_eq!(output(&program, ""), "rank 2 of 3 equations; row 2 = +1 * row 0 +1 * row 1\nu = 1.5 1 1\n");
}

#[test]
fn misuse_is_an_error_and_no_crash() {
    let program = compile("misuse", &["-pthread"]);
    assert_eq!(output(&program, ""), "misuse: every call returned\n");
}

#[test]
fn no_program_leaks_or_reads_what_is_not_its_own() {
    valgrind(&compile("misuse", &["-pthread"]));
    valgrind(&compile("calculix", &[]));
}

#[test]
fn owners_of_cpp_free_what_they_make() {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/c/owners.cpp");
    let program = build("c++", &["-std=c++17"], source, &["-pedantic"]);
    assert_eq!(output(&program, ""), "owners: as expected\n");
    valgrind(&program);
}

#[test]
fn the_fortran_module_counts_from_one() {
    let module = concat!(env!("CARGO_MANIFEST_DIR"), "/include/qless.f90");
    let objects = tempfile::tempdir().expect("a folder");
    let folder = format!("-J{}", objects.path().display());
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/c/module.f90");
    let program = build("gfortran", &["-std=f2018"], source, &["-Wno-compare-reals", module, &folder]);
    // No valgrind: gfortran does not free texts that functions return.
    assert_eq!(output(&program, ""), "module: as expected\n");
}

/// The third equation follows from the others, and 1:1 is the slave of two.
#[test]
fn arrays_of_calculix_become_independent_with_one_slave_each() {
    let text = output(&compile("calculix", &[]), "");
    let first: Vec<&str> = text.lines().filter_map(|line| line.split(' ').nth(2)).collect();
    assert_eq!(first.len(), 2, "{text}");
    assert_ne!(first[0], first[1], "{text}");
}

#[test]
fn c_has_the_bits_of_rust_on_the_corpus() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/corpus/cases");
    let cases = std::fs::read_dir(folder).expect("the corpus").flatten();
    let systems: Vec<_> = cases.map(|case| read_case(&case.path(), None, None).expect("a case")).collect();
    assert!(systems.len() > 25, "{} systems", systems.len());
    for (flags, base) in [(&[][..], 0), (&["-DWIDE"][..], 1)] {
        let input: String = systems.iter().map(|system| given(system, base)).collect();
        let expected: String = systems.iter().map(|system| results(system, base)).collect();
        let found = output(&compile("corpus", flags), &input);
        for (k, (found, expected)) in found.lines().zip(expected.lines()).enumerate() {
            assert_eq!(found, expected, "line {k}");
        }
        assert_eq!(found.lines().count(), expected.lines().count());
    }
}

/// A system as the program reads it.
fn given(system: &ConstraintSystem, base: usize) -> String {
    let (matrix, prescribed) = (system.matrix(), system.prescribed());
    let sizes =
        [system.equations(), system.dofs(), matrix.nnz(), prescribed.len()].map(|size| size.to_string()).join(" ");
    let integers =
        |list: &mut dyn Iterator<Item = usize>| list.map(|k| (k + base).to_string()).collect::<Vec<_>>().join(" ");
    // Rust prints decimals that give the same double, and C reads them so.
    let numbers = |list: &mut dyn Iterator<Item = f64>| list.map(|v| format!("{v:e}")).collect::<Vec<_>>().join(" ");
    [
        format!("{sizes} {base}"),
        integers(&mut matrix.starts().iter().copied()),
        integers(&mut matrix.columns().iter().map(|&j| j as usize)),
        numbers(&mut matrix.values().iter().copied()),
        numbers(&mut system.rhs().iter().copied()),
        integers(&mut prescribed.iter().map(|&(j, _)| j)),
        numbers(&mut prescribed.iter().map(|&(_, value)| value)),
    ]
    .join("\n")
        + "\n"
}

/// The lines that the program must print.
fn results(system: &ConstraintSystem, base: usize) -> String {
    let analysis = analyse(system, &Options::default()).expect("an analysis");
    let mut text = diagnosis(&analysis, base);
    let Ok(elimination) = Elimination::from_analysis(analysis, Form::Explicit) else { return text };
    let reduction = elimination.reduction();
    let line = |name: &str, list: &[usize]| integers(name, list.iter().copied(), base);
    text += &line("slaves", elimination.slaves());
    text += &line("masters", elimination.masters());
    text += &line("starts", reduction.t().starts());
    text += &integers("columns", reduction.t().columns().iter().map(|&j| j as usize), base);
    let x: Vec<f64> = (0..elimination.masters().len()).map(|k| 1.0 / (k + 1) as f64).collect();
    let (mut u, mut restricted) = (vec![0.0; elimination.dofs()], vec![0.0; x.len()]);
    elimination.expand_into(&x, &mut u).expect("finite");
    elimination.restrict_into(&u, &mut restricted).expect("finite");
    let multipliers = elimination.multipliers(&u).expect("factors");
    for (name, list) in [
        ("T", reduction.t().values()),
        ("G", reduction.g_matrix().values()),
        ("g", reduction.g()),
        ("u", &u),
        ("restricted", &restricted),
        ("multipliers", &multipliers),
    ] {
        text += &numbers(name, list);
    }
    text
}

fn diagnosis(analysis: &Analysis, base: usize) -> String {
    let count = |kind: Kind| analysis.kinds().iter().filter(|&&k| k == kind).count();
    let confidence = analysis.confidence();
    let mut text = format!(
        "rank {} {} {} {}\n",
        analysis.rank(),
        count(Kind::Redundant),
        count(Kind::Conflicting),
        u8::from(confidence.ambiguous)
    );
    text += &numbers("digits", &[confidence.digits_kept(), confidence.digits_dropped()]);
    for dependent in analysis.dependent() {
        let terms = analysis.because(dependent.row).expect("a row");
        text += &integers("because", terms.iter().map(|term| term.row), base);
        text += &numbers("coefficients", &terms.iter().map(|term| term.coefficient).collect::<Vec<_>>());
    }
    text
}

fn integers(name: &str, list: impl Iterator<Item = usize>, base: usize) -> String {
    let mut text = name.to_owned();
    list.for_each(|k| write!(text, " {}", k + base).expect("memory"));
    text + "\n"
}

fn numbers(name: &str, list: &[f64]) -> String {
    let mut text = name.to_owned();
    list.iter().for_each(|v| write!(text, " {:016x}", v.to_bits()).expect("memory"));
    text + "\n"
}
