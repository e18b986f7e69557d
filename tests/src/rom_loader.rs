//! The boot loader in the ROM of an STM32F405 on a UART (ST AN3155, AN2606), with the flash behind it.
//!
//! It is made from the documents, not from a chip. It stores what it receives, and starts nothing.

use std::fs::File;
use std::io::{Read, Write};
use std::mem;

use lashloop_bench::supervisor::find_program;
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::program::Running;

const ACK: u8 = 0x79;
const NACK: u8 = 0x1f;
const SYNCHRONISATION: u8 = 0x7f;
/// Start of the flash.
pub const FLASH: u32 = 0x0800_0000;
const SIZE: usize = 1 << 20;
/// Product number of the STM32F405.
const PRODUCT: [u8; 2] = [0x04, 0x13];
/// Version 3.1 and the commands of the loader: Get, Get Version, Get ID, Read Memory, Go, Write Memory, Extended Erase, Write
/// Protect, Write Unprotect, Readout Protect, Readout Unprotect. The last four get no answer but NACK.
const COMMANDS: [u8; 12] = [0x31, 0x00, 0x01, 0x02, 0x11, 0x21, 0x31, 0x44, 0x63, 0x73, 0x82, 0x92];

/// The program that talks to the loader.
pub const PROGRAM: &str = "stm32flash";

/// Names the missing program and the command that installs it.
#[must_use]
pub fn missing() -> Option<String> {
    find_program(PROGRAM).err().map(|error| format!("{error}: run `cargo xtask setup`"))
}

/// What is wrong with a chip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Defect {
    /// Nothing.
    None,
    /// The flash is protected: a block is answered by NACK.
    Protected,
    /// A block is answered by a byte that is neither ACK nor NACK.
    Garbled,
    /// This byte of the flash keeps its lowest bit at 0.
    StuckBit(usize),
    /// The loader stops answering at the first block.
    Hangs,
}

/// A chip in its boot loader. Its flash starts as zeros, so that only an erased sector takes an image.
pub struct RomLoader {
    /// The flash.
    pub flash: Vec<u8>,
    /// Where `Go` has left the loader for.
    pub left_for: Option<u32>,
    defect: Defect,
    received: Vec<u8>,
    awaits: Awaits,
}

/// The part of a request that comes next.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Awaits {
    Synchronisation,
    Command,
    /// The address of a command.
    Address(u8),
    /// How much to read from this offset in the flash.
    Length(usize),
    /// What to write to this offset in the flash.
    Block(usize),
    /// The numbers of the sectors to erase.
    Sectors,
    /// The loader hangs.
    Nothing,
}

impl RomLoader {
    /// The loader of a chip that was just reset.
    #[must_use]
    pub fn new(defect: Defect) -> Self {
        let awaits = Awaits::Synchronisation;
        Self { flash: vec![0; SIZE], left_for: None, defect, received: Vec::new(), awaits }
    }

    /// Whether the loader has stopped answering.
    #[must_use]
    pub fn hangs(&self) -> bool {
        self.awaits == Awaits::Nothing
    }

    /// Takes bytes and returns the answers.
    #[must_use]
    pub fn exchange(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.received.extend_from_slice(bytes);
        let mut answers = Vec::new();
        while self.left_for.is_none() && self.part_length() <= self.received.len() {
            let part: Vec<_> = self.received.drain(..self.part_length()).collect();
            let awaited = mem::replace(&mut self.awaits, Awaits::Command);
            answers.extend(self.answer(awaited, &part).unwrap_or(vec![NACK]));
        }
        answers
    }

    /// Length of the part that comes next; too long while it is unknown.
    fn part_length(&self) -> usize {
        match (self.awaits, &self.received[..]) {
            (Awaits::Synchronisation, _) | (Awaits::Command, [SYNCHRONISATION, ..]) => 1,
            (Awaits::Command | Awaits::Length(_), _) => 2,
            (Awaits::Address(_), _) => 5,
            (Awaits::Block(_), [last, ..]) => 3 + usize::from(*last),
            // A special number means the whole chip, and only a check follows.
            (Awaits::Sectors, [0xff, 0xf0..=0xff, ..]) => 3,
            (Awaits::Sectors, [high, low, ..]) => 5 + 2 * usize::from(u16::from_be_bytes([*high, *low])),
            (Awaits::Block(_) | Awaits::Sectors | Awaits::Nothing, _) => usize::MAX,
        }
    }

