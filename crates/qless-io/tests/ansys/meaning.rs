//! What the commands mean.

use crate::parse::{deck, equations, prescribed, warnings};

#[test]
fn equations_as_commands() {
    // The manual's own example of a command: 0 = UY(3) - UY(1) - 10 ROTZ(2).
    let model = deck("CE,1,0,3,UY,1,1,UY,-1,2,ROTZ,-10\nce,next,2.5,4,ux,1.0D0 $ CE,HIGH,,5,Temp,-2 ! more\n");
    assert_eq!(equations(&model), ["3:2 1, 1:2 -1, 2:6 -10 = 0", "4:1 1, 5:11 -2 = 2.5"]);
    assert_eq!(
        (model.model().label(0).expect("an equation"), model.model().label(1).expect("an equation")),
        ("line 1 CE 1 3:2".into(), "line 2 CE 2 4:1".into())
    );
    assert!(warnings(&model).is_empty());
}

#[test]
fn commands_change_equations() {
    let terms = "CE,7,1,1,UX,1,2,UX,0,3,UX,2\nCE,7,,-3,UX\nCE,7,,4,UX,-1\n";
    assert_eq!(equations(&deck(terms)), ["1:1 1, 4:1 -1 = 1"]);
    assert_eq!(equations(&deck(&format!("{terms}CE,7,3\n"))), ["1:1 1, 4:1 -1 = 3"]);
    assert_eq!(equations(&deck(&format!("{terms}CECMOD,7,4\n"))), ["1:1 1, 4:1 -1 = 4"]);
    let more = "CE,8,,1,UY,1\nCE,9,,1,UZ,1\nCE,10,,2,UZ,1\n";
    assert_eq!(equations(&deck(&format!("{terms}{more}CEDELE,7,9,2\n"))), ["1:2 1 = 0", "2:3 1 = 0"]);
    assert!(equations(&deck(&format!("{terms}{more}CEDELE,ALL\n"))).is_empty());
}

#[test]
fn equations_of_an_archive() {
    let text = "CE,R5.0,DEFI,       3,       1,  0.50000000    \n\
                CE,R5.0,NODE,      1700,UX  ,  1.00000000    ,      1700,UZ  , -1.00000000    \n\
                CE,R5.0,NODE,         9,ROTY,  0.25000000    ,         0,    ,  0.00000000    \n\
                CE,R5.0,DEFI,       1,       2,  0.00000000    \n\
                CE,R5.0,NODE,      1700,UX  ,  1.00000000    \n\
                CECMOD,      1,  0.75000000    \n";
    let deck = deck(text);
    assert_eq!(equations(&deck), ["1700:1 1, 1700:3 -1, 9:5 0.25 = 0.75", "1700:1 1 = 0"]);
    assert_eq!(
        (
            deck.model().equation(0).expect("an equation").origin.line,
            deck.model().equation(0).expect("an equation").origin.lines
        ),
        (1, 3)
    );
}

#[test]
fn later_releases_have_another_tag() {
    let text = "N,UNBL,LOC,1,,,0.,0.,0.\nN,UNBL,LOC,2\nN,UNBL,ANG,2,,,0.,30.\nN,UNBL,LOC,       -1,\n\
        CE,UNBL,DEFI,2,1,0\nCE,UNBL,NODE,1,UX,1,2,UX,-1\nCP,UNBL,2,3,UY,1,2\n";
    let deck = deck(text);
    assert_eq!(equations(&deck), ["1:1 1, 2:1 -1 = 0", "2:2 1, 1:2 -1 = 0"]);
    assert_eq!(warnings(&deck), ["0: nodes with rotated axes, such as 2, are constrained along these axes"]);
}

#[test]
fn coupled_sets() {
    let text = "CP,1,UX,5,3,-5,9\nCP,HIGH,,11\nCP,NEXT,TEMP,1,2\nCP,9,UY,1,2\nCPDELE,9\n";
    assert_eq!(equations(&deck(text)), ["9:1 1, 3:1 -1 = 0", "11:1 1, 3:1 -1 = 0", "2:11 1, 1:11 -1 = 0"]);
    // The number of a set that is left out is used up.
    let left_out = "CP,1,UX,1,2\nCP,5,ALL,3,4\nCP,NEXT,UY,5,6\nCP,6,,7\n";
    assert_eq!(equations(&deck(left_out)), ["2:1 1, 1:1 -1 = 0", "6:2 1, 5:2 -1 = 0", "7:2 1, 5:2 -1 = 0"]);
    let archive = "CP,R5.0,       3,       4,ROTZ,         1,         2\nCP,R5.0,       3,       4,ROTZ,         7\n";
    assert_eq!(equations(&deck(archive)), ["2:6 1, 1:6 -1 = 0", "7:6 1, 1:6 -1 = 0"]);
}

