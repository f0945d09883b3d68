//! Read, analyse, and keep the time: the start of check and reduce.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use qless::exact::{self, ExactRank, Reading, Settings};
use qless::{
    Analysis, ArgumentError, ConstraintSystem, Form, Kind, NearDependence, Options, Reduction, Report, analyse,
};
use qless_io::deck::{self, LoadCase};
use qless_io::write::Inputs;
use qless_io::{Content, Opened, read_case};

use crate::args::{Deny, Format, ModelArgs};
use crate::deck_input::{Choice, DeckInput};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::text::{self, Outcome};
use crate::wishes::Wishes;
use crate::{html, json, memory, stdout, vtu};

/// A model and what was found.
pub struct Diagnosis<'a> {
    pub args: &'a ModelArgs,
    pub options: Options,
    pub system: ConstraintSystem,
    pub analysis: Analysis,
    /// The deck that the system comes from, if it comes from one.
    pub deck: Option<DeckInput>,
    /// The rank of the numbers as typed, if it was asked for.
    exact: Option<ExactRank>,
    /// What may be meant instead of what is typed, where the rank is in doubt.
    pub meant: Option<NearDependence>,
    start: Instant,
    read: Duration,
}

/// A reduction, how it was asked for, and the time that it took.
#[derive(Clone, Copy)]
pub struct Reduced<'a> {
    pub reduction: &'a Reduction,
    pub form: Form,
    pub time: Duration,
}

/// How a model is to be looked at.
pub struct Question<'a> {
    pub options: Options,
    pub wishes: Wishes<'a>,
    /// Load cases of a deck; other models have none.
    pub choice: Choice,
}

/// Reads the model and analyses it.
pub fn diagnose<'a>(args: &'a ModelArgs, question: Question, progress: &Progress) -> Result<Diagnosis<'a>, Failure> {
    let start = Instant::now();
    let Question { mut options, wishes, choice } = question;
    let refused = |error, system: Option<&ConstraintSystem>| Failure::of_analysis(error, &args.input, system);
    // Known before the work, so said before the work.
    options.backend.get(options.memory).map_err(|error| refused(error.into(), None))?;
    memory::threads::start(args.threads()).map_err(Failure::of_threads)?;
    progress.stage("reading");
    let input = Input::read(args, &choice)?;
    let read = start.elapsed();
    progress.stage("analysing");
    // What the model leaves.
    options.memory = memory::left().map_or(options.memory, |left| left.min(options.memory));
    let terms = if matches!(args.format, Format::Json | Format::Html) { Report::TERMS } else { 0 };
    let (system, analysis, deck) = input.analyse(&choice, terms, &|system, place| {
        analyse(system, &wishes.resolve(&options, system, place)?).map_err(|error| refused(error, Some(system)))
    })?;
    if let Some(deck) = deck.as_ref().filter(|_| !wishes.is_empty()) {
        // Equations by their number in the deck, whatever a load case removes.
        let all = LoadCase::default();
        let model = deck.deck.model();
        let whole = model.system(&all).map_err(|error| Failure::of_deck(&deck.deck, &error))?;
        options = wishes.resolve(&options, &whole, Some((&deck.deck, &all)))?;
    }
    // A large right-hand side over a small coefficient.
    if let Some(&(dof, _)) = analysis.generated().iter().find(|(_, value)| !value.is_finite()) {
        return Err(Failure::of_overflow(&args.input, dof, &system.dof_label(dof)));
    }
    Ok(Diagnosis { args, options, system, analysis, deck, exact: None, meant: None, start, read })
}

/// Analyses a system, which may be that of a load case of a deck.
type Run<'a> = &'a dyn Fn(&ConstraintSystem, Option<(&deck::Deck, &LoadCase)>) -> Result<Analysis, Failure>;

/// What was read.
enum Input {
    Case(ConstraintSystem),
    Deck(Box<deck::Deck>),
}

impl Input {
    fn read(args: &ModelArgs, choice: &Choice) -> Result<Self, Failure> {
        let (input, rhs, prescribed) = (&args.input, args.rhs.as_deref(), args.prescribed.as_deref());
        let of_decks = args.solver.is_some() || matches!(choice, Choice::Named(_));
        let no_deck = || Failure::Input(format!("{}: --solver and --case go with a deck", input.display()));
        if input.is_dir() {
            return if of_decks { Err(no_deck()) } else { Ok(Self::Case(read_case(input, rhs, prescribed)?)) };
        }
        let opened = Opened::read(input, args.solver)?;
        match opened.content() {
            Content::Matrix if of_decks => Err(no_deck()),
            Content::Matrix => Ok(Self::Case(opened.into_case(rhs, prescribed)?)),
            Content::Deck(_) if rhs.is_some() || prescribed.is_some() => Err(Failure::Input(format!(
                "{}: --rhs and --prescribed go with a .mtx file; a deck has its own",
                input.display()
            ))),
            Content::Deck(_) => Ok(Self::Deck(Box::new(opened.into_deck(args.solver)?))),
        }
    }

