//! The specimen of the tests of virtual silicon: a drive that uses every pin the models have.
//!
//! Encoders are on TIM3 and TIM4, the bridge is on TIM1 with enable and break, the tick is TIM2. A position loop holds the motor
//! at [`REFERENCE`]. [`REQUEST`] makes it fail in one of several ways; each has to turn the bridge off.

#![no_std]
#![no_main]

use core::panic::PanicInfo;
use core::sync::atomic::{AtomicI32, AtomicU32, Ordering};

use cortex_m::interrupt::Mutex;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::{ExceptionFrame, entry, exception};
use stm32f4xx_hal::gpio::GpioExt;
use stm32f4xx_hal::pac::{self, GPIOB, Interrupt, TIM1, TIM2, TIM3, TIM4, interrupt};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::qei::Qei;
use stm32f4xx_hal::rcc::{Config, Enable};

/// Commanded motor position, counts. A test writes it.
#[unsafe(no_mangle)]
static REFERENCE: AtomicI32 = AtomicI32::new(0);
/// Motor position, counts, through every wrap of its timer.
#[unsafe(no_mangle)]
static MOTOR: AtomicI32 = AtomicI32::new(0);
/// Load position, counts, through every wrap of its timer.
#[unsafe(no_mangle)]
static LOAD: AtomicI32 = AtomicI32::new(0);
/// Ticks since reset.
#[unsafe(no_mangle)]
static TICKS: AtomicU32 = AtomicU32::new(0);
/// What to do at the next tick; see [`obey`]. A test writes it.
#[unsafe(no_mangle)]
static REQUEST: AtomicU32 = AtomicU32::new(0);

/// Counts of a PWM period: 168 MHz by 8400 is 20 kHz.
const PWM_PERIOD: u32 = 8_400;
/// Most that the duty may differ from its centre, counts.
const DUTY_LIMIT: i32 = 4_000;

/// What the tick owns.
struct Loop {
    motor: Qei<TIM3>,
    load: Qei<TIM4>,
    timer: TIM2,
    last: (u16, u16),
}

static LOOP: Mutex<core::cell::RefCell<Option<Loop>>> = Mutex::new(core::cell::RefCell::new(None));

#[entry]
fn main() -> ! {
    let device = pac::Peripherals::take().expect("the first call");
    let mut rcc = device.RCC.freeze(Config::hse(8.MHz()).sysclk(168.MHz()));
    let gpioa = device.GPIOA.split(&mut rcc);
    let gpiob = device.GPIOB.split(&mut rcc);
    let gpioc = device.GPIOC.split(&mut rcc);
    let motor = Qei::new(device.TIM3, (gpioc.pc6, gpioc.pc7), &mut rcc);
    let load = Qei::new(device.TIM4, (gpiob.pb6, gpiob.pb7), &mut rcc);
    let _pwm = gpioa.pa8.into_alternate::<1>();
    let _break = gpiob.pb12.into_alternate::<1>();
    let mut enable = gpiob.pb0.into_push_pull_output();
    TIM1::enable(&mut rcc);
    start_pwm(&device.TIM1);
    enable.set_high();
    TIM2::enable(&mut rcc);
    // 84 MHz by 84,000: a tick of 1 ms.
    device.TIM2.arr().write(|w| w.arr().set(83_999));
    device.TIM2.egr().write(|w| w.ug().update());
    device.TIM2.sr().write(|w| w.uif().clear());
    device.TIM2.dier().write(|w| w.uie().enabled());
    device.TIM2.cr1().write(|w| w.cen().enabled());
    cortex_m::interrupt::free(|token| {
        LOOP.borrow(token).replace(Some(Loop { motor, load, timer: device.TIM2, last: (0, 0) }));
    });
    // SAFETY: the loop is in its place.
    unsafe { NVIC::unmask(Interrupt::TIM2) };
    loop {
        cortex_m::asm::wfi();
    }
}

