//! Values and messages in the words and units of the protocol's specification.

use lashloop_protocol::field_value::FieldValue;
use lashloop_protocol::frame;
use lashloop_protocol::layout::{FieldLayout, UNITS};

use crate::prelude::wire::*;

/// Most elements of a list that is shown whole, and how many are shown of a longer one.
const MOST_WORDS: usize = 20;
const FIRST_WORDS: usize = 5;

/// A value as text for people.
pub(super) trait Words {
    fn words(&self) -> String;
}

/// How values of these types are shown.
macro_rules! words {
    ($($($ty:ty),+ => |$it:ident| $words:expr;)+) => {
        $($(impl Words for $ty {
            fn words(&self) -> String {
                let $it = self;
                $words
            }
        })+)+
    };
}

words! {
    // State, outcome, fault and type with their names in the lists of the specification.
    u8, u16, u32, u64, i32, i64, usize, State, Outcome, FaultCode, ParameterType => |it| it.to_string();
    // Nine digits distinguish any two values of binary32.
    f64 => |it| {
        let rounded: f64 = format!("{it:.8e}").parse().unwrap_or(*it);
        scaled(rounded.abs(), &rounded.to_string(), &format!("{rounded:e}"))
    };
    // The fewest digits that distinguish a value from its neighbours, nine at most.
    f32 => |it| scaled(f64::from(it.abs()), &it.to_string(), &format!("{it:e}"));
    ParameterValue => |it| match it {
        U32(value) => value.words(),
        F32(value) => value.words(),
        Self::Unknown { ty, .. } => format!("{it} of the type {}", ty.get()),
    };
    Bits => |it| {
        let value = f32::from_bits(it.0);
        if value.is_nan() { format!("NaN (bits {:#010x})", it.0) } else { value.words() }
    };
    bool => |it| if *it { "yes" } else { "no" }.to_owned();
    // Texts of a drive may hold control characters.
    str => |it| it.escape_debug().to_string();
    String => |it| it.as_str().words();
    Duration => |it| format!("{} s", (it.as_secs_f64() * 1e6).round() / 1e6);
    EncoderCounts => |it| format!("{} counts", it.get());
    TorqueFlags => |it| match it.iter_names().map(|(name, _)| name).collect::<Vec<_>>() {
        _ if it.is_empty() => "no flags".to_owned(),
        names => names.join(" and "),
    };
    DriveMessage, HostMessage => |it| message_words(it);
    CommandResult, FaultReport, Identity, LineReport, ParameterReport, TorqueAnswer => |it| {
        message_words(&DriveMessage::from(*it))
    };
}

/// Very large and very small numbers have a power of ten.
fn scaled(size: f64, plain: &str, with_power: &str) -> String {
    let is_plain = size == 0.0 || !size.is_finite() || (1e-5..1e9).contains(&size);
    if is_plain { plain } else { with_power }.to_owned()
}

/// A number that is compared by its bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Bits(pub(super) u32);

impl<T: Words + ?Sized> Words for &T {
    fn words(&self) -> String {
        (*self).words()
    }
}

impl<T: Words> Words for Option<T> {
    fn words(&self) -> String {
        self.as_ref().map_or_else(|| "none".to_owned(), T::words)
    }
}

impl<T: Words> Words for [T] {
    fn words(&self) -> String {
        if self.is_empty() {
            return "nothing".to_owned();
        }
        let shown = if self.len() > MOST_WORDS { FIRST_WORDS } else { self.len() };
        let words = self.iter().take(shown).map(T::words).collect::<Vec<_>>().join(", ");
        if shown < self.len() { format!("{words} and so on, {} in all", self.len()) } else { words }
    }
}

impl<T: Words> Words for Vec<T> {
    fn words(&self) -> String {
        self.as_slice().words()
    }
}

impl<T: Words, const N: usize> Words for [T; N] {
    fn words(&self) -> String {
        self.as_slice().words()
    }
}

macro_rules! tuples {
    ($(($($at:tt: $ty:ident),+);)+) => {
        $(impl<$($ty: Words),+> Words for ($($ty,)+) {
            fn words(&self) -> String {
                [$(self.$at.words()),+].join(", ")
            }
        })+
    };
}

tuples! {
    (0: A, 1: B);
    (0: A, 1: B, 2: C);
    (0: A, 1: B, 2: C, 3: D);
    (0: A, 1: B, 2: C, 3: D, 4: E);
    (0: A, 1: B, 2: C, 3: D, 4: E, 5: F);
}

/// Name and all fields, as `TorqueAnswer with sequence 3, torque 0 N m, state Idle, no flags, compute 57 x 0.1 us`.
fn message_words(message: &impl Message) -> String {
    let mut stuffed = message.frame().to_vec();
    stuffed.pop();
    // This frame was just encoded, so it is good.
    let body = frame::open(&mut stuffed).map_or_else(|_| Vec::new(), <[u8]>::to_vec);
    let layout = message.layout();
    let fields = layout.fields.iter().filter_map(|it| Some(field_words(it, it.value(&body)?)));
    let fields = fields.collect::<Vec<_>>().join(", ");
    if fields.is_empty() { layout.name.to_owned() } else { format!("{} with {fields}", layout.name) }
}

/// A field's name and value, with the unit after the value instead of at the end of the name.
fn field_words(field: &FieldLayout, value: FieldValue<'_>) -> String {
    let name = field.name;
    match value {
        FieldValue::Status(state, flags) if flags.iter().next().is_none() => {
            format!("state {state}, no flags")
        }
        FieldValue::Status(state, flags) => {
            let flags: Vec<_> = flags.iter().map(|flag| flag.to_string()).collect();
            format!("state {state}, {}", flags.join(" and "))
        }
        FieldValue::Unsigned(kind) if name == "request" => {
            let known = HostMessage::LAYOUTS.iter().find(|it| u32::from(it.kind) == kind);
            known.map_or_else(|| format!("request {kind:#04x}"), |it| format!("request {}", it.name))
        }
        value => {
            let value = match value {
                FieldValue::Real(value) => value.words(),
                other => other.to_string(),
            };
            let with_unit = UNITS.iter().find_map(|(suffix, unit)| Some((name.strip_suffix(suffix)?, unit)));
            match with_unit {
                Some((name, &"0.1 us")) => format!("{name} {value} x 0.1 us"),
                Some((name, unit)) => format!("{name} {value} {unit}"),
                None => format!("{name} {value}"),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_at_most_nine_digits_and_a_power_of_ten_where_they_are_long() {
        assert_eq!(f64::from(0.1_f32).words(), "0.100000001");
        assert_eq!((0.1_f32, -3e38_f32).words(), "0.1, -3e38");
        assert_eq!((1e-30_f64, f32::INFINITY, -0.0_f32).words(), "1e-30, inf, -0");
        assert_eq!(Duration::from_secs_f32(0.21).words(), "0.21 s");
    }

    #[test]
    fn bits_are_shown_as_their_number_and_of_a_long_list_the_first_few() {
        assert_eq!(vec![7_u8; 300].words(), "7, 7, 7, 7, 7 and so on, 300 in all");
        assert_eq!([0x3f80_0000, 0xbf80_0000, 0x7fc0_0001].map(Bits).words(), "1, -1, NaN (bits 0x7fc00001)");
    }
}
