//! Checks the rotations of rigid bodies and kinematic couplings in ccx: refuses free rotations, and warns of values and
//! loads on rotations that ccx ignores.

use std::collections::{BTreeMap, BTreeSet};

use rustc_hash::FxHashMap;

use crate::deck::calculix::cards::rigid::BodyReference;
use crate::deck::calculix::model::DeckDefinitions;
use crate::deck::calculix::model::elements::ElementShape;
use crate::deck::{Dof, Model};

/// A rotation is free if the determinant of its [`Gram`] matrix is at most this fraction of the product of the diagonal entries. Rounding
/// errors alone can give about a quarter of this fraction.
const FREE: f64 = 1e-13;

/// A rigid body or a kinematic coupling, with file and line of its card.
pub struct ReadBody {
    pub body: BodyReference,
    pub file: u32,
    pub line: u32,
}

/// Checks the rotations of all rigid bodies and kinematic couplings.
pub fn check(model: &mut Model, definitions: &DeckDefinitions, bodies: &[ReadBody], couplings: &[ReadBody]) {
    // ccx stops at a free rotation only if it expands no elements into solids.
    let is_expanded = definitions.blocks.iter().any(|block| ElementShape::from_type(&block.kind).is_expanded());
    for bodies in [bodies, couplings].into_iter().filter(|bodies| !bodies.is_empty() && !is_expanded) {
        find_free(model, definitions, bodies);
    }
    warn_of_idle(model, definitions, bodies);
}

/// `sum r r^T` over the equations of a rotation. In each equation, r holds the three coefficients of the rotation's components. The matrix
/// is singular if the rotation about some axis is free, for example if the reference and all nodes of the body lie on a line.
type Gram = [[f64; 3]; 3];

/// Refuses a free rotation about a global axis, at which ccx stops. Only warns of a free rotation about another axis: with rounding errors,
/// ccx may not notice that it is free.
fn find_free(model: &mut Model, definitions: &DeckDefinitions, bodies: &[ReadBody]) {
    let grams = grams(model, bodies);
    let mut seen = BTreeSet::new();
    for ReadBody { body, file, line } in bodies {
        let is_meshed = |node| definitions.elements().is_ok_and(|elements| elements.nodes.contains(&node));
        if !seen.insert(body.rotation) || body.names_rotation() && is_meshed(body.rotation.node) {
            continue;
        }
        let gram = grams.get(&body.rotation).copied().unwrap_or_default();
        for (k, is_sure) in free(&gram) {
            let about = || format!("about axis {}", k + 1);
            let name = if body.names_rotation() { model.dof_name(body.rotations()[k]) } else { about() };
            if is_sure {
                let text = format!("ccx stops: nothing holds rotation {name}: no equation of the body has it");
                model.refuse(*file, *line, text);
            } else {
                let text =
                    format!("ccx may stop: nothing holds the rotation of the body about a line ({name} is part of it)");
                model.warn(*file, *line, text);
            }
        }
    }
}

/// The [`Gram`] matrix of each rotation. A value that the first step prescribes counts as an equation.
fn grams(model: &Model, bodies: &[ReadBody]) -> FxHashMap<Dof, Gram> {
    let mut grams: FxHashMap<Dof, Gram> = FxHashMap::default();
    let mut place: FxHashMap<Dof, (Dof, usize)> = FxHashMap::default();
    for ReadBody { body, .. } in bodies {
        place.extend(body.rotations().into_iter().zip(0..).map(|(dof, k)| (dof, (body.rotation, k))));
    }
    let mut add = |terms: &[(Dof, f64)]| {
        let own = terms.iter().filter_map(|(dof, a)| Some((place.get(dof)?, *a)));
        for ((body, i), a) in own.clone() {
            let gram = grams.entry(*body).or_default();
            own.clone().filter(|((other, _), _)| other == body).for_each(|((_, j), b)| gram[*i][*j] += a * b);
        }
    };
    for equation in (0..model.equations()).map(|i| model.nth(i)) {
        let terms = equation.columns.iter().zip(equation.coefficients);
        add(&terms.map(|(&j, &a)| (model.dofs[j as usize], a)).collect::<Vec<_>>());
    }
    model.cases.first().iter().flat_map(|case| &case.prescribed).for_each(|given| add(&[(given.dof, 1.0)]));
    grams
}

