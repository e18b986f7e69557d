//! The boot loader in the ROM of an STM32F405 on a pseudo-terminal (ST AN3155, AN2606), with the flash behind it.
//!
//! It is made from the documents, not from a chip. `Go` starts a drive on the same terminal, as firmware in the flash would
//! be started: the native twin, for any contents of the flash.

use std::fs::File;
use std::io::{self, Read, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use lashloop_bench::device::twin::Twin;
use lashloop_firmware::drive::{Clock, Drive};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::terminal;

const ACK: u8 = 0x79;
const NACK: u8 = 0x1f;
const SYNCHRONISATION: u8 = 0x7f;
/// Start and size of the flash.
const FLASH: u32 = 0x0800_0000;
const SIZE: usize = 1 << 20;
/// Product number of the STM32F405.
const PRODUCT: [u8; 2] = [0x04, 0x13];
/// Version 3.1 and the commands of the loader: Get, Get Version, Get ID, Read Memory, Go, Write Memory, Extended Erase, Write
/// Protect, Write Unprotect, Readout Protect, Readout Unprotect.
const COMMANDS: [u8; 12] = [0x31, 0x00, 0x01, 0x02, 0x11, 0x21, 0x31, 0x44, 0x63, 0x73, 0x82, 0x92];

/// What is wrong with a chip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Defect {
    /// Nothing.
    None,
    /// Writing is not acknowledged: the flash is protected.
    Protected,
    /// A bit of this byte of the flash stays 0.
    StuckBit(usize),
    /// The loader stops answering at the first write.
    Hangs,
    /// The firmware doesn't answer.
    Silent,
}

/// A chip in its boot loader. It serves until the process ends.
pub struct RomLoader {
    /// The terminal as `--device` takes it.
    pub device: String,
    flash: Arc<Mutex<Vec<u8>>>,
    hangs: Arc<AtomicBool>,
}

impl RomLoader {
    /// Starts the loader of a chip with an erased flash.
    ///
    /// # Panics
    /// The system has no pseudo-terminal left.
    #[must_use]
    pub fn start(defect: Defect) -> Self {
        Self::serving(defect, |_| Ok(()))
    }

    /// Starts a drive on this chip that enters the loader at the first request for it.
    ///
    /// # Panics
    /// The system has no pseudo-terminal left.
    #[must_use]
    pub fn behind_a_drive() -> Self {
        Self::serving(Defect::None, drive_until_left)
    }

    fn serving(defect: Defect, firmware: fn(&mut File) -> io::Result<()>) -> Self {
        let terminal = terminal::open();
        let device = terminal::device(&terminal);
        let flash = Arc::new(Mutex::new(vec![0xff; SIZE]));
        let line = File::from(terminal.far_end.try_clone().expect("a handle"));
        let hangs = Arc::new(AtomicBool::new(false));
        let chip = Chip { line, flash: Arc::clone(&flash), hangs: Arc::clone(&hangs), defect };
        thread::spawn(move || {
            let has_left = chip.line.try_clone().and_then(|mut line| firmware(&mut line));
            // Until `Go`; an error is the end of the test.
            if has_left.is_ok() && chip.serve().is_ok() && defect != Defect::Silent {
                let _ = Twin::from(terminal).serve();
            } else {
                thread::park();
            }
        });
        Self { device, flash, hangs }
    }

    /// Whether a loader with [`Defect::Hangs`] has stopped answering.
    #[must_use]
    pub fn hangs(&self) -> bool {
        self.hangs.load(Ordering::Relaxed)
    }

    /// The first bytes of the flash.
    ///
    /// # Panics
    /// The flash is smaller.
    #[must_use]
    pub fn flash(&self, count: usize) -> Vec<u8> {
        self.flash.lock().unwrap_or_else(PoisonError::into_inner)[..count].to_vec()
    }
}

/// Serves a drive with a boot loader until it enters it.
fn drive_until_left(line: &mut File) -> io::Result<()> {
    struct SinceStart(Instant);
    impl Clock for SinceStart {
        fn now(&self) -> Duration {
            self.0.elapsed()
        }
    }
    let (mut drive, clock) = (Drive::new("native-twin").with_loader(), SinceStart(Instant::now()));
    let mut bytes = [0; 256];
    while !drive.enters_loader(clock.now()) {
        let timeout = Timespec { tv_sec: 0, tv_nsec: 1_000_000 };
        if poll(&mut [PollFd::new(&*line, PollFlags::IN)], Some(&timeout))? == 0 {
            continue;
        }
        let count = line.read(&mut bytes)?;
        let mut rest = &bytes[..count];
        while !rest.is_empty() {
            rest = &rest[drive.receive(rest, &clock)..];
            line.write_all(drive.output())?;
            drive.clear_output();
        }
    }
    Ok(())
}

struct Chip {
    line: File,
    flash: Arc<Mutex<Vec<u8>>>,
    hangs: Arc<AtomicBool>,
    defect: Defect,
}

/// Why a request ends early.
enum Refusal {
    /// It is answered by NACK.
    Nack,
    Line(io::Error),
}

