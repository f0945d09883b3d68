//! Decks that are programs: parameters, loops and conditions.

use qless_io::deck::Deck;
use qless_io::deck::clean;

use crate::parse::{deck, equations, prescribed, refused, try_deck, warnings};

fn left_out(text: &str) -> Vec<String> {
    let deck = deck(text);
    deck.model().left_out().map(|warning| format!("{}: {}", warning.line, warning.text)).collect()
}

#[test]
fn parameters_in_equations() {
    let text = "W=3.0\nCE,1,0,1,UX,W,2,UX,-1\n";
    assert_eq!(equations(&deck(text)), ["1:1 3, 2:1 -1 = 0"]);
    let text = "*SET,N1,4 $ L='UY'\nCE,NEXT,2*N1,N1,UX,1/4,N1+1,L,-N1\nD,N1,L,N1**2\n";
    let deck = deck(text);
    assert_eq!(equations(&deck), ["4:1 0.25, 5:2 -4 = 8"]);
    assert_eq!(prescribed(&deck, 0), ["4:2 16"]);
}

#[test]
fn an_equation_with_an_unknown_term_is_left_out_whole() {
    let text =
        "*GET,N,NODE,,NUM,MAX\nCE,1,0,1,UX,1\nCE,2,0,1,UY,1,2,UY,1\nCE,2,0,N,UX,1\nCE,2,0,5,UX,1\nCE,3,0,1,UZ,1\n";
    assert_eq!(equations(&deck(text)), ["1:1 1 = 0", "1:3 1 = 0"]);
    assert_eq!(
        left_out(text),
        [
            "4: CE uses N, whose value this reader does not know: left out",
            "5: CE 2 has a command that could not be read: the whole equation is left out"
        ]
    );
    let text = "*GET,N,NODE,,NUM,MAX\nCP,1,UX,1,2\nCP,1,,N\nD,N,UX\nCEDELE,ALL\n";
    assert!(equations(&deck(text)).is_empty());
    assert_eq!(left_out(text).len(), 2);
}

#[test]
fn loops_are_carried_out() {
    let text = "*DO,I,1,3\n*DO,J,10,20,10\nCE,NEXT,0,I,UX,1,I+J,UX,-1\n*ENDDO\n*ENDDO\nD,I,UX\n";
    let deck = deck(text);
    assert_eq!(equations(&deck)[..3], ["1:1 1, 11:1 -1 = 0", "1:1 1, 21:1 -1 = 0", "2:1 1, 12:1 -1 = 0"]);
    assert_eq!((equations(&deck).len(), prescribed(&deck, 0)), (6, vec!["4:1 0".to_owned()]));
    let of = |text: &str| equations(&crate::parse::deck(text)).len();
    assert_eq!(of("*DO,I,3,1\nCE,NEXT,0,I,UX,1\n*ENDDO\n"), 0);
    assert_eq!(of("*DO,I,3,1,-1\nCE,NEXT,0,I,UX,1\n*ENDDO\n"), 3);
    assert_eq!(of("*DO,I,0,0.3,0.1\nCE,NEXT,I,1,UX,1\n*ENDDO\n"), 4);
    assert_eq!(of("*DO,I,1,9\n*IF,I,EQ,4,EXIT\n*IF,I,EQ,2,CYCLE\nCE,NEXT,0,I,UX,1\n*ENDDO\nCE,NEXT,0,9,UX,1\n"), 3);
    assert_eq!(of("*DO,I,1,3\nCE,NEXT,0,I,UX,1 $ *ENDDO $ CE,NEXT,0,9,UX,1\n"), 4);
}

#[test]
fn conditions_choose() {
    let of = |a: &str| {
        let text = format!(
            "A={a}\n*IF,A,EQ,1,THEN\nCE,1,0,1,UX,1\n*IF,A,GT,5,THEN\nCE,9,0,1,UX,1\n*ENDIF\n\
             *ELSEIF,A,GT,1,AND,A,LT,3,THEN\nCE,2,0,2,UX,1\n*ELSE\nCE,3,0,3,UX,1\n*ENDIF\n"
        );
        equations(&deck(&text)).join(";")
    };
    assert_eq!([of("1"), of("2"), of("7")], ["1:1 1 = 0", "2:1 1 = 0", "3:1 1 = 0"]);
}

