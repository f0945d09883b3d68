//! Gathers the data for a report on the first rank: dependent equations and fixed DOFs.

use std::collections::{BTreeMap, BTreeSet};

use qless::Kind;

use super::Case;
use crate::analysis::Analysis;
use crate::ranks::{Message, Outbox, Ranks, real, records};
use crate::solve::DistributedCertificateTerm;

/// Findings of all ranks, by numbers from 0 in the whole system. All lists ascend.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct GatheredFindings {
    /// Redundant and conflicting equations.
    pub dependent: Vec<Equation>,
    /// Free DOFs that the equations fix, and their values.
    pub generated: Vec<(u64, f64)>,
    /// Preferred equations ([`qless::Preferences`]) that depend on other preferred equations only.
    pub unmet_equations: Vec<u64>,
    /// Facts about the dependent equations and the equations of their certificates.
    pub facts: BTreeMap<u64, Facts>,
}

/// A redundant or conflicting equation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Equation {
    /// The number of the equation.
    pub number: u64,
    /// Whether the equation is redundant or conflicting.
    pub kind: Kind,
    /// The same value as `mismatch` in [`DistributedDependent`](crate::DistributedDependent).
    pub mismatch: f64,
    /// The same value as `relative_mismatch` in [`DistributedDependent`](crate::DistributedDependent).
    pub relative_mismatch: f64,
    /// The same value as `dropped` in [`DistributedDependent`](crate::DistributedDependent).
    pub dropped: f64,
    /// Number of terms of the certificate.
    pub terms: usize,
    /// The certificate of the equation; `None` if it was not gathered.
    pub because: Option<Vec<DistributedCertificateTerm>>,
}

/// Facts about an equation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Facts {
    /// The right-hand side of the equation.
    pub rhs: f64,
    /// The largest absolute value of a coefficient of the equation.
    pub largest: f64,
    /// Number of DOFs of the equation.
    pub dofs: u64,
    /// Number of prescribed DOFs of the equation.
    pub prescribed: u64,
}

impl Case {
    /// Gathers the findings on the first rank. Also gathers certificates, those of conflicting equations first, as long as they have at
    /// most `terms` terms in total. The result is empty on the other ranks. Collective.
    pub fn gather(&self, ranks: &dyn Ranks, analysis: &Analysis, terms: usize) -> GatheredFindings {
        let mut found = GatheredFindings {
            dependent: self.heads(ranks, analysis),
            generated: gather(ranks, analysis.generated().iter().flat_map(|&(dof, value)| [dof, value.to_bits()]))
                .map(|[dof, bits]| (dof, real(bits)))
                .collect(),
            unmet_equations: gather(ranks, analysis.unmet_equations().iter().map(|&i| self.share.numbers()[i]))
                .map(|[number]| number)
                .collect(),
            facts: BTreeMap::new(),
        };
        self.certificates(ranks, analysis, &mut found.dependent, terms);
        let because = |equation: &Equation| {
            equation.because.iter().flatten().map(|term| term.equation).chain([equation.number]).collect::<Vec<_>>()
        };
        let named: BTreeSet<u64> = found.dependent.iter().flat_map(because).collect();
        found.facts = self.facts(ranks, &named);
        found
    }

    /// The redundant and conflicting equations of all ranks, without certificates.
    fn heads(&self, ranks: &dyn Ranks, analysis: &Analysis) -> Vec<Equation> {
        let words = analysis.dependent().iter().flat_map(|d| {
            let reals = [d.mismatch, d.relative_mismatch, d.dropped].map(f64::to_bits);
            let is_conflicting = u64::from(d.kind == Kind::Conflicting);
            let number = self.share.numbers()[d.equation];
            [number, is_conflicting, reals[0], reals[1], reals[2], d.because.len() as u64]
        });
        let head = |w: [u64; 6]| Equation {
            number: w[0],
            kind: if w[1] == 1 { Kind::Conflicting } else { Kind::Redundant },
            mismatch: real(w[2]),
            relative_mismatch: real(w[3]),
            dropped: real(w[4]),
            terms: w[5] as usize,
            because: None,
        };
        gather(ranks, words).map(head).collect()
    }

