//! Compares the reader with runs of ccx: the displacements must fulfil the model's equations, and free DOFs must be free.

use std::process::{Command, Stdio};

use qless_io::deck::{Dof, Model, Solver::Ccx};

use super::from_text::{BRICK, model};

const ELASTIC: &str = "*MATERIAL, NAME=M\n*ELASTIC\n1000.,.3\n*SOLID SECTION, ELSET=E, MATERIAL=M\n*BOUNDARY\n1,1,3\n2,1,3\n3,1,3\n4,1,3\n";

/// Whether `ccx` is installed; it must be if the corpus is.
pub fn is_there() -> bool {
    let there = Command::new("ccx").arg("-v").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    assert!(there || std::env::var_os("QLESS_CORPUS").is_none(), "install calculix-ccx");
    if !there {
        eprintln!("SKIPPED: ccx is not installed: nothing to run");
    }
    there
}

pub fn deck(cards: &str, steps: &[&str]) -> String {
    let step = |cards: &&str| format!("*STEP\n*STATIC\n{cards}*NODE PRINT, NSET=NALL\nU\n*END STEP\n");
    format!("{BRICK}{ELASTIC}{cards}{}", steps.iter().map(step).collect::<String>())
}

/// Displacements by step and node, 1 to 10; `None` if ccx stops.
pub fn solve(text: &str) -> Option<Vec<Vec<[f64; 3]>>> {
    let place = tempfile::tempdir().expect("a folder");
    std::fs::write(place.path().join("deck.inp"), text).expect("written");
    let mut ccx = Command::new("ccx");
    ccx.args(["-i", "deck"]).current_dir(place.path()).stdout(Stdio::null()).stderr(Stdio::null());
    let status = ccx.env("OMP_NUM_THREADS", "1").status().expect("ccx runs");
    let printed = std::fs::read_to_string(place.path().join("deck.dat")).unwrap_or_default();
    let rows = printed.lines().filter_map(|line| {
        // L: along the node's local axes.
        let numbers: Vec<f64> =
            line.trim_end_matches('L').split_whitespace().map(str::parse).collect::<Result<_, _>>().ok()?;
        if let [_, x, y, z] = numbers[..] { Some([x, y, z]) } else { None }
    });
    let rows: Vec<[f64; 3]> = rows.collect();
    status.success().then(|| rows.chunks(10).map(<[_]>::to_vec).collect())
}

fn value(u: &[[f64; 3]], dof: Dof) -> f64 {
    u[dof.node as usize - 1][usize::from(dof.component) - 1]
}

/// Checks the prescribed values and all equations in force against the output of ccx. Free DOFs that it does not print
/// (rotations) are skipped.
fn holds(model: &Model, steps: &[Vec<[f64; 3]>]) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    let known = |dof: Dof| dof.component <= 3 && dof.node <= 10;
    assert_eq!(model.cases().len(), steps.len());
    model.cases().iter().zip(steps).all(|(case, u)| {
        let given = case.prescribed.iter().all(|given| !known(given.dof) || near(value(u, given.dof), given.value));
        let is_given = |dof: &Dof| case.prescribed.iter().find(|given| given.dof == *dof).map(|given| given.value);
        let equations = model.in_force(case).all(|i| {
            let equation = model.equation(i).expect("an equation");
            let dofs: Vec<Dof> = equation.columns.iter().map(|&j| model.dofs()[j as usize]).collect();
            let value = |dof: &Dof| is_given(dof).unwrap_or_else(|| value(u, *dof));
            let sum = || dofs.iter().zip(equation.coefficients).map(|(dof, a)| a * value(dof)).sum::<f64>();
            !dofs.iter().all(|dof| known(*dof) || is_given(dof).is_some()) || near(sum(), equation.rhs)
        });
        given && equations
    })
}