#[test]
fn values_of_nodes() {
    let values = |text: &str| prescribed(&deck(text), 0);
    assert_eq!(values("D,5,UX\nD, 6,ROTZ,  0.7853    ,  0.0\n"), ["5:1 0", "6:6 0.7853"]);
    // The last one counts.
    assert_eq!(values("D,5,UX,1 $ D,5,UX,2\n"), ["5:1 2"]);
    assert_eq!(values("D,5,UX,3,,,,UY,TEMP\nDDELE,5,UY\n"), ["5:1 3", "5:11 3"]);
    let nodes = "N,1\nN,2\nN,3\nN,4\nN,5\n";
    assert_eq!(values(&format!("{nodes}D,1,UX,3,,5,2\nDDELE,3,ALL\n")), ["1:1 3", "5:1 3"]);
    assert_eq!(values(&format!("{nodes}D,1,UX,3,,5,2\nD,1,UY\nDDELE,1\n")), ["3:1 3", "5:1 3"]);
    let equation = "CE,1,0,1,UX,1,2,UZ,1\n";
    assert_eq!(values(&format!("{nodes}{equation}D,2,ALL\nD,ALL,UY,1\n"))[..3], ["1:2 1", "2:1 0", "2:2 1"]);
    let group = "CMBLOCK,ENDS,NODE,       3 ! two ends\n(8i10)\n         1         3        -4\n";
    assert_eq!(values(&format!("{nodes}{group}D,ends,UX\n")), ["1:1 0", "3:1 0", "4:1 0"]);
}