#[test]
fn what_is_not_followed_constrains_perhaps() {
    for (text, expected) in [
        (
            "*GET,N,NODE,,NUM,MAX\n*DO,I,1,N\nD,I,UX\n*ENDDO\nD,9,UX\n",
            "3: D is in *IF, *DO or *CREATE, and it is not known whether it is executed",
        ),
        (
            "*DOWHILE,N\nCE,1,0,1,UX,1\n*ENDDO\n",
            "2: CE is in *IF, *DO or *CREATE, and it is not known whether it is executed",
        ),
        (
            "*CREATE,M\nCERIG,1,2\n*END\n",
            "2: CERIG is in *IF, *DO or *CREATE, and it is not known whether it is executed",
        ),
        ("*IF,NX(1),EQ,0,THEN\nA=3\n*ENDIF\nD,A,UX\n", "4: D uses A"),
        ("A=1\n*IF,A,EQ,1,:END\nD,1,UX\n:END\n", "2: *IF jumps to another line"),
        (
            "*IF,NX(1),EQ,0,THEN\nSOLVE\n*ENDIF\n",
            "2: SOLVE is in *IF, *DO or *CREATE, and it is not known whether it is executed",
        ),
        ("CE,1,0,1,UX,1\n*REPEAT,4,1\n", "2: *REPEAT is not followed"),
        (
            "*DO,I,1,3\nCE,NEXT,0,I,UX,1\n*IF,NX(1),EQ,0,EXIT\n*ENDDO\n",
            "2: CE is in *IF, *DO or *CREATE, and it is not known whether it is executed",
        ),
        (
            "*DO,I,1,3\n*IF,NX(1),EQ,0,THEN\n*EXIT\n*ENDIF\nD,7,UX\n*ENDDO\n",
            "5: D is in *IF, *DO or *CREATE, and it is not known whether it is executed",
        ),
        (
            "*DO,I,1,3\n*IF,NX(1),EQ,0,THEN\n*IF,1,EQ,1,CYCLE\n*ENDIF\nD,7,UX\n*ENDDO\n",
            "5: D is in *IF, *DO or *CREATE, and it is not known whether it is executed",
        ),
    ] {
        // Without an equation, values would not matter.
        let found = left_out(&format!("{text}CE,9,0,1,UX,1,2,UX,1\n"));
        assert!(found.len() == 1 && found[0].starts_with(expected), "{text:?}: {found:?}");
    }
    // Commands in a skipped branch are not reported.
    assert!(left_out("A=1\n*IF,A,EQ,2,THEN\nCEINTF\nDSYM,SYMM,X\n*ENDIF\n").is_empty());
}

#[test]
fn loops_that_take_too_long() {
    let text = "*DO,I,1,1e9\n*DO,J,1,1e9\nCEDELE,1\n*ENDDO\n*ENDDO\n";
    let error = try_deck(text).expect_err("too long").to_string();
    assert!(error.contains("the text that loops read again exceeds the limit"), "{error}");
}

fn cleaned(text: &str) -> (Deck, String) {
    let before = deck(text);
    let plan = clean::plan(&before, &qless::Options::default()).expect("a plan");
    let result = String::from_utf8(clean::write(&before, &plan).expect("written")).expect("text");
    let after = deck(&result);
    assert!(refused(&after).is_empty(), "{result}");
    assert!(clean::plan(&after, &qless::Options::default()).expect("a plan").is_empty(), "{result}");
    (after, result)
}

#[test]
fn what_a_loop_makes_is_deleted_below_it() {
    let text = "CE,1,0,1,UX,1,2,UX,-1\n*DO,I,1,3\nCE,NEXT,0,I,UX,1,I+1,UX,-1\n*ENDDO\nD,1,UX\nSOLVE\n";
    let (after, result) = cleaned(text);
    assert_eq!(after.model().equations(), 3, "{result}");
    assert!(result.contains("*DO,I,1,3\nCE,NEXT,0,I,UX,1,I+1,UX,-1\n*ENDDO\n"), "{result}");
    assert!(result.contains("CEDELE,2\n"), "{result}");
    let text = "*DO,I,1,2\nCP,I,UX,1,I+1\n*ENDDO\nCE,1,0,2,UX,1,3,UX,-1\n";
    assert_eq!(cleaned(text).0.model().equations(), 2);
    assert!(warnings(&cleaned(text).0).is_empty());
}

