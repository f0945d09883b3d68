//! The first cards determine the format of an input, for any name, compression and encoding; an unknown format is an error.

use std::fs;
use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::harness::{HEADER, Place};

const CALCULIX: &str = "** a deck\n*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*EQUATION\n2\n1,1,1.,2,1,-1.\n2\n2,1,2.,1,1,-2.\n";
const NASTRAN: &str =
    "SOL 101\nCEND\nMPC = 1\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nMPC,1,1,1,1.,2,1,-1.\nENDDATA\n";
const LS_DYNA: &str = "*KEYWORD\n*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*CONSTRAINED_LINEAR_GLOBAL\n4\n1,1,1.\n2,1,-1.\n*END\n";
const RADIOSS: &str = "#RADIOSS STARTER\n/BEGIN\nlink\n      2019         0\n/NODE\n\
                       \x20        1                  0.                  0.                  0.\n\
                       \x20        2                  1.                  0.                  0.\n\
                       /MPC/4\nequal\n         1         1         0                  1.\n\
                       \x20        2         1         0                 -1.\n/END\n";
const ANSYS: &str = "/PREP7\nN,1,0,0,0\nN,2,1,0,0\nCE,1,0,1,UX,1,2,UX,-1\n";

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).expect("packed");
    encoder.finish().expect("packed")
}

fn utf16(text: &str, mark: [u8; 2], unit: fn(u16) -> [u8; 2]) -> Vec<u8> {
    mark.into_iter().chain(text.encode_utf16().flat_map(unit)).collect()
}

#[test]
fn the_first_cards_decide_and_not_the_ending() {
    let place = Place::new();
    let matrix = format!("{HEADER}1 2 2\n1 1 1\n1 2 -1\n");
    let relations = "# relations\na - b = 0\n";
    for (text, solver) in [
        (CALCULIX, Some("ccx")),
        (NASTRAN, Some("nastran")),
        (ANSYS, Some("ansys")),
        (LS_DYNA, Some("lsdyna")),
        (RADIOSS, Some("radioss")),
        (&matrix, None),
        (relations, None),
    ] {
        for name in ["a.inp", "a.dat", "a.bdf", "a.cdb", "a.mtx", "a.key", "a.txt", "a"] {
            place.file(name, text);
            let run = place.run(&format!("check -q {name} --format json"));
            assert_eq!(run.code, 0, "{name}: {}", run.err);
            assert_eq!(run.json()["solver"]["name"].as_str(), solver, "{name}");
            assert!(run.json()["input"]["rows"].as_u64() > Some(0), "{name}");
        }
    }
}

#[test]
fn encodings_and_standard_input_make_no_difference() {
    let place = Place::new();
    let crlf = CALCULIX.replace('\n', "\r\n");
    let little = utf16(&crlf, [0xff, 0xfe], u16::to_le_bytes);
    let texts = [
        CALCULIX.as_bytes().to_vec(),
        packed(CALCULIX.as_bytes()),
        utf16(CALCULIX, [0xfe, 0xff], u16::to_be_bytes),
        packed(&little),
        little,
        CALCULIX.replace('\n', "\r").into_bytes(),
        format!("\u{feff}{CALCULIX}").into_bytes(),
    ];
    for (k, text) in texts.iter().enumerate() {
        place.file("deck.inp", text);
        for run in [place.run("check -q deck.inp"), place.run_fed("check -q -", text)] {
            assert_eq!(run.code, 0, "{k}: {}", run.err);
            // Line numbers are those of an editor.
            assert!(
                run.out.contains("\"line 8 *EQUATION 2:1\" = -2 * row 1 \"line 6 *EQUATION 1:1\""),
                "{k}: {}",
                run.out
            );
        }
    }
    let matrix = format!("{HEADER}2 2 2\n1 1 1\n2 1 2\n");
    for text in [matrix.as_bytes().to_vec(), packed(matrix.as_bytes())] {
        place.file("C.mtx.gz", &text);
        assert!(place.run("check -q C.mtx.gz").out.contains("1 of 2 equations is redundant"));
        assert!(place.run_fed("check -q -", &text).out.contains("1 of 2 equations is redundant"));
    }
    // Prescribed values together with a matrix from standard input.
    place.file("given.txt", "1 1\n");
    assert_eq!(place.run_fed("check -q - --prescribed given.txt", matrix.as_bytes()).code, 1);
}

