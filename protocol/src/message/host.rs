//! The messages of the host.
//!
//! | kind | message | frame bytes | when |
//! |---|---|---|---|
//! | `0x01` | [`Hello`] | 14 | first of all, repeated until answered; keeps the session alive |
//! | `0x02` | [`DescribeParameter`] | 9 | any time |
//! | `0x03` | [`GetParameter`] | 9 | any time |
//! | `0x04` | [`SetParameter`] | 14 | in `Idle`; live parameters also in `Armed` and `Running` |
//! | `0x05` | [`Arm`] | 12 | in `Idle` |
//! | `0x06` | [`Start`] | 12 | in `Armed` |
//! | `0x07` | [`Stop`] | 8 | in `Idle`, `Armed` and `Running` |
//! | `0x08` | [`EmergencyStop`] | 8 | any time |
//! | `0x09` | [`ClearFault`] | 8 | in `Faulted` |
//! | `0x0a` | [`Reset`] | 8 | any time |
//! | `0x0b` | [`DescribeLaw`] | 9 | any time |
//! | `0x0c` | [`DescribeSignal`] | 9 | any time |
//! | `0x0d` | [`DescribeChoice`] | 10 | any time |
//! | `0x0e` | [`Subscribe`] | 14 | in `Idle`, `Armed` and `Running` |
//! | `0x0f` | [`EnterLoader`] | 12 | in `Idle`, to write another firmware |
//! | `0x10` | [`EncoderSample`] | 19 | once in a control period of HIL mode |
//! | `0x11` | [`Reference`] | 13 | once in a control period of bench mode |
//! | `0x20` | [`StoreParameters`] | 8 | in `Idle` |
//! | `0x21` | [`RecallParameters`] | 8 | in `Idle` |
//! | `0x22` | [`ForgetParameters`] | 8 | in `Idle` |
//! | `0x23` | [`SetZero`] | 9 | in `Idle` |
//! | `0x24` | [`Capture`] | 22 | in `Idle`, `Armed` and `Running` |
//! | `0x25` | [`ReadCapture`] | 10 | any time |

use crate::counts::EncoderCounts;
use crate::enums::{CaptureTrigger, ParameterValue, ZeroSource};
use crate::limits::{MINOR_VERSION, PROTOCOL_VERSION};

messages! {
    /// A message of the host.
    pub enum HostMessage: HostToDrive, in every period EncoderSample;

    /// Opens a session. A new session number makes the drive disarm and enter `Idle`; the number of the open session
    /// changes nothing and requests the identity only. Same layout in every protocol version.
    0x01 Hello {
        /// Protocol version of the host.
        protocol_version: u8,
        /// Minor version of the host.
        minor_version: u8,
        /// Number of the session, chosen by the host. It distinguishes the answers from those to an earlier host.
        session: u32,
    }

    /// Requests name, unit, type, range, flags and laws of a parameter.
    0x02 DescribeParameter {
        /// Index, from 0 to the parameter count in `Identity`, exclusive.
        index: u8,
    }

    /// Requests the value in force.
    0x03 GetParameter {
        /// Index of the parameter.
        index: u8,
    }

    /// Sets a parameter; the answer reads back the value then in force.
    0x04 SetParameter {
        /// Index of the parameter.
        index: u8,
        /// The new value, of the parameter's own type.
        value: ParameterValue,
    }

    /// Arms the drive: the next `Start` of this session enables torque.
    0x05 Arm {
        /// Session opened by `Hello`, so that a stale frame of an earlier host can't arm the drive.
        session: u32,
    }

    /// Starts the control law from its initial state. The next sample must carry sequence 0.
    0x06 Start {
        /// Session opened by `Hello`.
        session: u32,
    }

    /// Ends the run: torque zero, `Idle`.
    0x07 Stop {}

    /// Torque zero at once; the drive latches a fault.
    0x08 EmergencyStop {}

    /// Clears the latched fault; the drive returns to `Idle`.
    0x09 ClearFault {}

    /// Returns the drive to `Boot` with default parameters, as after power-up. Same layout in every protocol version.
    0x0a Reset {}

    /// Requests the name of a control law.
    0x0b DescribeLaw {
        /// Index, from 0 to the law count in `Identity`, exclusive.
        index: u8,
    }

    /// Requests name, unit and laws of a signal.
    0x0c DescribeSignal {
        /// Index, from 0 to the signal count in `Identity`, exclusive.
        index: u8,
    }

    /// Requests the name of a value of a parameter with choices, or of a value of one of the drive's lists.
    0x0d DescribeChoice {
        /// Index of the parameter, or one of the numbers of a list in [`limits`](crate::limits).
        parameter: u8,
        /// The value, from the smallest to the largest of the parameter; of a list its byte.
        choice: u8,
    }

    /// Selects the signals that telemetry carries, and its rate. Replaces the subscription before it.
    0x0e Subscribe {
        /// Signals: bit `n` stands for the signal with index `n`. At most 13; none ends telemetry.
        signals: u32,
        /// Telemetry follows the torque of every sample whose sequence is a multiple of this number; 0 ends telemetry.
        every: u16,
    }

    /// Ends the firmware and starts the boot loader of the chip, which takes another firmware.
    0x0f EnterLoader {
        /// Session opened by `Hello`.
        session: u32,
    }

    /// Readings of the two encoders at the start of a control period.
    0x10 EncoderSample {
        /// Number of the control period since the start, from 0; wraps around.
        sequence: u16,
        /// Motor encoder, in counts; wraps around.
        motor_counts: EncoderCounts,
        /// Load encoder, in counts; wraps around.
        load_counts: EncoderCounts,
        /// Reference position of the load, in rad.
        reference_rad: f32,
    }

    /// Bench mode: the reference for the control steps from its arrival on. Restarts the watchdog.
    0x11 Reference {
        /// Number of the message, chosen by the host; `BenchSample` repeats it.
        number: u16,
        /// Reference position of the load, in rad.
        reference_rad: f32,
    }

    /// Stores the parameters in force: they become the defaults, those after `Reset` and after power-up. A loss of power at any
    /// instant leaves the set before or the new one.
    0x20 StoreParameters {}

    /// Sets every parameter to its default.
    0x21 RecallParameters {}

    /// Forgets the stored parameters and sets every parameter to the default of the firmware.
    0x22 ForgetParameters {}

    /// Makes a position of motor and load the zero of both encoders.
    0x23 SetZero {
        /// Which position.
        source: ZeroSource,
    }

    /// Records signals around an event, to be read with `ReadCapture`. Replaces the capture before it.
    0x24 Capture {
        /// Signals: bit `n` stands for the signal with index `n`. One to four; none ends the capture.
        signals: u32,
        /// Steps from one row to the next, 1 or more.
        every: u16,
        /// Rows before the event.
        before: u16,
        /// The event.
        trigger: CaptureTrigger,
        /// Index of the signal whose value is the event, among the captured ones.
        trigger_signal: u8,
        /// Value of the signal at the event, in its unit.
        level: f32,
    }

    /// Requests rows of the last capture.
    0x25 ReadCapture {
        /// Number of the first row, from 0.
        first: u16,
    }
}

impl Hello {
    /// Opens this session with the versions of this crate.
    #[must_use]
    pub const fn new(session: u32) -> Self {
        Self { protocol_version: PROTOCOL_VERSION, minor_version: MINOR_VERSION, session }
    }
}
