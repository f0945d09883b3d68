//! If the rank is ambiguous, `check` states the rank as meant.

use super::harness::Place;

/// The third equation is the first one with six digits; with `apart` it is different.
fn typed(place: &Place, apart: f64) {
    let entries = [
        (1, 1, 0.123_456_789),
        (1, 2, -0.987_654_321),
        (2, 2, 1.0),
        (2, 3, 2.0),
        (3, 1, 0.123_457 + apart),
        (3, 2, -0.987_654),
    ];
    place.case("case", [3, 3], &entries, &[0.0; 3], &[]);
}

#[test]
fn both_ranks_are_told_where_equations_nearly_repeat_others() {
    let place = Place::new();
    typed(&place, 0.0);
    let run = place.run("check case");
    assert_eq!(run.code, 0);
    for line in [
        "As typed the rank is 3; if equations that agree to 5 digits are meant as the same,\n",
        "it is 2: 1 equation would then repeat others.\n",
        "  row 3 ~ 1 * row 1 to 5 digits of each coefficient\n",
    ] {
        assert!(run.out.contains(line), "`{line}` is not in {}", run.out);
    }
    let meant = &place.run("check case --format json").json()["meant"];
    assert_eq!((meant["rank"].as_u64(), meant["digits"].as_u64()), (Some(2), Some(5)));
    let equation = &meant["equations"][0];
    assert_eq!((equation["row"].as_u64(), equation["because"][0]["row"].as_u64()), (Some(3), Some(1)));
    assert!(equation["distance"].as_f64().is_some_and(|d| (1e-8..1e-5).contains(&d)), "{equation}");
}

#[test]
fn a_sure_rank_has_one_reading() {
    let place = Place::new();
    typed(&place, 0.1);
    assert!(place.run("check case --format json").json().get("meant").is_none());
    assert!(!place.run("check case").out.contains("As typed"));
}
