//! Reads the words and numbers of an MSH file, text or binary, and says where it stands when it cannot.

use super::fault::{Fault, Outcome};
use crate::message::{LONGEST, cut};

/// How numbers are written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Encoding {
    Text,
    /// Bytes per `size_t` (4 or 8), and whether the most significant byte comes first.
    Binary {
        size: usize,
        is_big_endian: bool,
    },
}

/// A place in a file.
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Where the last word, number or line began: the place of messages.
    mark: usize,
    pub encoding: Encoding,
    /// Name of the section, for messages.
    pub section: String,
}

/// Whether a section may be called so.
fn is_section(name: &str) -> bool {
    let is_word = name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    is_word && (1..=LONGEST).contains(&name.len()) && !name.starts_with("End")
}

/// Between two words: also what ends a line on Windows.
fn is_blank(byte: u8) -> bool {
    byte.is_ascii_whitespace()
}

impl<'a> Cursor<'a> {
    pub fn new(bytes: &'a [u8]) -> Cursor<'a> {
        Cursor {
            bytes,
            at: 0,
            mark: 0,
            encoding: Encoding::Text,
            section: String::new(),
        }
    }

    /// Bytes that are left.
    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The fault at this place.
    pub fn fault(&self, found: impl std::fmt::Display, allowed: impl std::fmt::Display) -> Fault {
        let place = match self.encoding {
            Encoding::Text => {
                let lines = self.bytes[..self.mark].iter().filter(|b| **b == b'\n');
                format!("line {}", lines.count() + 1)
            }
            Encoding::Binary { .. } => format!("byte {}", self.mark),
        };
        match self.section.as_str() {
            "" => Fault::new(format!("{found} ({place})"), allowed),
            section => Fault::new(format!("${section}: {found} ({place})"), allowed),
        }
    }

    fn end(&self, wanted: &str) -> Fault {
        self.fault(format!("the end of the file instead of {wanted}"), wanted)
    }

    fn skip_blanks(&mut self) {
        let blanks = self.bytes[self.at..].iter().take_while(|b| is_blank(**b));
        self.at += blanks.count();
    }

    /// The next word of text, whatever the encoding of numbers.
    fn word(&mut self, wanted: &str) -> Outcome<&'a str> {
        self.skip_blanks();
        self.mark = self.at;
        let rest = &self.bytes[self.at..];
        let length = rest.iter().take_while(|b| !is_blank(**b)).count();
        if length == 0 {
            return Err(self.end(wanted));
        }
        let word = std::str::from_utf8(&rest[..length])
            .map_err(|_| self.fault("bytes that are no text", wanted))?;
        if word.starts_with('$') {
            return Err(self.fault(format!("{:?} too early", cut(word)), wanted));
        }
        self.at += length;
        Ok(word)
    }

    fn parsed<T: std::str::FromStr>(&mut self, wanted: &str) -> Outcome<T> {
        let word = self.word(wanted)?;
        word.parse()
            .map_err(|_| self.fault(format!("{:?}", cut(word)), wanted))
    }

    fn raw<const N: usize>(&mut self, wanted: &str) -> Outcome<[u8; N]> {
        self.mark = self.at;
        let Some(raw) = self.bytes[self.at..].first_chunk::<N>() else {
            return Err(self.end(wanted));
        };
        self.at += N;
        let is_big_endian = matches!(
            self.encoding,
            Encoding::Binary {
                is_big_endian: true,
                ..
            }
        );
        let mut raw = *raw;
        if is_big_endian {
            raw.reverse();
        }
        Ok(raw)
    }

    /// An integer of 4 bytes.
    pub fn int(&mut self, wanted: &str) -> Outcome<i64> {
        match self.encoding {
            Encoding::Text => self.parsed(wanted),
            Encoding::Binary { .. } => Ok(i32::from_le_bytes(self.raw(wanted)?).into()),
        }
    }

    /// A number without sign: a tag or a count of MSH 4.
    pub fn size(&mut self, wanted: &str) -> Outcome<u64> {
        match self.encoding {
            Encoding::Text => self.parsed(wanted),
            Encoding::Binary { size: 4, .. } => Ok(u32::from_le_bytes(self.raw(wanted)?).into()),
            Encoding::Binary { .. } => Ok(u64::from_le_bytes(self.raw(wanted)?)),
        }
    }

