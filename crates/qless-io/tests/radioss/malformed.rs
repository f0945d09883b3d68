//! Decks that are wrong: file, line, card and field are named, and nothing panics.

use super::from_text::{CUBE, columns, first_line, parsed_bytes, refused};

#[test]
fn faults_name_file_line_card_and_field() {
    for (cards, line, part) in [
        ("/NODE\n1 =0. =x =0.\n", 1, "/NODE, field 4: `x` is no usable number"),
        ("/NODE\n1 =0. =NaN =0.\n", 1, "/NODE, field 4: `NaN` is no usable number"),
        ("/NODE\n-1 =0. =0. =0.\n", 1, "/NODE, field 1: expected a number from 0 to 4294967295, found `-1`"),
        ("/BRICK/1\n9 1.5\n", 1, "/BRICK/1, field 2: expected a whole number"),
        ("/RBODY/1\n'b\n22 0 0 0 =0. 99\n", 2, "/RBODY/1, field 7: node group 99 is not defined"),
        ("/RBODY/1\n'b\n99 0 0 0 =0. 3\n", 2, "/RBODY/1, field 1: node 99 is not defined"),
        ("/RBE2/1\n'b\n22\n", 2, "/RBE2/1, field 4: node group 0 is not defined"),
        ("/RBE2/1\n'b\n22 2/000 0 3\n", 2, "/RBE2/1, field 2: expected three digits 0 or 1, a blank, and three more"),
        ("/RBE2/1\n'b\n22 100/000 7 3\n", 2, "/RBE2/1, field 3: skew frame 7 is not defined"),
        ("/RBE3/1\n'b\n22 _ 2\n=1. _ 0 3\n", 2, "field 3: 2 sets of nodes are promised, but the card ends after 1"),
        ("/RBE3/1\n'b\n22 _ 1\n=1e999 _ 0 3\n", 3, "field 1: `1e999` is no usable number: too large"),
        ("/RBE3/1\n'b\n22 _ 1\n=1. 100/000 0 3\n", 2, "do not determine 22:1"),
        ("/RBE3/1\n'b\n22\n", 2, "nothing is connected"),
        ("/MPC/1\n'm\n1 7 0 =1.\n", 2, "/MPC/1, field 2: expected a degree of freedom from 1 to 6, found `7`"),
        ("/MPC/1\n'm\n1 1 0 =nan\n", 2, "/MPC/1, field 4: `nan` is no usable number"),
        ("/MPC/1\n'm\n1 1 0 =&c\n", 2, "field 4: parameter c is not defined"),
        ("/INTER/TYPE2/1\n't\n3 6 0 4\n", 2, "/INTER/TYPE2/1, field 2: surface 6 is not defined"),
        (
            "/SURF/SEG/6\n's\n1 1 2\n/INTER/TYPE2/1\n't\n3 6 0 4\n",
            5,
            "field 2: a segment has 2 different nodes instead of 3 or 4",
        ),
        ("/SURF/SEG/6\n's\n1 1 2 99\n/INTER/TYPE2/1\n't\n3 6 0 4\n", 5, "field 2: node 99 is not defined"),
        ("/BCS/1\n'b\n111/000 0\n", 2, "/BCS/1, field 3: node group 0 is not defined"),
        ("/GRNOD/NODE/9\n'a\n1 99\n/BCS/1\n'b\n111/000 0 9\n", 5, "/BCS/1, field 3: node 99 is not defined"),
        (
            "/GRNOD/GRNOD/9\n'a\n8\n/GRNOD/GRNOD/8\n'a\n9\n/BCS/1\n'b\n111/000 0 9\n",
            8,
            "node group 9 is defined by itself",
        ),
        ("/SKEW/MOV/9\n's\n1 2 2\n/BCS/1\n'b\n100/000 9 3\n", 5, "field 2: the axes of skew frame 9 are on a line"),
        ("/SKEW/MOV/9\n's\n1 2 99\n/BCS/1\n'b\n100/000 9 3\n", 5, "field 2: node 99 is not defined"),
        ("/IMPVEL/1\n'v\n1 W 0 0 3\n", 2, "/IMPVEL/1, field 2: expected a direction X, Y, Z, XX, YY or ZZ, found `W`"),
        ("/IMPVEL/1\n'v\n1\n", 2, "/IMPVEL/1, field 2: expected a direction"),
        ("#include nowhere.inc\n", 0, "the included file nowhere.inc cannot be read"),
    ] {
        let message = refused(&format!("{CUBE}{cards}"));
        let place = format!("deck_0000.rad:{}: ", first_line() + line);
        assert!(message.starts_with(&place) && message.contains(part), "{cards}{message}");
    }
    let inner =
        parsed_bytes(b"#include a.inc\n".to_vec(), &[("a.inc", "#\n/NODE\n1 =0. =? =0.\n")]).expect_err("wrong");
    assert!(inner.to_string().starts_with("a.inc:3: /NODE, field 4"), "{inner}");
    let circle = parsed_bytes(b"#include a.inc\n".to_vec(), &[("a.inc", "#include a.inc\n")]).expect_err("a circle");
    assert!(circle.to_string().contains("the depth of includes exceeds the limit"), "{circle}");
    let link = |k: u32| format!("/GRNOD/GRNOD/{}\n'g\n{} {}\n", 1000 + k, 1001 + k, 1002 + k);
    let chain = (1..=200).map(link).collect::<Vec<_>>().concat();
    let deep = refused(&format!("{CUBE}{chain}/BCS/1\n'b\n111/000 0 1001\n"));
    assert!(deep.contains("the depth of groups exceeds the limit of 100"), "{deep}");
}

