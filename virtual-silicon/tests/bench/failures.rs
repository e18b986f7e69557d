//! Code for failures of the firmware.
//!
//! Two functions of an image jump to a place in RAM, where a test puts the code of a failure. So one image serves all failures.

use lashloop_silicon::symbols::Symbols;
use lashloop_silicon::thumb::{Code, FOREVER, MASK_INTERRUPTS, RETURN, UNDEFINED};

use crate::host::Host;

/// The answer to a request that no run needs.
const SITE: &str = "send_description";
/// A function that one law calls in every step. The argument is returned instead of its value.
const FUNCTION: &str = "tanhf";
/// Where a test puts the code: RAM between variables and stack.
pub const PLACE: u32 = 0x2001_1000;

/// A word of RAM between variables and stack, by which a test controls code.
pub const FLAG: u32 = 0x2001_0000;
/// Line of the source that a made panic reports.
pub const PANIC_LINE: u32 = 4_711;

/// The image with both functions as jumps to [`PLACE`].
pub fn failing(image: &Symbols) -> Symbols {
    [SITE, FUNCTION].into_iter().fold(image.clone(), |image, function| {
        image.with_code(function, |_| Code::default().jump(PLACE.into())).expect("a function of the image")
    })
}

/// Puts code into [`PLACE`].
pub fn place(host: &mut Host, code: &Code) {
    let words = code.words();
    host.bench.act(move |chip, _| {
        for (address, word) in (PLACE..).step_by(4).zip(words) {
            chip.set_word(address.into(), word).expect("memory");
        }
    });
}

/// A panic of core with the location of a line of its own.
pub fn panicking(image: &Symbols) -> Code {
    let panic = image.function("option::unwrap_failed").expect("a function of core");
    // Four instructions to load two registers, one to jump, one to align.
    let location = PLACE + 20;
    let jump = Code::default().load(0, location).jump(panic);
    // File, its length, line, column.
    jump.halfword(0).word(0x0800_0000).word(0).word(PANIC_LINE).word(1)
}

/// Pushes onto a stack that has just one word left.
pub fn overflowing(image: &Symbols) -> Code {
    let guard = image.variable("STACK_GUARD").expect("the guard below the stack");
    // 1 kB of guard. mov sp, r0; push {r0}; push {r0}
    Code::default().load(0, guard as u32 + 1_024 + 4).halfwords(&[0x4685, 0xb401, 0xb401])
}

/// A processor fault at the priority of its own handler, to which FAULTMASK raises the core.
pub fn locking_up() -> Code {
    // cpsid f
    Code::default().halfwords(&[0xb671, UNDEFINED])
}

/// Pends the interrupt of TIM7, number 55, which no task handles.
pub fn interrupting() -> Code {
    const ENABLE: u32 = 0xe000_e104;
    const PEND: u32 = 0xe000_e204;
    const TIM7: u32 = 1 << 23;
    // str r1, [r0]
    let store = |code: Code| code.halfword(0x6001);
    let enabled = store(Code::default().load(0, ENABLE).load(1, TIM7));
    store(enabled.load(0, PEND)).halfword(RETURN)
}

/// An endless loop of the task that serves requests. The priority ceiling ends before it, so the other tasks go on.
pub fn serving_no_more() -> Code {
    // movs r0, #0; msr basepri, r0
    Code::default().halfwords(&[0x2000, 0xf380, 0x8811, FOREVER])
}

/// Returns the flag instead of a value, unless it is 0.
pub fn returning_the_flag() -> Code {
    // ldr r1, [r0]; cbz r1, 1f; vmov s0, r1; 1:
    Code::default().load(0, FLAG).halfwords(&[0x6801, 0xb109, 0xee00, 0x1a10, RETURN])
}

/// Loops forever if the flag is not 0.
pub fn never_ending() -> Code {
    // ldr r1, [r0]; cbz r1, 1f; b .; 1:
    Code::default().load(0, FLAG).halfwords(&[0x6801, 0xb101, FOREVER, RETURN])
}

/// Clears the flag after as many loops as it says.
pub fn taking_time() -> Code {
    // ldr r1, [r0]; movs r2, #0; str r2, [r0]; cbz r1, 1f; 2: subs r1, #1; bne 2b; 1:
    Code::default().load(0, FLAG).halfwords(&[0x6801, 0x2200, 0x6002, 0xb109, 0x3901, 0xd1fd, RETURN])
}

/// 40,000 loops with interrupts masked, at least 0.4 ms.
pub fn masking_interrupts() -> Code {
    // subs r0, #1; bne; cpsie i
    Code::default().halfword(MASK_INTERRUPTS).load(0, 40_000).halfwords(&[0x3801, 0xd1fd, 0xb662, RETURN])
}

/// Clears the control register of the tick's timer.
pub fn stopping_the_tick() -> Code {
    // movs r1, #0; str r1, [r0]
    Code::default().load(0, TIM5).halfwords(&[0x2100, 0x6001, RETURN])
}

const TIM5: u32 = 0x4000_0c00;