#[test]
fn every_step_holds_in_ccx_what_the_model_says() {
    if !is_there() {
        return;
    }
    let held = "1,1,3\n2,1,3\n3,1,3\n4,1,3\n";
    let new = format!("*BOUNDARY, OP=NEW\n{held}6,3,3,.2\n");
    let late = format!("*BOUNDARY\n6,3,3,.2\n*BOUNDARY, OP=NEW\n{held}7,3,3,.3\n");
    let tied = "*EQUATION\n2\n5,3,1.,6,3,-1.\n2\n7,3,1.,6,3,-1.\n";
    let load = "*CLOAD\n5,3,1.\n";
    for (cards, steps) in [
        ("*BOUNDARY\n5,3,3,.1\n", vec![new.as_str()]),
        ("", vec!["*BOUNDARY\n5,3,3,.1\n", &new]),
        ("", vec!["*BOUNDARY\n5,3,3,.1\n", &late]),
        ("*BOUNDARY\n5,3,3,.1\n", vec!["*BOUNDARY\n5,3,3,.3\n", "*BOUNDARY\n5,3,3,.4\n"]),
        (tied, vec![load, "*EQUATION, REMOVE\n5,3\n", "*BOUNDARY\n5,1\n"]),
        (tied, vec![load, "*EQUATION, REMOVE ALL\n"]),
        (&tied.replace('*', " \t*"), vec![" *CLOAD\n5,3,1.\n  ** a comment\n  *BOUNDARY\n6,3,3,.2\n"]),
        (
            "*COUPLING, REF NODE=9, SURFACE=STOP, CONSTRAINT NAME=C\n*DISTRIBUTING\n1,3\n*BOUNDARY\n9,3,3,.1\n",
            vec![load],
        ),
        ("*RIGID BODY, REF NODE=9, TIE NSET=TOP\n", vec![load]),
        ("*ELEMENT, TYPE=DCOUP3D, ELSET=D\n2,9\n*DISTRIBUTING COUPLING, ELSET=D\nTOP,1.\n", vec![load]),
    ] {
        let text = deck(cards, &steps);
        let printed = solve(&text).unwrap_or_else(|| panic!("ccx stops:\n{text}"));
        assert!(holds(&model(Ccx, &text), &printed), "{cards}{steps:?}\n{printed:?}");
    }
}

#[test]
fn what_ccx_does_not_constrain_moves_freely() {
    if !is_there() {
        return;
    }
    let load = "*CLOAD\n5,3,1.\n";
    let free = solve(&deck("", &[load])).expect("solved");
    for cards in [
        "*COUPLING, REF NODE=9, SURFACE=STOP, CONSTRAINT NAME=C\n*DISTRIBUTING\n1,3\n*BOUNDARY\n9,3,3,.1\n",
        "*COUPLING, REF NODE=9, SURFACE=STOP, CONSTRAINT NAME=C\n*KINEMATIC\n",
        "*RIGID BODY, REF NODE=9, TIE NSET=TOP\n",
        "*RIGID BODY, REF NODE=9, ANALYTICAL SURFACE=STOP\n",
    ] {
        let text = deck(cards, &[load]);
        assert_eq!(model(Ccx, &text).equations(), 0, "{cards}");
        assert_eq!(solve(&text).expect("solved")[0][..8], free[0][..8], "{cards}");
    }
    // If ccx makes the reference itself, the top stays plane too.
    let rigid = solve(&deck("*RIGID BODY, NSET=TOP\n", &[load])).expect("solved");
    let z = |node: usize| rigid[0][node - 1][2];
    assert!((z(5) + z(7) - z(6) - z(8)).abs() < 1e-8 && (z(5) - z(7)).abs() > 1e-4);
}

#[test]
fn a_mean_rotation_is_the_one_that_ccx_prescribes() {
    if !is_there() {
        return;
    }
    // Node 10 gives the axis, so that its position does not matter; its first DOF is the rotation.
    let cards = "*NODE\n10,0.,0.,3.\n*MPC\nMEANROT,5,5,5,6,6,6,7,7,7,8,8,8,10\n*BOUNDARY\n10,1,1,1e-3\n";
    let text = deck(cards, &["*CLOAD\n5,3,.1\n"]);
    let printed = solve(&text).expect("solved");
    let model = model(Ccx, &text);
    assert_eq!(model.equations(), 1);
    assert!(holds(&model, &printed), "{printed:?}");
    assert!(printed[0][4][0].abs() > 1e-5, "the top turns");
}

