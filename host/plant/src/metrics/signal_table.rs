//! The signals of a run by name.

use std::borrow::Cow;

use crate::Signal;
pub use crate::signal::DRIVE_PREFIX;

/// Signals of every run, with any plant and any drive.
pub static FIXED_SIGNALS: [Signal; 4] = [
    Signal::new("reference_rad", "rad"),
    Signal::new("load_position_rad", "rad"),
    Signal::new("motor_position_rad", "rad"),
    Signal::new("torque_nm", "N m"),
];

/// The signals of one run: those of its plant, and those that its telemetry carries.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SignalTable {
    /// The plant's signals, in the order of [`Sample::plant`](super::Sample::plant).
    pub plant: Vec<Signal>,
    /// The subscribed signals of the drive, in the order of [`Sample::drive`](super::Sample::drive); empty without telemetry.
    pub drive: Vec<Signal>,
}

/// Where the values of a signal are in a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// An index of [`FIXED_SIGNALS`].
    Fixed(usize),
    Plant(usize),
    Drive(usize),
}

impl SignalTable {
    /// The unit of a signal; `None` for an unknown one. A drive's signal is named `drive.NAME`.
    #[must_use]
    pub fn unit(&self, name: &str) -> Option<&str> {
        let signal = match self.find(name)? {
            Place::Fixed(index) => &FIXED_SIGNALS[index],
            Place::Plant(index) => &self.plant[index],
            Place::Drive(index) => &self.drive[index],
        };
        Some(&signal.unit)
    }

    /// Every name, as [`unit`](Self::unit) takes it.
    pub fn names(&self) -> impl Iterator<Item = Cow<'_, str>> {
        let bare = FIXED_SIGNALS.iter().chain(&self.plant).map(|signal| Cow::Borrowed(&*signal.name));
        let drive = self.drive.iter().map(|signal| Cow::Owned(format!("{DRIVE_PREFIX}{}", signal.name)));
        bare.chain(drive)
    }

    pub(super) fn find(&self, name: &str) -> Option<Place> {
        let position = |signals: &[Signal], name: &str| signals.iter().position(|signal| signal.name == name);
        if let Some(name) = name.strip_prefix(DRIVE_PREFIX) {
            return position(&self.drive, name).map(Place::Drive);
        }
        let fixed = position(&FIXED_SIGNALS, name).map(Place::Fixed);
        fixed.or_else(|| position(&self.plant, name).map(Place::Plant))
    }
}
