//! The outcome of a request.

wire_enum! {
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
        /// No parameter, law, signal or choice has this index.
        UnknownIndex = 5,
        /// The type of the value is not the type of the parameter.
        WrongType = 6,
        /// The value is outside the range of the parameter, or the subscription has more signals than a frame holds.
        OutOfRange = 7,
        /// The sample is older than the last sample taken, too far ahead of it, or not 0 after a start.
        OutOfSequence = 8,
        /// The parameters, each within its range, contradict each other, or the law in force lacks a subscribed signal; a log
        /// text names the cause.
        Inconsistent = 9,
        /// Bench mode: the power stage reports a fault.
        PowerStageFault = 10,
        /// Bench mode: an encoder gave no reading, moved faster than is plausible, or changed both channels at once.
        EncoderImplausible = 11,
    }
}