    /// Analyses the system; of a deck every load case that was chosen, and keeps the worst.
    fn analyse(
        self,
        choice: &Choice,
        terms: usize,
        run: Run,
    ) -> Result<(ConstraintSystem, Analysis, Option<DeckInput>), Failure> {
        match self {
            Self::Case(system) => {
                let analysis = run(&system, None)?;
                Ok((system, analysis, None))
            }
            Self::Deck(deck) => {
                let of_case = |system: &ConstraintSystem, place: (&deck::Deck, &LoadCase)| run(system, Some(place));
                let (system, analysis, deck) = DeckInput::analyse(*deck, choice, terms, &of_case)?;
                Ok((system, analysis, Some(deck)))
            }
        }
    }
}

impl Diagnosis<'_> {
    /// All files that were read.
    pub fn inputs(&self) -> Inputs {
        match &self.deck {
            Some(deck) => Inputs::of(deck.deck.model().files()),
            None => self.args.inputs(),
        }
    }

    /// Adds the rank of the numbers as typed, in exact arithmetic.
    pub fn take_exact_rank(&mut self) -> Result<(), Failure> {
        let standard = Settings::from(Reading::Typed);
        // Two primes at a time, 24 bytes for a coefficient.
        let fill = memory::left().map_or(standard.fill, |bytes| bytes / 48);
        let exact = exact::rank(&self.system, Settings { fill, ..standard }).map_err(|error| {
            let input = self.args.input.display();
            Failure::Resource(format!("{input}: {error}; leave out --exact, or allow more with --memory"))
        })?;
        self.exact = Some(exact);
        Ok(())
    }

    /// Adds the reading in which equations that nearly repeat others are meant to, where the rank is in doubt and memory allows it.
    pub fn take_meaning(&mut self) {
        if self.analysis.confidence().ambiguous {
            self.meant = self.analysis.near_dependence().unwrap_or_default();
        }
    }

    /// Whether the exit code is 1.
    pub fn is_refused(&self) -> bool {
        let denied = |kind| match kind {
            Kind::Independent => false,
            Kind::Redundant => self.args.deny == Some(Deny::Redundant),
            Kind::Conflicting => true,
        };
        self.analysis.dependent().iter().any(|dependent| denied(dependent.kind))
    }

    /// Whether something that constrains was left out, and that is not allowed.
    pub fn is_incomplete(&self) -> bool {
        let is_left_out = |deck: &DeckInput| deck.deck.model().left_out().next().is_some();
        !self.args.allow_incomplete && self.deck.as_ref().is_some_and(is_left_out)
    }

    /// What a shell sees: a conflict is one whatever was left out.
    pub fn code(&self) -> ExitCode {
        match (self.is_refused(), self.is_incomplete()) {
            (true, _) => ExitCode::from(1),
            (false, true) => ExitCode::from(4),
            (false, false) => ExitCode::SUCCESS,
        }
    }

    /// Prints the report.
    pub fn print(&self, reduced: Option<Reduced>, outcome: &Outcome, progress: Progress) -> Result<(), Failure> {
        progress.stage("explaining");
        let bytes = self.render(reduced, outcome)?;
        drop(progress);
        if self.args.format == Format::Text {
            self.deck.iter().for_each(DeckInput::warn);
        }
        stdout::write(|out| out.write_all(&bytes))
    }

    /// The report in the form that was asked for.
    pub fn render(&self, reduced: Option<Reduced>, outcome: &Outcome) -> Result<Vec<u8>, Failure> {
        let terms = if self.args.format == Format::Text { 0 } else { Report::TERMS };
        let misfit = |error| Failure::Resource(format!("the report cannot be made: {error}"));
        let report = self.report(reduced, terms).map_err(misfit)?;
        match self.args.format {
            Format::Text => Ok(text::render(self, &report, outcome).into_bytes()),
            Format::Json => {
                let mut bytes = Vec::new();
                let deck = self.deck.as_ref().map(|deck| deck.report(&self.analysis));
                json::write(&mut bytes, &report, deck).map_err(|error| Failure::of_stdout(&error))?;
                Ok(bytes)
            }
            Format::Vtu => vtu::render(self, reduced.map(|reduced| reduced.reduction)),
            Format::Html => html::render(self, &report)
                .map(String::into_bytes)
                .map_err(|error| Failure::Resource(format!("the page cannot be made: {error}"))),
        }
    }

    fn report(&self, reduced: Option<Reduced>, terms: usize) -> Result<Report, ArgumentError> {
        let mut report = Report::new(&self.analysis, terms);
        if let Some(deck) = &self.deck {
            report = report.with_left_out(deck.left_out());
        }
        if let Some(exact) = &self.exact {
            report = report.with_exact(&self.analysis, exact)?;
        }
        if let Some(meant) = &self.meant {
            report = report.with_near_dependence(&self.analysis, meant, terms)?;
        }
        let (report, time) = match reduced {
            Some(Reduced { reduction, form, time }) => {
                let residual = self.analysis.residual(reduction)?;
                (report.with_reduction(reduction, residual).with_form(form), time)
            }
            None => (report, Duration::ZERO),
        };
        Ok(report.with_timings(self.read, time, self.start.elapsed()))
    }
}
