//! How messages show numbers and the texts of users: on one line, short enough to read, and unable to deceive a terminal.

use std::fmt::{self, Display, Write};

/// Longest text of a user in a message, characters; the rest is cut off.
pub const LONGEST: usize = 80;

/// A number in its shortest form that reads back equal: plain between 1e-4 and 1e16, with an exponent beyond.
pub fn number(value: f64) -> Number {
    Number(value)
}

/// What [`number`] gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number(f64);

impl Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || !size.is_finite() || (1e-4..1e16).contains(&size) {
            write!(f, "{}", self.0)
        } else {
            write!(f, "{:e}", self.0)
        }
    }
}

/// A text of a user, cut after [`LONGEST`] characters.
pub fn cut(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// A text on one line: control characters, and characters that change the direction of writing or cannot be seen, are
/// written as escapes (`\n`, `\u{202e}`).
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    // writing into a String cannot fail
    let _ = Escaping(&mut out).write_str(text);
    out
}

/// Passes text on as [`escaped`] would.
pub struct Escaping<'a, W>(pub &'a mut W);

impl<W: Write> Write for Escaping<'_, W> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let mut rest = text;
        while let Some(at) = rest.find(is_treacherous) {
            let (plain, from) = rest.split_at(at);
            self.0.write_str(plain)?;
            let mut characters = from.chars();
            match characters.next() {
                Some('\n') => self.0.write_str("\\n")?,
                Some('\r') => self.0.write_str("\\r")?,
                Some('\t') => self.0.write_str("\\t")?,
                Some(other) => write!(self.0, "\\u{{{:x}}}", u32::from(other))?,
                None => {}
            }
            rest = characters.as_str();
        }
        self.0.write_str(rest)
    }
}

/// Control characters; marks and overrides of direction, separators of lines, joiners, fillers and tags, all without a
/// picture of their own.
fn is_treacherous(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' | '\u{180b}'..='\u{180f}'
            | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{3164}'
            | '\u{feff}' | '\u{ffa0}' | '\u{fff0}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back() {
        for (value, text) in [
            (1e300, "1e300"),
            (-1e300, "-1e300"),
            (1e-300, "1e-300"),
            (5e-324, "5e-324"),
            (1.5e16, "1.5e16"),
            (0.1, "0.1"),
            (1e-5, "1e-5"),
            (32.0, "32"),
            (-0.0, "-0"),
            (1e15, "1000000000000000"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(number(value).to_string(), text);
        }
        for exponent in -307..308 {
            let value = 1.234_567_890_123_456_7 * 10_f64.powi(exponent);
            let text = number(value).to_string();
            assert_eq!(text.parse(), Ok(value));
            assert!(text.len() < 25, "{text}");
        }
    }

    #[test]
    fn texts_stay_on_one_line_and_go_one_way() {
        assert_eq!(escaped("na\u{202e}me"), "na\\u{202e}me");
        assert_eq!(escaped("a\nb\r\tc\u{1b}[31m"), "a\\nb\\r\\tc\\u{1b}[31m");
        assert_eq!(escaped("Größe 接触 ±1 %"), "Größe 接触 ±1 %");
        assert_eq!(
            escaped("\u{feff}\u{85}\u{2066}"),
            "\\u{feff}\\u{85}\\u{2066}"
        );
        assert_eq!(escaped(""), "");
    }

    #[test]
    fn long_texts_are_cut() {
        assert_eq!(cut("short"), "short");
        let long = "ö".repeat(81);
        assert_eq!(cut(&long), format!("{}...", "ö".repeat(80)));
        assert_eq!(cut(&long[2..]), long[2..]);
    }
}
