//! What an MSH file says, before it is a mesh: nodes, elements and the groups they belong to.

use super::block::Block;
use super::cursor::{Cursor, Encoding};
use super::fault::{Fault, Outcome};
use super::{version2, version4};
use crate::message::cut;
use std::collections::BTreeMap;

/// The contents of a file.
#[derive(Debug, Default)]
pub(super) struct Contents {
    /// Names of the physical groups, by dimension and number.
    pub names: BTreeMap<(usize, i64), String>,
    /// Number and coordinates of every node, in the order of the file.
    pub nodes: Vec<(u64, [f64; 3])>,
    pub blocks: Vec<Block>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Version {
    Two,
    Four,
}

impl Contents {
    /// Reads a file.
    pub fn read(bytes: &[u8]) -> Outcome<Contents> {
        let mut from = Cursor::new(bytes);
        let mut contents = Contents::default();
        let mut entities = version4::Entities::default();
        let mut version = None;
        let mut seen: Vec<String> = Vec::new();
        while let Some(section) = from.next_section()? {
            let is_read = matches!(
                section.as_str(),
                "MeshFormat"
                    | "PhysicalNames"
                    | "Entities"
                    | "PartitionedEntities"
                    | "Nodes"
                    | "Elements"
            );
            if is_read && seen.contains(&section) {
                return Err(from.fault("this section a second time", "each section once"));
            }
            match (section.as_str(), version) {
                ("MeshFormat", _) => version = Some(format(&mut from)?),
                ("PhysicalNames", _) => contents.names = names(&mut from)?,
                ("Entities", Some(Version::Four)) => entities.read(&mut from)?,
                ("PartitionedEntities", Some(Version::Four)) => entities.read_parts(&mut from)?,
                ("Nodes", Some(Version::Four)) => contents.nodes = version4::nodes(&mut from)?,
                ("Nodes", Some(Version::Two)) => contents.nodes = version2::nodes(&mut from)?,
                ("Elements", Some(Version::Four)) => {
                    contents.blocks = version4::elements(&mut from, &entities)?;
                }
                ("Elements", Some(Version::Two)) => {
                    contents.blocks = version2::elements(&mut from)?
                }
                ("ParametricNodes", _) => {
                    let allowed = "$Nodes (in Gmsh: Mesh.SaveParametric = 0)";
                    return Err(from.fault("nodes with parameters", allowed));
                }
                ("Nodes" | "Elements" | "Entities", None) => {
                    return Err(from.fault("this section before $MeshFormat", "$MeshFormat first"));
                }
                _ => {
                    from.skip_section()?;
                    continue;
                }
            }
            from.end_section()?;
            seen.push(section);
        }
        for section in ["MeshFormat", "Nodes", "Elements"] {
            if !seen.iter().any(|s| s == section) {
                let allowed = "an MSH file with $MeshFormat, $Nodes and $Elements";
                return Err(Fault::new(format!("no section ${section}"), allowed));
            }
        }
        Ok(contents)
    }
}

/// `$MeshFormat`: version, encoding, bytes of a number.
fn format(from: &mut Cursor) -> Outcome<Version> {
    let line = String::from_utf8_lossy(from.line()).into_owned();
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    let expected = "\"4.1 0 8\": version 4.1 or 2.2, 0 for text or 1 for binary, bytes of a number";
    let &[version, encoding, size] = &words[..] else {
        return Err(from.fault(format!("{:?}", cut(&line)), expected));
    };
    let version = match version {
        "4.1" => Version::Four,
        "2.2" => Version::Two,
        _ => {
            let allowed =
                "4.1 or 2.2 (in Gmsh: Mesh.MshFileVersion); other versions are other formats";
            return Err(from.fault(format!("version {}", cut(version)), allowed));
        }
    };
    match (encoding, size) {
        ("0", "4" | "8") => Ok(version),
        ("1", "4" | "8") => {
            let size = if size == "4" { 4 } else { 8 };
            if version == Version::Two && size == 4 {
                return Err(from.fault("numbers of 4 bytes", "8 in version 2.2"));
            }
            from.encoding = Encoding::Binary {
                size,
                is_big_endian: false,
            };
            let is_big_endian = match from.int("the number 1, which tells the order of bytes")? {
                1 => false,
                0x0100_0000 => true,
                other => {
                    let allowed = "the number 1, which tells the order of bytes";
                    return Err(from.fault(other, allowed));
                }
            };
            from.encoding = Encoding::Binary {
                size,
                is_big_endian,
            };
            Ok(version)
        }
        _ => Err(from.fault(format!("{:?}", cut(&line)), expected)),
    }
}

/// `$PhysicalNames`: text in files of both encodings.
fn names(from: &mut Cursor) -> Outcome<BTreeMap<(usize, i64), String>> {
    let count = from.text_int("the number of names")?;
    from.line();
    let mut names = BTreeMap::new();
    for _ in 0..count {
        let dimension = from.text_int("the dimension of a group")?;
        let number = from.text_int("the number of a group")?;
        let expected = "a name of a group in quotation marks, UTF-8";
        let line = std::str::from_utf8(from.line())
            .map_err(|_| from.fault("bytes that are no text", expected))?;
        let name = line
            .trim()
            .strip_prefix('"')
            .and_then(|name| name.strip_suffix('"'));
        let (Ok(dimension @ 0..=3), Some(name)) = (usize::try_from(dimension), name) else {
            let found = format!(
                "group {number} of dimension {dimension} with {:?}",
                cut(line)
            );
            return Err(from.fault(found, expected));
        };
        if names
            .insert((dimension, number.saturating_abs()), name.to_owned())
            .is_some()
        {
            let found = format!("a second name of group {number} of dimension {dimension}");
            return Err(from.fault(found, "one name for each group"));
        }
    }
    // a group without a name is called by its number
    names.retain(|_, name| !name.is_empty());
    Ok(names)
}
