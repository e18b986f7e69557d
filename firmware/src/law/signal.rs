//! Signals: the numbers of a law that telemetry carries to the host.

/// One signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Signal {
    /// Name, with the unit at its end; at most 32 bytes.
    pub name: &'static str,
    /// Unit as text, at most 10 bytes; empty for a pure number.
    pub unit: &'static str,
    /// Laws that have the signal, bit `n` for law `n` of the set. A struct declares none; `laws!` collects them.
    pub laws: u16,
}

impl Signal {
    /// A signal of no law yet.
    #[must_use]
    pub const fn new(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit, laws: 0 }
    }
}

/// A struct of signals, declared by [`signals!`](crate::signals), or `()` for none.
pub trait Signals: Copy + Send {
    /// The signals in the order of the fields.
    const TABLE: &'static [Signal];

    /// Writes the values to the beginning of `values`, in the order of the table.
    fn write(&self, values: &mut [f32]);
}

impl Signals for () {
    const TABLE: &'static [Signal] = &[];

    fn write(&self, _values: &mut [f32]) {}
}

/// Declares signals: a struct of `f32`, and the table that describes it to the host.
///
/// ```
/// lashloop_firmware::signals! {
///     /// Signals of the velocity loop.
///     pub struct VelocitySignals {
///         /// Velocity error.
///         velocity_error_rad_s: "rad/s",
///     }
/// }
/// ```
///
/// `struct VelocitySignals<F>` declares the same signals over any float type.
#[macro_export]
macro_rules! signals {
    ($(#[$meta:meta])* $vis:vis struct $signals:ident <$float:ident> { $($fields:tt)* }) => {
        $crate::signals!(@all ($(#[$meta])*) ($vis) $signals ($float) $float; $($fields)*);
    };
    ($(#[$meta:meta])* $vis:vis struct $signals:ident { $($fields:tt)* }) => {
        $crate::signals!(@all ($(#[$meta])*) ($vis) $signals () f32; $($fields)*);
    };
    (@all ($(#[$meta:meta])*) ($vis:vis) $signals:ident ($($generic:ident)?) $float:ident;
        $($(#[$doc:meta])* $name:ident: $unit:literal),+ $(,)?
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        $vis struct $signals $(<$generic = f32>)? { $($(#[$doc])* pub $name: $float),+ }

        impl $crate::law::Signals for $signals {
            const TABLE: &'static [$crate::law::Signal] =
                &[$($crate::law::Signal::new(stringify!($name), $unit)),+];

            fn write(&self, values: &mut [f32]) {
                for (value, signal) in values.iter_mut().zip([$(self.$name),+]) {
                    *value = signal;
                }
            }
        }
    };
}
