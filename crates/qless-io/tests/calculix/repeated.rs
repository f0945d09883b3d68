//! Masters that an equation names twice, in runs of ccx: whether it adds them up or is silently wrong, and how `clean`
//! rewrites them.

use std::collections::BTreeMap;

use qless_io::deck::Solver::Ccx;
use qless_io::deck::clean::{self, FaultKind};

use super::ccx::{deck, is_there, solve};
use super::from_text::parsed;

/// Terms `(node, component, coefficient)`, the slave first.
type Terms = Vec<(usize, usize, f64)>;

/// Node 7 with local axes: `A` along the first axis, `B` in the plane of the first two.
const TURNED: &str = "*NSET, NSET=NT\n7\n*TRANSFORM, NSET=NT, TYPE=R\n1.,.3,.2,-.2,1.,.1\n";
const LOADS: &str = "*CLOAD\n5,3,1.\n8,1,2.\n6,2,-1.5\n";

struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }

    fn coefficient(&mut self) -> f64 {
        (self.below(30) as f64 + 5.0) / 10.0 * if self.below(2) == 0 { 1.0 } else { -1.0 }
    }
}

fn text(equations: &[Terms]) -> String {
    let term = |&(node, component, v): &(usize, usize, f64)| format!("{node},{component},{v:?}");
    let lines = |terms: &Terms| {
        terms.iter().map(term).collect::<Vec<_>>().chunks(4).map(|line| line.join(",") + "\n").collect::<String>()
    };
    let equation = |terms: &Terms| format!("*EQUATION\n{}\n{}", terms.len(), lines(terms));
    equations.iter().map(equation).collect::<Vec<_>>().concat()
}

/// The axes of `TURNED`.
fn axes() -> [[f64; 3]; 3] {
    let unit = |v: [f64; 3]| v.map(|x| x / v.iter().map(|x| x * x).sum::<f64>().sqrt());
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let first = unit([1.0, 0.3, 0.2]);
    let third = unit(cross(first, [-0.2, 1.0, 0.1]));
    [first, cross(third, first), third]
}

/// Terms along the global axes, each DOF once.
fn added_up(terms: &Terms, is_turned: bool) -> Terms {
    let mut sums: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for &(node, component, v) in terms {
        if is_turned && node == 7 {
            (0..3).for_each(|d| *sums.entry((7, d + 1)).or_default() += v * axes()[component - 1][d]);
        } else {
            *sums.entry((node, component)).or_default() += v;
        }
    }
    let first = terms.iter().map(|&(node, component, _)| (node, component)).next().expect("a slave");
    let own = sums.remove(&first).into_iter().map(|v| (first, v));
    own.chain(sums).map(|((node, component), v)| (node, component, v)).collect()
}

/// An equation of three nodes with repeated terms, and possibly another one whose slave it names.
fn system(random: &mut Random) -> Vec<Terms> {
    let slave = (5, 1 + random.below(3), 1.0);
    let (a, b) = ((7, 1 + random.below(3)), (6, 1 + random.below(3)));
    let mut terms = vec![slave, (b.0, b.1, random.coefficient()), (a.0, a.1, random.coefficient())];
    match random.below(4) {
        0 => terms.push((b.0, b.1, random.coefficient())),
        1 => terms.push((a.0, 1 + a.1 % 3, random.coefficient())),
        2 => terms.push((a.0, a.1, random.coefficient())),
        _ => terms.extend([(5, slave.1, 0.5), (b.0, b.1, 0.3)]),
    }
    let mut all = vec![terms];
    if random.below(3) == 0 {
        let chained = if random.below(2) == 0 { (b.0, b.1, 1.0) } else { (8, 3, 1.0) };
        all.push(vec![chained, (8, 2, random.coefficient())]);
    }
    all
}

/// Largest difference at nodes 5, 6, 8, relative to the largest displacement.
fn far(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let size = a.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
    let differences = [4, 5, 7].into_iter().flat_map(|k| (0..3).map(move |c| (a[k][c] - b[k][c]).abs()));
    differences.fold(0.0, f64::max) / size
}

#[test]
fn ccx_is_wrong_where_we_say_so_and_right_after_clean() {
    if !is_there() {
        return;
    }
    let (mut random, mut wrong) = (Random(3), [0; 2]);
    for turn in 0..60 {
        let is_turned = turn % 2 == 1;
        let equations = system(&mut random);
        let sound: Vec<Terms> = equations.iter().map(|terms| added_up(terms, is_turned)).collect();
        let expected = solve(&deck(&text(&sound), &[LOADS])).expect("solved");
        let own = format!("{}{}", if is_turned { TURNED } else { "" }, text(&equations));
        let own = deck(&own, &[LOADS]);
        let found = solve(&own).expect("solved");
        let read = parsed(Ccx, &own).expect("read");
        let faults = clean::faults(read.model());
        let is_said = faults.iter().any(|fault| matches!(fault.kind, FaultKind::MasterTwice { .. }));
        let is_wrong = far(&expected[0], &found[0]) > 1e-6;
        assert_eq!(is_said, is_wrong, "{own}\n{faults:?}\n{expected:?}\n{found:?}");
        wrong[usize::from(is_turned)] += usize::from(is_wrong);
        let plan = clean::plan(&read, &qless::Options::default()).expect("a plan");
        let cleaned = String::from_utf8(clean::write(&read, &plan).expect("written")).expect("text");
        let after = solve(&cleaned).unwrap_or_else(|| panic!("ccx stops:\n{cleaned}"));
        assert!(far(&expected[0], &after[0]) < 1e-6, "{cleaned}\n{expected:?}\n{after:?}");
        let again = parsed(Ccx, &cleaned).expect("read");
        assert!(clean::faults(again.model()).is_empty(), "{cleaned}");
    }
    assert!(wrong[0] > 5 && wrong[1] > 5, "{wrong:?}");
}
