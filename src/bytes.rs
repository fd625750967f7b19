//! Framed bytes, the form of saved states and models, and the little-endian numbers inside.
//!
//! ```text
//! magic (8 bytes) | format version | fingerprint | length of the payload in bytes | payload | checksum
//! ```
//!
//! Every number is a little-endian 64-bit word; the checksum is XXH3 over everything before it. It finds damage, not
//! malice: a reader must still check every length before it allocates and every index before it uses it.

use crate::error::{Error, Result};
use faer::{Mat, MatRef};
use xxhash_rust::xxh3::xxh3_64;

const WORD: usize = 8;
/// Bytes before the payload.
pub const HEADER: usize = 4 * WORD;
/// Bytes that a frame adds to its payload.
pub const OVERHEAD: usize = HEADER + WORD;

/// A kind of framed bytes.
pub struct Frame {
    pub magic: [u8; 8],
    pub format: u64,
    /// What errors call it.
    pub what: &'static str,
}

impl Frame {
    /// Completes `out`, whose payload has been written: header before it, checksum behind it.
    pub fn seal(&self, fingerprint: u64, out: &mut [u8]) {
        let end = out.len() - WORD;
        let payload = (out.len() - OVERHEAD) as u64;
        out[..WORD].copy_from_slice(&self.magic);
        let words = [self.format, fingerprint, payload];
        for (to, word) in out[WORD..HEADER].chunks_exact_mut(WORD).zip(words) {
            to.copy_from_slice(&word.to_le_bytes());
        }
        let checksum = xxh3_64(&out[..end]);
        out[end..].copy_from_slice(&checksum.to_le_bytes());
    }

    /// Fingerprint and payload of undamaged bytes of this kind.
    ///
    /// # Errors
    /// [`Error::Bytes`].
    pub fn open<'a>(&self, bytes: &'a [u8]) -> Result<(u64, &'a [u8])> {
        let what = self.what;
        let refuse = |what: String| Err(Error::Bytes { what });
        if bytes.len() < OVERHEAD || bytes[..WORD] != self.magic {
            return refuse(format!("{} bytes that are not a {what}", bytes.len()));
        }
        let word = |at: usize| u64::from_le_bytes(word_at(bytes, WORD * at));
        if word(1) != self.format {
            return refuse(format!(
                "{what} of format {}, this library reads {}",
                word(1),
                self.format
            ));
        }
        let payload = bytes.len() - OVERHEAD;
        if word(3) != payload as u64 {
            return refuse(format!(
                "{what} with {} bytes announced and {payload} found",
                word(3)
            ));
        }
        let end = bytes.len() - WORD;
        let (expected, found) = (
            u64::from_le_bytes(word_at(bytes, end)),
            xxh3_64(&bytes[..end]),
        );
        if expected != found {
            return refuse(format!(
                "damaged {what}: checksum {expected:016x} written, {found:016x} found"
            ));
        }
        Ok((word(2), &bytes[HEADER..end]))
    }
}

fn word_at(bytes: &[u8], at: usize) -> [u8; WORD] {
    let mut word = [0; WORD];
    word.copy_from_slice(&bytes[at..at + WORD]);
    word
}

/// Writes numbers into bytes that grow.
#[derive(Default)]
pub struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    /// A writer that leaves room for the header of a frame.
    pub fn framed() -> Writer {
        Writer {
            bytes: vec![0; HEADER],
        }
    }

    /// What was written after the header.
    pub fn payload(&self) -> &[u8] {
        &self.bytes[HEADER..]
    }

    /// The finished frame.
    pub fn seal(mut self, frame: &Frame, fingerprint: u64) -> Vec<u8> {
        self.bytes.extend([0; WORD]);
        frame.seal(fingerprint, &mut self.bytes);
        self.bytes
    }

    pub fn word(&mut self, value: u64) {
        self.bytes.extend(value.to_le_bytes());
    }

    pub fn float(&mut self, value: f64) {
        self.word(value.to_bits());
    }

    pub fn text(&mut self, value: &str) {
        self.word(value.len() as u64);
        self.bytes.extend(value.as_bytes());
    }

    pub fn raw(&mut self, value: &[u8]) {
        self.word(value.len() as u64);
        self.bytes.extend(value);
    }

    pub fn floats(&mut self, values: &[f64]) {
        self.word(values.len() as u64);
        values.iter().for_each(|v| self.float(*v));
    }

    pub fn indices(&mut self, values: &[usize]) {
        self.word(values.len() as u64);
        values.iter().for_each(|v| self.word(*v as u64));
    }

    /// Rows, columns, then the entries column by column.
    /// A matrix in single precision, two entries to a word.
    pub fn singles(&mut self, matrix: MatRef<f32>) {
        self.word(matrix.nrows() as u64);
        self.word(matrix.ncols() as u64);
        let mut entries = matrix.col_iter().flat_map(|column| column.iter());
        while let Some(first) = entries.next() {
            let second = entries.next().map_or(0, |v| v.to_bits());
            self.word(u64::from(first.to_bits()) | u64::from(second) << 32);
        }
    }

    pub fn matrix(&mut self, matrix: MatRef<f64>) {
        self.word(matrix.nrows() as u64);
        self.word(matrix.ncols() as u64);
        for column in matrix.col_iter() {
            column.iter().for_each(|v| self.float(*v));
        }
    }
}

