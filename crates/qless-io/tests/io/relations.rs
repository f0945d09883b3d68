//! Named relations: what is read, and where faults are.

use std::fmt::Write;
use std::path::Path;

use qless::{ConstraintSystem, Kind, Options, analyse};
use qless_io::{FileContent, Opened, ReadError, read_case};
use qless_scenes::Rng;

fn read(name: &str, text: &str) -> Result<ConstraintSystem, ReadError> {
    let place = tempfile::tempdir().expect("a temporary folder");
    let path = place.path().join(name);
    std::fs::write(&path, text).expect("written");
    read_case(&path, None, None)
}

/// The rows of a system in words.
fn words(system: &ConstraintSystem) -> Vec<String> {
    let term = |(j, a): (usize, f64)| format!("{a} {}", system.dof_label(j));
    let row = |i: usize| system.matrix().row(i).map(term).collect::<Vec<_>>().join(" ");
    (0..system.equations()).map(|i| format!("{}: {} = {}", system.equation_label(i), row(i), system.rhs()[i])).collect()
}

#[test]
fn every_form_of_a_relation() {
    let text = "# relations\n\ntie_1: 1.0 N12.DX - 1.0 N13.DX = 0.5 # a gap\r\n2 N13.DX + N14.DX = 0\n\
                line 7 *EQUATION 6:3: -1.5D0 * 6:3 -2 7:3 + -1 8:3 = -.5\nfix: 1 N12.DY = 3\nN12.DY = 0\nsupport: N14.DX = 2\n% end\n";
    for (name, text) in
        [("a.rel", text.to_owned()), ("a.txt", text.to_owned()), ("a.REL", text.replace("# relations\n", "\n"))]
    {
        let system = read(name, &text).expect(name);
        assert_eq!(
            words(&system),
            [
                "tie_1: 1 N12.DX -1 N13.DX = 0.5",
                "line 4: 2 N13.DX 1 N14.DX = 0",
                "line 7 *EQUATION 6:3: -1.5 6:3 -2 7:3 -1 8:3 = -0.5",
                "fix: 1 N12.DY = 3"
            ]
        );
        let given: Vec<_> = system.prescribed().iter().map(|&(j, value)| (system.dof_label(j), value)).collect();
        assert_eq!(given, [("N14.DX".to_owned(), 2.0), ("N12.DY".to_owned(), 0.0)]);
        let places =
            system.prescribed().iter().map(|&(j, _)| system.prescribed_place(j).unwrap_or_default().to_owned());
        assert_eq!(places.collect::<Vec<_>>(), ["support", "line 7"]);
    }
}

#[test]
fn contradicting_values_conflict_and_equal_ones_do_not() {
    let system = read("a.rel", "a = 1\nb: a = 1\nc: a = 2\na - d = 0\n").expect("read");
    let analysis = analyse(&system, &Options::default()).expect("an analysis");
    assert_eq!(words(&system), ["c: 1 a = 2", "line 4: 1 a -1 d = 0"]);
    assert_eq!(
        analysis.dependent().iter().map(|one| (one.row, one.kind)).collect::<Vec<_>>(),
        [(0, Kind::Conflicting)]
    );
}

