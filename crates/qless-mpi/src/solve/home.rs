//! Results on their way home: verdicts to the ranks that hold the equations, rows of T to the ranks that own the slaves.

use qless::Kind;

use super::lines::GIVEN;
use super::{Lines, Solved};
use crate::analysis::{CertificateTerm, Dependent};
use crate::parts::Layout;
use crate::ranks::{Post, Ranks, real};

/// What came home to a rank.
pub(crate) struct Findings {
    /// Of its equations, ascending.
    pub dependent: Vec<Dependent>,
    /// Rows of the slaves that it owns.
    pub lines: Lines,
    /// Free DOFs that it owns and that the equations fix, with their values.
    pub generated: Vec<(u64, f64)>,
    /// Its equations that stand for preferences that cannot be met.
    pub unmet: Vec<usize>,
}

/// Collective.
pub(crate) fn send_home(ranks: &dyn Ranks, layout: &Layout, solved: &[Solved]) -> Findings {
    let mut verdicts = Post::default();
    let mut rows = Post::default();
    let mut values = Post::default();
    let mut unmet = Post::default();
    for solved in solved {
        solved.write_verdicts(&mut verdicts);
        solved.write_rows(layout, &mut rows);
        for &(j, value) in solved.analysis.generated() {
            let dof = solved.dofs[j];
            values.to(layout.owner(dof)).extend([dof, value.to_bits()]);
        }
        for &i in solved.analysis.unmet_equations() {
            let (rank, place) = solved.guests.home[i];
            unmet.to(rank).push(place);
        }
    }
    let mut dependent = Vec::new();
    verdicts.send(ranks).iter().for_each(|message| read_verdicts(&message.words, &mut dependent));
    dependent.sort_unstable_by_key(|d: &Dependent| d.equation);
    let mut lines = Lines::default();
    rows.send(ranks).iter().for_each(|message| lines.read(&message.words));
    let pairs = |message: crate::Message| -> Vec<(u64, f64)> {
        message.words.chunks_exact(2).map(|pair| (pair[0], real(pair[1]))).collect()
    };
    let generated = values.send(ranks).into_iter().flat_map(pairs).collect();
    let unmet = unmet.send(ranks).into_iter().flat_map(|message| message.words).map(|place| place as usize).collect();
    Findings { dependent, lines, generated, unmet }
}

impl Solved {
    fn write_verdicts(&self, post: &mut Post) {
        for dependent in self.analysis.dependent() {
            let (rank, place) = self.guests.home[dependent.row];
            let because = self.analysis.because(dependent.row).unwrap_or_default();
            let words = post.to(rank);
            words.extend([place, u64::from(dependent.kind == Kind::Conflicting)]);
            words.extend([dependent.mismatch, dependent.relative_mismatch, dependent.dropped].map(f64::to_bits));
            words.push(because.len() as u64);
            words.extend(because.iter().flat_map(|b| [self.guests.rows.numbers[b.row], b.coefficient.to_bits()]));
        }
    }

    fn write_rows(&self, layout: &Layout, post: &mut Post) {
        let reduction = &self.reduction;
        for (i, &slave) in reduction.slaves().iter().enumerate() {
            let of_masters = reduction.t().row(i).map(|(q, value)| (self.dofs[reduction.masters()[q]], value));
            let of_given =
                reduction.g_matrix().row(i).map(|(p, value)| (self.dofs[reduction.prescribed()[p]] | GIVEN, value));
            let mut terms: Vec<(u64, f64)> = of_masters.chain(of_given).collect();
            terms.sort_unstable_by_key(|&(dof, _)| dof & !GIVEN);
            let slave = self.dofs[slave];
            let words = post.to(layout.owner(slave));
            words.extend([slave, reduction.g()[i].to_bits(), terms.len() as u64]);
            words.extend(terms.into_iter().flat_map(|(dof, value)| [dof, value.to_bits()]));
        }
    }
}

fn read_verdicts(words: &[u64], dependent: &mut Vec<Dependent>) {
    let mut at = 0;
    while at < words.len() {
        let (head, len) = (&words[at..at + 6], words[at + 5] as usize);
        let terms = words[at + 6..at + 6 + 2 * len].chunks_exact(2);
        dependent.push(Dependent {
            equation: head[0] as usize,
            kind: if head[1] == 0 { Kind::Redundant } else { Kind::Conflicting },
            mismatch: real(head[2]),
            relative_mismatch: real(head[3]),
            dropped: real(head[4]),
            because: terms.map(|pair| CertificateTerm { equation: pair[0], coefficient: real(pair[1]) }).collect(),
        });
        at += 6 + 2 * len;
    }
}
