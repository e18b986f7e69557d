//! The image for the flash, from an ELF: the loaded bytes in one piece, and the build that the drive will report.

use std::io;
use std::num::NonZeroU32;
use std::ops::Range;
use std::path::{Path, PathBuf};

use lashloop_bench::device::Build;
use lashloop_bench::regular_file;
use lashloop_bench::run::digest::sha256;
use object::elf;
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Architecture, LittleEndian, Object, ObjectSymbol};

/// Flash of the STM32F405xG. That of every other chip is larger than any image too.
pub const FLASH: Range<u32> = 0x0800_0000..0x0810_0000;
/// RAM of the STM32F405 that a stack can begin in; its upper end is the first address after it.
const RAM: Range<u32> = 0x2000_0000..0x2002_0001;
/// An erased byte.
const ERASED: u8 = 0xff;

/// Symbols of the linker script, see `firmware/build.rs`.
const BUILD_ID: &str = "_lashloop_build_id";
const BUILD_IS_DIRTY: &str = "_lashloop_build_is_dirty";
/// Symbol of a program for measurements.
const NO_DRIVE: &str = "_lashloop_no_drive";
/// Start of the symbol that ends with the board's name.
const BOARD: &str = "_lashloop_board_";
/// Start of the symbol that ends with the chip's name.
const CHIP: &str = "_lashloop_chip_";
/// The chip of an ELF that names none.
const DEFAULT_CHIP: &str = "STM32F405RGTx";

/// Why an ELF can't be flashed.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct ImageError {
    pub path: PathBuf,
    pub problem: ImageProblem,
}

/// What is wrong with an ELF.
#[derive(Debug, thiserror::Error)]
pub enum ImageProblem {
    #[error("can't be read: {0}")]
    Read(#[from] io::Error),
    #[error("isn't an ELF file for a Cortex-M ({0}); name the file that `cargo xtask image` builds")]
    NotAnElf(String),
    #[error("has nothing to load into the flash; name the file that `cargo xtask image` builds")]
    Empty,
    #[error(
        "loads {size} B at {address:#010x}, outside the flash from {:#010x} to {:#010x}: it is linked for another chip",
        FLASH.start,
        FLASH.end
    )]
    Outside { address: u32, size: u64 },
    #[error(
        "begins at {address:#010x}, and the chip starts at {:#010x}: it is linked for a boot loader of its own",
        FLASH.start
    )]
    Begin { address: u32 },
    #[error("is a program for measurements and no drive; name the file that `cargo xtask image` builds")]
    NoDrive,
    #[error(
        "has no vector table: the first words are {stack:#010x} and {reset:#010x}, a stack in RAM and a reset vector in the \
         image were expected"
    )]
    Vectors { stack: u32, reset: u32 },
}

/// An image for the flash.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// The ELF.
    pub path: PathBuf,
    /// From the start of the flash on. Gaps between segments are erased flash.
    pub bytes: Vec<u8>,
    /// The build that the drive reports once it runs this image; `None` if the ELF doesn't have it.
    pub build: Option<Build>,
    /// The board that it is for, as its drive reports it; `None` if the ELF doesn't have it.
    pub board: Option<String>,
    /// The chip of that board, as probe-rs names it.
    pub chip: String,
}

