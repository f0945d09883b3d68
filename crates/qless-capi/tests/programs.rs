//! C programs against the header and the shared library: the examples, misuse, CalculiX, Eigen, PETSc, ranks of MPI, and the corpus to the last bit.

mod support;

use std::fmt::Write;

use qless::elimination::{PrescribedDofs, View};
use qless::{Analysis, ConstraintSystem, Elimination, Form, Kind, Options, analyse};
use qless_io::read_case;
use support::{build, compile, on_ranks, output, valgrind};

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
    valgrind(&compile("misuse", &["-pthread"]), "");
    valgrind(&compile("calculix", &[]), "");
}

#[test]
fn owners_of_cpp_free_what_they_make() {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/c/owners.cpp");
    let program = build("c++", &["-std=c++17"], source, &["-pedantic"]);
    assert_eq!(output(&program, ""), "owners: as expected\n");
    valgrind(&program, "");
}

#[test]
fn the_fortran_module_counts_from_one() {
    let module = concat!(env!("CARGO_MANIFEST_DIR"), "/include/qless.f90");
    let objects = tempfile::tempdir().expect("a folder");
    let folder = format!("-J{}", objects.path().display());
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/c/module.f90");
    let program = build(
        "gfortran",
        &["-std=f2018"],
        source,
        &["-cpp", "-ffree-line-length-none", "-Wno-compare-reals", module, &folder],
    );
    // No valgrind: gfortran does not free texts that functions return.
    assert_eq!(output(&program, ""), "module: as expected\n");
}

/// A cube on four fixed nodes with these equations; 7:1 is prescribed.
fn cube(equations: &str) -> String {
    let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
    let nodes = (0..8).map(|k| format!("{},{}.,{}.,{}.\n", k + 1, corners[k % 4].0, corners[k % 4].1, k / 4));
    format!(
        "*NODE, NSET=ALL\n{}*ELEMENT, TYPE=C3D8, ELSET=E\n1,1,2,3,4,5,6,7,8\n{equations}*MATERIAL, NAME=M\n*ELASTIC\n1000.,0.3\n\
         *SOLID SECTION, ELSET=E, MATERIAL=M\n*STEP\n*STATIC\n*BOUNDARY\n1,1,3\n2,1,3\n3,1,3\n4,1,3\n7,1,1,0.01\n*CLOAD\n6,2,1.\n\
         *NODE PRINT, NSET=ALL\nU\n*END STEP\n",
        nodes.collect::<String>()
    )
}

/// The displacements that ccx prints for a deck, by node; an error is its exit code.
fn ccx(deck: &str) -> Result<Vec<[f64; 3]>, Option<i32>> {
    let place = tempfile::tempdir().expect("a folder");
    std::fs::write(place.path().join("deck.inp"), deck).expect("a file");
    let mut command = std::process::Command::new("ccx");
    command.args(["-i", "deck"]).current_dir(place.path()).env("OMP_NUM_THREADS", "1");
    let output = command.output().expect("ccx, which scripts/install installs");
    if !output.status.success() {
        return Err(output.status.code());
    }
    let printed = std::fs::read_to_string(place.path().join("deck.dat")).expect("results");
    let numbers = |line: &str| line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>().ok();
    let of_node = |line: &str| numbers(line).and_then(|list| <[f64; 4]>::try_from(list).ok());
    Ok(printed.lines().filter_map(of_node).map(|[_, x, y, z]| [x, y, z]).collect())
}

/// ccx refuses the equations as they are: two have one slave, and another slave is prescribed.
#[test]
fn arrays_of_calculix_become_equations_that_ccx_accepts() {
    let text = output(&compile("calculix", &[]), "");
    let (before, after) = text.split_once("**\n").expect("two sets of equations");
    assert_eq!((before.matches("*EQUATION").count(), after.matches("*EQUATION").count()), (4, 3));
    assert_eq!(ccx(&cube(before)), Err(Some(201)));
    let u = ccx(&cube(after)).unwrap_or_else(|code| panic!("ccx ends with {code:?}:\n{after}"));
    assert_eq!(u.len(), 8);
    // ccx prints seven digits.
    assert!(u[4..].iter().all(|u| (u[0] - 0.01).abs() < 1e-8), "{u:?}");
    assert!(u[5][1] > 1e-4, "the load moves node 6: {u:?}");
}

/// What `pkg-config` says; headers of the package are system headers, so that their own warnings are no errors.
fn package(name: &str) -> Vec<String> {
    let found =
        std::process::Command::new("pkg-config").args(["--cflags", "--libs", name]).output().expect("pkg-config");
    assert!(found.status.success(), "{name}: install what scripts/install names");
    String::from_utf8_lossy(&found.stdout).split_whitespace().map(|flag| flag.replace("-I", "-isystem")).collect()
}

