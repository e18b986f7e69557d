//! The image after a jump from the boot loader in the ROM: it answers, at the stated speed.
//!
//! A stand-in for the ROM lies at its address: a vector table whose exceptions all enter one handler, and a start that leaves the
//! chip as a loader may leave it, loads stack pointer and program counter from the flash, and jumps, once. There are two ways into
//! it, as `rigless` models the vector table register, but not what address 0 shows after a write to SYSCFG:
//!
//! - [`Entry::Pins`]: address 0 shows the ROM, as with BOOT0 high. So the chip starts for `flash --via dfu` and `--via uart`.
//! - [`Entry::Request`]: the image follows its own request into the ROM, as after `EnterLoader`, once, and has left interrupts and
//!   the vector table register as a loader expects them. The stand-in then sets that register to its own, where the chip has the
//!   ROM at address 0.
//!
//! What ST's ROM leaves behind has to be seen on a board.

use std::path::Path;

use lashloop_protocol::message::Hello;
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message, Numbered};
use lashloop_silicon::boards;
use lashloop_silicon::chip::{CRYSTAL_HZ, Chip};
use lashloop_silicon::lsi_capture::LsiCapture;
use lashloop_silicon::symbols::Symbols;
use lashloop_silicon::thumb::{Code, FOREVER, MASK_INTERRUPTS, NOTHING, RETURN};
use lashloop_silicon::wiring::Family;
use rigless::emulator::{self, AccessKind, Driver, Host, Settled, Start, Stop};
use rigless::image::Image;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

const MS: u64 = 1_000_000;
/// The image waits 0.1 s for a crystal that isn't there.
const HELLO_AT: u64 = 180 * MS;
const END: u64 = HELLO_AT + 10 * MS;
/// 10 bits of 42 MHz by 46.
const BYTE_NS: f64 = 10_952.4;
const RAM: u32 = 0x2000_0000;
const SYSTICK: u32 = 0xe000_e010;
const NVIC_ENABLE: u32 = 0xe000_e100;
const NVIC_PEND: u32 = 0xe000_e200;
const VECTOR_TABLE: u32 = 0xe000_ed08;
const JUMPED: u32 = 0x600d_f00d;
/// The request of firmware/src/board/loader.rs.
const REQUEST: u64 = 0x5245_4f4c;

/// What a family has for a loader.
struct Rom {
    /// The vector table of the loader.
    at: u32,
    /// Where the loader expects it.
    shown_at: u32,
    /// A word of memory that the image doesn't use, which the stand-in sets before it jumps.
    note: u32,
    /// RCC_CR, whose bits for HSE and PLL are those of every family.
    clock_control: u32,
    /// Offsets and values that make 24 MHz of the oscillator inside the chip, and of the crystal.
    pll: [&'static [(u16, u32)]; 2],
    /// Offset of RCC_CFGR, and its SW for the PLL.
    selection: (u16, u32),
}

const STM32F4: Rom = Rom {
    at: 0x1fff_0000,
    shown_at: 0,
    // Above 128 KiB.
    note: 0x2002_8000,
    clock_control: 0x4002_3800,
    // 1 MHz by 192; by 8 for the core, by 4 for USB.
    pll: [
        &[(0x04, 4 << 24 | 3 << 16 | 192 << 6 | 16)],
        &[(0x04, 4 << 24 | 1 << 22 | 3 << 16 | 192 << 6 | 8)],
    ],
    selection: (0x08, 2),
};
const STM32H7: Rom = Rom {
    at: 0x1ff0_9800,
    shown_at: 0x1ff0_9800,
    // In another memory.
    note: 0x2400_0000,
    clock_control: 0x5802_4400,
    // 2 MHz by 96; by 8 at every output.
    pll: [&[(0x28, 32 << 4), BY_96[0], BY_96[1]], &[(0x28, 4 << 4 | 2), BY_96[0], BY_96[1]]],
    selection: (0x10, 3),
};
const BY_96: [(u16, u32); 2] = [(0x2c, 0x01ff_0004), (0x30, 7 << 24 | 7 << 16 | 7 << 9 | 95)];

fn rom_of(family: Family) -> &'static Rom {
    match family {
        Family::Stm32f4 => &STM32F4,
        Family::Stm32h7 => &STM32H7,
    }
}