impl Image {
    /// Reads an ELF.
    ///
    /// # Errors
    /// The file can't be read, or isn't an image for this chip.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let failed = |problem| ImageError { path: path.to_owned(), problem };
        let elf = regular_file::read(path).map_err(|source| failed(source.into()))?;
        Self::from_bytes(path, &elf)
    }

    /// As [`read`](Self::read), of the bytes of a file.
    ///
    /// # Errors
    /// They aren't an image for this chip.
    pub fn from_bytes(path: &Path, elf: &[u8]) -> Result<Self, ImageError> {
        Self::from_elf(path, elf).map_err(|problem| ImageError { path: path.to_owned(), problem })
    }

    fn from_elf(path: &Path, elf: &[u8]) -> Result<Self, ImageProblem> {
        let no_elf = |error: object::read::Error| ImageProblem::NotAnElf(error.to_string());
        let file = ElfFile32::<LittleEndian>::parse(elf).map_err(no_elf)?;
        if file.architecture() != Architecture::Arm {
            return Err(ImageProblem::NotAnElf(format!("its processor is {:?}", file.architecture())));
        }
        if file.symbols().any(|symbol| symbol.name() == Ok(NO_DRIVE)) {
            return Err(ImageProblem::NoDrive);
        }
        let mut segments = Vec::new();
        for header in file.elf_program_headers() {
            let data = header.data(LittleEndian, elf).map_err(|()| {
                ImageProblem::NotAnElf("a segment ends after the end of the file".to_owned())
            })?;
            // Variables have an initial value, which lies in the flash, at a physical address.
            if header.p_type(LittleEndian) == elf::PT_LOAD && !data.is_empty() {
                segments.push((header.p_paddr(LittleEndian), data));
            }
        }
        let bytes = flatten(segments)?;
        check_vectors(&bytes)?;
        let chip = end_of_symbol(&file, CHIP).unwrap_or_else(|| DEFAULT_CHIP.to_owned());
        let board = end_of_symbol(&file, BOARD);
        Ok(Self { path: path.to_owned(), bytes, build: build(&file), board, chip })
    }

    /// SHA-256 of the bytes in hexadecimal.
    #[must_use]
    pub fn sha256(&self) -> String {
        sha256(&self.bytes)
    }
}

/// One piece from the start of the flash on.
fn flatten(mut segments: Vec<(u32, &[u8])>) -> Result<Vec<u8>, ImageProblem> {
    segments.sort_by_key(|(address, _)| *address);
    let first = segments.first().map(|(address, _)| *address).ok_or(ImageProblem::Empty)?;
    let mut bytes = Vec::new();
    for (address, data) in segments {
        let end = u64::from(address) + data.len() as u64;
        if address < FLASH.start || end > u64::from(FLASH.end) {
            return Err(ImageProblem::Outside { address, size: data.len() as u64 });
        }
        let offset = (address - FLASH.start) as usize;
        if bytes.len() < offset + data.len() {
            bytes.resize(offset + data.len(), ERASED);
        }
        bytes[offset..offset + data.len()].copy_from_slice(data);
    }
    if first == FLASH.start { Ok(bytes) } else { Err(ImageProblem::Begin { address: first }) }
}

/// A chip without a valid vector table locks up after its reset, and answers no more than a dead one.
fn check_vectors(bytes: &[u8]) -> Result<(), ImageProblem> {
    let word = |index: usize| {
        let word = bytes.get(4 * index..4 * index + 4).and_then(|word| word.try_into().ok());
        u32::from_le_bytes(word.unwrap_or_default())
    };
    let (stack, reset) = (word(0), word(1));
    let code = FLASH.start..FLASH.start + bytes.len() as u32;
    // Bit 0 of a vector selects the Thumb state, the only one of a Cortex-M.
    if RAM.contains(&stack) && code.contains(&(reset & !1)) && reset & 1 == 1 {
        Ok(())
    } else {
        Err(ImageProblem::Vectors { stack, reset })
    }
}

fn build(file: &ElfFile32<'_, LittleEndian>) -> Option<Build> {
    let value = |name: &str| {
        let symbol = file.symbols().find(|symbol| symbol.name() == Ok(name))?;
        u32::try_from(symbol.address()).ok()
    };
    let commit = NonZeroU32::new(value(BUILD_ID)?)?;
    Some(Build { commit: Some(commit), is_dirty: value(BUILD_IS_DIRTY)? != 0 })
}

/// What follows these letters in the name of a symbol.
fn end_of_symbol(file: &ElfFile32<'_, LittleEndian>, start: &str) -> Option<String> {
    let mut names = file.symbols().filter_map(|symbol| symbol.name().ok()?.strip_prefix(start));
    names.next().map(str::to_owned)
}
