//! Follows `*DO`, `*IF` and `*CREATE`: decides whether and how often commands are executed.
//!
//! If a condition or a bound of a block depends on an unknown value, it is unknown whether the commands of the block are executed.

use super::command::AnsysCommand;
use super::parameters::ApdlParameters;
use crate::deck::Problem;
use crate::deck::limits::{ITERATION, REREAD};

/// A position in the text: a byte, and its line from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TextPosition {
    pub start: usize,
    pub line: u32,
}

/// A block of `*DO`, `*IF` or `*CREATE` that is open.
#[derive(Clone, Debug)]
enum FlowBlock {
    /// A loop that is executed.
    Loop(DoLoop),
    /// A loop of which it is not known whether it goes on. Its body is read once more, as commands that may be executed or not.
    Doubted(DoLoop),
    /// The branch of `*IF` that is executed.
    Taken,
    /// A branch of `*IF` that is skipped; a later branch may be executed.
    Waiting,
    /// A block whose remaining commands are all skipped.
    Skipped,
    /// A block that depends on an unknown value.
    Unknown,
}

#[derive(Clone, Debug)]
struct DoLoop {
    name: String,
    value: f64,
    last: f64,
    step: f64,
    body: TextPosition,
    /// Whether the rest of this iteration is skipped.
    cycles: bool,
}

/// Whether the commands at a place are executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Execution {
    Executed,
    Skipped,
    Unknown,
}

/// The open blocks of `*DO`, `*IF` and `*CREATE`.
#[derive(Debug, Default)]
pub struct FlowControl {
    blocks: Vec<FlowBlock>,
    /// Line of the outermost open block.
    opened: u32,
    /// Number of bytes that loops have read again.
    pub again: usize,
    /// Where to continue reading; `None` for the next line.
    pub jump: Option<TextPosition>,
}

impl FlowControl {
    /// Whether commands at this place are executed.
    pub fn state(&self) -> Execution {
        let skips = |block: &FlowBlock| match block {
            FlowBlock::Loop(repeated) => repeated.cycles,
            other => matches!(other, FlowBlock::Waiting | FlowBlock::Skipped),
        };
        if self.blocks.iter().any(skips) {
            Execution::Skipped
        } else if self.blocks.iter().any(|block| matches!(block, FlowBlock::Unknown | FlowBlock::Doubted(_))) {
            Execution::Unknown
        } else {
            Execution::Executed
        }
    }

    /// Whether any block is open.
    pub fn is_within(&self) -> bool {
        !self.blocks.is_empty()
    }

    /// Commands may be lost because a block has no end: those of further iterations of a loop, or skipped ones. If so, returns the line of
    /// the outermost open block, otherwise `None`.
    pub fn never_closed(&self) -> Option<u32> {
        let loses = |block: &FlowBlock| !matches!(block, FlowBlock::Taken | FlowBlock::Unknown);
        self.blocks.iter().any(loses).then_some(self.opened)
    }

    /// Whether a loop is open, so that a command may be executed more than once.
    pub fn repeats(&self) -> bool {
        self.blocks.iter().any(|block| matches!(block, FlowBlock::Loop(_) | FlowBlock::Doubted(_)))
    }

