//! What the loader of FMUs and the library of exported ones ask of a machine. The program itself is static and asks for nothing.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use object::Endianness;
use object::read::elf::{ElfFile64, FileHeader};

/// Version of the GNU C library.
pub(super) type Glibc = (u32, u32);

/// The oldest GNU C library that has every symbol which a program or library takes from it.
pub(super) fn glibc(program: &Path) -> Result<Glibc> {
    let bytes = fs::read(program).with_context(|| format!("{} can't be read", program.display()))?;
    newest(&bytes)
        .with_context(|| format!("{} can't be read as ELF", program.display()))?
        .with_context(|| format!("{} names no version of the GNU C library", program.display()))
}

fn newest(bytes: &[u8]) -> Result<Option<Glibc>> {
    let file = ElfFile64::<Endianness>::parse(bytes)?;
    let endian = file.endian();
    let sections = file.elf_header().sections(endian, bytes)?;
    let mut newest = None;
    let Some((mut needs, strings)) = sections.gnu_verneed(endian, bytes)? else { return Ok(None) };
    let strings = sections.strings(endian, bytes, strings)?;
    while let Some((_, mut versions)) = needs.next()? {
        while let Some(version) = versions.next()? {
            let name = String::from_utf8_lossy(version.name(endian, strings)?);
            newest = newest.max(name.strip_prefix("GLIBC_").and_then(numbers));
        }
    }
    Ok(newest)
}

/// The first two numbers of a version, as `2.34`.
fn numbers(version: &str) -> Option<Glibc> {
    let mut numbers = version.split('.').map(str::parse);
    Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
}
