//! The entry point: reads a system as given, or twice if some of its numbers may be rounding.

use std::collections::HashSet;

use super::analyse::read;
use super::confidence::{Confidence, Doubt};
use super::exact::{self, ExactRank, PartRank, Settings};
use super::{Analysis, AnalysisError, Proof};
use crate::input::components::Labels;
use crate::input::noise::{NoiseTerm, Suspects};
use crate::input::numbering::Numbering;
use crate::{ConstraintSystem, Effort, Kind, Noise, Options, Tolerance};

/// The result if numbers that may be rounding are read the other way.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct OtherReading {
    /// True if suspect coefficients count as zero in this reading, false if they count as given.
    pub as_zero: bool,
    /// The coefficients that are read differently, ascending by row.
    pub terms: Vec<NoiseTerm>,
    /// The rank in this reading.
    pub rank: usize,
    /// Number of conflicting equations in this reading.
    pub conflicting: usize,
}

/// Diagnoses `C u = b`: rank, dependent equations, generated boundary conditions.
///
/// ```
/// use qless::{Kind, Options, SystemBuilder, analyse};
/// // Three equations that tie three DOFs in a ring: the last follows from the others.
/// let mut builder = SystemBuilder::new(3);
/// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
/// builder.equation([(1, 1.0), (2, -1.0)], 0.0);
/// builder.equation([(0, 1.0), (2, -1.0)], 0.0);
/// let system = builder.build()?;
/// let analysis = analyse(&system, &Options::default())?;
/// assert_eq!((analysis.rank(), analysis.kinds()[2]), (2, Kind::Redundant));
/// let because = analysis.because(2)?;
/// assert_eq!(because.iter().map(|term| (term.row, term.coefficient)).collect::<Vec<_>>(), [(0, 1.0), (1, 1.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError`] if a setting is out of range, a block does not fit into memory, or numbers leave the range of
/// doubles. No input that is a valid [`ConstraintSystem`] makes it panic.
pub fn analyse(system: &ConstraintSystem, options: &Options) -> Result<Analysis, AnalysisError> {
    options.validate()?;
    options.noise.validate(system)?;
    options.preferences.validate(system)?;
    let numbered = Numbering::new(system);
    let local = numbered.0.view(system, system.rhs());
    let suspects = match options.tolerance {
        Tolerance::Paper => Suspects::default(),
        Tolerance::Relative(_) => Suspects::find(local, &numbered.2, &options.noise),
    };
    let mut analysis = if suspects.rows.is_empty() && suspects.single.is_empty() {
        read(system.clone(), numbered, options)?
    } else {
        read_twice(system, options, &suspects)?
    };
    match options.effort {
        Effort::Quick => {}
        Effort::Checked => analysis.check_sides(),
        Effort::Proved => analysis.prove(),
        Effort::Exact => analysis.compare_with_exact(system)?,
    }
    Ok(analysis)
}

/// Bytes of a coefficient in exact elimination modulo two primes at the same time.
const BYTES: usize = 48;

impl Analysis {
    /// Adds the exact rank of the system as given. Raises a doubt if a part has another result, or if the equations that do not conflict
    /// have no solution.
    fn compare_with_exact(&mut self, system: &ConstraintSystem) -> Result<(), AnalysisError> {
        let settings = Settings { fill: self.options.memory / BYTES, ..self.options.numbers.into() };
        let exact = exact::rank(system, settings)?;
        let has_solution = || {
            let agrees = |row: usize| self.kinds[row] != Kind::Conflicting;
            let agreeing = system.only(|row, _| agrees(row), agrees);
            exact::rank(&agreeing, settings).map(|exact| exact.parts.iter().all(|part| part.solvable))
        };
        let is_conflicting = self.kinds.contains(&Kind::Conflicting);
        let is_same = analysed_parts(&self.kinds, &exact) == exact.parts && (!is_conflicting || has_solution()?);
        self.confidence = if is_same { self.confidence.settled() } else { self.confidence.or(Doubt::Exact) };
        self.exact = Some(exact);
        // If exact arithmetic agrees, a missing proof is no doubt.
        self.proof = Some(Proof::of(self));
        Ok(())
    }
}

