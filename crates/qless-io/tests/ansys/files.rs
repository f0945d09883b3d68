//! Files that a deck itself writes and reads again.

use crate::parse::{deck, equations, in_force, prescribed, warnings};

#[test]
fn resume_brings_back_what_is_saved() {
    let text = "N,1\nN,2\nN,3\nCP,1,UX,1,2\nD,1,UX,1\nSAVE\nCP,2,UX,1,3\nSOLVE\n/CLEAR\nN,9\nD,9,UY\nSOLVE\nRESUME\nD,2,UY,3\nSOLVE\n";
    let deck = deck(text);
    assert_eq!((deck.model().cases().len(), warnings(&deck)), (3, vec![]));
    assert_eq!(in_force(&deck, 0), ["2:1 1, 1:1 -1 = 0", "3:1 1, 1:1 -1 = 0"]);
    assert_eq!(prescribed(&deck, 1), ["9:2 0"]);
    assert_eq!(in_force(&deck, 2), ["2:1 1, 1:1 -1 = 0"]);
    assert_eq!(prescribed(&deck, 2), ["1:1 1", "2:2 3"]);
}

#[test]
fn files_are_known_by_name() {
    let left_out = |text: &str| deck(text).model().left_out().count();
    for (between, count) in [
        ("SAVE\nRESUME\n", 0),
        ("SAVE,a,db\nRESUME,a,db\n", 0),
        ("SAVE,a\n/CLEAR\nRESUME,a\n", 0),
        ("/FILNAME,x\nSAVE\n/FILNAME,y\n/FILNAME,x\nRESUME\n", 0),
        ("/FILNAME,x,1\nSAVE\n/CLEAR\nRESUME\n", 0),
        // The job has another name, or the file has.
        ("/FILNAME,x\nSAVE\n/CLEAR\nRESUME\n", 1),
        ("SAVE\n/FILNAME,x\nRESUME\n", 1),
        ("SAVE,a\nRESUME,A\n", 1),
        ("RESUME\nSAVE\n", 1),
        // Which file it is, or what it holds, depends on what this reader does not know.
        ("I=1\nSAVE,a%I%\nRESUME,a%I%\n", 1),
        ("SAVE,a\nF='b'\nSAVE,F\nRESUME,a\n", 1),
        ("*IF,ARG1,EQ,1,THEN\nSAVE,a\n*ENDIF\nRESUME,a\n", 1),
        ("SAVE,a\n*CREATE,M\nSAVE,a\n*END\nRESUME,a\n", 1),
        ("/POST1\nSAVE,a\nFINISH\nRESUME,a\n", 1),
        ("SAVE,a\nRESUME,a,,,1\n", 1),
        ("SAVE,a\n*IF,1,EQ,1,THEN\nRESUME,a\n*ENDIF\n", 1),
        ("SAVE,a\n/COPY,b,db,,a,db\nRESUME,a\n", 1),
        ("SAVE,a\n/COPY,a,db,,b,db\n/DELETE,a,rst\nRESUME,a\n", 0),
        ("SAVE,a\n/RENAME,a,db,,b,db\nRESUME,a\n", 1),
        ("SAVE,a\n/CWD,b\nRESUME,a\n", 1),
        ("SAVE,a\n/SYS,mv b.db a.db\nRESUME,a\n", 1),
        ("PARRES,,other\nSAVE,a\nRESUME,a\n", 1),
    ] {
        let text = format!("*GET,ARG1,NODE,,COUNT\nCE,1,0,1,UX,1\n{between}CE,2,0,2,UX,1\nSOLVE\n");
        assert_eq!(left_out(&text), count, "{between}");
    }
    // What is saved may itself be unknown.
    assert_eq!(left_out("CDREAD,DB,a,cdb\nSAVE\nRESUME\nCE,2,0,2,UX,1\nSOLVE\n"), 1);
}

/// A database holds parameters, nodes, selections and numbers of equations.
#[test]
fn databases_hold_everything() {
    let deck = deck(
        "A=4\nN,1\nN,2\nN,4\nNSEL,S,,,2\nCE,3,0,1,UX,1\nSAVE\nA=9\nNSEL,ALL\nCEDELE,ALL\nRESUME\nD,A,UY\nD,ALL,UZ\nCE,NEXT,0,2,UX,1\n",
    );
    assert_eq!(prescribed(&deck, 1), ["2:3 0", "4:2 0"]);
    assert_eq!(deck.model().label(1).as_deref(), Some("line 14 CE 4 2:1"));
    assert_eq!(in_force(&deck, 1).len(), 2);
    // A model that is brought back and neither changed nor solved is for output.
    let output = crate::parse::deck("CE,1,0,1,UX,1\nSAVE\nSOLVE\nRESUME\n/POST1\n");
    assert_eq!((output.model().cases().len(), output.model().equations()), (1, 1));
}

#[test]
fn resuming_is_limited() {
    let text = "CE,1,0,1,UX,1\nSAVE\n".to_owned() + &"RESUME\nSAVE\n".repeat(3000) + "CE,2,0,2,UX,1\nSOLVE\n";
    let error = crate::parse::try_deck(&text).expect_err("too much to read again").to_string();
    assert!(error.contains("the number of models exceeds"), "{error}");
}

#[test]
fn parameters_come_back() {
    let values = |text: &str| prescribed(&deck(&format!("{text}D,1,UX,A\nD,2,UX,B(2)\n")), 0);
    let saved = "A=3\n*DIM,B,ARRAY,2\nB(2)=5\n";
    assert_eq!(values(&format!("{saved}PARSAV,ALL\n/CLEAR\nPARRES\n")), ["1:1 3", "2:1 5"]);
    assert_eq!(values(&format!("{saved}PARSAV,ALL,p,x\nA=1\nB(2)=1\nPARRES,CHANGE,p,x\n")), ["1:1 3", "2:1 5"]);
    assert_eq!(values(&format!("{saved}PARSAV\nA=1\nB(2)=1\nPARRES,CHANGE\n")), ["1:1 3", "2:1 1"]);
    // Without CHANGE, all other parameters are deleted.
    assert!(crate::parse::try_deck("PARSAV,ALL\nA=1\nPARRES\nD,A,UX\n").is_err());
    for unknown in
        ["A=3\nPARRES\n", "PARRES,,f\n", "A=3\nPARSAV\nA=4\n*DO,I,1,2\nPARRES\n*ENDDO\n", "PARSAV,,f\nPARRES,,g\n"]
    {
        for (command, left_out) in [
            ("D,A,UX\n", 1),
            ("CE,2,A,1,UX,1\n", 1),
            ("CE,2,0,1,UX,1,2,UX,A\n", 1),
            ("CP,1,UX,1,A\n", 1),
            ("ET,1,A\n", 1),
            ("D,3,UX\n", 0),
            ("F,A,FX,1\n", 0),
            ("N,A,1\n", 0),
        ] {
            let deck = deck(&format!("CE,1,0,1,UX,1\n{unknown}{command}SOLVE\n"));
            let found = (deck.model().left_out().count(), equations(&deck).len());
            assert_eq!(found, (left_out, 1), "{unknown}{command}");
        }
    }
}
