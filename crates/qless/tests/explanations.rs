//! Explanations are short, irreducible, and give the equation that they explain.

use std::collections::BTreeMap;

use qless::common::SplitMix64;
use qless::explanation::{Explanation, Member};
use qless::report::Certificate;
use qless::{ConstraintSystem, Kind, Options, Report, SystemBuilder, analyse};

fn below(random: &mut SplitMix64, n: usize) -> usize {
    (random.next() % n as u64) as usize
}

fn shuffle<T>(random: &mut SplitMix64, items: &mut [T]) {
    (1..items.len()).rev().for_each(|k| items.swap(k, below(random, k + 1)));
}

/// Rank modulo 2^31 - 1 of rows of small whole numbers: their minors are far smaller or zero in these tests.
fn rank(mut rows: Vec<Vec<i64>>) -> usize {
    const P: i64 = (1 << 31) - 1;
    let inverse = |a: i64| {
        let (mut result, mut power, mut exponent) = (1, a.rem_euclid(P), P - 2);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = result * power % P;
            }
            power = power * power % P;
            exponent >>= 1;
        }
        result
    };
    let columns = rows.first().map_or(0, Vec::len);
    let mut rank = 0;
    for column in 0..columns {
        let Some(pivot) = (rank..rows.len()).find(|&i| rows[i][column].rem_euclid(P) != 0) else { continue };
        rows.swap(rank, pivot);
        let pivot_row = rows[rank].clone();
        let scale = inverse(pivot_row[column]);
        for row in &mut rows[rank + 1..] {
            let factor = row[column].rem_euclid(P) * scale % P;
            row.iter_mut().zip(&pivot_row).for_each(|(a, b)| *a = (*a - factor * b.rem_euclid(P)).rem_euclid(P));
        }
        rank += 1;
    }
    rank
}

/// A system of small whole numbers, `sum_j a_ij u_j = b_i`, in units that are powers of two: exact in both.
#[derive(Debug, Default)]
struct Model {
    rows: Vec<Vec<(usize, i64)>>,
    sides: Vec<i64>,
    prescribed: Vec<(usize, i64)>,
    /// Powers of two that multiply the equations, and the columns.
    units: [Vec<i32>; 2],
    /// The sum of an explanation with an error of at least this may be the vector within the tolerance only.
    inexact: f64,
}

impl Model {
    fn system(&self) -> ConstraintSystem {
        let [row, col] = &self.units;
        let mut builder = SystemBuilder::new(col.len());
        for ((terms, &side), &unit) in self.rows.iter().zip(&self.sides).zip(row) {
            let terms = terms.iter().map(|&(j, a)| (j, a as f64 * 2_f64.powi(unit + col[j])));
            builder.equation(terms, side as f64 * 2_f64.powi(unit));
        }
        self.prescribed.iter().for_each(|&(j, value)| builder.prescribe(j, value as f64 * 2_f64.powi(-col[j])));
        builder.build().expect("valid")
    }

    /// An equation as a dense row, with its right-hand side as the last number.
    fn equation(&self, i: usize) -> Vec<i64> {
        let mut row = vec![0; self.units[1].len() + 1];
        self.rows[i].iter().for_each(|&(j, a)| row[j] += a);
        *row.last_mut().expect("a right-hand side") = self.sides[i];
        row
    }

    fn value(&self, dof: usize) -> i64 {
        self.prescribed.iter().find(|&&(j, _)| j == dof).expect("prescribed").1
    }

    /// A member as a dense row, and its factor in units without powers of two.
    fn member(&self, member: Member) -> (Vec<i64>, f64) {
        let [row, col] = &self.units;
        match member {
            Member::Equation { row: i, coefficient } => (self.equation(i), coefficient * 2_f64.powi(row[i])),
            Member::Prescribed { dof, coefficient, .. } => {
                let mut unit = vec![0; col.len() + 1];
                (unit[dof], unit[col.len()]) = (1, self.value(dof));
                (unit, coefficient * 2_f64.powi(-col[dof]))
            }
            _ => unreachable!("there are two kinds of members"),
        }
    }

