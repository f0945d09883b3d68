//! The analysis of one load case.

use qless::report::{Counts, DependentEquation};
use qless::{Analysis, ConstraintSystem, Kind, Report, Status};
use qless_io::deck::{Deck, LoadCase};

use super::Run;
use super::claims::Claims;
use crate::failure::CliFailure;

/// The system of a load case and its analysis.
pub struct Examined {
    pub system: ConstraintSystem,
    pub analysis: Analysis,
    /// The course whose values stand alone in the system, where they conflict though all values at the end do not.
    course: Option<u32>,
}

/// The part of the analysis of a load case that is kept for the report.
pub struct Found {
    /// Without what was left out of the deck.
    pub status: Status,
    pub rank: usize,
    pub counts: Counts,
    /// With certificates, where a report shows them.
    pub dependent: Vec<DependentEquation>,
    pub solver: Claims,
    /// When that is so, unless at all times.
    pub when: Option<String>,
}

impl Found {
    pub fn of(deck: &Deck, case: &LoadCase, examined: &Examined, terms: usize) -> Self {
        let analysis = &examined.analysis;
        let (conflicting, redundant) = kinds(analysis);
        let status = match (conflicting, redundant) {
            (0, 0) => Status::Independent,
            (0, _) => Status::Redundant,
            _ => Status::Conflicting,
        };
        let dependent = if terms == 0 { Vec::new() } else { Report::new(analysis, terms).dependent };
        Self {
            status,
            rank: analysis.rank(),
            counts: Counts::new(analysis.rank(), redundant, conflicting),
            dependent,
            solver: Claims::of(deck, case),
            when: examined.course.map(|course| when(deck, course)),
        }
    }

    /// Severity, for lexicographic comparison: conflicts, redundancies, claims that the solver refuses, handles unsoundly, or drops.
    pub fn badness(&self) -> [usize; 5] {
        let Claims { refused, ignored, unsound, .. } = &self.solver;
        [self.counts.conflicting, self.counts.redundant, refused.len(), unsound.len(), ignored.len()]
    }

    /// `rank 12, 3 redundant, 1 conflicting`.
    pub fn summary(&self) -> String {
        format!("rank {}, {} redundant, {} conflicting", self.rank, self.counts.redundant, self.counts.conflicting)
    }
}

/// Analyses a load case: at its end, and, where equations depend on others, for the values of each course alone.
pub fn examine(deck: &Deck, case: &LoadCase, run: Run) -> Result<Examined, CliFailure> {
    let model = deck.model();
    let refused = |error| CliFailure::of_deck(deck, &error);
    let system = model.system(case).map_err(refused)?;
    let analysis = run(&system, (deck, case))?;
    let courses = model.courses_of(case);
    // Independent equations are consistent with every right-hand side.
    if courses.len() > 1 && analysis.dependent().iter().all(|dependent| dependent.kind == Kind::Redundant) {
        for course in courses.into_iter().filter(|_| !analysis.dependent().is_empty()) {
            let system = model.system_of_course(case, course).map_err(refused)?;
            let analysis = run(&system, (deck, case))?;
            if kinds(&analysis).0 > 0 {
                return Ok(Examined { system, analysis, course: Some(course) });
            }
        }
    }
    Ok(Examined { system, analysis, course: None })
}

fn when(deck: &Deck, course: u32) -> String {
    let name = deck.model().courses().nth(course as usize).flatten();
    let values = name.map_or("without an amplitude".to_owned(), |name| format!("of amplitude {name}"));
    format!("at times when amplitudes differ: shown for the values {values} alone")
}

/// Conflicting and redundant equations.
fn kinds(analysis: &Analysis) -> (usize, usize) {
    let of = |kind| analysis.dependent().iter().filter(|dependent| dependent.kind == kind).count();
    (of(Kind::Conflicting), of(Kind::Redundant))
}
