//! One attempt at the analysis: peel equations that a rank can solve alone, distribute and analyse the others, return the results.

use qless::{Confidence, Doubt, Options};

use super::WorkCounts;
use crate::components::{ConnectedComponent, ConnectedComponents, KnownDofs, Layout, NONE, TouchedDofs};
use crate::distribute::{Peel, PredictedWork, balance, exchange_equations, peel};
use crate::error::{Error, agree};
use crate::ranks::{Outbox, Ranks, real};
use crate::share::ShareRows;
use crate::solve::{
    LocalAnalysis, ReductionRows, ReturnedResults, SlaveRows, Soundness, request_rows, return_results, substitute,
};

/// The input of the analysis, which is the same in all attempts.
pub(super) struct AttemptInput<'a> {
    pub ranks: &'a dyn Ranks,
    pub layout: &'a Layout,
    pub rows: &'a ShareRows,
    pub touched: &'a TouchedDofs,
    pub known: &'a KnownDofs,
    pub options: &'a Options,
}

/// The result of an attempt.
pub(super) struct Attempt {
    pub findings: ReturnedResults,
    pub confidence: Confidence,
    pub work: WorkCounts,
    /// For each fragment (the portion of a component on this rank): true if the attempt showed that no equation of the component should
    /// have been peeled.
    pub unsound: Vec<bool>,
}

/// Peak memory of the serial analysis for each term and each equation of a component, without a factorization. Factorizations have
/// limits of their own.
const BYTES_OF_TERM: u64 = 60;
const BYTES_OF_EQUATION: u64 = 200;

