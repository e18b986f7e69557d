//! The requests to store, recall and forget parameters.

use lashloop_protocol::enums::{Outcome, State};

use super::keep::Keep;
use super::machine::Drive;
use super::refusal::Refusal;
use crate::law::LawSet;
use crate::store::{Progress, Store, StoreError};

impl<L: LawSet> Drive<L> {
    /// The drive after power-up, with a store: its parameters are those that were stored. [`Self::continue_storing`] is to be
    /// called after each [`Self::receive`], until it returns false.
    #[must_use]
    pub fn with_store(mut self, store: Store) -> Self {
        self.parameters.recall(Some(&store));
        self.store = Some(store);
        self
    }

    /// Writes the next line of a record, and answers the request after the last one. Returns whether there was one to write. A line
    /// takes less than 1 ms. Until the end [`Self::receive`] takes no bytes, so the parameters stay as they are.
    pub fn continue_storing(&mut self) -> bool {
        let Some(store) = &mut self.store else { return false };
        let parameters = &self.parameters;
        let result = match store.step(|place| parameters.entry_to_store(place)) {
            Progress::Idle => return false,
            Progress::Writing => return true,
            Progress::Done(result) => result,
        };
        if self.keeping == Keep::Forget && result.is_ok() {
            self.parameters.recall(self.store.as_ref());
        }
        self.send_result(self.keeping as u8, result.map_err(Refusal::from));
        true
    }

    /// Takes a request for the store, and answers it unless the memory has to be written first.
    pub(super) fn keep_parameters(&mut self, request: Keep) {
        self.keeping = request;
        if let Some(result) = self.begin_to_keep() {
            self.send_result(request as u8, result);
        }
    }

    /// `None` if the memory has to be written first.
    fn begin_to_keep(&mut self) -> Option<Result<(), Refusal>> {
        let state = self.state();
        let Some(store) = &mut self.store else { return Some(Err(Outcome::UnknownRequest.into())) };
        if state != State::Idle {
            return Some(Err(Outcome::WrongState.into()));
        }
        let count = match self.keeping {
            Keep::Store => self.parameters.count(),
            // Without a record there is nothing to forget, and no reason to wear the memory.
            Keep::Forget if store.holds_values() => 0,
            Keep::Forget | Keep::Recall => {
                self.parameters.recall(Some(store));
                return Some(Ok(()));
            }
        };
        store.begin(count.into()).err().map(|error| Err(error.into()))
    }
}

impl From<StoreError> for Refusal {
    fn from(error: StoreError) -> Self {
        Self { outcome: Outcome::StoreFailed, detail: error as u32 }
    }
}
