//! The outcome of a request.

wire_list! {
    /// Outcome of a request.
    pub enum Outcome {
        /// The drive carried out the request.
        Accepted = 1,
        /// The request is not allowed in this state; the answer carries the state.
        WrongState = 2,
        /// The session in the request is not the session of the last `Hello`.
        WrongSession = 3,
        /// Host and drive have different protocol versions.
        VersionMismatch = 4,
        /// No parameter, law, signal, choice or captured row has this index; for a row `detail` is the number of rows.
        UnknownIndex = 5,
        /// The type of the value is not the type of the parameter.
        WrongType = 6,
        /// The value is outside the range of the parameter, or the subscription has more signals than a frame holds.
        OutOfRange = 7,
        /// The sample is older than the last sample taken, too far ahead of it, or not 0 after a start.
        OutOfSequence = 8,
        /// The parameters, each within its range, contradict each other. `detail` is the index of one that doesn't go with the
        /// others.
        Inconsistent = 9,
        /// Bench mode: the power stage reports a fault. `detail` is as in [`FaultCode::PowerStage`](super::FaultCode::PowerStage).
        PowerStageFault = 10,
        /// Bench mode: the readings of an encoder allow no torque. `detail` is 1 if the encoders were not read yet, 2 or 3 if the
        /// motor or the load encoder moved faster than is plausible, 4 or 5 if both its channels changed at once.
        EncoderImplausible = 11,
        /// The drive doesn't know requests of this kind.
        UnknownRequest = 12,
        /// The law in force lacks a subscribed signal. `detail` is the index of the signal.
        SignalOfOtherLaw = 13,
        /// The drive could not store or forget the parameters. `detail` is 1 if its memory refuses to be written, 2 if it is full
        /// until the next power-up.
        StoreFailed = 14,
        /// The capture is missing or incomplete. `detail` is 0 without one, 1 before its event, 2 after it.
        NotCaptured = 15,
    }
}
