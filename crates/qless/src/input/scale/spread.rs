//! Whether the entries of a component are of one size.

use std::collections::HashSet;

use super::powers::exponent;
use super::{SMALL, Scaling, free};
use crate::input::components::Labels;
use crate::input::numbering::{Column, Exponents, LocalSystem};

/// How entries of free DOFs lie in the scaled rows of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spread {
    /// They are of one size.
    Even,
    /// Some are so small that they may be in another unit or stand for zero.
    SomeTiny,
    /// Whole columns are small: units mix.
    UnitsMix,
}

/// The components of a system in some of which entries are not of one size.
pub(crate) struct Spreads {
    pub labels: Labels,
    /// By component.
    pub of: Vec<Spread>,
}

impl Spreads {
    /// None where all entries are of one size everywhere; only where they are not does anybody need to know the components.
    pub fn new(
        system: LocalSystem,
        columns: &[Column],
        exponents: &[Exponents],
        scaling: &Scaling,
        uncertain: &HashSet<(u32, u32)>,
    ) -> Option<Self> {
        let small = small_entries(system, exponents, scaling);
        let is_small = |j: usize| columns[j].count >= 2 && small[j] == columns[j].count;
        let labels = Labels::of(system);
        let mut tallies = vec![Tally::default(); labels.count];
        let mut label = vec![0; system.dofs()];
        for (i, &component) in labels.of_row.iter().enumerate() {
            let tally = &mut tallies[component as usize];
            for (j, v) in free(system, i) {
                label[j] = component;
                if !uncertain.contains(&(i as u32, j as u32)) {
                    tally.smallest = tally.smallest.min(exponent(v) + scaling.row[i]);
                }
            }
        }
        for j in (0..system.dofs()).filter(|&j| system.free()[j] && columns[j].count >= 2) {
            let tally = &mut tallies[label[j] as usize];
            tally.shared += 1;
            tally.small += usize::from(is_small(j));
        }
        let of: Vec<Spread> = tallies.iter().map(Tally::spread).collect();
        of.iter().any(|&spread| spread != Spread::Even).then_some(Self { labels, of })
    }

    /// The equations of the components for which a condition holds.
    pub fn equations(&self, holds: impl Fn(usize) -> bool) -> Vec<bool> {
        let of: Vec<bool> = (0..self.of.len()).map(holds).collect();
        self.labels.of_row.iter().map(|&label| of[label as usize]).collect()
    }
}

/// What is counted of a component.
#[derive(Clone, Default)]
struct Tally {
    /// Smallest exponent of a free entry relative to its row.
    smallest: i32,
    /// Columns with two entries or more, ...
    shared: usize,
    /// ... and those of them that are small in all their rows.
    small: usize,
}

impl Tally {
    fn spread(&self) -> Spread {
        match self.smallest {
            _ if 20 * self.small > self.shared => Spread::UnitsMix,
            SMALL.. => Spread::Even,
            _ => Spread::SomeTiny,
        }
    }
}

/// How many entries of each column are small in their rows.
fn small_entries(system: LocalSystem, exponents: &[Exponents], scaling: &Scaling) -> Vec<u32> {
    let mut small = vec![0; system.dofs()];
    for (i, of_row) in exponents.iter().enumerate() {
        let least = i32::from(of_row.least);
        if least == 0 || least - 1023 + scaling.row[i] < SMALL {
            let entries = free(system, i).filter(|&(_, v)| exponent(v) + scaling.row[i] < SMALL);
            entries.for_each(|(j, _)| small[j] += 1);
        }
    }
    small
}
