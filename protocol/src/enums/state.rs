//! The state of a drive.

wire_list! {
    /// State of the drive.
    pub enum State {
        /// Powered, no handshake yet with a host of the same protocol version. Torque is zero.
        Boot = 1,
        /// Session open, disarmed. Torque is zero; parameters may be set.
        Idle = 2,
        /// Armed, waiting for the start. Torque is zero.
        Armed = 3,
        /// The control law determines the torque.
        Running = 4,
        /// A fault is latched. Torque is zero until the host clears the fault.
        Faulted = 5,
    }
}
