//! Small ELF files for the Cortex-M, as a linker would write them.

use std::fs;
use std::path::Path;

const HEADER: usize = 52;
const PROGRAM_HEADER: usize = 32;
const SECTION_HEADER: usize = 40;
/// Section of an absolute symbol.
const ABSOLUTE: u16 = 0xfff1;

/// An ELF file to be.
#[derive(Debug, Clone)]
pub struct Elf {
    /// Processor; 40 is Arm.
    pub machine: u16,
    /// Physical address and contents of each segment.
    pub segments: Vec<(u32, Vec<u8>)>,
    /// Absolute symbols.
    pub symbols: Vec<(&'static str, u32)>,
}

impl Elf {
    /// An image with `size` bytes from the start of the flash on, with vectors that a chip starts from, of this build. Its board
    /// is that of the native twin.
    #[must_use]
    pub fn image(size: usize, build_id: u32, is_dirty: bool) -> Self {
        let mut bytes: Vec<u8> =
            (0..size as u32).map(|at| (at.wrapping_mul(0x9e37_79b9) >> 24) as u8).collect();
        bytes[..4].copy_from_slice(&0x2002_0000_u32.to_le_bytes());
        bytes[4..8].copy_from_slice(&0x0800_0009_u32.to_le_bytes());
        let symbols = vec![
            ("_lashloop_build_id", build_id),
            ("_lashloop_build_is_dirty", u32::from(is_dirty)),
            ("_lashloop_board_native-twin", 1),
        ];
        Self { machine: 40, segments: vec![(0x0800_0000, bytes)], symbols }
    }

    /// The file.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        let mut names = vec![0];
        let mut symbols = vec![0; 16];
        for (name, value) in &self.symbols {
            let words = [names.len() as u32, *value, 0];
            symbols.extend(words.iter().flat_map(|word| word.to_le_bytes()));
            symbols.extend([0x10, 0]);
            symbols.extend(ABSOLUTE.to_le_bytes());
            names.extend(name.bytes().chain([0]));
        }
        let mut at = HEADER + PROGRAM_HEADER * self.segments.len();
        let mut programs = Vec::new();
        let mut contents = Vec::new();
        let mut loaded = Vec::new();
        for (address, data) in &self.segments {
            let size = data.len() as u32;
            let words = [1, at as u32, *address, *address, size, size, 5, 4];
            programs.extend(words.iter().flat_map(|word: &u32| word.to_le_bytes()));
            contents.extend_from_slice(data);
            loaded.push([0, 1, 6, *address, at as u32, size, 0, 0, 1, 0]);
            at += data.len();
        }
        let symbols_at = at as u32;
        let names_at = symbols_at + symbols.len() as u32;
        let sections_at = names_at + names.len() as u32;
        let mut sections: Vec<[u32; 10]> = vec![
            [0; 10],
            [0, 2, 0, 0, symbols_at, symbols.len() as u32, 2, 1, 4, 16],
            [0, 3, 0, 0, names_at, names.len() as u32, 0, 0, 1, 0],
        ];
        sections.extend(loaded);
        let mut file = vec![0x7f, b'E', b'L', b'F', 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        file.extend([2, self.machine].iter().flat_map(|half: &u16| half.to_le_bytes()));
        let words = [1, 0x0800_0009, HEADER as u32, sections_at, 0x0500_0000];
        file.extend(words.iter().flat_map(|word: &u32| word.to_le_bytes()));
        let halves = [HEADER, PROGRAM_HEADER, self.segments.len(), SECTION_HEADER, sections.len(), 2]
            .map(|it| it as u16);
        file.extend(halves.iter().flat_map(|half| half.to_le_bytes()));
        file.extend([programs, contents, symbols, names].concat());
        file.extend(sections.iter().flatten().flat_map(|word| word.to_le_bytes()));
        file
    }

    /// Writes the file.
    ///
    /// # Panics
    /// The folder is missing.
    pub fn write(&self, path: &Path) {
        fs::write(path, self.bytes()).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    }
}
