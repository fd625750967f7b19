//! Where the files that a scene names come from: a folder, memory, or nowhere.
//!
//! A scene is text; a mesh that it names is another file. Whoever compiles says where such files are. A compiled model keeps the
//! bytes of those that it was made from, so that it is compiled again without the folder.

use crate::bytes::{Reader, Writer};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::PathBuf;
use std::sync::Arc;

/// A source of files.
pub trait Files {
    /// The bytes of the file that a scene calls `name`.
    ///
    /// # Errors
    /// Why there are none, as a part of a sentence.
    fn read(&self, name: &str) -> Result<Arc<[u8]>, String>;
}

/// No files: for scenes that name none.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoFiles;

impl Files for NoFiles {
    fn read(&self, _name: &str) -> Result<Arc<[u8]>, String> {
        Err("no files came with the scene".to_owned())
    }
}

/// The files of a folder, as that of a scene file. A name is a path relative to it.
#[derive(Debug, Clone, Default)]
pub struct Folder(pub PathBuf);

impl Folder {
    /// The folder that a file is in.
    pub fn of(file: &std::path::Path) -> Folder {
        Folder(file.parent().map(PathBuf::from).unwrap_or_default())
    }
}

impl Files for Folder {
    fn read(&self, name: &str) -> Result<Arc<[u8]>, String> {
        let path = self.0.join(name);
        let failed = |why: &dyn std::fmt::Display| format!("{}: {why}", path.display());
        let mut file = File::open(&path).map_err(|error| failed(&error))?;
        let metadata = file.metadata().map_err(|error| failed(&error))?;
        if !metadata.is_file() {
            return Err(failed(&"it is no file"));
        }
        let mut bytes = Vec::new();
        let length = usize::try_from(metadata.len()).unwrap_or(usize::MAX);
        let has_room = bytes.try_reserve_exact(length).is_ok();
        if !has_room {
            return Err(failed(&"it is larger than the memory"));
        }
        // no more than announced, should it grow meanwhile
        let mut announced = (&mut file).take(metadata.len());
        announced
            .read_to_end(&mut bytes)
            .map_err(|error| failed(&error))?;
        Ok(bytes.into())
    }
}

/// Files in memory, by their names.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MemoryFiles(pub BTreeMap<String, Arc<[u8]>>);

impl MemoryFiles {
    /// Files with these names and contents.
    pub fn new<'a>(files: impl IntoIterator<Item = (&'a str, &'a [u8])>) -> MemoryFiles {
        let files = files.into_iter();
        MemoryFiles(
            files
                .map(|(name, bytes)| (name.to_owned(), bytes.into()))
                .collect(),
        )
    }
}

impl MemoryFiles {
    pub(crate) fn write(&self, out: &mut Writer) {
        out.word(self.0.len() as u64);
        for (name, bytes) in &self.0 {
            out.text(name);
            out.raw(bytes);
        }
    }

    /// # Errors
    /// [`crate::Error::Bytes`].
    pub(crate) fn from_bytes(from: &mut Reader) -> crate::Result<MemoryFiles> {
        let mut files = BTreeMap::new();
        for _ in 0..from.word()? {
            let name = from.text()?.to_owned();
            files.insert(name, from.raw()?.into());
        }
        Ok(MemoryFiles(files))
    }
}

impl Files for MemoryFiles {
    fn read(&self, name: &str) -> Result<Arc<[u8]>, String> {
        let known = || {
            self.0
                .keys()
                .map(|name| crate::message::cut(name))
                .collect::<Vec<_>>()
                .join(", ")
        };
        match self.0.get(name) {
            Some(bytes) => Ok(Arc::clone(bytes)),
            None if self.0.is_empty() => NoFiles.read(name),
            None => Err(format!(
                "it is not among the files that came with the scene: {}",
                known()
            )),
        }
    }
}

/// Passes on what another source has, and keeps it.
pub(crate) struct Keeper<'a> {
    source: &'a dyn Files,
    kept: RefCell<MemoryFiles>,
}

impl<'a> Keeper<'a> {
    pub fn new(source: &'a dyn Files) -> Keeper<'a> {
        Keeper {
            source,
            kept: RefCell::default(),
        }
    }

    /// What was read.
    pub fn into_files(self) -> MemoryFiles {
        self.kept.into_inner()
    }
}

impl Files for Keeper<'_> {
    fn read(&self, name: &str) -> Result<Arc<[u8]>, String> {
        let bytes = self.source.read(name)?;
        self.kept
            .borrow_mut()
            .0
            .insert(name.to_owned(), Arc::clone(&bytes));
        Ok(bytes)
    }
}