#[test]
fn selections_of_all() {
    let two = "NSEL,S,NODE,,2\n";
    for (selection, expected) in [
        ("NSEL,S,NODE,,ALL\n", &["1:1 0", "2:1 0", "3:1 0"][..]),
        ("NSEL,A,,,ALL\n", &["1:1 0", "2:1 0", "3:1 0"]),
        ("NSEL,ALL\n", &["1:1 0", "2:1 0", "3:1 0"]),
        ("NSEL,R,NODE,,ALL\n", &["2:1 0"]),
        ("ESEL,ALL\n", &["2:1 0"]),
        ("CM,A,NODE\nNSEL,S,NODE,,3\nCMSEL,ALL\n", &["2:1 0", "3:1 0"]),
        // Groups of elements leave the selected nodes alone.
        ("CM,E,ELEM\nCMSEL,S,E\n", &["2:1 0"]),
        ("CMBLOCK,E,ELEM,1\n(8i10)\n         3\nCMSEL,S,E\n", &["2:1 0"]),
    ] {
        let deck = deck(&format!("/CLEAR\nN,1\nN,2\nN,3\nNUMMRG,ELEM\n{two}{selection}D,ALL,UX\n"));
        assert_eq!(
            (prescribed(&deck, 0), warnings(&deck)),
            (expected.iter().map(|&one| one.into()).collect(), vec![]),
            "{selection}"
        );
    }
    for lost in ["RESUME,a,db\n", "CDREAD,DB,a,cdb\n"] {
        assert_eq!(deck(lost).model().left_out().count(), 1, "{lost}");
    }
    // A file that is not read may define what a command names. Without one, the name is wrong.
    assert!(crate::parse::try_deck("NGEN,2,1,1\nD,END,UX\n").is_err());
    assert_eq!(deck("CDREAD,DB,a,cdb\nD,END,UX\n").model().left_out().count(), 2);
    // A model that replaces another matters if something is constrained or solved after it.
    for (after, left_out) in [
        ("", 0),
        ("/POST1\nPLNSOL,U\n", 0),
        ("SOLVE\n", 1),
        ("LSSOLVE,1,1\n", 1),
        ("D,1,UX,1\n", 1),
        ("CP,1,UX,1,2\n", 1),
    ] {
        for replaced in ["RESUME,TABLE", "CDREAD,DB,a,cdb"] {
            let deck = deck(&format!("N,1\nN,2\nCE,1,0,1,UX,1,2,UX,1\nSOLVE\n{replaced}\n{after}"));
            // RESUME begins a model, so LSSOLVE solves load steps of another one.
            let count = if replaced.starts_with("RESUME") && after.starts_with("LSSOLVE") { 2 } else { 1 };
            let found = (deck.model().left_out().count(), warnings(&deck).len());
            assert_eq!(found, (left_out * count, count), "{replaced}, {after}");
        }
    }
    // Values of unknown nodes matter where there are equations.
    let archived = "CE,R5.0,DEFI,1,1,0.0\nCE,R5.0,NODE,1,UX,1.0\n";
    for (equation, left_out) in
        [("", 0), ("CE,1,0,1,UX,1,2,UX,1\n", 8), (archived, 8), ("CP,1,UX,1,2\n", 8), ("CEINTF\n", 9)]
    {
        let unknown = "NSEL,S,LOC,X,0\nD,ALL,UX\nDSYM,SYMM,X\nDL,1,,UX\nNUMMRG,NODE\nNUMMRG,ALL\nNUMCMP,NODE\nNDELE,1\n\
            *IF,ARG1,EQ,1,THEN\nSOLVE\n*ENDIF\n";
        let deck = deck(&format!("*GET,ARG1,NODE,,COUNT\nD,1,UX\n{unknown}{equation}"));
        assert_eq!((deck.model().left_out().count(), warnings(&deck).len()), (left_out, left_out.max(8)), "{equation}");
    }
    // A spectrum analysis writes a file of POST1 commands; other files may hold any command.
    for (input, left_out) in [
        ("/POST1\n/INPUT,,MCOM\n", 0),
        ("/POST1\n/input,case1,mcom\n", 0),
        ("/INPUT,,MCOM\n", 1),
        ("/POST1\nFINISH\n/INPUT,,MCOM\n", 1),
        ("/POST1\n/INPUT,CASE1\n", 1),
        ("/POST26\n/INPUT,,MCOM\n", 1),
    ] {
        assert_eq!(deck(&format!("CE,1,0,1,UX,1\nSOLVE\n{input}")).model().left_out().count(), left_out, "{input}");
    }
}

/// A command reaches the nodes that its component has, and that are defined, where the command stands.
#[test]
fn later_definitions_do_not_change_a_command() {
    let values = |text: &str| prescribed(&deck(&format!("N,1\n{text}")), 0);
    let again = "N,2\nNSEL,S,NODE,,1\nCM,G,NODE\nD,G,UX,5\nNSEL,S,NODE,,2\nCM,G,NODE\n";
    assert_eq!(values(again), ["1:1 5"]);
    assert_eq!(
        values("N,2\nCMBLOCK,G,NODE,1\n(8i10)\n         1\nD,G,UX,5\nCMBLOCK,G,NODE,1\n(8i10)\n         2\n"),
        ["1:1 5"]
    );
    assert_eq!(values("D,ALL,UX\nN,2\nCE,1,0,1,UX,1,2,UX,1\n"), ["1:1 0"]);
    assert_eq!(values("D,1,UX,0,,9\nN,2\n"), ["1:1 0"]);
    assert_eq!(values("D,ALL,UX\nN,2\nN,1\nD,ALL,UX,3\n"), ["1:1 3", "2:1 3"]);
    // What is defined is selected.
    assert_eq!(values("N,2\nNSEL,S,NODE,,2\nN,3\nD,ALL,UX\n"), ["2:1 0", "3:1 0"]);
}

