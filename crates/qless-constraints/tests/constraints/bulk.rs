use qless_constraints::types::{
    Body, Distance, Driven, Equal, Line, LinearEquation, OnLine, Point, Prescribed, RigidBody,
};
use qless_constraints::{AddError, Constraint, ConstraintId, ConstraintSet, EquationError, EquationSink, SetBuilder};

use crate::common::Outcome;

/// Fewer nodes than constraints, so that they share DOFs.
const NODES: usize = 2500;
/// Counts around the size of one task.
const COUNTS: [usize; 7] = [0, 1, 60, 4095, 4096, 4099, 9000];

/// Constraints of several types, in lengths of this unit.
#[derive(Clone, Copy)]
struct Mix {
    i: usize,
    seed: usize,
    unit: f64,
    fault: Option<Fault>,
}

#[derive(Clone, Copy)]
enum Fault {
    Input,
    Dof,
    Number,
}

#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct Refused(String);

impl Mix {
    fn new(i: usize, seed: usize, unit: f64) -> Self {
        Self { i, seed, unit, fault: None }
    }

    fn point(&self, k: usize) -> Point {
        let node = (self.i + k) % NODES;
        // Some have DOFs that do not ascend.
        let dofs = std::array::from_fn(|k| 6 * node + if node.is_multiple_of(5) { 2 - k } else { k });
        Point::new(dofs, [node as f64, (node * node % 7) as f64, (node % 3) as f64].map(|x| x * self.unit))
    }
}

impl Constraint for Mix {
    const NAME: &'static str = "mix";
    type Error = Refused;

    fn emit(self, sink: &mut EquationSink) -> Result<(), Refused> {
        match self.fault {
            Some(Fault::Input) => return Err(Refused("as agreed".into())),
            Some(Fault::Dof) => sink.equation("", [(6 * NODES + self.i, 1.0)], 0.0),
            Some(Fault::Number) => sink.equation("", [(0, f64::NAN)], 0.0),
            None => (),
        }
        let [a, b, c] = [0, 1, 2].map(|k| self.point(k));
        let number = (self.i * 37 % 11) as f64;
        let said = |error: &dyn std::error::Error| Refused(error.to_string());
        match (self.i * 31 + self.seed) % 9 {
            0 => Equal::new([a.dofs[1], b.dofs[1], c.dofs[1]]).emit(sink).map_err(|e| said(&e)),
            1 => LinearEquation { terms: vec![(a.dofs[0], 1.0), (b.dofs[1], number), (a.dofs[0], 2.0)], rhs: number }
                .emit(sink)
                .map_err(|e| said(&e)),
            2 => Prescribed { values: vec![(a.dofs[0], number)] }.emit(sink).map_err(|e| said(&e)),
            3 => Driven::new([(a.dofs[2], 1.0)], move |t| number * t).emit(sink).map_err(|e| said(&e)),
            4 => OnLine { point: a, line: Line::Nodes(b, c) }.emit(sink).map_err(|e| said(&e)),
            5 => {
                let body = Body::with_vector(a.dofs, a.at, a.dofs.map(|dof| dof + 3));
                RigidBody { body, nodes: vec![b.into()] }.emit(sink).map_err(|e| said(&e))
            }
            _ => Distance { length: Some(self.unit * (1.0 + number)), ..Distance::new(a, b) }
                .emit(sink)
                .map_err(|e| said(&e)),
        }?;
        // Names that differ between parts of the list.
        sink.equation(format!("own {}", self.i / 700), [(a.dofs[0], 1.0), (c.dofs[0], -1.0)], 0.0);
        Ok(())
    }
}

/// A way of adding constraints, and its result.
type Way = fn(&mut ConstraintSet, &str, usize, &(dyn Fn(usize) -> Mix + Sync)) -> Outcome<Vec<ConstraintId>>;

fn one_by_one(
    set: &mut ConstraintSet,
    label: &str,
    count: usize,
    of: &(dyn Fn(usize) -> Mix + Sync),
) -> Outcome<Vec<ConstraintId>> {
    (0..count).map(|i| Ok(set.add(format!("{label} {i}"), of(i))?)).collect()
}

