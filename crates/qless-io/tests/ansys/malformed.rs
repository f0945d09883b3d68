//! Every kind of malformed command: the message names file, line, command and field, what was found and what to do.

use crate::parse::try_deck;

#[test]
fn messages() {
    for (text, message) in [
        ("CE,x,0,1,UX,1\n", "1: CE, field 1: expected a number from 1, HIGH or NEXT, found `x`"),
        ("CE,1,0,n1,UX,1\n", "1: CE, field 3: expected the number of a node, found `n1`"),
        ("CE,1,0,1.5,UX,1\n", "1: CE, field 3: expected the number of a node, found `1.5`"),
        ("CE,1,0,1,UW,1\n", "1: CE, field 4: expected the label of a degree of freedom, such as UX"),
        ("CE,1,0,1,,1\n", "1: CE, field 4: expected the label"),
        ("CE,1,0,,UX,1\n", "1: CE, field 3: expected the number of a node, found nothing"),
        ("CE,1,0,1,UX,nan\n", "1: CE, field 5: `nan` is no usable number: every number must be finite"),
        ("CE,1,1e999,1,UX,1\n", "1: CE, field 2: `1e999` is no usable number: too large"),
        ("\nCE,1,0,1,UX,1,2,UX,1,3,UX,1,4,UX,1\n", "2: CE, field 12: expected no more than 3 terms in a command"),
        ("CE,4294967295,0,1,UX,1\nCE,NEXT,0,1,UX,1\n", "2: CE, field 1: expected a number from 1, HIGH or NEXT"),
        ("CE,R5.0,WHAT,1\n", "1: CE, field 2: expected DEFI or NODE, found `WHAT`"),
        ("CE,R5.0,NODE,1,UX,1\n", "1: CE, field 2: expected DEFI, which begins an equation, before NODE"),
        ("CE,R5.0,DEFI,-1,1,0\n", "1: CE, field 3: expected the number of terms, found `-1`"),
        ("CE,R5.0,DEFI,1,0,0\n", "1: CE, field 4: expected the number of the equation, found `0`"),
        (
            "CE,R5.0,DEFI,3,1,0\nCE,R5.0,NODE,1,UX,1,2,UX,1\n",
            "1: CE 1: 3 terms are promised, but the card ends after 2",
        ),
        (
            "CE,R5.0,DEFI,1,1,0\nCE,R5.0,NODE,1,UX,1,2,UX,1\n",
            "2: CE, field 6: expected no more terms than DEFI promises",
        ),
        ("CP,R5.0,3,1,UX,1,2\n", "1: CP 1: 3 nodes are promised, but the card ends after 2"),
        ("CP,R5.0,1,1,UX,1,2\n", "1: CP, field 2: expected as many nodes as promised, found `1`"),
        ("CP,1,UX,1,x2\n", "1: CP, field 4: expected the number of a node, found `x2`"),
        ("CP,1,,1,2\n", "1: CP, field 2: expected the label"),
        ("D,1,UX,one\n", "1: D, field 3: `one` is no usable number"),
        ("D,1\n", "1: D, field 2: expected the label"),
        ("D,ENDS,UX\n", "1: D, field 1: expected the number of a node, ALL, or a component that CMBLOCK defines"),
        ("D,1,UX,0,,5,-1\n", "1: D, field 6: expected a whole number from 1, found `-1`"),
        ("D,1,UX,,,,,UV\n", "1: D, field 7: expected the label"),
        ("CEDELE,all2\n", "1: CEDELE, field 1: expected a number from 1 or ALL, found `all2`"),
        ("CMBLOCK,A,NODE,x\n", "1: CMBLOCK, field 3: expected the number of items, found `x`"),
        (
            "NBLOCK,6,SOLID\n(3x9)\n",
            "2: a block: expected the format of the block, such as (3i9,6e21.13e3), found `(3x9)`",
        ),
        ("NBLOCK,6,SOLID\n(1i9)\n     1e45\n", "3: a block, field 1: expected the number of a node, found `1e45`"),
        ("N,1.5\n", "1: N, field 1: expected the number of a node, found `1.5`"),
    ] {
        let error = try_deck(text).expect_err(text).to_string();
        assert!(error.starts_with(&format!("deck.cdb:{message}")), "{text:?}: {error}");
    }
}

#[test]
fn a_line_that_is_too_long() {
    let text = format!("CE,1,0,1,UX,{}\n", "1".repeat(1 << 20));
    let error = try_deck(&text).expect_err("too long").to_string();
    assert!(error.contains("deck.cdb:1: a line: the length of the line exceeds the limit of 1048576"), "{error}");
}

#[test]
fn ranges_that_stand_for_too_much() {
    use std::fmt::Write;
    let mut text = String::new();
    for node in 1..=5000 {
        writeln!(text, "N,{node}").expect("written");
    }
    text += &"D,1,UX,0,,4000000000\n".repeat(11_000);
    let error = try_deck(&text).expect_err("too many").to_string();
    assert!(error.contains("D: the number of values exceeds the limit of 50000000"), "{error}");
}

#[test]
fn searches_that_take_too_long() {
    use std::fmt::Write;
    let (mut equation, mut set) = (String::new(), String::from("CP,1,UX,1\n"));
    for node in 1..=40_000 {
        writeln!(equation, "CE,1,0,{node},UX,1").expect("written");
        writeln!(set, "CP,1,UX,{node}").expect("written");
    }
    for (text, again) in [(equation, "CE,1,0,-50000,UX\n"), (set, "CP,1,UX,-1,1,-1,1,-1,1,-1,1\n")] {
        let error = try_deck(&(text + &again.repeat(15_000))).expect_err("too long").to_string();
        assert!(error.contains("the work to remove terms or nodes exceeds the limit of 500000000"), "{error}");
    }
}