#[test]
fn deletions_respect_the_selection() {
    let text = "N,1\nN,2\nN,3\nN,4\nCE,1,0,1,UX,1,2,UX,1\nCE,2,0,2,UX,1,3,UX,1\nCE,3,0,3,UX,1,4,UX,1\nCP,1,UY,1,2\nCP,2,UY,2,3\nCP,3,UY,3,4\n";
    let left = |selection: &str, deletions: &str| {
        let deck = deck(&format!("{text}{selection}\n{deletions}\n"));
        let first = |text: &String| text.chars().next().expect("a node");
        (equations(&deck).iter().map(first).collect::<String>(), deck.model().left_out().count())
    };
    let two = "NSEL,S,NODE,,1,2";
    assert_eq!(left(two, "CEDELE,ALL\nCPDELE,ALL"), ("34".into(), 0));
    assert_eq!(left(two, "CEDELE,ALL,,,ANY\nCPDELE,1,3"), ("34".into(), 0));
    // With `ALL`, only a set that has exactly the selected nodes certainly goes.
    assert_eq!(left(two, "CEDELE,1,,,ALL\nCPDELE,1,,,ALL"), ("2334".into(), 0));
    assert_eq!(left(two, "CEDELE,2,,,ALL\nCPDELE,3,,,ALL"), ("1323".into(), 2));
    assert_eq!(left("ALLSEL", "CPDELE,1,,,ALL"), ("12334".into(), 1));
    assert_eq!(left("NSEL,NONE", "CEDELE,ALL"), ("123234".into(), 0));
    assert_eq!(left("NSEL,S,LOC,X,0", "CEDELE,ALL\nCPDELE,2"), ("24".into(), 2));
    assert_eq!(left("NSEL,S,LOC,X,0\nALLSEL", "CEDELE,ALL\nCPDELE,2"), ("24".into(), 0));
}

#[test]
fn load_steps() {
    let deck = deck("CE,1,0,1,UX,1,2,UX,1\nD,1,UX,1\nF,2,FX,10\nSOLVE\nDDELE,1,UX\nD,2,UX,2\nFDELE,2,ALL\nsolve\n");
    let names: Vec<&str> = deck.model().cases().iter().map(|case| case.name.as_str()).collect();
    assert_eq!(names, ["load step 1", "load step 2"]);
    assert_eq!((prescribed(&deck, 0), prescribed(&deck, 1)), (vec!["1:1 1".into()], vec!["2:1 2".to_owned()]));
    assert_eq!((deck.model().cases()[0].loads.len(), deck.model().cases()[1].loads.len()), (1, 0));
}

#[test]
fn blocks_of_nodes() {
    let text = "/PREP7\nNBLOCK,6,SOLID,         7,         3\n(3i9,6e20.13)\n\
        \u{20}       1        0        0-1.0000000000000E+00 1.0000000000000E+00\n\
        \u{20}       2        0        0\n\
        \u{20}       7        0        0 0.0000000000000E+00 0.0000000000000E+00 0.0000000000000E+00 4.5000000000000E+01\n\
        N,R5.3,LOC,       -1,\n\
        EBLOCK,19,SOLID,         1,         1\n(19i9)\n        1        1        1\n       -1\n";
    let good = deck(&format!("{text}CE,1,0,1,UX,1,7,UX,1\n"));
    assert_eq!(warnings(&good), ["0: nodes with rotated axes, such as 7, are constrained along these axes"]);
    let error = crate::parse::try_deck(&format!("{text}CE,1,0,1,UX,1,3,UX,1\n")).expect_err("no node 3").to_string();
    assert_eq!(error, "deck.cdb:12: CE 1: node 3 is not defined; define it or correct the name");
}

