//! Inputs for contacts to ground.

use stm32f4xx_hal::gpio::{AnyPin, Input};

use crate::board::parts::ContactInputs;
use crate::contact::Contacts;

/// Enable, negative and positive limit switch, home switch; with pull-ups.
pub struct ContactPins(pub [AnyPin<Input>; 4]);

impl ContactInputs for ContactPins {
    fn closed(&self) -> Contacts {
        let [enable, negative_limit, positive_limit, home] = self.0.each_ref().map(AnyPin::is_low);
        Contacts { enable, negative_limit, positive_limit, home }
    }
}