#[test]
fn a_sector_repeats_itself_in_ccx() {
    if !is_there() {
        return;
    }
    let cards = "*NODE, NSET=NALL\n1,1.,0.,0.\n2,2.,0.,0.\n3,2.,0.,1.\n4,1.,0.,1.\n5,0.,1.,0.\n6,0.,2.,0.\n7,0.,2.,1.\n8,0.,1.,1.\n9,9.,9.,9.\n10,9.,9.,8.
*ELEMENT, TYPE=C3D8, ELSET=E\n1,1,2,6,5,4,3,7,8
*SURFACE, NAME=FIRST, TYPE=NODE\n1,\n2,\n3,\n4,\n*SURFACE, NAME=SECOND, TYPE=NODE\n5,\n6,\n7,\n8,
*MATERIAL, NAME=M\n*ELASTIC\n1000.,.3\n*SOLID SECTION, ELSET=E, MATERIAL=M
*TIE, NAME=T, CYCLIC SYMMETRY\nFIRST,SECOND\n*CYCLIC SYMMETRY MODEL, N=4, NGRAPH=1, TIE=T\n0.,0.,0.,0.,0.,1.
*BOUNDARY\n5,1,3\n8,1,2\n*STEP\n*STATIC\n*CLOAD\n6,1,1.\n7,3,.5\n*NODE PRINT, NSET=NALL\nU\n*END STEP\n";
    let printed = solve(cards).expect("solved");
    let model = model(Ccx, cards);
    assert_eq!(model.equations(), 12);
    assert!(holds(&model, &printed), "{printed:?}");
    assert!(printed[0][1].iter().any(|x| x.abs() > 1e-5), "it moves");
}

#[test]
fn a_kinematic_coupling_acts_along_its_orientation_or_the_basic_axes_in_ccx() {
    if !is_there() {
        return;
    }
    let axes = "1.,1.,0.,-1.,1.,0.\n";
    let turned = format!("*NSET, NSET=NT\n6\n*TRANSFORM, NSET=NT, TYPE=R\n{axes}");
    let oriented = format!("*ORIENTATION, NAME=O\n{axes}");
    // The second line turns the axes further, about one of them, by an angle in degrees.
    let mut further = ["3,90.", "1,30.", "2,-20.", ",90.", "4,90."].map(|line| format!("{oriented}{line}\n")).to_vec();
    // ccx knows no origin c, and takes all axes but cylindrical ones as rectangular.
    further.push(oriented.replace("0.\n", "0.,1.,2.,3.\n"));
    further.extend(["SPHERICAL", "Z RECTANGULAR"].map(|kind| oriented.replace("=O", &format!("=O, SYSTEM={kind}"))));
    for transform in ["", turned.as_str()] {
        let orientations = further.iter().chain([&oriented]).map(|card| (card.as_str(), ", ORIENTATION=O"));
        for (orientation, parameter) in orientations.chain([("", "")]) {
            for (components, count) in [("1,1", 4), ("1,2", 8), ("2,3", 8), ("1,3", 12)] {
                let cards = format!(
                    "{transform}{orientation}*COUPLING, REF NODE=9, SURFACE=STOP, CONSTRAINT NAME=C{parameter}\n*KINEMATIC\n{components}\n*BOUNDARY\n9,1,1,.1\n9,2,6\n"
                );
                let text = deck(&cards, &["*CLOAD\n7,2,3.\n7,3,5.\n"]);
                let printed = solve(&text).unwrap_or_else(|| panic!("ccx stops:\n{text}"));
                let model = model(Ccx, &text);
                assert!(holds(&model, &printed), "{cards}\n{printed:?}");
                // No slave occurs twice if ccx finds one for each equation.
                let slave = |i| model.dofs()[model.equation(i).expect("an equation").columns[0] as usize];
                let slaves: std::collections::BTreeSet<Dof> = (0..model.equations()).map(slave).collect();
                assert_eq!((model.equations(), slaves.len()), (count, count), "{cards}");
            }
        }
    }
}

#[test]
fn the_rotation_of_a_reference_does_nothing_in_ccx() {
    if !is_there() {
        return;
    }
    for body in ["*RIGID BODY, NSET=TOP, REF NODE=9\n", "*RIGID BODY, NSET=TOP, REF NODE=9, ROT NODE=10\n"] {
        let free = solve(&deck(body, &["*CLOAD\n5,1,1.\n"])).expect("solved");
        for idle in ["*BOUNDARY\n9,6,6,.1\n", "*CLOAD\n9,6,9.\n"] {
            let text = deck(body, &[&format!("*CLOAD\n5,1,1.\n{idle}")]);
            assert_eq!(solve(&text).expect("solved"), free, "{body}{idle}");
            assert!(super::from_text::warnings(&model(Ccx, &text)).contains("9:6 has no effect"), "{body}{idle}");
        }
    }
}

