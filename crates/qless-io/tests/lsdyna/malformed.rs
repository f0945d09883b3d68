//! Decks that are wrong: file, line, card and field are named, and nothing panics.

use super::from_text::{CUBE, first_line, parsed, parsed_with, refused};

#[test]
fn faults_name_file_line_card_and_field() {
    for (cards, line, part) in [
        ("*NODE\n1,0.,x,0.\n", 1, "*NODE, field 3: `x` is no usable number"),
        ("*NODE\n-1,0.,0.,0.\n", 1, "*NODE, field 1: expected a number from 0 to 4294967295, found `-1`"),
        ("*NODE\n1,0.,0.,0.,9\n", 1, "*NODE, field 5: expected a code of directions from 0 to 7, found `9`"),
        ("*CONSTRAINED_NODAL_RIGID_BODY\n1,0,99\n", 1, "field 3: node set 99 is not defined"),
        ("*CONSTRAINED_NODAL_RIGID_BODY\n3\n\n1.5\n", 3, "field 1: expected a whole number"),
        ("*CONSTRAINED_EXTRA_NODES_NODE\n9,20\n", 1, "field 1: rigid body 9 is not defined"),
        ("*CONSTRAINED_NODAL_RIGID_BODY\n3\n*CONSTRAINED_RIGID_BODIES\n3,3\n", 3, "rigid body 3 is defined by itself"),
        ("*CONSTRAINED_INTERPOLATION\n1,22,127\n5,123\n", 1, "field 3: expected digits from 1 to 6, found `127`"),
        ("*CONSTRAINED_INTERPOLATION\n1,99,123\n5,123\n", 1, "node 99 is not defined"),
        ("*CONSTRAINED_INTERPOLATION\n1,22,123\n", 1, "nothing is connected"),
        ("*CONSTRAINED_LINEAR_GLOBAL\n1\n1,8,1.\n", 2, "field 2: expected a degree of freedom from 1 to 7, found `8`"),
        ("*CONSTRAINED_LINEAR_GLOBAL\n1\n99,1,1.\n", 2, "field 1: node 99 is not defined"),
        ("*CONSTRAINED_LINEAR_GLOBAL\n1\n1,1,&c\n", 2, "field 3: parameter c is not defined"),
        ("*CONTACT_TIED_NODES_TO_SURFACE\n3,6,4,0\n", 1, "field 2: segment set 6 is not defined"),
        ("*SET_SEGMENT\n6\n1,2\n*CONTACT_TIED_NODES_TO_SURFACE\n3,6,4,0\n", 4, "a segment has 2 different nodes"),
        ("*SET_SEGMENT\n6\n1,2,99\n*CONTACT_TIED_NODES_TO_SURFACE\n3,6,4,0\n", 4, "field 2: node 99 is not defined"),
        ("*BOUNDARY_SPC_NODE\n99,0,1\n", 1, "field 1: node 99 is not defined"),
        ("*BOUNDARY_PRESCRIBED_MOTION_NODE\n1,1,0,1,1e999\n", 1, "field 5: `1e999` is no usable number: too large"),
        ("*BOUNDARY_PRESCRIBED_MOTION_RIGID\n1,1,0,1\n", 1, "field 1: rigid body 1 is not defined"),
        ("*INCLUDE\nnowhere.k\n", 1, "the included file nowhere.k cannot be read"),
    ] {
        let message = refused(&format!("{CUBE}{cards}"));
        let place = format!("deck.k:{}: ", first_line() + line);
        assert!(message.starts_with(&place) && message.contains(part), "{cards}{message}");
    }
    let inner =
        parsed_with("*KEYWORD\n*INCLUDE\na.k\n", &[("a.k", "$\n*NODE\n1,0.,?,0.\n")]).expect_err("wrong").to_string();
    assert!(inner.starts_with("a.k:3: *NODE, field 3"), "{inner}");
    let folder = "*KEYWORD\n*INCLUDE_PATH_RELATIVE\nparts\n*INCLUDE\na.k\n";
    assert!(parsed_with(folder, &[("parts/a.k", "*NODE\n1,0.,0.,0.\n")]).is_ok());
    let expression = "*KEYWORD\n*PARAMETER_EXPRESSION\nR x,2*y\n*NODE\n1,&x,0.,0.\n";
    let message = parsed_with(expression, &[]).expect_err("an expression").to_string();
    assert!(
        message.contains("field 2: it needs the value of the parameter x, which this reader does not follow"),
        "{message}"
    );
    let circle =
        parsed_with("*KEYWORD\n*INCLUDE\na.k\n", &[("a.k", "*INCLUDE\na.k\n")]).expect_err("a circle").to_string();
    assert!(circle.contains("the depth of includes exceeds the limit"), "{circle}");
}

/// Every beginning of a deck, and every deck with a byte that is another: read or refused with a line.
#[test]
fn damaged_decks_do_not_panic() {
    let text = format!(
        "{CUBE}*PARAMETER\nR x,2.\n*MAT_RIGID\n5\n1,7,7\n*PART_INERTIA\n\n1,1,5\n&x,0.,0.,1.,1\n\n\n1\n*CONSTRAINED_NODAL_RIGID_BODY_SPC\n\
         3\n1,1,1\n*CONSTRAINED_EXTRA_NODES_SET\n1,4\n*CONSTRAINED_INTERPOLATION\n1,22,0,0,1\n3,0,2.\n\
         *CONTACT_TIED_NODES_TO_SURFACE\n4,5,4,0\n\n\n*BOUNDARY_PRESCRIBED_MOTION_RIGID\n3,9,0,1\n1,2\n*SET_NODE_LIST_GENERATE\n8\n1,5\n*END\n"
    );
    let bytes = text.as_bytes();
    let check = |bytes: &[u8]| {
        let text = String::from_utf8_lossy(bytes);
        if let Err(error) = parsed(&text) {
            assert!(error.to_string().starts_with("deck.k"), "{error}");
        }
    };
    assert!(parsed(&text).is_ok());
    for end in 0..bytes.len() {
        check(&bytes[..end]);
    }
    for (k, other) in (0..bytes.len()).flat_map(|k| b"*,\n0-& \xff9".iter().map(move |other| (k, *other))) {
        let mut changed = bytes.to_vec();
        changed[k] = other;
        check(&changed);
    }
}