    /// The answer to a part; `None` for NACK.
    fn answer(&mut self, awaited: Awaits, part: &[u8]) -> Option<Vec<u8>> {
        match awaited {
            Awaits::Synchronisation if part != [SYNCHRONISATION] => {
                self.awaits = Awaits::Synchronisation;
                Some(Vec::new())
            }
            Awaits::Synchronisation => Some(vec![ACK]),
            Awaits::Command => self.command(part),
            Awaits::Address(command) => self.address(command, part),
            Awaits::Length(offset) => {
                let end = offset + usize::from(part[0]) + 1;
                let bytes = self.flash.get(offset..end).filter(|_| part[1] == !part[0])?;
                Some([&[ACK], bytes].concat())
            }
            Awaits::Block(offset) => self.write(offset, part),
            Awaits::Sectors => self.erase(part),
            Awaits::Nothing => None,
        }
    }

    fn command(&mut self, part: &[u8]) -> Option<Vec<u8>> {
        let counted = |bytes: &[u8]| Some([&[ACK, bytes.len() as u8 - 1], bytes, &[ACK]].concat());
        match *part {
            [command, complement] if complement != !command => None,
            [0x00, _] => counted(&COMMANDS),
            [0x01, _] => Some(vec![ACK, COMMANDS[0], 0, 0, ACK]),
            [0x02, _] => counted(&PRODUCT),
            [command @ (0x11 | 0x21 | 0x31), _] => {
                self.awaits = Awaits::Address(command);
                Some(vec![ACK])
            }
            [0x44, _] => {
                self.awaits = Awaits::Sectors;
                Some(vec![ACK])
            }
            // Also a second synchronisation, which has no complement.
            _ => None,
        }
    }

    fn address(&mut self, command: u8, part: &[u8]) -> Option<Vec<u8>> {
        let address = u32::from_be_bytes([part[0], part[1], part[2], part[3]]);
        let offset = address.checked_sub(FLASH)? as usize;
        if offset >= SIZE || xor(part) != 0 {
            return None;
        }
        match command {
            0x11 => self.awaits = Awaits::Length(offset),
            0x31 => self.awaits = Awaits::Block(offset),
            _ => self.left_for = Some(address),
        }
        Some(vec![ACK])
    }

    fn write(&mut self, offset: usize, part: &[u8]) -> Option<Vec<u8>> {
        let [_, bytes @ .., _] = part else { return None };
        let cells = self.flash.get_mut(offset..offset + bytes.len()).filter(|_| xor(part) == 0)?;
        match self.defect {
            Defect::Protected => return None,
            Defect::Garbled => return Some(vec![0]),
            Defect::Hangs => {
                self.awaits = Awaits::Nothing;
                return Some(Vec::new());
            }
            Defect::None | Defect::StuckBit(_) => {}
        }
        for (cell, byte) in cells.iter_mut().zip(bytes) {
            // Programming clears bits only.
            *cell &= byte;
        }
        if let Defect::StuckBit(at) = self.defect {
            self.flash[at] &= 0xfe;
        }
        Some(vec![ACK])
    }

    fn erase(&mut self, part: &[u8]) -> Option<Vec<u8>> {
        let [_, _, numbers @ .., _] = part else { return None };
        if numbers.is_empty() || xor(part) != 0 {
            return None;
        }
        for number in numbers.chunks_exact(2) {
            let (start, size) = sector(u16::from_be_bytes([number[0], number[1]]))?;
            self.flash[start..start + size].fill(0xff);
        }
        Some(vec![ACK])
    }
}

/// Exchanges bytes with a program until `answer` returns `None` or the program has ended. Calls `answer` every millisecond, also
/// without bytes.
///
/// # Panics
/// The line fails.
pub fn serve(line: &mut File, program: &mut Running, mut answer: impl FnMut(&[u8]) -> Option<Vec<u8>>) {
    let interval = Timespec { tv_sec: 0, tv_nsec: 1_000_000 };
    let mut bytes = [0; 512];
    while !program.has_ended() {
        let arrived = poll(&mut [PollFd::new(&*line, PollFlags::IN)], Some(&interval)).expect("a line");
        let count = if arrived > 0 { line.read(&mut bytes).expect("a line") } else { 0 };
        let Some(answer) = answer(&bytes[..count]) else { return };
        line.write_all(&answer).expect("a line");
    }
}

fn xor(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum ^ byte)
}

/// Offset and size of a sector: four of 16 KiB, one of 64 KiB, seven of 128 KiB.
fn sector(number: u16) -> Option<(usize, usize)> {
    let number = usize::from(number);
    match number {
        0..=3 => Some((number << 14, 1 << 14)),
        4 => Some((1 << 16, 1 << 16)),
        5..=11 => Some(((number - 4) << 17, 1 << 17)),
        _ => None,
    }
}
