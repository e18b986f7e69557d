//! The first instructions: the processor as after a reset, however the image was entered.
//!
//! A boot loader enters the image by a jump, not by a reset (ST AN3155, AN3156). It leaves its own vector table in force, and
//! may leave SysTick running and interrupts unmasked or pending. The first of them would end in the loader's handler, or in one of
//! ours before memory is initialised. [`clock_tree`](super::clock_tree) does the same for the clocks.

/// Called by cortex-m-rt before it initialises memory; in assembly, because no Rust code may run before that.
///
/// Interrupts stay masked until RTIC unmasks them.
// SAFETY: it writes registers of the processor and returns as a function does; it uses no memory.
#[allow(unsafe_code)]
#[unsafe(naked)]
#[unsafe(export_name = "__pre_init")]
extern "C" fn enter() {
    core::arch::naked_asm!(
        "cpsid i",
        "movs  r0, #0",
        "ldr   r1, =0xe000e010 // SysTick: control",
        "str   r0, [r1]",
        "mvns  r2, r0",
        "ldr   r1, =0xe000e180 // NVIC: disable all",
        "movs  r3, #8",
        "1: str r2, [r1], #4",
        "subs  r3, #1",
        "bne   1b",
        "ldr   r1, =0xe000e280 // NVIC: clear all that pend",
        "movs  r3, #8",
        "2: str r2, [r1], #4",
        "subs  r3, #1",
        "bne   2b",
        "ldr   r1, =0xe000ed04 // SCB: ICSR, clear a pending SysTick and PendSV; VTOR after it",
        "ldr   r0, =0x0a000000",
        "str   r0, [r1]",
        "ldr   r0, =__vector_table",
        "str   r0, [r1, #4]",
        "dsb",
        "isb",
        "bx    lr",
        ".ltorg",
    )
}