impl From<io::Error> for Refusal {
    fn from(error: io::Error) -> Self {
        Self::Line(error)
    }
}

impl Chip {
    /// Serves requests until `Go`.
    fn serve(&self) -> io::Result<()> {
        while self.take::<1>()? != [SYNCHRONISATION] {}
        self.send(&[ACK])?;
        loop {
            match self.request() {
                Ok(true) => return Ok(()),
                Ok(false) => {}
                Err(Refusal::Nack) => self.send(&[NACK])?,
                Err(Refusal::Line(error)) => return Err(error),
            }
        }
    }

    /// Serves one request; true for `Go`.
    fn request(&self) -> Result<bool, Refusal> {
        let [command] = self.take()?;
        // Also a second synchronisation, which has no complement.
        if command == SYNCHRONISATION {
            return Err(Refusal::Nack);
        }
        let [complement] = self.take()?;
        if complement != !command || !COMMANDS[1..].contains(&command) {
            return Err(Refusal::Nack);
        }
        self.send(&[ACK])?;
        match command {
            0x00 => self.reply(&COMMANDS)?,
            0x01 => self.send(&[COMMANDS[0], 0, 0, ACK])?,
            0x02 => self.reply(&PRODUCT)?,
            0x11 => self.read()?,
            0x21 => {
                let _start = self.address()?;
                return Ok(true);
            }
            0x31 => self.write()?,
            0x44 => self.erase()?,
            // Protection is changed at once, and the chip restarts.
            _ => self.send(&[ACK])?,
        }
        Ok(false)
    }

    fn read(&self) -> Result<(), Refusal> {
        let offset = self.address()?;
        let [last, check] = self.take()?;
        let end = offset + usize::from(last) + 1;
        if check != !last || end > SIZE {
            return Err(Refusal::Nack);
        }
        let bytes = self.flash()[offset..end].to_vec();
        self.send(&[&[ACK], &bytes[..]].concat())?;
        Ok(())
    }

    fn write(&self) -> Result<(), Refusal> {
        let offset = self.address()?;
        let [last] = self.take()?;
        let mut bytes = vec![0; usize::from(last) + 1];
        (&self.line).read_exact(&mut bytes)?;
        let [check] = self.take()?;
        match self.defect {
            Defect::Protected => return Err(Refusal::Nack),
            Defect::Hangs => {
                self.hangs.store(true, Ordering::Relaxed);
                loop {
                    thread::park();
                }
            }
            Defect::None | Defect::StuckBit(_) | Defect::Silent => {}
        }
        if xor(&bytes) ^ last != check || offset + bytes.len() > SIZE {
            return Err(Refusal::Nack);
        }
        let mut flash = self.flash();
        for (cell, byte) in flash[offset..].iter_mut().zip(bytes) {
            // Programming clears bits only.
            *cell &= byte;
        }
        if let Defect::StuckBit(at) = self.defect {
            flash[at] &= 0xfe;
        }
        drop(flash);
        self.send(&[ACK])?;
        Ok(())
    }

    fn erase(&self) -> Result<(), Refusal> {
        let head: [u8; 2] = self.take()?;
        let count = u16::from_be_bytes(head);
        if count >= 0xfff0 {
            self.take::<1>()?;
            self.flash().fill(0xff);
        } else {
            let mut sectors = vec![0; 2 * (usize::from(count) + 1)];
            (&self.line).read_exact(&mut sectors)?;
            let [check] = self.take()?;
            if xor(&head) ^ xor(&sectors) != check {
                return Err(Refusal::Nack);
            }
            for number in sectors.chunks_exact(2) {
                let (start, size) =
                    sector(u16::from_be_bytes([number[0], number[1]])).ok_or(Refusal::Nack)?;
                self.flash()[start..start + size].fill(0xff);
            }
        }
        self.send(&[ACK])?;
        Ok(())
    }

    /// Receives an address with its check, acknowledges it and returns the offset in the flash.
    fn address(&self) -> Result<usize, Refusal> {
        let bytes: [u8; 5] = self.take()?;
        let address = u32::from_be_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let offset = address.checked_sub(FLASH).map(|offset| offset as usize);
        match offset.filter(|offset| *offset < SIZE && xor(&bytes) == 0) {
            Some(offset) => {
                self.send(&[ACK])?;
                Ok(offset)
            }
            None => Err(Refusal::Nack),
        }
    }

    /// Sends a counted reply.
    fn reply(&self, bytes: &[u8]) -> io::Result<()> {
        self.send(&[&[bytes.len() as u8 - 1], bytes, &[ACK]].concat())
    }

    fn take<const N: usize>(&self) -> io::Result<[u8; N]> {
        let mut bytes = [0; N];
        (&self.line).read_exact(&mut bytes)?;
        Ok(bytes)
    }

    fn send(&self, bytes: &[u8]) -> io::Result<()> {
        (&self.line).write_all(bytes)
    }

    fn flash(&self) -> MutexGuard<'_, Vec<u8>> {
        self.flash.lock().unwrap_or_else(PoisonError::into_inner)
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
