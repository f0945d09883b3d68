//! The analysis of one load case.

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
    /// The time history whose values alone conflict, if the values of all histories together do not; the system then has only its values.
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

    /// Sort key of the severity: conflicts, redundancies, claims that the solver refuses, loses, handles unsoundly, or drops.
    pub fn severity(&self) -> [usize; 6] {
        let Claims { refused, implied, lost, unsound, .. } = &self.claims;
        let Counts { conflicting, redundant, .. } = self.counts;
        [conflicting, redundant, refused.len(), lost.len(), unsound.len(), implied.len()]
    }

    /// `rank 12, 3 redundant, 1 conflicting`.
    pub fn summary(&self) -> String {
        format!("rank {}, {} redundant, {} conflicting", self.rank, self.counts.redundant, self.counts.conflicting)
    }
}

/// Analyses a load case at its end. If some equations are redundant and the prescribed values have several time histories, also
/// analyses the values of each history alone, and returns the first analysis with a conflict.
pub fn analyse_case(deck: &Deck, case: &LoadCase, analyse: AnalyseCase) -> Result<CaseAnalysis, CliFailure> {
    let model = deck.model();
    let refused = |error| CliFailure::from_deck(deck, &error);
    let system = model.system(case).map_err(refused)?;
    let analysis = analyse(&system, (deck, case))?;
    let histories = model.histories_of(case);
    // Independent equations are consistent with every right-hand side.
    if histories.len() > 1 && !analysis.dependent().is_empty() && count_kinds(&analysis).0 == 0 {
        for history in histories {
            let system = model.system_of_history(case, history).map_err(refused)?;
            let analysis = analyse(&system, (deck, case))?;
            if count_kinds(&analysis).0 > 0 {
                return Ok(CaseAnalysis { system, analysis, history: Some(history) });
            }
        }
    }
    Ok(CaseAnalysis { system, analysis, history: None })
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
