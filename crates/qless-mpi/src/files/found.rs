//! The data for a report, gathered on the first rank: for dependent equations only.

use std::collections::{BTreeMap, BTreeSet};

use qless::Kind;

use super::Case;
use crate::analysis::Analysis;
use crate::ranks::{Message, Outbox, Ranks, real};
use crate::solve::DistributedCertificateTerm;

/// Of the whole, in numbers from 0; all lists ascend.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Found {
    /// Redundant and conflicting equations.
    pub dependent: Vec<Equation>,
    /// Free DOFs that the equations fix, and their values.
    pub generated: Vec<(u64, f64)>,
    /// Equations that are wanted and dependent on other such equations only.
    pub unmet_equations: Vec<u64>,
    /// The dependent equations and those of their certificates.
    pub facts: BTreeMap<u64, Facts>,
}

/// A redundant or conflicting equation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Equation {
    /// Its number.
    pub number: u64,
    /// Redundant or conflicting.
    pub kind: Kind,
    /// As in [`DistributedDependent`](crate::DistributedDependent).
    pub mismatch: f64,
    /// As in [`DistributedDependent`](crate::DistributedDependent).
    pub relative_mismatch: f64,
    /// As in [`DistributedDependent`](crate::DistributedDependent).
    pub dropped: f64,
    /// Terms of its certificate.
    pub terms: usize,
    /// Its certificate; none if it was left where it is.
    pub because: Option<Vec<DistributedCertificateTerm>>,
}

/// What is said of an equation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Facts {
    /// Its right-hand side.
    pub rhs: f64,
    /// Its largest coefficient, without sign.
    pub largest: f64,
    /// DOFs in it.
    pub dofs: u64,
    /// Those of them that are prescribed.
    pub prescribed: u64,
}

impl Case {
    /// Gathers what was found on the first rank, with certificates of at most `terms` terms together, those of conflicts first. Collective;
    /// nothing on the other ranks.
    pub fn gather(&self, ranks: &dyn Ranks, analysis: &Analysis, terms: usize) -> Found {
        let mut found = Found {
            dependent: self.heads(ranks, analysis),
            generated: numbers(ranks, analysis.generated().iter().flat_map(|&(dof, value)| [dof, value.to_bits()]))
                .chunks_exact(2)
                .map(|words| (words[0], real(words[1])))
                .collect(),
            unmet_equations: numbers(ranks, analysis.unmet_equations().iter().map(|&i| self.share.numbers()[i])),
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

    /// All dependent equations, without certificates.
    fn heads(&self, ranks: &dyn Ranks, analysis: &Analysis) -> Vec<Equation> {
        let words = analysis.dependent().iter().flat_map(|d| {
            let reals = [d.mismatch, d.relative_mismatch, d.dropped].map(f64::to_bits);
            let is_conflicting = u64::from(d.kind == Kind::Conflicting);
            let number = self.share.numbers()[d.equation];
            [number, is_conflicting, reals[0], reals[1], reals[2], d.because.len() as u64]
        });
        let head = |w: &[u64]| Equation {
            number: w[0],
            kind: if w[1] == 1 { Kind::Conflicting } else { Kind::Redundant },
            mismatch: real(w[2]),
            relative_mismatch: real(w[3]),
            dropped: real(w[4]),
            terms: w[5] as usize,
            because: None,
        };
        let words = numbers(ranks, words);
        words.chunks_exact(6).map(head).collect()
    }

    /// Brings the certificates that there is room for.
    fn certificates(&self, ranks: &dyn Ranks, analysis: &Analysis, dependent: &mut [Equation], terms: usize) {
        let mut post = Outbox::default();
        let mut left = terms;
        for kind in [Kind::Conflicting, Kind::Redundant] {
            for equation in dependent.iter().filter(|equation| equation.kind == kind) {
                if equation.terms <= left {
                    post.to(self.rows.holder(equation.number)).push(equation.number);
                }
                left = left.saturating_sub(equation.terms);
            }
        }
        let first = self.rows.of(ranks.rank()).start;
        let mut answers = Outbox::default();
        for number in post.send(ranks).iter().flat_map(|message| &message.words) {
            let place = analysis.dependent().binary_search_by_key(&((number - first) as usize), |d| d.equation);
            let because = place.map_or(&[][..], |place| &analysis.dependent()[place].because);
            answers.to(0).extend([*number, because.len() as u64]);
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

    /// What is to be said of these equations, asked by the first rank.
    fn facts(&self, ranks: &dyn Ranks, named: &BTreeSet<u64>) -> BTreeMap<u64, Facts> {
        let mut post = Outbox::default();
        named.iter().for_each(|&number| post.to(self.rows.holder(number)).push(number));
        let first = self.rows.of(ranks.rank()).start;
        let asked: Vec<usize> = post
            .send(ranks)
            .iter()
            .flat_map(|message| &message.words)
            .map(|number| (number - first) as usize)
            .collect();
        let prescribed = self.prescribed_in(ranks, &asked);
        let mut answers = Outbox::default();
        for (&i, prescribed) in asked.iter().zip(prescribed) {
            let values = self.share.rows.values(i);
            let largest = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            let reals = [self.share.rows.rhs[i], largest].map(f64::to_bits);
            answers.to(0).extend([self.share.numbers()[i], reals[0], reals[1], values.len() as u64, prescribed]);
        }
        let came = answers.send(ranks);
        let words = came.iter().flat_map(|message| message.words.chunks_exact(5));
        let facts = |w: &[u64]| (w[0], Facts { rhs: real(w[1]), largest: real(w[2]), dofs: w[3], prescribed: w[4] });
        words.map(facts).collect()
    }

    /// How many DOFs of each of these equations are prescribed, as the ranks know that hold the DOFs.
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

/// The words of all ranks, rank by rank, on the first one.
fn numbers(ranks: &dyn Ranks, words: impl Iterator<Item = u64>) -> Vec<u64> {
    let words: Vec<u64> = words.collect();
    let came = ranks.exchange(if words.is_empty() { Vec::new() } else { vec![Message { rank: 0, words }] });
    came.into_iter().flat_map(|message| message.words).collect()
}
