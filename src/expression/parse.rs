//! From a text to the operations of a program.

use super::function::{self, ADD, BINARY, BinaryFunction, CONSTANTS, UNARY};
use super::{DEEPEST, Fault, LONGEST, MOST_OPERATIONS, Operation};
use crate::message::cut;

/// Parses all of a text.
pub(super) fn parse(text: &str, variables: &[&str]) -> Result<Vec<Operation>, Fault> {
    if text.len() > LONGEST {
        return Err(Fault {
            position: LONGEST + 1,
            found: format!("a text of {} bytes", text.len()),
            allowed: format!("at most {LONGEST}"),
        });
    }
    let mut parser = Parser {
        text,
        at: 0,
        variables,
        operations: Vec::new(),
        waiting: 0,
        depth: 0,
    };
    parser.sum()?;
    match parser.peek() {
        None => Ok(parser.operations),
        Some(_) => Err(parser.fault("an operator, or the end")),
    }
}

struct Parser<'a> {
    text: &'a str,
    /// Place of the next byte.
    at: usize,
    variables: &'a [&'a str],
    operations: Vec<Operation>,
    /// Values on the stack.
    waiting: usize,
    /// Parentheses, signs and powers around.
    depth: usize,
}

impl<'a> Parser<'a> {
    /// The next character that is no blank.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        let trimmed = rest.trim_start_matches([' ', '\t', '\n', '\r']);
        self.at += rest.len() - trimmed.len();
        trimmed.chars().next()
    }

    /// Passes over a character if it is the next one.
    fn takes(&mut self, wanted: char) -> bool {
        let is_next = self.peek() == Some(wanted);
        if is_next {
            self.at += wanted.len_utf8();
        }
        is_next
    }

    fn fault_at(&self, at: usize, found: String, allowed: impl Into<String>) -> Fault {
        Fault {
            position: self.text[..at].chars().count() + 1,
            found,
            allowed: allowed.into(),
        }
    }

    /// A fault at the next character.
    fn fault(&mut self, allowed: &str) -> Fault {
        let found = match self.peek() {
            Some(next) => format!("{:?}", next.to_string()),
            None => "the end".to_owned(),
        };
        self.fault_at(self.at, found, allowed)
    }

    fn push(&mut self, operation: Operation) -> Result<(), Fault> {
        match operation {
            Operation::Constant(_) | Operation::Variable(_) => self.waiting += 1,
            Operation::Negate | Operation::Unary(_) => {}
            Operation::Binary(_) => self.waiting -= 1,
        }
        if self.operations.len() == MOST_OPERATIONS {
            let allowed = format!("at most {MOST_OPERATIONS} numbers and operations");
            return Err(self.fault_at(self.at - 1, "one more".to_owned(), allowed));
        }
        if self.waiting > DEEPEST {
            return Err(self.too_deep());
        }
        self.operations.push(operation);
        Ok(())
    }

    fn too_deep(&self) -> Fault {
        let allowed = format!("at most {DEEPEST} levels");
        self.fault_at(
            self.at.saturating_sub(1),
            "one level more".to_owned(),
            allowed,
        )
    }

    fn deeper(&mut self, inner: impl FnOnce(&mut Self) -> Result<(), Fault>) -> Result<(), Fault> {
        if self.depth == DEEPEST {
            return Err(self.too_deep());
        }
        self.depth += 1;
        inner(self)?;
        self.depth -= 1;
        Ok(())
    }

    fn sum(&mut self) -> Result<(), Fault> {
        self.product()?;
        loop {
            let function = match self.peek() {
                Some('+') => &ADD,
                Some('-') => &function::SUBTRACT,
                _ => return Ok(()),
            };
            self.at += 1;
            self.product()?;
            self.push(Operation::Binary(function))?;
        }
    }

    fn product(&mut self) -> Result<(), Fault> {
        self.sign()?;
        loop {
            let function = match self.peek() {
                Some('*') => &function::MULTIPLY,
                Some('/') => &function::DIVIDE,
                _ => return Ok(()),
            };
            self.at += 1;
            self.sign()?;
            self.push(Operation::Binary(function))?;
        }
    }

    fn sign(&mut self) -> Result<(), Fault> {
        if self.takes('-') {
            self.deeper(Self::sign)?;
            return self.push(Operation::Negate);
        }
        if self.takes('+') {
            return self.deeper(Self::sign);
        }
        self.atom()?;
        if self.takes('^') {
            self.deeper(Self::sign)?;
            self.push(Operation::Binary(&function::POWER))?;
        }
        Ok(())
    }

    fn atom(&mut self) -> Result<(), Fault> {
        match self.peek() {
            Some('(') => {
                self.at += 1;
                self.deeper(Self::sum)?;
                self.closes()
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_ascii_alphabetic() || c == '_' => self.name(),
            _ => Err(self.fault("a number, a name, a sign or a parenthesis")),
        }
    }

    fn closes(&mut self) -> Result<(), Fault> {
        match self.takes(')') {
            true => Ok(()),
            false => Err(self.fault("an operator or )")),
        }
    }

    /// The text from here on while `is_part` holds.
    fn word(&mut self, is_part: impl Fn(char) -> bool) -> &'a str {
        let rest = &self.text[self.at..];
        let len = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
        self.at += len;
        &rest[..len]
    }

    fn number(&mut self) -> Result<(), Fault> {
        let start = self.at;
        self.word(|c| c.is_ascii_digit() || c == '.');
        let rest = &self.text[self.at..];
        // an e that digits follow is an exponent, another one no part of the number
        let after = rest.strip_prefix(['e', 'E']);
        let digits = after.map(|after| after.strip_prefix(['+', '-']).unwrap_or(after));
        if let Some(digits) = digits.filter(|d| d.starts_with(|c: char| c.is_ascii_digit())) {
            self.at = self.text.len() - digits.len();
            self.word(|c| c.is_ascii_digit());
        }
        let written = &self.text[start..self.at];
        match written.parse::<f64>() {
            Ok(value) if value.is_finite() => self.push(Operation::Constant(value)),
            _ => Err(self.fault_at(start, format!("{:?}", cut(written)), "a finite number")),
        }
    }

    fn name(&mut self) -> Result<(), Fault> {
        let start = self.at;
        let name = self.word(|c| c.is_ascii_alphanumeric() || c == '_');
        if let Some(place) = self.variables.iter().position(|known| *known == name) {
            return self.push(Operation::Variable(place));
        }
        if let Some((_, value)) = CONSTANTS.iter().find(|(known, _)| *known == name) {
            return self.push(Operation::Constant(*value));
        }
        if let Some(function) = UNARY.iter().find(|known| known.name == name) {
            self.opens()?;
            self.deeper(Self::sum)?;
            self.closes()?;
            return self.push(Operation::Unary(function));
        }
        if let Some(function) = BINARY.iter().find(|known| known.name == name) {
            return self.two_arguments(function);
        }
        let known = self.variables.iter().copied();
        let known = known.chain(CONSTANTS.iter().map(|(name, _)| *name));
        let known = known.chain(UNARY.iter().map(|f| f.name));
        let known: Vec<&str> = known.chain(BINARY.iter().map(|f| f.name)).collect();
        let allowed = format!("the names {}", known.join(" "));
        Err(self.fault_at(start, format!("the unknown name {:?}", cut(name)), allowed))
    }

    fn two_arguments(&mut self, function: &'static BinaryFunction) -> Result<(), Fault> {
        self.opens()?;
        self.deeper(Self::sum)?;
        if !self.takes(',') {
            return Err(self.fault("a comma and a second argument"));
        }
        self.deeper(Self::sum)?;
        self.closes()?;
        self.push(Operation::Binary(function))
    }

    fn opens(&mut self) -> Result<(), Fault> {
        match self.takes('(') {
            true => Ok(()),
            false => Err(self.fault("( after the name of a function")),
        }
    }
}
