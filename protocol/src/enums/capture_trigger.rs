//! The event around which a capture records.

wire_list! {
    /// The event around which a capture records.
    pub enum CaptureTrigger {
        /// The first step after the rows before the event.
        Now = 1,
        /// The signal passes the level upwards.
        Rising = 2,
        /// The signal passes the level downwards.
        Falling = 3,
        /// The drive latches a fault.
        Fault = 4,
    }
}