#[test]
fn what_is_not_understood_is_named() {
    for (text, warning) in [
        ("cerig,1,2\n", "1: the equations of the region about node 1 are not known"),
        ("RBE3,1,ALL,SLAVES(1)\n", "1: RBE3 names SLAVES(1), which this reader does not know: left out"),
        ("CEINTF,0.1\n", "1: CEINTF constrains, but this reader does not support it: left out"),
        ("CPINTF,ALL\n", "1: CPINTF constrains"),
        ("CPCYC,ALL\n", "1: CPCYC constrains"),
        ("CYCLIC\n", "1: CYCLIC constrains"),
        ("DSYM,SYMM,X\n", "1: DSYM prescribes or releases values"),
        ("/INPUT,more,inp\n", "1: /INPUT is not followed"),
        ("mymacro,1\n", "1: MYMACRO is not known to this reader"),
        ("CE,1,0,1,UX,1\n*REPEAT,4,1\n", "2: *REPEAT is not followed"),
        (
            "*IF,A,EQ,1,THEN\nCE,1,0,1,UX,1\n*ENDIF\n",
            "2: CE is in *IF, *DO or *CREATE, and it is not known whether it is executed",
        ),
        ("NSEL,S,LOC,X,0\nD,ALL,UX\n", "2: D,ALL,UX names the selected nodes"),
        ("D,1,VELX,1\n", "1: D,1,VELX prescribes a velocity or an acceleration: left out"),
        ("D,1,UX,%TAB%\n", "1: D,1,UX takes its value from the table TAB"),
        ("D,1,UX,0,1\n", "1: the imaginary part of D,1,UX is ignored"),
        ("ET,1,MPC184\n", "1: MPC184 elements constrain"),
        ("ET,1,PRETS179\n", "1: PRETS179 elements constrain"),
        ("ET,3,174\nKEYOP,3,2,2\n", "2: contact elements with KEYOPT(2) = 2"),
        ("ETBLOCK,2,2\n(2i9,19a9)\n        1      184        0\n       -1\n", "3: MPC184 elements constrain"),
        (
            "ETBLOCK,1,1\n(2i9,19a9)\n        1      174        0        2\n       -1\n",
            "3: contact elements with KEYOPT(2)",
        ),
        (
            "CM,ENDS,NODE\nD,ENDS,UX\n",
            "2: D,ENDS,UX names a component of nodes that this reader does not know: left out",
        ),
        ("CE,1,0,1,UX,1,2,UX,1,1,UX,1\n", "1: CE 1 names a DOF more than once: its coefficients are added"),
        ("CP,1,ALL,1,2\n", "1: CP couples all DOFs"),
        ("CP,1,UX,ALL\n", "1: CP couples the nodes ALL"),
        ("CE,1,1,1,UX,1\nCE,1,2,2,UX,1\n", "2: the constant of CE 1 was 1 and becomes 2"),
        ("CECMOD,4,1\n", "1: CECMOD changes CE 4, which is not defined"),
        ("CE,3,0\n", "1: CE 3 has no terms: left out"),
    ] {
        let deck = deck(text);
        let found = warnings(&deck);
        assert!(found.len() == 1 && found[0].starts_with(warning), "{text:?}: {found:?}");
        // What is only said about something that was read, or may be no matter, does not make the model incomplete.
        let only_said = [
            "MYMACRO",
            "table",
            "imaginary",
            "more than once",
            "and becomes",
            "which is not defined",
            "no terms",
            "has no equations",
        ];
        let leaves_out = !only_said.iter().any(|word| found[0].contains(word));
        assert_eq!(deck.model().left_out().count(), usize::from(leaves_out), "{found:?}");
    }
}

#[test]
fn what_is_left_out_beyond_the_warnings_is_not_forgotten() {
    let deck = deck(&("/SOLU\nFOO,1\n".to_owned() + &"D,1,UX,%T%\n".repeat(1000) + "CEINTF\n"));
    assert_eq!(
        deck.model().left_out().map(|warning| warning.text.as_str()).collect::<Vec<_>>(),
        ["and 2 more warnings"]
    );
}

#[test]
fn what_an_archive_holds_besides_is_no_matter() {
    let text = "/COM,ANSYS RELEASE 15.0 $ CERIG,1,2\n/PREP7\n/NOPR\n/TITLE,it's CERIG ! 1\nANTYPE, 0\nNLGEOM, 1\n\
        *IF,_CDRDOFF,EQ,1,THEN     !if solid model was read in\n_CDRDOFF=             !reset\n*ELSE\nNUMOFF,NODE,  9\n*ENDIF\n\
        *SET,_BUTTON ,  1.000000000000\nDOF,DELETE\nET,       1,185\nKEYOP,       1, 6,        1\n\
        TB,HYPE,       1,   1,   3,POLY\nTBDATA,1,-8.05E-001\n_VAR(1,       1,       1) = 0.\nD = 3\nMPTEMP,R5.0, 1, 1,  0.0\nBFCUM   ,VELO,REPLACE\n/GO\nFINISH\n";
    let deck = deck(text);
    assert_eq!(warnings(&deck), Vec::<String>::new());
    assert_eq!((deck.model().equations(), deck.model().cases().len()), (0, 1));
}

#[test]
fn nothing_after_the_end() {
    assert!(equations(&deck("/EOF\nCE,1,0,1,UX,1\n")).is_empty());
    assert_eq!(equations(&deck("\u{feff}CE,1,0,1,UX,1\r\n/eof $ CE,2,0,1,UX,1")), ["1:1 1 = 0"]);
}