    /// Checks the members: they give the vector, no one can be left out, and exact arithmetic finds a mismatch only if there should be one.
    /// The last number of the vector is its right-hand side; `unit` is its power of two.
    fn check(&self, vector: &[i64], unit: i32, explanation: &Explanation, differs: Option<bool>) {
        let members: Vec<_> = explanation.members.iter().map(|&member| self.member(member)).collect();
        let (factor, dofs) = (2_f64.powi(-unit), vector.len() - 1);
        for j in 0..dofs {
            let parts = members.iter().map(|(row, coefficient)| coefficient * factor * row[j] as f64);
            let [sum, size] = parts.fold([0.0, 1.0], |[sum, size], part: f64| [sum + part, size + part.abs()]);
            assert!((sum - vector[j] as f64).abs() < 1e-9 * size, "DOF {j}: {sum}; {explanation:?} {self:?}");
        }
        let rank_of = |columns: usize, left_out: Option<usize>| {
            let kept =
                members.iter().enumerate().filter(|&(k, _)| Some(k) != left_out).map(|(_, (row, _))| row.as_slice());
            rank(kept.chain([vector]).map(|row| row[..columns].to_vec()).collect())
        };
        let is_exact = explanation.error < self.inexact;
        for left_out in (0..members.len()).map(Some).chain(is_exact.then_some(None)) {
            let found = rank_of(dofs, left_out);
            assert_eq!(found, members.len(), "{left_out:?} can be left out: {explanation:?} {self:?}");
        }
        if let Some(differs) = differs.filter(|_| is_exact) {
            assert_eq!(rank_of(dofs + 1, None), members.len() + usize::from(differs), "{explanation:?} {self:?}");
        }
        assert!(explanation.is_irreducible || explanation.error > 1e-9, "{explanation:?}");
    }

    /// Explains all that can be explained, alone and in a report; returns the number of members of each explanation.
    fn check_all(&self) -> Vec<usize> {
        let system = self.system();
        let analysis = analyse(&system, &Options::default()).expect("an analysis");
        let report = Report::new(&analysis, Report::TERMS);
        let mut lengths = Vec::new();
        for (&(dof, value), finding) in analysis.generated().iter().zip(&report.generated_boundary_conditions) {
            let explanation = analysis.explain_fixed(dof).expect("factors").expect("it is fixed");
            let unit = self.units[1][dof];
            let mut vector = vec![0; system.dofs() + 1];
            vector[dof] = 1;
            self.check(&vector, -unit, &explanation, None);
            let size = explanation.members.iter().map(|&member| self.member(member).1.abs()).fold(0.0, f64::max);
            assert!((explanation.right_hand_side - value).abs() <= 1e-8 * size, "{value} {explanation:?}");
            assert_eq!(finding.certificate.because, Certificate::of_members(&system, &explanation.members).because);
            lengths.push(explanation.members.len());
        }
        for (found, finding) in analysis.dependent().iter().zip(&report.dependent) {
            let explanation = analysis.explain(found.row).expect("a row").expect("it is dependent");
            let unit = self.units[0][found.row];
            self.check(&self.equation(found.row), unit, &explanation, Some(found.kind == Kind::Conflicting));
            for &member in &explanation.members {
                if let Member::Equation { row, .. } = member {
                    assert_ne!(analysis.kinds()[row], Kind::Conflicting);
                }
            }
            let factors = explanation.members.iter().map(|&member| self.member(member).1.abs());
            let size = factors.fold(2_f64.powi(unit), f64::max);
            let mismatch = system.rhs()[found.row] - explanation.right_hand_side;
            assert!((mismatch - found.mismatch).abs() <= 1e-5 * size, "{found:?} {explanation:?}");
            assert_eq!(finding.certificate.because, Certificate::of_members(&system, &explanation.members).because);
            lengths.push(explanation.members.len());
        }
        lengths
    }
}

/// Equal neighbours on a grid of `n` x `n` nodes, in any order.
fn grid(n: usize, random: &mut SplitMix64) -> ConstraintSystem {
    let right = (0..n * n).filter(|k| k % n + 1 < n).map(|k| (k, k + 1));
    let down = (0..n * (n - 1)).map(|k| (k, k + n));
    let mut ties: Vec<_> = right.chain(down).collect();
    shuffle(random, &mut ties);
    let mut builder = SystemBuilder::new(n * n);
    ties.iter().for_each(|&(a, b)| _ = builder.equation([(a, 1.0), (b, -1.0)], 0.0));
    builder.build().expect("valid")
}

