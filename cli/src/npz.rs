//! NPZ files, as NumPy reads them: a zip of arrays, stored as they are.

use crate::failure::Failure;
use std::io::{Cursor, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// An array.
pub enum Array<'a> {
    /// Numbers with their shape, row by row.
    Numbers(&'a [f64], Vec<usize>),
    /// Texts, one after the other.
    Texts(&'a [String]),
}

impl Array<'_> {
    /// Its file: format 1.0 of NumPy, little-endian.
    fn bytes(&self) -> Vec<u8> {
        let (kind, shape, data) = match self {
            Array::Numbers(values, shape) => {
                let data = values.iter().flat_map(|v| v.to_le_bytes()).collect();
                ("<f8".to_owned(), shape.clone(), data)
            }
            Array::Texts(texts) => {
                let longest = texts.iter().map(|t| t.chars().count()).max();
                let width = longest.unwrap_or(0).max(1);
                let padded = |text: &String| -> Vec<u8> {
                    let letters = text.chars().map(u32::from);
                    let letters = letters.chain(std::iter::repeat(0)).take(width);
                    letters.flat_map(u32::to_le_bytes).collect()
                };
                let data: Vec<u8> = texts.iter().flat_map(padded).collect();
                (format!("<U{width}"), vec![texts.len()], data)
            }
        };
        let shape: String = shape.iter().map(|n| format!("{n}, ")).collect();
        let mut header = format!(
            "{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}), }}",
            shape.trim_end()
        );
        // the data begins at a multiple of 64
        while (10 + header.len() + 1) % 64 != 0 {
            header.push(' ');
        }
        header.push('\n');
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }
}

/// Writes a file of named arrays.
///
/// # Errors
/// [`Failure::File`].
pub fn write(path: &Path, arrays: &[(String, Array)]) -> Result<(), Failure> {
    let failed = Failure::writing(path);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(zip::DateTime::default());
    for (name, array) in arrays {
        let file = format!("{name}.npy");
        zip.start_file(file, options).map_err(|e| failed(&e))?;
        zip.write_all(&array.bytes()).map_err(|e| failed(&e))?;
    }
    let bytes = zip.finish().map_err(|e| failed(&e))?.into_inner();
    let mut file = crate::standard::create(path)?;
    file.write_all(&bytes).map_err(|e| failed(&e))?;
    file.flush().map_err(|e| failed(&e))
}
