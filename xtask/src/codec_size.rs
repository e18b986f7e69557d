//! Code size of the wire contract in the Arm image.
//!
//! Most of it is inlined into the drive, so symbols don't show it. The line table does: it lists for every instruction
//! the functions around it, inlined ones included.

use std::fmt;
use std::path::Path;

use addr2line::Loader;
use anyhow::{Result, anyhow};
use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};

/// Source folders of the wire contract: ours and the CRC's.
const SOURCES: [&str; 2] = ["/protocol/src/", "/crc-3."];
/// The shortest instruction (bytes).
const THUMB: usize = 2;

/// Sizes in bytes.
pub(crate) struct CodecSize {
    code: usize,
    crc_table: u64,
}

impl CodecSize {
    pub(crate) fn of(path: &Path, elf: &[u8]) -> Result<Self> {
        let lines = Loader::new(path).map_err(|error| anyhow!("no line table: {error}"))?;
        let file = object::File::parse(elf)?;
        let text = file.section_by_name(".text").ok_or_else(|| anyhow!("no section .text"))?;
        let addresses = (text.address()..text.address() + text.size()).step_by(THUMB);
        let mut code = 0;
        for address in addresses {
            code += if is_codec(&lines, address)? { THUMB } else { 0 };
        }
        let is_table = |name: &str| name.contains("lashloop_protocol") && name.contains("3CRC");
        let tables = file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Data);
        let crc_table =
            tables.filter(|symbol| symbol.name().is_ok_and(is_table)).map(|symbol| symbol.size()).sum();
        Ok(Self { code, crc_table })
    }
}

/// Whether the instruction is part of a function of the wire contract, inlined or not.
fn is_codec(lines: &Loader, address: u64) -> Result<bool> {
    let failed = |error| anyhow!("the line table at {address:#x}: {error}");
    let mut frames = lines.find_frames(address).map_err(failed)?;
    while let Some(frame) = frames.next().map_err(|error| failed(error.into()))? {
        let file = frame.location.and_then(|location| location.file);
        if file.is_some_and(|file| SOURCES.iter().any(|source| file.contains(source))) {
            return Ok(true);
        }
    }
    Ok(false)
}

impl fmt::Display for CodecSize {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { code, crc_table } = self;
        write!(out, "of it the wire contract: code {code} B, inlined or not; CRC table {crc_table} B")
    }
}
