//! `*DO`, `*IF` and `*CREATE`: which commands are carried out, and how often.
//!
//! What depends on values that are not known is not followed: nobody knows whether the commands within are carried out.

use super::command::AnsysCommand;
use super::parameters::ApdlParameters;
use crate::deck::Problem;

/// Bytes that loops go through again at most: bounds the time.
const AGAIN: usize = 1 << 24;

/// A place in the text: its byte, and its line from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextPosition {
    pub start: usize,
    pub line: u32,
}

/// A block that is open.
#[derive(Clone, Debug)]
enum FlowBlock {
    /// A loop at work.
    Loop(DoLoop),
    /// A branch of `*IF` that is taken.
    Taken,
    /// Branches of `*IF`, none of which was taken yet.
    Waiting,
    /// Branches after the one that was taken, and all within what is passed over.
    Passed,
    /// What depends on something that is not known.
    Unfollowed,
}

#[derive(Clone, Debug)]
struct DoLoop {
    name: String,
    value: f64,
    last: f64,
    step: f64,
    body: TextPosition,
    /// Whether the rest of this turn is passed over.
    cycles: bool,
}

/// What happens to the commands of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Execution {
    CarriedOut,
    PassedOver,
    Unknown,
}

/// The open blocks.
#[derive(Debug, Default)]
pub struct FlowControl {
    blocks: Vec<FlowBlock>,
    /// Where the outermost one opened.
    opened: u32,
    /// Bytes that loops have gone through again.
    again: usize,
    /// Where the text goes on, if not below.
    pub jump: Option<TextPosition>,
}

impl FlowControl {
    /// What happens to commands here.
    pub fn state(&self) -> Execution {
        let passes = |block: &FlowBlock| match block {
            FlowBlock::Loop(turn) => turn.cycles,
            other => matches!(other, FlowBlock::Waiting | FlowBlock::Passed),
        };
        if self.blocks.iter().any(passes) {
            Execution::PassedOver
        } else if self.blocks.iter().any(|block| matches!(block, FlowBlock::Unfollowed)) {
            Execution::Unknown
        } else {
            Execution::CarriedOut
        }
    }

    /// Whether any block is open.
    pub fn is_within(&self) -> bool {
        !self.blocks.is_empty()
    }

    /// Where the outermost open block began, if blocks are open whose commands went astray: turns of a loop, or what was passed over.
    pub fn never_closed(&self) -> Option<u32> {
        let loses = |block: &FlowBlock| !matches!(block, FlowBlock::Taken | FlowBlock::Unfollowed);
        self.blocks.iter().any(loses).then_some(self.opened)
    }

    /// Whether a loop is open, so that a command may be carried out more than once.
    pub fn repeats(&self) -> bool {
        self.blocks.iter().any(|block| matches!(block, FlowBlock::Loop(_)))
    }

