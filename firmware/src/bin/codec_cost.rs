//! Instructions on a Cortex-M4F to encode and decode the two messages of a control period.
//!
//! An image for the emulator, built like the drive's. With `-icount shift=6` QEMU executes one instruction in 64 ns and
//! counts SysTick at 168 MHz, so 10.752 counts are one instruction. The image prints lines on USART2: first a loop of a
//! known number of instructions, then for each message its bytes and the instructions to encode and to decode it.

#![no_std]
#![no_main]

use core::fmt::Write;
use core::hint::black_box;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::entry;
use lashloop_protocol::enums::{State, TorqueFlags, TorqueStatus};
use lashloop_protocol::message::{EncoderSample, TorqueAnswer};
use lashloop_protocol::{Decoder, DriveMessage, EncoderCounts, HostMessage, Message};
use stm32f4xx_hal::pac::Peripherals;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;
use stm32f4xx_hal::serial;

/// Calls between two readings of the time, so that the instructions of a reading weigh little.
const CALLS: u32 = 256;
/// SysTick's counter has 24 bits.
const LAST_COUNT: u32 = 0x00ff_ffff;

#[entry]
fn main() -> ! {
    let (Some(core), Some(device)) = (cortex_m::Peripherals::take(), Peripherals::take()) else {
        unreachable!("the peripherals are taken once, here");
    };
    start(core.SYST);
    let mut rcc = device.RCC.freeze(Config::hsi());
    let pin = device.GPIOA.split(&mut rcc).pa2;
    let mut out = device
        .USART2
        .tx(pin, serial::Config::default(), &mut rcc)
        .expect("9600 bit/s are in the range of the divider");

    let sample = |sequence, counts: [i64; 2], reference| {
        let [motor_counts, load_counts] = counts.map(EncoderCounts::wrapping);
        let reference_rad = f32::from_bits(reference);
        HostMessage::from(EncoderSample { sequence, motor_counts, load_counts, reference_rad })
    };
    let torque = |sequence, torque_nm: f32, flags, compute_tenths_us| {
        let status = TorqueStatus { state: State::Running, flags };
        DriveMessage::from(TorqueAnswer { sequence, torque_nm, status, compute_tenths_us })
    };
    // The loop has one round more than its argument, of two instructions each, and a few to align it.
    let known = instructions(|| cortex_m::asm::delay(1000));
    let _ = writeln!(out, "loop-of-2002 {known}");
    // The second cycle of the conversation in the protocol's document; then the bytes that are the extremes of
    // stuffing.
    report(&mut out, "sample", &sample(1, [98_104, 32_766], 0));
    report(&mut out, "sample-zeros", &sample(0, [0; 2], 0));
    report(&mut out, "sample-no-zeros", &sample(u16::MAX, [-1; 2], u32::MAX));
    report(&mut out, "torque", &torque(1, -20.195_326, TorqueFlags::empty(), 57));
    report(&mut out, "torque-zeros", &torque(0, 0.0, TorqueFlags::empty(), 0));
    report(&mut out, "torque-no-zeros", &torque(u16::MAX, 1.1, TorqueFlags::all(), u16::MAX));
    let _ = writeln!(out, "end");
    loop {
        cortex_m::asm::wfi();
    }
}

fn start(mut syst: SYST) {
    syst.set_clock_source(SystClkSource::Core);
    syst.set_reload(LAST_COUNT);
    syst.clear_current();
    syst.enable_counter();
}

/// Prints the instructions to encode and to decode a message.
fn report<M: Message>(out: &mut impl Write, name: &str, message: &M) {
    let frame = message.frame();
    let mut decoder = Decoder::new();
    let encode = instructions(|| {
        black_box(black_box(message).frame());
    });
    let decode = instructions(|| {
        let mut input = black_box(&frame[..]);
        black_box(decoder.next::<M>(&mut input));
    });
    let all_read = decoder.counters().messages == CALLS;
    assert!(all_read, "the decoder rejected a frame");
    let _ = writeln!(out, "{name} {} {encode} {decode}", frame.len());
}

/// Instructions of a call, without the loop around it.
fn instructions(task: impl FnMut()) -> u32 {
    let empty = counts(|| {
        black_box(());
    });
    // 10.752 is 1344 / 125; the product stays below 2^31.
    let (counts, one) = ((counts(task) - empty) * 125, CALLS * 1344);
    (counts + one / 2) / one
}

fn counts(mut task: impl FnMut()) -> u32 {
    let before = SYST::get_current();
    for _ in 0..CALLS {
        task();
    }
    before.wrapping_sub(SYST::get_current()) & LAST_COUNT
}

/// An illegal instruction ends the emulator with an error message.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    cortex_m::asm::udf()
}
