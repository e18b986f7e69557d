//! The messages: what each says, who sends it, and when.
//!
//! | kind | message | sent by | frame bytes | when |
//! |---|---|---|---|---|
//! | `0x01` | [`Hello`] | host | 12 | first of all, repeated until answered; and as a sign of life |
//! | `0x02` | [`DescribeParameter`] | host | 8 | to learn name, unit, type and range |
//! | `0x03` | [`GetParameter`] | host | 8 | to learn the value in force |
//! | `0x04` | [`SetParameter`] | host | 13 | in `Idle`, live parameters also when armed or running; the answer reads the value back |
//! | `0x05` | [`Arm`] | host | 11 | in `Idle` |
//! | `0x06` | [`Start`] | host | 11 | in `Armed` |
//! | `0x07` | [`Stop`] | host | 7 | in `Idle`, `Armed` and `Running` |
//! | `0x08` | [`EmergencyStop`] | host | 7 | any time |
//! | `0x09` | [`ClearFault`] | host | 7 | in `Faulted` |
//! | `0x0a` | [`Reset`] | host | 7 | any time |
//! | `0x10` | [`EncoderSample`] | host | 19 | once in a control period |
//! | `0x81` | [`Identity`] | drive | 51 | answers `Hello` |
//! | `0x82` | [`ParameterDescription`] | drive | 62 | answers `DescribeParameter` |
//! | `0x83` | [`ParameterReport`] | drive | 15 | answers `GetParameter` and `SetParameter` |
//! | `0x85` | [`CommandResult`] | drive | 10 | answers every other request |
//! | `0x90` | [`TorqueAnswer`] | drive | 16 | answers `EncoderSample`; what else a sample causes comes after it |
//! | | | | | (a sample before the greeting or out of sequence gets a `CommandResult` instead) |
//! | `0x91` | [`Telemetry`] | drive | 33 | after every n-th torque while running |
//! | `0x92` | [`FaultReport`] | drive | 22 | when a fault is latched |
//! | `0x93` | [`Log`] | drive | 60 | when the drive has something to say |
//! | `0x94` | [`LineReport`] | drive | 23 | answers `Stop`, before its result, done or not |

use crate::counts::EncoderCounts;
use crate::enums::{Controllers, FaultCode, LogLevel, Outcome, ParameterValue, State, TorqueStatus, Version};
use crate::frame::{Frame, MAX_FRAME};
use crate::layout::MessageLayout;
use crate::text::Text;
use crate::wire::BodyError;

/// All messages of one direction.
pub trait Message: Sized {
    /// The layouts of all kinds, in the order of their kind byte.
    const LAYOUTS: &'static [MessageLayout];

    /// Reads a body whose CRC has been checked.
    ///
    /// # Errors
    /// What is wrong with it as a message of this direction.
    fn decode_body(body: &[u8]) -> Result<Self, BodyError>;

    /// The message and the rest of `input`, if that begins with a whole and good frame of the kind that is sent in every
    /// control period; `None` for anything else, for which the caller takes the long way, as it always may.
    #[cfg(feature = "fast-path")]
    #[inline(always)]
    fn split_off_periodic(_input: &[u8]) -> Option<(Self, &[u8])> {
        None
    }

    /// The layout of this message.
    fn layout(&self) -> &'static MessageLayout;

    /// Writes the whole frame to the beginning of `room` and gives that part of it, ready to be sent. What `room` holds
    /// before doesn't matter, and what is behind the frame is of no use.
    fn write_frame<'room>(&self, room: &'room mut [u8; MAX_FRAME]) -> &'room [u8];

    /// The whole frame as a value. Where it is sent at once, [`Message::write_frame`] saves a copy.
    #[inline(always)]
    fn frame(&self) -> Frame {
        Frame::written_by(|room| self.write_frame(room))
    }
}

payload! {
    /// Opens a session. A number other than the last one makes the drive disarm and go to `Idle`; the same number
    /// again only shows that the host is alive.
    0x01 HostToDrive Hello {
        /// Protocol version of the host.
        protocol_version: u8,
        /// Number of the session, chosen by the host so that answers to an earlier host can be told apart.
        session: u32,
    }
}

payload! {
    /// Asks what the parameter with this index is.
    0x02 HostToDrive DescribeParameter {
        /// Index, from 0 to the parameter count in `Identity`, exclusive.
        index: u8,
    }
}

payload! {
    /// Asks for the value in force.
    0x03 HostToDrive GetParameter {
        /// Index of the parameter.
        index: u8,
    }
}

payload! {
    /// Sets a parameter; the answer reads back what is in force afterwards.
    0x04 HostToDrive SetParameter {
        /// Index of the parameter.
        index: u8,
        /// The new value, of the parameter's own type.
        value: ParameterValue,
    }
}

payload! {
    /// Arms the drive: the next `Start` of this session will give torque.
    0x05 HostToDrive Arm {
        /// The session opened by `Hello`; a stale frame of an earlier host can't arm.
        session: u32,
    }
}

payload! {
    /// Starts the controller from its initial state. The next sample must carry sequence 0.
    0x06 HostToDrive Start {
        /// The session opened by `Hello`.
        session: u32,
    }
}

payload! {
    /// Ends the run in good order: torque zero, `Idle`.
    0x07 HostToDrive Stop {}
}

payload! {
    /// Torque zero at once, and a latched fault.
    0x08 HostToDrive EmergencyStop {}
}

