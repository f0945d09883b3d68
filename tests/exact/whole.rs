//! The rank of decimal numbers against fraction-free elimination of whole numbers (the decimals times a power of ten).

use qless::exact::{self, Reading};
use qless::{ConstraintSystem, SystemBuilder};
use qless_scenes::Rng;

/// A decimal as a multiple of 0.01.
type Cents = i128;

/// `C u = b` with all numbers in cents, the right-hand side last in each row, and `(DOF, value in tenths)` prescribed.
struct Decimal {
    rows: Vec<Vec<Cents>>,
    prescribed: Vec<(usize, i128)>,
}

/// The text of a number: 7, -0.25 or 1.5, or with an exponent.
fn typed(cents: Cents, shift: i32, scientific: bool) -> f64 {
    let text = if scientific || shift != 0 {
        format!("{cents}e{}", shift - 2)
    } else {
        let sign = if cents < 0 { "-" } else { "" };
        format!("{sign}{}.{:02}", cents.abs() / 100, cents.abs() % 100)
    };
    text.parse().expect("a number")
}

impl Decimal {
    fn random(rng: &mut Rng) -> Self {
        let (m, n) = (1 + rng.below(7), 1 + rng.below(6));
        let share = 2 + rng.below(3);
        let cents = |rng: &mut Rng| match rng.below(5) {
            k if k >= share => 0,
            0 => 100 * rng.coefficient(5) as Cents,
            1 => 10 * rng.coefficient(9) as Cents,
            _ => rng.coefficient(30) as Cents,
        };
        let mut rows: Vec<Vec<Cents>> = (0..m).map(|_| (0..=n).map(|_| cents(rng)).collect()).collect();
        for _ in 0..rng.below(m) {
            let (a, b, target) = (rng.below(m), rng.below(m), rng.below(m));
            let (x, y) = (rng.coefficient(3) as Cents, rng.coefficient(2) as Cents);
            rows[target] = (0..=n).map(|j| x * rows[a][j] + y * rows[b][j]).collect();
        }
        if rng.below(3) == 0 {
            rows[rng.below(m)][n] += rng.coefficient(2) as Cents;
        }
        let count = rng.below(n.min(3) + 1);
        let prescribed =
            rng.distinct(count, n).expect("few").into_iter().map(|dof| (dof, rng.coefficient(20) as i128)).collect();
        Self { rows, prescribed }
    }

    fn dofs(&self) -> usize {
        self.rows[0].len() - 1
    }

    /// As doubles, each row in a unit of its own.
    fn system(&self, rng: &mut Rng) -> ConstraintSystem {
        let mut builder = SystemBuilder::new(self.dofs());
        for row in &self.rows {
            let (shift, scientific) = ([0, 0, -12, 7][rng.below(4)], rng.below(2) == 0);
            let values: Vec<f64> = row.iter().map(|&cents| typed(cents, shift, scientific)).collect();
            builder.equation((0..self.dofs()).map(|j| (j, values[j])), values[self.dofs()]);
        }
        for &(dof, tenths) in &self.prescribed {
            builder.prescribe(dof, typed(10 * tenths, 0, false));
        }
        builder.build().expect("valid")
    }

    /// Ranks of `C_f` and of `[C_f | b - C_p u_p]`.
    fn ranks(&self) -> (usize, usize) {
        let known = |row: &Vec<Cents>| self.prescribed.iter().map(|&(j, tenths)| row[j] * tenths).sum::<Cents>();
        let is_free = |j: usize| self.prescribed.iter().all(|&(dof, _)| dof != j);
        let mut rows: Vec<Vec<i128>> = Vec::new();
        for row in &self.rows {
            // Coefficients in thousandths, as 0.01 times 0.1.
            let mut free: Vec<i128> = (0..self.dofs()).filter(|&j| is_free(j)).map(|j| 10 * row[j]).collect();
            free.push(10 * row[self.dofs()] - known(row));
            rows.push(free);
        }
        let cols = rows[0].len();
        let rank = rank_of(&mut rows, cols - 1);
        (rank, rank + usize::from(rows[rank..].iter().any(|row| row[cols - 1] != 0)))
    }
}

fn divisor(a: i128, b: i128) -> i128 {
    if b == 0 { a.abs() } else { divisor(b, a % b) }
}

