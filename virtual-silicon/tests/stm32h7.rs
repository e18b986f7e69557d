//! The models of an STM32H743 with a program of a few stores: pins in both directions, link, watchdog, oscillators.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::mpsc;
use std::time::Duration;

use lashloop_silicon::boards;
use lashloop_silicon::machine::{self, Ended};
use lashloop_silicon::pins::Pins;
use lashloop_silicon::quadrature::Quadrature;
use lashloop_silicon::surroundings::{End, Surroundings};
use lashloop_silicon::thumb::{Code, NOTHING};
use lashloop_silicon::wiring::Encoder;
use rigless::image::Image;

const MS: Duration = Duration::from_millis(1);
/// BKE and BKP of TIM1_BDTR, and MOE.
const BREAK: u32 = 0x3000;
const MAIN_OUTPUT: u32 = 0x8000;
const FLASH: u32 = 0x0800_0000;
const RAM: u32 = 0x2000_0000;

const RCC: u32 = 0x5802_4400;
const PORT_C: u32 = 0x5802_0800;
const PORT_D: u32 = 0x5802_0c00;
const PORT_E: u32 = 0x5802_1000;
const TIM3: u32 = 0x4000_0400;
const TIM4: u32 = 0x4000_0800;
const USART3: u32 = 0x4000_4800;
const TIM1: u32 = 0x4001_0000;
const TIM16: u32 = 0x4001_4400;
const USB_ID: u32 = 0x4008_003c;
const WATCHDOG: u32 = 0x5800_4800;

/// The registers that the program sets, in this order (RM0433).
const SETTINGS: [(u32, u32); 42] = [
    // Clocks of USB, ports C to E, TIM3, TIM4 and USART3, TIM1 and TIM16.
    (RCC + 0xd8, 1 << 27),
    (RCC + 0xe0, 0b11100),
    (RCC + 0xe8, 1 << 18 | 0b110),
    (RCC + 0xf0, 1 << 17 | 1),
    // HSE, and HSI stays on.
    (RCC, 1 << 16 | 1),
    // MODER, PUPDR, AFRL and AFRH of the board's pins.
    (PORT_C, 0b10_10_10 << 12),
    (PORT_C + 0x0c, 0b01_01_01 << 12),
    (PORT_C + 0x20, 0x22 << 24),
    (PORT_C + 0x24, 2),
    (PORT_D, 0b10_10_10 << 24 | 0b10_10 << 16),
    (PORT_D + 0x0c, 0b01_01_01 << 24 | 0b01 << 18),
    (PORT_D + 0x24, 0x222 << 16 | 0x77),
    (PORT_E, 0b10 << 30 | 0b10_10_10_10 << 16 | 0b01 << 14),
    (PORT_E + 0x0c, 0b01 << 30 | 0b10_10_10_10 << 16 | 0b01_01_01_01 << 6),
    (PORT_E + 0x24, 1 << 28 | 0x1111),
    (PORT_E + 0x18, 1 << 7),
    // Encoders: CCMR1, SMCR, ARR, CR1.
    (TIM3 + 0x18, 0x0101),
    (TIM3 + 0x08, 3),
    (TIM3 + 0x2c, 0xffff),
    (TIM3, 1),
    (TIM4 + 0x18, 0x0101),
    (TIM4 + 0x08, 3),
    (TIM4 + 0x2c, 0xffff),
    (TIM4, 1),
    // Bridge: ARR, CCR1, CCR2, CCMR1 with PWM mode 1, CCER, BDTR with a break that is active high, CR1, EGR.
    (TIM1 + 0x2c, 639),
    (TIM1 + 0x34, 192),
    (TIM1 + 0x38, 384),
    (TIM1 + 0x18, 0x6868),
    (TIM1 + 0x20, 0x0055),
    (TIM1 + 0x44, BREAK),
    (TIM1, 1),
    (TIM1 + 0x14, 1),
    // Low-speed oscillator: CSR, TISEL, CCMR1, CCER, CR1 of TIM16.
    (RCC + 0x74, 1),
    (TIM16 + 0x68, 1),
    (TIM16 + 0x18, 1),
    (TIM16 + 0x20, 1),
    (TIM16, 1),
    // Link: BRR for 1 MHz of 64 MHz, CR1.
    (USART3 + 0x0c, 64),
    (USART3, 0b1101),
    // Watchdog: start, access, RLR for 5 ms of 32 kHz by 4.
    (WATCHDOG, 0xcccc),
    (WATCHDOG, 0x5555),
    (WATCHDOG + 0x08, 39),
];
/// Registers that the program copies to memory, in this order: counts of both encoders, a capture, the id of the USB core.
const COPIED: [u32; 4] = [TIM3 + 0x24, TIM4 + 0x24, TIM16 + 0x34, USB_ID];
/// A byte to the program at which it stops, and the watchdog with it.
const STOP: u8 = 0;
/// Address of the loop, behind vector table and settings.
const LOOP: u32 = FLASH + 0x1000;

