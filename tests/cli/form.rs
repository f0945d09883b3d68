//! `reduce --form`: the files of factored components, evaluated by the documented formulas only.

use std::collections::BTreeSet;
use std::fs;

use serde_json::json;

use super::case::{Case, random};
use super::factors::{Factors, Whole};
use super::harness::Place;

/// A mortar tie: plain, in mixed units, with prescribed DOFs and b, or with all of these.
fn mortar(place: &Place, units: bool, prescribed: bool) -> Case {
    assert_eq!(place.run("generate fssi --equations 1500 --coupling mortar -o scene").code, 0);
    let mut case = Case::read(place, "scene");
    if units {
        case.mix_units();
    }
    if prescribed {
        // Prescribed masters make no equation dependent.
        assert_eq!(place.run("reduce scene -o plain").code, 0);
        let masters = Whole::read(place, "plain").masters;
        case.prescribed = (0..7).map(|k| (masters[k * masters.len() / 7], random(k as u64))).collect();
        // Consistent for the redundant equations too.
        let any: Vec<f64> = (0..case.c.columns).map(|j| random(j as u64) / case.column_unit(j)).collect();
        case.prescribed.iter_mut().for_each(|(j, value)| *value = any[*j]);
        case.b = case.times(&any);
    }
    case.write(place, "case");
    case
}

#[test]
fn factors_solve_the_equations_by_the_documented_formula() {
    for (units, prescribed) in [(false, false), (false, true), (true, false), (true, true)] {
        let place = Place::new();
        let case = mortar(&place, units, prescribed);
        let run = place.run("reduce case -o out --form factored --format json");
        assert_eq!(run.code, 0, "{}", run.err);
        let whole = Whole::read(&place, "out");
        assert!(!whole.blocks.is_empty(), "units {units}, prescribed {prescribed}");
        whole.blocks.iter().for_each(|block| block.check_against(&case));
        let u_q: Vec<f64> = whole.masters.iter().map(|&j| random(j as u64 + 99) / case.column_unit(j)).collect();
        let u_p: Vec<f64> = case.prescribed_values(&whole.prescribed);
        let u = whole.expand(&u_q, &u_p);
        assert!(case.residual(&u) < 1e-10, "{:e}, units {units}, prescribed {prescribed}", case.residual(&u));
        assert_eq!(whole.blocks.iter().map(|block| block.c_p.columns).sum::<usize>() > 0, prescribed);
        assert_eq!(run.json()["rank"], whole.slaves.len());
    }
}

/// In one unit only: in mixed units T is less accurate than the factors.
#[test]
fn what_follows_from_t_follows_from_the_factors() {
    for prescribed in [false, true] {
        let place = Place::new();
        let case = mortar(&place, false, prescribed);
        for (form, folder) in [("factored", "out"), ("explicit", "numbers")] {
            assert_eq!(place.run(&format!("reduce case -o {folder} --form {form}")).code, 0);
        }
        let (whole, numbers) = (Whole::read(&place, "out"), Whole::read(&place, "numbers"));
        assert!(whole.blocks.len() > 1 && numbers.blocks.is_empty());
        let u_p = case.prescribed_values(&numbers.prescribed);
        let u_q: Vec<f64> = numbers.masters.iter().map(|&j| random(j as u64)).collect();
        let u = numbers.expand(&u_q, &u_p);
        let same = whole.expand(&whole.masters.iter().map(|&j| u[j]).collect::<Vec<_>>(), &u_p);
        let most = u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        for (j, (a, b)) in u.iter().zip(&same).enumerate() {
            assert!((a - b).abs() < 1e-10 * most, "DOF {j}: {a} and {b}");
        }
    }
}

