//! The names of most modules, in two layers, so that modules form no cycle.

/// Names of other crates, for every module.
pub(crate) mod wire {
    pub(crate) use std::time::{Duration, Instant};

    pub(crate) use lashloop_protocol::EncoderCounts;
    pub(crate) use lashloop_protocol::enums::Outcome::{
        Accepted, EncoderImplausible, Inconsistent, OutOfRange, OutOfSequence, PowerStageFault,
        SignalOfOtherLaw, UnknownIndex, UnknownRequest, VersionMismatch, WrongSession, WrongState, WrongType,
    };
    pub(crate) use lashloop_protocol::enums::ParameterValue::{F32, U32};
    pub(crate) use lashloop_protocol::enums::State::{Armed, Boot, Faulted, Idle, Running};
    pub(crate) use lashloop_protocol::enums::*;
    pub(crate) use lashloop_protocol::limits::*;
    pub(crate) use lashloop_protocol::message::*;
    pub(crate) use lashloop_protocol::parameter_names::*;
    pub(crate) use lashloop_protocol::wire::Payload;
    pub(crate) use lashloop_session::{Parameter, SessionError};

    pub(crate) const NONE: TorqueFlags = TorqueFlags::empty();
}

/// What checks are made of, for the groups of checks. A module whose names are here uses [`wire`] alone.
pub(crate) mod checks {
    pub(crate) use super::wire::*;

    pub(crate) use crate::answers::{
        command_result, counted, fault, forget_time, hello, identity, is, latched, line_report, of, other,
        outcome, sample, telemetry, torque,
    };
    pub(crate) use crate::assertion::{
        Failure, RuleResult, broken, equal, expect, find, names, of_kinds, skip,
    };
    pub(crate) use crate::check::{Check, check};
    pub(crate) use crate::client::Client;
    pub(crate) use crate::encoders::encoder::{Encoder, placed};
    pub(crate) use crate::encoders::setup::{Setting, Setup};
    pub(crate) use crate::exchanges::{Exchange, reads, result, sets};
    pub(crate) use crate::moment::Moment;
    pub(crate) use crate::range::{holds, in_type_of, nearest_real, nearest_whole, neighbour};
    pub(crate) use crate::reactions::{
        accepted, fault_answer, first_sample, no_torque, refused_sample, still_reported,
    };
    pub(crate) use crate::words::{Bits, Words};
}