/// A program that sets registers. Then it reloads the watchdog, copies registers to memory, sends every byte back, and turns the main
/// output on.
fn program() -> Image {
    let exceptions = [FLASH + 4 * 16; 1].into_iter().chain([LOOP; 14]);
    let table = exceptions.fold(Code::default().word(0x2002_0000), |code, handler| code.word(handler | 1));
    // str r0, [r1]
    let store = |code: Code, register, value| code.load(0, value).load(1, register).halfword(0x6008);
    let mut code = SETTINGS.iter().fold(table, |code, (register, value)| store(code, *register, *value));
    // HSERDY, and then HSECSSON: ldr r0, [r1]; lsls r0, r0, #14; bpl; ldr r0, [r1]; orrs r0, r2; str r0, [r1]
    code = code.load(1, RCC).load(2, 1 << 19).halfwords(&[0x6808, 0x0380, 0xd5fc, 0x6808, 0x4310, 0x6008]);
    while 4 * code.words().len() as u32 <= LOOP - FLASH {
        code = code.halfword(NOTHING);
    }
    code = store(code, WATCHDOG, 0xaaaa);
    for (place, register) in (0..).zip(COPIED) {
        // ldr r0, [r1]; str r0, [r2]
        code = code.load(1, register).load(2, RAM + 4 * place).halfwords(&[0x6808, 0x6010]);
    }
    // RXNE of ISR: ldr r0, [r1, #0x1c]; lsls r0, r0, #26; bpl over the next nine instructions
    code = code.load(1, USART3).halfwords(&[0x69c8, 0x0680, 0xd50c]);
    // RDR and TDR: ldr r0, [r1, #0x24]; cmp r0, #0; beq .; str r0, [r1, #0x28]
    code = store(code.halfwords(&[0x6a48, 0x2800, 0xd0fe, 0x6288]), TIM1 + 0x44, BREAK | MAIN_OUTPUT);
    let bytes = code.jump(LOOP.into()).words().into_iter().flat_map(u32::to_le_bytes).collect();
    Image::new(Path::new("program"), bytes, Some(FLASH.into())).expect("an image")
}

/// Acts of a test, each with the time until the next one.
struct Script(Vec<(Duration, Act)>);