#[test]
fn a_redundant_tie_of_a_grid_closes_a_square() {
    for seed in 1..=10 {
        let system = grid(30, &mut SplitMix64::new(seed));
        let analysis = analyse(&system, &Options::default()).expect("an analysis");
        let length = |row| analysis.explain(row).expect("a row").expect("dependent").members.len();
        let lengths: Vec<usize> = analysis.dependent().iter().map(|found| length(found.row)).collect();
        assert_eq!(lengths.len(), 841);
        assert!(lengths.iter().all(|&length| length <= 4), "{lengths:?}");
    }
}

/// Ties of random ratios, sums of few DOFs, combinations of several of these, prescribed values; some numbers are wrong.
fn random_model(seed: u64) -> Model {
    let random = &mut SplitMix64::new(seed);
    let dofs = 4 + below(random, 30);
    let solution: Vec<i64> = (0..dofs).map(|_| below(random, 9) as i64 - 4).collect();
    let ratios: &[i64] = [&[1, -1][..], &[1, -1, 2, -3], &[1, -1, 2, 3, -5, 7]][below(random, 3)];
    let lengths: &[usize] = [&[2][..], &[1, 2, 2, 2, 3, 4], &[2, 3, 4, 5, 6]][below(random, 3)];
    let mut rows: Vec<Vec<(usize, i64)>> = Vec::new();
    for _ in 0..dofs / 2 + below(random, dofs) {
        let length = lengths[below(random, lengths.len())];
        rows.push((0..length).map(|_| (below(random, dofs), ratios[below(random, ratios.len())])).collect());
    }
    for _ in 0..=below(random, 4) {
        let parts = (0..2 + below(random, 4))
            .map(|_| (rows[below(random, rows.len())].clone(), 1 - 2 * below(random, 2) as i64));
        let parts: Vec<_> = parts.flat_map(|(part, sign)| part.into_iter().map(move |(j, a)| (j, sign * a))).collect();
        rows.push(parts);
    }
    shuffle(random, &mut rows);
    let wrong = |random: &mut SplitMix64| i64::from(below(random, 25) == 0);
    let side = |row: &Vec<(usize, i64)>| row.iter().map(|&(j, a)| a * solution[j]).sum::<i64>() + wrong(random);
    let sides = rows.iter().map(side).collect();
    let prescribed = (0..dofs).filter(|_| below(random, 8) == 0).collect::<Vec<_>>();
    let prescribed = prescribed.into_iter().map(|j| (j, solution[j] + wrong(random))).collect();
    let most = [0, 0, 3, 20][below(random, 4)];
    let mut powers = |count: usize| (0..count).map(|_| below(random, 2 * most + 1) as i32 - most as i32).collect();
    let units = [powers(rows.len()), powers(dofs)];
    Model { rows, sides, prescribed, units, inexact: f64::INFINITY }
}

/// Law: explanations give the equation, no member can be left out, and their sides show what is wrong. Each is checked exactly.
#[test]
fn explanations_are_irreducible_and_give_the_equation() {
    let lengths: Vec<usize> = (1..=4000).flat_map(|seed| random_model(seed).check_all()).collect();
    assert!(lengths.len() > 15_000, "{} explanations", lengths.len());
}

/// Springs in a row: `u_k - u_(k+1) - c_k f_k = b_k` and `f_k - f_(k+1) = 0`, with compliances of `2^(least - 40)` to 1, and sums of a few of
/// these equations. All coefficients are whole multiples of `2^-40`.
fn springs(seed: u64, (least, factor): (usize, i64)) -> Model {
    let random = &mut SplitMix64::new(seed);
    let n = 2 + below(random, 6);
    let one = 1 << 40;
    let mut rows: Vec<Vec<(usize, i64)>> = Vec::new();
    for k in 0..n {
        let compliance = (1 + below(random, 1 << 7) as i64) << (least + below(random, 33 - least));
        rows.push(vec![(k, one), (k + 1, -one), (n + 1 + k, -compliance)]);
    }
    rows.extend((1..n).map(|k| vec![(n + k, one), (n + 1 + k, -one)]));
    let mut sides: Vec<i64> = rows.iter().map(|_| [0, 0, 1, 2][below(random, 4)]).collect();
    let parts = rows.len();
    for _ in 0..=below(random, 2) {
        let (mut sum, mut side) = (BTreeMap::new(), 0);
        for _ in 0..=below(random, 3) {
            let (part, factor) = (below(random, parts), [1, factor, -2][below(random, 3)]);
            rows[part].iter().for_each(|&(j, a)| *sum.entry(j).or_default() += factor * a);
            side += factor * sides[part];
        }
        rows.push(sum.into_iter().collect());
        sides.push(side);
    }
    let mut order: Vec<usize> = (0..rows.len()).collect();
    shuffle(random, &mut order);
    let rows: Vec<_> = order.iter().map(|&i| rows[i].clone()).collect();
    let sides = order.iter().map(|&i| sides[i]).collect();
    let mut prescribed = vec![(0, 0)];
    prescribed.extend((below(random, 2) == 0).then_some((n, 0)));
    let units = [vec![-40; rows.len()], vec![0; 2 * n + 1]];
    // With compliances down to 2^-32, a few explanations hold within the tolerance only: their errors are 6e-12 and more.
    let inexact = if least < 12 { 1e-12 } else { f64::INFINITY };
    Model { rows, sides, prescribed, units, inexact }
}

