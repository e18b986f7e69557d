//! Tables of references, from files or from memory.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use lashloop_plant::reference::{Interpolation, Table, TableError};

/// Tables by their paths, instead of their files.
pub type GivenTables = BTreeMap<PathBuf, Table>;

/// Where the reader of a scenario finds its table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tables<'a> {
    /// Where relative paths start.
    pub(super) directory: &'a Path,
    pub(super) given: &'a GivenTables,
}

impl Tables<'_> {
    /// The given table of this path, or else that of the file.
    pub(super) fn read(self, file: &str, interpolation: Interpolation) -> Result<Table, TableError> {
        let path = self.directory.join(file);
        match self.given.get(&path) {
            Some(table) => Ok(table.clone().interpolated(interpolation)),
            None => Table::from_file(&path, interpolation),
        }
    }
}
