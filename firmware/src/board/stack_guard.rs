//! Memory below the stack that nobody may access: a stack that overflows is a processor fault, and not other variables.

use core::sync::atomic::AtomicU32;

use cortex_m::peripheral::MPU;

/// Size in bytes: more than the frame of any function that doesn't touch all of it.
const BYTES: usize = 1024;

#[repr(C, align(1024))]
struct Guard([AtomicU32; BYTES / 4]);

/// Variables lie below it, the stack above.
// SAFETY: the section isn't initialised by the start-up code, and nothing reads or writes these bytes.
#[allow(unsafe_code)]
#[unsafe(link_section = ".uninit.stack_guard")]
static STACK_GUARD: Guard = Guard([const { AtomicU32::new(0) }; BYTES / 4]);

/// Protects the memory. The processor leaves it accessible to the handler of the fault, whose stack is there (ARMv7-M B3.5.3).
pub(super) fn start(mpu: &MPU) {
    // Valid, for region 0.
    let address = (&raw const STACK_GUARD).addr() as u32 | 1 << 4;
    // Enabled, 2 to the power of 9 + 1 bytes, no access, no execution.
    let attributes = 1 | (BYTES.ilog2() - 1) << 1 | 1 << 28;
    // SAFETY: the region holds no variable of another owner, and everything outside of it keeps the default map.
    #[allow(unsafe_code)]
    unsafe {
        mpu.rbar.write(address);
        mpu.rasr.write(attributes);
        // Enabled, with the default map, off in HardFault and NMI.
        mpu.ctrl.write(1 | 1 << 2);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}