#[test]
fn a_loop_that_never_ends_is_left_out() {
    let text = "CE,1,0,9,UX,1\n*DO,I,1,3\nCE,NEXT,0,I,UX,1,I+1,UX,-1\n";
    assert_eq!(
        left_out(text),
        ["2: *DO, *IF or *CREATE is never closed: constraints that it may still make are left out"]
    );
    assert_eq!(left_out("*IF,1,EQ,2,THEN\nCE,1,0,9,UX,1\n").len(), 1);
    assert!(left_out(&format!("{text}*ENDDO\n")).is_empty() && left_out("*IF,1,EQ,1,THEN\nCE,1,0,9,UX,1\n").is_empty());
}

#[test]
fn numbers_that_are_compressed_are_not_followed() {
    for (what, count) in [("CE", 1), ("all", 1), ("NODE", 1), ("MAT", 0)] {
        assert_eq!(left_out(&format!("CE,5,0,1,UX,1\nNUMCMP,{what}\nCE,1,0,2,UX,1\n")).len(), count, "{what}");
    }
}

#[test]
fn a_comma_repeats_the_name_of_the_command_before() {
    let text = "N,1\n,2,1\n,3,2\nCE,1,0,1,UX,1,2,UX,-1\n ,2,0,2,UX,2,1,UX,-2\n, 3,0,3,UX,1,2,UX,-1\nD,1,UX,4\n,3,UY\n";
    let read = deck(text);
    assert_eq!(equations(&read), ["1:1 1, 2:1 -1 = 0", "2:1 2, 1:1 -2 = 0", "3:1 1, 2:1 -1 = 0"]);
    assert_eq!(prescribed(&read, 0), ["1:1 4", "3:2 0"]);
    assert!(warnings(&read).is_empty(), "{:?}", warnings(&read));
    // What is redundant goes, and what repeats a name stays what it was.
    let plan = clean::plan(&read, &qless::Options::default()).expect("a plan");
    let cleaned = String::from_utf8(clean::write(&read, &plan).expect("a deck")).expect("text");
    assert!(refused(&deck(&cleaned)).is_empty() && equations(&deck(&cleaned)).len() == 2, "{cleaned}");
    assert_eq!(warnings(&deck(",1,2\n")).len(), 1);
}

#[test]
fn nodes_are_selected_deleted_and_renumbered() {
    let nodes = "N,1,0,0,0\nN,2,1,0,0\nCE,1,3,2,UX,1\n";
    let of = |select: &str| deck(&format!("{nodes}NSEL,S,NODE,,1\n{select}\nD,ALL,UX,0\n"));
    for select in ["ALLSEL", "ALLSEL,ALL,ELEM"] {
        assert_eq!(prescribed(&of(select), 0), ["1:1 0", "2:1 0"], "{select}");
    }
    assert_eq!(of("ALLSEL,BELOW,ELEM").model().left_out().count(), 1);
    let cleared = deck("CE,1,0,1,UX,1,2,UX,-1\nD,1,UX,5\nLSCLEAR,ALL\nD,2,UX,7\n");
    assert_eq!(prescribed(&cleared, 0), ["2:1 7"]);
    for (text, expected) in [
        (format!("{nodes}NUMOFF,NODE,100\n"), Some("4: NUMOFF renumbers")),
        (format!("NUMOFF,NODE,100\n{nodes}"), None),
        (format!("{nodes}NDELE,2\n"), Some("4: NDELE deletes nodes")),
        (format!("N,9,0,0,0\nNDELE,9\n{nodes}"), None),
    ] {
        let found = left_out(&text);
        assert_eq!(found.len(), usize::from(expected.is_some()), "{text}: {found:?}");
        assert!(expected.is_none_or(|expected| found[0].starts_with(expected)), "{text}: {found:?}");
    }
}