#[test]
fn faults_name_line_and_column() {
    for (text, part) in [
        ("a - b 0\n", "a.rel:1:7: expected `+`, `-` or `=`, with blanks around it, found `0`"),
        ("a - b\n", "a.rel:1:6: expected `+`, `-` or `=`, with blanks around it, found nothing"),
        ("\n  1 a + = 0\n", "a.rel:2:9: expected the name of a DOF, found `=`"),
        ("x: 1.0 = 0\n", "a.rel:1:8: expected the name of a DOF, found `=`"),
        ("x: = 0\n", "a.rel:1:4: expected `+`, `-`, `*`, a number or the name of a DOF, found `=`"),
        ("x:\n", "a.rel:1:3: expected `+`, `-`, `*`, a number or the name of a DOF, found nothing"),
        ("2*a - b = 0\n", "a.rel:1:1: expected `+`, `-`, `*`, a number or the name of a DOF, found `2*a`"),
        ("a -b = 0\n", "a.rel:1:3: expected the name of a DOF, found `-b`"),
        ("a = b\n", "a.rel:1:5: expected a number, found `b`"),
        ("a =\n", "a.rel:1:4: expected a number, found nothing"),
        ("a = 1 2\n", "a.rel:1:7: expected the end of the relation, found `2`"),
        ("1e999 a = 1\n", "a.rel:1:1: `1e999` is no usable number: too large"),
        ("a b = nan\n", "a.rel:1:3: expected `+`, `-` or `=`"),
        ("a = nan\n", "a.rel:1:5: `nan` is no usable number: every number must be finite"),
        ("# only a comment\n", "a.rel: there is no relation; write one a line"),
    ] {
        let error = read("a.rel", text).expect_err(text).to_string();
        assert!(error.contains(part), "{text}{error}");
    }
    assert!(read("a.rel", "1e308 a + 1e308 a = 0\n").expect_err("overflow").to_string().contains("a.rel: "));
}

#[test]
fn relations_have_their_own_values_and_are_no_deck() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let path = place.path().join("a.rel");
    std::fs::write(&path, "a - b = 0\n").expect("written");
    let opened = || Opened::read(&path, None).expect("opened");
    assert_eq!(opened().content(), FileContent::Relations);
    let error = opened().into_case(Some(Path::new("b.txt")), None).expect_err("two right-hand sides").to_string();
    assert!(error.ends_with("relations have their own values; leave out --rhs and --prescribed"), "{error}");
    assert!(
        opened()
            .into_deck(None)
            .expect_err("no deck")
            .to_string()
            .ends_with("it is a matrix or a list of relations; name a deck")
    );
}

/// A system written as relations is the system: labels, coefficients to the last bit, right-hand sides and values.
#[test]
fn written_and_read_again_a_system_is_the_same() {
    let mut rng = Rng::new(17);
    for seed in 0..2000 {
        let (rows, dofs) = (1 + rng.below(6), 2 + rng.below(6));
        let number = |rng: &mut Rng| (rng.below(2001) as f64 - 1000.5) * 10_f64.powi(rng.below(12) as i32 - 6) / 7.0;
        let mut builder = qless::SystemBuilder::new(dofs);
        let mut text = String::new();
        // Names in the order in which they occur, which is that of their columns.
        let every: Vec<String> = (0..dofs).map(|j| format!("1 N{j}.D-{j}")).collect();
        writeln!(text, "all: {} = 0", every.join(" + ")).expect("a string");
        builder.labelled_equation("all", (0..dofs).map(|j| (j, 1.0)), 0.0);
        for i in 0..rows {
            let terms: Vec<(usize, f64)> = (0..=rng.below(4)).map(|_| (rng.below(dofs), number(&mut rng))).collect();
            let rhs = number(&mut rng);
            let sign = ["+ ", ""][rng.below(2)];
            let words: Vec<String> = terms.iter().map(|(j, a)| format!("{a:+e} N{j}.D-{j}")).collect();
            writeln!(text, "row_{i}: {sign}{} = {rhs}", words.join(" ")).expect("a string");
            builder.labelled_equation(format!("row_{i}"), terms, rhs);
        }
        for j in (0..dofs).filter(|j| j % 3 == seed % 3) {
            let value = number(&mut rng);
            writeln!(text, "N{j}.D-{j} = {value}").expect("a string");
            builder.prescribe_at(format!("line {}", text.lines().count()), j, value);
        }
        builder.dof_labels((0..dofs).map(|j| format!("N{j}.D-{j}")).collect());
        let expected = builder.build().expect("a system");
        assert_eq!(read("a.rel", &text).unwrap_or_else(|error| panic!("{error}\n{text}")), expected, "{text}");
    }
}
