//! Wrong laws of the name `pd`, of which the golden trace finds each. The specimen has no law of that name.

use lashloop_conformance::CheckStatus;
use lashloop_firmware::control::pd::Pd;
use lashloop_firmware::law::{ControlLaw, ControlOutput, DriveParameters, Measurement, ParameterError};
use lashloop_link::in_process::InProcess;

use crate::results;

/// Declares a law `pd` that measures wrongly, as the only law of a drive.
macro_rules! wrong_laws {
    ($($name:ident: |$measured:ident| $alter:expr,)+) => {
        $(mod $name {
            use super::*;

            pub struct Wrong(Pd);

            impl ControlLaw for Wrong {
                const NAME: &'static str = "pd";
                type Parameters = <Pd as ControlLaw>::Parameters;
                type Signals = <Pd as ControlLaw>::Signals;

                fn new(
                    parameters: Self::Parameters,
                    drive: &DriveParameters,
                ) -> Result<Self, ParameterError> {
                    Ok(Self(<Pd as ControlLaw>::new(parameters, drive)?))
                }

                fn step(&mut self, measurement: &Measurement<f32>) -> ControlOutput<Self::Signals> {
                    let mut $measured = *measurement;
                    $alter;
                    ControlLaw::step(&mut self.0, &$measured)
                }
            }

            lashloop_firmware::laws! {
                /// The wrong law alone.
                pub enum Laws {
                    /// The wrong law.
                    Pd(Wrong),
                }
            }

            #[test]
            fn is_found_by_the_golden_trace() {
                let results = results(InProcess::<Laws>::default());
                let trace = results.iter().filter(|it| it.group == "profile_pd");
                let failed = trace.filter(|it| matches!(it.status, CheckStatus::Failed { .. })).count();
                assert!(failed > 0, "{results:#?}");
            }
        })+
    };
}

wrong_laws! {
    no_velocity_of_the_reference: |measured| measured.reference_velocity_rad_s = 0.0,
    no_acceleration_of_the_reference: |measured| measured.reference_acceleration_rad_s2 = 0.0,
    twist_of_the_other_sign: |measured| measured.twist_rad = -measured.twist_rad,
    no_motor_velocity: |measured| measured.motor_velocity_rad_s = 0.0,
    no_load_velocity: |measured| measured.load_velocity_rad_s = 0.0,
    load_at_the_edge_of_its_count: |measured| measured.load_position_rad -= core::f32::consts::PI / 4096.0,
    motor_at_the_edge_of_its_count: |measured| measured.motor_position_rad -= core::f32::consts::PI / 2000.0,
}
