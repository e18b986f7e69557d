//! A drive passes with laws of Lashloop in force after power-up: no check assumes more of a law than the page does. The page itself
//! excludes `open-loop`, whose first torque is 0 (R10.4). `braking-curve` plans within the torque limit, as its request shows (R10.14).

use lashloop_firmware::control::backlash_inverse::BacklashInverse;
use lashloop_firmware::control::braking_curve::BrakingCurve;
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

/// What can't be judged of a law that never requests more than the limit.
const WITHIN_THE_LIMIT: [&str; 2] = ["a limited torque after a gap", "the torque limit of each run"];

/// Declares a drive with this law as its first, and another one, and what else may be skipped.
macro_rules! default_laws {
    ($($name:ident: $Law:ident, $Other:ident, $also:expr;)+) => {
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
                let may_be = |name: &str| DEPENDS.iter().chain(&$also).any(|what: &&str| name.contains(what));
                assert!(skipped.iter().all(|name| may_be(name)), "{skipped:?}");
            }
        })+
    };
}

default_laws! {
    pd: Pd, Merzouki, [];
    merzouki: Merzouki, Pd, [];
    merzouki_as_printed: MerzoukiAsPrinted, Pd, [];
    backlash_inverse: BacklashInverse, Pd, [];
    braking_curve: BrakingCurve, Pd, WITHIN_THE_LIMIT;
}