    /// Executes a command that opens, divides or closes a block; returns false for any other. `next` is the start of the next
    /// line if the command is alone on its line.
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
                let is_skipped = self.state() == Execution::Skipped;
                self.blocks.push(if is_skipped { FlowBlock::Skipped } else { FlowBlock::Unknown });
            }
            b"*IF" => return Ok(self.open_if(command, parameters)),
            b"*ELSEIF" => self.divide(|| condition(command, parameters)),
            b"*ELSE" => self.divide(|| Some(true)),
            b"*ENDDO" => self.close_loop(command, parameters)?,
            b"*ENDIF" | b"*END" => drop(self.blocks.pop()),
            b"*EXIT" => self.leave(false, true),
            b"*CYCLE" => self.leave(true, true),
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Opens the loop `*DO, Par, IVAL, FVAL, INC`.
    fn open_loop(&mut self, command: &AnsysCommand, next: Option<TextPosition>, parameters: &mut ApdlParameters) {
        if self.state() == Execution::Skipped {
            return self.blocks.push(FlowBlock::Skipped);
        }
        let number = |at: usize| parameters.number(command.field(at)).ok();
        let step = if command.field(4).is_empty() { Some(1.0) } else { number(4) };
        let known = self.state() == Execution::Executed;
        let name = String::from_utf8_lossy(command.field(1)).to_ascii_uppercase();
        let (Some(value), Some(last), Some(step), Some(body), true) = (number(2), number(3), step, next, known) else {
            parameters.forget(&name);
            return self.blocks.push(FlowBlock::Unknown);
        };
        let repeated = DoLoop { name, value, last, step, body, cycles: false };
        parameters.define(&repeated.name, value);
        self.blocks.push(if step == 0.0 {
            FlowBlock::Unknown
        } else if repeated.continues() {
            FlowBlock::Loop(repeated)
        } else {
            FlowBlock::Skipped
        });
    }

    fn close_loop(&mut self, command: &AnsysCommand, parameters: &mut ApdlParameters) -> Result<(), Problem> {
        let (mut repeated, is_doubted) = match self.blocks.pop() {
            Some(FlowBlock::Loop(repeated)) => (repeated, false),
            Some(FlowBlock::Doubted(repeated)) => (repeated, true),
            _ => return Ok(()),
        };
        repeated.value += repeated.step;
        repeated.cycles = false;
        parameters.define(&repeated.name, repeated.value);
        if is_doubted {
            parameters.forget(&repeated.name);
        } else if !repeated.continues() {
            return Ok(());
        }
        let body = command.range.end.saturating_sub(repeated.body.start);
        self.again = self.again.saturating_add(body + ITERATION);
        if self.again > REREAD {
            let advice = "write the commands out, or reduce the iterations";
            return Err(Problem::Limit { what: "the text that loops read again", limit: REREAD, advice });
        }
        self.jump = Some(repeated.body);
        self.blocks.push(if is_doubted { FlowBlock::Unknown } else { FlowBlock::Loop(repeated) });
        Ok(())
    }

    /// Executes `*IF, VAL1, Oper1, VAL2, Base1, VAL3, Oper2, VAL4, Base2`. Returns false if it jumps to another line.
    fn open_if(&mut self, command: &AnsysCommand, parameters: &ApdlParameters) -> bool {
        let has = |word: &str| command.fields.iter().skip(3).any(|field| field.eq_ignore_ascii_case(word.as_bytes()));
        if has("THEN") {
            let known = if self.state() == Execution::Skipped { None } else { Some(condition(command, parameters)) };
            self.blocks.push(match known {
                None => FlowBlock::Skipped,
                Some(None) => FlowBlock::Unknown,
                Some(Some(true)) => FlowBlock::Taken,
                Some(Some(false)) => FlowBlock::Waiting,
            });
            return true;
        }
        let holds = condition(command, parameters);
        if self.state() == Execution::Skipped || holds == Some(false) {
            return true;
        }
        if !has("EXIT") && !has("CYCLE") {
            return false;
        }
        self.leave(has("CYCLE"), holds.is_some());
        true
    }

    /// Executes `*ELSEIF` or `*ELSE`: ends one branch of `*IF` and begins the next.
    fn divide(&mut self, condition: impl FnOnce() -> Option<bool>) {
        let Some(block) = self.blocks.last_mut() else { return };
        match block {
            FlowBlock::Taken => *block = FlowBlock::Skipped,
            FlowBlock::Waiting => {
                *block = match condition() {
                    Some(true) => FlowBlock::Taken,
                    Some(false) => FlowBlock::Waiting,
                    None => FlowBlock::Unknown,
                }
            }
            FlowBlock::Loop(_) | FlowBlock::Doubted(_) | FlowBlock::Skipped | FlowBlock::Unknown => {}
        }
    }

    /// Skips the rest of the current iteration of the innermost loop, including the blocks inside it. Unless `cycles`, skips all further
    /// iterations, too. If the command may be executed or not, the open loops become unknown.
    fn leave(&mut self, cycles: bool, is_certain: bool) {
        let is_loop = |block: &FlowBlock| matches!(block, FlowBlock::Loop(_));
        match self.state() {
            Execution::Skipped => {}
            Execution::Executed if is_certain => match self.blocks.iter_mut().rfind(|block| is_loop(block)) {
                Some(FlowBlock::Loop(repeated)) if cycles => repeated.cycles = true,
                Some(block) => *block = FlowBlock::Skipped,
                None => {}
            },
            _ => self.doubt_loops(),
        }
    }

    /// Records that the open loops may end here, or not.
    pub fn doubt_loops(&mut self) {
        for block in &mut self.blocks {
            if let FlowBlock::Loop(repeated) = block {
                *block = FlowBlock::Doubted(repeated.clone());
            }
        }
    }
}

impl DoLoop {
    fn continues(&self) -> bool {
        // Rounding of the sum of steps must not add or remove an iteration.
        let slack = 1e-9 * self.step.abs();
        if self.step > 0.0 { self.value <= self.last + slack } else { self.value >= self.last - slack }
    }
}

/// Whether the condition of `*IF` or `*ELSEIF` holds; `None` if this is unknown.
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

/// Whether a word ends the condition of `*IF`. `AND`, `OR` and `XOR` do not: they combine it with a further comparison.
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
