//! The laws of Lashloop's own drive. A law is a file in [`control`](crate::control) and a line here.

use crate::control::backlash_inverse::BacklashInverse;
use crate::control::braking_curve::BrakingCurve;
use crate::control::merzouki::Merzouki;
use crate::control::merzouki_as_printed::MerzoukiAsPrinted;
use crate::control::open_loop::OpenLoop;
use crate::control::pd::Pd;

crate::laws! {
    /// The laws of Lashloop's own drive.
    #[derive(Debug, Clone, PartialEq)]
    pub enum Laws {
        /// The paper's cascade before compensation.
        Pd(Pd),
        /// The adaptive compensation of Merzouki and Cadiou, in the reading that reproduces the paper's numbers.
        Merzouki(Merzouki),
        /// The same compensation as printed, for comparison only.
        MerzoukiAsPrinted(MerzoukiAsPrinted),
        /// Inversion of the backlash in the torque domain, the gap identified by least squares. Not from the paper.
        BacklashInverse(BacklashInverse),
        /// That inverse along a braking curve: within a third of the minimum time to rest. Not from the paper.
        BrakingCurve(BrakingCurve),
        /// The reference as a torque, for commissioning.
        OpenLoop(OpenLoop),
    }
}