/// The rank and solvability that the floating-point analysis found for each part of an exact rank.
pub(crate) fn analysed_parts(kinds: &[Kind], exact: &ExactRank) -> Vec<PartRank> {
    let mut parts = vec![PartRank { equations: 0, rank: 0, solvable: true }; exact.parts.len()];
    for (&kind, &part) in kinds.iter().zip(&exact.part_of) {
        let part = &mut parts[part as usize];
        part.equations += 1;
        part.rank += usize::from(kind == Kind::Independent);
        part.solvable &= kind != Kind::Conflicting;
    }
    parts
}

/// Analyses the system with the coefficients `suspects.rows` read as zero: they belong to equations that may consist of rounding only. Then
/// analyses the affected components again with suspect numbers read the other way, if the noise is [`Noise::Auto`] and the effort has
/// checks.
fn read_twice(system: &ConstraintSystem, options: &Options, suspects: &Suspects) -> Result<Analysis, AnalysisError> {
    let without = |terms: &[NoiseTerm], is_read: &dyn Fn(usize) -> bool| {
        let gone: HashSet<(usize, usize)> = terms.iter().map(|term| (term.row, term.dof)).collect();
        system.only(|i, j| is_read(i) && !gone.contains(&(i, j)), is_read)
    };
    let read = |system: ConstraintSystem| {
        let numbered = Numbering::new(&system);
        read(system, numbered, options)
    };
    let mut analysis = read(without(&suspects.rows, &|_| true))?;
    let all = suspects.all();
    let (numbering, ..) = Numbering::new(system);
    let labels = Labels::of(numbering.view(system, system.rhs()));
    let mut is_concerned = vec![false; system.equations()];
    labels.mark(&all.iter().map(|term| term.row).collect::<Vec<_>>(), &mut is_concerned);
    let mut read_otherwise = |gone: &[NoiseTerm], terms: Vec<NoiseTerm>, as_zero: bool| {
        let other = read(without(gone, &|i| is_concerned[i]))?;
        let count = |kinds: &[Kind], kind: Kind| {
            kinds.iter().zip(&is_concerned).filter(|&(&of, &concerned)| concerned && of == kind).count()
        };
        let counts = |kinds: &[Kind]| [Kind::Independent, Kind::Conflicting].map(|kind| count(kinds, kind));
        let (found, own) = (counts(other.kinds()), counts(analysis.kinds()));
        // Remainders of dropped equations that vanish with the suspect coefficients consist of them.
        let is_cause = analysis.confidence.doubt == Some(Doubt::NoGap) && !other.confidence().ambiguous;
        if (found != own || is_cause) && analysis.other.is_none() {
            let conflicting = analysis.kinds().iter().filter(|&&kind| kind == Kind::Conflicting).count();
            let (rank, conflicting) = (analysis.rank() + found[0] - own[0], conflicting + found[1] - own[1]);
            analysis.other = Some(OtherReading { as_zero, terms, rank, conflicting });
            let Confidence { distance, error, .. } = analysis.confidence;
            let error = if is_cause { 0.0 } else { error };
            analysis.confidence = Confidence::of(distance, error, options.tolerance, Some(Doubt::Noise));
        }
        Ok::<(), AnalysisError>(())
    };
    if options.noise == Noise::Auto && options.effort.checks() {
        if !suspects.rows.is_empty() {
            read_otherwise(&[], suspects.rows.clone(), false)?;
        }
        if !suspects.single.is_empty() {
            read_otherwise(&all, suspects.single.clone(), true)?;
        }
    }
    analysis.noise.clone_from(&suspects.rows);
    Ok(analysis)
}