#[test]
fn a_cleaned_deck_is_plain_text() {
    let place = Place::new();
    place.file("plain.inp", CALCULIX).file("sound.bdf", utf16(NASTRAN, [0xff, 0xfe], u16::to_le_bytes));
    place.file("packed.inp.gz", packed(CALCULIX.as_bytes())).file("deck.dat", ANSYS);
    assert_eq!(place.run("clean -q plain.inp -o expected.inp").code, 0);
    let expected = fs::read_to_string(place.path("expected.inp")).expect("written");
    let run = place.run("clean -q packed.inp.gz -o unpacked.inp");
    assert_eq!((run.code, fs::read_to_string(place.path("unpacked.inp")).expect("written")), (0, expected.clone()));
    assert_eq!(place.run_fed("clean -q - -o fed.inp", CALCULIX.as_bytes()).code, 0);
    assert_eq!(fs::read_to_string(place.path("fed.inp")).expect("written"), expected);
    // In place and without a change: the output is the decoded text.
    assert_eq!(place.run("clean -q sound.bdf -o sound.bdf").code, 0);
    assert_eq!(fs::read_to_string(place.path("sound.bdf")).expect("written"), NASTRAN);
    // By its content it is a deck of ANSYS.
    assert_eq!(place.run("clean -q deck.dat -o other.dat").code, 0);
    assert_eq!(place.run("clean -q deck.dat -o other.cdb").code, 0);
    for (arguments, part) in [
        ("clean -q packed.inp.gz -o again.inp.gz", "leave out the ending .gz"),
        ("clean -q deck.dat -o other.bdf", "a deck of ANSYS; give it the same ending"),
    ] {
        let run = place.run(arguments);
        assert!(run.code == 2 && run.err.contains(part), "{arguments}: {}", run.err);
    }
}

