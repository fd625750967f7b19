//! JSON paths as errors and overrides write them: `contact.friction.alpha`, `loads[0].part`; `$` is the whole scene.

use crate::message::cut;
use std::fmt;

/// One step into a JSON value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Segment {
    Key(String),
    Index(usize),
}

/// A place in a JSON value.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Path(pub Vec<Segment>);

impl Path {
    /// Reads `a.b[0].c`; `None` if the text is not of this form.
    pub fn parse(text: &str) -> Option<Path> {
        let mut path = Path::default();
        for dotted in text.split('.') {
            let mut parts = dotted.split('[');
            let key = parts.next().filter(|key| !key.is_empty())?;
            path.0.push(Segment::Key(key.to_owned()));
            for index in parts {
                let index = index.strip_suffix(']')?.parse().ok()?;
                path.0.push(Segment::Index(index));
            }
        }
        Some(path)
    }

    /// The place `key` of the object here.
    pub fn key(&self, key: &str) -> Path {
        self.with(Segment::Key(key.to_owned()))
    }

    /// The place `index` of the array here.
    pub fn index(&self, index: usize) -> Path {
        self.with(Segment::Index(index))
    }

    fn with(&self, segment: Segment) -> Path {
        let mut path = self.clone();
        path.0.push(segment);
        path
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("$");
        }
        for (position, segment) in self.0.iter().enumerate() {
            match segment {
                Segment::Index(index) => write!(f, "[{index}]")?,
                // A key that would read as something else (`a.b`, `a[0]`, empty) is quoted.
                Segment::Key(key)
                    if key.is_empty() || key.contains(|c: char| ".[]\"$".contains(c)) =>
                {
                    write!(f, "[{:?}]", cut(key))?
                }
                Segment::Key(key) if position == 0 => f.write_str(&cut(key))?,
                Segment::Key(key) => write!(f, ".{}", cut(key))?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Path;

    #[test]
    fn paths_read_back() {
        for text in ["a", "contact.friction.alpha", "loads[0].direction[1]"] {
            assert_eq!(
                Path::parse(text).map(|p| p.to_string()).as_deref(),
                Some(text)
            );
        }
        for text in [
            "", ".a", "a.", "a..b", "[0]", "a[", "a[]", "a[x]", "a[0]b", "a]b[",
        ] {
            assert_eq!(Path::parse(text), None, "{text}");
        }
        assert_eq!(Path::default().key("a.b").to_string(), "[\"a.b\"]");
    }
}