payload! {
    /// Acknowledges the latched fault: back to `Idle`.
    0x09 HostToDrive ClearFault {}
}

payload! {
    /// Back to `Boot` with default parameters, as after power-up. Same layout in every protocol version.
    0x0a HostToDrive Reset {}
}

payload! {
    /// What the two encoders read at the start of a control period.
    0x10 HostToDrive EncoderSample {
        /// Number of the control period since the start, from 0; wraps around.
        sequence: u16,
        /// Motor encoder, in counts; wraps around.
        motor_counts: EncoderCounts,
        /// Load encoder, in counts; wraps around.
        load_counts: EncoderCounts,
        /// Where the load is wanted, in rad.
        reference_rad: f32,
    }
}

payload! {
    /// Who the drive is. Same layout in every protocol version.
    0x81 DriveToHost Identity {
        /// Protocol version of the drive.
        protocol_version: u8,
        /// The session of the `Hello` that this answers.
        session: u32,
        /// Version of the firmware.
        firmware: Version,
        /// First 32 bits of the commit the firmware was built from; 0 if unknown.
        build_id: u32,
        /// State after the greeting.
        state: State,
        /// Name of the board.
        board: Text<16>,
        /// Control period in force, in us.
        period_us: u32,
        /// Resolution of the motor encoder in force, in counts per revolution.
        motor_counts_per_rev: u32,
        /// Resolution of the load encoder in force, in counts per revolution.
        load_counts_per_rev: u32,
        /// Control laws offered.
        controllers: Controllers,
        /// Number of parameters.
        parameter_count: u8,
    }
}

payload! {
    /// What a parameter is.
    0x82 DriveToHost ParameterDescription {
        /// Index of the parameter.
        index: u8,
        /// 1 if it may be set while running, else 0.
        live: u8,
        /// Value after power-up.
        default: ParameterValue,
        /// Smallest value taken.
        min: ParameterValue,
        /// Largest value taken.
        max: ParameterValue,
        /// Name, with the unit at its end.
        name: Text<28>,
        /// Unit as text; empty for a pure number.
        unit: Text<10>,
    }
}

payload! {
    /// The value of a parameter after a get or a set.
    0x83 DriveToHost ParameterReport {
        /// Index of the parameter.
        index: u8,
        /// Whether the request was done; if not, `value` is the one still in force.
        outcome: Outcome,
        /// The value in force.
        value: ParameterValue,
        /// State of the drive.
        state: State,
    }
}

payload! {
    /// What became of a request that has no answer of its own.
    0x85 DriveToHost CommandResult {
        /// Kind byte of the request.
        request: u8,
        /// Whether it was done.
        outcome: Outcome,
        /// State afterwards.
        state: State,
    }
}

payload! {
    /// The torque for one sample.
    0x90 DriveToHost TorqueAnswer {
        /// Sequence of the sample that this answers.
        sequence: u16,
        /// Motor torque from now on, in N m; zero unless running.
        torque_nm: f32,
        /// State after the step, and what is to be known of this torque.
        status: TorqueStatus,
        /// Time from the arrival of the sample to this answer, in 0.1 us; stays at its largest value if longer.
        compute_tenths_us: u16,
    }
}

payload! {
    /// What the controller thinks.
    0x91 DriveToHost Telemetry {
        /// Sequence of the sample at which this was so.
        sequence: u16,
        /// Estimate of the dead-zone amplitude used in this step's torque, in rad.
        dead_zone_estimate_rad: f32,
        /// Estimate of the disturbing torque, in N m.
        disturbing_torque_nm: f32,
        /// Error of the load position, in rad.
        load_error_rad: f32,
        /// Error of the motor position against the position the outer loop asks for, in rad.
        motor_error_rad: f32,
        /// Error of the elastic torque, in N m.
        elastic_error_nm: f32,
        /// Torque asked for before the limit, in N m.
        requested_torque_nm: f32,
    }
}

payload! {
    /// A fault that has just been latched.
    0x92 DriveToHost FaultReport {
        /// What happened.
        code: FaultCode,
        /// Sequence of the last sample taken.
        sequence: u16,
        /// The value that broke the limit, in the unit that the code says; 0 where there is none.
        value: f32,
        /// The limit that was broken; 0 where there is none.
        limit: f32,
        /// More, where the code says so.
        detail: u32,
    }
}

payload! {
    /// A line of text from the firmware.
    0x93 DriveToHost Log {
        /// Its weight.
        level: LogLevel,
        /// The text.
        text: Text<52>,
    }
}

payload! {
    /// What the drive's end of the line has seen since the start of the run.
    0x94 DriveToHost LineReport {
        /// Good messages.
        messages: u32,
        /// Frames that arrived damaged.
        damaged: u32,
        /// Whole frames that were no message of this version.
        refused: u32,
        /// Bytes the receiver lost before they became part of a frame.
        overruns: u32,
    }
}

direction! {
    /// What the host says.
    pub enum HostMessage {
        Hello,
        DescribeParameter,
        GetParameter,
        SetParameter,
        Arm,
        Start,
        Stop,
        EmergencyStop,
        ClearFault,
        Reset,
        EncoderSample,
    }
    in every period EncoderSample
}

direction! {
    /// What the drive says.
    pub enum DriveMessage {
        Identity,
        ParameterDescription,
        ParameterReport,
        CommandResult,
        TorqueAnswer,
        Telemetry,
        FaultReport,
        Log,
        LineReport,
    }
    in every period TorqueAnswer
}
