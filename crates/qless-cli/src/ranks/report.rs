//! The report of the first rank, as text or JSON.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

use qless::backend::Backend;
use qless::explanation::{Explanation, Member};
use qless::report::{
    BackendUsed, Certificate, Counts, DependentEquation, GeneratedCondition, InputSizes, Omitted, Term,
};
use qless::{Options, Report};
use qless_io::chunk::find_labels;
use qless_mpi::{Analysis, Case, Equation, GatheredFindings};

use crate::args::ReportFormat;
use crate::failure::CliFailure;
use crate::report::text::{DependentRow, EquationList};
use crate::report::{CommandOutcome, json, text};
use crate::wording::{EquationFacts, EquationLookup};

/// The findings of all ranks.
pub struct Findings<'a> {
    pub case: &'a Case,
    pub analysis: &'a Analysis,
    pub found: &'a GatheredFindings,
    pub options: &'a Options,
    pub ranks: usize,
}

/// Labels and facts of the equations in the report.
struct RankEquations<'a> {
    found: &'a GatheredFindings,
    labels: BTreeMap<usize, String>,
}

impl EquationLookup for RankEquations<'_> {
    fn label(&self, row: usize) -> String {
        self.labels.get(&row).cloned().unwrap_or_else(|| format!("row {}", row + 1))
    }

    fn facts(&self, row: usize) -> EquationFacts {
        let facts = self.found.facts[&(row as u64)];
        let (dofs, prescribed) = (facts.dofs as usize, facts.prescribed as usize);
        EquationFacts { rhs: facts.rhs, largest: facts.largest, dofs, prescribed }
    }
}

impl Findings<'_> {
    /// The report in the requested format; `times` are the start of the run and the duration of reading.
    pub fn render(
        &self,
        input: &Path,
        format: ReportFormat,
        times: (Instant, Duration),
    ) -> Result<Vec<u8>, CliFailure> {
        let rows: Vec<usize> = self.found.facts.keys().map(|&row| row as usize).collect();
        let known = RankEquations { found: self.found, labels: labels(self.case.files().rows.as_deref(), &rows)? };
        let report = self.report(&known)?.with_timings(times.1, Duration::ZERO, times.0.elapsed());
        if format == ReportFormat::Text {
            return Ok(self.text(&known, &report, input).into_bytes());
        }
        let mut bytes = Vec::new();
        json::write(&mut bytes, None, &report, None).map_err(|error| CliFailure::from_stdout(&error))?;
        Ok(bytes)
    }

    fn text(&self, known: &RankEquations, report: &Report, input: &Path) -> String {
        let explain = |row: usize| {
            let equation = self.equation(row)?;
            let asked = known.facts(row).rhs;
            let members = equation.because.as_ref().map_or_else(Vec::new, |because| members(because));
            Some(Explanation::new(members, asked - equation.mismatch, 0.0))
        };
        let finding = |equation: &Equation| DependentRow {
            row: equation.number as usize,
            kind: equation.kind,
            mismatch: equation.mismatch,
            relative_mismatch: equation.relative_mismatch,
            dropped: equation.dropped,
        };
        let dependent = self.found.dependent.iter().map(finding).collect();
        let list = EquationList {
            idle_loads: 0,
            input,
            deck: None,
            tolerance: self.options.tolerance,
            equations: known,
            dependent,
            system: None,
            explain: &explain,
        };
        text::whole(&list, report, &CommandOutcome::Checked(None), &[], Vec::new())
    }

    fn equation(&self, row: usize) -> Option<&Equation> {
        let place = self.found.dependent.binary_search_by_key(&(row as u64), |equation| equation.number);
        place.ok().map(|place| &self.found.dependent[place])
    }

    fn report(&self, known: &RankEquations) -> Result<Report, CliFailure> {
        let (case, counts) = (self.case, self.analysis.counts());
        let sizes = [case.rows(), case.dofs(), case.coefficients(), case.prescribed()].map(|count| count as usize);
        let input = InputSizes::new(sizes[0], sizes[1], sizes[2], sizes[3]);
        let [independent, redundant, conflicting] =
            [counts.rank(), counts.redundant, counts.conflicting].map(|count| count as usize);
        let counts = Counts::new(independent, redundant, conflicting);
        let certainty = (self.options.effort, self.analysis.confidence());
        let mut report = Report::of_ranks(self.ranks, input, counts, certainty, self.backend()?);
        report.dependent = self.found.dependent.iter().map(|equation| dependent(equation, known)).collect();
        report.generated_boundary_conditions = self.generated()?;
        report.unmet_preferences.equations = self.found.unmet_equations.iter().map(|row| *row as usize + 1).collect();
        Ok(report)
    }

    fn backend(&self) -> Result<BackendUsed, CliFailure> {
        let backend: Box<dyn Backend> =
            self.options.backend.get(self.options.memory).map_err(|error| CliFailure::Input(error.to_string()))?;
        Ok(BackendUsed::new(backend.name(), rayon::current_num_threads(), backend.version()))
    }

    /// The generated boundary conditions. Their certificates are not computed across ranks.
    fn generated(&self) -> Result<Vec<GeneratedCondition>, CliFailure> {
        let dofs: Vec<usize> = self.found.generated.iter().map(|&(dof, _)| dof as usize).collect();
        let mut labels = labels(self.case.files().columns.as_deref(), &dofs)?;
        let condition = |&(dof, value): &(u64, f64)| {
            let dof = dof as usize;
            let label = labels.remove(&dof).unwrap_or_else(|| format!("DOF {}", dof + 1));
            GeneratedCondition::new(dof + 1, label, value, Certificate::left_out(Omitted::NotComputed))
        };
        Ok(self.found.generated.iter().map(condition).collect())
    }
}

fn labels(path: Option<&Path>, wanted: &[usize]) -> Result<BTreeMap<usize, String>, CliFailure> {
    Ok(path.map_or_else(|| Ok(BTreeMap::new()), |path| find_labels(path, wanted))?)
}

/// The members of a certificate. Across ranks, certificates have no prescribed values.
fn members(because: &[qless_mpi::DistributedCertificateTerm]) -> Vec<Member> {
    let member = |term: &qless_mpi::DistributedCertificateTerm| Member::Equation {
        row: term.equation as usize,
        coefficient: term.coefficient,
    };
    because.iter().map(member).collect()
}

fn dependent(equation: &Equation, known: &RankEquations) -> DependentEquation {
    let row = equation.number as usize;
    let term = |term: &qless_mpi::DistributedCertificateTerm| {
        Term::equation(term.equation as usize + 1, known.label(term.equation as usize), term.coefficient)
    };
    let certificate = match &equation.because {
        Some(because) => Certificate::complete(because.iter().map(term).collect()),
        None => Certificate::left_out(Omitted::Terms(equation.terms)),
    };
    DependentEquation::new(row + 1, known.label(row), equation.kind, equation.mismatch, certificate)
}