#[test]
fn no_slave_is_written_at_a_node_with_axes_of_its_own_that_is_prescribed() {
    if !is_there() {
        return;
    }
    let turned = "*NSET, NSET=NT\n6\n*TRANSFORM, NSET=NT, TYPE=R\n1.,1.,0.,-1.,1.,0.\n";
    let load = "*CLOAD\n7,2,3.\n7,3,5.\n";
    let whole = |terms: &str| deck(&format!("{turned}*BOUNDARY\n6,1,1,.01\n*EQUATION\n3\n{terms}\n"), &[load]);
    // Along the global axes, one of its components at node 6 has no coefficient.
    assert!(solve(&whole("6,2,1.,7,2,-1.,6,1,-1.")).is_none());
    let expected = solve(&whole("7,2,1.,6,2,-1.,6,1,1.")).expect("solved");
    for terms in ["6,1,-1.,6,2,1.,7,2,-1.", "6,1,-1.,6,2,1.,7,2,-1.\n3\n6,1,-2.,6,2,2.,7,2,-2."] {
        let text = whole(terms);
        let deck = super::from_text::parsed(Ccx, &text).expect("read");
        let plan = qless_io::deck::clean::plan(&deck, &qless::Options::default()).expect("a plan");
        let cleaned = qless_io::deck::clean::write(&deck, &plan).expect("written");
        let cleaned = String::from_utf8(cleaned).expect("text");
        let printed = solve(&cleaned).unwrap_or_else(|| panic!("ccx stops:\n{cleaned}"));
        assert_eq!(plan.written.iter().map(|one| one.slave.node).collect::<Vec<_>>(), [7]);
        let far = |(a, b): (&[f64; 3], &[f64; 3])| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1e-6);
        assert!(!printed[0].iter().zip(&expected[0]).any(far), "{printed:?}\n{expected:?}");
    }
}

#[test]
fn slaves_at_nodes_with_axes_of_their_own_are_those_that_ccx_can_take() {
    if !is_there() {
        return;
    }
    let cleaned = |turned: &str| {
        let coupling = "*COUPLING, REF NODE=9, SURFACE=STOP, CONSTRAINT NAME=C\n*KINEMATIC\n1,2\n";
        let held = "*BOUNDARY\n5,1,1,.02\n9,1,1,.015\n9,2,2,.01\n8,3,3,.01\n";
        let text = deck(&format!("{turned}{coupling}{held}"), &["*CLOAD\n8,2,3.\n5,3,5.\n"]);
        let deck = super::from_text::parsed(Ccx, &text).expect("read");
        let plan = qless_io::deck::clean::plan(&deck, &qless::Options::default()).expect("a plan");
        assert!(plan.written.len() > 4, "{plan:?}");
        let cleaned = qless_io::deck::clean::write(&deck, &plan).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let cleaned = String::from_utf8(cleaned).expect("text");
        solve(&cleaned).unwrap_or_else(|| panic!("ccx stops:\n{cleaned}"))
    };
    let expected = cleaned("");
    assert!(expected[0][6].iter().all(|x| x.abs() > 1e-6), "it moves: {expected:?}");
    for turn in 0..24 {
        let at = |k: i32| f64::from((turn * 37 + k * 61) % 100) / 50.0 - 0.99;
        let axes: Vec<String> = (0..6).map(|k| at(k).to_string()).collect();
        let turned = format!("*NSET, NSET=NT\n6,7\n*TRANSFORM, NSET=NT, TYPE=R\n{}\n", axes.join(","));
        let found = cleaned(&turned);
        // Nodes with local axes are printed along these.
        for node in [4, 7] {
            let far = (0..3).any(|k| (found[0][node][k] - expected[0][node][k]).abs() > 1e-6);
            assert!(!far, "{turned}\n{found:?}\n{expected:?}");
        }
    }
}
