//! Coupled sets that `CPNGEN`, `CPLGEN` and `CPSGEN` generate.

use qless_io::deck::clean;

use crate::parse::{deck, equations, try_deck, warnings};

/// The same sets as those of the `CP` commands.
#[test]
fn generated_sets_are_those_of_cp() {
    for (generated, written) in [
        ("CPNGEN,1,UX,2,4\n", "CP,1,UX,2,3,4\n"),
        ("CPNGEN,1,UX,2,6,2\nCPNGEN,1,,9\n", "CP,1,UX,2,4,6,9\n"),
        ("CP,1,UX,5\nCPNGEN,HIGH,UX,2,3\nCPNGEN,NEXT,UY,7,8\n", "CP,1,UX,5,2,3\nCP,2,UY,7,8\n"),
        ("CP,1,UX,1,2,3,4\nCPNGEN,1,UX,-2,3\n", "CP,1,UX,1,4\n"),
        ("CP,3,UX,1,2\nCPLGEN,3,UY,,ROTZ\n", "CP,3,UX,1,2\nCP,4,UY,1,2\nCP,5,ROTZ,1,2\n"),
        ("CP,1,TEMP,2,12\nCPSGEN,3,10,1\n", "CP,1,TEMP,2,12\nCP,2,TEMP,12,22\nCP,3,TEMP,22,32\n"),
        ("CP,1,UX,9,8\nCPSGEN,2,-3,1\n", "CP,1,UX,9,8\nCP,2,UX,6,5\n"),
        (
            "CP,1,UX,1,2\nCP,2,UY,1,2\nCP,3,UZ,1,2\nCPSGEN,2,4,1,3,2\n",
            "CP,1,UX,1,2\nCP,2,UY,1,2\nCP,3,UZ,1,2\nCP,4,UX,5,6\nCP,5,UZ,5,6\n",
        ),
        (
            "CP,1,UX,1,2\nCP,2,UY,1,2\nCPSGEN,3,4,1,2\n",
            "CP,1,UX,1,2\nCP,2,UY,1,2\nCP,3,UX,5,6\nCP,4,UY,5,6\nCP,5,UX,9,10\nCP,6,UY,9,10\n",
        ),
        ("CP,1,UX,1,2\nCPSGEN,1,4,1\n", "CP,1,UX,1,2\n"),
        ("CP,1,UX,1,2\nCPSGEN,2,4,1\nCPDELE,2\nCPSGEN,2,5,1\n", "CP,1,UX,1,2\nCP,2,UX,6,7\n"),
    ] {
        let (generated, cp) = (deck(generated), deck(written));
        assert_eq!((equations(&generated), warnings(&generated)), (equations(&cp), vec![]), "{written}");
    }
    let steps = deck("CP,1,UX,1,2\nSOLVE\nCPSGEN,2,4,1\nSOLVE\n");
    assert_eq!(crate::parse::in_force(&steps, 0).len(), 1);
    assert_eq!(crate::parse::in_force(&steps, 1).len(), 2);
}

#[test]
fn what_is_not_certain_is_left_out() {
    let two = "CP,1,UX,1,2\nCP,2,UY,1,2\nCPSGEN,3,4,1,2\n";
    for text in [
        "CP,1,UX,1,2\nCPSGEN,4,,1\n",
        "CP,1,UX,1,2\nCPSGEN,2,1,-1\n",
        "CPSGEN,2,1,7\n",
        "CPLGEN,7,UX\n",
        "CP,1,UX,ALL\nCPSGEN,2,1,1\n",
        "CP,1,UX,ALL\nCPNGEN,1,UX,2,3\n",
        "CM,G,NODE\nCPNGEN,1,UX,G\n",
        "*GET,K,NODE,,COUNT\nCP,1,UX,1,2\nCPSGEN,2,K,1\n",
        &format!("{two}CPDELE,4\n"),
        &format!("{two}CP,4,,7\n"),
    ] {
        assert!(deck(text).model().left_out().count() > 0, "{text}");
    }
    assert_eq!(deck(&format!("{two}CPDELE,ALL\nCP,4,UX,1,2\n")).model().left_out().count(), 0);
    for wrong in [
        "CP,1,UX,1,2\nCPSGEN,2,-1,1\n",
        "CP,1,UX,1,2\nCPLGEN,1,NO\n",
        "CPNGEN,1,UX,1,4000000000\n",
        "CP,1,UX,1,2\nCPSGEN,4000000000,1,1\n",
    ] {
        assert!(try_deck(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn generated_sets_are_cleaned_by_number() {
    let before = deck("CP,1,UX,1,2\nCPSGEN,3,1,1\nCP,9,UX,1,4\n");
    assert_eq!(equations(&before).len(), 4);
    let plan = clean::plan(&before, &qless::Options::default()).expect("a plan");
    let after = clean::write(&before, &plan).expect("written");
    assert_eq!(equations(&deck(std::str::from_utf8(&after).expect("text"))).len(), 3);
    let before = deck("CP,1,UX,1,2\nCP,2,UY,1,2\nCPSGEN,3,1,1,2\nCP,9,UX,1,4\n");
    let plan = clean::plan(&before, &qless::Options::default()).expect("a plan");
    assert!(clean::write(&before, &plan).expect_err("which set?").to_string().contains("CPSGEN"));
}
