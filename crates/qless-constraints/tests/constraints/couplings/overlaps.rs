use qless_constraints::ConstraintSet;
use qless_constraints::types::{Average, BeamToSolid, LinearEquation, Node6, Section, SmallRigidBody};

use super::faces::square;
use super::{cloud, masked, node, svd_rank};
use crate::common::{Outcome, rank};

/// Bodies that share n nodes: six rigid motions less what the nodes see of them is what is said twice.
#[test]
fn overlaps_are_counted() -> Outcome {
    let places = cloud(9, 8, 2.0, [0.0; 3]);
    let solid = |i: usize| masked(places[i], 0b111);
    for (shared, twice) in [(1, 0), (2, 1), (3, 3), (4, 6)] {
        let mut builder = ConstraintSet::builder(48);
        let group = |first: usize| (2..2 + shared).map(solid).chain([solid(6 + first)]).collect::<Vec<_>>();
        builder.add("one", SmallRigidBody { reference: places[0], nodes: group(0) })?;
        builder.add("two", SmallRigidBody { reference: places[1], nodes: group(1) })?;
        let set = builder.build().expect("few DOFs");
        assert_eq!(set.equations() - svd_rank(&set), twice, "{shared}");
        assert_eq!(rank(&set, &[0.0; 48])?, set.equations() - twice, "{shared}");
    }
    // The mean of nodes of a rigid body moves as the body does: with its own node as the reference, all six are said twice.
    for (reference, twice) in [(0, 6), (1, 0)] {
        let mut builder = ConstraintSet::builder(48);
        let nodes: Vec<Node6> = (2..6).map(solid).collect();
        builder.add("rigid", SmallRigidBody { reference: places[0], nodes: nodes.clone() })?;
        let nodes = nodes.into_iter().map(|node| (node, 1.5)).collect();
        builder.add("mean", Average { reference: places[reference], nodes })?;
        let set = builder.build().expect("few DOFs");
        assert_eq!((set.equations() - svd_rank(&set), set.equations() - rank(&set, &[0.0; 48])?), (twice, twice));
    }
    // The same face held by two beams.
    let face = square(0, 12);
    for (sections, twice) in [
        ([Section::Rigid, Section::Rigid], 6),
        ([Section::Plane, Section::Plane], 1),
        ([Section::Rigid, Section::Mean], 0),
        ([Section::Mean, Section::Mean], 0),
    ] {
        let mut builder = ConstraintSet::builder(24);
        for (i, section) in sections.into_iter().enumerate() {
            let beam = node(i, [0.2, 0.4, 0.1 + i as f64]);
            builder.add("end", BeamToSolid { beam, face: face.clone(), section })?;
        }
        let set = builder.build().expect("few DOFs");
        let redundant = set.equations() - svd_rank(&set);
        assert_eq!((redundant, set.equations() - rank(&set, &[0.0; 24])?), (twice, twice), "{sections:?}");
    }
    Ok(())
}

/// Couplings and other constraints of the same nodes: what is said twice is found, what contradicts is too.
#[test]
fn supports_of_a_coupled_face_are_redundant() -> Outcome {
    let mut builder = ConstraintSet::builder(18);
    builder.add("end", BeamToSolid { beam: node(0, [0.5, 0.5, 0.0]), face: square(0, 6), section: Section::Plane })?;
    for dof in [8, 11, 14, 17] {
        builder.add("support", LinearEquation { terms: vec![(dof, 1.0)], rhs: 0.0 })?;
    }
    let set = builder.build().expect("few DOFs");
    // Four supports of a plane are one more than it takes.
    assert_eq!((set.equations(), svd_rank(&set), rank(&set, &[0.0; 18])?), (11, 10, 10));
    Ok(())
}
