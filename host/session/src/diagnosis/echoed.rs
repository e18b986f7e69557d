//! An answer that repeats its request wrongly.

use lashloop_protocol::layout::MessageLayout;
use lashloop_protocol::{DriveMessage, HostMessage, Message};

/// An answer with the number of the request and another index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OtherIndex {
    /// The answer.
    pub answer: &'static MessageLayout,
    /// The field that differs.
    pub field: &'static str,
    /// Its value in the answer.
    pub received: u8,
    /// Its value in the request.
    pub sent: u8,
}

impl OtherIndex {
    /// The field of an answer that must repeat the request and doesn't.
    pub(super) fn of(answer: &DriveMessage, request: &HostMessage) -> Option<Self> {
        let (field, received, sent) = match (answer, request) {
            (DriveMessage::LawDescription(it), HostMessage::DescribeLaw(of)) => ("index", it.index, of.index),
            (DriveMessage::SignalDescription(it), HostMessage::DescribeSignal(of)) => {
                ("index", it.index, of.index)
            }
            (DriveMessage::ParameterDescription(it), HostMessage::DescribeParameter(of)) => {
                ("index", it.index, of.index)
            }
            (DriveMessage::ParameterReport(it), HostMessage::GetParameter(of)) => {
                ("index", it.index, of.index)
            }
            (DriveMessage::ParameterReport(it), HostMessage::SetParameter(of)) => {
                ("index", it.index, of.index)
            }
            (DriveMessage::ChoiceDescription(it), HostMessage::DescribeChoice(of)) => {
                if it.parameter == of.parameter {
                    ("choice", it.choice, of.choice)
                } else {
                    ("parameter", it.parameter, of.parameter)
                }
            }
            (DriveMessage::CommandResult(it), of) => ("request", it.request, of.layout().kind),
            _ => return None,
        };
        (received != sent).then(|| Self { answer: answer.layout(), field, received, sent })
    }
}
