use std::array::from_fn;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Average, Component, CouplingError, Node6, Point};

use super::{cross, dense, frame, masked, node, only, relative_residual, rigid, svd_rank};
use crate::common::random;

/// Why the average of these nodes is refused.
fn refusal(reference: Node6, nodes: &[Node6]) -> Option<CouplingError> {
    let mut builder = ConstraintSet::builder(60);
    let nodes = nodes.iter().map(|&node| (node, 1.0)).collect();
    match builder.add("it", Average { reference, nodes }) {
        Ok(_) => None,
        Err(qless_constraints::AddError::Input { source, .. }) => Some(source),
        Err(error) => panic!("{error}"),
    }
}

/// Nodes in a line in any direction, place and unit: rotations are refused, and the motion named is that about the line; what the
/// line does see follows; one node that sees rotations is enough.
#[test]
fn lines_do_not_see_their_own_rotation() {
    for (seed, count) in (0..20).flat_map(|seed| [2, 3, 7].map(|count| (seed, count))) {
        for (scale, far) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e6)] {
            let axes = frame(seed);
            let on = |s: f64| from_fn(|k| far * [1.0, -2.0, 0.5][k] + scale * s * axes[0][k]);
            let nodes: Vec<Node6> = (0..count).map(|i| masked(node(i + 1, on(i as f64 + random(i))), 0b111)).collect();
            let reference = node(0, on(0.77));
            for component in 3..6 {
                let Some(CouplingError::Undetermined { component: named, rotation, translation }) =
                    refusal(masked(reference, 1 << component), &nodes)
                else {
                    panic!("{seed} {count} {scale} {far}: accepted or refused for another reason")
                };
                assert_eq!(named as usize, component);
                // Far away the direction of the line is that of rounded coordinates.
                let tolerance = 1e-12 + 1e-14 * far;
                assert!(cross(rotation, axes[0]).iter().all(|x| x.abs() < tolerance), "{rotation:?} {:?}", axes[0]);
                assert!(translation.iter().all(|x| x.abs() < 1e-7), "{translation:?}");
            }
            assert_eq!(refusal(masked(reference, 0b111), &nodes), None, "{seed} {count} {scale} {far}");
            // Beside the line, translations across it and the line's offset are not seen either.
            let beside = Node6 { at: from_fn(|k| reference.at[k] + 0.3 * scale * axes[1][k]), ..reference };
            assert!(refusal(masked(beside, 0b111), &nodes).is_some());
            let mut seeing = nodes.clone();
            seeing[1] = node(2, nodes[1].at);
            assert_eq!(refusal(beside, &seeing), None);
        }
    }
}

/// Along an axis all but the rotation about it follow; nodes in one place and single nodes tell their translations.
#[test]
fn what_is_left_follows() {
    let nodes = [0.0, 1.0, 3.0].map(|x| masked(node(1 + x as usize, [x + 0.1, 0.7, -0.2]), 0b111));
    let reference = node(0, [2.1, 0.7, -0.2]);
    let rest = Component::ALL.into_iter().filter(|&component| component != Component::TurnX);
    let weighted = nodes.iter().map(|&node| (node, 2.0)).collect();
    let set = only(30, Average { reference: reference.only(rest), nodes: weighted });
    assert_eq!((set.equations(), svd_rank(&set)), (5, 5));
    // theta_z = sum (x - x_mean) v / sum (x - x_mean)^2, with x - x_mean = -4/3, -1/3, 5/3.
    let g = dense(&set);
    for (first, a) in [(6, -4.0 / 14.0), (12, -1.0 / 14.0), (24, 5.0 / 14.0)] {
        assert!((g[(4, first + 1)] + a).abs() < 1e-15 && (g[(3, first + 2)] - a).abs() < 1e-15, "{g:?}");
    }
    let one = [masked(node(1, [5.0, 6.0, 7.0]), 0b111)];
    let (here, there) = (node(0, one[0].at), node(0, [5.0, 6.0, 8.0]));
    assert_eq!(refusal(masked(here, 0b111), &one), None);
    assert_eq!(refusal(masked(there, 0b100), &one), None);
    assert!(refusal(masked(here, 0b1000), &one).is_some() && refusal(masked(there, 1), &one).is_some());
    let whole = [node(1, one[0].at)];
    assert_eq!(refusal(there, &whole), None);
    let set = only(12, Average { reference: there, nodes: vec![(whole[0], 0.1)] });
    assert!(relative_residual(&set, &rigid(12, &[there, whole[0]], [1.0, 2.0, 3.0], [0.1, 0.2, -0.3])) < 1e-14);
    // A group that is only seen along x tells no y.
    let flat = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let flat: Vec<Node6> = (0..3).map(|i| masked(node(i + 1, flat[i]), 1)).collect();
    assert!(matches!(
        refusal(masked(node(0, [0.0; 3]), 2), &flat),
        Some(CouplingError::Undetermined { component: Component::Y, .. })
    ));
}

/// A thin triangle is one as long as it is not rounding; the nearer to a line, the larger the factors.
#[test]
fn thin_groups_are_seen_until_rounding() {
    let group = |breadth: f64, far: f64| {
        let at = [[0.0, 0.0], [1.0, 0.0], [0.4, breadth]];
        let place = |i: usize| [far + at[i][0], far + at[i][1], far];
        let nodes: Vec<Node6> = (0..3).map(|i| masked(node(i + 1, place(i)), 0b111)).collect();
        refusal(masked(node(0, [far + 0.5, far, far]), 0b1000), &nodes)
    };
    for exponent in 0..7 {
        assert_eq!(group(10.0_f64.powi(-exponent), 0.0), None, "1e-{exponent}");
    }
    assert!(group(1e-10, 0.0).is_some() && group(0.0, 0.0).is_some());
    // Coordinates of 1e9 have units in the last place of 1e-7.
    assert!(group(1e-6, 1e9).is_some() && group(1e-1, 1e9).is_none());
}

/// A light node beside a line tells the rotation about it as long as its weight is not rounding of the others'.
#[test]
fn light_nodes_count_until_rounding() {
    let refused = |weight: f64| {
        let at = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.4, 1.0, 0.0]];
        let nodes = (0..3).map(|i| (masked(node(i + 1, at[i]), 0b111), if i == 2 { weight } else { 1.0 })).collect();
        let mut builder = ConstraintSet::builder(24);
        builder.add("it", Average { reference: masked(node(0, [0.5, 0.0, 0.0]), 0b1000), nodes }).is_err()
    };
    assert!(!refused(1.0) && !refused(1e-6) && !refused(1e-12) && refused(1e-24));
}

#[test]
fn nodes_have_dofs_of_their_own() {
    let (reference, other) = (node(0, [0.0; 3]), node(1, [1.0, 0.0, 0.0]));
    let shared = Node6 { dofs: [Some(6), Some(2), None, None, None, None], ..other };
    assert_eq!(refusal(reference, &[other, shared]), Some(CouplingError::SharedDof { node: 2, dof: 2 }));
    let twice = Point::new([9; 3], [1.0; 3]).into();
    assert_eq!(refusal(reference, &[twice]), Some(CouplingError::SharedDof { node: 1, dof: 9 }));
    assert_eq!(refusal(reference, &[masked(other, 0)]), Some(CouplingError::NoComponents { node: 1 }));
    assert_eq!(refusal(masked(reference, 0), &[other]), Some(CouplingError::NoComponents { node: 0 }));
    let nowhere = Node6 { at: [f64::NAN, 0.0, 0.0], ..other };
    assert_eq!(refusal(reference, &[nowhere]), Some(CouplingError::NoPlace { node: 1 }));
}