/// PWM mode 1 with preload at half duty; an active-high break turns the output off until software turns it on.
fn start_pwm(timer: &TIM1) {
    timer.arr().write(|w| w.arr().set(PWM_PERIOD as u16 - 1));
    timer.ccr1().write(|w| w.ccr().set(PWM_PERIOD as u16 / 2));
    timer.ccmr1_output().write(|w| w.oc1m().pwm_mode1().oc1pe().enabled());
    timer.ccer().write(|w| w.cc1e().set_bit());
    timer.egr().write(|w| w.ug().update());
    timer.cr1().write(|w| w.arpe().enabled().cen().enabled());
    timer.bdtr().write(|w| w.bke().set_bit().bkp().set_bit().ossi().set_bit().moe().set_bit());
}

#[interrupt]
fn TIM2() {
    cortex_m::interrupt::free(|token| {
        if let Some(state) = LOOP.borrow(token).borrow_mut().as_mut() {
            tick(state);
        }
    });
    obey(REQUEST.load(Ordering::Relaxed));
}

fn tick(state: &mut Loop) {
    state.timer.sr().write(|w| w.uif().clear());
    let (motor, load) = (state.motor.count() as u16, state.load.count() as u16);
    let speed = i32::from(motor.wrapping_sub(state.last.0) as i16);
    let position = MOTOR.load(Ordering::Relaxed) + speed;
    MOTOR.store(position, Ordering::Relaxed);
    let travelled = i32::from(load.wrapping_sub(state.last.1) as i16);
    LOAD.store(LOAD.load(Ordering::Relaxed) + travelled, Ordering::Relaxed);
    state.last = (motor, load);
    TICKS.store(TICKS.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
    let error = REFERENCE.load(Ordering::Relaxed) - position;
    let effort = (error / 2 - 6 * speed).clamp(-DUTY_LIMIT, DUTY_LIMIT);
    // SAFETY: after the start, the tick alone and the handlers below use TIM1.
    let pwm = unsafe { TIM1::steal() };
    pwm.ccr1().write(|w| w.ccr().set((PWM_PERIOD as i32 / 2 + effort) as u16));
}

/// Fails as requested.
fn obey(request: u32) {
    match request {
        1 => panic!("as requested"),
        // SAFETY: none, and that is the point: an undefined instruction, and addresses where nothing is.
        2 => unsafe { core::arch::asm!("udf #0") },
        3 => {
            NVIC::pend(Interrupt::TIM5);
            // SAFETY: nothing handles it, so the default handler runs.
            unsafe { NVIC::unmask(Interrupt::TIM5) };
        }
        // SAFETY: as above.
        4 => drop(unsafe { core::ptr::read_volatile(0x4003_0000 as *const u32) }),
        5 => {
            // SAFETY: nothing else uses the basic timer TIM6. It is part of the chip, and its clock is off.
            let timer = unsafe { pac::TIM6::steal() };
            timer.cr1().write(|w| w.cen().enabled());
        }
        _ => {}
    }
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    stop()
}

// SAFETY: the handler never returns and uses no state of the code it interrupts.
#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    stop()
}

// SAFETY: as above.
#[exception]
unsafe fn DefaultHandler(_: i16) {
    stop()
}

fn stop() -> ! {
    cortex_m::interrupt::disable();
    turn_bridge_off();
    loop {
        // Sleeping would end at once while an interrupt is pending.
        cortex_m::asm::nop();
    }
}

/// Main output and enable off. A function of its own, because a test removes it from the image and has to notice.
#[inline(never)]
fn turn_bridge_off() {
    // SAFETY: interrupts are off and control never returns to the owners.
    let (timer, port) = unsafe { (TIM1::steal(), GPIOB::steal()) };
    timer.bdtr().modify(|_, w| w.moe().clear_bit());
    port.bsrr().write(|w| w.br0().set_bit());
}