    /// A finite number.
    pub fn double(&mut self, wanted: &str) -> Outcome<f64> {
        let value: f64 = match self.encoding {
            Encoding::Text => self.parsed(wanted)?,
            Encoding::Binary { .. } => f64::from_le_bytes(self.raw(wanted)?),
        };
        match value.is_finite() {
            true => Ok(value),
            false => Err(self.fault(value, format!("{wanted}: a finite number"))),
        }
    }

    /// An integer written as text in files of both encodings.
    pub fn text_int(&mut self, wanted: &str) -> Outcome<i64> {
        self.parsed(wanted)
    }

    /// A count of things that take at least `bytes` each in a binary file; a file that is too short for them is refused before
    /// memory is taken. In a text every number takes two bytes or more.
    pub fn checked(&self, count: u64, numbers: usize, bytes: usize, what: &str) -> Outcome<usize> {
        let each = match self.encoding {
            Encoding::Text => 2 * numbers,
            Encoding::Binary { .. } => bytes,
        };
        let most = (self.left() + 1) / each.max(1);
        match usize::try_from(count) {
            Ok(count) if count <= most => Ok(count),
            _ => Err(self.fault(
                format!("{count} {what}"),
                format!("at most {most}, for which the file is long enough"),
            )),
        }
    }

    /// Bytes per `size_t` in a binary file.
    pub fn size_bytes(&self) -> usize {
        match self.encoding {
            Encoding::Text => 2,
            Encoding::Binary { size, .. } => size,
        }
    }

    /// The rest of the line, as text.
    pub fn line(&mut self) -> &'a [u8] {
        self.mark = self.at;
        let rest = &self.bytes[self.at..];
        let length = rest.iter().take_while(|b| **b != b'\n').count();
        self.at += (length + 1).min(rest.len());
        rest[..length]
            .strip_suffix(b"\r")
            .unwrap_or(&rest[..length])
    }

    /// Skips the end of the line after a text in a binary file; what follows are numbers.
    pub fn end_of_line(&mut self) {
        if self.encoding != Encoding::Text {
            self.line();
        }
    }

    /// Name of the section that begins here; `None` at the end of the file.
    ///
    /// # Errors
    /// Anything else between two sections.
    pub fn next_section(&mut self) -> Outcome<Option<String>> {
        self.section.clear();
        self.skip_blanks();
        if self.left() == 0 {
            return Ok(None);
        }
        let line = self.line();
        let name = line.strip_prefix(b"$").map(|name| name.trim_ascii());
        match name.and_then(|name| std::str::from_utf8(name).ok()) {
            Some(name) if is_section(name) => {
                self.section = name.to_owned();
                Ok(Some(name.to_owned()))
            }
            _ => {
                let shown = cut(&String::from_utf8_lossy(line));
                let allowed = "a section of an MSH file, as $MeshFormat or $Nodes";
                Err(self.fault(format!("{shown:?}"), allowed))
            }
        }
    }

    /// The end of the section.
    pub fn end_section(&mut self) -> Outcome<()> {
        self.skip_blanks();
        let line = self.line().trim_ascii();
        let wanted = format!("$End{}", self.section);
        if line == wanted.as_bytes() {
            return Ok(());
        }
        let shown = cut(&String::from_utf8_lossy(&line[..line.len().min(40)]));
        let found = match shown.is_empty() {
            true => "the end of the file".to_owned(),
            false => format!("{shown:?}"),
        };
        Err(self.fault(found, wanted))
    }

    /// Skips everything up to the end of the section.
    pub fn skip_section(&mut self) -> Outcome<()> {
        let mark = format!("$End{}", self.section);
        let rest = &self.bytes[self.at..];
        // at the beginning of a line
        let found = rest
            .windows(mark.len())
            .enumerate()
            .position(|(i, window)| window == mark.as_bytes() && (i == 0 || rest[i - 1] == b'\n'));
        match found {
            Some(length) => {
                self.at += length;
                self.end_section()
            }
            None => Err(self.fault("the end of the file", mark)),
        }
    }
}
