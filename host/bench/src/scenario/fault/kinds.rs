//! The table form in which a group declares its kinds of fault.

/// What ends a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaultDuration {
    /// `for_s` in time of the run; without `for_s` the end of the run.
    Simulated,
    /// The step in which it begins.
    Momentary,
    /// `for_s` in the link's time, since there may be no steps meanwhile.
    WallClock,
}

/// Declares the kinds of one group. An entry reads `"name" => Variant { key: Type = reader, ... }`, with
/// `lasts Momentary` or `lasts WallClock` before the keys where the kind doesn't last in time of the run. A reader is
/// called with the section and the key's name.
///
/// Yields the enum, its form in scenarios (`kind = "name"`, then the keys), and the reading of each kind.
macro_rules! fault_kinds {
    (
        $(#[$attribute:meta])*
        pub enum $group:ident {
            $(
                #[doc = $kind_doc:literal]
                $name:literal => $kind:ident $(lasts $duration:ident)? {
                    $($(#[doc = $key_doc:literal])+ $key:ident: $type:ty = $read:expr,)*
                }
            )+
        }
    ) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
        #[serde(tag = "kind")]
        pub enum $group {
            $(
                #[doc = $kind_doc]
                #[serde(rename = $name)]
                $kind {
                    $($(#[doc = $key_doc])+ $key: $type,)*
                },
            )+
        }

        impl $group {
            /// The kinds, as scenarios spell them, with their meanings.
            pub const KINDS: &[$crate::scenario::key::Choice] =
                &[$($crate::scenario::key::Choice { name: $name, doc: $kind_doc.trim_ascii() }),+];

            /// The kind's name, and what ends a fault of this kind.
            pub(super) const fn entry(&self) -> (&'static str, $crate::scenario::fault::kinds::FaultDuration) {
                match self {
                    $(Self::$kind { .. } => ($name, fault_kinds!(@duration $($duration)?)),)+
                }
            }

            /// Reads the keys of the kind of this name; `None` if this group has no such kind.
            // A group whose kinds have no keys reads nothing.
            #[allow(unused_variables)]
            pub(super) fn read(name: &str, section: &mut $crate::scenario::reader::Section<'_>) -> Option<Self> {
                match name {
                    $($name => Some(Self::$kind { $($key: $read(section.doc(concat!($($key_doc),+)), stringify!($key)),)* }),)+
                    _ => None,
                }
            }
        }
    };
    (@duration) => { $crate::scenario::fault::kinds::FaultDuration::Simulated };
    (@duration $duration:ident) => { $crate::scenario::fault::kinds::FaultDuration::$duration };
}

pub(super) use fault_kinds;
