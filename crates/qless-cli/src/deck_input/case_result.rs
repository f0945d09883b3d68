//! The analysis of one load case.

use std::borrow::Borrow;

use qless::report::{Counts, DependentEquation};
use qless::{Analysis, ConstraintSystem, Kind, Options, Report, Status};
use qless_io::deck::{Deck, LoadCase};

use super::AnalyseCase;
use super::claims::Claims;
use crate::failure::CliFailure;

/// The system of a load case and its analysis.
pub struct CaseAnalysis {
    pub system: ConstraintSystem,
    pub analysis: Analysis,
    /// The time history (such as an amplitude) whose prescribed values alone conflict, if the values of all histories together do not.
    /// `system` then has the values of this history only.
    history: Option<u32>,
}

/// The results of a load case that the report needs.
pub struct CaseResult {
    /// The status of the equations that were read; constraints that were left out do not count.
    pub status: Status,
    pub rank: usize,
    pub is_ambiguous: bool,
    pub counts: Counts,
    /// The dependent equations, with certificates if a report shows them.
    pub dependent: Vec<DependentEquation>,
    pub claims: Claims,
    /// The times for which the result holds; `None` if it holds at all times.
    pub when: Option<String>,
}

impl Borrow<Analysis> for CaseAnalysis {
    fn borrow(&self) -> &Analysis {
        &self.analysis
    }
}

impl CaseResult {
    pub fn new(
        deck: &Deck,
        case: &LoadCase,
        CaseAnalysis { analysis, history, .. }: &CaseAnalysis,
        options: &Options,
        terms: usize,
    ) -> Self {
        let (conflicting, redundant) = count_kinds(analysis);
        let status = match (conflicting, redundant) {
            (0, 0) => Status::Independent,
            (0, _) => Status::Redundant,
            _ => Status::Conflicting,
        };
        Self {
            status,
            rank: analysis.rank(),
            is_ambiguous: analysis.confidence().ambiguous,
            counts: Counts::new(analysis.rank(), redundant, conflicting),
            dependent: if terms == 0 { Vec::new() } else { Report::new(analysis, terms).dependent },
            claims: Claims::new(deck, case, options),
            when: history.map(|history| describe_times(deck, history)),
        }
    }

    /// Sort key of the severity: the numbers of conflicts, of redundancies, and of claims that the solver refuses, loses, handles unsoundly
    /// or drops, compared in this order.
    pub fn severity(&self) -> [usize; 6] {
        let Claims { refused, implied, lost, unsound, .. } = &self.claims;
        let Counts { conflicting, redundant, .. } = self.counts;
        [conflicting, redundant, refused.len(), lost.len(), unsound.len(), implied.len()]
    }

    /// The counts in words, such as `rank 12, 3 redundant, 1 conflicting`.
    pub fn summary(&self) -> String {
        format!("rank {}, {} redundant, {} conflicting", self.rank, self.counts.redundant, self.counts.conflicting)
    }
}

/// The analysis of a load case that holds at all times, or of the first time history whose values conflict.
pub fn analyse_case(deck: &Deck, case: &LoadCase, analyse: AnalyseCase) -> Result<CaseAnalysis, CliFailure> {
    let model = deck.model();
    let analysed = |history| -> Result<CaseAnalysis, CliFailure> {
        let system = model.system_at(case, history).map_err(|error| CliFailure::from_deck(deck, &error))?;
        let analysis = analyse(&system, (deck, case))?;
        Ok(CaseAnalysis { system, analysis, history })
    };
    Ok(model.at_all_times(case, analysed)?.1)
}

fn describe_times(deck: &Deck, history: u32) -> String {
    let name = deck.model().histories().nth(history as usize).flatten();
    let values = name.map_or("without an amplitude".to_owned(), |name| format!("of amplitude {name}"));
    format!("at times when amplitudes differ: shown for the values {values} alone")
}

/// Numbers of conflicting and of redundant equations.
fn count_kinds(analysis: &Analysis) -> (usize, usize) {
    let count = |kind| analysis.dependent().iter().filter(|dependent| dependent.kind == kind).count();
    (count(Kind::Conflicting), count(Kind::Redundant))
}