/// A few lines cannot demand much time or memory.
#[test]
fn groups_that_multiply_are_refused() {
    let nodes: Vec<String> = (1..=5000).map(|node| format!("{node} =0. =0. =0.\n")).collect();
    let text = format!("/NODE\n{}/GRNOD/GENE/1\n'all\n{}", nodes.concat(), "1 5000\n".repeat(10_000));
    let message = refused(&format!("{text}/BCS/1\n'b\n111/000 0 1\n"));
    let line = text.lines().count() + 3;
    let what = "the number of members of groups exceeds the limit of 40000000; name fewer groups in groups";
    assert_eq!(message, format!("deck_0000.rad:{line}: /BCS/1, field 3: {what}"));
}

/// Every beginning of a deck, and every deck with a byte that is another: read or refused with a line.
#[test]
fn damaged_decks_do_not_panic() {
    let cards = "/SKEW/FIX/6\n'oblique\n=-.6 =.8 =0.\n=0. =0. =1.\n/SURF/PART/EXT/7\n's\n1\n/RBODY/1\n'b\n22 0 0 0 =0. 3 0 1\n=0.\n=0.\n0 0 0\n\
                 /RBE2/2\n'b\n21 110/001 6 3\n/RBE3/3\n'm\n20 _ 2 0\n=1. 111/000 0 3\n=2. _ 0 4\n/MPC/4\n'm\n1 1 6 =2.\n\
                 /INTER/TYPE2/5\n't\n4 7 1 1 0 0 0 0 =.1\n/BCS/6\n'b\n110/000 6 4\n/IMPVEL/7\n'v\n1 X 0 0 4\n=1. =2. =0. =0.\n/END\n";
    let text = columns(&format!("{CUBE}{cards}"));
    let bytes = text.as_bytes();
    let check = |bytes: &[u8]| {
        if let Err(error) = parsed_bytes(bytes.to_vec(), &[]) {
            assert!(error.to_string().starts_with("deck_0000.rad:"), "{error}");
        }
    };
    assert!(parsed_bytes(bytes.to_vec(), &[]).is_ok());
    for end in 0..bytes.len() {
        check(&bytes[..end]);
    }
    for (k, other) in (0..bytes.len()).flat_map(|k| b"/#\n0-& \xff9".iter().map(move |other| (k, *other))) {
        let mut changed = bytes.to_vec();
        changed[k] = other;
        check(&changed);
    }
}
