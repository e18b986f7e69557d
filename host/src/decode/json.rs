//! Entries as JSON, one object a line.
//!
//! ```text
//! {"offset":0,"length":16,"direction":"drive_to_host","message":"TorqueAnswer","kind":144,
//!  "fields":{"sequence":258,"torque_nm":-20.420353,...},"units":{"torque_nm":"N m",...}}
//! {"packet":7,"time_ns":51200,"length":9,"error":"...","bytes":"0307..."}
//! {"counters":{"messages":1,...}}
//! ```
//!
//! The first two are shown on two lines. A real number that is none (NaN, infinity) is a string.

use lashloop_protocol::Counters;
use lashloop_protocol::enums::ParameterValue;
use lashloop_protocol::layout::Direction;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::entry::{Entry, Location};
use super::value::{Field, Value};

/// One entry as a line of JSON, without the end of line.
///
/// # Errors
/// None that is known: every value has a form in JSON.
pub fn line(entry: &Entry) -> serde_json::Result<String> {
    let (message, error) = match &entry.message {
        Ok(message) => (Some(message), None),
        Err(error) => (None, Some(error.to_string())),
    };
    let (offset, packet, time_ns) = match entry.location {
        Location::Offset(offset) => (Some(offset), None, None),
        Location::Packet { number, time_ns, .. } => (None, Some(number), Some(time_ns)),
    };
    serde_json::to_string(&Line {
        offset,
        packet,
        time_ns,
        length: entry.bytes.len(),
        direction: entry.direction().map(|direction| match direction {
            Direction::HostToDrive => "host_to_drive",
            Direction::DriveToHost => "drive_to_host",
        }),
        message: message.map(|message| message.layout.name),
        kind: message.map(|message| message.layout.kind),
        fields: message.map(|message| Fields(&message.fields)),
        units: message.map(|message| Units(&message.fields)),
        bytes: error.is_some().then(|| entry.bytes.iter().map(|byte| format!("{byte:02x}")).collect()),
        error,
    })
}

/// The counters, after the last entry.
///
/// # Errors
/// None that is known.
pub fn counters(counters: &Counters) -> serde_json::Result<String> {
    let Counters { messages, discarded_bytes, oversized, malformed, crc_errors, refused } = *counters;
    serde_json::to_string(&Total {
        counters: Counts { messages, crc_errors, malformed, oversized, refused, discarded_bytes },
    })
}

#[derive(Serialize)]
struct Line<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    offset: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    packet: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    time_ns: Option<u64>,
    length: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    direction: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    message: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<u8>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fields: Option<Fields<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    units: Option<Units<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bytes: Option<String>,
}

#[derive(Serialize)]
struct Total {
    counters: Counts,
}

#[derive(Serialize)]
struct Counts {
    messages: u32,
    crc_errors: u32,
    malformed: u32,
    oversized: u32,
    refused: u32,
    discarded_bytes: u32,
}

struct Fields<'a>(&'a [Field]);

impl Serialize for Fields<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|field| (field.name, &field.value)))
    }
}

struct Units<'a>(&'a [Field]);

impl Serialize for Units<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().filter_map(|field| Some((field.name, field.unit?))))
    }
}

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Unsigned(value) | Self::Parameter(ParameterValue::U32(value)) => {
                serializer.serialize_u32(*value)
            }
            Self::Signed(value) => serializer.serialize_i32(*value),
            Self::Real(value) | Self::Parameter(ParameterValue::F32(value)) if value.is_finite() => {
                serializer.serialize_f32(*value)
            }
            Self::Real(value) | Self::Parameter(ParameterValue::F32(value)) => serializer.collect_str(value),
            Self::Name(name) => serializer.serialize_str(name),
            Self::Status(state, flags) => {
                let mut status = serializer.serialize_struct("Status", 2)?;
                status.serialize_field("state", state)?;
                status.serialize_field("flags", flags)?;
                status.end()
            }
            Self::Flags(names) => serializer.collect_seq(names),
            Self::Text(text) => serializer.serialize_str(text),
            Self::Version(version) => serializer.collect_str(version),
        }
    }
}
