//! The control laws that a drive may offer.
//!
//! [`ControllerId::name`] is the one source of the laws' names: scenarios, records and the command line use it.

use crate::layout::FieldType;
use crate::wire::Wire;

wire_enum! {
    /// Control law.
    pub enum ControllerId {
        /// The paper's cascade before compensation.
        Pd = 1 as "pd",
        /// The adaptive compensation of Merzouki and Cadiou, in the reading that reproduces the paper's numbers.
        Merzouki = 2 as "merzouki",
        /// The same compensation as printed, without lead and without the free control; for comparison only.
        MerzoukiAsPrinted = 3 as "merzouki-as-printed",
        /// Inversion of the backlash in the torque domain, the gap identified by least squares. Not from the paper.
        BacklashInverse = 4 as "backlash-inverse",
    }
}

impl ControllerId {
    /// The law with this name, former names included; `None` for any other text. Scenarios may use former names until
    /// release 1.0.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "faithful" => Some(Self::Merzouki),
            "literal" => Some(Self::MerzoukiAsPrinted),
            "compensating" => Some(Self::BacklashInverse),
            _ => Self::ALL.iter().copied().find(|law| law.name() == name),
        }
    }
}

wire_enum! {
    /// Source of the disturbing torque in the compensation; value of the parameter `disturbing_torque_source`.
    pub enum DisturbingTorqueSource {
        /// The nominal dead-zone model, equation (4). Exact on the paper's smooth plant only.
        Model = 1,
        /// A momentum observer on the motor side. Independent of the plant's backlash model.
        Observed = 2,
    }
}

bitflags::bitflags! {
    /// Control laws that a drive offers: bit `n` stands for the [`ControllerId`] with byte `n`.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Controllers: u16 {
        /// [`ControllerId::Pd`].
        const PD = 1 << ControllerId::Pd as u16;
        /// [`ControllerId::Merzouki`].
        const MERZOUKI = 1 << ControllerId::Merzouki as u16;
        /// [`ControllerId::MerzoukiAsPrinted`].
        const MERZOUKI_AS_PRINTED = 1 << ControllerId::MerzoukiAsPrinted as u16;
        /// [`ControllerId::BacklashInverse`].
        const BACKLASH_INVERSE = 1 << ControllerId::BacklashInverse as u16;
    }
}

flag_set!(Controllers);

impl Controllers {
    /// Whether the drive offers this law.
    #[must_use]
    pub const fn offers(self, controller: ControllerId) -> bool {
        self.bits() & (1 << controller as u16) != 0
    }
}

impl Wire for Controllers {
    const LEN: usize = 2;
    const TYPE: FieldType = FieldType::Flags(Self::SET);

    #[inline]
    fn put(self, out: &mut [u8]) {
        self.bits().put(out);
    }

    /// Keeps unknown bits: a newer drive may offer laws that have no name here.
    #[inline]
    fn get(bytes: &[u8]) -> Option<Self> {
        u16::get(bytes).map(Self::from_bits_retain)
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;

    #[test]
    fn every_law_is_found_by_its_name() {
        for &law in ControllerId::ALL {
            assert_eq!(ControllerId::from_name(&law.to_string()), Some(law));
            assert!(Controllers::all().offers(law), "{law} has a bit");
        }
        assert_eq!(ControllerId::from_name("Pd"), None);
    }

    #[test]
    fn former_names_still_name_their_laws() {
        let former = [
            ("faithful", ControllerId::Merzouki),
            ("literal", ControllerId::MerzoukiAsPrinted),
            ("compensating", ControllerId::BacklashInverse),
        ];
        for (name, law) in former {
            assert_eq!(ControllerId::from_name(name), Some(law));
        }
    }
}
