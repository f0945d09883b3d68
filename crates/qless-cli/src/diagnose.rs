//! Reads and analyses a model, for check, reduce, clean, explain and diff. `report` renders the result.

mod gates;

use std::time::{Duration, Instant};

use qless::{Analysis, ConstraintSystem, Effort, Kind, NearDependence, Options, analyse};
use qless_io::deck::{self, LoadCase};
use qless_io::write::Inputs;
use qless_io::{FileContent, Opened, read_case};

use crate::args::{ModelArgs, ReportArgs};
use crate::deck_input::{DeckInput, LoadCaseChoice};
use crate::failure::{CliFailure, say};
use crate::preferences::PreferenceLists;
use crate::terminal::Progress;
use crate::{exit_code, memory};

/// A model and its analysis.
pub struct Diagnosis<'a> {
    pub args: &'a ModelArgs,
    pub report_args: &'a ReportArgs,
    pub options: Options,
    pub system: ConstraintSystem,
    pub analysis: Analysis,
    /// The deck of the system, if the input is a deck.
    pub deck: Option<DeckInput>,
    /// If the rank is ambiguous: the analysis in which nearly dependent equations count as dependent.
    pub near_dependence: Option<NearDependence>,
    /// Whether the command has several inputs. The report then names its input.
    pub is_one_of_several: bool,
    pub start: Instant,
    pub read: Duration,
}

/// Options, preferences and load cases of an analysis, and the report that it is for.
pub struct Question<'a> {
    pub report: &'a ReportArgs,
    pub options: Options,
    pub preferences: PreferenceLists<'a>,
    /// Load cases of a deck; other models have none.
    pub choice: LoadCaseChoice,
}

/// Reads the model and analyses it.
pub fn diagnose<'a>(
    args: &'a ModelArgs,
    question: Question<'a>,
    progress: &Progress,
) -> Result<Diagnosis<'a>, CliFailure> {
    let start = Instant::now();
    let Question { report: report_args, mut options, preferences, choice } = question;
    let refused = |error, system: Option<&ConstraintSystem>| CliFailure::from_analysis(error, &args.input, system);
    // A backend that cannot be used is refused before the work begins.
    options.backend.get(options.memory).map_err(|error| refused(error.into(), None))?;
    memory::threads::start(args.threads()).map_err(CliFailure::from_threads)?;
    progress.stage("reading");
    let input = Input::read(args, &choice)?;
    let read = start.elapsed();
    progress.stage("analysing");
    // The analysis may use the memory that remains.
    options.memory = memory::remaining().map_or(options.memory, |left| left.min(options.memory));
    let (system, analysis, deck) =
        input.analyse(&choice, &options, report_args.format.case_terms(), &|system, place| {
            analyse(system, &preferences.resolve(&options, system, place)?)
                .map_err(|error| refused(error, Some(system)))
        })?;
    if let Some(deck) = deck.as_ref().filter(|_| !preferences.is_empty()) {
        // Reports that use these options number rows as in the whole deck, even if a load case leaves out some equations.
        let all = LoadCase::default();
        let model = deck.deck.model();
        let whole = model.system(&all).map_err(|error| CliFailure::from_deck(&deck.deck, &error))?;
        options = preferences.resolve(&options, &whole, Some((&deck.deck, &all)))?;
    }
    // A generated value overflows if a large right-hand side is divided by a small coefficient.
    if let Some(&(dof, _)) = analysis.generated().iter().find(|(_, value)| !value.is_finite()) {
        return Err(CliFailure::from_overflow(&args.input, dof, &system.dof_label(dof)));
    }
    Ok(Diagnosis {
        args,
        report_args,
        options,
        system,
        analysis,
        deck,
        near_dependence: None,
        is_one_of_several: false,
        start,
        read,
    })
}

/// Analyses a system, which may be that of a load case of a deck.
type DiagnosisRun<'a> = &'a dyn Fn(&ConstraintSystem, Option<(&deck::Deck, &LoadCase)>) -> Result<Analysis, CliFailure>;

