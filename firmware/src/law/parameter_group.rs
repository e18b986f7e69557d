//! Parameters that belong together: a struct, its defaults and its table from one declaration.

use super::parameter::Parameter;

/// Values of parameters as 32-bit words, in the order of the fields that read them.
pub struct Words<'a> {
    values: &'a [u32],
    /// Indices of the words to come.
    indices: &'a [u8],
}

impl<'a> Words<'a> {
    /// The words of a drive with these indices.
    #[must_use]
    pub const fn new(values: &'a [u32], indices: &'a [u8]) -> Self {
        Self { values, indices }
    }

    /// The next word; zero after the last one.
    // Never inlined: a law reads dozens of words.
    #[inline(never)]
    pub fn next_word(&mut self) -> u32 {
        let Some((index, rest)) = self.indices.split_first() else { return 0 };
        self.indices = rest;
        self.values.get(usize::from(*index)).copied().unwrap_or(0)
    }
}

/// A struct of parameters, declared by [`parameters!`](crate::parameters).
pub trait ParameterGroup: Sized {
    /// The parameters in the order of the fields.
    const TABLE: &'static [Parameter];

    /// The values, from the next words.
    fn read(words: &mut Words<'_>) -> Self;
}

/// The parameters of a law: a group, a tuple of up to eight groups, or `()` for none.
///
/// A parameter that two groups or two laws declare alike is one parameter of the drive.
pub trait ParameterGroups: Sized {
    /// The tables of the groups.
    const TABLES: &'static [&'static [Parameter]];

    /// The groups, from the words of all tables one after the other.
    fn read(words: &mut Words<'_>) -> Self;
}

impl<G: ParameterGroup> ParameterGroups for G {
    const TABLES: &'static [&'static [Parameter]] = &[G::TABLE];

    fn read(words: &mut Words<'_>) -> Self {
        <G as ParameterGroup>::read(words)
    }
}

macro_rules! tuples {
    ($(($($group:ident),*))*) => { $(
        impl<$($group: ParameterGroup),*> ParameterGroups for ($($group,)*) {
            const TABLES: &'static [&'static [Parameter]] = &[$($group::TABLE),*];

            #[allow(unused_variables, clippy::unused_unit)]
            fn read(words: &mut Words<'_>) -> Self {
                ($(<$group as ParameterGroup>::read(words),)*)
            }
        }
    )* };
}

tuples! {
    () (A) (A, B) (A, B, C) (A, B, C, D) (A, B, C, D, E) (A, B, C, D, E, G) (A, B, C, D, E, G, H)
    (A, B, C, D, E, G, H, I)
}

/// Named values of a parameter, declared by [`choices!`](crate::choices).
pub trait Choice: Copy + 'static {
    /// Names in the order of the values, which count from 0.
    const NAMES: &'static [&'static str];

    /// The choice with this value. The drive admits values of the list only; any other reads as the first choice.
    fn from_value(value: u32) -> Self;
}