/// How the chip came to the image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Entry {
    Reset,
    Pins,
    Request,
}

/// The system clock at the jump: that of a reset, or 24 MHz of the PLL.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Clock {
    Off,
    PllOfHsi,
    PllOfHse,
}

/// What the loader leaves for interrupts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Interrupts {
    None,
    /// SysTick runs, with its interrupt, so fast that it comes many times while memory is initialised.
    SysTick,
    /// An interrupt of a peripheral that the image doesn't use is enabled and pending, behind the processor's mask.
    Peripheral,
}

/// A start of the image.
#[derive(Debug, Clone, Copy)]
struct Case {
    entry: Entry,
    clock: Clock,
    interrupts: Interrupts,
    /// What ends the ROM's handler.
    handler: u16,
    has_crystal: bool,
}

const AFTER_RESET: Case = Case {
    entry: Entry::Reset,
    clock: Clock::Off,
    interrupts: Interrupts::None,
    handler: FOREVER,
    has_crystal: true,
};

/// Every start after the ROM.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for entry in [Entry::Pins, Entry::Request] {
        let case = Case { entry, ..AFTER_RESET };
        cases.extend([Clock::Off, Clock::PllOfHsi, Clock::PllOfHse].map(|clock| Case { clock, ..case }));
        cases.push(Case { handler: RETURN, ..case });
        cases.push(Case { has_crystal: false, ..case });
        cases.push(Case { has_crystal: false, clock: Clock::PllOfHsi, ..case });
        cases.push(Case { interrupts: Interrupts::SysTick, handler: RETURN, ..case });
        cases.push(Case { interrupts: Interrupts::Peripheral, ..case });
    }
    cases
}

/// The stand-in for the ROM.
fn stand_in(rom: &Rom, case: Case, request_at: u32) -> Vec<u8> {
    const TABLE_WORDS: u32 = 128;
    let handler = Code::default().halfwords(&[case.handler, NOTHING]).words();
    let mut start = Code::default();
    if case.entry == Entry::Request {
        // As after a reset: mrs r0, primask; cmp r0, #0; beq over the next one; b .
        start = start.halfwords(&[0xf3ef, 0x8010, 0x2800, 0xd000, FOREVER]);
        let enabled = [0, 4, 8].map(|offset| (NVIC_ENABLE + offset, 0));
        for (register, value) in enabled.into_iter().chain([(VECTOR_TABLE, rom.shown_at), (request_at, 0)]) {
            // ldr r0, [r1]; cmp r0, r2; beq over the next one; b .
            start = start.load(1, register).load(2, value).halfwords(&[0x6808, 0x4290, 0xd000, FOREVER]);
        }
    }
    // ldr r0, [r1]; cmp r0, r2; bne over the next one; b .; str r2, [r1]
    start = start.load(1, rom.note).load(2, JUMPED).halfwords(&[0x6808, 0x4290, 0xd100, FOREVER, 0x600a]);
    // Its own variables, at the start of RAM: str r1, [r1]; adds r1, #4; cmp r1, r2; bne
    start = start.load(1, RAM).load(2, RAM + 12 * 1_024).halfwords(&[0x6009, 0x3104, 0x4291, 0xd1fb]);
    if case.clock != Clock::Off {
        start = start.load(1, rom.clock_control);
        let [internal, external] = rom.pll;
        let mut pll = internal;
        if case.clock == Clock::PllOfHse {
            // HSEON, and wait for HSERDY: ldr r0, [r1]; orrs r0, r2; str r0, [r1]; ldr r0, [r1]; lsls r0, r0, #14; bpl
            start = start.load(2, 1 << 16).halfwords(&[0x6808, 0x4310, 0x6008, 0x6808, 0x0380, 0xd5fc]);
            pll = external;
        }
        // str r0, [r1, #offset]; then PLLON and PLLRDY, SW and SWS as HSEON.
        for (offset, value) in pll {
            start = start.load(0, *value).halfword(0x6008 | offset << 4);
        }
        start = start.load(2, 1 << 24).halfwords(&[0x6808, 0x4310, 0x6008, 0x6808, 0x0180, 0xd5fc]);
        let (offset, pll) = rom.selection;
        let [load, store] = [0x6808, 0x6008].map(|opcode| opcode | offset << 4);
        start = start.load(2, pll).halfwords(&[load, 0x4310, store, load, 0x0700, 0xd5fc]);
    }
    if case.entry == Entry::Request {
        start = start.load(1, VECTOR_TABLE).load(0, rom.at).halfword(0x6008);
    }
    match case.interrupts {
        Interrupts::None => {}
        // 200 cycles: str r0, [r1, #4]; str r0, [r1, #8]; movs r0, #7; str r0, [r1]
        Interrupts::SysTick => {
            start = start.load(1, SYSTICK).load(0, 200).halfwords(&[0x6048, 0x6088, 0x2007, 0x6008]);
        }
        // Number 55, TIM7: str r0, [r1], twice
        Interrupts::Peripheral => {
            start = start.load(0, 1 << (55 - 32)).halfword(MASK_INTERRUPTS);
            start = start.load(1, NVIC_ENABLE + 4).halfword(0x6008).load(1, NVIC_PEND + 4).halfword(0x6008);
        }
    }
    // ldr r1, [r0]; msr msp, r1; ldr r1, [r0, #4]; bx r1
    let start = start.load(0, 0x0800_0000).halfwords(&[0x6801, 0xf381, 0x8808, 0x6841, 0x4708]).words();
    let handler_at = (rom.at + 4 * TABLE_WORDS) | 1;
    let start_at = handler_at + 4 * handler.len() as u32;
    let table = (0..TABLE_WORDS).map(|place| match place {
        0 => 0x2000_2000,
        1 => start_at,
        _ => handler_at,
    });
    table.chain(handler).chain(start).flat_map(u32::to_le_bytes).collect()
}