    /// A command that opens, closes or parts a block; false for others. `next` is the line below, where the command is the last of its
    /// line and the first.
    pub fn command(
        &mut self,
        command: &AnsysCommand,
        next: Option<TextPosition>,
        parameters: &mut ApdlParameters,
    ) -> Result<bool, Problem> {
        if self.blocks.is_empty() {
            self.opened = command.line;
        }
        match command.name.to_ascii_uppercase().as_slice() {
            b"*DO" => self.open_loop(command, next, parameters),
            b"*DOWHILE" | b"*CREATE" => {
                let state = self.state();
                self.blocks.push(if state == Execution::PassedOver {
                    FlowBlock::Passed
                } else {
                    FlowBlock::Unfollowed
                });
            }
            b"*IF" => return Ok(self.open_if(command, parameters)),
            b"*ELSEIF" => self.part(|| condition(command, parameters)),
            b"*ELSE" => self.part(|| Some(true)),
            b"*ENDDO" => self.close_loop(command, parameters)?,
            b"*ENDIF" | b"*END" => drop(self.blocks.pop()),
            b"*EXIT" => self.leave(false),
            b"*CYCLE" => self.leave(true),
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// `*DO, Par, IVAL, FVAL, INC`.
    fn open_loop(&mut self, command: &AnsysCommand, next: Option<TextPosition>, parameters: &mut ApdlParameters) {
        if self.state() == Execution::PassedOver {
            return self.blocks.push(FlowBlock::Passed);
        }
        let number = |at: usize| parameters.number(command.field(at)).ok();
        let step = if command.field(4).is_empty() { Some(1.0) } else { number(4) };
        let known = self.state() == Execution::CarriedOut;
        let name = String::from_utf8_lossy(command.field(1)).to_ascii_uppercase();
        let (Some(value), Some(last), Some(step), Some(body), true) = (number(2), number(3), step, next, known) else {
            parameters.forget(&name);
            return self.blocks.push(FlowBlock::Unfollowed);
        };
        let turn = DoLoop { name, value, last, step, body, cycles: false };
        parameters.define(&turn.name, value);
        self.blocks.push(if step == 0.0 {
            FlowBlock::Unfollowed
        } else if turn.goes_on() {
            FlowBlock::Loop(turn)
        } else {
            FlowBlock::Passed
        });
    }

    fn close_loop(&mut self, command: &AnsysCommand, parameters: &mut ApdlParameters) -> Result<(), Problem> {
        let Some(FlowBlock::Loop(mut turn)) = self.blocks.pop() else { return Ok(()) };
        turn.value += turn.step;
        turn.cycles = false;
        parameters.define(&turn.name, turn.value);
        if !turn.goes_on() {
            return Ok(());
        }
        self.again = self.again.saturating_add(command.range.end.saturating_sub(turn.body.start));
        if self.again > AGAIN {
            let advice = "write the commands out, or make fewer turns";
            return Err(Problem::Limit { what: "the text that loops go through", limit: AGAIN, advice });
        }
        self.jump = Some(turn.body);
        self.blocks.push(FlowBlock::Loop(turn));
        Ok(())
    }

    /// `*IF, VAL1, Oper1, VAL2, Base1, VAL3, Oper2, VAL4, Base2`.
    /// False where it leads to another line, which is not followed.
    fn open_if(&mut self, command: &AnsysCommand, parameters: &ApdlParameters) -> bool {
        let leads = |word: &str| command.fields.iter().skip(3).any(|field| field.eq_ignore_ascii_case(word.as_bytes()));
        if leads("THEN") {
            let known = if self.state() == Execution::PassedOver { None } else { Some(condition(command, parameters)) };
            self.blocks.push(match known {
                None => FlowBlock::Passed,
                Some(None) => FlowBlock::Unfollowed,
                Some(Some(true)) => FlowBlock::Taken,
                Some(Some(false)) => FlowBlock::Waiting,
            });
            return true;
        }
        let holds = condition(command, parameters);
        if self.state() == Execution::PassedOver || holds == Some(false) {
            return true;
        }
        if !leads("EXIT") && !leads("CYCLE") {
            return false;
        }
        match holds {
            Some(_) => self.leave(leads("CYCLE")),
            None => self.lose_loops(),
        }
        true
    }

    /// Nobody knows how the open loops go on.
    fn lose_loops(&mut self) {
        let loops = self.blocks.iter_mut().filter(|block| matches!(block, FlowBlock::Loop(_)));
        loops.for_each(|block| *block = FlowBlock::Unfollowed);
    }

    fn part(&mut self, condition: impl FnOnce() -> Option<bool>) {
        let Some(block) = self.blocks.last_mut() else { return };
        match block {
            FlowBlock::Taken => *block = FlowBlock::Passed,
            FlowBlock::Waiting => {
                *block = match condition() {
                    Some(true) => FlowBlock::Taken,
                    Some(false) => FlowBlock::Waiting,
                    None => FlowBlock::Unfollowed,
                }
            }
            FlowBlock::Loop(_) | FlowBlock::Passed | FlowBlock::Unfollowed => {}
        }
    }

    /// The rest of the innermost loop is passed over: of this turn, or of all. Blocks within it are, too, until they end.
    fn leave(&mut self, cycles: bool) {
        if self.state() != Execution::CarriedOut {
            return;
        }
        let Some(at) = self.blocks.iter().rposition(|block| matches!(block, FlowBlock::Loop(_))) else { return };
        match &mut self.blocks[at] {
            FlowBlock::Loop(turn) if cycles => turn.cycles = true,
            block => *block = FlowBlock::Passed,
        }
    }
}

impl DoLoop {
    fn goes_on(&self) -> bool {
        // What sums of steps leave by rounding is no further turn, nor one less.
        let slack = 1e-9 * self.step.abs();
        if self.step > 0.0 { self.value <= self.last + slack } else { self.value >= self.last - slack }
    }
}

/// Whether the condition of `*IF` or `*ELSEIF` holds, if that is known.
fn condition(command: &AnsysCommand, parameters: &ApdlParameters) -> Option<bool> {
    let first = compare(command, 1, parameters)?;
    match command.field(4).to_ascii_uppercase().as_slice() {
        b"AND" | b"OR" | b"XOR" if !command.field(8).is_empty() && !is_end(command.field(8)) => None,
        b"AND" => Some(first && compare(command, 5, parameters)?),
        b"OR" => Some(first || compare(command, 5, parameters)?),
        b"XOR" => Some(first != compare(command, 5, parameters)?),
        _ => Some(first),
    }
}

/// Whether a word says what follows from a condition, so that no further one stands behind it.
fn is_end(word: &[u8]) -> bool {
    ![&b"AND"[..], b"OR", b"XOR"].iter().any(|other| word.eq_ignore_ascii_case(other))
}

fn compare(command: &AnsysCommand, at: usize, parameters: &ApdlParameters) -> Option<bool> {
    let number = |at: usize| parameters.number(command.field(at)).ok();
    let (a, b) = (number(at), number(at + 2));
    match command.field(at + 1).to_ascii_uppercase().as_slice() {
        b"EQ" => Some(a? == b?),
        b"NE" => Some(a? != b?),
        b"LT" => Some(a? < b?),
        b"GT" => Some(a? > b?),
        b"LE" => Some(a? <= b?),
        b"GE" => Some(a? >= b?),
        b"ABLT" => Some(a?.abs() < b?.abs()),
        b"ABGT" => Some(a?.abs() > b?.abs()),
        _ => None,
    }
}
