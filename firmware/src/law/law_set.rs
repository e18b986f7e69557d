//! The laws of one drive: the law in force, and the tables that describe all of them.

use lashloop_protocol::limits::MAX_SIGNALS;

use super::drive_parameters::DriveParameters;
use super::measurement::Measurement;
use super::parameter::Parameter;
use super::parameter_error::ParameterError;
use super::signal::Signal;

/// The laws of a drive, declared by [`laws!`](macro@crate::laws). A value is the law in force, with its state.
pub trait LawSet: Sized + Send + 'static {
    /// Names of the laws; the value of the parameter `controller` is an index of this list.
    const NAMES: &'static [&'static str];
    /// The parameters of drive and laws. The index is that on the wire; the first one is `controller`.
    const PARAMETERS: &'static [Parameter];
    /// The signals of drive and laws. The index is that on the wire.
    const SIGNALS: &'static [Signal];

    /// One 32-bit word for each parameter.
    type Words: AsRef<[u32]> + AsMut<[u32]> + Copy + Send;
    /// The words after power-up.
    const DEFAULTS: Self::Words;

    /// The signals of the law in force.
    type Signals: Copy + Send;

    /// The law with this index in its initial state.
    ///
    /// # Errors
    /// If the parameters, each in its range, don't go together.
    fn new(law: u32, words: &Self::Words, drive: &DriveParameters) -> Result<Self, ParameterError>;

    /// Passes the words to the law in force after the change of a live one.
    ///
    /// # Errors
    /// If the new value doesn't go with the others. The law is then as before.
    fn update(&mut self, words: &Self::Words) -> Result<(), ParameterError>;

    /// Torque in N m for one sample, before the drive's limit. Writes the signals to `signals`, in place, because a copy
    /// would cost more instructions than some laws.
    fn step(&mut self, measurement: &Measurement<f32>, signals: &mut Option<Self::Signals>) -> f32;

    /// [`ControlLaw::TAKES_TORQUE`](super::ControlLaw::TAKES_TORQUE) of the law in force.
    fn takes_torque(&self) -> bool;

    /// Writes the signals of a law to their indices in `values`.
    fn write_signals(signals: &Self::Signals, values: &mut [f32; MAX_SIGNALS]);
}

/// Declares the laws of a drive: an enum with one line for each law, at most 16.
///
/// The order of the laws is that of their indices on the wire; the first one is in force after power-up. See
/// [`law`](crate::law) for an example.
#[macro_export]
macro_rules! laws {
    ($(#[$meta:meta])* $vis:vis enum $set:ident { $($(#[$law_meta:meta])* $law:ident($ty:ty)),+ $(,)? }) => {
        $(#[$meta])*
        #[allow(clippy::large_enum_variant)]
        $vis enum $set { $($(#[$law_meta])* $law($ty)),+ }

        const _: () = {
            use $crate::law::table;
            use $crate::law::{ControlLaw, DriveParameters, DriveSignals, LawSet, Parameter, ParameterGroup};
            use $crate::law::{ParameterGroups, Signal, Signals};

            /// The index of each law.
            enum Index { $($law),+ }

            /// The signals of each law.
            #[derive(Clone, Copy)]
            pub enum SignalsOfLaw { $($law(<$ty as ControlLaw>::Signals)),+ }

            const NAMES: &[&str] = &[$(<$ty as ControlLaw>::NAME),+];

            const PARAMETERS_OF_LAWS: &[&[&[Parameter]]] =
                &[$(<<$ty as ControlLaw>::Parameters as ParameterGroups>::TABLES),+];
            const PARAMETERS_OF_DRIVE: &[&[Parameter]] =
                &[&[table::controller(NAMES)], <DriveParameters as ParameterGroup>::TABLE];
            const PARAMETER_COUNT: usize =
                table::collect_parameters(PARAMETERS_OF_DRIVE, PARAMETERS_OF_LAWS).len;
            const LIVE_OF_LAWS: &[&[&str]] = &[$(<$ty as ControlLaw>::LIVE),+];
            static PARAMETERS: [Parameter; PARAMETER_COUNT] = table::mark_live(
                table::collect_parameters(PARAMETERS_OF_DRIVE, PARAMETERS_OF_LAWS).exact(),
                table::total(PARAMETERS_OF_DRIVE),
                LIVE_OF_LAWS,
            );

            const SIGNALS_OF_LAWS: &[&[&[Signal]]] =
                &[$(&[<<$ty as ControlLaw>::Signals as Signals>::TABLE]),+];
            const SIGNALS_OF_DRIVE: &[&[Signal]] = &[<DriveSignals as Signals>::TABLE];
            const SIGNAL_COUNT: usize = table::collect_signals(SIGNALS_OF_DRIVE, SIGNALS_OF_LAWS).len;
            static SIGNALS: [Signal; SIGNAL_COUNT] =
                table::collect_signals(SIGNALS_OF_DRIVE, SIGNALS_OF_LAWS).exact();

            impl LawSet for $set {
                const NAMES: &'static [&'static str] = NAMES;
                const PARAMETERS: &'static [Parameter] = &PARAMETERS;
                const SIGNALS: &'static [Signal] = &SIGNALS;
                const DEFAULTS: Self::Words = table::defaults(&PARAMETERS);

                type Words = [u32; PARAMETER_COUNT];
                type Signals = SignalsOfLaw;

                fn new(
                    law: u32,
                    words: &Self::Words,
                    drive: &DriveParameters,
                ) -> ::core::result::Result<Self, $crate::law::ParameterError> {
                    $(
                        if law == Index::$law as u32 {
                            const GROUPS: &[&[Parameter]] = PARAMETERS_OF_LAWS[Index::$law as usize];
                            static MAP: [u8; table::total(GROUPS)] = table::map_parameters(&PARAMETERS, GROUPS);
                            return table::build(&MAP, words, drive).map(Self::$law);
                        }
                    )+
                    ::core::result::Result::Err(table::no_law(law, NAMES))
                }

                fn update(&mut self, words: &Self::Words) -> ::core::result::Result<(), $crate::law::ParameterError> {
                    match self {
                        $(Self::$law(law) => {
                            const GROUPS: &[&[Parameter]] = PARAMETERS_OF_LAWS[Index::$law as usize];
                            static MAP: [u8; table::total(GROUPS)] = table::map_parameters(&PARAMETERS, GROUPS);
                            table::update(law, &MAP, words)
                        })+
                    }
                }

                #[inline(always)]
                fn step(
                    &mut self,
                    measurement: &$crate::law::Measurement<f32>,
                    signals: &mut ::core::option::Option<SignalsOfLaw>,
                ) -> f32 {
                    match self {
                        $(Self::$law(law) => {
                            let output = ControlLaw::step(law, measurement);
                            *signals = ::core::option::Option::Some(SignalsOfLaw::$law(output.signals));
                            output.torque_nm
                        })+
                    }
                }

                fn takes_torque(&self) -> bool {
                    match self {
                        $(Self::$law(_) => <$ty as ControlLaw>::TAKES_TORQUE),+
                    }
                }

                fn write_signals(signals: &SignalsOfLaw, values: &mut [f32; table::MAX_SIGNALS]) {
                    match signals {
                        $(SignalsOfLaw::$law(signals) => {
                            const GROUPS: &[&[Signal]] = SIGNALS_OF_LAWS[Index::$law as usize];
                            static MAP: [u8; table::total(GROUPS)] = table::map_signals(&SIGNALS, GROUPS);
                            table::scatter(signals, &MAP, values);
                        })+
                    }
                }
            }
        };
    };
}
