//! The zero of both encoders.

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
            ZeroSource::Home if parameters.home_input == Contact::Unused => {
                let (value, max, given_by) = (0.0, 2.0, "SetZero");
                let error = ParameterError { name: "home_input", value, max, given_by };
                Err(Parameters::<L>::inconsistent(&error))
            }
            ZeroSource::Home => {
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
            && let Some(is_home) = parameters.home_input.is_active(readings.contacts.home)
        {
            pins.note_home(is_home);
        }
    }
}
