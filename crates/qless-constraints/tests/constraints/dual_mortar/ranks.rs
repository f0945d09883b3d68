use std::array::from_fn;

use faer::Mat;
use qless::{Options, analyse};
use qless_constraints::ConstraintSet;
use qless_constraints::types::{Face, MortarTie, Multipliers, Node, Shape, Surface};

use super::{inclined, line, pair, tied};
use crate::common::Outcome;
use crate::surface_mortar::Mesh;

/// The same bits with one thread and with four.
#[test]
fn threads_do_not_change_a_bit() {
    for kind in [Multipliers::Standard, Multipliers::Dual] {
        let mesh = Mesh { shape: Shape::Quad8, cells: 9, wiggle: 0.4, bend: 0.1 };
        let [slave, master] = pair(mesh, Mesh { shape: Shape::Tri6, cells: 11, ..mesh }, inclined);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| tied(&slave, &master, kind, 1e-9).expect("tied").allocate().g().clone())
        };
        assert_eq!(with(1), with(4));
    }
}

/// Interfaces that share slave nodes, and one that is said twice in the other direction: the rank is that of the SVD.
#[test]
fn ranks_are_those_of_the_svd() -> Outcome {
    for (kind, twice) in [
        (Multipliers::Standard, false),
        (Multipliers::Dual, false),
        (Multipliers::Standard, true),
        (Multipliers::Dual, true),
    ] {
        let along = |s: f64| [s, 0.0];
        let up = |s: f64| [0.0, s];
        let (slave, master) = (line(0, 4, false, along), line(5, 3, false, along));
        // The first slave node is that of the corner.
        let mut side = line(8, 4, false, up);
        side.nodes[0] = slave.nodes[0];
        let wall = line(13, 5, true, up);
        let mut builder = ConstraintSet::builder(24);
        builder.add(
            "floor",
            MortarTie { slave: slave.clone(), master: master.clone(), multipliers: kind, tolerance: 1e-9 },
        )?;
        builder.add("wall", MortarTie { slave: side, master: wall, multipliers: kind, tolerance: 1e-9 })?;
        if twice {
            builder
                .add("floor again", MortarTie { slave: master, master: slave, multipliers: kind, tolerance: 1e-9 })?;
        }
        let set = builder.build().expect("few DOFs");
        let evaluation = set.allocate();
        let mut dense = Mat::<f64>::zeros(set.equations(), 24);
        (0..set.equations()).for_each(|i| evaluation.g().row(i).for_each(|(j, v)| dense[(i, j)] = v));
        let sizes = dense.singular_values().map_err(|error| format!("{error:?}"))?;
        let rank = sizes.iter().filter(|&&s| s > 1e-12 * sizes[0]).count();
        let found = analyse(&crate::common::at_rest(&set, &[])?, &Options::default())?.rank();
        assert_eq!(found, rank, "{kind:?}, {twice}: {sizes:?}");
        println!("{kind:?}, said twice {twice}: rank {rank} of {}", set.equations());
    }
    Ok(())
}

#[test]
fn facets_of_other_dimensions_are_refused() {
    let square = |first: usize| -> Surface<2, 1> {
        let at = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let nodes = (0..4).map(|i| Node::of_field(first + i, at[i])).collect();
        Surface { nodes, faces: vec![Face::new(Shape::Quad4, [0, 1, 2, 3])] }
    };
    let tie = MortarTie { slave: square(0), master: square(4), multipliers: Multipliers::Dual, tolerance: 1.0 };
    let words =
        ConstraintSet::builder(8).add("it", tie).map_or_else(|error| error.to_string(), |_| "accepted".to_owned());
    assert!(
        words.contains("facet 1, from 1, of the slave side is a Quad4; both sides must consist of lines"),
        "{words}"
    );
    let solid = |first: usize| -> Surface<3, 1> {
        let at: [[f64; 3]; 4] = from_fn(|i| from_fn(|k| f64::from(u8::from(i == k + 1))));
        let nodes = (0..4).map(|i| Node::of_field(first + i, at[i])).collect();
        Surface { nodes, faces: vec![Face::new(Shape::Tet4, [0, 1, 2, 3])] }
    };
    let tie = MortarTie { slave: solid(0), master: solid(4), multipliers: Multipliers::Standard, tolerance: 1.0 };
    let words =
        ConstraintSet::builder(8).add("it", tie).map_or_else(|error| error.to_string(), |_| "accepted".to_owned());
    assert!(words.contains("slave side is a Tet4"), "{words}");
}