impl AttemptInput<'_> {
    /// The equations of this rank, their DOFs, and what is known about these DOFs: the input of every stage.
    fn inputs(&self) -> (&ShareRows, &TouchedDofs, &KnownDofs) {
        (self.rows, self.touched, self.known)
    }

    /// Makes one attempt. Collective.
    pub fn attempt(&self, whole: &ConnectedComponents, may_peel: &[bool]) -> Result<Attempt, Error> {
        let Self { ranks, layout, rows, touched, known, options } = *self;
        let fragment = |i: usize| whole.of_row[i] as usize;
        let peels = peel(rows, touched, known, |i| may_peel[fragment(i)]);
        let mut gone = vec![false; rows.len()];
        peels.iter().for_each(|peel| gone[peel.row()] = true);
        let rest = ConnectedComponents::find(ranks, layout, self.inputs(), |i| !gone[i]);
        let components = rest.total(ranks, &loads(rows, &rest), |total, load| {
            *total = [total[0] + load[0], total[1] + load[1]];
        });
        agree(ranks, self.fits(&components))?;
        let to = balance(ranks, &rest, &components);
        let assigned_to = |i: usize| (!gone[i]).then(|| to[rest.of_row[i] as usize] as usize);
        // A core is what remains of a component after peeling. Cores are analysed apart from the other equations, because an unsound
        // core must not affect these.
        let is_core = |i: usize| may_peel[fragment(i)];
        let cores = exchange_equations(ranks, self.inputs(), |i| assigned_to(i).filter(|_| is_core(i)));
        let others = exchange_equations(ranks, self.inputs(), |i| assigned_to(i).filter(|_| !is_core(i)));
        let analysed = cores.rows.len() + others.rows.len();
        let solve = |assigned, options: &Options| {
            LocalAnalysis::new(assigned, layout.owned(ranks.rank()), options)
                .map_err(|failure| failure.on(ranks.rank()))
        };
        let solved = solve(cores, options).and_then(|cores| Ok((cores, solve(others, options)?)));
        let (cores, others) = agree(ranks, solved)?;
        let mut unsound = self.unsound_cores(cores.as_ref(), whole);
        let solved: Vec<LocalAnalysis> = cores.into_iter().chain(others).collect();
        let mut findings = return_results(ranks, layout, &solved);
        let confidence = self.confidence(&solved);
        findings.reduction = findings.reduction.sort();
        self.substitute(&peels, &mut findings, |i| unsound[fragment(i)] = true);
        let sent = (0..rows.len()).filter(|&i| assigned_to(i).is_some_and(|rank| rank != ranks.rank())).count();
        let work = WorkCounts { peeled: peels.len(), analysed, sent, attempts: 0 };
        Ok(Attempt { findings, confidence, work, unsound })
    }

    /// Checks that each component whose equations must be gathered from several ranks fits into the memory limit of one rank.
    fn fits(&self, components: &[ConnectedComponent<2>]) -> Result<(), Error> {
        let (limit, own) = (self.options.memory as u64, self.ranks.rank());
        for [equations, terms] in components.iter().filter(|c| c.crosses(own)).map(|c| c.total) {
            let bytes = BYTES_OF_EQUATION * equations + BYTES_OF_TERM * terms;
            if bytes > limit {
                return Err(Error::TooLarge { equations, terms, bytes, limit });
            }
        }
        Ok(())
    }

    /// For each fragment (the portion of a component on this rank): true if the core of its component was found unsound. A rank gives one
    /// judgement for all cores that it analysed.
    fn unsound_cores(&self, cores: Option<&LocalAnalysis>, whole: &ConnectedComponents) -> Vec<bool> {
        let mut post = Outbox::default();
        if let Some(solved) = cores.filter(|solved| solved.soundness() == Soundness::Unsound) {
            solved.assigned.source.iter().for_each(|&(rank, place)| post.to(rank).push(place));
        }
        let mut unsound = vec![false; whole.fragments()];
        for message in post.send(self.ranks) {
            message.words.iter().for_each(|&i| unsound[whole.of_row[i as usize] as usize] = true);
        }
        unsound
    }

    /// The confidence of all ranks together. The mismatch of an equation `0 = b` is compared with the largest right-hand side of the job.
    fn confidence(&self, solved: &[LocalAnalysis]) -> Confidence {
        let bits = |x: f64| x.to_bits();
        let fold = |pick: &dyn Fn(Confidence) -> f64, start: f64, with: fn(f64, f64) -> f64| {
            solved.iter().map(|solved| pick(solved.confidence())).fold(start, with)
        };
        let largest = self.rows.rhs.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
        let mut most = [
            u64::MAX - bits(fold(&|c| c.distance, 1.0, f64::min)),
            bits(fold(&|c| c.error, 0.0, f64::max)),
            bits(largest),
        ];
        self.ranks.max(&mut most);
        let largest = real(most[2]);
        let is_small = |solved: &LocalAnalysis| {
            let empty = |row: usize| solved.assigned.rows.row(row).next().is_none();
            solved
                .analysis
                .dependent()
                .iter()
                .any(|d| empty(d.row) && d.mismatch != 0.0 && d.mismatch.abs() < SMALL_MISMATCH * largest)
        };
        let own = solved.iter().filter_map(|solved| solved.confidence().doubt);
        let small = solved.iter().any(is_small).then_some(Doubt::Mismatch);
        let place = |doubt: Doubt| DOUBTS.iter().position(|&one| one == doubt).map_or(0, |place| 1 + place as u64);
        let mut doubts = [own.chain(small).map(place).max().unwrap_or(0)];
        self.ranks.max(&mut doubts);
        let other = DOUBTS.into_iter().find(|&doubt| place(doubt) == doubts[0]);
        Confidence::of(real(u64::MAX - most[0]), real(most[1]), self.options.tolerance, other)
    }

    /// Computes the rows of T for the peeled equations and sends them to the owners of their slaves. Calls `unsound` with each
    /// equation that should not have been peeled.
    fn substitute(&self, peels: &[Peel], findings: &mut ReturnedResults, mut unsound: impl FnMut(usize)) {
        let Self { ranks, layout, rows, touched, known, options } = *self;
        let slaves = self.slaves_of(peels, &findings.reduction);
        let own = layout.owned(ranks.rank());
        let mut post = Outbox::default();
        let mut scratch = ReductionRows::default();
        let terms = |peel: &Peel| rows.values(peel.row()).len() - 1;
        findings.reduction.reserve(peels.len(), peels.iter().map(terms).sum());
        for &peel in peels {
            let slave = rows.dofs[peel.place(rows)];
            let into = if own.contains(&slave) { &mut findings.reduction } else { &mut scratch };
            if substitute(into, peel, (rows, touched, known), &slaves, options.growth) == Soundness::Unsound {
                unsound(peel.row());
            }
            if scratch.len() > 0 {
                scratch.row(0).write(post.to(layout.owner(slave)));
                scratch.clear();
            }
        }
        post.send(ranks).iter().for_each(|message| findings.reduction.read(&message.words));
    }

    /// Collects the rows of T that peeled equations need: their terms may contain slaves of equations that were not peeled. Slaves of
    /// peeled equations need no row here, because each occurs in one equation only.
    fn slaves_of(&self, peels: &[Peel], own: &ReductionRows) -> SlaveRows {
        let Self { ranks, layout, rows, touched, known, .. } = *self;
        let mut wanted = vec![false; touched.dofs.len()];
        for peel in peels {
            let others = (rows.starts[peel.row()]..rows.starts[peel.row() + 1]).filter(|&k| k != peel.place(rows));
            others.map(|k| touched.places[k] as usize).for_each(|j| wanted[j] = known.flags[j].is_free());
        }
        let dofs: Vec<u64> =
            touched.dofs.iter().zip(wanted).filter(|(_, wanted)| *wanted).map(|(&dof, _)| dof).collect();
        let reduction = request_rows(ranks, layout, own, &dofs);
        let mut of_place = vec![NONE; touched.dofs.len()];
        for (i, dof) in reduction.slaves().enumerate() {
            if let Ok(place) = touched.dofs.binary_search(&dof) {
                of_place[place] = i as u32;
            }
        }
        let is_prescribed = known.flags.iter().map(|flags| !flags.is_free()).collect();
        SlaveRows { reduction, of_place, is_prescribed }
    }
}

/// Doubts by ascending priority. If ranks have several doubts, the last in this list is reported, as in the serial analysis.
const DOUBTS: [Doubt; 7] =
    [Doubt::Unproved, Doubt::Exact, Doubt::Mismatch, Doubt::Elimination, Doubt::NoGap, Doubt::Near, Doubt::Noise];

/// A mismatch below this fraction of the largest right-hand side is in doubt; the same threshold as in the serial confidence.
const SMALL_MISMATCH: f64 = 1e-6;

/// The number of equations and the number of terms of each fragment (the portion of a component on this rank).
fn loads(rows: &ShareRows, components: &ConnectedComponents) -> Vec<PredictedWork> {
    let mut loads = vec![[0, 0]; components.fragments()];
    for (i, &fragment) in components.of_row.iter().enumerate().filter(|&(_, &fragment)| fragment != NONE) {
        loads[fragment as usize][0] += 1;
        loads[fragment as usize][1] += rows.values(i).len() as u64;
    }
    loads
}