/// Finds the free rotations. Returns for each the global axis (0 to 2) closest to its axis, and whether the two axes are the same.
fn free(gram: &Gram) -> Vec<(usize, bool)> {
    let aligned: Vec<(usize, bool)> = (0..3).filter(|&k| gram[k][k] == 0.0).map(|k| (k, true)).collect();
    let minor = |k: usize| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        gram[i][i] * gram[j][j] - gram[i][j] * gram[j][i]
    };
    let [[a, b, c], [_, d, e], [.., f]] = *gram;
    let determinant = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d);
    let size = (0..3).map(|k| gram[k][k]).product::<f64>();
    if !aligned.is_empty() || determinant > FREE * size {
        return aligned;
    }
    let most = (0..3).max_by(|&a, &b| minor(a).total_cmp(&minor(b)));
    most.into_iter().map(|k| (k, false)).collect()
}

/// Warns of values and moments on components 4 to 6 of a body's reference: ccx ignores them unless an element or an
/// equation has these DOFs.
fn warn_of_idle(model: &mut Model, definitions: &DeckDefinitions, bodies: &[ReadBody]) {
    let references = || bodies.iter().map(|read| &read.body);
    let body = |dof: Dof| references().find(|body| body.node == dof.node && (4..=6).contains(&dof.component));
    let is_idle = |dof: Dof| !definitions.rotates(dof.node) && model.column(dof).is_none();
    let given = model.cases.iter().flat_map(|case| &case.prescribed).map(|given| (given.dof, given.origin));
    let loads = model.cases.iter().flat_map(|case| &case.loads).map(|load| (load.dof, load.origin));
    let found: BTreeMap<_, _> = given
        .chain(loads)
        .filter(|(dof, _)| is_idle(*dof))
        .filter_map(|(dof, origin)| Some(((origin.line, dof, model.cards.nth(origin.card).file), body(dof)?)))
        .collect();
    for ((line, dof, file), body) in found {
        let name = model.dof_name(dof);
        let text = match body.rotation_node() {
            Some(node) => format!(
                "{name} has no effect: the rotation of a *RIGID BODY with ROT NODE is components 1 to 3 of node {node}"
            ),
            None => format!("{name} has no effect: no card can name the rotation of a *RIGID BODY without ROT NODE"),
        };
        model.warn(file, line, text);
    }
}

#[cfg(test)]
mod tests {
    use super::{Gram, free};

    fn gram(rows: &[[f64; 3]]) -> Gram {
        let sum = |i: usize, j: usize| rows.iter().map(|row| row[i] * row[j]).sum();
        std::array::from_fn(|i| std::array::from_fn(|j| sum(i, j)))
    }

    #[test]
    fn what_no_row_holds_is_free() {
        assert_eq!(free(&Gram::default()), [(0, true), (1, true), (2, true)]);
        assert_eq!(free(&gram(&[[0.0, 0.3, 0.0], [0.7, 0.0, 0.0]])), [(2, true)]);
        // Rows of a point at (1, 2, -3). The rotation about the line from the origin to this point is free.
        assert_eq!(free(&gram(&[[0.0, -3.0, -2.0], [3.0, 0.0, 1.0], [2.0, -1.0, 0.0]])), [(2, false)]);
        assert_eq!(free(&gram(&[[0.0, -3.0, -2.0], [3.0, 0.0, 1.0], [2.0, -1.0, 0.0], [0.0, 1.0, 0.1]])), []);
    }
}
