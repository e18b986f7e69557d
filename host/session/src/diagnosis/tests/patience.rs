//! A drive that answers each request just in time.

use std::time::Duration;

use lashloop_protocol::enums::{ParameterFlags, ParameterValue};
use lashloop_protocol::limits::MAX_PARAMETERS;
use lashloop_protocol::message::{ChoiceDescription, Hello, Identity, LawDescription, ParameterDescription};
use lashloop_protocol::text::Text;
use lashloop_protocol::{DriveMessage, HostMessage, Numbered};

use super::peer::{Peer, identity};
use super::{MS, failure, frame};
use crate::{PATIENCE, SessionError};

/// A drive with 16 laws and 240 parameters of 256 choices each that answers each request but `Hello` after `delay`.
fn talkative(delay: Duration) -> Peer {
    Peer::answering_after(move |Numbered { number, message }| {
        let delay = if matches!(message, HostMessage::Hello(_)) { MS } else { delay };
        let answer: DriveMessage = match message {
            HostMessage::Hello(Hello { session, .. }) => {
                let parameter_count = MAX_PARAMETERS as u8;
                Identity { law_count: 16, parameter_count, ..identity(session) }.into()
            }
            HostMessage::DescribeLaw(it) => LawDescription { index: it.index, name: Text::new("law") }.into(),
            HostMessage::DescribeParameter(it) => ParameterDescription {
                index: it.index,
                flags: ParameterFlags::CHOICES,
                laws: u16::MAX,
                default: ParameterValue::U32(0),
                min: ParameterValue::U32(0),
                max: ParameterValue::U32(255),
                name: Text::new("parameter"),
                unit: Text::new(""),
            }
            .into(),
            HostMessage::DescribeChoice(it) => {
                let name = Text::new("choice");
                ChoiceDescription { parameter: it.parameter, choice: it.choice, name }.into()
            }
            other => panic!("{other:?} before the description is complete"),
        };
        Some((delay, frame(number, answer)))
    })
}

#[test]
fn answers_just_in_time_hold_no_session_beyond_its_patience() {
    for delay_ms in [300, 490, 700, 1990] {
        let delay = Duration::from_millis(delay_ms);
        let error = failure(talkative(delay), PATIENCE + Duration::from_secs(3));
        match error {
            SessionError::Slow { limit, requests, .. } => {
                assert_eq!(limit, PATIENCE, "{delay:?}");
                assert!(requests >= 8, "{delay:?}: {requests} requests");
            }
            SessionError::Silent { .. } => assert!(delay_ms > 500, "{delay:?}: {error}"),
            _ => panic!("{delay:?}: {error}"),
        }
    }
}
