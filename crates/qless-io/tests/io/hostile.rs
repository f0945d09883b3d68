//! A few bytes cannot be multiplied to much time or memory, and a fault is said of its own line.

use std::path::Path;

use qless_io::deck::{self, DeckError, Format, Problem};

fn refused(format: Format, text: &str) -> DeckError {
    let mut none = |_: &Path| Err(std::io::ErrorKind::NotFound.into());
    match deck::parse(format, Path::new("deck"), text.as_bytes().to_vec(), &mut none) {
        Err(error) => error,
        Ok(deck) => panic!("{} equations were read of {}", deck.model().equations(), &text[..text.len().min(80)]),
    }
}

#[test]
fn what_a_deck_multiplies_has_limits() {
    let grid = "BEGIN BULK\nGRID,1,,0.,0.,0.\n=,*1,=,*1.,==\n";
    let many_lines = "=(9999)\n".repeat(200);
    let node = "*NODE\n1,0.,0.,0.\n";
    for (format, text) in [
        (Format::Nastran, format!("{grid}=99999999\nENDDATA\n")),
        (Format::Nastran, format!("{grid}{many_lines}ENDDATA\n")),
        (Format::Calculix, format!("{node}*NSET,NSET=A,GENERATE\n1,4000000000\n*BOUNDARY\nA,1\n")),
        (Format::Ansys, "*DO,I,1,1e18\n*ENDDO\n".into()),
        (Format::Ansys, "N,1\nN,2\n*DO,I,1,1e18\nCE,I,0,1,UX,1,2,UX,-1\n*ENDDO\n".into()),
    ] {
        let error = refused(format, &text);
        assert!(matches!(error.problem, Problem::Limit { .. }), "{error}");
        assert!(error.line > 0, "{error}");
    }
}

#[test]
fn a_node_that_is_none_is_refused_at_its_own_line() {
    let body = "*NSET,NSET=R\n1,2\n*RIGID BODY,NSET=R,REF NODE=3\n*BOUNDARY\n3,1\n";
    for (line, field) in [
        ("2,abc,0.,0.", Some(2)),
        ("2,0.,nan,0.", Some(3)),
        ("2,0.,0.,inf", Some(4)),
        ("x2,0.,0.,0.", Some(1)),
        ("2,0.,1e999,0.", Some(3)),
        ("-2,0.,0.,0.", Some(1)),
    ] {
        for after in [body, "*EQUATION\n2\n1,1,1.,2,1,-1.\n", ""] {
            let error = refused(Format::Calculix, &format!("*NODE\n1,0.,0.,0.\n{line}\n3,1.,1.,1.\n{after}"));
            assert_eq!((error.line, error.field, error.card.as_str()), (3, field, "*NODE"), "{error}");
        }
    }
}
