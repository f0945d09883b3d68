use qless_constraints::types::{
    Average, BeamToSolid, Body, Node6, RigidBody, Section, ShellToSolid, SmallRigidBody, ThicknessLine,
};
use qless_constraints::{Constraint, ConstraintSet};

use super::faces::{SECTIONS, square};
use super::{cloud, dense, masked, node, only};

fn said<C: Constraint>(constraint: C) -> String {
    let mut builder = ConstraintSet::builder(60);
    let said = builder.add("it", constraint).map_or_else(|error| error.to_string(), |_| "accepted".to_owned());
    assert!(said == "accepted" || builder.build().expect("few DOFs").equations() == 0, "something of it is stored");
    said
}

/// What is said of these nodes under a reference that has the first six DOFs.
fn of_all(nodes: &[Node6]) -> [String; 3] {
    let reference = node(0, [0.1, 0.2, 0.3]);
    let body = Body::with_vector([0, 1, 2], reference.at, [3, 4, 5]);
    let weighted = nodes.iter().map(|&node| (node, 1.0)).collect();
    [
        said(SmallRigidBody { reference, nodes: nodes.to_vec() }),
        said(RigidBody { body, nodes: nodes.to_vec() }),
        said(Average { reference, nodes: weighted }),
    ]
}

/// One DOF for two things, whichever they are: at two nodes, as two components, at the reference.
#[test]
fn shared_dofs_are_refused() {
    for seed in 0..20 {
        let all = cloud(seed, 6, 1.0, [0.0; 3]);
        let nodes: Vec<Node6> = (1..6).map(|i| masked(all[i], 0b111)).collect();
        assert!(of_all(&nodes).iter().all(|said| said == "accepted"), "{:?}", of_all(&nodes));
        let (victim, component, other) = (seed % 5, seed % 3, (seed + 1 + seed % 3) % 5);
        for dof in [nodes[other].dofs[component], nodes[other].dofs[(component + 1) % 3], Some(seed % 6)] {
            let mut wrong = nodes.clone();
            wrong[victim].dofs[component] = dof;
            let words = format!("DOF {} of node", dof.unwrap_or_default());
            assert!(of_all(&wrong).iter().all(|said| said.contains(&words)), "{seed}: {:?}", of_all(&wrong));
        }
    }
}

/// A node given twice: rigid bodies say the same twice, an average has it with the sum of the weights.
#[test]
fn repeated_nodes_are_refused_or_weighted() {
    let all = cloud(3, 5, 1.0, [0.0; 3]);
    let nodes: Vec<Node6> = (1..5).map(|i| masked(all[i], 0b111)).collect();
    let twice = [&nodes[..], &nodes[..1]].concat();
    let [small, finite, average] = of_all(&twice);
    assert!(small.contains("DOF 6 of node 5") && finite.contains("DOF 6 of node 5"), "{small} {finite}");
    assert_eq!(average, "accepted");
    let of = |nodes: Vec<(Node6, f64)>| dense(&only(30, Average { reference: all[0], nodes }));
    let whole = of(nodes.iter().enumerate().map(|(i, &node)| (node, if i == 0 { 2.0 } else { 1.0 })).collect());
    let parts = of(twice.iter().map(|&node| (node, 1.0)).collect());
    let off = (0..6).flat_map(|i| (0..30).map(move |j| (i, j))).map(|at| (whole[at] - parts[at]).abs());
    assert!(off.fold(0.0, f64::max) < 1e-14);
    // In another place it is another node.
    let mut moved = twice;
    moved[4].at[1] += 1e-3;
    assert!(of_all(&moved).iter().all(|said| said.contains("DOF 6 of node 5")));
}

/// Two nodes of a face with one DOF; a mean takes a node that a mesh has twice, the others would say the same twice.
#[test]
fn faces_with_shared_dofs_are_refused() {
    for section in SECTIONS {
        let (mut face, beam) = (square(0, 6), node(0, [0.5, 0.5, 0.0]));
        face.nodes[2].dofs[1] = 7;
        let end = said(BeamToSolid { beam, face: face.clone(), section });
        assert!(end.contains("DOF 7 of node 3"), "{section:?}: {end}");
        let line = |i: usize, nodes: [usize; 2]| {
            let at = [i as f64, 0.5, 0.0];
            ThicknessLine {
                shell: Node6::new([40 + 6 * i, 41 + 6 * i, 42 + 6 * i], [43 + 6 * i, 44 + 6 * i, 45 + 6 * i], at),
                nodes: nodes.to_vec(),
            }
        };
        let lines = vec![line(0, [0, 3]), line(1, [1, 2])];
        let shell = said(ShellToSolid { lines: lines.clone(), face: face.clone(), section });
        assert!(shell.contains("line 2, from 1, names node 2 (from 0) with DOF 7"), "{section:?}: {shell}");
        face.nodes[2].dofs[1] = 13;
        // The shell node of one line on a solid node of another.
        let mut crossed = lines.clone();
        crossed[0].shell.dofs[4] = Some(13);
        let shell = said(ShellToSolid { lines: crossed, face: face.clone(), section });
        assert!(shell.contains("line 1, from 1, has a shell node"), "{section:?}: {shell}");
        assert_eq!(said(ShellToSolid { lines, face: face.clone(), section }), "accepted");
        let mut unmerged = face.clone();
        unmerged.nodes.push(face.nodes[1]);
        unmerged.faces = vec![triangle([0, 1, 2]), triangle([0, 2, 3])];
        let whole = said(BeamToSolid { beam, face: unmerged.clone(), section });
        assert_eq!(whole, "accepted");
        unmerged.faces = vec![triangle([0, 1, 2]), triangle([4, 2, 3])];
        unmerged.nodes[4].dofs = face.nodes[0].dofs;
        unmerged.nodes[4].at = face.nodes[0].at;
        let end = said(BeamToSolid { beam, face: unmerged, section });
        assert_eq!(end == "accepted", section == Section::Mean, "{end}");
    }
}

fn triangle(nodes: [usize; 3]) -> qless_constraints::types::Face {
    qless_constraints::types::Face::new(qless_constraints::types::Shape::Tri3, nodes)
}
