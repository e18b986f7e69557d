//! Inputs for contacts to ground.

use stm32h7xx_hal::gpio::{ErasedPin, Input};

use crate::board::parts::ContactInputs;
use crate::contact::Contacts;

/// Enable, negative and positive limit switch, home switch; with pull-ups.
pub struct ContactPins(pub [ErasedPin<Input>; 4]);

impl ContactInputs for ContactPins {
    fn closed(&self) -> Contacts {
        let [enable, negative_limit, positive_limit, home] = self.0.each_ref().map(ErasedPin::is_low);
        Contacts { enable, negative_limit, positive_limit, home }
    }
}