    /// Gathers certificates of at most `terms` terms in total.
    fn certificates(&self, ranks: &dyn Ranks, analysis: &Analysis, dependent: &mut [Equation], terms: usize) {
        let mut post = Outbox::default();
        let mut remaining = terms;
        for kind in [Kind::Conflicting, Kind::Redundant] {
            for equation in dependent.iter().filter(|equation| equation.kind == kind) {
                if equation.terms <= remaining {
                    post.to(self.rows.holder(equation.number)).push(equation.number);
                }
                remaining = remaining.saturating_sub(equation.terms);
            }
        }
        let first = self.rows.of(ranks.rank()).start;
        let mut answers = Outbox::default();
        for (_, [number]) in post.send_records(ranks) {
            let place = analysis.dependent().binary_search_by_key(&((number - first) as usize), |d| d.equation);
            let because = place.map_or(&[][..], |place| &analysis.dependent()[place].because);
            answers.to(0).extend([number, because.len() as u64]);
            answers.to(0).extend(because.iter().flat_map(|term| [term.equation, term.coefficient.to_bits()]));
        }
        for Message { words, .. } in answers.send(ranks) {
            let mut rest = &words[..];
            while let [number, count, tail @ ..] = rest {
                let (own, others) = tail.split_at(2 * *count as usize);
                let term = |w: &[u64]| DistributedCertificateTerm { equation: w[0], coefficient: real(w[1]) };
                if let Ok(place) = dependent.binary_search_by_key(number, |equation| equation.number) {
                    dependent[place].because = Some(own.chunks_exact(2).map(term).collect());
                }
                rest = others;
            }
        }
    }

    /// Gathers facts about the equations in `named` on the first rank. `named` is empty on all other ranks. Collective.
    fn facts(&self, ranks: &dyn Ranks, named: &BTreeSet<u64>) -> BTreeMap<u64, Facts> {
        let mut post = Outbox::default();
        named.iter().for_each(|&number| post.to(self.rows.holder(number)).push(number));
        let first = self.rows.of(ranks.rank()).start;
        let requested: Vec<usize> = post.send_records(ranks).map(|(_, [number])| (number - first) as usize).collect();
        let prescribed = self.prescribed_in(ranks, &requested);
        let mut answers = Outbox::default();
        for (&i, prescribed) in requested.iter().zip(prescribed) {
            let values = self.share.rows.values(i);
            let largest = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            let reals = [self.share.rows.rhs[i], largest].map(f64::to_bits);
            answers.to(0).extend([self.share.numbers()[i], reals[0], reals[1], values.len() as u64, prescribed]);
        }
        let facts = |(_, [number, rhs, largest, dofs, prescribed]): (usize, [u64; 5])| {
            (number, Facts { rhs: real(rhs), largest: real(largest), dofs, prescribed })
        };
        answers.send_records(ranks).map(facts).collect()
    }

    /// Number of prescribed DOFs of each equation, from the ranks that hold the DOFs. Collective.
    fn prescribed_in(&self, ranks: &dyn Ranks, equations: &[usize]) -> Vec<u64> {
        let mut post = Outbox::default();
        let mut askers: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (k, &i) in equations.iter().enumerate() {
            for (dof, _) in self.share.rows.row(i) {
                let holder = self.dofs.holder(dof);
                post.to(holder).push(dof);
                askers.entry(holder).or_default().push(k);
            }
        }
        let known: BTreeSet<u64> = self.share.prescribed.iter().map(|&(dof, _)| dof).collect();
        let mut answers = Outbox::default();
        for Message { rank, words } in post.send(ranks) {
            answers.to(rank).extend(words.iter().map(|dof| u64::from(known.contains(dof))));
        }
        let mut counts = vec![0; equations.len()];
        for Message { rank, words } in answers.send(ranks) {
            askers[&rank].iter().zip(words).for_each(|(&k, is_prescribed)| counts[k] += is_prescribed);
        }
        counts
    }
}

/// Gathers `words` from all ranks on the first rank, in the order of the ranks, and splits them into records of N words.
fn gather<const N: usize>(ranks: &dyn Ranks, words: impl Iterator<Item = u64>) -> impl Iterator<Item = [u64; N]> {
    let words: Vec<u64> = words.collect();
    let messages = if words.is_empty() { Vec::new() } else { vec![Message { rank: 0, words }] };
    records(ranks.exchange(messages)).map(|(_, record)| record)
}
