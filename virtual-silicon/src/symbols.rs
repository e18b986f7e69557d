//! Addresses of an image, and mutants of it.

use anyhow::{Context, Result, ensure};
use object::{File, Object, ObjectSection, ObjectSymbol, SymbolKind};
use rigless::image::Image;

use std::path::{Path, PathBuf};

/// The instruction `bx lr`: return to the caller.
const RETURN: [u8; 2] = 0x4770_u16.to_le_bytes();

/// An image as its file.
#[derive(Debug, Clone)]
pub struct Symbols {
    path: PathBuf,
    bytes: Vec<u8>,
}

impl Symbols {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// The file can't be read.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).with_context(|| format!("{} can't be read", path.display()))?;
        Ok(Self { path: path.to_owned(), bytes })
    }

    /// The image, as the chip's flash memory holds it.
    ///
    /// # Errors
    /// The file is no image.
    pub fn image(&self) -> Result<Image> {
        let image = Image::new(&self.path, self.bytes.clone(), None);
        image.with_context(|| format!("{} is no image", self.path.display()))
    }

    /// Address of the only variable of this name, without its path.
    ///
    /// # Errors
    /// The image has none or several.
    pub fn variable(&self, name: &str) -> Result<u64> {
        self.find(name, SymbolKind::Data).map(|(address, _)| address)
    }

    /// The same image with a function that returns at once.
    ///
    /// # Errors
    /// The image has no such function or several.
    pub fn without(&self, function: &str) -> Result<Self> {
        // Bit 0 of a function's address marks Thumb code.
        let (_, offset) = self.find(function, SymbolKind::Text)?;
        let mut mutant = self.clone();
        mutant.bytes[offset..][..RETURN.len()].copy_from_slice(&RETURN);
        Ok(mutant)
    }

    /// Address of the only symbol of this name, and its offset in the file.
    fn find(&self, name: &str, kind: SymbolKind) -> Result<(u64, usize)> {
        let file = File::parse(&self.bytes[..])
            .with_context(|| format!("{} is no ELF file", self.path.display()))?;
        // Both ways of mangling put the length before the name.
        let mangled = format!("{}{name}", name.len());
        let is_wanted = |symbol: &object::Symbol<'_, '_>| {
            symbol.name().is_ok_and(|found| found == name || found.contains(&mangled))
                && symbol.kind() == kind
        };
        let found: Vec<_> = file.symbols().filter(is_wanted).collect();
        let [symbol] = &found[..] else {
            let count = found.len();
            anyhow::bail!("{} has {count} symbols {name}, expected 1", self.path.display());
        };
        let address = symbol.address() & !1;
        let section = symbol.section_index().context("a symbol without a section")?;
        let section = file.section_by_index(section)?;
        // A section without contents, such as zeroed variables, has no place in the file.
        let start = section.file_range().map_or(0, |(start, _)| start);
        let offset = usize::try_from(start + address - section.address())?;
        ensure!(offset < self.bytes.len() || kind == SymbolKind::Data, "{name} is outside its file");
        Ok((address, offset))
    }
}
