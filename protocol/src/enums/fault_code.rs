//! The causes of a latched fault.

wire_list! {
    /// Cause of a latched fault.
    pub enum FaultCode {
        /// No sample within the watchdog time. `value` and `limit` in seconds.
        Watchdog = 1,
        /// The host sent an emergency stop.
        EmergencyStop = 2,
        /// The torque of the control law was not finite.
        TorqueNotFinite = 3,
        /// The reference in a sample was not finite.
        ReferenceNotFinite = 4,
        /// The motor encoder moved faster than is plausible. `value` and `limit` in rad/s.
        MotorEncoderJump = 5,
        /// The load encoder moved faster than is plausible. `value` and `limit` in rad/s.
        LoadEncoderJump = 6,
        /// The firmware panicked. `detail` is the source line.
        Panic = 7,
        /// The processor took a fault exception, `detail` is the program counter; or an unexpected interrupt, `detail` is
        /// its number.
        ProcessorFault = 8,
        /// Bench mode: the power stage reported a fault. `detail` is 1 for the break input, 2 for the fault line, 3 for a missing
        /// supply, 4 for overcurrent, 5 for overtemperature, 6 for the current sensor, 7 for overvoltage, 8 for
        /// a missing enable.
        PowerStage = 9,
        /// Bench mode: the motor encoder stands still while the load moves, `value` and `limit` in rad; or its channels changed
        /// at once, `detail` is the number of times.
        MotorEncoderLost = 10,
        /// Bench mode: the load encoder stands still while the motor moves, `value` and `limit` in rad at the motor; or its
        /// channels changed at once, `detail` is the number of times.
        LoadEncoderLost = 11,
        /// Bench mode: a control step ended after its period, or was missing. `value` and `limit` in seconds.
        TickOverrun = 12,
        /// Bench mode: the motor ran away from its torque. `value` and `limit` in rad; `detail` is 1 if the load turned with the
        /// motor, 2 if it turned against it, otherwise 0.
        MotorAgainstTorque = 13,
        /// Bench mode: the motor left its travel. `value` and `limit` in rad.
        MotorTravel = 14,
        /// Bench mode: the load left its travel. `value` and `limit` in rad.
        LoadTravel = 15,
        /// Bench mode: the torque was at its limit and nothing moved. `value` and `limit` in seconds.
        Stall = 16,
        /// Bench mode: the mean of the squared torque or current was too large. `value` and `limit` in N m, `detail` is 1 for the
        /// motor; in A, 2 for the stage.
        Overload = 17,
        /// Bench mode: the measured torque stayed below half the command. `value` and `limit` in seconds.
        TorqueMissing = 18,
        /// Bench mode: the torque was towards an active limit switch. `detail` is 1 for the negative one, 2 for the positive one.
        LimitSwitch = 19,
    }
}
