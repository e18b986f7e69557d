//! Entries as JSON, one object per line.
//!
//! ```text
//! {"offset":0,"length":16,"direction":"drive_to_host","message":"TorqueAnswer","kind":144,
//!  "fields":{"sequence":258,"torque_nm":-20.420353,...},"units":{"torque_nm":"N m",...}}
//! {"packet":7,"time_ns":51200,"length":9,"error":"...","bytes":"0307..."}
//! {"offset":16,"length":12,"direction":"drive_to_host","unknown_kind":200,"number":7,"bytes":"..."}
//! {"counters":{"messages":1,...}}
//! ```
//!
//! The first object is wrapped here. A request and its answer have a `number`. `Telemetry` also has
//! `"signals":{"NAME":VALUE,...}` if the descriptions of the signals and the subscription are part of the stream. NaN and
//! infinities are strings.

use lashloop_protocol::Counters;
use lashloop_protocol::enums::ParameterValue;
use lashloop_protocol::field_value::{FieldValue, SetFlags};
use lashloop_protocol::hex::Hex;
use lashloop_protocol::layout::Direction;
use lashloop_session::printable;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::entry::{DecodedMessage, Entry, Location};

/// One entry, without the end of line.
///
/// # Errors
/// None known: every value has a representation in JSON.
pub fn line(entry: &Entry) -> serde_json::Result<String> {
    let content = match (&entry.message, entry.unknown()) {
        (Ok(message), _) => Content::Good {
            message: message.layout.name,
            kind: message.layout.kind,
            number: message.number,
            fields: Fields(message),
            signals: (!message.labels.is_empty()).then_some(Signals(message)),
            units: Units(message),
        },
        (Err(_), Some((unknown_kind, number))) => {
            Content::Unknown { unknown_kind, number, bytes: Hex(&entry.bytes).to_string() }
        }
        (Err(error), None) => Content::Bad { error: error.to_string(), bytes: Hex(&entry.bytes).to_string() },
    };
    serde_json::to_string(&Line {
        location: entry.location,
        length: entry.bytes.len(),
        direction: entry.direction().map(|direction| match direction {
            Direction::HostToDrive => "host_to_drive",
            Direction::DriveToHost => "drive_to_host",
        }),
        content,
    })
}

/// The counters, after the last entry.
#[must_use]
pub fn counters(counters: &Counters) -> String {
    let Counters { messages, discarded_bytes, oversized, malformed, crc_errors, refused, unknown } =
        *counters;
    let errors = format!(r#""crc_errors":{crc_errors},"malformed":{malformed},"oversized":{oversized}"#);
    let rest = format!(r#""refused":{refused},"unknown":{unknown},"discarded_bytes":{discarded_bytes}"#);
    format!(r#"{{"counters":{{"messages":{messages},{errors},{rest}}}}}"#)
}

#[derive(Serialize)]
struct Line<'a> {
    #[serde(flatten)]
    location: Location,
    length: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    direction: Option<&'static str>,
    #[serde(flatten)]
    content: Content<'a>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Content<'a> {
    Good {
        message: &'static str,
        kind: u8,
        #[serde(skip_serializing_if = "Option::is_none")]
        number: Option<u8>,
        fields: Fields<'a>,
        #[serde(skip_serializing_if = "Option::is_none")]
        signals: Option<Signals<'a>>,
        units: Units<'a>,
    },
    Unknown {
        unknown_kind: u8,
        #[serde(skip_serializing_if = "Option::is_none")]
        number: Option<u8>,
        bytes: String,
    },
    Bad {
        error: String,
        bytes: String,
    },
}

struct Fields<'a>(&'a DecodedMessage);

impl Serialize for Fields<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.fields().map(|(field, value)| (field.name, Value(value))))
    }
}

struct Signals<'a>(&'a DecodedMessage);

impl Serialize for Signals<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.signals().map(|(label, value)| (label.name.as_str(), Real(value))))
    }
}

struct Units<'a>(&'a DecodedMessage);

impl Serialize for Units<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let fields = self.0.fields().filter_map(|(field, _)| Some((field.name, field.unit()?)));
        let signals = self.0.labels.iter().filter(|label| !label.unit.is_empty());
        serializer.collect_map(fields.chain(signals.map(|label| (label.name.as_str(), label.unit.as_str()))))
    }
}

struct Real(f32);

impl Serialize for Real {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0.is_finite() { serializer.serialize_f32(self.0) } else { serializer.collect_str(&self.0) }
    }
}

struct Value<'a>(FieldValue<'a>);

impl Serialize for Value<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let names = |flags: SetFlags| flags.iter().map(|flag| flag.to_string()).collect::<Vec<_>>();
        match self.0 {
            FieldValue::Unsigned(value) | FieldValue::Parameter(ParameterValue::U32(value)) => {
                serializer.serialize_u32(value)
            }
            FieldValue::Signed(value) => serializer.serialize_i32(value),
            FieldValue::Real(value) | FieldValue::Parameter(ParameterValue::F32(value)) => {
                Real(value).serialize(serializer)
            }
            FieldValue::Reals(values) => serializer.collect_seq(values.as_slice().iter().copied().map(Real)),
            FieldValue::Parameter(unknown @ ParameterValue::Unknown { .. }) => {
                serializer.collect_str(&FieldValue::Parameter(unknown))
            }
            FieldValue::Name(value) => serializer.collect_str(&value),
            FieldValue::Text(text) => serializer.serialize_str(&printable(text)),
            FieldValue::Status(state, flags) => {
                let mut status = serializer.serialize_struct("Status", 2)?;
                status.serialize_field("state", &state.to_string())?;
                status.serialize_field("flags", &names(flags))?;
                status.end()
            }
            FieldValue::Flags(flags) => serializer.collect_seq(names(flags)),
            FieldValue::Version(version) => serializer.collect_str(&version),
        }
    }
}