/// Law: coefficients of all sizes do not bring rounding into explanations.
#[test]
fn explanations_with_wide_coefficients_are_irreducible() {
    for range in [(12, 32), (8, 64)] {
        let lengths: Vec<usize> = (1..=4000).flat_map(|seed| springs(seed, range).check_all()).collect();
        assert!(lengths.len() > 10_000, "{} explanations", lengths.len());
    }
}

/// Coefficients of `2^-k` to 1, k between 8 and 26, and sums of two equations, in units of the equations of `2^-40` to `2^40`.
fn graded(seed: u64) -> Model {
    let random = &mut SplitMix64::new(seed);
    let (dofs, most) = (3 + below(random, 10), 8 + below(random, 19));
    let mut rows: Vec<Vec<(usize, i64)>> = Vec::new();
    for _ in 0..4 + below(random, 12) {
        let length = 1 + below(random, 3);
        let factor =
            |random: &mut SplitMix64| [1, -1, 3, -5][below(random, 4)] << [most, most, most / 2, 0][below(random, 4)];
        rows.push((0..length).map(|_| (below(random, dofs), factor(random))).collect());
    }
    for _ in 0..=below(random, 3) {
        let parts = (0..2)
            .map(|_| (rows[below(random, rows.len())].clone(), [1, -1, 3][below(random, 3)] << below(random, 10)));
        let sum: Vec<_> =
            parts.flat_map(|(part, factor)| part.into_iter().map(move |(j, a)| (j, factor * a))).collect();
        if sum.iter().all(|(_, a)| a.unsigned_abs() < 1 << 48) {
            rows.push(sum);
        }
    }
    shuffle(random, &mut rows);
    let units = [rows.iter().map(|_| below(random, 81) as i32 - 40).collect(), vec![0; dofs]];
    Model { sides: vec![0; rows.len()], rows, units, ..Model::default() }
}

/// Law: the members of an irreducible explanation are independent. Where rounding hides that they are not, nothing is claimed.
#[test]
fn members_of_irreducible_explanations_are_independent() {
    let (mut explained, mut claimed) = (0, 0);
    for model in (1..=4000).map(graded) {
        let analysis = analyse(&model.system(), &Options::default()).expect("an analysis");
        for dependent in analysis.dependent() {
            let explanation = analysis.explain(dependent.row).expect("a row").expect("it is dependent");
            explained += 1;
            if explanation.is_irreducible {
                let rows: Vec<_> = explanation.members.iter().map(|&member| model.member(member).0).collect();
                assert_eq!(rank(rows), explanation.members.len(), "{explanation:?} {model:?}");
                assert!(explanation.error <= 1e-9, "{explanation:?}");
                claimed += 1;
            }
        }
    }
    assert!(claimed > explained * 99 / 100, "{claimed} of {explained}");
}

