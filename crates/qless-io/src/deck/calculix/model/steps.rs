//! What the steps of a deck ask for, all together: it decides how some cards before them are read.

use crate::deck::calculix::syntax::KeywordCard;

/// What the steps of a deck ask for.
#[derive(Default)]
pub struct StepTraits {
    /// Number of steps.
    pub count: usize,
    /// Number of steps that are `*STATIC` or `*FREQUENCY`.
    static_or_modes: usize,
    /// Whether a step is geometrically nonlinear.
    pub is_nonlinear: bool,
    /// Whether a step integrates over time.
    pub is_dynamic: bool,
    /// Whether a step asks for modes of several nodal diameters.
    pub has_diameters: bool,
}

impl StepTraits {
    /// Records what a card in a step asks for.
    pub fn note(&mut self, card: &KeywordCard) {
        match card.keyword.as_slice() {
            b"*STEP" => {
                self.count += 1;
                self.is_nonlinear |= card.word("NLGEOM").is_some_and(|value| value != "NO");
            }
            b"*STATIC" | b"*FREQUENCY" => self.static_or_modes += 1,
            b"*DYNAMIC" => self.is_dynamic = true,
            b"*SELECTCYCLICSYMMETRYMODES" => self.has_diameters = true,
            _ => {}
        }
    }

    /// Whether all steps are `*STATIC` or `*FREQUENCY`.
    pub fn are_static_or_modes(&self) -> bool {
        self.count == self.static_or_modes
    }
}
