//! A generated cube of 8 x 8 x 8 elements with naive periodic ties: of one material it deforms evenly, which is known exactly; with a soft
//! core the answer must not depend on the order of the equations, which decides which of them go and what the slaves are.

use qless::{Options, analyse};
use std::fmt::Write;

use super::solver::{cleaned, difference, is_there, parse, solve};

const N: usize = 8;
/// The mean displacement gradient: column k is the prescribed displacement of dummy node k.
const GRADIENT: [[f64; 3]; 3] = [[0.01, 0.004, 0.0], [0.0, -0.003, 0.0], [0.0, 0.002, -0.003]];

fn node(i: usize, j: usize, k: usize) -> usize {
    1 + i + (N + 1) * (j + (N + 1) * k)
}

/// Every node on a face with a positive normal, edges and corners included, is tied to its image on the opposite face.
fn ties() -> Vec<String> {
    let dummy = (N + 1) * (N + 1) * (N + 1);
    let mut ties = Vec::new();
    for axis in 0..3 {
        for (a, b) in (0..=N).flat_map(|a| (0..=N).map(move |b| (a, b))) {
            let at = |c: usize| match axis {
                0 => node(c, a, b),
                1 => node(a, c, b),
                _ => node(a, b, c),
            };
            let tie = |d| format!("3\n{},{d},1,{},{d},-1,{},{d},-1\n", at(N), at(0), dummy + 1 + axis);
            ties.extend((1..=3).map(tie));
        }
    }
    ties
}

fn deck(soft_core: bool, ties: &[String]) -> String {
    let mut text = String::from("*NODE, NSET=NALL\n");
    let side = (0..=N).flat_map(|k| (0..=N).flat_map(move |j| (0..=N).map(move |i| (i, j, k))));
    for (i, j, k) in side {
        let at = |c: usize| c as f64 / N as f64;
        writeln!(text, "{},{},{},{}", node(i, j, k), at(i), at(j), at(k)).expect("text");
    }
    let dummy = (N + 1) * (N + 1) * (N + 1);
    (1..=3).for_each(|axis| writeln!(text, "{},{},2.,2.", dummy + axis, 1 + axis).expect("text"));
    let mut elements = [String::new(), String::new()];
    for e in 0..N * N * N {
        let (i, j, k) = (e % N, e / N % N, e / N / N);
        let is_core = [i, j, k].iter().all(|c| (2..6).contains(c));
        let corner = |(a, b, c): (usize, usize, usize)| node(i + a, j + b, k + c).to_string();
        let below = [(0, 0), (1, 0), (1, 1), (0, 1)];
        let corners: Vec<String> = (0..2).flat_map(|c| below.map(|(a, b)| corner((a, b, c)))).collect();
        writeln!(elements[usize::from(is_core && soft_core)], "{},{}", e + 1, corners.join(",")).expect("text");
    }
    for (set, elements) in ["HARD", "SOFT"].iter().zip(&elements).filter(|(_, elements)| !elements.is_empty()) {
        let stiffness = if *set == "HARD" { 210_000.0 } else { 700.0 };
        write!(
            text,
            "*ELEMENT, TYPE=C3D8, ELSET={set}\n{elements}*MATERIAL, NAME=M{set}\n*ELASTIC\n{stiffness:.1},0.3\n"
        )
        .expect("text");
        writeln!(text, "*SOLID SECTION, ELSET={set}, MATERIAL=M{set}").expect("text");
    }
    write!(text, "*EQUATION\n{}*STEP\n*STATIC\n*BOUNDARY\n1,1,3\n", ties.concat()).expect("text");
    for (axis, column) in GRADIENT.iter().enumerate() {
        (0..3).for_each(|c| writeln!(text, "{},{c1},{c1},{}", dummy + 1 + axis, column[c], c1 = c + 1).expect("text"));
    }
    text + "*NODE PRINT, NSET=NALL\nU\n*END STEP\n"
}

/// Displacements in the order of the nodes.
fn displacements(printed: &[String]) -> Vec<[f64; 3]> {
    let start = printed.iter().position(|word| word == "1").expect("node 1");
    let row = |words: &[String]| [1, 2, 3].map(|c| words[c].parse().expect("a number"));
    printed[start..].chunks_exact(4).map(row).collect()
}

#[test]
fn an_even_cube_deforms_evenly() {
    let text = deck(false, &ties());
    let parsed = parse(text.as_bytes());
    let system = parsed.model().system(&parsed.model().cases()[0]).expect("a system");
    let analysis = analyse(&system, &Options::default()).expect("analysed");
    // Each of the (N+1)^3 images is tied to one of N^3, component by component: the corner at node 1 is prescribed.
    let rank = 3 * ((N + 1).pow(3) - N.pow(3));
    assert_eq!((system.equations(), analysis.rank()), (9 * (N + 1) * (N + 1), rank));
    if !is_there() {
        return;
    }
    assert!(solve(text.as_bytes()).is_none(), "ccx refuses the naive ties");
    let printed = solve(&cleaned(&parsed).expect("consistent")).expect("ccx solves the cleaned deck");
    let u = displacements(&printed);
    let largest = 0.02;
    for n in 0..(N + 1).pow(3) {
        let x = [n % (N + 1), n / (N + 1) % (N + 1), n / (N + 1) / (N + 1)].map(|c| c as f64 / N as f64);
        for c in 0..3 {
            let truth: f64 = (0..3).map(|axis| x[axis] * GRADIENT[axis][c]).sum();
            assert!((u[n][c] - truth).abs() <= 1e-7 * largest, "node {}: {} for {truth}", n + 1, u[n][c]);
        }
    }
}

#[test]
fn the_order_of_the_ties_does_not_matter() {
    if !is_there() {
        return;
    }
    let mut ties = ties();
    let answer = |ties: &[String]| {
        let text = cleaned(&parse(deck(true, ties).as_bytes())).expect("consistent");
        solve(&text).expect("ccx solves the cleaned deck")
    };
    let first = answer(&ties);
    ties.reverse();
    let second = answer(&ties);
    assert!(difference(&first, &second) <= 1e-6, "{:e}", difference(&first, &second));
}
