//! Prescribed rotations of shells and beams, which ccx holds by mean rotations of the solids that it expands them into.

use std::fmt::Write;

use qless_scenes::Rng;

use super::expanded::{SHELL, left_out};
use super::loss::Printed;
use super::solver::is_there;

/// A strip of four elements along the first of `axes`, clamped at its first edge, with cards for its last edge `LAST`.
fn strip(kind: &str, axes: [[f64; 3]; 3], cards: &str, force: f64) -> String {
    let order = if kind.starts_with("B32") || kind.contains(['6', '8']) { 2 } else { 1 };
    let width = if kind.starts_with('B') { 0 } else { order };
    let (mut text, node) = ("*NODE, NSET=NALL\n".to_owned(), |i: usize, j: usize| 1 + i + 100 * j);
    let ends = |i| (0..=width).map(|j| node(i, j).to_string()).collect::<Vec<_>>().join("\n");
    for (i, j) in (0..=4 * order)
        .flat_map(|i| (0..=width).map(move |j| (i, j)))
        .filter(|(i, j)| order == 1 || width == 0 || i % 2 + j % 2 < 2 || kind.contains('6'))
    {
        let [x, y] = [i, j].map(|k| k as f64 / order as f64);
        let [a, b, c] = [0, 1, 2].map(|k| x * axes[0][k] + y * axes[1][k]);
        writeln!(text, "{},{a},{b},{c}", node(i, j)).expect("text");
    }
    writeln!(
        text,
        "*NSET, NSET=FIRST\n{}\n*NSET, NSET=LAST\n{}\n*ELEMENT, TYPE={kind}, ELSET=E",
        ends(0),
        ends(4 * order)
    )
    .expect("text");
    for e in 0..4 {
        let at = |i: usize, j: usize| node(e * order + i, j);
        let elements: Vec<Vec<usize>> = match (width, order, kind.contains(['3', '6'])) {
            (0, 1, _) => vec![vec![at(0, 0), at(1, 0)]],
            (0, ..) => vec![vec![at(0, 0), at(1, 0), at(2, 0)]],
            (_, 1, false) => vec![vec![at(0, 0), at(1, 0), at(1, 1), at(0, 1)]],
            (_, 1, true) => vec![vec![at(0, 0), at(1, 0), at(1, 1)], vec![at(0, 0), at(1, 1), at(0, 1)]],
            (_, _, false) => vec![vec![at(0, 0), at(2, 0), at(2, 2), at(0, 2), at(1, 0), at(2, 1), at(1, 2), at(0, 1)]],
            _ => vec![
                vec![at(0, 0), at(2, 0), at(2, 2), at(1, 0), at(2, 1), at(1, 1)],
                vec![at(0, 0), at(2, 2), at(0, 2), at(1, 1), at(1, 2), at(0, 1)],
            ],
        };
        for (k, nodes) in elements.iter().enumerate() {
            let nodes: Vec<String> = nodes.iter().map(usize::to_string).collect();
            writeln!(text, "{},{}", 10 * e + k + 1, nodes.join(",")).expect("text");
        }
    }
    let section = if width == 0 {
        let [a, b, c] = axes[1];
        format!("*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT\n.2,.1\n{a},{b},{c}\n")
    } else {
        SHELL.to_owned()
    };
    let [x, y, z] = axes[2].map(|component| force * component);
    let loads = format!("LAST,1,{x}\nLAST,2,{y}\nLAST,3,{z}\n");
    format!(
        "{text}*MATERIAL, NAME=M\n*ELASTIC\n1e6,0.\n{section}*BOUNDARY\nFIRST,1,6\n{cards}*STEP\n*STATIC\n*CLOAD\n{loads}*NODE PRINT, NSET=LAST\nU\n\
         *END STEP\n"
    )
}

/// The motion of the last edge along the third axis. `None` if ccx stops.
fn deflection(text: &str, axes: [[f64; 3]; 3]) -> Option<f64> {
    assert_eq!(left_out(text), None, "{text}");
    let u = Printed::run(text)?.first();
    Some((0..3).map(|k| u[k] * axes[2][k]).sum())
}

/// A strip whose last edge keeps its direction is about four times as stiff, as far as its elements do not lock; a beam of length 4 with a rotation at its end moves by twice that.
#[test]
fn prescribed_rotations_of_shells_and_of_beams_along_an_axis_hold() {
    if !is_there() {
        return;
    }
    let mut rng = Rng::new(1);
    for k in 0..100 {
        let kind = ["S3", "S4", "S4R", "S6", "S8", "S8R", "B31", "B31R", "B32", "B32R"][k % 10];
        let is_beam = kind.starts_with('B');
        let axes = if is_beam || k % 3 == 0 { global(&mut rng) } else { turned(&mut rng) };
        let free = deflection(&strip(kind, axes, "", 1e-3), axes).expect("solved");
        let held = deflection(&strip(kind, axes, "*BOUNDARY\nLAST,4,6\n", 1e-3), axes).expect("solved");
        assert!((0.15..0.35).contains(&(held / free)), "{kind} {axes:?}: {held} {free}");
        if is_beam {
            // The third axis turns to the first for a positive rotation about the second.
            let [x, y, z] = axes[1].map(|component| -1e-3 * component);
            let values = format!("LAST,4,4,{x}\nLAST,5,5,{y}\nLAST,6,6,{z}\n");
            let text = strip(kind, axes, &format!("*BOUNDARY\n{values}"), 0.0);
            let found = deflection(&text, axes).expect("solved");
            assert!((found - 2e-3).abs() < 1e-4, "{kind} {axes:?}: {found}");
        }
    }
}

/// Three of the global axes in any order and direction, as a right-handed system.
fn global(rng: &mut Rng) -> [[f64; 3]; 3] {
    let (first, next, sign) = (rng.below(3), 1 + rng.below(2), if rng.below(2) == 0 { 1.0 } else { -1.0 });
    let (mut a, mut b) = ([0.0; 3], [0.0; 3]);
    (a[first], b[(first + next) % 3]) = (sign, 1.0);
    [a, b, cross(a, b)]
}

fn turned(rng: &mut Rng) -> [[f64; 3]; 3] {
    let [a, b] = [0, 1].map(|_| [0, 1, 2].map(|_| rng.real()));
    let unit = |v: [f64; 3]| v.map(|x| x / v.iter().map(|x| x * x).sum::<f64>().sqrt());
    let (first, last) = (unit(a), unit(cross(a, b)));
    [first, cross(last, first), last]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [1, 2, 0].map(|k| a[k] * b[(k + 1) % 3] - a[(k + 1) % 3] * b[k])
}
