//! Prescribed rotations of shells and beams, which ccx holds by mean rotations of the solids that it expands them into, or in dynamic steps by
//! rigid sections.

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

/// ccx adds the given rotations of a node to one, takes its part in the plane of the shell, and holds it if at least two are given.
#[test]
fn prescribed_rotations_of_shells_hold_in_their_plane() {
    if !is_there() {
        return;
    }
    let mut rng = Rng::new(2);
    for k in 0..60 {
        let kind = ["S4", "S4R", "S8", "S8R"][k % 4];
        let axes = if k % 3 == 0 { global(&mut rng) } else { turned(&mut rng) };
        let missing = rng.below(4);
        let rotation = [0, 1, 2].map(|c| if c == missing { 0.0 } else { 1e-3 * rng.real() });
        let mut cards = "*BOUNDARY\n".to_owned();
        for c in (0..3).filter(|&c| c != missing) {
            writeln!(cards, "LAST,{0},{0},{1}", c + 4, rotation[c]).expect("text");
        }
        let text = strip(kind, axes, &cards, 0.0);
        assert_eq!(left_out(&text), None, "{text}");
        assert!(super::solver::parse(text.as_bytes()).model().warnings()[0].text.contains("in the plane of the shell"));
        // The strip bends to a circle: its end moves by half its length times the rotation.
        let expected: f64 = (0..3).map(|c| -2.0 * rotation[c] * axes[1][c]).sum();
        let u = Printed::run(&text).expect("solved").mean();
        let found: f64 = (0..3).map(|c| u[c] * axes[2][c]).sum();
        assert!((found - expected).abs() < 1e-8, "{kind} {axes:?}: {found} {expected}");
    }
}

/// ccx then prints huge displacements or stops.
#[test]
fn a_rotation_that_a_later_step_releases_leaves_the_deck_incomplete() {
    for (kind, has_value) in [("S4", true), ("S8", false), ("B31", true)] {
        let axes = global(&mut Rng::new(4));
        let value = if has_value { ",1e-3" } else { "" };
        let one = strip(kind, axes, "", 1e-3);
        let step = &one[one.find("*STEP").expect("a step")..];
        let first = one.replace("*CLOAD", &format!("*BOUNDARY\nLAST,4,6{value}\n*CLOAD"));
        let text = format!("{first}{}", step.replace("*CLOAD", "*BOUNDARY, OP=NEW\nFIRST,1,6\n*CLOAD"));
        assert_eq!(left_out(&format!("{first}{step}")), None);
        assert!(left_out(&text).is_some_and(|said| said.contains("equations of their own for rotations")), "{text}");
        assert!(!is_there() || Printed::run(&text).is_none_or(|printed| printed.last()[0].abs() > 1.0), "{text}");
    }
}

/// The deck with one dynamic step, which is slow.
fn dynamic(text: &str) -> String {
    let step = "*STEP, NLGEOM\n*DYNAMIC, DIRECT, ALPHA=0.\n1.,1.\n";
    text.replace("*STEP\n*STATIC\n", step).replace("1e6,0.\n", "1e6,0.\n*DENSITY\n1e-9\n")
}

#[test]
fn a_dynamic_step_holds_rotations_of_beams_and_clamps_of_shells() {
    if !is_there() {
        return;
    }
    let mut rng = Rng::new(3);
    for k in 0..72 {
        let kind = ["S3", "S4", "S4R", "S6", "S8", "B31", "B31R", "B32", "B32R"][k % 9];
        let axes = turned(&mut rng);
        let free = deflection(&dynamic(&strip(kind, axes, "", 1e-3)), axes).expect("solved");
        let held = deflection(&dynamic(&strip(kind, axes, "*BOUNDARY\nLAST,4,6\n", 1e-3)), axes).expect("solved");
        assert!((0.1..0.35).contains(&(held / free)), "{kind} {axes:?}: {held} {free}");
        // B31R also bends by modes that its reduced integration does not see.
        if kind.starts_with('B') && kind != "B31R" {
            let [x, y, z] = axes[1].map(|component| -1e-3 * component);
            let values = format!("*BOUNDARY\nLAST,4,4,{x}\nLAST,5,5,{y}\nLAST,6,6,{z}\n");
            let found = deflection(&dynamic(&strip(kind, axes, &values, 0.0)), axes).expect("solved");
            assert!((found - 2e-3).abs() < 1e-6, "{kind} {axes:?}: {found}");
        }
    }
    let axes = turned(&mut rng);
    let twice = |text: String| text.replace("*END STEP\n", "*END STEP\n*STEP\n*STATIC\n*END STEP\n");
    for text in [
        dynamic(&strip("S8", axes, "*BOUNDARY\nLAST,4,5\n", 1.0)),
        dynamic(&strip("S8", axes, "*BOUNDARY\nLAST,4,6,1e-3\n", 1.0)),
        dynamic(&strip("S8R", axes, "", 1.0)),
        twice(dynamic(&strip("B31", axes, "", 1.0))),
    ] {
        assert!(left_out(&text).is_some_and(|said| said.contains("equations of their own for rotations")), "{text}");
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