struct Run {
    lsi: LsiCapture,
    case: Case,
    note: u32,
    request_at: u64,
    has_requested: bool,
    has_greeted: bool,
    has_jumped: bool,
}

impl Driver<Chip> for Run {
    fn on_settled(&mut self, session: &mut Session<Chip>, _: &mut dyn Host, settled: Settled) {
        let Settled::Access { access, .. } = settled else { return };
        if !self.case.has_crystal && access.kind == AccessKind::Write {
            session.board_mut().hold_crystal(access.virtual_time, access.address);
        }
    }

    fn on_stop(
        &mut self,
        session: &mut Session<Chip>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        if !std::mem::replace(&mut self.has_requested, true) && self.case.entry == Entry::Request {
            host.write(self.request_at, Width::W32, REQUEST).expect("RAM");
        }
        let edge = self.lsi.turn(session.board_mut(), stop.at);
        let until = |at| Some(edge.map_or(VirtualNanos(at), |edge| edge.min(VirtualNanos(at))));
        if stop.at.0 < HELLO_AT {
            return until(HELLO_AT);
        }
        if !self.has_greeted {
            self.has_greeted = true;
            let line = session.board_mut().serial_line();
            line.send(&[0]);
            line.send(&HostMessage::from(Hello::new(7)).frame());
        }
        if stop.at.0 < END {
            return until(END);
        }
        let note = host.read(u64::from(self.note), Width::W32).expect("RAM");
        self.has_jumped = note == u64::from(JUMPED);
        None
    }
}

fn image(board: &str) -> Symbols {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target");
    let path = folder.join(boards::image_of(board)).with_extension("elf");
    Symbols::read(&path).unwrap_or_else(|error| panic!("{error}; `cargo xtask image` builds it"))
}

