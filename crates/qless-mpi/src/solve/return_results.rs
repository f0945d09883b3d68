//! Returns the results: verdicts to the ranks that hold the equations, rows of T to the ranks that own the slaves.

use qless::Kind;

use super::rows::PRESCRIBED_BIT;
use super::{LocalAnalysis, ReductionRows};
use crate::components::Layout;
use crate::ranks::{Message, Outbox, Ranks, real};

/// A redundant or conflicting equation of this rank.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct DistributedDependent {
    /// The index of the dependent equation among the equations of the share.
    pub equation: usize,
    /// Whether the equation is redundant or conflicting.
    pub kind: Kind,
    /// `b_k - sum c_i b_i` for this equation k, in its units. The c_i are the coefficients of the certificate, and b are the right-hand
    /// sides with the prescribed DOFs moved into them.
    pub mismatch: f64,
    /// The mismatch relative to its largest term; 0 if it is within rounding.
    pub relative_mismatch: f64,
    /// What remains of the equation after its certificate is subtracted, relative to the equation. The analysis treated it as zero. It is 0
    /// if it is within rounding.
    pub dropped: f64,
    /// The certificate `row_k = sum c_i row_i` over free DOFs, ascending by equation number. The equations may be of any rank.
    pub because: Vec<DistributedCertificateTerm>,
}

/// One term of a certificate: `coefficient` times an equation of the job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistributedCertificateTerm {
    /// The number of a kept equation.
    pub equation: u64,
    /// The coefficient of this equation.
    pub coefficient: f64,
}

/// The results for the equations and DOFs of one rank.
pub(crate) struct ReturnedResults {
    /// The dependent equations of this rank, ascending.
    pub dependent: Vec<DistributedDependent>,
    /// Rows of T of the slaves that this rank owns.
    pub reduction: ReductionRows,
    /// Free DOFs that this rank owns and that the equations fix, with their values.
    pub generated: Vec<(u64, f64)>,
    /// Preferred equations of this rank that depend on other preferred equations only.
    pub unmet: Vec<usize>,
}

/// Sends verdicts to the ranks that hold the equations, and rows of T to the owners of the slaves. Collective.
pub(crate) fn return_results(ranks: &dyn Ranks, layout: &Layout, solved: &[LocalAnalysis]) -> ReturnedResults {
    let mut verdicts = Outbox::default();
    let mut rows = Outbox::default();
    let mut values = Outbox::default();
    let mut unmet = Outbox::default();
    for solved in solved {
        solved.write_verdicts(&mut verdicts);
        solved.write_rows(layout, &mut rows);
        for &(j, value) in solved.analysis.generated() {
            let dof = solved.dofs[j];
            values.to(layout.owner(dof)).extend([dof, value.to_bits()]);
        }
        for &i in solved.analysis.unmet_equations() {
            let (rank, place) = solved.assigned.source[i];
            unmet.to(rank).push(place);
        }
    }
    let mut dependent = Vec::new();
    verdicts.send(ranks).iter().for_each(|message| read_verdicts(&message.words, &mut dependent));
    dependent.sort_unstable_by_key(|d: &DistributedDependent| d.equation);
    let mut reduction = ReductionRows::default();
    rows.send(ranks).iter().for_each(|message| reduction.read(&message.words));
    let generated = values.send_records(ranks).map(|(_, [dof, bits])| (dof, real(bits))).collect();
    let unmet = unmet.send_records(ranks).map(|(_, [place])| place as usize).collect();
    ReturnedResults { dependent, reduction, generated, unmet }
}

/// The rows of T, G and g of those DOFs in `dofs` (ascending) that are slaves. `rows` are the rows of the slaves that this rank owns.
/// Collective.
pub(crate) fn request_rows(ranks: &dyn Ranks, layout: &Layout, rows: &ReductionRows, dofs: &[u64]) -> ReductionRows {
    let own = layout.owned(ranks.rank());
    let mut post = Outbox::default();
    dofs.iter().filter(|dof| !own.contains(dof)).for_each(|&dof| post.to(layout.owner(dof)).push(dof));
    let answer = |message: Message| {
        let mut words = Vec::new();
        message.words.iter().filter_map(|&dof| rows.find(dof)).for_each(|row| row.write(&mut words));
        Message { rank: message.rank, words }
    };
    let answers = post.send(ranks).into_iter().map(answer).filter(|message| !message.words.is_empty()).collect();
    let mut found = ReductionRows::default();
    rows.among(dofs).for_each(|row| found.push_row(row));
    ranks.exchange(answers).iter().for_each(|message| found.read(&message.words));
    found
}

impl LocalAnalysis {
    fn write_verdicts(&self, post: &mut Outbox) {
        for dependent in self.analysis.dependent() {
            let (rank, place) = self.assigned.source[dependent.row];
            let because = self.analysis.because(dependent.row).unwrap_or_default();
            let words = post.to(rank);
            words.extend([place, u64::from(dependent.kind == Kind::Conflicting)]);
            words.extend([dependent.mismatch, dependent.relative_mismatch, dependent.dropped].map(f64::to_bits));
            words.push(because.len() as u64);
            words.extend(because.iter().flat_map(|b| [self.assigned.rows.numbers[b.row], b.coefficient.to_bits()]));
        }
    }

    fn write_rows(&self, layout: &Layout, post: &mut Outbox) {
        let reduction = &self.reduction;
        for (i, &slave) in reduction.slaves().iter().enumerate() {
            let masters = reduction.t().row(i).map(|(q, value)| (self.dofs[reduction.masters()[q]], value));
            let prescribed = reduction
                .g_matrix()
                .row(i)
                .map(|(p, value)| (self.dofs[reduction.prescribed()[p]] | PRESCRIBED_BIT, value));
            let mut terms: Vec<(u64, f64)> = masters.chain(prescribed).collect();
            terms.sort_unstable_by_key(|&(dof, _)| dof & !PRESCRIBED_BIT);
            let slave = self.dofs[slave];
            let words = post.to(layout.owner(slave));
            words.extend([slave, reduction.g()[i].to_bits(), terms.len() as u64]);
            words.extend(terms.into_iter().flat_map(|(dof, value)| [dof, value.to_bits()]));
        }
    }
}

fn read_verdicts(words: &[u64], dependent: &mut Vec<DistributedDependent>) {
    let mut at = 0;
    while at < words.len() {
        let (head, len) = (&words[at..at + 6], words[at + 5] as usize);
        let terms = words[at + 6..at + 6 + 2 * len].chunks_exact(2);
        dependent.push(DistributedDependent {
            equation: head[0] as usize,
            kind: if head[1] == 0 { Kind::Redundant } else { Kind::Conflicting },
            mismatch: real(head[2]),
            relative_mismatch: real(head[3]),
            dropped: real(head[4]),
            because: terms
                .map(|pair| DistributedCertificateTerm { equation: pair[0], coefficient: real(pair[1]) })
                .collect(),
        });
        at += 6 + 2 * len;
    }
}
