//! A control law of one's own, and a drive that has it besides Lashloop's laws.

#![no_std]
#![forbid(unsafe_code)]

pub mod velocity_pi;

use lashloop_firmware::control::backlash_inverse::BacklashInverse;
use lashloop_firmware::control::merzouki::Merzouki;
use lashloop_firmware::control::merzouki_as_printed::MerzoukiAsPrinted;
use lashloop_firmware::control::pd::Pd;

use velocity_pi::VelocityPi;

lashloop_firmware::laws! {
    /// The laws of this drive. The first one is in force after power-up.
    pub enum OwnLaws {
        /// The law of this crate.
        VelocityPi(VelocityPi),
        /// Lashloop's laws.
        Pd(Pd),
        /// As above.
        Merzouki(Merzouki),
        /// As above.
        MerzoukiAsPrinted(MerzoukiAsPrinted),
        /// As above.
        BacklashInverse(BacklashInverse),
    }
}