/// Declares the named values of a parameter as an enum. Names have at most 28 bytes.
///
/// ```
/// lashloop_firmware::choices! {
///     /// Source of the velocity.
///     pub enum VelocitySource {
///         /// Differences of the encoder's counts.
///         Encoder = "encoder",
///         /// An observer.
///         Observer = "observer",
///     }
/// }
/// ```
#[macro_export]
macro_rules! choices {
    ($(#[$meta:meta])* $vis:vis enum $choice:ident {
        $($(#[$variant_meta:meta])* $variant:ident = $name:literal),+ $(,)?
    }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        $vis enum $choice { $($(#[$variant_meta])* $variant),+ }

        impl $crate::law::Choice for $choice {
            const NAMES: &'static [&'static str] = &[$($name),+];

            fn from_value(value: u32) -> Self {
                const ALL: &[$choice] = &[$($choice::$variant),+];
                ALL.get(value as usize).copied().unwrap_or(ALL[0])
            }
        }
    };
}

/// Declares a group of parameters: a struct, its default values, and the table that describes it to the host.
///
/// A field is an `F32` or a `U32` with default, range and unit, or a choice with its default:
///
/// ```
/// # lashloop_firmware::choices! { pub enum VelocitySource { Encoder = "encoder", Observer = "observer" } }
/// lashloop_firmware::parameters! {
///     /// Gains of the velocity loop.
///     pub struct VelocityGains {
///         /// Velocity error to torque.
///         velocity_gain_nm_s_rad: F32 = 0.5 in 0.0..=100.0, "N m s/rad";
///         /// Samples in the moving average.
///         average_samples: U32 = 4 in 1..=64, "";
///         /// Source of the velocity.
///         velocity_source: VelocitySource = Observer;
///     }
/// }
/// let gains = VelocityGains::default();
/// assert_eq!((gains.velocity_gain_nm_s_rad, gains.average_samples), (0.5, 4));
/// ```
///
/// `struct VelocityGains<F>` declares the same group over any [`Real`](crate::law::Real): the drive uses
/// `VelocityGains<f32>`, and a test may compare it with the same law in `f64`.
#[macro_export]
macro_rules! parameters {
    ($(#[$meta:meta])* $vis:vis struct $group:ident <$float:ident> { $($fields:tt)* }) => {
        $crate::parameters!(@fields ($(#[$meta])*) ($vis) $group ($float) $float [] $($fields)*);
    };
    ($(#[$meta:meta])* $vis:vis struct $group:ident { $($fields:tt)* }) => {
        $crate::parameters!(@fields ($(#[$meta])*) ($vis) $group () f32 [] $($fields)*);
    };
    // One field after the other becomes its attributes, name, type, default, table entry and reading.
    (@fields $meta:tt $vis:tt $group:ident $generic:tt $float:ident [$($done:tt)*]
        $(#[$doc:meta])* $name:ident: F32 = $default:literal in $range:expr, $unit:literal; $($rest:tt)*
    ) => {
        $crate::parameters!(@fields $meta $vis $group $generic $float [$($done)* {
            ($(#[$doc])*) $name ($float) (<$float as $crate::law::Real>::from_f64($default))
            ($crate::law::Parameter::new(stringify!($name), $unit, {
                let range: ::core::ops::RangeInclusive<f32> = $range;
                $crate::law::Range::F32 { default: $default, min: *range.start(), max: *range.end() }
            }))
            (f32::from_bits)
        }] $($rest)*);
    };
    (@fields $meta:tt $vis:tt $group:ident $generic:tt $float:ident [$($done:tt)*]
        $(#[$doc:meta])* $name:ident: U32 = $default:literal in $range:expr, $unit:literal; $($rest:tt)*
    ) => {
        $crate::parameters!(@fields $meta $vis $group $generic $float [$($done)* {
            ($(#[$doc])*) $name (u32) ($default)
            ($crate::law::Parameter::new(stringify!($name), $unit, {
                let range: ::core::ops::RangeInclusive<u32> = $range;
                $crate::law::Range::U32 { default: $default, min: *range.start(), max: *range.end() }
            }))
            (u32::from)
        }] $($rest)*);
    };
    (@fields $meta:tt $vis:tt $group:ident $generic:tt $float:ident [$($done:tt)*]
        $(#[$doc:meta])* $name:ident: $choice:ident = $default:ident; $($rest:tt)*
    ) => {
        $crate::parameters!(@fields $meta $vis $group $generic $float [$($done)* {
            ($(#[$doc])*) $name ($choice) ($choice::$default)
            ($crate::law::Parameter::new(stringify!($name), "", $crate::law::Range::Choice {
                default: $choice::$default as u32,
                names: <$choice as $crate::law::Choice>::NAMES,
            }))
            (<$choice as $crate::law::Choice>::from_value)
        }] $($rest)*);
    };
    (@fields ($(#[$meta:meta])*) ($vis:vis) $group:ident ($($generic:ident)?) $float:ident [$({
        ($(#[$doc:meta])*) $name:ident ($ty:ty) ($default:expr) ($entry:expr) ($read:expr)
    })*]) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        $vis struct $group $(<$generic = f32>)? { $($(#[$doc])* pub $name: $ty),* }

        impl $(<$generic: $crate::law::Real>)? ::core::default::Default for $group $(<$generic>)? {
            /// The values after power-up.
            fn default() -> Self {
                Self { $($name: $default),* }
            }
        }

        impl $crate::law::ParameterGroup for $group {
            const TABLE: &'static [$crate::law::Parameter] = &[$($entry),*];

            // Never inlined, so that the image holds the code once for all laws with this group.
            #[inline(never)]
            fn read(words: &mut $crate::law::Words<'_>) -> Self {
                Self { $($name: $read(words.next_word())),* }
            }
        }
    };
}
