//! The entry into the boot loader.

use core::time::Duration;

use lashloop_protocol::enums::Outcome;

use super::loader::Loader;
use super::machine::Drive;
use crate::law::LawSet;

impl<L: LawSet> Drive<L> {
    /// The drive, on a chip with a boot loader: [`Self::enters_loader`] is to be called every millisecond.
    #[must_use]
    pub fn with_loader(mut self) -> Self {
        self.loader = Loader::Present;
        self
    }

    /// Whether the firmware is to end at device time `now`, and the boot loader to start.
    #[must_use]
    pub fn enters_loader(&self, now: Duration) -> bool {
        self.loader.is_due(now)
    }

    pub(super) fn enter_loader(&mut self, session: u32, now: Duration) -> Result<(), Outcome> {
        if self.loader == Loader::Absent || self.lifecycle.session() == Some(session) {
            return self.loader.request(self.state(), now);
        }
        Err(Outcome::WrongSession)
    }
}