/// Row 4 is `2^-11 row 0 - 2^-5 row 3`. Elimination nearby took rounding for a pivot, and explained row 2 by rows 0, 3 and 4 with
/// coefficients of 1e24 to 1e27 and by row 6.
#[test]
fn coefficients_of_dependent_equations_explain_nothing() {
    let two = |exponent: i32| 2_f64.powi(exponent);
    let rows = [
        vec![(0, -5.0)],
        vec![(4, -two(-15))],
        vec![(1, 1.0), (2, 6.0), (3, -1.0)],
        vec![(2, 1.0), (4, two(-15))],
        vec![(0, -1.25 * two(-9)), (2, -two(-5)), (4, -two(-20))],
        vec![(0, -5.0), (3, 1.5 * two(-29))],
        vec![(0, -30.0), (1, 1.5 * two(20)), (2, 1.125 * two(22)), (3, -1.5 * two(20))],
    ];
    let mut builder = SystemBuilder::new(5);
    rows.into_iter().for_each(|row| _ = builder.equation(row, 0.0));
    let analysis = analyse(&builder.build().expect("valid"), &Options::default()).expect("an analysis");
    let explanation = analysis.explain(2).expect("a row").expect("it is dependent");
    let largest = explanation.members.iter().map(|member| member.coefficient().abs()).fold(0.0, f64::max);
    assert!(explanation.is_irreducible && largest < 10.0, "{explanation:?}");
}

/// The sum of 160 equations, of which the last has a small factor: too long to be examined, and said to be so. A nearly dependent component
/// beside it changes nothing.
#[test]
fn a_long_explanation_with_small_factors_is_marked() {
    let n = 160;
    for (unit, is_irreducible) in [(1.0, true), (2_f64.powi(-27), false)] {
        let mut builder = SystemBuilder::new(n + 4);
        builder.equation([(n + 2, 1.0), (n + 3, 1.0)], 0.0);
        builder.equation([(n + 2, 1.0), (n + 3, 1.0 + 2_f64.powi(-31))], 0.0);
        let row =
            |i: usize, factor: f64| [1.0, 4.0, 1.0].into_iter().enumerate().map(move |(k, a)| (i + k, a * factor));
        (0..n).for_each(|i| _ = builder.equation(row(i, 1.0), 0.0));
        builder.equation((0..n).flat_map(|i| row(i, if i + 1 < n { 1.0 } else { unit })), 0.0);
        let analysis = analyse(&builder.build().expect("valid"), &Options::default()).expect("an analysis");
        let explanation = analysis.explain(analysis.dependent()[0].row).expect("a row").expect("dependent");
        assert_eq!((explanation.members.len(), explanation.is_irreducible), (n, is_irreducible));
        let report = Report::new(&analysis, Report::TERMS);
        assert_eq!(report.dependent[0].certificate.is_irreducible, is_irreducible);
    }
}

/// Law of components: a nearly dependent component beside changes no bit of an explanation, and not whether it is examined.
#[test]
fn explanations_do_not_depend_on_other_components() {
    let mut compared = 0;
    for seed in 1..=1000 {
        let alone = springs(seed, (12, 32));
        let dofs = alone.units[1].len();
        let mut both = springs(seed, (12, 32));
        both.rows.push(vec![(dofs, 1 << 40), (dofs + 1, 1 << 40)]);
        both.rows.push(vec![(dofs, 1 << 40), (dofs + 1, (1 << 40) + 512)]);
        both.sides.extend([0, 0]);
        both.units[0].extend([-40, -40]);
        both.units[1].extend([0, 0]);
        let [alone, both] = [alone, both].map(|model| analyse(&model.system(), &Options::default()).expect("small"));
        assert!(both.confidence().distance < 1e-8 && both.kinds()[..alone.kinds().len()] == *alone.kinds());
        for found in alone.dependent() {
            assert_eq!(alone.explain(found.row), both.explain(found.row), "{seed}");
            compared += 1;
        }
        for &(dof, _) in alone.generated() {
            assert_eq!(alone.explain_fixed(dof).expect("factors"), both.explain_fixed(dof).expect("factors"), "{seed}");
            compared += 1;
        }
    }
    assert!(compared > 4_000, "{compared}");
}

/// Large values that differ in a late digit are shown with that digit.
#[test]
fn the_arithmetic_shows_the_difference() {
    let mut builder = SystemBuilder::new(2);
    builder.labelled_equation("tie", [(0, 1.0), (1, -1.0)], 0.0);
    builder.prescribe_at("line 3", 0, 20_000_000.25);
    builder.prescribe_at("line 4", 1, 20_000_021.75);
    let system = builder.build().expect("valid");
    let analysis = analyse(&system, &Options::default()).expect("an analysis");
    let explanation = analysis.explain(0).expect("a row").expect("it conflicts");
    let expected = "20000000.25 (line 3) - 20000021.75 (line 4) = -21.5, but 0 is asked (tie)";
    assert_eq!(explanation.arithmetic(&system, 0), expected);
}
