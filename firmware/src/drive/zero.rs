//! The zero of both encoders.

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::{Outcome, State, ZeroSource};

use super::machine::Drive;
use super::parameters::Parameters;
use super::pins::PinReadings;
use super::refusal::Refusal;
use crate::contact::Contact;
use crate::law::{LawSet, ParameterError};

impl<L: LawSet> Drive<L> {
    pub(super) fn set_zero(&mut self, source: ZeroSource) -> Result<(), Refusal> {
        let state = self.state();
        let (Some(pins), Some(parameters)) = (&mut self.pins, self.parameters.pins()) else {
            return Err(Outcome::UnknownRequest.into());
        };
        if state != State::Idle {
            return Err(Outcome::WrongState.into());
        }
        match source {
            ZeroSource::Present => pins.set_zero(),
            ZeroSource::Home => {
                let index = parameters.index_input;
                let has_index = index.side().map(|side| pins.hardware().has_index.get(side) == Some(&true));
                let error = match has_index {
                    Some(true) => None,
                    Some(false) => {
                        Some(("index_input", index as u32 as f32, "the index input that the board lacks"))
                    }
                    None if parameters.home_input != Contact::Unused => None,
                    None => Some(("home_input", 0.0, "SetZero")),
                };
                if let Some((name, value, given_by)) = error {
                    let error = ParameterError { name, value, max: 2.0, given_by };
                    return Err(Parameters::<L>::inconsistent(&error));
                }
                pins.await_home();
                Ok(())
            }
            ZeroSource::Unknown(_) => Err(Outcome::OutOfRange.into()),
        }
    }

    /// Takes the zero where the home switch closes, if a host waits for it. To be called with the readings of every tick in `Idle`.
    pub(super) fn find_home(&mut self, readings: &PinReadings) {
        if let Some(pins) = self.pins.as_mut().filter(|pins| pins.awaits_home())
            && let Some(parameters) = self.parameters.pins()
            && parameters.index_input.side().is_none()
            && let Some(is_home) = parameters.home_input.is_active(readings.contacts.home)
        {
            pins.note_home(is_home);
        }
    }

    /// The encoder, 0 for the motor, whose index pulse a host waits for. After the sample of each tick, [`Self::note_index`] takes it.
    #[must_use]
    pub fn awaited_index(&self) -> Option<usize> {
        self.pins.as_ref().filter(|pins| pins.awaits_home())?;
        if self.state() != State::Idle {
            return None;
        }
        self.parameters.pins()?.index_input.side()
    }

    /// Takes the counts of [`Self::awaited_index`] at its latest index pulse since the last tick.
    pub fn note_index(&mut self, side: usize, index: Option<EncoderCounts>) {
        if let (Some(pins), Some(parameters)) = (&mut self.pins, self.parameters.pins()) {
            let is_home = parameters.home_input.is_active(pins.readings().contacts.home);
            pins.note_index(side, index, is_home != Some(false));
        }
    }
}