#[test]
fn constants_and_transposed_products_follow_the_formulas_of_the_help() {
    let place = Place::new();
    let case = mortar(&place, true, true);
    assert_eq!(place.run("reduce case -o out --form factored").code, 0);
    let whole = Whole::read(&place, "out");
    assert!(!whole.blocks.is_empty());
    for block in &whole.blocks {
        let g = block.solve(&block.b);
        let sizes = block.slaves.iter().zip(&g).map(|(&j, g)| g.abs() * case.column_unit(j));
        let most = sizes.fold(1.0, f64::max);
        for (j, g) in block.slaves.iter().zip(g) {
            let i = whole.slaves.binary_search(j).expect("a slave");
            let off = (whole.g[i] - g).abs() * case.column_unit(*j);
            assert!(off < 1e-10 * most, "DOF {j}: {off} of {most}");
            assert!(whole.row_is_empty(i), "{j}");
        }
        // f . T x = x . T^T f
        let x: Vec<f64> = block.masters.iter().map(|&j| random(j as u64) / case.column_unit(j)).collect();
        let f: Vec<f64> = block.slaves.iter().map(|&j| random(j as u64) * case.column_unit(j)).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (one, other) = (dot(&f, &block.t_times(&x)), dot(&x, &block.transposed_times(&f)));
        assert!((one - other).abs() < 1e-9 * one.abs().max(1.0), "{one} and {other}");
    }
}

#[test]
fn no_factors_of_an_earlier_run_are_left() {
    let place = Place::new();
    mortar(&place, false, false);
    let names = || {
        let entries =
            fs::read_dir(place.path("out")).expect("a folder").map(|entry| entry.expect("readable").file_name());
        entries
            .filter_map(|name| name.into_string().ok())
            .filter(|name| name.starts_with("block"))
            .collect::<BTreeSet<_>>()
    };
    assert_eq!(place.run("reduce case -o out --form factored").code, 0);
    let blocks = Whole::read(&place, "out").blocks.len();
    assert_eq!(names().len(), 9 * blocks);
    place.file("out/block77_L.mtx", "mine").file("out/block1_notes.txt", "mine");
    assert_eq!(place.run("reduce case -o out --form factored").code, 0);
    assert_eq!(names().len(), 9 * blocks + 2);
    // What the user changed since is the user's.
    place.file("out/block1_b.txt", "mine");
    assert_eq!(place.run("reduce case -o out --form explicit").code, 0);
    assert!(names().iter().eq(["block1_b.txt", "block1_notes.txt", "block77_L.mtx"]), "{:?}", names());

    assert_eq!(place.run("reduce case -o default").code, 0);
    for file in ["T.mtx", "G.mtx", "g.txt", "slaves.txt", "masters.txt", "prescribed.txt"] {
        let bytes = |folder: &str| fs::read(place.path(folder).join(file)).expect(file);
        assert!(bytes("out") == bytes("default"), "{file}");
    }
}

#[test]
fn files_of_all_blocks_or_none_are_written() {
    let place = Place::new();
    mortar(&place, false, false);
    assert_eq!(place.run("reduce case -o out").code, 0);
    place.file("out/block1_U.mtx/in/the/way", "");
    let before = place.everything();
    let run = place.run("reduce case -o out --form factored");
    assert_eq!(run.code, 3, "{}", run.err);
    assert!(run.err.contains("block1_U.mtx") && run.err.contains("nothing was written"), "{}", run.err);
    assert!(place.everything() == before);
}