fn at_once(
    set: &mut ConstraintSet,
    label: &str,
    count: usize,
    of: &(dyn Fn(usize) -> Mix + Sync),
) -> Outcome<Vec<ConstraintId>> {
    let ids = set.add_all(label, count, of)?;
    assert_eq!((ids.iter().len(), ids.get(count)), (count, None));
    assert_eq!(ids.get(count / 2), ids.iter().nth(count / 2));
    Ok(ids.iter().collect())
}

/// Everything visible of a set: numbers by their bits, patterns, labels, and the owners of equations.
#[derive(PartialEq)]
struct Seen {
    numbers: Vec<Vec<u64>>,
    patterns: Vec<(Vec<usize>, Vec<u32>)>,
    rounding: qless_constraints::Rounding,
    labels: Vec<String>,
    owners: Vec<usize>,
    rows: Vec<Vec<usize>>,
}

fn seen(set: &ConstraintSet, ids: &[ConstraintId], unit: f64) -> Outcome<Seen> {
    let some = |k: usize| (k * 7919 % 1009) as f64 / 1009.0 - 0.5;
    let u: Vec<f64> = (0..set.dofs()).map(|k| unit * some(k)).collect();
    let w: Vec<f64> = (0..set.equations()).map(|k| some(k + 13)).collect();
    let mut evaluation = set.allocate();
    set.assemble(&u, &w, &mut evaluation)?;
    let (c, g, h) = (evaluation.c(), evaluation.g(), evaluation.h());
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect();
    Ok(Seen {
        numbers: [c, g.values(), h.values()].map(bits).into(),
        patterns: [g, h].map(|matrix| (matrix.starts().to_vec(), matrix.columns().to_vec())).into(),
        rounding: set.rounding(&u)?,
        labels: (0..set.equations()).map(|row| set.label(row)).collect::<Result<_, _>>()?,
        owners: (0..set.equations()).map(|row| Ok(set.constraint_of(row)?.place())).collect::<Outcome<_>>()?,
        rows: ids.iter().map(|&id| Ok(set.rows_of(id)?)).collect::<Outcome<_>>()?,
    })
}

/// Constraints are added before, in bulk, between and after; then removed, deactivated, activated and changed.
fn life(way: Way, seed: usize, count: usize, unit: f64) -> Outcome<Vec<Seen>> {
    let mut set = ConstraintSet::builder(6 * NODES).build()?;
    let mix = |i: usize| Mix::new(i, seed, unit);
    let mut ids = one_by_one(&mut set, "before", seed * 50, &|i| mix(i * 9 + 2))?;
    ids.extend(way(&mut set, "first", count, &mix)?);
    let mut all = vec![seen(&set, &ids, unit)?];
    ids.extend(one_by_one(&mut set, "between", 30, &|i| mix(i + 3))?);
    set.set_time(0.5)?;
    ids.extend(way(&mut set, "second", count, &|i| mix(count - i))?);
    all.push(seen(&set, &ids, unit)?);
    for k in 0..ids.len().min(40) {
        let place = k * 7919 % ids.len();
        match k % 4 {
            0 => set.remove(ids.swap_remove(place))?,
            1 => set.deactivate(ids[place])?,
            2 => set.replace(ids[place], mix(k + 5))?,
            _ => set.activate(ids[(k - 2) * 7919 % ids.len()])?,
        }
    }
    one_by_one(&mut set, "after", 20, &mix)?;
    all.push(seen(&set, &ids, unit)?);
    Ok(all)
}

/// Identical to the last bit, in every unit, after any further changes, with any number of threads.
#[test]
fn all_at_once_is_one_by_one() -> Outcome {
    let pools = [1, 2, 5].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build());
    for (seed, count) in COUNTS.into_iter().enumerate() {
        let unit = [1e-6, 1.0, 1e6][seed % 3];
        let expected = life(one_by_one, seed, count, unit)?;
        let pool = pools[seed % 3].as_ref().map_err(ToString::to_string)?;
        // Its error need not be `Send`.
        let found = pool.install(|| life(at_once, seed, count, unit).map_err(|error| error.to_string()))?;
        assert!(found == expected, "{count} in units of {unit}");
    }
    Ok(())
}

