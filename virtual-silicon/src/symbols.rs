//! Addresses of an image, and mutants of it.

use anyhow::{Context, Result, ensure};
use object::{File, Object, ObjectSection, ObjectSymbol, SymbolKind};
use rigless::image::Image;
use std::path::{Path, PathBuf};

use crate::thumb::{Code, NOTHING, RETURN};

/// Start of the symbol that the build script of the firmware makes of the board's name.
const BOARD: &str = "_lashloop_board_";

/// An image as its file.
#[derive(Debug, Clone, PartialEq, Eq)]
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
    /// The file isn't an image.
    pub fn image(&self) -> Result<Image> {
        let image = Image::new(&self.path, self.bytes.clone(), None);
        image.with_context(|| format!("{} isn't an image", self.path.display()))
    }

    /// Name of the board that the image is for.
    ///
    /// # Errors
    /// The file isn't an ELF file.
    pub fn board(&self) -> Result<Option<String>> {
        let file = self.elf()?;
        let mut names = file.symbols().filter_map(|symbol| symbol.name().ok()?.strip_prefix(BOARD));
        Ok(names.next().map(str::to_owned))
    }

    /// Address of the only variable of this name, without its path.
    ///
    /// # Errors
    /// The image has none or several.
    pub fn variable(&self, name: &str) -> Result<u64> {
        self.find(name, SymbolKind::Data).map(|found| found.address)
    }

    /// Address of the only function of this name. The name may have the last segments of its path before it.
    ///
    /// # Errors
    /// The image has none or several.
    pub fn function(&self, name: &str) -> Result<u64> {
        self.find(name, SymbolKind::Text).map(|found| found.address)
    }

    /// Address of the first halfword of a function that is this one.
    ///
    /// # Errors
    /// The image has no such function or several, or the function has no such halfword.
    pub fn first_in(&self, function: &str, halfword: u16) -> Result<u64> {
        let Found { address, size, offset } = self.find(function, SymbolKind::Text)?;
        let mut halfwords = self.bytes[offset..][..size].chunks(2);
        let place = halfwords.position(|it| it == halfword.to_le_bytes());
        let place = place.with_context(|| format!("{function} has no halfword {halfword:#06x}"))?;
        Ok(address + 2 * place as u64)
    }

    /// The same image with a function that returns at once.
    ///
    /// # Errors
    /// The image has no such function or several.
    pub fn without(&self, function: &str) -> Result<Self> {
        self.with_code(function, |_| Code::default().halfword(RETURN))
    }

    /// The same image with other code at the start of a function, made for the address of the function.
    ///
    /// # Errors
    /// The image has no such function or several, or the code is longer than the function.
    pub fn with_code(&self, function: &str, code: impl FnOnce(u64) -> Code) -> Result<Self> {
        let Found { address, size, offset } = self.find(function, SymbolKind::Text)?;
        let code = code(address).0;
        ensure!(code.len() <= size, "{function} has {size} bytes, its new code {}", code.len());
        let mut mutant = self.clone();
        mutant.bytes[offset..][..code.len()].copy_from_slice(&code);
        Ok(mutant)
    }

    /// The same image with a function in which one piece of code is another one of the same length.
    ///
    /// # Errors
    /// The image has no such function or several, or the function doesn't have the piece exactly once.
    pub fn with_piece(&self, function: &str, piece: &Code, other: &Code) -> Result<Self> {
        let Found { size, offset, .. } = self.find(function, SymbolKind::Text)?;
        let length = piece.0.len();
        ensure!(length == other.0.len(), "a piece of {length} bytes for one of {}", other.0.len());
        let mut windows = self.bytes[offset..][..size].windows(length).enumerate();
        let places: Vec<_> = windows.by_ref().filter(|(_, window)| *window == piece.0).collect();
        let [(place, _)] = places[..] else {
            anyhow::bail!("{function} has the piece {} times, expected 1", places.len());
        };
        let mut mutant = self.clone();
        mutant.bytes[offset + place..][..length].copy_from_slice(&other.0);
        Ok(mutant)
    }

    /// The same image with a function that no longer calls another one.
    ///
    /// # Errors
    /// The image has no such functions or several, or there is no call.
    pub fn without_calls(&self, function: &str, called: &str) -> Result<Self> {
        let Found { address, size, offset } = self.find(function, SymbolKind::Text)?;
        let target = self.function(called)?;
        let mut mutant = self.clone();
        let mut calls = 0;
        for place in (0..size.saturating_sub(3)).step_by(2) {
            let call = Code::default().call(address + place as u64, target);
            let bytes = &mut mutant.bytes[offset + place..][..4];
            if *bytes == call.0 {
                bytes.copy_from_slice(&Code::default().halfwords(&[NOTHING, NOTHING]).0);
                calls += 1;
            }
        }
        ensure!(calls > 0, "{function} doesn't call {called}");
        Ok(mutant)
    }

    fn elf(&self) -> Result<File<'_>> {
        File::parse(&self.bytes[..]).with_context(|| format!("{} isn't an ELF file", self.path.display()))
    }

    /// The only symbol of this name.
    fn find(&self, name: &str, kind: SymbolKind) -> Result<Found> {
        let file = self.elf()?;
        // Both ways of mangling put the length before the name. The newer one separates the two where the name begins with an
        // underscore.
        let mangled = ["", "_"].map(|separator| {
            let of = |segment: &str| if segment.starts_with('_') { separator } else { "" };
            name.split("::").map(|it| format!("{}{}{it}", it.len(), of(it))).collect::<String>()
        });
        let named = |is_it: &dyn Fn(&str) -> bool| -> Vec<_> {
            let symbols = file.symbols().filter(|symbol| symbol.kind() == kind);
            symbols.filter(|symbol| symbol.name().is_ok_and(is_it)).collect()
        };
        // A name that is not mangled comes before one that is.
        let mut found = named(&|found| found == name);
        if found.is_empty() {
            found = named(&|found| mangled.iter().any(|mangled| found.contains(mangled)));
        }
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
        Ok(Found { address, size: usize::try_from(symbol.size())?, offset })
    }
}

/// A symbol.
struct Found {
    address: u64,
    size: usize,
    /// Offset in the file.
    offset: usize,
}
