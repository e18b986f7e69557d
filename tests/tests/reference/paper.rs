//! The paper's plants and laws: table 1, released at rest at pi/2 with the motor at 3 pi/2.

use core::f64::consts::FRAC_PI_2;

use lashloop_firmware::control::cascade::CascadeGains;
use lashloop_firmware::control::dead_zone_observer::{DeadZoneBounds, DeadZoneObserver};
use lashloop_firmware::control::merzouki::{DisturbingTorqueSource, Merzouki};
use lashloop_firmware::control::momentum_observer::MomentumObserver;
use lashloop_firmware::control::nominal_model::NominalModel;
use lashloop_firmware::control::pd::Pd;
use lashloop_firmware::law::Real;
use lashloop_plant::backlash_shaft::{BacklashShaft, ShaftParameters};
use lashloop_plant::hard_coulomb::HardCoulomb;
use lashloop_plant::smooth::Smooth;
use lashloop_plant::{Mechanics, Start};

use crate::law::Law;

/// The paper's initial condition.
pub(crate) const START: Start = Start::at_rest(FRAC_PI_2, 3.0 * FRAC_PI_2);

/// Coulomb friction of the load in N m that reproduces the paper's static error.
pub(crate) const LOAD_COULOMB_NM: f64 = 3.84;

pub(crate) fn smooth(substeps: u32) -> Smooth {
    Smooth::new(Mechanics::paper(), substeps).expect("valid plant")
}

pub(crate) fn hard_coulomb(substeps: u32) -> HardCoulomb {
    HardCoulomb::new(Mechanics::paper(), LOAD_COULOMB_NM, substeps).expect("valid plant")
}

/// The backlash shaft of the recorded trajectory: its torque has no limit.
pub(crate) fn backlash_shaft(substeps: u32) -> BacklashShaft {
    backlash_shaft_with(unlimited(), substeps)
}

pub(crate) fn backlash_shaft_with(parameters: ShaftParameters, substeps: u32) -> BacklashShaft {
    BacklashShaft::new(Mechanics::paper(), parameters, substeps).expect("valid plant")
}

pub(crate) fn unlimited() -> ShaftParameters {
    ShaftParameters { torque_saturation_nm: 1e6, ..ShaftParameters::paper() }
}

pub(crate) fn pd<F: Real>() -> Law<F> {
    Law::Pd(Pd::new(&NominalModel::default(), CascadeGains::default()))
}

fn merzouki<F: Real>(source: DisturbingTorqueSource<F>, period_s: f64) -> Law<F> {
    let law = Merzouki::new(
        &NominalModel::default(),
        CascadeGains::default(),
        DeadZoneObserver::default(),
        DeadZoneBounds::default(),
        source,
        F::from_f64(period_s),
    );
    Law::Merzouki(law.expect("valid law"))
}

/// The merzouki law for the paper's plant, where the disturbing torque is known.
pub(crate) fn merzouki_nominal<F: Real>(period_s: f64) -> Law<F> {
    merzouki(DisturbingTorqueSource::NominalModel, period_s)
}

/// The merzouki law for any other plant.
pub(crate) fn merzouki_observed<F: Real>(period_s: f64) -> Law<F> {
    let [pole_rad_s, observer_s] = [60.0, period_s].map(F::from_f64);
    let observer = MomentumObserver::new(&NominalModel::default(), pole_rad_s, observer_s);
    merzouki(DisturbingTorqueSource::Observed(observer), period_s)
}
