//! Flash and RAM of the Arm image, and their limits.

use std::fs;

use anyhow::{Context, Result, ensure};
use object::elf::{self, SHF_ALLOC, SHF_WRITE};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags};

use crate::arm_toolchain::{Program, drives};
use crate::codec_size::CodecSize;
use crate::paths;

/// Most flash for vectors, code and constants (bytes). The smallest chip has 256 KiB before its store: the limit is an alarm.
const TEXT_LIMIT: u64 = 96 * 1024;
/// Most RAM for statics (bytes), of which 4 KiB are the rows of a capture. The chip has 128 KiB; the stack takes the rest.
const STATIC_RAM_LIMIT: u64 = 12 * 1024;

/// Sizes in bytes.
pub(crate) struct Size {
    text: u64,
    static_ram: u64,
    /// Between the statics and the top of the RAM.
    stack: u64,
}

/// Prints the sizes of the boards' images.
pub(crate) fn print() -> Result<()> {
    for program in drives()? {
        print_one(&program)?;
    }
    Ok(())
}

fn print_one(program: &Program) -> Result<Size> {
    let path = paths::image(&program.image);
    let elf =
        fs::read(&path).with_context(|| format!("{}: run `cargo xtask image` first", path.display()))?;
    let size = Size::of(&elf).with_context(|| path.display().to_string())?;
    println!(
        "{}: text {} B of {TEXT_LIMIT} B; static RAM {} B of {STATIC_RAM_LIMIT} B; stack {} B",
        program.image, size.text, size.static_ram, size.stack
    );
    println!("{}", CodecSize::of(&path, &elf).with_context(|| path.display().to_string())?);
    Ok(size)
}

/// Prints the sizes.
///
/// # Errors
/// A size exceeds its limit, or there is no image.
pub(crate) fn check() -> Result<()> {
    for program in drives()? {
        let size = print_one(&program)?;
        ensure!(
            size.text <= TEXT_LIMIT,
            "{} has {} B of text, at most {TEXT_LIMIT} B are allowed",
            program.image,
            size.text
        );
        ensure!(
            size.static_ram <= STATIC_RAM_LIMIT,
            "{} has {} B of static RAM, at most {STATIC_RAM_LIMIT} B are allowed",
            program.image,
            size.static_ram
        );
    }
    Ok(())
}

impl Size {
    fn of(elf: &[u8]) -> Result<Self> {
        let file = object::File::parse(elf)?;
        let sum = |wanted: elf::SectionFlags| -> u64 {
            let sections = file.sections().filter(|section| match section.flags() {
                SectionFlags::Elf { sh_flags, .. } => sh_flags & (SHF_ALLOC | SHF_WRITE) == wanted,
                _ => false,
            });
            sections.map(|section| section.size()).sum()
        };
        let address = |name: &str| {
            let symbol = file.symbols().find(|symbol| symbol.name() == Ok(name));
            symbol.map(|symbol| symbol.address()).with_context(|| format!("the image has no symbol {name}"))
        };
        Ok(Self {
            text: sum(SHF_ALLOC),
            static_ram: sum(SHF_ALLOC | SHF_WRITE),
            stack: address("_stack_start")? - address("__sheap")?,
        })
    }
}