/// Eliminates the first `cols` columns in place, the pivot rows first, and divides each row by its greatest common divisor.
fn rank_of(rows: &mut [Vec<i128>], cols: usize) -> usize {
    let mut rank = 0;
    for col in 0..cols {
        let Some(pivot) = (rank..rows.len()).find(|&i| rows[i][col] != 0) else { continue };
        rows.swap(rank, pivot);
        for i in rank + 1..rows.len() {
            let (a, b) = (rows[rank][col], rows[i][col]);
            let term = |x: i128, y: i128| x.checked_mul(y).expect("small numbers");
            let mut sum: Vec<i128> = (0..rows[i].len()).map(|j| term(a, rows[i][j]) - term(b, rows[rank][j])).collect();
            let common = sum.iter().fold(0, |common, &x| divisor(x, common)).max(1);
            sum.iter_mut().for_each(|x| *x /= common);
            rows[i] = sum;
        }
        rank += 1;
    }
    rank
}

#[test]
fn numbers_as_typed_have_the_ranks_of_whole_numbers() {
    let mut rng = Rng::new(5);
    let mut seen = [0; 4];
    for case in 0..2000 {
        let decimal = Decimal::random(&mut rng);
        let system = decimal.system(&mut rng);
        let exact = exact::rank(&system, Reading::Typed).expect("small");
        let (rank, augmented) = decimal.ranks();
        assert_eq!((exact.rank, exact.augmented_rank), (rank, augmented), "case {case}: {system:?}");
        // A few of the 2.7e16 primes between 2^60 and 2^61, twice.
        assert!((1e-32..1e-25).contains(&exact.error_chance()), "case {case}: {:e}", exact.error_chance());
        let stored = exact::rank(&system, Reading::Stored).expect("small");
        let kinds =
            [rank < system.equations(), rank < augmented, stored.rank > rank, stored.augmented_rank > augmented];
        kinds.iter().zip(&mut seen).for_each(|(&kind, count)| *count += usize::from(kind));
    }
    // Dependent systems, unsolvable ones, and systems that differ in binary occur often enough.
    assert!(seen.iter().all(|&count| count > 100), "{seen:?}");
}

#[test]
fn a_tenth_and_two_tenths_are_three_tenths_as_typed_only() {
    let mut builder = SystemBuilder::new(2);
    for (x, y) in [(0.1, 1.0), (0.2, 2.0), (0.3, 3.0)] {
        builder.equation([(0, x), (1, y)], x);
    }
    let system = builder.build().expect("valid");
    let [typed, stored] =
        [Reading::Typed, Reading::Stored].map(|reading| exact::rank(&system, reading).expect("small"));
    assert_eq!((typed.rank, typed.augmented_rank), (1, 1));
    assert_eq!((stored.rank, stored.augmented_rank), (2, 2));
}

/// u0 = 0.1, u1 = 0.2 and u0 + u1 = 0.3, by a prescribed value as well.
#[test]
fn right_hand_sides_and_prescribed_values_are_read_as_typed_too() {
    for prescribed in [false, true] {
        let mut builder = SystemBuilder::new(2);
        builder.equation([(1, 1.0)], 0.2);
        builder.equation([(0, 1.0), (1, 1.0)], 0.3);
        if prescribed {
            builder.prescribe(0, 0.1);
        } else {
            builder.equation([(0, 1.0)], 0.1);
        }
        let system = builder.build().expect("valid");
        let solvable = |reading| exact::rank(&system, reading).expect("small").is_solvable();
        assert!(solvable(Reading::Typed) && !solvable(Reading::Stored));
    }
}

/// 1/3 cut to any number of digits is not 1/3.
#[test]
fn digits_that_are_missing_count() {
    for third in [0.333, 0.333_333, 0.333_333_333_333_333] {
        let mut builder = SystemBuilder::new(2);
        builder.equation([(0, third), (1, 1.0)], 0.0);
        builder.equation([(0, 1.0), (1, 3.0)], 0.0);
        assert_eq!(exact::rank(&builder.build().expect("valid"), Reading::Typed).expect("small").rank, 2);
    }
}

/// Numbers of the whole range of doubles, whose products are beyond it.
#[test]
fn nothing_overflows() {
    for (x, y, value) in [(1e308, 1e-300, 1e300), (5e-324, 1.7e308, -1e-320)] {
        let mut builder = SystemBuilder::new(3);
        builder.equation([(0, x), (1, y), (2, x)], y);
        builder.equation([(0, y), (1, x), (2, y)], y);
        builder.equation([(0, -x), (1, -y), (2, -x)], -y);
        builder.prescribe(2, value);
        for reading in [Reading::Typed, Reading::Stored] {
            let exact = exact::rank(&builder.clone().build().expect("valid"), reading).expect("small");
            assert_eq!((exact.rank, exact.augmented_rank), (2, 2), "{reading:?}");
        }
    }
}