/// A set with arrays and a plan of H accepts many more constraints.
#[test]
fn a_set_in_use_takes_many() -> Outcome {
    let build = |way: Way, follows: bool| -> Outcome<_> {
        let mut set = ConstraintSet::builder(6 * NODES).build()?;
        one_by_one(&mut set, "before", 500, &|i| Mix::new(i, 4, 1.0))?;
        let (u, mut evaluation) = (vec![0.125; set.dofs()], set.allocate());
        set.assemble(&u, &vec![1.0; set.equations()], &mut evaluation)?;
        way(&mut set, "", 6000, &|i| Mix::new(i, 1, 1.0))?;
        let mut evaluation = if follows { evaluation } else { set.allocate() };
        set.assemble(&u, &vec![2.0; set.equations()], &mut evaluation)?;
        Ok(evaluation)
    };
    assert_eq!(build(at_once, true)?, build(one_by_one, false)?);
    Ok(())
}

/// Among several faulty constraints the first one is named, as if it were added alone, and nothing is added.
#[test]
fn all_or_none() -> Outcome {
    for count in [100, 10_000] {
        for (k, fault) in [Fault::Input, Fault::Dof, Fault::Number].into_iter().enumerate() {
            let (first, later) = (count / 7 * (2 * k + 1), count - 1 - k);
            let of = |i: usize| {
                let fault = if i == first { Some(fault) } else { (i >= later).then_some(Fault::Input) };
                Mix { fault, ..Mix::new(i, 0, 1.0) }
            };
            let mut set = ConstraintSet::builder(6 * NODES).build()?;
            let ids = one_by_one(&mut set, "before", 300, &|i| Mix::new(i, 0, 1.0))?;
            let before = seen(&set, &ids, 1.0)?;
            let refused = set.add_all("rod", count, of).expect_err("some are faulty").to_string();
            let alone = set.add(format!("rod {first}"), of(first)).expect_err("it is faulty").to_string();
            assert_eq!(refused, alone);
            assert!(seen(&set, &ids, 1.0)? == before && set.constraints() == ids.len());
            let next = set.add("next", Equal::new([0, 1]))?;
            assert_eq!(next.place(), ids.len(), "numbers of those that were refused are given again");
        }
    }
    Ok(())
}

/// More constraints than can be numbered are refused before they are made.
#[test]
fn too_many_are_refused() {
    let too_large = |dofs: usize, count: usize| {
        let mut builder: SetBuilder = ConstraintSet::builder(dofs);
        let refused = builder.add_all("tie", count, |_| Equal::new([0, 1])).expect_err("too many");
        match refused {
            AddError::Equation { label, source: EquationError::TooLarge { what, .. }, .. } => (what, label),
            other => panic!("{other}"),
        }
    };
    assert_eq!(too_large(2, usize::MAX), ("constraints", "tie 4294967294".into()));
    assert_eq!(too_large(u32::MAX as usize, 5), ("DOFs", "tie 0".into()));
}

/// A type that states coordinates of DOFs out of range.
struct Far(usize);

impl Constraint for Far {
    const NAME: &'static str = "far";
    type Error = Refused;

    fn emit(self, sink: &mut EquationSink) -> Result<(), Refused> {
        sink.coordinate(self.0, 1.0);
        Ok(())
    }
}

#[test]
fn coordinates_of_dofs_that_are_not_there_are_refused() -> Outcome {
    for dof in [6, 4_000_000_000, usize::MAX] {
        let mut builder = ConstraintSet::builder(6);
        let refused = builder.add("far", Far(dof)).expect_err("there is no such DOF");
        let expected = EquationError::DofOutOfRange { dof, dofs: 6 };
        assert!(matches!(refused, AddError::Equation { source, .. } if source == expected));
        builder.add("near", Far(5))?;
        builder.build()?.rounding(&[0.0; 6])?;
    }
    Ok(())
}