#[test]
fn what_is_nothing_known_says_what_was_seen() {
    let place = Place::new();
    let noise: Vec<u8> = (0..5000_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    for (bytes, part) in [
        (&b""[..], "it is empty"),
        (b"\n \n", "it is empty"),
        (b"<html><body>*NODE</body></html>", "an HTML page"),
        (&noise, "starts with the bytes"),
        (b"Dear all,\nhere is the deck.\n", "line 1 is `Dear all,`"),
        (b"** comments\n** alone\n", "line 1 is `** comments`"),
        (b"#RADIOSS ENGINE\n/RUN/link/1\n", "an engine file of Radioss"),
        (&utf16(CALCULIX, *b"**", u16::to_le_bytes), "zero bytes, as in UTF-16"),
        (b"\xff\xfe*\0N", "ends within a character"),
        (&packed(CALCULIX.as_bytes())[..40], "gzip data, which are damaged"),
    ] {
        for name in ["a.inp", "a.dat", "a.cdb", "a"] {
            place.file(name, bytes);
            for command in ["check -q", "reduce -q -o out", "clean -q -o out.inp"] {
                let run = place.run(&format!("{command} {name}"));
                assert_eq!((run.code, run.out.as_str()), (2, ""), "{name}: {part}");
                assert!(run.err.contains(part) && run.err.contains(name), "{name}: {}", run.err);
                assert!(!run.err.chars().any(|c| c.is_control() && c != '\n'), "{}", run.err);
            }
        }
        assert!(place.run_fed("check -q -", bytes).err.contains(part));
    }
    assert!(!place.path("out").exists() && !place.path("out.inp").exists());
}

#[test]
fn a_bomb_is_left_unread() {
    let place = Place::new();
    let line = [&[b'*'; 1023][..], b"\n"].concat();
    place.file("bomb.inp", packed(&line.repeat(80 << 10)));
    let run = place.run("check -q bomb.inp");
    assert_eq!(run.code, 3, "{}", run.err);
    assert!(run.err.contains("unpack to more than"), "{}", run.err);
}

#[test]
fn a_solver_reads_its_own_format() {
    let place = Place::new();
    place.file("a.inp", CALCULIX).file("a.bdf", NASTRAN).file("a.cdb", ANSYS).file("a.k", LS_DYNA).paper("case", 1.0);
    place.file("a_0000.rad", RADIOSS);
    for (deck, solvers) in [
        ("a.inp", &["ccx", "abaqus"][..]),
        ("a.bdf", &["nastran", "mystran", "optistruct"]),
        ("a.cdb", &["ansys"]),
        ("a.k", &["lsdyna"]),
        ("a_0000.rad", &["radioss"]),
    ] {
        for solver in ["ccx", "abaqus", "nastran", "mystran", "optistruct", "ansys", "lsdyna", "radioss"] {
            let run = place.run(&format!("check -q {deck} --format json --solver {solver}"));
            if solvers.contains(&solver) {
                assert_eq!((run.code, run.json()["solver"]["name"].as_str()), (0, Some(solver)));
            } else {
                assert_eq!(run.code, 2, "{deck} {solver}");
                let names = solvers.join(" or ");
                assert!(
                    run.err.contains(&format!("{solver} does not read it")) && run.err.contains(&names),
                    "{}",
                    run.err
                );
            }
        }
    }
    place.file("ties.rel", "a - b = 0\n");
    for (arguments, parts) in [
        ("check a.inp --solver ansis", ["`ansis` is not a known solver", "mystran"]),
        ("check case --solver ccx", ["case", "--solver and --case need a deck"]),
        ("check case --case 1", ["case", "--solver and --case need a deck"]),
        ("check ties.rel --solver ccx", ["ties.rel", "--solver and --case need a deck"]),
        ("check ties.rel --rhs b.txt", ["ties.rel", "relations have their own values; leave out --rhs"]),
        ("clean ties.rel -o out.rel", ["ties.rel", "for a matrix or relations use `qless reduce`"]),
        ("clean a.k -o b.k", ["a.k", "decks of LS-DYNA are read, but not written"]),
        ("clean a_0000.rad -o b.rad", ["a_0000.rad", "decks of Radioss are read, but not written"]),
    ] {
        let run = place.run(arguments);
        assert!(run.code == 2 && parts.iter().all(|part| run.err.contains(part)), "{arguments}: {}", run.err);
    }
    // A card of two languages: the option --solver decides.
    place.file("tie.txt", "RBE3,1,,1,123,1.,123,2\n");
    assert_eq!(place.run("check -q tie.txt").code, 2);
    assert_ne!(place.run("check -q tie.txt --solver nastran").err, place.run("check -q tie.txt --solver ansys").err);
}

#[test]
fn a_deck_without_equations_is_no_mistake() {
    let place = Place::new();
    place.file("plain.inp", "*NODE\n1,0.,0.,0.\n*BOUNDARY\n1,1,3\n*STEP\n*STATIC\n*END STEP\n");
    place.case("case", [0, 1], &[], &[], &[]);
    let run = place.run("check -q plain.inp");
    assert_eq!(run.code, 0);
    assert!(
        run.out.starts_with("The deck has no equations between DOFs, so there is nothing to find.\n"),
        "{}",
        run.out
    );
    assert!(run.out.ends_with("Next: nothing to mend.\n") && !run.out.contains("exported"), "{}", run.out);
    assert!(place.run("check -q case").out.contains("check that the equations were exported"));
}

/// Labels and names of relations are those of every report.
#[test]
fn relations_keep_their_names() {
    let place = Place::new();
    place.file(
        "ties.rel",
        "# a loop of ties\ntie_1: 1.0 N12.DX - 1.0 N13.DX = 0.5\ntie_2: 1.0 N13.DX - 1.0 N14.DX = 0\n\
         tie_3: 2.0 N12.DX - 2.0 N14.DX = 3\nN14.DX = 0\n",
    );
    let run = place.run("check -q ties.rel");
    assert_eq!(run.code, 1, "{}", run.err);
    let because = "row 3 \"tie_3\" = 2 * row 1 \"tie_1\" + 2 * row 2 \"tie_2\"";
    assert!(run.out.contains(because), "{}", run.out);
    let report = place.run("check -q ties.rel --format json").json();
    assert!(report["status"] == "conflicting" && report.to_string().contains("N12.DX"), "{report}");
    let why = place.run("explain -q ties.rel N13.DX");
    assert!(why.out.contains("N13.DX") && why.out.contains("tie_"), "{}{}", why.out, why.err);
    place.file(
        "sound.rel",
        "tie_1: 1.0 N12.DX - 1.0 N13.DX = 0.5\ntie_2: 1.0 N13.DX - 1.0 N14.DX = 0\nN15.DX - N14.DX = 0\n",
    );
    assert_eq!(place.run("reduce -q sound.rel -o out --prefer-slaves N12.DX,N13.DX").code, 0);
    let slaves = fs::read_to_string(place.path("out/slaves.txt")).expect("written");
    assert_eq!(slaves.lines().filter(|line| !line.starts_with('#')).count(), 3, "{slaves}");
    assert_eq!(place.run("diff -q sound.rel sound.rel").code, 0);
    assert!(place.run_fed("check -q -", b"# relations\na = b\n").err.contains(":2:5: expected a number, found `b`"));
}
