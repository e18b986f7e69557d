//! A drive passes with laws of Lashloop in force after power-up: no check assumes more of a law than the page does. The page itself
//! excludes `open-loop`, whose first torque is 0 (R10.4), and `braking-curve`, which plans within the torque limit (R10.14).

use lashloop_firmware::control::backlash_inverse::BacklashInverse;
use lashloop_firmware::control::merzouki::Merzouki;
use lashloop_firmware::control::merzouki_as_printed::MerzoukiAsPrinted;
use lashloop_firmware::control::pd::Pd;
use lashloop_link::in_process::InProcess;

use crate::skipped;

/// What the checks are about that need certain parameters, signals or torques of a law, or signals that only one law has.
const DEPENDS: [&str; 5] = [
    "live",
    "signal",
    "a request that is infinite",
    "the law in force is that of the last Arm",
    "no count of a slow movement is lost",
];

/// Declares a drive with this law as its first, and another one.
macro_rules! default_laws {
    ($($name:ident: $Law:ident, $Other:ident;)+) => {
        $(mod $name {
            use super::*;

            lashloop_firmware::laws! {
                /// Two laws.
                pub enum Laws {
                    /// In force after power-up.
                    Default($Law),
                    /// The other one.
                    Other($Other),
                }
            }

            #[test]
            fn as_the_default_law_passes_every_check() {
                let skipped = skipped(InProcess::<Laws>::default());
                assert!(skipped.iter().all(|name| DEPENDS.iter().any(|what| name.contains(what))), "{skipped:?}");
            }
        })+
    };
}

default_laws! {
    pd: Pd, Merzouki;
    merzouki: Merzouki, Pd;
    merzouki_as_printed: MerzoukiAsPrinted, Pd;
    backlash_inverse: BacklashInverse, Pd;
}