/// Numbers of a model are not larger than this, and those that are divided by not smaller than its reciprocal: energies, products
/// of five of them, stay finite in a step.
pub const LARGEST: f64 = 1e60;

/// Whether a model may hold this number; false for NaN.
pub fn is_usable(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// # Errors
/// [`Error::Bytes`] for a number that is not finite, or so large that a step would overflow.
fn check_finite(mut values: impl Iterator<Item = f64>) -> Result<()> {
    match values.position(|v| !is_usable(v)) {
        None => Ok(()),
        Some(at) => Err(Reader::refusal(format!(
            "number {at} of a list is not finite, or beyond {LARGEST:e}"
        ))),
    }
}

/// Reads what a [`Writer`] wrote. No length is trusted: it must fit the bytes that remain.
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub fn new(payload: &'a [u8]) -> Reader<'a> {
        Reader { rest: payload }
    }

    /// The refusal of bytes whose checksum holds but whose content does not.
    pub fn refusal(what: impl Into<String>) -> Error {
        Error::Bytes { what: what.into() }
    }

    fn take(&mut self, count: u64) -> Result<&'a [u8]> {
        match usize::try_from(count) {
            Ok(count) if count <= self.rest.len() => {
                let (head, rest) = self.rest.split_at(count);
                self.rest = rest;
                Ok(head)
            }
            _ => Err(Reader::refusal(format!(
                "{count} bytes expected, {} left",
                self.rest.len()
            ))),
        }
    }

    /// # Errors
    /// [`Error::Bytes`] here and in all that follow, when the bytes end too early.
    pub fn word(&mut self) -> Result<u64> {
        Ok(u64::from_le_bytes(word_at(self.take(WORD as u64)?, 0)))
    }

    pub fn float(&mut self) -> Result<f64> {
        self.word().map(f64::from_bits)
    }

    /// A count, index or size.
    pub fn size(&mut self) -> Result<usize> {
        let word = self.word()?;
        usize::try_from(word)
            .map_err(|_| Reader::refusal(format!("size {word} is too large for this machine")))
    }

    pub fn text(&mut self) -> Result<&'a str> {
        let length = self.word()?;
        std::str::from_utf8(self.take(length)?)
            .map_err(|e| Reader::refusal(format!("text that is not UTF-8: {e}")))
    }

    pub fn raw(&mut self) -> Result<&'a [u8]> {
        let length = self.word()?;
        self.take(length)
    }

    /// As many words as `count` says, if that many are left.
    fn words(&mut self, count: u64) -> Result<impl Iterator<Item = u64> + use<'a>> {
        let bytes = self.take(count.saturating_mul(WORD as u64))?;
        Ok(bytes
            .chunks_exact(WORD)
            .map(|w| u64::from_le_bytes(word_at(w, 0))))
    }

    pub fn floats(&mut self) -> Result<Vec<f64>> {
        let count = self.word()?;
        Ok(self.words(count)?.map(f64::from_bits).collect())
    }

    /// Numbers, every one finite and not beyond [`LARGEST`].
    pub fn finite(&mut self) -> Result<Vec<f64>> {
        let values = self.floats()?;
        check_finite(values.iter().copied())?;
        Ok(values)
    }

    /// Indices, every one below `bound`.
    pub fn indices(&mut self, bound: usize) -> Result<Vec<usize>> {
        let count = self.word()?;
        self.words(count)?
            .map(|index| match usize::try_from(index) {
                Ok(index) if index < bound => Ok(index),
                _ => Err(Reader::refusal(format!("index {index} of {bound}"))),
            })
            .collect()
    }

    /// A matrix of the given shape, every entry finite.
    pub fn matrix(&mut self, rows: usize, columns: usize) -> Result<Mat<f64>> {
        let count = self.shape(rows, columns)?;
        let values: Vec<f64> = self.words(count)?.map(f64::from_bits).collect();
        check_finite(values.iter().copied())?;
        Ok(Mat::from_fn(rows, columns, |i, j| values[j * rows + i]))
    }

    /// A matrix in single precision, every entry finite.
    pub fn singles(&mut self, rows: usize, columns: usize) -> Result<Mat<f32>> {
        let count = self.shape(rows, columns)?;
        let words: Vec<u64> = self.words(count.div_ceil(2))?.collect();
        let entry = |at: usize| f32::from_bits((words[at / 2] >> (32 * (at % 2))) as u32);
        check_finite((0..rows * columns).map(|at| f64::from(entry(at))))?;
        Ok(Mat::from_fn(rows, columns, |i, j| entry(j * rows + i)))
    }

    /// The shape of a matrix, which must be this one; its number of entries.
    fn shape(&mut self, rows: usize, columns: usize) -> Result<u64> {
        let found = (self.size()?, self.size()?);
        if found != (rows, columns) {
            return Err(Reader::refusal(format!(
                "matrix: expected {rows} x {columns}, found {} x {}",
                found.0, found.1
            )));
        }
        Ok((rows as u64).saturating_mul(columns as u64))
    }

    /// # Errors
    /// [`Error::Bytes`] when something is left.
    pub fn finish(self) -> Result<()> {
        if self.rest.is_empty() {
            Ok(())
        } else {
            let left = self.rest.len();
            Err(Reader::refusal(format!("{left} bytes too many")))
        }
    }
}