/// What is wrong with a start of an image on a board.
fn start(image: &Symbols, board: &str, case: Case) -> Result<(), String> {
    let wiring = boards::open(board).expect("a board");
    let rom = rom_of(wiring.chip);
    let mut chip = Chip::new(&wiring, CRYSTAL_HZ, true).expect("models");
    chip.starts_in_rom = case.entry == Entry::Pins;
    let session = Session::new(Box::new(chip), 0, VirtualNanos(10)).expect("a chip");
    let request_at = image.variable("WORD").expect("the word of the loader");
    let rom_image = stand_in(rom, case, request_at as u32);
    let images = [
        image.image().expect("an image"),
        Image::new(Path::new("rom"), rom_image, Some(rom.at.into())).expect("a ROM"),
    ];
    let run = Run {
        lsi: LsiCapture::after_reset(VirtualNanos(0)),
        case,
        note: rom.note,
        request_at,
        has_requested: false,
        has_greeted: false,
        has_jumped: false,
    };
    let ended = emulator::run(session, &Start::new(&images), run).expect("a run");
    assert_eq!(ended.driver.has_jumped, case.entry != Entry::Reset, "{case:?}: the way through the ROM");

    let mut session = ended.session;
    if !session.resets().is_empty() {
        return Err(format!("{:?}", session.resets()));
    }
    let line = session.board_mut().serial_line();
    let (bytes, byte) = (line.take(), line.shortest_byte());
    let (mut decoder, mut rest) = (Decoder::new(), &bytes[..]);
    let messages: Vec<_> = std::iter::from_fn(|| decoder.next::<DriveMessage>(&mut rest)).collect();
    let is_identity = |it: &Result<Numbered<DriveMessage>, _>| {
        it.as_ref().is_ok_and(|it| matches!(it.message, DriveMessage::Identity(_)))
    };
    let logs_its_clock = |it: &Result<Numbered<DriveMessage>, _>| {
        it.as_ref().is_ok_and(
            |it| matches!(&it.message, DriveMessage::Log(log) if log.text.as_str().contains("crystal")),
        )
    };
    if messages.iter().any(logs_its_clock) == case.has_crystal {
        return Err(format!("another clock than that of the crystal, or not said: {messages:?}"));
    }
    if !messages.iter().any(is_identity) {
        return Err(format!("no Identity in {messages:?}"));
    }
    let byte_ns = byte.map_or(0.0, |byte| byte.as_secs_f64() * 1e9);
    // The internal oscillator of the model is exact.
    if (byte_ns - BYTE_NS).abs() < 20.0 { Ok(()) } else { Err(format!("{byte_ns} ns for a byte")) }
}

#[test]
fn every_image_answers_at_the_stated_speed_after_every_start() {
    for (name, _) in boards::BUILT_IN {
        let image = image(name);
        for case in [AFTER_RESET].into_iter().chain(cases()) {
            start(&image, name, case).unwrap_or_else(|problem| panic!("{name}, {case:?}: {problem}"));
        }
    }
}

#[test]
fn a_start_fails_without_any_part_of_the_entry() {
    let without = |image: &Symbols, pieces: &[[u16; 2]]| {
        pieces.iter().try_fold(image.clone(), |image, [instruction, next]| {
            let piece = Code::default().halfwords(&[*instruction, *next]);
            image.with_piece("__pre_init", &piece, &Code::default().halfwords(&[NOTHING, *next]))
        })
    };
    let board = boards::DEFAULT;
    let image = image(board);
    let careless = [
        // Each of them replaces the other: cpsid i, movs r0; str r0, [r1], mvns r2, r0.
        ("mask and SysTick", without(&image, &[[MASK_INTERRUPTS, 0x2000], [0x6008, 0x43c2]])),
        ("NVIC", image.with_code("__pre_init", |_| enter_without_nvic())),
        // str r0, [r1, #4], dsb.
        ("vector table", without(&image, &[[0x6048, 0xf3bf]])),
        ("clocks", image.without("clock_tree::reset")),
    ];
    for (part, careless) in careless {
        let careless = careless.unwrap_or_else(|error| panic!("{part}: {error}"));
        start(&careless, board, AFTER_RESET).unwrap_or_else(|problem| panic!("without {part}: {problem}"));
        let failed = cases().into_iter().find(|case| start(&careless, board, *case).is_err());
        println!("without {part}: {failed:?}");
        assert!(failed.is_some(), "no start needs {part}");
    }
}

/// Interrupts masked, SysTick off, and the vector table set.
fn enter_without_nvic() -> Code {
    // cpsid i; movs r0, #0; str r0, [r1]; the table is at the start of the flash: str r0, [r1]; bx lr
    let code = Code::default().halfword(MASK_INTERRUPTS).load(1, SYSTICK).halfwords(&[0x2000, 0x6008]);
    code.load(1, VECTOR_TABLE).load(0, 0x0800_0000).halfwords(&[0x6008, RETURN])
}