type Act = Box<dyn FnOnce(&mut Pins<'_>) + Send>;

fn act(wait: Duration, act: impl FnOnce(&mut Pins<'_>) + Send + 'static) -> (Duration, Act) {
    (wait, Box::new(act))
}

impl Surroundings for Script {
    fn turn(&mut self, chip: &mut Pins<'_>) -> ControlFlow<End, Duration> {
        if self.0.is_empty() {
            return ControlFlow::Break(End::Done);
        }
        let (wait, act) = self.0.remove(0);
        act(chip);
        ControlFlow::Continue(chip.now() + wait)
    }
}

/// Runs the program on a board that is ready, turns the main output on, and then acts.
fn run(acts: impl IntoIterator<Item = (Duration, Act)>) -> Ended<Script> {
    let ready = act(5 * MS, |chip| chip.drive_break(Some(false)));
    let on = act(MS, |chip| chip.serial_line().send(b"on"));
    let wiring = boards::open("nucleo-h743zi").expect("the board");
    let script = Script([ready, on].into_iter().chain(acts).collect());
    let ended = machine::run(program(), wiring, script).expect("a run");
    assert_eq!((ended.violations.to_string(), ended.end), (String::new(), Some(End::Done)));
    ended
}

fn copied(chip: &mut Pins<'_>, register: u32) -> u32 {
    let place = COPIED.iter().position(|it| *it == register).expect("a copied register") as u64;
    chip.word(u64::from(RAM) + 4 * place).expect("memory")
}

#[test]
fn every_pin_is_connected_and_bytes_come_back() {
    let ended = run([act(MS, |chip| {
        assert_eq!(chip.misconfigured(), [""; 0]);
        assert_eq!(chip.serial_line().take(), b"on");
        // 10 bits of 1 MHz, and instructions until the program sends a byte back.
        let byte = chip.serial_line().shortest_byte().expect("two bytes");
        assert!((Duration::from_micros(10)..Duration::from_nanos(10_050)).contains(&byte), "{byte:?}");
        assert_eq!(copied(chip, USB_ID), 0x1200, "a core that the driver doesn't know");
        let bridge = chip.bridge();
        assert!(bridge.is_on() && bridge.has_main_output);
        assert_eq!((bridge.duty, bridge.channels), (Some(0.3), [Some(0.3), Some(0.6)]));
        assert_eq!(chip.half_bridges(), [[Some(0.3), Some(0.7)], [Some(0.6), Some(0.4)]]);
    })]);
    assert_eq!(ended.resets, 0);
}

#[test]
fn encoders_count_in_both_directions() {
    let turn = |encoder, from: i64, to| {
        let mut it = Quadrature::at(from);
        std::iter::from_fn(move || it.step_towards(to))
            .map(move |edge| act(MS / 1_000, move |chip| chip.drive_encoder(encoder, edge)))
    };
    let counts = |chip: &mut Pins<'_>| [TIM3, TIM4].map(|timer| copied(chip, timer + 0x24) as u16);
    let show = act(MS, |chip| {
        chip.set_encoder(Encoder::Motor, Quadrature::default());
        chip.set_encoder(Encoder::Load, Quadrature::default());
    });
    // Pull-ups and the first levels have made counts.
    let (sender, start) = mpsc::channel();
    let before = act(MS, move |chip| sender.send(counts(chip)).expect("the receiver below"));
    let after = act(MS, move |chip| {
        let start = start.recv().expect("the counts before");
        let turned = std::array::from_fn(|encoder| counts(chip)[encoder].wrapping_sub(start[encoder]) as i16);
        assert_eq!(turned, [70, -50]);
    });
    let turns = turn(Encoder::Motor, 0, 100).chain(turn(Encoder::Load, 0, -50));
    let turns = turns.chain(turn(Encoder::Motor, 100, 70));
    run([show, before].into_iter().chain(turns).chain([act(MS, |_| {}), after]));
}

#[test]
fn the_break_input_and_a_crystal_that_stops_turn_the_output_off_without_software() {
    let causes: [fn(&mut Pins<'_>); 3] =
        [|chip| chip.drive_break(Some(true)), |chip| chip.drive_break(None), |chip| chip.stop_crystal()];
    for cause in causes {
        run([
            act(MS, move |chip| {
                assert!(chip.bridge().is_on() && !chip.clocks_are_internal());
                cause(chip);
            }),
            act(MS, |chip| assert!(!chip.bridge().has_main_output && !chip.bridge().is_on())),
        ]);
    }
}

#[test]
fn a_crystal_that_stops_leaves_the_clock_to_the_oscillator_inside() {
    run([act(MS, |chip| chip.stop_crystal()), act(MS, |chip| assert!(chip.clocks_are_internal()))]);
}

#[test]
fn a_program_that_stops_is_reset_by_the_watchdog() {
    let off = |chip: &mut Pins<'_>| {
        assert_eq!(chip.resets(), 1);
        assert!(
            !chip.bridge().has_main_output && chip.misconfigured().is_empty(),
            "the start after the reset"
        );
    };
    let ended = run([
        act(4 * MS, |chip| chip.serial_line().send(&[STOP])),
        act(3 * MS, |chip| assert_eq!(chip.resets(), 0, "before its 5 ms")),
        act(20 * MS, off),
        act(MS, |chip| assert_eq!(chip.resets(), 1, "the program reloads it again")),
    ]);
    assert_eq!(ended.resets, 1);
}

#[test]
fn the_low_speed_oscillator_is_captured() {
    run([act(MS, |chip| {
        let at = copied(chip, TIM16 + 0x34);
        assert!(at > 0, "{at}");
    })]);
}