/// The input: a system of equations, or a deck.
enum Input {
    Case(ConstraintSystem),
    Deck(Box<deck::Deck>),
}

impl Input {
    fn read(args: &ModelArgs, choice: &LoadCaseChoice) -> Result<Self, CliFailure> {
        let (input, rhs, prescribed) = (&args.input, args.rhs.as_deref(), args.prescribed.as_deref());
        let needs_deck = args.solver.is_some() || matches!(choice, LoadCaseChoice::Named(_));
        let no_deck = || CliFailure::Input(format!("{}: --solver and --case need a deck", input.display()));
        if input.is_dir() {
            return if needs_deck { Err(no_deck()) } else { Ok(Self::Case(read_case(input, rhs, prescribed)?)) };
        }
        let opened = Opened::read(input, args.solver)?;
        match opened.content() {
            FileContent::Matrix | FileContent::Relations if needs_deck => Err(no_deck()),
            FileContent::Matrix | FileContent::Relations => Ok(Self::Case(opened.into_case(rhs, prescribed)?)),
            FileContent::Deck(_) if rhs.is_some() || prescribed.is_some() => Err(CliFailure::Input(format!(
                "{}: --rhs and --prescribed need a .mtx file; a deck has its own values",
                input.display()
            ))),
            FileContent::Deck(_) => Ok(Self::Deck(Box::new(opened.into_deck(args.solver)?))),
        }
    }

    /// Analyses the system, or the chosen load cases of a deck; returns the most severe one.
    fn analyse(
        self,
        choice: &LoadCaseChoice,
        options: &Options,
        terms: usize,
        run: DiagnosisRun,
    ) -> Result<(ConstraintSystem, Analysis, Option<DeckInput>), CliFailure> {
        match self {
            Self::Case(system) => {
                let analysis = run(&system, None)?;
                Ok((system, analysis, None))
            }
            Self::Deck(deck) => {
                let of_case = |system: &ConstraintSystem, place: (&deck::Deck, &LoadCase)| run(system, Some(place));
                let (system, analysis, deck) = DeckInput::analyse(*deck, choice, options, terms, &of_case)?;
                Ok((system, analysis, Some(deck)))
            }
        }
    }
}

impl Diagnosis<'_> {
    /// All files that were read.
    pub fn inputs(&self) -> Inputs {
        match &self.deck {
            Some(deck) => Inputs::new(deck.deck.model().files()),
            None => self.args.inputs(),
        }
    }

    /// Adds the near-dependence, if the rank is ambiguous and memory allows it.
    pub fn add_near_dependence(&mut self) {
        // The effort `quick` checks nothing, near-dependences neither.
        if self.analysis.confidence().ambiguous && self.options.effort != Effort::Quick {
            self.near_dependence = self.analysis.near_dependence().unwrap_or_default();
        }
    }

    /// Whether equations conflict, or something is found that `--deny` names.
    pub fn is_refused(&self) -> bool {
        self.is_conflicting() || !self.denied().is_empty()
    }

    /// Whether equations conflict.
    pub fn is_conflicting(&self) -> bool {
        self.analysis.dependent().iter().any(|dependent| dependent.kind == Kind::Conflicting)
    }

    /// Whether constraints were left out without `--allow-incomplete`.
    pub fn is_incomplete(&self) -> bool {
        let is_left_out = |deck: &DeckInput| deck.deck.model().left_out().next().is_some();
        !self.report_args.allow_incomplete && self.deck.as_ref().is_some_and(is_left_out)
    }

    /// Returns the exit code, and writes to standard error what `--deny` has found.
    pub fn code(&self) -> u8 {
        let denied = self.denied();
        if !denied.is_empty() {
            say(format_args!("error: found what --deny names: {}", denied.join(", ")));
        }
        exit_code::for_diagnosis(self.is_refused(), self.is_incomplete())
    }
}
