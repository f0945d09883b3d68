//! Cyclic symmetry: the equations of the model hold in static steps of ccx, also if the sides have values and modes of a nodal diameter follow.

use std::f64::consts::TAU;
use std::fmt::Write;

use qless_scenes::Rng;

use super::loss::Printed;
use super::solver::{is_there, parse, solve};

/// A sector of two elements along the radius and two along the angle; node `1 + r + 3 a + 9 z` is at the steps r, a and z.
fn sector(rng: &mut Rng) -> String {
    let count = 3 + rng.below(20);
    let mut text = "*NODE, NSET=NALL\n".to_owned();
    for node in 0..18 {
        let (radius, angle) = (1.0 + f64::from(node % 3) / 2.0, TAU / count as f64 * f64::from(node / 3 % 3) / 2.0);
        writeln!(text, "{},{:.12},{:.12},{}", node + 1, radius * angle.cos(), radius * angle.sin(), node / 9)
            .expect("text");
    }
    text += "*ELEMENT, TYPE=C3D8, ELSET=E\n";
    for (number, k) in [(1, 1), (2, 2), (3, 4), (4, 5)] {
        let face = [k, k + 1, k + 4, k + 3];
        let nodes: Vec<String> = face.iter().chain(&face.map(|node| node + 9)).map(i32::to_string).collect();
        writeln!(text, "{number},{}", nodes.join(",")).expect("text");
    }
    text +=
        "*SURFACE, NAME=FIRST, TYPE=NODE\n1\n2\n3\n10\n11\n12\n*SURFACE, NAME=LAST, TYPE=NODE\n7\n8\n9\n16\n17\n18\n";
    let sides = if rng.below(2) == 0 { "FIRST,LAST" } else { "LAST,FIRST" };
    let axes = if rng.below(2) == 0 { "*TRANSFORM, NSET=NALL, TYPE=C\n0.,0.,0.,0.,0.,1.\n" } else { "" };
    format!(
        "{text}{axes}*TIE, NAME=T, CYCLIC SYMMETRY\n{sides}\n*CYCLIC SYMMETRY MODEL, N={count}, NGRAPH=1, TIE=T\n0.,0.,0.,0.,0.,1.\n\
         *MATERIAL, NAME=M\n*ELASTIC\n1000.,.3\n*DENSITY\n1e-3\n*SOLID SECTION, ELSET=E, MATERIAL=M\n*BOUNDARY\n5,1,3\n"
    )
}

#[test]
fn values_at_the_sides_belong_to_static_steps() {
    if !is_there() {
        return;
    }
    let mut rng = Rng::new(1);
    for _ in 0..24 {
        let head = sector(&mut rng);
        let master = if head.contains("FIRST,LAST") { 8 } else { 2 };
        let loads = format!("11,1,{}\n11,2,{}\n14,3,{}\n", rng.real(), rng.real(), rng.real());
        let step = format!(
            "*STEP\n*STATIC\n*BOUNDARY\n{master},1,1,.01\n*CLOAD\n{loads}*NODE PRINT, NSET=NALL\nU\n*END STEP\n"
        );
        let modes = "*STEP, PERTURBATION\n*FREQUENCY\n2\n*SELECT CYCLIC SYMMETRY MODES, NMIN=1, NMAX=1\n*END STEP\n";
        let text = format!("{head}{step}{modes}");
        let deck = parse(text.as_bytes());
        let model = deck.model();
        assert_eq!((model.equations(), model.left_out().count()), (18, 0), "{:?}", model.warnings());
        let printed = Printed::run(&format!("{head}{step}")).unwrap_or_else(|| panic!("ccx stops:\n{text}"));
        let broken: Vec<usize> = (0..18).filter(|&i| !printed.holds(model, i)).collect();
        assert!(broken.is_empty(), "{broken:?}\n{text}");
        assert!(solve(text.as_bytes()).is_some(), "ccx stops:\n{text}");
    }
}
