//! Variants of a system: another order, scaled rows, other units.

use proptest::collection::vec;
use proptest::prelude::*;
use qless::ConstraintSystem;
use qless_scenes::{Rng, Scene};

/// Seeds of the variants of a system.
#[derive(Clone, Debug)]
pub struct Change {
    pub order: u64,
    pub rows: u64,
    pub units: u64,
    /// The units of the DOFs as powers of ten; `None` for the original units.
    pub decades: Vec<i32>,
}

/// Whether DOFs are measured in other units, from 1e-6 to 1e6: that rounds coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Units {
    Kept,
    Mixed,
}

pub fn changes(units: Units) -> impl Strategy<Value = Change> {
    let decades = if units == Units::Kept { vec(0..=0, 0).boxed() } else { vec(-6..=6_i32, 1..=4).boxed() };
    (0_u64..1000, 0_u64..1000, 0_u64..1000, decades).prop_map(|(order, rows, units, decades)| Change {
        order,
        rows,
        units,
        decades,
    })
}

impl Change {
    pub fn units(&self, dofs: usize) -> Vec<f64> {
        let mut rng = Rng::new(self.units);
        let mut unit = || 10_f64.powi(*self.decades.get(rng.below(self.decades.len())).unwrap_or(&0));
        (0..dofs).map(|_| unit()).collect()
    }
}

/// A variant of a system.
pub struct Variant {
    pub name: &'static str,
    pub system: ConstraintSystem,
    /// The original number of DOF j.
    pub dofs: Vec<usize>,
    /// Unit of DOF j.
    pub units: Vec<f64>,
    /// Whether coefficients are still exact.
    pub exact: bool,
}

/// The system itself, in another order, with scaled rows, with both; and, if the seeds have units, two variants in other units.
pub fn variants(scene: &Scene, change: &Change) -> Vec<Variant> {
    let units = change.units(scene.system.dofs());
    let measured = if change.decades.is_empty() { scene.clone() } else { scene.scale_dofs(&units).expect("in range") };
    let scaled = |scene: &Scene| scene.scale_rows(40, change.rows).expect("in range").0;
    let shuffled = |scene: &Scene| scene.shuffle(change.order).expect("as valid as before");
    let variant = |name, scene: Scene, dofs: Vec<usize>| Variant {
        name,
        system: scene.system,
        units: dofs.iter().map(|&j| units[j]).collect(),
        dofs,
        exact: change.decades.is_empty(),
    };
    let natural = || (0..scene.system.dofs()).collect::<Vec<_>>();
    let (in_order, order) = shuffled(&measured);
    let (both, order_of_both) = shuffled(&scaled(&measured));
    vec![
        variant("as it is", measured.clone(), natural()),
        variant("shuffled", in_order, order.dofs),
        variant("rows scaled", scaled(&measured), natural()),
        variant("shuffled and rows scaled", both, order_of_both.dofs),
    ]
}