#[test]
fn auto_keeps_factors_where_they_are_worth_it_and_says_so() {
    let place = Place::new();
    // Windows overlap, so each slave depends on all masters.
    assert_eq!(place.run("generate windows --nx 30 --ny 30 -o case").code, 0);
    let text = place.run("reduce case -o out --form auto");
    assert_eq!(text.code, 0, "{}", text.err);
    let report = place.run("reduce case -o out --form auto --format json").json();
    let reduction = &report["reduction"];
    let (whole, listed) = (Whole::read(&place, "out"), reduction["factored"].as_array().expect("a list"));
    assert_eq!((&reduction["form"], listed.len()), (&json!("auto"), whole.blocks.len()));
    assert!(!listed.is_empty());
    for (listed, Factors { l, u, c_m, c_p, equations, slaves, masters, .. }) in listed.iter().zip(&whole.blocks) {
        // The ones of L are not counted.
        let nnz = [l, u, c_m, c_p].iter().map(|matrix| matrix.entries.len()).sum::<usize>() - l.rows;
        let predicted = listed["predicted"].as_u64().expect("a number");
        let sizes = [equations.len(), slaves.len(), masters.len()];
        let expected = json!({
            "equations": sizes[0], "slaves": sizes[1], "masters": sizes[2], "nnz": nnz, "predicted": predicted
        });
        assert_eq!(*listed, expected);
        assert!(predicted as usize > 4 * nnz && predicted as usize <= sizes[1] * sizes[2]);
        for said in [format!("{} equations", sizes[0]), format!("{nnz} numbers"), format!("about {predicted}")] {
            assert!(text.out.contains(&said), "{said}: {}", text.out);
        }
    }
    assert!(text.out.contains("lists of DOFs and factors to out"), "{}", text.out);
}

#[test]
fn auto_writes_t_alone_where_it_is_sparse() {
    let place = Place::new();
    assert_eq!(place.run("generate fssi --equations 1500 -o scene").code, 0);
    let run = place.run("reduce scene -o out --form auto");
    assert!(run.out.contains("No block stayed factored"), "{}", run.out);
    assert!(Whole::read(&place, "out").blocks.is_empty());
    assert_eq!(place.run("reduce scene -o default").code, 0);
    assert!(fs::read(place.path("out/T.mtx")).expect("T") == fs::read(place.path("default/T.mtx")).expect("T"));
    let reduction = |form: &str| place.run(&format!("reduce scene -o out --format json --form {form}")).json();
    for form in ["explicit", "auto"] {
        let reduction = &reduction(form)["reduction"];
        assert_eq!((&reduction["form"], &reduction["factored"]), (&json!(form), &json!([])));
    }
    assert_eq!(reduction("factored")["reduction"]["form"], "factored");
}

/// A component with preferred slaves is explicit.
#[test]
fn many_small_blocks_and_parts_with_wishes_keep_to_the_screen() {
    let place = Place::new();
    // Triples of equations on five DOFs of their own; a DOF of the last is prescribed, and so is one outside all equations.
    let entries: Vec<_> = (0..30)
        .flat_map(|k| {
            let (i, j) = (3 * k, 5 * k);
            let row = move |r: usize, values: [f64; 4]| (0..4).map(move |c| (i + r, j + 1 + (c + r) % 5, values[c]));
            row(1, [1.0, 2.0, -1.0, 0.5]).chain(row(2, [3.0, -1.0, 1.0, 1.0])).chain(row(3, [1.0, 1.0, 4.0, -2.0]))
        })
        .collect();
    let b: Vec<f64> = (0..90).map(|i| random(i as u64)).collect();
    place.case("many", [90, 151], &entries, &b, &[(150, 0.5), (151, 1.0)]);
    let run = place.run("reduce many -o out --form factored --prefer-slaves 1,2,151 --avoid-slaves 5 --keep 1-90");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.out.contains("Factored: 29 blocks") && run.out.contains("the largest:"), "{}", run.out);
    assert!(run.out.lines().count() <= 24 && run.out.lines().all(|line| line.chars().count() <= 100), "{}", run.out);
    let (whole, case) = (Whole::read(&place, "out"), Case::read(&place, "many"));
    assert_eq!((whole.blocks.len(), whole.t.entries.len() > 2), (29, true));
    let u_q: Vec<f64> = whole.masters.iter().map(|&j| random(j as u64)).collect();
    let u = whole.expand(&u_q, &[0.5, 1.0]);
    assert!(case.residual(&u) < 1e-10, "{:e}", case.residual(&u));
}