/// Each program compares with multipliers or checks equilibrium to 1e-10; PETSC prints the same on one and on four ranks.
#[test]
fn eigen_and_petsc_solve_the_same_condensed_matrix() {
    let flags = package("eigen3");
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/c/eigen.cpp");
    let eigen = output(&build("c++", &["-std=c++17"], source, &borrowed(&flags)), "");
    assert!(eigen.contains(" masters, |u| = "), "{eigen}");
    let flags = package("petsc");
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/c/petsc.c");
    let program = build("mpicc", &["-std=c11"], source, &borrowed(&flags));
    for ranks in [1, 4] {
        assert_eq!(on_ranks(&[], &program, ranks), eigen, "{ranks} ranks");
    }
}

/// A program with ranks; without `mpicc`, which `scripts/install` installs, the test fails.
fn with_mpi(name: &str) -> support::Program {
    let source = format!("{}/tests/c/{name}.c", env!("CARGO_MANIFEST_DIR"));
    build("mpicc", &["-std=c11"], &source, &["-pedantic"])
}

#[test]
fn the_example_on_ranks_prints_what_its_page_says() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/c.md");
    let page = std::fs::read_to_string(page).expect("the page");
    assert!(page.contains(include_str!("c/ranks_example.c")), "docs/c.md has another example");
    let program = with_mpi("ranks_example");
    for ranks in [1, 3] {
        // The last equation of the ring repeats the others.
        let (rank, equations) = (2 * ranks - 1, 2 * ranks);
        let line = format!("rank {rank} of {equations} equations; u = 3 at the last DOF\n");
        assert_eq!(on_ranks(&[], &program, ranks), line);
    }
}

/// The lines of the program that begin with this word, sorted, without the word.
fn lines_of(text: &str, word: &str) -> Vec<String> {
    let mut lines: Vec<String> = text.lines().filter_map(|line| line.strip_prefix(word)).map(str::to_owned).collect();
    lines.sort();
    lines
}

#[test]
fn ranks_find_what_one_process_finds() {
    let program = with_mpi("ranks");
    for ranks in [1, 3, 4] {
        let text = on_ranks(&[], &program, ranks);
        let (serial, distributed) = (lines_of(&text, "serial: "), lines_of(&text, "ranks: "));
        // 31 kinds and 28 slaves; T and G are printed to the last bit.
        assert_eq!(serial.len(), 59, "{text}");
        assert_eq!(distributed, serial, "{ranks} ranks");
    }
}

/// Open MPI leaks and sends bytes that nobody wrote, but not through functions of the library.
#[test]
fn ranks_leak_nothing_and_read_what_is_theirs() {
    let valgrind = ["valgrind", "--quiet", "--log-fd=1", "--leak-check=full", "--show-leak-kinds=definite"];
    let text = on_ranks(&valgrind, &with_mpi("ranks"), 2);
    let reports: Vec<&str> = text.lines().filter(|line| line.starts_with("==") && line.contains("qless")).collect();
    assert!(reports.is_empty(), "{text}");
    assert_eq!(lines_of(&text, "serial: "), lines_of(&text, "ranks: "));
}

fn borrowed(flags: &[String]) -> Vec<&str> {
    flags.iter().map(String::as_str).collect()
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
    text + &condensed(&elimination, base)
}

/// K as the program makes it.
fn condensed(elimination: &Elimination, base: usize) -> String {
    let n = elimination.dofs();
    let starts: Vec<usize> = (0..=n).map(|i| 2 * i).collect();
    let index: Vec<u32> = (0..n as u32).flat_map(|i| [i, (i + 1).min(n as u32 - 1)]).collect();
    let k: Vec<f64> = (0..n).flat_map(|i| [2.0 + i as f64, -1.0]).collect();
    let f: Vec<f64> = (0..n).map(|i| i as f64).collect();
    let pattern = elimination.condensed(View::rows(&starts, &index), PrescribedDofs::Eliminated).expect("a pattern");
    let (mut k_q, mut f_q) = (vec![0.0; pattern.nnz()], vec![0.0; pattern.unknowns()]);
    pattern.condense_into(elimination, &k, &f, &mut k_q, &mut f_q).expect("finite");
    let wide = |list: &[u32]| list.iter().map(|&k| k as usize).collect::<Vec<_>>();
    integers("lines", wide(pattern.starts()).into_iter(), base)
        + &integers("index", wide(pattern.index()).into_iter(), base)
        + &integers("unknowns", pattern.dofs().iter().copied(), base)
        + &numbers("K_q", &k_q)
        + &numbers("f_q", &f_q)
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
